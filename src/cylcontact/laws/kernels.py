"""The contact laws as compiled scalar functions, for right-hand sides compiled by numba.

A `Kernel` represents a law at one pair: which function states it, and the numbers of the pair. Both
are plain data, so one compiled integrator serves every law:

    load = kernel_load(kernel.kind, kernel.parameters, penetration)

A law of one formula (`cylcontact.laws.formula`) is compiled as it stands, and is right to a few
units in the last place. Conformal contact is its own curve (`cylcontact.laws.conformal.curve`).
Every other law, such as your own function, becomes a table: a cubic in ln f over ln δ, with
nodes added until the load is right to `TABLE_ERROR`.

This module imports numba, which is slow: import it where it is needed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba.extending import overload

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import Conformal, explicit, lambert, liu, logarithmic, power
from cylcontact.laws.conformal.curve import FAR_STEP
from cylcontact.laws.law import ENERGY_NODES, ENERGY_WEIGHTS, ContactLaw, has_formula
from cylcontact.laws.tabulated import (
    interval_of,
    load_of_table,
    stiffness_of_table,
    tabulate,
)
from cylcontact.support.arrays import FloatArray, require
from cylcontact.support.numba_cache import called, compiled, inlined, merged

POWER, LOGARITHMIC, EXPLICIT, LIU, CURVE, TABLE = range(6)
# The functions that are compiled as they stand.
KINDS = {power.load: POWER, logarithmic.load: LOGARITHMIC, explicit.load: EXPLICIT, liu.load: LIU}


@dataclass(frozen=True, eq=False)
class Kernel:
    """A law at one pair, ready for `kernel_load` and `kernel_stiffness`.

    `kind` says which function states it, `parameters` are its numbers. Beyond `max_penetration`,
    in mm, the load is NaN. A table ends at 1000·ΔR, unless the law ends before.
    """

    kind: int
    parameters: FloatArray
    max_penetration: float

    def load(self, penetration: float) -> float:
        """Return `kernel_load` at `penetration` in mm, for calls from Python."""
        return kernel_load(self.kind, self.parameters, penetration)

    def stiffness(self, penetration: float) -> float:
        """Return `kernel_stiffness` at `penetration` in mm, for calls from Python."""
        return kernel_stiffness(self.kind, self.parameters, penetration)


def kernel(law: ContactLaw, pair: CylinderPair) -> Kernel:
    """Return a law of the package or of the user at one pair as a kernel; refuse arrays.

    >>> from cylcontact import CylinderPair, Material, laws
    >>> pair = CylinderPair.internal(10.0, 9.5, Material("steel", E=207e3, nu=0.3))
    >>> made, law = kernel(laws.Johnson(), pair), laws.Johnson()
    >>> print(f"{made.load(1e-3):.9f} N/mm, {law.load(1e-3, pair):.9f} N/mm")
    40.730908413 N/mm, 40.730908413 N/mm
    """
    limit = np.asarray(law.max_penetration(pair))
    rule, remedy = "must be a single one", "make a kernel for each"
    require(limit.ndim == 0, "kernel", "pair", f"{limit.size} pairs", rule, remedy)
    rule = f"the {law.name} law is undefined for this pair"
    remedy = "choose another law, or a pair within its range"
    require(limit > 0, "kernel", "pair.dR", pair.dR, rule, remedy)
    if isinstance(law, Conformal):
        return Kernel(CURVE, _numbers_of(law, pair), float(limit))
    if has_formula(law) and (kind := KINDS.get(law.formula_for(pair.contact).load)) is not None:
        numbers = np.array([float(number) for number in law.numbers_at(pair)])
        return Kernel(kind, numbers, float(limit))
    table = tabulate(law, pair)
    return Kernel(TABLE, table, float(table[0]))


lambert.compiled_shares()  # so that compiled code can call the functions of numbers


@overload(lambert.branch_distance, strict=False)
def _branch_distance(p: Any) -> Any:
    return _distance_of_number


@overload(lambert.branch_share, strict=False)
def _branch_share(p: Any) -> Any:
    return _share_of_number


@called
def _distance_of_number(p: float) -> float:
    """Return `branch_distance` of a number: a root is NaN for p > 1."""
    if p == 0:
        return math.inf
    r = math.sqrt(0 - math.log(p))
    return lambert.numerator(r) / lambert.denominator(r)


@called
def _share_of_number(p: float) -> float:
    """Return `branch_share` of a number."""
    if p == 0:
        return 0.0
    return lambert.share_at(p, math.sqrt(-math.log(p)))


_power, _power_slope, _power_energy = map(merged, (power.load, power.stiffness, power.energy))
_log, _log_slope, _log_energy = map(
    called, (logarithmic.load, logarithmic.stiffness, logarithmic.energy)
)
_explicit, _explicit_slope = merged(explicit.load), merged(explicit.stiffness)
_liu, _liu_slope = merged(liu.load), merged(liu.stiffness)
called(interval_of)
_of_table, _slope_of_table = called(load_of_table), called(stiffness_of_table)

# The numbers of a curve before its cubics: 4 of L for each interval, then as many of U/(φ·d).
_HEAD = 10


def _numbers_of(law: Conformal, pair: CylinderPair) -> FloatArray:
    """Return the curve of `Conformal` at one pair as one flat array."""
    curve, dR = law.curve(pair), float(pair.dR)
    nodes, terms = curve.L.nodes, curve.L.terms
    head = [dR, math.pi * float(pair.E_star), curve.end[1] * dR, nodes.scale * dR, nodes.first]
    head += [nodes.near, 1 / nodes.step, 1 / FAR_STEP, nodes.near_count, terms.shape[1]]
    return np.concatenate([head, terms.T.ravel(), curve.work.terms.T.ravel()])


@inlined
def _place(numbers: FloatArray, penetration: float) -> tuple[int, float]:
    """Return where the cubic of L begins, and the part of its interval."""
    s = math.log(1 + numbers[3] / penetration)
    at = (s - numbers[4]) * numbers[6]
    if s > numbers[5]:
        at = numbers[8] + (s - numbers[5]) * numbers[7]
    interval = int(at)
    return _HEAD + 4 * interval, at - interval


@inlined
def _cubic_of(numbers: FloatArray, first: int, part: float) -> float:
    """Return a cubic."""
    bend = numbers[first + 2] + part * numbers[first + 3]
    return numbers[first] + part * (numbers[first + 1] + part * bend)


@called
def _table(numbers: FloatArray, penetration: float) -> float:
    """Return the load in N/mm from a table of `tabulate`."""
    n = numbers.size // 3
    if not penetration <= numbers[0]:
        return math.nan
    x, y, slopes = numbers[1 : 1 + n], numbers[1 + n : 1 + 2 * n], numbers[1 + 2 * n :]
    return _of_table(penetration, x, y, slopes, n)


@called
def _curve(numbers: FloatArray, penetration: float) -> float:
    """Return the load in N/mm from a curve."""
    if not penetration <= numbers[2]:
        return math.nan
    first, part = _place(numbers, penetration)
    return numbers[1] * penetration / _cubic_of(numbers, first, part)


@inlined
def inlined_load(kind: int, parameters: FloatArray, penetration: float) -> float:  # noqa: PLR0911
    """Return the load in N/mm at `penetration` in mm, to compiled functions."""
    n = parameters
    if penetration <= 0:
        return 0.0
    if kind == POWER:
        return _power(penetration, n[0], n[1])
    if kind == LOGARITHMIC:
        return _log(penetration, n[0], n[1])
    if kind == EXPLICIT:
        return _explicit(penetration, n[0], n[1], n[2], n[3], n[4])
    if kind == LIU:
        return _liu(penetration, n[0], n[1])
    if kind == CURVE:
        return _curve(n, penetration)
    return _table(n, penetration)


kernel_load = compiled(inlined_load, forceinline=True)


@compiled
def kernel_stiffness(  # noqa: PLR0911
    kind: int, parameters: FloatArray, penetration: float
) -> float:
    """Return d(load)/d(penetration) in N/mm² at `penetration` in mm."""
    n = parameters
    if penetration <= 0:
        return 0.0
    if kind == POWER:
        return _power_slope(penetration, n[0], n[1])
    if kind == LOGARITHMIC:
        return _log_slope(penetration, n[0], n[1])
    if kind == EXPLICIT:
        return _explicit_slope(penetration, n[0], n[1], n[2], n[3], n[4])
    if kind == LIU:
        return _liu_slope(penetration, n[0], n[1])
    if kind == CURVE:
        return _curve_slope(n, penetration)
    return _table_slope(n, penetration)


@called
def _table_slope(numbers: FloatArray, penetration: float) -> float:
    """Return the stiffness in N/mm² from a table."""
    n = numbers.size // 3
    if not penetration <= numbers[0]:
        return math.nan
    x, y, slopes = numbers[1 : 1 + n], numbers[1 + n : 1 + 2 * n], numbers[1 + 2 * n :]
    return _slope_of_table(penetration, x, y, slopes, n)


@called
def _curve_slope(numbers: FloatArray, penetration: float) -> float:
    """Return the stiffness in N/mm² from a curve."""
    if not penetration <= numbers[2]:
        return math.nan
    first, part = _place(numbers, penetration)
    L, bend = _cubic_of(numbers, first, part), 3 * part * numbers[first + 3]
    slope = numbers[first + 1] + part * (2 * numbers[first + 2] + bend)
    slope *= numbers[6] if first < _HEAD + 4 * numbers[8] else numbers[7]
    return numbers[1] / L * (1 + slope / L * numbers[3] / (numbers[3] + penetration))


@compiled
def kernel_energy(kind: int, parameters: FloatArray, penetration: float) -> float:
    """Return ∫ f dδ from 0 to `penetration` in mm: the stored energy per unit length, in N."""
    n = parameters
    if penetration <= 0:
        return 0.0
    if kind == POWER:
        return _power_energy(penetration, n[0], n[1])
    if kind == LOGARITHMIC:
        return _log_energy(penetration, n[0], n[1])
    if kind == CURVE:
        return _curve_energy(n, penetration)
    total = 0.0
    for node in range(ENERGY_NODES.size):
        total += ENERGY_WEIGHTS[node] * inlined_load(kind, n, penetration * ENERGY_NODES[node])
    return total * penetration


@called
def _curve_energy(numbers: FloatArray, penetration: float) -> float:
    """Return the stored energy from a curve."""
    if not penetration <= numbers[2]:
        return math.nan
    first, part = _place(numbers, penetration)
    L = _cubic_of(numbers, first, part)
    work = _cubic_of(numbers, first + 4 * int(numbers[9]), part)
    return numbers[1] * penetration * penetration * work / L
