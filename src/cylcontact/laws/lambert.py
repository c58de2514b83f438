"""The lower branch of Lambert's W, without loss of digits near the branch point.

With x = −p/e and W₋₁(x) = −(1 + w) the defining equation W·exp(W) = x becomes

    w − ln(1 + w) = −ln p,    0 < p ≤ 1,  w ≥ 0,

in which p = 1 is the branch point, and w tends to zero there like √(2(1 − p)). Working in p and w
instead of x and W gives w to full precision at both ends. `scipy.special.lambertw` loses half its
digits within 1e-9 of the branch point, which is where Johnson's law ends.

In r = √(−ln p) w is smooth, and w = r·P(r)/Q(r) with polynomials of degrees 11 and 10 is right to
8.4e-17 for all positive doubles (r < 27.3), so rounding alone limits it. The coefficients are
those of least largest relative error, found by Lawson's weights at 60 digits. All are positive:
nothing cancels. There is no start, no iteration and no convergence test.

NumPy, compiled code and exported files do the same operations in the same order, so their results
are equal to the bit where their logarithms are: NumPy and a C library may differ in the last one.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import ClassVar

import numpy as np

from cylcontact.laws.formula import choose
from cylcontact.support.arrays import FloatArray, as_floats

P = (
    1.414213562373095, 3.8904306430259923, 4.78826695251163, 3.4780659317025466,
    1.6388741586256448, 0.5164984302415064, 0.10795303919334102, 0.014303870930872672,
    0.001098666106178429, 4.309366632714642e-05, 7.210703189743118e-07, 3.595691830680739e-09,
)  # fmt: skip
Q = (
    1.0, 2.279545368628578, 2.255672484577512, 1.2798640457098824, 0.4531640031796749,
    0.10167882278950177, 0.013991726736688212, 0.0010920245015971987, 4.3049306175669955e-05,
    7.210512620702072e-07, 3.5957121162097092e-09,
)  # fmt: skip
P0, P1, P2, P3, P4, P5, P6, P7, P8, P9, P10, P11 = P
Q0, Q1, Q2, Q3, Q4, Q5, Q6, Q7, Q8, Q9, Q10 = Q

# Compiled code takes a quarter of NumPy's time. After this many values, importing numba has paid.
_PAYS_AFTER = 10_000_000
_MANY = 1000  # values in a call from which compiled code is faster


def numerator(r):
    """Return r·P(r), from its even and its odd powers, which a processor computes side by side."""
    s = r * r
    odd = P1 + s * (P3 + s * (P5 + s * (P7 + s * (P9 + s * P11))))
    return r * (P0 + s * (P2 + s * (P4 + s * (P6 + s * (P8 + s * P10)))) + r * odd)


def denominator(r):
    """Return Q(r), likewise."""
    s = r * r
    odd = Q1 + s * (Q3 + s * (Q5 + s * (Q7 + s * Q9)))
    return Q0 + s * (Q2 + s * (Q4 + s * (Q6 + s * (Q8 + s * Q10)))) + r * odd


def share_at(p, r):
    """Return p/(1 + w) at r = √(−ln p)."""
    under = denominator(r)
    return p * under / (under + numerator(r))


def branch_distance_of_number(p):
    """Return `branch_distance` as other languages compute it."""
    r = np.sqrt(0 - np.log(choose((p > 0) & (p <= 1), p, 1)))  # not −0 for p = 1
    w = numerator(r) / denominator(r)
    return choose(p <= 1, choose(p > 0, w, np.inf), np.nan)


def branch_share_of_number(p):
    """Return `branch_share` as other languages compute it."""
    r = np.sqrt(0 - np.log(choose((p > 0) & (p <= 1), p, 1)))  # not −0 for p = 1
    return choose(p <= 1, choose(p > 0, share_at(p, r), 0), np.nan)


def branch_distance(p: FloatArray) -> FloatArray:
    """Return w = −1 − W₋₁(−p/e) ≥ 0 for p from 0 to 1; NaN outside."""
    if np.ndim(p) == 0:
        return as_floats(branch_distance_of_number(float(p)))
    with np.errstate(all="ignore"):
        w, under = _both(np.log(p))
        w /= under
    np.copyto(w, np.inf, where=p == 0)
    return w


def branch_share(p: FloatArray) -> FloatArray:
    """Return p/(1 + w), with one division less than from w."""
    if np.ndim(p) == 0:
        return as_floats(branch_share_of_number(float(p)))
    _Values.so_far += p.size
    with np.errstate(all="ignore"):
        log_p = np.log(p)
        if _Values.so_far > _PAYS_AFTER and p.size >= _MANY:
            share = np.empty(p.shape)
            compiled_shares()(p.ravel(), log_p.ravel(), share.ravel())
        else:
            over, share = _both(log_p)
            over += share
            share *= p
            share /= over
    np.copyto(share, 0.0, where=p == 0)
    return share


class _Values:
    """How many values `branch_share` has had so far."""

    so_far: ClassVar[int] = 0


@cache
def compiled_shares() -> Callable[[FloatArray, FloatArray, FloatArray], None]:
    """Return `_shares` compiled, and let compiled code call the functions that it calls."""
    from cylcontact.support.numba_cache import compiled, inlined

    for function in (numerator, denominator, share_at):
        inlined(function)
    return compiled(_shares)


def _shares(p: FloatArray, log_p: FloatArray, out: FloatArray) -> None:
    """Put p/(1 + w) of numbers, whose logarithms are given, into `out`."""
    for at in range(p.size):
        out[at] = share_at(p[at], np.sqrt(-log_p[at]))


def _both(log_p: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return `numerator` and `denominator` at √(−ln p), with few arrays in between."""
    r = np.sqrt(np.subtract(0, log_p, out=log_p), out=log_p)
    s = r * r
    over, under = (_polynomial(s, odd) for odd in (P[1::2], Q[1::2]))
    over *= r
    over += _polynomial(s, P[::2])
    over *= r
    under *= r
    under += _polynomial(s, Q[::2])
    return over, under


def _polynomial(s: FloatArray, coefficients: tuple[float, ...]) -> FloatArray:
    """Return a polynomial of s by Horner's scheme."""
    result = s * coefficients[-1]
    for coefficient in coefficients[-2:0:-1]:
        result += coefficient
        result *= s
    result += coefficients[0]
    return result


# What exported files take in the place of functions of arrays.
OF_NUMBERS = {branch_distance: branch_distance_of_number, branch_share: branch_share_of_number}
