"""Worker processes of the commands, and their progress bars."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import typer

from cylcontact.progress import Progress

if TYPE_CHECKING:
    from cylcontact.parallel import Workers

__all__ = ["cores", "progress_bars", "workers"]


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


@contextmanager
def progress_bars() -> Iterator[Progress]:
    """Give a callback that draws progress bars if standard error is a terminal."""
    from rich import progress
    from rich.console import Console

    terminal = sys.stderr is not None and sys.stderr.isatty()
    columns = (
        progress.TextColumn("{task.description:>10}"),
        progress.BarColumn(),
        progress.MofNCompleteColumn(),
        progress.TimeElapsedColumn(),
    )
    console = Console(stderr=True)
    with progress.Progress(*columns, console=console, disable=not terminal) as bars:
        tasks = {}

        def update(stage: str, done: int, total: int) -> None:
            if stage not in tasks:
                tasks[stage] = bars.add_task(stage, total=total)
            bars.update(tasks[stage], completed=done)

        yield update
