"""Values of the supplement: how the coefficients of 2015 were made, and what the paper states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from typing import Any

import numpy as np
import pandas as pd

from cylcontact.bodies.pair import CONTACTS, Contact
from cylcontact.datasets.grid import grid_from
from cylcontact.fitting.law_models import grid_model_of
from cylcontact.fitting.objectives import collect_samples, form_of
from cylcontact.fitting.records import FAIRLY, SAME_BASIN, TOLERANCE
from cylcontact.fitting.results import LawFit
from cylcontact.laws import PUBLISHED
from cylcontact.laws.enhanced import INTERNAL_DR_MAX, INTERNAL_DR_MIN, PUBLISHED_DR
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Claim, Verdict
from cylcontact.reports.claims import ledger as claims_of
from cylcontact.reports.claims_text import counts
from cylcontact.reports.laws_to_use import laws_to_use
from cylcontact.reports.manuscript import number, plain

from .. import paper
from ..claims.section31_law import y_crossing
from ..claims.section32 import BOUNDS, LOADS, compared, law_differences, to_elements
from ..claims.section32 import largest as largest_off
from ..claims.section34_differences import largest_by_material
from ..extremes import Extreme, largest_difference, share_below
from ..finite_elements import penetrations, sensitivity_table, study, table
from ..searched_readings import readings as read_readings
from .joint_values import ENHANCED, JOHNSON
from .law_values import HOLE, Values, at_least, at_most, exact, spread

# The symbols of the manuscript, by the names that the coefficients have in results.
SYMBOLS: Mapping[str, str] = {
    **{"a": "a", "b": "b", "n": "n", "n_exponent": "m"},
    **{"Y_log_scale": "p", "Y_log_exponent": "q", "Y_slope": "u", "Y_offset": "v"},
}


CONTACT_NAMES: Mapping[Contact, str] = {"internal": "pin in a hole", "external": "rollers"}


# The rows of the table of objectives: campaign, contact, what is free, and the samples.
OBJECTIVES = (
    ("recovered-internal", "two", "chosen, E to {E} GPa"),
    ("internal", "all", "paper’s ranges"),
    ("internal-E1000", "all", "same, E to {E} GPa"),
    ("practical", "all", "ΔR {dR} mm"),
    ("recovered-external", "two", "chosen, E to {E} GPa"),
    ("external", "all", "paper’s ranges"),
    ("external-E1000", "all", "same, E to {E} GPa"),
)


ALL_FREE: Mapping[Contact, tuple[str, ...]] = {
    "internal": (
        *("internal", "internal-E1000", "practical", "internal-E1000-max-difference"),
        *("internal-E1000-rms-difference", "internal-E1000-rms-relative-force"),
    ),
    "external": ("external", "external-E1000"),
}


CLOSE = 5.0  # percent


# The paper's bounds of Sect. 3.4 in percent; moderate loads from the clearances of its fit on.
BOUND, TIGHT = 8.0, 4.0


FROM_WIDE = paper.TRAINING_DR["internal"][0]  # mm


WIDE = replace(paper.MODERATE, clearances=(FROM_WIDE, paper.COMPARED_CLEARANCES[1]))


LAW_NAMES: Mapping[str, str] = {
    "published": "2015 law",
    "refit": "2015 law, refitted",
    "power-dimensionless": "power law, two constants",
    "power-clearance": "power law by clearance",
    "explicit": "explicit",
    "johnson": "Johnson",
}


def law(bench: Bench) -> Values:
    """Return the ranges of the 2015 law, and where the branches of Y meet."""
    assert abs(y_crossing() - float(paper.Y_SWITCH)) < 1e-6, "the switch is where they meet"
    grid = bench.result("internal").settings["dataset"]["axes"]
    return {
        "defined_from": number(INTERNAL_DR_MIN, "mm", 1),
        "defined_to": number(int(INTERNAL_DR_MAX), "mm"),
        "switch": number(y_crossing(), "mm", 5),
        "clearances": exact(PUBLISHED_DR["internal"], "mm", 1),
        "sums": exact(PUBLISHED_DR["external"], "mm"),
        "loads": exact(paper.LOADS, "N/mm"),
        "moduli": exact((paper.TRAINING_E[0] / 1e3, paper.TRAINING_E[1] / 1e3), "GPa"),
        "ratios": number((grid["nu"]["min"], grid["nu"]["max"]), "", 1),
    }


def _digits_are_linked() -> bool:
    """Return whether the published digits of a pin in a hole follow from two of them."""
    own = asdict(PUBLISHED["internal"])
    p = own["Y_log_scale"]
    tied = {"b": own["a"] / 10, "Y_log_exponent": -p / 10}
    tied |= {"Y_slope": p / 100, "Y_offset": 1 + p / 10}
    return all(abs(own[name] - value) < 1e-12 for name, value in tied.items())


def made(bench: Bench) -> Values:
    """Return the coefficients searched anew, and how the search went."""
    assert _digits_are_linked(), "the printed digits are linked"
    assert _never_the_optimum(bench), "the published coefficients are not the optimum"
    assert _excess_is_of_stiffness(bench), "most of the excess comes from the linear stiffness"
    recovered = {contact: bench.result(f"recovered-{contact}") for contact in CONTACTS}
    assert _poor(recovered["external"]) == ["b"], "the samples hardly determine the rollers' b"
    free = {contact: bench.result(contact) for contact in CONTACTS}
    values: Values = {
        "coefficients": _coefficient_table(recovered, free),
        "objectives": _objective_table(bench),
        "points": _one_of_all([axes["E"]["points"] for axes in map(_axes, recovered.values())]),
        "nu": _one_of_all(
            [nu for axes in map(_axes, recovered.values()) for nu in axes["nu"]["values"]]
        ),
        "end": number(round(_axes(recovered["internal"])["E"]["max"]), "GPa"),
        "off": at_most(max(map(_largest_off, recovered.values())), "%", 1),
        "penalty": at_most(100 * (max(map(_published_ratio, recovered.values())) - 1), "%", 2),
        "same": number(100 * SAME_BASIN, "%", 1),
        "tolerance": number(round(100 * TOLERANCE), "%"),
        "fairly": number(round(100 * FAIRLY), "%"),
        "poor_count": len(_poor(free["internal"])),
        "internal_free": len(free["internal"].coefficients),
    }
    practical = bench.result("practical")
    clearances = _axes(practical)["dR"]
    assert practical.published is not None
    values |= {
        "practical_dR": exact((clearances["min"], clearances["max"]), "mm"),
        "practical_published": practical.published.objective,
        "practical_fitted": practical.objective.value,
        "practical_refit": _rms_over(practical, free["internal"]),
    }
    for contact, result in free.items():
        (_, agreeing), *_ = result.basins()
        values |= {
            f"{contact}_runs": len(result.runs),
            f"{contact}_agreeing": agreeing,
            f"{contact}_ratio": _published_ratio(result),
            f"{contact}_above": number(_above_bound(result), "%", 3),
        }
    return values


def _never_the_optimum(bench: Bench) -> bool:
    """Return whether every search of all coefficients is below the published ones by 5 %."""
    names = (name for group in ALL_FREE.values() for name in group)
    return all(_published_ratio(bench.result(name)) > 1.05 for name in names)


def _excess_is_of_stiffness(bench: Bench) -> bool:
    """Return whether two constants remove most of the squared excess over the bound, rollers."""
    two, three = bench.result("power-external"), bench.result("external")
    assert three.bound is not None
    left = two.objective.value**2 - three.bound**2
    return left < 0.5 * (three.objective.value**2 - three.bound**2)


def _rms_over(samples_of: LawFit, fit: LawFit) -> float:
    """Return the objective of the coefficients of one fit on the samples of another."""
    samples, _ = collect_samples(grid_from(samples_of.settings["dataset"], samples_of.name))
    model = grid_model_of(fit.law, fit.contact, fit.name)
    form = form_of(model, model.candidates(fit.coefficients), samples.dR)
    return float(np.sqrt(np.mean(form.log_ratio(0, samples) ** 2)))


def _axes(result: LawFit) -> dict[str, Any]:
    """Return the axes of the samples of a campaign."""
    axes: dict[str, Any] = result.settings["dataset"]["axes"]
    return axes


def _one_of_all(numbers: Sequence[float]) -> str:
    """Return the number that all are."""
    (one,) = set(numbers)
    return number(one, "", 1)


def _coefficient_table(
    recovered: Mapping[Contact, LawFit], free: Mapping[Contact, LawFit]
) -> pd.DataFrame:
    """Return the coefficients as published, recovered, and with all of them free."""
    rows = []
    for contact, result in recovered.items():
        for name, printed in asdict(PUBLISHED[contact]).items():
            fitted = result.coefficients[name]
            is_held = result.identification(name) == "fixed"
            off = "" if is_held else _cell(100 * (fitted / printed - 1), "+.1f")
            rows.append(
                {
                    "contact": CONTACT_NAMES[contact],
                    "symbol": f"${SYMBOLS[name]}$",
                    "published": _cell(printed, "g"),
                    "set by": _rule(result, name),
                    "recovered": _cell(fitted, "g" if is_held else "#.4g"),
                    "difference, %": off,
                    "all free": _cell(free[contact].coefficients[name], "#.4g"),
                }
            )
    return pd.DataFrame(rows)


def _rule(result: LawFit, name: str) -> str:
    """Return how a coefficient is set in a search: searched, held, or by its tie."""
    how = result.identification(name)
    if how.startswith("="):
        return f"${how[2:].replace('Y_log_scale', SYMBOLS['Y_log_scale'])}$"
    return "held" if how == "fixed" else "search"


def _objective_table(bench: Bench) -> pd.DataFrame:
    """Return the objectives of the published and the fitted coefficients, and the bounds."""
    rows = []
    for name, free, samples in OBJECTIVES:
        result = bench.result(name)
        axes = result.settings["dataset"]["axes"]
        ends = {
            "E": f"{axes['E']['max']:g}",
            "dR": f"{axes['dR']['min']:g} to {axes['dR']['max']:g}",
        }
        published = result.published
        rows.append(
            {
                "contact": CONTACT_NAMES[result.contact],
                "free": free,
                "samples": samples.format(**ends),
                "published": f"{published.objective if published else np.nan:.4f}",
                "fitted": f"{result.objective.value:.4f}",
                "bound": f"{result.bound:.4f}",
            }
        )
    return pd.DataFrame(rows)


def _cell(number: float, form: str) -> str:
    """Return a number for a cell of a table."""
    return format(number, form).replace("-", "−")


def _largest_off(result: LawFit) -> float:
    """Return the largest difference of a searched coefficient from the published, in percent."""
    published = asdict(PUBLISHED[result.contact])
    searched = [name for name in published if _rule(result, name) == "search"]
    return float(max(100 * abs(result.coefficients[k] / published[k] - 1) for k in searched))


def _published_ratio(result: LawFit) -> float:
    """Return the objective of the published coefficients over that of the fitted ones."""
    assert result.published is not None
    return result.published.objective / result.objective.value


def _above_bound(result: LawFit) -> float:
    """Return by how many percent a fit is above its lower bound."""
    assert result.bound is not None
    return 100 * (result.objective.value / result.bound - 1)


def _poor(result: LawFit) -> list[str]:
    """Return the coefficients that a fit hardly determines."""
    return [name for name in result.profiles if result.identification(name) == "poorly"]


def readings(bench: Bench) -> Values:
    """Return how far the recovered coefficients depend on what the paper does not say."""
    rows = read_readings(bench)
    inside, held, free = (_differences(bench, name) for name in _searches(bench))
    assert _highest_even(inside) < -30, "evenly spaced clearances end in another minimum"
    refined = [part.xs("points per axis") for part in (inside, held)]
    points = sorted(int(label) for label in refined[0].index)
    p_close = _close(inside[["Y_log_scale"]])
    return {
        "count": len(rows.drop_duplicates(["contact", "changed", "reading"])),
        "each": len(inside),
        "points": (points[0], points[-1]),
        "internal_refined": at_most(float(refined[0].abs().to_numpy().max()), "%", 2),
        "a_refined": at_most(float(refined[1]["a"].abs().max()), "%", 2),
        "b_refined": number(float(refined[1]["b"].loc[str(points[-1])]), "%", 2),
        "a_free": spread(free["a"], "%", 2),
        "n_free": spread(free["n"], "%", 2),
        "close": number(round(CLOSE), "%"),
        "internal_close": _close(inside),
        "p_close": p_close,
        "p_missed": len(inside) - len(_even_clearances(inside)) - p_close,
        "b_close": _close(held[["b"]]),
        "a_close": _close(held[["a"]]),
        "even": len(_even_clearances(inside)),
        "even_a": at_least(-_highest_even(inside), "%", 2),
        "combinations": _common(bench)[0],
        "common": at_most(_common(bench)[1], "%", 2),
    }


def _searches(bench: Bench) -> list[str]:
    """Return the names of the searches: internal, external with n fixed, and with n free."""
    return list(dict.fromkeys(read_readings(bench)["search"]))


def _differences(bench: Bench, search: str) -> pd.DataFrame:
    """Return the differences in percent of a search, a row per reading."""
    rows = read_readings(bench)
    return rows[rows["search"] == search].pivot_table(
        index=["changed", "reading"], columns="coefficient", values="difference_percent"
    )


def _even_clearances(differences: pd.DataFrame) -> pd.DataFrame:
    """Return the readings whose clearances are evenly spaced."""
    return differences[differences.index.get_level_values("reading").str.contains("dR linear")]


def _highest_even(differences: pd.DataFrame) -> float:
    """Return the highest difference of a in percent with evenly spaced clearances."""
    return float(_even_clearances(differences)["a"].max())


def _close(differences: pd.DataFrame) -> int:
    """Return how many readings have all coefficients closer than `CLOSE`."""
    return int((differences.abs() < CLOSE).all(axis=1).sum())


def _common(bench: Bench) -> tuple[int, float]:
    """Return the combinations of spacings and ends of E, and the best one's largest difference.

    Both contacts are searched on the same samples, for rollers with n fixed.
    """
    names = {"internal": "E linear, dR log, load linear, E to 1000 GPa"}
    names["external, n fixed"] = "E linear, dR linear, load linear, E to 10000 GPa"
    worst = []
    for search, name in names.items():
        largest = _differences(bench, search).abs().max(axis=1)
        spaced = largest[largest.index.get_level_values("reading").str.contains("dR l")]
        own = pd.Series({name: largest["points per axis", "20"]})
        worst.append(pd.concat([spaced.droplevel("changed"), own]))
    both = pd.concat(worst, axis=1, join="inner").max(axis=1)
    return len(both), float(both.min())


def ranges(bench: Bench) -> Values:
    """Return the table of laws, and how far the 2015 law is from Johnson's."""
    materials = paper.five_materials(bench)
    largest, moderate = (
        {name: largest_difference(m, domain) for name, m in materials.items()}
        for domain in (paper.PRACTICAL, WIDE)
    )
    assert min(abs(one.percent) for one in moderate.values()) > TIGHT, "no material keeps within"
    assert _no_reading_meets(bench), "no other reading meets a bound"
    assert _one_power_law_is_nearer(bench), "one power law is nearer than the published law"
    assert _differs_where_johnson_does(bench), "explicit and Johnson's law differ by conformity"
    worst, worst_moderate = _worst(largest), _worst(moderate)
    left = largest_by_material(materials, paper.PRACTICAL, corners=False)
    shares = [share_below(BOUND, m, paper.PRACTICAL) for m in materials.values()]
    return {
        "table": _laws_table(bench),
        "clearances": exact(paper.COMPARED_CLEARANCES, "mm", 2),
        "loads": exact(paper.LOADS, "N/mm"),
        "hole": number(round(HOLE), "mm"),
        "moderate_loads": number(paper.MODERATE_LOADS, "N/mm", 3),
        "materials": len(materials),
        "bound": number(round(BOUND), "%"),
        "tight": number(round(TIGHT), "%"),
        "largest": number(largest[worst].percent, "%", 2),
        "largest_material": _without_kind(worst),
        "excluded": number(left[_worst(left)].percent, "%", 2),
        "near": number(25, "µm"),
        "shares": spread(shares, "%", 2),
        "from": number(FROM_WIDE, "mm", 1),
        "moderate": number(abs(moderate[worst_moderate].percent), "%", 2),
        "moderate_material": _without_kind(worst_moderate),
    }


