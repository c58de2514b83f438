"""The command that solves finite-element set-ups."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cylcontact.cli import choices
from cylcontact.cli.keeping import interrupted, kept_beside
from cylcontact.cli.terminal import Force, Jobs, cores, progress_bars
from cylcontact.errors import InputError
from cylcontact.files import owning


def finite_element(
    spec: Annotated[
        Path,
        typer.Argument(help="A set-up, e.g. datasets/finite_element/recommended.toml."),
    ],
    engine: Annotated[str, typer.Option(help=f"{choices.listed(choices.ENGINES)}.")] = "embedded",
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", help="The table; SPEC-ENGINE.csv beside the set-up."),
    ] = None,
    jobs: Jobs = None,
    resume: Annotated[bool, typer.Option("--resume", help="Take up an interrupted study.")] = False,
    force: Force = False,
) -> None:
    """Solve a pin in a hole by finite elements, for each clearance and load of a set-up."""
    from cylcontact.datasets.finite_element import ENGINES, read_study, run_study, write_table
    from cylcontact.datasets.finite_element.study import engine_name
    from cylcontact.datasets.finite_element.table import require_same_inputs

    study = read_study(spec)
    chosen = next((name for name in ENGINES if name == engine), None)
    if chosen is None:
        raise InputError(
            "--engine", "", engine, "is not an engine", f"choose {' or '.join(ENGINES)}"
        )
    solver = engine_name(chosen)
    target = out or spec.with_name(f"{spec.stem}-{chosen}.csv")
    kept = kept_beside(target)
    with owning(target):
        if out is None and not force:
            require_same_inputs(target, study)
        if resume and not kept.exists():
            typer.echo(f"cylcontact: no cases are kept in {kept}; all are solved", err=True)
        try:
            with progress_bars() as progress:
                rows, failures = run_study(study, chosen, jobs or cores(), progress, kept, resume)
        except KeyboardInterrupt:
            raise KeyboardInterrupt(interrupted(kept, "case")) from None
        if failures:
            for failure in failures:
                typer.echo(f"cylcontact: {failure}", err=True)
            raise _incomplete(spec, sum(len(f.loads) for f in failures), len(rows), kept)
        write_table(target, study, solver, rows)
        kept.unlink(missing_ok=True)
    typer.echo(f"{target}: {len(rows)} cases by {solver}")


def _incomplete(spec: Path, failed: int, solved: int, kept: Path) -> InputError:
    """Return the error of a study some of whose cases have no solution."""
    place = f"the {solved} others are kept in {kept}, and --resume solves only what is missing"
    return InputError(
        str(spec),
        "",
        None,
        f"{failed} of {failed + solved} cases have no solution, for the reasons above",
        place if solved else "correct the set-up",
    )
