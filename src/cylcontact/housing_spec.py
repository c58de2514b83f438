"""The housing of a joint as files and options have it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, Strict, model_validator

from cylcontact.errors import InputError
from cylcontact.laws import Conformal, Explicit, Housing, Parametric, Sector
from cylcontact.laws.law import ContactLaw
from cylcontact.materials import Material, find_material, known_materials, modulus_in_MPa
from cylcontact.reading import plain_number
from cylcontact.spec import Spec, broken

# The laws that know the housing.
_LAWS: dict[str, Any] = {law.name: law for law in (Parametric, Explicit, Conformal)}


# In GPa, above diamond's 1200: a larger bare number was probably meant in MPa.
_LARGEST_BARE = 1500.0


def _in_GPa(E: object) -> object:
    """Return a modulus with a unit as a number of GPa; pydantic judges what has none."""
    if isinstance(E, str) and E.rstrip().endswith("Pa"):
        try:
            return float(modulus_in_MPa(E, "", "")) * 1e-3
        except InputError as error:
            raise broken("", E, error.rule, error.remedy) from None
    if isinstance(E, int | float) and _LARGEST_BARE < E < 1e300:
        remedy = f'did you mean {E * 1e-3:g}? Or write "{E:g} GPa"'
        raise broken("", E, "a bare number is in GPa, and diamond has 1200", remedy)
    return E


Modulus = Annotated[float, BeforeValidator(_in_GPa)]


class MaterialSpec(Spec):
    """A material by its name in a table of materials, or by its numbers."""

    material: str | None = Field(None, description="a material of the package's table")
    E: Modulus | None = Field(
        None, gt=0, description='Young\'s modulus in GPa, or with its unit, "207 GPa"'
    )
    nu: float | None = Field(None, ge=0, le=0.5, description="Poisson's ratio")
    yield_stress: float | None = Field(None, gt=0, description="the yield stress in MPa")

    @model_validator(mode="after")
    def _check_material(self) -> MaterialSpec:
        for key in ("E", "nu"):
            given = getattr(self, key)
            if self.material is None and given is None:
                raise broken(key, None, "is required", f"give {key}, or material = NAME")
            if self.material is not None and given is not None:
                raise broken(key, given, "is that of the material already", f"remove {key}")
        return self

    def named(self, name: str, own: Path | None, source: str, key: str) -> Material:
        """Return the material, from the tables or with a name for its numbers."""
        if self.material is None:
            assert self.E is not None
            assert self.nu is not None
            return Material(name, f"{self.E!r} GPa", self.nu, self.yield_stress)
        rows, others = known_materials(own), ", or give E and nu"
        table = "the tables of materials"
        row = find_material(self.material, rows, source, key, table, others).material
        stress = self.yield_stress or row.yield_stress
        return Material(row.name, f"{float(row.E)!r} MPa", row.nu, stress, row.thermal_expansion)


class LayerSpec(MaterialSpec):
    """A ring that is bonded around the hole's own."""

    R_i: float = Field(gt=0, description="the inner radius of the layer in mm")


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

    layers: Annotated[tuple[LayerSpec, ...], Strict(False)] | None = Field(
        None, description="a list of rings around the hole's own, from within, each with its R_i"
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
                rule = "is for a sector" if self.clamp == "rim" else "is missing for a sector"
                raise broken(key, value, rule, 'give angle and side with clamp = "sector" only')
        return self

    def with_numbers(
        self, own: Path | None, source: str, key: str = "housing.layers"
    ) -> HousingSpec:
        """Return the same with E, ν and the yield stress of materials that are named."""
        layers = []
        for layer in self.layers or ():
            material = layer.named("", own, source, key)
            of_material = {"nu": material.nu, "yield_stress": material.yield_stress}
            E = 1e-3 * float(material.E)
            layers.append(layer.model_copy(update={"material": None, "E": E, **of_material}))
        return self.model_copy(update={"layers": tuple(layers) or None})

    @property
    def housing(self) -> Housing:
        """The housing itself, if its layers have numbers."""
        layers = [
            (layer.named(f"layer {k}", None, "housing", "layers"), layer.R_i)
            for k, layer in enumerate(self.layers or (), start=1)
        ]
        if self.angle is None or self.side is None:
            return Housing(self.R_o, layers=layers)
        return Housing(self.R_o, clamp=Sector(self.angle, self.side), layers=layers)


def clamp_of(text: str, source: str) -> dict[str, float | str]:
    """Return the keys of a table [housing] for a clamp in short, rim, near:60 or far:60."""
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


def layers_of(texts: Sequence[str], source: str) -> list[dict[str, float | str]]:
    """Return the list of layers in short, each a material and its inner radius in mm."""
    layers: list[dict[str, float | str]] = []
    for text in texts:
        name, _, radius = text.rpartition(":")
        try:
            layers.append({"material": name, "R_i": plain_number(radius)})
        except ValueError:
            rule, remedy = "is no material with an inner radius", "write e.g. bronze:12"
            raise InputError(source, "--layer", text, rule, remedy) from None
    return layers


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
