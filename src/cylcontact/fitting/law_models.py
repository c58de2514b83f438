"""The parameters by which each law of the package is fitted to data.

| law | parameters | acts as |
|---|---|---|
| power | K_star, n | f = K_star·(E*/ΔR)·δⁿ |
| power-one-pair | K, n | f = K·δⁿ, for one pair |
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

Two parameters of the rig may join those of any law, where a campaign names them: `offset`, the
reading at first touch in mm, and `compliance` in mm per N/mm (`laws.adapters.RigCompliance`).

A parameter that a campaign leaves out is searched between the bounds given here, or held at its
nominal value where it is not free: Lambda_factor (c does the same), and clearance_factor (small
loads do not tell it from modulus_factor).
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

Coefficients = Mapping[str, float]


@dataclass(frozen=True)
class LawParameter:
    """A parameter of a law, and how it is searched where nothing else is said.

    Attributes
    ----------
    name : str
        Its name in campaigns and results.
    low, high : float
        Default bounds of the search.
    nominal : float or None
        Its value in the law as published, where there is one.
    free : bool
        Whether it is searched by default, rather than held at its nominal value.
    shift : bool
        Whether zero is a value like any other, so that a share of the value means nothing.
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
        From values by name to the law; raises InputError where they define none.
    nominal_is_published : bool
        Whether the nominal values are those of the law's source, rather than this project's.
    """

    law: str
    contact: Contact
    parameters: tuple[LawParameter, ...]
    build: Callable[[Coefficients], ContactLaw]
    nominal_is_published: bool = True

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the parameters."""
        return tuple(parameter.name for parameter in self.parameters)

    @property
    def family(self) -> Family:
        """The family that searches evaluate."""
        nominal = {p.name: p.nominal for p in self.parameters if p.nominal is not None}
        is_known = self.nominal_is_published and len(nominal) == len(self.parameters)
        return Family(
            law=self.law,
            contact=self.contact,
            names=self.names,
            form=self.form,
            is_power_law=False,
            published=nominal if is_known else None,
            shifts=tuple(p.name for p in self.parameters if p.shift),
        )

    def form(self, candidates: FloatArray, _: FloatArray) -> LawForm:
        """Return the laws of candidates, shape (P, k); None where they define none."""
        return LawForm(tuple(self.law_or_none(row) for row in candidates))

    def law_or_none(self, row: FloatArray) -> ContactLaw | None:
        """Return the law of one candidate, None where it defines none."""
        try:
            return self.build(dict(zip(self.names, map(float, row), strict=True)))
        except InputError:
            return None


# What a rig adds to a reading, by name.
RIG = (
    LawParameter("offset", -1.0, 1.0, nominal=0.0, free=False, shift=True),
    LawParameter("compliance", 0.0, 1.0, nominal=0.0, free=False, shift=True),
)
# Terms of sums in the enhanced law, and exponents that may be zero.
ENHANCED_SHIFTS = ("Y_log_exponent", "Y_slope", "Y_offset", "n_exponent")
RIG_NAMES = tuple(parameter.name for parameter in RIG)


def with_rig(model: LawModel, named: Collection[str]) -> LawModel:
    """Return a model with those parameters of the rig that a campaign names.

    Examples
    --------
    >>> with_rig(model_of("power", "internal", "example"), ["n", "offset"]).names
    ('K_star', 'n', 'offset')
    """
    added = tuple(p for p in RIG if p.name in named and p.name not in model.names)
    if not added:
        return model

    def build(found: Coefficients) -> ContactLaw:
        rig = {p.name: found[p.name] for p in added}
        return RigCompliance(model.build({name: found[name] for name in model.names}), **rig)

    return replace(model, parameters=(*model.parameters, *added), build=build)


def without_rig(coefficients: Coefficients) -> dict[str, float]:
    """Return the coefficients of the contact alone.

    Examples
    --------
    >>> without_rig({"K_star": 3.0, "n": 1.1, "offset": 1e-3})
    {'K_star': 3.0, 'n': 1.1}
    """
    return {name: value for name, value in coefficients.items() if name not in RIG_NAMES}


