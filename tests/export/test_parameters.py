"""Parameters of codes' own contacts: refitted, integrated and run by other means, and the command.

The formulas below are typed from the pages of the codes, in the units of their parameters; MuJoCo
and Exudyn run their own contact.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import minimize

from cylcontact import dissipation
from cylcontact.export import CODES, contact_parameters
from cylcontact.mechanism import joint_from, read_joint
from tests.support.programs import require_package
from tests.support.spec_files import changed

JOINT = Path(__file__).resolve().parents[2] / "datasets/joint.toml"
PIN = {
    "name": "pin", "units": "SI", "length": 10.0, "law": "explicit",
    "bearing": {"R": 10.0, "E": 207.0, "nu": 0.3}, "pin": {"R": 9.95, "E": 207.0, "nu": 0.3},
    "dissipation": {"factor": "exact", "restitution": 0.9},
    "friction": {"coefficient": 0.1, "v0": 1.0, "v1": 10.0},
}  # fmt: skip
LOW, HIGH = 100.0, 10000.0
EACH = pytest.mark.parametrize("code", CODES)


@cache
def parameters_of(code, restitution=0.9, mass=0.5, speed=None, law="explicit"):
    joint = joint_from(changed(PIN, {"dissipation.restitution": restitution, "law": law}))
    return contact_parameters(joint, code, LOW, HIGH, mass, speed)


def law_at(force):
    """The penetration in mm of the law under total forces in N."""
    joint = joint_from(PIN)
    return joint.law.penetration(np.asarray(force) / 10.0, joint.pair)


# --- elastic ---


def test_adams_default_is_far_too_soft():
    default = (np.array([100.0, 1e3, 1e4]) / 1e5) ** (1 / 2.2)  # mm, of K = 1e5 N/mm^e and e = 2.2
    np.testing.assert_allclose(default / law_at([100.0, 1e3, 1e4]), [196, 79, 37], rtol=0.01)
    p = parameters_of("adams")
    assert (p.values["K"], p.values["e"]) == pytest.approx((2.72e6, 1.219), rel=3e-3)
    assert p.force_error[0] < 0.065


@pytest.mark.parametrize(
    ("code", "name", "unit", "power"),
    [
        ("adams", "K", 1.0, "e"),
        ("exudyn", "contactStiffness", 1e-3, "contactStiffnessExponent"),
        ("chrono", "kn", 1e-3, None),
        ("simscape", "stiffness", 1e-3, None),
        ("drake", "point_contact_stiffness", 1e-3, None),
    ],
)
def test_no_power_or_line_is_closer_than_the_fitted_one(code, name, unit, power):
    force = np.geomspace(LOW, HIGH, 200)
    depth = law_at(force) * unit

    def spread(p):
        return np.mean((p[0] + (p[1] if power else 1.0) * np.log(depth) - np.log(force)) ** 2)

    best = minimize(
        spread, (15.0, 1.0), method="Nelder-Mead",
        options={"xatol": 1e-10, "fatol": 1e-16, "maxiter": 4000},
    ).x  # fmt: skip
    values = parameters_of(code).values
    both = 2 if code == "drake" else 1  # in Drake each body has twice the stiffness of the pair
    assert values[name] == pytest.approx(both * np.exp(best[0]), rel=1e-6)
    assert power is None or values[power] == pytest.approx(best[1], rel=1e-6)


@EACH
def test_the_errors_are_those_of_the_codes_force_over_the_range(code):
    p = parameters_of(code)
    joint, force = joint_from(PIN), np.geomspace(LOW, HIGH, 2001)
    depth = law_at(force)
    ratio = p.force(1e-3 * depth) / force
    assert p.force_error[0] == pytest.approx(np.abs(ratio - 1).max(), rel=1e-3)
    assert p.force_error[1] == pytest.approx(np.sqrt(np.mean((ratio - 1) ** 2)), rel=0.02)
    slope = np.gradient(p.force(1e-3 * depth), depth)
    ratio = slope / (10.0 * joint.law.stiffness(depth, joint.pair))
    assert p.stiffness_error[1] == pytest.approx(np.sqrt(np.mean((ratio - 1) ** 2)), rel=0.03)
    assert p.force([0.0, -1e-6]).tolist() == [0.0, 0.0]


# --- damping ---


def mm_adams(v, x, K, e, c_max, d_max):
    ramp = min(x / d_max, 1.0)
    return max(K * x**e + c_max * ramp * ramp * (3 - 2 * ramp) * v, 0.0)


def m_simscape(v, x, stiffness, damping, transition_region_width):
    ramp = min(x / transition_region_width, 1.0)
    return max(ramp * ramp * (3 - 2 * ramp) * (stiffness * x + damping * v), 0.0)


def bounce(force, mass, speed, time):
    """Restitution and largest x by another integrator, with short steps; mass as for the force."""

    def apart(_, state):
        return state[0]

    apart.terminal, apart.direction = True, -1.0
    run = solve_ivp(
        lambda _, s: (s[1], -force(s[1], max(s[0], 0.0)) / mass), (0.0, 1e3 * time), (0.0, speed),
        "DOP853", rtol=1e-10, atol=1e-13 * speed * np.array([time, 1.0]), max_step=time / 50,
        events=apart,
    )  # fmt: skip
    return -run.y[1, -1] / speed, run.y[0].max()


@pytest.mark.parametrize("restitution", [0.3, pytest.param(0.9, marks=pytest.mark.slow)])
@pytest.mark.parametrize("code", ["adams", "simscape"])
def test_the_bounce_of_the_typed_formula(code, restitution):
    p = parameters_of(code, restitution)
    # Adams in mm, s and N: masses in tonnes.
    typed, mass, unit = (mm_adams, 5e-4, 1e3) if code == "adams" else (m_simscape, 0.5, 1.0)
    time = np.sqrt(0.5 / 6.6e8)
    bounced = [
        bounce(lambda v, x: typed(v, x, **p.values), mass, unit * factor * p.speed, time)[0]
        for factor in (1.0, 0.5, 2.0)
    ]
    np.testing.assert_allclose(p.restitution, bounced, atol=1e-6)
    assert bounced[0] == pytest.approx(restitution, abs=1e-6)


@pytest.mark.parametrize(
    "restitution",
    [0.05, 0.9, *(pytest.param(e, marks=pytest.mark.slow) for e in (0.5, 0.99))],
)
def test_drakes_and_chronos_bounces_are_closed_forms(restitution):
    """Chrono's spring does not pull: Schwager and Pöschel, Granular Matter 9 (2007) 465."""
    p = parameters_of("drake", restitution)
    chi = p.values["hunt_crossley_dissipation"] * p.speed
    assert chi == pytest.approx(float(dissipation.exact_factor(restitution)), rel=1e-5)
    closed = dissipation.achieved_restitution(chi * np.array([1.0, 0.5, 2.0]))
    np.testing.assert_allclose(p.restitution, closed, atol=1e-6)
    p = parameters_of("chrono", restitution)
    np.testing.assert_allclose(p.restitution, restitution, atol=1e-6)
    decay, natural = p.values["gn"] / 2, np.sqrt(p.values["kn"] / p.mass)
    omega = np.sqrt(complex(natural**2 - decay**2))
    released = np.log((decay + 1j * omega) / (decay - 1j * omega)) / (1j * omega)
    assert np.exp(-decay * released.real) == pytest.approx(restitution, abs=1e-6)


