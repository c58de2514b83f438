"""The fast law for a pin in a hole of any two materials: `Conformal` with eight constants.

`cylcontact.laws.arcs` has its functions of the arc. With K = 2Â − w_i·H and L = M − w_j·H + C, as
there, δ/ΔR = d is the root of d·K = L, and φ = π·d/L.

**No iteration to watch.** A start from two formulas, for small arcs and for the largest, is within
a factor of two of tan²(ε/2) for all pairs; four steps of Newton's method then reach the last
digits, for every penetration. The kernel and the exported function take the same steps.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

import numpy as np
from numpy import exp, log, maximum, nan, pi, where
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import Contact, CylinderPair
from cylcontact.laws.arcs import CALIBRATED, ParametricCoefficients, arc, first_arc, shares
from cylcontact.laws.conformal import Conformal, in_units_of
from cylcontact.laws.formula import Formula
from cylcontact.laws.housed import at_pair, curve_of, not_by_itself, table_of
from cylcontact.laws.housing import Housing
from cylcontact.laws.law import ENERGY_NODES, ENERGY_WEIGHTS, AtPair, Law
from cylcontact.support.arrays import FloatArray, as_floats, inside_or_nan

# About L − C + C_J for the largest arc, C_J being Johnson's datum, and the least start for L.
_LAST_L, _LEAST_L = 1.43, 0.1
# Numbers of a pair for its arcs, and where d is in single precision.
_OF_ARCS = ("w_i", "w_j", "beta", "datum", "A0", "A1", "A2", "A3", "H3", "M0", "M1", "M2")
_RANGE = 1e-30, 1e30


def start(d, datum, johnson, c0):
    """Return x = ln tan²(ε/2) from the formulas for small and the largest arcs."""
    L0 = maximum(datum - johnson + log(exp(_LAST_L) + 4 / d), _LEAST_L)
    return first_arc(L0 / d + c0 * c0 / (1 - c0))


def newton(x, d, w_i, w_j, beta, datum, A0, A1, A2, A3, H3, M0, M1, M2):
    """Return x and L after a step of Newton's method."""
    S, c, k, k_slope, L, L_slope, H, H_slope = arc(
        x, w_i, w_j, beta, datum, A0, A1, A2, A3, H3, M0, M1, M2
    )
    part = S / d
    step = (part * L - k) / (k_slope - part * (c * L + L_slope))
    return x + step, L + L_slope * step


def load(penetration, pair, C_0, C_alpha, A0, A1, A2, A3, H3, M0, M1, M2):
    """Return f and df/dδ, four steps of Newton from a start for small and the largest arcs."""
    w_i, w_j, c0 = shares(pair.alpha, pair.beta)
    datum = C_0 + C_alpha * pair.alpha
    johnson = 2 * log(2) - 2 + w_j
    d = penetration / pair.dR
    x = start(d, datum, johnson, c0)
    for _ in range(4):
        x, last = newton(x, d, w_i, w_j, pair.beta, datum, A0, A1, A2, A3, H3, M0, M1, M2)
    f = pi * pair.E_star * penetration / where(last > 0, last, nan)  # own constants may have none
    S, c, k, k_slope, L, L_slope, H, H_slope = arc(
        x, w_i, w_j, pair.beta, datum, A0, A1, A2, A3, H3, M0, M1, M2
    )
    fell = k_slope - c * k
    return f, pi * pair.E_star * fell / (L * fell - L_slope * k)


_PLAIN = Formula(load)


def load_in_arrays(penetration, **numbers):
    """Return f alone, at one pair with the first two steps in single precision: half as long."""
    d = penetration / numbers["dR"]
    single = np.ndim(d) and not any(np.ndim(number) for number in numbers.values())
    if not (single and d.size and _RANGE[0] < d.min() and d.max() < _RANGE[1]):
        return _PLAIN.load(penetration, **numbers)
    of_arcs = {name: numbers[name] for name in _OF_ARCS}
    rough, half = d.astype(np.float32), {name: np.float32(x) for name, x in of_arcs.items()}
    x = start(rough, numbers["datum"], numbers["johnson"], numbers["c0"]).astype(np.float32)
    for _ in range(2):
        x, last = newton(x, rough, **half)
    x = x.astype(np.float64)
    for _ in range(2):
        x, last = newton(x, d, **of_arcs)
    return pi * numbers["E_star"] * penetration / where(last > 0, last, nan)


_EQUATION = "f = pi*E_star*penetration/L with penetration/dR*K(S) = L(S), see the steps"
_REMARK = "The penetration is counted from C = C_0 + C_alpha*alpha; Johnson's datum by default."


