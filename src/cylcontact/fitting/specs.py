"""Campaign files: their tables, and the parameters that they give a law."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import partial
from typing import Annotated, Any, TypeVar

from pydantic import AfterValidator, Field, model_validator

from cylcontact.bodies.pair import Contact
from cylcontact.datasets.reading import TableSpec
from cylcontact.files.spec import Spec, broken
from cylcontact.fitting.inputs import INPUTS
from cylcontact.fitting.noise import NOISES
from cylcontact.fitting.parameters import LawModel, Parameter
from cylcontact.fitting.reference import OBJECTIVES
from cylcontact.fitting.ties import require_valid
from cylcontact.laws.housing_spec import HousingSpec
from cylcontact.support.errors import InputError

# Limit on the runs of a campaign and on a population, for memory.
_MOST = 100_000


def _known(kind: str, names: Collection[str], name: str) -> str:
    if name not in names:
        raise broken("", name, f"is not a known {kind}", f"choose {', '.join(names)}")
    return name


_Objective = Annotated[str, AfterValidator(partial(_known, "objective", OBJECTIVES))]
_Noise = Annotated[str, AfterValidator(partial(_known, "noise", NOISES))]


class ParametersSpec(Spec):
    """The tables [bounds], [fixed] and [ties] of any campaign."""

    bounds: dict[str, Annotated[tuple[float, float], Field(strict=False)]] = Field(
        {}, description="a table [bounds] of the parameters to search, e.g. n = [1.0, 1.5]"
    )
    fixed: dict[str, float] = Field(
        {}, description="a table [fixed] of parameters with their values, e.g. n = 1.1"
    )
    ties: dict[str, str] = Field(
        {}, description='a table [ties] of expressions that set parameters, e.g. b = "a/10"'
    )

    @model_validator(mode="after")
    def _check_parameters(self) -> ParametersSpec:
        for name, (low, high) in self.bounds.items():
            if low >= high:
                rule, remedy = "must be below the upper bound", "exchange them, or use [fixed]"
                raise broken(f"bounds.{name}", [low, high], rule, remedy)
        tables: dict[str, dict[str, Any]] = {}
        tables |= {"bounds": self.bounds, "fixed": self.fixed, "ties": self.ties}
        for name in self.named:
            given = [key for key, table in tables.items() if name in table]
            if len(given) > 1:
                rule = f"is also in [{given[0]}]"
                raise broken(f"{given[1]}.{name}", None, rule, "keep one of them")
        return self

    @property
    def named(self) -> list[str]:
        """The parameters that the file bounds, fixes or ties."""
        return [*self.bounds, *self.fixed, *self.ties]


class GeneticSpec(Spec):
    """The table [genetic]."""

    runs: int = Field(
        4, ge=1, le=_MOST, description=f"the number of runs, an integer from 1 to {_MOST}"
    )
    population: int = Field(
        120, ge=4, le=_MOST, description=f"the size of a population, an integer from 4 to {_MOST}"
    )
    generations: int = Field(300, ge=1, description="the generations, an integer of at least 1")


class CampaignSpec(ParametersSpec):
    """A campaign file."""

    dataset: str = Field(description="the path of a grid spec, beside or above the campaign")
    law: str = Field(description="the law to fit, a string")
    objective: _Objective = Field(
        "rms-log-penetration", description=f"one of {', '.join(OBJECTIVES)}"
    )
    seed: int = Field(20150101, ge=0, description="the seed, an integer of at least 0")
    genetic: GeneticSpec = Field(GeneticSpec(), description="a table [genetic]")
    profiles: bool | None = Field(
        None, description="false for no profiles, which take hours with many parameters"
    )


class MeasuredSpec(ParametersSpec, TableSpec):
    """A campaign file that names a table of measurements."""

    data: str | Annotated[tuple[str, ...], Field(strict=False)] = Field(
        description="the path of a .csv, .xlsx or .parquet table beside or above the file, or a "
        "list of paths",
    )
    contact: Contact = Field(description='"internal" or "external"')
    law: str = Field(description="the law to fit, or your module:function")
    noise: _Noise | None = Field(
        None, description=f"how the scatter of the readings grows, one of {', '.join(NOISES)}"
    )
    level: float | None = Field(
        None, gt=0, lt=1, description="the level of intervals, between 0 and 1, e.g. 0.95"
    )
    drift: bool | None = Field(None, description="true if readings drift along a series")
    load_error: float | None = Field(
        None, gt=0, lt=1, description="standard deviation of the loads relative to them, 0 to 1"
    )
    seed: int = Field(20150101, ge=0, description="the seed, an integer of at least 0")
    starts: int = Field(12, ge=1, le=1000, description="the starts, an integer from 1 to 1000")
    constants: dict[str, float | str] = Field(
        {}, description="a table [constants] of values for all rows, e.g. dR_um = 50"
    )
    materials: str | None = Field(None, description="the path of a table of materials")
    uncertain: dict[str, float | str] = Field(
        {}, description='a table of standard uncertainties of inputs, e.g. dR = "2 um", E = "5%"'
    )
    housing: HousingSpec | None = Field(
        None, description="a table [housing] of the rim's radius R_o, its clamp and layers"
    )
    free: tuple[str, ...] | None = Field(
        None, strict=False, description="a list of parameters to free with their default bounds"
    )


_SpecType = TypeVar("_SpecType", bound=ParametersSpec)


def completed(spec: _SpecType, parameters: tuple[Parameter, ...]) -> _SpecType:
    """Return a campaign's settings with the bounds or the value of every parameter."""
    bounds = {p.name: (p.low, p.high) for p in parameters if p.is_free and p.known is None}
    fixed = {p.name: p.value for p in parameters if p.value is not None}
    constants = {*getattr(spec, "uncertain", {})} - {*INPUTS}
    fixed |= {p.name: p.known[0] for p in parameters if p.known and p.name in constants}
    return spec.model_copy(update={"bounds": bounds, "fixed": fixed})


