"""Pictures of a checked joint: its load against the penetration, and a sketch of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cylcontact.joint.loaded import law_of
from cylcontact.limits import hertz_stress
from cylcontact.plots.arguments import axes_for
from cylcontact.plots.style import ACCENT
from cylcontact.support.arrays import FloatArray, as_floats, require

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from cylcontact.bodies.pair import CylinderPair
    from cylcontact.joint.answer import Answer
    from cylcontact.joint.loaded import LoadedJoint

_POINTS = 161
# Colours are by logarithms where answers differ by more than this factor.
_DECADE = 10.0
# Of a fit these are drawn: the others lie between them.
_DRAWN = ("joint", "tightest", "middle", "loosest")


def draw_check(check: Answer, ax: Axes | None = None) -> Axes:
    """Draw the penetration of each pair up to its first yield, and the joint at work.

    Of a plane of unknown depth it is the largest pressure. Each line ends where its pair yields;
    the cross is on the pair that yields first.
    """
    joint = check.joint
    solved = dict(joint.solved())
    pairs = {name: pair for name, pair in solved.items() if name in _DRAWN}
    numbers = check.band or {"joint": check.numbers}
    ends = {name: numbers[name].first_yield_N_per_mm for name in pairs}
    known = [end for end in ends.values() if not np.isnan(end)]
    beyond = 1.25 * check.load
    top = max([beyond, *(1.05 * end for end in known)])
    worst, of_worst = check.worst
    with axes_for(ax, "plot", "column", 70.0) as axes:
        for name, pair in pairs.items():
            end = beyond if np.isnan(ends[name]) else ends[name]
            load = as_floats(np.linspace(0, end, _POINTS)[1:])
            label = name if check.iso else "to first yield" if known else "this joint"
            axes.plot(load, _drawn(load, pair, joint), label=label, marker="")
            if known:
                y = _drawn(as_floats(end), pair, joint)
                axes.plot(end, y, "x", color="black", markersize=4)
        at_yield = of_worst.first_yield_N_per_mm
        if not np.isnan(at_yield):
            label = f"first yield: {at_yield:,.0f} N/mm" + (f" ({worst})" if check.iso else "")
            y = _drawn(as_floats(at_yield), solved[worst], joint)
            axes.plot(at_yield, y, "X", color=ACCENT,
                      markerfacecolor=ACCENT, markersize=6, label=label)  # fmt: skip
        for name, pair in pairs.items():
            inside = not check.load > ends[name]  # beyond first yield the point is hollow
            axes.plot(check.load, _drawn(as_floats(check.load), pair, joint), "o", color="black",
                      markerfacecolor="black" if inside else "white", markersize=3)  # fmt: skip
        axes.axvline(check.load, color="black", linewidth=0.6, linestyle=":", marker="",
                     label=f"this load: {check.load:,.4g} N/mm")  # fmt: skip
        what = "penetration (µm)" if joint.has_penetration else "largest pressure (MPa)"
        axes.set(xlabel="load (N/mm)", ylabel=what, xlim=(0, top), ylim=(0, None))
        axes.set_title(title_of(joint))
        axes.legend(fontsize=6, loc="lower right", frameon=True, framealpha=0.9, edgecolor="none")
    return axes


def _drawn(load: FloatArray, pair: CylinderPair, joint: LoadedJoint) -> FloatArray:
    """Return what is drawn against the load."""
    if not joint.has_penetration:
        return hertz_stress(load, pair)
    return 1e3 * law_of(pair, joint.housing, joint.depth).penetration(load, pair)


def draw_map(table: pd.DataFrame, x: str, y: str, answer: str, ax: Axes | None = None) -> Axes:
    """Draw an answer of a table of joints against two of its columns, each joint as a point."""
    for key in (x, y, answer):
        rule, remedy = "is not a column of numbers", f"choose among {', '.join(map(str, table))}"
        sound = key in table and table[key].dtype.kind in "fiu"
        require(sound, "plot", "column", key, rule, remedy)
    known = table[[x, y, answer]].dropna()
    values = known[answer]
    spread = values.min() > 0 and values.max() > _DECADE * values.min()
    with axes_for(ax, "plot", "column", 75.0) as axes:
        points = axes.scatter(
            known[x],
            known[y],
            c=values,
            s=14,
            cmap="viridis",
            edgecolors="none",
            norm="log" if spread else None,
        )
        figure = axes.figure
        figure.colorbar(points, ax=axes, label=answer.replace("_", " "))
        axes.set(xlabel=x.replace("_", " "), ylabel=y.replace("_", " "))
        axes.set_title(f"{len(known):,} joints")
    return axes


def title_of(joint: LoadedJoint) -> str:
    """Return the joint in some words."""
    pair = joint.drawn
    one, other = pair.material_i.title, pair.material_j.title
    if pair.contact == "external":
        return f"{one} roller on {other} {'plane' if pair.is_flat else 'roller'}"
    size = joint.iso.code if joint.iso else f"R = {float(as_floats(pair.R_i)):g} mm"
    return f"{size}: {other} pin in {one}"
