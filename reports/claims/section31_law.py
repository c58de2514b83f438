"""Section 3.1: the form of the enhanced law, the ranges it is fitted over, and where it holds."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq, linprog

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.fitting.power_fit import fit_power
from cylcontact.laws import PUBLISHED, Enhanced, InternalCoefficients, Johnson, LankaraniNikravesh
from cylcontact.laws.power import PowerLaw
from cylcontact.limits import johnson_limit_load
from cylcontact.materials import Material
from cylcontact.pair import Contact, CylinderPair
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Alternative, Finding, agrees_as_printed, claim

from .. import paper
from ..paper import WINDOW
from ..power_fits import johnson_points, r_squared, reference_pair
from ..recovery import IF_MISPRINT
from .section1 import CORRELATED
from .section31 import E_TO_1000, above, judged, r_squared_of_law

# Not in the paper: the stiffest unfilled plastics, the stiffest with short glass fibres, and
# diamond, the stiffest common solid.
E_PLASTIC, E_GLASS_FIBRE, E_DIAMOND = 4.0, 20.0, 1150.0  # GPa
STEP = 1.001  # of central differences
INTERNAL_DR = paper.TRAINING_DR["internal"]
NEARLY_10_MM = 9.9999  # mm; Eq 6d excludes 10 mm itself
LARGEST_DR: dict[Contact, float] = {"internal": NEARLY_10_MM, "external": 500.0}


def force_exponent(pair: CylinderPair, less: CylinderPair, more: CylinderPair) -> float:
    """Return d ln f/d ln x of Johnson's law at a pair's δ, where x is a step less and more."""
    law = Johnson()
    delta = law.penetration(100.0, pair)
    return float(np.log(law.load(delta, more) / law.load(delta, less)) / (2 * np.log(STEP)))


def bearing_factors(*bearings: tuple[float, float]) -> FloatArray:
    """Return Eq 2's K for bearings of given ΔR in mm and E in MPa, with the paper's radius."""
    return np.array(
        [
            float(
                LankaraniNikravesh().factor(
                    CylinderPair.from_dR(
                        "internal",
                        dR,
                        Material("any", E, paper.NU_REFERENCE),
                        paper.BEARING_LENGTH,
                        R_i=paper.BEARING_RADIUS,
                    )
                )
            )
            for dR, E in bearings
        ]
    )


def proportional(name: str, exponents: dict[str, float], choice: str = "") -> Finding:
    """Judge the exponents of E* or 1/ΔR in the force of Eqs 1 and 2: above 0, and above 1/2."""
    least = min(exponents.values())
    *first, last = (f"{value:.2f} ({where})" for where, value in exponents.items())
    return Finding(
        f"at fixed penetration the force goes as {name} to the power of {', '.join(first)} and "
        f"{last}; proportional would be 1",
        holds=least > 0,
        choice=choice,
        miss="" if least > 0 else f"exponent {least:+.2f}",
        alternatives=[
            judged(
                "some level means nearer to proportional than to independent",
                f"{least:.2f} at the least",
                "" if least > 0.5 else f"{0.5 - least:.2f} below 0.5",
            )
        ],
        values={f"exponent, {where}, -": value for where, value in exponents.items()},
    )


@claim(
    "3.1-force-proportional-to-E",
    "Eqs 1 and 2 suggest that the force is proportional to E*",
    paper="some level of proportionality",
    rule="the force at a given penetration grows with E* (some level, ours)",
)
def force_proportional_to_modulus() -> Finding:
    """Return the exponent of E* in the force at fixed penetration, of Eqs 1 and 2."""
    E = paper.E_REFERENCE
    exponents = {
        f"Eq 1 at {dR:g} mm": force_exponent(
            *(reference_pair("internal", dR, E * step) for step in (1, 1 / STEP, STEP))
        )
        for dR in INTERNAL_DR
    }
    low, high = bearing_factors((0.1, E), (0.1, 2 * E))
    return proportional("E*", exponents | {"Eq 2": float(np.log2(high / low))})


@claim(
    "3.1-force-proportional-to-inverse-dR",
    "Eqs 1 and 2 suggest some proportionality of the force to 1/ΔR",
    paper="some level of proportionality",
    rule="the force at a given penetration grows with 1/ΔR (some level, ours)",
    against=(
        "Not reproduced: in Eq 1 the force goes with a small power of 1/ΔR, which is nearly no "
        "dependence; in Eq 5 the factor aΔR + b takes most of the 1/ΔR back."
    ),
)
def force_proportional_to_inverse_clearance() -> Finding:
    """Return the exponent of 1/ΔR in the force at fixed penetration, of Eqs 1 and 2."""
    exponents = {
        f"Eq 1 at {dR:g} mm": -force_exponent(
            *(reference_pair("internal", dR * step) for step in (1, 1 / STEP, STEP))
        )
        for dR in INTERNAL_DR
    }
    E = paper.E_REFERENCE
    low, high = bearing_factors((0.1, E), (0.05, E))
    return proportional(
        "1/ΔR",
        exponents | {"Eq 2": float(np.log2(high / low))},
        "207 GPa, at the penetration that belongs to 100 N/mm; for Eq 2 R_i = 10 mm",
    )


@claim(
    "3.1-K-star-linear-{contact}",
    "K* may be taken as linear in ΔR ({contact} contact)",
    paper="assumed",
    rule="a straight line explains 99 % of the variance of the fitted K* (99 % is ours)",
    figures=("fig_forms",),
    against="{against}",
    cases=[
        {
            "contact": "internal",
            "against": "Not reproduced: the variance is that of the largest K*; at small "
            "clearances the same line is off by most of K*, and no line serves them all.",
        },
        {
            "contact": "external",
            "against": (
                "Undecided: with n fitted at each clearance too, no straight line stays within "
                "10 %."
            ),
        },
    ],
)
def k_star_linear(contact: Contact) -> Finding:
    """Return how well a straight line follows K* = K·ΔR/E* of the fits at single clearances."""
    dR = np.clip(np.geomspace(*paper.TRAINING_DR[contact], 61), None, LARGEST_DR[contact])
    external = contact == "external"
    free, held = k_stars(contact, dR, hold_n=False), k_stars(contact, dR, hold_n=True)
    k_star = held if external else free
    a, b, explained, worst = straight_line(dR, k_star)
    least = least_worst_percent(dR, k_star)
    off = worst_percent(PUBLISHED[contact].a * dR + PUBLISHED[contact].b, held)
    fixed, fixed_least = straight_line(dR, held)[2], least_worst_percent(dR, held)

    third = judged(
        "n of Eq 6 held at each clearance",
        f"R² = {fixed:.3f}, no line stays closer than {fixed_least:.0f} %, the published one is "
        f"off by up to {off:.0f} %",
        below_99(fixed),
    )
    if external:
        third = judged(
            "the published line, within 10 % of K* everywhere",
            f"off by up to {off:.1f} %",
            above_10(off),
        )
    return Finding(
        f"R² = {explained:.4f} about {a:.3f}ΔR {b:+.3f}; the closest line is within {least:.1f} % "
        "of K* everywhere",
        holds=explained > 0.99,
        choice=f"a fit at each of 61 clearances, {'n = 1.094 held, ' if external else ''}207 GPa, "
        "10 to 1000 N/mm, all logarithmic",
        missing=WINDOW,
        miss=below_99(explained),
        alternatives=[
            judged(
                "the closest straight line, within 10 % of K*", f"{least:.1f} %", above_10(least)
            ),
            third,
        ],
        values={
            "a, 1/mm": a,
            "b, -": b,
            "R squared, -": explained,
            "worst, percent": worst,
            "least worst, percent": least,
            "least worst with n fitted, percent": least_worst_percent(dR, free),
            "R squared with n held, -": fixed,
            "least worst with n held, percent": fixed_least,
            "worst of the published line with n held, percent": off,
        },
    )


def below_99(explained: float) -> str:
    """Return by how much R² misses 0.99, nothing if it does not."""
    return "" if explained > 0.99 else f"R² {0.99 - explained:.3f} below 0.99"


def above_10(percent: float) -> str:
    """Return by how much a misfit exceeds 10 %, nothing if it does not."""
    return "" if percent < 10 else f"{percent - 10:.1f} points above 10 %"


def k_stars(contact: Contact, dR: FloatArray, *, hold_n: bool) -> FloatArray:
    """Return K* at each ΔR in mm, from fits of K and n, or of K with the n of Eq 6c."""
    K = []
    for x in dR:
        pair = reference_pair(contact, float(x))
        load, delta = johnson_points(paper.TRAINING_LOADS, pair)
        n = float(Enhanced().exponent(pair)) if hold_n else fit_power(load, delta).n
        K.append(np.exp(np.mean(np.log(load) - n * np.log(delta))))
    return as_floats(np.array(K) * dR / reference_pair(contact, 1.0).E_star)


def straight_line(dR: FloatArray, k_star: FloatArray) -> tuple[float, float, float, float]:
    """Return slope and offset of the least-squares line, its R² and its worst misfit in percent."""
    a, b = np.polyfit(dR, k_star, 1)
    line = a * dR + b
    return float(a), float(b), r_squared(k_star, line), worst_percent(line, k_star)


def worst_percent(line: FloatArray, k_star: FloatArray) -> float:
    """Return the largest misfit of a line in percent of K*."""
    return float(100 * np.max(np.abs(line / k_star - 1)))


def least_worst_percent(dR: FloatArray, k_star: FloatArray) -> float:
    """Return the worst misfit, in percent of K*, of the straight line for which it is least.

    Minimises t over a, b, t subject to |aΔR + b − K*| ≤ t·K*, a linear programme.
    """
    one = np.ones_like(dR)
    scaled = np.column_stack([dR / k_star, one / k_star])
    bound = np.vstack([np.column_stack([scaled, -one]), np.column_stack([-scaled, -one])])
    best = linprog(
        [0, 0, 1], A_ub=bound, b_ub=np.concatenate([one, -one]), bounds=[(None, None)] * 3
    )
    return float(100 * np.asarray(best.x)[2])


def y_branches(dR: float) -> tuple[float, float]:
    """Return the logarithmic and the linear branch of Y as published (Eq 6d)."""
    c = InternalCoefficients()
    return (
        float(c.Y_log_scale * np.log(1000 * dR) ** c.Y_log_exponent),
        float(c.Y_slope * dR + c.Y_offset),
    )


def y_crossing() -> float:
    """Return the ΔR in mm at which the published branches of Y meet."""
    return float(brentq(lambda dR: np.subtract(*y_branches(dR)), 0.05, 2.0, xtol=1e-15))


@claim(
    "3.1-Y-switch",
    "Y passes from its logarithmic to its linear branch at this clearance (Eq 6d)",
    paper=f"{paper.Y_SWITCH} mm",
    rule="equal to the printed digit",
    figures=("fig03",),
    paper_values={"dR, mm": float(paper.Y_SWITCH)},
)
def y_switch() -> Finding:
    """Return the clearance in mm at which the two branches of Y cross."""
    crossing = y_crossing()
    return Finding(
        f"the branches cross at {crossing:.7f} mm",
        holds=agrees_as_printed(crossing, paper.Y_SWITCH),
        values={"dR, mm": crossing},
    )


@claim(
    "3.1-Y-continuous",
    "the two branches of Y meet where it passes from one to the other (Eq 6d)",
    paper=f"one value at {paper.Y_SWITCH} mm",
    rule="a jump of Y no larger than the rounding of the printed clearance explains",
    figures=("fig03",),
)
def y_continuous() -> Finding:
    """Return the jump of Y, and of the penetration, at the printed switch point."""
    dR, c = float(paper.Y_SWITCH), InternalCoefficients()
    pair = reference_pair("internal", dR)
    branches = y_branches(dR)
    jump = abs(branches[0] - branches[1])
    K = (c.a * dR + c.b) * float(pair.E_star) / dR
    logarithmic, linear = (
        float(PowerLaw(n=Y * dR**c.n_exponent, K=K).penetration(100.0, pair)) for Y in branches
    )
    slopes = np.subtract(y_branches(dR + 1e-6), y_branches(dR - 1e-6)) / 2e-6
    off = 100 * abs(logarithmic / linear - 1)
    return Finding(
        f"they differ by {jump:.0e}, or {off:.0e} % of the penetration under 100 N/mm; dY/dΔR "
        f"jumps from {slopes[0]:.3f} to {slopes[1]:.3f} per mm, a kink in the law",
        holds=bool(jump < 5e-6 * abs(slopes[0] - slopes[1])),
        values={"jump of Y, -": jump, "slope before, 1/mm": slopes[0]},
    )


# --- the ranges of the fit ----------------------------------------------------------------------


@claim(
    "3.1-moduli-covered",
    "the range of E in the fit spans most engineering materials, from plastics to ceramics",
    paper=f"{paper.TRAINING_E[0] / 1e3:g} to {paper.TRAINING_E[1] / 1e3:g} GPa",
    rule="plastics and the five materials of the paper lie inside the range",
    against="Reproduced: most is not all; the five materials that the paper goes on with are "
    "inside, and it leaves plastics out of Sects. 3.3 and 3.4 itself.",
    paper_values={"low, GPa": paper.TRAINING_E[0] / 1e3, "high, GPa": paper.TRAINING_E[1] / 1e3},
)
def moduli_covered(bench: Bench) -> Finding:
    """Return the moduli of the five materials and of plastics in GPa."""
    low, high = (E / 1e3 for E in paper.TRAINING_E)
    moduli = [float(m.E) / 1e3 for m in paper.five_materials(bench).values()]

    def outside(*moduli: float) -> str:
        off = max(low / min(moduli), max(moduli) / high)
        return "" if off <= 1 else f"{off:.2f} times outside"

    readings = {
        f"unfilled plastics, at most {E_PLASTIC:g} GPa (assumed)": (E_PLASTIC, *moduli),
        f"plastics with short glass fibres, up to {E_GLASS_FIBRE:g} GPa (assumed)": (
            E_GLASS_FIBRE,
            *moduli,
        ),
        "most materials: the five of the paper": tuple(moduli),
    }
    (choice, own), *others = readings.items()
    return Finding(
        f"the five materials, {min(moduli):g} to {max(moduli):g} GPa, are inside; plastics of up "
        f"to {E_PLASTIC:g} GPa are not; the upper end is {high / E_DIAMOND:.0f} times that of "
        "diamond",
        holds=not outside(*own),
        choice=choice,
        miss=outside(*own),
        alternatives=[
            judged(name, f"{min(E):g} to {max(E):g} GPa", outside(*E)) for name, E in others
        ],
        values={"plastics, GPa": E_PLASTIC, "least, GPa": min(moduli)},
    )


@claim(
    "3.1-clearances-covered",
    "the range of internal clearances in the fit spans those of typical machines",
    paper=f"{INTERNAL_DR[0]:g} to {INTERNAL_DR[1]:g} mm",
    rule="it starts at or below the smallest typical clearance",
    against="Reproduced: the ranges are said to lead from typical clearances to other kinds of "
    "contact, and 50 µm is a typical clearance.",
    paper_values={"low, mm": INTERNAL_DR[0]},
)
def clearances_covered() -> Finding:
    """Return the smallest clearances in mm that the paper names elsewhere."""
    low = INTERNAL_DR[0]
    typical, most = paper.FIG7_CLEARANCES
    compared, joint = paper.COMPARED_CLEARANCES[0], min(paper.JOINT_CLEARANCES)

    def miss(smallest: float) -> str:
        return "" if low <= smallest else f"{low / smallest:.1f} times too high"

    return Finding(
        f"it starts at {low * 1e3:g} µm; typical clearances start at {typical * 1e3:g} µm "
        f"(Sect. 3.3), those compared at {compared * 1e3:g} µm (Sect. 3.4)",
        holds=not miss(typical),
        choice="typical clearances are those of Sect. 3.3",
        miss=miss(typical),
        alternatives=[
            judged(
                "typical clearances are those compared in Sect. 3.4",
                f"from {compared * 1e3:g} µm",
                miss(compared),
            ),
            judged("the joint of Sect. 4 is typical", f"{joint * 1e3:g} µm", miss(joint)),
            Alternative(
                "it is enough that the range starts among typical clearances",
                f"{low * 1e3:g} µm is among {typical * 1e3:g} to {most * 1e3:g} µm",
                typical <= low <= most,
            ),
        ],
        values={"smallest typical, mm": typical, "smallest compared, mm": compared},
    )


@claim(
    "3.1-johnson-over-the-box",
    "the penetrations to fit are calculated with Johnson's law over these ranges",
    paper="10 to 1000 N/mm, 20.7 to 10000 GPa, ν = 0.1 to 0.5, 0.05 to 10 mm",
    rule="Johnson's law has a penetration for all but 1 % of the combinations (1 % is ours)",
    figures=("fig08",),
    against=(
        "Undecided: the ranges are given up to 1000 N/mm, and in their softest corner Eq 8 ends "
        "the law before."
    ),
)
def johnson_over_the_box() -> Finding:
    """Return Johnson's limit in N/mm in the softest corner of the internal training box."""
    (dR, _), (E, _), load = INTERNAL_DR, paper.TRAINING_E, paper.LOADS[1]
    pair = CylinderPair.from_dR("internal", dR, Material("softest", E, 0.1))
    limit = float(johnson_limit_load(pair))
    # Eq 1 has a penetration up to where its logarithm is 1.
    end = 4 * np.pi * float(pair.E_star) * dR / math.e
    beyond = beyond_eq8_percent()
    return Finding(
        f"one in {1e-6 * 100 / beyond:.1f} million of the combinations lies beyond Eq 8's limit: "
        f"at {dR * 1e3:g} µm, {E / 1e3:g} GPa and ν = 0.1 Johnson's law ends at {limit:.0f} N/mm",
        holds=beyond < 1,
        choice="a wide number of combinations; shares on logarithmic axes",
        miss="" if beyond < 1 else f"{beyond - 1:.1f} points above 1 %",
        settled="the paper speaks of a wide number of combinations, not of every one",
        alternatives=[
            judged(
                "every combination: Eq 8 reaches the highest load in every corner",
                f"it ends at {limit:.0f} N/mm in one",
                "" if limit >= load else f"{load - limit:.0f} N/mm short of {load:g} N/mm",
            ),
            judged(
                "Eq 1 taken literally, on its falling branch too",
                f"it gives a penetration up to {end:.0f} N/mm",
                "" if end >= load else f"{load - end:.0f} N/mm short",
            ),
        ],
        values={"limit, N/mm": limit, "end of Eq 1, N/mm": end, "beyond Eq 8, percent": beyond},
    )


