"""What a result holds: runs, objectives, intervals, estimates, and what the residuals show."""

from __future__ import annotations

from pydantic import Field

from cylcontact.files.spec import Spec

# Half-widths of an interval, relative to the value, up to which a parameter is well or fairly
# determined.
WELL, FAIRLY = 0.02, 0.10
# The rise of the objective at the ends of the profile of a coefficient.
TOLERANCE = 0.01


class ObjectiveValue(Spec):
    """An objective's name and value."""

    name: str
    value: float


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
    objective_before_polish: float
    # None in old results.
    coefficients_before_polish: dict[str, float] | None
    objective: float
    coefficients: dict[str, float]
    evaluations: int | None  # None for a descent
    seconds: float


class Ends(Spec):
    """The ends of an interval of a parameter, and whether a bound of the search cuts them off."""

    low: float
    high: float
    low_is_bound: bool
    high_is_bound: bool

    def is_at_bound(self, value: float) -> bool:
        """Return whether a value is at an end that is a bound of the search."""
        margin = 1e-6 * (self.high - self.low) / 2
        return (self.low_is_bound and value - self.low <= margin) or (
            self.high_is_bound and self.high - value <= margin
        )

    @property
    def cut(self) -> str:
        """What an interval in words ends with if a bound cuts it off."""
        return ", bound" if self.low_is_bound or self.high_is_bound else ""


class Interval(Ends):
    """An interval of a parameter of a fit to readings."""

    # The lowest (S(θ) − S)/τ on the way; below 0 there is a better optimum.
    lowest: float = 0.0


class Profile(Ends):
    """The best attainable objective as a function of one coefficient; its ends are at 1 %."""

    values: list[float]
    objective: list[float]
    objective_at_published: float | None

    @property
    def interval(self) -> str:
        """The 1 % interval, and whether a bound cuts it off."""
        return f"{self.low:.4g} … {self.high:.4g}{self.cut}"

    def verdict(self, value: float) -> str:
        """Return "well", "fairly", "poorly" or "at a bound" for a coefficient at `value`."""
        half_width = (self.high - self.low) / 2
        if self.is_at_bound(value):
            return "at a bound"
        if self.low_is_bound or self.high_is_bound or half_width > FAIRLY * abs(value):
            return "poorly"
        return "well" if half_width <= WELL * abs(value) else "fairly"


class Estimate(Spec):
    """A free parameter with its standard error, and intervals by covariance and by profile."""

    value: float
    # None where the data do not determine it.
    standard_error: float | None
    low: float | None
    high: float | None
    profile: Interval | None
    verdict: str
    # Of the standard error; None if the size of the noise is known.
    degrees_of_freedom: float | None = None
    # Of a parameter of stiffness: its value for the pair as given.
    nominal: float | None = None


class SeriesEffect(Spec):
    """What the readings of a series share: offset and drift in mm, gain relative."""

    name: str
    rows: int
    effects: dict[str, float]


class FittedDeviations(Spec):
    """The deviations of a noise model: constant, offset and drift in mm, the others relative."""

    deviations: dict[str, float]
    random: bool
    series: list[SeriesEffect]


class Outlier(Spec):
    """A row far from the fitted law: measured less fitted, in robust standard deviations."""

    line: int
    deviations: float


class Finding(Spec):
    """A test of the noise that fails: series, pairs, drift, sequence or spread."""

    test: str
    # The probability of such residuals if the noise were as assumed.
    p: float
    says: str
    remedy: str

    @property
    def sentence(self) -> str:
        """What the residuals show, how unlikely that is, and what to do."""
        return f"{self.says} (p = {self.p:.2g}): {self.remedy}"


class Uncertainty(Spec):
    """The uncertainty of the coefficients from the noise of measurements."""

    level: float
    rows: int
    degrees_of_freedom: int
    residual_sigma: float
    residual_unit: str
    sigma_known: bool
    # The probability of residuals this large where their size is known.
    chi_square_p: float | None
    estimates: dict[str, Estimate]
    correlation: dict[str, dict[str, float]]
    # Parameters of which only a combination is identifiable.
    only_together: list[str]
    duplicates: list[list[int]]
    outliers: list[Outlier]
    notes: list[str]
    noise: FittedDeviations | None = None
    log_likelihood: float | None = None
    # The number of free parameters, deviations of the noise and fixed effects.
    estimated: int | None = None
    # Of the variance of the readings; with series, of that within them.
    r_squared: float | None = None
    # The residuals over the readings, and over the scatter from one reading to the next.
    missed: float | None = None
    missed_over_scatter: float | None = None
    # Whether the readings of the penetration fall as the load rises.
    falls: bool = False
    findings: list[Finding] = Field([])
    without_outliers: dict[str, float] = Field({})


# Runs whose objectives are this close, relatively, ended in the same basin.
SAME_BASIN = 1e-3


def same_basin(record: RunRecord, objective: float, exact: float = 1e-12) -> bool:
    """Return whether a run reached an objective, to 0.1 % and round-off."""
    return record.objective <= objective * (1 + SAME_BASIN) + exact
