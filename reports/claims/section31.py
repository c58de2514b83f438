"""Section 3.1: the fits of Fig 2, and how the exponent n varies (Fig 3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from cylcontact.arrays import FloatArray
from cylcontact.pair import Contact
from cylcontact.reports.claims import Finding, agrees_as_printed, claim, verdict_if

from ..paper import (
    E_REFERENCE,
    FIG2_DR,
    FIG2_FITS,
    GOOD_CORRELATION,
    TRAINING_DR,
    TRAINING_E,
    TRAINING_LOADS,
)
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
        "case": f"ΔR = {FIG2_DR[contact]:g} mm, 207 GPa, ν = 0.3 (Fig 2)",
    }
    for contact, (K, n) in FIG2_FITS.items()
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
    K, n = (float(text) for text in FIG2_FITS[contact])
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
    paper=f"R² > {GOOD_CORRELATION}",
    rule=f"R² above {GOOD_CORRELATION}",
    paper_values={"R squared, -": GOOD_CORRELATION},
    cases=FIG2_CASES,
)
def fig2_correlation(contact: Contact) -> Finding:
    """Return R² of Fig 2's fit, of ln f and of f."""
    fit = fig2_fit(contact)
    points = johnson_points(FIG2_LOADS[contact], reference_pair(contact, FIG2_DR[contact]))
    in_force = r_squared_in_force(fit, *points)
    return Finding(
        f"R² = {fit.r_squared:.5f} in the log–log line",
        holds=fit.r_squared > GOOD_CORRELATION,
        choice=f"R² of ln f about the fitted line; loads {LOADS[contact]}",
        alternatives=f"R² of f itself about the same curve is {in_force:.5f}: "
        f"{'also' if in_force > GOOD_CORRELATION else 'not'} above {GOOD_CORRELATION}",
        values={"R squared of ln f, -": fit.r_squared, "R squared of f, -": in_force},
    )


STRICT_CORRELATION = 0.999
N_EXTERNAL = 1.094
LOADS_AND_NU = "loads 10–1000 N/mm spaced logarithmically, ν = 0.3"


def exponent(contact: Contact, dR: float, E: float = E_REFERENCE) -> float:
    """Return n of the power law fitted over the training loads, at ΔR in mm and E in MPa."""
    return fit_at(contact, dR, E, TRAINING_LOADS).n


@dataclass(frozen=True)
class Sensitivity:
    """How n spreads over the training ranges of a contact, in percent.

    Attributes
    ----------
    contact : str
        "internal" or "external".
    centre : float
        The ΔR in mm at which E is varied, the geometric mean of its range.
    over_dR, over_E : float
        The spreads.
    """

    contact: Contact
    centre: float
    over_dR: float
    over_E: float

    @classmethod
    def of(cls, contact: Contact) -> Sensitivity:
        """Fit Johnson's law at the ends of the training ranges."""
        low, high = TRAINING_DR[contact]
        centre = float(np.sqrt(low * high))
        over_dR = ends_spread((exponent(contact, low), exponent(contact, high)))
        return cls(contact, centre, over_dR, _spread_over_E(contact, centre))

    @property
    def ratio(self) -> float:
        """The spread over ΔR, over that over E."""
        return self.over_dR / self.over_E

    @property
    def values(self) -> dict[str, float]:
        """The spreads by name."""
        return {"over dR, percent": self.over_dR, "over E, percent": self.over_E}

    def __str__(self) -> str:
        contact, centre, step = self.contact, self.centre, 1.01
        low, high = TRAINING_DR[contact]
        by_dR, by_E = (
            float(np.log(more / less) / (2 * np.log(step)))
            for less, more in (
                (exponent(contact, centre / step), exponent(contact, centre * step)),
                (
                    exponent(contact, centre, E_REFERENCE / step),
                    exponent(contact, centre, E_REFERENCE * step),
                ),
            )
        )
        return (
            f"n spreads {self.over_dR:.1f} % over ΔR = {low:g}–{high:g} mm (at 207 GPa) and "
            f"{self.over_E:.1f} % over E = 20.7–10000 GPa (at ΔR = {centre:.3g} mm), a ratio of "
            f"{self.ratio:.2f}; 1 % more ΔR and 1 % more E change it alike, by {by_dR:.4f} "
            f"and {by_E:.4f} %"
        )

    def other_ratios(self, least: float, most: float = np.inf) -> str:
        """Return the ratio of the spreads over other ranges of E and at the ends of ΔR, judged."""
        contact, centre, (low, high) = self.contact, self.centre, TRAINING_DR[self.contact]
        spreads = {
            f"at ΔR = {low:g} mm": _spread_over_E(contact, low),
            f"at ΔR = {high:g} mm": _spread_over_E(contact, high),
            "E up to 1000 GPa": _spread_over_E(contact, centre, (20.7e3, 1000e3)),
            "E of Sect. 3.4, 69–600 GPa": _spread_over_E(contact, centre, (69e3, 600e3)),
        }
        ratios = {name: self.over_dR / spread for name, spread in spreads.items()}
        return "ratio of the spreads: " + ", ".join(
            f"{name}, {ratio:.2f} {verdict_if(least <= ratio <= most)}"
            for name, ratio in ratios.items()
        )


