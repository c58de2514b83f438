"""What the uncertainty of a fit to measurements means, in sentences computed from its numbers."""

from __future__ import annotations

from cylcontact.fitting.uncertainty.report import (
    FAIRLY,
    OUTLYING,
    STRONG_CORRELATION,
    WELL,
    Uncertainty,
)

# Below this probability the residuals are larger than the standard deviations allow.
SURPRISING = 0.01
# At most so many lines of the table are listed.
LISTED = 8
NO_NOISE = 1e-11


def noise_verdicts(found: Uncertainty) -> list[str]:
    """Return the verdicts on a fit to measurements, most important first."""
    sentences = [
        _on_noise(found),
        _on_shape(found),
        *_on_what_is_determined(found),
        *_on_correlations(found),
    ]
    sentences += _on_rows(found)
    return [sentence for sentence in sentences if sentence] + found.notes


def _on_noise(found: Uncertainty) -> str:
    """Say how large the noise is, and whether it is as large as it should be."""
    if not found.sigma_known and found.residual_sigma < NO_NOISE:
        return "the data follow the law to rounding: there is no noise to estimate, and no interval"
    if not found.sigma_known:
        amount = (
            f"{found.residual_sigma:.3g} {found.residual_unit}"
            if not found.residual_unit.startswith("share")
            else f"{100 * found.residual_sigma:.3g} % of the {found.residual_unit.split()[-1]}"
        )
        return (
            f"measured data: the residuals scatter by {amount} (standard deviation, estimated from "
            f"them with {found.degrees_of_freedom} degrees of freedom); intervals are at "
            f"{100 * found.level:g} % and hold if the law is right and the noise independent"
        )
    if found.chi_square_p is None:
        return (
            "measured data with given standard deviations: the bulk of the residuals scatters by "
            f"{found.residual_sigma:.3g} of them (a robust loss has no chi-square test)"
        )
    p = found.chi_square_p
    verdict = "as large as the given standard deviations allow"
    if p < SURPRISING:
        verdict = (
            "larger than the given standard deviations allow: the law is wrong, or they are too "
            "small; the intervals are then too narrow"
        )
    elif p > 1 - SURPRISING:
        verdict = "smaller than the given standard deviations: those look too large"
    return f"measured data with given standard deviations: residuals are {verdict} (p = {p:.3g})"


def _on_shape(found: Uncertainty) -> str:
    """Say if the residuals hang together, which noise does not."""
    if found.runs_test_p is None or found.runs_test_p > SURPRISING:
        return ""
    if not found.sigma_known and found.residual_sigma < NO_NOISE:
        return ""
    return (
        "the residuals do not scatter at random along the load (runs test, p = "
        f"{found.runs_test_p:.2g}): the law has the wrong shape somewhere, which the intervals do "
        "not cover"
    )


def _on_what_is_determined(found: Uncertainty) -> list[str]:
    """Name the parameters by how well they are determined."""
    if found.only_together:
        return [
            f"the data do not tell {' and '.join(found.only_together)} apart: only a combination "
            "of them is determined; hold one of them with fixed = true"
        ]
    words = {
        "poorly": f"poorly determined (not to ±{100 * FAIRLY:g} % of the value, or for a shift of "
        "the prediction, or cut off by a bound)",
        "not": "not determined by these data (the interval is as wide as the value, or for a "
        "shift as the prediction, or as the bounds, or there is none)",
        "at a bound": "at a bound of the search: widen it",
    }
    sentences = []
    for verdict, words_of in words.items():
        names = [name for name, e in found.estimates.items() if e.verdict == verdict]
        if names:
            sentences.append(f"{', '.join(names)}: {words_of}")
    if not sentences:
        sentences = [
            f"every free parameter is determined to ±{100 * FAIRLY:g} % or better "
            f"(well: ±{100 * WELL:g} %), a shift in terms of the prediction"
        ]
    return sentences


def _on_correlations(found: Uncertainty) -> list[str]:
    """Name the pairs that the data hardly tell apart."""
    names = list(found.correlation)
    sentences = []
    for i, one in enumerate(names):
        for other in names[i + 1 :]:
            value = found.correlation[one][other]
            if abs(value) > STRONG_CORRELATION:
                kind = "rise together" if value > 0 else "trade off"
                sentences.append(
                    f"{one} and {other} {kind} (correlation {value:.3f}): quote them together, or "
                    "hold one"
                )
    return sentences


def _on_rows(found: Uncertainty) -> list[str]:
    """Report duplicates and outliers, which stay in."""
    sentences = []
    if found.duplicates:
        groups = "; ".join(" = ".join(map(str, lines)) for lines in found.duplicates[:LISTED])
        more = ", …" if len(found.duplicates) > LISTED else ""
        sentences.append(
            f"rows that say exactly the same, kept and counted as often: lines {groups}{more}"
        )
    if found.outliers:
        lines = ", ".join(
            f"{outlier.line} ({outlier.deviations:+.1f})" for outlier in found.outliers[:LISTED]
        )
        more = ", …" if len(found.outliers) > LISTED else ""
        advice = '; a robust loss (loss = "huber") would lessen their pull'
        sentences.append(
            f"rows more than {OUTLYING:g} robust standard deviations away, which are kept: lines "
            f"{lines}{more}{'' if found.loss_scale is not None else advice}"
        )
    if found.loss_scale is not None:
        sentences.append(
            f"a robust loss of scale {found.loss_scale:.4g} was used: intervals are asymptotic, "
            "and the bootstrap is the check on them"
        )
    return sentences
