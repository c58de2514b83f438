"""Values of the manuscript: finite elements, restitution, the slider-crank and the ledger."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import lru_cache
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd

from cylcontact.arrays import FloatArray
from cylcontact.impact import FACTORS, achieved_restitution, exact_factor, hysteresis_factor
from cylcontact.mechanism import Case
from cylcontact.mechanism.batch_means import BATCHES
from cylcontact.mechanism.joint import TANGENT_FROM
from cylcontact.mechanism.study import AGREEMENT
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Claim, Verdict
from cylcontact.reports.claims import ledger as claims_of
from cylcontact.reports.claims_text import counts
from cylcontact.reports.manuscript import Group, Value
from cylcontact.reports.quantity import Quantity, Symbol

from ..claims.section4 import first_impact
from ..claims.section32 import (
    BOUNDS,
    LOADS,
    compared,
    largest,
    law_differences,
    to_elements,
)
from ..fig_bifurcation import COLUMNS as SECTIONS
from ..fig_bifurcation import FILE as BIFURCATION
from ..finite_elements import penetrations, sensitivity_table, study, table
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
from ..paper import FIG6_WIDE, FRICTIONS, JOINT_CLEARANCES, JOINT_LAWS, RESTITUTIONS
from ..slider_crank import CASES, RECOMMENDED, law_limit, mechanism
from .law_values import spread, with_formulas

LARGE, SMALL = JOINT_CLEARANCES
SPHERE, JOHNSON, ENHANCED = JOINT_LAWS


# Finite elements.


def elements(bench: Bench) -> Group:
    """Return the check by finite elements: loads, solvers, laws, and the paper's bounds."""
    setup = study(bench, "recommended").setups["base"]
    rows = table(bench, "recommended")
    other = table(bench, "recommended", "calculix")
    solvers = 100 * (other["penetration_mm"] / rows["penetration_mm"] - 1)
    return {
        "clearances": spread(rows["dR_mm"], "mm", 2),
        "lightest": Quantity(float(rows["load_N_per_mm"].min()), "N/mm", 2),
        "middle": Quantity(LOADS[1], "N/mm", 2),
        "heaviest": Quantity(float(rows["load_N_per_mm"].max()), "N/mm", 3),
        "ratio": Quantity(setup.outer_ratio, "", 2),
        "solvers": Quantity(float(solvers.abs().max()), "%", 2),
        "mesh": _of_the_mesh(bench),
        **_laws_to_elements(bench),
        "switch": Quantity(FIG6_WIDE, "mm", 3),
        "bound_everywhere": Quantity(round(float(str(BOUNDS[0]["percent"]))), "%"),
        "bound_above": Quantity(round(float(str(BOUNDS[1]["percent"]))), "%"),
    }


def _of_the_mesh(bench: Bench) -> Quantity:
    """Return what elements of half the size change."""
    changes = sensitivity_table(table(bench, "sensitivity")).groupby("variant")["change_percent"]
    halved = changes.get_group("32 cells instead of 16").abs()
    return Quantity(float(halved.max()), "%", 1)


def _laws_to_elements(bench: Bench) -> Group:
    """Return how far the laws are from finite elements."""
    values: dict[str, Value] = {}
    rows = penetrations(table(bench, "recommended"))
    wide = rows[rows["dR_mm"] >= LARGE_ENOUGH]
    values["johnson_wide"] = Quantity(abs(largest(to_elements(wide, JOHNSON))), "%", 1)
    for law in (JOHNSON, "persson"):
        values[law] = Quantity(abs(largest(to_elements(rows, law))), "%", 2)
    for name, load in zip(("lightest", "middle", "heaviest"), LOADS, strict=True):
        off = largest(to_elements(compared(bench, "recommended", 0.0, (load,)), ENHANCED))
        values[f"enhanced_{name}"] = Quantity(abs(off), "%", 3)
    setup = study(bench, "recommended").setups["base"]
    worst = rows.iloc[int(np.abs(to_elements(rows, JOHNSON)).argmax())]
    pair = setup.pair(float(worst["dR_mm"]))
    return values | {
        "from": Quantity(LARGE_ENOUGH, "mm", 1),
        "johnson_phi": Quantity(float(worst["load_N_per_mm"] / (pair.E_star * pair.dR)), "", 2),
    }