def _worst(extremes: Mapping[str, Extreme]) -> str:
    """Return the material of the largest difference."""
    return max(extremes, key=lambda name: abs(extremes[name].percent))


def _without_kind(material: str) -> str:
    """Return a material's name for the text."""
    return material.removesuffix(" alloy")


def _no_reading_meets(bench: Bench) -> bool:
    """Return whether no reading of the paper's two bounds is met."""
    claims = bench.module("claims.section34_differences")
    (wide,), (tight,) = claims.below_8_percent(bench), claims.below_4_percent(bench)
    return {wide.verdict, tight.verdict} == {"not reproduced"}


def _laws_table(bench: Bench) -> pd.DataFrame:
    """Return the errors of the laws over the paper's ranges."""
    holes, rollers = (laws_to_use(contact, bench, "paper") for contact in ("internal", "external"))
    rows = []
    for hole, roller in zip(holes.to_dict("records"), rollers.to_dict("records"), strict=True):
        rows.append(
            {
                "law": LAW_NAMES[hole["law"]],
                "hole: rms to Johnson": _error(hole["rms_johnson"]),
                "hole: rms to conformal": _error(hole["rms_conformal"]),
                "hole: largest, %": _cell(hole["max_conformal_percent"], ".3g"),
                "rollers: rms to Johnson": _error(roller["rms_johnson"]),
                "units": str(hole["units"]).removesuffix(", MPa"),
                "relative time": f"{hole['relative_time']:.1f}",
            }
        )
    return pd.DataFrame(rows)


