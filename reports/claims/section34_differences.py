"""Sections 3.4 and 5: how large the difference between the two laws gets, and where."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from cylcontact.bodies.material import Material
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, Reading, claim, with_unit
from cylcontact.support.arrays import BoolArray, FloatArray, as_floats

from .. import paper
from ..extremes import (
    Extreme,
    best_load,
    largest_difference,
    lowest_difference,
    share_below,
)
from ..readings import found, reading
from .section34 import elastic

Extremes = Mapping[str, Extreme]
Materials = Mapping[str, Material]
MAPS = ("fig10", "fig11", "fig12", "fig13", "fig14")

# Ours: outside the middle half of a logarithmic axis, loads and clearances are low or high.
LOW_CLEARANCE, HIGH_CLEARANCE = np.geomspace(*paper.COMPARED_CLEARANCES, 5)[[1, 3]].tolist()
LOW_LOAD, HIGH_LOAD = paper.MODERATE_LOADS
LARGEST = paper.COMPARED_CLEARANCES[1]
SMALL_HOLE = min(paper.RADII)
# Ours: the middle third of the logarithmic loads.
MIDDLE_LOADS: paper.Interval = (10 ** (5 / 3), 10 ** (7 / 3))
MIDDLE_LABEL = f"{MIDDLE_LOADS[0]:.0f}–{MIDDLE_LOADS[1]:.0f} N/mm"
# From the clearances on that the paper calls typical of a bearing, and of mechanical systems.
FROM_50_UM = replace(paper.MODERATE, clearances=(paper.TRAINING_DR["internal"][0], LARGEST))
# In the smallest hole large clearances with high loads, and weak materials, yield soonest.
MIDDLE_SMALL_HOLE = replace(FROM_50_UM, R_i=SMALL_HOLE, loads=MIDDLE_LOADS)


def in_corner(name: str, dR: FloatArray, load: FloatArray) -> BoolArray:
    """Whether the paper leaves conditions out: its corners (i) to (iv), and its exception.

    The exception are high loads at small clearances.
    """
    small, large = dR < LOW_CLEARANCE, dR > HIGH_CLEARANCE
    low, high = load < LOW_LOAD, load > HIGH_LOAD
    corner: BoolArray = (small & (low | high)) | (large & high)
    of_material = {"ceramics": low, "aluminium alloy": high}
    return corner | of_material[name] if name in of_material else corner


def largest_by_material(
    materials: Materials, domain: paper.Domain, corners: bool = True
) -> dict[str, Extreme]:
    """Return each material's largest difference over a domain, with its corners or without."""
    return {
        name: largest_difference(m, domain, None if corners else partial(in_corner, name))
        for name, m in materials.items()
    }


def as_values(extremes: Extremes) -> dict[str, float]:
    """Return value, ΔR and load of each extreme under names with units."""
    values: dict[str, float] = {}
    for name, extreme in extremes.items():
        values[f"{name}, percent"] = extreme.percent
        values[f"{name}, dR, mm"] = extreme.dR
        values[f"{name}, load, N/mm"] = extreme.load
    return values


def below(bound: float, choice: str, extremes: Extremes, missing: str = "") -> Reading:
    """Return whether the largest of the differences is below a bound in percent."""
    name = max(extremes, key=lambda each: abs(extremes[each].percent))
    excess = abs(extremes[name].percent) - bound
    miss = f"{excess:.1f} points above {bound:.3g} %"
    worst = extremes[name]
    text = f"{worst.percent:+.1f} % ({name}, {worst.place})"
    return reading(choice, text, excess < 0, miss, missing)


def bounded(
    materials: Materials,
    bound: float,
    choice: str,
    domain: paper.Domain,
    missing: str = "",
) -> Reading:
    """Return whether the differences are below a bound in percent over a domain."""
    return below(bound, choice, largest_by_material(materials, domain), missing)


def with_share(
    own: Reading,
    materials: Materials,
    bound: float,
    domain: paper.Domain,
    called: str = "these clearances and loads",
) -> Reading:
    """Return a reading that also tells over how much of the domain the bound is kept."""
    shares = [share_below(bound, m, domain) for m in materials.values()]
    share = f"below {bound:g} % over {min(shares):.3g} to {max(shares):.3g} % of {called}"
    return replace(own, ours=f"the largest difference is {own.ours}; by material, it is {share}")


