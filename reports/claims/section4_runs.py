"""Sections 4.3 and 5: contacts, forces and steps in the runs of the slider-crank."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import pandas as pd

from cylcontact.mechanism import Case
from cylcontact.reports.bench import Bench, MissingInputError
from cylcontact.reports.claims import Finding, claim, joined
from cylcontact.reports.claims import Reading as Found
from cylcontact.support.progress import Progress

from ..long_runs import FEW, FIRST, MANY, SETS, SHORT, long_runs
from ..paper import INTEGRATOR, JOINT_CLEARANCES, JOINT_LAWS, TABLE_2, WINDOW
from ..slider_crank import law_limit, mechanism
from ..trends import (
    ALL,
    EQUAL,
    SCATTER,
    Conditions,
    Judge,
    Reading,
    above,
    case_name,
    change_of,
    compare,
    cylinders,
    every,
    finding,
    integrators,
    majority,
    sets,
    start,
    windows,
)
from .section4 import largest_forces

CYLINDERS = list(JOINT_LAWS)[1:]
LARGE, SMALL = JOINT_CLEARANCES
CONTINUOUS = 0.99  # share of the time from which contact counts as continuous (ours)
MOSTLY = 0.5
# Of mean penetrations, forces, ...: ours, within it numbers do not differ in particular.
ALIKE = 0.2
OURS = "our masses and lengths"
BASIS = f"{OURS}; {MANY} revolutions after the first {FIRST}"
# With runs without losses among them, and of these alone.
MIXED = f"{BASIS}, {FEW} without losses"
HORIZON = f"{OURS}; {FEW} revolutions after the first {FIRST}, as no lossless run is steady"
FIGURES = ("fig_mechanism_cases",)

ELASTIC: Conditions = {"restitution": [1.0]}
LOSSY: Conditions = {"restitution": [0.9]}
DRY: Conditions = {"friction": [0.0]}
ROUGH: Conditions = {"friction": [0.1]}
WIDE: Conditions = {"clearance": [LARGE]}
NARROW: Conditions = {"clearance": [SMALL]}
LOSSLESS: Conditions = {**ELASTIC, **DRY}
SMALLER, LARGER = ("clearance", LARGE, SMALL), ("clearance", SMALL, LARGE)
ALL_LOSSES = "all losses (c_e 1 and 0.9, c_f 0 and 0.1)"
ROUGHER, LOSSIER = ("friction", 0.0, 0.1), ("restitution", 1.0, 0.9)


def prepare(bench: Bench, progress: Progress) -> None:
    """Run what the journal of long runs lacks."""
    try:
        long_runs(bench, progress)
    except MissingInputError:
        return  # Each claim says so.


def among(table: pd.DataFrame, chosen: Conditions) -> pd.DataFrame:
    """Return the cases with the chosen conditions."""
    for key, values in chosen.items():
        table = table[table[key].isin(list(values))]
    return table


def judged(
    bench: Bench,
    judge: Judge,
    more: Sequence[Reading] = (),
    choice: str = "",
    basis: str = BASIS,
) -> Finding:
    """Return the finding of a judgement, with other words, inertias and windows."""
    lossless = basis != BASIS
    missing = f"{TABLE_2} and {WINDOW}" if lossless else TABLE_2
    own = Reading(joined(choice, basis), judge, missing=missing)
    others = [*more, *sets(judge), *(windows(judge) if lossless else [])]
    return finding(bench, [own, *others])


def cases_above(chosen: Conditions, bound: float, rule: Callable[..., bool | None]) -> Judge:
    """Return the judgement of cases that are in contact for at least a share of the time."""

    def judge(table: pd.DataFrame) -> Finding:
        rows = among(table, chosen)
        shares = rows["contact_fraction"].to_list()
        found = [
            above(*pair, bound)
            for pair in zip(shares, rows["contact_fraction_half_width"], strict=True)
        ]
        count, total, holds = found.count(True), len(found), rule(found)
        lowest = f"{100 * min(shares):.3g} %"
        values = {
            f"{case_name({k: row[k] for k in ('law', 'clearance', 'restitution', 'friction')})}, "
            "share of time": row["contact_fraction"]
            for row in rows.to_dict("records")
        }
        ours = f"all {total} trajectories are in contact all the time"
        if lowest != "100 %":
            ours = (
                f"{count} of {total} trajectories are in contact at least {100 * bound:g} % of "
                f"the time; the lowest share is {lowest}"
            )
        miss = "" if holds is not False else f"{count} of {total}, the lowest share {lowest}"
        return Finding(ours, holds, miss=miss, values=values)

    return judge


# Contacts and flights.


@claim(
    "4.3-longer-flights",
    "without losses all laws predict longer free flights at the larger clearance",
    paper="longer",
    rule=SCATTER,
    figures=("fig18", "fig19", *FIGURES),
)
def longer_flights(bench: Bench) -> Finding:
    """Return the mean duration of a flight in µs at both clearances."""
    judge = change_of("flight_us", LARGER, 1, LOSSLESS, "longer at 0.5 mm")
    return judged(bench, judge, choice="the mean duration of a flight", basis=HORIZON)


@claim(
    "4.3-dissipation-keeps-contact",
    "with c_e = 0.9 and without friction most trajectories show continuous contact",
    paper="most",
    rule="more than half of the six trajectories",
    figures=("fig18", "fig19", *FIGURES),
)
def dissipation_keeps_contact(bench: Bench) -> Finding:
    """Return how many cases with dissipation are in contact nearly all the time."""
    chosen = {**LOSSY, **DRY}
    judge = cases_above(chosen, CONTINUOUS, majority)
    part = cases_above(chosen, MOSTLY, every)
    ground = "'most of the trajectories' may be the greater part of each"
    greater = Reading("the greater part of each trajectory is in contact", part, ground=ground)
    more = [greater, start(judge)]
    return judged(bench, judge, more, f"continuous: {100 * CONTINUOUS:g} % of the time, ours")


@claim(
    "4.3-friction-keeps-contact",
    "with friction the trajectories are mostly in contact",
    paper="mostly in contact",
    rule="at 0.5 mm half of the time or more with every law",
    figures=("fig18", *FIGURES),
)
def friction_keeps_contact(bench: Bench) -> Finding:
    """Return the share of the time in contact with friction at 0.5 mm."""
    judge = cases_above({**WIDE, **LOSSY, **ROUGH}, MOSTLY, every)
    elastic = cases_above({**WIDE, **ELASTIC, **ROUGH}, MOSTLY, every)
    ground = "Sect. 5 says the same of elastic runs"
    more = [Reading("friction added to c_e = 1", elastic, ground=ground), start(judge)]
    return judged(bench, judge, more, "friction added to c_e = 0.9")


# Forces and penetrations, and Johnson's law against the enhanced one.


@claim(
    "4.3-friction-lowers-forces",
    "friction lowers the contact forces",
    paper="reduction",
    rule=ALL,
    figures=("fig18", *FIGURES),
)
def friction_lowers_forces(bench: Bench) -> Finding:
    """Return forces in N without and with friction at 0.5 mm."""

    def judge(column: str, chosen: Conditions) -> Judge:
        cases = {**WIDE, **chosen}
        return change_of(column, ROUGHER, -1, cases, "lower with friction")

    elastic = Reading("friction added to c_e = 1", judge("mean_force_N", ELASTIC))
    more = [start(judge("mean_force_N", LOSSY)), elastic]
    choice = "mean force in contact, friction added to c_e = 0.9 at 0.5 mm"
    return judged(bench, judge("mean_force_N", LOSSY), more, choice)


@claim(
    "4.3-sphere-deeper",
    "at 0.02 mm Lankarani and Nikravesh's law leads to deeper penetrations",
    paper="higher penetrations",
    rule=ALL,
    figures=("fig19", *FIGURES),
)
def sphere_deeper(bench: Bench) -> Finding:
    """Return mean penetrations in µm by the sphere and by the cylindrical laws at 0.02 mm."""
    chosen: Conditions = {**NARROW, **LOSSY}
    words = "deeper with Lankarani–Nikravesh"
    judge = cylinders("mean_penetration_um", -1, chosen, words)
    return judged(bench, judge, choice="mean penetration; c_e = 0.9")


COMPARED = {
    "contact_fraction": "share of time in contact",
    "impacts": "number of impacts",
    "mean_penetration_um": "mean penetration",
    "mean_force_N": "mean force",
}


def alike(chosen: Conditions) -> Judge:
    """Return the judgement whether the runs with Johnson's and the enhanced law agree."""

    def judge(table: pd.DataFrame) -> Finding:
        changes = {
            f"{name} {change.name}".strip(): change
            for column, name in COMPARED.items()
            for change in compare(table, column, "law", "johnson", "enhanced", chosen)
        }
        name, largest = max(changes.items(), key=lambda pair: abs(pair[1].relative))
        for friction, words in (("c_f = 0.1", "with friction"), ("c_f = 0", "without friction")):
            name = name.replace(friction, words)
        apart = [c for c in changes.values() if abs(c.relative) - c.margin > ALIKE]
        near = [c for c in changes.values() if abs(c.relative) + c.margin <= ALIKE]
        percent = replace(largest, name="").percent
        return Finding(
            f"{len(near)} of {len(changes)} numbers agree within {100 * ALIKE:g} %; furthest "
            f"apart: {name}, {percent}",
            holds=False if apart else len(near) == len(changes) or None,
            miss=f"differing: {len(apart)} of {len(changes)}, most by {percent}" if apart else "",
            values={f"{each}, change, -": c.relative for each, c in changes.items()},
        )

    return judge


