"""What a caption has to say of a run: what is assumed, and where a law was continued."""

from __future__ import annotations

import numpy as np
import pandas as pd

from cylcontact.mechanism import Mechanism, Trajectory
from cylcontact.mechanism.model import Body
from cylcontact.mechanism.system import TANGENT_FROM
from cylcontact.reports.bench import Bench
from cylcontact.reports.mechanism.runs import law_limit


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
