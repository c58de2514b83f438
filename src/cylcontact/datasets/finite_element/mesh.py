"""Meshes of half a pin in a hole: structured four-node quads, graded towards the contact.

The symmetry axis is x = 0. The contact is at the top, and θ is measured from there. The origin is
the hole's centre and the pin touches the top of the hole, so the pin's centre is at y = ΔR. The
plate is a ring of polar cells. The pin is a square core with three blocks around it, so that no
cell degenerates at its centre. As far as contact can extend, both surfaces have their nodes on the
same rays from the hole's centre, so contact is between pairs of nodes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cylcontact.arrays import FloatArray
from cylcontact.errors import InputError

__all__ = ["Body", "Grading", "IntArray", "Mesh", "Pairs", "make_mesh"]

IntArray = NDArray[np.intp]

# Half-width of the pin's square core, in radii.
_CORE = 0.35
_QUARTER = np.pi / 4
# The smallest cells at the end of a clamp, in radii of the hole.
_EDGE = 0.001
# 200 cells over the half-width of the narrowest real contact need some 3000.
_MOST_CELLS = 5000


@dataclass(frozen=True, eq=False)
class Body:
    """One body's mesh.

    Attributes
    ----------
    points : array of float, shape (N, 2)
        Nodes in mm.
    quads : array of int, shape (M, 4)
        Nodes of each cell, counter-clockwise.
    surface : array of int, shape (k,)
        Nodes of the contact surface, from the top.
    axis : array of int
        Nodes on the symmetry axis.
    """

    points: FloatArray
    quads: IntArray
    surface: IntArray
    axis: IntArray


@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of nodes that may touch: the first `count` of both surfaces.

    Attributes
    ----------
    count : int
        The number of pairs m.
    normals : array of float, shape (m, 2)
        Unit vectors out of the pin, from the hole's centre through each pair.
    gap : array of float, shape (m,)
        Distance in mm when the pin just touches the top; zero for the first pair.
    length : array of float, shape (m,)
        Length of surface in mm represented by each pair.
    arc : array of float, shape (m,)
        Distance from the top along the hole's surface in mm.
    """

    count: int
    normals: FloatArray
    gap: FloatArray
    length: FloatArray
    arc: FloatArray


@dataclass(frozen=True, eq=False)
class Mesh:
    """A pin, a plate with a hole, and the pairs of nodes between them.

    Attributes
    ----------
    plate, pin : Body
        The pin's centre is at (0, ΔR).
    centre : int
        Node at the centre of the pin.
    outer : array of int
        Nodes on the outer boundary of the plate, from the top.
    pairs : Pairs
        Pairs of nodes that may touch.
    """

    plate: Body
    pin: Body
    centre: int
    outer: IntArray
    pairs: Pairs

    @property
    def cells(self) -> int:
        """Number of quads."""
        return len(self.plate.quads) + len(self.pin.quads)


@dataclass(frozen=True)
class Grading:
    """Growth of the lengths of cells away from the middle of the contact.

    Attributes
    ----------
    size : float
        Length of the cells at the middle of the contact in mm.
    even : float
        Length of surface in mm with cells of that length.
    growth : float
        Ratio of the lengths of neighbouring cells beyond it, at least 1.
    largest : float
        Largest length of a cell, in radii of its body.
    fine : float
        Largest length of a cell in mm along the first `reach` of the surface.
    reach : float
        Length of surface in mm.
    """

    size: float
    even: float
    growth: float
    largest: float
    fine: float = np.inf
    reach: float = 0.0


def _graded(length: float, grading: Grading, radius: float = 1.0) -> FloatArray:
    """Return points from 0 to `length` with distances that grow from the grading's size.

    Parameters
    ----------
    length : float
        The last point, in mm.
    grading : Grading
        All distances are reduced slightly so that the last point is at `length`.
    radius : float
        Radius of the body in mm.

    Returns
    -------
    array of float
        In mm.

    Examples
    --------
    >>> print(_graded(1.0, Grading(size=0.1, even=0.0, growth=1.5, largest=0.3)).round(3))
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


def make_mesh(
    hole_radius: float,
    dR: float,
    outer_radius: float,
    grading: Grading,
    clamp_end: float | None = None,
) -> Mesh:
    """Mesh a pin in a hole.

    Parameters
    ----------
    hole_radius, dR, outer_radius : float
        R_i, ΔR and the plate's outer radius in mm.
    grading : Grading
        The lengths of the cells.
    clamp_end : float, optional
        An angle in radians from the top where the boundary begins to be free or held.

    Returns
    -------
    Mesh

    Examples
    --------
    >>> mesh = make_mesh(2.245, 0.1, 7.184, Grading(0.01, 0.08, 1.15, 0.12))
    >>> mesh.pin.points[mesh.centre].round(12).tolist(), mesh.pairs.gap[0].round(12).item()
    ([0.0, 0.1], 0.0)
    """
    pin_radius = hole_radius - dR
    top, right = _pin_angles(pin_radius, grading)
    inwards = replace(grading, even=0.0)
    depth = _graded((1 - _CORE) * pin_radius, inwards, pin_radius)
    pin, centre = _pin(pin_radius, dR, top, right, depth / depth[-1])
    # The pairs extend to 79°; contact of bodies of one material stays below 85° at any load.
    facing = np.concatenate([top, right[1 : 3 * (right.size // 8) + 1]])
    rays = np.arctan2(pin_radius * np.sin(facing), dR + pin_radius * np.cos(facing))
    plate, outer = _plate(hole_radius, outer_radius, rays, inwards, clamp_end)
    return Mesh(plate, pin, centre, outer, _pairs(plate, pin, hole_radius, facing.size))


def _pin_angles(radius: float, grading: Grading) -> tuple[FloatArray, FloatArray]:
    """Return the pin's angles from 0 to 45°, and a multiple of 8 intervals from 45° to 135°."""
    top = _graded(_QUARTER * radius, grading, radius) / radius
    eighths = int(np.ceil(_QUARTER / 4 / (top[-1] - top[-2])))
    return top, np.linspace(_QUARTER, 3 * _QUARTER, 8 * eighths + 1)


