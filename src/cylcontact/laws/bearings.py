"""Two laws of bearing practice for the total force of a steel roller on a raceway."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from cylcontact.arrays import require
from cylcontact.laws.formula import Formula
from cylcontact.laws.power import PowerShaped, end, energy, load
from cylcontact.pair import CylinderPair

# Moduli in MPa that count as steel.
_STEEL = 190e3, 220e3
_REMARK = (
    "For steel and a roller of the given length: the total force f*length does not depend on the "
    "radii or the moduli. Lengths in mm, forces in N."
)


def palmgren(pair):
    """Return K and n of δ = 3.84e-5·F^0.9/L^0.8, with f = F/L."""
    return (pair.length**0.8 / 3.84e-5) ** (1 / 0.9) / pair.length, 1 / 0.9


def iso_16281(pair):
    """Return K and n of F = c_L·(2δ)^(10/9), c_L = 35948·L^(8/9), with f = F/L."""
    return 35948 * pair.length ** (8 / 9) * 2 ** (10 / 9) / pair.length, 10 / 9


class OfSteel(PowerShaped):
    """A law for steel alone, which needs the length."""

    needs = ("length",)
    any_plane = False

    def require_pair(self, pair: CylinderPair) -> None:
        """Raise `InputError` for other materials than steel, or plane stress."""
        super().require_pair(pair)
        for body in (pair.material_i, pair.material_j):
            inside = (_STEEL[0] <= np.asarray(body.E)) & (np.asarray(body.E) <= _STEEL[1])
            rule = f"is no steel (E from {_STEEL[0] / 1e3:g} to {_STEEL[1] / 1e3:g} GPa)"
            remedy = "the law holds for steel only; use laws.Johnson() for other materials"
            require(inside, type(self).__name__, "material", body.name, rule, remedy)


@dataclass(frozen=True)
class Palmgren(OfSteel):
    """Palmgren's formula for a steel roller on one raceway, δ = 3.84e-5·F^0.9/L^0.8 (mm, N).

    F = f·L is the total force and L the length of the contact. Palmgren fitted it to tests of
    rollers (*Ball and Roller Bearing Engineering*, 3rd edition, SKF, 1959); bearing handbooks print
    it. Radii do not enter.

    Raises
    ------
    InputError
        When the law is evaluated, if a body is no steel or the length is not known.

    Examples
    --------
    A roller of 10 mm under 1 kN:

    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.external(R_i=5.0, R_j=20.0, material=steel, length=10.0)
    >>> print(f"{1e3 * Palmgren().penetration(100.0, pair):.3f} µm")
    3.050 µm
    """

    name: ClassVar[str] = "palmgren"
    equation = "penetration = 3.84e-5*F^0.9/length^0.8 with F = f*length"
    formula = Formula(load, palmgren, end, energy, equation, _REMARK)


@dataclass(frozen=True)
class Iso16281(OfSteel):
    """The roller stiffness of ISO/TS 16281, F = c_L·δ^(10/9) with c_L = 35948·L^(8/9) (mm, N).

    In the standard δ is the sum of the two contacts of a roller with the inner and the outer
    raceway, in series. Here, as for every law, δ is that of one contact, taken as half of the sum:
    F = c_L·(2δ)^(10/9). The deflection of both is `2 * law.penetration(load, pair)`.

    Raises
    ------
    InputError
        When the law is evaluated, if a body is no steel or the length is not known.

    Notes
    -----
    ISO/TS 16281:2008, *Rolling bearings: methods for calculating the modified reference rating life
    for universally loaded bearings*. The two contacts of a roller of 10 mm under 1 kN give way by
    6.3 µm, which is 2.07 times Palmgren's deflection of one.

    Examples
    --------
    >>> from cylcontact import CylinderPair, Material
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.external(R_i=5.0, R_j=20.0, material=steel, length=10.0)
    >>> print(f"{1e3 * 2 * Iso16281().penetration(100.0, pair):.3f} µm")
    6.308 µm
    """

    name: ClassVar[str] = "iso-16281"
    equation = "F = 35948*length^(8/9)*(2*penetration)^(10/9) with F = f*length"
    formula = Formula(load, iso_16281, end, energy, equation, _REMARK)
