"""A law as it is exported: steps and constants by names that every language takes."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version
from textwrap import wrap

import numpy as np

from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import CONTACTS, Contact, CylinderPair
from cylcontact.export.language import LANGUAGES, WIDTH, filled_template
from cylcontact.laws import LAWS, Johnson
from cylcontact.laws.adapters import ScaledLaw
from cylcontact.laws.formula import (
    FUNCTIONS,
    OF_PAIR,
    Formula,
    Step,
    assigned_in,
    depending,
    flat,
    names_in,
    needed,
    renamed,
    steps_of,
)
from cylcontact.laws.law import ContactLaw, Law, has_formula
from cylcontact.support.arrays import FloatArray, require
from cylcontact.support.errors import InputError
from cylcontact.support.plain_text import RESERVED, comment, identifier

# Unit and meaning of the arguments and results of exported functions.
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
RESULTS: Mapping[str, tuple[str, str]] = {
    "load": ("N/mm", "load per unit of axial length, f below"),
    "stiffness": ("N/mm^2", "d(load)/d(penetration) per unit of axial length, k below"),
}
# What pairs can have; other arguments are positive.
_OF_TWO_MATERIALS = {"alpha": "alpha * alpha < 1", "beta": "beta * beta < 0.251"}
# Clearances and sums of radii in mm, moduli in MPa and penetrations relative to ΔR that are tried.
_DR: dict[Contact, tuple[float, float]] = {"internal": (0.005, 9.0), "external": (5.0, 500.0)}
_MODULI = (2e3, 70e3, 207e3, 600e3)
_STEEL = 207e3
_DEPTHS = np.geomspace(1e-6, 1.0, 61)[:, None, None]
# Rounding may take this part from a load that levels off.
_ROUNDING = 1e-9
# Names that a language or a frame has for something else.
_TAKEN = (
    "load", "stiffness", "law", "wp", "outside", "inside", "apart", "still", "power", "choose",
    "numbers", "atanh", "range", "jnp", "jax", "math", "abs", "isnan", "result", "evaluate",
    "program", "module", "subroutine", "call", "implicit", "none",
)  # fmt: skip


@dataclass(frozen=True)
class ExportedLaw:
    """A law for a contact, or for both, as steps; scaled by factors other than 1."""

    law: ContactLaw
    contact: Contact | None
    origin: str
    formula: Formula
    coefficients: Mapping[str, float]
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
        own = self.formula.arguments
        return ("penetration", *(n for n in OF_PAIR if n in ("E_star", "dR") or n in own))

    @property
    def conditions(self) -> tuple[str, ...]:
        """Conditions on the arguments, in Python's syntax."""
        of_pair = (_OF_TWO_MATERIALS.get(name, f"{name} > 0") for name in self.arguments[1:])
        return ("penetration >= 0", *of_pair)

    @cached_property
    def constants(self) -> dict[str, float]:
        """The numbers of the steps by name, pi among them."""
        used = set().union(*(names_in(s.value) for s in flat(self.steps)), self.ends.split())
        own = {self._names[name]: x for name, x in {**self.coefficients, **self._factors}.items()}
        return {name: value for name, value in {"pi": math.pi, **own}.items() if name in used}

    @property
    def _factors(self) -> dict[str, float]:
        return {"load_factor": self.load_factor, "penetration_factor": self.penetration_factor}

    @property
    def ends(self) -> str:
        """The condition on what the steps of the pair give; empty for a law without an end."""
        if self.formula.end is None:
            return ""
        factor = f" / {self._names['penetration_factor']}" if self.penetration_factor != 1 else ""
        return f"penetration{factor} <= last"

    @property
    def steps(self) -> tuple[Step, ...]:
        """All steps, to f and k."""
        return self.at_pair + self.at_depth

    @cached_property
    def at_pair(self) -> tuple[Step, ...]:
        """The steps before the penetration."""
        return tuple(renamed(s, self._names) for s in self._chosen if s not in self._moving)

    @cached_property
    def at_depth(self) -> tuple[Step, ...]:
        """The steps from the penetration to f and k."""
        names = self._names
        steps = tuple(renamed(s, names) for s in self._moving)
        factor, by = names["load_factor"], ""
        if self.penetration_factor != 1:
            by = f" / {names['penetration_factor']}"
            steps = steps_of(f"{names['penetration']} = penetration{by}") + steps
        if names["f"] != "f":
            f, k = steps_of(f"f = {factor} * {names['f']}\nk = {factor}{by} * {names['k']}")
            known = max(n for n, s in enumerate(steps, 1) if names["f"] in assigned_in([s]))
            steps = (*steps[:known], f, *steps[known:], k)
        return steps

    @cached_property
    def _chosen(self) -> tuple[Step, ...]:
        """The steps that f, k and the end need."""
        results = ("f", "k", *(("last",) if self.formula.end else ()))
        return needed(self.formula.written_out, *results)

    @cached_property
    def _moving(self) -> tuple[Step, ...]:
        """Those of them that depend on the penetration."""
        return depending(self._chosen)

    @cached_property
    def _names(self) -> dict[str, str]:
        """The names in the export, by those of the formula."""
        wanted = {"penetration": "depth"} if self.penetration_factor != 1 else {}
        if wanted or self.load_factor != 1:
            wanted |= {"f": "alone", "k": "slope"}
        return safe_names(self._chosen, [*self.coefficients, *self._factors], wanted)

    def comment(self, mark: str) -> str:
        """Return the comment at the top of a file, each line behind a `mark`."""
        contact = f"{self.contact} contact" if self.contact else "internal or external contact"
        origin = f"exported by cylcontact {version('cylcontact')}"
        if self.coefficients:
            origin += f"; coefficients: {comment(self.origin)}"
        listed = {self._names[name]: value for name, value in self.coefficients.items()}
        listed |= {name: value for name, value in self._factors.items() if value != 1}
        lines = [
            self.name,
            "",
            f"The contact law '{comment(self.law.name)}' for parallel cylinders, {contact}.",
            "",
            *paragraph("Formula", _plain(self.formula.equation)),
            *paragraph("Remark", _plain(self.formula.remark)),
            *paragraph("Provenance", origin),
            *(f"  {name} = {value!r}" for name, value in listed.items()),
            "",
            "Arguments, in this order:",
            *table({name: MEANINGS[name] for name in self.arguments}),
            "Results:",
            *table(RESULTS),
            "",
            *paragraph("Domain", ", ".join(filter(None, (*self.conditions, self.ends)))),
            "Outside it both are NaN; at a negative penetration both are 0.",
        ]
        return "\n".join(f"{mark} {line}".rstrip() for line in lines)


