"""What readings show against a fit: coefficients with verdicts, tests of the noise, sentences.

The noise is taken to be independent and steady. Each test of that which fails gives a sentence:
what the residuals show, how unlikely that is, and the option that allows for it. All use the
residuals in standard deviations, in which they should be alike.
"""

from __future__ import annotations

import shlex
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from cylcontact.datasets.measurements import Indices, Measurements
from cylcontact.files.units import column_named, symbol
from cylcontact.fitting.adapters import CorrectedInputs
from cylcontact.fitting.noise import positions
from cylcontact.fitting.readings import MEDIAN_TO_SIGMA, Interval, Optimum, half_width
from cylcontact.fitting.records import (
    FAIRLY,
    POORLY,
    WELL,
    Estimate,
    FittedDeviations,
    SeriesEffect,
    with_verdict,
)
from cylcontact.support.arrays import BoolArray, FloatArray, as_floats
from cylcontact.support.choices import listed
from cylcontact.support.parallel import Workers, call, collect

LEVEL = 0.95
# A test fails below this probability.
_SURPRISING = 0.01
# Outliers are beyond A + B/N robust standard deviations, where the largest of N Gaussian residuals
# is in one of a hundred tables (5.4 for N = 8, 4.9 for 12, 4.4 for 30), or so far from a fit to the
# others as one of N is in one of two hundred. They stay in.
_OUTLYING, _MORE_FOR_FEW, _BY_CHANCE = 4.0, 11.0, 0.005
# Below this ratio a profile found a better optimum; it is not round-off.
_BETTER = -1e-6
# Rows that a test needs, and rows of a series that its trend needs.
_FEWEST, _FEWEST_IN_SERIES = 12, 4
# A standard error above this share of what was known before is as given.
_AS_GIVEN = 0.9
# Readings that differ relatively by less are equal.
_ROUNDING = 1e-12
# Load and penetration of a lower correlation of ranks have opposite signs.
_OPPOSITE = -0.5
# Readings whose scatter from one to the next can be told.
_FEWEST_NEIGHBOURS = 8
_STRONG_CORRELATION = 0.95
# A law that describes less than this share of the variance of readings is not theirs; nor is one
# that misses them by more than a share of them, and by several times their scatter.
_DESCRIBED = 0.8
_MISSED, _TIMES_SCATTER = 0.05, 3.0
# A stiffness that is certainly outside these, over that of the pair as given, is not the pair's.
_USUAL_STIFFNESS = (0.8, 1.25)
# Errors of inputs that a sentence names: ΔR in mm, and a share of E.
_MICROMETRE, _PERCENT = 1e-3, 0.01
# At most so many rows of the data are listed.
_LISTED = 8

# --- sentences ----------------------------------------------------------------------------------

COMPLIANCE = (
    "compliance is the extra displacement per unit load that the law does not include (mounting, "
    "rig, housing); it may be negative"
)
_MEANINGS = {
    "stiffness_factor": "stiffness_factor multiplies the load; it acts like a larger modulus",
    "compliance": COMPLIANCE,
}
_DATUM = "the reference point, the housing or the rig (try --free compliance)"
_DETERMINED = {
    "poorly": f"poorly determined, as the interval is wider than ±{100 * FAIRLY:g} % of the value "
    "(for a shift: of the prediction) or ends at a bound of the search",
    "not": f"not determined by these data, as the interval is wider than ±{100 * POORLY:g} % of "
    "the value (for a shift: of the prediction), reaches both bounds of the search, or is missing",
    "at a bound": "at a bound of the search: widen it",
}
# Deviations of series in words, with their factor from mm or a share.
_AMOUNTS = {
    "offset": ("{} µm of offset", 1e3),
    "gain": ("{} % of gain", 100.0),
    "drift": ("{} µm of drift", 1e3),
}


def warnings_of(optimum: Optimum, estimates: Mapping[str, Estimate]) -> list[str]:
    """Return what the readings show against the law or the noise assumed, with the remedy."""
    sentences = [
        _on_misfit(optimum),
        _on_chi_square(optimum),
        *_on_stiffness(optimum, estimates),
        *([] if optimum.is_rounding else tests_of_noise(optimum)),
        _on_outliers(optimum),
    ]
    return [sentence for sentence in sentences if sentence]


