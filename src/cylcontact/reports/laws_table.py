"""All laws side by side: one case, the whole domain, and the bounds that are told of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache

import numpy as np
import pandas as pd
from scipy.optimize import brentq, minimize_scalar

from cylcontact.arrays import FloatArray, require
from cylcontact.errors import InputError
from cylcontact.laws import LAWS, ContactLaw, Explicit, Johnson, Persson, explicit_penetration
from cylcontact.materials import Material
from cylcontact.pair import Contact, CylinderPair

# The case that the laws are compared for: the steel and the clearance of Fig 2, the radius and
# the length of the paper's bearing.
STEEL = Material("steel", E=207e3, nu=0.3)
R_I = LENGTH = 10.0  # mm
DR: dict[Contact, float] = {"internal": 0.05, "external": 2 * R_I}  # mm
LOAD = 100.0  # N/mm

# Where deviations are tabulated and the explicit law's error is sought, in φ = f/(E*·ΔR).
LOAD_NUMBERS: dict[Contact, tuple[float, ...]] = {
    "internal": (1e-4, 1e-3, 0.01, 0.1, 1.0, 10.0),
    "external": (1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3),
}
BOUNDED: dict[Contact, tuple[float, float]] = {"internal": (1e-6, 60.0), "external": (1e-9, 0.02)}
TRUTH: dict[Contact, ContactLaw] = {"internal": Persson(), "external": Johnson()}

DEPARTURES = (1.0, 3.0, 5.0, 10.0)  # percent
CLEARANCES = (0.0075, 0.02, 0.05, 0.2, 0.5)  # mm
SCAN = 2001

Error = Callable[[FloatArray], FloatArray]


def case(
    contact: Contact = "internal",
    E: float = 207e3,
    nu: float = 0.3,
    dR: float | None = None,
    R_i: float = R_I,
    length: float = LENGTH,
) -> CylinderPair:
    """Return the pair that the laws are compared for, with whatever is given changed.

    Parameters
    ----------
    contact : {"internal", "external"}
        Pin in hole, or two rollers.
    E : float
        Young's modulus of both bodies in MPa.
    nu : float
        Poisson's ratio of both bodies.
    dR : float, optional
        ΔR in mm; left out, 0.05 for internal and 20 for external contact.
    R_i, length : float
        Radius of body *i* and axial length in mm.

    Returns
    -------
    CylinderPair

    Raises
    ------
    InputError
        If a number is out of its range.

    Examples
    --------
    >>> pair = case(dR=0.02)
    >>> print(f"{pair.R_j:.2f} mm, {pair.E_star:.0f} MPa")
    9.98 mm, 113736 MPa
    """
    gap = DR.get(contact) if dR is None else dR
    material = Material("the material of both bodies", E, nu)
    return CylinderPair.from_dR(contact, gap if gap is not None else 1.0, material, length, R_i)


def comparison(pair: CylinderPair, load: float) -> pd.DataFrame:
    """Ask every law of `cylcontact.laws.LAWS` about one pair under one load.

    Parameters
    ----------
    pair : CylinderPair
        One pair, its numbers no arrays.
    load : float
        Load per unit length in N/mm, positive.

    Returns
    -------
    pandas.DataFrame
        Columns law, penetration_um, stiffness_N_per_mm2, max_load_N_per_mm (inf where there is
        none) and note; NaN where a law has no answer, and the note says why.

    Raises
    ------
    InputError
        If the load is not positive and finite.

    Examples
    --------
    >>> table = comparison(case(), 100.0).set_index("law")
    >>> print(table.loc[["johnson", "persson"], "penetration_um"].round(5).tolist())
    [1.55935, 1.56362]
    """
    require(
        load > 0 and np.isfinite(load),
        "comparison of laws",
        "load",
        load,
        "must be positive and finite",
        "give it in N/mm",
    )
    return pd.DataFrame([_answers(name, pair, load) for name in LAWS])


def _answers(name: str, pair: CylinderPair, load: float) -> dict[str, object]:
    """Return one row of the comparison."""
    law, note = LAWS[name](), ""
    penetration = stiffness = highest = np.nan
    try:
        penetration = float(law.penetration(load, pair))
        stiffness = float(law.stiffness(penetration, pair))
        highest = float(law.max_load(pair))
    except InputError as error:
        note = error.rule
    if not note and np.isnan(penetration):
        note = "undefined at this ΔR" if np.isnan(highest) else "beyond its largest load"
    return {
        "law": name,
        "penetration_um": 1e3 * penetration,
        "stiffness_N_per_mm2": stiffness,
        "max_load_N_per_mm": highest,
        "note": note,
    }


def deviations(pair: CylinderPair) -> pd.DataFrame:
    """Tabulate how far each law's penetration lies from the truth at equal load.

    The truth is Persson's law for internal contact and Johnson's for external contact.

    Parameters
    ----------
    pair : CylinderPair
        One pair; only laws that are not functions of φ alone depend on it.

    Returns
    -------
    pandas.DataFrame
        A row per law, a column per φ = f/(E*·ΔR), in percent; NaN where a law has no answer.

    Examples
    --------
    >>> print(deviations(case()).loc["johnson"].round(2).tolist())
    [-0.0, -0.01, -0.18, -2.13, -28.91, nan]
    """
    numbers = np.array(LOAD_NUMBERS[pair.contact])
    loads = numbers * pair.E_star * pair.dR
    truth = TRUTH[pair.contact].penetration(loads, pair)
    rows = {}
    for name, law in LAWS.items():
        try:
            rows[name] = 100 * (law().penetration(loads, pair) / truth - 1)
        except InputError:
            rows[name] = np.full_like(numbers, np.nan)
    return pd.DataFrame.from_dict(rows, orient="index", columns=list(numbers)).rename_axis("law")


@cache
def departure_number(percent: float) -> float:
    """Return the φ at which Johnson's penetration is low against Persson's by that much.

    Parameters
    ----------
    percent : float
        From 0 to the 47.8 % at Johnson's largest load, both excluded.

    Returns
    -------
    float

    Examples
    --------
    >>> print(f"{departure_number(10.0):.6f}")
    0.370145
    """
    root = brentq(
        lambda x: johnson_shortfall(np.exp(x)) - percent,
        np.log(1e-6),
        np.log(johnson_end()),
        xtol=1e-13,
    )
    return float(np.exp(root))


def johnson_end() -> float:
    """Return the largest φ of Johnson's law, 4π/e² (Eq 8)."""
    return float(4 * np.pi / np.e**2)


