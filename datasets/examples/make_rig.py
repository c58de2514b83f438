"""Make rig.csv: a synthetic test of one specimen as a rig records it, not a measurement.

    python datasets/examples/make_rig.py > datasets/examples/rig.csv

Derived: penetrations of a steel pin in a bronze hole by the explicit law, loaded and unloaded
twice, with the errors of a rig (`TRUTH`): its compliance, readings that are not zeroed, a drift,
and scatter of one size from NumPy's generator of seed 20150102, then rounded to 0.01 µm. One
reading is off by 2 µm. All loads are below first yield.
"""

import sys

import numpy as np

from cylcontact import CylinderPair, Material, laws

SEED = 20150102
HOLE, PIN = Material.named("bronze"), Material.named("low-carbon steel")
PAIR = CylinderPair.internal(R_i=10.0, R_j=9.98, material=HOLE, length=20.0, material_j=PIN)
# The values to find: factor of the load, compliance in mm/(N/mm), deviations in mm; the offset is
# that of the first reading.
TRUTH = {
    "stiffness_factor": 1.0,
    "compliance": 4e-6,
    "offset": -3e-3,
    "drift": 1.5e-3,
    "constant": 0.1e-3,
}
UP = np.array([0.2, 0.5, 1, 2, 3, 5, 7, 10, 14, 18, 23, 28, 34, 40])
LOADS = 1e3 * np.concatenate([UP, UP[-2::-1], UP[1:], UP[-2::-1]])
SECONDS, OFF_ROW, OFF = 30.0, 20, 2e-3
HEADER = """\
# SYNTHETIC, derived: the explicit law and errors of a rig, by make_rig.py, seed 20150102.
# A steel pin of radius 9.98 mm in a bronze hole of 10 mm, 20 mm long. Not a measurement.
F [N];s [µm];t [s]
"""


def table() -> str:
    """Return the text of the table."""
    rng = np.random.default_rng(SEED)
    line_load = LOADS / PAIR.length
    along = np.linspace(0.0, 1.0, LOADS.size)
    seen = (
        laws.Explicit().penetration(line_load, PAIR)
        + TRUTH["compliance"] * line_load
        + TRUTH["offset"]
        + TRUTH["drift"] * along
        + TRUTH["constant"] * rng.normal(size=LOADS.size)
    )
    seen[OFF_ROW] += OFF
    rows = [
        f"{load:.0f};{1e3 * reading:.2f};{SECONDS * k:.0f}".replace(".", ",")
        for k, (load, reading) in enumerate(zip(LOADS, seen, strict=True))
    ]
    return HEADER + "\n".join(rows) + "\n"


if __name__ == "__main__":
    sys.stdout.reconfigure(encoding="utf-8")
    sys.stdout.write(table())
