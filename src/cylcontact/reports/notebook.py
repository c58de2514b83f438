"""Progress bars of long computations in a notebook."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from html import escape
from importlib import import_module
from typing import Any

from cylcontact.support.progress import Progress

__all__ = ["live_progress"]


@contextmanager
def live_progress() -> Iterator[Progress]:
    """Show a bar for each stage of a long computation below the running cell."""
    ipython: Any = import_module("IPython.display")
    handles: dict[str, Any] = {}

    def show(stage: str, done: int, total: int) -> None:
        name = escape(stage)
        bar = f'<progress value="{done}" max="{total}" aria-label="{name}"></progress>'
        html = ipython.HTML(f"{bar} {name} {done}/{total}")
        if stage not in handles:
            # Outside a notebook, IPython returns None, which cannot be updated.
            handles[stage] = ipython.display(html, display_id=True)
        elif handles[stage] is not None:
            handles[stage].update(html)

    yield show