def notes_of(optimum: Optimum, level: float, determined: Sequence[str]) -> list[str]:
    """Return the size of the noise, and how the parameters are determined and correlated."""
    groups = [" = ".join(map(str, lines)) for lines in optimum.fit.data.duplicates()]
    duplicates = f"identical rows, all of them counted: lines {_listed(groups, '; ')}"
    all_determined = (
        f"every free parameter is determined to within ±{100 * FAIRLY:g} % of its value, or of the "
        f"prediction for a shift (well: ±{100 * WELL:g} %)"
    )
    return [
        _on_noise(optimum, level),
        *_on_inputs(optimum),
        *([] if determined else [all_determined]),
        *(text for name, text in _MEANINGS.items() if name in optimum.fit.names),
        *_on_correlations(optimum),
        *([duplicates] if groups else []),
    ]


def describes(optimum: Optimum) -> bool:
    """Return whether a law describes the readings at all."""
    return not _misfit(optimum)


def _misfit(optimum: Optimum) -> str:
    """Return by how much a law misses readings that it does not describe; "" if it does."""
    share, (missed, times) = r_squared(optimum), _missed(optimum)
    if share is not None and share < _DESCRIBED:
        return f"R² = {share:.3g}"
    if optimum.is_rounding or times is None or missed < _MISSED or times < _TIMES_SCATTER:
        return ""
    return (
        f"the residuals are {100 * missed:.2g} % of them (root mean square), {times:.2g} times "
        "the scatter between neighbouring readings"
    )


def _on_misfit(optimum: Optimum) -> str:
    how = _misfit(optimum)
    if not how:
        return ""
    if _falls(optimum):
        return (
            f"the law does not describe these readings ({how}): the penetration falls as the load "
            "rises, so one of them has the opposite sign (--sign penetration, or --sign load)"
        )
    causes = ("the units of the columns", "the materials", "the radii")
    said = _causes(optimum, "and", *causes, "a kink (the seat settles)", "a drift")
    return f"the law does not describe these readings ({how}): check {said}"


def _causes(optimum: Optimum, word: str, *causes: str) -> str:
    *first, last = causes if "compliance" in optimum.fit.names else (*causes, _DATUM)
    return f"{', '.join(first)}, {word} {last}"


def _on_stiffness(optimum: Optimum, estimates: Mapping[str, Estimate]) -> list[str]:
    sentences, (least, most) = [], _USUAL_STIFFNESS
    causes = ("a diameter given as a radius", "another unit", "another material", "another law")
    for p in optimum.fit.free:
        e = estimates[p.name]
        if not (p.stiffness and p.nominal) or e.low is None or e.high is None:
            continue
        if e.low / p.nominal > most or e.high / p.nominal < least:
            sentences.append(
                f"{p.name} is {e.value:.3g} ({e.low:.3g} to {e.high:.3g}), but would be "
                f"{p.nominal:.3g} for the pair as given; possible causes: "
                f"{_causes(optimum, 'or', *causes)}"
            )
    return sentences


def stated_in(data: Measurements, unit: str) -> tuple[float, str]:
    """Return the size and the name of the unit of a report: for mm that of the readings."""
    column = column_named(f"penetration_{data.data.units.get('penetration', 'mm')}")
    if unit != "mm" or column is None:
        return 1.0, unit
    return column.factor, symbol(column.unit)


def _on_outliers(optimum: Optimum) -> str:
    far, line = outliers(optimum), optimum.fit.data.line
    if not far:
        return ""
    lines = [f"{line(row)} ({size:+.1f})" for row, size in far.items()]
    without = _without(optimum, far)
    changes = []
    for p, value in zip(optimum.fit.free, optimum.point, strict=True):
        if p.name in without:
            size, unit = stated_in(optimum.fit.data, p.unit)
            change = f"{p.name} {value / size:.4g} → {without[p.name] / size:.4g}"
            changes.append(f"{change} {unit}".rstrip())
    return (
        "outliers, far from a fit to the others (in robust standard deviations), included in the "
        f"fit: lines {_listed(lines, ', ')}{'; without them ' if changes else ''}"
        f"{', '.join(changes)} (--exclude {','.join(str(line(row)) for row in [*far][:_LISTED])})"
    )


