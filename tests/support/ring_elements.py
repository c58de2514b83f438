"""Bonded rings by biquadratic finite elements, in plane strain: half of them, as they are even."""

from itertools import pairwise

import numpy as np
import skfem
from scipy.sparse import block_diag, coo_matrix
from scipy.sparse.linalg import splu
from skfem.helpers import ddot, eye, sym_grad, trace

from cylcontact.laws import Conformal
from cylcontact.laws.conformal.series import glauert

ELEMENT = skfem.ElementVector(skfem.ElementQuad2())


def graded(length, first, most):
    """Positions from a first cell to `length`, cells growing by half up to `most`."""
    steps = [first]
    while sum(steps) < length:
        steps.append(min(steps[-1] * 1.5, most))
    return np.cumsum(np.append(0, steps)) * length / sum(steps)


def grid(radii, clamp, cells, arc):
    """Positions in r and θ, graded to the clamp's end and to the end of a contact; and that end."""
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
    return r, theta, end


class Pressed:
    """A pair in its housing under a load: rings over the bore's radius, and the pressure on it."""

    def __init__(self, pair, housing, load):
        R_i, (kernel, *_) = float(pair.R_i), housing.kernels(pair)[1]
        self.housing, self.arc = (
            housing,
            np.radians(float(Conformal(housing).contact_angle(load, pair))),
        )
        self._b = np.tan(self.arc / 2)
        self._a = glauert(np.array([self._b]), float(pair.beta), 96, kernel.g).coefficients[0]
        self.radii = [1.0, *(radius / R_i for _, radius in housing.layers), housing.R_o / R_i]
        self.materials = [pair.material_i, *(material for material, _ in housing.layers)]

    def pressure(self, theta):
        """The pressure of the series under f = 1 and R = 1."""
        v = np.arccos(np.clip(np.tan(theta / 2) / self._b, -1, 1))
        return np.sin(np.multiply.outer(v, 2 * np.arange(self._a.size) + 1)) @ self._a

    def away_from_the_clamp(self, r, theta, values):
        """The values, and 0 by the ends of the clamp, which are singular."""
        clamp, radii = self.housing.clamp, self.radii
        if clamp == "rim":
            return values
        half, wall = np.radians(clamp.angle / 2), radii[-1] - radii[-2]
        end = half if clamp.side == "pushed" else np.pi - half
        near = (r > radii[-1] - wall / 2) & (radii[-1] * np.abs(theta - end) < wall)
        return np.where(near, 0, values)


class RingOfElements:
    """Rings of these radii, the bore's 1, and materials; the cells are graded to a clamp's end.

    With an arc, in radians, the cells at the bore are small enough for the pressure along it.
    """

    def __init__(self, radii, materials, clamp, cells=10, arc=None):
        r, theta, end = grid(radii, clamp, cells, arc)
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
        return bore_load(self.basis, pressure)

    def moved(self, load):
        """The displacements under a load."""
        moved = np.zeros(load.shape)
        moved[self.free] = self.factors.solve(load[self.free])
        return moved

    def stresses(self, moved):
        """Radius, θ, von Mises's stress at the nodes of each element."""
        basis = node_basis(self.mesh)
        mu, lame = self.mu[:, None], self.lame[:, None]
        strain = sym_grad(basis.interpolate(moved))
        (xx, xy), (_, yy) = stress_of(strain, mu, lame)
        zz = lame * trace(strain)
        mises = np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * xy**2)
        x, y = basis.global_coordinates()
        return np.hypot(x, y), np.arctan2(y, x), mises


