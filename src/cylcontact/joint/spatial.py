"""A clearance joint in space, as a force element: the pin may tilt, slide along and strike faces.

It has four states, the impact rates of the rims A and B, at the ends of the hole with z > 0 and
z < 0 along its axis, and of the two thrust faces there. `spatial_forces` has the equations.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field, Strict, model_validator

from cylcontact.bodies.material import own_table
from cylcontact.files.spec import Spec, broken, parse_spec, read_toml
from cylcontact.impact import IMPACT_RATE_FLOOR, hysteresis_factor
from cylcontact.joint import spatial_forces
from cylcontact.joint.clearance import (
    BodySpec,
    ClearanceJoint,
    ClearanceJointSpec,
    joint_from,
    parts_of,
    rows_of,
)
from cylcontact.support.arrays import FloatArray, as_floats, require
from cylcontact.support.numba_cache import compiled

# TOML has lists, not tuples.
_Vector = Annotated[tuple[float, float, float], Strict(False)]
_Interval = Annotated[tuple[float, float], Strict(False)]

# c and b of the rim's stiffness, for sharp rims and like materials; a pin as long as its hole, and
# one that goes on. From earlier elements; within 25 % of those in datasets/tilted_pin.csv, a fit to
# which gives (0.098, 0.42) and (0.155, 1.03).
EDGES = {"flush": (0.105, 0.45), "overhang": (0.17, 1.0), "none": (0.0, 1.0)}

# Assumed: a flush pin reaches this many half lengths of its hole, so that its ends, which a tilt of
# 0.1 draws in by 1 - cos, stay outside.
FLUSH_REACH = 1.005

# Assumed: up to this ratio of their plane-strain moduli materials are alike.
LIKE = 1.1


class SpatialBodySpec(BodySpec):
    """The hole of the bearing, with a place in space."""

    point: _Vector = Field(  # type: ignore[assignment]
        (0.0, 0.0, 0.0), description="a point in mm, in the axes of the body, [x, y, z]"
    )
    axis: _Vector = Field(
        (0.0, 0.0, 1.0), description="the direction of the axis, in the axes of the body"
    )

    @model_validator(mode="after")
    def _check_axis(self) -> SpatialBodySpec:
        if not any(self.axis):
            raise broken("axis", self.axis, "has no direction", "give one, as [0, 0, 1]")
        return self


class SpatialPinSpec(SpatialBodySpec):
    """The pin."""

    ends: _Interval | None = Field(
        None,
        description="its ends in mm along its axis from its point; if absent, a flush pin is as "
        "long as its hole, and any other has no end",
    )
    crown: float = Field(0.0, ge=0, description="the drop of a parabolic crown at the ends in mm")

    @model_validator(mode="after")
    def _check_ends(self) -> SpatialPinSpec:
        if self.ends is not None and self.ends[0] >= self.ends[1]:
            raise broken("ends", self.ends, "leave no pin", "give the lower one first")
        return self


class EdgeSpec(Spec):
    """The stiffness that the material beside the contact adds at a rim."""

    kind: Literal["flush", "overhang", "none"] | None = Field(
        None, description='"flush", "overhang" (the pin goes on beyond the hole) or "none"'
    )
    c: float | None = Field(None, ge=0, description="the factor of the rim's stiffness")
    b: float | None = Field(None, gt=0, description="the slope at which it sets in")

    @model_validator(mode="after")
    def _check(self) -> EdgeSpec:
        given = (self.c is not None, self.b is not None)
        if given != ((self.kind is None),) * 2:
            raise broken("", None, "needs a kind, or both c and b", 'write kind = "flush"')
        return self

    @property
    def constants(self) -> tuple[float, float]:
        """c and b."""
        return (self.c or 0.0, self.b or 1.0) if self.kind is None else EDGES[self.kind]


class ThrustSpec(Spec):
    """Two collars of the pin against the faces of the bush, as elastic rings."""

    play: float = Field(ge=0, description="the axial play in mm, of both sides together")
    radius: float = Field(gt=0, description="the mean radius of the rings in mm")
    stiffness: float = Field(gt=0, description="of one ring against its face in N/mm")
    restitution: float = Field(gt=0, le=1, description="the restitution, above 0 up to 1")


class SpatialJointSpec(ClearanceJointSpec):
    """A spatial joint's file."""

    kind: Literal["spatial"] = Field(description='"spatial"')
    bearing: SpatialBodySpec = Field(description="a table [bearing]")
    pin: SpatialPinSpec = Field(description="a table [pin]")
    edge: EdgeSpec = Field(description="a table [edge], the stiffness of the rims")
    thrust: ThrustSpec | None = Field(None, description="a table [thrust]")

    @model_validator(mode="after")
    def _check_length(self) -> SpatialJointSpec:
        crown, ends, half = self.pin.crown, self.pin.ends, 0.5 * self.length
        if crown >= self.length:
            remedy = f"keep it below {self.length} mm"
            raise broken("pin.crown", crown, "is more than the length of the bush", remedy)
        if ends and (ends[0] > -half or ends[1] < half) and self.edge.kind in ("flush", "overhang"):
            raise broken(
                "edge.kind", self.edge.kind, "is not known for an end of the pin inside the hole",
                'write kind = "none", or your own c and b',
            )  # fmt: skip
        if self.thrust and self.thrust.radius <= (self.bearing.R or 0.0):
            remedy = f"give more than the hole's radius of {self.bearing.R} mm"
            raise broken("thrust.radius", self.thrust.radius, "is inside the hole", remedy)
        return self


