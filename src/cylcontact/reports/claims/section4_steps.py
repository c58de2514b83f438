"""Sections 4.3 and 5: what decides the integrator's step."""

from __future__ import annotations

import pandas as pd

from cylcontact.mechanism.loop import FIRST_STEP
from cylcontact.reports.claims.claim import Claim, listed, with_unit
from cylcontact.reports.claims.section4_contact import BASIS, LARGE, SMALL, against_sphere
from cylcontact.reports.claims.trends import RUNS, as_values, changes, rule, shown, tally, trend
from cylcontact.reports.mechanism.runs import LAW_NAMES

STEP = (
    "mean step over a revolution by CVODE's Adams method with contact found by root, where the "
    "paper controls the step by the penetration at onset; an event's second row is no step, but "
    f"the short ones after every event count, where the integrator starts anew at {FIRST_STEP:g} s"
)
CAUSES = {
    "friction": ("4.3-friction-larger-steps", "friction", 0.0, 0.1),
    "energy dissipation": ("4.3-dissipation-larger-steps", "restitution", 1.0, 0.9),
    "a smaller clearance": ("4.3-small-clearance-larger-steps", "clearance", LARGE, SMALL),
}


def claims(table: pd.DataFrame) -> list[Claim]:
    """Return the claims on step sizes."""
    return [
        contact_needs_small_steps(table),
        cylinders_cost_more(table),
        *(larger_steps(table, cause) for cause in CAUSES),
    ]


def contact_needs_small_steps(table: pd.DataFrame) -> Claim:
    """Return the mean step in contact over that in flight."""
    chosen = table[(table["restitution"] == 1.0) & (table["friction"] == 0.0)]
    ratios = {
        f"{LAW_NAMES[r['law']]} at {r['clearance']:g} mm{told}": (
            r[f"mean_step_contact_us{run}"] / r[f"mean_step_flight_us{run}"]
        )
        for run, told in zip(RUNS, ("", ", tighter"), strict=True)
        for r in chosen.to_dict("records")
    }
    return Claim(
        id="4.3-impacts-need-small-steps",
        section="4.3",
        statement="short, hard impacts without losses need smaller time steps",
        paper="smaller",
        ours=f"mean step in contact over that in flight: {listed(ratios, '{:.3f}')}",
        rule="smaller in contact for every law and clearance at both tolerances",
        holds=max(ratios.values()) < 1,
        choice=f"{BASIS}; {STEP}",
        ours_values=with_unit(ratios, "-"),
    )


def cylinders_cost_more(table: pd.DataFrame) -> Claim:
    """Return the mean step by the sphere and by the cylindrical laws, without losses."""
    found = against_sphere(table, "step_us", {"friction": [0.0], "restitution": [1.0]})
    return Claim(
        id="4.3-cylinders-smaller-steps",
        section="4.3",
        statement="without losses cylindrical laws need smaller steps than the spherical one",
        paper="smaller, in particular for cylindrical laws",
        ours=f"smaller {tally(found, -1)}: {shown(found, '{:.2f} µs')}",
        rule=f"smaller {rule(found)}",
        holds=trend(found, -1),
        choice=f"{BASIS}; {STEP}",
        ours_values=as_values(found, "us"),
    )


def larger_steps(table: pd.DataFrame, cause: str) -> Claim:
    """Return the mean step without and with something that should make it larger."""
    name, condition, before, after = CAUSES[cause]
    found = changes(table, "step_us", condition, before, after)
    return Claim(
        id=name,
        section="4.3",
        statement=f"{cause} makes the integrator's steps larger",
        paper="larger",
        ours=f"larger {tally(found, 1)}: {shown(found, '{:.2f} µs')}",
        rule=f"larger {rule(found)}",
        holds=trend(found, 1),
        choice=f"{BASIS}; {STEP}",
        ours_values=as_values(found, "us"),
    )
