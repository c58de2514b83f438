"""A clearance joint by itself, as a force element: the wrench on bearing and pin from their motion.

The element has one state, the impact rate δ̇⁽⁻⁾ of the contact under way, 0 without contact.
`ClearanceJoint.evaluate` does not change it, because solvers evaluate trial steps and go back;
`ClearanceJoint.accept`, called for accepted steps or at the onset of a contact, returns the next.
`cylcontact.export.export_joint` writes the element in other languages.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field, Strict, model_validator

from cylcontact.bodies.iso286 import IsoFit
from cylcontact.bodies.material import own_table
from cylcontact.bodies.material_spec import MaterialSpec
from cylcontact.bodies.pair import CylinderPair
from cylcontact.files.spec import Spec, broken, parse_spec, read_toml
from cylcontact.impact import FACTORS, IMPACT_RATE_FLOOR, hysteresis_factor
from cylcontact.joint import contact, derivatives
from cylcontact.laws import LAWS, ContactLaw, Housing
from cylcontact.laws.housing_spec import HousingSpec, in_housing
from cylcontact.laws.kernels import Kernel, kernel, kernel_load, kernel_stiffness
from cylcontact.laws.power import require_coefficients
from cylcontact.laws.user import user_law
from cylcontact.limits import yield_load
from cylcontact.support.arrays import FloatArray, as_floats, require
from cylcontact.support.choices import Beyond
from cylcontact.support.errors import InputError
from cylcontact.support.numba_cache import compiled
from cylcontact.support.plain_text import identifier

# Of the Fortran names, which end in "_evaluate", the standard allows 63 characters.
_LONGEST_NAME = 40

# TOML has lists, not tuples.
Point = Annotated[tuple[float, float], Strict(False)]


class BodySpec(MaterialSpec):
    """The hole of the bearing, or the pin."""

    R: float | None = Field(None, gt=0, description="the radius in mm")
    point: Point = Field(
        (0.0, 0.0), description="the centre of hole or pin in mm, in the axes of the body, [x, y]"
    )


class DissipationSpec(Spec):
    """The dissipation in normal direction."""

    factor: str = Field(description=f"a hysteresis factor: {', '.join(FACTORS)}")
    restitution: float = Field(gt=0, le=1, description="the restitution, above 0 up to 1")

    @model_validator(mode="after")
    def _check(self) -> DissipationSpec:
        if self.factor not in FACTORS:
            raise broken("factor", self.factor, "is not known", f"choose {', '.join(FACTORS)}")
        return self


# Assumed: a larger friction coefficient is a slip of the pen.
MOST_FRICTION = 2.0


class FrictionSpec(Spec):
    """The friction."""

    coefficient: float = Field(
        ge=0, le=MOST_FRICTION, description="the friction coefficient, at most 2"
    )
    v0: float = Field(
        ge=0,
        description="the speed in mm/s up to which there is no friction; above 0 there is no "
        "static friction at all",
    )
    v1: float = Field(gt=0, description="the speed in mm/s from which there is all of it")

    @model_validator(mode="after")
    def _check(self) -> FrictionSpec:
        if self.v1 <= self.v0:
            raise broken("v1", self.v1, f"must be above v0 = {self.v0}", "raise it")
        return self


class ClearanceJointSpec(Spec):
    """A joint's file."""

    name: str = Field(description="the joint's name")
    units: Literal["SI", "mm"] = Field(
        "SI", description='"SI" (m, N, s, rad) or "mm" (mm, N, s, rad)'
    )
    clearance: float | None = Field(
        None, gt=0, description="the radial clearance in mm, in place of the pin's radius"
    )
    iso: str | None = Field(
        None, description='a fit of ISO 286, "20H7/g6", in place of radii and clearance'
    )
    length: float = Field(gt=0, description="the axial length in mm")
    housing: HousingSpec | None = Field(
        None, description="a table [housing] of the rim's radius R_o, for laws that know it"
    )
    law: str = Field(description="a contact law, e.g. explicit, or the path of a fit result")
    bearing: BodySpec = Field(description="a table [bearing]")
    pin: BodySpec = Field(description="a table [pin]")
    dissipation: DissipationSpec = Field(description="a table [dissipation]")
    friction: FrictionSpec = Field(description="a table [friction]")

    @model_validator(mode="after")
    def _check(self) -> ClearanceJointSpec:
        if not re.match("[A-Za-z]", self.name) or len(self.name) > _LONGEST_NAME:
            raise broken(
                "name", self.name, "cannot name a function",
                f"begin with one of A to Z, and take up to {_LONGEST_NAME} characters",
            )  # fmt: skip
        hole, pin, clearance = self.bearing.R, self.pin.R, self.clearance
        if self.iso is not None:
            for key, value in {"bearing.R": hole, "pin.R": pin, "clearance": clearance}.items():
                if value is not None:
                    raise broken(key, value, f"is given by the fit {self.iso}", "remove one")
            return self
        if hole is None:
            raise broken("bearing.R", None, "is required", "add the radius in mm")
        if (pin is None) == (clearance is None):
            rule = "is required" if pin is None else "is given twice"
            raise broken("pin.R", pin, rule, "give R of the pin, or the clearance")
        if pin is not None and pin >= hole:
            raise broken("pin.R", pin, "does not fit in the hole", f"keep it below {hole}")
        if clearance is not None and clearance >= hole:
            raise broken("clearance", clearance, "leaves no pin", f"keep it below {hole} mm")
        return self


