"""Manuscripts whose numbers, tables and figures come from results.

A manuscript is a file in pandoc's Markdown. In place of a number it names one, `{{GROUP.NAME}}`,
and may give a format, `{{GROUP.NAME:.2g}}`; see `Quantity.text`. The groups are

- `fit.RESULT`: the coefficients and objectives of a fit result;
- `figure.RECIPE`: the headlines and the caption of a figure;
- `claims`: how many statements of the paper have each verdict;
- every function of the file `values.py` beside the manuscript. It takes the bench, and returns
  quantities, texts and tables (DataFrames) by name.

`values.py` may also list, in `HOLDS`, phrases of the text that are true only as long as the results
say so: phrase → a function of the bench that returns whether they do.
"""

from __future__ import annotations

import inspect
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pandas as pd

from cylcontact.choices import first_of
from cylcontact.errors import InputError
from cylcontact.fitting.law_models import units_of
from cylcontact.fitting.results import DataFit, FitResult, LawFit
from cylcontact.reports.bench import Bench
from cylcontact.reports.build import FigureResult
from cylcontact.reports.claims import ledger
from cylcontact.reports.claims_text import counts
from cylcontact.reports.quantity import FORMAT, Quantity, Symbol, markdown

__all__ = [
    "PLACEHOLDER",
    "Filled",
    "Group",
    "Value",
    "Values",
    "figures_named",
    "fill",
    "own_values",
    "require_holds",
    "table_text",
]

Value = Quantity | str | pd.DataFrame
Group = Mapping[str, Value]

PLACEHOLDER = re.compile(r"\{\{\s*([^{}\n]*?)\s*\}\}")
# The kinds of groups of which there are many: `fit.internal`, `figure.fig12`.
_OF_MANY = ("fit", "figure")
_GIVEN = (*_OF_MANY, "claims")
# Names that a message lists.
_NAMED = 12
# Characters of the widest column of a table, relative to which the others are shortened.
_WIDEST = 40


@dataclass(frozen=True)
class Filled:
    """A manuscript with its numbers.

    Attributes
    ----------
    text : str
        The Markdown.
    numbers : list of dict
        A row for each placeholder: its line, the value in full precision, and its unit.
    tables : dict of str to DataFrame
        The tables, by the placeholder that names them.
    """

    text: str
    numbers: list[dict[str, Any]]
    tables: dict[str, pd.DataFrame]


class _NoValueError(Exception):
    """A placeholder that names no value: the rule it breaks, and the remedy."""


@dataclass(frozen=True)
class Values:
    """The values that a manuscript can name, each group computed once, when it is first named.

    Parameters
    ----------
    bench : Bench
        The bench.
    source : path
        The manuscript.
    figures : mapping of str to FigureResult, optional
        The figures drawn for it, by recipe.
    """

    bench: Bench
    source: Path
    figures: Mapping[str, FigureResult] = field(default_factory=dict)
    _groups: dict[str, Group] = field(default_factory=dict, repr=False)

    @property
    def names_own(self) -> bool:
        """Whether a value of `values.py` has been named."""
        return any(group.partition(".")[0] not in _GIVEN for group in self._groups)

    def find(self, name: str) -> Value:
        """Return the value of a name."""
        group, key = self._split(name)
        if group not in self._groups:
            self._groups[group] = self._compute(group)
        values = self._groups[group]
        if key not in values:
            raise _NoValueError("names no value", f"{group} has {first_of(values, _NAMED)}")
        return values[key]

    @staticmethod
    def _split(name: str) -> tuple[str, str]:
        """Return the group of a value, and the value's name in it."""
        group, _, key = name.partition(".")
        if group not in _OF_MANY:
            return group, key
        member, _, key = key.partition(".")
        if not member or Path(member).name != member:
            raise _NoValueError(f"names no {group}", f"write {{{{{group}.NAME.…}}}}")
        return f"{group}.{member}", key

    def _compute(self, group: str) -> Group:
        """Return the values of a group."""
        kind, _, member = group.partition(".")
        if kind == "fit":
            return _of_fit(_result(self.bench, member))
        if kind == "figure":
            return _of_figure(self.figures[member])
        if kind == "claims":
            return _of_claims(self.bench)
        own = own_values(self.bench, self.source)
        file = self.source.with_name("values.py")
        functions = _functions(own, file) if own else {}
        if group not in functions:
            known = first_of([*_GIVEN, *functions], _NAMED)
            rule, remedy = "names no group of values", f"choose {known}, or add it to values.py"
            raise _NoValueError(rule, remedy)
        return _as_group(_called(functions[group], group, self.bench, file), group, file)


