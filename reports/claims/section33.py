"""Section 3.3: where yield (Fig 7) and where the mathematics (Figs 8 and 9) end the laws."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import product

import numpy as np

from cylcontact import limits
from cylcontact.bodies.material import Material
from cylcontact.limits.yield_search import Criterion
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, Reading, claim
from cylcontact.reports.laws_bounds import departure_number, johnson_end, johnson_shortfall
from cylcontact.support.arrays import FloatArray

from .. import paper
from ..readings import below, found, reading

DR = paper.FIG2_DR["internal"]  # where a single number is given
CLEARANCES = np.geomspace(*paper.FIG7_CLEARANCES, 401)
STEEL = "low-carbon steel"
AGREEMENT = 10.0  # percent: the paper's bound for models that agree
CRITERIA: tuple[Criterion, ...] = ("von Mises", "Tresca")
Quantity = Callable[[float | FloatArray, Material, float], FloatArray]


def yield_load(dR: float | FloatArray, material: Material, R_i: float) -> FloatArray:
    """Return the load in N/mm at which Hertz's peak pressure is the yield stress."""
    return limits.yield_load(paper.clearance_pair(dR, material, R_i), "Hertz")


@claim(
    "3.3-yield-by-hertz-pressure",
    "nothing yields below the curves of Fig 7, where Hertz's peak pressure is the yield stress",
    paper="the range of application lies below the curve",
    rule="first yield at no lower load, for every clearance, radius and material of Fig 7",
    figures=("fig07",),
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
            replace(
                at_least_1(choice, f"{load:.0f} N/mm or more wherever below the curve", load / top),
                ground=f"the loads of the study end at {top:g} N/mm" if name == CRITERIA[0] else "",
            )
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


def at_least_1(choice: str, ours: str, ratio: float) -> Reading:
    """Return the reading by which a ratio must not be below 1."""
    return reading(choice, ours, ratio >= 1, f"{1 / ratio:.4g} times too low")


@claim(
    "3.3-logarithm-physical",
    "Eq 1 also keeps its physical meaning while its logarithm is 2 or more (Eq 8)",
    paper="ln ≥ 2 ensures mathematical and physical meaning",
    rule="Eq 1 behaves as the contact does up to that load",
    figures=("fig08",),
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
            replace(
                below(conformal, -shortfall, AGREEMENT),
                ground="Sect. 1 has it from Liu and co-workers that the law is effective only at "
                "large clearances and small or medium loads",
            ),
        ],
        f"the penetration grows with the load up to ln = 2, but is {shortfall:.0f} % short of "
        f"conformal contact there and {AGREEMENT:g} % short at ln = {departs:.2f} already "
        "(Persson 1964; Ciavarella and Decuzzi 2001)",
        ground="Sect. 3.4 calls it physically inconsistent that the penetration falls as the load "
        "grows",
        values={"shortfall at ln = 2, percent": shortfall, "logarithm at 10 percent, -": departs},
    )
