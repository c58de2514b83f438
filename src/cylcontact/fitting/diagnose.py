"""What the residuals of a fit show: tests of the law and of the noise that it assumes.

The noise is taken to be independent, steady, and of one size. Each test of that which fails is a
finding: what the residuals show, and the option that allows for it. All use the residuals in the
units in which they should be alike, whitened by the noise model if there is one.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from scipy import special

from cylcontact.datasets.measurements import Indices
from cylcontact.fitting.measured import MEDIAN_TO_SIGMA, Fit
from cylcontact.fitting.noise import Covariance, positions
from cylcontact.fitting.optimum import BETTER, Optimum, half_width
from cylcontact.fitting.records import (
    FAIRLY,
    WELL,
    Estimate,
    Finding,
    FittedDeviations,
    Interval,
    Outlier,
    SeriesEffect,
    Uncertainty,
)
from cylcontact.support.arrays import FloatArray, as_floats
from cylcontact.support.parallel import Workers, call, collect

# A test fails below this probability.
SURPRISING = 0.01
# Residuals this many robust standard deviations away are reported as outliers, which stay in.
OUTLYING = 3.5
# Rows that a test needs, and rows of a series that its trend needs.
_FEWEST, _FEWEST_IN_SERIES = 12, 4
# Readings that differ relatively by less are equal.
_ROUNDING = 1e-12
# Load and penetration of a lower correlation of ranks have opposite signs.
_OPPOSITE = -0.5
# Readings whose scatter from one to the next can be told.
_FEWEST_NEIGHBOURS = 8


def findings_of(optimum: Optimum) -> list[Finding]:
    """Return the tests of the noise that fail."""
    if optimum.r.size < _FEWEST + optimum.point.size:
        return []
    tests = (_series, _drift, _sequence, _spread)
    with np.errstate(divide="ignore", invalid="ignore"):  # of readings or loads that are all equal
        findings = [finding for test in tests if (finding := test(optimum)) is not None]
    names = {finding.test for finding in findings}
    # A series or a drift explains a sequence of like residuals.
    if names & {"series", "pairs", "drift"}:
        findings = [finding for finding in findings if finding.test != "sequence"]
    return findings


def _failed(test: str, p: float | None, says: str, remedy: str) -> Finding | None:
    """Return a finding if such residuals are surprising; p is None or NaN if none can tell."""
    if p is None or not p < SURPRISING:
        return None
    return Finding(test=test, p=p, says=says, remedy=remedy)


def _groups(optimum: Optimum, name: str) -> tuple[list[str], Indices] | None:
    """Return the groups of a grouping; None if the table has none or only one."""
    data = optimum.fit.data
    if name == "group" and name not in data.data.labels:
        return None
    names, index = data.groups(name)
    return (names, index) if len(names) > 1 else None


def _series_of_rows(optimum: Optimum, *names: str) -> Indices:
    """Return the group of each row in the first of some groupings that there is."""
    groupings = [groups for name in names if (groups := _groups(optimum, name))]
    return groupings[0][1] if groupings else np.zeros(optimum.r.size, dtype=np.intp)


def _allowed(optimum: Optimum) -> tuple[str, ...]:
    return () if optimum.fit.noise is None else optimum.fit.noise.model.effects


def _series(optimum: Optimum) -> Finding | None:
    """Test whether residuals depend on the series: a mean and a trend along the load of each."""
    if "offset" in _allowed(optimum):
        return None
    over = "group" if _groups(optimum, "group") else "pair"
    groups = _groups(optimum, over)
    if groups is None:
        return None
    names, index = groups
    member = as_floats(index[:, None] == np.arange(len(names)))
    load = np.log(optimum.fit.data.load)
    columns = np.hstack([member, member * (load - load.mean())[:, None]])
    p = _f_test(optimum, columns)
    if over == "group":
        return _failed(
            "series",
            p,
            f"the {len(names)} series of the column group differ by more than the scatter within "
            "them, so that the intervals are too narrow",
            "allow for it with --group group",
        )
    return _failed(
        "pairs",
        p,
        f"the residuals differ between the {len(names)} pairs of the table: each pair has errors "
        "of its own, or the law is wrong in the clearance or the moduli",
        "name the series by a column, and add --group COLUMN",
    )


def _drift(optimum: Optimum) -> Finding | None:
    """Test whether residuals have trends along the rows of the series, each its own."""
    if "drift" in _allowed(optimum):
        return None
    index = _series_of_rows(optimum, "group", "pair")
    data = optimum.fit.data
    position = _less_mean(positions(index, data.columns.get("time")), index)
    load = _less_mean(np.log(data.load), index)
    if abs(np.corrcoef(position, load)[0, 1]) > 0.9:
        return None  # along a single sweep of the load a drift looks like another law
    p = _f_test(optimum, position[:, None] * (index[:, None] == np.unique(index)))
    says = "the residuals drift along the rows of a series"
    return _failed("drift", p, says, "allow for it with --drift")


def _less_mean(values: FloatArray, index: Indices) -> FloatArray:
    return as_floats(values - (np.bincount(index, values) / np.bincount(index))[index])


def _sequence(optimum: Optimum) -> Finding | None:
    """Test whether each residual is like the one before, by their correlation."""
    index = _series_of_rows(optimum, "group")
    order = np.argsort(index, kind="stable")
    r, same = optimum.r[order], np.diff(index[order]) == 0
    r = r - r.mean()
    correlation = float((r[1:] * r[:-1])[same].sum() / (r**2).sum())
    p = float(special.ndtr(-correlation * np.sqrt(r.size)))
    load = optimum.fit.data.load
    turns = np.diff(np.sign(np.diff(load)))
    remedy = "repeat some loads, in another order: this may be a drift, or the law's shape"
    if np.any(turns != 0):
        untried = {
            "offset": "name the series by a column with --group COLUMN",
            "drift": "allow for a drift with --drift",
        }
        options = [text for effect, text in untried.items() if effect not in _allowed(optimum)]
        remedy = ", or ".join([*options, "try other laws with `cylcontact choose`"])
    says = (
        f"readings in sequence err alike (correlation {correlation:.2f}), so that the intervals "
        "are too narrow"
    )
    return _failed("sequence", p, says, remedy)


def _spread(optimum: Optimum) -> Finding | None:
    noise = optimum.fit.noise
    if optimum.known:
        return None
    size = _ranks(np.abs(optimum.r))
    correlation = float(np.corrcoef(size, _ranks(optimum.fit.observed))[0, 1])
    degrees = optimum.r.size - 2
    t = correlation * np.sqrt(degrees / max(1 - correlation**2, 1e-12))
    p = 2 * float(special.stdtr(degrees, -abs(t)))
    grows = "grows" if correlation > 0 else "falls"
    relative = " relative to it" if optimum.fit.is_log else ""
    if noise is not None:
        relative = " relative to that assumed"
    remedy = "allow for both kinds of scatter with --noise both"
    if noise is not None and len(noise.model.scatter) == 2:
        remedy = "look for what else makes readings scatter"
    return _failed("spread", p, f"the scatter of the readings{relative} {grows} with them", remedy)


def _f_test(optimum: Optimum, columns: FloatArray) -> float | None:
    """Return the probability of residuals that depend on columns so much; None if too few rows."""
    r = optimum.r
    design = np.column_stack([np.ones(r.size), columns])
    left, singular, _ = np.linalg.svd(design, full_matrices=False)
    basis = left[:, singular > 1e-10 * singular[0]]
    rank, rest = basis.shape[1] - 1, r.size - optimum.point.size - basis.shape[1]
    if rank < 1 or rest < _FEWEST_IN_SERIES:
        return None
    explained = float(((basis.T @ r) ** 2).sum()) - r.size * float(r.mean()) ** 2
    left_over = max(float((r**2).sum()) - float(((basis.T @ r) ** 2).sum()), 1e-300)
    return float(special.fdtrc(rank, rest, max(explained, 0.0) / rank / (left_over / rest)))


def _ranks(values: FloatArray) -> FloatArray:
    """Return the ranks of values; ties share their mean."""
    _, place, counts = np.unique(values, return_inverse=True, return_counts=True)
    return as_floats((np.cumsum(counts) - (counts - 1) / 2)[place])


# --- how well the law describes the readings --------------------------------------------------


def _outlying(optimum: Optimum) -> dict[int, float]:
    """Return the rows far from the law, and by how many robust standard deviations."""
    spread = MEDIAN_TO_SIGMA * float(np.median(np.abs(optimum.r)))
    if optimum.is_rounding or spread == 0:
        return {}
    deviations = dict(enumerate(-optimum.r / spread))
    return {row: float(size) for row, size in deviations.items() if abs(size) > OUTLYING}


def r_squared(optimum: Optimum) -> float | None:
    """Return the share of the variance within series that the law describes; None without any."""
    noise, added = optimum.fit.noise, optimum.series_in_mm
    rest, seen = _less_series(optimum), optimum.fit.observed - (0.0 if added is None else added)
    series = np.zeros(seen.size, dtype=np.intp) if noise is None else noise.series
    mean = np.bincount(series, seen) / np.bincount(series)
    total = float(((seen - mean[series]) ** 2).sum())
    if total <= _ROUNDING**2 * float((seen**2).sum()):
        return None
    return 1 - float((rest**2).sum()) / total


def _falls(optimum: Optimum) -> bool:
    """Return whether the penetration falls as the load rises, by Spearman's correlation."""
    data = optimum.fit.data
    if min(np.ptp(data.load), np.ptp(data.penetration)) == 0:
        return False
    return bool(np.corrcoef(_ranks(data.load), _ranks(data.penetration))[0, 1] < _OPPOSITE)


