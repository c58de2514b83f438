"""Make specimens.csv: a synthetic series of tests on nine specimens, not a measurement.

    python datasets/examples/make_specimens.py > datasets/examples/specimens.csv

Derived: penetrations of a steel pin in a steel hole by the explicit law. Each specimen adds an
offset of its own and multiplies by a gain of its own; single readings scatter by a constant and by
a share of the penetration (`TRUTH`), all normal from NumPy's generator of seed 20150103, then
rounded to 0.001 µm. All loads are below first yield.
"""

import sys

import numpy as np

from cylcontact import CylinderPair, Material, laws

SEED, SPECIMENS = 20150103, 9
STEEL = Material.named("high-strength steel")
PAIR = CylinderPair.internal(R_i=10.0, R_j=9.97, material=STEEL, length=20.0)
# The values to find: factor of the load, then deviations, in mm or relative to the penetration.
TRUTH = {
    "stiffness_factor": 1.0,
    "constant": 0.03e-3,
    "proportional": 0.01,
    "offset": 0.2e-3,
    "gain": 0.04,
}
LOADS = np.array([0.5, 1, 2, 4, 7, 12, 18, 25, 32, 40])
HEADER = """\
# SYNTHETIC, derived: the explicit law and errors of specimens, by make_specimens.py, seed 20150103.
# Steel pins of radius 9.97 mm in holes of 10 mm, 20 mm long. Not a measurement.
specimen,load_kN,penetration_um
"""


def table() -> str:
    """Return the text of the table."""
    rng = np.random.default_rng(SEED)
    exact = laws.Explicit().penetration(1e3 * LOADS / PAIR.length, PAIR)
    rows = []
    for number in range(1, SPECIMENS + 1):
        offset, gain = rng.normal(size=2) * (TRUTH["offset"], TRUTH["gain"])
        constant, proportional = rng.normal(size=(2, LOADS.size))
        scatter = TRUTH["constant"] * constant + TRUTH["proportional"] * exact * proportional
        seen = offset + (1 + gain) * exact + scatter
        rows += [f"S{number},{f:g},{1e3 * d:.3f}" for f, d in zip(LOADS, seen, strict=True)]
    return HEADER + "\n".join(rows) + "\n"


if __name__ == "__main__":
    sys.stdout.write(table())
