"""The law of Lankarani and Nikravesh, Eq 2: a point contact used for cylinders."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from numpy import isfinite, sqrt

from cylcontact.arrays import require
from cylcontact.laws.adapters import ScaledLaw
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.laws.definition import Parameter
from cylcontact.laws.formula import Formula
from cylcontact.laws.power import PowerShaped, end, energy, load


def form(pair, n):
    """Return K = (4/3)·E*·√R/L and n."""
    return 4 / 3 * pair.E_star * sqrt(pair.R) / pair.length, n


_EQUATION = "f = 4/3*E_star*sqrt(R_i*R_j/dR)/length*penetration^n"
_REMARK = (
    "The law gives the total force f*length of a point contact, independent of the length; "
    "f is that force per unit length."
)


@dataclass(frozen=True)
class LankaraniNikravesh(PowerShaped):
    """Lankarani and Nikravesh (1990), elastic part of Eq 2: F = (4/3)·E*·√R·δⁿ, R = R_i·R_j/ΔR.

    Parameters
    ----------
    n : float
        Exponent, positive; 1.5 for metals.

    Raises
    ------
    InputError
        If the exponent is not positive; when the law is evaluated, if the radii or the length of
        the pair are not known.

    Notes
    -----
    F is the *total* force of a point contact, in N; it does not depend on the axial length. The
    load per unit length is F/L, so the pair needs a length. The paper prints R_i·R_i where
    R_i·R_j is meant.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.5, material=steel, length=10.0)
    >>> print(f"{LankaraniNikravesh().load(1e-3, pair):.3f} N/mm")
    6.610 N/mm
    """

    n: float = 1.5
    name: ClassVar[str] = "lankarani-nikravesh"
    formula = Formula(load, form, end, energy, equation=_EQUATION, remark=_REMARK)
    any_plane = False
    needs = ("R_i", "R_j", "length")
    parameters = (
        Parameter("factor", 1e-2, 1e2, 1.0, stiffness=True, meaning="factor of the law's load"),
        Parameter("n", 0.8, 2.0, nominal=1.5, meaning="exponent of the penetration"),
    )

    def __post_init__(self) -> None:
        require(
            self.n > 0 and isfinite(self.n),
            "LankaraniNikravesh",
            "n",
            self.n,
            "must be positive and finite",
            "metals have n = 1.5",
        )

    @classmethod
    def fitted(cls, values: Mapping[str, float]) -> ContactLaw:
        """Return the law with a factor and an exponent."""
        return ScaledLaw(cls(n=values["n"]), load_factor=values["factor"])
