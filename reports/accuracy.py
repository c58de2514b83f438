"""Beyond the paper: how far the laws are from conformal contact, and what a housing adds."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, Rectangle
from matplotlib.ticker import FixedLocator, NullLocator

from cylcontact.bodies.pair import CylinderPair
from cylcontact.datasets.finite_element import Setup, solve
from cylcontact.laws import LAWS, Conformal, ContactLaw, Housing, Johnson, Persson, Sector
from cylcontact.plots.arguments import law_label
from cylcontact.plots.figure import legend_below, new_figure, plain_log
from cylcontact.support.arrays import FloatArray

from .paper import STEEL, material_of

PHI = np.geomspace(1e-6, 60.0, 1557)[::10]  # f/(E* ΔR)
OF_PHI = ("explicit", "johnson")  # one curve for every pair
CLEARANCES = (0.01, 0.05, 0.5)  # mm, of the enhanced law, which depends on ΔR as well
LOADS = (1.0, 10000.0)  # N/mm
BEND = 0.1  # percent; the axis of errors is linear below and logarithmic beyond

# The joint of fig_housing: its radii in mm and load in N/mm, and ratios R_o/R_i.
R_I, R_J, LOAD = 10.0, 9.95, 1000.0
RATIOS = np.geomspace(1.3, 20.0, 25)
CLAMPS = {
    "whole rim": "rim",
    "eye, 60°, pushed": Sector(60, "pushed"),
    "wide shank, 120°, pulled": Sector(120, "pulled"),
    "eye, 60°, pulled": Sector(60, "pulled"),
}
SOLVED = (1.5, 3.0, 10.0)  # R_o/R_i of the finite elements


def fig_accuracy() -> tuple[Figure, pd.DataFrame]:
    """Error of the penetration at equal load, in percent of conformal contact, against the load
    f/(E* ΔR), for a steel pin in a steel hole. Lines: laws with one curve for all pairs, and the
    enhanced law at three clearances from 1 to 10000 N/mm. The axis is linear up to ±0.1 %.
    """
    pair = CylinderPair.from_dR("internal", 0.05, STEEL)
    load = PHI * pair.E_star * pair.dR
    exact = Persson().penetration(load, pair)
    table = pd.DataFrame({"phi": PHI})
    for name in OF_PHI:
        table[name] = percent_off(LAWS[name](), load, pair, exact)
    for dR in CLEARANCES:
        wider = CylinderPair.from_dR("internal", dR, STEEL)
        load = PHI * wider.E_star * dR
        off = percent_off(LAWS["enhanced"](), load, wider, Persson().penetration(load, wider))
        inside = (load >= LOADS[0]) & (load <= LOADS[1])
        table[f"enhanced, {dR:g} mm"] = np.where(inside, off, np.nan)
    figure = new_figure("page", 82.0)
    axes = figure.subplots()
    for number, name in enumerate(table.columns.drop("phi")):
        axes.plot(PHI, table[name], label=law_label(str(name)), markevery=(3 * number, 18))
    axes.axhline(0, color="0.5", linewidth=0.6, linestyle="-", marker="")
    axes.set(xscale="log", xlim=(PHI[0], PHI[-1]), xlabel=r"load $f/(E^*\Delta R)$ (-)")
    axes.set(yscale="symlog", ylim=(-100, 100), ylabel="error of the penetration (%)")
    axes.set_yscale("symlog", linthresh=BEND, linscale=0.6)
    ticks = (-100, -10, -1, -0.1, 0, 0.1, 1, 10, 100)
    axes.yaxis.set_major_locator(FixedLocator(ticks))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_yticklabels([f"{tick:g}".replace("-", "\u2212") for tick in ticks])
    legend_below(axes, 3)
    return figure, table


def percent_off(
    law: ContactLaw, load: FloatArray, pair: CylinderPair, exact: FloatArray
) -> FloatArray:
    """Return the error of a law's penetration in percent; NaN beyond its domain."""
    return 100 * (law.penetration(load, pair) / exact - 1)


