"""What the commands share: options, the number of cores, progress bars."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cylcontact.errors import InputError

if TYPE_CHECKING:
    from cylcontact.parallel import Workers

RESULTS = Path("fitting/results")
# Below this a Young's modulus in MPa was probably meant in GPa; stiff plastics begin here.
SOFTEST = 1000.0  # MPa


def integer_from(least: int) -> Callable[[str], int]:
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


def modulus_in_MPa(value: float | None) -> float | None:
    """Note a Young's modulus that was perhaps given in GPa."""
    if value is not None and 0 < value < SOFTEST:
        typer.echo(
            f"cylcontact: --E = {value:g} is taken in MPa; GPa would be {value:g}e3", err=True
        )
    return value


def _named_folder(folder: Path) -> Path:
    """Refuse a folder of results that is named and does not exist; the usual one may be missing."""
    if folder != RESULTS and not folder.is_dir():
        raise InputError(
            "--results", "", str(folder), "is not a folder", "name one that holds fit results"
        )
    return folder


Results = Annotated[
    Path,
    typer.Option("--results", callback=_named_folder, help="The folder of fit results to go by."),
]
Jobs = Annotated[
    int | None,
    typer.Option(
        "--jobs",
        "-j",
        parser=integer_from(1),
        metavar="INTEGER",
        help="Worker processes; all cores by default.",
    ),
]
Scheduler = Annotated[
    str | None,
    typer.Option(metavar="ADDRESS", help="A Dask cluster instead, e.g. tcp://host:8786."),
]
Force = Annotated[
    bool, typer.Option("--force", help="Replace an output that came from other inputs.")
]
Runs = Annotated[
    int | None,
    typer.Option(
        parser=integer_from(1), metavar="INTEGER", help="Runs, instead of the campaign's."
    ),
]
Seed = Annotated[
    int | None,
    typer.Option(
        parser=integer_from(0), metavar="INTEGER", help="Seed, instead of the campaign's."
    ),
]


def cores() -> int:
    """Return the number of cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def workers(jobs: int | None, scheduler: str | None) -> Workers:
    """Return where work is done: on so many processes, all cores by default, or on a cluster."""
    from cylcontact.parallel import Cluster

    if scheduler is None:
        return jobs or cores()
    if jobs is not None:
        raise typer.BadParameter("--jobs is for this machine; leave it out with --scheduler")
    return Cluster(scheduler)


@contextmanager
def progress_bars() -> Iterator[Callable[[str, int, int], None]]:
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
