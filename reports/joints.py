"""Pins in holes of other materials, by the names of both, for the figures beyond the paper."""

from __future__ import annotations

from collections.abc import Iterable

from cylcontact.arrays import FloatArray
from cylcontact.pair import CylinderPair
from cylcontact.reports.bench import Bench

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
