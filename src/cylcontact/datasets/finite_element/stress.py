"""Stresses of a solution, one value per cell."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.finite_element.elasticity import displacement_basis
from cylcontact.datasets.finite_element.mesh import Body
from cylcontact.datasets.finite_element.setup import Setup


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


def stress_of(body: Body, displacements: FloatArray, setup: Setup) -> Stress:
    """Return the stresses of a body.

    Parameters
    ----------
    body : Body
        The mesh.
    displacements : array of float, shape (N, 2)
        Of its nodes, in mm.
    setup : Setup
        For the material and the plane state.

    Returns
    -------
    Stress

    Examples
    --------
    A square stretched by 0.1 % along y and free to contract:

    >>> from cylcontact.datasets.finite_element.mesh import Body
    >>> none = np.array([], dtype=np.intp)
    >>> points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> square = Body(points, np.array([[0, 1, 2, 3]]), none, none)
    >>> setup = Setup(hole_radius=2.245, outer_ratio=3.3, E=207e3, nu=0.3, plane="stress")
    >>> stress = stress_of(square, points * [-3e-4, 1e-3], setup)
    >>> print(stress.yy.round(6), np.abs(stress.xx).round(6), stress.von_mises.round(6))
    [207.] [0.] [207.]
    """
    E, nu = setup.equivalent
    basis = displacement_basis(body, order=1)
    gradient = np.asarray(basis.interpolate(displacements.ravel()).grad).mean(axis=-1)
    xx, yy = gradient[0, 0], gradient[1, 1]
    mu, lame = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
    volume = lame * (xx + yy)
    zz = volume if setup.plane == "strain" else np.zeros_like(volume)
    shear = mu * (gradient[0, 1] + gradient[1, 0])
    return Stress(volume + 2 * mu * xx, volume + 2 * mu * yy, shear, zz)
