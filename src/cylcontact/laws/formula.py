"""Laws in a small neutral notation, from which exports are rendered and kernels compiled."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import dataclass

from cylcontact.errors import InputError
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.pair import Contact

__all__ = [
    "IN_MM",
    "MEANINGS",
    "RESULTS",
    "Formula",
    "Step",
    "expression",
    "function_name",
    "needed",
    "required_contact",
    "steps_of",
]

# The remark of a law whose coefficients have units.
IN_MM = "Holds in mm, N and MPa only: its coefficients are not dimensionless."

# The first arguments of every exported function, and units and meanings of all arguments.
_ALWAYS = ("penetration", "E_star", "dR")
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
_SIGNED = ("alpha", "beta")
RESULTS: Mapping[str, tuple[str, str]] = {
    "load": ("N/mm", "load per unit of axial length, f below"),
    "stiffness": ("N/mm^2", "d(load)/d(penetration) per unit of axial length, k below"),
}


@dataclass(frozen=True)
class Step:
    """One assignment, `name = value`.

    Attributes
    ----------
    name : str
        The name assigned; each name is assigned once.
    value : ast.expr
        An expression or a conditional expression, `a if condition else b`.
    text : str
        The assignment as written.
    """

    name: str
    value: ast.expr
    text: str


@dataclass(frozen=True)
class Formula:
    """Load and stiffness per unit length as a sequence of assignments.

    Attributes
    ----------
    name : str
        The name of the exported function.
    law : ContactLaw
        The law.
    contact : {"internal", "external"} or None
        The contact of the coefficients; None if it makes no difference.
    equation : str
        The law on one line, for readers.
    text : str
        Assignments in Python's syntax, one a line, f and k among them. Names are the
        arguments, `constants`, pi and nan; functions are log, log1p, exp, sqrt, sin,
        atan and max. Names must not differ in case alone, because Fortran ignores case.
    coefficients : mapping
        The coefficients of the law, for readers.
    constants : mapping
        The numbers used in `text`, by name.
    extra : tuple of str
        Arguments after penetration, E_star and dR.
    conditions : tuple of str
        Conditions on the arguments, in addition to being positive.
    domain : str
        Further conditions of the domain, in words.
    remark : str
        A remark for users of the law.
    origin : str
        Origin of the coefficients.
    """

    name: str
    law: ContactLaw
    contact: Contact | None
    equation: str
    text: str
    coefficients: Mapping[str, float]
    constants: Mapping[str, float]
    extra: tuple[str, ...] = ()
    conditions: tuple[str, ...] = ()
    domain: str = ""
    remark: str = ""
    origin: str = ""

    @property
    def arguments(self) -> tuple[str, ...]:
        """The function's arguments, in order."""
        return _ALWAYS + self.extra

    @property
    def steps(self) -> tuple[Step, ...]:
        """The assignments of `text` that f and k need."""
        return needed(self.text, "f", "k")

    @property
    def requirements(self) -> tuple[str, ...]:
        """Conditions on the arguments that hold inside the domain."""
        lengths = (name for name in self.arguments[1:] if name not in _SIGNED)
        positive = (f"{name} > 0" for name in lengths)
        return ("penetration >= 0", *positive, *self.conditions)


def expression(text: str) -> ast.expr:
    """Parse one expression of the neutral notation.

    Examples
    --------
    >>> ast.unparse(expression("a*dR + b"))
    'a * dR + b'
    """
    return ast.parse(text, mode="eval").body


def steps_of(text: str) -> tuple[Step, ...]:
    r"""Parse assignments, one a line.

    Examples
    --------
    >>> [step.name for step in steps_of("d = penetration / dR\nf = E_star * d")]
    ['d', 'f']
    """
    return tuple(_step(line) for line in text.splitlines() if line.strip())


def needed(text: str, *results: str) -> tuple[Step, ...]:
    r"""Return the steps that some results need.

    Examples
    --------
    >>> [step.name for step in needed("a = dR\nb = 2*a\nk = 3*a\nf = 5*b", "f")]
    ['a', 'b', 'f']
    """
    names, steps = set(results), list[Step]()
    for step in reversed(steps_of(text)):
        if step.name in names:
            steps.insert(0, step)
            names |= {node.id for node in ast.walk(step.value) if isinstance(node, ast.Name)}
    return tuple(steps)


def _step(line: str) -> Step:
    """Parse `name = value`."""
    name, _, value = line.partition(" = ")
    if not (name.strip().isidentifier() and value):
        raise ValueError(f"a law's step must be an assignment, name = value, and is {line!r}")
    return Step(name.strip(), expression(value), line.strip())


def function_name(law: str, contact: Contact | None = None) -> str:
    """Return the name of an exported function.

    Examples
    --------
    >>> function_name("esdu-78035"), function_name("enhanced", "internal")
    ('cylcontact_esdu_78035', 'cylcontact_enhanced_internal')
    """
    return "_".join(["cylcontact", law.replace("-", "_"), *([contact] if contact else [])])


def required_contact(contact: Contact | None, law: str) -> Contact:
    """Return the contact; raise `InputError` if it is None."""
    if contact is None:
        raise InputError(
            "export",
            "--contact",
            None,
            f"is missing, and the {law} law has other coefficients for each",
            "give --contact internal or --contact external",
        )
    return contact
