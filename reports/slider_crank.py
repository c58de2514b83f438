"""The slider-crank of Section 4: its cases, simulated when they are needed, and caption notes.

A few revolutions are simulated here whenever a figure draws them. Statistics come from `long_runs`,
which keeps them in datasets/mechanism/long_runs.jsonl: deleting that file computes them anew.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
from scipy.integrate import quad

from cylcontact.bodies.pair import CylinderPair
from cylcontact.joint.clearance import TANGENT_FROM
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
from cylcontact.plots.style import COLOURS, LINE_STYLES, MARKERS
from cylcontact.reports.bench import Bench, MissingInputError
from cylcontact.support.arrays import FloatArray

from .paper import FRICTIONS, JOINT_CLEARANCES, JOINT_LAWS, RESTITUTIONS

# The paper's laws and the one that we recommend, with its cases and those of Sect. 4.3.
RECOMMENDED = "explicit"
LAW_NAMES = {**JOINT_LAWS, RECOMMENDED: "explicit"}
CASES = tuple(cases(LAW_NAMES, JOINT_CLEARANCES, RESTITUTIONS, FRICTIONS))
PAPER_CASES = tuple(case for case in CASES if case.law in JOINT_LAWS)

# Penetrations at which laws are compared: decades below the largest, and how many points.
DECADES, POINTS = 2.0, 801
SPEC = "datasets/slider_crank.toml"
# Longest step in s of the runs that are drawn, so that curves are smooth from step to step.
DRAWN_STEP = 4e-6


def mechanism(bench: Bench, case: Case | None = None) -> Mechanism:
    """Return the mechanism of the bench's spec, or a case of it."""
    rule, remedy = "this spec does not exist", "cylcontact init lays out a bench that has it"
    file = bench.required(SPEC, rule, remedy)
    return read_mechanism(file, **({} if case is None else vars(case)))


def simulated(
    bench: Bench, case: Case, revolutions: int, max_step: float | None = DRAWN_STEP
) -> Trajectory:
    """Return a case's run; beyond its domain the law continues along its tangent.

    The longest step in s is that of the spec if `max_step` is None.
    """
    model = mechanism(bench, case)
    integration = model.data["integration"]
    if max_step is not None:
        integration = {**integration, "max_step": max_step}
    model = mechanism_from({**model.data, "integration": integration}, model.source)
    return simulate(model, revolutions=revolutions, beyond="tangent")


def law_limit(mechanism: Mechanism) -> float:
    """Return the largest penetration of the mechanism's contact law in mm, inf without one."""
    contact = mechanism.clearance.contact
    return float(contact.law.max_penetration(contact.pair))


def limit_reached(mechanism: Mechanism) -> float:
    """Return the penetration in mm from which an impact would pass the end of the law, inf without.

    The joint's tangent is softer than the law, so that an impact goes deeper by it: to where it has
    taken the work that the law takes up to its end.
    """
    end = law_limit(mechanism)
    if end == np.inf:
        return end
    contact = mechanism.clearance.contact
    start, load, slope = (
        float(contact.block[name]) for name in ("last_penetration", "last_load", "last_slope")
    )
    work, _ = quad(lambda depth: float(contact.law.load(depth, contact.pair)), start, end)
    return start + (math.sqrt(load**2 + 2 * slope * work) - load) / slope


def assumed(mechanism: Mechanism) -> str:
    """Return a sentence on what is assumed in a mechanism, in the units of its spec."""
    joint = mechanism.clearance
    owner = "ground" if joint.i < 0 else mechanism.bodies[joint.i].name
    parts = [
        *(_body(mechanism, body) for body in mechanism.bodies),
        f"friction from {joint.contact.v0:g} to {joint.contact.v1:g} mm/s (Eq 15)",
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
        f"is continued along its tangent: {'; '.join(continued)}."
    )


def _continued_contacts(run: Trajectory) -> str:
    """Return the number of contacts of a run that were continued, as text, or nothing."""
    deepest = run.contacts["max_penetration_m"].to_numpy() * 1e3
    limit = law_limit(run.mechanism)
    continued = int((deepest > TANGENT_FROM * limit).sum())
    if not continued:
        return ""
    contact = run.joint.contact
    restitution = contact.data["dissipation"]["restitution"]
    case = f"c_e = {restitution:g}, c_f = {contact.friction:g}"
    left = int((deepest > limit_reached(run.mechanism)).sum())
    return (
        f"{LAW_NAMES[contact.law.name]} at {case}, {continued} of {deepest.size} contacts, {left} "
        f"of them with more work than the law takes up to its end at {limit * 1e3:.4g} µm"
    )


def horizons(bench: Bench, clearance: float) -> str:
    """Return a sentence on how long two tolerances agree, or on how to find out."""
    columns = ("clearance_mm", "against", "tolerance", "revolutions", "horizon_revolutions")
    try:
        table = bench.table("datasets/mechanism/cases.csv", columns, "make mechanism writes it")
    except MissingInputError:
        return "How long two tolerances agree, make mechanism finds out."
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
    number = list(LAW_NAMES).index(law)
    return {
        "color": COLOURS[number],
        "linestyle": LINE_STYLES[number],
        "marker": MARKERS[number],
    }
