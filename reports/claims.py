"""What the paper claims and what we find: the claims that its readers rely on."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import brentq
from scipy.special import lambertw

from cylcontact import limits
from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import CylinderPair
from cylcontact.datasets.finite_element import read_table, solve
from cylcontact.fitting.results import LawFit
from cylcontact.laws import (
    Enhanced,
    InternalCoefficients,
    Johnson,
    LankaraniNikravesh,
    difference_percent,
)
from cylcontact.reports.claims import Interpretation, claim
from cylcontact.support.arrays import BoolArray, FloatArray

from .elements import FIG_6_LOADS, FIG_6_WIDE, FOLDER, LAWS_OF_FIG_6, compared, setup
from .fits import DR, FIG_2, exponents, fit_power
from .fits import LOADS as FIT_LOADS
from .paper import CLEARANCES, JOHNSON_LIMITS, LOADS, MATERIALS, RADII, STEEL

# The paper gives no bounds for "moderate", "low" and "high", nor the spacing of its axes. Ours: the
# middle half of an axis is moderate, be it logarithmic or even.
AXES = {"logarithmic": np.geomspace, "even": np.linspace}
LOW_LOAD, HIGH_LOAD = np.geomspace(*LOADS, 5)[[1, 3]]  # 31.6 and 316 N/mm
STARTS = 1 - 1e-12  # just inside the end of Johnson's law


# --- Section 2: Johnson's law ---------------------------------------------------------------------


@claim("1, 2", "iteration", "a numerical iterative technique is required")
def johnson_needs_iteration() -> Iterator[Interpretation]:
    """Johnson's law gives the load for a penetration by iteration only."""
    pair = CylinderPair.from_dR("internal", 0.05, STEEL)
    depth = Johnson().penetration(LOADS[1], pair)
    argument = -np.e * depth / (4 * pair.dR)
    load = np.pi * pair.E_star * depth / -lambertw(argument, -1).real
    error = max(float(abs(load / LOADS[1] - 1)), np.finfo(float).eps)
    closed = "f = π E* δ/(−W₋₁(−e δ/(4ΔR)))"
    yield "in closed form by Lambert's W", f"{closed}, right to {error:.0e}", False
    yield "a program computes W itself by corrections of a guess", "one Halley step suffices", True


@claim("abstract", "well correlated", "the forces predicted … are well correlated")
def well_correlated() -> Iterator[Interpretation]:
    """Within the domain of Johnson's law, the enhanced law predicts well correlated forces."""
    worst = min((r_squared(body), name) for name, body in MATERIALS.items())
    said = f"R² of ln f at least {worst[0]:.4f} ({worst[1]})"
    yield "R² ≥ 0.99 over Figs 10 to 14", said, worst[0] >= 0.99
    dR, load, percent = force_difference(MATERIALS[worst[1]])
    most = f"up to {percent:+.0f} % at ΔR = {dR:.3g} mm and {load:.0f} N/mm ({worst[1]})"
    yield "forces within 10 % at equal penetration", most, abs(percent) < 10


def r_squared(body: Material) -> float:
    """Return R² of ln f of the enhanced law against Johnson's, over the window of Figs 10 to 14."""
    pair, load, _ = window(body)
    force = Enhanced().load(Johnson().penetration(load, pair), pair)
    return float(
        1 - np.sum(np.log(force / load) ** 2) / np.sum((np.log(load) - np.log(load).mean()) ** 2)
    )


def force_difference(body: Material) -> tuple[float, float, float]:
    """Return ΔR, the load and the difference in percent where the forces differ most."""
    pair, load, dR = window(body)
    percent = 100 * (Enhanced().load(Johnson().penetration(load, pair), pair) / load - 1)
    at = np.unravel_index(np.abs(percent).argmax(), percent.shape)
    return float(dR[at]), float(load[at]), float(percent[at])


@claim("1, 5", "exceeds", "a range of applications that exceeds that of the Johnson contact model")
def wider_range() -> Iterator[Interpretation]:
    """The enhanced law can be used where Johnson's cannot."""
    spans = {"Figs 10 to 14": CLEARANCES, "Figs 7 to 9": (0.001, 2.0)}
    for (name, ends), (axes, spaced) in product(spans.items(), AXES.items()):
        dR, load = np.meshgrid(spaced(*ends, 401), spaced(*LOADS, 201))
        shares = {"enhanced": 0.0, "Johnson": 0.0}
        for body in MATERIALS.values():
            pair = CylinderPair.from_dR("internal", dR, body)
            laws = {"enhanced": Enhanced(), "Johnson": Johnson()}
            for law, defined in laws.items():
                inside = np.isfinite(defined.penetration(load, pair)).mean()
                shares[law] += 100 * float(inside) / len(MATERIALS)
        said = f"defined over {shares['enhanced']:.2f} % against {shares['Johnson']:.2f} %"
        how = f"clearances of {name}, 10 to 1000 N/mm, {axes} axes"
        yield how, said, shares["enhanced"] > shares["Johnson"]


# --- Section 3.1: the fit -------------------------------------------------------------------------


