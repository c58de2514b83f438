"""Readings of a claim, and the finding that they make."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from cylcontact.reports.claims import Finding, Reading


def reading(
    choice: str,
    ours: str,
    holds: bool | np.bool_,
    miss: str = "",
    missing: str = "",
    ground: str = "",
) -> Reading:
    """Return a reading; `miss` is told only where it does not hold."""
    return Reading(choice, ours, bool(holds), missing, "" if holds else miss, ground)


def below(choice: str, percent: float, bound: float, missing: str = "") -> Reading:
    """Return the reading by which a difference in percent must be smaller than a bound."""
    excess = abs(percent) - bound
    text = f"{percent:+.3g} %"
    return reading(choice, text, excess < 0, f"{excess:.2g} points too much", missing)


def found(readings: Sequence[Reading], ours: str = "", **more: Any) -> Finding:
    """Return the finding whose own reading is the first, told as `ours` if that is given."""
    own, *others = readings
    fields = asdict(own) | {"ours": ours or own.ours} | more
    return Finding(**fields, alternatives=others)
