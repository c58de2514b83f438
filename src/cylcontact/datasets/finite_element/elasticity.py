"""Linear elasticity of one body by scikit-fem: stiffness, factorised once, and stresses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.finite_element.mesh import Body, IntArray
from cylcontact.datasets.finite_element.setup import BodyName, Setup

__all__ = ["LOCKS_FROM", "Elastic", "Stress", "factorise", "spread_load", "stress_of"]

# Above this ν the plain bilinear quad is too stiff, without limit as ν approaches 0.5. At 0.4 it
# costs 0.1 % of the penetration with 16 cells over the half-width, as much as the mesh does anyway.
LOCKS_FROM = 0.4
# One point of quadrature, at the middle of a cell.
_MIDDLE = (np.array([[0.5], [0.5]]), np.array([1.0]))


@dataclass(frozen=True, eq=False)
class Elastic:
    """The factorised stiffness of a supported body.

    Attributes
    ----------
    free : array of int
        Unconstrained degrees of freedom; node i has 2i (x) and 2i + 1 (y).
    factors : object
        Result of `scipy.sparse.linalg.splu`.
    size : int
        Total number of degrees of freedom.
    """

    free: IntArray
    factors: Any
    size: int

    def solve(self, forces: FloatArray) -> FloatArray:
        """Return displacements in mm under columns of nodal forces in N/mm, shape (size, k)."""
        displacements = np.zeros_like(forces)
        # SuperLU takes several times as long for all columns at once.
        for column, applied in enumerate(forces[self.free].T):
            displacements[self.free, column] = self.factors.solve(applied)
        return displacements


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


def _mesh_of(body: Body) -> Any:
    """Return scikit-fem's mesh of a body."""
    import skfem

    points, quads = (np.ascontiguousarray(array.T) for array in (body.points, body.quads))
    return skfem.MeshQuad(points, quads)


def _displacement_basis(body: Body, **quadrature: Any) -> Any:
    """Return scikit-fem's basis of bilinear displacements with a quadrature."""
    import skfem

    return skfem.Basis(_mesh_of(body), skfem.ElementVector(skfem.ElementQuad1()), **quadrature)


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
    full = _displacement_basis(body, intorder=3)
    if nu <= LOCKS_FROM:
        return asm(linear_elasticity(lame, mu), full).tocsc()
    volumetric = BilinearForm(lambda u, v, _: lame * div(u) * div(v))
    shear, volume = linear_elasticity(0.0, mu), _displacement_basis(body, quadrature=_MIDDLE)
    return (asm(shear, full) + asm(volumetric, volume)).tocsc()


def factorise(body: Body, E: float, nu: float, held: IntArray) -> Elastic:
    """Assemble and factorise the stiffness of a body in plane strain.

    Parameters
    ----------
    body : Body
        The mesh.
    E, nu : float
        In MPa and -.
    held : array of int
        Constrained degrees of freedom, with zero displacement.
    """
    from scipy.sparse.linalg import splu

    stiffness = _stiffness(body, E, nu)
    size = stiffness.shape[0]
    free = np.setdiff1d(np.arange(size), held)
    symmetric = {"SymmetricMode": True}
    factors = splu(
        stiffness[free][:, free],
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options=symmetric,
    )
    return Elastic(free, factors, size)


def spread_load(pin: Body, centre: FloatArray, radius: float) -> FloatArray:
    """Return the shares of the nodes in a load spread evenly over a disc, shape (N,), sum 1.

    Parameters
    ----------
    pin : Body
        The mesh.
    centre : array of float, shape (2,)
        The disc's centre in mm.
    radius : float
        Its radius in mm; infinity for the whole pin.
    """
    import skfem

    basis = skfem.Basis(_mesh_of(pin), skfem.ElementQuad1(), intorder=4)

    def inside(v: Any, w: Any) -> Any:
        return v * (np.hypot(w.x[0] - centre[0], w.x[1] - centre[1]) <= radius)

    shares = np.asarray(skfem.LinearForm(inside).assemble(basis), dtype=np.float64)
    return as_floats(shares / shares.sum())


def stress_of(body: Body, displacements: FloatArray, setup: Setup, of: BodyName) -> Stress:
    """Return the stresses of a body.

    Parameters
    ----------
    body : Body
        The mesh.
    displacements : array of float, shape (N, 2)
        Of its nodes, in mm.
    setup : Setup
        For the material and the plane state.
    of : {"plate", "pin"}
        Whose material.

    Returns
    -------
    Stress

    Examples
    --------
    A square stretched by 0.1 % along y and free to contract:

    >>> none = np.array([], dtype=np.intp)
    >>> points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> square = Body(points, np.array([[0, 1, 2, 3]]), none, none)
    >>> setup = Setup(hole_radius=2.245, outer_ratio=3.3, E=207e3, nu=0.3, plane="stress")
    >>> stress = stress_of(square, points * [-3e-4, 1e-3], setup, "plate")
    >>> print(stress.yy.round(6), np.abs(stress.xx).round(6), stress.von_mises.round(6))
    [207.] [0.] [207.]
    """
    E, nu = setup.equivalent(of)
    basis = _displacement_basis(body, quadrature=_MIDDLE)
    gradient = np.asarray(basis.interpolate(displacements.ravel()).grad)[..., 0]
    xx, yy = gradient[0, 0], gradient[1, 1]
    mu, lame = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
    volume = lame * (xx + yy)
    zz = volume if setup.plane == "strain" else np.zeros_like(volume)
    shear = mu * (gradient[0, 1] + gradient[1, 0])
    return Stress(volume + 2 * mu * xx, volume + 2 * mu * yy, shear, zz)
