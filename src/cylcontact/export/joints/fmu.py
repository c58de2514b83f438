"""The FMU target: FMI 2.0, model exchange and co-simulation, around the C target."""

from __future__ import annotations

from pathlib import Path

from cylcontact.export.fmi import Model, Variable, fmu
from cylcontact.export.joints import c
from cylcontact.mechanism.joint import ClearanceJoint
from cylcontact.plain_text import comment

_MOTION = (
    ("x", "length", "position of the reference point"),
    ("y", "length", "position of the reference point"),
    ("angle", "angle", "angle, anticlockwise"),
    ("v_x", "speed", "velocity of the reference point"),
    ("v_y", "speed", "velocity of the reference point"),
    ("spin", "spin", "rate of the angle"),
)
_WRENCH = (
    ("force_x", "force", "force of the contact"),
    ("force_y", "force", "force of the contact"),
    ("moment", "moment", "moment of the contact about the reference point"),
)
_BODIES = {"bearing": "of the body with the hole", "pin": "of the body with the pin"}
# Name, quantity (empty for the integer), causality and description, in the order of the value
# references; fmi2_joint.c has the same.
VARIABLES: tuple[tuple[str, str, str, str], ...] = (
    *(
        (f"{body}.{name}", quantity, "input", f"{text} {of}")
        for body, of in _BODIES.items()
        for name, quantity, text in _MOTION
    ),
    *(
        (f"{body}.{name}", quantity, "output", f"{text} {of.replace('of', 'on', 1)}")
        for body, of in _BODIES.items()
        for name, quantity, text in _WRENCH
    ),
    ("penetration", "length", "output", "negative where the bodies do not touch"),
    ("penetration_rate", "speed", "output", "rate of the penetration"),
    ("normal_force", "force", "output", "normal part of the force, not negative"),
    ("friction_force", "force", "output", "tangential part of the force on the bearing"),
    ("tangential_velocity", "speed", "output", "of the bearing against the pin"),
    ("dissipated_power", "power", "output", "by damping and friction, not negative"),
    ("impact_rate", "speed", "local", "penetration rate at first touch; 0: no contact"),
    ("flag", "", "output", "1 above first yield, plus 2 beyond the law's domain"),
)

# Name of each quantity's unit, in SI or with mm, and its exponents of kg, m and s.
_UNITS: dict[str, tuple[str, str, dict[str, float]]] = {
    "length": ("m", "mm", {"m": 1}),
    "angle": ("rad", "rad", {"rad": 1}),
    "speed": ("m/s", "mm/s", {"m": 1, "s": -1}),
    "spin": ("rad/s", "rad/s", {"rad": 1, "s": -1}),
    "force": ("N", "N", {"kg": 1, "m": 1, "s": -2}),
    "moment": ("N.m", "N.mm", {"kg": 1, "m": 2, "s": -2}),
    "power": ("W", "N.mm/s", {"kg": 1, "m": 2, "s": -3}),
}

# At an event, bodies that approach each other within this distance in mm touch: whoever locates
# the root of the penetration leaves a small error on either side.
_TOUCH = 1e-6

_DEFINITIONS = """\
#include "{name}.h"

#define JOINT(part) {name}_##part
#define GUID "$guid"
#define RATE_FLOOR {floor!r}
#define TOUCH {touch!r}

"""


def source(joint: ClearanceJoint, stem: str = "") -> dict[str, bytes]:
    """Return the FMU by its file name, with sources and a library for this platform.

    Raises `InputError` if there is no C compiler, or it fails.
    """
    name = joint.identifier
    definitions = _DEFINITIONS.format(name=name, floor=joint.rate_floor, touch=_TOUCH / joint.in_mm)
    hooks = (Path(__file__).parent / "fmi2_joint.c").read_text(encoding="ascii")
    return {f"{stem or name}.fmu": fmu(model_of(joint), c.source(joint), definitions, hooks)}


def model_of(joint: ClearanceJoint) -> Model:
    """Return what the FMU of a joint says of it."""
    title, law = comment(joint.name), comment(joint.law.name)
    in_units = {"": ""}
    bases: dict[str, dict[str, float]] = {}
    for quantity, (in_SI, in_mm, exponents) in _UNITS.items():
        unit = in_SI if joint.units == "SI" else in_mm
        in_units[quantity] = unit
        bases[unit] = exponents if unit == in_SI else {**exponents, "factor": 0.001}
    return Model(
        joint.identifier,
        title,
        f"The clearance joint '{title}': law {law}, clearance {float(joint.pair.dR):.6g} mm",
        tuple(Variable(n, in_units[q], causality, text) for n, q, causality, text in VARIABLES),
        bases,
        indicators=1,
    )
