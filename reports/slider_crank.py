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

# Statistics leave the first revolutions out: the journal starts at rest in the centre, and impacts
# separate two tolerances, where they do, within 1.5 revolutions (datasets/mechanism/cases.csv).
REVOLUTIONS, FIRST = 8, 3
# Without dissipation, friction drives the journal round along the wall of a small clearance. That
# lasts for a number of revolutions that hangs on every digit, then stops for good.
WHIRLING = Case("", min(JOINT_CLEARANCES), 1.0, 0.1)
WHIRLING_REVOLUTIONS = 16
# The second run of a case has the spec's tolerance times this.
TIGHTER = 0.1
AGAINST = "_against"
# The penetrations at which laws are compared: decades below the deepest, and how many.
DECADES, POINTS = 2.0, 801
SPEC = "datasets/slider_crank.toml"
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
    MissingInputError
        If there is no spec.
    InputError
        If the spec is wrong.
    """
    file = bench.input(SPEC)
    if not file.is_file():
        rule, remedy = "this spec does not exist", "cylcontact init lays out a bench that has it"
        raise MissingInputError(str(file), "", None, rule, remedy)
    return read_mechanism(file, **({} if case is None else vars(case)))


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


def statistics_table(bench: Bench) -> pd.DataFrame:
    """Run all 24 cases at two tolerances and return their statistics, which are remembered.

    Parameters
    ----------
    bench : Bench
        Where the spec is; its `jobs` run the cases.

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
        module = __name__.rpartition(".")[2]
        calls = [call(call_in_bench, bench.root, module, "run_case", data, case) for case in CASES]
        with closing(run_calls(calls, bench.jobs)) as rows:
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
    >>> bench = Bench(Path())
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
    >>> one = mechanism(Bench(Path()), Case("johnson", 0.02, 0.9, 0.1))
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


def assumed(one: Mechanism) -> str:
    """Return a sentence on what is assumed in a mechanism, in the units of its spec.

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism
    >>> print(assumed(read_mechanism("datasets/slider_crank.toml")))
    Assumed, as the paper's Table 2 is not at hand: crank 50 mm, 0.3 kg, 0.0001 kg m²; rod 120 mm,
    0.21 kg, 0.00025 kg m²; slider 0.14 kg; friction from 1 to 10 mm/s (Eq 15); the bearing is the
    rod's; at the start the journal is centred and at rest in it.
    """
    joint = one.clearance
    owner = "ground" if joint.i < 0 else one.bodies[joint.i].name
    parts = [
        *(_body(one, number) for number in range(len(one.bodies))),
        f"friction from {joint.v0 * 1e3:g} to {joint.v1 * 1e3:g} mm/s (Eq 15)",
        f"the bearing is the {owner}'s",
        "at the start the journal is centred and at rest in it",
    ]
    return "Assumed, as the paper's Table 2 is not at hand: " + "; ".join(parts) + "."


def _body(one: Mechanism, number: int) -> str:
    """Return a body's length, mass and inertia, without what plays no part."""
    body: Body = one.bodies[number]
    places = list(one.data["bodies"][body.name]["points"].values())
    if len(places) < 2:
        return f"{body.name} {body.mass:g} kg"
    length = float(np.hypot(*np.subtract(places[0], places[1]))) * 1e3
    return f"{body.name} {length:g} mm, {body.mass:g} kg, {body.inertia:g} kg m²"


def law_ends(runs: list[Trajectory]) -> str:
    """Return a sentence on the runs whose law was continued along its tangent; else on none.

    Parameters
    ----------
    runs : list of Trajectory
        Runs with `beyond="tangent"`.
    """
    told = [continued_contacts(run) for run in runs]
    told = [text for text in told if text]
    if not told:
        return "No law leaves its domain in these runs."
    return (
        f"Where a penetration passes {TANGENT_FROM:g} of the law's largest one (Eq 8), the law "
        f"goes on along its tangent: {'; '.join(told)}."
    )


def continued_contacts(run: Trajectory) -> str:
    """Return how many contacts of a run were continued, or nothing."""
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
    """Return a sentence on how long two tolerances agree, by the bench's table of cases.

    Parameters
    ----------
    bench : Bench
        Without the table, the sentence says how to make it.
    clearance : float
        In mm.

    Examples
    --------
    >>> from pathlib import Path
    >>> horizons(Bench(Path("nowhere")), 0.5)
    'How long two tolerances agree, make mechanism finds out.'
    """
    file = bench.input("datasets/mechanism/cases.csv")
    if not file.is_file():
        return "How long two tolerances agree, make mechanism finds out."
    table = pd.read_csv(file)
    rows = table[np.isclose(table["clearance_mm"], clearance)]
    tight, whole = float(rows["against"].iloc[0]), float(rows["revolutions"].iloc[0])
    short = rows.loc[rows["horizon_revolutions"] < whole, "horizon_revolutions"]
    told = f"Tolerances of {float(rows['tolerance'].iloc[0]):g} and {tight:g} agree over all "
    told += f"{whole:g} revolutions in {len(rows) - len(short)} of the {len(rows)} cases"
    if short.empty:
        return f"{told}."
    return f"{told}, and for {short.min():.2g} to {short.max():.2g} revolutions in the others."


def force_ratio(one: str, other: str, pair: CylinderPair, deepest: float) -> pd.DataFrame:
    """Compare the forces of two laws at equal penetration.

    Parameters
    ----------
    one, other : str
        Laws.
    pair : CylinderPair
        The joint.
    deepest : float
        The largest penetration in mm; the smallest is `DECADES` below it.

    Returns
    -------
    pandas.DataFrame
        Columns penetration_mm and ratio, that of `one` over `other`; NaN beyond a law's domain.

    Examples
    --------
    >>> from cylcontact import Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.5, material=steel, length=10.0)
    >>> ratio = force_ratio("lankarani-nikravesh", "johnson", pair, 0.05)["ratio"]
    >>> print(ratio.max().round(3))
    0.536
    """
    penetration = np.geomspace(deepest * 10**-DECADES, deepest, POINTS)
    ratio = total_force(one, penetration, pair) / total_force(other, penetration, pair)
    return pd.DataFrame({"penetration_mm": penetration, "ratio": ratio})


def crossings(table: pd.DataFrame) -> list[float]:
    """Return the penetrations in mm at which the ratio of `force_ratio` passes 1.

    Examples
    --------
    >>> crossings(pd.DataFrame({"penetration_mm": [1.0, 2.0, 3.0], "ratio": [0.5, 1.5, 2.0]}))
    [1.5]
    """
    x, excess = table["penetration_mm"].to_numpy(), table["ratio"].to_numpy() - 1
    at = np.flatnonzero(excess[:-1] * excess[1:] < 0)
    share = excess[at] / (excess[at] - excess[at + 1])
    return [float(value) for value in x[at] + share * (x[at + 1] - x[at])]


def total_force(law: str, penetration: FloatArray, pair: CylinderPair) -> FloatArray:
    """Return a law's elastic force in N at penetrations in mm, over the pair's whole length."""
    return LAWS[law]().load(penetration, pair) * pair.contact_length("a force")


def law_style(law: str) -> dict[str, Any]:
    """Return the colour, line style and marker of a law.

    Examples
    --------
    >>> law_style("johnson")["linestyle"]
    '--'
    """
    number = list(JOINT_LAWS).index(law)
    return {
        "color": COLOURS[number],
        "linestyle": LINE_STYLES[number],
        "marker": MARKERS[number],
    }
