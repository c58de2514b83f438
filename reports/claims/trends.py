"""How a number of the mechanism's runs changes with one condition, all others alike."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import pandas as pd

from ..slider_crank import AGAINST, LAW_NAMES

# What the names of the table's columns end in: at the spec's tolerance, and at a tighter one.
RUNS = ("", AGAINST)

# A change that is less than this share of the larger value is none, however sure.
FLOOR = 0.05
# Nor is one within this two-sided confidence of Student's t.
CONFIDENCE = 0.95
CERTAIN = (
    f"by over {FLOOR:.0%} and beyond {CONFIDENCE:.0%} confidence (Student's t) at both tolerances"
)
# So many pairs are told one by one.
FEW = 6
CONDITIONS = ("law", "clearance", "restitution", "friction")
FORMS = {
    "clearance": "{:g} mm",
    "restitution": "c_e = {:g}",
    "friction": "c_f = {:g}",
}


@dataclass(frozen=True)
class Pair:
    """A number under two conditions, from runs at one tolerance.

    Attributes
    ----------
    before, after : float
        Means over the revolutions.
    error : float
        The standard error of their difference, taking revolutions for independent.
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
        What is alike in both.
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
        """The first value in the mean over the tolerances."""
        return float(np.mean([pair.before for pair in self.pairs]))

    @property
    def after(self) -> float:
        """The second value in the mean over the tolerances."""
        return float(np.mean([pair.after for pair in self.pairs]))

    @property
    def relative(self) -> float:
        """The change as a share of the larger value, in the mean over the tolerances."""
        return float(np.mean([pair.relative for pair in self.pairs]))

    @property
    def error(self) -> float:
        """The standard error of `relative` at one tolerance.

        The largest of what the scatter from revolution to revolution gives, and what the
        difference between the tolerances does.
        """
        within = [pair.error / pair.scale for pair in self.pairs if pair.scale]
        between = float(np.std([pair.relative for pair in self.pairs], ddof=1))
        return max(*within, between) if within else between

    @property
    def margin(self) -> float:
        """How far `relative` may be off, by `CONFIDENCE`."""
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
        signs = {
            int(np.sign(pair.relative)) if abs(pair.relative) > least else 0 for pair in self.pairs
        }
        return signs.pop() if len(signs) == 1 else 0


def changes(
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
        Of `runs.statistics_table`.
    column : str
        The number that is compared.
    condition : str
        One of `CONDITIONS`.
    before, after : object
        Its two values.
    among : mapping, optional
        Conditions → the values that are looked at; the others count with all of theirs.

    Returns
    -------
    list of Change
    """
    chosen = table
    for key, values in (among or {}).items():
        chosen = chosen[chosen[key].isin(list(values))]
    others = [name for name in CONDITIONS if name != condition]
    first, second = (
        chosen[chosen[condition] == value].set_index(others).to_dict("index")
        for value in (before, after)
    )
    found = []
    for names, one in first.items():
        other = second[names]
        pairs = tuple(_pair(one, other, column, run) for run in RUNS)
        told = told_case(dict(zip(others, cast(tuple[Any, ...], names), strict=True)))
        found.append(Change(told, pairs, min(one["counted"], other["counted"]) - 1))
    return found


def _pair(one: Mapping[Any, Any], other: Mapping[Any, Any], column: str, run: str) -> Pair:
    errors = [row[f"{column}_std{run}"] / np.sqrt(row["counted"]) for row in (one, other)]
    return Pair(float(one[column + run]), float(other[column + run]), float(np.hypot(*errors)))


def told_case(conditions: Mapping[str, object]) -> str:
    """Name a case by its conditions."""
    parts = [
        LAW_NAMES[str(value)] if name == "law" else FORMS[name].format(value)
        for name, value in conditions.items()
    ]
    return " ".join(parts)


def rule(found: Sequence[Change]) -> str:
    """Return when a trend counts, with the number of pairs.

    Examples
    --------
    >>> print(rule([Change("", (Pair(1, 2, 0.1),) * 2, 4)] * 12))
    in more than half of the 12 pairs by over 5% and beyond 95% confidence (Student's t) at both
    tolerances, the reverse in none
    """
    return f"in more than half of the {len(found)} pairs {CERTAIN}, the reverse in none"


def trend(found: Sequence[Change], sign: int) -> bool:
    """Tell whether more than half of the changes have that sign and none has the other.

    Examples
    --------
    >>> up, flat = (Change("", (Pair(1, after, 0.1),) * 2, 4) for after in (2, 1))
    >>> trend([up, flat, up], 1)
    True
    """
    signs = [change.sign for change in found]
    return signs.count(sign) > len(signs) / 2 and -sign not in signs


def tally(found: Sequence[Change], sign: int) -> str:
    """Say in how many pairs the change has the sign, the other, or neither.

    Examples
    --------
    >>> pairs = {"a": Pair(1, 2, 0.1), "b": Pair(1, 0.5, 0.1), "c": Pair(1, 1, 0.1)}
    >>> tally([Change(name, (pair, pair), 4) for name, pair in pairs.items()], 1)
    'in 1 of 3 pairs; the reverse in 1 (b); undecided in 1 (c)'
    """
    reverse = [change.name for change in found if change.sign == -sign]
    undecided = [change.name for change in found if change.sign == 0]
    told = [f"in {sum(c.sign == sign for c in found)} of {len(found)} pairs"]
    told += [f"the reverse in {len(reverse)} ({', '.join(reverse)})"] if reverse else []
    told += [f"undecided in {len(undecided)} ({', '.join(undecided)})"] if undecided else []
    return "; ".join(told)


def shown(found: Sequence[Change], form: str) -> str:
    """List the values of every pair where they are few, else tell the range of their ratio.

    Examples
    --------
    >>> shown([Change("Johnson", (Pair(1.0, 2.0, 0.1),) * 2, 4)], "{:.1f} µs")
    'Johnson 1.0 µs → 2.0 µs'
    """
    if len(found) <= FEW:
        return ", ".join(
            f"{c.name} {form.format(c.before)} → {form.format(c.after)}" for c in found
        )
    ratios = [c.after / c.before for c in found if c.before]
    return f"ratios from {min(ratios):.2f} to {max(ratios):.2f}" if ratios else "from 0 in all"


def as_values(found: Sequence[Change], unit: str) -> dict[str, float]:
    """Return both values of every pair by name."""
    before = {f"{c.name}, before, {unit}": c.before for c in found}
    return before | {f"{c.name}, after, {unit}": c.after for c in found}