def halved_strengths(materials: Materials) -> Materials:
    """Return the materials with half the yield stress."""
    return {name: replace(m, yield_stress=paper.strength(m) / 2) for name, m in materials.items()}


@claim(
    "3.4-below-8-percent",
    "the two laws differ by less than 8 % in conditions with practical applications",
    paper="< 8 %",
    rule="below 8 % everywhere, for every material",
    figures=MAPS,
    paper_values={"bound, percent": 8.0},
)
def below_8_percent(bench: Bench) -> Finding:
    """Return the largest difference over the practical domain."""
    materials = paper.five_materials(bench)
    largest = largest_by_material(materials, paper.PRACTICAL)
    own = below(8, "practical domain, R_i = 10 mm", largest)
    return found(
        [
            with_share(own, materials, 8, paper.PRACTICAL, "the practical domain"),
            bounded(
                halved_strengths(materials),
                8,
                "R_i = 5 mm and half the yield stresses",
                replace(paper.PRACTICAL, R_i=SMALL_HOLE),
                paper.TABLE_1,
            ),
        ],
        values=as_values(largest),
    )


@claim(
    "3.4-below-4-percent",
    "at moderate loads they differ by less than 4 %, whatever the material",
    paper="< 4 %",
    rule="below 4 % for every material from 50 µm on, clear of the maximum around 25 µm",
    figures=MAPS,
    paper_values={"bound, percent": 4.0},
)
def below_4_percent(bench: Bench) -> Finding:
    """Return the largest difference at moderate loads, the maximum around 25 µm left out."""
    materials, switch = paper.five_materials(bench), float(paper.Y_SWITCH)
    other = partial(bounded, materials, 4.0)
    largest = largest_by_material(materials, FROM_50_UM)
    any_load = replace(FROM_50_UM, loads=paper.LOADS)
    best = {name: best_load(m, any_load) for name, m in materials.items()}
    # Where Y changes branch the difference has a ridge, as high for every material.
    at_switch = replace(paper.JOHNSON_ONLY, clearances=(switch, switch))
    ridge = {name: lowest_difference(m, at_switch) for name, m in materials.items()}
    flattest = max(extreme.percent for extreme in ridge.values())
    own = below(4, "moderate loads from 50 µm on", largest, paper.WINDOW)
    own = with_share(own, materials, 4, FROM_50_UM)
    loads = [extreme.load for extreme in ridge.values()]
    told = (
        f"at {switch:g} mm every material reaches {flattest:.1f} %, each at a load of its own "
        f"({min(loads):.0f} to {max(loads):.0f} N/mm)"
    )
    middle, sect_32 = (replace(FROM_50_UM, loads=loads) for loads in (MIDDLE_LOADS, (20.0, 100.0)))
    return found(
        [
            replace(own, ours=f"{own.ours}; {told}"),
            other(f"{MIDDLE_LABEL}, R_i = 10 mm", middle, paper.WINDOW),
            other(f"{MIDDLE_LABEL}, R_i = 5 mm", MIDDLE_SMALL_HOLE, paper.WINDOW),
            other("20–100 N/mm (Sect. 3.2)", sect_32, paper.WINDOW),
            below(4, "the load that suits each material best", best, paper.WINDOW),
            bounded(
                halved_strengths(materials),
                4,
                "half the yield stresses",
                FROM_50_UM,
                paper.TABLE_1,
            ),
        ],
        values=as_values(largest)
        | {f"{name}, at best load, percent": abs(e.percent) for name, e in best.items()}
        | {f"{name}, ridge, percent": e.percent for name, e in ridge.items()}
        | {f"{name}, ridge, N/mm": e.load for name, e in ridge.items()},
    )


def rounds_to_8(choice: str, extremes: Extremes, missing: str = "") -> Reading:
    """Return whether the largest of the differences rounds to 8 %."""
    percent = max(abs(extreme.percent) for extreme in extremes.values())
    ours = below(8, choice, extremes).ours
    return reading(choice, ours, round(percent) == 8, f"{percent - 8:+.1f} points", missing)


