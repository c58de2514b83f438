"""A pin in a hole by finite elements: one factorisation for all loads of a clearance.

Both bodies are linear elastic, and their frictionless contact is condensed to the pairs of nodes
that may touch. With the pin's centre at depth δ, forces λ ≥ 0 between pairs open them by Cλ, where
C is the sum of the compliances of both bodies. The applied load opens them by c·f. The gaps are

    g = g₀ + C·λ + c·f − δ·cos θ ≥ 0,    λ ≥ 0,    λᵀg = 0,    Σ λcos θ = f/2,

with half of the load f because the model is one half. For a given set of touching pairs this is a
small linear system. Pairs in tension are removed from the set and overlapping pairs are added,
until the set does not change.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from cylcontact.datasets.finite_element.mesh import Body, BodyName, Mesh, Setup
from cylcontact.laws import Sector
from cylcontact.support.arrays import BoolArray, FloatArray, IndexArray, as_floats, require
from cylcontact.support.errors import InputError

# Above this ν the plain bilinear quad is too stiff, without limit as ν approaches 0.5. At 0.4 it
# costs 0.1 % of the penetration with 16 cells over the half-width, as much as the mesh does anyway.
LOCKS_FROM = 0.4
# One point of quadrature, at the middle of a cell.
_MIDDLE = (np.array([[0.5], [0.5]]), np.array([1.0]))
# The set of touching pairs converges within about ten rounds on all meshes tried, from so many.
_ROUNDS, _FIRST = 100, 5


# --- a solution ----------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Stress:
    """Stresses at the middle of each cell, in MPa, shape (M,).

    Attributes
    ----------
    xx, yy, xy, zz : array of float
        The components; y is the direction of the load.
    """

    xx: FloatArray
    yy: FloatArray
    xy: FloatArray
    zz: FloatArray

    @property
    def von_mises(self) -> FloatArray:
        """The equivalent stress in MPa."""
        differences = (self.xx - self.yy) ** 2 + (self.yy - self.zz) ** 2 + (self.zz - self.xx) ** 2
        return as_floats(np.sqrt(differences / 2 + 3 * self.xy**2))


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
        E, nu = self.setup.equivalent(of)
        basis = _basis(getattr(self.mesh, of), quadrature=_MIDDLE)
        gradient = np.asarray(basis.interpolate(getattr(self, of).ravel()).grad)[..., 0]
        xx, yy = gradient[0, 0], gradient[1, 1]
        mu, lame = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
        volume = lame * (xx + yy)
        zz = volume if self.setup.plane == "strain" else np.zeros_like(volume)
        shear = mu * (gradient[0, 1] + gradient[1, 0])
        return Stress(volume + 2 * mu * xx, volume + 2 * mu * yy, shear, zz)

    def stress_below(self, of: BodyName) -> tuple[FloatArray, Stress]:
        """Return depths below the middle of the contact in mm, increasing, and stresses there.

        Parameters
        ----------
        of : {"plate", "pin"}
            The body.

        Returns
        -------
        depth : array of float, shape (k,)
        stress : Stress, shape (k,)
            At the middles of the cells along the line of the load.

        Examples
        --------
        >>> setup = Setup(hole_radius=10.0, outer_ratio=5.0, E=207e3, nu=0.3, cells=8)
        >>> (case,) = solve(setup, 0.1, [1.0])
        >>> depth, stress = case.stress_below("plate")
        >>> deepest = depth[stress.von_mises.argmax()] / case.half_width
        >>> print(f"the von Mises stress is largest {deepest:.1f} half-widths below")
        the von Mises stress is largest 0.7 half-widths below
        """
        body: Body = getattr(self.mesh, of)
        corners = body.points[body.quads]
        away = corners.mean(axis=1)[:, 1] - self.setup.hole_radius
        depth = away if of == "plate" else -away
        chosen = np.flatnonzero((corners[:, :, 0].min(axis=1) == 0) & (depth > 0))
        chosen = chosen[np.argsort(depth[chosen])]
        stress = self.stress(of)
        return depth[chosen], Stress(*(getattr(stress, f.name)[chosen] for f in fields(Stress)))


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
    held = clamped_nodes(setup, mesh)
    at = condense(setup, dR, mesh, np.concatenate([2 * held, 2 * held + 1]))
    return [at(load) for load in applied.tolist()]


def condense(setup: Setup, dR: float, mesh: Mesh, held: IndexArray) -> Callable[[float], Solution]:
    """Return what solves one load on a mesh; `held` are the plate's fixed degrees of freedom."""
    pairs = mesh.pairs
    on_plate = _displacements(
        mesh.plate,
        setup.equivalent("plate"),
        np.append(2 * mesh.plate.axis, held),
        _pair_forces(mesh, mesh.plate, 1.0),
    )
    pushed = _pair_forces(mesh, mesh.pin, -1.0)
    pushed[1::2, -1] = node_shares(setup, dR, mesh) / 2
    # The pin is fixed at its centre, where the reaction is zero.
    on_pin = _displacements(
        mesh.pin,
        setup.equivalent("pin"),
        np.append(2 * mesh.pin.axis, 2 * mesh.centre + 1),
        pushed,
    )
    opened = _opening(mesh, on_plate, on_pin)

    def at(load: float) -> Solution:
        gap = pairs.gap + opened[:, -1] * load
        touching, depth = touch(opened[:, :-1], gap, pairs.normals[:, 1], load)
        acting = np.append(touching, load)
        pressure = touching / pairs.length
        return Solution(
            setup=setup,
            dR=dR,
            load=load,
            penetration=depth,
            half_width=_edge(pairs.arc, pressure),
            arc=pairs.arc,
            pressure=pressure,
            mesh=mesh,
            plate=(on_plate @ acting).reshape(-1, 2),
            pin=(on_pin @ acting).reshape(-1, 2) + np.array([0.0, depth]),
        )

    return at


