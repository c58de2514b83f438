"""The curve of a pin in a hole: tables from which load and penetration follow without a search.

For given α, β, datum and housing d = δ/ΔR is a function of φ = f/(E*·ΔR) alone. In

    s = ln(1 + D/d),

where D is the d from which on the curve is straight, L = π·d/φ is smooth over all d > 0: nearly s
for small d, and a power series in 1/d for large ones. So cubics between even nodes in s, through L
and with its slopes, give the load for one logarithm and one division. The energy, as U/(φ·d), has
the same nodes. The same with φ in place of d is the inverse, and gives the arc and the pressure.

The nodes come from the arcs of `cylcontact.laws.conformal.arcs`. They are closer for s up to
`_NEAR` + ln D. Below that d nothing but L's constant changes with the pair, and L is straight.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cylcontact.laws.conformal.arcs import Arc, Bodies
from cylcontact.support.arrays import FloatArray, IndexArray, as_floats, on_one_thread

# Steps of s up to _NEAR + ln D, and beyond, up to _FAR + ln D; numbers are at least `LEAST`.
_STEP, _NEAR, FAR_STEP, _FAR = 1 / 320, 26.0, 0.5, 692.0
LEAST, MOST = 1e-300, 1e300
# The first step is halved up to so many times, until L is right to this between the nodes.
_HALVINGS, _ERROR = 5, 5e-11
# The same for the inverse, which a step of Newton's method in the other table improves.
_STEP_OF_INVERSE, _ERROR_OF_INVERSE = 1 / 16, 1e-7


@dataclass(frozen=True)
class Nodes:
    """Nodes in s = ln(1 + D/x): even ones up to `near`, and then up to `far` + ln D."""

    scale: float  # D
    first: float  # s of the first node, 0 if the law has no end
    step: float
    near: float
    far: float

    @property
    def near_count(self) -> int:
        """The number of intervals up to `near`."""
        return round((self.near - self.first) / self.step)

    @cached_property
    def s(self) -> FloatArray:
        """All nodes."""
        even = self.first + self.step * np.arange(self.near_count + 1)
        far = self.far + np.log(self.scale)
        return np.concatenate([even[:-1], np.arange(even[-1], far + FAR_STEP, FAR_STEP)])

    @property
    def x(self) -> FloatArray:
        """The numbers at the nodes; a large one stands for infinity."""
        return as_floats(self.scale / np.expm1(np.maximum(self.s, 1e-200)))

    def middles(self) -> FloatArray:
        """Return the numbers in the middle of every third even interval."""
        s = self.first + self.step * (0.5 + np.arange(0, self.near_count, 3))
        return as_floats(self.scale / np.expm1(s))

    def place(self, x: FloatArray) -> tuple[IndexArray, FloatArray]:
        """Return the intervals of positive numbers, and the part of each from 0 to 1."""
        s = np.log(1 + self.scale / x)
        at = np.minimum(s, self.near) - self.first
        at *= 1 / self.step
        if s.max() > self.near:
            at += np.maximum(s - self.near, 0.0) * (1 / FAR_STEP)
        k = at.astype(np.intp)
        part: FloatArray = at - k
        return k, part


@dataclass(frozen=True, eq=False)
class Table:
    """A function of s as cubics: row k of `terms`, shape (4, n), has the factors of part^k."""

    nodes: Nodes
    terms: FloatArray

    @classmethod
    def through(cls, nodes: Nodes, values: FloatArray, slopes: FloatArray) -> Table:
        """Return the cubics through values with slopes by s."""
        width = np.diff(nodes.s)
        rise, left, right = np.diff(values), width * slopes[:-1], width * slopes[1:]
        terms = [values[:-1], left, 3 * rise - 2 * left - right, left + right - 2 * rise]
        return cls(nodes, np.stack(terms))

    def at(self, k: IndexArray, part: FloatArray) -> FloatArray:
        """Return the function."""
        y: FloatArray = self.terms[3].take(k)
        for row in self.terms[2::-1]:
            y *= part
            y += row.take(k)
        return y

    def with_slope(self, k: IndexArray, part: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the function and its derivative by s."""
        zero, one, two, three = (row.take(k) for row in self.terms)
        three *= part
        bend = two + three
        slope = one + part * (2 * bend + three)
        slope *= 1 / self.nodes.step
        if k.max() >= self.nodes.near_count:
            slope = np.where(k < self.nodes.near_count, slope, slope * (self.nodes.step / FAR_STEP))
        return zero + part * (one + part * bend), slope


