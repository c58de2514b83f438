"""Section 3.1: the fits of Fig 2, and how the exponent n varies (Fig 3)."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from cylcontact.arrays import FloatArray
from cylcontact.pair import Contact
from cylcontact.reports.claims import Finding, agrees_as_printed, claim, verdict_if

from .. import paper
from ..paper import Interval
from ..power_fits import (
    FIG2_LOADS,
    SEARCHED_COUNTS,
    SEARCHED_STEPS,
    closest_external_window,
    ends_spread,
    fig2_fit,
    fit_at,
    johnson_points,
    r_squared_at,
    r_squared_in_force,
    reference_pair,
)

K_UNIT = "N/mm per mmⁿ"
LOADS: dict[Contact, str] = {
    "internal": "1, 10, 20, …, 1000 N/mm",
    "external": "1, 100, 200, …, 10000 N/mm",
}
FIG2_CASES = [
    {
        "contact": contact,
        "K": K,
        "n": n,
        "case": f"ΔR = {paper.FIG2_DR[contact]:g} mm, 207 GPa, ν = 0.3 (Fig 2)",
    }
    for contact, (K, n) in paper.FIG2_FITS.items()
]
FIG2_CHOICE: dict[Contact, str] = {
    "internal": f"the paper does not list its loads; {LOADS['internal']} and a straight line "
    "through (ln δ, ln f) give every printed digit of K and n at once",
    "external": f"the paper does not list its loads; {LOADS['external']} is the internal recipe "
    "over a range ten times as wide. ΔR = 140 mm is the caption's: the 50 µm in the text can only "
    "be meant for the internal case",
}


@claim(
    "3.1-fig2-{contact}-K",
    "factor K of the power law fitted to Johnson's, {contact}, {case}",
    paper="{K} " + K_UNIT,
    rule="agreement to the printed digit",
    cases=FIG2_CASES,
)
def fig2_factor(contact: Contact, K: str) -> Finding:
    """Return K of Fig 2's fit."""
    fit = fig2_fit(contact)
    return Finding(
        f"{fit.K:.1f} {K_UNIT} ({100 * (fit.K / float(K) - 1):+.2f} %)",
        holds=agrees_as_printed(fit.K, K),
        choice=FIG2_CHOICE[contact],
        alternatives=_other_loads(contact),
        values={"K, N/mm per mm^n": fit.K},
        paper_values={"K, N/mm per mm^n": float(K)},
    )


@claim(
    "3.1-fig2-{contact}-n",
    "exponent n of the power law fitted to Johnson's, {contact}, {case}",
    paper="{n}",
    rule="agreement to the printed digit",
    cases=FIG2_CASES,
)
def fig2_exponent(contact: Contact, n: str) -> Finding:
    """Return n of Fig 2's fit."""
    fit = fig2_fit(contact)
    return Finding(
        f"{fit.n:.5f}",
        holds=agrees_as_printed(fit.n, n),
        choice=FIG2_CHOICE[contact],
        alternatives=_other_loads(contact),
        values={"n, -": fit.n},
        paper_values={"n, -": float(n)},
    )


def _other_loads(contact: Contact) -> str:
    """Return what other lists of loads give for the external case."""
    if contact == "internal":
        return ""
    K, n = (float(text) for text in paper.FIG2_FITS[contact])
    loads, closest = closest_external_window(n, K)
    internal = fig2_fit(contact, FIG2_LOADS["internal"])
    return (
        f"the internal case's own loads give K = {internal.K:.0f}, n = {internal.n:.4f}. Of "
        f"{len(SEARCHED_STEPS) * len(SEARCHED_COUNTS)} lists of that form (1 N/mm, then 20 to 120 "
        "steps of 10 to 500 N/mm) none gives both printed numbers; of those that give "
        f"n = {n}, {loads} comes closest to K, with {closest.K:.1f} "
        f"({100 * (closest.K / K - 1):+.2f} %)"
    )


@claim(
    "3.1-fig2-{contact}-r-squared",
    "correlation of that fit with Johnson's law, {contact}",
    paper=f"R² > {paper.GOOD_CORRELATION}",
    rule=f"R² above {paper.GOOD_CORRELATION}",
    paper_values={"R squared, -": paper.GOOD_CORRELATION},
    cases=FIG2_CASES,
)
def fig2_correlation(contact: Contact) -> Finding:
    """Return R² of Fig 2's fit, of ln f and of f."""
    fit = fig2_fit(contact)
    points = johnson_points(FIG2_LOADS[contact], reference_pair(contact, paper.FIG2_DR[contact]))
    in_force = r_squared_in_force(fit, *points)
    return Finding(
        f"R² = {fit.r_squared:.5f} in the log–log line",
        holds=fit.r_squared > paper.GOOD_CORRELATION,
        choice=f"R² of ln f about the fitted line; loads {LOADS[contact]}",
        alternatives=f"R² of f itself about the same curve is {in_force:.5f}: "
        f"{'also' if in_force > paper.GOOD_CORRELATION else 'not'} above {paper.GOOD_CORRELATION}",
        values={"R squared of ln f, -": fit.r_squared, "R squared of f, -": in_force},
    )