@claim(
    "3.4-about-8-percent-at-25um",
    "around 25 µm and at moderate loads the difference has a slight maximum of about 8 %",
    paper="about 8 %",
    rule="the largest magnitude there rounds to 8 %",
    figures=MAPS,
    paper_values={"difference, percent": 8.0, "dR, mm": 0.025},
)
def about_8_percent_at_25um(bench: Bench) -> Finding:
    """Return the largest difference at ΔR = 25 µm and moderate loads."""
    materials = paper.five_materials(bench)
    at_25_um = replace(paper.MODERATE, clearances=(0.025, 0.025))
    exactly = largest_by_material(materials, at_25_um)
    troughs = {name: lowest_difference(m, paper.PRACTICAL) for name, m in materials.items()}
    trough = next(iter(troughs.values()))
    return found(
        [
            rounds_to_8("exactly 25 µm", exactly),
            replace(
                rounds_to_8("the maximum, wherever it lies", troughs),
                ground="the sentence is of a maximum",
            ),
        ],
        values=with_unit({name: extreme.percent for name, extreme in exactly.items()}, "percent")
        | {"trough, percent": trough.percent, "trough, dR, mm": trough.dR}
        | with_unit({name: extreme.load for name, extreme in troughs.items()}, "trough, N/mm"),
    )


# Assumed, for materials that the paper does not treat: E in GPa, ν and yield stress in MPa.
OTHERS = {"bronze": (110.0, 0.34, 220.0), "grey iron": (110.0, 0.26, 250.0)} | {
    "alumina": (380.0, 0.22, 300.0)
}
SOFT_OTHERS = {"magnesium alloy": (45.0, 0.35, 200.0), "white metal": (50.0, 0.35, 40.0)}


def with_strengths(numbers: Mapping[str, tuple[float, float, float]]) -> dict[str, Material]:
    """Return materials of E in GPa, ν and yield stress in MPa."""
    return {
        name: replace(elastic(E, nu), yield_stress=stress)
        for name, (E, nu, stress) in numbers.items()
    }


@claim(
    "3.4-other-materials",
    "the conclusions on accuracy carry over to other engineering materials",
    paper="they hold",
    rule="at moderate loads no larger difference than that of the worst of the five materials",
    figures=MAPS,
)
def other_materials(bench: Bench) -> Finding:
    """Return the largest differences of other materials at moderate loads."""
    five = largest_by_material(paper.five_materials(bench), paper.MODERATE)
    worst = max(abs(extreme.percent) for extreme in five.values())
    stiff = largest_by_material(with_strengths(OTHERS), paper.MODERATE)
    soft = largest_by_material(with_strengths(SOFT_OTHERS), paper.MODERATE)
    own = below(worst, "bronze, grey iron and alumina", stiff)
    trough = lowest_difference(elastic(69.0, 0.24), paper.JOHNSON_ONLY)
    per_modulus = trough.load / (float(elastic(69.0, 0.24).plane_strain_modulus) / 2)
    low, high = (load / per_modulus / 1e3 for load in paper.LOADS)
    return found(
        [replace(own, ours=f"{own.ours}, against {worst:.1f} % among the five")],
        values={"least E*, GPa": low, "most E*, GPa": high, **as_values(stiff), **as_values(soft)},
    )


SMALLEST = paper.COMPARED_CLEARANCES[0]
SMALL = np.array(sorted({dR for _, dR in paper.JOHNSON_LIMITS}))  # mm, those of the passage
GROWTH_BELOW = 0.25  # mm, where the paper sees the difference grow
VALID_FOR_ALL = 0.020  # mm, from where Johnson's law holds at 1000 N/mm for all five materials
BELOW_QUARTER_MM = np.geomspace(VALID_FOR_ALL, GROWTH_BELOW, 201)


def to_highest_load(material: Material, dR: FloatArray) -> FloatArray:
    """Return the difference under half the highest load at each clearance and under all of it.

    That is 1000 N/mm or Johnson's limit.
    """
    loads = np.multiply.outer(paper.JOHNSON_ONLY.top_load(dR, material), [0.5, 1.0])
    return paper.difference(dR[:, None], loads, material)


