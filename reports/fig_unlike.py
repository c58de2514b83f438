"""The error of taking a pin and a hole of two materials for equal ones of the same E*."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from matplotlib.ticker import AutoMinorLocator

from cylcontact.laws.conformal import Bodies
from cylcontact.plots.figure import Drawing, new_figure, panel_title, plain_log
from cylcontact.plots.maps import RIM, add_scale, draw_contours, label_contours
from cylcontact.plots.style import small_text
from cylcontact.reports.bench import Bench
from cylcontact.support.arrays import FloatArray, as_floats

from .joints import (
    ALUMINIUM,
    STEEL,
    Joint,
    draw_plane,
    error_table,
    label_of,
    origins_of,
    pair_of,
    signed_axis,
)

NU = 0.3
G = (1 - 2 * NU) / (2 - 2 * NU)  # (κ − 1)/(κ + 1) of bodies of that ν, β/α of two of them
LOADS, PLANE = f"any, nu = {NU:g}", "any"  # the pairs of the two maps in the table
PHI: FloatArray = np.geomspace(1e-3, 10.0, 61)
PLANE_PHI = 1.0
COUNT = 31  # of values of α
BETAS: FloatArray = np.linspace(-0.5, 0.5, 21)
JOINTS: tuple[Joint, ...] = (
    (STEEL, "PEEK"),
    (STEEL, ALUMINIUM),
    (STEEL, "bronze"),
    ("bronze", STEEL),
    (ALUMINIUM, STEEL),
    ("PEEK", STEEL),
    ("PTFE", STEEL),
)
JOINT_PHI: FloatArray = np.array([0.01, 0.1, 0.3, 1.0, 3.0, 10.0])
CAPTION = (
    "Error of the penetration (%) at equal load if a pin and a hole of two materials are taken for "
    "equal ones of one E*. (a) Against Dundurs' α and φ = f/(E* ΔR) (-), for "
    f"ν = {NU:g} of both. (b) Against Dundurs' α and β (-) at φ = {PLANE_PHI:g}; circles: named "
    "materials. Contours are dashed below zero."
)
METHOD = (
    "Persson's solution less that for any two materials, each by Johnson's datum, in percent of "
    "the latter. α = -1 is a rigid pin, α = 1 a rigid hole. In (a) both bodies are in plane strain "
    f"(our choice), so that β = {G:.4f} α. (b) covers all pairs that are possible; the circles are "
    "for plane strain, and the table has their errors from φ = 0.01 to 10. Material values that "
    "are not the paper's: {origins}."
)


def draw(bench: Bench) -> Drawing:
    named = pd.concat([_rows(bench, joint) for joint in JOINTS], ignore_index=True)
    table = pd.concat([_over_loads(), _over_plane(), named], ignore_index=True)
    method = METHOD.format(origins=origins_of(bench, JOINTS))
    return Drawing(_draw_maps(table, named), table, _headline(table, named), CAPTION, method)


def error_of_E_star(alpha: FloatArray, beta: float, phi: FloatArray) -> FloatArray:
    """Return the error in percent of the penetration of equal bodies, at loads φ."""
    alike = _approach(np.zeros_like(alpha), 0.0, phi)
    return as_floats(100 * (alike / _approach(alpha, beta, phi) - 1))


def _approach(alpha: FloatArray, beta: float, phi: FloatArray) -> FloatArray:
    """Return π·d/φ by Johnson's datum."""
    w_i, w_j = as_floats((1 - alpha) / 2), as_floats((1 + alpha) / 2)
    return Bodies(w_i, beta, as_floats(2 * np.log(2) - 2 + w_j)).arc_of_load(phi).L


def _over_loads() -> pd.DataFrame:
    """Tabulate the error over α and φ for bodies of one ν."""
    parts = [_table(LOADS, alpha, G * alpha, PHI) for alpha in np.linspace(-1.0, 1.0, COUNT)]
    return pd.concat(parts, ignore_index=True)


def _over_plane() -> pd.DataFrame:
    """Tabulate the error over Dundurs' plane; β alone decides from where to where α goes."""
    parts = []
    for beta in BETAS:
        alphas = np.linspace(max(-1.0, 4 * beta - 1), min(1.0, 4 * beta + 1), COUNT)
        parts.append(_table(PLANE, alphas, float(beta), as_floats(PLANE_PHI)))
    return pd.concat(parts, ignore_index=True)


def _rows(bench: Bench, joint: Joint) -> pd.DataFrame:
    """Tabulate the error of a pair of named materials."""
    pair = pair_of(bench, joint, 0.01, 10.0)
    return _table(label_of(joint), pair.alpha, float(pair.beta), JOINT_PHI)


def _table(name: str, alpha: FloatArray, beta: float, phi: FloatArray) -> pd.DataFrame:
    """Tabulate the error for one β."""
    alpha = as_floats(alpha)
    return error_table("pair", name, alpha, beta, phi, error_of_E_star(alpha, beta, phi))


