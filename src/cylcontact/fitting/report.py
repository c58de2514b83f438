"""Fit results and studies of their uncertainty as text for a terminal and HTML for a notebook."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from cylcontact.fitting.assessment import (
    basins,
    fixed,
    identification,
    noise_verdicts,
    noise_warnings,
    ties,
    verdicts,
    warnings,
)
from cylcontact.fitting.law_models import units_of
from cylcontact.fitting.uncertainty.resampling import FEW_GROUPS, FEW_REFITS, FEWEST_REFITS
from cylcontact.plain_text import brief
from cylcontact.text_tables import Table

if TYPE_CHECKING:
    from cylcontact.fitting.result import FitResult
    from cylcontact.fitting.uncertainty.bands import Band
    from cylcontact.fitting.uncertainty.discrepancy import DiscrepancyStudy
    from cylcontact.fitting.uncertainty.estimates import Uncertainty
    from cylcontact.fitting.uncertainty.resampling import Bootstrap, LeftOut
    from cylcontact.fitting.uncertainty.study import NoiseStudy

__all__ = [
    "NUMBERS",
    "as_html",
    "as_text",
    "by_search",
    "coefficient_table",
    "compare",
    "discrepancy_text",
    "labels",
    "noise_text",
    "side_by_side",
]

_WIDTH = 100

# The rows below the coefficients where results are compared, with their labels in text and their
# formats. Those of the published coefficients are computed on the data of each fit.
NUMBERS = {
    "objective": ("  fitted", ".5g"),
    "published objective": ("  published", ".5g"),
    "lower bound": ("  lower bound", ".5g"),
    "largest |Eq 9|, %": ("max |Eq 9|, %", ".4g"),
    "published largest |Eq 9|, %": ("  published", ".5g"),
    "samples": ("samples", ",d"),
    "masked": ("  masked", ",d"),
}

# The axes of grids, with symbols and units.
_AXES = {
    **{"E": ("E", " GPa"), "nu": ("ν", ""), "dR": ("ΔR", " mm"), "load": ("load", " N/mm")},
    **{"alpha": ("α", ""), "beta": ("β", ""), "phi": ("φ", "")},
}

# The units of objectives that have one, if no deviations are given with the data.
_OBJECTIVE_UNITS = {"rms-penetration": "mm", "rms-load": "N/mm", "rms-standardised": "std. dev."}

_Rows = list[tuple[str, ...]]


# --- one result -------------------------------------------------------------------------------


def as_text(result: FitResult) -> str:
    """Return the report on one result."""
    warned = [_item(sentence, "! ") for sentence in warnings(result)]
    return "\n".join(
        [
            fill(_headline(result), _WIDTH),
            *([_status(result)] if result.uncertainty is not None else []),
            *warned,
            "",
            str(Table(_columns(result), _rows(result))),
            *map(_item, _unwarned(result)),
        ]
    )


def _unwarned(result: FitResult) -> list[str]:
    """Return the verdicts on a result that are not among its warnings."""
    warned = warnings(result)
    return [sentence for sentence in verdicts(result) if sentence not in warned]


def _status(result: FitResult) -> str:
    """Return in a line whether a fit to measurements can be taken as it is."""
    agreeing = basins(result)[0][1]
    uncertainty = result.uncertainty
    found = [e.verdict for e in uncertainty.estimates.values()] if uncertainty else []
    at_bound = found.count("at a bound")
    poor = found.count("poorly") + found.count("not")
    parts = [
        f"{agreeing} of {len(result.runs)} runs agree",
        f"{at_bound or 'none'} at a bound",
        f"{poor or 'none'} ill determined",
    ]
    if uncertainty is not None and uncertainty.r_squared is not None:
        parts.append(f"R² = {uncertainty.r_squared:.5f}")
    if uncertainty is not None and uncertainty.log_likelihood is not None:
        parts.append(f"AIC = {result.aic:.1f}, BIC = {result.bic:.1f}")
    return " · ".join(parts)


def as_html(result: FitResult) -> str:
    """Return the report on one result as an HTML fragment, with all text escaped."""
    items = "".join(f"<li>{escape(sentence)}</li>" for sentence in _unwarned(result))
    status = f"<p>{escape(_status(result))}</p>" if result.uncertainty is not None else ""
    style = "border-left: 4px solid #D55E00; padding-left: 0.5em"
    warned = "".join(f'<p style="{style}">{escape(sentence)}</p>' for sentence in warnings(result))
    return (
        f"<p>{escape(_headline(result))}</p>{status}{warned}"
        f"{Table(_columns(result), _rows(result))._repr_html_()}<ul>{items}</ul>"
    )


def _headline(result: FitResult) -> str:
    """Return what was fitted to what."""
    law = f"{brief(result.name)}: {brief(result.law)} law, {result.contact} contact"
    if result.uncertainty is not None:
        return f"{law}, fitted to {result.counts.samples:,} measurements by {result.objective.name}"
    return (
        f"{law}, fitted to {result.reference} by {result.objective.name} on "
        f"{result.counts.samples:,} samples ({result.counts.masked:,} masked by the reference's "
        "domain)"
    )


def coefficient_table(result: FitResult) -> pd.DataFrame:
    """Return the coefficients of a result as a table; `FitResult.to_frame` describes it."""
    units = units_of(result.law, result.contact)
    estimates = result.uncertainty.estimates if result.uncertainty else {}
    rows = {}
    for name, value in result.coefficients.items():
        estimate, profile = estimates.get(name), result.profiles.get(name)
        ends = estimate.profile if estimate is not None else profile
        rows[name] = {
            "value": value,
            "unit": units.get(name, ""),
            "standard_error": np.nan if estimate is None else estimate.standard_error,
            "low": np.nan if ends is None else ends.low,
            "high": np.nan if ends is None else ends.high,
            "verdict": identification(result, name),
        }
    return pd.DataFrame.from_dict(rows, orient="index")


def _columns(result: FitResult) -> tuple[str, ...]:
    """Return the headings of the report's table.

    The penalty is the relative rise of the best objective when a coefficient is fixed at its
    published value.
    """
    if result.uncertainty is None:
        return ("", "fitted", "published", "penalty at published", "within 1 %", "identified")
    interval = f"{100 * result.uncertainty.level:g} % interval"
    published = ("published",) if result.published else ()
    return ("", "fitted", "unit", "std. error", interval, *published, "determined")


def _rows(result: FitResult) -> _Rows:
    """Return the rows of the report's table."""
    if result.uncertainty is not None:
        return _measured_rows(result, result.uncertainty)
    published, optimum = result.published, result.objective.value
    of_names = with_units(result, {name: name for name in result.coefficients})
    rows: _Rows = []
    for name, value in result.coefficients.items():
        paper = f"{published.coefficients[name]:g}" if published else "-"
        interval = penalty = ""
        if name in result.profiles:
            profile = result.profiles[name]
            interval = profile.interval
            if profile.objective_at_published is not None:
                penalty = f"{profile.objective_at_published / optimum - 1:+.1%}"
        verdict = identification(result, name)
        rows.append((of_names[name], f"{value:.5g}", paper, penalty, interval, verdict))
    paper = f"{published.objective:.5g}" if published else "-"
    bound = f"bound {result.bound:.5g}" if result.bound is not None else ""
    rows.append((_objective(result), f"{optimum:.5g}", paper, "", bound, ""))
    worst = result.max_abs_diff_percent
    rows.append(
        ("max |Eq 9|, %", _or_dash(worst.fitted, ".4g"), _or_dash(worst.published), "", "", "")
    )
    return rows


