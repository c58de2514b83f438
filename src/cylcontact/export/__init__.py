"""Laws and clearance joints as source text for other programs: C, Fortran, MATLAB and others."""

from __future__ import annotations

import re
from collections.abc import Collection
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from cylcontact.laws import LAWS, refuse_gone
from cylcontact.laws.law import ContactLaw, has_formula
from cylcontact.laws.user import user_law
from cylcontact.support.arrays import require
from cylcontact.support.choices import CODES, CONTACTS, JOINT_TARGETS, TARGETS, Contact, listed
from cylcontact.support.errors import InputError

if TYPE_CHECKING:
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


# A law without a closed form is known too, and refused when it is exported.
EXPORTABLE = tuple(name for name, law in LAWS.items() if has_formula(law()))


def export(law: ContactLaw, contact: str | None, target: str, origin: str = "") -> str | bytes:
    """Return a law with its coefficients as self-contained source text, or as an FMU.

    The text has a function of penetration (mm), E* (MPa) and ΔR (mm), for some laws also of R_i,
    R_j and the length (mm), α and β. It returns load (N/mm) and stiffness (N/mm²), both NaN outside
    the law's domain and 0 where the bodies do not touch. For JAX it has `load` and `penetration`,
    which differentiate.

    Parameters
    ----------
    law : ContactLaw
        A law with a formula, of the package, of your own or scaled.
    contact : {"internal", "external"} or None
        The contact; may be None if the law or its coefficients determine it, or if it makes no
        difference.
    target : {"c", "cpp", "fortran", "matlab", "python", "jax", "fmu"}
        The language.
    origin : str, optional
        Where user-defined coefficients come from, for the comments.

    Returns
    -------
    str or bytes
        The text of one file, which for MATLAB must have the name of the function; of an FMU the
        bytes.

    Raises
    ------
    InputError
        If the target or contact is unknown, the law has no formula that can be written in another
        language or is not for the contact, its load is negative or decreases for some pair, or an
        FMU finds no C compiler.

    Examples
    --------
    >>> from cylcontact import laws
    >>> source = export(laws.Enhanced(), "internal", "c")
    >>> print(*[line.strip() for line in source.splitlines() if "double a =" in line])
    static const double a = 0.965;
    """
    from cylcontact.export.exported_law import exported, require_contact_law, source

    _require_target(target)
    rule, remedy = "is not a contact", f"choose {listed(CONTACTS)}"
    require(contact in (*CONTACTS, None), "export", "--contact", contact, rule, remedy)
    chosen = exported(law, cast("Contact | None", contact), origin)
    require_contact_law(law, chosen.contact)
    return source(chosen, target)


def export_named(what: str, contact: str | None, target: str) -> str | bytes:
    """Return `export` of a law given by name, or of a fit result given by path.

    Parameters
    ----------
    what : str
        A law's name, e.g. "johnson", "module:function" of your own, or the path of a fit result.
    contact : {"internal", "external"} or None
        The contact; a result knows its own.
    target : {"c", "cpp", "fortran", "matlab", "python", "jax", "fmu"}
        The language.

    Returns
    -------
    str or bytes
        The text of one file, or an FMU.

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
    if what in LAWS:
        return export(LAWS[what](), contact, target)
    refuse_gone(what, "export", "law")
    if what.startswith("power"):
        rule, remedy = "has no coefficients of its own", "name a fit result of it"
        raise InputError("export", "law", what, rule, remedy)
    is_path = Path(what).suffix == ".json"
    with suppress(OSError):  # of a name that is too long
        is_path = is_path or Path(what).exists()
    if is_path:
        law, contact, origin = _of_result(what, contact)
        return export(law, contact, target, origin)
    if ":" in what:
        law = user_law(what, Path.cwd())
        return export(law, contact, target, "a function of the user's own")
    rule = "is neither a law that can be exported nor a fit result"
    names = ", ".join(EXPORTABLE)
    remedy = f"choose {names}, module:function of your own, or the path of a result"
    raise InputError("export", "law", what, rule, remedy)


def export_joint(
    joint: ClearanceJoint | SpatialJoint, target: str, stem: str = ""
) -> dict[str, str] | dict[str, bytes]:
    """Return a clearance joint as a force element in another language.

    The source is self-contained, with `start`, `evaluate` and `accept` as
    `cylcontact.mechanism.ClearanceJoint` has them; units, constants, assumptions and check values
    stand in its comments.

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
        If the target is unknown, the file's name is not one that the language can import, the
        joint's name is taken in its Fortran or C++, or an FMU finds no C compiler.

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
        from cylcontact.export.fmu import joint_fmu

        return joint_fmu(Element(joint), stem)
    return Element(joint).source(target, stem)


def _of_result(path: str, contact: str | None) -> tuple[ContactLaw, Contact, str]:
    """Return the law of a fit result, its contact, and in words what it was fitted to."""
    from cylcontact.fitting.results import FitResult

    result = FitResult.read(path)
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


def _require_target(target: str, targets: Collection[str] = TARGETS) -> None:
    rule, remedy = "is not a known target", f"choose {listed(targets)}"
    require(target in targets, "export", "--to", target, rule, remedy)
