"""A law in C, Fortran and MATLAB: load and stiffness of a penetration and a pair."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib.metadata import version
from textwrap import wrap
from typing import Any

import numpy as np

from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import CONTACTS, Contact, CylinderPair
from cylcontact.export.conformal import table_of
from cylcontact.export.languages import WIDTH, C, Fortran, MatlabArrays, plain_ascii
from cylcontact.export.plain import Function, Program, Vector, names_in
from cylcontact.fitting.adapters import ScaledLaw
from cylcontact.laws import LAWS, Conformal, Johnson
from cylcontact.laws.formula import OF_PAIR, STEP, Formula
from cylcontact.laws.lambert import OF_NUMBERS
from cylcontact.laws.law import ContactLaw, has_formula
from cylcontact.support.arrays import FloatArray, require
from cylcontact.support.errors import InputError
from cylcontact.support.plain_text import comment, identifier

# Unit and meaning of the arguments of exported functions.
MEANINGS: Mapping[str, tuple[str, str]] = {
    "penetration": ("mm", "penetration of the surfaces; negative where they do not touch"),
    "E_star": ("MPa", "composite modulus, 1/E_star = (1 - nu_i^2)/E_i + (1 - nu_j^2)/E_j"),
    "dR": ("mm", "R_i - R_j, internal (pin j in hole i); R_i + R_j, external (rollers)"),
    "R_i": ("mm", "radius of body i"),
    "R_j": ("mm", "radius of body j"),
    "length": ("mm", "axial length of the contact"),
    "alpha": ("-", "w_j - w_i with w_k = E_star*(1 - nu_k^2)/E_k; body j is the pin"),
    "beta": ("-", "w_j*g_j - w_i*g_i with g_k = (1 - 2*nu_k)/(2 - 2*nu_k)"),
}
# What pairs can have; other arguments are positive.
_DOMAINS = {"alpha": "alpha * alpha < 1", "beta": "beta * beta < 0.251"}
# Clearances and sums of radii in mm, moduli in MPa and penetrations over ΔR that are tried.
_DR: dict[Contact, tuple[float, float]] = {"internal": (0.005, 9.0), "external": (5.0, 500.0)}
_MODULI = (2e3, 70e3, 207e3, 600e3)
_DEPTHS = np.geomspace(1e-6, 1.0, 61)[:, None, None]
# Rounding may take this part from a load that levels off.
_ROUNDING = 1e-9


class _Elemental(Fortran):
    """Functions that take arrays too, except those that take a table."""

    def function(self, f: Function) -> str:
        """Return a function."""
        takes_table = any(isinstance(kind, Vector) for kind in f.arguments.values())
        self.prefix = "pure " if takes_table else "elemental "
        return super().function(f)


# The variable of a frame that has the numbers of the pair: no law has a constant of this name.
NUMBERS = "numbers_of_pair"
LANGUAGES: Mapping[str, type[C]] = {"c": C, "fortran": _Elemental, "matlab": MatlabArrays}


@dataclass(frozen=True)
class ExportedLaw:
    """A law for a contact, or for both, scaled by factors other than 1."""

    law: ContactLaw
    contact: Contact | None
    origin: str
    formula: Formula
    constants: Mapping[str, Any]  # numbers, and vectors of a table
    load_factor: float = 1.0
    penetration_factor: float = 1.0

    @property
    def name(self) -> str:
        """The name of the exported function."""
        # Of 63 letters at most in Fortran, with what follows it.
        word = identifier(f"cylcontact {self.law.name}")[:43]
        return f"{word}_{self.contact}" if self.contact else word

    @property
    def arguments(self) -> tuple[str, ...]:
        """The arguments of the function, in order."""
        asked = self.formula.of_pair
        return ("penetration", *(n for n in OF_PAIR if n in ("E_star", "dR") or n in asked))

    @property
    def domain(self) -> str:
        """The condition on the arguments, in Python's syntax."""
        of_pair = (_DOMAINS.get(name, f"{name} > 0") for name in self.arguments[1:])
        return " and ".join(["penetration >= 0", *of_pair])

    def comment(self) -> list[str]:
        """Return the comment at the top of a file."""
        contact = f"{self.contact} contact" if self.contact else "internal or external contact"
        origin = f"exported by cylcontact {version('cylcontact')}"
        listed = self.constants if self.origin else {}
        if listed:
            origin += f"; constants: {comment(self.origin)}"
        factors = {"load": self.load_factor, "penetration": self.penetration_factor}
        scaled = [f"{name} times {x!r}" for name, x in factors.items() if x != 1]
        rows = {name: MEANINGS[name] for name in self.arguments}
        return [
            self.name,
            "",
            f"The contact law '{comment(self.law.name)}' for parallel cylinders, {contact}.",
            "",
            *paragraph("Formula", _line(self.formula.equation)),
            *paragraph("Remark", _line(self.formula.remark)),
            *paragraph("Scaled", ", ".join(scaled)),
            *paragraph("Provenance", origin),
            *(f"  {plain_ascii(name)} = {value!r}" for name, value in listed.items()),
            "",
            "Arguments:",
            *(f"  {name:<12} {unit:<4} {meaning}" for name, (unit, meaning) in rows.items()),
            "",
            "Load in N/mm and stiffness in N/mm^2, per unit of axial length: 0 at a negative",
            f"penetration, NaN outside the law's domain, {self.domain}.",
        ]


