"""Tables of the coefficients of all campaigns, and the results that cannot be read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from cylcontact.errors import InputError
from cylcontact.fitting.result import FitResult
from cylcontact.fitting.verdicts import verdicts
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
OBJECTIVE = "objective"
SAME_DATA = "published, same data"
LARGEST = "largest |Eq 9|, %"
# The unit of an objective, by the first of these words in its name.
UNITS = {"percent": "%", "-log-": "(ln)", "relative": "(relative)"}


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
    """The fits of one law and contact side by side.

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
    """

    law: str
    contact: str
    rows: tuple[str, ...]
    coefficients: int
    published: tuple[str, ...]
    columns: tuple[Column, ...]


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
    """Return a table for each law and contact, with their fits side by side.

    Parameters
    ----------
    results : mapping of str to FitResult
        By name.

    Returns
    -------
    list of Table
        Those with most fits first.
    """
    groups: dict[tuple[str, str], list[FitResult]] = {}
    for result in results.values():
        groups.setdefault((result.law, result.contact), []).append(result)
    ordered = sorted(groups.items(), key=lambda item: (-len(item[1]), item[0]))
    return [_table(law, contact, members) for (law, contact), members in ordered]


def headline(results: Mapping[str, FitResult], names: Sequence[str]) -> list[Table]:
    """Return the main fits, each beside the published coefficients, if they exist."""
    main = [results[name] for name in names if name in results]
    return [
        replace(table, columns=tuple(replace(c, name="refit", about="") for c in table.columns))
        for table in (_table(result.law, result.contact, [result]) for result in main)
    ]


def _table(law: str, contact: str, results: Sequence[FitResult]) -> Table:
    """Return one table."""
    # Some results of a group may have been made where nothing was published.
    published = next((r.published for r in results if r.published is not None), None)
    names = tuple(results[0].coefficients)
    paper = {n: f"{published.coefficients[n]:g}" for n in names} if published else {}
    columns = [_cells(result) for result in results]
    if len(results) == 1:
        # One set of data: the published coefficients' results on it go to their column.
        paper |= _published_cells(results[0])
        del columns[0][SAME_DATA]
    rows = tuple(columns[0])
    return Table(
        law,
        contact,
        rows,
        len(names),
        tuple(paper.get(row, MISSING) for row in rows),
        tuple(
            Column(
                result.name,
                f"to {result.reference}, {result.objective.name}",
                tuple(cells.values()),
                tuple(verdicts(result)),
            )
            for result, cells in zip(results, columns, strict=True)
        ),
    )


def _cells(result: FitResult) -> dict[str, str]:
    """Return one fit's cells, row → cell, coefficients first."""
    unit = _unit(result)
    published = result.published.objective if result.published else None
    return {
        **{name: f"{value:.5g}" for name, value in result.coefficients.items()},
        OBJECTIVE: _number(result.objective.value, unit),
        SAME_DATA: _number(published, unit),
        "lower bound": _number(result.bound, unit),
        LARGEST: f"{result.max_abs_diff_percent.fitted:.4g}",
        "samples": f"{result.counts.samples:,}".replace(",", "\u2009"),
        "masked": f"{result.counts.masked:,}".replace(",", "\u2009"),
        "commit": _commit(result),
    }


def _published_cells(result: FitResult) -> dict[str, str]:
    """Return the results of the published coefficients on the data of a fit, row → cell."""
    if result.published is None:
        return {}
    return {
        OBJECTIVE: _number(result.published.objective, _unit(result)),
        LARGEST: _number(result.max_abs_diff_percent.published),
    }


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


def _unit(result: FitResult) -> str:
    """Return the unit of an objective."""
    return next((unit for word, unit in UNITS.items() if word in result.objective.name), "")


def _number(value: float | None, unit: str = "") -> str:
    """Return a number with its unit, or a dash for None."""
    return MISSING if value is None else f"{value:.5g} {unit}".rstrip()
