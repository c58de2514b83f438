"""Persson's solution for a pin in a hole, in dimensionless form and with a closed penetration.

A pin (disk) is pressed without friction into a hole of nearly its own radius R in an infinite
plate of the same material. The contact reaches from −ε to ε. With u = tan²(ε/2), φ = f/(E*·ΔR)
and N = 2 − 2u² − ln(1 + u), Persson (On the stress distribution of cylindrical elastic bodies in
contact, Chalmers, 1964; reviewed by Ciavarella and Decuzzi, Int. J. Solids Struct. 38 (2001)
4507–4523) found

    φ = 2π·u(1 + u)/N,
    R·p(θ)/f = 2s/(πB(1 + y²)) + ln((B + s)/(B − s))/(2π·u(1 + u)),

with y = tan(θ/2), B = √(1 + u) and s = √(u − y²). N vanishes at u = U = 0.8346: however large the
load, ε stays below 84.83°. (The literature's E' is 2E* here.)

**The gap.** Under p = Σ pₙcos nθ the radial displacements of hole and pin (Michell) differ by

    w = (R/E*)·[p₀ + Σ pₙ(1/(n − 1) + 1/(n + 1))·cos nθ],    n ≥ 2,

for equal materials whatever their Poisson's ratio. Summed up, and with p₁ = f/(πR),

    w(θ) = R/(πE*)·∫ p(θ')·[−2cos α·ln|2sin(α/2)| − 1/2]dθ' + C·f/(πE*)·cos θ,    α = θ − θ'.

The term n = 1 carries the load and moves the surface as a rigid displacement would, so C depends
on how the pin is loaded and how far away the plate is held: a two-dimensional body has no
absolute approach. In contact w = δcos θ − ΔR(1 − cos θ), hence δ = w(0).

**The penetration.** Differentiate that condition by u: the change of the pressure causes the gap
δ'cos θ. As the influence function is symmetric, ∫p'w = ∫p·w' over the arc, that is
(δ + ΔR)·f' − ΔR·∫p'R dθ = δ'·f. With ∫pR dθ = 2π·E*ΔR·(2/N − 1) it becomes

    π·d[(1 + δ/ΔR)/φ]/du = −(4u + 1/(1 + u))/(u²(1 + u)²),

which has an elementary integral. **The choice made here** is the constant with which δ goes to
Johnson's law as φ → 0 (C = 2ln 2 − 3/2). Then, without any quadrature,

    δ = f·Z/(πE*),  Z = ln(4(1 + u)/u) − 2/(1 + u) + 1/(2(1 + u)²) + ln(1 + u)/(2u(1 + u)),
    dδ/df = S/(πE*),
    S = ln(4(1 + u)/u) − 2/(1 + u) + 1/(2(1 + u)²)
        + [(1 + u + u²)·ln(1 + u) − (1 − u)²(1 + u)]/((1 + u)²(2 + u − ln(1 + u))).

Everything is written in the spread t = u/(U − u), which is proportional to φ for small and for
large loads; so no digit is lost at either end.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cylcontact.arrays import FloatArray, as_floats

# The root of 2 − 2u² − ln(1 + u) between 0 and 1, and the contact semi-angle there, 84.83°.
U = 0.8346152454776572
LIMIT_ANGLE = 2 * np.arctan(np.sqrt(U))

# Where ln u and ratios of vanishing numbers are cut off, and what stands for an infinite spread.
TINY = np.finfo(np.float64).tiny
HUGE = 1e300


class Arc(NamedTuple):
    """A contact arc: the spread t, u = tan²(ε/2), ln(1 + u), and n = N/(U − u)."""

    t: FloatArray
    u: FloatArray
    log: FloatArray
    n: FloatArray


def arc_of_spread(t: FloatArray) -> Arc:
    """Return the arc with spread t = u/(U − u) ≥ 0."""
    left = U / (1 + t)
    u = t * left
    # ln((1 + U)/(1 + u)) over U − u, which is wanted although both may vanish.
    ratio = np.maximum(left / (1 + u), TINY)
    n = 2 * (U + u) + np.log1p(ratio) / (ratio * (1 + u))
    return Arc(t, u, np.log1p(u), n)


def load_number(arc: Arc) -> FloatArray:
    """Return φ = f/(E*·ΔR) of an arc.

    Examples
    --------
    >>> u = np.tan(np.radians(60.0) / 2) ** 2
    >>> print(load_number(arc_of_spread(u / (U - u))))
    """
    return as_floats(arc.t / _spread_per_load(arc))


def approach(arc: Arc) -> FloatArray:
    """Return Z = π·E*·δ/f of an arc."""
    u, log, _ = arc.u, arc.log, arc.n
    return as_floats(_common(arc) + log / (2 * np.maximum(u, TINY) * (1 + u)))


def compliance(arc: Arc) -> FloatArray:
    """Return S = π·E*·dδ/df of an arc."""
    u, v = arc.u, 1 + arc.u
    top = (1 + u * v) * arc.log - (1 - u) ** 2 * v
    return as_floats(_common(arc) + top / (v**2 * (1 + v - arc.log)))
