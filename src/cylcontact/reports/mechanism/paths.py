"""The way of the journal's centre in its bearing, as panels: Figs 18 and 19."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.arrays import BoolArray, FloatArray
from cylcontact.mechanism import Case, Trajectory
from cylcontact.plots.figure import new_figure
from cylcontact.plots.style import ACCENT, small_text
from cylcontact.reports.mechanism.magnified import draw_clearance_circle
from cylcontact.reports.mechanism.runs import FRICTIONS, LAW_NAMES, RESTITUTIONS

# What is left out of a path changes it by less than that, in clearances: a tenth of a line's width.
TOLERANCE = 0.002
FLIGHT: dict[str, Any] = {"color": "0.6", "linewidth": 0.35, "linestyle": "-", "marker": ""}
TOUCH: dict[str, Any] = {"color": ACCENT, "linewidth": 0.7, "linestyle": "-", "marker": ""}
CIRCLE: dict[str, Any] = {"linewidth": 0.6, "linestyle": (0, (4, 2)), "zorder": 4}


def path_table(case: Case, run: Trajectory, first: int) -> pd.DataFrame:
    """Return the journal centre's way from a revolution on, without the steps that do not show.

    Parameters
    ----------
    case : Case
        What the rows are marked with.
    run : Trajectory
        The run.
    first : int
        The first revolution, from 0.

    Returns
    -------
    pandas.DataFrame
        Columns law, clearance_mm, restitution, friction, revolution, x_um and y_um of the
        journal's centre from the bearing's (−e), and mode, "contact" or "flight".
    """
    rows = run.revolution >= first
    places = -run.eccentricity[rows] * 1e6
    touching = run.in_contact[rows]
    kept = _kept(places, touching, TOLERANCE * run.mechanism.clearance.radial * 1e6)
    return pd.DataFrame(
        {
            "law": case.law,
            "clearance_mm": case.clearance,
            "restitution": case.restitution,
            "friction": case.friction,
            "revolution": run.revolution[rows][kept],
            "x_um": places[kept, 0],
            "y_um": places[kept, 1],
            "mode": np.where(touching[kept], "contact", "flight"),
        }
    )


def _kept(places: FloatArray, touching: BoolArray, tolerance: float) -> BoolArray:
    """Choose the points to keep; where the mode changes both rows stay."""
    changes = np.flatnonzero(np.diff(touching))
    ends = np.unique(np.concatenate(([0, len(places) - 1], changes, changes + 1)))
    kept = np.zeros(len(places), dtype=bool)
    kept[ends] = True
    stretches = [(int(a), int(b)) for a, b in pairwise(ends)]
    while stretches:
        start, end = stretches.pop()
        if end - start < 2:
            continue
        away = _distances(places[start + 1 : end], places[start], places[end])
        farthest = int(away.argmax())
        if away[farthest] > tolerance:
            middle = start + 1 + farthest
            kept[middle] = True
            stretches += [(start, middle), (middle, end)]
    return kept


def _distances(places: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Return the distances of points from the line between two others (Douglas and Peucker)."""
    along, off = end - start, places - start
    length = float(np.hypot(*along))
    if length == 0.0:
        distances: FloatArray = np.hypot(*off.T)
    else:
        distances = np.abs(along[0] * off[:, 1] - along[1] * off[:, 0]) / length
    return distances


def path_panels(paths: Mapping[Case, pd.DataFrame]) -> Figure:
    """Draw the paths of one clearance, a row for each law and a column for each dissipation.

    Parameters
    ----------
    paths : mapping of Case to pandas.DataFrame
        Those of `path_table`.
    """
    columns = [(ce, cf) for ce in RESTITUTIONS for cf in FRICTIONS]
    figure = new_figure("full", 118.0, wide=True)
    panels = figure.subplots(len(LAW_NAMES), len(columns), sharex=True, sharey=True)
    clearance = next(iter(paths)).clearance * 1e3
    farthest = max(float(np.hypot(path["x_um"], path["y_um"]).max()) for path in paths.values())
    reach = 1.06 * max(farthest, clearance)
    for case, path in paths.items():
        row, column = (
            list(LAW_NAMES).index(case.law),
            columns.index((case.restitution, case.friction)),
        )
        axes = panels[row, column]
        _draw_path(axes, path)
        draw_clearance_circle(axes, clearance, **CIRCLE)
        axes.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
        if row == 0:
            axes.set_title(rf"$c_e$ = {case.restitution:g}, $c_f$ = {case.friction:g}")
        if column == 0:
            axes.set_ylabel(f"{LAW_NAMES[case.law]}\n$-e_y$ (µm)", fontsize=small_text())
        if row == len(LAW_NAMES) - 1:
            axes.set_xlabel("$-e_x$ (µm)", fontsize=small_text())
    return figure


def _draw_path(axes: Axes, path: pd.DataFrame) -> None:
    """Draw flights thin and grey, contacts over them."""
    x, y = path["x_um"].to_numpy(), path["y_um"].to_numpy()
    touching = (path["mode"] == "contact").to_numpy()
    for look, shown, order in ((FLIGHT, ~touching, 2), (TOUCH, touching, 3)):
        axes.plot(np.where(shown, x, np.nan), np.where(shown, y, np.nan), **look, zorder=order)