def _spread_over_E(contact: Contact, dR: float, moduli: tuple[float, float] = TRAINING_E) -> float:
    """Return the spread of n between two moduli in MPa, in percent."""
    low, high = moduli
    return ends_spread((exponent(contact, dR, low), exponent(contact, dR, high)))


@claim(
    "3.1-fig3-internal-sensitivity",
    "internal: n is far more sensitive to ΔR than to the elastic constants (Fig 3a)",
    paper="much lower sensitivity to the material",
    rule="the spread of n over ΔR is at least twice that over E",
)
def fig3_internal_sensitivity() -> Finding:
    """Return the spreads of n over ΔR and over E for internal contact."""
    sensitivity = Sensitivity.of("internal")
    return Finding(
        str(sensitivity),
        holds=sensitivity.ratio >= 2,
        choice="full training ranges (the curves of Fig 3 are not named in the text), "
        f"{LOADS_AND_NU}. Johnson's law knows ΔR and E only through E*·ΔR, so n takes the same "
        "change from 1 % of either; which spread is wider only tells which range is wider: 200 "
        "times in ΔR, 483 times in E",
        alternatives=sensitivity.other_ratios(2),
        values=sensitivity.values,
    )


@claim(
    "3.1-fig3-external-sensitivity",
    "external: n is about equally sensitive to ΔR and to E (Fig 3b)",
    paper="equally dependent on both",
    rule="neither spread of n exceeds twice the other",
)
def fig3_external_sensitivity() -> Finding:
    """Return the spreads of n over ΔR and over E for external contact."""
    sensitivity = Sensitivity.of("external")
    return Finding(
        str(sensitivity),
        holds=0.5 <= sensitivity.ratio <= 2,
        choice=f"full training ranges, {LOADS_AND_NU}",
        alternatives=sensitivity.other_ratios(0.5, 2),
        values=sensitivity.values,
    )


