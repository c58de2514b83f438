"""A joint in MATLAB or Octave.

The exported joint is run by Octave. A pin falls into its bearing and rolls up the other side.
"""

import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt
import numpy as np

from cylcontact.export import export_joint
from cylcontact.mechanism import read_joint

SCRIPT = """
element = joint();
mass = 0.5; inertia = 2.5e-5; step = 2e-6;
bearing = zeros(1, 6); pin = [3e-5 0 0 0 0 0]; rate = element.start();
for k = 0:9999
    wrench = element.evaluate(rate, bearing, pin);
    acceleration = [wrench.force_pin / mass - [0 9.81], wrench.moment_pin / inertia];
    pin(4:6) = pin(4:6) + step * acceleration;
    pin(1:3) = pin(1:3) + step * pin(4:6);
    rate = element.accept(rate, bearing, pin);
    if mod(k, 5) == 0
        printf("%g %g %g %g\\n", 1e3 * k * step, 1e6 * pin(1:2), wrench.normal_force);
    end
end
"""
joint = read_joint(Path(__file__).parents[2] / "datasets/joint.toml")
with TemporaryDirectory() as folder:
    for name, text in (export_joint(joint, "matlab", "joint") | {"run.m": SCRIPT}).items():
        Path(folder, name).write_text(text)
    command = ["octave-cli", "--no-gui", "--norc", "--quiet", "run.m"]
    run = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, check=True, timeout=300
    )
time, x, y, force = np.array([line.split() for line in run.stdout.splitlines()], float).T
figure, (of_path, of_force) = plt.subplots(1, 2, figsize=(6.4, 3.6), layout="constrained")
of_path.plot(x, y, linewidth=0.8)
of_path.set(xlabel="x (µm)", ylabel="y (µm)", aspect="equal")
of_force.plot(time, force, linewidth=0.8)
of_force.set(xlabel="time (ms)", ylabel="normal force (N)")
figure.savefig("joint_in_octave.png", dpi=112)
