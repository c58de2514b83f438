"""Dissipation in an impact.

**Hysteresis factors.** The models of Eqs 2, 3 and 5 all dissipate in the same way: they multiply an
elastic law by a term in the penetration rate δ̇, made dimensionless by the rate δ̇⁽⁻⁾ at first touch,

    F = F_el(δ)·(1 + χ·δ̇/δ̇⁽⁻⁾),

and differ in the hysteresis factor χ that they assign to a coefficient of restitution e.

**What e a factor gives** (derived). Let two bodies of effective mass m meet with no other force
and write u = δ̇/δ̇⁽⁻⁾. Newton's law m·dδ̇/dt = −F becomes, with d/dt = δ̇·d/dδ,

    m·(δ̇⁽⁻⁾)²·u/(1 + χu)·du = −F_el(δ)·dδ.

From first touch (δ = 0, u = 1) to separation (δ = 0, u = −e) the right-hand side integrates to
zero for any F_el, because the elastic law returns all the work it stores. So the integral of
u/(1 + χu) from −e to 1 vanishes, and

    χ(1 + e) = ln[(1 + χ)/(1 − χe)],    e = [1 + W₀(−(1 + χ)·exp(−(1 + χ)))]/χ

for every elastic law and exponent, mass and speed. As 1 − χe = −W₀ > 0, the load of such an
impact is never negative before the bodies separate.

**How it is evaluated.** In p = χ(1 + e)/2 the relation splits into two explicit halves,

    (1 − e)/(1 + e) = L(p),    χ = p·(1 + L(p)),    L(p) = coth p − 1/p,

with Langevin's function L, which can be computed to full precision everywhere. The form with
W₀ loses half the digits as χ → 0, where its argument rounds to the branch point −1/e.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.support.arrays import (
    FloatArray,
    as_floats,
    require,
    require_not_negative,
    require_positive,
)
from cylcontact.support.errors import InputError

HysteresisFactor = Callable[[ArrayLike], FloatArray]

# Assumed: the slowest impact rate in mm/s at which the factor applies in full. The impacts of a
# mechanism are two to four orders of magnitude faster.
IMPACT_RATE_FLOOR = 1.0
# Assumed: |δ̇|/δ̇⁽⁻⁾ up to which the damping is that of the models; twice that is its bound.
RATIO_BEND = 10.0

_OF_RESTITUTION = "take it from a wanted restitution, e.g. exact_factor(0.9)"
# Newton's method reaches machine precision after four steps in the worst case.
_NEWTON_STEPS = 5


def dissipative_load(
    elastic_load: ArrayLike,
    penetration_rate: ArrayLike,
    impact_rate: ArrayLike,
    chi: ArrayLike,
    floor: float = IMPACT_RATE_FLOOR,
) -> FloatArray:
    """Return F = F_el·(1 + χ·s(δ̇/δ̇⁽⁻⁾)), never negative (Eqs 2, 3 and 5 with bounded damping).

    Parameters
    ----------
    elastic_load : array_like
        F_el ≥ 0 from a contact law, in N or N/mm.
    penetration_rate : array_like
        δ̇ in mm/s, positive while the bodies approach.
    impact_rate : array_like
        δ̇⁽⁻⁾, the penetration rate at first touch, in mm/s.
    chi : array_like
        Hysteresis factor χ ≥ 0.
    floor : float, optional
        Lower bound in mm/s of the δ̇⁽⁻⁾ that divides. A slower impact has the factor χ·δ̇⁽⁻⁾/floor
        instead of χ: e → 1 as it gets slower, as for real bodies.

    Returns
    -------
    array of float
        In the unit of `elastic_load`, of the broadcast shape; NaN where an input is NaN. It is
        clipped at zero, because contact does not pull: never in an isolated impact, only where
        other forces pull the bodies apart.

    Raises
    ------
    InputError
        If χ is negative or not finite, or the floor is not positive and finite.

    Examples
    --------
    >>> print(dissipative_load(100.0, [50.0, 0.0, -50.0, -500.0], 50.0, chi=0.25))
    [125. 100.  75.   0.]
    """
    factor = require_not_negative(chi, "hysteresis factor", "chi", _OF_RESTITUTION)
    remedy = "give the slowest impact rate that counts, in mm/s"
    require_positive(floor, "dissipative_load", "floor", remedy)
    ratio = as_floats(penetration_rate) / np.maximum(as_floats(impact_rate), floor)
    damping = factor * bounded_ratio(ratio)
    return as_floats(np.maximum(as_floats(elastic_load) * (1 + damping), 0.0))


def bounded_ratio(ratio: ArrayLike) -> FloatArray:
    """Return s(u), the velocity ratio u = δ̇/δ̇⁽⁻⁾ bounded by ±2U, with U = 10.

    s(u) = u for |u| ≤ U, and sgn(u)·U·(1 + v/√(1 + v²)) with v = |u|/U − 1 beyond, which is twice
    continuously differentiable.

    The bound is ours, not the paper's: without it the damping of a contact that starts slowly and
    is then pressed together could be any multiple of the elastic load. Isolated impacts, in which
    |u| ≤ 1, stay as they are. U is assumed; in the slider-crank of Sect. 4 a joint in permanent
    contact reaches |u| = 6.

    Examples
    --------
    >>> print(bounded_ratio([-0.5, 10.0, 20.0, 1e6]).round(6))
    [-0.5      10.       17.071068 20.      ]
    """
    u = as_floats(ratio)
    beyond = np.maximum(np.abs(u) / RATIO_BEND - 1, 0.0)
    # v/√(1 + v²) without overflow.
    bent = np.copysign(RATIO_BEND * (1 + beyond / np.hypot(1.0, beyond)), u)
    return as_floats(np.where(np.abs(u) <= RATIO_BEND, u, bent))


def achieved_restitution(chi: ArrayLike) -> FloatArray:
    """Return the coefficient of restitution that a hysteresis factor χ ≥ 0 gives.

    e = [1 + W₀(−(1 + χ)·exp(−(1 + χ)))]/χ, from 1 at χ = 0 towards 1/χ as χ → ∞, with a relative
    error of a few units in the last place. Raises `InputError` if χ is negative or not finite.

    Examples
    --------
    >>> chi = lankarani_nikravesh(0.9)
    >>> print(f"wanted 0.9, achieved {achieved_restitution(chi):.4f}")
    wanted 0.9, achieved 0.9132
    """
    factor = require_not_negative(chi, "hysteresis factor", "chi", _OF_RESTITUTION)
    # Newton's method for p(1 + L(p)) = χ: convex and growing, and this start is above the root.
    p = np.minimum(factor, (1 + factor) / 2)
    for _ in range(_NEWTON_STEPS):
        L, complement, _ = _langevin(p)
        reached = p * (1 + L)
        p = p - (reached - factor) / (complement * (1 + reached))
    L, complement, _ = _langevin(p)
    return as_floats(complement / (1 + L))


def exact_factor(restitution: ArrayLike) -> FloatArray:
    """Return the hysteresis factor that gives exactly the restitution e, 0 < e ≤ 1.

    It is the root χ of χ(1 + e) = ln[(1 + χ)/(1 − χe)], with a relative error of a few units in the
    last place. Close to e = 1 it is (3/2)(1 − e) + (3/2)(1 − e)² + …, and Hu and Guo's factor has
    both terms; for small e it is 1/e, like Gonthier's. Raises `InputError` if e is outside (0, 1].

    Notes
    -----
    χ = 2p/(1 + e) with p = L⁻¹((1 − e)/(1 + e)). The inverse of Langevin's function has no
    closed form. Kröger (J. Non-Newtonian Fluid Mech. 223 (2015) 77–87) approximates it to 0.3 %;
    Newton's method on L/(1 − L), which is nearly straight, refines that.

    Examples
    --------
    >>> chi = exact_factor(0.9)
    >>> print(f"{chi:.4f} gives {achieved_restitution(chi):.15f}")
    0.1665 gives 0.900000000000000
    """
    e = _restitution(restitution)
    r, target = (1 - e) / (1 + e), (1 - e) / (2 * e)
    p = r * (3 - (6 * r**2 + r**4 - 2 * r**6) / 5) * (1 + e) / (2 * e * (1 + r))
    for _ in range(_NEWTON_STEPS):
        L, complement, slope = _langevin(p)
        p = p - (L / complement - target) / slope
    return as_floats(2 * p / (1 + e))


def _published(factor: Callable[[FloatArray], FloatArray]) -> HysteresisFactor:
    """Return a factor of the literature, for restitutions that are checked."""
    return lambda restitution: as_floats(factor(_restitution(restitution)))


# Keyed by the names that specs and reports use, in order of publication, the exact one last.
FACTORS: dict[str, HysteresisFactor] = {
    # J. Appl. Mech. 42 (1975) 440–445
    "hunt-crossley": _published(lambda e: 3 * (1 - e) / 2),
    # J. Eng. Ind. 99 (1977) 513–518
    "herbert-mcwhannell": _published(lambda e: 6 * (1 - e) / ((2 * e - 1) ** 2 + 3)),
    # J. Mech. Transm. Autom. Des. 105 (1983) 534–540
    "lee-wang": _published(lambda e: 3 * (1 - e) / 4),
    # J. Mech. Des. 112 (1990) 369; the paper's
    "lankarani-nikravesh": _published(lambda e: 3 * (1 - e) * (1 + e) / 4),
    # Multibody Syst. Dyn. 11 (2004) 209–233
    "gonthier": _published(lambda e: (1 - e) * (1 + e) / e),
    # J. Dyn. Control 4 (2006) 294–298
    "zhiying-qishao": _published(lambda e: 3 * (1 - e) * (1 + e) / 4 * np.exp(2 * (1 - e))),
    # Multibody Syst. Dyn. 25 (2011) 357–375
    "flores": _published(lambda e: 8 * (1 - e) / (5 * e)),
    # Multibody Syst. Dyn. 35 (2015) 131–151
    "hu-guo": _published(lambda e: 3 * (1 - e) / (2 * e)),
    "exact": exact_factor,
}
lankarani_nikravesh = FACTORS["lankarani-nikravesh"]


def hysteresis_factor(name: str) -> HysteresisFactor:
    """Return the factor χ(e), 0 < e ≤ 1, that specs call `name`; raise `InputError` for others.

    Examples
    --------
    >>> print(hysteresis_factor("lankarani-nikravesh")([0.5, 0.9]).round(4))
    [0.5625 0.1425]
    """
    if name not in FACTORS:
        remedy = f"choose {', '.join(FACTORS)}"
        raise InputError("hysteresis factor", "name", name, "is not known", remedy)
    return FACTORS[name]


def _restitution(value: ArrayLike) -> FloatArray:
    """Return e as float64; raise `InputError` outside (0, 1]."""
    e, rule = as_floats(value), "must lie in (0, 1]"
    remedy = "give 1 for an elastic impact, less for one that dissipates"
    require((e > 0) & (e <= 1), "hysteresis factor", "restitution", value, rule, remedy)
    return e


def _langevin(p: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return L = coth p − 1/p for p ≥ 0, 1 − L, and the slope of L/(1 − L).

    Up to p = 2 this is Lambert's continued fraction L = p/(3 + p²/(5 + p²/(7 + …))), which has no
    cancellation; ten levels reach machine precision. Beyond, coth p = 1 + E with
    E = 2/(exp 2p − 1).
    """
    small = p < 2
    q = np.where(small, p, 0.0)
    fraction = np.zeros_like(q)
    for odd in range(21, 3, -2):
        fraction = q**2 / (odd + fraction)
    ratio = 1 / (3 + fraction)
    L = q * ratio
    slope = (1 - L**2 - 2 * ratio) / (1 - L) ** 2

    q = np.where(small, 2.0, p)
    E = -2 * np.exp(-2 * q) / np.expm1(-2 * q)
    complement = np.where(small, 1 - L, 1 / q - E)
    # L' = 1/p² − E(2 + E), numerator and denominator times p², so that no power of p overflows.
    slope = np.where(small, slope, (1 - q * E * (2 * q + q * E)) / (1 - q * E) ** 2)
    return np.where(small, L, 1 - complement), complement, slope
