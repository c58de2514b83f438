"""The integrator's steps over a revolution, in contact and in flight."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from cylcontact.mechanism import Case, Trajectory
from cylcontact.plots.figure import new_figure, panel_title
from cylcontact.plots.style import ACCENT

STYLES = {
    "flight": {"color": "black", "marker": "s", "markerfacecolor": "black"},
    "contact": {"color": ACCENT, "marker": "o", "markerfacecolor": ACCENT},
}


def step_table(case: Case, run: Trajectory, revolution: int) -> pd.DataFrame:
    """Return every step of one revolution.

    Parameters
    ----------
    case : Case
        What the rows are marked with.
    run : Trajectory
        The run.
    revolution : int
        From 0.

    Returns
    -------
    pandas.DataFrame
        Columns law, clearance_mm, restitution, friction, revolution (at the step's end), step_us
        and mode, "contact" or "flight".
    """
    length, touching = np.diff(run.time) * 1e6, run.in_contact[1:]
    at = run.revolution[1:]
    # An onset or a release has two rows at one time.
    rows = (at > revolution) & (at <= revolution + 1) & (length > 0)
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


def step_panels(tables: Mapping[Case, pd.DataFrame]) -> Figure:
    """Draw step against time, a row of panels for each clearance.

    Parameters
    ----------
    tables : mapping of Case to pandas.DataFrame
        Those of `step_table`, as many for each clearance.
    """
    clearances = list(dict.fromkeys(case.clearance for case in tables))
    figure = new_figure("full", 96.0)
    panels = figure.subplots(
        len(clearances), len(tables) // len(clearances), sharex=True, sharey=True, squeeze=False
    )
    for number, (case, table) in enumerate(tables.items()):
        axes = panels.flat[number]
        for mode, look in STYLES.items():
            rows = table[table["mode"] == mode]
            axes.plot(
                rows["revolution"], rows["step_us"], label=mode,
                linestyle="none", markersize=1.2, markeredgewidth=0, rasterized=True, **look,
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
