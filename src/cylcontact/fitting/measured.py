"""A law fitted to readings: its residuals, their minimum, and the noise that they show.

| objective | residual | for |
|---|---|---|
| rms-log-penetration | ln(δ_law(f)/δ) | noise proportional to δ |
| rms-penetration | (δ_law(f) − δ)/σ, σ = 1 mm by default | constant noise, or σ |
| rms-standardised | V^(−½)·(δ_law(f) − δ), in standard deviations | a noise model (`noise`) |
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from cylcontact.datasets.measurements import Indices, Measurements
from cylcontact.fitting.noise import Covariance, Likelihood, NoiseModel, estimate
from cylcontact.fitting.search import Minimum
from cylcontact.fitting.space import Space, law_of
from cylcontact.laws.law import ContactLaw
from cylcontact.support.arrays import BoolArray, FloatArray, as_floats
from cylcontact.support.errors import InputError

OBJECTIVES = ("rms-log-penetration", "rms-penetration")
STANDARDISED = "rms-standardised"
# From the median of |r| to a standard deviation of Gaussian residuals.
MEDIAN_TO_SIGMA = 1.4826
# Points evaluated for each start chosen.
_POINTS_PER_START = 32
# A parameter is searched by its logarithm if its bounds have more than this ratio.
_WIDE = 100.0
# Steps of central differences relative to a parameter, or to its interval if it is near 0.
_RELATIVE_STEP, _INTERVAL_STEP = 6e-6, 1e-9
# Descents from the end of the one before; one that gains less, relatively, is the last.
_MAX_RESTARTS, _MIN_GAIN, _PRECISION = 10, 1e-12, 1e-15
# Iterations for the deviations of a noise model, which end when the parameters move by less than
# this share of the residuals.
_ROUNDS, _SETTLED = 60, 1e-9


@dataclass(frozen=True, eq=False)
class Fit(Space):
    """N readings, and a law with k free parameters that is fitted to them."""

    objective: str
    data: Measurements
    noise: Covariance | None = None

    @property
    def is_log(self) -> bool:
        """Whether residuals are logarithms of a ratio."""
        return "log" in self.objective

    @property
    def has_sigma(self) -> bool:
        """Whether the standard deviation of the noise is known."""
        if self.objective == STANDARDISED:
            return self.noise is not None and not self.noise.names
        return not self.is_log and "penetration_std" in self.data.columns

    @property
    def sigma(self) -> FloatArray:
        """The standard deviations in mm, shape (N,); 1 if they are not known."""
        return self.data.columns.get("penetration_std", np.ones(len(self.data)))

    @property
    def observed(self) -> FloatArray:
        """The measured penetrations in mm, shape (N,)."""
        return self.data.penetration

    # --- the law and its residuals ------------------------------------------------------------

    def law(self, point: FloatArray) -> ContactLaw | None:
        """Return the law of free parameters, with its rig; None for those that define none."""
        return law_of(self.model, self.complete(point[None, :])[0])

    def differences(self, points: FloatArray) -> FloatArray:
        """Return the predicted less the measured penetrations in mm, shape (P, N)."""
        laws = (law_of(self.model, values) for values in self.complete(points))
        return as_floats(np.array([self._predicted(law) for law in laws]) - self.observed)

    def raw(self, points: FloatArray) -> FloatArray:
        """Return the residuals with σ, shape (P, N)."""
        every = self.complete(points)
        return np.array([self._raw(law_of(self.model, values)) for values in every])

    def residuals(self, points: FloatArray) -> FloatArray:
        """Return residuals whose squares add up to the objective's, shape (P, N)."""
        return self._scaled(self.raw(points))

    def values(self, points: FloatArray) -> FloatArray:
        """Return the objective of P points, shape (P,); inf if undefined."""
        return _norm(self.residuals(points))

    def value_of(self, coefficients: Mapping[str, float]) -> float:
        """Return the objective of coefficients by name, which may be outside the bounds."""
        law = law_of(self.model, [coefficients[name] for name in self.model.names])
        return float(_norm(self._scaled(self._raw(law)[None, :]))[0])

    def _scaled(self, raw: FloatArray) -> FloatArray:
        return as_floats(raw / np.sqrt(len(self.data)))

    def _raw(self, law: ContactLaw | None) -> FloatArray:
        """Return the residuals of one law, shape (N,); NaN outside its domain."""
        predicted, observed = self._predicted(law), self.observed
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            difference = np.log(predicted / observed) if self.is_log else predicted - observed
            if self.noise is not None:
                return self.noise.whitened(as_floats(difference))
            return as_floats(difference if self.is_log else difference / self.sigma)

    def _predicted(self, law: ContactLaw | None) -> FloatArray:
        data = self.data
        if law is None:
            return np.full(len(data), np.nan)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return law.penetration(data.load, data.pair)

    def jacobian(
        self, point: FloatArray, evaluate: Callable[[FloatArray], FloatArray]
    ) -> FloatArray:
        """Return derivatives by the free parameters, shape (N, k); one-sided at a bound."""
        interval = _INTERVAL_STEP / _RELATIVE_STEP * (self.high - self.low)
        steps = _RELATIVE_STEP * np.maximum(np.abs(point), interval)
        high = np.minimum(point + steps, np.maximum(self.high, point))
        low = np.maximum(point - steps, np.minimum(self.low, point))
        moved = np.vstack([point + np.diag(high - point), point + np.diag(low - point)])
        ahead, behind = np.split(evaluate(moved), 2)
        with np.errstate(invalid="ignore"):
            slopes = (ahead - behind) / (high - low)[:, None]
        return as_floats(np.nan_to_num(slopes, nan=0.0, posinf=0.0, neginf=0.0).T)

    # --- the minimum --------------------------------------------------------------------------

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

    def minimise(self, start: FloatArray, most: int = _MAX_RESTARTS) -> Minimum:
        """Descend within the bounds, at most so often from the end before, to no higher values."""
        point, value, evaluations = start, self.value(start), 1
        if point.size == 0 or not np.isfinite(value):
            return Minimum(point, value, evaluations)
        for _ in range(most):
            candidate, spent = self._descend(point)
            reached = self.value(candidate)
            evaluations += spent + 1
            is_worthwhile = reached < value * (1 - _MIN_GAIN)
            if reached < value:
                point, value = candidate, reached
            if not is_worthwhile:
                break
        return Minimum(point, value, evaluations)

    def _descend(self, start: FloatArray) -> tuple[FloatArray, int]:
        """Run scipy's trust-region method once; return its end and the candidates evaluated."""
        span = self.high - self.low
        margin = 1e-12 * span

        def residuals(point: FloatArray) -> FloatArray:
            return as_floats(self.finite_residuals(point[None, :])[0])

        def slopes(point: FloatArray) -> FloatArray:
            return self.jacobian(point, self.residuals)

        solution = least_squares(
            residuals,
            np.clip(start, self.low + margin, self.high - margin),
            jac=slopes,
            bounds=(self.low, self.high),
            x_scale=np.maximum(np.abs(start), 1e-3 * span),
            xtol=_PRECISION,
            ftol=_PRECISION,
            gtol=_PRECISION,
            max_nfev=200,
        )
        return np.asarray(solution.x), int(solution.nfev + 2 * start.size * (solution.njev or 0))

    # --- the noise ----------------------------------------------------------------------------

    def take(self, rows: Indices, series: Indices | None = None) -> Fit:
        """Return the fit to rows, possibly repeated; `series` renumbers those of its noise."""
        noise = None if self.noise is None else self.noise.take(rows, series)
        return replace(self, data=self.data.take(rows), noise=noise)

    def with_noise(
        self, model: NoiseModel, best: Mapping[str, float], deviations: Mapping[str, float]
    ) -> Fit:
        """Return the fit with a noise model of these deviations, for a law close to the best."""
        law = self.law(self.point(best))
        if law is None:
            raise TypeError("the law is undefined at the best parameters")
        covariance = model.covariance(self.data, law, best.get("offset", 0.0))
        return replace(self, noise=replace(covariance, deviations=dict(deviations)))

    def at_best(self, best: Mapping[str, float]) -> Fit:
        """Return the fit with its noise, if it has a model of it, for the best law."""
        if self.noise is None:
            return self
        return self.with_noise(self.noise.model, best, self.noise.deviations)

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
        point = start
        for _ in range(_ROUNDS):
            noise = self.with_noise(model, self.coefficients(point), {}).noise
            assert noise is not None
            likelihood = self.likelihood(point, noise)
            rows, free = likelihood.slopes.shape
            effects = likelihood.covariance.fixed.shape[1]
            if rows <= free + effects:
                rule = f"are not more than {free} parameters and {effects} effects of the series"
                remedy = "measure more points, or leave group and drift out"
                raise InputError(self.data.data.source, "group", f"{rows} rows", rule, remedy)
            deviations = estimate(likelihood)
            if not np.isfinite([*deviations.values()]).all():
                raise singular(self.data.data.source)
            weighed = replace(self, noise=replace(noise, deviations=deviations))
            moved = weighed.minimise(point).point
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


def _norm(residuals: FloatArray) -> FloatArray:
    with np.errstate(over="ignore", invalid="ignore"):
        values = np.sqrt((residuals**2).sum(axis=1))
    return np.where(np.isfinite(values), values, np.inf)
