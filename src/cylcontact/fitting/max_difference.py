"""The largest |Eq 9| over a grid of any size."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import closing

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.grid import Grid
from cylcontact.datasets.sampling import blocks
from cylcontact.fitting.forms import form_of
from cylcontact.fitting.samples import samples_of
from cylcontact.laws.definition import LawModel
from cylcontact.parallel import Workers, call, run_calls

__all__ = ["max_abs_difference_percent"]


def max_abs_difference_percent(
    grid: Grid,
    model: LawModel,
    candidates: list[Mapping[str, float]],
    jobs: Workers = 1,
    progress: Callable[[int], None] | None = None,
) -> FloatArray:
    """Return the largest |Eq 9| in percent over a grid for each of several coefficient sets.

    Parameters
    ----------
    grid : Grid
        The grid, sampled block by block.
    model : LawModel
        The law.
    candidates : list of mapping
        Coefficients by name, P of them.
    jobs : int or Cluster
        Threads, or a Dask cluster; the result does not depend on it.
    progress : callable, optional
        Called with the number of clearances done.

    Returns
    -------
    array of float, shape (P,)
    """
    points = model.candidates(*candidates)
    work = [call(_at_clearance, grid, model, points, float(dR)) for dR in grid.dR]
    worst = np.zeros(len(candidates))
    with closing(run_calls(work, jobs, threads=True)) as results:
        for done, at_clearance in enumerate(results, start=1):
            worst = np.maximum(worst, at_clearance)
            if progress is not None:
                progress(done)
    return 100 * worst


def _at_clearance(grid: Grid, model: LawModel, points: FloatArray, dR: float) -> FloatArray:
    """Return the largest |Eq 9| at one ΔR, as a fraction, shape (P,).

    Eq 9 increases with the log ratio, so only the extremes are exponentiated.
    """
    low, high = np.zeros(len(points)), np.zeros(len(points))
    form = form_of(model, points, np.array([dR]))
    for block in blocks(grid, dR):
        rows = samples_of(grid.contact, block)
        for k in range(len(points)):
            ratio = form.log_penetration_ratio(k, rows)
            low[k] = np.fmin.reduce(ratio, initial=low[k])
            high[k] = np.fmax.reduce(ratio, initial=high[k])
    return as_floats(np.maximum(np.expm1(high), -np.expm1(low)))
