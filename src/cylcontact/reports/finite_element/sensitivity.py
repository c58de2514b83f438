"""How much each unstated choice of the finite-element set-up matters."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FixedFormatter, FixedLocator

from cylcontact.materials import Material
from cylcontact.plots.figure import new_figure, panel_title
from cylcontact.plots.style import COLOURS, MARKERS


def sensitivity_table(rows: pd.DataFrame) -> pd.DataFrame:
    """Return what each variant changes, case by case.

    Parameters
    ----------
    rows : pandas.DataFrame
        A study's table, its set-up as the variant "base".

    Returns
    -------
    pandas.DataFrame
        Columns variant, dR_mm, load_N_per_mm, change_percent of the penetration, and constant,
        the change of the additive constant C in δ = f/(πE*)·(ln(πE*ΔR/f) + C).
    """
    keys = ["dR_mm", "load_N_per_mm"]
    base = rows[rows["variant"] == "base"][[*keys, "penetration_mm"]]
    others = rows[rows["variant"] != "base"]
    before = others[keys].merge(base, how="left", on=keys)["penetration_mm"].to_numpy()
    change = others["penetration_mm"].to_numpy() - before
    material = Material("steel", 1e3 * others["E_GPa"].to_numpy(), others["nu"].to_numpy())
    E_star = material.plane_strain_modulus / 2
    return others[["variant", *keys]].assign(
        change_percent=100 * change / before,
        constant=np.pi * E_star * change / others["load_N_per_mm"].to_numpy(),
    )


def sensitivity_panels(table: pd.DataFrame) -> Figure:
    """Draw a row for each variant: the change in percent, and of the additive constant."""
    figure = new_figure("full", 92.0)
    panels = figure.subplots(1, 2, sharey=True)
    variants = list(dict.fromkeys(table["variant"]))
    quantities = {
        "change_percent": ("change of the penetration (%)", "percent", (0.1, 1, 10, 100)),
        "constant": (
            "change of C (-)",
            r"$\pi E^* \Delta\delta / f$",
            (0.01, 0.1, 1, 10),
        ),
    }
    for number, (axes, (column, (label, title, ticks))) in enumerate(
        zip(panels, quantities.items(), strict=True)
    ):
        for place, (dR, rows) in enumerate(table.groupby("dR_mm")):
            for load, marked in rows.groupby("load_N_per_mm"):
                low = load == table["load_N_per_mm"].min()
                height = [variants.index(name) for name in marked["variant"]]
                axes.plot(
                    marked[column],
                    np.array(height) + 0.16 * (place - 1.5),
                    linestyle="none",
                    marker=MARKERS[place],
                    color=COLOURS[place],
                    markerfacecolor="white" if low else COLOURS[place],
                    label=rf"$\Delta R$ = {dR:g} mm, {load:g} N/mm",
                )
        axes.axvline(0, color="0.45", linewidth=0.6, linestyle="-", marker="")
        both = [*(-tick for tick in reversed(ticks[1:-1])), 0, *ticks[1:]]
        axes.set_xscale("symlog", linthresh=ticks[1], linscale=0.6)
        axes.xaxis.set_major_locator(FixedLocator(both))
        axes.xaxis.set_major_formatter(FixedFormatter([f"{tick:g}" for tick in both]))
        axes.set_xlim(-3 * ticks[-2], ticks[-1])
        axes.set_xlabel(label)
        panel_title(axes, number, title)
    panels[0].set_yticks(range(len(variants)), variants)
    panels[0].set_ylim(len(variants) - 0.4, -0.6)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return figure
