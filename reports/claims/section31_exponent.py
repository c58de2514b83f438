"""Section 3.1's statements on how the exponent n varies (Fig 3)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from cylcontact.arrays import FloatArray
from cylcontact.pair import Contact
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim, verdict_if

from ..paper import E_REFERENCE, TRAINING_DR, TRAINING_E, TRAINING_LOADS
from ..power_fits import ends_spread, fit_at, johnson_points, r_squared_at, reference_pair

ACCEPTABLE = 0.998  # R² of Sect. 3.1
STRICT = 0.999
N_EXTERNAL = 1.094
LOADS_TOLD = "loads 10–1000 N/mm spaced logarithmically, ν = 0.3"


def spread_over_dR(contact: Contact) -> float:
    """Return the spread of n over the training range of ΔR at 207 GPa, in percent."""
    low, high = (fit_at(contact, dR, E_REFERENCE, TRAINING_LOADS).n for dR in TRAINING_DR[contact])
    return ends_spread((low, high))


def spread_over_E(contact: Contact, dR: float, moduli: tuple[float, float] = TRAINING_E) -> float:
    """Return the spread of n over moduli in MPa at ΔR in mm, in percent."""
    low, high = (fit_at(contact, dR, E, TRAINING_LOADS).n for E in moduli)
    return ends_spread((low, high))


@claim(
    "3.1-fig3-internal-sensitivity",
    "internal: n is far more sensitive to ΔR than to the elastic constants (Fig 3a)",
    paper="much lower sensitivity to the material",
    rule="the spread of n over ΔR is at least twice that over E",
)
def internal_sensitivity(_bench: Bench) -> Finding:
    """Return the spreads of n over ΔR and over E for internal contact."""
    contact: Contact = "internal"
    centre = float(np.sqrt(np.prod(TRAINING_DR[contact])))
    over_dR, over_E = spread_over_dR(contact), spread_over_E(contact, centre)
    return Finding(
        _spreads(contact, over_dR, over_E, centre),
        holds=_far_more(over_dR / over_E),
        choice=(
            "full training ranges (the curves of Fig 3 are not named in the text), "
            + LOADS_TOLD
            + ". Johnson's law knows ΔR and E only through E*·ΔR, so n takes the same change from "
            "1 % of either; which spread is wider only tells which range is wider: 200 times in "
            "ΔR, 483 times in E"
        ),
        alternatives=_other_ratios(contact, centre, over_dR, _far_more),
        values={"over dR, percent": over_dR, "over E, percent": over_E},
    )


@claim(
    "3.1-fig3-external-sensitivity",
    "external: n is about equally sensitive to ΔR and to E (Fig 3b)",
    paper="equally dependent on both",
    rule="neither spread of n exceeds twice the other",
)
def external_sensitivity(_bench: Bench) -> Finding:
    """Return the spreads of n over ΔR and over E for external contact."""
    contact: Contact = "external"
    centre = float(np.sqrt(np.prod(TRAINING_DR[contact])))
    over_dR, over_E = spread_over_dR(contact), spread_over_E(contact, centre)
    return Finding(
        _spreads(contact, over_dR, over_E, centre),
        holds=_about_equal(over_dR / over_E),
        choice="full training ranges, " + LOADS_TOLD,
        alternatives=_other_ratios(contact, centre, over_dR, _about_equal),
        values={"over dR, percent": over_dR, "over E, percent": over_E},
    )


def _spreads(contact: Contact, over_dR: float, over_E: float, centre: float) -> str:
    """Tell the two spreads, that over ν, and the sensitivities per percent."""
    low, high = TRAINING_DR[contact]
    return (
        f"n spreads {over_dR:.1f} % over ΔR = {low:g}–{high:g} mm (at 207 GPa) and {over_E:.1f} % "
        f"over E = 20.7–10000 GPa (at ΔR = {centre:.3g} mm), a ratio of {over_dR / over_E:.2f}; "
        f"1 % more ΔR and 1 % more E change it alike, by {_elasticity(contact, centre, 'dR'):.4f} "
        f"and {_elasticity(contact, centre, 'E'):.4f} %"
    )


def _elasticity(contact: Contact, dR: float, of: str) -> float:
    """Return d ln n/d ln ΔR or d ln n/d ln E by a central difference."""
    step = 1.01
    ends = [
        fit_at(
            contact,
            dR * (factor if of == "dR" else 1),
            E_REFERENCE * (factor if of == "E" else 1),
            TRAINING_LOADS,
        ).n
        for factor in (1 / step, step)
    ]
    return float(np.log(ends[1] / ends[0]) / (2 * np.log(step)))


def _far_more(ratio: float) -> bool:
    """Tell whether the spread over ΔR is far wider than that over E."""
    return ratio >= 2


def _about_equal(ratio: float) -> bool:
    """Tell whether neither spread is far wider than the other."""
    return 0.5 <= ratio <= 2


def _other_ratios(
    contact: Contact, centre: float, over_dR: float, rule: Callable[[float], bool]
) -> str:
    """Tell the ratio of the spreads under other ranges of E and at the ends of ΔR."""
    low, high = TRAINING_DR[contact]
    others = {
        f"at ΔR = {low:g} mm": spread_over_E(contact, low),
        f"at ΔR = {high:g} mm": spread_over_E(contact, high),
        "E up to 1000 GPa": spread_over_E(contact, centre, (20.7e3, 1000e3)),
        "E of Sect. 3.4, 69–600 GPa": spread_over_E(contact, centre, (69e3, 600e3)),
    }
    ratios = {name: over_dR / spread for name, spread in others.items()}
    return "ratio of the spreads: " + ", ".join(
        f"{name}, {ratio:.2f} {verdict_if(rule(ratio))}" for name, ratio in ratios.items()
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
        """Return the percentage of the box in which each n reaches the acceptable R²."""
        share: FloatArray = 100 * self.weight @ (self.r_squared > ACCEPTABLE)
        return share


def product_points(contact: Contact, product: float) -> tuple[FloatArray, FloatArray]:
    """Return loads and penetrations of a pair with E·ΔR as given, at the reference modulus."""
    return johnson_points(TRAINING_LOADS, reference_pair(contact, product / E_REFERENCE))


@claim(
    "3.1-internal-no-single-n",
    "internal: no single exponent serves all clearances and materials",
    paper="none does",
    rule=f"no n gives R² > {ACCEPTABLE} all over the training box",
)
def no_single_exponent_internal(_bench: Bench) -> Finding:
    """Return how much of the internal training box the best single exponent serves."""
    box = TrainingBox.of("internal")
    n, served = box.n, box.served()
    best = int(np.argmax(served))
    return Finding(
        f"the best single exponent, n = {n[best]:.3f}, serves {served[best]:.0f} % of the box",
        holds=bool(served.max() < 100),
        choice=(
            f"'serves' means R² > {ACCEPTABLE} of ln f (the paper's figure for a very good "
            "correlation) with the best factor K for that n; box of ΔR = 0.05–10 mm and "
            "E = 20.7–10000 GPa on logarithmic axes; " + LOADS_TOLD
        ),
        values={"best n, -": float(n[best]), "served, percent": float(served[best])},
    )


@claim(
    "3.1-external-single-n",
    "external: n = 1.094 correlates acceptably for most geometries and materials",
    paper="most",
    rule=f"R² > {ACCEPTABLE} over more than half of the training box",
)
def single_exponent_external(_bench: Bench) -> Finding:
    """Return how much of the external training box n = 1.094 serves."""
    box = TrainingBox.of("external")
    column = int(np.argmin(np.abs(box.n - N_EXTERNAL)))
    served = float(box.served()[column])
    least = float(box.r_squared[:, column].min())
    return Finding(
        f"n = {N_EXTERNAL} serves {served:.1f} % of the box (least R² = {least:.4f})",
        holds=served > 50,
        choice=(
            "'serves' as for internal contact, with the best K at every point; box of "
            "ΔR = 5–500 mm and E = 20.7–10000 GPa; " + LOADS_TOLD
        ),
        values={"served, percent": served, "least R squared, -": least},
    )


@claim(
    "3.1-external-exceptions",
    "external: exceptions are the smallest ΔR and both extremes of E",
    paper="smallest ΔR; lowest and highest E",
    rule=f"R² ≤ {ACCEPTABLE} occurs at the smallest ΔR, at the lowest E and at the highest E",
)
def exceptions_external(_bench: Bench) -> Finding:
    """Return where n = 1.094 fails and the exponents that the corners would want."""
    (dR_low, dR_high), (E_low, E_high) = TRAINING_DR["external"], TRAINING_E
    corners = {
        f"{dR:g} mm, {E / 1e3:g} GPa": fit_at("external", dR, E, TRAINING_LOADS).n
        for dR in (dR_low, dR_high)
        for E in (E_low, E_high)
    }
    low_edge = float(brentq(_excess_r_squared, dR_low * E_low, dR_high * E_low))
    strict_edge = float(
        brentq(lambda p: _excess_r_squared(p, STRICT), dR_low * E_high, dR_high * E_high)
    )
    return Finding(
        (
            f"R² ≤ {ACCEPTABLE} only in the corner E·ΔR < {low_edge / 1e3:.0f} GPa·mm: E up to "
            f"{low_edge / dR_low / 1e3:.1f} GPa at {dR_low:g} mm, ΔR up to "
            f"{low_edge / E_low:.1f} mm at {E_low / 1e3:g} GPa; fitted n in the box's corners: "
            + ", ".join(f"{n:.3f} ({name})" for name, n in corners.items())
        ),
        holds=_exceptional_corners(ACCEPTABLE),
        choice=(
            "n depends on E*·ΔR only: small ΔR with low E wants a larger n, large ΔR with high E a "
            "smaller one; by this measure only the former is an exception, the highest E none"
        ),
        alternatives=(
            f"with R² > {STRICT} as the bar the highest E becomes an exception too, though with "
            f"the largest ΔR, {strict_edge / E_high:.0f} mm and more "
            + verdict_if(_exceptional_corners(STRICT))
        ),
        values=(
            {f"n at {name}, -": n for name, n in corners.items()}
            | {"largest E·ΔR of the exceptions, N/mm": low_edge}
        ),
    )


def _exceptional_corners(bar: float) -> bool:
    """Tell whether R² at n = 1.094 fails the bar in the soft, narrow and the stiff, wide corner."""
    corners = np.multiply(TRAINING_DR["external"], TRAINING_E)
    return all(_excess_r_squared(product, bar) <= 0 for product in corners)


def _excess_r_squared(product: float, bar: float = ACCEPTABLE) -> float:
    """Return R² at n = 1.094 less the bar, external contact."""
    return float(r_squared_at(N_EXTERNAL, *product_points("external", product))) - bar
