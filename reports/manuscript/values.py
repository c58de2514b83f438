"""The values that `contact-laws.md` names, and the phrases that they must support."""

import cylcontact
from cylcontact.reports import Bench
from cylcontact.reports.manuscript import Group

from . import law_values, mechanism_values
from .law_values import (
    explicit_law,
    housing,
    johnson,
    law,
    made,
    pairs,
    pins,
    ranges,
    readings,
    yielding,
)
from .mechanism_values import crank, elements, ledger, restitution

__all__ = [
    "HOLDS",
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

HOLDS = {**law_values.HOLDS, **mechanism_values.HOLDS}


def software(bench: Bench) -> Group:  # noqa: ARG001
    """Return the version of the package."""
    return {"version": cylcontact.__version__}