def beyond_eq8_percent() -> float:
    """Return the part of the internal training ranges beyond Eq 8, on logarithmic axes, ν linear.

    Eq 8 in logarithms: ln ΔR + ln E is below ln f + ln(e²·2(1 − ν²)/4π). At one load and ν this
    cuts a triangle off the corner of the rectangle of ΔR and E.
    """
    nu, load = np.meshgrid(np.linspace(0.1, 0.5, 401), np.geomspace(*paper.LOADS, 4001))
    product = load * math.e**2 * 2 * (1 - nu**2) / (4 * np.pi)
    sides = np.log(INTERNAL_DR[1] / INTERNAL_DR[0]), np.log(np.divide(*paper.TRAINING_E[::-1]))
    leg = np.clip(np.log(product / (INTERNAL_DR[0] * paper.TRAINING_E[0])), 0, None)
    return float(100 * np.mean(leg**2 / 2) / np.prod(sides))


# --- where the published law holds --------------------------------------------------------------


def largest_difference(low: float, high: float, loads: FloatArray = paper.TRAINING_LOADS) -> float:
    """Return the largest |Eq 9| in percent from ΔR low to high in mm, 207 GPa, loads in N/mm."""
    found = []
    for dR in np.geomspace(low, high, 61):
        pair = reference_pair("internal", float(dR))
        load, delta = johnson_points(loads, pair)
        found.append(np.max(np.abs(Enhanced().penetration(load, pair) / delta - 1)))
    return float(100 * max(found))


