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

from collections.abc import Callable, Collection, Mapping
from dataclasses import asdict, dataclass, fields, replace
from typing import TYPE_CHECKING

from cylcontact.arrays import FloatArray
from cylcontact.errors import InputError
from cylcontact.fitting.parameters import Family, LawForm
from cylcontact.laws import LAWS, PUBLISHED, ContactLaw
from cylcontact.laws.adapters import RigCompliance, ScaledLaw, adjusted_logarithmic
from cylcontact.laws.enhanced import Enhanced
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
    "LawParameter",
    "is_user_law",
    "law_of",
    "model_of",
    "with_rig",
]

_Coefficients = Mapping[str, float]


@dataclass(frozen=True)
class LawParameter:
    """A parameter of a law with its default bounds.

    Attributes
    ----------
    name : str
        Its name in campaigns and results.
    low, high : float
        Default bounds of the search.
    nominal : float or None
        Its value in the published law; None if there is none.
    free : bool
        Whether it is searched by default; otherwise it is fixed at its nominal value.
    shift : bool
        Whether its zero is arbitrary, so that a relative error has no meaning.
    """

    name: str
    low: float
    high: float
    nominal: float | None = None
    free: bool = True
    shift: bool = False


@dataclass(frozen=True)
class LawModel:
    """A law with named parameters.

    Attributes
    ----------
    law : str
        Its name in campaigns.
    contact : {"internal", "external"}
        The contact it is for.
    parameters : tuple of LawParameter
        Its parameters.
    build : callable
        From values by name to the law. Raises InputError if they define none.
    nominal_is_published : bool
        Whether the nominal values are those of the law's source, not of this project.
    """

    law: str
    contact: Contact
    parameters: tuple[LawParameter, ...]
    build: Callable[[_Coefficients], ContactLaw]
    nominal_is_published: bool = True

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the parameters."""
        return tuple(parameter.name for parameter in self.parameters)

    @property
    def family(self) -> Family:
        """The family of candidates for a search."""
        nominal = {p.name: p.nominal for p in self.parameters if p.nominal is not None}
        is_published = self.nominal_is_published and len(nominal) == len(self.parameters)
        return Family(
            law=self.law,
            contact=self.contact,
            names=self.names,
            form=self.form,
            is_power_law=False,
            published=nominal if is_published else None,
            shifts=tuple(p.name for p in self.parameters if p.shift),
        )

    def form(self, candidates: FloatArray, _: FloatArray) -> LawForm:
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
    LawParameter("offset", -1.0, 1.0, nominal=0.0, free=False, shift=True),
    LawParameter("compliance", 0.0, 1.0, nominal=0.0, free=False, shift=True),
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


def _logarithmic(name: str, base: LogarithmicLaw, contact: Contact) -> LawModel:
    """Return the model of a logarithmic law."""
    parameters = (
        LawParameter("kappa", 0.2, 5.0, nominal=float(base.kappa)),
        LawParameter("c", -5.0, 5.0, nominal=float(base.shift), shift=True),
        LawParameter("Lambda_factor", 1e-3, 1e3, nominal=1.0, free=False),
    )
    return LawModel(name, contact, parameters, lambda values: adjusted_logarithmic(base, **values))


def _dimensionless(name: str, base: ContactLaw) -> LawModel:
    """Return the model of a law between f/(E*·ΔR) and δ/ΔR."""

    def build(values: _Coefficients) -> ContactLaw:
        clearance = values["clearance_factor"]
        return ScaledLaw(base, values["modulus_factor"] * clearance, clearance)

    parameters = (
        LawParameter("modulus_factor", 0.05, 20.0, nominal=1.0),
        LawParameter("clearance_factor", 0.05, 20.0, nominal=1.0, free=False),
    )
    return LawModel(name, "internal", parameters, build)


def _power(values: _Coefficients) -> ContactLaw:
    """Return the power law of n and one of K, K_star and C."""
    return PowerLaw(**values)


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
        LawParameter(name, low, high, nominal=value, shift=name in _ENHANCED_SHIFTS)
        for (name, value), (low, high) in zip(nominal.items(), bounds, strict=True)
    )
    return LawModel("enhanced", contact, parameters, lambda values: Enhanced(coefficients=values))


def _explicit(contact: Contact) -> LawModel:
    """Return the model of the explicit law."""
    bounds = {"c": (0.5, 3.0), "A": (0.05, 5.0), "B": (0.5, 20.0)}
    parameters = tuple(
        LawParameter(
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
        lambda values: Explicit(coefficients=values),
        nominal_is_published=False,
    )


def _models() -> dict[tuple[str, Contact], LawModel]:
    """Return every model, by law and contact."""
    exponent = LawParameter("n", 0.8, 2.0)
    models = []
    for contact in CONTACTS:
        powers = {
            "power": LawParameter("K_star", 1e-3, 1e3),
            "power-one-pair": LawParameter("K", 1.0, 1e9),
            "power-dimensionless": LawParameter("C", 1e-3, 1e3),
        }
        models += [
            LawModel(name, contact, (factor, exponent), _power) for name, factor in powers.items()
        ]
        models += [_enhanced(contact), _explicit(contact)]
        point = (
            LawParameter("factor", 1e-2, 1e2, nominal=1.0),
            LawParameter("n", 0.8, 2.0, nominal=1.5),
        )
        models.append(LawModel("lankarani-nikravesh", contact, point, _lankarani_nikravesh))
        for name, make in LAWS.items():
            base = make()
            if isinstance(base, LogarithmicLaw):
                models.append(_logarithmic(name, base, contact))
    models += [_dimensionless(name, LAWS[name]()) for name in ("persson", "liu")]
    depth = LawParameter("depth", 0.05, 20.0, nominal=DEPTH)
    models.append(LawModel("winkler", "internal", (depth,), _winkler, nominal_is_published=False))
    return {(model.law, model.contact): model for model in models}


MODELS = _models()


def is_user_law(law: str) -> bool:
    """Return whether a law's name is module:function."""
    return ":" in law


def law_of(result: FitResult, source: str = "") -> ContactLaw:
    """Return the fitted law of the contact, without the compliance of the rig.

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
