"""Which further readings would narrow the intervals of a fit most.

To first order n further readings of one new series add JᵀV⁻¹J to the inverse of the covariance of
the parameters, with J the derivatives of the penetration and V its covariance by the fitted noise.
Readings are first spread evenly over the candidates, chosen one after the other, and drawn at
random; each of these sets is exchanged reading by reading for other candidates until no exchange
gains, and the best of the ends is taken. What is minimised is the determinant of the covariance
(D-optimality; Fedorov 1972), or the variance of one parameter; what is known from elsewhere does
not count. A candidate may be chosen more than once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from cylcontact.bodies.pair import CylinderPair
from cylcontact.fitting.noise import FEWEST_RANDOM
from cylcontact.fitting.readings import Optimum, half_width
from cylcontact.support.arrays import FloatArray, as_floats
from cylcontact.support.errors import InputError
from cylcontact.support.plain_text import as_label, item

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from cylcontact.plots.figure import Drawing

# The most readings to add, and the relative gain below which they narrow nothing.
_MOST, _NARROWER = 1000, 1e-3
# Random sets from which exchanges start as well.
_RANDOM = 8
# An exchange that gains less than this, relatively, is none.
_GAIN = 1e-9


@dataclass(frozen=True, eq=False)
class Plan:
    """Further readings, and the intervals expected with them.

    Attributes
    ----------
    readings : pandas.DataFrame
        The readings to add: load_N_per_mm, dR_mm and their number.
    intervals : pandas.DataFrame
        For each free parameter its value and the half-width of its interval, before and after.
    candidates : pandas.DataFrame
        All candidates: load_N_per_mm, dR_mm, and narrower_percent, by how much one reading there
        narrows the interval that counts (without a parameter the mean of all, by the determinant).
    parameter : str
        The parameter that counts; empty for all.
    read : tuple of str
        Lines that say what was read of the table of the readings before.
    warning : str
        Which of the readings are at loads outside those measured; empty if none is.
    """

    readings: pd.DataFrame
    intervals: pd.DataFrame
    candidates: pd.DataFrame
    parameter: str
    read: tuple[str, ...] = ()
    warning: str = ""

    def __str__(self) -> str:
        what = f"the interval of {self.parameter}" if self.parameter else "all intervals together"
        title = f"{self.readings['number'].sum()} further readings that narrow {what} most"
        readings = self.readings.to_string(index=False, float_format="{:.5g}".format)
        intervals = self.intervals.to_string(float_format="{:.5g}".format)
        read = "".join(f"{item(line, '')}\n" for line in self.read)
        warning = f"\n{item(self.warning, '! ')}" if self.warning else ""
        return f"{read}{title}{warning}\n\n{readings}\n\n{intervals}"

    def to_dict(self) -> dict[str, Any]:
        """Return what the text says as plain data, for JSON."""
        return {
            "parameter": self.parameter or None,
            "readings": self.readings.to_dict("records"),
            "intervals": self.intervals.reset_index().to_dict("records"),
            "read": list(self.read),
            "warning": self.warning or None,
        }

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw what one reading at each candidate gains, a line for each clearance."""
        from cylcontact.plots.arguments import axes_for
        from cylcontact.plots.style import ACCENT

        keys, gain = ["load_N_per_mm", "dR_mm"], "narrower_percent"
        with axes_for(ax, "plot", "column", 60.0) as axes:
            for dR, rows in self.candidates.groupby("dR_mm"):
                axes.plot(rows["load_N_per_mm"], rows[gain], marker="", label=f"ΔR = {dR:g} mm")
            at = self.candidates.merge(self.readings, on=keys)
            axes.plot(at["load_N_per_mm"], at[gain], "o", color=ACCENT, label="to be added")
            for _, row in at[at["number"] > 1].iterrows():
                words = f"{row['number']:.0f} times"
                place = row["load_N_per_mm"], row[gain]
                axes.annotate(words, place, (-5, 4), textcoords="offset points", ha="right")
            axes.margins(x=0.2)
            what = as_label(self.parameter) if self.parameter else "all intervals"
            axes.set(
                xscale="log",
                xlabel="load (N/mm)",
                ylabel=f"one reading narrows {what} by (%)",
                ylim=(0, 1.2 * self.candidates[gain].max()),
            )
            axes.legend(loc="lower left")
        return axes

    def drawing(self) -> Drawing:
        """Return `plot` as a figure with a caption; its table is that of the candidates."""
        from cylcontact.plots.figure import Drawing, new_figure

        figure = new_figure("column", 60.0)
        self.plot(figure.subplots())
        caption = (
            "By how much one further reading narrows the interval of "
            f"{self.parameter or 'all parameters together'}, against the load, and the "
            f"{self.readings['number'].sum()} readings that together narrow it most."
        )
        return Drawing(figure, self.candidates, caption)


