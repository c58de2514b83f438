"""Figs 17 to 19: the joint of the slider-crank, whose masses and lengths are ours."""

from __future__ import annotations

from functools import partial
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from cylcontact.laws import LAWS
from cylcontact.mechanism import Trajectory, read_mechanism, simulate
from cylcontact.plots.figure import legend_below, new_figure, panel_title, panels
from cylcontact.plots.style import width_mm

SPEC = "datasets/slider_crank.toml"
DRAWN = {"lankarani-nikravesh": "Lankarani-Nikravesh", "johnson": "Johnson"}
DRAWN |= {"enhanced": "enhanced", "explicit": "explicit"}
LOSSES = list(product((1.0, 0.9), (0.0, 0.1)))  # restitution, friction
# The revolution that is drawn: the eleventh, by when the runs that settle have settled.
FIRST, LAST = 10, 11
# Points of a path, of which an impact has about twenty.
POINTS = 3000
# How paths are drawn.
LINE = {"marker": "", "linestyle": "-", "linewidth": 0.4, "color": "C0"}


def run(law: str, revolutions: int, max_step: float, **case: Any) -> Trajectory:
    """Simulate a case; beyond its end a law goes on along its tangent. The longest step is in s."""
    mechanism = read_mechanism(SPEC, law=law, max_step=max_step, **case)
    return simulate(mechanism, revolutions, beyond="tangent")


def fig17() -> tuple[Figure, pd.DataFrame]:
    """Contact force against penetration over the first impact of the slider-crank, at two radial
    clearances; restitution 0.9, no friction. Thick: above on approach, below on return. Thin: the
    law without dissipation. The paper does not say which impact it draws: this one is the hardest
    of the start, and the same for all laws.
    """
    figure, parts = panels(2, 70.0, below_mm=6.0)
    tables = []
    for number, (axes,) in enumerate(parts):
        clearance = (0.5, 0.02)[number]
        for colour, (law, name) in enumerate(DRAWN.items()):
            table = first_impact(law, clearance)
            tables.append(table)
            depth, force = table["penetration_um"], 1e-3 * table["force_N"]
            axes.plot(depth, force, color=f"C{colour}", marker="", label=name)
            elastic = {"linestyle": "-", "color": f"C{colour}", "marker": "", "linewidth": 0.5}
            axes.plot(depth, 1e-3 * table["elastic_force_N"], **elastic)
        axes.set(xlabel="penetration (µm)", ylabel="contact force (kN)")
        axes.set(xlim=(0, None), ylim=(0, None))
        panel_title(axes, number, f"radial clearance {clearance:g} mm")
    legend_below(parts[0][0], 4)
    return figure, pd.concat(tables, ignore_index=True)


def first_impact(law: str, clearance: float) -> pd.DataFrame:
    """Return force and penetration over the first contact, with a hundred steps in it."""
    hit = run(law, 1, 5e-7, clearance=clearance, restitution=0.9, friction=0.0)
    onset, release = hit.contacts[["onset_s", "release_s"]].iloc[0]
    rows = hit.in_contact & (hit.time >= onset) & (hit.time <= release)
    pair = hit.mechanism.joint.pair
    length = pair.contact_length("the joint")
    depth = np.maximum(hit.penetration[rows], 0.0)  # m; at its ends a rounding error is left
    columns = {"time_us": 1e6 * (hit.time[rows] - onset), "penetration_um": 1e6 * depth}
    columns["force_N"] = hit.normal_force[rows]
    columns["elastic_force_N"] = LAWS[law]().load(1e3 * depth, pair) * length
    return pd.DataFrame({"law": law, "clearance_mm": clearance, **columns})


def paths(clearance: float) -> tuple[Figure, pd.DataFrame]:
    """Path of the journal's centre in its bearing over the eleventh revolution after the start, in
    parts of the clearance, for four laws (columns), restitutions c_e and friction coefficients c_f
    (rows). Grey: the circle of the clearance, outside of which journal and bearing touch. Where the
    journal flies, the motion is chaotic: compare the kind of path, not its points.
    """
    figure, tables = new_figure("page", 0.96 * width_mm("page")), []
    grid = figure.subplots(len(LOSSES), len(DRAWN), sharex=True, sharey=True)
    for row, (restitution, friction) in zip(grid, LOSSES, strict=True):
        case = {"clearance": clearance, "restitution": restitution, "friction": friction}
        for axes, law in zip(row, DRAWN, strict=True):
            table = path(run(law, LAST, 4e-6, **case))
            tables.append(table.assign(law=law, **case))
            axes.add_patch(Circle((0, 0), 1.0, facecolor="0.93", edgecolor="0.6", linewidth=0.5))
            axes.plot(1e-3 * table["x_um"] / clearance, 1e-3 * table["y_um"] / clearance, **LINE)
            axes.set(aspect="equal", xticks=(-1, 0, 1), yticks=(-1, 0, 1))
        row[0].set_ylabel(f"$c_e$ = {restitution:g}, $c_f$ = {friction:g}")
    for axes, name in zip(grid[0], DRAWN.values(), strict=True):
        axes.set_title(name)
    figure.supxlabel("$x$ / clearance (-)", fontsize="medium")
    figure.supylabel("$y$ / clearance (-)", fontsize="medium")
    table = pd.concat(tables, ignore_index=True)
    reach = 1.04e-3 * table[["x_um", "y_um"]].abs().to_numpy().max() / clearance
    axes.set(xlim=(-reach, reach), ylim=(-reach, reach))
    return figure, table


def path(motion: Trajectory) -> pd.DataFrame:
    """Return the journal's centre from that of the bearing at even times."""
    revolution = np.linspace(FIRST, LAST, POINTS)
    x, y = -1e6 * motion.eccentricity_at(revolution * motion.mechanism.period).T
    return pd.DataFrame({"revolution": revolution, "x_um": x, "y_um": y})


fig18 = partial(paths, clearance=0.5)
fig19 = partial(paths, clearance=0.02)
FIGURES = {"fig17": fig17, "fig18": fig18, "fig19": fig19}
