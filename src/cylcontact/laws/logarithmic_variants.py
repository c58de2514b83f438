"""The logarithmic laws that differ from Johnson's in κ, Λ or c.

| law | κ | Λ | c |
|---|---|---|---|
| Johnson (1985) | 1 | 4π·ΔR | −1 |
| Roark and Young | 1 | 4π·ΔR | 2/3 − 2·ln 2 |
| Radzimovsky (1953), half-width | 1 | 4π·ΔR | 2/3 |
| Radzimovsky, 1.60 with radii | 1 | 4π·ΔR | 2/3 + ln(6.25/4π) |
| ESDU 78035 | 1 | 4π·ΔR | 1 |
| Dubowsky and Freudenstein (1971) | 1 | π·L²·ΔR/(R_i·R_j) | 1 |
| Goldsmith (1960) | 1 | π·R_i·R_j/ΔR | 1 |
| Hertz cylinder | 2 | π·ΔR | −1 |

The literature disagrees on several of them, so each class states which reading it takes. All are
derived for bodies of equal elastic constants; for other pairs they use the E* of the pair.
"""

from __future__ import annotations

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.laws.logarithmic import LogarithmicLaw, definition_of
from cylcontact.pair import CylinderPair

__all__ = [
    "DEFINITIONS",
    "DubowskyFreudenstein",
    "Esdu78035",
    "Goldsmith",
    "HertzCylinder",
    "Radzimovsky",
    "RadzimovskyRadii",
    "RoarkYoung",
]


class RoarkYoung(LogarithmicLaw):
    """Radzimovsky's formula with b the full contact width, as in Roark and Young's tables.

    δ = f/(π·E*)·[2/3 + ln(4R_i/b) + ln(4R_j/b)] with b = 4·√(f·R/(π·E*)). (The tables' factor
    1.60 belongs with diameters: 1.60·√2 = 2.26 = 4/√π with radii.)
    """

    name = "roark-young"
    shift = 2 / 3 - 2 * np.log(2)


class Radzimovsky(LogarithmicLaw):
    """Radzimovsky's formula (1953) with b Hertz's half-width.

    δ = f/(π·E*)·[2/3 + ln(4R_i/b) + ln(4R_j/b)] with b = 2·√(f·R/(π·E*)).
    """

    name = "radzimovsky"
    shift = 2 / 3


class RadzimovskyRadii(LogarithmicLaw):
    """Radzimovsky's formula with b = 1.60·√(f·R/E*), as multibody papers print it.

    The 1.60 of the tables is for diameters. With radii, b is neither the half-width nor the full
    width of Hertz. The law is included because comparisons in the literature use it.
    """

    name = "radzimovsky-radii"
    shift = 2 / 3 + float(np.log(16 / 1.6**2 / (4 * np.pi)))


class Esdu78035(LogarithmicLaw):
    """ESDU item 78035, δ = f/(π·E*)·[ln(4π·ΔR·E*/f) + 1].

    The compliance of each body is taken as (1 − ν²)/(π·E), without a further factor π. The
    original was not available, so the convention is unverified.
    """

    name = "esdu-78035"
    shift = 1.0


class DubowskyFreudenstein(LogarithmicLaw):
    """Dubowsky and Freudenstein (1971), δ = f/(π·E*)·[ln(π·E*·L²·ΔR/(f·R_i·R_j)) + 1].

    This is their L^m with m = 3 (total force F = f·L). It needs the radii and the axial length.
    """

    name = "dubowsky-freudenstein"
    shift = 1.0
    reach_formula = "pi * (length * length) / (R_i * R_j / dR)"
    needs = ("R_i", "R_j", "length")

    def reach(self, pair: CylinderPair) -> FloatArray:
        """Return π·L²/R in mm, with R = R_i·R_j/ΔR."""
        length = pair.contact_length("the law of Dubowsky and Freudenstein")
        return as_floats(np.pi * length**2 / pair.R)


class Goldsmith(LogarithmicLaw):
    """Goldsmith (1960) as printed in multibody papers, δ = f/(π·E*)·[ln(π·E*·R/f) + 1].

    The L^m of Dubowsky and Freudenstein with m = 1 is dimensionally inconsistent unless the length
    drops out. What remains is π times the effective radius R = R_i·R_j/ΔR as reach. With m = 3 the
    law is that of Dubowsky and Freudenstein. It needs the radii.
    """

    name = "goldsmith"
    shift = 1.0
    reach_formula = "pi * (R_i * R_j / dR)"
    needs = ("R_i", "R_j")

    def reach(self, pair: CylinderPair) -> FloatArray:
        """Return π·R_i·R_j/ΔR in mm."""
        return as_floats(np.pi * pair.R)


class HertzCylinder(LogarithmicLaw):
    """The law called Hertz's for cylinders in multibody papers, δ = 2f/(π·E*)·[ln(π·ΔR·E*/f) − 1].

    Hertz's theory of line contact gives no approach. This is a separate logarithmic law, about
    twice as compliant as Johnson's.
    """

    name = "hertz-cylinder"
    kappa = 2.0
    shift = -1.0
    reach_formula = "pi * dR"

    def reach(self, pair: CylinderPair) -> FloatArray:
        """Return π·ΔR in mm."""
        return as_floats(np.pi * as_floats(pair.dR))


DEFINITIONS = tuple(
    definition_of(law)
    for law in (
        RoarkYoung,
        Radzimovsky,
        RadzimovskyRadii,
        Esdu78035,
        DubowskyFreudenstein,
        Goldsmith,
        HertzCylinder,
    )
)
