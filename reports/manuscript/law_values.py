"""Numbers and tables of the sections on the laws: how they were made, and where they hold."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from functools import cache
from typing import Any, Literal

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from cylcontact import laws
from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.finite_element import Setup, solve
from cylcontact.datasets.grid import grid_from
from cylcontact.fitting.law_models import grid_model_of
from cylcontact.fitting.objectives import collect_samples, form_of
from cylcontact.fitting.records import FAIRLY, SAME_BASIN, TOLERANCE
from cylcontact.fitting.results import LawFit
from cylcontact.laws import PUBLISHED, arcs, explicit, explicit_pair
from cylcontact.laws.conformal import Bodies
from cylcontact.laws.enhanced import INTERNAL_DR_MAX, INTERNAL_DR_MIN, PUBLISHED_DR
from cylcontact.limits import first_yield, yield_load
from cylcontact.materials import Material
from cylcontact.pair import CONTACTS, Contact, CylinderPair
from cylcontact.reports.bench import Bench
from cylcontact.reports.laws_bounds import (
    BOUNDED,
    departure_number,
    explicit_error,
    johnson_end,
    johnson_shortfall,
)
from cylcontact.reports.laws_to_use import laws_to_use
from cylcontact.reports.manuscript import Group, Value
from cylcontact.reports.quantity import Quantity, Symbol

from .. import paper
from ..claims.section31_law import y_crossing
from ..claims.section34_differences import in_corner, largest_by_material
from ..extremes import Extreme, largest_difference, share_below
from ..fig_any_pair import EDGE, PHI, possible_pairs
from ..fig_explicit import CLAMPED, added_by_housing
from ..fig_readings import readings as read_readings
from ..joints import ALUMINIUM, STEEL, pair_of
from ..universal import EXAMPLE, UNIT_PAIR

__all__ = [
    "HOLDS",
    "explicit_law",
    "housing",
    "johnson",
    "law",
    "made",
    "pairs",
    "pins",
    "ranges",
    "readings",
    "yielding",
]


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
# Loads and clearances as in the paper, R_i = 10 mm; yield stress assumed.
HOLE, STRENGTH, YIELD_E, YIELD_NU = 10.0, 250.0, 200e3, 0.3
YIELD_DR = (2.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)  # mm
# The joints of the finite elements: pin and plate, E in MPa and ν.
FE_STEEL, FE_ALUMINIUM, FE_PEEK = (207e3, 0.3), (70e3, 0.33), (3.6e3, 0.38)
FE_JOINTS = ((FE_STEEL, FE_ALUMINIUM), (FE_ALUMINIUM, FE_STEEL), (FE_PEEK, FE_STEEL))
FE_RATIO, FE_PHI = 80.0, (0.03, 0.3, 3.0)
METALS = ((STEEL, ALUMINIUM), (ALUMINIUM, STEEL), (STEEL, "bronze"), ("bronze", STEEL))
JOINT_PHI = (0.01, 0.1, 1.0, 10.0)
HOUSING_PHI = 0.1


# --- the 2015 law -------------------------------------------------------------------------------


def law(bench: Bench) -> Group:
    """Return the ranges of the 2015 law, and where the branches of Y meet."""
    grid = bench.result("internal").settings["dataset"]["axes"]
    return {
        "defined_from": Quantity(INTERNAL_DR_MIN, "mm", 1),
        "defined_to": Quantity(int(INTERNAL_DR_MAX), "mm"),
        "switch": Quantity(y_crossing(), "mm", 5),
        "clearances": _exact(PUBLISHED_DR["internal"], "mm", 1),
        "sums": _exact(PUBLISHED_DR["external"], "mm"),
        "loads": _exact(paper.LOADS, "N/mm"),
        "moduli": _exact((paper.TRAINING_E[0] / 1e3, paper.TRAINING_E[1] / 1e3), "GPa"),
        "ratios": Quantity((grid["nu"]["min"], grid["nu"]["max"]), "", 1),
    }


def spread(values: Iterable[float], unit: str = "", digits: int = 3) -> Quantity:
    """Return the least and the largest of some values."""
    least, *_, most = sorted(map(float, values))
    return Quantity((least, most), unit, digits)


def _at_most(value: float, unit: str, digits: int) -> Quantity:
    """Return a bound, rounded up."""
    step = _step(value, digits)
    return Quantity(step * math.ceil(value / step - 1e-9), unit, digits)


def _at_least(value: float, unit: str, digits: int) -> Quantity:
    """Return a lower bound, rounded down."""
    step = _step(value, digits)
    return Quantity(step * math.floor(value / step + 1e-9), unit, digits)


def _step(value: float, digits: int) -> float:
    """Return the unit of the last of a number's digits."""
    return float(10.0 ** (math.floor(math.log10(value)) + 1 - digits))