def source(law: ExportedLaw, target: str) -> str:
    """Return a law as the text of a file in a language."""
    language, names, in_cpp = LANGUAGES[target](), law.arguments, target == "cpp"
    domain = language.formula(" and ".join(law.conditions))
    constants = {name: x for name, x in law.constants.items() if name not in language.names}
    check = {"fortran": f"if (.not. ({domain})) return", "python": f"if not ({domain}):"}
    parts = {
        "comment": law.comment(language.comment),
        "name": law.name,
        # C++ has its functions in a namespace, in a header.
        "guard": law.name.upper() if in_cpp else "",
        "inline": "inline " if in_cpp else "",
        "both": "evaluate" if in_cpp else law.name,
        "prefix": "" if in_cpp else f"{law.name}_",
        "arguments": ", ".join(names),
        "parameters": ", ".join(f"double {name}" for name in names),
        "pair": ", ".join(names[1:]),
        "total": " + ".join(names),
        "expanded": "\n".join(f"{name} = {name} + numbers;" for name in names),
        "hidden": "\n".join(f"{name}(outside) = NaN;" for name in names),
        "domain": domain,
        "check": language.wrapped(check.get(target, "")),
        "ends": language.formula(law.ends) if law.ends else "",
        "least": "jnp.minimum(dR, last)" if law.ends else "dR",
        "constants": language.constants(constants),
        "variables": language.declared(law.steps),
        "at_pair": language.statements(law.at_pair),
        "at_depth": language.statements(law.at_depth),
    }
    parts["helpers"] = language.helpers_of(parts["at_pair"] + parts["at_depth"])
    return filled_template(f"law.{'c' if in_cpp else target}", parts)