def _listed(texts: Sequence[str], mark: str) -> str:
    return mark.join(texts[:_LISTED]) + (", …" if len(texts) > _LISTED else "")


def _on_noise(optimum: Optimum, level: float) -> str:
    if optimum.is_rounding:
        return (
            "the data follow the law to round-off: there is no noise to estimate, and no interval"
        )
    noise, stated = optimum.fit.noise, optimum.fit.noise.model.scatter
    parts = [_on_scatter(optimum)] if stated else [_on_given(optimum)]
    parts += _on_series(deviations_of(optimum))
    if not noise.model.effects:
        parts.append(f"intervals are at {100 * level:g} % and hold if the law is right")
    else:
        parts.append(f"intervals are at {100 * level:g} %")
    return "; ".join(parts)


def _on_scatter(optimum: Optimum) -> str:
    """Return the scatter of single readings that was found."""
    deviations = optimum.fit.noise.deviations
    constant, share = (deviations.get(name, 0.0) for name in ("constant", "proportional"))
    found = "standard deviation, found from the residuals"
    texts = {
        "constant": f"±{1e3 * constant:.3g} µm at any load",
        "proportional": f"±{100 * share:.3g} % of the penetration",
    }
    names = optimum.fit.noise.model.scatter
    if len(names) == 1:
        return f"noise: {texts[names[0]]} ({found}; --noise {names[0]})"
    if constant > 0 and share > 0:
        words = f"noise: {texts['constant']} and {texts['proportional']} ({found})"
        words += f", equal at {1e3 * constant / share:.3g} µm"
    else:
        kind, other = ("constant", "proportional") if share == 0 else ("proportional", "constant")
        words = f"noise: {texts[kind]} ({found}); no {other} part"
    if optimum.mixture is not None:
        words += (
            f"; {optimum.r.size} readings hardly tell the two kinds apart, and the intervals allow "
            "for that"
        )
    return words


def _on_given(optimum: Optimum) -> str:
    """Return what the residuals are beside given standard deviations."""
    p = optimum.chi_square_p
    if p is None:
        return "single readings have the standard deviations given"
    if p > 1 - _SURPRISING:
        return (
            "the residuals are smaller than the given standard deviations: those look too large "
            f"(p = {p:.3g})"
        )
    return _on_chi_square(optimum) or (
        f"the residuals are as large as the given standard deviations allow (p = {p:.3g})"
    )


def _on_chi_square(optimum: Optimum) -> str:
    p = optimum.chi_square_p
    if p is None or p >= _SURPRISING:
        return ""
    return (
        "the residuals are larger than the given standard deviations allow: the law is wrong, or "
        f"the deviations are too small; the intervals are too narrow (p = {p:.3g})"
    )


def _on_inputs(optimum: Optimum) -> list[str]:
    """Return what errors of the inputs would change, or what the readings say of them."""
    fit, known = optimum.fit, [p for p in optimum.fit.free if p.known is not None]
    if known:
        learned = [
            f"{p.name} (±{100 * error / p.known[1]:.0f} % of the uncertainty given)"
            for p, error in zip(fit.free, optimum.errors.tolist(), strict=True)
            if p.known is not None and error <= _AS_GIVEN * p.known[1]
        ]
        told = f"the readings narrow {', '.join(learned)}" if learned else "none is narrowed"
        return [
            f"known from elsewhere, and fitted as further readings: "
            f"{', '.join(p.name for p in known)}; {told}"
        ]
    stiffness = next((k for k, p in enumerate(fit.free) if p.stiffness), None)
    if optimum.is_rounding or stiffness is None or optimum.unidentifiable:
        return []
    name, value = fit.names[stiffness], optimum.point[stiffness]
    changes = []
    for words, corrected in (
        ("1 µm more of ΔR", {"dR": _MICROMETRE}),
        ("1 % more of E", {"E": _PERCENT}),
    ):
        moved = _moved(optimum, **corrected)[stiffness]
        changes.append(f"{words} would change {name} by {100 * moved / value:+.2g} %")
    if not np.isfinite(moved):
        return []
    return [
        f"radii and moduli are taken as exact: {', '.join(changes)} (--uncertain, if you know them "
        "only so well)"
    ]


