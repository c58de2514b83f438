"""Periodic or not: Poincaré sections of the slider-crank over its clearance."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from cylcontact.mechanism.statistics import HELD, LONGEST, REPEATS
from cylcontact.plots.figure import Drawing, new_figure, panel_title, plain_log
from cylcontact.plots.style import ACCENT, COLOURS, QUIET, current_style
from cylcontact.reports.bench import Bench

from .slider_crank import assumed, mechanism

FILE = "datasets/mechanism/bifurcation.csv"
COLUMNS = (
    *("clearance_mm", "held_m_per_s", "revolution", "e_y_um", "e_y_rate_m_per_s"),
    *("impact_rate_m_per_s", "period"),
)
CAPTION = (
    "Is the motion periodic? Slider-crank, Johnson's law, once a revolution from {first} to "
    "{last}: eccentricity e_y across the slide over the radial clearance c (mm). The impact rate "
    "δ̇⁽⁻⁾, which scales the damping, is (a) that of each onset of contact, (b) held at {rate:g} "
    "m/s. (c) Its value at the end. (d) Three runs of (b). Assumed mechanism."
)
METHOD = (
    "The losses are {losses}. These Poincaré sections are taken at the crank's outer dead centre. "
    "A motion has period n if its sections repeat after n revolutions, to {repeats:g} of the "
    "clearance, over the last {held}; n is sought up to {longest}. In (b) the contact has "
    "{rate:g} m/s from revolution 11 on, and it keeps that rate until a flight ends it; it then "
    "has the rate of the next onset. In (c) are the runs of (a) and, open, those of (b) that have "
    "lost their rate, if they end in contact; dotted: the rate held in (b). In (d) is one run of "
    "each kind from (b) that has kept its rate, the one with the widest spread of e_y/c. Where "
    "contact never ends, δ̇⁽⁻⁾ scales the damping for good, and its value depends on the start, "
    "so that a motion belongs to a clearance and to a rate. With one rate, (b) is no smoother "
    "than (a). {assumed}"
)
# Colour, marker and its size in points by the kind of motion.
KINDS: dict[str, tuple[str, str, float]] = {
    "period 1": ("black", "o", 2.4),
    f"period 2 to {LONGEST}": (COLOURS[1], "s", 2.4),
    "no period": (ACCENT, "^", 2.2),
}
# Sections that agree to so many decimals are drawn once.
PLACES = 4
LOST = "open: held rate lost in a flight"
RATE = r"$\dot\delta^{(-)}$"
TICKS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5)


def draw(bench: Bench) -> Drawing:
    sections = _sections(bench)
    runs = sections.drop_duplicates(["held_m_per_s", "clearance_mm"], keep="last")
    held = float(sections["held_m_per_s"].max())
    headline = {}
    for rate in (0.0, held):
        group = runs[runs["held_m_per_s"] == rate]
        name = f"{rate:g} m/s held" if rate else "rate of the onset"
        headline[f"{name}: runs"] = float(len(group))
        for kind in KINDS:
            headline[f"{name}: {kind}"] = float((_kind(group) == kind).sum())
    still = runs[runs["held_m_per_s"] == held]["impact_rate_m_per_s"] == held
    headline[f"{held:g} m/s held: to the end"] = float(still.sum())
    model = mechanism(bench)
    contact = model.clearance.contact
    restitution = contact.data["dissipation"]["restitution"]
    caption = CAPTION.format(
        first=sections["revolution"].min() + 1,
        last=sections["revolution"].max() + 1,
        rate=held,
    )
    method = METHOD.format(
        losses=f"c_e = {restitution:g} and c_f = {contact.friction:g}",
        longest=LONGEST,
        repeats=REPEATS,
        held=HELD,
        rate=held,
        assumed=assumed(model),
    )
    return Drawing(_draw_panels(sections, runs, held), sections, headline, caption, method)


def _sections(bench: Bench) -> pd.DataFrame:
    """Return the sections drawn; a rate held of 0 is that of the onset."""
    table = bench.table(FILE, COLUMNS, "make bifurcation computes it")
    return pd.DataFrame(
        {
            "clearance_mm": table["clearance_mm"],
            "held_m_per_s": table["held_m_per_s"].fillna(0.0),
            "revolution": table["revolution"],
            "e_y_over_clearance": table["e_y_um"] / table["clearance_mm"] * 1e-3,
            "e_y_rate_m_per_s": table["e_y_rate_m_per_s"],
            "impact_rate_m_per_s": table["impact_rate_m_per_s"],
            "period": table["period"],
        }
    )


def _kind(table: pd.DataFrame) -> pd.Series[Any]:
    """Return the kind of motion of every row."""
    first, longer, none = KINDS
    period = table["period"]
    kinds = np.where(period == 0, none, np.where(period == 1, first, longer))
    return pd.Series(list(kinds), table.index, dtype=object)


def _draw_panels(sections: pd.DataFrame, runs: pd.DataFrame, held: float) -> Figure:
    """Draw sections over the clearance twice, the rates carried, and three sections."""
    figure = new_figure("full", 112.0)
    panels = figure.subplots(2, 2, by_rows=True)
    for number, rate in enumerate((0.0, held)):
        axes = panels[0, number]
        _draw_kinds(axes, sections[sections["held_m_per_s"] == rate], "e_y_over_clearance")
        what = f"held at {rate:g} m/s" if rate else "of each onset of contact"
        panel_title(axes, number, rf"{RATE} {what}")
        axes.set_ylabel("$e_y/c$ (-)")
    panels[0, 1].sharey(panels[0, 0])
    _draw_rates(panels[1, 0], runs, held)
    panel_title(panels[1, 0], 2, rf"{RATE} at the end")
    for axes in (*panels[0], panels[1, 0]):
        plain_log(axes, "x", TICKS)
        axes.set_xlabel("radial clearance $c$ (mm)")
    _draw_sections(panels[1, 1], sections[sections["held_m_per_s"] == held])
    panel_title(panels[1, 1], 3, "three motions of (b)")
    _add_key(figure)
    return figure


def _lost(table: pd.DataFrame) -> pd.Series[Any]:
    """Return whether a rate was held and another one is carried."""
    rate = table["held_m_per_s"]
    return (rate > 0) & (table["impact_rate_m_per_s"] != rate)


def _draw_kinds(axes: Axes, table: pd.DataFrame, column: str) -> None:
    """Draw a column over the clearance; open markers where the rate held has been lost."""
    drawn = table[~table[["held_m_per_s", "clearance_mm", column]].round(PLACES).duplicated()]
    kinds, lost = _kind(drawn), _lost(drawn)
    for kind in KINDS:
        for rows, is_open in ((~lost, False), (lost, True)):
            chosen = drawn[rows & (kinds == kind)]
            axes.plot(chosen["clearance_mm"], chosen[column], **_marker(kind, is_open))


def _marker(kind: str, is_open: bool) -> dict[str, Any]:
    """Return the marker of a kind of motion."""
    colour, marker, size = KINDS[kind]
    return {
        "linestyle": "none",
        "color": colour,
        "marker": marker,
        "markersize": size * current_style().lines,
        "markeredgewidth": 0.5,
        "markerfacecolor": "white" if is_open else colour,
    }


def _draw_rates(axes: Axes, runs: pd.DataFrame, held: float) -> None:
    """Draw the rates carried at the end, save where it is the one held or the end is in flight."""
    touching = runs["impact_rate_m_per_s"] > 0
    _draw_kinds(
        axes, runs[touching & ((runs["held_m_per_s"] == 0) | _lost(runs))], "impact_rate_m_per_s"
    )
    axes.axhline(held, color=QUIET, linewidth=0.8, linestyle=":", marker="")
    axes.set(yscale="log", ylabel=rf"{RATE} (m/s)")


def _draw_sections(axes: Axes, sections: pd.DataFrame) -> None:
    """Draw the sections of the run of each kind that fills most of the plane."""
    still_held = sections[~_lost(sections)]
    for kind in KINDS:
        rows = still_held[_kind(still_held) == kind]
        if rows.empty:
            continue
        group = rows.groupby("clearance_mm")["e_y_over_clearance"]
        clearance = (group.max() - group.min()).sort_values().index[-1]
        run = rows[rows["clearance_mm"] == clearance]
        axes.plot(
            run["e_y_over_clearance"], run["e_y_rate_m_per_s"],
            label=f"$c$ = {clearance:.3g} mm", **_marker(kind, False),
        )  # fmt: skip
    axes.set(xlabel="$e_y/c$ (-)", ylabel=r"$\dot e_y$ (m/s)")
    axes.legend()


def _add_key(figure: Figure) -> None:
    """Explain the markers below the panels."""
    handles = [Line2D([], [], label=kind, **_marker(kind, False)) for kind in KINDS]
    handles.append(Line2D([], [], label=LOST, **_marker(next(iter(KINDS)), True)))
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
