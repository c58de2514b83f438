"""Bonded rings by biquadratic finite elements, in plane strain: half of them, as they are even."""

from itertools import pairwise

import numpy as np
import skfem
from scipy.sparse.linalg import splu
from skfem.helpers import ddot, eye, sym_grad, trace

ELEMENT = skfem.ElementVector(skfem.ElementQuad2())


def graded(length, first, most):
    """Positions from a first cell to `length`, cells growing by half up to `most`."""
    steps = [first]
    while sum(steps) < length:
        steps.append(min(steps[-1] * 1.5, most))
    return np.cumsum(np.append(0, steps)) * length / sum(steps)


class RingOfElements:
    """Rings of these radii, the bore's 1, and materials; the cells are graded to a clamp's end.

    With an arc, in radians, the cells at the bore are small enough for the pressure along it.
    """

    def __init__(self, radii, materials, clamp, cells=10, arc=None):
        end = np.pi
        if clamp != "rim":
            half = np.radians(clamp.angle) / 2
            end = half if clamp.side == "pushed" else np.pi - half
        first = 0.03 if clamp == "rim" else 3e-4 if arc is None else 3e-3
        most = np.pi / (3 * cells)
        theta = end - graded(end, first, most)[::-1]
        if clamp != "rim":
            theta = np.append(theta, (end + graded(np.pi - end, first, most))[1:])
        r = [np.linspace(*ends, 5) for ends in pairwise(radii[:-1])]
        r += [radii[-1] - graded(radii[-1] - radii[-2], first, most)]
        if arc is not None:
            away = graded(arc, 1e-3 * arc, arc / cells)  # from the edge of the contact
            theta = np.concatenate([theta, arc - away, arc + away])
            r += [1 + graded(min(3 * arc, radii[1] - 1), 1e-3 * arc, arc / cells)]
        r = apart(np.concatenate(r), radii)
        theta = apart(theta, [0, end, np.pi, *([] if arc is None else [arc])])
        mesh = skfem.MeshQuad.init_tensor(r, theta)
        mesh = skfem.MeshQuad2.from_mesh(mesh)
        at = mesh.doflocs
        polar = np.array([at[0] * np.cos(at[1]), at[0] * np.sin(at[1])])
        self.mesh = skfem.MeshQuad2(polar, mesh.t, sort_t=False)
        layer = np.searchsorted(radii[1:-1], at[0][mesh.t].mean(axis=0))
        E, nu = (np.array([getattr(m, key) for m in materials])[layer] for key in ("E", "nu"))
        self.mu, self.lame = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
        self.basis = skfem.Basis(self.mesh, ELEMENT, intorder=5)

        @skfem.BilinearForm
        def stiffness(u, v, w):
            return ddot(stress_of(sym_grad(u), w.mu, w.lame), sym_grad(v))

        one = 0 * self.basis.dx
        fields = {"mu": self.mu[:, None] + one, "lame": self.lame[:, None] + one}
        K = stiffness.assemble(self.basis, **fields)
        x, y = self.basis.doflocs
        angle, radius = np.arctan2(y, x), np.hypot(x, y)
        rim = (radius > radii[-1] * (1 - 1e-9)) & (
            (angle <= end + 1e-9) if clamp == "rim" or clamp.side == "pushed" else
            (angle >= end - 1e-9)
        )  # fmt: skip
        upright = np.isin(np.arange(x.size), self.basis.split_indices()[1])
        self.free = np.flatnonzero(~(rim | (upright & (np.abs(y) < 1e-9))))
        self.factors = splu(K.tocsc()[self.free][:, self.free])

    def pressed(self, pressure):
        """The load of a pressure over θ on the bore."""
        load = np.zeros(self.basis.N)
        angle = np.arctan2(self.basis.doflocs[1], self.basis.doflocs[0])
        bore = np.flatnonzero(np.hypot(*self.basis.doflocs) < 1 + 1e-9)
        dofs = [np.intersect1d(bore, part) for part in self.basis.split_indices()]
        dofs = [part[np.argsort(angle[part])] for part in dofs]
        theta = angle[dofs[0]]
        start, width = theta[:-2:2], theta[2::2] - theta[:-2:2]
        x, weights = np.polynomial.legendre.leggauss(6)
        x = (1 + x) / 2
        at = start[:, None] + width[:, None] * x
        force = pressure(at) * width[:, None] * weights / 2
        shapes = np.array([(1 - x) * (1 - 2 * x), 4 * x * (1 - x), x * (2 * x - 1)])
        for part, along in zip(dofs, (np.cos(at), np.sin(at)), strict=True):
            for k, shape in enumerate(shapes):  # the start, the middle and the end of each edge
                np.add.at(load, part[k : k + 2 * len(start) : 2], (force * along) @ shape)
        return load

    def moved(self, load):
        """The displacements under a load."""
        moved = np.zeros(load.shape)
        moved[self.free] = self.factors.solve(load[self.free])
        return moved

    def stresses(self, moved):
        """Radius, θ, von Mises's stress at the nodes of each element."""
        at = np.array([(x, y) for x in (0.0, 0.5, 1.0) for y in (0.0, 0.5, 1.0)]).T
        basis = skfem.Basis(self.mesh, ELEMENT, quadrature=(at, np.ones(at.shape[1]) / 9))
        mu, lame = self.mu[:, None], self.lame[:, None]
        strain = sym_grad(basis.interpolate(moved))
        (xx, xy), (_, yy) = stress_of(strain, mu, lame)
        zz = lame * trace(strain)
        mises = np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * xy**2)
        x, y = basis.global_coordinates()
        return np.hypot(x, y), np.arctan2(y, x), mises


def stress_of(strain, mu, lame):
    return 2 * mu * strain + lame * eye(trace(strain), 2)


def apart(positions, fixed):
    """Sorted positions at least 1e-5 apart within the fixed ones, which are among them."""
    free = np.unique(positions)
    free = free[(free > min(fixed)) & (free < max(fixed))]
    free = free[np.append(True, np.diff(free) > 1e-5)]
    away = np.abs(free[:, None] - np.asarray(fixed)).min(axis=1)
    return np.sort(np.append(free[away > 1e-5], np.unique(fixed)))
