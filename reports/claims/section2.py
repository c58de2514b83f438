"""Section 2: what the paper says of the models it starts from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cylcontact import limits
from cylcontact.arrays import FloatArray
from cylcontact.laws import Enhanced, Johnson, LankaraniNikravesh
from cylcontact.laws.enhanced import INTERNAL_DR_MAX, INTERNAL_DR_MIN
from cylcontact.materials import Material
from cylcontact.pair import CylinderPair
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim, joined, listed, with_unit

from ..paper import (
    CLEARANCES,
    ELASTIC,
    LOADS,
    PRACTICAL,
    Domain,
    clearance_pair,
    eq1_peak_load,
    eq1_penetration,
    five_materials,
    material_origins,
)

SECTION = "2"
STEEL = Material("steel of Fig 2", 207e3, 0.3)
LENGTH = 10.0  # mm, the axial length of the slider-crank's bearing


@claim(
    "2-limit-depends-on-clearance-and-material",
    "Johnson's law ends at a largest load set by the clearance and the material",
    paper="depends on both",
    rule="both exponents positive",
)
def johnson_limit_scaling(_bench: Bench) -> Finding:
    """Return how Johnson's largest load depends on clearance and modulus."""

    def limit(dR: float, E: float) -> float:
        return float(limits.johnson_limit_load(clearance_pair(dR, Material("", E, 0.3))))

    base = limit(0.05, 207e3)
    by_dR = np.log2(limit(0.1, 207e3) / base)
    by_E = np.log2(limit(0.05, 414e3) / base)
    return Finding(
        f"f_max ∝ ΔR^{by_dR:.3f}·E^{by_E:.3f}; {base:.0f} N/mm at 50 µm, 207 GPa, ν = 0.3",
        holds=bool(by_dR > 0 and by_E > 0),
        values={"exponent of dR, -": by_dR, "exponent of E, -": by_E},
    )


@claim(
    "2-force-falls-beyond-limit",
    "past its largest load Johnson's force falls while the penetration rises",
    paper="falls",
    rule="the largest penetration of Eq 1 lies at Eq 8's load, and penetration falls past it",
)
def force_falls_beyond_limit(_bench: Bench) -> Finding:
    """Return what Eq 1, taken literally beyond its largest load, does."""
    pair = clearance_pair(0.05, STEEL)
    limit = float(limits.johnson_limit_load(pair))
    peak = eq1_peak_load(pair) / limit
    at_limit, past_it = eq1_penetration([limit, 1.5 * limit], pair)
    beyond = float(past_it / at_limit)
    return Finding(
        (
            f"dδ/df changes sign at {peak:.6f} of Eq 8's load; at 1.5 times that load "
            f"Eq 1 gives {beyond:.3f} of the largest penetration, so on that branch load and "
            "penetration do move in opposite directions"
        ),
        holds=bool(abs(peak - 1) < 1e-4 and beyond < 1),
        values={"peak over limit, -": peak, "beyond over peak, -": beyond},
    )


@claim(
    "2-johnson-needs-iteration",
    "Johnson's load at a given penetration needs an iterative solution",
    paper="needs Newton–Raphson or the like",
    rule="reproduced if the closed inverse misses by more than 1e-12 somewhere in the domain",
)
def needs_iteration(_bench: Bench) -> Finding:
    """Return the accuracy of the closed inverse of Johnson's law."""
    pair = clearance_pair(0.05, STEEL)
    law = Johnson()
    # Fractions of the largest load. Near the limit df/dδ is infinite, so the error is
    # measured in the penetration, which is well conditioned there.
    fraction = np.concatenate([np.geomspace(1e-9, 1, 2001), 1 - 2.0 ** -np.arange(1, 53)])
    penetration = law.penetration(law.max_load(pair) * fraction, pair)
    returned = law.penetration(law.load(penetration, pair), pair)
    error = float(np.max(np.abs(returned / penetration - 1)))
    return Finding(
        (
            "a closed inverse exists, f = πE*δ/(−W₋₁(−eδ/(4ΔR))): no iteration; penetration → "
            f"load → penetration returns within a relative {error:.1e} up to the limit"
        ),
        holds=error > 1e-12,
        choice="the law is implicit only in elementary functions; Lambert's W₋₁ inverts it exactly",
        values={"round trip error, -": error},
    )


