"""Names to choose from in specs and options, in a module that imports nothing slow."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, get_args

__all__ = [
    "BEYOND",
    "ENGINES",
    "FORMATS",
    "METHODS",
    "TABLE_SUFFIXES",
    "Beyond",
    "Engine",
    "Format",
    "Method",
    "listed",
]

Method = Literal["minimal", "multiplier"]
Beyond = Literal["stop", "tangent"]
Engine = Literal["embedded", "calculix"]
Format = Literal["png", "pdf", "svg", "pgf"]

METHODS: tuple[Method, ...] = get_args(Method)
BEYOND: tuple[Beyond, ...] = get_args(Beyond)
ENGINES: tuple[Engine, ...] = get_args(Engine)
FORMATS: tuple[Format, ...] = get_args(Format)
TABLE_SUFFIXES = (".csv", ".parquet")


def listed(names: Iterable[str]) -> str:
    """Return names as a sentence lists them.

    Examples
    --------
    >>> listed(ENGINES), listed(FORMATS)
    ('embedded or calculix', 'png, pdf, svg or pgf')
    """
    *others, last = names
    return f"{', '.join(others)} or {last}" if others else last
