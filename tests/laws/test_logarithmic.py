"""The other logarithmic laws, against their formulas as printed."""

import numpy as np
import pytest
from mpmath import log, mp, mpf, pi, sqrt

from cylcontact import CylinderPair, Material, laws
from cylcontact.fitting.law_models import MODELS

STEEL = Material("steel", E=207e3, nu=0.3)
PAIR = CylinderPair.from_dR("internal", 0.05, STEEL, length=10.0, R_i=10.0)


def radzimovsky(width_factor, of_pi):
    """Radzimovsky's formula with b = width_factor·√(f·R/E*), over √π where `of_pi`."""

    def penetration(f, E_star, R_i, R_j, L):  # noqa: ARG001
        R = R_i * R_j / (R_i - R_j)
        b = width_factor * sqrt(f * R / E_star) / (sqrt(pi) if of_pi else 1)
        return f / (pi * E_star) * (mpf(2) / 3 + log(4 * R_i / b) + log(4 * R_j / b))

    return penetration


# Each formula as the literature prints it, in total force F = f·L or per unit length.
PRINTED = {
    "roark-young": radzimovsky(4, of_pi=True),
    "radzimovsky": radzimovsky(2, of_pi=True),
    "radzimovsky-radii": radzimovsky(mpf("1.6"), of_pi=False),
    "esdu-78035": lambda f, E, Ri, Rj, _: f / (pi * E) * (1 + log(4 * pi * E * (Ri - Rj) / f)),
    "dubowsky-freudenstein": lambda f, E, Ri, Rj, L: (
        f / (pi * E) * (1 + log(L**3 * (Ri - Rj) * pi * E / (f * L * Ri * Rj)))
    ),
    "goldsmith": lambda f, E, Ri, Rj, _: (
        f / (pi * E) * (1 + log(pi * E * Ri * Rj / ((Ri - Rj) * f)))
    ),
    "hertz-cylinder": lambda f, E, Ri, Rj, _: 2 * f / (pi * E) * (log(pi * E * (Ri - Rj) / f) - 1),
}


@pytest.mark.parametrize("law", PRINTED)
@pytest.mark.parametrize("load", [1e-3, 1.0, 100.0, 1000.0])
def test_penetration_is_the_printed_formula(law, load):
    mp.dps = 40
    E_star = mpf(207000) / (2 * (1 - mpf("0.3") ** 2))
    exact = PRINTED[law](mpf(load), E_star, mpf(10), mpf("9.95"), mpf(10))
    assert laws.LAWS[law]().penetration(load, PAIR) == pytest.approx(float(exact), rel=1e-13)


def test_a_fitted_law_has_its_own_c_and_factors_of_modulus_and_lambda():
    values = {"stiffness_factor": 1.2, "c": 0.4, "Lambda_factor": 2.0}
    law = MODELS["goldsmith", "internal"].build(values)
    E_star = 1.2 * PAIR.E_star
    expected = 100.0 / (np.pi * E_star) * (np.log(2 * np.pi * PAIR.R * E_star / 100.0) + 0.4)
    assert law.penetration(100.0, PAIR) == pytest.approx(expected, rel=1e-13)


def test_a_stiffness_factor_multiplies_the_load_as_of_any_law():
    shape = {"c": -1.0, "Lambda_factor": 1.0}
    law = MODELS["johnson", "internal"].build(shape | {"stiffness_factor": 1.2})
    depth = np.array([1e-4, 1e-3, 5e-3])
    expected = 1.2 * laws.Johnson().load(depth, PAIR)
    assert law.load(depth, PAIR) == pytest.approx(expected, rel=1e-12)