def _measured_rows(result: FitResult, uncertainty: Uncertainty) -> _Rows:
    """Return the rows of the table of a fit to measurements."""
    published, units = result.published, units_of(result.law, result.contact)
    rows: _Rows = []
    # The free ones first: the others are the law's own constants.
    ordered = sorted(result.coefficients, key=lambda name: name not in uncertainty.estimates)
    for name in ordered:
        value = result.coefficients[name]
        paper = f"{published.coefficients[name]:.5g}" if published else ""
        estimate = uncertainty.estimates.get(name)
        error = interval = ""
        if estimate is not None and estimate.standard_error is not None:
            error = f"{estimate.standard_error:.2g}"
        if estimate is not None and estimate.profile is not None:
            ends = estimate.profile
            cut = ", bound" if ends.low_is_bound or ends.high_is_bound else ""
            interval = f"{ends.low:.5g} … {ends.high:.5g}{cut}"
        verdict = identification(result, name)
        rows.append((name, f"{value:.5g}", units.get(name, ""), error, interval, paper, verdict))
    paper = f"{published.objective:.5g}" if published else ""
    unit = _OBJECTIVE_UNITS.get(result.objective.name, "")
    rows.append((result.objective.name, f"{result.objective.value:.5g}", unit, "", "", paper, ""))
    worst = result.max_abs_diff_percent
    largest = (
        "largest |Eq 9|",
        _or_dash(worst.fitted, ".4g"),
        "%",
        "",
        "",
        _or_dash(worst.published),
        "",
    )
    if min(result.settings["measurements"]["numbers"]["penetration"]) > 0:
        rows.append(largest)  # of readings about zero a relative difference says nothing
    return rows if published else [(*row[:5], row[6]) for row in rows]


