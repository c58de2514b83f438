"""Claims: what a paper states in numbers, compared with our own.

A claim is a decorated function in a file of the bench's `reports/claims`. The decorator has the
sentence, the paper's value and the rule; the function computes our value and returns a `Finding`:

    @claim(
        "3.2-below-10-percent",
        "the laws agree to 10 %",
        paper="< 10 %",
        rule="below 10 % at every load",
    )
    def below_10_percent(bench: Bench) -> Finding:
        '''Return the largest difference in percent.'''
        largest = ...
        return Finding(f"{largest:.1f} %", holds=largest < 10)

The files are read in alphabetical order, and the claims of one section stay in the order in
which they are written.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from inspect import signature
from itertools import groupby
from textwrap import wrap
from typing import Any, Literal

import pandas as pd

from cylcontact.errors import InputError
from cylcontact.progress import Progress, silent
from cylcontact.reports.bench import Bench, MissingInputError

__all__ = [
    "VERDICTS",
    "Claim",
    "Finding",
    "Verdict",
    "agrees_as_printed",
    "claim",
    "counts",
    "joined",
    "ledger",
    "listed",
    "to_json",
    "to_records",
    "to_table",
    "to_text",
    "verdict_if",
    "with_unit",
]

Verdict = Literal["reproduced", "reproduced with a stated choice", "not reproduced", "not testable"]
VERDICTS: tuple[Verdict, ...] = (
    "reproduced",
    "reproduced with a stated choice",
    "not reproduced",
    "not testable",
)
LABEL_WIDTH = 10
Case = Mapping[str, Any]


@dataclass(frozen=True)
class Finding:
    """Our side of a claim, computed by its function.

    Attributes
    ----------
    ours : str
        Our value, with its unit.
    holds : bool or None
        Whether the rule is met; None where nothing can be computed.
    choice : str
        The choice of ours that the number rests on, or the reason for the verdict.
    alternatives : str
        The number and the verdict under other reasonable choices.
    values : mapping
        Our numbers in full precision, by a name that ends in the unit.
    paper_values : mapping
        The paper's numbers, where these come from its constants.
    rule : str
        The rule, where its wording depends on the data.
    """

    ours: str
    holds: bool | None
    choice: str = ""
    alternatives: str = ""
    values: Mapping[str, float] = field(default_factory=dict)
    paper_values: Mapping[str, float] = field(default_factory=dict)
    rule: str = ""


@dataclass(frozen=True)
class Claim:
    """A quantitative statement of the paper, our number for it, and whether they agree.

    The verdict follows from `holds` and from whether a choice of ours was needed.

    Attributes
    ----------
    id : str
        Section and short name, such as "3.4-below-8-percent".
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
        The number and the verdict under other reasonable choices.
    paper_values, ours_values : mapping
        The numbers in the texts, from a name that ends in its unit to the full-precision value.
    """

    id: str
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
    def section(self) -> str:
        """The paper's section, the first part of the id."""
        return self.id.partition("-")[0]

    @property
    def verdict(self) -> Verdict:
        """The verdict that follows from `holds` and `choice`."""
        if self.holds is None:
            return "not testable"
        if not self.holds:
            return "not reproduced"
        return "reproduced with a stated choice" if self.choice else "reproduced"


@dataclass(frozen=True)
class ClaimFunction:
    """A decorated function: called with a bench, it returns one claim per case."""

    function: Callable[..., Finding]
    texts: tuple[str, str, str, str]
    paper_values: Mapping[str, float]
    cases: Sequence[Case]

    def __call__(self, bench: Bench) -> list[Claim]:
        return [self._one(bench, case) for case in self.cases]

    def _one(self, bench: Bench, case: Case) -> Claim:
        available = {"bench": bench, **case}
        parameters = signature(self.function).parameters
        try:
            finding = self.function(**{k: v for k, v in available.items() if k in parameters})
        except MissingInputError as error:
            finding = Finding("", None, choice=str(error))
        *texts, rule = self.texts
        # Without a case, braces in the texts are left alone.
        id, statement, paper, rule = (
            text.format(**case) if case else text for text in (*texts, finding.rule or rule)
        )
        return Claim(
            id,
            statement,
            paper,
            finding.ours,
            rule,
            finding.holds,
            finding.choice,
            finding.alternatives,
            {**self.paper_values, **finding.paper_values},
            finding.values,
        )