@claim(
    "4.3-johnson-and-enhanced-alike",
    "apart from that, Johnson's law and the enhanced one give no particular difference",
    paper="no difference",
    rule=f"{', '.join(COMPARED.values())} differ by at most {100 * ALIKE:g} % (ours)",
    figures=("fig18", *FIGURES),
)
def johnson_and_enhanced_alike(bench: Bench) -> Finding:
    """Return how far runs with Johnson's and with the enhanced law differ."""
    return judged(bench, alike({**WIDE, **LOSSY}), choice="0.5 mm, c_e = 0.9")


@claim(
    "4.3-johnson-within-its-domain",
    "Johnson's law can be used in the runs of Figs 17 to 19 (no limit is mentioned there)",
    paper="used in all of them",
    rule="no penetration at 0.02 mm passes Eq 8's limit",
    figures=("fig17", "fig19"),
)
def johnson_within_its_domain(bench: Bench) -> Finding:
    """Return the deepest penetration in µm by Johnson's law at 0.02 mm."""
    limit = 1e3 * law_limit(mechanism(bench, Case("johnson", SMALL, 0.9, 0.0)))
    elastic: Conditions = {**ELASTIC, **ROUGH}
    groups = {
        " with c_e = 1 and no friction": LOSSLESS,
        " with c_e = 1 and friction": elastic,
        " with c_e = 0.9": LOSSY,
    }

    def judge(chosen: Conditions) -> Judge:
        def of(table: pd.DataFrame) -> Finding:
            rows = among(table, {**NARROW, "law": ["johnson"], **chosen})
            left, deepest = float(rows["left"].max()), float(rows["deepest_um"].max())
            found = {name: among(rows, losses) for name, losses in groups.items()}
            parts = [
                f"{group['deepest_um'].max():.3g} µm{name} ({_passed(group)})"
                for name, group in ({"": rows} if chosen else found).items()
            ]
            return Finding(
                f"Eq 8's limit is a penetration of {limit:.2f} µm; the deepest is "
                f"{', '.join(parts)}",
                holds=left == 0,
                miss="" if left == 0 else f"by {deepest - limit:.2g} µm",
                values={
                    "deepest, um": deepest,
                    "limit, um": limit,
                    "left, share of revolutions": left,
                },
            )

        return of

    lossy = judge(LOSSY)
    more = [
        Reading("c_e = 0.9", lossy, ground="the captions of Figs 17 to 19 are of c_e = 0.9"),
        *(replace(each, choice=f"c_e = 0.9, {each.choice}") for each in sets(lossy)),
    ]
    choice = f"all runs at 0.02 mm, from the start; without losses {FIRST + FEW} revolutions"
    return judged(bench, judge({}), more, choice)