# --- several results --------------------------------------------------------------------------


def compare(results: Sequence[FitResult]) -> str:
    """Return results side by side: a table for those of one kind, then the verdicts.

    Parameters
    ----------
    results : sequence of FitResult
        In the order of the columns.

    Returns
    -------
    str
        Results of one kind are of the same law, contact and search (`by_search`). A table has a
        column for the published coefficients and one for each result, and the samples of each
        beneath. That of a single result gives its difference from the published coefficients.
    """
    parts: list[str] = [_side_by_side_text(group) for group in by_search(results)]
    for result in results:
        parts.append("\n".join([f"{brief(result.name)}:", *map(_item, verdicts(result))]))
    return "\n\n".join(parts)


def by_search(results: Iterable[FitResult]) -> list[list[FitResult]]:
    """Return the results in groups of the same law, contact, fixed and tied coefficients."""
    groups: dict[tuple[str, ...], list[FitResult]] = {}
    for result in results:
        kind = (result.law, result.contact, *labels(result).values())
        groups.setdefault(kind, []).append(result)
    return list(groups.values())


def labels(result: FitResult) -> dict[str, str]:
    """Return the label of each coefficient in tables: its name, its tie, whether it was fixed.

    Examples
    --------
    >>> from cylcontact.fitting import FitResult
    >>> labels(FitResult.read("fitting/results/recovered-external.json"))
    {'a': 'a', 'b': 'b', 'n': 'n (fixed)'}
    """
    of_ties = {name: f"{name} = {expression}" for name, expression in ties(result).items()}
    of_fixed = {name: f"{name} (fixed)" for name in fixed(result)}
    return {name: (of_ties | of_fixed).get(name, name) for name in result.coefficients}


def with_units(result: FitResult, labels: Mapping[str, str]) -> dict[str, str]:
    """Return labels of coefficients with their units, name → "label, unit"."""
    units = units_of(result.law, result.contact)
    return {name: ", ".join(filter(None, (text, units.get(name)))) for name, text in labels.items()}


def _objective(result: FitResult) -> str:
    """Return the name of the objective with its unit."""
    name = result.objective.name
    return ", ".join(filter(None, (name, _OBJECTIVE_UNITS.get(name))))


def side_by_side(results: Sequence[FitResult]) -> dict[str, list[str | None]]:
    """Return results of one law and contact side by side, for the renderings of such a table.

    Parameters
    ----------
    results : sequence of FitResult
        In the order of the columns.

    Returns
    -------
    dict
        The labels of the coefficients, then the rows of `NUMBERS`: row → the published value (""
        below the coefficients) and each fit's; None for a number that does not exist. With a
        single result the published coefficients' numbers are in their own column, and a third one
        holds the difference of the fit from them in percent.

    Examples
    --------
    >>> from cylcontact.fitting import FitResult
    >>> table = side_by_side([FitResult.read("fitting/results/external.json")])
    >>> table["n"], table["objective"]
    (['1.094', '1.0847', '-0.8'], ['0.065965', '0.051954', '-21.2'])
    """
    # Some results of a group may be of data for which nothing was published.
    published = next((r.published.coefficients for r in results if r.published), None)
    rows: dict[str, list[str | None]] = {
        label: [
            f"{published[name]:g}" if published else None,
            *(f"{r.coefficients[name]:.5g}" for r in results),
        ]
        for name, label in labels(results[0]).items()
    }
    columns = [_numbers(result) for result in results]
    for number, (row, (_, form)) in enumerate(NUMBERS.items()):
        values = [column[number] for column in columns]
        rows[row] = ["", *(None if v is None else format(v, form) for v in values)]
    if len(results) == 1:
        _add_differences(rows, results[0])
    return rows


