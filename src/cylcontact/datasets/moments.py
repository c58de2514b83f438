"""Moments: six numbers per clearance that replace any number of samples.

For a law f = K*(ΔR)·E*/ΔR·δ^n(ΔR) the residual of a sample is

    r = ln δ_law − ln δ_reference = (s + c)/n − j,

with s = ln(f/E*), j = ln δ_reference and c = ln ΔR − ln K*. At one ΔR both c and n are constants,
so Σr² depends on the samples only through their count, the means of s and j, and their centred
second moments. This is exact for any number of samples, and moments of parts can be merged.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields
from functools import reduce
from typing import Self

import numpy as np

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws.logarithmic import LogarithmicLaw
from cylcontact.support.arrays import FloatArray, IndexArray, as_floats


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
    >>> s, j = np.random.default_rng(1).normal(size=(2, 100))
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
    def of_samples(cls, dR: float, s: FloatArray, j: FloatArray) -> Self:
        """Return the moments of samples that share one ΔR, shapes (k,)."""
        numbers = [0.0] * 5
        if s.size:
            mean_s, mean_j = s.mean(), j.mean()
            s0, j0 = s - mean_s, j - mean_j
            # Sums instead of dot products, whose result depends on the number of BLAS threads.
            numbers = [mean_s, mean_j, (s0 * s0).sum(), (s0 * j0).sum(), (j0 * j0).sum()]
        return cls(*(np.array([value]) for value in (dR, float(s.size), *numbers)))

    def at(self, places: IndexArray) -> Self:
        """Return the moments at some of the clearances."""
        return type(self)(*(getattr(self, field.name)[places] for field in fields(self)))

    @property
    def total(self) -> float:
        """Number of samples at all clearances."""
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
    """Merge moments of different samples at the same clearances (Chan, Golub and LeVeque 1979)."""
    return reduce(_merge_two, parts)


def _merge_two(first: Moments, second: Moments) -> Moments:
    count = first.count + second.count
    share = np.divide(second.count, count, out=np.zeros_like(count), where=count > 0)
    ds, dj = second.mean_s - first.mean_s, second.mean_j - first.mean_j
    weight = first.count * share
    return Moments(
        dR=first.dR,
        count=count,
        mean_s=first.mean_s + ds * share,
        mean_j=first.mean_j + dj * share,
        ss=first.ss + second.ss + ds * ds * weight,
        sj=first.sj + second.sj + ds * dj * weight,
        jj=first.jj + second.jj + dj * dj * weight,
    )


def concatenate(parts: Iterable[Moments]) -> Moments:
    """Return moments at different clearances as one object, in the given order."""
    columns = zip(*([getattr(m, f.name) for f in fields(m)] for m in parts), strict=True)
    return Moments(*map(np.concatenate, columns))


# --- without samples ----------------------------------------------------------------------------

# The interpolation converges as ρ⁻ᵠ; this error is left, and the sums reduce it further.
_ERROR = 1e-12


def logarithmic_moments(
    law: LogarithmicLaw, pairs: CylinderPair, load: FloatArray, clearances: CylinderPair
) -> Moments:
    """Return the moments of every load on every pair, at the ΔR of each of m other pairs.

    `pairs` differ in E*, `clearances` in ΔR. Every sample must lie in the domain of the law, which
    is δ = κ/π·f/E*·z with z = 1 + ln(f_max/f), where f_max is proportional to E* and to ΔR. So

        s = ln f − ln E*,    j = s + ln(κ/π) + ln z,    z = x − y + t,

    with x of the pair, y = ln f, and t of the clearance. In the domain z ≥ 1, so ln z is smooth and
    can be interpolated from a few Chebyshev nodes in x and y, with matrices U and V of barycentric
    weights (Berrut and Trefethen 2004) that are the same at every clearance. With C = ln z at the
    nodes, the samples of ln z are U·C·Vᵀ and their sums are bilinear in C:

        Σ a·ln z·b = (Uᵀa)ᵀ·C·(Vᵀb),    Σ ln² z = Σ (UᵀU·C·VᵀV)∘C.

    That takes some thousand logarithms a clearance, however many samples there are.
    """
    log_E, log_load = np.log(pairs.E_star), np.log(load)
    ends = np.broadcast_to(np.log(law.max_load(pairs)), log_E.shape)
    t = np.atleast_1d(np.log(clearances.dR / pairs.dR))
    (x, U), (y, V) = _interpolation(1 + ends), _interpolation(log_load)
    # Logarithms of z over its mean are small, so subtracting their mean loses no digits.
    middle = 1 + ends.mean() - log_load.mean() + t
    C = np.log((x[:, None] - y + t[:, None, None]) / middle[:, None, None])
    a, b = log_E - log_E.mean(), log_load - log_load.mean()
    # Sums instead of dot products, whose result depends on the number of BLAS threads.
    U1, Ua = U.sum(axis=0), (a[:, None] * U).sum(axis=0)
    V1, Vb = V.sum(axis=0), (b[:, None] * V).sum(axis=0)
    count = float(a.size * b.size)
    mean = np.einsum("i,mij,j->m", U1, C, V1, optimize=False) / count
    C -= mean[:, None, None]
    sz = (C * (U1[:, None] * Vb - Ua[:, None] * V1)).sum(axis=(1, 2))
    zz = np.maximum(((_gram(U) @ C @ _gram(V)) * C).sum(axis=(1, 2)), 0.0)
    ss = a.size * (b * b).sum() + b.size * (a * a).sum()
    mean_s = log_load.mean() - log_E.mean()
    mean_j = mean_s + np.log(law.kappa / np.pi) + np.log(middle) + mean
    numbers = (count, mean_s, mean_j, ss, ss + sz, ss + 2 * sz + zz)
    dR = np.broadcast_to(clearances.dR, t.shape)
    return Moments(dR, *(np.broadcast_to(as_floats(number), t.shape) for number in numbers))


def _gram(weights: FloatArray) -> FloatArray:
    """Return WᵀW, summed in the order of the samples."""
    return as_floats(np.einsum("ki,kj->ij", weights, weights, optimize=False))


def _interpolation(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return nodes and weights (n, q) that interpolate ln z, with z = 0 at least 1 away."""
    low, extent = values.min(), np.ptp(values)
    reach = 1 + 2 / max(extent, 1e-6)
    q = int(np.ceil(-np.log(_ERROR) / np.log(reach + np.sqrt(reach**2 - 1))))
    q = q if extent > _ERROR else 1  # nodes so close would be one
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
