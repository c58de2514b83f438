"""Linear elasticity of one body: assembled by scikit-fem, factorised once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.finite_element.mesh import Body, IntArray


@dataclass(frozen=True, eq=False)
class Elastic:
    """A body's stiffness, with the supports that hold it, ready to be solved.

    Attributes
    ----------
    free : array of int
        Degrees of freedom that are not held; node i has 2i (x) and 2i + 1 (y).
    factors : object
        What `scipy.sparse.linalg.splu` gives.
    size : int
        Number of all degrees of freedom.
    """

    free: IntArray
    factors: Any
    size: int

    def solve(self, forces: FloatArray) -> FloatArray:
        """Return displacements in mm under columns of nodal forces in N/mm, shape (size, k)."""
        displacements = np.zeros_like(forces)
        displacements[self.free] = self.factors.solve(np.ascontiguousarray(forces[self.free]))
        return displacements


def mesh_of(body: Body) -> Any:
    """Return scikit-fem's mesh of a body."""
    import skfem

    points, quads = (np.ascontiguousarray(array.T) for array in (body.points, body.quads))
    return skfem.MeshQuad(points, quads)


def displacement_basis(body: Body, order: int) -> Any:
    """Return scikit-fem's basis of bilinear displacements on a body, with its quadrature."""
    import skfem

    return skfem.Basis(mesh_of(body), skfem.ElementVector(skfem.ElementQuad1()), intorder=order)


def factorise(body: Body, E: float, nu: float, held: IntArray) -> Elastic:
    """Assemble a body's stiffness in plane strain and factorise it without the held freedoms.

    Parameters
    ----------
    body : Body
        The mesh.
    E, nu : float
        In MPa and -.
    held : array of int
        Degrees of freedom that are zero.
    """
    from scipy.sparse.linalg import splu
    from skfem import asm
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    basis = displacement_basis(body, order=3)
    stiffness = asm(linear_elasticity(*lame_parameters(E, nu)), basis).tocsc()
    free = np.setdiff1d(np.arange(basis.N), held)
    symmetric = {"SymmetricMode": True}
    factors = splu(
        stiffness[free][:, free],
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options=symmetric,
    )
    return Elastic(free, factors, basis.N)


def spread_load(pin: Body, centre: FloatArray, radius: float) -> FloatArray:
    """Return the nodes' shares of a load spread evenly over a disc, shape (N,), their sum 1.

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

    basis = skfem.Basis(mesh_of(pin), skfem.ElementQuad1(), intorder=4)

    def inside(v: Any, w: Any) -> Any:
        return v * (np.hypot(w.x[0] - centre[0], w.x[1] - centre[1]) <= radius)

    shares = np.asarray(skfem.LinearForm(inside).assemble(basis), dtype=np.float64)
    return as_floats(shares / shares.sum())
