"""Clearance joints as FMUs: in FMPy and in libcosim, against the library."""

import subprocess
import zipfile

import numpy as np
import pytest

from cylcontact.files.spec import read_toml
from cylcontact.mechanism import joint_from, read_joint
from tests.support.fmu_masters import (
    OUTPUTS,
    PARAMETERS,
    REALS,
    Cosim,
    Fmu,
    Library,
    cosimulate,
    export_fmu,
    integrate,
)
from tests.support.mechanism_cases import ROOT
from tests.support.programs import fake_program, require_package, require_program
from tests.support.spec_files import DROP, changed

JOINT = ROOT / "datasets/joint.toml"
DATA = read_toml(JOINT)
# The journal under load touches some five times in 3 ms, sliding.
LOADED_END = 3e-3


@pytest.fixture(scope="module")
def joint():
    return read_joint(JOINT)


@pytest.fixture(scope="module")
def fmu(joint, tmp_path_factory):
    require_program("gcc")
    return export_fmu(joint, tmp_path_factory.mktemp("fmu"))


@pytest.fixture
def load(fmu, tmp_path):
    """Load an instance of the FMU, each from a folder of its own."""
    count = iter(range(100))
    return lambda *args, **kwargs: Fmu(fmu, tmp_path / str(next(count)), *args, **kwargs)


def motions(joint, count, seed, deepest=8e-6):
    """Random motions around contact: the pin mostly a few µm into the bearing."""
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


@pytest.mark.parametrize(
    ("units", "name", "stem"),
    [
        ("SI", "wrist pin", "wrist_pin"),
        ("mm", "a \n\x01 b */ \\ é ??/ '\"<& $c {d} -->", "a_b_c_d"),
    ],
)
def test_fmpy_finds_no_problem_whatever_the_units_and_the_name(tmp_path, units, name, stem):
    from fmpy import read_model_description
    from fmpy.validation import validate_fmu

    require_program("gcc")
    path = export_fmu(joint_from(changed(DATA, {"units": units, "name": name})), tmp_path)
    assert path.name == f"{stem}.fmu"
    assert validate_fmu(str(path)) == []
    Fmu(path, tmp_path / "unpacked")
    description = read_model_description(path, validate=True)
    assert (description.fmiVersion, description.numberOfEventIndicators) == ("2.0", 1)
    for kind in (description.modelExchange, description.coSimulation):
        assert kind.canGetAndSetFMUstate
    with zipfile.ZipFile(path) as archive:
        assert {f"sources/{stem}.c", f"sources/{stem}_fmi2.c"} < set(archive.namelist())
    given = {v.name: v.unit for v in description.modelVariables}
    length = {"SI": "m", "mm": "mm"}[units]
    assert (given["pin.x"], given["pin.v_y"]) == (length, f"{length}/s")
    assert given["bearing.moment"] == f"N.{length}"
    factors = {unit.name: unit.baseUnit.factor for unit in description.unitDefinitions}
    assert factors[length] == factors[f"N.{length}"] == float({"SI": 1, "mm": "1e-3"}[units])


def test_the_file_depends_on_the_joint_alone(fmu, joint, tmp_path):
    assert export_fmu(joint, tmp_path).read_bytes() == fmu.read_bytes()
    other = export_fmu(joint_from(changed(DATA, {"friction.coefficient": 0.2})), tmp_path)
    with zipfile.ZipFile(fmu) as one, zipfile.ZipFile(other) as two:
        guids = {z.read("modelDescription.xml").split(b'guid="')[1][:38] for z in (one, two)}
    assert len(guids) == 2


@pytest.mark.parametrize("prefix", [[], ["-DFMI2_FUNCTION_PREFIX=wrist_pin_"]])
def test_the_sources_compile_without_a_warning(fmu, tmp_path, prefix):
    gcc = require_program("gcc")
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(tmp_path)
    for source in ("wrist_pin.c", "wrist_pin_fmi2.c"):
        subprocess.run(
            [gcc, "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Werror", *prefix,
             "-c", source], cwd=tmp_path / "sources", check=True,
        )  # fmt: skip


