"""Sections 4.3 and 5: when the journal touches the bearing, and how often it hits it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import pandas as pd

from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim, listed, verdict_if, with_unit

from ..slider_crank import (
    CLEARANCES,
    FIRST,
    LAW_NAMES,
    REVOLUTIONS,
    TIGHTER,
    WHIRLING,
    WHIRLING_REVOLUTIONS,
    statistics_table,
)
from .trends import (
    RUNS,
    Change,
    as_values,
    changes,
    rule,
    shown,
    tally,
    trend,
)

SPHERE, *CYLINDERS = LAW_NAMES
LARGE, SMALL = CLEARANCES
BASIS = (
    f"geometry and masses assumed (Table 2 is missing); means over revolutions {FIRST + 1} to "
    f"{REVOLUTIONS} (to {WHIRLING_REVOLUTIONS} at {WHIRLING.clearance:g} mm with "
    f"c_e = {WHIRLING.restitution:g} and c_f = {WHIRLING.friction:g}, where a whirl along the wall "
    "lasts for a number of revolutions that hangs on the tolerance, and then stops), after the "
    "start-up and where sensitive runs have parted, of two runs for each case, at the spec's "
    f"tolerance and at {TIGHTER:g} of it"
)
# What counts as contact without end.
CONTINUOUS = 0.99
MOSTLY = 0.5
ROUGH: Mapping[str, Sequence[object]] = {"friction": [0.1]}


def _elastic(table: pd.DataFrame, column: str, run: str = RUNS[0]) -> dict[str, list[float]]:
    """Return a number at both clearances for the cases without losses, by law."""
    chosen = table[(table["restitution"] == 1.0) & (table["friction"] == 0.0)]
    found = chosen.set_index(["law", "clearance"])[column + run].to_dict()
    return {LAW_NAMES[law]: [float(found[law, c]) for c in (SMALL, LARGE)] for law in LAW_NAMES}


def _always(table: pd.DataFrame, column: str, holds: Callable[[float, float], bool]) -> bool:
    """Tell whether small and large clearance stand so for every law, at both tolerances."""
    return all(
        holds(small, large)
        for run in RUNS
        for small, large in _elastic(table, column, run).values()
    )


def _at_least(table: pd.DataFrame, share: float) -> pd.DataFrame:
    """Return the cases in contact for at least that share of the time, at both tolerances."""
    return table[(table[[f"contact_fraction{run}" for run in RUNS]] >= share).all(axis=1)]


def _told(found: dict[str, list[float]], form: str) -> str:
    return listed({k: f"{form.format(a)} → {form.format(b)}" for k, (a, b) in found.items()}, "{}")


def _values(found: dict[str, list[float]], unit: str) -> dict[str, float]:
    return {
        f"{law}, {clearance:g} mm, {unit}": value
        for law, pair in found.items()
        for clearance, value in zip((SMALL, LARGE), pair, strict=True)
    }


@claim(
    "4.3-longer-flights",
    "without losses all laws predict longer free flights at the larger clearance",
    paper="longer",
    rule="longer for every law at both tolerances",
)
def longer_flights(bench: Bench) -> Finding:
    """Return the mean duration of a flight at both clearances."""
    table = statistics_table(bench)
    found = _elastic(table, "flight_us")
    return Finding(
        f"mean duration of a flight, {SMALL:g} → {LARGE:g} mm: {_told(found, '{:.0f} µs')}",
        holds=_always(table, "flight_us", lambda small, large: large > small),
        choice=BASIS,
        values=_values(found, "us"),
    )


@claim(
    "4.3-shorter-contacts",
    "without losses all laws predict shorter contacts at the larger clearance",
    paper="shorter",
    rule="shorter for every law at both tolerances",
)
def shorter_contacts(bench: Bench) -> Finding:
    """Return the mean duration of a contact at both clearances."""
    table = statistics_table(bench)
    found, share = _elastic(table, "contact_us"), _elastic(table, "contact_fraction")
    by_share = _always(table, "contact_fraction", lambda small, large: large < small)
    return Finding(
        f"mean duration of a contact, {SMALL:g} → {LARGE:g} mm: {_told(found, '{:.1f} µs')}",
        holds=_always(table, "contact_us", lambda small, large: large < small),
        choice=BASIS,
        alternatives=(
            f"by their share of the time, {_told(share, '{:.2f}')}, contacts are shorter "
            f"{verdict_if(by_share)}"
        ),
        values=_values(found, "us") | _values(share, "share of time"),
    )


@claim(
    "4.3-dissipation-keeps-contact",
    "with c_e = 0.9 most trajectories show continuous contact",
    paper="most",
    rule="more than half of the cases, each at both tolerances",
)
def dissipation_keeps_contact(bench: Bench) -> Finding:
    """Return how many runs with dissipation are in contact nearly all the time."""
    table = statistics_table(bench)
    lossy = table[table["restitution"] == 0.9]
    count, total = len(_at_least(lossy, CONTINUOUS)), len(lossy)
    smooth = lossy[lossy["friction"] == 0.0]
    kept = _at_least(smooth, CONTINUOUS)
    by_clearance = [
        f"{(kept['clearance'] == c).sum()} of {(smooth['clearance'] == c).sum()} at {c:g} mm"
        for c in CLEARANCES
    ]
    large = smooth[smooth["clearance"] == LARGE]
    shares = {LAW_NAMES[r["law"]]: r["contact_fraction"] for r in large.to_dict("records")}
    return Finding(
        f"{count} of {total} cases with c_e = 0.9 are in contact {CONTINUOUS:.0%} of the time",
        holds=count > total / 2,
        choice=f"{BASIS}; 'continuous' is at least {CONTINUOUS:.0%} of the time",
        alternatives=(
            f"without friction {' and '.join(by_clearance)}; the share of time at {LARGE:g} mm is "
            f"then {listed(shares, '{:.2f}')} {verdict_if(len(kept) > len(smooth) / 2)}"
        ),
        values=(
            {"cases in contact, -": float(count), "cases, -": float(total)}
            | with_unit(shares, "share of time at 0.5 mm without friction")
        ),
    )


@claim(
    "4.3-friction-keeps-contact",
    "with friction the trajectories are mostly in contact",
    paper="mostly in contact",
    rule="half of the time or more in every case with c_f = 0.1, at both tolerances",
)
def friction_keeps_contact(bench: Bench) -> Finding:
    """Return the share of time in contact with friction, and what friction changes."""
    table = statistics_table(bench)
    rough = table[table["friction"] > 0]
    mostly = _at_least(rough, MOSTLY)
    found = changes(table, "contact_fraction", "friction", 0.0, 0.1)
    rest = rough.drop(index=mostly.index)
    low = {
        f"{LAW_NAMES[r['law']]} at {r['clearance']:g} mm, c_e = {r['restitution']:g}": (
            r["contact_fraction"]
        )
        for r in rest.to_dict("records")
    }
    told = f"; not so: {listed(low, '{:.2f}')}" if low else ""
    return Finding(
        f"half of the time or more in {len(mostly)} of {len(rough)} cases{told}",
        holds=len(mostly) == len(rough),
        choice=BASIS,
        alternatives=f"friction lengthens the time in contact {tally(found, 1)}",
        values=as_values(found, "share of time"),
    )


def against_sphere(
    table: pd.DataFrame, column: str, among: Mapping[str, Sequence[object]] = ROUGH
) -> list[Change]:
    """Compare both cylindrical laws with the sphere, by default in the cases with friction."""
    return [
        replace(change, name=f"{LAW_NAMES[law]} {change.name}")
        for law in CYLINDERS
        for change in changes(table, column, "law", SPHERE, law, among)
    ]


@claim(
    "4.3-sphere-most-in-contact",
    "with friction contact lasts longest with Lankarani and Nikravesh's law",
    paper="more evident for that law",
)
def sphere_most_in_contact(bench: Bench) -> Finding:
    """Return whether the sphere is the longest in contact with friction."""
    table = statistics_table(bench)
    found = against_sphere(table, "contact_fraction")
    return Finding(
        f"a cylindrical law is less in contact {tally(found, -1)}",
        holds=trend(found, -1),
        choice=BASIS,
        alternatives=shown(found, "{:.3f}"),
        values=as_values(found, "share of time"),
        rule=f"less in contact {rule(found)}",
    )


@claim(
    "4.3-friction-fewer-flights",
    "with cylindrical laws free flights are rarer with friction than without",
    paper="reduced frequency",
)
def friction_means_fewer_flights(bench: Bench) -> Finding:
    """Return impacts per revolution without and with friction, for the cylindrical laws."""
    table = statistics_table(bench)
    found = changes(table, "impacts", "friction", 0.0, 0.1, {"law": CYLINDERS})
    lively = [change for change in found if change.before > 0]
    return Finding(
        f"impacts per revolution fall {tally(lively, -1)}: {shown(lively, '{:.1f}')}",
        holds=trend(lively, -1),
        choice=BASIS,
        values=as_values(lively, "impacts per revolution"),
        rule=f"they fall {rule(lively)}, of those that fly without friction",
    )


@claim(
    "4.3-small-clearance-smoother",
    "a smaller clearance makes for fewer impacts",
    paper="fewer impacts, long contacts",
)
def small_clearance_fewer_impacts(bench: Bench) -> Finding:
    """Return impacts per revolution at both clearances."""
    table = statistics_table(bench)
    found = changes(table, "impacts", "clearance", LARGE, SMALL)
    share = changes(table, "contact_fraction", "clearance", LARGE, SMALL)
    return Finding(
        f"impacts per revolution fall {tally(found, -1)}: {shown(found, '{:.1f}')}",
        holds=trend(found, -1),
        choice=BASIS,
        alternatives=f"the share of time in contact rises {tally(share, 1)}",
        values=as_values(found, "impacts per revolution"),
        rule=f"they fall {rule(found)}",
    )


@claim(
    "5-flight-prevails-without-losses",
    "without losses free flight prevails over contact",
    paper="prevalence of free flight",
    rule="below one half for every law and clearance at both tolerances",
)
def flight_prevails(bench: Bench) -> Finding:
    """Return the share of time in contact without any losses."""
    table = statistics_table(bench)
    found = _elastic(table, "contact_fraction")
    return Finding(
        f"share of time in contact, {SMALL:g} → {LARGE:g} mm: {_told(found, '{:.2f}')}",
        holds=_always(table, "contact_fraction", lambda small, large: max(small, large) < 0.5),
        choice=BASIS,
        values=_values(found, "share of time"),
    )
