"""The slider-crank with a clearance as a model of Exudyn, a general multibody code.

Planar rigid bodies, revolute joints, a crank of constant speed. The journal in its bearing is
either Exudyn's own sphere in a hollow sphere, F = K·δⁿ, or our joint as a user function.
"""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import exudyn.itemInterface
import numpy as np
from scipy.integrate import cumulative_trapezoid

from cylcontact.files.spec import read_toml
from cylcontact.mechanism import ClearanceJoint, Motion, SliderCrank, joint_from, mechanism_from

SPEC = Path(__file__).parents[1] / "datasets" / "slider_crank.toml"
exu, _OUTPUT = exudyn.itemInterface, exudyn.OutputVariableType


class Run(NamedTuple):
    """Time, penetration and energies at every step, in SI, and the seconds of the solution."""

    time: np.ndarray
    penetration: np.ndarray
    seconds: float
    kinetic_energy: np.ndarray
    drive_work: np.ndarray
    dissipated: np.ndarray | None


def simulate_in_exudyn(mechanism: SliderCrank, end: float, step: float, joint: Any = None) -> Run:
    """Simulate a slider-crank to a time in s, in equal steps.

    The contact is a joint with `start`, `evaluate` and `accept`, or else Exudyn's own: its law must
    then be a power law, its dissipation that of Hunt and Crossley; the friction differs below v1.
    """
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    nodes, marker = _assemble(system, mechanism)
    ends = [marker(*end) for end in _ends(mechanism)]
    powers = None
    if joint is None:
        _contact(system, mechanism.joint, ends)
    else:
        powers = _our_contact(system, joint, *(nodes[body] for body, _ in _ends(mechanism)))
    drive = _guide(system, nodes, mechanism.omega)
    centres = [_sensor(system, exu.SensorMarker, "Position", markerNumber=each) for each in ends]
    speeds = [_sensor(system, exu.SensorNode, "Coordinates_t", nodeNumber=node) for node in nodes]
    moment = _sensor(system, exu.SensorObject, "Force", objectNumber=drive)
    with _quiet():
        system.Assemble()
        settings = _settings(end, step)
        started = time.process_time()
        system.SolveDynamic(settings, solverType=exudyn.DynamicSolverType.TrapezoidalIndex2)
        seconds = time.process_time() - started
    stored = system.GetSensorStoredData
    times = stored(moment)[:, 0]
    bearing, journal = (stored(sensor)[:, 1:3] for sensor in centres)
    energy = sum(
        0.5 * stored(sensor)[:, 1:4] ** 2 @ [mass, mass, inertia]
        for sensor, (mass, inertia) in zip(speeds, _inertias(mechanism), strict=True)
    )
    return Run(
        times,
        np.hypot(*(bearing - journal).T) - 1e-3 * mechanism.joint.radial,
        seconds,
        energy,
        _work(times, stored(moment)[:, 1] * -mechanism.omega)[1],
        None if powers is None else np.interp(times, *_work(*np.transpose(powers))),
    )


def slider_crank(restitution: float, friction: float) -> SliderCrank:
    """Return a mechanism with the dissipation of Exudyn's contact."""
    data = read_toml(SPEC)
    data["joint"]["dissipation"]["factor"] = "hunt-crossley"
    return mechanism_from(data, str(SPEC), restitution=restitution, friction=friction)


def imbalance(mechanism: SliderCrank, run: Run) -> float:
    """Return the largest error of the balance of energy of a run with our joint, in J."""
    contact = mechanism.joint
    delta = np.linspace(0, 1010 * max(run.penetration.max(), 1e-6), 4001)  # mm
    force = np.nan_to_num(contact.law.load(delta, contact.pair)) * contact.pair.length
    energy = 1e-3 * cumulative_trapezoid(force, delta, initial=0.0)
    stored = np.interp(np.maximum(run.penetration, 0) * 1e3, delta, energy)
    total = run.kinetic_energy + stored + run.dissipated
    return float(np.abs(total - total[0] - run.drive_work).max())


