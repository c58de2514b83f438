"""The commands `laws`, which list and compare laws, and `export`."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from cylcontact.cli.joint import AROUND, joint_of
from cylcontact.cli.options import (
    JSON,
    QUIET,
    argument,
    interval,
    number,
    option,
    output,
    require_output,
    takes,
)
from cylcontact.cli.pair import JOINT, option_of, own_materials
from cylcontact.cli.terminal import note, say
from cylcontact.files.writing import json_text, replacing_all, require_suffix
from cylcontact.joint.words import housing_from_words, pair_from_words
from cylcontact.support.choices import CODES, CONTACTS, JOINT_TARGETS, TARGETS, listed
from cylcontact.support.errors import InputError, require

if TYPE_CHECKING:
    from cylcontact.laws import ContactLaw

CONTACT = option(f"{listed(CONTACTS)}.", "--contact", default="internal", metavar="CONTACT")
_OWN_CONTACT = {"rich_help_panel": "Parameters of a code's own contact"}


def listing(contact: str = CONTACT) -> None:
    """List the laws, with the parameters that a fit searches."""
    from cylcontact.fitting.law_models import listing as parameters
    from cylcontact.laws.compare import listing as names

    _require_contact(contact)
    say(f"{names(contact)}\n\n{parameters(contact)}")  # type: ignore[arg-type]


def accuracy(contact: str = CONTACT, as_json: bool = JSON) -> None:
    """Print the errors of all laws over the ranges in which they are used."""
    from cylcontact.laws import compare as module

    _require_contact(contact)
    if as_json:
        say(json_text({"rows": module.accuracy(contact)}))  # type: ignore[arg-type]
    else:
        say(module.accuracy_text(contact))  # type: ignore[arg-type]


@takes("pair", JOINT)
@takes("around", AROUND)
def compare(
    *,
    own: str | None = option("Your own law, as one more row.", metavar="MODULE:FUNCTION"),
    as_json: bool = JSON,
    pair: dict[str, Any],
    around: dict[str, Any],
) -> None:
    """Compare all laws for one joint.

    With an ISO fit there is a table for each pair, from the tightest to the loosest.
    """
    from cylcontact.joint.answer import described
    from cylcontact.joint.check import checked
    from cylcontact.laws.compare import comparison, comparison_text

    joint, law = joint_of(pair, around, "laws compare"), None
    if own is not None:
        from cylcontact.laws.user import user_law

        law = user_law(own, Path.cwd())
    given = float(joint.load), law, joint.housing, joint.depth
    pairs = dict(joint.solved())
    if as_json:
        tables = {name: comparison(each, *given) for name, each in pairs.items()}
        rows = [table.assign(pair=name).to_dict("records") for name, table in tables.items()]
        say(json_text({"rows": [*chain.from_iterable(rows)]}))
    else:
        parts = ["\n".join(described(joint))]
        for name, each in pairs.items():
            title = f"{name}: {each.dR * 1e3:.4g} µm\n" if joint.iso else ""
            parts.append(title + comparison_text(each, *given))
        say("\n\n".join(parts))
    for warning in checked(joint).warnings:
        say(f"warning: {warning}", err=True)


def _require_contact(contact: str) -> None:
    require(contact in CONTACTS, "laws", "--contact", contact, "is unknown", listed(CONTACTS))


def _warn(source: str, *warnings: str | None) -> None:
    for warning in filter(None, warnings):
        say(f"warning: {source}{warning}", err=True)


@takes("pair", JOINT)
def export(
    what: str | None = argument(
        "A fit result, a law such as johnson, or your own: mine:load.",
        metavar="RESULT|LAW",
        default=None,
    ),
    *,
    joint: Path | None = option("The file of a joint, datasets/joint.toml.", metavar="FILE"),
    target: str = option(
        f"{listed(TARGETS)}; of a joint {listed(JOINT_TARGETS)}, or with --range {listed(CODES)}.",
        "--to",
        metavar="TARGET",
        default=...,
    ),
    force_range: Any = interval("Range of the total force, N.", "--range", **_OWN_CONTACT),
    mass: float | None = number(
        "Effective mass in an impact; 1 by default.", metavar="KG", **_OWN_CONTACT
    ),
    speed: float | None = number(
        "Speed of an impact; else from the range.", metavar="M/S", **_OWN_CONTACT
    ),
    out: Path | None = output("The file; a law goes to standard output without it."),
    quiet: bool = QUIET,
    pair: dict[str, Any],
) -> None:
    """Write a law, or a joint with clearance, in another language.

    A law in a housing (--R-o, --clamp) needs a pair, with the options of
    cylcontact check. With --range, print the parameters of a code's own
    contact that fit the law of a joint best.
    """
    forces = force_range and "{:g}:{:g}".format(*force_range)
    own_contact = {"--range": forces, "--mass": mass, "--speed": speed}
    require_output(out)
    if joint is not None:
        _refuse({"RESULT|LAW": what}, "is in the file of the joint already", "leave it out")
        others = {option_of(name): value for name, value in pair.items() if name != "materials"}
        _refuse(others, "is in the file of the joint already", "leave it out, or --joint")
    if target in CODES:
        _export_parameters(
            joint, target, force_range, mass, speed, pair.get("materials"), out, quiet
        )
        return
    remedy = f"leave it out, or choose --to {listed(CODES)}"
    _refuse(own_contact, "is for a code's own contact", remedy)
    if joint is not None:
        _export_joint(joint, target, out, pair.get("materials"), quiet)
    else:
        remedy = "name one, e.g. explicit, or a joint with --joint"
        require(what is not None, "export", "RESULT|LAW", None, "is missing", remedy)
        _export_law(str(what), target, out, pair, quiet)


def _refuse(given: Mapping[str, Any], rule: str, remedy: str) -> None:
    """Refuse options that are given."""
    for name, value in given.items():
        require(value is None, "export", name, value, rule, remedy)


def _export_law(
    what: str, target: str, out: Path | None, pair: dict[str, Any], quiet: bool
) -> None:
    """Write a law, conformal contact that of one pair, to a file or to standard output."""
    from cylcontact.export import law_named, source_and_header
    from cylcontact.export.languages import require_callable
    from cylcontact.laws.housing_spec import in_housing

    if out is not None:
        require_callable(target, out.stem)
    own, contact, origin, of_pair = own_materials(pair, "export"), None, "", None
    housing = housing_from_words(pair, "export", option_of, own)
    law: ContactLaw
    if housing is not None:
        law = in_housing(what, housing, "export", "RESULT|LAW")
    else:
        law, contact, origin = law_named(what, pair.get("contact"))
    if law.name == "conformal" and (housing is not None or {*pair} - {"contact"}):
        of_pair = pair_from_words(pair, "export", option_of, own)
    else:
        others = {option_of(name): value for name, value in pair.items() if name != "contact"}
        _refuse(others, "is for conformal contact or a joint", "leave it out, or export conformal")
    source, header = source_and_header(law, contact, target, origin, of_pair)
    if out is None:
        typer.echo(source, nl=False)
        return
    texts = {out: source}
    if header:
        texts[out.with_suffix(".h")] = header
    _write(what, texts, quiet)


def _write(name: str, texts: Mapping[Path, Any], quiet: bool) -> None:
    """Write what is exported, all of its files or none."""
    with replacing_all(texts) as files:
        for file, text in zip(files, texts.values(), strict=True):
            file.write_bytes(text if isinstance(text, bytes) else text.encode("ascii"))
    note(f"{name} written to {', '.join(map(str, texts))}", quiet)


def _export_parameters(
    path: Path | None,
    code: str,
    force_range: tuple[float, float] | None,
    mass: float | None,
    speed: float | None,
    materials: str | None,
    out: Path | None,
    quiet: bool,
) -> None:
    """Print the parameters of a code's own contact, or write them to the file `out`."""
    from cylcontact.bodies.pair import unusual_lengths
    from cylcontact.export import contact_parameters
    from cylcontact.mechanism import read_joint

    rule = f"is missing for {code}"
    if path is None:
        remedy = "name its file, e.g. --joint datasets/joint.toml"
        raise InputError("export", "--joint", None, rule, remedy)
    if force_range is None:
        raise InputError("export", "--range", None, rule, "give total forces in N, e.g. 100:5000")
    joint = read_joint(path, materials)
    parameters = contact_parameters(joint, code, *force_range, 1.0 if mass is None else mass, speed)
    if out is None:
        typer.echo(parameters)
    else:
        _write(joint.name, {out: f"{parameters}\n"}, quiet)
    yields = f"first yield is at {joint.first_yield:.4g} N"
    above = yields if force_range[1] > joint.first_yield else None
    _warn(f"{path}: ", above, *unusual_lengths(joint.pair))


def _export_joint(
    path: Path, target: str, out: Path | None, materials: str | None, quiet: bool
) -> None:
    """Write a joint as a force element, next to the file `out`."""
    from cylcontact.bodies.pair import unusual_lengths
    from cylcontact.export import export_joint
    from cylcontact.files.spec import read_toml
    from cylcontact.mechanism import ClearanceJoint, SpatialJoint, read_joint

    joint: SpatialJoint | ClearanceJoint
    if read_toml(path).get("kind") == "spatial":
        joint = SpatialJoint.read(path, materials)
        planar = joint.planar
    else:
        joint = planar = read_joint(path, materials)
    texts = export_joint(joint, target, out.stem if out else "")
    suffix = JOINT_TARGETS[target]
    if out is None:
        remedy = f"name the file, e.g. -o {planar.identifier}{suffix}"
        raise InputError("export", "--out", None, "is missing for a joint", remedy)
    require_suffix(out, suffix)
    _write(planar.name, {out.with_name(name): text for name, text in texts.items()}, quiet)
    _warn(f"{path}: ", *unusual_lengths(planar.pair))
