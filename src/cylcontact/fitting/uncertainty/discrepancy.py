"""Study the discrepancy of a fit to a reference law, which has no noise.

Samples of a law are exact, so its residuals are the same in every repetition: there is no standard
error. A study gives the deviation from the reference over the grid, how far a coefficient or a
pair may move before it gets noticeably worse, and the influence of each part of the grid.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any, Literal

import numpy as np
from pydantic import Field

from cylcontact.arrays import FloatArray
from cylcontact.datasets.grid import AnyGrid
from cylcontact.datasets.sampling import blocks
from cylcontact.errors import InputError
from cylcontact.fitting.calibration import problem_of
from cylcontact.fitting.campaign import Campaign, campaign_from_settings, grid_of, with_grid
from cylcontact.fitting.polish import polish
from cylcontact.fitting.result import FitResult
from cylcontact.fitting.samples import form_of, samples_of
from cylcontact.fitting.uncertainty.law_profiles import DiscrepancyPair, Profile, discrepancy_pair
from cylcontact.fitting.uncertainty.profiles import pairs_of
from cylcontact.fitting.uncertainty.resampling import LeftOut, left_out
from cylcontact.parallel import Workers, call, collect
from cylcontact.progress import Progress, silent
from cylcontact.spec import Spec

# Contours of pairs: the relative rise of the best objective.
RISES = (0.01, 0.05, 0.10)
# Width of the bins of ln(δ/δ_reference), the precision of its quantiles, and its range.
_BIN, _LARGEST = 1e-4, 8.0
_QUANTILES = (0.025, 0.5, 0.975)


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

    The values of the axis `leave_out` (dR, E or material, nu or load) are left out one after the
    other; `with_pairs` maps the objective over each pair of coefficients.
    """
    source = f"fit result {result.name!r}"
    if result.kind != "discrepancy":
        raise InputError(
            source, "kind", result.kind, "was fitted to measurements", "study its noise"
        )
    campaign = campaign_from_settings(result.name, result.settings, source)
    best = result.coefficients
    spread = _spread(campaign, best)
    fits: list[LeftOut] = []
    if leave_out is not None:
        axis = "E" if leave_out == "material" else leave_out
        fits = _leave_one_out(campaign, best, axis, jobs, progress)
    pairs: list[DiscrepancyPair] = []
    if with_pairs:
        problem, _ = problem_of(campaign, jobs, silent)
        calls = [
            call(discrepancy_pair, problem, names, best, result.profiles)
            for names in pairs_of(problem)
        ]
        pairs = collect(calls, jobs, progress, "mapping")
    return DiscrepancyStudy(
        name=result.name,
        profiles=result.profiles,
        pairs=pairs,
        left_out=fits,
        spread_percent=spread,
    )


def _leave_one_out(
    campaign: Campaign, best: Mapping[str, float], axis: str, jobs: Workers, progress: Progress
) -> list[LeftOut]:
    """Fit without each value of an axis, and evaluate the fit on that value."""
    axes = grid_of(campaign).axes
    if axis not in axes:
        raise InputError(
            campaign.source,
            "leave-out",
            axis,
            "is not an axis of a grid",
            f"choose {', '.join(axes)}{' or material' if 'E' in axes else ''}",
        )
    size = getattr(grid_of(campaign), axis).size
    if size < 2:
        raise InputError(
            campaign.source, "leave-out", axis, "has one value only", "choose another axis"
        )
    calls = [call(_without, campaign, best, axis, k) for k in range(size)]
    return collect(calls, jobs, progress, "leaving out")


def _with_axis(grid: AnyGrid, axis: str, values: FloatArray) -> AnyGrid:
    """Return a grid with other values on an axis."""
    changed: dict[str, Any] = {axis: values}
    return replace(grid, **changed)


def _without(campaign: Campaign, best: Mapping[str, float], axis: str, place: int) -> LeftOut:
    """Fit without one value of an axis."""
    values = getattr(grid_of(campaign), axis)
    rest = _with_axis(grid_of(campaign), axis, np.delete(values, place))
    own = _with_axis(grid_of(campaign), axis, values[place : place + 1])
    problem, _ = problem_of(with_grid(campaign, rest), 1, silent)
    alone, rows = None, 0
    with suppress(InputError):  # if every sample of this value is masked
        alone, counts = problem_of(with_grid(campaign, own), 1, silent)
        rows = counts.samples
    group = f"{axis} = {values[place]:.6g}"
    return left_out(group, problem, alone, rows, best, partial(polish, precision=1e-10))


def _spread(campaign: Campaign, best: Mapping[str, float]) -> dict[str, float]:
    """Return quantiles of Eq 9 over the grid in percent, from a histogram of ln(δ/δ_reference)."""
    edges = np.arange(-_LARGEST, _LARGEST + _BIN, _BIN)
    counts = np.zeros(edges.size - 1)
    candidate = campaign.model.candidates(best)
    for dR in grid_of(campaign).dR:
        form = form_of(campaign.model, candidate, np.array([dR]))
        for block in blocks(grid_of(campaign), float(dR)):
            ratio = form.log_penetration_ratio(0, samples_of(grid_of(campaign), block))
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
