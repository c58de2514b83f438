"""Power-law fits at one pair: K, n and R² of Figs 2 and 3."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import ContactLaw
from cylcontact.support.arrays import FloatArray, as_floats, require


@dataclass(frozen=True)
class PowerFit:
    """The straight line ln f = ln K + n·ln δ through load–penetration points.

    Attributes
    ----------
    K : float
        Factor in N/mm per mmⁿ.
    n : float
        Exponent.
    r_squared : float
        Fraction of the variance of ln f explained by the line.
    """

    K: float
    n: float
    r_squared: float


def fit_power(load: ArrayLike, penetration: ArrayLike) -> PowerFit:
    """Fit f = K·δⁿ (Eq 3) by least squares on ln f.

    Parameters
    ----------
    load : array_like
        Loads in N/mm, shape (m,), positive.
    penetration : array_like
        Penetrations in mm, shape (m,), positive.

    Returns
    -------
    PowerFit

    Raises
    ------
    InputError
        If fewer than two different penetrations are given, or one is not positive.

    Examples
    --------
    >>> delta = np.array([1e-4, 1e-3, 1e-2])
    >>> fit = fit_power(3e5 * delta**1.2, delta)
    >>> print(f"K = {fit.K:.0f}, n = {fit.n:.4f}, R² = {fit.r_squared:.6f}")
    K = 300000, n = 1.2000, R² = 1.000000
    """
    f, delta = np.broadcast_arrays(as_floats(load), as_floats(penetration))
    inside = (f > 0) & (delta > 0) & np.isfinite(f) & np.isfinite(delta)
    rule = "every value must be positive and finite"
    remedy = "leave out points beyond the law's domain"
    require(inside, "fit_power", "load, penetration", None, rule, remedy)
    y, x = np.log(f), np.log(delta)
    rule, remedy = "at least two different penetrations are needed", "give more loads"
    require(bool(x.size) and np.ptp(x) > 0, "fit_power", "penetration", None, rule, remedy)
    x0, y0 = x - x.mean(), y - y.mean()
    n = float(x0 @ y0 / (x0 @ x0))
    K = float(np.exp(y.mean() - n * x.mean()))
    r_squared = float((x0 @ y0) ** 2 / ((x0 @ x0) * (y0 @ y0)))
    return PowerFit(K, n, r_squared)


def fit_power_to_law(law: ContactLaw, load: FloatArray, pair: CylinderPair) -> PowerFit:
    """Fit f = K·δⁿ to a law at one pair over the given loads (N/mm), as in Fig 2.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material, laws
    >>> pair = CylinderPair.from_dR("internal", 0.05, Material("steel", E=207e3, nu=0.3))
    >>> load = np.concatenate([[1.0], np.arange(10.0, 1001.0, 10.0)])
    >>> fit = fit_power_to_law(laws.Johnson(), load, pair)
    >>> print(f"K = {fit.K:.0f}, n = {fit.n:.4f}, R² = {fit.r_squared:.6f}")
    K = 312148, n = 1.2370, R² = 0.998123
    """
    return fit_power(load, law.penetration(load, pair))