class SpatialState(NamedTuple):
    """The state of a spatial joint.

    Attributes
    ----------
    impact_rate : array of float, shape (..., 4)
        δ̇⁽⁻⁾ > 0 of the contacts under way at rims A and B and at faces A and B, 0 without.
    """

    impact_rate: FloatArray


class SpatialWrench(NamedTuple):
    """Forces and moments of a spatial joint, in its units and the axes of the world.

    Attributes
    ----------
    force_bearing, force_pin : array of float, shape (..., 3)
        On the two bodies, opposite to each other.
    moment_bearing, moment_pin : array of float, shape (..., 3)
        About the reference points of the bodies.
    penetration, penetration_rate : array of float, shape (..., 4)
        At rims A and B (of a crowned pin the deepest in each half) and at faces A and B; negative
        without contact. Their zeros are the events.
    normal_force : array of float
        The sum of the loads on the wall.
    dissipated_power, elastic_energy : array of float
        The first by damping and friction, not negative.
    touched : array of float
        The length of the wall that touches.
    flag : array of int
        The sum of 1 if the line load is above first yield somewhere (a sharp rim yields at once),
        2 beyond the end of the law, 4 if less than a quarter of the length touches and the rims
        have no stiffness, 8 if the tilt is above 0.1, 16 if the constants of a named [edge], which
        are for like materials, carry load at a rim and the moduli differ by more than a tenth, 32
        if the penetration of a rim or a face is above a tenth of the hole's radius: the pin has
        left its hole, 64 if pin and hole share less than 99 % of the length that they share in the
        middle: the pin has slid out, 128 if the motion is not a number, 256 if the law is for a
        housing and one rim is less than 90 % as deep as the other or less than 90 % of the length
        touches: each slice then bends the housing by itself, but a housing bends as a whole.
    """

    force_bearing: FloatArray
    moment_bearing: FloatArray
    force_pin: FloatArray
    moment_pin: FloatArray
    penetration: FloatArray
    penetration_rate: FloatArray
    normal_force: FloatArray
    dissipated_power: FloatArray
    elastic_energy: FloatArray
    touched: FloatArray
    flag: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class SpatialJoint:
    """A clearance joint in space, as a force element; build one with `SpatialJoint.read`.

    Attributes
    ----------
    planar : ClearanceJoint
        The joint that it is without tilt: bodies, law, damping, friction, name and units.
    spec : SpatialJointSpec
        Points, axes, ends, crown, rims and faces, as the file has them.
    data : dict
        The file's content.

    Examples
    --------
    A pin of 9.95 mm that leans by 0.006 in its hole of 10 mm, 20 mm long, touches both rims:

    >>> joint = SpatialJoint.read("datasets/spatial_joint.toml")
    >>> still = [0.0] * 6
    >>> wrench = joint.evaluate(
    ...     joint.start(), [0, 0, 0, 1, 0, 0, 0, *still], [0, 0, 0, 1, 0.003, 0, 0, *still]
    ... )
    >>> print(f"{1e6 * wrench.penetration[0]:.2f} µm along {1e3 * wrench.touched:.2f} mm")
    10.18 µm along 3.39 mm
    """

    planar: ClearanceJoint
    spec: SpatialJointSpec
    data: dict[str, Any] = field(default_factory=dict, repr=False)

    @classmethod
    def read(cls, path: Path | str, materials: Path | str | None = None) -> SpatialJoint:
        """Read a joint's file with kind = "spatial".

        Parameters
        ----------
        path, materials
            As for `read_joint`.

        Returns
        -------
        SpatialJoint

        Raises
        ------
        InputError
            With the first mistake in the file.
        """
        own = own_table(materials, Path(path).parent, str(path))
        return cls.from_data(read_toml(path), str(path), own)

    @classmethod
    def from_data(
        cls, data: dict[str, Any], source: str = "joint", own: Path | None = None
    ) -> SpatialJoint:
        """Return the joint of a file's data; see `read`."""
        spec = parse_spec(SpatialJointSpec, data, source)
        plane = {
            key: {k: v for k, v in value.items() if k in BodySpec.model_fields and k != "point"}
            if key in ("bearing", "pin")
            else value
            for key, value in data.items()
            if key in ClearanceJointSpec.model_fields
        }
        joint = cls(joint_from(plane, source, own), spec, data)
        thrust = spec.thrust
        if thrust is not None:
            E_star, R = float(joint.planar.pair.E_star), float(joint.record["R_hole"])
            bound = 2 * E_star * (2 * thrust.radius - R)
            require(
                thrust.stiffness <= bound, source, "thrust.stiffness", thrust.stiffness,
                "is above that of a rigid collar", f"keep it below {bound:.3g} N/mm",
            )  # fmt: skip
            require(
                np.isfinite(joint.record["face_chi"]), source, "thrust.restitution",
                thrust.restitution, "is too small for the hysteresis factor",
                "give a larger one",
            )  # fmt: skip
        return joint

    @cached_property
    def record(self) -> Any:
        """The numbers of the compiled functions, of the type `spatial_forces.SPATIAL`."""
        planar, spec, thrust = self.planar, self.spec, self.spec.thrust
        R_i, R_j = (float(R) for R in planar.pair.radii("the joint"))
        half, (c, b) = 0.5 * spec.length, spec.edge.constants
        reach = FLUSH_REACH * half if spec.edge.kind == "flush" else np.inf
        low, high = spec.pin.ends or (-reach, reach)
        record = np.zeros(1, spatial_forces.SPATIAL)[0]
        record["point_b"], record["point_p"] = spec.bearing.point, spec.pin.point
        record["x_b"], record["y_b"], record["z_b"] = _frame(spec.bearing.axis)
        record["axis_p"] = _frame(spec.pin.axis)[2]
        record["in_mm"], record["half"] = planar.in_mm, half
        record["R_hole"], record["R_pin"], record["clearance"] = R_i, R_j, planar.radial
        record["pin_low"], record["pin_high"] = low, high
        record["crown"], record["crown_half"] = spec.pin.crown, half
        if spec.pin.ends:
            record["crown_at"], record["crown_half"] = 0.5 * (low + high), 0.5 * (high - low)
        record["chi"], record["friction"] = planar.chi, planar.friction
        record["rate_floor"] = IMPACT_RATE_FLOOR
        record["v0"], record["v1"] = planar.v0, planar.v1
        stiff = 0.4 * float(planar.pair.E_star) * (2 * R_i * R_j / planar.radial) ** 0.5
        record["edge"], record["edge_width"] = c * stiff, b * R_i
        first, second = map(float, planar.pair.moduli)
        record["housed"] = planar.housing is not None
        record["unlike"] = spec.edge.kind is not None and not 1 / LIKE < first / second < LIKE
        if thrust is not None:
            factor = hysteresis_factor(spec.dissipation.factor)
            record["face_gap"], record["face_radius"] = half + 0.5 * thrust.play, thrust.radius
            record["face_stiffness"] = thrust.stiffness / (2 * np.pi)
            record["face_chi"] = float(factor(thrust.restitution))
        for name in ("last_penetration", "last_load", "last_slope", "kernel"):
            record[name] = planar.block[name]
        record["yields"] = planar.first_yield / spec.length
        return record

    def start(self) -> SpatialState:
        """Return the state without contact."""
        return SpatialState(np.zeros(4))

    def evaluate(self, state: SpatialState, bearing: ArrayLike, pin: ArrayLike) -> SpatialWrench:
        """Return the wrench; the state stays as it is.

        Parameters
        ----------
        state : SpatialState
            Its impact rates have shape (4,) or (..., 4).
        bearing, pin : array_like, shape (13,) or (..., 13)
            Of the reference points of the two bodies: position, quaternion w, x, y, z from the
            axes of the body to the world, velocity and angular velocity in the world's axes.

        Returns
        -------
        SpatialWrench
            Where the state says "no contact" and the surfaces overlap, as in a trial step across
            the onset, the impact rate is the penetration rate of these very arguments.

        Raises
        ------
        InputError
            For arguments that are no motion, or if the axes are near a right angle.
        """
        rates, bearings, pins, shape = self._rows(state, bearing, pin)
        wrench, work = np.zeros(len(rates), spatial_forces.WRENCH), np.zeros(1, spatial_forces.WORK)
        states = rates.view(spatial_forces.STATE)[:, 0]
        _evaluate(
            states, bearings, pins, wrench, work[0], self.record, self.planar.kernel.parameters
        )
        moves = np.isfinite(np.hstack([bearings, pins])).all(axis=1)  # else the wrench is NaN
        require(
            ~(moves & np.isnan(wrench["normal_force"])), self.planar.name, "pin", None,
            "has its axis near a right angle to that of the hole", "give both axes in the file",
        )  # fmt: skip
        return SpatialWrench(**parts_of(wrench, shape))

    def accept(self, state: SpatialState, bearing: ArrayLike, pin: ArrayLike) -> SpatialState:
        """Return the state after an accepted step, or at the onset of a contact.

        Parameters
        ----------
        state, bearing, pin
            As for `evaluate`.

        Returns
        -------
        SpatialState
            Of each rim and face: 0 without contact; at the first touch the penetration rate, at
            least 1 mm/s; unchanged while the contact lasts.
        """
        rates, bearings, pins, shape = self._rows(state, bearing, pin)
        work = np.zeros(1, spatial_forces.WORK)[0]
        _accept(rates.view(spatial_forces.STATE)[:, 0], bearings, pins, work, self.record)
        return SpatialState(rates.reshape(*shape, 4))

    def _rows(
        self, state: SpatialState, bearing: ArrayLike, pin: ArrayLike
    ) -> tuple[FloatArray, FloatArray, FloatArray, tuple[int, ...]]:
        rows = rows_of(as_floats(state.impact_rate), bearing, pin, 13)
        for key, body in zip(("bearing", "pin"), rows[1:3], strict=True):
            rule, remedy = "has a quaternion of zeros", "give one of any length but 0"
            require((body[:, 3:7] != 0).any(axis=1), "joint", key, None, rule, remedy)
        return rows


def _frame(axis: tuple[float, float, float]) -> FloatArray:
    """Return three unit vectors at right angles, the last along an axis."""
    z = np.array(axis) / np.linalg.norm(axis)
    x = np.eye(3)[np.argmin(np.abs(z))]
    x = x - (x @ z) * z
    x /= np.linalg.norm(x)
    return np.array([x, np.cross(z, x), z])


@compiled
def _evaluate(
    states: Any, bearing: FloatArray, pin: FloatArray, wrench: Any, work: Any, joint: Any,
    law: FloatArray,
) -> None:  # fmt: skip
    """Write the wrench of each row."""
    for k in range(len(states)):
        spatial_forces.evaluate(states[k], bearing[k], pin[k], wrench[k], work, joint, law)


@compiled
def _accept(states: Any, bearing: FloatArray, pin: FloatArray, work: Any, joint: Any) -> None:
    """Update the impact rates of each row."""
    for k in range(len(states)):
        spatial_forces.accept(states[k], bearing[k], pin[k], work, joint)