def _passed(rows: pd.DataFrame) -> str:
    """Return in how many revolutions the run that is most often past a limit is past it."""
    left, counted = max(zip(rows["left"], rows["counted"], strict=True))
    total = FIRST + counted
    return f"past it in {left * total:.0f} of {total} revolutions" if left else "never past it"


@claim(
    "5-sphere-underestimates-forces",
    "a spherical law underestimates the contact forces of cylinders",
    paper="forces underestimated",
    rule=f"lower than a cylindrical law's; {EQUAL}",
    figures=("fig17", *FIGURES),
)
def sphere_underestimates_forces(bench: Bench) -> Finding:
    """Return the largest forces in N of one and the same impact, and those of long runs."""
    own, *others = [(design, largest_forces(bench, design)) for design in SETS]
    return replace(
        own[1],
        choice=f"largest force of the first impact at c_e = 0.9, {OURS}",
        missing=TABLE_2,
        alternatives=[
            Found(SHORT[design], got.ours, got.holds, TABLE_2, got.miss) for design, got in others
        ],
    )


# The integrator's steps.
STEPS = "integrator that locates the onset of contact by root finding"


def steps(
    bench: Bench,
    judge: Judge,
    more: Sequence[Reading],
    choice: str = STEPS,
    basis: str = BASIS,
) -> Finding:
    """Return the finding on the cost: with other integrators, and other masses."""
    found = judged(bench, judge, [*more, *integrators(judge)], choice, basis)
    return replace(found, missing=f"{found.missing} and {INTEGRATOR}")