def _error(rms: float) -> str:
    """Return an error for a cell, 0 where the law is the reference itself."""
    return "0" if rms < 1e-9 else f"{rms:.4f}"


def _errors_of(bench: Bench, name: str) -> tuple[float, float]:
    """Return the errors of a law for a pin in a hole, to Johnson's law and to conformal contact."""
    rows = laws_to_use("internal", bench, "paper").to_dict("records")
    (row,) = (row for row in rows if row["law"] == name)
    return float(row["rms_johnson"]), float(row["rms_conformal"])


def _differs_where_johnson_does(bench: Bench) -> bool:
    """Return whether the explicit law is far nearer to conformal contact than to Johnson's law."""
    to_johnson, to_conformal = _errors_of(bench, "explicit")
    return to_conformal < 0.05 * to_johnson


def _one_power_law_is_nearer(bench: Bench) -> bool:
    """Return whether one power law is nearer than the published law, by both references."""
    two, published = (_errors_of(bench, name) for name in ("power-dimensionless", "published"))
    return two[0] < published[0] and two[1] < published[1]


def _no_load_keeps_both() -> bool:
    """Whether at each load the two laws alone break one of the bounds."""
    pairs = [(float(str(b["percent"])), law_differences(float(str(b["lowest"])))) for b in BOUNDS]
    return all(any(abs(off[load]) >= percent for percent, off in pairs) for load in LOADS)


