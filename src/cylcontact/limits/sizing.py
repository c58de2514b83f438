"""The clearance, modulus or length that gives a stiffness or penetration; the width of contact."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.material import material_in_MPa
from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import Conformal, ContactLaw, Johnson
from cylcontact.support.arrays import FloatArray, as_floats, require, require_positive
from cylcontact.support.errors import InputError

Unknown = Literal["dR", "E", "length"]
# What `find` finds: its unit, and where it looks.
UNKNOWNS: dict[Unknown, tuple[str, float, float]] = {
    "dR": ("mm", 1e-5, 1e3),
    "E": ("MPa", 1.0, 1e7),
    "length": ("mm", 1e-2, 1e4),
}
_SCAN = 200
_SOURCE = "find"


def half_width(load: float, pair: CylinderPair, law: Conformal | None = None) -> FloatArray:
    """Return half the width of contact in mm, R·sin ε of `laws.Conformal`, R beyond 90°.

    The law may be one with a housing.
    """
    angle = np.radians(np.minimum((law or Conformal()).contact_angle(load, pair), 90.0))
    return as_floats(pair.radii("the width")[0] * np.sin(angle))


def find(
    unknown: Unknown,
    pair: CylinderPair,
    load: float,
    *,
    stiffness: float | None = None,
    penetration: float | None = None,
    law: ContactLaw | None = None,
) -> float:
    """Return the clearance, modulus or length at which a contact has a stiffness or penetration.

    Parameters
    ----------
    unknown : {"dR", "E", "length"}
        The radial clearance in mm; Young's modulus of the pin in MPa, that of the hole in the same
        ratio as in the pair; or the axial length in mm.
    pair : CylinderPair
        One pair; its value of the unknown is not used.
    load : float
        In N/mm; for a length the total force in N.
    stiffness : float, optional
        In N/mm²; for a length the total stiffness in N/mm.
    penetration : float, optional
        In mm. Give this or the stiffness.
    law : ContactLaw, optional
        `laws.Conformal()` by default for a pin in a hole, `laws.Johnson()` for rollers.

    Returns
    -------
    float
        The largest value that will do: a law may meet a stiffness again next to its end.

    Raises
    ------
    InputError
        If no value within reach meets it; the error says what can be reached.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> pair = CylinderPair.from_dR("internal", 0.01, Material("steel", 207e3, 0.3), R_i=10.0)
    >>> dR = find("dR", pair, 500.0, stiffness=2e5)
    >>> law = Conformal()
    >>> at = CylinderPair.from_dR("internal", dR, pair.material_i)
    >>> print(f"{dR:.5f} mm, {law.stiffness(law.penetration(500.0, at), at).item():.4f} N/mm²")
    0.00694 mm, 200000.0000 N/mm²
    """
    require(unknown in UNKNOWNS, _SOURCE, "", unknown, "cannot be found", "dR, E or length")
    if (stiffness is None) == (penetration is None):
        rule = "is missing" if stiffness is None else "is given beside a penetration"
        raise InputError(_SOURCE, "stiffness", stiffness, rule, "give stiffness or penetration")
    key, wanted = ("stiffness", stiffness) if penetration is None else ("penetration", penetration)
    target = float(require_positive(wanted, _SOURCE, key, "give it in N/mm² or mm"))
    require_positive(load, _SOURCE, "load", "give it in N/mm, for a length in N")
    if law is None:
        law = Conformal() if pair.contact == "internal" else Johnson()
    unit, low, high = UNKNOWNS[unknown]
    if unknown == "dR" and pair.R_i is not None:
        # No pin smaller than half its hole; rollers of which the second has some radius.
        R_i = float(as_floats(pair.R_i))
        low, high = (low, R_i / 2) if pair.contact == "internal" else (R_i * (1 + 1e-6), 1e6 * R_i)

    def value(x: ArrayLike) -> FloatArray:
        at, scale = _with(pair, unknown, as_floats(x)), as_floats(x) if unknown == "length" else 1.0
        depth = law.penetration(load / scale, at)
        return as_floats(depth if stiffness is None else scale * law.stiffness(depth, at))

    # On both sides of a clearance at which the law jumps.
    jumps = [x for x in getattr(law, "jumps", ()) if unknown == "dR" and low < x < high]
    grid = np.union1d(np.geomspace(low, high, _SCAN), [*np.nextafter(jumps, 0), *jumps])
    values = value(grid)
    known = np.isfinite(values)
    miss = np.sign(values[known] - target)
    crossings = np.flatnonzero((miss[:-1] * miss[1:] <= 0) & ~np.isin(grid[known][1:], jumps))
    of = "mm" if stiffness is None else "N/mm" if unknown == "length" else "N/mm²"
    for jump in jumps if crossings.size == 0 else []:
        below, above = value([np.nextafter(jump, 0), jump])
        if (below - target) * (above - target) < 0:
            rule = f"is met by no dR: the law jumps from {below:.4g} to {above:.4g} {of}"
            raise InputError(_SOURCE, key, target, f"{rule} at {jump:g} mm", "change the target")
    if crossings.size == 0:
        reach = f"{np.min(values[known]):.4g} to {np.max(values[known]):.4g}" if known.any() else ""
        rule = f"is met by no {unknown} from {low:g} to {high:g} {unit}"
        rule += f", which give {reach} {of}" if reach else f", where {law.name} has no value"
        raise InputError(_SOURCE, key, target, rule, "change the load, the materials or the target")
    from scipy.optimize import brentq  # which takes longer to import than the package

    k = crossings[-1]  # of several that of the smallest f/(E*·ΔR): others are next to a law's end
    low, high = (float(np.log(end)) for end in grid[known][[k, k + 1]])

    def miss_at(log: float) -> float:
        return float(value(np.exp(log))) / target - 1

    return float(np.exp(brentq(miss_at, low, high, xtol=1e-14)))


def _with(pair: CylinderPair, unknown: Unknown, x: FloatArray) -> CylinderPair:
    """Return a pair with another value of the unknown."""
    if unknown == "length":
        return pair
    if unknown == "dR":
        R_j = None
        if pair.R_i is not None:
            R_j = pair.R_i - x if pair.contact == "internal" else x - pair.R_i
        return replace(pair, dR=x, R_j=R_j)
    scale = x / as_floats(pair.material_j.E)
    hole, pin = (
        material_in_MPa(body.name, body.E * scale, body.nu)
        for body in (pair.material_i, pair.material_j)
    )
    return replace(pair, material_i=hole, material_j=pin)
