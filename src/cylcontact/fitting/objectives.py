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

from cylcontact.arrays import FloatArray, IndexArray, as_floats
from cylcontact.datasets.grid import AnyGrid, DimensionlessGrid
from cylcontact.datasets.moments import Moments
from cylcontact.datasets.sampling import Block, Counts, blocks, reduce_grid
from cylcontact.fitting.problem import ParameterSpace, built
from cylcontact.laws.law import ContactLaw, LawModel
from cylcontact.materials import material_in_MPa
from cylcontact.pair import Contact, CylinderPair
from cylcontact.parallel import Workers, call, run_calls

# With E = 2 MPa and ν = 0 the composite modulus is 1 MPa.
_UNIT = material_in_MPa("of unit composite modulus", 2.0, 0.0)


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples sorted by clearance and, within one, by s."""

    contact: Contact
    # The m clearances in mm.
    dR: FloatArray
    # Of each of N samples its clearance, ln(f/E*) and ln δ, and on a dimensionless grid α and β.
    index: IndexArray
    s: FloatArray
    j: FloatArray
    dundurs: tuple[FloatArray, FloatArray] | None = None

    @cached_property
    def pair(self) -> CylinderPair:
        """The pair of each sample with E* = 1, so that its load is f/E*, in mm."""
        if self.dundurs is not None:
            return CylinderPair.from_dundurs(*self.dundurs)
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


def samples_of(grid: AnyGrid, block: Block) -> Samples:
    """Return one block of samples as rows."""
    index = np.zeros(block.load.size, dtype=np.intp)
    dundurs = block.row_values if isinstance(grid, DimensionlessGrid) else None
    return Samples(grid.contact, np.array([block.dR]), index, block.s, block.j, dundurs)


def collect_samples(grid: AnyGrid) -> tuple[Samples, Counts]:
    """Sample a grid into memory, without clearances that are masked completely."""
    clearances: list[tuple[float, FloatArray, FloatArray]] = []
    masked, dundurs = 0, None
    for dR in grid.dR:
        sampled = list(blocks(grid, float(dR)))
        masked += sum(block.masked for block in sampled)
        s = np.concatenate([block.s for block in sampled])
        j = np.concatenate([block.j for block in sampled])
        order = np.argsort(s, kind="stable")
        if s.size:
            clearances.append((float(dR), s[order], j[order]))
        if isinstance(grid, DimensionlessGrid):  # of one clearance
            alpha, beta = (np.concatenate([b.row_values[k] for b in sampled]) for k in (0, 1))
            dundurs = alpha[order], beta[order]
    if not clearances:
        reduce_grid(grid)  # raises the error that names the reason
    rows = Samples(
        contact=grid.contact,
        dR=np.array([dR for dR, _, _ in clearances]),
        index=np.repeat(np.arange(len(clearances)), [s.size for _, s, _ in clearances]),
        s=np.concatenate([s for _, s, _ in clearances]),
        j=np.concatenate([j for _, _, j in clearances]),
        dundurs=dundurs,
    )
    return rows, Counts(rows.s.size, masked)


@dataclass(frozen=True)
class PowerForm:
    """P power laws at m clearances: c = ln ΔR − ln K* and n, NaN where K* or n is not positive."""

    c: FloatArray
    n: FloatArray

    def __len__(self) -> int:
        return len(self.n)

    def log_penetration_ratio(self, candidate: int, rows: Samples) -> FloatArray:
        """Return r = (s + c)/n − j of each sample."""
        c, n = self.c[candidate][rows.index], self.n[candidate][rows.index]
        return as_floats((rows.s + c) / n - rows.j)

    def log_load_ratio(self, candidate: int, rows: Samples) -> FloatArray:
        """Return n·j − c − s = −n·r of each sample."""
        c, n = self.c[candidate][rows.index], self.n[candidate][rows.index]
        return as_floats(n * rows.j - c - rows.s)


@dataclass(frozen=True)
class LawForm:
    """P laws of any kind; None for parameters that define none."""

    laws: tuple[ContactLaw | None, ...]

    def __len__(self) -> int:
        return len(self.laws)

    def log_penetration_ratio(self, candidate: int, rows: Samples) -> FloatArray:
        """Return ln(δ_law/δ_reference) of each sample at equal load."""
        law = self.laws[candidate]
        if law is None:
            return np.full_like(rows.s, np.nan)
        return as_floats(np.log(law.penetration(rows.load, rows.pair)) - rows.j)

    def log_load_ratio(self, candidate: int, rows: Samples) -> FloatArray:
        """Return ln(f_law/f_reference) of each sample at equal penetration."""
        law = self.laws[candidate]
        if law is None:
            return np.full_like(rows.s, np.nan)
        return as_floats(np.log(law.load(rows.penetration, rows.pair)) - rows.s)


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
        log_ratio = form.log_load_ratio if self.of_load else form.log_penetration_ratio
        return (log_ratio(candidate, self.rows) for candidate in range(len(form)))

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

        A strip of width w in the log ratio is best placed if exp(w₊) − 1 = 1 − exp(w₋) with
        w₊ − w₋ = w. The largest magnitude is then tanh(w/2).
        """
        points = self.rows.clearances()
        widths = [_strip_width(j, s) if self.of_load else _strip_width(s, j) for s, j in points]
        return float(100 * np.tanh(max(widths) / 2))

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


def _strip_width(s: FloatArray, j: FloatArray) -> float:
    """Return the extent in j of the narrowest strip around the points (s, j).

    The strip is j = p·s + q ± w/2; the linear programme finds p, q and w.
    """
    x, y = s - s.mean(), j - j.mean()
    ones = np.ones_like(x)
    above = np.column_stack([-x, -ones, -ones / 2])
    below = np.column_stack([x, ones, -ones / 2])
    solution = linprog(
        [0, 0, 1],
        A_ub=np.vstack([above, below]),
        b_ub=np.concatenate([-y, y]),
        bounds=[(None, None), (None, None), (0, None)],
    )
    if solution.x is None:
        raise ArithmeticError(f"the narrowest strip was not found: {solution.message}")
    return float(solution.x[2])


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
    grid: AnyGrid,
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


def _at_clearance(grid: AnyGrid, model: LawModel, points: FloatArray, dR: float) -> FloatArray:
    """Return the largest |Eq 9| at one ΔR, as a fraction, shape (P,).

    Eq 9 increases with the log ratio, so only the extremes are exponentiated.
    """
    low, high = np.zeros(len(points)), np.zeros(len(points))
    form = form_of(model, points, np.array([dR]))
    for block in blocks(grid, dR):
        rows = samples_of(grid, block)
        for k in range(len(points)):
            ratio = form.log_penetration_ratio(k, rows)
            low[k] = np.fmin.reduce(ratio, initial=low[k])
            high[k] = np.fmax.reduce(ratio, initial=high[k])
    return as_floats(np.maximum(np.expm1(high), -np.expm1(low)))


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
