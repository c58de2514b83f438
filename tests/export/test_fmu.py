"""Clearance joints as FMUs: in FMPy and in libcosim, against the library."""

import subprocess
import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from cylcontact import InputError
from cylcontact.export import export_joint
from cylcontact.mechanism import joint_from, read_joint, read_mechanism, simulate
from cylcontact.mechanism.joint import JointState
from cylcontact.spec import read_toml
from tests.support.fmu_masters import (
    OUTPUTS,
    REALS,
    Cosim,
    Fmu,
    Journal,
    Library,
    SliderCrank,
    cosimulate,
    export_fmu,
    integrate,
    onsets_of,
)
from tests.support.mechanism_cases import ROOT
from tests.support.programs import fake_program, require_package, require_program
from tests.support.spec_files import changed

JOINT = ROOT / "datasets/joint.toml"
DATA = read_toml(JOINT)
SPEC = ROOT / "datasets/slider_crank.toml"
# The journal under load: it touches some five times in 3 ms, sliding.
LOADED = Journal(force=(30.0, -200.0), spin=50.0)
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


def motions(joint, count, seed):
    """Random motions around contact: the pin mostly a few µm into the bearing."""
    rng = np.random.default_rng(seed)
    unit = 1e-3 * joint.in_mm  # m
    around, depth = rng.uniform(0, 2 * np.pi, count), rng.uniform(-2e-6, 8e-6, count)
    bearing = np.column_stack(
        [rng.uniform(-0.05, 0.05, (count, 2)) / unit, rng.uniform(-4, 4, count),
         rng.uniform(-1, 1, (count, 2)) / unit, rng.uniform(-90, 90, count)]
    )  # fmt: skip
    away = (float(joint.pair.dR) * 1e-3 + depth) * np.exp(1j * around)
    away += complex(*joint.point_bearing) * 1e-3 * np.exp(1j * bearing[:, 2])
    pin = bearing + 0
    pin[:, :2] += np.column_stack([away.real, away.imag]) / unit
    pin[:, 2:] += rng.uniform(-0.2, 0.2, (count, 4)) / [1, unit, unit, 1 / 90]
    return np.hstack([bearing, pin])


@pytest.mark.parametrize("units", ["SI", "mm"])
def test_fmpy_finds_no_problem(tmp_path, units):
    from fmpy import read_model_description
    from fmpy.validation import validate_fmu

    require_program("gcc")
    path = export_fmu(joint_from(changed(DATA, {"units": units})), tmp_path)
    assert validate_fmu(str(path)) == []
    description = read_model_description(path, validate=True)
    assert (description.fmiVersion, description.numberOfEventIndicators) == ("2.0", 1)
    for kind in (description.modelExchange, description.coSimulation):
        assert kind.canGetAndSetFMUstate
    with zipfile.ZipFile(path) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        for kind in ("ModelExchange", "CoSimulation"):
            files = [file.get("name") for file in root.find(kind).find("SourceFiles")]
            assert files == ["wrist_pin.c", "wrist_pin_fmi2.c"]
            assert {f"sources/{file}" for file in files} < set(archive.namelist())
    given = {v.name: v.unit for v in description.modelVariables}
    length = {"SI": "m", "mm": "mm"}[units]
    assert (given["pin.x"], given["pin.v_y"]) == (length, f"{length}/s")
    assert given["bearing.moment"] == f"N.{length}"
    factors = {unit.name: unit.baseUnit.factor for unit in description.unitDefinitions}
    assert factors[length] == factors[f"N.{length}"] == float({"SI": 1, "mm": "1e-3"}[units])


def test_no_name_breaks_out_of_the_description(tmp_path):
    from fmpy.validation import validate_fmu

    require_program("gcc")
    name = "a \n\x01 b */ \\ é ??/ '\"<& $c {d} -->"
    path = export_fmu(joint_from(changed(DATA, {"name": name})), tmp_path)
    assert path.name == "a_b_c_d.fmu"
    assert validate_fmu(str(path)) == []
    Fmu(path, tmp_path / "unpacked")