def plan(
    optimum: Optimum,
    loads: FloatArray,
    dR: FloatArray | None,
    add: int,
    parameter: str | None,
    level: float,
) -> Plan:
    """Return the best further readings; `DataFit.plan` describes the arguments."""
    if optimum.unidentifiable:
        rule, remedy = "cannot be identified separately", "fix one of them, and fit again"
        raise InputError("plan", "parameters", optimum.unidentifiable, rule, remedy)
    names = optimum.fit.names
    if parameter is not None and parameter not in names:
        raise InputError(
            "plan", "parameter", parameter, "is not free", f"choose {', '.join(names)}"
        )
    if isinstance(add, bool) or not isinstance(add, int | np.integer) or not 1 <= add <= _MOST:
        rule = f"must be a whole number from 1 to {_MOST}"
        raise InputError("plan", "add", add, rule, "5 is common")
    if not loads.size or not (np.isfinite(loads) & (loads > 0)).all():
        rule, remedy = "must be positive loads", "give some, e.g. [10.0, 100.0, 1000.0]"
        raise InputError("plan", "candidates", loads.tolist(), rule, remedy)
    candidates = _Candidates.of(optimum, loads, dR)
    before = as_floats(np.linalg.inv(optimum.covariance))
    counted = [
        k
        for k, p in enumerate(optimum.fit.free)
        if p.name == parameter or (parameter is None and p.known is None)
    ]

    def cost(information: FloatArray) -> float:
        """Return the width of one parameter, or the mean of several by the determinant."""
        part = np.linalg.inv(information)[np.ix_(counted, counted)]
        return float(np.exp(np.linalg.slogdet(part)[1] / (2 * len(counted))))

    chosen = _best_set(candidates, before, cost, add)
    if cost(before + candidates.information(chosen)) > (1 - _NARROWER) * cost(before):
        raise InputError("plan", "candidates", None, *_on_nothing(optimum))
    covariance = as_floats(np.linalg.inv(before + candidates.information(chosen)))
    return Plan(
        readings=candidates.table.assign(number=np.bincount(chosen, minlength=len(candidates)))
        .query("number > 0")
        .reset_index(drop=True),
        intervals=_intervals(optimum, covariance, add, level),
        candidates=candidates.table.assign(narrower_percent=candidates.gains(before, cost)),
        parameter=parameter or "",
        read=tuple(optimum.fit.data.read),
        warning=_on_loads(candidates.table["load_N_per_mm"].to_numpy()[chosen], optimum),
    )


def _on_nothing(optimum: Optimum) -> tuple[str, str]:
    """Return why readings narrow nothing, and what to do about it."""
    noise, rule = optimum.fit.noise, "narrow nothing"
    if noise.is_random or not noise.model.over:
        return rule, "take other candidates"
    number = np.unique(noise.series).size
    return (
        f"{rule} as a new series, which only shows its own offset and gain while series are few",
        f"add readings to the {number} series there are, or measure {FEWEST_RANDOM - number} more "
        f"series in full, fit again, and plan with {FEWEST_RANDOM}",
    )


def _on_loads(loads: FloatArray, optimum: Optimum) -> str:
    """Return a warning for loads outside those measured, where law and noise are extrapolated."""
    measured = optimum.fit.data.load
    outside = int(np.count_nonzero((loads < measured.min()) | (loads > measured.max())))
    if not outside:
        return ""
    return (
        f"{outside} of these readings are outside the measured loads, {measured.min():g} to "
        f"{measured.max():g} N/mm, where the law and its noise are extrapolated"
    )


def _best_set(
    candidates: _Candidates,
    before: FloatArray,
    cost: Callable[[FloatArray], float],
    add: int,
) -> list[int]:
    """Return the readings of the lowest cost that exchanges lead to, as indices of candidates."""

    def of(rows: list[int]) -> float:
        return cost(before + candidates.information(rows))

    def best(others: list[int]) -> int:
        return int(np.argmin([of([*others, k]) for k in range(len(candidates))]))

    greedy: list[int] = []
    for _ in range(add):
        greedy.append(best(greedy))
    spread = np.linspace(0, len(candidates) - 1, add).round().astype(int).tolist()
    rng, ends = np.random.default_rng(0), []
    random = rng.integers(len(candidates), size=(_RANDOM, add)).tolist()
    for chosen in (spread, greedy, *random):
        reached, now = np.inf, of(chosen)
        while now < reached * (1 - _GAIN):
            reached = now
            for place in range(add):
                chosen[place] = best(chosen[:place] + chosen[place + 1 :])
            now = of(chosen)
        ends.append(chosen)
    return min(ends, key=of)