@claim(
    "2-lankarani-nikravesh-softer",
    "Lankarani–Nikravesh gives much lower forces than Johnson",
    paper="much lower",
    rule="below 1 everywhere in the practical domain, and its median below one half",
)
def lankarani_softer(bench: Bench) -> Finding:
    """Return Lankarani–Nikravesh over Johnson at equal penetration, over the practical domain."""
    materials = five_materials(bench)
    ratios = {name: _softness(m, PRACTICAL, LENGTH) for name, m in materials.items()}
    median = {name: float(np.nanmedian(ratio)) for name, ratio in ratios.items()}
    most = {name: float(np.nanmax(ratio)) for name, ratio in ratios.items()}
    wide = replace(PRACTICAL, label="R_i = 100 mm", R_i=100.0)
    steel = materials["low-carbon steel"]
    others = {
        "R_i = L = 100 mm": float(np.nanmax(_softness(steel, wide, 100.0))),
        "R_i = 100 mm, L = 10 mm": float(np.nanmax(_softness(steel, wide, 10.0))),
        "R_i = 10 mm, L = 1 mm": float(np.nanmax(_softness(steel, PRACTICAL, 1.0))),
    }
    return Finding(
        (
            "ratio of its load to Johnson's at equal penetration, in the practical domain: median "
            + listed(median, "{:.2f}")
            + f"; largest: {max(most.values()):.2f} for each material"
        ),
        holds=max(most.values()) < 1 and max(median.values()) < 0.5,
        choice=(
            f"R_i = {PRACTICAL.R_i:g} mm and axial length L = {LENGTH:g} mm, those of the "
            "paper's bearing: Eq 2 is a total force without a length in it, so per unit length "
            "it is F/L (its printed radii R_i·R_i read as R_i·R_j)"
        ),
        alternatives=(
            "the largest ratio goes as R_i/L: "
            + listed(others, "gives {:.2f}")
            + ". Lankarani–Nikravesh is the softer law everywhere only if L exceeds about "
            f"{max(most.values()):.1f}·R_i; for shorter contacts not reproduced"
        ),
        values={
            **{f"{name}, median, -": value for name, value in median.items()},
            **{f"{name}, largest, -": value for name, value in most.items()},
            **with_unit(others, "-"),
        },
    )


def _softness(material: Material, domain: Domain, length: float) -> FloatArray:
    """Return Lankarani–Nikravesh's load over Johnson's at equal penetration, on a grid."""
    dR, load = domain.point(
        np.linspace(0, 1, 401)[:, None], np.linspace(0, 1, 201)[None, :], material
    )
    pair = CylinderPair.from_dR("internal", dR, material, length=length, R_i=domain.R_i)
    return LankaraniNikravesh().load(Johnson().penetration(load, pair), pair) / load


@claim(
    "2-enhanced-covers-more",
    "the enhanced law has none of the limits of Johnson's domain",
    paper="no limits of validity",
    rule="the enhanced law is defined wherever Johnson's is and where it is not",
)
def enhanced_beyond_johnson(bench: Bench) -> Finding:
    """Return how much of Sect. 3.4's plane each law covers."""
    dR = np.geomspace(*CLEARANCES, 1201)[:, None]
    load = np.geomspace(*LOADS, 1201)[None, :]
    johnson, enhanced = {}, {}
    for name, material in five_materials(bench).items():
        pair = clearance_pair(dR, material)
        johnson[name] = 100 * float(np.isfinite(Johnson().penetration(load, pair)).mean())
        enhanced[name] = 100 * float(np.isfinite(Enhanced().penetration(load, pair)).mean())
    return Finding(
        (
            "share of Sect. 3.4's clearance–load plane in which each law gives a penetration: "
            f"enhanced {min(enhanced.values()):.0f} % for every material; Johnson "
            + listed(johnson, "{:.2f} %")
            + f"; the enhanced law adds {100 - min(johnson.values()):.2f} % at most"
        ),
        holds=min(enhanced.values()) == 100 and min(johnson.values()) < 100,
        choice=joined(
            "judged over Sect. 3.4's clearances and loads", material_origins(bench, ELASTIC)
        ),
        alternatives=(
            "over all clearances the reverse holds: Eq 6d confines the enhanced law to "
            f"{INTERNAL_DR_MIN:g} ≤ ΔR < {INTERNAL_DR_MAX:g} mm (Figs 7–9 start at 0.001 mm), "
            "while Johnson's law has no limit of clearance"
        ),
        values=with_unit(johnson, "percent"),
    )


@claim(
    "2-johnson-experiment",
    "Johnson's law has been confirmed by experiment",
    paper="confirmed",
    rule="none",
)
def johnson_experiment(_bench: Bench) -> Finding:
    """Return the statement on experiments, which no computation can judge."""
    return Finding(
        "—",
        holds=None,
        choice="the paper gives no measured data",
    )
