"""What the housing does to the penetration of one joint: the figure of the README.

`python -m reports.fig_housing` solves its finite elements again and writes datasets/housing.csv.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from scipy.interpolate import PchipInterpolator

from cylcontact.bodies.pair import CylinderPair
from cylcontact.datasets.finite_element import Setup, solve
from cylcontact.laws import Conformal, Explicit, Housing, Johnson, Sector
from cylcontact.plots.figure import Drawing, new_figure, plain_log
from cylcontact.plots.style import COLOURS, QUIET
from cylcontact.reports.bench import Bench
from cylcontact.support.arrays import FloatArray

from .joints import STEEL, origins_of

# The joint of the README and of the page of laws, under this load in N/mm.
PIN, HOLE, R_I, R_J, LOAD = STEEL, "bronze", 10.0, 9.95, 1000.0
CLAMPS: dict[str, tuple[str, Literal["rim"] | Sector]] = {
    "rim": ("whole rim", "rim"),
    "near_60": ("60° near: rod pushes", Sector(60, "near")),
    "far_180": ("180° far", Sector(180, "far")),
    "far_120": ("120° far", Sector(120, "far")),
    "far_60": ("60° far: rod pulls", Sector(60, "far")),
}
# R_o/R_i of the lines; of the circles; of the headline and the finite elements, and cells of these
# over half of the contact.
RATIOS: FloatArray = np.array([1.3, 1.5, 1.75, 2.0, 2.5, 3.0, 5.0, 10.0, 20.0])
CIRCLES = (1.5, 2.0, 3.0, 5.0, 10.0, 20.0)
NAMED, CELLS = (1.5, 3.0, 10.0), 10
ELEMENTS = "datasets/housing.csv"
CAPTION = (
    "The same joint in other housings: penetration (µm) of a steel pin in a bronze hole against "
    "R_o/R_i (-), radius of the clamped rim over the hole's. Lines: exact series for the rim or a "
    "sector clamped, near the contact or opposite. Circles: the explicit law there. Crosses: "
    "finite elements. Dotted: Johnson's law, which knows no housing."
)
METHOD = (
    "R_i = 10 mm, R_j = 9.95 mm, 1000 N/mm, plane strain, no friction, the pin under a body force. "
    "The penetration is the displacement of the pin's centre against the clamped rim, less the "
    "clearance; the lines run smoothly through it at nine R_o/R_i. Where five constants miss the "
    "series by more than 1 %, the explicit law is a table of it. The joint is our choice. Material "
    "values that are not the paper's: {origins}."
)


def draw(bench: Bench) -> Drawing:
    pair = joint(bench)
    solved = by_clamp_and_ratio(bench).pivot_table("penetration_um", "ratio", "clamp")
    table = pd.DataFrame({"ratio": RATIOS})
    for name, (_, clamp) in CLAMPS.items():
        housings = [Housing(R_I * ratio, clamp=clamp) for ratio in table["ratio"]]
        table[f"{name}_um"] = [micrometres(Conformal(each), pair) for each in housings]
        table[f"{name}_explicit_um"] = [
            micrometres(Explicit(datum=each), pair) if ratio in CIRCLES else np.nan
            for ratio, each in zip(RATIOS, housings, strict=True)
        ]
        table[f"{name}_elements_um"] = table["ratio"].map(solved[name])
    johnson = micrometres(Johnson(), pair)
    headline = {"Johnson's law, µm": johnson}
    for name, (words, clamp) in CLAMPS.items():
        for ratio in NAMED:
            law = Conformal(Housing(R_I * ratio, clamp=clamp))
            headline[f"{words}, R_o/R_i = {ratio:g}, µm"] = micrometres(law, pair)
        error = table[f"{name}_explicit_um"] / table[f"{name}_um"] - 1
        headline[f"{words}: explicit off by at most, %"] = float(100 * error.abs().max())
        error = table[f"{name}_elements_um"] / table[f"{name}_um"] - 1
        headline[f"{words}: finite elements off by at most, %"] = float(100 * error.abs().max())
    method = METHOD.format(origins=origins_of(bench, [(PIN, HOLE)]))
    return Drawing(_draw(table, johnson), table, headline, CAPTION, method)


def by_clamp_and_ratio(bench: Bench) -> pd.DataFrame:
    """Return the committed penetrations by finite elements in µm."""
    return bench.table(ELEMENTS, ["clamp", "ratio", "penetration_um"], "make housing makes it")


def joint(bench: Bench) -> CylinderPair:
    pin, hole = (bench.material(name).material for name in (PIN, HOLE))
    return CylinderPair.internal(R_i=R_I, R_j=R_J, pin=pin, hole=hole)


def by_elements(bench: Bench, name: str, ratio: float) -> float:
    """Return the penetration in µm by finite elements."""
    pair = joint(bench)
    hole, pin = pair.material_i, pair.material_j
    setup = Setup(
        hole_radius=R_I,
        outer_ratio=ratio,
        E=float(hole.E),
        nu=float(hole.nu),
        pin_E=float(pin.E),
        pin_nu=float(pin.nu),
        clamp=CLAMPS[name][1],
        cells=CELLS,
    )
    (case,) = solve(setup, R_I - R_J, [LOAD])
    return 1e3 * case.penetration


def micrometres(law: Conformal | Explicit | Johnson, pair: CylinderPair) -> float:
    """Return the penetration in µm under the load."""
    return float(1e3 * law.penetration(LOAD, pair))


def smooth(values: pd.Series[float]) -> tuple[FloatArray, FloatArray]:
    """Return a smooth line through values at `RATIOS`, on logarithmic axes."""
    ratio = np.geomspace(RATIOS[0], RATIOS[-1], 201)
    line = PchipInterpolator(np.log(RATIOS), np.log(values))
    return ratio, np.exp(line(np.log(ratio)))


def _draw(table: pd.DataFrame, johnson: float) -> Figure:
    """Draw the penetration over the housing, a line per clamp."""
    figure = new_figure("full", 92.0)
    axes = figure.subplots()
    for number, (name, (words, _)) in enumerate(CLAMPS.items()):
        style: dict[str, Any] = {"color": COLOURS[number], "linestyle": "-", "marker": ""}
        axes.plot(*smooth(table[f"{name}_um"]), label=words, **style)
        style |= {"linestyle": "", "marker": "o", "markerfacecolor": "none"}
        axes.plot(table["ratio"], table[f"{name}_explicit_um"], **style)
        axes.plot(table["ratio"], table[f"{name}_elements_um"], **style | {"marker": "+"}, ms=9)
    axes.axhline(johnson, color=QUIET, linestyle=":", marker="", zorder=1)
    axes.text(19.5, johnson * 0.97, "Johnson's law", ha="right", va="top", color=QUIET)
    axes.set(xscale="log", yscale="log", xlim=(1.25, 20.8))
    plain_log(axes, "x", (1.3, 1.5, 2, 3, 5, 10, 20))
    plain_log(axes, "y", (7, 10, 20, 50, 100, 200))
    axes.set_xlabel(r"housing $R_o/R_i$ (-)")
    axes.set_ylabel("penetration (µm)")
    axes.legend(title="clamped", loc="upper right")
    return figure


if __name__ == "__main__":
    ours = Bench(Path())
    rows = [(name, ratio, by_elements(ours, name, ratio)) for name in CLAMPS for ratio in NAMED]
    made = pd.DataFrame(rows, columns=["clamp", "ratio", "penetration_um"])
    made.to_csv(ELEMENTS, index=False, float_format="%.9g")
