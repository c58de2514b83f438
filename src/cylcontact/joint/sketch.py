"""A sketch of a joint with its dimensions, load and contact, the clearance enlarged."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.patches import Circle, Rectangle, Wedge

from cylcontact.laws import Housing, Sector
from cylcontact.plots.sketch import OUTLINE, THIN, cross, dimension, polar
from cylcontact.plots.style import ACCENT

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from cylcontact.joint.answer import Answer
    from cylcontact.joint.loaded import LoadedJoint

# Over the radius of the hole: the clearance that is drawn, and the plate around a hole.
_GAP, _PLATE = 0.07, 1.9
_PIN, _RINGS, _PLAIN = "0.78", ("0.9", "0.82", "0.94"), "0.93"
_LOAD: dict[str, Any] = {"shrinkA": 0, "shrinkB": 0} | {
    "arrowstyle": "-|>", "mutation_scale": 11, "linewidth": 2.0, "edgecolor": ACCENT,
    "facecolor": ACCENT,
}  # fmt: skip
_CONTACT: dict[str, Any] = {
    "color": ACCENT, "linewidth": 2.2, "linestyle": "-", "marker": "", "zorder": 6,
}  # fmt: skip
# Larger rollers are drawn with this ratio of radii.
_LARGEST = 2.2


def draw_sketch(check: Answer, axes: Axes) -> None:
    """Draw the joint of a check, the load downwards."""
    axes.set_aspect("equal")
    axes.set_axis_off()
    if check.pair.contact == "internal":
        _draw_pin(check, axes)
    else:
        _draw_rollers(check, axes)


def _toward(distance: float, degrees: float) -> tuple[float, float]:
    """Return a point at an angle from the load."""
    return polar(distance, degrees - 90.0)


def _draw_pin(check: Answer, axes: Axes) -> None:
    """Draw the pin of a check in its hole and its housing, with the contact."""
    joint, numbers = check.joint, check.numbers
    R_i, R_j = (float(each) for each in joint.drawn.radii("a sketch"))
    gap = "clearance of the fit" if joint.iso else f"ΔR = {1e3 * float(joint.drawn.dR):.4g} µm"
    draw_pin(axes, R_i, R_j, joint.housing, gap)
    if not np.isnan(angle := numbers.contact_angle_deg):
        arc = [_toward(1.0, each) for each in np.linspace(-angle, angle, 121)]
        axes.plot(*zip(*arc, strict=True), **_CONTACT)
        for side in {-numbers.peak_at_deg, numbers.peak_at_deg}:
            axes.plot(*_toward(1.0, side), "o", color=ACCENT, markerfacecolor="white",
                      markersize=4, zorder=7)  # fmt: skip


def draw_pin(axes: Axes, R_i: float, R_j: float, housing: Housing | None, gap: str) -> None:
    """Draw a pin in its hole and its housing, the load downwards; `gap` names the clearance."""
    axes.set_aspect("equal")
    axes.set_axis_off()
    outer = _draw_around(housing, R_i, axes)
    axes.add_patch(Circle((0, 0), 1.0, facecolor="white", zorder=3, **OUTLINE))
    middle = (0.0, -_GAP)
    axes.add_patch(Circle(middle, 1 - _GAP, facecolor=_PIN, zorder=4, **OUTLINE))
    axes.annotate("", xy=(0, -0.72), xytext=middle, arrowprops=_LOAD, zorder=8)
    axes.text(0.14, -0.42, "load", color=ACCENT, zorder=9, ha="left", va="center", fontsize=6.5)
    cross(axes, middle, zorder=8)
    axes.text(0, 0.3, f"$R_j$ = {R_j:.6g}", ha="center", zorder=9, fontsize=6.5)
    far = outer + 0.18 * outer
    _point_at(axes, _toward(1.0, 300), _toward(far, 300), f"$R_i$ = {R_i:.6g}")
    side, top = 1.12 * outer, 1.12 * outer
    if housing is not None:
        _point_at(axes, _toward(outer, 60), _toward(far, 60), f"$R_o$ = {housing.R_o:.6g}")
        shank = getattr(housing.clamp, "shank", None)
        top, side = (top, side) if shank is None else (1.65 * outer, max(1.0, shank) * side)
    axes.set(xlim=(-1.75 * side, 1.75 * side), ylim=(-1.2 * outer, top))
    axes.text(0, -1.16 * outer, f"{gap}, drawn larger; lengths in mm", ha="center", va="top",
              fontsize=6.5)  # fmt: skip


def _draw_around(housing: Housing | None, R_i: float, axes: Axes) -> float:
    """Draw what is around the hole, and return its radius over that of the hole."""
    if housing is None:
        axes.add_patch(Circle((0, 0), _PLATE, facecolor=_PLAIN, edgecolor="0.6", linestyle="--"))
        axes.text(0, 1.45, "large plate", ha="center", va="center", fontsize=6.5)
        return _PLATE
    outer = housing.R_o / R_i
    clamp = housing.clamp
    if isinstance(clamp, Sector) and clamp.shank is not None:
        half = clamp.shank * outer
        axes.add_patch(Rectangle((-half, 0), 2 * half, 1.5 * outer, facecolor=_RINGS[0],
                                 zorder=0, **OUTLINE))  # fmt: skip
        at = 1.5 * outer
        _hatch(axes, [(x, at) for x in np.linspace(-half, half, 9)], (0.0, 1.0), outer)
        y = 1.38 * outer
        dimension(axes, (-half, y), (half, y), f"{2 * clamp.shank * housing.R_o:.5g}",
                  (0, -0.06 * outer))  # fmt: skip
    edges = [1.0, *(r / R_i for _, r in housing.layers), outer]
    for k in range(len(edges) - 1, 0, -1):
        colour = _RINGS[(k - 1) % len(_RINGS)]
        axes.add_patch(Circle((0, 0), edges[k], facecolor=colour, zorder=1, **OUTLINE))
        if k < len(edges) - 1:
            text = f"$R$ = {R_i * edges[k]:.6g}"
            at = 255 - 16 * (k - 1)
            _point_at(axes, _toward(edges[k], at), _toward(1.18 * outer, at), text)
    if not (isinstance(clamp, Sector) and clamp.shank is not None):
        angle = 360.0 if not isinstance(clamp, Sector) else float(clamp.angle)
        centre = 180.0 if isinstance(clamp, Sector) and clamp.side == "pulled" else 0.0
        count = max(5, int(angle / 9))
        for each in np.linspace(centre - angle / 2, centre + angle / 2, count):
            _hatch(axes, [_toward(outer, each)], _toward(1.0, each), outer)
        if angle < 360:
            axes.add_patch(
                Wedge(
                    (0, 0),
                    outer,
                    centre - angle / 2 - 90,
                    centre + angle / 2 - 90,
                    width=0.001,
                    edgecolor="black",
                    linewidth=2.2,
                    zorder=2,
                )
            )
            _point_at(
                axes,
                _toward(outer, centre + angle / 2),
                _toward(1.2 * outer, centre + angle / 2 + 8),
                f"{angle:g}°",
            )
    return outer


def _hatch(
    axes: Axes, points: list[tuple[float, float]], out: tuple[float, float], size: float
) -> None:
    """Draw strokes of a clamp outwards from points."""
    long = 0.08 * size
    for x, y in points:
        axes.plot([x, x + long * (out[0] + 0.5 * out[1])], [y, y + long * (out[1] - 0.5 * out[0])],
                  **THIN)  # fmt: skip


def _point_at(
    axes: Axes, point: tuple[float, float], text_at: tuple[float, float], text: str
) -> None:
    """Write a size beside a drawing, with a leader to what it is of."""
    axes.plot(*zip(point, text_at, strict=True), zorder=9, **THIN)
    align = "left" if text_at[0] > 0 else "right"
    axes.text(*text_at, f" {text} ", ha=align, va="center", zorder=9)


def _draw_rollers(check: Answer, axes: Axes) -> None:
    """Draw two rollers, or one on a plane, the first above."""
    joint: LoadedJoint = check.joint
    R_i, R_j = (float(each) for each in joint.drawn.radii("a sketch"))
    axes.add_patch(Circle((0, 1), 1.0, facecolor=_PIN, **OUTLINE))
    cross(axes, (0, 1))
    _point_at(axes, polar(1.0, 160, (0, 1)), (-1.25, 1.75), f"$R_i$ = {R_i:.6g}")
    if np.isinf(R_j):
        axes.add_patch(Rectangle((-1.7, -1.0), 3.4, 1.0, facecolor=_RINGS[0], edgecolor="none"))
        axes.plot([-1.7, 1.7], [0, 0], color="black", linewidth=0.9, linestyle="-", marker="")
        if joint.depth:
            _hatch(axes, [(x, -1.0) for x in np.linspace(-1.6, 1.6, 13)], (0.0, -1.0), 1.2)
            dimension(axes, (1.3, 0), (1.3, -1.0), f"{joint.depth:g}", (-0.25, 0))
    else:
        ratio = min(R_j / R_i, _LARGEST)
        axes.add_patch(Circle((0, -ratio), ratio, facecolor=_RINGS[0], **OUTLINE))
        axes.text(0, -0.6 * min(ratio, 1.0), f"$R_j$ = {R_j:.6g}", ha="center", va="top")
    axes.annotate("", xy=(0, 1.12), xytext=(0, 2.45), arrowprops=_LOAD, zorder=8)
    axes.text(0.1, 2.2, "load", color=ACCENT)
    axes.plot(0, 0, "o", color=ACCENT, markerfacecolor=ACCENT, markersize=4)
    width = f"contact {check.numbers.width_mm:.3g} mm wide"
    _point_at(axes, (0, 0), (1.15, 0.28), width)
    axes.set(xlim=(-2.7, 3.3), ylim=(-1.35, 2.6))