def test_the_file_depends_on_the_joint_alone(fmu, joint, tmp_path):
    assert export_fmu(joint, tmp_path).read_bytes() == fmu.read_bytes()
    other = export_fmu(joint_from(changed(DATA, {"friction.coefficient": 0.2})), tmp_path)
    with zipfile.ZipFile(fmu) as one, zipfile.ZipFile(other) as two:
        (library,) = set(one.namelist()) - {
            "modelDescription.xml", "sources/wrist_pin.c", "sources/wrist_pin.h",
            "sources/wrist_pin_fmi2.c",
        }  # fmt: skip
        assert library.startswith("binaries/")
        assert one.namelist() == two.namelist()
        guids = {z.read("modelDescription.xml").split(b'guid="')[1][:38] for z in (one, two)}
        assert len(guids) == 2
        assert all(entry.date_time == (1980, 1, 1, 0, 0, 0) for entry in one.infolist())


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
    joint = joint_from(changed(DATA, {"units": units, "bearing.point": [3.0, -2.0]}))
    element = Fmu(export_fmu(joint, tmp_path), tmp_path / "unpacked")
    library = Library(joint)
    seen = []
    for motion in motions(joint, 300, 7):
        element.set(motion)
        w = library.joint.evaluate(library.state, motion[:6], motion[6:])
        ours = [*w.force_bearing, w.moment_bearing, *w.force_pin, w.moment_pin, *w[4:10]]
        seen.append((element.fmu.getReal(OUTPUTS[:-1]), ours))
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


def test_evaluating_changes_nothing(load, joint):
    element = load()
    first = element.wrench(motions(joint, 1, 3)[0])
    for motion in motions(joint, 50, 4):
        element.wrench(motion)
        element.indicator(motion)
    assert element.get("impact_rate") == [0.0]
    assert np.array_equal(element.wrench(motions(joint, 1, 3)[0]), first)


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
    assert element.get("impact_rate") == [rate if begins else 0.0]
    # What has begun is not ended by a step that is still before the touch.
    element.completed(motion)
    assert element.get("impact_rate") == [rate if begins else 0.0]


def test_misuse_is_refused(load, fmu, tmp_path):
    from fmpy import extract, read_model_description
    from fmpy.fmi1 import FMICallException
    from fmpy.fmi2 import FMU2Model

    element = load()
    for misuse in (
        lambda: element.fmu.setReal([12], [1.0]),
        lambda: element.fmu.getReal([len(REALS)]),
        lambda: element.fmu.setInteger([0], [1]),
        lambda: element.fmu.getInteger([1]),
        lambda: element.fmu.deSerializeFMUstate(b"short"),
    ):
        with pytest.raises(FMICallException, match="error"):
            misuse()
    stranger = FMU2Model(
        guid="{another}", unzipDirectory=extract(fmu, tmp_path / "other"), instanceName="x",
        modelIdentifier=read_model_description(fmu).modelExchange.modelIdentifier,
    )  # fmt: skip
    with pytest.raises(Exception, match="Failed to instantiate"):
        stranger.instantiate()


def test_an_impact_gives_back_the_restitution_as_deep_as_an_integration_of_its_own(load, joint):
    """Against the law itself: m·δ̈ = −f(δ)·length·(1 + χ·δ̇/δ̇⁽⁻⁾); χ exact for e = 0.9."""
    speed, mass = 0.4, 0.5
    system = Journal(mass, start=(0.0, 0.0, 0.6 * speed, 0.8 * speed))
    _, states, onsets = integrate(system, load(), 4e-4)
    assert onsets == pytest.approx(float(joint.pair.dR) * 1e-3 / speed, rel=1e-12)
    assert np.hypot(*states[-1, 2:]) == pytest.approx(0.9 * speed, rel=1e-9)

    def impact(_t, y):
        load = float(joint.law.load(max(y[0], 0.0) * 1e3, joint.pair)) * joint.pair.length
        return [y[1], -load * (1 + joint.chi * y[1] / speed) / mass]

    def deepest(_t, y):
        return y[1]

    deepest.terminal = True
    alone = solve_ivp(impact, (0, 1), [0.0, speed], events=deepest, rtol=1e-11, atol=1e-18)
    library = Library(joint)
    library.state = JointState(speed)
    peak = max(library.indicator(system.motion(0.0, y)) for y in states)
    assert peak < alone.y_events[0][0][0] < peak * 1.01  # accepted steps miss the very deepest
    depth = states[np.argmin(np.abs(states[:, 2:] @ [0.6, 0.8]))]
    assert library.indicator(system.motion(0.0, depth)) > 0


def test_the_journal_under_load_moves_as_with_the_library(load, joint):
    """FMPy in model exchange, with an event at each touch and release."""
    times, states, onsets = integrate(LOADED, load(), LOADED_END)
    ours = integrate(LOADED, Library(joint), LOADED_END)
    assert onsets.size >= 4
    np.testing.assert_allclose(onsets, ours[2], rtol=0, atol=1e-11)
    assert times[-1] == ours[0][-1] == LOADED_END
    np.testing.assert_allclose(states[-1, :2], ours[1][-1, :2], rtol=0, atol=1e-12)
    np.testing.assert_allclose(states[-1, 2:], ours[1][-1, 2:], rtol=0, atol=1e-8)