def _moved(optimum: Optimum, dR: float = 0.0, E: float = 0.0) -> FloatArray:
    """Return how the free parameters move with an error of an input, to first order, (k,)."""
    data = optimum.fit.data
    stated = tuple((float(at), float(at) + dR) for at in np.unique(data.columns["dR"]))
    law = CorrectedInputs(optimum.law, stated if dR else (), (1 + E, 1 + E))
    with np.errstate(invalid="ignore"):
        change = law.penetration(data.load, data.pair) - optimum.law.penetration(
            data.load, data.pair
        )
    J, V = optimum.likelihood.slopes, optimum.fit.noise
    return as_floats(-optimum.covariance @ V.white(J.T) @ V.white(change))


def _on_series(noise: FittedDeviations) -> list[str]:
    """Return how much series differ, or that their effects are fixed."""
    shared = {name: size for name, size in noise.deviations.items() if name in _AMOUNTS}
    words = [
        _AMOUNTS[name][0].format(f"{_AMOUNTS[name][1] * size:.3g}") for name, size in shared.items()
    ]
    number = len(noise.series)
    if words:
        return [f"the {number} series differ by {', '.join(words)} (standard deviations)"]
    if number > 1:
        return [
            f"the {number} series have fixed effects, so the intervals hold for these series, not "
            "for others"
        ]
    parts = []
    if number and "drift" in noise.series[0].effects:
        drift = f"{1e3 * noise.series[0].effects['drift']:.3g} µm"
        parts.append(f"the readings drift by {drift} from the first to the last")
    if number and "offset" in noise.series[0].effects:
        parts.append("there is one series, and the intervals hold for it alone")
    return parts


def on_lack_of_determination(optimum: Optimum, estimates: Mapping[str, Estimate]) -> list[str]:
    """Return which parameters the readings do not determine, or poorly."""
    together = optimum.unidentifiable
    if together:
        which = "has no effect on the fit: fix it"
        if len(together) > 1:
            which = "are not identifiable, only a combination of them: fix one"
        return [
            f"{' and '.join(together)} {which} with --fix {together[0]}=VALUE, or [fixed] in the "
            "campaign"
        ]
    by_verdict = {v: [k for k, e in estimates.items() if e.verdict == v] for v in _DETERMINED}
    return [f"{', '.join(names)}: {_DETERMINED[v]}" for v, names in by_verdict.items() if names]


def _on_correlations(optimum: Optimum) -> list[str]:
    names, matrix, sentences = optimum.fit.names, correlation_of(optimum), []
    for i, j in zip(*np.triu_indices(len(matrix), 1), strict=True):
        if abs(matrix[i, j]) > _STRONG_CORRELATION:
            kind = "rise together" if matrix[i, j] > 0 else "trade off"
            sentences.append(
                f"{names[i]} and {names[j]} {kind} (correlation {matrix[i, j]:.3f}): quote them "
                "together, or fix one"
            )
    return sentences


# --- coefficients -------------------------------------------------------------------------------


def estimates_of(
    optimum: Optimum, level: float = LEVEL, jobs: Workers = 1
) -> tuple[dict[str, Estimate], list[str]]:
    """Return the free parameters with intervals, and which profiles found a better fit."""
    names, intervals = optimum.fit.names, {}
    if not optimum.is_rounding:
        known = [name for name in names if name not in optimum.unidentifiable]
        calls = [call(optimum.interval, name, level) for name in known]
        intervals = dict(zip(known, collect(calls, jobs), strict=True))
    estimates = {name: _estimate(optimum, name, level, intervals.get(name)) for name in names}
    better = [
        f"the profile of {name} found a better fit, S − S_best = {interval.lowest:.3g}: the "
        "intervals are not those of the best fit; fit again with more starts"
        for name, interval in intervals.items()
        if interval.lowest < _BETTER
    ]
    return estimates, better


