"""The clearance, modulus or length with which a joint meets a target."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from cylcontact.bodies.material import scaled
from cylcontact.bodies.pair import CylinderPair
from cylcontact.joint.answer import described
from cylcontact.joint.check import JointCheck, checked
from cylcontact.joint.loaded import LoadedJoint, law_of, warmed
from cylcontact.limits.sizing import TARGETS, UNKNOWNS, Unknown, find
from cylcontact.support.arrays import as_floats, require
from cylcontact.support.text_tables import TextTable

__all__ = ["Size", "size_of"]

# Which value of a band serves all of its pairs: the largest, or for a soft joint the smallest.
_NAMES = {"clearance": "radial clearance", "modulus": "modulus of the pin", "length": "length"}


@dataclass(frozen=True, eq=False)
class Size:
    """What meets a target, for one pair or for those of an ISO fit; `size_of` makes it.

    Attributes
    ----------
    joint : LoadedJoint
    unknown, target : str
        What was sought, and what it meets.
    wanted : float
        In N/mm², for a length N/mm; in mm, MPa, or as a factor.
    values : dict of float
        In mm or MPa, for "joint" or each pair of a fit. A clearance is that at 20 °C.
    """

    joint: LoadedJoint
    unknown: Unknown
    target: str
    wanted: float
    values: dict[str, float]

    @property
    def value(self) -> float:
        """The value; with a fit the largest, which serves the weakest pair."""
        return max(self.values.values())

    @cached_property
    def check(self) -> JointCheck:
        """The joint with this value, checked; with a fit the middle pair."""
        joint = self.joint
        pair, load = joint.drawn, float(joint.load)
        if self.unknown == "length":
            load, pair = load / self.value, replace(pair, length=self.value)
        elif self.unknown == "clearance":
            R_i, of = pair.R_i, 1.0 if pair.contact == "external" else -1.0
            assert R_i is not None
            R_j = of * (self.value - R_i) if of > 0 else R_i - self.value
            pair = replace(pair, dR=self.value, R_j=R_j)
        else:
            factor = self.value / float(as_floats(pair.material_j.E))
            hole, pin = (scaled(body, factor) for body in (pair.material_i, pair.material_j))
            pair = replace(pair, material_i=hole, material_j=pin)
        plain = replace(
            joint, drawn=pair, load=as_floats(load), iso=None, cold={"joint": pair}, weights={}
        )
        return checked(replace(plain, pairs={"joint": warmed(pair, plain)}))

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is wrong or doubtful with the joint of this value."""
        return self.check.warnings

    def __str__(self) -> str:
        joint = self.joint if self.joint.iso else self.check.joint
        return "\n".join([*described(joint)[:-1], "", *self._lines()])

    def _lines(self) -> list[str]:
        unit, (per, whole) = UNKNOWNS[self.unknown][0], TARGETS[self.target]
        is_length = self.unknown == "length"
        of = whole if is_length else per
        if self.target == "penetration":
            wanted = f"a penetration of {1e3 * self.wanted:g} µm"
        elif self.target == "factor":
            wanted = f"first yield at {self.wanted:g} times the load"
        else:
            name = {"stiffness": "a stiffness", "peak": "a largest pressure"}[self.target]
            wanted = f"{name} of {self.wanted:g} {of}"
        load = f"under {float(self.joint.load):g} {'N' if is_length else 'N/mm'}"
        name = _NAMES[self.unknown]
        if self.unknown == "clearance" and self.joint.drawn.contact == "external":
            name = "R_i + R_j"
        text = f"{name} = {self.value:.6g} {unit}"
        if name == "radial clearance":
            text += f" ({2 * self.value:.6g} mm on the diameter)"
            text += " at 20 °C" if self.joint.temperature else ""
        lines = [f"{text} gives {wanted} {load}"]
        if self.joint.iso is not None:
            rows = [[f"{value:.6g}" for value in self.values.values()]]
            rows[0].insert(0, f"{name}, {unit}")
            lines[0] = f"{text} serves every pair for {wanted} {load}"
            lines.append(str(TextTable(["", *self.values], rows)))
        return lines

    def to_dict(self) -> dict[str, Any]:
        """Return the answer under plain names, for JSON."""
        unit = UNKNOWNS[self.unknown][0]
        return {
            "sought": self.unknown,
            "unit": unit,
            "value": self.value,
            "values": self.values,
            self.target: self.wanted,
            "load": float(self.joint.load),
            "iso": self.joint.iso.code if self.joint.iso else None,
            "warnings": list(self.warnings),
            "joint": self.check.to_dict(),
        }


def size_of(joint: LoadedJoint, unknown: Unknown, **target: float) -> Size:
    """Return the clearance, modulus or length with which a joint meets a target.

    Parameters
    ----------
    joint : LoadedJoint
        The joint; for a length its load is the total force in N.
    unknown : {"clearance", "modulus", "length"}
    **target : float
        stiffness, penetration, peak or factor, as for `cylcontact.sizing.find`.
    """
    law = law_of(joint.drawn, joint.housing, joint.depth)
    key = next(iter(target))
    rule = "is not defined for a plane of unknown depth"
    needs = key in ("stiffness", "penetration")
    remedy = "give the depth, or a target of peak or factor"
    require(joint.has_penetration or not needs, "size", key, target[key], rule, remedy)
    values = {
        name: _value(joint, joint.cold[name], unknown, law, target) for name, _ in joint.solved()
    }
    return Size(joint, unknown, key, target[key], values)


def _value(
    joint: LoadedJoint,
    pair: CylinderPair,
    unknown: Unknown,
    law: Any,
    target: dict[str, float],
) -> float:
    """Return the value for one pair at 20 °C."""
    load = float(np.max(joint.load))
    return find(
        unknown, pair, load, law=law, temperature=joint.temperature, rim=joint.rim, **target
    )
