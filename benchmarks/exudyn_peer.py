"""The slider-crank with a clearance as a model of Exudyn, a general multibody code.

Planar rigid bodies, revolute joints, the crank kept at its speed by a constraint on its velocity.
For the journal in its bearing either Exudyn's own sphere in a hollow sphere: pressed in the plane
of motion, a contact F = K·δⁿ of the same line of action as ours; or our joint as `cylcontact export
--to python` writes it, a user function for the forces on the two bodies. Steps are of one size.
"""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import exudyn
import numpy as np
from exudyn.itemInterface import (
    MarkerBodyRigid,
    MarkerNodeCoordinate,
    NodeGenericData,
    NodePointGround,
    NodeRigidBody2D,
    ObjectConnectorCoordinate,
    ObjectContactSphereSphere,
    ObjectGenericODE2,
    ObjectGround,
    ObjectJointRevolute2D,
    ObjectRigidBody2D,
    SensorMarker,
    SensorNode,
    SensorObject,
)
from scipy.integrate import cumulative_trapezoid

from cylcontact.laws.power import PowerShaped
from cylcontact.mechanism import ClearanceJoint, Trajectory, joint_from

_OUTPUT = exudyn.OutputVariableType


@dataclass(frozen=True)
class Run:
    """Time, penetration and energies at every step, in SI, and the seconds of the solution."""

    time: np.ndarray
    penetration: np.ndarray
    seconds: float
    kinetic_energy: np.ndarray
    drive_work: np.ndarray
    dissipated: np.ndarray | None = None


def simulate_in_exudyn(
    mechanism, start: Trajectory, end: float, step: float, joint: ModuleType | None = None
) -> Run:
    """Simulate a slider-crank to a time in s, from where a run of ours begins, in equal steps.

    The contact is an exported joint, or else Exudyn's own: its law must then be a power law, its
    dissipation that of Hunt and Crossley; the friction differs below the speed v1.
    """
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    nodes, marker = _assemble(system, mechanism, start)
    clearance = mechanism.clearance
    powers = None
    if joint is None:
        _contact(system, clearance, marker)
    else:
        powers = _our_contact(system, joint, nodes[clearance.i], nodes[clearance.j])
    centres = [
        _sensor(system, SensorMarker, "Position", markerNumber=marker(*end_of))
        for end_of in ((clearance.i, clearance.point_i), (clearance.j, clearance.point_j))
    ]
    speeds = [_sensor(system, SensorNode, "Coordinates_t", nodeNumber=node) for node in nodes]
    drive = _guide(system, nodes, mechanism.driver.speed)
    moment = _sensor(system, SensorObject, "Force", objectNumber=drive)
    with _quiet():
        system.Assemble()
        settings = _settings(end, step)
        started = time.process_time()
        system.SolveDynamic(settings, solverType=exudyn.DynamicSolverType.TrapezoidalIndex2)
        seconds = time.process_time() - started
    stored = system.GetSensorStoredData
    bearing, journal = (stored(sensor) for sensor in centres)
    times = bearing[:, 0]
    eccentricity = np.hypot(*(bearing - journal)[:, 1:3].T)
    energy = sum(
        0.5 * stored(sensor)[:, 1:4] ** 2 @ [body.mass, body.mass, body.inertia]
        for sensor, body in zip(speeds, mechanism.bodies, strict=True)
    )
    power = stored(moment)[:, 1] * -mechanism.driver.speed
    return Run(
        times,
        eccentricity - 1e-3 * clearance.contact.radial,
        seconds,
        np.asarray(energy),
        cumulative_trapezoid(power, times, initial=0.0),
        None if powers is None else _integral(powers, times),
    )


def joint_of(mechanism, **changes) -> ClearanceJoint:
    """Return a mechanism's clearance joint as a force element in SI units."""
    clearance = mechanism.clearance
    points = {
        body: clearance.contact.data[body] | {"point": [1e3 * x for x in point]}
        for body, point in (("bearing", clearance.point_i), ("pin", clearance.point_j))
    }
    return joint_from(clearance.contact.data | points | changes)


def _integral(powers: list[tuple[float, float]], times: np.ndarray) -> np.ndarray:
    """Return the work done up to some times by powers at other times."""
    at, power = np.array(powers).T
    return np.interp(times, at, cumulative_trapezoid(power, at, initial=0.0))


def _assemble(system, mechanism, start: Trajectory):
    """Build bodies and ideal joints; return the nodes, and a function that places markers."""
    nodes, bodies = [], []
    for k, body in enumerate(mechanism.bodies):
        node = system.AddNode(
            NodeRigidBody2D(
                referenceCoordinates=start.coordinates[0, k],
                initialVelocities=start.velocities[0, k],
            )
        )
        shape = ObjectRigidBody2D(mass=body.mass, inertia=body.inertia, nodeNumber=node)
        nodes.append(node)
        bodies.append(system.AddObject(shape))
    ground = system.AddObject(ObjectGround())

    def marker(body: int, point) -> int:
        return system.AddMarker(
            MarkerBodyRigid(
                bodyNumber=ground if body < 0 else bodies[body], localPosition=[*point, 0.0]
            )
        )

    for joint in mechanism.joints:
        if joint.kind == "revolute" and joint.clearance is None:
            pins = [marker(joint.i, joint.point_i), marker(joint.j, joint.point_j)]
            system.AddObject(ObjectJointRevolute2D(markerNumbers=pins))
    return nodes, marker


def _guide(system, nodes: list[int], speed: float) -> int:
    """Keep the slider on its line, and the crank at its speed; return the drive."""
    fixed = system.AddMarker(
        MarkerNodeCoordinate(nodeNumber=system.AddNode(NodePointGround()), coordinate=0)
    )
    crank, _, slider = nodes
    for node, coordinate, offset, of_velocity in (
        (slider, 1, 0.0, False),
        (slider, 2, 0.0, False),
        (crank, 2, speed, True),
    ):
        moving = system.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
        constraint = system.AddObject(
            ObjectConnectorCoordinate(
                markerNumbers=[fixed, moving], offset=offset, velocityLevel=of_velocity
            )
        )
    return constraint


def _our_contact(system, joint: ModuleType, bearing: int, pin: int) -> list[tuple[float, float]]:
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
        ObjectGenericODE2(
            nodeNumbers=[bearing, pin], massMatrix=np.zeros((6, 6)), forceUserFunction=forces
        )
    )
    system.SetPostStepUserFunction(accept)
    return powers


def _contact(system, clearance, marker) -> None:
    """Put the journal into its bearing, with Exudyn's own contact."""
    contact = clearance.contact
    law: PowerShaped = contact.law
    factor, n = law.factor_and_exponent(contact.pair)
    data = system.AddNode(NodeGenericData(numberOfDataCoordinates=4, initialCoordinates=[0.0] * 4))
    centres = [
        marker(clearance.j, clearance.point_j),
        marker(clearance.i, clearance.point_i),
    ]
    system.AddObject(
        ObjectContactSphereSphere(
            markerNumbers=centres,
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
