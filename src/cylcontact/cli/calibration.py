"""The commands around a calibration: sample, fit, compare, verify."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cylcontact.cli.terminal import RESULTS, Jobs, Runs, Seed, cores, progress_bars
from cylcontact.errors import InputError


def sample(
    spec: Annotated[Path, typer.Argument(help="A grid spec, e.g. datasets/internal.toml.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="The .parquet or .csv file to write.")],
) -> None:
    """Sample a reference law over a grid, in bounded memory."""
    from cylcontact.datasets import read_grid, write_samples

    grid = read_grid(spec)
    with progress_bars() as progress:
        counts = write_samples(grid, out, lambda n: progress("sampling", n, grid.dR.size))
    typer.echo(
        f"{out}: {counts.samples:,} samples, {counts.masked:,} masked by the domain of "
        f"{grid.reference}"
    )


def fit(
    campaign: Annotated[Path, typer.Argument(help="A campaign, e.g. fitting/internal.toml.")],
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", help="The result; results/NAME.json beside the campaign."),
    ] = None,
    jobs: Jobs = None,
    runs: Runs = None,
    seed: Seed = None,
    resume: Annotated[bool, typer.Option("--resume", help="Take up an interrupted fit.")] = False,
) -> None:
    """Calibrate a law to a reference by genetic search and local polish."""
    from cylcontact.files import require_writable
    from cylcontact.fitting import calibrate, read_campaign

    planned = read_campaign(campaign, runs, seed)
    target = out or campaign.parent / "results" / f"{campaign.stem}.json"
    require_writable(target)
    kept = target.with_name(target.name + ".partial")
    if resume and not kept.exists():
        typer.echo(f"cylcontact: no runs are kept in {kept}; all are run", err=True)
    try:
        with progress_bars() as progress:
            result = calibrate(planned, jobs or cores(), progress, kept, resume)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(_interrupted(kept)) from None
    result.save(target)
    kept.unlink(missing_ok=True)
    typer.echo(f"{result}\n\nwritten to {target}")


def compare(
    results: Annotated[list[Path], typer.Argument(help="Result files, e.g. fitting/results/*.")],
) -> None:
    """Show results side by side, with the published coefficients."""
    from cylcontact import fitting

    typer.echo(fitting.compare([fitting.FitResult.load(path) for path in results]))


def verify(
    results: Annotated[
        list[Path] | None, typer.Argument(help="Result files; all committed ones by default.")
    ] = None,
    jobs: Jobs = None,
) -> None:
    """Redo committed fits with their own settings and compare; exit code 1 where one differs."""
    from cylcontact.fitting.verify import verify as verify_one

    paths = results or sorted(RESULTS.glob("*.json"))
    if not paths:
        raise InputError(str(RESULTS), "", None, "holds no results", "run make fits, or name some")
    failed = 0
    for path in paths:
        with progress_bars() as progress:
            checks = verify_one(path, jobs or cores(), progress)
        for check in checks:
            typer.echo(f"{path.stem}: {check}")
        failed += sum(not check.holds for check in checks)
    typer.echo(f"{len(paths)} results verified, {failed} checks do not hold")
    if failed:
        raise typer.Exit(1)


def _interrupted(kept: Path) -> str:
    """Say what an interrupted fit leaves behind."""
    runs = kept.read_bytes().count(b"\n") - 1 if kept.is_file() else 0
    if runs < 1:
        return "interrupted before a run was complete; nothing is kept"
    return (
        f"interrupted; {runs} complete {'run is' if runs == 1 else 'runs are'} kept in {kept}; "
        "the same command with --resume goes on from there"
    )
