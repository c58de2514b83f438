"""The joint uncertainty of two coefficients: noise of measured data, discrepancy of laws."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from cylcontact.arrays import FloatArray
from cylcontact.fitting.calibration import calibrate
from cylcontact.fitting.campaign import read_campaign
from cylcontact.fitting.result import FitResult
from cylcontact.fitting.uncertainty.discrepancy import RISES, study_discrepancy
from cylcontact.fitting.uncertainty.profiles import DiscrepancyPair, PairMap
from cylcontact.fitting.uncertainty.study import study_noise
from cylcontact.plots.figure import Drawing, new_figure, panel_title
from cylcontact.plots.style import ACCENT, COLOURS
from cylcontact.reports.bench import Bench

STYLES = ("-", "--", ":")
# Points of the finer grid along each axis.
FINE = 241


def draw(bench: Bench) -> Drawing:
    measured = calibrate(read_campaign(bench.input("fitting/examples/pin-in-hole.toml")))
    reference = bench.result("external")
    noise = study_noise(measured, with_pairs=True).pairs[0]
    pairs = study_discrepancy(reference, with_pairs=True).pairs
    discrepancy = next(pair for pair in pairs if pair.names == ("b", "n"))
    figure = new_figure("full", 84.0)
    left, right = figure.subplots(1, 2)
    _draw_noise(left, measured, noise)
    _draw_discrepancy(right, reference, discrepancy)
    left.set(xlabel=r"$\kappa$ (-)", ylabel="$c$ (-)")
    right.set(xlabel="$b$ (mm$^{2-n}$)", ylabel="$n$ (-)")
    for axes in (left, right):
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=3, columnspacing=1.2)
    panel_title(left, 0, "measured data (synthetic): noise")
    panel_title(right, 1, f"fit to {reference.reference.capitalize()}: model discrepancy")
    table = _table(noise, discrepancy)
    return Drawing(figure, table, _headline(measured), _caption(measured, reference))


def _draw_noise(axes: Axes, result: FitResult, pair: PairMap) -> None:
    """Draw the confidence regions of two parameters."""
    x, y, height_map = _smooth(pair.x, pair.y, pair.ratio)
    for style, colour, (level, height) in zip(
        STYLES, COLOURS, pair.thresholds.items(), strict=False
    ):
        axes.contour(x, y, height_map, [np.sqrt(height)], colors=[colour], linestyles=[style])
        axes.plot([], [], style, color=colour, marker="", label=f"{level} % region")
    _mark(axes, result, pair.names)


def _smooth(
    x: list[float], y: list[float], heights: list[list[float | None]]
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
    limits = axes.axis()
    axes.plot(*(result.coefficients[n] for n in names), "*", color=ACCENT, label="fitted")
    if result.published is not None:
        x, y = (result.published.coefficients[n] for n in names)
        if limits[0] <= x <= limits[1] and limits[2] <= y <= limits[3]:
            axes.plot(x, y, "o", color=COLOURS[1], label="published")


def _draw_discrepancy(axes: Axes, result: FitResult, pair: DiscrepancyPair) -> None:
    """Draw by how much the best attainable objective rises."""
    x, y, height_map = _smooth(pair.x, pair.y, pair.rise)
    for style, colour, height in zip(STYLES, COLOURS, RISES, strict=False):
        axes.contour(x, y, height_map, [np.sqrt(height)], colors=[colour], linestyles=[style])
        axes.plot([], [], style, color=colour, marker="", label=f"objective +{100 * height:g} %")
    _mark(axes, result, pair.names)


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


def _headline(measured: FitResult) -> dict[str, float]:
    """Return the intervals of the fit to data."""
    estimates = measured.uncertainty.estimates if measured.uncertainty else {}
    headline = {}
    for name, estimate in estimates.items():
        headline[f"fitted {name}"] = estimate.value
        if estimate.profile is not None:
            headline[f"lowest {name} at 95 %"] = estimate.profile.low
            headline[f"highest {name} at 95 %"] = estimate.profile.high
    return headline


def _caption(measured: FitResult, reference: FitResult) -> str:
    """Return the caption."""
    return (
        f"Two coefficients at a time, the others refitted. (a) The fit {measured.name!r} of the "
        f"{measured.law} law to {measured.counts.samples} synthetic measurements (derived: "
        "Johnson's law with 3 % of noise, one row off by 25 %): regions that hold the true values, "
        "here the published ones, at the level given, by the likelihood's profile. (b) The fit "
        f"{reference.name!r} of the {reference.law} law to {reference.reference.capitalize()}'s, "
        "which has no noise: where the best attainable objective lies "
        f"{', '.join(f'{100 * rise:g} %' for rise in RISES)} above the optimum. The noise in (a), "
        "and the grid and objective in (b), are our choice."
    )
