"""The lower branch of Lambert's W, written so that nothing is lost near the branch point.

With x = −p/e and W₋₁(x) = −(1 + w) the defining equation W·exp(W) = x becomes

    w − ln(1 + w) = −ln p,    0 < p ≤ 1,  w ≥ 0,

in which p → 1 is the branch point and w goes to zero there like √(2(1 − p)). Working in p and
w instead of x and W keeps full precision on both ends; `scipy.special.lambertw` loses half
its digits within 1e-9 of the branch point, and it is there that Johnson's law ends.
"""

from __future__ import annotations

import numpy as np

from cylcontact.arrays import FloatArray, as_floats, inside_or_nan


def branch_distance(p: FloatArray) -> FloatArray:
    """Return w = −1 − W₋₁(−p/e), the distance of W₋₁ from the branch point.

    Parameters
    ----------
    p : array of float
        Between 0 and 1; elements outside give NaN.

    Returns
    -------
    array of float
        w ≥ 0: zero at p = 1, infinite at p = 0. The relative error of 1 + w is a few units
        in the last place.

    Notes
    -----
    Barry et al., Math. Comput. Simul. 53 (2000) 95–103, give w to a relative 2.6e-4 in
    closed form; a single third-order Householder correction (quartic convergence) takes it
    to machine precision. There is no loop and no convergence test.

    Examples
    --------
    >>> w = branch_distance(np.array([0.5]))
    >>> print(f"{w[0] - np.log1p(w[0]):.15f}")
    0.693147180559945
    """
    p = np.asarray(p, dtype=np.float64)
    regular = (p > 0) & (p < 1)
    safe = np.where(regular, p, 0.5)
    g = -np.log(safe)
    w = _householder(_barry(g), g)
    w = np.where(p == 1, 0.0, np.where(p == 0, np.inf, w))
    return inside_or_nan(w, (p >= 0) & (p <= 1))


def _barry(g: FloatArray) -> FloatArray:
    """Return the closed-form approximation of w, with g = −ln p > 0."""
    m1, m2, m3 = 0.3361, -0.0042, -0.0201
    root = np.sqrt(g)
    top = m1 * np.sqrt(0.5) * root
    # Barry's 1 − 1/(1 + top/bottom) over one denominator: bottom has a zero near g = 346.
    bottom = 1 + m2 * g * np.exp(m3 * root)
    return as_floats(g + 2 / m1 * top / (bottom + top))


def _householder(w: FloatArray, g: FloatArray) -> FloatArray:
    """Correct w towards the root of h(w) = w − ln(1 + w) − g."""
    u = 1 + w
    h = w - np.log1p(w) - g
    h1, h2, h3 = w / u, 1 / u**2, -2 / u**3
    step: FloatArray = h * (6 * h1**2 - 3 * h * h2) / (6 * h1**3 - 6 * h * h1 * h2 + h**2 * h3)
    corrected: FloatArray = w - step
    return corrected
