"""What a fit needs of a law: its parameters, and how it is built and evaluated from them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from cylcontact.bodies.pair import CONTACTS, Contact
from cylcontact.fitting.adapters import ScaledLaw
from cylcontact.laws import (
    LAWS,
    Enhanced,
    Explicit,
    LankaraniNikravesh,
    Liu,
    LogarithmicLaw,
    Persson,
    PowerClearance,
    PowerLaw,
)
from cylcontact.laws.enhanced import INTERNAL_DR_MAX, INTERNAL_DR_MIN, internal_exponent
from cylcontact.laws.law import Coefficients, ContactLaw
from cylcontact.laws.power import of_clearance
from cylcontact.support.arrays import FloatArray, as_floats, require


@dataclass(frozen=True)
class Parameter:
    """A parameter of a law: searched between two bounds, fixed at a value, or tied to others.

    `nominal` is a value to start from, that of the law's source if the model says so; `tie` the
    expression that sets it, e.g. "a/10" (`fitting.ties`). The zero of a `shift` is arbitrary, so
    that a relative error has no meaning. A `stiffness` sets how stiff the contact is, and is free
    by default in a fit to measurements. What is `never_free` may be fixed at another value, but is
    not searched.
    """

    name: str
    low: float = math.nan
    high: float = math.nan
    nominal: float | None = None
    value: float | None = None
    tie: str | None = None
    shift: bool = False
    stiffness: bool = False
    never_free: bool = False
    unit: str = ""
    meaning: str = ""
    # Its value from elsewhere, and the standard deviation of that, as of a further reading.
    known: tuple[float, float] | None = None

    @property
    def fixed(self) -> bool:
        """Whether it is fixed."""
        return self.value is not None

    @property
    def is_free(self) -> bool:
        """Whether it is searched."""
        return not self.fixed and self.tie is None


# Multiplies the load of a law, as E* does.
STIFFNESS_FACTOR = Parameter(
    "stiffness_factor", 0.05, 20.0, 1.0, stiffness=True, meaning="multiplies the load, as E* does"
)


@dataclass(frozen=True)
class LawModel:
    """A law with named parameters, as it is fitted."""

    law: str  # its name in campaigns
    contact: Contact
    parameters: tuple[Parameter, ...]  # each with default bounds, or fixed
    build: Callable[[Coefficients], ContactLaw]  # raises InputError for values that define none
    # For power laws at each clearance: from candidates, shape (P, k), and clearances ΔR in mm,
    # shape (m,), to K* and n in f = K*·E*/ΔR·δⁿ, shape (P, m) each. Such a law can be evaluated
    # from moments and has a lower bound.
    power_form: Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]] | None = None
    # The same with ln K* for K*, and the derivatives of both by the parameters, shape (P, k, m).
    # The clearances may differ between candidates, shape (P, m).
    slope_form: Callable[[FloatArray, FloatArray], tuple[FloatArray, ...]] | None = None
    # Whether it can be fitted on a grid, where a sample has ΔR and f/E* only, and whether its
    # nominal values are those of the law's source, not of this project.
    on_grid: bool = False
    nominal_is_published: bool = True
    # The range of ΔR in mm, both ends included: calibration may use the open end of [0.005, 10[,
    # which the law itself excludes.
    dR_min: float = 0.0
    dR_max: float = math.inf
    # Which form of the law has these parameters, for one that could be written in several.
    formula: str = ""
    digest: str = ""  # the hash of the file of a user's own law

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


# The form of the enhanced law for internal contact.
_EQ_6D = "Eq 6d as printed"

# --- the laws of the package --------------------------------------------------------------------

# Constants whose zero is arbitrary.
_SHIFTS = {"c", "p", "n1", "q", "n2", "Y_log_exponent", "Y_slope", "Y_offset", "n_exponent"}


def parameters_of_fields(kind: Any, *names: str) -> tuple[Parameter, ...]:
    """Return the constants of a dataclass as parameters; its values, if it has them, as nominal."""
    return tuple(
        Parameter(
            each.name,
            nominal=None if isinstance(kind, type) else getattr(kind, each.name),
            shift=each.name in _SHIFTS,
            **each.metadata,
        )
        for each in fields(kind)
        if each.metadata and (not names or each.name in names)
    )


def _of_logarithmic(law: LogarithmicLaw, contact: Contact) -> LawModel:
    """Return a law by a factor S of its load, c and a factor of Λ.

    The latter acts through ln F + c alone, and is fixed. S is a factor of E*, which κ and c take:
    κ/S and c + ln S.
    """

    def build(values: Coefficients) -> ContactLaw:
        S, of_Lambda = values["stiffness_factor"], values["Lambda_factor"]
        for key, value in (("stiffness_factor", S), ("Lambda_factor", of_Lambda)):
            require(value > 0, law.name, key, value, "must be positive", "move its bounds")
        return replace(law, kappa=law.kappa / S, c=values["c"] + math.log(S * of_Lambda))

    factor = Parameter("Lambda_factor", 1e-3, 1e3, 1.0, value=1.0, meaning="factor of Λ")
    parameters = (STIFFNESS_FACTOR, *parameters_of_fields(law, "c"), factor)
    return LawModel(law.name, contact, parameters, build)


def _scaled(law: ContactLaw) -> LawModel:
    """Return a law between f/(E*·ΔR) and δ/ΔR, by factors of its load and of ΔR.

    The second is fixed by default: at small loads it is not identifiable beside the first.
    """

    def build(values: Coefficients) -> ContactLaw:
        clearance = values["clearance_factor"]
        return ScaledLaw(law, values["stiffness_factor"] * clearance, clearance)

    parameters = (
        STIFFNESS_FACTOR,
        Parameter("clearance_factor", 0.05, 20.0, nominal=1.0, value=1.0, meaning="factor of ΔR"),
    )
    return LawModel(law.name, "internal", parameters, build)


def _of_coefficients(law: Any, contact: Contact, **more: Any) -> LawModel:
    """Return a law by its coefficients for a contact."""
    parameters = tuple(
        replace(p, value=p.nominal, never_free=True) if p.name == "Y_switch" else p
        for p in parameters_of_fields(law.defaults[contact])
    )
    return LawModel(law.name, contact, parameters, law, on_grid=True, **more)


def _lankarani(contact: Contact) -> LawModel:
    """Return the law of Lankarani and Nikravesh by the exponent."""

    def build(values: Coefficients) -> ContactLaw:
        return LankaraniNikravesh(n=values["n"])

    law = LankaraniNikravesh()
    return LawModel(law.name, contact, parameters_of_fields(law), build)


def _power_law(values: Coefficients) -> ContactLaw:
    return PowerLaw(**values)


def _power_clearance(values: Coefficients) -> ContactLaw:
    return PowerClearance(**values)


def _of_power(contact: Contact) -> Iterator[LawModel]:
    """Yield the ways to fit a power law."""
    for name, factor, form in (
        ("power-one-pair", "K", None),
        ("power", "K_star", _constant),
        ("power-dimensionless", "C", _with_dR),
    ):
        n, each = parameters_of_fields(PowerLaw, "n", factor)
        on_grid = form is not None
        yield LawModel(name, contact, (each, n), _power_law, form, on_grid=on_grid)


def _of_clearance(contact: Contact) -> LawModel:
    """Return the power law by the clearance; two of its constants are zero by default."""
    parameters = tuple(
        replace(p, value=0.0 if p.name in ("q", "n2") else None)
        for p in parameters_of_fields(PowerClearance)
    )
    return LawModel(
        PowerClearance.name, contact, parameters, _power_clearance,
        _by_clearance, on_grid=True,
    )  # fmt: skip


def package_models() -> Iterator[LawModel]:
    """Yield the models of the laws of the package, those with default constants first."""
    for name in LAWS:
        law = LAWS[name]()
        if isinstance(law, LogarithmicLaw):
            yield from (_of_logarithmic(law, contact) for contact in CONTACTS)
        elif isinstance(law, Liu | Persson):
            yield _scaled(law)
    inside = {"dR_min": INTERNAL_DR_MIN, "dR_max": INTERNAL_DR_MAX}
    forms = {"power_form": _enhanced, "slope_form": _enhanced_slopes}
    yield _of_coefficients(Enhanced, "internal", formula=_EQ_6D, **forms, **inside)
    forms["slope_form"] = _external_slopes
    yield _of_coefficients(Enhanced, "external", **forms)
    for contact in CONTACTS:
        yield _of_coefficients(Explicit, contact, nominal_is_published=False)
    yield from (_lankarani(contact) for contact in CONTACTS)
    for contact in CONTACTS:
        yield from _of_power(contact)
    yield from (_of_clearance(contact) for contact in CONTACTS)


def _constant(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the same K* and n at every ΔR (Eqs 3-4)."""
    K_star, n = candidates.T[:, :, None] + np.zeros_like(dR)
    return K_star, n