# Assumed: where the straight line of "tangent" takes over, as a fraction of the law's largest
# penetration. At the limit itself Johnson's law is infinitely stiff.
TANGENT_FROM = 0.9

# Millimetres in the element's unit of length.
MILLIMETRES = {"SI": 1e3, "mm": 1.0}


class JointState(NamedTuple):
    """The state of a joint: the impact rate δ̇⁽⁻⁾ > 0 of the contact under way, 0 without."""

    impact_rate: float | FloatArray


class JointWrench(NamedTuple):
    """Forces and moments of a joint, in its units.

    Attributes
    ----------
    force_bearing, force_pin : array of float, shape (..., 2)
        On the two bodies, opposite to each other.
    moment_bearing, moment_pin : float or array of float
        About the reference points of the bodies, positive anticlockwise.
    penetration, penetration_rate : float or array of float
        δ, negative without contact, and its rate.
    normal_force, friction_force : float or array of float
        f_n ≥ 0, and f_t on the bearing along t = [n_y, −n_x], where n points from the pin's
        centre to the bearing's.
    tangential_velocity : float or array of float
        v_t = (v_bearing − v_pin)·t at the contact.
    dissipated_power : float or array of float
        By damping and friction, not negative.
    flag : int or array of int
        1 if the elastic load is above first yield, plus 2 where the law's tangent has taken over,
        plus 32 if the penetration is above a tenth of the hole's radius: the pin has left its hole,
        plus 128 if the force or a moment is not a number.
    """

    force_bearing: FloatArray
    moment_bearing: FloatArray
    force_pin: FloatArray
    moment_pin: FloatArray
    penetration: FloatArray
    penetration_rate: FloatArray
    normal_force: FloatArray
    friction_force: FloatArray
    tangential_velocity: FloatArray
    dissipated_power: FloatArray
    flag: NDArray[np.int64]


class JointJacobian(NamedTuple):
    """Derivatives of force and moment of both bodies, in the joint's units.

    Attributes
    ----------
    by_position, by_velocity : array of float, shape (..., 6, 6)
        Rows: force x, force y and moment of the bearing, then of the pin. Columns: x, y and angle
        of the bearing, then of the pin; or their rates.
    """

    by_position: FloatArray
    by_velocity: FloatArray


