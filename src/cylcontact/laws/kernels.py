"""The contact laws as compiled scalar functions, for right-hand sides compiled by numba.

A `Kernel` represents a law at one pair: the kind of formula and its parameters. Both are plain
data, so one compiled integrator serves every law:

    load = kernel_load(kernel.kind, kernel.parameters, penetration)

A law of one formula (`cylcontact.laws.formula`) is compiled from the steps that are exported to
other languages too, and is right to a few units in the last place. Conformal contact is its own
curve (`cylcontact.laws.conformal.curve`). Every other law, such as a function of one's own, becomes
a table: a cubic in ln f over ln δ, with nodes added until the load is right to `TABLE_ERROR`.

This module imports numba, which is slow: import it where it is needed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import LAW_TYPES, Conformal
from cylcontact.laws.conformal.curve import FAR_STEP
from cylcontact.laws.formula import Formula, lines_of, needed
from cylcontact.laws.law import ENERGY_NODES, ENERGY_WEIGHTS, ContactLaw, Law, has_formula
from cylcontact.laws.tabulated import cubic, tabulate
from cylcontact.support.arrays import FloatArray, require
from cylcontact.support.numba_cache import called, compiled, inlined, merged

TABLE, CURVE = -1, -2


def _key(formula: Formula) -> tuple[Any, ...]:
    """Return what formulas have in common that are compiled as one."""
    return formula.function, formula.end, formula.energy, formula.numbers


_KINDS = {_key(law.formula): law.formula for law in LAW_TYPES if issubclass(law, Law)}
_KEYS = list(_KINDS)


@dataclass(frozen=True, eq=False)
class Kernel:
    """A law at one pair, ready for `kernel_load` and `kernel_stiffness`.

    `kind` is the number of the formula, `CURVE` or `TABLE`; `parameters` are its numbers. Beyond
    `max_penetration`, in mm, the load is NaN. A table ends at 1000·ΔR, unless the law ends before.
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
    """Return a law of the package or of the user's own at one pair as a kernel; refuse arrays.

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
    formula = law.formula_at(pair) if has_formula(law) else None
    key = None if formula is None else _key(formula)
    if isinstance(law, Conformal):
        return Kernel(CURVE, _numbers_of(law, pair), float(limit))
    if not isinstance(law, Law) or key not in _KINDS:
        table = tabulate(law, pair)
        return Kernel(TABLE, table, float(table[0]))
    numbers = [float(number) for number in law.numbers_at(pair).values()]
    return Kernel(_KEYS.index(key), np.array(numbers), float(limit))


_cubic = called(cubic)


@called
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
    value: float = numbers[first] + part * (numbers[first + 1] + part * bend)
    return value


@called
def _other_load(kind: int, numbers: FloatArray, penetration: float) -> float:
    """Return the load in N/mm from a curve or a table."""
    if kind == TABLE:
        return _read_table(numbers, penetration)[0]
    if not penetration <= numbers[2]:
        return math.nan
    first, part = _place(numbers, penetration)
    load: float = numbers[1] * penetration / _cubic_of(numbers, first, part)
    return load


@called
def _other_stiffness(kind: int, numbers: FloatArray, penetration: float) -> float:
    """Return the stiffness in N/mm² from a curve or a table."""
    if kind == TABLE:
        load, exponent = _read_table(numbers, penetration)
        return load * exponent / penetration
    if not penetration <= numbers[2]:
        return math.nan
    first, part = _place(numbers, penetration)
    L, bend = _cubic_of(numbers, first, part), 3 * part * numbers[first + 3]
    slope = numbers[first + 1] + part * (2 * numbers[first + 2] + bend)
    slope *= numbers[6] if first < _HEAD + 4 * numbers[8] else numbers[7]
    stiffness: float = numbers[1] / L * (1 + slope / L * numbers[3] / (numbers[3] + penetration))
    return stiffness


def _of_all_kinds(result: str, other: Any) -> Callable[[int, FloatArray, float], float]:
    """Return one function for the load, the stiffness or the energy of kernels of every kind.

    `other` is for curves, tables, and kinds that have no closed form of the result. Steps that a
    result does not need are left out, because a compiler keeps calls of `pow`.
    """
    lines = ["def function(kind, numbers, penetration):"]
    for kind, formula in enumerate(_KINDS.values()):
        steps = needed(formula.scalar_steps, result)
        if result == "energy" and formula.energy is None:
            continue
        used = {*formula.numbers_of(result), *(("last",) if formula.end else ())}
        lines += [f"  if kind == {kind}:"]
        lines += [
            f"    {name} = numbers[{k}]" for k, name in enumerate(formula.numbers) if name in used
        ]
        lines += ["    if not penetration <= last:", "      return nan"] if formula.end else []
        lines += [f"    {line}" for line in [*lines_of(steps), f"return {result}"]]
    names = {**vars(math), "other": other}
    exec("\n".join([*lines, "  return other(kind, numbers, penetration)"]), names)
    return cast(Callable[[int, FloatArray, float], float], merged(names["function"]))


_load = _of_all_kinds("f", _other_load)
_stiffness = _of_all_kinds("k", _other_stiffness)


@inlined
def inlined_load(kind: int, parameters: FloatArray, penetration: float) -> float:
    """Return the load in N/mm at `penetration` in mm, to compiled functions."""
    if penetration <= 0:
        return 0.0
    return _load(kind, parameters, penetration)


kernel_load = compiled(inlined_load, forceinline=True)


@inlined
def _quadrature(kind: int, numbers: FloatArray, penetration: float) -> float:
    """Return the integral of the load up to a penetration, in N."""
    total = 0.0
    for node in range(ENERGY_NODES.size):
        load = inlined_load(kind, numbers, penetration * ENERGY_NODES[node])
        total += ENERGY_WEIGHTS[node] * load
    return total * penetration


@inlined
def _other_energy(kind: int, numbers: FloatArray, penetration: float) -> float:
    """Return the integral of the load up to a penetration, in N, from a curve or by quadrature."""
    if kind != CURVE:
        return _quadrature(kind, numbers, penetration)
    if not penetration <= numbers[2]:
        return math.nan
    first, part = _place(numbers, penetration)
    L = _cubic_of(numbers, first, part)
    work = _cubic_of(numbers, first + 4 * int(numbers[9]), part)
    energy: float = numbers[1] * penetration * penetration * work / L
    return energy


_energy = _of_all_kinds("energy", _other_energy)


@compiled
def kernel_stiffness(kind: int, parameters: FloatArray, penetration: float) -> float:
    """Return d(load)/d(penetration) in N/mm² at `penetration` in mm."""
    if penetration <= 0:
        return 0.0
    return _stiffness(kind, parameters, penetration)


@compiled
def kernel_energy(kind: int, parameters: FloatArray, penetration: float) -> float:
    """Return ∫ f dδ from 0 to `penetration` in mm: the stored energy per unit length, in N."""
    if penetration <= 0:
        return 0.0
    return _energy(kind, parameters, penetration)
