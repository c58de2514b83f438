"""The slider-crank: its file, its dimensions, and its equations of motion.

The frame has its origin at the crank's pivot and its first axis along the slide. A(t) is the crank
pin, prescribed by the driver. The rod, of length L, points in the direction u = (cos φ, sin φ), and
its far end is P = A + L·u. The centre of the joint on the slider is S = (s, h), with h the offset
of the slide. The coordinates are the two components of

    E = S − P,

that is, the eccentricity if the slider carries the bearing and its negative if the rod does. They
are of the size of the clearance, so that a relative tolerance applies to the clearance. They
determine the other coordinates as long as the rod is not perpendicular to the slide:

    sin φ = (h − A_y − E_y)/L,    s = A_x + L·cos φ + E_x.

With the force f on the slider, −f on the rod at P, a moment M on the rod, the moment of inertia J_A
of the rod about A and its centre of mass at a·u from A,

    J_A·φ̈ + m·a·u⊥·Ä = L·u⊥·(−f) + M + gravity,    m_s·s̈ = f_x + gravity,

and E follows by differentiating its definition twice. The driver's power is the moment of the
crank's reaction about its pivot times ω.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import Field

from cylcontact.bodies.iso286 import IsoFit
from cylcontact.bodies.material import own_table
from cylcontact.bodies.pair import unusual_lengths
from cylcontact.files.spec import Spec, parse_spec, read_toml
from cylcontact.joint import contact
from cylcontact.joint.clearance import ClearanceJoint, Point, build_joint, require_defined
from cylcontact.support.arrays import FloatArray, require
from cylcontact.support.errors import InputError
from cylcontact.support.numba_cache import called, inlined

# --- the file -----------------------------------------------------------------------------------


class BarSpec(Spec):
    """Crank or rod."""

    length: float = Field(gt=0, description="the length in mm")
    mass: float = Field(gt=0, description="the mass in kg")
    inertia: float = Field(gt=0, description="the moment of inertia about the centre, kg m²")
    centre: float = Field(
        0.5, description="the centre of mass as a share of the length, from the crank's pivot on"
    )


class SliderSpec(Spec):
    """The slider."""

    mass: float = Field(gt=0, description="the mass in kg")


class SliderCrankSpec(Spec):
    """A slider-crank's file."""

    name: str = Field(description="its name")
    speed: float = Field(description="the crank's speed in rpm, negative for clockwise")
    angle: float = Field(0.0, description="the crank's angle at the start in degrees")
    offset: float = Field(0.0, description="the distance of the slide from the pivot in mm")
    gravity: Point = Field((0.0, 0.0), description="[along, across] the slide in m/s²")
    crank: BarSpec = Field(description="a table [crank]")
    rod: BarSpec = Field(description="a table [rod]")
    slider: SliderSpec = Field(description="a table [slider]")
    bearing_of: Literal["rod", "slider"] = Field("rod", description='"rod" or "slider"')
    joint: dict[str, Any] = Field(description="a table [joint], with the keys of a joint's file")
    eccentricity: Point = Field(
        (0.0, 0.0), description="[x, y] in mm from the pin's centre to the bearing's, at the start"
    )
    eccentricity_rate: Point = Field((0.0, 0.0), description="its rate at the start in mm/s")
    max_step: float = Field(1e-4, gt=0, description="the longest step in s")
    tolerance: float = Field(1e-8, ge=1e-14, le=1e-3, description="the tolerance, e.g. 1e-8")
    revolutions: int = Field(10, ge=1, description="the number of revolutions of the crank")


# Values that `read_mechanism` may change: those of the joint, with their places, and others.
_OF_JOINT = {
    "law": ("law",),
    "clearance": ("clearance",),
    "restitution": ("dissipation", "restitution"),
    "friction": ("friction", "coefficient"),
}
_OTHERS = ("revolutions", "tolerance", "max_step")
# Assumed: the least rod length over the height that it must span. The rod then stays at least eight
# degrees away from the perpendicular to the slide, where the equations end.
_LEAST_ROD = 1.01
# Assumed, for warnings: a density in kg/m³ above tungsten's, the radii of gyration of a bar over
# its length, and ten times the gravity of the earth in m/s².
_DENSITY, _GYRATION, _GRAVITY = 20e3, (0.05, 1.5), 98.1

