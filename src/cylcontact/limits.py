"""The load at which a contact yields, and the end of Johnson's law (Sect. 3.3)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, require
from cylcontact.laws import Johnson, conformal
from cylcontact.pair import CylinderPair

__all__ = [
    "conformal_yield_load",
    "elastic_limit_clearance",
    "hertz_half_width",
    "hertz_pressure",
    "hertz_stress",
    "johnson_limit_load",
    "johnson_limit_penetration",
    "stress_at_johnson_limit",
    "yield_load",
]

# Each step cuts the error of ln f to a third or less, which reaches machine precision.
_CONFORMAL_STEPS = 40


def hertz_stress(load: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return the peak pressure of Hertz's line contact, √(f·E*/(π·R)) (Eq 7).

    Parameters
    ----------
    load : array_like
        Load per unit length in N/mm.
    pair : CylinderPair
        A pair with known radii.

    Returns
    -------
    array of float
        Stress in MPa; NaN where the load is negative.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.5, material=steel)
    >>> print(f"{hertz_stress(100.0, pair):.2f} MPa")
    138.04 MPa
    """
    f = as_floats(load)
    f = np.where(f >= 0, f, np.nan)
    return as_floats(np.sqrt(f * pair.E_star / (np.pi * pair.R)))


def hertz_half_width(load: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return the half-width of Hertz's line contact, b = 2·√(f·R/(π·E*)).

    Parameters
    ----------
    load : array_like
        Load per unit length in N/mm.
    pair : CylinderPair
        A pair with known radii.

    Returns
    -------
    array of float
        Half-width in mm; NaN where the load is negative.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.5, material=steel)
    >>> b, peak = hertz_half_width(100.0, pair), hertz_stress(100.0, pair)
    >>> print(f"{b:.4f} mm carry {np.pi / 2 * b * peak:.6f} N/mm")
    0.4612 mm carry 100.000000 N/mm
    """
    f = as_floats(load)
    f = np.where(f >= 0, f, np.nan)
    return as_floats(2 * np.sqrt(f * pair.R / (np.pi * pair.E_star)))


def hertz_pressure(x: ArrayLike, load: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return the elliptic pressure of Hertz's line contact, p = p₀·√(1 − x²/b²).

    Parameters
    ----------
    x : array_like
        Distance from the middle of the contact in mm.
    load : array_like
        Load per unit length in N/mm.
    pair : CylinderPair
        A pair with known radii.

    Returns
    -------
    array of float
        Pressure in MPa; zero outside the contact, NaN where the load is negative.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.5, material=steel)
    >>> print(hertz_pressure([0.0, 0.3, 0.5], 100.0, pair).round(2))
    [138.04 104.84   0.  ]
    """
    half_width = hertz_half_width(load, pair)
    inside = np.abs(as_floats(x)) < half_width
    share = np.where(inside, as_floats(x) / np.where(half_width > 0, half_width, 1.0), 1.0)
    return as_floats(hertz_stress(load, pair) * np.sqrt(1 - share**2))


def yield_load(pair: CylinderPair, yield_stress: float | None = None) -> FloatArray:
    """Return the load at which Hertz's peak pressure reaches the yield stress (Fig 7).

    It is Eq 7 solved for the load: f = π·σ_Y²·R/E*. The paper takes peak pressure equal to the
    yield stress as its criterion. Plastic flow in line contact starts at a higher pressure, about
    1.8·σ_Y by von Mises. Like Eq 7 it holds only where `hertz_half_width` at that load is small
    compared with the radii; for a pin that fits closely in its hole use `conformal_yield_load`.

    Parameters
    ----------
    pair : CylinderPair
        A pair with known radii.
    yield_stress : float, optional
        In MPa; by default the lower one of the two materials.

    Returns
    -------
    array of float
        Load per unit length in N/mm.

    Raises
    ------
    InputError
        If neither the argument nor both materials give a yield stress, or it is not positive.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3, yield_stress=250.0)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.5, material=steel)
    >>> print(f"{hertz_stress(yield_load(pair), pair):.6f} MPa")
    250.000000 MPa
    """
    stress = _yield_stress(pair, yield_stress)
    return as_floats(np.pi * stress**2 * pair.R / pair.E_star)


