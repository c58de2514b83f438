"""The laws of the package as formulas, with their coefficients and domains."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from cylcontact.errors import InputError
from cylcontact.export.formula import Formula
from cylcontact.laws import logarithmic_variants as variants
from cylcontact.laws.adapters import ScaledLaw
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.laws.enhanced import (
    INTERNAL_DR_MAX,
    INTERNAL_DR_MIN,
    PUBLISHED,
    Coefficients,
    Enhanced,
    ExternalCoefficients,
    coefficients_from,
)
from cylcontact.laws.explicit import CALIBRATED, Explicit, ExplicitCoefficients
from cylcontact.laws.liu import Liu
from cylcontact.laws.logarithmic import Johnson, LogarithmicLaw
from cylcontact.laws.power import PowerLaw
from cylcontact.laws.sphere import LankaraniNikravesh
from cylcontact.laws.winkler import DEPTH, Winkler
from cylcontact.pair import Contact

__all__ = ["formula_of"]

_MM_N_MPA = "Holds in mm, N and MPa only: its coefficients are not dimensionless."

# For each logarithmic law, its reach Lambda in mm and the arguments that the reach needs.
_RADII = ("R_i", "R_j")
_REACHES: Mapping[type[LogarithmicLaw], tuple[str, tuple[str, ...]]] = {
    Johnson: ("4 * pi * dR", ()),
    variants.RoarkYoung: ("4 * pi * dR", ()),
    variants.Radzimovsky: ("4 * pi * dR", ()),
    variants.RadzimovskyRadii: ("4 * pi * dR", ()),
    variants.Esdu78035: ("4 * pi * dR", ()),
    variants.DubowskyFreudenstein: (
        "pi * (length * length) / (R_i * R_j / dR)",
        (*_RADII, "length"),
    ),
    variants.Goldsmith: ("pi * (R_i * R_j / dR)", _RADII),
    variants.HertzCylinder: ("pi * dR", ()),
}


# The steps of each law, in the order in which the package computes them: an exported function then
# agrees with the package to the last digits and leaves its domain at the same number.
_POWER_STEPS = """
f = factor * penetration ** n
k = n * (factor * penetration ** (n - 1))
"""

# The factor of a power law, the law on one line and a remark, by the name of its constant.
_POWERS = {
    "C_factor": (
        "C_factor * E_star * dR ** (1 - n)",
        "f = C_factor*E_star*dR*(penetration/dR)^n",
        "Dimensionless in penetration/dR and f/(E_star*dR).",
    ),
    "K_star": ("K_star * (E_star / dR)", "f = K_star*E_star/dR*penetration^n", _MM_N_MPA),
    "K_factor": (
        "K_factor",
        "f = K_factor*penetration^n",
        f"{_MM_N_MPA} For the one pair that it was fitted to.",
    ),
}

_ENHANCED_INTERNAL_STEPS = """
Y_log = Y_log_scale * log(1000 * dR) ** Y_log_exponent
Y = max(Y_log, Y_slope * dR + Y_offset)
n = Y * dR ** n_exponent
K_geometry = a * dR + b
factor = K_geometry * E_star / dR if K_geometry > 0 and n > 0 else nan
"""

_ENHANCED_EXTERNAL_STEPS = """
K_geometry = a * dR + b
factor = K_geometry * E_star / dR if K_geometry > 0 and n > 0 else nan
"""

# Lambert's W in the variables of laws/lambert.py. The conditions are written so that NaN takes the
# regular branch, which p = 0 and p = 1 do not enter.
_LOGARITHMIC_STEPS = """
f_max = ({reach}) * E_star * peak
compliance = kappa / (pi * E_star)
share = penetration / (compliance * f_max)
p = share if share <= 1 else nan
inner = 0.5 if p <= 0 or p >= 1 else p
g = -log(inner)
root = sqrt(g)
top = 0.3361 * sqrt(0.5) * root
bottom = 1 + -0.0042 * g * exp(-0.0201 * root)
start = g + 2 / 0.3361 * top / (bottom + top)
u = 1 + start
h = start - log1p(start) - g
h1 = start / u
h2 = 1 / (u * u)
h3 = -2 / (u * u * u)
above = 6 * (h1 * h1) - 3 * h * h2
below = 6 * (h1 * h1 * h1) - 6 * h * h1 * h2 + h * h * h3
w = 0 if p >= 1 else start - h * above / below
f = f_max * (p / (1 + w))
k = 0 if p <= 0 else 1 / (compliance * w)
"""

_EXPLICIT_STEPS = """
d = penetration / dR if penetration > 0 else 1
ratio = A / d
first = log(B / d)
second = c + log1p(ratio * first)
third = c + log1p(ratio * second)
second_slope = -(ratio * (first + 1)) / (1 + ratio * first)
third_slope = ratio * (second_slope - second) / (1 + ratio * second)
f = pi * E_star * penetration / third
k = pi * E_star * (1 - third_slope / third) / third if penetration > 0 else 0
"""

_LIU_STEPS = """
root = sqrt(penetration / (2 * (dR + penetration)))
f = pi / 2 * E_star * penetration * root
k = pi / 4 * E_star * root * (3 * dR + 2 * penetration) / (dR + penetration)
"""

_LANKARANI_NIKRAVESH_STEPS = """
factor = 4 / 3 * E_star * sqrt(R_i * R_j / dR) / length
"""

# x - sin x by a power series where the difference loses digits, as in laws/winkler.py.
_WINKLER_STEPS = """
d = penetration / dR
x = 2 * atan(sqrt(d) * sqrt(2 + d))
small = x if x < 1 else 1
square = small * small
s18 = 1 - square / 342
s16 = 1 - square / 272 * s18
s14 = 1 - square / 210 * s16
s12 = 1 - square / 156 * s14
s10 = 1 - square / 110 * s12
s8 = 1 - square / 72 * s10
s6 = 1 - square / 42 * s8
s4 = 1 - square / 20 * s6
excess = x * x * x / 6 * s4 if x < 1 else x - sin(x)
f = E_star * dR / depth * ((1 + d) * excess / 2)
k = E_star / depth * ((x + sin(x)) / 2)
"""


def formula_of(law: ContactLaw, contact: Contact | None) -> Formula:
    """Return the formula of a law.

    Parameters
    ----------
    law : ContactLaw
        One of the package's laws that has a closed form for the load.
    contact : {"internal", "external"} or None
        The contact; may be None for laws that are the same for both.

    Returns
    -------
    Formula

    Raises
    ------
    InputError
        If the law has no closed form or is for the other contact.

    Examples
    --------
    >>> formula_of(Liu(), "internal").equation
    'f = pi/2*E_star*d*sqrt(d/(2*(dR + d))) with the penetration d'
    """
    for kind, build in _BUILDERS.items():
        if isinstance(law, kind):
            return build(law, contact)
    raise InputError(
        "export",
        "law",
        getattr(law, "name", law),
        "has no closed form to write in another language",
        "export explicit, which follows conformal contact",
    )


def _named(law: str, contact: Contact | None) -> str:
    """Return the name of the exported function."""
    return "_".join(["cylcontact", law.replace("-", "_"), *([contact] if contact else [])])


def _required(contact: Contact | None, law: str) -> Contact:
    """Return the contact; raise `InputError` if it is None."""
    if contact is None:
        raise InputError(
            "export",
            "--contact",
            None,
            f"is missing, and the {law} law has other coefficients for each",
            "give --contact internal or --contact external",
        )
    return contact


def _enhanced(law: Enhanced, contact: Contact | None) -> Formula:
    """Eqs 5-6 with the law's own coefficients, or the published ones of the contact."""
    chosen = _enhanced_coefficients(law, contact)
    numbers = {name: float(value) for name, value in asdict(chosen).items()}
    if isinstance(chosen, ExternalCoefficients):
        equation, text = "f = (a*dR + b)*E_star/dR*penetration^n", _ENHANCED_EXTERNAL_STEPS
        conditions: tuple[str, ...] = ()
    else:
        equation = (
            "f = (a*dR + b)*E_star/dR*penetration^n with n = Y*dR^n_exponent and "
            "Y = max(Y_log_scale*ln(1000*dR)^Y_log_exponent, Y_slope*dR + Y_offset)"
        )
        text = _ENHANCED_INTERNAL_STEPS
        conditions = (f"dR >= {INTERNAL_DR_MIN}", f"dR < {INTERNAL_DR_MAX}")
    return Formula(
        name=_named(law.name, chosen.contact),
        law=law,
        contact=chosen.contact,
        equation=equation,
        text=text + _POWER_STEPS.lstrip(),
        coefficients=numbers,
        constants=numbers,
        conditions=conditions,
        domain="a*dR + b > 0, n > 0",
        remark=_MM_N_MPA,
        origin="published, Pereira, Ramalho and Ambrosio 2015" if law.coefficients is None else "",
    )


