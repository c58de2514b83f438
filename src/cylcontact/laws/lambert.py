"""The lower branch of Lambert's W, without loss of digits near the branch point.

With x = −p/e and W₋₁(x) = −(1 + w) the defining equation W·exp(W) = x becomes

    w − ln(1 + w) = −ln p,    0 < p ≤ 1,  w ≥ 0,

in which p = 1 is the branch point, and w tends to zero there like √(2(1 − p)). Working in p and w
instead of x and W gives 1 + w to full precision at both ends. `scipy.special.lambertw` loses half
its digits within 1e-9 of the branch point, which is where Johnson's law ends. The error of w is a
few units in the last place of 1 + w, so the relative error of w grows next to the branch point, to
8e-12 at 1 − p = 1e-12.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cylcontact.arrays import FloatArray

__all__ = ["CHUNK", "START", "branch_distance", "to_load_fraction"]

# The start w = r(a + r(b + cr))/(1 + dr) with r = √(−ln p), in which w is smooth. Fitted over all
# positive doubles; the relative error is 5e-4, below 1.5e-4 for w < 5.
START = (1.41441, 1.0246, 0.25518, 0.25524)

# Used instead of what is not positive: the smallest double, which 1 + w makes zero.
_LEAST = 5e-324

# Elements per chunk, so that the work arrays stay in the cache of a core.
CHUNK = 1 << 14


def branch_distance(p: FloatArray) -> FloatArray:
    """Return w = −1 − W₋₁(−p/e), the distance of W₋₁ from the branch point.

    Parameters
    ----------
    p : array of float
        Between 0 and 1; NaN for elements outside.

    Returns
    -------
    array of float
        w ≥ 0: zero at p = 1, infinite at p = 0. The relative error of 1 + w is a few units
        in the last place; that of w alone grows as w goes to zero, to 8e-12 at 1 − p = 1e-12.

    Notes
    -----
    One fourth-order step of the inverse series (Householder's method) on w − ln(1 + w) + ln p, from
    a start in closed form, leaves an error below half a unit in the last place of 1 + w. There is
    no iteration and no convergence test.

    Examples
    --------
    >>> w = branch_distance(np.array([0.5]))
    >>> print(f"{w[0] - np.log1p(w[0]):.15f}")
    0.693147180559945
    """
    p = np.asarray(p, dtype=np.float64)
    w = np.empty(p.shape)
    flat, distances = p.ravel(), w.reshape(-1)
    for chunk, work in _chunks(p.size):
        _distance(flat[chunk], distances[chunk], work)
    np.copyto(w, np.inf, where=p == 0)
    return w[()]


def to_load_fraction(p: FloatArray) -> FloatArray:
    """Return q = p/(1 + w), the inverse of p = q(1 − ln q), written into `p` if possible.

    Parameters
    ----------
    p : array of float
        At most 1; NaN for elements beyond. A contiguous array is overwritten.

    Returns
    -------
    array of float
        Between 0 and 1, to a few units in the last place; 0 where p is negative.

    Examples
    --------
    >>> q = to_load_fraction(np.array([0.0, 0.5, 1.0]))
    >>> print((q * (1 - np.log(np.maximum(q, 1e-300)))).round(15))
    [0.  0.5 1. ]
    """
    q = np.asarray(p, dtype=np.float64, order="C")
    flat = q.reshape(-1)
    for chunk, work in _chunks(flat.size):
        u = work[-1]
        np.maximum(flat[chunk], _LEAST, out=flat[chunk])
        _distance(flat[chunk], u, work)
        u += 1
        flat[chunk] /= u
    return q[()]


def _chunks(size: int) -> Iterator[tuple[slice, FloatArray]]:
    """Yield the chunks of an array of this size, each with four work arrays."""
    work = np.empty((4, min(CHUNK, size)))
    for first in range(0, size, CHUNK):
        last = min(first + CHUNK, size)
        yield slice(first, last), work[:, : last - first]


def _distance(p: FloatArray, w: FloatArray, work: FloatArray) -> None:
    """Write w for p > 0 into `w`, including its end and the NaN outside."""
    with np.errstate(divide="ignore", invalid="ignore"):
        _interior(p, w, work)
    np.copyto(w, 0.0, where=p == 1)


def _interior(p: FloatArray, w: FloatArray, work: FloatArray) -> None:
    """Write w for 0 < p < 1 into `w`; NaN elsewhere.

    The operations are in place, because allocating intermediate arrays would cost more than the
    arithmetic. `cylcontact.laws.kernels` has the formula in readable form.
    """
    a, b, c, d = START
    g, r, u, _ = work
    np.negative(np.log(p, out=g), out=g)
    np.sqrt(g, out=r)
    # The start, as u = 1 + w.
    np.multiply(r, c, out=u)
    for coefficient in (b, a):
        u += coefficient
        u *= r
    r *= d
    r += 1
    u /= r
    u += 1
    # Round w so that u = 1 + w exactly; otherwise ln u would lose the digits of a small w.
    np.subtract(u, 1, out=w)
    # The scaled residual t = (w − ln u − g)/w².
    t = np.log(u, out=r)
    np.subtract(w, t, out=t)
    t -= g
    t /= np.multiply(w, w, out=g)
    # The correction, t·w·u·(1 + t(1/2 + t(1/2 + w/3))).
    np.divide(w, 3, out=g)
    for _ in range(2):
        g += 0.5
        g *= t
    g += 1
    g *= t
    g *= u
    g *= w
    w -= g
