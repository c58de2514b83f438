"""The search for the explicit law: the forms tried, each fitted, and what they cost."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Literal

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import Transform

from cylcontact.fitting.polish import minimise_largest
from cylcontact.laws import Persson
from cylcontact.plots.figure import Drawing, figure_of_lines, panel_title, plain_log
from cylcontact.plots.style import COLOURS, small_text
from cylcontact.reports.bench import Bench
from cylcontact.support.arrays import FloatArray, as_floats

from .universal import PHI_MAX, PHI_MIN, UNIT_PAIR

CAPTION = (
    "Largest error (%) of closed forms of L in δ/ΔR = (φ/π) L for Persson's conformal solution, "
    "1e-6 ≤ φ ≤ 60; at the right: their numbers of constants and of logarithms. φ = f/(E* ΔR), d "
    "= δ/ΔR. (a) Error of the load at given penetration. (b) Error of the penetration at given "
    "load. Filled: the forms in cylcontact."
)
METHOD = (
    "Internal contact, δ and ΔR in mm; e is Euler's number. The datum of Persson's solution is "
    "matched to Johnson's law at small loads. With L from d the load is explicit, with L from φ "
    "the penetration. Every fit, of the least largest error, is made anew when this is drawn, "
    "from stored starting points; another local optimum is not excluded. The constants are "
    "unrounded here; those of the two forms that the package has are rounded there, which costs a "
    "little. The forms tried are our choice; each has at most four constants."
)
FIT_POINTS, CHECK_POINTS = 400, 4001
# The bounds of the constants; D alone may be negative.
LOW, HIGH = 0.02, 12.0
D_LOW, D_HIGH = -2.0, 2.0
UNDEFINED = 1e3  # percent, where a form has no value
Given = Literal["penetration", "load"]
Function = Callable[..., FloatArray]
TITLES: dict[Given, str] = {
    "penetration": "load explicit, $L(d)$",
    "load": r"penetration explicit, $L(\varphi)$",
}
# Columns beside the panels, in sizes of their text from the frame; this many brackets are long.
COLUMNS = {"constants": 2.9, "ln": 6.0}
LONG = 4
CHOSEN = "c + ln(1 + A/d [c + ln(1 + A/d ln(B/d))])"
SIMPLEST = "c + ln(1 + A/φ)"


def draw(_bench: Bench) -> Drawing:
    table = _table()
    errors = table.set_index("form")["largest_error_percent"]
    of_penetration = errors[(table["given"] == "load").to_numpy()]
    headline = {
        f"load explicit, chosen form: largest error from {PHI_MIN:g} to {PHI_MAX:g}, %": errors[
            CHOSEN
        ],
        "penetration explicit, simplest form: largest error, %": errors[SIMPLEST],
        "penetration explicit, best form: largest error, %": of_penetration.min(),
        "forms": float(len(table)),
    }
    return Drawing(_draw_panels(table), table, headline, CAPTION, METHOD)


def _table() -> pd.DataFrame:
    """Fit every form and list them, the least accurate first, load-explicit forms before others."""
    rows = []
    for form, (function, start) in FORMS.items():
        given: Given = "load" if "φ" in form else "penetration"
        constants, largest = _fit(function, start, given)
        rows.append(
            {
                "form": form,
                "given": given,
                "constants": len(constants),
                "logarithms": form.count("ln"),
                "largest_error_percent": largest,
                "fitted": " ".join(f"{name}={value:.6g}" for name, value in constants.items()),
            }
        )
    return pd.DataFrame(rows).sort_values(
        ["given", "largest_error_percent"], ascending=False, ignore_index=True
    )


def _ln1(x: FloatArray) -> FloatArray:
    return as_floats(np.log1p(x))


# Each form of L as a function of d or φ, and the constants at which its fit starts.
FORMS: dict[str, tuple[Function, dict[str, float]]] = {
    "c + k ln(1 + B/d^m)": (
        lambda d, c, k, B, m: c + k * _ln1(B / d**m),
        {"c": 1.47, "k": 0.66, "B": 1.0, "m": 1.75},
    ),
    "c + ln(1 + A/d [c + ln(1 + B/d)])": (
        lambda d, c, A, B: c + _ln1(A / d * (c + _ln1(B / d))),
        {"c": 1.4, "A": 0.4, "B": 0.76},
    ),
    "c + ln(1 + A/d ln(B/d))": (
        lambda d, c, A, B: c + _ln1(A / d * np.log(B / d)),
        {"c": 1.5, "A": 0.32, "B": 6.0},
    ),
    "c + ln(1 + B/d ln(1 + A/d))": (
        lambda d, c, A, B: c + _ln1(B / d * _ln1(A / d)),
        {"c": 1.46, "A": 4.7, "B": 0.35},
    ),
    "c + ln(1 + B/d ln(e + A/d))": (
        lambda d, c, A, B: c + _ln1(B / d * np.log(np.e + A / d)),
        {"c": 1.41, "A": 1.9, "B": 0.46},
    ),
    "c + ln(1 + A/d [c + ln(1 + A/d [c + ln(1 + A/d [c + ln(1 + A/d)])])])": (
        lambda d, c, A: c + _ln1(A / d * (c + _ln1(A / d * (c + _ln1(A / d * (c + _ln1(A / d))))))),
        {"c": 1.42, "A": 0.35},
    ),
    "c + ln(1 + B/d [ln(1 + A/d) + D])": (
        lambda d, c, A, B, D: c + _ln1(B / d * (_ln1(A / d) + D)),
        {"c": 1.44, "A": 1.2, "B": 0.44, "D": 0.7},
    ),
    "c + ln(1 + B/d ln(1 + A/d)) + D/(1 + d)": (
        lambda d, c, A, B, D: c + _ln1(B / d * _ln1(A / d)) + D / (1 + d),
        {"c": 1.44, "A": 2.6, "B": 0.32, "D": 0.3},
    ),
    "c + ln(1 + A/d [c + ln(1 + A/d ln(1 + B/d))])": (
        lambda d, c, A, B: c + _ln1(A / d * (c + _ln1(A / d * _ln1(B / d)))),
        {"c": 1.42, "A": 0.36, "B": 3.4},
    ),
    CHOSEN: (
        lambda d, c, A, B: c + _ln1(A / d * (c + _ln1(A / d * np.log(B / d)))),
        {"c": 1.43, "A": 0.36, "B": 3.8},
    ),
    "c + ln(1 + A/d [c + ln(1 + D/d ln(B/d))])": (
        lambda d, c, A, B, D: c + _ln1(A / d * (c + _ln1(D / d * np.log(B / d)))),
        {"c": 1.43, "A": 0.36, "B": 3.8, "D": 0.36},
    ),
    SIMPLEST: (
        lambda phi, c, A: c + _ln1(A / phi),
        {"c": 1.42, "A": 1.1},
    ),
    "c + k ln(1 + A/φ)": (
        lambda phi, c, A, k: c + k * _ln1(A / phi),
        {"c": 1.42, "A": 1.1, "k": 1.0},
    ),
    "c + ln(1 + A/φ) + Dφ/(1 + kφ)^2": (
        lambda phi, c, A, D, k: c + _ln1(A / phi) + D * phi / (1 + k * phi) ** 2,
        {"c": 1.43, "A": 1.1, "D": -0.03, "k": 0.46},
    ),
}


def _fit(
    function: Function, start: dict[str, float], given: Given
) -> tuple[dict[str, float], float]:
    """Return the constants fitted minimax, and the largest error in percent on a finer grid."""
    low = np.array([D_LOW if name == "D" else LOW for name in start])
    high = np.array([D_HIGH if name == "D" else HIGH for name in start])
    coarse, fine = _samples(FIT_POINTS), _samples(CHECK_POINTS)
    point = minimise_largest(
        lambda points: _errors(function, given, points, *coarse),
        low,
        high,
        np.array(list(start.values())),
    )
    constants = dict(zip(start, map(float, point), strict=True))
    return constants, float(np.abs(_errors(function, given, point[None, :], *fine)).max())


def _samples(count: int) -> tuple[FloatArray, FloatArray]:
    """Return φ, spaced logarithmically, and Persson's d."""
    phi = as_floats(np.geomspace(PHI_MIN, PHI_MAX, count))
    return phi, Persson().penetration(phi, UNIT_PAIR)


