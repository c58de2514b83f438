"""Mechanisms as data: bodies, joints and one clearance, read from a spec."""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cylcontact.errors import InputError
from cylcontact.impact import IMPACT_RATE_FLOOR, hysteresis_factor
from cylcontact.laws import LAWS, ContactLaw
from cylcontact.materials import Material, find_material, known_materials, own_table
from cylcontact.mechanism.assumptions import assumptions
from cylcontact.mechanism.spec import ClearanceSpec, MaterialSpec, MechanismSpec
from cylcontact.mechanism.unusual import unusual_masses
from cylcontact.pair import CylinderPair, unusual_lengths
from cylcontact.spec import parse_spec, read_toml

__all__ = [
    "GROUND",
    "Body",
    "Clearance",
    "Integration",
    "Joint",
    "Mechanism",
    "Point",
    "mechanism_from",
    "read_mechanism",
]

GROUND = -1
Point = tuple[float, float]

# Assumptions that no spec can change.
_ASSUMED = (
    "start: the journal centred in its bearing and at rest in it",
    f"slowest impact that dissipates as its factor says = {IMPACT_RATE_FLOOR} mm/s",
)

# The values that commands may set, and their keys in a spec.
_OVERRIDES = {
    "law": "clearance.law",
    "clearance": "clearance.radial",
    "restitution": "clearance.restitution",
    "friction": "clearance.friction",
    "revolutions": "integration.revolutions",
    "tolerance": "integration.tolerance",
}


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

    `direction` and `angle` are in rad, `speed` in rad/s; which of them are used depends on `kind`,
    "revolute", "prismatic" or "driver".
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


@dataclass(frozen=True)
class Clearance:
    """The clearance joint: lengths in m, speeds in m/s, the pair and the law in mm, N and MPa.

    Body i carries the bearing, body j the journal.
    """

    joint: str
    i: int
    j: int
    point_i: Point
    point_j: Point
    radial: float
    R_bearing: float
    length: float
    law: ContactLaw
    pair: CylinderPair | None
    chi: float
    friction: float
    v0: float
    v1: float
    rate_floor: float = IMPACT_RATE_FLOOR * 1e-3


@dataclass(frozen=True)
class Integration:
    """The settings of the integration in a spec."""

    alpha: float
    beta: float
    max_step: float
    tolerance: float
    revolutions: int


@dataclass(frozen=True)
class Mechanism:
    """A mechanism; build one with `read_mechanism` or `mechanism_from`.

    Attributes
    ----------
    name : str
    bodies : tuple of Body
    joints : tuple of Joint
        All joints, including the one with the clearance.
    clearance : Clearance
    gravity : pair of float
        In m/s².
    integration : Integration
    data : dict
        The spec, including changes.
    source : str
        Its name in errors.
    """

    name: str
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    clearance: Clearance
    gravity: Point
    integration: Integration
    data: dict[str, Any] = field(repr=False)
    source: str = "mechanism"

    @property
    def driver(self) -> Joint:
        """The joint that turns at constant speed."""
        return next(joint for joint in self.joints if joint.kind == "driver")

    @property
    def ideal(self) -> bool:
        """Whether the clearance is zero, so that its joint is a revolute like the others."""
        return self.clearance.radial == 0.0

    @property
    def constraints(self) -> tuple[Joint, ...]:
        """The joints that constrain: all except the one with a clearance."""
        return tuple(j for j in self.joints if self.ideal or j.name != self.clearance.joint)

    @property
    def period(self) -> float:
        """The time of one revolution of the driver in s."""
        return 2 * math.pi / abs(self.driver.speed)

    @property
    def assumptions(self) -> tuple[str, ...]:
        """Every assumption as "key = value": those of the spec and those of the model."""
        return (*assumptions(self.data), *_ASSUMED)

    @property
    def warnings(self) -> tuple[str, ...]:
        """A sentence for each mass, inertia or length of the joint that can hardly be meant."""
        pair = self.clearance.pair
        return (*unusual_masses(self.data), *(() if pair is None else unusual_lengths(pair)))


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
        Values that replace those of the spec: `law` (a name or a ContactLaw), `clearance` in mm,
        `restitution`, `friction`, `revolutions`, `tolerance`. None keeps the value of the spec.

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
    >>> [body.name for body in mechanism.bodies], mechanism.clearance.law
    (['crank', 'rod', 'slider'], Johnson())
    """
    own = own_table(None if materials is None else str(materials), Path(path).parent, str(path))
    return mechanism_from(read_toml(path), str(path), own, **changes)


def mechanism_from(
    data: dict[str, Any], source: str = "mechanism", own: Path | None = None, **changes: Any
) -> Mechanism:
    """Return the mechanism of a spec's data; see `read_mechanism`."""
    changed = copy.deepcopy(data)
    _set_materials(changed, source, own)
    law = changes.pop("law", None)
    for key, value in {**changes, "law": law if isinstance(law, str) else None}.items():
        if key not in _OVERRIDES:
            raise InputError(source, key, value, "cannot be set", f"choose {', '.join(_OVERRIDES)}")
        if value is not None:
            _set(changed, _OVERRIDES[key], value)
    spec = parse_spec(MechanismSpec, changed, source)
    chosen = LAWS[spec.clearance.law]() if law is None or isinstance(law, str) else law
    if chosen is law:
        changed["clearance"]["law"] = repr(law)
    names = {"ground": GROUND} | {name: index for index, name in enumerate(spec.bodies)}
    joints = tuple(_joint(spec, name, names) for name in spec.joints)
    return Mechanism(
        name=spec.name,
        bodies=tuple(
            Body(name, body.mass, body.inertia, (*body.guess[:2], math.radians(body.guess[2])))
            for name, body in spec.bodies.items()
        ),
        joints=joints,
        clearance=_clearance(spec, joints, names, chosen),
        gravity=spec.gravity,
        integration=Integration(**spec.integration.model_dump()),
        data=changed,
        source=source,
    )


