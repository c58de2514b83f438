"""The joint as a force element: the library's own, and its exports along whole trajectories."""

from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, impact, laws
from cylcontact.export import export_joint
from cylcontact.files.spec import read_toml
from cylcontact.fitting.adapters import ScaledLaw
from cylcontact.joint.contact import BEYOND_LAW, LEFT_HOLE, NOT_A_NUMBER, YIELDS
from cylcontact.mechanism import JointState, joint_from, read_joint, simulate
from tests.support.export_runners import compile_with, run_program
from tests.support.joint_runners import RUNNERS, run_c, run_library, write
from tests.support.mechanism_cases import slider_crank
from tests.support.spec_files import DROP, changed

ROOT = Path(__file__).resolve().parents[2]
CPP = r"""
#include <cstdio>
#include "element.h"
int main() {
    const double bearing[6] = {}, pin[6] = {};
    pin_state state;
    pin_wrench wrench;
    pin_start(&state);
    pin_evaluate(&state, bearing, pin, &wrench);
    std::printf("%d\n", wrench.flag);
}
"""
JOINT = read_toml(ROOT / "datasets/joint.toml")
ALUMINIUM = {"E": 69.0, "nu": 0.33}
STEEL = {"E": 207.0, "nu": 0.3}
CASES = [("johnson", 0.02), ("enhanced", 0.5), ("explicit", 0.5), ("conformal", 0.02)]
each_case = pytest.mark.parametrize("case", CASES, ids="{0[0]}-{0[1]}".format)
# In the order of the columns that a runner answers.
FORCES, MOMENTS, LENGTHS, RATES = [0, 1, 3, 4, 8, 9], [2, 5], [6], [7, 10, 13]
NORMAL, POWER, FLAG = 8, 11, 12


def joint_for(law, clearance, units="SI", **changes):
    """Return the joint of the slider-crank; conformal is the law for its unlike materials."""
    pin = ALUMINIUM if law == "conformal" else STEEL
    data = {
        "name": f"{law}-{clearance}", "units": units, "length": 10.0, "law": law,
        "bearing": {"R": 10.0, **STEEL}, "pin": {"R": 10.0 - clearance, **pin},
        "dissipation": {"factor": "lankarani-nikravesh", "restitution": 0.9},
        "friction": {"coefficient": 0.1, "v0": 1.0, "v1": 10.0},
    }  # fmt: skip
    return joint_from(changed(data, changes))


@cache
def run_of(law, clearance):
    """Two revolutions of the slider-crank with that joint."""
    mechanism = replace(slider_crank(), joint=joint_for(law, clearance))
    return simulate(mechanism, revolutions=2, beyond="tangent")


def rows_of(run, relative=True):
    """Return impact rate and motion at every recorded state, to the bodies' own centres of mass.

    Relative ones put the origin into the centre of the hole: what a trajectory in minimal
    coordinates knows of the joint exactly.
    """
    motion, floor = run.motion, run.mechanism.joint.rate_floor
    rows = np.zeros((run.time.size, 13))
    rows[:, 0] = np.where(run.in_contact, np.maximum(run.impact_rate, floor), 0.0)
    arm = 0.06 * np.exp(1j * motion.rod_angle)
    rod = motion.crank_pin + arm
    speed = 1j * run.mechanism.omega * motion.crank_pin + 1j * motion.rod_spin * arm
    rows[:, 1:7] = np.column_stack(
        (rod.real, rod.imag, motion.rod_angle, speed.real, speed.imag, motion.rod_spin)
    )
    rows[:, 7], rows[:, 10] = motion.slider_position, motion.slider_velocity
    if relative:
        rows[:, 1:3] = rows[:, 4:6] = 0.0
        rows[:, 7:9], rows[:, 10:12] = -run.eccentricity, -run.eccentricity_rate
    return rows


