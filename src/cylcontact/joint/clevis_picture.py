"""Pictures of a clevis: a sketch to scale, and the line load along the pin."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.patches import FancyArrowPatch, Rectangle

from cylcontact.joint.bush import shown
from cylcontact.plots.sketch import OUTLINE
from cylcontact.plots.style import ACCENT

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from cylcontact.joint.clevis_beam import Clevis, State

_COLOURS = {"joint": "C0", "tightest": "C0", "middle": "C1", "loosest": "C2"}
_PIN, _EYE, _CHEEK = "0.78", "0.9", "0.82"
# Of an edge so much is not drawn, in R.
_EDGE = 0.02


def draw_clevis(clevis: Clevis, force: float, states: Mapping[str, State], axes: Axes) -> None:
    """Draw the clevis to scale, cut along the pin, the force on the eye upwards."""
    R = next(iter(states.values())).R
    half, cheek = clevis.eye.thickness / 2, clevis.cheek.thickness
    start, end = half + clevis.gap, clevis.pin_length / 2
    tall = {
        name: 2.0 * R if plate.housing is None else plate.housing.R_o
        for name, plate in clevis.plates.items()
    }
    for place, width, height, grey in (
        (-half, 2 * half, tall["eye"], _EYE),
        (start, cheek, tall["cheek"], _CHEEK),
        (-start - cheek, cheek, tall["cheek"], _CHEEK),
    ):
        axes.add_patch(Rectangle((place, -height), width, 2 * height, facecolor=grey, **OUTLINE))
    axes.add_patch(Rectangle((-end, -R), 2 * end, 2 * R, facecolor=_PIN, **OUTLINE))
    reach = max(tall.values())
    arrow: dict[str, Any] = {
        "arrowstyle": "-|>",
        "mutation_scale": 11,
        "linewidth": 2.0,
        "color": ACCENT,
    }
    axes.add_patch(FancyArrowPatch((0, tall["eye"]), (0, tall["eye"] + 0.8 * R), **arrow))
    for side in (-1, 1):
        x = side * (start + cheek / 2)
        ends = (x, -tall["cheek"]), (x, -tall["cheek"] - 0.8 * R)
        axes.add_patch(FancyArrowPatch(*ends, **arrow))
    axes.text(0, reach + 1.0 * R, f"{force / 1e3:g} kN", ha="center", fontsize=7)
    axes.text(0, 0, f"Ø{shown(clevis.diameter)}", ha="center", va="center", fontsize=7)
    for x, text in ((0, half * 2), (start + cheek / 2, cheek)):
        axes.text(x, -0.6 * (R + reach), f"{text:g}", ha="center", va="center", fontsize=7)
    axes.set(xlim=(-1.1 * end, 1.1 * end), ylim=(-reach - 1.3 * R, reach + 1.8 * R))
    axes.set_aspect("equal")
    axes.set_axis_off()


def draw_line_load(
    clevis: Clevis, force: float, states: Mapping[str, State], ax: Axes | None = None
) -> Axes:
    """Draw the line load along the pin beside the uniform one."""
    import matplotlib.pyplot as plt

    if ax is None:
        _, ax = plt.subplots(layout="constrained")
    half = clevis.eye.thickness / 2
    start = half + clevis.gap
    for name, state in states.items():
        for part, sign, edge in ((state.in_eye, 1.0, half), (~state.in_eye, -1.0, start)):
            shown = part & (np.abs(state.z - edge) > _EDGE * state.R)
            order = np.argsort(state.z[shown])
            z, f = state.z[shown][order], sign * state.line_load[shown][order]
            label = name if sign > 0 and len(states) > 1 else None
            for mirror in (1, -1):
                ax.plot(mirror * z, f, color=_COLOURS[name], marker="", linestyle="-",
                        label=label if mirror > 0 else None)  # fmt: skip
    uniform = force / clevis.eye.thickness, -force / 2 / clevis.cheek.thickness
    style: dict[str, Any] = {"color": "0.5", "linestyle": "--", "marker": ""}
    ax.plot([-half, half], [uniform[0]] * 2, label="uniform", **style)
    for side in (-1, 1):
        ends = [side * start, side * (start + clevis.cheek.thickness)]
        ax.plot(ends, [uniform[1]] * 2, **style)
    ax.axhline(0, color="black", linewidth=0.6, linestyle="-", marker="")
    ax.set(xlabel="along the pin (mm)", ylabel="line load on the pin (N/mm)")
    ax.set_title(f"{force / 1e3:g} kN on the eye", fontsize="small")
    ax.legend(fontsize="small")
    return ax
