"""Set-ups of a pin in a hole, and meshes of its half: four-node quads, graded towards the contact.

The symmetry axis is x = 0. The contact is at the top, and θ is measured from there. The origin is
the hole's centre and the pin touches the top of the hole, so the pin's centre is at y = ΔR. The
plate is a ring of polar cells. The pin is a square core with three blocks around it, so that no
cell degenerates at its centre. As far as contact can extend, both surfaces have their nodes on the
same rays from the hole's centre, so contact is between pairs of nodes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal, get_args

import numpy as np
from pydantic import BeforeValidator, Field

from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import CylinderPair, Plane
from cylcontact.files.spec import Spec, broken, parse_spec
from cylcontact.laws import Conformal, Sector
from cylcontact.support.arrays import FloatArray, IndexArray, require
from cylcontact.support.errors import InputError

BodyName = Literal["plate", "pin"]

# With fewer cells over the half-width of the contact the pressure is meaningless.
_FEWEST_CELLS = 4
# For a given `size`: number of cells of that size, growth beyond, and largest cell in radii.
_EVEN_CELLS, _GROWTH, _LARGEST = 24, 1.1, 0.1
# Rounding costs 1e-5 of the penetration at 1 − 2ν = 2e-11 and is inversely proportional to 1 − 2ν.
_LARGEST_NU = 0.499999

# Half-width of the pin's square core, in radii.
_CORE = 0.35
_QUARTER = np.pi / 4
# The smallest cells at the end of a clamp, in radii of the hole.
_EDGE = 0.001
# 200 cells over the half-width of the narrowest real contact need some 3000.
_MOST_CELLS = 5000


# --- the set-up ----------------------------------------------------------------------------------


def _clamp(clamp: object) -> object:
    """Return the sector that a text such as "pulled:60" names, and all else as it is."""
    side, colon, angle = clamp.partition(":") if isinstance(clamp, str) else ("", "", "")
    if not colon:
        return clamp
    try:
        return Sector(float(angle), side)  # type: ignore[arg-type]
    except ValueError:
        rule = "must be a sector, pushed or pulled, of 10 to 350 degrees"
        raise broken("", clamp, rule, 'write e.g. "pulled:60"') from None


_Clamp = Annotated[Literal["upper half", "rim"] | Sector, BeforeValidator(_clamp)]


class SetupKeys(Spec):
    """What a set-up may hold, in Python and, with Young's moduli in GPa, in a file."""

    hole_radius: float = Field(gt=0, description="the radius of the hole in mm")
    outer_ratio: float = Field(
        gt=1, le=1000, description="the plate's outer radius over the hole's, above 1"
    )
    E: float | str = Field(description="Young's modulus in MPa, or with its unit")
    nu: float = Field(ge=0, le=0.5, description="Poisson's ratio, from 0 to 0.5")
    plane: Plane = Field("strain", description='"strain" or "stress"')
    load_on: Literal["pin", "disc", "centre"] = Field(
        "pin", description='"pin", "disc" or "centre"'
    )
    disc_ratio: float = Field(
        0.25, gt=0.1, le=1, description="the loaded disc's radius over the pin's, above 0.1"
    )
    clamp: _Clamp = Field(
        "upper half",
        description='"upper half", "rim", or a sector such as "pushed:60" or "pulled:60"',
    )
    cells: int = Field(
        16,
        ge=_FEWEST_CELLS,
        le=200,
        description=f"cells over the contact's half-width, an integer from {_FEWEST_CELLS} to 200",
    )
    size: float | None = Field(None, gt=0, description="the smallest cells, a number in mm above 0")
    contact_size: float | None = Field(
        None, gt=0, description="the largest cells in the contact, a number in mm above 0"
    )
    pin_E: float | str | None = Field(None, description="the pin's Young's modulus, as E")
    pin_nu: float | None = Field(
        None, ge=0, le=0.5, description="the pin's Poisson's ratio, from 0 to 0.5"
    )


