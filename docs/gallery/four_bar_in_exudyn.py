"""A four-bar in Exudyn.

Exudyn solves a four-bar linkage with a clearance joint of this package between coupler and rocker.
The joint is a user function; its state is updated after each accepted step.
"""

from pathlib import Path

import exudyn as exu
import matplotlib.pyplot as plt
import numpy as np
from exudyn import itemInterface as items  # noqa: N813

from cylcontact.files.spec import read_toml
from cylcontact.mechanism import joint_from

# Crank, coupler and rocker: length in m, mass in kg, inertia about the centre in kg m².
LINKS = [(0.04, 0.20, 5e-5), (0.12, 0.30, 4e-4), (0.09, 0.25, 2e-4)]
GROUND, OMEGA, END, STEP = 0.14, 2 * np.pi * 10, 0.015, 4e-6  # m, rad/s, s, s

# The start: the crank lies along the ground, and the circles of coupler and rocker meet at C.
(crank, coupler, rocker), base = (length for length, _, _ in LINKS), GROUND - LINKS[0][0]
x = (coupler**2 - rocker**2 + base**2) / (2 * base)
corners = np.array([0, crank, crank + x + 1j * np.sqrt(coupler**2 - x**2), GROUND])
bars = np.diff(corners)
# The crank turns at OMEGA, and the three bars stay a closed loop.
turning = 1j * bars
matrix = np.array([[turning[1].real, turning[2].real], [turning[1].imag, turning[2].imag]])
spins = [OMEGA, *np.linalg.solve(matrix, -OMEGA * np.array([turning[0].real, turning[0].imag]))]
corner_speeds = np.cumsum([0, *(spins * turning)])

data = read_toml(Path(__file__).parents[2] / "datasets/joint.toml")
data |= {"law": "explicit", "name": "rocker-pin"}
data["pin"] |= {"R": 9.9, "point": [-500 * rocker, 0.0]}  # mm, from the centre of the rocker
data["bearing"] |= {"point": [500 * coupler, 0.0]}
joint = joint_from(data)

system = exu.SystemContainer().AddSystem()
ground, nodes, bodies = system.AddObject(items.ObjectGround()), [], []
for k, (_, mass, inertia) in enumerate(LINKS):
    at, speed = corners[k] + bars[k] / 2, (corner_speeds[k] + corner_speeds[k + 1]) / 2
    place = [at.real, at.imag, np.angle(bars[k])]
    motion = [speed.real, speed.imag, spins[k]]
    node = items.NodeRigidBody2D(referenceCoordinates=place, initialVelocities=motion)
    nodes.append(system.AddNode(node))
    body = items.ObjectRigidBody2D(mass=mass, inertia=inertia, nodeNumber=nodes[-1])
    bodies.append(system.AddObject(body))
    mark = system.AddMarker(items.MarkerBodyMass(bodyNumber=bodies[-1]))
    system.AddLoad(items.LoadMassProportional(markerNumber=mark, loadVector=[0, -9.81, 0]))


def pinned(first, x_first, second, x_second):
    """Join two bodies at points on their axes."""
    ends = (first, x_first), (second, x_second)
    marks = [
        system.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=[x, 0, 0]))
        for body, x in ends
    ]
    system.AddObject(items.ObjectJointRevolute2D(markerNumbers=marks))


pinned(ground, 0.0, bodies[0], -crank / 2)
pinned(bodies[0], crank / 2, bodies[1], -coupler / 2)
pinned(bodies[2], rocker / 2, ground, GROUND)
fixed, moving = (
    system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
    for node, coordinate in ((system.AddNode(items.NodePointGround()), 0), (nodes[0], 2))
)
system.AddObject(
    items.ObjectConnectorCoordinate(markerNumbers=[fixed, moving], offset=OMEGA, velocityLevel=True)
)

# The joint: `evaluate` in trial steps, `accept` after each accepted one.
pair, state, history = nodes[1:], joint.start(), []
rest = [np.array(system.GetNode(node)["referenceCoordinates"]) for node in pair]


def motions(q, v):
    return [np.array([*(q[3 * k : 3 * k + 3] + rest[k]), *v[3 * k : 3 * k + 3]]) for k in (0, 1)]


def force(_system, _t, _number, q, v):
    wrench = joint.evaluate(state, *motions(np.array(q), np.array(v)))
    return [*wrench.force_bearing, wrench.moment_bearing, *wrench.force_pin, wrench.moment_pin]


def accept(_system, t):
    global state  # noqa: PLW0603
    kinds = exu.OutputVariableType.Coordinates, exu.OutputVariableType.Coordinates_t
    now = motions(*(np.hstack([system.GetNodeOutput(n, kind) for n in pair]) for kind in kinds))
    state = joint.accept(state, *now)
    history.append((t, float(joint.evaluate(state, *now).normal_force)))
    return True


system.AddObject(
    items.ObjectGenericODE2(nodeNumbers=pair, massMatrix=np.zeros((6, 6)), forceUserFunction=force)
)
system.SetPostStepUserFunction(accept)
system.Assemble()
settings = exu.SimulationSettings()
settings.timeIntegration.endTime, settings.timeIntegration.verboseMode = END, 0
settings.timeIntegration.numberOfSteps = round(END / STEP)
settings.timeIntegration.newton.useModifiedNewton = True
settings.solution.file.write = False
system.SolveDynamic(settings, solverType=exu.DynamicSolverType.TrapezoidalIndex2)
time, load = np.transpose(history)
print(f"{np.count_nonzero(np.diff(load > 0)) // 2} contacts, up to {load.max():.0f} N")
figure, axes = plt.subplots(figsize=(5.0, 2.81), layout="constrained")
axes.plot(1e3 * time, load, linewidth=0.8)
axes.set(xlabel="time (ms)", ylabel="normal force (N)")
figure.savefig("four_bar_in_exudyn.png", dpi=144)
