"""Fig 5: contact stress at clearances of 1 mm and 0.01 mm, beside Hertz."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from cylcontact import limits
from cylcontact.datasets.finite_element import Solution, solve
from cylcontact.laws.conformal import pressure as persson_pressure
from cylcontact.plots.figure import Drawing, legend_below, new_figure, panel_title
from cylcontact.plots.style import COLOURS
from cylcontact.reports.bench import Bench
from cylcontact.support.arrays import FloatArray

from .finite_elements import (
    choices,
    study,
)
from .paper import FIG5_CLEARANCES

LOAD = 500.0  # N/mm, at which the contact of the smaller clearance is conformal
CAPTION = (
    f"Contact stress by finite elements at ΔR = 1 mm and 0.01 mm and a load of {LOAD:g} N/mm, "
    "relative to Hertz's peak pressure p₀, against distances relative to Hertz's half-width b. "
    "(a, b) Stress along the load, compression positive, around the contact at y = R_i. (c, d) "
    "Pressure on the surface, beside Hertz's ellipse and Persson's conformal solution."
)
METHOD = (
    "Hertz's contact has {sizes}. In (a, b) each cell has one value, drawn in its place before "
    "loading; in (c, d) the points are pairs of nodes. The table has lengths in mm and pressures "
    "in MPa. The paper names no load; with ours the wider contact is "
    "Hertz's and the closer one is not. {choices}"
)
# How far the panels reach, in half-widths of Hertz's contact.
REACH, DEPTH = 2.0, 1.0
MAXIMA = 1.35  # of the vertical axis of the pressure


def draw(bench: Bench) -> Drawing:
    setup = study(bench, "recommended").setups["base"]
    solutions = [solve(setup, dR, [LOAD])[0] for dR in FIG5_CLEARANCES]
    table = _table(solutions)
    headline = {}
    for dR in FIG5_CLEARANCES:
        for theory in ("hertz", "persson"):
            key = f"{dR:g} mm: largest departure from {theory.capitalize()}, % of its peak"
            rows = table[table["dR_mm"] == dR]
            departure = (rows["pressure_MPa"] - rows[f"{theory}_MPa"]).abs().max()
            headline[key] = float(100 * departure / rows[f"{theory}_MPa"].max())
    sizes = ", and ".join(
        f"b = {_hertz_width(case):.3g} mm and p₀ = {_hertz_peak(case):.3g} MPa "
        f"at ΔR = {case.dR:g} mm"
        for case in solutions
    )
    words = {"sizes": sizes, "choices": choices(bench)}
    return Drawing(_draw_panels(solutions), table, headline, CAPTION, METHOD.format(**words))


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
                    "hertz_half_width_mm": _hertz_width(solution),
                    "hertz_peak_MPa": _hertz_peak(solution),
                }
            )
        )
    return pd.concat(parts, ignore_index=True)


def _hertz_width(solution: Solution) -> float:
    """Return the half-width of Hertz's contact in mm."""
    return float(limits.hertz_half_width(solution.load, solution.setup.pair(solution.dR)))


def _hertz_peak(solution: Solution) -> float:
    """Return the peak pressure of Hertz's contact in MPa."""
    return float(limits.hertz_stress(solution.load, solution.setup.pair(solution.dR)))


def _theories(solution: Solution, arc: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return Hertz's and Persson's pressure in MPa at distances along the hole's surface."""
    pair, radius = solution.setup.pair(solution.dR), solution.setup.hole_radius
    hertz = limits.hertz_pressure(arc, solution.load, pair)
    # Persson's angle is the same for both bodies, whose radii he takes as nearly equal.
    mean = np.sqrt(radius * (radius - solution.dR))
    angle = np.minimum(arc / mean, np.pi)
    return hertz, persson_pressure(angle, solution.load, pair)


def _draw_panels(solutions: Sequence[Solution]) -> Figure:
    """Draw stress maps above pressure profiles, a column for each solution."""
    figure = new_figure("full", 112.0)
    panels = figure.subplots(2, len(solutions), sharey="row")
    for column, solution in enumerate(solutions):
        cells = _draw_stress(panels[0, column], solution)
        _draw_pressure(panels[1, column], solution)
        for axes in panels[:, column]:
            axes.xaxis.set_major_locator(MultipleLocator(1))
        for row, what in enumerate(("stress", "pressure")):
            title = rf"{what}, $\Delta R$ = {solution.dR:g} mm"
            panel_title(panels[row, column], row * len(solutions) + column, title)
    panels[0, 0].set_ylabel("$(y - R_i)/b$ (-)")
    panels[1, 0].set_ylabel("pressure $p/p_0$ (-)")
    figure.colorbar(
        cells, ax=list(panels[0]), pad=0.02, extend="max", label=r"$-\sigma_{yy}/p_0$ (-)"
    )
    legend_below(panels[1, 0], 3)
    return figure


def _draw_stress(axes: Axes, solution: Solution) -> PolyCollection:
    """Draw the stress along the load, as compression, on both sides of the axis."""
    width, middle = _hertz_width(solution), [0.0, solution.setup.hole_radius]
    outlines, values = [], []
    for body, stress in (
        (solution.mesh.plate, solution.stress("plate")),
        (solution.mesh.pin, solution.stress("pin")),
    ):
        corners = (body.points[body.quads] - middle) / width
        visible = (np.abs(corners).min(axis=1) < [REACH, DEPTH]).all(axis=1)
        for side in (1.0, -1.0):
            outlines.append(corners[visible] * [side, 1.0])
            values.append(-stress.yy[visible] / _hertz_peak(solution))
    cells = PolyCollection(
        list(np.concatenate(outlines)), array=np.concatenate(values), cmap="cividis"
    )
    # Cells overlap a little; otherwise hairlines would appear between them.
    cells.set(edgecolor="face", linewidth=0.3, rasterized=True, clim=(0.0, 1.0))
    axes.add_collection(cells)
    axes.set(xlim=(-REACH, REACH), ylim=(-DEPTH, DEPTH), aspect="equal", xlabel="$x/b$ (-)")
    return cells


def _draw_pressure(axes: Axes, solution: Solution) -> None:
    """Draw the pressure on the surface beside Hertz's and Persson's."""
    width, peak = _hertz_width(solution), _hertz_peak(solution)
    places = np.linspace(-REACH, REACH, 401)
    hertz, persson = _theories(solution, np.abs(places) * width)
    axes.plot(places, hertz / peak, "-", color=COLOURS[0], marker="", label="Hertz (Eq 7)")
    axes.plot(places, persson / peak, "--", color=COLOURS[1], marker="", label="Persson")
    near = solution.arc <= REACH * width
    arc, pressure = solution.arc[near] / width, solution.pressure[near] / peak
    points: dict[str, Any] = {
        "color": COLOURS[2],
        "linestyle": "none",
        "marker": "o",
        "markersize": 2.5,
    }
    arcs, pressures = np.append(-arc[:0:-1], arc), np.append(pressure[:0:-1], pressure)
    axes.plot(arcs, pressures, **points, label="finite elements")
    axes.set(
        xlim=(-REACH, REACH), ylim=(-0.05, MAXIMA), xlabel="distance along the surface / $b$ (-)"
    )
