"""Persson's solution for a pin in a hole, dimensionless, with a closed-form penetration.

A pin (disk) is pressed without friction into a hole of nearly its own radius R in an infinite
plate of the same material, and touches it from −ε to ε. With φ = f/(E*·ΔR), u = tan²(ε/2) and
N = 2 − 2u² − ln(1 + u), Persson (On the Stress Distribution of Cylindrical Elastic Bodies in
Contact, Chalmers 1964; see Ciavarella and Decuzzi, Int. J. Solids Struct. 38 (2001) 4507–4523)
found the load and the pressure,

    φ = 2π·u(1 + u)/N,
    R·p(θ)/f = 2s/(πB(1 + y²)) + ln((B + s)/(B − s))/(2π·u(1 + u)),

where y = tan(θ/2), B = √(1 + u) and s = √(u − y²). N vanishes at u = U = 0.8346, so ε stays below
84.83° at any load. (The E' of the literature is 2E* here.)

**The gap.** By Michell's solution a pressure Σ pₙcos nθ changes the gap between hole and disk by

    w = (R/E*)·[p₀ + Σ (1/(n − 1) + 1/(n + 1))·pₙcos nθ],    n ≥ 2,

if both have the same E and ν; ν itself drops out. Summed, and with p₁ = f/(πR), this is

    w(θ) = R/(πE*)·∫ p(θ')·[−2cos α·ln|2sin(α/2)| − 1/2]dθ' + C·f/(πE*)·cos θ,    α = θ − θ'.

The term n = 1 carries the load and displaces the surface like a rigid motion, so C depends on how
the pin is loaded and how far away the plate is held. **Two-dimensional bodies have no absolute
approach**, and C is a choice. In contact w = δcos θ − ΔR(1 − cos θ), so δ = w(0).

**The penetration.** Differentiate the contact condition by u: the change of the pressure opens
the gap δ'cos θ. The influence function is symmetric, so ∫p'w dθ = ∫p·w'dθ on the arc, that is
(δ + ΔR)·f' − ΔR·∫p'R dθ = δ'·f. As ∫p R dθ = 2π·E*ΔR·(2/N − 1), this becomes

    π·d[(1 + δ/ΔR)/φ]/du = −(4u + 1/(1 + u))/(u²(1 + u)²)

and has an elementary integral. **The choice made here** is that δ tends to Johnson's law as φ → 0,
which gives C = 2ln 2 − 3/2. Then, without any quadrature, δ = f·Z/(πE*) and dδ/df = S/(πE*), where

    Z = G + ln(1 + u)/(2u(1 + u)),
    S = G + [(1 + u + u²)·ln(1 + u) − (1 − u)²(1 + u)]/((1 + u)²(2 + u − ln(1 + u))),
    G = ln(4(1 + u)/u) − 2/(1 + u) + 1/(2(1 + u)²).

The functions use the spread t = u/(U − u), which is proportional to the load both for small and for
large loads, so that no digits are lost at either end.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cylcontact.arrays import FloatArray, as_floats

__all__ = [
    "LIMIT_ANGLE",
    "Arc",
    "U",
    "approach",
    "arc_of_angle",
    "arc_of_load",
    "arc_of_penetration",
    "arc_of_spread",
    "compliance",
    "contact_angle",
    "load_number",
    "pressure_number",
]

# The root of 2 − 2u² − ln(1 + u), and the contact semi-angle there, 84.83°.
U = 0.8346152454776572
LIMIT_ANGLE = 2 * float(np.arctan(np.sqrt(U)))

# The ratio t/φ = n/(2π(1 + u)) in the limits of small and of complete contact, u = 0 and U.
_T_PER_PHI_SMALL = 1 / (np.pi * U)
_T_PER_PHI_LARGE = (4 * U + 1 / (1 + U)) / (2 * np.pi * (1 + U))

# Used instead of zero and infinity where a logarithm or a ratio must stay finite.
_TINY = float(np.finfo(np.float64).tiny)
_SMALL, _HUGE = 1e-300, 1e300


class Arc(NamedTuple):
    """A contact arc: its spread t, u = tan²(ε/2), ln(1 + u) and n = N/(U − u)."""

    t: FloatArray
    u: FloatArray
    log: FloatArray
    n: FloatArray


def arc_of_spread(t: FloatArray) -> Arc:
    """Return the arc of spread t = u/(U − u), with t ≥ 0 finite."""
    left = U / (1 + t)
    u = t * left
    # N/(U − u) with N = N(u) − N(U), written without the difference, which would lose digits.
    ratio = np.maximum(left / (1 + u), _TINY)
    n = 2 * (U + u) + np.log1p(ratio) / (ratio * (1 + u))
    return Arc(t, u, np.log1p(u), n)


def arc_of_angle(angle: FloatArray) -> Arc:
    """Return the arc from −`angle` to `angle`, in radians and below the limit angle."""
    u = np.tan(angle / 2) ** 2
    return arc_of_spread(u / np.maximum(U - u, _TINY))


def arc_of_load(phi: FloatArray) -> Arc:
    """Return the arc under the load φ = f/(E*·ΔR) ≥ 0.

    Notes
    -----
    The start interpolates t/φ between its two limits with a relative error of 4e-4. Two Newton
    steps reach machine precision for every φ, without a convergence test.

    Examples
    --------
    >>> arc = arc_of_load(np.array([0.1, 10.0, 1e9]))
    >>> print(np.degrees(contact_angle(arc)).round(4))
    [19.7811 77.5704 84.8279]
    """
    phi = np.minimum(phi, _HUGE)
    t = phi * (_T_PER_PHI_LARGE + (_T_PER_PHI_SMALL - _T_PER_PHI_LARGE) / (1 + 0.796 * phi))
    for _ in range(2):
        arc = arc_of_spread(t)
        t = t + (phi * _t_per_phi(arc) - t) / _load_exponent(arc)
    return arc_of_spread(t)


def arc_of_penetration(d: FloatArray) -> Arc:
    """Return the arc at the penetration d = δ/ΔR ≥ 0.

    Notes
    -----
    The start is an explicit law of the form t = a·d/(b + ln(1 + (c/d)·(ln(1 + g/d) + h))), fitted
    with a relative error of 3e-3 for d ≥ 1e-12, and 1e-2 below. Two Newton steps on logarithmic
    scales reach a few units in the last place for every d.

    Examples
    --------
    >>> d = np.array([1e-3, 1.0, 1e3])
    >>> arc = arc_of_penetration(d)
    >>> print((load_number(arc) * approach(arc) / (np.pi * d)).round(13))
    [1. 1. 1.]
    """
    d = np.clip(d, _SMALL, _HUGE)
    t = 1.2102 * d / (1.6387 + np.log1p(0.4045 / d * (np.log1p(0.9256 / d) + 0.7692)))
    for _ in range(2):
        arc = arc_of_spread(t)
        Z = approach(arc)
        exponent = _load_exponent(arc) * compliance(arc) / Z  # dln d/dln t
        t = t * (np.pi * d * _t_per_phi(arc) / (Z * t)) ** (1 / exponent)
    return arc_of_spread(t)


def load_number(arc: Arc) -> FloatArray:
    """Return φ = f/(E*·ΔR)."""
    return as_floats(arc.t / _t_per_phi(arc))


def contact_angle(arc: Arc) -> FloatArray:
    """Return ε in radians."""
    return as_floats(2 * np.arctan(np.sqrt(arc.u)))


def approach(arc: Arc) -> FloatArray:
    """Return Z = π·E*·δ/f."""
    u = np.maximum(arc.u, _TINY)
    return as_floats(_common(arc) + arc.log / (2 * u * (1 + u)))


def compliance(arc: Arc) -> FloatArray:
    """Return S = π·E*·dδ/df."""
    u, v = arc.u, 1 + arc.u
    top = (1 + u * v) * arc.log - (1 - u) ** 2 * v
    return as_floats(_common(arc) + top / (v**2 * (1 + v - arc.log)))


def pressure_number(y: FloatArray, arc: Arc) -> FloatArray:
    """Return R·p/f at y = tan(θ/2); zero outside the arc.

    Notes
    -----
    ln((B + s)/(B − s)) is computed as 2·artanh(s/B), which is accurate near the edge.

    Examples
    --------
    >>> u = np.array(1e-10)
    >>> peak = pressure_number(np.array(0.0), arc_of_spread(u / (U - u)))
    >>> print(f"{peak * np.pi * np.sqrt(u):.9f}")  # Hertz: 2f/(π·R·ε), with ε = 2√u
    1.000000000
    """
    b, B = np.sqrt(arc.u), np.sqrt(1 + arc.u)
    s = np.sqrt(np.maximum((b - y) * (b + y), 0.0))
    u = np.maximum(arc.u, _TINY)
    even = 2 * s / (np.pi * B * (1 + y**2))
    return as_floats(even + np.arctanh(s / B) / (np.pi * u * (1 + u)))


def _common(arc: Arc) -> FloatArray:
    """Return G, the common part of Z and S."""
    v = 1 + arc.u
    return as_floats(np.log(4) + arc.log - np.log(np.maximum(arc.u, _TINY)) - (2 - 0.5 / v) / v)


def _t_per_phi(arc: Arc) -> FloatArray:
    """Return t/φ = n/(2π(1 + u))."""
    return as_floats(arc.n / (2 * np.pi * (1 + arc.u)))


def _load_exponent(arc: Arc) -> FloatArray:
    """Return dln φ/dln t."""
    u = arc.u
    return as_floats((1 + 2 * u) * (2 + u - arc.log) / ((1 + u) * U * arc.n))
