"""Fit a law to a law: sample the reference on a grid, search, descend, and profile."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np

from cylcontact.datasets.sampling import Counts, reduce_grid
from cylcontact.files.journal import Journal
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.profile import Profiles
from cylcontact.fitting.records import (
    TOLERANCE,
    MaxDifference,
    ObjectiveValue,
    Profile,
    SampleCounts,
)
from cylcontact.fitting.reference import OnMoments, OnSamples, Samples, max_abs_difference_percent
from cylcontact.fitting.results import LawFit
from cylcontact.fitting.runs import best_of, published_on, run_all, searches
from cylcontact.support.arrays import FloatArray, on_one_thread
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import Workers, call, collect
from cylcontact.support.progress import Progress, silent

# Points evaluated at a time until the law is defined for one, and their number.
_AT_ONCE, _TRIED = 64, 1 << 12
# Values of a coefficient in a profile, and the largest distance from the optimum that counts.
_CURVE, _FAR = 41, 1e6


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
    spec = campaign.spec
    provenance = campaign.provenance  # of what is run, not of what is there when it ends
    space, counts = space_of(campaign, jobs, progress)
    journal = Journal(checkpoint, "campaign", campaign.key) if checkpoint else None
    calls = searches(space, spec.genetic, spec.seed, campaign.source)
    records = run_all(calls, jobs, progress, journal, resume)
    best, published = best_of(records), published_on(space)
    compared = [best.coefficients] + ([published.coefficients] if published else [])
    largest = max_abs_difference_percent(campaign.grid, campaign.model, compared, jobs, progress)
    profiles = {} if spec.profiles is False else profiles_of(space, compared, jobs, progress)
    return LawFit(
        name=campaign.name,
        law=campaign.model.law,
        contact=campaign.model.contact,
        reference=campaign.reference,
        coefficients=best.coefficients,
        objective=ObjectiveValue(name=campaign.objective, value=best.objective),
        published=published,
        max_abs_diff_percent=MaxDifference(
            fitted=float(largest[0]), published=float(largest[1]) if published else None
        ),
        runs=records,
        counts=SampleCounts(samples=counts.samples, masked=counts.masked),
        settings=campaign.settings,
        provenance=provenance,
        bound=space.bound if isinstance(space, OnMoments) else None,
        profiles=profiles,
    )


def space_of(
    campaign: Campaign, jobs: Workers = 1, progress: Progress = silent
) -> tuple[OnMoments | OnSamples, Counts]:
    """Return what a campaign minimises, and the number of its samples used and masked."""
    grid, model, parameters = campaign.grid, campaign.model, campaign.parameters
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


def profiles_of(
    space: OnMoments | OnSamples,
    compared: list[dict[str, float]],
    jobs: Workers = 1,
    progress: Progress = silent,
) -> dict[str, Profile]:
    """Return the profiles of the free coefficients, at the best and, perhaps, published ones."""
    # A batch is faster where descents are; otherwise each coefficient has a worker.
    is_batch = space.in_batches
    groups = [space.names] if is_batch else [[name] for name in space.names]
    calls = [call(_profiles, space, group, *compared) for group in groups]
    progress("profiling", 0, len(calls))
    return {
        name: profile
        for some in collect(calls, 1 if is_batch else jobs, progress, "profiling")
        for name, profile in some.items()
    }


def _profiles(
    space: OnMoments | OnSamples,
    names: list[str],
    best: Mapping[str, float],
    published: Mapping[str, float] | None = None,
) -> dict[str, Profile]:
    """Return the profiles of some coefficients, on one thread."""
    values = []
    for p in space.free:
        others = [each[p.name] for each in (best, published) if each]
        even = np.linspace(p.low, p.high, _CURVE)
        values.append(np.union1d(even, others) if p.name in names else np.empty(0))
    optimum = space.value_of(best)
    with on_one_thread():
        profiles = Profiles(space, space.point(best), values)
        ends = profiles.ends(partial(_distance, optimum))
    return {
        p.name: _record(profiles, axis, ends[axis], (published or {}).get(p.name))
        for axis, p in enumerate(space.free)
        if p.name in names
    }


def _distance(optimum: float, objective: FloatArray) -> FloatArray:
    """Return the root of the rise of the objective over that at the ends of an interval."""
    rise = np.maximum(objective - optimum, 0.0) / (TOLERANCE * optimum)
    return np.minimum(np.sqrt(rise), _FAR)


def _record(profiles: Profiles, axis: int, ends: FloatArray, published: float | None) -> Profile:
    parameter, places = profiles.space.free[axis], profiles.places(axis)
    places = places[np.isfinite(profiles.objective[places])]
    values, objective = profiles.at[places], profiles.objective[places]
    is_bound = np.isnan(ends)
    low, high = np.where(is_bound, [parameter.low, parameter.high], ends).tolist()
    return Profile(
        values=values.tolist(),
        objective=objective.tolist(),
        low=low,
        high=high,
        low_is_bound=bool(is_bound[0]),
        high_is_bound=bool(is_bound[1]),
        objective_at_published=next(iter(objective[values == published].tolist()), None),
    )