# A slider-crank for compiled functions, in SI. The reciprocals save divisions.
CRANK = np.dtype(
    [
        (name, np.float64)
        for name in (
            *("crank", "rod", "offset", "omega", "angle", "side"),
            *("crank_a", "crank_mass", "rod_a", "rod_mass"),
            *("gravity_x", "gravity_y", "per_rod", "per_rod_inertia", "per_slider_mass"),
        )
    ]
)
Crank = Any
# Cosine and sine of the crank's angle.
Turn = tuple[float, float]
# The rates of the equations: four of E and Ė, the driver's work, and `JOINT_LEDGERS`.
COORDINATES, DRIVE = 4, 4
JOINT_LEDGERS = ("normal_dissipation", "friction_dissipation", "penetration_integral", "impulse")
RATES = COORDINATES + 1 + len(JOINT_LEDGERS)


@dataclass(frozen=True, eq=False)
class SliderCrank:
    """A slider-crank with a clearance joint; build one with `read_mechanism`.

    Attributes
    ----------
    spec : SliderCrankSpec
        The content of its file.
    joint : ClearanceJoint
        The joint of rod and slider.
    data : dict
        The content of the file as read, with the changes.
    source : str
        Its name in errors.
    materials : path, optional
        The user's table of materials.
    """

    spec: SliderCrankSpec
    joint: ClearanceJoint
    data: dict[str, Any] = field(repr=False)
    source: str = "slider-crank"
    materials: Path | None = None

    @property
    def name(self) -> str:
        """Its name."""
        return self.spec.name

    @property
    def omega(self) -> float:
        """The crank's speed in rad/s."""
        return self.spec.speed * 2 * math.pi / 60

    @property
    def period(self) -> float:
        """The time of a revolution in s."""
        return 2 * math.pi / abs(self.omega)

    @property
    def side(self) -> float:
        """The sign of the eccentricity in E."""
        return 1.0 if self.spec.bearing_of == "slider" else -1.0

    @property
    def record(self) -> Any:
        """The numbers for compiled functions, of the type `CRANK`."""
        spec, m = self.spec, np.zeros(1, CRANK)[0]
        m["crank"], m["rod"] = 1e-3 * spec.crank.length, 1e-3 * spec.rod.length
        m["offset"], m["omega"] = 1e-3 * spec.offset, self.omega
        m["angle"], m["side"] = math.radians(spec.angle), self.side
        m["crank_a"], m["rod_a"] = spec.crank.centre * m["crank"], spec.rod.centre * m["rod"]
        m["crank_mass"], m["rod_mass"] = spec.crank.mass, spec.rod.mass
        m["gravity_x"], m["gravity_y"] = spec.gravity
        m["per_rod"], m["per_slider_mass"] = 1 / m["rod"], 1 / spec.slider.mass
        m["per_rod_inertia"] = 1 / (spec.rod.inertia + spec.rod.mass * m["rod_a"] ** 2)
        return m

    @property
    def start(self) -> FloatArray:
        """E in m and its rate in m/s at the start."""
        spec = self.spec
        return self.side * 1e-3 * np.array([*spec.eccentricity, *spec.eccentricity_rate])

    def changed(self, **changes: Any) -> SliderCrank:
        """Return this slider-crank with other values; see `read_mechanism`."""
        if changes.get("law") is None and self.data["joint"]["law"] == repr(self.joint.law):
            changes["law"] = self.joint.law  # it was given as an object
        return mechanism_from(self.data, self.source, self.materials, **changes)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about implausible masses, inertias, lengths or gravity."""
        return (*self._unusual_numbers(), *unusual_lengths(self.joint.pair))

    def _unusual_numbers(self) -> Iterator[str]:
        spec, hole = self.spec, 2 * float(self.joint.pair.radii("the joint")[0])
        length = self.joint.pair.contact_length("the joint")
        size = 1e-3 * max(spec.crank.length + spec.rod.length, length, hole)
        for name, body in (("crank", spec.crank), ("rod", spec.rod), ("slider", spec.slider)):
            if body.mass > _DENSITY * size**3:
                yield f"the {name} has {body.mass:g} kg; masses are in kg, not in g"
            elif isinstance(body, BarSpec):
                radius = 1e3 * math.sqrt(body.inertia / body.mass)
                if not _GYRATION[0] <= radius / body.length <= _GYRATION[1]:
                    what = f"the {name}, {body.length:g} mm long, has a radius of gyration of"
                    yield f"{what} {radius:.3g} mm; inertias are in kg m², not in g mm² or kg mm²"
        if (pull := math.hypot(*spec.gravity)) > _GRAVITY:
            yield f"gravity is {pull:g} m/s²; it is in m/s², not in mm/s²"


def read_mechanism(
    path: Path | str, materials: Path | str | None = None, **changes: Any
) -> SliderCrank:
    """Read the file of a slider-crank with a clearance between rod and slider.

    Parameters
    ----------
    path : path
        A TOML file, e.g. datasets/slider_crank.toml.
    materials : path, optional
        Your own table of materials; by default datasets/materials.csv if there is one, beside the
        file, above it or here.
    **changes
        Values that replace those of the file: `law` (a name, a fit's result or a ContactLaw),
        `clearance` in mm, `restitution`, `friction`, `revolutions`, `tolerance`, `max_step` in s.
        None keeps the value of the file.

    Returns
    -------
    SliderCrank

    Raises
    ------
    InputError
        With the first mistake in the file.

    Examples
    --------
    >>> crank = read_mechanism("datasets/slider_crank.toml", law="johnson", clearance=0.02)
    >>> crank.joint.law, round(1e3 * crank.period)
    (Johnson(), 12)
    """
    own = own_table(materials, Path(path).parent, str(path))
    return mechanism_from(read_toml(path), str(path), own, **changes)


def mechanism_from(
    data: dict[str, Any], source: str = "slider-crank", own: Path | None = None, **changes: Any
) -> SliderCrank:
    """Return the slider-crank of a file's data; see `read_mechanism`."""
    data, known = copy.deepcopy(data), (*_OF_JOINT, *_OTHERS)
    law = changes.get("law")
    given = None if isinstance(law, str) else law
    for key, value in changes.items():
        require(key in known, source, key, value, "cannot be set", f"choose {', '.join(known)}")
        if value is not None:
            _change(data, key, repr(value) if value is given else value, source)
    spec = parse_spec(SliderCrankSpec, data, source)
    try:
        joint = build_joint({"name": "joint", **spec.joint}, source, own, given)
        for body, point in (("bearing", joint.point_bearing), ("pin", joint.point_pin)):
            rule, remedy = "must be 0: the joint is at the end of the rod", "remove it"
            require(point == (0.0, 0.0), source, f"{body}.point", point, rule, remedy)
        require_defined(joint, source)
    except InputError as error:
        key = f"joint.{error.key}" if error.source == source else error.key
        raise InputError(error.source, key, error.value, error.rule, error.remedy) from None
    mechanism = SliderCrank(spec, joint, data, source, own)
    _require_motion(mechanism)
    return mechanism


def _require_motion(mechanism: SliderCrank) -> None:
    """Refuse a slider-crank that cannot turn, or starts outside its clearance."""
    spec, source, radial = mechanism.spec, mechanism.source, mechanism.joint.radial
    rule, remedy = "must not be zero", "give it in rpm"
    require(spec.speed != 0, source, "speed", spec.speed, rule, remedy)
    span = spec.crank.length + abs(spec.offset) + radial
    require(
        spec.rod.length >= _LEAST_ROD * span, source, "rod.length", spec.rod.length,
        f"is too short: crank, offset and clearance take {span:g} mm at the dead centre",
        f"give at least {_LEAST_ROD * span:.4g} mm",
    )  # fmt: skip
    start = math.hypot(*spec.eccentricity)
    rule, remedy = f"is outside the clearance of {radial:.4g} mm", "keep its length below that"
    require(start < radial, source, "eccentricity", [*spec.eccentricity], rule, remedy)


def _change(data: dict[str, Any], key: str, value: Any, source: str) -> None:
    """Set a value in a file's data; a clearance decides the pin's radius."""
    if key in _OTHERS:
        data[key] = value
        return
    joint = data.setdefault("joint", {})
    if not isinstance(joint, dict):  # refused with the file
        return
    bearing, pin = joint.get("bearing"), joint.get("pin")
    if key == "clearance" and isinstance(bearing, dict) and isinstance(pin, dict):
        pin.pop("R", None)
        if "iso" in joint:
            bearing["R"] = IsoFit.read(str(joint.pop("iso")), source, "joint.iso").middle[0]
    *tables, last = _OF_JOINT[key]
    table = joint.setdefault(tables[0], {}) if tables else joint
    if isinstance(table, dict):
        table[last] = value


# --- the equations ------------------------------------------------------------------------------

# Of Taylor's series.
_COS = (-1 / 2, 1 / 24, -1 / 720, 1 / 40320)
_SIN = (-1 / 6, 1 / 120, -1 / 5040, 1 / 362880)


@called
def crank_turn(t: float, m: Crank) -> Turn:
    """Return cosine and sine of the crank's angle."""
    theta = m.angle + m.omega * t
    return math.cos(theta), math.sin(theta)


@inlined
def later(turn: Turn, dt: float, m: Crank) -> Turn:
    """Return the cosine and sine of `crank_turn` a time dt later."""
    c, s = turn
    angle = m.omega * dt
    if abs(angle) > 0.1:
        x, y = math.cos(angle), math.sin(angle)
    else:  # Taylor's series to the last digit, without divisions
        z = angle * angle
        x = 1.0 + z * (_COS[0] + z * (_COS[1] + z * (_COS[2] + z * _COS[3])))
        y = angle * (1.0 + z * (_SIN[0] + z * (_SIN[1] + z * (_SIN[2] + z * _SIN[3]))))
    return c * x - s * y, s * x + c * y


@inlined
def _rod_motion(turn: Turn, y: FloatArray, m: Crank) -> tuple[float, float, float]:
    """Return sin φ, cos φ and φ̇ of the rod."""
    sine = (m.offset - m.crank * turn[1] - y[1]) * m.per_rod
    cosine = math.sqrt(1.0 - sine * sine)
    spin = -(m.omega * m.crank * turn[0] + y[3]) * m.per_rod / cosine
    return sine, cosine, spin


@inlined
def _motion(spin: float, y: FloatArray, m: Crank) -> contact.Motion:
    """Return the motion of the joint at a spin of the rod."""
    side = m.side
    of_bearing, of_pin = (0.0, spin) if side > 0 else (spin, 0.0)
    return contact.Motion(side * y[0], side * y[1], side * y[2], side * y[3], of_bearing, of_pin)


@inlined
def joint_motion(turn: Turn, y: FloatArray, m: Crank) -> contact.Motion:
    """Return the motion of the joint."""
    return _motion(_rod_motion(turn, y, m)[2], y, m)


@inlined
def derivatives(
    turn: Turn, y: FloatArray, rates: FloatArray, joint: contact.Joint, law: FloatArray, m: Crank
) -> None:
    """Write the rates of E, Ė and the ledgers."""
    c, s = turn
    sine, cosine, spin = _rod_motion(turn, y, m)
    omega, length, a = m.omega, m.rod, m.rod_a
    A_x, A_y = m.crank * c, m.crank * s
    a_x, a_y = -omega * omega * A_x, -omega * omega * A_y

    # Force on the slider, f, and moment on the rod about its end P.
    f_x, f_y, moment = 0.0, 0.0, 0.0
    for n in range(DRIVE + 1, RATES):
        rates[n] = 0.0
    if joint.touching:
        f = contact.forces(_motion(spin, y, m), joint.impact_rate, joint, law)
        f_x, f_y = m.side * f.x, m.side * f.y
        moment = f.moment_j if m.side > 0 else f.moment_i
        rates[DRIVE + 1], rates[DRIVE + 2] = f.normal_power, f.friction_power
        rates[DRIVE + 3], rates[DRIVE + 4] = f.delta, f.normal

    # The rod about A, in the accelerating frame; gravity on the rod reduces Ä.
    inertial = -a * sine * (a_x - m.gravity_x) + a * cosine * (a_y - m.gravity_y)
    turning = length * (sine * f_x - cosine * f_y) + moment
    alpha = (turning - m.rod_mass * inertial) * m.per_rod_inertia
    square = spin * spin

    rates[0], rates[1] = y[2], y[3]
    slider = f_x * m.per_slider_mass + m.gravity_x
    rates[2] = slider - a_x + length * (sine * alpha + cosine * square)
    rates[3] = -a_y - length * (cosine * alpha - sine * square)

    # The crank's reaction and the gravity on it, about the pivot.
    G_x = a_x - a * sine * alpha - a * cosine * square - m.gravity_x
    G_y = a_y + a * cosine * alpha - a * sine * square - m.gravity_y
    reaction_x, reaction_y = m.rod_mass * G_x + f_x, m.rod_mass * G_y + f_y
    weight = m.crank_mass * m.crank_a * (c * m.gravity_y - s * m.gravity_x)
    rates[DRIVE] = omega * (A_x * reaction_y - A_y * reaction_x - weight)
