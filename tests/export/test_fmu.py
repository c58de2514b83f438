"""Clearance joints as FMUs: in FMPy, against the library."""

import subprocess
import zipfile
from ctypes import CFUNCTYPE, c_char_p, c_int, c_void_p, cast
from dataclasses import replace

import numpy as np
import pytest

from cylcontact.files.spec import read_toml
from cylcontact.fitting.adapters import ScaledLaw
from cylcontact.laws import Liu
from cylcontact.mechanism import joint_from, read_joint
from tests.support.fmu_masters import Fmu, export_fmu
from tests.support.mechanism_cases import ROOT
from tests.support.programs import fake_program, require_package, require_program
from tests.support.spec_files import DROP, changed

JOINT = ROOT / "datasets/joint.toml"
DATA = read_toml(JOINT)


@pytest.fixture(scope="module")
def joint():
    return read_joint(JOINT)


@pytest.fixture(scope="module")
def fmu(joint, tmp_path_factory):
    require_program("gcc")
    require_package("fmpy")
    return export_fmu(joint, tmp_path_factory.mktemp("fmu"))


@pytest.fixture
def load(fmu, tmp_path):
    """Load an instance of the FMU, each from a folder of its own."""
    count = iter(range(100))
    return lambda kind="ModelExchange": Fmu(fmu, tmp_path / str(next(count)), kind, np.zeros(12))


def motions(joint, count, deepest, seed=7):
    """Random motions around contact, with the pin up to `deepest` m in the bearing."""
    rng = np.random.default_rng(seed)
    unit = 1e-3 * joint.in_mm  # m
    around, depth = rng.uniform(0, 2 * np.pi, count), rng.uniform(-2e-6, deepest, count)
    bearing = np.column_stack(
        [rng.uniform(-0.05, 0.05, (count, 2)) / unit, rng.uniform(-4, 4, count),
         rng.uniform(-1, 1, (count, 2)) / unit, rng.uniform(-90, 90, count)]
    )  # fmt: skip
    away = (float(joint.pair.dR) * 1e-3 + depth) * np.exp(1j * around)
    away += complex(*joint.point_bearing) * 1e-3 * np.exp(1j * bearing[:, 2])
    pin = bearing + 0
    pin[:, 2:] += rng.uniform(-0.2, 0.2, (count, 4)) / [1, unit, unit, 1 / 90]
    away -= complex(*joint.point_pin) * 1e-3 * np.exp(1j * pin[:, 2])
    pin[:, :2] += np.column_stack([away.real, away.imag]) / unit
    return np.hstack([bearing, pin])


def deep(x=51e-6, rate=0.3):
    """A pin in its bearing at rest."""
    motion = np.zeros(12)
    motion[[6, 9]] = x, rate
    return motion


@pytest.mark.parametrize(
    ("units", "name", "stem"),
    [
        ("SI", "wrist pin", "wrist_pin"),
        ("mm", "a \n\x01 b */ \\ é ??/ '\"<& $c {d} -->", "a_b_c_d"),
    ],
)
def test_fmpy_finds_no_problem_whatever_the_units_and_the_name(tmp_path, units, name, stem):
    gcc, fmpy = require_program("gcc"), require_package("fmpy")
    from fmpy.validation import validate_fmu

    path = export_fmu(joint_from(changed(DATA, {"units": units, "name": name})), tmp_path)
    assert path.name == f"{stem}.fmu"
    assert validate_fmu(str(path)) == []
    description = fmpy.read_model_description(path, validate=True)
    assert (description.fmiVersion, description.numberOfEventIndicators) == ("2.0", 1)
    for kind in (description.modelExchange, description.coSimulation):
        assert kind.canGetAndSetFMUstate
    given = {v.name: v.unit for v in description.modelVariables}
    length = {"SI": "m", "mm": "mm"}[units]
    assert (given["pin.x"], given["pin.v_y"]) == (length, f"{length}/s")
    assert given["bearing.moment"] == f"N.{length}"
    factors = {unit.name: unit.baseUnit.factor for unit in description.unitDefinitions}
    assert factors[length] == factors[f"N.{length}"] == float({"SI": 1, "mm": "1e-3"}[units])
    # Its sources compile without a warning, also with the prefix of static linking.
    with zipfile.ZipFile(path) as archive:
        archive.extractall(tmp_path)
    flags = ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Werror"]
    prefix = [] if units == "SI" else [f"-DFMI2_FUNCTION_PREFIX={stem}_"]
    source = f"{stem}.c"
    subprocess.run(
        [gcc, "-fsyntax-only", *flags, *prefix, source], cwd=tmp_path / "sources", check=True
    )


