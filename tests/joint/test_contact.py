"""The forces in the joint: laws, dissipation and friction of the package, on the right bodies."""

import numba
import numpy as np
import pytest

from cylcontact import impact
from cylcontact.joint import contact
from cylcontact.laws import LAWS
from tests.support.mechanism_cases import slider_crank

RNG = np.random.default_rng(8)


def in_contact(mechanism, impact_rate=1.0):
    """Return the joint of a mechanism in contact, and the numbers of its law."""
    contact = mechanism.joint
    joint = contact.record("stop").copy()
    joint["touching"], joint["impact_rate"] = 1, impact_rate
    return joint, contact.kernel.parameters


def forces(e, e_dot, joint, law):
    motion = contact.Motion(*e, *e_dot, 0.0, 0.0)
    return _forces(motion, joint["impact_rate"], joint, law)


_forces = numba.njit(contact.forces)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("clearance", [0.5, 0.02])
def test_the_normal_force_is_that_of_the_law_and_the_dissipation(law, clearance):
    mechanism = slider_crank(law, clearance)
    joint, p = mechanism.joint, in_contact(mechanism, impact_rate=0.7)
    for delta in (1e-9, 1e-7, 3e-6):
        for rate in (-1.0, 0.0, 0.4):
            e, e_dot = (0.0, 1e-3 * joint.radial + delta), (0.0, rate)
            actual = forces(e, e_dot, *p)
            elastic = joint.law.load(delta * 1e3, joint.pair) * 10.0
            wanted = impact.dissipative_load(elastic, rate * 1e3, 0.7e3, joint.chi)
            # δ is a difference of numbers of the size of the clearance.
            digits = 1e-8 + 1e-18 / delta
            assert actual[4] == pytest.approx(float(wanted), rel=digits)
            assert actual[1] == pytest.approx(-float(wanted), rel=digits)
            assert actual[5] == pytest.approx((actual[4] - elastic) * rate, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("v_t", [-3.0, -0.005, -0.0005, 0.0, 0.002, 0.02])
def test_the_friction_is_that_of_the_modified_coulomb_law(v_t):
    mechanism = slider_crank()
    joint, p = mechanism.joint, in_contact(mechanism)
    # n = (0, 1), t = [n_y, −n_x] = (1, 0), so that ė_x is v_t.
    actual = forces((0.0, 1e-3 * joint.radial + 1e-6), (v_t, 0.0), *p)
    wanted = impact.friction_load(actual[4], v_t * 1e3, joint.friction, 1.0, 10.0)
    assert actual[0] == pytest.approx(float(wanted), abs=1e-9)
    assert actual[6] == pytest.approx(-float(wanted) * v_t, abs=1e-9)


def test_the_force_never_pulls():
    mechanism = slider_crank(restitution=0.3)
    e, e_dot = (0.0, mechanism.joint.radial * 1e-3 + 1e-6), (0.0, -50.0)
    actual = forces(e, e_dot, *in_contact(mechanism))
    assert actual[4] == 0.0
    assert actual[0] == actual[1] == 0.0
