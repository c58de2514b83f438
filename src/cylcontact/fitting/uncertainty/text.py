"""Studies of uncertainty as text for a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from cylcontact.fitting.result import FitResult
from cylcontact.fitting.summary import item, text_table
from cylcontact.fitting.uncertainty.bands import Band
from cylcontact.fitting.uncertainty.discrepancy import DiscrepancyStudy
from cylcontact.fitting.uncertainty.resampling import (
    FEW_GROUPS,
    FEW_REFITS,
    FEWEST_REFITS,
    Bootstrap,
    LeftOut,
)
from cylcontact.fitting.uncertainty.study import NoiseStudy
from cylcontact.fitting.uncertainty.wording import noise_verdicts


def noise_text(study: NoiseStudy) -> str:
    """Return the report on a fit to measurements."""
    found = study.uncertainty
    level = f"{100 * found.level:g} %"
    lines: list[tuple[str, ...]] = []
    for name, estimate in found.estimates.items():
        covariance = profile = error = "-"
        if estimate.standard_error is not None:
            error = f"{estimate.standard_error:.3g}"
            covariance = _ends(estimate.low, estimate.high)
        if estimate.profile is not None:
            profile = _ends(estimate.profile.low, estimate.profile.high)
        resampled = "-"
        if study.bootstrap is not None:
            resampled = _resampled(study.bootstrap, name)
        lines.append((name, f"{estimate.value:.5g}", error, covariance, profile, resampled))
    columns = ("", "fitted", "std. error", f"{level}, covariance", f"{level}, profile")
    parts = [
        f"{study.name}: how sure, given the noise of the measurements",
        text_table((*columns, f"{level}, bootstrap"), lines),
        "\n".join(map(item, [*noise_verdicts(found), *_on_bootstrap(study.bootstrap, level)])),
    ]
    parts += _left_out(study.left_out, list(found.estimates))
    parts += _on_bands(study.bands, level)
    return "\n\n".join(parts)


def discrepancy_text(study: DiscrepancyStudy, result: FitResult) -> str:
    """Return the report on a fit to a reference law."""
    lines: list[tuple[str, ...]] = [
        (name, f"{result.coefficients[name]:.5g}", curve.interval)
        for name, curve in study.profiles.items()
    ]
    low, middle, high = study.spread_percent.values()
    sentences = [
        f"{result.reference} is a law, not a measurement: what is left over is model discrepancy, "
        "and no standard errors belong to it",
        f"over the grid, Eq 9 lies between {low:+.3g} % and {high:+.3g} % for 95 % of the samples "
        f"(median {middle:+.3g} %)",
    ]
    parts = [
        f"{study.name}: how far each coefficient may move before the best objective rises by 1 %",
        text_table(("", "fitted", "within 1 %"), lines),
        "\n".join(map(item, sentences)),
    ]
    return "\n\n".join(parts + _left_out(study.left_out, list(study.profiles)))


def _ends(low: float | None, high: float | None) -> str:
    """Return an interval."""
    return "-" if low is None or high is None else f"{low:.5g} … {high:.5g}"


def _resampled(found: Bootstrap, name: str) -> str:
    """Return the interval of a bootstrap, or its standard error alone where it has none."""
    if name not in found.intervals:
        return f"error {found.standard_errors[name]:.3g}"
    return _ends(found.intervals[name].low, found.intervals[name].high)


def _on_bootstrap(found: Bootstrap | None, level: str) -> list[str]:
    """Say what was resampled, and whether there was enough of it."""
    if found is None:
        return []
    said = f"bootstrap: {found.replicates} refits to {found.groups} resampled {_plural(found.over)}"
    done = found.replicates - found.undefined
    if found.undefined:
        said += f", of which {found.undefined} left the law undefined and do not count"
    if not found.intervals:
        said += f"; {done} refits give standard errors, and {level} intervals from {FEWEST_REFITS}"
    elif done < FEW_REFITS:
        said += f"; {done} refits are few for {level} intervals, take {FEW_REFITS} or more"
    if found.groups < FEW_GROUPS:
        said += f"; {found.groups} are few, and their intervals too narrow as a rule"
    return [said]


def _plural(over: str) -> str:
    """Return what was resampled, in the plural."""
    return {"rows": "rows", "dR": "clearances"}.get(over, f"{over}s")


def _left_out(found: Sequence[LeftOut], names: Sequence[str]) -> list[str]:
    """Return the table of fits without one group."""
    if not found:
        return []
    lines = [
        (
            left.group,
            f"{left.rows:,}",
            *(f"{left.coefficients[name]:.5g}" for name in names),
            "-" if left.own_rms is None else f"{left.own_rms:.4g}",
        )
        for left in found
    ]
    table = text_table(("without", "samples", *names, "their objective"), lines)
    return ["Fits without one group, and how well they predict it:\n" + table]


def _on_bands(bands: Sequence[Band], level: str) -> list[str]:
    """Return the width of the bands at the ends of each pair's range."""
    if not bands:
        return []
    lines = [(band.name, band.quantity, *_widths(band)) for band in bands]
    columns = ("pair", "predicted", "at", "curve ±%", "new ±%", "at", "curve ±%", "new ±%")
    return [f"Bands at the ends of the range ({level}):\n" + text_table(columns, lines)]


def _widths(band: Band) -> list[str]:
    """Return where a band begins and ends, and its half-widths there."""
    cells = []
    for k in (0, -1):
        curve = 50 * (band.high[k] - band.low[k]) / band.value[k]
        new = 50 * (band.new_high[k] - band.new_low[k]) / band.value[k]
        cells += [f"{band.at[k]:.4g}", f"{curve:.2g}", f"{new:.2g}"]
    return cells
