"""Specs of mechanisms: the models of their TOML files."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, Strict, model_validator

from cylcontact.impact import FACTORS
from cylcontact.laws import LAWS
from cylcontact.mechanism.assumptions import check_provenance
from cylcontact.modulus import Modulus
from cylcontact.spec import Spec, broken

__all__ = [
    "BodySpec",
    "ClearanceSpec",
    "GroundSpec",
    "IntegrationSpec",
    "JointSpec",
    "MechanismSpec",
    "ProvenanceSpec",
]

# TOML has lists, not tuples.
_Pair = Annotated[tuple[float, float], Strict(False)]


class BodySpec(Spec):
    """A rigid body."""

    mass: float = Field(gt=0, description="the mass in kg")
    inertia: float = Field(gt=0, description="the moment of inertia about the centre, kg m²")
    points: dict[str, _Pair] = Field(
        description="named points in m from the centre, {pin = [x, y]}", strict=False
    )
    guess: tuple[float, float, float] = Field(
        description="a rough position to assemble from, [x, y, degrees]", strict=False
    )


class GroundSpec(Spec):
    """The ground."""

    points: dict[str, _Pair] = Field(
        description="named points in m, {pivot = [x, y]}", strict=False
    )


class JointSpec(Spec):
    """A joint between two bodies."""

    type: Literal["revolute", "prismatic", "driver"] = Field(
        description='"revolute", "prismatic" or "driver"'
    )
    between: tuple[str, str] = Field(
        description='two points, ["crank.pin", "rod.pin"]; two bodies for a driver', strict=False
    )
    direction: float | None = Field(None, description="the slide's direction in degrees")
    angle: float = Field(0.0, description="the angle between the bodies in degrees")
    speed: float | None = Field(None, description="the speed in rpm, negative for clockwise")

    @model_validator(mode="after")
    def _check(self) -> JointSpec:
        required = {"revolute": None, "prismatic": "direction", "driver": "speed"}[self.type]
        for key in ("direction", "speed"):
            given = getattr(self, key) is not None
            if given and key != required:
                raise broken(key, getattr(self, key), f"is not for a {self.type}", "remove it")
            if key == required and not given:
                raise broken(key, None, f"is required for a {self.type}", f"add {key}")
        if self.type == "driver" and not self.speed:
            raise broken("speed", self.speed, "must not be zero", "give it in rpm")
        return self


class MaterialSpec(Spec):
    """A material, as its name in a table is replaced by it."""

    name: str = Field(description="its name")
    E: Modulus = Field(gt=0, description='Young\'s modulus in GPa, or with a unit, "207 GPa"')
    nu: float = Field(ge=0, le=0.5, description="Poisson's ratio")
    yield_stress: float | None = Field(None, gt=0, description="the yield stress in MPa")


class ClearanceSpec(Spec):
    """The revolute joint with clearance, and its contact."""

    joint: str = Field(description="the name of a revolute joint")
    bearing: str = Field(description="the body that carries the bearing")
    radial: float = Field(ge=0, description="the radial clearance in mm, 0 for an ideal joint")
    R_bearing: float = Field(gt=0, description="the radius of the bearing in mm")
    length: float = Field(gt=0, description="the axial length in mm")
    E: Modulus | None = Field(
        None, gt=0, description='Young\'s modulus of both bodies in GPa, or with a unit, "207 GPa"'
    )
    nu: float | None = Field(None, ge=0, le=0.5, description="Poisson's ratio of both bodies")
    yield_stress: float | None = Field(
        None, gt=0, description="the yield stress of both bodies in MPa"
    )
    pin: MaterialSpec | None = Field(None, description="the journal's material, by its name")
    hole: MaterialSpec | None = Field(None, description="the bearing's material, by its name")
    law: str = Field(description=f"a contact law: {', '.join(LAWS)}")
    restitution: float = Field(gt=0, le=1, description="the restitution, above 0 up to 1")
    factor: str = Field(description=f"a hysteresis factor: {', '.join(FACTORS)}")
    friction: float = Field(ge=0, description="the friction coefficient")
    v0: float = Field(ge=0, description="the speed in mm/s up to which there is no friction")
    v1: float = Field(gt=0, description="the speed in mm/s from which there is all of it")

    @model_validator(mode="after")
    def _check(self) -> ClearanceSpec:
        if self.radial >= self.R_bearing:
            raise broken(
                "radial", self.radial, "leaves no journal", f"keep it below {self.R_bearing} mm"
            )
        self._check_materials()
        if self.law not in LAWS:
            raise broken("law", self.law, "is not a law", f"choose {', '.join(LAWS)}")
        if self.factor not in FACTORS:
            raise broken("factor", self.factor, "is not known", f"choose {', '.join(FACTORS)}")
        if self.v1 <= self.v0:
            raise broken("v1", self.v1, f"must be above v0 = {self.v0}", "raise it")
        return self

    def _check_materials(self) -> None:
        by_name = self.pin is not None or self.hole is not None
        for key in ("pin", "hole") if by_name else ("E", "nu"):
            if getattr(self, key) is None:
                remedy = f"give {key}, or E and nu" if by_name else f"give {key}, or pin and hole"
                raise broken(key, None, "is required", remedy)
        for key in ("E", "nu", "yield_stress") if by_name else ():
            given = getattr(self, key)
            if given is not None:
                raise broken(key, given, "is that of the materials already", "remove it")


class IntegrationSpec(Spec):
    """How to integrate."""

    alpha: float = Field(ge=0, description="Baumgarte's α in 1/s")
    beta: float = Field(ge=0, description="Baumgarte's β in 1/s")
    max_step: float = Field(gt=0, description="the longest step in s")
    tolerance: float = Field(gt=0, lt=1, description="the tolerance, e.g. 1e-8")
    revolutions: int = Field(ge=1, description="revolutions of the drive, at least 1")


class ProvenanceSpec(Spec):
    """The provenance of the numbers by key; the longest matching key applies."""

    paper: tuple[str, ...] = Field(description="keys of the paper's numbers", strict=False)
    derived: tuple[str, ...] = Field(description="keys of derived numbers", strict=False)
    assumed: tuple[str, ...] = Field(description="keys of assumed numbers", strict=False)
    chosen: tuple[str, ...] = Field(
        (), description="keys of numbers set by a command", strict=False
    )


class MechanismSpec(Spec):
    """A mechanism's file."""

    name: str = Field(description="the mechanism's name")
    gravity: _Pair = Field(description="the acceleration of gravity in m/s², [x, y]", strict=False)
    ground: GroundSpec = Field(description="a table [ground.points]")
    bodies: dict[str, BodySpec] = Field(min_length=1, description="a table [bodies.NAME] for each")
    joints: dict[str, JointSpec] = Field(description="a table [joints.NAME] for each")
    clearance: ClearanceSpec = Field(description="a table [clearance]")
    integration: IntegrationSpec = Field(description="a table [integration]")
    provenance: ProvenanceSpec = Field(description="a table [provenance]")

    @model_validator(mode="after")
    def _check_names(self) -> MechanismSpec:
        if "ground" in self.bodies:
            raise broken("bodies.ground", None, "is no body's name", "it is what does not move")
        for name, joint in self.joints.items():
            for end in joint.between:
                self._check_end(f"joints.{name}.between", end, joint.type == "driver")
        drivers = [name for name, joint in self.joints.items() if joint.type == "driver"]
        if len(drivers) != 1:
            raise broken("joints", drivers, "there must be one driver", 'give type = "driver" once')
        self._check_clearance()
        check_provenance(self.model_dump(exclude_unset=True))
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

    def _check_clearance(self) -> None:
        joint = self.joints.get(self.clearance.joint)
        if joint is None or joint.type != "revolute":
            revolutes = [name for name, j in self.joints.items() if j.type == "revolute"]
            raise broken(
                "clearance.joint", self.clearance.joint, "is not a revolute joint",
                f"choose {', '.join(revolutes)}",
            )  # fmt: skip
        bodies = [end.partition(".")[0] for end in joint.between]
        if self.clearance.bearing not in bodies:
            raise broken(
                "clearance.bearing", self.clearance.bearing, "is not at that joint",
                f"choose {' or '.join(bodies)}",
            )  # fmt: skip