@dataclass(frozen=True, eq=False)
class ClearanceJoint:
    """A revolute joint with clearance, as a force element; build one with `read_joint`.

    Attributes
    ----------
    name : str
    units : {"SI", "mm"}
        Those of the element: m or mm, N, s and rad; moments in N m or N mm.
    pair : CylinderPair
        Hole and pin with radii and length, in mm and MPa.
    law : ContactLaw
    chi : float
        The hysteresis factor χ.
    friction : float
        The friction coefficient.
    v0, v1 : float
        The speeds of Eq 15 in mm/s.
    point_bearing, point_pin : pair of float
        The centres of hole and pin in mm, from the reference points in the axes of the bodies.
    origin : str
        Where the law's coefficients come from, if from a fit.
    data : dict
        The file's content.

    Notes
    -----
    Beyond nine tenths of the largest penetration of a law that ends, the load continues along its
    tangent. The damping is at most 20χ times the elastic load (`impact.bounded_ratio`), and an
    impact slower than 1 mm/s counts as one of 1 mm/s.

    Examples
    --------
    A pin of 9.95 mm, 51 µm off the centre of its hole of 10 mm, still moving outwards:

    >>> joint = read_joint("datasets/joint.toml")
    >>> bearing, pin = [0.0] * 6, [51e-6, 0.0, 0.0, 0.02, 0.0, 0.0]
    >>> state = joint.accept(joint.start(), bearing, pin)
    >>> wrench = joint.evaluate(state, bearing, pin)
    >>> print(f"{1e6 * wrench.penetration:.3f} µm, {wrench.force_pin[0]:.1f} N")
    1.000 µm, -482.8 N
    """

    name: str
    units: Literal["SI", "mm"]
    pair: CylinderPair
    law: ContactLaw
    chi: float
    friction: float
    v0: float
    v1: float
    point_bearing: Point = (0.0, 0.0)
    point_pin: Point = (0.0, 0.0)
    origin: str = ""
    data: dict[str, Any] = field(default_factory=dict, repr=False)

    @property
    def identifier(self) -> str:
        """The name as other languages take it.

        Examples
        --------
        >>> read_joint("datasets/joint.toml").identifier
        'wrist_pin'
        """
        return identifier(self.name)

    @property
    def in_mm(self) -> float:
        """The unit of length in mm."""
        return MILLIMETRES[self.units]

    @property
    def rate_floor(self) -> float:
        """The slowest impact rate, in the joint's units."""
        return IMPACT_RATE_FLOOR / self.in_mm

    @cached_property
    def block(self) -> Any:
        """The record with the tangent that continues a law."""
        return self.record()

    @property
    def housing(self) -> Housing | None:
        """The housing, if the law has one."""
        datum = getattr(self.law, "datum", None)
        return datum if isinstance(datum, Housing) else None

    @cached_property
    def first_yield(self) -> float:
        """The elastic force in N at first yield; inf unless all yield stresses are known."""
        if not self.can_yield:
            return float("inf")
        load = float(yield_load(self.pair, housing=self.housing))
        return load * self.pair.contact_length("the joint")

    @cached_property
    def kernel(self) -> Kernel:
        """The law at the pair, ready to be compiled."""
        return kernel(self.law, self.pair)

    @property
    def radial(self) -> float:
        """The radial clearance in mm."""
        return float(np.asarray(self.pair.dR))

    @property
    def can_yield(self) -> bool:
        """Whether all yield stresses are known, those of the housing's rings too."""
        rings = () if self.housing is None else self.housing.layers
        bodies = self.pair.material_i, self.pair.material_j, *(body for body, _ in rings)
        return all(body.yield_stress is not None for body in bodies)

    def record(self, beyond: Beyond = "tangent") -> Any:
        """Return the joint as compiled functions take it, of the type `contact.JOINT`."""
        R_i, R_j = (float(R) for R in self.pair.radii("the joint"))
        record = np.zeros(1, contact.JOINT)[0]
        record["branch"] = record["regime"] = contact.ANY
        record["chi"], record["friction"] = self.chi, self.friction
        record["v0"], record["v1"] = self.v0 * 1e-3, self.v1 * 1e-3
        record["impact_rate"] = record["rate_floor"] = IMPACT_RATE_FLOOR * 1e-3
        record["clearance"] = self.radial * 1e-3
        record["R_bearing"], record["R_pin"] = R_i * 1e-3, R_j * 1e-3
        record["length"] = self.pair.contact_length("the joint")
        (record["x_i"], record["y_i"]), (record["x_j"], record["y_j"]) = (
            (x / 1e3, y / 1e3) for x, y in (self.point_bearing, self.point_pin)
        )
        record["metres"], record["first_yield"] = self.in_mm / 1e3, self.first_yield
        record["last_penetration"] = record["stop_penetration"] = np.inf
        law = self.kernel
        record["kernel"] = law.kind
        if np.isfinite(law.max_penetration):
            last = law.max_penetration * (TANGENT_FROM if beyond == "tangent" else 1.0)
            record["last_penetration"] = last
            # Trial steps of an integrator go beyond the end even if the run stops there.
            record["last_load"] = kernel_load(law.kind, law.parameters, last)
            if beyond == "tangent":
                record["last_slope"] = kernel_stiffness(law.kind, law.parameters, last)
            else:
                record["stop_penetration"] = last * 1e-3
        return record

    def start(self) -> JointState:
        """Return the state without contact."""
        return JointState(0.0)

    def evaluate(self, state: JointState, bearing: ArrayLike, pin: ArrayLike) -> JointWrench:
        """Return the wrench; the state stays as it is.

        Parameters
        ----------
        state : JointState
            Its impact rate has shape () or (...).
        bearing, pin : array_like, shape (6,) or (..., 6)
            x, y, angle, v_x, v_y and spin of the reference points of the two bodies.

        Returns
        -------
        JointWrench
            If the state says "no contact" where the surfaces overlap, as in a trial step across the
            onset, the impact rate is the penetration rate of these very arguments.
        """
        rates, bearings, pins, shape = self._rows(state, bearing, pin)
        wrench = np.zeros(len(rates), contact.WRENCH)
        _evaluate(rates, bearings, pins, wrench, self.block, self.kernel.parameters)
        return JointWrench(**parts_of(wrench, shape))

    def evaluate_jacobian(
        self, state: JointState, bearing: ArrayLike, pin: ArrayLike
    ) -> JointJacobian:
        """Return the derivatives of the forces and moments by the motion of both bodies.

        The impact rate of the state is held. At a kink (first touch, the speeds v0 and v1, the
        clip of the normal force at zero, the end of the law) the derivative is that of the piece
        that `evaluate` takes there; it is zero without contact, and NaN for a motion that is not a
        number.

        Parameters
        ----------
        state, bearing, pin
            As for `evaluate`.

        Returns
        -------
        JointJacobian

        Examples
        --------
        The stiffness of a pin that is pressed 1 µm in:

        >>> joint = read_joint("datasets/joint.toml")
        >>> bearing, pin = [0.0] * 6, [51e-6, 0.0, 0.0, 0.0, 0.0, 0.0]
        >>> by_position, by_velocity = joint.evaluate_jacobian(JointState(0.02), bearing, pin)
        >>> print(f"{-by_position[3, 3]:.4g} N/m")
        4.948e+08 N/m
        """
        rates, bearings, pins, shape = self._rows(state, bearing, pin)
        out = np.zeros(len(rates), derivatives.JACOBIAN)
        _evaluate_jacobian(rates, bearings, pins, out, self.block, self.kernel.parameters)
        return JointJacobian(*(out[name].reshape(*shape, 6, 6) for name in out.dtype.names or ()))

    def differentiate(
        self,
        state: JointState,
        bearing: ArrayLike,
        pin: ArrayLike,
        bearing_along: ArrayLike,
        pin_along: ArrayLike,
    ) -> JointWrench:
        """Return the derivative of every number of the wrench along a direction of the motion.

        Parameters
        ----------
        state, bearing, pin
            As for `evaluate`.
        bearing_along, pin_along : array_like, shape (6,) or (..., 6)
            The direction: the change of x, y, angle, v_x, v_y and spin of either body.

        Returns
        -------
        JointWrench
            With the flag 0. Kinks and NaN are as in `evaluate_jacobian`.

        Examples
        --------
        >>> joint = read_joint("datasets/joint.toml")
        >>> bearing, pin = [0.0] * 6, [51e-6, 0.0, 0.0, 0.0, 0.0, 0.0]
        >>> along = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
        >>> change = joint.differentiate(JointState(0.02), bearing, pin, [0.0] * 6, along)
        >>> print(f"{change.normal_force:.4g} N/m, {change.penetration:.1f}")
        4.948e+08 N/m, 1.0
        """
        rates, bearings, pins, shape = self._rows(state, bearing, pin)
        first, second = (
            np.ascontiguousarray(np.broadcast_to(as_floats(along), (*shape, 6)).reshape(-1, 6))
            for along in (bearing_along, pin_along)
        )
        wrench = np.zeros(len(rates), contact.WRENCH)
        law = self.kernel.parameters
        _differentiate(rates, bearings, pins, first, second, wrench, self.block, law)
        return JointWrench(**parts_of(wrench, shape))

    def elastic_energy(self, bearing: ArrayLike, pin: ArrayLike) -> FloatArray:
        """Return the energy that the contact stores, in J or N mm, within 4e-8 of it.

        Parameters
        ----------
        bearing, pin
            As for `evaluate`.

        Returns
        -------
        array of float, shape (...)
            ∫ F_el dδ up to the penetration; 0 without contact.

        Examples
        --------
        >>> joint = read_joint("datasets/joint.toml")
        >>> print(f"{joint.elastic_energy([0.0] * 6, [51e-6, 0.0, 0.0, 0.0, 0.0, 0.0]):.4g} J")
        0.00019 J
        """
        _, bearings, pins, shape = self._rows(self.start(), bearing, pin)
        out = np.zeros(len(pins))
        _elastic_energy(bearings, pins, out, self.block, self.kernel.parameters)
        return out.reshape(shape)

    def accept(self, state: JointState, bearing: ArrayLike, pin: ArrayLike) -> JointState:
        """Return the state after an accepted step, or at the onset of a contact.

        Parameters
        ----------
        state, bearing, pin
            As for `evaluate`.

        Returns
        -------
        JointState
            Without contact, 0. At the first touch the penetration rate, at least 1 mm/s. Unchanged
            while the contact lasts.
        """
        rates, bearings, pins, shape = self._rows(state, bearing, pin)
        _accept(rates, bearings, pins, self.block)
        numbers = rates["impact_rate"]
        return JointState(numbers.reshape(shape) if shape else float(numbers[0]))

    def _rows(
        self, state: JointState, bearing: ArrayLike, pin: ArrayLike
    ) -> tuple[Any, FloatArray, FloatArray, tuple[int, ...]]:
        """Return states and both bodies, one to a row, and the shape of the rows."""
        rates = as_floats(state.impact_rate)[..., None]
        numbers, bearings, pins, shape = rows_of(rates, bearing, pin, 6)
        return numbers.view(contact.STATE)[:, 0], bearings, pins, shape


