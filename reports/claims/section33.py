"""Section 3.3: where yield (Fig 7) and where the mathematics (Figs 8 and 9) end the laws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cylcontact import limits
from cylcontact.arrays import FloatArray
from cylcontact.materials import Material
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim, joined, listed, with_unit

from ..paper import (
    FIG2_DR,
    FIG7_CLEARANCES,
    RADII,
    YIELD,
    clearance_pair,
    eq1_peak_load,
    five_materials,
    material_origins,
    strength,
)

CLEARANCES = np.geomspace(*FIG7_CLEARANCES, 401)
DR = FIG2_DR["internal"]  # where a single number is shown


@claim(
    "3.3-yield-load-against-clearance",
    "the load that reaches yield grows as the clearance falls (Fig 7)",
    paper="grows",
    rule="f_Y falls steadily with ΔR for every material and radius",
)
def yield_load_against_clearance(bench: Bench) -> Finding:
    """Return how much the load at yield grows from the largest to the smallest clearance."""
    falls = all(
        np.all(np.diff(_yield_load(CLEARANCES, m, R_i)) < 0)
        for m in five_materials(bench).values()
        for R_i in RADII
    )
    any_material = five_materials(bench)["low-carbon steel"]
    growth = {
        f"R_i = {R_i:g} mm": float(np.divide(*_yield_load(CLEARANCES[[0, -1]], any_material, R_i)))
        for R_i in RADII
    }
    return Finding(
        (
            "f_Y = πσ_Y²·R_i·R_j/(E*ΔR); from 2 mm down to 1 µm it grows, for any material, "
            + listed(growth, "{:.0f} times")
        ),
        holds=falls,
        values=with_unit(growth, "-"),
    )


@claim(
    "3.3-yield-load-against-radius",
    "the load that reaches yield depends on the size of the bodies (Fig 7a–c)",
    paper="curves differ between R_i = 100, 10 and 5 mm",
    rule="f_Y grows with R_i for every material and clearance",
)
def yield_load_against_radius(bench: Bench) -> Finding:
    """Return the load at yield for the three radii of Fig 7."""
    grows = all(
        np.all(np.diff([_yield_load(CLEARANCES, m, R_i) for R_i in sorted(RADII)], axis=0) > 0)
        for m in five_materials(bench).values()
    )
    loads = {
        f"R_i = {R_i:g} mm": float(
            _yield_load(DR, bench.material("low-carbon steel").material, R_i)
        )
        for R_i in RADII
    }
    return Finding(
        f"{_steel_told(bench)} at {DR * 1e3:g} µm: " + listed(loads, "{:.0f} N/mm"),
        holds=grows,
        values=with_unit(loads, "N/mm"),
    )


@claim(
    "3.3-yield-load-against-contact-area",
    "a smaller area of contact lowers the load that can be carried",
    paper="lowers",
    rule="width and load at yield fall together from R_i = 100 to 5 mm",
)
def yield_load_against_contact_width(bench: Bench) -> Finding:
    """Return the width of contact at yield beside the load."""
    material = bench.material("low-carbon steel").material
    dR = float(CLEARANCES[-1])
    loads = {R_i: float(_yield_load(dR, material, R_i)) for R_i in RADII}
    widths = {R_i: _contact_width(loads[R_i], dR, material, R_i) for R_i in RADII}
    formal = {f"R_i = {R_i:g} mm": 1e3 * _formal_below(material, R_i) for R_i in RADII}
    return Finding(
        (
            f"{_steel_told(bench)} at ΔR = {dR:g} mm, width of contact and load at yield: "
            + ", ".join(
                f"{widths[R]:.2f} mm and {loads[R]:.0f} N/mm (R_i = {R:g} mm)" for R in RADII
            )
            + "; at yield f_Y = (π/4)·σ_Y·width"
        ),
        holds=bool(np.all(np.diff(list(loads.values())) < 0))
        and bool(np.all(np.diff(list(widths.values())) < 0)),
        alternatives=(
            "at small clearances Fig 7 is formal: the width that Hertz gives at yield exceeds the "
            "hole's diameter below ΔR of " + listed(formal, "{:.0f} µm")
        ),
        values={f"width at R_i {R:g} mm, mm": width for R, width in widths.items()},
    )


def _contact_width(load: float, dR: float, material: Material, R_i: float) -> float:
    """Return the width of contact in mm from Hertz's p = 4f/(π·width)."""
    return 4 * load / (np.pi * float(limits.hertz_stress(load, clearance_pair(dR, material, R_i))))


