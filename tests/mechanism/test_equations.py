"""The equations of motion and the reactions, against other derivations."""

import mpmath
import numpy as np
import pytest

from cylcontact.joint import JointState
from cylcontact.mechanism import Motion, mechanism_from, simulate
from tests.support.mechanism_cases import ODD, SLIDER_CRANK, Equations, slider_crank
from tests.support.spec_files import changed


class Cartesian:
    """Eq 10: crank, rod and slider in Cartesian coordinates, with multipliers.

    `solve` returns the accelerations x, y and angle of the three bodies and the seven reactions:
    pivot and crank pin (x, y), guide (force, moment), moment of the driver.
    """

    def __init__(self, mechanism):
        self.mechanism, spec = mechanism, mechanism.spec
        self.mass = np.array([
            *(spec.crank.mass, spec.crank.mass, spec.crank.inertia),
            *(spec.rod.mass, spec.rod.mass, spec.rod.inertia),
            *(spec.slider.mass, spec.slider.mass, 1e-4),
        ])  # fmt: skip

    def solve(self, t, y, impact_rate):
        spec = self.mechanism.spec
        w, r, L = self.mechanism.omega, 1e-3 * spec.crank.length, 1e-3 * spec.rod.length
        u = np.exp(1j * (np.radians(spec.angle) + w * t))
        phi = np.arcsin((1e-3 * spec.offset - r * u.imag - y[1]) / L)
        e = np.exp(1j * phi)
        spin = -(w * r * u.real + y[3]) / (L * e.real)
        P, P_rate = r * u + L * e, 1j * w * r * u + 1j * spin * L * e
        rod = [P.real, P.imag, phi, P_rate.real, P_rate.imag, spin]
        block = [P.real + y[0], 1e-3 * spec.offset, 0.0, P_rate.real + y[2], 0.0, 0.0]
        on_rod = spec.bearing_of == "rod"
        wrench = self.mechanism.joint.evaluate(
            JointState(impact_rate), *((rod, block) if on_rod else (block, rod))
        )
        sides = (wrench.force_bearing, wrench.moment_bearing), (wrench.force_pin, wrench.moment_pin)
        (f, moment), (g, other) = sides if on_rod else sides[::-1]
        # Arms from the centres of mass, and applied forces and moments.
        c, a = spec.crank.centre * r * u, spec.rod.centre * L * e
        arm = L * e - a
        turning = arm.real * f[1] - arm.imag * f[0] + moment
        weight = np.array([*spec.gravity, 0.0] * 3) * self.mass
        applied = weight + np.array([0, 0, 0, *f, turning, *g, other])

        # The rows say where the reactions act, and what they keep: J·q̈ = γ.
        def point(body, arm):
            rows = np.zeros((2, 9))
            rows[:, 3 * body : 3 * body + 2] = np.eye(2)
            rows[:, 3 * body + 2] = -arm.imag, arm.real
            return rows

        guide = np.zeros((2, 9))
        guide[0, 7] = guide[1, 8] = 1.0
        drive = np.zeros((1, 9))
        drive[0, 2] = 1.0
        pin = point(1, -a) - point(0, r * u - c)
        J = np.vstack((point(0, -c), pin, guide, drive))
        pivot, joined = -(w**2) * c, -(spin**2) * a - w**2 * (r * u - c)
        gamma = [pivot.real, pivot.imag, joined.real, joined.imag, 0.0, 0.0, 0.0]
        K = np.block([[np.diag(self.mass), -J.T], [J, np.zeros((7, 7))]])
        solution = np.linalg.solve(K, np.concatenate((applied, gamma)))
        bodies, reactions = solution[:9], solution[9:]
        end = -(w**2) * r * u + (1j * bodies[5] - spin**2) * L * e  # the acceleration of P
        return bodies, reactions, np.array([bodies[6] - end.real, -end.imag])


ODD_CASES = [ODD | {"bearing_of": bearing} for bearing in ("rod", "slider")]


@pytest.mark.parametrize("spec", ODD_CASES, ids=str)
def test_multipliers_give_the_same_accelerations_and_power(spec):
    mechanism = mechanism_from(changed(SLIDER_CRANK, spec))
    ours, theirs = Equations(mechanism), Cartesian(mechanism)
    ours.joint["touching"], ours.joint["impact_rate"] = 1, 0.3
    generator = np.random.default_rng(3)
    for _ in range(300):
        t, angle = generator.uniform(0, mechanism.period), generator.uniform(0, 7)
        away = 5e-4 * (1 + generator.uniform(1e-3, 2e-2))
        y = np.array([away * np.cos(angle), away * np.sin(angle), *generator.normal(0, 0.3, 2)])
        rates = ours.rates(t, y)
        _, reactions, E_acceleration = theirs.solve(t, y, 0.3)
        scale = np.abs(E_acceleration).max()
        assert rates[2:4] == pytest.approx(E_acceleration, abs=1e-10 * scale)
        assert rates[4] == pytest.approx(mechanism.omega * reactions[6], rel=1e-9, abs=1e-6)


