"""The force of a pin that tilts: slices of the plane law, the rim's stiffness, finite elements.

`tilted_pin` made the table.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from cylcontact.joint.spatial import EDGES
from cylcontact.plots.figure import Drawing, new_figure, panel_title
from cylcontact.plots.style import COLOURS
from cylcontact.reports.bench import Bench

from .tilted_pin import FILE, FINER, FIRST, MATERIALS, constants, with_rim

DRAWN = 0.1
ENDS = {"flush": "pin as long as its hole", "overhang": "pin that goes on"}
CAPTION = (
    "Force of a pin that tilts, its rim {drawn}·ΔR deep in the hole, over E*·ΔR·R, against the "
    "tilt (ΔR/R), for three lengths of the hole. Crosses: finite elements in three dimensions; "
    "dotted: slices of the plane law; lines: with the rim's stiffness. "
    "(a) Pin and hole end together. (b) The pin goes on by R/2."
)
METHOD = (
    "Harmonics in the angle and quadratic elements in (r, z), ν = 0.3, a bush of four times the "
    "radius of its hole, clamped outside, and a pin under body forces uniform and linear along "
    "the axis; frictionless cells of pressure. The smallest elements are {first}·R; with half of "
    "that and twice the cells in the angle forces change by at most {change:.1f} %. The numbers "
    "are those of datasets/tilted_pin.csv, which `make tilt` computes. Slices have the plane law "
    "of the same elements, lines the rim's stiffness of the spatial joint. The last points of a "
    "length touch both rims."
)
COLUMNS = (
    *("first_element", "length", "ends", "materials", "depth", "share"),
    *("force", "moment", "lamina_force", "lamina_moment"),
)


def draw(bench: Bench) -> Drawing:
    table = bench.table(FILE, COLUMNS, "make tilt writes it")
    coarse = table[table["first_element"] == FIRST]
    headline: dict[str, float] = {}
    for ends in ENDS:
        for name in MATERIALS:
            chosen = coarse[(coarse["ends"] == ends) & (coarse["materials"] == name)]
            c, b = constants(chosen)
            words = f"{ends}, {name}"
            headline |= {f"{words}: c": c, f"{words}: b": b}
            tilted = chosen[np.isfinite(chosen["share"])]
            for what, pair in (("own c and b", (c, b)), ("the joint's", EDGES[ends])):
                errors = 100 * (with_rim(tilted, *pair)[0] / tilted["force"] - 1)
                headline[f"{words}, {what}: lowest error, %"] = float(errors.min())
                headline[f"{words}, {what}: highest error, %"] = float(errors.max())
    change = mesh_change(table)
    headline["mesh: largest change, %"] = change
    shown = coarse[(coarse["materials"] == "alike") & np.isfinite(coarse["share"])]
    shown = pd.concat([_with_edge(shown[shown["ends"] == ends], ends) for ends in ENDS])
    shown = shown.drop(columns="first_element")
    shown["tilt"] = shown["depth"] / (shown["share"] * shown["length"])
    caption, method = CAPTION.format(drawn=DRAWN), METHOD.format(first=FIRST, change=change)
    return Drawing(_draw(shown[shown["depth"] == DRAWN]), shown, headline, caption, method)


def mesh_change(table: pd.DataFrame) -> float:
    """Return by how much forces change at most, in percent, on the finer mesh."""
    place = ["length", "ends", "materials", "depth", "share"]
    fine = table[table["first_element"] == FINER[0]].set_index(place)["force"]
    coarse = table[table["first_element"] == FIRST].set_index(place)["force"]
    return float(100 * (fine / coarse[fine.index] - 1).abs().max())


def _with_edge(table: pd.DataFrame, ends: str) -> pd.DataFrame:
    """Add the force with the rim's stiffness that the joint has."""
    return table.assign(rim_force=with_rim(table, *EDGES[ends])[0])


def _draw(table: pd.DataFrame) -> Figure:
    """Draw the force over the tilt, a panel for both kinds of ends."""
    figure = new_figure("full", 78.0)
    panels = figure.subplots(1, 2, sharey=True)
    for number, (axes, (ends, words)) in enumerate(zip(panels, ENDS.items(), strict=True)):
        for colour, (length, rows) in zip(
            COLOURS, table[table["ends"] == ends].groupby("length"), strict=False
        ):
            look = {"color": colour, "marker": ""}
            axes.plot(rows["tilt"], rows["rim_force"], "-", label=f"{length:g}", **look)
            axes.plot(rows["tilt"], rows["lamina_force"], ":", **look)
            look = {"color": colour, "marker": "x", "linestyle": ""}
            axes.plot(rows["tilt"], rows["force"], **look)
        axes.set(xscale="log", yscale="log")
        axes.set_xlabel(r"tilt $\psi R/\Delta R$ (-)")
        panel_title(axes, number, words)
    panels[0].set_ylabel(r"force / ($E^*\,\Delta R\,R$) (-)")
    panels[0].legend(title="$L/R$", loc="lower left")
    return figure
