"""Section 3.4's statements on where Johnson's law ends."""

from __future__ import annotations

import numpy as np

from cylcontact import limits
from cylcontact.materials import Material
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, agrees_as_printed, claim, listed, with_unit
from ..paper import (
    CLEARANCES,
    ELASTIC,
    LOADS,
    MATERIALS,
    Table,
    clearance_pair,
    eq1_penetration,
    five_materials,
    origins,
)

PRINTED_LIMITS = (
    ("aluminium alloy", 0.0075, "494"),
    ("aluminium alloy", 0.010, "658"),
    ("titanium alloy", 0.0075, "865"),
)
PLASTIC = Material("plastic", E=3e3, nu=0.4)  # assumed: a common unfilled plastic





def _limit(material: Material, dR: float) -> float:
    """Return Johnson's limit in N/mm."""
    return float(limits.johnson_limit_load(clearance_pair(dR, material)))


@claim(
    f"3.4-limit-{name.partition(' ')[0]}-{dR * 1e3:g}um",
    f"Johnson's limit load for {name} at ΔR = {dR * 1e3:g} µm",
    paper=f"{printed} N/mm",
    rule="agreement to the printed digit",
    paper_values={"load, N/mm": float(printed)},
)
def johnson_limit(bench: Bench, name: str, dR: float, printed: str) -> Finding:
    """Return Johnson's limit load of one material at one clearance."""
    material = bench.material(name).material
    load = _limit(material, dR)
    sources = origins(bench, (name,), ELASTIC)
    circular = " (from these limits themselves, so this is a check of consistency only)"
    return Finding(
        f"{load:.2f} N/mm",
        holds=agrees_as_printed(load, printed),
        choice=sources + circular if "derived" in sources else sources,
        values={"load, N/mm": load},
    )


@claim(
    "3.4-valid-at-1000",
    "at 7.5 µm Johnson's law holds up to 1000 N/mm for all but the aluminium and titanium "
        "alloys",
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
        alternatives=f"for these three the law would hold to {least:.0f} N/mm, so 1000 is a round number "
            "rather than the largest valid load",
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
    for name, dR, _ in PRINTED_LIMITS:
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
def plastics_left_out(bench: Bench) -> Finding:
    """Return Johnson's limit for a plastic."""
    low, high = _limit(PLASTIC, CLEARANCES[0]), _limit(PLASTIC, CLEARANCES[1])
    needed = LOADS[1] / (low / CLEARANCES[0])
    return Finding(
        f"limit {low:.0f} N/mm at 7.5 µm and {high:.0f} N/mm at 2 mm; 1000 N/mm needs "
            f"ΔR ≥ {needed:.2f} mm",
        holds=low < LOADS[1] / 10,
        choice="assumed plastic: 3 GPa, ν = 0.4",
        alternatives=f"from {needed:.2f} to 2 mm, {100 * np.log(2 / needed) / np.log(2 / 0.0075):.0f} % of "
            "the clearances (logarithmically), the comparison could be made over all loads",
        values={"limit at 7.5 um, N/mm": low, "limit at 2 mm, N/mm": high},
    )
