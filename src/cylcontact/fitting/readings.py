"""A law fitted to readings, and the fit at its best: covariance, intervals and predictions.

The noise says what the residuals r are (`noise`). With J their derivatives by the free parameters
at the optimum, least squares has the covariance s²·(JᵀJ)⁻¹, where s² is 1 if the standard
deviations are known and Σr²/(N − k) if not. With a noise model s² is 1, and the degrees of freedom
are Satterthwaite's.

A profile fixes a parameter and refits the others. The likelihood ratio to the optimum is
(S(θ) − S)/τ if the noise is Gaussian. An interval holds the values for which it stays below the
quantile of χ² (standard deviations known) or of F (not known). Unlike an interval from the
covariance it follows the curvature of the law.

Bands are from the delta method, in ln δ if the noise is proportional, since contact laws are nearly
linear there; in δ otherwise, where readings may be negative. The variance of the curve is gᵀCg with
g the derivatives by the free parameters and C their covariance. A new reading adds the noise, with
random effects that of a series not yet measured.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import CylinderPair
from cylcontact.datasets.measurements import Indices, Measurements
from cylcontact.fitting.adapters import RigCompliance, ScaledLaw
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.noise import Covariance, Degrees, Likelihood, NoiseModel, Plain, estimate
from cylcontact.fitting.search import EXACT, descend
from cylcontact.fitting.space import Space, law_of
from cylcontact.fitting.specs import MeasuredSpec
from cylcontact.laws.law import Coefficients, ContactLaw
from cylcontact.laws.user import UserLaw
from cylcontact.support.arrays import BoolArray, FloatArray, as_floats
from cylcontact.support.errors import InputError

# From the median of |r| to a standard deviation of Gaussian residuals.
MEDIAN_TO_SIGMA = 1.4826
# Smaller residuals are round-off: the data have no noise.
ROUNDING = 1e-11
# Points evaluated for each start chosen.
_POINTS_PER_START = 32
# A parameter is searched by its logarithm if its bounds have more than this ratio.
_WIDE = 100.0
# Steps of central differences relative to a parameter, or to its interval if it is near 0.
_RELATIVE_STEP, _INTERVAL_STEP = 6e-6, 1e-9
# Share of the mean curvature that damps a parameter of none.
_FLOOR = 1e-4
# Iterations for the deviations of a noise model, which end when the parameters move by less than
# this share of the residuals.
_ROUNDS, _SETTLED = 60, 1e-9
# A direction with a smaller singular value, relative to the largest, is not identifiable; it
# involves the parameters with at least this fraction of its largest component.
_BLIND, _INVOLVED = 1e-7, 0.1
# Precision of an interval's ends relative to the distance from the optimum, the first step towards
# an end relative to the distance to the bound, the least one relative to that so far, and the most.
_EDGE_PRECISION, _FIRST_STEP, _LEAST_STEP, _EDGE_STEPS = 1e-6, 1e-6, 1e-3, 60
# Relative gain at the end of a descent with a parameter fixed.
_REFIT = 1e-12
# Closer to a bound than this, relative to its interval, a parameter is at it.
_AT_BOUND = 1e-9
# Half-widths of the interval on either side of the optimum in a profile, and the values there.
_REACH, _POINTS = 1.6, 21
# Points evaluated before data are refused as outside a law's domain.
_TRIALS = 256
# Penetrations at which a function of the user's own is evaluated.
_LOOKS = 101
# In place of a predicted reading of 0 mm, to which an error is relative.
_NO_DEPTH = 1e-12


@dataclass(frozen=True, eq=False)
class Fit(Space):
    """N readings, and a law with k free parameters that is fitted to them."""

    data: Measurements
    noise: Plain | Covariance

    @property
    def observed(self) -> FloatArray:
        """The measured penetrations in mm, shape (N,)."""
        return self.data.penetration

    def law(self, point: FloatArray) -> ContactLaw | None:
        """Return the law of free parameters, with its rig; None for those that define none."""
        return law_of(self.model, self.complete(point[None, :])[0])

    def predicted(self, points: FloatArray) -> FloatArray:
        """Return the penetrations of P points in mm, shape (P, N); NaN outside the domain."""
        depths = np.full((len(points), len(self.data)), np.nan)
        for depth, values in zip(depths, self.complete(points), strict=True):
            law = law_of(self.model, values)
            if law is not None:
                with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                    depth[:] = law.penetration(self.data.load, self.data.pair)
        return depths

    def differences(self, points: FloatArray) -> FloatArray:
        """Return the predicted less the measured penetrations in mm, shape (P, N)."""
        return self.predicted(points) - self.observed

    def raw(self, points: FloatArray) -> FloatArray:
        """Return the residuals, shape (P, N)."""
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return self.noise.residuals(self.predicted(points), self.observed)

    def residuals(self, points: FloatArray) -> FloatArray:
        """Return the residuals over √N, whose squares add up to the objective's."""
        return as_floats(self.raw(points) / np.sqrt(len(self.data)))

    @property
    def size(self) -> int:
        """The number of residuals, N."""
        return len(self.data)

    def curvatures(self, A: FloatArray) -> FloatArray:
        """Return the curvature of each parameter: in readings they have all sizes (Marquardt)."""
        return np.diagonal(A, axis1=1, axis2=2) + _FLOOR * super().curvatures(A)

    def slopes(self, points: FloatArray) -> FloatArray:
        """Return the derivatives of the residuals, shape (P, k, N)."""
        return np.array([self.jacobian(point, self.residuals).T for point in points])

    def jacobian(
        self, point: FloatArray, evaluate: Callable[[FloatArray], FloatArray]
    ) -> FloatArray:
        """Return derivatives by the free parameters, shape (N, k); one-sided at a bound."""
        interval = _INTERVAL_STEP / _RELATIVE_STEP * self.span
        steps = _RELATIVE_STEP * np.maximum(np.abs(point), interval)
        high = np.minimum(point + steps, np.maximum(self.high, point))
        low = np.maximum(point - steps, np.minimum(self.low, point))
        moved = np.vstack([point + np.diag(high - point), point + np.diag(low - point)])
        ahead, behind = np.split(evaluate(moved), 2)
        with np.errstate(invalid="ignore"):
            slopes = (ahead - behind) / (high - low)[:, None]
        return as_floats(np.nan_to_num(slopes, nan=0.0, posinf=0.0, neginf=0.0).T)

    def starts(self, nominal: FloatArray | None, number: int, seed: int) -> FloatArray:
        """Return points to start from: the nominal one, and the best of many in the bounds."""
        rng, k = np.random.default_rng(seed), len(self.free)
        unit = np.vstack([np.full(k, 0.5), rng.uniform(size=(_POINTS_PER_START * number, k))])
        low, high = self.low, self.high
        wide: BoolArray = (low > 0) & (high > _WIDE * np.where(low > 0, low, 1.0))
        safe_low, safe_high = np.where(wide, low, 1.0), np.where(wide, high, 1.0)
        logarithmic = safe_low * (safe_high / safe_low) ** unit
        points = np.where(wide, logarithmic, low + unit * (high - low))
        if nominal is not None:
            points = np.vstack([np.clip(nominal, low, high), points])
        values = self.values(points)
        first = [] if nominal is None or not np.isfinite(values[0]) else [0]
        order = [k for k in np.argsort(values, kind="stable") if np.isfinite(values[k])]
        return as_floats(points[[*first, *(k for k in order if k not in first)][:number]])

    def minimise(self, start: FloatArray, precision: float = EXACT) -> tuple[FloatArray, float]:
        """Return the minimum below a point, and its value."""
        points, values = descend(self, start[None], precision)
        return points[0], float(values[0])

    def take(self, rows: Indices) -> Fit:
        """Return the fit to a selection of rows."""
        return replace(self, data=self.data.take(rows), noise=self.noise.take(rows))

    # --- the noise ----------------------------------------------------------------------------

    def with_noise(
        self, model: NoiseModel, point: FloatArray, deviations: Mapping[str, float]
    ) -> Fit:
        """Return the fit with a noise model of these deviations, for a law close to the best."""
        law = self.law(point)
        assert law is not None, "the law is undefined at the best parameters"
        offset = self.coefficients(point).get("offset", 0.0)
        covariance = model.covariance(self.data, law, offset)
        return replace(self, noise=replace(covariance, deviations=dict(deviations)))

    def at_best(self, point: FloatArray) -> Fit:
        """Return the fit with its noise, if it has a model of it, for the best law."""
        if isinstance(self.noise, Plain):
            return self
        return self.with_noise(self.noise.model, point, self.noise.deviations)

    def likelihood(self, point: FloatArray, noise: Covariance) -> Likelihood:
        """Return the likelihood of the deviations of a noise model at a point."""
        slopes = self.jacobian(point, self.differences)
        return Likelihood(noise, self.differences(point[None, :])[0], slopes)

    def estimating(self, model: NoiseModel, start: FloatArray) -> Fit:
        """Return the fit with the deviations of a noise model.

        The two take turns: the parameters by least squares of the residuals in standard deviations,
        which the deviations weigh, and the deviations by restricted maximum likelihood of these
        residuals, until neither moves. `start` is the best point by plain least squares.
        """
        point, source = start, self.data.data.source
        for _ in range(_ROUNDS):
            noise = self.with_noise(model, point, {}).noise
            assert isinstance(noise, Covariance)
            likelihood = self.likelihood(point, noise)
            (rows, free), effects = likelihood.slopes.shape, noise.fixed.shape[1]
            if rows <= free + effects:
                rule = f"are not more than {free} parameters and {effects} effects of the series"
                remedy = "measure more points, or leave group and drift out"
                raise InputError(source, "group", f"{rows} rows", rule, remedy)
            deviations = estimate(likelihood)
            if not np.isfinite([*deviations.values()]).all():
                raise singular(source)
            weighed = replace(self, noise=replace(noise, deviations=deviations))
            moved, _ = weighed.minimise(point)
            step = likelihood.slopes @ (moved - point)
            point = moved
            size = float(np.abs(likelihood.residuals).max())
            if float(np.abs(step).max(initial=0.0)) <= _SETTLED * size:
                break
        return weighed


