"""Refits to parts of the data: the bootstrap, and leave-one-group-out.

Rows of one specimen share its errors. Resampling whole groups (materials, clearances, pairs)
preserves this. Leaving one out shows its influence on the coefficients, and how well the others
predict it.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import closing

import numpy as np
from pydantic import Field

from cylcontact.arrays import FloatArray
from cylcontact.errors import InputError
from cylcontact.fitting.measured_objective import measured
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.uncertainty.profiles import Descent, Interval, refit_to_data
from cylcontact.fitting.uncertainty.residual_model import with_rows
from cylcontact.parallel import Workers, call, collect, run_calls
from cylcontact.progress import Progress, silent
from cylcontact.spec import Spec

__all__ = [
    "FEWEST_REFITS",
    "FEW_GROUPS",
    "FEW_REFITS",
    "Bootstrap",
    "LeftOut",
    "bootstrap",
    "leave_one_out",
    "left_out",
]

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


class LeftOut(Spec):
    """A fit without one group."""

    group: str = Field(description="the group left out")
    rows: int = Field(description="its rows")
    coefficients: dict[str, float] = Field(description="fitted to the others")
    own_rms: float | None = Field(
        description="the objective of its rows with those coefficients; null if undefined"
    )


def bootstrap(
    problem: Problem,
    best: Mapping[str, float],
    over: str,
    replicates: int,
    seed: int,
    level: float,
    jobs: Workers = 1,
    progress: Progress = silent,
) -> Bootstrap:
    """Refit to resampled rows or groups.

    Parameters
    ----------
    problem : Problem
        On measurements.
    best : mapping
        The coefficients at the optimum, from which refits start.
    over : str
        A criterion of `Measurements.groups`, e.g. "rows".
    replicates : int
        Number of refits.
    seed : int
        The same seed gives the same intervals.
    level : float
        E.g. 0.95.
    jobs : int or Cluster
        Worker processes, or a Dask cluster.
    progress : callable, optional
        Called with the stage, how many of its parts are done, and their number.

    Returns
    -------
    Bootstrap

    Raises
    ------
    InputError
        If there is only one group, or fewer than two refits could start.
    """
    names, _ = _groups(problem, over)
    noise = measured(problem).noise
    if noise is not None and noise.covariance.model.over not in (None, over):
        raise InputError(
            measured(problem).data.data.source,
            "over",
            over,
            "would tear apart the series of the noise model",
            "resample whole series with --over group",
        )
    seeds = np.random.SeedSequence(seed).spawn(replicates)
    batches = [seeds[k : k + _BATCH] for k in range(0, replicates, _BATCH)]
    calls = [call(_replicates, problem, best, over, batch) for batch in batches]
    refits: list[FloatArray | None] = []
    with closing(run_calls(calls, jobs)) as results:
        for batch in results:
            refits.extend(batch)
            progress("resampling", len(refits), replicates)
    points = [point for point in refits if point is not None]
    if len(points) < 2:
        raise InputError(
            measured(problem).data.data.source,
            "bootstrap",
            replicates,
            f"refits left the law defined in {len(points)}, and a spread needs two",
            "request more, or fit again so that the law is defined for all rows",
        )
    spread = np.array(points)
    return Bootstrap(
        over=over,
        groups=len(names),
        replicates=replicates,
        undefined=replicates - len(points),
        seed=seed,
        intervals=_percentiles(problem, spread, level) if len(points) >= FEWEST_REFITS else {},
        standard_errors={
            p.name: float(s) for p, s in zip(problem.free, spread.std(axis=0, ddof=1), strict=True)
        },
    )


def _percentiles(problem: Problem, spread: FloatArray, level: float) -> dict[str, Interval]:
    """Return the percentile interval of each free parameter."""
    tails = np.percentile(spread, [50 * (1 - level), 50 * (1 + level)], axis=0)
    return {
        p.name: Interval(
            low=float(low),
            high=float(high),
            low_is_bound=bool(low <= p.low),
            high_is_bound=bool(high >= p.high),
        )
        for p, low, high in zip(problem.free, *tails, strict=True)
    }


def leave_one_out(
    problem: Problem,
    best: Mapping[str, float],
    over: str,
    jobs: Workers = 1,
    progress: Progress = silent,
) -> list[LeftOut]:
    """Fit without each group in turn, and evaluate that fit on the group.

    Parameters
    ----------
    problem, best, over, jobs, progress
        As for `bootstrap`.

    Returns
    -------
    list of LeftOut

    Raises
    ------
    InputError
        If there is only one group, or too few rows remain without one.
    """
    names, group = _groups(problem, over)
    for number, name in enumerate(names):
        remaining = int((group != number).sum())
        if remaining <= len(problem.free):
            raise InputError(
                measured(problem).data.data.source,
                "over",
                over,
                f"without {name} only {remaining} rows remain for {len(problem.free)} parameters",
                "choose another grouping, or fix parameters",
            )
    calls = [call(_without, problem, best, over, number) for number in range(len(names))]
    return collect(calls, jobs, progress, "leaving out")


def left_out(
    group: str,
    rest: Problem,
    own: Problem | None,
    rows: int,
    best: Mapping[str, float],
    refit: Descent,
) -> LeftOut:
    """Fit without one group, and evaluate the fit on it.

    Parameters
    ----------
    group : str
        Its name.
    rest : Problem
        The problem without it.
    own : Problem or None
        The problem on it alone; None if it has no samples.
    rows : int
        Its rows.
    best : mapping
        The coefficients of the fit to all, from which to start.
    refit : callable
        `refit_to_data` or `refit_to_law`.

    Returns
    -------
    LeftOut
    """
    point, _ = refit(rest, rest.point(best))
    coefficients = rest.coefficients(point)
    own_rms = np.inf if own is None else own.value_of(coefficients)
    return LeftOut(
        group=group,
        rows=rows,
        coefficients=coefficients,
        own_rms=own_rms if np.isfinite(own_rms) else None,
    )


def _groups(problem: Problem, over: str) -> tuple[list[str], FloatArray]:
    """Return the names of the groups, at least two, and the group of each row."""
    data = measured(problem).data
    names, group = data.groups(over)
    if len(names) < 2:
        raise InputError(
            data.data.source,
            "over",
            over,
            f"all rows are of one group, {names[0]}",
            "choose rows, or measure another",
        )
    return names, np.asarray(group)


def _replicates(
    problem: Problem,
    best: Mapping[str, float],
    over: str,
    seeds: list[np.random.SeedSequence],
) -> list[FloatArray | None]:
    """Refit once per seed; None if the law is undefined for a row at the start."""
    data = measured(problem).data
    start = problem.point(best)
    names, group = data.groups(over)
    members = [np.flatnonzero(group == number) for number in range(len(names))]
    points: list[FloatArray | None] = []
    for seed in seeds:
        drawn = np.random.default_rng(seed).integers(len(names), size=len(names))
        rows = np.concatenate([members[k] for k in drawn])
        copies = np.repeat(np.arange(drawn.size), [members[k].size for k in drawn])
        point, value = refit_to_data(with_rows(problem, rows, copies), start)
        points.append(point if np.isfinite(value) else None)
    return points


def _without(problem: Problem, best: Mapping[str, float], over: str, number: int) -> LeftOut:
    """Fit without one group."""
    names, group = measured(problem).data.groups(over)
    others, own = np.flatnonzero(group != number), np.flatnonzero(group == number)
    rest, alone = with_rows(problem, others), with_rows(problem, own)
    return left_out(names[number], rest, alone, own.size, best, refit_to_data)
