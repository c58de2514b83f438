"""Values of the manuscript: restitution, and the slider-crank with a clearance joint."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import product

import numpy as np
import pandas as pd

from cylcontact.impact import FACTORS, achieved_restitution, exact_factor, hysteresis_factor
from cylcontact.joint.clearance import TANGENT_FROM
from cylcontact.limits import yield_load
from cylcontact.mechanism import Case
from cylcontact.mechanism.batch_means import BATCHES
from cylcontact.mechanism.study import AGREEMENT
from cylcontact.reports.bench import Bench
from cylcontact.reports.manuscript import number
from cylcontact.support.arrays import FloatArray

from ..claims.section4 import first_impact
from ..long_runs import (
    FEW,
    FIRST,
    LEVEL,
    LIGHT_SET,
    LONG_SET,
    MANY,
    SETS,
    SPEC_SET,
    LongRun,
    is_lossless,
    long_runs,
    statistics_table,
)
from ..paper import FRICTIONS, JOINT_CLEARANCES, JOINT_LAWS, RESTITUTIONS
from ..slider_crank import CASES, RECOMMENDED, mechanism
from .law_values import STRENGTH, Values, spread

LARGE, SMALL = JOINT_CLEARANCES


SPHERE, JOHNSON, ENHANCED = JOINT_LAWS


WANTED = (0.1, 0.3, 0.5, 0.7, 0.9)


PAPER_FACTOR = "lankarani-nikravesh"


SHORT_LAWS = {
    SPHERE: "LN",
    JOHNSON: "Johnson",
    ENHANCED: "2015 law",
    RECOMMENDED: "explicit",
}


FORCES = {"mean_force_N": "mean", "max_force_N": "peak"}


# Half-widths below this share of the mean are not printed.
NARROW = 5e-4


JOINT_COLUMNS = (r"$\Delta R,\ \mathrm{mm}$", "$c_e$", "$c_f$")


def restitution(bench: Bench) -> Values:
    """Return what a restitution becomes under the published factors."""
    assert _later_closer(), "each later factor is closer than every older one"
    wanted = float(mechanism(bench).clearance.contact.data["dissipation"]["restitution"])
    chi = float(hysteresis_factor(PAPER_FACTOR)(wanted))
    achieved = float(achieved_restitution(chi))
    largest_chi = float(hysteresis_factor(PAPER_FACTOR)(np.nextafter(0.0, 1.0)))
    return {
        "wanted": number(wanted, "", 1),
        "factor": number(chi, "", 4),
        "achieved": number(achieved, "", 4),
        "exact": number(float(exact_factor(wanted)), "", 4),
        "loss": number(100 - 100 * _lost(achieved) / _lost(wanted), "%", 2),
        "least": number(float(achieved_restitution(largest_chi)), "", 3),
    }


def _lost(e: float) -> float:
    """Return the share of the energy that an impact of restitution e loses."""
    return 1 - e**2


def _achieved(name: str) -> FloatArray:
    """Return the restitutions that a factor achieves for those of `WANTED`."""
    return achieved_restitution(hysteresis_factor(name)(np.array(WANTED)))


def _later_closer() -> bool:
    """Whether the largest error of each later factor is below that of every older one."""
    wanted = np.array(WANTED)
    oldest = ("hunt-crossley", "herbert-mcwhannell", "lee-wang", PAPER_FACTOR)
    later = [name for name in FACTORS if name not in (*oldest, "exact")]
    error = {name: float(np.abs(_achieved(name) - wanted).max()) for name in (*oldest, *later)}
    return max(error[name] for name in later) < min(error[name] for name in oldest)


def crank(bench: Bench) -> Values:
    """Return the slider-crank: what is assumed, how it is computed, and what it does."""
    assert _walled(bench), "all of them have the smaller restitution and end in permanent contact"
    force = _rows(bench, clearance=LARGE, restitution=0.9, friction=0.1)["mean_force_N"]
    assert force.max() / force.min() < 1.01, "all four laws give the same mean force"
    return {
        **_assumed(bench),
        **_computed(bench),
        **_by_law(bench),
        "wall_force": spread(force / 1e3, "kN", 3),
        "whirl": number(100 * _widest(bench), "%", 2),
        "tangent": number(100 * TANGENT_FROM, "%", 2),
        "table": _force_table(bench),
    }


def _assumed(bench: Bench) -> Values:
    """Return the numbers of the mechanism, the paper's and the assumed ones."""
    model = mechanism(bench)
    own = model.data
    longer = LongRun(LONG_SET, CASES[0], 1).mechanism(own).data["bodies"]
    lighter = LongRun(LIGHT_SET, CASES[0], 1).mechanism(own).data["bodies"]
    pair, bodies = model.clearance.contact.pair, own["bodies"]
    values: Values = {
        "speed": number(60 / model.period, "rpm", 4),
        "radius": number(float(np.asarray(pair.R_i)), "mm", 2),
        "large": number(LARGE, "mm", 1),
        "small": number(SMALL, "mm", 1),
        "elastic": number(max(RESTITUTIONS), "", 1),
        "restitution": number(min(RESTITUTIONS), "", 1),
        "dry": number(min(FRICTIONS), "", 1),
        "friction": number(max(FRICTIONS), "", 1),
        "cases": len(CASES),
        "lighter": number(100 * lighter["rod"]["mass"] / bodies["rod"]["mass"], "%", 2),
    }
    for prefix, parts in (("", bodies), ("longer_", longer)):
        values[f"{prefix}rod"] = number(_length(parts["rod"]), "mm", 3)
        for name in ("rod", "slider"):
            values[f"{prefix}{name}_mass"] = number(parts[name]["mass"], "kg", 2)
    values["crank"] = number(_length(bodies["crank"]), "mm", 2)
    return values | {"crank_mass": number(bodies["crank"]["mass"], "kg", 2)}


