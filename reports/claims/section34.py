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

from ..paper import (
    CLEARANCES,
    ELASTIC,
    LOADS,
    MATERIALS,
    PRACTICAL,
    YIELD,
    clearance_pair,
    eq1_penetration,
    five_materials,
    material_origins,
    material_rows,
    origins,
)

# Johnson's limit in N/mm as the text prints it, by material and ΔR in mm.
PRINTED = {
    ("aluminium alloy", 0.0075): "494",
    ("aluminium alloy", 0.010): "658",
    ("titanium alloy", 0.0075): "865",
}
PLASTIC = Material("plastic", E=3e3, nu=0.4)  # assumed: a common unfilled plastic


def _limit(material: Material, dR: float) -> float:
    """Return Johnson's limit in N/mm."""
    return float(limits.johnson_limit_load(clearance_pair(dR, material)))


@claim(
    "3.4-limit-{short}-{dR_um:g}um",
    "Johnson's limit load for {name} at ΔR = {dR_um:g} µm",
    paper="{printed} N/mm",
    rule="agreement to the printed digit",
    cases=[
        {"short": name.partition(" ")[0], "name": name, "dR_um": 1e3 * dR, "printed": printed}
        for (name, dR), printed in PRINTED.items()
    ],
)
def johnson_limit(bench: Bench, name: str, dR_um: float, printed: str, **_short: str) -> Finding:
    """Return Johnson's limit load of one material at one clearance."""
    material = bench.material(name).material
    load = _limit(material, dR_um * 1e-3)
    sources = origins({name: bench.material(name)}, (name,), ELASTIC)
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
def valid_at_top_load(bench: Bench) -> Finding:
    """Return the materials for which Johnson's law still holds at 7.5 µm and 1000 N/mm."""
    dR, top = CLEARANCES[0], LOADS[1]
    found = {name: _limit(m, dR) for name, m in five_materials(bench).items()}
    valid = {name for name, load in found.items() if load >= top}
    least = min(found[name] for name in valid) if valid else 0.0
    return Finding(
        f"limits at {dR * 1e3:g} µm: {listed(found, '{:.0f} N/mm')}",
        holds=valid == set(MATERIALS[:3]),
        choice=material_origins(bench, ELASTIC),
        alternatives=(
            f"for these three the law would hold to {least:.0f} N/mm, so 1000 is a round number "
            "rather than the largest valid load"
        ),
        values=with_unit(found, "N/mm"),
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
    for name, dR in PRINTED:
        pair = clearance_pair(dR, bench.material(name).material)
        limit = float(limits.johnson_limit_load(pair))
        at_limit, at_top = eq1_penetration([limit, LOADS[1]], pair)
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
def plastics_left_out(_bench: Bench) -> Finding:
    """Return Johnson's limit for a plastic."""
    low, high = _limit(PLASTIC, CLEARANCES[0]), _limit(PLASTIC, CLEARANCES[1])
    needed = LOADS[1] / (low / CLEARANCES[0])
    return Finding(
        (
            f"limit {low:.0f} N/mm at 7.5 µm and {high:.0f} N/mm at 2 mm; 1000 N/mm needs "
            f"ΔR ≥ {needed:.2f} mm"
        ),
        holds=low < LOADS[1] / 10,
        choice="assumed plastic: 3 GPa, ν = 0.4",
        alternatives=(
            f"from {needed:.2f} to 2 mm, {100 * np.log(2 / needed) / np.log(2 / 0.0075):.0f} % of "
            "the clearances (logarithmically), the comparison could be made over all loads"
        ),
        values={"limit at 7.5 um, N/mm": low, "limit at 2 mm, N/mm": high},
    )


def _yield_exponent(E: float, stress: float) -> float:
    """Return log2 of the change of the yield load when E or σ_Y are multiplied as given."""

    def load(modulus: float, strength: float) -> float:
        pair = clearance_pair(0.05, Material("", modulus, 0.3, strength), 10.0)
        return float(limits.yield_load(pair))

    return float(np.log2(load(200e3 * E, 250.0 * stress) / load(200e3, 250.0)))


@claim(
    "3.4-allowable-load-against-strength",
    "the largest allowable load grows with the yield strength",
    paper="grows",
    rule="positive exponent",
)
def yield_load_against_strength(_bench: Bench) -> Finding:
    """Return the exponent of the yield stress in the load at yield."""
    exponent = _yield_exponent(1, 2)
    return Finding(
        f"f_Y ∝ σ_Y^{exponent:.3f}",
        holds=exponent > 0,
        values={"exponent, -": exponent},
    )


@claim(
    "3.4-allowable-load-against-modulus",
    (
        "the load that can be carried without yielding grows with the composite modulus and "
        "falls when Young's modulus falls"
    ),
    paper="grows with E*",
    rule="positive exponent",
)
def yield_load_against_modulus(_bench: Bench) -> Finding:
    """Return the exponent of the modulus in the load at yield, and in Johnson's limit."""
    exponent = _yield_exponent(2, 1)
    johnson = float(np.log2(_johnson_limit(400e3) / _johnson_limit(200e3)))
    return Finding(
        f"f_Y ∝ E*^{exponent:.3f}: at equal yield stress it falls with E*",
        holds=exponent > 0,
        choice=(
            "a stiffer pair makes a narrower contact, hence more stress; follows from the paper's "
            "own Eq 7 solved for the load"
        ),
        alternatives=(
            f"Johnson's limit (Eq 8), the other load called largest allowable, goes as "
            f"E*^{johnson:.3f} {verdict_if(johnson > 0)} but does not know the yield stress"
        ),
        values={"exponent of f_Y, -": exponent, "exponent of Johnson's limit, -": johnson},
    )


def _johnson_limit(E: float) -> float:
    """Return Johnson's limit in N/mm at 50 µm for a modulus in MPa."""
    return float(limits.johnson_limit_load(clearance_pair(0.05, Material("", E, 0.3))))


def _yield_loads(bench: Bench, dR: float, R_i: float) -> dict[str, float]:
    """Return the load at yield in N/mm of each material."""
    return {
        name: float(limits.yield_load(clearance_pair(dR, m, R_i)))
        for name, m in five_materials(bench).items()
    }


@claim(
    "3.4-low-clearance-low-load",
    "(i) very small clearances with low loads have no practical application",
    paper="no application",
    rule="none",
)
def low_clearance_low_load(_bench: Bench) -> Finding:
    """Return the statement on practice, for which there is no criterion."""
    return Finding(
        "—",
        holds=None,
        choice=(
            "no mechanical limit excludes them (stress is lowest there), so the practical domain "
            f"above keeps them: {PRACTICAL.clearances[0] * 1e3:g} µm with "
            f"{PRACTICAL.loads[0]:g} N/mm belongs to it"
        ),
    )


@claim(
    "3.4-high-clearance-high-load",
    "(ii) large clearances with high loads lie beyond yield",
    paper="yield is quickly reached",
    rule="every material yields below 1000 N/mm at 2 mm",
)
def high_clearance_high_load(bench: Bench) -> Finding:
    """Return the load at yield at the largest clearance."""
    dR, top = CLEARANCES[1], LOADS[1]
    radii = (10.0, 5.0, 100.0)
    loads = {R_i: _yield_loads(bench, dR, R_i) for R_i in radii}
    below = {R_i: sum(load < top for load in loads[R_i].values()) for R_i in radii}
    return Finding(
        f"load at yield at {dR:g} mm, R_i = 10 mm: {listed(loads[10.0], '{:.0f} N/mm')}",
        holds=below[10.0] == len(MATERIALS),
        choice=joined("R_i = 10 mm", material_origins(bench, YIELD)),
        alternatives=(
            f"with R_i = 5 mm {below[5.0]} of the five yield below 1000 N/mm, the last at "
            f"{max(loads[5.0].values()):.0f} N/mm {verdict_if(below[5.0] == len(MATERIALS))}; with "
            f"R_i = 100 mm {below[100.0]} do {verdict_if(below[100.0] == len(MATERIALS))}"
        ),
        values=with_unit(loads[10.0], "N/mm"),
    )


@claim(
    "3.4-hard-material-small-load",
    "(iii) very hard materials reach their elastic limit even under very small loads",
    paper="limit quickly reached",
    rule="the strength is reached somewhere in 7.5 µm ≤ ΔR ≤ 2 mm",
)
def hard_material_small_load(bench: Bench) -> Finding:
    """Return how near to its strength the hardest material is at the smallest load."""
    ratio = {R_i: _stress_ratio(bench, "ceramics", LOADS[0], R_i) for R_i in (10.0, 5.0)}
    return Finding(
        (
            f"ceramics under {LOADS[0]:g} N/mm: stress up to {100 * ratio[10.0]:.0f} % of the "
            "strength (at 2 mm, R_i = 10 mm)"
        ),
        holds=ratio[10.0] >= 1,
        choice=joined("R_i = 10 mm", origins(material_rows(bench), ("ceramics",), YIELD)),
        alternatives=(
            f"with R_i = 5 mm up to {100 * ratio[5.0]:.0f} % {verdict_if(ratio[5.0] >= 1)}"
        ),
        values={"stress over strength, -": ratio[10.0]},
    )


@claim(
    "3.4-soft-material-high-load",
    "(iv) weak materials such as aluminium alloys reach yield under very high loads",
    paper="limit quickly reached",
    rule="yield is reached somewhere in 7.5 µm ≤ ΔR ≤ 2 mm",
)
def soft_material_high_load(bench: Bench) -> Finding:
    """Return how near to yield the aluminium alloy is at the highest load."""
    name = "aluminium alloy"
    ratio = _stress_ratio(bench, name, LOADS[1], 10.0)
    edge = _clearance_at_yield(bench.material(name).material, LOADS[1], 10.0)
    return Finding(
        (
            f"{name} under {LOADS[1]:g} N/mm: up to {ratio:.1f} times the yield stress, reached "
            f"from ΔR = {edge:.2f} mm upwards (R_i = 10 mm)"
        ),
        holds=ratio >= 1,
        choice=joined("R_i = 10 mm", origins(material_rows(bench), (name,), YIELD)),
        values={"stress over yield stress, -": ratio, "dR at yield, mm": edge},
    )


def _stress_ratio(bench: Bench, name: str, load: float, R_i: float) -> float:
    """Return Hertz's stress over the yield stress at the largest clearance, where it is largest."""
    material = five_materials(bench)[name]
    pair = clearance_pair(CLEARANCES[1], material, R_i)
    return float(np.sqrt(load / limits.yield_load(pair)))


def _clearance_at_yield(material: Material, load: float, R_i: float) -> float:
    """Return the ΔR in mm at which `load` reaches yield: f_Y = C·R_i·(R_i − ΔR)/ΔR."""
    pair = clearance_pair(1.0, material, R_i)
    constant = float(limits.yield_load(pair) / pair.R)
    return R_i**2 / (load / constant + R_i)
