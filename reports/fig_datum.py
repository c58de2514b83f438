"""What a housing clamped on its rim adds to the penetration, against its radius."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from cylcontact.laws import Conformal, Housing, difference_percent
from cylcontact.plots.figure import Drawing, new_figure, panel_title, plain_log
from cylcontact.plots.style import COLOURS, LINE_STYLES, MARKERS, QUIET
from cylcontact.reports.bench import Bench
from cylcontact.support.arrays import FloatArray

from .joints import ALUMINIUM, STEEL, Joint, label_of, origins_of, pair_of

JOINTS: tuple[Joint, ...] = (
    (STEEL, STEEL),
    (STEEL, ALUMINIUM),
    (ALUMINIUM, STEEL),
    (STEEL, "bronze"),
    ("PEEK", STEEL),
)
# R_o/R_i of the housings.
RATIOS: FloatArray = np.geomspace(1.3, 100.0, 35)
PHI = (0.01, 0.1, 1.0)
# Neither changes a number: C and δ/ΔR depend on ρ and φ alone.
R_O, DR = 1000.0, 0.01  # mm
MARKED = 20.0  # the ρ of the headline
CAPTION = (
    "What a clamped housing adds to a pin's penetration, against ρ = R_o/R_i (-), the clamped "
    "radius over the hole's. (a) Additive constant C (-) of L in δ = f L/(π E*) at small loads; "
    "filled, at the right: Johnson's datum. (b-d) Added penetration (%) at loads φ = f/(E* ΔR) (-)."
)
METHOD = (
    "Lines are for a housing clamped on its whole rim R_o and a pin under a body force, plane "
    "strain, no friction. Johnson's datum has no housing; it is the convention C = 2 ln 2 - 2 + "
    "w_j, with w_j the pin's share of 1/E*. Below zero in (b-d) the joint is stiffer than by that "
    "datum. The pairs and ρ are our choice. Material values that are not "
    "the paper's: {origins}."
)


def draw(bench: Bench) -> Drawing:
    table = pd.concat([_rows(bench, joint) for joint in JOINTS], ignore_index=True)
    method = METHOD.format(origins=origins_of(bench, JOINTS))
    return Drawing(_draw_panels(table), table, _headline(bench), CAPTION, method)


def _rows(bench: Bench, joint: Joint, ratios: FloatArray = RATIOS) -> pd.DataFrame:
    """Tabulate C and what it adds to the penetration over ρ."""
    pair = pair_of(bench, joint, DR, R_O / ratios)
    housing, johnson = Housing(R_O), Conformal()
    held = Conformal(housing)
    which, kernels = housing.kernels(pair)
    columns = {
        "pair": label_of(joint),
        "ratio": ratios,
        "constant": held.constant(pair) + np.array([kernel.h for kernel in kernels])[which],
        "johnson_constant": float(johnson.constant(pair)),
    }
    for phi in PHI:
        load = phi * pair.E_star * DR
        columns[_column(phi)] = difference_percent(held, johnson, load, pair)
    return pd.DataFrame(columns)


def _column(phi: float) -> str:
    """Return the name of the column of a load."""
    return f"added_at_phi_{phi:g}_percent"


def _headline(bench: Bench) -> dict[str, float]:
    """Return C and what it adds at φ = 1 for one housing."""
    numbers = {}
    for joint in JOINTS:
        (row,) = _rows(bench, joint, np.array([MARKED])).to_dict("records")
        where = f"{label_of(joint)}, R_o/R_i = {MARKED:g}"
        numbers[f"{where}: C"] = float(row["constant"])
        numbers[f"{where}: added at φ = 1, %"] = float(row[_column(1.0)])
    return numbers


def _draw_panels(table: pd.DataFrame) -> Figure:
    """Draw C, and what it adds at each load."""
    figure = new_figure("full", 112.0)
    panels = figure.subplots(2, 2)
    columns = ("constant", *map(_column, PHI))
    for number, (axes, column) in enumerate(zip(panels.flat, columns, strict=True)):
        _draw_lines(axes, table, column)
        axes.axhline(0, color=QUIET, linewidth=0.6, linestyle="-", marker="", zorder=1)
        plain_log(axes, "x", (2, 5, 10, 20, 50, 100))
        axes.set(xlim=(RATIOS[0], RATIOS[-1]), xlabel=r"housing $\rho = R_o/R_i$ (-)")
        axes.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
        if number:
            panel_title(axes, number, rf"added at $\varphi$ = {PHI[number - 1]:g}")
            axes.set_ylabel("added penetration (%)")
    first, *added = panels.flat
    low, high = np.transpose([axes.get_ylim() for axes in added])
    for axes in added:
        axes.set_ylim(low.min(), high.max())
    panel_title(first, 0, "constant at small loads")
    first.set_ylabel("constant $C$ (-)")
    _mark_johnson(first, table)
    lines, labels = first.get_legend_handles_labels()
    count = len(labels)
    figure.legend(lines, labels, title="pin in hole", loc="outside lower center", ncols=count)
    return figure


def _draw_lines(axes: Axes, table: pd.DataFrame, column: str) -> None:
    """Draw one column of the table, a line per pair."""
    for number, (name, rows) in enumerate(table.groupby("pair", sort=False)):
        axes.plot(
            rows["ratio"].to_numpy(),
            rows[column].to_numpy(),
            label=str(name),
            color=COLOURS[number],
            linestyle=LINE_STYLES[number],
            marker=MARKERS[number],
            markevery=(3 + 2 * number, 9),
        )


def _mark_johnson(axes: Axes, table: pd.DataFrame) -> None:
    """Mark the constant of Johnson's datum to the right of the panel."""
    for number, (_, rows) in enumerate(table.groupby("pair", sort=False)):
        axes.plot(
            1.03,
            rows["johnson_constant"].iloc[0],
            color=COLOURS[number],
            marker=MARKERS[number],
            markerfacecolor=COLOURS[number],
            transform=axes.get_yaxis_transform(),
            clip_on=False,
        )
