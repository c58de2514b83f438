"""Fit a law to a law: sample the reference on a grid, search, descend, and profile."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from cylcontact.datasets.grid import Grid
from cylcontact.datasets.sampling import Counts, reduce_grid
from cylcontact.files.journal import Journal
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.profile import Profiles
from cylcontact.fitting.records import (
    FAIRLY,
    SAME_BASIN,
    TOLERANCE,
    WELL,
    Estimate,
    MaxDifference,
    ObjectiveValue,
    Profile,
    Published,
    SampleCounts,
    SearchRecord,
    with_verdict,
)
from cylcontact.fitting.reference import OnMoments, OnSamples, Samples, max_abs_difference_percent
from cylcontact.fitting.results import LawFit, on_runs
from cylcontact.fitting.runs import best_of, published_on, run_all, searches
from cylcontact.fitting.space import Space
from cylcontact.fitting.specs import CampaignSpec
from cylcontact.support.arrays import FloatArray, on_one_thread
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import Workers, call, collect
from cylcontact.support.progress import Progress, silent

# Points evaluated at a time until the law is defined for one, and their number.
_AT_ONCE, _TRIED = 64, 1 << 12
# A search that ends this close above the objective, relatively, has found the optimum itself.
_AS_GOOD = 1e-6
# Values of a coefficient in a profile, and the largest distance from the optimum that counts.
_CURVE, _FAR = 41, 1e6
# A coefficient this close to a bound, relative to the search interval, is at the bound.
_AT_BOUND = 1e-6


def calibrate(
    campaign: Campaign,
    jobs: Workers = 1,
    progress: Progress = silent,
    checkpoint: Path | None = None,
    resume: bool = False,
) -> LawFit:
    """Fit a law to a law: sample the grid, search, descend, and profile each coefficient.

    Parameters
    ----------
    campaign : Campaign
        From `Campaign.read`.
    jobs : int or Cluster
        Worker processes, or a Dask cluster; the result does not depend on it.
    progress : callable, optional
        Called with the stage, how many of its parts are done, and their number.
    checkpoint : path, optional
        The journal of finished runs; the caller removes it once the result is saved.
    resume : bool
        Whether to take the runs already in `checkpoint` from there.

    Returns
    -------
    LawFit

    Raises
    ------
    InputError
        If every sample is masked, the bounds exclude the law's domain, or `checkpoint` belongs to
        another campaign.

    Examples
    --------
    Samples of the published external law recover its coefficients:

    >>> from cylcontact.datasets import Grid
    >>> dR, load = np.geomspace(5.0, 500.0, 4), np.geomspace(10.0, 1000.0, 4)
    >>> grid = Grid("external", "enhanced", np.array([207.0]), np.array([0.3]), dR, load)
    >>> bounds = {"a": (0.1, 1.5), "b": (0.1, 3.0), "n": (1.0, 1.5)}
    >>> campaign = Campaign.on(grid, "enhanced", bounds=bounds, genetic={"runs": 2})
    >>> result = calibrate(campaign)
    >>> print({name: round(value, 6) for name, value in result.coefficients.items()})
    {'a': 0.39, 'b': 0.85, 'n': 1.094}
    """
    grid, spec = _grid_in(campaign), campaign.spec
    assert isinstance(spec, CampaignSpec)
    provenance = campaign.provenance  # of what is run, not of what is there when it ends
    space, counts = space_of(campaign, jobs, progress)
    journal = Journal(checkpoint, "campaign", campaign.key) if checkpoint else None
    calls = searches(space, spec.genetic, spec.seed, campaign.source)
    records = run_all(calls, SearchRecord, jobs, progress, journal, resume)
    best, published = best_of(records), published_on(space)
    compared = [best.coefficients] + ([published.coefficients] if published else [])
    largest = max_abs_difference_percent(grid, campaign.model, compared, jobs, progress)
    curves = {} if spec.profiles is False else profiles_of(space, compared, jobs, progress)
    estimates = _estimates(space, best.coefficients, curves)
    bound = space.bound if isinstance(space, OnMoments) else None
    warnings, notes = sentences_on(space, estimates, published, bound, records)
    return LawFit(
        name=campaign.name,
        law=campaign.model.law,
        contact=campaign.model.contact,
        formula=campaign.model.formula,
        reference=campaign.reference,
        estimates=estimates,
        objective=ObjectiveValue(name=campaign.objective, value=best.objective),
        published=published,
        max_abs_diff_percent=MaxDifference(
            fitted=float(largest[0]), published=float(largest[1]) if published else None
        ),
        runs=records,
        counts=SampleCounts(samples=counts.samples, masked=counts.masked),
        warnings=warnings,
        notes=notes,
        settings=campaign.settings,
        provenance=provenance,
        bound=bound,
        profiles={name: profile for name, (profile, *_) in curves.items()},
    )


def space_of(
    campaign: Campaign, jobs: Workers = 1, progress: Progress = silent
) -> tuple[OnMoments | OnSamples, Counts]:
    """Return what a campaign minimises, and the number of its samples used and masked."""
    grid, model, parameters = _grid_in(campaign), campaign.model, campaign.parameters
    space: OnMoments | OnSamples
    if model.power_form is not None and campaign.objective == "rms-log-penetration":
        moments, counts = reduce_grid(grid, jobs, progress)
        space = OnMoments(model, parameters, moments)
    else:
        samples = Samples.of(grid)
        counts = Counts(samples.s.size, grid.size - samples.s.size)
        space = OnSamples(model, parameters, campaign.objective, samples)
    _require_defined_somewhere(space, campaign.source)
    return space, counts


def _grid_in(campaign: Campaign) -> Grid:
    """Return the grid that a campaign is on; refuse one on measurements."""
    if not isinstance(campaign.data, Grid):
        rule = "is a campaign on measurements, not on a grid"
        raise InputError(campaign.source, "", None, rule, "fit it with fit_table")
    return campaign.data


def _require_defined_somewhere(space: OnMoments | OnSamples, source: str) -> None:
    """Refuse bounds within which the law is undefined at some sample, wherever it is tried."""
    unit = np.random.default_rng(0).uniform(size=(_TRIED, len(space.free)))
    corners = np.vstack([np.zeros(len(space.free)), np.ones(len(space.free)), unit])
    points = space.low + corners * space.span
    some = (points[k : k + _AT_ONCE] for k in range(0, len(points), _AT_ONCE))
    if not any(np.isfinite(space.values(part)).any() for part in some):
        bounds = {p.name: [p.low, p.high] for p in space.free}
        rule = "within these bounds the law is undefined for some of the samples"
        remedy = "move the bounds; a power law needs a positive factor and n at every ΔR"
        raise InputError(source, "bounds", bounds, rule, remedy)


# --- profiles -----------------------------------------------------------------------------------

# A profile with the ends of its interval, NaN for one that a bound cuts off, and its objective at
# the published value.
_Curve = tuple[Profile, FloatArray, float | None]


def profiles_of(
    space: OnMoments | OnSamples,
    compared: list[dict[str, float]],
    jobs: Workers = 1,
    progress: Progress = silent,
) -> dict[str, _Curve]:
    """Return the profiles of the free coefficients, at the best and, perhaps, published ones."""
    # A batch is faster where descents are; otherwise each coefficient has a worker.
    is_batch = space.in_batches
    groups = [space.names] if is_batch else [[name] for name in space.names]
    calls = [call(_profiles, space, group, *compared) for group in groups]
    progress("profiling", 0, len(calls))
    parts = collect(calls, 1 if is_batch else jobs, progress, "profiling")
    return {name: curve for part in parts for name, curve in part.items()}


def _profiles(
    space: OnMoments | OnSamples,
    names: list[str],
    best: Mapping[str, float],
    published: Mapping[str, float] | None = None,
) -> dict[str, _Curve]:
    """Return the profiles of some coefficients within their bounds, on one thread."""
    values = []
    for p in space.free:
        others = [each[p.name] for each in (best, published) if each]
        inside = [value for value in others if p.low <= value <= p.high]
        even = np.linspace(p.low, p.high, _CURVE)
        values.append(np.union1d(even, inside) if p.name in names else np.empty(0))
    optimum, curves = space.value_of(best), {}
    with on_one_thread():
        profiles = Profiles(space, space.point(best), values)
        ends = profiles.ends(partial(_distance, optimum))
    for axis, p in enumerate(space.free):
        places = profiles.places(axis)
        places = places[np.isfinite(profiles.objective[places])]
        at, objective = profiles.at[places], profiles.objective[places]
        if p.name in names:
            there = objective[at == (published or {}).get(p.name, np.nan)].tolist()
            profile = Profile(values=at.tolist(), objective=objective.tolist())
            curves[p.name] = profile, ends[axis], next(iter(there), None)
    return curves


def _distance(optimum: float, objective: FloatArray, _: int) -> FloatArray:
    """Return the root of the rise of the objective over that at the ends of an interval."""
    rise = np.maximum(objective - optimum, 0.0) / (TOLERANCE * optimum)
    return np.minimum(np.sqrt(rise), _FAR)


# --- what it means ------------------------------------------------------------------------------


def _estimates(
    space: Space,
    best: Mapping[str, float],
    curves: Mapping[str, _Curve],
) -> dict[str, Estimate]:
    """Return all coefficients; those searched with the interval and the verdict of the profile."""
    estimates, optimum = {}, space.value_of(best)
    for p in space.parameters:
        verdict = f"= {p.tie}" if p.tie else "fixed" if p.fixed else "-"
        each = Estimate(value=best[p.name], unit=p.unit, verdict=verdict)
        if p.name in curves:
            _, ends, at_published = curves[p.name]
            cut = np.isnan(ends).tolist()
            low, high = np.where(cut, [p.low, p.high], ends).tolist()
            penalty = None if at_published is None else at_published / optimum - 1
            more = {"low": low, "high": high, "low_is_bound": cut[0], "high_is_bound": cut[1]}
            each = each.model_copy(update={**more, "penalty": penalty})
            each = with_verdict(each, 1 / abs(each.value) if each.value else np.inf)
        estimates[p.name] = each
    return estimates


def sentences_on(
    space: Space,
    estimates: Mapping[str, Estimate],
    published: Published | None,
    bound: float | None,
    runs: list[SearchRecord],
) -> tuple[list[str], list[str]]:
    """Return warnings and notes: on the published values, the bound, identification, and runs."""
    best, notes = min(run.objective for run in runs), []
    if published is not None:
        ratio = published.objective / best
        notes.append("the published coefficients are the optimum on this grid, within 0.1 %")
        if published.objective < best * (1 - SAME_BASIN) - LawFit.round_off:
            notes[-1] = (
                "the published coefficients, outside these bounds, have a lower objective: "
                f"{published.objective:.4g}"
            )
        elif published.objective > best * (1 + SAME_BASIN) + LawFit.round_off:
            is_all = all(p.is_free or p.never_free for p in space.parameters)
            searched = "all coefficients" if is_all else f"only {' and '.join(space.names)}"
            excess = f"{100 * (ratio - 1):.1f} % above" if ratio < 1.1 else f"{ratio:.2f} times"
            notes[-1] = (
                f"with {searched} free the published coefficients are not the optimum on this "
                f"grid: their objective is {published.objective:.4g}, {excess} the fitted one"
            )
    if bound:
        notes.append(
            f"the fit is {100 * (best / bound - 1):.1f} % above the lower bound {bound:.4g}, "
            "reached with K* and n fitted separately at each clearance"
        )
    judged = {name: e.verdict for name, e in estimates.items() if e.low is not None}
    poor = [name for name, verdict in judged.items() if verdict in ("poorly", "not")]
    if poor:
        notes.append(
            f"poorly identified: {', '.join(poor)} (the best objective rises by less than "
            f"{100 * TOLERANCE:g} % while the coefficient moves by more than {100 * FAIRLY:g} % of "
            f"its value, or to a bound; well identified is {100 * WELL:g} %)"
        )
    elif judged:
        notes.append("every coefficient inside its bounds is at least fairly identified")
    for p in space.free:
        for side, end in (("lower", p.low), ("upper", p.high)):
            if abs(estimates[p.name].value - end) <= _AT_BOUND * (p.high - p.low):
                notes.append(f"{p.name} is at its {side} bound {end:g}: widen it")
    law = space.model.build({name: each.value for name, each in estimates.items()})
    how = "[fixed] in the campaign, or --fix"
    warnings, more = on_runs(runs, LawFit.round_off, poor, how)
    return warnings, [*notes, *more, _on_search(runs), *filter(None, [getattr(law, "note", "")])]


def _on_search(runs: Sequence[SearchRecord]) -> str:
    """Return what the genetic search reached, and what the descent after it added."""
    best = min(run.objective for run in runs)
    above = [max(run.objective_before_polish / best - 1, 0.0) for run in runs if best > 0]
    if not above or max(above) < _AS_GOOD:
        return "the genetic search itself reached this objective within 1 in a million"
    return (
        f"the genetic search ended {min(above):.1e} to {max(above):.1e} above this objective; "
        "a descent from there gained the rest"
    )
