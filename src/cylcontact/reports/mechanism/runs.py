"""The cases of Section 4, simulated from the bench's spec when they are asked for."""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import closing
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pandas as pd

from cylcontact.mechanism import (
    Case,
    Mechanism,
    Trajectory,
    cases,
    mechanism_from,
    read_mechanism,
    simulate,
)
from cylcontact.mechanism.system import TANGENT_FROM
from cylcontact.parallel import Workers, call, run_calls
from cylcontact.reports.bench import Bench

# The laws, clearances (mm), restitutions and frictions of Sect. 4.3.
LAW_NAMES: Mapping[str, str] = {
    "lankarani-nikravesh": "Lankarani–Nikravesh",
    "johnson": "Johnson",
    "enhanced": "enhanced",
}
CLEARANCES = (0.5, 0.02)
RESTITUTIONS = (1.0, 0.9)
FRICTIONS = (0.0, 0.1)
CASES = tuple(cases(LAW_NAMES, CLEARANCES, RESTITUTIONS, FRICTIONS))

# Statistics leave the first revolutions out: the journal starts at rest in the centre, and impacts
# separate two tolerances, where they do, within 1.5 revolutions (datasets/mechanism/cases.csv).
REVOLUTIONS, FIRST = 8, 3
# Without dissipation, friction drives the journal round along the wall of a small clearance. That
# lasts for a number of revolutions that hangs on every digit, then stops for good.
WHIRLING = Case("", min(CLEARANCES), 1.0, 0.1)
WHIRLING_REVOLUTIONS = 16
# The second run of a case has the spec's tolerance times this.
TIGHTER = 0.1
AGAINST = "_against"
_REMEMBERED: dict[str, pd.DataFrame] = {}
STATISTICS = (
    "contact_fraction",
    "impacts",
    "mean_penetration_um",
    "max_penetration_um",
    "force_p99_N",
    "max_force_N",
    "mean_step_contact_us",
    "mean_step_flight_us",
)


def mechanism(bench: Bench, case: Case | None = None) -> Mechanism:
    """Return the mechanism of the bench's spec, or a case of it.

    Raises
    ------
    InputError
        If the spec is missing or wrong.
    """
    if case is None:
        return read_mechanism(bench.mechanism_file)
    return read_mechanism(bench.mechanism_file, **vars(case))


def simulated(bench: Bench, case: Case, revolutions: int) -> Trajectory:
    """Return a case's run over that many revolutions; a few runs are remembered.

    Beyond its domain a law goes on along its tangent, and the run says how often.

    Raises
    ------
    InputError
        If the spec is missing or wrong.
    """
    one = mechanism(bench, case)
    return _simulated(json.dumps(one.data), one.source, revolutions)


@lru_cache(maxsize=12)
def _simulated(data: str, source: str, revolutions: int) -> Trajectory:
    """Simulate what a spec's data say; the data are the key that a run is remembered by."""
    one = mechanism_from(json.loads(data), source)
    return simulate(one, revolutions=revolutions, beyond="tangent")


def revolutions_of(case: Case) -> int:
    """Return over how many revolutions a case is run.

    Examples
    --------
    >>> revolutions_of(Case("johnson", 0.02, 1.0, 0.1)), revolutions_of(CASES[0])
    (16, 8)
    """
    whirls = replace(case, law="") == WHIRLING
    return WHIRLING_REVOLUTIONS if whirls else REVOLUTIONS


def statistics_table(bench: Bench, workers: Workers = 1) -> pd.DataFrame:
    """Run all 24 cases at two tolerances and return their statistics, which are remembered.

    Parameters
    ----------
    bench : Bench
        Where the spec lies.
    workers : int or Cluster, optional
        Where to run the cases; the table does not depend on it.

    Returns
    -------
    pandas.DataFrame
        One row for each of `CASES`: law, clearance (mm), restitution, friction, what `case_row`
        returns at the spec's tolerance, and the same at the tighter one (names end in `AGAINST`).

    Raises
    ------
    InputError
        If the spec is missing or wrong.
    """
    data = json.dumps(mechanism(bench).data)
    if data not in _REMEMBERED:
        calls = [call(run_case, data, case) for case in CASES]
        with closing(run_calls(calls, workers)) as rows:
            _REMEMBERED[data] = pd.DataFrame(list(rows))
    return _REMEMBERED[data].copy()