def _exact(ends: tuple[float, float], unit: str, digits: int = 3) -> Quantity:
    """Return the ends of a range, whole numbers in full."""
    low, high = (int(end) if float(end).is_integer() else end for end in ends)
    return Quantity((low, high), unit, digits)


# --- how its coefficients were made -------------------------------------------------------------


def made(bench: Bench) -> Group:
    """Return the coefficients searched anew, and how the search went."""
    recovered = {contact: bench.result(f"recovered-{contact}") for contact in CONTACTS}
    free = {contact: bench.result(contact) for contact in CONTACTS}
    values: dict[str, Value] = {
        "coefficients": _coefficient_table(recovered, free),
        "objectives": _objective_table(bench),
        "points": _one_of_all([axes["E"]["points"] for axes in map(_axes, recovered.values())]),
        "nu": _one_of_all(
            [nu for axes in map(_axes, recovered.values()) for nu in axes["nu"]["values"]]
        ),
        "end": Quantity(round(_axes(recovered["internal"])["E"]["max"]), "GPa"),
        "off": _at_most(max(map(_largest_off, recovered.values())), "%", 1),
        "penalty": _at_most(max(map(_penalty, recovered.values())), "%", 2),
        "same": Quantity(100 * SAME_BASIN, "%", 1),
        "tolerance": Quantity(round(100 * TOLERANCE), "%"),
        "fairly": Quantity(round(100 * FAIRLY), "%"),
        "poor_count": Quantity(len(_poor(free["internal"]))),
        "internal_free": Quantity(len(free["internal"].coefficients)),
    }
    practical = bench.result("practical")
    clearances = _axes(practical)["dR"]
    assert practical.published is not None
    values |= {
        "practical_dR": _exact((clearances["min"], clearances["max"]), "mm"),
        "practical_published": Quantity(practical.published.objective),
        "practical_fitted": Quantity(practical.objective.value),
        "practical_refit": Quantity(_rms_over(practical, free["internal"])),
    }
    for contact, result in free.items():
        (_, agreeing), *_ = result.basins()
        values |= {
            f"{contact}_runs": Quantity(len(result.runs)),
            f"{contact}_agreeing": Quantity(agreeing),
            f"{contact}_ratio": Quantity(_published_ratio(result)),
            f"{contact}_above": Quantity(_above_bound(result), "%", 3),
        }
    return values


def _rms_over(samples_of: LawFit, fit: LawFit) -> float:
    """Return the objective of the coefficients of one fit on the samples of another."""
    samples, _ = collect_samples(grid_from(samples_of.settings["dataset"], samples_of.name))
    model = grid_model_of(fit.law, fit.contact, fit.name)
    form = form_of(model, model.candidates(fit.coefficients), samples.dR)
    return float(np.sqrt(np.mean(form.log_penetration_ratio(0, samples) ** 2)))


def _axes(result: LawFit) -> dict[str, Any]:
    """Return the axes of the samples of a campaign."""
    axes: dict[str, Any] = result.settings["dataset"]["axes"]
    return axes