# What a body is, by how many numbers.
_BODIES = {
    6: ("six numbers", "x, y, angle, v_x, v_y, spin"),
    13: ("thirteen numbers", "position, quaternion w x y z, velocity and angular velocity"),
}


def rows_of(
    rates: FloatArray, bearing: ArrayLike, pin: ArrayLike, size: int
) -> tuple[FloatArray, FloatArray, FloatArray, tuple[int, ...]]:
    """Return copies of impact rates and both bodies, one to a row, and the shape of the rows."""
    numbers = [rates]
    for key, body in (("bearing", bearing), ("pin", pin)):
        numbers.append(np.asarray(body, dtype=np.float64))
        if numbers[-1].shape[-1:] != (size,):
            what, remedy = _BODIES[size]
            require(False, "joint", key, body, f"must be {what}", f"give {remedy}")
    if all(part.ndim == 1 for part in numbers):  # one state: broadcasting takes longer than a law
        first, second, third = (part.reshape(1, -1).copy() for part in numbers)
        return first, second, third, ()
    shape = np.broadcast_shapes(*(part.shape[:-1] for part in numbers))
    first, second, third = (
        np.broadcast_to(part, (*shape, part.shape[-1])).reshape(-1, part.shape[-1]).copy()
        for part in numbers
    )
    return first, second, third, shape


