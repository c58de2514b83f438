"""Files of joints that need more than a line: a pin in a pressed bush, and a clevis."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, cast

from pydantic import BeforeValidator, Field, model_validator

from cylcontact.bodies.material import own_table
from cylcontact.bodies.material_spec import MaterialSpec
from cylcontact.files.spec import Spec, broken, parse_spec, read_toml
from cylcontact.files.units import load_in_N_per_mm
from cylcontact.joint.bush import Bush, BushCheck, check_bush
from cylcontact.joint.clevis import ClevisCheck, check_clevis
from cylcontact.joint.clevis_beam import Clevis, Plate
from cylcontact.laws.housing_spec import HousingSpec
from cylcontact.limits.rings import Rim
from cylcontact.support.errors import InputError, require

__all__ = ["BushJointSpec", "BushSpec", "ClevisSpec", "PlateSpec", "check_file"]


def _size(value: object) -> object:
    """Return a number or a class as it is, and a list as a pair of limits."""
    return tuple(value) if isinstance(value, list) else value


Size = Annotated[str | float | tuple[float, float], BeforeValidator(_size)]


class BushSpec(MaterialSpec):
    """A table [bush]: a bush before it is pressed in."""

    seat: Annotated[str | tuple[Size, Size], BeforeValidator(_size)] = Field(
        description='the fit of its seat, "26H7/s6", or the diameters [HOLE, OUTER] in mm'
    )
    bore: Size | None = Field(
        None, description='the diameter of its bore before pressing: mm, [LOW, HIGH] or "20E6"'
    )
    wall: Size | None = Field(
        None, description="the thickness of its wall in mm, or [LOW, HIGH], instead of the bore"
    )
    wrapped: bool = Field(False, description="whether it is rolled of strip, with a gap")

    def bush(self, own: Path | None, source: str) -> Bush:
        """Return the bush with its material."""
        material = self.named("", own, source, "bush")
        return Bush(material, self.seat, self.bore, self.wall, self.wrapped)


class PinSpec(MaterialSpec):
    """A table [pin]."""

    diameter: Size = Field(description='its diameter: mm, [LOW, HIGH] or a class, "20f7"')


class BushJointSpec(Spec):
    """A file of a joint with a bush."""

    load: str | float = Field(description='the load in N/mm, or "10 kN" with the length')
    length: float | None = Field(None, gt=0, description="the axial length in mm")
    plane: Literal["strain", "stress"] = Field(
        "strain", description='"strain" for long parts, "stress" for thin ones'
    )
    temperature: float | tuple[float, float] = Field(
        20.0, description="the temperature in °C, or [PIN, HOLE]"
    )
    rim: str | None = Field(None, description='"free", "held", or the material of a frame')
    pin: PinSpec = Field(description="the pin: its material and diameter")
    hole: MaterialSpec = Field(description="the material of the part around the bush")
    housing: HousingSpec = Field(description="the part around the bush: R_o and clamp")
    bush: BushSpec = Field(description="the bush: material, bore or wall, and seat")

    @model_validator(mode="after")
    def _check(self) -> BushJointSpec:
        if self.housing.layers:
            raise broken("housing.layers", None, "are beside a bush", "leave them out")
        return self


def is_plain_joint(path: Path | str) -> bool:
    """Return whether a file is of a joint with neither bush nor clevis; refuse what is no joint.

    Raises
    ------
    InputError
        If the file is neither; the error names what may be checked.
    """
    data = read_toml(path)
    if "bush" in data or {"eye", "cheek"} & {*data}:
        return False
    rule = "is no joint"
    remedy = "give a table of joints, the file of a joint ([bearing] and [pin], as "
    remedy += "datasets/joint.toml), of one with a [bush], or of a clevis, as datasets/clevis.toml"
    if not {"bearing", "pin"} <= {*data} or data.get("kind") == "spatial":
        raise InputError(str(path), "", None, rule, remedy)
    return True


class PlateSpec(MaterialSpec):
    """A table [eye] or [cheek] of a clevis."""

    thickness: float = Field(gt=0, description="in mm: of the eye, or of one cheek")
    hole: Size = Field(description='the diameter of its hole: mm, [LOW, HIGH] or "20H8"')
    housing: HousingSpec | None = Field(
        None, description="its shape: R_o, clamp, layers; by default clamped at four radii"
    )


class ClevisSpec(Spec):
    """A file of a clevis."""

    load: str | float = Field(description='the force on the eye in N, or "10 kN"')
    gap: float = Field(gt=0, description="the gap between eye and cheek in mm")
    beyond: float = Field(0.0, ge=0, description="how far the pin goes beyond a cheek in mm")
    pin: PinSpec = Field(description="the pin: its material and diameter")
    eye: PlateSpec = Field(description="the eye: material, thickness, hole, housing")
    cheek: PlateSpec = Field(description="one of two cheeks: material, thickness, hole, housing")


def _check_clevis(data: dict[str, Any], source: str, own: Path | None) -> ClevisCheck:
    """Return the answer for the file of a clevis."""
    spec = parse_spec(ClevisSpec, data, source)
    plates = {
        name: Plate(
            plate.thickness,
            plate.named("", own, source, name),
            plate.hole,
            None if plate.housing is None else plate.housing.built(own, source, f"{name}.housing"),
        )
        for name, plate in (("eye", spec.eye), ("cheek", spec.cheek))
    }
    # The force as on a length of 1 mm.
    load = load_in_N_per_mm(spec.load, 1.0) if isinstance(spec.load, str) else spec.load
    pin = spec.pin.named("", own, source, "pin")
    clevis = Clevis(pin, spec.pin.diameter, **plates, gap=spec.gap, beyond=spec.beyond)
    return check_clevis(clevis, load)


def check_file(path: Path | str, materials: str | None = None) -> BushCheck | ClevisCheck:
    """Return the answer for the file of a joint with a bush, or of a clevis.

    Parameters
    ----------
    path : str or Path
    materials : str, optional
        A table of materials; by default datasets/materials.csv beside the file or above, if any.

    Returns
    -------
    BushCheck or ClevisCheck

    Raises
    ------
    InputError
        If the file cannot be read, or the joint cannot be answered.
    """
    source, data = str(path), read_toml(path)
    own = own_table(materials, Path(path).parent, source)
    if "eye" in data or "cheek" in data:
        return _check_clevis(data, source, own)
    rule = "is neither a joint with a bush, which has a table [bush], nor a clevis, with [eye]"
    require("bush" in data, source, "", None, rule, "copy datasets/bush.toml or clevis.toml")
    if isinstance(data.get("temperature"), list):
        data["temperature"] = tuple(data["temperature"])
    spec = parse_spec(BushJointSpec, data, source)
    load = spec.load
    if isinstance(load, str):
        load = load_in_N_per_mm(load, spec.length)
    housing = spec.housing.built(own, source)
    return check_bush(
        spec.bush.bush(own, source),
        spec.pin.named("", own, source, "pin"),
        spec.pin.diameter,
        spec.hole.named("", own, source, "hole"),
        housing,
        load,
        length=spec.length,
        plane=spec.plane,
        temperature=spec.temperature,
        rim=_rim_of(spec.rim, own, source),
    )


def _rim_of(name: str | None, own: Path | None, source: str) -> Rim | None:
    """Return the state of a rim: free, held, or the material of a frame."""
    if name is None:
        return None
    if name in ("free", "held"):
        return cast(Rim, name)
    return MaterialSpec(material=name).named("", own, source, "rim")
