"""Values of the manuscript: the laws of a pin in a hole, its housing and first yield."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields
from functools import cache
from typing import Literal

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from cylcontact import laws
from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import CylinderPair
from cylcontact.datasets.finite_element import Setup, solve
from cylcontact.laws import arcs, explicit, explicit_pair
from cylcontact.laws.conformal import Bodies
from cylcontact.laws.housed import needs_series
from cylcontact.limits import first_yield, yield_load
from cylcontact.reports.bench import Bench
from cylcontact.reports.laws_bounds import (
    BOUNDED,
    departure_number,
    explicit_error,
    johnson_end,
    johnson_shortfall,
)
from cylcontact.reports.manuscript import number
from cylcontact.support.arrays import FloatArray, as_floats

from .. import fig_housing
from ..fig_any_pair import EDGE, PHI, possible_pairs
from ..fig_explicit import CLAMPED, added_by_housing
from ..joints import ALUMINIUM, STEEL, pair_of
from ..universal import EXAMPLE, UNIT_PAIR

Values = dict[str, object]


# Loads and clearances as in the paper, R_i = 10 mm; yield stress assumed.
HOLE, STRENGTH, YIELD_E, YIELD_NU = 10.0, 250.0, 200e3, 0.3


YIELD_DR = (2.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01)  # mm


# The joints of the finite elements: pin and plate, E in MPa and ν.
FE_STEEL, FE_ALUMINIUM, FE_PEEK = (207e3, 0.3), (70e3, 0.33), (3.6e3, 0.38)


Clamp = Literal["rim"] | laws.Sector
FE_JOINTS = ((FE_STEEL, FE_ALUMINIUM), (FE_ALUMINIUM, FE_STEEL), (FE_PEEK, FE_STEEL))


FE_RATIO, FE_PHI = 80.0, (0.03, 0.3, 3.0)


METALS = ((STEEL, ALUMINIUM), (ALUMINIUM, STEEL), (STEEL, "bronze"), ("bronze", STEEL))


JOINT_PHI = (0.01, 0.1, 1.0, 10.0)


HOUSING_PHI, HOUSED_PHI = 0.1, (0.01, 0.1, 1.0, 5.0)


SHARE = 0.99  # of the largest load; beyond it δ determines f badly


def spread(values: Iterable[float], unit: str = "", digits: int = 3) -> str:
    """Return the least and the largest of some values."""
    least, *_, most = sorted(map(float, values))
    return number((least, most), unit, digits)


def at_most(value: float, unit: str, digits: int) -> str:
    """Return a bound, rounded up."""
    step = _unit_of(value, digits)
    return number(step * math.ceil(value / step - 1e-9), unit, digits)


def at_least(value: float, unit: str, digits: int) -> str:
    """Return a lower bound, rounded down."""
    step = _unit_of(value, digits)
    return number(step * math.floor(value / step + 1e-9), unit, digits)


def _unit_of(value: float, digits: int) -> float:
    """Return the unit of the last of a number's digits."""
    return float(10.0 ** (math.floor(math.log10(value)) + 1 - digits))


def exact(ends: tuple[float, float], unit: str, digits: int = 3) -> str:
    """Return the ends of a range, whole numbers in full."""
    low, high = (int(end) if float(end).is_integer() else end for end in ends)
    return number((low, high), unit, digits)


def johnson(bench: Bench) -> Values:  # noqa: ARG001
    """Return the end of Johnson's law, how exact its inverse is, and where it departs."""
    assert _closed_form_error() < 1e-12, "the penetration follows in closed form"
    return {
        "end": johnson_end(),
        "round_trip": at_most(_round_trip(), "", 1),
        "share": number(round(100 * SHARE), "%"),
        "one": number(1, "%"),
        "one_phi": number(departure_number(1.0), "", 2),
        "many": number(10, "%"),
        "many_phi": number(departure_number(10.0), "", 2),
        "end_low": number(johnson_shortfall(johnson_end()), "%", 2),
        "limit_angle": number(_limit_angle(), "°", 4),
    }


def _limit_angle() -> float:
    """Return the semi-angle in degrees that no load reaches, for bodies of one material."""
    return float(np.degrees(Bodies(as_floats(0.5), 0.0, as_floats(0.0)).last.angle))


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


def explicit_law(bench: Bench) -> Values:  # noqa: ARG001
    """Return the constants of the explicit law and its largest errors."""
    errors = explicit_error()
    values: Values = {}
    values |= {
        "example_E": number(round(float(EXAMPLE.E) / 1e3), "GPa"),
        "example_nu": number(float(EXAMPLE.nu), "", 1),
    }
    for contact, constants in explicit.CALIBRATED.items():
        values |= {
            f"{contact}_{name}": number(value, "", 4 if value < 2 else 3)
            for name, value in asdict(constants).items()
        }
        values[f"{contact}_range"] = exact(BOUNDED[contact], "", 1)
        values[f"{contact}_load"] = at_most(errors[f"{contact} load"], "%", 2)
    return values


