"""Section 3.3: where yield (Fig 7) and where the mathematics (Figs 8 and 9) end the laws."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import product

import numpy as np

from cylcontact import limits
from cylcontact.arrays import FloatArray
from cylcontact.materials import Material
from cylcontact.pair import CylinderPair
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Alternative, Finding, claim, listed, with_unit
from cylcontact.reports.laws_bounds import departure_number, johnson_end, johnson_shortfall
from cylcontact.yield_search import Criterion

from .. import paper
from ..readings import below, found, reading

DR = paper.FIG2_DR["internal"]  # where a single number is given
CLEARANCES = np.geomspace(*paper.FIG7_CLEARANCES, 401)
SIZES = {f"R_i = {R_i:g} mm": R_i for R_i in paper.RADII}
STEEL = "low-carbon steel"
E_RANGE, NU_RANGE = (69e3, 600e3), (0.24, 0.34)  # MPa and -, Sect. 3.4
AGREEMENT = 10.0  # percent: the paper's bound for models that agree
CRITERIA: tuple[Criterion, ...] = ("von Mises", "Tresca")
Quantity = Callable[[float | FloatArray, Material, float], FloatArray]


def yield_load(dR: float | FloatArray, material: Material, R_i: float) -> FloatArray:
    """Return the load in N/mm at which Hertz's peak pressure is the yield stress."""
    return limits.yield_load(paper.clearance_pair(dR, material, R_i), "Hertz")


def yield_width(dR: float | FloatArray, material: Material, R_i: float) -> FloatArray:
    """Return the width in mm of Hertz's contact at that load."""
    pair = paper.clearance_pair(dR, material, R_i)
    return 2 * limits.hertz_half_width(yield_load(dR, material, R_i), pair)


def limit_stress(dR: float | FloatArray, material: Material, R_i: float) -> FloatArray:
    """Return Hertz's peak pressure in MPa at Johnson's limit."""
    return limits.stress_at_johnson_limit(paper.clearance_pair(dR, material, R_i))


def falls_with_size(bench: Bench, quantity: Quantity) -> bool:
    """Whether a quantity falls from R_i = 100 to 5 mm for every material and clearance."""
    return all(
        bool(np.all(np.diff([quantity(CLEARANCES, m, R_i) for R_i in paper.RADII], axis=0) < 0))
        for m in paper.five_materials(bench).values()
    )


def by_size(bench: Bench, quantity: Quantity) -> dict[str, float]:
    """Return a quantity of the low-carbon steel at 50 µm for the three radii of Fig 7."""
    steel = bench.material(STEEL).material
    return {size: float(quantity(DR, steel, R_i)) for size, R_i in SIZES.items()}


@claim(
    "3.3-yield-by-hertz-pressure",
    "nothing yields below the curves of Fig 7, where Hertz's peak pressure is the yield stress",
    paper="the range of application lies below the curve",
    rule="first yield at no lower load, for every clearance, radius and material of Fig 7",
    figures=("fig07",),
    against="Reproduced: the paper defines its range of application by Hertz's peak pressure, and "
    "wherever Hertz's theory holds that is on the safe side of von Mises and Tresca.",
)
def yield_by_hertz_pressure(bench: Bench) -> Finding:
    """Return the load at first yield over that of Fig 7, and the loads where it is lower."""
    steel, R_i, top = bench.material(STEEL).material, paper.HOLE_RADIUS, paper.LOADS[1]
    cases = list(product(paper.five_materials(bench).values(), paper.RADII))
    curves = np.array([yield_load(CLEARANCES[::20], *case) for case in cases])
    whole, practical, least, values = [], [], dict[str, float](), dict[str, float]()
    for name in CRITERIA:
        pairs = [paper.clearance_pair(CLEARANCES[::20], *case) for case in cases]
        exact = np.array([limits.yield_load(pair, name) for pair in pairs])
        ratio, load = float((exact / curves).min()), float(exact[exact < curves].min())
        choice = f"{name}, our yield stresses"
        whole.append(at_least_1(choice, f"{ratio:.4f} of the curve's load at worst", ratio))
        choice += f", up to {top:g} N/mm"
        practical.append(
            at_least_1(choice, f"{load:.0f} N/mm or more wherever below the curve", load / top)
        )
        least[name] = load
        values |= {f"{name}, lowest ratio, -": ratio, f"{name}, lowest where below, N/mm": load}
    ends = CLEARANCES[[0, -1]]
    exact = limits.yield_load(paper.clearance_pair(ends, steel, R_i))
    small, large = (float(each) for each in exact / yield_load(ends, steel, R_i))
    return found(
        [*whole, *practical],
        f"by von Mises {STEEL} in a {R_i:g} mm hole first yields at {large:.1f} times the curve's "
        f"load at 2 mm, but at {small:.3f} times at 1 µm; yield below a curve needs "
        f"{least['Tresca']:.0f} N/mm or more (Tresca; {least['von Mises']:.0f} by von Mises)",
        values={**values, "steel at 1 um, -": small, "steel at 2 mm, -": large},
    )


