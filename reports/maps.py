"""Figs 10 to 14: how far a law's penetration is from a reference's, over clearance and load.

The paper's five materials have a map each with the published coefficients, and a strip of five maps
for each other fit of them. Any other combination goes by arguments, from the command line

    cylcontact figure maps material="titanium alloy" law=explicit

or from Python, `difference_map(bench, "titanium alloy", law="explicit")`. First yield is by von
Mises: the paper's estimate, Hertz's peak pressure equal to the yield stress, is low for wide
clearances and unsafe for close ones.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from cylcontact.bodies.material import MaterialRow
from cylcontact.datasets.grid import grid_from
from cylcontact.laws import LAWS, ContactLaw, Enhanced, difference_percent, reference_law
from cylcontact.limits import yield_load
from cylcontact.plots import Drawing, new_figure, plot_map
from cylcontact.plots.difference_map import map_grid
from cylcontact.plots.figure import panel_title, plain_log, plain_number
from cylcontact.plots.maps import add_scale
from cylcontact.reports.bench import Bench
from cylcontact.support.errors import InputError
from cylcontact.support.plain_text import as_label, brief

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
YIELDING = "; the ticks are on the side where it exceeds it"
# The strips: the fit, the name of its coefficients, and what the strip shows.
STRIPS = {
    "fig_maps_refit": ("internal", "refitted coefficients"),
    "fig_maps_practical": ("practical", "refitted over this map's range"),
    "fig_maps_conformal": ("conformal", "refitted to Persson's solution"),
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
) -> Drawing:
    """Map the difference of a law's penetration from a reference over clearance and load.

    The law is one of the package by its name ("enhanced" has the published coefficients), or a fit
    result for internal contact by its own; the reference is by default the one of the fit.
    """
    row = _row(bench, material)
    mapped = _mapped_law(bench, law, reference, label)
    figure = new_figure("middle", 98.0)
    axes = figure.subplots()
    axes.set_title(f"{_title(row)}\n{mapped.label}")
    _draw_map(axes, row, mapped)
    add_scale(figure, axes, f"difference from {REFERENCE_WORDS[mapped.reference.name][0]} (%)")
    figure.legend(loc="outside lower center", ncols=2)
    table = _map_table(row, mapped.law, mapped.reference)
    headline = _headline(table, mapped.fitted_from or CLEARANCES[0])
    return Drawing(figure, table, headline, _caption([row], mapped), _method([row], mapped, table))


def strip(bench: Bench, fit: str, label: str) -> Drawing:
    """Map a fit for the paper's five materials side by side."""
    rows = [_row(bench, material) for material in MATERIALS]
    mapped = _mapped_law(bench, fit, label=label)
    figure = new_figure("full", 66.0)
    panels = figure.subplots(1, len(rows), sharex=True, sharey=True)
    for number, (axes, row) in enumerate(zip(panels, rows, strict=True)):
        _draw_map(axes, row, mapped, labels=False)
        panel_title(axes, number, as_label(row.material.name))
        axes.label_outer()
        plain_log(axes, "x", (0.01, 0.1, 1.0))
        axes.set(xlim=CLEARANCES, xlabel=r"$\Delta R$ (mm)")
    add_scale(figure, list(panels), f"from {REFERENCE_WORDS[mapped.reference.name][0]} (%)")
    keys = dict(zip(*panels[-1].get_legend_handles_labels()[::-1], strict=True))
    figure.legend(keys.values(), keys.keys(), loc="outside lower center", ncols=3)
    tables = {row.material.name: _map_table(row, mapped.law, mapped.reference) for row in rows}
    headline = {
        f"{name}: {what}": value
        for name, table in tables.items()
        for what, value in _headline(table, mapped.fitted_from or CLEARANCES[0]).items()
    }
    table = pd.concat(tables, names=["material"]).reset_index("material").reset_index(drop=True)
    return Drawing(figure, table, headline, _caption(rows, mapped), _method(rows, mapped, table))


def _row(bench: Bench, material: str) -> MaterialRow:
    """Return a material that has a yield stress."""
    row = bench.material(material)
    if row.material.yield_stress is None:
        rule, remedy = "has no yield stress, which the map needs", "add it to the table"
        raise InputError("maps", "material", material, rule, remedy)
    return row


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