@dataclass(frozen=True, eq=False)
class _Candidates:
    """m possible readings: derivatives (m, k), variances (m,), and what their series shares."""

    table: pd.DataFrame
    slopes: FloatArray
    variance: FloatArray
    shared: FloatArray
    spread: FloatArray | None

    def __len__(self) -> int:
        return self.variance.size

    @classmethod
    def of(cls, optimum: Optimum, loads: FloatArray, dR: FloatArray | None) -> _Candidates:
        """Return the candidates of all loads at all clearances."""
        base = _pair_of(optimum)
        clearances = np.atleast_1d(as_floats(base.dR if dR is None else dR))
        load, gap = (grid.ravel() for grid in np.meshgrid(loads, clearances))
        pair = base
        if dR is not None:  # the pin, or the second roller, has another radius
            sign = 1 if base.contact == "internal" else -1
            R_j = None if base.R_i is None else sign * (base.R_i - gap)
            pair = replace(base, dR=as_floats(gap), R_j=R_j)
        centre, slopes = optimum.slopes_of(lambda law: law.penetration(load, pair))
        if not np.isfinite(centre).all():
            rule, remedy = "leaves the domain of the fitted law", "stay within it"
            raise InputError("plan", "loads", load[~np.isfinite(centre)][0], rule, remedy)
        depth = as_floats(centre - optimum.best.get("offset", 0.0))
        shared, spread, noise = np.empty((load.size, 0)), None, optimum.fit.noise
        variance = noise.scatter_variance(depth, load)
        if noise.model.effects:
            columns = {"offset": np.ones_like(depth), "gain": depth, "drift": 0.5 + 0 * depth}
            shared = np.stack([columns[name] for name in noise.model.effects], axis=1)
            if noise.is_random:
                spread = noise.spread(noise.deviations)
        import pandas as pd

        table = pd.DataFrame({"load_N_per_mm": load, "dR_mm": gap})
        return cls(table, slopes, variance, shared, spread)

    def information(self, rows: list[int]) -> FloatArray:
        """Return JᵀV⁻¹J of some of the candidates, as readings of one new series."""
        weight = 1 / np.sqrt(self.variance[rows])
        J, Z = self.slopes[rows] * weight[:, None], self.shared[rows] * weight[:, None]
        if not Z.size:
            return as_floats(J.T @ J)
        inner = Z.T @ Z
        if self.spread is None:  # fixed effects take away what they could explain
            core = np.linalg.pinv(inner, hermitian=True)
        else:
            scaled = self.spread[:, None] * inner * self.spread
            inverse = np.linalg.inv(np.eye(len(scaled)) + scaled)
            core = self.spread[:, None] * inverse * self.spread
        return as_floats(J.T @ J - J.T @ Z @ core @ Z.T @ J)

    def gains(self, before: FloatArray, cost: Callable[[FloatArray], float]) -> FloatArray:
        """Return by how many percent one reading at each candidate narrows what counts."""
        reached = [cost(before + self.information([k])) for k in range(len(self))]
        return as_floats(100 * (1 - np.array(reached) / cost(before)))


def _intervals(optimum: Optimum, covariance: FloatArray, add: int, level: float) -> pd.DataFrame:
    import pandas as pd

    before = optimum.degrees_of_each()
    # Every reading of one kind of noise adds a degree of freedom.
    one_kind = len(optimum.fit.noise.names) == 1 and not optimum.fit.noise.given.any()
    after = before + add if one_kind else before
    errors = np.sqrt(np.diag(covariance))
    return pd.DataFrame(
        {
            "value": optimum.point,
            "half_width": half_width(level, before) * optimum.errors,
            "expected_half_width": half_width(level, after) * errors,
        },
        index=pd.Index(optimum.fit.names, name="parameter"),
    )


def _pair_of(optimum: Optimum) -> CylinderPair:
    """Return the pair of the first row, of whose materials all rows have to be."""
    data = optimum.fit.data
    names, _ = data.groups("material")
    if len(names) > 1:
        rule, remedy = f"the data have {len(names)} pairs of materials", "fit one of them alone"
        raise InputError("plan", "materials", None, rule, remedy)
    return data.take(np.zeros(1, dtype=np.intp)).pair
