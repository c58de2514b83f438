"""Section 3.4: where Johnson's law ends, and where the materials yield."""

from __future__ import annotations

import numpy as np

from cylcontact import limits
from cylcontact.materials import Material
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import (
    Finding,
    agrees_as_printed,
    claim,
    joined,
    listed,
    verdict_if,
    with_unit,
)

from .. import paper

SMALLEST, LARGEST = paper.COMPARED_CLEARANCES
LOWEST, HIGHEST = paper.LOADS
PLASTIC = Material("plastic", E=3e3, nu=0.4)  # assumed: a common unfilled plastic


def limit(material: Material, dR: float) -> float:
    """Return Johnson's limit in N/mm."""
    return float(limits.johnson_limit_load(paper.clearance_pair(dR, material)))


def yield_load(material: Material, dR: float, R_i: float = 10.0) -> float:
    """Return the load at yield in N/mm."""
    return float(limits.yield_load(paper.clearance_pair(dR, material, R_i), "Hertz"))


@claim(
    "3.4-limit-{short}-{dR_um:g}um",
    "Johnson's limit load for {name} at ΔR = {dR_um:g} µm",
    paper="{printed} N/mm",
    rule="agreement to the printed digit",
    cases=[
        {"short": name.split()[0], "name": name, "dR_um": 1e3 * dR, "dR": dR, "printed": printed}
        for (name, dR), printed in paper.JOHNSON_LIMITS.items()
    ],
)
def johnson_limit(bench: Bench, name: str, dR: float, printed: str) -> Finding:
    """Return Johnson's limit load in N/mm of one material at one clearance."""
    row = bench.material(name)
    load, sources = limit(row.material, dR), paper.origins({name: row}, (name,), paper.ELASTIC)
    circular = " (from these limits themselves, so this is a check of consistency only)"
    return Finding(
        f"{load:.2f} N/mm",
        holds=agrees_as_printed(load, printed),
        choice=sources + circular if "derived" in sources else sources,
        values={"load, N/mm": load},
        paper_values={"load, N/mm": float(printed)},
    )


@claim(
    "3.4-valid-at-1000",
    "at 7.5 µm Johnson's law holds up to 1000 N/mm for all but the aluminium and titanium alloys",
    paper="ceramics and both steels valid, aluminium and titanium alloys not",
    rule="exactly the three named materials have their limit at or above 1000 N/mm",
)
def valid_at_1000(bench: Bench) -> Finding:
    """Return Johnson's limit at 7.5 µm in N/mm of every material."""
    loads = {name: limit(m, SMALLEST) for name, m in paper.five_materials(bench).items()}
    valid = {name: load for name, load in loads.items() if load >= HIGHEST}
    return Finding(
        f"limits at {SMALLEST * 1e3:g} µm: {listed(loads, '{:.0f} N/mm')}",
        holds=valid.keys() == set(paper.MATERIALS[:3]),
        choice=paper.material_origins(bench, paper.ELASTIC),
        alternatives=f"for these three the law would hold to {min(valid.values(), default=0):.0f} "
        "N/mm, so 1000 is a round number rather than the largest valid load",
        values=with_unit(loads, "N/mm"),
    )


@claim(
    "3.4-penetration-falls",
    "beyond those limits the penetration falls as the load grows",
    paper="falls",
    rule="the ratio is below 1",
)
def penetration_falls(bench: Bench) -> Finding:
    """Return Eq 1's penetration at 1000 N/mm over that at its limit."""
    ratios = {}
    for name, dR in paper.JOHNSON_LIMITS:
        material = bench.material(name).material
        loads = [limit(material, dR), HIGHEST]
        at_limit, at_top = paper.eq1_penetration(loads, paper.clearance_pair(dR, material))
        ratios[f"{name} at {dR * 1e3:g} µm"] = float(at_top / at_limit)
    return Finding(
        "Eq 1's penetration at 1000 N/mm over that at the limit: " + listed(ratios, "{:.3f}"),
        holds=all(ratio < 1 for ratio in ratios.values()),
        values=with_unit(ratios, "-"),
    )