def singular(source: str) -> InputError:
    """Return the error of a fit whose information matrix is singular."""
    rule = "do not determine the law and the noise together: the information matrix is singular"
    remedy = "free fewer parameters, leave out --drift, --group or --load-error, or measure more"
    return InputError(source, "readings", None, rule, remedy)


# --- the fit of a campaign ------------------------------------------------------------------------


def plain_fit(campaign: Campaign) -> Fit:
    """Return the fit of a campaign on measurements by plain least squares."""
    data, noise = measurements_in(campaign), campaign.noise
    if not isinstance(noise, Plain):
        noise = Plain(is_log=False, given=data.columns.get("penetration_std"))
    return Fit(campaign.model, campaign.parameters, data, noise)


def fit_with_noise(campaign: Campaign) -> Fit:
    """Return the fit of a campaign on measurements, with its noise estimated.

    Raises
    ------
    InputError
        If the law is undefined for some row at all coefficients tried.
    """
    plain, spec = plain_fit(campaign), campaign.spec
    assert isinstance(spec, MeasuredSpec)
    _require_defined(campaign, plain)
    if not isinstance(campaign.noise, NoiseModel):
        return plain
    starts = plain.starts(campaign.nominal, spec.starts, spec.seed)
    point, _ = min(map(plain.minimise, starts), key=lambda end: end[1])
    return plain.estimating(campaign.noise, point)


