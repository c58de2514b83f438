"""Section 3.3's statements on the end of Johnson's law (Eq 8, Figs 8 and 9)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cylcontact import limits
from cylcontact.arrays import FloatArray
from cylcontact.materials import Material
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim, joined, listed, with_unit
from ..paper import (
    FIG7_CLEARANCES,
    MATERIALS,
    RADII,
    YIELD,
    Table,
    clearance_pair,
    eq1_peak_load,
    five_materials,
    origins,
    strength,
)
from ..power_fits import FIG2_DR

CLEARANCES = np.geomspace(*FIG7_CLEARANCES, 401)
DR = FIG2_DR["internal"]  # where a single number is shown





@claim(
    "3.3-logarithm-at-least-2",
    "Johnson's law holds while its logarithm is 2 or more, f ≤ 4πE*ΔR/e² (Eq 8)",
    paper="ln ≥ 2",
    rule="agreement to 1e-4",
    paper_values={"logarithm, -": 2.0},
)
def logarithm_at_least_two(bench: Bench) -> Finding:
    """Return the logarithm of Eq 1 at the largest penetration, found on the curve itself."""
    pair = clearance_pair(DR, bench.material("low-carbon steel").material)
    factor = eq1_peak_load(pair) / float(pair.E_star * DR)
    logarithm = float(np.log(4 * np.pi / factor))
    return Finding(
        f"penetration peaks at ln = {logarithm:.6f}, f = {factor:.4f}·E*ΔR. This bounds the "
            "algebra, not the physics: an elastic contact conforms well before that load",
        holds=abs(logarithm - 2) < 1e-4,
        values={"logarithm, -": logarithm, "load over E* dR, -": factor},
    )


@claim(
    "3.3-limit-independent-of-radii",
    "Johnson's limit load does not depend on the size of the bodies (Fig 8)",
    paper="independent",
    rule="no spread (bodies of equal material)",
)
def limit_independent_of_radii(bench: Bench) -> Finding:
    """Return Johnson's limit at one clearance for the three radii."""
    materials = five_materials(bench)
    spread = max(
        np.ptp([float(limits.johnson_limit_load(clearance_pair(DR, m, R))) for R in RADII])
        for m in materials.values()
    )
    loads = {
        name: float(limits.johnson_limit_load(clearance_pair(DR, m)))
        for name, m in materials.items()
    }
    return Finding(
        f"spread over R_i = 100, 10, 5 mm: {spread:.1g} N/mm; at {DR * 1e3:g} µm "
        + listed(loads, "{:.0f} N/mm"),
        holds=spread == 0,
        values=with_unit(loads, "N/mm"),
    )


@claim(
    "3.3-stress-at-limit-against-size",
    "the stress at Johnson's limit grows as the area of contact falls (Fig 9)",
    paper="grows",
    rule="σ_H grows from R_i = 100 to 5 mm for every material and clearance",
)
def stress_at_limit_against_radius(bench: Bench) -> Finding:
    """Return Hertz's stress at Johnson's limit for the three radii of Fig 9."""
    grows = all(
        np.all(np.diff([_stress_at_limit(CLEARANCES, m, R) for R in RADII], axis=0) > 0)
        for m in five_materials(bench).values()
    )
    stress = {
        f"R_i = {R:g} mm": float(_stress_at_limit(DR, bench.material("low-carbon steel").material, R))
        for R in RADII
    }
    return Finding(
        "σ_H = (2/e)·E*ΔR/√(R_i·R_j); low-carbon steel at 50 µm: "
        + listed(stress, "{:.0f} MPa"),
        holds=grows,
        values=with_unit(stress, "MPa"),
    )


@claim(
    "3.3-plastic-before-limit",
    "yield before Johnson's limit is likelier for small contacts and low strength",
    paper="likelier",
    rule="that clearance falls with R_i and with the yield stress, for every material",
)
def plastic_before_limit(bench: Bench) -> Finding:
    """Return the clearances above which a contact yields before Johnson's law ends."""
    materials = five_materials(bench)
    crossing = {R: {n: _yields_first_above(m, R) for n, m in materials.items()} for R in RADII}
    weaker = {
        name: _yields_first_above(replace(m, yield_stress=strength(m) / 2), 10.0)
        for name, m in materials.items()
    }
    shown = "low-carbon steel"
    return Finding(
        "clearance above which yield comes first, R_i = 10 mm: "
            + listed(crossing[10.0], "{:.1f} µm")
            + f"; {shown}: {crossing[100.0][shown]:.1f} µm at R_i = 100 mm, "
            f"{crossing[5.0][shown]:.1f} µm at 5 mm, {weaker[shown]:.1f} µm at 10 mm with half "
            "the yield stress",
        holds=all(
            crossing[5.0][name] < crossing[10.0][name] < crossing[100.0][name]
            and weaker[name] < crossing[10.0][name]
            for name in materials
        ),
        choice=joined(
            "the paper's sentence can be read as a growing yield stress making yield likelier; "
            "the sensible reading, a falling one, is taken",
            material_origins(bench, YIELD),
        ),
        values=with_unit(crossing[10.0], "um"),
    )


def _yields_first_above(material: Material, R_i: float) -> float:
    """Return the ΔR in µm above which yield comes before Johnson's limit."""
    return 1e3 * float(limits.elastic_limit_clearance(R_i, clearance_pair(DR, material)))


def _stress_at_limit(dR: float | FloatArray, material: Material, R_i: float) -> FloatArray:
    """Return Hertz's peak pressure in MPa at Johnson's limit."""
    return limits.stress_at_johnson_limit(clearance_pair(dR, material, R_i))
