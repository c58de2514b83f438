"""A law with named parameters, as it is fitted."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.pair import Contact

Coefficients = Mapping[str, float]


@dataclass(frozen=True)
class Parameter:
    """A parameter of a law: searched between two bounds, fixed, or tied to others.

    Parameters
    ----------
    name : str
        Its name in campaigns and results.
    low, high : float
        Bounds of the search, if it is searched.
    nominal : float, optional
        A value to start from; that of the law's source if the model says so.
    value : float, optional
        The value that it is fixed at.
    tie : str, optional
        The expression that sets it, e.g. "a/10" (`fitting.ties`).
    shift : bool
        Whether its zero is arbitrary, so that a relative error has no meaning.
    stiffness : bool
        Whether it sets how stiff the contact is, and is free by default in a fit to measurements.
    unit : str
        Its unit; empty for a number without one.
    meaning : str
        What it is, in a few words.
    """

    name: str
    low: float = math.nan
    high: float = math.nan
    nominal: float | None = None
    value: float | None = None
    tie: str | None = None
    shift: bool = False
    stiffness: bool = False
    unit: str = ""
    meaning: str = ""

    @property
    def fixed(self) -> bool:
        """Whether it is fixed."""
        return self.value is not None

    @property
    def is_free(self) -> bool:
        """Whether it is searched."""
        return not self.fixed and self.tie is None


@dataclass(frozen=True)
class LawModel:
    """A law with named parameters, as it is fitted.

    Attributes
    ----------
    law : str
        Its name in campaigns.
    contact : {"internal", "external"}
        The contact it is for.
    parameters : tuple of Parameter
        Its parameters, each with default bounds, or fixed.
    build : callable
        From values by name to the law. Raises InputError if they define none.
    power_form : callable, optional
        For power laws at each clearance: from candidates, shape (P, k), and clearances ΔR in mm,
        shape (m,), to K* and n in f = K*·E*/ΔR·δⁿ, shape (P, m) each. Such a law can be evaluated
        from moments and has a lower bound.
    smooth_form : callable, optional
        From candidates, clearances and ε to ln K*, n and their derivatives by the parameters,
        shape (P, k, m), with every maximum in the law smoothed over ε. At ε = 0 it is `power_form`.
    on_grid : bool
        Whether the law can be fitted on a grid, where a sample has ΔR and f/E* only.
    dimensionless : bool
        Whether the coefficients have no units, so that it can be fitted on a grid of α, β and φ.
    nominal_is_published : bool
        Whether the nominal values are those of the law's source, not of this project.
    dR_min, dR_max : float
        The range of ΔR in mm, both ends included: calibration may use the open end of [0.005, 10[,
        which the law itself excludes.
    digest : str
        The hash of the file of a user's own law; empty for others.
    """

    law: str
    contact: Contact
    parameters: tuple[Parameter, ...]
    build: Callable[[Coefficients], ContactLaw]
    power_form: Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]] | None = None
    smooth_form: Callable[[FloatArray, FloatArray, float], tuple[FloatArray, ...]] | None = None
    on_grid: bool = False
    dimensionless: bool = False
    nominal_is_published: bool = True
    dR_min: float = 0.0
    dR_max: float = math.inf
    digest: str = ""

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the parameters, in the order of the columns of candidates."""
        return tuple(parameter.name for parameter in self.parameters)

    @property
    def published(self) -> dict[str, float] | None:
        """The published values of the parameters, if all have one."""
        nominal = {p.name: p.nominal for p in self.parameters if p.nominal is not None}
        is_published = self.nominal_is_published and len(nominal) == len(self.parameters)
        return nominal if is_published else None

    def candidates(self, *coefficients: Coefficients) -> FloatArray:
        """Return P sets of coefficients by name as candidates, shape (P, k)."""
        return np.array([[values[name] for name in self.names] for values in coefficients])
