"""Fig 4: the finite-element mesh at a clearance of 0.1 mm, whole and magnified."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MultipleLocator

from cylcontact.datasets.finite_element.mesh import Body, Mesh
from cylcontact.plots.figure import Drawing, legend_below, new_figure, panel_title
from cylcontact.plots.style import ACCENT, COLOURS
from cylcontact.reports.bench import Bench

from .finite_elements import choices, study

CLEARANCE = 0.1  # mm, of the paper's Fig 4
WINDOWS = (0.8, 0.08)  # widths of the magnified parts in mm
STEPS = (2.0, 0.2, 0.02)  # between the ticks of the panels in mm
CAPTION = (
    "Finite element mesh at ΔR = 0.1 mm: half of a pin, pressed upwards, in half of a plate, "
    "symmetric about the line of the load, x = 0; lengths in mm. (a) Whole mesh. (b, c) The "
    "top of the hole, where the contact is; the frames mark these views."
)
METHOD = (
    "The cells are quadrilaterals with four nodes. Those in the contact are {smallest:.2f} µm "
    "wide, {cells} to the half-width of the contact at 20 N/mm; the paper gives 1.31 to 6.63 µm. "
    "{choices}"
)
# The colours of the cells' fill and of their sides.
BODIES = {"plate": ("0.85", COLOURS[0]), "pin": ("#cfe4f2", COLOURS[1])}


def draw(bench: Bench) -> Drawing:
    recommended = study(bench, "recommended")
    setup = recommended.setups["base"]
    mesh = setup.mesh(CLEARANCE, recommended.load)
    table = _table(mesh)
    smallest = 1e3 * table["shortest_in_contact_mm"].max()
    headline = {
        "cells": float(table["cells"].sum()),
        "pairs of nodes that may touch": float(mesh.pairs.count),
        "length of the cells in the contact, µm": smallest,
    }
    method = METHOD.format(smallest=smallest, cells=setup.cells, choices=choices(bench))
    figure = _draw_panels(mesh, setup.hole_radius)
    return Drawing(figure, table, headline, CAPTION, method)


def _table(mesh: Mesh) -> pd.DataFrame:
    """Return the counts and sizes of the cells, one row for each body."""
    parts = []
    for name in BODIES:
        body = getattr(mesh, name)
        corners = body.points[body.quads]
        steps = np.roll(corners, -1, axis=1) - corners
        sides = np.asarray(np.hypot(steps[..., 0], steps[..., 1]))
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


def _first_cell(body: Body) -> float:
    """Return the length in mm of the surface's first cell, on the axis."""
    start, end = body.points[body.surface[:2]]
    return float(np.hypot(*(end - start)))


def _draw_panels(mesh: Mesh, hole_radius: float) -> Figure:
    """Draw a mesh whole, and magnified in two windows at the top of the hole."""
    figure = new_figure("full", 84.0)
    # The whole is twice as high as wide, the windows are square, and all are equally high.
    panels = figure.subplots(1, 3, width_ratios=(0.5, 1, 1))
    extent = 1.02 * float(mesh.plate.points[:, 1].max())
    views = [(0.0, extent, -extent, extent)]
    views += [(0.0, side, hole_radius - side / 2, hole_radius + side / 2) for side in WINDOWS]
    titles = ("whole", f"{WINDOWS[0]:g} mm wide", f"{WINDOWS[1]:g} mm wide")
    for number, (axes, view, step) in enumerate(zip(panels, views, STEPS, strict=True)):
        for name, colours in BODIES.items():
            _draw_body(axes, getattr(mesh, name), name, colours, view)
        axes.set(xlim=view[:2], ylim=view[2:], aspect="equal", xlabel="$x$ (mm)", ylabel="$y$ (mm)")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(MultipleLocator(step))
        panel_title(axes, number, titles[number])
    for axes, (left, right, bottom, top) in zip(panels, views[1:], strict=False):
        corner, size = (left, bottom), (right - left, top - bottom)
        axes.add_patch(Rectangle(corner, *size, fill=False, edgecolor=ACCENT, linewidth=1.2))
    legend_below(panels[0], 2)
    return figure


def _draw_body(
    axes: Axes, body: Body, name: str, colours: tuple[str, str], view: tuple[float, ...]
) -> None:
    """Draw a body's cells that are in view."""
    left, right, bottom, top = view
    corners = body.points[body.quads]
    (x0, y0), (x1, y1) = corners.min(axis=1).T, corners.max(axis=1).T
    seen = corners[(x1 > left) & (x0 < right) & (y1 > bottom) & (y0 < top)]
    fill, line = colours
    sides = min(0.25, 15 / len(seen) ** 0.5)  # points, so that small cells stay apart
    look = {"facecolor": fill, "edgecolor": line, "linewidth": sides, "label": name}
    axes.add_collection(PolyCollection(list(seen), **look))
