"""Claims: what a paper says in numbers, held against numbers that are computed.

A claim is a decorated function in a file of the bench's `reports/claims`. The decorator has the
sentence, the paper's value and the rule; the function computes and returns what we find:

    @claim(
        "3.2-below-10-percent",
        "the laws agree to 10 %",
        paper="< 10 %",
        rule="below 10 % at every load",
    )
    def below_10_percent(bench: Bench) -> Finding:
        largest = ...
        return Finding(f"{largest:.1f} %", holds=largest < 10)

The files are searched in alphabetical order, and the claims of one section stay in the order in
which they are written.
"""

from __future__ import annotations

import ast
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
from pathlib import Path
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
    "to_csv",
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
    """What a claim's function found out.

    Attributes
    ----------
    ours : str
        Our value, with its unit.
    holds : bool or None
        Whether the rule is met; None where nothing can be computed.
    choice : str
        The choice of ours that the number rests on, or the reason for the verdict.
    alternatives : str
        What becomes of the number and the verdict under other reasonable choices.
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
    """A quantitative statement of the paper, what it says, what we compute, and whether they agree.

    The verdict is never given: it follows from `holds`, which the claim's function computes by
    `rule`, and from whether a choice of ours was needed to compute it.

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
        What becomes of the number and the verdict under other reasonable choices.
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


# A claim's function, with the decorator's words attached: from a bench to its claims.
ClaimFunction = Callable[[Bench], list[Claim]]


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
        For statements that differ in a value only: one claim for each, whose values go to the
        function as keywords and into the texts where these have the key in braces.

    Examples
    --------
    >>> @claim("2-{name}-is-even", "{name} is even", paper="even", rule="2 divides it",
    ...        cases=[{"name": "four", "number": 4}, {"name": "seven", "number": 7}])
    ... def is_even(bench, name, number):
    ...     return Finding(f"remainder {number % 2}", holds=number % 2 == 0)
    >>> for each in is_even(Bench(Path("bench"))):
    ...     print(f"{each.id}, {each.statement}: {each.ours}, {each.verdict}")
    2-four-is-even, four is even: remainder 0, reproduced
    2-seven-is-even, seven is even: remainder 1, not reproduced
    """
    numbers = dict(paper_values or {})

    def decorate(function: Callable[..., Finding]) -> ClaimFunction:
        def compute(bench: Bench) -> list[Claim]:
            return [one(bench, case) for case in cases]

        def one(bench: Bench, case: Case) -> Claim:
            try:
                finding = function(bench, **case)
            except MissingInputError as error:
                finding = Finding("", None, choice=str(error))
            texts = [id, statement, paper, finding.rule or rule]
            own_id, sentence, printed, wanted = (_filled(text, case) for text in texts)
            return Claim(
                own_id,
                sentence,
                printed,
                finding.ours,
                wanted,
                finding.holds,
                finding.choice,
                finding.alternatives,
                numbers | dict(finding.paper_values),
                finding.values,
            )

        compute.__name__, compute.__doc__ = function.__name__, function.__doc__
        compute.__module__ = function.__module__
        compute.is_claim = True  # type: ignore[attr-defined]
        return compute

    return decorate


def _filled(text: str, case: Case) -> str:
    """Return a text with a case's values in it; without a case its braces are left alone."""
    return text.format(**case) if case else text


def ledger(bench: Bench, progress: Progress = silent) -> list[Claim]:
    """Compute every claim of a bench.

    Parameters
    ----------
    bench : Bench
        Its `reports/claims/*.py` are searched, and its `jobs` run what takes long.
    progress : callable, optional
        Called with the stage, how many functions have been evaluated and their total.

    Returns
    -------
    list of Claim
        In the order of the paper's sections. A claim that needs an input that has not been made
        cannot be tested and says so.

    Raises
    ------
    InputError
        If two claims have the same id, or an input is wrong.
    """
    functions = [
        function for file in claim_files(bench) for function in _claim_functions(bench, file)
    ]
    claims: list[Claim] = []
    progress("claims", 0, len(functions))
    for done, function in enumerate(functions, start=1):
        claims += function(bench)
        progress("claims", done, len(functions))
    _require_different_ids(claims, bench)
    return sorted(claims, key=lambda each: each.section)


def claim_files(bench: Bench) -> list[Path]:
    """Return the files with claims, in alphabetical order of their names; others help these."""
    files = sorted((bench.recipes_folder / "claims").glob("*.py"), key=lambda file: file.stem)
    return [file for file in files if _has_claims(file)]


def _has_claims(file: Path) -> bool:
    """Whether a function in a file is decorated with `claim`."""
    try:
        tree = ast.parse(file.read_text(encoding="utf-8"))
    except (SyntaxError, ValueError) as error:
        rule, remedy = f"is not Python ({error})", "correct it"
        raise InputError(str(file), "", None, rule, remedy) from None
    decorators = [
        decorator.func.id
        for node in tree.body
        if isinstance(node, ast.FunctionDef)
        for decorator in node.decorator_list
        if isinstance(decorator, ast.Call) and isinstance(decorator.func, ast.Name)
    ]
    return "claim" in decorators


def _claim_functions(bench: Bench, file: Path) -> list[ClaimFunction]:
    """Return the claims of a file in the order in which they are written there."""
    module = bench.module(f"claims.{file.stem}")
    return [
        function
        for function in vars(module).values()
        if getattr(function, "is_claim", False) and function.__module__ == module.__name__
    ]


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


# What claims put their texts together with.


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


# The ledger as text for a terminal, as a table, as CSV and as JSON.


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
    """Return one claim: a heading with the verdict, then what is behind it."""
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
    """Return what the text in `choice` is for this verdict."""
    return {"not testable": "reason", "not reproduced": "basis"}.get(one.verdict, "choice")


def _entry(label: str, text: str, width: int, indent: int) -> list[str]:
    """Return a label with its text wrapped beside it."""
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


def to_csv(claims: Iterable[Claim]) -> str:
    """Return the table as CSV text."""
    return to_table(claims).to_csv(index=False, lineterminator="\n")


def to_json(claims: Sequence[Claim], terms: Mapping[str, str]) -> str:
    """Return definitions, claims and counts as JSON text."""
    whole = {
        "definitions": dict(terms),
        "claims": to_records(claims),
        "counts": counts(claims),
    }
    return json.dumps(whole, ensure_ascii=False, indent=2) + "\n"
