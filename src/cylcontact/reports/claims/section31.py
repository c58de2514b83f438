"""Section 3.1: the fits of Fig 2 and Fig 3, and the shape chosen for the enhanced law."""

from __future__ import annotations

from cylcontact.pair import Contact
from cylcontact.reports.claims import section31_exponent, section31_shape
from cylcontact.reports.claims.claim import Claim, agrees_as_printed
from cylcontact.reports.claims.domain import Table
from cylcontact.reports.claims.power_fits import (
    FIG2_DR,
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

SECTION = "3.1"
K_UNIT = "N/mm per mmⁿ"
PRINTED: dict[Contact, tuple[str, str]] = {
    "internal": ("312148", "1.2370"),
    "external": ("44935", "1.0935"),
}
LOADS_TOLD: dict[Contact, str] = {
    "internal": "1, 10, 20, …, 1000 N/mm",
    "external": "1, 100, 200, …, 10000 N/mm",
}
FIG2_CHOICE: dict[Contact, str] = {
    "internal": (
        f"the paper does not list its loads; {LOADS_TOLD['internal']} and a straight line through "
        "(ln δ, ln f) give every printed digit of K and n at once"
    ),
    "external": (
        f"the paper does not list its loads; {LOADS_TOLD['external']} is the internal recipe over "
        "a range ten times as wide. ΔR = 140 mm is the caption's: the 50 µm in the text can only "
        "be meant for the internal case"
    ),
}


def claims(rows: Table) -> list[Claim]:
    """Return the claims of Section 3.1."""
    return [
        *(fig2_factor(contact) for contact in FIG2_DR),
        *(fig2_exponent(contact) for contact in FIG2_DR),
        *(fig2_correlation(contact) for contact in FIG2_DR),
        *section31_exponent.claims(SECTION),
        *section31_shape.claims(SECTION, rows),
    ]


def fig2_factor(contact: Contact) -> Claim:
    """Return K of Fig 2."""
    printed, K = PRINTED[contact][0], fig2_fit(contact).K
    return Claim(
        id=f"3.1-fig2-{contact}-K",
        section=SECTION,
        statement=f"factor K of the power law fitted to Johnson's, {contact}, {_case(contact)}",
        paper=f"{printed} {K_UNIT}",
        ours=f"{K:.1f} {K_UNIT} ({100 * (K / float(printed) - 1):+.2f} %)",
        rule="agreement to the printed digit",
        holds=agrees_as_printed(K, printed),
        choice=FIG2_CHOICE[contact],
        alternatives=_other_windows(contact),
        paper_values={"K, N/mm per mm^n": float(printed)},
        ours_values={"K, N/mm per mm^n": K},
    )


def fig2_exponent(contact: Contact) -> Claim:
    """Return n of Fig 2."""
    printed, n = PRINTED[contact][1], fig2_fit(contact).n
    return Claim(
        id=f"3.1-fig2-{contact}-n",
        section=SECTION,
        statement=f"exponent n of the power law fitted to Johnson's, {contact}, {_case(contact)}",
        paper=printed,
        ours=f"{n:.5f}",
        rule="agreement to the printed digit",
        holds=agrees_as_printed(n, printed),
        choice=FIG2_CHOICE[contact],
        alternatives=_other_windows(contact),
        paper_values={"n, -": float(printed)},
        ours_values={"n, -": n},
    )


def fig2_correlation(contact: Contact) -> Claim:
    """Return R² of Fig 2's fit, of ln f and of f."""
    fit = fig2_fit(contact)
    points = johnson_points(FIG2_LOADS[contact], reference_pair(contact, FIG2_DR[contact]))
    in_force = r_squared_in_force(fit, *points)
    told = "also" if in_force > 0.998 else "not"
    return Claim(
        id=f"3.1-fig2-{contact}-r-squared",
        section=SECTION,
        statement=f"correlation of that fit with Johnson's law, {contact}",
        paper="R² > 0.998",
        ours=f"R² = {fit.r_squared:.5f} in the log–log line",
        rule="R² above 0.998",
        holds=fit.r_squared > 0.998,
        choice=f"R² of ln f about the fitted line; loads {LOADS_TOLD[contact]}",
        alternatives=f"R² of f itself about the same curve is {in_force:.5f}: {told} above 0.998",
        paper_values={"R squared, -": 0.998},
        ours_values={"R squared of ln f, -": fit.r_squared, "R squared of f, -": in_force},
    )


def _case(contact: Contact) -> str:
    """Describe Fig 2's case."""
    return f"ΔR = {FIG2_DR[contact]:g} mm, 207 GPa, ν = 0.3 (Fig 2)"


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
