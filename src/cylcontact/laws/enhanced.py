"""The enhanced law of Pereira, Ramalho and Ambrósio, Eqs 5–6: f = (aΔR + b)·E*/ΔR·δⁿ."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from numbers import Real
from typing import ClassVar, cast

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import BoolArray, FloatArray, as_floats, inside_or_nan, require
from cylcontact.errors import InputError
from cylcontact.html_repr import completed_law_html
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.laws.definition import Coefficients as Values
from cylcontact.laws.definition import Definition, LawModel, Parameter
from cylcontact.laws.formula import IN_MM, Formula, function_name, required_contact
from cylcontact.laws.power import KERNEL, PowerShaped
from cylcontact.pair import CONTACTS, Contact, CylinderPair

__all__ = [
    "DEFINITION",
    "INTERNAL_DR_MAX",
    "INTERNAL_DR_MIN",
    "PUBLISHED",
    "PUBLISHED_DR",
    "Coefficients",
    "Enhanced",
    "ExternalCoefficients",
    "InternalCoefficients",
    "coefficients_from",
    "internal_Y",
    "internal_exponent",
    "stiffness_factor",
]

# Eq 6d defines Y for internal contact on [0.005, 10[ mm.
INTERNAL_DR_MIN = 0.005
INTERNAL_DR_MAX = 10.0


@dataclass(frozen=True)
class InternalCoefficients:
    """Coefficients for internal contact; the defaults are the published ones (Eq 6)."""

    a: float = 0.965
    b: float = 0.0965
    Y_log_scale: float = 1.51
    Y_log_exponent: float = -0.151
    Y_slope: float = 0.0151
    Y_offset: float = 1.151
    n_exponent: float = -0.005
    contact: ClassVar[Contact] = "internal"

    def exponent(self, dR: FloatArray) -> FloatArray:
        """Return n at ΔR in mm (Eq 6c)."""
        return internal_exponent(
            dR,
            self.Y_log_scale,
            self.Y_log_exponent,
            self.Y_slope,
            self.Y_offset,
            self.n_exponent,
        )


@dataclass(frozen=True)
class ExternalCoefficients:
    """Coefficients for external contact; the defaults are the published ones (Eq 6)."""

    a: float = 0.39
    b: float = 0.85
    n: float = 1.094
    contact: ClassVar[Contact] = "external"

    def exponent(self, dR: FloatArray) -> FloatArray:
        """Return n, the same at every ΔR (Eq 6c)."""
        return as_floats(np.full_like(dR, self.n))


Coefficients = InternalCoefficients | ExternalCoefficients
PUBLISHED: Mapping[Contact, Coefficients] = {
    "internal": InternalCoefficients(),
    "external": ExternalCoefficients(),
}
# The range of clearances in mm over which the published coefficients were fitted.
PUBLISHED_DR: Mapping[Contact, tuple[float, float]] = {
    "internal": (0.05, 10.0),
    "external": (5.0, 500.0),
}


def stiffness_factor(dR: ArrayLike, a: ArrayLike, b: ArrayLike) -> FloatArray:
    """Return K* = aΔR + b, the geometric part of the factor (Eqs 4–5)."""
    return as_floats(as_floats(a) * as_floats(dR) + as_floats(b))


def internal_Y(
    dR: ArrayLike,
    Y_log_scale: ArrayLike,
    Y_log_exponent: ArrayLike,
    Y_slope: ArrayLike,
    Y_offset: ArrayLike,
) -> FloatArray:
    """Return Y at ΔR in mm (Eq 6d), as the larger of its two branches.

    The published branches cross at the published switch point, 0.34954 mm, and the larger one
    applies on either side. The maximum is therefore equivalent, and the switch point follows
    the coefficients.

    Examples
    --------
    >>> Y = internal_Y([0.05, 1.0], 1.51, -0.151, 0.0151, 1.151)
    >>> print(Y.round(4))
    [1.2289 1.1661]
    """
    gap = as_floats(dR)
    logarithmic = as_floats(Y_log_scale) * np.log(1000 * gap) ** as_floats(Y_log_exponent)
    linear = as_floats(Y_slope) * gap + as_floats(Y_offset)
    return as_floats(np.maximum(logarithmic, linear))


def internal_exponent(
    dR: ArrayLike,
    Y_log_scale: ArrayLike,
    Y_log_exponent: ArrayLike,
    Y_slope: ArrayLike,
    Y_offset: ArrayLike,
    n_exponent: ArrayLike,
) -> FloatArray:
    """Return n = Y·ΔR^n_exponent for internal contact (Eq 6c)."""
    Y = internal_Y(dR, Y_log_scale, Y_log_exponent, Y_slope, Y_offset)
    return as_floats(Y * as_floats(dR) ** as_floats(n_exponent))


def coefficients_from(values: Mapping[str, float]) -> Coefficients:
    """Return coefficients from their values; the names decide between internal and external.

    Raises
    ------
    InputError
        If the names are not exactly those of one contact, or a value is not a finite number.
    """
    for name, value in values.items():
        require(
            isinstance(value, Real) and np.isfinite(value),
            "Enhanced",
            name,
            value,
            "a coefficient must be a finite number",
            "give the value that a fit or the paper gives",
        )
    for kind in (InternalCoefficients, ExternalCoefficients):
        if set(values) == {field.name for field in fields(kind)}:
            return kind(**values)
    internal, external = (", ".join(asdict(kind)) for kind in PUBLISHED.values())
    raise InputError(
        "Enhanced",
        "coefficients",
        sorted(values),
        "the names must be those of one contact",
        f"internal: {internal}; external: {external}",
    )


@dataclass(frozen=True)
class Enhanced(PowerShaped):
    """The enhanced law (Pereira, Ramalho and Ambrósio 2015), Eqs 5–6, without dissipation factor.

    Parameters
    ----------
    coefficients : InternalCoefficients, ExternalCoefficients or mapping, optional
        By default the published coefficients for the contact of the pair. The names in a mapping
        of values (such as `FitResult.coefficients`) decide which contact it is for; the law then
        refuses pairs of the other contact.

    Notes
    -----
    The law holds in mm, N and MPa only: its coefficients are not dimensionless. It is NaN for
    internal contact outside 0.005 ≤ ΔR < 10 mm, and where aΔR + b or n is not positive, which
    only happens with other coefficients than the published ones.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.from_dR("internal", dR=0.05, material=steel)
    >>> print(f"{Enhanced().penetration(100.0, pair) * 1e3:.4f} µm")
    1.5144 µm
    """

    coefficients: Coefficients | Mapping[str, float] | None = None
    name: ClassVar[str] = "enhanced"
    units: ClassVar[Mapping[str, str]] = {"a": "mm^(1-n)", "b": "mm^(2-n)", "Y_slope": "1/mm"}

    def __post_init__(self) -> None:
        if isinstance(self.coefficients, Mapping):
            object.__setattr__(self, "coefficients", coefficients_from(self.coefficients))

    def _repr_html_(self) -> str:
        return completed_law_html(self, PUBLISHED)

    def factor_and_exponent(self, pair: CylinderPair) -> tuple[FloatArray, FloatArray]:
        """Return K = (aΔR + b)·E*/ΔR in N/mm per mmⁿ and n (Eq 6c).

        Both are NaN where the law is undefined; a NaN in n alone would not do, as 1ⁿ is then 1.
        """
        chosen, dR = self._coefficients_for(pair), as_floats(pair.dR)
        inside = _in_range(dR, pair.contact)
        K_star = stiffness_factor(dR, chosen.a, chosen.b)
        n = chosen.exponent(np.where(inside, dR, 1.0))
        defined = inside & (K_star > 0) & (n > 0)
        return inside_or_nan(K_star * pair.E_star / dR, defined), inside_or_nan(n, defined)

    def _coefficients_for(self, pair: CylinderPair) -> Coefficients:
        """Return the coefficients; raise `InputError` if they are for the other contact."""
        if self.coefficients is None:
            pair.require_plane_strain("Enhanced")
            return PUBLISHED[pair.contact]
        chosen = cast(Coefficients, self.coefficients)  # __post_init__ leaves no mapping
        if chosen.contact != pair.contact:
            raise InputError(
                "Enhanced",
                "coefficients",
                None,
                f"they are for {chosen.contact} contact and the pair is {pair.contact}",
                "use coefficients fitted for the pair's contact",
            )
        return chosen


def _in_range(dR: FloatArray, contact: Contact) -> BoolArray:
    """Return where ΔR is in the range of Eq 6 for the contact."""
    if contact == "internal":
        return np.asarray((dR >= INTERNAL_DR_MIN) & (dR < INTERNAL_DR_MAX))
    return np.asarray(dR > 0)


_EXTERNAL_STEPS = """
K_geometry = a * dR + b
factor = K_geometry * E_star / dR if K_geometry > 0 and n > 0 else nan"""
_INTERNAL_STEPS = f"""
Y_log = Y_log_scale * log(1000 * dR) ** Y_log_exponent
Y = max(Y_log, Y_slope * dR + Y_offset)
n = Y * dR ** n_exponent{_EXTERNAL_STEPS}"""


def _formula(law: Enhanced, contact: Contact | None) -> Formula:
    """Return the formula for export, with the published coefficients of the contact by default."""
    chosen = _exported_coefficients(law, contact)
    numbers = {name: float(value) for name, value in asdict(chosen).items()}
    is_internal = chosen.contact == "internal"
    exponent = (
        " with n = Y*dR^n_exponent and "
        "Y = max(Y_log_scale*ln(1000*dR)^Y_log_exponent, Y_slope*dR + Y_offset)"
    )
    return Formula(
        name=function_name(law.name, chosen.contact),
        law=law,
        contact=chosen.contact,
        equation=f"f = (a*dR + b)*E_star/dR*penetration^n{exponent if is_internal else ''}",
        text=(_INTERNAL_STEPS if is_internal else _EXTERNAL_STEPS) + KERNEL.steps,
        coefficients=numbers,
        constants=numbers,
        conditions=(f"dR >= {INTERNAL_DR_MIN}", f"dR < {INTERNAL_DR_MAX}") if is_internal else (),
        domain="a*dR + b > 0, n > 0",
        remark=IN_MM,
        origin="published, Pereira, Ramalho and Ambrosio 2015" if law.coefficients is None else "",
    )


def _exported_coefficients(law: Enhanced, contact: Contact | None) -> Coefficients:
    """Return the coefficients of a law; raise `InputError` if they are for the other contact."""
    if law.coefficients is None:
        return PUBLISHED[required_contact(contact, law.name)]
    chosen = cast(Coefficients, law.coefficients)
    if contact not in (None, chosen.contact):
        raise InputError(
            "export",
            "--contact",
            contact,
            f"the coefficients are for {chosen.contact} contact",
            "leave it out",
        )
    return chosen


def _internal_form(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return K* and n of Eqs 5–6 for internal contact."""
    a, b, *rest = candidates.T[:, :, None]
    return stiffness_factor(dR, a, b), internal_exponent(dR, *rest)