def _estimate(optimum: Optimum, name: str, level: float, interval: Interval | None) -> Estimate:
    k = optimum.fit.names.index(name)
    value, unit = float(optimum.point[k]), optimum.fit.free[k].unit
    if name in optimum.unidentifiable:
        return Estimate(value=value, unit=unit, verdict="not")
    error = float(optimum.errors[k])
    if interval is None:  # of readings that follow the law to round-off
        reach = float(half_width(level, optimum.degrees_of_each()[k])) * error
        interval = Interval(value - reach, value + reach, False, False, 0.0)
    ends = {key: x for key, x in interval._asdict().items() if key != "lowest"}
    estimate = Estimate(value=value, unit=unit, standard_error=error, **ends)
    known = optimum.fit.free[k].known
    if known is not None:
        verdict = "as given" if error > _AS_GIVEN * known[1] else "learned"
        return estimate.model_copy(update={"verdict": verdict})
    return with_verdict(estimate, float(optimum.per_unit[k]))


def correlation_of(optimum: Optimum) -> FloatArray:
    """Return the correlations of the free parameters, shape (k, k), 0 with unidentifiable ones."""
    errors = np.nan_to_num(optimum.errors)
    scale = np.outer(errors, errors)
    return np.divide(optimum.covariance, scale, out=np.eye(len(scale)), where=scale > 0)


def deviations_of(optimum: Optimum) -> FittedDeviations:
    """Return the deviations of the noise and the effects of the series."""
    noise = optimum.fit.noise
    series, effects, over = [], optimum.series, noise.model.over
    if effects is not None:
        labels = optimum.fit.data.groups(over)[0] if over else ["all rows"]
        rows = np.bincount(noise.series).tolist()
        for label, size, shares in zip(labels, rows, effects.tolist(), strict=True):
            shared = dict(zip(noise.model.effects, shares, strict=True))
            series.append(SeriesEffect(name=label, rows=size, effects=shared))
    deviations = dict(noise.deviations)
    return FittedDeviations(deviations=deviations, random=noise.is_random, series=series)


# --- how well the law describes the readings ----------------------------------------------------


def outliers(optimum: Optimum) -> dict[int, float]:
    """Return the rows far from the law, and by how many robust standard deviations."""
    spread = MEDIAN_TO_SIGMA * float(np.median(np.abs(optimum.r)))
    if optimum.is_rounding or spread == 0:
        return {}
    sizes = -optimum.r / spread
    limit = _OUTLYING + _MORE_FOR_FEW / sizes.size
    far = np.flatnonzero((np.abs(sizes) > limit) | _stands_alone(optimum))
    return {int(row): float(sizes[row]) for row in far}


def _stands_alone(optimum: Optimum) -> BoolArray:
    """Return which readings are far from a fit to the others, by Student's t of N of them."""
    from scipy import special

    r, likelihood, degrees = optimum.r, optimum.likelihood, optimum.degrees - 1
    if degrees < 1:
        return np.zeros(r.size, dtype=bool)
    white = likelihood.covariance.white(likelihood.basis[: r.size].T.copy())
    basis = np.linalg.qr(white.T)[0]
    free = np.maximum(1 - (basis**2).sum(axis=1), 1e-12)
    squares = float((r**2).sum())
    rest = np.maximum(squares - r**2 / free, 1e-12 * squares) / degrees
    t = np.abs(r) / np.sqrt(rest * free)
    return np.asarray(2 * special.stdtr(degrees, -t) < _BY_CHANCE / r.size)


def _without(optimum: Optimum, far: Collection[int]) -> dict[str, float]:
    """Return the coefficients of a fit without the outliers; none if there are none."""
    rows = np.setdiff1d(np.arange(optimum.r.size), list(far))
    if not far or rows.size <= optimum.point.size:
        return {}
    rest = optimum.fit.take(rows)
    return rest.coefficients(rest.minimise(optimum.point)[0])


