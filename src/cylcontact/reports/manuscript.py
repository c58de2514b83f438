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
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import pandas as pd

from cylcontact.errors import InputError
from cylcontact.fitting.law_models import units_of
from cylcontact.fitting.result import FitResult
from cylcontact.plain_text import markdown
from cylcontact.reports.bench import Bench
from cylcontact.reports.build import FigureResult
from cylcontact.reports.claims import ledger
from cylcontact.reports.claims_text import counts
from cylcontact.reports.quantity import FORMAT, Formula, Quantity

__all__ = ["PLACEHOLDER", "Filled", "Values", "figures_named", "fill", "require_holds"]

Value = Quantity | str | pd.DataFrame
Group = Mapping[str, Value]

PLACEHOLDER = re.compile(r"\{\{\s*([^{}\n]*?)\s*\}\}")
# The parts of the name of a group: `fit` and `figure` are followed by the name of one.
_OF_MANY = ("fit", "figure")
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
    """

    text: str
    numbers: list[dict[str, Any]]


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

    def find(self, placeholder: str) -> tuple[Value, str]:
        """Return the value that a placeholder names, and the format it gives.

        Raises
        ------
        ValueError
            If it names nothing; the message is a rule and a remedy.
        InputError
            If the values cannot be computed.
        """
        name, colon, form = placeholder.rpartition(":")
        if not colon or not FORMAT.fullmatch(form):
            name, form = placeholder, ""
        group, _, key = self._split(name)
        if group not in self._groups:
            self._groups[group] = self._compute(group)
        values = self._groups[group]
        if key not in values:
            raise ValueError(f"names no value; {group} has {_some(values)}")
        return values[key], form

    @staticmethod
    def _split(name: str) -> tuple[str, str, str]:
        """Return the group of a value, and the value's name in it."""
        first, dot, rest = name.partition(".")
        if first in _OF_MANY:
            member, dot, rest = rest.partition(".")
            first = f"{first}.{member}"
        return first, dot, rest

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
        functions = _functions(own) if own else {}
        if group not in functions:
            known = _some(["fit", "figure", "claims", *functions])
            raise ValueError(f"names no group of values; choose {known}, or add it to values.py")
        file = self.source.with_name("values.py")
        values = _called(functions[group], self.bench, file)
        kinds = Quantity, str, pd.DataFrame
        if not isinstance(values, Mapping) or not all(
            isinstance(key, str) and isinstance(value, kinds) for key, value in values.items()
        ):
            rule = "returns no dict of quantities, texts and tables"
            raise InputError(str(file), group, values, rule, "correct the file")
        return values


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
        If a placeholder names nothing, with its line.

    Examples
    --------
    >>> from cylcontact.files import shipped_bench
    >>> values = Values(Bench(shipped_bench()), Path("mine.md"))
    >>> print(fill("We find a = {{fit.internal.a:.3g}}.", values).text)
    We find a = 0.872.
    """
    numbers: list[dict[str, Any]] = []

    def replaced(found: re.Match[str]) -> str:
        line = text.count("\n", 0, found.start()) + 1
        try:
            value, form = values.find(found[1])
            put = _text(value, form)
        except ValueError as error:
            if isinstance(error, InputError):
                raise
            rule, _, remedy = str(error).partition("; ")
            where = f"{values.source}, line {line}"
            raise InputError(where, "", found[0], rule, remedy) from None
        numbers.append({"line": line, "placeholder": found[1], **_row(value)})
        return put

    return Filled(PLACEHOLDER.sub(replaced, text), numbers)


def figures_named(text: str) -> list[str]:
    """Return the recipes whose headlines or captions a manuscript names.

    Examples
    --------
    >>> figures_named("{{figure.fig12.caption}} {{ figure.fig10.highest difference, % }}")
    ['fig10', 'fig12']
    """
    names = (found[1].split(".") for found in PLACEHOLDER.finditer(text))
    return sorted({parts[1] for parts in names if parts[0] == "figure" and len(parts) > 1})


def require_holds(text: str, bench: Bench, source: Path) -> None:
    """Raise `InputError` if a phrase of a manuscript is no longer true of the results.

    Parameters
    ----------
    text : str
        The manuscript, with its placeholders.
    bench : Bench
        The bench with the results.
    source : path
        The manuscript's file, whose `values.py` lists such phrases in `HOLDS`.
    """
    own = own_values(bench, source)
    words, file = " ".join(text.split()), source.with_name("values.py")
    for phrase, holds in getattr(own, "HOLDS", {}).items():
        if " ".join(phrase.split()) in words and not _called(holds, bench, file):
            rule = "is not what the results say any more"
            raise InputError(str(source), "", phrase, rule, "rewrite it, and its entry in HOLDS")


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
    return bench.module(".".join((*parts, "values")))


def _functions(module: ModuleType) -> dict[str, Callable[[Bench], Group]]:
    """Return the groups of `values.py`: its public functions of a bench."""
    return {
        name: function
        for name, function in vars(module).items()
        if inspect.isfunction(function)
        and not name.startswith("_")
        and list(inspect.signature(function).parameters) == ["bench"]
    }


def _row(value: Value) -> dict[str, Any]:
    """Return a value for the list of numbers."""
    if isinstance(value, Quantity):
        ends = value.value if isinstance(value.value, tuple) else (value.value,)
        return {"value": " to ".join(map(repr, ends)), "unit": value.unit}
    return {"value": value if isinstance(value, str) else f"{len(value)} rows", "unit": ""}


def _called(function: Callable[[Bench], Any], bench: Bench, file: Path) -> Any:
    """Return what a function of a user's `values.py` returns."""
    name = function.__name__
    try:
        given = function(bench)
    except InputError:
        raise
    except Exception as error:
        rule = f"failed with {type(error).__name__} ({error})"
        raise InputError(str(file), name, None, rule, "correct the file") from error
    return given


