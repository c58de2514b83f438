"""Objectives on samples of a reference law, each with its lower bound.

The deviation is r = ln(δ_law/δ_reference) at equal load, or ln(f_law/f_reference) at equal
penetration, which for a power law is −n·r.

The lower bound is the objective with the best K* and n at *each* clearance. No law of the form
f = K*(ΔR)·E*/ΔR·δ^n(ΔR) can be better, whatever its K*(ΔR) and n(ΔR).

Candidates that are a power law at each clearance are a `PowerForm`, evaluated at once; a `LawForm`
holds candidates of any law.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from scipy.optimize import least_squares, linprog

from cylcontact.bodies.material import material_in_MPa
from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.datasets.grid import Grid
from cylcontact.datasets.moments import Moments
from cylcontact.datasets.sampling import Counts, blocks, reduce_grid
from cylcontact.fitting.problem import ParameterSpace, built
from cylcontact.laws.law import ContactLaw, LawModel
from cylcontact.support.arrays import FloatArray, IndexArray, as_floats
from cylcontact.support.parallel import Workers, call, run_calls

# With E = 2 MPa and ν = 0 the composite modulus is 1 MPa.
_UNIT = material_in_MPa("of unit composite modulus", 2.0, 0.0)


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples sorted by clearance and, within one, by s."""

    contact: Contact
    # The m clearances in mm.
    dR: FloatArray
    # Of each of N samples its clearance, ln(f/E*) and ln δ.
    index: IndexArray
    s: FloatArray
    j: FloatArray

    @cached_property
    def pair(self) -> CylinderPair:
        """The pair of each sample with E* = 1, so that its load is f/E*, in mm."""
        return CylinderPair.from_dR(self.contact, self.dR[self.index], _UNIT)

    @cached_property
    def load(self) -> FloatArray:
        """Loads over the composite modulus, in mm."""
        return np.asarray(np.exp(self.s))

    @cached_property
    def penetration(self) -> FloatArray:
        """Penetrations in mm."""
        return np.asarray(np.exp(self.j))

    @cached_property
    def starts(self) -> IndexArray:
        """Index of the first sample of each clearance, shape (m,)."""
        return np.searchsorted(self.index, np.arange(self.dR.size))

    def clearances(self) -> list[tuple[FloatArray, FloatArray]]:
        """Return s and j of each clearance."""
        edges = self.starts[1:]
        return list(zip(np.split(self.s, edges), np.split(self.j, edges), strict=True))


def collect_samples(grid: Grid) -> tuple[Samples, Counts]:
    """Sample a grid into memory, without clearances that are masked completely."""
    sampled = [
        (np.full(block.load.size, k), block.s, block.j, block.masked)
        for k, dR in enumerate(grid.dR)
        for block in blocks(grid, float(dR))
    ]
    *columns, masked = zip(*sampled, strict=True)
    of_clearance, s, j = map(np.concatenate, columns)
    if not s.size:
        reduce_grid(grid)  # raises the error that names the reason
    order = np.lexsort((s, of_clearance))
    inside, index = np.unique(of_clearance[order], return_inverse=True)
    rows = Samples(
        contact=grid.contact,
        dR=grid.dR[inside],
        index=index,
        s=s[order],
        j=j[order],
    )
    return rows, Counts(s.size, sum(masked))


@dataclass(frozen=True)
class PowerForm:
    """P power laws at m clearances: c = ln ΔR − ln K* and n, NaN where K* or n is not positive."""

    c: FloatArray
    n: FloatArray

    def __len__(self) -> int:
        return len(self.n)

    def log_ratio(self, candidate: int, rows: Samples, of_load: bool = False) -> FloatArray:
        """Return r = (s + c)/n − j of each sample, or n·j − c − s = −n·r of the loads."""
        c, n = self.c[candidate][rows.index], self.n[candidate][rows.index]
        return as_floats(n * rows.j - c - rows.s if of_load else (rows.s + c) / n - rows.j)


@dataclass(frozen=True)
class LawForm:
    """P laws of any kind; None for parameters that define none."""

    laws: tuple[ContactLaw | None, ...]

    def __len__(self) -> int:
        return len(self.laws)

    def log_ratio(self, candidate: int, rows: Samples, of_load: bool = False) -> FloatArray:
        """Return ln(δ_law/δ_reference) of each sample at equal load, or that of the loads."""
        law = self.laws[candidate]
        if law is None:
            return np.full_like(rows.s, np.nan)
        if of_load:
            return as_floats(np.log(law.load(rows.penetration, rows.pair)) - rows.s)
        return as_floats(np.log(law.penetration(rows.load, rows.pair)) - rows.j)


