"""The law to use for each contact, by its error on the samples of the main fits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from cylcontact.errors import InputError
from cylcontact.pair import CONTACTS, Contact
from cylcontact.reports.bench import Bench
from cylcontact.reports.laws_to_use import error_text, laws_to_use

__all__ = ["Answer", "Row", "answers"]

BODIES: dict[Contact, str] = {"internal": "A pin in a hole", "external": "Two rollers"}
# The references of `laws_to_use`, the better one first.
REFERENCES = {"conformal": "conformal contact", "johnson": "Johnson's law"}
TEXTS = ("law", "formula", "constants", "units", "defined")


@dataclass(frozen=True)
class Row:
    """A law in the comparison: its errors and the time of a load, that of a power law being 1."""

    law: str
    rms: str
    largest: str
    time: str


@dataclass(frozen=True)
class Answer:
    """The law to use for one contact.

    Attributes
    ----------
    contact, bodies : str
        The contact, and what is in it.
    law, formula, constants, units, defined : str
        The law of the least RMS error, its load, its constants and their units, and where it is
        defined.
    reference : str
        What the errors of the penetration are measured against.
    best : Row or None
        Its row of the comparison; None where there is a problem.
    rows : tuple of Row
        All laws of the comparison.
    problem : str
        The reason why there is no comparison.
    """

    contact: str
    bodies: str
    law: str = ""
    formula: str = ""
    constants: str = ""
    units: str = ""
    defined: str = ""
    reference: str = ""
    best: Row | None = None
    rows: tuple[Row, ...] = ()
    problem: str = ""


def answers(bench: Bench) -> Iterator[Answer]:
    """Yield the law to use for each contact, or the reason why there is no comparison."""
    for contact in CONTACTS:
        try:
            yield _answer(contact, bench)
        except InputError as error:
            yield Answer(contact, BODIES[contact], problem=str(error))


def _answer(contact: Contact, bench: Bench) -> Answer:
    """Return the law to use for one contact."""
    table = laws_to_use(contact, bench)
    reference = next(name for name in REFERENCES if f"rms_{name}" in table)
    rows = tuple(
        Row(
            each["law"],
            error_text(each[f"rms_{reference}"], ".4f"),
            error_text(each[f"max_{reference}_percent"], ".3g"),
            f"{each['relative_time']:.1f}",
        )
        for each in table.to_dict("records")
    )
    at = int(table[f"rms_{reference}"].argmin())
    texts = {name: str(table.loc[at, name]) for name in TEXTS}
    return Answer(
        contact, BODIES[contact], **texts, reference=REFERENCES[reference], best=rows[at], rows=rows
    )
