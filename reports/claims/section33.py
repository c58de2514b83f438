"""Section 3.3: where yield (Fig 7) and where the mathematics (Figs 8 and 9) end the laws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cylcontact import limits
from cylcontact.arrays import FloatArray
from cylcontact.materials import Material
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim, joined, listed, with_unit

from .. import paper

DR = paper.FIG2_DR["internal"]  # where a single number is given
CLEARANCES = np.geomspace(*paper.FIG7_CLEARANCES, 401)
SIZES = {f"R_i = {R_i:g} mm": R_i for R_i in paper.RADII}


def yield_load(dR: float | FloatArray, material: Material, R_i: float) -> FloatArray:
    """Return the load at yield in N/mm."""
    return limits.yield_load(paper.clearance_pair(dR, material, R_i), "Hertz")


def steel(bench: Bench) -> tuple[Material, str]:
    """Return the steel that single numbers are given for, and its name with the yield stress."""
    row = bench.material("low-carbon steel")
    stress, origin = paper.strength(row.material), row.provenance["yield_stress_MPa"]
    return row.material, f"{row.material.name} (yield stress {stress:g} MPa, {origin})"


@claim(
    "3.3-yield-load-against-clearance",
    "the load that reaches yield grows as the clearance falls (Fig 7)",
    paper="grows",
    rule="f_Y falls steadily with ΔR for every material and radius",
)
def yield_load_against_clearance(bench: Bench) -> Finding:
    """Return how much the load at yield grows from the largest to the smallest clearance."""
    material, _ = steel(bench)
    growth = {
        name: float(np.divide(*yield_load(CLEARANCES[[0, -1]], material, R_i)))
        for name, R_i in SIZES.items()
    }
    return Finding(
        "f_Y = πσ_Y²·R_i·R_j/(E*ΔR); from 2 mm down to 1 µm it grows, for any material, "
        + listed(growth, "{:.0f} times"),
        holds=all(
            np.all(np.diff(yield_load(CLEARANCES, m, R_i)) < 0)
            for m in paper.five_materials(bench).values()
            for R_i in paper.RADII
        ),
        values=with_unit(growth, "-"),
    )


@claim(
    "3.3-yield-load-against-radius",
    "the load that reaches yield depends on the size of the bodies (Fig 7a–c)",
    paper="curves differ between R_i = 100, 10 and 5 mm",
    rule="f_Y grows with R_i for every material and clearance",
)
def yield_load_against_radius(bench: Bench) -> Finding:
    """Return the load at yield in N/mm for the three radii of Fig 7."""
    material, name = steel(bench)
    loads = {size: float(yield_load(DR, material, R_i)) for size, R_i in SIZES.items()}
    return Finding(
        f"{name} at {DR * 1e3:g} µm: {listed(loads, '{:.0f} N/mm')}",
        holds=all(
            np.all(np.diff([yield_load(CLEARANCES, m, R_i) for R_i in paper.RADII], axis=0) < 0)
            for m in paper.five_materials(bench).values()
        ),
        values=with_unit(loads, "N/mm"),
    )


@claim(
    "3.3-yield-load-against-contact-area",
    "a smaller area of contact lowers the load that can be carried",
    paper="lowers",
    rule="width and load at yield fall together from R_i = 100 to 5 mm",
)
def yield_load_against_contact_area(bench: Bench) -> Finding:
    """Return the width of contact in mm and the load in N/mm at yield."""
    (material, name), dR = steel(bench), float(CLEARANCES[-1])
    loads = [float(yield_load(dR, material, R_i)) for R_i in paper.RADII]
    # Hertz's peak pressure is p = 4f/(π·width).
    widths = [
        4 * f / (np.pi * float(limits.hertz_stress(f, paper.clearance_pair(dR, material, R_i))))
        for f, R_i in zip(loads, paper.RADII, strict=True)
    ]
    # The ΔR at which the width at yield, 4σ_Y·R/E*, is the hole's diameter.
    stiffness = float(paper.clearance_pair(DR, material).E_star / (2 * paper.strength(material)))
    formal = {size: 1e3 * R_i / (1 + stiffness) for size, R_i in SIZES.items()}
    return Finding(
        f"{name} at ΔR = {dR:g} mm, width of contact and load at yield: "
        + ", ".join(
            f"{width:.2f} mm and {load:.0f} N/mm ({size})"
            for size, width, load in zip(SIZES, widths, loads, strict=True)
        )
        + "; at yield f_Y = (π/4)·σ_Y·width",
        holds=bool(np.all(np.diff([loads, widths]) < 0)),
        alternatives="at small clearances Fig 7 is formal: the width that Hertz gives at yield "
        "exceeds the hole's diameter below ΔR of " + listed(formal, "{:.0f} µm"),
        values={
            f"width at R_i {R:g} mm, mm": width
            for R, width in zip(paper.RADII, widths, strict=True)
        },
    )


@claim(
    "3.3-size-matters-most",
    "the size of the bodies changes the load at yield more than the material does",
    paper="size has the greater influence",
    rule="the factor over R_i exceeds the factor over the materials",
)
def size_matters_most(bench: Bench) -> Finding:
    """Return the ratio of the loads at yield over radii, over materials, and over E*."""
    materials = paper.five_materials(bench).values()
    loads = np.array([[float(yield_load(DR, m, R)) for R in paper.RADII] for m in materials])
    by_size = float(loads[0].max() / loads[0].min())
    by_material = float(loads[:, 0].max() / loads[:, 0].min())
    moduli = [float(m.plane_strain_modulus) for m in materials]
    by_modulus = max(moduli) / min(moduli)
    return Finding(
        f"R_i from 5 to 100 mm: {by_size:.0f} times; over the five materials: "
        f"{by_material:.1f} times ({by_modulus:.1f} times through E* alone)",
        holds=by_size > by_material,
        choice=joined(f"at ΔR = {DR * 1e3:g} µm", paper.material_origins(bench, paper.YIELD)),
        values={"by size, -": by_size, "by material, -": by_material, "by E*, -": by_modulus},
    )


@claim(
    "3.3-elastic-constants-matter",
    "E and ν of the material also narrow the range of application",
    paper="they do",
    rule="both change the load at yield by more than 1 %",
)
def elastic_constants_matter() -> Finding:
    """Return the ratio of the loads at yield over E alone and over ν alone."""

    def load(E: float, nu: float) -> float:
        return float(yield_load(DR, Material("", E, nu, yield_stress=250.0), 10.0))

    by_E = load(69e3, 0.3) / load(600e3, 0.3)
    by_nu = load(200e3, 0.34) / load(200e3, 0.24)
    return Finding(
        f"at equal yield stress f_Y ∝ 1/E*: {by_E:.2f} times lower at 600 than at 69 GPa, and "
        f"{100 * (1 - by_nu):.1f} % lower at ν = 0.34 than at 0.24",
        holds=abs(by_E - 1) > 0.01 and abs(by_nu - 1) > 0.01,
        values={"by E, -": by_E, "by nu, -": by_nu},
    )


@claim(
    "3.3-logarithm-at-least-2",
    "Johnson's law holds while its logarithm is 2 or more, f ≤ 4πE*ΔR/e² (Eq 8)",
    paper="ln ≥ 2",
    rule="agreement to 1e-4",
    paper_values={"logarithm, -": 2.0},
)
def logarithm_at_least_2(bench: Bench) -> Finding:
    """Return the logarithm in Eq 1 at its largest penetration."""
    pair = paper.clearance_pair(DR, steel(bench)[0])
    number = paper.eq1_peak_load(pair) / float(pair.E_star * DR)
    logarithm = float(np.log(4 * np.pi / number))
    return Finding(
        f"penetration peaks at ln = {logarithm:.6f}, f = {number:.4f}·E*ΔR. This bounds the "
        "algebra, not the physics: an elastic contact conforms well before that load",
        holds=abs(logarithm - 2) < 1e-4,
        values={"logarithm, -": logarithm, "load over E* dR, -": number},
    )


@claim(
    "3.3-limit-independent-of-radii",
    "Johnson's limit load does not depend on the size of the bodies (Fig 8)",
    paper="independent",
    rule="no spread (bodies of equal material)",
)
def limit_independent_of_radii(bench: Bench) -> Finding:
    """Return Johnson's limit in N/mm at one clearance, and its spread over three radii."""
    loads = {
        name: [
            float(limits.johnson_limit_load(paper.clearance_pair(DR, m, R))) for R in paper.RADII
        ]
        for name, m in paper.five_materials(bench).items()
    }
    spread = np.ptp(list(loads.values()), axis=1).max()
    first = {name: row[0] for name, row in loads.items()}
    return Finding(
        f"spread over R_i = 100, 10, 5 mm: {spread:.1g} N/mm; at {DR * 1e3:g} µm "
        + listed(first, "{:.0f} N/mm"),
        holds=bool(spread == 0),
        values=with_unit(first, "N/mm"),
    )


