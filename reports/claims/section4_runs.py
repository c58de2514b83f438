"""Sections 4.3 and 5: contacts, forces and steps in the runs of the slider-crank."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import pandas as pd

from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim, joined, listed, verdict_if, with_unit

from ..paper import JOINT_CLEARANCES, JOINT_LAWS
from ..slider_crank import (
    AGAINST,
    FIRST,
    REVOLUTIONS,
    TIGHTER,
    WHIRLING,
    WHIRLING_REVOLUTIONS,
    statistics_table,
)
from ..trends import (
    CERTAIN,
    CONDITIONS,
    RUNS,
    Change,
    as_values,
    case_name,
    compare,
    is_trend,
    rule,
    tally,
    trend_finding,
    values_or_ratios,
)

SPHERE, *CYLINDERS = JOINT_LAWS
LARGE, SMALL = JOINT_CLEARANCES
BASIS = (
    f"geometry and masses assumed (Table 2 is missing); means over revolutions {FIRST + 1} to "
    f"{REVOLUTIONS} (to {WHIRLING_REVOLUTIONS} at {WHIRLING.clearance:g} mm with "
    f"c_e = {WHIRLING.restitution:g} and c_f = {WHIRLING.friction:g}, where a whirl along the wall "
    "stops and comes back, so that so few revolutions are one sample of it), after the "
    "start-up and where sensitive runs have parted, of two runs for each case, at the spec's "
    f"tolerance and at {TIGHTER:g} of it"
)
CONTINUOUS = 0.99  # share of the time from which contact counts as continuous
WITH_FRICTION: Mapping[str, Sequence[object]] = {"friction": [0.1]}


def lossless(table: pd.DataFrame) -> pd.DataFrame:
    """Return the cases without losses."""
    return table[(table["restitution"] == 1.0) & (table["friction"] == 0.0)]


def by_law(table: pd.DataFrame, column: str, run: str = RUNS[0]) -> dict[str, tuple[float, float]]:
    """Return a number at the small and at the large clearance without losses, by law."""
    values = lossless(table).set_index(["law", "clearance"])[column + run].to_dict()
    return {
        name: (float(values[law, SMALL]), float(values[law, LARGE]))
        for law, name in JOINT_LAWS.items()
    }


def always(table: pd.DataFrame, column: str, holds: Callable[[float, float], bool]) -> bool:
    """Whether a relation of small and large clearance holds for every law at both tolerances."""
    return all(holds(*pair) for run in RUNS for pair in by_law(table, column, run).values())


def arrows(pairs: Mapping[str, tuple[float, float]], form: str) -> str:
    """Return "law small → large, ..."."""
    return ", ".join(
        f"{law} {form.format(small)} → {form.format(large)}"
        for law, (small, large) in pairs.items()
    )


def law_values(pairs: Mapping[str, tuple[float, float]], unit: str) -> dict[str, float]:
    """Return the numbers of `by_law` under names with units."""
    return {
        f"{law}, {clearance:g} mm, {unit}": value
        for law, pair in pairs.items()
        for clearance, value in zip((SMALL, LARGE), pair, strict=True)
    }


def in_contact(table: pd.DataFrame, share: float) -> pd.DataFrame:
    """Return the cases in contact for at least a share of the time at both tolerances."""
    return table[(table[[f"contact_fraction{run}" for run in RUNS]] >= share).all(axis=1)]


@claim(
    "4.3-longer-flights",
    "without losses all laws predict longer free flights at the larger clearance",
    paper="longer",
    rule="longer for every law at both tolerances",
)
def longer_flights(bench: Bench) -> Finding:
    """Return the mean duration of a flight in µs at both clearances."""
    table = statistics_table(bench)
    durations = by_law(table, "flight_us")
    return Finding(
        f"mean duration of a flight, {SMALL:g} → {LARGE:g} mm: {arrows(durations, '{:.0f} µs')}",
        holds=always(table, "flight_us", lambda small, large: large > small),
        choice=BASIS,
        values=law_values(durations, "us"),
    )


@claim(
    "4.3-shorter-contacts",
    "without losses all laws predict shorter contacts at the larger clearance",
    paper="shorter",
    rule="shorter for every law at both tolerances",
)
def shorter_contacts(bench: Bench) -> Finding:
    """Return the mean duration of a contact in µs at both clearances."""
    table = statistics_table(bench)
    durations, shares = by_law(table, "contact_us"), by_law(table, "contact_fraction")
    by_share = always(table, "contact_fraction", lambda small, large: large < small)
    return Finding(
        f"mean duration of a contact, {SMALL:g} → {LARGE:g} mm: {arrows(durations, '{:.1f} µs')}",
        holds=always(table, "contact_us", lambda small, large: large < small),
        choice=BASIS,
        alternatives=f"by their share of the time, {arrows(shares, '{:.2f}')}, contacts are "
        f"shorter {verdict_if(by_share)}",
        values=law_values(durations, "us") | law_values(shares, "share of time"),
    )


@claim(
    "4.3-dissipation-keeps-contact",
    "with c_e = 0.9 most trajectories show continuous contact",
    paper="most",
    rule="more than half of the cases, each at both tolerances",
)
def dissipation_keeps_contact(bench: Bench) -> Finding:
    """Return how many cases with dissipation are in contact nearly all the time."""
    table = statistics_table(bench)
    lossy = table[table["restitution"] == 0.9]
    count, total = len(in_contact(lossy, CONTINUOUS)), len(lossy)
    smooth = lossy[lossy["friction"] == 0.0]
    continuous = in_contact(smooth, CONTINUOUS)
    counts = " and ".join(
        f"{(continuous['clearance'] == c).sum()} of {(smooth['clearance'] == c).sum()} at {c:g} mm"
        for c in JOINT_CLEARANCES
    )
    at_large = smooth[smooth["clearance"] == LARGE].set_index("law")["contact_fraction"]
    shares = {JOINT_LAWS[str(law)]: float(share) for law, share in at_large.items()}
    return Finding(
        f"{count} of {total} cases with c_e = 0.9 are in contact {CONTINUOUS:.0%} of the time",
        holds=count > total / 2,
        choice=f"{BASIS}; 'continuous' is at least {CONTINUOUS:.0%} of the time",
        alternatives=f"without friction {counts}; the share of time at {LARGE:g} mm is then "
        f"{listed(shares, '{:.2f}')} {verdict_if(len(continuous) > len(smooth) / 2)}",
        values={
            "cases in contact, -": float(count),
            "cases, -": float(total),
            **with_unit(shares, "share of time at 0.5 mm without friction"),
        },
    )


@claim(
    "4.3-friction-keeps-contact",
    "with friction the trajectories are mostly in contact",
    paper="mostly in contact",
    rule="half of the time or more in every case with c_f = 0.1, at both tolerances",
)
def friction_keeps_contact(bench: Bench) -> Finding:
    """Return how many cases with friction are in contact for half of the time or more."""
    table = statistics_table(bench)
    rough = table[table["friction"] > 0]
    mostly = in_contact(rough, 0.5)
    exceptions = {
        f"{JOINT_LAWS[row['law']]} at {row['clearance']:g} mm, c_e = {row['restitution']:g}": (
            row["contact_fraction"]
        )
        for row in rough.drop(index=mostly.index).to_dict("records")
    }
    changes = compare(table, "contact_fraction", "friction", 0.0, 0.1)
    return Finding(
        f"half of the time or more in {len(mostly)} of {len(rough)} cases"
        + (f"; not so: {listed(exceptions, '{:.2f}')}" if exceptions else ""),
        holds=len(mostly) == len(rough),
        choice=BASIS,
        alternatives=f"friction lengthens the time in contact {tally(changes, 1)}",
        values=as_values(changes, "share of time"),
    )


def against_sphere(
    table: pd.DataFrame, column: str, among: Mapping[str, Sequence[object]] = WITH_FRICTION
) -> list[Change]:
    """Compare both cylindrical laws with the sphere, by default in the cases with friction."""
    return [
        replace(change, name=f"{JOINT_LAWS[law]} {change.name}")
        for law in CYLINDERS
        for change in compare(table, column, "law", SPHERE, law, among)
    ]


@claim(
    "4.3-sphere-most-in-contact",
    "with friction contact lasts longest with Lankarani and Nikravesh's law",
    paper="more evident for that law",
)
def sphere_most_in_contact(bench: Bench) -> Finding:
    """Return in how many cases with friction a cylindrical law is less in contact."""
    changes = against_sphere(statistics_table(bench), "contact_fraction")
    return Finding(
        f"a cylindrical law is less in contact {tally(changes, -1)}",
        holds=is_trend(changes, -1),
        choice=BASIS,
        alternatives=values_or_ratios(changes, "{:.3f}"),
        values=as_values(changes, "share of time"),
        rule=f"less in contact {rule(changes)}",
    )


@claim(
    "4.3-friction-fewer-flights",
    "with cylindrical laws free flights are rarer with friction than without",
    paper="reduced frequency",
)
def friction_fewer_flights(bench: Bench) -> Finding:
    """Return impacts per revolution without and with friction, for the cylindrical laws."""
    table = statistics_table(bench)
    changes = compare(table, "impacts", "friction", 0.0, 0.1, {"law": CYLINDERS})
    flying = [change for change in changes if change.before > 0]
    texts = "impacts per revolution fall", "they fall"
    finding = trend_finding(flying, -1, texts, "{:.1f}", "impacts per revolution", BASIS)
    return replace(finding, rule=f"{finding.rule}, of those that fly without friction")


@claim(
    "4.3-small-clearance-smoother",
    "a smaller clearance makes for fewer impacts",
    paper="fewer impacts, long contacts",
)
def small_clearance_smoother(bench: Bench) -> Finding:
    """Return impacts per revolution at both clearances."""
    table = statistics_table(bench)
    changes = compare(table, "impacts", "clearance", LARGE, SMALL)
    shares = compare(table, "contact_fraction", "clearance", LARGE, SMALL)
    return trend_finding(
        changes,
        -1,
        ("impacts per revolution fall", "they fall"),
        "{:.1f}",
        "impacts per revolution",
        BASIS,
        f"the share of time in contact rises {tally(shares, 1)}",
    )


@claim(
    "5-flight-prevails-without-losses",
    "without losses free flight prevails over contact",
    paper="prevalence of free flight",
    rule="below one half for every law and clearance at both tolerances",
)
def flight_prevails_without_losses(bench: Bench) -> Finding:
    """Return the share of time in contact without losses."""
    table = statistics_table(bench)
    shares = by_law(table, "contact_fraction")
    return Finding(
        f"share of time in contact, {SMALL:g} → {LARGE:g} mm: {arrows(shares, '{:.2f}')}",
        holds=always(table, "contact_fraction", lambda small, large: max(small, large) < 0.5),
        choice=BASIS,
        values=law_values(shares, "share of time"),
    )


# Forces and penetrations, and Johnson's law against the enhanced one.
DIFFERENT = 0.2  # relative difference below which numbers do not differ in particular
FORCE = "force_p99_N"
FORCE_CHOICE = f"{BASIS}; the force's 99th percentile over the time in contact"
COMPARED = {
    "contact_fraction": "share of time in contact",
    "impacts": "impacts",
    "mean_penetration_um": "mean penetration",
    FORCE: "99 % force",
    "step_us": "step",
}


@claim("4.3-friction-lowers-forces", "friction lowers the contact forces", paper="reduction")
def friction_lowers_forces(bench: Bench) -> Finding:
    """Return forces in N without and with friction."""
    table = statistics_table(bench)
    changes = compare(table, FORCE, "friction", 0.0, 0.1)
    rising = sorted((c for c in changes if c.relative > 0), key=lambda c: -c.relative)
    rises = ", ".join(f"{c.name} {c.before:.0f} N → {c.after:.0f} N" for c in rising)
    apart = ", ".join(
        f"{case_name({name: row[name] for name in CONDITIONS})} "
        f"{row[FORCE]:.0f} N and {row[FORCE + AGAINST]:.0f} N"
        for row in table.to_dict("records")
        if abs(row[FORCE] - row[FORCE + AGAINST])
        > DIFFERENT * max(row[FORCE], row[FORCE + AGAINST])
    )
    alternatives = joined(
        f"in the mean it rises in {len(rising)} pairs: {rises}" if rises else "",
        f"over {DIFFERENT:.0%} apart at the two tolerances: {apart}" if apart else "",
    )
    texts = "they fall", "lower"
    return trend_finding(changes, -1, texts, "{:.0f} N", "N", FORCE_CHOICE, alternatives)


@claim(
    "4.3-cylinders-higher-forces",
    "with friction, too, cylindrical laws give higher forces than the spherical one",
    paper="higher",
)
def cylinders_higher_forces(bench: Bench) -> Finding:
    """Return forces in N by the sphere and by the cylindrical laws, with friction."""
    changes = against_sphere(statistics_table(bench), FORCE)
    return trend_finding(changes, 1, ("higher", "higher"), "{:.0f} N", "N", FORCE_CHOICE)


@claim(
    "4.3-sphere-deeper",
    "at 0.02 mm Lankarani and Nikravesh's law leads to deeper penetrations",
    paper="higher penetrations",
)
def sphere_deeper(bench: Bench) -> Finding:
    """Return mean penetrations in µm by the sphere and by the cylindrical laws at 0.02 mm."""
    table = statistics_table(bench)
    changes = against_sphere(table, "mean_penetration_um", {"clearance": [SMALL]})
    texts = "mean penetration with a cylindrical law is lower", "lower"
    return trend_finding(changes, -1, texts, "{:.2f} µm", "um", BASIS)


@claim(
    "4.3-johnson-and-enhanced-alike",
    "otherwise Johnson's law and the enhanced one give no particular difference",
    paper="no difference",
    rule=f"none differs {CERTAIN}, and by more than {DIFFERENT:.0%} of the larger in the mean; "
    f"more than half are alike, within {DIFFERENT:.0%} at that confidence",
)
def johnson_and_enhanced_alike(bench: Bench) -> Finding:
    """Return the numbers in which runs with Johnson's and with the enhanced law differ."""
    table = statistics_table(bench)
    changes = {
        f"{name}, {change.name}": change
        for column, name in COMPARED.items()
        for change in compare(table, column, "law", "johnson", "enhanced")
    }
    differing = {
        name: change
        for name, change in changes.items()
        if change.sign and abs(change.relative) > DIFFERENT
    }
    alike = sum(abs(change.relative) + change.margin < DIFFERENT for change in changes.values())
    texts = ", ".join(f"{name} {c.before:.3g} → {c.after:.3g}" for name, c in differing.items())
    continued = "; ".join(
        f"{JOINT_LAWS[row['law']]} at {row['clearance']:g} mm, c_e = {row['restitution']:g}, "
        f"c_f = {row['friction']:g}: {row['continued']:.0f} of {row['onsets']:.0f} contacts, "
        f"{row['left']:.0f} beyond the law's end"
        for row in table[table["continued"] > 0].to_dict("records")
    )
    return Finding(
        f"{len(differing)} of {len(changes)} numbers differ, Johnson → enhanced: "
        f"{texts or 'none'}; {alike} are alike, {len(changes) - alike - len(differing)} undecided",
        holds=not differing and alike > len(changes) / 2,
        choice=f"{BASIS}; compared are {', '.join(COMPARED.values())}",
        alternatives=f"Johnson's law had to be continued along its tangent ({continued})"
        if continued
        else "",
        values={
            **{f"{name}, change over the larger, -": c.relative for name, c in differing.items()},
            "numbers compared, -": float(len(changes)),
            "of them different, -": float(len(differing)),
        },
    )


