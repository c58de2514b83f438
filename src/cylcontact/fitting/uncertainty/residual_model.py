"""The residuals of a fit to measurements, and the covariance of its parameters.

With residuals r and J their derivatives by the free parameters at the optimum, least squares has
the covariance s²·(JᵀJ)⁻¹, where s² is 1 if the standard deviations are known and Σr²/(N − k) if
not. With a noise model r are in standard deviations, s² is 1, and the degrees of freedom are
Satterthwaite's (`restricted_likelihood`). With a robust loss it is the sandwich H⁻¹GH⁻¹ of
H = Σψ'JJᵀ and G = N/(N − k)·Σψ²JJᵀ (Huber 1981), ψ being half the loss's derivative. ψ' is negative
for large residuals of Cauchy's loss. If they are so many that H is not positive definite, there is
no covariance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy import special

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.measurements import Indices
from cylcontact.fitting.least_squares import jacobian
from cylcontact.fitting.loss import Loss
from cylcontact.fitting.measured_objective import measured
from cylcontact.fitting.noise_fit import likelihood_at
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.restricted_likelihood import Degrees

__all__ = [
    "MEDIAN_TO_SIGMA",
    "ROUNDING",
    "ResidualModel",
    "residual_model_at",
    "with_rows",
]

# A direction with a smaller singular value, relative to the largest, is not identifiable.
_BLIND = 1e-7
# It involves the parameters with at least this fraction of its largest component.
_INVOLVED = 0.1
# Smaller residuals are round-off: the data have no noise.
ROUNDING = 1e-11
# H, scaled to a diagonal of about 1, is positive definite if its smallest eigenvalue is larger.
_POSITIVE = 1e-12
_NOT_CURVED = (
    "too many residuals are far out for this robust loss: its curvature is not positive definite, "
    "and there is neither a covariance nor an interval; take a larger scale, or the Huber loss"
)
# From the median of |r| to a standard deviation of Gaussian residuals.
MEDIAN_TO_SIGMA = 1.4826


@dataclass(frozen=True, eq=False)
class ResidualModel:
    """The residuals at an optimum and what follows from them.

    Attributes
    ----------
    rows, free : int
        Measurements N and free parameters k.
    known : bool
        Whether the standard deviations were given with the data.
    robust : bool
        Whether the loss is robust.
    sum_of_squares : float
        The minimum S of the sum of squares, or of the robust loss.
    sigma : float
        Standard deviation of the residuals in their units: √(Σr²/(N − k)), or from their median
        with a robust loss.
    unit : float
        τ, such that (S(θ) − S)/τ has a χ² or F distribution; NaN if the robust loss has no
        curvature at the optimum.
    covariance : array of float, shape (k, k), or None
        Of the free parameters; None if they are not all identifiable.
    blind : tuple of str
        The parameters of which only a combination is identifiable. If there is no covariance for
        another reason, that is in `notes`.
    per_unit : array of float, shape (k,)
        Factor from a half-width to a relative one: 1/|value|. For a shift, whose zero is
        arbitrary, the root mean square of the relative change of the predictions per unit of it.
    notes : tuple of str
        Warnings for the report.
    satterthwaite : Degrees, optional
        Degrees of freedom with a noise model.
    """

    rows: int
    free: int
    known: bool
    robust: bool
    sum_of_squares: float
    sigma: float
    unit: float
    covariance: FloatArray | None
    blind: tuple[str, ...]
    per_unit: FloatArray
    notes: tuple[str, ...] = ()
    satterthwaite: Degrees | None = None

    @property
    def degrees(self) -> int:
        """Degrees of freedom, N − k."""
        return self.rows - self.free

    @property
    def is_rounding(self) -> bool:
        """Whether the data follow the law to round-off, without noise."""
        return not self.known and self.sigma < ROUNDING

    def degrees_of(self, contrasts: FloatArray) -> FloatArray:
        """Return the degrees of freedom of linear combinations of the parameters.

        Parameters
        ----------
        contrasts : array of float, shape (..., k)
            Their coefficients.

        Returns
        -------
        array of float, shape (...)
            Infinite if the standard deviations are known.
        """
        if self.satterthwaite is not None:
            return self.satterthwaite(contrasts)
        return np.full(contrasts.shape[:-1], np.inf if self.known else float(self.degrees))

    def degrees_of_each(self) -> FloatArray:
        """Return the degrees of freedom of each parameter, shape (k,)."""
        return self.degrees_of(np.eye(self.free))

    def half_width(self, level: float, degrees: ArrayLike) -> FloatArray:
        """Return half-widths of intervals of this level in standard errors."""
        tail, finite = (1 + level) / 2, np.isfinite(degrees)
        student = special.stdtrit(np.where(finite, degrees, 1.0), tail)
        return as_floats(np.where(finite, student, special.ndtri(tail)))

    def threshold(self, level: float, places: Sequence[int]) -> float:
        """Return the largest (S(θ) − S)/τ within a region of this level in these parameters."""
        number, degrees = len(places), float(self.degrees_of_each()[list(places)].min())
        if np.isinf(degrees):
            return float(special.chdtri(number, 1 - level))
        return float(number * special.fdtri(number, degrees, level))

    @property
    def chi_square_p(self) -> float | None:
        """The probability of residuals this large or larger; None if σ is not known.

        It is None with a robust loss as well, whose minimum has no χ² distribution.
        """
        if not self.known or self.robust:
            return None
        return float(special.chdtrc(self.degrees, self.sum_of_squares))


def residual_model_at(problem: Problem, point: FloatArray) -> ResidualModel:
    """Return the residual model at an optimum.

    Parameters
    ----------
    problem : Problem
        On measurements.
    point : array of float, shape (k,)
        Its optimum.

    Returns
    -------
    ResidualModel
    """
    objective = measured(problem)

    def raw(points: FloatArray) -> FloatArray:
        return objective.raw(problem.form(points))

    r = raw(point[None, :])[0]
    slopes = jacobian(problem, point, raw)
    degrees = r.size - point.size
    sigma = float(np.sqrt((r**2).sum() / degrees))
    if not objective.loss.is_linear:  # that of rows other than outliers
        sigma = MEDIAN_TO_SIGMA * float(np.median(np.abs(r))) * float(np.sqrt(r.size / degrees))
    known, robust = objective.has_sigma, not objective.loss.is_linear
    unit = 1.0 if known else sigma**2
    inverse, blind = _inverse(slopes)
    covariance = None if inverse is None else inverse * unit
    notes: tuple[str, ...] = ()
    if robust:
        unit, covariance = _sandwich(objective.loss, r, slopes, inverse)
        if covariance is None and inverse is not None:
            notes = (_NOT_CURVED,)
    names = [p.name for p in problem.free]
    satterthwaite = None
    if objective.noise is not None:
        satterthwaite = Degrees.of(likelihood_at(problem, point), objective.noise.deviations)
        unit, covariance = 1.0, None if inverse is None else satterthwaite.covariance
    return ResidualModel(
        rows=r.size,
        free=point.size,
        known=known,
        robust=robust,
        sum_of_squares=float(r.size * problem.value(point) ** 2),
        sigma=sigma,
        unit=unit,
        covariance=covariance,
        blind=tuple(names[k] for k in blind),
        per_unit=_per_unit(problem, point),
        notes=notes,
        satterthwaite=satterthwaite,
    )


def with_rows(problem: Problem, rows: Indices, series: Indices | None = None) -> Problem:
    """Return the problem with a selection of its measurements, possibly repeated.

    `series` renumbers the series of its noise model, of which repeated rows are others.
    """
    objective = measured(problem)
    noise = None if objective.noise is None else objective.noise.take(rows, series)
    part = replace(objective, data=objective.data.take(rows), noise=noise)
    return replace(problem, objective=part)


def _sandwich(
    loss: Loss, r: FloatArray, slopes: FloatArray, inverse: FloatArray | None
) -> tuple[float, FloatArray | None]:
    """Return τ and H⁻¹GH⁻¹ of a robust loss, given (JᵀJ)⁻¹; NaN and None without curvature."""
    psi, psi_slope = loss.psi(r), loss.psi_slope(r)
    degrees, mean_slope = r.size - slopes.shape[1], float(psi_slope.mean())
    unit = float((psi**2).sum() / degrees / mean_slope) if mean_slope > 0 else np.nan
    if inverse is None:
        return unit, None
    # Orthonormal columns scale H well, whatever the units of the parameters.
    root = np.linalg.cholesky(inverse)
    columns = slopes @ root
    curvature = (columns * psi_slope[:, None]).T @ columns
    if mean_slope <= 0 or np.linalg.eigvalsh(curvature)[0] <= _POSITIVE:
        return np.nan, None
    weighted = columns * psi[:, None]
    half = root @ np.linalg.inv(curvature)
    return unit, as_floats(half @ (weighted.T @ weighted) @ half.T * (r.size / degrees))


def _per_unit(problem: Problem, point: FloatArray) -> FloatArray:
    """Return the factors from half-widths to relative ones, shape (k,)."""
    objective = measured(problem)

    def differences(points: FloatArray) -> FloatArray:
        return objective.differences(problem.form(points))

    # The relative change of the predictions per unit of each parameter.
    observed = objective.observed
    size = observed if objective.is_log else np.full_like(observed, np.sqrt((observed**2).mean()))
    moved = jacobian(problem, point, differences) / size[:, None]
    effect = np.sqrt((moved**2).mean(axis=0))
    # Bounds on either side of zero make it arbitrary, whatever the law declares.
    is_shift = [p.shift or p.low < 0 < p.high for p in problem.free]
    with np.errstate(divide="ignore"):
        return as_floats(np.where(is_shift, effect, 1 / np.abs(point)))


def _inverse(slopes: FloatArray) -> tuple[FloatArray | None, list[int]]:
    """Return (JᵀJ)⁻¹, or None and the columns of which only a combination is identifiable."""
    size = np.sqrt((slopes**2).sum(axis=0))
    scaled = slopes / np.where(size > 0, size, 1.0)
    _, singular, directions = np.linalg.svd(scaled, full_matrices=False)
    if singular[-1] <= _BLIND * singular[0]:
        component = np.abs(directions[-1])
        return None, [int(k) for k in np.flatnonzero(component >= _INVOLVED * component.max())]
    half = directions.T / singular
    return as_floats(half @ half.T / np.outer(size, size)), []
