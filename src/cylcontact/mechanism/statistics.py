"""Statistics of a run over its revolutions: means with intervals by batch means, period, warnings.

The values of successive revolutions depend on each other, so that their scatter says little of how
well their mean is known. The means of batches much longer than that dependence are nearly
independent and normal, and Student's interval applies to them (Law and Kelton, Simulation Modeling
and Analysis). Every mean here is a ratio of sums, Σ numerator / Σ denominator: a plain mean has
ones in the denominator, the mean penetration has the time in contact. With the sums N and D of a
batch, its residual is d = N − R·D, and the standard error of R is that of the mean of d over the
mean of D.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.special import stdtrit

from cylcontact.limits import yield_warning
from cylcontact.mechanism.run import Settings
from cylcontact.mechanism.slider_crank import SliderCrank
from cylcontact.support.arrays import FloatArray, require

if TYPE_CHECKING:
    import pandas as pd

FORCE_PERCENTILES = (50, 95, 99)
# The Poincaré section at the end of every revolution.
SECTION = ("e_x_um", "e_y_um", "e_x_rate_m_per_s", "e_y_rate_m_per_s", "in_contact")

# The sums of which a mean is the ratio, and its factor; other means are over the revolutions.
RATIOS: dict[str, tuple[str, str, float]] = {
    "mean_penetration_um": ("penetration_integral_um_s", "contact_time_s", 1.0),
    "mean_force_N": ("impulse_N_s", "contact_time_s", 1.0),
    "mean_step_contact_us": ("contact_time_s", "contact_steps", 1e6),
    "mean_step_flight_us": ("flight_time_s", "flight_steps", 1e6),
}
QUANTITIES = (
    *("contact_fraction", "impacts", "mean_penetration_um", "max_penetration_um", "mean_force_N"),
    *(f"force_p{percent}_N" for percent in FORCE_PERCENTILES),
    *("max_force_N", "drive_work_J", "normal_dissipation_J", "friction_dissipation_J"),
    *("mean_step_contact_us", "mean_step_flight_us", "steps", "evaluations"),
)
# Batches, if two revolutions are left in each; fewer than the second number give no interval.
BATCHES, LEAST, SIZE = 20, 4, 2
LEVEL = 0.95
# Assumed: two sections are the same if they differ by less than this share of the clearance, and
# their rates by this share of the clearance times the crank's speed.
REPEATS = 1e-3
# A motion has period p if each of the last REPEATED sections repeats the one p revolutions earlier.
REPEATED, LONGEST = 24, 8
# Assumed: the energy balance expected of every revolution, relative to the largest kinetic energy.
BALANCE = 1e-6

_AS_COLUMN = str.maketrans({" ": "_", "(": None, ")": None, "µ": "u"})


def batch_means(over: FloatArray, under: FloatArray, level: float = LEVEL) -> tuple[Any, Any]:
    """Return Σ over / Σ under, of columns of revolutions, and the half-widths of their intervals.

    Both are NaN where there is none: without a batch, or where the denominators are all 0. A
    revolution with a NaN in the numerator counts in neither sum.
    """
    missing = np.isnan(over)
    over, under = np.where(missing, 0.0, over), np.where(missing, 0.0, under)
    total, count = under.sum(axis=0), min(BATCHES, len(over) // SIZE)
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = np.where(total > 0, over.sum(axis=0) / total, np.nan)
        if count < LEAST:
            return ratio, np.full_like(ratio, np.nan)
        starts = np.linspace(0, len(over), count, endpoint=False).astype(np.intp)
        top, bottom = (np.add.reduceat(part, starts) for part in (over, under))
        residuals = (top - ratio * bottom) / (total / count)
    error = np.sqrt((residuals**2).sum(axis=0) / (count * (count - 1)))
    return ratio, stdtrit(count - 1, 0.5 + level / 2) * error


@dataclass(frozen=True, eq=False, repr=False)
class Statistics:
    """Statistics of a run over its revolutions, from the revolution `first` on.

    Attributes
    ----------
    revolutions : DataFrame
        One row for each revolution of the run, indexed by its number from 0: what `interval`
        averages; the sums of which some means are ratios (`contact_time_s`, `flight_time_s`,
        `penetration_integral_um_s`, `impulse_N_s`, `contact_steps`); `impact_rate_m_per_s`, the
        δ̇⁽⁻⁾ that the contact at the end carries; `contacts` that are under way or begin, and how
        many of these are `above_yield` and `beyond_law`; `max_load_N_per_mm`, elastic; the Poincaré
        section at the revolution's end; `seconds` of computing; the largest `kinetic_energy_J`, and
        `energy_error_J` since the start.
    mechanism : SliderCrank
    settings : Settings
    first : int
        The first revolution that counts for means and intervals.
    """

    revolutions: pd.DataFrame
    mechanism: SliderCrank
    settings: Settings
    first: int = 0

    def __post_init__(self) -> None:
        total = len(self.revolutions)
        rule, remedy = f"leaves none of {total} revolutions", "start earlier, or simulate more"
        require(0 <= self.first < total, "statistics", "first", self.first, rule, remedy)

    @property
    def by_revolution(self) -> pd.DataFrame:
        """The rows of the revolutions from `first` on."""
        return self.revolutions.iloc[self.first :]

    @cached_property
    def mean(self) -> pd.Series[float]:
        """The means of the quantities; NaN where there was no contact."""
        return self.interval()["mean"]

    def interval(self, level: float = LEVEL) -> pd.DataFrame:
        """Return means, and half-widths of their intervals by batch means.

        The revolutions are divided into 20 batches, or as many as leave two revolutions in each.
        Fewer than four batches give no interval (NaN). A joint without dissipation and friction has
        no interval either, because it has no steady state.

        Parameters
        ----------
        level : float
            The confidence, between 0 and 1.

        Returns
        -------
        DataFrame
            Indexed by quantity, with the columns `mean` and `half_width`.

        Examples
        --------
        >>> from cylcontact.mechanism import long_run, read_mechanism
        >>> statistics = long_run(read_mechanism("datasets/slider_crank.toml"), revolutions=30)
        >>> print(statistics.interval().loc["drive_work_J"].round(2).to_list())
        [3.05, 0.0]
        """
        import pandas as pd

        require(0 < level < 1, "interval", "level", level, "must lie in (0, 1)", "give e.g. 0.95")
        table = self.by_revolution.assign(one=1.0)
        table["flight_steps"] = table["steps"] - table["contact_steps"]
        rows = [RATIOS.get(name, (name, "one", 1.0)) for name in QUANTITIES]
        over = np.column_stack([factor * table[top] for top, _, factor in rows]).astype(float)
        under = np.column_stack([table[bottom] for _, bottom, _ in rows]).astype(float)
        mean, half_width = batch_means(over, under, level)
        if self.lossless:
            half_width = np.full_like(mean, np.nan)
        return pd.DataFrame({"mean": mean, "half_width": half_width}, [*QUANTITIES])

    @property
    def lossless(self) -> bool:
        """Whether nothing dissipates: c_e = 1 and no friction."""
        return self.mechanism.joint.chi == 0.0 and self.mechanism.joint.friction == 0.0

    @property
    def period(self) -> int | None:
        """The smallest number p ≤ 8 of revolutions after which the motion repeats.

        Each of the last 24 sections must repeat the one p revolutions earlier. 0 if there is no
        such p; None if the run is too short to tell, below 32.
        """
        clearance = self.mechanism.joint.radial * 1e-3
        rate = clearance * abs(self.mechanism.omega)
        scale = np.array([clearance * 1e6] * 2 + [rate] * 2 + [1.0])
        points = self.revolutions[list(SECTION)].to_numpy(dtype=np.float64) / scale
        for period in range(1, LONGEST + 1):
            if len(points) < REPEATED + period:
                return None
            apart = points[-REPEATED:] - points[-REPEATED - period : -period]
            if np.abs(apart).max() < REPEATS:
                return period
        return 0

    @property
    def carried(self) -> float:
        """δ̇⁽⁻⁾ in m/s of a contact that lasts through the last revolution; NaN without one.

        This rate of the last first touch sets the damping from then on, and decides the motion.
        """
        last = self.revolutions.iloc[-1]
        lasting = last["contact_fraction"] == 1.0 and last["impacts"] == 0
        return float(last["impact_rate_m_per_s"]) if lasting else float("nan")

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about first yield, the end of the law, and the energy balance."""
        table, joint = self.revolutions, self.mechanism.joint
        texts = []
        load = float(table["max_load_N_per_mm"].max())
        if text := yield_warning(load, joint.pair, joint.housing):
            texts.append(f"{text}; {self._in_revolutions('above_yield')}")
        if self.continuation:
            texts.append(self.continuation)
        share = table["energy_error_J"].abs() / table["kinetic_energy_J"].max()
        if (share > BALANCE * np.arange(1, len(table) + 1)).any():
            texts.append(
                f"the energy balance is off by up to {100 * share.max():.2g} % of the largest "
                "kinetic energy; use a tighter tolerance"
            )
        return tuple(texts)

    @property
    def continuation(self) -> str:
        """A sentence on contacts for which a law was continued beyond its domain, or nothing."""
        table, joint = self.revolutions, self.mechanism.joint
        if not table["beyond_law"].sum():
            return ""
        law, deepest = joint.block["last_penetration"] * 1e3, table["max_penetration_um"].max()
        text = f"beyond {law:.4g} µm the law goes on along its tangent, up to {deepest:.4g} µm"
        return f"{text}: {self._in_revolutions('beyond_law')}"

    def _in_revolutions(self, column: str) -> str:
        """Say how many revolutions have a contact of a kind, and which is the first."""
        numbers = np.flatnonzero(self.revolutions[column] > 0)
        total = len(self.revolutions)
        return f"in {numbers.size:,} of {total:,} revolutions, first in number {numbers[0] + 1:,}"

    @property
    def summary(self) -> dict[str, Any]:
        """Settings and largest values of the whole run, by name."""
        table, joint, spec = self.revolutions, self.mechanism.joint, self.mechanism.spec
        rows: dict[str, Any] = {
            "law": joint.origin or joint.data["law"],
            "clearance (mm)": float(f"{joint.radial:.9g}"),
            "restitution": joint.data["dissipation"]["restitution"],
            "friction": joint.friction,
            "tolerance": spec.tolerance,
            "revolutions": len(table),
            "steps": int(table["steps"].sum()),
            "contacts": int(table["impacts"].sum()),
            "max penetration (µm)": round(float(table["max_penetration_um"].max()), 3),
            "energy error (J)": float(f"{table['energy_error_J'].abs().max():.3g}"),
        }
        if joint.can_yield:
            load = float(table["max_load_N_per_mm"].max())
            share = 100 * load * joint.pair.contact_length("the joint") / joint.first_yield
            rows["max elastic load"] = f"{load:,.0f} N/mm, {share:.3g} % of first yield (von Mises)"
        return rows

    def to_dict(self) -> dict[str, Any]:
        """Return what `to_text` prints as plain data, for JSON."""
        return {
            "mechanism": self.mechanism.spec.name,
            # As columns are called: max penetration (µm) is max_penetration_um.
            **{key.translate(_AS_COLUMN): value for key, value in self.summary.items()},
            "first": self.first,
            "means": self.interval().reset_index(names="quantity").to_dict("records"),
            "period": self.period,
            "carried_m_per_s": self.carried,
            "lossless": self.lossless,
            "warnings": list(self.warnings),
        }

    def __repr__(self) -> str:
        total, period = len(self.revolutions), self.period
        table = self.interval().rename(columns={"half_width": "±"})
        text = table.to_string(float_format="{:.5g}".format, na_rep="-")
        words = {None: "too few revolutions for a period", 0: "no period up to 8 revolutions"}
        motion = words.get(period, f"the motion repeats after {period} revolutions")
        if (rate := self.carried) > 0:
            motion += f"; the contact lasts, damped by the δ̇⁽⁻⁾ of its onset, {rate:.3g} m/s"
        if self.lossless:
            motion += "; nothing dissipates, so there is no steady state and no interval"
        title = f"Means over revolutions {self.first + 1:,} to {total:,}, ± half the 95 % interval"
        return f"{title}\n{text}\n{motion}"

    def _repr_html_(self) -> str:
        return f"<pre>{escape(repr(self))}</pre>"

    def to_text(self) -> str:
        """Return the report that `cylcontact simulate` prints."""
        rows = "\n".join(f"  {key:>22}: {value}" for key, value in self.summary.items())
        return f"Run of {self.mechanism.spec.name!r}\n{rows}\n\n{self!r}"