def _errors(
    function: Function, given: Given, points: FloatArray, phi: FloatArray, d: FloatArray
) -> FloatArray:
    """Return the errors in percent of every set of constants, shape (P, k) to (P, q)."""
    constants = points.T[:, :, None]
    with np.errstate(all="ignore"):
        if given == "penetration":
            ratio = np.pi * d / function(d, *constants) / phi
        else:
            ratio = phi / np.pi * function(phi, *constants) / d
        return np.nan_to_num(100 * (ratio - 1), nan=UNDEFINED, posinf=UNDEFINED, neginf=-UNDEFINED)


def _draw_panels(table: pd.DataFrame) -> Figure:
    """Draw the largest error of each form, a panel for each quantity that is given."""
    parts = [table[table["given"] == given] for given in TITLES]
    rows = [len(part) for part in parts]
    figure = figure_of_lines("full", 1.35 * (sum(rows) + 5))
    panels = figure.subplots(2, 1, sharex=True, height_ratios=rows)
    for number, (axes, part, title) in enumerate(zip(panels, parts, TITLES.values(), strict=True)):
        _draw_dots(axes, part)
        panel_title(axes, number, title)
    plain_log(panels[1], "x", (0.001, 0.01, 0.1, 1, 10))
    panels[1].set(xlim=(1e-3, 10), xlabel="largest error (%)")
    for heading in ("constants", "ln"):
        _write_beside(panels[0], panels[0].transAxes, 1.02, heading, heading)
    return figure


