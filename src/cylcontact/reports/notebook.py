"""Helpers of the notebooks: optional packages, and live progress bars."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from html import escape
from importlib import import_module
from types import ModuleType
from typing import Any

from cylcontact.support.errors import InputError
from cylcontact.support.progress import Progress

__all__ = ["live_progress", "progress_bar", "require_extra"]

REMEDY = "run `make extras` in the repository, or: pip install 'cylcontact[notebooks]'"


def require_extra(module: str) -> ModuleType:
    """Return a module of the extra `notebooks`, or raise `InputError` with the remedy.

    Examples
    --------
    >>> require_extra("no_such_module")
    Traceback (most recent call last):
    ...
    cylcontact.support.errors.InputError: notebook: no_such_module is not installed; run ...
    """
    try:
        return import_module(module)
    except ImportError:
        raise InputError("notebook", "", None, f"{module} is not installed", REMEDY) from None


@contextmanager
def live_progress() -> Iterator[Progress]:
    """Show a bar per stage of a long computation below the running cell."""
    display = require_extra("IPython.display")
    handles: dict[str, Any] = {}

    def show(stage: str, done: int, total: int) -> None:
        bar = display.HTML(progress_bar(stage, done, total))
        if stage not in handles:
            # Outside a notebook, IPython returns None, which cannot be updated.
            handles[stage] = display.display(bar, display_id=True)
        elif handles[stage] is not None:
            handles[stage].update(bar)

    yield show


def progress_bar(stage: str, done: int, total: int) -> str:
    """Return a progress bar as HTML.

    Examples
    --------
    >>> print(progress_bar("searching", 3, 16))
    <progress value="3" max="16" aria-label="searching"></progress> searching 3/16
    """
    name = escape(stage)
    bar = f'<progress value="{done}" max="{total}" aria-label="{name}"></progress>'
    return f"{bar} {name} {done}/{total}"
