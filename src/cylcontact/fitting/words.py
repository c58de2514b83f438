"""What the uncertainty of a fit to readings means, in sentences; labels and tables of reports."""

from __future__ import annotations

from textwrap import fill

from cylcontact.fitting.diagnose import OUTLYING, STRONG_CORRELATION, SURPRISING
from cylcontact.fitting.optimum import ROUNDING
from cylcontact.fitting.records import FAIRLY, WELL, FittedDeviations, Uncertainty
from cylcontact.support.plain_text import advice

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


def noise_warnings(uncertainty: Uncertainty) -> list[str]:
    """Return what makes the intervals of a fit to measurements doubtful, with the remedy."""
    return [*data_warnings(uncertainty), *_on_lack_of_determination(uncertainty)]


def data_warnings(uncertainty: Uncertainty) -> list[str]:
    """Return what the readings show against a law or the noise assumed, with the remedy."""
    sentences = [
        _on_misfit(uncertainty),
        _on_chi_square(uncertainty),
        *_on_stiffness(uncertainty),
        *(finding.sentence for finding in uncertainty.findings),
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
    how = _misfit(uncertainty)
    if not how:
        return ""
    if uncertainty.falls:
        return (
            f"the law does not describe these readings ({how}): the penetration falls as the load "
            "rises, so one of them has the opposite sign (--sign penetration, or --sign load)"
        )
    causes = ("the units of the columns", "the materials", "the radii")
    listed = _causes(uncertainty, "and", *causes, "a kink (a seat that settles)", "a drift")
    return f"the law does not describe these readings ({how}): look at {listed}"


def _causes(uncertainty: Uncertainty, word: str, *causes: str) -> str:
    *first, last = causes if "compliance" in uncertainty.estimates else (*causes, _DATUM)
    return f"{', '.join(first)}, {word} {last}"


def _on_stiffness(uncertainty: Uncertainty) -> list[str]:
    sentences = []
    for name, estimate in uncertainty.estimates.items():
        ends = estimate.profile or estimate
        if not estimate.nominal or ends.low is None or ends.high is None:
            continue
        low, high = ends.low / estimate.nominal, ends.high / estimate.nominal
        if low <= _USUAL_STIFFNESS[1] and high >= _USUAL_STIFFNESS[0]:
            continue
        causes = ("a diameter given as a radius", "another unit", "another material")
        listed = _causes(uncertainty, "or", *causes, "another law")
        sentences.append(
            f"{name} is {estimate.value:.3g} ({ends.low:.3g} to {ends.high:.3g}), and "
            f"{estimate.nominal:.3g} for the pair as given: is it {listed}?"
        )
    return sentences


def noise_verdicts(uncertainty: Uncertainty) -> list[str]:
    """Return the verdicts on a fit to measurements, most important first."""
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
    return sentence


def _is_exact(uncertainty: Uncertainty) -> bool:
    return not uncertainty.sigma_known and uncertainty.residual_sigma < ROUNDING


def _on_noise(uncertainty: Uncertainty) -> str:
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
    p = uncertainty.chi_square_p
    assert p is not None
    verdict = "as large as the given standard deviations allow"
    if p > 1 - SURPRISING:
        verdict = "smaller than the given standard deviations: those look too large"
    return _on_chi_square(uncertainty) or (
        f"measured data with given standard deviations: residuals are {verdict} (p = {p:.3g})"
    )


def _on_chi_square(uncertainty: Uncertainty) -> str:
    p = uncertainty.chi_square_p
    if p is None or p >= SURPRISING:
        return ""
    return (
        "the residuals are larger than the given standard deviations allow: the law is wrong, or "
        f"they are too small; the intervals are then too narrow (p = {p:.3g})"
    )


def _on_deviations(noise: FittedDeviations, level: float) -> str:
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
        effects = noise.series[0].effects
        if "drift" in effects:
            drift = f"{1e3 * effects['drift']:.3g} µm"
            parts.append(f"the readings drift by {drift} from the first to the last")
        if "offset" in effects:
            parts.append("there is one series, and the intervals are not about others like it")
    elif noise.series:
        parts.append(
            f"the {len(noise.series)} series have fixed effects, so that the intervals are about "
            "these series, not about others like them"
        )
    sizes = "; ".join(parts) or "the standard deviations are those given"
    return f"measured data: {sizes}; intervals are at {100 * level:g} %"


def _on_lack_of_determination(uncertainty: Uncertainty) -> list[str]:
    together = uncertainty.only_together
    if len(together) == 1:
        return [
            f"{together[0]} has no effect on the fit: fix it with --fix {together[0]}=VALUE, or "
            "[fixed] in the campaign"
        ]
    if together:
        return [
            f"{' and '.join(together)} are not identifiable, only a combination of them: fix one "
            f"with --fix {together[0]}=VALUE, or [fixed] in the campaign"
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
    sentences = []
    if uncertainty.duplicates:
        groups = "; ".join(
            " = ".join(map(str, lines)) for lines in uncertainty.duplicates[:_LISTED]
        )
        more = ", …" if len(uncertainty.duplicates) > _LISTED else ""
        sentences.append(f"identical rows, each of them counted: lines {groups}{more}")
    return sentences


WIDTH = 100


# The units of objectives that have one, if the residuals are not in given deviations.
# What an objective is, in words.
OBJECTIVE_WORDS = {
    "rms-log-penetration": "relative scatter of the penetration",
    "rms-penetration": "scatter of the penetration",
    "rms-standardised": "scatter in standard deviations",
    "rms-difference-percent": "scatter of the penetration in percent",
    "max-difference-percent": "largest difference of the penetration in percent",
    "rms-relative-force": "relative scatter of the load",
    "max-relative-force-percent": "largest difference of the load in percent",
}
OBJECTIVE_UNITS = {"rms-penetration": "mm", "rms-standardised": "std. dev."}


Rows = list[tuple[str, ...]]


def label_of(name: str, unit: str) -> str:
    """Return a name with its unit, if it has one."""
    return ", ".join(filter(None, (name, unit)))


def item(sentence: str, mark: str = "- ", width: int = WIDTH) -> str:
    """Return a sentence as an item of a list, wrapped, its options in the words of the reader."""
    return fill(advice(sentence), width, initial_indent=mark, subsequent_indent="  ")


def or_dash(value: float | None, style: str = ".5g", none: str = "-") -> str:
    """Return a number, or a dash for None."""
    return none if value is None else format(value, style)