# --- finite elements ------------------------------------------------------------------------------


# From this ΔR in mm on Johnson's law and finite elements agree; ours, for the text.
LARGE_ENOUGH = 0.05


def elements(bench: Bench) -> Values:
    """Return the check by finite elements: loads, solvers, laws, and the paper's bounds."""
    assert _johnson_falls_short(bench), "Johnson's law falls short as the contact widens"
    assert _no_load_keeps_both(), "at each load the two laws alone break a bound"
    setup = study(bench, "recommended").setups["base"]
    rows = table(bench, "recommended")
    other = table(bench, "recommended", "calculix")
    solvers = 100 * (other["penetration_mm"] / rows["penetration_mm"] - 1)
    return {
        "clearances": spread(rows["dR_mm"], "mm", 2),
        "lightest": number(float(rows["load_N_per_mm"].min()), "N/mm", 2),
        "middle": number(LOADS[1], "N/mm", 2),
        "heaviest": number(float(rows["load_N_per_mm"].max()), "N/mm", 3),
        "ratio": number(setup.outer_ratio, "", 2),
        "solvers": number(float(solvers.abs().max()), "%", 2),
        "mesh": _of_the_mesh(bench),
        **_laws_to_elements(bench),
        "switch": number(paper.FIG6_WIDE, "mm", 3),
        "bound_everywhere": number(round(float(str(BOUNDS[0]["percent"]))), "%"),
        "bound_above": number(round(float(str(BOUNDS[1]["percent"]))), "%"),
    }