@EACH
def test_the_joints_own_restitution_is_matched(code):
    p, own, time = parameters_of(code), joint_from(PIN), np.sqrt(0.5 / 6.6e8)

    def force(v, x, chi=own.chi):
        return 10.0 * float(own.law.load(1e3 * x, own.pair)) * (1 + chi * v / p.speed)

    assert p.restitution[0] == pytest.approx(bounce(force, 0.5, p.speed, time)[0], abs=1e-6)
    # The default speed is that of an impact which rises to the middle of the range.
    _, deepest = bounce(lambda v, x: force(v, x, 0.0), 0.5, p.speed, time)
    assert 1e3 * deepest == pytest.approx(float(law_at(np.sqrt(LOW * HIGH))), rel=5e-3)
    np.testing.assert_allclose(parameters_of(code, 1.0).restitution, 1.0, atol=1e-6)


# --- the codes themselves ---

FALL = """
<mujoco><option timestep="{step}" gravity="0 0 0" integrator="RK4"/><worldbody>
<geom type="plane" size="1 1 1" condim="1" solref="{solref}" solimp="{solimp}"/>
<body pos="0 0 .1"><joint type="slide" axis="0 0 1"/>
<geom type="sphere" size=".1" mass="{mass}" condim="1" solref="{solref}" solimp="{solimp}"/>
</body></worldbody></mujoco>
"""


