"""Standard errors, intervals and tests of a fit to measurements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from pydantic import Field
from scipy import special

from cylcontact.arrays import FloatArray
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.uncertainty.profiles import (
    BETTER,
    FAIRLY,
    WELL,
    Interval,
    interval,
    is_at_bound,
)
from cylcontact.fitting.uncertainty.residual_model import (
    MEDIAN_TO_SIGMA,
    ResidualModel,
    measured,
    residual_model_at,
)
from cylcontact.parallel import Workers, call, collect
from cylcontact.spec import Spec

__all__ = [
    "LEVEL",
    "OUTLYING",
    "STRONG_CORRELATION",
    "Estimate",
    "Outlier",
    "Uncertainty",
    "uncertainty_of",
]

LEVEL = 0.95
# The half-width, relative to the value, up to which a parameter is poorly determined. The zero of a
# shift is arbitrary: its half-width counts by the relative change of the predictions.
_POORLY = 1.0
# Residuals this many robust standard deviations away are reported as outliers, which stay in.
OUTLYING = 3.5
STRONG_CORRELATION = 0.95
# The normal approximation of the runs test needs this many residuals of either sign.
_FEW_OF_A_SIGN = 8


class Estimate(Spec):
    """A free parameter with its standard error and intervals."""

    value: float = Field(description="the fitted value")
    standard_error: float | None = Field(description="from the covariance; null where undetermined")
    low: float | None = Field(description="lower end of the interval from the covariance")
    high: float | None = Field(description="upper end of the interval from the covariance")
    profile: Interval | None = Field(description="the interval from the profile likelihood")
    verdict: str = Field(description="well, fairly, poorly, not, or at a bound")


class Outlier(Spec):
    """A row far from the fitted law."""

    line: int = Field(description="its line in the table")
    deviations: float = Field(description="measured less fitted, in robust standard deviations")


class Uncertainty(Spec):
    """The uncertainty of the coefficients from the noise of measurements."""

    level: float = Field(description="the level of all intervals")
    rows: int = Field(description="measurements")
    degrees_of_freedom: int = Field(description="measurements less free parameters")
    residual_sigma: float = Field(description="standard deviation of the residuals")
    residual_unit: str = Field(description="the unit of the residuals")
    sigma_known: bool = Field(description="whether standard deviations came with the data")
    chi_square_p: float | None = Field(
        description="the probability of residuals this large, where their size is known"
    )
    runs_test_p: float | None = Field(
        description="the probability of so few changes of the residuals' sign along the load"
    )
    loss_scale: float | None = Field(description="the scale of a robust loss")
    estimates: dict[str, Estimate] = Field(description="each free parameter")
    correlation: dict[str, dict[str, float]] = Field(description="of the free parameters")
    only_together: list[str] = Field(
        description="parameters of which only a combination is identifiable"
    )
    duplicates: list[list[int]] = Field(description="lines of identical rows")
    outliers: list[Outlier] = Field(description="rows far from the fitted law; they stay in")
    notes: list[str] = Field(
        description="warnings about the intervals, and the sources of material constants"
    )


def uncertainty_of(
    problem: Problem, best: Mapping[str, float], level: float = LEVEL, jobs: Workers = 1
) -> Uncertainty:
    """Return the uncertainty of a fit to measurements.

    Parameters
    ----------
    problem : Problem
        On measurements.
    best : mapping
        The coefficients at its optimum.
    level : float
        Of all intervals.
    jobs : int or Cluster
        Where the profiles are computed.

    Returns
    -------
    Uncertainty
    """
    objective, point = measured(problem), problem.point(best)
    noise = residual_model_at(problem, point)
    data = objective.data
    estimates = _estimates(problem, noise, best, level, jobs)
    return Uncertainty(
        level=level,
        rows=noise.rows,
        degrees_of_freedom=noise.degrees,
        residual_sigma=noise.sigma,
        residual_unit=_unit(noise, objective.is_log, objective.of_load),
        sigma_known=noise.known,
        chi_square_p=noise.chi_square_p,
        runs_test_p=_runs_test(problem, point),
        loss_scale=None if objective.loss.is_linear else objective.loss.scale,
        estimates=estimates,
        correlation=_correlation(problem, noise),
        only_together=list(noise.blind),
        duplicates=data.duplicates(),
        outliers=_outliers(problem, noise, point),
        notes=[*noise.notes, *_better_optima(estimates), *data.data.notes],
    )


def _better_optima(estimates: Mapping[str, Estimate]) -> list[str]:
    """Return a warning for each profile that found a better optimum."""
    return [
        f"the profile of {name} found a better fit, (S − S_best)/τ = {e.profile.lowest:.3g}: the "
        "intervals are not those of the best fit; fit again with more starts"
        for name, e in estimates.items()
        if e.profile is not None and e.profile.lowest < BETTER
    ]


def _unit(noise: ResidualModel, is_log: bool, of_load: bool) -> str:
    """Return the unit of the residuals."""
    if noise.known:
        return "given standard deviations"
    quantity = "load" if of_load else "penetration"
    return f"share of the {quantity}" if is_log else ("N/mm" if of_load else "mm")


def _estimates(
    problem: Problem, noise: ResidualModel, best: Mapping[str, float], level: float, jobs: Workers
) -> dict[str, Estimate]:
    """Return each free parameter with its intervals."""
    names = [p.name for p in problem.free]
    profiles: Sequence[Interval | None] = [None] * len(names)
    if noise.covariance is not None and not noise.is_rounding:
        calls = [call(interval, problem, noise, name, best, level) for name in names]
        profiles = collect(calls, jobs)
    return {
        name: _estimate(best[name], noise, k, profile, level)
        for k, (name, profile) in enumerate(zip(names, profiles, strict=True))
    }


def _estimate(
    value: float, noise: ResidualModel, place: int, profile: Interval | None, level: float
) -> Estimate:
    """Return one parameter with its intervals."""
    if noise.covariance is None:
        return Estimate(
            value=value, standard_error=None, low=None, high=None, profile=None, verdict="not"
        )
    error = float(np.sqrt(max(noise.covariance[place, place], 0.0)))
    reach = noise.half_width(level) * error
    return Estimate(
        value=value,
        standard_error=error,
        low=value - reach,
        high=value + reach,
        profile=profile,
        verdict=_verdict(value, reach, profile, float(noise.per_unit[place])),
    )


def _verdict(value: float, reach: float, profile: Interval | None, per_unit: float) -> str:
    """Return "well", "fairly", "poorly", "not" or "at a bound" for a parameter."""
    half_width = reach
    if profile is not None:
        half_width = (profile.high - profile.low) / 2
        if is_at_bound(profile, value):
            return "at a bound"
        if profile.low_is_bound and profile.high_is_bound:
            return "not"
        if profile.low_is_bound or profile.high_is_bound:
            return "poorly"
    share = half_width * per_unit
    if share > _POORLY:
        return "not"
    if share > FAIRLY:
        return "poorly"
    return "well" if share <= WELL else "fairly"


def _correlation(problem: Problem, noise: ResidualModel) -> dict[str, dict[str, float]]:
    """Return the correlations of the free parameters; none without a covariance."""
    if noise.covariance is None:
        return {}
    names = [p.name for p in problem.free]
    errors = np.sqrt(np.maximum(np.diag(noise.covariance), 0.0))
    scale = np.outer(errors, errors)
    matrix = np.divide(noise.covariance, scale, out=np.eye(len(names)), where=scale > 0)
    return {
        one: {other: float(matrix[i, k]) for k, other in enumerate(names)}
        for i, one in enumerate(names)
    }


def _runs_test(problem: Problem, point: FloatArray) -> float | None:
    """Return the probability of so few runs of residuals of one sign (Wald and Wolfowitz 1940).

    Rows are sorted by pair and load. Noise changes sign at random; residuals of a law of the wrong
    shape do not. None if there are too few rows of either sign.
    """
    objective = measured(problem)
    _, group = objective.data.groups("pair")
    order = np.lexsort((objective.data.load, group))
    positive = objective.raw(problem.form(point[None, :]))[0][order] > 0
    n, m = int(positive.sum()), int((~positive).sum())
    if min(n, m) < _FEW_OF_A_SIGN:
        return None
    runs = 1 + int((positive[1:] != positive[:-1]).sum())
    mean = 1 + 2 * n * m / (n + m)
    variance = (mean - 1) * (mean - 2) / (n + m - 1)
    return float(special.ndtr((runs - mean) / np.sqrt(variance)))


def _outliers(problem: Problem, noise: ResidualModel, point: FloatArray) -> list[Outlier]:
    """Return the rows far from the law, in robust standard deviations."""
    objective = measured(problem)
    r = objective.raw(problem.form(point[None, :]))[0]
    spread = MEDIAN_TO_SIGMA * float(np.median(np.abs(r)))
    if noise.is_rounding or spread == 0:
        return []
    far = np.flatnonzero(np.abs(r) > OUTLYING * spread)
    return [
        Outlier(line=objective.data.line(int(k)), deviations=float(-r[k] / spread)) for k in far
    ]
