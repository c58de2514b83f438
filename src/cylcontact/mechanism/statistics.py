"""A run in numbers: one value for each revolution, their means and their scatter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from cylcontact.arrays import BoolArray, FloatArray
from cylcontact.errors import InputError
from cylcontact.mechanism import derived

if TYPE_CHECKING:
    import pandas as pd

    from cylcontact.mechanism.trajectory import Trajectory

PERCENTILES = (50, 95, 99)


@dataclass(frozen=True)
class Statistics:
    """Numbers by revolution.

    Attributes
    ----------
    by_revolution : DataFrame
        One row for each revolution, indexed by its number, with the columns

        - `contact_fraction`: share of the time in contact;
        - `impacts`: onsets of contact;
        - `mean_penetration_um`: over the time in contact;
        - `max_penetration_um`;
        - `force_p50_N`, `force_p95_N`, `force_p99_N`, `max_force_N`: percentiles of the normal
          force over the time in contact;
        - `drive_work_J`, `normal_dissipation_J`, `friction_dissipation_J`: in that revolution;
        - `mean_step_contact_us`, `mean_step_flight_us`: of the integrator;
        - `steps`, `evaluations`.
    """

    by_revolution: pd.DataFrame

    @property
    def mean(self) -> pd.Series[float]:
        """The means over the revolutions; a revolution without contact has no forces."""
        return self.by_revolution.mean()

    @property
    def scatter(self) -> pd.Series[float]:
        """The standard deviations over the revolutions (n − 1 in the denominator)."""
        return self.by_revolution.std()

    def __repr__(self) -> str:
        table = self.by_revolution.agg(["mean", "std", "min", "max"]).T
        return f"{len(self.by_revolution)} revolutions\n{table.to_string(float_format='%.6g')}"

    def _repr_html_(self) -> str:
        table: str = self.by_revolution.agg(["mean", "std", "min", "max"]).T.to_html()
        return table


def statistics(trajectory: Trajectory, first: int = 0) -> Statistics:
    """Return the statistics of a run over its revolutions from `first` on.

    Parameters
    ----------
    trajectory : Trajectory
        The run.
    first : int
        The first revolution that counts, from 0.

    Raises
    ------
    InputError
        If no revolution is left.

    Examples
    --------
    >>> from cylcontact.mechanism import read_mechanism, simulate
    >>> mechanism = read_mechanism("datasets/slider_crank.toml", clearance=0.02)
    >>> found = simulate(mechanism, revolutions=2).statistics(first=1)
    >>> print(f"{found.mean['contact_fraction']:.3f}")
    1.000
    """
    import pandas as pd

    if not 0 <= first < trajectory.revolutions:
        raise InputError(
            "statistics", "first", first, f"leaves none of {trajectory.revolutions} revolutions",
            "start earlier, or simulate more revolutions",
        )  # fmt: skip
    starts = np.searchsorted(trajectory.rows.revolution, np.arange(trajectory.revolutions + 1))
    onsets, _ = derived.changes(trajectory.in_contact)
    rows = []
    for index in range(first, trajectory.revolutions):
        # From the last row of the revolution before.
        span = slice(max(int(starts[index]) - 1, 0), int(starts[index + 1]))
        begun = np.count_nonzero((onsets >= starts[index]) & (onsets < starts[index + 1]))
        rows.append(_one_revolution(trajectory, span) | {"impacts": begun})
    table = pd.DataFrame(
        rows, index=pd.RangeIndex(first, trajectory.revolutions, name="revolution")
    )
    counts = trajectory.counts.iloc[first:].set_index(table.index)
    return Statistics(table.join(counts[["steps", "evaluations"]]))


def _one_revolution(trajectory: Trajectory, span: slice) -> dict[str, float]:
    """Return the numbers of one revolution."""
    time, touching = trajectory.time[span], trajectory.in_contact[span]
    dt = np.diff(time)
    # A step belongs to the mode of the row that it ends in: an onset's second row has dt = 0.
    inside, moving = touching[1:], dt > 0
    delta, force = trajectory.penetration[span], trajectory.normal_force[span]
    found = {
        "contact_fraction": float(dt[inside].sum() / dt.sum()),
        "mean_penetration_um": _mean(dt, delta, inside) * 1e6,
        "max_penetration_um": float(delta[touching].max(initial=0.0)) * 1e6,
        "max_force_N": float(force.max(initial=0.0)),
        "mean_step_contact_us": _average(dt[inside & moving]) * 1e6,
        "mean_step_flight_us": _average(dt[~inside & moving]) * 1e6,
    }
    for percent, value in zip(PERCENTILES, _percentiles(dt, force, inside), strict=True):
        found[f"force_p{percent}_N"] = value
    for name in ("drive_work", "normal_dissipation", "friction_dissipation"):
        ledger = getattr(trajectory, name)[span]
        found[f"{name}_J"] = float(ledger[-1] - ledger[0])
    return found


def _average(values: FloatArray) -> float:
    return float(values.mean()) if values.size else float("nan")


def _mean(dt: FloatArray, values: FloatArray, inside: BoolArray) -> float:
    """Return the mean over the time inside, by the trapezoidal rule; NaN where there is none."""
    weight = dt[inside]
    middle = 0.5 * (values[1:] + values[:-1])[inside]
    return float(weight @ middle / weight.sum()) if weight.sum() > 0 else float("nan")


def _percentiles(dt: FloatArray, values: FloatArray, inside: BoolArray) -> list[float]:
    """Return percentiles over the time inside; NaN where there is none."""
    weight, middle = dt[inside], 0.5 * (values[1:] + values[:-1])[inside]
    if not weight.sum() > 0:
        return [float("nan")] * len(PERCENTILES)
    order = np.argsort(middle, kind="stable")
    share = (np.cumsum(weight[order]) - 0.5 * weight[order]) / weight.sum()
    return [float(np.interp(percent / 100, share, middle[order])) for percent in PERCENTILES]