def fig_housing() -> tuple[Figure, pd.DataFrame]:
    """Penetration of a steel pin in a bronze hole against the outer radius of the housing, for four
    ways to hold it; R_i = 10 mm, R_j = 9.95 mm, 1000 N/mm, plane strain. Lines: conformal contact;
    crosses: finite elements; dotted: Johnson's law, which takes no housing. Below: the housings;
    thick: where the rim is held, arrow: the load on the pin.
    """
    steel, bronze = material_of("high-strength steel"), material_of("bronze")
    pair = CylinderPair.internal(R_i=R_I, R_j=R_J, pin=steel, hole=bronze)
    table = pd.DataFrame({"R_o_over_R_i": RATIOS})
    for name, clamp in CLAMPS.items():
        laws = [Conformal(Housing(R_I * ratio, clamp=clamp)) for ratio in RATIOS]
        table[name] = [1e3 * float(law.penetration(LOAD, pair)) for law in laws]
    table["johnson"] = 1e3 * float(Johnson().penetration(LOAD, pair))
    figure = new_figure("page", 112.0)
    parts = figure.subplot_mosaic([["plot"] * 4, list("abcd")], height_ratios=(2, 1))
    axes = parts["plot"]
    for number, (name, clamp) in enumerate(CLAMPS.items()):
        axes.plot(RATIOS, table[name], label=name, markevery=(2 * number, 8))
        points = [by_elements(pair, ratio, clamp) for ratio in SOLVED]
        look = {"color": f"C{number}", "markersize": 9, "linestyle": "none"}
        axes.plot(SOLVED, points, "+", **look)
        sketch(parts["abcd"[number]], clamp)
        title = name.replace("°, ", "°,\n")
        parts["abcd"[number]].set_title(title, color=f"C{number}")
    axes.axhline(table["johnson"].iloc[0], color="0.45", linestyle=":", marker="")
    axes.text(
        19.5, table["johnson"].iloc[0], "Johnson's law", ha="right", va="bottom", color="0.45"
    )
    plain_log(axes, "x", (1.3, 1.5, 2, 3, 5, 10, 20))
    plain_log(axes, "y", (7, 10, 20, 50, 100, 200))
    axes.set(xlabel=r"outer radius of the housing $R_o/R_i$ (-)", ylabel="penetration (µm)")
    axes.legend(loc="upper right")
    return figure, table


def by_elements(pair: CylinderPair, ratio: float, clamp: str | Sector) -> float:
    """Return the penetration in µm by finite elements."""
    hole, pin = pair.material_i, pair.material_j
    bodies = {
        "E": float(hole.E),
        "nu": float(hole.nu),
        "pin_E": float(pin.E),
        "pin_nu": float(pin.nu),
    }
    setup = Setup(hole_radius=R_I, outer_ratio=ratio, clamp=clamp, cells=10, **bodies)
    (case,) = solve(setup, R_I - R_J, [LOAD])
    return 1e3 * case.penetration


def sketch(axes: Axes, clamp: str | Sector) -> None:
    """Draw a housing, the pin, the held part of the rim and the load, which points upwards."""
    outer = 2.0
    axes.add_patch(Circle((0, 0), outer, facecolor="0.85", edgecolor="black", linewidth=0.6))
    axes.add_patch(Circle((0, 0), 1.0, facecolor="white", edgecolor="black", linewidth=0.6))
    axes.add_patch(Circle((0, 0.08), 0.92, facecolor="#cfe4f2", edgecolor="black", linewidth=0.6))
    axes.annotate("", (0, 0.7), (0, -0.55), arrowprops={"arrowstyle": "-|>", "facecolor": "black"})
    half = 180.0 if clamp == "rim" else clamp.angle / 2  # type: ignore[union-attr]
    middle = 90.0 if clamp == "rim" or clamp.side == "pushed" else 270.0  # type: ignore[union-attr]
    held = {"theta1": middle - half, "theta2": middle + half, "linewidth": 3.5, "color": "black"}
    axes.add_patch(Arc((0, 0), 2 * outer, 2 * outer, **held))
    if clamp != "rim":  # the rod or shank that holds the sector
        width, sign = 2 * outer * np.sin(np.radians(half)), 1 if middle == 90.0 else -1
        low = sign * outer * np.cos(np.radians(half))
        shank = {"facecolor": "0.85", "edgecolor": "black", "linewidth": 0.6, "zorder": 0}
        axes.add_patch(Rectangle((-width / 2, low), width, sign * 1.6, **shank))
    axes.set(xlim=(-2.3, 2.3), ylim=(-2.9, 2.9), aspect="equal")
    axes.axis("off")


FIGURES = {"fig_accuracy": fig_accuracy, "fig_housing": fig_housing}