def pairs(bench: Bench) -> Values:
    """Return what two materials change, and how near the fast laws are."""
    assert _alpha_alone_is_worse(bench), "leaving out β alone is worse than leaving out both"
    metals = np.array([_of_E_star(bench, joint) for joint in METALS])
    of_parametric, of_explicit = map(_largest_error, (laws.Parametric(), laws.ExplicitPair()))
    return {
        "phi": exact((float(PHI[0]), float(PHI[-1])), "", 1),
        "alpha": number(EDGE, "", 3),
        "parametric": at_most(of_parametric, "%", 2),
        "explicit": at_most(of_explicit, "%", 2),
        "parametric_constants": len(fields(arcs.CALIBRATED)),
        "explicit_constants": len(fields(explicit_pair.CALIBRATED)),
        "metals": number((float(metals.min()), float(metals.max())), "%", 2),
        "plane_phi": 1,
        "highest_phi": round(JOINT_PHI[-1]),
        "grid": possible_pairs()[0].size,
        "any": number(_any_pair(), "%", 2),
        "eight": _eight_constants(),
        "eighteen": _eighteen_constants(),
        "newton": number(_of_newton(), digits=1),
    }


def _eight_constants() -> pd.DataFrame:
    """Return the constants of the polynomials of the arc, two of them exact."""
    own = asdict(arcs.CALIBRATED)
    signs = {name: f"${name[0].lower()}_{name[1]}$" for name in own}
    return pd.DataFrame([{sign: _signed(f"{own[name]:.4f}") for name, sign in signs.items()}])


def _eighteen_constants() -> pd.DataFrame:
    """Return the constants of the formula in one line: a row for each polynomial."""
    own = asdict(explicit_pair.CALIBRATED)
    terms = ("$1$", "$g$", r"$\beta$", "$g^2$", r"$g\beta$", r"$\beta^2$")
    names = {"A": r"$\ln A$", "B": r"$\ln B$", "D": "$D$", "G": "$G$"}
    cells = [
        [_signed(f"{own[key]:.4f}") if (key := f"{name}{k}") in own else "–" for k in range(6)]
        for name in names
    ]
    table = pd.DataFrame(cells, columns=list(terms))
    table.insert(0, "coefficient of", list(names.values()))
    return table


def _signed(cell: str) -> str:
    """Return a number with a true minus sign."""
    return cell.replace("-", "−")


def _of_newton() -> float:
    """Return the largest error of the load after four Newton steps, for one material."""
    d = laws.Persson().penetration(PHI, UNIT_PAIR)
    return float(np.abs(laws.Parametric().load(d, UNIT_PAIR) / PHI - 1).max())


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


def pins(bench: Bench) -> Values:
    """Return how far finite elements are from the series: two materials, and housings."""
    materials = [(Material("pin", *pin), Material("hole", *hole)) for pin, hole in FE_JOINTS]
    wide = [_off_elements(*each, FE_RATIO, "rim", HOLE / 1000, FE_PHI) for each in materials]
    pair, off = fig_housing.joint(bench), []
    solved = fig_housing.by_clamp_and_ratio(bench)
    for name, ratio, penetration in solved.to_numpy():
        clamp = fig_housing.CLAMPS[name][1]
        series = laws.Conformal(laws.Housing(fig_housing.R_I * ratio, clamp=clamp))
        off.append(abs(100 * (penetration / fig_housing.micrometres(series, pair) - 1)))
    return {
        "unlike": at_most(max(wide), "%", 2),
        "plate": round(FE_RATIO),
        "housings": at_most(max(off), "%", 1),
    }


def _off_elements(
    pin: Material, hole: Material, ratio: float, clamp: Clamp, dR: float, phi: Iterable[float]
) -> float:
    """Return the largest difference in percent of the elements' penetration from the series'."""
    own = {"pin_E": float(pin.E), "pin_nu": float(pin.nu)}
    setup = Setup(
        hole_radius=HOLE, outer_ratio=ratio, E=float(hole.E), nu=float(hole.nu), clamp=clamp, **own
    )
    pair = setup.pair(dR)
    loads = [each * float(pair.E_star) * dR for each in phi]
    one = laws.Conformal(laws.Housing(R_o=ratio * HOLE, clamp=clamp))
    found = [solution.penetration for solution in solve(setup, dR, loads)]
    return float(np.abs(100 * (found / one.penetration(loads, pair) - 1)).max())


