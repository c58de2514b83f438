"""Section 3.2: the finite-element check, judged by the committed tables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, Reading, check, claim, with_unit
from cylcontact.support.arrays import FloatArray, as_floats

from .. import paper
from ..finite_elements import penetrations, table
from ..paper import DATUM, FIG6_WIDE, STEEL, difference
from ..readings import found, reading

LOADS = (20.0, 40.0, 100.0)  # N/mm
# Load in N/mm → what speaks for it as the load of Fig 6.
FIG6_LOADS = {
    20.0: ("20 N/mm", "the load with which Fig 6 is introduced"),
    40.0: ("40 N/mm", "given for Fig 6 a sentence later"),
    100.0: ("100 N/mm", "the bounds are said to hold at the other loads too"),
}
FIG6_CLEARANCES = (0.005, 1.5)  # mm
BOUNDS = (
    {"percent": 10.0, "lowest": FIG6_CLEARANCES[0]},
    {"percent": 3.0, "lowest": FIG6_WIDE},
)
# Table of the bench → what a reading says of it.
SETUPS = {
    "recommended": "our set-up: plane strain, load spread over the pin, outer radius fitted to "
    "Johnson's law",
    "paper": "the paper's set-up: plane stress, load on the centre node, outer radius ours",
}
FREE = "datum chosen for best agreement with the laws"
MESH_PERCENT = 1.0
GROUNDS = {
    "penetration, load on the centre node": "the paper loads so, and Fig 6 is of penetrations"
}


def largest(percents: FloatArray) -> float:
    """Return the percentage of largest magnitude."""
    return float(percents.flat[np.abs(percents).argmax()])


def change_percent(rows: pd.DataFrame, column: str, variant: str, base: str = "base") -> float:
    """Return the largest change in percent from one variant of a study to another."""
    after, before = (rows.loc[rows["variant"] == name, column] for name in (variant, base))
    return largest(100 * (after.to_numpy() / before.to_numpy() - 1))


def clearances(lowest: float) -> FloatArray:
    """Return ΔR in mm from `lowest` to the end of Fig 6."""
    return np.geomspace(lowest, FIG6_CLEARANCES[1], 4001)


def law_differences(lowest: float) -> dict[float, float]:
    """Return Eq 9 where it is largest, in percent, by load in N/mm."""
    return {load: largest(difference(clearances(lowest), load, STEEL)) for load in LOADS}


@claim(
    "3.2-below-10-and-3-percent",
    f"Johnson's and the enhanced law differ by less than 10 % from 5 µm to 1.5 mm, and by less "
    f"than 3 % above {FIG6_WIDE:g} mm",
    paper="< 10 % and < 3 %",
    rule="|Eq 9| below both bounds",
    figures=("fig06",),
)
def below_both() -> Finding:
    """Return the largest difference between the two laws, load by load, over both ranges."""
    everywhere, wide = law_differences(FIG6_CLEARANCES[0]), law_differences(FIG6_WIDE)
    readings = [
        both_kept(choice, [(10.0, everywhere[load]), (3.0, wide[load])], ground)
        for load, (choice, ground) in FIG6_LOADS.items()
    ]
    return found(
        readings,
        "each load breaks at least one of the two bounds, whatever the datum: "
        + "; ".join(
            f"{each.ours} at {load:g} N/mm" for load, each in zip(LOADS, readings, strict=True)
        ),
        values={
            f"enhanced to Johnson, {load:g} N/mm, {where}, percent": off[load]
            for where, off in (("everywhere", everywhere), ("wide", wide))
            for load in LOADS
        },
    )


def both_kept(
    choice: str, pairs: Sequence[tuple[float, float]], ground: str = "", missing: str = ""
) -> Reading:
    """Return the reading by which differences in percent must each be within a bound."""
    checks = [check(value, "within", bound, "%") for bound, value in pairs]
    text = " and ".join(
        f"{each.ours} against {bound:g} %" for each, (bound, _) in zip(checks, pairs, strict=True)
    )
    misses = ", ".join(each.miss for each in checks if each.miss)
    return reading(choice, text, not misses, misses, missing, ground)


def compared(bench: Bench, name: str, lowest: float, loads: tuple[float, ...]) -> pd.DataFrame:
    """Return every model's penetration in a table, from a ΔR in mm on and at some loads."""
    rows = penetrations(table(bench, name))
    return rows[(rows["dR_mm"] >= lowest) & rows["load_N_per_mm"].isin(loads)]


def to_elements(rows: pd.DataFrame, *laws: str) -> FloatArray:
    """Return the laws' penetrations less that of finite elements, in percent, a column for each."""
    ratio = rows[[f"{law}_mm" for law in laws]].to_numpy() / rows[["fe_mm"]].to_numpy()
    return as_floats(100 * (ratio - 1))


