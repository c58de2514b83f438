"""The commands `check` and `size`, and the joint of their options."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from cylcontact.cli.options import (
    Options,
    argument,
    number,
    option,
    reader,
    takes,
)
from cylcontact.cli.pair import JOINT, blaming_options, material_of, pair_of, read_housing
from cylcontact.cli.terminal import say
from cylcontact.files.reading import plain_number
from cylcontact.support.choices import listed
from cylcontact.support.errors import InputError, require

if TYPE_CHECKING:
    from cylcontact.bodies.iso286 import IsoFit
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
    from cylcontact.files.units import load_in_N_per_mm
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
    text = around.get("load", "100")
    unit = "" if text.strip()[-1:].isalpha() or "/" in text else " N/mm"
    try:
        load = load_in_N_per_mm(f"{text}{unit}", length)
    except InputError as error:
        remedy = error.remedy.replace("the length", "--length")
        raise InputError(source, "--load", text, error.rule, remedy) from None
    state: Any = rim
    if rim not in (None, "free", "held"):
        state = material_of(str(rim), pair, source, "--rim")
    with blaming_options(_OPTIONS, source):
        return resolve(
            cylinders, load, housing=housing, iso=iso, depth=around.get("depth"),
            temperature=around.get("temperature"), rim=state,
        )  # fmt: skip


def _read_iso(code: str, source: str, sought: str) -> IsoFit:
    from cylcontact.bodies.iso286 import IsoFit

    rule, remedy = "gives the clearance, which is what is sought", "leave out --iso, give --Ri"
    require(sought != "clearance", source, "--iso", code, rule, remedy)
    return IsoFit.read(code, source, "--iso")


@takes("pair", JOINT)
@takes("around", AROUND)
def check(
    *,
    as_json: bool = JSON,
    pair: dict[str, Any],
    around: dict[str, Any],
) -> None:
    """Check a joint: penetration, stiffness, pressure and first yield.

    The joint is a pin in a hole, two rollers, or a roller on a plane.
    """
    from cylcontact.joint.check import checked

    joint = joint_of(pair, around, "check")
    with blaming_options(_OPTIONS, "check"):
        answer = checked(joint)
    say(answer.to_json() if as_json else str(answer))
    for warning in answer.warnings:
        say(f"warning: {warning}", err=True)


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
