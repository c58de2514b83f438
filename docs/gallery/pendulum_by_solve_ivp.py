"""A pendulum on a pin, by SciPy.

A pendulum hangs on a pin with clearance, and `solve_ivp` integrates it. Beginning and end of each
contact are events.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp

from cylcontact.files.spec import read_toml
from cylcontact.mechanism import JointState, joint_from

MASS, INERTIA, ARM, END = 0.8, 2e-3, 80.0, 0.4  # kg, kg m², mm, s
data = read_toml(Path(__file__).parents[2] / "datasets/joint.toml")
data["law"], data["dissipation"]["restitution"] = "explicit", 0.7
data["bearing"] |= {"point": [-ARM, 0.0]}  # from the centre of mass of the pendulum
joint, pin = joint_from(data), np.zeros(6)
state, contacts = joint.start(), []
# It is let go lying, the hole around the pin.
t, y, path = 0.0, np.array([1e-3 * ARM, 0.0, 0.0, 0.0, 0.0, 0.0]), []


def rates(_, y):
    force_x = force_y = moment = 0.0
    if state.impact_rate > 0:  # else a trial step may press already
        wrench = joint.evaluate(state, y, pin)
        (force_x, force_y), moment = wrench.force_bearing, wrench.moment_bearing
    return [*y[3:], force_x / MASS, force_y / MASS - 9.81, moment / INERTIA]


def touch(_, y):
    return 1e3 * float(joint.evaluate(JointState(0.0), y, pin).penetration)


touch.terminal = True
while t < END:
    touching = state.impact_rate > 0
    touch.direction = -1 if touching else 1
    part = solve_ivp(
        rates, (t, END), y, "DOP853", events=touch, rtol=1e-8, atol=1e-11, first_step=1e-9,
        max_step=1e-4 if touching else 1e-3,
    )  # fmt: skip
    t, y = part.t[-1], part.y[:, -1]
    path.append(part.y)
    if touching:
        state = joint.start()
    elif t < END:
        speed = float(joint.evaluate(state, y, pin).penetration_rate)
        state = JointState(max(speed, joint.rate_floor))
        contacts.append((1e3 * t, 1e3 * speed))
print(f"{len(contacts)} contacts, the first after {contacts[0][0]:.3f} ms")
x, y, angle = np.hstack(path)[:3]
hole_x, hole_y = 1e3 * x - ARM * np.cos(angle), 1e3 * y - ARM * np.sin(angle)
figure, (of_hole, of_speed) = plt.subplots(1, 2, figsize=(6.4, 3.6), layout="constrained")
of_hole.plot(1e3 * hole_x, 1e3 * hole_y, linewidth=0.8)
of_hole.add_patch(plt.Circle((0, 0), 1e3 * joint.radial, fill=False, linestyle=":"))
of_hole.set(xlabel="hole from the pin, x (µm)", ylabel="y (µm)", aspect="equal")
of_speed.semilogy(*np.transpose(contacts), ".")
of_speed.set(xlabel="time (ms)", ylabel="impact speed (mm/s)")
figure.savefig("pendulum_by_solve_ivp.png", dpi=112)
