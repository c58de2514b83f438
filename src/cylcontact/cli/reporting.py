"""The commands `figure`, `report` and `claims`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import cast

from cylcontact.cli.options import (
    JOBS,
    JSON,
    QUIET,
    RESULTS_FOLDER,
    WIDTHS,
    argument,
    one_of,
    option,
    output,
    require_output,
    several,
)
from cylcontact.cli.terminal import note, progress_bars, say
from cylcontact.files.writing import json_text
from cylcontact.support.choices import FORMATS, Format, listed
from cylcontact.support.errors import InputError


def figure(
    names: list[str] | None = argument(
        "Figures, e.g. fig10 fig_housing; all by default. Arguments follow the name of a figure: "
        "fig12 result=build/internal.json.",
        default=None,
        metavar="FIGURE",
    ),
    out: Path | None = output("The folder; build/figures by default.", metavar="FOLDER"),
    width: str | None = option(f"{listed(WIDTHS)}, or a number of mm.", metavar="WIDTH"),
    style: str | None = option("A matplotlib style, by name or file.", metavar="STYLE"),
    formats: list[str] | None = several(
        f"{listed(FORMATS)}.", "--format", of=one_of(FORMATS), metavar="FORMAT"
    ),
    jobs: int = JOBS,
    as_json: bool = JSON,
    quiet: bool = QUIET,
) -> None:
    """Draw figures, each with its numbers as CSV and its caption."""
    from cylcontact.plots.style import read_width
    from cylcontact.reports.figures import files_with_captions, write_figures

    chosen, arguments = _names_and_arguments(names or ())
    with progress_bars(quiet) as progress:
        written = write_figures(
            Path(),
            chosen,
            arguments,
            out,
            formats=cast(list[Format], formats or ["png", "pdf"]),
            style=style,
            width=read_width(width) if width else None,
            workers=jobs,
            progress=progress,
        )
    if as_json:
        say(json_text(files_with_captions(written)))
        return
    count = sum(path.suffix == ".csv" for path in written)
    note(f"{count} {'figure' if count == 1 else 'figures'} in {written[0].parent}", quiet)


def _names_and_arguments(words: Sequence[str]) -> tuple[list[str], dict[str, str]]:
    """Split a command line into figures and the arguments, KEY=VALUE, of a single one."""
    figures = [word for word in words if "=" not in word]
    pairs = [word.partition("=") for word in words if "=" in word]
    if pairs and len(figures) != 1:
        rule, remedy = "is an argument of one figure", "name that figure before it, and no other"
        raise InputError("figure", pairs[0][0], pairs[0][2], rule, remedy)
    return figures, {key: value for key, _, value in pairs}


def report(
    out: Path = output("The page.", default=Path("build/report.html")),
    results: Path = RESULTS_FOLDER,
    figures: Path = option(
        "The folder of figures.", default=Path("build/figures"), metavar="FOLDER"
    ),
    quiet: bool = QUIET,
) -> None:
    """Write one HTML page with coefficients, figures and claims."""
    from cylcontact.reports.page import write_page

    require_output(out, ".html")
    for what in write_page(out, Path(), results, figures):
        say(f"missing: {what}", err=True)
    note(f"open {out}", quiet)


def claims(
    out: Path | None = output("Write them as a table, .csv, instead of printing them."),
    as_json: bool = JSON,
    quiet: bool = QUIET,
) -> None:
    """Compare the claims of the paper with computed numbers, in every interpretation."""
    from cylcontact.reports.claims import as_records, claims_of, to_text, write_claims

    require_output(out, ".csv")
    computed = claims_of(Path()) if out is None else write_claims(Path(), out)
    if as_json:
        say(json_text(as_records(computed)))
    elif out is None:
        say(to_text(computed))
    else:
        note(f"{len(computed)} claims written to {out}", quiet)
