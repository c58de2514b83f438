"""Worker processes of the commands, and their progress bars."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import typer

from cylcontact.plain_text import brief, visible
from cylcontact.progress import Progress

if TYPE_CHECKING:
    from cylcontact.parallel import Workers


def cores() -> int:
    """Return the number of cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def workers(jobs: int | None, scheduler: str | None) -> Workers:
    """Return the number of processes, all cores by default, or the Dask cluster at `scheduler`."""
    from cylcontact.parallel import Cluster

    if scheduler is None:
        return jobs or cores()
    if jobs is not None:
        raise typer.BadParameter("--jobs is for this machine; leave it out with --scheduler")
    return Cluster(scheduler)


def say(text: str, err: bool = False) -> None:
    """Print a text, on standard error if `err`; characters that are not seen are escaped."""
    typer.echo(visible(text, "\n"), err=err)


@contextmanager
def progress_bars() -> Iterator[Progress]:
    """Give a callback that draws progress bars if standard error is a terminal."""
    from rich import progress
    from rich.console import Console

    terminal = sys.stderr is not None and sys.stderr.isatty()
    columns = (
        progress.TextColumn("{task.description:>10}", markup=False),
        progress.BarColumn(),
        progress.MofNCompleteColumn(),
        progress.TimeElapsedColumn(),
    )
    console = Console(stderr=True)
    with progress.Progress(*columns, console=console, disable=not terminal) as bars:
        tasks = {}

        def update(stage: str, done: int, total: int) -> None:
            if stage not in tasks:
                tasks[stage] = bars.add_task(brief(stage), total=total)
            bars.update(tasks[stage], completed=done)

        yield update


def noting(progress: Progress, stage: str, note: str) -> Progress:
    """Return a callback that says a note, unless it is empty, when a stage begins.

    By then the input is checked, so that an error in it is the only line.
    """
    notes = [note] if note else []

    def update(now: str, done: int, total: int) -> None:
        if now == stage and notes:
            say(f"cylcontact: {notes.pop()}", err=True)
        progress(now, done, total)

    return update
