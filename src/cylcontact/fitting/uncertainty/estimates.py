"""Standard errors, intervals and tests of a fit to measurements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from pydantic import Field
from scipy import special

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.fitting.measured_objective import measured
from cylcontact.fitting.noise_model import FittedNoise
from cylcontact.fitting.problem import Problem
from cylcontact.fitting.uncertainty.findings import Finding, findings_of
from cylcontact.fitting.uncertainty.information import log_likelihood, number_estimated
from cylcontact.fitting.uncertainty.profiles import (
    BETTER,
    FAIRLY,
    WELL,
    Interval,
    interval,
    is_at_bound,
    refit_to_data,
)
from cylcontact.fitting.uncertainty.residual_model import (
    MEDIAN_TO_SIGMA,
    ResidualModel,
    residual_model_at,
    with_rows,
)
from cylcontact.parallel import Workers, call, collect
from cylcontact.spec import Spec

__all__ = [
    "LEVEL",
    "OUTLYING",
    "STRONG_CORRELATION",
    "Estimate",
    "FittedDeviations",
    "Outlier",
    "SeriesEffect",
    "Uncertainty",
    "series_effects",
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
# Readings whose scatter from one to the next can be told.
_FEWEST_NEIGHBOURS = 8


class Estimate(Spec):
    """A free parameter with its standard error and intervals."""

    value: float = Field(description="the fitted value")
    standard_error: float | None = Field(description="from the covariance; null where undetermined")
    low: float | None = Field(description="lower end of the interval from the covariance")
    high: float | None = Field(description="upper end of the interval from the covariance")
    profile: Interval | None = Field(description="the interval from the profile likelihood")
    verdict: str = Field(description="well, fairly, poorly, not, or at a bound")
    degrees_of_freedom: float | None = Field(
        None, description="of the standard error; null if the size of the noise is known"
    )
    nominal: float | None = Field(
        None, description="of a parameter of stiffness: its value for the pair as given"
    )


class Outlier(Spec):
    """A row far from the fitted law."""

    line: int = Field(description="its line in the table")
    deviations: float = Field(description="measured less fitted, in robust standard deviations")


class SeriesEffect(Spec):
    """What the readings of a series share, as estimated."""

    name: str = Field(description="the series")
    rows: int = Field(description="its rows")
    effects: dict[str, float] = Field(description="offset and drift in mm, gain relative")


class FittedDeviations(Spec):
    """The deviations of a noise model."""

    deviations: dict[str, float] = Field(
        description="constant, offset and drift in mm, proportional and gain relative"
    )
    random: bool = Field(description="whether the effects of the series are random")
    series: list[SeriesEffect] = Field(description="the series")


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
    noise: FittedDeviations | None = Field(None, description="of a noise model")
    log_likelihood: float | None = Field(
        None, description="of the readings in mm or N/mm; null with a robust loss"
    )
    estimated: int | None = Field(
        None, description="free parameters, deviations of the noise and fixed effects"
    )
    r_squared: float | None = Field(
        None,
        description="share of the variance of the readings that the law describes; with series, "
        "of that within them",
    )
    missed: float | None = Field(
        None, description="the residuals over the readings, root mean square, less series effects"
    )
    missed_over_scatter: float | None = Field(
        None, description="the residuals over the scatter from one reading to the next"
    )
    findings: list[Finding] = Field([], description="tests that the noise assumed fails")
    without_outliers: dict[str, float] = Field(
        {}, description="the coefficients without the outliers, if there are any"
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
    outliers = _outliers(problem, noise, point)
    missed, over_scatter = _missed(problem, point)
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
        outliers=outliers,
        notes=[*noise.notes, *_better_optima(estimates), *data.data.notes],
        noise=_deviations(problem, point),
        log_likelihood=log_likelihood(problem, point),
        estimated=number_estimated(problem),
        r_squared=_r_squared(problem, point),
        missed=missed,
        missed_over_scatter=None if noise.is_rounding else over_scatter,
        findings=findings_of(problem, point) if not noise.is_rounding else [],
        without_outliers=_without(problem, best, outliers),
    )


def _deviations(problem: Problem, point: FloatArray) -> FittedDeviations | None:
    """Return the deviations of the noise model and the effects of the series."""
    objective = measured(problem)
    if objective.noise is None:
        return None
    covariance, names = objective.noise.covariance, objective.noise.covariance.model.effects
    series: list[SeriesEffect] = []
    if names:
        over = covariance.model.over
        labels = objective.data.groups(over)[0] if over else ["all rows"]
        effects = _effects_of_series(problem, point, objective.noise)
        sizes = np.bincount(covariance.series)
        series = [
            SeriesEffect(
                name=label,
                rows=int(size),
                effects={name: float(v) for name, v in zip(names, own, strict=True)},
            )
            for label, size, own in zip(labels, sizes, effects, strict=True)
        ]
    return FittedDeviations(
        deviations=dict(objective.noise.deviations), random=covariance.is_random, series=series
    )


def _effects_of_series(problem: Problem, point: FloatArray, noise: FittedNoise) -> FloatArray:
    """Return the effects of each series, shape (G, q)."""
    return noise.series_effects(measured(problem).differences(problem.form(point[None, :]))[0])


def series_effects(problem: Problem, point: FloatArray) -> FloatArray | None:
    """Return what its series adds to each reading in mm, shape (N,); None without series."""
    noise = measured(problem).noise
    if noise is None or not noise.covariance.model.effects:
        return None
    effects = _effects_of_series(problem, point, noise)
    return as_floats((noise.covariance.columns * effects[noise.covariance.series]).sum(axis=1))


def _r_squared(problem: Problem, point: FloatArray) -> float | None:
    """Return 1 − Σ(fitted − measured)²/Σ(measured − mean)²; None if all readings are equal.

    What a series adds is no misfit of the law: the readings are less that, and the means those of
    the series.
    """
    objective = measured(problem)
    seen, rest = objective.observed, _less_series(problem, point)
    series = np.zeros(seen.size, dtype=np.intp)
    if objective.noise is not None:
        seen, series = seen + _effects(problem, point), objective.noise.covariance.series
    mean = np.bincount(series, seen) / np.bincount(series)
    total = float(((seen - mean[series]) ** 2).sum())
    return 1 - float((rest**2).sum()) / total if total > 0 else None


def _effects(problem: Problem, point: FloatArray) -> FloatArray:
    """Return the differences of the law, shape (N,), that are effects of the series, in mm."""
    effects = series_effects(problem, point)
    return np.zeros(len(measured(problem).data)) if effects is None else -effects


def _less_series(problem: Problem, point: FloatArray) -> FloatArray:
    """Return the fitted less the measured values, without what the series add, shape (N,)."""
    differences = measured(problem).differences(problem.form(point[None, :]))[0]
    return as_floats(differences - _effects(problem, point))


def _missed(problem: Problem, point: FloatArray) -> tuple[float, float | None]:
    """Return the residuals over the readings, and over the scatter from one to the next.

    The scatter is that of the second differences along the load, by their median, which a kink or
    an outlier does not move. None for fewer than `_FEWEST_NEIGHBOURS` readings.
    """
    objective = measured(problem)
    if objective.is_log:
        r, size = objective.raw(problem.form(point[None, :]))[0], 1.0
    else:
        r, size = _less_series(problem, point), float(np.sqrt((objective.observed**2).mean()))
    missed = float(np.sqrt((r**2).mean()))
    if r.size < _FEWEST_NEIGHBOURS or size == 0:
        return missed / size if size > 0 else 0.0, None
    over = "group" if "group" in objective.data.data.labels else "pair"
    bends = np.diff(r[np.lexsort((objective.data.load, objective.data.groups(over)[1]))], 2)
    scatter = MEDIAN_TO_SIGMA * float(np.median(np.abs(bends))) / np.sqrt(6)
    return missed / size, missed / scatter if scatter > 0 else None


def _without(
    problem: Problem, best: Mapping[str, float], outliers: Sequence[Outlier]
) -> dict[str, float]:
    """Return the coefficients of a fit without the outliers; none if there are none."""
    data = measured(problem).data
    lines = {outlier.line for outlier in outliers}
    rows = np.array([k for k in range(len(data)) if data.line(k) not in lines])
    if not lines or rows.size <= len(problem.free):
        return {}
    rest = with_rows(problem, rows)
    return rest.coefficients(refit_to_data(rest, rest.point(best))[0])


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
    if noise.satterthwaite is not None:
        return "estimated standard deviations"
    quantity = "load" if of_load else "penetration"
    return f"share of the {quantity}" if is_log else ("N/mm" if of_load else "mm")


def _estimates(
    problem: Problem, noise: ResidualModel, best: Mapping[str, float], level: float, jobs: Workers
) -> dict[str, Estimate]:
    """Return each free parameter with its intervals."""
    names = [p.name for p in problem.free]
    degrees = noise.degrees_of_each()
    profiles: Sequence[Interval | None] = [None] * len(names)
    if noise.covariance is not None and not noise.is_rounding:
        calls = [call(interval, problem, noise, name, best, level) for name in names]
        profiles = collect(calls, jobs)
    estimates = {}
    for k, (p, profile) in enumerate(zip(problem.free, profiles, strict=True)):
        estimate = _estimate(best[p.name], noise, k, profile, level, float(degrees[k]))
        nominal = p.nominal if p.stiffness else None
        estimates[p.name] = estimate.model_copy(update={"nominal": nominal})
    return estimates


def _estimate(
    value: float,
    noise: ResidualModel,
    place: int,
    profile: Interval | None,
    level: float,
    degrees: float,
) -> Estimate:
    """Return one parameter with its intervals."""
    if noise.covariance is None:
        return Estimate(
            value=value, standard_error=None, low=None, high=None, profile=None, verdict="not"
        )
    error = float(np.sqrt(max(noise.covariance[place, place], 0.0)))
    reach = float(noise.half_width(level, degrees)) * error
    return Estimate(
        value=value,
        standard_error=error,
        low=value - reach,
        high=value + reach,
        profile=profile,
        verdict=_verdict(value, reach, profile, float(noise.per_unit[place])),
        degrees_of_freedom=degrees if np.isfinite(degrees) else None,
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