def run_case(data: str, case: Case) -> dict[str, object]:
    """Run one case of the mechanism whose spec's data are given as JSON, and return its row."""
    one = mechanism_from(json.loads(data), "mechanism", **vars(case))
    rows = []
    for share in (1.0, TIGHTER):
        tolerance = share * one.integration.tolerance
        rows.append(
            case_row(
                simulate(
                    one, revolutions=revolutions_of(case), tolerance=tolerance, beyond="tangent"
                )
            )
        )
    row, second = rows
    return vars(case) | row | {f"{name}{AGAINST}": value for name, value in second.items()}


def case_row(run: Trajectory, first: int = FIRST) -> dict[str, float]:
    """Return a run's numbers: means over the revolutions from `first` on, and their scatter.

    Parameters
    ----------
    run : Trajectory
        Of the slider-crank.
    first : int, optional
        The first revolution that counts, from 0.

    Returns
    -------
    dict of str to float
        The means of `STATISTICS`, each with its standard deviation over the revolutions
        (`_std`), and how many were `counted`; `step_us`, the mean step, and `step_us_std`;
        `contact_us` and `flight_us`, the mean durations of a contact and of a flight (NaN where
        there is none); the `onsets` of the whole run, how many of those contacts were
        `continued` along the law's tangent, and in how many the penetration `left` the law's
        domain; and `energy_error`, relative to the peak kinetic energy.

    Examples
    --------
    >>> from pathlib import Path
    >>> bench = Bench(Path("."))
    >>> case = Case("enhanced", clearance=0.02, restitution=0.9, friction=0.1)
    >>> row = case_row(simulated(bench, case, revolutions=4))
    >>> print(row["contact_fraction"], row["impacts"])
    1.0 0.0
    """
    found = run.statistics(first)
    steps = run.mechanism.period * 1e6 / found.by_revolution["steps"]
    row = {name: float(found.mean[name]) for name in STATISTICS}
    row |= {f"{name}_std": float(found.scatter[name]) for name in STATISTICS}
    deepest = run.contacts["max_penetration_m"].to_numpy() * 1e3
    limit = law_limit(run.mechanism)
    inside, outside = _durations(run, first * run.mechanism.period)
    return row | {
        "counted": float(len(found.by_revolution)),
        "step_us": float(steps.mean()),
        "step_us_std": float(steps.std()),
        "contact_us": inside,
        "flight_us": outside,
        "onsets": float(len(run.contacts)),
        "continued": float((deepest > TANGENT_FROM * limit).sum()),
        "left": float((deepest > limit).sum()),
        "energy_error": float(np.abs(run.energy_error).max() / run.kinetic_energy.max()),
    }


def law_limit(one: Mechanism) -> float:
    """Return the largest penetration of the mechanism's contact law in mm, inf without one.

    Examples
    --------
    >>> from pathlib import Path
    >>> one = mechanism(Bench(Path(".")), Case("johnson", 0.02, 0.9, 0.1))
    >>> print(f"{law_limit(one):.5f}")
    0.01083
    """
    joint = one.clearance
    return np.inf if joint.pair is None else float(joint.law.max_penetration(joint.pair))


def _durations(run: Trajectory, begin: float) -> tuple[float, float]:
    """Return the mean durations in µs of the contacts and flights that begin and end after it."""
    onset = run.contacts["onset_s"].to_numpy()
    release = run.contacts["release_s"].to_numpy()
    inside = (release - onset)[onset >= begin]
    outside = (onset[1:] - release[:-1])[release[:-1] >= begin]
    means = [
        float(np.nanmean(spans)) * 1e6 if np.isfinite(spans).any() else np.nan
        for spans in (inside, outside)
    ]
    return means[0], means[1]