def r_squared(optimum: Optimum) -> float | None:
    """Return the share of the variance within series that the law describes; None without any."""
    noise, added = optimum.fit.noise, optimum.series_in_mm
    seen = optimum.fit.observed - (0.0 if added is None else added)
    series = noise.series
    mean = np.bincount(series, seen) / np.bincount(series)
    total = float(((seen - mean[series]) ** 2).sum())
    if total <= _ROUNDING**2 * float((seen**2).sum()):
        return None
    return 1 - float((_less_series(optimum) ** 2).sum()) / total


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


def _missed(optimum: Optimum) -> tuple[float, float | None]:
    """Return the residuals over the readings, and over the scatter from one to the next.

    The scatter is that of the second differences along the load, by their median, which a kink or
    an outlier does not move. None for fewer than `_FEWEST_NEIGHBOURS` readings.
    """
    fit, missed = optimum.fit, _less_series(optimum)
    size, rms = (float(np.sqrt((x**2).mean())) for x in (fit.observed, missed))
    share = rms / size if size > 0 else 0.0
    if missed.size < _FEWEST_NEIGHBOURS:
        return share, None
    over = "group" if "group" in fit.data.data.labels else "pair"
    r = missed / fit.noise.scale  # alike at all loads
    bends = np.diff(r[np.lexsort((fit.data.load, fit.data.groups(over)[1]))], 2)
    scatter = MEDIAN_TO_SIGMA * float(np.median(np.abs(bends))) / np.sqrt(6)
    return share, float(np.sqrt((r**2).mean())) / scatter if scatter > 0 else None


# --- tests of the noise -------------------------------------------------------------------------


def tests_of_noise(optimum: Optimum) -> list[str]:
    """Return a sentence for each test of the noise that fails."""
    if optimum.r.size < _FEWEST + optimum.point.size:
        return []
    allowed = optimum.fit.noise.model.effects
    with np.errstate(divide="ignore", invalid="ignore"):  # of readings or loads that are all equal
        of_series = "" if "offset" in allowed else _series(optimum)
        of_drift = "" if "drift" in allowed else _drift(optimum)
        # A series or a drift explains a sequence of like residuals.
        sequence = "" if of_series or of_drift else _sequence(optimum, allowed)
        tests = of_series, of_drift, sequence, _spread(optimum)
    return [sentence for sentence in tests if sentence]


def _failed(p: float, says: str, remedy: str) -> str:
    """Return the sentence on residuals that are surprising, else ""; p is NaN if none can tell."""
    return f"{says} (p = {p:.2g}): {remedy}" if p < _SURPRISING else ""


def _groups(optimum: Optimum, *names: str) -> tuple[str, list[str], Indices]:
    """Return the first of some groupings with several groups: its name, theirs, and the rows'."""
    data = optimum.fit.data
    for name in names:
        if name != "group" or name in data.data.labels:
            groups, index = data.groups(name)
            if len(groups) > 1:
                return name, groups, index
    return "", [""], np.zeros(optimum.r.size, dtype=np.intp)


def _series(optimum: Optimum) -> str:
    """Test whether residuals depend on the series: a mean and a trend along the load of each."""
    over, names, index = _groups(optimum, "group", "pair")
    if not over:
        return ""
    member = as_floats(index[:, None] == np.arange(len(names)))
    load = np.log(optimum.fit.data.load)
    p = _f_test(optimum, np.hstack([member, member * (load - load.mean())[:, None]]))
    if over == "group":
        says = (
            f"the {len(names)} series of the column group differ by more than the scatter within "
            "them, so the intervals are too narrow"
        )
        return _failed(p, says, "allow for it with --group group")
    says = (
        f"the residuals differ between the {len(names)} pairs of the table: each pair has its "
        "own error, or the law depends wrongly on the clearance or the moduli"
    )
    return _failed(p, says, _by_series(optimum))