def at_least_1(choice: str, ours: str, ratio: float) -> Alternative:
    """Return the reading by which a ratio must not be below 1."""
    return reading(choice, ours, ratio >= 1, f"{1 / ratio:.4g} times too low")


@claim(
    "3.3-yield-load-against-clearance",
    "the load that reaches yield grows as the clearance falls (Fig 7)",
    paper="grows",
    rule="Hertz's load at yield falls steadily with ΔR for every material and radius",
    figures=("fig07",),
)
def yield_load_against_clearance(bench: Bench) -> Finding:
    """Return how much the load at yield grows from the largest to the smallest clearance."""
    materials = list(paper.five_materials(bench).values())
    growth = {
        name: float(np.divide(*yield_load(CLEARANCES[[0, -1]], materials[0], R_i)))
        for name, R_i in SIZES.items()
    }
    return Finding(
        "f_Y = πσ_Y²·R_i·R_j/(E*ΔR): from 2 mm down to 1 µm it grows "
        f"{growth['R_i = 10 mm']:.0f} times at R_i = 10 mm, whatever the material",
        holds=all(
            bool(np.all(np.diff(yield_load(CLEARANCES, m, R_i)) < 0))
            for m in materials
            for R_i in paper.RADII
        ),
        values=with_unit(growth, "-"),
    )


@claim(
    "3.3-yield-load-against-radius",
    "the load that reaches yield depends on the size of the bodies (Fig 7a–c)",
    paper="curves differ between R_i = 100, 10 and 5 mm",
    rule="Hertz's load at yield grows with R_i for every material and clearance",
    figures=("fig07",),
)
def yield_load_against_radius(bench: Bench) -> Finding:
    """Return the load at yield in N/mm for the three radii of Fig 7."""
    loads = by_size(bench, yield_load)
    return Finding(
        f"{STEEL} at {DR * 1e3:g} µm: {listed(loads, '{:.0f} N/mm')}",
        falls_with_size(bench, yield_load),
        values=with_unit(loads, "N/mm"),
    )


@claim(
    "3.3-yield-load-against-contact-area",
    "a smaller area of contact lowers the load that can be carried",
    paper="lowers",
    rule="width and load at yield fall together, be it with the radius, with a larger clearance "
    "or with a stiffer material",
    figures=("fig07",),
)
def yield_load_against_contact_area(bench: Bench) -> Finding:
    """Return the width of contact in mm and the load in N/mm at yield."""
    dR, holds = float(CLEARANCES[-1]), True
    for m in paper.five_materials(bench).values():
        stiffer = [replace(m, E=E) for E in E_RANGE]
        for quantity in (yield_width, yield_load):
            series = (
                [quantity(dR, m, R_i) for R_i in paper.RADII],
                quantity(CLEARANCES, m, paper.HOLE_RADIUS),
                [quantity(dR, each, paper.HOLE_RADIUS) for each in stiffer],
            )
            holds &= all(bool(np.all(np.diff(each) < 0)) for each in series)
    steel = bench.material(STEEL).material
    pairs = [
        (float(yield_width(dR, steel, R)), float(yield_load(dR, steel, R))) for R in paper.RADII
    ]
    return Finding(
        f"f_Y = (π/4)·σ_Y·width; {STEEL} at ΔR = {dR:g} mm carries "
        + ", ".join(f"{load:.0f} N/mm on {width:.2f} mm" for width, load in pairs)
        + f" ({', '.join(SIZES)})",
        holds,
        values={
            f"width at R_i {R:g} mm, mm": width
            for R, (width, _) in zip(paper.RADII, pairs, strict=True)
        },
    )


@claim(
    "3.3-size-matters-most",
    "the size of the bodies changes the load at yield more than E and ν do",
    paper="size has the greater influence",
    rule="the factor over R_i exceeds the factor over the material",
    figures=("fig07",),
    against=(
        "Not reproduced: between the two smaller sizes, 10 and 5 mm, the load changes less than "
        "by E and ν."
    ),
)
def size_matters_most(bench: Bench) -> Finding:
    """Return the ratios of the loads at yield over radii and elastic constants."""
    steel = bench.material(STEEL).material
    largest, *_, smallest = paper.RADII
    at_largest, at_middle, at_smallest = (float(yield_load(DR, steel, R)) for R in paper.RADII)
    size = at_largest / at_smallest
    scaled = float(yield_load(DR * largest / smallest, steel, largest)) / at_smallest
    soft, stiff = (
        Material("", E, nu, yield_stress=1.0) for E, nu in zip(E_RANGE, NU_RANGE, strict=True)
    )
    elastic = float(yield_load(DR, soft, smallest) / yield_load(DR, stiff, smallest))
    return found(
        [
            larger(f"ΔR = {DR * 1e3:g} µm for every radius", size, elastic),
            larger("ΔR in proportion to R_i", scaled, elastic),
        ],
        f"R_i from {smallest:g} to {largest:g} mm changes it {size:.0f} times, E and ν over the "
        f"ranges of Sect. 3.4 {elastic:.1f} times",
        values={
            "by size, -": size,
            "in proportion, -": scaled,
            "by E and nu, -": elastic,
            "by size, 10 to 5 mm, -": at_middle / at_smallest,
        },
    )


