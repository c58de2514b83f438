"""Distribution of the integrator's steps over a revolution, without losses and with both."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.mechanism import Case, Trajectory
from cylcontact.plots.figure import Drawing, new_figure, panel_title
from cylcontact.plots.style import ACCENT, COLOURS, QUIET
from cylcontact.reports.bench import Bench

from .paper import JOINT_CLEARANCES
from .slider_crank import RECOMMENDED, assumed, mechanism, simulated

REVOLUTION = 3  # from 0
LOSSES = ((1.0, 0.0), (0.9, 0.1))
CASES = [Case(RECOMMENDED, c, *losses) for c in JOINT_CLEARANCES for losses in LOSSES]
CAPTION = (
    "Distribution of the integrator's accepted steps (µs) in revolution {revolution} of the "
    "slider-crank with the explicit law, at two radial clearances c (mm): the share of the steps "
    "that are no longer than a length. c_e: restitution; c_f: friction coefficient; in brackets: "
    "number of steps; dotted: largest step allowed. Mechanism's data assumed."
)
METHOD = (
    "The integrator is DOP853 at a tolerance of {tolerance:g}. A step that passes the onset or the "
    "release of a contact is repeated, shorter, until it ends there; a short first step follows, "
    "of 1 µs in flight, from which the steps grow again. With both losses the journal stays in "
    "contact. The dotted line is the paper's largest step, {longest:g} µs. {assumed}"
)
# Limits of the axis of steps in µs.
LIMITS = (5e-5, 300.0)
# Colour of a mode, and styles of its lines without losses and with both.
STYLES: dict[str, tuple[str, tuple[str, str]]] = {
    "contact": (ACCENT, ("-", "--")),
    "flight": (COLOURS[1], ("-.", ":")),
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
    longest = 1e6 * slider_crank.data["integration"]["max_step"]
    method = METHOD.format(
        tolerance=slider_crank.integration.tolerance,
        longest=longest,
        assumed=assumed(slider_crank),
    )
    table = pd.concat(tables.values(), ignore_index=True)
    figure = _draw_panels(tables, longest)
    return Drawing(figure, table, headline, CAPTION.format(revolution=REVOLUTION + 1), method)


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


def _draw_panels(tables: Mapping[Case, pd.DataFrame], longest: float) -> Figure:
    """Draw the distributions of the steps in µs, a panel for each clearance."""
    figure = new_figure("full", 68.0)
    panels = figure.subplots(1, len(JOINT_CLEARANCES), sharey=True)
    for number, (axes, clearance) in enumerate(zip(panels, JOINT_CLEARANCES, strict=True)):
        for case, table in tables.items():
            if case.clearance == clearance:
                _draw_distributions(axes, case, table)
        axes.axvline(longest, color=QUIET, linewidth=0.8, linestyle=":", marker="")
        axes.set(xscale="log", xlim=LIMITS, ylim=(0, 1), xlabel="step (µs)")
        axes.legend(loc="upper left")
        panel_title(axes, number, f"$c$ = {clearance:g} mm")
    panels[0].set_ylabel("share of the steps (-)")
    return figure


def _draw_distributions(axes: Axes, case: Case, table: pd.DataFrame) -> None:
    """Draw the cumulative distributions of a case's steps in contact and in flight."""
    losses = (case.restitution, case.friction)
    for mode, steps in table.groupby("mode")["step_us"]:
        colour, lines = STYLES[str(mode)]
        axes.ecdf(
            steps, color=colour, linestyle=lines[LOSSES.index(losses)], marker="",
            label=rf"{mode}, $c_e$ = {losses[0]:g}, $c_f$ = {losses[1]:g} ({len(steps)})",
        )  # fmt: skip
