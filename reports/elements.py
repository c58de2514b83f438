"""Figs 4 to 6: our finite elements, which `cylcontact finite-element` solves, beside the laws."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from cylcontact import limits
from cylcontact.bodies.pair import CylinderPair
from cylcontact.datasets.finite_element import Setup, Solution, read_study, read_table, solve
from cylcontact.laws import LAWS
from cylcontact.laws.conformal import pressure as conformal_pressure
from cylcontact.plots.figure import legend_below, panel_title, panels, plain_log
from cylcontact.support.arrays import FloatArray

from .paper import STEEL

FOLDER = "datasets/finite_element"
BODIES = {"plate": ("C1", "#e6f0f7"), "pin": ("C2", "#f9e6dc")}
LAWS_OF_FIG_6 = {
    "johnson": ("Johnson's law", {"color": "C0", "linestyle": "-"}),
    "enhanced": ("enhanced law", {"color": "C1", "linestyle": "--"}),
}
BEYOND_FIG_6 = {
    "explicit": ("explicit law", {"color": "C3", "linestyle": "--"}),
    "persson": ("Persson's law", {"color": "C0", "linestyle": "-"}),
}
# The set-ups of our finite elements: as the paper says, and as one would have it.
STUDIES = {
    "paper": ("elements as in the paper", {"marker": "s", "color": "C4"}),
    "recommended": ("elements, plane strain", {"marker": "o", "color": "C2"}),
}
FIG_5_LOAD, FIG_5_CLEARANCES = 100.0, (1.0, 0.01)  # N/mm, the largest of Section 3.2; mm
LINES = (0.06, 0.2, 0.4)  # points, of the cells in the panels of Fig 4
TOP = 1.2  # of the colour scale of Fig 5, above the largest value
CURVES = (
    ("hertz_MPa", {"color": "C0", "linestyle": "-"}, "Hertz (Eq 7)"),
    ("conformal_MPa", {"color": "C1", "linestyle": "--"}, "conformal"),
)
FIG_6_LOADS = (20.0, 40.0, 100.0)  # N/mm
FIG_6_WIDE = 0.445  # mm, from where on the paper states 3 %


def setup() -> Setup:
    """Return the set-up that the committed tables were made with."""
    return read_study(f"{FOLDER}/recommended.toml").setups["base"]


def fig04() -> tuple[Figure, pd.DataFrame]:
    """Finite-element mesh of a pin in a hole at ΔR = 0.1 mm, R_i = 2.245 mm: half of the plane
    problem, whole and magnified twice at the contact. Quadrilaterals with four nodes, at the
    contact with sides of 6 to 9 µm, of 16 to the half-width under 20 N/mm. The paper's have sides
    of 1.31 to 6.63 µm; with those (the elements as in the paper of Fig 6) the contact looks alike.
    """
    mesh = setup().mesh(0.1, [20.0, 40.0, 100.0])
    figure, parts = panels(3, 64.0, least_mm=60.0, below_mm=6.0)
    sizes = (2.02 * mesh.plate.points[:, 1].max(), 0.8, 0.08)  # mm
    rows = []
    for number, ((axes,), size) in enumerate(zip(parts, sizes, strict=True)):
        middle = 0.0 if number == 0 else setup().hole_radius
        for name, (line, fill) in BODIES.items():
            body = getattr(mesh, name)
            cells = body.points[body.quads]
            seen = np.abs(cells[:, :, 1] - middle).min(axis=1) < size / 2
            look = {"facecolor": fill, "edgecolor": line, "linewidth": LINES[number]}
            axes.add_collection(PolyCollection(list(cells[seen]), label=name, **look))
            rows.append({"size_mm": size, "body": name, "cells": int(seen.sum())})
        limits_of_y = (middle - size / 2, middle + size / 2)
        axes.set(xlim=(0, size / 2 if number == 0 else size), ylim=limits_of_y, aspect="equal")
        axes.set(xlabel="x (mm)", ylabel="y (mm)")
        panel_title(axes, number, "whole" if number == 0 else f"{size:g} mm at the contact")
    legend_below(parts[0][0], 2)
    return figure, pd.DataFrame(rows)


def fig05() -> tuple[Figure, pd.DataFrame]:
    """Contact stress by finite elements in plane strain under 100 N/mm at (a) ΔR = 1 mm and
    (b) 0.01 mm, against distances in half-widths b of Hertz's contact. Above: the compressive
    stress along the load on both cylinders, relative to Hertz's peak pressure p_0. Below: the
    pressure along the contact, beside Hertz (Eq 7) and conformal contact. The paper does not say
    for which load its Fig 5 is.
    """
    figure, parts = panels(2, 96.0, heights=(1.5, 1), least_mm=80.0, below_mm=8.0)
    tables = []
    for number, (dR, (upper, lower)) in enumerate(zip(FIG_5_CLEARANCES, parts, strict=True)):
        (case,) = solve(setup(), dR, [FIG_5_LOAD])
        b = float(limits.hertz_half_width(FIG_5_LOAD, setup().pair(dR)))
        p_0 = float(limits.hertz_stress(FIG_5_LOAD, setup().pair(dR)))
        cells = stress_field(upper, case, b, p_0)
        near = case.arc <= 2 * b
        table = pressures(case, case.arc[near]).assign(pressure_MPa=case.pressure[near])
        tables.append(table.assign(hertz_half_width_mm=b, hertz_peak_MPa=p_0))
        for side in (-1, 1):
            points = side * table["distance_mm"] / b, table["pressure_MPa"] / p_0
            label = "finite elements" if side == 1 else None
            lower.plot(*points, "o", color="C2", markersize=2.5, label=label)
        places = np.linspace(-2, 2, 801)
        curves = pressures(case, np.abs(places) * b)
        for column, style, name in CURVES:
            lower.plot(places, curves[column] / p_0, marker="", label=name, **style)
        lower.set(xlim=(-2, 2), ylim=(0, TOP), xlabel="x / b, distance / b (-)")
        lower.set_ylabel(r"pressure / $p_0$ (-)")
        title = f"$\\Delta R$ = {dR:g} mm\n$p_0$ = {p_0:.0f} MPa, b = {b:.3g} mm"
        panel_title(upper, number, title)
    bar = figure.colorbar(cells, ax=[upper for upper, _ in parts], pad=0.02, aspect=30)
    bar.set_label(r"$-\sigma_{yy}/p_0$ (-)")
    legend_below(parts[0][1], 3)
    return figure, pd.concat(tables, ignore_index=True)


def stress_field(axes: Axes, case: Solution, b: float, p_0: float) -> PolyCollection:
    """Draw the compressive stress along the load on both sides of the axis, cell by cell."""
    outlines, values = [], []
    for name in BODIES:
        body = getattr(case.mesh, name)
        corners = (body.points[body.quads] - [0.0, case.setup.hole_radius]) / b
        near = (np.abs(corners).min(axis=1) < [2.0, 1.5]).all(axis=1)
        for side in (1.0, -1.0):
            outlines.append(corners[near] * [side, 1.0])
            values.append(-case.stress(name).yy[near] / p_0)  # type: ignore[arg-type]
    cells = PolyCollection(
        list(np.concatenate(outlines)), array=np.concatenate(values), cmap="cividis"
    )
    # The cells' sides are drawn too, or hairlines would appear between cells.
    cells.set(edgecolor="face", linewidth=0.3, rasterized=True, clim=(0.0, TOP))
    axes.add_collection(cells)
    axes.set(xlim=(-2, 2), ylim=(-1.5, 1.5))
    axes.set_ylabel(r"$(y - R_i)$ / b (-)")
    return cells


def pressures(case: Solution, arc: FloatArray) -> pd.DataFrame:
    """Return the pressure of Hertz and of conformal contact in MPa along the surface."""
    pair, radius = case.setup.pair(case.dR), case.setup.hole_radius
    # Conformal contact has one angle for both surfaces, whose radii are nearly equal.
    angle = np.minimum(arc / np.sqrt(radius * (radius - case.dR)), np.pi)
    return pd.DataFrame(
        {
            "dR_mm": case.dR,
            "load_N_per_mm": case.load,
            "distance_mm": arc,
            "hertz_MPa": limits.hertz_pressure(arc, case.load, pair),
            "conformal_MPa": conformal_pressure(angle, case.load, pair),
        }
    )


def fig06() -> tuple[Figure, pd.DataFrame]:
    """Penetration against radial clearance by finite elements (points), Johnson's law and the
    enhanced law (lines) under (a) 20, (b) 40 and (c) 100 N/mm; E = 207 GPa, ν = 0.3,
    R_i = 2.245 mm. Squares: as the paper says, plane stress and the load on the centre nodes.
    Circles: plane strain and the load spread over the pin. Below: the laws less the elements;
    grey: the paper's 10 %, and 3 % from 0.445 mm on. The outer radius of the plate, which the
    paper does not state, is 3.3 R_i, with which the circles agree with Johnson's law at small
    loads: that they agree is by construction.
    """
    return against_elements(LAWS_OF_FIG_6, STUDIES, (-60, 20))


def fig_elements() -> tuple[Figure, pd.DataFrame]:
    """As Fig 6, for laws beyond the paper: penetration by our explicit law and by Persson's law of
    conformal contact against finite elements in plane strain. The outer radius of the plate is
    chosen so that Johnson's law, and with it these two, agree at small loads.
    """
    recommended = {"recommended": STUDIES["recommended"]}
    return against_elements(BEYOND_FIG_6, recommended, (-4, 4))


def against_elements(
    laws: dict[str, tuple[str, dict[str, Any]]],
    studies: dict[str, tuple[str, dict[str, Any]]],
    percent: tuple[float, float],
) -> tuple[Figure, pd.DataFrame]:
    """Draw the penetration by laws and by elements under each load, and below the difference."""
    figure, parts = panels(3, 84.0, heights=(2, 1), below_mm=12.0)
    dR = np.geomspace(0.005, 1.5, 201)
    pair = CylinderPair.from_dR("internal", dR, STEEL)
    for (upper, lower), load in zip(parts, FIG_6_LOADS, strict=True):
        for law, (name, look) in laws.items():
            depth = LAWS[law]().penetration(load, pair)
            upper.plot(dR, 1e3 * depth, marker="", label=name, **look)
        upper.set_ylabel("penetration (µm)")
        lower.axhspan(-10, 10, color="0.93", zorder=0)
        lower.fill_between([FIG_6_WIDE, 2.0], -3, 3, color="0.82", zorder=0.1)
        lower.set(ylabel="difference (%)", ylim=percent)
        plain_log(lower, "x", (0.01, 0.1, 1.0))
        lower.set_xlim(0.004, 2.0)
        panel_title(upper, FIG_6_LOADS.index(load), f"{load:g} N/mm")
    bottom = max(axes.get_subplotspec().rowspan.stop for _, axes in parts)  # type: ignore[union-attr]
    for _, lower in parts:
        if lower.get_subplotspec().rowspan.stop == bottom:  # type: ignore[union-attr]
            lower.set_xlabel(r"$\Delta R$ (mm)")
    tables = []
    for study, (name, mark) in studies.items():
        table = compared(study)
        for (upper, lower), (_, rows) in zip(parts, table.groupby("load_N_per_mm"), strict=True):
            elements = rows["embedded_mm"]
            upper.plot(rows["dR_mm"], 1e3 * elements, linestyle="none", label=name, **mark)
            for law, (_, look) in laws.items():
                off = 100 * (rows[f"{law}_mm"] / elements - 1)
                lower.plot(rows["dR_mm"], off, markersize=2.5, **{**look, "marker": mark["marker"]})
        if study == "recommended":
            calculix = read_table(f"{FOLDER}/recommended-calculix.csv").rows["penetration_mm"]
            table = table.assign(calculix_mm=calculix.to_numpy())
        tables.append(table.assign(set_up=study))
    for upper, _ in parts:
        upper.set_ylim(0, None)
    legend_below(parts[0][0], 4)
    return figure, pd.concat(tables, ignore_index=True)


def compared(study: str) -> pd.DataFrame:
    """Return the penetrations by finite elements and by laws, at the rows of a committed table."""
    rows = read_table(f"{FOLDER}/{study}-embedded.csv").rows
    pair = CylinderPair.from_dR("internal", rows["dR_mm"].to_numpy(), STEEL)
    load = rows["load_N_per_mm"].to_numpy()
    names = (*LAWS_OF_FIG_6, *BEYOND_FIG_6)
    columns = {f"{name}_mm": LAWS[name]().penetration(load, pair) for name in names}
    kept = rows[["dR_mm", "load_N_per_mm"]].assign(embedded_mm=rows["penetration_mm"])
    return kept.assign(**columns, E_GPa=rows["E_GPa"], nu=rows["nu"])


FIGURES = {"fig04": fig04, "fig05": fig05, "fig06": fig06, "fig_elements": fig_elements}