def fit_of_fig_2(contact: str, dR: float, loads: FloatArray, K: str, n: str) -> Interpretation:
    pair = CylinderPair.from_dR(contact, dR, STEEL)
    fit = fit_power(loads, Johnson().penetration(loads, pair))
    met = f"{fit.K:.0f}" == K and f"{fit.n:.4f}" == n
    how = f"loads 1, {loads[1]:g}, {loads[2]:g}, … {loads[-1]:g} N/mm"
    return how, f"K = {fit.K:.1f}, n = {fit.n:.5f}", met


@claim("3.1", "K = 312148, n = 1.2370", "the best fit for internal cylindrical contact")
def fig_2_internal() -> Iterator[Interpretation]:
    """A power law fitted to Johnson's at ΔR = 50 µm has these constants (pin in a hole)."""
    yield fit_of_fig_2("internal", *FIG_2["internal"], "312148", "1.2370")


@claim("3.1", "K = 44935, n = 1.0935", "for external cylindrical contact")
def fig_2_external() -> Iterator[Interpretation]:
    """A power law fitted to Johnson's at ΔR = 140 mm has these constants (rollers)."""
    dR, loads = FIG_2["external"]
    yield fit_of_fig_2("external", dR, FIG_2["internal"][1], "44935", "1.0935")
    yield fit_of_fig_2("external", dR, loads, "44935", "1.0935")