@pytest.mark.parametrize("units", ["SI", "mm"])
def test_outputs_are_those_of_the_library(tmp_path, units):
    require_program("gcc")
    points = {"bearing.point": [3.0, -2.0], "pin.point": [-1.0, 4.0]}
    joint = joint_from(changed(DATA, {"units": units, "law": "explicit", **points}))
    element = Fmu(export_fmu(joint, tmp_path), tmp_path / "unpacked")
    library = Library(joint)
    seen = []
    for motion in motions(joint, 300, 7):
        element.set(motion)
        w = library.joint.evaluate(library.state, motion[:6], motion[6:])
        ours = [*w.force_bearing, w.moment_bearing, *w.force_pin, w.moment_pin, *w[4:10]]
        seen.append((element.fmu.getReal(OUTPUTS), ours))
        library.completed(motion)
        element.completed(motion)
        rate = float(library.state.impact_rate)
        assert element.get("impact_rate") == pytest.approx([rate], rel=1e-12, abs=0)
        after = library.joint.evaluate(library.state, motion[:6], motion[6:])
        assert element.fmu.getInteger([0]) == [int(after.flag)]
    got, ours = np.array(seen).transpose(1, 0, 2)
    assert (ours[:, 6] > 0).sum() > 150
    assert (np.abs(got - ours) <= 1e-12 * np.abs(ours).max(axis=0)).all()


def test_a_state_is_kept_restored_and_sent_elsewhere(load):
    motion, deeper = np.zeros((2, 12))
    motion[[6, 9]], deeper[[6, 9]] = (51e-6, 0.3), (55e-6, 0.1)
    one, other = load(), load()
    assert one.get("impact_rate") == other.get("impact_rate") == [0.0]
    one.completed(motion)
    assert one.get("impact_rate") == [0.3]
    assert other.get("impact_rate") == [0.0]  # several at once
    kept, wrench = one.fmu.getFMUstate(), one.wrench(deeper)
    one.completed(np.zeros(12))
    assert one.get("impact_rate") == [0.0]
    assert not np.array_equal(one.wrench(deeper), wrench)
    one.fmu.setFMUstate(kept)
    assert one.get(*REALS[:12]) == list(motion)
    assert np.array_equal(one.wrench(deeper), wrench)
    other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(one.fmu.serializeFMUstate(kept)))
    assert other.get("impact_rate") == [0.3]
    assert np.array_equal(other.wrench(deeper), wrench)
    one.fmu.freeFMUstate(kept)
    one.fmu.reset()
    assert one.get("impact_rate", "pin.x") == [0.0, 0.0]


def test_a_completed_step_into_contact_asks_for_an_event(load):
    element, motion = load(), np.zeros(12)
    motion[[6, 9]] = 51e-6, 0.3
    assert element.completed(np.zeros(12)) is False
    assert element.completed(motion) is True  # the contact began within the step
    assert element.get("impact_rate") == [0.3]
    motion[9] = 0.1
    assert element.completed(motion) is False
    assert element.get("impact_rate") == [0.3]
    motion[6] = 400e-6  # above first yield: the flag is a discrete variable
    assert element.fmu.getInteger([0]) == [0]
    assert element.completed(motion) is True
    assert element.fmu.getInteger([0]) == [1]
    assert element.completed(np.zeros(12)) is True
    assert element.get("impact_rate") == [0.0]
    assert element.fmu.getInteger([0]) == [0]


@pytest.mark.parametrize(
    ("gap", "rate", "begins"),
    [(-1e-13, 0.3, True), (1e-13, 0.3, True), (-1e-13, -0.3, False), (-1e-8, 0.3, False)],
)
def test_an_event_within_a_rounding_error_of_the_touch_begins_it(load, joint, gap, rate, begins):
    element, motion = load(), np.zeros(12)
    motion[[6, 9]] = float(joint.pair.dR) * 1e-3 + gap, rate
    element.at_event(motion)
    assert element.get("impact_rate") == pytest.approx([rate if begins else 0.0], rel=1e-12)
    # What has begun is not ended by a step that is still before the touch.
    element.completed(motion)
    assert element.get("impact_rate") == pytest.approx([rate if begins else 0.0], rel=1e-12)


