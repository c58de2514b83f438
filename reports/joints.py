"""Pins in holes of other materials, for the figures beyond the paper.

By the names of both, or anywhere in the plane of Dundurs' α and β.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import FixedLocator, FuncFormatter

from cylcontact.bodies.pair import CylinderPair
from cylcontact.plots.maps import signed
from cylcontact.reports.bench import Bench
from cylcontact.support.arrays import FloatArray

from .paper import ELASTIC, origins

STEEL, ALUMINIUM = "high-strength steel", "aluminium alloy"
# Each a pin and a hole.
Joint = tuple[str, str]
_SHORT = {STEEL: "steel", ALUMINIUM: "aluminium"}


def label_of(joint: Joint) -> str:
    """Return "pin in hole" with short names."""
    return " in ".join(_SHORT.get(name, name) for name in joint)


def pair_of(bench: Bench, joint: Joint, dR: float, R_i: FloatArray | float) -> CylinderPair:
    """Return the pair, ΔR and R_i in mm."""
    pin, hole = (bench.material(name).material for name in joint)
    return CylinderPair.from_dR("internal", dR, hole, R_i=R_i, material_j=pin)


def origins_of(bench: Bench, joints: Iterable[Joint]) -> str:
    """Return which E and ν are not the paper's own."""
    names = list(dict.fromkeys(name for joint in joints for name in joint))
    return origins({name: bench.material(name) for name in names}, names, ELASTIC)


def error_table(
    kind: str,
    name: str,
    alpha: FloatArray,
    beta: FloatArray | float,
    phi: FloatArray,
    error_percent: FloatArray,
) -> pd.DataFrame:
    """Tabulate errors over α, β and φ, which broadcast, with a first column that names them all."""
    columns = np.broadcast_arrays(alpha, beta, phi, error_percent)
    # Round-off would differ from machine to machine; + 0.0 removes −0.0.
    values = np.round(np.column_stack([column.ravel() for column in columns]), 9) + 0.0
    table = pd.DataFrame(values, columns=["alpha", "beta", "phi", "error_percent"])
    table.insert(0, kind, name)
    return table


def signed_axis(axis: Axis, step: float) -> None:
    """Put signed numbers on a linear axis."""
    axis.set_major_locator(FixedLocator(list(np.arange(-2, 3) * step)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: signed(value)))


def draw_plane(axes: Axes) -> None:
    """Prepare axes for a map over α and β, with the outline of the pairs that are possible."""
    axes.plot([-1, -1, 1, 1, -1], [0, -0.5, 0, 0.5, 0], "-", color="black", lw=0.8, marker="")
    axes.set(xlim=(-1, 1), ylim=(-0.5, 0.5))
    signed_axis(axes.xaxis, 0.5)
    signed_axis(axes.yaxis, 0.25)
