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
    """A coefficient, and how far it may move if it was searched.

    The interval is the profile's; a bound of the search may cut it off. There is none if the data
    do not determine the coefficient.
    """

    value: float
    unit: str = ""
    verdict: str = "-"  # well, fairly, poorly, not, at a bound, fixed, or an expression
    low: float | None = None
    high: float | None = None
    low_is_bound: bool = False
    high_is_bound: bool = False
    standard_error: float | None = None
    # The relative rise of the objective with the coefficient at its published value.
    penalty: float | None = None

    @property
    def interval(self) -> str:
        """The interval in words, and whether a bound cuts it off."""
        if self.low is None or self.high is None:
            return ""
        cut = ", bound" if self.low_is_bound or self.high_is_bound else ""
        return f"{self.low:.5g} … {self.high:.5g}{cut}"


def verdict_of(estimate: Estimate, per_unit: float) -> str:
    """Return how well an interval determines a value; `per_unit` makes widths relative."""
    low, high = estimate.low, estimate.high
    assert low is not None
    assert high is not None
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
    """A run: its search, and the polish after it; only the seconds differ between repeats."""

    index: int
    seed: int
    # The budget of a search; None for a descent.
    population: int | None
    crossover: str | None
    objective_before_polish: float
    coefficients_before_polish: dict[str, float] | None
    objective: float
    coefficients: dict[str, float]
    evaluations: int | None
    seconds: float


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