def _less_series(optimum: Optimum) -> FloatArray:
    """Return the fitted less the measured values, without what the series add, shape (N,)."""
    added = optimum.series_in_mm
    return optimum.differences if added is None else optimum.differences + added


def missed(optimum: Optimum) -> tuple[float, float | None]:
    """Return the residuals over the readings, and over the scatter from one to the next.

    The scatter is that of the second differences along the load, by their median, which a kink or
    an outlier does not move. None for fewer than `_FEWEST_NEIGHBOURS` readings.
    """
    fit, size = optimum.fit, 1.0
    if fit.is_log:
        r = optimum.r
    else:
        r, size = _less_series(optimum), float(np.sqrt((fit.observed**2).mean()))
    rms = float(np.sqrt((r**2).mean()))
    if r.size < _FEWEST_NEIGHBOURS or size == 0:
        return rms / size if size > 0 else 0.0, None
    over = "group" if "group" in fit.data.data.labels else "pair"
    bends = np.diff(r[np.lexsort((fit.data.load, fit.data.groups(over)[1]))], 2)
    scatter = MEDIAN_TO_SIGMA * float(np.median(np.abs(bends))) / np.sqrt(6)
    return rms / size, rms / scatter if scatter > 0 else None


# --- standard errors, intervals and verdicts ----------------------------------------------------

