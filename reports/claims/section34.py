"""Section 3.4: where Johnson's law ends, and where the materials yield."""

from __future__ import annotations

import math

import numpy as np

from cylcontact import limits
from cylcontact.bodies.material import Material
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import (
    Finding,
    Reading,
    claim,
)

from .. import paper

ALUMINIUM = "aluminium alloy"


def elastic(E_GPa: float, nu: float) -> Material:
    """Return a material without a name or a yield stress."""
    return Material("", 1e3 * E_GPa, nu)


def yield_load(material: Material, dR: float, R_i: float = paper.HOLE_RADIUS) -> float:
    """Return the load at yield in N/mm."""
    return float(limits.yield_load(paper.clearance_pair(dR, material, R_i), "Hertz"))


@claim(
    "3.4-limits-in-proportion",
    "the aluminium alloy's two limits grow with the clearance as Eq 8 has it",
    paper="494 N/mm at 7.5 µm, 658 N/mm at 10 µm",
    rule="one E* gives both loads as printed",
    figures=("fig08",),
)
def limits_in_proportion() -> Finding:
    """Return the interval of E* in GPa that Eq 8 leaves for the two printed loads."""
    ends = [
        [(float(printed) + half) * math.e**2 / (4e3 * math.pi * dR) for half in (-0.5, 0.5)]
        for (name, dR), printed in paper.JOHNSON_LIMITS.items()
        if name == ALUMINIUM
    ]
    least, most = max(low for low, _ in ends), min(high for _, high in ends)
    return Finding(
        f"every E* from {least:.2f} to {most:.2f} GPa gives both",
        holds=least < most,
        values={"least E*, GPa": least, "largest E*, GPa": most},
    )


def yield_exponent(E: float = 1.0, stress: float = 1.0, dR: float = 1.0) -> float:
    """Return log2 of the change of the yield load when E, σ_Y or ΔR are multiplied as given."""
    changed, steel = (
        yield_load(Material("", 200e3 * x, 0.3, 250.0 * y), 0.05 * z)
        for x, y, z in ((E, stress, dR), (1.0, 1.0, 1.0))
    )
    return float(np.log2(changed / steel))


@claim(
    "3.4-limit-load-against-young",
    "the load that can be carried without yielding falls as Young's modulus falls",
    paper="falls",
    rule="positive exponent of E",
    figures=("fig07",),
)
def limit_load_against_young(bench: Bench) -> Finding:
    """Return the exponent of the modulus in the load at yield, alone and among the materials."""
    exponent = yield_exponent(E=2)
    materials = paper.five_materials(bench).values()
    logarithms = np.log(
        [
            (float(m.plane_strain_modulus), yield_load(m, paper.FIG2_DR["internal"]))
            for m in materials
        ]
    )
    among = float(np.polyfit(logarithms[:, 0], logarithms[:, 1], 1)[0])
    return Finding(
        f"by Eq 7 it goes as E to the power of {exponent:.2f}: a softer pair carries more",
        holds=exponent > 0,
        choice="equal yield stress",
        miss=f"exponent {exponent:.0f}, the reverse",
        alternatives=[
            Reading(
                "the five materials, each with its own yield stress",
                f"as E to the power of {among:.2f} (least squares of the logarithms)",
                among > 0,
                paper.TABLE_1,
                f"exponent {among:.2f}, the reverse",
            )
        ],
        values={"exponent, -": exponent, "exponent among the materials, -": among},
    )