def test_the_file_depends_on_the_joint_alone(fmu, joint, tmp_path):
    assert export_fmu(joint, tmp_path).read_bytes() == fmu.read_bytes()
    other = export_fmu(joint_from(changed(DATA, {"friction.coefficient": 0.2})), tmp_path)
    with zipfile.ZipFile(fmu) as one, zipfile.ZipFile(other) as two:
        guids = {z.read("modelDescription.xml").split(b'guid="')[1][:38] for z in (one, two)}
    assert len(guids) == 2


def assert_same(element, joint, state, moves, tolerance):
    """Compare an FMU with the library before and after each of some events; return the state."""
    seen, flags = [], set()
    for motion in moves:
        element.set(motion)
        before = joint.evaluate(state, motion[:6], motion[6:])
        seen.append((element.wrench[:-1], np.hstack(before[:-1])))
        element.at_event(motion)
        state = joint.accept(state, motion[:6], motion[6:])
        after = joint.evaluate(state, motion[:6], motion[6:])
        seen.append((element.wrench[:-1], np.hstack(after[:-1])))
        assert element.impact_rate == pytest.approx([float(state.impact_rate)], rel=1e-12, abs=0)
        assert element.wrench[-1] == after.flag
        flags.add(int(after.flag))
    got, ours = np.array(seen).transpose(1, 0, 2)
    assert (ours[:, 6] > 0).mean() > 0.5
    assert len(flags) > 1
    assert (np.abs(got - ours) <= tolerance * np.abs(ours).max(axis=0)).all()
    return state


@pytest.mark.parametrize(
    ("law", "units"),
    [
        pytest.param("conformal", "SI", marks=pytest.mark.slow),
        ("explicit", "mm"),
        ("johnson", "SI"),
        pytest.param("enhanced", "mm", marks=pytest.mark.slow),
    ],
)
def test_outputs_are_those_of_the_library_also_with_other_parameters(tmp_path, law, units):
    """Clearance, with the law and first yield by it, friction and restitution."""
    require_program("gcc")
    require_package("fmpy")
    points = {"bearing.point": [3.0, -2.0], "pin.point": [-1.0, 4.0]}
    data = changed(DATA, {"law": law, "units": units, **points})
    joint = joint_from(data)
    element = Fmu(export_fmu(joint, tmp_path), tmp_path / "unpacked", inputs=np.zeros(12))
    tolerance = 1e-8 if law == "conformal" else 1e-12
    state = joint.accept(joint.start(), np.zeros(6), np.zeros(6))  # with the points apart: deep in
    state = assert_same(element, joint, state, motions(joint, 200, 2e-4), tolerance)
    other = {"clearance": 0.08, "friction.coefficient": 0.2, "dissipation.restitution": 0.8123}
    joint = joint_from(changed(data, {**other, "pin.R": DROP}))
    element.fmu.setReal(element.parameters, [0.08 / joint.in_mm, 0.2, 0.8123])
    assert_same(element, joint, state, motions(joint, 200, 2e-4, seed=8), 2e-8)


def test_a_law_without_a_formula_has_its_table_and_no_clearance_to_tune(joint, tmp_path):
    require_program("gcc")
    require_package("fmpy")
    joint = replace(joint, law=ScaledLaw(Liu(), 0.7, 1.5))
    element = Fmu(export_fmu(joint, tmp_path), tmp_path / "unpacked", inputs=np.zeros(12))
    assert len(element.parameters) == 2
    assert_same(element, joint, joint.start(), motions(joint, 100, 2e-4), 1e-12)