def suited_difference(rows: pd.DataFrame, *laws: str) -> float:
    """Return the smallest bound in percent that the laws can keep to finite elements.

    Penetrations may count from anywhere: a constant times the load is added to those of the
    elements. Each law at each row bounds the constant from both sides.
    """
    ratio = 1 + to_elements(rows, *laws) / 100
    unit = (rows["load_N_per_mm"] / rows["fe_mm"]).to_numpy()[:, None]

    def gap(bound: float) -> float:
        lowest, highest = (ratio / (1 + bound) - 1) / unit, (ratio / (1 - bound) - 1) / unit
        return float(lowest.max() - highest.min())

    return 100 * float(brentq(gap, 0.0, 0.99, xtol=1e-12))


@claim(
    "3.2-finite-elements-below-10-and-3-percent",
    "finite elements differ from both laws by less than 10 % from 5 µm to 1.5 mm, and by less "
    f"than 3 % above {FIG6_WIDE:g} mm",
    paper="< 10 % and < 3 %",
    rule="each law within both bounds of finite elements",
    figures=("fig06", "fig_fe_sensitivity"),
)
def elements_below_both(bench: Bench) -> Finding:
    """Return how far the laws are from finite elements, by set-up and datum."""
    laws, at_20 = ("johnson", "enhanced"), LOADS[:1]
    off: dict[str, list[float]] = {}
    for name, setup in SETUPS.items():
        tables = [compared(bench, name, low, at_20) for low in (FIG6_CLEARANCES[0], FIG6_WIDE)]
        off[f"{setup}; 20 N/mm"] = [largest(to_elements(rows, *laws)) for rows in tables]
        off[f"{setup}, {FREE}; 20 N/mm"] = [suited_difference(rows, *laws) for rows in tables]
    readings = [
        both_kept(name, list(zip((10.0, 3.0), each, strict=True)), missing=DATUM)
        for name, each in off.items()
    ]
    own, _, as_printed, free = (each.ours for each in readings)
    return found(
        readings,
        f"at 20 N/mm the laws are {own} off finite elements in our set-up, {as_printed} in the "
        f"paper's, and {free} in the paper's with the {FREE}",
        values={
            f"{name}, {where}, percent": value
            for name, each in off.items()
            for where, value in zip(("everywhere", "wide"), each, strict=True)
        },
    )


@claim(
    "3.2-mesh-refinement",
    "further mesh refinement does not alter the results",
    paper="no change",
    rule=f"less than {MESH_PERCENT:g} % (ours) when the elements are halved",
    figures=("fig_fe_sensitivity",),
)
def mesh_refinement(bench: Bench) -> Finding:
    """Return the change of peak pressure and penetration on a finer mesh, in percent."""
    rows = table(bench, "sensitivity")
    variants = {
        "load on the centre node": ("the same on 32 cells", "load at the centre node"),
        "load spread over the pin": ("32 cells instead of 16", "base"),
    }
    changes = {
        f"{what}, {load}": change_percent(rows, column, *variants[load])
        for load in variants
        for what, column in (
            ("contact pressure (the forces checked)", "peak_pressure_MPa"),
            ("penetration", "penetration_mm"),
        )
    }
    pressure, penetration, *_ = changes.values()
    return found(
        [
            check(value, "within", MESH_PERCENT, "%", name, ground=GROUNDS.get(name, ""))
            for name, value in list(changes.items())[:2]
        ],
        "from 16 to 32 elements over the half-width the contact pressure changes by "
        f"{pressure:+.2f} %; the penetration under the paper's load on the centre node by "
        f"{penetration:+.1f} %",
        values=with_unit(changes, "percent"),
    )


@claim(
    "3.2-plane-stress-elements",
    "plane-stress elements can check laws whose modulus is that of plane strain",
    paper="plane stress elements; E* = E/(2(1 − ν²))",
    rule=f"the plane state changes the penetration by less than the section's bound, 3 % above "
    f"{FIG6_WIDE:g} mm and 10 % over all clearances",
    figures=("fig_fe_sensitivity",),
)
def plane_stress_elements(bench: Bench) -> Finding:
    """Return what plane stress changes, in percent."""
    rows = table(bench, "sensitivity")
    snug = rows["dR_mm"] < FIG6_WIDE
    small, wide = (
        change_percent(rows[part], "penetration_mm", "plane stress") for part in (snug, ~snug)
    )
    at_20 = rows[rows["load_N_per_mm"] == LOADS[0]].groupby("variant")
    slopes = {
        name: np.polyfit(np.log(group["dR_mm"]), group["penetration_mm"], 1)[0]
        for name, group in at_20
        if name in ("base", "plane stress")
    }
    slope = float(100 * (slopes["plane stress"] / slopes["base"] - 1))
    modulus = float(100 * (1 / (1 - paper.NU_REFERENCE**2) - 1))
    return found(
        [both_kept(f"same datum, above and below {FIG6_WIDE:g} mm", [(3.0, wide), (10.0, small)])],
        f"plane stress deepens the penetration by up to {max(small, wide):.1f} % and its slope "
        f"over ln ΔR by {slope:.1f} %, near the {modulus:.1f} % of 1/(1 − ν²)",
        values=with_unit(
            {
                f"below {FIG6_WIDE:g} mm": small,
                f"above {FIG6_WIDE:g} mm": wide,
                "slope": slope,
                "modulus": modulus,
            },
            "percent",
        ),
    )
