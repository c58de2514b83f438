"""Many clearance joints, each with its own numbers, evaluated in one compiled call."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.pair import CylinderPair
from cylcontact.impact import FACTORS, IMPACT_RATE_FLOOR, hysteresis_factor
from cylcontact.joint import contact
from cylcontact.joint.clearance import (
    MILLIMETRES,
    MOST_FRICTION,
    TANGENT_FROM,
    JointState,
    JointWrench,
    parts_of,
    rows_of,
)
from cylcontact.laws import Conformal, ContactLaw, Housing
from cylcontact.laws.kernels import CURVE, KINDS, kernel
from cylcontact.laws.law import has_formula
from cylcontact.limits import yield_load
from cylcontact.support.arrays import FloatArray, as_floats, require
from cylcontact.support.numba_cache import compiled

_SOURCE = "joints"
# The first numbers of a curve are those of one joint: dR, π·E*, the end of the law, and a length.
_OF_CURVE = 4
# A part of which w_j − w_i of joints that share a curve may differ.
_SAME = 1e-12


@dataclass(frozen=True, eq=False)
class ClearanceJoints:
    """Joints with clearance as arrays, of one law; `ClearanceJoint` is one of them.

    Attributes
    ----------
    law : ContactLaw
        A law of the package with a formula, or `laws.Conformal()` and `laws.Persson()` for joints
        that share a curve: their pairs have the same two materials, or each has one material.
    pair : CylinderPair
        Hole and pin of n joints, with a length; radii, moduli and Poisson's ratios may be arrays.
    restitution : array_like, shape () or (n,)
        Above 0 up to 1.
    friction : array_like, shape () or (n,)
        The friction coefficient, from 0 to 2.
    v0, v1 : array_like, shape () or (n,)
        The speeds of Eq 15 in mm/s.
    factor : str
        The hysteresis factor, one of `dissipation.FACTORS`.
    point_bearing, point_pin : array_like, shape (2,) or (n, 2)
        The centres of hole and pin in mm, from the reference points in the axes of the bodies.
    units : {"SI", "mm"}
        As in `ClearanceJoint`.

    Raises
    ------
    InputError
        If a number is outside its range, a pair outside the law's, or the joints have no curve in
        common.

    Examples
    --------
    Three clearances, the last one with two pins that are pressed in:

    >>> from cylcontact import CylinderPair, Material, laws
    >>> steel = Material("steel", E=207e3, nu=0.3)
    >>> pair = CylinderPair.internal(10.0, [9.99, 9.97, 9.95], steel, length=10.0)
    >>> joints = ClearanceJoints(laws.Conformal(), pair, restitution=[0.9, 0.8, 0.7])
    >>> pins = [[11e-6, 0, 0, 0, 0, 0], [51e-6, 0, 0, 0, 0, 0], [0, 51e-6, 0, 0, 0, 0]]
    >>> which = [0, 2, 2]
    >>> state = joints.accept(joints.start(3), [0.0] * 6, pins, of=which)
    >>> print(joints.evaluate(state, [0.0] * 6, pins, of=which).normal_force.round(1))
    [854.1 584.  584. ]
    """

    law: ContactLaw
    pair: CylinderPair
    restitution: ArrayLike = 0.9
    friction: ArrayLike = 0.0
    v0: ArrayLike = 0.0
    v1: ArrayLike = 1.0
    factor: str = "exact"
    point_bearing: ArrayLike = (0.0, 0.0)
    point_pin: ArrayLike = (0.0, 0.0)
    units: Literal["SI", "mm"] = "SI"
    _joints: Any = field(init=False, repr=False)
    # Numbers of the law of each joint, and those that all of them share.
    _heads: FloatArray = field(init=False, repr=False)
    _shared: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        require(self.units in MILLIMETRES, _SOURCE, "units", self.units, "is not known", '"SI"')
        rule, remedy = "is not known", f"choose {', '.join(FACTORS)}"
        require(self.factor in FACTORS, _SOURCE, "factor", self.factor, rule, remedy)
        shape = np.broadcast_shapes(np.shape(self.pair.dR), np.shape(self.pair.E_star))
        rule, remedy = "is not one row of joints", "give radii or moduli as arrays of shape (n,)"
        require(len(shape) == 1, _SOURCE, "pair", shape, rule, remedy)
        heads, shared, kind = self._numbers(shape[0])
        for name, value in (
            ("_heads", heads), ("_shared", shared), ("_joints", self._records(shape[0], kind)),
        ):  # fmt: skip
            object.__setattr__(self, name, value)

    def __len__(self) -> int:
        """Return the number of joints."""
        return len(self._joints)

    def _numbers(self, size: int) -> tuple[FloatArray, FloatArray, int]:
        """Return the numbers of the law of each joint, what all share, and the law's kind."""
        law: Any = self.law
        pair = self.pair
        if isinstance(law, Conformal):
            rule, remedy = "is in a housing, with a curve for each", "loop over ClearanceJoint"
            require(not isinstance(law.datum, Housing), _SOURCE, "law", law.datum, rule, remedy)
            alike = np.ptp(pair.alpha) <= _SAME and np.ptp(pair.beta) <= _SAME
            rule = "needs a curve for each pair of materials, and these joints have several"
            remedy = "make a ClearanceJoints for each pair of materials, or loop over them"
            require(alike, _SOURCE, "law", law.name, rule, remedy)
            pin, hole = _first(pair.material_j), _first(pair.material_i)
            first = CylinderPair.from_dR("internal", 1.0, pin=pin, hole=hole, plane=pair.plane)
            curve = kernel(law, first).parameters
            unit = curve[:_OF_CURVE].copy()
            unit[1] /= float(first.E_star)
            by = [pair.dR, pair.E_star, pair.dR, pair.dR]
            heads = [x * np.broadcast_to(y, size) for x, y in zip(unit, by, strict=True)]
            return np.ascontiguousarray(np.column_stack(heads)), curve[_OF_CURVE:], CURVE
        kind = KINDS.get(law.formula_for("internal").load) if has_formula(law) else None
        rule, remedy = "has no formula of the package", "loop over ClearanceJoint"
        require(kind is not None, _SOURCE, "law", law.name, rule, remedy)
        numbers = [np.broadcast_to(number, size) for number in law.numbers_at(pair)]
        return np.ascontiguousarray(np.column_stack(numbers), dtype=float), np.empty(0), kind or 0

    def _records(self, size: int, kind: int) -> Any:
        """Return the joints as compiled functions take them."""
        pair, e = self.pair, as_floats(self.restitution)
        friction, v0, v1 = (as_floats(x) for x in (self.friction, self.v0, self.v1))
        require((e > 0) & (e <= 1), _SOURCE, "restitution", e, "must lie in (0, 1]", "e.g. 0.9")
        good = (friction >= 0) & (friction <= MOST_FRICTION)
        require(good, _SOURCE, "friction", friction, "must be from 0 to 2", "give e.g. 0.1")
        good = (v0 >= 0) & (v1 > v0) & (v1 < np.inf)
        rule, remedy = "must be finite, with 0 ≤ v0 < v1", "give two speeds in mm/s"
        require(good, _SOURCE, "v0, v1", v1, rule, remedy)
        last = np.broadcast_to(as_floats(self.law.max_penetration(pair)), size)
        rule = f"are undefined by the {self.law.name} law"
        require(last > 0, _SOURCE, "pair", last, rule, "choose another law")
        ends = np.isfinite(last)
        last = np.where(ends, TANGENT_FROM * last, np.inf)
        R_i, R_j = pair.radii(_SOURCE)
        length, unit = pair.contact_length(_SOURCE), MILLIMETRES[self.units]
        joints = np.zeros(size, contact.JOINT)
        joints["branch"] = joints["regime"] = contact.ANY
        joints["kernel"], joints["chi"] = kind, hysteresis_factor(self.factor)(e)
        joints["friction"], joints["v0"], joints["v1"] = friction, 1e-3 * v0, 1e-3 * v1
        joints["impact_rate"] = joints["rate_floor"] = IMPACT_RATE_FLOOR * 1e-3
        joints["clearance"], joints["length"] = 1e-3 * as_floats(pair.dR), length
        joints["R_bearing"], joints["R_pin"] = 1e-3 * as_floats(R_i), 1e-3 * as_floats(R_j)
        joints["metres"], joints["stop_penetration"] = 1e-3 * unit, np.inf
        joints["last_penetration"] = last
        if ends.any():
            depth = np.where(ends, last, 0.0)
            joints["last_load"] = self.law.load(depth, pair)
            joints["last_slope"] = np.where(ends, self.law.stiffness(depth, pair), 0.0)
        known = all(m.yield_stress is not None for m in (pair.material_i, pair.material_j))
        joints["first_yield"] = yield_load(pair) * length if known else np.inf
        for body, point in (("i", self.point_bearing), ("j", self.point_pin)):
            centre = 1e-3 * as_floats(point)
            joints[f"x_{body}"], joints[f"y_{body}"] = centre[..., 0], centre[..., 1]
        return joints

    def start(self, rows: int | None = None) -> JointState:
        """Return states without contact, one for each joint or as many as `rows`."""
        return JointState(np.zeros(len(self) if rows is None else rows))

    def evaluate(
        self, state: JointState, bearing: ArrayLike, pin: ArrayLike, of: ArrayLike | None = None
    ) -> JointWrench:
        """Return the wrenches; the states stay as they are.

        Parameters
        ----------
        state : JointState
            Impact rates of shape (rows,).
        bearing, pin : array_like, shape (6,) or (rows, 6)
            As for `ClearanceJoint.evaluate`.
        of : array_like of int, shape (rows,), optional
            The number of the joint of each row, from 0. By default there is a row for each joint.

        Returns
        -------
        JointWrench
            As of `ClearanceJoint.evaluate`, with a row for each row.

        Raises
        ------
        InputError
            If there is not one joint for each row, or no joint of a number.
        """
        states, bearings, pins, which = self._rows(state, bearing, pin, of)
        wrench = np.zeros(len(states), contact.WRENCH)
        law = np.concatenate([np.zeros(self._heads.shape[1]), self._shared])
        _evaluate_many(states, bearings, pins, wrench, self._joints, self._heads, law, which)
        return JointWrench(**parts_of(wrench, (len(states),)))

    def accept(
        self, state: JointState, bearing: ArrayLike, pin: ArrayLike, of: ArrayLike | None = None
    ) -> JointState:
        """Return the states after an accepted step; see `evaluate` for the arguments."""
        states, bearings, pins, which = self._rows(state, bearing, pin, of)
        _accept_many(states, bearings, pins, self._joints, which)
        return JointState(states["impact_rate"].copy())

    def _rows(
        self, state: JointState, bearing: ArrayLike, pin: ArrayLike, of: ArrayLike | None
    ) -> tuple[Any, FloatArray, FloatArray, Any]:
        """Return states, bodies and numbers of joints, one to a row."""
        rates, bearings, pins, shape = rows_of(
            as_floats(state.impact_rate)[..., None], bearing, pin, 6
        )
        which = np.arange(len(self)) if of is None else np.asarray(of)
        rule, remedy = f"is not one joint for each of {len(rates)} rows", "give `of`, one a row"
        good = len(shape) == 1 and which.shape == shape and which.dtype.kind in "iu"
        require(good, _SOURCE, "of", which.shape, rule, remedy)
        inside = (which >= 0) & (which < len(self))
        require(inside, _SOURCE, "of", which, f"must be from 0 to {len(self) - 1}", "count from 0")
        return rates.view(contact.STATE)[:, 0], bearings, pins, which.astype(np.intp)


def _first(material: Any) -> Any:
    """Return a material of single numbers: the first of arrays."""
    from cylcontact.bodies.material import material_in_MPa

    E, nu = (float(np.ravel(x)[0]) for x in (material.E, material.nu))
    return material_in_MPa(material.name, E=E, nu=nu)


@compiled
def _evaluate_many(
    states: Any, bearing: FloatArray, pin: FloatArray, wrench: Any, joints: Any,
    heads: FloatArray, law: FloatArray, of: Any,
) -> None:  # fmt: skip
    """Write the wrench of each row; the numbers of a law begin with those of its joint."""
    for k in range(len(states)):
        for place in range(heads.shape[1]):
            law[place] = heads[of[k], place]
        contact.evaluate(states[k], bearing[k], pin[k], wrench[k], joints[of[k]], law)


@compiled
def _accept_many(states: Any, bearing: FloatArray, pin: FloatArray, joints: Any, of: Any) -> None:
    """Update the impact rate of each row."""
    for k in range(len(states)):
        contact.accept(states[k], bearing[k], pin[k], joints[of[k]])
