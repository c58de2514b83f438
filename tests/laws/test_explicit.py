"""The explicit law: its promised accuracy, its inverse, and that it holds everywhere."""

from pathlib import Path

import numpy as np
import pytest
from mpmath import mp, mpf

from cylcontact import CylinderPair, laws
from cylcontact.bodies.material import material_in_MPa
from cylcontact.fitting import read_result
from cylcontact.laws.explicit import CALIBRATED

UNIT = material_in_MPa("of unit composite modulus", E=2.0, nu=0.0)
LAW = laws.Explicit()
ROOT = Path(__file__).resolve().parents[2]


def unit_pair(contact):
    """E* = 1 MPa and ΔR = 1 mm: a load is φ and a penetration d."""
    return CylinderPair.from_dR(contact, 1.0, UNIT)


@pytest.mark.parametrize(
    ("contact", "reference", "phi", "percent"),
    [
        ("internal", laws.Persson(), np.geomspace(1e-6, 60, 20001), 0.12),
        ("external", laws.Johnson(), np.geomspace(1e-9, 0.02, 20001), 0.07),
    ],
)
def test_load_is_as_accurate_as_promised(contact, reference, phi, percent):
    pair = unit_pair(contact)
    load = LAW.load(reference.penetration(phi, pair), pair)
    error = 100 * np.abs(load / phi - 1).max()
    assert 0.5 * percent < error < percent


@pytest.mark.parametrize("contact", ["internal", "external"])
def test_formula_in_forty_digits(contact):
    mp.dps = 40
    c, A, B = (mpf(float(v)) for v in vars(CALIBRATED[contact]).values())
    for d in np.geomspace(1e-14, 1e8, 45):
        x = mpf(float(d))
        L = c + mp.log(1 + A / x * (c + mp.log(1 + A / x * mp.log(B / x))))
        assert float(LAW.load(d, unit_pair(contact))) == pytest.approx(float(mp.pi * x / L), 4e-15)


@pytest.mark.parametrize("contact", ["internal", "external"])
def test_rounded_constants_are_those_the_campaign_found(contact):
    result = read_result(ROOT / f"fitting/results/explicit-{contact}.json")
    for name, value in result.coefficients.items():
        assert getattr(CALIBRATED[contact], name) == pytest.approx(value, rel=5e-4)
    assert result.objective.value < 0.09
    assert laws.Explicit(result.coefficients).coefficients.c == result.coefficients["c"]
