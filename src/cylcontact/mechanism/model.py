"""Mechanisms as data: bodies, joints ideal or with clearance, springs and loads, from a spec."""

from __future__ import annotations

import cmath
import copy
import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import combinations
from pathlib import Path
from typing import Any, Literal

from pydantic import Field, model_validator

from cylcontact.bodies.fits import Fit
from cylcontact.bodies.material import own_table, shipped_materials
from cylcontact.bodies.pair import unusual_lengths
from cylcontact.files.spec import Spec, broken, parse_spec, read_toml
from cylcontact.impact import IMPACT_RATE_FLOOR
from cylcontact.joint.clearance import (
    ClearanceJoint,
    ClearanceJointSpec,
    Point,
    build_joint,
    named_law,
)
from cylcontact.support.arrays import require
from cylcontact.support.errors import InputError

GROUND = -1

# Assumptions that no spec can change.
_ASSUMED = (
    "start: every pin centred in its bearing and at rest in it",
    f"slowest impact that dissipates as its factor says = {IMPACT_RATE_FLOOR} mm/s",
)

# Assumed bounds, an order of magnitude or more from any machine: a body as heavy as tungsten that
# fills a cube around the whole mechanism, and radii of gyration by its extent.
_DENSITY = 20e3  # kg/m³
_SLIMMEST = 1e-3

# --- the spec -----------------------------------------------------------------------------------


class BodySpec(Spec):
    """A rigid body."""

    mass: float = Field(gt=0, description="the mass in kg")
    inertia: float = Field(gt=0, description="the moment of inertia about the centre, kg m²")
    points: dict[str, Point] = Field(
        description="named points in m from the centre, {pin = [x, y]}"
    )
    guess: tuple[float, float, float] = Field(
        description="a rough position to assemble from, [x, y, degrees]", strict=False
    )


class GroundSpec(Spec):
    """The ground."""

    points: dict[str, Point] = Field(description="named points in m, {pivot = [x, y]}")


class JointSpec(Spec):
    """A joint between two bodies; one with clearance has the keys of a joint's file as well."""

    name: str = Field(description="the joint's name")
    type: Literal["revolute", "prismatic", "driver"] = Field(
        "revolute", description='"revolute", "prismatic" or "driver"'
    )
    between: tuple[str, str] = Field(
        description='two points, ["rod.eye", "slider.pin"], that of the bearing first; two bodies '
        "for a driver",
        strict=False,
    )
    direction: float | None = Field(None, description="the slide's direction in degrees")
    angle: float = Field(0.0, description="the angle between the bodies in degrees")
    speed: float | None = Field(None, description="the speed in rpm, negative for clockwise")
    ramp: float = Field(0.0, ge=0, description="the time in s in which the speed is reached")
    torque: float | None = Field(None, description="the driving torque in N m, in place of a speed")

    @model_validator(mode="after")
    def _check(self) -> JointSpec:
        for key, of in (("direction", "prismatic"), ("speed", "driver"), ("torque", "driver")):
            if getattr(self, key) is not None and self.type != of:
                raise broken(key, getattr(self, key), f"is not for a {self.type}", "remove it")
        if self.type == "prismatic" and self.direction is None:
            raise broken("direction", None, "is required for a prismatic", "add direction")
        if self.type == "driver" and (self.speed is None) == (self.torque is None):
            rule = "is required for a driver" if self.speed is None else "is given beside a torque"
            raise broken("speed", self.speed, rule, "give speed in rpm, or torque in N m")
        if self.type == "driver" and not (self.speed or self.torque):
            raise broken("speed", self.speed, "must not be zero", "give it in rpm")
        return self


class SpringSpec(Spec):
    """A spring and damper between two points, or two bodies that turn against each other."""

    between: tuple[str, str] = Field(
        description='two points, ["ground.pivot", "rod.eye"], or two bodies', strict=False
    )
    stiffness: float = Field(0.0, ge=0, description="N/m, or N m/rad between bodies")
    damping: float = Field(0.0, ge=0, description="N s/m, or N m s/rad between bodies")
    length: float = Field(0.0, ge=0, description="the length without force in m")
    angle: float = Field(0.0, description="the angle without moment in degrees")

    @model_validator(mode="after")
    def _check(self) -> SpringSpec:
        key, of = ("length", "bodies") if self.turning else ("angle", "points")
        if key in self.model_fields_set:
            raise broken(key, getattr(self, key), f"is not for a spring between {of}", "remove it")
        return self

    @property
    def turning(self) -> bool:
        """Whether it is between two bodies, not points."""
        return all("." not in end for end in self.between)