def test_a_state_is_kept_restored_and_sent_elsewhere(load):
    one, other = load(), load()
    one.completed(deep())
    assert (one.impact_rate, other.impact_rate) == ([0.3], [0.0])  # several at once
    kept = one.fmu.getFMUstate()
    one.set(deep(55e-6, 0.1))
    wrench = one.wrench
    one.completed(np.zeros(12))
    assert one.impact_rate == [0.0]
    one.fmu.setFMUstate(kept)
    assert one.fmu.getReal(one.inputs) == list(deep())
    other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(one.fmu.serializeFMUstate(kept)))
    for element in (one, other):
        assert element.impact_rate == [0.3]
        element.set(deep(55e-6, 0.1))
        assert np.array_equal(element.wrench, wrench)
    one.fmu.freeFMUstate(kept)
    one.fmu.reset()
    assert one.impact_rate == [0.0]
    assert one.fmu.getReal(one.inputs) == [0.0] * 12


def test_a_completed_step_into_contact_asks_for_an_event(load):
    """The flag is a discrete variable: above first yield, it asks for one too."""
    element = load()
    for motion, asks, rate, flag in (
        (np.zeros(12), False, 0.0, 0), (deep(), True, 0.3, 0), (deep(rate=0.1), False, 0.3, 0),
        (deep(400e-6, 0.1), True, 0.3, 1), (np.zeros(12), True, 0.0, 0),
    ):  # fmt: skip
        before = element.wrench[-1]
        element.set(motion)
        assert element.wrench[-1] == before
        assert element.completed(motion) is asks
        assert (element.impact_rate, element.wrench[-1]) == ([rate], flag)


@pytest.mark.parametrize(
    ("gap", "rate", "begins"),
    [(-1e-13, 0.3, True), (1e-13, 0.3, True), (-1e-13, -0.3, False), (-1e-8, 0.3, False)],
)
def test_an_event_within_a_rounding_error_of_the_touch_begins_it(load, joint, gap, rate, begins):
    element, motion = load(), deep(float(joint.pair.dR) * 1e-3 + gap, rate)
    for step in (element.at_event, element.completed):
        # What has begun is not ended by a step that is still before the touch.
        step(motion)
        assert element.impact_rate == pytest.approx([rate if begins else 0.0], rel=1e-12)


def test_a_body_goes_on_from_its_last_input(load):
    """The bearing moves at 1 m/s through ten steps of 10 µs, in each of which the pin is set."""
    element, step = load("CoSimulation"), 1e-5
    fmu, x, v_x, pin_x = element.fmu, 0, 3, 6
    fmu.setReal([v_x], [1.0])
    for k in range(10):
        fmu.setReal([pin_x], [0.0])
        fmu.doStep(k * step, step)
    assert element.wrench[6] == pytest.approx(1e-4 - 5e-5, rel=1e-9)
    assert fmu.getReal([x, v_x]) == [0.0, 1.0]  # as they were set
    # Only the speed is set, from 0 to 9 m/s: the place goes on from where it is.
    element = load("CoSimulation")
    for k in range(10):
        element.fmu.setReal([v_x], [float(k)])
        element.fmu.doStep(k * step, step)
    assert element.wrench[6] == pytest.approx(45 * step - 5e-5, rel=1e-9)


def test_a_parameter_outside_its_bounds_is_named(fmu, load):
    import fmpy
    from fmpy.fmi2 import FMU2Model, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

    element, said = load(), []
    # The message is behind its format, in the variable arguments.
    logger = CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p, c_char_p)(
        lambda *given: said.append(given[-1].decode())
    )
    callbacks = fmi2CallbackFunctions(logger=cast(logger, fmi2CallbackLoggerTYPE))
    again = FMU2Model(
        guid=element.fmu.guid, unzipDirectory=element.fmu.unzipDirectory, instanceName="again",
        modelIdentifier=element.fmu.modelIdentifier,
    )  # fmt: skip
    again.instantiate(callbacks=callbacks)
    variables = {v.name: v for v in fmpy.read_model_description(fmu).modelVariables}
    for name, value in (("friction", 2.5), ("restitution", 0.0), ("clearance", 1.0)):
        with pytest.raises(Exception, match="error"):
            again.setReal([variables[name].valueReference], [value])
        bounds = variables[name].min, variables[name].max
        assert said.pop() == f"{name} must be from {bounds[0]} to {bounds[1]}"
    assert (variables["friction"].min, variables["friction"].max) == ("0.0", "2.0")