@claim(
    "5-elastic-forces-are-large",
    "without dissipation the contact forces become large",
    paper="large",
)
def elastic_forces_are_large(bench: Bench) -> Finding:
    """Return forces in N without and with dissipation."""
    changes = compare(statistics_table(bench), FORCE, "restitution", 1.0, 0.9)
    texts = "with c_e = 0.9 they are lower", "lower with dissipation"
    return trend_finding(changes, -1, texts, "{:.0f} N", "N", FORCE_CHOICE)


# The integrator's steps.
STEP_CHOICE = (
    f"{BASIS}; mean step over a revolution by DOP853 with contact found by root, where the paper "
    "controls the step of a predictor and corrector by the penetration at onset; an event's second "
    "row is no step, but the short ones at the start of every contact count"
)


@claim(
    "4.3-impacts-need-small-steps",
    "short, hard impacts without losses need smaller time steps",
    paper="smaller",
    rule="smaller in contact for every law and clearance at both tolerances",
)
def impacts_need_small_steps(bench: Bench) -> Finding:
    """Return the mean step in contact over that in flight."""
    ratios = {
        f"{JOINT_LAWS[row['law']]} at {row['clearance']:g} mm{tolerance}": (
            row[f"mean_step_contact_us{run}"] / row[f"mean_step_flight_us{run}"]
        )
        for run, tolerance in zip(RUNS, ("", ", tighter"), strict=True)
        for row in lossless(statistics_table(bench)).to_dict("records")
    }
    return Finding(
        f"mean step in contact over that in flight: {listed(ratios, '{:.3f}')}",
        holds=max(ratios.values()) < 1,
        choice=STEP_CHOICE,
        values=with_unit(ratios, "-"),
    )