def _with_dR(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return K* = C·ΔR^(2 − n), and n."""
    C, n = candidates.T[:, :, None] + np.zeros_like(dR)
    return as_floats(C * dR ** (2 - n)), n


def _by_clearance(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return K* and n of `PowerClearance`."""
    K_star, n = of_clearance(dR, *candidates.T[:, :, None])
    return as_floats(K_star), as_floats(n)


def _enhanced(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return K* and n of candidates at clearances (Eqs 5 and 6)."""
    a, b, *rest = candidates.T[:, :, None]
    n = internal_exponent(dR, *rest) if len(rest) > 1 else rest[0] + np.zeros_like(dR)
    return as_floats(a * dR + b), as_floats(n)


def _enhanced_slopes(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, ...]:
    """Return ln K*, n and their derivatives for internal contact."""
    a, b, scale, exponent, slope, offset, n_exponent, switch = candidates.T[:, :, None]
    K_star, log_dR, log_log = a * dR + b, np.log(dR), np.log(np.log(1000 * dR))
    power, reach = np.exp(exponent * log_log), np.exp(n_exponent * log_dR)
    linear = np.where(dR < switch, 0.0, reach)
    logarithmic = reach - linear
    n = scale * power * logarithmic + (slope * dR + offset) * linear
    K_slopes, n_slopes = np.zeros((2, *candidates.shape, dR.shape[-1]))
    K_slopes[:, 0], K_slopes[:, 1] = dR / K_star, 1 / K_star
    n_slopes[:, 2] = logarithmic * power
    n_slopes[:, 3] = logarithmic * scale * power * log_log
    n_slopes[:, 4], n_slopes[:, 5], n_slopes[:, 6] = linear * dR, linear, n * log_dR
    return np.log(K_star), n, K_slopes, n_slopes


def _external_slopes(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, ...]:
    """Return ln K*, n and their derivatives for external contact."""
    a, b, n = candidates.T[:, :, None]
    K_star = a * dR + b
    K_slopes, n_slopes = np.zeros((2, *candidates.shape, dR.shape[-1]))
    K_slopes[:, 0], K_slopes[:, 1], n_slopes[:, 2] = dR / K_star, 1 / K_star, 1.0
    return np.log(K_star), n + np.zeros_like(K_star), K_slopes, n_slopes
