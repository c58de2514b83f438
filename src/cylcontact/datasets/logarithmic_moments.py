"""Moments of a logarithmic reference law over whole rows of a grid, without its samples.

At fixed E, ν and ΔR, a logarithmic law is δ = A·f·z with z = 1 + ln(f_max/f), so that

    s = ln f − ln E*,    j = s + ln(κ/π) + ln z,    z = x − y + t,

with a term x of the row (E and ν), y = ln f of the load and t of the clearance. In the domain
z ≥ 1, so ln z is smooth and interpolated from a few Chebyshev nodes in x and y, with matrices U
and V of barycentric weights (Berrut and Trefethen 2004) that are the same at every clearance.
With C = ln z at the nodes the samples are U·C·Vᵀ, and their sums are bilinear in C:

    Σ a·ln z·b = (Uᵀa)ᵀ·C·(Vᵀb),    Σ ln² z = Σ (UᵀU·C·VᵀV)∘C.

That takes some thousand logarithms a clearance, however many samples there are.
"""

from __future__ import annotations

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.moments import Moments
from cylcontact.laws.logarithmic import LogarithmicLaw
from cylcontact.pair import CylinderPair

# The interpolation converges as ρ⁻ᵠ; the error left, which the sums reduce further.
_LEFT = 1e-12


def row_moments(
    law: LogarithmicLaw,
    pair: CylinderPair,
    load: FloatArray,
    dR: FloatArray | None = None,
    shift: FloatArray | None = None,
) -> Moments:
    """Return the moments of every load on every pair of one ΔR, all inside the law's domain.

    They are those at m clearances `dR` in mm, given the logarithm of each one's Λ over that of the
    pairs, `shift`; by default at the clearance of the pairs. They equal `Moments.of_samples` up to
    rounding.
    """
    dR = np.atleast_1d(as_floats(pair.dR)) if dR is None else dR
    t = np.zeros(1) if shift is None else shift
    log_E, log_load = np.log(pair.E_star), np.log(load)
    reach = np.broadcast_to(1 + np.log(law.max_load(pair)), log_E.shape)
    (x, by_row), (y, by_load) = _interpolation(reach), _interpolation(log_load)
    # Logarithms of z over its mean are small, so subtracting their mean loses no digits.
    middle = reach.mean() - log_load.mean() + t
    C = np.log((x[:, None] - y + t[:, None, None]) / middle[:, None, None])
    b, a = log_E - log_E.mean(), log_load - log_load.mean()
    # Sums instead of dot products, whose result depends on the number of BLAS threads.
    rows, loads = by_row.sum(axis=0), by_load.sum(axis=0)
    rows_b, loads_a = (b[:, None] * by_row).sum(axis=0), (a[:, None] * by_load).sum(axis=0)
    count = float(log_E.size * log_load.size)
    mean = np.einsum("i,mij,j->m", rows, C, loads, optimize=False) / count
    C -= mean[:, None, None]
    sz = (C * (rows[:, None] * loads_a - rows_b[:, None] * loads)).sum(axis=(1, 2))
    zz = ((_gram(by_row) @ C @ _gram(by_load)) * C).sum(axis=(1, 2))
    ss = log_E.size * (a * a).sum() + log_load.size * (b * b).sum()
    mean_s = log_load.mean() - log_E.mean()
    mean_j = mean_s + np.log(law.kappa / np.pi) + np.log(middle) + mean
    numbers = (count, mean_s, mean_j, ss, ss + sz, ss + 2 * sz + np.maximum(zz, 0.0))
    return Moments(dR, *(np.broadcast_to(as_floats(number), dR.shape) for number in numbers))


def _gram(weights: FloatArray) -> FloatArray:
    """Return WᵀW, summed in the order of the samples."""
    return as_floats(np.einsum("ki,kj->ij", weights, weights, optimize=False))


def _interpolation(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return nodes and the weights, shape (n, q), that interpolate ln z from them at n values.

    Few values are nodes themselves. The singularity z = 0 is at least 1 away from the values, which
    sets the rate ρ.
    """
    low, extent = values.min(), np.ptp(values)
    reach = 1 + 2 / max(extent, 1e-6)
    q = int(np.ceil(-np.log(_LEFT) / np.log(reach + np.sqrt(reach**2 - 1))))
    if values.size <= q:
        return values, np.eye(values.size)
    angle = np.pi * (np.arange(q) + 0.5) / q
    nodes = low + extent * (1 + np.cos(angle)) / 2
    distance = values[:, None] - nodes
    with np.errstate(divide="ignore", invalid="ignore"):
        weights = (-1.0) ** np.arange(q) * np.sin(angle) / distance
        total = weights.sum(axis=1, keepdims=True)
        weights /= total
    at_node = np.isinf(total[:, 0])
    weights[at_node] = distance[at_node] == 0
    return nodes, weights
