"""Fig 3: the exponent of power laws fitted to Johnson's law, against ΔR, E and ν."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.bodies.material import Material, material_in_MPa
from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.fitting.power_fit import fit_power
from cylcontact.laws import Enhanced
from cylcontact.plots.figure import (
    Drawing,
    legend_below,
    new_figure,
    panel_title,
    plain_log,
    plain_number,
)
from cylcontact.reports.bench import Bench
from cylcontact.support.arrays import FloatArray

from .paper import TRAINING_DR, TRAINING_LOADS
from .power_fits import ends_spread, johnson_points

# The material about which ΔR, E and ν are varied one at a time.
E_GPA, NU = 207.0, 0.3
TICKS: Mapping[Contact, tuple[float, ...]] = {
    "internal": (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10),
    "external": (5, 10, 20, 50, 100, 200, 500),
}
MODULI_GPA = (20.7, 69.0, 207.0, 600.0, 10000.0)
RATIOS = (0.1, 0.3, 0.5)
CAPTION = (
    "Exponent n, less one, of the power law f = K δⁿ fitted to Johnson's law anew for each ΔR, E "
    "and ν, against ΔR (mm). Lines: five values of E, ν = 0.3. Band: ν from 0.1 to 0.5 at E = 207 "
    "GPa. Thick grey line: the published exponent (Eq 6c)."
)
METHOD = (
    "E and ν act through E* = E/(2(1 - ν²)) alone, and E* and ΔR only through their product. The "
    "fit is least squares in ln δ and ln f over 41 loads from 10 to 1000 N/mm spaced "
    "logarithmically; loads beyond Johnson's limit (Eq 8) are left out. The spacing of the loads, "
    "the values of E and the fit are our choice, as the paper names none. The published exponent "
    "for internal contact is defined below ΔR = 10 mm; its line ends at the last ΔR before."
)
EXPONENTS = (0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5)  # n - 1 on the vertical axis


def draw(_bench: Bench) -> Drawing:
    studies = [
        ExponentStudy(contact, np.geomspace(*TRAINING_DR[contact], 47), ticks)
        for contact, ticks in TICKS.items()
    ]
    tables = [exponent_table(study, MODULI_GPA, RATIOS, TRAINING_LOADS) for study in studies]
    table = pd.concat(tables, ignore_index=True)
    return Drawing(_draw_panels(studies, tables), table, _spreads(table), CAPTION, METHOD)


@dataclass(frozen=True)
class ExponentStudy:
    """One panel: ΔR in mm, and the values that its axis labels."""

    contact: Contact
    dR: FloatArray
    ticks: tuple[float, ...]


def exponent_table(
    study: ExponentStudy, moduli: Sequence[float], ratios: Sequence[float], loads: FloatArray
) -> pd.DataFrame:
    """Fit a power law to Johnson's law pair by pair; moduli in GPa, loads in N/mm."""
    rows = []
    for E, nu, dR in product(moduli, ratios, study.dR):
        pair = CylinderPair.from_dR(study.contact, dR, Material("any", E * 1e3, nu))
        inside, penetration = johnson_points(loads, pair)
        fit = fit_power(inside, penetration)
        rows.append((study.contact, E, nu, dR, inside.size, fit.n, fit.K, fit.r_squared))
    names = ("contact", "E_GPa", "nu", "dR_mm", "points", "n", "K_N_per_mm_n", "R2")
    return pd.DataFrame(rows, columns=names)


def _draw_panels(studies: Sequence[ExponentStudy], tables: Sequence[pd.DataFrame]) -> Figure:
    """Draw n against ΔR: a line per modulus, the spread over ν, the published n."""
    figure = new_figure("full", 80.0)
    panels = figure.subplots(1, len(studies), sharey=True)
    for number, (axes, study, table) in enumerate(zip(panels, studies, tables, strict=True)):
        _draw_moduli(axes, table)
        spread = table[table["E_GPa"] == E_GPA].groupby("dR_mm")["n"].agg(["min", "max"])
        axes.fill_between(
            spread.index.to_numpy(),
            spread["min"] - 1,
            spread["max"] - 1,
            color="0.8",
            linewidth=0,
            zorder=0,
            label=f"$\\nu$ from {RATIOS[0]:g} to {RATIOS[-1]:g}, $E$ = {E_GPA:g} GPa",
        )
        pair = CylinderPair.from_dR(study.contact, study.dR, material_in_MPa("any", 1.0, 0.0))
        style: dict[str, Any] = {"marker": "", "color": "0.5", "linewidth": 2.2, "zorder": 1}
        axes.plot(
            study.dR, Enhanced().exponent(pair) - 1, "-", label="published $n$ (Eq 6c)", **style
        )
        plain_log(axes, "x", study.ticks)
        axes.set(xlabel=r"$\Delta R$ (mm)", xlim=(study.dR[0], study.dR[-1]))
        panel_title(axes, number, f"{study.contact} contact")
    plain_log(panels[0], "y", EXPONENTS)
    panels[0].set(ylabel="exponent less one, $n - 1$ (-)", ylim=(EXPONENTS[0], 0.6))
    legend_below(panels[0], 4)
    return figure


def _draw_moduli(axes: Axes, table: pd.DataFrame) -> None:
    """Draw a line per modulus."""
    for number, (E, lines) in enumerate(table[table["nu"] == NU].groupby("E_GPa")):
        label = f"$E$ = {plain_number(float(str(E)))} GPa"
        dR, n = lines["dR_mm"].to_numpy(), lines["n"].to_numpy()
        axes.plot(dR, n - 1, label=label, markevery=(1 + 2 * number, 12))


def _spreads(table: pd.DataFrame) -> dict[str, float]:
    """Return the spread of n over ΔR, E and ν, each varied alone, in percent of the mean."""
    spreads = {}
    for contact, fits in table.groupby("contact", sort=False):
        middle = fits["dR_mm"].unique()[fits["dR_mm"].nunique() // 2]
        centre = {"E_GPa": E_GPA, "nu": NU, "dR_mm": middle}
        for varied in ("dR_mm", "E_GPa", "nu"):
            fixed = {name: value for name, value in centre.items() if name != varied}
            n = fits.loc[(fits[list(fixed)] == pd.Series(fixed)).all(axis=1), "n"]
            spreads[f"{contact}: spread of n over {varied}, %"] = float(
                ends_spread((n.min(), n.max()))
            )
    return spreads
