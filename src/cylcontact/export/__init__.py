"""Laws and clearance joints as source text for other programs: C, Fortran and MATLAB."""

from __future__ import annotations

import re
from collections.abc import Collection
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from cylcontact.laws import LAWS
from cylcontact.laws.law import ContactLaw
from cylcontact.laws.power import require_coefficients
from cylcontact.laws.user import user_law
from cylcontact.support.arrays import require
from cylcontact.support.choices import CODES, CONTACTS, JOINT_TARGETS, TARGETS, Contact, listed
from cylcontact.support.errors import InputError

if TYPE_CHECKING:
    from cylcontact.bodies.pair import CylinderPair
    from cylcontact.export.parameters import contact_parameters
    from cylcontact.mechanism import ClearanceJoint, SpatialJoint

__all__ = [
    "CODES",
    "EXPORTABLE",
    "JOINT_TARGETS",
    "TARGETS",
    "contact_parameters",
    "export",
    "export_joint",
    "export_named",
]


def __dir__() -> list[str]:
    return __all__


def __getattr__(name: str) -> Any:
    if name == "contact_parameters":
        return import_module(f"{__name__}.parameters").contact_parameters
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


EXPORTABLE = tuple(LAWS)


def export(
    law: ContactLaw,
    contact: str | None,
    target: str,
    origin: str = "",
    pair: CylinderPair | None = None,
) -> str:
    """Return a law with its coefficients as self-contained source text.

    The text has a function for the load (N/mm) and one for the stiffness (N/mm²) of penetration
    (mm), E* (MPa) and ΔR (mm), for some laws also of R_i, R_j and the length (mm), α and β. Both
    are NaN outside the law's domain and 0 where the bodies do not touch.

    Parameters
    ----------
    law : ContactLaw
        A law of the package, your own, or a scaled one.
    contact : {"internal", "external"} or None
        The contact; may be None if the law or its coefficients determine it, or if it makes no
        difference.
    target : {"c", "fortran", "matlab"}
        The language.
    origin : str, optional
        Where user-defined coefficients come from, for the comments.
    pair : CylinderPair, optional
        The materials of conformal contact, and the radii in a housing, for which it is a table.

    Returns
    -------
    str
        The text of one file, which for MATLAB must have the name of the function.

    Raises
    ------
    InputError
        If the target or contact is unknown, the law cannot be written in another language or is
        not for the contact, or its load is negative or decreases for some pair.

    Examples
    --------
    >>> from cylcontact import laws
    >>> source = export(laws.Enhanced(), "internal", "c")
    >>> print(*[line.strip() for line in source.splitlines() if "double a =" in line][:1])
    const double a = 0.965;
    """
    return source_and_header(law, contact, target, origin, pair)[0]


def source_and_header(
    law: ContactLaw,
    contact: str | None,
    target: str,
    origin: str = "",
    pair: CylinderPair | None = None,
) -> tuple[str, str]:
    """Return `export`, and the header of C, which C++ takes too; empty for other languages."""
    from cylcontact.export.law import exported, header, require_contact_law, source

    _require_target(target, TARGETS)
    rule, remedy = "is not a contact", f"choose {listed(CONTACTS)}"
    require(contact in (*CONTACTS, None), "export", "--contact", contact, rule, remedy)
    chosen = exported(law, cast("Contact | None", contact), origin, pair)
    if pair is None:
        require_contact_law(law, chosen.contact)
    return source(chosen, target), header(chosen) if target == "c" else ""


def law_named(what: str, contact: str | None) -> tuple[ContactLaw, str | None, str]:
    """Return a law by its name or by the path of a fit result, its contact and its origin."""
    if what in LAWS:
        return LAWS[what](), contact, ""
    is_path = Path(what).suffix == ".json"
    with suppress(OSError):  # of a name that is too long
        is_path = is_path or Path(what).exists()
    if is_path:
        return _of_result(what, contact)
    if ":" in what:
        return user_law(what, Path.cwd()), contact, "a function of the user's own"
    require_coefficients(what, "export")
    rule = "is neither a law that can be exported nor a fit result"
    names = ", ".join(EXPORTABLE)
    remedy = f"choose {names}, your module:function, or the path of a result"
    raise InputError("export", "law", what, rule, remedy)


