"""The commands `check` and `size`, and the joint of their options."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cylcontact.cli.bush import EXAMPLE, bush_check, diameter, read_bush
from cylcontact.cli.options import (
    Options,
    argument,
    number,
    option,
    reader,
    takes,
)
from cylcontact.cli.pair import (
    JOINT,
    blaming_options,
    material_of,
    option_of,
    pair_of,
    read_housing,
)
from cylcontact.cli.terminal import say
from cylcontact.files.reading import plain_number
from cylcontact.support.choices import listed
from cylcontact.support.errors import InputError, require

if TYPE_CHECKING:
    from cylcontact.bodies.iso286 import IsoFit
    from cylcontact.joint.bush import BushCheck
    from cylcontact.joint.check import JointCheck
    from cylcontact.joint.loaded import LoadedJoint

WHAT = ("clearance", "modulus", "length")


def _temperatures(text: str) -> tuple[float, float]:
    pin, _, hole = text.partition(",")
    return plain_number(pin), plain_number(hole or pin)


_AT: dict[str, Any] = {"rich_help_panel": "Load and surroundings"}
_TO: dict[str, Any] = {"rich_help_panel": "What to meet: one of"}
JSON = option("Print JSON, not the text.", "--json", default=False)
# What a joint has besides its pair and its housing.
AROUND: Options = {
    "load": (str | None, option("In N/mm, or '6 kN' with --length.", metavar="LOAD", **_AT)),
    "iso": (str | None, option("An ISO fit instead of radii, 20H7/g6.", metavar="CODE", **_AT)),
    "temperature": (
        str | None,
        option("Temperature in °C, or PIN,HOLE; radii are those at 20 °C.", metavar="T",
               parser=reader(_temperatures, "must be one number or two, PIN,HOLE"), **_AT),
    ),
    "rim": (str | None, option(
        "The housing's rim when warm: free, held, or the material of the frame.",
        metavar="STATE", **_AT)),
    "depth": (float | None, number("Depth at which a plane (--Rj inf) is held, mm.", **_AT)),
}  # fmt: skip
TARGETS: Options = {
    "stiffness": (float | None, number("In N/mm²; for a length N/mm.", **_TO)),
    "penetration": (float | None, number("In µm.", **_TO)),
    "peak": (float | None, number("Largest pressure, MPa.", **_TO)),
    "factor": (float | None, number("First yield over the load.", **_TO)),
}
_BUSH = option(
    "A pressed bush: MATERIAL, BORE before pressing, HOLE/BUSH; --hole is around it.",
    metavar="TEXT",
    parser=reader(read_bush, f"is no bush; {EXAMPLE}"),
    rich_help_panel="The housing of the hole",
)
# With a bush the pin may have a class of ISO 286.
_CHECKED: Options = dict(JOINT) | {
    "pin_diameter": (
        str | None,
        option("Diameter of the pin; with --bush also a class, 20f7.", "--pin-diameter",
               metavar="MM", parser=reader(diameter, "is no diameter; give mm, or 20f7"),
               rich_help_panel="The pair of cylinders"),
    ),
}  # fmt: skip
# Where errors of the joint come from.
_OPTIONS = {
    **{key: f"--{key}" for key in ("load", "iso", "depth", "temperature", "rim", "factor")},
    **{key: f"--{key}" for key in ("stiffness", "penetration", "peak")},
    **{"pin": "--temperature", "hole": "--temperature", "datum": "--depth", "housing": "--R-o"},
    **{"R_o": "--R-o", "layers": "--layer", "clamp": "--clamp"},
}


def joint_of(
    pair: dict[str, Any], around: dict[str, Any], source: str, sought: str = ""
) -> LoadedJoint:
    """Return the joint that the options of a command give; `sought` is what it is to find."""
    from cylcontact.joint.loaded import resolve

    code, rim = around.get("iso"), around.get("rim")
    iso = None if code is None else _read_iso(code, source, sought)
    housing = read_housing(pair, source)
    cylinders = pair_of(pair, source, iso, free=sought == "clearance")
    # Of a length that is sought the load is the total, as on a length of 1 mm.
    length = 1.0 if sought == "length" else cylinders.length
    if sought == "length":
        rule, remedy = "is what is sought (size length)", "leave it out"
        require(cylinders.length is None, source, "--length", cylinders.length, rule, remedy)
    load, state = load_of(around, length, source), rim_of(rim, pair, source)
    with blaming_options(_OPTIONS, source):
        return resolve(
            cylinders, load, housing=housing, iso=iso, depth=around.get("depth"),
            temperature=around.get("temperature"), rim=state,
        )  # fmt: skip


def load_of(around: Mapping[str, Any], length: float | None, source: str) -> float:
    """Return the load of the options in N/mm."""
    from cylcontact.files.units import load_in_N_per_mm

    text = around.get("load", "100")
    unit = "" if text.strip()[-1:].isalpha() or "/" in text else " N/mm"
    try:
        return load_in_N_per_mm(f"{text}{unit}", length)
    except InputError as error:
        remedy = error.remedy.replace("the length", "--length")
        raise InputError(source, "--load", text, error.rule, remedy) from None


def rim_of(rim: str | None, pair: Mapping[str, Any], source: str) -> Any:
    """Return the state of a rim: free, held, or the material of the frame."""
    return rim if rim in (None, "free", "held") else material_of(str(rim), pair, source, "--rim")


def _read_iso(code: str, source: str, sought: str) -> IsoFit:
    from cylcontact.bodies.iso286 import IsoFit

    rule, remedy = "gives the clearance, which is what is sought", "leave out --iso, give --Ri"
    require(sought != "clearance", source, "--iso", code, rule, remedy)
    return IsoFit.read(code, source, "--iso")


@takes("pair", _CHECKED)
@takes("around", AROUND)
def check(
    file: Path | None = argument(
        "The file of a joint with a bush, datasets/bush.toml.", metavar="[FILE]", default=None
    ),
    *,
    bush: Any = _BUSH,
    as_json: bool = JSON,
    pair: dict[str, Any],
    around: dict[str, Any],
) -> None:
    """Check a joint: penetration, stiffness, pressure and first yield.

    The joint is a pin in a hole, two rollers, or a roller on a plane.
    """
    answer = _checked(file, bush, pair, around)
    say(answer.to_json() if as_json else str(answer))
    for warning in answer.warnings:
        say(f"warning: {warning}", err=True)


def _checked(
    file: Path | None, bush: Any, pair: dict[str, Any], around: dict[str, Any]
) -> JointCheck | BushCheck:
    """Return the answer for the joint of a file or of the options."""
    if file is not None:
        from cylcontact.joint.specs import check_file

        materials = pair.pop("materials", None)
        options = [*map(option_of, (*pair, *around)), *["--bush"] * (bush is not None)]
        rule = f"is in the file already: {file}"
        for name in options:
            raise InputError("check", name, None, rule, "leave one of them out")
        return check_file(file, materials)
    if bush is not None:
        rim = rim_of(around.get("rim"), pair, "check")
        return bush_check(bush, pair, around, partial(load_of, around, source="check"), rim)
    from cylcontact.joint.check import checked

    size = pair.get("pin_diameter")
    rule, remedy = "is a class, which is for a joint with --bush", "give --iso 20H7/f7, or mm"
    require(not isinstance(size, str), "check", "--pin-diameter", size, rule, remedy)
    joint = joint_of(pair, around, "check")
    with blaming_options(_OPTIONS, "check"):
        return checked(joint)


@takes("pair", JOINT)
@takes("around", AROUND)
@takes("targets", TARGETS)
def size(
    what: str = argument(f"{listed(WHAT)}.", metavar="WHAT"),
    *,
    as_json: bool = JSON,
    pair: dict[str, Any],
    around: dict[str, Any],
    targets: dict[str, Any],
) -> None:
    """Find the clearance, the pin's modulus or the length that meets a target.

    For a length, --load is the total force in N.
    """
    from cylcontact.joint.size import size_of

    require(what in WHAT, "size", "WHAT", what, f"must be {listed(WHAT)}", "name one of these")
    names = [f"--{name}" for name in TARGETS]
    given = [f"--{name}" for name in targets]
    if len(given) != 1:
        rule = f"is given beside {given[0]}" if given else "is missing"
        key = given[1] if given else "--stiffness"
        raise InputError("size", key, None, rule, f"give one of {listed(names)}")
    if "penetration" in targets:
        targets["penetration"] *= 1e-3
    joint = joint_of(pair, around, "size", what)
    try:
        with blaming_options({"yield_stress": "--factor", **_OPTIONS}, "size"):
            answer = size_of(joint, what, **targets)  # type: ignore[arg-type]
    except InputError as error:
        value = error.value
        if error.key == "--penetration" and isinstance(value, float):
            value = f"{1e3 * value:g} µm"
        raise InputError(error.source, error.key, value, error.rule, error.remedy) from None
    say(json.dumps(answer.to_dict(), ensure_ascii=False, indent=1) if as_json else str(answer))
    for warning in answer.warnings:
        say(f"warning: {warning}", err=True)