def fill(text: str, values: Values) -> Filled:
    """Return a manuscript with its numbers in place of the placeholders.

    Parameters
    ----------
    text : str
        The Markdown.
    values : Values
        What it may name.

    Raises
    ------
    InputError
        If a placeholder names nothing, has a wrong format, or stands where its value cannot; the
        message has its line.

    Examples
    --------
    >>> from cylcontact.files import shipped_bench
    >>> values = Values(Bench(shipped_bench()), Path("mine.md"))
    >>> print(fill("The error is {{fit.internal.objective:.2g}}.", values).text)
    The error is 0.064.
    """
    filled = Filled("", [], {})

    def replaced(found: re.Match[str]) -> str:
        line = text.count("\n", 0, found.start()) + 1
        name, colon, form = found[1].rpartition(":")
        if not colon or not FORMAT.fullmatch(form):
            name, form = found[1], ""
        try:
            value = values.find(name)
            put = _text(value, form)
            _require_room(found, value)
        except _NoValueError as error:
            where = f"{values.source}, line {line}"
            raise InputError(where, "", found[0], *error.args) from None
        if isinstance(value, pd.DataFrame):
            filled.tables[name] = value
        filled.numbers.append({"line": line, "placeholder": found[1], **_row(value)})
        return put

    return Filled(PLACEHOLDER.sub(replaced, text), filled.numbers, filled.tables)


def _require_room(found: re.Match[str], value: Value) -> None:
    """Refuse a placeholder whose surroundings its value would change."""
    before, after = found.string[: found.start()], found.string[found.end() :]
    if isinstance(value, pd.DataFrame) and not (
        before.endswith("\n\n") and (after.startswith("\n\n") or not after.strip())
    ):
        raise _NoValueError("is a table", "put it in a paragraph of its own")
    if before.endswith("$") or after[:1].isalnum():
        raise _NoValueError("touches other text", "put a space between them")


def figures_named(text: str) -> list[str]:
    """Return the recipes whose headlines or captions a manuscript names.

    Examples
    --------
    >>> figures_named("{{figure.fig12.caption}} {{ figure.fig10.highest difference, % }}")
    ['fig10', 'fig12']
    """
    names = (found[1].split(".") for found in PLACEHOLDER.finditer(text))
    return sorted({parts[1] for parts in names if parts[0] == "figure" and any(parts[1:2])})


# --- a user's own values ------------------------------------------------------------------------


def own_values(bench: Bench, source: Path) -> ModuleType | None:
    """Return the module `values.py` beside a manuscript of a bench; None if there is none."""
    folder = source.resolve().parent
    if not (folder / "values.py").is_file():
        return None
    try:
        parts = folder.relative_to(bench.recipes_folder.resolve()).parts
    except ValueError:
        rule = f"is not in {bench.recipes_folder}, so its values.py cannot import from there"
        remedy = "move the manuscript there, or work in its bench"
        raise InputError(str(source), "", None, rule, remedy) from None
    if any("." in part for part in parts):
        rule = "has a dot in its name, so Python cannot import values.py from it"
        raise InputError(str(folder), "", None, rule, "rename the folder")
    return bench.module(".".join((*parts, "values")))


def require_holds(text: str, bench: Bench, source: Path) -> list[str]:
    """Require that the results support the phrases of a manuscript that depend on them.

    Parameters
    ----------
    text : str
        The manuscript, with its placeholders.
    bench : Bench
        The bench with the results.
    source : path
        The manuscript's file, whose `values.py` lists such phrases in `HOLDS`.

    Returns
    -------
    list of str
        The phrases of `HOLDS` that the manuscript does not have.

    Raises
    ------
    InputError
        If a phrase is not true any more, or `HOLDS` is wrong.
    """
    own, file = own_values(bench, source), source.with_name("values.py")
    phrases = _phrases(own, file) if own else {}
    words = " ".join(text.split())
    present = {phrase for phrase in phrases if " ".join(phrase.split()) in words}
    for phrase in (phrase for phrase in phrases if phrase in present):
        holds = _called(phrases[phrase], phrase, bench, file)
        if not isinstance(holds, bool | np.bool_):
            rule = "is not answered with True or False"
            raise InputError(str(file), phrase, holds, rule, "correct the function")
        if not holds:
            rule = "is not what the results say any more"
            remedy = "rewrite it, and its entry in HOLDS"
            raise InputError(str(source), "", phrase, rule, remedy)
    return [phrase for phrase in phrases if phrase not in present]


