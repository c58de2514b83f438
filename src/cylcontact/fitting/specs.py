"""Campaign files: their tables, and the parameters that they give a law."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import partial
from typing import Annotated, TypeVar

from pydantic import AfterValidator, Field, model_validator

from cylcontact.bodies.pair import Contact
from cylcontact.datasets.readings import TableSpec
from cylcontact.files.spec import Spec, broken
from cylcontact.fitting.genetic import CROSSOVERS
from cylcontact.fitting.measured import LOSSES
from cylcontact.fitting.noise import NOISES
from cylcontact.fitting.objectives import OBJECTIVES
from cylcontact.fitting.optimizers import OPTIMIZERS
from cylcontact.fitting.problem import require_valid
from cylcontact.laws.housing_spec import HousingSpec
from cylcontact.laws.law import LawModel, Parameter
from cylcontact.support.errors import InputError

_SpecType = TypeVar("_SpecType", bound=Spec)

# Limit on the runs of a campaign and on a population, for memory.
_MOST = 100_000
_TIES = 'a table [ties] of expressions that set parameters, e.g. b = "a/10"'
_PARAMETER_REMEDY = "give low and high, or value with fixed = true"


def _known(kind: str, names: Collection[str], name: str) -> str:
    if name not in names:
        raise broken("", name, f"is not a known {kind}", f"choose {', '.join(names)}")
    return name


_Objective = Annotated[str, AfterValidator(partial(_known, "objective", OBJECTIVES))]
_Optimizer = Annotated[str, AfterValidator(partial(_known, "optimiser", OPTIMIZERS))]
_Noise = Annotated[str, AfterValidator(partial(_known, "noise", NOISES))]
_LossName = Annotated[str, AfterValidator(partial(_known, "loss", LOSSES))]


class ParameterSpec(Spec):
    """A table [parameters.NAME]."""

    low: float | None = Field(None, description="the lower bound, a number")
    high: float | None = Field(None, description="the upper bound, a number")
    value: float | None = Field(None, description="the value of a fixed parameter, a number")
    fixed: bool = Field(False, description="true or false")

    @model_validator(mode="after")
    def _check(self) -> ParameterSpec:
        if self.low is not None and self.high is not None and self.low >= self.high:
            rule = f"must be below high = {self.high}"
            raise broken("low", self.low, rule, "exchange them, or give value with fixed = true")
        if self.fixed:
            if self.value is None:
                raise broken("value", None, "is required when fixed = true", _PARAMETER_REMEDY)
            low = self.value if self.low is None else self.low
            high = self.value if self.high is None else self.high
            if not low <= self.value <= high:
                rule = f"lies outside its own bounds, {self.low} to {self.high}"
                raise broken("value", self.value, rule, "move it, or leave low and high out")
            return self
        if self.value is not None:
            raise broken("value", self.value, "is used only with fixed = true", _PARAMETER_REMEDY)
        if self.low is None or self.high is None:
            missing = "low" if self.low is None else "high"
            raise broken(missing, None, "is required", _PARAMETER_REMEDY)
        return self

    @classmethod
    def of(cls, parameter: Parameter) -> ParameterSpec:
        """Return the table of a parameter that is searched or fixed."""
        if parameter.fixed:
            return cls(value=parameter.value, fixed=True)
        return cls(low=parameter.low, high=parameter.high)


class GeneticSpec(Spec):
    """The table [genetic]."""

    runs: int = Field(
        16, ge=1, le=_MOST, description=f"the number of runs, an integer from 1 to {_MOST}"
    )
    populations: tuple[int, ...] = Field(
        (60, 120), strict=False, description="a list of population sizes, integers of at least 4"
    )
    generations: int = Field(300, ge=1, description="the generations, an integer of at least 1")
    crossovers: tuple[str, ...] = Field(
        ("single_point", "uniform", "blend"),
        strict=False,
        description=f"a list from {', '.join(CROSSOVERS)}",
    )

    @model_validator(mode="after")
    def _check(self) -> GeneticSpec:
        if not self.populations or not 4 <= min(self.populations) <= max(self.populations) <= _MOST:
            rule = f"must be a list of sizes from 4 to {_MOST}"
            raise broken("populations", list(self.populations), rule, "e.g. [60, 120]")
        unknown = [name for name in self.crossovers if name not in CROSSOVERS]
        if unknown or not self.crossovers:
            rule = "must be a list of known crossovers"
            remedy = f"choose from {', '.join(CROSSOVERS)}"
            raise broken("crossovers", list(self.crossovers), rule, remedy)
        return self


class CampaignSpec(Spec):
    """A campaign file."""

    dataset: str = Field(description="the path of a grid spec, beside or above the campaign")
    law: str = Field(description="the law to fit, a string")
    objective: _Objective = Field(OBJECTIVES[0], description=f"one of {', '.join(OBJECTIVES)}")
    seed: int = Field(20150101, ge=0, description="the seed, an integer of at least 0")
    parameters: dict[str, ParameterSpec] = Field(
        {}, description="tables [parameters.NAME] for parameters with other bounds, or fixed ones"
    )
    ties: dict[str, str] | None = Field(None, description=_TIES)
    optimizer: _Optimizer = Field("genetic", description=f"one of {', '.join(OPTIMIZERS)}")
    genetic: GeneticSpec = Field(GeneticSpec(), description="a table [genetic]")
    profiles: bool | None = Field(
        None, description="false for no profiles, which take hours with many parameters"
    )


class MeasuredSpec(TableSpec):
    """A campaign file that names a table of measurements."""

    data: str = Field(
        description="the path of a .csv, .xlsx or .parquet table, beside or above the file"
    )
    contact: Contact = Field(description='"internal" or "external"')
    law: str = Field(description="the law to fit, or module:function for one of your own")
    objective: str | None = Field(None, description="an objective for measurements")
    noise: _Noise | None = Field(
        None, description=f"how the scatter of the readings grows, one of {', '.join(NOISES)}"
    )
    drift: bool | None = Field(None, description="true if readings drift along a series")
    load_error: float | None = Field(
        None, gt=0, lt=1, description="standard deviation of the loads relative to them, 0 to 1"
    )
    loss: _LossName = Field("linear", description=f"one of {', '.join(LOSSES)}")
    loss_scale: float | None = Field(
        None, gt=0, description="the residual beyond which a point counts less, a positive number"
    )
    seed: int = Field(20150101, ge=0, description="the seed, an integer of at least 0")
    starts: int = Field(12, ge=1, le=1000, description="the starts, an integer from 1 to 1000")
    constants: dict[str, float | str] = Field(
        {}, description="a table [constants] of values for all rows, e.g. dR_um = 50"
    )
    materials: str | None = Field(None, description="the path of a table of materials")
    housing: HousingSpec | None = Field(
        None, description="a table [housing] of the rim's radius R_o, its clamp and layers"
    )
    parameters: dict[str, ParameterSpec] = Field(
        {}, description="tables [parameters.NAME] for parameters with other bounds, or fixed ones"
    )
    free: tuple[str, ...] | None = Field(
        None, strict=False, description="a list of parameters to free with their default bounds"
    )
    ties: dict[str, str] | None = Field(None, description=_TIES)
    optimizer: _Optimizer | None = Field(
        None, description=f"a search instead of several starts, one of {', '.join(OPTIMIZERS)}"
    )
    genetic: GeneticSpec = Field(
        GeneticSpec(), description="a table [genetic], the budget of an optimizer"
    )

    @model_validator(mode="after")
    def _check(self) -> MeasuredSpec:
        if self.loss == "linear" and self.loss_scale is not None:
            rule = "is used only with a robust loss"
            remedy = "leave it out, or choose loss = soft_l1, huber or cauchy"
            raise broken("loss_scale", self.loss_scale, rule, remedy)
        return self

    @property
    def named(self) -> list[str]:
        """The parameters that the file bounds, fixes or ties."""
        return [*self.parameters, *(self.ties or {})]


def completed(spec: _SpecType, parameters: tuple[Parameter, ...]) -> _SpecType:
    """Return a campaign's settings with a table for every parameter that is not tied."""
    tables = {p.name: ParameterSpec.of(p) for p in parameters if p.tie is None}
    return spec.model_copy(update={"parameters": tables})