# From this ΔR in mm on Johnson's law and finite elements agree; ours, for the text.
LARGE_ENOUGH = 0.05


# Restitution.

WANTED = (0.1, 0.3, 0.5, 0.7, 0.9)
PAPER_FACTOR = "lankarani-nikravesh"


def restitution(bench: Bench) -> Group:
    """Return what a restitution becomes under the published factors."""
    wanted = float(mechanism(bench).clearance.contact.data["dissipation"]["restitution"])
    chi = float(hysteresis_factor(PAPER_FACTOR)(wanted))
    achieved = float(achieved_restitution(chi))
    largest_chi = float(hysteresis_factor(PAPER_FACTOR)(np.nextafter(0.0, 1.0)))
    return {
        "wanted": Quantity(wanted, "", 1),
        "factor": Quantity(chi, "", 4),
        "achieved": Quantity(achieved, "", 4),
        "exact": Quantity(float(exact_factor(wanted)), "", 4),
        "loss": Quantity(100 - 100 * _lost(achieved) / _lost(wanted), "%", 2),
        "least": Quantity(float(achieved_restitution(largest_chi)), "", 3),
    }


def _lost(e: float) -> float:
    """Return the share of the energy that an impact of restitution e loses."""
    return 1 - e**2


def _achieved(name: str) -> FloatArray:
    """Return the restitutions that a factor achieves for those of `WANTED`."""
    return achieved_restitution(hysteresis_factor(name)(np.array(WANTED)))


# The slider-crank.


def crank(bench: Bench) -> Group:
    """Return the slider-crank: what is assumed, how it is computed, and what it does."""
    return {
        **_assumed(bench),
        **_computed(bench),
        **_contacts(bench),
        **_by_law(bench),
        **_limit(bench),
        **_kept_rates(bench),
        "table": _force_table(bench),
    }


def _assumed(bench: Bench) -> Group:
    """Return the numbers of the mechanism, the paper's and the assumed ones."""
    model = mechanism(bench)
    own = model.data
    longer = LongRun(LONG_SET, CASES[0], 1).mechanism(own).data["bodies"]
    lighter = LongRun(LIGHT_SET, CASES[0], 1).mechanism(own).data["bodies"]
    pair, bodies = model.clearance.contact.pair, own["bodies"]
    values: dict[str, Value] = {
        "speed": Quantity(60 / model.period, "rpm", 4),
        "radius": Quantity(float(np.asarray(pair.R_i)), "mm", 2),
        "large": Quantity(LARGE, "mm", 1),
        "small": Quantity(SMALL, "mm", 1),
        "elastic": Quantity(max(RESTITUTIONS), "", 1),
        "restitution": Quantity(min(RESTITUTIONS), "", 1),
        "dry": Quantity(min(FRICTIONS), "", 1),
        "friction": Quantity(max(FRICTIONS), "", 1),
        "cases": Quantity(len(CASES)),
        "lighter": Quantity(100 * lighter["rod"]["mass"] / bodies["rod"]["mass"], "%", 2),
    }
    for prefix, parts in (("", bodies), ("longer_", longer)):
        values[f"{prefix}rod"] = Quantity(_length(parts["rod"]), "mm", 3)
        for name in ("rod", "slider"):
            values[f"{prefix}{name}_mass"] = Quantity(parts[name]["mass"], "kg", 2)
    values["crank"] = Quantity(_length(bodies["crank"]), "mm", 2)
    return values | {"crank_mass": Quantity(bodies["crank"]["mass"], "kg", 2)}


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


