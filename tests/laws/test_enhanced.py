import math
from dataclasses import asdict

import numpy as np
import pytest

from cylcontact import CylinderPair, Material, laws
from cylcontact.laws import Enhanced, InternalCoefficients
from tests.support.paper_equations import e_star, factor_and_exponent

LAW = Enhanced()
# ΔR in mm over the whole range that Eq 6 states, on both sides of the switch of Y.
INTERNAL = [0.005, 0.0075, 0.05, 0.1, 0.3, 0.349, 0.35, 0.5, 1.0, 3.0, np.nextafter(10.0, 0)]
EXTERNAL = [1.0, 5.0, 140.0, 500.0]
ALL = [("internal", dR) for dR in INTERNAL] + [("external", dR) for dR in EXTERNAL]


def steel_pair(contact, dR):
    return CylinderPair.from_dR(contact, dR, Material("steel", E=207e3, nu=0.3))


def first_branch(dR):
    return 1.51 * math.log(1000 * dR) ** -0.151


# --- Eqs 5 and 6 ------------------------------------------------------------------------------


@pytest.mark.parametrize(("contact", "dR"), ALL)
def test_the_published_law_is_eqs_5_and_6(contact, dR):
    pair = steel_pair(contact, dR)
    K, n = factor_and_exponent(e_star(207e3, 0.3), dR, contact)
    for load in (1.0, 10.0, 1000.0):
        delta = (load / K) ** (1 / n)
        assert LAW.penetration(load, pair) == pytest.approx(delta, rel=4e-15, abs=0)
        assert LAW.load(delta, pair) == pytest.approx(load, rel=4e-15)


# --- Y and its two branches -------------------------------------------------------------------


def test_factor_and_exponent_follow_other_coefficients():
    """The switch of Y lies where the two branches meet, at other clearances than the paper's."""
    own = InternalCoefficients(a=0.5, b=0.25, Y_offset=1.18, n_exponent=-0.1)
    dR, law = np.array([0.05, 0.3]), Enhanced(own)
    pair = steel_pair("internal", dR)
    Y = np.array([first_branch(0.05), 0.0151 * 0.3 + 1.18])
    np.testing.assert_allclose(law.exponent(pair), Y * dR**-0.1, rtol=1e-15)
    np.testing.assert_allclose(law.factor(pair), (0.5 * dR + 0.25) * pair.E_star / dR, rtol=1e-15)


# --- where the law is defined -----------------------------------------------------------------

METHODS = ("load", "penetration", "stiffness")
OUTSIDE = [1e-9, 0.001, 0.002, np.nextafter(0.005, 0.0), 10.0, 20.0]


@pytest.mark.parametrize("dR", OUTSIDE)
def test_outside_its_range_of_dR_the_internal_law_is_nan(dR):
    pair = steel_pair("internal", dR)
    answers = [getattr(LAW, method)(1e-3, pair) for method in METHODS]
    answers += [LAW.max_load(pair), LAW.max_penetration(pair), LAW.factor(pair), LAW.exponent(pair)]
    assert np.all(np.isnan(answers))


@pytest.mark.parametrize("changed", [{"b": -0.2}, {"a": 0.0, "b": 0.0}, {"Y_log_scale": -1.0}])
def test_coefficients_that_give_no_stiffness_give_nan(changed):
    """A negative or zero factor or exponent would give a load of the wrong sign, or none."""
    no_Y = {"Y_slope": 0.0, "Y_offset": 0.0} if "Y_log_scale" in changed else {}
    law = Enhanced(asdict(InternalCoefficients()) | changed | no_Y)
    pair = steel_pair("internal", 0.05)
    assert np.all(np.isnan([getattr(law, method)(1.0, pair) for method in METHODS]))
    assert np.isnan(law.max_load(pair))


# --- Eq 9 -------------------------------------------------------------------------------------


def test_a_stiffer_law_differs_by_a_negative_percentage(pair):
    soft, stiff = laws.PowerLaw(n=1.0, K=1.0), laws.PowerLaw(n=1.0, K=4.0)
    assert laws.difference_percent(stiff, soft, 7.0, pair) == -75.0
    assert laws.difference_percent(soft, stiff, 7.0, pair) == 300.0
    assert laws.difference_percent(soft, soft, 7.0, pair) == 0.0
