"""Write datasets/vectors anew: python -m tests.support.write_vectors."""

import json
from pathlib import Path

import numpy as np

from cylcontact import CylinderPair, InputError, Material
from cylcontact.laws import LAWS

FOLDER = Path(__file__).parents[2] / "datasets" / "vectors"
COLUMNS = (
    "E_i_MPa", "nu_i", "E_j_MPa", "nu_j", "R_i_mm", "R_j_mm", "length_mm", "penetration_mm",
    "load_N_per_mm", "stiffness_N_per_mm2",
)  # fmt: skip
STEEL, BRONZE = (207e3, 0.3), (110e3, 0.34)
# Fractions of two, so that ΔR is exact as well.
PAIRS = {
    "internal": [(*STEEL, *STEEL, 10.0, 10 - 2**-6, 12.0), (*BRONZE, *STEEL, 10.0, 9.75, 12.0),
                 (*STEEL, *BRONZE, 25.0, 25 - 2**-4, 20.0), (*STEEL, *STEEL, 50.0, 48.0, 20.0)],
    "external": [(*STEEL, *STEEL, 10.0, 15.0, 12.0), (*STEEL, *STEEL, 5.0, 30.0, 8.0),
                 (*BRONZE, *STEEL, 10.0, 10.0, 12.0), (*STEEL, *BRONZE, 60.0, 20.0, 20.0)],
}  # fmt: skip


def pair_of(contact, row):
    E_i, nu_i, E_j, nu_j, R_i, R_j, length = row[:7]
    one, other = Material("i", E_i, nu_i), Material("j", E_j, nu_j)
    return getattr(CylinderPair, contact)(R_i, R_j, one, length, other)


def rows_of(law, contact):
    """Forty rows over four pairs, or over those of steel if the law is for no other."""
    pairs = [pair for pair in PAIRS[contact] if _takes(law, contact, pair)]
    rows = []
    for numbers in pairs:
        pair = pair_of(contact, numbers)
        top = 0.8 * min(float(law.max_penetration(pair)), float(pair.dR), 0.1)
        count = 40 // len(pairs)
        for depth in (float(f"{x:.3g}") for x in np.geomspace(1e-3 * top, top, count)):
            answers = law.load(depth, pair), law.stiffness(depth, pair)
            rows.append([*numbers, depth, *(float(f"{float(x):.15g}") for x in answers)])
    return rows


def _takes(law, contact, numbers):
    try:
        return bool(np.isfinite(law.load(1e-4, pair_of(contact, numbers))))
    except InputError:
        return False


if __name__ == "__main__":
    for name, make in LAWS.items():
        for contact in make().contacts:
            rows = ",\n  ".join(json.dumps(row) for row in rows_of(make(), contact))
            head = f'{{"law": "{name}", "contact": "{contact}",\n '
            text = f'{head}"columns": {json.dumps(COLUMNS)},\n "rows": [\n  {rows}\n ]}}\n'
            (FOLDER / f"{name}-{contact}.json").write_text(text, encoding="ascii")