# --- elasticity ----------------------------------------------------------------------------------


def _basis(body: Body, vector: bool = True, **quadrature: Any) -> Any:
    """Return scikit-fem's basis of bilinear displacements, or of a number, with a quadrature."""
    import skfem

    points, quads = (np.ascontiguousarray(array.T) for array in (body.points, body.quads))
    element = skfem.ElementQuad1()
    element = skfem.ElementVector(element) if vector else element
    return skfem.Basis(skfem.MeshQuad(points, quads), element, **quadrature)


def _stiffness(body: Body, E: float, nu: float) -> Any:
    """Return the stiffness of a body in plane strain, shape (2N, 2N).

    Plain bilinear quads, and for ν > `LOCKS_FROM` with the mean dilatation of each cell in the
    volumetric part (B-bar; Hughes, Int. J. Numer. Meth. Engng 15 (1980) 1413–1418). In the plane
    that is the dilatation at the cell's middle.
    """
    from skfem import BilinearForm, asm
    from skfem.helpers import div
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    lame, mu = lame_parameters(E, nu)
    full = _basis(body, intorder=3)
    if nu <= LOCKS_FROM:
        return asm(linear_elasticity(lame, mu), full).tocsc()
    volumetric = BilinearForm(lambda u, v, _: lame * div(u) * div(v))
    shear, volume = linear_elasticity(0.0, mu), _basis(body, quadrature=_MIDDLE)
    return (asm(shear, full) + asm(volumetric, volume)).tocsc()


