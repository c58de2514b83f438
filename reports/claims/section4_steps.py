"""Sections 4.3 and 5: what decides the integrator's step."""

from __future__ import annotations

from cylcontact.mechanism.loop import FIRST_STEP
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim, listed, with_unit

from ..slider_crank import LAW_NAMES, statistics_table
from .section4_contact import BASIS, LARGE, SMALL, against_sphere
from .trends import RUNS, as_values, changes, rule, shown, tally, trend

STEP = (
    "mean step over a revolution by CVODE's Adams method with contact found by root, where the "
    "paper controls the step by the penetration at onset; an event's second row is no step, but "
    f"the short ones after every event count, where the integrator starts anew at {FIRST_STEP:g} s"
)
CAUSES = [
    {"short": "friction", "cause": "friction", "changed": ("friction", 0.0, 0.1)},
    {"short": "dissipation", "cause": "energy dissipation", "changed": ("restitution", 1.0, 0.9)},
    {
        "short": "small-clearance",
        "cause": "a smaller clearance",
        "changed": ("clearance", LARGE, SMALL),
    },
]


@claim(
    "4.3-impacts-need-small-steps",
    "short, hard impacts without losses need smaller time steps",
    paper="smaller",
    rule="smaller in contact for every law and clearance at both tolerances",
)
def contact_needs_small_steps(bench: Bench) -> Finding:
    """Return the mean step in contact over that in flight."""
    table = statistics_table(bench)
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
    table = statistics_table(bench)
    found = against_sphere(table, "step_us", {"friction": [0.0], "restitution": [1.0]})
    return Finding(
        f"smaller {tally(found, -1)}: {shown(found, '{:.2f} µs')}",
        holds=trend(found, -1),
        choice=f"{BASIS}; {STEP}",
        values=as_values(found, "us"),
        rule=f"smaller {rule(found)}",
    )


@claim(
    "4.3-{short}-larger-steps",
    "{cause} makes the integrator's steps larger",
    paper="larger",
    cases=CAUSES,
)
def larger_steps(bench: Bench, changed: tuple[str, float, float], **_texts: str) -> Finding:
    """Return the mean step without and with something that should make it larger."""
    table = statistics_table(bench)
    found = changes(table, "step_us", *changed)
    return Finding(
        f"larger {tally(found, 1)}: {shown(found, '{:.2f} µs')}",
        holds=trend(found, 1),
        choice=f"{BASIS}; {STEP}",
        values=as_values(found, "us"),
        rule=f"larger {rule(found)}",
    )