def larger(choice: str, factor: float, other: float) -> Alternative:
    """Return the reading by which one factor must exceed another."""
    ours = f"{factor:.0f} against {other:.1f} times"
    miss = f"{other / factor:.2g} times too small"
    return reading(choice, ours, factor > other, miss)


@claim(
    "3.3-elastic-constants-matter",
    "E and ν of the material also narrow the range of application",
    paper="they do",
    rule="both change the load at yield by more than 1 % (ours) over the ranges of Sect. 3.4",
    figures=("fig07",),
)
def elastic_constants_matter() -> Finding:
    """Return the ratio of the loads at yield over E alone and over ν alone."""

    def load(E: float, nu: float) -> float:
        return float(yield_load(DR, Material("", E, nu, yield_stress=1.0), paper.HOLE_RADIUS))

    by_E = load(E_RANGE[0], paper.NU_REFERENCE) / load(E_RANGE[1], paper.NU_REFERENCE)
    by_nu = load(paper.E_REFERENCE, NU_RANGE[1]) / load(paper.E_REFERENCE, NU_RANGE[0])
    return Finding(
        f"at equal yield stress f_Y ∝ (1 − ν²)/E: {by_E:.1f} times lower at 600 than at 69 GPa, "
        f"{100 * (1 - by_nu):.1f} % lower at ν = 0.34 than at 0.24",
        holds=abs(by_E - 1) > 0.01 and abs(by_nu - 1) > 0.01,
        values={"by E, -": by_E, "by nu, -": by_nu},
    )


@claim(
    "3.3-logarithm-at-least-2",
    "Eq 1 keeps its mathematical meaning while its logarithm is 2 or more (Eq 8)",
    paper="ln ≥ 2",
    rule="the penetration peaks at ln = 2, to 1e-4",
    figures=("fig08",),
    paper_values={"logarithm, -": 2.0},
)
def logarithm_at_least_2(bench: Bench) -> Finding:
    """Return the logarithm in Eq 1 at its largest penetration."""
    pair = paper.clearance_pair(DR, bench.material(STEEL).material)
    number = paper.eq1_peak_load(pair) / float(pair.E_star * DR)
    logarithm = float(np.log(4 * np.pi / number))
    return Finding(
        f"Eq 1's penetration peaks at ln = {logarithm:.6f}, under f = {number:.4f}·E*ΔR",
        holds=abs(logarithm - 2) < 1e-4,
        values={"logarithm, -": logarithm, "load over E* dR, -": number},
    )


@claim(
    "3.3-logarithm-physical",
    "Eq 1 also keeps its physical meaning while its logarithm is 2 or more (Eq 8)",
    paper="ln ≥ 2 ensures mathematical and physical meaning",
    rule="Eq 1 behaves as the contact does up to that load",
    figures=("fig08",),
    against="Not reproduced: the introduction itself restricts Johnson's law to large clearances "
    "and small or medium loads, so its physical range must end well before its algebra does.",
)
def logarithm_physical(bench: Bench) -> Finding:
    """Return by how much Eq 1 falls short of conformal contact at Eq 8's load."""
    pair = paper.clearance_pair(DR, bench.material(STEEL).material)
    loads = np.linspace(0.0, float(limits.johnson_limit_load(pair)), 401)[1:]
    falls = int(np.sum(np.diff(paper.eq1_penetration(loads, pair)) < 0))
    shortfall = johnson_shortfall(johnson_end())
    departs = float(np.log(4 * np.pi / departure_number(AGREEMENT)))
    growing = "the penetration does not fall as the load grows"
    steps = f"falls over {falls} of {len(loads) - 1} steps"
    conformal = f"within {AGREEMENT:g} % of elastic conformal contact at ln = 2"
    return found(
        [
            reading(growing, steps, falls == 0, steps),
            below(conformal, -shortfall, AGREEMENT),
        ],
        f"the penetration grows with the load up to ln = 2, but is {shortfall:.0f} % short of "
        f"conformal contact there and {AGREEMENT:g} % short at ln = {departs:.2f} already "
        "(Persson 1964; Ciavarella and Decuzzi 2001)",
        settled="Sect. 3.4 calls it physically inconsistent that the penetration falls as the load "
        "grows",
        values={"shortfall at ln = 2, percent": shortfall, "logarithm at 10 percent, -": departs},
    )


