"""The clearance closed: the multiplier form against the closed form of the slider-crank."""

import mpmath
import numpy as np
import pytest

from cylcontact.mechanism import mechanism_from, simulate
from cylcontact.mechanism.linkage import assemble
from tests.support.mechanism_cases import FOUR_BAR, ODD, Equations, slider_crank

CRANK, ROD, OMEGA = mpmath.mpf("0.05"), mpmath.mpf("0.12"), -2 * mpmath.pi * 5000 / 60
ROD_MASS, ROD_INERTIA, SLIDER_MASS = (mpmath.mpf(x) for x in ("0.21", "2.5e-4", "0.14"))
TIMES = [0.0, 0.0011, 0.0047, 0.0083]


def rod_angle(t):
    return -mpmath.asin(CRANK * mpmath.sin(OMEGA * t) / ROD)


def rod_centre(t):
    """Complex position of the rod's centre of mass, halfway."""
    return CRANK * mpmath.expj(OMEGA * t) + ROD / 2 * mpmath.expj(rod_angle(t))


def slider(t):
    return mpmath.re(CRANK * mpmath.expj(OMEGA * t) + ROD * mpmath.expj(rod_angle(t)))


def kinetic(t):
    speeds = mpmath.diff(rod_centre, t), mpmath.diff(rod_angle, t), mpmath.diff(slider, t)
    parts = (
        ROD_MASS * abs(speeds[0]) ** 2,
        ROD_INERTIA * speeds[1] ** 2,
        SLIDER_MASS * speeds[2] ** 2,
    )
    return sum(parts) / 2


@pytest.mark.parametrize("t", TIMES)
def test_the_power_of_the_drive_is_the_rate_of_the_kinetic_energy(t):
    mechanism = slider_crank(clearance=0.0)
    expected = float(mpmath.diff(kinetic, t))
    q, v = assemble(mechanism, t)
    out = Equations(mechanism, "multiplier").rates(t, np.concatenate((q, v)))
    assert out[18] == pytest.approx(expected, abs=1e-8 * 5e4)


@pytest.mark.parametrize("t", TIMES)
def test_the_accelerations_are_those_of_the_closed_form(t):
    mechanism = slider_crank(clearance=0.0)
    q, v = assemble(mechanism, t)
    out = Equations(mechanism, "multiplier").rates(t, np.concatenate((q, v)))
    centre = mpmath.diff(rod_centre, t, 2)
    expected = [centre.real, centre.imag, mpmath.diff(rod_angle, t, 2), mpmath.diff(slider, t, 2)]
    assert out[12:16] == pytest.approx([float(x) for x in expected], rel=1e-10, abs=1e-6)
    assert np.abs(out[16:18]).max() < 1e-6


@pytest.mark.parametrize("spec", [{}, ODD], ids=["plain", "odd"])
def test_a_revolution_follows_the_closed_form(spec):
    mechanism = slider_crank(clearance=0.0, spec=spec)
    run = simulate(mechanism, revolutions=1, tolerance=1e-11)
    for row in range(0, run.time.size, 37):
        q, v = assemble(mechanism, float(run.time[row]))
        assert run.coordinates[row].ravel() == pytest.approx(q, abs=1e-10)
        assert run.velocities[row].ravel() == pytest.approx(v, abs=1e-7)
    assert np.abs(run.energy_error).max() < 1e-6 * run.kinetic_energy.max()


def test_an_ideal_four_bar_keeps_its_joints_and_its_energy():
    run = simulate(mechanism_from(FOUR_BAR, clearance=0.0), revolutions=1)
    assert run.drift[:, 0].max() < 1e-10
    assert np.abs(run.energy_error).max() < 1e-9 * run.kinetic_energy.max()
