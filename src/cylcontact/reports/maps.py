"""Maps of the difference between the enhanced law and Johnson's: Figs 10 to 14 and 10r to 14r."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.patheffects import TickedStroke, withStroke

from cylcontact.arrays import FloatArray
from cylcontact.datasets.grid import grid_from
from cylcontact.datasets.materials_table import MaterialRow
from cylcontact.fitting.result import FitResult
from cylcontact.laws import ContactLaw, Enhanced, Johnson, difference_percent
from cylcontact.limits import johnson_limit_load, yield_load
from cylcontact.reports.claims.domain import (
    ELASTIC,
    JOHNSON_ONLY,
    PRACTICAL,
    YIELD,
    clearance_pair,
    origins,
)
from cylcontact.reports.claims.power_fits import TRAINING_DR
from cylcontact.reports.contours import RIM, Frame, draw_contours, label_contours, new_map
from cylcontact.reports.drawing import Drawing
from cylcontact.reports.style import plain_number

POINTS = (161, 81)  # along ΔR and along the load
FRAME = Frame(
    x=PRACTICAL.clearances,
    y=PRACTICAL.loads,
    x_ticks=(0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2),
    y_ticks=(10, 20, 50, 100, 200, 500, 1000),
    x_label=r"radial clearance $\Delta R$ (mm)",
    y_label="load (N/mm)",
)
NOTE_HEIGHT = 1.025  # of the notes above the frame, in heights of it
BEYOND_GREY = "0.72"


def published_map(row: MaterialRow) -> Drawing:
    """Map the difference from Johnson's law with the published coefficients.

    Parameters
    ----------
    row : MaterialRow
        The material of both bodies.

    Returns
    -------
    Drawing

    Examples
    --------
    >>> from cylcontact import Material
    >>> origin = {"E_GPa": "paper", "nu": "paper", "yield_stress_MPa": "assumed"}
    >>> row = MaterialRow(Material("steel", 200e3, 0.3, 250.0), origin, "")
    >>> print(f"{published_map(row).headline['highest difference, %']:.2f} %")
    33.68 %
    """
    fitted_from = TRAINING_DR["internal"][0]
    return _difference_map(row, Enhanced(), "published coefficients", fitted_from)


def refit_map(row: MaterialRow, result: FitResult) -> Drawing:
    """Map the difference from Johnson's law with refitted coefficients.

    Parameters
    ----------
    row : MaterialRow
        The material of both bodies.
    result : FitResult
        For internal contact.

    Returns
    -------
    Drawing
    """
    values = ", ".join(f"{name} = {value:.6g}" for name, value in result.coefficients.items())
    fitted_from = float(grid_from(result.settings["dataset"], result.name).dR.min())
    drawing = _difference_map(row, Enhanced(result.coefficients), "refit coefficients", fitted_from)
    return replace(
        drawing, caption=f"{drawing.caption} Coefficients of the fit {result.name!r}: {values}."
    )


def map_table(row: MaterialRow, law: ContactLaw) -> pd.DataFrame:
    """Evaluate a law and Johnson's over the window of the maps.

    Where Johnson's law ends inside the window, the loads end there too, so that the map is
    filled exactly to that line and the table holds no empty cells.

    Parameters
    ----------
    row : MaterialRow
        The material of both bodies.
    law : ContactLaw
        The law that is judged, for internal contact.

    Returns
    -------
    pandas.DataFrame
        Columns dR_mm, load_N_per_mm, penetration_mm, johnson_penetration_mm,
        difference_percent and yield_load_N_per_mm, clearance by clearance.

    Examples
    --------
    >>> from cylcontact import Material
    >>> row = MaterialRow(Material("steel", 207e3, 0.3, 250.0), {}, "")
    >>> print(map_table(row, Enhanced())["difference_percent"].abs().max().round(1))
    31.6
    """
    along_dR, along_load = (np.linspace(0.0, 1.0, count) for count in POINTS)
    dR, load = np.broadcast_arrays(
        *JOHNSON_ONLY.point(along_dR[:, np.newaxis], along_load, row.material)
    )
    pair = clearance_pair(dR, row.material, PRACTICAL.R_i)
    columns = {
        "dR_mm": dR,
        "load_N_per_mm": load,
        "penetration_mm": law.penetration(load, pair),
        "johnson_penetration_mm": Johnson().penetration(load, pair),
        "difference_percent": difference_percent(law, Johnson(), load, pair),
        "yield_load_N_per_mm": yield_load(pair),
    }
    return pd.DataFrame({name: values.ravel() for name, values in columns.items()})


def _difference_map(
    row: MaterialRow, law: ContactLaw, coefficients: str, fitted_from: float
) -> Drawing:
    """Map the difference of a law's penetration from Johnson's over clearance and load."""
    table = map_table(row, law)
    dR, load, difference = (
        table[name].to_numpy().reshape(POINTS)
        for name in ("dR_mm", "load_N_per_mm", "difference_percent")
    )
    clearances = dR[:, 0]
    pair = clearance_pair(clearances, row.material, PRACTICAL.R_i)
    figure, axes = new_map(
        FRAME, f"{_title(row)}: {coefficients}", "difference of penetration, Eq 9 (%)"
    )
    lines = draw_contours(axes, dR, load, difference)
    _shade_beyond_johnson(axes, clearances, johnson_limit_load(pair))
    _mark_fitted_range(axes, fitted_from)
    _draw_yield_line(axes, clearances, yield_load(pair))
    figure.draw_without_rendering()
    label_contours(axes, lines, _keep_clear(fitted_from))
    _label_yield_line(axes, clearances, yield_load(pair))
    return Drawing(
        figure, table, _headline(table, fitted_from), _caption(row, coefficients, fitted_from)
    )


def _shade_beyond_johnson(axes: Axes, dR: FloatArray, limit: FloatArray) -> None:
    """Shade and label the region in which Johnson's law gives no penetration (Eq 8)."""
    ceiling = FRAME.y[1]
    if limit[0] >= ceiling:
        return
    axes.fill_between(
        dR,
        np.minimum(limit, ceiling),
        ceiling,
        facecolor=BEYOND_GREY,
        edgecolor="0.4",
        hatch="xxxxx",
        linewidth=0,
    )
    axes.plot(dR, limit, "-", color="black", linewidth=0.8, marker="")
    axes.annotate(
        "beyond Johnson's law",
        xy=(FRAME.x[0] * 1.04, ceiling * 0.96),
        xytext=(0.05, NOTE_HEIGHT),
        textcoords="axes fraction",
        arrowprops={
            "arrowstyle": "-|>",
            "facecolor": "black",
            "linewidth": 0.6,
            "mutation_scale": 5,
            "relpos": (0.0, 0.4),
            "shrinkB": 0,
        },
    )