@pytest.mark.parametrize("spec", ODD_CASES, ids=str)
def test_the_reactions_satisfy_newtons_equations_at_every_row(spec):
    run = simulate(mechanism_from(changed(SLIDER_CRANK, spec)), revolutions=1)
    theirs, motion = Cartesian(run.mechanism), run.motion
    columns = {
        "slider_acceleration": motion.slider_acceleration,
        "pivot_x": motion.pivot_force.real,
        "pivot_y": motion.pivot_force.imag,
        "crank_pin_x": motion.crank_pin_force.real,
        "crank_pin_y": motion.crank_pin_force.imag,
        "guide_force": motion.guide_force,
        "guide_moment": motion.guide_moment,
        "crank_moment": motion.crank_moment,
    }
    # At an onset δ is 0 to rounding, and by itself the joint would press already.
    rows = np.flatnonzero(run.in_contact | (run.penetration < -1e-9))
    assert len(rows) > 1000
    expected = []
    for row in rows:
        rate = max(run.impact_rate[row], 1e-3)
        bodies, reactions, _ = theirs.solve(run.time[row], run.steps.values[row, :4], rate)
        expected.append([bodies[6], *reactions])
    for (name, actual), wanted in zip(columns.items(), np.transpose(expected), strict=True):
        assert np.abs(actual[rows] - wanted).max() < 1e-9 * np.abs(wanted).max(), name


# --- what the outputs are -----------------------------------------------------------------------


def fine_run(friction):
    """Return a revolution in steps so short that differences are derivatives."""
    mechanism = slider_crank(friction=friction, spec={"gravity": [1.5, -9.81]}, max_step=2e-7)
    return simulate(mechanism, revolutions=1)


@pytest.mark.parametrize("name", ["motion", "ideal"])
def test_acceleration_is_the_derivative_of_velocity_and_that_of_position(name):
    """Without friction, whose force reverses within a step."""
    run = fine_run(friction=0.0)
    motion, dt = getattr(run, name), np.diff(run.time)
    inside = (dt > 1e-9) & (run.in_contact[1:] == run.in_contact[:-1])
    for lower, upper in (("position", "velocity"), ("velocity", "acceleration")):
        value, rate = (getattr(motion, f"slider_{part}") for part in (lower, upper))
        difference = np.diff(value)[inside] - (dt * (rate[1:] + rate[:-1]) / 2)[inside]
        share = np.abs(difference) / (np.abs(rate).max() * dt[inside].max())
        # The force bends at an onset, where the trapezoidal rule is less close.
        assert np.percentile(share, 98) < 1e-5
        assert share.max() < 2e-4


def test_the_work_of_the_crank_is_the_change_of_energy_and_what_is_lost():
    fine = fine_run(friction=0.1)
    power = fine.crank_moment * fine.mechanism.omega
    work = np.concatenate(([0.0], np.cumsum(np.diff(fine.time) * (power[1:] + power[:-1]) / 2)))
    energy = fine.kinetic_energy + fine.potential_energy + fine.elastic_energy
    lost = fine.normal_dissipation + fine.friction_dissipation
    assert lost[-1] > 1.0
    assert np.abs(work - (energy - energy[0] + lost)).max() < 1e-5 * np.abs(work).max()
    assert np.abs(fine.energy_error).max() < 1e-8 * fine.kinetic_energy.max()


CRANK, ROD, OMEGA = mpmath.mpf("0.05"), mpmath.mpf("0.12"), -2 * mpmath.pi * 5000 / 60
ROD_MASS, ROD_INERTIA, SLIDER_MASS = (mpmath.mpf(x) for x in ("0.21", "2.5e-4", "0.14"))


def rod_angle(t):
    return -mpmath.asin(CRANK * mpmath.sin(OMEGA * t) / ROD)


def rod_centre(t):
    return CRANK * mpmath.expj(OMEGA * t) + ROD / 2 * mpmath.expj(rod_angle(t))


def slider(t):
    return mpmath.re(CRANK * mpmath.expj(OMEGA * t) + ROD * mpmath.expj(rod_angle(t)))


def kinetic(t):
    speeds = mpmath.diff(rod_centre, t), mpmath.diff(rod_angle, t), mpmath.diff(slider, t)
    masses = ROD_MASS, ROD_INERTIA, SLIDER_MASS
    return sum(m * abs(v) ** 2 for m, v in zip(masses, speeds, strict=True)) / 2


@pytest.mark.parametrize("t", [0.0, 0.0011, 0.0047, 0.0083])
def test_the_ideal_mechanism_is_that_of_the_closed_form(t):
    mechanism = slider_crank()
    ideal = Motion(mechanism, np.array([mechanism.omega * t]))
    assert ideal.slider_position[0] == pytest.approx(float(slider(t)), rel=1e-13)
    assert ideal.slider_velocity[0] == pytest.approx(float(mpmath.diff(slider, t)), abs=1e-11)
    acceleration = float(mpmath.diff(slider, t, 2))
    assert ideal.slider_acceleration[0] == pytest.approx(acceleration, rel=1e-10)
    power = float(mpmath.diff(kinetic, t))
    assert mechanism.omega * ideal.crank_moment[0] == pytest.approx(power, abs=1e-8 * 5e4)
