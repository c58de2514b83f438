"""Loads at which a contact yields and Johnson's law ends, against clearance, as in Figs 7 to 9."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullFormatter

from cylcontact.bodies.material import Material
from cylcontact.limits import hertz_stress, johnson_limit_load, yield_load
from cylcontact.limits.yield_search import Criterion
from cylcontact.plots.arguments import Range, axes_for, pins_in_hole, require_line, require_range
from cylcontact.plots.figure import legend_below, plain_log, round_ticks
from cylcontact.plots.style import staggered
from cylcontact.support.arrays import FloatArray, as_floats, require
from cylcontact.support.plain_text import as_label

__all__ = ["DR", "limit_clearances", "plot_limits"]

DR: Range = (0.001, 2.0)  # mm, of Figs 7 to 9
POINTS = 100


def plot_limits(
    material: Material,
    *,
    dR: Range = DR,
    R_i: float = 10.0,
    material_j: Material | None = None,
    criterion: Criterion | None = "von Mises",
    johnson: bool = True,
    pressure: bool = False,
    ax: Axes | None = None,
    **line: Any,
) -> Axes:
    """Draw the load at first yield and the largest load of Johnson's law against the clearance.

    For a pin in a hole. Fig 7 draws first yield, Fig 8 the largest load of Johnson's law, and Fig 9
    Hertz's peak pressure (Eq 7) at that load.

    Parameters
    ----------
    material : Material
        Of both bodies, or of the hole if `material_j` is given.
    dR : tuple of float, optional
        Lowest and highest radial clearance in mm.
    R_i : float, optional
        Radius of the hole in mm.
    material_j : Material, optional
        Of the pin.
    criterion : {"von Mises", "Tresca", "Hertz"} or None
        Of first yield, as in `cylcontact.limits.yield_load`; None leaves it out.
    johnson : bool, optional
        Whether to draw the largest load of Johnson's law (Eq 8).
    pressure : bool, optional
        Whether to draw Hertz's peak pressure (Eq 7) in MPa at these loads, rather than the loads.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; by default a new figure with a legend. Lines in your own axes follow
        their cycle of colours, and `ax.legend()` names them.
    **line
        Settings of the lines for `Axes.plot`, such as `label` and `color`.

    Returns
    -------
    matplotlib.axes.Axes
        Both axes logarithmic: clearance in mm, load per unit length in N/mm or pressure in MPa.

    Raises
    ------
    InputError
        If the clearances, the radius, the criterion or `ax` are wrong, nothing is left to draw, or
        a material has no yield stress.

    Examples
    --------
    >>> bronze = Material("bronze", E=110e3, nu=0.34, yield_stress=220.0)
    >>> ax = plot_limits(bronze, criterion="Hertz", R_i=5.0)
    >>> [line.get_label() for line in ax.lines]
    ['bronze: first yield (Hertz), $R_i$ = 5 mm', "bronze: largest load of Johnson's law"]
    """
    require(
        criterion is not None or johnson,
        "plot_limits",
        "criterion, johnson",
        (criterion, johnson),
        "leave nothing to draw",
        "give a criterion, or johnson=True",
    )
    takes = "material, dR, R_i, material_j, criterion, johnson, pressure, ax"
    require_line(line, "plot_limits", takes)
    require_range(dR, "plot_limits", "dR", "mm")
    pair = pins_in_hole(limit_clearances(dR), "plot_limits", material, R_i, material_j)
    bodies = (material_j, material) if material_j else (material,)
    who = " in ".join(as_label(body.name) for body in bodies)
    loads = {}
    if criterion is not None:
        loads[f"{who}: first yield ({criterion}), $R_i$ = {R_i:g} mm"] = yield_load(pair, criterion)
    if johnson:
        loads[f"{who}: largest load of Johnson's law"] = johnson_limit_load(pair)
    with axes_for(ax, "plot_limits", "column", 80.0) as axes:
        for label, values in loads.items():
            drawn = hertz_stress(values, pair) if pressure else values
            # No marker hides another line's.
            marks = {"label": label, "markevery": staggered(len(axes.lines), POINTS)}
            axes.plot(pair.dR, drawn, **marks | line)
        plain_log(axes, "x", round_ticks(*dR))
        axes.set(xlim=dR, xlabel=r"radial clearance $\Delta R$ (mm)")
        axes.set_ylabel("peak pressure (MPa)" if pressure else "load (N/mm)")
        axes.set_yscale("log")
        axes.yaxis.set_minor_locator(LogLocator(subs=(1.0,), numticks=20))
        axes.yaxis.set_minor_formatter(NullFormatter())
        if ax is None:
            legend_below(axes)
    return axes


def limit_clearances(dR: Range = DR) -> FloatArray:
    """Return the clearances in mm at which `plot_limits` evaluates the limits, shape (100,).

    Examples
    --------
    >>> print(limit_clearances((0.01, 1.0))[[0, -1]])
    [0.01 1.  ]
    """
    return as_floats(np.geomspace(*dR, POINTS))
