"""Specs of single clearance joints: the model of their TOML files."""

from __future__ import annotations

import re
from typing import Annotated, Literal

from pydantic import Field, Strict, model_validator

from cylcontact.housing_spec import HousingSpec
from cylcontact.impact import FACTORS
from cylcontact.modulus import Modulus
from cylcontact.spec import Spec, broken

__all__ = ["BodySpec", "ClearanceJointSpec", "DissipationSpec", "FrictionSpec"]

# Of the Fortran names, which end in "_evaluate", the standard allows 63 characters.
_LONGEST_NAME = 40

# TOML has lists, not tuples.
_Point = Annotated[tuple[float, float], Strict(False)]


class BodySpec(Spec):
    """The hole of the bearing, or the pin."""

    R: float = Field(gt=0, description="the radius in mm")
    material: str | None = Field(None, description="a material of the package's table")
    E: Modulus | None = Field(
        None, gt=0, description='Young\'s modulus in GPa, or with its unit, "207 GPa"'
    )
    nu: float | None = Field(None, ge=0, le=0.5, description="Poisson's ratio")
    yield_stress: float | None = Field(None, gt=0, description="the yield stress in MPa")
    point: _Point = Field(
        (0.0, 0.0), description="the centre of hole or pin in mm, in the axes of the body, [x, y]"
    )

    @model_validator(mode="after")
    def _check(self) -> BodySpec:
        for key in ("E", "nu"):
            given = getattr(self, key)
            if self.material is None and given is None:
                raise broken(key, None, "is required", f"give {key}, or material = NAME")
            if self.material is not None and given is not None:
                raise broken(key, given, "is that of the material already", f"remove {key}")
        return self


class DissipationSpec(Spec):
    """The dissipation in normal direction."""

    factor: str = Field(description=f"a hysteresis factor: {', '.join(FACTORS)}")
    restitution: float = Field(gt=0, le=1, description="the restitution, above 0 up to 1")

    @model_validator(mode="after")
    def _check(self) -> DissipationSpec:
        if self.factor not in FACTORS:
            raise broken("factor", self.factor, "is not known", f"choose {', '.join(FACTORS)}")
        return self


class FrictionSpec(Spec):
    """The friction."""

    coefficient: float = Field(ge=0, description="the friction coefficient")
    v0: float = Field(ge=0, description="the speed in mm/s up to which there is no friction")
    v1: float = Field(gt=0, description="the speed in mm/s from which there is all of it")

    @model_validator(mode="after")
    def _check(self) -> FrictionSpec:
        if self.v1 <= self.v0:
            raise broken("v1", self.v1, f"must be above v0 = {self.v0}", "raise it")
        return self


class ClearanceJointSpec(Spec):
    """A joint's file."""

    name: str = Field(description="the joint's name")
    units: Literal["SI", "mm"] = Field(description='"SI" (m, N, s, rad) or "mm" (mm, N, s, rad)')
    length: float = Field(gt=0, description="the axial length in mm")
    housing: HousingSpec | None = Field(
        None, description="a table [housing] of the rim's radius R_o, for laws that know it"
    )
    law: str = Field(description="a contact law, e.g. explicit, or the path of a fit result")
    bearing: BodySpec = Field(description="a table [bearing]")
    pin: BodySpec = Field(description="a table [pin]")
    dissipation: DissipationSpec = Field(description="a table [dissipation]")
    friction: FrictionSpec = Field(description="a table [friction]")

    @model_validator(mode="after")
    def _check(self) -> ClearanceJointSpec:
        if not re.match("[A-Za-z]", self.name) or len(self.name) > _LONGEST_NAME:
            raise broken(
                "name", self.name, "cannot name a function",
                f"begin with one of A to Z, and take up to {_LONGEST_NAME} characters",
            )  # fmt: skip
        if self.pin.R >= self.bearing.R:
            raise broken(
                "pin.R", self.pin.R, "does not fit in the hole", f"keep it below {self.bearing.R}"
            )
        return self
