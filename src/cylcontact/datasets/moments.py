"""Six numbers per clearance that stand for any number of samples.

For a law f = K*(ΔR)·E*/ΔR·δ^n(ΔR) the residual of a sample is

    r = ln δ_law − ln δ_reference = (s + c)/n − j,

with s = ln(f/E*), j = ln δ_reference and c = ln ΔR − ln K*. At one ΔR both c and n are
constants, so that Σ r² depends on the samples only through their count, the means of s and j
and their centred second moments. A grid of any size collapses to these, exactly, and the
moments of its parts merge.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields
from functools import reduce

import numpy as np

from cylcontact.arrays import FloatArray, require

__all__ = ["Moments", "concatenate", "merge"]


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
        # Plain sums rather than dot products: their result does not depend on BLAS threads.
        sums = ((s0 * s0).sum(), (s0 * j0).sum(), (j0 * j0).sum())
        return cls(*(np.array([value]) for value in (dR, float(s.size), mean_s, mean_j, *sums)))

    @property
    def total(self) -> float:
        """Number of samples at all clearances together."""
        return float(self.count.sum())

    @property
    def slope(self) -> FloatArray:
        """Slope of the least-squares line of j on s at each ΔR: the best 1/n."""
        return np.divide(self.sj, self.ss, out=np.zeros_like(self.sj), where=self.ss > 0)

    @property
    def unexplained(self) -> FloatArray:
        """Sum of squares that this line leaves at each ΔR: no K* and n can do better."""
        return np.maximum(self.jj - self.sj * self.slope, 0.0)


def merge(parts: Iterable[Moments]) -> Moments:
    """Merge moments of disjoint samples at the same clearances.

    Pairwise update of Chan, Golub and LeVeque (1979), on centred sums, so that nothing
    cancels.

    Parameters
    ----------
    parts : iterable of Moments
        At least one; all at the same ΔR.

    Returns
    -------
    Moments
        The same in any order, up to rounding.

    Raises
    ------
    InputError
        If the clearances differ.
    """
    return reduce(_merge_two, parts)


def concatenate(parts: Iterable[Moments]) -> Moments:
    """Join moments at different clearances into one, in the given order."""
    collected = list(parts)
    return Moments(
        *(np.concatenate([getattr(part, field.name) for part in collected]) for field in _FIELDS)
    )


def _merge_two(one: Moments, two: Moments) -> Moments:
    """Merge two sets of moments."""
    require(
        one.dR.shape == two.dR.shape and np.array_equal(one.dR, two.dR),
        "merge",
        "dR",
        None,
        "moments of different clearances cannot be merged",
        "concatenate them instead",
    )
    count = one.count + two.count
    share = np.divide(two.count, count, out=np.zeros_like(count), where=count > 0)
    ds, dj = two.mean_s - one.mean_s, two.mean_j - one.mean_j
    weight = one.count * share
    return Moments(
        one.dR,
        count,
        one.mean_s + ds * share,
        one.mean_j + dj * share,
        one.ss + two.ss + ds * ds * weight,
        one.sj + two.sj + ds * dj * weight,
        one.jj + two.jj + dj * dj * weight,
    )


_FIELDS = fields(Moments)
