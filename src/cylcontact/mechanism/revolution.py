"""One revolution of a run reduced to a row of numbers, of which statistics are made."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cylcontact.arrays import FloatArray, IndexArray
from cylcontact.mechanism.derived import changes
from cylcontact.mechanism.step_history import LEDGERS, StepHistory

__all__ = ["ENERGIES", "FORCE_PERCENTILES", "Limits", "reduce_revolution"]

FORCE_PERCENTILES = (50, 95, 99)
ENERGIES = ("drive_work", "normal_dissipation", "friction_dissipation")


class Limits(NamedTuple):
    """Thresholds that a contact may pass.

    Attributes
    ----------
    first_yield : float
        The penetration in m at which the elastic load is that of first yield; NaN where no yield
        stress is known.
    law : float
        The penetration in m from which the law is continued along its tangent; inf without an end.
    floor : float
        The slowest impact in m/s that dissipates as its factor says.
    """

    first_yield: float
    law: float
    floor: float


def reduce_revolution(
    rows: StepHistory,
    penetration: FloatArray,
    force: FloatArray,
    within: FloatArray,
    limits: Limits,
) -> dict[str, float]:
    """Return the numbers of one revolution; see `Statistics.by_revolution`.

    Parameters
    ----------
    rows : StepHistory
        The last step of the revolution before and the n − 1 steps of this one.
    penetration, force : array of float, shape (n,)
        δ in m and f_n in N.
    within : array of float, shape (n − 1, parts)
        f_n in N in equal parts of every step.
    limits : Limits
        What contacts are held against.
    """
    touching, dt = rows.in_contact, np.diff(rows.time)
    # A step has the mode of its last row; the second row of an onset has dt = 0.
    inside, moving = touching[1:], dt > 0
    spent = {name: float(rows.values[-1, k] - rows.values[0, k]) for name, k in LEDGERS.items()}
    contact_time, flight_time = float(dt[inside].sum()), float(dt[~inside].sum())
    steps, evaluations, seconds = rows.counts[0]
    contact_steps = int(np.count_nonzero(inside & moving))
    begins, _ = changes(touching)
    numbers = {
        "contact_fraction": contact_time / (contact_time + flight_time),
        "impacts": begins.size,
        "mean_penetration_um": _ratio(spent["penetration_integral"], contact_time) * 1e6,
        "max_penetration_um": float(penetration[touching].max(initial=0.0)) * 1e6,
        "mean_force_N": _ratio(spent["impulse"], contact_time),
    }
    for percent, value in zip(
        FORCE_PERCENTILES, _percentiles(dt[inside], within[inside]), strict=True
    ):
        numbers[f"force_p{percent}_N"] = value
    numbers["max_force_N"] = float(max(force.max(initial=0.0), within.max(initial=0.0)))
    numbers |= {f"{name}_J": spent[name] for name in ENERGIES}
    return numbers | {
        "mean_step_contact_us": _ratio(contact_time, contact_steps) * 1e6,
        "mean_step_flight_us": _ratio(flight_time, int(steps) - contact_steps) * 1e6,
        "steps": int(steps),
        "evaluations": int(evaluations),
        "seconds": float(seconds),
        "contact_time_s": contact_time,
        "flight_time_s": flight_time,
        "penetration_integral_um_s": spent["penetration_integral"] * 1e6,
        "impulse_N_s": spent["impulse"],
        "contact_steps": contact_steps,
        "impact_rate_m_per_s": float(rows.impact_rate[-1]),
        **_passed(rows, penetration, limits),
    }


def _ratio(numerator: float, denominator: float) -> float:
    return numerator / denominator if denominator > 0 else float("nan")


def _percentiles(dt: FloatArray, values: FloatArray) -> list[float]:
    """Return percentiles over the time of steps, shape (m,), with `values` in equal parts of each.

    NaN without any step.
    """
    if not dt.sum() > 0:
        return [float("nan")] * len(FORCE_PERCENTILES)
    weight, sample = np.repeat(dt, values.shape[1]), values.ravel()
    order = np.argsort(sample, kind="stable")
    share = (np.cumsum(weight[order]) - 0.5 * weight[order]) / weight.sum()
    return [float(np.interp(percent / 100, share, sample[order])) for percent in FORCE_PERCENTILES]


def _passed(rows: StepHistory, penetration: FloatArray, limits: Limits) -> dict[str, float]:
    """Return the contacts of the revolution, and how many pass each limit and when first.

    A contact under way at the start counts again, so that no revolution depends on another.
    """
    begins, _ = changes(rows.in_contact)
    slow = begins[rows.impact_rate[begins] < limits.floor]
    if rows.in_contact[0]:
        begins = np.append(0, begins)
    depth = np.where(rows.in_contact, penetration, -np.inf)
    deepest = np.maximum.reduceat(depth, begins) if begins.size else np.empty(0)
    numbers = {"contacts": begins.size, "grazing": slow.size, "grazing_s": _time(rows, slow)}
    for name, limit in (("above_yield", limits.first_yield), ("beyond_law", limits.law)):
        numbers[name] = float(np.count_nonzero(deepest > limit))
        numbers[f"{name}_s"] = _time(rows, np.flatnonzero(depth > limit))
    if np.isnan(limits.first_yield):
        numbers["above_yield"] = float("nan")
    return numbers


def _time(rows: StepHistory, at: IndexArray) -> float:
    """Return the time in s of the first of some rows; NaN without any."""
    return float(rows.time[at[0]]) if at.size else float("nan")
