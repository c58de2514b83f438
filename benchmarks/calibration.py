"""The time from a grid to coefficients within 0.1 % of the best objective that is known."""

from __future__ import annotations

import time
from collections.abc import Iterator
from statistics import median

import numpy as np

from benchmarks.harness import Row, Side, rows, seconds_of
from benchmarks.peers import PEERS, RowProblem, reach, rows_of
from benchmarks.sampling import grid_of
from benchmarks.search import space_of
from cylcontact.fitting.reference import OnMoments
from cylcontact.fitting.runs import searches
from cylcontact.fitting.search import minimise
from cylcontact.fitting.specs import GeneticSpec

# A search has arrived when its objective is this close to the best.
CLOSE = 1.001
# Runs of ours, one after the other, before a seed counts as having failed.
MOST_RUNS = 200
OURS = {
    "cylcontact: sampling, genetic search and polish": True,
    "cylcontact: sampling and descents alone": False,
}
# All peers run to the end on the first grid; on the others, that have more samples, their time
# follows from the evaluations that they needed there.
SMALL = (5, 3, 61, 5)
TINY = (3, 2, 9, 4)
LARGER = {"1,001,925 samples": (25, 9, 61, 73), "100,000,000 samples": (200, 50, 100, 100)}
# Rows of more samples than this are not held: five columns and as many temporaries of eight bytes.
MOST_ROWS = 20_000_000


def measure(short: bool) -> Iterator[list[Row]]:
    """Yield the seconds that each way takes, by number of samples."""
    table, evaluations = _on_the_small_grid(short)
    yield table
    for case, shape in {} if short else LARGER.items():
        yield _on_a_larger_grid(case, shape, evaluations)


def _on_the_small_grid(short: bool) -> tuple[list[Row], dict[str, tuple[float, bool]]]:
    """Run everything; return the rows, and by peer the evaluations and whether it arrived."""
    shape, rounds = (TINY, 1) if short else (SMALL, 3)
    space = space_of(*shape)
    best = _best_known(space, 4 if short else 16)
    samples = rows_of(grid_of(*shape), space, CLOSE * best)
    require_same_objective(space, samples)
    names = list(PEERS)[:1] if short else list(PEERS)
    reached = {name: [] for name in names}
    seconds = {name: [] for name in (*OURS, *names)}
    for seed in range(rounds):
        for name, is_genetic in OURS.items():
            seconds[name].append(_ours(shape, CLOSE * best, seed, is_genetic))
        for name in names:
            started = time.perf_counter()
            reached[name].append(reach(name, samples, seed))
            seconds[name].append(time.perf_counter() - started)
    notes, needed = {}, {}
    for name, runs in reached.items():
        above = 100 * (median(value for value, _ in runs) / best - 1)
        arrived = sum(value <= CLOSE * best for value, _ in runs)
        count = median(count for _, count in runs)
        needed[name] = (count, arrived == len(runs))
        notes[name] = f"{arrived} of {len(runs)} arrived; {above:.2g} % above the best, "
        notes[name] += f"{count:,} evaluations"
    case = f"{samples.load.size:,} samples"
    return rows("calibration", case, seconds, "s", 1.0, notes), needed


def _on_a_larger_grid(
    case: str, shape: tuple[int, ...], evaluations: dict[str, tuple[float, bool]]
) -> list[Row]:
    """Run ours, and multiply the peers' evaluations by the measured cost of one."""
    space, size = space_of(*shape), int(np.prod(shape))
    best = _best_known(space, 16)
    seconds = {
        side: [_ours(shape, CLOSE * best, seed, is_genetic) for seed in range(3)]
        for side, is_genetic in OURS.items()
    }
    notes = {}
    if size <= MOST_ROWS:
        samples = rows_of(grid_of(*shape), space, 0.0)
        require_same_objective(space, samples)
        point = (space.low + space.high) / 2
        cost = median(seconds_of(Side("", lambda: samples.residuals(point))) for _ in range(4))
        for name, (count, arrived) in evaluations.items():
            seconds[name] = [count * cost] * 3
            notes[name] = f"computed: {count:,.0f} evaluations of {1e3 * cost:.1f} ms"
            notes[name] += "" if arrived else ", which had not arrived"
    return rows("calibration", case, seconds, "s", 1.0, notes)


def _ours(shape: tuple[int, ...], target: float, seed: int, is_genetic: bool) -> float:
    """Return the seconds until a campaign's runs, or descents from random points, arrive."""
    started = time.perf_counter()
    space = space_of(*shape)
    for index, (run, arguments, _) in enumerate(searches(space, GeneticSpec(runs=MOST_RUNS), seed)):
        if is_genetic:
            reached = run(*arguments).objective
        else:
            start = space.scatter(np.random.default_rng([seed, index]), 1)[0]
            reached = minimise(space, start, MOST_RUNS * seed + index)[1]
        if reached <= target:
            return time.perf_counter() - started
    raise AssertionError(f"seed {seed}: none of {MOST_RUNS} runs came within {CLOSE}")


def _best_known(space: OnMoments, runs: int) -> float:
    planned = searches(space, GeneticSpec(runs=runs), 20150101)
    return min(run(*arguments).objective for run, arguments, _ in planned)


def require_same_objective(space: OnMoments, samples: RowProblem) -> None:
    """Hold the objective from moments against that of the samples, at random candidates."""
    candidates = [samples.start(np.random.default_rng(seed)) for seed in range(5)]
    by_rows = [np.sqrt(np.mean(samples.residuals(candidate) ** 2)) for candidate in candidates]
    np.testing.assert_allclose(space.values(np.array(candidates)), by_rows, rtol=1e-9)
