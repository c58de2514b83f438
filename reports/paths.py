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
from matplotlib.lines import Line2D

from cylcontact.arrays import BoolArray, FloatArray
from cylcontact.mechanism import Case, Trajectory
from cylcontact.mechanism.drawing import draw_clearance_circle
from cylcontact.plots.figure import Drawing, StyledFigure, new_figure
from cylcontact.plots.style import ACCENT, COLOURS, MM_PER_INCH, current_style, small_text
from cylcontact.reports.bench import Bench

from .paper import FRICTIONS, RESTITUTIONS
from .slider_crank import (
    CASES,
    DRAWN_STEP,
    LAW_NAMES,
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
    "Paths of the journal's centre in its bearing over {drawn} of the crank, to one scale, at a "
    "radial clearance c of {clearance:g} mm, for four contact laws and four pairs of restitution "
    "c_e and friction coefficient c_f; x along the slide. Pale: the whole path; dark: its last "
    "{last:g} revolution. The mechanism's data are assumed."
)
METHOD = (
    "The path is that of -e, the journal's centre relative to the bearing's. In contact it is "
    "outside the clearance circle by the penetration. The restitution c_e acts through the factor "
    "of Lankarani and Nikravesh. In {always} of the {cases} cases the journal stays in contact "
    "throughout; the shortest flights of the others cannot be seen at this scale. "
    "{whirls}{horizons} Beyond that a path is one of many, and only its statistics are of use. "
    "Which revolutions the paper draws is not said. {ends} {assumed}"
)
# The points omitted change a path by less than this, in clearances: a tenth of a line's width.
TOLERANCE = 0.002
# The end of each path that is drawn dark, in revolutions.
LAST = 0.05
# Colour, and width of the line in points: the whole path, then its end.
STYLES = {
    "flight": (("#C9D9E8", 0.3), (COLOURS[1], 0.5)),
    "contact": (("#F3CDB0", 0.4), (ACCENT, 0.7)),
}
# Greatest height of the figure, and what texts take of its width and height, in mm.
HIGHEST, TEXTS = 180.0, 22.0
CIRCLE: dict[str, Any] = {"linewidth": 0.6, "linestyle": (0, (4, 2)), "zorder": 3.5}


def path_drawing(bench: Bench, clearance: float, revolutions: int, max_step: float) -> Drawing:
    """Draw the journal's paths at one clearance, for all laws, restitutions and frictions.

    No step is longer than `max_step` in s, so that the curves are smooth.
    """
    drawn = [case for case in CASES if case.clearance == clearance]
    runs = {case: simulated(bench, case, FIRST + revolutions, max_step) for case in drawn}
    paths = {case: path_table(case, run, FIRST) for case, run in runs.items()}
    means = {case: run.statistics(FIRST).mean for case, run in runs.items()}
    headline = {
        f"{case.law}, c_e = {case.restitution:g}, c_f = {case.friction:g}: {text}": mean[column]
        for case, mean in means.items()
        for column, text in NUMBERS.items()
    }
    last = FIRST + revolutions
    caption = CAPTION.format(
        drawn=f"revolutions {FIRST + 1} to {last}" if revolutions > 1 else f"revolution {last}",
        clearance=clearance,
        last=LAST,
    )
    deep = {
        case: runs[case] for case in drawn if means[case]["max_penetration_um"] > 1e3 * clearance
    }
    method = METHOD.format(
        always=sum(mean["contact_fraction"] == 1.0 for mean in means.values()),
        cases=len(drawn),
        whirls=_whirls(deep),
        horizons=horizons(bench, clearance),
        ends=law_ends(list(runs.values())),
        assumed=assumed(mechanism(bench)),
    )
    table = pd.concat(paths.values(), ignore_index=True)
    return Drawing(_draw_panels(paths, 1e3 * clearance), table, headline, caption, method)


def path_table(case: Case, run: Trajectory, first: int) -> pd.DataFrame:
    """Return the path of the journal's centre (−e), without the points that a line needs not."""
    rows = run.revolution >= first
    places = -run.eccentricity[rows] * 1e6
    touching = run.in_contact[rows]
    drawn = _simplified(places, touching, TOLERANCE * run.joint.contact.radial * 1e3)
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


def _whirls(deep: Mapping[Case, Trajectory]) -> str:
    """Return a sentence on the runs whose penetration exceeds the clearance, or nothing."""
    if not deep:
        return ""
    turns = " and ".join(
        f"{_turns(run):.2g} turns with the {LAW_NAMES[str(case.law)]} law at "
        f"c_e = {case.restitution:g} and c_f = {case.friction:g}"
        for case, run in deep.items()
    )
    return (
        "Where the penetration exceeds the clearance, the journal's centre whirls about the "
        f"bearing's and its inertia presses it outwards: {turns} per revolution of the crank, both "
        "senses counted. "
    )


