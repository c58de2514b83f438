"""Contact, impacts and steps of the slider-crank, for four laws and eight cases."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from cylcontact.joint.clearance import TANGENT_FROM
from cylcontact.plots.figure import Drawing, new_figure, panel_title
from cylcontact.plots.style import QUIET, small_text
from cylcontact.reports.bench import Bench

from .long_runs import FEW, FIRST, MANY, statistics_table
from .paper import FRICTIONS, JOINT_CLEARANCES, RESTITUTIONS
from .slider_crank import LAW_NAMES, assumed, law_style, mechanism

COLUMNS = [
    "law",
    "clearance",
    "restitution",
    "friction",
    *(
        f"{name}{half}"
        for name in (
            "contact_fraction",
            "impacts",
            "step_us",
            "mean_penetration_um",
            "max_penetration_um",
            "force_p99_N",
        )
        for half in ("", "_half_width")
    ),
    "counted",
    "continued",
    "left",
]
CAPTION = (
    "Share of time in contact, impacts per revolution and the integrator's mean step (µs) of the "
    "slider-crank, by radial clearance ΔR (mm), restitution c_e and friction coefficient c_f, for "
    "four laws: means with 95 % intervals. Grey: no losses, hence no steady state; bars show the "
    "scatter within the window. The mechanism's data are assumed."
)
METHOD = (
    "The means are over {many} revolutions after the first {first}, and their intervals by batch "
    "means; without losses they are over {few} revolutions, and hold for that window only. Runs "
    "with impacts depend on every detail of the numerics, so that only such statistics can be "
    "compared. At 0.02 mm without dissipation Johnson's law is continued along its tangent from "
    "{tangent:g} of its largest penetration, in up to {continued:.0%} of the contacts; in "
    "up to {left:.0%} of the revolutions an impact takes more work than the law up to its end. "
    "{assumed}"
)
LOSSES = [(ce, cf) for ce in RESTITUTIONS for cf in FRICTIONS]
GROUPS = [(c, *losses) for c in JOINT_CLEARANCES for losses in LOSSES]
LABELS = [f"{ce:g}\n{cf:g}" for _, ce, cf in GROUPS]
LOSSLESS = [number for number, group in enumerate(GROUPS) if group[1:] == (1.0, 0.0)]
# From one law to the next within a group, in groups.
APART = 0.18
# Lower end of the axes in their upper ends, so that markers at zero are clear of the frame.
BELOW = -0.05
# Height of the two rows of losses, in sizes of their font.
ROWS = 3.3
BARS: dict[str, Any] = {"linestyle": "none", "capsize": 1.5, "elinewidth": 0.7, "capthick": 0.7}


def draw(bench: Bench) -> Drawing:
    table = statistics_table(bench)
    johnson = table[table["law"] == "johnson"]
    headline = {
        f"{row.law}, {row.clearance:g} mm, c_e = {row.restitution:g}, c_f = {row.friction:g}: "
        f"{name}": getattr(row, column)
        for row in table.itertuples()
        for column, name in (
            ("contact_fraction", "share of time in contact, -"),
            ("impacts", "impacts per revolution, -"),
        )
    }
    method = METHOD.format(
        first=FIRST,
        many=MANY,
        few=FEW,
        tangent=TANGENT_FROM,
        continued=johnson["continued"].max(),
        left=johnson["left"].max(),
        assumed=assumed(mechanism(bench)),
    )
    csv = table[COLUMNS].rename(columns={"clearance": "clearance_mm"})
    return Drawing(_draw_panels(table), csv, headline, CAPTION, method)


def _draw_panels(table: pd.DataFrame) -> Figure:
    """Draw the share of time in contact, impacts per revolution and the mean step."""
    figure = new_figure("full", 74.0)
    panels = figure.subplots(1, 3)
    columns = (
        ("contact_fraction", "share of time in contact (-)"),
        ("impacts", "impacts per revolution (-)"),
        ("step_us", "mean step (µs)"),
    )
    for number, (axes, (column, label)) in enumerate(zip(panels, columns, strict=True)):
        draw_laws(axes, table, column, f"{column}_half_width")
        axes.set(ylabel=label, ylim=(BELOW * axes.get_ylim()[1], None))
        panel_title(axes, number, label.partition(" (")[0])
    law_key(figure, panels[0], "no losses")
    return figure


def draw_laws(axes: Axes, table: pd.DataFrame, column: str, half: str | None = None) -> None:
    """Draw all cases of the laws, with bars of a half-width where there is one."""
    for law, rows in table.groupby("law", sort=False):
        _draw_law(axes, str(law), rows, column, half)
    for number in LOSSLESS:
        axes.axvspan(number - 0.5, number + 0.5, color="0.92", linewidth=0, zorder=0)
    axes.set(xlim=(-0.5, len(GROUPS) - 0.5), xlabel="$c_e$ (first row), $c_f$ (second row)")
    axes.set_xticks(range(len(GROUPS)), LABELS)
    middles = (np.arange(len(JOINT_CLEARANCES)) + 0.5) * len(LOSSES) - 0.5
    clearances = [f"$\\Delta R$ = {clearance:g} mm" for clearance in JOINT_CLEARANCES]
    axes.set_xticks(middles, clearances, minor=True)
    axes.tick_params(axis="x", which="both", length=0)
    axes.tick_params(axis="x", which="minor", pad=ROWS * small_text())
    axes.axvline(len(LOSSES) - 0.5, color=QUIET, linewidth=0.6, linestyle="-", marker="")


def law_key(figure: Figure, axes: Axes, grey: str) -> None:
    """Explain the markers and the grey bands below the panels."""
    handles, labels = axes.get_legend_handles_labels()
    handles.append(Patch(color="0.92"))
    figure.legend(handles, [*labels, grey], loc="outside lower center", ncols=5, handlelength=1.6)


def _draw_law(axes: Axes, law: str, rows: pd.DataFrame, column: str, half: str | None) -> None:
    """Draw a law's cases, with bars of a half-width where there is one."""
    cases = rows.set_index(["clearance", "restitution", "friction"]).loc[GROUPS]
    at = np.arange(len(GROUPS)) + APART * (list(LAW_NAMES).index(law) - 1.5)
    style = law_style(law)
    bars = None if half is None else cases[half].to_numpy()
    axes.errorbar(
        at, cases[column].to_numpy(), yerr=bars, color=style["color"], marker=style["marker"],
        label=LAW_NAMES[law], **BARS,
    )  # fmt: skip