def exported(law: ContactLaw, contact: Contact | None, origin: str = "") -> ExportedLaw:
    """Return a law for export.

    Raises `InputError` if it has no formula, is for the other contact, or differs between the
    contacts and none is given.
    """
    base, load_factor, penetration_factor = law, 1.0, 1.0
    while isinstance(base, ScaledLaw):
        load_factor *= base.load_factor
        penetration_factor *= base.penetration_factor
        base = base.base
    if not has_formula(base):
        raise InputError(
            "export", "law", getattr(law, "name", law),
            "has no closed form to write in another language",
            "export explicit, which follows conformal contact",
        )  # fmt: skip
    contacts = base.contacts
    if contact not in (None, *contacts):
        rule, remedy = f"the law '{law.name}' is for a pin in a hole", "or export johnson"
        raise InputError("export", "--contact", contact, rule, f"give --contact internal, {remedy}")
    if isinstance(base, Johnson) and base.datum is not None:
        rule, remedy = "is for a plane, which has no dR to give to a function", "leave it out"
        raise InputError("export", "datum", base.datum, rule, remedy)
    own = getattr(getattr(base, "coefficients", None), "contact", None)
    if own is not None:
        rule = f"the coefficients are for {own} contact"
        require(contact in (None, own), "export", "--contact", contact, rule, "leave it out")
        contacts = (own,)
    if len(contacts) == 1:
        contact = contacts[0]
    of_contact = [(base.formula_for(each), base.constants_for(each)) for each in contacts]
    if contact is None and of_contact[0] != of_contact[-1]:
        rule = f"is missing, and the {law.name} law has other coefficients for each"
        remedy = "give --contact internal or --contact external"
        raise InputError("export", "--contact", None, rule, remedy)
    formula, numbers = of_contact[contacts.index(contact) if contact else 0]
    factors = load_factor, penetration_factor
    return ExportedLaw(law, contact, origin or _origin(law), formula, numbers, *factors)


def _origin(law: ContactLaw) -> str:
    """Return where the coefficients of a law come from, in words."""
    if not isinstance(law, Law) or law.name not in LAWS or law != LAWS[law.name]():
        return "given by the caller"
    if not law.published:
        return "calibrated by this package"
    return f"published, {law._source}" if law._source else "published"


def safe_names(
    steps: Iterable[Step], others: Iterable[str], wanted: Mapping[str, str] | None = None
) -> dict[str, str]:
    """Return the names of an export by those of steps and others: words of every language.

    No two differ in case alone, because Fortran ignores it. Arguments and results stay as they are,
    unless other names are `wanted`.
    """
    steps, fixed = tuple(steps), (*OF_PAIR, "penetration", "f", "k", "last", "pi", "nan", "inf")
    taken = {name.lower() for name in (*fixed, *FUNCTIONS, *_TAKEN, *RESERVED)}
    names = {name: name for name in fixed}
    loops = (step.name for step in flat(steps) if step.body)
    words = {name: name for name in (*others, *assigned_in(steps), *loops) if name not in names}
    for name, text in (words | dict(wanted or {})).items():
        word = identifier(text) or ("x" if text.strip("_") else "turn")
        word = first = word if word[0].isalpha() else f"x{word}"
        number = 1
        while word.lower() in taken:
            number += 1
            word = f"{first}_{number}"
        taken.add(word.lower())
        names[name] = word
    return names


def _plain(text: str) -> str:
    """Return a formula or a remark for a comment of any language."""
    return re.sub(r"[^ -\[\]-~]|\?", "_", " ".join(text.split()))


def paragraph(title: str, text: str) -> list[str]:
    """Return `title: text`, wrapped; nothing for no text."""
    whole = f"{title}: {text}.".replace("..", ".")
    lines = wrap(whole, WIDTH, subsequent_indent="  ", break_on_hyphens=False)
    return lines if text else []


def table(rows: Mapping[str, tuple[str, str]]) -> list[str]:
    """Return a line for each name, with unit and meaning."""
    return [f"  {name:<12} {unit:<7} {meaning}" for name, (unit, meaning) in rows.items()]


def require_contact_law(law: ContactLaw, contact: Contact | None) -> None:
    """Refuse a law whose load is negative or decreases for some pair, or exists for none."""
    has_load = False
    for each in CONTACTS if contact is None else (contact,):
        try:
            pair, depth, loads = _loads(law, each, _MODULI)
        except InputError:  # some laws are for steel alone
            pair, depth, loads = _loads(law, each, (_STEEL,))
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


def _loads(
    law: ContactLaw, contact: Contact, moduli: tuple[float, ...]
) -> tuple[CylinderPair, FloatArray, FloatArray]:
    """Return pairs of many clearances and moduli, and penetrations and loads for them."""
    dR = np.geomspace(*_DR[contact], 13)[:, None]
    R_i = 20 * dR if contact == "internal" else dR / 2
    material = Material("any", np.array(moduli), 0.3)
    pair = CylinderPair.from_dR(contact, dR, material, length=10.0, R_i=R_i)
    with np.errstate(all="ignore"):
        loads = law.load(_DEPTHS * dR, pair)
    depth, loads = np.broadcast_arrays(_DEPTHS * dR, loads)
    return pair, depth, loads