def _length(body: Mapping[str, Mapping[str, list[float]]]) -> float:
    """Return the distance between the two points of a body in mm."""
    one, other = body["points"].values()
    return 1e3 * math.dist(one, other)


def _tolerances(bench: Bench) -> pd.DataFrame:
    """Return the cases, how many revolutions two tolerances agree for, and how many were run."""
    columns = (
        *("law", "clearance_mm", "restitution", "friction"),
        *("tolerance", "against", "revolutions", "horizon_revolutions"),
    )
    return bench.table("datasets/mechanism/cases.csv", columns, "make mechanism writes it")


def _parted(bench: Bench) -> pd.DataFrame:
    """Return the cases in which two tolerances part."""
    rows = _tolerances(bench)
    return rows[rows["horizon_revolutions"] < rows["revolutions"]]


def _walled(bench: Bench) -> bool:
    """Whether all cases that two tolerances agree on dissipate and end in permanent contact."""
    rows = _tolerances(bench)
    agreeing = rows[rows["horizon_revolutions"] >= rows["revolutions"]]
    keys = ["law", "clearance", "restitution", "friction"]
    names = agreeing[["law", "clearance_mm", "restitution", "friction"]].to_numpy().tolist()
    shares = statistics_table(bench).set_index(keys).loc[list(map(tuple, names))]
    always = (shares["contact_fraction"] == 1.0).all()
    return bool((agreeing["restitution"] < 1).all() and always)


def _computed(bench: Bench) -> Values:
    """Return tolerances, the balance of energy, and the lengths of the runs."""
    rows, parted = _tolerances(bench), _parted(bench)
    runs = long_runs(bench)
    runs = runs[runs["design"].isin(SETS)]
    return {
        "tolerance": number(float(rows["tolerance"].iloc[0]), "", 1),
        "tighter": number(float(rows["against"].iloc[0]), "", 1),
        "together": len(rows) - len(parted),
        "parted": len(parted),
        "compared": int(rows["revolutions"].iloc[0]),
        "horizon": spread(parted["horizon_revolutions"], "", 2),
        "agreement": number(100 * AGREEMENT, "%", 1),
        "runs": len(runs),
        "balance": number(float(runs["energy_error"].max()), "", 1),
        "many": MANY,
        "few": FEW,
        "first": FIRST,
        "batches": BATCHES,
        "level": number(100 * LEVEL, "%", 2),
    }


