"""All laws over the whole domain of conformal contact, in dimensionless variables.

With φ = f/(E*·ΔR) and d = δ/ΔR a dimensionless law is a single curve for every pair. The enhanced
law is not dimensionless: every clearance has its own curve, drawn for a stated pair.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.material import material_in_MPa
from cylcontact.bodies.pair import CylinderPair
from cylcontact.fitting.results import LawFit
from cylcontact.laws import (
    ContactLaw,
    Enhanced,
    Explicit,
    Johnson,
    Liu,
    Persson,
    Winkler,
    explicit_penetration,
)
from cylcontact.reports.laws_bounds import BOUNDED, STEEL
from cylcontact.support.arrays import FloatArray, as_floats

# E* = 1 MPa and ΔR = 1 mm, so that a load is φ and a penetration is d.
_UNIT = material_in_MPa("unit", 2.0, 0.0)
UNIT_PAIR = CylinderPair.from_dR("internal", 1.0, _UNIT)
UNIT_ROLLERS = CylinderPair.from_dR("external", 1.0, _UNIT)
PHI_MIN, PHI_MAX = BOUNDED["internal"]
EXTERNAL_PHI = BOUNDED["external"]
PER_DECADE = 200
# What the table calls the formula for the penetration.
FORMULA = "explicit formula for the penetration"
INVERSION_POINTS = 100_001

# The pairs for which the laws that are not dimensionless are drawn.
EXAMPLE = STEEL
EXAMPLE_CLEARANCES = (0.01, 0.05, 0.5)  # mm
EXAMPLE_LOADS = (1.0, 1e4)  # N/mm


@dataclass(frozen=True)
class Curve:
    """A law in the universal variables, beside its reference."""

    law: str
    pair: str
    phi: FloatArray
    d: FloatArray
    reference_d: FloatArray
    load_error: FloatArray
    penetration_error: FloatArray


def _law_curve(
    law: ContactLaw,
    label: str,
    reference: ContactLaw,
    pair: CylinderPair = UNIT_PAIR,
    ends: tuple[float, float] = (PHI_MIN, PHI_MAX),
    pair_label: str = "any",
) -> Curve:
    """Evaluate a law and its reference at `PER_DECADE` loads to the decade."""
    unit = float(pair.E_star * pair.dR)
    phi = _loads(ends, _last_loads(law, reference, pair) / unit)
    load, depth = phi * unit, reference.penetration(phi * unit, pair)
    delta = law.penetration(load, pair)
    return Curve(
        label,
        pair_label,
        phi,
        as_floats(delta / pair.dR),
        as_floats(depth / pair.dR),
        as_floats(100 * (law.load(depth, pair) / load - 1)),
        as_floats(100 * (delta / depth - 1)),
    )


def _formula_curve() -> Curve:
    """Evaluate the formula for the penetration; its load is the formula inverted numerically."""
    phi = _loads((PHI_MIN, PHI_MAX))
    reference_d, d = Persson().penetration(phi, UNIT_PAIR), explicit_penetration(phi, UNIT_PAIR)
    line = np.geomspace(PHI_MIN / 2, 2 * PHI_MAX, INVERSION_POINTS)
    depths = np.log(explicit_penetration(line, UNIT_PAIR))
    load = np.exp(np.interp(np.log(reference_d), depths, np.log(line)))
    errors = (as_floats(100 * (ratio - 1)) for ratio in (load / phi, d / reference_d))
    return Curve(FORMULA, "any", phi, d, reference_d, *errors)


def dimensionless_curves() -> list[Curve]:
    """Return the laws that are one curve for every pair, judged by Persson's."""
    laws: tuple[tuple[str, ContactLaw], ...] = (
        ("explicit", Explicit()),
        ("johnson", Johnson()),
        ("liu", Liu()),
        ("winkler", Winkler()),
    )
    curves = [_law_curve(law, name, Persson()) for name, law in laws]
    return [curves[0], _formula_curve(), *curves[1:]]


def enhanced_curves(refits: dict[str, LawFit]) -> list[Curve]:
    """Return the enhanced law for the pairs of `EXAMPLE`, published and refitted."""
    laws = {"enhanced": Enhanced()}
    laws |= {name: Enhanced(result.coefficients) for name, result in refits.items()}
    return [
        _example_curve(law, name, dR) for name, law in laws.items() for dR in EXAMPLE_CLEARANCES
    ]


def external_curve() -> Curve:
    """Return the explicit law for rollers, judged by Johnson's."""
    return _law_curve(Explicit(), "explicit", Johnson(), UNIT_ROLLERS, EXTERNAL_PHI)


def _example_curve(law: ContactLaw, label: str, dR: float) -> Curve:
    """Return a law for one example pair, between the example's loads."""
    pair = CylinderPair.from_dR("internal", dR, EXAMPLE)
    unit = float(pair.E_star) * dR
    low, high = (load / unit for load in EXAMPLE_LOADS)
    name = f"E = {EXAMPLE.E / 1e3:g} GPa; nu = {EXAMPLE.nu:g}; dR = {dR:g} mm"
    return _law_curve(law, label, Persson(), pair, (low, high), name)


def _last_loads(law: ContactLaw, reference: ContactLaw, pair: CylinderPair) -> FloatArray:
    """Return the law's largest load, and the reference's at the law's largest penetration."""
    ends = law.max_load(pair), reference.load(law.max_penetration(pair), pair)
    # Just inside, so that rounding leaves neither undefined.
    return as_floats(ends) * (1 - 1e-12)


def _loads(ends: tuple[float, float], more: ArrayLike = ()) -> FloatArray:
    """Return φ from one end to the other, with the values of `more` between them."""
    count = round(PER_DECADE * np.log10(ends[1] / ends[0])) + 1
    inside = [phi for phi in np.atleast_1d(more) if ends[0] < phi < ends[1]]
    return np.unique([*np.geomspace(*ends, count), *inside])
