"""Figs 7 to 9: where a pin in a hole yields and Johnson's law ends, against the clearance."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cylcontact.bodies.pair import CylinderPair
from cylcontact.limits import johnson_limit_load, stress_at_johnson_limit, yield_load
from cylcontact.plots.figure import legend_below, new_figure, panel_title, panels, plain_log
from cylcontact.plots.limit_curves import limit_clearances

from .paper import JOHNSON_LIMITS, MATERIALS, RADII

CLEARANCES = limit_clearances()
STAR = {"color": "black", "markersize": 10, "markeredgewidth": 0.5, "zorder": 3}
THIN = {"linestyle": (0, (4, 2)), "linewidth": 0.7, "marker": ""}


def fig07() -> tuple[Figure, pd.DataFrame]:
    """Load per unit length at which Hertz's peak pressure (Eq 7) equals the yield stress, against
    radial clearance, for a pin in a hole of the same material: (a) R_i = 100 mm, (b) 10 mm,
    (c) 5 mm. Thin, dashed: first yield by von Mises for the exact pressure and stresses; it is
    lower where the contact is wide. The yield stresses are assumed.
    """
    table = by_radius(
        load_N_per_mm=yield_load,
        hertz_load_N_per_mm=lambda pair: yield_load(pair, "Hertz"),
    )
    figure, axes_of = panels_by_radius(
        table, "hertz_load_N_per_mm", "load (N/mm)", thin="load_N_per_mm"
    )
    for axes in axes_of:
        axes.plot([], [], color="0.3", **THIN, label="first yield by von Mises")
    legend_below(axes_of[0])
    return figure, table


def fig08() -> tuple[Figure, pd.DataFrame]:
    """Largest load per unit length of Johnson's law, 4π E* ΔR/e² (Eq 8), against radial clearance,
    for a pin in a hole of the same material. Stars: the three limits that the text prints.
    """
    table = over_clearance(load_N_per_mm=johnson_limit_load)
    figure = new_figure("column", 84.0)
    axes = figure.subplots()
    lines_by_material(axes, table, "load_N_per_mm")
    places = [dR for _, dR in JOHNSON_LIMITS]
    axes.plot(places, list(JOHNSON_LIMITS.values()), "k*", markersize=7, label="printed limits")
    axes.set(ylabel="load (N/mm)", ylim=(10, 3e6))
    legend_below(axes)
    return figure, table


def fig09() -> tuple[Figure, pd.DataFrame]:
    """Hertz's peak pressure (Eq 7) at the largest load of Johnson's law (Eq 8), against radial
    clearance, for a pin in a hole of the same material: (a) R_i = 100 mm, (b) 10 mm, (c) 5 mm.
    Stars: the pressure equals the yield stress, which is assumed; to the right of a star the
    material yields before Johnson's law ends.
    """
    table = by_radius(stress_MPa=stress_at_johnson_limit)
    strengths = {name: material.yield_stress for name, material in MATERIALS.items()}
    table["yield_stress_MPa"] = table["material"].map(strengths)
    figure, axes_of = panels_by_radius(table, "stress_MPa", "peak pressure (MPa)")
    for axes, (_, rows) in zip(axes_of, table.groupby("R_i_mm", sort=False), strict=True):
        for number, (_, curve) in enumerate(rows.groupby("material", sort=False)):
            stress, at = np.log(curve["stress_MPa"]), np.log(curve["yield_stress_MPa"].iloc[0])
            where = np.interp(at, stress, np.log(CLEARANCES), left=np.nan, right=np.nan)
            axes.plot(np.exp(where), np.exp(at), "*", **STAR, markerfacecolor=f"C{number}")
        axes.plot([], [], "*", **STAR, markerfacecolor="0.3", label="equal to the yield stress")
    legend_below(axes_of[0])
    return figure, table


def over_clearance(
    R_i: float | None = None, **quantities: Callable[[CylinderPair], object]
) -> pd.DataFrame:
    """Evaluate functions of a pair, by column, over the clearances for each material."""
    parts = []
    for name, material in MATERIALS.items():
        pair = CylinderPair.from_dR("internal", CLEARANCES, material, R_i=R_i)
        columns = {column: quantity(pair) for column, quantity in quantities.items()}
        parts.append(pd.DataFrame({"material": name, "dR_mm": CLEARANCES, **columns}))
    return pd.concat(parts, ignore_index=True)


def by_radius(**quantities: Callable[[CylinderPair], object]) -> pd.DataFrame:
    """Return `over_clearance` for every radius of the hole."""
    parts = [over_clearance(R_i, **quantities).assign(R_i_mm=R_i) for R_i in RADII]
    return pd.concat(parts, ignore_index=True)


def panels_by_radius(
    table: pd.DataFrame, column: str, label: str, thin: str = ""
) -> tuple[Figure, list[Axes]]:
    """Draw a column against clearance, a panel for each radius; another as thin lines."""
    figure, parts = panels(len(RADII), 72.0, below_mm=10.0, sharex=True, sharey=True)
    for number, ((axes,), R_i) in enumerate(zip(parts, RADII, strict=True)):
        lines_by_material(axes, table[table["R_i_mm"] == R_i], column, thin)
        panel_title(axes, number, f"$R_i$ = {R_i:g} mm")
        axes.set_ylabel(label)
        axes.label_outer()
    return figure, [axes for (axes,) in parts]


def lines_by_material(axes: Axes, table: pd.DataFrame, column: str, thin: str = "") -> None:
    """Draw a line for each material against clearance, and a thin one beside it."""
    for number, (name, rows) in enumerate(table.groupby("material", sort=False)):
        every = (2 + 4 * number, 25)
        (line,) = axes.plot(rows["dR_mm"], rows[column], label=str(name), markevery=every)
        if thin:
            axes.plot(rows["dR_mm"], rows[thin], color=line.get_color(), **THIN)
    axes.set(yscale="log", xlim=(CLEARANCES[0], CLEARANCES[-1]))
    axes.set_xlabel(r"radial clearance $\Delta R$ (mm)")
    plain_log(axes, "x", (0.001, 0.01, 0.1, 1.0))


FIGURES = {"fig07": fig07, "fig08": fig08, "fig09": fig09}
