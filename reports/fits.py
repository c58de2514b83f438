"""Figs 2 and 3: power laws fitted to Johnson's law, and how their exponent varies."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import Enhanced, Johnson
from cylcontact.plots.figure import legend_below, panel_title, panels, plain_log
from cylcontact.support.arrays import FloatArray

from .paper import STEEL

# ΔR in mm, and the loads in N/mm. Those of the hole give every printed digit, those of the rollers
# come close. The paper names no loads.
FIG_2 = {
    "internal": (0.05, np.append(1, 10 * np.arange(1, 101))),
    "external": (140.0, np.append(1, 100 * np.arange(1, 101))),
}
# K in N/mm per mmⁿ and n, as printed.
PUBLISHED = {"internal": (312148, 1.2370), "external": (44935, 1.0935)}
# The ranges of Section 3.1; the paper says neither how many points they have nor their spacing.
DR = {"internal": (0.05, 10.0), "external": (5.0, 500.0)}  # mm
MODULI, RATIOS = (20.7, 69.0, 207.0, 600.0, 10000.0), (0.1, 0.3, 0.5)  # GPa, -
LOADS = np.geomspace(10.0, 1000.0, 41)  # N/mm


class PowerFit(NamedTuple):
    """Lines ln f = ln K + n·ln δ through points; K in N/mm per mmⁿ."""

    K: FloatArray
    n: FloatArray
    r_squared: FloatArray


def fit_power(load: FloatArray, penetration: FloatArray) -> PowerFit:
    """Fit f = K·δⁿ (Eq 3) by least squares on ln f, along the last axis and without what is NaN."""
    x, y = np.log(penetration), np.log(load)
    x_mean, y_mean = (np.nanmean(each, axis=-1, keepdims=True) for each in (x, y))
    dx, dy = x - x_mean, y - y_mean
    xx, xy, yy = (np.nansum(each, axis=-1) for each in (dx * dx, dx * dy, dy * dy))
    n = xy / xx
    return PowerFit(np.exp(y_mean[..., 0] - n * x_mean[..., 0]), n, xy**2 / (xx * yy))


def fig02() -> tuple[Figure, pd.DataFrame]:
    """Load per unit length against penetration by Johnson's law (Eq 1), and the power law f = K δⁿ
    (Eq 3), as published and as fitted to Johnson's in logarithms: (a) a pin in a hole, ΔR = 50 µm;
    (b) rollers, ΔR = 140 mm. E = 207 GPa, ν = 0.3. Below: the power laws less Johnson's. The paper
    names no loads; ours are (a) 1, 10, 20, … 1000 N/mm, (b) 1, 100, 200, … 10000 N/mm.
    """
    figure, parts = panels(2, 82.0, heights=(3, 1), least_mm=80.0)
    tables = []
    for number, (contact, (dR, load)) in enumerate(FIG_2.items()):
        pair = CylinderPair.from_dR(contact, dR, STEEL)
        depth = Johnson().penetration(load, pair)
        fit = fit_power(load, depth)
        fitted = fit.K * depth**fit.n
        columns = {"load_N_per_mm": load, "penetration_mm": depth, "fitted_load_N_per_mm": fitted}
        table = pd.DataFrame({"contact": contact, "dR_mm": dR, **columns})
        table["difference_percent"] = 100 * (fitted / load - 1)
        K, n = PUBLISHED[contact]
        table["published_load_N_per_mm"] = K * depth**n
        tables.append(table)
        upper, lower = parts[number]
        upper.plot(1e3 * depth, load, marker="", label="Johnson's law")
        label = f"fitted: K = {fit.K:.0f}, n = {fit.n:.4f}, $R^2$ = {fit.r_squared:.4f}"
        lines = {
            "fitted_load_N_per_mm": (label, {"linestyle": "--", "color": "C2"}),
            "published_load_N_per_mm": (
                f"published: K = {K}, n = {n:.4f}",
                {"linestyle": ":", "color": "C1"},
            ),
        }
        for column, (name, look) in lines.items():
            upper.plot(1e3 * depth, table[column], marker="", label=name, **look)
            lower.plot(1e3 * depth, 100 * (table[column] / load - 1), marker="", **look)
        lower.axhline(0, color="0.5", linewidth=0.6, linestyle="-", marker="")
        upper.legend(loc="upper left", title="K in N/mm$^{n+1}$", alignment="left")
        upper.set(ylabel="load (N/mm)", ylim=(0, 1.5 * load.max()))
        panel_title(upper, number, f"{contact}, $\\Delta R$ = {dR:g} mm")
        lower.set_xlim(0, None)
        lower.set(xlabel="penetration (µm)", ylabel="difference (%)", ylim=(-30, 10))
    return figure, pd.concat(tables, ignore_index=True)


def fig03() -> tuple[Figure, pd.DataFrame]:
    """Exponent n of the power law fitted to Johnson's law, anew for each ΔR, E and ν, over 41 loads
    from 10 to 1000 N/mm up to the end of Johnson's law: (a) a pin in a hole, (b) rollers. Lines:
    five values of E at ν = 0.3. Band: ν from 0.1 to 0.5 at 207 GPa. Grey: the published exponent
    (Eq 6c).
    """
    figure, parts = panels(2, 74.0, below_mm=12.0)
    tables = []
    for number, (contact, ends) in enumerate(DR.items()):
        (axes,) = parts[number]
        dR = np.geomspace(*ends, 47)
        table = exponents(contact, dR)
        tables.append(table)
        spread = table[table["E_GPa"] == 207.0].groupby("dR_mm")["n"].agg(["min", "max"])
        axes.fill_between(dR, *spread.T.to_numpy(), color="0.85", label="ν from 0.1 to 0.5")
        inside = np.geomspace(ends[0], ends[1] * (1 - 1e-9), 201)  # Eq 6d excludes its last ΔR
        pair = CylinderPair.from_dR(contact, inside, Material("any", "1 MPa", 0.0))
        published = {"color": "0.5", "linewidth": 2.2, "linestyle": "-", "marker": ""}
        axes.plot(inside, Enhanced().exponent(pair), **published, label="published (Eq 6c)")
        for E, rows in table[table["nu"] == 0.3].groupby("E_GPa"):
            axes.plot(dR, rows["n"], label=f"E = {E:g} GPa", markevery=12)
        axes.set(xlim=ends, xlabel=r"$\Delta R$ (mm)", ylabel="exponent n (-)", ylim=(1.0, None))
        plain_log(axes, "x", (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500))
        axes.set_xlim(ends)
        panel_title(axes, number, f"{contact} contact")
    legend_below(parts[0][0], 4)
    return figure, pd.concat(tables, ignore_index=True)


def exponents(contact: str, dR: FloatArray) -> pd.DataFrame:
    """Fit a power law to Johnson's for each E, ν and ΔR, over the loads up to its end."""
    tables = []
    for E, nu in product(MODULI, RATIOS):
        pair = CylinderPair.from_dR(contact, dR[:, None], Material("any", 1e3 * E, nu))
        inside = LOADS <= Johnson().max_load(pair)
        load = np.where(inside, LOADS, np.nan)
        of_power = fit_power(load, Johnson().penetration(load, pair))
        fit = {"n": of_power.n, "K_N_per_mm_n": of_power.K, "R2": of_power.r_squared}
        case = {"contact": contact, "E_GPa": E, "nu": nu, "dR_mm": dR}
        tables.append(pd.DataFrame({**case, "points": inside.sum(axis=1), **fit}))
    return pd.concat(tables, ignore_index=True)


FIGURES = {"fig02": fig02, "fig03": fig03}