def test_misuse_is_refused(load):
    from fmpy.fmi1 import FMICallException

    element = load()
    for misuse in (
        lambda: element.fmu.setReal(OUTPUTS[:1], [1.0]),
        lambda: element.fmu.getReal([len(REALS)]),
        lambda: element.fmu.setInteger([0], [1]),
        lambda: element.fmu.getInteger([1]),
        lambda: element.fmu.setReal(PARAMETERS[:1], [-1.0]),  # a clearance
        lambda: element.fmu.setReal(PARAMETERS[2:], [1.01]),  # a restitution
        lambda: element.fmu.setReal(PARAMETERS[1:2], [np.nan]),
    ):
        with pytest.raises(FMICallException, match="error"):
            misuse()
    assert element.get(*REALS[25:]) == pytest.approx([5e-5, 0.1, 0.9])


def test_only_states_of_this_fmu_and_steps_forward_are_taken(load):
    from fmpy.fmi1 import FMICallException

    element, rng = load("CoSimulation"), np.random.default_rng(3)
    state = element.fmu.serializeFMUstate(element.fmu.getFMUstate())
    bad = bytearray(state)
    bad[40] ^= 1
    for size in (0, 5, 120, len(state)):
        with pytest.raises(FMICallException, match="error"):
            element.fmu.deSerializeFMUstate(rng.bytes(size))
    with pytest.raises(FMICallException, match="error"):
        element.fmu.deSerializeFMUstate(bytes(bad))
    assert element.fmu.deSerializeFMUstate(state)
    before = element.fmu.getReal(range(len(REALS)))
    for step in (0.0, -1e-6, np.nan, np.inf):
        with pytest.raises(FMICallException, match="error"):
            element.fmu.doStep(0.0, step)
    assert element.fmu.getReal(range(len(REALS))) == before
    element.fmu.doStep(0.0, 1e-6)


@pytest.mark.parametrize("law", ["conformal", "explicit", "johnson", "enhanced", "liu"])
def test_parameters_give_the_joint_with_other_numbers(law, tmp_path):
    """Clearance, with the law and first yield by it, friction and restitution."""
    require_program("gcc")
    data = changed(DATA, {"law": law, "bearing.point": [3.0, -2.0]})
    element = Fmu(export_fmu(joint_from(data), tmp_path), tmp_path / "unpacked")
    other = {"clearance": 0.08, "friction.coefficient": 0.2, "dissipation.restitution": 0.8123}
    joint = joint_from(changed(data, {**other, "pin.R": DROP}))
    element.fmu.setReal(PARAMETERS, [8e-5, 0.2, 0.8123])
    library = Library(joint)
    seen = []
    for motion in motions(joint, 300, 8, deepest=2e-4):
        element.at_event(motion)
        library.at_event(motion)
        w = joint.evaluate(library.state, motion[:6], motion[6:])
        ours = [*w.force_bearing, w.moment_bearing, *w.force_pin, w.moment_pin, *w[4:]]
        seen.append(([*element.fmu.getReal(OUTPUTS), *element.fmu.getInteger([0])], ours))
    got, ours = np.array(seen).transpose(1, 0, 2)
    assert len({*ours[:, -1]}) > 1
    np.testing.assert_array_equal(got[:, -1], ours[:, -1])
    assert (np.abs(got - ours) <= 2e-8 * np.abs(ours).max(axis=0)).all()


def test_the_journal_under_load_moves_as_with_the_library(load, joint, fmu):
    """FMPy in model exchange, with an event at each touch and release, and in co-simulation."""
    times, states, onsets = integrate(load(), LOADED_END)
    ours = integrate(Library(joint), LOADED_END)
    assert onsets.size >= 4
    np.testing.assert_allclose(onsets, ours[2], rtol=0, atol=1e-11)
    assert times[-1] == ours[0][-1] == LOADED_END
    np.testing.assert_allclose(states[-1, :2], ours[1][-1, :2], rtol=0, atol=1e-12)
    np.testing.assert_allclose(states[-1, 2:], ours[1][-1, 2:], rtol=0, atol=1e-8)
    # The impact rate is that of the end of a step: of first order in the step.
    errors = [
        np.hypot(*(cosimulate(load("CoSimulation"), LOADED_END, size)[1][-1] - states[-1, :2]))
        for size in (2e-6, 2.5e-7)
    ]
    assert errors[1] < min(2e-7, errors[0] / 4)
    # Another importer steps the same.
    require_package("libcosimpy")
    one = cosimulate(Cosim(fmu, 1e-6), 1e-3, 1e-6)
    for ours, theirs in zip(one, cosimulate(load("CoSimulation"), 1e-3, 1e-6), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-13)


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