def _one_of_all(numbers: Sequence[float]) -> Quantity:
    """Return the number that all are."""
    (number,) = set(numbers)
    return Quantity(number, "", 1)


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
                    "symbol": Symbol(SYMBOLS[name]),
                    "published": _cell(printed, "g"),
                    "set by": _rule(result, name),
                    "recovered": _cell(fitted, "g" if is_held else "#.4g"),
                    "difference, %": off,
                    "all free": _cell(free[contact].coefficients[name], "#.4g"),
                }
            )
    return with_formulas(rows)


def _rule(result: LawFit, name: str) -> str:
    """Return how a coefficient is set in a search: searched, held, or by its tie."""
    how = result.identification(name)
    if how.startswith("="):
        return Symbol(how[2:].replace("Y_log_scale", SYMBOLS["Y_log_scale"]))
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


def _penalty(result: LawFit) -> float:
    """Return by how many percent the published coefficients' objective is above the fitted."""
    return 100 * (_published_ratio(result) - 1)


def _above_bound(result: LawFit) -> float:
    """Return by how many percent a fit is above its lower bound."""
    assert result.bound is not None
    return 100 * (result.objective.value / result.bound - 1)


def _poor(result: LawFit) -> list[str]:
    """Return the coefficients that a fit hardly determines."""
    return [name for name in result.profiles if result.identification(name) == "poorly"]


# --- the readings of how the paper fitted -------------------------------------------------------


def readings(bench: Bench) -> Group:
    """Return how far the recovered coefficients depend on what the paper does not say."""
    rows = read_readings(bench)
    inside, held, free = (_differences(bench, name) for name in _searches(bench))
    refined = [part.xs("points per axis") for part in (inside, held)]
    points = sorted(int(label) for label in refined[0].index)
    p_close = _close(inside[["Y_log_scale"]])
    return {
        "count": Quantity(len(rows.drop_duplicates(["contact", "changed", "reading"]))),
        "each": Quantity(len(inside)),
        "points": Quantity((points[0], points[-1])),
        "internal_refined": _at_most(float(refined[0].abs().to_numpy().max()), "%", 2),
        "a_refined": _at_most(float(refined[1]["a"].abs().max()), "%", 2),
        "b_refined": Quantity(float(refined[1]["b"].loc[str(points[-1])]), "%", 2),
        "a_free": spread(free["a"], "%", 2),
        "n_free": spread(free["n"], "%", 2),
        "close": Quantity(round(CLOSE), "%"),
        "internal_close": Quantity(_close(inside)),
        "p_close": Quantity(p_close),
        "p_missed": Quantity(len(inside) - len(_even_clearances(inside)) - p_close),
        "b_close": Quantity(_close(held[["b"]])),
        "a_close": Quantity(_close(held[["a"]])),
        "even": Quantity(len(_even_clearances(inside))),
        "even_a": _at_least(-_highest_even(inside), "%", 2),
        "combinations": Quantity(_common(bench)[0]),
        "common": _at_most(_common(bench)[1], "%", 2),
    }


def with_formulas(rows: list[dict[str, str]]) -> pd.DataFrame:
    """Return a table that keeps the formulas in its cells and headings."""
    columns = pd.Index(list(rows[0]), dtype=object)
    return pd.DataFrame([list(row.values()) for row in rows], columns=columns, dtype=object)


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


# --- Johnson's law, conformal contact and the explicit law --------------------------------------


def johnson(bench: Bench) -> Group:  # noqa: ARG001
    """Return the end of Johnson's law, how exact its inverse is, and where it departs."""
    return {
        "end": Quantity(johnson_end()),
        "round_trip": _at_most(_round_trip(), "", 1),
        "share": Quantity(round(100 * SHARE), "%"),
        "one": Quantity(1, "%"),
        "one_phi": Quantity(departure_number(1.0), "", 2),
        "many": Quantity(10, "%"),
        "many_phi": Quantity(departure_number(10.0), "", 2),
        "end_low": Quantity(johnson_shortfall(johnson_end()), "%", 2),
        "limit_angle": Quantity(_limit_angle(), "°", 4),
    }


