"""Statistics of a run over its revolutions: means with intervals, steadiness, period, warnings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.joint.clearance import ClearanceJoint
from cylcontact.limits import yield_warning
from cylcontact.mechanism.batch_means import BatchMeans
from cylcontact.mechanism.joint_motion import FORCE_PERCENTILES, SECTION, Limits
from cylcontact.mechanism.model import Joint, Mechanism
from cylcontact.mechanism.run import Settings, State
from cylcontact.support.arrays import FloatArray, require

if TYPE_CHECKING:
    import pandas as pd

# The sums of which a mean is the ratio, and its factor; other means are over the revolutions.
_RATIOS: dict[str, tuple[str, str, float]] = {
    "mean_penetration_um": ("penetration_integral_um_s", "contact_time_s", 1.0),
    "mean_force_N": ("impulse_N_s", "contact_time_s", 1.0),
    "mean_step_contact_us": ("contact_time_s", "contact_steps", 1e6),
    "mean_step_flight_us": ("flight_time_s", "flight_steps", 1e6),
}
QUANTITIES = (
    "contact_fraction",
    "impacts",
    "mean_penetration_um",
    "max_penetration_um",
    "mean_force_N",
    *(f"force_p{percent}_N" for percent in FORCE_PERCENTILES),
    "max_force_N",
    "drive_work_J",
    "normal_dissipation_J",
    "friction_dissipation_J",
    "mean_step_contact_us",
    "mean_step_flight_us",
    "steps",
    "evaluations",
)
# Those of the whole mechanism; the others are of a joint.
_SHARED = ("drive_work_J", "steps", "evaluations")

# Assumed: two sections are the same if they differ by less than this share of the clearance, and
# their rates by this share of the clearance times the driver's speed.
REPEATS = 1e-3
# A motion has period p if each of the last HELD sections repeats the one p revolutions earlier.
HELD, LONGEST = 24, 8
# Assumed: the energy balance expected of every revolution, relative to the largest kinetic energy.
# At the default tolerance ten revolutions close to 1e-7.
BALANCE = 1e-6
_LEVEL = 0.95


@dataclass(frozen=True, eq=False, repr=False)
class Statistics:
    """Statistics of a run over its revolutions, from the revolution `first` on.

    Where several joints have a clearance, columns and quantities that concern one begin with its
    name, as in "wrist-pin.mean_force_N", and `joint` returns its statistics alone.

    Attributes
    ----------
    revolutions : DataFrame
        One row for each revolution of the run, indexed by its number from 0, with the columns

        - `contact_fraction`: share of the time in contact;
        - `impacts`: onsets of contact;
        - `mean_penetration_um`, `mean_force_N`: over the time in contact, from integrals that
          the integrator carries along;
        - `max_penetration_um`;
        - `force_p50_N`, `force_p95_N`, `force_p99_N`, `max_force_N`: percentiles of the normal
          force over the time in contact, from the steps;
        - `normal_dissipation_J`, `friction_dissipation_J`, and of the whole mechanism
          `drive_work_J` and `damping_J`, of dampers: in that revolution;
        - `mean_step_contact_us`, `mean_step_flight_us`: mean steps of the integrator;
        - `steps`, `evaluations`, `seconds` of computing, NaN from a file;
        - `contact_time_s`, `flight_time_s`, `penetration_integral_um_s`, `impulse_N_s`,
          `contact_steps`: the sums of which means are ratios;
        - `impact_rate_m_per_s`: δ̇⁽⁻⁾ of the contact at the revolution's end; 0 out of contact;
        - `contacts`: contacts that are under way or begin; of these `above_yield` and
          `beyond_law`, and `grazing`, impacts slower than the floor of δ̇⁽⁻⁾, each with the time
          of the first one (`_s`, NaN if there is none). `above_yield` is NaN without a yield
          stress;
        - `max_load_N_per_mm`: the largest elastic load, without damping;
        - `kinetic_energy_J`: the largest;
        - `energy_error_J`: at the revolution's end, since the start of the run;
        - `drift`: largest |Φ| at its end in m or rad; NaN in minimal coordinates, which have none;
        - `e_x_um`, `e_y_um`, `e_x_rate_m_per_s`, `e_y_rate_m_per_s`, `in_contact`: the Poincaré
          section, the eccentricity and its rate at the revolution's end.
    mechanism : Mechanism
        The mechanism.
    settings : Settings
        The settings of the run.
    end : State
        The state at its end, from which `long_run` goes on.
    limits : dict of str to Limits
        What the contacts of each joint were held against.
    first : int
        The first revolution that counts for means, intervals and tests.
    only : str, optional
        The joint that these statistics are of, among several.
    """

    revolutions: pd.DataFrame
    mechanism: Mechanism
    settings: Settings
    end: State
    limits: dict[str, Limits]
    first: int = 0
    only: str | None = None

    def __post_init__(self) -> None:
        require_counted("statistics", self.first, len(self.revolutions))

    @property
    def _joints(self) -> list[Joint]:
        joints = self.mechanism.clearances
        return [joint for joint in joints if self.only in (None, joint.name)]

    @property
    def _joint(self) -> Joint:
        """The one joint that these statistics are of."""
        return self._joints[0] if len(self._joints) == 1 else self.mechanism.clearance

    @property
    def _contact(self) -> ClearanceJoint:
        return self._joint.contact

    @property
    def _limits(self) -> Limits:
        return self.limits[self._joint.name]

    def joint(self, name: str) -> Statistics:
        """Return the statistics of one joint, with the columns of a mechanism that has no other."""
        names = [joint.name for joint in self._joints]
        rule, remedy = "has no clearance", f"choose {', '.join(names)}"
        require(name in names, "statistics", "joint", name, rule, remedy)
        if len(names) == 1:
            return self
        others = tuple(f"{other}." for other in names if other != name)
        own = {
            column: column.removeprefix(f"{name}.")
            for column in map(str, self.revolutions)
            if not column.startswith(others)
        }
        table = self.revolutions[[*own]].rename(columns=own)
        return replace(self, revolutions=table, only=name)

    @property
    def _by_joint(self) -> list[tuple[str, Statistics]]:
        """What to call each joint in a sentence, and its statistics."""
        several = len(self._joints) > 1
        return [(f"{j.name}: " if several else "", self.joint(j.name)) for j in self._joints]

    def _on_each(self, *sayings: Callable[[Statistics], str]) -> list[str]:
        """Return the sentences on each joint, without those that say nothing."""
        texts = [(name, say(joint)) for name, joint in self._by_joint for say in sayings]
        return [f"{name}{text}" for name, text in texts if text]

    def _of_joints(self, names: tuple[str, ...]) -> list[str]:
        """Return the columns of some quantities of all joints."""
        several = len(self._joints) > 1
        return [f"{j.name}.{name}" if several else name for j in self._joints for name in names]

    @property
    def quantities(self) -> list[str]:
        """The names of what is averaged."""
        if len(self._joints) == 1:
            return [*QUANTITIES]
        return [*self._of_joints(tuple(q for q in QUANTITIES if q not in _SHARED)), *_SHARED]

    @property
    def by_revolution(self) -> pd.DataFrame:
        """The rows of the revolutions from `first` on; the columns are those of `revolutions`."""
        return self.revolutions.iloc[self.first :]

    @property
    def mean(self) -> pd.Series[float]:
        """The means of the quantities; NaN where there was no contact.

        Means over the time in contact are ratios of sums, others are those of the revolutions.
        """
        import pandas as pd

        return pd.Series(self._batches.ratio, self.quantities)

    @property
    def scatter(self) -> pd.Series[float]:
        """The standard deviations from revolution to revolution (n − 1 in the denominator).

        They do not say how well a mean is known; `interval` does.
        """
        return self.by_revolution[self.quantities].std()

    @cached_property
    def _batches(self) -> BatchMeans:
        table, over, under = self.by_revolution.assign(one=1.0), [], []
        for quantity in self.quantities:
            joint, dot, name = quantity.rpartition(".")
            numerator, denominator, factor = _RATIOS.get(name, (name, "", 1.0))
            over.append(factor * table[f"{joint}{dot}{numerator}"])
            if denominator == "flight_steps":
                under.append(table["steps"] - table[f"{joint}{dot}contact_steps"])
            else:
                under.append(table[f"{joint}{dot}{denominator}" if denominator else "one"])
        sums = (np.column_stack(columns).astype(np.float64) for columns in (over, under))
        return BatchMeans.of(*sums)

    def interval(self, level: float = _LEVEL) -> pd.DataFrame:
        """Return the means with intervals of confidence, by batch means.

        The revolutions are divided into 20 batches, or as many as leave two revolutions in each.
        Less than four batches, and a mechanism without losses, give no interval.

        Parameters
        ----------
        level : float
            The confidence.

        Returns
        -------
        DataFrame
            Indexed by quantity, with the columns `mean` and `half_width` (NaN: no interval).

        Raises
        ------
        InputError
            If the level is not between 0 and 1.

        Examples
        --------
        >>> from cylcontact.mechanism import long_run, read_mechanism
        >>> mechanism = read_mechanism("datasets/slider_crank.toml")
        >>> table = long_run(mechanism, revolutions=30).interval()
        >>> print(table.loc["drive_work_J"].round(2).to_list())
        [3.05, 0.0]
        """
        require(0 < level < 1, "interval", "level", level, "must lie in (0, 1)", "give e.g. 0.95")
        width = self._batches.half_width(level)
        if self.lossless:
            width[:] = np.nan
        return self.mean.to_frame("mean").assign(half_width=width)

    @property
    def lossless(self) -> bool:
        """Whether nothing dissipates: c_e = 1 and no friction."""
        damped = any(spring.damping for spring in self.mechanism.springs)
        contacts = [joint.contact for joint in self._joints]
        return not damped and all(c and c.chi == 0.0 and c.friction == 0.0 for c in contacts)

    @property
    def stationary(self) -> pd.Series[str]:
        """Whether each quantity is steady.

        - "yes": no trend was found;
        - "drifts": the batch means have a trend (t-test of their slope at 1 %) of more than a
          thousandth of the mean;
        - "correlated": there is no trend, but successive batch means are correlated (von
          Neumann's test at 1 %), so that the interval is too narrow and the run too short;
        - "too short": there are less than four batches of two revolutions;
        - "no steady state": nothing dissipates. The energy spreads upwards, and a mean is a
          number of its horizon;
        - "-": there is no value, as of a force without contact.

        Of a hundred steady quantities one is called drifting by chance, and one correlated.
        """
        import pandas as pd

        found = self._batches
        verdicts = np.where(found.drifts, "drifts", np.where(found.correlated, "correlated", "yes"))
        if self.lossless:
            verdicts = np.full(len(self.quantities), "no steady state")
        elif not found.batches:
            verdicts = np.full(len(self.quantities), "too short")
        verdicts = np.where(np.isnan(found.ratio), "-", verdicts)
        return pd.Series(verdicts, self.quantities, dtype=object)

    @property
    def section(self) -> pd.DataFrame:
        """The Poincaré section: eccentricity, its rate and the mode at every revolution's end."""
        return self.by_revolution[self._of_joints(SECTION)]

    @property
    def period(self) -> int | None:
        """The smallest number p ≤ 8 of revolutions after which the motion repeats.

        Each of the last 24 sections must repeat the one p revolutions earlier, to a thousandth of
        the clearance and, for the rates, of the clearance times the driver's speed. 0 if there is
        no such p; None if the run is too short to tell, below 32. Of a long run a period says
        something of its end only.
        """
        points, rate = [], 2 * np.pi / self.mechanism.period
        for _, joint in self._by_joint:
            clearance = joint._contact.radial * 1e-3
            scale = np.array([clearance * 1e6] * 2 + [clearance * rate] * 2 + [1.0])
            section = joint.revolutions[list(SECTION)].to_numpy(dtype=np.float64)
            points.append(section / scale)
        return period_of(np.column_stack(points)) if points else None

    @property
    def warnings(self) -> tuple[str, ...]:
        """A sentence for each thing to be wary of, over the whole run: how often, and when first.

        First yield, the end of the law's domain, impacts slower than the floor of δ̇⁽⁻⁾, and an
        energy balance worse than a millionth of the largest kinetic energy per revolution.
        """
        kinds = Statistics._yield, Statistics._continuation, Statistics._grazing
        return (*self._on_each(*kinds), *filter(None, [self._balance()]))

    def _revolutions_with(self, column: str) -> str:
        """Return in how many revolutions contacts are of a kind, and when first; "" if none is."""
        table = self.revolutions
        rows, first = int((table[column] > 0).sum()), float(table[f"{column}_s"].min())
        text = f"in {rows:,} of {len(table):,} revolutions, first at {first:.4g} s"
        return text if rows else ""

    def _yield(self) -> str:
        load = self.revolutions["max_load_N_per_mm"].max()
        text = yield_warning(load, self._contact.pair, self._contact.housing)
        return f"{text}; {self._revolutions_with('above_yield')}" if text else ""

    def _grazing(self) -> str:
        count, total = (int(self.revolutions[name].sum()) for name in ("grazing", "impacts"))
        if not count:
            return ""
        floor = f"{self._limits.floor * 1e3:g} mm/s an impact counts as one of that speed"
        slower = f"{count:,} of {total:,} impacts begin slower ({_percent(count / total)})"
        return f"grazing starts: below {floor}; {slower}, {self._revolutions_with('grazing')}"

    @property
    def continuation(self) -> str:
        """A sentence on contacts for which a law was continued beyond its domain, or nothing."""
        return "; ".join(self._on_each(Statistics._continuation))

    def _continuation(self) -> str:
        passed = self._revolutions_with("beyond_law")
        law, deepest = self._limits.law * 1e6, self.revolutions["max_penetration_um"].max()
        text = f"beyond {law:.4g} µm the law goes on along its tangent, up to {deepest:.4g} µm"
        return f"{text}: {passed}" if passed else ""

    def _balance(self) -> str:
        error, total = self.revolutions["energy_error_J"].abs(), len(self.revolutions)
        share = error / self.revolutions["kinetic_energy_J"].max()
        worse = share > BALANCE * np.arange(1, total + 1)
        if not worse.any():
            return ""
        return (
            f"the energy balance is off by up to {error.max():.3g} J, {_percent(share.max())} of "
            f"the largest kinetic energy, and by more than {BALANCE:g} of it per revolution at the "
            f"end of {int(worse.sum()):,} of {total:,} revolutions, first of revolution "
            f"{int(np.argmax(worse)) + 1:,}; a tighter tolerance mends it"
        )

    @property
    def summary(self) -> dict[str, Any]:
        """Settings and largest values of the whole run, by name."""
        table, joints = self.revolutions, self._by_joint
        worst, drift = float(table["energy_error_J"].abs().max()), float(table["drift"].max())
        rows: dict[str, Any] = {}
        for name, joint in joints:
            contact = joint._contact
            rows[f"{name}law"] = contact.data["law"]
            rows[f"{name}clearance (mm)"] = float(f"{contact.radial:.9g}")
            rows[f"{name}restitution"] = contact.data["dissipation"]["restitution"]
            rows[f"{name}friction"] = contact.friction
        rows["method"], rows["tolerance"] = self.settings.method, self.settings.tolerance
        rows["revolutions"], rows["steps"] = len(table), int(table["steps"].sum())
        for name, joint in joints:
            deepest = float(joint.revolutions["max_penetration_um"].max())
            rows[f"{name}contacts"] = int(joint.revolutions["impacts"].sum())
            rows[f"{name}max penetration (µm)"] = round(deepest, 3)
        rows["energy error (J)"] = float(f"{worst:.3g}")
        if np.isfinite(drift):
            rows["drift (m, rad)"] = float(f"{drift:.3g}")
        if self.continuation:
            rows["beyond the law"] = self.settings.beyond
        for name, joint in joints:
            if not np.isnan(joint._limits.first_yield):
                load = float(joint.revolutions["max_load_N_per_mm"].max())
                length = joint._contact.pair.contact_length("the joint")
                share = f"{100 * load * length / joint._contact.first_yield:.3g} %"
                text = f"{load:,.0f} N/mm, {share} of first yield (von Mises)"
                rows[f"{name}max elastic load"] = text
        return rows

    @property
    def _counts(self) -> str:
        """Which revolutions count."""
        total = len(self.revolutions)
        text = f"revolutions {self.first + 1:,} to {total:,}"
        left_out = f", the first {self.first:,} left out" if self.first else ""
        return (f"revolution {total:,}" if self.first + 1 == total else text) + left_out

    @property
    def _method(self) -> str:
        """How the intervals were made, or why there are none."""
        count = self._batches.batches
        if self.lossless:
            return "no intervals: nothing dissipates, and these are numbers of this horizon"
        if not count:
            return "too few revolutions for intervals (at least 8)"
        size, over = divmod(len(self.by_revolution), count)
        more = " or one more" if over else ""
        return f"± half the 95 % interval from {count} batches of {size} revolutions{more}"

    @property
    def motion(self) -> tuple[str, ...]:
        """Sentences on the motion: whether it is steady, its period, and the δ̇⁽⁻⁾ it carries."""
        verdicts = self.stationary[self.stationary != "-"]
        texts = []
        for verdict, sentence in _STEADINESS.items():
            found = list(verdicts.index[verdicts == verdict])
            if len(found) == len(verdicts):
                texts.append(sentence)
            elif found and verdict != "yes":
                texts.append(f"{sentence}: {', '.join(found)}")
        if self._joints:
            texts.append(self._repeats())
        return (*texts, *self._on_each(Statistics._carried))

    def _repeats(self) -> str:
        """Return a sentence on the period."""
        period, closeness = self.period, f"{REPEATS:g} of the clearance"
        if period is None:
            return f"too few revolutions for a period (at least {HELD + LONGEST})"
        if period == 0:
            return f"no period up to {LONGEST} revolutions (the sections of the last {HELD})"
        unit = "revolution" if period == 1 else "revolutions"
        return f"periodic: repeats after {period} {unit} to {closeness}, over the last {HELD}"

    @property
    def carried(self) -> float:
        """δ̇⁽⁻⁾ in m/s that a contact without end keeps from its onset; NaN if the run has flights.

        It scales the damping, and so decides what motion the contact settles to: a contact that
        began slower is damped more. A run "has flights" if its last revolution has one.
        """
        last = self.joint(self._joint.name).revolutions.iloc[-1]
        return float(last["impact_rate_m_per_s"] if last["flight_time_s"] == 0 else np.nan)

    def _carried(self) -> str:
        """Return a sentence on the δ̇⁽⁻⁾ of a contact that does not end, "" if it does."""
        flights = np.flatnonzero(self.revolutions["flight_time_s"] > 0)
        since = f"revolution {int(flights[-1]) + 2:,}" if flights.size else "the start"
        text = f"in contact throughout since {since}, with the δ̇⁽⁻⁾ of its onset, "
        text += f"{self.carried:.3g} m/s, which scales the damping"
        return "" if np.isnan(self.carried) else text

    def _table(self) -> pd.DataFrame:
        """Return what `repr` shows; without batches there are no intervals and verdicts."""
        counted = self.by_revolution[self.quantities]
        table = self.interval().rename(columns={"half_width": "±"}).assign(
            std=counted.std(), min=counted.min(), max=counted.max(), stationary=self.stationary
        )  # fmt: skip
        judged = self._batches.batches and not self.lossless
        return table if judged else table.drop(columns=["±", "stationary"])

    def __repr__(self) -> str:
        table = self._table().to_string(float_format="{:.5g}".format, na_rep="-")
        lines = [f"Means over {self._counts}; {self._method}", table, *self.motion]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        notes = "".join(f"<p>{escape(text)}.</p>" for text in (self._method, *self.motion))
        table: str = self._table().to_html(float_format=lambda number: f"{number:.5g}", na_rep="–")
        return f"<p>Means over {self._counts}.</p>{table}{notes}"

    def to_text(self) -> str:
        """Return the report that `cylcontact simulate` prints: summary, statistics, assumptions."""
        milliseconds = self.revolutions["seconds"].mean() * 1e3
        real = f"{self.mechanism.period * 1e3:.3g} ms in real time"
        speed = f"{milliseconds:.1f} ms of computing for a revolution in the mean, {real}"
        lines = [described(f"Run of {self.mechanism.name!r}", self.summary), "", repr(self), ""]
        if milliseconds > 0:  # a file has no times
            lines += [speed, ""]
        lines += [f"Assumed: {'; '.join(self.assumptions)}"] if self.assumptions else []
        return "\n".join(lines)

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What is assumed, with the continuation of a law if there was one."""
        return (*self.mechanism.assumptions, *filter(None, [self.continuation]))


_STEADINESS = {
    "yes": "no quantity has a trend",
    "drifts": "not steady, with a trend",
    "correlated": "too short, as batches still depend on each other",
    "too short": "too few revolutions to tell a trend",
    "no steady state": "no steady state: nothing dissipates, and the energy spreads upwards",
}


def require_counted(source: str, first: int, revolutions: int) -> None:
    """Raise `InputError` if statistics from a revolution on would count none."""
    require(
        0 <= first < revolutions, source, "first", first,
        f"leaves none of {revolutions} revolutions", "start earlier, or simulate more revolutions",
    )  # fmt: skip


def described(title: str, summary: dict[str, Any]) -> str:
    """Return a title and a summary as lines."""
    rows = "\n".join(f"  {key:>22}: {value}" for key, value in summary.items())
    return f"{title}\n{rows}"


def period_of(points: FloatArray) -> int | None:
    """Return the period of sections of shape (n, coordinates), scaled; see `Statistics.period`."""
    for period in range(1, LONGEST + 1):
        if len(points) < HELD + period:
            return None
        apart = points[-HELD:] - points[-HELD - period : -period]
        if np.abs(apart).max() < REPEATS:
            return period
    return 0


def _percent(share: float) -> str:
    """Return a share in per cent, with two digits if it is small."""
    return f"{100 * share:.2g} %" if share < 0.1 else f"{100 * share:.0f} %"
