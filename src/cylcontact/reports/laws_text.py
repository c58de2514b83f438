"""The tables of `laws_table` as text for a terminal."""

from __future__ import annotations

import numpy as np
import pandas as pd

from cylcontact.pair import CylinderPair
from cylcontact.reports import laws_table

NOTHING = "-"


def text(pair: CylinderPair, load: float) -> str:
    """Return the comparison, the deviations, Johnson's departures and the explicit law's error."""
    table = laws_table.comparison(pair, load)
    contact = pair.contact
    truth = laws_table.TRUTH[contact].name
    parts = [
        f"{contact} contact, ΔR = {float(pair.dR):g} mm, E* = {float(pair.E_star):.2f} MPa, "
        f"f = {load:g} N/mm, φ = f/(E*·ΔR) = {load / float(pair.E_star * pair.dR):.6f}",
        _comparison(table),
        f"penetration against {truth}'s at equal load, percent, at φ =",
        _deviations(laws_table.deviations(pair)),
    ]
    if contact == "internal":
        parts += [
            "where johnson's penetration is too low against persson's: φ, and the load in N/mm "
            "at ΔR in mm; the last line is the end of johnson's law (Eq 8)",
            _departures(laws_table.departures(pair.material_i)),
        ]
    return "\n\n".join([*parts, _explicit()]) + "\n"


def number(value: float, form: str) -> str:
    """Return a number by `form`; a dash where there is none, "none" for inf."""
    if np.isnan(value):
        return NOTHING
    return "none" if np.isinf(value) else format(value, form)


def deviation(value: float) -> str:
    """Return a deviation in percent with two decimals, none from 1000 on; no sign on zero."""
    shown = number(value, "+.2f" if abs(value) < 1000 else "+.0f")
    return shown.removeprefix("-") if shown == "-0.00" else shown.replace("+0.00", "0.00")


def load_text(value: float) -> str:
    """Return a load in N/mm with one decimal."""
    return number(value, ".1f")


def _comparison(table: pd.DataFrame) -> str:
    """Return the comparison with its columns named for reading."""
    shown = pd.DataFrame(
        {
            "law": table["law"],
            "penetration, µm": [number(value, ".5f") for value in table["penetration_um"]],
            "stiffness, N/mm²": [number(value, ".1f") for value in table["stiffness_N_per_mm2"]],
            "largest load, N/mm": [number(value, ".1f") for value in table["max_load_N_per_mm"]],
            "": table["note"],
        }
    )
    return _lines(shown)


def _deviations(table: pd.DataFrame) -> str:
    """Return the deviations, one line per law."""
    shown = table.map(deviation).rename(columns="{:g}".format)
    return _lines(shown.reset_index())


def _departures(table: pd.DataFrame) -> str:
    """Return the departures, one line per percentage."""
    low_by, numbers, *gaps = table.columns
    shown = pd.DataFrame(
        {
            "too low by, %": [f"{value:.1f}" for value in table[low_by]],
            "φ": [f"{value:.6f}" for value in table[numbers]],
        }
        | {f"{gap:g}": [load_text(value) for value in table[gap]] for gap in gaps}
    )
    return _lines(shown)


def _explicit() -> str:
    """Return the explicit law's error bounds."""
    error = laws_table.explicit_error()
    lines = ["largest error of the explicit law:"]
    for contact, (low, high) in laws_table.BOUNDED.items():
        for what in ("load", "penetration"):
            name = f"{contact} {what}"
            lines.append(
                f"  {name}: {error[name]:.4f} % of {laws_table.TRUTH[contact].name}'s for "
                f"{low:g} ≤ φ ≤ {high:g} (at φ = {error[f'{name}, at φ']:.4g})"
            )
    name = "one-line penetration"
    lines.append(
        f"  {name} (explicit_penetration, internal): {error[name]:.4f} % "
        f"(at φ = {error[f'{name}, at φ']:.4g})"
    )
    return "\n".join(lines)


def _lines(table: pd.DataFrame) -> str:
    """Return a table of texts: the first column to the left, numbers to the right."""
    columns = [[str(name), *table[name].tolist()] for name in table.columns]
    widths = [max(map(len, column)) for column in columns]
    lines = []
    for cells in zip(*columns, strict=True):
        first, *others = (
            cell.ljust(width) if name in ("law", "") else cell.rjust(width)
            for cell, width, name in zip(cells, widths, table.columns, strict=True)
        )
        lines.append("  ".join([first, *others]).rstrip())
    return "\n".join(lines)
