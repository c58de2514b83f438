"""The load at which a contact yields, and the end of Johnson's law (Sect. 3.3)."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import Housing, Johnson
from cylcontact.limits.housing_stress import first_yield_in, first_yields_in, seat_opens_in
from cylcontact.limits.rings import AtRest
from cylcontact.limits.yield_search import Criterion, FirstYield, find_first_yield
from cylcontact.support.arrays import FloatArray, as_floats, require, require_positive
from cylcontact.support.errors import InputError


def hertz_stress(load: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return the peak pressure of Hertz's line contact, p₀ = √(f·E*/(π·R)) (Eq 7).

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
    >>> pair = CylinderPair.internal(10.0, 9.5, Material("steel", E=207e3, nu=0.3))
    >>> peak, b = hertz_stress(100.0, pair), hertz_half_width(100.0, pair)
    >>> print(f"{peak:.2f} MPa and {b:.4f} mm carry {np.pi / 2 * b * peak:.6f} N/mm")
    138.04 MPa and 0.4612 mm carry 100.000000 N/mm
    >>> print(hertz_pressure([0.0, 0.3, 0.5], 100.0, pair).round(2))
    [138.04 104.84   0.  ]
    """
    return as_floats(np.sqrt(_loads(load) * pair.E_star / (np.pi * pair.R)))