class LoadSpec(Spec):
    """A constant force at a point, in the axes of the ground, and a moment."""

    at: str = Field(description='a point of a body, "slider.pin"')
    force: Point = Field((0.0, 0.0), description="the force in N, [x, y]")
    moment: float = Field(0.0, description="the moment in N m, positive anticlockwise")


class IntegrationSpec(Spec):
    """How to integrate."""

    alpha: float = Field(0.5, ge=0, description="Baumgarte's α in 1/s")
    beta: float = Field(0.5, ge=0, description="Baumgarte's β in 1/s")
    max_step: float = Field(1e-4, gt=0, description="the longest step in s")
    tolerance: float = Field(gt=0, lt=1, description="the tolerance, e.g. 1e-8")
    revolutions: int = Field(ge=1, description="revolutions of the drive, at least 1")
    period: float | None = Field(
        None, gt=0, description="the time in s of what counts as one revolution without a speed"
    )


class MechanismSpec(Spec):
    """A mechanism's file."""

    name: str = Field(description="the mechanism's name")
    gravity: Point = Field((0.0, 0.0), description="the acceleration of gravity in m/s², [x, y]")
    ground: GroundSpec = Field(description="a table [ground.points]")
    bodies: dict[str, BodySpec] = Field(min_length=1, description="a table [bodies.NAME] for each")
    joint: tuple[JointSpec, ...] = Field(description="a table [[joint]] for each", strict=False)
    spring: tuple[SpringSpec, ...] = Field(
        (), description="a table [[spring]] for each", strict=False
    )
    load: tuple[LoadSpec, ...] = Field((), description="a table [[load]] for each", strict=False)
    integration: IntegrationSpec = Field(description="a table [integration]")

    @model_validator(mode="after")
    def _check_names(self) -> MechanismSpec:
        if "ground" in self.bodies:
            raise broken("bodies.ground", None, "is no body's name", "it is what does not move")
        names = [joint.name for joint in self.joint]
        for name in names:
            if names.count(name) > 1 or "." in name:
                rule = "has a point in it" if "." in name else "is the name of two joints"
                raise broken("joint", name, rule, "give each a name of its own")
        for joint in self.joint:
            for end in joint.between:
                self._check_end(f"joint.{joint.name}.between", end, joint.type == "driver")
        for spring in self.spring:
            for end in spring.between:
                self._check_end("spring.between", end, spring.turning)
        for load in self.load:
            self._check_end("load.at", load.at, whole_body=False)
        period, turns = self.integration.period, any(joint.speed for joint in self.joint)
        if turns == (period is not None):
            rule = f"is {'given beside' if turns else 'required without'} a driver of a given speed"
            remedy = "remove it" if turns else "add what counts as one revolution, s"
            raise broken("integration.period", period, rule, remedy)
        return self

    def _check_end(self, key: str, end: str, whole_body: bool) -> None:
        body, _, point = end.partition(".")
        bodies: dict[str, BodySpec | GroundSpec] = {"ground": self.ground, **self.bodies}
        if body not in bodies:
            raise broken(key, end, "names no body", f"bodies: {', '.join(bodies)}")
        if whole_body and point:
            raise broken(key, end, "names a point", "a driver takes two bodies")
        if not whole_body and point not in bodies[body].points:
            points = ", ".join(bodies[body].points)
            raise broken(key, end, "names no point", f"points of {body}: {points}")


# --- the mechanism ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Body:
    """A rigid body: mass in kg, inertia in kg m², and the guess (x, y, θ) in m and rad."""

    name: str
    mass: float
    inertia: float
    guess: tuple[float, float, float]


