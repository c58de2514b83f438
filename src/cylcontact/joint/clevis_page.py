"""The page of a clevis: a sketch to scale, the line load along the pin, the answer."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.patches import FancyArrowPatch, Rectangle

from cylcontact.joint.bush import shown
from cylcontact.joint.clevis import NOT_INCLUDED, around, cells, summary
from cylcontact.joint.page import Page, Source, numbers_of_material
from cylcontact.plots.sketch import OUTLINE
from cylcontact.plots.style import ACCENT

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from cylcontact.joint.clevis import ClevisCheck

_COLOURS = {"joint": "C0", "tightest": "C0", "middle": "C1", "loosest": "C2"}
_PIN, _EYE, _CHEEK = "0.78", "0.9", "0.82"
# Of an edge so much is not drawn, in R.
_EDGE = 0.02


def page_of(check: ClevisCheck) -> Page:
    """Return the page of a check."""
    clevis = check.clevis
    title = f"{clevis.pin.title} pin Ø{shown(clevis.diameter)} in an eye between two cheeks"
    sections = {
        "Bending of the pin": [" ".join(line.split()) for line in summary(check)],
        "Assumptions": [
            "Linear elasticity; the pin is a beam on the exact contact law, fitted to finite "
            "elements in three dimensions.",
        ],
        "Not included": [NOT_INCLUDED],
    }
    return Page(
        "Check of a clevis", title, partial(draw_clevis, check), partial(draw_line_load, check),
        _inputs(check), *cells(check), [], check.warnings, sections,
    )  # fmt: skip


def _inputs(check: ClevisCheck) -> list[Source]:
    """Return what the answer is computed from."""
    clevis = check.clevis
    rows = [
        ("pin", *numbers_of_material(clevis.pin)),
        ("", f"Ø{shown(clevis.diameter)}, {clevis.pin_length:g} mm long", "given"),
    ]
    for name, plate in clevis.plates.items():
        title = "cheek, one of 2" if name == "cheek" else name
        rows += [
            (title, *numbers_of_material(plate.material)),
            ("", f"{plate.thickness:g} mm, hole Ø{shown(plate.hole)}, {around(plate)}", "given"),
        ]
        if plate.housing is not None:
            rows += [
                (f"  from {radius:g} mm", *numbers_of_material(body))
                for body, radius in plate.housing.layers
            ]
    return [*rows, ("gap", f"{clevis.gap:g} mm", "given"),
            ("load", f"{check.force:,.6g} N on the eye", "given")]  # fmt: skip


def draw_clevis(check: ClevisCheck, axes: Axes) -> None:
    """Draw the clevis to scale, cut along the pin, the force on the eye upwards."""
    clevis = check.clevis
    R = next(iter(check.band.values())).pin_mm / 2
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
    axes.text(0, reach + 1.0 * R, f"{check.force / 1e3:g} kN", ha="center", fontsize=7)
    axes.text(0, 0, f"Ø{shown(clevis.diameter)}", ha="center", va="center", fontsize=7)
    for x, text in ((0, half * 2), (start + cheek / 2, cheek)):
        axes.text(x, -0.6 * (R + reach), f"{text:g}", ha="center", va="center", fontsize=7)
    axes.set(xlim=(-1.1 * end, 1.1 * end), ylim=(-reach - 1.3 * R, reach + 1.8 * R))
    axes.set_aspect("equal")
    axes.set_axis_off()


def draw_line_load(check: ClevisCheck, ax: Axes | None = None) -> Axes:
    """Draw the line load along the pin beside the uniform one."""
    import matplotlib.pyplot as plt

    if ax is None:
        _, ax = plt.subplots(layout="constrained")
    clevis = check.clevis
    half = clevis.eye.thickness / 2
    start = half + clevis.gap
    for name, state in check.states.items():
        R = check.band[name].pin_mm / 2
        for part, sign, edge in ((state.in_eye, 1.0, half), (~state.in_eye, -1.0, start)):
            shown = part & (np.abs(state.z - edge) > _EDGE * R)
            order = np.argsort(state.z[shown])
            z, f = state.z[shown][order], sign * state.line_load[shown][order]
            label = name if sign > 0 and len(check.states) > 1 else None
            for mirror in (1, -1):
                ax.plot(mirror * z, f, color=_COLOURS[name], marker="", linestyle="-",
                        label=label if mirror > 0 else None)  # fmt: skip
    uniform = check.force / clevis.eye.thickness, -check.force / 2 / clevis.cheek.thickness
    style: dict[str, Any] = {"color": "0.5", "linestyle": "--", "marker": ""}
    ax.plot([-half, half], [uniform[0]] * 2, label="uniform", **style)
    for side in (-1, 1):
        ends = [side * start, side * (start + clevis.cheek.thickness)]
        ax.plot(ends, [uniform[1]] * 2, **style)
    ax.axhline(0, color="black", linewidth=0.6, linestyle="-", marker="")
    ax.set(xlabel="along the pin (mm)", ylabel="line load on the pin (N/mm)")
    ax.set_title(f"{check.force / 1e3:g} kN on the eye", fontsize="small")
    ax.legend(fontsize="small")
    return ax