def parameters_of(
    model: LawModel, spec: ParametersSpec, source: str, others: str = ""
) -> tuple[Parameter, ...]:
    """Return the parameters of a campaign, in the order of the law."""
    for key, names in (("bounds", spec.bounds), ("fixed", spec.fixed)):
        for name in names:
            if name not in model.names:
                rule = f"is not a parameter of {model.law} for {model.contact} contact"
                remedy = f"its parameters: {', '.join(model.names)}{others}"
                raise InputError(source, f"{key}.{name}", None, rule, remedy)
    require_valid(spec.ties, model.names, source)
    parameters = tuple(_parameter(p, spec) for p in model.parameters)
    for of_law, p in zip(model.parameters, parameters, strict=True):
        if of_law.never_free and not p.fixed:
            rule = f"is a number of the formula of the {model.law} law, which no fit may search"
            remedy = f"fix it at a value, e.g. --fix {p.name}={of_law.nominal:g}"
            raise InputError(source, p.name, None, rule, remedy)
    for p in parameters:
        if p.is_free and not math.isfinite(p.high - p.low):
            rule = "is required: your own law has no default bounds"
            remedy = f"add {p.name} = [low, high] to [bounds], or its value to [fixed]"
            raise InputError(source, f"bounds.{p.name}", None, rule, remedy)
    if not any(p.is_free for p in parameters):
        rule, remedy = "are all fixed or tied", "free at least one: give it bounds"
        raise InputError(source, "parameters", None, rule, remedy)
    return parameters


def _parameter(parameter: Parameter, spec: ParametersSpec) -> Parameter:
    name = parameter.name
    if name in spec.ties:
        tie = spec.ties[name]
        return replace(parameter, low=math.nan, high=math.nan, value=None, tie=tie)
    if name in spec.fixed:
        return replace(parameter, low=math.nan, high=math.nan, value=spec.fixed[name])
    if name in spec.bounds:
        low, high = spec.bounds[name]
        return replace(parameter, low=low, high=high, value=None)
    return parameter


def with_parameters(
    contents: Mapping[str, Any],
    bounds: Mapping[str, Any] | None,
    fixed: Mapping[str, Any] | None,
    ties: Mapping[str, Any] | None,
) -> dict[str, Any]:
    """Return the contents of a campaign file with other bounds, values and ties of parameters."""
    given = {"bounds": bounds or {}, "fixed": fixed or {}, "ties": ties or {}}
    new = {name for table in given.values() for name in table}
    if not new or not all(isinstance(contents.get(key, {}), dict) for key in given):
        return dict(contents)
    tables = {
        key: {name: v for name, v in contents.get(key, {}).items() if name not in new} | {**table}
        for key, table in given.items()
    }
    return {**contents, **tables}
