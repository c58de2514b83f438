"""What the commands say: texts, progress bars, and what an interrupted command has left."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import typer

from cylcontact.support.plain_text import brief, visible
from cylcontact.support.progress import Progress, silent


def say(text: object, err: bool = False) -> None:
    """Print a text, on standard error if `err`; characters that are not seen are escaped."""
    typer.echo(visible(str(text), "\n"), err=err)


def note(text: object, quiet: bool, err: bool = False) -> None:
    """Print what is no result, no warning and no error, unless the user wants it quiet."""
    if not quiet:
        say(text, err)


@contextmanager
def progress_bars(quiet: bool = False) -> Iterator[Progress]:
    """Give a callback that draws progress bars if standard error is a terminal."""
    if quiet or sys.stderr is None or not sys.stderr.isatty():
        yield silent
        return
    from rich import progress
    from rich.console import Console

    columns = (
        progress.TextColumn("{task.description:>10}", markup=False),
        progress.BarColumn(),
        progress.MofNCompleteColumn(),
        progress.TimeElapsedColumn(),
    )
    console = Console(stderr=True)
    with progress.Progress(*columns, console=console) as bars:
        tasks = {}

        def update(stage: str, done: int, total: int) -> None:
            if stage not in tasks:
                tasks[stage] = bars.add_task(brief(stage), total=total)
            bars.update(tasks[stage], completed=done)

        yield update


@contextmanager
def resumable(
    out: Path, part: str, resume: bool, quiet: bool = False
) -> Iterator[tuple[Path, Progress]]:
    """Give the path of the journal beside an output, removed in the end, and a callback for bars.

    If the block fails, the journal stays. An interruption says how many parts it holds, each
    called "run" or "case".
    """
    journal = out.with_name(out.name + ".partial")
    if resume and not journal.exists():
        say(f"cylcontact: no {part}s are kept in {journal}; all are computed", err=True)
    try:
        with progress_bars(quiet) as progress:
            yield journal, progress
    except KeyboardInterrupt:
        # The first line is the header.
        count = journal.read_bytes().count(b"\n") - 1 if journal.is_file() else 0
        text = f"interrupted before a {part} was complete; nothing is kept"
        if count > 0:
            parts = f"{part} is" if count == 1 else f"{part}s are"
            text = (
                f"interrupted; {count} complete {parts} kept in {journal}; "
                "the same command with --resume goes on from there"
            )
        raise KeyboardInterrupt(text) from None
    journal.unlink(missing_ok=True)
