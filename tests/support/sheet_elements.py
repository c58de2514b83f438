"""The eye of a sheet by finite elements: its end is round, and it is clamped behind the hole."""

import numpy as np
import skfem
from scipy.sparse.linalg import splu
from skfem.helpers import ddot, sym_grad

from tests.support.ring_elements import ELEMENT, RingOfElements, stress_of

# In radii of the hole: the sheet's half-width, which is the radius of its end, and its length.
_WIDTH, _LENGTH = 2.0, 4.0


class SheetOfElements(RingOfElements):
    """Half of the sheet of NAFEMS's loaded pin, loaded towards its round end."""

    def __init__(self, E, nu, cells=2):
        corner = np.pi - np.arctan(_WIDTH / _LENGTH)
        ends = [(0, np.pi / 2, 8), (np.pi / 2, corner, 6), (corner, np.pi, 4)]
        theta = np.unique(np.concatenate([np.linspace(a, b, k * cells) for a, b, k in ends]))
        across = np.linspace(0, 1, 6 * cells) ** 1.3
        mesh = skfem.MeshQuad2.from_mesh(skfem.MeshQuad.init_tensor(1 + across, theta))
        share, angle = mesh.doflocs[0] - 1, mesh.doflocs[1]
        with np.errstate(divide="ignore"):
            rim = np.minimum(_WIDTH / np.abs(np.sin(angle)), _LENGTH / np.abs(np.cos(angle)))
        radius = 1 + share * (np.where(angle <= np.pi / 2, _WIDTH, rim) - 1)
        at = radius * np.array([np.cos(angle), np.sin(angle)])
        self.basis = skfem.Basis(skfem.MeshQuad2(at, mesh.t, sort_t=False), ELEMENT, intorder=5)
        self.mu, lame = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))

        @skfem.BilinearForm
        def stiffness(u, v, _):
            return ddot(stress_of(sym_grad(u), self.mu, lame), sym_grad(v))

        x, y = self.basis.doflocs
        upright = np.isin(np.arange(x.size), self.basis.split_indices()[1])
        self.free = np.flatnonzero((x > 1e-9 - _LENGTH) & ~(upright & (np.abs(y) < 1e-9)))
        K = stiffness.assemble(self.basis)
        self.factors = splu(K.tocsc()[self.free][:, self.free])


def compliances(elements, pair, count):
    """The g_nm of elements of the hole's body, as `Housing.from_compliances` describes them."""
    n = np.arange(count)
    loads = np.array([elements.pressed(lambda theta, k=k: np.cos(k * theta)) for k in n])
    work = 2 * elements.mu / np.pi * loads @ np.array([elements.moved(load) for load in loads]).T
    kappa, w = float(pair.kolosov[0]), float(pair.shares[0])
    plate = (kappa / np.maximum(n - 1, 1) + 1 / (n + 1)) / 2
    plate[:2] = 1, 0.25
    whole = np.where(n == 0, 1, 2)
    return w / (kappa + 1) * (work * np.outer(whole, whole) - np.diag(plate * whole))
