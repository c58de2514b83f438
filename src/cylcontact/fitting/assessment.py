"""Verdicts: sentences on the quality of a fit, computed from its numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cylcontact.fitting.uncertainty.estimates import OUTLYING, STRONG_CORRELATION
from cylcontact.fitting.uncertainty.law_profiles import TOLERANCE
from cylcontact.fitting.uncertainty.profiles import FAIRLY, WELL
from cylcontact.fitting.uncertainty.residual_model import ROUNDING

if TYPE_CHECKING:
    from cylcontact.fitting.records import RunRecord
    from cylcontact.fitting.result import FitResult
    from cylcontact.fitting.uncertainty.estimates import FittedDeviations, Uncertainty

__all__ = [
    "SAME_BASIN",
    "basins",
    "data_warnings",
    "describes",
    "fixed",
    "identification",
    "noise_verdicts",
    "noise_warnings",
    "round_off",
    "same_basin",
    "ties",
    "verdicts",
    "warnings",
]

# Runs whose objectives are this close, relatively, ended in the same basin.
SAME_BASIN = 1e-3
# The objective of data that follow the law exactly is round-off, below this.
_EXACT = 1e-12
# From moments it has half of the digits.
_EXACT_FROM_MOMENTS = 1e-6
# A coefficient this close to a bound, relative to the search interval, is at the bound.
_AT_BOUND = 1e-6
# Below this probability the residuals are not those of the noise assumed.
_SURPRISING = 0.01
# A law that describes less than this share of the variance of readings is not theirs; nor is one
# that misses them by more than a share of them, and by several times their scatter.
_DESCRIBED = 0.8
_MISSED, _TIMES_SCATTER = 0.05, 3.0
# A stiffness that is certainly outside these, over that of the pair as given, is not the pair's.
_USUAL_STIFFNESS = (0.8, 1.25)
# What the estimates are, beside their names.
COMPLIANCE = (
    "the compliance is what the readings yield per load beyond the law's own datum: the points "
    "between which they are taken, the housing and the rig; negative is less"
)
_MEANINGS = {
    "kappa": "kappa is a factor of the penetration, as of a modulus E*/kappa",
    "stiffness_factor": "stiffness_factor is a factor of the load, as of a modulus so much larger",
    "modulus_factor": "modulus_factor is a factor of the modulus E*",
    "compliance": COMPLIANCE,
}
_DATUM = "the datum, the housing or the rig (try --free compliance)"
# At most so many rows of the data are listed.
_LISTED = 8


def verdicts(result: FitResult) -> list[str]:
    """Return the verdicts on a result, most important first.

    For a fit to a reference law they are its `warnings`; then they state whether the published
    coefficients are the optimum, how far the fit is from the lower bound, which coefficients are
    well identified, which are at a bound, and how many runs agree. For a fit to measurements they
    are those of `noise_verdicts`, the objective of the published coefficients, and how many runs
    agree.
    """
    if result.uncertainty is not None:
        steps = result.settings["measurements"].get("steps", [])
        sentences = [
            *noise_verdicts(result.uncertainty),
            _on_published_law(result),
            *(f"data: {step}" for step in steps),
        ]
    else:
        sentences = [
            *warnings(result),
            _on_published(result),
            _on_lower_bound(result),
            _on_identification(result),
            *_on_search_bounds(result),
        ]
    return [sentence for sentence in [*sentences, *_on_runs(result)] if sentence]


def identification(result: FitResult, name: str) -> str:
    """Return "well", "fairly", "poorly", "not", "at a bound", "fixed", its tie, or "-"."""
    if name in ties(result):
        return f"= {ties(result)[name]}"
    if result.uncertainty is not None:
        estimate = result.uncertainty.estimates.get(name)
        return "fixed" if estimate is None else estimate.verdict
    if name not in result.profiles:
        return "fixed" if result.profiles or name in fixed(result) else "-"
    return result.profiles[name].verdict(result.coefficients[name])


def ties(result: FitResult) -> dict[str, str]:
    """Return the expressions that set coefficients of a result, by name."""
    return result.settings["campaign"].get("ties") or {}


def fixed(result: FitResult) -> list[str]:
    """Return the coefficients that a result's campaign fixes at a value."""
    tables = result.settings["campaign"]["parameters"]
    return [name for name, table in tables.items() if table.get("fixed")]