def measurements_in(campaign: Campaign) -> Measurements:
    """Return the measurements that a campaign is on; refuse one on a grid."""
    if not isinstance(campaign.data, Measurements):
        rule = "is a campaign on a grid, not on measurements"
        raise InputError(campaign.source, "", None, rule, "fit it with calibrate")
    return campaign.data


def _require_defined(campaign: Campaign, fit: Fit) -> None:
    """Refuse data that no coefficients within the bounds can describe, and name the row."""
    data = fit.data
    points = fit.scatter(np.random.default_rng(0), _TRIALS)
    if campaign.nominal is not None:
        points = np.vstack([campaign.nominal, points])
    defined = np.zeros(len(data), dtype=int)
    for point in points:
        inside = np.isfinite(fit.raw(point[None, :])[0])
        if inside.all():
            return
        defined += inside
    require_increasing(fit, points[0])  # says more of a law of one's own
    row = int(np.argmin(defined))
    tried = f"{len(points) - defined[row]} of {len(points)} sets of" if defined[row] else "all"
    where = f"{campaign.source}, {data.data.row_word} {data.line(row)}"
    names = ("load", "penetration", "dR")
    values = [float(data.columns[name][row]) for name in names]
    law = campaign.model.law
    rule = f"lies outside the domain of {law} at {tried} coefficients tried within the bounds"
    remedy = "move the bounds, remove the row, or choose a law that reaches that far"
    raise InputError(where, ", ".join(names), values, rule, remedy)