class Setup(SetupKeys):
    """Everything about a case except the clearance and the load.

    Attributes
    ----------
    hole_radius, outer_ratio : float
        R_i in mm, and the plate's outer radius over it, which sets the additive constant of the
        penetration, because a 2-D body has no absolute approach.
    E, nu : float
        Young's modulus as in `Material`, in MPa or with its unit, and Poisson's ratio, in plane
        strain at most 0.499999.
    plane : {"strain", "stress"}
        Plane state.
    load_on : {"pin", "disc", "centre"}
        Where the load acts: all over the pin, on a disc at its centre, or at the centre node.
    disc_ratio : float
        Radius of that disc over the radius of the pin.
    clamp : {"upper half", "rim"} or Sector
        The part of the plate's outer boundary that is fixed: the half that the pin is pushed
        towards, or as in a `Housing` all of it or a sector, "pulled:60" for short. A sector ends at
        the node next to its angle; the cells are graded to its end, unless that is in front of
        where contact may extend.
    cells : int
        Number of cells over the half-width of the contact at the smallest load.
    size, contact_size : float, optional
        Length of the smallest cells in mm, in place of `cells`, and of the largest in the contact.
    pin_E, pin_nu : float, optional
        Those of the pin, by default the plate's.

    Raises
    ------
    InputError
        If a value is out of its range.

    Examples
    --------
    An aluminium pin in a steel plate:

    >>> steel = {"hole_radius": 2.245, "outer_ratio": 3.4, "E": 207e3, "nu": 0.3}
    >>> for setup in (Setup(**steel), Setup(**steel, pin_E="70 GPa", pin_nu=0.33)):
    ...     print(f"{setup.half_width(1.0, 20.0):.4f} mm")
    0.0250 mm
    0.0349 mm
    """

    def __init__(self, **keys: Any) -> None:
        parse_spec(SetupKeys, keys, "finite elements")  # its errors are ours
        super().__init__(**keys)
        for body in get_args(BodyName):
            self.material(body)  # which judges E
        for key in ("nu", "pin_nu"):
            nu = getattr(self, key)
            fits = self.plane == "stress" or nu is None or nu <= _LARGEST_NU
            rule = f"must not exceed {_LARGEST_NU:g} in plane strain: the stiffness of an "
            rule += "incompressible body is infinite"
            remedy = "use 0.4999, or laws.Conformal(), which takes 0.5"
            require(fits, "finite elements", key, nu, rule, remedy)

    @property
    def outer_radius(self) -> float:
        """The plate's outer radius in mm."""
        return self.outer_ratio * self.hole_radius

    def material(self, of: BodyName) -> Material:
        """Return the material of a body."""
        E = self.E if of == "plate" or self.pin_E is None else self.pin_E
        nu = self.nu if of == "plate" or self.pin_nu is None else self.pin_nu
        return Material(of, E, nu)

    def equivalent(self, of: BodyName) -> tuple[float, float]:
        """Return E (MPa) and ν of a body for which plane strain is equivalent to the state `plane`.

        Plane stress is equivalent to plane strain with E' = E(1 + 2ν)/(1 + ν)² and ν' = ν/(1 + ν).
        """
        material = self.material(of)
        E, nu = float(material.E), float(material.nu)
        if self.plane == "strain":
            return E, nu
        return E * (1 + 2 * nu) / (1 + nu) ** 2, nu / (1 + nu)

    def pair(self, dR: float) -> CylinderPair:
        """Return the pair of cylinders."""
        plate, pin = self.material("plate"), self.material("pin")
        return CylinderPair.from_dR(
            "internal", dR, R_i=self.hole_radius, pin=pin, hole=plate, plane=self.plane
        )

    @property
    def clamp_end(self) -> float | None:
        """Where a clamped sector ends, in radians from the top."""
        if not isinstance(self.clamp, Sector):
            return None
        half = np.radians(self.clamp.angle) / 2
        return float(half if self.clamp.side == "pushed" else np.pi - half)

    def half_width(self, dR: float, load: float) -> float:
        """Return the half-width of the contact in mm by the reference law, to grade the mesh."""
        pair = self.pair(dR)
        radius = np.sqrt(self.hole_radius * (self.hole_radius - dR))
        return float(np.radians(Conformal().contact_angle(load, pair)) * radius)

    def require_room(self, dR: float) -> None:
        """Raise `InputError` for a clearance that is not positive or leaves no pin."""
        rule = f"must lie between 0 and the radius of the hole, {self.hole_radius:g} mm"
        remedy = "give the radial clearance in mm"
        require(0 < dR < self.hole_radius, "finite elements", "dR", dR, rule, remedy)

    def mesh(
        self,
        dR: float,
        loads: Sequence[float] | FloatArray,
        plate: PlateMesher | None = None,
        eighths: int = 3,
    ) -> Mesh:
        """Return the mesh of one clearance for all its loads.

        `plate` meshes another outline; pairs of nodes extend to 45° and `eighths` of 90° more.

        Raises
        ------
        InputError
            If the clearance leaves no pin, or the cells are too large for the narrowest contact.
        """
        self.require_room(dR)
        narrow, wide = (self.half_width(dR, float(f)) for f in (min(loads), max(loads)))
        if self.size is None:
            share = 1.44 / self.cells
            grading = Grading(narrow / self.cells, 1.1 * narrow, 1 + share, share)
        else:
            needed = narrow / _FEWEST_CELLS
            rule = f"is too coarse: at ΔR = {dR:g} mm and {min(loads):g} N/mm the contact's "
            rule += f"half-width is {narrow:.3g} mm, and {_FEWEST_CELLS} cells must fit into it"
            remedy = f"use {needed:.2g} mm or less, or give cells instead"
            require(self.size <= needed, "finite elements", "size", self.size, rule, remedy)
            even = min(1.1 * narrow, _EVEN_CELLS * self.size)
            fine = np.inf if self.contact_size is None else self.contact_size
            grading = Grading(self.size, even, _GROWTH, _LARGEST, fine, 1.1 * wide)
        return _mesh(self, dR, grading, plate or _plate, eighths)


