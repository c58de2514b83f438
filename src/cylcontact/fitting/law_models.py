"""The parameters by which each law of the package is fitted to data.

| law | parameters | acts as |
|---|---|---|
| power | K_star, n | f = K_star·(E*/ΔR)·δⁿ |
| power-one-pair | K, n | f = K·δⁿ, for one pair |
| power-dimensionless | C, n | f = C·E*·ΔR·(δ/ΔR)ⁿ |
| enhanced, internal | a, b, Y_log_scale, Y_log_exponent, Y_slope, Y_offset, n_exponent | Eqs 5–6 |
| enhanced, external | a, b, n | Eqs 5–6 |
| explicit | c, A, B | `laws.explicit` |
| johnson, roark-young, radzimovsky, radzimovsky-radii, esdu-78035, dubowsky-freudenstein, \
goldsmith, hertz-cylinder | kappa, c, Lambda_factor | \
δ = kappa·f/(πE*)·[ln(Lambda_factor·Λ·E*/f) + c], Λ the law's own |
| persson, liu (internal) | modulus_factor, clearance_factor | the law with modulus_factor·E* and \
clearance_factor·ΔR in place of E* and ΔR |
| winkler (internal) | depth | depth of the foundation over the radius; modulus E* |
| lankarani-nikravesh | factor, n | F = factor·(4/3)·E*·√R·δⁿ |

A campaign may add two parameters of the test rig to any law: `offset`, the reading at first touch
in mm, and `compliance` in mm per N/mm (`laws.adapters.RigCompliance`).

A parameter that a campaign leaves out is searched between the bounds given here. Two are fixed at
their nominal values by default: Lambda_factor, which is redundant with c, and clearance_factor,
which is not identifiable beside modulus_factor at small loads.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import asdict, dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.errors import InputError
from cylcontact.fitting.parameters import Parameter
from cylcontact.fitting.samples import Form, LawForm, PowerForm
from cylcontact.laws import LAWS, PUBLISHED, ContactLaw
from cylcontact.laws.adapters import RigCompliance, ScaledLaw, adjusted_logarithmic
from cylcontact.laws.enhanced import (
    INTERNAL_DR_MAX,
    INTERNAL_DR_MIN,
    Enhanced,
    internal_exponent,
    stiffness_factor,
)
from cylcontact.laws.explicit import CALIBRATED, Explicit, ExplicitCoefficients
from cylcontact.laws.logarithmic import LogarithmicLaw
from cylcontact.laws.power import PowerLaw
from cylcontact.laws.sphere import LankaraniNikravesh
from cylcontact.laws.winkler import DEPTH, Winkler
from cylcontact.pair import CONTACTS, Contact

if TYPE_CHECKING:
    from cylcontact.fitting.result import FitResult

__all__ = [
    "MODELS",
    "RIG_NAMES",
    "LawModel",
    "grid_model_of",
    "is_user_law",
    "law_of",
    "model_of",
    "with_rig",
]

_Coefficients = Mapping[str, float]


@dataclass(frozen=True)
class LawModel:
    """A law with named parameters.

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
        shape (m,), to a `PowerForm`, which can be evaluated from moments and has a lower bound.
    on_grid : bool
        Whether the law can be fitted on a grid, where a sample has ΔR and f/E* only.
    nominal_is_published : bool
        Whether the nominal values are those of the law's source, not of this project.
    dR_min, dR_max : float
        The range of ΔR in mm, both ends included: calibration may use the open end of [0.005, 10[,
        which the law itself excludes.
    """

    law: str
    contact: Contact
    parameters: tuple[Parameter, ...]
    build: Callable[[_Coefficients], ContactLaw]
    power_form: Callable[[FloatArray, FloatArray], PowerForm] | None = None
    on_grid: bool = False
    nominal_is_published: bool = True
    dR_min: float = 0.0
    dR_max: float = math.inf

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

    def candidates(self, *coefficients: _Coefficients) -> FloatArray:
        """Return P sets of coefficients by name as candidates, shape (P, k)."""
        return np.array([[values[name] for name in self.names] for values in coefficients])

    def form(self, candidates: FloatArray, dR: FloatArray) -> Form:
        """Return candidates, shape (P, k), at clearances ΔR in mm, shape (m,)."""
        return self.laws(candidates) if self.power_form is None else self.power_form(candidates, dR)

    def laws(self, candidates: FloatArray) -> LawForm:
        """Return the laws of candidates, shape (P, k); None for one that defines none."""
        return LawForm(tuple(self._law_or_none(row) for row in candidates))

    def _law_or_none(self, row: FloatArray) -> ContactLaw | None:
        """Return the law of one candidate, or None."""
        try:
            return self.build(dict(zip(self.names, map(float, row), strict=True)))
        except InputError:
            return None


# What a test rig adds to a reading.
_RIG = (
    Parameter("offset", -1.0, 1.0, nominal=0.0, value=0.0, shift=True),
    Parameter("compliance", 0.0, 1.0, nominal=0.0, value=0.0, shift=True),
)
# Terms of sums in the enhanced law, and exponents that may be zero.
_ENHANCED_SHIFTS = ("Y_log_exponent", "Y_slope", "Y_offset", "n_exponent")
RIG_NAMES = tuple(parameter.name for parameter in _RIG)


def with_rig(model: LawModel, named: Collection[str]) -> LawModel:
    """Return a model with the parameters of the rig that a campaign names.

    Examples
    --------
    >>> with_rig(model_of("power", "internal", "example"), ["n", "offset"]).names
    ('K_star', 'n', 'offset')
    """
    added = tuple(p for p in _RIG if p.name in named and p.name not in model.names)
    if not added:
        return model

    def build(values: _Coefficients) -> ContactLaw:
        rig = {p.name: values[p.name] for p in added}
        return RigCompliance(model.build({name: values[name] for name in model.names}), **rig)

    return replace(model, parameters=(*model.parameters, *added), build=build)


def _without_rig(coefficients: _Coefficients) -> dict[str, float]:
    """Return the coefficients of the contact, without those of the rig.

    Examples
    --------
    >>> _without_rig({"K_star": 3.0, "n": 1.1, "offset": 1e-3})
    {'K_star': 3.0, 'n': 1.1}
    """
    return {name: value for name, value in coefficients.items() if name not in RIG_NAMES}


def model_of(law: str, contact: Contact, source: str) -> LawModel:
    """Return the model of a law of the package.

    Raises
    ------
    InputError
        If the law is unknown, or not for this contact.

    Examples
    --------
    >>> model_of("johnson", "internal", "example").names
    ('kappa', 'c', 'Lambda_factor')
    """
    model = MODELS.get((law, contact))
    if model is not None:
        return model
    others = [place for name, place in MODELS if name == law]
    if others:
        raise InputError(
            source, "law", law, f"is for {others[0]} contact only", "choose another law or contact"
        )
    known = ", ".join(dict.fromkeys(name for name, _ in MODELS))
    raise InputError(
        source,
        "law",
        law,
        "is not a law that can be fitted",
        f"choose {known}, or module:function for one of your own",
    )


def grid_model_of(law: str, contact: Contact, source: str) -> LawModel:
    """Return the model of a law that can be fitted on a grid.

    Raises
    ------
    InputError
        If the law cannot be fitted on a grid.
    """
    model = MODELS.get((law, contact))
    if model is None or not model.on_grid:
        known = " or ".join(sorted({model.law for model in MODELS.values() if model.on_grid}))
        rule = "is not a law that can be fitted on a grid"
        raise InputError(source, "law", law, rule, f"choose {known}")
    return model


def _logarithmic(name: str, base: LogarithmicLaw, contact: Contact) -> LawModel:
    """Return the model of a logarithmic law."""
    parameters = (
        Parameter("kappa", 0.2, 5.0, nominal=float(base.kappa)),
        Parameter("c", -5.0, 5.0, nominal=float(base.shift), shift=True),
        Parameter("Lambda_factor", 1e-3, 1e3, nominal=1.0, value=1.0),
    )
    return LawModel(name, contact, parameters, lambda values: adjusted_logarithmic(base, **values))


def _scaled(name: str, base: ContactLaw) -> LawModel:
    """Return the model of a law between f/(E*·ΔR) and δ/ΔR."""

    def build(values: _Coefficients) -> ContactLaw:
        clearance = values["clearance_factor"]
        return ScaledLaw(base, values["modulus_factor"] * clearance, clearance)

    parameters = (
        Parameter("modulus_factor", 0.05, 20.0, nominal=1.0),
        Parameter("clearance_factor", 0.05, 20.0, nominal=1.0, value=1.0),
    )
    return LawModel(name, "internal", parameters, build)


def _power_law(values: _Coefficients) -> ContactLaw:
    """Return the power law of n and one of K, K_star and C."""
    return PowerLaw(**values)


def _enhanced_law(values: _Coefficients) -> ContactLaw:
    """Return the enhanced law."""
    return Enhanced(coefficients=values)


def _explicit_law(values: _Coefficients) -> ContactLaw:
    """Return the explicit law."""
    return Explicit(coefficients=values)


def _at_clearances(K_star: FloatArray, n: FloatArray, dR: FloatArray) -> PowerForm:
    """Return the candidates with these K* and n, (P, m) each, at ΔR in mm, (m,)."""
    K_star = np.where(K_star > 0, K_star, np.nan)
    return PowerForm(
        c=as_floats(np.log(dR) - np.log(K_star)), n=as_floats(np.where(n > 0, n, np.nan))
    )


def _internal_form(candidates: FloatArray, dR: FloatArray) -> PowerForm:
    """Eqs 5–6 for internal contact."""
    a, b, *rest = candidates.T[:, :, None]
    return _at_clearances(stiffness_factor(dR, a, b), internal_exponent(dR, *rest), dR)


def _external_form(candidates: FloatArray, dR: FloatArray) -> PowerForm:
    """Eqs 5–6 for external contact."""
    a, b, n = candidates.T[:, :, None]
    return _at_clearances(stiffness_factor(dR, a, b), n + np.zeros_like(dR), dR)


def _power_form(candidates: FloatArray, dR: FloatArray) -> PowerForm:
    """Eqs 3–4: the same K* and n at every ΔR."""
    K_star, n = candidates.T[:, :, None] + np.zeros_like(dR)
    return _at_clearances(K_star, n, dR)


def _dimensionless_form(candidates: FloatArray, dR: FloatArray) -> PowerForm:
    """f = C·E*·ΔR·(δ/ΔR)^n, that is K* = C·ΔR^(2 − n)."""
    C, n = candidates.T[:, :, None] + np.zeros_like(dR)
    return _at_clearances(C * dR ** (2 - n), n, dR)


def _winkler(values: _Coefficients) -> ContactLaw:
    """Return the elastic foundation of a depth."""
    return Winkler(depth=values["depth"])


def _lankarani_nikravesh(values: _Coefficients) -> ContactLaw:
    """Return the point contact with a factor and an exponent."""
    return ScaledLaw(LankaraniNikravesh(n=values["n"]), load_factor=values["factor"])


def _enhanced(contact: Contact) -> LawModel:
    """Return the model of the enhanced law."""
    internal = ((0.1, 1.5), (0.0, 0.5), (1.0, 3.0), (-0.6, 0.0), (-0.1, 0.1), (0.8, 1.6))
    bounds = (*internal, (-0.1, 0.1)) if contact == "internal" else ((0.1, 1.5), (0, 3), (1, 1.5))
    nominal = asdict(PUBLISHED[contact])
    parameters = tuple(
        Parameter(name, low, high, nominal=value, shift=name in _ENHANCED_SHIFTS)
        for (name, value), (low, high) in zip(nominal.items(), bounds, strict=True)
    )
    is_internal = contact == "internal"
    return LawModel(
        "enhanced",
        contact,
        parameters,
        _enhanced_law,
        power_form=_internal_form if is_internal else _external_form,
        on_grid=True,
        dR_min=INTERNAL_DR_MIN if is_internal else 0.0,
        dR_max=INTERNAL_DR_MAX if is_internal else math.inf,
    )


def _explicit(contact: Contact) -> LawModel:
    """Return the model of the explicit law."""
    bounds = {"c": (0.5, 3.0), "A": (0.05, 5.0), "B": (0.5, 20.0)}
    parameters = tuple(
        Parameter(
            f.name,
            *bounds[f.name],
            nominal=getattr(CALIBRATED[contact], f.name),
            shift=f.name == "c",
        )
        for f in fields(ExplicitCoefficients)
    )
    return LawModel(
        "explicit",
        contact,
        parameters,
        _explicit_law,
        on_grid=True,
        nominal_is_published=False,
    )


def _models() -> dict[tuple[str, Contact], LawModel]:
    """Return every model, by law and contact."""
    exponent = Parameter("n", 0.8, 2.0)
    models = []
    for contact in CONTACTS:
        one_pair = (Parameter("K", 1.0, 1e9), exponent)
        models.append(LawModel("power-one-pair", contact, one_pair, _power_law))
        for name, factor, form in (
            ("power", Parameter("K_star", 1e-3, 1e3), _power_form),
            ("power-dimensionless", Parameter("C", 1e-3, 1e3), _dimensionless_form),
        ):
            parameters = (factor, exponent)
            models.append(LawModel(name, contact, parameters, _power_law, form, on_grid=True))
        models += [_enhanced(contact), _explicit(contact)]
        point = (
            Parameter("factor", 1e-2, 1e2, nominal=1.0),
            Parameter("n", 0.8, 2.0, nominal=1.5),
        )
        models.append(LawModel("lankarani-nikravesh", contact, point, _lankarani_nikravesh))
        for name, make in LAWS.items():
            base = make()
            if isinstance(base, LogarithmicLaw):
                models.append(_logarithmic(name, base, contact))
    models += [_scaled(name, LAWS[name]()) for name in ("persson", "liu")]
    depth = Parameter("depth", 0.05, 20.0, nominal=DEPTH)
    models.append(LawModel("winkler", "internal", (depth,), _winkler, nominal_is_published=False))
    return {(model.law, model.contact): model for model in models}


MODELS = _models()


def is_user_law(law: str) -> bool:
    """Return whether a law's name is module:function."""
    return ":" in law


def law_of(result: FitResult, source: str = "") -> ContactLaw:
    """Return the fitted law of the contact, without the offset and compliance of the rig.

    Parameters
    ----------
    result : FitResult
        A fit on a grid or to measurements.
    source : str, optional
        The result's file, for error messages; by default its name.

    Raises
    ------
    InputError
        If the law is a Python function of the user's own.
    """
    if is_user_law(result.law):
        raise InputError(
            source or result.name,
            "law",
            result.law,
            "is a Python function of your own, and this needs a law of the package",
            "fit a law of the package, e.g. explicit",
        )
    model = model_of(result.law, result.contact, source or result.name)
    return model.build(_without_rig(result.coefficients))
