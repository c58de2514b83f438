"""Sections 4.3 and 5: contacts, forces and steps in the runs of the slider-crank."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import pandas as pd

from cylcontact.mechanism import Case
from cylcontact.progress import Progress
from cylcontact.reports.bench import Bench, MissingInputError
from cylcontact.reports.claims import Finding, claim, joined

from ..long_runs import FEW, FIRST, MANY, WINDOWS, long_runs
from ..paper import INTEGRATOR, JOINT_CLEARANCES, JOINT_LAWS, TABLE_2, WINDOW
from ..slider_crank import law_limit, mechanism
from ..trends import (
    ALL,
    Change,
    Judge,
    Judgement,
    Reading,
    above,
    case_name,
    compare,
    every,
    finding,
    integrators,
    majority,
    mostly,
    sets,
    trend,
    windows,
)

SPHERE, *CYLINDERS = JOINT_LAWS
LARGE, SMALL = JOINT_CLEARANCES
CONTINUOUS = 0.99  # share of the time from which contact counts as continuous (ours)
MOSTLY = 0.5
# Of mean penetrations, forces, ...: ours, within it numbers do not differ in particular.
ALIKE = 0.2
START = f"1-{WINDOWS[0]}"
BASIS = f"our masses and lengths; {MANY} revolutions after the first {FIRST} ({FEW} without losses)"
HORIZON = (
    f"our masses and lengths; {FEW} revolutions after the first {FIRST}, as no lossless run is "
    "steady"
)
FIGURES = ("fig_mechanism_cases",)
Conditions = Mapping[str, Sequence[object]]

# The format of a number in a sentence, and its unit in the names of values.
FORMS = {
    "contact_fraction": ("{:.3f}", "share of time"),
    "impacts": ("{:.1f}", "onsets per revolution"),
    "contact_us": ("{:.1f} µs", "us"),
    "flight_us": ("{:.0f} µs", "us"),
    "step_us": ("{:.1f} µs", "us"),
    "mean_step_contact_us": ("{:.2f} µs", "us"),
    "evaluations": ("{:.0f}", "evaluations"),
    **dict.fromkeys(("mean_force_N", "force_p99_N", "max_force_N"), ("{:.0f} N", "N")),
    **dict.fromkeys(("mean_penetration_um", "max_penetration_um"), ("{:.2f} µm", "um")),
}

ELASTIC: Conditions = {"restitution": [1.0]}
LOSSY: Conditions = {"restitution": [0.9]}
DRY: Conditions = {"friction": [0.0]}
ROUGH: Conditions = {"friction": [0.1]}
WIDE: Conditions = {"clearance": [LARGE]}
NARROW: Conditions = {"clearance": [SMALL]}
LOSSLESS: Conditions = {**ELASTIC, **DRY}


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


def change_of(
    column: str, change: tuple[str, object, object], sign: int, chosen: Conditions, verb: str
) -> Judge:
    """Return the judgement of a change of one condition among the chosen cases."""
    return lambda table: trend(compare(table, column, *change, chosen), sign, verb, *FORMS[column])


def against_sphere(table: pd.DataFrame, column: str, chosen: Conditions) -> list[Change]:
    """Compare both cylindrical laws with the sphere."""
    return [
        replace(change, name=f"{JOINT_LAWS[law]} {change.name}".strip())
        for law in CYLINDERS
        for change in compare(table, column, "law", SPHERE, law, chosen)
    ]


def cylinders(column: str, sign: int, chosen: Conditions, verb: str) -> Judge:
    """Return the judgement of the cylindrical laws against the sphere."""
    return lambda table: trend(against_sphere(table, column, chosen), sign, verb, *FORMS[column])


def judged(
    bench: Bench,
    judge: Judge,
    more: Sequence[Reading] = (),
    choice: str = "",
    horizon: bool = False,
    rule: str = "",
) -> Finding:
    """Return the finding of a judgement, with other words, inertias and windows."""
    basis = HORIZON if horizon else BASIS
    missing = f"{TABLE_2} and {WINDOW}" if horizon else TABLE_2
    own = Reading(joined(choice, basis), judge, missing=missing)
    others = [*more, *sets(judge), *(windows(judge) if horizon else [])]
    return finding(bench, [own, *others], rule)


def cases_above(chosen: Conditions, bound: float, rule: Callable[..., bool | None]) -> Judge:
    """Return the judgement of cases that are in contact for at least a share of the time."""

    def judge(table: pd.DataFrame) -> Judgement:
        rows = among(table, chosen)
        shares = rows["contact_fraction"].to_list()
        found = [
            above(*pair, bound)
            for pair in zip(shares, rows["contact_fraction_half_width"], strict=True)
        ]
        count, total, holds = found.count(True), len(found), rule(found)
        values = {
            f"{case_name({k: row[k] for k in ('law', 'clearance', 'restitution', 'friction')})}, "
            "share of time": row["contact_fraction"]
            for row in rows.to_dict("records")
        }
        return Judgement(
            f"{count} of {total} trajectories touch for {bound:.0%} of the time or more; shares "
            f"of time from {min(shares):.2f} to {max(shares):.2f}",
            holds,
            "" if holds is not False else f"{count} of {total}, the least {min(shares):.3f}",
            values,
        )

    return judge


# Contacts and flights.


@claim(
    "4.3-longer-flights",
    "without losses all laws predict longer free flights at the larger clearance",
    paper="longer",
    rule=ALL,
    figures=("fig18", "fig19", *FIGURES),
    against="without losses the energy of the journal spreads, and a mean is one of its window",
)
def longer_flights(bench: Bench) -> Finding:
    """Return the mean duration of a flight in µs at both clearances."""
    change = ("clearance", SMALL, LARGE)
    judge = change_of("flight_us", change, 1, LOSSLESS, "longer at 0.5 than at 0.02 mm")
    return judged(bench, judge, choice="the mean duration of a flight", horizon=True)


@claim(
    "4.3-shorter-contacts",
    "without losses all laws predict shorter contacts at the larger clearance",
    paper="shorter",
    rule=ALL,
    figures=("fig18", "fig19", *FIGURES),
    against="'contact periods' may be the part of the time that is spent in contact, which is "
    "shorter; single contacts are not",
)
def shorter_contacts(bench: Bench) -> Finding:
    """Return the mean duration of a contact in µs at both clearances."""
    change = ("clearance", SMALL, LARGE)
    judge = change_of("contact_us", change, -1, LOSSLESS, "shorter at 0.5 than at 0.02 mm")
    share = change_of("contact_fraction", change, -1, LOSSLESS, "less at 0.5 than at 0.02 mm")
    more = [Reading("the share of the time in contact", share)]
    return judged(bench, judge, more, "the mean duration of a contact", horizon=True)


@claim(
    "4.3-dissipation-keeps-contact",
    "with c_e = 0.9 and without friction most trajectories show continuous contact",
    paper="most",
    rule="more than half of the six trajectories",
    figures=("fig18", "fig19", *FIGURES),
    against="'most of the trajectories' may be the greater part of each, which all six meet; and "
    "with a longer rod all six end in contact without end, after up to 1500 revolutions",
)
def dissipation_keeps_contact(bench: Bench) -> Finding:
    """Return how many cases with dissipation are in contact nearly all the time."""
    chosen = {**LOSSY, **DRY}
    judge = cases_above(chosen, CONTINUOUS, majority)
    part = cases_above(chosen, MOSTLY, every)
    more = [Reading("the greater part of each trajectory is in contact", part)]
    return judged(bench, judge, more, f"continuous: {CONTINUOUS:.0%} of the time, ours")


@claim(
    "4.3-friction-keeps-contact",
    "with friction the trajectories are mostly in contact",
    paper="mostly in contact",
    rule="at 0.5 mm half of the time or more with every law",
    figures=("fig18", *FIGURES),
    against="the sentence does not say to which runs friction is added: in elastic ones, of which "
    "'become' speaks, flight still prevails",
)
def friction_keeps_contact(bench: Bench) -> Finding:
    """Return the share of the time in contact with friction at 0.5 mm."""
    judge = cases_above({**WIDE, **LOSSY, **ROUGH}, MOSTLY, every)
    elastic = cases_above({**WIDE, **ELASTIC, **ROUGH}, MOSTLY, every)
    more = [Reading("friction added to c_e = 1", elastic)]
    return judged(bench, judge, more, "friction added to c_e = 0.9")


@claim(
    "4.3-sphere-most-in-contact",
    "with friction contact is more evident with Lankarani and Nikravesh's law",
    paper="more evident",
    rule=f"in contact for longer than with either cylindrical law, {ALL}",
    figures=("fig18", *FIGURES),
    against="with c_e = 0.9 all laws end in contact without end, and none can be ahead; the "
    "sentence must then mean elastic runs or the start",
)
def sphere_most_in_contact(bench: Bench) -> Finding:
    """Return the shares of time in contact with friction at 0.5 mm."""

    def judge(chosen: Conditions) -> Judge:
        rough = {**WIDE, **ROUGH, **chosen}
        return cylinders("contact_fraction", -1, rough, "less than with the sphere")

    start = f"revolutions 1 to {WINDOWS[0]}, the start"
    more = [
        Reading("friction added to c_e = 1", judge(ELASTIC)),
        Reading(start, judge(LOSSY), window=START, missing=WINDOW),
    ]
    found = judged(bench, judge(LOSSY), more, "friction added to c_e = 0.9")
    return replace(found, missing=f"{TABLE_2} and {WINDOW}")


@claim(
    "4.3-friction-leaves-flights",
    "with friction some free flights remain with cylindrical laws",
    paper="some free-flight modes",
    rule="at 0.5 mm some onset of contact with each of them",
    figures=("fig18", *FIGURES),
    against="the figures may show the first revolutions, in which the journal still bounces",
)
def friction_leaves_flights(bench: Bench) -> Finding:
    """Return the onsets of contact per revolution with friction at 0.5 mm."""

    def judge(chosen: Conditions) -> Judge:
        def of(table: pd.DataFrame) -> Judgement:
            rows = among(table, {**WIDE, **ROUGH, **chosen, "law": CYLINDERS})
            onsets = {JOINT_LAWS[row["law"]]: row["impacts"] for row in rows.to_dict("records")}
            texts = ", ".join(f"{name} {value:.2g}" for name, value in onsets.items())
            return Judgement(
                f"onsets of contact per revolution: {texts}",
                min(onsets.values()) > 0,
                "" if min(onsets.values()) > 0 else f"{min(onsets.values()):g} onsets",
                {f"{name}, onsets per revolution": value for name, value in onsets.items()},
            )

        return of

    start = f"revolutions 1 to {WINDOWS[0]}, the start"
    more = [
        Reading(start, judge(LOSSY), window=START, missing=WINDOW),
        Reading("friction added to c_e = 1", judge(ELASTIC)),
    ]
    found = judged(bench, judge(LOSSY), more, "friction added to c_e = 0.9")
    return replace(found, missing=f"{TABLE_2} and {WINDOW}")


@claim(
    "4.3-friction-fewer-flights",
    "with cylindrical laws free flights are rarer with friction than without",
    paper="reduced frequency",
    rule=f"fewer onsets of contact per revolution, {ALL}",
    figures=("fig18", *FIGURES),
    against="with our masses both laws show it; with a longer rod flights end without friction "
    "too, though only after hundreds of revolutions",
)
def friction_fewer_flights(bench: Bench) -> Finding:
    """Return impacts per revolution without and with friction, for the cylindrical laws."""

    def judge(chosen: Conditions) -> Judge:
        cases = {**WIDE, "law": CYLINDERS, **chosen}
        return change_of("impacts", ("friction", 0.0, 0.1), -1, cases, "rarer with friction")

    elastic = judge(ELASTIC)
    more = [
        Reading("friction added to c_e = 1", elastic, missing=WINDOW),
        *(replace(each, choice=f"c_e = 1, {each.choice}") for each in windows(elastic)),
    ]
    return judged(bench, judge(LOSSY), more, "friction added to c_e = 0.9")


@claim(
    "4.3-small-clearance-smoother",
    "a smaller clearance makes for fewer impacts",
    paper="fewer impacts",
    rule=f"fewer onsets of contact per revolution, {ALL}",
    figures=("fig18", "fig19", *FIGURES),
    against="the paper's figure shows all losses: without dissipation the small clearance has "
    "more impacts, not fewer",
)
def small_clearance_smoother(bench: Bench) -> Finding:
    """Return impacts per revolution at both clearances."""

    def judge(chosen: Conditions) -> Judge:
        change = ("clearance", LARGE, SMALL)
        return change_of("impacts", change, -1, chosen, "fewer at 0.02 mm")

    more = [Reading("all four losses", judge({})), Reading("c_e = 1", judge(ELASTIC))]
    return judged(bench, judge(LOSSY), more, "runs with c_e = 0.9")


@claim(
    "4.3-small-clearance-long-contact",
    "a smaller clearance makes for long contacts, in which the journal follows the wall",
    paper="long periods of contact",
    rule=f"in contact for a larger share of the time, {ALL}",
    figures=("fig18", "fig19", *FIGURES),
    against="with our masses no window speaks against it; with a longer rod contact becomes "
    "permanent at the large clearance too",
)
def small_clearance_long_contact(bench: Bench) -> Finding:
    """Return the share of the time in contact at both clearances."""

    def judge(chosen: Conditions) -> Judge:
        change = ("clearance", LARGE, SMALL)
        return change_of("contact_fraction", change, 1, chosen, "longer at 0.02 mm")

    more = [Reading("runs with c_e = 0.9", judge(LOSSY))]
    return judged(bench, judge({}), more, "all four losses", horizon=True)


@claim(
    "5-flight-prevails-without-losses",
    "without losses free flight prevails over contact",
    paper="prevalence of free flight",
    rule="in contact for less than half of the time, with every law at both clearances",
    figures=("fig18", "fig19", *FIGURES),
    against="at 0.02 mm contact and flight share the time nearly evenly with Lankarani and "
    "Nikravesh's law, and the inertias decide",
)
def flight_prevails_without_losses(bench: Bench) -> Finding:
    """Return the share of time in contact without losses."""

    def judge(chosen: Conditions) -> Judge:
        def of(table: pd.DataFrame) -> Judgement:
            rows = among(table, {**LOSSLESS, **chosen})
            shares = rows["contact_fraction"]
            at_most = {
                f"{clearance:g} mm": group.max()
                for clearance, group in shares.groupby(rows["clearance"], sort=False)
            }
            texts = ", ".join(f"{value:.2f} at {name}" for name, value in at_most.items())
            holds = bool(shares.max() < MOSTLY)
            return Judgement(
                f"in contact for at most {texts}",
                holds,
                "" if holds else f"{shares.max():.3f}",
                {f"{name}, largest share of time": value for name, value in at_most.items()},
            )

        return of

    more = [Reading("0.5 mm alone, as in Fig 18", judge(WIDE))]
    return judged(bench, judge({}), more, horizon=True)


@claim(
    "5-friction-keeps-elastic-contact",
    "friction brings the elastic mechanism mostly into contact",
    paper="mostly in contact",
    rule="in contact for half of the time or more with every law",
    figures=("fig18", "fig19", *FIGURES),
    against="the sentence may speak of runs that dissipate in the normal force too, which are in "
    "contact all the time",
)
def friction_keeps_elastic_contact(bench: Bench) -> Finding:
    """Return the share of the time in contact with friction and c_e = 1."""
    judge = cases_above({**WIDE, **ELASTIC, **ROUGH}, MOSTLY, every)
    more = [
        Reading("at 0.02 mm", cases_above({**NARROW, **ELASTIC, **ROUGH}, MOSTLY, every)),
        Reading("with c_e = 0.9", cases_above({**WIDE, **LOSSY, **ROUGH}, MOSTLY, every)),
    ]
    return judged(bench, judge, more, "c_e = 1 at 0.5 mm")


# Forces and penetrations, and Johnson's law against the enhanced one.


@claim(
    "4.3-friction-lowers-forces",
    "friction lowers the contact forces",
    paper="reduction",
    rule=ALL,
    figures=("fig18", *FIGURES),
    against="with our masses every law shows it; with a longer rod the journal settles on the "
    "wall without friction too, which has then nothing to lower",
)
def friction_lowers_forces(bench: Bench) -> Finding:
    """Return forces in N without and with friction at 0.5 mm."""

    def judge(column: str, chosen: Conditions) -> Judge:
        cases = {**WIDE, **chosen}
        return change_of(column, ("friction", 0.0, 0.1), -1, cases, "lower with friction")

    elastic = judge("mean_force_N", ELASTIC)
    more = [
        Reading("its 99th percentile", judge("force_p99_N", LOSSY)),
        Reading("friction added to c_e = 1", elastic, missing=WINDOW),
        *(replace(each, choice=f"c_e = 1, {each.choice}") for each in windows(elastic)),
    ]
    choice = "mean force in contact, friction added to c_e = 0.9 at 0.5 mm"
    return judged(bench, judge("mean_force_N", LOSSY), more, choice)


@claim(
    "4.3-cylinders-higher-forces",
    "with friction, too, cylindrical laws give higher forces than the spherical one",
    paper="higher",
    rule=ALL,
    figures=("fig18", *FIGURES),
    against="in contact without end the mean force is the mechanism's inertia, whatever the law; "
    "only impacts tell laws apart",
)
def cylinders_higher_forces(bench: Bench) -> Finding:
    """Return forces in N by the sphere and by the cylindrical laws, with friction."""

    def judge(column: str, chosen: Conditions) -> Judge:
        return cylinders(column, 1, {**WIDE, **ROUGH, **chosen}, "higher than with the sphere")

    more = [
        Reading("its 99th percentile", judge("force_p99_N", LOSSY)),
        Reading("friction added to c_e = 1", judge("mean_force_N", ELASTIC)),
        Reading(
            f"largest force of a revolution, revolutions 1 to {WINDOWS[0]}",
            judge("max_force_N", LOSSY),
            window=START,
            missing=WINDOW,
        ),
    ]
    choice = "mean force in contact, friction added to c_e = 0.9 at 0.5 mm"
    found = judged(bench, judge("mean_force_N", LOSSY), more, choice)
    return replace(found, missing=f"{TABLE_2} and {WINDOW}")


@claim(
    "4.3-sphere-deeper",
    "at 0.02 mm Lankarani and Nikravesh's law leads to deeper penetrations",
    paper="higher penetrations",
    rule=ALL,
    figures=("fig19", *FIGURES),
    against="where the elastic journal whirls, episodes decide the mean, and the laws whirl for "
    "different shares of the time",
)
def sphere_deeper(bench: Bench) -> Finding:
    """Return mean penetrations in µm by the sphere and by the cylindrical laws at 0.02 mm."""

    def judge(column: str, chosen: Conditions) -> Judge:
        return cylinders(column, -1, {**NARROW, **chosen}, "less deep than with the sphere")

    more = [
        Reading("all four losses", judge("mean_penetration_um", {})),
        Reading("the largest of a revolution, c_e = 0.9", judge("max_penetration_um", LOSSY)),
    ]
    return judged(bench, judge("mean_penetration_um", LOSSY), more, "its mean; c_e = 0.9")


COMPARED = {
    "contact_fraction": "share of time in contact",
    "impacts": "impacts",
    "mean_penetration_um": "mean penetration",
    "mean_force_N": "mean force",
}


def alike(chosen: Conditions) -> Judge:
    """Return the judgement whether the runs with Johnson's and the enhanced law agree."""

    def judge(table: pd.DataFrame) -> Judgement:
        changes = {
            f"{name} {change.name}".strip(): change
            for column, name in COMPARED.items()
            for change in compare(table, column, "law", "johnson", "enhanced", chosen)
        }
        name, largest = max(changes.items(), key=lambda pair: abs(pair[1].relative))
        apart = [c for c in changes.values() if abs(c.relative) - c.margin > ALIKE]
        near = [c for c in changes.values() if abs(c.relative) + c.margin <= ALIKE]
        percent = replace(largest, name="").percent
        return Judgement(
            f"{len(near)} of {len(changes)} numbers agree within {ALIKE:.0%}; furthest apart is "
            f"the {name}, {percent}",
            False if apart else len(near) == len(changes) or None,
            f"differing: {len(apart)} of {len(changes)}, most by {percent}" if apart else "",
            {f"{each}, change, -": c.relative for each, c in changes.items()},
        )

    return judge


