"""Fig 2: power laws fitted to Johnson's law for one internal and one external contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, MultipleLocator

from cylcontact.bodies.pair import CylinderPair
from cylcontact.fitting.power_fit import PowerFit, fit_power_to_law
from cylcontact.laws import Johnson, PowerLaw
from cylcontact.plots.figure import Drawing, new_figure, panel_title, plain_number
from cylcontact.plots.style import ACCENT, QUIET
from cylcontact.reports.bench import Bench
from cylcontact.support.arrays import FloatArray

from .paper import FIG2_DR, FIG2_FITS, GOOD_CORRELATION
from .power_fits import FIG2_LOADS, reference_pair

CAPTION = (
    "Load per unit length (N/mm) against penetration (µm) by Johnson's law (Eq 1), and the power "
    "law f = K δⁿ (Eq 3; K in N/mm per mmⁿ) fitted to it; E = 207 GPa, ν = 0.3. Below: fitted load "
    "less Johnson's at equal penetration, in percent of Johnson's."
)
METHOD = (
    "The fit is least squares in ln δ and ln f; R² is of the same fit. The loads fitted to are "
    "our choice, as the paper names none: (a) 1, 10, 20, … 1000 N/mm, which gives the paper's "
    "constants to every digit; (b) 1, 100, 200, … 10000 N/mm, which comes close to them. The "
    "difference is drawn at these loads."
)
# The vertical axis of the differences in percent, for both contacts.
DIFFERENCES, STEP = (-30.0, 10.0), 10.0


def draw(_bench: Bench) -> Drawing:
    cases = [
        PowerCase(
            reference_pair(contact, FIG2_DR[contact]),
            FIG2_LOADS[contact],
            (*stated, f"> {GOOD_CORRELATION}"),
        )
        for contact, stated in FIG2_FITS.items()
    ]
    tables = [_fit_table(case) for case in cases]
    headline: dict[str, float] = {}
    for case in cases:
        fit, contact = case.fit(), case.pair.contact
        headline |= {f"{contact} K": fit.K, f"{contact} n": fit.n, f"{contact} R2": fit.r_squared}
    table = pd.concat(tables, ignore_index=True)
    return Drawing(_draw_panels(cases, tables), table, headline, CAPTION, METHOD)


@dataclass(frozen=True)
class PowerCase:
    """One panel of Fig 2."""

    pair: CylinderPair
    loads: FloatArray
    stated: tuple[str, str, str]

    def fit(self) -> PowerFit:
        """Fit f = K·δⁿ to Johnson's law at the case's loads."""
        return fit_power_to_law(Johnson(), self.loads, self.pair)


def _fit_table(case: PowerCase) -> pd.DataFrame:
    """Return the points of one case and the fitted load at each."""
    fit, pair = case.fit(), case.pair
    penetration = Johnson().penetration(case.loads, pair)
    fitted = PowerLaw(n=fit.n, K=fit.K).load(penetration, pair)
    return pd.DataFrame(
        {
            "contact": pair.contact,
            "dR_mm": pair.dR,
            "load_N_per_mm": case.loads,
            "penetration_mm": penetration,
            "fitted_load_N_per_mm": fitted,
            "difference_percent": 100 * (fitted / case.loads - 1),
        }
    )


def _draw_panels(cases: Sequence[PowerCase], tables: Sequence[pd.DataFrame]) -> Figure:
    """Draw Johnson's points and the fitted power law, and below them the difference."""
    figure = new_figure("full", 82.0)
    grid = figure.subplots(2, len(cases), sharex="col", height_ratios=(3, 1))
    for number, (case, table) in enumerate(zip(cases, tables, strict=True)):
        _draw_fit(grid[0, number], case, table)
        axes = grid[1, number]
        axes.axhline(0, color=QUIET, linewidth=0.6, linestyle="-", marker="")
        microns = 1e3 * table["penetration_mm"]
        axes.plot(microns, table["difference_percent"], "--", color=ACCENT, marker="")
        axes.set(xlabel="penetration (µm)", ylim=DIFFERENCES)
        axes.yaxis.set_major_locator(MultipleLocator(STEP))
        pair = case.pair
        panel_title(grid[0, number], number, f"{pair.contact}, $\\Delta R$ = {pair.dR:g} mm")
    grid[0, 0].set_ylabel("load (N/mm)")
    grid[1, 0].set_ylabel("difference\nof load (%)")
    return figure


def _draw_fit(axes: Axes, case: PowerCase, table: pd.DataFrame) -> None:
    """Draw points and line, and print the fit beside the paper's."""
    microns = 1e3 * table["penetration_mm"]
    axes.plot(microns, table["load_N_per_mm"], marker="", label="Johnson's law")
    fitted: dict[str, Any] = {"linestyle": "--", "color": ACCENT, "marker": ""}
    axes.plot(microns, table["fitted_load_N_per_mm"], **fitted, label="fitted power law")
    axes.legend(loc="lower right")
    axes.set(xlim=(0, microns.max()), ylim=(0, 1.05 * table["load_N_per_mm"].max()))
    axes.yaxis.set_major_locator(MaxNLocator(5))
    axes.yaxis.set_major_formatter(lambda load, _: plain_number(load))
    fit = case.fit()
    ours = (f"{fit.K:.0f}", f"{fit.n:.4f}", f"{fit.r_squared:.4f}")
    columns = (("", "$K$", "$n$", "$R^2$"), ("here", *ours), ("paper", *case.stated))
    for x, cells in zip((0.04, 0.12, 0.29), columns, strict=True):
        for line, cell in enumerate(cells):
            axes.text(x, 0.93 - 0.09 * line, cell, transform=axes.transAxes, va="baseline")