def _enhanced_coefficients(law: Enhanced, contact: Contact | None) -> Coefficients:
    """Return the coefficients of a law; raise `InputError` if they are for the other contact."""
    own = law.coefficients
    if own is None:
        return PUBLISHED[_required(contact, law.name)]
    chosen = coefficients_from(own) if isinstance(own, Mapping) else own
    if contact not in (None, chosen.contact):
        raise InputError(
            "export",
            "--contact",
            contact,
            f"the coefficients are for {chosen.contact} contact",
            "leave it out",
        )
    return chosen


def _power(law: PowerLaw, contact: Contact | None) -> Formula:
    """Eqs 3-4, f = K*penetration^n, and its dimensionless form."""
    factors = {"C_factor": law.C, "K_star": law.K_star, "K_factor": law.K}
    name, value = next((name, value) for name, value in factors.items() if value is not None)
    step, equation, remark = _POWERS[name]
    numbers = {name: float(value), "n": float(law.n)}
    return Formula(
        name=_named(law.name, contact),
        law=law,
        contact=contact,
        equation=equation,
        text=f"factor = {step}\n" + _POWER_STEPS.lstrip(),
        coefficients=numbers,
        constants=numbers,
        remark=remark,
    )


def _logarithmic(law: LogarithmicLaw, contact: Contact | None) -> Formula:
    """Return the inverse of d = kappa/(pi*E_star)*f*(ln(Lambda*E_star/f) + c)."""
    reach, extra = _REACHES[type(law)]
    return Formula(
        name=_named(law.name, None),
        law=law,
        contact=contact,
        equation=(
            "penetration = kappa/(pi*E_star)*f*(ln(Lambda*E_star/f) + c) solved for f, with "
            f"Lambda = {reach.replace(' * ', '*').replace(' / ', '/')}"
        ),
        text=_LOGARITHMIC_STEPS.format(reach=reach),
        coefficients={"kappa": float(law.kappa), "c": float(law.shift)},
        constants={"kappa": float(law.kappa), "peak": float(np.exp(law.shift - 1))},
        extra=extra,
        domain=(
            "penetration <= kappa/pi*Lambda*peak, with peak = exp(c - 1), where the load is "
            "Lambda*E_star*peak and the stiffness infinite"
        ),
        remark=(
            "For bodies of equal elastic constants. f = f_max*p/(1 + w) with p the penetration in "
            "units of the largest and w = -1 - W(-p/e), W the lower branch of Lambert's function: "
            "closed-form start of Barry et al. 2000 and one Householder step, no iteration."
        ),
        origin="the law's own",
    )