def parts_of(wrench: Any, shape: tuple[int, ...]) -> dict[str, Any]:
    """Return the parts of wrenches, each of the shape of the rows."""
    parts = {name: wrench[name] for name in wrench.dtype.names}
    if shape == ():
        return {name: part[0] for name, part in parts.items()}
    return {name: part.reshape(shape + part.shape[1:]).copy() for name, part in parts.items()}


@compiled
def _evaluate(
    states: Any, bearing: FloatArray, pin: FloatArray, wrench: Any, joint: Any, law: FloatArray
) -> None:
    """Write the wrench of each row."""
    for k in range(len(states)):
        contact.evaluate(states[k], bearing[k], pin[k], wrench[k], joint, law)


@compiled
def _evaluate_jacobian(
    states: Any, bearing: FloatArray, pin: FloatArray, out: Any, joint: Any, law: FloatArray
) -> None:
    """Write the derivatives of each row."""
    for k in range(len(states)):
        derivatives.evaluate_jacobian(states[k], bearing[k], pin[k], out[k], joint, law)


@compiled
def _differentiate(
    states: Any, bearing: FloatArray, pin: FloatArray, first: FloatArray, second: FloatArray,
    out: Any, joint: Any, law: FloatArray,
) -> None:  # fmt: skip
    """Write the derivative along the direction of each row."""
    for k in range(len(states)):
        derivatives.differentiate(
            states[k], bearing[k], pin[k], first[k], second[k], out[k], joint, law
        )


