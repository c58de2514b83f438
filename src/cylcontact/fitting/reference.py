"""A law fitted to samples of another law: by their moments, or by the samples themselves.

The deviation is r = ln(δ_law/δ_reference) at equal load, or ln(f_law/f_reference) at equal
penetration. A law that is a power law at each clearance, f = K*(ΔR)·E*/ΔR·δ^n(ΔR), has
r = (s + c)/n − j with s = ln(f/E*), j = ln δ_reference and c = ln ΔR − ln K*, and −n·r for loads.
Its sum of squares follows from the moments of the samples. Other laws and objectives take the
samples themselves.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from cylcontact.bodies.material import material_in_MPa
from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.datasets.grid import Grid
from cylcontact.datasets.moments import Moments
from cylcontact.datasets.sampling import blocks, require_samples
from cylcontact.fitting.parameters import LawModel
from cylcontact.fitting.space import Space, central_differences, law_of
from cylcontact.laws.law import ContactLaw
from cylcontact.support.arrays import FloatArray, IndexArray, as_floats
from cylcontact.support.parallel import Workers, call, run_calls
from cylcontact.support.progress import Progress, silent

# Whether loads are compared at equal penetration, the factor of the relative deviation (None for
# its logarithm), and whether its largest magnitude counts.
OBJECTIVES: dict[str, tuple[bool, float | None, bool]] = {
    "rms-log-penetration": (False, None, False),
    "rms-difference-percent": (False, 100.0, False),
    "max-difference-percent": (False, 100.0, True),
    "rms-relative-force": (True, 1.0, False),
    "max-relative-force-percent": (True, 100.0, True),
}
# With E = 2 MPa and ν = 0 the composite modulus is 1 MPa.
_UNIT = material_in_MPa("of unit composite modulus", 2.0, 0.0)
# Numbers in an array of points by clearances; of more points some at a time are evaluated.
_AT_ONCE = 1 << 22
# A descent to a largest deviation sees the extremes of about so many groups of samples.
_GROUPS = 400
# Step of the logarithm of the ratio for the derivative of a deviation.
_STEP = 1e-6


class PowerLaws(NamedTuple):
    """P power laws at m clearances: c = ln ΔR − ln K* and n, NaN where K* or n is not positive."""

    c: FloatArray
    n: FloatArray


def power_laws(model: LawModel, candidates: FloatArray, dR: FloatArray) -> PowerLaws:
    """Return candidates of a model that has a power form, shape (P, all), at clearances in mm."""
    assert model.power_form is not None
    with np.errstate(all="ignore"):  # what is not finite lies outside the law
        K_star, n = model.power_form(candidates, dR)
        c = np.log(dR) - np.log(np.where(K_star > 0, K_star, np.nan))
    return PowerLaws(as_floats(c), as_floats(np.where(n > 0, n, np.nan)))


@dataclass(frozen=True, eq=False)
class Samples:
    """N samples of a reference law, sorted by clearance and, within one, by load over E*."""

    contact: Contact
    # The m clearances in mm.
    dR: FloatArray
    # Of each sample its clearance, ln(f/E*) and ln δ.
    index: IndexArray
    s: FloatArray
    j: FloatArray

    @classmethod
    def of(cls, grid: Grid) -> Samples:
        """Sample a grid into memory, without clearances that are masked completely."""
        sampled = [
            (np.full(block.load.size, k), block.s, block.j)
            for k, dR in enumerate(grid.dR)
            for block in blocks(grid, float(dR))
        ]
        of_clearance, s, j = map(np.concatenate, zip(*sampled, strict=True))
        require_samples(grid, s.size)
        order = np.lexsort((s, of_clearance))
        inside, index = np.unique(of_clearance[order], return_inverse=True)
        return cls(
            contact=grid.contact,
            dR=grid.dR[inside],
            index=index,
            s=s[order],
            j=j[order],
        )

    @cached_property
    def pair(self) -> CylinderPair:
        """The pair of each sample with E* = 1 MPa, so that its load is f/E*."""
        return CylinderPair.from_dR(self.contact, self.dR[self.index], _UNIT)

    @cached_property
    def load(self) -> FloatArray:
        """Loads over the composite modulus, in mm."""
        return np.asarray(np.exp(self.s))

    @cached_property
    def penetration(self) -> FloatArray:
        """Penetrations of the reference in mm."""
        return np.asarray(np.exp(self.j))

    def log_ratio(self, law: ContactLaw | None, of_load: bool = False) -> FloatArray:
        """Return ln(δ_law/δ_reference) of each sample at equal load, or that of the loads."""
        if law is None:
            return np.full_like(self.s, np.nan)
        if of_load:
            return as_floats(np.log(law.load(self.penetration, self.pair)) - self.s)
        return as_floats(np.log(law.penetration(self.load, self.pair)) - self.j)

    def log_ratios(
        self, model: LawModel, candidates: FloatArray, of_load: bool = False
    ) -> Iterator[FloatArray]:
        """Yield `log_ratio` for each of P candidates of a model."""
        if model.power_form is None:
            yield from (self.log_ratio(law_of(model, row), of_load) for row in candidates)
            return
        for c, n in zip(*power_laws(model, candidates, self.dR), strict=True):
            at, exponent = c[self.index], n[self.index]
            yield exponent * self.j - at - self.s if of_load else (self.s + at) / exponent - self.j


@dataclass(frozen=True, eq=False)
class OfLaw(Space):
    """What the two spaces have in common: slopes of power laws by formula."""

    def _with_slopes(
        self, points: FloatArray, dR: FloatArray
    ) -> tuple[PowerLaws, FloatArray, FloatArray]:
        """Return power laws, and the slopes of ln K* and n, (P, k, m)."""
        assert self.model.slope_form is not None
        with np.errstate(all="ignore"):
            log_K, n, *by_all = self.model.slope_form(self.complete(points), dR)
            laws = PowerLaws(np.log(dR) - log_K, np.where(n > 0, n, np.nan))
        if any(p.tie for p in self.parameters):
            ties = central_differences(self.complete, self.low, self.high, points)
            by_free = [as_floats(ties @ each) for each in by_all]
        else:
            is_free = [p.is_free for p in self.parameters]
            by_free = [each if all(is_free) else each[:, is_free] for each in by_all]
        d_log_K, dn = by_free
        return laws, d_log_K, dn


@dataclass(frozen=True, eq=False)
class OnMoments(OfLaw):
    """The root mean square of ln(δ_law/δ_reference) of power laws, from moments alone."""

    moments: Moments

    @cached_property
    def bound(self) -> float:
        """The objective with the best K* and n at each ΔR, a lower bound for every such law."""
        return float(np.sqrt(self.moments.unexplained.sum() / self.moments.total))

    @property
    def in_batches(self) -> bool:
        """They do."""
        return True

    def residuals(self, points: FloatArray) -> FloatArray:
        """Return residuals whose squares add up to those of the objective less the bound."""
        return self._residuals(power_laws(self.model, self.complete(points), self.moments.dR))

    def values(self, points: FloatArray) -> FloatArray:
        """Return the objective of P points, shape (P,); inf if undefined."""
        some = max(1, _AT_ONCE // self.moments.dR.size)
        starts = range(0, len(points), some)
        parts = [super(OnMoments, self).values(points[k : k + some]) for k in starts]
        return as_floats(np.hypot(np.concatenate(parts), self.bound))

    def linearised(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the residuals and their derivatives, by formula if the law has one."""
        if self.model.slope_form is None:
            return super().linearised(points)
        laws, d_log_K, dn = self._with_slopes(points, self.moments.dR)
        level_weight, tilt_weight, _ = self._constants
        u = 1 / laws.n
        mean = level_weight * u * u * (self.moments.mean_s + laws.c)
        slopes = np.empty((*dn.shape[:-1], 2 * dn.shape[-1]))
        level, tilt = slopes[..., : dn.shape[-1]], slopes[..., dn.shape[-1] :]
        np.multiply(-mean[:, None], dn, out=level)
        level -= (level_weight * u)[:, None] * d_log_K
        np.multiply((-tilt_weight * u * u)[:, None], dn, out=tilt)
        return self._residuals(laws), slopes

    def _residuals(self, laws: PowerLaws) -> FloatArray:
        """Return the mean of r at each ΔR, and its part linear in s."""
        m = self.moments
        level_weight, tilt_weight, slope = self._constants
        with np.errstate(over="ignore", invalid="ignore"):
            level = level_weight * ((m.mean_s + laws.c) / laws.n - m.mean_j)
            return np.concatenate([level, tilt_weight * (1 / laws.n - slope)], axis=1)

    @cached_property
    def _constants(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The moments as every evaluation needs them: two weights and the best 1/n."""
        m = self.moments
        return np.sqrt(m.count / m.total), np.sqrt(m.ss / m.total), m.slope


@dataclass(frozen=True, eq=False)
class OnSamples(OfLaw):
    """Any objective of any law, on the samples of a reference law."""

    objective: str
    samples: Samples

    @property
    def is_largest(self) -> bool:  # type: ignore[override]
        """Whether the largest deviation counts."""
        return OBJECTIVES[self.objective][2]

    def residuals(self, points: FloatArray) -> FloatArray:
        """Return residuals whose squares add up to the objective's, or the extremes of groups."""
        if self.is_largest:
            return np.array([self._extremes(each) for each in self._deviations(points)])
        deviations = np.array([*self._deviations(points)])
        return as_floats(deviations / np.sqrt(self.samples.s.size))

    def values(self, points: FloatArray) -> FloatArray:
        """Return the objective of P points, shape (P,); inf if undefined."""
        with np.errstate(over="ignore", invalid="ignore"):
            values = np.array(
                [
                    np.abs(each).max() if self.is_largest else np.sqrt(np.mean(each**2))
                    for each in self._deviations(points)
                ]
            )
        return np.where(np.isfinite(values), values, np.inf)

    def linearised(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the residuals and their derivatives, by formula if the law has one."""
        if self.model.slope_form is None or self.is_largest:
            return super().linearised(points)
        of_load, at = OBJECTIVES[self.objective][0], self.samples.index
        (c, n), d_log_K, dn = self._with_slopes(points, self.samples.dR)
        if of_load:
            level, tilt, x = d_log_K, dn, self.samples.j
            ratio = n[:, at] * self.samples.j - c[:, at] - self.samples.s
        else:
            du = -dn / n[:, None] ** 2
            level, tilt, x = c[:, None] * du - d_log_K / n[:, None], du, self.samples.s
            ratio = (self.samples.s + c[:, at]) / n[:, at] - self.samples.j
        root = np.sqrt(x.size)
        weight = (self._deviation(ratio + _STEP) - self._deviation(ratio - _STEP)) / (
            2 * _STEP * root
        )
        slopes = weight[:, None] * (level[..., at] + tilt[..., at] * x)
        return self._deviation(ratio) / root, as_floats(slopes)

    def _deviations(self, points: FloatArray) -> Iterator[FloatArray]:
        """Yield the deviation of each sample, shape (N,), for each of P points."""
        candidates, of_load = self.complete(points), OBJECTIVES[self.objective][0]
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            for ratio in self.samples.log_ratios(self.model, candidates, of_load):
                yield self._deviation(ratio)

    def _deviation(self, log_ratio: FloatArray) -> FloatArray:
        factor = OBJECTIVES[self.objective][1]
        return log_ratio if factor is None else as_floats(factor * np.expm1(log_ratio))

    def _extremes(self, deviation: FloatArray) -> FloatArray:
        """Return the largest and the smallest of each group, as fractions."""
        ends = (ufunc.reduceat(deviation, self._groups) for ufunc in (np.maximum, np.minimum))
        return np.concatenate([*ends]) / 100

    @cached_property
    def _groups(self) -> IndexArray:
        """Start indices of groups of neighbouring samples, each within one clearance."""
        even = np.linspace(0, self.samples.s.size, _GROUPS, endpoint=False).astype(np.intp)
        starts = np.searchsorted(self.samples.index, np.arange(self.samples.dR.size))
        return np.union1d(even, starts)


# --- the largest difference over a grid ---------------------------------------------------------


def max_abs_difference_percent(
    grid: Grid,
    model: LawModel,
    candidates: Sequence[Mapping[str, float]],
    jobs: Workers = 1,
    progress: Progress = silent,
) -> FloatArray:
    """Return the largest |Eq 9| in percent over a grid for each of P coefficient sets.

    The grid is sampled block by block, by `jobs` threads.
    """
    points = model.candidates(*candidates)
    work = [call(_largest_at, grid, model, points, float(dR)) for dR in grid.dR]
    worst = np.zeros(len(candidates))
    progress("comparing", 0, len(work))
    with closing(run_calls(work, jobs, threads=True)) as results:
        for done, at_clearance in enumerate(results, start=1):
            worst = np.maximum(worst, at_clearance)
            progress("comparing", done, len(work))
    return 100 * worst


def _largest_at(grid: Grid, model: LawModel, points: FloatArray, dR: float) -> FloatArray:
    """Return the largest |Eq 9| at one ΔR, as a fraction, shape (P,)."""
    low, high = np.zeros(len(points)), np.zeros(len(points))
    for block in blocks(grid, dR):
        index = np.zeros(block.load.size, dtype=np.intp)
        samples = Samples(grid.contact, np.array([dR]), index, block.s, block.j)
        for k, ratio in enumerate(samples.log_ratios(model, points)):
            low[k] = np.fmin(low[k], np.fmin.reduce(ratio, initial=0.0))
            high[k] = np.fmax(high[k], np.fmax.reduce(ratio, initial=0.0))
    # Eq 9 increases with the log ratio, so only the extremes are exponentiated.
    return as_floats(np.maximum(np.expm1(high), -np.expm1(low)))