def conformal_yield_load(pair: CylinderPair, yield_stress: float | None = None) -> FloatArray:
    """Return the load at which Persson's peak pressure reaches the yield stress.

    The criterion is that of `yield_load`, with the pressure of
    `cylcontact.laws.conformal.peak_pressure`, which also holds for a pin that fits closely in its
    hole. The load is below `yield_load`, because Persson's peak pressure is above Hertz's; the two
    agree where the contact is small.

    Parameters
    ----------
    pair : CylinderPair
        A pin in a hole, both of the same E and ν, with known radii.
    yield_stress : float, optional
        In MPa; by default the lower one of the two materials.

    Returns
    -------
    array of float
        Load per unit length in N/mm.

    Raises
    ------
    InputError
        If the contact is external, the materials differ, the radii are not known, or there is no
        positive yield stress.

    Notes
    -----
    The slope of ln p over ln f is between 1/2 (Hertz) and 1 (complete contact). Steps with the
    slope 3/4 therefore converge from any start; this one is Hertz's load.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=200e3, nu=0.3, yield_stress=250.0)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.95, material=steel)
    >>> print(f"{conformal_yield_load(pair):.0f} N/mm, by Hertz {yield_load(pair):.0f} N/mm")
    2443 N/mm, by Hertz 3556 N/mm
    """
    stress = _yield_stress(pair, yield_stress)
    load = yield_load(pair, stress)
    for _ in range(_CONFORMAL_STEPS):
        load = load * (stress / conformal.peak_pressure(load, pair)) ** (4 / 3)
    return as_floats(load)


def johnson_limit_load(pair: CylinderPair) -> FloatArray:
    """Return the largest load of Johnson's law in N/mm, 4π·E*·ΔR/e² (Eq 8, Fig 8).

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> aluminium = Material("aluminium", E=69e3, nu=0.33)
    >>> pair = CylinderPair.from_dR("internal", [0.0075, 0.010], aluminium)
    >>> print(johnson_limit_load(pair).round(1))
    [493.8 658.4]
    """
    return Johnson().max_load(pair)


def johnson_limit_penetration(pair: CylinderPair) -> FloatArray:
    """Return the largest penetration of Johnson's law in mm, 4ΔR/e² for equal materials."""
    return Johnson().max_penetration(pair)


def stress_at_johnson_limit(pair: CylinderPair) -> FloatArray:
    """Return Hertz's peak pressure in MPa at Johnson's largest load (Fig 9).

    For equal materials it is (2/e)·E*·ΔR/√(R_i·R_j).
    """
    return hertz_stress(johnson_limit_load(pair), pair)


def elastic_limit_clearance(R_i: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return the ΔR in mm at which the yield load equals the largest load of Johnson's law.

    Below it Johnson's law ends before the material yields. The stress of Fig 9 equals the yield
    stress where (2/e)·E*·ΔR = σ_Y·√(R_i·R_j). With R_j = R_i − ΔR (internal) this is a quadratic
    in ΔR, solved in closed form.

    Parameters
    ----------
    R_i : array_like
        Radius of the hole in mm.
    pair : CylinderPair
        An internal pair; only its materials are used.

    Returns
    -------
    array of float
        ΔR in mm.

    Raises
    ------
    InputError
        If the contact is external, the materials differ or have no yield stress, or the
        radius is not positive.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=200e3, nu=0.3, yield_stress=250.0)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.5, material=steel)
    >>> dR = elastic_limit_clearance(10.0, pair)
    >>> at_dR = CylinderPair.from_dR("internal", dR, steel, R_i=10.0)
    >>> print(f"{stress_at_johnson_limit(at_dR):.6f} MPa")
    250.000000 MPa
    """
    require(
        pair.contact == "internal",
        "elastic_limit_clearance",
        "pair.contact",
        pair.contact,
        "must be internal",
        "external contact has no clearance",
    )
    require(
        pair.material_i.plane_strain_modulus == pair.material_j.plane_strain_modulus,
        "elastic_limit_clearance",
        "pair.material_j",
        pair.material_j.name,
        "must be as stiff as material_i, or Johnson's limit is not that of Eq 8",
        "give a pair of one material",
    )
    radius = as_floats(R_i)
    require(
        (radius > 0) & np.isfinite(radius),
        "elastic_limit_clearance",
        "R_i",
        R_i,
        "must be positive and finite",
        "give it in mm",
    )
    m = (np.e * _yield_stress(pair, None) / (2 * pair.E_star)) ** 2
    return as_floats(2 * radius / (1 + np.sqrt(1 + 4 / m)))


def _yield_stress(pair: CylinderPair, given: float | None) -> float:
    """Return the yield stress in MPa: the given one, else the lower one of the materials."""
    own = [m.yield_stress for m in (pair.material_i, pair.material_j) if m.yield_stress is not None]
    require(
        given is not None or len(own) == 2,
        "yield limit",
        "yield_stress",
        None,
        "is not known for both materials",
        "give the materials a yield_stress in MPa, or pass one",
    )
    stress = given if given is not None else min(own)
    require(
        stress > 0 and np.isfinite(stress),
        "yield limit",
        "yield_stress",
        stress,
        "must be positive and finite",
        "give it in MPa",
    )
    return stress