def claim(
    id: str,
    statement: str,
    *,
    paper: str,
    rule: str = "",
    paper_values: Mapping[str, float] | None = None,
    cases: Sequence[Case] = ({},),
) -> Callable[[Callable[..., Finding]], ClaimFunction]:
    """Return a decorator that makes a claim of a function.

    Parameters
    ----------
    id : str
        Section, hyphen, short name.
    statement : str
        What the paper says, in our words.
    paper : str
        The paper's value as printed, with its unit.
    rule : str, optional
        What must be true for the statement to count as reproduced; left out where the function
        words it.
    paper_values : mapping of str to float, optional
        The numbers in `paper`, by a name that ends in the unit.
    cases : sequence of mapping, optional
        One claim is made for each. Its values replace their names in braces in the texts, and the
        function gets those that it has parameters for. It gets the bench as `bench`, if it has
        that parameter.

    Examples
    --------
    >>> from pathlib import Path
    >>> @claim("2-{name}-is-even", "{name} is even", paper="even", rule="2 divides it",
    ...        cases=[{"name": "four", "number": 4}, {"name": "seven", "number": 7}])
    ... def is_even(number):
    ...     return Finding(f"remainder {number % 2}", holds=number % 2 == 0)
    >>> for each in is_even(Bench(Path("bench"))):
    ...     print(f"{each.id}, {each.statement}: {each.ours}, {each.verdict}")
    2-four-is-even, four is even: remainder 0, reproduced
    2-seven-is-even, seven is even: remainder 1, not reproduced
    """
    texts = (id, statement, paper, rule)
    return lambda function: ClaimFunction(function, texts, paper_values or {}, cases)


def ledger(bench: Bench, progress: Progress = silent) -> list[Claim]:
    """Compute every claim of a bench.

    Parameters
    ----------
    bench : Bench
        The claims are in its `reports/claims/*.py`; its `jobs` run the mechanism's cases.
    progress : callable, optional
        Called with the stage, how many functions have been evaluated and their total.

    Returns
    -------
    list of Claim
        In the order of the paper's sections. A claim whose input has not been made is not
        testable.

    Raises
    ------
    InputError
        If two claims have the same id, or an input is wrong.
    """
    functions = _claim_functions(bench)
    claims: list[Claim] = []
    progress("claims", 0, len(functions))
    for done, function in enumerate(functions, start=1):
        claims += function(bench)
        progress("claims", done, len(functions))
    _require_different_ids(claims, bench)
    return sorted(claims, key=lambda each: each.section)


def _claim_functions(bench: Bench) -> list[ClaimFunction]:
    """Return the claims of a bench, file by file in the order in which they are written."""
    functions: list[ClaimFunction] = []
    for file in sorted((bench.recipes_folder / "claims").glob("*.py"), key=lambda path: path.stem):
        module = bench.module(f"claims.{file.stem}")
        functions += [
            value
            for value in vars(module).values()
            if isinstance(value, ClaimFunction) and value.function.__module__ == module.__name__
        ]
    return functions


def _require_different_ids(claims: Iterable[Claim], bench: Bench) -> None:
    """Refuse two claims with one id."""
    seen: set[str] = set()
    for each in claims:
        if each.id in seen:
            raise InputError(
                str(bench.recipes_folder / "claims"),
                "id",
                each.id,
                "two claims have this id",
                "give one of them another",
            )
        seen.add(each.id)


def counts(claims: Iterable[Claim]) -> dict[Verdict, int]:
    """Return how many claims have each verdict, zeros included."""
    verdicts = [each.verdict for each in claims]
    return {verdict: verdicts.count(verdict) for verdict in VERDICTS}


# Helpers for the texts of claims.


