"""Sections 4.2 to 5: the constraints of the slider-crank, and the three laws in its joint."""

from __future__ import annotations

import copy

import numpy as np
import pandas as pd

from cylcontact.mechanism import Case, Trajectory, mechanism_from, simulate
from cylcontact.pair import CylinderPair
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim, listed, with_unit

from ..paper import JOINT_CLEARANCES, JOINT_LAWS
from ..slider_crank import SPEC, crossings, force_ratio, mechanism, simulated

REVOLUTIONS = 3
SPHERE, JOHNSON, ENHANCED = JOINT_LAWS
BASIS = (
    "geometry and masses of the slider-crank assumed (Table 2 is missing); penetrations up to the "
    "deepest of the first impact at c_e = 0.9 without friction, the same impact for all laws"
)
AGREE = 0.1  # relative distance within which forces count as the same


@claim(
    "4.2-baumgarte",
    "Baumgarte's method with α = β = 0.5 keeps the violation of constraints down",
    paper="α = β = 0.5",
    rule="at most half of the violation without it",
)
def baumgarte(bench: Bench) -> Finding:
    """Return the violation of the constraints in m with the paper's parameters and without."""

    def violation(**parameters: float) -> float:
        data = copy.deepcopy(spec.data)
        data["integration"] |= parameters
        run = simulate(mechanism_from(data, SPEC), "multiplier", revolutions=REVOLUTIONS)
        return float(run.drift[:, 0].max())

    spec = mechanism(bench)
    stabilised, free = violation(), violation(alpha=0.0, beta=0.0)
    return Finding(
        f"largest violation in {REVOLUTIONS} revolutions {stabilised:.2g} m with it, "
        f"{free:.2g} m without",
        holds=stabilised <= free / 2,
        choice="geometry and masses assumed (Table 2 is missing); Cartesian coordinates, the "
        f"spec's law and losses, tolerance {spec.integration.tolerance:g}: the tolerance alone "
        "keeps the violation this small",
        values={"with it, m": stabilised, "without, m": free},
    )


def first_impact(bench: Bench, law: str, clearance: float) -> Trajectory:
    """Return one revolution at c_e = 0.9 without friction."""
    return simulated(bench, Case(law, clearance, 0.9, 0.0), 1)


def joint_pair(run: Trajectory) -> CylinderPair:
    """Return the journal and the bearing of a run."""
    pair = run.mechanism.clearance.pair
    assert pair is not None
    return pair


def deepest(bench: Bench, law: str, clearance: float) -> float:
    """Return the deepest penetration of the first impact in mm."""
    return 1e3 * float(first_impact(bench, law, clearance).contacts["max_penetration_m"].iloc[0])


def largest_force(bench: Bench, law: str, clearance: float) -> float:
    """Return the largest force of the first impact in N."""
    return float(first_impact(bench, law, clearance).contacts["max_force_N"].iloc[0])


def ratio_table(bench: Bench, one: str, other: str, clearance: float) -> pd.DataFrame:
    """Return the ratio of two laws' forces up to the smaller of their deepest penetrations."""
    pair = joint_pair(first_impact(bench, one, clearance))
    depth = min(deepest(bench, law, clearance) for law in (one, other))
    return force_ratio(one, other, pair, depth)


@claim(
    "4.3-sphere-softest",
    "Lankarani and Nikravesh's law is always the softest of the three",
    paper="always softer",
    rule="ratio below 1 at every penetration, over two decades of it",
)
def sphere_softest(bench: Bench) -> Finding:
    """Return the largest ratio of Lankarani and Nikravesh's force to the cylindrical laws'."""
    ratios = {
        f"over {JOINT_LAWS[law]} at {clearance:g} mm": float(
            ratio_table(bench, SPHERE, law, clearance)["ratio"].max()
        )
        for clearance in JOINT_CLEARANCES
        for law in (JOHNSON, ENHANCED)
    }
    return Finding(
        f"its force at equal penetration, at most: {listed(ratios, '{:.2f}')}",
        holds=max(ratios.values()) < 1,
        choice=BASIS,
        values=with_unit(ratios, "-"),
    )


@claim(
    "4.3-comparable-stiffness",
    "the enhanced law and Johnson's are comparably stiff in the range of use",
    paper="comparable",
    rule="at every penetration the two differ by a smaller factor than either does from "
    "Lankarani and Nikravesh's",
)
def comparable_stiffness(bench: Bench) -> Finding:
    """Return the least and the largest ratio of Johnson's force to the enhanced law's."""
    extent: dict[str, float] = {}
    nearer = []
    for clearance in JOINT_CLEARANCES:
        table = ratio_table(bench, JOHNSON, ENHANCED, clearance)
        extent[f"{clearance:g} mm, least"] = float(table["ratio"].min())
        extent[f"{clearance:g} mm, largest"] = float(table["ratio"].max())
        depth = float(table["penetration_mm"].iloc[-1])
        for law in (JOHNSON, ENHANCED):
            pair = joint_pair(first_impact(bench, law, clearance))
            to_sphere = force_ratio(SPHERE, law, pair, depth)["ratio"]
            nearer.append(np.all(np.abs(np.log(table["ratio"])) < np.abs(np.log(to_sphere))))
    return Finding(
        f"force of Johnson over enhanced at equal penetration: {listed(extent, '{:.2f}')}",
        holds=all(nearer),
        choice=f"{BASIS}; 'comparable' is not defined in the paper",
        values=with_unit(extent, "-"),
    )


