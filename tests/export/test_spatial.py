"""The joint in space in other languages: as the library's own, in all kinds of contact."""

from collections import Counter
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid
from scipy.spatial.transform import Rotation

from cylcontact.export import export_joint
from cylcontact.joint.contact import NOT_A_NUMBER
from cylcontact.mechanism import SpatialJoint
from tests.support.fmu_masters import Cosim, Fmu, export_fmu
from tests.support.joint_runners import RUNNERS
from tests.support.programs import require_package
from tests.support.spatial_cases import FIXED, body, joint_for, motions, run_library

THRUST = {"play": 0.2, "radius": 12.0, "stiffness": 2e5, "restitution": 0.5}
KINDS = {
    "example": {"thrust": THRUST},
    "ends, in mm": {
        "pin.ends": [-9.5, 9.0], "edge": {"c": 0.1, "b": 0.5}, "units": "mm", "law": "johnson",
        "thrust": THRUST,
        "bearing.yield_stress": 300.0, "pin.yield_stress": 300.0,
    },
    "crown and table": {"pin.crown": 0.004, "law": "conformal"},
    "crown the other way, the law ends": {
        "pin.crown": 0.004, "pin.axis": [0, 0, -1], "pin.ends": [-11.0, 9.95], "law": "johnson",
        "edge": {"c": 0.1, "b": 0.5},
    },
    "flush in a housing": {
        "edge.kind": "flush", "law": "conformal", "housing": {"R_o": 20.0}, "thrust": THRUST
    },
}  # fmt: skip
# Octave takes a tenth of a second for each.
ROWS = {"matlab": 60}


def rows_of(joint, rows, seed=11):
    rates, pins = motions(joint, rows, seed)
    return np.hstack([rates, np.tile(FIXED, (rows, 1)), pins])


def answers_of_library(joint, rows):
    return run_library(joint, rows[:, :4], rows[:, 4:17], rows[:, 17:])


def with_unknowns(joint, rows):
    """Add a state in contact thirteen times, each with one number of the pin's motion unknown."""
    (touching, *_) = rows[answers_of_library(joint, rows)[:, 12] > 0]
    unknown = np.tile(touching, (13, 1))
    unknown[:, :4] = 0.0
    np.fill_diagonal(unknown[:, 17:], np.nan)
    return np.vstack([rows, unknown])


# In other languages than C one kind each, the rest before a change goes in.
ONE = {"fortran": "crown the other way, the law ends", "matlab": "crown and table"}
CASES = [
    pytest.param(target, kind, marks=[pytest.mark.slow] * (ONE.get(target, kind) != kind))
    for target, kind in product(RUNNERS, KINDS)
]


@pytest.mark.parametrize(("target", "kind"), CASES)
def test_exports_agree_with_the_library_in_all_kinds_of_contact(target, kind, tmp_path):
    """To 1e-12 of the peak of each part of the wrench, and of each accepted rate.

    A file has a coarser curve of conformal contact, to 1e-8. A motion that is not a number has no
    force and no impact rate.
    """
    joint = joint_for(**KINDS[kind])
    rows = with_unknowns(joint, rows_of(joint, ROWS.get(target, 1000)))
    answers, wanted = RUNNERS[target](joint, rows, tmp_path), answers_of_library(joint, rows)
    touching = wanted[:-13, 12:16] > 0
    kinds = {(*map(bool, row[:2]), bool(row[2:].any())) for row in touching}
    assert len(kinds) >= 4
    assert np.isfinite(wanted[:-13]).all()
    assert np.isnan(wanted[-13:, :12]).all()
    assert np.isnan(wanted[-13:, -4:-2]).any(axis=1).all()
    assert (wanted[-13:, 24].astype(int) & NOT_A_NUMBER).all()
    at, allowed = 0, 1e-8 if joint.planar.law.name == "conformal" else 1e-12
    for size in (3, 3, 3, 3, 4, 4, 1, 1, 1, 1, 1, 4):
        part, own = answers[:, at : at + size], wanted[:, at : at + size]
        np.testing.assert_allclose(part, own, rtol=0, atol=allowed * np.nanmax(np.abs(own)))
        at += size