def source(law: ExportedLaw, target: str) -> str:
    """Return a law as the text of a file in a language."""
    program = Program(instead=dict(OF_NUMBERS))
    frame = _Frame(law, program, LANGUAGES[target](program))
    language = frame.language
    domain = program.expression(law.domain, dict.fromkeys(law.arguments, float))
    parts = {
        **frame.parts(), **language.parts(), "name": law.name,
        "about": "\n".join(f"{language.comment} {line}".rstrip() for line in law.comment()),
        "arguments": ", ".join(law.arguments), "heads": _heads(law),
        "domain": language.text(domain),
        "total": " + ".join(law.arguments),
        "rows": "\n".join(f"{n} = reshape({n} + zero, 1, []);" for n in law.arguments),
        "hidden": "\n".join(f"{n}(outside) = 1;" for n in law.arguments),
    }  # fmt: skip
    return language.file(parts, f"law{language.suffix}")


def header(law: ExportedLaw) -> str:
    """Return the C header of a law, which C++ takes too."""
    parts = {"name": law.name, "capitals": law.name.upper(), "heads": _heads(law)}
    return C(Program()).file(parts, "law.h")


def _heads(law: ExportedLaw) -> str:
    """Return the arguments of a law in C."""
    return ", ".join(f"double {name}" for name in law.arguments)


class _Frame:
    """What the functions of load and stiffness compute in the frame of a template."""

    def __init__(self, law: ExportedLaw, program: Program, language: C) -> None:
        """Read the functions of a law into a program."""
        formula = law.formula
        asked = {key: getattr(formula, key) for key in ("numbers", "load", "stiffness", "end")}
        self.read = {key: program.read(f) for key, f in asked.items() if f is not None}
        self.law, self.program, self.language = law, program, language
        self.tables = {f"table_{n}": v for n, v in law.constants.items() if np.ndim(v)}
        program.numbers |= self.tables
        self.result = self.read["numbers"].returns if "numbers" in self.read else None
        names = {*law.arguments, *law.constants}
        self.local = dict.fromkeys(names, float) | {NUMBERS: self.result}

    def parts(self) -> dict[str, str]:
        """Return the expressions and statements of the template, by name."""
        law, formula, language = self.law, self.law.formula, self.language
        depth, of_depth = "penetration", law.penetration_factor
        if of_depth != 1:
            depth = f"penetration / {of_depth!r}"
        values = {"load": self.call("load", depth)}
        if formula.stiffness is None:
            more, less = (self.call("load", f"{depth} * {by!r}") for by in (1 + STEP, 1 - STEP))
            values["stiffness"] = f"({more} - {less}) / ({depth} * {2 * STEP!r})"
        else:
            values["stiffness"] = self.call("stiffness", depth)
        factors = {"load": law.load_factor, "stiffness": law.load_factor / of_depth}
        for what, factor in factors.items():
            if factor != 1:
                values[what] = f"{factor!r} * {values[what]}"
        last = "inf" if formula.end is None else self.call("end")
        texts = values | {"inside": f"{depth} <= {last}"}
        read = {name: self.expression(text) for name, text in texts.items()}
        parts = {name: language.text(node) for name, node in read.items()}
        numbers, declared = "", ""
        if self.result is not None:
            declared = language.declared(NUMBERS, self.result) + language.end
            read["numbers"] = self.expression(self.call("numbers"))
            numbers = language.assigned(NUMBERS, read["numbers"]) + language.end
        for what in ("load", "stiffness"):
            nodes = [read[key] for key in (what, "inside", "numbers") if key in read]
            used = {name for node in nodes for name in names_in(node)}
            constants = {n: v for n, v in law.constants.items() if n in used}
            lines = [language.local_constant(*each) for each in constants.items()]
            parts[f"constants_of_{what}"] = "\n".join(lines)
        return {**parts, "numbers_at": numbers, "declared": declared}

    def call(self, what: str, *first: str) -> str:
        """Return the call of a function of the law in Python's syntax."""
        f, formula = self.read[what], self.law.formula
        wanted = {"numbers": tuple(formula.asked), "end": formula.taken_by_end}
        names = wanted.get(what, formula.taken)
        given = [f"table_{n}" if f"table_{n}" in self.tables else n for n in names]
        if self.result is not None and what != "numbers":
            given = [f"{NUMBERS}.{name}" for name in names]
        return f"{f.name}({', '.join([*first, *given])})"

    def expression(self, text: str) -> Any:
        """Return an expression in Python's syntax, read."""
        functions = {f.name: f for f in self.read.values()}
        return self.program.expression(text, self.local, functions | self.tables)


