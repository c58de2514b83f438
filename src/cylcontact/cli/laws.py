"""The commands `laws` and `export`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from cylcontact.cli.options import (
    argument,
    interval,
    number,
    option,
    output,
    reader,
    require_output,
    takes,
)
from cylcontact.cli.pair import PAIR, blaming_options, option_of, pair_of, read_housing
from cylcontact.cli.terminal import say
from cylcontact.files.reading import plain_number
from cylcontact.files.writing import replacing_all, require_suffix, shipped_bench
from cylcontact.support.choices import CODES, JOINT_TARGETS, TARGETS, listed
from cylcontact.support.errors import InputError, require

if TYPE_CHECKING:
    from cylcontact.bodies.pair import CylinderPair
    from cylcontact.laws import Housing


def _temperatures(text: str) -> tuple[float, float]:
    pin, _, hole = text.partition(",")
    return plain_number(pin), plain_number(hole or pin)


_WARM = option(
    "Of pin and hole, °C, or PIN,HOLE; radii hold at 20.",
    metavar="T",
    parser=reader(_temperatures, "must be one number or two, PIN,HOLE"),
)


@takes("pair", PAIR)
def laws(
    *,
    load: str = option("N/mm; '6 kN' with --length.", metavar="LOAD", default="100"),
    own: str | None = option("A function of your own beside them.", metavar="MODULE:FUNCTION"),
    fit: str | None = option("A fit, 20H7/g6, instead of radii.", metavar="CODE"),
    temperature: Any = _WARM,
    find: str | None = option("dR, E or length, for one of these:", metavar="WHAT"),
    stiffness: float | None = number("For --find, N/mm²; of a length N/mm."),
    penetration: float | None = number("For --find, µm."),
    listing: bool = option("A line each, and what fits search.", "--list", default=False),
    pair: dict[str, Any],
) -> None:
    """Compare the laws for a pair, and say which one to use.

    Without options it is a steel pin (207 GPa, 0.3) in a hole of 10 mm radius with ΔR = 0.05 mm.
    With --fit it begins with the band of the fit. For the length of --find the load is the total.
    """
    from cylcontact.bodies.pair import unusual_lengths
    from cylcontact.files.units import load_in_N_per_mm
    from cylcontact.laws.user import user_law
    from cylcontact.limits import yield_warning
    from cylcontact.reports import laws_to_use
    from cylcontact.reports.bench import Bench
    from cylcontact.reports.laws_table import listing as all_laws
    from cylcontact.reports.laws_table import to_text

    around = read_housing(pair, "laws")
    cylinders = pair_of(pair, "laws")
    if listing:
        say(all_laws(cylinders.contact))
        return
    # Of a length that is sought the load is the total, as on a length of 1 mm.
    length = 1.0 if find == "length" else pair.get("length_mm")
    with blaming_options({"": "--load"}, "laws"):
        force = load_in_N_per_mm(load if " " in load else f"{load} N/mm", length)
    warm = dict(zip(("pin", "hole"), temperature or (), strict=False))
    if fit is not None:
        cylinders = _of_fit(fit, cylinders, pair, force, warm)
    if warm:
        cylinders = cylinders.at_temperature(**warm)
    if find is not None:
        _find(find, cylinders, force, stiffness, penetration, around)
        return
    for name, value in (("--stiffness", stiffness), ("--penetration", penetration)):
        require(value is None, "laws", name, value, "is for --find", "add --find dR")
    advice = laws_to_use.to_text(cylinders.contact, Bench(shipped_bench()))
    listed_too = None if own is None else user_law(own, Path.cwd())
    say(f"{advice}\n\n{to_text(cylinders, force, listed_too, around)}")
    _warn("", yield_warning(force, cylinders, around), *unusual_lengths(cylinders))


def _warn(source: str, *warnings: str | None) -> None:
    for warning in filter(None, warnings):
        say(f"warning: {source}{warning}", err=True)


def _of_fit(
    code: str, pair: CylinderPair, given: Mapping[str, Any], load: float, warm: dict[str, float]
) -> CylinderPair:
    """Print the bands of a fit, and return the pair in its middle."""
    from dataclasses import replace

    from cylcontact.bodies.fits import Fit
    from cylcontact.limits.sizing import bands

    sizes = ("dR_mm", "R_i_mm", "R_j_mm", "hole_diameter", "pin_diameter")
    for name in filter(given.__contains__, sizes):
        rule = f"is given by the fit {code}"
        raise InputError("laws", option_of(name), given[name], rule, "leave one of them out")
    rule, remedy = "has no fit", "leave out --contact, or --fit"
    require(pair.contact == "internal", "laws", "--contact", pair.contact, rule, remedy)
    fit = Fit.read(code, "laws", "--fit")
    fit.require_clearance("laws", "--fit")
    over = bands(
        fit, pair, load, pin_temperature=warm.get("pin"), hole_temperature=warm.get("hole")
    )
    say(f"{over}\nby Johnson's datum, which takes no housing\n")
    R_i, R_j = fit.middle
    return replace(pair, dR=R_i - R_j, R_i=R_i, R_j=R_j)


def _find(
    what: str,
    pair: CylinderPair,
    load: float,
    stiffness: float | None,
    penetration: float | None,
    housing: Housing | None,
) -> None:
    """Print the clearance, modulus or length that meets a stiffness or a penetration."""
    from cylcontact.laws import Conformal
    from cylcontact.limits.sizing import UNKNOWNS
    from cylcontact.limits.sizing import find as found

    with blaming_options({"stiffness": "--stiffness", "load": "--load", "": "--find"}, "laws"):
        depth = None if penetration is None else 1e-3 * penetration
        law = None if housing is None else Conformal(housing)
        value = found(what, pair, load, stiffness=stiffness, penetration=depth, law=law)  # type: ignore[arg-type]
    per, rate = ("N", "N/mm") if what == "length" else ("N/mm", "N/mm²")
    wanted = f"{penetration:g} µm" if stiffness is None else f"{stiffness:g} {rate}"
    datum = "by Johnson's datum" if housing is None else f"in {housing}"
    say(f"{what} = {value:.6g} {UNKNOWNS[what][0]} gives {wanted} under {load:g} {per}, {datum}")  # type: ignore[index]


@takes("pair", PAIR, listed=False)
def export(
    what: str | None = argument(
        "A fit result, or a law: johnson, or mine:load.", metavar="[RESULT|LAW]", default=None
    ),
    *,
    joint: Path | None = option(
        "A joint, e.g. datasets/joint.toml, as a force element.", metavar="JOINT"
    ),
    target: str = option(
        f"{listed(TARGETS)}; of a joint {listed(JOINT_TARGETS)}, or with --range {listed(CODES)}.",
        "--to",
        metavar="TARGET",
        default=...,
    ),
    force_range: Any = interval("Total force in N for a code's own contact.", "--range"),
    mass: float | None = number("Effective mass of its impacts, kg; 1."),
    speed: float | None = number("Their speed, m/s; by the middle of the range."),
    out: Path | None = output("The file; standard output by default, but for a joint."),
    pair: dict[str, Any],
) -> None:
    """Write a law, or a clearance joint, in another language.

    A law in a housing (--R-o, --clamp) is of one pair, which takes the options of cylcontact laws;
    others are of any. With --range, print the parameters of the code's own contact that follow a
    joint's law over a range.
    """
    forces = force_range and "{:g}:{:g}".format(*force_range)
    own_contact = {"--range": forces, "--mass": mass, "--speed": speed}
    require_output(out)
    if target in CODES:
        _export_parameters(joint, target, force_range, mass, speed, pair.get("materials"), out)
        return
    remedy = f"leave it out, or choose --to {listed(CODES)}"
    _refuse(own_contact, "is for a code's own contact", remedy)
    if joint is not None:
        _refuse({"RESULT|LAW": what}, "is in the file of the joint already", "leave it out")
        _export_joint(joint, target, out, pair)
    else:
        remedy = "name one, e.g. explicit, or a joint with --joint"
        require(what is not None, "export", "RESULT|LAW", None, "is missing", remedy)
        _export_law(str(what), target, out, pair)


def _refuse(given: Mapping[str, Any], rule: str, remedy: str) -> None:
    """Refuse options that are given."""
    for name, value in given.items():
        require(value is None, "export", name, value, rule, remedy)


def _export_law(what: str, target: str, out: Path | None, pair: dict[str, Any]) -> None:
    """Write a law, in a housing that of one pair, to a file or to standard output."""
    from cylcontact.export import export as exported
    from cylcontact.export import export_named
    from cylcontact.export.in_housing import law_in_housing
    from cylcontact.export.language import require_callable
    from cylcontact.laws.housing_spec import in_housing

    if out is not None:
        require_callable(target, out.stem)
    housing = read_housing(pair, "export")
    source: str | bytes
    if housing is not None:
        conformal = in_housing(what, housing, "export", "RESULT|LAW")
        law, words = law_in_housing(conformal, pair_of(pair, "export"))
        say(f"{what} in this housing: {words}", err=True)
        source = exported(law, None, target, words)
    else:
        contact = pair.pop("contact", None)
        others = {option_of(name): value for name, value in pair.items()}
        _refuse(others, "is for a law in a housing or a joint", "leave it out, or add --R-o")
        source = export_named(what, contact, target)
    if out is not None:
        _write(what, {out: source})
        return
    remedy = "name the file, e.g. -o law.fmu"
    require(isinstance(source, str), "export", "--out", None, "is missing for an FMU", remedy)
    typer.echo(source, nl=False)


def _write(name: str, texts: Mapping[Path, str | bytes]) -> None:
    """Write what is exported, all of its files or none."""
    with replacing_all(texts) as files:
        for file, text in zip(files, texts.values(), strict=True):
            file.write_bytes(text if isinstance(text, bytes) else text.encode("ascii"))
    say(f"{name} written to {', '.join(map(str, texts))}")


def _export_parameters(
    path: Path | None,
    code: str,
    force_range: tuple[float, float] | None,
    mass: float | None,
    speed: float | None,
    materials: str | None,
    out: Path | None,
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
        _write(joint.name, {out: f"{parameters}\n"})
    yields = f"first yield is at {joint.first_yield:.4g} N"
    above = yields if force_range[1] > joint.first_yield else None
    _warn(f"{path}: ", above, *unusual_lengths(joint.pair))


def _export_joint(path: Path, target: str, out: Path | None, pair: Mapping[str, Any]) -> None:
    """Write a joint as a force element, next to the file `out`."""
    from cylcontact.bodies.pair import unusual_lengths
    from cylcontact.export import export_joint
    from cylcontact.files.spec import read_toml
    from cylcontact.mechanism import ClearanceJoint, SpatialJoint, read_joint

    others = {option_of(name): value for name, value in pair.items() if name != "materials"}
    _refuse(others, "is in the file of the joint already", "leave it out, or --joint")
    joint: SpatialJoint | ClearanceJoint
    if read_toml(path).get("kind") == "spatial":
        joint = SpatialJoint.read(path, pair.get("materials"))
        planar = joint.planar
    else:
        joint = planar = read_joint(path, pair.get("materials"))
    texts = export_joint(joint, target, out.stem if out else "")
    suffix = JOINT_TARGETS[target]
    if out is None:
        remedy = f"name the file, e.g. -o {planar.identifier}{suffix}"
        raise InputError("export", "--out", None, "is missing for a joint", remedy)
    require_suffix(out, suffix)
    _write(planar.name, {out.with_name(name): text for name, text in texts.items()})
    _warn(f"{path}: ", *unusual_lengths(planar.pair))
