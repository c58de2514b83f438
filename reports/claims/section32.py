"""Section 3.2: the finite-element check, judged by the committed tables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
import pandas as pd

from cylcontact import limits
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim, joined, verdict_if, with_unit

from ..finite_elements import (
    STRESS_LOAD,
    STRESS_LOAD_CHOICE,
    choices,
    penetrations,
    sensitivity_table,
    study,
    table,
)
from ..paper import FIG5_CLEARANCES, FIG6_WIDE

MODELS = {
    "fe": "finite elements",
    "johnson": "Johnson",
    "enhanced": "enhanced",
    "explicit": "our explicit law",
}
# Cells per half-width: the paper's "further refinement" starts from the first; the finest tried.
REFINED, FINEST = 16, 48
MESH_PERCENT = 0.2
HERTZ_PERCENT = 3.0
# (model, reference model, load in N/mm) → difference in percent of the reference.
Differences = Mapping[tuple[str, str, float], float]


@claim(
    "3.2-below-{percent:g}-percent",
    "finite elements, Johnson and the enhanced law agree to {percent:g} % {where}",
    paper="< {percent:g} %",
    rule="below {percent:g} % between each two of the three, at 20, 40 and 100 N/mm",
    cases=[
        {"percent": 10.0, "lowest": 0.0, "where": "from 5 µm to 1.5 mm"},
        {"percent": 3.0, "lowest": FIG6_WIDE, "where": f"at {FIG6_WIDE:g} mm and above"},
    ],
)
def below_percent(bench: Bench, percent: float, lowest: float) -> Finding:
    """Return the largest difference between each two models, load by load."""
    rows = table(bench, "recommended")
    to_fe = (("johnson", "fe"), ("enhanced", "fe"))
    off = largest_differences(rows, (*to_fe, ("enhanced", "johnson")), lowest)
    explicit = largest_differences(rows, (("explicit", "fe"),), lowest)
    # The set-up to the letter of the paper.
    letter = largest_differences(table(bench, "paper"), to_fe, lowest)
    return Finding(
        "largest difference in percent of the second: " + _by_pair(off),
        holds=max(map(abs, off.values())) < percent,
        choice=choices(bench),
        alternatives=joined(
            "beside them, " + _by_pair(explicit),
            "set-up to the letter (plane stress, load on the centre node), " + _by_pair(letter),
        ),
        values={
            f"{MODELS[one]} to {MODELS[other]}, {load:g} N/mm, percent": value
            for (one, other, load), value in {**off, **explicit}.items()
        },
        paper_values={"bound, percent": percent},
    )


def largest_differences(
    rows: pd.DataFrame, pairs: Iterable[tuple[str, str]], lowest: float
) -> Differences:
    """Return each pair's difference of largest magnitude at every load, from a ΔR in mm on."""
    differences = {}
    for one, other in pairs:
        for load, group in penetrations(rows[rows["dR_mm"] >= lowest]).groupby("load_N_per_mm"):
            off = 100 * (group[f"{one}_mm"] / group[f"{other}_mm"] - 1).to_numpy()
            differences[one, other, float(str(load))] = float(off[np.abs(off).argmax()])
    return differences


def _by_pair(differences: Differences) -> str:
    """Return "one to other a % (load), b % (load); ..."."""
    pairs: dict[str, list[str]] = {}
    for (one, other, load), value in differences.items():
        texts = pairs.setdefault(f"{MODELS[one]} to {MODELS[other]}", [])
        texts.append(f"{value:+.1f} % ({load:g} N/mm)")
    return "; ".join(f"{name} {', '.join(texts)}" for name, texts in pairs.items())