@claim(
    "3.3-limit-independent-of-radii",
    "Johnson's limit load does not depend on the size of the bodies (Fig 8)",
    paper="independent",
    rule="no spread over R_i, bodies of equal material",
    figures=("fig08",),
)
def limit_independent_of_radii(bench: Bench) -> Finding:
    """Return Johnson's limit in N/mm at one clearance, and its spread over three radii."""
    loads = {
        name: [
            float(limits.johnson_limit_load(paper.clearance_pair(DR, m, R))) for R in paper.RADII
        ]
        for name, m in paper.five_materials(bench).items()
    }
    spread = float(np.ptp(list(loads.values()), axis=1).max())
    first = {name: row[0] for name, row in loads.items()}
    E = bench.material(STEEL).material.E
    return Finding(
        f"4πE*ΔR/e² has no radius: {STEEL} ({E / 1e3:g} GPa) at {DR * 1e3:g} µm ends at "
        f"{first[STEEL]:.0f} N/mm in holes of 100, 10 and 5 mm, spread {spread:.1g} N/mm",
        holds=spread == 0,
        values=with_unit(first, "N/mm"),
    )


@claim(
    "3.3-stress-at-limit-against-size",
    "plastic deformation at Johnson's limit is the likelier, the smaller the contact (Fig 9)",
    paper="likelier",
    rule="as R_i and the width of contact fall the stress grows, for every material and clearance",
    figures=("fig09",),
)
def stress_at_limit_against_size(bench: Bench) -> Finding:
    """Return Hertz's stress in MPa at Johnson's limit for the three radii of Fig 9."""

    def width(dR: float | FloatArray, material: Material, R_i: float) -> FloatArray:
        pair = paper.clearance_pair(dR, material, R_i)
        return 2 * limits.hertz_half_width(limits.johnson_limit_load(pair), pair)

    stresses, widths = by_size(bench, limit_stress), by_size(bench, width)
    wide = widths["R_i = 10 mm"] / 20
    return Finding(
        f"σ_H = (2/e)·E*ΔR/√(R_i·R_j): {STEEL} at {DR * 1e3:g} µm {listed(stresses, '{:.0f} MPa')};"
        f" a formal stress, since Hertz's contact is then {wide:.2f} times as wide as the hole",
        falls_with_size(bench, width)
        and falls_with_size(bench, lambda dR, m, R_i: -limit_stress(dR, m, R_i)),
        values=with_unit(stresses, "MPa") | {"width over the hole, -": wide},
    )


@claim(
    "3.3-plastic-before-limit",
    "how likely yield is before Johnson's limit depends on the yield stress (taken as: the lower, "
    "the likelier)",
    paper="increases with the decreasing of … and with yield stress value",
    rule="a lower yield stress widens the range of clearances at which yield comes first, for "
    "every material",
    figures=("fig09",),
    against="Undecided: the repeated 'with' makes the yield stress a cause of its own, and the "
    "sentence of Sect. 3.4 that is called as witness is wrong on the modulus.",
)
def plastic_before_limit(bench: Bench) -> Finding:
    """Return the clearances in µm above which a contact yields before Johnson's law ends."""

    def crossing(material: Material) -> float:
        pair = CylinderPair.from_dR("internal", DR, material)
        return 1e3 * float(limits.elastic_limit_clearance(paper.HOLE_RADIUS, pair))

    materials = paper.five_materials(bench)
    own = {name: crossing(m) for name, m in materials.items()}
    weak = {
        name: crossing(replace(m, yield_stress=paper.strength(m) / 2))
        for name, m in materials.items()
    }
    likelier = all(weak[name] < own[name] for name in materials)
    reverse = all(weak[name] > own[name] for name in materials)
    ours = f"from {own[STEEL]:.1f} to {weak[STEEL]:.1f} µm when the yield stress is halved"
    other_way = f"{abs(own[STEEL] - weak[STEEL]):.1f} µm the other way"
    lower = "'decreasing' goes with area and yield stress"
    higher = "'decreasing' goes with the area only, so that a higher yield stress would widen it"
    return found(
        [
            reading(lower, ours, likelier, other_way),
            reading(higher, ours, reverse, other_way),
        ],
        f"in a 10 mm hole of {STEEL} yield comes before Johnson's limit above {own[STEEL]:.1f} µm, "
        f"with half the yield stress above {weak[STEEL]:.1f} µm already",
        settled="Sect. 3.4 has the largest allowable load grow with the yield strength",
        values=with_unit(own, "um") | {f"{STEEL}, half the yield stress, um": weak[STEEL]},
    )