def _computed(bench: Bench) -> Group:
    """Return tolerances, the balance of energy, and the lengths of the runs."""
    rows, parted = _tolerances(bench), _parted(bench)
    runs = long_runs(bench)
    runs = runs[runs["design"].isin(SETS)]
    return {
        "tolerance": Quantity(float(rows["tolerance"].iloc[0]), "", 1),
        "tighter": Quantity(float(rows["against"].iloc[0]), "", 1),
        "together": Quantity(len(rows) - len(parted)),
        "parted": Quantity(len(parted)),
        "compared": Quantity(int(rows["revolutions"].iloc[0])),
        "horizon": spread(parted["horizon_revolutions"], "", 2),
        "agreement": Quantity(100 * AGREEMENT, "%", 1),
        "runs": Quantity(len(runs)),
        "balance": Quantity(float(runs["energy_error"].max()), "", 1),
        "many": Quantity(MANY),
        "few": Quantity(FEW),
        "first": Quantity(FIRST),
        "batches": Quantity(BATCHES),
        "level": Quantity(100 * LEVEL, "%", 2),
    }


def _rows(bench: Bench, design: str = SPEC_SET, **chosen: float | str) -> pd.DataFrame:
    """Return the numbers of the cases with some conditions."""
    rows = statistics_table(bench, design)
    for name, value in chosen.items():
        rows = rows[rows[name] == value]
    return rows


def _shares(rows: pd.DataFrame, digits: int = 2) -> Quantity:
    """Return the range of the shares of the time in contact, in percent."""
    return spread(100 * rows["contact_fraction"], "%", digits)


def _ratios(after: pd.DataFrame, before: pd.DataFrame, column: str) -> Quantity:
    """Return the range of the ratios of a number in two groups of cases, law by law."""
    keys = ["law", "clearance"]
    both = after.set_index(keys)[column] / before.set_index(keys)[column]
    return spread(both, "", 2)


def _contacts(bench: Bench) -> Group:
    """Return shares of the time in contact and forces, and the verdicts on the mechanism."""
    lossy = _rows(bench, restitution=0.9, friction=0.0)
    elastic = _rows(bench, restitution=1.0, friction=0.0)
    claims = _of_mechanism(bench)
    number = counts(claims)
    return {
        "rough_share": _shares(_rows(bench, clearance=LARGE, restitution=1.0, friction=0.1)),
        "wall_force": spread(_wall_force(bench) / 1e3, "kN", 3),
        "elastic_force": _ratios(elastic, lossy, "mean_force_N"),
        "whirl": Quantity(100 * _widest(bench), "%", 2),
        "open": Quantity(number["undecided"]),
        "hanging": Quantity(number["depends on a missing input"]),
        "stands": Quantity(number["reproduced"] + number["reproduced with a stated choice"]),
        "judged": Quantity(len(claims)),
    }


def _by_law(bench: Bench) -> Group:
    """Return what the law changes: the peak of one impact; and what it does not, on the wall."""
    peaks = {
        law: float(first_impact(bench, SPEC_SET, law, SMALL).contacts["max_force_N"].iloc[0])
        for law in SHORT_LAWS
    }
    over = {law: 100 * (peak / peaks[RECOMMENDED] - 1) for law, peak in peaks.items()}
    wall = _rows(bench, restitution=0.9, friction=0.1).groupby("clearance")
    apart = [
        100 * float((wall[name].max() / wall[name].min() - 1).max())
        for name in ("mean_force_N", "drive_work_J")
    ]
    return {
        "peak": Quantity(peaks[RECOMMENDED] / 1e3, "kN", 3),
        "peak_johnson": Quantity(over[JOHNSON], "%", 2),
        "peak_enhanced": Quantity(over[ENHANCED], "%", 1),
        "peak_sphere": Quantity(-over[SPHERE], "%", 1),
        "drive_work": spread(wall["drive_work_J"].mean(), "J", 3),
        "wall_apart": Quantity(max(apart), "%", 1),
    }


def _wall_force(bench: Bench) -> pd.Series[float]:
    """Return the mean forces in N in permanent contact at the large clearance, by law."""
    rows = _rows(bench, clearance=LARGE, restitution=0.9, friction=0.1)
    return rows["mean_force_N"]


def _widest(bench: Bench) -> float:
    """Return the largest half-width of a force of the table, relative, of runs with losses."""
    rows = _rows(bench)
    rows = rows[(rows["restitution"] < 1) | (rows["friction"] > 0)]
    return max(float((rows[f"{name}_half_width"] / rows[name]).max()) for name in FORCES)


