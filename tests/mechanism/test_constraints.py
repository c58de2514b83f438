"""Joints: their Jacobian and acceleration terms, and the assembly from a rough guess."""

import numpy as np
import pytest

from cylcontact import InputError
from cylcontact.mechanism import mechanism_from
from cylcontact.mechanism.linkage import assemble, closure, constraint_table
from cylcontact.mechanism.model import Joint
from tests.support.mechanism_cases import FOUR_BAR, SLIDER_CRANK, slider_crank
from tests.support.spec_files import DROP, changed

# One joint of every kind, between the ground and a body and between two that move.
JOINTS = (
    Joint("a", "revolute", -1, 0, (0.1, -0.2), (0.3, 0.4)),
    Joint("b", "revolute", 0, 1, (0.2, 0.1), (-0.3, 0.2)),
    Joint("c", "prismatic", -1, 1, (0.1, 0.2), (0.3, -0.1), direction=0.3, angle=0.2),
    Joint("d", "prismatic", 0, 2, (0.3, 0.1), (0.1, 0.2), direction=-0.7, angle=0.1),
    Joint("e", "driver", -1, 0, speed=3.0, angle=0.4),
    Joint("f", "driver", 1, 2, speed=-2.0),
    Joint("g", "driver", 0, 2, speed=2.0, ramp=0.5),
)
RNG = np.random.default_rng(4)
Q, V, A = RNG.normal(size=(3, 9))
STEP = 1e-5


def path(t):
    """A motion with these coordinates, velocities and accelerations at t = 0."""
    return Q + V * t + A * t**2 / 2, V + A * t


def constraints_at(t):
    return closure(constraint_table(JOINTS), t, *path(t))


def test_the_jacobian_is_the_derivative_of_the_constraints():
    table = constraint_table(JOINTS)
    _, _, jacobian, _ = closure(table, 0.0, Q, V)
    for k in range(Q.size):
        shift = np.zeros_like(Q)
        shift[k] = STEP
        above, below = (closure(table, 0.0, Q + sign * shift, V)[0] for sign in (1, -1))
        assert jacobian[:, k] == pytest.approx((above - below) / (2 * STEP), abs=1e-9)


def test_the_rates_and_gamma_are_those_of_any_motion():
    _, rate, jacobian, gamma = constraints_at(0.0)
    above, below = constraints_at(STEP), constraints_at(-STEP)
    assert rate == pytest.approx((above[0] - below[0]) / (2 * STEP), abs=1e-8)
    # d²Φ/dt² = Φ_q·q̈ − γ
    acceleration = (above[1] - below[1]) / (2 * STEP)
    assert jacobian @ A - gamma == pytest.approx(acceleration, abs=1e-7)


@pytest.mark.parametrize("degrees", [0.0, 77.0, 200.0])
def test_the_slider_crank_is_assembled_where_trigonometry_puts_it(degrees):
    mechanism = slider_crank(spec={"joint.drive.angle": degrees})
    q, v = assemble(mechanism)
    theta, omega, r, L = np.radians(degrees), mechanism.driver.speed, 0.05, 0.12
    phi = -np.arcsin(r * np.sin(theta) / L)
    phi_rate = -omega * r * np.cos(theta) / (L * np.cos(phi))
    x = r * np.cos(theta) + L * np.cos(phi)
    x_rate = -omega * r * np.sin(theta) - phi_rate * L * np.sin(phi)
    assert [q[5], q[6], q[7], q[8]] == pytest.approx([phi, x, 0, 0], abs=1e-14)
    assert [v[5], v[6], v[7], v[8]] == pytest.approx([phi_rate, x_rate, 0, 0], abs=1e-10)


def test_the_four_bar_is_assembled_where_two_circles_meet():
    q, _ = assemble(mechanism_from(FOUR_BAR))
    crank_pin, pivot, coupler, rocker = np.array([0.04, 0.0]), np.array([0.14, 0.0]), 0.12, 0.09
    base = pivot - crank_pin
    d = np.hypot(*base)
    along = (coupler**2 - rocker**2 + d**2) / (2 * d)
    joint = crank_pin + along * base / d + np.sqrt(coupler**2 - along**2) * np.array([0.0, 1.0])
    end = q[3:5] + 0.06 * np.array([np.cos(q[5]), np.sin(q[5])])
    assert end == pytest.approx(joint, abs=1e-14)


def test_a_rod_too_short_is_told():
    rod = {"bodies.rod.points": {"pin": [-0.02, 0.0], "eye": [0.02, 0.0]}}
    spec = changed(SLIDER_CRANK, rod | {"joint.drive.angle": 90.0})
    with pytest.raises(
        InputError, match=r"cannot be assembled: the joints stay .* apart"
    ) as caught:
        assemble(mechanism_from(spec))
    assert "a rod must reach" in caught.value.remedy


def test_a_joint_too_few_is_warned_of():
    mechanism = mechanism_from(changed(SLIDER_CRANK, {"joint.slide": DROP}))
    assert mechanism.warnings == ("beside the driver 2 coordinates are free: is a joint missing?",)
    q, _ = assemble(mechanism)
    assert q[5:8] == pytest.approx([0, 0.17, 0], abs=1e-14)


def test_a_joint_that_holds_twice_what_another_leaves_free_is_told():
    twice = {"name": "slide", "between": ["ground.pivot", "crank.pivot"]}
    with pytest.raises(InputError, match="leave a body free, or hold one twice"):
        assemble(mechanism_from(changed(SLIDER_CRANK, {"joint.slide": twice})))