@claim(
    "3.2-same-trend",
    "the relation of penetration and clearance has the same trend at every load",
    paper="same trend at 20, 40 and 100 N/mm",
    rule="each model's penetration rises over the same steps of clearance at every load",
)
def same_trend(bench: Bench) -> Finding:
    """Return over how many steps of clearance each model's penetration falls, load by load."""
    rows = penetrations(table(bench, "recommended")).pivot(index="dR_mm", columns="load_N_per_mm")
    loads = rows.columns.unique("load_N_per_mm")
    falls: dict[str, dict[str, float]] = {}
    alike = []
    for model in ("fe", "johnson", "enhanced"):
        # A row for each step to the next clearance, a column for each load.
        falling = ~(np.diff(rows[f"{model}_mm"].to_numpy(), axis=0) > 0)
        falls[MODELS[model]] = {
            f"{load:g} N/mm": float(n) for load, n in zip(loads, falling.sum(axis=0), strict=True)
        }
        alike.append(bool((falling == falling[:, :1]).all()))
    return Finding(
        "; ".join(
            f"{model}: of {len(rows) - 1} steps to the next clearance "
            + ", ".join(f"{count:g} fall at {load}" for load, count in counts.items())
            for model, counts in falls.items()
        ),
        holds=all(alike),
        choice=choices(bench),
        values={
            f"steps that fall, {model}, {load}, -": count
            for model, counts in falls.items()
            for load, count in counts.items()
        },
    )


@claim(
    "3.2-mesh-refinement",
    "further mesh refinement does not alter the results",
    paper="no change",
    rule=f"less than {MESH_PERCENT:g} %, our bound",
)
def mesh_refinement(bench: Bench) -> Finding:
    """Return the change of penetration and peak pressure on a finer mesh, in percent."""
    choice, rows = choices(bench), table(bench, "convergence")
    coarse, fine = rows[rows["variant"] == f"cells {REFINED}"], rows[rows["variant"] == "base"]
    changes = {
        name: float(100 * np.abs(fine[column].to_numpy() / coarse[column].to_numpy() - 1).max())
        for name, column in (
            ("penetration", "penetration_mm"),
            ("peak pressure", "peak_pressure_MPa"),
        )
    }
    by_variant = sensitivity_table(table(bench, "sensitivity")).groupby("variant")["change_percent"]
    coarse_node, fine_node = (
        100 + by_variant.get_group(variant).to_numpy()
        for variant in ("load at the centre node", "the same on 32 cells")
    )
    at_node = max(100 * (fine_node / coarse_node - 1), key=abs)
    return Finding(
        ", ".join(f"{name} changes by {value:.2f} %" for name, value in changes.items())
        + f" at most from {REFINED} to {FINEST} cells over the contact's half-width",
        holds=max(changes.values()) < MESH_PERCENT,
        choice=choice,
        alternatives="with the load on the centre node, as the paper has it, the penetration "
        f"changes by {at_node:+.1f} % at most from 16 to 32 cells "
        f"{verdict_if(abs(at_node) < MESH_PERCENT)}",
        values={
            **with_unit(changes, "percent"),
            "penetration, load on the centre node, percent": at_node,
        },
    )


@claim(
    "3.2-hertz-{dR:g}-mm",
    "Hertz's theory still applies at a clearance of {dR:g} mm",
    paper="the shape of the contact stress confirms it",
    rule=f"within {HERTZ_PERCENT:g} % at {STRESS_LOAD:g} N/mm, our bound",
    cases=[{"dR": dR} for dR in FIG5_CLEARANCES],
)
def hertz_applies(bench: Bench, dR: float) -> Finding:
    """Return the peak pressure less Hertz's at one clearance, in percent, load by load."""
    rows = table(bench, "recommended")
    rows = rows[rows["dR_mm"] == dR]
    loads = rows["load_N_per_mm"].to_numpy()
    hertz = limits.hertz_stress(loads, study(bench, "recommended").setups["base"].pair(dR))
    percents = 100 * (rows["peak_pressure_MPa"].to_numpy() / hertz - 1)
    off = dict(zip(loads.tolist(), percents.tolist(), strict=True))
    return Finding(
        f"peak pressure less Hertz's: {off[STRESS_LOAD]:+.2f} % at {STRESS_LOAD:g} N/mm",
        holds=abs(off[STRESS_LOAD]) < HERTZ_PERCENT,
        choice=f"{choices(bench)} {STRESS_LOAD_CHOICE[0].upper()}{STRESS_LOAD_CHOICE[1:]}.",
        alternatives=", ".join(
            f"{value:+.2f} % at {load:g} N/mm {verdict_if(abs(value) < HERTZ_PERCENT)}"
            for load, value in off.items()
            if load != STRESS_LOAD
        ),
        values={
            f"peak pressure less Hertz's, {load:g} N/mm, percent": v for load, v in off.items()
        },
    )