# --- the mesh ------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Body:
    """One body's mesh."""

    points: FloatArray  # (N, 2), the nodes in mm
    quads: IndexArray  # (M, 4), the nodes of each cell, counter-clockwise
    surface: IndexArray  # nodes of the contact surface, from the top
    axis: IndexArray  # nodes on the symmetry axis


@dataclass(frozen=True, eq=False)
class Pairs:
    """The pairs of nodes that may touch: the first `count` of both surfaces."""

    count: int
    normals: FloatArray  # (m, 2), unit vectors out of the pin, from the hole's centre
    gap: FloatArray  # mm, when the pin just touches the top; zero for the first pair
    length: FloatArray  # mm, the length of surface that each pair represents
    arc: FloatArray  # mm, from the top along the hole's surface


@dataclass(frozen=True, eq=False)
class Mesh:
    """A pin with its centre at (0, ΔR), a plate with a hole, and the pairs between them."""

    plate: Body
    pin: Body
    centre: int  # the node at the centre of the pin
    outer: IndexArray  # nodes on the outer boundary of the plate, from the top
    pairs: Pairs

    @property
    def cells(self) -> int:
        """Number of quads."""
        return len(self.plate.quads) + len(self.pin.quads)


@dataclass(frozen=True)
class Grading:
    """How the lengths of cells grow away from the middle of the contact."""

    size: float  # mm, of the cells at the middle
    even: float  # mm, the length of surface with cells of that size
    growth: float  # the ratio of neighbours beyond it, at least 1
    largest: float  # of all cells, in radii of the body
    fine: float = np.inf  # mm, of the cells along the first `reach` of the surface
    reach: float = 0.0  # mm


