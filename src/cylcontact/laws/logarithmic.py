"""Johnson's law, and the common form of the logarithmic laws.

Every logarithmic law of cylindrical contact has the form

    δ = A·f·[ln(Λ·E*/f) + c],    A = κ/(π·E*),

and differs from the others only in κ, c and the reach Λ (mm), a length that depends on the radii.
The largest load is f_max = Λ·E*·exp(c − 1); beyond it the penetration would decrease with the
load. In q = f/f_max and p = δ/δ_max, with δ_max = A·f_max, all of them are the single curve
p = q(1 − ln q), with the inverse q = p/(1 + w) and w from Lambert's function.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.arrays import FloatArray, as_floats, inside_or_nan
from cylcontact.html_repr import law_html
from cylcontact.laws.adapters import ScaledLaw
from cylcontact.laws.contact_law import ContactLaw, OverLength, depth_of
from cylcontact.laws.definition import Coefficients, Definition, KernelSteps, LawModel, Parameter
from cylcontact.laws.formula import Formula, function_name
from cylcontact.laws.lambert import START, branch_distance, to_load_fraction
from cylcontact.pair import CONTACTS, Contact, CylinderPair

__all__ = [
    "DEFINITION",
    "Johnson",
    "LogarithmicLaw",
    "adjusted_logarithmic",
    "definition_of",
    "logarithmic_formula",
]


@dataclass(frozen=True)
class LogarithmicLaw(OverLength):
    """The common form δ = κ/(π·E*)·f·[ln(Λ·E*/f) + c]; a law supplies κ, c and Λ.

    Attributes
    ----------
    name : str
        The law's name.
    kappa, shift : float
        κ and c.
    reach_formula : str
        Λ for exports, in the notation of `laws.formula.Formula`.
    any_plane : bool
        Whether it also holds in plane stress, with the E* of that.
    needs : tuple of str
        What Λ needs to know of a pair besides ΔR.
    """

    name: ClassVar[str]
    kappa: ClassVar[float] = 1.0
    shift: ClassVar[float]
    reach_formula: ClassVar[str] = "4 * pi * dR"
    any_plane: ClassVar[bool] = False
    needs: ClassVar[tuple[str, ...]] = ()
    _repr_html_ = law_html

    def reach(self, pair: CylinderPair) -> FloatArray:
        """Return Λ in mm, 4π·ΔR unless the law has another."""
        return as_floats(4 * np.pi * as_floats(pair.dR))

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm; NaN outside [0, max_load]."""
        q = _fraction(load, self.max_load(pair))
        inside = (q >= 0) & (q <= 1)
        p = q * (1 - np.log(np.where(inside & (q > 0), q, 1.0)))
        return inside_or_nan(self.max_penetration(pair) * p, inside)

    def load(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the load in N/mm at `penetration` in mm; NaN beyond max_penetration."""
        f = to_load_fraction(_fraction(penetration, self.max_penetration(pair)))
        f *= self.max_load(pair)
        return f

    def stiffness(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return d(load)/d(penetration) in N/mm²; infinite at max_penetration."""
        w = branch_distance(_fraction(depth_of(penetration), self.max_penetration(pair)))
        with np.errstate(divide="ignore"):
            return as_floats(1 / (self._compliance(pair) * w))

    def max_load(self, pair: CylinderPair) -> FloatArray:
        """Return the largest load in N/mm, Λ·E*·exp(c − 1)."""
        if not self.any_plane:
            pair.require_plane_strain(type(self).__name__)
        return as_floats(self.reach(pair) * pair.E_star * np.exp(self.shift - 1))

    def max_penetration(self, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm at the largest load."""
        return as_floats(self._compliance(pair) * self.max_load(pair))

    def _compliance(self, pair: CylinderPair) -> FloatArray:
        """Return A = κ/(π·E*) in mm²/N."""
        return as_floats(self.kappa / (np.pi * pair.E_star))


def _fraction(values: ArrayLike, limit: FloatArray) -> FloatArray:
    """Return `values` in units of `limit`; inf (outside the domain) where that overflows."""
    with np.errstate(over="ignore"):
        return as_floats(as_floats(values) / limit)


class Johnson(LogarithmicLaw):
    """Johnson's law, Eq 1: f = π·E*·δ/[ln(4π·E*·ΔR/f) − 1] per unit length.

    The paper solves it for the load by iteration. `load` evaluates the exact inverse,
    f = π·E*·δ/(−W₋₁(−e·δ/(4ΔR))). The domain ends at f = 4π·E*·ΔR/e² (Eq 8), δ = 4ΔR/e².

    For bodies of different materials the reach is
    Λ = 4π·R_i^(2w_i)·R_j^(2w_j)/R with w_k = E*(1 − ν_k²)/E_k (each body's own half-plane
    compression, Johnson's Contact Mechanics, Sect. 5.6). As w_i + w_j = 1 and R = R_i·R_j/ΔR,
    that is Λ = 4π·ΔR·(R_i/R_j)^(w_i − w_j), and equal materials give Λ = 4π·ΔR. In plane stress
    E takes the place of E/(1 − ν²); the derivation is the same.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.from_dR("internal", dR=0.05, material=steel)
    >>> law = Johnson()
    >>> delta = law.penetration(100.0, pair)
    >>> print(f"{delta * 1e3:.5f} µm, {law.load(delta, pair):.10f} N/mm")
    1.55935 µm, 100.0000000000 N/mm
    """

    name = "johnson"
    shift = -1.0
    any_plane = True

    def reach(self, pair: CylinderPair) -> FloatArray:
        """Return Λ in mm: 4π·ΔR for equal materials, else 4π·ΔR·(R_i/R_j)^(w_i − w_j)."""
        modulus_i, modulus_j = pair.moduli
        if np.all(modulus_i == modulus_j):
            return super().reach(pair)
        R_i, R_j = pair.radii("Johnson's law for different materials")
        w_i, w_j = pair.E_star / modulus_i, pair.E_star / modulus_j
        return as_floats(4 * np.pi * as_floats(pair.dR) * (R_i / R_j) ** (w_i - w_j))


def adjusted_logarithmic(
    base: LogarithmicLaw, kappa: float, c: float, Lambda_factor: float = 1.0
) -> ScaledLaw:
    """Return δ = κ/(π·E*)·f·[ln(F·Λ·E*/f) + c] with the Λ of a logarithmic law.

    With B = F·exp(c − c₀) it is (κ·B/κ₀)·δ₀(f/B), a scaled form of the law δ₀ with κ₀, c₀ and Λ.
    F and c act only through ln F + c.

    Parameters
    ----------
    base : LogarithmicLaw
        The law that supplies Λ.
    kappa, c : float
        κ, positive, and c.
    Lambda_factor : float
        F, positive.

    Returns
    -------
    ScaledLaw

    Raises
    ------
    InputError
        If κ or F is not positive.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material, laws
    >>> pair = CylinderPair.from_dR("internal", 0.05, Material("steel", E=207e3, nu=0.3))
    >>> law = adjusted_logarithmic(laws.Johnson(), kappa=1.0, c=2 / 3)
    >>> print(law.penetration(100.0, pair) / laws.Radzimovsky().penetration(100.0, pair))
    1.0
    """
    load_factor = Lambda_factor * float(np.exp(c - base.shift))
    return ScaledLaw(base, load_factor, kappa * load_factor / base.kappa)


# Lambert's W as in laws/lambert.py, with the penetration in units of the largest one. At the ends,
# p = 0 and p = 1, the regular branch would divide by zero; there and beyond it computes p = 0.5.
_STEPS = """
p = penetration / deepest
inner = 0.5 if p <= 0 or p >= 1 else p
g = -log(inner)
r = sqrt(g)
u = 1 + r * ({} + r * ({} + {} * r)) / (1 + {} * r)
start = u - 1
t = (start - log(u) - g) / (start * start)
w = 0 if p >= 1 else start - t * start * u * (1 + t * (0.5 + t * (0.5 + start / 3)))
f = f_max * (p / (1 + w)) if p <= 1 else nan
slope = f_max / (deepest * w) if p <= 1 else nan
k = 0 if p <= 0 else slope
energy = f * (penetration / 2 - deepest / 4 * (f / f_max))
""".format(*START)


def _numbers(law: LogarithmicLaw, pair: CylinderPair) -> tuple[float, float]:
    """Return the largest load and penetration."""
    return float(law.max_load(pair)), float(law.max_penetration(pair))


def logarithmic_formula(
    law: LogarithmicLaw, contact: Contact | None, scaled: ScaledLaw | None = None
) -> Formula:
    """Return the formula of a logarithmic law for export, or of a scaled one.

    Parameters
    ----------
    law : LogarithmicLaw
        The law that supplies Λ.
    contact : {"internal", "external"} or None
        The contact.
    scaled : ScaledLaw, optional
        The law with other κ and c; see `adjusted_logarithmic`.

    Returns
    -------
    Formula
    """
    kappa, shift, origin = float(law.kappa), float(law.shift), "the law's own"
    if scaled is not None:
        B, D = scaled.load_factor, scaled.penetration_factor
        kappa, shift, origin = float(law.kappa * D / B), law.shift + float(np.log(B)), ""
    reach = law.reach_formula
    return Formula(
        name=function_name(law.name),
        law=scaled or law,
        contact=contact,
        equation=(
            "penetration = kappa/(pi*E_star)*f*(ln(Lambda*E_star/f) + c) solved for f, with "
            f"Lambda = {reach.replace(' * ', '*').replace(' / ', '/')}"
        ),
        text=(
            f"f_max = ({reach}) * E_star * peak\ndeepest = kappa / (pi * E_star) * f_max{_STEPS}"
        ),
        coefficients={"kappa": kappa, "c": shift},
        constants={"kappa": kappa, "peak": float(np.exp(shift - 1))},
        extra=law.needs,
        domain=(
            "penetration <= kappa/pi*Lambda*peak, with peak = exp(c - 1), where the load is "
            "Lambda*E_star*peak and the stiffness infinite"
        ),
        remark=(
            "For bodies of equal elastic constants. f = f_max*p/(1 + w) with p the penetration in "
            "units of the largest and w = -1 - W(-p/e), W the lower branch of Lambert's function: "
            "a start in closed form and one step of fourth order, no iteration."
        ),
        origin=origin,
    )


_KERNEL = KernelSteps(("f_max", "deepest"), _numbers, _STEPS)


def definition_of(law: type[LogarithmicLaw]) -> Definition:
    """Return the definition of a logarithmic law.

    It is fitted by κ, c and a factor of Λ, which is fixed by default, because it is redundant
    with c.
    """
    base = law()

    def build(values: Coefficients) -> ContactLaw:
        return adjusted_logarithmic(base, **values)

    parameters = (
        Parameter("kappa", 0.2, 5.0, float(law.kappa), stiffness=True, meaning="factor of δ"),
        Parameter(
            "c", -5.0, 5.0, float(law.shift), shift=True, meaning="term beside the logarithm"
        ),
        Parameter("Lambda_factor", 1e-3, 1e3, nominal=1.0, value=1.0, meaning="factor of Λ"),
    )
    return Definition(
        law=law,
        formula=logarithmic_formula,
        kernel=_KERNEL,
        models=tuple(LawModel(law.name, contact, parameters, build) for contact in CONTACTS),
        needs=law.needs,
    )


DEFINITION = definition_of(Johnson)
