"""Deferred calls, to be made by a worker."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

__all__ = ["RESUME", "Call", "call"]

# A function with its arguments, as joblib takes it.
Call = tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]
# What to do once workers are lost.
RESUME = "a command that has --resume goes on with it from what is complete"


def call(function: Callable[..., Any], *arguments: Any, **named: Any) -> Call:
    """Return a deferred call.

    Parameters
    ----------
    function : callable
        A module-level function, so that other processes can import it.
    *arguments, **named
        Its arguments.

    Returns
    -------
    tuple
        The same as from `joblib.delayed`, but typed and without importing joblib.

    Examples
    --------
    >>> function, arguments, named = call(round, 2.1234, ndigits=2)
    >>> function(*arguments, **named)
    2.12
    """
    return function, arguments, named