@compiled
def _elastic_energy(
    bearing: FloatArray, pin: FloatArray, out: FloatArray, joint: Any, law: FloatArray
) -> None:
    """Write the energy of each row."""
    for k in range(len(out)):
        out[k] = derivatives.elastic_energy(bearing[k], pin[k], joint, law)


@compiled
def _accept(states: Any, bearing: FloatArray, pin: FloatArray, joint: Any) -> None:
    """Update the impact rate of each row."""
    for k in range(len(states)):
        contact.accept(states[k], bearing[k], pin[k], joint)


def read_joint(path: Path | str, materials: Path | str | None = None) -> ClearanceJoint:
    """Read a joint's file.

    Parameters
    ----------
    path : path
        A TOML file, e.g. datasets/joint.toml. A fit result named in it is searched beside the file
        first, then in the working folder.
    materials : path, optional
        Your own table of materials; by default datasets/materials.csv if there is one, beside the
        file, above it or here.

    Returns
    -------
    ClearanceJoint

    Raises
    ------
    InputError
        With the first mistake in the file.

    Examples
    --------
    >>> joint = read_joint("datasets/joint.toml")
    >>> joint.law.name, round(joint.chi, 4), round(joint.first_yield)
    ('conformal', 0.1665, 33201)
    """
    own = own_table(materials, Path(path).parent, str(path))
    return joint_from(read_toml(path), str(path), own)


def joint_from(
    data: dict[str, Any], source: str = "joint", own: Path | None = None
) -> ClearanceJoint:
    """Return the joint of a file's data; see `read_joint`."""
    joint = build_joint(data, source, own)
    require_defined(joint, source)
    return joint


def require_defined(joint: ClearanceJoint, source: str, key: str = "law") -> None:
    """Raise `InputError` if a joint's law is undefined for its pair."""
    deepest = np.asarray(joint.law.max_penetration(joint.pair))
    load = joint.law.load(np.minimum(1e-3 * joint.radial, 0.5 * deepest), joint.pair)
    require(
        (deepest > 0) & (load > 0) & np.isfinite(load), source, key, joint.data["law"],
        f"is undefined for this pair, with its clearance of {joint.radial:.4g} mm",
        "choose another law",
    )  # fmt: skip


