"""How far a candidate is from the reference: the objectives, each with its lower bound.

All of them judge the residual r = (s + c)/n − j of `cylcontact.datasets.moments`, the log of
δ_law/δ_reference at equal load. At equal penetration the log of the force ratio is −n·r.

The lower bound is what the best K* and n at *each* clearance would reach: no law of the form
f = K*(ΔR)·E*/ΔR·δ^n(ΔR) can do better, whatever its K*(ΔR) and n(ΔR).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy.optimize import least_squares, linprog

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.moments import Moments
from cylcontact.fitting.parameters import PowerForm


class Objective(Protocol):
    """A number to make small, evaluated for many candidates at once."""

    @property
    def dR(self) -> FloatArray:
        """The clearances in mm, shape (m,)."""
        ...

    def values(self, form: PowerForm) -> FloatArray:
        """Return the objective of P candidates, shape (P,); inf where one is undefined."""
        ...

    def residuals(self, form: PowerForm) -> FloatArray:
        """Return what the polish works on, shape (P, q)."""
        ...

    @property
    def bound(self) -> float:
        """The per-clearance lower bound."""
        ...


@dataclass(frozen=True)
class RmsLogPenetration:
    """Root mean square of ln(δ_law/δ_reference), from moments alone."""

    moments: Moments

    @property
    def dR(self) -> FloatArray:
        """The clearances in mm, shape (m,)."""
        return self.moments.dR

    def values(self, form: PowerForm) -> FloatArray:
        """Return the objective of P candidates, shape (P,)."""
        level, tilt = self._parts(form)
        squares = (level**2 + tilt**2).sum(axis=-1)
        return _or_inf(np.sqrt(squares + self.bound**2))

    def residuals(self, form: PowerForm) -> FloatArray:
        """Return the parts whose squares add up to the objective's, the bound's left out."""
        level, tilt = self._parts(form)
        return np.concatenate([level, tilt], axis=1)

    @cached_property
    def bound(self) -> float:
        """What the least-squares line of j on s leaves at each clearance."""
        return float(np.sqrt(self.moments.unexplained.sum() / self.moments.total))

    def _parts(self, form: PowerForm) -> tuple[FloatArray, FloatArray]:
        """Split the residuals at each ΔR into their mean and what is linear in s."""
        m = self.moments
        level_weight, tilt_weight, slope = self._constants
        level = level_weight * ((m.mean_s + form.c) / form.n - m.mean_j)
        tilt = tilt_weight * (1 / form.n - slope)
        return as_floats(level), as_floats(tilt)

    @cached_property
    def _constants(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """What every evaluation needs of the moments: two weights and the best 1/n."""
        m = self.moments
        return np.sqrt(m.count / m.total), np.sqrt(m.ss / m.total), m.slope


@dataclass(frozen=True, eq=False)
class Rows:
    """Samples held in memory, sorted by clearance, for objectives that moments do not carry.

    Attributes
    ----------
    dR : array of float, shape (m,)
        The clearances in mm.
    index : array of int, shape (N,)
        The clearance of each sample.
    s, j : array of float, shape (N,)
        ln(f/E*) and ln δ.
    """

    dR: FloatArray
    index: np.ndarray[tuple[int], np.dtype[np.intp]]
    s: FloatArray
    j: FloatArray

    def log_ratio(self, c: FloatArray, n: FloatArray) -> FloatArray:
        """Return r of one candidate, shape (N,), from its c and n, shape (m,)."""
        return as_floats((self.s + c[self.index]) / n[self.index] - self.j)

    def clearances(self) -> list[tuple[FloatArray, FloatArray]]:
        """Return s and j of each clearance."""
        edges = np.searchsorted(self.index, np.arange(1, self.dR.size))
        return list(zip(np.split(self.s, edges), np.split(self.j, edges), strict=True))


@dataclass(frozen=True)
class _RowObjective(ABC):
    """What the objectives on rows share: one candidate after the other."""

    rows: Rows

    @property
    def dR(self) -> FloatArray:
        """The clearances in mm, shape (m,)."""
        return self.rows.dR

    def values(self, form: PowerForm) -> FloatArray:
        """Return the objective of P candidates, shape (P,)."""
        with np.errstate(over="ignore"):
            return _or_inf(np.array([self._one(c, n) for c, n in zip(form.c, form.n, strict=True)]))

    def _one(self, c: FloatArray, n: FloatArray) -> float:
        """Return the objective of one candidate."""
        return _rms(self._deviations(self.rows.log_ratio(c, n), n[self.rows.index]))

    def residuals(self, form: PowerForm) -> FloatArray:
        """Return the deviations over √N, shape (P, N): squared, they add up to the objective's."""
        with np.errstate(over="ignore"):
            deviations = [
                self._deviations(self.rows.log_ratio(c, n), n[self.rows.index])
                for c, n in zip(form.c, form.n, strict=True)
            ]
        return as_floats(np.array(deviations) / np.sqrt(self.rows.s.size))

    @abstractmethod
    def _deviations(self, log_ratio: FloatArray, n: FloatArray) -> FloatArray:
        """Return what is squared, from r and n of each sample."""

    @cached_property
    def bound(self) -> float:
        """What the best line at each clearance leaves."""
        squares = 0.0
        for s, j in self.rows.clearances():
            squares += _best_line(s, j, self._deviations)
        return float(np.sqrt(squares / self.rows.s.size))


