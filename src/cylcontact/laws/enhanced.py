"""The enhanced law of Pereira, Ramalho and Ambrósio, Eqs 5–6: f = (aΔR + b)·E*/ΔR·δⁿ."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

from numpy import inf, log, nan

from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.laws.formula import Formula, choose
from cylcontact.laws.law import Constants, constant
from cylcontact.laws.power import IN_MM, Numbers, PowerShaped, power_formula
from cylcontact.support.errors import InputError

# E* in MPa of steel on steel, E = 207 GPa and ν = 0.3, and a load in N/mm: for the size of a jump.
_E_STAR, _LOAD = 207e3 / (2 * (1 - 0.3**2)), 100.0
# A smaller jump is not worth a note: the published branches meet to 1e-8.
_LEAST_JUMP = 1e-4
# Eq 6d defines Y for internal contact on [0.005, 10[ mm.
INTERNAL_DR_MIN = 0.005
INTERNAL_DR_MAX = 10.0


@dataclass(frozen=True)
class InternalCoefficients(Constants):
    """Coefficients for internal contact; the defaults are the published ones (Eq 6)."""

    a: float = constant(0.1, 1.5, "slope of K* over ΔR", 0.965, unit="mm^(1-n)")
    b: float = constant(0.0, 0.5, "K* at ΔR = 0", 0.0965, unit="mm^(2-n)")
    Y_log_scale: float = constant(1.0, 3.0, "factor of the logarithmic branch of Y", 1.51)
    Y_log_exponent: float = constant(-0.6, 0.0, "exponent of ln(1000·ΔR)", -0.151)
    Y_slope: float = constant(-0.1, 0.1, "slope of Y over ΔR", 0.0151, unit="1/mm")
    Y_offset: float = constant(0.8, 1.6, "Y of the linear branch at ΔR = 0", 1.151)
    n_exponent: float = constant(-0.1, 0.1, "exponent of ΔR in n", -0.005)
    Y_switch: float = constant(
        INTERNAL_DR_MIN, INTERNAL_DR_MAX, "ΔR from which Y is linear", 0.34954, unit="mm"
    )
    contact: ClassVar[Contact] = "internal"
    law = "Enhanced"

    @property
    def jump(self) -> float:
        """The relative change of the penetration at Y_switch, of steel under 100 N/mm."""
        values = asdict(self)
        first = {**values, "Y_switch": inf}  # the logarithmic branch everywhere
        (K1, n1), (K2, n2) = (internal(_E_STAR, self.Y_switch, **each) for each in (first, values))
        return float((_LOAD / K2) ** (1 / n2) / (_LOAD / K1) ** (1 / n1) - 1)


@dataclass(frozen=True)
class ExternalCoefficients(Constants):
    """Coefficients for external contact; the defaults are the published ones (Eq 6)."""

    a: float = constant(0.1, 1.5, "slope of K* over ΔR", 0.39, unit="mm^(1-n)")
    b: float = constant(0.0, 3.0, "K* at ΔR = 0", 0.85, unit="mm^(2-n)")
    n: float = constant(1.0, 1.5, "exponent of the penetration", 1.094)
    contact: ClassVar[Contact] = "external"
    law = "Enhanced"


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


def internal_exponent(
    dR, Y_log_scale, Y_log_exponent, Y_slope, Y_offset, n_exponent, Y_switch
) -> float:
    """Return n = Y·ΔR^n_exponent (Eq 6c), with Y at ΔR in mm by Eq 6d.

    The published branches of Y meet at the switch, 0.34954 mm. Those of other coefficients may
    leave a jump there.
    """
    logarithmic = Y_log_scale * log(1000 * dR) ** Y_log_exponent
    Y = choose(dR < Y_switch, logarithmic, Y_slope * dR + Y_offset)
    return Y * dR**n_exponent


def internal(
    E_star, dR, a, b, Y_log_scale, Y_log_exponent, Y_slope, Y_offset, n_exponent, Y_switch
) -> Numbers:
    """Return K = (a·ΔR + b)·E*/ΔR and n of Eq 6 for internal contact."""
    n = internal_exponent(dR, Y_log_scale, Y_log_exponent, Y_slope, Y_offset, n_exponent, Y_switch)
    K_star = a * dR + b
    in_range = (dR >= INTERNAL_DR_MIN) & (dR < INTERNAL_DR_MAX)
    return Numbers(choose(in_range & (K_star > 0) & (n > 0), K_star * E_star / dR, nan), n)


def external(E_star, dR, a, b, n) -> Numbers:
    """Return K = (a·ΔR + b)·E*/ΔR and n of Eq 6 for external contact."""
    K_star = a * dR + b
    return Numbers(choose((K_star > 0) & (n > 0), K_star * E_star / dR, nan), n)


_EQUATION = "f = (a*dR + b)*E_star/dR*penetration^n"
_WITH_Y = (
    f"{_EQUATION} with n = Y*dR^n_exponent; "
    "Y = Y_log_scale*ln(1000*dR)^Y_log_exponent for dR < Y_switch, else Y_slope*dR + Y_offset"
)
_FORMULAS: Mapping[Contact, Formula] = {
    "internal": power_formula(internal, _WITH_Y, IN_MM),
    "external": power_formula(external, _EQUATION, IN_MM),
}


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
    formula: ClassVar[Formula] = _FORMULAS["internal"]
    defaults: ClassVar[Mapping[Contact, Any]] = PUBLISHED
    origin: ClassVar[str] = "published, Pereira, Ramalho and Ambrosio 2015"

    def formula_for(self, contact: Contact) -> Formula:
        """Return Eqs 5 and 6 for a contact."""
        return _FORMULAS[contact]

    @classmethod
    def _coefficients_from(cls, values: Mapping[str, float]) -> Coefficients:
        """Return coefficients from their values; the names decide between the contacts."""
        for published in PUBLISHED.values():
            if set(values) == set(asdict(published)):
                return type(published)(**values)
        internal, external = (", ".join(asdict(kind)) for kind in PUBLISHED.values())
        rule, remedy = "the names must be those of one contact", f"internal: {internal}"
        names = sorted(values)
        raise InputError("Enhanced", "coefficients", names, rule, f"{remedy}; external: {external}")

    @property
    def jumps(self) -> tuple[float, ...]:
        """The clearance in mm at which the branches of Y of fitted coefficients may not meet."""
        own = self.coefficients
        return (own.Y_switch,) if isinstance(own, InternalCoefficients) else ()

    @property
    def note(self) -> str:
        """The jump between the branches of Y, if they do not meet."""
        own = self.coefficients
        if not isinstance(own, InternalCoefficients) or abs(own.jump) < _LEAST_JUMP:
            return ""
        return (
            f"the branches of Y do not meet at dR = {own.Y_switch:g} mm: from there on the "
            f"penetration of steel under {_LOAD:g} N/mm is {abs(100 * own.jump):.1f} % "
            f"{'larger' if own.jump > 0 else 'smaller'}"
        )

    def require_pair(self, pair: CylinderPair) -> None:
        """Raise `InputError` if the coefficients are not for the pair."""
        own = getattr(self.coefficients, "contact", None)
        if own is None:
            pair.require_plane_strain("Enhanced")
        elif own != pair.contact:
            rule = f"they are for {own} contact and the pair is {pair.contact}"
            remedy = "use coefficients fitted for the pair's contact"
            raise InputError("Enhanced", "coefficients", None, rule, remedy)