def joined(*parts: str) -> str:
    """Return the parts that are not empty, separated by semicolons."""
    return "; ".join(filter(None, parts))


def verdict_if(holds: bool) -> str:
    """Return the verdict that an alternative choice would lead to, in parentheses."""
    return "(reproduced)" if holds else "(not reproduced)"


def agrees_as_printed(value: float, printed: str) -> bool:
    """Whether `value`, rounded to as many decimals as `printed` shows, is that number.

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


# The ledger as text, table, CSV and JSON.


def to_text(claims: Sequence[Claim], terms: Mapping[str, str], width: int = 100) -> str:
    """Return the ledger for reading: definitions, claims by section, count of verdicts.

    Parameters
    ----------
    claims : sequence of Claim
        In the order to print.
    terms : mapping of str to str
        The paper's definitions, term → meaning.
    width : int
        Columns of the terminal.

    Returns
    -------
    str
    """
    lines = ["Definitions", ""] if terms else []
    for term, meaning in terms.items():
        lines += [*_entry(f"{term}:", meaning, width, len(term) + 2), ""]
    for section, members in groupby(claims, key=lambda each: each.section):
        lines += [f"Section {section}", "─" * width, ""]
        for each in members:
            lines += [*_claim_lines(each, width), ""]
    return "\n".join([*lines, *_count_lines(claims)]) + "\n"


def _claim_lines(one: Claim, width: int) -> list[str]:
    """Return the lines of one claim: the id with the verdict, then the texts."""
    entries = (
        ("claim", one.statement),
        ("paper", one.paper),
        ("ours", one.ours),
        ("rule", one.rule),
        (_choice_label(one), one.choice),
        ("otherwise", one.alternatives),
    )
    lines = [f"{one.id}  [{one.verdict}]"]
    for label, text in entries:
        if text:
            lines += _entry(f"  {label}", text, width, LABEL_WIDTH + 2)
    return lines


def _choice_label(one: Claim) -> str:
    """Return the label of the text in `choice`, which depends on the verdict."""
    return {"not testable": "reason", "not reproduced": "basis"}.get(one.verdict, "choice")


def _entry(label: str, text: str, width: int, indent: int) -> list[str]:
    """Return the lines of a text that is wrapped to the right of its label."""
    start = f"{label:<{indent}}"
    rest = " " * (LABEL_WIDTH + 2)
    return wrap(text, width, initial_indent=start, subsequent_indent=rest, break_on_hyphens=False)


def _count_lines(claims: Sequence[Claim]) -> list[str]:
    """Return the closing count."""
    return [
        "Verdicts",
        *(f"  {number:3d}  {verdict}" for verdict, number in counts(claims).items()),
        f"  {len(claims):3d}  in all",
    ]


def to_records(claims: Iterable[Claim]) -> list[dict[str, Any]]:
    """Return each claim as plain values, the verdict among them."""
    return [
        {
            "id": each.id,
            "section": each.section,
            "statement": each.statement,
            "paper": each.paper,
            "ours": each.ours,
            "rule": each.rule,
            "verdict": each.verdict,
            "choice": each.choice,
            "alternatives": each.alternatives,
            "paper_values": {k: float(v) for k, v in each.paper_values.items()},
            "ours_values": {k: float(v) for k, v in each.ours_values.items()},
        }
        for each in claims
    ]


def to_table(claims: Iterable[Claim]) -> pd.DataFrame:
    """Return the ledger as a table, one row per claim; the values are JSON text in their cells."""
    records = to_records(claims)
    for record in records:
        for column in ("paper_values", "ours_values"):
            record[column] = json.dumps(record[column], ensure_ascii=False)
    return pd.DataFrame.from_records(records)


def to_json(claims: Sequence[Claim], terms: Mapping[str, str]) -> str:
    """Return definitions, claims and counts as JSON text."""
    document = {
        "definitions": dict(terms),
        "claims": to_records(claims),
        "counts": counts(claims),
    }
    return json.dumps(document, ensure_ascii=False, indent=2) + "\n"
