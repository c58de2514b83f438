"""The commands `sample`, `fit`, `compare` and `verify`."""

from __future__ import annotations

from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cylcontact.choices import FIT_FILES, is_table
from cylcontact.cli import measured
from cylcontact.cli.options import (
    RESULTS,
    Force,
    Jobs,
    Resume,
    Scheduler,
    expand_options,
    require_taken,
    resumable,
)
from cylcontact.cli.terminal import noting, progress_bars, say, workers
from cylcontact.cli.uncertainty import StudyOptions, study_uncertainty
from cylcontact.errors import InputError
from cylcontact.files import replacing, require_suffix, require_writable

if TYPE_CHECKING:
    from cylcontact.fitting import Campaign, FitResult, TableCampaign
    from cylcontact.parallel import Workers


def sample(
    spec: Annotated[Path, typer.Argument(help="A grid spec, e.g. datasets/internal.toml.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="The .parquet or .csv file to write.")],
) -> None:
    """Sample a reference law over a grid, in bounded memory."""
    from cylcontact.datasets import read_grid, write_samples

    require_writable(out)
    grid = read_grid(spec)
    with progress_bars() as progress:
        counts = write_samples(grid, out, lambda n: progress("sampling", n, grid.dR.size))
    say(
        f"{out}: {counts.samples:,} samples, {counts.masked:,} masked by the domain of "
        f"{grid.reference}"
    )


@expand_options
def fit(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="CAMPAIGN|TABLE|RESULT",
            help="A campaign, e.g. fitting/internal.toml, a table (.csv, .txt, .xlsx, …), or "
            "a fit result, whose uncertainty is studied.",
        ),
    ],
    *,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            help="The result, .json or for a table a folder, results/NAME beside the input by "
            "default; a comparison's .csv; the .json of a study.",
        ),
    ] = None,
    law: measured.LawOption,
    search: measured.SearchOptions,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    resume: Resume = False,
    force: Force = False,
    table: measured.TableOptions,
    study: StudyOptions,
) -> None:
    """Calibrate a law to a reference or to measurements, or study the fit's uncertainty."""
    is_result, names = source.suffix.lower() == ".json", search.optimizers
    way = "a fit result" if is_result else "a comparison" if len(names) > 1 else "a calibration"
    given = {"resume": resume, "force": force, **asdict(search), **asdict(table), **asdict(study)}
    of_table = [field.name for field in fields(measured.TableOptions)]
    takes = {
        "a calibration": ["runs", "seed", "optimizer", "resume", "force", *of_table],
        "a comparison": ["runs", "seed", "optimizer", *of_table],
        "a fit result": ["seed", *(field.name for field in fields(StudyOptions))],
    }
    require_taken(str(source), way, takes, given)
    where = workers(jobs, scheduler)
    if is_result:
        study_uncertainty(source, study, law, search.seed, where, out)
        return
    plans = [measured.plan(source, law, table, search, name) for name in names or (None,)]
    if len(names) > 1:
        _compare_optimizers(plans[0], names, where, out)
    else:
        _calibrate(source, plans[0], where, resume, force, out)


def _calibrate(
    source: Path,
    planned: Campaign | TableCampaign,
    where: Workers,
    resume: bool,
    force: bool,
    out: Path | None,
) -> None:
    """Fit a law, and write the result."""
    from cylcontact.fitting import Campaign, calibrate, fit_table
    from cylcontact.fitting.results import require_same_inputs

    target, folder = _place(source, planned, out)
    require_writable(target, *(target.with_name(name) for name in FIT_FILES if folder))
    require_suffix(target, ".json")
    if out is None and not force:
        require_same_inputs(target, planned)
    with resumable(target, "run") as journal:
        anew = resume and not journal.exists()
        note = f"no runs are kept in {journal}; all are run" if anew else ""
        with progress_bars() as bars:
            progress = noting(bars, "searching", note)
            result: FitResult
            if isinstance(planned, Campaign):
                result = calibrate(planned, where, progress, journal, resume)
            else:
                result = fit_table(planned, where, progress, journal, resume)
        _save(result, target, folder)
    names = f": {', '.join(FIT_FILES)}" if folder else ""
    say(f"{result}\n\nwritten to {folder or target}{names}")


def _place(
    source: Path, planned: Campaign | TableCampaign, out: Path | None
) -> tuple[Path, Path | None]:
    """Return the file of the result, and for a table the folder of all its files.

    A campaign's result is a file alone, and so is one that is to be written to a .json. A second
    law has a folder of its own beside that of the first, with its name.
    """
    results = source.parent / "results"
    if not is_table(source):
        return out or results / f"{source.stem}.json", None
    if out is None:
        out = results / source.stem
        law = planned.model.law
        if _law_in(out / FIT_FILES[0]) not in ("", law):
            out = results / f"{source.stem}-{law.replace(':', '-')}"
    elif out.suffix.lower() == ".json":
        return out, None
    return out / FIT_FILES[0], out


def _law_in(result: Path) -> str:
    """Return the law of a fit result; empty without a result that can be read."""
    from cylcontact.fitting import FitResult

    try:
        return FitResult.read(result).law if result.exists() else ""
    except InputError:
        return ""


def _save(result: FitResult, target: Path, folder: Path | None) -> None:
    """Write a result, with its residuals and picture if it has a folder."""
    from cylcontact.fitting import DataFit

    if folder is None or not isinstance(result, DataFit):
        result.save(target)
        return
    from cylcontact.reports.fit_folder import write_fit

    write_fit(result, folder)


def _compare_optimizers(
    planned: Campaign | TableCampaign, names: list[str], where: Workers, out: Path | None
) -> None:
    """Run a campaign with several optimisers, with the same budget, and compare them."""
    from cylcontact.fitting import optimizer_comparison

    if out is not None:
        require_suffix(out, ".csv")
        require_writable(out)
    with progress_bars() as progress:
        compared = optimizer_comparison.compare_optimizers(planned, names, where, progress)
    if out is not None:
        with replacing(out) as temporary:
            compared.to_csv(temporary, index=False, lineterminator="\n")
    say(optimizer_comparison.as_text(compared))


def compare(
    results: Annotated[
        list[Path], typer.Argument(help="Result files, e.g. fitting/results/*.json.")
    ],
) -> None:
    """Compare results with each other and with the published coefficients."""
    from cylcontact import fitting

    say(fitting.compare([fitting.FitResult.read(path) for path in results]))


def verify(
    results: Annotated[
        list[Path] | None, typer.Argument(help="Result files; all committed ones by default.")
    ] = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
) -> None:
    """Redo committed fits with their own settings; exit code 1 if one differs."""
    from cylcontact.fitting.comparison import verify as verify_one

    paths = results or sorted(RESULTS.glob("*.json"))
    if not paths:
        rule = "has no results"
        remedy = "name some, or lay out a bench with: cylcontact init FOLDER"
        raise InputError(str(RESULTS), "", None, rule, remedy)
    failed = 0
    for path in paths:
        with progress_bars() as progress:
            checks = verify_one(path, workers(jobs, scheduler), progress)
        say("\n".join(f"{path.stem}: {check}" for check in checks))
        failed += sum(not check.holds for check in checks)
    say(f"{len(paths)} results verified, {failed} checks do not hold")
    if failed:
        raise typer.Exit(1)
