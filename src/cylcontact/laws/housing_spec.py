"""The housing of a joint as files and options have it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, Strict, model_validator

from cylcontact.bodies.material_spec import MaterialSpec, numbers_of
from cylcontact.files.spec import Spec, broken
from cylcontact.laws import Conformal, Housing, Sector
from cylcontact.support.arrays import require


class LayerSpec(MaterialSpec):
    """A ring that is bonded around the hole's own."""

    R_i: float = Field(gt=0, description="the inner radius of the layer in mm")


class HousingSpec(Spec):
    """A table [housing]: a ring around the hole that is clamped on its rim."""

    R_o: float = Field(gt=0, description="the radius of the rim in mm")
    clamp: Literal["rim", "sector", "lug"] = Field(
        "rim",
        description='"rim" if all of it is clamped, "sector" for a part, "lug" for a pulled lug',
    )
    angle: float | None = Field(
        None, ge=10, le=350, description="the angle of the clamped sector, 10 to 350 degrees"
    )
    side: Literal["pushed", "pulled"] | None = Field(
        None,
        description='"pushed" if the pin is pressed towards the sector, "pulled" if away from it',
    )
    shank: float | None = Field(
        None, ge=0.5, description="half the width of a lug's shank over R_o, by default 1"
    )
    layers: Annotated[tuple[LayerSpec, ...], Strict(False)] | None = Field(
        None, description="a list of rings around the hole's own, from within, each with its R_i"
    )
    seat: Literal["bonded", "sliding"] | None = Field(
        None, description='"bonded" for layers that are glued in, "sliding" for a pressed bush'
    )

    @model_validator(mode="after")
    def _check(self) -> HousingSpec:
        radii = [*(layer.R_i for layer in self.layers or ()), self.R_o]
        if radii != sorted(set(radii)):
            rule = "must have inner radii that increase from one to the next, up to R_o"
            raise broken("layers", radii, rule, "give the layers from within")
        given = {"angle": self.angle, "side": self.side}
        for key, value in given.items():
            if (value is None) == (self.clamp == "sector"):
                rule = "is missing for a sector" if value is None else "is for a sector"
                raise broken(key, value, rule, 'give angle and side with clamp = "sector" only')
        if self.shank is not None and self.clamp != "lug":
            raise broken(
                "shank", self.shank, "is for a lug", 'write clamp = "lug", or leave it out'
            )
        if self.seat is not None and not self.layers:
            raise broken("seat", self.seat, "is for layers", "give layers, or leave it out")
        return self

    def with_numbers(
        self, own: Path | None, source: str, key: str = "housing.layers"
    ) -> HousingSpec:
        """Return the same with the numbers of materials that are named."""
        layers = [
            layer.model_copy(
                update={"material": None} | numbers_of(layer.named("", own, source, key))
            )
            for layer in self.layers or ()
        ]
        return self.model_copy(update={"layers": tuple(layers) or None})

    def built(self, own: Path | None, source: str, key: str = "housing.layers") -> Housing:
        """Return the housing itself, with the materials of its layers."""
        layers = [
            (layer.named(f"layer {k}", own, source, key), layer.R_i)
            for k, layer in enumerate(self.layers or (), start=1)
        ]
        clamp: Literal["rim"] | Sector = "rim"
        if self.clamp == "lug":
            clamp = Sector.lug(1.0 if self.shank is None else self.shank)
        elif self.angle is not None and self.side is not None:
            clamp = Sector(self.angle, self.side)
        return Housing(self.R_o, clamp=clamp, layers=layers, seat=self.seat or "bonded")

    @property
    def housing(self) -> Housing:
        """The housing itself, if its layers have numbers."""
        return self.built(None, "housing")


def takes_housing(law: str) -> bool:
    """Return whether a law of this name takes a housing."""
    return law == Conformal.name


def in_housing(law: str, housing: Housing, source: str, key: str = "law") -> Conformal:
    """Return the law of a name in a housing."""
    require(takes_housing(law), source, key, law, "takes no housing", "choose conformal")
    return Conformal(housing)
