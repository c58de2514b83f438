"""Sections 4.3 and 5: forces and penetrations, and Johnson's law against the enhanced one."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim, joined, listed

from ..slider_crank import AGAINST, LAW_NAMES, statistics_table
from .section4_contact import BASIS, SMALL, against_sphere
from .trends import (
    CERTAIN,
    CONDITIONS,
    Change,
    as_values,
    changes,
    rule,
    shown,
    tally,
    told_case,
    trend,
)

# Less is no particular difference.
DIFFERENT = 0.2
FORCE = "force_p99_N"
PERCENTILE = "the force's 99th percentile over the time in contact"
ALIKE = {
    "contact_fraction": "share of time in contact",
    "impacts": "impacts",
    "mean_penetration_um": "mean penetration",
    FORCE: "99 % force",
    "step_us": "step",
}


@claim(
    "4.3-friction-lowers-forces",
    "friction lowers the contact forces",
    paper="reduction",
)
def friction_lowers_forces(bench: Bench) -> Finding:
    """Return forces without and with friction."""
    table = statistics_table(bench)
    found = changes(table, FORCE, "friction", 0.0, 0.1)
    return Finding(
        f"they fall {tally(found, -1)}: {shown(found, '{:.0f} N')}",
        holds=trend(found, -1),
        choice=f"{BASIS}; {PERCENTILE}",
        alternatives=joined(_raised(found), _unsteady(table)),
        values=as_values(found, "N"),
        rule=f"lower {rule(found)}",
    )


def _raised(found: Sequence[Change]) -> str:
    """Say by how much the force rises in the pairs in which it does, most first."""
    rising = sorted((c for c in found if c.relative > 0), key=lambda c: c.relative, reverse=True)
    told = {c.name: f"{c.before:.0f} N → {c.after:.0f} N" for c in rising}
    return f"in the mean it rises in {len(told)} pairs: {listed(told, '{}')}" if told else ""


def _unsteady(table: pd.DataFrame) -> str:
    """Name the cases whose force is not the same at both tolerances."""
    told = {
        told_case({name: row[name] for name in CONDITIONS}): (
            f"{row[FORCE]:.0f} N and {row[FORCE + AGAINST]:.0f} N"
        )
        for row in table.to_dict("records")
        if abs(row[FORCE] - row[FORCE + AGAINST])
        > DIFFERENT * max(row[FORCE], row[FORCE + AGAINST])
    }
    return f"over {DIFFERENT:.0%} apart at the two tolerances: {listed(told, '{}')}" if told else ""


@claim(
    "4.3-cylinders-higher-forces",
    "with friction, too, cylindrical laws give higher forces than the spherical one",
    paper="higher",
)
def cylinders_higher_forces(bench: Bench) -> Finding:
    """Return forces by the sphere and by the cylindrical laws, with friction."""
    table = statistics_table(bench)
    found = against_sphere(table, FORCE)
    return Finding(
        f"higher {tally(found, 1)}: {shown(found, '{:.0f} N')}",
        holds=trend(found, 1),
        choice=f"{BASIS}; {PERCENTILE}",
        values=as_values(found, "N"),
        rule=f"higher {rule(found)}",
    )


@claim(
    "4.3-sphere-deeper",
    "at 0.02 mm Lankarani and Nikravesh's law leads to deeper penetrations",
    paper="higher penetrations",
)
def sphere_deeper(bench: Bench) -> Finding:
    """Return penetrations by the sphere and by the cylindrical laws at the small clearance."""
    table = statistics_table(bench)
    found = against_sphere(
        table, "mean_penetration_um", {"clearance": [SMALL], "friction": [0.0, 0.1]}
    )
    return Finding(
        (
            f"mean penetration with a cylindrical law is lower {tally(found, -1)}: "
            + shown(found, "{:.2f} µm")
        ),
        holds=trend(found, -1),
        choice=BASIS,
        values=as_values(found, "um"),
        rule=f"lower {rule(found)}",
    )


@claim(
    "4.3-johnson-and-enhanced-alike",
    "otherwise Johnson's law and the enhanced one give no particular difference",
    paper="no difference",
    rule=(
        f"none differs {CERTAIN}, and by more than {DIFFERENT:.0%} of the larger in the mean; "
        f"more than half are alike, within {DIFFERENT:.0%} at that confidence"
    ),
)
def johnson_and_enhanced_alike(bench: Bench) -> Finding:
    """Return in what the runs with Johnson's and with the enhanced law differ."""
    table = statistics_table(bench)
    differing: dict[str, str] = {}
    values: dict[str, float] = {}
    count = alike = 0
    for column, name in ALIKE.items():
        for change in changes(table, column, "law", "johnson", "enhanced"):
            count += 1
            alike += abs(change.relative) + change.margin < DIFFERENT
            if change.sign and abs(change.relative) > DIFFERENT:
                case = f"{name}, {change.name}"
                differing[case] = f"{change.before:.3g} → {change.after:.3g}"
                values[f"{case}, change over the larger, -"] = change.relative
    values |= {"numbers compared, -": float(count), "of them different, -": float(len(differing))}
    continued = table[table["continued"] > 0]
    told = [
        f"{LAW_NAMES[r['law']]} at {r['clearance']:g} mm, c_e = {r['restitution']:g}, "
        f"c_f = {r['friction']:g}: {r['continued']:.0f} of {r['onsets']:.0f} contacts, "
        f"{r['left']:.0f} beyond the law's end"
        for r in continued.to_dict("records")
    ]
    return Finding(
        (
            f"{len(differing)} of {count} numbers differ, Johnson → enhanced: "
            + (listed(differing, "{}") or "none")
            + f"; {alike} are alike, {count - alike - len(differing)} undecided"
        ),
        holds=not differing and alike > count / 2,
        choice=f"{BASIS}; compared are {', '.join(ALIKE.values())}",
        alternatives=f"Johnson's law had to be continued along its tangent ({'; '.join(told)})"
        if told
        else "",
        values=values,
    )


@claim(
    "5-elastic-forces-are-large",
    "without dissipation the contact forces become large",
    paper="large",
)
def losses_lower_forces(bench: Bench) -> Finding:
    """Return forces without and with dissipation."""
    table = statistics_table(bench)
    found = changes(table, FORCE, "restitution", 1.0, 0.9)
    return Finding(
        f"with c_e = 0.9 they are lower {tally(found, -1)}: {shown(found, '{:.0f} N')}",
        holds=trend(found, -1),
        choice=f"{BASIS}; {PERCENTILE}",
        values=as_values(found, "N"),
        rule=f"lower with dissipation {rule(found)}",
    )