# From the set-up, the angles of the first nodes on the hole and the grading away from them: the
# plate, and the nodes on its outer boundary.
PlateMesher = Callable[[Setup, FloatArray, Grading], tuple[Body, IndexArray]]


def _mesh(setup: Setup, dR: float, grading: Grading, plate_of: PlateMesher, eighths: int) -> Mesh:
    """Mesh a pin in a hole."""
    pin_radius = setup.hole_radius - dR
    # The pin's angles from 0 to 45°, and a multiple of 8 intervals from 45° to 135°.
    top = graded(_QUARTER * pin_radius, grading, pin_radius) / pin_radius
    eighth = int(np.ceil(_QUARTER / 4 / (top[-1] - top[-2])))
    right = np.linspace(_QUARTER, 3 * _QUARTER, 8 * eighth + 1)
    inwards = replace(grading, even=0.0)
    depth = graded((1 - _CORE) * pin_radius, inwards, pin_radius)
    pin, centre = _pin(pin_radius, dR, top, right, depth / depth[-1])
    # By default they extend to 79°; contact of bodies of one material in a plate stays below 85°.
    facing = np.concatenate([top, right[1 : eighths * eighth + 1]])
    rays = np.arctan2(pin_radius * np.sin(facing), dR + pin_radius * np.cos(facing))
    plate, outer = plate_of(setup, rays, inwards)
    return Mesh(plate, pin, centre, outer, _pairs(plate, pin, setup.hole_radius, facing.size))


def graded(length: float, grading: Grading, radius: float) -> FloatArray:
    """Return points from 0 to `length` with distances that grow from the grading's size.

    All distances are reduced slightly so that the last point is at `length`.

    >>> print(graded(1.0, Grading(size=0.1, even=0.0, growth=1.5, largest=0.3), 1.0).round(3))
    [0.    0.093 0.233 0.442 0.721 1.   ]
    """
    points, size = [0.0], grading.size
    while points[-1] < length:
        if len(points) > _MOST_CELLS:
            rule = f"more than {_MOST_CELLS} cells lie side by side"
            remedy = "give fewer cells, or a larger size or contact_size"
            raise InputError("finite elements", "mesh", None, rule, remedy)
        points.append(points[-1] + size)
        if points[-1] >= grading.even:
            cap = grading.fine if points[-1] < grading.reach else np.inf
            size = max(size, min(size * grading.growth, grading.largest * radius, cap))
    return np.array(points) * (length / points[-1])


def _plate(setup: Setup, rays: FloatArray, grading: Grading) -> tuple[Body, IndexArray]:
    """Mesh the plate, a ring with `rays` as its first angles, and return its outer nodes too."""
    radius, clamp_end = setup.hole_radius, setup.clamp_end
    width = setup.outer_radius - radius
    onwards = replace(grading, size=(rays[-1] - rays[-2]) * radius)
    outwards = replace(grading, largest=2 * grading.largest)
    if clamp_end is None:
        r = radius + graded(width, outwards, radius)
    else:
        edge = replace(grading, size=_EDGE * radius, even=0.0)
        inner = graded(width / 2, replace(outwards, largest=grading.largest), radius)
        r = radius + np.append(inner, width - graded(width / 2, edge, radius)[-2::-1])
    if clamp_end is not None and clamp_end > rays[-1]:
        middle, rest = (clamp_end - rays[-1]) / 2, np.pi - clamp_end
        before = graded(middle * radius, onwards, radius) / radius
        to_end, after = (graded(a * radius, edge, radius) / radius for a in (middle, rest))
        before = np.append(rays[-1] + before[1:], clamp_end - to_end[-2::-1])
        theta = np.concatenate([rays, before, clamp_end + after[1:]])
    else:
        to_side = graded((np.pi / 2 - rays[-1]) * radius, onwards, radius) / radius
        # One node is exactly at the end of the upper half of the boundary.
        below = np.linspace(np.pi / 2, np.pi, int(np.ceil(np.pi / 2 / grading.largest)) + 1)
        theta = np.concatenate([rays, rays[-1] + to_side[1:-1], below])
    points = polar(r[:, None], theta[None, :])
    nodes = np.arange(r.size * theta.size).reshape(r.size, theta.size)
    # θ runs clockwise, so with r outwards the corners turn counter-clockwise in this order.
    axis = np.concatenate([nodes[:, 0], nodes[:, -1]])
    return Body(points.reshape(-1, 2), quads_of(nodes), nodes[0], axis), nodes[-1]


