"""The command `finite-element`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cylcontact.choices import ENGINES, listed
from cylcontact.cli.options import Force, Jobs, Resume, resumable
from cylcontact.cli.terminal import cores, noting, progress_bars, say
from cylcontact.errors import InputError
from cylcontact.files import require_suffix, require_writable

__all__ = ["finite_element"]


def finite_element(
    spec: Annotated[
        Path,
        typer.Argument(help="A set-up, e.g. datasets/finite_element/recommended.toml."),
    ],
    engine: Annotated[str, typer.Option(help=f"{listed(ENGINES)}.")] = "embedded",
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", help="The table; SPEC-ENGINE.csv beside the set-up."),
    ] = None,
    jobs: Jobs = None,
    resume: Resume = False,
    force: Force = False,
) -> None:
    """Solve a pin in a hole by finite elements, for each clearance and load of a set-up."""
    from cylcontact.datasets.finite_element import read_study, run_study, write_table
    from cylcontact.datasets.finite_element.study import engine_name
    from cylcontact.datasets.finite_element.table import require_same_inputs

    study = read_study(spec)
    chosen = next((name for name in ENGINES if name == engine), None)
    if chosen is None:
        raise InputError("--engine", "", engine, "is not an engine", f"choose {listed(ENGINES)}")
    solver = engine_name(chosen)
    target = out or spec.with_name(f"{spec.stem}-{chosen}.csv")
    require_writable(target)
    require_suffix(target, ".csv")
    if out is None and not force:
        require_same_inputs(target, study)
    with resumable(target, "case") as journal:
        anew = resume and not journal.exists()
        note = f"no cases are kept in {journal}; all are solved" if anew else ""
        with progress_bars() as bars:
            progress = noting(bars, "solving", note)
            rows, failures = run_study(study, chosen, jobs or cores(), progress, journal, resume)
        if failures:
            for failure in failures:
                say(f"cylcontact: {failure}", err=True)
            raise _incomplete(spec, sum(len(f.loads) for f in failures), len(rows), journal)
        write_table(target, study, solver, rows)
    say(f"{target}: {len(rows)} cases by {solver}")


def _incomplete(spec: Path, failed: int, solved: int, journal: Path) -> InputError:
    """Return the error for a study with unsolved cases."""
    remedy = f"the {solved} others are kept in {journal}, and --resume solves only what is missing"
    return InputError(
        str(spec),
        "",
        None,
        f"{failed} of {failed + solved} cases have no solution, for the reasons above",
        remedy if solved else "correct the set-up",
    )
