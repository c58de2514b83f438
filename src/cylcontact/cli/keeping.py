"""What long commands keep beside their output, so that an interrupted one can go on from there."""

from __future__ import annotations

from pathlib import Path


def kept_beside(target: Path) -> Path:
    """Return where the complete parts of an output are kept until it is whole.

    Examples
    --------
    >>> kept_beside(Path("build/mine.json")).as_posix()
    'build/mine.json.partial'
    """
    return target.with_name(target.name + ".partial")


def interrupted(kept: Path, part: str) -> str:
    """Say what an interrupted command leaves behind.

    Parameters
    ----------
    kept : path
        A line that says what is kept, then a line for each complete part.
    part : str
        What a part is called, "run" or "case".

    Examples
    --------
    >>> interrupted(Path("no such.partial"), "run")
    'interrupted before a run was complete; nothing is kept'
    """
    count = kept.read_bytes().count(b"\n") - 1 if kept.is_file() else 0
    if count < 1:
        return f"interrupted before a {part} was complete; nothing is kept"
    parts = f"{part} is" if count == 1 else f"{part}s are"
    return (
        f"interrupted; {count} complete {parts} kept in {kept}; "
        "the same command with --resume goes on from there"
    )