def require_increasing(fit: Fit, point: FloatArray) -> None:
    """Refuse a function of the user's own that is no contact law at some free parameters."""
    law, data = fit.model.build(fit.coefficients(point)), fit.data
    if isinstance(law, RigCompliance):
        law = law.base
    function = law.base if isinstance(law, ScaledLaw) else law
    if not isinstance(function, UserLaw):
        return
    at = ", ".join(f"{name} = {value:.6g}" for name, value in function.values.items())
    with np.errstate(all="ignore"):
        deepest = np.fmax(data.penetration, law.penetration(data.load, data.pair))
    deepest = np.where(deepest > 0, deepest, np.abs(data.penetration).max())
    before = np.full(len(data), -np.inf)
    for share in np.linspace(0.0, 1.0, _LOOKS):
        loads = function.load(share * deepest, data.pair)
        wrong = np.flatnonzero((loads <= before) | ((loads < 0) & (share > 0)))
        if wrong.size:
            row = int(wrong[0])
            what = "decreases with" if loads[row] < before[row] else "does not grow with"
            if loads[row] < 0:
                what = f"is negative, {loads[row]:.6g} N/mm, at"
            rule = f"{what} the penetration at {share * deepest[row]:.6g} mm, with {at}"
            remedy = "the load of a contact grows from 0; correct the function, or move the bounds"
            raise InputError(function.name, "load", None, rule, remedy)
        before = np.where(np.isfinite(loads), loads, before)


# --- the fit at its best ------------------------------------------------------------------------