def _plate(
    radius: float,
    outer_radius: float,
    rays: FloatArray,
    grading: Grading,
    clamp_end: float | None,
) -> tuple[Body, IntArray]:
    """Mesh the plate, a ring with `rays` as its first angles."""
    onwards = replace(grading, size=(rays[-1] - rays[-2]) * radius)
    to_side = _graded((np.pi / 2 - rays[-1]) * radius, onwards, radius) / radius
    below = np.linspace(np.pi / 2, np.pi, int(np.ceil(np.pi / 2 / grading.largest)) + 1)
    # One node is exactly at the end of the upper half of the boundary.
    theta = np.concatenate([rays, rays[-1] + to_side[1:-1], below])
    outwards = replace(grading, largest=2 * grading.largest)
    r = radius + _graded(outer_radius - radius, outwards, radius)
    if clamp_end is not None:
        edge = replace(grading, size=_EDGE * radius, even=0.0)
        half = (outer_radius - radius) / 2
        inner = _graded(half, replace(outwards, largest=grading.largest), radius)
        r = radius + np.append(inner, 2 * half - _graded(half, edge, radius)[-2::-1])
        if clamp_end > rays[-1]:
            middle, rest = (clamp_end - rays[-1]) / 2, np.pi - clamp_end
            before = _graded(middle * radius, onwards, radius) / radius
            to_end, after = (_graded(a * radius, edge, radius) / radius for a in (middle, rest))
            before = np.append(rays[-1] + before[1:], clamp_end - to_end[-2::-1])
            theta = np.concatenate([rays, before, clamp_end + after[1:]])
    points = _polar(r[:, None], theta[None, :])
    nodes = np.arange(points.shape[0] * points.shape[1]).reshape(points.shape[:2])
    # θ runs clockwise, so with r outwards the corners turn counter-clockwise in this order.
    quads = _quads(nodes)
    axis = np.concatenate([nodes[:, 0], nodes[:, -1]])
    return Body(points.reshape(-1, 2), quads, nodes[0], axis), nodes[-1]


def _pin(
    radius: float, dR: float, top: FloatArray, right: FloatArray, depth: FloatArray
) -> tuple[Body, int]:
    """Mesh the pin: layers between its surface and a square core, and the core.

    `depth` runs from 0 at the surface to 1 at the core.
    """
    bottom = np.linspace(3 * _QUARTER, np.pi, top.size)
    theta = np.concatenate([top, right[1:], bottom[1:]])
    surface = _polar(np.array(radius), theta)
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
    quads = np.concatenate([_quads(ring[::-1]), _quads(core[::-1])])
    axis = np.unique(np.concatenate([ring[:, 0], ring[:, -1], core[:, 0]]))
    return Body(points, quads, ring[0], axis), int(core[rows // 2, 0])


def _pairs(plate: Body, pin: Body, radius: float, count: int) -> Pairs:
    """Return the pairs of nodes that face each other."""
    hole, facing = plate.points[plate.surface[:count]], pin.points[pin.surface[:count]]
    normals = hole / radius
    # The pin touches the top exactly, without rounding error.
    gap = np.concatenate([[0.0], radius - np.hypot(facing[1:, 0], facing[1:, 1])])
    pieces = np.hypot(*np.diff(hole, axis=0).T)
    length = np.zeros(count)
    length[:-1] += pieces / 2
    length[1:] += pieces / 2
    arc = radius * np.arctan2(hole[:, 0], hole[:, 1])
    return Pairs(count, normals, gap, length, arc)


def _polar(r: FloatArray, theta: FloatArray) -> FloatArray:
    """Return points at r and θ, θ from the top."""
    r, theta = np.broadcast_arrays(r, theta)
    points = np.stack([r * np.sin(theta), r * np.cos(theta)], axis=-1)
    # sin π and cos π/2 are not zero in floating point; put points of the axes exactly on them.
    return np.where(np.abs(points) < 1e-12 * r[..., None], 0.0, points)


def _quads(nodes: IntArray) -> IntArray:
    """Return the cells of a block of nodes with rows outwards and columns clockwise."""
    corners = (nodes[:-1, :-1], nodes[:-1, 1:], nodes[1:, 1:], nodes[1:, :-1])
    return np.stack([corner.ravel() for corner in corners], axis=-1)