def exported(
    law: ContactLaw, contact: Contact | None, origin: str = "", pair: CylinderPair | None = None
) -> ExportedLaw:
    """Return a law for export; conformal contact is of the materials and the housing of a pair.

    Raises `InputError` if it has no formula, is for the other contact, or differs between the
    contacts and none is given.
    """
    base, load_factor, penetration_factor = law, 1.0, 1.0
    while isinstance(base, ScaledLaw):
        load_factor *= base.load_factor
        penetration_factor *= base.penetration_factor
        base = base.base
    contacts: tuple[Contact, ...] = getattr(base, "contacts", ())
    if contact not in (None, *contacts):
        rule, remedy = f"the law '{law.name}' is for a pin in a hole", "or export johnson"
        raise InputError("export", "--contact", contact, rule, f"give --contact internal, {remedy}")
    factors = load_factor, penetration_factor
    if isinstance(base, Conformal):
        table = table_of(base, pair, fitted=bool(origin) or law is not base)
        return ExportedLaw(law, "internal", "", *table, *factors)
    if not has_formula(base):
        raise InputError(
            "export", "law", getattr(law, "name", law), "has no formula to write", "export explicit"
        )
    if isinstance(base, Johnson) and base.datum is not None:
        rule, remedy = "is for a plane, which has no dR to give to a function", "leave it out"
        raise InputError("export", "datum", base.datum, rule, remedy)
    fitted_for = getattr(getattr(base, "coefficients", None), "contact", None)
    if fitted_for is not None:
        rule = f"the coefficients are for {fitted_for} contact"
        require(contact in (None, fitted_for), "export", "--contact", contact, rule, "leave it out")
        contacts = (fitted_for,)
    if len(contacts) == 1:
        contact = contacts[0]
    of_contact = [(base.formula_for(each), base.constants_for(each)) for each in contacts]
    if contact is None and of_contact[0] != of_contact[-1]:
        rule = f"is missing, and the {law.name} law has other coefficients for each"
        remedy = "give --contact internal or --contact external"
        raise InputError("export", "--contact", None, rule, remedy)
    formula, constants = of_contact[contacts.index(contact) if contact else 0]
    is_usual = law.name in LAWS and law == LAWS[law.name]()
    if base.note:
        note = base.note[0].upper() + base.note[1:]
        formula = replace(formula, remark=f"{formula.remark} {note}.")
    origin = origin or (base.origin if is_usual else "given by the caller")
    return ExportedLaw(law, contact, origin, formula, constants, *factors)


def _line(text: str) -> str:
    """Return a formula or a remark for a comment of any language."""
    return re.sub(r"[^ -\[\]-~]|\?", "_", " ".join(text.split()))


def paragraph(title: str, text: str) -> list[str]:
    """Return `title: text`, wrapped; nothing for no text."""
    whole = f"{title}: {text}.".replace("..", ".")
    lines = wrap(whole, WIDTH - 4, subsequent_indent="  ", break_on_hyphens=False)
    return lines if text else []


def require_contact_law(law: ContactLaw, contact: Contact | None) -> None:
    """Refuse a law whose load is negative or decreases for some pair, or exists for none."""
    has_load = False
    for each in CONTACTS if contact is None else (contact,):
        pair, depth, loads = _loads(law, each)
        before = np.fmax.accumulate(np.nan_to_num(loads, nan=-np.inf), axis=0)
        wrong = loads < 0
        wrong[1:] |= loads[1:] < before[:-1] * (1 - _ROUNDING)
        for at in map(tuple, np.argwhere(wrong)):
            dR, E, _ = (x[at] for x in np.broadcast_arrays(pair.dR, pair.material_i.E, loads))
            rule = (
                "is no contact law with these coefficients: its load "
                f"{'is negative' if loads[at] < 0 else 'decreases'} at {depth[at]:.3g} mm "
                f"for ΔR = {dR:.3g} mm and E = {E:g} MPa"
            )
            raise InputError("export", "law", law.name, rule, "correct them, or redo the fit")
        has_load = has_load or bool(((loads > 0) & np.isfinite(loads)).any())
    if not has_load:
        rule = "has no load at any penetration with these coefficients"
        raise InputError("export", "law", law.name, rule, "correct them, or redo the fit")


def _loads(law: ContactLaw, contact: Contact) -> tuple[CylinderPair, FloatArray, FloatArray]:
    """Return pairs of many clearances and moduli, and penetrations and loads for them."""
    dR = np.geomspace(*_DR[contact], 13)[:, None]
    R_i = 20 * dR if contact == "internal" else dR / 2
    material = Material("any", np.array(_MODULI), 0.3)
    pair = CylinderPair.from_dR(contact, dR, material, length=10.0, R_i=R_i)
    with np.errstate(all="ignore"):
        loads = law.load(_DEPTHS * dR, pair)
    depth, loads = np.broadcast_arrays(_DEPTHS * dR, loads)
    return pair, depth, loads