def _headline(table: pd.DataFrame, named: pd.DataFrame) -> dict[str, float]:
    """Return the extremes of the maps, and each named pair's error at φ = 1."""
    errors = table.groupby("pair")["error_percent"]
    numbers: dict[str, float] = {}
    for pair, where in ((LOADS, "nu = 0.3, φ to 10"), (PLANE, "any pair, φ = 1")):
        lowest, highest = errors.get_group(pair).min(), errors.get_group(pair).max()
        numbers |= {f"{where}: lowest, %": lowest, f"{where}: highest, %": highest}
    at_one = named[named["phi"] == PLANE_PHI].set_index("pair")["error_percent"]
    numbers |= {f"{pair}, φ = 1, %": error for pair, error in at_one.items()}
    return {key: float(number) for key, number in numbers.items()}


def _draw_maps(table: pd.DataFrame, named: pd.DataFrame) -> Figure:
    """Draw both maps."""
    figure = new_figure("full", 80.0)
    loads, plane = panels = figure.subplots(1, 2)
    signed_axis(loads.xaxis, 0.5)
    draw_plane(plane)
    for axes in panels:
        axes.set(xlim=(-1, 1), xlabel=r"Dundurs' $\alpha$ (-), positive: pin softer")
    for axis in (loads.xaxis, plane.xaxis, plane.yaxis):
        axis.set_minor_locator(AutoMinorLocator(5))
    plain_log(loads, "y", (0.001, 0.01, 0.1, 1, 10))
    loads.set(ylabel=r"load $\varphi = f/(E^*\Delta R)$ (-)", ylim=(PHI[0], PHI[-1]))
    plane.set(ylabel=r"Dundurs' $\beta$ (-)")
    panel_title(loads, 0, rf"$\nu$ = {NU:g} for both")
    panel_title(plane, 1, rf"any pair, $\varphi$ = {PLANE_PHI:g}")
    add_scale(figure, list(panels), "error of the penetration with $E^*$ alone (%)")
    of_loads = draw_contours(loads, *_grid(table, LOADS, "phi", (COUNT, PHI.size)))
    of_plane = draw_contours(plane, *_grid(table, PLANE, "beta", (BETAS.size, COUNT)))
    points = named.drop_duplicates("pair")
    figure.draw_without_rendering()
    _number_points(plane, points, of_plane)
    label_contours(loads, of_loads, np.empty((0, 2)))
    label_contours(plane, of_plane, np.vstack([points[["alpha", "beta"]], *_edges()]))
    return figure


def _edges() -> tuple[FloatArray, FloatArray]:
    """Return points on the two slanted edges of what is possible, each of shape (m, 2)."""
    alpha = np.linspace(-1.0, 1.0, 81)
    above = np.column_stack([alpha, (alpha + 1) / 4])
    return above, above - np.array([0.0, 0.5])


def _grid(
    table: pd.DataFrame, pair: str, upwards: str, shape: tuple[int, int]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return α, the other coordinate and the error of a map."""
    rows = table[table["pair"] == pair]
    alpha, other, error = (
        rows[name].to_numpy().reshape(shape) for name in ("alpha", upwards, "error_percent")
    )
    return alpha, other, error


def _number_points(axes: Axes, points: pd.DataFrame, contours: QuadContourSet) -> None:
    """Number the named pairs, with their names in the corners that no pair reaches."""
    lines = [
        axes.transData.transform(path.interpolated(8).vertices) for path in contours.get_paths()
    ]
    names: dict[bool, list[str]] = {True: [], False: []}
    rows = zip(points["pair"], points["alpha"], points["beta"], strict=True)
    for number, (pair, alpha, beta) in enumerate(rows, start=1):
        softer_pin = bool(alpha > 0)
        axes.plot(alpha, beta, "o", color="black", clip_on=False, zorder=4)
        axes.annotate(
            str(number),
            xy=(alpha, beta),
            xytext=_beside(axes, (alpha, beta), np.concatenate(lines), softer_pin),
            textcoords="offset points",
            horizontalalignment="right" if softer_pin else "left",
            verticalalignment="center",
            fontsize=small_text(),
            path_effects=[RIM],
            zorder=5,
        )
        names[softer_pin].append(f"{number}  {pair}")
    axes.text(-0.95, 0.47, "\n".join(names[True]), va="top", fontsize=small_text())
    below = "\n".join(names[False])
    axes.text(0.95, -0.47, below, ha="right", multialignment="left", fontsize=small_text())


def _beside(
    axes: Axes, point: tuple[float, float], lines: FloatArray, to_left: bool
) -> tuple[float, float]:
    """Return the offset in points of a number beside a point that is farthest from lines."""
    em = small_text()
    pixels = axes.figure.dpi / 72
    offsets = [((-0.6 if to_left else 0.6) * em, up * em) for up in (-0.4, -0.2, 0, 0.2, 0.4)]

    def room(offset: tuple[float, float]) -> float:
        middle = np.array([1.5, 1]) * offset * pixels + axes.transData.transform(point)
        return float(np.hypot(*(lines - middle).T).min())

    return max(offsets, key=room)
