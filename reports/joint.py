"""Figs 17 to 19: the joint of the slider-crank, whose masses and lengths are ours."""

from __future__ import annotations

from functools import partial
from itertools import product

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from cylcontact.laws import LAWS
from cylcontact.mechanism import Trajectory, mechanism_from, read_mechanism, simulate
from cylcontact.plots.figure import legend_below, new_figure, panel_title

SPEC = "datasets/slider_crank.toml"
DRAWN = {"lankarani-nikravesh": "Lankarani-Nikravesh", "johnson": "Johnson"}
DRAWN |= {"enhanced": "enhanced", "explicit": "explicit"}
LOSSES = list(product((1.0, 0.9), (0.0, 0.1)))  # restitution, friction
# The revolutions that count: from 3, by when the runs that settle have settled, to the 13th.
FIRST, LAST = 3, 13


def run(law: str, revolutions: int, max_step: float, **case: float) -> Trajectory:
    """Simulate a case; beyond its end a law goes on along its tangent. The longest step is in s."""
    data = read_mechanism(SPEC, law=law, **case).data
    finer = {**data, "integration": {**data["integration"], "max_step": max_step}}
    return simulate(mechanism_from(finer, SPEC), revolutions=revolutions, beyond="tangent")


def fig17() -> tuple[Figure, pd.DataFrame]:
    """Contact force against penetration over the first impact of the slider-crank, at two radial
    clearances; restitution 0.9, no friction. Thick: above on approach, below on return. Thin: the
    law without dissipation. The paper does not say which impact it draws: this one is the hardest
    of the start, and the same for all laws.
    """
    figure, tables = new_figure("page", 74.0), []
    for number, axes in enumerate(figure.subplots(1, 2)):
        clearance = (0.5, 0.02)[number]
        for colour, (law, name) in enumerate(DRAWN.items()):
            table = first_impact(law, clearance)
            tables.append(table)
            depth, force = table["penetration_um"], 1e-3 * table["force_N"]
            axes.plot(depth, force, color=f"C{colour}", marker="", label=name)
            elastic = {"linestyle": "-", "color": f"C{colour}", "marker": "", "linewidth": 0.5}
            axes.plot(depth, 1e-3 * table["elastic_force_N"], **elastic)
        axes.set(xlabel="penetration (µm)", xlim=(0, None), ylim=(0, None))
        panel_title(axes, number, f"radial clearance {clearance:g} mm")
    figure.axes[0].set_ylabel("contact force (kN)")
    figure.axes[0].legend(loc="upper left")
    return figure, pd.concat(tables, ignore_index=True)


def first_impact(law: str, clearance: float) -> pd.DataFrame:
    """Return force and penetration over the first contact, with a hundred steps in it."""
    hit = run(law, 1, 5e-7, clearance=clearance, restitution=0.9, friction=0.0)
    onset, release = hit.contacts[["onset_s", "release_s"]].iloc[0]
    rows = hit.in_contact & (hit.time >= onset) & (hit.time <= release)
    pair = hit.mechanism.clearance.contact.pair
    depth = np.maximum(hit.penetration[rows], 0.0)  # m; at its ends a rounding error is left
    columns = {"time_us": 1e6 * (hit.time[rows] - onset), "penetration_um": 1e6 * depth}
    columns["force_N"] = hit.normal_force[rows]
    columns["elastic_force_N"] = LAWS[law]().load(1e3 * depth, pair) * pair.length
    return pd.DataFrame({"law": law, "clearance_mm": clearance, **columns})


def distances(clearance: float) -> tuple[Figure, pd.DataFrame]:
    """Share of the time in which the pin's centre is closer to the hole's than a distance, over ten
    revolutions, for four laws, restitutions c_e and friction coefficients c_f. The paper draws the
    paths, which are chaotic: only their statistics can be compared.
    """
    figure, tables = new_figure("page", 62.0), []
    panels = figure.subplots(1, 4, sharex=True, sharey=True)
    for number, (axes, (ce, cf)) in enumerate(zip(panels, LOSSES, strict=True)):
        axes.axvline(1.0, color="0.4", linestyle=":", marker="")
        for law, name in DRAWN.items():
            case = {"clearance": clearance, "restitution": ce, "friction": cf}
            table = shares(run(law, LAST, 4e-6, **case))
            distance = 1e-3 * table["distance_um"] / clearance
            axes.plot(distance, table["share"], marker="", label=name)
            tables.append(table.assign(law=law, **case))
        axes.set(xlabel="distance / clearance (-)", xlim=(0, None), ylim=(0, 1))
        panel_title(axes, number, f"$c_e$ = {ce:g}, $c_f$ = {cf:g}")
    panels[0].set_ylabel("share of the time (-)")
    legend_below(panels[0], 4)
    return figure, pd.concat(tables, ignore_index=True)


def shares(path: Trajectory) -> pd.DataFrame:
    """Return the distance that the pin's centre stays within for each share of the time."""
    rows = path.revolution >= FIRST
    distance = np.hypot(*path.eccentricity[rows].T)
    middle, spent = (distance[1:] + distance[:-1]) / 2, np.diff(path.time[rows])
    order = np.argsort(middle)
    share, reached = np.linspace(0, 1, 201), np.cumsum(spent[order]) / spent.sum()
    within = np.interp(share, reached, middle[order])
    return pd.DataFrame({"share": share, "distance_um": 1e6 * within})


fig18 = partial(distances, clearance=0.5)
fig19 = partial(distances, clearance=0.02)
FIGURES = {"fig17": fig17, "fig18": fig18, "fig19": fig19}
