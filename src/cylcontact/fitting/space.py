"""What is fitted: the free parameters of a law, and residuals whose squares are minimised.

Moments and samples of another law and readings are three spaces. Search, descent and profile know
nothing else.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.fitting.parameters import LawModel, Parameter
from cylcontact.fitting.ties import evaluate
from cylcontact.laws.law import ContactLaw
from cylcontact.support.arrays import FloatArray, as_floats
from cylcontact.support.errors import InputError

# Step of central differences, relative to the interval between the bounds.
_DIFFERENCE = 1e-6


@dataclass(frozen=True, eq=False)
class Space:
    """The parameters of a law, k of them free between bounds, the others fixed or tied.

    A subclass has `residuals`. If its objective is not the norm of these, it has `values` too.
    """

    model: LawModel
    # One for each of the model's names, in their order.
    parameters: tuple[Parameter, ...]

    # Whether the largest residual counts instead of the sum of squares.
    is_largest: ClassVar[bool] = False

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

    @cached_property
    def span(self) -> FloatArray:
        """Distances between the bounds, shape (k,)."""
        return self.high - self.low

    def fixing(self, **fixed: float) -> Self:
        """Return the same with some parameters fixed at values."""
        parameters = tuple(replace(p, value=fixed.get(p.name, p.value)) for p in self.parameters)
        return replace(self, parameters=parameters)

    def point(self, coefficients: Mapping[str, float]) -> FloatArray:
        """Return the free parameters from coefficients by name, shape (k,)."""
        return np.array([coefficients[name] for name in self.names])

    def coefficients(self, point: FloatArray) -> dict[str, float]:
        """Return all coefficients by name, including the fixed and the tied ones."""
        complete = self.complete(point[None, :])[0]
        return {p.name: float(v) for p, v in zip(self.parameters, complete, strict=True)}

    def complete(self, points: FloatArray) -> FloatArray:
        """Add the fixed and the tied parameters to P points, shape (P, k) to (P, all)."""
        columns: dict[str, ArrayLike] = dict(zip(self.names, points.T, strict=True))
        columns |= {p.name: p.value for p in self.parameters if p.value is not None}
        columns |= {p.name: evaluate(p.tie, columns) for p in self.parameters if p.tie is not None}
        complete = np.empty((len(points), len(self.parameters)))
        for index, parameter in enumerate(self.parameters):
            complete[:, index] = columns[parameter.name]
        return complete

    def scatter(self, rng: np.random.Generator, number: int) -> FloatArray:
        """Return random points between the bounds, shape (number, k)."""
        return rng.uniform(self.low, self.high, (number, len(self.free)))

    # --- the objective ------------------------------------------------------------------------

    def residuals(self, points: FloatArray) -> FloatArray:
        """Return residuals whose squares add up to the objective's, shape (P, k) to (P, q)."""
        raise NotImplementedError

    @cached_property
    def size(self) -> int:
        """The number of residuals, q."""
        return int(self.residuals(self.low[None, :]).shape[1])

    def values(self, points: FloatArray) -> FloatArray:
        """Return the objective of P points, shape (P, k) to (P,); inf if undefined."""
        with np.errstate(over="ignore", invalid="ignore"):
            norms = np.sqrt((self.residuals(points) ** 2).sum(axis=1))
        return np.where(np.isfinite(norms), norms, np.inf)

    def value(self, point: FloatArray) -> float:
        """Return the objective of one point, shape (k,)."""
        return float(self.values(point[None, :])[0])

    def value_of(self, coefficients: Mapping[str, float]) -> float:
        """Return the objective of coefficients by name, which may be outside the bounds."""
        fixed = (replace(p, value=coefficients[p.name], tie=None) for p in self.parameters)
        return replace(self, parameters=tuple(fixed)).value(np.empty(0))

    def finite_residuals(self, points: FloatArray) -> FloatArray:
        """Return `residuals` with 1e3 where a law is undefined, for solvers that need numbers."""
        return np.nan_to_num(self.residuals(points), nan=1e3, posinf=1e3, neginf=-1e3)

    # --- what a search may use ----------------------------------------------------------------

    @property
    def in_batches(self) -> bool:
        """Whether many points descend faster at once than one by one."""
        return False

    @property
    def is_ill_conditioned(self) -> bool:
        """Whether parameters may trade off so much that each descent is one of SciPy's."""
        return False

    def linearised(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the residuals and their derivatives, shapes (P, q) and (P, k, q)."""
        return self.finite_residuals(points), self.slopes(points)

    def curvatures(self, A: FloatArray) -> FloatArray:
        """Return what damps the steps of P descents, shape (P, k), from JᵀJ: here its mean."""
        mean = np.trace(A, axis1=1, axis2=2)[:, None] / A.shape[1]
        return as_floats(np.repeat(mean, A.shape[1], axis=1))

    def slopes(self, points: FloatArray) -> FloatArray:
        """Return the derivatives of the residuals, shape (P, k, q)."""
        return central_differences(self.finite_residuals, self.low, self.high, points)


def central_differences(
    function: Callable[[FloatArray], FloatArray],
    low: FloatArray,
    high: FloatArray,
    points: FloatArray,
) -> FloatArray:
    """Return the derivatives of a function of P points, shape (P, k, q); one-sided at a bound."""
    steps = np.diag(_DIFFERENCE * (high - low))
    ahead = np.minimum(points[:, None] + steps, high)
    behind = np.maximum(points[:, None] - steps, low)
    moved = np.concatenate([ahead, behind]).reshape(-1, low.size)
    there = function(moved).reshape(2, *ahead.shape[:2], -1)
    width = np.diagonal(ahead - behind, axis1=1, axis2=2)
    return as_floats((there[0] - there[1]) / width[..., None])


def law_of(model: LawModel, values: Sequence[float] | FloatArray) -> ContactLaw | None:
    """Return the law of values of all parameters; None for those that define none."""
    try:
        return model.build(dict(zip(model.names, map(float, values), strict=True)))
    except InputError:
        return None
