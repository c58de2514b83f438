"""How a number of the mechanism's runs changes with one condition while all others stay the same."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import pandas as pd

from cylcontact.reports.claims import Finding

from ..paper import JOINT_LAWS
from ..slider_crank import AGAINST

# Endings of the table's columns: at the spec's tolerance, and at a tighter one.
RUNS = ("", AGAINST)

# Changes below this share of the larger value do not count, however significant.
FLOOR = 0.05
# Nor do changes within this two-sided confidence of Student's t.
CONFIDENCE = 0.95
CERTAIN = (
    f"by over {FLOOR:.0%} and beyond {CONFIDENCE:.0%} confidence (Student's t) at both tolerances"
)
FEW = 6  # up to so many pairs are listed one by one
CONDITIONS = ("law", "clearance", "restitution", "friction")
FORMS = {"clearance": "{:g} mm", "restitution": "c_e = {:g}", "friction": "c_f = {:g}"}


@dataclass(frozen=True)
class Pair:
    """A number under two conditions, from runs at one tolerance.

    Attributes
    ----------
    before, after : float
        Means over the revolutions.
    error : float
        The standard error of their difference, if revolutions are independent.
    """

    before: float
    after: float
    error: float

    @property
    def scale(self) -> float:
        """The larger of both values."""
        return max(abs(self.before), abs(self.after))

    @property
    def relative(self) -> float:
        """The change as a share of the larger value, from −1 to 1 for numbers above 0."""
        return (self.after - self.before) / self.scale if self.scale else 0.0


@dataclass(frozen=True)
class Change:
    """A number under two conditions, from runs at several tolerances.

    Attributes
    ----------
    name : str
        The conditions that both have in common.
    pairs : tuple of Pair
        One for each tolerance.
    freedom : float
        Degrees of freedom of the errors: the fewest revolutions of a mean, less one.
    """

    name: str
    pairs: tuple[Pair, ...]
    freedom: float

    @property
    def before(self) -> float:
        """The first value, averaged over the tolerances."""
        return float(np.mean([pair.before for pair in self.pairs]))

    @property
    def after(self) -> float:
        """The second value, averaged over the tolerances."""
        return float(np.mean([pair.after for pair in self.pairs]))

    @property
    def relative(self) -> float:
        """The change as a share of the larger value, averaged over the tolerances."""
        return float(np.mean([pair.relative for pair in self.pairs]))

    @property
    def error(self) -> float:
        """The standard error of `relative` at one tolerance.

        The largest of those from the scatter between revolutions and of that from the difference
        between the tolerances.
        """
        within = [pair.error / pair.scale for pair in self.pairs if pair.scale]
        between = float(np.std([pair.relative for pair in self.pairs], ddof=1))
        return max(*within, between) if within else between

    @property
    def margin(self) -> float:
        """The half-width of the confidence interval of `relative`."""
        from scipy.special import stdtrit

        return float(stdtrit(self.freedom, 0.5 + CONFIDENCE / 2)) * self.error

    @property
    def sign(self) -> int:
        """1 if the number rises at every tolerance, −1 if it falls, 0 if that is undecided.

        Examples
        --------
        >>> sure, small = Pair(1.0, 2.0, 0.1), Pair(1.0, 1.1, 0.1)
        >>> Change("", (sure, sure), 4).sign, Change("", (sure, small), 4).sign
        (1, 0)
        """
        least = max(FLOOR, self.margin)
        signs = {np.sign(p.relative) if abs(p.relative) > least else 0 for p in self.pairs}
        return int(signs.pop()) if len(signs) == 1 else 0


def compare(
    table: pd.DataFrame,
    column: str,
    condition: str,
    before: object,
    after: object,
    among: Mapping[str, Sequence[object]] | None = None,
) -> list[Change]:
    """Compare every case with the one that differs from it in one condition only.

    Parameters
    ----------
    table : pandas.DataFrame
        From `slider_crank.statistics_table`.
    column : str
        The number that is compared.
    condition : str
        One of `CONDITIONS`.
    before, after : object
        Its two values.
    among : mapping, optional
        Conditions → the values to include; all values of the others are included.

    Returns
    -------
    list of Change
    """
    for key, values in (among or {}).items():
        table = table[table[key].isin(list(values))]
    others = [name for name in CONDITIONS if name != condition]
    first, second = (
        table[table[condition] == value].set_index(others).to_dict("index")
        for value in (before, after)
    )
    changes = []
    for key, one in first.items():
        other = second[key]
        pairs = tuple(_pair(one, other, column, run) for run in RUNS)
        name = case_name(dict(zip(others, cast(tuple[Any, ...], key), strict=True)))
        changes.append(Change(name, pairs, min(one["counted"], other["counted"]) - 1))
    return changes


def _pair(one: Mapping[Any, Any], other: Mapping[Any, Any], column: str, run: str) -> Pair:
    """Return a number of two rows at one tolerance."""
    errors = [row[f"{column}_std{run}"] / np.sqrt(row["counted"]) for row in (one, other)]
    return Pair(float(one[column + run]), float(other[column + run]), float(np.hypot(*errors)))


def case_name(conditions: Mapping[str, Any]) -> str:
    """Return the name of a case.

    Examples
    --------
    >>> case_name({"law": "johnson", "clearance": 0.5, "friction": 0.1})
    'Johnson 0.5 mm c_f = 0.1'
    """
    return " ".join(
        JOINT_LAWS[value] if condition == "law" else FORMS[condition].format(value)
        for condition, value in conditions.items()
    )


def rule(changes: Sequence[Change]) -> str:
    """Return when a trend counts, with the number of pairs.

    Examples
    --------
    >>> print(rule([Change("", (Pair(1, 2, 0.1),) * 2, 4)] * 12))
    in more than half of the 12 pairs by over 5% and beyond 95% confidence (Student's t) at both
    tolerances, the reverse in none
    """
    return f"in more than half of the {len(changes)} pairs {CERTAIN}, the reverse in none"


def is_trend(changes: Sequence[Change], sign: int) -> bool:
    """Whether more than half of the changes have that sign and none has the other.

    Examples
    --------
    >>> up, flat = (Change("", (Pair(1, after, 0.1),) * 2, 4) for after in (2, 1))
    >>> is_trend([up, flat, up], 1)
    True
    """
    signs = [change.sign for change in changes]
    return signs.count(sign) > len(signs) / 2 and -sign not in signs


def tally(changes: Sequence[Change], sign: int) -> str:
    """Return in how many pairs the change has the sign, the other, or neither.

    Examples
    --------
    >>> pairs = {"a": Pair(1, 2, 0.1), "b": Pair(1, 0.5, 0.1), "c": Pair(1, 1, 0.1)}
    >>> tally([Change(name, (pair, pair), 4) for name, pair in pairs.items()], 1)
    'in 1 of 3 pairs; the reverse in 1 (b); undecided in 1 (c)'
    """
    parts = [f"in {sum(c.sign == sign for c in changes)} of {len(changes)} pairs"]
    for text, other in (("the reverse", -sign), ("undecided", 0)):
        names = [change.name for change in changes if change.sign == other]
        parts += [f"{text} in {len(names)} ({', '.join(names)})"] if names else []
    return "; ".join(parts)


def values_or_ratios(changes: Sequence[Change], form: str) -> str:
    """Return the values of a few pairs, or the range of the ratios of many.

    Examples
    --------
    >>> values_or_ratios([Change("Johnson", (Pair(1.0, 2.0, 0.1),) * 2, 4)], "{:.1f} µs")
    'Johnson 1.0 µs → 2.0 µs'
    """
    if len(changes) <= FEW:
        return ", ".join(
            f"{c.name} {form.format(c.before)} → {form.format(c.after)}" for c in changes
        )
    ratios = [c.after / c.before for c in changes if c.before]
    return f"ratios from {min(ratios):.2f} to {max(ratios):.2f}" if ratios else "from 0 in all"


def as_values(changes: Sequence[Change], unit: str) -> dict[str, float]:
    """Return both values of every pair by name."""
    before = {f"{c.name}, before, {unit}": c.before for c in changes}
    return before | {f"{c.name}, after, {unit}": c.after for c in changes}


def trend_finding(
    changes: Sequence[Change],
    sign: int,
    texts: tuple[str, str],
    form: str,
    unit: str,
    choice: str,
    alternatives: str = "",
) -> Finding:
    """Return the finding on a claimed trend.

    Parameters
    ----------
    changes : sequence of Change
        From `compare`.
    sign : int
        1 for a rise, −1 for a fall.
    texts : tuple of str
        The beginnings of our value and of the rule.
    form, unit : str
        The format of a value in the text, and the unit in the names of the values.
    choice, alternatives : str, optional
        As in `Finding`.
    """
    ours, condition = texts
    return Finding(
        f"{ours} {tally(changes, sign)}: {values_or_ratios(changes, form)}",
        holds=is_trend(changes, sign),
        choice=choice,
        alternatives=alternatives,
        values=as_values(changes, unit),
        rule=f"{condition} {rule(changes)}",
    )
