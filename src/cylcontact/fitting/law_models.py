"""The models by which laws are fitted: those of the package, and what a test rig adds.

`cylcontact laws` has the parameters of each law with their bounds. A campaign may add three
to any law: `offset`, the reading at first touch in mm; `compliance`, the extra displacement per
unit load in mm per N/mm (`fitting.adapters.RigCompliance`); and `stiffness_factor`, which
multiplies the load.

By default a fit to measurements searches the offset and `stiffness_factor`; the constants that give
a law its shape stay fixed. A power law, which has no constants of its own, searches all.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from cylcontact.bodies.pair import Contact
from cylcontact.fitting.adapters import CorrectedInputs, RigCompliance, ScaledLaw
from cylcontact.fitting.parameters import STIFFNESS_FACTOR, LawModel, Parameter, package_models
from cylcontact.laws import LAWS, ContactLaw, contacts_of
from cylcontact.laws.conformal.housings import Housing
from cylcontact.laws.housing_spec import HousingSpec, in_housing
from cylcontact.laws.law import Coefficients
from cylcontact.laws.user import UserFunction, UserLaw
from cylcontact.support.errors import InputError

MODELS: dict[tuple[str, Contact], LawModel] = {(m.law, m.contact): m for m in package_models()}

_RIG = (
    STIFFNESS_FACTOR,
    Parameter("offset", -1.0, 1.0, 0.0, shift=True, unit="mm", meaning="reading at first touch"),
    Parameter(
        "compliance",
        -1.0,
        1.0,
        0.0,
        shift=True,
        unit="mm/(N/mm)",
        meaning="extra displacement per unit load: mounting, rig, housing",
    ),
)
RIG_NAMES = tuple(parameter.name for parameter in _RIG)


def with_rig(model: LawModel, named: Collection[str]) -> LawModel:
    """Return a model with those parameters of the rig that are named."""
    added = tuple(p for p in _RIG if p.name in named and p.name not in model.names)
    if not added:
        return model

    def build(values: Coefficients) -> ContactLaw:
        rig = {p.name: values[p.name] for p in added}
        law = model.build({name: values[name] for name in model.names})
        if "stiffness_factor" in rig:
            law = ScaledLaw(law, load_factor=rig.pop("stiffness_factor"))
        return RigCompliance(law, **rig) if rig else law

    return replace(model, parameters=(*model.parameters, *added), build=build)


def for_measurements(model: LawModel, free: Collection[str], named: Collection[str]) -> LawModel:
    """Return a model as it is fitted to measurements if a campaign does not say otherwise."""
    if any(p.nominal is None for p in model.parameters):
        return with_rig(model, {*free, *named})
    held = tuple(
        replace(p, value=None if p.stiffness or p.name in free else p.nominal)
        for p in model.parameters
    )
    usual = {"offset"}
    if not any(p.stiffness for p in held):
        usual.add("stiffness_factor")
    return with_rig(replace(model, parameters=held), {*usual, *free, *named})


def model_of(law: str, contact: Contact, source: str) -> LawModel:
    """Return the model of a law of the package."""
    if (law, contact) in MODELS:
        return MODELS[law, contact]
    plain = {name: contacts_of(name) for name in LAWS}
    if contact in plain.get(law, ()):
        return _without_constants(law, contact, LAWS[law]())
    others = [*(place for name, place in MODELS if name == law), *plain.get(law, ())]
    if others:
        raise InputError(
            source, "law", law, f"is for {others[0]} contact only", "choose another law or contact"
        )
    known = ", ".join(dict.fromkeys([*(name for name, _ in MODELS), *plain]))
    rule = "is not a law that can be fitted"
    remedy = f"choose {known}, or your module:function"
    raise InputError(source, "law", law, rule, remedy)


def _without_constants(law: str, contact: Contact, built: ContactLaw) -> LawModel:
    return LawModel(law, contact, (), lambda _: built, nominal_is_published=False)


def fittable_laws(contact: Contact) -> list[str]:
    """Return the names of the laws that can be fitted to a contact."""
    plain = [name for name in LAWS if contact in contacts_of(name)]
    return [*dict.fromkeys([*plain, *(name for name, place in MODELS if place == contact)])]


def listing(contact: Contact) -> str:
    """Return what a fit searches of each law, in a line for each parameter."""
    lines = ["parameters that a fit searches, and its bounds unless a campaign gives others:"]
    for model in MODELS.values():
        if model.contact == contact and model.parameters:
            lines.append(f"  {model.law}")
            for each in model.parameters:
                bounds = f"{each.low:g} to {each.high:g}"
                bounds = bounds if each.value is None else f"fixed at {each.value:g}"
                lines.append(f"    {each.name:<18} {bounds:<16} {each.unit:<11} {each.meaning}")
    return "\n".join(lines)


def grid_model_of(law: str, contact: Contact, source: str) -> LawModel:
    """Return the model of a law that can be fitted on a grid."""
    model = MODELS.get((law, contact))
    if model is None or not model.on_grid:
        known = " or ".join(sorted({model.law for model in MODELS.values() if model.on_grid}))
        rule = "is not a law that can be fitted on a grid"
        remedy = f"choose {known}; for another, cylcontact sample the grid and fit that table"
        raise InputError(source, "law", law, rule, remedy)
    return model


def user_model(law: str, contact: Contact, source: str, *folders: Path) -> LawModel:
    """Return the model of the user's function, from the first folder that has its file."""
    try:
        user = UserFunction.named(law, *folders)
        constants = user.formula.constants
        if not constants:
            rule = "has no constant to fit besides the penetration and what it asks of the pair"
            remedy = "write it as def load(penetration, E_star, dR, K, n): ..."
            raise InputError(law, "law", None, rule, remedy)
    except InputError as error:
        raise InputError(source, "law", law, error.rule, error.remedy) from error
    parameters = tuple(
        Parameter(name, *_bounds_of(user, name, source), nominal, value=nominal)
        for name, nominal in constants.items()
    )
    return named_user_model(user, parameters, contact)


