"""A law fitted to readings, and the fit at its best: covariance, intervals and predictions.

The residuals r are the predicted less the measured penetrations, whitened by the covariance of the
readings (`noise`): least squares minimises S = Σr², with the squares of what is known of the
parameters from elsewhere. With J the derivatives of r at the optimum the parameters have the
covariance (JᵀJ)⁻¹; the degrees of freedom are Satterthwaite's.

A profile fixes a parameter and refits the others. The likelihood ratio to the optimum is S(θ) − S
for Gaussian noise. An interval holds the values for which it stays below the quantile of χ²
(standard deviations known) or of F (not known). Unlike an interval from the covariance it follows
the curvature of the law. The profiles are those of `profile`, which remembers every refit. With few
readings an interval is wider, as `noise.Mixture` says.

Bands are from the delta method. The variance of the curve is gᵀCg with g the derivatives by the
free parameters and C their covariance. A new reading adds the noise, with random effects that of a
series not yet measured.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import CylinderPair
from cylcontact.datasets.measurements import Indices, Measurements
from cylcontact.fitting.adapters import ContactAlone, CorrectedInputs, RigCompliance, ScaledLaw
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.noise import (
    DEPENDENT,
    Covariance,
    Degrees,
    Likelihood,
    Mixture,
    NoiseModel,
    estimate,
    sharpened,
)
from cylcontact.fitting.profile import Profiles
from cylcontact.fitting.search import EXACT, descend
from cylcontact.fitting.space import Space, law_of
from cylcontact.fitting.specs import MeasuredSpec
from cylcontact.laws.law import ContactLaw
from cylcontact.laws.user import UserLaw
from cylcontact.support.arrays import BoolArray, FloatArray, as_floats
from cylcontact.support.errors import InputError

# From the median of |r| to a standard deviation of Gaussian residuals.
MEDIAN_TO_SIGMA = 1.4826
# Residuals smaller than this share of the readings are round-off: the data have no noise.
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
# A direction that has no effect involves the parameters with this fraction of its largest
# component; a prediction with more than this share along it is not determined.
_INVOLVED, _ALONG = 0.1, 1e-4
# The first step towards an end of an interval relative to the bounds, and the largest distance.
_FIRST_STEP, _FAR = 1e-6, 1e6
# Starts that end relatively this close together are of one minimum.
_SAME = 1e-8
# Starts are compared on at most so many readings.
_LOOKED_AT = 2_000
# Numbers in arrays of points by readings; of more points some at a time are evaluated.
_AT_ONCE = 1 << 20
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
    noise: Covariance

    @property
    def observed(self) -> FloatArray:
        """The measured penetrations in mm, shape (N,)."""
        return self.data.penetration

    def law(self, point: FloatArray) -> ContactLaw | None:
        """Return the law of free parameters, with its rig; None for those that define none."""
        return law_of(self.model, self.complete(point[None, :])[0])

    def predicted(self, points: FloatArray) -> FloatArray:
        """Return the penetrations of P points in mm, shape (P, N); NaN outside the domain.

        Points that differ in the rig alone share the penetration of their contact.
        """
        depths = np.full((len(points), len(self.data)), np.nan)
        load, pair = self.data.load, self.data.pair
        contacts: dict[bytes, ContactAlone] = {}
        for depth, values in zip(depths, self.complete(points), strict=True):
            law = law_of(self.model, values)
            if law is None:
                continue
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                if isinstance(law, RigCompliance):
                    key = values[self._of_contact].tobytes()
                    if key not in contacts:
                        contacts[key] = ContactAlone(law.base, load, pair)
                    depth[:] = law.reading_of(contacts[key])
                else:
                    depth[:] = law.penetration(load, pair)
        return depths

    @cached_property
    def _of_contact(self) -> BoolArray:
        """Whether each parameter changes the contact itself, shape (all,): the rig's do not."""
        return np.array([p.name not in ("offset", "compliance") for p in self.parameters])

    def differences(self, points: FloatArray) -> FloatArray:
        """Return the predicted less the measured penetrations in mm, shape (P, N)."""
        return self.predicted(points) - self.observed

    def raw(self, points: FloatArray) -> FloatArray:
        """Return the residuals, shape (P, N)."""
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return self.noise.residuals(self.predicted(points), self.observed)

    def residuals(self, points: FloatArray) -> FloatArray:
        """Return the residuals over √N, whose squares add up to the objective's."""
        return as_floats(self.whole(points) / np.sqrt(len(self.data)))

    def values(self, points: FloatArray) -> FloatArray:
        """Return the objective of P points, shape (P,), of some at a time."""
        some = max(1, _AT_ONCE // len(self.data))
        parts = (points[k : k + some] for k in range(0, max(len(points), 1), some))
        return np.concatenate([super(Fit, self).values(part) for part in parts])

    @cached_property
    def _known(self) -> tuple[Indices, FloatArray, FloatArray]:
        """The parameters that are known from elsewhere: index, value and standard deviation.

        Those that a profile fixes count as well.
        """
        places = [k for k, p in enumerate(self.parameters) if p.known is not None]
        pairs = [p.known for p in self.parameters if p.known is not None]
        values, deviations = np.reshape(np.array(pairs, dtype=np.float64), (-1, 2)).T
        return np.array(places, dtype=np.intp), values, deviations

    def from_known(self, points: FloatArray) -> FloatArray:
        """Return how far parameters are from what is known of them, in deviations, shape (P, m)."""
        places, values, deviations = self._known
        return as_floats((self.complete(points)[:, places] - values) / deviations)

    def whole(self, points: FloatArray) -> FloatArray:
        """Return the residuals of the readings and of what is known, shape (P, N + m)."""
        return as_floats(np.hstack([self.raw(points), self.from_known(points)]))

    @cached_property
    def size(self) -> int:
        """The number of residuals, N + m."""
        return len(self.data) + self._known[0].size

    @property
    def is_ill_conditioned(self) -> bool:
        """Readings may hardly tell parameters apart."""
        return True

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
        last = len(self.data) - 1
        rows = np.unique(np.linspace(0, last, min(last + 1, _LOOKED_AT)).astype(np.intp))
        values = self.take(rows).values(points)
        order = [k for k in np.argsort(values, kind="stable") if np.isfinite(values[k])]
        if nominal is not None and np.isfinite(values[0]):
            order = [0, *(k for k in order if k != 0)]
        if rows.size <= last:  # where all readings are defined, of which these are some
            order = [*islice((k for k in order if np.isfinite(self.value(points[k]))), number)]
        return as_floats(points[order[:number]])

    def minimise(self, start: FloatArray, precision: float = EXACT) -> tuple[FloatArray, float]:
        """Return the minimum below a point, and its value."""
        points, values = descend(self, start[None], precision)
        return points[0], float(values[0])

    def lowest(self, starts: FloatArray) -> FloatArray:
        """Return the lowest minimum below some points; of the first two if they agree."""
        ends = [self.minimise(start) for start in starts[:2]]
        if not agree([value for _, value in ends]):
            ends += [self.minimise(start) for start in starts[2:]]
        return min(ends, key=lambda end: end[1])[0]

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
        """Return the fit with its noise for the best law."""
        return self.with_noise(self.noise.model, point, self.noise.deviations)

    def likelihood(self, point: FloatArray, noise: Covariance) -> Likelihood:
        """Return the likelihood of the deviations of a noise model at a point."""
        slopes = self.jacobian(point, self.differences)
        known = self.from_known(point[None, :])[0], self.jacobian(point, self.from_known)
        return Likelihood(noise, self.differences(point[None, :])[0], slopes, *known)

    def estimating(self, model: NoiseModel, start: FloatArray) -> Fit:
        """Return the fit with the deviations of a noise model.

        The two take turns: the parameters by least squares of the residuals in standard deviations,
        which the deviations weigh, and the deviations by restricted maximum likelihood of these
        residuals, until neither moves. `start` is the best point by plain least squares.
        """
        point, source = start, self.data.data.source
        deviations: dict[str, float] = {}
        for _ in range(_ROUNDS):
            noise = self.with_noise(model, point, {}).noise
            likelihood = self.likelihood(point, noise)
            (rows, free), effects = likelihood.slopes.shape, noise.fixed.shape[1]
            if rows + likelihood.known.size <= free + effects:
                rule = f"are not more than {free} parameters and {effects} effects of the series"
                remedy = "measure more points, or leave group and drift out"
                raise InputError(source, "group", f"{rows} rows", rule, remedy)
            deviations = estimate(likelihood, deviations)
            if not np.isfinite([*deviations.values()]).all():
                raise singular(source)
            weighed = replace(self, noise=replace(noise, deviations=deviations))
            moved, _ = weighed.minimise(point)
            step = likelihood.slopes @ (moved - point)
            point = moved
            size = float(np.abs(likelihood.residuals).max())
            if float(np.abs(step).max(initial=0.0)) <= _SETTLED * size:
                break
        deviations = sharpened(likelihood, deviations)
        return replace(weighed, noise=replace(weighed.noise, deviations=deviations))


def agree(values: Sequence[float]) -> bool:
    """Return whether two or more minima are one."""
    return len(values) > 1 and bool(np.ptp(values) <= _SAME * min(values))


def singular(source: str) -> InputError:
    """Return the error of a fit whose information matrix is singular."""
    rule = "do not determine the law and the noise together: the information matrix is singular"
    remedy = "free fewer parameters, leave out --drift, --group or --load-error, or measure more"
    return InputError(source, "readings", None, rule, remedy)


# --- the fit of a campaign ------------------------------------------------------------------------


def plain_fit(campaign: Campaign) -> Fit:
    """Return the fit of a campaign on measurements by plain least squares."""
    data = measurements_in(campaign)
    noise = independent(data, data.columns.get("penetration_std"))
    return Fit(campaign.model, campaign.parameters, data, noise)


def independent(data: Measurements, given: FloatArray | None = None) -> Covariance:
    """Return the covariance of independent readings, of given deviations or of 1 mm each."""
    zero = np.zeros(len(data))
    return Covariance(
        model=NoiseModel(noise="constant" if given is None else None),
        load=data.load,
        given=zero if given is None else as_floats(given**2),
        depth=data.penetration,
        series=zero.astype(np.intp),
        position=zero,
        deviations={"constant": 1.0} if given is None else {},
    )


def fit_with_noise(campaign: Campaign) -> Fit:
    """Return the fit of a campaign on measurements, as `fit_and_starts` does."""
    return fit_and_starts(campaign)[0]


def fit_and_starts(campaign: Campaign) -> tuple[Fit, FloatArray]:
    """Return the fit of a campaign on measurements, with its noise estimated, and its starts.

    Raises
    ------
    InputError
        If the law is undefined for some row at all coefficients tried.
    """
    plain, spec = plain_fit(campaign), campaign.spec
    assert isinstance(spec, MeasuredSpec)
    assert campaign.noise is not None
    _require_defined(campaign, plain)
    starts = plain.starts(campaign.nominal, spec.starts, spec.seed)
    point = plain.lowest(starts)
    size, observed = (
        float(np.sqrt((values**2).mean()))
        for values in (plain.differences(point[None])[0], plain.observed)
    )
    if size < ROUNDING * observed and not campaign.noise.is_given:
        rounding = {"constant": max(size, np.finfo(float).eps * observed)}
        return replace(plain, noise=plain.noise.at(rounding)), starts
    return plain.estimating(campaign.noise, point), starts


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
    rule = f"lies outside the domain of {law} at {tried} starting points within the bounds"
    remedy = "move the bounds, remove the row, or choose a law that reaches that far"
    raise InputError(where, ", ".join(names), values, rule, remedy)


def require_increasing(fit: Fit, point: FloatArray) -> None:
    """Refuse the user's function if it is not a contact law at some free parameters."""
    law, data = fit.model.build(fit.coefficients(point)), fit.data
    while isinstance(law, RigCompliance | CorrectedInputs):
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
    lowest: float  # S(θ) − S; below 0 there is a better optimum


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
        """The derivatives of r, and of what is known, by the free parameters, (N + m, k)."""
        return self.fit.jacobian(self.point, self.fit.whole)

    @property
    def degrees(self) -> int:
        """Degrees of freedom: readings, and what is known, less parameters and fixed effects."""
        return self.likelihood.degrees

    @cached_property
    def sum_of_squares(self) -> float:
        """The minimum S of the sum of squares."""
        return float(self.r.size * self.fit.value(self.point) ** 2)

    @property
    def is_rounding(self) -> bool:
        """Whether the data follow the law to round-off, without noise."""
        size, observed = (float((x**2).mean()) for x in (self.differences, self.fit.observed))
        return not self.fit.noise.is_given and size < ROUNDING**2 * observed

    @property
    def chi_square_p(self) -> float | None:
        """The probability of residuals this large; None unless all deviations are given."""
        from scipy import special

        if not self.fit.noise.is_given:
            return None
        return float(special.chdtrc(self.degrees, self.sum_of_squares))

    @cached_property
    def series(self) -> FloatArray | None:
        """The effects of each series, shape (G, q); None without series."""
        noise = self.fit.noise
        return noise.series_effects(self.differences) if noise.model.effects else None

    @property
    def series_in_mm(self) -> FloatArray | None:
        """What its series adds to each reading in mm, shape (N,); None without series."""
        noise, effects = self.fit.noise, self.series
        if effects is None:
            return None
        return as_floats((noise.columns * effects[noise.series]).sum(axis=1))

    @property
    def log_likelihood(self) -> float | None:
        """ln L of the readings in mm; None if they follow the law to round-off."""
        return None if self.is_rounding else self.likelihood.log_likelihood

    @property
    def estimated(self) -> int:
        """The number of free parameters, deviations of the noise and fixed effects."""
        return self.point.size + self.fit.noise.estimated

    # --- the covariance of the parameters -----------------------------------------------------

    @cached_property
    def likelihood(self) -> Likelihood:
        """The likelihood of the deviations of the noise."""
        return self.fit.likelihood(self.point, self.fit.noise)

    @cached_property
    def satterthwaite(self) -> Degrees:
        """The covariance of the parameters, and degrees of freedom."""
        return Degrees.of(self.likelihood, self.fit.noise.deviations)

    @cached_property
    def mixture(self) -> Mixture | None:
        """The average over the split of the noise, where few readings leave that open."""
        return None if self.is_rounding else Mixture.of(self.likelihood)

    @cached_property
    def _without_effect(self) -> FloatArray:
        """Directions of the parameters without effect on the readings, shape (d, k), scaled."""
        scaled = self.slopes / self._sizes
        _, values, directions = np.linalg.svd(scaled, full_matrices=False)
        return as_floats(directions[values <= DEPENDENT * values[0]])

    @property
    def _sizes(self) -> FloatArray:
        size = np.sqrt((self.slopes**2).sum(axis=0))
        return as_floats(np.where(size > 0, size, 1.0))

    @property
    def unidentifiable(self) -> list[str]:
        """The parameters of which only a combination, or none, has an effect."""
        component = np.abs(self._without_effect)
        largest = component.max(axis=1, keepdims=True, initial=0.0)
        involved = (component >= _INVOLVED * largest).any(axis=0)
        return [name for name, is_in in zip(self.fit.names, involved, strict=True) if is_in]

    @property
    def covariance(self) -> FloatArray:
        """Of the free parameters, shape (k, k); of what is determined of them, if not all are."""
        return self.satterthwaite.covariance

    @property
    def errors(self) -> FloatArray:
        """The standard errors of the free parameters, shape (k,); NaN for unidentifiable ones."""
        errors = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        unknown = [name in self.unidentifiable for name in self.fit.names]
        return as_floats(np.where(unknown, np.nan, errors))

    @cached_property
    def per_unit(self) -> FloatArray:
        """Factors from half-widths to relative ones, shape (k,): 1/|value|.

        For a shift, whose zero is arbitrary, the root mean square of the change of the predictions
        per unit of it, over that of the readings.
        """
        moved, size = self.likelihood.slopes, (self.fit.observed**2).mean()
        effect = np.sqrt((moved**2).mean(axis=0) / size)
        # Bounds on either side of zero make it arbitrary, whatever the law declares.
        is_shift = [p.shift or p.low < 0 < p.high for p in self.fit.free]
        with np.errstate(divide="ignore"):
            return as_floats(np.where(is_shift, effect, 1 / np.abs(self.point)))

    def degrees_of_each(self) -> FloatArray:
        """Return the degrees of freedom of each parameter, shape (k,); inf if σ is known."""
        return self.satterthwaite(np.eye(self.point.size))

    def reach(self, contrasts: FloatArray, level: float) -> FloatArray:
        """Return the half-widths of intervals of m contrasts (m, k), below and above, (m, 2)."""
        variance = ((contrasts @ self.covariance) * contrasts).sum(axis=1)
        widths = half_width(level, self.satterthwaite(contrasts)) * np.sqrt(variance)
        both = np.repeat(widths[:, None], 2, axis=1)
        if self.mixture is None:
            return both
        return as_floats(both * self.mixture.widening(contrasts, widths, level))

    def limits(self, level: float, name: str) -> FloatArray:
        """Return √(S(θ) − S) at the ends of the interval of a parameter, shape (2,)."""
        contrast = np.eye(self.point.size)[[self.fit.names.index(name)]]
        return as_floats(
            self.reach(contrast, level)[0] / np.sqrt(contrast @ self.covariance @ contrast.T)[0]
        )

    # --- profiles -----------------------------------------------------------------------------

    def rise(self, objective: FloatArray) -> FloatArray:
        """Return √(S(θ) − S): for a linear law the distance in standard errors."""
        above = self.r.size * objective**2 - self.sum_of_squares
        return as_floats(np.sqrt(np.maximum(above, 0.0)))

    def _profiles(self, name: str, values: FloatArray) -> Profiles:
        """Return the profile of a free parameter, held at some values first."""
        of_each = [values if each == name else np.empty(0) for each in self.fit.names]
        return Profiles(self.fit, self.point, of_each)

    def interval(self, name: str, level: float) -> Interval:
        """Return the profile-likelihood interval of a free parameter."""
        k, limits = self.fit.names.index(name), self.limits(level, name)
        low, high, best = self.fit.low[k], self.fit.high[k], self.point[k]
        # Slightly more than the distance by the covariance.
        error = float(np.nan_to_num(self.errors[k]))
        step = np.maximum(1.1 * limits * error, _FIRST_STEP * (high - low))
        at = np.unique(np.clip([best - step[0], best, best + step[1]], low, high))
        profiles = self._profiles(name, at)

        def distance(objective: FloatArray, side: int) -> FloatArray:
            return as_floats(np.minimum(self.rise(objective) / limits[side], _FAR))

        ends = profiles.ends(distance)[k]
        cut_low, cut_high = np.isnan(ends).tolist()
        lower = float(low if cut_low else ends[0])
        upper = float(high if cut_high else ends[1])
        lowest = self.r.size * profiles.objective.min() ** 2 - self.sum_of_squares
        return Interval(lower, upper, cut_low, cut_high, min(0.0, float(lowest)))

    def profile(
        self, name: str, low: float, high: float, level: float
    ) -> tuple[FloatArray, FloatArray, float]:
        """Return values of a parameter, the rise there, and that at the ends of the level."""
        k = self.fit.names.index(name)
        best, limit = self.point[k], float(self.limits(level, name).mean())
        low = max(self.fit.low[k], best - _REACH * (best - low))
        high = min(self.fit.high[k], best + _REACH * (high - best))
        profiles = self._profiles(name, np.union1d(np.linspace(low, high, _POINTS), [best]))
        places = profiles.places(k)
        return profiles.at[places], self.rise(profiles.objective[places]), limit

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
        """Return m numbers, their variances by the delta method, and half-widths, (m, 2)."""
        centre, slopes = self.slopes_of(evaluate)
        along = (slopes / self._sizes) @ self._without_effect.T
        size = np.linalg.norm(slopes / self._sizes, axis=1)
        if (np.linalg.norm(along, axis=1) > _ALONG * size).any():
            rule = "cannot be identified separately, so that there is no band"
            remedy = "fix one of them (--fix NAME=VALUE), and fit again"
            raise InputError("prediction", "parameters", self.unidentifiable, rule, remedy)
        variance = ((slopes @ self.covariance) * slopes).sum(axis=1)
        return centre, as_floats(variance), self.reach(slopes, level)

    def band(self, pair: CylinderPair, level: float, load: ArrayLike) -> Band:
        """Return the prediction for a pair at m loads in N/mm, with bands."""
        force = np.atleast_1d(as_floats(load))

        def predicted(law: ContactLaw) -> FloatArray:
            with np.errstate(divide="ignore", invalid="ignore"):
                return law.penetration(force, pair)

        centre, variance, reach = self.propagated(predicted, level)
        if not np.isfinite(centre).all():
            outside = float(np.broadcast_to(force, centre.shape)[~np.isfinite(centre)][0])
            rule, remedy = "leaves the domain of the fitted law", "stay within it"
            raise InputError("prediction", "load in N/mm", outside, rule, remedy)
        added = self.variance_of_reading(centre, force)
        # A new reading is as many standard deviations away as the curve.
        error = np.sqrt(variance)
        times = np.where(
            error > 0, reach.T / np.where(error > 0, error, 1.0), half_width(level, self.degrees)
        )
        below, above = times * np.sqrt(variance + added)
        low, high = reach.T
        return Band(centre, centre - low, centre + high, centre - below, centre + above)

    def variance_of_reading(self, reading: FloatArray, force: FloatArray) -> FloatArray:
        """Return the variance of new readings of the penetration in mm².

        A given variance is interpolated over the load.
        """
        return self.fit.noise.new_variance(reading - self.best.get("offset", 0.0), force)


def half_width(level: float, degrees: ArrayLike) -> FloatArray:
    """Return half-widths of intervals of this level in standard errors, at degrees of freedom."""
    from scipy import special

    tail, finite = (1 + level) / 2, np.isfinite(degrees)
    student = special.stdtrit(np.where(finite, degrees, 1.0), tail)
    return as_floats(np.where(finite, student, special.ndtri(tail)))