def basins(result: FitResult) -> list[tuple[float, int]]:
    """Return the distinct objectives of the runs with the number of runs at each, best first."""
    counts: list[tuple[float, int]] = []
    for record in sorted(result.runs, key=lambda record: record.objective):
        if counts and same_basin(record, counts[-1][0], round_off(result)):
            counts[-1] = (counts[-1][0], counts[-1][1] + 1)
        else:
            counts.append((record.objective, 1))
    return counts


def same_basin(record: RunRecord, objective: float, exact: float = _EXACT) -> bool:
    """Return whether a run reached an objective, to 0.1 % and round-off."""
    return record.objective <= objective * (1 + SAME_BASIN) + exact


def round_off(result: FitResult) -> float:
    """Return the objective below which the law follows the samples of a result exactly."""
    return _EXACT if result.uncertainty is not None else _EXACT_FROM_MOMENTS


def _on_published(result: FitResult) -> str:
    """Compare the objective of the published coefficients with the fitted one."""
    if result.published is None:
        return ""
    optimum = result.objective.value * (1 + SAME_BASIN) + round_off(result)
    if result.published.objective <= optimum:
        return "the published coefficients are the optimum on this grid, within 0.1 %"
    ratio = result.published.objective / result.objective.value
    excess = f"{100 * (ratio - 1):.1f} % above" if ratio < 1.1 else f"{ratio:.2f} times"
    return (
        f"with {_searched(result)} the published coefficients are not the optimum on this grid: "
        f"their objective is {result.published.objective:.4g}, {excess} the fitted one"
    )


def _searched(result: FitResult) -> str:
    """Return which coefficients of a result were free."""
    if not fixed(result) and not ties(result):
        return "all coefficients free"
    return f"only {' and '.join(result.profiles)} free"


def _on_published_law(result: FitResult) -> str:
    """Give the objective of the published coefficients on measurements."""
    if result.published is None:
        return ""
    return (
        "on these data the law has an objective of "
        f"{result.published.objective:.4g} with its published constants, and "
        f"{result.objective.value:.4g} fitted"
    )


def _on_lower_bound(result: FitResult) -> str:
    """Give the distance to the best objective that any law of this form could reach."""
    if not result.bound:
        return ""
    excess = result.objective.value / result.bound - 1
    return (
        f"the fit is {100 * excess:.1f} % above the lower bound {result.bound:.4g}, reached with "
        "K* and n fitted separately at each clearance"
    )


def _on_identification(result: FitResult) -> str:
    """Name the coefficients that are poorly identified, if there are profiles."""
    if not result.profiles:
        return ""
    poor = _poorly_identified(result)
    if not poor:
        return "every coefficient inside its bounds is at least fairly identified"
    return (
        f"poorly identified: {', '.join(poor)} (the best objective rises by less than "
        f"{100 * TOLERANCE:g} % while the coefficient moves by more than {100 * FAIRLY:g} % of its "
        f"value, or to a bound; well identified is {100 * WELL:g} %)"
    )


def _poorly_identified(result: FitResult) -> list[str]:
    """Return the coefficients that the profiles show to be poorly identified."""
    return [name for name in result.profiles if identification(result, name) == "poorly"]


def _on_search_bounds(result: FitResult) -> list[str]:
    """Name the coefficients at a bound of the search."""
    sentences = []
    for name, table in result.settings["campaign"]["parameters"].items():
        if table.get("fixed"):
            continue
        margin = _AT_BOUND * (table["high"] - table["low"])
        for end in ("low", "high"):
            if abs(result.coefficients[name] - table[end]) <= margin:
                sentences.append(f"{name} is at its {end} bound {table[end]:g}: widen it")
    return sentences