def export_named(
    what: str, contact: str | None, target: str, pair: CylinderPair | None = None
) -> str:
    """Return `export` of a law given by name, or of a fit result given by path.

    Parameters
    ----------
    what : str
        A law's name, e.g. "johnson", "module:function" for your own, or the path of a fit result.
    contact : {"internal", "external"} or None
        The contact; a result knows its own.
    target : {"c", "fortran", "matlab"}
        The language.
    pair : CylinderPair, optional
        As `export` takes it.

    Returns
    -------
    str
        The text of one file.

    Raises
    ------
    InputError
        If there is no such law, result, contact or target, or they do not fit together.

    Examples
    --------
    >>> source = export_named("johnson", None, "fortran")
    >>> print(*[line for line in source.splitlines() if line.startswith("module")])
    module cylcontact_johnson_law
    """
    law, contact, origin = law_named(what, contact)
    return export(law, contact, target, origin, pair)


def export_joint(
    joint: ClearanceJoint | SpatialJoint, target: str, stem: str = ""
) -> dict[str, str] | dict[str, bytes]:
    """Return a clearance joint as a force element in another language.

    The source is self-contained, with `start`, `evaluate` and `accept` as
    `cylcontact.mechanism.ClearanceJoint` has them. Its comments have units, materials, assumptions
    and a motion with its forces, to check a build against.

    Parameters
    ----------
    joint : ClearanceJoint or SpatialJoint
        The joint, of any law.
    target : str
        The language, one of `JOINT_TARGETS`.
    stem : str, optional
        The name of the files without suffix; by default that of the joint.

    Returns
    -------
    dict
        The texts of the files by name; of an FMU the bytes.

    Raises
    ------
    InputError
        If the target is unknown, MATLAB cannot call a file of that name, the joint's name is taken
        in its Fortran, or there is no C compiler for an FMU.

    Examples
    --------
    >>> from cylcontact.mechanism import read_joint
    >>> list(export_joint(read_joint("datasets/joint.toml"), "c"))
    ['wrist_pin.c', 'wrist_pin.h']
    """
    _require_target(target, JOINT_TARGETS)
    require(
        not stem or re.fullmatch(r"[\w+-][\w.+ -]*", stem, re.ASCII) is not None, "export", "--out",
        stem, "is not plain text", "name the file with ASCII letters, digits, spaces, - and _",
    )  # fmt: skip
    from cylcontact.export.joint import Element

    if target == "fmu":
        from cylcontact.export.fmu import JointFmu

        return JointFmu(Element(joint)).files(stem)
    return Element(joint).source(target, stem)


def _of_result(path: str, contact: str | None) -> tuple[ContactLaw, Contact, str]:
    """Return the law of a fit result, its contact, and in words what it was fitted to."""
    from cylcontact.fitting import read_result

    result = read_result(path)
    require(
        contact in (None, result.contact), path, "contact", result.contact,
        f"contradicts --contact {contact}",
        "leave --contact out, or name a result for that contact",
    )  # fmt: skip
    made_with = result.provenance.get("cylcontact", "an unknown version")
    origin = (
        f"fit result '{result.name}', fitted to {result.reference} by cylcontact {made_with}, "
        f"{result.objective.name} = {result.objective.value:.6g}"
    )
    return result.to_law(path), result.contact, origin


def _require_target(target: str, targets: Collection[str]) -> None:
    rule, remedy = "is not a known target", f"choose {listed(targets)}"
    require(target in targets, "export", "--to", target, rule, remedy)
