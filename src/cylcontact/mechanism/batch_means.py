"""Intervals and tests for the mean of a correlated series, from the means of long batches.

The values of successive revolutions depend on each other, so that their scatter says little of how
well their mean is known. The means of batches much longer than that dependence are nearly
independent and normal, and Student's interval applies to them (Law and Kelton, Simulation Modeling
and Analysis). Every mean here is a ratio of sums, Σ numerator / Σ denominator: a plain mean has
ones in the denominator, the mean penetration has the time in contact. With the sums N and D of a
batch, its residual is d = N − R·D, and the standard error of R is that of the mean of d over the
mean of D.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri, stdtr, stdtrit

from cylcontact.support.arrays import BoolArray, FloatArray

BATCHES = 20
# Fewer batches, or fewer revolutions in each, give no interval.
LEAST, SIZE = 4, 2
# Of both tests: the probability to reject a series that is stationary, or whose batches are
# independent.
SIGNIFICANCE = 0.01
# Assumed: a drift or an error of less than this share of the mean is none. A run that settles
# drifts for ever, by less and less.
NEGLIGIBLE = 1e-3


def batches_of(revolutions: int) -> int:
    """Return the number of batches that a run is divided into; 0 if it is too short."""
    count = min(BATCHES, revolutions // SIZE)
    return count if count >= LEAST else 0


@dataclass(frozen=True)
class BatchMeans:
    """The sums of k quantities over batches.

    `ratio`, shape (k,), is Σ numerator / Σ denominator over all revolutions, NaN where the
    denominators are all 0; `residuals`, shape (batches, k), are N − R·D over the mean of D.
    """

    ratio: FloatArray
    residuals: FloatArray

    @classmethod
    def of(cls, numerator: FloatArray, denominator: FloatArray) -> BatchMeans:
        """Return the batch means of series of shape (revolutions, k).

        Batches differ by at most one revolution in length, which ratios allow for. A revolution
        with a NaN in the numerator counts in neither sum.
        """
        missing = np.isnan(numerator)
        over, under = np.where(missing, 0.0, numerator), np.where(missing, 0.0, denominator)
        total = under.sum(axis=0)
        with np.errstate(invalid="ignore", divide="ignore"):
            ratio: FloatArray = np.where(total > 0, over.sum(axis=0) / total, np.nan)
        count = batches_of(len(over))
        if not count:
            return cls(ratio, np.empty((0, ratio.size)))
        starts = np.linspace(0, len(over), count, endpoint=False).astype(np.intp)
        top, bottom = (np.add.reduceat(part, starts) for part in (over, under))
        with np.errstate(invalid="ignore", divide="ignore"):
            residuals: FloatArray = (top - ratio * bottom) / (total / count)
        return cls(ratio, residuals)

    @property
    def batches(self) -> int:
        """The number of batches; 0 if the run is too short for them."""
        return len(self.residuals)

    def half_width(self, level: float) -> FloatArray:
        """Return the half-widths of the intervals at a level of confidence; NaN without batches."""
        count = self.batches
        if not count:
            return np.full_like(self.ratio, np.nan)
        error = np.sqrt((self.residuals**2).sum(axis=0) / (count * (count - 1)))
        width: FloatArray = stdtrit(count - 1, 0.5 + level / 2) * error
        return width

    @property
    def drifts(self) -> BoolArray:
        """Whether the batch means have a trend: a t-test of their slope, at 1 %."""
        count = self.batches
        if not count:
            return np.zeros(self.ratio.size, dtype=bool)
        at = np.arange(count) - 0.5 * (count - 1)
        square = at @ at
        slope = at @ self.residuals / square
        left = ((self.residuals - np.outer(at, slope)) ** 2).sum(axis=0) / (count - 2)
        with np.errstate(invalid="ignore", divide="ignore"):
            t = np.abs(slope) * np.sqrt(square / left)
        certain = 2 * stdtr(count - 2, -t) < SIGNIFICANCE
        found: BoolArray = certain & (np.abs(slope) * count > NEGLIGIBLE * np.abs(self.ratio))
        return found

    @property
    def correlated(self) -> BoolArray:
        """Whether successive batch means are correlated, so that the interval is too narrow.

        Von Neumann's ratio of successive differences, as Young's C, at 1 % (one-sided). It matters
        only if the standard error is not negligible beside the mean.
        """
        count = self.batches
        if not count:
            return np.zeros(self.ratio.size, dtype=bool)
        squares = (self.residuals**2).sum(axis=0)
        steps = (np.diff(self.residuals, axis=0) ** 2).sum(axis=0)
        with np.errstate(invalid="ignore", divide="ignore"):
            c = 1 - steps / (2 * squares)
        bound = -ndtri(SIGNIFICANCE) * math.sqrt((count - 2) / (count**2 - 1))
        found: BoolArray = (c > bound) & (
            squares > count * (count - 1) * (NEGLIGIBLE * self.ratio) ** 2
        )
        return found