def _on_runs(result: FitResult) -> list[str]:
    """Say how many runs agree with the best, and where the others ended."""
    (_, agreeing), *others = basins(result)
    sentences = [f"{agreeing} of {len(result.runs)} runs reached the best objective within 0.1 %"]
    if others:
        objectives = ", ".join(f"{objective:.4g} ({count})" for objective, count in others)
        sentences.append(f"the others ended in other basins, at (runs): {objectives}")
    return sentences


# --- what the uncertainty of a fit to measurements means, in sentences ------------------------


def warnings(result: FitResult) -> list[str]:
    """Return what makes a result doubtful, with the remedy.

    Fewer than half of the runs at the best; for measurements also tests of the noise that fail,
    with the option that allows for it, and parameters that are at a bound or not determined.
    """
    noise = [] if result.uncertainty is None else noise_warnings(result.uncertainty)
    return [*noise, *_on_disagreement(result)]


def noise_warnings(uncertainty: Uncertainty) -> list[str]:
    """Return what makes the intervals of a fit to measurements doubtful, with the remedy."""
    return [*data_warnings(uncertainty), *_on_lack_of_determination(uncertainty)]


def data_warnings(uncertainty: Uncertainty) -> list[str]:
    """Return what the readings show against a law or the noise assumed, with the remedy."""
    # Series that differ and a drift make residuals of the right law look like those of a wrong one.
    is_explained = any(finding.test in ("series", "drift") for finding in uncertainty.findings)
    sentences = [
        _on_misfit(uncertainty),
        *_on_stiffness(uncertainty),
        *(finding.sentence for finding in uncertainty.findings),
        "" if is_explained else _on_shape(uncertainty),
        _on_outliers(uncertainty),
    ]
    return [sentence for sentence in sentences if sentence]


def describes(uncertainty: Uncertainty) -> bool:
    """Return whether a law describes the readings at all."""
    return not _misfit(uncertainty)


def _misfit(uncertainty: Uncertainty) -> str:
    """Return by how much a law misses readings that it does not describe; "" if it does."""
    share, missed = uncertainty.r_squared, uncertainty.missed
    times = uncertainty.missed_over_scatter
    if share is not None and share < _DESCRIBED:
        return f"R² = {share:.3g}"
    if missed is None or times is None or missed < _MISSED or times < _TIMES_SCATTER:
        return ""
    return (
        f"it misses them by {100 * missed:.2g} % (root mean square), {times:.2g} times their "
        "scatter from one to the next"
    )


def _on_misfit(uncertainty: Uncertainty) -> str:
    """Warn of a law that is not near the readings at all."""
    how = _misfit(uncertainty)
    if not how:
        return ""
    causes = ["the units of the columns", "the materials", "the radii"]
    causes += ["a kink (a seat that settles)", "a drift"]
    if "compliance" not in uncertainty.estimates:
        causes.append(_DATUM)
    *first, last = causes
    return (
        f"the law does not describe these readings ({how}): look at {', '.join(first)}, and {last}"
    )


def _on_stiffness(uncertainty: Uncertainty) -> list[str]:
    """Warn of a stiffness that is not that of the pair as given."""
    sentences = []
    for name, estimate in uncertainty.estimates.items():
        ends = estimate.profile or estimate
        if not estimate.nominal or ends.low is None or ends.high is None:
            continue
        low, high = ends.low / estimate.nominal, ends.high / estimate.nominal
        if low <= _USUAL_STIFFNESS[1] and high >= _USUAL_STIFFNESS[0]:
            continue
        causes = ["a diameter given as a radius", "another unit", "another material", "another law"]
        if "compliance" not in uncertainty.estimates:
            causes.append(_DATUM)
        *first, last = causes
        sentences.append(
            f"{name} is {estimate.value:.3g} ({ends.low:.3g} to {ends.high:.3g}), and "
            f"{estimate.nominal:.3g} for the pair as given: is it {', '.join(first)}, or {last}?"
        )
    return sentences