def _scaled(law: ScaledLaw, contact: Contact | None) -> Formula:
    """Return a scaled logarithmic law, or the base law if both factors are 1."""
    B, D = law.load_factor, law.penetration_factor
    if isinstance(law.base, LogarithmicLaw):
        kappa, shift = law.base.kappa * D / B, law.base.shift + float(np.log(B))
        formula = _logarithmic(law.base, contact)
        return replace(
            formula,
            law=law,
            coefficients={"kappa": float(kappa), "c": shift},
            constants={"kappa": float(kappa), "peak": float(np.exp(shift - 1))},
            origin="",
        )
    if B == D == 1:
        return replace(formula_of(law.base, contact), law=law)
    raise InputError(
        "export",
        "law",
        law.name,
        "has factors of its own, which only logarithmic laws are written with",
        "hold its factors at 1, or fit power, explicit or a logarithmic law",
    )


def _explicit(law: Explicit, contact: Contact | None) -> Formula:
    """Return the explicit law with its own constants, or those calibrated for the contact."""
    own = law.coefficients
    where = contact if own is not None else _required(contact, law.name)
    chosen = (
        own if isinstance(own, ExplicitCoefficients) else CALIBRATED[_required(where, law.name)]
    )
    numbers = {name: float(value) for name, value in asdict(chosen).items()}
    return Formula(
        name=_named(law.name, where),
        law=law,
        contact=where,
        equation=(
            "f = pi*E_star*penetration/L with d = penetration/dR and "
            "L = c + ln(1 + A/d*(c + ln(1 + A/d*ln(B/d))))"
        ),
        text=_EXPLICIT_STEPS,
        coefficients=numbers,
        constants=numbers,
        remark="Dimensionless in penetration/dR and f/(E_star*dR); no largest penetration.",
        origin="calibrated for the contact" if own is None else "",
    )


