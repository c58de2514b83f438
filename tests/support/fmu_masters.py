"""Masters for FMUs of clearance joints, and what they move: a journal under load."""

from ctypes import c_double
from pathlib import Path

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

from cylcontact.export.fmu import JointFmu
from cylcontact.export.joint import Element
from cylcontact.joint.clearance import JointState
from cylcontact.mechanism import read_joint

JOINT = Path(__file__).resolve().parents[2] / "datasets/joint.toml"
REALS = [v.name for v in JointFmu(Element(read_joint(JOINT))).variables]
INPUTS, OUTPUTS, PARAMETERS = list(range(12)), list(range(12, 24)), [25, 26, 27]


def export_fmu(joint, folder):
    """Write a joint's FMU; return its path."""
    from cylcontact.export import export_joint

    ((name, content),) = export_joint(joint, "fmu").items()
    path = folder / name
    path.write_bytes(content)
    return path


def started(path, folder, kind="ModelExchange", inputs=()):
    """Return an FMU in FMPy after its initialisation with these inputs, the first of its reals."""
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Model, FMU2Slave

    description = read_model_description(path)
    fmu = {"ModelExchange": FMU2Model, "CoSimulation": FMU2Slave}[kind](
        guid=description.guid,
        unzipDirectory=extract(path, folder),
        modelIdentifier=description.modelExchange.modelIdentifier,
        instanceName="joint",
    )
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    if len(inputs):
        fmu.setReal(range(len(inputs)), list(inputs))
    fmu.exitInitializationMode()
    return fmu


class Fmu:
    """An FMU in FMPy, in model exchange or co-simulation; several may come from one file."""

    def __init__(self, path, folder, kind="ModelExchange", motion=(0.0,) * 12):
        self.fmu = started(path, folder, kind, motion)
        if kind == "ModelExchange":
            self.event()

    def set(self, motion):
        self.fmu.setReal(INPUTS, list(motion))

    def get(self, *names):
        return self.fmu.getReal([REALS.index(name) for name in names])

    def wrench(self, motion):
        """Fx, Fy and moment on the bearing, and on the pin."""
        self.set(motion)
        return np.array(self.fmu.getReal(OUTPUTS[:6]))

    def indicator(self, motion):
        self.set(motion)
        values = (c_double * 1)()
        self.fmu.getEventIndicators(values, 1)
        return values[0]

    def completed(self, motion):
        self.set(motion)
        return self.fmu.completedIntegratorStep()[0]

    def event(self):
        self.fmu.newDiscreteStates()
        self.fmu.enterContinuousTimeMode()

    def at_event(self, motion):
        self.set(motion)
        self.fmu.enterEventMode()
        self.event()

    def step(self, t, size, motion):
        """In co-simulation: the wrench and the penetration after a step."""
        self.set(motion)
        self.fmu.doStep(t, size)
        return np.array(self.fmu.getReal(OUTPUTS[:7]))


class Cosim:
    """An FMU in libcosim, with the same step."""

    def __init__(self, path, size):
        from libcosimpy.CosimExecution import CosimExecution
        from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
        from libcosimpy.CosimManipulator import CosimManipulator
        from libcosimpy.CosimObserver import CosimObserver
        from libcosimpy.CosimSlave import CosimLocalSlave

        log_output_level(CosimLogLevel.WARNING)
        self.execution = CosimExecution.from_step_size(step_size=round(size * 1e9))  # ns
        self.slave = CosimLocalSlave(fmu_path=str(path), instance_name="joint")
        self.index = self.execution.add_local_slave(local_slave=self.slave)
        self.manipulator = CosimManipulator.create_override()
        self.execution.add_manipulator(manipulator=self.manipulator)
        self.observer = CosimObserver.create_last_value()
        self.execution.add_observer(observer=self.observer)

    def step(self, _t, _size, motion):
        self.manipulator.slave_real_values(self.index, INPUTS, [float(x) for x in motion])
        assert self.execution.step()
        return np.array(self.observer.last_real_values(self.index, OUTPUTS[:7]))


class Library:
    """`ClearanceJoint` for the same master."""

    def __init__(self, joint):
        self.joint, self.state = joint, joint.start()

    def _evaluate(self, motion):
        return self.joint.evaluate(self.state, motion[:6], motion[6:])

    def wrench(self, motion):
        w = self._evaluate(motion)
        return np.array([*w.force_bearing, w.moment_bearing, *w.force_pin, w.moment_pin])

    def indicator(self, motion):
        return float(self._evaluate(motion).penetration)

    def completed(self, motion):
        self.state = self.joint.accept(self.state, motion[:6], motion[6:])

    def at_event(self, motion):
        wrench = self._evaluate(motion)
        self.completed(motion)
        # The root is located to a rounding error, on either side.
        if -1e-12 < wrench.penetration <= 0 and wrench.penetration_rate > 0:
            self.state = JointState(max(float(wrench.penetration_rate), self.joint.rate_floor))


# A journal of a mass, with a spin, in a bearing at rest, under a constant force.
MASS, FORCE, SPIN = 0.5, np.array([30.0, -200.0]), 50.0  # kg, N, rad/s


def motion(t, y):
    return np.array([*(0.0,) * 6, y[0], y[1], SPIN * t, y[2], y[3], SPIN])


def acceleration(wrench):
    return (FORCE + wrench[3:5]) / MASS


def integrate(element, end, tolerance=1e-11):
    """Model exchange: integrate to a time, with an event wherever the contact changes.

    Returns times and states at every accepted step and event, and the times of the onsets.
    """
    times, states, onsets, touching = [0.0], [np.zeros(4)], [], False

    def derivative(t, y):
        return np.concatenate([y[2:], acceleration(element.wrench(motion(t, y)))])

    def indicator(t, y):
        return element.indicator(motion(t, y))

    while times[-1] < end:
        solver = DOP853(
            derivative, times[-1], states[-1], end, rtol=tolerance,
            atol=tolerance * np.array([1e-5, 1e-5, 1.0, 1.0]),
        )  # fmt: skip
        while solver.status == "running":
            solver.step()
            t, y = solver.t, solver.y
            changes = (indicator(t, y) > 0) != touching
            if changes:
                dense = solver.dense_output()
                t = brentq(lambda t, d=dense: indicator(t, d(t)), solver.t_old, t, xtol=1e-16)
                y, touching = dense(t), not touching
                if touching:
                    onsets.append(t)
            times.append(t)
            states.append(y)
            again = element.completed(motion(t, y))
            if changes or again:
                element.at_event(motion(t, y))
                break
    return np.array(times), np.array(states), np.array(onsets)


def cosimulate(element, end, size):
    """Co-simulation: positions at the steps, velocities half a step later (leapfrog).

    Returns times, positions and penetrations at the ends of the steps. The element moves the bodies
    on by a step at the velocities it is given, to where they are then.
    """
    x, v, rows = np.zeros(2), size / 2 * acceleration(np.zeros(6)), []
    for k in range(round(end / size)):
        out = element.step(k * size, size, motion(k * size, np.concatenate([x, v])))
        x = x + size * v
        v = v + size * acceleration(out)
        rows.append([(k + 1) * size, *x, out[6]])
    rows = np.array(rows)
    return rows[:, 0], rows[:, 1:3], rows[:, 3]
