"""Figs 17 to 19: the joint of the slider-crank, whose masses and lengths are ours."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from cylcontact.laws import LAWS
from cylcontact.mechanism import Trajectory, read_mechanism, simulate
from cylcontact.plots.figure import legend_below, new_figure, panel_title, panels
from cylcontact.plots.style import width_mm
from cylcontact.support.arrays import FloatArray

SPEC = "datasets/slider_crank.toml"
DRAWN = {
    "lankarani-nikravesh": "Lankarani-Nikravesh",
    "johnson": "Johnson",
    "enhanced": "enhanced",
}
LOSSES = list(product((1.0, 0.9), (0.0, 0.1)))  # restitution, friction
# The revolutions of Figs 18 and 19: the runs that settle have settled by the eleventh.
FIRST, LAST = 10, 40
# Runs of a case, by their longest step in s. Where the motion is chaotic they differ by chance.
RUNS = (1e-4, 2e-5, 5e-6)
POINTS = 1000  # times in a revolution, of which an impact has about ten
CELLS = 80  # of a picture of a path, along each axis
SHARES = LogNorm(1e-3, 1.0)  # percent of the time in a cell
BEYOND = 121  # penetrations of a curve
WIDE = 120.0  # mm; in a narrower figure the curves are below the pictures


def run(law: str, revolutions: int, max_step: float, **case: Any) -> Trajectory:
    """Simulate a case; beyond its end a law goes on along its tangent. The longest step is in s."""
    mechanism = read_mechanism(SPEC, law=law, max_step=max_step, **case)
    return simulate(mechanism, revolutions, beyond="tangent")


def fig17() -> tuple[Figure, pd.DataFrame]:
    """Contact force against penetration over the first impact of the slider-crank, at two radial
    clearances; restitution 0.9, no friction. Thick: above on approach, below on return. Thin: the
    law without dissipation. The bodies are elastic throughout. The paper does not say which impact
    it draws: this one is the hardest of the start, and the same for all laws.
    """
    figure, parts = panels(2, 70.0, below_mm=6.0)
    tables = []
    for number, (axes,) in enumerate(parts):
        clearance = (0.5, 0.02)[number]
        for colour, (law, name) in enumerate(DRAWN.items()):
            table = first_impact(law, clearance)
            tables.append(table)
            depth, force = table["penetration_um"], 1e-3 * table["force_N"]
            axes.plot(depth, force, color=f"C{colour}", marker="", label=name)
            elastic = {"linestyle": "-", "color": f"C{colour}", "marker": "", "linewidth": 0.5}
            axes.plot(depth, 1e-3 * table["elastic_force_N"], **elastic)
        axes.set(xlabel="penetration (µm)", ylabel="contact force (kN)")
        axes.set(xlim=(0, None), ylim=(0, None))
        panel_title(axes, number, f"radial clearance {clearance:g} mm")
    legend_below(parts[0][0], 4)
    return figure, pd.concat(tables, ignore_index=True)


def first_impact(law: str, clearance: float) -> pd.DataFrame:
    """Return force and penetration over the first contact, with a hundred steps in it."""
    hit = run(law, 1, 5e-7, clearance=clearance, restitution=0.9, friction=0.0)
    onset, release = hit.contacts[["onset_s", "release_s"]].iloc[0]
    rows = hit.in_contact & (hit.time >= onset) & (hit.time <= release)
    pair = hit.mechanism.joint.pair
    length = pair.contact_length("the joint")
    depth = np.maximum(hit.penetration[rows], 0.0)  # m; at its ends a rounding error is left
    columns = {"time_us": 1e6 * (hit.time[rows] - onset), "penetration_um": 1e6 * depth}
    columns["force_N"] = hit.normal_force[rows]
    columns["elastic_force_N"] = LAWS[law]().load(1e3 * depth, pair) * length
    return pd.DataFrame({"law": law, "clearance_mm": clearance, **columns})


def fig18() -> tuple[Figure, pd.DataFrame]:
    """Where the journal's centre is in its bearing, at a radial clearance of 0.5 mm: share of the
    time in each cell, over revolutions 11 to 40 of three runs, for the three laws (columns),
    restitutions c_e and friction coefficients c_f (rows, each with limits of its own). Outside the
    circle journal and bearing touch. Curves: how much of the time the penetration is deeper than
    x; thin, each of the runs, which differ in the longest step of the integrator alone. Where the
    thin lines spread, the motion is chaotic, and differences between laws within that spread are
    chance: without losses (first row) even the share of contact is.
    """
    return paths(0.5)


def fig19() -> tuple[Figure, pd.DataFrame]:
    """As Fig 18, at a radial clearance of 0.02 mm. Without dissipation (upper rows) phases in which
    the journal whirls along its bearing come and go; whether a given revolution is one of them is
    chance. Johnson's law ends at a penetration of 10.8 µm; from 9.7 µm on it continues along its
    tangent, which the upper rows reach.
    """
    return paths(0.02)


class Case(NamedTuple):
    """The runs of a law: places of the journal in parts of the clearance, shape (run, time, 2)."""

    law: str
    restitution: float
    friction: float
    places: FloatArray


def paths(clearance: float) -> tuple[Figure, pd.DataFrame]:
    """Draw where the journal is and how deep it goes, for all laws and losses."""
    width = width_mm("page")
    figure, tables = new_figure("page", 0.88 * width if width >= WIDE else 2.3 * width), []
    if width >= WIDE:
        left, right = figure.subfigures(1, 2, width_ratios=(1.3, 1))
        curves = right.subplots(len(LOSSES), 1)
    else:
        left, right = figure.subfigures(2, 1, height_ratios=(1.4, 1))
        curves = right.subplots(2, 2).ravel()
    grid = left.subplots(len(LOSSES), len(DRAWN))
    for row, losses in enumerate(LOSSES):
        cases = [simulated(law, clearance, *losses) for law in DRAWN]
        reach = 1.05 * max(float(np.abs(case.places).max()) for case in cases)
        deepest = max(quantile(case, 0.999) for case in cases)
        depth = np.linspace(0, deepest, BEYOND)
        for column, case in enumerate(cases):
            share = cells(case, reach)
            picture(grid[row, column], share, reach)
            tables += [table_of_cells(case, clearance, share, reach)]
            tables += beyond(curves[row], case, clearance, depth, f"C{column}")
        label = f"$c_e$ = {losses[0]:g}, $c_f$ = {losses[1]:g}"
        grid[row, 0].set_ylabel(f"{label}\n$y$ / clearance (-)")
        curves[row].set(xlim=(0, 1e3 * clearance * deepest), ylim=(0, None), title=label)
        curves[row].set_ylabel("time deeper (%)")
        for axes in grid[row, 1:]:
            axes.tick_params(labelleft=False)
    for axes, name in zip(grid[0], DRAWN.values(), strict=True):
        axes.set_title(name if width >= WIDE else name.replace("-", "-\n"))
    for axes in grid[-1]:
        axes.set_xlabel("$x$ / clearance (-)")
    for axes in curves if width >= WIDE else curves[2:]:
        axes.set_xlabel("penetration (µm)")
    bar = left.colorbar(grid[0, 0].images[0], ax=grid, location="bottom", aspect=40, pad=0.02)
    bar.set_label("time in a cell (%)")
    bar.set_ticks([0.001, 0.01, 0.1, 1.0], labels=["0.001", "0.01", "0.1", "1"])
    legend_below(curves[0])
    return figure, pd.concat(tables, ignore_index=True)


def simulated(law: str, clearance: float, restitution: float, friction: float) -> Case:
    """Run a case a few times and return where the journal is, at even times."""
    places = []
    for step in RUNS:
        case = {"clearance": clearance, "restitution": restitution, "friction": friction}
        motion = run(law, LAST, step, **case)
        # One time more than a whole number in each: no revolution is sampled as the one before.
        revolution = np.linspace(FIRST, LAST, POINTS * (LAST - FIRST) + 1, endpoint=False)
        eccentricity = motion.eccentricity_at(revolution * motion.mechanism.period)  # m
        places.append(-1e3 * eccentricity / clearance)
    return Case(law, restitution, friction, np.array(places))


def penetrations(case: Case) -> Iterator[FloatArray]:
    """Yield the penetrations of each run in clearances; negative in flight."""
    for places in case.places:
        yield np.hypot(*places.T) - 1


def quantile(case: Case, share: float) -> float:
    """Return the penetration in clearances that this share of the time is not deeper."""
    return max(float(np.quantile(depth, share)) for depth in penetrations(case))


def cells(case: Case, reach: float) -> FloatArray:
    """Return the percentage of the time in each cell of a picture, rows along y."""
    edges = np.linspace(-reach, reach, CELLS + 1)
    x, y = case.places.reshape(-1, 2).T
    counts, *_ = np.histogram2d(y, x, bins=(edges, edges))
    return 100 * counts / x.size


def picture(axes: Axes, share: FloatArray, reach: float) -> None:
    """Draw the percentage of the time in each cell, and the circle of the clearance."""
    seen = np.ma.masked_equal(share, 0)
    axes.imshow(
        seen, cmap="viridis_r", norm=SHARES, origin="lower", extent=(-reach, reach, -reach, reach)
    )
    circle = {"facecolor": "none", "edgecolor": "0.35", "linewidth": 0.5, "linestyle": "-"}
    axes.add_patch(Circle((0, 0), 1.0, **circle))
    axes.set(xticks=(-1, 0, 1), yticks=(-1, 0, 1))


def table_of_cells(case: Case, clearance: float, share: FloatArray, reach: float) -> pd.DataFrame:
    """Return the cells in which the journal has been, by their middle."""
    middle = 1e3 * clearance * reach * (2 * (np.arange(CELLS) + 0.5) / CELLS - 1)
    row, column = np.nonzero(share)
    columns = {"x_um": middle[column], "y_um": middle[row], "percent": share[row, column]}
    return labelled(case, clearance, "time in a cell", columns)


def beyond(
    axes: Axes, case: Case, clearance: float, depth: FloatArray, colour: str
) -> list[pd.DataFrame]:
    """Draw how much of the time the penetration is deeper, of all runs and of each."""
    shares = [100 * np.mean(run[:, None] > depth, axis=0) for run in penetrations(case)]
    microns, look = 1e3 * clearance * depth, {"color": colour, "marker": ""}
    for share in shares:
        axes.plot(microns, share, linestyle="-", linewidth=0.4, **look)
    axes.plot(microns, np.mean(shares, axis=0), label=DRAWN[case.law], **look)
    tables = []
    for number, share in enumerate(shares, 1):
        columns = {"run": number, "depth_um": microns, "percent": share}
        tables.append(labelled(case, clearance, "time deeper", columns))
    return tables


def labelled(case: Case, clearance: float, what: str, columns: dict[str, Any]) -> pd.DataFrame:
    """Return a table of a case, with what its percentages are."""
    of_case = {"law": case.law, "clearance_mm": clearance, "restitution": case.restitution}
    return pd.DataFrame({"quantity": what, **of_case, "friction": case.friction, **columns})


FIGURES = {"fig17": fig17, "fig18": fig18, "fig19": fig19}
