"""A joint in C.

The joint of `datasets/joint.toml` is exported, compiled and hit by a pin of 0.2 kg. Damping makes
the force on the way out smaller than on the way in.
"""

import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt
import numpy as np

from cylcontact.export import export_joint
from cylcontact.mechanism import read_joint

MAIN = """
#include <stdio.h>
#include "joint.h"
int main(void) {
    const double bearing[6] = {0.0}, mass = 0.2, dt = 2e-8;
    double pin[6] = {0.0, -4.99e-5, 0.0, 0.0, -0.3, 0.0};
    NAME_state state; NAME_wrench wrench; NAME_start(&state);
    for (int step = 0; step < 20000 && pin[4] < 0.29; step++) {
        NAME_evaluate(&state, bearing, pin, &wrench);
        pin[4] += dt * wrench.force_pin[1] / mass, pin[1] += dt * pin[4];
        NAME_accept(&state, bearing, pin);
        if (step % 20 == 0) printf("%g %g\\n", 1e6 * wrench.penetration, wrench.force_pin[1]);
    }
}
"""
joint = read_joint(Path(__file__).parents[2] / "datasets/joint.toml")
with TemporaryDirectory() as folder:
    files = export_joint(joint, "c", "joint") | {"main.c": MAIN.replace("NAME", joint.identifier)}
    for name, text in files.items():
        Path(folder, name).write_text(text)
    build = "gcc -O2 main.c joint.c -lm -o impact"
    subprocess.run(build.split(), cwd=folder, check=True)
    run = subprocess.run([f"{folder}/impact"], capture_output=True, text=True, check=True)
depth, force = np.array([line.split() for line in run.stdout.splitlines()], float).T
figure, axes = plt.subplots(figsize=(5.0, 2.81), layout="constrained")
axes.plot(depth, 1e-3 * force)
axes.set(xlabel="penetration (µm)", ylabel="force on the pin (kN)", xlim=(-1, None))
figure.savefig("joint_in_c.png", dpi=144)