def _pin(
    radius: float, dR: float, top: FloatArray, right: FloatArray, depth: FloatArray
) -> tuple[Body, int]:
    """Mesh the pin: layers between its surface and a square core, and the core.

    `depth` runs from 0 at the surface to 1 at the core. Returned is the node at the centre too.
    """
    bottom = np.linspace(3 * _QUARTER, np.pi, top.size)
    theta = np.concatenate([top, right[1:], bottom[1:]])
    surface = polar(np.array(radius), theta)
    reach = np.maximum(np.abs(np.cos(theta)), np.abs(np.sin(theta)))
    around = surface * (_CORE / reach)[:, None]
    layers = surface + depth[:, None, None] * (around - surface)
    ring = np.arange(depth.size * theta.size).reshape(depth.size, theta.size)
    # The rows of the core run from its top to its bottom side, its columns outwards.
    rows, columns = right.size, top.size
    upper, lower = around[:columns, 0], around[-columns:, 0][::-1]
    height = around[columns - 1 : columns - 1 + rows, 1]
    share = ((height[0] - height) / (height[0] - height[-1]))[:, None]
    x = upper + share * (lower - upper)
    core = np.full((rows, columns), -1, dtype=np.intp)
    inner = ring[-1]
    core[0], core[-1] = inner[:columns], inner[-columns:][::-1]
    core[:, -1] = inner[columns - 1 : columns - 1 + rows]
    own = core < 0
    core[own] = ring.size + np.arange(np.count_nonzero(own))
    filling = np.stack([x, np.broadcast_to(height[:, None], x.shape)], axis=-1)[own]
    points = np.concatenate([layers.reshape(-1, 2), filling]) + np.array([0.0, dR])
    quads = np.concatenate([quads_of(ring[::-1]), quads_of(core[::-1])])
    axis = np.unique(np.concatenate([ring[:, 0], ring[:, -1], core[:, 0]]))
    return Body(points, quads, ring[0], axis), int(core[rows // 2, 0])


def _pairs(plate: Body, pin: Body, radius: float, count: int) -> Pairs:
    """Return the pairs of nodes that face each other."""
    hole, facing = plate.points[plate.surface[:count]], pin.points[pin.surface[:count]]
    # The pin touches the top exactly, without rounding error.
    gap = np.concatenate([[0.0], radius - np.hypot(facing[1:, 0], facing[1:, 1])])
    pieces = np.hypot(*np.diff(hole, axis=0).T)
    length = np.zeros(count)
    length[:-1] += pieces / 2
    length[1:] += pieces / 2
    arc = radius * np.arctan2(hole[:, 0], hole[:, 1])
    return Pairs(count, hole / radius, gap, length, arc)


def polar(r: FloatArray, theta: FloatArray) -> FloatArray:
    """Return points at r and θ, θ from the top."""
    r, theta = np.broadcast_arrays(r, theta)
    points = np.stack([r * np.sin(theta), r * np.cos(theta)], axis=-1)
    # sin π and cos π/2 are not zero in floating point; put points of the axes exactly on them.
    return np.where(np.abs(points) < 1e-12 * r[..., None], 0.0, points)


def quads_of(nodes: IndexArray) -> IndexArray:
    """Return the cells of a block of nodes with rows outwards and columns clockwise."""
    corners = (nodes[:-1, :-1], nodes[:-1, 1:], nodes[1:, 1:], nodes[1:, :-1])
    return np.stack([corner.ravel() for corner in corners], axis=-1)
