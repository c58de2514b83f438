"""Departure of Johnson's law from conformal contact, and the error of the explicit law.

Both depend on φ = f/(E*·ΔR) only.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache

import numpy as np
import pandas as pd
from scipy.optimize import brentq, minimize_scalar

from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.laws import Conformal, ContactLaw, Explicit, Johnson, Persson
from cylcontact.support.arrays import FloatArray

__all__ = [
    "BOUNDED",
    "CLEARANCES",
    "DEPARTURES",
    "STEEL",
    "TRUTH",
    "departure_number",
    "departures",
    "explicit_error",
    "johnson_end",
    "johnson_shortfall",
    "truth_of",
]

STEEL = Material("steel", E=207e3, nu=0.3)  # of Fig 2
# The reference for the other laws, of two bodies of one material.
TRUTH: dict[Contact, ContactLaw] = {"internal": Persson(), "external": Johnson()}
# The range of φ for the explicit law's error.
BOUNDED: dict[Contact, tuple[float, float]] = {"internal": (1e-6, 60.0), "external": (1e-9, 0.02)}
SCAN = 2001

DEPARTURES = (1.0, 3.0, 5.0, 10.0)  # percent
CLEARANCES = (0.0075, 0.02, 0.05, 0.2, 0.5)  # mm

# Ratio of a law's load or penetration to the reference's, as a function of the load in N/mm.
Ratio = Callable[[FloatArray], FloatArray]


def truth_of(pair: CylinderPair) -> ContactLaw:
    """Return the reference law of a pair, which is `Conformal` for a pin of another material.

    Examples
    --------
    >>> bronze = Material("bronze", E=110e3, nu=0.34)
    >>> truth_of(CylinderPair.from_dR("internal", 0.05, STEEL, material_j=bronze)).name
    'conformal'
    """
    if pair.contact == "internal" and not pair.of_one_material:
        return Conformal()
    return TRUTH[pair.contact]


@cache
def departure_number(percent: float) -> float:
    """Return the φ at which Johnson's penetration is that percentage below Persson's.

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
    return float(4 * np.pi / math.e**2)


def johnson_shortfall(number: float) -> float:
    """Return the percentage by which Johnson's penetration is below Persson's at φ."""
    pair = CylinderPair.from_dR("internal", 1.0, STEEL)
    # Round-off must not put the load beyond the end of Johnson's law.
    load = np.minimum(number * pair.E_star, Johnson().max_load(pair))
    ratio = Johnson().penetration(load, pair) / Persson().penetration(load, pair)
    return float(100 * (1 - ratio))


def departures(
    material: Material = STEEL, clearances: Sequence[float] = CLEARANCES
) -> pd.DataFrame:
    """Tabulate the loads at which Johnson's law departs from conformal contact.

    Examples
    --------
    >>> print(departures(clearances=[0.05]).round(3).to_string(index=False))
     johnson_low_by_percent  load_number     0.05
                      1.000        0.053  300.286
                      3.000        0.133  754.502
                      5.000        0.204 1160.304
                     10.000        0.370 2104.948
                     47.775        1.701 9671.411
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

    Examples
    --------
    >>> error = explicit_error()
    >>> error["internal load"] < 0.12, error["external load"] < 0.07
    (True, True)
    """
    errors = {}
    for contact, ends in BOUNDED.items():
        pair = CylinderPair.from_dR(contact, 1.0, STEEL)
        for name, ratio in _ratios(pair).items():
            errors[name], errors[f"{name}, at φ"] = _largest(ratio, float(pair.E_star), *ends)
    return errors


def _ratios(pair: CylinderPair) -> dict[str, Ratio]:
    """Return the explicit law's ratios to the reference, by name."""
    law, truth = Explicit(), TRUTH[pair.contact]

    def load(f: FloatArray) -> FloatArray:
        return law.load(truth.penetration(f, pair), pair) / f

    def penetration(f: FloatArray) -> FloatArray:
        return law.penetration(f, pair) / truth.penetration(f, pair)

    return {f"{pair.contact} load": load, f"{pair.contact} penetration": penetration}


def _largest(ratio: Ratio, unit: float, low: float, high: float) -> tuple[float, float]:
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