@dataclass(frozen=True)
class Joint:
    """A joint of bodies i and j (−1 is the ground) at points in their own axes, in m.

    `direction` and `angle` are in rad, `speed` in rad/s, `ramp` in s, `torque` in N m; which of
    them are used depends on `kind`, "revolute", "prismatic" or "driver". Only a revolute has a
    `clearance`, with the bearing in body i.
    """

    name: str
    kind: str
    i: int
    j: int
    point_i: Point = (0.0, 0.0)
    point_j: Point = (0.0, 0.0)
    direction: float = 0.0
    angle: float = 0.0
    speed: float = 0.0
    ramp: float = 0.0
    torque: float = 0.0
    clearance: ClearanceJoint | None = field(default=None, compare=False)

    @property
    def contact(self) -> ClearanceJoint:
        """Pin and bearing of a joint with clearance, their law, dissipation and friction."""
        assert self.clearance is not None
        return self.clearance


@dataclass(frozen=True)
class Spring:
    """A spring and damper of bodies i and j, in SI; `turning` ones act between their angles."""

    turning: bool
    i: int
    j: int
    point_i: Point
    point_j: Point
    stiffness: float
    damping: float
    rest: float


@dataclass(frozen=True)
class Load:
    """A constant force in N at a point of a body in m, in the axes of the ground, and a moment."""

    body: int
    point: Point
    force: Point
    moment: float


@dataclass(frozen=True)
class Mechanism:
    """A mechanism; build one with `read_mechanism` or `mechanism_from`.

    Attributes
    ----------
    name : str
    bodies : tuple of Body
    joints : tuple of Joint
    springs : tuple of Spring
    loads : tuple of Load
    gravity : pair of float
        In m/s².
    integration : IntegrationSpec
    data : dict
        The spec, including changes.
    source : str
        Its name in errors.
    """

    name: str
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    springs: tuple[Spring, ...]
    loads: tuple[Load, ...]
    gravity: Point
    integration: IntegrationSpec
    data: dict[str, Any] = field(repr=False, hash=False)
    source: str = "mechanism"

    @property
    def clearances(self) -> tuple[Joint, ...]:
        """The joints with clearance."""
        return tuple(joint for joint in self.joints if joint.clearance is not None)

    @property
    def clearance(self) -> Joint:
        """The joint with clearance; an `InputError` unless there is one."""
        names = [joint.name for joint in self.clearances]
        rule, remedy = f"{len(names)} joints have a clearance", "take one of `clearances`"
        require(len(names) == 1, self.source, "joint", ", ".join(names) or None, rule, remedy)
        return self.clearances[0]

    @property
    def driver(self) -> Joint:
        """The first joint that turns at a given speed; an `InputError` without one."""
        drivers = [joint for joint in self.joints if joint.speed]
        rule, remedy = "none turns at a given speed", "give a driver its speed"
        require(len(drivers) > 0, self.source, "joint", None, rule, remedy)
        return drivers[0]

    @property
    def period(self) -> float:
        """The time of one revolution of the driver in s, or what counts as one."""
        given = self.integration.period
        return 2 * math.pi / abs(self.driver.speed) if given is None else given

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What every simulation assumes, in words."""
        return _ASSUMED if self.clearances else ()

    @property
    def warnings(self) -> tuple[str, ...]:
        """A sentence for each mass, inertia or length that can hardly be meant."""
        texts = [*self._unusual_masses()]
        for joint in self.clearances:
            texts += unusual_lengths(joint.contact.pair)
        held = sum({"driver": 1}.get(joint.kind, 2) for joint in self.joints if not joint.torque)
        free = 3 * len(self.bodies) - held
        if free > 0 and any(joint.speed for joint in self.joints):
            texts.append(f"beside the driver {free} coordinates are free: is a joint missing?")
        return tuple(texts)

    def _unusual_masses(self) -> Iterator[str]:
        """Yield a sentence for each mass above the mechanism's extent in tungsten and the like."""
        places = [complex(*point) for point in self.data["ground"]["points"].values()]
        for body in self.bodies:
            x, y, angle = body.guess
            arms = (0.0, 0.0), *self.data["bodies"][body.name]["points"].values()
            places += [complex(x, y) + cmath.rect(1.0, angle) * complex(*arm) for arm in arms]
        size = max(abs(a - b) for a, b in combinations(places, 2))
        for body in self.bodies:
            has, of = f"{body.name} has", f"in a mechanism of {size:.3g} m"
            radius = math.sqrt(body.inertia / body.mass)
            if body.mass > _DENSITY * size**3:
                yield f"{has} {body.mass:g} kg {of}; masses are in kg, not in g"
            elif not _SLIMMEST * size <= radius <= size:
                text = f"{has} a radius of gyration of {radius:.3g} m {of}"
                yield f"{text}; inertias are in kg m², not in g mm² or kg mm²"