def _rows(bench: Bench, design: str = SPEC_SET, **chosen: float | str) -> pd.DataFrame:
    """Return the numbers of the cases with some conditions."""
    rows = statistics_table(bench, design)
    for name, value in chosen.items():
        rows = rows[rows[name] == value]
    return rows


def _by_law(bench: Bench) -> Values:
    """Return what the law changes: the peak of one impact; and what it does not, on the wall."""
    peaks = {
        law: float(first_impact(bench, SPEC_SET, law, SMALL).contacts["max_force_N"].iloc[0])
        for law in SHORT_LAWS
    }
    over = {law: 100 * (peak / peaks[RECOMMENDED] - 1) for law, peak in peaks.items()}
    wall = _rows(bench, restitution=0.9, friction=0.1).groupby("clearance")
    drops = peaks[RECOMMENDED] / 1e3
    steel = mechanism(bench).clearance.contact.pair
    yields = {name: _first_yield(bench, dR) for name, dR in (("large", LARGE), ("small", SMALL))}
    assert drops < yields["small"], "the impact at the small clearance stays below first yield"
    flights = _rows(bench, clearance=LARGE)
    flights = flights[(flights["restitution"] == 1) | (flights["friction"] == 0)]
    assert flights["max_force_N"].min() > 1e3 * yields["large"], "at the large one they do not"
    apart = [
        100 * float((wall[name].max() / wall[name].min() - 1).max())
        for name in ("mean_force_N", "drive_work_J")
    ]
    return {
        "peak": number(drops, "kN", 3),
        "E": number(round(float(steel.material_i.E) / 1e3), "GPa"),
        "nu": number(float(steel.material_i.nu), "", 1),
        **{f"yield_{name}": number(load, "kN", 2) for name, load in yields.items()},
        "peak_johnson": number(over[JOHNSON], "%", 2),
        "peak_enhanced": number(over[ENHANCED], "%", 1),
        "peak_sphere": number(-over[SPHERE], "%", 1),
        "drive_work": spread(wall["drive_work_J"].mean(), "J", 3),
        "wall_apart": number(max(apart), "%", 1),
    }


def _first_yield(bench: Bench, dR: float) -> float:
    """Return the force in kN at which the joint first yields by von Mises, of a steel assumed."""
    joint = mechanism(bench, Case(RECOMMENDED, dR, 0.9, 0.0)).clearance.contact
    return (
        float(yield_load(joint.pair, yield_stress=STRENGTH))
        * float(joint.pair.contact_length("the joint"))
        / 1e3
    )


def _widest(bench: Bench) -> float:
    """Return the largest half-width of a force of the table, relative, of runs with losses."""
    rows = _rows(bench)
    rows = rows[(rows["restitution"] < 1) | (rows["friction"] > 0)]
    return max(float((rows[f"{name}_half_width"] / rows[name]).max()) for name in FORCES)


def _force_table(bench: Bench) -> pd.DataFrame:
    """Return mean and largest forces in kN with their intervals, a row for each joint."""
    rows = []
    for joint in product(JOINT_CLEARANCES, RESTITUTIONS, FRICTIONS):
        cells: dict[str, str] = dict(zip(JOINT_COLUMNS, map("{:g}".format, joint), strict=True))
        c, e, friction = joint
        cases = _rows(bench, clearance=c, restitution=e, friction=friction).to_dict("records")
        numbers = {row["law"]: row for row in cases}
        for column, word in FORCES.items():
            for law, short in SHORT_LAWS.items():
                row = numbers[law]
                half = row[f"{column}_half_width"] / 1e3
                steady = not is_lossless(Case(law, *joint))
                cells[f"{word}, {short}"] = _interval(row[column] / 1e3, half, steady)
        rows.append(cells)
    return pd.DataFrame(rows)


def _interval(mean: float, half: float, steady: bool) -> str:
    """Return a mean with its half-width to two digits; a star where nothing is steady."""
    if not steady:
        return f"{mean:#.2g}*".replace(".*", "*")
    if half < NARROW * mean:
        return f"{mean:#.3g}"
    decimals = max(0, 1 - math.floor(math.log10(half)))
    return f"{mean:.{decimals}f} ± {half:.{decimals}f}"