class SlidingRings:
    """Rings that share u_r at their interfaces and have no shear there, with a clamp on the rim.

    Each ring is a mesh of its own; the nodes of an interface have one radial displacement, and a
    tangential one on each side.
    """

    def __init__(self, radii, materials, clamp, cells=10, arc=None, plane="strain"):
        r, theta, end = grid(radii, clamp, cells, arc)
        whole = skfem.MeshQuad.init_tensor(r, theta)
        middle = whole.p[0][whole.t].mean(axis=0)
        self.rings, matrices = [], []
        for k, material in enumerate(materials):
            inside = (middle > radii[k]) & (middle < radii[k + 1])
            mesh = skfem.MeshQuad2.from_mesh(whole.restrict(np.flatnonzero(inside)))
            at = mesh.doflocs
            polar = np.array([at[0] * np.cos(at[1]), at[0] * np.sin(at[1])])
            mesh = skfem.MeshQuad2(polar, mesh.t, sort_t=False)
            basis = skfem.Basis(mesh, ELEMENT, intorder=5)
            mu = material.E / (2 * (1 + material.nu))
            lame = material.E * material.nu / ((1 + material.nu) * (1 - 2 * material.nu))
            if plane == "stress":
                lame = 2 * mu * lame / (lame + 2 * mu)

            @skfem.BilinearForm
            def stiffness(u, v, _, mu=mu, lame=lame):
                return ddot(stress_of(sym_grad(u), mu, lame), sym_grad(v))

            self.rings.append((mesh, basis, mu, lame, 0.0 if plane == "stress" else material.nu))
            matrices.append(stiffness.assemble(basis))
        self._tie(radii, clamp, end)
        K = (self.shape.T @ block_diag(matrices) @ self.shape).tocsc()
        self.factors = splu(K[self.free][:, self.free])

    def _tie(self, radii, clamp, end):
        """The displacements of all nodes from the free ones: radial and tangential for each."""
        bases = [basis for _, basis, *_ in self.rings]
        starts = np.cumsum([0, *(basis.N for basis in bases)])
        rows, columns, values, fixed, shared = [], [], [], [], {}
        count = 0
        for k, (basis, start) in enumerate(zip(bases, starts, strict=False)):
            across, upright = basis.split_indices()
            x, y = basis.doflocs[:, across]
            radius, angle = np.hypot(x, y), np.arctan2(y, x)
            at = dict(zip(keys(*basis.doflocs[:, upright]), upright, strict=True))
            for i, key in enumerate(keys(x, y)):
                seat = any(abs(radius[i] - edge) < 1e-9 for edge in radii[1:-1])
                radial = shared.get(key) if seat else None
                if radial is None:
                    radial, count = count, count + 1
                    if seat:
                        shared[key] = radial
                tangential, count = count, count + 1
                c, s = np.cos(angle[i]), np.sin(angle[i])
                for dof, terms in ((across[i], (c, -s)), (at[key], (s, c))):
                    rows += [start + dof] * 2
                    columns += [radial, tangential]
                    values += terms
                if abs(y[i]) < 1e-9:
                    fixed.append(tangential)
                on_rim = k == len(bases) - 1 and radius[i] > radii[-1] * (1 - 1e-9)
                near = clamp == "rim" or clamp.side == "pushed"
                clamped = angle[i] <= end + 1e-9 if near else angle[i] >= end - 1e-9
                if on_rim and clamped:
                    fixed += [radial, tangential]
        self.shape = coo_matrix((values, (rows, columns)), (starts[-1], count)).tocsr()
        self.free = np.setdiff1d(np.arange(count), fixed)

    def moved(self, pressure):
        """The displacements of each ring under a pressure over θ on the bore."""
        load = np.zeros(self.shape.shape[0])
        inner = self.rings[0][1]
        load[: inner.N] = bore_load(inner, pressure)
        small = np.zeros(self.shape.shape[1])
        small[self.free] = self.factors.solve((self.shape.T @ load)[self.free])
        ends = np.cumsum([basis.N for _, basis, *_ in self.rings])[:-1]
        return np.split(self.shape @ small, ends)

    def stresses(self, moved, k):
        """Radius, θ and σ_xx, σ_yy, σ_xy, σ_zz at the nodes of each element of ring k."""
        mesh, _, mu, lame, nu = self.rings[k]
        basis = node_basis(mesh)
        (xx, xy), (_, yy) = stress_of(sym_grad(basis.interpolate(moved[k])), mu, lame)
        x, y = basis.global_coordinates()
        return np.hypot(x, y), np.arctan2(y, x), np.array([xx, yy, xy, nu * (xx + yy)])


def keys(x, y):
    """Nodes of two meshes at one place have one key."""
    return list(zip(np.round(x, 9).tolist(), np.round(y, 9).tolist(), strict=True))


def bore_load(basis, pressure):
    """The load of a pressure over θ on the bore."""
    load = np.zeros(basis.N)
    angle = np.arctan2(basis.doflocs[1], basis.doflocs[0])
    bore = np.flatnonzero(np.hypot(*basis.doflocs) < 1 + 1e-9)
    dofs = [np.intersect1d(bore, part) for part in basis.split_indices()]
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


def node_basis(mesh):
    """A basis whose points are the nodes of each element."""
    at = np.array([(x, y) for x in (0.0, 0.5, 1.0) for y in (0.0, 0.5, 1.0)]).T
    return skfem.Basis(mesh, ELEMENT, quadrature=(at, np.ones(at.shape[1]) / 9))


def stress_of(strain, mu, lame):
    return 2 * mu * strain + lame * eye(trace(strain), 2)


def apart(positions, fixed):
    """Sorted positions at least 1e-5 apart within the fixed ones, which are among them."""
    free = np.unique(positions)
    free = free[(free > min(fixed)) & (free < max(fixed))]
    free = free[np.append(True, np.diff(free) > 1e-5)]
    away = np.abs(free[:, None] - np.asarray(fixed)).min(axis=1)
    return np.sort(np.append(free[away > 1e-5], np.unique(fixed)))