def _of_the_mesh(bench: Bench) -> str:
    """Return what elements of half the size change."""
    changes = sensitivity_table(table(bench, "sensitivity")).groupby("variant")["change_percent"]
    halved = changes.get_group("32 cells instead of 16").abs()
    return number(float(halved.max()), "%", 1)


def _laws_to_elements(bench: Bench) -> Values:
    """Return how far the laws are from finite elements."""
    values: Values = {}
    rows = penetrations(table(bench, "recommended"))
    wide = rows[rows["dR_mm"] >= LARGE_ENOUGH]
    values["johnson_wide"] = number(abs(largest_off(to_elements(wide, JOHNSON))), "%", 1)
    for law in (JOHNSON, "persson"):
        values[law] = number(abs(largest_off(to_elements(rows, law))), "%", 2)
    for name, load in zip(("lightest", "middle", "heaviest"), LOADS, strict=True):
        off = largest_off(to_elements(compared(bench, "recommended", 0.0, (load,)), ENHANCED))
        values[f"enhanced_{name}"] = number(abs(off), "%", 3)
    setup = study(bench, "recommended").setups["base"]
    worst = rows.iloc[int(np.abs(to_elements(rows, JOHNSON)).argmax())]
    pair = setup.pair(float(worst["dR_mm"]))
    return values | {
        "from": number(LARGE_ENOUGH, "mm", 1),
        "johnson_phi": number(float(worst["load_N_per_mm"] / (pair.E_star * pair.dR)), "", 2),
    }