STRICT_CORRELATION = 0.999
N_EXTERNAL = 1.094
LOADS_AND_NU = "loads 10–1000 N/mm spaced logarithmically, ν = 0.3"


def exponent(contact: Contact, dR: float, E: float = paper.E_REFERENCE) -> float:
    """Return n of the power law fitted over the training loads, at ΔR in mm and E in MPa."""
    return fit_at(contact, dR, E, paper.TRAINING_LOADS).n


def spread(contact: Contact, dR: Interval, E: Interval) -> float:
    """Return the spread of n between two ΔR in mm with two E in MPa, in percent."""
    low, high = (exponent(contact, *ends) for ends in zip(dR, E, strict=True))
    return ends_spread((low, high))


def sensitivity(contact: Contact, bounds: Interval, choice: str) -> Finding:
    """Return the spreads of n over the training ranges, their ratio judged by its bounds."""
    low, high = paper.TRAINING_DR[contact]
    E, step, centre = paper.E_REFERENCE, 1.01, float(np.sqrt(low * high))
    over_dR = spread(contact, (low, high), (E, E))
    over_E = spread(contact, (centre, centre), paper.TRAINING_E)
    by_dR, by_E = (
        float(np.log(exponent(contact, *more) / exponent(contact, *less)) / (2 * np.log(step)))
        for more, less in (
            ((centre * step, E), (centre / step, E)),
            ((centre, E * step), (centre, E / step)),
        )
    )
    spreads = {
        f"at ΔR = {low:g} mm": spread(contact, (low, low), paper.TRAINING_E),
        f"at ΔR = {high:g} mm": spread(contact, (high, high), paper.TRAINING_E),
        "E up to 1000 GPa": spread(contact, (centre, centre), (20.7e3, 1000e3)),
        "E of Sect. 3.4, 69–600 GPa": spread(contact, (centre, centre), (69e3, 600e3)),
    }
    ratios = {name: over_dR / other for name, other in spreads.items()}
    return Finding(
        f"n spreads {over_dR:.1f} % over ΔR = {low:g}–{high:g} mm (at 207 GPa) and "
        f"{over_E:.1f} % over E = 20.7–10000 GPa (at ΔR = {centre:.3g} mm), a ratio of "
        f"{over_dR / over_E:.2f}; 1 % more ΔR and 1 % more E change it alike, by {by_dR:.4f} "
        f"and {by_E:.4f} %",
        holds=bounds[0] <= over_dR / over_E <= bounds[1],
        choice=choice,
        alternatives="ratio of the spreads: "
        + ", ".join(
            f"{name}, {ratio:.2f} {verdict_if(bounds[0] <= ratio <= bounds[1])}"
            for name, ratio in ratios.items()
        ),
        values={"over dR, percent": over_dR, "over E, percent": over_E},
    )


@claim(
    "3.1-fig3-internal-sensitivity",
    "internal: n is far more sensitive to ΔR than to the elastic constants (Fig 3a)",
    paper="much lower sensitivity to the material",
    rule="the spread of n over ΔR is at least twice that over E",
)
def fig3_internal_sensitivity() -> Finding:
    """Return the spreads of n over ΔR and over E for internal contact."""
    choice = (
        "full training ranges (the curves of Fig 3 are not named in the text), "
        f"{LOADS_AND_NU}. Johnson's law knows ΔR and E only through E*·ΔR, so n takes the same "
        "change from 1 % of either; which spread is wider only tells which range is wider: 200 "
        "times in ΔR, 483 times in E"
    )
    return sensitivity("internal", (2, np.inf), choice)


@claim(
    "3.1-fig3-external-sensitivity",
    "external: n is about equally sensitive to ΔR and to E (Fig 3b)",
    paper="equally dependent on both",
    rule="neither spread of n exceeds twice the other",
)
def fig3_external_sensitivity() -> Finding:
    """Return the spreads of n over ΔR and over E for external contact."""
    return sensitivity("external", (0.5, 2), f"full training ranges, {LOADS_AND_NU}")


N_TRIED = np.round(np.arange(1.05, 1.3005, 0.001), 3)


def training_box(contact: Contact) -> tuple[FloatArray, FloatArray]:
    """Return R² of ln f for every n tried along the training box, and the part of the box at each.

    Johnson's law knows the pair only through E*·ΔR once the loads are given, so the box of ΔR and
    E is sampled along that product, from corner to corner. R² has the shape (product, n); the
    parts, on logarithmic axes, sum to 100 %.
    """
    sides = np.array([paper.TRAINING_DR[contact], paper.TRAINING_E])
    low, high = np.log(sides.prod(axis=0))
    s = np.linspace(low, high, 2001)
    # The lengths of the lines ln E + ln ΔR = s inside the rectangle: a trapezium.
    length = np.minimum(np.minimum(s - low, high - s), np.diff(np.log(sides)).min())
    r_squared = [r_squared_at(N_TRIED, *product_points(contact, product)) for product in np.exp(s)]
    return np.array(r_squared), 100 * length / length.sum()


