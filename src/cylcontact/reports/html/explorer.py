"""Data of the interactive page: exported laws, materials, ranges."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from cylcontact.errors import InputError
from cylcontact.export import EXPORTABLE, export, export_named
from cylcontact.fitting.results import FitResult
from cylcontact.laws import LAWS, Johnson, Parametric
from cylcontact.laws.enhanced import PUBLISHED_DR
from cylcontact.materials import MaterialRow
from cylcontact.pair import CONTACTS
from cylcontact.plain_text import brief
from cylcontact.reports.laws_bounds import BOUNDED, TRUTH

__all__ = ["explorer_data"]

# The parts of an exported law that the page computes it from.
NEEDED = ("constants", "steps", "conditions")
INITIAL_LAWS = ("johnson", "persson", "enhanced", "explicit", "fit:practical", "fit:external")
# For each slider: its ends and its initial value.
CONTROLS: Mapping[str, Mapping[str, Any]] = {
    "internal": {"dR": (0.001, 10.0, 0.05), "load": (1.0, 10000.0, 100.0)},
    "external": {"dR": (5.0, 500.0, 20.0), "load": (1.0, 10000.0, 100.0)},
}


def explorer_data(
    materials: Mapping[str, MaterialRow], results: Mapping[Path, FitResult]
) -> dict[str, Any]:
    """Return the page's data, ready for JSON.

    Parameters
    ----------
    materials : mapping of str to MaterialRow
        The table of materials.
    results : mapping of path to FitResult
        Fits by their files; their laws are added to the package's.

    Returns
    -------
    dict

    Examples
    --------
    >>> data = explorer_data({}, {})
    >>> [law["id"] for law in data["laws"] if law["contact"] == "external"][:2]
    ['johnson', 'roark-young']
    """
    return {
        "controls": CONTROLS,
        "materials": [_material(row) for row in materials.values()],
        "laws": [*_package_laws(), *_fitted_laws(results)],
        "truth": {contact: law.name for contact, law in TRUTH.items()}
        | {"unlike": Parametric.name},
        "explicit_range": {contact: list(BOUNDED[contact]) for contact in CONTACTS},
        "trained_dR": {contact: list(PUBLISHED_DR[contact]) for contact in CONTACTS},
        "initial_laws": INITIAL_LAWS,
    }


def _material(row: MaterialRow) -> dict[str, Any]:
    """Return a material with its provenance; E and yield stress in MPa."""
    material = row.material
    return {
        "name": brief(material.name),
        "E": float(material.E),
        "nu": float(material.nu),
        "yield_stress": material.yield_stress,
        "provenance": row.provenance,
    }


def _package_laws() -> Iterator[dict[str, Any]]:
    """Yield the package's laws for each of their contacts."""
    for name in LAWS:
        for contact in CONTACTS:
            if name == "persson":
                if contact == "internal":
                    yield _law(name, "Persson, conformal contact", contact, None)
            elif name in EXPORTABLE:
                try:
                    text = export(LAWS[name](), contact, "json")
                except InputError:  # a law for the other contact only
                    continue
                label = f"{name}, published" if name == "enhanced" else name
                yield _law(name, label, contact, text)


def _fitted_laws(results: Mapping[Path, FitResult]) -> Iterator[dict[str, Any]]:
    """Yield the laws fitted by campaigns, except those that only Python can compute."""
    for path, result in results.items():
        try:
            text = export_named(str(path), None, "json")
        except InputError:
            continue
        label = brief(f"{result.law}, fit {result.name!r}")
        yield _law(f"fit:{path.stem}", label, result.contact, text)


def _law(name: str, label: str, contact: str, exported: str | bytes | None) -> dict[str, Any]:
    """Return one law as data."""
    document = json.loads(exported) if exported else None
    return {
        "id": name,
        "label": label,
        "contact": contact,
        "remark": document["remark"] if document else "Exact for like bodies, without friction.",
        "formula": document["formula"] if document else "",
        "document": {key: document[key] for key in NEEDED} if document else None,
        # Its reach depends on the two materials, which the exported formula does not know.
        "johnson": document is not None and document["law"] == Johnson.name,
    }