def read_mechanism(
    path: Path | str, materials: Path | str | None = None, **changes: Any
) -> Mechanism:
    """Read a mechanism's spec.

    Parameters
    ----------
    path : path
        A TOML file, e.g. datasets/slider_crank.toml.
    materials : path, optional
        Your own table of materials; by default datasets/materials.csv if there is one, beside the
        file, above it or here.
    **changes
        Values that replace those of the spec: `law` (a name, a fit's result or a ContactLaw),
        `clearance` in mm (0: ideal), `restitution` and `friction` of every joint with clearance,
        `revolutions`, `tolerance`. None keeps the value of the spec.

    Returns
    -------
    Mechanism

    Raises
    ------
    InputError
        With the first mistake in the file.

    Examples
    --------
    >>> mechanism = read_mechanism("datasets/slider_crank.toml", law="johnson", clearance=0.02)
    >>> [body.name for body in mechanism.bodies], mechanism.clearance.contact.law
    (['crank', 'rod', 'slider'], Johnson())
    """
    own = own_table(materials, Path(path).parent, str(path))
    return mechanism_from(read_toml(path), str(path), own, **changes)


def mechanism_from(
    data: dict[str, Any], source: str = "mechanism", own: Path | None = None, **changes: Any
) -> Mechanism:
    """Return the mechanism of a spec's data; see `read_mechanism`."""
    for former in ("clearance", "joints"):
        rule = "is an entry of [[joint]] now"
        require(not isinstance(data.get(former), dict), source, f"[{former}]", None, rule, _ENTRY)
    changed, law = copy.deepcopy(data), changes.get("law")
    given = changed.get("joint")
    entries = given if isinstance(given, list) and all(isinstance(e, dict) for e in given) else []
    _change(changed, entries, source, changes)
    kinematic = [{k: entry[k] for k in entry if k not in _OF_CONTACT} for entry in entries]
    spec = parse_spec(MechanismSpec, changed | ({"joint": kinematic} if entries else {}), source)
    for key in _OF_JOINTS:
        good = changes.get(key) is None or any(map(_has_clearance, entries))
        rule = "is for joints with clearance, and there is none"
        require(good, source, key, changes.get(key), rule, "leave it out, or give one a clearance")
    points = {f"ground.{name}": at for name, at in spec.ground.points.items()}
    for body, its in spec.bodies.items():
        points |= {f"{body}.{name}": at for name, at in its.points.items()}
    index = {"ground": GROUND} | {name: number for number, name in enumerate(spec.bodies)}

    def end(name: str) -> tuple[int, Point]:
        return index[name.partition(".")[0]], points.get(name, (0.0, 0.0))

    joints = []
    for about, entry in zip(spec.joint, entries, strict=True):
        (i, point_i), (j, point_j) = map(end, about.between)
        direction, angle = math.radians(about.direction or 0.0), math.radians(about.angle)
        speed, torque = (about.speed or 0.0) * 2 * math.pi / 60, about.torque or 0.0
        kind = about.type, i, j, point_i, point_j, direction, angle, speed, about.ramp, torque
        joints.append(_with_contact(Joint(about.name, *kind), entry, source, own, law))
    bodies = []
    for name, its in spec.bodies.items():
        x, y, degrees = its.guess
        bodies.append(Body(name, its.mass, its.inertia, (x, y, math.radians(degrees))))
    springs = []
    for of in spec.spring:
        (i, point_i), (j, point_j) = map(end, of.between)
        rest = math.radians(of.angle) if of.turning else of.length
        springs.append(Spring(of.turning, i, j, point_i, point_j, of.stiffness, of.damping, rest))
    loads = tuple(Load(*end(about.at), about.force, about.moment) for about in spec.load)
    parts = tuple(bodies), tuple(joints), tuple(springs), loads, spec.gravity
    return Mechanism(spec.name, *parts, spec.integration, changed, source)