Y_LOW = 0.005  # mm
Y_SWITCH = paper.Y_SWITCH
FIG6_LOADS = (20.0, 40.0, 100.0)  # N/mm, of Sect. 3.2


@claim(
    "3.1-good-over-all-clearances",
    "with Y of two branches the law correlates well with Johnson's over all clearances",
    paper="good correlation for the complete range",
    rule=f"R² above {CORRELATED:g} (ours)",
    figures=("fig_forms",),
    against=(
        "Reproduced: the paper's search takes all deformation–force pairs at once, and for them "
        "R² is above our bar however they are spaced."
    ),
)
def good_over_all_clearances() -> Finding:
    """Return R² of ln f at the worst clearance, and of ln δ over all samples."""
    dR = np.geomspace(INTERNAL_DR[0], NEARLY_10_MM, 61)
    r2 = np.array([r_squared_of_law(paper.TRAINING_LOADS, "internal", float(x)) for x in dR])
    worst, good = float(r2.min()), float(dR[r2 > CORRELATED].max())
    largest = largest_difference(INTERNAL_DR[0], NEARLY_10_MM)

    def miss(value: float) -> str:
        return above(value, CORRELATED)

    pooled = {
        "all pairs at once, all axes logarithmic": pooled_r_squared("log"),
        f"the same, E over {IF_MISPRINT}": pooled_r_squared("log", E_TO_1000[1]),
        "all pairs at once, all axes evenly spaced": pooled_r_squared("linear"),
    }
    best = max(pooled.values())
    return Finding(
        f"R² falls to {worst:.2f} at 10 mm, and is above {CORRELATED:g} up to {good:.1f} mm; the "
        f"penetration is off by up to {largest:.0f} %",
        holds=not miss(worst),
        choice="R² of ln f at each clearance, 207 GPa, loads spaced logarithmically",
        miss=miss(worst),
        alternatives=[
            *(
                judged(
                    name,
                    f"R² of ln δ is {value:.4f}",
                    miss(value),
                    "" if IF_MISPRINT in name else WINDOW,
                )
                for name, value in pooled.items()
            ),
            judged(
                f"the best of these, by the bar of Fig 2, R² > {paper.GOOD_CORRELATION}",
                f"R² of ln δ is {best:.4f}",
                above(best),
            ),
        ],
        values={
            "least R squared, -": worst,
            "good up to, mm": good,
            "largest difference, percent": largest,
            **{f"R squared, {name}, -": value for name, value in pooled.items()},
        },
    )


