"""The uncertainty of coefficients from the noise of readings: errors, intervals and verdicts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydantic import Field

from cylcontact.fitting.diagnose import (
    Finding,
    Outlier,
    findings_of,
    missed,
    outliers,
    r_squared,
    runs_test,
)
from cylcontact.fitting.measured import Fit
from cylcontact.fitting.noise import FittedNoise
from cylcontact.fitting.optimum import BETTER, Optimum, half_width
from cylcontact.fitting.records import FAIRLY, WELL, Interval
from cylcontact.parallel import Workers, call, collect
from cylcontact.spec import Spec

LEVEL = 0.95
# The half-width, relative to the value, up to which a parameter is poorly determined. The zero of a
# shift is arbitrary: its half-width counts by the relative change of the predictions.
_POORLY = 1.0
STRONG_CORRELATION = 0.95


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


def uncertainty_of(optimum: Optimum, level: float = LEVEL, jobs: Workers = 1) -> Uncertainty:
    """Return the uncertainty of a fit to readings; profiles are computed by `jobs`."""
    fit, data = optimum.fit, optimum.fit.data
    estimates = _estimates(optimum, level, jobs)
    far = outliers(optimum)
    share_missed, over_scatter = missed(optimum)
    return Uncertainty(
        level=level,
        rows=len(data),
        degrees_of_freedom=optimum.degrees,
        residual_sigma=optimum.sigma,
        residual_unit=_unit(fit),
        sigma_known=optimum.known,
        chi_square_p=optimum.chi_square_p,
        runs_test_p=runs_test(optimum),
        loss_scale=fit.loss.scale if optimum.robust else None,
        estimates=estimates,
        correlation=_correlation(optimum),
        only_together=optimum.blind,
        duplicates=data.duplicates(),
        outliers=far,
        notes=[*optimum.notes, *_better_optima(estimates), *data.data.notes],
        noise=None if fit.noise is None else _deviations(optimum, fit.noise),
        log_likelihood=optimum.log_likelihood,
        estimated=optimum.estimated,
        r_squared=r_squared(optimum),
        missed=share_missed,
        missed_over_scatter=None if optimum.is_rounding else over_scatter,
        findings=[] if optimum.is_rounding else findings_of(optimum),
        without_outliers=_without(optimum, far),
    )


def _deviations(optimum: Optimum, noise: FittedNoise) -> FittedDeviations:
    """Return the deviations of the noise model and the effects of the series."""
    covariance, series, effects = noise.covariance, [], optimum.series
    if effects is not None:
        over, data = covariance.model.over, optimum.fit.data
        labels = data.groups(over)[0] if over else ["all rows"]
        series = [
            SeriesEffect(
                name=label,
                rows=int(size),
                effects=dict(zip(noise.effects, own.tolist(), strict=True)),
            )
            for label, size, own in zip(
                labels, np.bincount(covariance.series), effects, strict=True
            )
        ]
    deviations = dict(noise.deviations)
    return FittedDeviations(deviations=deviations, random=covariance.is_random, series=series)


def _without(optimum: Optimum, far: Sequence[Outlier]) -> dict[str, float]:
    """Return the coefficients of a fit without the outliers; none if there are none."""
    data, lines = optimum.fit.data, {outlier.line for outlier in far}
    rows = np.array([k for k in range(len(data)) if data.line(k) not in lines])
    if not lines or rows.size <= optimum.point.size:
        return {}
    rest = optimum.fit.take(rows)
    return rest.coefficients(rest.minimise(optimum.point).point)


def _better_optima(estimates: dict[str, Estimate]) -> list[str]:
    """Return a warning for each profile that met a better optimum."""
    return [
        f"the profile of {name} found a better fit, (S − S_best)/τ = {e.profile.lowest:.3g}: the "
        "intervals are not those of the best fit; fit again with more starts"
        for name, e in estimates.items()
        if e.profile is not None and e.profile.lowest < BETTER
    ]


def _unit(fit: Fit) -> str:
    """Return the unit of the residuals."""
    if fit.has_sigma:
        return "given standard deviations"
    if fit.noise is not None:
        return "estimated standard deviations"
    if fit.is_log:
        return f"share of the {'load' if fit.of_load else 'penetration'}"
    return "N/mm" if fit.of_load else "mm"


def _estimates(optimum: Optimum, level: float, jobs: Workers) -> dict[str, Estimate]:
    """Return each free parameter with its intervals."""
    names = optimum.fit.names
    profiles: Sequence[Interval | None] = [None] * len(names)
    if optimum.covariance is not None and not optimum.is_rounding:
        profiles = collect([call(optimum.interval, name, level) for name in names], jobs)
    return {
        name: _estimate(optimum, k, profile, level)
        for k, (name, profile) in enumerate(zip(names, profiles, strict=True))
    }


def _estimate(optimum: Optimum, k: int, profile: Interval | None, level: float) -> Estimate:
    """Return one parameter with its intervals."""
    parameter, value = optimum.fit.free[k], float(optimum.point[k])
    nominal = parameter.nominal if parameter.stiffness else None
    if optimum.covariance is None:
        nothing = dict.fromkeys(("standard_error", "low", "high", "profile"))
        return Estimate(value=value, verdict="not", nominal=nominal, **nothing)
    error, degrees = float(optimum.errors[k]), float(optimum.degrees_of_each()[k])
    reach = float(half_width(level, degrees)) * error
    return Estimate(
        value=value,
        standard_error=error,
        low=value - reach,
        high=value + reach,
        profile=profile,
        verdict=_verdict(value, reach, profile, float(optimum.per_unit[k])),
        degrees_of_freedom=degrees if np.isfinite(degrees) else None,
        nominal=nominal,
    )


def _verdict(value: float, reach: float, profile: Interval | None, per_unit: float) -> str:
    """Return "well", "fairly", "poorly", "not" or "at a bound" for a parameter."""
    half_width = reach
    if profile is not None:
        half_width = (profile.high - profile.low) / 2
        if profile.is_at_bound(value):
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


def _correlation(optimum: Optimum) -> dict[str, dict[str, float]]:
    """Return the correlations of the free parameters; none without a covariance."""
    if optimum.covariance is None:
        return {}
    names, scale = optimum.fit.names, np.outer(optimum.errors, optimum.errors)
    matrix = np.divide(optimum.covariance, scale, out=np.eye(len(names)), where=scale > 0)
    rows = zip(names, matrix.tolist(), strict=True)
    return {name: dict(zip(names, row, strict=True)) for name, row in rows}
