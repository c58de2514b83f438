"""The command line: `cylcontact sample | fit | compare | verify | report | claims | laws | export`.

Exit codes: 0 done, 1 a check does not hold, 2 bad input (one line on standard error),
130 interrupted, 141 nobody reads the output any more. Heavy imports wait until a command needs
them.
"""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cylcontact.errors import InputError

if TYPE_CHECKING:
    from cylcontact.fitting.calibrate import Progress

RESULTS = Path("fitting/results")

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Calibrate contact laws for parallel cylinders and see where each can be trusted.",
)


def _integer_from(least: int) -> Callable[[str], int]:
    """Return a parser of integers of at least `least`."""

    def parse(text: str) -> int:
        try:
            number = int(text)
        except ValueError:
            number = least - 1
        if number < least:
            raise typer.BadParameter(f"{text!r} must be an integer of at least {least}")
        return number

    return parse


Jobs = Annotated[
    int | None,
    typer.Option(
        "--jobs",
        "-j",
        parser=_integer_from(1),
        metavar="INTEGER",
        help="Worker processes; all cores by default.",
    ),
]
Runs = Annotated[
    int | None,
    typer.Option(
        parser=_integer_from(1), metavar="INTEGER", help="Runs, instead of the campaign's."
    ),
]
Seed = Annotated[
    int | None,
    typer.Option(
        parser=_integer_from(0), metavar="INTEGER", help="Seed, instead of the campaign's."
    ),
]


@app.command()
def sample(
    spec: Annotated[Path, typer.Argument(help="A grid spec, e.g. datasets/internal.toml.")],
    out: Annotated[Path, typer.Option("-o", "--out", help="The .parquet or .csv file to write.")],
) -> None:
    """Sample a reference law over a grid, in bounded memory."""
    from cylcontact.datasets import read_grid, write_samples

    grid = read_grid(spec)
    with _progress() as progress:
        counts = write_samples(grid, out, lambda n: progress("sampling", n, grid.dR.size))
    typer.echo(
        f"{out}: {counts.samples:,} samples, {counts.masked:,} masked by the domain of "
        f"{grid.reference}"
    )


@app.command()
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
        with _progress() as progress:
            result = calibrate(planned, jobs or _cores(), progress, kept, resume)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(_interrupted(kept)) from None
    result.save(target)
    kept.unlink(missing_ok=True)
    typer.echo(f"{result}\n\nwritten to {target}")


@app.command()
def compare(
    results: Annotated[list[Path], typer.Argument(help="Result files, e.g. fitting/results/*.")],
) -> None:
    """Show results side by side, with the published coefficients."""
    from cylcontact import fitting

    typer.echo(fitting.compare([fitting.FitResult.load(path) for path in results]))


@app.command()
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
        with _progress() as progress:
            checks = verify_one(path, jobs or _cores(), progress)
        for check in checks:
            typer.echo(f"{path.stem}: {check}")
        failed += sum(not check.holds for check in checks)
    typer.echo(f"{len(paths)} results verified, {failed} checks do not hold")
    if failed:
        raise typer.Exit(1)


@app.command()
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
    with _progress() as progress:
        progress("drawing", 0, len(wanted))
        for name in wanted:
            (written,) = build(bench, [name], out)
            drawn += 1
            progress("drawing", drawn, len(wanted))
    typer.echo(f"{drawn} figures in {written.paths[0].parent}")


@app.command()
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


@app.command("laws")
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


@app.command()
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


def _cores() -> int:
    """Return the number of cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _interrupted(kept: Path) -> str:
    """Say what an interrupted fit leaves behind."""
    runs = kept.read_bytes().count(b"\n") - 1 if kept.is_file() else 0
    if runs < 1:
        return "interrupted before a run was complete; nothing is kept"
    return (
        f"interrupted; {runs} complete {'run is' if runs == 1 else 'runs are'} kept in {kept}; "
        "the same command with --resume goes on from there"
    )


@contextmanager
def _progress() -> Iterator[Progress]:
    """Show a progress bar on a terminal, and nothing when standard error is not one."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    terminal = sys.stderr is not None and sys.stderr.isatty()
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description:>10}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, disable=not terminal) as bars:
        tasks = {}

        def show(stage: str, done: int, total: int) -> None:
            if stage not in tasks:
                tasks[stage] = bars.add_task(stage, total=total)
            bars.update(tasks[stage], completed=done)

        yield show


def main() -> None:
    """Run the command line, and turn every expected failure into one line and an exit code."""
    _prepare_streams()
    try:
        status = _run(sys.argv[1:])
    except InputError as error:
        status = _fail(str(error))
    except KeyboardInterrupt as stop:
        status = _fail(str(stop) or "interrupted; nothing is left half-written", 130)
    except MemoryError:
        status = _fail("memory is short; thin the grid, or use smaller populations or fewer --jobs")
    except OSError as error:
        # Every file has an InputError of its own, so this is about standard output; give Python
        # somewhere to flush what is left.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        status = 141
        if not isinstance(error, BrokenPipeError):
            status = _fail(f"standard output: cannot be written ({error.strerror}); make room")
    except Exception as error:
        if not hasattr(error, "format_message"):
            raise
        status = _fail(_usage(error, error.format_message()))
    sys.exit(status)


def _prepare_streams() -> None:
    """Make standard output and error take everything: in other encodings, and when closed."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def _run(arguments: Sequence[str]) -> int:
    """Run one command and return its exit code; errors of all kinds come out as they are."""
    command = typer.main.get_command(app)
    try:
        with command.make_context("cylcontact", list(arguments)) as context:
            command.invoke(context)
    except typer.Exit as stop:
        return stop.exit_code
    return 0


def _usage(error: Exception, message: str) -> str:
    """Put a mistake on the command line, told by typer, and the remedy on one line."""
    rule = " ".join(message.split()).rstrip(".") or "a command is missing"
    context = getattr(error, "ctx", None)
    return f"{rule}; see {context.command_path if context else 'cylcontact'} --help"


def _fail(message: str, status: int = 2) -> int:
    """Print one line on standard error and return the exit code, that of bad input by default."""
    typer.echo(f"cylcontact: {message}", err=True)
    return status


if __name__ == "__main__":
    main()
