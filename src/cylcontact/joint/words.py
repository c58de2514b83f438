"""A joint as users write it: in the options of a command, or in a row of a table.

Both give values by the same names. What is found wrong is told by the name that `named` gives.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cylcontact.files.reading import plain_number
from cylcontact.files.units import length_in_mm, load_in_N_per_mm
from cylcontact.support.choices import CONTACTS
from cylcontact.support.errors import InputError, require

if TYPE_CHECKING:
    from cylcontact.bodies.iso286 import IsoFit
    from cylcontact.bodies.material import Material
    from cylcontact.bodies.pair import CylinderPair
    from cylcontact.joint.loaded import LoadedJoint
    from cylcontact.laws import Housing
    from cylcontact.laws.housing_spec import HousingSpec

Named = Callable[[str], str]

SIZES = ("radial_clearance", "R_i", "R_j", "hole_diameter", "pin_diameter")
HOUSING = ("R_o", "clamp", "layer")
# Columns for the reader of a table, which are carried along.
LABELS = ("name", "id", "part", "joint", "note")
DEFAULT_LOAD = "100 N/mm"
# What stands for a radius under another name.
_DIAMETERS = {"hole_diameter": "R_i", "pin_diameter": "R_j"}
# The names of errors from deeper down.
_DEEPER = {
    "dR": "radial_clearance", "datum": "depth", "housing": "R_o", "layers": "layer",
    "angle": "clamp", "shank": "clamp", "side": "clamp", "R_o": "R_o",
    **{key: key for key in ("load", "iso", "depth", "temperature", "rim", "length", "R_i", "R_j")},
}  # fmt: skip


# --- single words -------------------------------------------------------------------------------


def material_words(text: str) -> str | tuple[float, ...]:
    """Return the name of a material, or its E in MPa, ν and perhaps yield stress and expansion.

    >>> material_words("bronze"), material_words("207 GPa, 0.3, 350 MPa, 12e-6/K")
    ('bronze', (207000.0, 0.3, 350.0, 1.2e-05))
    """
    from cylcontact.bodies.material import modulus_in_MPa

    modulus, *rest = (part.strip() for part in text.split(","))
    if not rest:
        return text.strip()
    if len(rest) > 3:
        raise ValueError
    units = ("", "MPa", "/K")
    numbers = [
        plain_number(part.removesuffix(unit)) for part, unit in zip(rest, units, strict=False)
    ]
    return float(modulus_in_MPa(modulus, "", "")), *numbers


def radius_words(text: str) -> float:
    """Return a length in mm; inf is a plane."""
    return math.inf if text.strip() == "inf" else length_in_mm(text)


def clamp_words(text: str) -> dict[str, Any]:
    """Return the keys of a table [housing] for a clamp in short.

    >>> clamp_words("rim"), clamp_words("pulled:60")
    ({'clamp': 'rim'}, {'clamp': 'sector', 'angle': 60.0, 'side': 'pulled'})
    """
    if text == "rim":
        return {"clamp": "rim"}
    side, colon, angle = text.partition(":")
    if side == "lug":
        return {"clamp": "lug"} | ({"shank": plain_number(angle)} if colon else {})
    if side not in ("pushed", "pulled"):
        raise ValueError
    return {"clamp": "sector", "angle": plain_number(angle), "side": side}


def layer_words(text: str) -> dict[str, Any]:
    """Return the keys of a layer in a table [housing]: a material, and its inner radius.

    >>> layer_words("bronze:12"), layer_words("110 GPa, 0.3:15")
    ({'material': 'bronze', 'R_i': 12.0}, {'E': '110000.0 MPa', 'nu': 0.3, 'R_i': 15.0})
    """
    name, _, radius = text.rpartition(":")
    material = material_words(name)
    keys: dict[str, Any] = {"material": material}
    if isinstance(material, tuple):
        names = ("E", "nu", "yield_stress", "thermal_expansion")
        keys = dict(zip(names, material, strict=False))
        keys["E"] = f"{keys['E']!r} MPa"
    return keys | {"R_i": length_in_mm(radius)}


def temperature_words(text: str) -> tuple[float, float]:
    """Return the temperatures of pin and hole in °C, one for both or PIN,HOLE."""
    pin, _, hole = text.partition(",")
    return plain_number(pin), plain_number(hole or pin)


# --- the joint ----------------------------------------------------------------------------------


def joint_from_words(
    given: Mapping[str, Any],
    source: str,
    named: Named = str,
    own: Path | None = None,
    sought: str = "",
) -> LoadedJoint:
    """Return the joint that values by their names give.

    Parameters
    ----------
    given : mapping
        Values by the names of options with _ for -: lengths in mm, temperatures as a pair.
    source : str
        The command or the row, for errors.
    named : callable
        Gives the name under which a user wrote a value.
    own : path, optional
        The user's table of materials.
    sought : str
        What is to be found, "clearance" or "length"; it must not be given then.
    """
    from cylcontact.joint.loaded import resolve

    iso = None
    if (code := given.get("iso")) is not None:
        rule = "gives the clearance, which is what is sought"
        remedy = f"leave it out, and give {named('R_i')}"
        require(sought != "clearance", source, named("iso"), code, rule, remedy)
        iso = _fit(str(code), source, named)
    housing = housing_from_words(given, source, named, own)
    pair = pair_from_words(given, source, named, own, iso, free=sought == "clearance")
    # Of a length that is sought the load is the total, as on a length of 1 mm.
    length = 1.0 if sought == "length" else pair.length
    if sought == "length":
        rule, remedy = "is what is sought (size length)", "leave it out"
        require(pair.length is None, source, named("length"), pair.length, rule, remedy)
    load = load_from_words(given.get("load", DEFAULT_LOAD), length, source, named)
    rim = rim_from_words(given.get("rim"), source, named, own)
    with blaming(named, source, {"pin": "temperature", "hole": "temperature"}):
        return resolve(
            pair, load, housing=housing, iso=iso, depth=given.get("depth"),
            temperature=given.get("temperature"), rim=rim,
        )  # fmt: skip


def rim_from_words(rim: str | None, source: str, named: Named, own: Path | None) -> Any:
    """Return the state of a rim: free, held, or the material of the frame."""
    if rim in (None, "free", "held"):
        return rim
    return material_from_words(rim, source, named("rim"), own)


def _fit(code: str, source: str, named: Named) -> IsoFit:
    from cylcontact.bodies.iso286 import IsoFit

    return IsoFit.read(code, source, named("iso"))


def load_from_words(load: Any, length: float | None, source: str, named: Named) -> float:
    """Return a load in N/mm from a number of N/mm, or from a text with or without a unit."""
    text = str(load).strip()
    unit = "" if text[-1:].isalpha() or "/" in text else " N/mm"
    try:
        return load_in_N_per_mm(f"{text}{unit}", length)
    except InputError as error:
        remedy = error.remedy.replace("the length", named("length"))
        raise InputError(source, named("load"), text, error.rule, remedy) from None


@contextmanager
def blaming(named: Named, source: str, more: Mapping[str, str] | None = None) -> Iterator[None]:
    """Tell an error of the block by the name that a user wrote."""
    names = _DEEPER | dict(more or {})
    try:
        yield
    except InputError as error:
        keys = error.key.split(", ")
        if not {*keys} <= {*names}:
            raise
        key = ", ".join(named(names[each]) for each in keys)
        raise InputError(source, key, error.value, error.rule, error.remedy) from None


def housing_spec_from_words(
    given: Mapping[str, Any], source: str, named: Named
) -> HousingSpec | None:
    """Return the housing that values give as a table [housing], None without any."""
    data = {key: given[key] for key in HOUSING if key in given}
    if not data:
        return None
    from cylcontact.files.spec import parse_spec
    from cylcontact.laws.housing_spec import HousingSpec

    contact = given.get("contact", "internal")
    remedy = f"leave out {' and '.join(map(named, data))}, or {named('contact')}"
    require_pin(source, named, contact, remedy)
    clamp = data.pop("clamp", {})
    data |= clamp_words(clamp) if isinstance(clamp, str) else clamp
    if "layer" in data:
        layers = data.pop("layer")
        layers = [layers] if isinstance(layers, str) else layers
        data["layers"] = [layer_words(x) if isinstance(x, str) else x for x in layers]
    with blaming(named, source):
        return parse_spec(HousingSpec, data, source)


def housing_from_words(
    given: Mapping[str, Any], source: str, named: Named, own: Path | None
) -> Housing | None:
    """Return the housing that values give, None without any."""
    spec = housing_spec_from_words(given, source, named)
    if spec is None:
        return None
    with blaming(named, source):
        return spec.built(own, source, named("layer"))


def require_pin(source: str, named: Named, contact: str, remedy: str) -> None:
    """Refuse for rollers what is for a pin and a hole."""
    rule = "has no pin and no hole"
    require(contact == "internal", source, named("contact"), contact, rule, remedy)


def pair_from_words(
    given: Mapping[str, Any],
    source: str,
    named: Named,
    own: Path | None,
    iso: IsoFit | None = None,
    free: bool = False,
) -> CylinderPair:
    """Return the pair that values give: with the radii of a fit, or with its clearance `free`."""
    from cylcontact.bodies.pair import CylinderPair

    contact, plane = given.get("contact", "internal"), given.get("plane", "strain")
    rule, remedy = "must be 'internal' or 'external'", "a pin in a hole, or two rollers"
    require(contact in CONTACTS, source, named("contact"), contact, rule, remedy)
    rule, remedy = "must be strain or stress", "strain for long cylinders, stress for thin ones"
    require(plane in ("strain", "stress"), source, named("plane"), plane, rule, remedy)
    if iso is not None:
        for name in filter(given.__contains__, SIZES):
            rule = f"is given by {named('iso')} {iso.code}"
            raise InputError(source, named(name), given[name], rule, "leave one of them out")
        rule = f"has no fit ({named('iso')} {iso.code})"
        remedy = f"leave out {named('contact')}, or {named('iso')}"
        require(contact == "internal", source, named("contact"), contact, rule, remedy)
    first, second = bodies_from_words(given, source, named, own, contact)
    length = given.get("length")
    if iso is not None:
        return CylinderPair.internal(*iso.middle, first, length, second, plane=plane)
    sizes = _sizes(given, source, named, contact, free)
    R_i, R_j, dR = (sizes.get(key) for key in ("R_i", "R_j", "dR"))
    # A radius is half of what a user gave as a diameter.
    diameters = {"R_i", "R_j"} if {*_DIAMETERS} & {*given} else set()
    names = {of: key for key, of in _DIAMETERS.items() if key in given}
    try:
        with blaming(named, source, names):
            if R_i is not None and R_j is not None:
                build = CylinderPair.internal if contact == "internal" else CylinderPair.external
                return build(R_i, R_j, first, length, second, plane=plane)
            assert dR is not None
            if R_i is None:
                assert R_j is not None
                R_i = dR + R_j if contact == "internal" else dR - R_j
            return CylinderPair.from_dR(
                contact,
                dR,
                first,
                length,
                R_i,
                second,
                plane=plane,
            )
    except InputError as error:
        if diameters and "diameter" in error.key:
            raise InputError(source, error.key, None, error.rule, error.remedy) from None
        raise


def _sizes(
    given: Mapping[str, Any], source: str, named: Named, contact: str, free: bool
) -> dict[str, float]:
    """Return two of R_i, R_j and dR in mm."""
    sizes: dict[str, float] = {}
    origin: dict[str, str] = {}
    for name in SIZES:
        if (value := given.get(name)) is None:
            continue
        key = {"radial_clearance": "dR", **_DIAMETERS}.get(name, name)
        if name in _DIAMETERS:
            require_pin(source, named, contact, f"leave out {named(name)}; rollers have radii")
            require(value > 0, source, named(name), value, "must be positive", "give it in mm")
            value /= 2
        rule, remedy = f"says the same as {named(origin.get(key, ''))}", "keep one of them"
        require(key not in sizes, source, named(name), None, rule, remedy)
        sizes[key], origin[key] = float(value), name
    if free:
        for key in {"dR", "R_j"} & {*sizes}:
            rule, remedy = "is what is sought (size clearance)", "leave it out"
            raise InputError(source, named(origin[key]), given[origin[key]], rule, remedy)
        rule, remedy = "is missing", "give the radius of the hole, or of the first roller"
        require("R_i" in sizes, source, named("R_i"), None, rule, remedy)
        return sizes | {"dR": sizes["R_i"] / 2 if contact == "internal" else 2 * sizes["R_i"]}
    if len(sizes) < 2:
        missing = "R_j" if "R_i" in sizes else "R_i"
        i, j, clearance = named("R_i"), named("R_j"), named("radial_clearance")
        rule = f"is missing: two of {i}, {j} and {clearance} are needed"
        remedy = f"give diameters ({named('hole_diameter')}, {named('pin_diameter')}), "
        remedy += f"or a fit: {named('iso')} 20H7/g6"
        if contact == "external":
            rule, remedy = "is missing", f"give the radii of both rollers; {j} inf is a plane"
        raise InputError(source, named(missing), None, rule, remedy)
    if len(sizes) == 3:
        rule, remedy = "follows from the radii", "leave it out"
        raise InputError(source, named(origin["dR"]), sizes["dR"], rule, remedy)
    if contact == "internal":
        _require_clearance(sizes, origin, source, named)
    return sizes


def _require_clearance(
    sizes: Mapping[str, float], origin: Mapping[str, str], source: str, named: Named
) -> None:
    """Refuse sizes of a pin in a hole that leave no clearance, with what to do."""
    for key in {"R_i", "R_j"} & {*sizes}:
        if sizes[key] < 0:
            remedy = "a concave surface is the hole of internal contact: "
            remedy += f"{named('R_i')} {-sizes[key]:g}, with the smaller radius as {named('R_j')}"
            rule = "must be positive"
            raise InputError(source, named(origin[key]), sizes[key], rule, remedy)
    if {*_DIAMETERS} <= {*origin.values()} and sizes["R_j"] > sizes["R_i"]:
        rule = f"must be smaller than the hole ({named('hole_diameter')} {2 * sizes['R_i']:g})"
        remedy = "give the larger diameter to the hole"
        raise InputError(source, named("pin_diameter"), 2 * sizes["R_j"], rule, remedy)
    if sizes.get("dR") == 0 or sizes.get("R_i") == sizes.get("R_j", math.nan):
        key = "dR" if "dR" in sizes else "R_j"
        rule = "leaves no clearance, and the laws need one"
        remedy = "give the least clearance that the joint may have, e.g. "
        remedy += f"{named('radial_clearance')} 1e-4"
        remedy += f" in place of {named(origin[key])}" if key == "R_j" else ""
        value = sizes["dR"] if key == "dR" else None
        raise InputError(source, named(origin[key]), value, rule, remedy)


# --- materials ----------------------------------------------------------------------------------


def bodies_from_words(
    given: Mapping[str, Any], source: str, named: Named, own: Path | None, contact: str
) -> tuple[Material, Material]:
    """Return the materials of bodies i and j: of the hole and the pin, or of the rollers."""
    both = given.get("material")
    both = both if isinstance(both, list) or both is None else [both]
    each = {role: given[role] for role in ("pin", "hole") if given.get(role) is not None}
    for role in each:
        remedy = f"leave out {named(role)}; rollers have {named('material')}"
        require_pin(source, named, contact, remedy)
    if both and each:
        role = next(iter(each))
        rule = f"is of both bodies, and {named(role)} is of one"
        remedy = "give one value for each body"
        raise InputError(source, named("material"), None, rule, remedy)
    if both:
        rule, remedy = "is given more than once", "two rollers have two materials at most"
        if contact == "internal":
            remedy = f"for a pin in a hole give {named('pin')} and {named('hole')}"
        most = 1 if contact == "internal" else 2
        require(len(both) <= most, source, named("material"), None, rule, remedy)
        bodies = [material_from_words(value, source, named("material"), own) for value in both]
        return bodies[0], bodies[-1]
    wanted = ("hole", "pin") if contact == "internal" else ("material", "material")
    for role in wanted:
        remedy = f"give e.g. {named('material')} 'low-carbon steel', or {named('pin')} and "
        require(role in each, source, named(role), None, "is missing", remedy + named("hole"))
    hole, pin = (material_from_words(each[role], source, named(role), own) for role in wanted)
    return hole, pin


def material_from_words(value: Any, source: str, name: str, own: Path | None) -> Material:
    """Return a material by its name, or by its numbers."""
    from cylcontact.bodies.material import Material, find_material, known_materials

    if isinstance(value, str):
        try:
            value = material_words(value)
        except ValueError as error:
            rule = error.rule if isinstance(error, InputError) else "is not a material"
            remedy = "write its name, or '207 GPa, 0.3, 350 MPa, 12e-6/K'"
            raise InputError(source, name, value, rule, remedy) from None
    if isinstance(value, str):
        table = "the tables of materials"
        return find_material(value, known_materials(own), source, name, table).material
    E, nu, *more = value
    yields, expansion = (*more, None, None)[:2]
    try:
        return Material("", f"{E!r} MPa", nu, yields, expansion)
    except InputError as error:
        raise InputError(source, name, error.value, error.rule, error.remedy) from None