@dataclass(frozen=True)
class TrainingBox:
    """R² of ln f about the best line of given slope, over the training ranges of ΔR and E.

    Johnson's law knows the pair only through E*·ΔR once the loads are given, so the box is
    sampled along that one product, each value weighted by its share of the box.

    Attributes
    ----------
    product : array of float
        E·ΔR in N/mm, logarithmically spaced from corner to corner of the box.
    weight : array of float
        The part of the box, on logarithmic axes, at each product; the sum is 1.
    n : array of float
        The slopes tried.
    r_squared : array of float
        R², shape (product, n).
    """

    product: FloatArray
    weight: FloatArray
    n: FloatArray
    r_squared: FloatArray

    @classmethod
    def of(cls, contact: Contact) -> TrainingBox:
        """Fit Johnson's law along the products of the contact's box."""
        low, high = np.log(np.multiply(TRAINING_DR[contact], TRAINING_E))
        s = np.linspace(low, high, 2001)
        # The lengths of the lines ln E + ln ΔR = s inside the rectangle: a trapezium.
        widths = np.log([np.divide(*TRAINING_DR[contact][::-1]), np.divide(*TRAINING_E[::-1])])
        weight = np.minimum(np.minimum(s - low, high - s), widths.min())
        n = np.round(np.arange(1.05, 1.3005, 0.001), 3)
        r_squared = np.array([r_squared_at(n, *product_points(contact, p)) for p in np.exp(s)])
        return cls(np.exp(s), weight / weight.sum(), n, r_squared)

    def served(self) -> FloatArray:
        """Return the percentage of the box in which each n gives a good correlation."""
        share: FloatArray = 100 * self.weight @ (self.r_squared > GOOD_CORRELATION)
        return share


def product_points(contact: Contact, product: float) -> tuple[FloatArray, FloatArray]:
    """Return loads and penetrations of a pair with E·ΔR as given, at the reference modulus."""
    return johnson_points(TRAINING_LOADS, reference_pair(contact, product / E_REFERENCE))


@claim(
    "3.1-internal-no-single-n",
    "internal: no single exponent serves all clearances and materials",
    paper="none does",
    rule=f"no n gives R² > {GOOD_CORRELATION} all over the training box",
)
def internal_no_single_n() -> Finding:
    """Return how much of the internal training box the best single exponent serves."""
    box = TrainingBox.of("internal")
    n, served = box.n, box.served()
    best = int(np.argmax(served))
    return Finding(
        f"the best single exponent, n = {n[best]:.3f}, serves {served[best]:.0f} % of the box",
        holds=bool(served.max() < 100),
        choice=f"'serves' means R² > {GOOD_CORRELATION} of ln f (the paper's figure for a very "
        "good correlation) with the best factor K for that n; box of ΔR = 0.05–10 mm and "
        f"E = 20.7–10000 GPa on logarithmic axes; {LOADS_AND_NU}",
        values={"best n, -": float(n[best]), "served, percent": float(served[best])},
    )


@claim(
    "3.1-external-single-n",
    "external: n = 1.094 correlates acceptably for most geometries and materials",
    paper="most",
    rule=f"R² > {GOOD_CORRELATION} over more than half of the training box",
)
def external_single_n() -> Finding:
    """Return how much of the external training box n = 1.094 serves."""
    box = TrainingBox.of("external")
    column = int(np.argmin(np.abs(box.n - N_EXTERNAL)))
    served = float(box.served()[column])
    least = float(box.r_squared[:, column].min())
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
    rule=f"R² ≤ {GOOD_CORRELATION} occurs at the smallest ΔR, at the lowest E and at the highest E",
)
def external_exceptions() -> Finding:
    """Return where n = 1.094 fails, and the exponents fitted at the corners of the box."""
    (dR_low, dR_high), (E_low, E_high) = TRAINING_DR["external"], TRAINING_E
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

    soft_edge = brentq(excess, dR_low * E_low, dR_high * E_low, (GOOD_CORRELATION,))
    stiff_edge = brentq(excess, dR_low * E_high, dR_high * E_high, (STRICT_CORRELATION,))
    return Finding(
        f"R² ≤ {GOOD_CORRELATION} only in the corner E·ΔR < {soft_edge / 1e3:.0f} GPa·mm: E up to "
        f"{soft_edge / dR_low / 1e3:.1f} GPa at {dR_low:g} mm, ΔR up to "
        f"{soft_edge / E_low:.1f} mm at {E_low / 1e3:g} GPa; fitted n in the box's corners: "
        + ", ".join(f"{n:.3f} ({name})" for name, n in corners.items()),
        holds=both_corners_fail(GOOD_CORRELATION),
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
