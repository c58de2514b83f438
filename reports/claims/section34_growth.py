"""Section 3.4's statements on where the difference between the laws grows."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from cylcontact import limits
from cylcontact.materials import Material
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim, joined, listed, verdict_if, with_unit
from ..paper import (
    CLEARANCES,
    ELASTIC,
    LOADS,
    MATERIALS,
    Table,
    clearance_pair,
    difference,
    five_materials,
    origins,
)

SMALLEST = CLEARANCES[0]
BELOW = 0.25  # mm, the clearance below which the paper sees the difference grow
VALID_FOR_ALL = 0.020  # mm; from here Johnson's law holds at 1000 N/mm for all five materials





def _top(material: Material) -> float:
    """Return the highest load at 7.5 µm in N/mm: 1000 or Johnson's limit."""
    limit = float(limits.johnson_limit_load(clearance_pair(SMALLEST, material)))
    return min(LOADS[1], limit)


def _at_half_and_top(material: Material) -> tuple[float, float]:
    """Return the differences in percent at 7.5 µm under half the highest load and all of it."""
    top = _top(material)
    half, full = difference(SMALLEST, [top / 2, top], material)
    return float(half), float(full)


def _growth_choice(bench: Bench) -> str:
    """Say what 'high loads' are at the smallest clearance."""
    return joined(
        "high load: from half the highest load to all of it, 1000 N/mm or Johnson's limit",
        material_origins(bench, ELASTIC),
    )


@claim(
    "3.4-growth-at-low-clearance",
    "at the smallest clearances the difference grows under high loads",
    paper="grows",
    rule="the magnitude grows for every material but ceramics, which the paper excepts",
)
def growth_at_low_clearance(bench: Bench) -> Finding:
    """Return the growth of the difference at the smallest clearance under high loads."""
    found = {
        name: _at_half_and_top(m) for name, m in five_materials(bench).items() if name != "ceramics"
    }
    return Finding(
        "at 7.5 µm, from half the highest load to all of it: "
        + ", ".join(f"{name} {half:+.1f} → {full:+.1f} %" for name, (half, full) in found.items()),
        holds=all(abs(full) > abs(half) for half, full in found.values()),
        choice=_growth_choice(bench),
        values={
            f"{name} at {what} load, percent": value
            for name, pair in found.items()
            for what, value in zip(("half", "highest"), pair, strict=True)
        },
    )


@claim(
    "3.4-growth-with-falling-stiffness",
    "at the smallest clearances the difference is the larger the softer the material",
    paper="larger",
    rule="the magnitude rises from each material to the next softer one",
)
def growth_with_falling_stiffness(bench: Bench) -> Finding:
    """Return the difference at the smallest clearance and one load, from stiff to soft."""
    materials = five_materials(bench)
    load = min(_top(m) for m in materials.values())
    by_stiffness = sorted(materials.items(), key=lambda item: -float(item[1].plane_strain_modulus))
    found = {name: float(difference(SMALLEST, load, m)) for name, m in by_stiffness}
    return Finding(
        f"at 7.5 µm and {load:.0f} N/mm: {listed(found, '{:+.1f} %')}",
        holds=bool(np.all(np.diff(np.abs(list(found.values()))) > 0)),
        choice=joined(
            "compared at the highest load that Johnson's law carries for all five",
            material_origins(bench, ELASTIC),
        ),
        values=with_unit(found, "percent"),
    )


@claim(
    "3.4-ceramics-exception",
    "ceramics are the exception to that growth",
    paper="exception",
    rule="for ceramics the magnitude does not grow from half the highest load to all of it",
)
def ceramics_exception(bench: Bench) -> Finding:
    """Return the course of the difference for ceramics at the smallest clearance."""
    material = five_materials(bench)["ceramics"]
    half, full = _at_half_and_top(material)
    low = float(difference(SMALLEST, LOADS[0], material))
    return Finding(
        f"ceramics at 7.5 µm: {half:+.1f} → {full:+.1f} % from 500 to 1000 N/mm",
        holds=abs(full) <= abs(half),
        choice=_growth_choice(bench),
        alternatives=f"at the low end ceramics are the worst of all instead: {low:+.1f} % at 7.5 µm and "
            "10 N/mm",
        values={"half load, percent": half, "highest load, percent": full},
    )


def _rise(dR: float, material: Material) -> float:
    """Return the change of the signed difference from 500 to 1000 N/mm, in percentage points."""
    half, full = difference(dR, [LOADS[1] / 2, LOADS[1]], material)
    return float(full - half)


@claim(
    "3.4-growth-below-0.25-mm",
    "below 0.25 mm the difference grows under very high loads",
    paper="grows for ΔR < 0.25 mm",
    rule="the signed difference rises at every ΔR from 20 µm to 0.25 mm, for every material",
    paper_values={"dR, mm": BELOW},
)
def growth_below_quarter_mm(bench: Bench) -> Finding:
    """Return the growth under very high loads between 20 µm and 0.25 mm."""
    dR = np.geomspace(VALID_FOR_ALL, BELOW, 201)
    rises = {name: min(_rise(float(x), m) for x in dR) for name, m in five_materials(bench).items()}
    ends = {name: _magnitude_end(m) for name, m in five_materials(bench).items()}
    return Finding(
        "least rise of the signed difference from 500 to 1000 N/mm between 20 µm and 0.25 mm: "
            + listed(rises, "{:+.1f}")
            + " percentage points",
        holds=all(rise > 0 for rise in rises.values()),
        choice=joined(
            "signed as Eq 9 defines it; 'very high' is 500 to 1000 N/mm; from 20 µm, where "
            "Johnson's law carries 1000 N/mm for all five",
            material_origins(bench, ELASTIC),
        ),
        alternatives="in magnitude, with the sign left out, growth ends at ΔR of "
            + listed(ends, "{:.2f} mm")
            + " "
            + verdict_if(min(ends.values()) >= BELOW),
        values={f"{name}, percentage points": rise for name, rise in rises.items()}
        | {f"{name}, end of growth in magnitude, mm": end for name, end in ends.items()},
    )


def _magnitude_end(material: Material) -> float:
    """Return the ΔR in mm, up from 0.1, at which the magnitude stops to grow, 500 to 1000 N/mm."""

    def total(dR: float) -> float:
        # The magnitudes are equal where the signed differences cancel.
        return float(difference(dR, [LOADS[1] / 2, LOADS[1]], material).sum())

    return float(brentq(total, 0.1, 0.8))


@claim(
    "3.4-growth-below-0.25-mm-against-modulus",
    "that growth is the stronger the lower the modulus",
    paper="stronger",
    rule="at every ΔR from 20 µm to 0.25 mm the rise is larger for each next softer material",
)
def growth_against_modulus(bench: Bench) -> Finding:
    """Return the rise under very high loads from stiff to soft materials."""
    materials = five_materials(bench)
    by_stiffness = sorted(materials.items(), key=lambda item: -float(item[1].plane_strain_modulus))
    clearances = np.geomspace(VALID_FOR_ALL, BELOW, 51)
    rises = np.array([[_rise(float(x), m) for x in clearances] for _, m in by_stiffness])
    shown = {name: _rise(0.1, m) for name, m in by_stiffness}
    return Finding(
        f"rise from 500 to 1000 N/mm at 0.1 mm: {listed(shown, '{:+.1f}')} percentage points",
        holds=bool(np.all(np.diff(rises, axis=0) > 0)),
        choice=joined("as for the growth itself", material_origins(bench, ELASTIC)),
        values={f"{name}, percentage points": rise for name, rise in shown.items()},
    )