def model_of(law: str, contact: Contact, source: str) -> LawModel:
    """Return the model of a law of the package.

    Raises
    ------
    InputError
        If there is no such law, or it is not for the contact.

    Examples
    --------
    >>> model_of("johnson", "internal", "example").names
    ('kappa', 'c', 'Lambda_factor')
    """
    found = MODELS.get((law, contact))
    if found is not None:
        return found
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
    return LawModel(name, contact, parameters, lambda found: adjusted_logarithmic(base, **found))


def _dimensionless(name: str, base: ContactLaw) -> LawModel:
    """Return the model of a law of f/(E*·ΔR) and δ/ΔR alone."""

    def build(found: Coefficients) -> ContactLaw:
        clearance = found["clearance_factor"]
        return ScaledLaw(base, found["modulus_factor"] * clearance, clearance)

    parameters = (
        LawParameter("modulus_factor", 0.05, 20.0, nominal=1.0),
        LawParameter("clearance_factor", 0.05, 20.0, nominal=1.0, free=False),
    )
    return LawModel(name, "internal", parameters, build)


def _power(found: Coefficients) -> ContactLaw:
    """Return the power law of K or K_star, and n."""
    return PowerLaw(**found)


def _winkler(found: Coefficients) -> ContactLaw:
    """Return the foundation of a depth."""
    return Winkler(depth=found["depth"])


def _lankarani_nikravesh(found: Coefficients) -> ContactLaw:
    """Return the point contact with another factor and exponent."""
    return ScaledLaw(LankaraniNikravesh(n=found["n"]), load_factor=found["factor"])


def _enhanced(contact: Contact) -> LawModel:
    """Return the model of the enhanced law."""
    internal = ((0.1, 1.5), (0.0, 0.5), (1.0, 3.0), (-0.6, 0.0), (-0.1, 0.1), (0.8, 1.6))
    bounds = (*internal, (-0.1, 0.1)) if contact == "internal" else ((0.1, 1.5), (0, 3), (1, 1.5))
    nominal = asdict(PUBLISHED[contact])
    parameters = tuple(
        LawParameter(name, low, high, nominal=value, shift=name in ENHANCED_SHIFTS)
        for (name, value), (low, high) in zip(nominal.items(), bounds, strict=True)
    )
    return LawModel("enhanced", contact, parameters, lambda found: Enhanced(coefficients=found))


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
        lambda found: Explicit(coefficients=found),
        nominal_is_published=False,
    )


def _models() -> dict[tuple[str, Contact], LawModel]:
    """Return every model, by law and contact."""
    exponent = LawParameter("n", 0.8, 2.0)
    models = []
    for contact in CONTACTS:
        power = (LawParameter("K_star", 1e-3, 1e3), exponent)
        models.append(LawModel("power", contact, power, _power))
        one_pair = (LawParameter("K", 1.0, 1e9), exponent)
        models.append(LawModel("power-one-pair", contact, one_pair, _power))
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


# The laws that campaigns on grids fit, from their coefficients.
FITTED: Mapping[str, Callable[[Mapping[str, float]], ContactLaw]] = {
    "enhanced": lambda values: Enhanced(coefficients=values),
    "explicit": lambda values: Explicit(coefficients=values),
    "power": lambda values: PowerLaw(**values),
}


def law_of(result: FitResult, source: str = "") -> ContactLaw:
    """Return the law that a fit found, of the contact alone: a rig's compliance is left out.

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
    # That module imports this one.
    from cylcontact.fitting.user_law import is_user_law

    coefficients = without_rig(result.coefficients)
    if result.law in FITTED:
        return FITTED[result.law](coefficients)
    if is_user_law(result.law):
        raise InputError(
            source or result.name,
            "law",
            result.law,
            "is a Python function of your own, and this needs a law of the package",
            "fit a law of the package, e.g. explicit",
        )
    return model_of(result.law, result.contact, source or result.name).build(coefficients)