def _limit(bench: Bench) -> Group:
    """Return the largest penetrations at the small clearance against the end of Johnson's law."""
    values: dict[str, Value] = {
        "limit": Quantity(_johnson_limit(bench), "µm", 4),
        "tangent": Quantity(100 * TANGENT_FROM, "%", 2),
    }
    for name, friction in (("lossless", 0.0), ("elastic", 0.1)):
        row = _deep(bench, SPEC_SET, restitution=1.0, friction=friction).iloc[0]
        values[f"deepest_{name}"] = Quantity(float(row["deepest_um"]), "µm", 3)
        values[f"passed_{name}"] = Quantity(float(100 * row["left"]), "%", 2)
    lossy = float(_deep(bench, SPEC_SET, restitution=0.9)["deepest_um"].max())
    values["deepest_lossy"] = Quantity(lossy, "µm", 3)
    return values


def _johnson_limit(bench: Bench) -> float:
    """Return the largest penetration of Johnson's law in µm at the small clearance."""
    return 1e3 * law_limit(mechanism(bench, Case(JOHNSON, SMALL, 0.9, 0.0)))


def _deep(bench: Bench, design: str, **chosen: float) -> pd.DataFrame:
    """Return runs with Johnson's law at the small clearance."""
    return _rows(bench, design, law=JOHNSON, clearance=SMALL, **chosen)


def _kept_rates(bench: Bench) -> Group:
    """Return the motions of the bifurcation study: by the rate of the onset and by one held."""
    rows = bench.table(BIFURCATION, SECTIONS, "make bifurcation computes it")
    rows = rows.fillna({"held_m_per_s": 0.0})
    runs = rows.drop_duplicates(["held_m_per_s", "clearance_mm"], keep="last")
    held = float(runs["held_m_per_s"].max())
    periods = runs.pivot(index="clearance_mm", columns="held_m_per_s", values="period")
    return {
        "motions": Quantity(len(periods)),
        "held": Quantity(held, "m/s", 1),
        "single": Quantity(int((periods[0.0] == 1).sum())),
        "changed": Quantity(int((periods[0.0] != periods[held]).sum())),
    }


SHORT_LAWS = {
    SPHERE: "LN",
    JOHNSON: "Johnson",
    ENHANCED: "2015 law",
    RECOMMENDED: "explicit",
}
FORCES = {"mean_force_N": "mean", "max_force_N": "peak"}
# Half-widths below this share of the mean are not printed.
NARROW = 5e-4


JOINT_COLUMNS = (Symbol(r"\Delta R,\ \mathrm{mm}"), Symbol("c_e"), Symbol("c_f"))


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
    return with_formulas(rows)


def _interval(mean: float, half: float, steady: bool) -> str:
    """Return a mean with its half-width to two digits; a star where nothing is steady."""
    if not steady:
        return f"{mean:#.2g}*".replace(".*", "*")
    if half < NARROW * mean:
        return f"{mean:#.3g}"
    decimals = max(0, 1 - math.floor(math.log10(half)))
    return f"{mean:.{decimals}f} ± {half:.{decimals}f}"


# The ledger.

VERDICT_COLUMNS: Mapping[str, Verdict] = {
    "as printed": "reproduced",
    "with a choice": "reproduced with a stated choice",
    "not": "not reproduced",
    "undecided": "undecided",
    "missing input": "depends on a missing input",
}
HEADINGS = {
    "as printed": "reproduced as printed",
    "with a choice": "reproduced with a choice",
    "not": "not reproduced",
    "missing input": "depends on an input",
}
# Files of claims → what their statements are about.
TOPICS = {
    "section1": "range of the existing laws",
    "section2": "Johnson’s and other laws",
    "section31": "power-law fits, exponents",
    "section31_law": "form and range of the 2015 law",
    "section31_search": "search for its coefficients",
    "section32": "finite elements",
    "section33": "limits by yield and by algebra",
    "section34": "limits by material",
    "section34_differences": "difference of the two laws",
    "section4": "stiffness of the laws in the joint",
    "section4_runs": "contacts, forces and steps in it",
}


