"""The housing of a joint as files and options have it."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, model_validator

from cylcontact.errors import InputError
from cylcontact.laws import Conformal, Explicit, Housing, Parametric, Sector
from cylcontact.laws.law import ContactLaw
from cylcontact.spec import Spec, broken

# The laws that know the housing.
_LAWS: dict[str, Any] = {law.name: law for law in (Parametric, Explicit, Conformal)}


class HousingSpec(Spec):
    """A table [housing]: a ring around the hole that is clamped on its rim."""

    R_o: float = Field(gt=0, description="the radius of the rim in mm")
    clamp: Literal["rim", "sector"] = Field(
        "rim", description='"rim" if all of it is clamped, "sector" for a part'
    )
    angle: float | None = Field(
        None, ge=10, le=350, description="the angle of the clamped sector, 10 to 350 degrees"
    )
    side: Literal["near", "far"] | None = Field(
        None, description='"near" if the pin is pressed towards the sector, "far" if away from it'
    )

    @model_validator(mode="after")
    def _check(self) -> HousingSpec:
        given = {"angle": self.angle, "side": self.side}
        for key, value in given.items():
            if (value is None) == (self.clamp == "sector"):
                rule = "is for a sector" if self.clamp == "rim" else "is missing for a sector"
                raise broken(key, value, rule, 'give angle and side with clamp = "sector" only')
        return self

    @property
    def housing(self) -> Housing:
        """The housing itself."""
        if self.angle is None or self.side is None:
            return Housing(self.R_o)
        return Housing(self.R_o, clamp=Sector(self.angle, self.side))


def clamp_of(text: str, source: str) -> dict[str, float | str]:
    """Return the keys of a table [housing] for a clamp in short, rim, near:60 or far:60.

    >>> clamp_of("far:60", "example")
    {'clamp': 'sector', 'angle': 60.0, 'side': 'far'}
    """
    side, _, angle = text.partition(":")
    if text == "rim":
        return {"clamp": "rim"}
    try:
        if side in ("near", "far"):
            return {"clamp": "sector", "angle": float(angle), "side": side}
    except ValueError:
        pass
    raise InputError(
        source, "--clamp", text, "is no clamp", "write rim, near:60 or far:60, with your angle"
    )


def takes_housing(law: str) -> bool:
    """Return whether a law of this name knows the housing."""
    return law in _LAWS


def in_housing(law: str, housing: Housing, source: str, key: str = "law") -> ContactLaw:
    """Return the law of a name in a housing."""
    if law not in _LAWS:
        rule, remedy = "knows no housing", f"choose {', '.join(_LAWS)}"
        raise InputError(source, key, law, rule, remedy)
    housed: ContactLaw = _LAWS[law](datum=housing)
    return housed
