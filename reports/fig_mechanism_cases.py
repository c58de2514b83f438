"""Contact, impacts and steps of the slider-crank, for three laws and eight cases."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.plots.figure import Drawing, new_figure, panel_title
from cylcontact.plots.style import QUIET
from cylcontact.reports.bench import Bench

from .long_runs import FEW, FIRST, MANY, statistics_table
from .paper import FRICTIONS, JOINT_CLEARANCES, JOINT_LAWS, RESTITUTIONS
from .slider_crank import assumed, law_style, mechanism

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
    "Share of the time in contact, impacts per revolution and the integrator's mean step of the "
    "slider-crank, by radial clearance (mm), restitution c_e and friction c_f, for three laws. "
    "Markers: means over {many} revolutions after the first {first}; bars: their 95 % intervals, "
    "by batch means. Without losses there is no steady state: means over {few} revolutions, "
    "numbers of that window, and bars that tell how its batches scatter. Runs with impacts are "
    "sensitive to everything, so that "
    "only such statistics can be compared. At 0.02 mm without dissipation Johnson's law goes on "
    "along its tangent from 0.9 of its largest penetration, in up to {continued:.0%} of the "
    "contacts, and its end is passed in up to {left:.0%} of the revolutions. {assumed}"
)
GROUPS = [(c, ce, cf) for c in JOINT_CLEARANCES for ce in RESTITUTIONS for cf in FRICTIONS]
LABELS = [f"{ce:g}\n{cf:g}" for _, ce, cf in GROUPS]
# From one law to the next within a group, in groups.
APART = 0.22
# Room above the data for the clearances.
HEADROOM = 1.12
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
    caption = CAPTION.format(
        first=FIRST,
        many=MANY,
        few=FEW,
        continued=johnson["continued"].max(),
        left=johnson["left"].max(),
        assumed=assumed(mechanism(bench)),
    )
    csv = table[COLUMNS].rename(columns={"clearance": "clearance_mm"})
    return Drawing(_draw_panels(table), csv, headline, caption)


def _draw_panels(table: pd.DataFrame) -> Figure:
    """Draw the share of time in contact, impacts per revolution and the mean step."""
    figure = new_figure("full", 70.0)
    panels = figure.subplots(1, 3)
    columns = (
        ("contact_fraction", "share of time in contact (-)"),
        ("impacts", "impacts per revolution (-)"),
        ("step_us", "mean step (µs)"),
    )
    for number, (axes, (column, label)) in enumerate(zip(panels, columns, strict=True)):
        for law, rows in table.groupby("law", sort=False):
            _draw_law(axes, str(law), rows, column, f"{column}_half_width")
        _label_groups(axes)
        axes.set(ylabel=label, ylim=(0, HEADROOM * axes.get_ylim()[1]))
        panel_title(axes, number, label.partition(" (")[0])
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


def _draw_law(axes: Axes, law: str, rows: pd.DataFrame, column: str, half: str | None) -> None:
    """Draw a law's cases, with bars of a half-width where there is one."""
    cases = rows.set_index(["clearance", "restitution", "friction"]).loc[GROUPS]
    at = np.arange(len(GROUPS)) + APART * (list(JOINT_LAWS).index(law) - 1)
    style = law_style(law)
    bars = None if half is None else cases[half].to_numpy()
    axes.errorbar(
        at, cases[column].to_numpy(), yerr=bars, color=style["color"], marker=style["marker"],
        label=JOINT_LAWS[law], clip_on=False, **BARS,
    )  # fmt: skip


def _label_groups(axes: Axes) -> None:
    """Write the losses below the cases, and the clearances above them."""
    axes.set_xticks(range(len(GROUPS)), LABELS)
    axes.tick_params(axis="x", length=0)
    middle = len(GROUPS) / 2 - 0.5
    axes.axvline(middle, color=QUIET, linewidth=0.6, linestyle="-", marker="")
    for number, clearance in enumerate(JOINT_CLEARANCES):
        axes.annotate(
            f"{clearance:g} mm", xy=(0.25 + 0.5 * number, 1.0), xycoords="axes fraction",
            xytext=(0, -8), textcoords="offset points", ha="center", va="center",
        )  # fmt: skip
    axes.set_xlabel("$c_e$ (above), $c_f$ (below)")


def balance_panel(axes: Axes, table: pd.DataFrame, bound: float) -> None:
    """Draw the largest error of the energy balance of every case, relative to its peak."""
    for law, rows in table.groupby("law", sort=False):
        _draw_law(axes, str(law), rows, "energy_error", None)
    axes.axhline(bound, color=QUIET, linewidth=0.8, linestyle=":", marker="")
    _label_groups(axes)
    axes.set(ylabel="largest error of the balance (-)", yscale="log", ylim=(1e-10, 1e-2))
