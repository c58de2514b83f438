"""How a number of the mechanism's runs changes with one condition, all others alike."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import pandas as pd

from cylcontact.reports.mechanism.runs import LAW_NAMES

# A change of so many standard errors is one; less is undecided.
ERRORS = 2.0
RULE = f"in more than half of the pairs by over {ERRORS:g} standard errors, the reverse in none"
# So many pairs are told one by one.
FEW = 6
CONDITIONS = ("law", "clearance", "restitution", "friction")
FORMS = {
    "clearance": "{:g} mm",
    "restitution": "c_e = {:g}",
    "friction": "c_f = {:g}",
}


@dataclass(frozen=True)
class Change:
    """A number under two conditions.

    Attributes
    ----------
    name : str
        What is alike in both.
    before, after : float
        Means over the revolutions.
    error : float
        The standard error of their difference, taking revolutions for independent.
    """

    name: str
    before: float
    after: float
    error: float

    @property
    def sign(self) -> int:
        """1 if the number rises, −1 if it falls, 0 if the scatter does not tell.

        Examples
        --------
        >>> Change("", 1.0, 2.0, 0.1).sign, Change("", 1.0, 1.1, 0.1).sign
        (1, 0)
        """
        difference = self.after - self.before
        return int(np.sign(difference)) if abs(difference) > ERRORS * self.error else 0


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
        error = np.hypot(_standard_error(one, column), _standard_error(other, column))
        told = _told(dict(zip(others, cast(tuple[Any, ...], names), strict=True)))
        found.append(Change(told, float(one[column]), float(other[column]), float(error)))
    return found


def _standard_error(row: Mapping[Any, Any], column: str) -> float:
    return float(row[f"{column}_std"] / np.sqrt(row["counted"]))


def _told(conditions: Mapping[str, object]) -> str:
    """Name a case by its conditions."""
    parts = [
        LAW_NAMES[str(value)] if name == "law" else FORMS[name].format(value)
        for name, value in conditions.items()
    ]
    return " ".join(parts)


def trend(found: Sequence[Change], sign: int) -> bool:
    """Tell whether more than half of the changes have that sign and none has the other.

    Examples
    --------
    >>> trend([Change("a", 1, 2, 0.1), Change("b", 1, 1, 0.1), Change("c", 1, 2, 0.1)], 1)
    True
    """
    signs = [change.sign for change in found]
    return signs.count(sign) > len(signs) / 2 and -sign not in signs


def tally(found: Sequence[Change], sign: int) -> str:
    """Say in how many pairs the change has the sign, the other, or neither.

    Examples
    --------
    >>> tally([Change("a", 1, 2, 0.1), Change("b", 1, 0.5, 0.1), Change("c", 1, 1, 0.1)], 1)
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
    >>> shown([Change("Johnson", 1.0, 2.0, 0.1)], "{:.1f} µs")
    'Johnson 1.0 µs → 2.0 µs'
    """
    if len(found) <= FEW:
        return ", ".join(
            f"{c.name} {form.format(c.before)} → {form.format(c.after)}" for c in found
        )
    ratios = [c.after / c.before for c in found if c.before]
    return f"ratios from {min(ratios):.2f} to {max(ratios):.2f}"


def as_values(found: Sequence[Change], unit: str) -> dict[str, float]:
    """Return both values of every pair by name."""
    before = {f"{c.name}, before, {unit}": c.before for c in found}
    return before | {f"{c.name}, after, {unit}": c.after for c in found}
