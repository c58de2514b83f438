"""The pictures of a run: slider, crank, contact force, path of the journal, Poincaré map."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from cylcontact.plots.figure import StyledFigure, new_figure, panel_title
from cylcontact.plots.style import figure_style
from cylcontact.support.arrays import require

# Points of a path in a revolution.
POINTS = 3000
Trajectory = Any  # `trajectory` imports this module


def drawn(run: Trajectory, revolutions: float) -> StyledFigure:
    """Draw a run; see `Trajectory.plot`."""
    rule, remedy = "must be positive", "give e.g. 2"
    require(revolutions > 0, "plot", "revolutions", revolutions, rule, remedy)
    rows = run.revolution >= run.revolution[-1] - revolutions
    turn, motion, ideal = run.revolution[rows], run.motion, run.ideal
    with figure_style():
        figure = new_figure("page", 110.0)
        (of_slider, of_crank, of_force), (path, poincare, blank) = figure.subplots(2, 3)
        pairs = (
            (of_slider, motion.slider_acceleration, ideal.slider_acceleration, 1e-3),
            (of_crank, motion.crank_moment, ideal.crank_moment, 1.0),
        )
        for axes, actual, wanted, factor in pairs:
            axes.plot(turn, factor * actual[rows], marker="", label="with clearance")
            axes.plot(turn, factor * wanted[rows], marker="", label="ideal")
        of_force.plot(turn, 1e-3 * run.normal_force[rows], marker="")
        of_slider.set_ylabel("acceleration (km/s²)")
        of_crank.set_ylabel("moment (N m)")
        of_force.set_ylabel("force (kN)")
        for axes in (of_slider, of_crank, of_force):
            axes.set_xlabel("revolution (-)")
        draw_path(path, run, turn[0], turn[-1])
        path.set(xlabel="$x$ (mm)", ylabel="$y$ (mm)")
        ends = np.searchsorted(run.steps.revolution, np.arange(len(run.steps.counts)), "right") - 1
        poincare.plot(
            motion.slider_velocity[ends], 1e-3 * motion.slider_acceleration[ends], ".", markersize=3
        )
        poincare.set(xlabel="velocity (m/s)", ylabel="acceleration (km/s²)")
        titles = "slider", "crank", "contact force", "path of the journal", "slider, once a turn"
        for number, (axes, title) in enumerate(zip(figure.axes, titles, strict=False)):
            panel_title(axes, number, title)
        blank.axis("off")
        blank.legend(*of_slider.get_legend_handles_labels(), loc="center")
    return figure


def draw_path(axes: Axes, run: Trajectory, first: float, last: float) -> None:
    """Draw the path of the pin's centre in the hole in mm, and the circle of the clearance.

    `first` and `last` are in revolutions.
    """
    radius = run.mechanism.joint.radial
    axes.add_patch(Circle((0.0, 0.0), radius, fill=False, edgecolor="0.4", linewidth=0.6))
    at = np.linspace(first, last, max(2, round(POINTS * (last - first))))
    x, y = -1e3 * run.eccentricity_at(at * run.mechanism.period).T
    axes.plot(x, y, marker="", linewidth=0.4)
    axes.set_aspect("equal", "datalim")