def _ledger(bench: Bench) -> tuple[Claim, ...]:
    """Return all claims, misprints among them; computed anew if an input has changed."""
    status = ((file, file.stat()) for file in bench.inputs)
    return _ledger_of(bench, frozenset((file, at.st_mtime_ns, at.st_size) for file, at in status))


@lru_cache(maxsize=1)
def _ledger_of(bench: Bench, _inputs: frozenset[tuple[Path, int, int]]) -> tuple[Claim, ...]:
    """Return all claims for inputs in one state."""
    return tuple(claims_of(bench))


def _claims(bench: Bench) -> list[Claim]:
    """Return the testable claims; misprints are left out."""
    return [c for c in _ledger(bench) if not c.misprint and c.finding.readings]


def _of_mechanism(bench: Bench) -> list[Claim]:
    """Return the claims on the runs of the slider-crank and its joint."""
    return [c for c in _claims(bench) if _topic(c) in ("section4", "section4_runs")]


def _values(bench: Bench, name: str) -> Mapping[str, float]:
    """Return the numbers of a claim."""
    return next(c for c in _ledger(bench) if c.id == name).finding.values


def _verdict(bench: Bench, name: str) -> Verdict:
    """Return the verdict of a claim."""
    return next(c for c in _ledger(bench) if c.id == name).verdict


def _topic(claim: Claim) -> str:
    """Return the file of a claim, or that of its section."""
    stem = Path(claim.code.partition(":")[0]).stem
    return stem if stem in TOPICS else "section" + claim.section.replace(".", "")


def ledger(bench: Bench) -> Group:
    """Return the ledger: counts, a table by section, and what is not reproduced."""
    claims = _claims(bench)
    number = counts(claims)
    readings = [len(c.finding.readings) for c in claims]
    misprints = sum(c.misprint for c in _ledger(bench))
    return {
        "statements": Quantity(len(claims)),
        "one_branch": Quantity(next(iter(_values(bench, "3.1-no-single-Y").values()))),
        "stand": Quantity(number["reproduced"] + number["reproduced with a stated choice"]),
        "untestable": Quantity(len(_ledger(bench)) - len(claims) - misprints),
        "misprints": Quantity(misprints),
        "readings": Quantity(sum(readings)),
        "most": Quantity(max(readings)),
        **{name.replace(" ", "_"): Quantity(number[v]) for name, v in VERDICT_COLUMNS.items()},
        "table": _ledger_table(claims),
        "failed": _failed_table(claims),
    }


def _ledger_table(claims: list[Claim]) -> pd.DataFrame:
    """Return the counts of the verdicts by section and topic, and their sums."""
    rows = [
        [", ".join(dict.fromkeys(c.section for c in group)), topic, *_counted(group)]
        for stem, topic in TOPICS.items()
        if (group := [c for c in claims if _topic(c) == stem])
    ]
    names = ["Sect.", "topic", "statements", *(HEADINGS.get(n, n) for n in VERDICT_COLUMNS)]
    return pd.DataFrame([*rows, ["all", "", *_counted(claims)]], columns=names)


def _counted(claims: list[Claim]) -> list[str]:
    """Return the number of claims, and of those with each verdict, as text."""
    number = counts(claims)
    columns = [len(claims), *(number[verdict] for verdict in VERDICT_COLUMNS.values())]
    return [str(count) if count else "–" for count in columns]


def _failed_table(claims: list[Claim]) -> pd.DataFrame:
    """Return the statements that no reading reproduces: the paper's number, ours, and why."""
    rows = []
    for c in claims:
        if c.verdict == "not reproduced":
            ours, reason = FAILED.get(c.id, (_as_found, ""))
            cells = (f"{c.statement} ({c.section})", c.paper, ours(c), reason)
            rows.append([_printed(cell) for cell in cells])
    return pd.DataFrame(rows, columns=["statement (section)", "paper", "ours", "reason"])