@claim(
    "4.3-johnson-and-enhanced-alike",
    "otherwise Johnson's law and the enhanced one give no particular difference",
    paper="no difference",
    rule=f"{', '.join(COMPARED.values())} differ by at most {ALIKE:.0%} (ours)",
    figures=("fig18", *FIGURES),
    against="with our masses the two agree at both clearances; with a longer rod they settle "
    "at different times, of which a mean says little",
)
def johnson_and_enhanced_alike(bench: Bench) -> Finding:
    """Return how far runs with Johnson's and with the enhanced law differ."""
    more = [
        Reading("0.5 mm, c_e = 1 with friction", alike({**WIDE, **ELASTIC, **ROUGH})),
        Reading("0.5 mm, without losses", alike({**WIDE, **LOSSLESS})),
        Reading("0.02 mm, c_e = 0.9", alike({**NARROW, **LOSSY})),
    ]
    return judged(bench, alike({**WIDE, **LOSSY}), more, "0.5 mm, c_e = 0.9")


@claim(
    "4.3-johnson-within-its-domain",
    "Johnson's law covers the range of the applications considered",
    paper="in the range of the applications considered",
    rule="no penetration at 0.02 mm passes Eq 8's limit",
    figures=("fig17", "fig19"),
    against="the passage is about Fig 17, of c_e = 0.9; without dissipation Johnson's law ends in "
    "the runs of Fig 19, of which the paper is silent",
)
def johnson_within_its_domain(bench: Bench) -> Finding:
    """Return the deepest penetration in µm by Johnson's law at 0.02 mm."""
    limit = 1e3 * law_limit(mechanism(bench, Case("johnson", SMALL, 0.9, 0.0)))

    def judge(chosen: Conditions) -> Judge:
        def of(table: pd.DataFrame) -> Judgement:
            rows = among(table, {**NARROW, "law": ["johnson"], **chosen})
            left = float(rows["left"].max())
            deepest = float(rows["deepest_um"].max())
            return Judgement(
                f"penetrations up to {deepest:.3g} µm, against a limit of {limit:.2f} µm; passed "
                f"in up to {left:.0%} of the revolutions",
                left == 0,
                "" if left == 0 else f"by {deepest - limit:.2g} µm",
                {"deepest, um": deepest, "limit, um": limit, "left, share of revolutions": left},
            )

        return of

    more = [
        Reading("c_e = 1 without friction", judge(LOSSLESS), missing=WINDOW),
        Reading("c_e = 1 with friction", judge({**ELASTIC, **ROUGH})),
    ]
    return judged(bench, judge(LOSSY), more, "runs with c_e = 0.9, from the start")


