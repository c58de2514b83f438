"""The fits side by side: coefficients of all campaigns, and those that have none."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from cylcontact.errors import InputError
from cylcontact.fitting.result import FitResult
from cylcontact.fitting.verdicts import verdicts
from cylcontact.reports.bench import Bench

NOTHING = "–"


@dataclass(frozen=True)
class Campaigns:
    """The bench's fit results, and why others are missing."""

    results: Mapping[str, FitResult]
    missing: Mapping[str, str]


@dataclass(frozen=True)
class Column:
    """One fit in a table: its name, what it was fitted to, and its cells."""

    name: str
    about: str
    cells: tuple[str, ...]
    verdicts: tuple[str, ...]


@dataclass(frozen=True)
class Table:
    """The fits of one law and contact side by side.

    Attributes
    ----------
    law, contact : str
        What they have in common.
    rows : tuple of str
        The names of the rows, coefficients first.
    coefficients : int
        How many rows are coefficients.
    published : tuple of str
        The column of the published values.
    columns : tuple of Column
        One for each fit.
    """

    law: str
    contact: str
    rows: tuple[str, ...]
    coefficients: int
    published: tuple[str, ...]
    columns: tuple[Column, ...]


def read_campaigns(bench: Bench) -> Campaigns:
    """Read every result of the bench; a result that is not there or not right has a reason."""
    results, missing = {}, {}
    campaigns = {path.stem for path in (bench.root / "fitting").glob("*.toml")}
    names = campaigns | {path.stem for path in bench.results_folder.glob("*.json")}
    for name in sorted(names):
        try:
            results[name] = bench.result(name)
        except InputError as error:
            missing[name] = str(error)
    return Campaigns(results, missing)


def tables(results: Mapping[str, FitResult]) -> list[Table]:
    """Return the fits side by side, those of one law and contact in one table.

    Parameters
    ----------
    results : mapping of str to FitResult
        By name.

    Returns
    -------
    list of Table
        The largest first.
    """
    groups: dict[tuple[str, str], list[FitResult]] = {}
    for result in results.values():
        groups.setdefault((result.law, result.contact), []).append(result)
    ordered = sorted(groups.items(), key=lambda item: (-len(item[1]), item[0]))
    return [_table(law, contact, members) for (law, contact), members in ordered]


def headline(results: Mapping[str, FitResult]) -> list[Table]:
    """Return the two main fits, each beside the published coefficients, as far as they exist."""
    main = [results[name] for name in ("internal", "external") if name in results]
    return [
        replace(table, columns=tuple(replace(c, name="refit", about="") for c in table.columns))
        for table in (_table(result.law, result.contact, [result]) for result in main)
    ]


def _table(law: str, contact: str, results: Sequence[FitResult]) -> Table:
    """Return one table."""
    # Some results of a group may have been made where nothing was published.
    published = next((r.published for r in results if r.published is not None), None)
    names = tuple(results[0].coefficients)
    rows = (
        *names,
        "objective",
        "published, same data",
        "lower bound",
        "largest |Eq 9|, %",
        "samples",
        "masked",
    )
    paper = (
        [f"{published.coefficients[n]:g}" for n in names] if published else [NOTHING] * len(names)
    )
    return Table(
        law,
        contact,
        rows,
        len(names),
        (*paper, *[NOTHING] * (len(rows) - len(names))),
        tuple(_column(result) for result in results),
    )


def _column(result: FitResult) -> Column:
    """Return one fit's cells, in the order of the rows."""
    published = result.published.objective if result.published else None
    cells = (
        *(f"{value:.5g}" for value in result.coefficients.values()),
        f"{result.objective.value:.5g}",
        _number(published),
        _number(result.bound),
        f"{result.max_abs_diff_percent.fitted:.4g}",
        f"{result.counts.samples:,}".replace(",", "\u2009"),
        f"{result.counts.masked:,}".replace(",", "\u2009"),
    )
    about = f"to {result.reference}, {result.objective.name}"
    return Column(result.name, about, cells, tuple(verdicts(result)))


def _number(value: float | None) -> str:
    """Return a number, or a dash where there is none."""
    return NOTHING if value is None else f"{value:.5g}"
