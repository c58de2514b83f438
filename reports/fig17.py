"""Fig 17: contact force against penetration over an impact, for four laws and two clearances."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.mechanism import Case, Trajectory
from cylcontact.plots.figure import Drawing, new_figure, panel_title
from cylcontact.reports.bench import Bench

from .paper import JOINT_CLEARANCES, LOADS
from .slider_crank import (
    LAW_NAMES,
    RECOMMENDED,
    assumed,
    crossings,
    force_ratio,
    law_ends,
    law_style,
    mechanism,
    simulated,
    total_force,
)

# Longest step in s: a hundredth of an impact, so that its peak is a point of the curve.
STEP = 5e-7
# The line of a law without dissipation.
ELASTIC: dict[str, Any] = {"marker": "", "linewidth": 0.5, "linestyle": "-"}
CASES = [Case(law, clearance, 0.9, 0.0) for clearance in JOINT_CLEARANCES for law in LAW_NAMES]
CAPTION = (
    "Contact force against penetration δ over the first impact of the slider-crank, with four "
    "laws and at two radial clearances (mm); restitution 0.9, no friction. Thick: the loop, above "
    "on approach and below on return; thin: the law without dissipation. The mechanism's data are "
    "assumed, and the paper does not say which impact it draws."
)
METHOD = (
    "Before the first impact the runs are alike, so that all laws meet the same impact, and it is "
    "the hardest of the start: {impacts}. Markers, on approach alone, are at the first step "
    "beyond each quarter of the largest penetration. At equal penetration Johnson's law is "
    "stiffer than the enhanced one {crossed}. The loads, over {length:g} mm of length, go up to "
    "{top:.0f} N/mm, beyond the {fitted:g} N/mm that the enhanced law is fitted to. Which impact "
    "to draw is our choice. {ends} {assumed}"
)


def draw(bench: Bench) -> Drawing:
    runs = {case: simulated(bench, case, 1, max_step=STEP) for case in CASES}
    table = pd.concat([_impact(case, run) for case, run in runs.items()], ignore_index=True)
    headline, crossed, impacts = {}, [], []
    for clearance, rows in table.groupby("clearance_mm", sort=False):
        case = Case("johnson", float(str(clearance)), 0.9, 0.0)
        speed = runs[case].contacts["impact_rate_m_per_s"].iloc[0]
        impacts.append(f"{speed:.3g} m/s at {clearance:g} mm")
        pair = runs[case].mechanism.clearance.contact.pair
        deepest = rows.loc[rows["law"] == case.law, "penetration_um"].max() * 1e-3
        equal = crossings(force_ratio("johnson", "enhanced", pair, deepest))
        crossed.append(f"from {1e3 * equal[-1]:.3g} µm on at {clearance:g} mm")
        headline[f"{clearance:g} mm, Johnson stiffer than enhanced from, um"] = 1e3 * equal[-1]
        for law, loop in rows.groupby("law", sort=False):
            headline[f"{clearance:g} mm, {law}: penetration, um"] = loop["penetration_um"].max()
            headline[f"{clearance:g} mm, {law}: force, N"] = loop["force_N"].max()
        peaks = rows.groupby("law")["force_N"].max()
        excess = 100 * (peaks["johnson"] / peaks[RECOMMENDED] - 1)
        headline[f"{clearance:g} mm, Johnson's largest force over the explicit law's, %"] = excess
    length = next(iter(runs.values())).mechanism.clearance.contact.pair.length
    method = METHOD.format(
        impacts=", ".join(impacts),
        crossed=", ".join(crossed),
        length=length,
        top=table["force_N"].max() / length,
        fitted=LOADS[1],
        ends=law_ends(list(runs.values())),
        assumed=assumed(mechanism(bench)),
    )
    return Drawing(_draw_panels(table), table, headline, CAPTION, method)


def _impact(case: Case, run: Trajectory) -> pd.DataFrame:
    """Return force and penetration over the first contact of a run."""
    onset, release = run.contacts[["onset_s", "release_s"]].to_numpy(dtype=float)[0]
    rows = run.in_contact & (run.time >= onset) & (run.time <= release)
    pair = run.mechanism.clearance.contact.pair
    # At the ends of a contact the root leaves a rounding error of either sign.
    depth = np.maximum(run.penetration[rows], 0.0)
    return pd.DataFrame(
        {
            "law": case.law,
            "clearance_mm": case.clearance,
            "time_us": (run.time[rows] - onset) * 1e6,
            "penetration_um": depth * 1e6,
            "force_N": run.normal_force[rows],
            "elastic_force_N": total_force(str(case.law), depth * 1e3, pair),
        }
    )


def _draw_panels(table: pd.DataFrame) -> Figure:
    """Draw force against penetration, a panel for each clearance and a loop for each law."""
    figure = new_figure("full", 74.0)
    panels = figure.subplots(1, len(JOINT_CLEARANCES))
    for number, (axes, clearance) in enumerate(zip(panels, JOINT_CLEARANCES, strict=True)):
        impacts = table[table["clearance_mm"] == clearance]
        for law, loop in impacts.groupby("law", sort=False):
            _draw_loop(axes, str(law), loop)
        axes.set(xlabel="penetration δ (µm)", ylabel="contact force (kN)")
        axes.set(xlim=(0, None), ylim=(0, None))
        panel_title(axes, number, f"radial clearance {clearance:g} mm")
    panels[0].plot([], [], color="black", label="without dissipation", **ELASTIC)
    panels[0].legend(loc="upper left")
    return figure


def _draw_loop(axes: Axes, law: str, loop: pd.DataFrame) -> None:
    """Draw a loop with its markers along the penetration, and the elastic curve inside it."""
    depth, force = loop["penetration_um"].to_numpy(), loop["force_N"].to_numpy() / 1e3
    style = law_style(law)
    marked = np.searchsorted(depth[: depth.argmax()], np.arange(0.25, 1, 0.25) * depth.max())
    axes.plot(depth, force, label=LAW_NAMES[law], markevery=marked.tolist(), **style)
    order = np.argsort(depth)
    elastic = loop["elastic_force_N"].to_numpy()[order] / 1e3
    axes.plot(depth[order], elastic, **style | ELASTIC)
