"""How far a candidate is from the reference: the objectives, each with its lower bound.

All of them judge r = ln(δ_law/δ_reference) at equal load, or ln(f_law/f_reference) at equal
penetration, which for a power law is −n·r.

The lower bound is what the best K* and n at *each* clearance would reach: no law of the form
f = K*(ΔR)·E*/ΔR·δ^n(ΔR) can do better, whatever its K*(ΔR) and n(ΔR).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, Protocol

import numpy as np
from scipy.optimize import least_squares, linprog

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.moments import Moments
from cylcontact.fitting.parameters import Form, PowerForm
from cylcontact.fitting.samples import Samples

# Largest magnitudes are reported to the polish over this many groups of samples at least.
GROUPS = 400


class Objective(Protocol):
    """A number to make small, evaluated for many candidates at once."""

    @property
    def dR(self) -> FloatArray:
        """The clearances in mm, shape (m,)."""
        ...

    def values(self, form: Form) -> FloatArray:
        """Return the objective of P candidates, shape (P,); inf where one is undefined."""
        ...

    def residuals(self, form: Form) -> FloatArray:
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

    def values(self, form: Form) -> FloatArray:
        """Return the objective of P candidates, shape (P,)."""
        with np.errstate(over="ignore"):
            level, tilt = self._parts(form)
            squares = (level**2 + tilt**2).sum(axis=-1)
        return _or_inf(np.sqrt(squares + self.bound**2))

    def residuals(self, form: Form) -> FloatArray:
        """Return the parts whose squares add up to the objective's, the bound's left out."""
        level, tilt = self._parts(form)
        return np.concatenate([level, tilt], axis=1)

    @cached_property
    def bound(self) -> float:
        """What the least-squares line of j on s leaves at each clearance."""
        return float(np.sqrt(self.moments.unexplained.sum() / self.moments.total))

    def _parts(self, form: Form) -> tuple[FloatArray, FloatArray]:
        """Split the residuals at each ΔR into their mean and what is linear in s."""
        if not isinstance(form, PowerForm):
            raise TypeError("moments carry power laws only; use rows")
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


@dataclass(frozen=True)
class _RowObjective(ABC):
    """What the objectives on rows share: one candidate after the other."""

    rows: Samples
    # Whether loads are compared at equal penetration rather than penetrations at equal load.
    of_load: ClassVar[bool] = False

    @property
    def dR(self) -> FloatArray:
        """The clearances in mm, shape (m,)."""
        return self.rows.dR

    def values(self, form: Form) -> FloatArray:
        """Return the objective of P candidates, shape (P,)."""
        with np.errstate(over="ignore"):
            return _or_inf(np.array([self._value(self._log_ratio(form, k)) for k in _all(form)]))

    def residuals(self, form: Form) -> FloatArray:
        """Return what the polish works on, shape (P, q)."""
        with np.errstate(over="ignore"):
            return np.array([self._residuals(self._log_ratio(form, k)) for k in _all(form)])

    @property
    @abstractmethod
    def bound(self) -> float:
        """The per-clearance lower bound for power laws."""

    def _log_ratio(self, form: Form, candidate: int) -> FloatArray:
        """Return the log of the ratio that is judged, shape (N,)."""
        judged = form.log_load_ratio if self.of_load else form.log_penetration_ratio
        return judged(candidate, self.rows)

    @abstractmethod
    def _value(self, log_ratio: FloatArray) -> float:
        """Return the objective of one candidate."""

    @abstractmethod
    def _residuals(self, log_ratio: FloatArray) -> FloatArray:
        """Return the residuals of one candidate, shape (q,)."""


@dataclass(frozen=True)
class _RootMeanSquare(_RowObjective):
    """Root mean square of a deviation."""

    @staticmethod
    @abstractmethod
    def deviation(log_ratio: FloatArray) -> FloatArray:
        """Return what is squared."""

    @cached_property
    def bound(self) -> float:
        """What the best line at each clearance leaves."""
        squares = [self._best_line(s, j) for s, j in self.rows.clearances()]
        return float(np.sqrt(sum(squares) / self.rows.s.size))

    def _value(self, log_ratio: FloatArray) -> float:
        return float(np.sqrt(np.mean(self.deviation(log_ratio) ** 2)))

    def _residuals(self, log_ratio: FloatArray) -> FloatArray:
        # Over √N, their squares add up to the objective's.
        return as_floats(self.deviation(log_ratio) / np.sqrt(log_ratio.size))

    def _best_line(self, s: FloatArray, j: FloatArray) -> float:
        """Return the least sum of squares that one K* and n reach on one clearance's samples."""
        if np.ptp(s) == 0:
            return 0.0  # samples at one s are one point, and some line passes through it
        x, y = (j - j.mean(), s) if self.of_load else (s - s.mean(), j)

        def residuals(line: FloatArray) -> FloatArray:
            return self.deviation(line[0] + line[1] * x - y)

        slope, level = np.polyfit(x, y, 1)
        start = np.array([level, slope])
        return float(2 * least_squares(residuals, start, method="lm", xtol=1e-12).cost)


