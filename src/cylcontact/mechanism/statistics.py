"""Statistics of a run: values for each revolution, their means and their scatter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from cylcontact.arrays import BoolArray, FloatArray
from cylcontact.errors import InputError
from cylcontact.mechanism.derived import changes
from cylcontact.mechanism.step_history import LEDGERS, StepHistory

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Statistics", "statistics"]

_PERCENTILES = (50, 95, 99)
_ENERGIES = ("drive_work", "normal_dissipation", "friction_dissipation")


@dataclass(frozen=True)
class Statistics:
    """Statistics by revolution.

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
        - `mean_step_contact_us`, `mean_step_flight_us`: mean steps of the integrator;
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


def statistics(
    rows: StepHistory, penetration: FloatArray, normal_force: FloatArray, first: int = 0
) -> Statistics:
    """Return the statistics of a run over its revolutions from `first` on.

    Parameters
    ----------
    rows : StepHistory
        The steps of the run, n of them.
    penetration, normal_force : array of float, shape (n,)
        δ in m and f_n in N.
    first : int
        The first revolution that counts, from 0.

    Raises
    ------
    InputError
        If no revolution is left.
    """
    import pandas as pd

    revolutions = rows.counts.shape[0]
    if not 0 <= first < revolutions:
        raise InputError(
            "statistics", "first", first, f"leaves none of {revolutions} revolutions",
            "start earlier, or simulate more revolutions",
        )  # fmt: skip
    starts = np.searchsorted(rows.revolution, np.arange(revolutions + 1))
    onsets, _ = changes(rows.in_contact)
    records = []
    for index in range(first, revolutions):
        # From the last row of the previous revolution.
        span = slice(max(int(starts[index]) - 1, 0), int(starts[index + 1]))
        impacts = np.count_nonzero((onsets >= starts[index]) & (onsets < starts[index + 1]))
        steps, evaluations, _ = rows.counts[index].astype(int)
        records.append(
            _one_revolution(rows, span, penetration[span], normal_force[span])
            | {"impacts": impacts, "steps": steps, "evaluations": evaluations}
        )
    return Statistics(
        pd.DataFrame(records, index=pd.RangeIndex(first, revolutions, name="revolution"))
    )


def _one_revolution(
    rows: StepHistory, span: slice, penetration: FloatArray, force: FloatArray
) -> dict[str, float]:
    """Return the numbers of one revolution."""
    touching, dt = rows.in_contact[span], np.diff(rows.time[span])
    # A step has the mode of its last row; the second row of an onset has dt = 0.
    inside, moving = touching[1:], dt > 0
    numbers = {
        "contact_fraction": float(dt[inside].sum() / dt.sum()),
        "mean_penetration_um": _mean(dt, penetration, inside) * 1e6,
        "max_penetration_um": float(penetration[touching].max(initial=0.0)) * 1e6,
        "max_force_N": float(force.max(initial=0.0)),
        "mean_step_contact_us": _average(dt[inside & moving]) * 1e6,
        "mean_step_flight_us": _average(dt[~inside & moving]) * 1e6,
    }
    for percent, value in zip(_PERCENTILES, _percentiles(dt, force, inside), strict=True):
        numbers[f"force_p{percent}_N"] = value
    for name in _ENERGIES:
        ledger = rows.values[span, LEDGERS[name]]
        numbers[f"{name}_J"] = float(ledger[-1] - ledger[0])
    return numbers


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
        return [float("nan")] * len(_PERCENTILES)
    order = np.argsort(middle, kind="stable")
    share = (np.cumsum(weight[order]) - 0.5 * weight[order]) / weight.sum()
    return [float(np.interp(percent / 100, share, middle[order])) for percent in _PERCENTILES]
