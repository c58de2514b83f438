"""All laws side by side: for one pair under a load, and over the ranges that they are used in."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.laws import FITTED, LAWS, Conformal, ContactLaw, Housing, Johnson
from cylcontact.laws.housing_spec import in_housing, takes_housing
from cylcontact.support.errors import InputError
from cylcontact.support.html_repr import summary_of
from cylcontact.support.text_tables import TextTable

__all__ = ["accuracy", "accuracy_text", "comparison", "comparison_text", "listing"]

# E in MPa and ΔR in mm: metals and ceramics with practical clearances, and the paper's rollers.
RANGES: dict[Contact, tuple[tuple[float, float], tuple[float, float]]] = {
    "internal": ((69e3, 600e3), (0.0075, 2.0)),
    "external": ((20.7e3, 10000e3), (5.0, 500.0)),
}
LOADS = (10.0, 1000.0)  # N/mm
POINTS = 15  # on each axis, in even steps of the logarithm
R_I = LENGTH = 10.0  # mm, for the laws that need them


def reference(
    contact: Contact, housing: Housing | None = None, depth: float | None = None
) -> ContactLaw:
    """Return the law that others are compared with: conformal contact, or Johnson's for rollers."""
    return Conformal(housing or "johnson") if contact == "internal" else Johnson(datum=depth)


def comparison(
    pair: CylinderPair,
    load: float,
    own: ContactLaw | None = None,
    housing: Housing | None = None,
    depth: float | None = None,
) -> pd.DataFrame:
    """Evaluate every law for a pair under a load.

    Parameters
    ----------
    pair : CylinderPair
        One pair with scalar numbers.
    load : float
        Load per unit length in N/mm.
    own : ContactLaw, optional
        Your own law, in the last row.
    housing : Housing, optional
        For the laws that take one.
    depth : float, optional
        Of a plane, in mm, for the laws that take one.

    Returns
    -------
    pandas.DataFrame
        Columns law, penetration_um, off_percent (from conformal contact, for rollers from Johnson's
        law), stiffness_N_per_mm2, largest_load_N_per_mm and note. NaN where a law is undefined.

    Examples
    --------
    >>> steel = Material("steel", 207e3, 0.3)
    >>> table = comparison(CylinderPair.internal(10.0, 9.95, steel), 100.0).set_index("law")
    >>> print(f"{table.loc['johnson', 'penetration_um']:.5f} µm")
    1.55935 µm
    """
    laws: list[ContactLaw] = []
    for name, law in LAWS.items():
        housed = housing is not None and takes_housing(name)
        built = in_housing(name, housing, "laws") if housing and housed else law()
        laws.append(Johnson(datum=depth) if isinstance(built, Johnson) and depth else built)
    table = pd.DataFrame([_row(law, pair, load) for law in (*laws, *([own] if own else []))])
    exact = np.nan
    if depth is not None or not pair.is_flat:
        exact = 1e3 * float(reference(pair.contact, housing, depth).penetration(load, pair))
    table.insert(2, "off_percent", 100 * (table["penetration_um"] / exact - 1))
    return table


def _row(law: ContactLaw, pair: CylinderPair, load: float) -> dict[str, object]:
    """Return what a law says of a pair, or why it does not apply."""
    row: dict[str, object] = {"law": law.name, "penetration_um": np.nan, "note": ""}
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            depth = float(law.penetration(load, pair))
            row |= {
                "penetration_um": 1e3 * depth,
                "stiffness_N_per_mm2": float(law.stiffness(depth, pair)),
                "largest_load_N_per_mm": float(law.max_load(pair)),
            }
        row["note"] = "" if np.isfinite(depth) else "undefined at this load"
    except InputError as error:
        row["note"] = error.rule
    return row