def _set(data: dict[str, Any], key: str, value: Any) -> None:
    """Set a value by its dotted key, and mark it as chosen in the provenance."""
    table, _, name = key.partition(".")
    if isinstance(data.get(table), dict):
        data[table][name] = value
    origin = data.get("provenance")
    if isinstance(origin, dict):
        for kind, keys in origin.items():
            if isinstance(keys, list):
                origin[kind] = [listed for listed in keys if listed != key]
        origin.setdefault("chosen", []).append(key)


def _set_materials(data: dict[str, Any], source: str, own: Path | None) -> None:
    """Put materials in the places of their names, and where their numbers are from."""
    clearance, origin = data.get("clearance", {}), data.get("provenance", {})
    for body in ("pin", "hole"):
        if not isinstance(clearance, dict) or not isinstance(clearance.get(body), str):
            continue
        key, table = f"clearance.{body}", "the tables of materials"
        row = find_material(clearance[body], known_materials(own), source, key, table)
        material = row.material
        values = {"E": float(material.E) * 1e-3, "nu": material.nu}
        if material.yield_stress is not None:
            values["yield_stress"] = material.yield_stress
        clearance[body] = {"name": material.name, **values}
        columns = {"E": "E_GPa", "nu": "nu", "yield_stress": "yield_stress_MPa"}
        for name in values if isinstance(origin, dict) else ():
            origin.setdefault(row.provenance[columns[name]], []).append(f"{key}.{name}")


def _joint(spec: MechanismSpec, name: str, names: dict[str, int]) -> Joint:
    """Return a joint with the indices of its bodies and the coordinates of its points."""
    joint = spec.joints[name]
    bodies, points = [], []
    for end in joint.between:
        body, _, point = end.partition(".")
        bodies.append(names[body])
        owner = spec.ground if body == "ground" else spec.bodies[body]
        points.append(owner.points[point] if point else (0.0, 0.0))
    return Joint(
        name=name,
        kind=joint.type,
        i=bodies[0],
        j=bodies[1],
        point_i=points[0],
        point_j=points[1],
        direction=math.radians(joint.direction or 0.0),
        angle=math.radians(joint.angle),
        speed=(joint.speed or 0.0) * 2 * math.pi / 60,
    )


def _material(c: ClearanceSpec, own: MaterialSpec | None) -> Material:
    """Return the material of a body: its own, or that of both."""
    if own is not None:
        return Material(own.name, f"{own.E!r} GPa", own.nu, own.yield_stress)
    assert c.E is not None
    assert c.nu is not None
    return Material("joint", f"{c.E!r} GPa", c.nu, c.yield_stress)


def _clearance(
    spec: MechanismSpec, joints: tuple[Joint, ...], names: dict[str, int], law: ContactLaw
) -> Clearance:
    """Return the clearance joint, in SI except for the pair."""
    c = spec.clearance
    joint = next(joint for joint in joints if joint.name == c.joint)
    ends = [(joint.i, joint.point_i), (joint.j, joint.point_j)]
    if names[c.bearing] != joint.i:
        ends.reverse()
    pair = None
    if c.radial > 0:
        pin, hole = _material(c, c.pin), _material(c, c.hole)
        pair = CylinderPair.from_dR(
            "internal", c.radial, length=c.length, R_i=c.R_bearing, pin=pin, hole=hole
        )
    return Clearance(
        joint=c.joint,
        i=ends[0][0],
        j=ends[1][0],
        point_i=ends[0][1],
        point_j=ends[1][1],
        radial=c.radial * 1e-3,
        R_bearing=c.R_bearing * 1e-3,
        length=c.length,
        law=law,
        pair=pair,
        chi=float(hysteresis_factor(c.factor)(c.restitution)),
        friction=c.friction,
        v0=c.v0 * 1e-3,
        v1=c.v1 * 1e-3,
    )
