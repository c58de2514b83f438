"""Finite-element set-ups as TOML files, with the provenance of every number."""

from __future__ import annotations

from dataclasses import dataclass, fields
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import Field, model_validator

from cylcontact.datasets.finite_element.setup import (
    FEWEST_CELLS,
    Clamp,
    LoadOn,
    Plane,
    Setup,
    require_room,
)
from cylcontact.errors import InputError
from cylcontact.modulus import Modulus
from cylcontact.provenance import spec_hash
from cylcontact.spec import Spec, broken, parse_spec, read_toml

__all__ = ["Origin", "Study", "StudySpec", "read_study", "study_from"]

Origin = Literal["paper", "derived", "assumed"]
_LENGTH_REMEDY = "a number in mm above 0"


class StudySpec(Spec):
    """A set-up file: one set-up, its clearances and loads, and variants of it."""

    hole_radius: float = Field(gt=0, description="the radius of the hole in mm")
    outer_ratio: float = Field(
        gt=1, le=1000, description="the plate's outer radius over the hole's, above 1"
    )
    E: Modulus = Field(gt=0, description='Young\'s modulus in GPa, or with its unit, "207 GPa"')
    nu: float = Field(ge=0, le=0.5, description="Poisson's ratio, from 0 to 0.5")
    pin_E: Modulus | None = Field(None, gt=0, description="the pin's Young's modulus, as E")
    pin_nu: float | None = Field(
        None, ge=0, le=0.5, description="the pin's Poisson's ratio, from 0 to 0.5"
    )
    plane: Plane = Field("strain", description='"strain" or "stress"')
    load_on: LoadOn = Field("pin", description='"pin", "disc" or "centre"')
    disc_ratio: float = Field(
        0.25, gt=0.1, le=1, description="the loaded disc's radius over the pin's, above 0.1"
    )
    clamp: Clamp = Field("upper half", description='"upper half" or "whole"')
    cells: int = Field(
        16,
        ge=FEWEST_CELLS,
        le=200,
        description=f"cells over the contact's half-width, an integer from {FEWEST_CELLS} to 200",
    )
    size: float | None = Field(None, gt=0, description=f"the smallest cells, {_LENGTH_REMEDY}")
    contact_size: float | None = Field(
        None, gt=0, description=f"the largest cells in the contact, {_LENGTH_REMEDY}"
    )
    dR: tuple[float, ...] = Field(strict=False, description="a list of clearances in mm")
    load: tuple[float, ...] = Field(strict=False, description="a list of loads in N/mm")
    origin: dict[str, Origin] = Field(
        description='a table [origin] that calls each key "paper", "derived" or "assumed"'
    )
    variants: tuple[dict[str, Any], ...] = Field(
        (), strict=False, description="tables [[variants]], each with name and the changed keys"
    )

    @model_validator(mode="after")
    def _check(self) -> StudySpec:
        for key in ("dR", "load"):
            values = getattr(self, key)
            if not values or min(values) <= 0 or any(b <= a for a, b in pairwise(values)):
                raise broken(
                    key, list(values), "must be positive and increasing", "sort it, drop repeats"
                )
        given = self.model_fields_set - {"origin", "variants"}
        for key in sorted(given ^ self.origin.keys()):
            rule = "is required" if key in given else "is not a key of this file"
            raise broken(f"origin.{key}", None, rule, "mark each key as paper, derived or assumed")
        try:
            self.setup()
        except InputError as error:
            raise broken(error.key, error.value, error.rule, error.remedy) from None
        return self

    def setup(self) -> Setup:
        """Return the set-up, without its variants."""
        values = {field.name: getattr(self, field.name) for field in fields(Setup)}
        pin_E = None if self.pin_E is None else f"{self.pin_E!r} GPa"
        return Setup(**{**values, "E": f"{self.E!r} GPa", "pin_E": pin_E})


@dataclass(frozen=True)
class Study:
    """A set-up with its variants, clearances and loads.

    Attributes
    ----------
    name : str
        The file's name without suffix.
    setups : dict
        Set-ups by the name of the variant; the set-up itself is "base".
    dR, load : tuple of float
        Clearances in mm and loads in N/mm.
    origin : dict
        "paper", "derived" or "assumed" for each key of the file.
    key : str
        A hash of the file's contents.
    source : str
        Its name in errors.
    """

    name: str
    setups: dict[str, Setup]
    dR: tuple[float, ...]
    load: tuple[float, ...]
    origin: dict[str, Origin]
    key: str
    source: str

    @property
    def loads(self) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        """The loads as an array."""
        return np.array(self.load)


def read_study(path: Path | str) -> Study:
    """Read a set-up file.

    Parameters
    ----------
    path : path
        A TOML file: hole_radius (mm), outer_ratio, E (GPa), nu, plane, load_on, clamp, the mesh's
        cells or size, dR (mm), load (N/mm), a table origin, and tables variants; pin_E (GPa) and
        pin_nu for a pin of another material.

    Returns
    -------
    Study

    Raises
    ------
    InputError
        If the file is not a set-up; the message has key, value, rule and remedy.
    """
    return study_from(read_toml(path), Path(path).stem, str(path))


def study_from(data: dict[str, Any], name: str, source: str) -> Study:
    """Return the study described by the contents of a set-up file."""
    spec = parse_spec(StudySpec, data, source)
    setups = {"base": spec.setup()}
    for number, variant in enumerate(spec.variants):
        label, changed = _variant(data, variant, f"{source}, variants.{number}")
        if label in setups:
            raise InputError(source, f"variants.{number}.name", label, "is used twice", "rename it")
        setups[label] = changed
    for setup in setups.values():
        for dR in spec.dR:
            try:
                require_room(setup, dR)
            except InputError as error:
                raise InputError(source, error.key, dR, error.rule, error.remedy) from None
    return Study(name, setups, spec.dR, spec.load, dict(spec.origin), spec_hash(data), source)


def _variant(data: dict[str, Any], variant: dict[str, Any], source: str) -> tuple[str, Setup]:
    """Return a variant's name and set-up."""
    changes = dict(variant)
    label = changes.pop("name", None)
    if not isinstance(label, str) or not label:
        raise InputError(source, "name", label, "is required", "give the variant a name")
    if not label.isprintable() or set(label) & set(',"#') or label[0] in "=+-@":
        rule = "must not contain commas, quotes or #, or begin with =, +, - or @"
        raise InputError(source, "name", label, rule, "rename it")
    for key in ("dR", "load", "origin", "variants"):
        if key in changes:
            raise InputError(source, key, changes[key], "cannot vary", "use a file of its own")
    whole = {**data, **changes, "variants": [], "origin": {**data["origin"]}}
    # The changes of a variant are our assumptions, even where the set-up has the paper's numbers.
    whole["origin"] |= dict.fromkeys(changes, "assumed")
    return label, parse_spec(StudySpec, whole, source).setup()