def _limit_angle() -> float:
    """Return the semi-angle in degrees that no load reaches, for bodies of one material."""
    return float(np.degrees(Bodies(as_floats(0.5), 0.0, as_floats(0.0)).last.angle))


SHARE = 0.99  # of the largest load; beyond it δ determines f badly


def _round_trip() -> float:
    """Return the largest relative error of the load of the penetration of a load."""
    johnson_law, pair = laws.Johnson(), UNIT_PAIR
    loads = np.geomspace(1e-6, SHARE, 4001) * johnson_law.max_load(pair)
    back = johnson_law.load(johnson_law.penetration(loads, pair), pair)
    return float(np.abs(back / loads - 1).max())


def _closed_form_error() -> float:
    """Return how far the closed forms of the text are from Persson's law, relatively."""
    S = np.geomspace(1e-6, 0.45, 200)
    H = 2 * S - (1 - S) ** 2 * np.log1p(-S) / S
    C = 2 * np.log(2) - 1.5
    phi = np.pi / ((1 - S) ** 2 / S - H / 2)
    d = phi / np.pi * (-np.log(S) + S**2 / 2 + H / 2 + C)
    return float(np.abs(laws.Persson().penetration(phi, UNIT_PAIR) / d - 1).max())


def explicit_law(bench: Bench) -> Group:  # noqa: ARG001
    """Return the constants of the explicit law and its largest errors."""
    errors = explicit_error()
    values: dict[str, Value] = {}
    values |= {
        "example_E": Quantity(round(float(EXAMPLE.E) / 1e3), "GPa"),
        "example_nu": Quantity(float(EXAMPLE.nu), "", 1),
    }
    for contact, constants in explicit.CALIBRATED.items():
        values |= {
            f"{contact}_{name}": Quantity(value, "", 4 if value < 2 else 3)
            for name, value in asdict(constants).items()
        }
        values[f"{contact}_range"] = _exact(BOUNDED[contact], "", 1)
        values[f"{contact}_load"] = _at_most(errors[f"{contact} load"], "%", 2)
    return values


# --- any two materials --------------------------------------------------------------------------


def pairs(bench: Bench) -> Group:
    """Return what two materials change, and how near the fast laws are."""
    metals = np.array([_of_E_star(bench, joint) for joint in METALS])
    of_parametric, of_explicit = map(_largest_error, (laws.Parametric(), laws.ExplicitPair()))
    return {
        "phi": _exact((float(PHI[0]), float(PHI[-1])), "", 1),
        "alpha": Quantity(EDGE, "", 3),
        "parametric": _at_most(of_parametric, "%", 2),
        "explicit": _at_most(of_explicit, "%", 2),
        "parametric_constants": Quantity(len(fields(arcs.CALIBRATED))),
        "explicit_constants": Quantity(len(fields(explicit_pair.CALIBRATED))),
        "metals": Quantity((float(metals.min()), float(metals.max())), "%", 2),
        "plane_phi": Quantity(1),
        "highest_phi": Quantity(round(JOINT_PHI[-1])),
        "grid": Quantity(possible_pairs()[0].size),
        "any": Quantity(_any_pair(), "%", 2),
    }


def _of_E_star(bench: Bench, joint: tuple[str, str]) -> FloatArray:
    """Return the errors of the penetration in percent if E* alone is kept."""
    pair = pair_of(bench, joint, 0.05, HOLE)
    phi = np.array(JOINT_PHI)
    exact = laws.Conformal().penetration(phi * pair.E_star * 0.05, pair) / 0.05
    return np.asarray(100 * (laws.Persson().penetration(phi, UNIT_PAIR) / exact - 1))


