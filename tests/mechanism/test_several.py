"""Mechanisms with several clearances, springs, dampers, loads and driving torques."""

from functools import partial

import numpy as np
import pytest
from scipy.integrate import DOP853, solve_ivp

from cylcontact import InputError
from cylcontact.mechanism import Trajectory, long_run, mechanism_from, simulate
from cylcontact.mechanism.linkage import assemble, closure, constraint_table, driven
from cylcontact.mechanism.slider_crank import recognise
from tests.support.joint_runners import module_of
from tests.support.mechanism_cases import (
    CLEARANCE,
    FOUR_BAR,
    ODD,
    SLIDER_CRANK,
    TURNED,
    with_clearance,
)
from tests.support.spec_files import changed

TWO = with_clearance(SLIDER_CRANK, "crank-pin")
CRANK, WRIST = "crank-pin", "wrist-pin"


def two_clearances(crank_pin=0.5, wrist_pin=0.5, **changes):
    clearances = {f"joint.{CRANK}.clearance": crank_pin, f"joint.{WRIST}.clearance": wrist_pin}
    return mechanism_from(changed(TWO, clearances), **changes)


# --- two clearances in the slider-crank -----------------------------------------------------------


@pytest.mark.parametrize("method", ["minimal", "multiplier"])
@pytest.mark.parametrize("restitution", [1.0, 0.9])
@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_the_energy_balance_closes_with_two_clearances(restitution, friction, method):
    mechanism = two_clearances(restitution=restitution, friction=friction)
    run = simulate(mechanism, method, revolutions=10)
    assert min(len(joint.contacts) for joint in run.joints.values()) > 100
    assert np.abs(run.energy_error).max() < 4e-8 * run.kinetic_energy.max()
    assert run.drift[:, 0].max() < 1e-10
    for joint in run.joints.values():
        assert joint.penetration[joint.in_contact].min() > -1e-13
        assert joint.penetration[~joint.in_contact].max() < 1e-12


# Each joint turned: the hole in the other body.
TURNED_PIN = {f"joint.{CRANK}.between": ["rod.pin", "crank.pin"]}


@pytest.mark.parametrize("changes", [{}, ODD | TURNED, ODD | TURNED_PIN])
@pytest.mark.parametrize("order", [1, -1])
def test_both_forms_agree_with_two_clearances(changes, order):
    """On the first impacts and what has been lost by then, in either order of the joints."""
    spec = changed(TWO, changes)
    mechanism = mechanism_from(spec | {"joint": spec["joint"][::order]})
    runs = [simulate(mechanism, form, 1, 1e-11) for form in (None, "multiplier")]
    assert [run.settings.method for run in runs] == ["minimal", "multiplier"]
    first = [onsets(run)[:20] for run in runs]
    assert len(first[0]) == 20
    for (mine, name), (other, named) in zip(*first, strict=True):
        assert name == named
        assert mine == pytest.approx(other, abs=1e-6 * mechanism.period)
    rows = [np.searchsorted(run.time, times[-1][0]) for run, times in zip(runs, first, strict=True)]
    for name in ("drive_work", "friction_dissipation", "kinetic_energy", "potential_energy"):
        ends = [getattr(run, name)[row] for run, row in zip(runs, rows, strict=True)]
        assert ends[0] == pytest.approx(ends[1], rel=1e-5)
    ends = [run.coordinates[row] for run, row in zip(runs, rows, strict=True)]
    assert ends[0] == pytest.approx(ends[1], abs=1e-7)
    for joint in mechanism.clearances:
        forces = [run.joints[joint.name].force for run in runs]
        largest = [np.hypot(*f[:row].T).max() for f, row in zip(forces, rows, strict=True)]
        assert largest[0] == pytest.approx(largest[1], rel=1e-2)


def onsets(run):
    """Return when contacts begin in s, and in which joint."""
    return sorted((float(t), name) for name, j in run.joints.items() for t in j.contacts["onset_s"])