@claim(
    "5-elastic-forces-are-large",
    "without dissipation the contact forces become large",
    paper="large",
    rule=f"larger than with c_e = 0.9, {ALL}",
    figures=FIGURES,
    against="'large' has no measure; they are larger than with dissipation",
)
def elastic_forces_are_large(bench: Bench) -> Finding:
    """Return forces in N with and without dissipation."""

    def judge(column: str, chosen: Conditions) -> Judge:
        change = ("restitution", 0.9, 1.0)
        return change_of(column, change, 1, chosen, "larger without dissipation")

    more = [
        Reading("its 99th percentile", judge("force_p99_N", DRY)),
        Reading("with friction", judge("mean_force_N", ROUGH)),
    ]
    choice = "mean force in contact, without friction"
    return judged(bench, judge("mean_force_N", DRY), more, choice, horizon=True)


# The integrator's steps.
STEPS = "mean step of an integrator that finds contact by root"


def steps(
    bench: Bench,
    judge: Callable[[str], Judge],
    more: Sequence[Reading],
    choice: str = "",
    horizon: bool = False,
) -> Finding:
    """Return the finding on steps: by their mean, other integrators, and other masses."""
    own = judge("step_us")
    found = judged(bench, own, [*more, *integrators(own)], joined(choice, STEPS), horizon)
    return replace(found, missing=f"{found.missing} and {INTEGRATOR}")