def pooled_r_squared(spacing: str, top: float = paper.TRAINING_E[1], points: int = 20) -> float:
    """Return R² of ln δ of the published internal law over all pairs, E up to `top` in MPa."""
    space = np.geomspace if spacing == "log" else np.linspace
    johnson, enhanced = [], []
    for E in space(paper.TRAINING_E[0], top, points):
        for dR in space(INTERNAL_DR[0], NEARLY_10_MM, points):
            pair = reference_pair("internal", float(dR), float(E))
            load, delta = johnson_points(space(*paper.LOADS, points), pair)
            johnson.append(np.log(delta))
            enhanced.append(np.log(Enhanced().penetration(load, pair)))
    return r_squared(np.concatenate(johnson), np.concatenate(enhanced))


@claim(
    "3.1-Y-below-the-fit",
    "the first branch of Y serves from 5 µm on (Eq 6d), though the fit starts at 50 µm",
    paper=f"[{Y_LOW:g}, {paper.Y_SWITCH}] mm",
    rule="the largest difference is not greater below 50 µm than above it",
    figures=("fig11",),
    against=(
        "Reproduced: a little above 5 µm and at 20 to 100 N/mm the law is nearly within 10 %, "
        "well below the 50 µm at which the fit starts."
    ),
)
def y_below_the_fit() -> Finding:
    """Return the largest differences in percent and the least R² below the start of the fit."""
    start = INTERNAL_DR[0]
    below, branch = largest_difference(Y_LOW, start), largest_difference(start, float(Y_SWITCH))
    moderate = largest_difference(Y_LOW, start, np.array(FIG6_LOADS))
    r2 = r_squared_of_law(paper.TRAINING_LOADS, "internal", Y_LOW)

    def miss(percent: float, bound: float) -> str:
        return "" if percent <= bound else f"{percent - bound:.1f} points above {bound:.0f} %"

    return Finding(
        f"the enhanced law's penetration differs from Johnson's by up to {below:.0f} % for ΔR from "
        f"{1e3 * Y_LOW:g} to {1e3 * start:g} µm, by up to {branch:.0f} % from {1e3 * start:g} µm "
        f"to {Y_SWITCH} mm",
        holds=not miss(below, branch),
        choice="against its own branch; 207 GPa, from 10 N/mm to the lower of 1000 N/mm and Eq 8",
        miss=miss(below, branch),
        alternatives=[
            judged(
                "Sect. 3.2's bound, below 10 % from 5 µm on, at 20, 40 and 100 N/mm",
                f"up to {moderate:.1f} %",
                miss(moderate, 10),
            ),
            judged(
                f"R² above {paper.GOOD_CORRELATION} as in Fig 2, 10 to 1000 N/mm",
                f"{r2:.3f} at {1e3 * Y_LOW:g} µm",
                above(r2),
            ),
        ],
        values={
            "below 50 um, percent": below,
            "50 um to the switch, percent": branch,
            "below 50 um at 20 to 100 N/mm, percent": moderate,
            "R squared at 5 um, -": r2,
        },
    )