def _draw_dots(axes: Axes, table: pd.DataFrame) -> None:
    """Draw a dot per form, its formula to the left and its costs to the right."""
    for place, row in enumerate(table.to_dict("records")):
        face = COLOURS[0] if row["form"] in {CHOSEN, SIMPLEST} else "white"
        axes.axhline(place, color="0.85", linewidth=0.5, linestyle="-", marker="", zorder=0)
        axes.plot(row["largest_error_percent"], place, "o", color="black", markerfacecolor=face)
        for heading, count in (("constants", row["constants"]), ("ln", row["logarithms"])):
            _write_beside(axes, axes.get_yaxis_transform(), place, heading, str(count))
    axes.set_ylim(len(table) - 0.4, -0.6)
    axes.set_yticks(range(len(table)), [_formula(form) for form in table["form"]])
    axes.tick_params(axis="y", length=0)


def _write_beside(axes: Axes, transform: Transform, place: float, heading: str, text: str) -> None:
    """Write a text in the column of a heading, to the right of a panel."""
    axes.annotate(
        text,
        (1.0, place),
        xycoords=transform,
        xytext=(COLUMNS[heading] * small_text(), 0),
        textcoords="offset points",
        annotation_clip=False,
        horizontalalignment="center",
        verticalalignment="bottom" if text == heading else "center",
        fontsize=small_text(),
    )


def _formula(form: str) -> str:
    r"""Write a form for matplotlib, a long one in two lines."""
    spaced = re.sub(r"([ABD]/d) (?=ln|\[)", r"(\1)\\,", form).replace("φ", r"\varphi ")
    lines = re.sub(r"\bln", r"\\ln", re.sub(r"(?<=k) ln", r"\\,ln", spaced)).split("[")
    if len(lines) < LONG:
        return f"${'['.join(lines)}$"
    middle = len(lines) // 2
    return f"${'['.join(lines[:middle])}[$\n${'['.join(lines[middle:])}$"