def build_joint(
    data: dict[str, Any], source: str, own: Path | None = None, law: ContactLaw | None = None
) -> ClearanceJoint:
    """Return the joint of a file's data, with another law if one is given."""
    rule, remedy = "is a spatial joint", "read it with SpatialJoint.read"
    require(data.get("kind") != "spatial", source, "kind", "spatial", rule, remedy)
    spec = parse_spec(ClearanceJointSpec, data, source)
    hole, pin = (
        body.named(key, own, source, f"{key}.material")
        for key, body in (("bearing", spec.bearing), ("pin", spec.pin))
    )
    R_i, radial = spec.bearing.R or 0.0, spec.clearance or 0.0
    if spec.iso is not None:
        fit = IsoFit.read(spec.iso, source, "iso")
        fit.require_clearance(source, "iso")
        pair = CylinderPair.internal(*fit.middle, length=spec.length, pin=pin, hole=hole)
    elif spec.pin.R is not None:
        pair = CylinderPair.internal(R_i, spec.pin.R, length=spec.length, pin=pin, hole=hole)
    else:
        pair = CylinderPair.from_dR(
            "internal", radial, length=spec.length, R_i=R_i, pin=pin, hole=hole
        )
    origin = ""
    if law is None and spec.housing is not None:
        law, origin = _in_housing(spec.law, spec.housing, own, source)
    elif law is None:
        law, origin = named_law(spec.law, source)
    damping = spec.dissipation
    chi = float(hysteresis_factor(damping.factor)(damping.restitution))
    require(
        np.isfinite(chi), source, "dissipation.restitution", damping.restitution,
        f"is too small for the hysteresis factor {damping.factor!r}", "give a larger one",
    )  # fmt: skip
    friction = spec.friction.coefficient, spec.friction.v0, spec.friction.v1
    points = spec.bearing.point, spec.pin.point
    about = spec.name, spec.units, pair, law, chi
    return ClearanceJoint(*about, *friction, *points, origin, data)


def _in_housing(
    what: str, spec: HousingSpec, own: Path | None, source: str
) -> tuple[ContactLaw, str]:
    """Return a law in the housing of a joint, and in words what it is."""
    require(
        spec.clamp == "rim", source, "housing.clamp", spec.clamp,
        "has a direction, but a joint rotates", "a joint takes a rim that is clamped all around",
    )  # fmt: skip
    housing = spec.built(own, source)
    law = in_housing(what, housing, source)
    origin = f"in a housing of R_o = {spec.R_o:g} mm, its whole rim clamped"
    for material, radius in housing.layers:
        origin += f", of E = {material.E:g} MPa from R = {radius:g} mm on"
    return law, origin


def named_law(what: str, source: str) -> tuple[ContactLaw, str]:
    """Return the law with a name, or of a fit result, and the origin of its coefficients."""
    if what in LAWS:
        return LAWS[what](), ""
    if ":" in what:
        return user_law(what, Path(source).parent, Path.cwd()), "a function of the user's own"
    if Path(what).suffix != ".json":
        require_coefficients(what, source)
        raise InputError(
            source, "law", what, "is neither a law nor a fit result",
            f"choose {', '.join(LAWS)}, your module:function, or the path of a result",
        )  # fmt: skip
    from cylcontact.fitting import read_result

    path = next((path for path in (Path(source).parent / what, Path(what)) if path.is_file()), None)
    if path is None:
        rule = "is neither beside this file nor in the working folder"
        raise InputError(source, "law", what, rule, "give the path of a fit's result")
    result = read_result(path)
    rule, remedy = "is a fit to external contact", "name a fit for a pin in a hole"
    require(result.contact == "internal", source, "law", what, rule, remedy)
    return result.to_law(what), f"fit result '{result.name}', fitted to {result.reference}"