def _bounds_of(user: UserFunction, name: str, source: str) -> tuple[float, float]:
    """Return the bounds that a function states for a constant, as in K: (1e4, 1e5)."""
    stated = getattr(user.function, "__annotations__", {}).get(name)
    if isinstance(stated, str):  # of a module with postponed annotations
        try:
            stated = ast.literal_eval(stated)
        except (ValueError, SyntaxError):
            stated = None
    if not isinstance(stated, tuple | list):
        return -math.inf, math.inf
    is_pair = len(stated) == 2 and all(isinstance(end, int | float) for end in stated)
    if not is_pair or not stated[0] < stated[1]:
        rule, remedy = "must be two numbers, the lower first", f"write {name}: (1.0, 2.0)"
        raise InputError(source, f"{user.spec}, bounds of {name}", stated, rule, remedy)
    return float(stated[0]), float(stated[1])


def named_user_model(
    user: UserFunction, parameters: tuple[Parameter, ...], contact: Contact
) -> LawModel:
    """Return the model of a function with these parameters, without importing it."""

    def build(values: Coefficients) -> ContactLaw:
        return UserLaw(user, dict(values))

    return LawModel(
        user.spec, contact, parameters, build, nominal_is_published=False, digest=user.digest
    )


def housed_model(law: str, contact: Contact, housing: Housing, source: str) -> LawModel:
    """Return the model of a law in a known housing: it has no constants of its own."""
    if contact == "external":
        rule, remedy = "is for a pin in a hole", "leave it out for rollers"
        raise InputError(source, "housing", None, rule, remedy)
    return _without_constants(law, contact, in_housing(law, housing, source))


def is_user_law(law: str) -> bool:
    """Return whether a law's name is module:function."""
    return ":" in law


def fitted_law(
    law: str,
    contact: Contact,
    coefficients: Coefficients,
    housing: Mapping[str, Any] | None,
    source: str,
) -> ContactLaw:
    """Return the fitted law of the contact for any pair, without the rig of the readings."""
    if is_user_law(law):
        rule = "is your own Python function, and this needs a law of the package"
        remedy = "fit a law of the package, e.g. explicit"
        raise InputError(source, "law", law, rule, remedy)
    if housing is None:
        model = model_of(law, contact, source)
    else:
        model = housed_model(law, contact, HousingSpec(**housing).housing, source)
    names = {*model.names, "stiffness_factor"}
    of_contact = {name: value for name, value in coefficients.items() if name in names}
    if "E_factor" in coefficients:  # of the modulus of both bodies, and so of the load
        stiffness = of_contact.get("stiffness_factor", 1.0)
        of_contact["stiffness_factor"] = stiffness * coefficients["E_factor"]
    built = with_rig(model, of_contact).build(of_contact)
    E = coefficients.get("E_i_factor", 1.0), coefficients.get("E_j_factor", 1.0)
    return built if E == (1.0, 1.0) else CorrectedInputs(built, E=E)