def test_the_fmu_gives_the_numbers_of_the_library(tmp_path):
    """At events of random motions; at the end of a step in which the pin turns and flies."""
    fmpy = require_package("fmpy")
    require_package("libcosimpy")
    from fmpy.validation import validate_fmu

    joint, size = joint_for(**KINDS["example"]), 1e-6
    path = export_fmu(joint, tmp_path)
    assert not validate_fmu(str(path))
    count = Counter(v.causality for v in fmpy.read_model_description(path).modelVariables)
    assert (count["input"], count["output"], count["local"]) == (26, 25, 4)
    model = Fmu(path, tmp_path / "model", inputs=[*FIXED, *FIXED])
    slave = Fmu(path, tmp_path / "slave", "CoSimulation", [*FIXED, *FIXED])
    master = Cosim(path, size)
    state = moved = joint.start()
    for step, row in enumerate(rows_of(joint, 200)):
        bearing, pin = row[4:17], row[17:]
        if np.abs(joint.evaluate(state, bearing, pin).penetration).min() < 1e-8:
            continue
        state = joint.accept(state, bearing, pin)
        wrench = joint.evaluate(state, bearing, pin)
        model.at_event(row[4:])
        wanted = np.hstack([*wrench, state.impact_rate])
        np.testing.assert_allclose(
            [*model.wrench, *model.impact_rate], wanted, rtol=1e-9, atol=1e-9
        )
        np.testing.assert_allclose(model.indicators, wrench.penetration, rtol=0, atol=1e-15)
        # In co-simulation, in FMPy and in libcosim.
        later = pin.copy()
        later[:3] += size * pin[7:10]
        turned = Rotation.from_rotvec(size * pin[10:])
        turned *= Rotation.from_quat(pin[3:7], scalar_first=True)
        later[3:7] = turned.as_quat(scalar_first=True)
        moved = joint.accept(moved, bearing, later)
        slave.set(row[4:])
        slave.fmu.doStep(step * size, size)
        wanted = np.hstack(joint.evaluate(moved, bearing, later))
        np.testing.assert_allclose(slave.wrench, wanted, rtol=1e-6, atol=1e-6)
        theirs = master.step(slave.inputs, row[4:], slave.outputs)
        np.testing.assert_allclose(theirs, slave.wrench[:-1], rtol=1e-12, atol=1e-12)


@pytest.mark.slow
def test_a_leaf_that_rattles_in_exudyn_keeps_its_energy():
    """By user functions around the exported joint: stored, moved, lifted and lost make one sum."""
    exu, items = require_package("exudyn"), require_package("exudyn.itemInterface")
    mass, inertia, step, steps, weight = 2.0, np.array([2e-3, 4e-3, 5e-3]), 2e-6, 2500, 2.0 * 9.81
    joint = joint_for(**{"pin.point": [-60.0, 0.0, 0.0]}, thrust=THRUST)
    rows, state = [], joint.start()
    system = exu.SystemContainer().AddSystem()
    node = system.AddNode(items.NodeRigidBodyRotVecLG(
        referenceCoordinates=[0.06, 0, 0, 0, 0, 0], initialVelocities=[0.1, 0, 0, 0.5, 3, -2]
    ))  # fmt: skip
    system.AddObject(items.ObjectRigidBody(
        mass=mass, inertia=[*inertia, 0, 0, 0], nodeNumber=node
    ))  # fmt: skip
    marker, kinds = system.AddMarker(items.MarkerNodeRigid(nodeNumber=node)), exu.OutputVariableType

    def pin():
        wanted = kinds.Position, kinds.RotationMatrix, kinds.Velocity, kinds.AngularVelocity
        position, rotation, velocity, spin = (system.GetNodeOutput(node, k) for k in wanted)
        turn = Rotation.from_matrix(rotation.reshape(3, 3))
        return body(position, turn, velocity, spin)

    def force(*_):
        return joint.evaluate(state, FIXED, pin()).force_pin - np.array([0, 0, weight])

    def torque(*_):
        return joint.evaluate(state, FIXED, pin()).moment_pin

    def accept(*_):
        nonlocal state
        moved = pin()
        state = joint.accept(state, FIXED, moved)
        w = joint.evaluate(state, FIXED, moved)
        rows.append([*moved, *w.penetration, w.elastic_energy, w.dissipated_power])
        return True

    system.AddLoad(items.LoadForceVector(markerNumber=marker, loadVectorUserFunction=force))
    system.AddLoad(items.LoadTorqueVector(markerNumber=marker, loadVectorUserFunction=torque))
    system.SetPostStepUserFunction(accept)
    system.Assemble()
    settings = exu.SimulationSettings()
    time = settings.timeIntegration
    time.numberOfSteps, time.endTime, time.verboseMode = steps, steps * step, 0
    settings.solution.file.write = False
    system.SolveDynamic(settings, solverType=exu.DynamicSolverType.RK44)
    pins, (*depths, stored, power) = np.array(rows)[:, :13], np.array(rows)[:, 13:].T
    spin = Rotation.from_quat(pins[:, 3:7], scalar_first=True).inv().apply(pins[:, 10:])
    moving = 0.5 * mass * (pins[:, 7:10] ** 2).sum(axis=1) + 0.5 * spin**2 @ inertia
    lost = cumulative_trapezoid(power, dx=step, initial=0.0)
    energy = moving + weight * pins[:, 2] + stored + lost
    assert (np.max(depths, axis=1) > 0).all()
    assert np.ptp(energy) < 1e-3 * lost[-1]


def test_the_command_writes_a_spatial_joint(run, tmp_path):
    out = tmp_path / "hinge.c"
    file = Path(__file__).resolve().parents[2] / "datasets/spatial_joint.toml"
    code, printed, err = run("export", "--joint", file, "--to", "c", "-o", out)
    assert (code, err) == (0, "")
    assert printed == f"hinge-pin written to {out}, {out.with_suffix('.h')}\n"
    texts = export_joint(SpatialJoint.read(file), "c", "hinge")
    assert {p.name: p.read_text(encoding="ascii") for p in tmp_path.iterdir()} == texts