@claim(
    "4.3-impacts-need-small-steps",
    "short, hard impacts without losses need smaller time steps",
    paper="smaller",
    rule="smaller in contact than in flight, for every law and clearance",
    figures=("fig_mechanism_steps",),
    against="a step of ours resolves the contact law's kink at onset, which another integrator "
    "may step over",
)
def impacts_need_small_steps(bench: Bench) -> Finding:
    """Return the mean step in contact over that in flight."""

    def judge(_column: str) -> Judge:
        def of(table: pd.DataFrame) -> Judgement:
            rows = among(table, LOSSLESS)
            ratios = rows["mean_step_contact_us"] / rows["mean_step_flight_us"]
            names = [
                f"{JOINT_LAWS[r['law']]} {r['clearance']:g} mm" for r in rows.to_dict("records")
            ]
            holds = bool(ratios.max() < 1)
            return Judgement(
                f"mean step in contact {ratios.min():.2f} to {ratios.max():.2f} of that in flight",
                holds,
                "" if holds else f"a ratio of {ratios.max():.2f}",
                {f"{name}, -": value for name, value in zip(names, ratios, strict=True)},
            )

        return of

    return steps(bench, judge, [], horizon=True)


@claim(
    "4.3-cylinders-smaller-steps",
    "without losses cylindrical laws need smaller steps than the spherical one",
    paper="smaller, in particular for cylindrical laws",
    rule=ALL,
    figures=("fig_mechanism_steps", *FIGURES),
    against="the mean step hangs on how often contact comes and goes, which differs between "
    "windows of a run without losses",
)
def cylinders_smaller_steps(bench: Bench) -> Finding:
    """Return the mean step in µs by the sphere and by the cylindrical laws, without losses."""

    def judge(column: str) -> Judge:
        return cylinders(column, -1, LOSSLESS, "smaller than with the sphere")

    more = [Reading("the mean step in contact", judge("mean_step_contact_us"))]
    return steps(bench, judge, more, horizon=True)


