"""Section 3.1: the fits of Fig 2, and how the exponent n varies (Fig 3)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cylcontact.bodies.pair import Contact
from cylcontact.fitting.power_fit import PowerFit
from cylcontact.laws import Enhanced
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, Reading, agrees_as_printed, claim
from cylcontact.support.arrays import FloatArray

from .. import paper
from ..load_lists import WIDER_FOUND, WIDER_SEARCH, expected_matches, external_matches
from ..paper import WINDOW, Interval
from ..power_fits import (
    FIG2_LOADS,
    ends_spread,
    fig2_fit,
    fit_at,
    johnson_points,
    r_squared,
    r_squared_at,
    reference_pair,
)
from ..readings import found, reading
from ..searched_readings import IF_MISPRINT, on_samples

K_UNIT = "N/mm per mmⁿ"
LOADS: dict[Contact, str] = {
    "internal": "loads of 1, 10, 20, …, 1000 N/mm",
    "external": "loads of 1, 100, 200, …, 10000 N/mm",
}
ALL_DIGITS = "these loads give every printed digit of K and n at once"
FIG2_CASES = [
    {
        "contact": contact,
        "K": K,
        "n": n,
        "dR": f"{paper.FIG2_DR[contact]:g}",
    }
    for contact, (K, n) in paper.FIG2_FITS.items()
]


@claim(
    "3.1-fig2-{contact}",
    "the power law fitted to Johnson's at ΔR = {dR} mm, 207 GPa and ν = 0.3 has these constants "
    "({contact} contact)",
    paper="K = {K} " + K_UNIT + ", n = {n}",
    rule="both equal to the printed digit",
    figures=("fig02",),
    cases=FIG2_CASES,
)
def fig2_constants(contact: Contact, K: str, n: str) -> Finding:
    """Return K and n of Fig 2's fit over several lists of loads."""
    fits: dict[str, PowerFit] = {}
    told, values = "", {}
    internal = contact == "internal"
    if not internal:
        _, matches = external_matches()
        fits = {f"{name} (found by search)": fit for name, fit in list(matches.items())[:1]}
        alike = "1, 10, 20, …, 1000 N/mm, as in the internal case"
        fits[alike], expected = fig2_fit(contact, FIG2_LOADS["internal"]), expected_matches()
        values = {"lists expected by chance, -": expected}
        told = (
            f"; a search of {WIDER_SEARCH} lists of loads found {WIDER_FOUND} that give both "
            f"printed numbers, about as many as chance would ({expected:.1f} expected)"
        )

    def of(choice: str, fit: PowerFit, missing: str = WINDOW) -> Reading:
        met = agrees_as_printed(fit.K, K) and agrees_as_printed(fit.n, n)
        off = f"K {100 * (fit.K / float(K) - 1):+.3f} %, n {100 * (fit.n / float(n) - 1):+.3f} %"
        return reading(choice, f"K = {fit.K:.1f} {K_UNIT}, n = {fit.n:.5f}", met, off, missing)

    missing = "" if internal else WINDOW
    own = of(f"{LOADS[contact]}, line through (ln δ, ln f)", fig2_fit(contact), missing)
    if internal:
        own = replace(own, ground=ALL_DIGITS)
    return found(
        [own, *(of(loads, fit, missing) for loads, fit in fits.items())],
        f"{own.ours}{f' ({own.miss})' if own.miss else ''} with {LOADS[contact]}{told}",
        values={"K, N/mm per mm^n": fig2_fit(contact).K, "n, -": fig2_fit(contact).n, **values},
        paper_values={"K, N/mm per mm^n": float(K), "n, -": float(n)},
    )


def r_squared_of_law(load: FloatArray, contact: Contact, dR: float) -> float:
    """Return R² of ln f of the published law against Johnson's at ΔR in mm and 207 GPa."""
    pair = reference_pair(contact, dR)
    inside, delta = johnson_points(load, pair)
    return r_squared(np.log(inside), np.log(Enhanced().load(delta, pair)))


# --- Fig 3: the exponent over clearance and material -------------------------------------------

N_EXTERNAL = 1.094
E_TO_1000 = (paper.TRAINING_E[0], 1000e3)
FIG3_LOADS = "41 loads from 10 to 1000 N/mm, spaced logarithmically"


def sensitivity_ratios(contact: Contact) -> tuple[float, dict[str, float]]:
    """Return the spread of n over ΔR by that over E: of equal changes, and of ranges.

    The spread over ΔR is at 207 GPa. Johnson's law knows ΔR and E only through E*·ΔR, so equal
    relative changes of either change n alike.
    """
    low, high = paper.TRAINING_DR[contact]
    E, more, centre = paper.E_REFERENCE, 1.01, float(np.sqrt(low * high))

    def spread(dR: Interval, E: Interval) -> float:
        ends = [fit_at(contact, *end, paper.TRAINING_LOADS).n for end in zip(dR, E, strict=True)]
        return ends_spread((ends[0], ends[1]))

    equal = spread((centre, centre * more), (E, E)) / spread((centre, centre), (E, E * more))
    over_dR = spread((low, high), (E, E))
    ranges = {"20.7 to 10000 GPa": paper.TRAINING_E, IF_MISPRINT: E_TO_1000}
    return equal, {
        f"E over {name}, at ΔR = {dR:.3g} mm": over_dR / spread((dR, dR), moduli)
        for name, moduli in ranges.items()
        for dR in (low, centre, high)
    }


