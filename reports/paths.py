"""Figs 18 and 19: the paths of the journal's centre in its bearing, at two clearances."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.arrays import BoolArray, FloatArray
from cylcontact.mechanism import Case, Trajectory
from cylcontact.mechanism.drawing import draw_clearance_circle
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.style import ACCENT, small_text
from cylcontact.reports.bench import Bench

from .paper import FRICTIONS, JOINT_LAWS, RESTITUTIONS
from .slider_crank import (
    CASES,
    assumed,
    horizons,
    law_ends,
    mechanism,
    simulated,
)

# The first revolution drawn, from 0; the runs that settle have settled by then.
FIRST = 3
NUMBERS = {
    "contact_fraction": "share of time in contact, -",
    "impacts": "impacts per revolution, -",
    "max_penetration_um": "largest penetration, um",
}
CAPTION = (
    "Journal centre relative to the bearing's, over {drawn} of the crank, at a radial clearance of "
    "{clearance:g} mm, in µm and to scale; by rows the contact law, by columns the coefficient of "
    "restitution c_e (in Lankarani and Nikravesh's factor) and of friction c_f. Grey: flight; "
    "orange: contact; dashed: the clearance circle, which the centre leaves by the penetration. "
    "{share}. {whirls}{horizons} Beyond that a path is one of many, and only its statistics are of "
    "use. Which revolutions the paper draws is not said. {ends} {assumed}"
)
# The points omitted change a path by less than this, in clearances: a tenth of a line's width.
TOLERANCE = 0.002
FLIGHT: dict[str, Any] = {"color": "0.6", "linewidth": 0.35, "linestyle": "-", "marker": ""}
TOUCH: dict[str, Any] = {"color": ACCENT, "linewidth": 0.7, "linestyle": "-", "marker": ""}
CIRCLE: dict[str, Any] = {"linewidth": 0.6, "linestyle": (0, (4, 2)), "zorder": 4}


def path_drawing(bench: Bench, clearance: float, revolutions: int) -> Drawing:
    """Draw the journal's paths at one clearance, for all laws, restitutions and frictions."""
    drawn = [case for case in CASES if case.clearance == clearance]
    runs = {case: simulated(bench, case, FIRST + revolutions) for case in drawn}
    paths = {case: path_table(case, run, FIRST) for case, run in runs.items()}
    means = {case: run.statistics(FIRST).mean for case, run in runs.items()}
    headline = {
        f"{case.law}, c_e = {case.restitution:g}, c_f = {case.friction:g}: {text}": mean[column]
        for case, mean in means.items()
        for column, text in NUMBERS.items()
    }
    always = sum(mean["contact_fraction"] == 1.0 for mean in means.values())
    last = FIRST + revolutions
    caption = CAPTION.format(
        drawn=f"revolutions {FIRST + 1} to {last}" if revolutions > 1 else f"revolution {last}",
        clearance=clearance,
        whirls=_whirls(runs, clearance),
        share=f"In {always} of the {len(drawn)} the journal then stays on the bearing's wall",
        horizons=horizons(bench, clearance),
        ends=law_ends(list(runs.values())),
        assumed=assumed(mechanism(bench)),
    )
    table = pd.concat(paths.values(), ignore_index=True)
    return Drawing(_draw_panels(paths), table, headline, caption)


def path_table(case: Case, run: Trajectory, first: int) -> pd.DataFrame:
    """Return the path of the journal's centre (−e), without the points that a line needs not."""
    rows = run.revolution >= first
    places = -run.eccentricity[rows] * 1e6
    touching = run.in_contact[rows]
    drawn = _simplified(places, touching, TOLERANCE * run.mechanism.clearance.radial * 1e6)
    return pd.DataFrame(
        {
            "law": case.law,
            "clearance_mm": case.clearance,
            "restitution": case.restitution,
            "friction": case.friction,
            "revolution": run.revolution[rows][drawn],
            "x_um": places[drawn, 0],
            "y_um": places[drawn, 1],
            "mode": np.where(touching[drawn], "contact", "flight"),
        }
    )