_ENTRY = (
    'write [[joint]] with name = "wrist-pin", between = ["slider.pin", "rod.eye"], '
    "clearance = 0.5, length = 10.0, law, bearing, pin, dissipation, friction"
)
_OF_CONTACT = ClearanceJointSpec.model_fields.keys() - {"name"}
# The values that commands may set, with their places in an entry of a joint or in a table.
_OF_JOINTS = {
    "law": ("law",),
    "clearance": ("clearance",),
    "restitution": ("dissipation", "restitution"),
    "friction": ("friction", "coefficient"),
}
_OF_INTEGRATION = ("revolutions", "tolerance")


def _has_clearance(entry: dict[str, Any]) -> bool:
    return bool(_OF_CONTACT & entry.keys())


def _change(
    data: dict[str, Any], entries: list[dict[str, Any]], source: str, changes: dict[str, Any]
) -> None:
    """Set the values of a command in a spec's data, of which the entries are joints."""
    joints = [*filter(_has_clearance, entries)]
    for key, value in changes.items():
        known = (*_OF_JOINTS, *_OF_INTEGRATION)
        require(key in known, source, key, value, "cannot be set", f"choose {', '.join(known)}")
        if value is None:
            continue
        if key in _OF_INTEGRATION and isinstance(data.get("integration"), dict):
            data["integration"][key] = value
        for entry in joints if key in _OF_JOINTS else []:
            if key == "clearance":
                _forget_radii(entry, source)
            *tables, last = _OF_JOINTS[key]
            table = entry.setdefault(tables[0], {}) if tables else entry
            if isinstance(table, dict):
                table[last] = value if key != "law" or isinstance(value, str) else repr(value)


def _forget_radii(entry: dict[str, Any], source: str) -> None:
    """Let a clearance decide the pin's radius; of a fit, keep the hole of its middle."""
    bearing, pin = entry.get("bearing"), entry.get("pin")
    if isinstance(pin, dict):
        pin.pop("R", None)
    if isinstance(bearing, dict) and "fit" in entry:
        bearing["R"] = Fit.read(str(entry.pop("fit")), source, "fit").middle[0]


def _with_contact(
    joint: Joint, entry: dict[str, Any], source: str, own: Path | None, law: Any
) -> Joint:
    """Return a joint with the contact of its entry, if it has a clearance."""
    if not _has_clearance(entry) or entry.get("clearance") == 0:
        if isinstance(law, str):
            named_law(law, source)  # refuses one that is not known
        return joint
    data = {key: value for key, value in entry.items() if key == "name" or key in _OF_CONTACT}
    try:
        rule, remedy = "has no clearance", "give it to a revolute"
        require(joint.kind == "revolute", source, "type", joint.kind, rule, remedy)
        contact = build_joint(data, source, own, None if isinstance(law, str) else law)
        for body in ("bearing", "pin"):
            point = data[body].get("point", [0.0, 0.0])
            rule, remedy = "is where `between` says", "remove it"
            require(point == [0.0, 0.0], source, f"{body}.point", None, rule, remedy)
    except InputError as error:
        key = f"joint.{joint.name}.{error.key}"
        raise InputError(error.source, key, error.value, error.rule, error.remedy) from None
    for body, material in (("bearing", contact.pair.material_i), ("pin", contact.pair.material_j)):
        if entry[body].get("material") and material.name not in shipped_materials():
            # As a saved run has it, without the user's table.
            named = {"E": f"{float(material.E)!r} MPa", "nu": float(material.nu)}
            if material.yield_stress is not None:
                named["yield_stress"] = float(material.yield_stress)
            entry[body] = named | {k: v for k, v in entry[body].items() if k != "material"}
    (x_i, y_i), (x_j, y_j) = joint.point_i, joint.point_j
    bearing, pin = (1e3 * x_i, 1e3 * y_i), (1e3 * x_j, 1e3 * y_j)
    placed = replace(contact, data=data, point_bearing=bearing, point_pin=pin)
    return replace(joint, clearance=placed)