@dataclass(frozen=True)
class RmsLogPenetrationOnRows(_RootMeanSquare):
    """Root mean square of ln(δ_law/δ_reference), for laws that moments do not carry."""

    @staticmethod
    def deviation(log_ratio: FloatArray) -> FloatArray:
        """Return r itself."""
        return log_ratio


@dataclass(frozen=True)
class RmsDifference(_RootMeanSquare):
    """Root mean square of Eq 9, in percent."""

    @staticmethod
    def deviation(log_ratio: FloatArray) -> FloatArray:
        """Return Eq 9 in percent."""
        return as_floats(100 * np.expm1(log_ratio))


@dataclass(frozen=True)
class RmsRelativeForce(_RootMeanSquare):
    """Root mean square of (f_law − f_reference)/f_reference at equal penetration."""

    of_load: ClassVar[bool] = True

    @staticmethod
    def deviation(log_ratio: FloatArray) -> FloatArray:
        """Return the relative deviation of the load."""
        return as_floats(np.expm1(log_ratio))


@dataclass(frozen=True)
class Largest(_RowObjective):
    """Largest magnitude of a relative deviation, in percent."""

    @cached_property
    def bound(self) -> float:
        """The worst clearance's narrowest strip around its samples.

        A strip of width w in the log ratio is best placed so that exp(w₊) − 1 = 1 − exp(w₋)
        with w₊ − w₋ = w, which makes the largest magnitude equal to tanh(w/2).
        """
        points = self.rows.clearances()
        widths = [_strip_width(j, s) if self.of_load else _strip_width(s, j) for s, j in points]
        return float(100 * np.tanh(max(widths) / 2))

    def _value(self, log_ratio: FloatArray) -> float:
        return float(100 * np.abs(np.expm1(log_ratio)).max())

    def _residuals(self, log_ratio: FloatArray) -> FloatArray:
        # As fractions; the largest and smallest of each group stand for all of it.
        ratio = np.expm1(log_ratio)
        extremes = [ufunc.reduceat(ratio, self._groups) for ufunc in (np.maximum, np.minimum)]
        return np.concatenate(extremes)

    @cached_property
    def _groups(self) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
        """Where groups of neighbouring samples begin: each within one clearance."""
        even = np.linspace(0, self.rows.s.size, GROUPS, endpoint=False).astype(np.intp)
        return np.union1d(even, self.rows.starts)


@dataclass(frozen=True)
class MaxDifference(Largest):
    """Largest magnitude of Eq 9, in percent."""


@dataclass(frozen=True)
class MaxRelativeForce(Largest):
    """Largest magnitude of (f_law − f_reference)/f_reference at equal penetration, in percent."""

    of_load: ClassVar[bool] = True


def _all(form: Form) -> range:
    """Return the numbers of the candidates."""
    return range(len(form))


def _or_inf(values: FloatArray) -> FloatArray:
    """Put inf where a candidate is undefined."""
    return np.where(np.isfinite(values), values, np.inf)


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


ON_ROWS: dict[str, Callable[[Samples], Objective]] = {
    "rms-difference-percent": RmsDifference,
    "max-difference-percent": MaxDifference,
    "rms-relative-force": RmsRelativeForce,
    "max-relative-force-percent": MaxRelativeForce,
}
OBJECTIVES = ("rms-log-penetration", *ON_ROWS)


def make_objective(objective: str, data: Moments | Samples) -> Objective:
    """Return the named objective on its data: moments only for rms-log-penetration."""
    if isinstance(data, Moments):
        return RmsLogPenetration(data)
    return ON_ROWS.get(objective, RmsLogPenetrationOnRows)(data)