class Reduced:
    """Another formulation: coordinates on the null space of the constraints, by singular values.

    Forces are those of the exported Python joints, and SciPy integrates from event to event.
    """

    def __init__(self, mechanism):
        self.joints = mechanism.clearances
        self.mass = np.array([[b.mass, b.mass, b.inertia] for b in mechanism.bodies]).ravel()
        self.table = constraint_table([j for j in mechanism.joints if j.clearance is None])
        self.modules = [module_of(joint.contact) for joint in self.joints]
        self.rates = [0.0] * len(self.joints)
        self.start = np.concatenate(assemble(mechanism))

    def wrench(self, k, y):
        size, joint = self.mass.size, self.joints[k]
        bearing, pin = (
            [*y[3 * b : 3 * b + 3], *y[size + 3 * b : size + 3 * b + 3]] for b in (joint.i, joint.j)
        )
        return self.modules[k].evaluate(self.rates[k], bearing, pin)

    def gap(self, k, _, y):
        return self.wrench(k, y).penetration * 1e3

    def right(self, t, y):
        size, force = self.mass.size, np.zeros(self.mass.size)
        for k, joint in enumerate(self.joints):
            if self.rates[k]:
                w = self.wrench(k, y)
                force[3 * joint.i : 3 * joint.i + 3] += (*w.force_bearing, w.moment_bearing)
                force[3 * joint.j : 3 * joint.j + 3] += (*w.force_pin, w.moment_pin)
        _, _, jacobian, gamma = closure(self.table, t, y[:size], y[size:])
        free = np.linalg.svd(jacobian)[2][len(jacobian) :].T
        particular = np.linalg.lstsq(jacobian, gamma)[0]
        reduced = free.T @ (self.mass[:, None] * free)
        rest = np.linalg.solve(reduced, free.T @ (force - self.mass * particular))
        return np.concatenate((y[size:], particular + free @ rest))

    def onsets(self, count):
        """Return when the first contacts begin in s, and in which joint."""
        t, y, found = 0.0, self.start, []
        while len(found) < count:
            events = [partial(self.gap, k) for k in range(len(self.joints))]
            for event, rate in zip(events, self.rates, strict=True):
                event.terminal, event.direction = True, -1.0 if rate else 1.0
            path = solve_ivp(
                self.right, (t, 1.0), y, DOP853, events=events, rtol=1e-11, atol=1e-13,
                max_step=2e-6 if any(self.rates) else 2e-5, first_step=1e-9,
            )  # fmt: skip
            t, y = float(path.t[-1]), path.y[:, -1]
            k = next(k for k, times in enumerate(path.t_events) if times.size)
            if self.rates[k]:
                self.rates[k] = 0.0
            else:
                self.rates[k] = max(self.wrench(k, y).penetration_rate, 1e-3)
                found.append((t, self.joints[k].name))
        return found


@pytest.mark.slow
@pytest.mark.parametrize(("restitution", "friction"), [(0.9, 0.0), (0.9, 0.1)])
def test_a_second_formulation_gives_the_first_twenty_impacts(restitution, friction):
    mechanism = two_clearances(0.1, 0.1, restitution=restitution, friction=friction)
    run = simulate(mechanism, revolutions=1, tolerance=1e-11)
    ours = onsets(run)[:20]
    theirs = Reduced(mechanism).onsets(20)
    assert [name for _, name in ours] == [name for _, name in theirs]
    for (mine, _), (other, _) in zip(ours, theirs, strict=True):
        assert mine == pytest.approx(other, abs=1e-6 * mechanism.period)


def test_a_clearance_that_shrinks_becomes_an_ideal_joint():
    """Its statistics approach those with that joint ideal: here of the drive and of the other."""
    law = "lankarani-nikravesh"
    ideal = simulate(two_clearances(0.0, 0.2, law=law), "multiplier", revolutions=6).statistics(3)
    names = ("mean_force_N", "mean_penetration_um", "friction_dissipation_J", "contact_fraction")
    wanted = np.array([ideal.mean[name] for name in names])
    off = []
    for share in (0.1, 0.01, 0.001):
        statistics = simulate(two_clearances(0.2 * share, 0.2, law=law), revolutions=6).statistics(
            3
        )
        found = np.array([statistics.joint(WRIST).mean[name] for name in names])
        off.append(np.abs(found / wanted - 1).max())
    assert off[0] < 0.1
    assert off[2] < off[1] < off[0]
    assert off[2] < 3e-3


def test_each_joint_has_a_law_a_pair_and_statistics_of_its_own(tmp_path):
    pin = {f"joint.{CRANK}.law": "explicit", f"joint.{CRANK}.pin": {"material": "bronze"}}
    soft = {f"joint.{WRIST}.{body}.yield_stress": 100.0 for body in ("bearing", "pin")}
    mechanism = mechanism_from(changed(TWO, pin | soft))
    run = simulate(mechanism, revolutions=3)
    statistics = run.statistics(1)
    assert [j.contact.law.name for j in mechanism.clearances] == ["explicit", "enhanced"]
    mean, alone = statistics.mean, statistics.joint(WRIST)
    assert mean[f"{WRIST}.mean_force_N"] == alone.mean["mean_force_N"]
    assert mean["drive_work_J"] == alone.mean["drive_work_J"]
    assert alone.revolutions["above_yield"].sum() > 0
    assert statistics.revolutions[f"{CRANK}.above_yield"].isna().all()
    assert [text.startswith(f"{WRIST}: the largest load") for text in run.warnings] == [True]
    lost = sum(
        statistics.revolutions[f"{name}.{kind}_dissipation_J"].sum()
        for name in run.joints
        for kind in ("normal", "friction")
    )
    all_lost = run.normal_dissipation[-1] + run.friction_dissipation[-1]
    assert lost == pytest.approx(all_lost, rel=1e-12)
    with pytest.raises(InputError, match="2 joints have a clearance; take one of `clearances`"):
        _ = run.penetration
    assert f"{CRANK}: law: explicit" in statistics.to_text()
    whole = long_run(mechanism, 3, 1)
    assert whole.mean.drop("evaluations").equals(mean.drop("evaluations"))
    run.save(tmp_path / "run.parquet")
    resumed = simulate(mechanism, revolutions=4, resume=Trajectory.load(tmp_path / "run.parquet"))
    assert np.array_equal(resumed.rows.values, simulate(mechanism, revolutions=4).rows.values)


