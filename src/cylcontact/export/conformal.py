"""Conformal contact of one pair of materials, also in a housing, as a short table.

With materials and R_o/R_i given, L = π·E*·δ/f is one function of s = ln(1 + D·ΔR/δ), see
`cylcontact.laws.conformal.curve`. Here it has few nodes, which are even in s up to `near` and a
second time beyond, so that the interval of a penetration is a division and no search.
"""

from __future__ import annotations

from math import log, nan, pi
from typing import Annotated, Any, NamedTuple

import numpy as np

from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import Conformal, Housing, Persson, Sector
from cylcontact.laws.conformal.curve import FAR_STEP, make
from cylcontact.laws.formula import Formula, choose
from cylcontact.support.arrays import FloatArray
from cylcontact.support.errors import InputError

# Step, end of the close nodes and of all nodes in s, and the error of L, for `curve.make`: about 96
# nodes for a law, more in thin eyes and for a joint.
COARSE = 1 / 8, 8.0, 20.0, 1e-5
FINE = 1 / 32, 12.0, 32.0, 1e-8
# The loads f/(E*·ΔR) for which a file states its error.
_LOADS = np.geomspace(1e-9, 1e6, 601)
_EQUATION = "f = pi*E_star*penetration/L, L a cubic between nodes in s = ln(1 + D*dR/penetration)"
Nodes = Annotated[FloatArray, 0]
# Any one material: the law does not depend on it.
_ANY = Material("any", 200e3, 0.3)


class Line(NamedTuple):
    """L, and its slope by s."""

    L: float
    slope: float


def line_at(
    penetration, dR, D, first, step, near, near_count: int, far_step, last: int,
    values: Nodes, slopes: Nodes,
) -> Line:  # fmt: skip
    """Return L at a penetration, a cubic between nodes."""
    s = log(1 + D * dR / penetration)
    width = choose(s < near, step, far_step)
    place = choose(s < near, (s - first) / step, near_count + (s - near) / far_step)
    k = int(max(min(place, last - 1.0), 0.0))
    part = min(place - k, 1.0)
    rise = values[k + 1] - values[k]
    start = width * slopes[k]
    stop = width * slopes[k + 1]
    two = 3 * rise - 2 * start - stop
    three = start + stop - 2 * rise
    # Beyond the last node L is straight.
    L = values[k] + part * (start + part * (two + part * three)) + stop * max(place - last, 0.0)
    return Line(L, (start + part * (2 * two + part * 3 * three)) / width)


def load(
    penetration, E_star, dR, largest, D, first, step, near, near_count: int, far_step, last: int,
    values: Nodes, slopes: Nodes,
):  # fmt: skip
    """Return f = π·E*·δ/L."""
    at = line_at(penetration, dR, D, first, step, near, near_count, far_step, last, values, slopes)
    return choose(penetration <= largest * dR, pi * E_star * penetration / at.L, nan)


def stiffness(
    penetration, E_star, dR, largest, D, first, step, near, near_count: int, far_step, last: int,
    values: Nodes, slopes: Nodes,
):  # fmt: skip
    """Return df/dδ = π·E*·(1 − dln L/dln δ)/L."""
    at = line_at(penetration, dR, D, first, step, near, near_count, far_step, last, values, slopes)
    fall = at.slope * D * dR / ((D * dR + penetration) * at.L)
    return choose(penetration <= largest * dR, pi * E_star * (1 + fall) / at.L, nan)


def table_of(
    law: Conformal,
    pair: CylinderPair | None,
    nodes: tuple[float, ...] = COARSE,
    fitted: bool = False,
) -> tuple[Formula, dict[str, Any]]:
    """Return conformal contact at a pair as a formula, and its constants."""
    if pair is None:
        if not isinstance(law, Persson):
            rule = "depends on the materials, and on the radius in a housing"
            remedy = "give them, e.g. --material bronze --Ri 10 --Rj 9.95, or export persson"
            if fitted or isinstance(law.datum, Housing):  # which persson is not
                remedy = "give those of the fit, as --pin, --hole, --Ri and --Rj"
            raise InputError("export", "law", law.name, rule, remedy)
        pair = CylinderPair.from_dR("internal", 1.0, _ANY)
    curve = law.curve(pair)
    table = make(curve.bodies, *nodes).L
    terms, last = table.terms, table.terms[:, -1]
    widths = np.diff(table.nodes.s)
    values = np.append(terms[0], last.sum())
    slopes = np.append(terms[1] / widths, (last[1] + 2 * last[2] + 3 * last[3]) / widths[-1])
    constants: dict[str, Any] = {
        "largest": curve.end[1], "D": table.nodes.scale, "first": table.nodes.first,
        "step": table.nodes.step, "near": table.nodes.near, "near_count": table.nodes.near_count,
        "far_step": FAR_STEP, "last": widths.size,
        # Twelve digits are more than the curve has.
        "values": np.array([float(f"{x:.12g}") for x in values]),
        "slopes": np.array([float(f"{x:.12g}") for x in slopes]),
    }  # fmt: skip
    phi = _LOADS[_LOADS < 0.999 * curve.end[0]]
    error = max(
        abs(load(d, 1.0, 1.0, **constants) / exact - 1)
        for d, exact in zip(curve.penetration(phi).tolist(), phi.tolist(), strict=True)
    )
    remark = (
        f"{_about(law, pair)}. {values.size} nodes; the load is within {error:.0e} of the series "
        "for f/(E_star*dR) from 1e-9 to 1e6"
    )
    return Formula(load, stiffness, equation=_EQUATION, remark=remark), constants


def _about(law: Conformal, pair: CylinderPair) -> str:
    """Return what the table is for."""
    if isinstance(law, Persson):
        return "For bodies of one material"
    hole, pin = pair.material_i, pair.material_j
    bodies = (
        f"For a pin of E = {float(pin.E):g} MPa and nu = {float(pin.nu):g} in a hole of "
        f"E = {float(hole.E):g} MPa and nu = {float(hole.nu):g}, plane {pair.plane}"
    )
    housing = law.datum
    if not isinstance(housing, Housing):
        return bodies
    clamp = "all of its rim clamped"
    if isinstance(housing.clamp, Sector):
        where = {"pushed": "near the load", "pulled": "far from the load"}[housing.clamp.side]
        clamp = (
            f"{housing.clamp.angle:g} degrees of its rim clamped, {where}, which acts along the "
            "middle of this sector: the law is for no other direction"
        )
    R_i = float(np.asarray(pair.R_i))
    for material, radius in housing.layers:
        clamp += f", a ring of E = {material.E:g} MPa and nu = {material.nu:g} bonded around it "
        clamp += f"from {radius / R_i:g} R_i on"
    return (
        f"{bodies}, in a housing of R_o/R_i = {housing.R_o / R_i:g}, {clamp}. The penetration is "
        "that of the pin's centre against the clamped rim, less the clearance"
    )