def _johnson_falls_short(bench: Bench) -> bool:
    """Whether Johnson's law is furthest from the elements where φ is largest, and below them."""
    rows = penetrations(table(bench, "recommended"))
    error = to_elements(rows, JOHNSON).ravel()
    phi = (rows["load_N_per_mm"] / rows["dR_mm"]).to_numpy()
    worst = int(np.abs(error).argmax())
    return bool(error[worst] < 0 and phi.argmax() == worst)


# --- the ledger -----------------------------------------------------------------------------------

VERDICTS: Mapping[str, Verdict] = {
    "as_printed": "reproduced",
    "with_a_choice": "reproduced with a stated choice",
    "failed": "not reproduced",
    "undecided": "undecided",
    "missing_input": "depends on a missing input",
}
HEADINGS = (
    *("Sect.", "statements", "reproduced as printed", "reproduced with a choice"),
    *("not reproduced", "undecided", "depends on an input"),
)


def ledger(bench: Bench) -> Values:
    """Return the ledger: counts, a table by section, and what is not reproduced."""
    every = claims_of(bench)
    claims = [c for c in every if not c.misprint and c.finding.readings]
    readings = [len(c.finding.readings) for c in claims]
    misprints = sum(c.misprint for c in every)
    number_of = counts(claims)
    sections = dict.fromkeys(c.section for c in claims)
    rows = [[name, *_counted([c for c in claims if c.section == name])] for name in sections]
    failed = [c for c in claims if c.verdict == "not reproduced"]
    return {
        "statements": len(claims),
        "stand": number_of["reproduced"] + number_of["reproduced with a stated choice"],
        "untestable": len(every) - len(claims) - misprints,
        "misprints": misprints,
        "readings": sum(readings),
        "most": max(readings),
        **{name: number_of[verdict] for name, verdict in VERDICTS.items()},
        "table": pd.DataFrame([*rows, ["all", *_counted(claims)]], columns=list(HEADINGS)),
        "failures": pd.DataFrame(
            [
                [f"{plain(c.statement)} ({c.section})", plain(c.paper), plain(_ours(c))]
                for c in failed
            ],
            columns=["statement (section)", "paper", "ours"],
        ),
    }


def _counted(claims: Sequence[Claim]) -> list[str]:
    """Return the number of claims, and of those with each verdict, as text."""
    number_of = counts(claims)
    columns = [len(claims), *(number_of[verdict] for verdict in VERDICTS.values())]
    return [str(count) if count else "–" for count in columns]


def _ours(claim: Claim) -> str:
    """Return our value of a claim, up to its first semicolon."""
    return claim.finding.ours.partition(";")[0]