class Interval(NamedTuple):
    """The ends of an interval, whether a bound cuts them off, and the lowest ratio on the way."""

    low: float
    high: float
    low_is_bound: bool
    high_is_bound: bool
    lowest: float  # (S(θ) − S)/τ; below 0 there is a better optimum


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

    @cached_property
    def best(self) -> dict[str, float]:
        """All coefficients, by name."""
        return self.fit.coefficients(self.point)

    @cached_property
    def law(self) -> ContactLaw:
        """The fitted law, with the rig."""
        law = self.fit.law(self.point)
        assert law is not None, "the law is undefined at the best parameters"
        return law

    @property
    def covariance_of_readings(self) -> Covariance | None:
        """The covariance of the readings; None without a noise model."""
        return self.fit.noise if isinstance(self.fit.noise, Covariance) else None

    # --- the residuals ------------------------------------------------------------------------

    @cached_property
    def r(self) -> FloatArray:
        """The residuals, shape (N,)."""
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
        return not self.fit.noise.is_given and self.sigma < ROUNDING

    @property
    def chi_square_p(self) -> float | None:
        """The probability of residuals this large; None if σ is not known."""
        from scipy import special

        if not self.fit.noise.is_given:
            return None
        return float(special.chdtrc(self.degrees, self.sum_of_squares))

    @cached_property
    def series(self) -> FloatArray | None:
        """The effects of each series, shape (G, q); None without series."""
        noise = self.covariance_of_readings
        if noise is None or not noise.model.effects:
            return None
        return noise.series_effects(self.differences)

    @property
    def series_in_mm(self) -> FloatArray | None:
        """What its series adds to each reading in mm, shape (N,); None without series."""
        noise, effects = self.covariance_of_readings, self.series
        if noise is None or effects is None:
            return None
        return as_floats((noise.columns * effects[noise.series]).sum(axis=1))

    @property
    def log_likelihood(self) -> float | None:
        """ln L of the readings in mm; None if all residuals are zero."""
        noise = self.fit.noise
        if isinstance(noise, Plain):
            return noise.log_likelihood(self.r, self.fit.observed)
        assert self.likelihood is not None
        return self.likelihood.log_likelihood(noise.deviations)

    @property
    def estimated(self) -> int:
        """The number of free parameters, deviations of the noise and fixed effects."""
        noise = self.fit.noise
        if isinstance(noise, Covariance):
            return self.point.size + noise.estimated
        return self.point.size + (0 if noise.is_given else 1)

    # --- the covariance of the parameters -----------------------------------------------------

    @cached_property
    def likelihood(self) -> Likelihood | None:
        """The likelihood of the deviations of the noise model, if there is one."""
        noise = self.covariance_of_readings
        return None if noise is None else self.fit.likelihood(self.point, noise)

    @cached_property
    def satterthwaite(self) -> Degrees | None:
        """Degrees of freedom with a noise model."""
        noise = self.covariance_of_readings
        if self.likelihood is None or noise is None:
            return None
        return Degrees.of(self.likelihood, noise.deviations)

    @cached_property
    def _inverse(self) -> tuple[FloatArray | None, list[int]]:
        """(JᵀJ)⁻¹, or None and the columns of which only a combination is identifiable."""
        size = np.sqrt((self.slopes**2).sum(axis=0))
        scaled = self.slopes / np.where(size > 0, size, 1.0)
        _, singular_values, directions = np.linalg.svd(scaled, full_matrices=False)
        if singular_values[-1] <= _BLIND * singular_values[0]:
            component = np.abs(directions[-1])
            return None, [int(k) for k in np.flatnonzero(component >= _INVOLVED * component.max())]
        half = directions.T / singular_values
        return as_floats(half @ half.T / np.outer(size, size)), []

    @property
    def unidentifiable(self) -> list[str]:
        """The parameters of which only a combination is identifiable."""
        return [self.fit.names[k] for k in self._inverse[1]]

    @cached_property
    def covariance(self) -> FloatArray | None:
        """Of the free parameters, shape (k, k); None if they are not all identifiable."""
        inverse, _ = self._inverse
        if inverse is None:
            return None
        if self.satterthwaite is not None:
            return self.satterthwaite.covariance
        return as_floats(inverse * self.unit)

    @property
    def unit(self) -> float:
        """τ, such that (S(θ) − S)/τ has a χ² or F distribution."""
        is_plain = self.covariance_of_readings is None
        return self.sigma**2 if is_plain and not self.fit.noise.is_given else 1.0

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
        size = observed if self.fit.noise.is_log else rms
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
        degrees = np.inf if self.fit.noise.is_given else float(self.degrees)
        return np.full(contrasts.shape[:-1], degrees)

    def degrees_of_each(self) -> FloatArray:
        """Return the degrees of freedom of each parameter, shape (k,)."""
        return self.degrees_of(np.eye(self.point.size))

    def threshold(self, level: float, name: str) -> float:
        """Return the largest (S(θ) − S)/τ within the interval of a parameter."""
        from scipy import special

        degrees = float(self.degrees_of_each()[self.fit.names.index(name)])
        if np.isinf(degrees):
            return float(special.chdtri(1, 1 - level))
        return float(special.fdtri(1, degrees, level))

    # --- profiles -----------------------------------------------------------------------------

    def ratio(self, fixed: Coefficients, start: Coefficients) -> tuple[float, dict[str, float]]:
        """Return (S(θ) − S)/τ with some parameters fixed, and the others refitted from a start."""
        held = self.fit.fixing(**fixed)
        point, reached = held.minimise(held.point(start), _REFIT)
        ratio = (self.r.size * reached**2 - self.sum_of_squares) / self.unit
        return float(ratio), held.coefficients(point)

    def interval(self, name: str, level: float) -> Interval:
        """Return the profile-likelihood interval of a free parameter."""
        parameter = next(p for p in self.fit.free if p.name == name)
        limit = float(np.sqrt(self.threshold(level, name)))
        low, low_is_bound, below = self._edge(name, parameter.low, limit)
        high, high_is_bound, above = self._edge(name, parameter.high, limit)
        return Interval(low, high, low_is_bound, high_is_bound, min(0.0, below, above))

    def _edge(self, name: str, bound: float, limit: float) -> tuple[float, bool, float]:
        """Return an interval's end, whether it is the bound, and the lowest ratio on the way."""
        best, lowest = self.best[name], np.inf
        reach = bound - best
        if reach == 0:
            return bound, True, lowest
        # Slightly more than the distance by the covariance.
        error = float(np.nan_to_num(self.errors[self.fit.names.index(name)]))
        inner, inside = 0.0, -limit
        step = outer = min(1.0, max(1.1 * limit * error / abs(reach), _FIRST_STEP))
        start: Coefficients = self.best
        last = start

        def excess(share: float) -> float:
            """Return how far √ratio, nearly linear in the parameter, is above the limit."""
            nonlocal last, lowest
            # A descent that starts at a bound may stay there.
            origin = start if self._is_at_bound(last) else last
            fixed = {name: best + share * reach}
            ratio, others = self.ratio(fixed, origin)
            if not np.isfinite(ratio) and origin is not start:  # undefined with the others of last
                ratio, others = self.ratio(fixed, start)
            last = others if np.isfinite(ratio) else last
            lowest = min(lowest, ratio)
            return float(np.sqrt(max(ratio, 0.0))) - limit

        while (outside := excess(outer)) <= 0 or (outside == np.inf and step > _LEAST_STEP * outer):
            if outside == np.inf:  # with these others: nearer ones lead on
                step /= 2
            elif outer == 1.0:
                return bound, True, lowest
            else:
                inside, inner, start, step = outside, outer, last, 2 * step
            outer = min(1.0, inner + step)
        if inner == 0.0:  # a refit here says whether the fit is a minimum at all
            excess(inner)
        share = crossing(excess, (inner, inside), (outer, outside))
        return best + share * reach, False, lowest

    def _is_at_bound(self, coefficients: Coefficients) -> bool:
        return any(
            min(coefficients[p.name] - p.low, p.high - coefficients[p.name])
            < _AT_BOUND * (p.high - p.low)
            for p in self.fit.free
        )

    def profile(
        self, name: str, low: float, high: float, level: float
    ) -> tuple[FloatArray, FloatArray, float]:
        """Return values of a parameter, √((S(θ) − S)/τ) there, and its value at the level's ends.

        For a linear law the root is the distance in standard errors. Each refit starts from that
        nearer the best.
        """
        best, parameter = self.best[name], self.fit.free[self.fit.names.index(name)]
        low = max(parameter.low, best - _REACH * (best - low))
        high = min(parameter.high, best + _REACH * (high - best))
        values = np.union1d(np.linspace(low, high, _POINTS), [best])
        rise, middle = np.empty(values.size), int(np.searchsorted(values, best))
        for order in (range(middle, values.size), range(middle - 1, -1, -1)):
            start: Coefficients = self.best
            for index in order:
                ratio, start = self.ratio({name: float(values[index])}, start)
                rise[index] = np.sqrt(max(ratio, 0.0))
        return values, rise, float(np.sqrt(self.threshold(level, name)))

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
            blamed = self.unidentifiable or list(self.best)
            raise InputError("prediction", "parameters", blamed, rule, remedy)
        centre, slopes = self.slopes_of(evaluate)
        variance = ((slopes @ self.covariance) * slopes).sum(axis=1)
        return centre, as_floats(variance), half_width(level, self.degrees_of(slopes))

    def band(self, pair: CylinderPair, level: float, load: ArrayLike) -> Band:
        """Return the prediction for a pair at m loads in N/mm, with bands."""
        force, is_log = np.atleast_1d(as_floats(load)), self.fit.noise.is_log

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
        noise = self.fit.noise
        if isinstance(noise, Plain):
            return noise.new_variance(depth, 1.0 if noise.is_given else self.sigma)
        return noise.new_variance(depth - self.best.get("offset", 0.0), force)