def _on_disagreement(result: FitResult) -> list[str]:
    """Warn if fewer than half of the runs reached the best objective."""
    (_, agreeing), *_ = basins(result)
    runs = len(result.runs)
    if 2 * agreeing >= runs:
        return []
    poor = [] if result.uncertainty is not None else _poorly_identified(result)
    held = " or ".join(poor) or "a coefficient"
    how = "fixed = true in the campaign" if result.uncertainty is None else "--fix NAME=VALUE"
    return [
        f"only {agreeing} of {runs} runs reached the best objective within 0.1 %, so a lower one "
        f"may have been missed: make more runs (--runs {4 * runs}), or hold {held} at a value "
        f"({how})"
    ]


def noise_verdicts(uncertainty: Uncertainty) -> list[str]:
    """Return the verdicts on a fit to measurements, most important first.

    They state how large the noise is, which parameters are determined, which are correlated, and
    which rows are duplicates.
    """
    determined = _on_lack_of_determination(uncertainty) or [
        f"every free parameter is determined to ±{100 * FAIRLY:g} % or better "
        f"(well: ±{100 * WELL:g} %), a shift in terms of the prediction"
    ]
    sentences = [
        _on_noise(uncertainty),
        *determined,
        *(text for name, text in _MEANINGS.items() if name in uncertainty.estimates),
        *_on_correlations(uncertainty),
        *_on_rows(uncertainty),
        *uncertainty.notes,
    ]
    return [sentence for sentence in sentences if sentence]


def _on_outliers(uncertainty: Uncertainty) -> str:
    """Name the outliers, and what a fit without them gives."""
    if not uncertainty.outliers:
        return ""
    lines = ", ".join(
        f"{outlier.line} ({outlier.deviations:+.1f})" for outlier in uncertainty.outliers[:_LISTED]
    )
    more = ", …" if len(uncertainty.outliers) > _LISTED else ""
    sentence = (
        f"rows more than {OUTLYING:g} robust standard deviations away, not left out: lines "
        f"{lines}{more}"
    )
    changes = [
        f"{name} {estimate.value:.4g} → {uncertainty.without_outliers[name]:.4g}"
        for name, estimate in uncertainty.estimates.items()
        if name in uncertainty.without_outliers
    ]
    if changes:
        sentence += f"; without them {', '.join(changes)}"
    if uncertainty.loss_scale is None and uncertainty.noise is None:
        sentence += "; --loss huber reduces their influence"
    return sentence


def _is_exact(uncertainty: Uncertainty) -> bool:
    """Return whether the residuals are round-off."""
    return not uncertainty.sigma_known and uncertainty.residual_sigma < ROUNDING


def _on_noise(uncertainty: Uncertainty) -> str:
    """Return sentences on the noise, and on its agreement with the given standard deviations."""
    sigma, unit = uncertainty.residual_sigma, uncertainty.residual_unit
    if _is_exact(uncertainty):
        return (
            "the data follow the law to round-off: there is no noise to estimate, and no interval"
        )
    if uncertainty.noise is not None:
        return _on_deviations(uncertainty.noise, uncertainty.level)
    if not uncertainty.sigma_known:
        is_share = unit.startswith("share")
        amount = f"{100 * sigma:.3g} % of the {unit.split()[-1]}" if is_share else None
        return (
            f"measured data: the residuals scatter by {amount or f'{sigma:.3g} {unit}'} (standard "
            f"deviation, estimated from them with {uncertainty.degrees_of_freedom} degrees of "
            f"freedom); intervals are at {100 * uncertainty.level:g} % and hold if the law is "
            "right and the noise independent"
        )
    if uncertainty.chi_square_p is None:
        return (
            "measured data with given standard deviations: the bulk of the residuals scatters by "
            f"{sigma:.3g} of them (a robust loss has no chi-square test)"
        )
    p = uncertainty.chi_square_p
    verdict = "as large as the given standard deviations allow"
    if p < _SURPRISING:
        verdict = (
            "larger than the given standard deviations allow: the law is wrong, or they are too "
            "small; the intervals are then too narrow"
        )
    elif p > 1 - _SURPRISING:
        verdict = "smaller than the given standard deviations: those look too large"
    return f"measured data with given standard deviations: residuals are {verdict} (p = {p:.3g})"