def _map_table(row: MaterialRow, law: ContactLaw, reference: ContactLaw) -> pd.DataFrame:
    """Evaluate a law, its reference and the yield load at the points of the map."""
    pair, load = map_grid(reference, row.material, **WINDOW)
    columns = {
        "dR_mm": pair.dR,
        "load_N_per_mm": load,
        "penetration_mm": law.penetration(load, pair),
        f"{reference.name}_penetration_mm": reference.penetration(load, pair),
        "difference_percent": difference_percent(law, reference, load, pair),
        "yield_load_N_per_mm": yield_load(pair),
    }
    return pd.DataFrame(
        {name: np.broadcast_to(values, load.shape).ravel() for name, values in columns.items()}
    )


def _draw_map(axes: Axes, row: MaterialRow, mapped: MappedLaw, labels: bool = True) -> None:
    """Draw a map of a material, and from where on the coefficients are fitted."""
    if mapped.fitted_from is not None and mapped.fitted_from > CLEARANCES[0]:
        words = f"coefficients fitted from {plain_number(mapped.fitted_from)} mm on"
        axes.axvline(mapped.fitted_from, color="black", linestyle=":", marker="", label=words)
    own: dict[str, Any] = {"colorbar": False, "labels": labels, "ax": axes}
    plot_map(mapped.law, mapped.reference, row.material, **own, **WINDOW)


def _headline(table: pd.DataFrame, fitted_from: float) -> dict[str, float]:
    """Return the extremes over the map, and over the part of it below first yield."""
    difference = table["difference_percent"]
    elastic = table[table["load_N_per_mm"] <= table["yield_load_N_per_mm"]]
    magnitude = elastic["difference_percent"].abs()
    return {
        "lowest difference, %": float(difference.min()),
        "highest difference, %": float(difference.max()),
        "largest |difference| before first yield, %": float(magnitude.max()),
        "share before first yield below 8 %": _share_below(magnitude, 8),
        "share before first yield below 8 % in the fitted part": _share_below(
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


def _caption(rows: Sequence[MaterialRow], mapped: MappedLaw) -> str:
    """Return the caption."""
    assumed = any(row.provenance["yield_stress_MPa"] == "assumed" for row in rows)
    of = brief(rows[0].material.name) if len(rows) == 1 else "one of five materials"
    return (
        f"Penetration of {mapped.name} less {REFERENCE_WORDS[mapped.reference.name][1]} at equal "
        "load, in percent of the latter (Eq 9), against radial clearance (mm) and load per unit "
        f"length (N/mm), for a pin in a hole of {of}. Contours are dashed "
        f"below zero.{' Yield stress assumed.' * assumed}"
    )


def _method(rows: Sequence[MaterialRow], mapped: MappedLaw, table: pd.DataFrame) -> str:
    """Return how the maps were made."""
    names = [row.material.name for row in rows]
    origin = origins(dict(zip(names, rows, strict=True)), names, ELASTIC, YIELD)
    yields = bool((table["yield_load_N_per_mm"] < LOADS[1]).any())
    stresses = ", ".join(f"{row.material.yield_stress:g}" for row in rows)
    sentences = [
        f"Internal contact, both bodies of {brief(names[0])}." if len(rows) == 1 else "",
        *_calibration(mapped),
        "Figs 10 to 14 and all maps like them have the same levels and colours; the arrows of the "
        "scale are for values beyond its ends.",
        REFERENCE_WORDS[mapped.reference.name][2],
        f"{'On the ticked line' if yields else 'Only at loads above this map'} the largest von "
        f"Mises stress in either body, with a hole of {HOLE_RADIUS:g} mm radius, reaches the yield "
        f"stress ({stresses} MPa){YIELDING * yields}. The radius is our choice.",
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
    f"fig{number}": partial(difference_map, material=material)
    for number, material in enumerate(MATERIALS, start=10)
}
FIGURES |= {name: partial(strip, fit=fit, label=label) for name, (fit, label) in STRIPS.items()}