def _add_differences(rows: dict[str, list[str | None]], result: FitResult) -> None:
    """Move the numbers of the published coefficients to their column, and add the differences."""
    for row in ("objective", "largest |Eq 9|, %"):
        rows[row][0] = rows.pop(f"published {row}")[1]
    differences = {}
    if result.published is not None:
        published = result.published.coefficients | {"objective": result.published.objective}
        fitted = result.coefficients | {"objective": result.objective.value}
        differences = {
            label: f"{100 * (fitted[name] / published[name] - 1):+.1f}"
            for name, label in (labels(result) | {"objective": "objective"}).items()
            if published[name] and name not in fixed(result)
        }
    for row, cells in rows.items():
        cells.append(differences.get(row, ""))


def _numbers(result: FitResult) -> tuple[float | None, ...]:
    """Return the numbers of `NUMBERS`."""
    return (
        result.objective.value,
        result.published.objective if result.published else None,
        result.bound,
        result.max_abs_diff_percent.fitted,
        result.max_abs_diff_percent.published,
        result.counts.samples,
        result.counts.masked,
    )


def _side_by_side_text(results: list[FitResult]) -> str:
    """Return results of one law and contact side by side as text."""
    first = results[0]
    of_coefficients = labels(first)
    of_units = with_units(first, of_coefficients)
    names = {row: label for row, (label, _) in NUMBERS.items()}
    names |= {label: of_units[name] for name, label in of_coefficients.items()}
    columns = [f"{first.law}, {first.contact}", "published", *(r.name for r in results)]
    if len(results) == 1:
        names["objective"] = _objective(first)
        columns.append("difference, %")
    rows: _Rows = [
        (names.get(row, row), *("-" if c is None else c for c in cells))
        for row, cells in side_by_side(results).items()
    ]
    if len(results) > 1:
        objectives = ("objective", "", *map(_objective, results))
        rows.insert(len(first.coefficients), objectives)
    return "\n".join([str(Table(columns, rows)), *map(_samples_text, results)])


def _samples_text(result: FitResult) -> str:
    """Return which samples a result was fitted to, in a line."""
    if result.uncertainty is not None:
        return f"{brief(result.name)}: {result.counts.samples:,} measurements"
    axes = result.settings["dataset"]["axes"]
    texts = [_axis_text(*words, axes[name]) for name, words in _AXES.items() if name in axes]
    return f"{brief(result.name)}: samples at {', '.join(texts)}"


def _axis_text(symbol: str, unit: str, axis: Mapping[str, Any]) -> str:
    """Return an axis of a grid in a few words.

    Examples
    --------
    >>> _axis_text("ΔR", " mm", {"min": 0.05, "max": 10.0, "points": 20, "spacing": "log"})
    'ΔR 0.05…10 mm (20 log)'
    """
    values = axis.get("values")
    if values is None:
        low, high, count = axis["min"], axis["max"], f" ({axis['points']} {axis['spacing']})"
    else:
        low, high, count = values[0], values[-1], f" ({len(values)})" if len(values) > 1 else ""
    span = f"{low:g}" if low == high else f"{low:g}…{high:g}"
    return f"{symbol} {span}{unit}{count}"


# --- studies of uncertainty -------------------------------------------------------------------


def noise_text(study: NoiseStudy) -> str:
    """Return the report on the uncertainty of a fit to measurements."""
    uncertainty, bootstrap = study.uncertainty, study.bootstrap
    level = f"{100 * uncertainty.level:g} %"
    rows: _Rows = []
    for name, estimate in uncertainty.estimates.items():
        error = covariance = profile = "-"
        if estimate.standard_error is not None:
            error = f"{estimate.standard_error:.3g}"
            covariance = _interval(estimate.low, estimate.high)
        if estimate.profile is not None:
            profile = _interval(estimate.profile.low, estimate.profile.high)
        resampled = "-" if bootstrap is None else _resampled(bootstrap, name)
        rows.append((name, f"{estimate.value:.5g}", error, covariance, profile, resampled))
    intervals = [f"{level}, {method}" for method in ("covariance", "profile", "bootstrap")]
    warned = noise_warnings(uncertainty)
    sentences = [each for each in noise_verdicts(uncertainty) if each not in warned]
    if bootstrap is not None:
        sentences.append(_on_bootstrap(bootstrap, level))
    title = f"{brief(study.name)}: uncertainty from the noise of the measurements"
    parts = [
        "\n".join([title, *(_item(sentence, "! ") for sentence in warned)]),
        str(Table(("", "fitted", "std. error", *intervals), rows)),
        "\n".join(map(_item, sentences)),
        *_left_out(study.left_out, list(uncertainty.estimates)),
        *_on_bands(study.bands, level),
    ]
    return "\n\n".join(parts)


