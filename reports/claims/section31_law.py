"""Section 3.1: the form of the enhanced law, the ranges it is fitted over, and the fit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq, linprog

from cylcontact.arrays import FloatArray
from cylcontact.fitting.assessment import basins
from cylcontact.laws import PUBLISHED, InternalCoefficients, Johnson, LankaraniNikravesh
from cylcontact.laws.power import PowerLaw
from cylcontact.pair import Contact, CylinderPair
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, agrees_as_printed, claim

from .. import paper
from ..power_fits import fit_at, reference_pair

# Not in the paper: the stiffest unfilled plastics, and diamond, the stiffest common solid.
E_PLASTIC, E_DIAMOND = 4.0, 1150.0  # GPa
STEP = 1.001  # of central differences


def force_exponent(pair: CylinderPair, less: CylinderPair, more: CylinderPair) -> float:
    """Return d ln f/d ln x of Johnson's law at a pair's δ, where x is a step less and more."""
    law = Johnson()
    delta = law.penetration(100.0, pair)
    return float(np.log(law.load(delta, more) / law.load(delta, less)) / (2 * np.log(STEP)))


@claim(
    "3.1-force-proportional-to-E",
    "the models suggest a force proportional to E*",
    paper="some proportionality",
    rule="exponent within 0.1 of 1",
)
def force_proportional_to_modulus() -> Finding:
    """Return the exponent of E* in the force at fixed penetration."""
    exponents = {
        f"ΔR = {dR:g} mm": force_exponent(
            reference_pair("internal", dR),
            reference_pair("internal", dR, paper.E_REFERENCE / STEP),
            reference_pair("internal", dR, paper.E_REFERENCE * STEP),
        )
        for dR in paper.TRAINING_DR["internal"]
    }
    return Finding(
        "exponent of E* in Johnson's force at fixed penetration: "
        + ", ".join(f"{value:.4f} at {name}" for name, value in exponents.items()),
        holds=all(abs(value - 1) < 0.1 for value in exponents.values()),
        values={f"exponent at {name}, -": value for name, value in exponents.items()},
    )


@claim(
    "3.1-force-proportional-to-inverse-dR",
    "the models suggest a force proportional to 1/ΔR",
    paper="some proportionality",
    rule="exponent nearer to −1 than to 0",
)
def force_proportional_to_inverse_clearance() -> Finding:
    """Return the exponent of ΔR in the force at fixed penetration."""
    exponents = {
        f"{at:g} mm": force_exponent(
            *(reference_pair("internal", x) for x in (at, at / STEP, at * STEP))
        )
        for at in paper.TRAINING_DR["internal"]
    }
    dR = np.array([0.05, 0.1])
    bearing = CylinderPair.from_dR(
        "internal", dR, paper.STEEL, paper.BEARING_LENGTH, R_i=paper.BEARING_RADIUS
    )
    small, large = LankaraniNikravesh().factor(bearing)
    return Finding(
        "exponent of ΔR in Johnson's force at fixed penetration (that of 100 N/mm, 207 GPa): "
        + ", ".join(f"{value:.2f} at ΔR = {name}" for name, value in exponents.items()),
        holds=all(value < -0.5 for value in exponents.values()),
        choice="the force falls with ΔR far more slowly than 1/ΔR; in Eq 5 the factor aΔR + b "
        "makes up for most of the 1/ΔR",
        alternatives=f"Lankarani–Nikravesh at R_i = 10 mm: {np.log2(large / small):.2f}, from the "
        "square root in Eq 2",
        values={f"exponent at {name}, -": value for name, value in exponents.items()},
    )


@claim(
    "3.1-K-star-linear-{contact}",
    "{contact}: K* of K = K*·E*/ΔR is linear in ΔR",
    paper="assumed linear",
    rule="some straight line is within 8 % of K* over the training range",
    cases=[{"contact": contact} for contact in paper.TRAINING_DR],
)
def k_star_linear(contact: Contact) -> Finding:
    """Return how well a straight line follows K* = K·ΔR/E* of the fits at single clearances."""
    dR = np.geomspace(*paper.TRAINING_DR[contact], 61)
    K = np.array([fit_at(contact, x, paper.E_REFERENCE, paper.TRAINING_LOADS).K for x in dR])
    k_star = K * dR / reference_pair(contact, 1.0).E_star
    a, b = np.polyfit(dR, k_star, 1)
    residual = k_star - (a * dR + b)
    r_squared = float(1 - residual @ residual / np.sum((k_star - k_star.mean()) ** 2))
    worst = float(100 * np.max(np.abs(residual / k_star)))
    least = least_worst_percent(dR, k_star)
    power, logarithm = np.polyfit(np.log(dR), np.log(k_star), 1)
    power_off = 100 * np.max(np.abs(np.exp(logarithm) * dR**power / k_star - 1))
    published = PUBLISHED[contact]
    return Finding(
        f"least squares: K* = {a:.3f}ΔR {b:+.3f} (Eq 6: {published.a:g}ΔR {published.b:+g}), "
        f"R² = {r_squared:.4f}, but off by up to {worst:.0f} % of K*",
        holds=least < 8,
        choice="K* from a fit at each of 61 clearances, 207 GPa, ν = 0.3, loads 10–1000 N/mm "
        "(both logarithmic); R² is set by the largest K* and hides the small clearances. "
        "The 8 % are Sect. 3.4's bound on the difference; it takes nearly all of an error in K*",
        alternatives=f"no straight line stays closer than {least:.1f} % of K*; a power of ΔR with "
        f"exponent {power:.2f} stays within {power_off:.0f} %",
        values={
            "a, 1/mm": a,
            "b, -": b,
            "R squared, -": r_squared,
            "worst, percent": worst,
            "least worst, percent": least,
        },
    )


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


@claim(
    "3.1-Y-switch",
    "Y passes from its logarithmic to its linear branch at this clearance (Eq 6d)",
    paper=f"{paper.Y_SWITCH} mm",
    rule="agreement to the printed digit",
    paper_values={"dR, mm": float(paper.Y_SWITCH)},
)
def y_switch() -> Finding:
    """Return the clearance in mm at which the two branches of Y cross."""
    crossing = float(brentq(lambda dR: np.subtract(*y_branches(dR)), 0.05, 2.0, xtol=1e-15))
    return Finding(
        f"the branches cross at {crossing:.7f} mm",
        holds=agrees_as_printed(crossing, paper.Y_SWITCH),
        values={"dR, mm": crossing},
    )


@claim(
    "3.1-Y-continuous",
    "Y is one function of two branches that meet (Eq 6d)",
    paper="one value at the switch point, given to five digits",
    rule="a jump of Y no larger than the rounding of the switch point (5e-6 mm) explains",
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
    return Finding(
        f"the branches differ by {jump:.1e} there, which moves the penetration by "
        f"{100 * abs(logarithmic / linear - 1):.1e} % (100 N/mm, 207 GPa); the slope dY/dΔR "
        f"jumps from {slopes[0]:.3f} to {slopes[1]:.4f} per mm, a kink in the law",
        holds=bool(jump < 5e-6 * abs(slopes[0] - slopes[1])),
        values={"jump of Y, -": jump, "slope before, 1/mm": slopes[0]},
    )


@claim(
    "3.1-moduli-covered",
    "the training range of E covers engineering materials from plastics to ceramics",
    paper=f"{paper.TRAINING_E[0] / 1e3:g} to {paper.TRAINING_E[1] / 1e3:g} GPa",
    rule="plastics, the five materials and ceramics all lie inside the range",
    paper_values={"low, GPa": paper.TRAINING_E[0] / 1e3, "high, GPa": paper.TRAINING_E[1] / 1e3},
)
def moduli_covered(bench: Bench) -> Finding:
    """Return the moduli of the five materials and of plastics in GPa."""
    low, high = (E / 1e3 for E in paper.TRAINING_E)
    moduli = [float(m.E) / 1e3 for m in paper.five_materials(bench).values()]
    return Finding(
        f"the five materials ({min(moduli):g}–{max(moduli):g} GPa) lie inside; plastics (up to "
        f"{E_PLASTIC:g} GPa) lie below; {high:g} GPa is {high / E_DIAMOND:.0f} times diamond",
        holds=low <= E_PLASTIC and low <= min(moduli) and max(moduli) <= high,
        choice=f"assumed: unfilled plastics at most {E_PLASTIC:g} GPa, diamond {E_DIAMOND:g} GPa. "
        "The upper end is probably 1000 GPa misprinted; plastics are outside either way",
        values={"plastics, GPa": E_PLASTIC, "least, GPa": min(moduli)},
    )


@claim(
    "3.1-clearances-covered",
    "the internal training range of ΔR covers the clearances of typical machines",
    paper="0.05 to 10 mm",
    rule="the range starts at or below the smallest clearance that the paper compares",
    paper_values={"low, mm": paper.TRAINING_DR["internal"][0]},
)
def clearances_covered() -> Finding:
    """Return the smallest clearance in mm that the paper compares."""
    low, compared, typical = (
        paper.TRAINING_DR["internal"][0],
        paper.COMPARED_CLEARANCES[0],
        paper.FIG7_CLEARANCES[0],
    )
    return Finding(
        f"Sect. 3.4 compares from {compared * 1e3:g} µm and Sect. 3.3 counts clearances "
        f"from {typical * 1e3:g} µm as typical: {low / compared:.1f} and {low / typical:.0f} "
        "times below the range's lower end",
        holds=low <= compared,
        choice="judged by the paper's own later ranges: below 50 µm the enhanced law is "
        "extrapolated",
        values={"smallest compared, mm": compared},
    )


# The fit itself, judged by the committed results.
OPTIMUM = 1.01  # times the best known objective counts as the optimum
SAME_COEFFICIENT = 0.01  # relative distance within which coefficients count as the same
MISSING = Finding("", None, choice="no fit result to compute it from; make fits produces them")
CHOICES = (
    "objective, point counts, spacing, bounds and search settings are ours; the objective is the "
    "root mean square of ln(δ_enhanced/δ_Johnson)"
)


@claim(
    "3.1-best-correlation-{contact}",
    "the published {contact} coefficients give the best correlation with Johnson",
    paper="best of several genetic runs",
    rule=f"at most {OPTIMUM:g} times the refit's objective",
    cases=[{"contact": "internal"}, {"contact": "external"}],
)
def best_correlation(bench: Bench, contact: Contact) -> Finding:
    """Return the published coefficients' objective over the refit's, by campaign."""
    ratios = {
        name: result.published.objective / result.objective.value
        for name, result in bench.results_by_name().items()
        if result.contact == contact and result.published is not None
    }
    others = ", ".join(f"{ratio:.2f} ({name})" for name, ratio in ratios.items() if name != contact)
    finding = MISSING
    if contact in ratios:
        finding = Finding(
            f"objective {ratios[contact]:.2f} times that of the refit",
            holds=ratios[contact] <= OPTIMUM,
            choice=f"ranges of Sect. 3.1 to the letter; {CHOICES}",
        )
    return replace(
        finding,
        alternatives=f"on other grids or by other objectives: {others}" if others else "",
        values={f"objective ratio on {name}, -": ratio for name, ratio in ratios.items()},
    )


@claim(
    "3.1-external-{name}",
    "the optimum for external contact has this {name}",
    paper="{published:g}",
    rule=f"within {SAME_COEFFICIENT:.0%} of the published value",
    cases=[
        {"name": name, "published": getattr(PUBLISHED["external"], name)}
        for name in ("a", "b", "n")
    ],
)
def external_coefficient(bench: Bench, name: str, published: float) -> Finding:
    """Return one refitted external coefficient, by campaign."""
    refits = {
        campaign: result
        for campaign, result in bench.results_by_name().items()
        if result.contact == "external" and result.law == "enhanced"
    }
    values = {campaign: result.coefficients[name] for campaign, result in refits.items()}
    main = refits.pop("external-E1000", None)
    others = ", ".join(f"{values[campaign]:.4g} ({campaign})" for campaign in refits)
    finding = MISSING
    if main is not None:
        value, profile = main.coefficients[name], main.profiles[name]
        deviation = value / published - 1
        finding = Finding(
            f"{value:.4g} ({deviation:+.1%}); from {profile.low:.3g} to {profile.high:.3g} the fit "
            "is within 1 % of the best",
            holds=abs(deviation) <= SAME_COEFFICIENT,
            choice=f"E up to 1000 GPa; {CHOICES}",
        )
    return replace(
        finding,
        alternatives=f"refit on other grids: {others}" if others else "",
        values={f"{name} on {campaign}, -": value for campaign, value in values.items()},
        paper_values={f"{name}, -": published},
    )


@claim(
    "3.1-several-runs",
    "several runs with different populations and crossovers are needed",
    paper="several runs",
    rule="at least one run misses the best objective by more than 0.1 %",
)
def several_runs(bench: Bench) -> Finding:
    """Return how many runs of the internal campaign miss the best basin."""
    result = bench.results_by_name().get("internal")
    if result is None:
        return MISSING
    missed = len(result.runs) - basins(result)[0][1]
    return Finding(
        f"{missed} of {len(result.runs)} internal runs end in a worse basin, even polished",
        holds=missed > 0,
        choice=CHOICES,
        values={"runs in a worse basin, -": float(missed)},
    )
