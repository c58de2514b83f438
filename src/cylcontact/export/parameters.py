"""A joint's law as the parameters of the contact that a multibody code has of its own.

The normal force of each code is a formula of the penetration x, its rate v, and parameters. The
elastic ones are fitted to the law: the logarithm of the force is as close as can be by the root of
the mean square, over forces spaced evenly by their logarithm. The damping is matched: an impact of
a mass at a speed comes back with the joint's restitution.

Units are m, N, s and kg, except for the parameters of Adams, which are in mm.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
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
# Parameters of a contact by the code's own names.
Values = dict[str, Any]


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


class _Code(NamedTuple):
    """The contact of a code.

    `elastic` gives the parameters closest to a law without damping; `damped` is the one that the
    damping sets, and its value for a damping. `force` takes x ≥ 0, v, the mass and the speed of the
    impact, and the parameters.
    """

    title: str
    formula: str
    note: str
    address: str
    units: Mapping[str, str]  # of the parameters
    elastic: Callable[[_Curve], Values]
    force: Callable[..., Any]
    damped: tuple[str, Callable[[Values, float], Any]]

    def with_damping(self, values: Values, damping: float) -> Values:
        """Return parameters with a damping."""
        name, value = self.damped
        return {**values, name: value(values, damping)}


def _plain(_: Values, damping: float) -> float:
    return damping


def _step(share: FloatArray) -> FloatArray:
    """Return the cubic from 0 at 0 to 1 at 1, level there and beyond."""
    s = np.clip(share, 0.0, 1.0)
    return as_floats(s**2 * (3 - 2 * s))


def _fit_adams(curve: _Curve) -> Values:
    k, e = curve.power()
    return {"K": k * 1e-3**e, "e": e, "c_max": 0.0, "d_max": 1e3 * float(curve.x[0])}


def _adams(
    x: Any, v: Any, _mass: float, _speed: float, K: Any, e: Any, c_max: Any, d_max: Any
) -> Any:
    return np.maximum(K * (1e3 * x) ** e + c_max * _step(1e3 * x / d_max) * 1e3 * v, 0.0)


def _mujoco(x: Any, v: Any, mass: float, _speed: float, solref: Any, solimp: Any) -> Any:
    k, b, (d_0, d_width, width, midpoint, power) = -solref[0], -solref[1], solimp
    s = np.clip(x / width, 0.0, 1.0)
    below = s**power / midpoint ** (power - 1)
    above = 1 - (1 - s) ** power / (1 - midpoint) ** (power - 1)
    part = (d_0 + (d_width - d_0) * np.where(s <= midpoint, below, above)) / d_width
    return np.maximum(mass * (k * x * part**2 + b * v * part), 0.0)


def _fit_mujoco(curve: _Curve) -> Values:
    """Fit the stiffness, and d_0, width and power of the impedance.

    At the smallest midpoint the impedance rises most at first touch, as the stiffness does.
    """
    d_width = 1e-3

    def solimp(p: FloatArray) -> tuple[float, ...]:
        part, ln_width, power = map(float, p)
        return part * d_width, d_width, float(np.exp(ln_width)), 1e-4, power

    def ratio(p: FloatArray) -> FloatArray:
        force = _mujoco(curve.x, 0.0, curve.mass, 0.0, (-1.0, 0.0), solimp(p))
        return as_floats(np.log(curve.force / force))

    def misses(p: FloatArray) -> FloatArray:
        return as_floats(ratio(p) - ratio(p).mean())

    ln_x = float(np.log(curve.x[-1]))
    bounds = ([0.1, ln_x - 3, 1.0], [1.0, ln_x + 3, 8.0])
    best = least_squares(misses, (0.7, ln_x, 2.0), bounds=bounds).x
    return {"solref": (-float(np.exp(ratio(best).mean())), 0.0), "solimp": solimp(best)}


def _fit_exudyn(curve: _Curve) -> Values:
    k, n = curve.power()
    return {
        "contactStiffness": k, "contactStiffnessExponent": n, "restitutionCoefficient": 1.0,
        "minimumImpactVelocity": 1e-3 * IMPACT_RATE_FLOOR, "impactModel": 2,
    }  # fmt: skip


def _exudyn(
    x: Any, v: Any, _mass: float, speed: float, contactStiffness: float,
    contactStiffnessExponent: float, restitutionCoefficient: float, minimumImpactVelocity: float,
    impactModel: int,  # noqa: ARG001
) -> Any:  # fmt: skip
    e, onset = restitutionCoefficient, max(speed, minimumImpactVelocity)
    factor = 1.5 * (1 - e) * (11 - e) / (1 + 9 * e) if e > 1 / 3 else (1 - e) * (1 + e) / e
    return contactStiffness * x**contactStiffnessExponent * (1 + factor * v / onset)


def _exudyn_restitution(_: Values, factor: float) -> float:
    """Return the restitution of a hysteresis factor, by the formula of the code."""
    if factor < 8 / 3:
        half = 9 + 4.5 * factor
        return float((half - np.sqrt(half**2 - 1.5 * (16.5 - factor))) / 1.5)
    return float((np.sqrt(factor**2 + 4) - factor) / 2)


_CODES: Mapping[str, _Code] = {
    "adams": _Code(
        "Adams, IMPACT",
        "F = max(0, K x^e + STEP(x, 0, 0, d_max, c_max) v)",
        "In mm, N, s; full damping from the penetration of the smallest force on.",
        "https://adams.thisaray.com/adams_solver/state_contact.html",
        {"K": "N/mm^e", "e": "", "c_max": "N s/mm", "d_max": "mm"},
        _fit_adams, _adams, ("c_max", _plain),
    ),
    "chrono": _Code(
        "Chrono SMC, Hooke",
        "F = max(0, kn x + m gn v), m the effective mass that Chrono computes",
        "SetContactForceModel(Hooke), UseMaterialProperties(false), both materials alike.",
        "https://api.projectchrono.org/classchrono_1_1_ch_system_s_m_c.html",
        {"kn": "N/m", "gn": "1/s"},
        lambda curve: {"kn": curve.linear(), "gn": 0.0},
        lambda x, v, mass, _, kn, gn: np.maximum(kn * x + mass * gn * v, 0.0),
        ("gn", _plain),
    ),
    "drake": _Code(
        "Drake, compliant point contact",
        "F = k x max(0, 1 + d v), k half of each geometry's, d the same",
        "Give both geometries these; the approximation kSap has no such dissipation.",
        "https://drake.mit.edu/doxygen_cxx/group__compliant__contact.html",
        {"point_contact_stiffness": "N/m", "hunt_crossley_dissipation": "s/m"},
        lambda curve: {
            "point_contact_stiffness": 2 * curve.linear(), "hunt_crossley_dissipation": 0.0,
        },
        lambda x, v, _mass, _speed, point_contact_stiffness, hunt_crossley_dissipation: (
            point_contact_stiffness / 2 * x * np.maximum(1 + hunt_crossley_dissipation * v, 0.0)
        ),
        ("hunt_crossley_dissipation", _plain),
    ),
    "mujoco": _Code(
        "MuJoCo, solref in its direct form",
        "F = max(0, m (k x (d(x)/d_width)^2 + b v d(x)/d_width)), solref = -k -b",
        "solref holds for this effective mass m; d_width of other forces is added to F.",
        "https://mujoco.readthedocs.io/en/stable/modeling.html#solver-parameters",
        {"solref": "(1/s^2, 1/s)", "solimp": "(-, -, m, -, -)"},
        _fit_mujoco, _mujoco, ("solref", lambda values, b: (values["solref"][0], 0.0 - b)),
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
        _fit_exudyn, _exudyn, ("restitutionCoefficient", _exudyn_restitution),
    ),
    "simscape": _Code(
        "Simscape Multibody, Spatial Contact Force",
        "F = max(0, s(x/w) (k x + b v)), s rising from 0 to 1 over the width w",
        "w ends where the range begins; the page leaves s open, taken as a cubic here.",
        "https://www.mathworks.com/help/sm/ref/spatialcontactforce.html",
        {"stiffness": "N/m", "damping": "N s/m", "transition_region_width": "m"},
        lambda curve: {
            "stiffness": curve.linear(), "damping": 0.0,
            "transition_region_width": float(curve.x[0]),
        },
        lambda x, v, _mass, _speed, stiffness, damping, transition_region_width: np.maximum(
            _step(x / transition_region_width) * (stiffness * x + damping * v), 0.0
        ),
        ("damping", _plain),
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
        """Return the code's normal force in N at a penetration in m and a rate in m/s."""
        x, v = as_floats(penetration), as_floats(rate)
        force = self._contact.force(np.maximum(x, 0.0), v, self.mass, self.speed, **self.values)
        return as_floats(np.where(x > 0, force, 0.0))

    def __str__(self) -> str:
        """Return a line for each parameter, then the errors and the restitution."""
        numbers = {name: np.ravel(value).tolist() for name, value in self.values.items()}
        lines = [
            f"{name} = {' '.join(f'{x:.6g}' for x in of)} {self._contact.units[name]}".rstrip()
            for name, of in numbers.items()
        ]
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
        If the code is unknown, the range is empty or exceeds the domain of the law, or mass or
        speed are not positive.

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
    curve, own = _curve(joint, low, high, mass), _CODES[code]
    if speed is None:
        load = np.sqrt(low * high) / joint.pair.contact_length("the export")
        deepest = float(joint.law.penetration(load, joint.pair))
        energy = stored_energy(1e-3 * deepest, joint.record("stop"), joint.kernel.parameters)
        speed = float(f"{np.sqrt(2 * energy / mass):.3g}")
    values = _matched(own, own.elastic(curve), joint.chi, curve, speed)
    force, above, below = (
        own.force(x, 0.0, mass, speed, **values)
        for x in (curve.x, curve.x * (1 + 1e-5), curve.x * (1 - 1e-5))
    )
    restitution = (_restitution(own, values, curve, by * speed) for by in (1, 0.5, 2))
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


