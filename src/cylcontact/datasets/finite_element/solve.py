"""The embedded solver: one factorisation for all loads of a clearance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from cylcontact.arrays import FloatArray
from cylcontact.datasets.finite_element.contact import Condensed
from cylcontact.datasets.finite_element.elasticity import (
    Elastic,
    Stress,
    factorise,
    spread_load,
    stress_of,
)
from cylcontact.datasets.finite_element.mesh import Body, IntArray, Mesh
from cylcontact.datasets.finite_element.setup import BodyName, Setup
from cylcontact.laws import Sector

__all__ = ["Solution", "clamped_nodes", "node_shares", "solve"]


@dataclass(frozen=True, eq=False)
class Solution:
    """The solution of one case.

    Attributes
    ----------
    setup : Setup
        The set-up.
    dR, load : float
        Clearance in mm and load in N/mm.
    penetration : float
        Displacement of the pin's centre from first touch in mm.
    half_width : float
        Half-width of the contact in mm, from Hertz's ellipse through the flank of the pressure:
        within 1 % of the reference law's up to f/(E*·ΔR) = 0.3, and 3 % low at 3. NaN in thin eyes,
        where the pressure does not fall like an ellipse.
    arc, pressure : array of float
        Distance from the top along the hole in mm and contact pressure in MPa, at the pairs of
        nodes that may touch.
    mesh : Mesh
        The mesh.
    plate, pin : array of float, shape (N, 2)
        Displacements of the nodes in mm.
    """

    setup: Setup
    dR: float
    load: float
    penetration: float
    half_width: float
    arc: FloatArray
    pressure: FloatArray
    mesh: Mesh
    plate: FloatArray
    pin: FloatArray

    @property
    def peak_pressure(self) -> float:
        """The pressure on the axis in MPa."""
        return float(self.pressure[0])

    def stress(self, of: BodyName) -> Stress:
        """Return the stresses at the middle of each cell of a body."""
        body, displacements = self._body(of)
        return stress_of(body, displacements, self.setup, of)

    def stress_below(self, of: BodyName) -> tuple[FloatArray, Stress]:
        """Return the stresses below the middle of the contact, by depth.

        Parameters
        ----------
        of : {"plate", "pin"}
            The body.

        Returns
        -------
        depth : array of float, shape (k,)
            Distance from the contact surface along the line of the load in mm, increasing.
        stress : Stress
            Shape (k,), at the middles of the cells that touch this line.

        Examples
        --------
        >>> setup = Setup(hole_radius=10.0, outer_ratio=5.0, E=207e3, nu=0.3)
        >>> (case,) = solve(setup, 0.1, [1.0])
        >>> depth, stress = case.stress_below("plate")
        >>> deepest = depth[stress.von_mises.argmax()] / case.half_width
        >>> print(f"the von Mises stress is largest {deepest:.1f} half-widths below")
        the von Mises stress is largest 0.7 half-widths below
        """
        body, _ = self._body(of)
        corners = body.points[body.quads]
        middles = corners.mean(axis=1)
        top = self.setup.hole_radius
        depth = middles[:, 1] - top if of == "plate" else top - middles[:, 1]
        chosen = np.flatnonzero((corners[:, :, 0].min(axis=1) == 0) & (depth > 0))
        chosen = chosen[np.argsort(depth[chosen])]
        stress = self.stress(of)
        return depth[chosen], Stress(*(getattr(stress, f.name)[chosen] for f in fields(Stress)))

    def _body(self, of: BodyName) -> tuple[Body, FloatArray]:
        """Return the mesh of a body and the displacements of its nodes."""
        return (self.mesh.plate, self.plate) if of == "plate" else (self.mesh.pin, self.pin)


def solve(setup: Setup, dR: float, loads: Sequence[float] | FloatArray) -> list[Solution]:
    """Solve one clearance for all its loads.

    Parameters
    ----------
    setup : Setup
        The set-up.
    dR : float
        Clearance in mm.
    loads : sequence of float
        In N/mm.

    Returns
    -------
    list of Solution
        One for each load.

    Raises
    ------
    InputError
        If the clearance leaves no pin, the mesh is too coarse or the contact does not settle.

    Examples
    --------
    >>> from cylcontact import limits
    >>> setup = Setup(hole_radius=2.245, outer_ratio=3.4, E=207e3, nu=0.3, cells=8)
    >>> (case,) = solve(setup, 1.0, [20.0])
    >>> hertz = limits.hertz_stress(20.0, setup.pair(1.0))
    >>> print(f"{case.penetration * 1e3:.2f} µm, {case.peak_pressure / hertz:.3f} of Hertz")
    0.57 µm, 1.001 of Hertz
    """
    applied = np.asarray(loads, dtype=np.float64)
    mesh = setup.mesh(dR, applied)
    count = mesh.pairs.count
    plate, pin = _factorised(setup, mesh)
    on_plate = plate.solve(_pair_forces(mesh, plate.size, mesh.plate.surface, 1.0))
    forces = _pair_forces(mesh, pin.size, mesh.pin.surface, -1.0)
    weight = np.zeros(pin.size)
    weight[1::2] = node_shares(setup, dR, mesh) / 2
    on_pin = pin.solve(np.column_stack([forces, weight]))
    problem = Condensed(
        compliance=_opening(mesh, on_plate, on_pin[:, :count]),
        load_opening=_opening(mesh, np.zeros((plate.size, 1)), on_pin[:, count:])[:, 0],
        cosines=mesh.pairs.normals[:, 1],
        gap=mesh.pairs.gap,
    )
    solutions = []
    for load in applied.tolist():
        touching, depth = problem.touch(load)
        moved = on_pin @ np.append(touching, load)
        pressure = touching / mesh.pairs.length
        solutions.append(
            Solution(
                setup=setup,
                dR=dR,
                load=load,
                penetration=depth,
                half_width=_edge(mesh.pairs.arc, pressure),
                arc=mesh.pairs.arc,
                pressure=pressure,
                mesh=mesh,
                plate=(on_plate @ touching).reshape(-1, 2),
                pin=moved.reshape(-1, 2) + np.array([0.0, depth]),
            )
        )
    return solutions


def clamped_nodes(setup: Setup, mesh: Mesh) -> IntArray:
    """Return the fixed nodes of the plate's outer boundary."""
    held: IntArray = mesh.outer
    if setup.clamp == "upper half":
        held = held[mesh.plate.points[held, 1] >= 0]
    elif isinstance(setup.clamp, Sector):
        x, y = mesh.plate.points[held].T
        theta = np.arctan2(x, y)
        end = int(np.abs(theta - setup.clamp_end).argmin())
        held = held[: end + 1] if setup.clamp.side == "near" else held[end:]
    return held