def _formal_below(material: Material, R_i: float) -> float:
    """Return the ΔR in mm at which the width at yield, 4σ_Y·R/E*, is the hole's diameter."""
    return float(R_i / (1 + clearance_pair(DR, material).E_star / (2 * strength(material))))


@claim(
    "3.3-size-matters-most",
    "the size of the bodies changes the load at yield more than the material does",
    paper="size has the greater influence",
    rule="the factor over R_i exceeds the factor over the materials",
)
def size_matters_most(bench: Bench) -> Finding:
    """Return the load at yield's spread over radii beside that over materials."""
    materials = five_materials(bench)
    loads = np.array([[float(_yield_load(DR, m, R)) for R in RADII] for m in materials.values()])
    by_size = float(loads[0].max() / loads[0].min())
    by_material = float(loads[:, 0].max() / loads[:, 0].min())
    stiffness = [float(m.plane_strain_modulus) for m in materials.values()]
    by_modulus = max(stiffness) / min(stiffness)
    return Finding(
        (
            f"R_i from 5 to 100 mm: {by_size:.0f} times; over the five materials: "
            f"{by_material:.1f} times ({by_modulus:.1f} times through E* alone)"
        ),
        holds=by_size > by_material,
        choice=joined(f"at ΔR = {DR * 1e3:g} µm", material_origins(bench, YIELD)),
        values={"by size, -": by_size, "by material, -": by_material, "by E*, -": by_modulus},
    )


@claim(
    "3.3-elastic-constants-matter",
    "E and ν of the material also narrow the range of application",
    paper="they do",
    rule="both change the load at yield by more than 1 %",
)
def elastic_constants_matter(_bench: Bench) -> Finding:
    """Return what E and ν alone do to the load at yield, over Sect. 3.4's ranges."""

    def load(E: float, nu: float) -> float:
        return float(_yield_load(DR, Material("", E, nu, yield_stress=250.0), 10.0))

    by_E = load(69e3, 0.3) / load(600e3, 0.3)
    by_nu = load(200e3, 0.34) / load(200e3, 0.24)
    return Finding(
        (
            f"at equal yield stress f_Y ∝ 1/E*: {by_E:.2f} times lower at 600 than at 69 GPa, and "
            f"{100 * (1 - by_nu):.1f} % lower at ν = 0.34 than at 0.24"
        ),
        holds=abs(by_E - 1) > 0.01 and abs(by_nu - 1) > 0.01,
        values={"by E, -": by_E, "by nu, -": by_nu},
    )


def _yield_load(dR: float | FloatArray, material: Material, R_i: float) -> FloatArray:
    """Return the load at yield in N/mm."""
    return limits.yield_load(clearance_pair(dR, material, R_i))


def _steel_told(bench: Bench) -> str:
    """Name the steel whose numbers are shown, with its yield stress."""
    row = bench.material("low-carbon steel")
    origin = row.provenance["yield_stress_MPa"]
    return f"low-carbon steel (yield stress {row.material.yield_stress:g} MPa, {origin})"


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
        (
            f"penetration peaks at ln = {logarithm:.6f}, f = {factor:.4f}·E*ΔR. This bounds the "
            "algebra, not the physics: an elastic contact conforms well before that load"
        ),
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
        (
            f"spread over R_i = 100, 10, 5 mm: {spread:.1g} N/mm; at {DR * 1e3:g} µm "
            + listed(loads, "{:.0f} N/mm")
        ),
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
        f"R_i = {R:g} mm": float(
            _stress_at_limit(DR, bench.material("low-carbon steel").material, R)
        )
        for R in RADII
    }
    return Finding(
        "σ_H = (2/e)·E*ΔR/√(R_i·R_j); low-carbon steel at 50 µm: " + listed(stress, "{:.0f} MPa"),
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
        (
            "clearance above which yield comes first, R_i = 10 mm: "
            + listed(crossing[10.0], "{:.1f} µm")
            + f"; {shown}: {crossing[100.0][shown]:.1f} µm at R_i = 100 mm, "
            f"{crossing[5.0][shown]:.1f} µm at 5 mm, {weaker[shown]:.1f} µm at 10 mm with half "
            "the yield stress"
        ),
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
