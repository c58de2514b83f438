"""Moments: six numbers per clearance that replace any number of samples.

For a law f = K*(ΔR)·E*/ΔR·δ^n(ΔR) the residual of a sample is

    r = ln δ_law − ln δ_reference = (s + c)/n − j,

with s = ln(f/E*), j = ln δ_reference and c = ln ΔR − ln K*. At one ΔR both c and n are
constants, so that Σ r² depends on the samples only through their count, the means of s and j and
their centred second moments. This reduction is exact for a grid of any size, and the moments of
its parts can be merged.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields
from functools import reduce

import numpy as np

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws.logarithmic import LogarithmicLaw
from cylcontact.support.arrays import FloatArray, IndexArray, as_floats, require


@dataclass(frozen=True, eq=False)
class Moments:
    """Moments of (s, j) = (ln(f/E*), ln δ) at each of m clearances.

    Attributes
    ----------
    dR : array of float, shape (m,)
        ΔR in mm.
    count : array of float, shape (m,)
        Number of samples.
    mean_s, mean_j : array of float, shape (m,)
        Means; zero where the count is zero.
    ss, sj, jj : array of float, shape (m,)
        Centred sums Σ(s − s̄)², Σ(s − s̄)(j − j̄) and Σ(j − j̄)².

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> s, j = rng.normal(size=(2, 100))
    >>> parts = [Moments.of_samples(0.5, s[:30], j[:30]), Moments.of_samples(0.5, s[30:], j[30:])]
    >>> merged, whole = merge(parts), Moments.of_samples(0.5, s, j)
    >>> bool(np.allclose(merged.sj, whole.sj, rtol=1e-13))
    True
    """

    dR: FloatArray
    count: FloatArray
    mean_s: FloatArray
    mean_j: FloatArray
    ss: FloatArray
    sj: FloatArray
    jj: FloatArray

    @classmethod
    def of_samples(cls, dR: float, s: FloatArray, j: FloatArray) -> Moments:
        """Return the moments of samples that share one ΔR, shapes (k,)."""
        if s.size == 0:
            return cls(*(np.array([value]) for value in (dR, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)))
        mean_s, mean_j = s.mean(), j.mean()
        s0, j0 = s - mean_s, j - mean_j
        # Sums instead of dot products, whose result depends on the number of BLAS threads.
        sums = ((s0 * s0).sum(), (s0 * j0).sum(), (j0 * j0).sum())
        return cls(*(np.array([value]) for value in (dR, float(s.size), mean_s, mean_j, *sums)))

    def at(self, places: IndexArray) -> Moments:
        """Return the moments at some of the clearances."""
        return Moments(*(getattr(self, field.name)[places] for field in _FIELDS))

    @property
    def total(self) -> float:
        """Total number of samples at all clearances."""
        return float(self.count.sum())

    @property
    def slope(self) -> FloatArray:
        """Slope of the least-squares line of j over s at each ΔR, the best 1/n."""
        return np.divide(self.sj, self.ss, out=np.zeros_like(self.sj), where=self.ss > 0)

    @property
    def unexplained(self) -> FloatArray:
        """Residual sum of squares of that line at each ΔR, a lower bound for every K* and n."""
        return np.maximum(self.jj - self.sj * self.slope, 0.0)


def merge(parts: Iterable[Moments]) -> Moments:
    """Merge moments of disjoint samples at the same clearances.

    Pairwise update of Chan, Golub and LeVeque (1979) on centred sums, without cancellation.

    Parameters
    ----------
    parts : iterable of Moments
        At least one; all at the same ΔR.

    Returns
    -------
    Moments
        Independent of the order up to rounding.

    Raises
    ------
    InputError
        If the clearances differ.
    """
    return reduce(_merge_two, parts)


def concatenate(parts: Iterable[Moments]) -> Moments:
    """Return moments at different clearances as one object, in the given order."""
    collected = list(parts)
    return Moments(
        *(np.concatenate([getattr(part, field.name) for part in collected]) for field in _FIELDS)
    )


def _merge_two(first: Moments, second: Moments) -> Moments:
    same = first.dR.shape == second.dR.shape and np.array_equal(first.dR, second.dR)
    rule = "moments of different clearances cannot be merged"
    require(same, "merge", "dR", None, rule, "concatenate them instead")
    count = first.count + second.count
    share = np.divide(second.count, count, out=np.zeros_like(count), where=count > 0)
    ds, dj = second.mean_s - first.mean_s, second.mean_j - first.mean_j
    weight = first.count * share
    return Moments(
        first.dR,
        count,
        first.mean_s + ds * share,
        first.mean_j + dj * share,
        first.ss + second.ss + ds * ds * weight,
        first.sj + second.sj + ds * dj * weight,
        first.jj + second.jj + dj * dj * weight,
    )


_FIELDS = fields(Moments)


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

    At fixed E, ν and ΔR, a logarithmic law is δ = A·f·z with z = 1 + ln(f_max/f), so that

        s = ln f − ln E*,    j = s + ln(κ/π) + ln z,    z = x − y + t,

    with a term x of the row (E and ν), y = ln f of the load and t of the clearance. In the domain
    z ≥ 1, so ln z is smooth and interpolated from a few Chebyshev nodes in x and y, with matrices U
    and V of barycentric weights (Berrut and Trefethen 2004) that are the same at every clearance.
    With C = ln z at the nodes the samples are U·C·Vᵀ, and their sums are bilinear in C:

        Σ a·ln z·b = (Uᵀa)ᵀ·C·(Vᵀb),    Σ ln² z = Σ (UᵀU·C·VᵀV)∘C.

    That takes some thousand logarithms a clearance, however many samples there are.

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
    """Return nodes and weights (n, q) that interpolate ln z, with z = 0 at least 1 away."""
    low, extent = values.min(), np.ptp(values)
    reach = 1 + 2 / max(extent, 1e-6)
    q = int(np.ceil(-np.log(_LEFT) / np.log(reach + np.sqrt(reach**2 - 1))))
    q = q if extent > _LEFT else 1  # nodes so close would be one
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