@claim(
    "3.3-stress-at-limit-against-size",
    "the stress at Johnson's limit grows as the area of contact falls (Fig 9)",
    paper="grows",
    rule="σ_H grows from R_i = 100 to 5 mm for every material and clearance",
)
def stress_at_limit_against_size(bench: Bench) -> Finding:
    """Return Hertz's stress in MPa at Johnson's limit for the three radii of Fig 9."""

    def stress(dR: float | FloatArray, material: Material, R_i: float) -> FloatArray:
        return limits.stress_at_johnson_limit(paper.clearance_pair(dR, material, R_i))

    material, _ = steel(bench)
    stresses = {size: float(stress(DR, material, R_i)) for size, R_i in SIZES.items()}
    return Finding(
        f"σ_H = (2/e)·E*ΔR/√(R_i·R_j); low-carbon steel at 50 µm: {listed(stresses, '{:.0f} MPa')}",
        holds=all(
            np.all(np.diff([stress(CLEARANCES, m, R_i) for R_i in paper.RADII], axis=0) > 0)
            for m in paper.five_materials(bench).values()
        ),
        values=with_unit(stresses, "MPa"),
    )


@claim(
    "3.3-plastic-before-limit",
    "yield before Johnson's limit is likelier for small contacts and low strength",
    paper="likelier",
    rule="that clearance falls with R_i and with the yield stress, for every material",
)
def plastic_before_limit(bench: Bench) -> Finding:
    """Return the clearances in µm above which a contact yields before Johnson's law ends."""

    def crossing(material: Material, R_i: float) -> float:
        pair = paper.clearance_pair(DR, material)
        return 1e3 * float(limits.elastic_limit_clearance(R_i, pair))

    materials = paper.five_materials(bench)
    large, medium, small = (
        {name: crossing(m, R_i) for name, m in materials.items()} for R_i in paper.RADII
    )
    weak = {
        name: crossing(replace(m, yield_stress=paper.strength(m) / 2), 10.0)
        for name, m in materials.items()
    }
    steel = "low-carbon steel"
    return Finding(
        "clearance above which yield comes first, R_i = 10 mm: "
        + listed(medium, "{:.1f} µm")
        + f"; {steel}: {large[steel]:.1f} µm at R_i = 100 mm, {small[steel]:.1f} µm at 5 mm, "
        f"{weak[steel]:.1f} µm at 10 mm with half the yield stress",
        holds=all(
            small[name] < medium[name] < large[name] and weak[name] < medium[name]
            for name in materials
        ),
        choice=joined(
            "the paper's sentence can be read as a growing yield stress making yield likelier; "
            "the sensible reading, a falling one, is taken",
            paper.material_origins(bench, paper.YIELD),
        ),
        values=with_unit(medium, "um"),
    )
