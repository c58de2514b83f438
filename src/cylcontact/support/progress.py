"""The callback by which long computations report their progress."""

from __future__ import annotations

from collections.abc import Callable

# Called with the stage, how many of its parts are done, and their number.
Progress = Callable[[str, int, int], None]


class _Silent:
    """Report nothing; a default that signatures show as `silent`."""

    def __call__(self, stage: str, done: int, total: int) -> None:
        pass

    def __repr__(self) -> str:
        return "silent"


silent = _Silent()