def johnson_shortfall(number: float) -> float:
    """Return by how many percent Johnson's penetration is below Persson's at φ."""
    pair = CylinderPair.from_dR("internal", 1.0, STEEL)
    # Not a rounding error beyond the end of Johnson's law.
    load = np.minimum(number * pair.E_star, Johnson().max_load(pair))
    ratio = Johnson().penetration(load, pair) / Persson().penetration(load, pair)
    return float(100 * (1 - ratio))


def departures(
    material: Material = STEEL, clearances: Sequence[float] = CLEARANCES
) -> pd.DataFrame:
    """Tabulate the loads at which Johnson's law departs from conformal contact.

    Parameters
    ----------
    material : Material, optional
        Of both bodies.
    clearances : sequence of float, optional
        ΔR in mm.

    Returns
    -------
    pandas.DataFrame
        Columns johnson_low_by_percent, load_number (φ) and, for each ΔR in mm, the load φ·E*·ΔR
        in N/mm; the last row is the end of Johnson's law (Eq 8).

    Examples
    --------
    >>> print(departures(clearances=[0.05]).round(3).to_string(index=False))
     johnson_low_by_percent  load_number     0.05
                      1.000        0.053  300.289
                      3.000        0.133  754.505
                      5.000        0.204 1160.305
                     10.000        0.370 2104.951
                     47.765        1.701 9671.411
    """
    end = johnson_end()
    percents = [*DEPARTURES, johnson_shortfall(end)]
    numbers = np.array([*(departure_number(percent) for percent in DEPARTURES), end])
    E_star = CylinderPair.from_dR("internal", 1.0, material).E_star
    return pd.DataFrame(
        {"johnson_low_by_percent": percents, "load_number": numbers}
        | {gap: numbers * E_star * gap for gap in clearances}
    )


@cache
def explicit_error() -> dict[str, float]:
    """Return the largest errors of the explicit law, by a dense scan and local refinement.

    Returns
    -------
    dict
        "internal load" and "internal penetration" (against Persson's law), "external load" and
        "external penetration" (against Johnson's), "one-line penetration" (of
        `explicit_penetration` against Persson's): each in percent, and, under the same name with
        ", at φ" after it, where.

    Examples
    --------
    >>> found = explicit_error()
    >>> found["internal load"] < 0.12, found["external load"] < 0.07
    (True, True)
    """
    found = {}
    for contact, ends in BOUNDED.items():
        pair, law, truth = case(contact), Explicit(), TRUTH[contact]
        unit = float(pair.E_star * pair.dR)
        sought: dict[str, Error] = {
            f"{contact} load": lambda f, p=pair, t=truth: (  # type: ignore[misc]
                law.load(t.penetration(f, p), p) / f
            ),
            f"{contact} penetration": lambda f, p=pair, t=truth: (  # type: ignore[misc]
                law.penetration(f, p) / t.penetration(f, p)
            ),
        }
        if contact == "internal":
            sought["one-line penetration"] = lambda f, p=pair, t=truth: (  # type: ignore[misc]
                explicit_penetration(f, p) / t.penetration(f, p)
            )
        for name, ratio in sought.items():
            found[name], found[f"{name}, at φ"] = _largest(ratio, unit, *ends)
    return found


def _largest(ratio: Error, unit: float, low: float, high: float) -> tuple[float, float]:
    """Return the largest |ratio − 1| in percent for low ≤ φ ≤ high, and its φ."""

    def size(x: FloatArray) -> FloatArray:
        return 100 * np.abs(ratio(np.exp(x) * unit) - 1)

    x = np.linspace(np.log(low), np.log(high), SCAN)
    values = size(x)
    best, place = float(values.max()), float(x[values.argmax()])
    inner = values[1:-1]
    peaks = np.flatnonzero((inner >= values[:-2]) & (inner >= values[2:])) + 1
    for i in peaks:
        top = minimize_scalar(
            lambda at: -float(size(np.asarray(at))),
            bounds=(x[i - 1], x[i + 1]),
            method="bounded",
            options={"xatol": 1e-8},
        )
        if -top.fun > best:
            best, place = float(-top.fun), float(top.x)
    return best, float(np.exp(place))


def to_text(pair: CylinderPair, load: float) -> str:
    """Return everything this module knows about a pair and a load, to be read.

    Parameters
    ----------
    pair : CylinderPair
        One pair.
    load : float
        Load per unit length in N/mm.

    Returns
    -------
    str

    Raises
    ------
    InputError
        If the load is not positive and finite.
    """
    from cylcontact.reports.laws_text import text

    return text(pair, load)
