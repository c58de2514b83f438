"""Results as text for a terminal and as HTML for a notebook."""

from __future__ import annotations

import io
from collections.abc import Sequence
from html import escape
from textwrap import fill

from rich.console import Console
from rich.table import Table

from cylcontact.fitting.result import FitResult
from cylcontact.fitting.uncertainty.report import Uncertainty
from cylcontact.fitting.verdicts import identification, verdicts

WIDTH = 100
COLUMNS = ("", "fitted", "published", "held there", "within 1 %", "identified")
TableRows = list[tuple[str, ...]]


def as_text(result: FitResult) -> str:
    """Return the report on one result."""
    return "\n".join(
        [
            fill(_headline(result), WIDTH),
            "",
            text_table(_columns(result), _lines(result)),
            *(item(sentence) for sentence in verdicts(result)),
        ]
    )


def as_html(result: FitResult) -> str:
    """Return the same report as an HTML fragment, all of its texts escaped."""
    head = "".join(f"<th>{column}</th>" for column in _columns(result))
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in line) + "</tr>"
        for line in _lines(result)
    )
    items = "".join(f"<li>{escape(sentence)}</li>" for sentence in verdicts(result))
    return (
        f"<p>{escape(_headline(result))}</p>"
        f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table><ul>{items}</ul>"
    )


def compare(results: Sequence[FitResult]) -> str:
    """Return results side by side, those of one law and contact in one table, then verdicts.

    Parameters
    ----------
    results : sequence of FitResult
        In the order of the columns.

    Returns
    -------
    str
        Each table has a column for the published coefficients and one for each result; the
        objective of the published coefficients depends on the data and has a row of its own.
    """
    groups: dict[tuple[str, str], list[FitResult]] = {}
    for result in results:
        groups.setdefault((result.law, result.contact), []).append(result)
    parts = [_compare_group(group) for group in groups.values()]
    for result in results:
        parts.append("\n".join([f"{result.name}:", *map(item, verdicts(result))]))
    return "\n\n".join(parts)


def item(sentence: str) -> str:
    """Return a sentence as an item of a list, wrapped."""
    return fill(sentence, WIDTH, initial_indent="- ", subsequent_indent="  ")


def _headline(result: FitResult) -> str:
    """Return what was fitted to what."""
    if result.uncertainty is not None:
        return (
            f"{result.name}: {result.law} law, {result.contact} contact, fitted to "
            f"{result.counts.samples:,} measurements by {result.objective.name}"
        )
    return (
        f"{result.name}: {result.law} law, {result.contact} contact, fitted to "
        f"{result.reference} by {result.objective.name} on {result.counts.samples:,} samples "
        f"({result.counts.masked:,} masked by the reference's domain)"
    )


def _lines(result: FitResult) -> TableRows:
    """Return the lines of the report's table.

    "Held there" is by how much the best attainable objective rises when the coefficient is held
    at its published value.
    """
    if result.uncertainty is not None:
        return _measured_lines(result, result.uncertainty)
    published, optimum = result.published, result.objective.value
    lines: TableRows = []
    for name, value in result.coefficients.items():
        paper = f"{published.coefficients[name]:g}" if published else "-"
        interval = rise = ""
        if name in result.profiles:
            profile = result.profiles[name]
            interval = profile.interval
            if profile.objective_at_published is not None:
                rise = f"{profile.objective_at_published / optimum - 1:+.1%}"
        lines.append((name, f"{value:.5g}", paper, rise, interval, identification(result, name)))
    paper = f"{published.objective:.5g}" if published else "-"
    bound = f"bound {result.bound:.5g}" if result.bound is not None else ""
    lines.append((result.objective.name, f"{optimum:.5g}", paper, "", bound, ""))
    worst = result.max_abs_diff_percent
    lines.append(("max |Eq 9|, %", f"{worst.fitted:.4g}", _or_dash(worst.published), "", "", ""))
    return lines


def _columns(result: FitResult) -> tuple[str, ...]:
    """Return the headings of the report's table."""
    if result.uncertainty is None:
        return COLUMNS
    interval = f"{100 * result.uncertainty.level:g} % interval"
    return ("", "fitted", "std. error", interval, "published", "determined")


def _measured_lines(result: FitResult, found: Uncertainty) -> TableRows:
    """Return the lines of the table of a fit to measurements."""
    published = result.published
    lines: TableRows = []
    for name, value in result.coefficients.items():
        paper = f"{published.coefficients[name]:.5g}" if published else "-"
        estimate = found.estimates.get(name)
        error = interval = ""
        if estimate is not None and estimate.standard_error is not None:
            error = f"{estimate.standard_error:.2g}"
        if estimate is not None and estimate.profile is not None:
            ends = estimate.profile
            cut = ", bound" if ends.low_is_bound or ends.high_is_bound else ""
            interval = f"{ends.low:.5g} … {ends.high:.5g}{cut}"
        lines.append((name, f"{value:.5g}", error, interval, paper, identification(result, name)))
    paper = f"{published.objective:.5g}" if published else "-"
    lines.append((result.objective.name, f"{result.objective.value:.5g}", "", "", paper, ""))
    worst = result.max_abs_diff_percent
    lines.append(("max |Eq 9|, %", f"{worst.fitted:.4g}", "", "", _or_dash(worst.published), ""))
    return lines


def _compare_group(results: list[FitResult]) -> str:
    """Return the table of results of one law and contact."""
    first = results[0]
    columns = (f"{first.law}, {first.contact}", "published", *(r.name for r in results))
    lines: TableRows = []
    for name in first.coefficients:
        paper = f"{first.published.coefficients[name]:g}" if first.published else "-"
        lines.append((name, paper, *(f"{r.coefficients[name]:.5g}" for r in results)))
    lines += [
        ("objective", "", *(r.objective.name for r in results)),
        ("  fitted", "", *(f"{r.objective.value:.5g}" for r in results)),
        (
            "  published",
            "",
            *(_or_dash(r.published.objective if r.published else None) for r in results),
        ),
        ("  lower bound", "", *(_or_dash(r.bound) for r in results)),
        ("max |Eq 9|, %", "", *(f"{r.max_abs_diff_percent.fitted:.4g}" for r in results)),
        ("  published", "", *(_or_dash(r.max_abs_diff_percent.published) for r in results)),
        ("samples", "", *(f"{r.counts.samples:,}" for r in results)),
        ("  masked", "", *(f"{r.counts.masked:,}" for r in results)),
    ]
    return text_table(columns, lines)


def _or_dash(value: float | None) -> str:
    """Return a number, or a dash where there is none."""
    return "-" if value is None else f"{value:.5g}"


def text_table(columns: Sequence[str], lines: TableRows) -> str:
    """Return an aligned table of text, numbers to the right.

    Parameters
    ----------
    columns : sequence of str
        The headings.
    lines : sequence of tuple of str
        The cells, line by line.

    Returns
    -------
    str
    """
    table = Table(box=None, pad_edge=False, header_style="")
    for index, column in enumerate(columns):
        table.add_column(column, justify="left" if index == 0 else "right", no_wrap=True)
    for line in lines:
        table.add_row(*line)
    stream = io.StringIO()
    width = max(WIDTH, 24 * len(columns))
    Console(file=stream, width=width, color_system=None, markup=False, highlight=False).print(table)
    return "\n".join(line.rstrip() for line in stream.getvalue().splitlines())