@dataclass(frozen=True)
class RmsDifference(_RowObjective):
    """Root mean square of Eq 9, in percent."""

    def _deviations(self, log_ratio: FloatArray, n: FloatArray) -> FloatArray:  # noqa: ARG002
        return 100 * np.expm1(log_ratio)


@dataclass(frozen=True)
class RmsRelativeForce(_RowObjective):
    """Root mean square of (f_law − f_reference)/f_reference at equal penetration."""

    def _deviations(self, log_ratio: FloatArray, n: FloatArray) -> FloatArray:
        return np.expm1(-n * log_ratio)


@dataclass(frozen=True)
class MaxDifference(RmsDifference):
    """Largest magnitude of Eq 9, in percent."""

    def _one(self, c: FloatArray, n: FloatArray) -> float:
        return float(100 * np.abs(np.expm1(self.rows.log_ratio(c, n))).max())

    def residuals(self, form: PowerForm) -> FloatArray:
        """Return the largest and smallest of Eq 9 at each clearance, as fractions, (P, 2m)."""
        pairs = zip(form.c, form.n, strict=True)
        ratio = np.expm1([self.rows.log_ratio(c, n) for c, n in pairs])
        starts = np.searchsorted(self.rows.index, np.arange(self.dR.size))
        extremes = [ufunc.reduceat(ratio, starts, axis=1) for ufunc in (np.maximum, np.minimum)]
        return np.concatenate(extremes, axis=1)

    @cached_property
    def bound(self) -> float:
        """The worst clearance's narrowest strip around (s, j).

        A strip of width w in r is best placed so that exp(w₊) − 1 = 1 − exp(w₋) with
        w₊ − w₋ = w, which makes the largest |Eq 9| equal to tanh(w/2).
        """
        widths = [_strip_width(s, j) for s, j in self.rows.clearances()]
        return float(100 * np.tanh(max(widths) / 2))


def _rms(deviations: FloatArray) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(deviations**2)))


def _or_inf(values: FloatArray) -> FloatArray:
    """Put inf where a candidate is undefined."""
    return np.where(np.isfinite(values), values, np.inf)


def _best_line(
    s: FloatArray, j: FloatArray, deviations: Callable[[FloatArray, FloatArray], FloatArray]
) -> float:
    """Return the least sum of squared deviations that one K* and n reach on samples."""
    if np.ptp(s) == 0:
        return 0.0  # samples at one s are one point, and some line passes through it
    slope, level = np.polyfit(s - s.mean(), j, 1)

    def residuals(line: FloatArray) -> FloatArray:
        log_ratio = line[0] + line[1] * (s - s.mean()) - j
        return deviations(log_ratio, np.full_like(s, 1 / line[1]))

    start = np.array([level, slope])
    return float(2 * least_squares(residuals, start, method="lm", xtol=1e-12).cost)


def _strip_width(s: FloatArray, j: FloatArray) -> float:
    """Return the extent in j of the narrowest strip around the points (s, j).

    The strip is j = p·s + q ± w/2; the linear programme finds p, q and w.
    """
    x, y = s - s.mean(), j - j.mean()
    ones = np.ones_like(x)
    above = np.column_stack([-x, -ones, -ones / 2])
    below = np.column_stack([x, ones, -ones / 2])
    found = linprog(
        [0, 0, 1],
        A_ub=np.vstack([above, below]),
        b_ub=np.concatenate([-y, y]),
        bounds=[(None, None), (None, None), (0, None)],
    )
    if found.x is None:
        raise ArithmeticError(f"the narrowest strip was not found: {found.message}")
    return float(found.x[2])


OBJECTIVES = (
    "rms-log-penetration",
    "rms-difference-percent",
    "max-difference-percent",
    "rms-relative-force",
)
_ON_ROWS = {
    "rms-difference-percent": RmsDifference,
    "max-difference-percent": MaxDifference,
    "rms-relative-force": RmsRelativeForce,
}


def needs_rows(objective: str) -> bool:
    """Tell whether an objective needs the samples themselves, not only their moments."""
    return objective in _ON_ROWS


def make_objective(objective: str, data: Moments | Rows) -> Objective:
    """Return the named objective on its data: rows where `needs_rows` says so."""
    if isinstance(data, Rows):
        return _ON_ROWS[objective](data)
    return RmsLogPenetration(data)