def joint_of(mechanism: SliderCrank) -> ClearanceJoint:
    """Return a mechanism's clearance joint as a force element in SI units."""
    data, (bearing, pin) = mechanism.joint.data, _ends(mechanism)
    points = {
        body: data[body] | {"point": [1e3 * x for x in point]}
        for body, (_, point) in (("bearing", bearing), ("pin", pin))
    }
    return joint_from(data | points)


def _ends(mechanism: SliderCrank) -> list[tuple[int, tuple[float, float]]]:
    """Return the bodies of bearing and pin (crank, rod, slider), with the centres in their axes."""
    rod = mechanism.spec.rod
    ends = [(1, (1e-3 * rod.length * (1 - rod.centre), 0.0)), (2, (0.0, 0.0))]
    return ends if mechanism.spec.bearing_of == "rod" else ends[::-1]


def _inertias(mechanism: SliderCrank) -> list[tuple[float, float]]:
    """Return mass and inertia of crank, rod and slider; the slider does not turn."""
    spec = mechanism.spec
    return [(b.mass, b.inertia) for b in (spec.crank, spec.rod)] + [(spec.slider.mass, 1.0)]


def _places(mechanism: SliderCrank) -> tuple[np.ndarray, np.ndarray]:
    """Return x, y, angle and their rates of crank, rod and slider at the start, shapes (3, 3)."""
    spec, omega = mechanism.spec, mechanism.omega
    angle = np.radians(spec.angle)
    E, E_rate = (complex(*part) for part in np.split(mechanism.start, 2))
    motion = Motion(mechanism, np.array([angle]), E, E_rate)
    A, phi, spin = (x[0] for x in (motion.crank_pin, motion.rod_angle, motion.rod_spin))
    arm = 1e-3 * spec.rod.length * spec.rod.centre * np.exp(1j * phi)
    crank, rod = spec.crank.centre * A, A + arm
    speeds = spec.crank.centre * 1j * omega * A, 1j * omega * A + 1j * spin * arm
    slider = motion.slider_position[0], 1e-3 * spec.offset, 0.0
    places = [[crank.real, crank.imag, angle], [rod.real, rod.imag, phi], slider]
    rates = [[speeds[0].real, speeds[0].imag, omega], [speeds[1].real, speeds[1].imag, spin]]
    return np.array(places), np.array([*rates, [motion.slider_velocity[0], 0.0, 0.0]])


