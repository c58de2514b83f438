"""The slider-crank of Section 4: its cases, simulated when they are needed, and caption notes."""

from __future__ import annotations

import json
from contextlib import closing
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import pandas as pd

from cylcontact.arrays import FloatArray
from cylcontact.laws import LAWS
from cylcontact.mechanism import (
    Case,
    Mechanism,
    Trajectory,
    cases,
    mechanism_from,
    read_mechanism,
    simulate,
)
from cylcontact.mechanism.model import Body
from cylcontact.mechanism.system import TANGENT_FROM
from cylcontact.pair import CylinderPair
from cylcontact.parallel import call, run_calls
from cylcontact.plots.style import COLOURS, LINE_STYLES, MARKERS
from cylcontact.reports.bench import Bench, MissingInputError, call_in_bench

from .paper import FRICTIONS, JOINT_CLEARANCES, JOINT_LAWS, RESTITUTIONS

# The cases of Sect. 4.3.
CASES = tuple(cases(JOINT_LAWS, JOINT_CLEARANCES, RESTITUTIONS, FRICTIONS))

# Statistics omit the first revolutions: the journal starts at rest in the centre, and impacts make
# two tolerances diverge, if at all, within 1.5 revolutions (datasets/mechanism/cases.csv).
REVOLUTIONS, FIRST = 8, 3
# Without dissipation, friction drives the journal round along the wall of a small clearance. Such a
# whirl lasts for some twenty revolutions in the mean, stops and comes back, so that these few
# revolutions are one sample of it; `long_run` over a thousand gives an interval.
WHIRLING = Case("", min(JOINT_CLEARANCES), 1.0, 0.1)
WHIRLING_REVOLUTIONS = 16
# Tolerance of a case's second run, relative to the spec's.
TIGHTER = 0.1
AGAINST = "_against"
# Penetrations at which laws are compared: decades below the largest, and how many points.
DECADES, POINTS = 2.0, 801
SPEC = "datasets/slider_crank.toml"
# Longest step in s of the runs that are drawn, so that curves are smooth from step to step.
DRAWN_STEP = 2e-6
_STATISTICS: dict[str, pd.DataFrame] = {}
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
    """Return the mechanism of the bench's spec, or a case of it."""
    file = bench.input(SPEC)
    if not file.is_file():
        rule, remedy = "this spec does not exist", "cylcontact init lays out a bench that has it"
        raise MissingInputError(str(file), "", None, rule, remedy)
    return read_mechanism(file, **({} if case is None else vars(case)))


def simulated(
    bench: Bench, case: Case, revolutions: int, max_step: float | None = DRAWN_STEP
) -> Trajectory:
    """Return a case's run, cached; beyond its domain the law continues along its tangent.

    The longest step in s is that of the spec if `max_step` is None.
    """
    model = mechanism(bench, case)
    if max_step is not None:
        model.data["integration"]["max_step"] = max_step
    return _simulated(json.dumps(model.data), model.source, revolutions)


@lru_cache(maxsize=12)
def _simulated(data: str, source: str, revolutions: int) -> Trajectory:
    """Simulate the mechanism of a spec's data, which are hashable as JSON."""
    model = mechanism_from(json.loads(data), source)
    return simulate(model, revolutions=revolutions, beyond="tangent")


def revolutions_of(case: Case) -> int:
    """Return the number of revolutions of a case's run."""
    whirls = replace(case, law="") == WHIRLING
    return WHIRLING_REVOLUTIONS if whirls else REVOLUTIONS


def statistics_table(bench: Bench) -> pd.DataFrame:
    """Run all 24 cases at two tolerances and return their statistics, which are cached.

    The columns are those of `Case`, the values of `case_row` at the spec's tolerance, and the same
    at the tighter one (names end in `AGAINST`).
    """
    data = json.dumps(mechanism(bench).data)
    if data not in _STATISTICS:
        module = __name__.rpartition(".")[2]
        calls = [call(call_in_bench, bench.root, module, "run_case", data, case) for case in CASES]
        with closing(run_calls(calls, bench.jobs)) as rows:
            _STATISTICS[data] = pd.DataFrame(list(rows))
    return _STATISTICS[data].copy()