def _drift(optimum: Optimum) -> str:
    """Test whether residuals have trends along the rows of the series, each its own."""
    _, _, index = _groups(optimum, "group", "pair")
    data = optimum.fit.data
    position = _less_mean(positions(index, data.columns.get("time")), index)
    load = _less_mean(np.log(data.load), index)
    if abs(np.corrcoef(position, load)[0, 1]) > 0.9:
        return ""  # along a single sweep of the load a drift looks like another law
    p = _f_test(optimum, position[:, None] * (index[:, None] == np.unique(index)))
    says = "the residuals drift along the rows of a series"
    remedy = "allow for it with --drift"
    if "group" not in data.data.labels and data.data.unused:
        remedy += f", or {_by_series(optimum)}"
    return _failed(p, says, remedy)


def _by_series(optimum: Optimum) -> str:
    """Return how to allow for series, by the table's own columns of words if it has some."""
    names = optimum.fit.data.data.unused[:2]
    if not names:
        return "name the series by a column with --group COLUMN"
    return f"allow for series with {listed(f'--group {shlex.quote(name)}' for name in names)}"


def _less_mean(values: FloatArray, index: Indices) -> FloatArray:
    return as_floats(values - (np.bincount(index, values) / np.bincount(index))[index])


def _sequence(optimum: Optimum, allowed: Collection[str]) -> str:
    """Test whether each residual is like the one before, by their correlation."""
    from scipy import special

    _, _, index = _groups(optimum, "group")
    order = np.argsort(index, kind="stable")
    r, same = optimum.r[order], np.diff(index[order]) == 0
    r = r - r.mean()
    correlation = float((r[1:] * r[:-1])[same].sum() / (r**2).sum())
    turns = np.diff(np.sign(np.diff(optimum.fit.data.load)))
    remedy = "repeat some loads in another order, to tell a drift from a wrong law"
    if np.any(turns != 0):
        untried = {
            "offset": _by_series(optimum),
            "drift": "allow for a drift with --drift",
        }
        options = [text for effect, text in untried.items() if effect not in allowed]
        remedy = ", or ".join([*options, "try other laws with `cylcontact choose`"])
    says = (
        f"the errors of successive readings are alike (correlation {correlation:.2f}), so the "
        "intervals are too narrow"
    )
    return _failed(float(special.ndtr(-correlation * np.sqrt(r.size))), says, remedy)


def _spread(optimum: Optimum) -> str:
    """Test whether the size of the residuals depends on that of the readings."""
    from scipy import special

    fit, noise = optimum.fit, optimum.fit.noise
    if noise.is_given:
        return ""
    correlation = float(np.corrcoef(_ranks(np.abs(optimum.r)), _ranks(fit.observed))[0, 1])
    degrees = optimum.r.size - 2
    t = correlation * np.sqrt(degrees / max(1 - correlation**2, 1e-12))
    remedy = "look for another cause of scatter"
    if len(noise.model.scatter) == 1:
        remedy = "allow for both kinds of scatter: leave --noise out"
    grows = "grows" if correlation > 0 else "falls"
    says = f"the scatter, relative to the noise assumed, {grows} with the reading"
    return _failed(2 * float(special.stdtr(degrees, -abs(t))), says, remedy)


def _f_test(optimum: Optimum, columns: FloatArray) -> float:
    """Return the probability of residuals that depend on columns so much; NaN if too few rows."""
    from scipy import special

    r = optimum.r
    design = np.column_stack([np.ones(r.size), columns])
    left, singular, _ = np.linalg.svd(design, full_matrices=False)
    basis = left[:, singular > 1e-10 * singular[0]]
    rank, rest = basis.shape[1] - 1, optimum.degrees - basis.shape[1]
    if rank < 1 or rest < _FEWEST_IN_SERIES:
        return np.nan
    along = float(((basis.T @ r) ** 2).sum())
    explained = max(along - r.size * float(r.mean()) ** 2, 0.0)
    left_over = max(float((r**2).sum()) - along, 1e-300)
    return float(special.fdtrc(rank, rest, explained / rank / (left_over / rest)))


def _ranks(values: FloatArray) -> FloatArray:
    """Return the ranks of values; ties share their mean."""
    _, place, counts = np.unique(values, return_inverse=True, return_counts=True)
    return as_floats((np.cumsum(counts) - (counts - 1) / 2)[place])