@claim(
    "3.1",
    "quite sensitive, much lower",
    "quite sensitive to ΔR … much lower sensitivity to the elastic",
)
def exponent_of_holes() -> Iterator[Interpretation]:
    """In a hole the exponent depends on ΔR much more than on the elastic properties."""
    table = exponents("internal", np.geomspace(*DR["internal"], 21))
    steel = table[(table["E_GPa"] == 207.0) & (table["nu"] == 0.3)]["n"]
    over_dR = float(np.ptp(steel))
    at_0_3 = table[table["nu"] == 0.3]
    of_elasticity = {
        "ν from 0.1 to 0.5": table[table["E_GPa"] == 207.0],
        "E from 69 to 600 GPa, as in Figs 10 to 14": at_0_3[at_0_3["E_GPa"].between(69, 600)],
        "E from 20.7 to 10000 GPa, as in Section 3.1": at_0_3,
    }
    for what, rows in of_elasticity.items():
        spread = rows.groupby("dR_mm")["n"].agg(np.ptp)
        said = f"spread over ΔR {over_dR:.3f}, over these {spread.min():.3f} to {spread.max():.3f}"
        yield f"{what}, less than half at every ΔR", said, 2 * spread.max() < over_dR
        middle = spread.iloc[len(spread) // 2]
        how = f"{what}, less than half at {spread.index[len(spread) // 2]:.2g} mm"
        yield how, f"spread over ΔR {over_dR:.3f}, over these {middle:.3f}", 2 * middle < over_dR
    same = "the same: Johnson's law depends on E*·ΔR/f alone"
    yield "equal relative changes of E and ΔR", same, False


@claim("3.1", "n = 1.094", "acceptable correlations for most of the values")
def one_exponent_for_rollers() -> Iterator[Interpretation]:
    """For rollers one exponent serves most of the geometries and materials."""
    for spacing, spaced in AXES.items():
        table = exponents("external", spaced(*DR["external"], 21))
        of_logarithm, of_load = np.transpose([r_squared_of_line(row) for row in table.itertuples()])
        for what, r2 in {"ln f": of_logarithm, "f": of_load}.items():
            share = 100 * float(np.mean(r2 > 0.998))
            how = f"R² of {what} > 0.998, as in Fig 2, with the best K, {spacing} ΔR"
            yield how, f"in {share:.1f} % of the cases", share > 50


def r_squared_of_line(case: Any) -> tuple[float, float]:
    """Return R² of ln f and of f for n = 1.094 and the K that is best for ln f, of one case."""
    body = Material("any", 1e3 * case.E_GPa, case.nu)
    pair = CylinderPair.from_dR("external", case.dR_mm, body)
    load = FIT_LOADS[FIT_LOADS <= Johnson().max_load(pair)]
    misfit = np.log(load) - 1.094 * np.log(Johnson().penetration(load, pair))
    off = misfit.mean() - misfit  # of ln f
    return (
        float(1 - np.sum(off**2) / np.sum((np.log(load) - np.log(load).mean()) ** 2)),
        float(1 - np.sum((load * np.expm1(off)) ** 2) / np.sum((load - load.mean()) ** 2)),
    )


@claim("3.1", "linear, internal", "we assume that K* and ΔR are linearly related")
def K_star_of_holes_is_linear() -> Iterator[Interpretation]:
    """For a pin in a hole K* = K·ΔR/E* grows linearly with ΔR."""
    yield from K_star_is_linear("internal")


@claim("3.1", "linear, external", "we assume that K* and ΔR are linearly related")
def K_star_of_rollers_is_linear() -> Iterator[Interpretation]:
    """For rollers K* = K·ΔR/E* grows linearly with ΔR."""
    yield from K_star_is_linear("external")


def K_star_is_linear(contact: str) -> Iterator[Interpretation]:
    for spacing, spaced in AXES.items():
        dR = spaced(*DR[contact], 47)
        pair = CylinderPair.from_dR(contact, dR, STEEL)
        fits = exponents(contact, dR)
        steel = fits[(fits["E_GPa"] == 207.0) & (fits["nu"] == 0.3)]
        K_star = steel["K_N_per_mm_n"].to_numpy() * dR / pair.E_star
        line = np.polynomial.Polynomial.fit(dR, K_star, 1)(dR)
        worst = 100 * float(np.abs(line / K_star - 1).max())
        r2 = float(np.corrcoef(line, K_star)[0, 1] ** 2)
        yield f"steel, {spacing} ΔR, R² > 0.998", f"R² = {r2:.4f}", r2 > 0.998
        how = f"steel, {spacing} ΔR, within 10 % everywhere"
        yield how, f"off by up to {worst:.0f} %", worst < 10


@claim("3.1", "0.34954 mm", "if ΔR ∈ [0.34954, 10.0[ mm")
def switch_of_Y() -> Iterator[Interpretation]:
    """Y passes from its first branch to its second at this clearance (Eq 6d)."""
    c = InternalCoefficients()

    def gap(dR: float) -> float:
        return c.Y_log_scale * np.log(1000 * dR) ** c.Y_log_exponent - c.Y_slope * dR - c.Y_offset

    where = brentq(gap, 0.05, 2.0, xtol=1e-15)
    yield "where the two branches are equal", f"{where:.7f} mm", f"{where:.5f}" == "0.34954"


@claim("3.1", "best correlation", "the best is assumed to be the global minimum")
def best_correlation() -> Iterator[Interpretation]:
    """The published coefficients are the best fit to Johnson's law."""
    for name in ("internal", "internal-E1000", "external", "external-E1000"):
        fit = LawFit.read(f"fitting/results/{name}.json")
        ratio = fit.published.objective / fit.objective.value
        said = f"the published rms is {ratio:.2f} times the least"
        yield f"samples of fitting/{name}.toml", said, ratio < 1.05


@claim("3.1", "Eq 6", "solved by using a genetic optimization")
def search_returns_the_coefficients() -> Iterator[Interpretation]:
    """A search over the ranges of Section 3.1 finds the published coefficients."""
    table = pd.read_csv("fitting/results/choices.csv", comment="#", keep_default_na=False)
    keys = ["contact", "way", "given", "end_mm"]
    for row in table.drop_duplicates(keys).itertuples():
        more = row.given or (f"to {row.end_mm} mm" if row.end_mm else "")
        how = f"{row.contact}, {row.way}{', ' if more else ''}{more}: all within 5 %"
        said = (
            f"{row.all_within_5_percent:,} of {row.fits:,} fits; the nearest has them within "
            f"{row.nearest_percent:.3g} %"
        )
        yield how, said, row.all_within_5_percent > row.fits / 2


# --- Section 3.2: finite elements -----------------------------------------------------------------


@claim("3.2", "< 10 %, and < 3 % above 0.445 mm", "differ from each other by less than 10 %")
def laws_agree() -> Iterator[Interpretation]:
    """The enhanced law and Johnson's differ by less than this from 5 µm to 1.5 mm (Fig 6)."""
    dR = np.geomspace(0.005, 1.5, 4001)
    pair = CylinderPair.from_dR("internal", dR, STEEL)
    for load in FIG_6_LOADS:
        off = np.abs(difference_percent(Enhanced(), Johnson(), load, pair))
        most, wide = off.max(), off[dR >= FIG_6_WIDE].max()
        yield f"{load:g} N/mm", f"{most:.1f} % and {wide:.1f} %", most < 10 and wide < 3


@claim("3.2", "< 10 %, and < 3 % above 0.445 mm", "differ from each other by less than 10 %")
def laws_and_elements_agree() -> Iterator[Interpretation]:
    """Finite elements differ from both laws by less than this from 5 µm to 1.5 mm (Fig 6)."""
    words = {"paper": "plane stress, load on the centre nodes", "recommended": "plane strain"}
    for study, law in product(words, ("johnson", "enhanced")):
        table = compared(study)
        off = 100 * (table[f"{law}_mm"] / table["embedded_mm"] - 1)
        wide = off[table["dR_mm"] >= FIG_6_WIDE].abs().max()
        how = f"{LAWS_OF_FIG_6[law][0]}, {words[study]}, 20 to 100 N/mm"
        met = bool(off.abs().max() < 10 and wide < 3)
        said = f"{off.min():+.1f} to {off.max():+.1f} %, {wide:.1f} % above"
        if study == "recommended" and law == "johnson":
            # The outer radius of the plate is chosen so that this law agrees.
            yield f"{how}, by construction", said, None
        else:
            yield how, said, met


@claim("3.2", "Hertz, 1 mm", "the Hertz elastic contact theory can still be applied")
def hertz_applies_at_1_mm() -> Iterator[Interpretation]:
    """At ΔR = 1 mm the contact stress is Hertz's."""
    yield from hertz_pressure_applies(1.0)


@claim("3.2", "Hertz, 0.01 mm", "the Hertz elastic contact theory can still be applied")
def hertz_applies_at_10_um() -> Iterator[Interpretation]:
    """At ΔR = 0.01 mm the contact stress is Hertz's."""
    yield from hertz_pressure_applies(0.01)


def hertz_pressure_applies(dR: float) -> Iterator[Interpretation]:
    for load in FIG_6_LOADS:
        (case,) = solve(setup(), dR, [load])
        hertz = limits.hertz_pressure(case.arc, load, case.setup.pair(dR))
        off = 100 * float(np.abs(case.pressure - hertz).max() / hertz.max())
        peak = 100 * float(case.peak_pressure / hertz.max() - 1)
        said = f"peak {peak:+.1f} %, anywhere {off:.0f} % of the peak"
        yield f"{load:g} N/mm, plane strain, peak within 3 %", said, abs(peak) < 3


@claim("3.2", "no change", "further mesh refinements do not alter the results")
def mesh_is_fine_enough() -> Iterator[Interpretation]:
    """Finer elements do not change the result."""
    rows = read_table(f"{FOLDER}/sensitivity-embedded.csv").rows.set_index("variant")
    for words, coarse, fine in (
        (
            "load on the centre node, as in the paper",
            "load at the centre node",
            "the same on 32 cells",
        ),
        ("load spread over the pin", "base", "32 cells instead of 16"),
    ):
        for column, what in (("peak_pressure_MPa", "pressure"), ("penetration_mm", "penetration")):
            change = rows.loc[fine, column].to_numpy() / rows.loc[coarse, column].to_numpy() - 1
            most = 100 * float(np.abs(change).max())
            yield f"{what}, {words}, within 0.5 %", f"changes by {most:.2f} %", most < 0.5


# --- Section 3.3: limits --------------------------------------------------------------------------


@claim("3.3", "with yield stress", "plastic deformation … increases … with yield stress value")
def plastic_deformation_with_strength() -> Iterator[Interpretation]:
    """Within Johnson's law a higher yield stress makes plastic deformation more likely (Fig 9)."""
    dR = np.geomspace(0.001, 2.0, 401)
    for R_i in RADII:
        shares = []
        for factor in (1.0, 1.5):
            above = [
                limits.stress_at_johnson_limit(CylinderPair.from_dR("internal", dR, body, R_i=R_i))
                > factor * float(body.yield_stress or np.nan)
                for body in MATERIALS.values()
            ]
            shares.append(100 * float(np.mean(above)))
        said = f"Hertz's pressure above it at {shares[0]:.0f} % of the clearances of Fig 9, then at"
        said += f" {shares[1]:.0f} %"
        yield f"R_i = {R_i:g} mm, half as much yield stress again", said, shares[1] > shares[0]


@claim("3.3", "below the curve", "cannot exceed the yield stress of the material")
def no_yield_below_fig_7() -> Iterator[Interpretation]:
    """Nothing yields below the curves of Fig 7, where Hertz's peak pressure is the yield stress."""
    dR = np.geomspace(0.001, 2.0, 21)
    bodies = product(MATERIALS.values(), RADII)
    pairs = [CylinderPair.from_dR("internal", dR, body, R_i=R_i) for body, R_i in bodies]
    curves = np.array([limits.yield_load(pair, "Hertz") for pair in pairs])
    for criterion in ("von Mises", "Tresca"):
        exact = np.array([limits.yield_load(pair, criterion) for pair in pairs])
        share, least = (exact / curves).min(), exact[exact < curves].min()
        yield criterion, f"first yield at {share:.2g} of the curve's load", share >= 1
        how = f"{criterion}, loads up to {LOADS[1]:g} N/mm"
        yield how, f"where it is below the curve, from {least:.0f} N/mm on", least >= LOADS[1]


# --- Section 3.4: the difference of the two laws --------------------------------------------------


@claim(
    "3.4", "494 N/mm at 7.5 µm, 658 N/mm at 10 µm", "the maximum allowable loads are 494 and 658"
)
def limits_in_proportion() -> Iterator[Interpretation]:
    """The largest load of Johnson's law grows with the clearance as Eq 8 says (aluminium)."""
    by_dR = {dR: load for (name, dR), load in JOHNSON_LIMITS.items() if "aluminium" in name}
    per_E_star = {dR: 4 * np.pi * dR / np.e**2 for dR in by_dR}
    least = max((load - 0.5) / per_E_star[dR] for dR, load in by_dR.items())
    most = min((load + 0.5) / per_E_star[dR] for dR, load in by_dR.items())
    said = f"E* from {least:.0f} to {most:.0f} MPa, as for E = 69 GPa, ν = 0.33"
    yield "one E* gives both as printed", said, least < most


@claim(
    "3.4",
    "most materials",
    "still valid for the lowest clearance … for the majority of material types",
)
def johnson_valid_at_1000() -> Iterator[Interpretation]:
    """At the least clearance 1000 N/mm is within Johnson's law, but for aluminium and titanium."""
    ends = {
        name: float(
            limits.johnson_limit_load(CylinderPair.from_dR("internal", CLEARANCES[0], body))
        )
        for name, body in MATERIALS.items()
    }
    short = sorted(name for name, end in ends.items() if end < LOADS[1])
    said = ", ".join(f"{name} {end:.0f}" for name, end in ends.items())
    met = short == ["aluminium alloy", "titanium alloy"]
    yield "Eq 8 at ΔR = 7.5 µm", f"{said} N/mm", met


def window(
    body: Material,
    loads: tuple[float, float] = LOADS,
    from_dR: float = CLEARANCES[0],
    R_i: float = 0.0,
) -> tuple[CylinderPair, FloatArray, FloatArray]:
    """Return pairs, loads and clearances up to Johnson's end and, with an R_i, to Eq 7's yield."""
    dR = np.geomspace(from_dR, CLEARANCES[1], 401)[:, None]
    pair = CylinderPair.from_dR("internal", dR, body, R_i=R_i or None)
    top = np.minimum(limits.johnson_limit_load(pair), loads[1])
    if R_i:
        top = np.minimum(top, limits.yield_load(pair, "Hertz"))
    load = loads[0] * (top / loads[0]) ** np.linspace(0, STARTS, 201)
    load = np.where(top > loads[0], load, np.nan)
    return pair, load, np.broadcast_to(dR, load.shape)


def largest(
    name: str,
    loads: tuple[float, float] = LOADS,
    from_dR: float = CLEARANCES[0],
    R_i: float = 10.0,
    without_corners: str = "",
) -> float:
    """Return the difference (Eq 9) of a material that is largest in magnitude, in percent.

    Over all of the window, or without its corners on axes of this spacing.
    """
    pair, load, dR = window(MATERIALS[name], loads, from_dR, R_i)
    percent = difference_percent(Enhanced(), Johnson(), load, pair)
    counts = np.isfinite(percent)
    if without_corners:
        counts &= ~in_a_corner(name, dR, load, AXES[without_corners])
    return float(max(percent[counts], key=abs))


def in_a_corner(
    name: str, dR: FloatArray, load: FloatArray, spaced: Callable[..., FloatArray]
) -> BoolArray:
    """Return where Section 3.4 sees no practical application, or excepts high loads."""
    low, high = spaced(*LOADS, 5)[[1, 3]]
    small, large = spaced(*CLEARANCES, 5)[[1, 3]]
    corner = (dR < small) & ((load < low) | (load > high))
    corner |= (dR > large) & (load > high)
    of_material = {"ceramics": load < low, "aluminium alloy": load > high}
    return corner | of_material.get(name, False)


def by_material(**settings: object) -> dict[str, float]:
    return {name: largest(name, **settings) for name in MATERIALS}  # type: ignore[arg-type]


def said_of(percents: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {percent:+.1f}" for name, percent in percents.items()) + " %"


def all_below(bound: float, percents: Mapping[str, float]) -> bool:
    return max(map(abs, percents.values())) < bound


@claim("3.4", "< 8 %", "differences lower than 8 % for the range of conditions with practical")
def below_8_percent() -> Iterator[Interpretation]:
    """The two laws differ by less than 8 % in conditions with practical applications."""
    whole = by_material()
    yield "all of Figs 10 to 14 up to yield (R_i = 10 mm)", said_of(whole), all_below(8, whole)
    for axes in AXES:
        inner = by_material(without_corners=axes)
        how = f"without corners (i) to (iv) and high loads at small clearances, {axes} axes"
        yield how, said_of(inner), all_below(8, inner)


MODERATE = {
    "32 to 316 N/mm, the middle half of a logarithmic axis": (LOW_LOAD, HIGH_LOAD),
    "258 to 752 N/mm, the middle half of an even axis": (257.5, 752.5),
    "20 to 100 N/mm, the loads of Section 3.2": (20.0, 100.0),
}


@claim("3.4", "< 4 %", "lower than 4 % for moderate loads")
def below_4_percent() -> Iterator[Interpretation]:
    """At moderate loads they differ by less than 4 %, whatever the material."""
    for how, loads in MODERATE.items():
        percents = by_material(loads=loads, from_dR=0.05)
        yield f"{how}, ΔR from 50 µm on", said_of(percents), all_below(4, percents)


@claim("5", "< 10 %", "under moderate load values, maximum differences lower than 10 %")
def below_10_percent() -> Iterator[Interpretation]:
    """In practical applications at moderate loads the two laws differ by less than 10 %."""
    for words, from_dR in {"from 50 µm, as in the fit": 0.05, "from 7.5 µm": CLEARANCES[0]}.items():
        for how, loads in MODERATE.items():
            percents = by_material(loads=loads, from_dR=from_dR)
            yield f"{how}, ΔR {words}", said_of(percents), all_below(10, percents)


@claim("3.4", "about 8 % at 25 µm", "with a maximum value of about 8 %")
def about_8_percent_at_25_um() -> Iterator[Interpretation]:
    """Around 25 µm and at moderate loads the difference has a maximum of about 8 %."""
    load = np.geomspace(LOW_LOAD, HIGH_LOAD, 401)
    at_25, lowest = [], []
    for body in MATERIALS.values():
        pair = CylinderPair.from_dR("internal", 0.025, body)
        at_25.append(difference_percent(Enhanced(), Johnson(), load, pair))
        pair, loads, dR = window(body, (LOW_LOAD, HIGH_LOAD))
        percent = difference_percent(Enhanced(), Johnson(), loads, pair)
        at = np.unravel_index(np.nanargmin(percent), percent.shape)
        lowest.append((float(percent[at]), float(dR[at])))
    most = float(np.abs(at_25).max())
    yield "exactly at 25 µm", f"{most:.1f} %", round(most) == 8
    percent, dR = min(lowest)
    yield (
        "the maximum, wherever it is",
        f"{percent:.1f} % at {1e3 * dR:.0f} µm",
        round(-percent) == 8,
    )


@claim("3.4", "grows", "an undesirable increase on the difference … corresponding to high loads")
def grows_at_small_clearances() -> Iterator[Interpretation]:
    """At small clearances and high loads the difference grows, the more the softer the material."""
    growths = {}
    for name, body in MATERIALS.items():
        pair = CylinderPair.from_dR("internal", CLEARANCES[0], body)
        top = min(float(limits.johnson_limit_load(pair)), LOADS[1]) * STARTS
        half, whole = difference_percent(Enhanced(), Johnson(), [top / 2, top], pair)
        growths[name] = float(abs(whole) - abs(half))
    others = [growth for name, growth in growths.items() if name != "ceramics"]
    said = ", ".join(f"{name} {growth:+.0f}" for name, growth in growths.items())
    how = "at 7.5 µm, from half the largest load to all of it, all but ceramics"
    yield how, f"{said} points", min(others) > 0
    yield "the softer, the more, as the paper says", f"{said} points", others == sorted(others)


@claim("3.4", "the same accuracy", "also valid for other materials with practical applications")
def other_materials() -> Iterator[Interpretation]:
    """The accuracy is the same for other materials."""
    others = {"bronze": (110e3, 0.34), "grey iron": (110e3, 0.26), "alumina": (380e3, 0.22)}
    bodies = MATERIALS | {name: Material(name, *constants) for name, constants in others.items()}
    for how, from_dR in {"from 7.5 µm": CLEARANCES[0], "from 50 µm": 0.05}.items():
        most, mean = {}, {}
        for name, body in bodies.items():
            pair, load, _ = window(body, (LOW_LOAD, HIGH_LOAD), from_dR)
            percent = difference_percent(Enhanced(), Johnson(), load, pair)
            percent = percent[np.isfinite(percent)]
            most[name] = float(max(percent, key=abs))
            mean[name] = float(np.abs(percent).mean())
        for what, values in {"largest difference": most, "mean difference": mean}.items():
            theirs = max(abs(values[name]) for name in MATERIALS)
            ours = {name: abs(values[name]) for name in others}
            said = ", ".join(f"{name} {percent:.2f}" for name, percent in ours.items())
            said += f" %; the paper's materials up to {theirs:.2f} %"
            yield f"{what} at 32 to 316 N/mm, ΔR {how}, no larger", said, all_below(theirs, ours)


@claim("3.4", "with σ_y", "The maximum allowable load increases with the yield strength")
def load_rises_with_strength() -> Iterator[Interpretation]:
    """The largest allowable load rises with the yield strength."""
    yield from allowable_load(strength=1.1)


@claim("3.4", "with E*", "The maximum allowable load increases with … the composite modulus")
def load_rises_with_modulus() -> Iterator[Interpretation]:
    """The largest allowable load rises with the composite modulus, and falls with E."""
    yield from allowable_load(modulus=1.1)


def allowable_load(modulus: float = 1.0, strength: float = 1.0) -> Iterator[Interpretation]:
    """Yield how loads at the limit change with 10 % more modulus or yield stress of steel."""
    steel = MATERIALS["low-carbon steel"]
    yield_stress = float(steel.yield_stress or np.nan)
    other = Material("other", modulus * float(steel.E), steel.nu, strength * yield_stress)
    pairs = [CylinderPair.from_dR("internal", 0.05, body, R_i=10.0) for body in (steel, other)]
    for how, limit in {
        "no yield by Hertz's peak pressure (Eq 7)": lambda pair: limits.yield_load(pair, "Hertz"),
        "no yield by von Mises": limits.yield_load,
        "the domain of Johnson's law (Eq 8)": limits.johnson_limit_load,
    }.items():
        before, after = (float(limit(pair)) for pair in pairs)
        percent = 100 * (after / before - 1)
        yield f"{how}, R_i = 10 mm, 50 µm, with 10 % more", f"{percent:+.1f} %", percent > 1e-6


# --- Sections 4 and 5: the slider-crank, whose masses and lengths are ours ------------------------

CASES = "datasets/mechanism/cases.csv"
REVOLUTION = 60 / 5000  # s


@cache
def all_cases() -> pd.DataFrame:
    table = pd.read_csv(CASES, comment="#")
    times = {
        "contact_ms": 1e3 * table["contact_fraction"] * REVOLUTION / table["impacts"],
        "flight_ms": 1e3 * (1 - table["contact_fraction"]) * REVOLUTION / table["impacts"],
    }
    paper = table[table["law"] != "explicit"].copy()
    return paper.assign(**times)


def cases(**only: float) -> pd.DataFrame:
    """Return the cases of `datasets/mechanism/cases.csv` for the paper's three laws."""
    table = all_cases()
    for column, value in only.items():
        table = table[table[column] == value]
    return table


def joint(dR: float) -> CylinderPair:
    """Return the joint of Section 4: R_i = 10 mm, 10 mm long."""
    return CylinderPair.from_dR("internal", dR, STEEL, 10.0, R_i=10.0)


@claim("4.3", "stiffer at 0.5 mm", "For larger clearance values, the Johnson … slightly stiffer")
def johnson_is_stiffer() -> Iterator[Interpretation]:
    """At 0.5 mm Johnson's law is slightly stiffer than the enhanced one."""
    yield from johnson_against_enhanced(0.5, +1)


@claim("4.3", "softer at 0.02 mm", "the situation being reversed for small clearance values")
def johnson_is_softer() -> Iterator[Interpretation]:
    """At 0.02 mm Johnson's law is slightly softer than the enhanced one."""
    yield from johnson_against_enhanced(0.02, -1)


def johnson_against_enhanced(dR: float, sign: int) -> Iterator[Interpretation]:
    """Yield where Johnson's law is the stiffer one (sign 1) or the softer one (-1).

    Penetrations are evenly spaced, as on the axis of Fig 17, up to 60 µm or the end of Johnson's
    law.
    """
    pair, word = joint(dR), "stiffer" if sign > 0 else "softer"
    end = min(0.06, STARTS * float(Johnson().max_penetration(pair)))
    depth = end * np.arange(1, 2001) / 2000
    where = f"of the penetrations up to {1e3 * end:.0f} µm"
    force = {law.name: law.load(depth, pair) for law in (Johnson(), Enhanced())}
    for what, (johnson, enhanced) in {
        "force": (force["johnson"], force["enhanced"]),
        "tangent": (np.gradient(force["johnson"], depth), np.gradient(force["enhanced"], depth)),
    }.items():
        share = 100 * float(np.mean(sign * (johnson - enhanced) > 0))
        yield f"{what} at equal penetration, in most", f"in {share:.0f} % {where}", share > 50
    work = 100 * float(force["johnson"].sum() / force["enhanced"].sum() - 1)
    said = f"{work:+.1f} % of the enhanced law's"
    yield f"{word} by the work up to {1e3 * end:.0f} µm", said, sign * work > 0


@claim("4.3, 5", "softer", "always leads to softer contact … contact forces are underestimated")
def sphere_is_softest() -> Iterator[Interpretation]:
    """The law of Lankarani and Nikravesh, which is a sphere's, gives lower forces."""
    depth = 1e-3 * np.geomspace(0.05, 60.0, 401)
    for dR in (0.5, 0.02):
        pair = joint(dR)
        inside = depth[depth < Johnson().max_penetration(pair)]
        force = LankaraniNikravesh().load(inside, pair)
        share = {
            name: float((force / law.load(inside, pair)).max())
            for name, law in {"Johnson's": Johnson(), "the enhanced law's": Enhanced()}.items()
        }
        said = ", ".join(f"at most {most:.2f} of {name}" for name, most in share.items())
        yield f"equal penetration, ΔR = {dR:g} mm", said, max(share.values()) < 1
    rows = cases(clearance_mm=0.02, restitution=0.9).pivot(
        index="law", columns="friction", values="mean_penetration_um"
    )
    depths = rows.loc["lankarani-nikravesh"] / rows.drop("lankarani-nikravesh").max()
    said = f"mean penetration {depths.min():.2f} times that of the others"
    yield "deeper in the runs at 0.02 mm, c_e = 0.9", said, bool(depths.min() > 1)


@claim("4.3", "longer flights", "longer free flight trajectories for larger clearance values")
def longer_flights() -> Iterator[Interpretation]:
    """Without losses flights are longer at the larger clearance."""
    yield from means_by_clearance("flight_ms", +1)


@claim("4.3", "shorter contacts", "shorter contact periods … for larger clearance values")
def shorter_contacts() -> Iterator[Interpretation]:
    """Without losses contacts are shorter at the larger clearance."""
    yield from means_by_clearance("contact_ms", -1)


def means_by_clearance(column: str, sign: int) -> Iterator[Interpretation]:
    means = cases(restitution=1.0, friction=0.0).pivot(
        index="law", columns="clearance_mm", values=column
    )
    ratio = means[0.5] / means[0.02]
    said = f"{ratio.min():.1f} to {ratio.max():.1f} times that at 0.02 mm"
    yield "mean duration, by law", said, bool((sign * (ratio - 1) > 0).all())


@claim("4.3", "fewer impacts", "a smaller number of impacts observed")
def fewer_impacts() -> Iterator[Interpretation]:
    """At the smaller clearance there are fewer impacts."""
    for restitution, friction in product((1.0, 0.9), (0.0, 0.1)):
        rows = cases(restitution=restitution, friction=friction)
        impacts = rows.pivot(index="law", columns="clearance_mm", values="impacts")
        small, large = impacts[0.02], impacts[0.5]
        said = f"{small.min():.0f} to {small.max():.0f} a revolution at 0.02 mm, "
        said += f"{large.min():.0f} to {large.max():.0f} at 0.5 mm"
        how = f"c_e = {restitution:g}, c_f = {friction:g}, with each law"
        yield how, said, None if not impacts.any(axis=None) else bool((small < large).all())


@claim("4.3", "most", "most of the trajectories present the pairs in continuous contact")
def dissipation_keeps_contact() -> Iterator[Interpretation]:
    """With c_e = 0.9 and no friction most trajectories show continuous contact."""
    shares = cases(restitution=0.9, friction=0.0)["contact_fraction"]
    count = int((shares >= 0.99).sum())
    yield "in contact 99 % of the time", f"{count} of {len(shares)} cases", count > len(shares) / 2
    yield "in contact most of the time", f"at least {100 * shares.min():.0f} %", shares.min() > 0.5


@claim("4.3, 5", "mostly in contact", "become mostly in the contact mode")
def friction_keeps_contact() -> Iterator[Interpretation]:
    """With friction the journal is mostly in contact."""
    for restitution in (0.9, 1.0):
        shares = cases(clearance_mm=0.5, restitution=restitution, friction=0.1)["contact_fraction"]
        how = f"0.5 mm, c_e = {restitution:g}, more than half of the time"
        yield how, f"{100 * shares.min():.0f} to {100 * shares.max():.0f} %", shares.min() > 0.5


@claim("4.3", "reduction", "the reduction on the global contact force values, due to the friction")
def friction_lowers_forces() -> Iterator[Interpretation]:
    """Friction lowers the contact forces."""
    for restitution in (0.9, 1.0):
        rows = cases(clearance_mm=0.5, restitution=restitution)
        forces = rows.pivot(index="law", columns="friction", values="mean_force_N")
        share = forces[0.1] / forces[0.0]
        said = f"{share.min():.2f} to {share.max():.2f} of the mean force without"
        yield f"0.5 mm, c_e = {restitution:g}", said, bool((share < 1).all())


@claim(
    "4.3", "with dissipation", "the integration time step … increases with the energy dissipation"
)
def steps_grow_with_dissipation() -> Iterator[Interpretation]:
    """The integrator's steps grow with dissipation."""
    yield from larger_steps("restitution", 1.0, 0.9, "c_e 1 to 0.9")
    yield from larger_steps("friction", 0.0, 0.1, "friction 0 to 0.1")


@claim("4.3", "with smaller clearance", "and with the decrease of the clearance size")
def steps_grow_with_less_clearance() -> Iterator[Interpretation]:
    """The integrator's steps grow with a smaller clearance."""
    yield from larger_steps("clearance_mm", 0.5, 0.02, "0.5 to 0.02 mm")


def larger_steps(column: str, low: float, high: float, words: str) -> Iterator[Interpretation]:
    others = [each for each in ("law", "clearance_mm", "restitution", "friction") if each != column]
    steps = cases().pivot(index=others, columns=column, values="steps")
    ratio = steps[low] / steps[high]
    count = int((ratio > 1).sum())
    said = f"larger in {count} of {len(ratio)} cases, median {ratio.median():.2f} times"
    yield f"our integrator, {words}, larger in most cases", said, count > len(ratio) / 2


@claim("4.3", "no other difference", "No other particular difference in the dynamic behavior")
def johnson_and_enhanced_alike() -> Iterator[Interpretation]:
    """Johnson's law and the enhanced one give the same motion in the mean."""
    columns = {
        "contact_fraction": "time in contact",
        "impacts": "impacts",
        "mean_penetration_um": "penetration",
        "mean_force_N": "force",
    }
    for dR, restitution, friction in product((0.5, 0.02), (0.9, 1.0), (0.0, 0.1)):
        rows = cases(clearance_mm=dR, restitution=restitution, friction=friction).set_index("law")
        a, b = (rows.loc[law, list(columns)].astype(float) for law in ("johnson", "enhanced"))
        percent = 100 * (b / a - 1)[(a != 0) | (b != 0)]
        worst = percent.abs().idxmax()
        how = f"{dR:g} mm, c_e = {restitution:g}, c_f = {friction:g}, means within 20 %"
        said = f"enhanced against Johnson at most {percent[worst]:+.0f} % ({columns[worst]})"
        yield how, said, bool(percent.abs().max() < 20)