@dataclass(frozen=True, eq=False)
class Curve:
    """The answers of `Bodies` from tables: L and U/(φ·d) over d, and L over φ.

    Loads and penetrations are from `LEAST` to `MOST`, and not beyond `end`.
    """

    bodies: Bodies
    L: Table
    work: Table
    inverse: Table

    @property
    def end(self) -> tuple[float, float]:
        """φ and d where the law ends, inf where it does not."""
        return self.bodies.end

    def load(self, d: FloatArray) -> FloatArray:
        """Return φ at d."""
        return as_floats(np.pi * d / self.L.at(*self.L.nodes.place(d)))

    def penetration(self, phi: FloatArray) -> FloatArray:
        """Return d under φ, with a step of Newton's method, so that it is the inverse of `load`."""
        d = phi * self.inverse.at(*self.inverse.nodes.place(phi)) * (1 / np.pi)
        L, slope = self._L(d)
        return as_floats(d - d * (d * np.pi - phi * L) / (d * np.pi - phi * slope))

    def stiffness(self, d: FloatArray) -> FloatArray:
        """Return dφ/dd at d."""
        L, slope = self._L(d)
        return as_floats(np.pi * (L - slope) / (L * L))

    def energy(self, d: FloatArray) -> FloatArray:
        """Return the stored energy over E*·ΔR² at d."""
        k, part = self.L.nodes.place(d)
        return as_floats(np.pi * d * d * self.work.at(k, part) / self.L.at(k, part))

    def angle(self, phi: FloatArray) -> FloatArray:
        """Return ε in radians under φ."""
        table, _ = self._arcs
        return as_floats(table.at(*table.nodes.place(phi)) / np.sqrt(1 + table.nodes.scale / phi))

    def peak(self, phi: FloatArray) -> FloatArray:
        """Return the largest R·p/f under φ."""
        _, table = self._arcs
        return as_floats(table.at(*table.nodes.place(phi)) * np.sqrt(1 + table.nodes.scale / phi))

    def _L(self, d: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return L and dL/dln d."""
        nodes = self.L.nodes
        L, slope = self.L.with_slope(*nodes.place(d))
        return L, as_floats(slope / (-1 - d * (1 / nodes.scale)))

    @cached_property
    def _arcs(self) -> tuple[Table, Table]:
        """ε·√(1 + D/φ) and the largest R·p/f over it, over φ: neither varies by much."""
        nodes = _nodes(self.bodies, self.L.nodes.step, by_load=True)
        arc, by_s = _arcs_at(self.bodies, nodes, by_load=True)
        root = np.exp(nodes.s / 2)
        angle, rate = arc.angle * root, np.sqrt(arc.b2) * arc.c * by_s * root
        with on_one_thread():
            peak, slope = (value / root for value in self.bodies.pressure(arc))
        return (
            Table.through(nodes, angle, rate + angle / 2),
            Table.through(nodes, peak, slope * by_s - peak / 2),
        )


@on_one_thread()
def make(
    bodies: Bodies,
    step: float = _STEP,
    near: float = _NEAR,
    far: float = _FAR,
    error: float = _ERROR,
) -> Curve:
    """Return the curve of bodies; a coarser one, as for an export, with other steps and error."""
    bodies.require_increasing()
    with np.errstate(all="ignore"):  # at infinity
        L, work = _tables(bodies, _nodes(bodies, step, near, far), error)
        nodes = _nodes(bodies, _STEP_OF_INVERSE, near, far, by_load=True)
        inverse, _ = _tables(bodies, nodes, _ERROR_OF_INVERSE, by_load=True)
    return Curve(bodies, L, work, inverse)


def _nodes(
    bodies: Bodies, step: float, near: float = _NEAR, far: float = _FAR, *, by_load: bool = False
) -> Nodes:
    """Return the nodes of a curve over d, or over φ."""
    end = bodies.end[0 if by_load else 1]
    bend = bodies.arc(2 * bodies.last.q)  # from there on the curve is straight
    straight = float(bend.phi if by_load else bend.phi * bend.L / np.pi)
    scale = max(1.0, end if np.isfinite(end) else straight)
    first = float(np.log1p(scale / end))
    count = np.ceil((near + np.log(scale) - first) / step)
    return Nodes(scale, first, step, first + float(count) * step, far)


def _arcs_at(bodies: Bodies, nodes: Nodes, *, by_load: bool) -> tuple[Arc, FloatArray]:
    """Return the arcs at nodes over d or φ with their slopes, and dln b²/ds."""
    x = nodes.x
    x[0] = min(x[0], bodies.end[0 if by_load else 1] * (1 - 1e-14))
    arc = bodies.with_slopes((bodies.arc_of_load if by_load else bodies.arc_of_penetration)(x))
    # S·K as the load or the penetration has it: next to the last arc the difference loses digits.
    arc = arc._replace(k=arc.S * (np.pi if by_load else arc.L) / x)
    rate = arc.phi_slope if by_load else arc.phi_slope + arc.L_slope / arc.L  # dln x/dln b²
    return arc, as_floats(-(1 + x / nodes.scale) / rate)


def _tables(
    bodies: Bodies, nodes: Nodes, error: float, *, by_load: bool = False
) -> tuple[Table, Table]:
    """Return L and U/(φ·d) over d or φ, with nodes so close that L is right to `error`."""
    for _ in range(_HALVINGS):
        arc, by_s = _arcs_at(bodies, nodes, by_load=by_load)
        L = Table.through(nodes, arc.L, arc.L_slope * by_s)
        middles = nodes.middles()
        exact = (bodies.arc_of_load if by_load else bodies.arc_of_penetration)(middles).L
        if np.abs(L.at(*nodes.place(middles)) / exact - 1).max() < error:
            break
        nodes = replace(nodes, step=nodes.step / 2)
    # By reciprocity K·dH = (H − 1)·dK − dL.
    H_1 = arc.S * bodies.hoop(arc)
    K_slope = (arc.k_slope - arc.c * arc.k) / arc.S
    slope = by_s * (arc.L_slope - H_1 * K_slope) / arc.L - H_1 * (1 / nodes.x + 1 / nodes.scale)
    return L, Table.through(nodes, bodies.work(arc), slope / 2)