def _mark_fitted_range(axes: Axes, fitted_from: float) -> None:
    """Mark the clearance from which on the coefficients were fitted, unless all were."""
    if fitted_from <= FRAME.x[0]:
        return
    axes.axvline(fitted_from, color="0.25", linewidth=0.8, linestyle=":", marker="")
    axes.text(
        fitted_from * 1.03,
        FRAME.y[0] * 1.06,
        f"fitted from {plain_number(fitted_from)} mm on",
        rotation=90,
        path_effects=[RIM],
    )


def _keep_clear(fitted_from: float) -> FloatArray:
    """Return points along the note on the fitted range, for contour labels to avoid."""
    loads = np.geomspace(FRAME.y[0], 3.5 * FRAME.y[0], 6)
    return np.column_stack([np.full_like(loads, 1.06 * fitted_from), loads])


def _draw_yield_line(axes: Axes, dR: FloatArray, limit: FloatArray) -> None:
    """Draw the load at which the contact yields, ticks on the side where it does."""
    comb = TickedStroke(spacing=6, angle=90, length=0.6, linewidth=0.8, foreground="black")
    rim = withStroke(linewidth=3.2, foreground="white")
    axes.plot(dR, limit, "-", color="black", linewidth=1.6, marker="", path_effects=[rim, comb])


def _label_yield_line(axes: Axes, dR: FloatArray, limit: FloatArray) -> None:
    """Write along the yield line, on the side that yields, what it is; or that there is none."""
    shown = np.flatnonzero(limit < FRAME.y[1])
    words = "yield line" if shown.size else "no yield in this window"
    note = f"{words} for $R_i$ = {PRACTICAL.R_i:g} mm"
    axes.text(1.0, NOTE_HEIGHT, note, transform=axes.transAxes, ha="right")
    if shown.size == 0:
        return
    ends, middle = shown[[0, -1]], shown[shown.size // 2]
    (x0, y0), (x1, y1) = axes.transData.transform(np.column_stack([dR[ends], limit[ends]]))
    axes.annotate(
        "yields",
        xy=(dR[middle], limit[middle]),
        xytext=(4, 4),
        textcoords="offset points",
        rotation=np.degrees(np.arctan2(y1 - y0, x1 - x0)),
        rotation_mode="anchor",
        ha="center",
        va="bottom",
        path_effects=[RIM],
    )


def _headline(table: pd.DataFrame, fitted_from: float) -> dict[str, float]:
    """Return the extremes over the map, and over the part of it that stays elastic."""
    difference = table["difference_percent"]
    practical = table[table["load_N_per_mm"] <= table["yield_load_N_per_mm"]]
    magnitude = practical["difference_percent"].abs()
    return {
        "lowest difference, %": float(difference.min()),
        "highest difference, %": float(difference.max()),
        "largest |difference| in the practical domain, %": float(magnitude.max()),
        "share of the practical domain below 8 %": _share_below(magnitude, 8),
        "share below 8 % in the fitted part of the practical domain": _share_below(
            magnitude[practical["dR_mm"] >= fitted_from], 8
        ),
    }


def _share_below(magnitude: pd.Series[float], bound: float) -> float:
    """Return the share of a logarithmic map that stays below a bound."""
    return float((magnitude < bound).mean())


def _title(row: MaterialRow) -> str:
    """Return the material with its elastic constants."""
    E = plain_number(float(row.material.E) / 1e3)
    return f"{row.material.name}, $E$ = {E} GPa, $\\nu$ = {row.material.nu:g}"


def _caption(row: MaterialRow, coefficients: str, fitted_from: float) -> str:
    """Say what a map shows, what was chosen and what is assumed."""
    material = row.material
    told = origins({material.name: row}, (material.name,), ELASTIC, YIELD)
    return (
        "Penetration of the enhanced law (Eqs 5-6) less Johnson's (Eq 1) at equal load, in percent "
        "of Johnson's (Eq 9), against radial clearance (mm) and load per unit length (N/mm); "
        f"internal contact, both bodies of {material.name}, {coefficients}. They were fitted at "
        f"clearances from {plain_number(fitted_from)} mm on; below, the law is extrapolated. "
        "Contours are solid above zero and dashed below; levels and colours are those of all "
        "these maps. Grey: beyond the largest load of Johnson's law (Eq 8). Ticked line: the peak "
        f"pressure (Eq 7) in a hole of {PRACTICAL.R_i:g} mm radius reaches the yield stress of "
        f"{material.yield_stress:g} MPa, ticks where it exceeds it; the radius is our choice. "
        f"Material values that are not the paper's: {told}."
    )