def test_events_of_two_joints_may_coincide():
    """A beam that falls on two pins alike: both sides touch and part at the same times."""
    ends = {"left": [-0.1, 0.0], "right": [0.1, 0.0]}
    entries = [
        {**CLEARANCE, "name": side, "between": [f"beam.{side}", f"ground.{side}"]} for side in ends
    ]
    spec = {
        "name": "beam",
        "gravity": [0.0, -9.81],
        "ground": {"points": ends},
        "bodies": {
            "beam": {"mass": 2.0, "inertia": 0.01, "points": ends, "guess": [0.0, 0.0, 0.0]}
        },
        "joint": entries,
        "integration": {
            "alpha": 0.0, "beta": 0.0, "max_step": 1e-3, "tolerance": 1e-9, "revolutions": 1,
            "period": 0.1,
        },
    }  # fmt: skip
    run = simulate(mechanism_from(spec, friction=0.0))
    left, right = (run.joints[side].contacts for side in ends)
    for column in ("onset_s", "impact_rate_m_per_s", "max_penetration_m"):
        np.testing.assert_allclose(left[column][:5], right[column][:5], rtol=1e-6)
    assert len(left) == len(right) > 4
    fall = np.sqrt(2 * 0.5e-3 / 9.81)
    assert left["onset_s"][0] == pytest.approx(fall, rel=1e-9)
    assert np.abs(run.energy_error).max() < 1e-6 * run.kinetic_energy.max()


def test_a_four_bar_with_three_clearances_keeps_its_energy():
    spec = with_clearance(with_clearance(FOUR_BAR, "crank-pin", clearance=0.1), "rocker")
    run = simulate(mechanism_from(spec, clearance=0.1), revolutions=2)
    assert list(run.joints) == ["crank-pin", "rocker-pin", "rocker"]
    assert all(len(joint.contacts) > 3 for joint in run.joints.values())
    assert np.abs(run.energy_error).max() < 1e-6 * run.kinetic_energy.max()


# --- springs, dampers, loads, torques -------------------------------------------------------------

PENDULUM = {
    "name": "pendulum",
    "gravity": [0.0, -9.81],
    "ground": {"points": {"pin": [0.0, 0.0], "post": [0.1, 0.0]}},
    "bodies": {
        "rod": {
            "mass": 0.8, "inertia": 2e-3, "points": {"eye": [-0.08, 0.0], "end": [0.08, 0.0]},
            "guess": [0.08, 0.0, 0.0],
        }
    },
    "joint": [{**CLEARANCE, "name": "pivot", "between": ["rod.eye", "ground.pin"]}],
    "spring": [{"between": ["ground", "rod"], "stiffness": 3.0, "damping": 0.01, "angle": -40.0}],
    "integration": {
        "alpha": 0.0, "beta": 0.0, "max_step": 1e-3, "tolerance": 1e-9, "revolutions": 1,
        "period": 0.25,
    },
}  # fmt: skip


def ideal(spec, **changes):
    """Return a spec with its clearances closed and other changes."""
    return mechanism_from(changed(spec, changes), clearance=0.0)