def run_case(data: str, case: Case) -> dict[str, object]:
    """Run one case of the mechanism whose spec's data are given as JSON, and return its row."""
    model = mechanism_from(json.loads(data), "mechanism", **vars(case))
    revolutions, tolerance = revolutions_of(case), model.integration.tolerance
    row, second = (
        case_row(simulate(model, revolutions=revolutions, tolerance=value, beyond="tangent"))
        for value in (tolerance, TIGHTER * tolerance)
    )
    return vars(case) | row | {f"{name}{AGAINST}": value for name, value in second.items()}


def case_row(run: Trajectory, first: int = FIRST) -> dict[str, float]:
    """Return a run's numbers: means over the revolutions from `first` on, and their scatter.

    Besides `STATISTICS` and their standard deviations (`_std`): the number of revolutions
    `counted`; the mean step; the mean durations of a contact and a flight (NaN where there is
    none); over the whole run the `onsets`, the contacts `continued` along the law's tangent and
    those that `left` its domain; and `energy_error`, relative to the peak kinetic energy.
    """
    statistics = run.statistics(first)
    steps = run.mechanism.period * 1e6 / statistics.by_revolution["steps"]
    row = {name: float(statistics.mean[name]) for name in STATISTICS}
    row |= {f"{name}_std": float(statistics.scatter[name]) for name in STATISTICS}
    deepest = run.contacts["max_penetration_m"].to_numpy() * 1e3
    limit = law_limit(run.mechanism)
    inside, outside = _durations(run, first * run.mechanism.period)
    return row | {
        "counted": float(len(statistics.by_revolution)),
        "step_us": float(steps.mean()),
        "step_us_std": float(steps.std()),
        "contact_us": inside,
        "flight_us": outside,
        "onsets": float(len(run.contacts)),
        "continued": float((deepest > TANGENT_FROM * limit).sum()),
        "left": float((deepest > limit).sum()),
        "energy_error": float(np.abs(run.energy_error).max() / run.kinetic_energy.max()),
    }


def law_limit(mechanism: Mechanism) -> float:
    """Return the largest penetration of the mechanism's contact law in mm, inf without one."""
    joint = mechanism.clearance
    return np.inf if joint.pair is None else float(joint.law.max_penetration(joint.pair))


def _durations(run: Trajectory, begin: float) -> tuple[float, float]:
    """Return the mean durations in µs of the contacts and flights after a time in s."""
    onset = run.contacts["onset_s"].to_numpy()
    release = run.contacts["release_s"].to_numpy()
    inside = (release - onset)[onset >= begin]
    outside = (onset[1:] - release[:-1])[release[:-1] >= begin]
    means = [
        float(np.nanmean(spans)) * 1e6 if np.isfinite(spans).any() else np.nan
        for spans in (inside, outside)
    ]
    return means[0], means[1]


def assumed(mechanism: Mechanism) -> str:
    """Return a sentence on what is assumed in a mechanism, in the units of its spec."""
    joint = mechanism.clearance
    owner = "ground" if joint.i < 0 else mechanism.bodies[joint.i].name
    parts = [
        *(_body(mechanism, body) for body in mechanism.bodies),
        f"friction from {joint.v0 * 1e3:g} to {joint.v1 * 1e3:g} mm/s (Eq 15)",
        f"the bearing is the {owner}'s",
        "at the start the journal is centred and at rest in it",
    ]
    return "Assumed, as the paper's Table 2 is not at hand: " + "; ".join(parts) + "."