@claim(
    "3.4-plastics",
    "for plastics Johnson's domain is too small for a comparison",
    paper="comparison makes no sense",
    rule="at 7.5 µm the limit is below a tenth of the load range's upper end",
)
def plastics() -> Finding:
    """Return Johnson's limit in N/mm for a plastic."""
    low, high = limit(PLASTIC, SMALLEST), limit(PLASTIC, LARGEST)
    needed = HIGHEST / (low / SMALLEST)
    share = 100 * np.log(LARGEST / needed) / np.log(LARGEST / SMALLEST)
    return Finding(
        f"limit {low:.0f} N/mm at 7.5 µm and {high:.0f} N/mm at 2 mm; 1000 N/mm needs "
        f"ΔR ≥ {needed:.2f} mm",
        holds=low < HIGHEST / 10,
        choice="assumed plastic: 3 GPa, ν = 0.4",
        alternatives=f"from {needed:.2f} to 2 mm, {share:.0f} % of the clearances "
        "(logarithmically), the comparison could be made over all loads",
        values={"limit at 7.5 um, N/mm": low, "limit at 2 mm, N/mm": high},
    )


def yield_exponent(E: float = 1.0, stress: float = 1.0) -> float:
    """Return log2 of the change of the yield load when E or σ_Y are multiplied as given."""
    changed, steel = (
        yield_load(Material("", 200e3 * x, 0.3, 250.0 * y), 0.05)
        for x, y in ((E, stress), (1.0, 1.0))
    )
    return float(np.log2(changed / steel))


@claim(
    "3.4-allowable-load-against-strength",
    "the largest allowable load grows with the yield strength",
    paper="grows",
    rule="positive exponent",
)
def allowable_load_against_strength() -> Finding:
    """Return the exponent of the yield stress in the load at yield."""
    exponent = yield_exponent(stress=2)
    return Finding(
        f"f_Y ∝ σ_Y^{exponent:.3f}", holds=exponent > 0, values={"exponent, -": exponent}
    )


@claim(
    "3.4-allowable-load-against-modulus",
    "the load that can be carried without yielding grows with the composite modulus and "
    "falls when Young's modulus falls",
    paper="grows with E*",
    rule="positive exponent",
)
def allowable_load_against_modulus() -> Finding:
    """Return the exponent of the modulus in the load at yield, and in Johnson's limit."""
    exponent = yield_exponent(E=2)
    stiff, soft = (limit(Material("", E, 0.3), 0.05) for E in (400e3, 200e3))
    johnson = float(np.log2(stiff / soft))
    return Finding(
        f"f_Y ∝ E*^{exponent:.3f}: at equal yield stress it falls with E*",
        holds=exponent > 0,
        choice="a stiffer pair makes a narrower contact, hence more stress; follows from the "
        "paper's own Eq 7 solved for the load",
        alternatives="Johnson's limit (Eq 8), the other load called largest allowable, goes as "
        f"E*^{johnson:.3f} {verdict_if(johnson > 0)} but does not know the yield stress",
        values={"exponent of f_Y, -": exponent, "exponent of Johnson's limit, -": johnson},
    )


@claim(
    "3.4-low-clearance-low-load",
    "(i) very small clearances with low loads have no practical application",
    paper="no application",
    rule="none",
)
def low_clearance_low_load() -> Finding:
    """Return no value: there is no criterion for practical application."""
    return Finding(
        "—",
        holds=None,
        choice="no mechanical limit excludes them (stress is lowest there), so the practical "
        f"domain above keeps them: {paper.PRACTICAL.clearances[0] * 1e3:g} µm with "
        f"{paper.PRACTICAL.loads[0]:g} N/mm belongs to it",
    )


