"""How far the contacts of six multibody codes are from the law that they are fitted to."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from cylcontact.export import CODES, contact_parameters
from cylcontact.mechanism import ClearanceJoint, joint_from
from cylcontact.plots.figure import Drawing, new_figure, plain_log
from cylcontact.plots.style import COLOURS, LINE_STYLES, MARKERS, QUIET
from cylcontact.reports.bench import Bench
from cylcontact.support.arrays import FloatArray

from .joints import STEEL

LOW, HIGH = 100.0, 10000.0  # N
FORCE: FloatArray = np.geomspace(LOW, HIGH, 61)
CAPTION = (
    "Error (%) of the normal force of the contacts that multibody codes have of their own, each "
    "with the parameters that are closest to the explicit law over this range, against the total "
    "force (N). A steel pin of 20 mm in its bearing, 10 mm long, radial clearance 0.05 mm."
)
METHOD = (
    "The formula of each code as its documentation states it, at the penetration of the law. "
    "Fitted is the logarithm of the force, at forces spaced evenly by their logarithm. Adams and "
    "Exudyn have a power; Chrono (Hooke), Drake and Simscape a stiffness; MuJoCo an impedance "
    "that rises with the penetration. The headline has Adams' default, 1e5 N/mm and 2.2, beside "
    "them. The joint is our choice, E and ν of high-strength steel are assumed."
)
# Codes whose elastic force is the same share a line.
LINES = {
    "Chrono, Drake, Simscape": "chrono",
    "Adams, Exudyn": "adams",
    "MuJoCo": "mujoco",
}


def draw(bench: Bench) -> Drawing:
    joint = _joint(bench)
    depth = joint.law.penetration(FORCE / joint.pair.contact_length("the figure"), joint.pair)
    parts, headline = [], {}
    for code in CODES:
        parameters = contact_parameters(joint, code, LOW, HIGH)
        force = parameters.force(1e-3 * depth)
        columns = {"code": code, "force_N": FORCE, "penetration_um": 1e3 * depth}
        error = 100 * (force / FORCE - 1)
        parts.append(pd.DataFrame(columns | {"code_force_N": force, "error_percent": error}))
        headline[f"{code}: largest error, %"] = 100 * parameters.force_error[0]
    for number in (0, 30, 60):
        softer = (FORCE[number] / 1e5) ** (1 / 2.2) / depth[number]
        headline[f"Adams' default at {FORCE[number]:g} N: penetration over the law's"] = softer
    table = pd.concat(parts, ignore_index=True)
    return Drawing(_draw_lines(table), table, headline, CAPTION, METHOD)


def _joint(bench: Bench) -> ClearanceJoint:
    """Return the joint; its damping and friction do not matter here."""
    steel = bench.material(STEEL).material
    body = {"E": float(steel.E) / 1e3, "nu": float(steel.nu)}
    return joint_from({
        "name": "pin", "units": "SI", "length": 10.0, "law": "explicit",
        "bearing": {"R": 10.0, **body}, "pin": {"R": 9.95, **body},
        "dissipation": {"factor": "exact", "restitution": 0.9},
        "friction": {"coefficient": 0.1, "v0": 1.0, "v1": 10.0},
    })  # fmt: skip


def _draw_lines(table: pd.DataFrame) -> Figure:
    """Draw the error of each kind of contact over the force."""
    figure = new_figure("column", 66.0)
    axes = figure.subplots()
    axes.axhline(0, color=QUIET, linewidth=0.6, linestyle="-", marker="", zorder=1)
    for number, (label, code) in enumerate(LINES.items()):
        rows = table[table["code"] == code]
        axes.plot(
            rows["force_N"].to_numpy(),
            rows["error_percent"].to_numpy(),
            label=label,
            color=COLOURS[number],
            linestyle=LINE_STYLES[number],
            marker=MARKERS[number],
            markevery=(3 + 2 * number, 12),
        )
    plain_log(axes, "x", (100, 200, 500, 1000, 2000, 5000, 10000))
    axes.set(xlim=(LOW, HIGH), xlabel="total force (N)", ylabel="error of the code's force (%)")
    axes.legend()
    return figure