@pytest.mark.parametrize("kind", ["ModelExchange", "CoSimulation"])
def test_directional_derivatives_are_those_of_the_outputs(load, joint, kind):
    """Of random motions by random directions, against differences through the FMU.

    In co-simulation they are at the impact rate after the step. Where a difference repeats a step
    in which the contact begins, the impact rate changes too: there, and only there, they differ.
    """
    element, rng = load(kind), np.random.default_rng(5)
    fmu, step, h, errors, begun = element.fmu, 1e-6, 1e-9, [], []

    def outputs(motion, state):
        fmu.setFMUstate(state)
        element.set(motion)
        if kind == "CoSimulation":
            fmu.doStep(0.0, step)
        return element.wrench[:-1]

    state = fmu.getFMUstate()
    for k, motion in enumerate(motions(joint, 200, 2e-5)):
        along = rng.normal(size=12) * np.tile([1, 1, 10, 1e3, 1e3, 1e3], 2)
        if k % 2 and kind == "CoSimulation":
            outputs(motion, state)  # the contact is under way
            under_way = fmu.getFMUstate()
        else:
            under_way = state
        less, more = (outputs(motion + way * h * along, under_way) for way in (-1, 1))
        outputs(motion, under_way)
        got = fmu.getDirectionalDerivative(element.outputs, element.inputs, list(along))
        slope = (more - less) / (2 * h)
        forces = [*range(6), 8, 9]
        if not np.any(slope[forces]):  # free, or the normal force is clipped
            assert not np.any(np.array(got)[forces])
            continue
        errors.append(np.abs(slope - got)[forces].max() / np.abs(slope[forces]).max())
        begun.append(under_way is state)
    errors, begun = np.array(errors), np.array(begun)
    within = errors[~begun] if kind == "CoSimulation" else errors
    assert np.median(within) < 1e-6
    assert (within < 1e-4).mean() > 0.95  # a kink lies in the difference of the others
    if kind == "CoSimulation":
        assert np.median(errors[begun]) > 1e-2


def test_misuse_is_refused(load):
    """Values that cannot be set, bytes that are no state of this FMU, and steps that go nowhere."""
    from fmpy.fmi1 import FMICallException

    element, rng = load("CoSimulation"), np.random.default_rng(3)
    fmu, (clearance, friction, restitution) = element.fmu, element.parameters
    state = fmu.serializeFMUstate(fmu.getFMUstate())
    bad = bytearray(state)
    bad[40] ^= 1
    before = fmu.getReal(range(28))
    for act, *arguments in (
        (fmu.setReal, element.outputs[:1], [1.0]),
        (fmu.getReal, [28]),
        (fmu.setInteger, [0], [1]),
        (fmu.getInteger, [1]),
        (fmu.setReal, [clearance], [-1.0]),
        (fmu.setReal, [restitution], [1.01]),
        *((fmu.setReal, [friction], [bad]) for bad in (np.nan, np.inf, 1e9, 2.01, -0.1)),
        *((fmu.deSerializeFMUstate, rng.bytes(size)) for size in (0, 5, 120, len(state))),
        (fmu.deSerializeFMUstate, bytes(bad)),
        *((fmu.doStep, 0.0, step) for step in (0.0, -1e-6, np.nan, np.inf)),
    ):
        with pytest.raises(FMICallException, match="error"):
            act(*arguments)
    assert fmu.getReal(range(28)) == before
    assert before[-3:] == pytest.approx([5e-5, 0.1, 0.9])
    assert fmu.deSerializeFMUstate(state)
    fmu.doStep(0.0, 1e-6)


@pytest.mark.parametrize(
    ("script", "told"),
    [
        ("", "'fmu': needs a C compiler, and there is neither cc nor gcc; install one (Debian"),
        ("echo no headers >&2\necho more >&2\nexit 1", "cc failed: no headers; check that it comp"),
    ],
)
def test_without_a_compiler_one_line_says_how_to_get_one(run, tmp_path, monkeypatch, script, told):
    if script:
        fake_program(tmp_path, "cc", script)
    monkeypatch.setenv("PATH", str(tmp_path))
    out = tmp_path / "joint.fmu"
    code, said, errors = run("export", "--joint", JOINT, "--to", "fmu", "-o", out)
    assert (code, said, errors.count("\n"), out.exists()) == (2, "", 1, False)
    assert told in errors
