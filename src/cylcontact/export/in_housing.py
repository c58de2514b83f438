"""A law in the housing of one joint as a law of δ, E* and ΔR alone, which every language takes.

With the materials and R_o/R_i given, φ = f/(E*·ΔR) is a function of d = δ/ΔR. It is written as a
table: a cubic in ln φ over ln d with the slopes of the curve at its nodes. Such cubics are a sum
that needs no search,

    ln φ = y₀ + s₀·(x − x₀) + Σ m²·(b + c·m),    m = max(x − x_k, 0),    x = ln d,

b and c being the jumps of the second and third derivatives at node k over 2 and 6.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np

from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.laws import Conformal, Housing, Sector
from cylcontact.laws.formula import Formula, Step, steps_of
from cylcontact.laws.law import Law
from cylcontact.laws.tabulated import cubic
from cylcontact.support.arrays import FloatArray

_TABLE = "f = E_star*dR*exp(y), y a cubic of x = ln(penetration/dR) between nodes"
# The largest errors of a table in load and stiffness, relative, and where it begins in ln d.
_LOAD, _STIFFNESS, _FIRST, _STEP, _DEEPEST = 5e-4, 5e-3, np.log(1e-9), 0.15, 1e6


@dataclass(frozen=True)
class Table(Formula):
    """A formula that is a table, as a sum over its nodes."""

    nodes: tuple[tuple[float, float, float], ...] = ()

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """The assignments up to f and k, and the end."""
        x, y, slope = np.array(self.nodes).T
        width, rise = np.diff(x), np.diff(y) / np.diff(x)
        square = (3 * rise - 2 * slope[:-1] - slope[1:]) / width
        third = (slope[:-1] + slope[1:] - 2 * rise) / width**2
        square_jumps, third_jumps = (np.diff(each, prepend=0.0) for each in (square, third))
        square_jumps[1:] -= 3 * third[:-1] * width[:-1]
        lines = [
            f"last = {float(np.exp(x[-1]))!r} * dR",
            "x = log(penetration / dR)",
            f"y = {float(y[0])!r} + {float(slope[0])!r} * (x - {float(x[0])!r})",
            f"s = {float(slope[0])!r}",
        ]
        jumps = zip(x[:-1].tolist(), square_jumps.tolist(), third_jumps.tolist(), strict=True)
        for at, b, c in jumps:
            lines += [
                f"m = max(x - {at!r}, 0)",
                f"y = y + m * m * ({b!r} + {c!r} * m)",
                f"s = s + m * ({2 * b!r} + {3 * c!r} * m)",
            ]
        return steps_of("\n".join([*lines, "f = E_star * dR * exp(y)", "k = f * s / penetration"]))


@dataclass(frozen=True)
class InHousing(Law):
    """A law in the housing of one joint."""

    stated: Formula
    name: ClassVar[str] = "in-housing"
    contacts: ClassVar[tuple[Contact, ...]] = ("internal",)

    def formula_for(self, contact: Contact) -> Formula:  # noqa: ARG002
        """Return the formula."""
        return self.stated

    def constants_for(self, contact: Contact) -> dict[str, float]:  # noqa: ARG002
        """Return none."""
        return {}


def law_in_housing(law: Conformal, pair: CylinderPair) -> tuple[InHousing, str]:
    """Return the law at one pair for export, and how far it is from its curve, in words."""
    curve = law.curve(pair)
    x = np.arange(_FIRST, np.log(min(_DEEPEST, curve.end[1])), _STEP)
    phi, slopes = curve.load(np.exp(x)), np.exp(x) * curve.stiffness(np.exp(x))
    nodes = _thinned(Nodes(x, np.log(phi), slopes / phi))
    stated = InHousing(Table(_function, end=_function, equation=_TABLE, nodes=nodes))
    ends = curve.penetration(np.array([1e-4, min(10.0, 0.999 * curve.end[0])]))
    d = np.geomspace(ends[0], ends[1], 400)
    error = np.abs(stated.load(d * pair.dR, pair) / law.load(d * pair.dR, pair) - 1).max()
    words = f"a table of {len(nodes)} nodes, within {100 * error:.2g} percent"
    remark = _remark(law.datum, pair) if isinstance(law.datum, Housing) else _materials(pair)
    return _remarked(stated, remark, words)


def _remarked(law: InHousing, remark: str, words: str) -> tuple[InHousing, str]:
    """Return a law whose formula says what it is for and how exact it is."""
    words += " of the load by the series, for f over E_star dR from 1e-4 to 10"
    return replace(law, stated=replace(law.stated, remark=f"{remark}. It is {words}")), words


class Nodes(NamedTuple):
    """ln d, ln φ and dln φ/dln d."""

    x: FloatArray
    y: FloatArray
    slopes: FloatArray


def _thinned(curve: Nodes) -> tuple[tuple[float, float, float], ...]:
    """Return the nodes that a table needs: every interval is halved until it is close enough."""
    x, y, slopes = curve
    first, last = 0, x.size - 1
    chosen, open_ = {first, last}, [(first, last)]
    while open_:
        low, high = open_.pop()
        inside = np.arange(low + 1, high)
        width, rise = x[high] - x[low], (y[high] - y[low]) / (x[high] - x[low])
        above, slope = cubic((x[inside] - x[low]) / width, width, rise, slopes[low], slopes[high])
        far = np.abs(y[low] + above - y[inside]).max(initial=0.0) > _LOAD
        if inside.size and (far or np.abs(slope / slopes[inside] - 1).max() > _STIFFNESS):
            middle = (low + high) // 2
            chosen.add(middle)
            open_ += [(low, middle), (middle, high)]
    nodes = sorted(chosen)
    return tuple(zip(*(each[nodes].tolist() for each in curve), strict=True))


def _function(penetration: FloatArray, _pair: CylinderPair) -> FloatArray:
    """Stand for a table, which has no constants."""
    return penetration


def _remark(housing: Housing, pair: CylinderPair) -> str:
    """Return what the law is for."""
    clamp = "all of its rim clamped"
    if isinstance(housing.clamp, Sector):
        angle, side = housing.clamp.angle, housing.clamp.side
        clamp = (
            f"{angle:g} degrees of its rim clamped, {side} from the load, which acts along the "
            "middle of this sector: the law is for no other direction"
        ).replace("near from", "near")
    R_i = float(np.asarray(pair.R_i))
    for material, radius in housing.layers:
        clamp += f", a ring of E = {material.E:g} MPa and nu = {material.nu:g} bonded around it "
        clamp += f"from {radius / R_i:g} R_i on"
    return (
        f"{_materials(pair)}, in a housing of R_o/R_i = {housing.R_o / R_i:g}, {clamp}. The "
        "penetration is that of the pin's centre against the clamped rim, less the clearance"
    )


def _materials(pair: CylinderPair) -> str:
    """Return what pins and holes the law is for."""
    hole, pin = pair.material_i, pair.material_j
    return (
        f"For a pin of E = {float(pin.E):g} MPa and nu = {float(pin.nu):g} in a hole of "
        f"E = {float(hole.E):g} MPa and nu = {float(hole.nu):g}, plane {pair.plane}"
    )
