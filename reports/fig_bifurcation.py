"""Periodic or not: Poincaré sections of the slider-crank over its clearance."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from cylcontact.mechanism.statistics import HELD, LONGEST, REPEATS
from cylcontact.plots.figure import Drawing, new_figure, panel_title, plain_log
from cylcontact.plots.style import ACCENT
from cylcontact.reports.bench import Bench

from .slider_crank import assumed, mechanism

FILE = "datasets/mechanism/bifurcation.csv"
COLUMNS = (
    *("clearance_mm", "held_m_per_s", "revolution", "e_y_um", "e_y_rate_m_per_s"),
    *("impact_rate_m_per_s", "period"),
)
CAPTION = (
    "Is the motion periodic? After how many revolutions that of the slider-crank repeats, against "
    "the radial clearance c (mm), with Johnson's law. The impact rate δ̇⁽⁻⁾, which scales the "
    "damping, is (a) that of each onset of contact, (b) held at {rate:g} m/s. Assumed mechanism."
)
METHOD = (
    "The losses are {losses}. Sections are taken at the crank's outer dead centre, in revolutions "
    "{first} to {last}; they are in the table. A motion has period n if they repeat after n "
    "revolutions, to {repeats:g} of the clearance, over the last {held}; n is sought up to "
    "{longest}. In (b) the contact has {rate:g} m/s from revolution 11 on, and it keeps that rate "
    "until a flight ends it; it then has the rate of the next onset (open marks). Where contact "
    "never ends, δ̇⁽⁻⁾ scales the damping for good, and its value depends on the start, so that a "
    "motion belongs to a clearance and to a rate. With one rate, (b) is no smoother than (a). "
    "{assumed}"
)
NONE = LONGEST + 1  # where a motion without a period is drawn
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
        headline[f"{name}: period 1"] = float((group["period"] == 1).sum())
        headline[f"{name}: period 2 to {LONGEST}"] = float((group["period"] > 1).sum())
        headline[f"{name}: no period"] = float((group["period"] == 0).sum())
    still = runs[runs["held_m_per_s"] == held]["impact_rate_m_per_s"] == held
    headline[f"{held:g} m/s held: to the end"] = float(still.sum())
    model = mechanism(bench)
    contact = model.clearance.contact
    restitution = contact.data["dissipation"]["restitution"]
    method = METHOD.format(
        first=sections["revolution"].min() + 1,
        last=sections["revolution"].max() + 1,
        losses=f"c_e = {restitution:g} and c_f = {contact.friction:g}",
        longest=LONGEST,
        repeats=REPEATS,
        held=HELD,
        rate=held,
        assumed=assumed(model),
    )
    caption = CAPTION.format(rate=held)
    return Drawing(_draw_panels(runs, held), sections, headline, caption, method)


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


def _draw_panels(runs: pd.DataFrame, held: float) -> Figure:
    """Draw the period over the clearance, a panel for each way the damping gets its rate."""
    figure = new_figure("full", 44.0)
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for number, (axes, rate) in enumerate(zip(panels, (0.0, held), strict=True)):
        group = runs[runs["held_m_per_s"] == rate]
        lost = (rate > 0) & (group["impact_rate_m_per_s"] != rate)
        place = group["period"].where(group["period"] > 0, NONE)
        for chosen, face in ((~lost, ACCENT), (lost, "white")):
            at = group["clearance_mm"][chosen], place[chosen]
            axes.plot(*at, "o", color=ACCENT, markerfacecolor=face)
        what = f"held at {rate:g} m/s" if rate else "of each onset of contact"
        panel_title(axes, number, rf"$\dot\delta^{{(-)}}$ {what}")
        plain_log(axes, "x", TICKS)
        axes.set_xlabel("radial clearance $c$ (mm)")
    periods = range(1, LONGEST + 1)
    panels[0].set(ylabel="period (revolutions)", yticks=[*periods, NONE], ylim=(0.3, NONE + 0.7))
    panels[0].set_yticklabels([*map(str, periods), "none"])
    return figure
