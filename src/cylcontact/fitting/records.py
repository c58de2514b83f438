"""What a result holds: coefficients with intervals and verdicts, runs, profiles, and series."""

from __future__ import annotations

from pydantic import Field

from cylcontact.files.spec import Spec

# Half-widths of an interval, relative to the value, up to which a parameter is well, fairly or
# poorly determined.
WELL, FAIRLY, POORLY = 0.02, 0.10, 1.0
# A value this close to a bound, relative to the interval, is at the bound.
_AT_BOUND = 1e-6
# The rise of the objective at the ends of the interval of a fit to a law.
TOLERANCE = 0.01
# Runs whose objectives are this close, relatively, ended in the same basin.
SAME_BASIN = 1e-3


class Estimate(Spec):
    """A coefficient, with its interval if it was searched.

    The interval is the profile's; a bound of the search may cut it off. There is none if the data
    do not determine the coefficient. The verdict is well, fairly, poorly, not, or at a bound; for
    one that was not searched it is fixed, or the expression that sets it, such as "= a/10".
    """

    value: float
    unit: str = ""
    verdict: str = "-"
    low: float | None = None
    high: float | None = None
    low_is_bound: bool = False
    high_is_bound: bool = False
    standard_error: float | None = None
    # The relative rise of the objective with the coefficient at its published value.
    penalty: float | None = None

    @property
    def interval(self) -> str:
        """The interval as text, and whether a bound cuts it off; empty without one."""
        if self.low is None or self.high is None:
            return ""
        cut = ", bound" if self.low_is_bound or self.high_is_bound else ""
        return f"{self.low:.5g} … {self.high:.5g}{cut}"


def with_verdict(estimate: Estimate, per_unit: float) -> Estimate:
    """Return an estimate with the verdict on its interval; `per_unit` makes widths relative."""
    return estimate.model_copy(update={"verdict": _verdict(estimate, per_unit)})


def _verdict(estimate: Estimate, per_unit: float) -> str:
    low, high = estimate.low, estimate.high
    if low is None or high is None:
        return "not"
    cut, margin = (estimate.low_is_bound, estimate.high_is_bound), _AT_BOUND * (high - low) / 2
    if (cut[0] and estimate.value - low <= margin) or (cut[1] and high - estimate.value <= margin):
        return "at a bound"
    if any(cut):
        return "not" if all(cut) else "poorly"
    limits = {"well": WELL, "fairly": FAIRLY, "poorly": POORLY}
    share = per_unit * (high - low) / 2
    return next((verdict for verdict, limit in limits.items() if share <= limit), "not")


class ObjectiveValue(Spec):
    """An objective's name and value, and its unit if it has one."""

    name: str
    value: float
    unit: str = ""


class Published(Spec):
    """The published coefficients on the same data."""

    coefficients: dict[str, float]
    objective: float


class MaxDifference(Spec):
    """Largest difference of the penetration in percent; None where the law is undefined."""

    fitted: float | None
    published: float | None


class SampleCounts(Spec):
    """Samples used, and samples that the reference's domain masked."""

    samples: int
    masked: int


class RunRecord(Spec):
    """A run, a descent from one start; only the seconds differ between repeats."""

    index: int
    seed: int
    objective: float
    coefficients: dict[str, float]
    seconds: float


class SearchRecord(RunRecord):
    """A genetic search with its budget and its best, and the descents after it."""

    population: int
    evaluations: int
    objective_before_polish: float
    coefficients_before_polish: dict[str, float]


def same_basin(record: RunRecord, objective: float, exact: float = 1e-12) -> bool:
    """Return whether a run reached an objective, to 0.1 % and round-off."""
    return record.objective <= objective * (1 + SAME_BASIN) + exact


class Profile(Spec):
    """The best attainable objective as a function of one coefficient."""

    values: list[float]
    objective: list[float]


class SeriesEffect(Spec):
    """What the readings of a series share: offset and drift in mm, gain relative."""

    name: str
    rows: int
    effects: dict[str, float]


class FittedDeviations(Spec):
    """The deviations of a noise model: constant, offset and drift in mm, the others relative."""

    deviations: dict[str, float]
    random: bool
    series: list[SeriesEffect] = Field([])