def housing(bench: Bench) -> Values:
    """Return what a housing does, and how near its approximations are to the series."""
    pair = fig_housing.joint(bench)
    housings = [
        laws.Housing(fig_housing.R_I * ratio, clamp=clamp)
        for _, clamp in fig_housing.CLAMPS.values()
        for ratio in fig_housing.NAMED
    ]
    named = {
        (name, word): laws.Housing(fig_housing.R_I * ratio, clamp=fig_housing.CLAMPS[name][1])
        for name in ("rim", "near_60", "far_60")
        for word, ratio in (("thin", fig_housing.NAMED[0]), ("thick", fig_housing.NAMED[-1]))
    }
    plate, eye = float(yield_load(pair)), first_yield(pair, housing=named["far_60", "thin"])
    loads = float(eye.load), float(yield_load(pair, "Hertz"))
    assert loads[0] < loads[1], "Hertz's estimate is unsafe for eyes"
    compact = [each for each in housings if not needs_series(each, pair)]
    five = [laws.Explicit(datum=each).five_constants(pair) for each in housings]
    added = sorted(float(added_by_housing(ratio, HOUSING_PHI)) for ratio in CLAMPED)
    return {
        "ratios": exact(CLAMPED, ""),
        "phi": number(HOUSING_PHI, "", 1),
        "added": number((added[0], added[1]), "%", 2),
        "count": len(housings),
        "compact_count": len(compact),
        "compact": at_most(max(_off_in(each, pair) for each in compact), "%", 2),
        "five_count": sum(each.is_close for each in five),
        "five": at_most(max(100 * each.error for each in five if each.is_close), "%", 2),
        "phi_tested": exact((HOUSED_PHI[0], HOUSED_PHI[-1]), "", 1),
        **{
            f"{name}_{word}": number(fig_housing.micrometres(laws.Conformal(one), pair), "µm", 2)
            for (name, word), one in named.items()
        },
        "johnson": number(fig_housing.micrometres(laws.Johnson(), pair), "µm", 3),
        "plate_yield": number(plate / 1e3, "kN/mm", 2),
        "eye_yield": number(100 * float(eye.load) / plate, "%", 2),
        "eye_angle": number(round(float(eye.angle)), "°"),
        "thin": number(fig_housing.NAMED[0], "", 2),
        "thick": round(fig_housing.NAMED[-1]),
        "load": number(round(fig_housing.LOAD), "N/mm"),
        "R": number(fig_housing.R_I, "mm", 2),
        "dR": number(fig_housing.R_I - fig_housing.R_J, "mm", 1),
    }


def _off_in(one: laws.Housing, pair: CylinderPair) -> float:
    """Return the largest error of the load by Ritz's method in a housing, in percent."""
    loads = np.array(HOUSED_PHI) * float(pair.E_star * pair.dR)
    d = laws.Conformal(one).penetration(loads, pair)
    return float(np.abs(100 * (laws.Parametric(datum=one).load(d, pair) / loads - 1)).max())


Ductile = Literal["von Mises", "Tresca"]


def yielding(bench: Bench) -> Values:  # noqa: ARG001
    """Return the load at first yield of a steel pin in a steel hole, against the estimate."""
    far, near = _yield(YIELD_DR[0]), _yield(YIELD_DR[-1])
    assert all(_yield(dR).body == "hole" for dR in YIELD_DR), "the hole yields first"
    assert far.depth > 0.1 and near.depth == 0, "below its surface for wide clearances only"  # noqa: PT018
    assert max(_snug()) < 1.1 * min(_snug()), "hardly depends on the clearance"
    return {
        "table": _yield_table(),
        "hole": number(round(HOLE), "mm"),
        "E": number(round(YIELD_E / 1e3), "GPa"),
        "nu": number(YIELD_NU, "", 1),
        "stress": number(round(STRENGTH), "MPa"),
        "mises_phi": number(_yield(_even()).phi, "", 2),
        "tresca_phi": number(_yield(_even("Tresca"), "Tresca").phi, "", 2),
        "wide": number(far.ratio, "", 2),
        "snug": spread(_snug(), "", 3),
        "closest": number(YIELD_DR[-1], "mm", 1),
        "too_much": number(1 / near.ratio, "", 2),
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
                r"$\Delta R,\ \mathrm{mm}$": f"{dR:g}",
                r"$\varphi$": f"{at.phi:.2g}",
                "von Mises, N/mm": f"{at.load:.0f}",
                "Tresca, N/mm": f"{tresca.load:.0f}",
                "Hertz, N/mm": f"{at.load / at.ratio:.0f}",
                "depth, mm": f"{at.depth:.2f}",
            }
        )
    return pd.DataFrame(rows)