def _simplified(places: FloatArray, touching: BoolArray, tolerance: float) -> BoolArray:
    """Return a mask of the points that the path needs; both rows of a change of mode stay."""
    changes = np.flatnonzero(np.diff(touching))
    ends = np.unique(np.concatenate(([0, len(places) - 1], changes, changes + 1)))
    needed = np.zeros(len(places), dtype=bool)
    needed[ends] = True
    stretches = [(int(a), int(b)) for a, b in pairwise(ends)]
    while stretches:
        start, end = stretches.pop()
        if end - start < 2:
            continue
        away = _distances(places[start + 1 : end], places[start], places[end])
        farthest = int(away.argmax())
        if away[farthest] > tolerance:
            middle = start + 1 + farthest
            needed[middle] = True
            stretches += [(start, middle), (middle, end)]
    return needed


def _distances(places: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Return the distances of points from the line between two others (Douglas and Peucker)."""
    along, off = end - start, places - start
    length = float(np.hypot(*along))
    if length == 0.0:
        distances: FloatArray = np.hypot(*off.T)
    else:
        distances = np.abs(along[0] * off[:, 1] - along[1] * off[:, 0]) / length
    return distances


def _whirls(runs: Mapping[Case, Trajectory], clearance: float) -> str:
    """Return a sentence on the runs whose penetration exceeds the clearance, or nothing."""
    deep = {
        case: run
        for case, run in runs.items()
        if run.statistics(FIRST).mean["max_penetration_um"] > 1e3 * clearance
    }
    if not deep:
        return ""
    turns = [_turns(run) for run in deep.values()]
    losses = sorted({(case.restitution, case.friction) for case in deep})
    text = " and ".join(f"c_e = {c_e:g}, c_f = {c_f:g}" for c_e, c_f in losses)
    return (
        f"At {text} the penetration exceeds the clearance in {len(deep)} runs, for some "
        "revolutions at a time: the journal's "
        f"centre whirls about the bearing's, {min(turns):.2g} to {max(turns):.2g} turns per "
        "revolution of the crank, both senses counted, and its inertia presses it outwards. "
    )


def _turns(run: Trajectory) -> float:
    """Return the turns of the journal's centre about the bearing's per revolution, without sign."""
    rows = run.revolution >= FIRST
    angle = np.unwrap(np.arctan2(*run.eccentricity[rows].T[::-1]))
    return float(np.abs(np.diff(angle)).sum() / (2 * np.pi) / np.ptp(run.revolution[rows]))


def _draw_panels(paths: Mapping[Case, pd.DataFrame]) -> Figure:
    """Draw the paths of one clearance, a row for each law and a column for each dissipation."""
    columns = [(ce, cf) for ce in RESTITUTIONS for cf in FRICTIONS]
    figure = new_figure("full", 118.0)
    panels = figure.subplots(len(JOINT_LAWS), len(columns), sharex=True, sharey=True)
    clearance = next(iter(paths)).clearance * 1e3
    farthest = max(float(np.hypot(path["x_um"], path["y_um"]).max()) for path in paths.values())
    reach = 1.06 * max(farthest, clearance)
    for case, path in paths.items():
        row, column = (
            list(JOINT_LAWS).index(case.law),
            columns.index((case.restitution, case.friction)),
        )
        axes = panels[row, column]
        _draw_path(axes, path)
        draw_clearance_circle(axes, clearance, **CIRCLE)
        axes.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
        if row == 0:
            axes.set_title(rf"$c_e$ = {case.restitution:g}, $c_f$ = {case.friction:g}")
        if column == 0:
            axes.set_ylabel(f"{JOINT_LAWS[case.law]}\n$-e_y$ (µm)", fontsize=small_text())
        if row == len(JOINT_LAWS) - 1:
            axes.set_xlabel("$-e_x$ (µm)", fontsize=small_text())
    return figure


def _draw_path(axes: Axes, path: pd.DataFrame) -> None:
    """Draw flights thin and grey, contacts over them."""
    x, y = path["x_um"].to_numpy(), path["y_um"].to_numpy()
    touching = (path["mode"] == "contact").to_numpy()
    for style, drawn, order in ((FLIGHT, ~touching, 2), (TOUCH, touching, 3)):
        axes.plot(np.where(drawn, x, np.nan), np.where(drawn, y, np.nan), **style, zorder=order)


FIGURES: dict[str, Callable[[Bench], Drawing]] = {
    "fig18": partial(path_drawing, clearance=0.5, revolutions=3),
    "fig19": partial(path_drawing, clearance=0.02, revolutions=1),
}