def _any_pair() -> tuple[float, float]:
    """Return the extremes of that error over all pairs at φ = 1."""
    pair = CylinderPair.from_dundurs(*possible_pairs())
    alike = laws.Persson().penetration(1.0, UNIT_PAIR)
    error = 100 * (alike / laws.Conformal().penetration(1.0, pair) - 1)
    return float(error.min()), float(error.max())


@cache
def _largest_error(one: laws.ContactLaw) -> float:
    """Return the largest error of the load in percent over all pairs."""
    alpha, beta = possible_pairs()
    pair = CylinderPair.from_dundurs(alpha[..., None], beta[..., None])
    d = laws.Conformal().penetration(PHI, pair)
    return float(np.abs(100 * (one.load(d, pair) / PHI - 1)).max())


def _alpha_alone_is_worse(bench: Bench) -> bool:
    """Return whether α without β is further off than E* alone, for the metals tried."""
    phi = np.array(JOINT_PHI[1:])
    for joint in METALS:
        pair = pair_of(bench, joint, 0.05, HOLE)
        exact = laws.Conformal().penetration(phi * pair.E_star * 0.05, pair) / 0.05
        alone = CylinderPair.from_dundurs(float(pair.alpha), 0.0)
        of_alpha = laws.Conformal().penetration(phi, alone) / exact - 1
        if not np.all(np.abs(100 * of_alpha) > np.abs(_of_E_star(bench, joint)[1:])):
            return False
    return True


def pins(bench: Bench) -> Group:  # noqa: ARG001
    """Return how far finite elements of two materials are from the solution by series."""
    return {
        "unlike": _at_most(_unlike_by_elements(), "%", 2),
        "plate": Quantity(round(FE_RATIO)),
    }


@cache
def _unlike_by_elements() -> float:
    """Return the largest difference in percent of finite elements of two materials."""
    largest = 0.0
    for pin, (E, nu) in FE_JOINTS:
        own = {"pin_E": pin[0], "pin_nu": pin[1]}
        setup = Setup(hole_radius=HOLE, outer_ratio=FE_RATIO, E=E, nu=nu, clamp="rim", **own)
        pair, dR = setup.pair(HOLE / 1000), HOLE / 1000
        one = laws.Conformal(datum=laws.Housing(R_o=FE_RATIO * HOLE))
        for phi in FE_PHI:
            load = phi * float(pair.E_star) * dR
            (solution,) = solve(setup, dR, [load])
            away = solution.penetration / float(one.penetration(load, pair)) - 1
            largest = max(largest, 100 * abs(away))
    return largest


# --- where each law holds -----------------------------------------------------------------------


def ranges(bench: Bench) -> Group:
    """Return the table of laws, and how far the 2015 law is from Johnson's."""
    materials = paper.five_materials(bench)
    largest, moderate = (
        {name: largest_difference(m, domain) for name, m in materials.items()}
        for domain in (paper.PRACTICAL, WIDE)
    )
    worst, worst_moderate = _worst(largest), _worst(moderate)
    left = largest_by_material(materials, paper.PRACTICAL, in_corner)
    shares = [share_below(BOUND, m, paper.PRACTICAL) for m in materials.values()]
    return {
        "table": _laws_table(bench),
        "clearances": _exact(paper.COMPARED_CLEARANCES, "mm", 2),
        "loads": _exact(paper.LOADS, "N/mm"),
        "hole": Quantity(round(HOLE), "mm"),
        "moderate_loads": Quantity(paper.MODERATE_LOADS, "N/mm", 3),
        "materials": Quantity(len(materials)),
        "bound": Quantity(round(BOUND), "%"),
        "tight": Quantity(round(TIGHT), "%"),
        "largest": Quantity(largest[worst].percent, "%", 2),
        "largest_material": _without_kind(worst),
        "excluded": Quantity(left[_worst(left)].percent, "%", 2),
        "near": Quantity(25, "µm"),
        "shares": spread(shares, "%", 2),
        "from": Quantity(FROM_WIDE, "mm", 1),
        "moderate": Quantity(abs(moderate[worst_moderate].percent), "%", 2),
        "moderate_material": _without_kind(worst_moderate),
    }


