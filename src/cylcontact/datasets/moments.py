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

from cylcontact.arrays import FloatArray, IndexArray, require


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
    """Merge two sets of moments."""
    require(
        first.dR.shape == second.dR.shape and np.array_equal(first.dR, second.dR),
        "merge",
        "dR",
        None,
        "moments of different clearances cannot be merged",
        "concatenate them instead",
    )
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