def _displacements(
    body: Body, constants: tuple[float, float], held: IndexArray, forces: FloatArray
) -> FloatArray:
    """Return the displacements in mm under columns of nodal forces in N/mm, node i at 2i, 2i + 1.

    The body has E in MPa and ν, in plane strain; the degrees of freedom `held` do not move.
    """
    from scipy.sparse.linalg import splu

    stiffness = _stiffness(body, *constants)
    free = np.setdiff1d(np.arange(len(forces)), held)
    factors = splu(
        stiffness[free][:, free],
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    displacements = np.zeros_like(forces)
    # SuperLU takes several times as long for all columns at once.
    for column, applied in enumerate(forces[free].T):
        displacements[free, column] = factors.solve(applied)
    return displacements


def clamped_nodes(setup: Setup, mesh: Mesh) -> IndexArray:
    """Return the fixed nodes of the plate's outer boundary."""
    held = mesh.outer
    x, y = mesh.plate.points[held].T
    if isinstance(setup.clamp, Sector):
        end = int(np.abs(np.arctan2(x, y) - setup.clamp_end).argmin())
        return held[: end + 1] if setup.clamp.side == "pushed" else held[end:]
    return held[y >= 0] if setup.clamp == "upper half" else held


def node_shares(setup: Setup, dR: float, mesh: Mesh) -> FloatArray:
    """Return the shares of the load at the nodes of the pin, shape (N,), sum 1."""
    import skfem

    if setup.load_on == "centre":
        return np.where(np.arange(len(mesh.pin.points)) == mesh.centre, 1.0, 0.0)
    radius = np.inf if setup.load_on == "pin" else setup.disc_ratio * (setup.hole_radius - dR)
    x, y = mesh.pin.points[mesh.centre]

    def inside(v: Any, w: Any) -> Any:
        return v * (np.hypot(w.x[0] - x, w.x[1] - y) <= radius)

    basis = _basis(mesh.pin, vector=False, intorder=4)
    shares = np.asarray(skfem.LinearForm(inside).assemble(basis), dtype=np.float64)
    return as_floats(shares / shares.sum())


# --- contact -------------------------------------------------------------------------------------


def _pair_forces(mesh: Mesh, body: Body, sign: float) -> FloatArray:
    """Return the forces on a body of a unit force in each pair, and none: shape (2N, m + 1)."""
    count = mesh.pairs.count
    forces = np.zeros((len(body.points), 2, count + 1))
    forces[body.surface[:count], :, np.arange(count)] = sign * mesh.pairs.normals
    return forces.reshape(-1, count + 1)


def _opening(mesh: Mesh, plate: FloatArray, pin: FloatArray) -> FloatArray:
    """Return by how much columns of displacements open the pairs, shape (m, k)."""
    on_plate, on_pin = (
        moved.reshape(-1, 2, moved.shape[1])[body.surface[: mesh.pairs.count]]
        for body, moved in ((mesh.plate, plate), (mesh.pin, pin))
    )
    return as_floats((mesh.pairs.normals[:, :, None] * (on_plate - on_pin)).sum(axis=1))


def touch(
    compliance: FloatArray, gap: FloatArray, cosines: FloatArray, load: float
) -> tuple[FloatArray, float]:
    """Return the forces λ of the pairs in N/mm and the penetration δ in mm.

    The arguments are C in mm per N/mm, g₀ + c·f in mm, cos θ, and f in N/mm.

    Springs of 1 and 3 N/mm per mm side by side under 8 N/mm, half of which they carry:

    >>> touch(np.diag([1.0, 1 / 3, 1.0]), np.array([0.0, 0.0, 9.0]), np.ones(3), 8.0)
    (array([1., 3., 0.]), 1.0)
    """
    active: BoolArray = np.arange(gap.size) < _FIRST
    for _ in range(_ROUNDS):
        touching = np.flatnonzero(active)
        n = touching.size
        matrix = np.zeros((n + 1, n + 1))
        matrix[:n, :n] = compliance[np.ix_(touching, touching)]
        matrix[:n, n] = matrix[n, :n] = -cosines[touching]
        solution = np.linalg.solve(matrix, np.append(-gap[touching], -load / 2))
        forces, depth = np.zeros(gap.size), float(solution[n])
        forces[touching] = solution[:n]
        gaps = gap + compliance @ forces - depth * cosines
        # The tolerance covers the rounding error of a closed gap.
        changed = np.where(active, forces > 0, gaps < -1e-9 * abs(depth))
        if np.array_equal(changed, active):
            break
        active = changed if changed.any() else ~active
    else:
        rule = f"the set of touching pairs still changes after {_ROUNDS} rounds"
        remedy = "change the number of cells a little, or the clearance"
        raise InputError("finite elements", "load", load, rule, remedy)
    rule = "presses the pin into contact up to the side of the hole, beyond the mesh's pairs"
    require(not active[-1], "finite elements", "load", load, rule, "lower it, or raise dR or E")
    return forces, depth


def _edge(arc: FloatArray, pressure: FloatArray) -> float:
    """Return the edge of the contact in mm: the root of a line fitted to p² over arc².

    Hertz's p² is such a line. It is fitted to the points between 30 and 90 % of the peak, because
    the pressure of the last pair of nodes depends on where between two nodes the contact ends.

    >>> x = np.linspace(0, 1.2, 25)
    >>> print(round(_edge(x, 100 * np.sqrt(np.maximum(1 - x**2, 0))), 12))
    1.0
    """
    share = pressure / pressure.max()
    flank = (share > 0.3) & (share < 0.9)
    slope, level = np.polyfit(arc[flank] ** 2, pressure[flank] ** 2, 1)
    square = -level / slope
    return float(np.sqrt(square)) if square > 0 else np.nan
