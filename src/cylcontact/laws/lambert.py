"""The lower branch of Lambert's W, without loss of digits near the branch point.

With x = −p/e and W₋₁(x) = −(1 + w) the defining equation W·exp(W) = x becomes

    w − ln(1 + w) = −ln p,    0 < p ≤ 1,  w ≥ 0,

in which p = 1 is the branch point, and w tends to zero there like √(2(1 − p)). Working in p and w
instead of x and W gives 1 + w to full precision at both ends. `scipy.special.lambertw` loses half
its digits within 1e-9 of the branch point, which is where Johnson's law ends. The error of w is a
few units in the last place of 1 + w, so the relative error of w grows next to the branch point, to
1e-10 at 1 − p = 1e-12.

One step of fourth order from a start in closed form leaves an error below half a unit in the last
place of 1 + w. There is no iteration and no convergence test. `inner_distance` has it in
readable form, as other languages and compiled code compute it; arrays take the same start in
single precision and Fritsch's step, in as few passes as possible.
"""

from __future__ import annotations

import numpy as np

from cylcontact.laws.formula import choose
from cylcontact.support.arrays import FloatArray

# The start w = r(A + r(B + Cr))/(1 + Dr) with r = √(−ln p), in which w is smooth. Fitted over all
# positive doubles; the relative error is 5e-4, below 1.5e-4 for w < 5.
A, B, C, D = 1.41441, 1.0246, 0.25518, 0.25524


def inner_distance(p):
    """Return w for 0 < p < 1, by the inverse series (Householder) of its equation."""
    g = -np.log(p)
    r = np.sqrt(g)
    u = 1 + r * (A + r * (B + C * r)) / (1 + D * r)
    start = u - 1
    t = (start - np.log(u) - g) / (start * start)
    return start - t * start * u * (1 + t * (0.5 + t * (0.5 + start / 3)))


def branch_distance_of_number(p):
    """Return `branch_distance` as other languages compute it."""
    # At the branch point the regular formula would divide by zero; there it computes p = 0.5.
    w = inner_distance(choose((p > 0) & (p < 1), p, 0.5))
    return choose(p <= 1, choose(p > 0, choose(p < 1, w, 0), np.inf), np.nan)


def branch_distance(p: FloatArray) -> FloatArray:
    """Return w = −1 − W₋₁(−p/e) ≥ 0 for p from 0 to 1; NaN outside."""
    p, shape = np.ascontiguousarray(p, dtype=np.float64), np.shape(p)
    with np.errstate(all="ignore"):
        u, size, change = _step(p)
        change *= u
        change /= size
        u -= 1
        u -= change
    np.copyto(u, 0.0, where=p == 1)
    np.copyto(u, np.inf, where=p == 0)
    return u.reshape(shape)[()]


def branch_share(p: FloatArray) -> FloatArray:
    """Return p/(1 + w), with one division less than from w."""
    p, shape = np.ascontiguousarray(p, dtype=np.float64), np.shape(p)
    with np.errstate(all="ignore"):
        u, size, change = _step(p)
        np.subtract(size, change, out=change)
        change *= u
        size *= p
        size /= change
    if not p.max(initial=0.5) < 1:
        np.copyto(size, 1.0, where=p == 1)
    return size.reshape(shape)[()]


def _step(p: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return u = 1 + w of the start, and N and T by which 1 + w is u·(1 − T/N)."""
    log_p = np.log(p)
    # Single precision is as exact as the start, half as long, and makes u = 1 + w exact.
    r = log_p.astype(np.float32)
    np.negative(r, out=r)
    np.sqrt(r, out=r)
    start = np.multiply(r, np.float32(C))
    for coefficient in (B, A):
        start += np.float32(coefficient)
        start *= r
    r *= np.float32(D)
    r += np.float32(1)
    start /= r
    w = start.astype(np.float64)
    u = w + 1
    # Fritsch, Shafer and Crowley (1973): with the residual F = w − ln u + ln p, Q = w(w − 2F/3),
    # the next 1 + w is u·[1 − (F/w)·(Q − F/2)/(Q − F)]. Here N = w(Q − F), T = F(Q − F/2).
    F = np.log(u)
    np.subtract(w, F, out=F)
    F += log_p
    rest = np.multiply(F, 2 / 3, out=log_p)
    np.subtract(w, rest, out=rest)
    rest *= w
    rest -= F
    w *= rest
    rest *= F
    F *= F
    F *= 0.5
    rest += F
    return u, w, rest
