"""How measurements err: scatter that grows or not, errors of the load, series, and drift.

A reading of the penetration is δ = δ_law(f) + e with a Gaussian e of the covariance

    V = diag(σ_δ² + (dδ/df)²·σ_f² + s₀² + s₁²·δ_c²) + Z·diag(τ²)·Zᵀ.

σ_δ and σ_f are given with the data: deviations of the penetration and of the load, the latter
carried over by the slope of the law (the effective variance of Orear 1982). s₀ is a constant
scatter, s₁ one in proportion to the penetration δ_c of the contact. The readings of a series share
an offset, a gain and a drift, which are the columns of Z: 1, δ_c, and the position in the series
from 0 to 1. With five series or more these effects are random with deviations τ. With fewer a
deviation cannot be estimated; each series then gets its own fixed effects.

With the residuals r of the readings at the best parameters and X their derivatives, the columns of
fixed effects among them, the deviations minimise the restricted likelihood

    −2·ℓ = ln|V| + ln|XᵀV⁻¹X| + rᵀPr,   P = V⁻¹ − V⁻¹X(XᵀV⁻¹X)⁻¹XᵀV⁻¹

(Patterson and Thompson 1971), which allows for the parameters being estimated from the same data:
with constant scatter alone it gives Σr²/(N − k). The degrees of freedom of an estimate are
Satterthwaite's: 2C²/(gᵀAg), with C its variance, g the derivatives of C by the logarithms of the
deviations, and A their covariance from the curvature of ℓ; at least two.

Unless a fit says otherwise, both s₀ and s₁ are found. With few readings the data hardly tell the
two apart. `Mixture` then averages over how the scatter is split between them.

What is known of the parameters from elsewhere, such as a measured clearance, acts like further
readings of them (`Likelihood.known`).
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from operator import itemgetter
from types import MappingProxyType
from typing import Any

import numpy as np

from cylcontact.datasets.measurements import Indices, Measurements
from cylcontact.laws.law import ContactLaw
from cylcontact.support.arrays import FloatArray, as_floats

NOISES = ("constant", "proportional", "both")
# The objective of a fit to measurements: the root mean square of V^(−½)·(δ_law(f) − δ).
OBJECTIVE = "rms-standardised"
# Degrees of freedom of an estimate are at least these.
_FEWEST_DEGREES = 2.0
# A direction of the parameters with a smaller singular value, relative to the largest, has no
# effect on the readings.
DEPENDENT = 1e-7
# With fewer series than this, their effects are fixed.
FEWEST_RANDOM = 5
# Deviations relative to the penetration; the others are in mm.
RELATIVE = ("proportional", "gain")
# Deviations are searched by their logarithms, within these of a first guess.
_LEAST, _MOST = -14.0, 9.0
# The smallest share of a first guess from which a deviation is sought.
_SMALL = 0.02
# Steps of the derivatives of ℓ, and of its curvature.
_STEP, _WIDE_STEP = 1e-4, 1e-2
# Precision of −2ℓ in a search for the best start, and in the last one; the most steps.
_COARSE, _FINE, _MOST_STEPS = 1e-2, 1e-14, 500
# A deviation is zero if −2ℓ loses no more than this by it.
_NO_LOSS = 1e-6


@dataclass(frozen=True)
class NoiseModel:
    """The noise that a fit allows for; `MeasuredSpec` has the keys of a campaign.

    noise: how the scatter of single readings grows, None if their deviations are given; over: the
    grouping of the rows into series, None for one; drift: whether readings drift along a series;
    load_error: standard deviation of the loads relative to them, beside that in the data;
    has_offset: whether the law has a free offset, which is then the mean of fixed offsets.
    """

    noise: str | None
    over: str | None = None
    drift: bool = False
    load_error: float = 0.0
    has_offset: bool = False

    @property
    def is_given(self) -> bool:
        """Whether the deviations of single readings are given with them."""
        return self.noise is None

    @property
    def scatter(self) -> tuple[str, ...]:
        """The deviations of single readings that are estimated."""
        if self.noise is None:
            return ()
        return ("constant", "proportional") if self.noise == "both" else (self.noise,)

    @property
    def effects(self) -> tuple[str, ...]:
        """The effects that the readings of a series share."""
        series = ("offset", "gain") if self.over else ()
        return series + (("drift",) if self.drift else ())

    def covariance(self, data: Measurements, law: ContactLaw, offset: float = 0.0) -> Covariance:
        """Return the covariance of readings, for a law with its rig; the offset is in mm."""
        load, pair, columns = data.load, data.pair, data.columns
        reading = law.penetration(load, pair)
        zero = np.zeros(len(data))
        load_std = np.hypot(columns.get("load_std", zero), self.load_error * load)
        given = columns.get("penetration_std", zero) ** 2
        if load_std.any():
            with np.errstate(divide="ignore"):
                slope = np.where(load_std > 0, 1 / law.stiffness(reading, pair), 0.0)
            given = given + (slope * load_std) ** 2
        series = zero.astype(np.intp) if self.over is None else data.groups(self.over)[1]
        return Covariance(
            model=self,
            load=load,
            given=as_floats(given),
            depth=as_floats(reading - offset),
            series=series,
            position=positions(series, columns.get("time")),
        )


def positions(series: Indices, time: FloatArray | None) -> FloatArray:
    """Return the position of each row in its series, from 0 for the first to 1 at most."""
    along = np.empty(series.size)
    for number in np.unique(series):
        rows = np.flatnonzero(series == number)
        along[rows] = np.arange(rows.size) if time is None else time[rows] - time[rows].min()
    longest = float(along.max())
    return along / longest if longest > 0 else along


@dataclass(frozen=True, eq=False)
class Covariance:
    """The covariance of N readings, and the deviations in it that were estimated.

    load in N/mm; given: the variance of each row that is known beforehand, in mm²; depth: the
    penetration of the contact in mm; series of each row, from 0, and position in it; random:
    whether the effects of the series are random, as they stay in a part of the data, by default
    with five series or more.
    """

    model: NoiseModel
    load: FloatArray
    given: FloatArray
    depth: FloatArray
    series: Indices
    position: FloatArray
    random: bool | None = None
    deviations: Mapping[str, float] = field(default_factory=dict)

    @property
    def is_given(self) -> bool:
        """Whether all standard deviations are given with the data."""
        return not self.names

    @property
    def estimated(self) -> int:
        """The number of deviations and fixed effects that are estimated."""
        return len(self.names) + int(self.fixed.shape[1])

    @cached_property
    def is_random(self) -> bool:
        """Whether the effects of the series are random."""
        if self.random is not None:
            return self.random
        return bool(self.model.effects) and np.unique(self.series).size >= FEWEST_RANDOM

    @property
    def names(self) -> tuple[str, ...]:
        """The deviations that are estimated: of single readings, then of series."""
        return self.model.scatter + (self.model.effects if self.is_random else ())

    @cached_property
    def columns(self) -> FloatArray:
        """The effects of a series on its readings, shape (N, q)."""
        shapes = {"offset": np.ones_like(self.depth), "gain": self.depth, "drift": self.position}
        return as_floats(np.stack([shapes[name] for name in self.model.effects], axis=-1))

    @cached_property
    def fixed(self) -> FloatArray:
        """The columns of fixed effects, shape (N, m); none if the effects are random.

        Gains sum to zero, since their mean is the law's own stiffness; so do offsets beside a free
        offset of the law.
        """
        if self.is_random or not self.model.effects:
            return np.empty((self.depth.size, 0))
        member = self.series[:, None] == np.unique(self.series)
        parts = []
        for name, column in zip(self.model.effects, self.columns.T, strict=True):
            part = member * column[:, None]
            if name == "gain" or (name == "offset" and self.model.has_offset):
                part = part[:, 1:] - part[:, :1]
            parts.append(part)
        return as_floats(np.hstack(parts))

    def variance(self, deviations: Mapping[str, float]) -> FloatArray:
        """Return the variance of single readings in mm², shape (N,)."""
        constant = deviations.get("constant", 0.0)
        proportional = deviations.get("proportional", 0.0) * self.depth
        return as_floats(self.given + constant**2 + proportional**2)

    def spread(self, deviations: Mapping[str, float]) -> FloatArray:
        """Return the deviations of the columns of Z, shape (q,)."""
        return np.array([deviations[name] for name in self.model.effects])

    def take(self, rows: Indices) -> Covariance:
        """Return the covariance of a selection of rows."""
        return replace(
            self,
            load=self.load[rows],
            given=self.given[rows],
            depth=self.depth[rows],
            series=self.series[rows],
            position=self.position[rows],
            random=self.is_random,
        )

    # --- at the estimated deviations ----------------------------------------------------------

    def at(self, deviations: Mapping[str, float]) -> Covariance:
        """Return the covariance at some deviations."""
        return replace(self, deviations=deviations)

    @cached_property
    def scale(self) -> FloatArray:
        """The standard deviations of single readings in mm, shape (N,)."""
        return as_floats(np.sqrt(self.variance(self.deviations)))

    @cached_property
    def _blocks(self) -> list[tuple[Indices, FloatArray, FloatArray, FloatArray]]:
        """For G series of n rows their rows, shape (G, n), and the effects, scaled, by axes.

        These are Q of shape (G, n, m), orthonormal, and of the matrix between them the squares
        (G, m) and the axes (G, m, m).
        """
        if not self.is_random:
            return []
        columns = self.columns / self.scale[:, None] * self.spread(self.deviations)
        order = np.argsort(self.series, kind="stable")
        _, first, sizes = np.unique(self.series[order], return_index=True, return_counts=True)
        blocks = []
        for n in np.unique(sizes):
            rows = order[first[sizes == n, None] + np.arange(n)]
            Q, R = np.linalg.qr(columns[rows])
            values, vectors = np.linalg.eigh(R @ R.mT)
            blocks.append((rows, Q, np.maximum(values, 0.0), vectors))
        return blocks

    @property
    def log_det(self) -> float:
        """ln|V|."""
        shared = sum(np.log1p(values).sum() for _, _, values, _ in self._blocks)
        return float(2 * np.log(self.scale).sum() + shared)

    def white(self, values: FloatArray) -> FloatArray:
        """Return values in mm, (..., N), times a root of V⁻¹, symmetric up to the scale."""
        u = values / self.scale
        for rows, Q, squares, axes in self._blocks:
            part, shrunk = u[..., rows], 1 - 1 / np.sqrt(1 + squares)
            S = (axes * shrunk[:, None, :]) @ axes.mT
            u[..., rows] = part - ((part[..., None, :] @ Q) @ S @ Q.mT)[..., 0, :]
        return as_floats(u)

    @cached_property
    def _fixed_basis(self) -> FloatArray:
        return _basis_of(self.fixed / self.scale[:, None])

    def residuals(self, predicted: FloatArray, observed: FloatArray) -> FloatArray:
        """Return the whitened differences, (..., N), less what fixed effects explain."""
        u = self.white(predicted - observed)
        return as_floats(u - (u @ self._fixed_basis) @ self._fixed_basis.T)

    def series_effects(self, residuals: FloatArray) -> FloatArray:
        """Return the effects of each series, shape (G, q), from fitted less measured in mm.

        Offsets and drifts are in mm, gains relative. Random effects are the best linear unbiased
        predictions, fixed ones their least squares.
        """
        names, place = np.unique(self.series, return_inverse=True)
        effects = np.zeros((names.size, len(self.model.effects)))
        if self.is_random:
            weighted = self.white(-self.scale * self.white(residuals)) / self.scale  # −V⁻¹·r
            np.add.at(effects, place, self.columns * weighted[:, None])
            return as_floats(self.spread(self.deviations) ** 2 * effects)
        values = np.linalg.lstsq(self.fixed / self.scale[:, None], -residuals / self.scale)[0]
        member = place[:, None] == np.arange(names.size)
        design = (member[:, :, None] * self.columns[:, None, :]).reshape(place.size, -1)
        return as_floats(np.linalg.lstsq(design, self.fixed @ values)[0].reshape(effects.shape))

    def scatter_variance(self, depth: FloatArray, load: FloatArray) -> FloatArray:
        """Return the variance of single new readings in mm², without what their series shares."""
        # What is given at the loads of the data is interpolated between them.
        at, place = np.unique(self.load, return_inverse=True)
        mean = np.bincount(place, self.given) / np.bincount(place)
        proportional = self.deviations.get("proportional", 0.0) * depth
        constant = self.deviations.get("constant", 0.0)
        return as_floats(np.interp(load, at, mean) + proportional**2 + constant**2)

    def new_variance(self, depth: FloatArray, load: FloatArray) -> FloatArray:
        """Return the variance of a new reading of a new series in mm², at depths and loads."""
        shared = np.square([self.deviations.get(name, 0.0) for name in ("offset", "drift")]).sum()
        gain = self.deviations.get("gain", 0.0) * depth
        return as_floats(self.scatter_variance(depth, load) + gain**2 + shared)


def _basis_of(columns: FloatArray) -> FloatArray:
    """Return an orthonormal basis of the space of columns, which need not be independent."""
    length = np.linalg.norm(columns, axis=0)
    scaled = columns / np.where(length > 0, length, 1.0)
    left, singular, _ = np.linalg.svd(scaled, full_matrices=False)
    return as_floats(left[:, singular > DEPENDENT * singular.max(initial=0.0)])


# --- the deviations by restricted maximum likelihood ------------------------------------------


@dataclass(frozen=True, eq=False)
class Likelihood:
    """The restricted likelihood of deviations, from residuals in mm and their slopes (N, k).

    What is known of the parameters from elsewhere acts like m further readings, in units of their
    standard deviations: `known` has the differences, shape (m,), and `known_slopes` is (m, k).
    """

    covariance: Covariance
    residuals: FloatArray
    slopes: FloatArray
    known: FloatArray = field(default_factory=lambda: np.empty(0))
    known_slopes: FloatArray = field(default_factory=lambda: np.empty((0, 0)))

    def __call__(self, deviations: Mapping[str, float]) -> float:
        """Return −2ℓ; inf if the covariance or the information matrix is singular."""
        log_det, normal, rest = self._terms_or_infinite(deviations)
        value = float(log_det + np.linalg.slogdet(normal)[1] + rest)
        return value if np.isfinite(value) else np.inf

    @cached_property
    def log_likelihood(self) -> float:
        """ln L of the readings, not restricted, at its largest over deviations and parameters.

        Whatever is assumed of the noise, it is the likelihood of the same readings in mm.
        """

        def unrestricted(deviations: Mapping[str, float]) -> float:
            log_det, _, rest = self._terms_or_infinite(deviations)
            return log_det + rest

        names = self.covariance.names
        best = _largest(unrestricted, names, self._first()) if names else {}
        lowest = unrestricted(best)
        if not np.isfinite(lowest):
            raise np.linalg.LinAlgError("Singular matrix")
        return -0.5 * (self.residuals.size * float(np.log(2 * np.pi)) + lowest)

    def _terms_or_infinite(
        self, deviations: Mapping[str, float]
    ) -> tuple[float, FloatArray, float]:
        """Return `_terms`; where the covariance or the information matrix is singular, infinity.

        A search over the deviations tries such ones on its way.
        """
        if (self.covariance.variance(deviations) > 0).all():
            with contextlib.suppress(np.linalg.LinAlgError):
                return self._terms(deviations)
        return np.inf, np.eye(1), np.inf

    def _first(self) -> dict[str, float]:
        """Return a first guess of the deviations."""
        size = float(np.sqrt((self.residuals**2).mean()))
        depth = float(np.sqrt((self.covariance.depth**2).mean()))
        shares = {
            name: size / depth if name in RELATIVE else size for name in self.covariance.names
        }
        return {name: share or 1e-12 for name, share in shares.items()}

    def _terms(self, deviations: Mapping[str, float]) -> tuple[float, FloatArray, float]:
        """Return ln|V|, XᵀV⁻¹X in an orthonormal basis of the columns of X, and rᵀPr."""
        white = self._white(V := self.covariance.at(deviations), self._reduced)
        inner = white @ white.T
        normal = inner[1:, 1:]
        rest = inner[0, 0] - inner[0, 1:] @ np.linalg.solve(normal, inner[1:, 0])
        return V.log_det, normal, float(rest)

    def parameter_covariance(self, deviations: Mapping[str, float]) -> FloatArray:
        """Return the covariance of the free parameters, shape (k, k)."""
        X = self._white(self.covariance.at(deviations), self._design.T)
        size = np.linalg.norm(X, axis=1)
        X = X / np.where(size > 0, size, 1.0)[:, None]
        k, size = self.slopes.shape[1], np.where(size > 0, size, 1.0)
        inverse = np.linalg.pinv(X @ X.T, rcond=DEPENDENT**2, hermitian=True)
        return as_floats((inverse / np.outer(size, size))[:k, :k])

    @cached_property
    def _reduced(self) -> FloatArray:
        """The residuals, then an orthonormal basis of the derivatives and fixed effects."""
        return np.vstack([np.concatenate([self.residuals, self.known]), self.basis.T])

    @cached_property
    def basis(self) -> FloatArray:
        """An orthonormal basis of the derivatives and fixed effects, shape (N + m, rank)."""
        return _basis_of(self._design)

    @property
    def degrees(self) -> int:
        """Readings, and what is known, less parameters and fixed effects."""
        return int(self.residuals.size + self.known.size - self.basis.shape[1])

    @cached_property
    def _design(self) -> FloatArray:
        """The derivatives by the parameters and fixed effects, shape (N + m, k + q)."""
        design = np.hstack([self.slopes, self.covariance.fixed])
        if not self.known.size:
            return design
        more = np.zeros((self.known.size, design.shape[1]))
        more[:, : self.slopes.shape[1]] = self.known_slopes
        return np.vstack([design, more])

    def _white(self, V: Covariance, values: FloatArray) -> FloatArray:
        """Return values of shape (..., N + m) whitened; what is known is in its own deviations."""
        N = self.residuals.size
        return np.concatenate([V.white(values[..., :N].copy()), values[..., N:]], axis=-1)


def estimate(
    likelihood: Likelihood, start: Mapping[str, float] = MappingProxyType({})
) -> dict[str, float]:
    """Return the deviations of largest restricted likelihood, sought from `start`, if given.

    "constant", "offset" and "drift" are in mm, "proportional" and "gain" relative; 0 where the
    readings show none, NaN where the information matrix is singular at all deviations tried.
    """
    names = likelihood.covariance.names
    return _largest(likelihood, names, likelihood._first(), start) if names else {}


def sharpened(likelihood: Likelihood, deviations: Mapping[str, float]) -> dict[str, float]:
    """Return deviations found after a step of Newton's method on the slopes of the likelihood.

    A search ends where the likelihood is flat to rounding. The zero of its slopes is known to many
    more digits, so that another computer finds the same.
    """
    active = tuple(name for name in deviations if deviations[name] > 0)

    def value(steps: FloatArray) -> float:
        return likelihood({**deviations, **_scaled(deviations, active, steps)})

    step = -_inverse_curvature(value, len(active)) @ _slopes(value, np.zeros(len(active)))
    if not np.abs(step).max(initial=0.0) < _WIDE_STEP:  # on a bound, or not at the lowest
        return dict(deviations)
    return {**deviations, **_scaled(deviations, active, step)}


def _slopes(value: Callable[[FloatArray], float], at: FloatArray) -> FloatArray:
    steps = _STEP * np.eye(at.size)
    return np.array([(value(at + step) - value(at - step)) / (2 * _STEP) for step in steps])


def _largest(
    minus_twice: Callable[[Mapping[str, float]], float],
    names: tuple[str, ...],
    first: Mapping[str, float],
    start: Mapping[str, float] = MappingProxyType({}),
) -> dict[str, float]:
    """Return the deviations of the lowest −2ℓ; NaN if it is infinite at all that were tried."""

    def value(steps: FloatArray) -> float:
        return minus_twice(_scaled(first, names, steps))

    from scipy.optimize import minimize  # slow to import

    def descend(at: FloatArray, precision: float) -> tuple[float, FloatArray]:
        # L-BFGS-B would wait for threads of OpenBLAS at each step.
        slopes, bounds = partial(_slopes, value), [(_LEAST, _MOST)] * at.size
        options: Any = {"ftol": precision, "maxiter": _MOST_STEPS}
        with np.errstate(invalid="ignore"):  # where the likelihood is infinite on both sides
            end = minimize(value, at, jac=slopes, method="SLSQP", bounds=bounds, options=options).x
        return value(end), end

    if start:  # from 0 the search could not return
        at = np.log([max(start[name] / first[name], _SMALL) for name in names])
        ends = [(value(at), at)]
    else:  # few readings may have several minima: in each start but one a deviation exceeds others
        k = len(names)
        starts = np.vstack([np.ones(k), np.where(np.eye(k) > 0, 1.0, _SMALL)])[: k + (k > 1)]
        ends = [descend(np.log(each), _COARSE) for each in starts]
    coarse = min(ends, key=itemgetter(0))
    lowest, at = min(coarse, descend(coarse[1], _FINE), key=itemgetter(0))
    best = _scaled(first, names, at)
    for name in sorted(names, key=lambda name: best[name] / first[name]):
        without = best | {name: 0.0}
        if (reached := minus_twice(without)) <= lowest + _NO_LOSS:
            best, lowest = without, min(lowest, reached)
    return best if np.isfinite(lowest) else dict.fromkeys(names, np.nan)


def _scaled(
    first: Mapping[str, float], names: tuple[str, ...], steps: FloatArray
) -> dict[str, float]:
    return {name: first[name] * math.exp(step) for name, step in zip(names, steps, strict=True)}


# --- degrees of freedom -----------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Degrees:
    """Satterthwaite's degrees of freedom of linear combinations of the parameters.

    covariance of the parameters, shape (k, k); sensitivity: its derivatives by the logarithm of
    each deviation, (m, k, k); spread: the covariance of these logarithms, (m, m); most: readings
    less parameters, infinite where a parameter may be known from elsewhere.
    """

    covariance: FloatArray
    sensitivity: FloatArray
    spread: FloatArray
    most: float

    @classmethod
    def of(cls, likelihood: Likelihood, deviations: Mapping[str, float]) -> Degrees:
        """Return the degrees of freedom at the estimated deviations."""
        active = tuple(name for name in deviations if deviations[name] > 0)

        def at(steps: FloatArray) -> dict[str, float]:
            return {**deviations, **_scaled(deviations, active, steps)}

        def covariance(steps: FloatArray) -> FloatArray:
            return likelihood.parameter_covariance(at(steps))

        k, m = likelihood.slopes.shape[1], len(active)
        slopes = [
            (covariance(step) - covariance(-step)) / (2 * _WIDE_STEP)
            for step in _WIDE_STEP * np.eye(m)
        ]
        return cls(
            covariance=likelihood.parameter_covariance(deviations),
            sensitivity=np.reshape(slopes, (m, k, k)),
            spread=_inverse_curvature(lambda steps: 0.5 * likelihood(at(steps)), m),
            most=np.inf if likelihood.known.size else float(likelihood.degrees),
        )

    def __call__(self, contrasts: FloatArray) -> FloatArray:
        """Return the degrees of freedom of contrasts, (..., k) to (...); inf if all is given."""
        variance = np.einsum("...i,ij,...j->...", contrasts, self.covariance, contrasts)
        if not self.sensitivity.size:
            return np.full_like(variance, np.inf)
        g = np.einsum("...i,mij,...j->...m", contrasts, self.sensitivity, contrasts)
        noise = np.einsum("...m,mn,...n->...", g, self.spread, g)
        with np.errstate(divide="ignore", invalid="ignore"):
            degrees = np.where(noise > 0, 2 * variance**2 / noise, np.inf)
        return as_floats(np.clip(degrees, min(_FEWEST_DEGREES, self.most), self.most))


def _inverse_curvature(value: Callable[[FloatArray], float], size: int) -> FloatArray:
    """Return the inverse of the second derivatives at 0, without directions that do not curve."""
    steps = _WIDE_STEP * np.eye(size)
    curvature = np.empty((size, size))
    for i in range(size):
        for j in range(i, size):
            a, b = steps[i], steps[j]
            mixed = value(a + b) - value(a - b) - value(b - a) + value(-a - b)
            curvature[i, j] = curvature[j, i] = mixed / (4 * _WIDE_STEP**2)
    values, vectors = np.linalg.eigh(curvature)
    curved = values > 1e-6 * max(float(values.max(initial=0.0)), 1e-12)
    inverse = np.where(curved, 1 / np.where(curved, values, 1.0), 0.0)
    return as_floats((vectors * inverse) @ vectors.T)


# --- few readings -----------------------------------------------------------------------------

# With as many degrees of freedom an interval does not average over the split of the noise any
# more; with so many it does so wholly.
_MANY, _FEW = 10.0, 8.0
# Splits of the noise, from constant alone to proportional alone, and halvings of an interval.
_NODES, _HALVINGS = 24, 50


@dataclass(frozen=True, eq=False)
class Mixture:
    """What the readings say of the parameters, averaged over the split of the noise.

    The scatter is s₀² = s²·cos²φ and s₁² = s²·sin²φ/q², with q the root mean square of δ_c, and a
    uniform φ. At each of n nodes the size s is integrated out: the parameters have a Student
    distribution of N − k degrees of freedom, and the node the weight of its likelihood.

    shift: the best parameters less those of the fit, (n, k); covariance (n, k, k); weight (n,).
    """

    shift: FloatArray
    covariance: FloatArray
    weight: FloatArray
    degrees: float

    @classmethod
    def of(cls, likelihood: Likelihood) -> Mixture | None:
        """Return the mixture; None where the readings tell the two apart, or it is not needed."""
        V, degrees = likelihood.covariance, float(likelihood.degrees)
        needed = V.names == ("constant", "proportional") and not V.given.any()
        if not needed or degrees >= _MANY or likelihood.known.size or degrees < 1:
            return None
        size = float(np.sqrt((V.depth**2).mean()))
        shifts, covariances, values = [], [], []
        for angle in (np.arange(_NODES) + 0.5) / _NODES * np.pi / 2:
            split = {"constant": math.cos(angle), "proportional": math.sin(angle) / size}
            C = likelihood.parameter_covariance(split)
            white = V.at(split).white(likelihood._reduced)
            rest = white[0] - white[1:].T @ np.linalg.lstsq(white[1:].T, white[0])[0]
            variance = float(rest @ rest) / degrees
            log_det = float(np.linalg.slogdet(white[1:] @ white[1:].T)[1])
            values.append(degrees * math.log(variance) + V.at(split).log_det + log_det)
            slopes = V.at(split).white(likelihood.slopes.T)
            shifts.append(-C @ slopes @ white[0])
            covariances.append(variance * C)
        weight = np.exp(-0.5 * (np.array(values) - min(values)))
        return cls(np.array(shifts), np.array(covariances), weight / weight.sum(), degrees)

    def widening(self, contrasts: FloatArray, reach: FloatArray, level: float) -> FloatArray:
        """Return by how much intervals of m contrasts (m, k) are to be wider, below and above.

        `reach` is their half-width by the deviations found, (m,); the factors are (m, 2), 1 or
        more.
        """
        from scipy import special

        centre = self.shift @ contrasts.T
        variance = np.einsum("mi,nij,mj->nm", contrasts, self.covariance, contrasts)
        error = np.sqrt(np.maximum(variance, np.finfo(float).tiny))
        far = special.stdtrit(self.degrees, 0.5 + 0.4999) * error
        ends = []
        for tail in ((1 - level) / 2, (1 + level) / 2):
            low, high = (centre - far).min(axis=0), (centre + far).max(axis=0)
            for _ in range(_HALVINGS):
                middle = (low + high) / 2
                below = self.weight @ special.stdtr(self.degrees, (middle - centre) / error) < tail
                low, high = np.where(below, middle, low), np.where(below, high, middle)
            ends.append(np.abs((low + high) / 2))
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.nan_to_num(np.stack(ends, axis=-1) / reach[:, None], nan=1.0, posinf=1.0)
        share = min(1.0, (_MANY - self.degrees) / (_MANY - _FEW))
        return as_floats(np.maximum(ratio, 1.0) ** share)
