"""Make pin-in-hole.csv: a synthetic experiment, Johnson's law and noise, not a measurement.

    python datasets/examples/make_pin_in_hole.py > datasets/examples/pin-in-hole.csv

Derived: penetrations are Johnson's for three clearances and two materials of the table of
materials, times exp(0.03·g) with g standard normal from NumPy's generator of seed 20150101, then
rounded to 0.001 µm. One row stands twice and one is off by 25 %, as happens.
"""

import sys

import numpy as np

from cylcontact import CylinderPair, laws
from cylcontact.bodies.material import shipped_materials

SEED, NOISE = 20150101, 0.03
RADIUS = 10.0
CLEARANCES = (0.02, 0.05, 0.2)
MATERIALS = ("low-carbon steel", "titanium alloy")
LOADS = np.array([5, 10, 20, 40, 60, 80, 120, 160, 200, 250], dtype=float)
HEADER = """\
# SYNTHETIC, derived: Johnson's law and 3 % of noise, by make_pin_in_hole.py, seed 20150101.
# A pin in a hole of radius 10 mm; loads per unit length. Not a measurement.
material,dR_um,load_N_per_mm,penetration_um
"""


def table() -> str:
    """Return the text of the table."""
    rng = np.random.default_rng(SEED)
    known = shipped_materials()
    rows = []
    for name in MATERIALS:
        for dR in CLEARANCES:
            pair = CylinderPair.internal(RADIUS, RADIUS - dR, known[name].material)
            exact = laws.Johnson().penetration(LOADS, pair)
            seen = exact * np.exp(NOISE * rng.normal(size=LOADS.size))
            rows += [
                f"{name},{1e3 * dR:g},{f:g},{1e3 * d:.3f}" for f, d in zip(LOADS, seen, strict=True)
            ]
    off = rows[33].rsplit(",", 1)
    rows[33] = f"{off[0]},{1.25 * float(off[1]):.3f}"
    rows.insert(13, rows[12])
    return HEADER + "\n".join(rows) + "\n"


if __name__ == "__main__":
    sys.stdout.write(table())
