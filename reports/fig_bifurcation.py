"""Periodic or not: Poincaré sections of the slider-crank over its clearance."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.mechanism.statistics import HELD, LONGEST, REPEATS
from cylcontact.plots.figure import Drawing, new_figure, panel_title, plain_log
from cylcontact.plots.style import ACCENT, COLOURS
from cylcontact.reports.bench import Bench, MissingInputError

from .slider_crank import assumed, mechanism

FILE = "datasets/mechanism/bifurcation.csv"
CAPTION = (
    "Poincaré sections of the slider-crank with Johnson's law, {losses}, at the end of each of "
    "revolutions {first} to {last}, by the radial clearance (mm). The section is taken at the "
    "crank's outer dead centre; e_y is the eccentricity across the slide. Black: period 1; blue: "
    "period 2 to {longest}; orange: no such period (sections repeat if they agree to {repeats:g} "
    "of the clearance, over {held} revolutions). (a) Every contact has the δ̇⁽⁻⁾ of its onset. (b) "
    "From revolution 11 on the contact carries {rate:g} m/s; circles: a later flight has ended "
    "that, and the contact carries the rate of another onset. (c) The δ̇⁽⁻⁾ (m/s) that each of the "
    "runs carries at its end; filled: those of (a), open: those of (b). (d) The sections of one "
    "run of each kind from (b). In contact without end δ̇⁽⁻⁾ scales the damping for good, and which "
    "one an onset has depends on the start, so that a motion belongs to a clearance and to a rate. "
    "With one rate, (b) is no smoother than (a). {assumed}"
)
KINDS = {"period 1": "black", f"period 2 to {LONGEST}": COLOURS[1], "no period": ACCENT}
DOTS: dict[str, Any] = {"linestyle": "none", "marker": "o", "markeredgewidth": 0.2}
CIRCLES: dict[str, Any] = {"linestyle": "none", "marker": "o", "markeredgewidth": 0.6}
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
    clearance = model.data["clearance"]
    caption = CAPTION.format(
        losses=f"c_e = {clearance['restitution']:g} and c_f = {clearance['friction']:g}",
        first=sections["revolution"].min() + 1,
        last=sections["revolution"].max() + 1,
        longest=LONGEST,
        repeats=REPEATS,
        held=HELD,
        rate=held,
        assumed=assumed(model),
    )
    return Drawing(_draw_panels(sections, runs, held), sections, headline, caption)


def _sections(bench: Bench) -> pd.DataFrame:
    """Return the sections drawn; a rate held of 0 is that of the onset."""
    file = bench.input(FILE)
    if not file.is_file():
        rule, remedy = "this table does not exist", "make bifurcation computes it"
        raise MissingInputError(str(file), "", None, rule, remedy)
    table = pd.read_csv(file)
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
    figure = new_figure("full", 110.0)
    panels = figure.subplots(2, 2)
    for number, rate in enumerate((0.0, held)):
        axes = panels[0, number]
        _draw_bifurcation(axes, sections[sections["held_m_per_s"] == rate])
        what = f"held at {rate:g} m/s" if rate else "of each onset"
        panel_title(axes, number, rf"{RATE} {what}")
        axes.set_ylabel("$e_y/c$ (-)")
    panels[0, 1].sharey(panels[0, 0])
    _draw_rates(panels[1, 0], runs)
    panel_title(panels[1, 0], 2, rf"{RATE} carried at the end")
    for axes in (*panels[0], panels[1, 0]):
        plain_log(axes, "x", TICKS)
        axes.set_xlabel("radial clearance (mm)")
    _draw_sections(panels[1, 1], sections[sections["held_m_per_s"] == held])
    panel_title(panels[1, 1], 3, "Poincaré sections")
    handles = [
        panels[0, 0].plot(
            [], [], color=colour, markerfacecolor=colour, markersize=3, label=kind, **DOTS
        )[0]
        for kind, colour in KINDS.items()
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure


def _draw_bifurcation(axes: Axes, sections: pd.DataFrame) -> None:
    """Draw all sections of the runs; circles where the rate held has been lost."""
    kinds, rate = _kind(sections), sections["held_m_per_s"]
    lost = (rate > 0) & (sections["impact_rate_m_per_s"] != rate)
    for kind, colour in KINDS.items():
        for style, rows in ((DOTS, ~lost), (CIRCLES, lost)):
            chosen = sections[rows & (kinds == kind)]
            size = 1.6 if style is DOTS else 2.4
            axes.plot(
                chosen["clearance_mm"], chosen["e_y_over_clearance"], markersize=size,
                color=colour, markerfacecolor=colour if style is DOTS else "none", rasterized=True,
                **style,
            )  # fmt: skip


def _draw_rates(axes: Axes, runs: pd.DataFrame) -> None:
    """Draw the rate that each run carries at its end; none where it ends in flight."""
    touching = runs[runs["impact_rate_m_per_s"] > 0]
    kinds = _kind(touching)
    for kind, colour in KINDS.items():
        for style, rows in (
            (DOTS, touching["held_m_per_s"] == 0),
            (CIRCLES, touching["held_m_per_s"] > 0),
        ):
            chosen = touching[rows & (kinds == kind)]
            axes.plot(
                chosen["clearance_mm"], chosen["impact_rate_m_per_s"], color=colour,
                markerfacecolor=colour if style is DOTS else "none", markersize=3, **style,
            )  # fmt: skip
    axes.set(yscale="log", ylabel=rf"{RATE} (m/s)")


def _draw_sections(axes: Axes, sections: pd.DataFrame) -> None:
    """Draw the sections of the run of each kind that fills most of the plane."""
    still_held = sections[sections["impact_rate_m_per_s"] == sections["held_m_per_s"]]
    for kind, colour in KINDS.items():
        rows = still_held[_kind(still_held) == kind]
        if rows.empty:
            continue
        group = rows.groupby("clearance_mm")["e_y_over_clearance"]
        clearance = (group.max() - group.min()).sort_values().index[-1]
        run = rows[rows["clearance_mm"] == clearance]
        axes.plot(
            run["e_y_over_clearance"], run["e_y_rate_m_per_s"], markersize=2.4, color=colour,
            markerfacecolor=colour, label=f"{clearance:.3g} mm", **DOTS,
        )  # fmt: skip
    axes.set(xlabel="$e_y/c$ (-)", ylabel=r"$\dot e_y$ (m/s)")
    axes.legend()
