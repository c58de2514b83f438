"""The commands `laws` and `export`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
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
from cylcontact.cli.pair import (
    PAIR,
    blaming_options,
    material_of,
    option_of,
    pair_of,
    read_housing,
)
from cylcontact.cli.terminal import say
from cylcontact.files.reading import plain_number
from cylcontact.files.writing import replacing_all, require_suffix
from cylcontact.support.choices import CODES, CONTACTS, JOINT_TARGETS, TARGETS, listed
from cylcontact.support.errors import InputError, require

if TYPE_CHECKING:
    from cylcontact.bodies.fits import Fit
    from cylcontact.bodies.pair import CylinderPair
    from cylcontact.laws import ContactLaw, Housing


def _temperatures(text: str) -> tuple[float, float]:
    pin, _, hole = text.partition(",")
    return plain_number(pin), plain_number(hole or pin)


_AT, _SHOWN = {"rich_help_panel": "Load and surroundings"}, {"rich_help_panel": "What to print"}
_FOUND = {"rich_help_panel": "Find a size instead"}
_OWN_CONTACT = {"rich_help_panel": "Parameters of a code's own contact"}
_WARM = option(
    "Temperature in °C, or PIN,HOLE; radii are those at 20 °C.",
    metavar="T",
    parser=reader(_temperatures, "must be one number or two, PIN,HOLE"),
    **_AT,
)
_RIM = "The housing's rim when warm: free, held, or the material of the frame."


@takes("pair", PAIR)
def laws(
    *,
    load: str = option("In N/mm, or '6 kN' with --length.", metavar="LOAD", default="100", **_AT),
    fit: str | None = option("An ISO fit instead of radii, 20H7/g6.", metavar="CODE", **_AT),
    temperature: Any = _WARM,
    rim: str | None = option(_RIM, metavar="STATE", **_AT),
    depth: float | None = number("Depth at which a plane (--Rj inf) is held, mm.", **_AT),
    every: bool = option("Compare all laws for this pair.", "--all", default=False, **_SHOWN),
    own: str | None = option("A law of your own, with --all.", metavar="MODULE:FUNCTION", **_SHOWN),
    accuracy: bool = option("Errors of all laws.", "--accuracy", default=False, **_SHOWN),
    listing: bool = option("All laws with their parameters.", "--list", default=False, **_SHOWN),
    as_json: bool = option("The numbers as JSON.", "--json", default=False, **_SHOWN),
    find: str | None = option("dR, E or length that gives one of these:", metavar="WHAT", **_FOUND),
    stiffness: float | None = number("N/mm²; for --find length N/mm.", **_FOUND),
    penetration: float | None = number("In µm.", **_FOUND),
    pair: dict[str, Any],
) -> None:
    """Check a joint: penetration, stiffness, pressure and first yield.

    With --find it computes the clearance, the pin's modulus or the length
    for a stiffness or a penetration instead. For a length, --load is in N.
    """
    from cylcontact.bodies.pair import unusual_lengths
    from cylcontact.files.units import load_in_N_per_mm
    from cylcontact.limits import yield_warning

    contact = pair.get("contact", "internal")
    if listing or accuracy:
        from cylcontact.reports import laws_compared

        require(contact in CONTACTS, "laws", "--contact", contact, "is unknown", listed(CONTACTS))
        table = laws_compared.listing if listing else laws_compared.accuracy_text
        say(table(contact))
        return
    for name, value in (("--stiffness", stiffness), ("--penetration", penetration)):
        if find is None:
            require(value is None, "laws", name, value, "is for --find", "add --find dR")
    around = read_housing(pair, "laws")
    iso = None if fit is None else _read_fit(fit, pair)
    cylinders = pair_of(pair, "laws", find)
    # Of a length that is sought the load is the total, as on a length of 1 mm.
    length = 1.0 if find == "length" else pair.get("length_mm")
    with blaming_options({"": "--load"}, "laws"):
        force = load_in_N_per_mm(load if " " in load else f"{load} N/mm", length)
    require(force > 0, "laws", "--load", load, "must be positive", "give it in N/mm")
    warm = _warming(temperature, rim, around, pair)
    if find is not None:
        _find(find, warm(cylinders), force, stiffness, penetration, around)
        return
    if every:
        from cylcontact.reports import laws_compared

        law = None
        if own is not None:
            from cylcontact.laws.user import user_law

            law = user_law(own, Path.cwd())
        say(laws_compared.comparison_text(warm(cylinders), force, law, around))
        return
    require(own is None, "laws", "--own", own, "needs --all", "add --all")
    _check(cylinders, force, around, iso, depth, warm, as_json)
    if iso is None:
        warnings = (yield_warning(force, warm(cylinders), around), *unusual_lengths(cylinders))
        _warn("", *warnings)


def _check(
    pair: CylinderPair,
    load: float,
    housing: Housing | None,
    fit: Fit | None,
    depth: float | None,
    warm: Callable[[CylinderPair], CylinderPair],
    as_json: bool,
) -> None:
    """Print what a joint does."""
    import json

    from cylcontact.reports.joint_check import check_joint

    if pair.is_flat:
        remedy = "give the depth at which the half-plane is held, e.g. --depth 50"
        require(depth is not None, "laws", "--depth", None, "is missing for a plane", remedy)
    else:
        require(depth is None, "laws", "--depth", depth, "is for a plane", "give --Rj inf too")
    with blaming_options({"datum": "--depth"}, "laws"):
        check = check_joint(pair, load, housing=housing, fit=fit, depth=depth, warm=warm)
    say(json.dumps(check.to_dict(), ensure_ascii=False, indent=1) if as_json else str(check))


def _warming(
    temperature: tuple[float, float] | None,
    rim: str | None,
    housing: Housing | None,
    given: Mapping[str, Any],
) -> Callable[[CylinderPair], CylinderPair]:
    """Return what takes a pair to its temperatures."""
    if temperature is None:
        require(rim is None, "laws", "--rim", rim, "is for --temperature", "give that too")
        return lambda pair: pair
    from cylcontact.limits import at_temperature

    state: Any = rim
    if rim not in (None, "free", "held"):
        state = material_of(str(rim), given, "laws", "--rim")
    pin, hole = temperature

    def warm(pair: CylinderPair) -> CylinderPair:
        with blaming_options(
            {"rim": "--rim", "hole": "--temperature", "pin": "--temperature"}, "laws"
        ):
            return at_temperature(pair, pin, hole, housing=housing, rim=state)

    return warm


def _warn(source: str, *warnings: str | None) -> None:
    for warning in filter(None, warnings):
        say(f"warning: {source}{warning}", err=True)


def _read_fit(code: str, given: dict[str, Any]) -> Fit:
    """Return an ISO fit, and put the radii in its middle in the place of those of the options."""
    from cylcontact.bodies.fits import Fit

    sizes = ("dR_mm", "R_i_mm", "R_j_mm", "hole_diameter", "pin_diameter")
    for name in filter(given.__contains__, sizes):
        rule = f"is given by the fit {code}"
        raise InputError("laws", option_of(name), given[name], rule, "leave one of them out")
    contact, rule, remedy = (
        given.get("contact", "internal"),
        "has no fit",
        "leave out --contact, or --fit",
    )
    require(contact == "internal", "laws", "--contact", contact, rule, remedy)
    fit = Fit.read(code, "laws", "--fit")
    rule, remedy = "leaves no clearance at any pair", "choose a looser pin: h, g"
    require(fit.clearance[1] > 0, "laws", "--fit", code, rule, remedy)
    given["R_i_mm"], given["R_j_mm"] = fit.nominal / 2 + 1.0, fit.nominal / 2
    return fit


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
    from cylcontact.limits.sizing import find as solve

    with blaming_options({"stiffness": "--stiffness", "load": "--load", "": "--find"}, "laws"):
        depth = None if penetration is None else 1e-3 * penetration
        law = None if housing is None else Conformal(housing)
        value = solve(what, pair, load, stiffness=stiffness, penetration=depth, law=law)  # type: ignore[arg-type]
    per, rate = ("N", "N/mm") if what == "length" else ("N/mm", "N/mm²")
    wanted = f"{penetration:g} µm" if stiffness is None else f"{stiffness:g} {rate}"
    datum = "by Johnson's datum" if housing is None else f"in {housing}"
    say(f"{what} = {value:.6g} {UNKNOWNS[what][0]} gives {wanted} under {load:g} {per}, {datum}")  # type: ignore[index]


@takes("pair", PAIR, listed=False)
def export(
    what: str | None = argument(
        "A fit result, a law such as johnson, or your own: mine:load.",
        metavar="[RESULT|LAW]",
        default=None,
    ),
    *,
    joint: Path | None = option("The file of a joint, datasets/joint.toml.", metavar="JOINT"),
    target: str = option(
        f"{listed(TARGETS)}; of a joint {listed(JOINT_TARGETS)}, or with --range {listed(CODES)}.",
        "--to",
        metavar="TARGET",
        default=...,
    ),
    force_range: Any = interval("Range of the total force, N.", "--range", **_OWN_CONTACT),
    mass: float | None = number("Effective mass in an impact, kg; 1 by default.", **_OWN_CONTACT),
    speed: float | None = number("Speed of an impact, m/s; else from the range.", **_OWN_CONTACT),
    out: Path | None = output("The file; a law goes to standard output without it."),
    pair: dict[str, Any],
) -> None:
    """Write a law, or a joint with clearance, in another language.

    A law in a housing (--R-o, --clamp) needs a pair, with the options of
    cylcontact laws. With --range, print the parameters of a code's own
    contact that fit the law of a joint best.
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
    """Write a law, conformal contact that of one pair, to a file or to standard output."""
    from cylcontact.export import law_named, source_and_header
    from cylcontact.export.notation import require_callable
    from cylcontact.laws.housing_spec import in_housing

    if out is not None:
        require_callable(target, out.stem)
    housing, contact, origin, of_pair = read_housing(pair, "export"), None, "", None
    law: ContactLaw
    if housing is not None:
        law = in_housing(what, housing, "export", "RESULT|LAW")
    else:
        law, contact, origin = law_named(what, pair.get("contact"))
    if law.name == "conformal" and (housing is not None or {*pair} - {"contact"}):
        of_pair = pair_of(pair, "export")
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
    _write(what, texts)


def _write(name: str, texts: Mapping[Path, Any]) -> None:
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
