"""Accuracy of runs: the horizon of two tolerances, drift and energy balance by tolerance."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.arrays import FloatArray, require
from cylcontact.choices import Beyond
from cylcontact.errors import InputError
from cylcontact.mechanism.long_run import FIRST, long_run
from cylcontact.mechanism.model import Mechanism, mechanism_from
from cylcontact.mechanism.simulate import simulate
from cylcontact.mechanism.step_history import Settings
from cylcontact.mechanism.trajectory import Trajectory
from cylcontact.parallel import Workers, call, run_calls
from cylcontact.progress import Progress, silent

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "AGREEMENT",
    "agreement",
    "bifurcation",
    "eccentricity_at",
    "horizon",
    "sections",
    "tolerance_table",
]

# Assumed: two runs agree while their eccentricities differ by less than this fraction of the
# clearance. Runs diverge fast, so the horizon depends little on the fraction.
AGREEMENT = 0.01
# The second tolerance of `agreement` relative to the first, and how far it looks.
TIGHTER, REVOLUTIONS = 0.1, 10


def eccentricity_at(run: Trajectory, time: FloatArray) -> FloatArray:
    """Return the eccentricity of a run in m at the given times, shape (n, 2).

    Cubic Hermite interpolation between the steps.

    Parameters
    ----------
    run : Trajectory
        The run.
    time : array of float, shape (n,)
        In s, within the run.

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism, simulate
    >>> run = simulate(read_mechanism("datasets/slider_crank.toml"), revolutions=1)
    >>> bool(np.allclose(eccentricity_at(run, run.time), run.eccentricity, atol=1e-12))
    True
    """
    from scipy.interpolate import CubicHermiteSpline

    steps, rows = np.unique(run.time, return_index=True)
    spline = CubicHermiteSpline(steps, run.eccentricity[rows], run.eccentricity_rate[rows])
    eccentricity: FloatArray = spline(time)
    return eccentricity


def horizon(run: Trajectory, other: Trajectory, share: float = AGREEMENT) -> float:
    """Return the time until which two runs of the same mechanism agree, in revolutions.

    Parameters
    ----------
    run, other : Trajectory
        The runs, for example at two tolerances or with two methods.
    share : float
        Allowed difference of the eccentricities, as a fraction of the clearance.

    Returns
    -------
    float
        The time of the first step with a larger difference, or the end if there is none.

    Raises
    ------
    InputError
        If the runs are of different mechanisms.

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism, simulate
    >>> mechanism = read_mechanism("datasets/slider_crank.toml", clearance=0.02)
    >>> runs = [simulate(mechanism, tolerance=rtol, revolutions=1) for rtol in (1e-8, 1e-10)]
    >>> horizon(*runs)
    1.0
    """
    if run.mechanism.data["clearance"] != other.mechanism.data["clearance"]:
        raise InputError("horizon", "other", None, "is of another mechanism", "give two alike")
    end = min(run.revolutions, other.revolutions)
    time = run.time[run.time <= end * run.mechanism.period * (1 + 1e-12)]
    time = np.minimum(time, other.time[-1])
    apart = np.hypot(*(run.eccentricity[: time.size] - eccentricity_at(other, time)).T)
    beyond = np.flatnonzero(apart > share * run.mechanism.clearance.radial)
    return float(run.revolution[beyond[0]]) if beyond.size else float(end)


def agreement(mechanism: Mechanism, settings: Settings, revolutions: int = REVOLUTIONS) -> str:
    """Return a sentence on how long a run keeps to its path at a tenth of its tolerance.

    Parameters
    ----------
    mechanism : Mechanism
        The mechanism.
    settings : Settings
        The settings of the run.
    revolutions : int
        Its length; at most 10 revolutions are compared.

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism
    >>> from cylcontact.mechanism.simulate import settings_for
    >>> mechanism = read_mechanism("datasets/slider_crank.toml", clearance=0.02)
    >>> print(agreement(mechanism, settings_for(mechanism), 2))
    tolerances of 1e-08 and 1e-09 keep to one path over the 2 revolutions compared
    """
    compared = min(revolutions, REVOLUTIONS)
    pair = settings.tolerance, max(settings.tolerance * TIGHTER, 1e-14)
    text = f"tolerances of {pair[0]:g} and {pair[1]:g}"
    try:
        runs = [
            simulate(
                mechanism, settings.method, compared, tolerance, settings.beyond,
                allowed_penetration=settings.allowed_penetration,
            )
            for tolerance in pair
        ]  # fmt: skip
    except InputError as error:
        return f"{text} part: at the second one {error.rule}"
    reach = horizon(runs[0], runs[1])
    unit = "revolution" if compared == 1 else f"{compared} revolutions"
    if reach >= compared:
        return f"{text} keep to one path over the {unit} compared"
    return f"{text} part after {reach:.2g} revolutions: beyond that only statistics mean something"


def bifurcation(
    mechanism: Mechanism,
    clearances: Sequence[float],
    revolutions: int = 200,
    last: int = 50,
    impact_rate: float | None = None,
    beyond: Beyond = "stop",
    workers: Workers = 1,
    progress: Progress = silent,
) -> pd.DataFrame:
    """Return the Poincaré sections of a mechanism over its clearance.

    Parameters
    ----------
    mechanism : Mechanism
        What all runs have in common.
    clearances : sequence of float
        Radial clearances in mm.
    revolutions, last : int
        The length of each run, and how many of its last sections are kept.
    impact_rate : float, optional
        δ̇⁽⁻⁾ in m/s that the contact carries from revolution 10 on if the joint is in contact at its
        end. A contact without end keeps it, and it decides the motion; a flight ends it. By default
        every contact has the rate of its onset.
    beyond : {"stop", "tangent"}
        As in `simulate`.
    workers : int or Cluster
        Where to run.
    progress : callable, optional
        Called with a stage, the runs done and their number.

    Returns
    -------
    DataFrame
        One row for each section: `clearance_mm`, `held_m_per_s` (NaN: not held), `revolution`, the
        section, `impact_rate_m_per_s` (δ̇⁽⁻⁾ at that time, 0 out of contact) and the run's `period`
        (0: none up to 8; NaN: too short).

    Raises
    ------
    InputError
        If there is no clearance, or a run cannot be or stops.

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism
    >>> mechanism = read_mechanism("datasets/slider_crank.toml")
    >>> table = bifurcation(mechanism, [0.5], revolutions=40, last=2)
    >>> print(table[["clearance_mm", "revolution", "in_contact", "period"]].to_string(index=False))
     clearance_mm  revolution  in_contact  period
              0.5          38        True     1.0
              0.5          39        True     1.0
    """
    import pandas as pd

    require(
        len(clearances) > 0, "bifurcation", "clearances", clearances, "there is none", "give some"
    )
    require(
        0 < last < revolutions, "bifurcation", "last", last,
        f"must be at least 1 and below the {revolutions} revolutions", "keep fewer sections",
    )  # fmt: skip
    require(
        impact_rate is None or impact_rate > 0, "bifurcation", "impact_rate", impact_rate,
        "must be positive", "give it in m/s, or leave it out",
    )  # fmt: skip
    rest = revolutions, last, impact_rate, beyond
    calls = [call(sections, mechanism.data, mechanism.source, c, *rest) for c in clearances]
    tables = []
    with closing(run_calls(calls, workers)) as results:
        for done, table in enumerate(results, 1):
            tables.append(table)
            progress("clearances", done, len(calls))
    joined: pd.DataFrame = pd.concat(tables, ignore_index=True)
    return joined


def sections(
    data: dict[str, Any],
    source: str,
    clearance: float,
    revolutions: int,
    last: int,
    impact_rate: float | None,
    beyond: Beyond,
) -> pd.DataFrame:
    """Return the rows of `bifurcation` for one clearance in mm."""
    mechanism, first = mechanism_from(data, source, clearance=clearance), revolutions - last
    start = None
    if impact_rate is not None:
        start = long_run(mechanism, min(FIRST, first), beyond=beyond)
        if start.end.in_contact:
            start = replace(start, end=replace(start.end, impact_rate=impact_rate))
    run = long_run(mechanism, revolutions, first, beyond=beyond, resume=start)
    table: pd.DataFrame = run.section.assign(
        impact_rate_m_per_s=run.by_revolution["impact_rate_m_per_s"],
        period=np.nan if run.period is None else float(run.period),
    ).reset_index()
    table.insert(0, "clearance_mm", clearance)
    table.insert(1, "held_m_per_s", np.nan if impact_rate is None else impact_rate)
    return table


def tolerance_table(tables: Sequence[pd.DataFrame]) -> pd.DataFrame:
    """Summarise the cost and accuracy of sweeps at several tolerances.

    Parameters
    ----------
    tables : sequence of DataFrame
        Tables from `sweep`, each for one method and tolerance.

    Returns
    -------
    DataFrame
        One row for each table: `method`, `tolerance`, number of complete `cases`, largest and
        median relative energy error, largest drift of a position constraint in m or rad (NaN in
        minimal coordinates, which have none), and mean steps and evaluations per revolution.

    Raises
    ------
    InputError
        If a table has no complete case.
    """
    import pandas as pd

    rows = []
    for table in tables:
        complete = table[table["status"] == "complete"]
        if complete.empty:
            rule = f"no case is complete; the first: {table['message'].iloc[0]}"
            raise InputError("tolerance_table", "tables", None, rule, "choose other cases")
        rows.append(
            {
                "method": complete["method"].iloc[0],
                "tolerance": complete["tolerance"].iloc[0],
                "cases": len(complete),
                "energy_error_max": complete["energy_error"].max(),
                "energy_error_median": complete["energy_error"].median(),
                "drift_max": complete["drift"].max(),
                "steps_per_revolution": complete["steps"].mean(),
                "evaluations_per_revolution": complete["evaluations"].mean(),
            }
        )
    return pd.DataFrame(rows)
