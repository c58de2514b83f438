"""Section 3.1: the fits of Fig 2 and Fig 3, and the shape chosen for the enhanced law."""

from __future__ import annotations

from cylcontact.pair import Contact
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import (
    Finding,
    agrees_as_printed,
    claim,
)

from ..paper import FIG2_DR
from ..power_fits import (
    FIG2_LOADS,
    SEARCHED_COUNTS,
    SEARCHED_STEPS,
    closest_external_window,
    fig2_fit,
    johnson_points,
    r_squared_in_force,
    reference_pair,
    stepped_loads,
)

K_UNIT = "N/mm per mmⁿ"
PRINTED: dict[Contact, tuple[str, str]] = {
    "internal": ("312148", "1.2370"),
    "external": ("44935", "1.0935"),
}
LOADS: dict[Contact, str] = {
    "internal": "1, 10, 20, …, 1000 N/mm",
    "external": "1, 100, 200, …, 10000 N/mm",
}
CASES = [
    {
        "contact": contact,
        "K": K,
        "n": n,
        "case": f"ΔR = {FIG2_DR[contact]:g} mm, 207 GPa, ν = 0.3 (Fig 2)",
    }
    for contact, (K, n) in PRINTED.items()
]
FIG2_CHOICE: dict[Contact, str] = {
    "internal": (
        f"the paper does not list its loads; {LOADS['internal']} and a straight line through "
        "(ln δ, ln f) give every printed digit of K and n at once"
    ),
    "external": (
        f"the paper does not list its loads; {LOADS['external']} is the internal recipe over "
        "a range ten times as wide. ΔR = 140 mm is the caption's: the 50 µm in the text can only "
        "be meant for the internal case"
    ),
}


@claim(
    "3.1-fig2-{contact}-K",
    "factor K of the power law fitted to Johnson's, {contact}, {case}",
    paper="{K} " + K_UNIT,
    rule="agreement to the printed digit",
    cases=CASES,
)
def fig2_factor(_bench: Bench, contact: Contact, **_case: str) -> Finding:
    """Compare K of Fig 2."""
    printed, K = PRINTED[contact][0], fig2_fit(contact).K
    return Finding(
        f"{K:.1f} {K_UNIT} ({100 * (K / float(printed) - 1):+.2f} %)",
        holds=agrees_as_printed(K, printed),
        choice=FIG2_CHOICE[contact],
        alternatives=_other_windows(contact),
        values={"K, N/mm per mm^n": K},
        paper_values={"K, N/mm per mm^n": float(printed)},
    )


@claim(
    "3.1-fig2-{contact}-n",
    "exponent n of the power law fitted to Johnson's, {contact}, {case}",
    paper="{n}",
    rule="agreement to the printed digit",
    cases=CASES,
)
def fig2_exponent(_bench: Bench, contact: Contact, **_case: str) -> Finding:
    """Compare n of Fig 2."""
    printed, n = PRINTED[contact][1], fig2_fit(contact).n
    return Finding(
        f"{n:.5f}",
        holds=agrees_as_printed(n, printed),
        choice=FIG2_CHOICE[contact],
        alternatives=_other_windows(contact),
        values={"n, -": n},
        paper_values={"n, -": float(printed)},
    )


@claim(
    "3.1-fig2-{contact}-r-squared",
    "correlation of that fit with Johnson's law, {contact}",
    paper="R² > 0.998",
    rule="R² above 0.998",
    paper_values={"R squared, -": 0.998},
    cases=CASES,
)
def fig2_correlation(_bench: Bench, contact: Contact, **_case: str) -> Finding:
    """Compare R² of Fig 2's fit, of ln f and of f."""
    fit = fig2_fit(contact)
    points = johnson_points(FIG2_LOADS[contact], reference_pair(contact, FIG2_DR[contact]))
    in_force = r_squared_in_force(fit, *points)
    in_force_too = "also" if in_force > 0.998 else "not"
    return Finding(
        f"R² = {fit.r_squared:.5f} in the log–log line",
        holds=fit.r_squared > 0.998,
        choice=f"R² of ln f about the fitted line; loads {LOADS[contact]}",
        alternatives=(
            f"R² of f itself about the same curve is {in_force:.5f}: {in_force_too} above 0.998"
        ),
        values={"R squared of ln f, -": fit.r_squared, "R squared of f, -": in_force},
    )


def _other_windows(contact: Contact) -> str:
    """Say what other load lists would give for the external case."""
    if contact == "internal":
        return ""
    K_printed, n_printed = (float(text) for text in PRINTED[contact])
    window, best = closest_external_window(n_printed, K_printed)
    internal = fig2_fit(contact, stepped_loads(1, 10, 1000))
    return (
        f"the internal case's own loads give K = {internal.K:.0f}, n = {internal.n:.4f}. Of "
        f"{len(SEARCHED_STEPS) * len(SEARCHED_COUNTS)} lists of that form (1 N/mm, then 20 to 120 "
        "steps of 10 to 500 N/mm) none gives both printed numbers; of those that give "
        f"n = {n_printed}, {window} comes closest to K, with {best.K:.1f} "
        f"({100 * (best.K / K_printed - 1):+.2f} %)"
    )