Form = PowerForm | LawForm


def form_of(model: LawModel, candidates: FloatArray, dR: FloatArray) -> Form:
    """Return candidates of a model, shape (P, k), at clearances ΔR in mm, shape (m,)."""
    if model.power_form is None:
        return LawForm(tuple(built(model, row) for row in candidates))
    K_star, n = model.power_form(candidates, dR)
    K_star = np.where(K_star > 0, K_star, np.nan)
    return PowerForm(
        c=as_floats(np.log(dR) - np.log(K_star)), n=as_floats(np.where(n > 0, n, np.nan))
    )


# The polish of a largest magnitude sees the extremes of at least this many groups of samples.
_GROUPS = 400
# Step of the log ratio for the derivative of a deviation.
_STEP = 1e-6


@dataclass(frozen=True)
class RmsLogPenetration:
    """Root mean square of ln(δ_law/δ_reference), from moments alone."""

    moments: Moments

    @property
    def dR(self) -> FloatArray:
        """The clearances in mm, shape (m,)."""
        return self.moments.dR

    @property
    def size(self) -> int:
        """The number of residuals, q."""
        return 2 * self.dR.size

    def values(self, form: Form) -> FloatArray:
        """Return the objective of P candidates, shape (P,)."""
        with np.errstate(over="ignore"):
            level, tilt = self._parts(form)
            squares = (level**2 + tilt**2).sum(axis=-1)
        return _or_inf(np.sqrt(squares + self.bound**2))

    def residuals(self, form: Form) -> FloatArray:
        """Return residuals whose squares add up to those of the objective less the bound."""
        level, tilt = self._parts(form)
        return np.concatenate([level, tilt], axis=1)

    def slopes(self, form: PowerForm, d_log_K: FloatArray, dn: FloatArray) -> FloatArray:
        """Return the derivatives of the residuals by k parameters from those of ln K* and n."""
        level_weight, tilt_weight, _ = self._constants
        u = 1 / form.n
        mean = level_weight * u * u * (self.moments.mean_s + form.c)
        slopes = np.empty((*dn.shape[:-1], self.size))
        level, tilt = slopes[..., : dn.shape[-1]], slopes[..., dn.shape[-1] :]
        np.multiply(-mean[:, None], dn, out=level)
        level -= (level_weight * u)[:, None] * d_log_K
        np.multiply((-tilt_weight * u * u)[:, None], dn, out=tilt)
        return slopes

    @cached_property
    def bound(self) -> float:
        """The residual of the least-squares lines of j on s, one for each clearance."""
        return float(np.sqrt(self.moments.unexplained.sum() / self.moments.total))

    def _parts(self, form: Form) -> tuple[FloatArray, FloatArray]:
        """Return the mean of the residuals at each ΔR, and their part linear in s."""
        if not isinstance(form, PowerForm):
            raise TypeError("moments carry power laws only; use rows")
        m = self.moments
        level_weight, tilt_weight, slope = self._constants
        level = level_weight * ((m.mean_s + form.c) / form.n - m.mean_j)
        tilt = tilt_weight * (1 / form.n - slope)
        return as_floats(level), as_floats(tilt)

    @cached_property
    def _constants(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The moments as every evaluation needs them: two weights and the best 1/n."""
        m = self.moments
        return np.sqrt(m.count / m.total), np.sqrt(m.ss / m.total), m.slope


@dataclass(frozen=True)
class OnRows(ABC):
    """An objective on rows, evaluated for one candidate after the other."""

    rows: Samples
    # Whether loads are compared at equal penetration rather than penetrations at equal load.
    of_load: bool = False

    @property
    def dR(self) -> FloatArray:
        """The clearances in mm, shape (m,)."""
        return self.rows.dR

    def values(self, form: Form) -> FloatArray:
        """Return the objective of P candidates, shape (P,)."""
        with np.errstate(over="ignore"):
            return _or_inf(np.array([self._value(ratio) for ratio in self.log_ratios(form)]))

    def residuals(self, form: Form) -> FloatArray:
        """Return the residuals for the polish, shape (P, q)."""
        with np.errstate(over="ignore"):
            return np.array([self._residuals(ratio) for ratio in self.log_ratios(form)])

    @property
    @abstractmethod
    def bound(self) -> float:
        """The per-clearance lower bound for power laws."""

    def log_ratios(self, form: Form) -> Iterator[FloatArray]:
        """Yield the log of the ratio of loads or penetrations of each candidate, shape (N,)."""
        return (form.log_ratio(k, self.rows, self.of_load) for k in range(len(form)))

    @abstractmethod
    def _value(self, log_ratio: FloatArray) -> float: ...

    @abstractmethod
    def _residuals(self, log_ratio: FloatArray) -> FloatArray: ...


@dataclass(frozen=True)
class RootMeanSquare(OnRows):
    """Root mean square of a deviation: of the log ratio, or of `factor` times Eq 9."""

    factor: float | None = None

    @property
    def size(self) -> int:
        """The number of residuals, q."""
        return self.rows.s.size

    def deviation(self, log_ratio: FloatArray) -> FloatArray:
        """Return the deviation that is squared."""
        return log_ratio if self.factor is None else as_floats(self.factor * np.expm1(log_ratio))

    @cached_property
    def bound(self) -> float:
        """The objective with the best line at each clearance."""
        squares = [self._best_line(s, j) for s, j in self.rows.clearances()]
        return float(np.sqrt(sum(squares) / self.rows.s.size))

    def _value(self, log_ratio: FloatArray) -> float:
        return float(np.sqrt(np.mean(self.deviation(log_ratio) ** 2)))

    def _residuals(self, log_ratio: FloatArray) -> FloatArray:
        # Over √N, their squares add up to the objective's.
        return as_floats(self.deviation(log_ratio) / np.sqrt(log_ratio.size))

    def slopes(self, form: PowerForm, d_log_K: FloatArray, dn: FloatArray) -> FloatArray:
        """Return the derivatives of the residuals by k parameters from those of ln K* and n."""
        rows, u = self.rows, 1 / form.n
        du = -((u**2)[:, None]) * dn
        if self.of_load:
            level, tilt, at = d_log_K, dn, rows.j
        else:
            level, tilt, at = form.c[:, None] * du - d_log_K * u[:, None], du, rows.s
        log_ratio = np.array(list(self.log_ratios(form)))
        ahead, behind = (self.deviation(log_ratio + step) for step in (_STEP, -_STEP))
        weight = (ahead - behind) / (2 * _STEP * np.sqrt(at.size))
        return as_floats(weight[:, None] * (level[..., rows.index] + tilt[..., rows.index] * at))

    def _best_line(self, s: FloatArray, j: FloatArray) -> float:
        if np.ptp(s) == 0:
            return 0.0  # samples at one s are one point
        x, y = (j - j.mean(), s) if self.of_load else (s - s.mean(), j)

        def residuals(line: FloatArray) -> FloatArray:
            return self.deviation(line[0] + line[1] * x - y)

        slope, level = np.polyfit(x, y, 1)
        start = np.array([level, slope])
        return float(2 * least_squares(residuals, start, method="lm", xtol=1e-12).cost)


@dataclass(frozen=True)
class Largest(OnRows):
    """Largest magnitude of a relative deviation, in percent."""

    @cached_property
    def bound(self) -> float:
        """From the widest of the narrowest strips around the samples of each clearance.

        A strip of half-width w in the log ratio is best placed if exp(w₊) − 1 = 1 − exp(w₋) with
        w₊ − w₋ = 2w. The largest magnitude is then tanh w.
        """
        widths = []
        for s, j in self.rows.clearances():
            x, y = (j, s) if self.of_load else (s, j)
            lines = np.column_stack([x - x.mean(), np.ones_like(x)])
            widths.append(least_largest(y.mean() - y, lines, [(None, None)] * 2)[1])
        return float(100 * np.tanh(max(widths)))

    def _value(self, log_ratio: FloatArray) -> float:
        return float(100 * np.abs(np.expm1(log_ratio)).max())

    def _residuals(self, log_ratio: FloatArray) -> FloatArray:
        # Fractions; the largest and smallest of each group represent it.
        ratio = np.expm1(log_ratio)
        extremes = [ufunc.reduceat(ratio, self._groups) for ufunc in (np.maximum, np.minimum)]
        return np.concatenate(extremes)

    @cached_property
    def _groups(self) -> IndexArray:
        """Start indices of groups of neighbouring samples, each within one clearance."""
        even = np.linspace(0, self.rows.s.size, _GROUPS, endpoint=False).astype(np.intp)
        return np.union1d(even, self.rows.starts)


def _or_inf(values: FloatArray) -> FloatArray:
    return np.where(np.isfinite(values), values, np.inf)


def least_largest(
    residuals: FloatArray, slopes: FloatArray, bounds: Sequence[tuple[float | None, float | None]]
) -> tuple[FloatArray, float]:
    """Minimise max|residuals + slopes·step| within bounds; return the step and that largest."""
    minus_t = -np.ones((residuals.size, 1))
    solution = linprog(
        np.append(np.zeros(len(bounds)), 1.0),
        A_ub=np.block([[slopes, minus_t], [-slopes, minus_t]]),
        b_ub=np.concatenate([-residuals, residuals]),
        bounds=[*bounds, (0.0, None)],
    )
    if solution.x is None:  # numerically infeasible
        return np.zeros(len(bounds)), float(np.abs(residuals).max())
    return as_floats(solution.x[:-1]), float(solution.x[-1])


Objective = RmsLogPenetration | OnRows

ON_ROWS: dict[str, Callable[[Samples], Objective]] = {
    "rms-difference-percent": partial(RootMeanSquare, factor=100.0),
    "max-difference-percent": Largest,
    "rms-relative-force": partial(RootMeanSquare, of_load=True, factor=1.0),
    "max-relative-force-percent": partial(Largest, of_load=True),
}
OBJECTIVES = ("rms-log-penetration", *ON_ROWS)


def make_objective(objective: str, data: Moments | Samples) -> Objective:
    """Return the named objective on its data; moments are for rms-log-penetration only."""
    if isinstance(data, Moments):
        return RmsLogPenetration(data)
    return ON_ROWS.get(objective, RootMeanSquare)(data)


def max_abs_difference_percent(
    grid: Grid,
    model: LawModel,
    candidates: Sequence[Mapping[str, float]],
    jobs: Workers = 1,
    progress: Callable[[int], None] | None = None,
) -> FloatArray:
    """Return the largest |Eq 9| in percent over a grid for each of P coefficient sets.

    The grid is sampled block by block, by `jobs` threads. `progress` is called with the number of
    clearances done.
    """
    points = model.candidates(*candidates)
    work = [call(_at_clearance, grid, model, points, float(dR)) for dR in grid.dR]
    worst = np.zeros(len(candidates))
    with closing(run_calls(work, jobs, threads=True)) as results:
        for done, at_clearance in enumerate(results, start=1):
            worst = np.maximum(worst, at_clearance)
            if progress is not None:
                progress(done)
    return 100 * worst


def _at_clearance(grid: Grid, model: LawModel, points: FloatArray, dR: float) -> FloatArray:
    """Return the largest |Eq 9| at one ΔR, as a fraction, shape (P,)."""
    low, high = np.zeros(len(points)), np.zeros(len(points))
    for ratios in log_ratios_at(grid, model, points, dR):
        low = np.fmin(low, np.fmin.reduce(ratios, axis=1, initial=0.0))
        high = np.fmax(high, np.fmax.reduce(ratios, axis=1, initial=0.0))
    # Eq 9 increases with the log ratio, so only the extremes are exponentiated.
    return as_floats(np.maximum(np.expm1(high), -np.expm1(low)))


def log_ratios_at(
    grid: Grid, model: LawModel, points: FloatArray, dR: float
) -> Iterator[FloatArray]:
    """Yield ln(δ_law/δ_reference) of P candidates at one ΔR, by blocks of samples."""
    form = form_of(model, points, np.array([dR]))
    for block in blocks(grid, dR):
        index = np.zeros(block.load.size, dtype=np.intp)
        rows = Samples(grid.contact, np.array([dR]), index, block.s, block.j)
        yield np.array([form.log_ratio(k, rows) for k in range(len(points))])


# Numbers in an array of candidates by data; of more candidates some at a time are evaluated.
_AT_ONCE = 1 << 22


@dataclass(frozen=True, eq=False)
class Problem(ParameterSpace):
    """Fit a law to a law: minimise an objective on a grid over the free parameters."""

    objective: Objective

    def values(self, points: FloatArray) -> FloatArray:
        """Return the objective of P points of the free parameters, shape (P, k) to (P,)."""
        at_once = max(1, _AT_ONCE // self.objective.dR.size)
        if len(points) <= at_once:
            return self.objective.values(self.form(points))
        parts = [points[first : first + at_once] for first in range(0, len(points), at_once)]
        return np.concatenate([self.values(part) for part in parts])

    def residuals(self, points: FloatArray) -> FloatArray:
        """Return the objective's residuals of P points, shape (P, k) to (P, q)."""
        return self.objective.residuals(self.form(points))

    def form(self, points: FloatArray) -> Form:
        """Return the laws at P points of the free parameters, shape (P, k)."""
        with np.errstate(all="ignore"):  # what is not finite lies outside the law
            return form_of(self.model, self.complete(points), self.objective.dR)

    def value_of(self, coefficients: Mapping[str, float]) -> float:
        """Return the objective of coefficients by name, which may be outside the bounds."""
        form = form_of(self.model, self.model.candidates(coefficients), self.objective.dR)
        return float(self.objective.values(form)[0])
