"""The clearance joint in space as an element, from the functions of `mechanism.spatial_forces`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from cylcontact.export.element import Element, Motion
from cylcontact.export.joint import element_of as planar_element
from cylcontact.joint import contact, spatial_forces
from cylcontact.joint.spatial import SpatialJoint, SpatialState

# q + tan(x)/x*(ahead/2)*spin*q, x = ahead*abs(spin)/2: a turn, but for the quaternion's length.
_HALF = "0.5*ahead*(1 + ahead*ahead*(spin_x*spin_x + spin_y*spin_y + spin_z*spin_z)/12)"
_MOTION = (
    *(Motion(x, "length", "position of the reference point", f"{x} + ahead*v_{x}") for x in "xyz"),
    Motion("q_w", "number", "quaternion from the body's axes to the world's",
           f"q_w - {_HALF}*(spin_x*q_x + spin_y*q_y + spin_z*q_z)"),
    Motion("q_x", "number", "of any length but 0",
           f"q_x + {_HALF}*(spin_x*q_w + spin_y*q_z - spin_z*q_y)"),
    Motion("q_y", "number", "quaternion", f"q_y + {_HALF}*(spin_y*q_w + spin_z*q_x - spin_x*q_z)"),
    Motion("q_z", "number", "quaternion", f"q_z + {_HALF}*(spin_z*q_w + spin_x*q_y - spin_y*q_x)"),
    *(Motion(f"v_{x}", "speed", "velocity of the reference point") for x in "xyz"),
    *(Motion(f"spin_{x}", "spin", "angular velocity in the world's axes") for x in "xyz"),
)  # fmt: skip
_MEANINGS = {
    "force_bearing": ("force", "force on the body with the hole, in the world's axes"),
    "moment_bearing": ("moment", "about the reference point of this body"),
    "force_pin": ("force", "force on the body with the pin"),
    "moment_pin": ("moment", "about the reference point of this body"),
    "penetration": ("length", "at rims A (z > 0) and B, faces A and B; negative without contact"),
    "penetration_rate": ("speed", "rates of the penetrations"),
    "normal_force": ("force", "sum of the loads on the wall of the hole"),
    "dissipated_power": ("power", "by damping and friction, not negative"),
    "elastic_energy": ("energy", "stored in the contacts"),
    "touched": ("length", "length of the wall that touches"),
    "flag": ("", "sum of 1 yield, 2 beyond law, 4 no rims, 8 tilt > 0.1, 16 unlike, 32 left hole"),
}
_FUNCTIONS = (
    contact.bounded_ratio,
    *(getattr(spatial_forces, name) for name in (
        "load_at", "energy_at", "rotate", "resolve", "cross", "move", "section", "seek",
        "reach_faces", "reach", "slide", "press", "onset_at", "press_piece",
        "free_distance", "press_straight", "first_touch", "press_crowned", "press_rims",
        "press_faces", "finish", "reset", "invalidate", "evaluate", "accept",
    )),
)  # fmt: skip


_ASSUMPTIONS = (
    "two rigid bodies in space; the load of the law acts on each section of the length that "
    "touches, and all forces are derivatives of one energy",
    "rims as in three-dimensional elasticity for sharp edges and like materials; a sharp rim "
    "yields at once",
    "damping as of the planar joint, with an impact rate for each rim and each face; an impact "
    "slower than 1 mm/s counts as one at 1 mm/s",
    "friction by the sliding velocity, along the axis too, between its two speeds a ramp",
)


def element_of(joint: SpatialJoint) -> Element:
    """Return a spatial joint as functions, lists of names and words."""
    plane = planar_element(joint.planar)
    c, b = joint.spec.edge.constants
    return replace(
        plane,
        motion=_MOTION,
        meanings=_MEANINGS,
        constants={},
        about=[*plane.about, f"length {joint.spec.length!r} mm, rims with c = {c!r}, b = {b!r}"],
        assumptions=_ASSUMPTIONS,
        checks=list(_checks(joint)),
        contacts=4,
        program=replace(
            plane.program, functions=_FUNCTIONS, joint=joint.record, work=spatial_forces.WORK
        ),
    )


def _checks(joint: SpatialJoint) -> Iterator[tuple[Any, ...]]:
    """Yield states and wrenches: free, on one rim, on both."""
    mm = joint.planar.in_mm
    bearing = [0.0] * 3 + [1.0] + [0.0] * 9
    radial, half = joint.planar.radial, joint.spec.length / 2
    for away, lean in ((0.5, 0.0), (0.61, 0.4), (0.0, 1.02)):
        turn = 0.5 * lean * radial / half
        pin = [away * radial / mm, 0, 0, float(np.cos(turn)), 0, float(np.sin(turn)), 0]
        pin = [float(x) for x in (*pin, 50.0 / mm, 0.0, 1.0 / mm, 0.0, 0.5, 0.0)]
        rates = [0.0, 50.0 / mm, 0.0, 0.0]
        wrench = joint.evaluate(SpatialState(np.array(rates)), bearing, pin)
        yield rates, bearing, pin, wrench
