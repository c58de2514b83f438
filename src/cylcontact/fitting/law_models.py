"""The models by which laws are fitted: those of the package, and what a test rig adds.

`cylcontact laws` lists the parameters of each law with their bounds. A campaign may add two
parameters of the test rig to any law: `offset`, the reading at first touch in mm, and `compliance`
in mm per N/mm (`laws.adapters.RigCompliance`).
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import TYPE_CHECKING

from cylcontact.errors import InputError
from cylcontact.laws import DEFINITIONS, ContactLaw
from cylcontact.laws.adapters import RigCompliance
from cylcontact.laws.definition import Coefficients, LawModel, Parameter
from cylcontact.pair import Contact

if TYPE_CHECKING:
    from cylcontact.fitting.result import FitResult

__all__ = [
    "MODELS",
    "RIG_NAMES",
    "grid_model_of",
    "is_user_law",
    "law_of",
    "model_of",
    "with_rig",
]

MODELS = {(m.law, m.contact): m for definition in DEFINITIONS for m in definition.models}

# What a test rig adds to a reading.
_RIG = (
    Parameter(
        "offset",
        -1.0,
        1.0,
        nominal=0.0,
        value=0.0,
        shift=True,
        unit="mm",
        meaning="reading at first touch",
    ),
    Parameter(
        "compliance",
        0.0,
        1.0,
        nominal=0.0,
        value=0.0,
        shift=True,
        unit="mm/(N/mm)",
        meaning="compliance of the rig",
    ),
)
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

    def build(values: Coefficients) -> ContactLaw:
        rig = {p.name: values[p.name] for p in added}
        return RigCompliance(model.build({name: values[name] for name in model.names}), **rig)

    return replace(model, parameters=(*model.parameters, *added), build=build)


def _without_rig(coefficients: Coefficients) -> dict[str, float]:
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
