"""Calls put off until a worker makes them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

__all__ = ["Call", "call"]

# A function with its arguments, as joblib takes it.
Call = tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]


def call(function: Callable[..., Any], *arguments: Any, **named: Any) -> Call:
    """Return a call that is not made yet.

    Parameters
    ----------
    function : callable
        A function of a module, so that other processes find it.
    *arguments, **named
        What to call it with.

    Returns
    -------
    tuple
        What `joblib.delayed` would give, typed, and without the import.

    Examples
    --------
    >>> function, arguments, named = call(round, 2.1234, ndigits=2)
    >>> function(*arguments, **named)
    2.12
    """
    return function, arguments, named
