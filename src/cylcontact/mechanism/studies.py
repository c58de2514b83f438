"""How far a run can be trusted: the horizon of two tolerances, drift and balance by tolerance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.errors import InputError
from cylcontact.mechanism.trajectory import Trajectory

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["AGREEMENT", "eccentricity_at", "horizon", "tolerance_table"]

# Assumed: two runs agree while their eccentricities differ by less than this share of the
# clearance. What parts does so fast, so that another share moves the horizon little.
AGREEMENT = 0.01


def eccentricity_at(run: Trajectory, time: FloatArray) -> FloatArray:
    """Return a run's eccentricity in m at given times, shape (n, 2).

    Cubic interpolation between the steps, with the rates that the run has at their ends.

    Parameters
    ----------
    run : Trajectory
        The run.
    time : array of float, shape (n,)
        In s, inside the run.

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
    found: FloatArray = spline(time)
    return found


def horizon(run: Trajectory, other: Trajectory, share: float = AGREEMENT) -> float:
    """Return up to when two runs of the same mechanism agree, in revolutions.

    Parameters
    ----------
    run, other : Trajectory
        At two tolerances, say, or in two forms.
    share : float
        Of the clearance: by how much the eccentricities may differ.

    Returns
    -------
    float
        The time of the first step at which they differ by more; that of the end if none does.

    Raises
    ------
    InputError
        If the runs are of mechanisms that differ.

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


def tolerance_table(tables: Sequence[pd.DataFrame]) -> pd.DataFrame:
    """Summarise sweeps at several tolerances: what each costs and what it gives.

    Parameters
    ----------
    tables : sequence of DataFrame
        From `sweep`, each of one method and tolerance.

    Returns
    -------
    DataFrame
        One row for each: `method`, `tolerance`, number of complete `cases`, largest and median
        relative energy error, largest drift of a position constraint in m or rad (NaN in minimal
        coordinates, which have none), and steps and evaluations per revolution in the mean over
        the cases.

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
            raise InputError("tolerance_table", "tables", None, "no case is complete", "see why")
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
