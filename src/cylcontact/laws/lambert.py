"""The lower branch of Lambert's W, without loss of digits near the branch point.

With x = −p/e and W₋₁(x) = −(1 + w) the defining equation W·exp(W) = x becomes

    w − ln(1 + w) = −ln p,    0 < p ≤ 1,  w ≥ 0,

in which p = 1 is the branch point, and w tends to zero there like √(2(1 − p)). Working in p and w
instead of x and W gives 1 + w to full precision at both ends. `scipy.special.lambertw` loses half
its digits within 1e-9 of the branch point, which is where Johnson's law ends. The error of w is a
few units in the last place of 1 + w, so the relative error of w grows next to the branch point, to
8e-12 at 1 − p = 1e-12.

One fourth-order step of the inverse series (Householder's method) on w − ln(1 + w) + ln p, from a
start in closed form, leaves an error below half a unit in the last place of 1 + w. There is no
iteration and no convergence test.
"""

from __future__ import annotations

import numpy as np

from cylcontact.arrays import FloatArray

# The start w = r(A + r(B + Cr))/(1 + Dr) with r = √(−ln p), in which w is smooth. Fitted over all
# positive doubles; the relative error is 5e-4, below 1.5e-4 for w < 5.
A, B, C, D = 1.41441, 1.0246, 0.25518, 0.25524


def branch_distance_steps(p):
    """Return w for numbers, as other languages and compiled code compute it."""
    # At the branch point the regular formula would divide by zero; there it computes p = 0.5.
    inner = np.where((p <= 0) | (p >= 1), 0.5, p)
    g = -np.log(inner)
    r = np.sqrt(g)
    u = 1 + r * (A + r * (B + C * r)) / (1 + D * r)
    start = u - 1
    t = (start - np.log(u) - g) / (start * start)
    w = start - t * start * u * (1 + t * (0.5 + t * (0.5 + start / 3)))
    return np.where(p >= 1, 0, w)


def branch_distance(p: FloatArray) -> FloatArray:
    """Return w = −1 − W₋₁(−p/e) ≥ 0 for p from 0 to 1; NaN outside.

    The operations are in place, because allocating intermediate arrays would cost more than the
    arithmetic; `branch_distance_steps` has the formula in readable form.

    Examples
    --------
    >>> w = branch_distance(np.array([0.5]))
    >>> print(f"{w[0] - np.log1p(w[0]):.15f}")
    0.693147180559945
    """
    p, shape = np.ascontiguousarray(p, dtype=np.float64), np.shape(p)
    with np.errstate(divide="ignore", invalid="ignore"):
        g = -np.log(p)
        r = np.sqrt(g)
        # The start, as u = 1 + w.
        u = np.multiply(r, C)
        for coefficient in (B, A):
            u += coefficient
            u *= r
        r *= D
        r += 1
        u /= r
        u += 1
        # Round w so that u = 1 + w exactly; otherwise ln u would lose the digits of a small w.
        w = u - 1
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
        if not (p.min(initial=0.5) > 0 and p.max(initial=0.5) < 1):
            np.copyto(w, 0.0, where=p == 1)
            np.copyto(w, np.inf, where=p == 0)
    return w.reshape(shape)[()]
