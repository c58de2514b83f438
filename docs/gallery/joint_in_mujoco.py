"""A joint in MuJoCo.

The exported joint is a passive force in MuJoCo. A pin rattles in its bearing under gravity.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import mujoco
import numpy as np

from cylcontact.mechanism import read_joint

joint = read_joint(Path(__file__).parents[2] / "datasets/joint.toml")
model = mujoco.MjModel.from_xml_string("""
<mujoco><option timestep="1e-6" gravity="0 -9.81 0"/><worldbody><body>
<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><joint axis="0 0 1"/>
<geom type="cylinder" size=".00995 .005" mass="0.5" contype="0" conaffinity="0"/>
</body></worldbody></mujoco>""")
data, still, state, path = mujoco.MjData(model), [0.0] * 6, joint.start(), []


def force_on_pin(_, data):
    wrench = joint.evaluate(state, still, [*data.qpos, *data.qvel])
    data.qfrc_passive[:] += [*wrench.force_pin, wrench.moment_pin]


mujoco.set_mjcb_passive(force_on_pin)
data.qvel[:2] = 0.01, 0.02
for _ in range(30_000):
    mujoco.mj_step(model, data)
    state = joint.accept(state, still, [*data.qpos, *data.qvel])
    path.append(1e6 * data.qpos[:2].copy())
mujoco.set_mjcb_passive(None)
x, y = np.array(path).T
figure, axes = plt.subplots(figsize=(5.0, 2.81), layout="constrained")
axes.plot(x, y, linewidth=0.8)
axes.set(xlabel="x (µm)", ylabel="y (µm)", aspect="equal")
figure.savefig("joint_in_mujoco.png", dpi=144)
