"""Maps of the difference between the enhanced law and a reference: Figs 10 to 14, r, p and c."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from cylcontact.arrays import as_floats
from cylcontact.datasets.grid import grid_from
from cylcontact.fitting.result import FitResult
from cylcontact.laws import ContactLaw, Enhanced, Johnson, difference_percent, reference_law
from cylcontact.limits import yield_load
from cylcontact.materials import MaterialRow
from cylcontact.plots.figure import Drawing, plain_number
from cylcontact.plots.maps import draw_contours, label_contours, new_map
from cylcontact.reports.claims.domain import (
    ELASTIC,
    JOHNSON_ONLY,
    PRACTICAL,
    YIELD,
    clearance_pair,
    origins,
)
from cylcontact.reports.claims.power_fits import TRAINING_DR
from cylcontact.reports.map_marks import (
    FRAME,
    draw_yield_line,
    keep_clear,
    label_yield_line,
    mark_fitted_range,
    shade_beyond_johnson,
    stack_notes,
)

POINTS = (161, 81)  # along ΔR and along the load
# What the references are called beside the colour scale and in the caption, and where they end.
JUDGES = {
    "johnson": (
        "difference of penetration, Eq 9 (%)",
        "Johnson's (Eq 1)",
        "Grey: beyond the largest load of Johnson's law (Eq 8).",
    ),
    "persson": (
        "difference from Persson's penetration (%)",
        "Persson's conformal solution, its datum matched to Johnson's law at small loads,",
        "No part is grey: Persson's solution, unlike Johnson's law, has no largest load; the "
        "yield line stays Hertz's.",
    ),
}


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
    return _difference_map(row, Enhanced(), Johnson(), "published coefficients", fitted_from)


def refit_map(row: MaterialRow, result: FitResult, label: str = "refit coefficients") -> Drawing:
    """Map the difference with refitted coefficients, from the law that they were fitted to.

    Parameters
    ----------
    row : MaterialRow
        The material of both bodies.
    result : FitResult
        For internal contact, fitted to Johnson's law or to Persson's.
    label : str, optional
        What the title calls the coefficients.

    Returns
    -------
    Drawing
    """
    values = ", ".join(f"{name} = {value:.6g}" for name, value in result.coefficients.items())
    fitted_from = float(grid_from(result.settings["dataset"], result.name).dR.min())
    reference = reference_law(result.reference)
    drawing = _difference_map(row, Enhanced(result.coefficients), reference, label, fitted_from)
    return replace(
        drawing, caption=f"{drawing.caption} Coefficients of the fit {result.name!r}: {values}."
    )


def map_table(
    row: MaterialRow, law: ContactLaw, reference: ContactLaw | None = None
) -> pd.DataFrame:
    """Evaluate a law and its reference over the window of the maps.

    Where Johnson's law is the reference and ends inside the window, the loads end there too, so
    that the map is filled exactly to that line and the table holds no empty cells.

    Parameters
    ----------
    row : MaterialRow
        The material of both bodies.
    law : ContactLaw
        The law that is judged, for internal contact.
    reference : ContactLaw, optional
        The law that it is judged by; left out, Johnson's.

    Returns
    -------
    pandas.DataFrame
        Columns dR_mm, load_N_per_mm, penetration_mm, johnson_penetration_mm (or whatever the
        reference is), difference_percent and yield_load_N_per_mm, clearance by clearance.

    Examples
    --------
    >>> from cylcontact import Material
    >>> row = MaterialRow(Material("steel", 207e3, 0.3, 250.0), {}, "")
    >>> print(map_table(row, Enhanced())["difference_percent"].abs().max().round(1))
    31.6
    """
    judge = reference or Johnson()
    along_dR, along_load = (np.linspace(0.0, 1.0, count) for count in POINTS)
    dR, load = JOHNSON_ONLY.point(along_dR[:, np.newaxis], along_load, row.material)
    pair = clearance_pair(dR, row.material, PRACTICAL.R_i)
    if np.isinf(judge.max_load(pair)).all():
        load = as_floats(np.geomspace(*FRAME.y, POINTS[1]))
    dR, load = np.broadcast_arrays(dR, load)
    pair = clearance_pair(dR, row.material, PRACTICAL.R_i)
    columns = {
        "dR_mm": dR,
        "load_N_per_mm": load,
        "penetration_mm": law.penetration(load, pair),
        f"{judge.name}_penetration_mm": judge.penetration(load, pair),
        "difference_percent": difference_percent(law, judge, load, pair),
        "yield_load_N_per_mm": yield_load(pair),
    }
    return pd.DataFrame({name: values.ravel() for name, values in columns.items()})


def _difference_map(
    row: MaterialRow, law: ContactLaw, reference: ContactLaw, coefficients: str, fitted_from: float
) -> Drawing:
    """Map the difference of a law's penetration from a reference over clearance and load."""
    table = map_table(row, law, reference)
    dR, load, difference = (
        table[name].to_numpy().reshape(POINTS)
        for name in ("dR_mm", "load_N_per_mm", "difference_percent")
    )
    clearances = dR[:, 0]
    pair = clearance_pair(clearances, row.material, PRACTICAL.R_i)
    figure, axes = new_map(
        FRAME,
        f"{_title(row)}: {coefficients}",
        JUDGES[reference.name][0],
    )
    lines = draw_contours(axes, dR, load, difference)
    ends, yields = reference.max_load(pair), yield_load(pair)
    stacked = stack_notes(axes, ends, yields, figure.style.narrow)
    shade_beyond_johnson(axes, clearances, ends)
    mark_fitted_range(axes, fitted_from)
    draw_yield_line(axes, clearances, yields)
    figure.draw_without_rendering()
    label_contours(axes, lines, keep_clear(fitted_from))
    label_yield_line(axes, clearances, yields, stacked)
    caption = _caption(row, reference, coefficients, fitted_from)
    return Drawing(figure, table, _headline(table, fitted_from), caption)


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


def _caption(row: MaterialRow, reference: ContactLaw, coefficients: str, fitted_from: float) -> str:
    """Say what a map shows, what was chosen and what is assumed."""
    material = row.material
    told = origins({material.name: row}, (material.name,), ELASTIC, YIELD)
    _, judge, end = JUDGES[reference.name]
    extrapolated = "; below, the law is extrapolated" if fitted_from > FRAME.x[0] else ""
    return (
        f"Penetration of the enhanced law (Eqs 5-6) less {judge} at equal load, in percent "
        "of the latter (Eq 9), against radial clearance (mm) and load per unit length (N/mm); "
        f"internal contact, both bodies of {material.name}, {coefficients}. They were fitted at "
        f"clearances from {plain_number(fitted_from)} mm on{extrapolated}. "
        "Contours are solid above zero and dashed below; levels and colours are those of all "
        f"these maps. {end} Ticked line: the peak "
        f"pressure (Eq 7) in a hole of {PRACTICAL.R_i:g} mm radius reaches the yield stress of "
        f"{material.yield_stress:g} MPa, ticks where it exceeds it; the radius is our choice. "
        f"Material values that are not the paper's: {told}."
    )
