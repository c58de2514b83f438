"""Judgements on the mechanism's runs: how a number changes with one condition, the others equal."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, cast

import numpy as np
import pandas as pd
from scipy.special import stdtrit

from cylcontact.mechanism.batch_means import BATCHES
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding
from cylcontact.reports.claims import Reading as Found

from .long_runs import (
    FIRST,
    LEVEL,
    LIGHT_SET,
    LONG_SET,
    SHORT,
    SPEC_SET,
    STEP_CONTROLLED,
    STEP_CONTROLS,
    WINDOWS,
    statistics_table,
)
from .paper import INTEGRATOR, JOINT_LAWS, TABLE_2, WINDOW
from .slider_crank import LAW_NAMES

# Ours: a number that changes by less than this share of the first value counts as equal, and a
# trend fails only if some comparison goes the other way by more.
FLOOR = 0.05
FEW = 3  # up to so many changes are listed one by one
CONDITIONS = ("law", "clearance", "restitution", "friction")
FORMS = {"clearance": "{:g} mm", "restitution": "c_e = {:g}", "friction": "c_f = {:g}"}
EQUAL = f"within {100 * FLOOR:g} % counts as equal (ours)"
ALL = f"in every comparison, beyond the {100 * LEVEL:g} % interval; {EQUAL}"
# Where runs without losses are among them.
SCATTER = f"in every comparison, beyond the scatter of batches; {EQUAL}"

# The name and the format of a number in a sentence, and its unit in the names of values.
NUMBERS = {
    "flight_us": ("mean duration of a flight", "{:.0f} µs", "us"),
    "step_us": ("mean step", "{:.1f} µs", "us"),
    "evaluations": ("evaluations per revolution", "{:.0f}", "evaluations"),
    "mean_force_N": ("mean force in contact", "{:.0f} N", "N"),
    "mean_penetration_um": ("mean penetration", "{:.2f} µm", "um"),
}
# What the numbers on both sides of an arrow are.
ARROWS = {
    "clearance": "{:g} → {:g} mm",
    "restitution": "c_e = {:g} → {:g}",
    "friction": "without → with friction",
}
Conditions = Mapping[str, Sequence[object]]

Kind = Literal["shows", "equal", "reverse", "open"]


@dataclass(frozen=True)
class Change:
    """A number under two conditions, from two independent runs."""

    name: str
    before: float
    after: float
    half_widths: tuple[float, float] = (np.nan, np.nan)  # NaN without an interval

    @property
    def relative(self) -> float:
        """The change as a share of the first value; infinite from 0."""
        return self._share(self.after - self.before)

    @property
    def margin(self) -> float:
        """The half-width of the interval of `relative` (Welch); 0 where there is no interval."""
        return self._share(self._width)

    def _share(self, value: float) -> float:
        if self.before == 0.0:
            return math.copysign(math.inf, value) if value else 0.0
        return value / abs(self.before)

    @property
    def _width(self) -> float:
        """The half-width of the interval of the difference."""
        freedom, share = BATCHES - 1, 0.5 + LEVEL / 2
        squares = (np.nan_to_num(self.half_widths) / stdtrit(freedom, share)) ** 2
        total = float(squares.sum())
        if total == 0.0:
            return 0.0
        welch = total**2 * freedom / float((squares**2).sum())
        return float(stdtrit(welch, share)) * math.sqrt(total)

    def kind(self, sign: int) -> Kind:
        """Return whether the change has a sign, its reverse, neither, or cannot be told."""
        rise, width = sign * (self.after - self.before), self._width
        floor = FLOOR * abs(self.before)
        if abs(rise) + width <= floor:
            return "equal"
        if rise > max(width, floor):
            return "shows"
        return "reverse" if rise + width < -floor else "open"

    def text(self, form: str) -> str:
        """Return both values, with the unit of `form` once."""
        digits = form.partition(" ")[0]
        return f"{self.name} {digits.format(self.before)} → {form.format(self.after)}".strip()

    @property
    def percent(self) -> str:
        """The change with its margin, in percent of the first value."""
        if self.before == 0.0:
            return self.text("{:.3g}")
        margin = f" ± {100 * self.margin:.2g}" if self.margin > 1e-3 else ""
        return f"{self.name} {100 * self.relative:+.3g}{margin} %".strip()


def compare(
    table: pd.DataFrame,
    column: str,
    condition: str,
    before: object,
    after: object,
    among: Conditions | None = None,
) -> list[Change]:
    """Compare every case with the one that differs from it in one condition only.

    Pairs that lack the number, as the duration of flights without any, are left out.
    """
    for key, chosen in (among or {}).items():
        table = table[table[key].isin(list(chosen))]
    others = [name for name in CONDITIONS if name != condition]
    varied = [name for name in others if table[name].nunique() > 1]
    first, second = (
        table[table[condition] == value].set_index(others).to_dict("index")
        for value in (before, after)
    )
    changes = []
    for case, one in first.items():
        pair = one, second[case]
        conditions = dict(zip(others, cast(tuple[Any, ...], case), strict=True))
        name = case_name({key: conditions[key] for key in varied})
        values = [float(row[column]) for row in pair]
        widths = [float(row[f"{column}_half_width"]) for row in pair]
        if np.isfinite(values).all():
            changes.append(Change(name, values[0], values[1], (widths[0], widths[1])))
    return changes


def case_name(conditions: Mapping[str, Any]) -> str:
    """Return the name of a case.

    Examples
    --------
    >>> case_name({"law": "johnson", "clearance": 0.5, "friction": 0.1})
    'Johnson 0.5 mm c_f = 0.1'
    """
    return " ".join(
        LAW_NAMES[value] if condition == "law" else FORMS[condition].format(value)
        for condition, value in conditions.items()
    )


# What one reading of a claim gives, of the cases of one set of runs.
Judge = Callable[[pd.DataFrame], Finding]


def trend(
    changes: Sequence[Change],
    sign: int,
    verb: str,
    number: tuple[str, str, str],
    numbers: str = "",
) -> Finding:
    """Judge a trend that is claimed of all changes.

    It holds if every one shows it or is equal, and at least half show it; it fails if some change
    certainly goes the other way, or if all are equal; else the runs cannot tell.
    """
    label, form, unit = number
    kinds = [change.kind(sign) for change in changes]
    reverse = [c for c, kind in zip(changes, kinds, strict=True) if kind == "reverse"]
    showing, total = kinds.count("shows"), len(kinds)
    holds: bool | None = None
    miss = ""
    if reverse:
        worst = max(reverse, key=lambda change: abs(change.relative))
        holds, miss = False, f"{len(reverse)} of {total} the other way, most {worst.percent}"
    elif kinds.count("equal") == total:
        holds, miss = False, f"no change above {_largest(changes)}"
    elif "open" not in kinds and 2 * showing >= total:
        holds = True
    if not numbers:
        few = total <= FEW
        numbers = (
            ", ".join(c.text(form) for c in changes) if few else f"factors of {_span(changes)}"
        )
    ours = f"{label}: {numbers}"
    # Numbers that all show it, one by one, speak for themselves.
    if total > FEW or showing < total:
        ours = f"{_counted(changes, kinds, verb)}; {ours}"
    values = {
        ", ".join(filter(None, (c.name, when, unit))): value
        for c in changes
        for when, value in (("before", c.before), ("after", c.after))
    }
    return Finding(ours, holds, miss=miss, values=values)


def _counted(changes: Sequence[Change], kinds: Sequence[Kind], verb: str) -> str:
    """Return in how many comparisons a trend shows."""
    equal, total = kinds.count("equal"), len(kinds)
    if equal == total:
        return f"equal within {_largest(changes)}"
    text = f"{verb} in {kinds.count('shows') or 'none'} of {total} comparisons"
    return f"{text}, equal in {equal}" if equal else text


def _largest(changes: Sequence[Change]) -> str:
    """Return the bound of changes that all count as equal, in percent."""
    largest = max((abs(c.relative) + c.margin for c in changes), default=0.0)
    return f"{max(100 * largest, 0.1):.1f} %"


def _span(changes: Sequence[Change]) -> str:
    """Return the least and the largest ratio of a number after a change to that before."""
    ratios = [c.after / c.before for c in changes]
    return f"{min(ratios):.2f} to {max(ratios):.2f}"


def change_of(
    column: str, change: tuple[str, object, object], sign: int, chosen: Conditions, verb: str
) -> Judge:
    """Return the judgement of a change of one condition among the chosen cases."""
    quantity, form, unit = NUMBERS[column]
    condition, *ends = change
    number = f"{quantity}, {ARROWS[condition].format(*ends)}", form, unit
    return lambda table: trend(compare(table, column, *change, chosen), sign, verb, number)


def cylinders(column: str, sign: int, chosen: Conditions, verb: str) -> Judge:
    """Return the judgement of the cylindrical laws against the sphere."""
    sphere, *others = JOINT_LAWS

    def judge(table: pd.DataFrame) -> Finding:
        changes = [
            replace(change, name=f"{JOINT_LAWS[law]} {change.name}".strip())
            for law in others
            for change in compare(table, column, "law", sphere, law, chosen)
        ]
        times = f"with cylindrical laws {_span(changes)} times that with {JOINT_LAWS[sphere]}"
        return trend(changes, sign, verb, NUMBERS[column], times)

    return judge


def majority(found: Sequence[bool | None]) -> bool | None:
    """Whether more than half hold; None if uncertain ones decide.

    Examples
    --------
    >>> majority([True, True, False]), majority([True, None, False]), majority([True, False])
    (True, None, False)
    """
    yes, maybe = found.count(True), found.count(None)
    return True if 2 * yes > len(found) else False if 2 * (yes + maybe) <= len(found) else None


def above(value: float, half_width: float, bound: float) -> bool | None:
    """Whether a mean is above a bound; None if its interval holds the bound.

    Examples
    --------
    >>> above(0.6, 0.05, 0.5), above(0.4, float("nan"), 0.5), above(0.48, 0.05, 0.5)
    (True, False, None)
    """
    margin = float(np.nan_to_num(half_width))
    return None if abs(value - bound) < margin else value >= bound


def every(found: Sequence[bool | None]) -> bool | None:
    """Whether all hold; None if only uncertain ones stand in the way.

    Examples
    --------
    >>> every([True, True]), every([True, None]), every([None, False])
    (True, None, False)
    """
    return False if False in found else None if None in found else True


@dataclass(frozen=True)
class Reading:
    """A judgement with what it is made on."""

    choice: str
    judge: Judge
    design: str = SPEC_SET
    window: str = ""
    missing: str = ""
    ground: str = ""


def sets(judge: Judge) -> list[Reading]:
    """Return the readings with other masses and lengths."""
    return [
        Reading(SHORT[design], judge, design=design, missing=TABLE_2)
        for design in (LIGHT_SET, LONG_SET)
    ]


def start(judge: Judge) -> Reading:
    """Return the reading of the first revolutions of all runs."""
    first = WINDOWS[0]
    return Reading(f"revolutions 1 to {first}", judge, window=f"1-{first}", missing=WINDOW)


def windows(judge: Judge) -> list[Reading]:
    """Return the readings with shorter windows of the runs without losses."""
    return [
        Reading(
            f"without losses over revolutions {FIRST + 1} to {FIRST + length}",
            judge,
            window=str(length),
            missing=WINDOW,
        )
        for length in WINDOWS
    ]


def integrators(judge: Judge) -> list[Reading]:
    """Return the readings with the paper's control of the step, at two tolerances."""
    length = f"over {STEP_CONTROLLED} revolutions"
    return [
        Reading(f"{name}, {length}", judge, design=name, missing=INTEGRATOR)
        for name in STEP_CONTROLS
    ]


def finding(bench: Bench, readings: Sequence[Reading]) -> Finding:
    """Return the finding of several readings, of which the first is our own."""
    own, *others = readings
    found = []
    for each in readings:
        table = statistics_table(bench, each.design, each.window)
        found.append(each.judge(table[table["law"].isin(JOINT_LAWS)]))
    return replace(
        found[0],
        choice=own.choice,
        missing=own.missing,
        ground=own.ground,
        alternatives=[
            Found(each.choice, got.ours, got.holds, each.missing, got.miss, each.ground)
            for each, got in zip(others, found[1:], strict=True)
        ],
    )
