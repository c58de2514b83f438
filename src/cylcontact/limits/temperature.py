"""Pin and hole at other temperatures: how far the bore moves follows from the rings around it.

A pin grows as a free body. A hole in a plate without a housing widens as a disk of its material
would. In a housing each ring has u(r) = A·r + B/r and, with E, ν and α in plane stress,

    σ_r = E/(1 − ν²)·[(1 + ν)(A − α·T) − (1 − ν)·B/r²],

where T is the change of temperature; in plane strain E/(1 − ν²), ν/(1 − ν) and (1 + ν)·α take their
places (Timoshenko and Goodier, Theory of Elasticity, Sect. 151). The bore is free of stress, the
rings are bonded, and the rim is free, held, or moves with a frame: u = α_frame·T·R_o.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cylcontact.bodies.material import Material, require_known_at
from cylcontact.bodies.pair import CylinderPair, Plane
from cylcontact.laws import Housing, Sector
from cylcontact.support.arrays import require
from cylcontact.support.errors import InputError

__all__ = ["at_temperature", "bore_expansion"]

_SOURCE = "at_temperature"


def at_temperature(
    pair: CylinderPair,
    pin: float | None = None,
    hole: float | None = None,
    *,
    housing: Housing | None = None,
    rim: str | Material | None = None,
    reference: float = 20.0,
) -> CylinderPair:
    """Return pin and hole with the radii that they have at other temperatures.

    Parameters
    ----------
    pair : CylinderPair
        A pin in a hole with its radii at the reference.
    pin, hole : float, optional
        Temperatures in °C of the pin, and of the hole with all that surrounds it; the reference if
        left out.
    housing : Housing, optional
        The rings around the hole.
    rim : {"free", "held"} or Material, optional
        What the outer rim does: it is free, does not move at all, or follows a frame of this
        material, which has the hole's temperature. Needed with a housing.
    reference : float
        The temperature in °C at which the pair has its radii.

    Returns
    -------
    CylinderPair

    Raises
    ------
    InputError
        If an expansion coefficient or the state of the rim is not known, a polymer of the table
        leaves room temperature, or the pin seizes.

    Examples
    --------
    A PEEK bush in a steel frame, 60 K warmer:

    >>> peek, steel = Material.named("PEEK"), Material.named("low-carbon steel")
    >>> own = Material("PEEK at 80 °C", 3.0e3, 0.38, thermal_expansion=47e-6)
    >>> pair = CylinderPair.internal(10.0, 9.9, pin=steel, hole=own, plane="stress")
    >>> warm = at_temperature(pair, 80.0, 80.0, housing=Housing(13.0), rim=steel)
    >>> print(f"{1e3 * (warm.R_i - 10.0):.2f} µm")
    -1.04 µm
    """
    if housing is None:
        require(rim is None, _SOURCE, "rim", rim, "is for a housing", "give the housing too")
        return pair.at_temperature(pin, hole, reference)
    warmer = 0.0 if hole is None else hole - reference
    cold = pair.at_temperature(pin, None, reference)  # the pin grows; radii and rules are checked
    R_i = float(pair.radii("a temperature")[0])
    moved = bore_expansion(pair.material_i, R_i, housing, warmer, rim, pair.plane)
    dR = float(cold.dR) + moved
    if dR <= 0:
        rule = f"seizes the pin: no clearance is left, {-1e3 * dR:.3g} µm are missing"
        remedy = f"give more clearance, or keep the temperatures closer to {reference:g} °C"
        raise InputError(_SOURCE, "hole", hole, rule, remedy)
    return replace(cold, dR=dR, R_i=R_i + moved)


def bore_expansion(
    material: Material,
    R_i: float,
    housing: Housing,
    warmer: float,
    rim: str | Material | None,
    plane: Plane = "strain",
) -> float:
    """Return by how far a bore widens, in mm, when its rings get warmer by so many K."""
    rule, remedy = "is given by compliances, without its rings", "give its rings, R_o and layers"
    require(housing.g is None, _SOURCE, "housing", housing, rule, remedy)
    rule = "is missing: how far the bore moves depends on what the rim does"
    remedy = 'give "free", "held", or the material of the frame'
    require(rim is not None, _SOURCE, "rim", None, rule, remedy)
    known = isinstance(rim, Material) or rim in ("free", "held")
    require(known, _SOURCE, "rim", rim, "is not a state of the rim", remedy)
    rule, remedy = "is for a rim clamped all round", 'a rim clamped on a sector is "free"'
    whole = not isinstance(housing.clamp, Sector) or rim == "free"
    require(whole, _SOURCE, "rim", rim, rule, remedy)
    rings = [(material, R_i), *housing.layers]
    inner = [radius for _, radius in rings]
    outer = [*inner[1:], housing.R_o]
    frame = [rim] if isinstance(rim, Material) else []
    for body in (*(body for body, _ in rings), *frame):
        key, rule = f"{body.name or 'the hole'}.thermal_expansion", "is not known"
        require(body.thermal_expansion is not None, _SOURCE, key, None, rule, "give it in 1/K")
        require_known_at(body, warmer)

    size = 2 * len(rings)
    matrix, right = np.zeros((size, size)), np.zeros(size)

    def stress(k: int, r: float) -> tuple[float, float, float]:
        """Return the factors of A_k and B_k in σ_r, and its part at A = B = 0."""
        body = rings[k][0]
        E, nu, alpha = float(body.E), float(body.nu), float(body.thermal_expansion or 0.0)
        if plane == "strain":
            E, nu, alpha = E / (1 - nu**2), nu / (1 - nu), (1 + nu) * alpha
        of_A = E / (1 - nu)
        return of_A, -E / ((1 + nu) * r**2), -of_A * alpha * warmer

    of_A, of_B, own = stress(0, inner[0])  # the bore is free of stress
    matrix[0, :2], right[0] = (of_A, of_B), -own
    for k in range(len(rings) - 1):
        r, row = outer[k], 2 * k + 1
        (a, b, own), (c, d, other) = stress(k, r), stress(k + 1, r)
        matrix[row, 2 * k : 2 * k + 4] = a, b, -c, -d
        right[row] = other - own
        matrix[row + 1, 2 * k : 2 * k + 4] = r, 1 / r, -r, -1 / r
    if rim == "free":
        of_A, of_B, own = stress(len(rings) - 1, housing.R_o)
        matrix[-1, -2:], right[-1] = (of_A, of_B), -own
    else:
        growth = rim.thermal_expansion if isinstance(rim, Material) else 0.0
        matrix[-1, -2:] = housing.R_o, 1 / housing.R_o
        right[-1] = float(growth or 0.0) * warmer * housing.R_o
    A, B = np.linalg.solve(matrix, right)[:2]
    return float(A * R_i + B / R_i)
