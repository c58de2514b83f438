"""The slider-crank: time per revolution against real time, and against Exudyn."""

from __future__ import annotations

import time
from collections.abc import Iterator
from functools import partial
from itertools import product

import numpy as np

from benchmarks.exudyn_peer import SPEC, Run, simulate_in_exudyn
from benchmarks.harness import Row, rows, seconds_of
from cylcontact.mechanism import long_run, read_mechanism, simulate

# Elastic and without friction both codes have the same forces; up to END the motion does not
# yet amplify its errors.
ELASTIC = {"law": "enhanced", "clearance": 0.5, "restitution": 1.0, "friction": 0.0}
CONTACTS, END = 4, 1.5e-3
LAWS = ("enhanced", "johnson", "lankarani-nikravesh")
EXUDYN = "one revolution, and the error of the onset of its fourth contact"
OURS, REAL_TIME = "cylcontact, 1e-08", "real time"


def measure(short: bool) -> Iterator[list[Row]]:
    """Yield the time per revolution of the paper's 24 cases, and of both codes by accuracy."""
    cases = list(product(LAWS, (0.5, 0.02), (1.0, 0.9), (0.0, 0.1)))
    count = 1 if short else 50
    for law, clearance, restitution, friction in cases[4:5] if short else cases:
        changes = {"clearance": clearance, "restitution": restitution, "friction": friction}
        mechanism = read_mechanism(SPEC, law=law, **changes, revolutions=count, tolerance=1e-8)
        run = partial(long_run, mechanism, count, beyond="tangent")
        run()  # compiles
        seconds = {REAL_TIME: [mechanism.period], OURS: [seconds_of(run) / count]}
        case = f"{law}, {clearance} mm, restitution {restitution}, friction {friction}"
        yield rows(case, seconds, "ms", 1e3)
    yield _against_exudyn(short)


def _against_exudyn(short: bool) -> list[Row]:
    mechanism = read_mechanism(SPEC, **ELASTIC, revolutions=1)
    exact = onsets_of(simulate(mechanism.changed(tolerance=1e-12)))
    tolerances, steps = ((1e-8,), (1e-6,)) if short else ((1e-8, 1e-10), (1e-6, 2.5e-7, 6.25e-8))
    runs = {
        f"cylcontact, {tolerance:.0e}": partial(simulate, mechanism.changed(tolerance=tolerance))
        for tolerance in tolerances
    } | {
        f"Exudyn, step {step:g} s": partial(simulate_in_exudyn, mechanism, END, step)
        for step in steps
    }
    errors = {name: abs(onsets_of(run()) - exact)[-1] for name, run in runs.items()}
    assert max(errors.values()) < 1e-6, errors
    notes = {name: f"{1e9 * e:.2g} ns off" for name, e in errors.items()}
    seconds: dict[str, list[float]] = {name: [] for name in runs}
    for _ in range(1 if short else 5):
        for name, run in runs.items():
            seconds[name].append(_seconds_per_revolution(run, mechanism.period))
    return rows(EXUDYN, seconds, "ms", 1e3, notes)


def _seconds_per_revolution(simulation, period: float) -> float:
    """Return the time of our revolution, or of Exudyn's solution without building its model."""
    started = time.perf_counter()
    run = simulation()
    if isinstance(run, Run):  # up to END only
        return run.seconds * period / END
    return time.perf_counter() - started


def onsets_of(run) -> np.ndarray:
    """Return when the first contacts begin, in s, of a run of ours or of Exudyn's."""
    if not isinstance(run, Run):
        return run.contacts["onset_s"].to_numpy()[:CONTACTS]
    before = np.flatnonzero((run.penetration[1:] > 0) & (run.penetration[:-1] <= 0))[:CONTACTS]
    first, last = run.penetration[before], run.penetration[before + 1]
    return run.time[before] - first / (last - first) * (run.time[before + 1] - run.time[before])
