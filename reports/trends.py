"""Changes of a number in the mechanism's runs with one condition, the others being equal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import pandas as pd
from scipy.special import stdtrit

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.reports.claims import Finding

from .paper import JOINT_LAWS
from .slider_crank import AGAINST

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
class Change:
    """A number under two conditions, from runs at several tolerances.

    Attributes
    ----------
    name : str
        The conditions that both have in common.
    by_run : array of float
        Before and after, the means over the revolutions, and the standard error of their
        difference if revolutions are independent; a column for each tolerance.
    freedom : float
        Degrees of freedom of the errors: the fewest revolutions of a mean, less one.
    """

    name: str
    by_run: FloatArray
    freedom: float

    @property
    def before(self) -> float:
        """The first value, averaged over the tolerances."""
        return float(self.by_run[0].mean())

    @property
    def after(self) -> float:
        """The second value, averaged over the tolerances."""
        return float(self.by_run[1].mean())

    @property
    def shares(self) -> FloatArray:
        """The change and its standard error as shares of the larger value, by tolerance."""
        before, after, error = self.by_run
        scale = np.maximum(np.abs(before), np.abs(after))
        return as_floats(np.array([after - before, error]) / np.where(scale > 0, scale, np.inf))

    @property
    def relative(self) -> float:
        """The change as a share of the larger value, averaged over the tolerances."""
        return float(self.shares[0].mean())

    @property
    def margin(self) -> float:
        """The half-width of the confidence interval of `relative`.

        The error is the largest of those from the scatter between revolutions and of that from
        the difference between the tolerances.
        """
        changes, errors = self.shares
        error = max(*errors, np.std(changes, ddof=1))
        return float(stdtrit(self.freedom, 0.5 + CONFIDENCE / 2) * error)

    @property
    def sign(self) -> int:
        """1 if the number rises at every tolerance, −1 if it falls, 0 if that is undecided.

        Examples
        --------
        >>> sure = Change("", np.array([[1.0, 1.0], [2.0, 2.0], [0.1, 0.1]]), 4)
        >>> small = Change("", np.array([[1.0, 1.0], [2.0, 1.1], [0.1, 0.1]]), 4)
        >>> sure.sign, small.sign
        (1, 0)
        """
        changes = self.shares[0]
        signs = np.sign(changes) * (np.abs(changes) > max(FLOOR, self.margin))
        return int(signs[0]) if np.all(signs == signs[0]) else 0


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
    for key, chosen in (among or {}).items():
        table = table[table[key].isin(list(chosen))]
    others = [name for name in CONDITIONS if name != condition]
    first, second = (
        table[table[condition] == value].set_index(others).to_dict("index")
        for value in (before, after)
    )
    changes = []
    for case, one in first.items():
        pair = one, second[case]
        values = [[row[column + run] for run in RUNS] for row in pair]
        errors = [
            [row[f"{column}_std{run}"] / np.sqrt(row["counted"]) for run in RUNS] for row in pair
        ]
        name = case_name(dict(zip(others, cast(tuple[Any, ...], case), strict=True)))
        by_run = as_floats([*values, np.hypot(errors[0], errors[1])])
        freedom = min(row["counted"] for row in pair) - 1
        changes.append(Change(name, by_run, freedom))
    return changes


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
    >>> print(rule([Change("", np.ones((3, 2)), 4)] * 12))
    in more than half of the 12 pairs by over 5% and beyond 95% confidence (Student's t) at both
    tolerances, the reverse in none
    """
    return f"in more than half of the {len(changes)} pairs {CERTAIN}, the reverse in none"


def is_trend(changes: Sequence[Change], sign: int) -> bool:
    """Whether more than half of the changes have that sign and none has the other.

    Examples
    --------
    >>> up, flat = (Change("", np.array([[1, 1], [to, to], [0.1, 0.1]]), 4) for to in (2, 1))
    >>> is_trend([up, flat, up], 1)
    True
    """
    signs = [change.sign for change in changes]
    return signs.count(sign) > len(signs) / 2 and -sign not in signs


def tally(changes: Sequence[Change], sign: int) -> str:
    """Return in how many pairs the change has the sign, the other, or neither.

    Examples
    --------
    >>> values = {"a": (1, 2), "b": (2, 1), "c": (1, 1)}
    >>> tally([Change(n, np.array([[x, x], [y, y], [0, 0]]), 4) for n, (x, y) in values.items()], 1)
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
    >>> values_or_ratios([Change("Johnson", np.array([[1.0], [2.0], [0.1]]), 4)], "{:.1f} µs")
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
