"""The noise that measurements show around a fit, and the covariance that it gives the parameters.

With residuals r and J their derivatives by the free parameters at the optimum, least squares has
the covariance s²·(JᵀJ)⁻¹, where s² is 1 if the standard deviations are known and Σr²/(N − k) if
not. With a robust loss it is the sandwich H⁻¹GH⁻¹ of H = Σψ'JJᵀ and G = N/(N − k)·Σψ²JJᵀ (Huber
1981), ψ being half the loss's derivative. ψ' is negative for far residuals of a loss that levels
off (Cauchy's); where they are so many that H is not positive definite there is no covariance.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import special

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.measurements import Indices
from cylcontact.fitting.least_squares import jacobian
from cylcontact.fitting.loss import Loss
from cylcontact.fitting.measured_objective import MeasuredObjective
from cylcontact.fitting.problem import Problem

# Singular values below this share of the largest one: the data do not see that direction.
BLIND = 1e-7
# A direction's parameters are those with at least this share of its largest component.
INVOLVED = 0.1
# Residuals below this are rounding: data without noise.
ROUNDING = 1e-11
# A curvature H is positive definite if its smallest eigenvalue, with H scaled to a diagonal of
# about 1, is above this.
POSITIVE = 1e-12
NOT_CURVED = (
    "too many residuals are far out for this robust loss: its curvature is not positive definite, "
    "and there is neither a covariance nor an interval; take a larger scale, or the Huber loss"
)
# From the median of |r| to a standard deviation of Gaussian residuals.
MEDIAN_TO_SIGMA = 1.4826


@dataclass(frozen=True, eq=False)
class ResidualModel:
    """What the residuals at the optimum say.

    Attributes
    ----------
    rows, free : int
        Measurements N and free parameters k.
    known : bool
        Whether the standard deviations were given with the data.
    robust : bool
        Whether the loss is another than that of least squares.
    sum_of_squares : float
        The minimum S of the sum of squares, or of the robust loss.
    sigma : float
        Standard deviation of the residuals, √(Σr²/(N − k)), from their median with a robust loss;
        its unit is that of the residuals.
    unit : float
        τ: (S(θ) − S)/τ is distributed like a square of Gaussians; NaN where the robust loss has
        no curvature there.
    covariance : array of float, shape (k, k), or None
        Of the free parameters; None where the data do not determine all of them.
    blind : tuple of str
        Where that is so, the parameters that only act together; empty where it is for another
        reason, which is then in `notes`.
    per_unit : array of float, shape (k,)
        What turns a half-width into a share: 1/|value|; for a shift, whose zero is a choice, the
        root mean square of the relative change of the predictions (of loads or penetrations,
        whichever the residuals compare) per unit of it, the others held.
    notes : tuple of str
        What has to be said beside the numbers.
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

    @property
    def degrees(self) -> int:
        """Degrees of freedom, N − k."""
        return self.rows - self.free

    @property
    def is_rounding(self) -> bool:
        """Whether the data follow the law to rounding, so that there is no noise to speak of."""
        return not self.known and self.sigma < ROUNDING

    def half_width(self, level: float) -> float:
        """Return how many standard errors an interval of this level reaches to either side."""
        tail = (1 + level) / 2
        if self.known:
            return float(special.ndtri(tail))
        return float(special.stdtrit(self.degrees, tail))

    def threshold(self, level: float, parameters: int = 1) -> float:
        """Return the largest (S(θ) − S)/τ within a region of this level for so many parameters."""
        if self.known:
            return float(special.chdtri(parameters, 1 - level))
        return float(parameters * special.fdtri(parameters, self.degrees, level))

    @property
    def chi_square_p(self) -> float | None:
        """The probability of residuals this large or larger, where their size is known.

        None with a robust loss, whose minimum is not distributed like χ².
        """
        if not self.known or self.robust:
            return None
        return float(special.chdtrc(self.degrees, self.sum_of_squares))


