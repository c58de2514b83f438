"""The commands `check` and `size`, and the joint of their options."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from cylcontact.cli.options import (
    JSON,
    QUIET,
    Options,
    argument,
    number,
    option,
    output,
    reader,
    require_output,
    takes,
)
from cylcontact.cli.pair import JOINT, option_of, own_materials
from cylcontact.cli.terminal import note, progress_bars, say
from cylcontact.files.reading import require_file
from cylcontact.files.units import length_in_mm, split_number
from cylcontact.files.writing import json_text
from cylcontact.joint.bush_words import EXAMPLE, bush_words, diameter_words
from cylcontact.joint.words import blaming, joint_from_words, temperature_words
from cylcontact.support.choices import is_table, listed
from cylcontact.support.errors import InputError, require

if TYPE_CHECKING:
    from cylcontact.joint.bush import BushCheck
    from cylcontact.joint.check import JointCheck
    from cylcontact.joint.clevis import ClevisCheck
    from cylcontact.joint.loaded import LoadedJoint

PAGES = (".html", ".pdf", ".png")
WHAT = ("clearance", "modulus", "length")


def _depth(text: str) -> float:
    """Return a penetration in mm; without a unit it is in µm."""
    return length_in_mm(text if split_number(text)[1] else f"{text} µm")


_AT: dict[str, Any] = {"rich_help_panel": "Load and surroundings"}
_TO: dict[str, Any] = {"rich_help_panel": "What to meet: one of"}
# What a joint has besides its pair and its housing.
AROUND: Options = {
    "load": (str | None, option("In N/mm, or '6 kN' with --length.", metavar="LOAD", **_AT)),
    "iso": (str | None, option("An ISO fit instead of radii, 20H7/g6.", metavar="CODE", **_AT)),
    "temperature": (
        str | None,
        option("Temperature in °C, or PIN,HOLE; radii are those at 20 °C.", metavar="°C",
               parser=reader(temperature_words, "must be one number or two, PIN,HOLE"), **_AT),
    ),
    "rim": (str | None, option(
        "The housing's rim when warm: free, held, or the material of the frame.",
        metavar="STATE", **_AT)),
    "depth": (float | None, number("Depth at which a plane (--Rj inf) is held.", metavar="MM",
              **_AT)),
}  # fmt: skip
TARGETS: Options = {
    "stiffness": (float | None, number("In N/mm²; for a length N/mm.", metavar="STIFFNESS", **_TO)),
    "penetration": (
        float | None,
        option(
            "In µm, or with its unit.",
            metavar="MICRONS",
            parser=reader(_depth, "is not a length; give µm, or e.g. '0.02 mm'"),
            **_TO,
        ),
    ),
    "peak": (float | None, number("Largest pressure, MPa.", metavar="MPA", **_TO)),
    "factor": (float | None, number("First yield over the load.", metavar="FACTOR", **_TO)),
}
_BUSH = option(
    "A pressed bush: MATERIAL, BORE before pressing, HOLE/BUSH; --hole is around it.",
    metavar="BUSH",
    parser=reader(bush_words, f"is not a bush; {EXAMPLE}"),
    rich_help_panel="The housing of the hole",
)
# With a bush the pin may have a class of ISO 286.
_CHECKED: Options = dict(JOINT) | {
    "pin_diameter": (
        str | None,
        option("Diameter of the pin; with --bush also a class, 20f7.", "--pin-diameter",
               metavar="MM", parser=reader(diameter_words, "is not a diameter; give mm, or 20f7"),
               rich_help_panel="The pair of cylinders"),
    ),
}  # fmt: skip
# What a target is called in the errors of a search.
_TARGETS = {name: name for name in TARGETS} | {"yield_stress": "factor"}


def joint_of(
    pair: dict[str, Any], around: dict[str, Any], source: str, sought: str = ""
) -> LoadedJoint:
    """Return the joint that the options of a command give; `sought` is what it is to find."""
    own = own_materials(pair, source)
    return joint_from_words(pair | around, source, option_of, own, sought)


@takes("pair", _CHECKED)
@takes("around", AROUND)
def check(
    file: Path | None = argument(
        "A table of joints or clevises, or the file of a joint, of one with a bush, of a clevis.",
        metavar="FILE",
        default=None,
    ),
    *,
    bush: Any = _BUSH,
    out: Path | None = output("One page to file, .html, .pdf or .png; of a table the answers."),
    as_json: bool = JSON,
    quiet: bool = QUIET,
    pair: dict[str, Any],
    around: dict[str, Any],
) -> None:
    """Check a joint: penetration, stiffness, pressure and first yield.

    The joint is a pin in a hole, two rollers, or a roller on a plane.
    """
    if file is not None:
        require_file(file)
    if file is not None and is_table(file):
        _check_table(file, bush, out, as_json, quiet, pair | around)
        return
    require_output(out, *PAGES)
    answer = _checked(file, bush, pair, around)
    if out is not None:
        answer.save(out)
    say(answer.to_json() if as_json else str(answer))
    for warning in answer.warnings:
        say(f"warning: {warning}", err=True)


def _check_table(
    path: Path, bush: Any, out: Path | None, as_json: bool, quiet: bool, given: dict[str, Any]
) -> None:
    """Check the joints of a table, and write their answers."""
    from cylcontact.joint.tables import SUFFIXES, check_table, require_joints

    if not as_json and (out is None or out.suffix.lower() not in SUFFIXES):
        require_joints(path)  # what is wrong with the file goes before what it lacks
    require_output(out, *SUFFIXES)
    rule, remedy = f"is for one joint, and {path} is a table", "leave it out"
    require(bush is None, "check", "--bush", None, rule, remedy)
    require(out is not None or as_json, "check", "--out", None, "is missing for a table",
            "name the answers, e.g. -o answers.csv")  # fmt: skip
    own = own_materials(given, "check")
    given.pop("materials", None)
    with progress_bars(quiet) as progress:
        checked = check_table(path, materials=own, same=given, progress=progress)
    if as_json:
        say(json_text(checked.table))
    if out is not None:
        checked.save(out)
        counted = f"{checked.answered:,} of {len(checked.table):,} joints answered"
        note(f"{out}: {counted}", as_json or quiet)
    if checked.refused:
        counted = f"{checked.refused:,} of {len(checked.table):,} joints refused"
        say(f"cylcontact: {counted}; first: {checked.first_refusal}", err=True)
        raise typer.Exit(1)


def _check_joint_file(
    path: Path, bush: Any, pair: dict[str, Any], around: dict[str, Any]
) -> JointCheck:
    """Check the joint of a file under the load of the options."""
    from cylcontact.bodies.material import changed
    from cylcontact.joint import read_joint
    from cylcontact.joint.check import checked
    from cylcontact.joint.loaded import resolve
    from cylcontact.joint.words import load_from_words, rim_from_words

    materials, own = pair.pop("materials", None), own_materials(pair, "check")
    names = [*pair, *(["bush"] if bush is not None else []), *({"iso", "depth"} & {*around})]
    for name in names:
        rule, remedy = f"is in the file already: {path}", "leave one of them out"
        raise InputError("check", option_of(name), None, rule, remedy)
    joint = read_joint(path, materials)
    rule, remedy = f"is missing for {path}", "give the load on the joint, e.g. --load 5kN"
    require("load" in around, "check", "--load", None, rule, remedy)
    load = load_from_words(around["load"], joint.pair.length, "check", option_of)
    rim = rim_from_words(around.get("rim"), "check", option_of, own)
    bodies = (joint.pair.material_i, joint.pair.material_j)
    # A material that the file gives by its numbers is called like its body there.
    hole, pin = (changed(x, name="") if x.name in ("bearing", "pin") else x for x in bodies)
    cylinders = replace(joint.pair, material_i=hole, material_j=pin)
    warm = around.get("temperature")
    with blaming(option_of, "check"):
        return checked(resolve(cylinders, load, housing=joint.housing, temperature=warm, rim=rim))


def _checked(
    file: Path | None, bush: Any, pair: dict[str, Any], around: dict[str, Any]
) -> JointCheck | BushCheck | ClevisCheck:
    """Return the answer for the joint of a file or of the options."""
    if file is not None:
        from cylcontact.joint.specs import check_file, is_plain_joint

        if is_plain_joint(file):
            return _check_joint_file(file, bush, pair, around)
        materials = pair.pop("materials", None)
        options = [*map(option_of, (*pair, *around)), *["--bush"] * (bush is not None)]
        for name in options:
            rule, remedy = f"belongs in the file: {file}", "write it there, and leave it out here"
            raise InputError("check", name, None, rule, remedy)
        return check_file(file, materials)
    if bush is not None:
        from cylcontact.joint.bush_words import bush_from_words

        given = pair | around | {"bush": bush}
        return bush_from_words(given, "check", option_of, own_materials(pair, "check"))
    from cylcontact.joint.check import checked

    size = pair.get("pin_diameter")
    rule, remedy = "is a class, which is for a joint with --bush", "give --iso 20H7/f7, or mm"
    require(not isinstance(size, str), "check", "--pin-diameter", size, rule, remedy)
    joint = joint_of(pair, around, "check")
    with blaming(option_of, "check"):
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
    joint = joint_of(pair, around, "size", what)
    try:
        with blaming(option_of, "size", _TARGETS):
            answer = size_of(joint, what, **targets)  # type: ignore[arg-type]
    except InputError as error:
        value = error.value
        if error.key == "--penetration" and isinstance(value, float):
            value = f"{1e3 * value:g} µm"
        raise InputError(error.source, error.key, value, error.rule, error.remedy) from None
    say(json_text(answer.to_dict()) if as_json else str(answer))
    for warning in answer.warnings:
        say(f"warning: {warning}", err=True)
