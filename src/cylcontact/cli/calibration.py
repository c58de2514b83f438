"""The commands `sample`, `fit`, `optimizers`, `compare` and `verify`."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cylcontact.choices import FIT_FILES, TABLE_SUFFIXES
from cylcontact.cli import measured
from cylcontact.cli.options import (
    RESULTS,
    Force,
    Jobs,
    Runs,
    Scheduler,
    Seed,
    expand_options,
    resumable,
)
from cylcontact.cli.terminal import progress_bars, workers
from cylcontact.errors import InputError
from cylcontact.files import owning, replacing, require_suffix
from cylcontact.fitting.optimizers import OPTIMIZERS

if TYPE_CHECKING:
    from cylcontact.fitting.result import FitResult

__all__ = ["compare", "fit", "optimizers", "sample", "verify"]


def sample(
    spec: Annotated[Path, typer.Argument(help="A grid spec, e.g. datasets/internal.toml.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="The .parquet or .csv file to write.")],
) -> None:
    """Sample a reference law over a grid, in bounded memory."""
    from cylcontact.datasets import read_grid, write_samples

    grid = read_grid(spec)
    with owning(out), progress_bars() as progress:
        counts = write_samples(grid, out, lambda n: progress("sampling", n, grid.dR.size))
    typer.echo(
        f"{out}: {counts.samples:,} samples, {counts.masked:,} masked by the domain of "
        f"{grid.reference}"
    )


@expand_options
def fit(
    campaign: Annotated[
        Path,
        typer.Argument(
            help="A campaign, e.g. fitting/internal.toml, or a .csv, .xlsx or .parquet table."
        ),
    ],
    *,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            help="The result, .json or for a table a folder; results/NAME beside the input.",
        ),
    ] = None,
    jobs: Jobs = None,
    search: measured.SearchOptions,
    scheduler: Scheduler = None,
    resume: Annotated[bool, typer.Option("--resume", help="Resume an interrupted fit.")] = False,
    force: Force = False,
    law: measured.LawOption,
    table: measured.TableOptions,
) -> None:
    """Calibrate a law to a reference, or to a table of measurements."""
    from cylcontact.fitting import calibrate
    from cylcontact.fitting.result import require_same_inputs

    planned = measured.plan(campaign, law, table, search)
    target, folder = _place(campaign, out)
    where = workers(jobs, scheduler)
    with owning(target):
        if out is None and not force:
            require_same_inputs(target, planned)
        with resumable(target, "run") as journal:
            if resume and not journal.exists():
                typer.echo(f"cylcontact: no runs are kept in {journal}; all are run", err=True)
            with progress_bars() as progress:
                result = calibrate(planned, where, progress, journal, resume)
            _save(result, target, folder)
    names = f": {', '.join(FIT_FILES)}" if folder else ""
    typer.echo(f"{result}\n\nwritten to {folder or target}{names}")


def _place(campaign: Path, out: Path | None) -> tuple[Path, Path | None]:
    """Return the file of the result, and for a table the folder of all its files.

    A campaign's result is a file alone, and so is one that is to be written to a .json.
    """
    results = campaign.parent / "results"
    is_table = campaign.suffix.lower() in TABLE_SUFFIXES
    if out is None:
        out = results / (campaign.stem if is_table else f"{campaign.stem}.json")
    if is_table and out.suffix.lower() != ".json":
        return out / FIT_FILES[0], out
    return out, None


def _save(result: FitResult, target: Path, folder: Path | None) -> None:
    """Write a result, with its residuals and picture if it has a folder."""
    if folder is None:
        result.save(target)
        return
    from cylcontact.reports.fit_folder import write_fit

    write_fit(result, folder)


def optimizers(
    campaign: Annotated[Path, typer.Argument(help="A campaign, e.g. fitting/internal.toml.")],
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[OPTIMIZER]...", help="Some; all by default.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Write every run to this .csv as well.")
    ] = None,
    jobs: Jobs = None,
    runs: Runs = None,
    seed: Seed = None,
    scheduler: Scheduler = None,
) -> None:
    """Run a campaign with every optimiser, with the same budget, and compare them."""
    from cylcontact.fitting import optimizer_comparison, read_campaign

    for name in names or ():
        read_campaign(campaign, optimizer=name)  # refuses an unknown one
    planned = read_campaign(campaign, runs, seed)
    if out is not None:
        require_suffix(out, ".csv")
    where = workers(jobs, scheduler)
    with owning(out) if out else nullcontext(), progress_bars() as progress:
        compared = optimizer_comparison.compare_optimizers(
            planned, names or OPTIMIZERS, where, progress
        )
        if out is not None:
            with replacing(out) as temporary:
                temporary.write_text(optimizer_comparison.as_csv(compared), encoding="utf-8")
    typer.echo(optimizer_comparison.as_text(compared))


def compare(
    results: Annotated[
        list[Path], typer.Argument(help="Result files, e.g. fitting/results/*.json.")
    ],
) -> None:
    """Compare results with each other and with the published coefficients."""
    from cylcontact import fitting

    typer.echo(fitting.compare([fitting.FitResult.read(path) for path in results]))


def verify(
    results: Annotated[
        list[Path] | None, typer.Argument(help="Result files; all committed ones by default.")
    ] = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
) -> None:
    """Redo committed fits with their own settings; exit code 1 if one differs."""
    from cylcontact.fitting.verify import verify as verify_one

    paths = results or sorted(RESULTS.glob("*.json"))
    if not paths:
        raise InputError(
            str(RESULTS),
            "",
            None,
            "has no results",
            "name some, or lay out a bench with: cylcontact init FOLDER",
        )
    failed = 0
    for path in paths:
        with progress_bars() as progress:
            checks = verify_one(path, workers(jobs, scheduler), progress)
        for check in checks:
            typer.echo(f"{path.stem}: {check}")
        failed += sum(not check.holds for check in checks)
    typer.echo(f"{len(paths)} results verified, {failed} checks do not hold")
    if failed:
        raise typer.Exit(1)