def _work(time: np.ndarray, power: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return times and the work done until then."""
    return time, cumulative_trapezoid(power, time, initial=0.0)


def _assemble(system, mechanism: SliderCrank):
    """Build bodies and ideal joints; return the nodes, and a function that places markers."""
    nodes, bodies = [], []
    for place, rate, (mass, inertia) in zip(*_places(mechanism), _inertias(mechanism), strict=True):
        nodes.append(
            system.AddNode(exu.NodeRigidBody2D(referenceCoordinates=place, initialVelocities=rate))
        )
        shape = exu.ObjectRigidBody2D(mass=mass, inertia=inertia, nodeNumber=nodes[-1])
        bodies.append(system.AddObject(shape))
    bodies.append(system.AddObject(exu.ObjectGround()))

    def marker(body: int, point) -> int:
        place = [*point, 0.0]
        return system.AddMarker(exu.MarkerBodyRigid(bodyNumber=bodies[body], localPosition=place))

    crank, rod, ground = mechanism.spec.crank, mechanism.spec.rod, -1
    before, after = (1e-3 * crank.length * share for share in (-crank.centre, 1 - crank.centre))
    for first, second in (
        ((ground, (0.0, 0.0)), (0, (before, 0.0))),
        ((0, (after, 0.0)), (1, (-1e-3 * rod.length * rod.centre, 0.0))),
    ):
        pins = [marker(*first), marker(*second)]
        system.AddObject(exu.ObjectJointRevolute2D(markerNumbers=pins))
    return nodes, marker


def _guide(system, nodes: list[int], speed: float) -> int:
    """Keep the slider on its line, and the crank at its speed; return the drive."""
    fixed = system.AddMarker(
        exu.MarkerNodeCoordinate(nodeNumber=system.AddNode(exu.NodePointGround()), coordinate=0)
    )
    crank, _, slider = nodes
    for node, coordinate, offset, of_velocity in (
        (slider, 1, 0.0, False),
        (slider, 2, 0.0, False),
        (crank, 2, speed, True),
    ):
        moving = system.AddMarker(exu.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
        constraint = system.AddObject(
            exu.ObjectConnectorCoordinate(
                markerNumbers=[fixed, moving], offset=offset, velocityLevel=of_velocity
            )
        )
    return constraint


def _our_contact(system, joint: Any, bearing: int, pin: int) -> list[tuple[float, float]]:
    """Put our joint between two bodies; return the list of times and dissipated powers.

    Trial states are evaluated only; δ̇⁽⁻⁾ is kept or forgotten at the end of each step.
    """
    places = [np.array(system.GetNode(node)["referenceCoordinates"]) for node in (bearing, pin)]
    offsets = [*places[0], *places[1]]
    impact_rate, powers = joint.start(), [(0.0, 0.0)]

    def bodies(q, v):
        at = [x + x_0 for x, x_0 in zip(q, offsets, strict=True)]
        return (*at[:3], *v[:3]), (*at[3:], *v[3:])

    def forces(_system, _t, _number, q, v):
        w = joint.evaluate(impact_rate, *bodies(q, v))
        return [*w.force_bearing, w.moment_bearing, *w.force_pin, w.moment_pin]

    def coordinates(kind):
        return [x for node in (bearing, pin) for x in system.GetNodeOutput(node, kind)]

    def accept(_system, t):
        nonlocal impact_rate
        now = bodies(coordinates(_OUTPUT.Coordinates), coordinates(_OUTPUT.Coordinates_t))
        impact_rate = joint.accept(impact_rate, *now)
        powers.append((t, joint.evaluate(impact_rate, *now).dissipated_power))
        return True

    system.AddObject(
        exu.ObjectGenericODE2(
            nodeNumbers=[bearing, pin], massMatrix=np.zeros((6, 6)), forceUserFunction=forces
        )
    )
    system.SetPostStepUserFunction(accept)
    return powers


def _contact(system, contact: ClearanceJoint, ends: list[int]) -> None:
    """Put the journal into its bearing, with Exudyn's own contact, at markers of their centres."""
    factor, n = contact.law.factor_and_exponent(contact.pair)
    data = system.AddNode(
        exu.NodeGenericData(numberOfDataCoordinates=4, initialCoordinates=[0.0] * 4)
    )
    system.AddObject(
        exu.ObjectContactSphereSphere(
            markerNumbers=ends[::-1],
            nodeNumber=data,
            spheresRadii=[1e-3 * contact.pair.R_j, 1e-3 * contact.pair.R_i],
            isHollowSphere1=True,
            # N/mm per mmⁿ, times the length in mm, to N per mⁿ.
            contactStiffness=float(factor) * contact.pair.length * 1000 ** float(n),
            contactStiffnessExponent=float(n),
            dynamicFriction=contact.friction,
            frictionProportionalZone=1e-3 * contact.v1,
            # Hunt and Crossley's χ = 3(1 − e)/2.
            restitutionCoefficient=1.0 - contact.chi / 1.5,
            impactModel=1,
        )
    )


def _sensor(system, kind, output: str, **where: int) -> int:
    """Add a sensor that keeps what it reads."""
    variable = getattr(_OUTPUT, output)
    return system.AddSensor(
        kind(outputVariableType=variable, storeInternal=True, writeToFile=False, **where)
    )


def _settings(end: float, step: float):
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(end / step)
    settings.timeIntegration.endTime = end
    settings.timeIntegration.verboseMode = 0
    # A smaller step only where Newton's method does not converge, as with Exudyn's own friction.
    settings.timeIntegration.adaptiveStep = True
    settings.timeIntegration.discontinuous.useRecommendedStepSize = False
    settings.timeIntegration.newton.useModifiedNewton = True
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = step
    return settings


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Send what the C++ side prints to nowhere."""
    kept = os.dup(1)
    with Path(os.devnull).open("w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        try:
            yield
        finally:
            os.dup2(kept, 1)
            os.close(kept)