def measured(problem: Problem) -> MeasuredObjective:
    """Return a problem's objective, which has to be one on measurements."""
    if not isinstance(problem.objective, MeasuredObjective):
        raise TypeError("noise is that of measurements")
    return problem.objective


def residual_model_at(problem: Problem, point: FloatArray) -> ResidualModel:
    """Return what the residuals at an optimum say.

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
    if not objective.loss.is_linear:  # what is expected of a row that is no outlier
        sigma = MEDIAN_TO_SIGMA * float(np.median(np.abs(r))) * float(np.sqrt(r.size / degrees))
    known, robust = objective.has_sigma, not objective.loss.is_linear
    unit = 1.0 if known else sigma**2
    inverse, blind = _inverse(slopes)
    covariance = None if inverse is None else inverse * unit
    notes: tuple[str, ...] = ()
    if robust:
        unit, covariance = _sandwich(objective.loss, r, slopes, inverse)
        if covariance is None and inverse is not None:
            notes = (NOT_CURVED,)
    names = [p.name for p in problem.free]
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
        per_unit=_per_unit(problem, point, _effect(objective, r, slopes)),
        notes=notes,
    )


def with_rows(problem: Problem, rows: Indices) -> Problem:
    """Return the problem with some of its measurements, possibly repeated."""
    objective = measured(problem)
    return replace(problem, objective=replace(objective, data=objective.data.take(rows)))


def _sandwich(
    loss: Loss, r: FloatArray, slopes: FloatArray, inverse: FloatArray | None
) -> tuple[float, FloatArray | None]:
    """Return τ and H⁻¹GH⁻¹ of a robust loss, given (JᵀJ)⁻¹; NaN and None without curvature."""
    psi, psi_slope = loss.psi(r), loss.psi_slope(r)
    degrees, mean_slope = r.size - slopes.shape[1], float(psi_slope.mean())
    unit = float((psi**2).sum() / degrees / mean_slope) if mean_slope > 0 else np.nan
    if inverse is None:
        return unit, None
    # In columns that are orthonormal H is well scaled, whatever the units of the parameters.
    root = np.linalg.cholesky(inverse)
    columns = slopes @ root
    curvature = (columns * psi_slope[:, None]).T @ columns
    if mean_slope <= 0 or np.linalg.eigvalsh(curvature)[0] <= POSITIVE:
        return np.nan, None
    weighted = columns * psi[:, None]
    half = root @ np.linalg.inv(curvature)
    return unit, as_floats(half @ (weighted.T @ weighted) @ half.T * (r.size / degrees))


def _per_unit(problem: Problem, point: FloatArray, effect: FloatArray) -> FloatArray:
    """Return what turns half-widths into shares, shape (k,)."""
    # A search that crosses zero takes it for a value like any other, whatever is declared.
    is_shift = [p.name in problem.family.shifts or p.low < 0 < p.high for p in problem.free]
    with np.errstate(divide="ignore"):
        return as_floats(np.where(is_shift, effect, 1 / np.abs(point)))


def _effect(objective: MeasuredObjective, r: FloatArray, slopes: FloatArray) -> FloatArray:
    """Return the relative change of the predictions per unit of each parameter, shape (k,)."""
    moved = np.sqrt((slopes**2).mean(axis=0))
    if objective.is_log:
        return as_floats(moved)
    return as_floats(moved / np.sqrt((objective.predicted(r) ** 2).mean()))


def _inverse(slopes: FloatArray) -> tuple[FloatArray | None, list[int]]:
    """Return (JᵀJ)⁻¹, or None and the columns that only act together."""
    size = np.sqrt((slopes**2).sum(axis=0))
    scaled = slopes / np.where(size > 0, size, 1.0)
    _, singular, directions = np.linalg.svd(scaled, full_matrices=False)
    if singular[-1] <= BLIND * singular[0]:
        share = np.abs(directions[-1])
        return None, [int(k) for k in np.flatnonzero(share >= INVOLVED * share.max())]
    half = directions.T / singular
    return as_floats(half @ half.T / np.outer(size, size)), []
