"""Parts of a fit result: its runs, its objective, and how many samples it has."""

from __future__ import annotations

from pydantic import Field

from cylcontact.spec import Spec

__all__ = ["MaxDifference", "ObjectiveValue", "Published", "RunRecord", "SampleCounts"]


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
