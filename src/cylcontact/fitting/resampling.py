"""Refits to parts of the readings: the bootstrap, and leave-one-group-out.

Rows of one specimen share its errors. Resampling whole groups (materials, clearances, pairs)
preserves this. Leaving one out shows its influence on the coefficients, and how well the others
predict it.
"""

from __future__ import annotations

from contextlib import closing

import numpy as np
from pydantic import Field

from cylcontact.arrays import FloatArray
from cylcontact.datasets.measurements import Indices
from cylcontact.errors import InputError
from cylcontact.fitting.optimum import Optimum
from cylcontact.fitting.records import Interval, LeftOut
from cylcontact.parallel import Workers, call, collect, run_calls
from cylcontact.progress import Progress, silent
from cylcontact.spec import Spec

# Replicates per call of a worker.
_BATCH = 25
# With fewer groups than this intervals are too narrow.
FEW_GROUPS = 8
# Fewer refits than this give standard errors, but no percentile intervals.
FEWEST_REFITS = 40
# With this many refits the ends of a 95 % interval vary with the seed by about a tenth of a
# standard error. The report warns of fewer.
FEW_REFITS = 1000


class Bootstrap(Spec):
    """Percentile intervals from refits to resampled data."""

    over: str = Field(description="what was resampled: rows, or a kind of group")
    groups: int = Field(description="their number")
    replicates: int = Field(description="the number of refits requested")
    undefined: int = Field(
        0, description="refits for which the law was undefined at the start; left out"
    )
    seed: int = Field(description="the seed of the resampling")
    intervals: dict[str, Interval] = Field(
        description=f"of each free parameter; none from fewer than {FEWEST_REFITS} refits"
    )
    standard_errors: dict[str, float] = Field(description="standard deviations of the refits")


def bootstrap(
    optimum: Optimum,
    over: str,
    replicates: int,
    seed: int,
    level: float,
    jobs: Workers = 1,
    progress: Progress = silent,
) -> Bootstrap:
    """Refit to resampled rows or groups, from the optimum; the same seed gives the same intervals.

    `over` is a criterion of `Measurements.groups`, e.g. "rows".

    Raises
    ------
    InputError
        If there is only one group, or fewer than two refits could start.
    """
    names, _ = _groups(optimum, over)
    noise, source = optimum.fit.noise, optimum.fit.data.data.source
    if noise is not None and noise.covariance.model.over not in (None, over):
        rule = "would tear apart the series of the noise model"
        raise InputError(source, "over", over, rule, "resample whole series with --over group")
    seeds = np.random.SeedSequence(seed).spawn(replicates)
    batches = [seeds[k : k + _BATCH] for k in range(0, replicates, _BATCH)]
    refits: list[FloatArray | None] = []
    with closing(
        run_calls([call(_replicates, optimum, over, b) for b in batches], jobs)
    ) as results:
        for batch in results:
            refits.extend(batch)
            progress("resampling", len(refits), replicates)
    points = np.array([point for point in refits if point is not None])
    if len(points) < 2:
        rule = f"refits left the law defined in {len(points)}, and a spread needs two"
        remedy = "request more, or fit again so that the law is defined for all rows"
        raise InputError(source, "bootstrap", replicates, rule, remedy)
    intervals = {}
    if len(points) >= FEWEST_REFITS:
        ends = np.percentile(points, [50 * (1 - level), 50 * (1 + level)], axis=0).T
        intervals = {
            p.name: Interval(
                low=float(low),
                high=float(high),
                low_is_bound=bool(low <= p.low),
                high_is_bound=bool(high >= p.high),
            )
            for p, (low, high) in zip(optimum.fit.free, ends, strict=True)
        }
    errors = zip(optimum.fit.names, points.std(axis=0, ddof=1).tolist(), strict=True)
    return Bootstrap(
        over=over,
        groups=len(names),
        replicates=replicates,
        undefined=replicates - len(points),
        seed=seed,
        intervals=intervals,
        standard_errors=dict(errors),
    )


def leave_one_out(
    optimum: Optimum, over: str, jobs: Workers = 1, progress: Progress = silent
) -> list[LeftOut]:
    """Fit without each group in turn, and evaluate that fit on the group.

    Raises
    ------
    InputError
        If there is only one group, or too few rows remain without one.
    """
    names, group = _groups(optimum, over)
    for number, name in enumerate(names):
        left = int((group != number).sum())
        if left <= optimum.point.size:
            rule = f"without {name} only {left} rows remain for {optimum.point.size} parameters"
            remedy = "choose another grouping, or fix parameters"
            raise InputError(optimum.fit.data.data.source, "over", over, rule, remedy)
    calls = [call(_without, optimum, over, number) for number in range(len(names))]
    return collect(calls, jobs, progress, "leaving out")


def _groups(optimum: Optimum, over: str) -> tuple[list[str], Indices]:
    """Return the names of the groups, at least two, and the group of each row."""
    data = optimum.fit.data
    names, group = data.groups(over)
    if len(names) < 2:
        rule = f"all rows are of one group, {names[0]}"
        raise InputError(data.data.source, "over", over, rule, "choose rows, or measure another")
    return names, group


def _replicates(
    optimum: Optimum, over: str, seeds: list[np.random.SeedSequence]
) -> list[FloatArray | None]:
    """Refit once per seed; None if the law is undefined for a row at the start."""
    names, group = optimum.fit.data.groups(over)
    members = [np.flatnonzero(group == number) for number in range(len(names))]
    points: list[FloatArray | None] = []
    for seed in seeds:
        drawn = np.random.default_rng(seed).integers(len(names), size=len(names))
        rows = np.concatenate([members[k] for k in drawn])
        copies = np.repeat(np.arange(drawn.size), [members[k].size for k in drawn])
        point, value, _ = optimum.fit.take(rows, copies).minimise(optimum.point)
        points.append(point if np.isfinite(value) else None)
    return points


def _without(optimum: Optimum, over: str, number: int) -> LeftOut:
    """Fit without one group, and evaluate the fit on it."""
    names, group = optimum.fit.data.groups(over)
    own = np.flatnonzero(group == number)
    rest = optimum.fit.take(np.flatnonzero(group != number))
    coefficients = rest.coefficients(rest.minimise(optimum.point).point)
    rms = optimum.fit.take(own).value_of(coefficients)
    return LeftOut.of(names[number], own.size, coefficients, rms)
