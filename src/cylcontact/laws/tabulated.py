"""Tables of ln f over ln δ at one pair, for laws without a formula to compile."""

from __future__ import annotations

from math import exp, log
from typing import Annotated, TypeVar

import numpy as np

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws.law import ContactLaw
from cylcontact.support.arrays import FloatArray, IndexArray, as_floats, require

_Number = TypeVar("_Number", float, FloatArray)

# The relative error of a load from the table, checked inside every interval.
TABLE_ERROR = 1e-10
# The ends of the table in units of ΔR, unless the law ends before.
_SHALLOWEST, DEEPEST = 1e-30, 1e3

_FIRST_NODES = 257
_MOST_NODES = 200_000
# Shortest interval of ln δ. Next to a vertical tangent or a jump in slope the table has the error
# of one such interval.
_SHORTEST = 1e-12
# Positions of the checks in an interval, as fractions of its length.
_CHECKED = (0.25, 0.5, 0.75)


def tabulate(law: ContactLaw, pair: CylinderPair) -> FloatArray:
    """Return a law at one pair as one flat array.

    The penetration at which the table ends, in mm, is followed by ln δ, ln f and dln f/dln δ at N
    nodes. The table ends at 1000·ΔR, unless the domain of the law ends before; a law without an
    end, such as Persson's, is defined beyond the table. A cubic between the nodes, and the first
    slope below them, give the load to a relative `TABLE_ERROR` from 1e-30·ΔR on. Within 1e-12 in
    ln δ of a vertical tangent or a jump in slope the error may be larger. Raises `InputError` if
    the law is undefined or not smooth somewhere.
    """
    dR = float(np.asarray(pair.dR))
    end = min(float(law.max_penetration(pair)), DEEPEST * dR)
    x = np.linspace(np.log(_SHALLOWEST * dR), np.log(end), _FIRST_NODES)
    while True:
        y, slope = _logarithms(law, pair, x, end)
        coarse = _coarse(law, pair, x, y, slope, end)
        if not coarse.size:
            return np.concatenate([[end], x, y, slope])
        x = np.insert(x, coarse + 1, (x[coarse] + x[coarse + 1]) / 2)
        rule = f"its load is not smooth: {_MOST_NODES} nodes do not give it to {TABLE_ERROR:g}"
        remedy = "check its load and stiffness"
        require(x.size <= _MOST_NODES, "tabulate", "law", law.name, rule, remedy)


def cubic(
    part: _Number, width: _Number, rise: _Number, first: _Number, last: _Number
) -> tuple[_Number, _Number]:
    """Return the cubic with given slopes at both ends of an interval, and its slope."""
    rest, left, right = 1 - part, first - rise, last - rise
    above = width * part * (rise + rest * (rest * left - part * right))
    slope = rise + rest * (1 - 3 * part) * left - part * (2 - 3 * part) * right
    return above, slope


def _logarithms(
    law: ContactLaw, pair: CylinderPair, x: FloatArray, end: float
) -> tuple[FloatArray, FloatArray]:
    """Return ln f and dln f/dln δ at x = ln δ."""
    delta = np.minimum(np.exp(x), end)
    f, k = law.load(delta, pair), law.stiffness(delta, pair)
    defined = (f > 0) & np.isfinite(f) & (k >= 0)
    where = f"{delta[~defined][:1]} mm"
    rule = f"its load or its stiffness is not a positive number at {where}"
    remedy = "a law must be defined from zero to its max_penetration"
    require(defined, "tabulate", "law", law.name, rule, remedy)
    with np.errstate(invalid="ignore"):
        slope = delta * k / f
    # In place of a vertical tangent use the chord, the best a cubic can do there.
    chord = np.gradient(np.log(f), x)
    return np.log(f), as_floats(np.where(np.isfinite(slope), slope, chord))


def _coarse(
    law: ContactLaw, pair: CylinderPair, x: FloatArray, y: FloatArray, slope: FloatArray, end: float
) -> IndexArray:
    """Return the intervals in which the error of the cubic exceeds the tolerance."""
    width = np.diff(x)
    rise = np.diff(y) / width
    bad = np.zeros(width.size, dtype=bool)
    for part in _CHECKED:
        exact, _ = _logarithms(law, pair, x[:-1] + part * width, end)
        above, _ = cubic(np.full_like(width, part), width, rise, slope[:-1], slope[1:])
        bad |= np.abs(y[:-1] + above - exact) > TABLE_ERROR / 4
    return np.flatnonzero(bad & (width > _SHORTEST))


# --- plain functions: of a number, from the nodes ------------------------------------------------

Nodes = Annotated[FloatArray, 0]


def interval_of(at: float, x: Nodes, nodes: int) -> int:
    """Return the interval of x that has `at`; the first or the last one beyond the nodes."""
    low = 0
    high = nodes - 1
    while high - low > 1:
        middle = (low + high) // 2
        if x[middle] <= at:
            low = middle
        else:
            high = middle
    return low


def load_of_table(penetration: float, x: Nodes, y: Nodes, slopes: Nodes, nodes: int) -> float:
    """Return the load from ln δ, ln f and dln f/dln δ at the nodes."""
    at = log(penetration)
    if at <= x[0]:
        return exp(y[0] + slopes[0] * (at - x[0]))
    low = interval_of(at, x, nodes)
    width = x[low + 1] - x[low]
    rise = (y[low + 1] - y[low]) / width
    part = (at - x[low]) / width
    rest = 1.0 - part
    bend = rest * (slopes[low] - rise) - part * (slopes[low + 1] - rise)
    return exp(y[low] + width * part * (rise + rest * bend))


def stiffness_of_table(penetration: float, x: Nodes, y: Nodes, slopes: Nodes, nodes: int) -> float:
    """Return the stiffness from the same: f/δ·dln f/dln δ."""
    at = log(penetration)
    if at <= x[0]:
        return slopes[0] * exp(y[0] + slopes[0] * (at - x[0])) / penetration
    low = interval_of(at, x, nodes)
    width = x[low + 1] - x[low]
    rise = (y[low + 1] - y[low]) / width
    part = (at - x[low]) / width
    rest = 1.0 - part
    left = slopes[low] - rise
    right = slopes[low + 1] - rise
    load = exp(y[low] + width * part * (rise + rest * (rest * left - part * right)))
    exponent = rise + rest * (1.0 - 3.0 * part) * left - part * (2.0 - 3.0 * part) * right
    return load * exponent / penetration
