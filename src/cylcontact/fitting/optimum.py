"""A fit to readings at its best parameters: their covariance, intervals, and predictions.

With residuals r and J their derivatives by the free parameters at the optimum, least squares has
the covariance s²·(JᵀJ)⁻¹, where s² is 1 if the standard deviations are known and Σr²/(N − k) if
not. With a noise model r are in standard deviations, s² is 1, and the degrees of freedom are
Satterthwaite's (`noise`).

A profile fixes a parameter and refits the others. The likelihood ratio to the optimum is
(S(θ) − S)/τ if the noise is Gaussian. An interval or region holds the values for which it stays
below the quantile of χ² (standard deviations known) or of F (not known). Unlike an interval from
the covariance it follows the curvature of the law.

Bands are from the delta method in ln f, and in ln δ if the noise is proportional, since contact
laws are nearly linear there; in δ otherwise, where readings may be negative. The variance of the
curve is gᵀCg with g the derivatives by the free parameters and C their covariance. A new reading
adds the noise, with random effects that of a series not yet measured.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import special
from scipy.optimize import brentq

from cylcontact.bodies.pair import CylinderPair
from cylcontact.fitting.measured import Fit
from cylcontact.fitting.noise import Degrees, Likelihood
from cylcontact.fitting.records import Interval
from cylcontact.laws.law import Coefficients, ContactLaw
from cylcontact.support.arrays import FloatArray, as_floats
from cylcontact.support.errors import InputError

# Smaller residuals are round-off: the data have no noise.
ROUNDING = 1e-11
# Below this ratio a profile found a better optimum; it is not round-off.
BETTER = -1e-6
# A direction with a smaller singular value, relative to the largest, is not identifiable; it
# involves the parameters with at least this fraction of its largest component.
_BLIND, _INVOLVED = 1e-7, 0.1
# Precision of an interval's ends relative to the distance from the optimum, the first step towards
# an end relative to the distance to the bound, and the largest rise that counts.
_EDGE_PRECISION, _FIRST_STEP, _FAR = 1e-4, 1e-6, 1e6
# Closer to a bound than this, relative to its interval, a parameter is at it.
_AT_BOUND = 1e-9
# Half-widths of the interval on either side of the optimum in a profile, and the values there.
_REACH, _POINTS = 1.6, 21
# In place of a predicted reading of 0 mm, to which an error is relative.
_NO_DEPTH = 1e-12


class Band(NamedTuple):
    """A predicted curve in mm, with the bands of the curve and of a new reading, shape (m,)."""

    value: FloatArray
    low: FloatArray
    high: FloatArray
    new_low: FloatArray
    new_high: FloatArray


@dataclass(frozen=True, eq=False)
class Optimum:
    """A fit with k free parameters to N readings, at its best point."""

    fit: Fit
    point: FloatArray

    @classmethod
    def of(cls, fit: Fit, best: Mapping[str, float]) -> Optimum:
        """Return the optimum of coefficients by name."""
        return cls(fit, fit.point(best))

    @cached_property
    def best(self) -> dict[str, float]:
        """All coefficients, by name."""
        return self.fit.coefficients(self.point)

    @cached_property
    def law(self) -> ContactLaw:
        """The fitted law, with the rig."""
        law = self.fit.law(self.point)
        if law is None:
            raise TypeError("the law is undefined at the best parameters")
        return law

    # --- the residuals ------------------------------------------------------------------------

    @cached_property
    def r(self) -> FloatArray:
        """The residuals with σ, shape (N,)."""
        return as_floats(self.fit.raw(self.point[None, :])[0])

    @cached_property
    def differences(self) -> FloatArray:
        """The fitted less the measured penetrations in mm, shape (N,)."""
        return as_floats(self.fit.differences(self.point[None, :])[0])

    @cached_property
    def slopes(self) -> FloatArray:
        """The derivatives of r by the free parameters, shape (N, k)."""
        return self.fit.jacobian(self.point, self.fit.raw)

    @property
    def known(self) -> bool:
        """Whether the standard deviations were given with the data."""
        return self.fit.has_sigma

    @property
    def degrees(self) -> int:
        """Degrees of freedom, N − k."""
        return self.r.size - self.point.size

    @cached_property
    def sum_of_squares(self) -> float:
        """The minimum S of the sum of squares."""
        return float(self.r.size * self.fit.value(self.point) ** 2)

    @cached_property
    def sigma(self) -> float:
        """Standard deviation of r, √(Σr²/(N − k))."""
        return float(np.sqrt((self.r**2).sum() / self.degrees))

    @property
    def is_rounding(self) -> bool:
        """Whether the data follow the law to round-off, without noise."""
        return not self.known and self.sigma < ROUNDING

    @property
    def chi_square_p(self) -> float | None:
        """The probability of residuals this large; None if σ is not known."""
        if not self.known:
            return None
        return float(special.chdtrc(self.degrees, self.sum_of_squares))

    @cached_property
    def series(self) -> FloatArray | None:
        """The effects of each series, shape (G, q); None without series."""
        noise = self.fit.noise
        if noise is None or not noise.model.effects:
            return None
        return noise.series_effects(self.differences)

    @property
    def series_in_mm(self) -> FloatArray | None:
        """What its series adds to each reading in mm, shape (N,); None without series."""
        noise, effects = self.fit.noise, self.series
        if noise is None or effects is None:
            return None
        return as_floats((noise.columns * effects[noise.series]).sum(axis=1))

    # --- the covariance of the parameters -----------------------------------------------------

    @cached_property
    def likelihood(self) -> Likelihood | None:
        """The likelihood of the deviations of the noise model, if there is one."""
        noise = self.fit.noise
        return None if noise is None else self.fit.likelihood(self.point, noise)

    @cached_property
    def satterthwaite(self) -> Degrees | None:
        """Degrees of freedom with a noise model."""
        if self.likelihood is None or self.fit.noise is None:
            return None
        return Degrees.of(self.likelihood, self.fit.noise.deviations)

    @cached_property
    def _inverse(self) -> tuple[FloatArray | None, list[int]]:
        """(JᵀJ)⁻¹, or None and the columns of which only a combination is identifiable."""
        size = np.sqrt((self.slopes**2).sum(axis=0))
        scaled = self.slopes / np.where(size > 0, size, 1.0)
        _, singular, directions = np.linalg.svd(scaled, full_matrices=False)
        if singular[-1] <= _BLIND * singular[0]:
            component = np.abs(directions[-1])
            return None, [int(k) for k in np.flatnonzero(component >= _INVOLVED * component.max())]
        half = directions.T / singular
        return as_floats(half @ half.T / np.outer(size, size)), []

    @property
    def blind(self) -> list[str]:
        """The parameters of which only a combination is identifiable."""
        return [self.fit.names[k] for k in self._inverse[1]]

    @property
    def covariance(self) -> FloatArray | None:
        """Of the free parameters, shape (k, k); None if they are not all identifiable."""
        return self._unit_and_covariance[1]

    @property
    def unit(self) -> float:
        """τ, such that (S(θ) − S)/τ has a χ² or F distribution."""
        return self._unit_and_covariance[0]

    @cached_property
    def _unit_and_covariance(self) -> tuple[float, FloatArray | None]:
        inverse, _ = self._inverse
        if self.satterthwaite is not None:
            return 1.0, None if inverse is None else self.satterthwaite.covariance
        unit = 1.0 if self.known else self.sigma**2
        return unit, None if inverse is None else as_floats(inverse * unit)

    @property
    def errors(self) -> FloatArray:
        """The standard errors of the free parameters, shape (k,); NaN without a covariance."""
        if self.covariance is None:
            return np.full(self.point.size, np.nan)
        return as_floats(np.sqrt(np.maximum(np.diag(self.covariance), 0.0)))

    @cached_property
    def per_unit(self) -> FloatArray:
        """Factors from half-widths to relative ones, shape (k,): 1/|value|.

        For a shift, whose zero is arbitrary, the root mean square of the relative change of the
        predictions per unit of it.
        """
        observed = self.fit.observed
        rms = np.full_like(observed, np.sqrt((observed**2).mean()))
        size = observed if self.fit.is_log else rms
        moved = self.fit.jacobian(self.point, self.fit.differences) / size[:, None]
        effect = np.sqrt((moved**2).mean(axis=0))
        # Bounds on either side of zero make it arbitrary, whatever the law declares.
        is_shift = [p.shift or p.low < 0 < p.high for p in self.fit.free]
        with np.errstate(divide="ignore"):
            return as_floats(np.where(is_shift, effect, 1 / np.abs(self.point)))

    def degrees_of(self, contrasts: FloatArray) -> FloatArray:
        """Return the degrees of freedom of combinations, (..., k) to (...); inf if σ is known."""
        if self.satterthwaite is not None:
            return self.satterthwaite(contrasts)
        return np.full(contrasts.shape[:-1], np.inf if self.known else float(self.degrees))

    def degrees_of_each(self) -> FloatArray:
        """Return the degrees of freedom of each parameter, shape (k,)."""
        return self.degrees_of(np.eye(self.point.size))

    def threshold(self, level: float, names: Sequence[str]) -> float:
        """Return the largest (S(θ) − S)/τ within a region of this level in these parameters."""
        places = [self.fit.names.index(name) for name in names]
        number, degrees = len(places), float(self.degrees_of_each()[places].min())
        if np.isinf(degrees):
            return float(special.chdtri(number, 1 - level))
        return float(number * special.fdtri(number, degrees, level))

    @property
    def log_likelihood(self) -> float | None:
        """ln L of the readings in mm; None if all residuals are zero.

        They are readings whatever the residuals, so that fits with different noise can be compared.
        A standard deviation that is estimated has its value of largest likelihood, √(Σr²/N).
        """
        fit, r = self.fit, self.r
        if self.likelihood is not None and fit.noise is not None:
            return self.likelihood.log_likelihood(fit.noise.deviations)
        # From the residual to the reading: |dr/dy| = 1/y for logarithms, else 1/σ.
        size = np.abs(fit.observed) if fit.is_log else fit.sigma
        scale = -float(np.log(size).sum())
        variance = 1.0 if fit.has_sigma else float((r**2).mean())
        if variance == 0:
            return None
        squares = float((r**2).sum()) / variance
        return float(-0.5 * (r.size * np.log(2 * np.pi * variance) + squares) + scale)

    @property
    def estimated(self) -> int:
        """The number of free parameters, deviations of the noise and fixed effects."""
        if self.fit.noise is not None:
            noise = self.fit.noise
            return self.point.size + len(noise.names) + int(noise.fixed.shape[1])
        return self.point.size + (0 if self.known else 1)

    # --- profiles -----------------------------------------------------------------------------

    def ratio(self, fixed: Coefficients, start: Coefficients) -> tuple[float, dict[str, float]]:
        """Return (S(θ) − S)/τ with some parameters fixed, and the others refitted from a start."""
        held = self.fit.fixing(**fixed)
        point, reached, _ = held.minimise(held.point(start))
        ratio = (self.r.size * reached**2 - self.sum_of_squares) / self.unit
        return float(ratio), held.coefficients(point)

    def interval(self, name: str, level: float) -> Interval:
        """Return the profile-likelihood interval of a free parameter."""
        parameter = next(p for p in self.fit.free if p.name == name)
        limit = float(np.sqrt(self.threshold(level, [name])))
        low, low_is_bound, below = self._edge(name, parameter.low, limit)
        high, high_is_bound, above = self._edge(name, parameter.high, limit)
        return Interval(
            low=low,
            high=high,
            low_is_bound=low_is_bound,
            high_is_bound=high_is_bound,
            lowest=min(0.0, below, above),
        )

    def _edge(self, name: str, bound: float, limit: float) -> tuple[float, bool, float]:
        """Return an interval's end, whether it is the bound, and the lowest ratio on the way."""
        best, lowest = self.best[name], np.inf
        reach = bound - best
        if reach == 0:
            return bound, True, lowest
        # Slightly more than the distance by the covariance.
        error = np.nan_to_num(self.errors[self.fit.names.index(name)])
        inner, outer = 0.0, min(1.0, max(1.1 * limit * float(error) / abs(reach), _FIRST_STEP))
        start: Coefficients = self.best
        last = start
        # A refit from another start may end in another minimum, so each value is found once.
        known: dict[float, float] = {}

        def excess(share: float) -> float:
            nonlocal last, lowest
            if share in known:
                return known[share]
            # A descent that starts at a bound may stay there.
            origin = start if self._is_at_bound(last) else last
            fixed = {name: best + share * reach}
            ratio, last = self.ratio(fixed, origin)
            if not np.isfinite(ratio) and origin is not start:  # undefined with the others of last
                ratio, last = self.ratio(fixed, start)
            lowest = min(lowest, ratio)
            # The square root of the ratio is nearly linear in the parameter.
            known[share] = min(float(np.sqrt(max(ratio, 0.0))), _FAR * limit) - limit
            return known[share]

        while excess(outer) <= 0:
            if outer == 1.0:
                return bound, True, lowest
            inner, start, outer = outer, last, min(1.0, 2 * outer)
        if inner == 0.0:  # a refit here says whether the fit is a minimum at all
            excess(inner)
            known[inner] = -limit
        share = brentq(excess, inner, outer, rtol=_EDGE_PRECISION, xtol=_EDGE_PRECISION * outer)
        return best + float(share) * reach, False, lowest

    def _is_at_bound(self, coefficients: Coefficients) -> bool:
        return any(
            min(coefficients[p.name] - p.low, p.high - coefficients[p.name])
            < _AT_BOUND * (p.high - p.low)
            for p in self.fit.free
        )

    def profile(
        self, name: str, ends: Interval, level: float
    ) -> tuple[FloatArray, FloatArray, float]:
        """Return values of a parameter, √((S(θ) − S)/τ) there, and its value at the level's ends.

        For a linear law the root is the distance in standard errors. Each refit starts from that
        nearer the best.
        """
        best, parameter = self.best[name], self.fit.free[self.fit.names.index(name)]
        low = max(parameter.low, best - _REACH * (best - ends.low))
        high = min(parameter.high, best + _REACH * (ends.high - best))
        values = np.union1d(np.linspace(low, high, _POINTS), [best])
        rise, middle = np.empty(values.size), int(np.searchsorted(values, best))
        for order in (range(middle, values.size), range(middle - 1, -1, -1)):
            start: Coefficients = self.best
            for index in order:
                ratio, start = self.ratio({name: float(values[index])}, start)
                rise[index] = np.sqrt(max(ratio, 0.0))
        return values, rise, float(np.sqrt(self.threshold(level, [name])))

    # --- predictions --------------------------------------------------------------------------

    def slopes_of(
        self, evaluate: Callable[[ContactLaw], ArrayLike]
    ) -> tuple[FloatArray, FloatArray]:
        """Return m numbers of the fitted law, NaN if undefined, and their derivatives (m, k)."""
        centre = np.atleast_1d(as_floats(evaluate(self.law)))

        def values(points: FloatArray) -> FloatArray:
            laws = map(self.fit.law, points)
            return np.array(
                [np.full_like(centre, np.nan) if law is None else evaluate(law) for law in laws]
            ).reshape(len(points), -1)

        return centre, self.fit.jacobian(self.point, values)

    def propagated(
        self, evaluate: Callable[[ContactLaw], ArrayLike], level: float
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return m numbers, their variances by the delta method, and half-widths in errors."""
        if self.covariance is None:
            rule = "are not identifiable one by one, so that there is no band"
            remedy = "fix one of them (--fix NAME=VALUE), and fit again"
            blamed = self.blind or list(self.best)
            raise InputError("prediction", "parameters", blamed, rule, remedy)
        centre, slopes = self.slopes_of(evaluate)
        variance = ((slopes @ self.covariance) * slopes).sum(axis=1)
        return centre, as_floats(variance), half_width(level, self.degrees_of(slopes))

    def band(self, pair: CylinderPair, level: float, load: ArrayLike) -> Band:
        """Return the prediction for a pair at m loads in N/mm, with bands."""
        force, is_log = np.atleast_1d(as_floats(load)), self.fit.is_log

        def predicted(law: ContactLaw) -> FloatArray:
            with np.errstate(divide="ignore", invalid="ignore"):
                value = law.penetration(force, pair)
                return as_floats(np.log(value)) if is_log else value

        centre, variance, reach = self.propagated(predicted, level)
        if not np.isfinite(centre).all():
            outside = float(np.broadcast_to(force, centre.shape)[~np.isfinite(centre)][0])
            rule = "leaves the domain of the fitted law, or is not positive"
            raise InputError("prediction", "load in N/mm", outside, rule, "stay within it")
        depth = self.law.penetration(force, pair)
        depth = as_floats(np.where(depth == 0, _NO_DEPTH, depth))
        added = self.variance_of_reading(depth, force)
        if is_log:
            added = as_floats(added / depth**2)
        spread, wider = reach * np.sqrt(variance), reach * np.sqrt(variance + added)
        ends = (centre, centre - spread, centre + spread, centre - wider, centre + wider)
        return Band(*(as_floats(np.exp(end)) if is_log else as_floats(end) for end in ends))

    def variance_of_reading(self, depth: FloatArray, force: FloatArray) -> FloatArray:
        """Return the variance of new readings of the penetration in mm².

        With given standard deviations, a new reading has their median, or with a noise model that
        of the loads measured.
        """
        fit = self.fit
        sigma = 1.0 if self.known else self.sigma
        if fit.noise is not None:
            return fit.noise.new_variance(depth - self.best.get("offset", 0.0), force)
        # Relative to δ.
        size = np.full_like(force, sigma)
        if not fit.is_log:
            size = sigma * float(np.median(fit.sigma)) / depth
        return as_floats((size * depth) ** 2)


def half_width(level: float, degrees: ArrayLike) -> FloatArray:
    """Return half-widths of intervals of this level in standard errors, at degrees of freedom."""
    tail, finite = (1 + level) / 2, np.isfinite(degrees)
    student = special.stdtrit(np.where(finite, degrees, 1.0), tail)
    return as_floats(np.where(finite, student, special.ndtri(tail)))