def comparison_text(
    pair: CylinderPair,
    load: float,
    own: ContactLaw | None = None,
    housing: Housing | None = None,
    depth: float | None = None,
) -> str:
    """Return the comparison of all laws as a table."""
    forms = {
        "penetration, µm": ("penetration_um", "{:.5g}"),
        "off by, %": ("off_percent", "{:+.2f}"),
        "stiffness, N/mm²": ("stiffness_N_per_mm2", "{:.5g}"),
        "ends at, N/mm": ("largest_load_N_per_mm", "{:.5g}"),
    }
    table = comparison(pair, load, own, housing, depth)
    texts = pd.DataFrame({"law": table["law"]})
    for heading, (column, form) in forms.items():
        cells = [form.format(value) for value in table[column]]
        texts[heading] = ["-" if cell.endswith("nan") else cell for cell in cells]
    texts["ends at, N/mm"] = texts["ends at, N/mm"].replace("inf", "never")
    texts[""] = [note.partition(" and this pair")[0] for note in table["note"]]
    lines = texts.to_string(index=False, justify="right").splitlines()
    return "\n".join(line.rstrip() for line in lines)


def accuracy(contact: Contact) -> pd.DataFrame:
    """Return the errors of the laws' penetration over the ranges in which they are used.

    Both are at equal load, up to the end of Johnson's law: the root mean square of the logarithm,
    and the largest in percent, against conformal contact and, for rollers, Johnson's law.

    Examples
    --------
    >>> table = accuracy("internal").set_index("law")
    >>> bool(table.loc["explicit", "rms"] < 0.001 < table.loc["johnson", "rms"])
    True
    """
    (E_low, E_high), ends = RANGES[contact]
    E, dR, load = (np.geomspace(*axis, POINTS) for axis in ((E_low, E_high), ends, LOADS))
    E, dR, load = (axis.ravel() for axis in np.meshgrid(E, dR, load))
    material = Material("any", E, 0.3)
    inside = load <= Johnson().max_load(CylinderPair.from_dR(contact, dR, material))
    E, dR, load = E[inside], dR[inside], load[inside]
    radius = R_I if contact == "internal" else dR / 2
    pair = CylinderPair.from_dR(contact, dR, Material("any", E, 0.3), LENGTH, radius)
    exact = reference(contact).penetration(load, pair)
    rows = []
    for name, law in LAWS.items():
        try:
            error = np.log(law().penetration(load, pair) / exact)
        except InputError:
            continue
        known = np.isfinite(error)
        rows.append(
            {
                "law": name,
                "rms": float(np.sqrt(np.mean(error[known] ** 2))),
                "largest_percent": 100 * float(np.abs(np.expm1(error[known])).max()),
                "defined_percent": 100 * float(known.mean()),
            }
        )
    return pd.DataFrame(rows).sort_values("rms", ignore_index=True)


def accuracy_text(contact: Contact) -> str:
    """Return the errors of the laws as a table with a heading."""
    E, dR = RANGES[contact]
    of = "conformal contact" if contact == "internal" else "Johnson's law"
    head = (
        f"error of the penetration against {of} at equal load; {contact} contact, E from "
        f"{E[0] / 1e3:g} to {E[1] / 1e3:g} GPa,\nΔR from {dR[0]:g} to {dR[1]:g} mm, "
        f"{LOADS[0]:g} to {LOADS[1]:g} N/mm up to the end of Johnson's law"
    )
    rows = [
        [
            str(row["law"]),
            f"{row['rms']:.4f}",
            f"{row['largest_percent']:.3g}",
            f"{row['defined_percent']:.3g}",
        ]
        for row in accuracy(contact).to_dict("records")
    ]
    return f"{head}\n\n{TextTable(['law', 'rms of ln', 'largest, %', 'defined over, %'], rows)}"


def listing(contact: Contact) -> str:
    """Return the laws in a line each."""
    lines = ["the laws; sources and conventions are in the documentation of each:"]
    width = max(map(len, LAWS))
    known: dict[str, Any] = {name: LAWS[name]() for name in LAWS} | FITTED
    for name, law in known.items():
        if contact in law.contacts:
            lines.append(f"  {name:<{width}}  {summary_of(law)}")
    return "\n".join(lines)
