"""A joint's law as the parameters of the contact that a multibody code has of its own.

The normal force of each code is a formula of the penetration x, its rate v, and parameters. The
elastic ones are fitted to the law: the logarithm of the force is as close as can be by the root of
the mean square, over forces spaced evenly by their logarithm. The damping is matched: an impact of
a mass at a speed comes back with the joint's restitution.

Units are m, N, s and kg, but for the parameters of Adams, which are in mm.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, least_squares

from cylcontact.impact import IMPACT_RATE_FLOOR, achieved_restitution
from cylcontact.joint.clearance import ClearanceJoint
from cylcontact.joint.contact import stored_energy
from cylcontact.support.arrays import FloatArray, as_floats, require
from cylcontact.support.choices import CODES, listed

# The forces of a fit.
_FORCES = 200


class _Impact(NamedTuple):
    """An impact: effective mass in kg, and speed in m/s."""

    mass: float
    speed: float


class _Curve(NamedTuple):
    """A law over a range: penetration in m, force in N, stiffness in N/m; an effective mass."""

    x: FloatArray
    force: FloatArray
    stiffness: FloatArray
    mass: float

    def power(self) -> tuple[float, float]:
        """Return k and n of the force k·x^n that is closest."""
        n, ln_k = np.polyfit(np.log(self.x), np.log(self.force), 1)
        return float(np.exp(ln_k)), float(n)

    def linear(self) -> float:
        """Return k of the force k·x that is closest."""
        return float(np.exp(np.mean(np.log(self.force / self.x))))


# --- the codes ---

# Parameters of a contact by the code's own names.
Values = dict[str, Any]


class _Code(NamedTuple):
    """The contact of a code.

    `elastic` gives the parameters closest to a law, with the one named `damping` at none. `force`
    takes x ≥ 0 in m, v in m/s, an impact and the parameters.
    """

    title: str
    formula: str
    note: str
    address: str
    units: Mapping[str, str]  # of the parameters
    damping: str
    elastic: Callable[[_Curve], Values]
    force: Callable[..., Any]

    def damped(self, values: Values, by: float) -> Values:
        """Return parameters with a damping; that of Exudyn is a hysteresis factor."""
        damping: Any = by
        if self.damping == "solref":
            damping = (values["solref"][0], 0.0 - by)
        elif self.damping == "restitutionCoefficient":
            damping = 1.0
            if by != 0:
                miss = partial(_miss_exudyn, by)
                damping = float(brentq(miss, 1e-12, 1.0, xtol=1e-14))
        return {**values, self.damping: damping}


def _step(share: FloatArray) -> FloatArray:
    """Return the cubic from 0 at 0 to 1 at 1, level there and beyond."""
    s = np.clip(share, 0.0, 1.0)
    return as_floats(s**2 * (3 - 2 * s))


def _fit_adams(curve: _Curve) -> Values:
    k, e = curve.power()
    return {"K": k * 1e-3**e, "e": e, "c_max": 0.0, "d_max": 1e3 * float(curve.x[0])}


def _adams(x: Any, v: Any, _: _Impact, K: float, e: float, c_max: float, d_max: float) -> Any:
    depth, rate = 1e3 * x, 1e3 * v
    return np.maximum(K * depth**e + c_max * _step(depth / d_max) * rate, 0.0)


def _mujoco(
    x: Any, v: Any, impact: _Impact, solref: Sequence[float], solimp: Sequence[float]
) -> Any:
    k, b, (d_0, d_width, width, midpoint, power) = -solref[0], -solref[1], solimp
    s = np.clip(x / width, 0.0, 1.0)
    below = s**power / midpoint ** (power - 1)
    above = 1 - (1 - s) ** power / (1 - midpoint) ** (power - 1)
    part = (d_0 + (d_width - d_0) * np.where(s <= midpoint, below, above)) / d_width
    return np.maximum(impact.mass * (k * x * part**2 + b * v * part), 0.0)


def _fit_mujoco(curve: _Curve) -> Values:
    """Fit the stiffness, and d_0, width and power of the impedance.

    At the smallest midpoint the impedance rises most at first touch, as the stiffness does.
    """
    d_width, still, mass = 1e-3, np.zeros_like(curve.x), _Impact(curve.mass, 0.0)

    def solimp(p: FloatArray) -> tuple[float, ...]:
        part, ln_width, power = map(float, p)
        return part * d_width, d_width, float(np.exp(ln_width)), 1e-4, power

    def ratio(p: FloatArray) -> FloatArray:
        return as_floats(
            np.log(curve.force / _mujoco(curve.x, still, mass, (-1.0, 0.0), solimp(p)))
        )

    def misses(p: FloatArray) -> FloatArray:
        return as_floats(ratio(p) - ratio(p).mean())

    ln_x = float(np.log(curve.x[-1]))
    bounds = ([0.1, ln_x - 3, 1.0], [1.0, ln_x + 3, 8.0])
    best = least_squares(misses, (0.7, ln_x, 2.0), bounds=bounds).x
    return {"solref": (-float(np.exp(ratio(best).mean())), 0.0), "solimp": solimp(best)}


def _fit_exudyn(curve: _Curve) -> Values:
    stiffness, exponent = curve.power()
    return {
        "contactStiffness": stiffness, "contactStiffnessExponent": exponent,
        "restitutionCoefficient": 1.0, "minimumImpactVelocity": 1e-3 * IMPACT_RATE_FLOOR,
        "impactModel": 2,
    }  # fmt: skip


def _miss_exudyn(factor: float, e: float) -> float:
    return _exudyn_factor(e) - factor


def _exudyn_factor(e: float) -> float:
    return 1.5 * (1 - e) * (11 - e) / (1 + 9 * e) if e > 1 / 3 else (1 - e) * (1 + e) / e


def _exudyn(
    x: Any, v: Any, impact: _Impact, contactStiffness: float, contactStiffnessExponent: float,
    restitutionCoefficient: float, minimumImpactVelocity: float, **_others: int,
) -> Any:  # fmt: skip
    onset = max(impact.speed, minimumImpactVelocity)
    factor = _exudyn_factor(restitutionCoefficient)
    return contactStiffness * x**contactStiffnessExponent * (1 + factor * v / onset)


_CODES: Mapping[str, _Code] = {
    "adams": _Code(
        "Adams, IMPACT",
        "F = max(0, K x^e + STEP(x, 0, 0, d_max, c_max) v)",
        "In mm, N, s; full damping from the penetration of the smallest force on.",
        "https://adams.thisaray.com/adams_solver/state_contact.html",
        {"K": "N/mm^e", "e": "", "c_max": "N s/mm", "d_max": "mm"},
        "c_max", _fit_adams, _adams,
    ),
    "chrono": _Code(
        "Chrono SMC, Hooke",
        "F = max(0, kn x + m gn v), m the effective mass that Chrono computes",
        "SetContactForceModel(Hooke), UseMaterialProperties(false), both materials alike.",
        "https://api.projectchrono.org/classchrono_1_1_ch_system_s_m_c.html",
        {"kn": "N/m", "gn": "1/s"},
        "gn", lambda curve: {"kn": curve.linear(), "gn": 0.0},
        lambda x, v, impact, kn, gn: np.maximum(kn * x + impact.mass * gn * v, 0.0),
    ),
    "drake": _Code(
        "Drake, compliant point contact",
        "F = k x max(0, 1 + d v), k half of each geometry's, d the same",
        "Give both geometries these; the approximation kSap has no such dissipation.",
        "https://drake.mit.edu/doxygen_cxx/group__compliant__contact.html",
        {"point_contact_stiffness": "N/m", "hunt_crossley_dissipation": "s/m"},
        "hunt_crossley_dissipation",
        lambda curve: {
            "point_contact_stiffness": 2 * curve.linear(), "hunt_crossley_dissipation": 0.0,
        },
        lambda x, v, _, point_contact_stiffness, hunt_crossley_dissipation: (
            point_contact_stiffness / 2 * x * np.maximum(1 + hunt_crossley_dissipation * v, 0.0)
        ),
    ),
    "mujoco": _Code(
        "MuJoCo, solref in its direct form",
        "F = max(0, m (k x (d(x)/d_width)^2 + b v d(x)/d_width)), solref = -k -b",
        "solref holds for this effective mass m; d_width of other forces is added to F.",
        "https://mujoco.readthedocs.io/en/stable/modeling.html#solver-parameters",
        {"solref": "(1/s^2, 1/s)", "solimp": "(-, -, m, -, -)"},
        "solref", _fit_mujoco, _mujoco,
    ),
    "exudyn": _Code(
        "Exudyn, ObjectContactSphereSphere",
        "F = k x^n (1 + c v/v_0), v_0 the rate at first touch, at least the minimum; c = "
        "3/2 (1 - e)(11 - e)/(1 + 9 e) for e > 1/3, (1 - e^2)/e below",
        "isHollowSphere1 = True; markers and radii of pin and hole in this order.",
        "https://exudyn.readthedocs.io/en/latest/docs/RST/items/ObjectContactSphereSphere.html",
        {
            "contactStiffness": "N/m^n", "contactStiffnessExponent": "",
            "restitutionCoefficient": "", "minimumImpactVelocity": "m/s", "impactModel": "",
        },
        "restitutionCoefficient", _fit_exudyn, _exudyn,
    ),
    "simscape": _Code(
        "Simscape Multibody, Spatial Contact Force",
        "F = max(0, s(x/w) (k x + b v)), s rising from 0 to 1 over the width w",
        "w ends where the range begins; the page leaves s open, taken as a cubic here.",
        "https://www.mathworks.com/help/sm/ref/spatialcontactforce.html",
        {"stiffness": "N/m", "damping": "N s/m", "transition_region_width": "m"},
        "damping",
        lambda curve: {
            "stiffness": curve.linear(), "damping": 0.0,
            "transition_region_width": float(curve.x[0]),
        },
        lambda x, v, _, stiffness, damping, transition_region_width: np.maximum(
            _step(x / transition_region_width) * (stiffness * x + damping * v), 0.0
        ),
    ),
}  # fmt: skip


# --- a joint's parameters ---


@dataclass(frozen=True)
class ContactParameters:
    """Parameters of a multibody code's own contact, and how close it then is to a joint's law.

    Attributes
    ----------
    values : dict
        The parameters, numbers or tuples of them, by the names that the code has for them.
    low, high : float
        The total forces in N between which they were fitted.
    mass, speed : float
        The effective mass in kg and the speed in m/s at which the damping was matched.
    restitution : tuple of float
        The coefficients of restitution of the code at this speed, at half and at twice it.
    force_error, stiffness_error : pair of float
        The largest and the root-mean-square error over the range, as parts of the law's.
    """

    values: dict[str, Any]
    low: float
    high: float
    mass: float
    speed: float
    restitution: tuple[float, ...]
    force_error: tuple[float, float]
    stiffness_error: tuple[float, float]
    _contact: _Code

    def force(self, penetration: ArrayLike, rate: ArrayLike = 0.0) -> FloatArray:
        """Return the code's own normal force in N, for the mass and in an impact of the speed.

        Parameters
        ----------
        penetration : array_like
            In m; 0 or less is no contact.
        rate : array_like, optional
            Its rate in m/s.

        Returns
        -------
        array of float
        """
        x, impact = as_floats(penetration), _Impact(self.mass, self.speed)
        force = self._contact.force(np.maximum(x, 0.0), as_floats(rate), impact, **self.values)
        return as_floats(np.where(x > 0, force, 0.0))

    def __str__(self) -> str:
        """Return a line for each parameter, then the errors and the restitution."""
        lines = []
        for name, value in self.values.items():
            numbers = value if isinstance(value, tuple) else (value,)
            text = " ".join(f"{number:.6g}" for number in numbers)
            lines.append(f"{name} = {text} {self._contact.units[name]}".rstrip())
        force, stiffness = (
            f"within {100 * largest:.2g} % (root mean square {100 * rms:.2g} %)"
            for largest, rms in (self.force_error, self.stiffness_error)
        )
        at, half, twice = self.restitution
        return "\n".join([
            *lines,
            "",
            f"From {self.low:g} to {self.high:g} N: force {force}, stiffness {stiffness}.",
            f"Restitution {at:.3f} at {self.speed:g} m/s of {self.mass:g} kg, {half:.3f} at half "
            f"and {twice:.3f} at twice this speed.",
            f"{self._contact.title}: {self._contact.formula}.",
            self._contact.note,
            self._contact.address,
        ])  # fmt: skip


def contact_parameters(
    joint: ClearanceJoint,
    code: str,
    low: float,
    high: float,
    mass: float = 1.0,
    speed: float | None = None,
) -> ContactParameters:
    """Return the parameters with which a multibody code's own contact follows a joint's law.

    Parameters
    ----------
    joint : ClearanceJoint
        The joint, of any law.
    code : {"adams", "chrono", "drake", "mujoco", "exudyn", "simscape"}
        The code.
    low, high : float
        The range of the total force in N.
    mass : float, optional
        The effective mass of the impact in kg: m_1·m_2/(m_1 + m_2), or that of the pin if the
        bearing is fixed.
    speed : float, optional
        The speed of the impact in m/s; by default one whose force rises, without losses, to the
        geometric mean of the range.

    Returns
    -------
    ContactParameters

    Raises
    ------
    InputError
        If the code is unknown, the range is none or exceeds the law, or mass or speed are not
        positive.

    Notes
    -----
    The joint's restitution is the one that its hysteresis factor achieves, at every speed.

    Examples
    --------
    >>> from cylcontact.mechanism import read_joint
    >>> parameters = contact_parameters(read_joint("datasets/joint.toml"), "adams", 100, 5000)
    >>> print(*str(parameters).splitlines()[:2])
    K = 1.92827e+06 N/mm^e e = 1.22033
    """
    require(code in CODES, "export", "--to", code, "is not known", f"choose {listed(CODES)}")
    for key, number in (("--mass", mass), ("--speed", 1.0 if speed is None else speed)):
        require(0 < number < np.inf, "export", key, number, "must be positive", "give kg and m/s")
    curve = _curve(joint, low, high, mass)
    if speed is None:
        length = joint.pair.contact_length("the export")
        deepest = float(joint.law.penetration(np.sqrt(low * high) / length, joint.pair))
        block, parameters = joint.record("stop"), joint.kernel.parameters
        energy = stored_energy(1e-3 * deepest, block, parameters)
        speed = float(f"{np.sqrt(2 * energy / mass):.3g}")
    impact, own = _Impact(mass, speed), _CODES[code]
    values = _damped(own, own.elastic(curve), joint.chi, curve, impact)
    force, above, below = (
        own.force(x, np.zeros_like(x), impact, **values)
        for x in (curve.x, curve.x * (1 + 1e-5), curve.x * (1 - 1e-5))
    )
    restitution = (
        _restitution(own, values, curve, _Impact(mass, factor * speed)) for factor in (1, 0.5, 2)
    )
    return ContactParameters(
        values, low, high, mass, speed, tuple(restitution), _error(force / curve.force),
        _error((above - below) / (2e-5 * curve.x) / curve.stiffness), own,
    )  # fmt: skip


def _error(ratio: FloatArray) -> tuple[float, float]:
    """Return the largest and the root-mean-square difference from 1."""
    return float(np.abs(ratio - 1).max()), float(np.sqrt(np.mean((ratio - 1) ** 2)))


def _curve(joint: ClearanceJoint, low: float, high: float, mass: float) -> _Curve:
    """Return the law over the range, evenly by the logarithm of the force."""
    pair, length = joint.pair, joint.pair.contact_length("the export")
    most, text = float(joint.law.max_load(pair)) * length, f"{low:g}:{high:g}"
    rule, remedy = "is no range of force", "give the smaller one first, both above 0 N"
    require(0 < low < high < np.inf, "export", "--range", text, rule, remedy)
    rule = f"goes beyond the law '{joint.law.name}', which ends at {most:.4g} N"
    remedy = "end it before, or choose a law without an end, such as explicit"
    require(high < most, "export", "--range", text, rule, remedy)
    force = np.geomspace(low, high, _FORCES)
    x = joint.law.penetration(force / length, pair)
    return _Curve(1e-3 * x, force, 1e3 * length * joint.law.stiffness(x, pair), mass)


def _damped(code: _Code, values: Values, chi: float, curve: _Curve, impact: _Impact) -> Values:
    """Return parameters with the damping that gives the restitution of a hysteresis factor."""
    if chi == 0 or code.damping == "restitutionCoefficient":
        return code.damped(values, chi)
    wanted = float(achieved_restitution(chi))

    def excess(damping: float) -> float:
        return _restitution(code, code.damped(values, damping), curve, impact) - wanted

    # First the damping that doubles the force in the middle of the range.
    x, v = np.sqrt(curve.x[0] * curve.x[-1]), as_floats(impact.speed)
    elastic, more = (float(code.force(x, v, impact, **code.damped(values, c))) for c in (0.0, 1.0))
    most = elastic / (more - elastic)
    while excess(most) > 0:
        most *= 2
    return code.damped(values, float(brentq(excess, 0.0, most, xtol=1e-9 * most)))


def _restitution(code: _Code, values: Values, curve: _Curve, impact: _Impact) -> float:
    """Return the coefficient of restitution of an impact."""
    mass, speed = impact

    def motion(_time: float, state: FloatArray) -> tuple[float, float]:
        x, v = state
        return v, -float(code.force(np.maximum(x, 0.0), v, impact, **values)) / mass

    def apart(_time: float, state: FloatArray) -> float:
        return float(state[0])

    apart.terminal, apart.direction = True, -1.0  # type: ignore[attr-defined]
    # That of a mass on a spring; no step may pass over the end of the force, or over a transition.
    time = float(np.sqrt(mass / curve.linear()))
    run = solve_ivp(
        motion, (0.0, 1e9 * time), (0.0, speed), method="LSODA", events=apart,
        rtol=1e-10, atol=1e-12 * speed * np.array([time, 1.0]), max_step=0.005 * time,
    )  # fmt: skip
    return float(-run.y[1, -1] / speed)