def _phrases(own: ModuleType, file: Path) -> Mapping[str, Callable[[Bench], object]]:
    """Return the phrases of `HOLDS`, each with its function."""
    phrases = getattr(own, "HOLDS", {})
    if not isinstance(phrases, Mapping) or not all(
        isinstance(phrase, str) and callable(function) for phrase, function in phrases.items()
    ):
        rule, remedy = "is no dict of phrases and functions", "write {phrase: function}"
        raise InputError(str(file), "HOLDS", None, rule, remedy)
    return phrases


def _functions(own: ModuleType, file: Path) -> dict[str, Callable[[Bench], object]]:
    """Return the groups of `values.py`: its public functions of one argument, the bench."""
    guards = _phrases(own, file).values()
    functions = {
        name: value
        for name, value in vars(own).items()
        if not name.startswith("_") and _takes_a_bench(value) and value not in guards
    }
    for name in _GIVEN:
        if name in functions:
            raise InputError(str(file), name, None, "is a group already", "rename the function")
    return functions


def _takes_a_bench(value: object) -> bool:
    """Return whether this is a function with one argument called `bench`."""
    if not callable(value) or inspect.isclass(value):
        return False
    try:
        return list(inspect.signature(value).parameters) == ["bench"]
    except (TypeError, ValueError):
        return False


def _called(function: Callable[[Bench], object], name: str, bench: Bench, file: Path) -> Any:
    """Return what a function of a user's `values.py` returns."""
    try:
        return function(bench)
    except InputError as error:
        if error.source != "Quantity":
            raise
        raise InputError(
            str(file), f"{name}: {error.key}", error.value, error.rule, error.remedy
        ) from error
    except (Exception, SystemExit) as error:
        rule = f"failed with {type(error).__name__} ({error})"
        raise InputError(str(file), name, None, rule, "correct the file") from error


def _as_group(values: object, group: str, file: Path) -> Group:
    """Return what a function of `values.py` has returned; refuse what is no group of values."""
    if not isinstance(values, Mapping):
        rule = "returns no dict of quantities, texts and tables"
        raise InputError(str(file), group, values, rule, "correct the function")
    for name, value in values.items():
        if not isinstance(name, str) or not isinstance(value, Quantity | str | pd.DataFrame):
            rule = "is neither a quantity nor a text nor a table"
            raise InputError(str(file), f"{group}.{name}", value, rule, "correct the function")
    return values


# --- values as Markdown -------------------------------------------------------------------------


def _row(value: Value) -> dict[str, Any]:
    """Return a value for the list of numbers."""
    if isinstance(value, Quantity):
        return {"value": " to ".join(map(repr, value.ends)), "unit": value.unit}
    return {"value": value if isinstance(value, str) else f"{len(value)} rows", "unit": ""}


def _text(value: Value, form: str) -> str:
    """Return a value as Markdown."""
    if isinstance(value, Quantity):
        try:
            return value.text(form)
        except ValueError as error:
            rule, _, remedy = str(error).partition("; ")
            raise _NoValueError(rule, remedy) from None
    if form:
        raise _NoValueError("is no number", f"leave out :{form}")
    if isinstance(value, str):
        return markdown(value)
    if value.empty:
        raise _NoValueError("is a table without rows", "leave it out")
    return table_text(value)


def table_text(table: pd.DataFrame) -> str:
    r"""Return a table as Markdown, its columns as wide as their texts need.

    Columns of numbers are aligned to the right.

    Examples
    --------
    >>> print(table_text(pd.DataFrame({"law": ["Johnson"], "error, %": ["1.5"]})))
    | law | error\, \% |
    |:------------|------------:|
    | Johnson | 1\.5 |
    """
    rows = [list(table.columns), *(list(row) for row in table.astype(object).to_numpy())]
    columns = list(zip(*rows, strict=True))
    widths = [min(max(_width(head), *map(_length, cells)), _WIDEST) for head, *cells in columns]
    right = [all(map(_is_number, column[1:])) for column in columns]
    # Pandoc takes the share of a column from the hyphens below its heading.
    rules = [
        f"{'-' * (width + 5)}:" if end else f":{'-' * (width + 5)}"
        for width, end in zip(widths, right, strict=True)
    ]
    lines = [f"| {' | '.join(map(_cell, row))} |" for row in rows]
    return "\n".join([lines[0], f"|{'|'.join(rules)}|", *lines[1:]])