def growth(material: Material, dR: FloatArray) -> FloatArray:
    """Return by how many points the difference grows from half the highest load to all of it."""
    return as_floats(np.diff(to_highest_load(material, dR))[:, 0])


def from_stiff_to_soft(bench: Bench) -> dict[str, Material]:
    """Return the materials of Figs 10–14, the stiffest first."""
    materials = paper.five_materials(bench).items()
    return dict(sorted(materials, key=lambda item: -float(item[1].plane_strain_modulus)))


def grows(choice: str, growths: Mapping[str, float], told: str) -> Reading:
    """Return whether the difference, of which `told` begins a sentence, grows for every material.

    `growths` has the least over the clearances.
    """
    name = min(growths, key=growths.__getitem__)
    text = f"{told} grows by {growths[name]:.1f} percentage points or more (least for {name})"
    return reading(choice, text, growths[name] > 0, f"falls by {-growths[name]:.1f} points")


@claim(
    "3.4-growth-at-low-clearance",
    "at the smallest clearances the difference grows under high loads",
    paper="grows",
    rule="it grows for every material but ceramics, which the paper excepts",
    figures=MAPS,
)
def growth_at_low_clearance(bench: Bench) -> Finding:
    """Return the growth from half the highest load to all of it at the smallest clearances."""
    materials = from_stiff_to_soft(bench)
    del materials["ceramics"]
    sizes = {name: np.abs(to_highest_load(m, SMALL)) for name, m in materials.items()}
    halves = {name: to_highest_load(m, SMALL[:1])[0] for name, m in materials.items()}
    own = grows(
        "7.5 and 10 µm, magnitude, from half the highest load",
        {name: float(np.diff(size).min()) for name, size in sizes.items()},
        "from half the highest load to all of it the difference",
    )
    return found(
        [own],
        values={
            f"{name} at {load} load, percent": float(value)
            for name, pair in halves.items()
            for load, value in zip(("half", "highest"), pair, strict=True)
        },
    )


@claim(
    "3.4-growth-below-0.25-mm",
    "below 0.25 mm the difference grows under very high loads",
    paper="grows for ΔR < 0.25 mm",
    rule="it grows at every ΔR from 20 µm to 0.25 mm, for every material",
    figures=MAPS,
    paper_values={"dR, mm": GROWTH_BELOW},
)
def growth_below_quarter_mm(bench: Bench) -> Finding:
    """Return the least growth under very high loads between 20 µm and 0.25 mm."""
    materials = from_stiff_to_soft(bench)
    rises = {name: float(growth(m, BELOW_QUARTER_MM).min()) for name, m in materials.items()}
    own = grows(
        "signed as in Eq 9, from 500 to 1000 N/mm",
        rises,
        "from 500 to 1000 N/mm the difference with its sign",
    )
    return found([own], values=with_unit(rises, "percentage points"))


@claim(
    "3.4-growth-below-0.25-mm-against-modulus",
    "below 0.25 mm the growth under very high loads is the stronger the lower the modulus, "
    "ceramics excepted",
    paper="stronger; ceramics are the exception",
    rule="at every ΔR from 20 µm to 0.25 mm no softer material grows less",
    figures=MAPS,
)
def growth_below_quarter_mm_against_modulus(bench: Bench) -> Finding:
    """Return the growth under very high loads from stiff to soft materials."""
    materials = from_stiff_to_soft(bench)
    sizes = {name: growth(m, BELOW_QUARTER_MM) for name, m in materials.items()}
    at_tenth = {name: float(growth(m, as_floats([0.1]))[0]) for name, m in materials.items()}
    firsts = ", ".join(f"{name} {size[0]:.1f}" for name, size in sizes.items())
    least = np.diff(list(sizes.values()), axis=0).min()
    # Materials at the same φ have the same difference but for rounding.
    own = reading(
        "signed as in Eq 9, from 500 to 1000 N/mm, given at 20 µm",
        f"{firsts} points",
        least > -1e-9,
        f"falls by {-least:.1f} points",
    )
    return found([own], values=with_unit(at_tenth, "percentage points"))