LEVEL = 0.95
# The half-width, relative to the value, up to which a parameter is poorly determined. The zero of a
# shift is arbitrary: its half-width counts by the relative change of the predictions.
_POORLY = 1.0
STRONG_CORRELATION = 0.95


def uncertainty_of(optimum: Optimum, level: float = LEVEL, jobs: Workers = 1) -> Uncertainty:
    """Return the uncertainty of a fit to readings; profiles are computed by `jobs`."""
    fit, data = optimum.fit, optimum.fit.data
    estimates = _estimates(optimum, level, jobs)
    far = _outlying(optimum)
    share_missed, over_scatter = missed(optimum)
    better = [
        f"the profile of {name} found a better fit, (S − S_best)/τ = {e.profile.lowest:.3g}: the "
        "intervals are not those of the best fit; fit again with more starts"
        for name, e in estimates.items()
        if e.profile is not None and e.profile.lowest < BETTER
    ]
    return Uncertainty(
        level=level,
        rows=len(data),
        degrees_of_freedom=optimum.degrees,
        residual_sigma=optimum.sigma,
        residual_unit=_unit(fit),
        sigma_known=optimum.known,
        chi_square_p=optimum.chi_square_p,
        estimates=estimates,
        correlation=_correlation(optimum),
        only_together=optimum.blind,
        duplicates=data.duplicates(),
        outliers=[Outlier(line=data.line(row), deviations=far[row]) for row in far],
        notes=[*better, *data.data.notes],
        noise=None if fit.noise is None else _deviations(optimum, fit.noise),
        log_likelihood=optimum.log_likelihood,
        estimated=optimum.estimated,
        r_squared=r_squared(optimum),
        missed=share_missed,
        missed_over_scatter=None if optimum.is_rounding else over_scatter,
        falls=_falls(optimum),
        findings=[] if optimum.is_rounding else findings_of(optimum),
        without_outliers=_without(optimum, far),
    )


def _deviations(optimum: Optimum, noise: Covariance) -> FittedDeviations:
    series, effects = [], optimum.series
    if effects is not None:
        over, data = noise.model.over, optimum.fit.data
        labels = data.groups(over)[0] if over else ["all rows"]
        series = [
            SeriesEffect(
                name=label,
                rows=int(size),
                effects=dict(zip(noise.model.effects, own.tolist(), strict=True)),
            )
            for label, size, own in zip(labels, np.bincount(noise.series), effects, strict=True)
        ]
    deviations = dict(noise.deviations)
    return FittedDeviations(deviations=deviations, random=noise.is_random, series=series)


def _without(optimum: Optimum, far: Collection[int]) -> dict[str, float]:
    """Return the coefficients of a fit without the outliers; none if there are none."""
    rows = np.setdiff1d(np.arange(optimum.r.size), list(far))
    if not far or rows.size <= optimum.point.size:
        return {}
    rest = optimum.fit.take(rows)
    return rest.coefficients(rest.minimise(optimum.point).point)


def _unit(fit: Fit) -> str:
    if fit.has_sigma:
        return "given standard deviations"
    if fit.noise is not None:
        return "estimated standard deviations"
    if fit.is_log:
        return "share of the penetration"
    return "mm"


def _estimates(optimum: Optimum, level: float, jobs: Workers) -> dict[str, Estimate]:
    names = optimum.fit.names
    profiles: Sequence[Interval | None] = [None] * len(names)
    if optimum.covariance is not None and not optimum.is_rounding:
        profiles = collect([call(optimum.interval, name, level) for name in names], jobs)
    return {
        name: _estimate(optimum, k, profile, level)
        for k, (name, profile) in enumerate(zip(names, profiles, strict=True))
    }


def _estimate(optimum: Optimum, k: int, profile: Interval | None, level: float) -> Estimate:
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
    if optimum.covariance is None:
        return {}
    names, scale = optimum.fit.names, np.outer(optimum.errors, optimum.errors)
    matrix = np.divide(optimum.covariance, scale, out=np.eye(len(names)), where=scale > 0)
    rows = zip(names, matrix.tolist(), strict=True)
    return {name: dict(zip(names, row, strict=True)) for name, row in rows}
