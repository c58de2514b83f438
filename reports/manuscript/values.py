"""The values that `contact-laws.md` names, and the phrases that they must support."""

from . import law_values, mechanism_values
from .law_values import explicit_law, johnson, law, made, pairs, pins, ranges, readings, yielding
from .mechanism_values import crank, elements, ledger, restitution

__all__ = [
    "HOLDS",
    "crank",
    "elements",
    "explicit_law",
    "johnson",
    "law",
    "ledger",
    "made",
    "pairs",
    "pins",
    "ranges",
    "readings",
    "restitution",
    "yielding",
]

HOLDS = {**law_values.HOLDS, **mechanism_values.HOLDS}
