"""One statement of the paper held against computed numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

Verdict = Literal["reproduced", "reproduced with a stated choice", "not reproduced", "not testable"]
VERDICTS: tuple[Verdict, ...] = (
    "reproduced",
    "reproduced with a stated choice",
    "not reproduced",
    "not testable",
)


@dataclass(frozen=True)
class Claim:
    """A quantitative statement of the paper, what it says, what we compute, and whether they agree.

    The verdict is never given: it follows from `holds`, which the function that builds the
    claim computes by `rule`, and from whether a choice of ours was needed to compute it.

    Attributes
    ----------
    id : str
        Section and short name, such as "3.4-below-8-percent".
    section : str
        The paper's section.
    statement : str
        What the paper says, in our words.
    paper : str
        The paper's value as printed, with its unit.
    ours : str
        Our value, with its unit.
    rule : str
        What must be true for the statement to count as reproduced.
    holds : bool or None
        Whether the rule is met; None where nothing can be computed.
    choice : str
        The choice of ours that the number rests on, or the reason for the verdict.
    alternatives : str
        What becomes of the number and the verdict under other reasonable choices.
    paper_values, ours_values : mapping
        The numbers in the texts, from a name that ends in its unit to the full-precision value.
    """

    id: str
    section: str
    statement: str
    paper: str
    ours: str
    rule: str
    holds: bool | None
    choice: str = ""
    alternatives: str = ""
    paper_values: Mapping[str, float] = field(default_factory=dict)
    ours_values: Mapping[str, float] = field(default_factory=dict)

    @property
    def verdict(self) -> Verdict:
        """The verdict that follows from `holds` and `choice`."""
        if self.holds is None:
            return "not testable"
        if not self.holds:
            return "not reproduced"
        return "reproduced with a stated choice" if self.choice else "reproduced"


def joined(*parts: str) -> str:
    """Return the parts that are not empty, separated by semicolons."""
    return "; ".join(filter(None, parts))


def verdict_if(holds: bool) -> str:
    """Return the verdict that an alternative choice would lead to, in parentheses."""
    return "(reproduced)" if holds else "(not reproduced)"


def agrees_as_printed(value: float, printed: str) -> bool:
    """Tell whether `value`, rounded to as many decimals as `printed` shows, is that number.

    Examples
    --------
    >>> agrees_as_printed(1.23700027, "1.2370"), agrees_as_printed(1.0939, "1.0935")
    (True, False)
    """
    decimals = len(printed.partition(".")[2])
    return round(value, decimals) == float(printed)


def listed(values: Mapping[str, object], form: str, separator: str = ", ") -> str:
    """Return "name value, name value, …" with each value formatted by `form`.

    Examples
    --------
    >>> listed({"steel": 1.25, "titanium": 2.0}, "{:.1f} %")
    'steel 1.2 %, titanium 2.0 %'
    """
    return separator.join(f"{name} {form.format(value)}" for name, value in values.items())


def with_unit(values: Mapping[str, float], unit: str) -> dict[str, float]:
    """Return `values` under names that end in `unit`.

    Examples
    --------
    >>> with_unit({"steel": 1.25}, "percent")
    {'steel, percent': 1.25}
    """
    return {f"{name}, {unit}": value for name, value in values.items()}