@pytest.mark.parametrize(("clearance", "contacts"), [(0.5, 4), (0.02, 3)])
def test_the_slider_crank_moves_as_in_the_mechanism(tmp_path, clearance, contacts):
    """The mechanism's constraints, the force of the FMU, friction and restitution and all."""
    require_program("gcc")
    mechanism = read_mechanism(SPEC, clearance=clearance)
    run = simulate(mechanism, revolutions=1, tolerance=1e-11, beyond="tangent")
    exact = run.contacts["onset_s"].to_numpy()
    peer = require_package("benchmarks.exudyn_peer")
    path = export_fmu(peer.joint_of(mechanism), tmp_path)
    system = SliderCrank(mechanism)
    end = exact[contacts - 1] * 1.001
    times, states, onsets = integrate(system, Fmu(path, tmp_path / "unpacked"), end)
    np.testing.assert_allclose(onsets, exact[:contacts], rtol=0, atol=1e-10)
    # Where the bodies are, and how fast, at each touch.
    at, of = np.isin(times, onsets), np.searchsorted(run.time, exact[:contacts])
    q, v = states[at].reshape(contacts, 2, -1, 3).transpose(1, 0, 2, 3)
    np.testing.assert_allclose(q, run.coordinates[of], rtol=0, atol=1e-7)
    np.testing.assert_allclose(v, run.velocities[of], rtol=0, atol=1e-4)


@pytest.fixture(scope="module")
def exact(fmu, tmp_path_factory):
    """The loaded journal in model exchange: its first onsets, and where it is at the end."""
    _, states, onsets = integrate(LOADED, Fmu(fmu, tmp_path_factory.mktemp("exact")), 2.5e-3)
    return onsets[:3], states[-1]


def test_two_importers_step_the_same(fmu, load):
    """Co-simulation of the journal under load, in libcosim and in FMPy."""
    require_package("libcosimpy")
    one = cosimulate(LOADED, Cosim(fmu, 1e-6), 2e-3, 1e-6)
    other = cosimulate(LOADED, load("CoSimulation"), 2e-3, 1e-6)
    assert (one[2] > 0).sum() > 100
    for ours, theirs in zip(one, other, strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-13)


def test_co_simulation_tends_to_model_exchange(load, exact):
    onsets, last = exact
    off = {}
    for size in (2e-6, 1e-6, 2.5e-7):
        times, states, penetration = cosimulate(LOADED, load("CoSimulation"), 2.5e-3, size)
        error = np.hypot(*(states[-1, :2] - last[:2]))
        off[size] = error, np.abs(onsets_of(times, penetration)[:3] - onsets).max()
    assert off[2.5e-7][0] < 2e-7
    assert off[2.5e-7][1] < 2e-7
    # The impact rate is that of the end of a step: of first order in the step.
    assert off[2.5e-7][0] < off[2e-6][0] / 4


def test_the_slider_crank_in_libcosim(tmp_path):
    """The mechanism's own equations in a master, the joint in libcosim, to the third contact."""
    require_package("libcosimpy")
    require_program("gcc")
    mechanism = read_mechanism(SPEC)
    run = simulate(mechanism, revolutions=1, tolerance=1e-11)
    exact = run.contacts["onset_s"].to_numpy()[:3]
    peer = require_package("benchmarks.exudyn_peer")
    path = export_fmu(peer.joint_of(mechanism), tmp_path)
    off = {}
    for size in (1e-6, 2e-7):
        steps = cosimulate(SliderCrank(mechanism), Cosim(path, size), exact[2] * 1.01, size)
        off[size] = np.abs(onsets_of(steps[0], steps[2])[:3] - exact).max()
    assert off[2e-7] < 1e-6
    assert off[2e-7] < off[1e-6] / 2


def test_the_command_writes_the_fmu(run, fmu, tmp_path):
    out = tmp_path / "joint.fmu"
    said = run("export", "--joint", JOINT, "--to", "fmu", "-o", out)
    assert said == (0, f"wrist-pin written to {out}\n", "")
    assert out.read_bytes() == fmu.read_bytes()


def test_without_a_compiler_one_line_says_how_to_get_one(run, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    code, said, errors = run("export", "--joint", JOINT, "--to", "fmu", "-o", tmp_path / "j.fmu")
    assert (code, said) == (2, "")
    assert errors == (
        "cylcontact: export: --to = 'fmu': needs a C compiler, and there is neither cc nor gcc; "
        "install one (Debian: apt install gcc libc6-dev; macOS: xcode-select --install)\n"
    )
    assert list(tmp_path.iterdir()) == []


def test_a_compiler_that_fails_is_told_in_one_line(tmp_path, monkeypatch, joint):
    fake_program(tmp_path, "cc", "echo no headers >&2\necho more >&2\nexit 1")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError) as caught:
        export_joint(joint, "fmu")
    assert str(caught.value).endswith("cc failed: no headers; check that it compiles a C program")
