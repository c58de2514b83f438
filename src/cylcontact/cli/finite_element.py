"""The command `finite-element`."""

from __future__ import annotations

from pathlib import Path

from cylcontact.cli.options import FORCE, JOBS, RESUME, argument, output, require_output, resumable
from cylcontact.cli.terminal import cores, noting, progress_bars, say
from cylcontact.errors import InputError


def finite_element(
    spec: Path = argument("A set-up, e.g. datasets/finite_element/recommended.toml."),
    out: Path | None = output("The table; SPEC-embedded.csv beside the set-up."),
    jobs: int | None = JOBS,
    resume: bool = RESUME,
    force: bool = FORCE,
) -> None:
    """Solve a pin in a hole by finite elements."""
    from cylcontact.datasets.finite_element import read_study, run_study, write_table
    from cylcontact.datasets.finite_element.study import require_same_inputs, solver_name

    study = read_study(spec)
    target = out or spec.with_name(f"{spec.stem}-embedded.csv")
    require_output(target, ".csv")
    if out is None and not force:
        require_same_inputs(target, study)
    with resumable(target, "case") as journal:
        anew = resume and not journal.exists()
        note = f"no cases are kept in {journal}; all are solved" if anew else ""
        with progress_bars() as bars:
            progress = noting(bars, "solving", note)
            rows, failures = run_study(study, jobs or cores(), progress, journal, resume)
        if failures:
            say("\n".join(f"cylcontact: {failure}" for failure in failures), err=True)
            cases = len(study.setups) * len(study.dR) * len(study.load)
            kept = f"the {len(rows)} others are kept in {journal}, and --resume solves only "
            raise InputError(
                str(spec),
                "",
                None,
                f"{cases - len(rows)} of {cases} cases have no solution, for the reasons above",
                f"{kept}what is missing" if len(rows) else "correct the set-up",
            )
        write_table(target, study, solver_name(), rows)
    say(f"{target}: {len(rows)} cases by {solver_name()}")