def _turns(run: Trajectory) -> float:
    """Return the turns of the journal's centre about the bearing's per revolution, without sign."""
    rows = run.revolution >= FIRST
    angle = np.unwrap(np.arctan2(*run.eccentricity[rows].T[::-1]))
    return float(np.abs(np.diff(angle)).sum() / (2 * np.pi) / np.ptp(run.revolution[rows]))


def _draw_panels(paths: Mapping[Case, pd.DataFrame], clearance: float) -> Figure:
    """Draw the paths at a clearance in µm: laws by rows, losses by columns."""
    losses: list[tuple[float | None, ...]] = [(ce, cf) for ce in RESTITUTIONS for cf in FRICTIONS]
    places = pd.concat(paths.values())[["x_um", "y_um"]].abs().max()
    reach = 1.03 * np.maximum(places.to_numpy(), clearance)
    figure = new_figure("full", HIGHEST)
    shape = len(LAW_NAMES), len(losses)
    _fit_height(figure, shape, reach)
    panels: Any = figure.add_gridspec(*shape).subplots(sharex=True, sharey=True)
    for case, path in paths.items():
        row, column = (
            list(LAW_NAMES).index(str(case.law)),
            losses.index((case.restitution, case.friction)),
        )
        axes = panels[row, column]
        _draw_path(axes, path)
        draw_clearance_circle(axes, clearance, **CIRCLE)
        axes.set(xlim=(-reach[0], reach[0]), ylim=(-reach[1], reach[1]), aspect="equal")
        axes.set(xticks=[], yticks=[])
        axes.spines[:].set_visible(False)
    between, dash = ("\n", "–\n") if figure.style.narrow else (", ", "–")
    for axes, (ce, cf) in zip(panels[0], losses, strict=True):
        axes.set_title(f"$c_e$ = {ce:g}{between}$c_f$ = {cf:g}", loc="center")
    for axes, name in zip(panels[:, 0], LAW_NAMES.values(), strict=True):
        axes.set_ylabel(name.replace("–", dash))
    _draw_scale(panels[-1, 0], 0.5 * clearance, reach)
    _add_key(figure)
    return figure


def _fit_height(figure: StyledFigure, shape: tuple[int, int], reach: FloatArray) -> None:
    """Set a figure's height so that panels to scale fill its width, unless that is too high."""
    width, highest = figure.get_size_inches() * MM_PER_INCH
    texts = TEXTS * highest / HIGHEST
    wanted = texts + (width - texts) / shape[1] * reach[1] / reach[0] * shape[0]
    if not figure.style.narrow:
        wanted = min(wanted, highest)
    figure.set_size_inches(width / MM_PER_INCH, wanted / MM_PER_INCH)


def _draw_path(axes: Axes, path: pd.DataFrame) -> None:
    """Draw the whole path pale, its end dark over it, and contacts over flights."""
    x, y, at = (path[name].to_numpy() for name in ("x_um", "y_um", "revolution"))
    last = at >= at[-1] - LAST
    for order, (mode, styles) in enumerate(STYLES.items()):
        for dark, (colour, width) in enumerate(styles):
            drawn = (path["mode"] == mode).to_numpy() & (last | (not dark))
            axes.plot(
                np.where(drawn, x, np.nan), np.where(drawn, y, np.nan), "-", marker="",
                color=colour, linewidth=width * current_style().lines, zorder=2 + order + 2 * dark,
            )  # fmt: skip


def _draw_scale(axes: Axes, length: float, reach: FloatArray) -> None:
    """Draw a scale bar in µm in a corner that no path reaches."""
    x, y = -reach
    axes.plot([x, x + length], [y, y], "-", marker="|", color="black", clip_on=False)
    axes.annotate(
        f"{length:g} µm", xy=(x, y), xytext=(0, -3), textcoords="offset points", va="top",
        fontsize=small_text(),
    )  # fmt: skip


def _add_key(figure: Figure) -> None:
    """Explain the lines below the panels."""
    handles = [
        Line2D([], [], color=styles[1][0], linewidth=2 * styles[1][1], label=mode)
        for mode, styles in STYLES.items()
    ]
    circle = {name: value for name, value in CIRCLE.items() if name != "zorder"}
    handles += [Line2D([], [], color="black", label="clearance circle, radius c", **circle)]
    figure.legend(handles=handles, loc="outside lower center", ncols=3)


FIGURES: dict[str, Callable[[Bench], Drawing]] = {
    "fig18": partial(path_drawing, clearance=0.5, revolutions=3, max_step=DRAWN_STEP),
    "fig19": partial(path_drawing, clearance=0.02, revolutions=1, max_step=0.5 * DRAWN_STEP),
}