def with_arms(case, **changes):
    """Return a joint 60 mm from the rod's centre of mass and beside the pin's, and its motions."""
    points = {"bearing.point": [60.0, 0.0], "pin.point": [30.0, -20.0]}
    rows = rows_of(run_of(*case), relative=False)
    arm = np.exp(1j * rows[:, 9]) * complex(0.03, -0.02)
    rows[:, 7:9] -= np.column_stack([arm.real, arm.imag])
    rows[:, 10:12] -= rows[:, 12:] * np.column_stack([-arm.imag, arm.real])
    return joint_for(*case, **points, **changes), rows


def assert_close(actual, wanted, tolerance):
    """Compare answers, each to a part of the largest of its kind."""
    for columns in (FORCES, MOMENTS, LENGTHS, RATES, [POWER]):
        peak = np.abs(wanted[:, columns]).max()
        np.testing.assert_allclose(
            actual[:, columns], wanted[:, columns], rtol=0, atol=tolerance * peak
        )
    np.testing.assert_array_equal(actual[:, FLAG], wanted[:, FLAG])


# --- the library's own ---


@each_case
def test_the_joint_gives_the_trajectorys_own_forces(case):
    run, joint = run_of(*case), joint_for(*case)
    answers = run_library(joint, rows_of(run))
    peak, touching = run.normal_force.max(), run.in_contact
    own = np.column_stack([run.force, -run.force, run.normal_force, run.friction_force])
    np.testing.assert_allclose(
        answers[touching][:, FORCES], own[touching], rtol=0, atol=1e-12 * peak
    )
    # The row of an event, before the contact begins, may be deep in by the rounding of its time.
    free = answers[~touching]
    assert np.abs(free[:, FORCES]).max() <= 1e-10 * peak
    assert (free[free[:, 6] <= 0][:, [*FORCES, *MOMENTS, POWER, FLAG]] == 0).all()
    np.testing.assert_allclose(answers[:, 6], run.penetration, rtol=0, atol=1e-18)
    np.testing.assert_allclose(answers[:, 7], run.penetration_rate, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(answers[:, 10], run.tangential_velocity, rtol=1e-12, atol=1e-12)
    # The power is what the ledgers add up; its integral by the trapezoidal rule.
    lost = run.normal_dissipation + run.friction_dissipation
    assert np.trapezoid(answers[:, POWER], run.time) == pytest.approx(lost[-1], rel=5e-3)


@each_case
def test_forces_and_moments_balance_and_dissipate(case):
    joint, rows = with_arms(case)
    answers = run_library(joint, rows)
    force, moment, opposite = answers[:, :2], answers[:, MOMENTS], answers[:, 3:5]
    peak = np.abs(force).max()
    assert peak > 1e4
    np.testing.assert_array_equal(force, -opposite)
    about_origin = (
        moment.sum(axis=1)
        + rows[:, 1] * force[:, 1] - rows[:, 2] * force[:, 0]
        + rows[:, 7] * opposite[:, 1] - rows[:, 8] * opposite[:, 0]
    )  # fmt: skip
    np.testing.assert_allclose(about_origin, 0.0, atol=1e-13 * peak)
    assert (answers[:, POWER] >= 0).all()
    assert answers[:, POWER].max() > 0
    # The power of the wrench, by the motion of the bodies, is what is lost and what is stored.
    power = (
        (force * rows[:, 4:6]).sum(axis=1) + (opposite * rows[:, 10:12]).sum(axis=1)
        + (moment * rows[:, [6, 12]]).sum(axis=1)
    )  # fmt: skip
    elastic, _ = with_arms(case, **{"dissipation.restitution": 1.0, "friction.coefficient": 0.0})
    stored = run_library(elastic, rows)[:, NORMAL] * answers[:, 7]
    balance = power + answers[:, POWER] + stored
    np.testing.assert_allclose(balance, 0.0, atol=1e-12 * peak * np.abs(rows[:, 3:]).max())


@pytest.mark.parametrize("law", laws.LAWS)
@pytest.mark.parametrize("clearance", [0.5, 0.02])
def test_the_forces_are_those_of_the_law_the_dissipation_and_the_friction(law, clearance):
    joint = joint_for(law, clearance)
    depths, rates, slips = (1e-9, 1e-7, 3e-6), (-1.0, 0.0, 0.4), (-3.0, -5e-3, -5e-4, 0.0, 2e-2)
    depth, rate, slip = np.array(list(product(depths, rates, slips))).T
    still = 0 * depth
    pin = np.column_stack([still, 1e-3 * joint.radial + depth, still, slip, rate, still])
    wrench = joint.evaluate(JointState(0.7), np.zeros(6), pin)
    elastic = joint.law.load(depth * 1e3, joint.pair) * 10.0
    normal = impact.dissipative_load(elastic, rate * 1e3, 0.7e3, joint.chi)
    # δ is a difference of numbers of the size of the clearance.
    digits = 1e-8 + 1e-18 / depth
    assert (np.abs(wrench.normal_force - normal) <= digits * normal).all()
    np.testing.assert_allclose(wrench.force_pin[:, 1], -wrench.normal_force, rtol=1e-12)
    friction = impact.friction_load(wrench.normal_force, slip * 1e3, 0.1, 1.0, 10.0)
    np.testing.assert_allclose(wrench.force_pin[:, 0], friction, rtol=0, atol=1e-9)
    lost = (wrench.normal_force - elastic) * rate - friction * slip
    np.testing.assert_allclose(wrench.dissipated_power, lost, rtol=1e-6, atol=1e-9)


def test_the_force_never_pulls():
    joint = joint_for("enhanced", 0.5, **{"dissipation.restitution": 0.3})
    pin = [0.0, 1e-3 * joint.radial + 1e-6, 0.0, 0.0, -50.0, 0.0]
    wrench = joint.evaluate(JointState(1.0), np.zeros(6), pin)
    assert wrench.penetration > 0
    assert (wrench.normal_force, *wrench.force_pin) == (0, 0, 0)


# --- in other languages ---


def in_all_states(joint):
    """Return motions without contact, in contact, beyond yield, the law's end and the hole."""
    return np.array([
        [rate, *bearing, *pin]
        for rate in (0.0, 0.002, 0.5)
        for part in (0.0, 0.5, 1.0 + 1e-9, 1.1, 1.4, 3.0, 1200.0)
        for speed in (-0.3, 0.0, 1e-5, 0.1, 50.0)
        for bearing, pin in [motion(joint, part, speed, spin=3.0)]
    ])  # fmt: skip


def without_a_number():
    """Return motions with each number of both bodies unknown, and one with none."""
    rows = np.tile([0.0, *[0.0] * 6, 1e-4, 0.0, 0.0, 0.3, 0.0, 0.0], (13, 1))
    np.fill_diagonal(rows[:12, 1:], np.nan)
    return rows


def assert_equal_without_numbers(answers, wanted):
    np.testing.assert_array_equal(np.isnan(answers), np.isnan(wanted))
    np.testing.assert_array_equal(answers[:, FLAG], wanted[:, FLAG])


SOFT = {"bearing.yield_stress": 60.0, "pin.yield_stress": 120.0}


# tests/export has the formula of each law in each language.
@pytest.mark.parametrize(
    ("language", "law"),
    [("c", "enhanced"), ("c", "explicit"),
     *product(RUNNERS, ("johnson", "conformal", "a table"))],
)  # fmt: skip
def test_exports_agree_along_a_trajectory_and_in_all_states(language, law, tmp_path):
    case = next((case for case in CASES if case[0] == law), ("explicit", 0.5))
    joint = joint_for(*case, **SOFT)
    if law == "a table":  # a law without a formula
        joint = replace(joint, law=ScaledLaw(laws.Liu(), 0.7, 1.5))
    parts = rows_of(run_of(*case))[:: 8 if language == "matlab" else 1], in_all_states(joint)
    ends = np.cumsum([len(part) for part in parts])
    rows = np.vstack([*parts, without_a_number()])
    answers, wanted = RUNNERS[language](joint, rows, tmp_path), run_library(joint, rows)
    # A file has a coarser curve of conformal contact.
    coarse = law == "conformal"
    along, others = (np.split(each, ends) for each in (answers, wanted))
    assert_close(along[0], others[0], 1e-8 if coarse else 1e-12)
    np.testing.assert_allclose(along[1], others[1], rtol=1e-8 if coarse else 1e-9, atol=1e-9)
    flags, deepest = set(others[1][:, FLAG]), YIELDS + LEFT_HOLE
    deepest += BEYOND_LAW if law in ("johnson", "a table") else 0
    assert {0, YIELDS, deepest} <= flags <= {0, YIELDS, YIELDS + BEYOND_LAW, deepest}
    assert_equal_without_numbers(along[2], others[2])


@pytest.mark.parametrize("language", RUNNERS)
def test_exports_agree_where_the_bodies_have_arms_and_in_mm(language, tmp_path):
    joint, rows = with_arms(("explicit", 0.5))
    rows = rows[::8]
    wanted, joint = run_library(joint, rows), replace(joint, units="mm")
    rows[:, [0, 1, 2, 4, 5, 7, 8, 10, 11]] *= 1e3  # all inputs but angles and spins
    both = np.vstack([rows, without_a_number()])
    answers, of_library = RUNNERS[language](joint, both, tmp_path), run_library(joint, both)
    assert_equal_without_numbers(answers[len(rows) :], of_library[len(rows) :])
    answers, of_library = answers[: len(rows)], of_library[: len(rows)]
    assert_close(answers, of_library, 1e-12)
    answers[:, [*MOMENTS, *LENGTHS, *RATES, POWER]] /= 1e3
    # On the surface rounding decides whether there is a contact.
    decided = np.abs(wanted[:, 6]) > 1e-15
    assert decided.mean() > 0.95
    assert_close(answers[decided], wanted[decided], 1e-9)


# --- how it is called ---

DEEP, CLEAR = 1.01, 0.5  # of the clearance


def motion(joint, part, rate, spin=0.0):
    """Return a bearing at rest and a pin moving outwards along (0.6, 0.8), in the joint's units."""
    away = part * float(joint.pair.dR) / joint.in_mm
    pin = [0.6 * away, 0.8 * away, 0.0, 0.6 * rate, 0.8 * rate, spin]
    return [0.0] * 6, pin


def accepted(joint, state, *moves):
    """Return the state after some accepted steps."""
    for move in moves:
        state = joint.accept(state, *motion(joint, *move))
    return state


def test_accept_keeps_the_rate_of_the_first_touch_until_the_contact_ends():
    joint = joint_for("explicit", 0.05)
    assert joint.start() == (0.0,)
    free = accepted(joint, joint.start(), (CLEAR, 0.3))
    touched = accepted(joint, free, (DEEP, 0.3))
    pressed = accepted(joint, touched, (DEEP, 2.0), (DEEP, -0.2))
    assert free.impact_rate == 0.0
    assert touched.impact_rate == pytest.approx(0.3, rel=1e-12)
    assert pressed == touched
    assert accepted(joint, pressed, (CLEAR, -0.2)).impact_rate == 0.0
    # Too slow, or leaving: the floor.
    for rate in (1e-6, -0.5):
        assert accepted(joint, joint.start(), (DEEP, rate)).impact_rate == joint.rate_floor == 1e-3


def test_evaluate_is_pure_and_takes_a_trial_step_across_the_onset_as_it_is():
    joint = joint_for("explicit", 0.05, **{"friction.coefficient": 0.0})
    state, move = joint.start(), motion(joint, DEEP, 0.3)
    trial, again = (joint.evaluate(state, *move) for _ in range(2))
    kept = joint.evaluate(joint.accept(state, *move), *move)
    assert state == joint.start()
    assert trial.normal_force == again.normal_force == kept.normal_force
    elastic = float(joint.law.load(trial.penetration * 1e3, joint.pair)) * 10.0
    assert trial.normal_force == pytest.approx(elastic * (1 + joint.chi), rel=1e-12)


def test_a_grazing_start_cannot_make_the_damping_run_away():
    joint = joint_for("explicit", 0.05)
    grazing = accepted(joint, joint.start(), (DEEP, 1e-9))
    for rate in (1e-3, 0.1, 10.0, 1e4):
        wrench = joint.evaluate(grazing, *motion(joint, DEEP, rate))
        elastic = float(joint.law.load(wrench.penetration * 1e3, joint.pair)) * 10.0
        wanted = impact.dissipative_load(elastic, rate * 1e3, 1.0, joint.chi)
        assert wrench.normal_force == pytest.approx(float(wanted), rel=1e-9)
        assert wrench.normal_force <= elastic * (1 + 20 * joint.chi)


def test_centres_that_coincide_have_a_normal():
    joint = joint_for("explicit", 0.05)
    wrench = joint.evaluate(joint.start(), [0.0] * 6, [0.0, 0.0, 0.0, -0.2, 0.1, 0.0])
    assert wrench.penetration == pytest.approx(-5e-5, rel=1e-12)
    assert wrench.penetration_rate == 0.2
    assert (wrench.force_bearing == 0).all()


@pytest.mark.parametrize("points", [((3.0, 2.0), (1.0, 4.0)), ((0.0, 0.0), (0.0, 0.0))])
def test_a_motion_that_is_not_a_number_has_no_force_and_no_impact_rate(points):
    pin, bearing = points
    joint = joint_for("explicit", 0.05, **{"pin.point": pin, "bearing.point": bearing})
    answers = run_library(joint, without_a_number())
    assert np.isnan(answers[:12, :6]).all()
    speeds = [3, 4, 9, 10] if points == ((0.0, 0.0), (0.0, 0.0)) else range(12)
    assert np.isnan(answers[[0, 1, 2, 6, 7, 8, *speeds], 13]).all()
    assert np.isfinite(answers[12]).all()
    none = answers[:, FLAG].astype(int) & NOT_A_NUMBER
    assert (none == [NOT_A_NUMBER] * 12 + [0]).all()


def test_states_may_be_arrays():
    joint = joint_for("conformal", 0.05)
    bearing, pin = motion(joint, DEEP, 0.1, spin=30.0)
    pins = np.tile(pin, (2, 3, 1))
    pins[1] *= CLEAR
    state = joint.accept(joint.start(), bearing, pins)
    wrench, one = joint.evaluate(state, bearing, pins), joint.evaluate(joint.start(), bearing, pin)
    assert state.impact_rate.shape == wrench.flag.shape == (2, 3)
    assert wrench.force_pin.shape == (2, 3, 2)
    assert (wrench.force_pin[0] == one.force_pin).all()
    assert (wrench.force_pin[1] == 0).all()


def test_the_flag_says_first_yield_the_end_of_the_law_and_a_pin_that_left_its_hole():
    soft = {"bearing.yield_stress": 100.0, "pin.yield_stress": 200.0}
    joint = joint_for("johnson", 0.05, **soft)
    last = joint.block["last_penetration"]
    assert last == pytest.approx(0.9 * float(joint.law.max_penetration(joint.pair)))
    yields = float(joint.law.penetration(joint.first_yield / 10.0, joint.pair))
    assert yields < last
    flags = [
        int(joint.evaluate(joint.start(), *motion(joint, 1 + delta / 0.05, 0.1)).flag)
        for delta in (0.99 * yields, 1.01 * yields, 0.999 * last, 1.001 * last)
    ]
    assert flags == [0, YIELDS, YIELDS, YIELDS + BEYOND_LAW]
    deepest = [motion(joint, 1 + delta / 0.05, 0.1) for delta in (0.999, 1.001)]
    flags = [int(joint.evaluate(joint.start(), *bodies).flag) for bodies in deepest]
    assert flags == [YIELDS + BEYOND_LAW, YIELDS + BEYOND_LAW + LEFT_HOLE]
    unknown = joint_for("johnson", 0.05, **{"pin.yield_stress": 200.0})
    assert unknown.first_yield == np.inf
    assert unknown.evaluate(unknown.start(), *motion(unknown, 1.9, 0.1)).flag == BEYOND_LAW


@pytest.mark.parametrize("layer", [{}, {"yield_stress": 300.0}], ids=["unknown", "known"])
def test_a_joint_with_a_layer_evaluates_and_exports(layer):
    """First yield is unknown without the layer's yield stress."""
    layers = [{"R_i": 12.0, "E": 70.0, "nu": 0.33, **layer}]
    stresses = {"bearing.yield_stress": 300.0, "pin.yield_stress": 300.0}
    housing = {"R_o": 20.0, "layers": layers}
    joint = joint_for("conformal", 0.05, housing=housing, **stresses)
    assert joint.can_yield == np.isfinite(joint.first_yield) == bool(layer)
    assert joint.evaluate(joint.start(), *motion(joint, 1.1, 0.1)).normal_force > 0
    for target in RUNNERS:
        assert export_joint(joint, target)


# --- what it says ---


def test_the_header_is_for_cpp_too(tmp_path):
    (tmp_path / "main.cpp").write_text(CPP, encoding="ascii")
    source = write(joint_for("explicit", 0.05, name="pin"), "c", tmp_path)
    compile_with("gcc", "-std=c99", "-c", source, "-o", tmp_path / "element.o")
    files = tmp_path / "main.cpp", tmp_path / "element.o"
    flags = ("-std=c++11", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Werror")
    compile_with("g++", *flags, *files, "-o", tmp_path / "main", "-lm")
    assert run_program(tmp_path / "main") == "0\n"


@pytest.mark.parametrize("target", RUNNERS)
def test_no_name_breaks_out_of_its_comment(target):
    joint = joint_for("explicit", 0.05, name='a \n b */ \\ é ??/ \'""" $c {d}')
    origin = "fit result 'x\n*/ ??/ \\"
    texts = export_joint(replace(joint, origin=origin), target)
    assert all(name.startswith("a_b_c_d") for name in texts)
    together = "\n".join(texts.values())
    assert "??" not in together
    assert not set(together) & set("é\\$")


def test_the_check_in_the_comment_is_what_the_element_gives(tmp_path):
    joint = joint_for("explicit", 0.05, "mm", **{"bearing.point": [30.0, -4.0]})
    text = export_joint(joint, "c")["explicit_0_05.h"].partition("// Check:")[2]
    lines = [line.split(maxsplit=2)[1:] for line in text.splitlines()[1:9] if "with" not in line]
    shown = {name: np.array(numbers.split(", "), float) for name, numbers in lines if "," in numbers
             or name in ("impact_rate", "moment_pin", "moment_bearing", "penetration")}  # fmt: skip
    row = np.hstack([shown[name] for name in ("impact_rate", "bearing", "pin")])
    answers = run_c(joint, row[None], tmp_path)[0]
    wanted = ("moment_bearing", "force_pin", "moment_pin", "penetration")
    np.testing.assert_allclose(answers[2:7], np.hstack([shown[name] for name in wanted]), rtol=1e-9)
    assert answers[8] > 1.0


def test_materials_may_be_named_or_given():
    joint = read_joint(ROOT / "datasets/joint.toml")
    bronze = Material.named("bronze")
    pin = Material("pin", 207e3, 0.3, 250.0)
    assert joint.pair == CylinderPair.internal(10.0, 9.95, bronze, 10.0, pin)
    soft = {"pin.E": "200 MPa", "bearing.material": "PTFE", "bearing.E": DROP, "bearing.nu": DROP}
    pair = joint_for("explicit", 0.05, **soft).pair
    assert (pair.material_i.E, pair.material_j.E) == (500.0, 200.0)
    harder = joint_from(changed(JOINT, {"bearing.yield_stress": 300.0}))
    assert (harder.pair.material_i.E, harder.pair.material_i.yield_stress) == (bronze.E, 300.0)


NOT_FOR_IT = ROOT / "fitting/results/external.json"
MISTAKES = {
    "missing table": ({"friction": DROP}, "friction: is required; add a table [friction]"),
    "no unit": ({"pin.E": "hard"}, "pin.E = 'hard': must be a number; give Young's modulus in GPa"),
    "both": ({"bearing.nu": 0.3}, "bearing.nu = 0.3: is already given by the material; remove nu"),
    "large pin": ({"pin.R": 10.0}, "pin.R = 10.0: does not fit in the hole; keep it below 10.0"),
    "units": ({"units": "inch"}, "units = 'inch': must be 'SI' or 'mm'; give \"SI\""),
    "name": ({"name": "4 pins"}, "name = '4 pins': cannot name a function; begin with one of A"),
    "long name": ({"name": "p" * 41}, "cannot name a function; begin with one of A to Z, and take"),
    "no result": ({"law": "no.json"}, "law = 'no.json': is neither beside this file nor in"),
    "external result": ({"law": str(NOT_FOR_IT)}, "is a fit to external contact; name a fit for"),
    "law undefined": (
        {"law": "enhanced", "bearing.R": 100.0, "pin.R": 80.0},
        "law = 'enhanced': is undefined for this pair, with its clearance of 20 mm; choose another",
    ),
    "friction": ({"friction.coefficient": 30.0}, "must be less than or equal to 2; give the fri"),
    "no friction": ({"friction.coefficient": float("inf")}, "friction.coefficient = inf: must be "),
    "restitution": ({"dissipation.restitution": 0.0}, "must be greater than 0; give the restitu"),
}


@pytest.mark.parametrize(("changes", "message"), MISTAKES.values(), ids=MISTAKES)
def test_mistakes_in_a_joints_file_are_told(changes, message):
    with pytest.raises(InputError) as caught:
        joint_from(changed(JOINT, changes), "mine.toml")
    assert message in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


# --- the command ---


def test_export_takes_a_name_with_a_space_materials_of_ones_own_and_warns_of_metres(
    run, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "datasets/joint.toml").read_text(encoding="utf-8")
    Path("mine.toml").write_text(text.replace('"bronze"', '"Gunmetal"'), encoding="utf-8")
    Path("own.csv").write_text("name;E_GPa;nu\ngunmetal;102,5;0,34\n", encoding="utf-8")
    export = ("export", "--joint", "mine.toml", "--to", "c", "-o", "my joint.c")
    assert run(*export)[0] == 2
    code, _, err = run(*export, "--materials", "own.csv")
    assert (code, err) == (0, "")
    assert "gunmetal, E = 102500.0 MPa" in Path("my joint.h").read_text(encoding="ascii")
    assert '#include "my joint.h"' in Path("my joint.c").read_text(encoding="ascii")
    metres = text.replace("R = 10.0", "R = 0.01").replace("R = 9.95", "R = 0.00995")
    Path("metres.toml").write_text(metres, encoding="utf-8")
    err = run("export", "--joint", "metres.toml", "--to", "c", "-o", "m.c")[2]
    assert "warning: metres.toml: the radius of the hole in mm is 0.01: lengths are in mm" in err
