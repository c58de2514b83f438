"""Figs 10 to 14: how far a law's penetration is from another's, against clearance and load."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.fitting.results import LawFit
from cylcontact.laws import LAWS, ContactLaw
from cylcontact.plots.difference_map import map_table, plot_map
from cylcontact.plots.figure import legend_below, new_figure, panel_title, panels
from cylcontact.plots.maps import add_scale
from cylcontact.support.errors import InputError

from .paper import FITTED_FROM, MATERIALS, material_of


def fig10(result: str = "published") -> tuple[Figure, pd.DataFrame]:
    """Penetration of the enhanced law less Johnson's at equal load, in percent of Johnson's (Eq 9),
    against radial clearance and load per unit length; a pin in a hole, ceramics. Coefficients:
    {result}. Ticked line: first yield in a hole of 10 mm, by von Mises with the assumed tensile
    strength for the yield stress. Dotted: where the clearances of the paper's fit begin.
    """
    return paper_map("ceramics", result)


def fig11(result: str = "published") -> tuple[Figure, pd.DataFrame]:
    """As Fig 10, high-strength steel, for which nothing yields at these loads. Coefficients:
    {result}. Dotted: where the clearances of the paper's fit begin.
    """
    return paper_map("high-strength steel", result)


def fig12(result: str = "published") -> tuple[Figure, pd.DataFrame]:
    """As Fig 10, low-carbon steel. Coefficients: {result}. Ticked line: first yield by von Mises in
    a hole of 10 mm, for an assumed yield stress. Dotted: where the clearances of the paper's fit
    begin.
    """
    return paper_map("low-carbon steel", result)


def fig13(result: str = "published") -> tuple[Figure, pd.DataFrame]:
    """As Fig 10, titanium alloy, for which nothing yields at these loads. Coefficients: {result}.
    Hatched: beyond the end of Johnson's law (Eq 8). Dotted: where the clearances of the paper's
    fit begin.
    """
    return paper_map("titanium alloy", result)


def fig14(result: str = "published") -> tuple[Figure, pd.DataFrame]:
    """As Fig 10, aluminium alloy. Coefficients: {result}. Hatched: beyond the end of Johnson's law
    (Eq 8). Ticked line: first yield by von Mises in a hole of 10 mm, for an assumed yield stress.
    Dotted: where the clearances of the paper's fit begin.
    """
    return paper_map("aluminium alloy", result)


def paper_map(material: str, result: str) -> tuple[Figure, pd.DataFrame]:
    """Draw a map of the paper with its coefficients, or with those of a fit."""
    law = LAWS["enhanced"]() if result == "published" else law_of(result)
    return one_map(law, LAWS["johnson"](), material, FITTED_FROM)


def fig_map(
    material: str = "low-carbon steel", law: str = "explicit", reference: str = "johnson"
) -> tuple[Figure, pd.DataFrame]:
    """Penetration by the law {law} less that by {reference} at equal load, in percent of the
    latter, against radial clearance and load per unit length; a pin in a hole, {material}. Hatched,
    if any: beyond the end of {reference}. Ticked line, if any: first yield by von Mises in a hole
    of 10 mm.
    """
    return one_map(law_of(law), law_of(reference), material)


def fig_refit(result: str = "internal") -> tuple[Figure, pd.DataFrame]:
    """The maps of Figs 10 to 14 for refitted coefficients ({result}): penetration of the enhanced
    law less Johnson's at equal load, in percent (Eq 9). Hatched: beyond the end of Johnson's law.
    """
    law, johnson, tables = law_of(result), LAWS["johnson"](), {}
    figure, parts = panels(
        len(MATERIALS), 52.0, least_mm=34.0, below_mm=8.0, sharex=True, sharey=True
    )
    drawn = [axes for (axes,) in parts]
    for number, (axes, body) in enumerate(zip(drawn, MATERIALS.values(), strict=True)):
        plot_map(law, johnson, body, colorbar=False, labels=False, ax=axes)
        panel_title(axes, number, body.name)
        thin_ticks(axes)
        tables[body.name] = map_table(law, johnson, body)
    add_scale(figure, drawn, "from Johnson's law (%)")
    legend_below(drawn[-1])
    return figure, pd.concat(tables, names=["material"]).reset_index("material")


def one_map(
    law: ContactLaw, reference: ContactLaw, material: str, fitted_from: float | None = None
) -> tuple[Figure, pd.DataFrame]:
    """Draw the map of a material over a column, with its name as the title."""
    body = material_of(material)
    figure = new_figure("column", 84.0)
    axes = figure.subplots()
    if fitted_from is not None:
        words = f"the paper's fit begins, {fitted_from:g} mm"
        axes.axvline(fitted_from, color="black", linestyle=":", marker="", label=words)
    plot_map(law, reference, body, ax=axes)
    axes.set_title(f"{body.name}, $E$ = {float(body.E) / 1e3:g} GPa, $\\nu$ = {body.nu:g}")
    legend_below(axes, 1)
    return figure, map_table(law, reference, body)


def thin_ticks(axes: Axes) -> None:
    """Label a small panel at its outer sides alone, with few clearances."""
    axes.set_xlabel(r"$\Delta R$ (mm)")
    axes.label_outer()
    axes.set_xticks([0.01, 0.1, 1.0], ["0.01", "0.1", "1"])


def law_of(name: str) -> ContactLaw:
    """Return a law by its name, or that of a fit by the name or the path of its result."""
    if name in LAWS:
        return LAWS[name]()
    file = Path(name) if name.endswith(".json") else Path(f"fitting/results/{name}.json")
    if not file.is_file():
        remedy = f"choose {', '.join(LAWS)}, or fit it"
        raise InputError("figure", "law", name, "is neither a law nor a fit result", remedy)
    return LawFit.read(file).to_law()


FIGURES = {
    "fig10": fig10,
    "fig11": fig11,
    "fig12": fig12,
    "fig13": fig13,
    "fig14": fig14,
    "fig_map": fig_map,
    "fig_refit": fig_refit,
}