def _text(value: Value, form: str) -> str:
    """Return a value as Markdown."""
    if isinstance(value, Quantity):
        return value.text(form)
    if form:
        raise ValueError(f"is no number; leave out :{form}")
    return markdown(value) if isinstance(value, str) else table_text(value)


def table_text(table: pd.DataFrame) -> str:
    r"""Return a table as Markdown, its columns as wide as their texts need.

    Columns of numbers are aligned to the right.

    Examples
    --------
    >>> import pandas as pd
    >>> print(table_text(pd.DataFrame({"law": ["Johnson"], "error, %": ["1.5"]})))
    | law | error\, \% |
    |:------------|--------------:|
    | Johnson | 1.5 |
    """
    rows = [list(table.columns), *(list(row) for row in table.astype(object).to_numpy())]
    widths = [
        min(max(len(str(cell)) for cell in column), _WIDEST) for column in zip(*rows, strict=True)
    ]
    right = [all(map(_is_number, column)) for column in zip(*rows[1:], strict=True)]
    # Pandoc takes the share of a column from the hyphens below its heading.
    rules = [
        f"{'-' * (width + 5)}:" if end else f":{'-' * (width + 5)}"
        for width, end in zip(widths, right or [False] * len(widths), strict=True)
    ]
    lines = [f"| {' | '.join(map(_cell, row))} |" for row in rows]
    return "\n".join([lines[0], f"|{'|'.join(rules)}|", *lines[1:]])


def _cell(cell: object) -> str:
    """Return a cell of a table as Markdown."""
    return f"${cell}$" if isinstance(cell, Formula) else markdown(str(cell))


def _is_number(cell: object) -> bool:
    """Return whether a cell is a number, maybe with its error or a star, or stands for none."""
    number = r"[+−-]?[\d.]+"
    return re.fullmatch(rf"({number}( ± {number})?\*?|–)?", str(cell)) is not None


def _result(bench: Bench, name: str) -> FitResult:
    """Return a campaign's result, or that of a fit to a table, by the table's name."""
    folders = [
        path
        for path in sorted((bench.root / "datasets").rglob("result.json"))
        if path.parent.name == name and path.parent.parent.name == "results"
    ]
    if (bench.results_folder / f"{name}.json").is_file() or not folders:
        return bench.result(name)
    if len(folders) > 1:
        raise ValueError(f"is the name of {folders[0]} and {folders[1]}; rename one of the tables")
    return FitResult.read(bench.noted(folders[0]))


def _of_fit(result: FitResult) -> Group:
    """Return the coefficients of a result, with their intervals, and its objectives."""
    units = units_of(result.law, result.contact)
    values: dict[str, Value] = {
        name: Quantity(value, units.get(name, ""), 4) for name, value in result.coefficients.items()
    }
    values["objective"] = Quantity(result.objective.value)
    values["samples"] = Quantity(result.counts.samples)
    if result.bound is not None:
        values["bound"] = Quantity(result.bound)
    if result.published is not None:
        values["published"] = Quantity(result.published.objective)
    if result.uncertainty is None:
        return values
    values["level"] = Quantity(100 * result.uncertainty.level, "%", 2)
    for name, estimate in result.uncertainty.estimates.items():
        unit, value = units.get(name, ""), estimate.value
        ends = estimate.profile or estimate
        if ends.low is None or ends.high is None:
            continue
        digits = _digits((ends.low, ends.high))
        values[name] = Quantity(value, unit, digits)
        values[f"{name}.interval"] = Quantity((ends.low, ends.high), unit, digits)
    return values


def _digits(ends: tuple[float, float]) -> int:
    """Return the significant digits that show an interval's width with two."""
    width, largest = abs(ends[1] - ends[0]), max(map(abs, ends))
    return max(2, math.floor(math.log10(largest / width)) + 2) if width > 0 else 4


def _of_figure(figure: FigureResult) -> Group:
    """Return the headlines of a figure, whose names end in their unit, and its caption."""
    values: dict[str, Value] = {"caption": figure.caption}
    for name, value in figure.headline.items():
        unit = re.search(r", (\S+)$", name)
        values[name] = Quantity(value, unit[1] if unit else "")
    return values


def _of_claims(bench: Bench) -> Group:
    """Return how many statements can be tested, and how many have each verdict."""
    number = counts(ledger(bench))
    plain, chosen, failed, undecided, hanging, untestable = number.values()
    named = {
        "testable": sum(number.values()) - untestable,
        "reproduced": plain + chosen,
        "as_printed": plain,
        "with_a_choice": chosen,
        "not_reproduced": failed,
        "undecided": undecided,
        "missing_input": hanging,
        "not_testable": untestable,
    }
    return {name: Quantity(count) for name, count in named.items()}


def _some(names: Iterable[str], most: int = 12) -> str:
    """Return names for a message, the first ones if they are many."""
    every = list(names)
    more = f" and {len(every) - most} more" if len(every) > most else ""
    return ", ".join(every[:most]) + more
