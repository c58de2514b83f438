"""The contact laws as compiled scalar functions, for right-hand sides compiled by numba.

A `Kernel` represents a law at one pair: the kind of formula and its parameters. Both are plain
data, so one compiled integrator serves every law:

    load = kernel_load(kernel.kind, kernel.parameters, penetration)

The logarithmic laws, the power laws (the enhanced one among them), Liu's and the explicit law
are evaluated by their formulas, to a few units in the last place. Every other law (Persson's,
Winkler's, user-defined ones) becomes a table: a cubic in ln f over ln δ, with nodes added until the
load is right to `TABLE_ERROR`.

This module imports numba, which is slow: import it where it is needed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from cylcontact.arrays import FloatArray, require
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.laws.explicit import Explicit
from cylcontact.laws.lambert import START
from cylcontact.laws.liu import Liu
from cylcontact.laws.logarithmic import LogarithmicLaw
from cylcontact.laws.power import PowerShaped
from cylcontact.laws.tabulated import cubic, tabulate
from cylcontact.numba_cache import compiled
from cylcontact.pair import CylinderPair

__all__ = [
    "EXPLICIT",
    "LIU",
    "LOGARITHMIC",
    "POWER",
    "TABLE",
    "Kernel",
    "branch_distance",
    "kernel",
    "kernel_load",
    "kernel_stiffness",
]

LOGARITHMIC, POWER, LIU, EXPLICIT, TABLE = range(5)


@dataclass(frozen=True, eq=False)
class Kernel:
    """A law at one pair, ready for `kernel_load` and `kernel_stiffness`.

    Attributes
    ----------
    kind : int
        The formula: `LOGARITHMIC`, `POWER`, `LIU`, `EXPLICIT` or `TABLE`.
    parameters : array of float, shape (k,)
        Its numbers.
    max_penetration : float
        In mm; beyond it the load is NaN. A table ends at 1000·ΔR, unless the law ends before;
        Persson's and Winkler's laws have no end themselves.
    """

    kind: int
    parameters: FloatArray
    max_penetration: float


def kernel(law: ContactLaw, pair: CylinderPair) -> Kernel:
    """Return a law at one pair as a kernel.

    Parameters
    ----------
    law : ContactLaw
        A law of the package or a user-defined one.
    pair : CylinderPair
        One pair; arrays are refused.

    Returns
    -------
    Kernel

    Raises
    ------
    InputError
        If the pair holds arrays, the law is undefined for it, or a user-defined law cannot be
        tabulated.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material, laws
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.5, material=steel)
    >>> johnson = kernel(laws.Johnson(), pair)
    >>> print(f"{kernel_load(johnson.kind, johnson.parameters, 1e-3):.9f} N/mm")
    40.730908413 N/mm
    >>> print(f"{laws.Johnson().load(1e-3, pair):.9f} N/mm")
    40.730908413 N/mm
    """
    limit = np.asarray(law.max_penetration(pair))
    require(
        limit.ndim == 0,
        "kernel",
        "pair",
        f"{limit.size} pairs",
        "must be a single one",
        "make a kernel for each",
    )
    require(
        limit > 0,
        "kernel",
        "pair.dR",
        pair.dR,
        f"the {law.name} law is undefined for this pair",
        "choose another law, or a pair within its range",
    )
    for method, of_formula in _FORMULAS:
        if type(law).load is method:
            kind, numbers = of_formula(law, pair)
            return Kernel(kind, np.array(numbers, dtype=np.float64), float(limit))
    table = tabulate(law, pair)
    return Kernel(TABLE, table, float(table[0]))


def _logarithmic_numbers(law: LogarithmicLaw, pair: CylinderPair) -> tuple[int, list[float]]:
    largest, deepest = float(law.max_load(pair)), float(law.max_penetration(pair))
    return LOGARITHMIC, [largest, deepest]


def _power_numbers(law: PowerShaped, pair: CylinderPair) -> tuple[int, list[float]]:
    factor, n = law.factor_and_exponent(pair)
    return POWER, [float(factor), float(n)]


def _liu_numbers(_: Liu, pair: CylinderPair) -> tuple[int, list[float]]:
    return LIU, [float(pair.E_star), float(np.asarray(pair.dR))]


def _explicit_numbers(law: Explicit, pair: CylinderPair) -> tuple[int, list[float]]:
    chosen = law.coefficients_for(pair.contact)
    numbers = [float(pair.E_star), float(np.asarray(pair.dR)), chosen.c, chosen.A, chosen.B]
    return EXPLICIT, numbers


# Compare the method, not the class, so that a subclass that overrides `load` is tabulated.
_FORMULAS: tuple[tuple[Any, Callable[[Any, CylinderPair], tuple[int, list[float]]]], ...] = (
    (LogarithmicLaw.load, _logarithmic_numbers),
    (PowerShaped.load, _power_numbers),
    (Liu.load, _liu_numbers),
    (Explicit.load, _explicit_numbers),
)


@compiled
def kernel_load(kind: int, parameters: FloatArray, penetration: float) -> float:
    """Return the load in N/mm at `penetration` in mm.

    Parameters
    ----------
    kind, parameters
        Of a `Kernel`.
    penetration : float
        In mm.

    Returns
    -------
    float
        Zero where there is no penetration, NaN beyond the kernel's `max_penetration`.
    """
    load: float = 0.0
    if penetration <= 0:
        return load
    if kind == LOGARITHMIC:
        p = penetration / parameters[1]
        load = parameters[0] * (p / (1 + branch_distance(p)))
    elif kind == POWER:
        load = parameters[0] * penetration ** parameters[1]
    elif kind == LIU:
        load = math.pi / 2 * parameters[0] * penetration * _liu_root(parameters[1], penetration)
    elif kind == EXPLICIT:
        L, _ = _explicit_logarithms(parameters, penetration)
        load = math.pi * parameters[0] * penetration / L
    else:
        load, _ = _read_table(parameters, penetration)
    return load


@compiled
def kernel_stiffness(kind: int, parameters: FloatArray, penetration: float) -> float:
    """Return d(load)/d(penetration) in N/mm² at `penetration` in mm.

    Parameters
    ----------
    kind, parameters
        Of a `Kernel`.
    penetration : float
        In mm.

    Returns
    -------
    float
        Zero where there is no penetration, NaN beyond the kernel's `max_penetration`. The slope
        of a table is right to about 1e-7.
    """
    stiffness: float = 0.0
    if penetration <= 0:
        return stiffness
    if kind == LOGARITHMIC:
        w = branch_distance(penetration / parameters[1])
        stiffness = parameters[0] / (parameters[1] * w)
    elif kind == POWER:
        stiffness = parameters[1] * parameters[0] * penetration ** (parameters[1] - 1)
    elif kind == LIU:
        dR = parameters[1]
        slope = _liu_root(dR, penetration) * (3 * dR + 2 * penetration) / (dR + penetration)
        stiffness = math.pi / 4 * parameters[0] * slope
    elif kind == EXPLICIT:
        L, slope = _explicit_logarithms(parameters, penetration)
        stiffness = math.pi * parameters[0] * (1 - slope / L) / L
    else:
        load, exponent = _read_table(parameters, penetration)
        stiffness = load * exponent / penetration
    return stiffness


@compiled
def branch_distance(p: float) -> float:
    """Return w = −1 − W₋₁(−p/e) for p > 0, as `cylcontact.laws.lambert` does for arrays.

    Parameters
    ----------
    p : float
        Between 0 and 1.

    Returns
    -------
    float
        NaN if p > 1. Only 1 + w has full precision: the relative error of w, and of a stiffness
        divided by it, grows to 8e-12 at 1 − p = 1e-12.
    """
    if not p < 1:
        return 0.0 if p == 1 else math.nan
    a, b, c, d = START
    g = -math.log(p)
    r = math.sqrt(g)
    u = 1 + r * (a + r * (b + c * r)) / (1 + d * r)
    w = u - 1
    t = (w - math.log(u) - g) / (w * w)
    return w - t * w * u * (1 + t * (0.5 + t * (0.5 + w / 3)))


@compiled
def _liu_root(dR: float, penetration: float) -> float:
    """Return √(δ/(2(ΔR + δ)))."""
    return math.sqrt(penetration / (2 * (dR + penetration)))


@compiled
def _explicit_logarithms(parameters: FloatArray, penetration: float) -> tuple[float, float]:
    """Return L and dL/d(ln d) of the explicit law."""
    d = penetration / parameters[1]
    c, ratio = parameters[2], parameters[3] / d
    inner = math.log(parameters[4] / d)
    middle = c + math.log1p(ratio * inner)
    outer = c + math.log1p(ratio * middle)
    middle_slope = -ratio * (inner + 1) / (1 + ratio * inner)
    return outer, ratio * (middle_slope - middle) / (1 + ratio * middle)


@compiled
def _read_table(table: FloatArray, penetration: float) -> tuple[float, float]:
    """Return the load in N/mm and dln f/dln δ from a table of `tabulate`."""
    if not penetration <= table[0]:
        return math.nan, math.nan
    nodes = table.size // 3
    x, y, slopes = table[1 : 1 + nodes], table[1 + nodes : 1 + 2 * nodes], table[1 + 2 * nodes :]
    at = math.log(penetration)
    if at <= x[0]:
        return math.exp(y[0] + slopes[0] * (at - x[0])), slopes[0]
    below, above = 0, nodes - 1
    while above - below > 1:
        middle = (below + above) // 2
        if x[middle] <= at:
            below = middle
        else:
            above = middle
    width = x[above] - x[below]
    rise = (y[above] - y[below]) / width
    y_at, slope = _cubic((at - x[below]) / width, width, rise, slopes[below], slopes[above])
    return math.exp(y[below] + y_at), slope


_cubic = compiled(cubic)