def crossing(
    function: Callable[[float], float], inner: tuple[float, float], outer: tuple[float, float]
) -> float:
    """Return where a function crosses zero between two points, each with its value there.

    Regula falsi by Anderson and Björck (1973), which weighs down the end that stays. Where the
    function is infinite, the interval is halved.
    """
    (a, at_a), (b, at_b) = inner, outer
    for _ in range(_EDGE_STEPS):
        if abs(b - a) <= _EDGE_PRECISION * max(abs(a), abs(b)):
            break
        at_a, at_b = (np.copysign(1.0, at) if np.isinf(at_a + at_b) else at for at in (at_a, at_b))
        x = b - at_b * (b - a) / (at_b - at_a)
        at_x = function(x)
        if abs(at_x) <= _EDGE_PRECISION:
            return x
        if at_x * at_b < 0:
            a, at_a = b, at_b
        else:
            weight = 1 - at_x / at_b
            at_a *= weight if weight > 0 else 0.5
        b, at_b = x, at_x
    return b


def half_width(level: float, degrees: ArrayLike) -> FloatArray:
    """Return half-widths of intervals of this level in standard errors, at degrees of freedom."""
    from scipy import special

    tail, finite = (1 + level) / 2, np.isfinite(degrees)
    student = special.stdtrit(np.where(finite, degrees, 1.0), tail)
    return as_floats(np.where(finite, student, special.ndtri(tail)))