def product_points(contact: Contact, product: float) -> tuple[FloatArray, FloatArray]:
    """Return loads and penetrations of a pair with E·ΔR as given, at the reference modulus."""
    return johnson_points(
        paper.TRAINING_LOADS, reference_pair(contact, product / paper.E_REFERENCE)
    )


@claim(
    "3.1-internal-no-single-n",
    "internal: no single exponent serves all clearances and materials",
    paper="none does",
    rule=f"no n gives R² > {paper.GOOD_CORRELATION} all over the training box",
)
def internal_no_single_n() -> Finding:
    """Return how much of the internal training box the best single exponent serves."""
    r_squared, part = training_box("internal")
    served = part @ (r_squared > paper.GOOD_CORRELATION)
    best = int(np.argmax(served))
    return Finding(
        f"the best single exponent, n = {N_TRIED[best]:.3f}, serves {served[best]:.0f} % of the "
        "box",
        holds=bool(served.max() < 100),
        choice=f"'serves' means R² > {paper.GOOD_CORRELATION} of ln f (the paper's figure for a "
        "very good correlation) with the best factor K for that n; box of ΔR = 0.05–10 mm and "
        f"E = 20.7–10000 GPa on logarithmic axes; {LOADS_AND_NU}",
        values={"best n, -": float(N_TRIED[best]), "served, percent": float(served[best])},
    )


@claim(
    "3.1-external-single-n",
    "external: n = 1.094 correlates acceptably for most geometries and materials",
    paper="most",
    rule=f"R² > {paper.GOOD_CORRELATION} over more than half of the training box",
)
def external_single_n() -> Finding:
    """Return how much of the external training box n = 1.094 serves."""
    r_squared, part = training_box("external")
    column = r_squared[:, int(np.argmin(np.abs(N_TRIED - N_EXTERNAL)))]
    served, least = float(part @ (column > paper.GOOD_CORRELATION)), float(column.min())
    return Finding(
        f"n = {N_EXTERNAL} serves {served:.1f} % of the box (least R² = {least:.4f})",
        holds=served > 50,
        choice="'serves' as for internal contact, with the best K at every point; box of "
        f"ΔR = 5–500 mm and E = 20.7–10000 GPa; {LOADS_AND_NU}",
        values={"served, percent": served, "least R squared, -": least},
    )


@claim(
    "3.1-external-exceptions",
    "external: exceptions are the smallest ΔR and both extremes of E",
    paper="smallest ΔR; lowest and highest E",
    rule=f"R² ≤ {paper.GOOD_CORRELATION} occurs at the smallest ΔR, at the lowest E and at the "
    "highest E",
)
def external_exceptions() -> Finding:
    """Return where n = 1.094 fails, and the exponents fitted at the corners of the box."""
    (dR_low, dR_high), (E_low, E_high) = paper.TRAINING_DR["external"], paper.TRAINING_E
    corners = {
        f"{dR:g} mm, {E / 1e3:g} GPa": exponent("external", dR, E)
        for dR in (dR_low, dR_high)
        for E in (E_low, E_high)
    }

    def excess(product: float, bar: float) -> float:
        """Return R² at n = 1.094 less a bar, at E·ΔR in N/mm."""
        return float(r_squared_at(N_EXTERNAL, *product_points("external", product))) - bar

    def both_corners_fail(bar: float) -> bool:
        return all(excess(product, bar) <= 0 for product in (dR_low * E_low, dR_high * E_high))

    soft_edge = brentq(excess, dR_low * E_low, dR_high * E_low, (paper.GOOD_CORRELATION,))
    stiff_edge = brentq(excess, dR_low * E_high, dR_high * E_high, (STRICT_CORRELATION,))
    return Finding(
        f"R² ≤ {paper.GOOD_CORRELATION} only in the corner E·ΔR < {soft_edge / 1e3:.0f} GPa·mm: "
        f"E up to {soft_edge / dR_low / 1e3:.1f} GPa at {dR_low:g} mm, ΔR up to "
        f"{soft_edge / E_low:.1f} mm at {E_low / 1e3:g} GPa; fitted n in the box's corners: "
        + ", ".join(f"{n:.3f} ({name})" for name, n in corners.items()),
        holds=both_corners_fail(paper.GOOD_CORRELATION),
        choice="n depends on E*·ΔR only: small ΔR with low E wants a larger n, large ΔR with high "
        "E a smaller one; by this measure only the former is an exception, the highest E none",
        alternatives=f"with R² > {STRICT_CORRELATION} as the bar the highest E becomes an "
        f"exception too, though with the largest ΔR, {stiff_edge / E_high:.0f} mm and more "
        + verdict_if(both_corners_fail(STRICT_CORRELATION)),
        values={
            **{f"n at {name}, -": n for name, n in corners.items()},
            "largest E·ΔR of the exceptions, N/mm": float(soft_edge),
        },
    )