def _require_internal(contact: Contact | None, law: str) -> None:
    """Raise `InputError` for external contact."""
    if contact == "external":
        raise InputError(
            "export",
            "--contact",
            contact,
            f"the law '{law}' is for a pin in a hole",
            "give --contact internal, or export johnson",
        )


def _liu(law: Liu, contact: Contact | None) -> Formula:
    """Return the law of Liu and co-workers, for a pin in a hole."""
    _require_internal(contact, law.name)
    return Formula(
        name=_named(law.name, None),
        law=law,
        contact="internal",
        equation="f = pi/2*E_star*d*sqrt(d/(2*(dR + d))) with the penetration d",
        text=_LIU_STEPS,
        coefficients={},
        constants={},
        remark="No largest penetration.",
        origin="the law has none",
    )


def _winkler(law: Winkler, contact: Contact | None) -> Formula:
    """Return the elastic foundation, for a pin in a hole."""
    _require_internal(contact, law.name)
    numbers = {"depth": float(law.depth)}
    return Formula(
        name=_named(law.name, None),
        law=law,
        contact="internal",
        equation=(
            "f = E_star/depth*((dR + penetration)*angle - dR*sin(angle)) with "
            "cos(angle) = dR/(dR + penetration)"
        ),
        text=_WINKLER_STEPS,
        coefficients=numbers,
        constants=numbers,
        remark="depth is that of the foundation in units of the radius, an assumption.",
        origin=(
            "assumed, for the slope of conformal contact at large loads"
            if law.depth == DEPTH
            else ""
        ),
    )


def _lankarani_nikravesh(law: LankaraniNikravesh, contact: Contact | None) -> Formula:
    """Return Eq 2 per unit length."""
    numbers = {"n": float(law.n)}
    return Formula(
        name=_named(law.name, None),
        law=law,
        contact=contact,
        equation="f = 4/3*E_star*sqrt(R_i*R_j/dR)/length*penetration^n",
        text=_LANKARANI_NIKRAVESH_STEPS + _POWER_STEPS.lstrip(),
        coefficients=numbers,
        constants=numbers,
        extra=(*_RADII, "length"),
        remark=(
            "The law gives the total force f*length of a point contact, independent of the length; "
            "f is that force per unit length."
        ),
        origin="the law's own",
    )


_BUILDERS: Mapping[type, Callable[[Any, Contact | None], Formula]] = {
    Enhanced: _enhanced,
    PowerLaw: _power,
    LogarithmicLaw: _logarithmic,
    ScaledLaw: _scaled,
    Explicit: _explicit,
    Liu: _liu,
    LankaraniNikravesh: _lankarani_nikravesh,
    Winkler: _winkler,
}
