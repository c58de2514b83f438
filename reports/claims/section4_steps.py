"""Sections 4.3 and 5: what decides the integrator's step."""

from __future__ import annotations

import pandas as pd

from cylcontact.mechanism.loop import FIRST_STEP
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim, listed, with_unit
from .section4_contact import BASIS, LARGE, SMALL, against_sphere
from .trends import RUNS, as_values, changes, rule, shown, tally, trend
from ..slider_crank import LAW_NAMES

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





@claim(
    "4.3-impacts-need-small-steps",
    "short, hard impacts without losses need smaller time steps",
    paper="smaller",
    rule="smaller in contact for every law and clearance at both tolerances",
)
def contact_needs_small_steps(bench: Bench) -> Finding:
    """Return the mean step in contact over that in flight."""
    chosen = table[(table["restitution"] == 1.0) & (table["friction"] == 0.0)]
    ratios = {
        f"{LAW_NAMES[r['law']]} at {r['clearance']:g} mm{told}": (
            r[f"mean_step_contact_us{run}"] / r[f"mean_step_flight_us{run}"]
        )
        for run, told in zip(RUNS, ("", ", tighter"), strict=True)
        for r in chosen.to_dict("records")
    }
    return Finding(
        f"mean step in contact over that in flight: {listed(ratios, '{:.3f}')}",
        holds=max(ratios.values()) < 1,
        choice=f"{BASIS}; {STEP}",
        values=with_unit(ratios, "-"),
    )


@claim(
    "4.3-cylinders-smaller-steps",
    "without losses cylindrical laws need smaller steps than the spherical one",
    paper="smaller, in particular for cylindrical laws",
)
def cylinders_cost_more(bench: Bench) -> Finding:
    """Return the mean step by the sphere and by the cylindrical laws, without losses."""
    found = against_sphere(table, "step_us", {"friction": [0.0], "restitution": [1.0]})
    return Finding(
        f"smaller {tally(found, -1)}: {shown(found, '{:.2f} µs')}",
        holds=trend(found, -1),
        choice=f"{BASIS}; {STEP}",
        values=as_values(found, "us"),
        rule=f"smaller {rule(found)}",
    )


@claim(
    name,
    f"{cause} makes the integrator's steps larger",
    paper="larger",
)
def larger_steps(bench: Bench, cause: str) -> Finding:
    """Return the mean step without and with something that should make it larger."""
    name, condition, before, after = CAUSES[cause]
    found = changes(table, "step_us", condition, before, after)
    return Finding(
        f"larger {tally(found, 1)}: {shown(found, '{:.2f} µs')}",
        holds=trend(found, 1),
        choice=f"{BASIS}; {STEP}",
        values=as_values(found, "us"),
        rule=f"larger {rule(found)}",
    )
