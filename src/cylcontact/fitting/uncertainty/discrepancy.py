"""Study the discrepancy of a fit to a reference law, which has no noise.

Samples of a law are exact, so its residuals are the same in every repetition: there is no standard
error. A study gives the deviation from the reference over the grid, how far a coefficient or a
pair may move before it gets noticeably worse, and the influence of each part of the grid.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from itertools import combinations
from typing import Any, Literal

import numpy as np
from pydantic import Field

from cylcontact.arrays import FloatArray
from cylcontact.datasets.grid import Grid
from cylcontact.datasets.sampling import blocks
from cylcontact.errors import InputError
from cylcontact.fitting.calibration import problem_of
from cylcontact.fitting.campaign import Campaign, campaign_from_settings
from cylcontact.fitting.data import grid_of, with_grid
from cylcontact.fitting.forms import form_of
from cylcontact.fitting.polish import polish
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.profile import Profile
from cylcontact.fitting.result import FitResult
from cylcontact.fitting.samples import samples_of
from cylcontact.fitting.uncertainty.likelihood import PAIR_POINTS
from cylcontact.fitting.uncertainty.resampling import LeftOut
from cylcontact.parallel import Call, Workers, call, run_calls
from cylcontact.progress import Progress, silent
from cylcontact.spec import Spec

__all__ = ["RISES", "DiscrepancyPair", "DiscrepancyStudy", "study_discrepancy"]

_AXES = ("dR", "E", "nu", "load")
_PRECISION = 1e-10
# Contours of pairs: the relative rise of the best objective.
RISES = (0.01, 0.05, 0.10)
# 1 % intervals on either side of the optimum in a map of a pair; 10 % are at about 3.2.
_PAIR_REACH = 4.0
# Width of the bins of ln(δ/δ_reference), the precision of its quantiles, and its range.
_BIN, _LARGEST = 1e-4, 8.0
_QUANTILES = (0.025, 0.5, 0.975)


class DiscrepancyPair(Spec):
    """The rise of the objective over two coefficients, all others re-optimised."""

    names: tuple[str, str] = Field(description="the two coefficients", strict=False)
    x: list[float] = Field(description="values of the first, increasing")
    y: list[float] = Field(description="values of the second, increasing")
    rise: list[list[float | None]] = Field(
        description="best objective over the optimum, less 1; null where the law is undefined"
    )


class DiscrepancyStudy(Spec):
    """The discrepancy of a fit to a reference law."""

    name: str = Field(description="the fit's name")
    kind: Literal["discrepancy"] = Field("discrepancy", description="what the numbers are about")
    profiles: dict[str, Profile] = Field(description="the objective over each coefficient")
    pairs: list[DiscrepancyPair] = Field(description="the objective over pairs of them")
    left_out: list[LeftOut] = Field(description="fits without one value of an axis")
    spread_percent: dict[str, float] = Field(
        description="quantiles of Eq 9 over the samples of the grid, in percent"
    )


def study_discrepancy(
    result: FitResult,
    *,
    leave_out: str | None = None,
    with_pairs: bool = False,
    jobs: Workers = 1,
    progress: Progress = silent,
) -> DiscrepancyStudy:
    """Return the discrepancy of a fit to a reference law.

    Parameters
    ----------
    result : FitResult
        Of kind "discrepancy".
    leave_out : str, optional
        The axis of the grid whose values are left out one after the other: dR, E (or material),
        nu or load.
    with_pairs : bool
        Whether to map the objective over each pair of coefficients.
    jobs : int or Cluster
        Worker processes, or a Dask cluster; the result does not depend on it.
    progress : callable, optional
        Called with the stage, how many of its parts are done, and their number.

    Returns
    -------
    DiscrepancyStudy

    Raises
    ------
    InputError
        If the result is one of measurements, or the axis is unknown or has one value only.
    """
    source = f"fit result {result.name!r}"
    if result.kind != "discrepancy":
        raise InputError(
            source, "kind", result.kind, "was fitted to measurements", "study its noise"
        )
    campaign = campaign_from_settings(result.name, result.settings, source)
    best = result.coefficients
    spread = _spread(campaign, best)
    left_out: list[LeftOut] = []
    if leave_out is not None:
        axis = "E" if leave_out == "material" else leave_out
        left_out = _leave_one_out(campaign, best, axis, jobs, progress)
    pairs: list[DiscrepancyPair] = []
    if with_pairs:
        problem, _ = problem_of(campaign, jobs, silent)
        calls = [
            call(_pair, problem, names, best, result.profiles)
            for names in combinations([p.name for p in problem.free], 2)
        ]
        pairs = _collected(calls, jobs, progress, "mapping")
    return DiscrepancyStudy(
        name=result.name,
        profiles=result.profiles,
        pairs=pairs,
        left_out=left_out,
        spread_percent=spread,
    )


def _collected(calls: Sequence[Call], jobs: Workers, progress: Progress, stage: str) -> list[Any]:
    """Run calls and collect what they return."""
    results = []
    with closing(run_calls(calls, jobs)) as returned:
        for result in returned:
            results.append(result)
            progress(stage, len(results), len(calls))
    return results


def _leave_one_out(
    campaign: Campaign, best: Mapping[str, float], axis: str, jobs: Workers, progress: Progress
) -> list[LeftOut]:
    """Fit without each value of an axis, and evaluate the fit on that value."""
    if axis not in _AXES:
        raise InputError(
            campaign.source,
            "leave-out",
            axis,
            "is not an axis of a grid",
            f"choose {', '.join(_AXES)} or material",
        )
    size = getattr(grid_of(campaign), axis).size
    if size < 2:
        raise InputError(
            campaign.source, "leave-out", axis, "has one value only", "choose another axis"
        )
    calls = [call(_without, campaign, best, axis, k) for k in range(size)]
    fits: list[LeftOut] = _collected(calls, jobs, progress, "leaving out")
    return fits


def _with_axis(grid: Grid, axis: str, values: FloatArray) -> Grid:
    """Return a grid with other values on an axis."""
    changed: dict[str, Any] = {axis: values}
    return replace(grid, **changed)


def _without(campaign: Campaign, best: Mapping[str, float], axis: str, place: int) -> LeftOut:
    """Fit without one value of an axis."""
    values = getattr(grid_of(campaign), axis)
    rest = _with_axis(grid_of(campaign), axis, np.delete(values, place))
    own = _with_axis(grid_of(campaign), axis, values[place : place + 1])
    problem, _ = problem_of(with_grid(campaign, rest), 1, silent)
    point, _ = polish(problem, problem.point(best), _PRECISION)
    coefficients = problem.coefficients(point)
    own_rms, rows = np.inf, 0
    try:
        alone, counts = problem_of(with_grid(campaign, own), 1, silent)
        own_rms, rows = alone.value_of(coefficients), counts.samples
    except InputError:
        pass  # every sample of this value is masked
    return LeftOut(
        group=f"{axis} = {values[place]:.6g}",
        rows=rows,
        coefficients=coefficients,
        own_rms=own_rms if np.isfinite(own_rms) else None,
    )


def _pair(
    problem: Problem,
    names: tuple[str, str],
    best: Mapping[str, float],
    profiles: Mapping[str, Profile],
) -> DiscrepancyPair:
    """Map the rise of the objective over two coefficients."""
    optimum = problem.value_of(best)
    axes = []
    for name in names:
        parameter = next(p for p in problem.free if p.name == name)
        below, above = best[name] - profiles[name].low, profiles[name].high - best[name]
        low = max(parameter.low, best[name] - _PAIR_REACH * below)
        axes.append(
            np.linspace(low, min(parameter.high, best[name] + _PAIR_REACH * above), PAIR_POINTS)
        )
    x, y = axes
    rise: list[list[float | None]] = [[None] * x.size for _ in y]
    for row, second in enumerate(y):
        start: Mapping[str, float] = best
        for column, first in enumerate(x):
            smaller = problem.fixing(names[0], float(first)).fixing(names[1], float(second))
            point, reached = polish(smaller, smaller.point(start), _PRECISION)
            if np.isfinite(reached):
                rise[row][column], start = reached / optimum - 1, smaller.coefficients(point)
    return DiscrepancyPair(names=names, x=[float(v) for v in x], y=[float(v) for v in y], rise=rise)


def _spread(campaign: Campaign, best: Mapping[str, float]) -> dict[str, float]:
    """Return quantiles of Eq 9 over the grid in percent, from a histogram of ln(δ/δ_reference)."""
    edges = np.arange(-_LARGEST, _LARGEST + _BIN, _BIN)
    counts = np.zeros(edges.size - 1)
    candidate = campaign.model.candidates(best)
    for dR in grid_of(campaign).dR:
        form = form_of(campaign.model, candidate, np.array([dR]))
        for block in blocks(grid_of(campaign), float(dR)):
            ratio = form.log_penetration_ratio(0, samples_of(grid_of(campaign).contact, block))
            if not np.isfinite(ratio).all():
                raise InputError(
                    campaign.source,
                    "coefficients",
                    dict(best),
                    "leave the law undefined for some of its samples",
                    "redo the fit",
                )
            counts += np.histogram(np.clip(ratio, -_LARGEST, _LARGEST), edges)[0]
    reached = np.cumsum(counts) / counts.sum()
    middles = (edges[1:] + edges[:-1]) / 2
    return {
        f"{100 * share:g}": float(100 * np.expm1(middles[np.searchsorted(reached, share)]))
        for share in _QUANTILES
    }
