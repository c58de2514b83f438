"""The commands `sample` and `finite-element`, which write tables."""

from __future__ import annotations

from pathlib import Path

from cylcontact.cli.options import FORCE, JOBS, QUIET, RESUME, argument, output, require_output
from cylcontact.cli.terminal import note, progress_bars, resumable, say
from cylcontact.support.errors import InputError


def sample(
    spec: Path = argument("A grid, e.g. datasets/internal.toml.", metavar="GRID"),
    out: Path = output("The .parquet or .csv file to write.", default=...),
    quiet: bool = QUIET,
) -> None:
    """Sample a reference law over a grid, in bounded memory."""
    from cylcontact import datasets

    require_output(out)
    grid = datasets.read_grid(spec)
    with progress_bars(quiet) as progress:
        counts = datasets.sample(grid, out, progress)
    masked = f"{counts.masked:,} masked by the domain of {grid.reference}"
    note(f"{out}: {counts.samples:,} samples, {masked}", quiet)


def finite_element(
    spec: Path = argument(
        "A set-up, e.g. datasets/finite_element/recommended.toml.", metavar="SETUP"
    ),
    out: Path | None = output("The table; SETUP-embedded.csv beside the set-up."),
    jobs: int = JOBS,
    resume: bool = RESUME,
    force: bool = FORCE,
    quiet: bool = QUIET,
) -> None:
    """Solve a pin in a hole by finite elements."""
    from cylcontact.datasets.finite_element import read_study, run_study, write_table
    from cylcontact.datasets.finite_element.study import require_same_inputs, solver_name

    study = read_study(spec)
    target = out or spec.with_name(f"{spec.stem}-embedded.csv")
    require_output(target, ".csv")
    if out is None and not force:
        require_same_inputs(target, study)
    with resumable(target, "case", resume, quiet) as (journal, progress):
        rows, failures = run_study(study, jobs, progress, journal, resume)
        if failures:
            say("\n".join(f"cylcontact: {failure}" for failure in failures), err=True)
            cases = len(study.setups) * len(study.dR) * len(study.load)
            rule = f"{cases - len(rows)} of {cases} cases have no solution, for the reasons above"
            remedy = "correct the set-up"
            if len(rows):
                remedy = f"{journal} keeps the others, and --resume solves only what is missing"
            raise InputError(str(spec), "", None, rule, remedy)
        write_table(target, study, solver_name(), rows)
    note(f"{target}: {len(rows)} cases by {solver_name()}", quiet)
