"""Section 3.2: the finite-element check, judged by the committed tables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from cylcontact import limits
from cylcontact.datasets.finite_element import Setup
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim, joined, verdict_if

from ..finite_elements import (
    STRESS_LOAD,
    STRESS_LOAD_CHOICE,
    choices,
    penetrations,
    sensitivity_table,
    study,
    table,
)

WIDE = 0.445  # mm, from where on the paper states 3 %
# The three models of the paper in pairs, and our explicit law beside them.
PAIRS = (("johnson", "fe"), ("enhanced", "fe"), ("enhanced", "johnson"))
BESIDE = (("explicit", "fe"),)
SPOKEN = {"fe": "finite elements", "johnson": "Johnson", "enhanced": "enhanced"}
SPOKEN |= {"explicit": "our explicit law"}
# Refinement beyond this many cells per half-width is the paper's "further refinement".
REFINED = 16
# Cells of the finest mesh tried.
FINEST = 48
MESH_PERCENT = 0.2
HERTZ_PERCENT = 3.0


@dataclass(frozen=True)
class Tables:
    """What the claims are judged by.

    Attributes
    ----------
    setup : Setup
        The recommended set-up.
    choice : str
        What of it is our choice.
    recommended, letter, convergence, sensitivity : pandas.DataFrame
        The embedded solver's tables of the set-ups of those names, "letter" of `paper`.
    """

    setup: Setup
    choice: str
    recommended: pd.DataFrame
    letter: pd.DataFrame
    convergence: pd.DataFrame
    sensitivity: pd.DataFrame

    @classmethod
    def of(cls, bench: Bench) -> Tables:
        """Read a bench's tables.

        Raises
        ------
        MissingInputError
            If one has not been made.
        InputError
            If one was edited by hand, or is not of its set-up.
        """
        return cls(
            setup=study(bench, "recommended").setups["base"],
            choice=choices(bench),
            recommended=table(bench, "recommended"),
            letter=table(bench, "paper"),
            convergence=table(bench, "convergence"),
            sensitivity=table(bench, "sensitivity"),
        )


@claim(
    "3.2-below-{percent:g}-percent",
    "finite elements, Johnson and the enhanced law agree to {percent:g} % {where}",
    paper="< {percent:g} %",
    rule="below {percent:g} % between each two of the three, at 20, 40 and 100 N/mm",
    cases=[
        {"percent": 10.0, "lowest": 0.0, "where": "from 5 µm to 1.5 mm"},
        {"percent": 3.0, "lowest": WIDE, "where": f"at {WIDE:g} mm and above"},
    ],
)
def within(bench: Bench, percent: float, lowest: float, **_where: str) -> Finding:
    """Compare the largest difference between each two models, load by load, with a bound."""
    tables = Tables.of(bench)
    off = largest(tables.recommended, PAIRS, lowest)
    beside = largest(tables.recommended, BESIDE, lowest)
    letter = largest(tables.letter, PAIRS[:2], lowest)
    return Finding(
        "largest difference in percent of the second: " + _by_pair(off),
        holds=max(map(abs, off.values())) < percent,
        choice=tables.choice,
        alternatives=joined(
            "beside them, " + _by_pair(beside),
            "set-up to the letter (plane stress, load on the centre node), " + _by_pair(letter),
        ),
        values={_key(*key): value for key, value in (off | beside).items()},
        paper_values={"bound, percent": percent},
    )


def largest(
    rows: pd.DataFrame, pairs: tuple[tuple[str, str], ...], lowest: float
) -> dict[tuple[str, str, float], float]:
    """Return the difference of largest magnitude, in percent of the second, by pair and load."""
    numbers = penetrations(rows[rows["dR_mm"] >= lowest])
    differences = {}
    for one, other in pairs:
        for load, group in numbers.groupby("load_N_per_mm"):
            off = 100 * (group[f"{one}_mm"] / group[f"{other}_mm"] - 1).to_numpy()
            differences[one, other, float(str(load))] = float(off[np.abs(off).argmax()])
    return differences


@claim(
    "3.2-same-trend",
    "the relation of penetration and clearance has the same trend at every load",
    paper="same trend at 20, 40 and 100 N/mm",
    rule="each model's penetration rises over the same steps of clearance at every load",
)
def same_trend(bench: Bench) -> Finding:
    """Compare the clearances over which each model's penetration rises, load by load."""
    tables = Tables.of(bench)
    numbers = penetrations(tables.recommended).sort_values("dR_mm")
    falls: dict[str, dict[str, float]] = {}
    alike = []
    for name in ("fe", "johnson", "enhanced"):
        rising = {
            f"{load:g} N/mm": np.diff(group[f"{name}_mm"].to_numpy()) > 0
            for load, group in numbers.groupby("load_N_per_mm")
        }
        falls[SPOKEN[name]] = {load: float((~up).sum()) for load, up in rising.items()}
        alike.append(all(np.array_equal(up, rising["20 N/mm"]) for up in rising.values()))
    return Finding(
        "; ".join(
            f"{model}: of {len(numbers) // len(counts) - 1} steps to the next clearance "
            + ", ".join(f"{count:g} fall at {load}" for load, count in counts.items())
            for model, counts in falls.items()
        ),
        holds=all(alike),
        choice=tables.choice,
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
def refinement(bench: Bench) -> Finding:
    """Return how much a finer mesh changes penetration and peak pressure."""
    tables = Tables.of(bench)
    rows = tables.convergence.assign(
        cells_across=tables.convergence["variant"].map(
            lambda name: int(name.split()[1]) if name != "base" else FINEST
        )
    )
    coarse = rows[rows["cells_across"] == REFINED]
    fine = rows[rows["cells_across"] == FINEST]
    changes = {
        quantity: float(100 * np.abs(fine[column].to_numpy() / coarse[column].to_numpy() - 1).max())
        for quantity, column in (
            ("penetration", "penetration_mm"),
            ("peak pressure", "peak_pressure_MPa"),
        )
    }
    node = _centre_node(tables.sensitivity)
    return Finding(
        (
            ", ".join(f"{name} changes by {value:.2f} %" for name, value in changes.items())
            + f" at most from {REFINED} to {FINEST} cells over the contact's half-width"
        ),
        holds=max(changes.values()) < MESH_PERCENT,
        choice=tables.choice,
        alternatives=(
            "with the load on the centre node, as the paper has it, the penetration changes by "
            f"{node:+.1f} % at most from 16 to 32 cells {verdict_if(abs(node) < MESH_PERCENT)}"
        ),
        values=(
            {f"{name}, percent": value for name, value in changes.items()}
            | {"penetration, load on the centre node, percent": node}
        ),
    )


def _centre_node(rows: pd.DataFrame) -> float:
    """Return by how many percent refinement changes the penetration under a load on one node."""
    changes = sensitivity_table(rows)
    coarse = changes[changes["variant"] == "load at the centre node"]["change_percent"].to_numpy()
    fine = changes[changes["variant"] == "the same on 32 cells"]["change_percent"].to_numpy()
    change = 100 * ((100 + fine) / (100 + coarse) - 1)
    return float(change[np.abs(change).argmax()])


@claim(
    "3.2-hertz-{dR:g}-mm",
    "Hertz's theory still applies at a clearance of {dR:g} mm",
    paper="the shape of the contact stress confirms it",
    rule=f"within {HERTZ_PERCENT:g} % at {STRESS_LOAD:g} N/mm, our bound",
    cases=[{"dR": 1.0}, {"dR": 0.01}],
)
def hertz(bench: Bench, dR: float) -> Finding:
    """Compare the peak pressure at one clearance with Hertz's, at Fig 5's load and the others."""
    tables = Tables.of(bench)
    rows = tables.recommended[tables.recommended["dR_mm"] == dR]
    loads = rows["load_N_per_mm"].to_numpy()
    ratios = rows["peak_pressure_MPa"].to_numpy() / limits.hertz_stress(
        loads, tables.setup.pair(dR)
    )
    off = {float(load): float(100 * (r - 1)) for load, r in zip(loads, ratios, strict=True)}
    others = [
        f"{value:+.2f} % at {load:g} N/mm {verdict_if(abs(value) < HERTZ_PERCENT)}"
        for load, value in off.items()
        if load != STRESS_LOAD
    ]
    return Finding(
        f"peak pressure less Hertz's: {off[STRESS_LOAD]:+.2f} % at {STRESS_LOAD:g} N/mm",
        holds=abs(off[STRESS_LOAD]) < HERTZ_PERCENT,
        choice=f"{tables.choice} {STRESS_LOAD_CHOICE[0].upper()}{STRESS_LOAD_CHOICE[1:]}.",
        alternatives=", ".join(others),
        values={
            f"peak pressure less Hertz's, {load:g} N/mm, percent": v for load, v in off.items()
        },
    )


def _by_pair(differences: Mapping[tuple[str, str, float], float]) -> str:
    """Return "one to other: a (load), b (load); ..." with differences in percent."""
    pairs: dict[str, list[str]] = {}
    for (one, other, load), value in differences.items():
        pairs.setdefault(f"{SPOKEN[one]} to {SPOKEN[other]}", []).append(
            f"{value:+.1f} % ({load:g} N/mm)"
        )
    return "; ".join(f"{name} {', '.join(values)}" for name, values in pairs.items())


def _key(one: str, other: str, load: float) -> str:
    """Return the name of a value, with its unit."""
    return f"{SPOKEN[one]} to {SPOKEN[other]}, {load:g} N/mm, percent"