def hertz_half_width(load: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return the half-width in mm of `hertz_stress`'s contact, b = 2·√(f·R/(π·E*))."""
    return as_floats(2 * np.sqrt(_loads(load) * pair.R / (np.pi * pair.E_star)))


def _loads(load: ArrayLike) -> FloatArray:
    """Return loads, NaN where they are negative."""
    f = as_floats(load)
    return np.where(f >= 0, f, np.nan)


def hertz_pressure(x: ArrayLike, load: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return the elliptic pressure in MPa of `hertz_stress`'s contact, p = p₀·√(1 − x²/b²).

    `x` is the distance from the middle of the contact in mm; the pressure is zero outside it.
    """
    half_width = hertz_half_width(load, pair)
    inside = np.abs(as_floats(x)) < half_width
    share = np.where(inside, as_floats(x) / np.where(half_width > 0, half_width, 1.0), 1.0)
    return as_floats(hertz_stress(load, pair) * np.sqrt(1 - share**2))


def yield_load(
    pair: CylinderPair,
    criterion: Criterion = "von Mises",
    yield_stress: ArrayLike | None = None,
    housing: Housing | None = None,
) -> FloatArray:
    """Return the load at which the contact first yields (Fig 7 with the paper's "Hertz").

    Parameters
    ----------
    pair : CylinderPair
        A pair with known radii, of any two materials.
    criterion : {"von Mises", "Tresca", "Hertz"}
        For von Mises and Tresca see `first_yield`. "Hertz" is the paper's estimate, Hertz's peak
        pressure (Eq 7) equal to the lower yield stress: f = π·σ_Y²·R/E*. In plane strain and with
        ν = 0.3 rollers carry 3.2 times as much by von Mises. A pin in a hole carries more than
        the estimate while f/(E*·ΔR) is below 0.67 at yield, and less beyond.
    yield_stress : float or array_like, optional
        In MPa, for both bodies; by default each has that of its material.
    housing : Housing, optional
        As for `first_yield`; "Hertz" takes none.

    Returns
    -------
    array of float
        Load per unit length in N/mm.

    Raises
    ------
    InputError
        If the criterion or the radii are not known, neither the argument nor both materials give
        a yield stress, or it is not positive.

    Examples
    --------
    A close fit yields long before Hertz's formula says so:

    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=200e3, nu=0.3, yield_stress=250.0)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=[9.5, 9.95, 9.99], material=steel)
    >>> print(yield_load(pair).round(), yield_load(pair, "Hertz").round())
    [ 901. 3614. 3618.] [  339.  3556. 17850.]
    """
    if criterion == "Hertz":
        rule, remedy = "is not for the criterion 'Hertz'", "choose 'von Mises' or 'Tresca'"
        require(housing is None, "yield limit", "housing", housing, rule, remedy)
        weaker = np.minimum(*_yield_stresses(pair, yield_stress))
        return as_floats(np.pi * weaker**2 * pair.R / pair.E_star)
    return first_yield(pair, criterion, yield_stress, housing).load


def first_yield(
    pair: CylinderPair,
    criterion: Literal["von Mises", "Tresca"] = "von Mises",
    yield_stress: ArrayLike | None = None,
    housing: Housing | None = None,
    at_rest: AtRest | None = None,
) -> FirstYield:
    """Return the load at which either body first yields, the body, and the depth.

    Parameters
    ----------
    pair, yield_stress
        As for `yield_load`, in plane strain or plane stress.
    criterion : {"von Mises", "Tresca"}
        Compares an equivalent stress with the yield stress of each body. Both criteria are for
        ductile materials, not for brittle ones, which break in tension.
    housing : Housing, optional
        Around the hole, in place of an infinite plate.
    at_rest : AtRest, optional
        The stress that the rings of the housing have before any load, pressed together or warmed.
        The pair has the radii of that state; the load is 0 if a ring yields at rest.

    Returns
    -------
    FirstYield
        With `load` in N/mm, `body` ("hole" or "pin", "layer 1" and so on of a housing, for external
        contact "i" or "j"), `depth` in mm below the surface, and `angle` in degrees from the load.
        In a housing the load is NaN where the pin leaves it within the arc before anything yields.

    Raises
    ------
    InputError
        As for `yield_load`; "Hertz" gives no place.

    Notes
    -----
    A pin in a hole: the pressure is that of `cylcontact.laws.Conformal`, and the stresses inside
    both bodies under it are exact; `cylcontact.limits.stress` derives them. The pin's load is
    balanced by an even body force, the plate's at infinity. Loads are within 2e-4 of the
    solution, in relative terms. More than eight kinds of joints, of other β, κ or ν, are searched
    in compiled code, 3 µs each on two cores, instead of by a table for each kind, which takes
    0.2 s; both agree to 2e-4. In a housing loads are within 1e-3, where thin eyes that are pulled
    yield on the bore beside the contact, by bending and hoop tension. The ends of a clamp, which
    are singular, are left out: see `cylcontact.limits.housing_stress`. Rollers: Hertz's pressure
    on flat surfaces.

    Examples
    --------
    Clearances of 0.5 and 0.01 mm: below the hole's surface, and on it.

    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=200e3, nu=0.3, yield_stress=250.0)
    >>> for R_j in (9.5, 9.99):
    ...     at = first_yield(CylinderPair.internal(R_i=10.0, R_j=R_j, material=steel))
    ...     print(f"{at.load:.0f} N/mm, in the {at.body}, {at.depth:.2f} mm deep")
    901 N/mm, in the hole, 0.87 mm deep
    3618 N/mm, in the hole, 0.00 mm deep

    The second one in an eye that is pulled by its shank:

    >>> from cylcontact.laws import Housing, Sector
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.99, material=steel)
    >>> print(first_yield(pair, housing=Housing(20.0, Sector(60, side="pulled"))))
    1,428 N/mm (von Mises, in the hole, at its surface, 93° from the load)
    """
    rule = "must be 'von Mises', 'Tresca' or, for the load alone, 'Hertz'"
    remedy = "'Hertz' is the paper's estimate of the load"
    known = criterion in ("von Mises", "Tresca")
    require(known, "yield limit", "criterion", criterion, rule, remedy)
    stresses = _yield_stresses(pair, yield_stress, housing)
    if housing is not None:
        return first_yield_in(housing, pair, stresses, criterion, at_rest)
    rule, remedy = "is of the rings of a housing", "give the housing too"
    require(at_rest is None, "yield limit", "at_rest", None, rule, remedy)
    return find_first_yield(pair, (stresses[0], stresses[1]), criterion)


def first_yields(
    pair: CylinderPair,
    housing: Housing,
    at_rest: AtRest | None = None,
    criterion: Literal["von Mises", "Tresca"] = "von Mises",
) -> tuple[FirstYield, ...]:
    """Return the first yield of each ring of a housing, from within, and of the pin.

    Parameters
    ----------
    pair, housing, at_rest, criterion
        As for `first_yield`. Each body has the yield stress of its material.

    Returns
    -------
    tuple of FirstYield
        The load is NaN where the pin leaves the housing before the body yields, and for a body
        whose yield stress is not known.

    Examples
    --------
    A bronze bush, pressed into a steel eye by 12 µm on the radius; the eye pulls the pin:

    >>> from cylcontact import CylinderPair, Material, laws, limits
    >>> bronze = Material("bronze", 110e3, 0.34, yield_stress=220.0)
    >>> steel = Material("steel", 200e3, 0.3, yield_stress=250.0)
    >>> pair = CylinderPair.from_dR("internal", 0.02, pin=steel, hole=bronze, R_i=10.0)
    >>> eye = laws.Housing(20.0, laws.Sector(60, "pulled"), [(steel, 12.0)], seat="sliding")
    >>> rest = limits.at_rest([bronze, steel], [10.0, 12.0, 20.0], interference=0.012)
    >>> bush, lug, _ = first_yields(pair, eye, rest)
    >>> print(f"bush {bush.load:.0f} N/mm, eye {lug.load:.0f} N/mm, {lug.angle:.0f}° from the load")
    bush 3672 N/mm, eye 895 N/mm, 92° from the load
    """
    known = [body.yield_stress for body in _materials(pair, housing)]
    stresses = [np.inf if stress is None else stress for stress in known]
    return tuple(first_yields_in(housing, pair, stresses, criterion, at_rest))


def seat_opens(pair: CylinderPair, housing: Housing, at_rest: AtRest) -> FloatArray:
    """Return the load in N/mm from which a seat between the rings of a housing opens.

    At that load the pressure of the seat at rest and the radial stress of the load add to zero
    somewhere. Beyond it neither a sliding nor a bonded seat describes the joint.

    Parameters
    ----------
    pair, housing, at_rest
        As for `first_yield`. A rim that is pressed into a frame is a seat too.

    Returns
    -------
    array of float
        inf where no load opens a seat; seats without pressure at rest do not count.
    """
    return seat_opens_in(housing, pair, at_rest)


def yield_warning(
    load: ArrayLike, pair: CylinderPair, housing: Housing | None = None
) -> str | None:
    """Return a warning if a load is above first yield by von Mises, else None.

    The loads are in N/mm, for several pairs a load for each; NaN is ignored. The result is also
    None if a radius or a yield stress is unknown.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> pair = CylinderPair.internal(10.0, 9.99, Material("steel", 200e3, 0.3, yield_stress=250.0))
    >>> first, *others = yield_warning([100.0, 5000.0], pair).split(" (")
    >>> print(first)
    the largest load, 5,000 N/mm, is above first yield at 3,618 N/mm
    >>> print(*others)
    von Mises, in the hole, at its surface); all laws here are elastic
    """
    bodies = _materials(pair, housing)
    if pair.R_i is None or pair.R_j is None or any(body.yield_stress is None for body in bodies):
        return None
    at, given = first_yield(pair, housing=housing), np.nan_to_num(as_floats(load), nan=0.0)
    is_one = np.ndim(at.load) == 0
    loads, ends = np.broadcast_arrays(np.max(given, initial=0.0) if is_one else given, at.load)
    shares = as_floats(loads / ends)
    if not np.any(shares > 1):
        return None
    worst = int(np.nanargmax(shares))
    which = "the largest load" if is_one else "the largest load over first yield"
    place = at.take(worst, loads.shape)
    load_and_limit = f"{which}, {loads.flat[worst]:,.0f} N/mm, is above first yield at {place}"
    return f"{load_and_limit}; all laws here are elastic"


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


def stress_at_johnson_limit(pair: CylinderPair) -> FloatArray:
    """Return Hertz's peak pressure in MPa at Johnson's largest load (Fig 9).

    For equal materials it is (2/e)·E*·ΔR/√(R_i·R_j).
    """
    return hertz_stress(johnson_limit_load(pair), pair)


def elastic_limit_clearance(R_i: ArrayLike, pair: CylinderPair) -> FloatArray:
    """Return the ΔR in mm below which Johnson's law ends before Hertz's pressure reaches yield.

    At this ΔR the yield load by the criterion "Hertz" is the largest load of Johnson's law. The
    stress of Fig 9 equals the yield stress where (2/e)·E*·ΔR = σ_Y·√(R_i·R_j). With
    R_j = R_i − ΔR (internal) this is a quadratic in ΔR, solved in closed form.

    Parameters
    ----------
    R_i : array_like
        Radius of the hole in mm.
    pair : CylinderPair
        An internal pair; only its materials are used.

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
    source = "elastic_limit_clearance"
    rule, remedy = "must be internal", "external contact has no clearance"
    require(pair.contact == "internal", source, "pair.contact", pair.contact, rule, remedy)
    equal = pair.material_i.plane_strain_modulus == pair.material_j.plane_strain_modulus
    rule = "must be as stiff as material_i, or Johnson's limit is not that of Eq 8"
    remedy = "give a pair of one material"
    require(equal, source, "pair.material_j", pair.material_j.title, rule, remedy)
    radius = require_positive(R_i, source, "R_i", "give it in mm")
    m = (math.e * np.minimum(*_yield_stresses(pair, None)) / (2 * pair.E_star)) ** 2
    return as_floats(2 * radius / (1 + np.sqrt(1 + 4 / m)))


def _materials(pair: CylinderPair, housing: Housing | None) -> list[Material]:
    """Return the materials of body i, of layers around it, and of body j."""
    layers = () if housing is None else housing.layers
    return [pair.material_i, *(material for material, _ in layers), pair.material_j]


def _yield_stresses(
    pair: CylinderPair, given: ArrayLike | None, housing: Housing | None = None
) -> list[FloatArray]:
    """Return the yield stresses of body i, of layers around it, and of body j in MPa."""
    bodies = _materials(pair, housing)
    stresses = [body.yield_stress if given is None else given for body in bodies]
    known = [as_floats(stress) for stress in stresses if stress is not None]
    if len(known) < len(bodies):
        rule = f"is not known for {'both' if len(bodies) == 2 else 'all'} materials"
        remedy = "give the materials a yield_stress in MPa, or pass one"
        raise InputError("yield limit", "yield_stress", None, rule, remedy)
    if given is not None:  # those of materials are positive
        require_positive(given, "yield limit", "yield_stress", "give it in MPa")
    return known