@claim(
    "4.3-{one}-stiffer-{clearance:g}mm",
    "at {clearance:g} mm {stiff} is slightly stiffer than {soft}",
    paper="slightly stiffer",
    rule="stiffer over more than half of the penetrations, on a linear scale as in Fig 17",
    cases=[
        {
            "clearance": JOINT_CLEARANCES[0],
            "one": JOHNSON,
            "other": ENHANCED,
            "stiff": "Johnson's law",
            "soft": "the enhanced law",
        },
        {
            "clearance": JOINT_CLEARANCES[1],
            "one": ENHANCED,
            "other": JOHNSON,
            "stiff": "the enhanced law",
            "soft": "Johnson's law",
        },
    ],
)
def slightly_stiffer(bench: Bench, clearance: float, one: str, other: str) -> Finding:
    """Return over which share of the penetrations one law is stiffer than the other."""
    table = ratio_table(bench, one, other, clearance)
    depth, ratio = 1e3 * table["penetration_mm"].to_numpy(), table["ratio"].to_numpy()
    share = float(np.diff(depth)[ratio[1:] > 1].sum() / depth[-1])
    even = [1e3 * penetration for penetration in crossings(table)]
    own, others = (1e3 * deepest(bench, law, clearance) for law in (one, other))
    return Finding(
        f"stiffer over {100 * share:.0f} % of the penetrations up to {depth[-1]:.3g} µm; "
        f"the two are even at {' and '.join(f'{at:.3g} µm' for at in even)}, the ratio of "
        f"forces goes from {ratio.min():.2f} to {ratio.max():.2f}",
        holds=share > 0.5,
        choice=f"{BASIS}; which range the paper means is not said, and the verdict hangs on it",
        alternatives=f"over the whole impact it is the {'stiffer' if own < others else 'softer'}: "
        f"{own:.3g} µm deep against {others:.3g} µm",
        values={
            "share, -": share,
            **{f"even at ({number}), um": at for number, at in enumerate(even, start=1)},
        },
    )


@claim(
    "5-sphere-underestimates-forces",
    "a spherical law underestimates the contact forces of cylinders",
    paper="forces underestimated",
    rule="lower than with either cylindrical law, at both clearances",
)
def sphere_underestimates_forces(bench: Bench) -> Finding:
    """Return the largest forces in N of one and the same impact by each law."""
    forces = {
        clearance: {law: largest_force(bench, law, clearance) for law in JOINT_LAWS}
        for clearance in JOINT_CLEARANCES
    }
    texts = {
        f"{JOINT_LAWS[law]} at {clearance:g} mm": force
        for clearance, row in forces.items()
        for law, force in row.items()
    }
    return Finding(
        f"largest force of the same impact: {listed(texts, '{:.0f} N')}",
        holds=all(row[SPHERE] == min(row.values()) for row in forces.values()),
        choice=BASIS,
        values=with_unit(texts, "N"),
    )


@claim(
    "5-sphere-knows-no-length",
    "spherical laws do not account for the axial length of the cylinders",
    paper="not accounted for",
    rule=f"at neither clearance does a single length make both laws agree within {AGREE:.0%} "
    "over the penetrations: the largest is over "
    f"{(1 + AGREE) / (1 - AGREE):.2f} times the least",
)
def sphere_knows_no_length(bench: Bench) -> Finding:
    """Return the lengths in mm for which the spherical law gives Johnson's force."""
    lengths: dict[str, float] = {}
    spreads = []
    for clearance in JOINT_CLEARANCES:
        joint = first_impact(bench, SPHERE, clearance).mechanism.clearance
        length = ratio_table(bench, SPHERE, JOHNSON, clearance)["ratio"] * joint.length
        lengths[f"{clearance:g} mm, least"] = float(length.min())
        lengths[f"{clearance:g} mm, largest"] = float(length.max())
        spreads.append(length.max() / length.min())
    return Finding(
        "the length of joint for which it gives Johnson's force, by clearance and over the "
        f"penetrations: {listed(lengths, '{:.2g} mm')}",
        holds=all(spread > (1 + AGREE) / (1 - AGREE) for spread in spreads),
        choice=BASIS,
        values=with_unit(lengths, "mm of length"),
    )