def _worst(extremes: Mapping[str, Extreme]) -> str:
    """Return the material of the largest difference."""
    return max(extremes, key=lambda name: abs(extremes[name].percent))


def _without_kind(material: str) -> str:
    """Return a material's name for the text."""
    return material.removesuffix(" alloy")


LAW_NAMES: Mapping[str, str] = {
    "published": "2015 law",
    "refit": "2015 law, refitted",
    "power-dimensionless": "power law, two constants",
    "power-clearance": "power law by clearance",
    "explicit": "explicit",
    "johnson": "Johnson",
}


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


def housing(bench: Bench) -> Group:  # noqa: ARG001
    """Return what a clamped housing adds to the penetration by Johnson's datum."""
    added = sorted(float(added_by_housing(ratio, HOUSING_PHI)) for ratio in CLAMPED)
    return {
        "ratios": _exact(CLAMPED, ""),
        "phi": Quantity(HOUSING_PHI, "", 1),
        "added": Quantity((added[0], added[1]), "%", 2),
    }


# --- first yield --------------------------------------------------------------------------------

Ductile = Literal["von Mises", "Tresca"]


def yielding(bench: Bench) -> Group:  # noqa: ARG001
    """Return the load at first yield of a steel pin in a steel hole, against the estimate."""
    far = _yield(YIELD_DR[0])
    return {
        "table": _yield_table(),
        "hole": Quantity(round(HOLE), "mm"),
        "E": Quantity(round(YIELD_E / 1e3), "GPa"),
        "nu": Quantity(YIELD_NU, "", 1),
        "stress": Quantity(round(STRENGTH), "MPa"),
        "mises_phi": Quantity(_yield(_even()).phi, "", 2),
        "tresca_phi": Quantity(_yield(_even("Tresca"), "Tresca").phi, "", 2),
        "wide": Quantity(far.ratio, "", 2),
        "snug": spread(_snug(), "", 3),
        "closest": Quantity(YIELD_DR[-1], "mm", 1),
        "too_much": Quantity(1 / _yield(YIELD_DR[-1]).ratio, "", 2),
    }


@dataclass(frozen=True)
class _Yield:
    """First yield at a clearance: f, f/(E*·ΔR), f over the estimate, f/(σ_Y·R), and the place."""

    load: float
    phi: float
    ratio: float
    strength: float
    depth: float
    body: str


@cache
def _yield(dR: float, criterion: Ductile = "von Mises") -> _Yield:
    """Return first yield at a clearance in mm."""
    steel = Material("steel", YIELD_E, YIELD_NU, yield_stress=STRENGTH)
    pair = CylinderPair.from_dR("internal", dR, steel, R_i=HOLE)
    at = first_yield(pair, criterion)
    load = float(at.load)
    return _Yield(
        load,
        load / (float(pair.E_star) * dR),
        load / float(yield_load(pair, "Hertz")),
        load / (STRENGTH * HOLE),
        float(at.depth),
        str(at.body),
    )


@cache
def _even(criterion: Ductile = "von Mises") -> float:
    """Return the ΔR in mm at which first yield and the estimate from Hertz's pressure agree."""
    root = brentq(lambda x: _yield(float(np.exp(x)), criterion).ratio - 1, -5.3, 0.0, xtol=1e-9)
    return float(np.exp(root))


def _snug() -> list[float]:
    """Return loads at first yield over σ_Y·R for clearances too small for the estimate."""
    return [_yield(float(dR)).strength for dR in np.geomspace(1e-3, _even(), 25)]


