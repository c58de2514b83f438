"""The slider-crank with a clearance as a model of Exudyn, a general multibody code.

Planar rigid bodies, revolute joints, the crank kept at its speed by a constraint on its velocity,
and a sphere in a hollow sphere for the journal in its bearing: pressed in the plane of motion,
a contact F = K·δⁿ of the same line of action as ours. Its steps are all of one size.
"""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

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
    ObjectGround,
    ObjectJointRevolute2D,
    ObjectRigidBody2D,
    SensorBody,
)

from cylcontact.laws.power import PowerShaped
from cylcontact.mechanism import Trajectory


@dataclass(frozen=True)
class Run:
    """The journal in its bearing, at every step: time in s, penetration in m.

    `seconds` is what the solution took, without building and assembling the model.
    """

    time: np.ndarray
    penetration: np.ndarray
    seconds: float


def simulate_in_exudyn(mechanism, start: Trajectory, end: float, step: float) -> Run:
    """Simulate a slider-crank without friction or dissipation to a time, in steps of one size.

    Parameters
    ----------
    mechanism : Mechanism
        As `read_mechanism` returns it; its law a power law, ce = 1 and no friction.
    start : Trajectory
        A run of ours, to begin where it begins.
    end, step : float
        In s.
    """
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    sensors = _assemble(system, mechanism, start)
    with _quiet():
        system.Assemble()
        settings = _settings(end, step)
        started = time.perf_counter()
        system.SolveDynamic(settings, solverType=exudyn.DynamicSolverType.TrapezoidalIndex2)
        seconds = time.perf_counter() - started
    bearing, journal = (system.GetSensorStoredData(sensor) for sensor in sensors)
    eccentricity = np.hypot(*(bearing - journal)[:, 1:3].T)
    return Run(bearing[:, 0], eccentricity - mechanism.clearance.radial, seconds)


def _assemble(system, mechanism, start: Trajectory) -> tuple[int, int]:
    """Build the model; return the sensors of the bearing's and of the journal's centre."""
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
        if joint.kind == "revolute" and joint.name != mechanism.clearance.joint:
            pins = [marker(joint.i, joint.point_i), marker(joint.j, joint.point_j)]
            system.AddObject(ObjectJointRevolute2D(markerNumbers=pins))
    _guide(system, nodes, mechanism.driver.speed)
    return _contact(system, mechanism.clearance, marker, bodies)


def _guide(system, nodes: list[int], speed: float) -> None:
    """Keep the crank at its speed, and the slider on its line."""
    fixed = system.AddMarker(
        MarkerNodeCoordinate(nodeNumber=system.AddNode(NodePointGround()), coordinate=0)
    )
    crank, _, slider = nodes
    for node, coordinate, offset, of_velocity in (
        (crank, 2, speed, True),
        (slider, 1, 0.0, False),
        (slider, 2, 0.0, False),
    ):
        moving = system.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
        system.AddObject(
            ObjectConnectorCoordinate(
                markerNumbers=[fixed, moving], offset=offset, velocityLevel=of_velocity
            )
        )


def _contact(system, clearance, marker, bodies: list[int]) -> tuple[int, int]:
    """Put the journal into its bearing, and sensors on both."""
    law: PowerShaped = clearance.law
    factor, n = law.factor_and_exponent(clearance.pair)
    data = system.AddNode(NodeGenericData(numberOfDataCoordinates=4, initialCoordinates=[0.0] * 4))
    centres = [
        marker(clearance.j, clearance.point_j),
        marker(clearance.i, clearance.point_i),
    ]
    system.AddObject(
        ObjectContactSphereSphere(
            markerNumbers=centres,
            nodeNumber=data,
            spheresRadii=[clearance.R_bearing - clearance.radial, clearance.R_bearing],
            isHollowSphere1=True,
            # N/mm per mmⁿ, times the length in mm, to N per mⁿ.
            contactStiffness=float(factor) * clearance.length * 1000 ** float(n),
            contactStiffnessExponent=float(n),
            restitutionCoefficient=1.0,
            impactModel=1,
        )
    )

    def sensor(body: int, point) -> int:
        return system.AddSensor(
            SensorBody(
                bodyNumber=bodies[body],
                localPosition=[*point, 0.0],
                outputVariableType=exudyn.OutputVariableType.Position,
                storeInternal=True,
                writeToFile=False,
            )
        )

    return sensor(clearance.i, clearance.point_i), sensor(clearance.j, clearance.point_j)


def _settings(end: float, step: float):
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps = round(end / step)
    settings.timeIntegration.endTime = end
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.adaptiveStep = False
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