def _external_form(candidates: FloatArray, dR: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return K* and n of Eqs 5–6 for external contact."""
    a, b, n = candidates.T[:, :, None]
    return stiffness_factor(dR, a, b), as_floats(n + np.zeros_like(dR))


def _smooth_internal_form(
    candidates: FloatArray, dR: FloatArray, smooth: float
) -> tuple[FloatArray, ...]:
    """Return K*, n and their derivatives, with Y = ½(Y₁ + Y₂ + √((Y₁ − Y₂)² + ε²))."""
    a, b, scale, exponent, slope, offset, n_exponent = candidates.T[:, :, None]
    power, reach = np.log(1000 * dR) ** exponent, dR**n_exponent
    first, second = scale * power, slope * dR + offset
    gap = np.hypot(first - second, smooth)
    share = 0.5 + 0.5 * np.divide(first - second, gap, out=np.zeros_like(gap), where=gap > 0)
    n = 0.5 * (first + second + gap) * reach
    logarithmic, linear = share * reach, (1 - share) * reach
    K_slopes, n_slopes = np.zeros((2, *candidates.shape, dR.size))
    K_slopes[:, 0], K_slopes[:, 1] = dR, 1.0
    n_slopes[:, 2] = logarithmic * power
    n_slopes[:, 3] = logarithmic * first * np.log(np.log(1000 * dR))
    n_slopes[:, 4], n_slopes[:, 5], n_slopes[:, 6] = linear * dR, linear, n * np.log(dR)
    return stiffness_factor(dR, a, b), n, K_slopes, n_slopes


def _fitted(values: Values) -> ContactLaw:
    """Return the law with these coefficients."""
    return Enhanced(coefficients=values)


_PARAMETERS: Mapping[Contact, tuple[Parameter, ...]] = {
    "internal": (
        Parameter("a", 0.1, 1.5, unit="mm^(1-n)", meaning="slope of K* over ΔR"),
        Parameter("b", 0.0, 0.5, unit="mm^(2-n)", meaning="K* at ΔR = 0"),
        Parameter("Y_log_scale", 1.0, 3.0, meaning="factor of the logarithmic branch of Y"),
        Parameter("Y_log_exponent", -0.6, 0.0, shift=True, meaning="exponent of ln(1000·ΔR)"),
        Parameter("Y_slope", -0.1, 0.1, shift=True, unit="1/mm", meaning="slope of Y over ΔR"),
        Parameter("Y_offset", 0.8, 1.6, shift=True, meaning="Y of the linear branch at ΔR = 0"),
        Parameter("n_exponent", -0.1, 0.1, shift=True, meaning="exponent of ΔR in n"),
    ),
    "external": (
        Parameter("a", 0.1, 1.5, unit="mm^(1-n)", meaning="slope of K* over ΔR"),
        Parameter("b", 0.0, 3.0, unit="mm^(2-n)", meaning="K* at ΔR = 0"),
        Parameter("n", 1.0, 1.5, meaning="exponent of the penetration"),
    ),
}


def _model(contact: Contact) -> LawModel:
    """Return the model of the law, with the published coefficients as nominal values."""
    is_internal, published = contact == "internal", PUBLISHED[contact]
    return LawModel(
        "enhanced",
        contact,
        tuple(replace(p, nominal=getattr(published, p.name)) for p in _PARAMETERS[contact]),
        _fitted,
        power_form=_internal_form if is_internal else _external_form,
        smooth_form=_smooth_internal_form if is_internal else None,
        on_grid=True,
        dR_min=INTERNAL_DR_MIN if is_internal else 0.0,
        dR_max=INTERNAL_DR_MAX if is_internal else math.inf,
    )


DEFINITION = Definition(
    law=Enhanced,
    formula=_formula,
    kernel=KERNEL,
    models=tuple(_model(contact) for contact in CONTACTS),
)
