"""Moments of a logarithmic reference law over whole rows of a grid, one logarithm per sample.

At fixed E, ν and ΔR, a logarithmic law is δ = A·f·z with z = 1 + ln(f_max/f), so that

    s = ln f − ln E*,    j = s + ln(κ/π) + ln z.

s and z are differences of a term of the row (E and ν) and a term of the load. So only ln z is
evaluated at each sample, and the moments need its sums along rows and along loads and the sum of
its squares:

    Σ(s − s̄)·ln z = Σ_k (ln f_k − mean)·Σ_r ln z − Σ_r (ln E*_r − mean)·Σ_k ln z.
"""

from __future__ import annotations

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.datasets.moments import Moments
from cylcontact.laws.logarithmic import LogarithmicLaw
from cylcontact.pair import CylinderPair

__all__ = ["TILE", "row_moments"]

# Samples per tile: their logarithms, half a MiB, stay in the cache of a core.
TILE = 1 << 16


def row_moments(law: LogarithmicLaw, pair: CylinderPair, load: FloatArray) -> Moments:
    """Return the moments of every load on every pair, all inside the law's domain.

    Parameters
    ----------
    law : LogarithmicLaw
        The reference.
    pair : CylinderPair
        Pairs of one ΔR, E and ν in arrays of shape (r,).
    load : array of float, shape (k,)
        Loads in N/mm, none above the law's largest for any of the pairs.

    Returns
    -------
    Moments
        At the one clearance; equal to `Moments.of_samples` of the r·k samples up to rounding.

    Examples
    --------
    >>> from cylcontact import Material, laws
    >>> law, load = laws.Johnson(), np.geomspace(10.0, 1000.0, 5)
    >>> steel = Material("steels", E=np.array([200e3, 207e3]), nu=0.3)
    >>> pair = CylinderPair.from_dR("internal", 0.5, steel)
    >>> s, j = np.log(load / pair.E_star[:, None]), np.log([
    ...     law.penetration(load, CylinderPair.from_dR("internal", 0.5, Material("", E, 0.3)))
    ...     for E in (200e3, 207e3)
    ... ])
    >>> whole, by_row = Moments.of_samples(0.5, s.ravel(), j.ravel()), row_moments(law, pair, load)
    >>> bool(np.isclose(whole.jj, by_row.jj, rtol=1e-13))
    True
    """
    log_E, log_load = np.log(pair.E_star), np.log(load)
    reach = np.broadcast_to(1 + np.log(law.max_load(pair)), log_E.shape)
    # Logarithms of z over its mean are small, so subtracting their mean loses no digits.
    middle = reach.mean() - log_load.mean()
    rows, loads = reach / middle, -log_load / middle
    if rows.size > loads.size:
        by_load, by_row, squares = _sums(loads, rows)
    else:
        by_row, by_load, squares = _sums(rows, loads)
    count = float(log_E.size * log_load.size)
    mean = by_row.sum() / count
    b, a = log_E - log_E.mean(), log_load - log_load.mean()
    ss = log_E.size * (a * a).sum() + log_load.size * (b * b).sum()
    sz = (a * by_load).sum() - (b * by_row).sum()
    zz = max(squares - count * mean**2, 0.0)
    mean_s = log_load.mean() - log_E.mean()
    mean_j = mean_s + np.log(law.kappa / np.pi) + np.log(middle) + mean
    numbers = (pair.dR, count, mean_s, mean_j, ss, ss + sz, ss + 2 * sz + zz)
    return Moments(*(np.array([float(number)]) for number in numbers))


def _sums(few: FloatArray, many: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Return the sums of ln(few + many) by element of `few` and `many`, and of its squares."""
    by_few, by_many, squares = np.zeros(few.size), np.zeros(many.size), 0.0
    width = min(many.size, TILE)
    height = min(few.size, max(1, TILE // width))
    room = np.empty((height, width))
    for top in range(0, few.size, height):
        for left in range(0, many.size, width):
            down, across = slice(top, top + height), slice(left, left + width)
            x, y = few[down, None], many[across]
            z = np.add(x, y, out=room[: x.size, : y.size])
            np.log(z, out=z)
            by_few[down] += z.sum(axis=1)
            by_many[across] += z.sum(axis=0)
            # Sums instead of dot products, whose result depends on the number of BLAS threads.
            squares += float(np.square(z, out=z).sum())
    return by_few, by_many, squares
