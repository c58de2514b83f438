"""The callback by which long computations report their progress."""

from __future__ import annotations

from collections.abc import Callable

# Called with the stage, how many of its parts are done, and their number.
Progress = Callable[[str, int, int], None]


def silent(stage: str, done: int, total: int) -> None:
    """Report nothing."""
