"""The joint uncertainty of two coefficients: noise of measured data, discrepancy of laws."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.contour import QuadContourSet

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.fitting import Campaign, DataFit, FitResult, LawFit
from cylcontact.fitting.calibration import problem_of
from cylcontact.fitting.discrepancy import RISES
from cylcontact.fitting.profiles import discrepancy_pair
from cylcontact.fitting.records import DiscrepancyPair, PairMap
from cylcontact.fitting.table_campaign import TableCampaign, read_campaign
from cylcontact.fitting.table_fit import fit_table
from cylcontact.plots.figure import Drawing, legend_below, new_figure, panel_title
from cylcontact.plots.style import ACCENT, COLOURS, LINE_STYLES, small_text
from cylcontact.reports.bench import Bench

Heights = list[list[float | None]]
CAPTION = (
    "How well a fit determines two coefficients. (a) Johnson's law fitted to synthetic "
    "measurements: regions that hold the true factor κ and constant c at confidence levels of 68 "
    "and 95 %. (b) The enhanced law fitted to Johnson's, external contact, without noise: best "
    "attainable objective 1, 5 and 10 % above the optimum. Noise, grid and objective are ours."
)

# Points of the finer grid along each axis.
FINE = 241
LEVELS = (0.68, 0.95)
MARKS: dict[str, dict[str, Any]] = {
    "fitted": {"marker": "o", "color": ACCENT, "markerfacecolor": ACCENT},
    "published": {"marker": "s", "color": COLOURS[1]},
}


def draw(bench: Bench) -> Drawing:
    campaign = read_campaign(bench.input("fitting/examples/pin-in-hole.toml"))
    assert isinstance(campaign, TableCampaign)
    measured = fit_table(campaign)
    reference = bench.result("external")
    noise, discrepancy = _noise(measured), _discrepancy(reference)
    figure = new_figure("full", 80.0)
    left, right = figure.subplots(1, 2)
    levels = noise.thresholds
    regions = _draw_map(left, noise, noise.ratio, list(levels.values()))
    contours = _draw_map(right, discrepancy, discrepancy.rise, RISES)
    _mark(left, measured, noise.names)
    _mark(right, reference, discrepancy.names)
    left.set(xlabel=r"$\kappa$ (-)", ylabel="$c$ (-)")
    right.set(xlabel="$b$ (mm$^{2-n}$)", ylabel="$n$ (-)")
    panel_title(left, 0, "synthetic measurements: noise")
    panel_title(right, 1, f"fit to {reference.reference.capitalize()}'s law: model discrepancy")
    legend_below(left, 2)
    figure.draw_without_rendering()
    _label(left, regions, [f"{level} %" for level in levels])
    _label(right, contours, [f"+{100 * rise:g} %" for rise in RISES])
    table = _table(noise, discrepancy)
    return Drawing(figure, table, _headline(measured), CAPTION, _method(measured, reference))


def _noise(result: DataFit) -> PairMap:
    """Return the likelihood over the two parameters of a fit to data."""
    estimates = result.uncertainty.estimates
    ends = {name: one.profile for name, one in estimates.items() if one.profile is not None}
    (names,) = result.optimum.pairs
    return result.optimum.map_of_pair(names, ends, LEVELS)


def _discrepancy(result: LawFit) -> DiscrepancyPair:
    """Return the rise of the objective over b and n of a fit to a law."""
    campaign = Campaign.of_settings(result.name, result.settings, f"fit {result.name!r}")
    problem, _ = problem_of(campaign)
    return discrepancy_pair(problem, ("b", "n"), result.coefficients, result.profiles)


def _draw_map(
    axes: Axes, pair: PairMap | DiscrepancyPair, heights: Heights, levels: Sequence[float]
) -> QuadContourSet:
    """Draw contours of a map, through its square root, which is smoother."""
    x, y, smooth = _smooth(pair.x, pair.y, heights)
    styles = LINE_STYLES[: len(levels)]
    return axes.contour(x, y, smooth, np.sqrt(levels), colors="black", linestyles=styles)


def _label(axes: Axes, lines: QuadContourSet, words: Sequence[str]) -> None:
    """Label contours, in turn where each is farthest to the lower left and upper right."""
    to_axes, places = axes.transData + axes.transAxes.inverted(), []
    for number, path in enumerate(lines.get_paths()):
        points = as_floats(path.vertices)
        across = to_axes.transform(points).sum(axis=1)
        places.append(points[across.argmax() if number % 2 else across.argmin()])
    texts = dict(zip(lines.levels, words, strict=True))
    size = small_text()
    axes.clabel(lines, fmt=texts, fontsize=size, inline_spacing=3, manual=places, colors="black")


def _smooth(
    x: list[float], y: list[float], heights: Heights
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the square root of a map on a finer grid, by cubic splines through the map.

    A map with points at which the law is undefined keeps its grid.
    """
    from scipy.interpolate import RectBivariateSpline

    plain = np.sqrt(np.maximum(np.array(heights, dtype=float), 0.0))
    if not np.isfinite(plain).all():
        return np.array(x), np.array(y), plain
    fine_x, fine_y = (np.linspace(axis[0], axis[-1], FINE) for axis in (x, y))
    squared = RectBivariateSpline(y, x, plain**2)(fine_y, fine_x)
    return fine_x, fine_y, np.sqrt(np.maximum(squared, 0.0))


def _mark(axes: Axes, result: FitResult, names: tuple[str, str]) -> None:
    """Mark the fitted and the published coefficients, the latter if within the map."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    marked = {"fitted": result.coefficients}
    if result.published is not None:
        marked["published"] = result.published.coefficients
    for label, coefficients in marked.items():
        x, y = (coefficients[name] for name in names)
        if left <= x <= right and low <= y <= high:
            axes.plot(x, y, linestyle="none", label=label, **MARKS[label])


def _table(noise: PairMap, discrepancy: DiscrepancyPair) -> pd.DataFrame:
    """Return the heights drawn, both panels one below the other."""
    rows = [
        {"panel": panel, "coefficient_x": pair.names[0], "coefficient_y": pair.names[1], "x": x}
        | {"y": y, "height": heights[row][column]}
        for panel, pair, heights in (
            ("noise", noise, noise.ratio),
            ("discrepancy", discrepancy, discrepancy.rise),
        )
        for row, y in enumerate(pair.y)
        for column, x in enumerate(pair.x)
    ]
    return pd.DataFrame(rows)


def _headline(measured: DataFit) -> dict[str, float]:
    """Return the intervals of the fit to data."""
    estimates = measured.uncertainty.estimates
    headline = {}
    for name, estimate in estimates.items():
        headline[f"fitted {name}"] = estimate.value
        if estimate.profile is not None:
            headline[f"lowest {name} at 95 %"] = estimate.profile.low
            headline[f"highest {name} at 95 %"] = estimate.profile.high
    return headline


def _method(measured: DataFit, reference: LawFit) -> str:
    """Return how both maps were made."""
    return (
        f"(a) The fit {measured.name!r} of the {measured.law} law to {measured.counts.samples} "
        "synthetic measurements, derived from Johnson's law with 3 % of noise and one row that is "
        "off by 25 %. The regions follow from the profile of the likelihood; the published "
        f"coefficients are the true ones here. (b) The fit {reference.name!r} of the "
        f"{reference.law} law to {reference.reference.capitalize()}'s, which has no noise; the "
        "other coefficients are refitted at every point. The noise in (a), and the grid and the "
        "objective in (b), are our choice. Splines through maps of 21 × 21 points give the curves."
    )