@pytest.mark.parametrize("mass", [0.5, 2.0])
def test_mujocos_own_contact_has_the_force_and_the_bounce(mass):
    mujoco = require_package("mujoco")
    p = parameters_of("mujoco", mass=mass)
    numbers = {name: " ".join(map(repr, value)) for name, value in p.values.items()}
    step = 4e-7 * np.sqrt(mass)
    model = mujoco.MjModel.from_xml_string(FALL.format(mass=mass, step=step, **numbers))
    data = mujoco.MjData(model)
    for x in (1e-7, 1e-6, 5e-6, 2e-5, 5e-5):
        for v in (-0.01, 0.0, 0.01):
            data.qpos[0], data.qvel[0] = -x, -v
            mujoco.mj_forward(model, data)
            assert data.qfrc_constraint[0] == pytest.approx(float(p.force(x, v)), rel=1e-8)
    for factor, wanted in zip((1.0, 0.5, 2.0), p.restitution, strict=True):
        data.qpos[0], data.qvel[0] = 1e-9, -factor * p.speed
        while data.qpos[0] <= 1e-9 or data.qvel[0] < 0:
            mujoco.mj_step(model, data)
        assert data.qvel[0] / (factor * p.speed) == pytest.approx(wanted, abs=2e-4)


@pytest.mark.parametrize("restitution", [0.2, 0.9])
def test_exudyns_own_contact_has_the_bounce_at_each_speed(restitution):
    exu = require_package("exudyn")
    items = require_package("exudyn.itemInterface")
    p = parameters_of("exudyn", restitution)
    for factor, wanted in zip((1.0, 0.5, 2.0), p.restitution, strict=True):
        speed = factor * p.speed
        system = exu.SystemContainer().AddSystem()
        node = system.AddNode(items.NodeRigidBody2D(initialVelocities=[speed, 0, 0]))
        pin = items.ObjectRigidBody2D(mass=0.5, inertia=1e-3, nodeNumber=node)
        bodies = [system.AddObject(pin), system.AddObject(items.ObjectGround())]
        markers = [system.AddMarker(items.MarkerBodyRigid(bodyNumber=body)) for body in bodies]
        data = items.NodeGenericData(numberOfDataCoordinates=4, initialCoordinates=[0.0] * 4)
        contact = items.ObjectContactSphereSphere(
            markerNumbers=markers, nodeNumber=system.AddNode(data), isHollowSphere1=True,
            spheresRadii=[9.95e-3, 10e-3], **p.values,
        )  # fmt: skip
        system.AddObject(contact)
        system.Assemble()
        settings = exu.SimulationSettings()
        time = settings.timeIntegration
        time.endTime = 5e-5 / speed + 1e-3
        time.numberOfSteps, time.verboseMode = round(time.endTime / 2e-7), 0
        time.discontinuous.useRecommendedStepSize = False
        settings.solution.file.write = False
        system.SolveDynamic(settings, solverType=exu.DynamicSolverType.TrapezoidalIndex2)
        rate = system.GetNodeOutput(node, exu.OutputVariableType.Coordinates_t)[0]
        assert -rate / speed == pytest.approx(wanted, abs=1e-5)
        assert wanted == pytest.approx(restitution, abs=1e-6)


# --- the command ---


def test_the_command_prints_the_parameters(run, tmp_path):
    command = ("export", "--joint", JOINT, "--to", "adams", "--range", "100:5000")
    assert run(*command) == (
        0,
        f"{contact_parameters(read_joint(JOINT), 'adams', 100, 5000)}\n",
        "",
    )
    out = tmp_path / "new" / "contact.txt"
    options = ("--mass", "0.5", "--speed", "0.4", "-o", out)
    assert run(*command, *options) == (0, f"wrist-pin written to {out}\n", "")
    at_speed = contact_parameters(read_joint(JOINT), "adams", 100, 5000, 0.5, 0.4)
    assert out.read_text(encoding="ascii") == f"{at_speed}\n"