def test_a_pendulum_on_a_dropped_pin_is_that_of_scipy_with_the_exported_joint():
    mechanism = mechanism_from(PENDULUM, restitution=0.7)
    run = simulate(mechanism, tolerance=1e-11)
    joint = module_of(mechanism.clearance.contact)
    rate, still = joint.start(), [0.0] * 6

    def right(_, y):
        w = joint.evaluate(rate, y, still)
        force = np.array(w.force_bearing) if rate else np.zeros(2)
        moment = (w.moment_bearing if rate else 0.0) - 3.0 * (y[2] + np.radians(40)) - 0.01 * y[5]
        return [*y[3:], force[0] / 0.8, force[1] / 0.8 - 9.81, moment / 2e-3]

    def gap(_, y):
        return joint.evaluate(rate, y, still).penetration * 1e3

    gap.terminal = True
    t, y, onsets = 0.0, np.array([0.08, 0, 0, 0, 0, 0.0]), []
    while t < 0.25 and len(onsets) < 12:
        gap.direction = -1.0 if rate else 1.0
        path = solve_ivp(
            right, (t, 0.25), y, DOP853, events=gap, rtol=1e-11, atol=1e-14,
            max_step=2e-6 if rate else 1e-3, first_step=1e-9,
        )  # fmt: skip
        t, y = float(path.t[-1]), path.y[:, -1]
        if t < 0.25:
            onsets += [] if rate else [t]
            rate = 0.0 if rate else max(joint.evaluate(0.0, y, still).penetration_rate, 1e-3)
    assert len(onsets) >= 5
    ours = run.contacts["onset_s"].to_numpy()[: len(onsets)]
    np.testing.assert_allclose(ours, onsets, rtol=0, atol=1e-6)
    assert np.abs(run.energy_error).max() < 1e-8
    assert run.damping[-1] > 1e-4


def test_an_ideal_pendulum_with_spring_damper_and_load_is_that_of_scipy():
    """One equation for the angle; a linear spring, a torsional damper, a force and a moment."""
    about = {
        "spring": [
            {"between": ["ground", "rod"], "stiffness": 0.5, "damping": 0.02, "angle": 30.0},
            {"between": ["ground.post", "rod.end"], "stiffness": 200.0, "damping": 1.5,
             "length": 0.05},
        ],
        "load": [{"at": "rod.end", "force": [2.0, -3.0], "moment": 0.1}],
    }  # fmt: skip
    run = simulate(ideal(PENDULUM, **about), tolerance=1e-11)
    inertia = 2e-3 + 0.8 * 0.08**2

    def right(_, y):
        angle, spin = y
        u, w = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        way = 0.16 * u - [0.1, 0.0]
        distance = np.hypot(*way)
        along = way / distance
        pull = 200.0 * (distance - 0.05) + 1.5 * 0.16 * spin * (w @ along)
        force = [2.0, -3.0] - pull * along
        moment = 0.16 * (w @ force) + 0.08 * w @ [0, -9.81 * 0.8] + 0.1
        return [spin, (moment - 0.5 * (angle - np.radians(30)) - 0.02 * spin) / inertia]

    path = solve_ivp(right, (0, 0.25), [0.0, 0.0], DOP853, rtol=1e-12, atol=1e-12, t_eval=run.time)
    assert run.coordinates[:, 0, 2] == pytest.approx(path.y[0], abs=1e-9)
    assert np.abs(run.energy_error).max() < 1e-9
    assert run.damping[-1] > 1e-3


def test_a_driving_torque_does_its_work():
    """Without gravity a rotor gains M·θ, and turns by M·t²/2J."""
    drive = {"name": "motor", "type": "driver", "between": ["ground", "rod"], "torque": 0.3}
    rotor = {"spring": [], "gravity": [0.0, 0.0], "joint": [*PENDULUM["joint"], drive]}
    run = simulate(ideal(PENDULUM, **rotor), tolerance=1e-11)
    angle = run.coordinates[:, 0, 2]
    inertia = 2e-3 + 0.8 * 0.08**2
    assert angle == pytest.approx(0.3 * run.time**2 / (2 * inertia), abs=1e-9)
    assert run.drive_work == pytest.approx(0.3 * angle, abs=1e-9)
    assert run.kinetic_energy == pytest.approx(run.drive_work, abs=1e-8)


def test_a_driver_reaches_its_speed_smoothly():
    speed, ramp, step = -40.0, 0.02, 1e-6
    for t in (0.004, 0.011, 0.019):
        before, at, after = (driven(t + sign * step, speed, ramp) for sign in (-1, 0, 1))
        for n, tolerance in ((0, 1e-6), (1, 1e-4)):
            slope = (after[n] - before[n]) / (2 * step)
            assert at[n + 1] == pytest.approx(slope, abs=tolerance)
    assert driven(0.05, speed, ramp)[:2] == pytest.approx((speed * (0.05 - ramp / 2), speed))
    slow = mechanism_from(changed(SLIDER_CRANK, {"joint.drive.ramp": ramp}))
    assert recognise(slow) is None
    run = simulate(slow, revolutions=3)
    assert np.abs(run.velocities[0]).max() == 0.0
    assert run.velocities[run.time > ramp, 0, 2] == pytest.approx(slow.driver.speed, rel=1e-9)
    assert np.abs(run.energy_error).max() < 1e-7 * run.kinetic_energy.max()