@dataclass(frozen=True)
class Parametric(Law, Conformal):
    """A pin in a hole of any two materials, by eight constants: fast, and within 0.06 %.

    The law of `Conformal` with polynomials in place of its series: penetration, load and stiffness
    are elementary functions. Exact for β = 0, as for two bodies of one material. The contact angle
    and the largest pressure are those of `Conformal`.

    Parameters
    ----------
    datum : "johnson", float or Housing
        Where the penetration is counted from, as for `Conformal`. In a housing the law is a curve
        that is made once for a joint: from the polynomials with the housing's terms by Ritz's
        method, within about 1 % of `Conformal`, or from its series where these are not that close;
        it ends at a penetration of 1e6·ΔR.
    coefficients : ParametricCoefficients or mapping, optional
        By default the calibrated ones.

    Raises
    ------
    InputError
        As for `Conformal`.

    Notes
    -----
    For every α and β that two materials can have and 1e-6 ≤ φ ≤ 60, with Johnson's datum, the error
    against `Conformal` is below 0.06 % in penetration and load; `cylcontact figure fig_any_pair`
    maps it. Load and penetration invert each other to a few units in the last place, to fewer
    digits with a C next to the least that the pair allows.

    Examples
    --------
    A steel pin in an aluminium plate that is clamped at twenty times the hole's radius:

    >>> from cylcontact import CylinderPair, Material, laws
    >>> steel, aluminium = Material("steel", 207e3, 0.3), Material("aluminium", 70e3, 0.33)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.99, material=aluminium, material_j=steel)
    >>> clamped = laws.Housing(R_o=200.0)
    >>> fast, reference = Parametric(clamped), Conformal(clamped)
    >>> print(f"{fast.load(0.01, pair):.2f} N/mm, {reference.load(0.01, pair):.2f} N/mm")
    423.60 N/mm, 423.59 N/mm
    """

    coefficients: ParametricCoefficients | Mapping[str, float] | None = None
    name: ClassVar[str] = "parametric"

    formula = Formula(load, equation=_EQUATION, remark=_REMARK, in_arrays=load_in_arrays)
    contacts = ("internal",)
    defaults: ClassVar[Mapping[Contact, Any]] = {"internal": CALIBRATED}
    published = False
    on_grid = True
    dimensionless = True
    # Of `Conformal`, as the interface of `Law` comes first.
    require_pair = Conformal.require_pair

    def __post_init__(self) -> None:
        super().__post_init__()
        Conformal.__post_init__(self)

    @property
    def constants(self) -> ParametricCoefficients:
        """The coefficients, by default the calibrated ones."""
        return self.coefficients_for("internal")  # type: ignore[no-any-return]

    def constants_for(self, contact: Contact) -> dict[str, float]:
        """Return the constants, and C = C_0 + C_alpha·α of a datum that no pair changes."""
        if isinstance(self.datum, str):
            by_alpha = {"C_0": float(2 * log(2)) - 1.5, "C_alpha": 0.5}
        elif isinstance(self.datum, (int, float)):
            by_alpha = {"C_0": float(self.datum), "C_alpha": 0.0}
        else:
            raise not_by_itself(self.datum)
        return by_alpha | asdict(self.constants)

    def formula_at(self, pair: CylinderPair) -> Formula | None:
        """Return the formula; None in a housing, where the law is a curve of arcs."""
        return None if isinstance(self.datum, Housing) else self.formula

    def table(self, pair: CylinderPair) -> FloatArray:
        """Return ln f over ln δ in a housing, as compiled code takes it."""
        assert isinstance(self.datum, Housing)
        return table_of(curve_of(self.datum, pair, self.constants), pair)

    def at_pair(self, pair: CylinderPair) -> AtPair:
        """Return the law at a pair: in a housing the curve of one joint, the series of many."""
        if not isinstance(self.datum, Housing):
            return super().at_pair(pair)
        self.require_pair(pair)
        if not any(np.asarray(each).ndim for each in (pair.E_star, pair.dR, pair.R_i)):
            return at_pair(curve_of(self.datum, pair, self.constants), pair)
        end = as_floats(np.full_like(pair.E_star * as_floats(pair.dR), np.inf))
        load, stiffness = Conformal.load, Conformal.stiffness
        return AtPair(
            lambda depth: load(self, depth, pair),
            lambda depth: stiffness(self, depth, pair),
            end,
            is_single=False,
        )

    def constants_at(self, pair: CylinderPair) -> Mapping[str, Any]:
        """Return the constants, and C at a pair."""
        self.require_datum(pair)
        if isinstance(self.datum, str):
            return self.constants_for(pair.contact)
        own = asdict(self.constants)
        return {"C_0": self.constant(pair), "C_alpha": 0.0} | own

    def penetration(self, load: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return the penetration in mm under `load` in N/mm."""
        f = as_floats(load)
        if isinstance(self.datum, Housing):
            if self.at_pair(pair).is_single:
                return super().penetration(f, pair)
            return Conformal.penetration(self, f, pair)
        touching, phi = in_units_of(self.load_unit(pair), f)
        w_i, w_j, c0 = shares(pair.alpha, pair.beta)
        own = asdict(self.constants)
        K = pi / np.clip(phi, 1e-300, 1e300)
        with np.errstate(over="ignore", invalid="ignore"):  # own constants may have no root
            x = first_arc(K + c0 * c0 / (1 - c0))
            for _ in range(4):
                S, c, k, k_slope, L, L_slope, H, H_slope = arc(
                    x, w_i, w_j, pair.beta, self.constant(pair), **own
                )
                step = (S * K - k) / (k_slope - S * c * K)
                x = x + step
            L = L + L_slope * step
        return inside_or_nan(f / (pi * pair.E_star) * where(L > 0, L, nan), touching)

    def energy(self, penetration: ArrayLike, pair: CylinderPair) -> FloatArray:
        """Return ∫f dδ of its own load up to `penetration` in mm, per unit length in N."""
        delta = as_floats(penetration)
        nodes = zip(ENERGY_NODES, ENERGY_WEIGHTS, strict=True)
        return as_floats(delta * sum(weight * self.load(delta * x, pair) for x, weight in nodes))