def _yield_table() -> pd.DataFrame:
    """Return loads at first yield by clearance."""
    rows = []
    for dR in YIELD_DR:
        at, tresca = _yield(dR), _yield(dR, "Tresca")
        rows.append(
            {
                Symbol(r"\Delta R,\ \mathrm{mm}"): f"{dR:g}",
                Symbol(r"\varphi"): f"{at.phi:.2g}",
                "von Mises, N/mm": f"{at.load:.0f}",
                "Tresca, N/mm": f"{tresca.load:.0f}",
                "Hertz, N/mm": f"{at.load / at.ratio:.0f}",
                "depth, mm": f"{at.depth:.2f}",
            }
        )
    return with_formulas(rows)


# --- what the text says in words ----------------------------------------------------------------


def _digits_are_linked() -> bool:
    """Return whether the published digits of a pin in a hole follow from two of them."""
    own = asdict(PUBLISHED["internal"])
    p = own["Y_log_scale"]
    tied = {"b": own["a"] / 10, "Y_log_exponent": -p / 10}
    tied |= {"Y_slope": p / 100, "Y_offset": 1 + p / 10}
    return all(abs(own[name] - value) < 1e-12 for name, value in tied.items())


def _never_the_optimum(bench: Bench) -> bool:
    """Return whether every search of all coefficients is below the published ones by 5 %."""
    names = (name for group in ALL_FREE.values() for name in group)
    return all(_published_ratio(bench.result(name)) > 1.05 for name in names)


def _moderate(bench: Bench) -> list[float]:
    """Return the largest difference in percent at moderate loads, of each material."""
    materials = paper.five_materials(bench).values()
    return [abs(largest_difference(material, WIDE).percent) for material in materials]


def _no_reading_meets(bench: Bench) -> bool:
    """Return whether no reading of the paper's two bounds is met."""
    claims = bench.module("claims.section34_differences")
    (wide,), (tight,) = claims.below_8_percent(bench), claims.below_4_percent(bench)
    return {wide.verdict, tight.verdict} == {"not reproduced"}


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


def _excess_is_of_stiffness(bench: Bench) -> bool:
    """Return whether two constants remove most of the squared excess over the bound, rollers."""
    two, three = bench.result("power-external"), bench.result("external")
    assert three.bound is not None
    left = two.objective.value**2 - three.bound**2
    return left < 0.5 * (three.objective.value**2 - three.bound**2)


HOLDS: dict[str, Callable[[Bench], bool]] = {
    "The printed switch is the point where the two branches meet": lambda _: (
        abs(y_crossing() - float(paper.Y_SWITCH)) < 1e-6
    ),
    "The printed digits are linked": lambda _: _digits_are_linked(),
    "readings that space them evenly end in another minimum": lambda bench: (
        _highest_even(_differences(bench, "internal")) < -30
    ),
    "the samples hardly determine it": lambda bench: (
        _poor(bench.result("recovered-external")) == ["b"]
    ),
    "With all coefficients free, the published ones are not the optimum": _never_the_optimum,
    "so most of the excess comes from the linear stiffness": _excess_is_of_stiffness,
    "The penetration follows in closed form": lambda _: _closed_form_error() < 1e-12,
    "leaving out $\\beta$ alone is worse than leaving out both": _alpha_alone_is_worse,
    "is already closer than the published law": _one_power_law_is_nearer,
    "differs much from Johnson's law only where Johnson's law differs from conformal contact": (
        _differs_where_johnson_does
    ),
    "no material keeps within the smaller bound": lambda bench: min(_moderate(bench)) > TIGHT,
    "Neither bound is met for all materials under any other reading": _no_reading_meets,
    "The hole yields first": lambda _: all(_yield(dR).body == "hole" for dR in YIELD_DR),
    "below its surface for wide clearances and on it for close fits": lambda _: (
        _yield(YIELD_DR[0]).depth > 0.1 and _yield(YIELD_DR[-1]).depth == 0
    ),
    "the load at first yield hardly depends on the clearance": lambda _: (
        max(_snug()) < 1.1 * min(_snug())
    ),
}