# Numbers of the paper's equations are not ours, and a unit stays with its number.
_SWAPS = {
    "'": "’",
    " %": "\u00a0%",
    " N/mm": "\u00a0N/mm",
    " µm": "\u00a0µm",
    " mm": "\u00a0mm",
    "the load at yield (Eq 7)": "the estimated load at yield",
    "by Eq 7 it": "the estimated load",
    " (Eq 6d)": "",
    "rms of ln δ": "rms of r",
}


def _printed(text: str) -> str:
    """Return a text of the ledger as it is printed here."""
    for old, new in _SWAPS.items():
        text = text.replace(old, new)
    return text


def _as_found(claim: Claim) -> str:
    """Return our value as the ledger has it."""
    return claim.finding.ours


def _first_part(claim: Claim) -> str:
    """Return our value up to its first semicolon."""
    return claim.finding.ours.partition(";")[0]


def _iteration(_claim: Claim) -> str:
    """Return what there is in place of an iteration."""
    return "a closed form"


def _extrapolated(claim: Claim) -> str:
    """Return the largest difference below the clearances of the fit and within them."""
    values = claim.finding.values
    below, within = values["below 50 um, percent"], values["50 um to the switch, percent"]
    return f"off by up to {below:.0f} % below the fitted clearances, {within:.0f} % within"


def _free_search(claim: Claim) -> str:
    """Return the published deviation over the least, with all coefficients searched."""
    names = [name for name in claim.finding.values if name.startswith("objective ratio, all")]
    ratios = [claim.finding.values[name] for name in names]
    return f"{min(ratios):.1f} to {max(ratios):.1f} times the least deviation, by the samples"


def _one_branch(claim: Claim) -> str:
    """Return the deviation with one branch, and as published."""
    return claim.finding.ours.partition(": ")[2]


FAILED: Mapping[str, tuple[Callable[[Claim], str], str]] = {
    "2-johnson-needs-iteration": (_iteration, "Lambert's function inverts the law"),
    "3.1-Y-below-the-fit": (_extrapolated, "the branch is used outside the range of its fit"),
    "3.1-best-correlation-internal": (
        _free_search,
        "the printed coefficients are tied; a free search goes further",
    ),
    "3.1-no-single-Y": (_one_branch, "a fitted law with one branch is nearer than the printed one"),
    "3.4-allowable-load-against-modulus": (
        _as_found,
        "true of the end of Johnson's law, but not with the yield stress, which it also names",
    ),
    "3.4-limit-load-against-young": (
        _as_found,
        "the end of Johnson's law depends on the modulus so, and not on yielding",
    ),
    "3.4-below-8-percent": (
        _first_part,
        "largest where Johnson's law ends; above the bound elsewhere too",
    ),
    "3.4-below-4-percent": (_first_part, "a ridge where Y changes branch, for every material"),
    "4.3-small-clearance-larger-steps": (_first_part, "with a restitution of one the steps shrink"),
}


# What the text says in words.


def _no_load_keeps_both(_bench: Bench) -> bool:
    """Whether at each load the two laws alone break one of the bounds."""
    pairs = [(float(str(b["percent"])), law_differences(float(str(b["lowest"])))) for b in BOUNDS]
    return all(any(abs(off[load]) >= percent for percent, off in pairs) for load in LOADS)


def _johnson_falls_short(bench: Bench) -> bool:
    """Whether Johnson's law is furthest from the elements where φ is largest, and below them."""
    rows = penetrations(table(bench, "recommended"))
    error = to_elements(rows, JOHNSON).ravel()
    phi = (rows["load_N_per_mm"] / rows["dR_mm"]).to_numpy()
    worst = int(np.abs(error).argmax())
    return bool(error[worst] < 0 and phi.argmax() == worst)


def _walled(bench: Bench) -> bool:
    """Whether all cases that two tolerances agree on dissipate and end in permanent contact."""
    rows = _tolerances(bench)
    agreeing = rows[rows["horizon_revolutions"] >= rows["revolutions"]]
    keys = ["law", "clearance", "restitution", "friction"]
    names = agreeing[["law", "clearance_mm", "restitution", "friction"]].to_numpy().tolist()
    shares = statistics_table(bench).set_index(keys).loc[list(map(tuple, names))]
    always = (shares["contact_fraction"] == 1.0).all()
    return bool((agreeing["restitution"] < 1).all() and always)