def node_shares(setup: Setup, dR: float, mesh: Mesh) -> FloatArray:
    """Return the shares of the load at the nodes of the pin, shape (N,), sum 1."""
    if setup.load_on == "centre":
        shares = np.zeros(len(mesh.pin.points))
        shares[mesh.centre] = 1.0
        return shares
    radius = np.inf if setup.load_on == "pin" else setup.disc_ratio * (setup.hole_radius - dR)
    return spread_load(mesh.pin, mesh.pin.points[mesh.centre], radius)


def _edge(arc: FloatArray, pressure: FloatArray) -> float:
    """Return the edge of the contact in mm: the root of a line fitted to p² over arc².

    Hertz's p² is such a line. It is fitted to the points between 30 and 90 % of the peak, because
    the pressure of the last pair of nodes depends on where between two nodes the contact ends.

    Examples
    --------
    >>> x = np.linspace(0, 1.2, 25)
    >>> print(round(_edge(x, 100 * np.sqrt(np.maximum(1 - x**2, 0))), 12))
    1.0
    """
    share = pressure / pressure.max()
    flank = (share > 0.3) & (share < 0.9)
    slope, level = np.polyfit(arc[flank] ** 2, pressure[flank] ** 2, 1)
    square = -level / slope
    return float(np.sqrt(square)) if square > 0 else np.nan


def _factorised(setup: Setup, mesh: Mesh) -> tuple[Elastic, Elastic]:
    """Factorise plate and pin; the pin is fixed at its centre, where the reaction is zero."""
    held = clamped_nodes(setup, mesh)
    plate = np.concatenate([2 * mesh.plate.axis, 2 * held, 2 * held + 1])
    pin = np.append(2 * mesh.pin.axis, 2 * mesh.centre + 1)
    return (
        factorise(mesh.plate, *setup.equivalent("plate"), plate),
        factorise(mesh.pin, *setup.equivalent("pin"), pin),
    )


def _pair_forces(mesh: Mesh, size: int, surface: IntArray, sign: float) -> FloatArray:
    """Return the nodal forces of a unit force in each pair, shape (size, m)."""
    pairs = mesh.pairs
    nodes, each = surface[: pairs.count], np.arange(pairs.count)
    forces = np.zeros((size, pairs.count))
    forces[2 * nodes, each] = sign * pairs.normals[:, 0]
    forces[2 * nodes + 1, each] = sign * pairs.normals[:, 1]
    return forces


def _opening(mesh: Mesh, plate: FloatArray, pin: FloatArray) -> FloatArray:
    """Return by how much displacements open the pairs, shape (m, k)."""
    pairs = mesh.pairs
    opened = np.zeros((pairs.count, pin.shape[1]))
    for axis in (0, 1):
        on_plate = plate[2 * mesh.plate.surface[: pairs.count] + axis]
        on_pin = pin[2 * mesh.pin.surface[: pairs.count] + axis]
        opened += pairs.normals[:, axis, None] * (on_plate - on_pin)
    return opened
