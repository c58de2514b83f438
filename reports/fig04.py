"""Fig 4: the finite-element mesh at a clearance of 0.1 mm, whole and magnified."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from cylcontact.arrays import FloatArray
from cylcontact.datasets.finite_element.mesh import Body, Mesh
from cylcontact.plots.figure import Drawing, new_figure, panel_title
from cylcontact.plots.style import COLOURS
from cylcontact.reports.bench import Bench

from .finite_elements import choices, study

CLEARANCE = 0.1  # mm, of the paper's Fig 4
WINDOWS = (0.8, 0.08)  # widths of the magnified parts in mm
CAPTION = (
    "The mesh of four-node quads at ΔR = 0.1 mm: half of a pin (blue) in half of a plate with a "
    "hole (black), symmetric about x = 0; lengths in mm. (a) Whole. (b, c) The top of the hole, "
    "where the contact is. The smallest cells are {smallest:.2f} µm long, {cells} to the "
    "half-width of the contact at 20 N/mm; the paper gives 1.31 to 6.63 µm. {choices}"
)
BODIES = {"plate": COLOURS[0], "pin": COLOURS[1]}


def draw(bench: Bench) -> Drawing:
    recommended = study(bench, "recommended")
    setup = recommended.setups["base"]
    mesh = setup.mesh(CLEARANCE, recommended.loads)
    table = _table(mesh)
    smallest = 1e3 * table["shortest_in_contact_mm"].max()
    headline = {
        "cells": float(table["cells"].sum()),
        "pairs of nodes that may touch": float(mesh.pairs.count),
        "length of the cells in the contact, µm": smallest,
    }
    caption = CAPTION.format(smallest=smallest, cells=setup.cells, choices=choices(bench))
    return Drawing(_draw_panels(mesh, setup.hole_radius), table, headline, caption)


def _table(mesh: Mesh) -> pd.DataFrame:
    """Return the counts and sizes of the cells, one row for each body."""
    parts = []
    for name in BODIES:
        body = getattr(mesh, name)
        sides = _sides(body)
        parts.append(
            {
                "body": name,
                "cells": len(body.quads),
                "nodes": len(body.points),
                "shortest_side_mm": float(sides.min()),
                "shortest_in_contact_mm": _first_cell(body),
                "longest_side_mm": float(sides.max()),
            }
        )
    return pd.DataFrame(parts)


def _sides(body: Body) -> FloatArray:
    """Return the lengths of all cells' sides in mm."""
    corners = body.points[body.quads]
    steps = np.roll(corners, -1, axis=1) - corners
    return np.asarray(np.hypot(steps[..., 0], steps[..., 1]))


def _first_cell(body: Body) -> float:
    """Return the length in mm of the surface's first cell, on the axis."""
    start, end = body.points[body.surface[:2]]
    return float(np.hypot(*(end - start)))


def _draw_panels(mesh: Mesh, hole_radius: float) -> Figure:
    """Draw a mesh whole, and magnified in two windows at the top of the hole."""
    figure = new_figure("full", 84.0)
    panels = figure.subplots(1, 3, width_ratios=(0.62, 1, 1))
    extent = float(mesh.plate.points[:, 1].max())
    titles = ("whole", f"{WINDOWS[0]:g} mm wide", f"{1e3 * WINDOWS[1]:g} µm wide")
    widths = (np.inf, *WINDOWS)
    for number, (axes, width) in enumerate(zip(panels, widths, strict=True)):
        for name, colour in BODIES.items():
            _draw_body(axes, getattr(mesh, name), colour, 0.25 if number else 0.1)
        axes.set_aspect("equal")
        axes.set_xlabel("x (mm)")
        panel_title(axes, number, titles[number])
        if number == 0:
            axes.set(xlim=(-0.15, extent + 0.15), ylim=(-extent - 0.15, extent + 0.15))
            axes.set_ylabel("y (mm)")
        else:
            axes.set(xlim=(0, width), ylim=(hole_radius - width / 2, hole_radius + width / 2))
    return figure


def _draw_body(axes: Axes, body: Body, colour: str, linewidth: float) -> None:
    """Draw a body's cells."""
    outlines = list(body.points[body.quads])
    axes.add_collection(
        PolyCollection(outlines, facecolor="none", edgecolor=colour, linewidth=linewidth)
    )
