"""The commands that show and hand on: report, claims, laws, export."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cylcontact.cli.terminal import RESULTS, progress_bars
from cylcontact.errors import InputError


def report(
    names: Annotated[
        list[str] | None, typer.Argument(help="Recipes, e.g. fig10 fig10r; all by default.")
    ] = None,
    results: Annotated[
        Path, typer.Option("--results", help="The folder of fit results to draw from.")
    ] = RESULTS,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Where to write; reports/figures.")
    ] = None,
) -> None:
    """Draw the figures, each as PNG and PDF with the CSV of its numbers."""
    from cylcontact.reports.bench import Bench
    from cylcontact.reports.build import build, find_recipes

    bench = Bench(Path(), results)
    wanted = names or list(find_recipes(bench))
    drawn = 0
    with progress_bars() as progress:
        progress("drawing", 0, len(wanted))
        for name in wanted:
            (written,) = build(bench, [name], out)
            drawn += 1
            progress("drawing", drawn, len(wanted))
    typer.echo(f"{drawn} figures in {written.paths[0].parent}")


def claims(
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Write the ledger as .csv or .json instead.")
    ] = None,
    results: Annotated[
        Path, typer.Option("--results", help="The folder of fit results to judge by.")
    ] = RESULTS,
) -> None:
    """Hold every quantitative statement of the paper against computed numbers."""
    from cylcontact.files import replacing
    from cylcontact.reports.bench import Bench
    from cylcontact.reports.claims import calibration_claims, ledger, to_csv, to_json, to_text

    bench = Bench(Path(), results)
    writers = {".csv": to_csv, ".json": to_json}
    if out is not None and out.suffix not in writers:
        raise InputError(
            str(out), "", None, "is neither .csv nor .json", "name the output so that it is one"
        )
    found = ledger(bench.materials(), calibration_claims(bench.results_by_name()))
    if out is None:
        typer.echo(to_text(found), nl=False)
        return
    with replacing(out) as temporary:
        temporary.write_text(writers[out.suffix](found), encoding="utf-8")
    typer.echo(f"{len(found)} claims written to {out}")


def compare_laws(
    E: Annotated[float, typer.Option("--E", help="Young's modulus, MPa.")] = 207e3,
    nu: Annotated[float, typer.Option("--nu", help="Poisson's ratio.")] = 0.3,
    dR: Annotated[
        float | None,
        typer.Option("--dR", help="ΔR, mm; by default 0.05 internal, twice Ri external."),
    ] = None,
    R_i: Annotated[float, typer.Option("--Ri", help="Radius of the hole or roller, mm.")] = 10.0,
    length: Annotated[float, typer.Option(help="Axial length, mm.")] = 10.0,
    load: Annotated[float, typer.Option(help="Load per unit length, N/mm.")] = 100.0,
    contact: Annotated[str, typer.Option(help="internal or external.")] = "internal",
) -> None:
    """Show all contact laws side by side for one pair, and how accurate the explicit law is."""
    from cylcontact.reports.laws_table import case, to_text

    typer.echo(to_text(case(contact, E, nu, dR, R_i, length), load), nl=False)


def export(
    what: Annotated[
        str, typer.Argument(metavar="RESULT|LAW", help="A fit result, or a law, e.g. johnson.")
    ],
    target: Annotated[str, typer.Option("--to", help="c, fortran, matlab or json.")],
    contact: Annotated[
        str | None, typer.Option(help="internal or external, for laws that depend on it.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="The file; standard output by default.")
    ] = None,
) -> None:
    """Write a law as a function in another language, for a multibody code."""
    from cylcontact.export import export_named
    from cylcontact.files import replacing

    source = export_named(what, contact, target)
    if out is None:
        typer.echo(source, nl=False)
        return
    with replacing(out) as temporary:
        temporary.write_text(source, encoding="ascii")
    typer.echo(f"{what} written to {out}")