def discrepancy_text(study: DiscrepancyStudy, result: FitResult) -> str:
    """Return the report on the discrepancy of a fit to a reference law."""
    rows: _Rows = [
        (name, f"{result.coefficients[name]:.5g}", profile.interval)
        for name, profile in study.profiles.items()
    ]
    low, middle, high = study.spread_percent.values()
    sentences = [
        f"{result.reference} is a law, not a measurement: the residuals are model discrepancy, "
        "which has no standard error",
        f"over the grid, Eq 9 lies between {low:+.3g} % and {high:+.3g} % for 95 % of the samples "
        f"(median {middle:+.3g} %)",
    ]
    parts = [
        f"{brief(study.name)}: how far each coefficient may move before the best objective rises "
        "by 1 %",
        str(Table(("", "fitted", "within 1 %"), rows)),
        "\n".join(map(_item, sentences)),
        *_left_out(study.left_out, list(study.profiles)),
    ]
    return "\n\n".join(parts)


def _interval(low: float | None, high: float | None) -> str:
    """Return an interval."""
    return "-" if low is None or high is None else f"{low:.5g} … {high:.5g}"


def _resampled(bootstrap: Bootstrap, name: str) -> str:
    """Return the bootstrap interval, or only the standard error after too few refits."""
    if name not in bootstrap.intervals:
        return f"error {bootstrap.standard_errors[name]:.3g}"
    return _interval(bootstrap.intervals[name].low, bootstrap.intervals[name].high)


def _on_bootstrap(bootstrap: Bootstrap, level: str) -> str:
    """Return a sentence on the bootstrap: the groups resampled, and if the refits suffice."""
    plural = {"rows": "rows", "dR": "clearances"}.get(bootstrap.over, f"{bootstrap.over}s")
    sentence = f"bootstrap: {bootstrap.replicates} refits to {bootstrap.groups} resampled {plural}"
    refits = bootstrap.replicates - bootstrap.undefined
    if bootstrap.undefined:
        sentence += f", of which {bootstrap.undefined} left the law undefined and do not count"
    if not bootstrap.intervals:
        sentence += (
            f"; {refits} refits give standard errors, and {level} intervals from {FEWEST_REFITS}"
        )
    elif refits < FEW_REFITS:
        sentence += f"; {refits} refits are few for {level} intervals, take {FEW_REFITS} or more"
    if bootstrap.groups < FEW_GROUPS:
        sentence += f"; {bootstrap.groups} are few, and their intervals too narrow as a rule"
    return sentence


def _left_out(fits: Sequence[LeftOut], names: Sequence[str]) -> list[str]:
    """Return the table of fits without one group; nothing if there are none."""
    if not fits:
        return []
    rows = [
        (
            fit.group,
            f"{fit.rows:,}",
            *(f"{fit.coefficients[name]:.5g}" for name in names),
            "-" if fit.own_rms is None else f"{fit.own_rms:.4g}",
        )
        for fit in fits
    ]
    table = Table(("without", "samples", *names, "RMS on that group"), rows)
    return [f"Fits without one group, and how well they predict it:\n{table}"]


def _on_bands(bands: Sequence[Band], level: str) -> list[str]:
    """Return the half-widths of the bands at both ends of each pair's range."""
    if not bands:
        return []
    rows = [
        (band.name, band.quantity, *_half_widths(band, 0), *_half_widths(band, -1))
        for band in bands
    ]
    end = ("at", "curve ±%", "new ±%")
    table = Table(("pair", "predicted", *end, *end), rows)
    return [f"Bands at the ends of the range ({level}):\n{table}"]


def _half_widths(band: Band, k: int) -> tuple[str, str, str]:
    """Return a point of a band and its half-widths there, in percent."""
    value = abs(band.value[k])  # a predicted reading may be 0 or below
    widths = (band.high[k] - band.low[k], band.new_high[k] - band.new_low[k])
    curve, new = (f"{50 * width / value:.2g}" if value > 0 else "-" for width in widths)
    return f"{band.at[k]:.4g}", curve, new


# --- pieces of text ---------------------------------------------------------------------------


def _item(sentence: str, mark: str = "- ") -> str:
    """Return a sentence as an item of a list, wrapped."""
    return fill(sentence, _WIDTH, initial_indent=mark, subsequent_indent="  ")


def _or_dash(value: float | None, style: str = ".5g") -> str:
    """Return a number, or a dash for None."""
    return "-" if value is None else format(value, style)