def _length(cell: object) -> int:
    """Return about how many characters of a cell are seen."""
    return len(re.sub(r"\\[a-z]+|[{}\s\\]", "", cell) if isinstance(cell, Symbol) else str(cell))


def _width(head: object) -> int:
    """Return the characters that a heading needs, whose words may be on several lines."""
    if isinstance(head, Symbol):
        return _length(head)
    return max(map(len, str(head).split()), default=0) + 1


def _cell(cell: object) -> str:
    """Return a cell of a table as Markdown, numbers with four digits."""
    if isinstance(cell, Symbol):
        return f"${cell}$"
    if isinstance(cell, float):
        return Quantity(cell, digits=4).text()
    return markdown(str(cell)).replace(r"$\mu$", "µ")


def _is_number(cell: object) -> bool:
    """Return whether a cell is a number, maybe with its error or a star, or stands for none."""
    number = r"[+−-]?[\d.]+"
    return re.fullmatch(rf"({number}( ± {number})?\*?|–)?", str(cell)) is not None


# --- values of results --------------------------------------------------------------------------


def _result(bench: Bench, name: str) -> FitResult:
    """Return a campaign's result, or that of a fit to a table, by the table's name."""
    campaign = bench.results_folder / f"{name}.json"
    files = [
        *([campaign] if campaign.is_file() else []),
        *(
            file
            for file in sorted((bench.root / "datasets").rglob("result.json"))
            if file.parent.name == name and file.parent.parent.name == "results"
        ),
    ]
    if len(files) > 1:
        rule, remedy = f"is {files[0]} and {files[1]}", "rename one of them"
        raise _NoValueError(rule, remedy)
    return FitResult.read(bench.noted(files[0])) if files else bench.result(name)


def _of_fit(result: FitResult) -> Group:
    """Return the coefficients of a result, with their intervals, and its objectives."""
    units = units_of(result.law, result.contact)
    values: dict[str, Value] = {
        name: Quantity(value, units.get(name, ""), 4) for name, value in result.coefficients.items()
    }
    values["objective"] = Quantity(result.objective.value)
    values["samples"] = Quantity(result.counts.samples)
    if isinstance(result, LawFit) and result.bound is not None:
        values["bound"] = Quantity(result.bound)
    if result.published is not None:
        values["published"] = Quantity(result.published.objective)
    if not isinstance(result, DataFit):
        return values
    values["level"] = Quantity(100 * result.uncertainty.level, "%", 2)
    for name, estimate in result.uncertainty.estimates.items():
        ends = estimate.profile or estimate
        if ends.low is None or ends.high is None:
            continue
        unit, digits = units.get(name, ""), _digits(ends.low, ends.high)
        values[name] = Quantity(estimate.value, unit, digits)
        values[f"{name}.interval"] = Quantity((ends.low, ends.high), unit, digits)
    return values


def _digits(low: float, high: float) -> int:
    """Return the significant digits that show an interval's width with two."""
    width, largest = abs(high - low), max(abs(low), abs(high))
    return max(2, math.floor(math.log10(largest / width)) + 2) if width > 0 else 4


def _of_figure(figure: FigureResult) -> Group:
    """Return the headlines of a figure, whose names end in their unit, and its caption."""
    values: dict[str, Value] = {"caption": figure.caption}
    for name, value in figure.headline.items():
        unit = re.search(r", (\S+)$", name)
        values[name] = Quantity(float(value), unit[1] if unit else "")
    return values


def _of_claims(bench: Bench) -> Group:
    """Return how many statements can be tested, and how many have each verdict."""
    number = counts(ledger(bench))
    plain, chosen = number["reproduced"], number["reproduced with a stated choice"]
    named = {
        "testable": sum(number.values()) - number["not testable"],
        "reproduced": plain + chosen,
        "as_printed": plain,
        "with_a_choice": chosen,
        "not_reproduced": number["not reproduced"],
        "undecided": number["undecided"],
        "missing_input": number["depends on a missing input"],
        "not_testable": number["not testable"],
    }
    return {name: Quantity(count) for name, count in named.items()}
