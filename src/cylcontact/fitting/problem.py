"""Calibration problems: the free parameters of a law, and the objective to minimise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray
from cylcontact.fitting.objectives import Objective
from cylcontact.fitting.samples import Form
from cylcontact.fitting.ties import evaluate
from cylcontact.laws.law import LawModel, Parameter

# Numbers in an array of candidates by data; of more candidates some at a time are evaluated.
_AT_ONCE = 1 << 22


@dataclass(frozen=True, eq=False)
class ParameterSpace:
    """The parameters of a law, some of them free between bounds, the others fixed or tied.

    Attributes
    ----------
    model : LawModel
        The law and contact.
    parameters : tuple of Parameter
        One for each of the model's names, in their order.
    objective : object
        What is minimised: for a grid an `Objective`, for readings its name.
    """

    model: LawModel
    # One for each of the model's names, in their order.
    parameters: tuple[Parameter, ...]
    objective: object

    @cached_property
    def free(self) -> tuple[Parameter, ...]:
        """The parameters that are searched."""
        return tuple(p for p in self.parameters if p.is_free)

    @cached_property
    def names(self) -> list[str]:
        """The names of the free parameters."""
        return [p.name for p in self.free]

    @cached_property
    def low(self) -> FloatArray:
        """Lower bounds of the free parameters, shape (k,)."""
        return np.array([p.low for p in self.free])

    @cached_property
    def high(self) -> FloatArray:
        """Upper bounds of the free parameters, shape (k,)."""
        return np.array([p.high for p in self.free])

    def coefficients(self, point: FloatArray) -> dict[str, float]:
        """Return all coefficients by name, including the fixed and the tied ones."""
        complete = self.complete(point[None, :])[0]
        return {p.name: float(v) for p, v in zip(self.parameters, complete, strict=True)}

    def point(self, coefficients: Mapping[str, float]) -> FloatArray:
        """Return the free parameters from coefficients by name, shape (k,)."""
        return np.array([coefficients[name] for name in self.names])

    def fixing(self, **fixed: float) -> Self:
        """Return the same with some parameters fixed at values."""
        parameters = tuple(replace(p, value=fixed.get(p.name, p.value)) for p in self.parameters)
        return replace(self, parameters=parameters)

    def complete(self, points: FloatArray) -> FloatArray:
        """Add the fixed and the tied parameters to P points, shape (P, k) to (P, all)."""
        columns: dict[str, ArrayLike] = {
            name: points[:, column] for column, name in enumerate(self.names)
        }
        columns |= {p.name: p.value for p in self.parameters if p.value is not None}
        columns |= {p.name: evaluate(p.tie, columns) for p in self.parameters if p.tie is not None}
        complete = np.empty((len(points), len(self.parameters)))
        for index, parameter in enumerate(self.parameters):
            complete[:, index] = columns[parameter.name]
        return complete

    def scatter(self, rng: np.random.Generator, number: int) -> FloatArray:
        """Return random points between the bounds, shape (number, k)."""
        return rng.uniform(self.low, self.high, (number, len(self.free)))

    # What a search needs; a problem on a grid and a fit to readings have their own.

    def values(self, points: FloatArray) -> FloatArray:
        """Return the objective of P points of the free parameters, shape (P, k) to (P,)."""
        raise NotImplementedError

    def residuals(self, points: FloatArray) -> FloatArray:
        """Return residuals whose squares add up to the objective's, shape (P, k) to (P, q)."""
        raise NotImplementedError

    def value(self, point: FloatArray) -> float:
        """Return the objective of one point, shape (k,)."""
        return float(self.values(point[None, :])[0])

    def value_of(self, coefficients: Mapping[str, float]) -> float:
        """Return the objective of coefficients by name, which may be outside the bounds."""
        raise NotImplementedError

    def finite_residuals(self, points: FloatArray) -> FloatArray:
        """Return `residuals` with 1e3 where a law is undefined, for solvers that need numbers."""
        return np.nan_to_num(self.residuals(points), nan=1e3, posinf=1e3, neginf=-1e3)


@dataclass(frozen=True, eq=False)
class Problem(ParameterSpace):
    """Fit a law to a law: minimise an objective on a grid over the free parameters.

    Attributes
    ----------
    objective : Objective
        The objective with its data.
    """

    objective: Objective

    def values(self, points: FloatArray) -> FloatArray:
        """Return the objective of P points of the free parameters, shape (P, k) to (P,)."""
        at_once = max(1, _AT_ONCE // self.objective.dR.size)
        if len(points) <= at_once:
            return self.objective.values(self.form(points))
        parts = [points[first : first + at_once] for first in range(0, len(points), at_once)]
        return np.concatenate([self.values(part) for part in parts])

    def residuals(self, points: FloatArray) -> FloatArray:
        """Return the objective's residuals of P points, shape (P, k) to (P, q)."""
        return self.objective.residuals(self.form(points))

    def form(self, points: FloatArray) -> Form:
        """Return the laws at P points of the free parameters, shape (P, k)."""
        with np.errstate(all="ignore"):  # what is not finite lies outside the law
            return self.objective.form(self.model, self.complete(points))

    def value_of(self, coefficients: Mapping[str, float]) -> float:
        """Return the objective of coefficients by name, which may be outside the bounds."""
        form = self.objective.form(self.model, self.model.candidates(coefficients))
        return float(self.objective.values(form)[0])