def _body(mechanism: Mechanism, body: Body) -> str:
    """Return a body's mass, and its length and inertia where they matter."""
    places = list(mechanism.data["bodies"][body.name]["points"].values())
    if len(places) < 2:
        return f"{body.name} {body.mass:g} kg"
    length = float(np.hypot(*np.subtract(places[0], places[1]))) * 1e3
    return f"{body.name} {length:g} mm, {body.mass:g} kg, {body.inertia:g} kg m²"


def law_ends(runs: list[Trajectory]) -> str:
    """Return a sentence on the runs whose law was continued along its tangent."""
    continued = [text for run in runs if (text := _continued_contacts(run))]
    if not continued:
        return "No law leaves its domain in these runs."
    return (
        f"Where a penetration passes {TANGENT_FROM:g} of the law's largest one (Eq 8), the law "
        f"goes on along its tangent: {'; '.join(continued)}."
    )


def _continued_contacts(run: Trajectory) -> str:
    """Return the number of contacts of a run that were continued, as text, or nothing."""
    deepest = run.contacts["max_penetration_m"].to_numpy() * 1e3
    limit = law_limit(run.mechanism)
    continued = int((deepest > TANGENT_FROM * limit).sum())
    if not continued:
        return ""
    joint, data = run.mechanism.clearance, run.mechanism.data["clearance"]
    case = f"c_e = {data['restitution']:g}, c_f = {joint.friction:g}"
    left = int((deepest > limit).sum())
    return (
        f"{data['law']} at {case}, {continued} of {deepest.size} contacts, "
        f"{left} of them beyond the limit of {limit * 1e3:.4g} µm"
    )


def horizons(bench: Bench, clearance: float) -> str:
    """Return a sentence on how long two tolerances agree, or on how to find out."""
    file = bench.input("datasets/mechanism/cases.csv")
    if not file.is_file():
        return "How long two tolerances agree, make mechanism finds out."
    table = pd.read_csv(file)
    rows = table[np.isclose(table["clearance_mm"], clearance)]
    tight, whole = float(rows["against"].iloc[0]), float(rows["revolutions"].iloc[0])
    short = rows.loc[rows["horizon_revolutions"] < whole, "horizon_revolutions"]
    text = f"Tolerances of {float(rows['tolerance'].iloc[0]):g} and {tight:g} agree over all "
    text += f"{whole:g} revolutions in {len(rows) - len(short)} of the {len(rows)} cases"
    if short.empty:
        return f"{text}."
    return f"{text}, and for {short.min():.2g} to {short.max():.2g} revolutions in the others."


def force_ratio(law: str, other: str, pair: CylinderPair, deepest: float) -> pd.DataFrame:
    """Return the ratio of two laws' forces at equal penetration, up to the largest one in mm."""
    penetration = np.geomspace(deepest * 10**-DECADES, deepest, POINTS)
    ratio = total_force(law, penetration, pair) / total_force(other, penetration, pair)
    return pd.DataFrame({"penetration_mm": penetration, "ratio": ratio})


def crossings(table: pd.DataFrame) -> list[float]:
    """Return the penetrations in mm at which the ratio of `force_ratio` passes 1."""
    x, excess = table["penetration_mm"].to_numpy(), table["ratio"].to_numpy() - 1
    at = np.flatnonzero(excess[:-1] * excess[1:] < 0)
    share = excess[at] / (excess[at] - excess[at + 1])
    return [float(value) for value in x[at] + share * (x[at + 1] - x[at])]


def total_force(law: str, penetration: FloatArray, pair: CylinderPair) -> FloatArray:
    """Return a law's elastic force in N at penetrations in mm, over the pair's whole length."""
    return LAWS[law]().load(penetration, pair) * pair.contact_length("a force")


def law_style(law: str) -> dict[str, Any]:
    """Return the colour, line style and marker of a law."""
    number = list(JOINT_LAWS).index(law)
    return {
        "color": COLOURS[number],
        "linestyle": LINE_STYLES[number],
        "marker": MARKERS[number],
    }