@claim(
    "4.3-impacts-need-small-steps",
    "without dissipation and friction the motion costs more to compute, as its steps are smaller",
    paper="higher computational costs",
    rule=f"more evaluations than with c_e = 0.9, {SCATTER}",
    figures=("fig_mechanism_steps",),
)
def impacts_need_small_steps(bench: Bench) -> Finding:
    """Return evaluations per revolution without friction, with dissipation and without."""
    change = ("restitution", 0.9, 1.0)
    judge = change_of("evaluations", change, 1, DRY, "more without losses")
    own, other = integrators(judge)
    return finding(
        bench,
        [
            replace(
                own,
                missing=f"{TABLE_2} and {INTEGRATOR}",
                ground="the paper's own way to choose the step",
            ),
            other,
        ],
    )


@claim(
    "4.3-small-clearance-larger-steps",
    "a smaller clearance makes the integrator's steps larger",
    paper="larger",
    rule=SCATTER,
    figures=("fig_mechanism_steps", *FIGURES),
)
def larger_steps(bench: Bench) -> Finding:
    """Return the mean step in µs at both clearances."""

    evaluations = change_of("evaluations", SMALLER, -1, {}, "fewer")
    more = [
        Reading("by evaluations per revolution", evaluations, missing=INTEGRATOR),
    ]
    choice = joined(f"{ALL_LOSSES}, as 'among all cases' says", STEPS)
    return steps(bench, change_of("step_us", SMALLER, 1, {}, "larger"), more, choice, MIXED)
