"""The dimensionless solution for a pin in a hole of any two materials.

The hole is body i, the pin body j. Each takes the share w of the compliance (w_i + w_j = 1, see
`CylinderPair.shares`), and α = w_j − w_i and β are Dundurs' parameters. With φ = f/(E*·ΔR) and
d = δ/ΔR, pressure p in units of f/R, ψ = θ − s and Λ = −ln(2|sin(ψ/2)|), Michell's solution for
the disk and the infinite plate makes the condition of contact on |θ| < ε

    2∫p(s)·[cos ψ·Λ(ψ) + β|sin ψ|(π − |ψ|)/2 − w_j/2]ds + K − (K + L − C)·cos θ = 0,

with K = π/φ and L = π·d/φ. (The term of cos θ is a rigid displacement, known up to the datum C.)
The operator 1 + d²/dθ² removes cos θ and leaves the equation that `cylcontact.laws.glauert`
solves, with 2Â = K + w_i·H and H = ∫p dθ. Then

    K = 2Â − w_i·H,    L = M − w_j·H + C,

and 2Â, H and M depend on ε and β alone: **α enters linearly**.

**β = 0, any α.** With S = sin²(ε/2) the pressure is Persson's at the same ε and

    2Â = (1 − S)²/S,    H = 2S − (1 − S)²·ln(1 − S)/S,    M = −ln S + S²/2 + H.

**Reciprocity.** The kernel is symmetric, so a change of the arc does the same work on the pressure
and the change of the pressure on the displacement: dL = −(1 − H)·dK − K·dH. Hence
π·E*·dδ/df = d(φL)/dφ = L + K(1 − H) + K²·dH/dK, without a further function; and M follows from
2Â and H.

The searches use x = ln tan²(ε/2), in which no digits are lost at small arcs and few near 180°.
Written in k = S·K and h = (H − 1)/S, both of which stay finite, nothing cancels.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.laws.glauert import (
    X_TOP,
    Remainder,
    closed_forms,
    estimated_c,
    persson_peak,
    remainder,
)

__all__ = [
    "Arc",
    "Bodies",
    "approach",
    "arc_of_load",
    "arc_of_penetration",
    "compliance",
    "contact_angle",
    "largest_arc",
    "peak_number",
]

# Newton's method takes three to five steps; where it leaves its bracket the bracket is halved. A
# step of this size is the last, because it leaves its square.
_STEPS = 100
_LAST_STEP = 1e-8
# Used instead of zero and infinity for φ, and for d, which is larger than φ by L/π.
_TINY, _SMALL, _HUGE = float(np.finfo(np.float64).tiny), 1e-300, 1e300


@dataclass(frozen=True)
class Bodies:
    """Two bodies of one β.

    Parameters
    ----------
    w_i, w_j : float or array
        Shares of hole and pin in the compliance.
    beta : float
        Dundurs' β, as `CylinderPair.beta`.
    C : float or array
        The datum's constant.
    """

    w_i: FloatArray
    w_j: FloatArray
    beta: float
    C: FloatArray

    @property
    def remainder(self) -> Remainder | None:
        """What β adds to the closed forms."""
        return remainder(self.beta)


class Arc(NamedTuple):
    """A contact arc: x = ln b², S and c = 1 − S, h = (H − 1)/S, k = S·K; slopes are by x.

    `h_closed` is h for β = 0.
    """

    x: FloatArray
    S: FloatArray
    c: FloatArray
    h: FloatArray
    h_slope: FloatArray
    k: FloatArray
    k_slope: FloatArray
    h_closed: FloatArray


def arc_at(x: FloatArray, bodies: Bodies) -> Arc:
    """Return the arc with tan²(ε/2) = eˣ."""
    b2 = np.exp(x)
    S, c, a, h_closed, a_slope, h_slope = closed_forms(b2)
    h = h_closed
    if bodies.remainder is not None:
        angle_slope = np.sqrt(b2) * c
        added = bodies.remainder.additions(2 * np.arctan(np.sqrt(b2)))
        a, h = a + added[0], h + added[1]
        a_slope = a_slope + added[2] * angle_slope
        h_slope = h_slope + added[3] * angle_slope
    k = a - bodies.w_i * S * (1 + S * h)
    k_slope = a_slope - bodies.w_i * S * (c * (1 + 2 * S * h) + S * h_slope)
    return Arc(x, S, c, h, h_slope, as_floats(k), as_floats(k_slope), h_closed)


def approach(arc: Arc, bodies: Bodies) -> FloatArray:
    """Return L = π·E*·δ/f.

    Examples
    --------
    For equal materials and Johnson's datum it is Persson's:

    >>> from cylcontact.laws import persson
    >>> half = np.float64(0.5)
    >>> steel = Bodies(half, half, 0.0, np.float64(2 * np.log(2) - 1.5))
    >>> phi = np.array([1e-9, 1.0])
    >>> mine = approach(arc_of_load(phi, steel, largest_arc(steel)), steel)
    >>> print(mine / persson.approach(persson.arc_of_load(phi)))
    [1. 1.]
    """
    S, w_i = arc.S, bodies.w_i
    L = bodies.C - arc.x - np.log(arc.c) + S**2 / 2 + w_i * (1 + S * arc.h_closed)
    if bodies.remainder is not None:
        L = L + bodies.remainder.approach(contact_angle(arc))
        L = L - bodies.w_j * S * (arc.h - arc.h_closed)
    return as_floats(L)


def compliance(arc: Arc, bodies: Bodies) -> FloatArray:
    """Return π·E*·dδ/df by reciprocity."""
    k = arc.k
    rate = k * k * (arc.c * arc.h + arc.h_slope) / (arc.c * k - arc.k_slope)
    return as_floats(approach(arc, bodies) - k * arc.h - rate)


def contact_angle(arc: Arc) -> FloatArray:
    """Return the semi-angle ε in radians."""
    return as_floats(2 * np.arctan(np.exp(arc.x / 2)))


def peak_number(arc: Arc, bodies: Bodies) -> FloatArray:
    """Return R·p/f at θ = 0."""
    peak = persson_peak(np.exp(arc.x / 2))
    if bodies.remainder is not None:
        peak = peak * (1 + bodies.remainder.peak(contact_angle(arc)))
    return as_floats(peak)


def largest_arc(bodies: Bodies) -> Arc:
    """Return the arc that no load exceeds, where K = 0.

    Examples
    --------
    A rigid pin, equal bodies, and a hole of three times the pin's modulus:

    >>> w_i = np.array([1.0, 0.5, 0.25])
    >>> arc = largest_arc(Bodies(w_i, 1 - w_i, 0.0, 0 * w_i))
    >>> print(np.degrees(contact_angle(arc)).round(2))
    [72.35 84.83 96.64]
    """
    top = X_TOP if bodies.remainder is None else bodies.remainder.x_top
    share = np.maximum(bodies.w_i + bodies.beta, np.exp(-X_TOP))
    c = estimated_c(share)

    def miss(x: FloatArray) -> tuple[FloatArray, FloatArray]:
        arc = arc_at(x, bodies)
        return arc.k, arc.k_slope

    start = np.minimum(np.log((1 - c) / c), top)
    return arc_at(_root(miss, start, np.full_like(start, top)), bodies)


def arc_of_load(phi: FloatArray, bodies: Bodies, last: Arc) -> Arc:
    """Return the arc under the load φ = f/(E*·ΔR) ≥ 0, the root of K = π/φ before `last`."""
    target = np.pi / np.clip(phi, _TINY, _HUGE)

    def miss(x: FloatArray) -> tuple[FloatArray, FloatArray]:
        arc = arc_at(x, bodies)
        return arc.k - arc.S * target, arc.k_slope - arc.c * arc.k

    return arc_at(_root(miss, _start(target, last), last.x), bodies)


def arc_of_penetration(d: FloatArray, bodies: Bodies, last: Arc) -> Arc:
    """Return the arc at the penetration d = δ/ΔR ≥ 0, the root of d·K = L before `last`."""
    depth = np.clip(d, _SMALL, _HUGE)

    def miss(x: FloatArray) -> tuple[FloatArray, FloatArray]:
        arc = arc_at(x, bodies)
        L, part = approach(arc, bodies), arc.S / depth
        L_slope = arc.h * arc.k_slope - arc.k * (2 * arc.c * arc.h + arc.h_slope)
        return arc.k - part * L, arc.k_slope - arc.c * arc.k - part * L_slope

    least = approach(last, bodies)
    L = np.logaddexp(least, np.log(4) - np.log(depth))
    return arc_at(_root(miss, _start(L / depth, last), last.x), bodies)


def _start(K: FloatArray, last: Arc) -> FloatArray:
    """Return about the x where K has a value, as if K differed from its closed form by a constant.

    That is the constant which is right at the largest arc; (1 − S)²/S = 1/(b²(1 + b²)).
    """
    q = K + last.c**2 / last.S
    return as_floats(np.minimum(-np.log(q) - np.log((1 + np.sqrt(1 + 4 / q)) / 2), last.x))


def _root(
    miss: Callable[[FloatArray], tuple[FloatArray, FloatArray]], x: FloatArray, end: FloatArray
) -> FloatArray:
    """Return the root x ≤ `end` of a decreasing function, from its value and slope.

    Newton's method, with the middle of the bracket in place of a step that leaves it.
    """
    low, high = np.full_like(x, 2 * np.log(_TINY)), end
    for _ in range(_STEPS):
        value, slope = miss(x)
        low, high = np.where(value > 0, x, low), np.where(value > 0, high, x)
        with np.errstate(divide="ignore", invalid="ignore"):
            new = x - value / slope
        new = np.where((new >= low) & (new <= high), new, (low + high) / 2)
        if np.all(np.abs(new - x) <= _LAST_STEP * np.maximum(1, np.abs(x))):
            break
        x = new
    return as_floats(new)
