"""The forces in the joint: laws, dissipation and friction of the package, on the right bodies."""

import numpy as np
import pytest

from cylcontact import impact
from cylcontact.laws import LAWS
from cylcontact.mechanism import contact, linkage, simulate
from tests.support.mechanism_cases import ODD, TURNED, Equations, slider_crank

RNG = np.random.default_rng(8)


def in_contact(mechanism, impact_rate=1.0):
    """Return the joint of a mechanism in contact, and the numbers of its law."""
    contact = mechanism.clearance.contact
    joint = contact.record("stop").copy()
    joint["touching"], joint["impact_rate"] = 1, impact_rate
    return joint, contact.kernel.parameters


def forces(e, e_dot, joint, law):
    return contact.forces_at((*e, *e_dot, 0.0, 0.0), joint["impact_rate"], joint, law)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("clearance", [0.5, 0.02])
def test_the_normal_force_is_that_of_the_law_and_the_dissipation(law, clearance):
    mechanism = slider_crank(law, clearance)
    joint, p = mechanism.clearance.contact, in_contact(mechanism, impact_rate=0.7)
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
    joint, p = mechanism.clearance.contact, in_contact(mechanism)
    # n = (0, 1), t = [n_y, −n_x] = (1, 0), so that ė_x is v_t.
    actual = forces((0.0, 1e-3 * joint.radial + 1e-6), (v_t, 0.0), *p)
    wanted = impact.friction_load(actual[4], v_t * 1e3, joint.friction, 1.0, 10.0)
    assert actual[0] == pytest.approx(float(wanted), abs=1e-9)
    assert actual[6] == pytest.approx(-float(wanted) * v_t, abs=1e-9)


def test_the_force_never_pulls():
    mechanism = slider_crank(restitution=0.3)
    e, e_dot = (0.0, mechanism.clearance.contact.radial * 1e-3 + 1e-6), (0.0, -50.0)
    actual = forces(e, e_dot, *in_contact(mechanism))
    assert actual[4] == 0.0
    assert actual[0] == actual[1] == 0.0


@pytest.mark.parametrize("bearing", ["rod", "slider"])
def test_the_pair_of_forces_balances_and_dissipates(bearing):
    """On bodies in random motion, with the velocities at the contact point worked out here."""
    mechanism = slider_crank(spec=ODD | (TURNED if bearing == "slider" else {}))
    pair = mechanism.clearance.contact
    run = Equations(mechanism, "multiplier").run
    joint, law = run.joints[0], run.laws
    joint["touching"], joint["impact_rate"] = 1, 1.0
    (i, j), c = (int(joint["i"]), int(joint["j"])), 1e-3 * pair.radial
    point_i, point_j = ((joint[f"x_{k}"], joint[f"y_{k}"]) for k in "ij")
    for _ in range(200):
        q, v = RNG.normal(size=9), RNG.normal(size=9)
        v[[3 * i + 2, 3 * j + 2]] *= 300.0
        # Put the journal 2 µm deep into the bearing, in a random direction.
        turn = np.exp(2j * np.pi * RNG.random())
        gap = (c + 2e-6) * turn
        turns = np.empty((3, 2))
        linkage.turn(q, turns)
        here = linkage.point(q, v, turns, i, *point_i)
        there = linkage.point(q, v, turns, j, *point_j)
        q[3 * j] += here[2] - there[2] - gap.real
        q[3 * j + 1] += here[3] - there[3] - gap.imag
        force = np.zeros(9)
        normal_power, friction_power, _, _ = linkage.touch(q, v, turns, force, joint, law)
        f_i, f_j = force[3 * i : 3 * i + 3], force[3 * j : 3 * j + 3]
        # Newton's third law, and no net moment about the origin.
        assert f_i[:2] == pytest.approx(-f_j[:2], abs=1e-9)
        moment = sum(f[2] + q[3 * k] * f[1] - q[3 * k + 1] * f[0] for f, k in ((f_i, i), (f_j, j)))
        scale = np.hypot(*f_i[:2])
        assert moment == pytest.approx(0.0, abs=1e-12 * scale * 10 + 1e-9)
        # The power of both forces, through the bodies' own velocities at the contact point.
        n = np.array([turn.real, turn.imag])
        bearing_centre = np.array(linkage.point(q, v, turns, i, *point_i)[2:4])
        point = bearing_centre - joint["R_bearing"] * n
        velocities = [
            v[3 * k : 3 * k + 2]
            + v[3 * k + 2] * np.array([-(point[1] - q[3 * k + 1]), point[0] - q[3 * k]])
            for k in (i, j)
        ]
        power = f_i[:2] @ velocities[0] + f_j[:2] @ velocities[1]
        # The moments on the bodies are those of the same forces: the same power by coordinates.
        assert force @ v == pytest.approx(power, rel=1e-6, abs=1e-9 * scale)
        approach = n @ (velocities[0] - velocities[1])
        elastic = pair.law.load(2e-3, pair.pair) * 10.0
        assert -power == pytest.approx(
            normal_power + friction_power + elastic * approach, rel=1e-6, abs=1e-6 * elastic
        )
        # Friction opposes the sliding, and dissipates.
        t = np.array([n[1], -n[0]])
        sliding = t @ (velocities[0] - velocities[1])
        assert (f_i[:2] @ t) * sliding <= 0
        assert friction_power == pytest.approx(-(f_i[:2] @ t) * sliding, rel=1e-9, abs=1e-9)
        assert normal_power >= -1e-9


def test_what_a_run_reports_is_what_its_ledgers_add_up():
    run = simulate(slider_crank(spec={"integration.max_step": 1e-6}), revolutions=1)
    power = -run.friction_force * run.tangential_velocity
    assert (power >= 0).all()
    assert np.trapezoid(power, run.time) == pytest.approx(run.friction_dissipation[-1], rel=5e-4)
    elastic = (
        run.mechanism.clearance.contact.law.load(
            np.maximum(run.penetration, 0) * 1e3, run.mechanism.clearance.contact.pair
        )
        * 10.0
        * run.in_contact
    )
    lost = (run.normal_force - elastic) * run.penetration_rate
    assert np.trapezoid(lost, run.time) == pytest.approx(run.normal_dissipation[-1], rel=1e-3)
    along = np.hypot(run.normal_force, run.friction_force)
    assert np.hypot(*run.force.T) == pytest.approx(along, rel=1e-9, abs=1e-9)
