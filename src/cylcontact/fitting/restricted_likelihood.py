"""Deviations of a noise model by restricted maximum likelihood, and degrees of freedom.

With the residuals r of the readings at the best parameters and X their derivatives, the columns of
fixed effects among them, the deviations minimise

    −2·ℓ = ln|V| + ln|XᵀV⁻¹X| + rᵀPr,   P = V⁻¹ − V⁻¹X(XᵀV⁻¹X)⁻¹XᵀV⁻¹

(Patterson and Thompson 1971), which allows for the parameters being estimated from the same data:
with constant scatter alone it gives Σr²/(N − k). The degrees of freedom of an estimate are
Satterthwaite's: 2C²/(gᵀAg), with C its variance, g the derivatives of C by the logarithms of the
deviations, and A their covariance from the curvature of ℓ.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.optimize import OptimizeResult, minimize

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.measurements import Indices
from cylcontact.fitting.noise_model import Covariance, basis_of

__all__ = ["Degrees", "Likelihood", "estimate"]

# Deviations are searched by their logarithms, within these of a first guess.
_LEAST, _MOST = -14.0, 9.0
# Steps of the derivatives of ℓ, and of its curvature.
_STEP, _WIDE_STEP = 1e-4, 1e-2
_OPTIONS: Any = {"ftol": 1e-14, "gtol": 1e-7, "maxiter": 500}
# A deviation is zero if −2ℓ loses no more than this by it.
_NO_LOSS = 1e-6


@dataclass(frozen=True, eq=False)
class Likelihood:
    """The restricted likelihood of deviations, for residuals at the best parameters.

    Attributes
    ----------
    covariance : Covariance
        Of N readings.
    residuals : array of float, shape (N,)
        Fitted less measured, in mm.
    slopes : array of float, shape (N, k)
        Their derivatives by the free parameters.
    """

    covariance: Covariance
    residuals: FloatArray
    slopes: FloatArray

    def __call__(self, deviations: Mapping[str, float]) -> float:
        """Return −2ℓ; inf if the covariance is singular."""
        inner, log_det = self._inner(deviations, self._reduced)
        if not np.isfinite(log_det):
            return np.inf
        normal = inner[1:, 1:]
        sign, log_normal = np.linalg.slogdet(normal)
        if sign <= 0:
            return np.inf
        rest = inner[0, 0] - inner[0, 1:] @ np.linalg.solve(normal, inner[1:, 0])
        return float(log_det + log_normal + rest)

    def log_likelihood(self, deviations: Mapping[str, float]) -> float:
        """Return ln L of the readings, not restricted, at the best parameters and fixed effects."""
        inner, log_det = self._inner(deviations, self._reduced)
        rest = inner[0, 0] - inner[0, 1:] @ np.linalg.solve(inner[1:, 1:], inner[1:, 0])
        return float(-0.5 * (self.residuals.size * np.log(2 * np.pi) + log_det + rest))

    def parameter_covariance(self, deviations: Mapping[str, float]) -> FloatArray:
        """Return the covariance of the free parameters, shape (k, k)."""
        design = np.hstack([self.slopes, self.covariance.fixed])
        size = np.linalg.norm(design, axis=0)
        size = np.where(size > 0, size, 1.0)
        inner, _ = self._inner(deviations, design / size)
        inverse = np.linalg.pinv(inner, hermitian=True) / np.outer(size, size)
        k = self.slopes.shape[1]
        return as_floats(inverse[:k, :k])

    @cached_property
    def _reduced(self) -> FloatArray:
        """The residuals, then an orthonormal basis of the derivatives and fixed effects."""
        basis = basis_of(np.hstack([self.slopes, self.covariance.fixed]))
        return np.column_stack([self.residuals, basis])

    def _inner(
        self, deviations: Mapping[str, float], columns: FloatArray
    ) -> tuple[FloatArray, float]:
        """Return MᵀV⁻¹M of columns M, shape (m, m), and ln|V|."""
        covariance = self.covariance
        variance = covariance.variance(deviations)
        if not (variance > 0).all():
            return np.zeros((columns.shape[1],) * 2), np.inf
        weighted = columns / variance[:, None]
        inner, log_det = columns.T @ weighted, float(np.log(variance).sum())
        if not covariance.is_random:
            return inner, log_det
        Z = covariance.columns * covariance.spread(deviations)
        own = _by_series(covariance.series, Z[:, :, None] * Z[:, None, :] / variance[:, None, None])
        shared = _by_series(covariance.series, Z[:, :, None] * weighted[:, None, :])
        core = np.eye(Z.shape[1]) + own
        inner = inner - np.einsum("gqa,gqb->ab", shared, np.linalg.solve(core, shared))
        return inner, log_det + float(np.linalg.slogdet(core)[1].sum())


def _by_series(series: Indices, values: FloatArray) -> FloatArray:
    """Return sums over the rows of each series, shape (N, ...) to (G, ...)."""
    order = np.argsort(series, kind="stable")
    starts = np.flatnonzero(np.diff(series[order], prepend=-1))
    return as_floats(np.add.reduceat(values[order], starts, axis=0))


def estimate(likelihood: Likelihood) -> dict[str, float]:
    """Return the deviations of largest restricted likelihood.

    Parameters
    ----------
    likelihood : Likelihood
        At the best parameters.

    Returns
    -------
    dict of str to float
        "constant" and "offset" and "drift" in mm, "proportional" and "gain" relative; 0 where the
        readings show none.

    Examples
    --------
    Twice the scatter in the residuals gives twice the deviation, √(Σr²/(N − k)):

    >>> from cylcontact.fitting.noise_model import NoiseModel
    >>> one, none = np.ones(4), np.zeros(4)
    >>> model = NoiseModel("constant")
    >>> covariance = Covariance(model, one, none, one, one, np.zeros(4, dtype=int), none)
    >>> r = np.array([1.0, -1.0, 1.0, -1.0])
    >>> round(estimate(Likelihood(covariance, r, one[:, None]))["constant"], 5)
    1.1547
    """
    names = likelihood.covariance.names
    if not names:
        return {}
    first = _guess(likelihood)

    def value(steps: FloatArray) -> float:
        return likelihood(_scaled(first, names, steps))

    def slopes(steps: FloatArray) -> FloatArray:
        return _gradient(value, steps)

    solution: OptimizeResult = minimize(
        value,
        np.zeros(len(names)),
        jac=slopes,
        method="L-BFGS-B",
        bounds=[(_LEAST, _MOST)] * len(names),
        options=_OPTIONS,
    )
    best, lowest = _scaled(first, names, solution.x), float(solution.fun)
    for name in sorted(names, key=lambda name: best[name] / first[name]):
        without = best | {name: 0.0}
        if (reached := likelihood(without)) <= lowest + _NO_LOSS:
            best, lowest = without, min(lowest, reached)
    return best


def _guess(likelihood: Likelihood) -> dict[str, float]:
    """Return deviations of the size of the residuals."""
    size = float(np.sqrt((likelihood.residuals**2).mean()))
    depth = float(np.sqrt((likelihood.covariance.depth**2).mean()))
    relative = ("proportional", "gain")
    return {
        name: (size / depth if name in relative else size) or 1e-12
        for name in likelihood.covariance.names
    }


def _scaled(
    first: Mapping[str, float], names: tuple[str, ...], steps: FloatArray
) -> dict[str, float]:
    """Return deviations by the logarithms of their ratios to the first guess."""
    return {name: first[name] * math.exp(step) for name, step in zip(names, steps, strict=True)}


def _gradient(value: Callable[[FloatArray], float], at: FloatArray) -> FloatArray:
    """Return the derivatives of a function by central differences."""
    steps = _STEP * np.eye(at.size)
    return np.array([(value(at + step) - value(at - step)) / (2 * _STEP) for step in steps])


@dataclass(frozen=True, eq=False)
class Degrees:
    """Satterthwaite's degrees of freedom of linear combinations of the parameters.

    Attributes
    ----------
    covariance : array of float, shape (k, k)
        Of the parameters.
    sensitivity : array of float, shape (m, k, k)
        Its derivatives by the logarithm of each deviation.
    spread : array of float, shape (m, m)
        The covariance of these logarithms.
    most : float
        Readings less parameters.
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

        size = len(active)
        steps = _WIDE_STEP * np.eye(size)
        ahead = [likelihood.parameter_covariance(at(step)) for step in steps]
        behind = [likelihood.parameter_covariance(at(-step)) for step in steps]
        sensitivity = np.array(
            [(a - b) / (2 * _WIDE_STEP) for a, b in zip(ahead, behind, strict=True)]
        )
        k = likelihood.slopes.shape[1]
        return cls(
            covariance=likelihood.parameter_covariance(deviations),
            sensitivity=sensitivity.reshape(size, k, k),
            spread=_inverse_curvature(lambda steps: 0.5 * likelihood(at(steps)), size),
            most=float(likelihood.residuals.size - k - likelihood.covariance.fixed.shape[1]),
        )

    def __call__(self, contrasts: FloatArray) -> FloatArray:
        """Return the degrees of freedom of contrasts, shape (..., k) to (...); at least 1.

        They are infinite if nothing was estimated.
        """
        variance = np.einsum("...i,ij,...j->...", contrasts, self.covariance, contrasts)
        if not self.sensitivity.size:
            return np.full_like(variance, np.inf)
        g = np.einsum("...i,mij,...j->...m", contrasts, self.sensitivity, contrasts)
        noise = np.einsum("...m,mn,...n->...", g, self.spread, g)
        with np.errstate(divide="ignore", invalid="ignore"):
            degrees = np.where(noise > 0, 2 * variance**2 / noise, np.inf)
        return as_floats(np.clip(degrees, 1.0, self.most))


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