def parameters_of(
    model: LawModel,
    tables: Mapping[str, ParameterSpec],
    ties: Mapping[str, str] | None,
    source: str,
    others: str = "",
) -> tuple[Parameter, ...]:
    """Return the parameters of a campaign, in the order of the law."""
    for name in tables:
        if name not in model.names:
            rule = f"is not a parameter of {model.law} for {model.contact} contact"
            remedy = f"its parameters: {', '.join(model.names)}{others}"
            raise InputError(source, f"parameters.{name}", None, rule, remedy)
    ties = ties or {}
    require_valid(ties, tables, model.names, source)
    parameters = []
    for p in model.parameters:
        if p.name in ties:
            parameters.append(Parameter(p.name, tie=ties[p.name], shift=p.shift))
        elif p.name in tables:
            given = tables[p.name]
            low, high = (math.nan if end is None else end for end in (given.low, given.high))
            parameters.append(replace(p, low=low, high=high, value=given.value))
        elif p.fixed or math.isfinite(p.high - p.low):
            parameters.append(p)
        else:
            rule = "is required: a law of your own has no default bounds"
            remedy = "give low and high, or value with fixed = true"
            raise InputError(source, f"parameters.{p.name}", None, rule, remedy)
    if not any(p.is_free for p in parameters):
        rule, remedy = "all are fixed or tied", "free at least one: give it low and high"
        raise InputError(source, "parameters", None, rule, remedy)
    return tuple(parameters)