def _stand(bench: Bench, *names: str) -> bool:
    """Whether claims are reproduced, and by every reading of them."""
    stated = [c for c in _ledger(bench) if c.id in names]
    return len(stated) == len(names) and all(
        c.verdict.startswith("reproduced") and all(r.holds for r in c.finding.readings)
        for c in stated
    )


def _settled(bench: Bench) -> bool:
    """Whether friction added to c_e = 0.9 keeps contact always, in every set of inertias."""
    rows = [_rows(bench, design, restitution=0.9, friction=0.1) for design in SETS]
    return all(bool((each["contact_fraction"] == 1).all()) for each in rows)


def _on_the_wall(bench: Bench) -> bool:
    """Whether the laws give the same mean force in permanent contact, within 1 %."""
    force = _wall_force(bench)
    return bool(force.max() / force.min() < 1.01)


def _elastic_steps_shrink(bench: Bench) -> bool:
    """Whether a smaller clearance shrinks the steps where c_e = 1, half of the cases, only."""
    steps = _values(bench, "4.3-small-clearance-larger-steps")
    before = {k: v for k, v in steps.items() if k.endswith(", before, us")}
    shrinks = {k: steps[k.replace("before", "after")] < before[k] for k in before}
    elastic = {k: "c_e = 1 " in k for k in before}
    return shrinks == elastic and 2 * sum(elastic.values()) == len(elastic)


def _one_failure(bench: Bench) -> bool:
    """Whether the steps' statement is the only one on the mechanism that is not reproduced."""
    failed = [c.id for c in _of_mechanism(bench) if c.verdict == "not reproduced"]
    return failed == ["4.3-small-clearance-larger-steps"]


def _later_closer(_bench: Bench) -> bool:
    """Whether the largest error of each later factor is below that of every older one."""
    wanted = np.array(WANTED)
    oldest = ("hunt-crossley", "herbert-mcwhannell", "lee-wang", PAPER_FACTOR)
    later = [name for name in FACTORS if name not in (*oldest, "exact")]
    error = {name: float(np.abs(_achieved(name) - wanted).max()) for name in (*oldest, *later)}
    return max(error[name] for name in later) < min(error[name] for name in oldest)


def _first_impact_only(bench: Bench) -> bool:
    """Whether with c_e = 0.9 the longer rod alone passes the limit, in one revolution."""
    limit = _johnson_limit(bench)
    others = [_deep(bench, design, restitution=0.9) for design in (SPEC_SET, LIGHT_SET)]
    longer = _deep(bench, LONG_SET, restitution=0.9)
    once = (longer["left"] * (longer["counted"] + FIRST)).round() == 1
    short = all(bool((each["deepest_um"] < limit).all()) for each in others)
    return short and bool(once.all())


HOLDS: dict[str, Callable[[Bench], bool]] = {
    "at each of the three loads the two laws alone": _no_load_keeps_both,
    "falls short as the contact widens": _johnson_falls_short,
    "All of them have the smaller restitution and end in permanent contact": _walled,
    "holds for every reading and every set of masses": lambda bench: _stand(
        bench,
        "4.3-longer-flights",
        "4.3-friction-fewer-flights",
        "4.3-friction-lowers-forces",
        "5-elastic-forces-are-large",
        "4.3-sphere-softest",
    ),
    "the journal never leaves the wall": _settled,
    "one revolution only is past the end": _first_impact_only,
    "all four laws give the same mean force": _on_the_wall,
    "in half of the comparisons they shrink, those with": _elastic_steps_shrink,
    "less energy than intended": lambda _bench: (
        _lost(float(_achieved(PAPER_FACTOR)[-1])) < _lost(WANTED[-1])
    ),
    "One statement fails": _one_failure,
    "The text does not say which is meant": lambda bench: (
        _verdict(bench, "4.3-friction-keeps-contact") == "undecided"
    ),
    "is below that of every older one": _later_closer,
    "depends on the missing masses": lambda bench: (
        _verdict(bench, "4.3-johnson-and-enhanced-alike") == "depends on a missing input"
    ),
}
