"""Fig 4: the finite-element mesh at a clearance of 0.1 mm, whole and magnified."""

from cylcontact.plots.figure import Drawing
from cylcontact.reports.bench import Bench
from cylcontact.reports.finite_element.data import choices, study
from cylcontact.reports.finite_element.mesh import mesh_panels, mesh_table

CLEARANCE = 0.1  # mm, of the paper's Fig 4
CAPTION = (
    "The mesh of four-node quads at ΔR = 0.1 mm: half of a pin (blue) in half of a plate with a "
    "hole (black), symmetric about x = 0; lengths in mm. (a) Whole. (b, c) The top of the hole, "
    "where the contact is. The smallest cells are {smallest:.2f} µm long, {cells} to the "
    "half-width of the contact at 20 N/mm; the paper gives 1.31 to 6.63 µm. {choices}"
)


def draw(bench: Bench) -> Drawing:
    planned = study(bench, "recommended")
    setup = planned.setups["base"]
    mesh = setup.mesh(CLEARANCE, planned.loads)
    table = mesh_table(mesh)
    smallest = 1e3 * table["shortest_in_contact_mm"].max()
    headline = {
        "cells": float(table["cells"].sum()),
        "pairs of nodes that may touch": float(mesh.pairs.count),
        "length of the cells in the contact, µm": smallest,
    }
    caption = CAPTION.format(smallest=smallest, cells=setup.cells, choices=choices(bench))
    return Drawing(mesh_panels(mesh, setup.hole_radius, (0.8, 0.08)), table, headline, caption)
