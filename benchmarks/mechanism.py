"""The slider-crank: time per revolution against real time, and against Exudyn at its accuracy."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial
from itertools import product
from pathlib import Path

import numpy as np

from benchmarks.exudyn_peer import Run, simulate_in_exudyn
from benchmarks.harness import Row, Side, rows, timings
from cylcontact.mechanism import long_run, read_mechanism, simulate

SPEC = Path(__file__).parents[1] / "datasets" / "slider_crank.toml"
# Where Exudyn and we are compared: elastic, without friction, so that the force laws are the
# same; up to here the motion is not yet sensitive to its own errors.
ELASTIC = {"law": "enhanced", "clearance": 0.5, "restitution": 1.0, "friction": 0.0}
# The paper's laws of Section 4.
LAWS = ("enhanced", "johnson", "lankarani-nikravesh")
CONTACTS, END = 4, 1.5e-3
OURS = "cylcontact at 1e-8"
TOLERANCES, STEPS = (1e-6, 1e-8, 1e-10), (1e-6, 2.5e-7, 6.25e-8)


def measure(short: bool) -> Iterator[list[Row]]:
    """Yield the milliseconds per revolution of long runs by case, and the cost of accuracy."""
    yield from _cases(short)
    yield _accuracy(short)


def _cases(short: bool) -> Iterator[list[Row]]:
    revolutions = 1 if short else 50
    for law, clearance, restitution, friction in product(LAWS, (0.5, 0.02), (1.0, 0.9), (0.0, 0.1)):
        if short and (law, clearance) != ("enhanced", 0.02):
            continue
        mechanism = read_mechanism(
            SPEC,
            law=law,
            clearance=clearance,
            restitution=restitution,
            friction=friction,
            revolutions=revolutions,
            tolerance=1e-8,
        )
        ours = Side(OURS, partial(long_run, mechanism, revolutions, beyond="tangent"))
        measured = timings([ours], 1)[OURS]
        seconds = {"real time": [mechanism.period]}
        seconds[OURS] = [total / revolutions for total in measured]
        case = f"{law}, {clearance} mm, restitution {restitution}, friction {friction}"
        yield rows("mechanism", case, seconds, "ms per revolution", 1e3)


def _accuracy(short: bool) -> list[Row]:
    """Time both up to the end of the fourth contact, and note the error of its onset."""
    mechanism = read_mechanism(SPEC, **ELASTIC, revolutions=1)
    reference = simulate(mechanism.changed(tolerance=1e-12))
    exact = onsets_of(reference)
    share = END / mechanism.period
    ours = {
        f"cylcontact, tolerance {tolerance:g}": partial(
            simulate, mechanism.changed(tolerance=tolerance)
        )
        for tolerance in (TOLERANCES[1:2] if short else TOLERANCES)
    }
    theirs = {
        f"Exudyn, step {step:g} s": partial(simulate_in_exudyn, mechanism, END, step)
        for step in (STEPS[:1] if short else STEPS)
    }
    errors = {name: onset_error(exact, onsets_of(run())) for name, run in (ours | theirs).items()}
    assert max(errors.values()) < 1e-6, errors
    notes = {name: f"fourth contact begins {1e9 * e:.2g} ns off" for name, e in errors.items()}
    # Both per revolution: ours runs a whole one, Exudyn up to the end of the fourth contact.
    per_revolution: dict[str, list[float]] = {name: [] for name in ours | theirs}
    for _ in range(1 if short else 5):
        for name, run in (ours | theirs).items():
            part = share if name in theirs else 1.0
            per_revolution[name].append(_seconds_of_solution(run) / part)
    case = "accuracy: enhanced, 0.5 mm, elastic, without friction"
    return rows("mechanism", case, per_revolution, "ms per revolution", 1e3, notes)


def _seconds_of_solution(simulation: Callable[[], object]) -> float:
    """Time a simulation; Exudyn's without building its model, which is done but once."""
    started = time.perf_counter()
    run = simulation()
    return run.seconds if isinstance(run, Run) else time.perf_counter() - started


def onsets_of(run) -> np.ndarray:
    """Return when the first contacts begin, in s, of a run of ours or of Exudyn's."""
    if not isinstance(run, Run):
        return run.contacts["onset_s"].to_numpy()[:CONTACTS]
    before = np.flatnonzero((run.penetration[1:] > 0) & (run.penetration[:-1] <= 0))[:CONTACTS]
    first, last = run.penetration[before], run.penetration[before + 1]
    times = run.time[before], run.time[before + 1]
    return times[0] - first / (last - first) * (times[1] - times[0])


def onset_error(exact: np.ndarray, onsets: np.ndarray) -> float:
    """Return how far the last of the contacts is off, in s."""
    return float(abs(onsets[-1] - exact[-1]))
