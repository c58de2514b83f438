"""Several laws for one pair, side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import ContactLaw, difference_percent
from cylcontact.plots.arguments import (
    AnyLaw,
    Range,
    as_law,
    axes_for,
    require_line,
    require_one_pair,
    require_range,
)
from cylcontact.plots.figure import legend_below, plain_log, round_ticks
from cylcontact.plots.style import QUIET, staggered
from cylcontact.support.arrays import FloatArray, as_floats, require

__all__ = ["plot_laws"]

POINTS = 161


def plot_laws(
    laws: Sequence[AnyLaw] | Mapping[str, AnyLaw],
    pair: CylinderPair,
    *,
    load: Range = (10.0, 1000.0),
    relative_to: AnyLaw | None = None,
    ax: Axes | None = None,
    **line: Any,
) -> Axes:
    """Draw the penetration of several laws against load, or their difference from one of them.

    Parameters
    ----------
    laws : sequence or mapping of str to ContactLaw
        The laws, or names in `cylcontact.laws.LAWS`; the keys of a mapping are their labels.
    pair : CylinderPair
        One pair, of internal or external contact.
    load : tuple of float, optional
        Lowest and highest load per unit length in N/mm.
    relative_to : ContactLaw or str, optional
        Draw the difference from this law at equal load in percent (Eq 9); a label of `laws`, or
        any law. By default draw penetrations in µm.
    ax : matplotlib.axes.Axes, optional
        Axes to draw into; by default a new figure with a legend. Lines in your own axes follow
        their cycle of colours, and `ax.legend()` names them.
    **line
        Settings of the lines for `Axes.plot`, such as `linewidth`.

    Returns
    -------
    matplotlib.axes.Axes
        With a logarithmic axis of loads, and one of penetrations; differences are linear. A line
        ends where its law does.

    Raises
    ------
    InputError
        If there is no law, a law, the loads, `ax` or a setting is wrong, a law does not apply to
        the pair, or the pair holds arrays.

    Examples
    --------
    >>> from cylcontact import Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.95, material=steel)
    >>> ax = plot_laws(["johnson", "enhanced"], pair, relative_to="johnson")
    >>> [line.get_label() for line in ax.get_legend_handles_labels()[0]]
    ['johnson', 'enhanced']
    """
    named = _by_label(laws)
    require_line(line, "plot_laws", "laws, pair, load, relative_to, ax")
    require_one_pair(pair, "plot_laws", "pair")
    require_range(load, "plot_laws", "load", "N/mm")
    loads = as_floats(np.geomspace(*load, POINTS))
    reference = None
    if relative_to is not None:
        known = named.get(relative_to) if isinstance(relative_to, str) else None
        reference = known or as_law(relative_to, "plot_laws", "relative_to")
    curves = {label: _curve(law, reference, loads, pair) for label, law in named.items()}
    with axes_for(ax, "plot_laws", "column", 80.0) as axes:
        for label, curve in curves.items():
            # No marker hides another line's.
            marks = {"label": label, "markevery": staggered(len(axes.lines), POINTS)}
            axes.plot(loads, curve, **marks | line)
        plain_log(axes, "x", round_ticks(*load))
        axes.set(xlim=load, xlabel="load (N/mm)")
        if reference is None:
            axes.set(yscale="log", ylabel="penetration (µm)")
            plain_log(axes, "y", round_ticks(*axes.get_ylim()))
        else:
            axes.axhline(0.0, color=QUIET, linewidth=0.6, linestyle="-", marker="", zorder=1)
            axes.set_ylabel("difference of penetration (%)")
        if ax is None:
            legend_below(axes)
    return axes


def _by_label(laws: Sequence[AnyLaw] | Mapping[str, AnyLaw]) -> dict[str, ContactLaw]:
    """Return the laws by their labels; those of a sequence are their names."""
    remedy = "give a list of laws, or a mapping of labels to laws"
    several = isinstance(laws, Sequence | Mapping) and not isinstance(laws, str)
    require(several and len(laws) > 0, "plot_laws", "laws", laws, "must not be empty", remedy)
    if isinstance(laws, Mapping):
        return {label: as_law(law, "plot_laws", "laws") for label, law in laws.items()}
    given = [as_law(law, "plot_laws", "laws") for law in laws]
    named = {law.name: law for law in given}
    require(
        len(named) == len(given),
        "plot_laws",
        "laws",
        [law.name for law in given],
        "two laws have the same name",
        "give a mapping with a label for each law",
    )
    return named


def _curve(
    law: ContactLaw, reference: ContactLaw | None, loads: FloatArray, pair: CylinderPair
) -> FloatArray:
    """Return the penetrations in µm, or their differences from the reference's in percent."""
    if reference is None:
        return as_floats(1e3 * law.penetration(loads, pair))
    return difference_percent(law, reference, loads, pair)