@claim(
    "4.3-{short}-larger-steps",
    "{cause} makes the integrator's steps larger",
    paper="larger",
    rule=ALL,
    figures=("fig_mechanism_steps", *FIGURES),
    against="{against}",
    cases=[
        {
            "short": "friction",
            "cause": "friction",
            "change": ("friction", 0.0, 0.1),
            "own": ("friction added to c_e = 0.9 at 0.5 mm", {**WIDE, **LOSSY}),
            "other": ("friction added to c_e = 1", {**WIDE, **ELASTIC}),
            "against": "an integrator of looser tolerance sees no kinks of friction, and its steps "
            "do grow",
        },
        {
            "short": "dissipation",
            "cause": "energy dissipation",
            "change": ("restitution", 1.0, 0.9),
            "own": ("all clearances and frictions", {}),
            "other": ("without friction", DRY),
            "against": "nearly every pair shows it, and those that do not hang on the integrator",
        },
        {
            "short": "small-clearance",
            "cause": "a smaller clearance",
            "change": ("clearance", LARGE, SMALL),
            "own": ("all four losses, as 'among all cases' says", {}),
            "other": ("c_e = 1", ELASTIC),
            "against": "with c_e = 0.9, where contact does not end, steps do grow with every law",
        },
    ],
)
def larger_steps(
    bench: Bench,
    change: tuple[str, float, float],
    own: tuple[str, Conditions],
    other: tuple[str, Conditions],
) -> Finding:
    """Return the mean step in µs before and after a change of conditions."""

    def judge(column: str, sign: int = 1, chosen: Conditions = own[1]) -> Judge:
        return change_of(column, change, sign, chosen, "larger" if sign > 0 else "fewer")

    def most(table: pd.DataFrame) -> Judgement:
        return mostly(compare(table, "step_us", *change, own[1]), 1, "larger")

    evaluations = judge("evaluations", -1)
    more = [
        Reading(other[0], judge("step_us", chosen=other[1])),
        Reading("more than half of the pairs", most),
        Reading("by evaluations per revolution", evaluations, missing=INTEGRATOR),
    ]
    return steps(bench, judge, more, own[0])
