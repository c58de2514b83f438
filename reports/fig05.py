"""Fig 5: contact stress at clearances of 1 mm and 0.01 mm, beside Hertz."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from cylcontact import limits
from cylcontact.arrays import FloatArray
from cylcontact.datasets.finite_element import Solution, solve
from cylcontact.laws.conformal import pressure as persson_pressure
from cylcontact.plots.figure import Drawing, new_figure, panel_title
from cylcontact.plots.style import COLOURS
from cylcontact.reports.bench import Bench

from .finite_elements import (
    STRESS_LOAD,
    STRESS_LOAD_CHOICE,
    choices,
    study,
)
from .paper import FIG5_CLEARANCES

CAPTION = (
    "Contact stress by finite elements at ΔR = 1 mm and 0.01 mm, f = 20 N/mm; {load_choice}. "
    "(a, b) Stress along the load in MPa, compression positive, "
    "one value per cell; x, y in mm. (c, d) Pressure (MPa) at the pairs of nodes, beside Hertz's "
    "ellipse and Persson's conformal solution. {choices}"
)
# How far the panels reach, in half-widths of Hertz's contact.
REACH, DEPTH = 2.0, 1.6


def draw(bench: Bench) -> Drawing:
    setup = study(bench, "recommended").setups["base"]
    solutions = [solve(setup, dR, [STRESS_LOAD])[0] for dR in FIG5_CLEARANCES]
    table = _table(solutions)
    headline = {}
    for dR in FIG5_CLEARANCES:
        for theory in ("hertz", "persson"):
            key = f"{dR:g} mm: largest departure from {theory.capitalize()}, % of its peak"
            headline[key] = _largest_departure(table, dR, theory)
    caption = CAPTION.format(load_choice=STRESS_LOAD_CHOICE, choices=choices(bench))
    return Drawing(_draw_panels(solutions), table, headline, caption)


def _table(solutions: Sequence[Solution]) -> pd.DataFrame:
    """Return the pressure of finite elements, Hertz and Persson at the pairs that may touch."""
    parts = []
    for solution in solutions:
        near = solution.arc <= REACH * _hertz_width(solution)
        arc = solution.arc[near]
        hertz, persson = _theories(solution, arc)
        parts.append(
            pd.DataFrame(
                {
                    "dR_mm": solution.dR,
                    "load_N_per_mm": solution.load,
                    "distance_mm": arc,
                    "pressure_MPa": solution.pressure[near],
                    "hertz_MPa": hertz,
                    "persson_MPa": persson,
                }
            )
        )
    return pd.concat(parts, ignore_index=True)


def _hertz_width(solution: Solution) -> float:
    """Return the half-width of Hertz's contact in mm."""
    return float(limits.hertz_half_width(solution.load, solution.setup.pair(solution.dR)))


def _theories(solution: Solution, arc: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return Hertz's and Persson's pressure in MPa at distances along the hole's surface."""
    pair, radius = solution.setup.pair(solution.dR), solution.setup.hole_radius
    hertz = limits.hertz_pressure(arc, solution.load, pair)
    # Persson's angle is the same for both bodies, whose radii he takes as nearly equal.
    mean = np.sqrt(radius * (radius - solution.dR))
    angle = np.minimum(arc / mean, np.pi)
    return hertz, persson_pressure(angle, solution.load, pair)


def _largest_departure(table: pd.DataFrame, dR: float, theory: str) -> float:
    """Return the largest |pressure − theory| at one clearance, in percent of the theory's peak."""
    rows = table[table["dR_mm"] == dR]
    departure = (rows["pressure_MPa"] - rows[f"{theory}_MPa"]).abs().max()
    return float(100 * departure / rows[f"{theory}_MPa"].max())


def _draw_panels(solutions: Sequence[Solution]) -> Figure:
    """Draw stress maps above pressure profiles, a column for each solution."""
    figure = new_figure("full", 116.0)
    panels = figure.subplots(2, len(solutions), by_rows=True)
    for column, solution in enumerate(solutions):
        _draw_stress(figure, panels[0, column], solution)
        panel_title(
            panels[0, column],
            column,
            rf"$\Delta R$ = {solution.dR:g} mm, {solution.load:g} N/mm",
        )
        _draw_pressure(panels[1, column], solution)
        panel_title(
            panels[1, column],
            len(solutions) + column,
            rf"pressure on the surface, $\Delta R$ = {solution.dR:g} mm",
        )
    handles, labels = panels[1, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


def _draw_stress(figure: Figure, axes: Axes, solution: Solution) -> None:
    """Draw the stress along the load, as compression, on both sides of the axis."""
    width = _hertz_width(solution)
    reach, depth = REACH * width, DEPTH * width
    top = solution.setup.hole_radius
    outlines, values = [], []
    for body, stress in (
        (solution.mesh.plate, solution.stress("plate")),
        (solution.mesh.pin, solution.stress("pin")),
    ):
        corners = body.points[body.quads]
        compression = -stress.yy
        middle = corners.mean(axis=1)
        visible = (middle[:, 0] < 1.1 * reach) & (np.abs(middle[:, 1] - top) < 1.2 * depth)
        for side in (1.0, -1.0):
            outlines.append(corners[visible] * [side, 1.0])
            values.append(compression[visible])
    cells = PolyCollection(
        list(np.concatenate(outlines)), array=np.concatenate(values), cmap="cividis"
    )
    # Cells overlap a little; otherwise hairlines would appear between them.
    cells.set(edgecolor="face", linewidth=0.3, rasterized=True, clim=(0.0, solution.peak_pressure))
    axes.add_collection(cells)
    axes.set(xlim=(-reach, reach), ylim=(top - depth, top + depth))
    axes.set_aspect("equal")
    axes.set(xlabel="x (mm)", ylabel="y (mm)")
    figure.colorbar(cells, ax=axes, label=r"$-\sigma_{yy}$ (MPa)")


def _draw_pressure(axes: Axes, solution: Solution) -> None:
    """Draw the pressure on the surface beside Hertz's and Persson's."""
    reach = REACH * _hertz_width(solution)
    arc = np.linspace(-reach, reach, 401)
    hertz, persson = _theories(solution, np.abs(arc))
    axes.plot(arc, hertz, "-", color=COLOURS[0], marker="", label="Hertz (Eq 7)")
    axes.plot(arc, persson, "--", color=COLOURS[1], marker="", label="Persson")
    both = np.concatenate([-solution.arc[:0:-1], solution.arc])
    pressure = np.concatenate([solution.pressure[:0:-1], solution.pressure])
    axes.plot(
        both,
        pressure,
        color=COLOURS[2],
        linestyle="none",
        marker="o",
        markersize=2.5,
        label="finite elements",
    )
    axes.set(xlim=(-reach, reach), ylim=(0, 1.15 * solution.peak_pressure))
    axes.set(xlabel="distance along the surface (mm)", ylabel="pressure (MPa)")