@claim(
    "3.4-high-clearance-high-load",
    "(ii) large clearances with high loads lie beyond yield",
    paper="yield is quickly reached",
    rule="every material yields below 1000 N/mm at 2 mm",
)
def high_clearance_high_load(bench: Bench) -> Finding:
    """Return the load at yield in N/mm at the largest clearance."""
    loads = {
        R_i: {name: yield_load(m, LARGEST, R_i) for name, m in paper.five_materials(bench).items()}
        for R_i in (5.0, 10.0, 100.0)
    }
    below = {R_i: sum(f < HIGHEST for f in row.values()) for R_i, row in loads.items()}
    return Finding(
        f"load at yield at {LARGEST:g} mm, R_i = 10 mm: {listed(loads[10.0], '{:.0f} N/mm')}",
        holds=below[10.0] == len(paper.MATERIALS),
        choice=joined("R_i = 10 mm", paper.material_origins(bench, paper.YIELD)),
        alternatives=f"with R_i = 5 mm {below[5.0]} of the five yield below 1000 N/mm, the last at "
        f"{max(loads[5.0].values()):.0f} N/mm {verdict_if(below[5.0] == len(paper.MATERIALS))}; "
        f"with R_i = 100 mm {below[100.0]} do {verdict_if(below[100.0] == len(paper.MATERIALS))}",
        values=with_unit(loads[10.0], "N/mm"),
    )


def stress_ratio(material: Material, load: float, R_i: float = 10.0) -> float:
    """Return Hertz's stress over the yield stress at the largest clearance, where it is largest."""
    return float(np.sqrt(load / yield_load(material, LARGEST, R_i)))


@claim(
    "3.4-hard-material-small-load",
    "(iii) very hard materials reach their elastic limit even under very small loads",
    paper="limit quickly reached",
    rule="the strength is reached somewhere in 7.5 µm ≤ ΔR ≤ 2 mm",
)
def hard_material_small_load(bench: Bench) -> Finding:
    """Return the stress over the strength of the hardest material under the smallest load."""
    material = bench.material("ceramics").material
    ratio, small = (stress_ratio(material, LOWEST, R_i) for R_i in (10.0, 5.0))
    return Finding(
        f"ceramics under {LOWEST:g} N/mm: stress up to {100 * ratio:.0f} % of the strength (at "
        "2 mm, R_i = 10 mm)",
        holds=ratio >= 1,
        choice=joined(
            "R_i = 10 mm", paper.origins(paper.material_rows(bench), ("ceramics",), paper.YIELD)
        ),
        alternatives=f"with R_i = 5 mm up to {100 * small:.0f} % {verdict_if(small >= 1)}",
        values={"stress over strength, -": ratio},
    )


@claim(
    "3.4-soft-material-high-load",
    "(iv) weak materials such as aluminium alloys reach yield under very high loads",
    paper="limit quickly reached",
    rule="yield is reached somewhere in 7.5 µm ≤ ΔR ≤ 2 mm",
)
def soft_material_high_load(bench: Bench) -> Finding:
    """Return the stress over the yield stress of the aluminium alloy under the highest load."""
    name = "aluminium alloy"
    material, R_i = bench.material(name).material, 10.0
    ratio = stress_ratio(material, HIGHEST)
    # The load at yield is C·R_i·(R_i − ΔR)/ΔR.
    constant = yield_load(material, 1.0) / (R_i * (R_i - 1.0))
    edge = R_i**2 / (HIGHEST / constant + R_i)
    return Finding(
        f"{name} under {HIGHEST:g} N/mm: up to {ratio:.1f} times the yield stress, reached from "
        f"ΔR = {edge:.2f} mm upwards (R_i = 10 mm)",
        holds=ratio >= 1,
        choice=joined(
            "R_i = 10 mm", paper.origins(paper.material_rows(bench), (name,), paper.YIELD)
        ),
        values={"stress over yield stress, -": ratio, "dR at yield, mm": edge},
    )
