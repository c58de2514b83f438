"""Figs 10 to 14: how far a law's penetration is from a reference's, over clearance and load.

The paper's five materials are drawn with the published coefficients (figNN), refitted over the
paper's ranges (r), over the practical domain (p), and to conformal contact and judged by it (c).
Any other combination goes by arguments, from the command line

    cylcontact figure maps material="titanium alloy" law=explicit

or from Python, `difference_map(bench, "titanium alloy", law="explicit")`. These draw first yield by
von Mises; Figs 10 to 14 keep the paper's estimate, Hertz's peak pressure equal to the yield stress.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.transforms import blended_transform_factory

from cylcontact.datasets.grid import grid_from
from cylcontact.errors import InputError
from cylcontact.laws import LAWS, ContactLaw, Enhanced, difference_percent, reference_law
from cylcontact.limits import yield_load
from cylcontact.materials import MaterialRow
from cylcontact.plain_text import as_label, brief
from cylcontact.plots import Drawing, new_figure, plot_map
from cylcontact.plots.difference_map import map_grid
from cylcontact.plots.figure import StyledFigure, plain_number
from cylcontact.plots.maps import add_scale
from cylcontact.plots.style import current_style
from cylcontact.reports.bench import Bench
from cylcontact.yield_search import Criterion

from .paper import (
    COMPARED_CLEARANCES,
    ELASTIC,
    HOLE_RADIUS,
    LOADS,
    MATERIALS,
    TRAINING_DR,
    YIELD,
    origins,
)

# For each reference: its name on the colour scale, in the caption, and its end in the note.
REFERENCE_WORDS = {
    "johnson": (
        "Johnson's law",
        "Johnson's (Eq 1)",
        "Loads beyond the largest of Johnson's law (Eq 8) are hatched.",
    ),
    "persson": (
        "Persson's solution",
        "Persson's conformal solution",
        "No part is hatched: Persson's solution, unlike Johnson's law, has no largest load. Its "
        "datum is matched to Johnson's law at small loads.",
    ),
}
CLEARANCES = COMPARED_CLEARANCES
WINDOW: dict[str, Any] = {"dR": CLEARANCES, "load": LOADS, "R_i": HOLE_RADIUS}
# In sizes of the font: the margins left, right, below without the key, and above a map; the height
# of a line of the key, and its distance from the map.
MARGINS, KEY_LINE, KEY_BELOW = (5.2, 6.0, 3.7, 3.4), 1.5, 3.2

# For each criterion of the yield line: what the headline calls the loads up to it, and what on it
# reaches the yield stress.
CRITERION_WORDS: dict[Criterion, tuple[str, str]] = {
    "Hertz": ("practical domain", "Hertz's peak pressure (Eq 7)"),
    "von Mises": ("elastic domain", "the largest von Mises stress in either body"),
}

YIELDING = "; the ticks are on the side where it exceeds it"

# The fit of each variant of the paper's maps, and its name in the title.
VARIANTS = {
    "": ("enhanced", ""),
    "r": ("internal", "refitted coefficients"),
    "p": ("practical", "refitted over this map's range"),
    "c": ("conformal", "refitted to Persson's solution"),
}


@dataclass(frozen=True)
class MappedLaw:
    """A law on a map, with the words for its caption and title."""

    law: ContactLaw
    reference: ContactLaw
    name: str
    label: str
    fitted_from: float | None = None  # the smallest clearance of the fit in mm
    coefficients: str = ""


def draw(bench: Bench, *, material: str, law: str = "enhanced", reference: str = "") -> Drawing:
    """Draw a map for a material, by arguments on the command line."""
    if law not in LAWS and not bench.result_file(f"{law}.json").is_file():
        rule = f"is neither a law nor a fit result in {bench.results_folder}"
        raise InputError("maps", "law", law, rule, f"choose {', '.join(LAWS)}, or fit it")
    return difference_map(bench, material, law, reference)


def difference_map(
    bench: Bench,
    material: str,
    law: str = "enhanced",
    reference: str = "",
    label: str = "",
    criterion: Criterion = "von Mises",
) -> Drawing:
    """Map the difference of a law's penetration from a reference over clearance and load.

    Parameters
    ----------
    bench : Bench
        Where the material and the fit result are looked up.
    material : str
        Of both bodies: one that ships, or one of the bench's own table.
    law : str, optional
        A law's name, such as "explicit" ("enhanced" has the published coefficients), or the name
        of a fit result for internal contact, such as "practical". A fit goes before a law of the
        same name.
    reference : str, optional
        "johnson" or "persson"; by default the law that the fit was made to, or Johnson's.
    label : str, optional
        Name of a fit result's coefficients in the title.
    criterion : {"von Mises", "Hertz"}
        Of the yield line; "Hertz" is the paper's estimate.

    Returns
    -------
    Drawing

    Raises
    ------
    InputError
        If the material, the law or the reference is unknown, the material has no yield stress,
        or the law is for external contact.
    """
    row = bench.material(material)
    if row.material.yield_stress is None:
        rule, remedy = "has no yield stress, which the map needs", "add it to the table"
        raise InputError("maps", "material", material, rule, remedy)
    return _draw_map(row, _mapped_law(bench, law, reference, label), criterion)


def _mapped_law(bench: Bench, law: str, reference: str = "", label: str = "") -> MappedLaw:
    """Return the law of a name or a fit result, with its words for the map."""
    if reference and reference not in REFERENCE_WORDS:
        remedy = f"choose {', '.join(REFERENCE_WORDS)}"
        raise InputError("maps", "reference", reference, "is not a reference of the maps", remedy)
    default = reference_law(reference or "johnson")
    if law == "enhanced":
        label, fitted_from = "published coefficients", TRAINING_DR["internal"][0]
        own = f"the enhanced law (Eqs 5-6; {label})"
        return MappedLaw(Enhanced(), default, own, label, fitted_from)
    if law in LAWS and not bench.result_file(f"{law}.json").is_file():
        return MappedLaw(LAWS[law](), default, f"the {law} law", f"{law} law")
    result = bench.result(law)
    if result.contact != "internal" or "dataset" not in result.settings:
        rule, remedy = "is not a fit on a grid of internal contacts", "choose one that is"
        raise InputError("maps", "law", law, rule, remedy)
    label = label or f"fit {result.name!r}"
    source = f"Eqs 5-6; {label}" if result.law == "enhanced" else label
    values = ", ".join(f"{name} = {value:.6g}" for name, value in result.coefficients.items())
    return MappedLaw(
        result.to_law(),
        reference_law(reference or result.reference),
        f"the {result.law} law ({source})",
        label,
        float(grid_from(result.settings["dataset"], result.name).dR.min()),
        f"Coefficients of the fit {result.name!r}: {values}.",
    )


def _map_table(
    row: MaterialRow, law: ContactLaw, reference: ContactLaw, criterion: Criterion
) -> pd.DataFrame:
    """Evaluate a law, its reference and the yield load at the points of the map."""
    pair, load = map_grid(reference, row.material, **WINDOW)
    columns = {
        "dR_mm": pair.dR,
        "load_N_per_mm": load,
        "penetration_mm": law.penetration(load, pair),
        f"{reference.name}_penetration_mm": reference.penetration(load, pair),
        "difference_percent": difference_percent(law, reference, load, pair),
        "yield_load_N_per_mm": yield_load(pair, criterion),
    }
    return pd.DataFrame(
        {name: np.broadcast_to(values, load.shape).ravel() for name, values in columns.items()}
    )


def _draw_map(row: MaterialRow, mapped: MappedLaw, criterion: Criterion) -> Drawing:
    """Draw the map."""
    table = _map_table(row, mapped.law, mapped.reference, criterion)
    fitted_from = mapped.fitted_from or CLEARANCES[0]
    figure = new_figure("middle", 115.0 if current_style().narrow else 106.0)
    axes = _map_axes(figure)
    axes.set_title(f"{_title(row)}\n{mapped.label}")
    add_scale(figure, axes, f"difference from {REFERENCE_WORDS[mapped.reference.name][0]} (%)")
    if fitted_from > CLEARANCES[0]:
        words = f"coefficients fitted from {plain_number(fitted_from)} mm on"
        axes.axvline(fitted_from, color="black", linestyle=":", marker="", label=words)
    plot_map(
        mapped.law,
        mapped.reference,
        row.material,
        criterion=criterion,
        colorbar=False,
        ax=axes,
        **WINDOW,
    )
    below = -KEY_BELOW * rcParams["font.size"] / (axes.bbox.height * 72 / figure.dpi)
    # In the middle of the page, not of the axes, beside which the scale is.
    place = blended_transform_factory(figure.transFigure, axes.transAxes)
    where = {"bbox_to_anchor": (0.5, below), "bbox_transform": place}
    figure.legend(loc="upper center", ncols=2, borderaxespad=0.0, **where)
    headline = _headline(table, fitted_from, CRITERION_WORDS[criterion][0])
    method = _method(row, mapped, criterion, table)
    return Drawing(figure, table, headline, _caption(row, mapped), method)


def _map_axes(figure: StyledFigure) -> Axes:
    """Add axes that have the same place in every map of a style, with room for a key below.

    A layout by the content would give maps in one row of a page unequal heights.
    """
    figure.set_layout_engine()
    em = rcParams["font.size"] / 72
    width, height = figure.get_size_inches()
    left, right, bottom, top = (em * margin for margin in MARGINS)
    bottom += em * KEY_LINE * (3 if figure.style.narrow else 2)
    figure.subplots_adjust(left / width, bottom / height, 1 - right / width, 1 - top / height)
    axes: Axes = figure.subplots()
    return axes


def _headline(table: pd.DataFrame, fitted_from: float, domain: str) -> dict[str, float]:
    """Return the extremes over the map, and over the part of it below the yield line."""
    difference = table["difference_percent"]
    elastic = table[table["load_N_per_mm"] <= table["yield_load_N_per_mm"]]
    magnitude = elastic["difference_percent"].abs()
    return {
        "lowest difference, %": float(difference.min()),
        "highest difference, %": float(difference.max()),
        f"largest |difference| in the {domain}, %": float(magnitude.max()),
        f"share of the {domain} below 8 %": _share_below(magnitude, 8),
        f"share below 8 % in the fitted part of the {domain}": _share_below(
            magnitude[elastic["dR_mm"] >= fitted_from], 8
        ),
    }


def _share_below(magnitude: pd.Series[float], bound: float) -> float:
    """Return the share of a logarithmic map that stays below a bound."""
    return float((magnitude < bound).mean())


def _title(row: MaterialRow) -> str:
    """Return the material with its elastic constants."""
    E = plain_number(float(row.material.E) / 1e3)
    return f"{as_label(row.material.name)}, $E$ = {E} GPa, $\\nu$ = {row.material.nu:g}"


def _caption(row: MaterialRow, mapped: MappedLaw) -> str:
    """Return the caption."""
    assumed = row.provenance["yield_stress_MPa"] == "assumed"
    return (
        f"Penetration of {mapped.name} less {REFERENCE_WORDS[mapped.reference.name][1]} at equal "
        "load, in percent of the latter (Eq 9), against radial clearance (mm) and load per unit "
        f"length (N/mm), for a pin in a hole of {brief(row.material.name)}. Contours are dashed "
        f"below zero.{' Yield stress assumed.' * assumed}"
    )


def _method(row: MaterialRow, mapped: MappedLaw, criterion: Criterion, table: pd.DataFrame) -> str:
    """Return how the map was made."""
    material = row.material
    origin = origins({material.name: row}, (material.name,), ELASTIC, YIELD)
    yields = bool((table["yield_load_N_per_mm"] < LOADS[1]).any())
    sentences = [
        f"Internal contact, both bodies of {brief(material.name)}.",
        *_calibration(mapped),
        "Figs 10 to 14 and all maps like them have the same levels and colours; the arrows of the "
        "scale are for values beyond its ends.",
        REFERENCE_WORDS[mapped.reference.name][2],
        f"{'On the ticked line' if yields else 'Only at loads above this map'} "
        f"{CRITERION_WORDS[criterion][1]}, with a hole of {HOLE_RADIUS:g} mm radius, reaches the "
        f"yield stress of {material.yield_stress:g} MPa{YIELDING * yields}.",
        "The radius is our choice.",
        "The criterion is the paper's, not first yield by von Mises." * (criterion == "Hertz"),
        f"Material values that are not the paper's: {origin}." if origin else "",
        mapped.coefficients,
    ]
    return " ".join(filter(None, sentences))


def _calibration(mapped: MappedLaw) -> Iterator[str]:
    """Return the sentences of the note on the clearances of the calibration."""
    if mapped.fitted_from is not None:
        start = plain_number(mapped.fitted_from)
        yield f"The coefficients were fitted at clearances from {start} mm on."
        if mapped.fitted_from > CLEARANCES[0]:
            yield "Left of the dotted line the law is extrapolated."


FIGURES: dict[str, Callable[[Bench], Drawing]] = {
    f"fig{number}{variant}": partial(
        difference_map, material=material, law=law, label=label, criterion="Hertz"
    )
    for number, material in enumerate(MATERIALS, start=10)
    for variant, (law, label) in VARIANTS.items()
}
