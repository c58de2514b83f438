"""Tables of the coefficients of all campaigns, and the results that cannot be read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from cylcontact.errors import InputError
from cylcontact.fitting.comparison import by_search, side_by_side
from cylcontact.fitting.results import FitResult
from cylcontact.reports.bench import Bench

__all__ = [
    "MISSING",
    "Campaigns",
    "Column",
    "Table",
    "headline",
    "made_with",
    "read_campaigns",
    "tables",
]

MISSING = "–"
_ROW_NAMES = {"published objective": "published, same data"}


@dataclass(frozen=True)
class Campaigns:
    """The bench's fit results, and the reasons why others are missing."""

    results: Mapping[str, FitResult]
    missing: Mapping[str, str]


@dataclass(frozen=True)
class Column:
    """One fit in a table: its name, reference and objective, and its cells."""

    name: str
    about: str
    cells: tuple[str, ...]
    verdicts: tuple[str, ...]


@dataclass(frozen=True)
class Table:
    """The fits of one law, contact and search side by side.

    Attributes
    ----------
    law, contact : str
        The law and the contact of the fits.
    rows : tuple of str
        The names of the rows, coefficients first.
    coefficients : int
        The number of rows that are coefficients.
    published : tuple of str
        The column of the published values.
    columns : tuple of Column
        One for each fit.
    recovered : bool
        Whether it is of one fit that fixes or ties coefficients.
    """

    law: str
    contact: str
    rows: tuple[str, ...]
    coefficients: int
    published: tuple[str, ...]
    columns: tuple[Column, ...]
    recovered: bool = False


def read_campaigns(bench: Bench) -> Campaigns:
    """Read every result of the bench, and the reasons why some cannot be read.

    A campaign without a result is not missing here; the figures that need it report it.
    """
    results, missing = {}, {}
    for name in sorted(path.stem for path in bench.results_folder.glob("*.json")):
        try:
            results[name] = bench.result(name)
        except InputError as error:
            missing[name] = str(error)
    return Campaigns(results, missing)


def tables(results: Mapping[str, FitResult]) -> list[Table]:
    """Return a table for each law, contact and search, with their fits side by side.

    Parameters
    ----------
    results : mapping of str to FitResult
        By name.

    Returns
    -------
    list of Table
        Those with most fits first.
    """
    groups = sorted(
        by_search(results.values()), key=lambda group: (-len(group), group[0].law, group[0].contact)
    )
    return [_table(group) for group in groups]


def headline(results: Mapping[str, FitResult], names: Sequence[str]) -> list[Table]:
    """Return the main fits, each beside the published coefficients, if they exist."""
    return [_main_fit(results[name]) for name in names if name in results]


def _main_fit(result: FitResult) -> Table:
    """Return the table of a main fit, "recovered" if it fixes or ties coefficients."""
    table = _table([result])
    recovered = bool(result.fixed or result.ties)
    name = "recovered" if recovered else "refit"
    column, *others = table.columns
    columns = (replace(column, name=name, about=""), *others)
    return replace(table, columns=columns, recovered=recovered)


def _table(results: Sequence[FitResult]) -> Table:
    """Return one table."""
    first, rows = results[0], side_by_side(results)
    alone = len(results) == 1
    rows.pop("published largest |Eq 9|, %", None)
    rows["commit"] = ["", *map(_commit, results), *([""] if alone else [])]
    cells = {row: [_cell(cell) for cell in row_cells] for row, row_cells in rows.items()}
    published, *columns = zip(*cells.values(), strict=True)
    differences = [Column("difference, %", "", columns.pop(), ())] if alone else []
    return Table(
        first.law,
        first.contact,
        tuple(_ROW_NAMES.get(row, row) for row in cells),
        len(first.coefficients),
        published,
        (
            *(
                Column(
                    result.name,
                    f"to {result.reference}, {result.objective.name}",
                    column,
                    tuple(result.verdicts),
                )
                for result, column in zip(results, columns, strict=True)
            ),
            *differences,
        ),
    )


def _cell(number: str | None) -> str:
    """Return a number with thin spaces between thousands, or a dash if it does not exist."""
    return number.replace(",", "\u2009") if number else MISSING


def _commit(result: FitResult) -> str:
    """Return the start of a fit's commit, and whether files were modified."""
    name = str(result.provenance.get("git_commit") or "unknown")
    return f"{name[:10]}, modified" if name.endswith("-dirty") else name[:10]


def made_with(results: Mapping[str, FitResult]) -> dict[str, str]:
    """Return the version and the commit of the fits, "several" if they differ."""
    versions = {str(r.provenance.get("cylcontact", "unknown")) for r in results.values()}
    commits = {_commit(result) for result in results.values()}
    return {
        name: next(iter(values)) if len(values) == 1 else "several"
        for name, values in (("version", versions), ("commit", commits))
        if values
    }
