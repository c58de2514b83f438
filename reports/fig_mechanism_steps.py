"""The integrator's steps over one revolution, without losses and with both of them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from cylcontact.mechanism import Case, Trajectory
from cylcontact.plots.figure import Drawing, new_figure, panel_title
from cylcontact.plots.style import ACCENT
from cylcontact.reports.bench import Bench

from .paper import JOINT_CLEARANCES
from .slider_crank import assumed, mechanism, simulated

REVOLUTION = 3  # from 0
LOSSES = ((1.0, 0.0), (0.9, 0.1))
CASES = [Case("enhanced", c, *losses) for c in JOINT_CLEARANCES for losses in LOSSES]
CAPTION = (
    "Accepted steps (µs) of the integrator, DOP853 at a tolerance of {tolerance:g}, "
    "over revolution {revolution} of the slider-crank with the enhanced law, by radial clearance "
    "(mm) and losses: without any, and with c_e = 0.9 and c_f = 0.1. Each onset and release of "
    "contact is found by root and followed by a short first step, which makes the combs. The "
    "paper's largest step is 100 µs. {assumed}"
)
STYLES = {
    "flight": {"color": "black", "marker": "s", "markerfacecolor": "black"},
    "contact": {"color": ACCENT, "marker": "o", "markerfacecolor": ACCENT},
}


def draw(bench: Bench) -> Drawing:
    runs = {case: simulated(bench, case, REVOLUTION + 1, max_step=None) for case in CASES}
    tables = {case: _steps(case, run) for case, run in runs.items()}
    headline = {}
    for case, table in tables.items():
        name = f"{case.clearance:g} mm, c_e = {case.restitution:g}, c_f = {case.friction:g}"
        headline[f"{name}: steps"] = float(len(table))
        for mode, steps in table.groupby("mode")["step_us"]:
            headline[f"{name}: mean step in {mode}, us"] = float(steps.mean())
    slider_crank = mechanism(bench)
    caption = CAPTION.format(
        tolerance=slider_crank.integration.tolerance,
        revolution=REVOLUTION + 1,
        assumed=assumed(slider_crank),
    )
    table = pd.concat(tables.values(), ignore_index=True)
    return Drawing(_draw_panels(tables), table, headline, caption)


def _steps(case: Case, run: Trajectory) -> pd.DataFrame:
    """Return every step of the revolution."""
    length, touching = np.diff(run.time) * 1e6, run.in_contact[1:]
    at = run.revolution[1:]
    # An onset or a release has two rows at one time.
    rows = (at > REVOLUTION) & (at <= REVOLUTION + 1) & (length > 0)
    return pd.DataFrame(
        {
            "law": case.law,
            "clearance_mm": case.clearance,
            "restitution": case.restitution,
            "friction": case.friction,
            "revolution": at[rows],
            "step_us": length[rows],
            "mode": np.where(touching[rows], "contact", "flight"),
        }
    )


def _draw_panels(tables: Mapping[Case, pd.DataFrame]) -> Figure:
    """Draw step against time, a row of panels for each clearance."""
    figure = new_figure("full", 96.0)
    panels = figure.subplots(len(JOINT_CLEARANCES), len(LOSSES), sharex=True, sharey=True)
    for number, (case, table) in enumerate(tables.items()):
        axes = panels.flat[number]
        for mode, style in STYLES.items():
            rows = table[table["mode"] == mode]
            axes.plot(
                rows["revolution"], rows["step_us"], label=mode,
                linestyle="none", markersize=1.2, markeredgewidth=0, rasterized=True, **style,
            )  # fmt: skip
        losses = rf"$c_e$ = {case.restitution:g}, $c_f$ = {case.friction:g}"
        panel_title(axes, number, f"{case.clearance:g} mm, {losses}")
        axes.set_yscale("log")
    for axes in panels[-1]:
        axes.set_xlabel("time (revolutions of the crank)")
    for axes in panels[:, 0]:
        axes.set_ylabel("step (µs)")
    handles, labels = panels.flat[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2, markerscale=4)
    return figure