def sensitivity(contact: Contact, bounds: Interval) -> Finding:
    """Judge the ratio of the spreads of n over ΔR and over E by its bounds."""
    equal, ratios = sensitivity_ratios(contact)

    def miss(ratio: float) -> str:
        nearest = float(np.clip(ratio, *bounds))
        return "" if nearest == ratio else f"{abs(ratio - nearest):.2f} from {nearest:g}"

    printed = {name: ratio for name, ratio in ratios.items() if IF_MISPRINT not in name}
    return Finding(
        f"equal relative changes of ΔR and E change n alike (ratio {equal:.3f}); over the full "
        f"ranges of the fit the spread of n over ΔR is {min(printed.values()):.2f} to "
        f"{max(printed.values()):.2f} times that over E, depending on the ΔR held (with E to 1000 "
        f"GPa, if 10000 is a misprint, up to {max(ratios.values()):.2f} times)",
        holds=not miss(equal),
        choice=f"equal relative changes; {FIG3_LOADS}",
        miss=miss(equal),
        alternatives=[
            reading(
                name,
                f"ratio {ratio:.2f}",
                not miss(ratio),
                miss(ratio),
                ground="Fig 3 shows the whole ranges",
            )
            for name, ratio in printed.items()
        ],
        values={"ratio of equal changes, -": equal}
        | {f"ratio {name}, -": ratio for name, ratio in ratios.items()},
    )


@claim(
    "3.1-fig3-internal-sensitivity",
    "for internal contact n depends on the elastic constants far less than on ΔR (Fig 3a)",
    paper="much lower sensitivity to the material",
    rule="the spread of n over ΔR is at least twice that over E (twice is ours)",
    figures=("fig03",),
)
def fig3_internal_sensitivity() -> Finding:
    """Return the spreads of n over ΔR and over E for internal contact."""
    return sensitivity("internal", (2, np.inf))


MOST = 50.0  # percent of the ranges
N_TRIED = np.round(np.arange(1.05, 1.3005, 0.001), 3)


def training_box(contact: Contact) -> tuple[FloatArray, FloatArray]:
    """Return R² of ln f for every n tried along the training box, and the part of the box at each.

    Johnson's law knows the pair only through E*·ΔR once the loads are given, so the box of ΔR and
    E is sampled along that product, from corner to corner. R² has the shape (product, n); the
    parts, on logarithmic axes, sum to 100 %.
    """
    sides = np.array([paper.TRAINING_DR[contact], paper.TRAINING_E])
    low, high = np.log(sides.prod(axis=0))
    s = np.linspace(low, high, 1001)
    # The lengths of the lines ln E + ln ΔR = s inside the rectangle: a trapezium.
    length = np.minimum(np.minimum(s - low, high - s), np.diff(np.log(sides)).min())
    r_squared = [r_squared_at(N_TRIED, *product_points(contact, each)) for each in np.exp(s)]
    return np.array(r_squared), 100 * length / length.sum()


def product_points(contact: Contact, product: float) -> tuple[FloatArray, FloatArray]:
    """Return loads and penetrations of a pair with E·ΔR as given, at the reference modulus."""
    pair = reference_pair(contact, product / paper.E_REFERENCE)
    return johnson_points(paper.TRAINING_LOADS, pair)


CORRELATES = f"correlates means R² > {paper.GOOD_CORRELATION} of ln f"


def served(contact: Contact, n: float | None = None) -> tuple[float, float]:
    """Return an exponent and the percentage of the box that it serves.

    Takes the n that serves most of the box unless one is given.
    """
    r_squared, part = training_box(contact)
    share = part @ (r_squared > paper.GOOD_CORRELATION)
    best = int(np.argmax(share) if n is None else np.argmin(np.abs(N_TRIED - n)))
    return float(N_TRIED[best]), float(share[best])


@claim(
    "3.1-internal-no-single-n",
    "for internal contact no single exponent serves all clearances and materials",
    paper="not possible",
    rule="none correlates everywhere in the ranges of the fit",
    figures=("fig03",),
)
def internal_no_single_n() -> Finding:
    """Return how much of the internal training box the best single exponent serves."""
    n, share = served("internal")
    missed = "" if share < 100 else f"one n serves {share:.0f} %, not below 100 %"
    choice = f"{CORRELATES}, with the best K for that n; shares on logarithmic axes"
    own = reading(choice, f"n = {n:.3f} serves {share:.0f} %", not missed, missed, WINDOW)
    return found(
        [own],
        f"the best single exponent, n = {n:.3f}, serves {share:.0f} % of the ranges",
        values={"best n, -": n, "served, percent": share},
    )


@claim(
    "3.1-external-single-n",
    "for external contact n = 1.094 is acceptable for most geometries and materials",
    paper="most",
    rule="it correlates over more than half of the ranges of the fit",
    figures=("fig03",),
)
def external_single_n(bench: Bench) -> Finding:
    """Return how much of the external training box n = 1.094 serves, and where a search ends."""
    samples = on_samples(bench, "external, n free")
    searched = {name: float(rows["value"]["n"]) for name, rows in samples.items()}
    _, share = served("external", N_EXTERNAL)
    missed = "" if share > MOST else f"{MOST - share:.0f} points below half"
    choice = f"{CORRELATES}, with the best K everywhere; shares on logarithmic axes"
    own = reading(choice, f"serves {share:.1f} %", not missed, missed, WINDOW)
    return found(
        [own],
        f"n = {N_EXTERNAL} serves {share:.1f} % of the ranges; a search of a, b and n ends at "
        f"n = {min(searched.values()):.3f} to {max(searched.values()):.3f}, by the samples",
        values={"served, percent": share}
        | {f"n searched, {name}, -": n for name, n in searched.items()},
    )
