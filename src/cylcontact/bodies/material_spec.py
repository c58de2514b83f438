"""A material as files have it: by its name, or by its numbers."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import Annotated

from pydantic import BeforeValidator, Field, model_validator

from cylcontact.bodies.material import (
    Material,
    changed,
    find_material,
    known_materials,
    modulus_in_MPa,
)
from cylcontact.files.spec import Spec, broken
from cylcontact.support.errors import InputError

# In GPa, above diamond's 1200: a larger bare number was probably meant in MPa, or in Pa if it is
# too large for that too.
_LARGEST_BARE = 1500.0


def _in_GPa(E: object) -> object:
    """Return a modulus with a unit as a number of GPa; pydantic judges what has none."""
    if isinstance(E, str) and E.rstrip().endswith("Pa"):
        try:
            return float(modulus_in_MPa(E, "", "")) * 1e-3
        except InputError as error:
            raise broken("", E, error.rule, error.remedy) from None
    if isinstance(E, int | float) and _LARGEST_BARE < E < 1e300:
        meant = E * (1e-3 if E <= 1e3 * _LARGEST_BARE else 1e-9)
        remedy = f'did you mean {meant:g}? Or write "{E:g} GPa"'
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
    thermal_expansion: float | None = Field(
        None, gt=0, lt=1e-3, description="the coefficient of linear expansion in 1/K"
    )

    @model_validator(mode="after")
    def _check_material(self) -> MaterialSpec:
        for key in ("E", "nu"):
            given = getattr(self, key)
            if self.material is None and given is None:
                raise broken(key, None, "is required", f"give {key}, or material = NAME")
            if self.material is not None and given is not None:
                raise broken(key, given, "is already given by the material", f"remove {key}")
        return self

    def named(self, name: str, own: Path | None, source: str, key: str) -> Material:
        """Return the material, from the tables or with a name for its numbers."""
        of_file = {
            key: value
            for key in ("yield_stress", "thermal_expansion")
            if (value := getattr(self, key)) is not None
        }
        if self.material is None:
            assert self.E is not None
            assert self.nu is not None
            return Material(name, f"{self.E!r} GPa", self.nu, **of_file)
        rows, others = known_materials(own), ", or give E and nu"
        table = "the tables of materials"
        row = find_material(self.material, rows, source, key, table, others)
        return changed(row.material, **of_file)


def numbers_of(material: Material) -> dict[str, float | None]:
    """Return the numbers of a material as the keys of a `MaterialSpec`."""
    given = {field.name: getattr(material, field.name) for field in fields(material)}
    del given["name"]
    return given | {"E": 1e-3 * float(material.E)}
