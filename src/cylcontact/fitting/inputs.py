"""Uncertain inputs: clearance, moduli, length, load cell, constants of a law or a rig.

`uncertain` gives each a standard uncertainty (GUM): that of a tolerance ±t is t/√3, that of a
certificate's U with k = 2 is U/2. The input is then fitted beside the other parameters, with what
is known of it as one further reading: a Gaussian about the stated value. Without it an input counts
as exact, and its error goes into the other parameters.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from cylcontact.files.reading import plain_number
from cylcontact.files.units import split_number
from cylcontact.fitting.adapters import CorrectedInputs
from cylcontact.fitting.parameters import LawModel, Parameter
from cylcontact.laws.law import Coefficients, ContactLaw
from cylcontact.support.arrays import FloatArray
from cylcontact.support.errors import InputError

# Inputs of a pair and of its readings; R_i and R_j count through the clearance.
INPUTS = ("dR", "R_i", "R_j", "E", "E_i", "E_j", "length", "load")
# What multiplies an input that was stated, by the input.
_FACTORS = {name: f"{name}_factor" for name in ("E", "E_i", "E_j", "length", "load")}
# Bounds of what is known, in its standard uncertainties; a clearance or a factor stays above this
# share of what was stated.
_REACH, _LEAST_SHARE = 8.0, 0.05
_UNITS = {"nm": 1e-6, "um": 1e-3, "µm": 1e-3, "mm": 1.0, "MPa": 1.0, "GPa": 1e3}
# Units of the inputs that have one; factors and constants are plain numbers.
_LENGTHS, _MODULI = ("nm", "um", "µm", "mm"), ("MPa", "GPa")
_ALLOWED = {
    **dict.fromkeys(("dR", "R_i", "R_j", "length"), _LENGTHS),
    **dict.fromkeys(("E", "E_i", "E_j"), _MODULI),
}


def with_inputs(
    model: LawModel,
    uncertain: Mapping[str, float | str],
    columns: Mapping[str, FloatArray],
    source: str,
) -> LawModel:
    """Return a model whose parameters include what is known only so well.

    A clearance has a parameter for each stated value, since each is another measurement. Moduli,
    lengths and loads have a factor each, for all rows.

    Parameters
    ----------
    model : LawModel
        With the parameters of the campaign; a constant that is uncertain has a value or bounds.
    uncertain : mapping of str to float or str
        Standard uncertainties by name: a number in mm, MPa or the unit of a constant, a number with
        its unit, or a share such as "5%".
    columns : mapping of str to array
        The inputs as stated, in mm, N/mm and MPa.
    source : str
        For errors.
    """
    _require_known(model, uncertain, source)
    sizes = {key: _size(key, text, source) for key, text in uncertain.items()}
    known, stated = [], {}
    for dR, sigma in _clearances(sizes, columns).items():
        name = "dR" if len(_values(columns)) == 1 else f"dR_{dR:g}"
        known.append(_known(name, dR, sigma, _LEAST_SHARE * dR, "mm"))
        stated[name] = dR
    for key, name in _FACTORS.items():
        if key in sizes:
            value, is_share = sizes[key]
            sigma = value if is_share else value / _stated(key, columns, source)
            known.append(_known(name, 1.0, sigma, _LEAST_SHARE, ""))
    constants = []
    for p in model.parameters:
        if p.name in sizes:
            value, is_share = sizes[p.name]
            at = p.value if p.value is not None else p.nominal
            sigma = value * abs(at) if is_share and at is not None else value
            constants.append(_constant(p, at, sigma, source))
        else:
            constants.append(p)
    base = replace(model, parameters=tuple(constants))
    if not known:
        return base

    def build(values: Coefficients) -> ContactLaw:
        law = model.build({name: values[name] for name in model.names})
        dR = tuple((at, values[name]) for name, at in stated.items())
        factor = {key: values.get(name, 1.0) for key, name in _FACTORS.items()}
        E = factor["E"] * factor["E_i"], factor["E"] * factor["E_j"]
        # Loads were read in total, and divided by the length.
        return CorrectedInputs(law, dR, E, factor["load"] / factor["length"])

    return replace(base, parameters=(*constants, *known), build=build)


def _known(name: str, at: float, sigma: float, least: float, unit: str) -> Parameter:
    low, high = max(at - _REACH * sigma, least), at + _REACH * sigma
    return Parameter(name, low, high, at, unit=unit, known=(at, sigma))


def _constant(p: Parameter, at: float | None, sigma: float, source: str) -> Parameter:
    """Return a constant that is known about its value."""
    if at is None or p.tie is not None:
        rule = "has no value that is known"
        remedy = f"give it: --fix {p.name}=VALUE, or [fixed] in a campaign"
        raise InputError(source, f"uncertain.{p.name}", None, rule, remedy)
    return replace(
        p, low=at - _REACH * sigma, high=at + _REACH * sigma, value=None, known=(at, sigma)
    )


def _require_known(model: LawModel, uncertain: Mapping[str, float | str], source: str) -> None:
    names = (*INPUTS, *model.names)
    for key in uncertain:
        if key not in names:
            rule = "is not an input or a parameter of this fit"
            raise InputError(source, f"uncertain.{key}", None, rule, f"choose {', '.join(names)}")
    for one, others in (("dR", ("R_i", "R_j")), ("E", ("E_i", "E_j"))):
        both = [other for other in others if one in uncertain and other in uncertain]
        if both:
            rule = f"is uncertain as well as {one}"
            raise InputError(source, f"uncertain.{both[0]}", None, rule, "keep one of them")


def _size(key: str, text: float | str, source: str) -> tuple[float, bool]:
    """Return a standard uncertainty, and whether it is a share."""
    number, unit = split_number(str(text))
    is_share = unit == "%"
    allowed = _ALLOWED.get(key, ())
    try:
        value = plain_number(number)
    except ValueError:
        value = math.nan
    unit = "" if is_share else unit
    if not (0 < value < math.inf) or (unit and unit not in allowed):
        example = '"2 um"' if allowed == _LENGTHS else '"5%"'
        rule = "must be a positive standard uncertainty"
        remedy = (
            f"give e.g. {example}; of a tolerance ±t it is t/√3, of a certificate's U it is U/2"
        )
        raise InputError(source, f"uncertain.{key}", text, rule, remedy)
    if is_share:
        return value / 100, True
    if key == "load" and not unit:
        rule = "must be a share of the load"
        raise InputError(source, "uncertain.load", text, rule, 'give e.g. "1%"')
    return value * _UNITS.get(unit, 1.0), False


def _values(columns: Mapping[str, FloatArray]) -> list[float]:
    return [float(value) for value in np.unique(columns["dR"])]


def _clearances(
    sizes: Mapping[str, tuple[float, bool]], columns: Mapping[str, FloatArray]
) -> dict[float, float]:
    """Return the standard uncertainty of each stated clearance in mm; none if all are exact."""
    if "dR" in sizes:
        value, is_share = sizes["dR"]
        return {dR: value * dR if is_share else value for dR in _values(columns)}
    radii = {key: sizes[key] for key in ("R_i", "R_j") if key in sizes}
    if not radii:
        return {}
    squares = [
        (value * (float(columns[key].mean()) if is_share else 1.0)) ** 2
        for key, (value, is_share) in radii.items()
    ]
    return dict.fromkeys(_values(columns), math.sqrt(sum(squares)))


def _stated(key: str, columns: Mapping[str, FloatArray], source: str) -> float:
    """Return the stated value to which an uncertainty in its unit is relative."""
    names = {"E": ("E_i", "E_j")}.get(key, (key,))
    values = np.unique([columns[name] for name in names if name in columns])
    if values.size != 1:
        rule = "is of values that differ from row to row, or is not given"
        raise InputError(source, f"uncertain.{key}", None, rule, 'give it as a share, e.g. "5%"')
    return float(values[0])