def _matched(code: _Code, values: Values, chi: float, curve: _Curve, speed: float) -> Values:
    """Return parameters with the damping that gives the restitution of a hysteresis factor."""
    if chi == 0 or code.damped[1] is _exudyn_restitution:
        return code.with_damping(values, chi)
    wanted = float(achieved_restitution(chi))

    def excess(damping: float) -> float:
        return _restitution(code, code.with_damping(values, damping), curve, speed) - wanted

    # First the damping that doubles the force in the middle of the range.
    x = np.sqrt(curve.x[0] * curve.x[-1])
    elastic, more = (
        float(code.force(x, speed, curve.mass, speed, **code.with_damping(values, c)))
        for c in (0.0, 1.0)
    )
    most = elastic / (more - elastic)
    while excess(most) > 0:
        most *= 2
    return code.with_damping(values, float(brentq(excess, 0.0, most, xtol=1e-9 * most)))


def _restitution(code: _Code, values: Values, curve: _Curve, speed: float) -> float:
    """Return the coefficient of restitution of an impact at a speed."""

    def motion(_time: float, state: FloatArray) -> tuple[float, float]:
        x, v = state
        return v, -float(
            code.force(np.maximum(x, 0.0), v, curve.mass, speed, **values)
        ) / curve.mass

    def apart(_time: float, state: FloatArray) -> float:
        return float(state[0])

    apart.terminal, apart.direction = True, -1.0  # type: ignore[attr-defined]
    # That of a mass on a spring; no step may pass over the end of the force, or over a transition.
    time = float(np.sqrt(curve.mass / curve.linear()))
    run = solve_ivp(
        motion, (0.0, 1e9 * time), (0.0, speed), method="LSODA", events=apart,
        rtol=1e-10, atol=1e-12 * speed * np.array([time, 1.0]), max_step=0.005 * time,
    )  # fmt: skip
    return float(-run.y[1, -1] / speed)