@claim(
    "4.3-cylinders-smaller-steps",
    "without losses cylindrical laws need smaller steps than the spherical one",
    paper="smaller, in particular for cylindrical laws",
)
def cylinders_smaller_steps(bench: Bench) -> Finding:
    """Return the mean step in µs by the sphere and by the cylindrical laws, without losses."""
    changes = against_sphere(lossless(statistics_table(bench)), "step_us", {})
    return trend_finding(changes, -1, ("smaller", "smaller"), "{:.2f} µs", "us", STEP_CHOICE)


@claim(
    "4.3-{short}-larger-steps",
    "{cause} makes the integrator's steps larger",
    paper="larger",
    cases=[
        {"short": "friction", "cause": "friction", "change": ("friction", 0.0, 0.1)},
        {"short": "dissipation", "cause": "energy dissipation", "change": ("restitution", 1, 0.9)},
        {
            "short": "small-clearance",
            "cause": "a smaller clearance",
            "change": ("clearance", LARGE, SMALL),
        },
    ],
)
def larger_steps(bench: Bench, change: tuple[str, float, float]) -> Finding:
    """Return the mean step in µs before and after a change of conditions."""
    changes = compare(statistics_table(bench), "step_us", *change)
    return trend_finding(changes, 1, ("larger", "larger"), "{:.2f} µs", "us", STEP_CHOICE)
