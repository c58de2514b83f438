"""Parts of a fit result: its runs, its objective, its intervals, and how many samples it has."""

from __future__ import annotations

import numpy as np
from pydantic import Field

from cylcontact.spec import Spec

# Half-widths of an interval, relative to the value, up to which a parameter is well or fairly
# determined.
WELL, FAIRLY = 0.02, 0.10


class ObjectiveValue(Spec):
    """An objective's name and value."""

    name: str = Field(description="the objective's name")
    value: float = Field(description="its value")


class Published(Spec):
    """The published coefficients on the same data."""

    coefficients: dict[str, float] = Field(description="the coefficients of the law's source")
    objective: float = Field(description="their objective")


class MaxDifference(Spec):
    """Largest |Eq 9| over the data, in percent."""

    fitted: float | None = Field(
        description="of the fitted coefficients; none if undefined at all of the data"
    )
    published: float | None = Field(description="of the published ones, where there are any")


class SampleCounts(Spec):
    """Samples used, and samples that the reference's domain masked."""

    samples: int = Field(description="samples used")
    masked: int = Field(description="samples masked")


class RunRecord(Spec):
    """The result of a run; only the seconds differ between repeats."""

    index: int = Field(description="the run's place in the campaign")
    seed: int = Field(description="the seed of the search")
    population: int | None = Field(
        description="the population, which sets the budget of every search; null for a descent"
    )
    crossover: str | None = Field(description="the crossover of a genetic search")
    objective_before_polish: float = Field(description="the best of the search")
    coefficients_before_polish: dict[str, float] | None = Field(
        description="those of the search alone; null in old results, which do not have them"
    )
    objective: float = Field(description="the objective after the polish")
    coefficients: dict[str, float] = Field(description="the coefficients after the polish")
    evaluations: int = Field(description="candidates that the search evaluated")
    seconds: float = Field(description="wall-clock time")


class Ends(Spec):
    """The ends of an interval of a parameter."""

    low: float = Field(description="the lower end")
    high: float = Field(description="the upper end")
    low_is_bound: bool = Field(description="whether a bound of the search cuts it off below")
    high_is_bound: bool = Field(description="whether a bound of the search cuts it off above")

    def is_at_bound(self, value: float) -> bool:
        """Return whether a value is at an end that is a bound of the search."""
        margin = 1e-6 * (self.high - self.low) / 2
        return (self.low_is_bound and value - self.low <= margin) or (
            self.high_is_bound and self.high - value <= margin
        )


class Interval(Ends):
    """An interval of a parameter of a fit to readings."""

    lowest: float = Field(
        0.0, description="the lowest (S(θ) − S)/τ; below 0 there is a better optimum"
    )


class LeftOut(Spec):
    """A fit without one group."""

    group: str = Field(description="the group left out")
    rows: int = Field(description="its rows")
    coefficients: dict[str, float] = Field(description="fitted to the others")
    own_rms: float | None = Field(
        description="the objective of its rows with those coefficients; null if undefined"
    )

    @classmethod
    def of(cls, group: str, rows: int, coefficients: dict[str, float], rms: float) -> LeftOut:
        """Return the record; an objective that is not finite is none."""
        own_rms = rms if np.isfinite(rms) else None
        return cls(group=group, rows=rows, coefficients=coefficients, own_rms=own_rms)
