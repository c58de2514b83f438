"""Arcs of contact by elementary functions: those of `cylcontact.laws.conformal` with polynomials.

For β = 0 the functions 2Â, H and M of the arc have closed forms. For other β each gains β times a
polynomial in u = sin(ε/2) = √S:

    2Â = [(1 − S)² + βu(A0 + A1·u + A2·u² + A3·u³)]/S,
    H  = 2S − (1 − S)²·ln(1 − S)/S + H3·βu³,
    M  = −ln S + S²/2 + H(β = 0) + βu(M0 + M1·u + M2·u²).

A0 = −16/(3π) and M0 = 80/(9π) are the limits for small arcs, where the pressure is Hertz's. The
other six are calibrated (`fitting/parametric.toml`) and rounded to the digits that the accuracy
needs. Each function here is a part of a law's formula.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy import exp, log, log1p, maximum, sqrt

from cylcontact.laws.law import Constants, constant

_A0, _M0 = -16 / (3 * np.pi), 80 / (9 * np.pi)


@dataclass(frozen=True)
class ParametricCoefficients(Constants):
    """The constants of the polynomials of `Parametric`, of which A0 and M0 are exact.

    Raises
    ------
    InputError
        If one is not finite.
    """

    A0: float = constant(-3.0, 0.0, "coefficient of β·u in 2Â·S; exactly −16/(3π)", _A0, value=_A0)
    A1: float = constant(1.0, 2.0, "coefficient of β·u² in 2Â·S", 1.6238)
    A2: float = constant(-0.5, 1.5, "coefficient of β·u³ in 2Â·S", 0.3116)
    A3: float = constant(-3.0, -1.5, "coefficient of β·u⁴ in 2Â·S", -2.1986)
    H3: float = constant(-0.05, 0.05, "coefficient of β·u³ in H", 0.0053)
    M0: float = constant(0.0, 5.0, "coefficient of β·u in M; exactly 80/(9π)", _M0, value=_M0)
    M1: float = constant(-1.6, -0.8, "coefficient of β·u² in M", -1.1141)
    M2: float = constant(0.3, 1.2, "coefficient of β·u³ in M", 0.6367)
    law = "Parametric"


CALIBRATED = ParametricCoefficients()


def shares(alpha, beta):
    """Return w_i, w_j and about 1 − S of the largest arc, as `glauert.estimated_c`."""
    w_i, w_j = (1 - alpha) / 2, (1 + alpha) / 2
    root = sqrt(maximum(w_i + beta, 0))
    return w_i, w_j, sqrt(2) * root / (1 + 1.17 * root)


def arc(x, w_i, w_j, beta, datum, A0, A1, A2, A3, H3, M0, M1, M2):
    """Return S, c = 1 − S, k = S·K, L and H at tan²(ε/2) = eˣ, and the slopes of the last three."""
    b = exp(x)
    c = 1 / (1 + b)
    S = b * c
    fall = log1p(b)
    slow = c * fall
    u = sqrt(S)
    v = beta * u
    over, c2, S2 = slow / b, c * c, S * S
    closed = 2 * S + over
    rise = c * (2 * S + c - 2 * slow - over)
    extra = H3 * v * S
    H = closed + extra
    H_slope = rise + 1.5 * c * extra
    bent = v * c / 2
    k = c2 + v * (A0 + u * (A1 + u * (A2 + u * A3))) - w_i * S * H
    k_slope = bent * (A0 + u * (2 * A1 + u * (3 * A2 + u * 4 * A3))) - S * (
        2 * c2 + w_i * (c * H + H_slope)
    )
    L = fall - x + S2 / 2 + closed + v * (M0 + u * (M1 + u * M2)) - w_j * H + datum
    M_slope = c * (S2 - 1) + rise + bent * (M0 + u * (2 * M1 + u * 3 * M2))
    return S, c, k, k_slope, L, M_slope - w_j * H_slope, H, H_slope


def first_arc(q):
    """Return the x at which 1/(b²(1 + b²)) = q, with b² = eˣ."""
    return -log(q * (1 + sqrt(1 + 4 / q)) / 2)
