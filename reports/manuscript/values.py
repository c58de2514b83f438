"""The values that `pin_in_hole.md` and `supplement.md` name; an assertion guards their words."""

import cylcontact
from cylcontact.reports import Bench

from .joint_values import crank, restitution
from .law_values import Values, explicit_law, housing, johnson, pairs, pins, yielding
from .paper_values import elements, law, ledger, made, ranges, readings

__all__ = [
    "crank",
    "elements",
    "explicit_law",
    "housing",
    "johnson",
    "law",
    "ledger",
    "made",
    "pairs",
    "pins",
    "ranges",
    "readings",
    "restitution",
    "software",
    "yielding",
]


def software(bench: Bench) -> Values:  # noqa: ARG001
    """Return the version of the package."""
    return {"version": cylcontact.__version__}
