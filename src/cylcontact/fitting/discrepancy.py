"""Study the discrepancy of a fit to a reference law, which has no noise.

Samples of a law are exact, so its residuals are the same in every repetition: there is no standard
error. A study gives the deviation from the reference over the grid, how far a coefficient or a
pair may move before it gets noticeably worse, and the influence of each part of the grid.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.datasets.grid import AnyGrid
from cylcontact.errors import InputError
from cylcontact.fitting.calibration import problem_of
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.objectives import log_ratios_at
from cylcontact.fitting.polish import polish
from cylcontact.fitting.profiles import discrepancy_pair
from cylcontact.fitting.records import DiscrepancyPair, LeftOut, Profile
from cylcontact.fitting.results import LawFit
from cylcontact.fitting.words import Rows, item, left_out_table
from cylcontact.parallel import Workers, call, collect
from cylcontact.plain_text import brief
from cylcontact.progress import Progress, silent
from cylcontact.spec import Spec
from cylcontact.text_tables import Table

# Contours of pairs: the relative rise of the best objective.
RISES = (0.01, 0.05, 0.10)
# Width of the bins of ln(δ/δ_reference), the precision of its quantiles, and its range.
_BIN, _LARGEST = 1e-4, 8.0
_QUANTILES = (0.025, 0.5, 0.975)


class DiscrepancyStudy(Spec):
    """The discrepancy of a fit to a reference law."""

    name: str
    profiles: dict[str, Profile]
    pairs: list[DiscrepancyPair]
    left_out: list[LeftOut]
    # Quantiles of Eq 9 over the samples of the grid.
    spread_percent: dict[str, float]
    coefficients: dict[str, float]
    reference: str

    def __str__(self) -> str:
        rows: Rows = [
            (name, f"{self.coefficients[name]:.5g}", profile.interval)
            for name, profile in self.profiles.items()
        ]
        low, middle, high = self.spread_percent.values()
        sentences = [
            f"{self.reference} is a law, not a measurement: the residuals are model discrepancy, "
            "which has no standard error",
            f"over the grid, Eq 9 lies between {low:+.3g} % and {high:+.3g} % for 95 % of the "
            f"samples (median {middle:+.3g} %)",
        ]
        parts = [
            f"{brief(self.name)}: how far each coefficient may move before the best objective "
            "rises by 1 %",
            str(Table(("", "fitted", "within 1 %"), rows)),
            "\n".join(map(item, sentences)),
            *left_out_table(self.left_out, list(self.profiles)),
        ]
        return "\n\n".join(parts)


def study_discrepancy(
    result: LawFit,
    *,
    leave_out: str | None = None,
    with_pairs: bool = False,
    jobs: Workers = 1,
    progress: Progress = silent,
) -> DiscrepancyStudy:
    """Return the discrepancy of a fit to a reference law."""
    source = f"fit result {result.name!r}"
    campaign = Campaign.of_settings(result.name, result.settings, source)
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
            for names in combinations(problem.names, 2)
        ]
        pairs = collect(calls, jobs, progress, "mapping")
    return DiscrepancyStudy(
        name=result.name,
        profiles=result.profiles,
        pairs=pairs,
        left_out=fits,
        spread_percent=spread,
        coefficients=best,
        reference=result.reference,
    )


def _leave_one_out(
    campaign: Campaign, best: Mapping[str, float], axis: str, jobs: Workers, progress: Progress
) -> list[LeftOut]:
    """Fit without each value of an axis, and evaluate the fit on that value."""
    axes = campaign.grid.axes
    if axis not in axes:
        rule = "is not an axis of a grid"
        remedy = f"choose {', '.join(axes)}{' or material' if 'E' in axes else ''}"
        raise InputError(campaign.source, "leave-out", axis, rule, remedy)
    size = getattr(campaign.grid, axis).size
    if size < 2:
        raise InputError(
            campaign.source, "leave-out", axis, "has one value only", "choose another axis"
        )
    calls = [call(_without, campaign, best, axis, k) for k in range(size)]
    return collect(calls, jobs, progress, "leaving out")


def _with_axis(grid: AnyGrid, axis: str, values: FloatArray) -> AnyGrid:
    changed: dict[str, Any] = {axis: values}
    return replace(grid, **changed)


def _without(campaign: Campaign, best: Mapping[str, float], axis: str, place: int) -> LeftOut:
    values = getattr(campaign.grid, axis)
    rest = _with_axis(campaign.grid, axis, np.delete(values, place))
    own = _with_axis(campaign.grid, axis, values[place : place + 1])
    problem, _ = problem_of(campaign.on(rest), 1, silent)
    alone, rows = None, 0
    with suppress(InputError):  # if every sample of this value is masked
        alone, counts = problem_of(campaign.on(own), 1, silent)
        rows = counts.samples
    point, _ = polish(problem, problem.point(best), precision=1e-10)
    coefficients = problem.coefficients(point)
    rms = np.inf if alone is None else alone.value_of(coefficients)
    return LeftOut.of(f"{axis} = {values[place]:.6g}", rows, coefficients, rms)


def _spread(campaign: Campaign, best: Mapping[str, float]) -> dict[str, float]:
    """Return quantiles of Eq 9 over the grid in percent, from a histogram of ln(δ/δ_reference)."""
    edges = np.arange(-_LARGEST, _LARGEST + _BIN, _BIN)
    counts = np.zeros(edges.size - 1)
    candidate = campaign.model.candidates(best)
    for dR in campaign.grid.dR:
        for (ratio,) in log_ratios_at(campaign.grid, campaign.model, candidate, float(dR)):
            if not np.isfinite(ratio).all():
                rule = "leave the law undefined for some of its samples"
                raise InputError(campaign.source, "coefficients", dict(best), rule, "redo the fit")
            counts += np.histogram(np.clip(ratio, -_LARGEST, _LARGEST), edges)[0]
    reached = np.cumsum(counts) / counts.sum()
    middles = (edges[1:] + edges[:-1]) / 2
    return {
        f"{100 * share:g}": float(100 * np.expm1(middles[np.searchsorted(reached, share)]))
        for share in _QUANTILES
    }