def _on_deviations(noise: FittedDeviations, level: float) -> str:
    """Return a sentence on the deviations of a noise model."""
    in_mm = {"constant": "{} µm", "offset": "{} µm of offset", "drift": "{} µm of drift"}
    relative = {"proportional": "{} % of the penetration", "gain": "{} % of gain"}
    single: list[str] = []
    series: list[str] = []
    for name, value in noise.deviations.items():
        text = in_mm.get(name) or relative[name]
        amount = text.format(f"{(1e3 if name in in_mm else 100) * value:.3g}")
        (series if name in ("offset", "gain", "drift") else single).append(amount)
    parts = (
        [f"single readings scatter by {' and '.join(single)} (standard deviation)"]
        if single
        else []
    )
    if series:
        parts.append(
            f"the {len(noise.series)} series differ by {', '.join(series)} (standard deviations)"
        )
    elif len(noise.series) == 1:
        drift = noise.series[0].effects["drift"]
        parts.append(f"the readings drift by {1e3 * drift:.3g} µm from the first to the last")
    elif noise.series:
        parts.append(
            f"the {len(noise.series)} series have fixed effects, so that the intervals are about "
            "these series, not about others like them"
        )
    sizes = "; ".join(parts) or "the standard deviations are those given"
    return f"measured data: {sizes}; intervals are at {100 * level:g} %"


def _on_shape(uncertainty: Uncertainty) -> str:
    """Return a sentence if neighbouring residuals are correlated, unlike those of noise."""
    p = uncertainty.runs_test_p
    if p is None or p > _SURPRISING or _is_exact(uncertainty):
        return ""
    return (
        f"the residuals are not random along the load (runs test, p = {p:.2g}): the law has the "
        "wrong shape somewhere, which the intervals do not cover"
    )


def _on_lack_of_determination(uncertainty: Uncertainty) -> list[str]:
    """Name the parameters that are not well or fairly determined."""
    together = uncertainty.only_together
    if len(together) == 1:
        return [
            f"{together[0]} has no effect on the fit: fix it with --fix {together[0]}=VALUE, or "
            "fixed = true in the campaign"
        ]
    if together:
        return [
            f"{' and '.join(together)} are not identifiable, only a combination of them: fix one "
            f"with --fix {together[0]}=VALUE, or fixed = true in the campaign"
        ]
    meanings = {
        "poorly": f"poorly determined (not to ±{100 * FAIRLY:g} % of the value, or for a "
        "shift of the prediction, or cut off by a bound)",
        "not": "not determined by these data (the interval is as wide as the value, or for a "
        "shift as the prediction, or as the bounds, or there is none)",
        "at a bound": "at a bound of the search: widen it",
    }
    sentences = []
    for verdict, meaning in meanings.items():
        names = [name for name, e in uncertainty.estimates.items() if e.verdict == verdict]
        if names:
            sentences.append(f"{', '.join(names)}: {meaning}")
    return sentences


def _on_correlations(uncertainty: Uncertainty) -> list[str]:
    """Name the pairs of strongly correlated parameters."""
    names = list(uncertainty.correlation)
    sentences = []
    for i, one in enumerate(names):
        for other in names[i + 1 :]:
            value = uncertainty.correlation[one][other]
            if abs(value) > STRONG_CORRELATION:
                kind = "rise together" if value > 0 else "trade off"
                sentences.append(
                    f"{one} and {other} {kind} (correlation {value:.3f}): quote them together, or "
                    "fix one"
                )
    return sentences


def _on_rows(uncertainty: Uncertainty) -> list[str]:
    """Name duplicates, and the scale of a robust loss."""
    sentences = []
    if uncertainty.duplicates:
        groups = "; ".join(
            " = ".join(map(str, lines)) for lines in uncertainty.duplicates[:_LISTED]
        )
        more = ", …" if len(uncertainty.duplicates) > _LISTED else ""
        sentences.append(f"identical rows, each of them counted: lines {groups}{more}")
    if uncertainty.loss_scale is not None:
        sentences.append(
            f"a robust loss of scale {uncertainty.loss_scale:.4g} was used: intervals are "
            "asymptotic; check them with the bootstrap"
        )
    return sentences
