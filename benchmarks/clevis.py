"""A clevis in three dimensions: pin, eye and cheek as bodies of revolution in frictionless contact.

As in `benchmarks.tilted_pin`, finite elements in (r, z) for each harmonic cos mφ give the
compliance of bands of the walls, and cells (band × angle) touch without friction. The plates are
clamped at four radii of the pin, and the pin is free: its displacement and that of the eye follow
from the forces. The eye pushes the pin at φ = 180°, the cheeks hold it at φ = 0. All bodies have
ν = 0.3 and one modulus, but the plates may have another.

    python -m benchmarks.clevis

solves the joints of datasets/clevis.csv again, in some minutes, and prints them.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import skfem
from scipy.interpolate import CubicSpline
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse.linalg import splu

from benchmarks.tilted_pin import HARMONICS, graded, in_harmonics, mass

OUTER, SOFT = 4.0, 1e-7


@dataclass(frozen=True)
class Joint:
    """Sizes in mm, moduli in MPa: radius of the pin, eye, one cheek, gap, clearances."""

    R: float
    eye: float
    cheek: float
    gap: float
    clearance: float
    E: float = 207e3
    E_plates: float = 207e3


def both_ends(length, first, most):
    half = graded(length / 2, first, most)
    return np.concatenate([half, (length - half[::-1])[1:]])


def compliances(r, z, R, bands, *, clamped=None, pin=False, half=False):
    """S_m of bands (from, to) of the wall r = R under a radial load per radian, for E = 1."""
    mesh = skfem.MeshQuad.init_tensor(r, z)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad2(), 3), intorder=5)
    x, y = mesh.p[:, mesh.facets]
    wall = np.flatnonzero((abs(x - R) < 1e-9).all(axis=0))
    middle, length = y[:, wall].mean(axis=0), abs(np.diff(y[:, wall], axis=0)[0])
    loads = np.zeros((basis.N, len(bands)))
    for band, (start, end) in enumerate(bands):
        for k in np.flatnonzero((middle > start) & (middle < end)):
            loads[basis.nodal_dofs[0, mesh.facets[:, wall[k]]], band] += R * length[k] / 6
            loads[basis.facet_dofs[0, wall[k]], band] += R * 4 * length[k] / 6
    loads *= -1 if pin else 1
    (zero, linear, square), component = in_harmonics(basis)
    weight = mass.assemble(basis)
    x, y = basis.doflocs
    fixed = np.zeros(basis.N, bool)
    if clamped is not None:
        fixed |= x > clamped - 1e-9
    if half:  # z = 0 is the middle of the eye
        fixed |= (y < 1e-9) & (component == 1)
    free = np.flatnonzero(~fixed)
    motion = np.array([1.0, 0.0, -1.0])[component][free]
    weight = weight[free][:, free]
    force = weight @ motion / (motion @ weight @ motion)
    S = np.empty((len(HARMONICS), len(bands), len(bands)))
    for at, m in enumerate(HARMONICS):
        load, stiff = loads[free], (zero + m * linear + m * m * square)[free][:, free]
        if pin:
            stiff = stiff + SOFT * weight
        lu = splu(stiff.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
        if pin and m == 1:  # its own translation is separate
            moved = lu.solve(load - np.outer(force, motion @ load))
            moved -= np.outer(motion, force @ moved)
        else:
            moved = lu.solve(load)
        S[at] = load.T @ moved
    return S


def between(S, count):
    """S_m for all m below a count."""
    m, solved = np.arange(count), np.array(HARMONICS)
    spline = CubicSpline(np.log(solved[3:]), solved[3:, None, None] * S[3:])
    every = spline(np.log(np.clip(m, solved[3], solved[-1]))) / np.maximum(m, 1)[:, None, None]
    every[solved[solved < count]] = S[solved < count]
    return every


class ClevisOfElements:
    """A joint ready for any force; `first` is the smallest element in R, `angles` cells in 180°."""

    def __init__(self, joint, first=0.02, most=0.25, angles=60):
        self.joint, self.angles, self.step = joint, angles, np.pi / angles
        R, first, most = joint.R, first * joint.R, most * joint.R
        eye = joint.eye / 2 - graded(joint.eye / 2, first, most)[::-1]
        eye[0] = 0.0
        cheek = both_ends(joint.cheek, first, most)
        start = joint.eye / 2 + joint.gap
        gap = joint.eye / 2 + both_ends(joint.gap, first, most)
        hole = R + graded((OUTER - 1) * R, first, 2 * most)
        pin = R - graded(R, first, most)[::-1]
        pin[0] = 0.0
        of_eye, of_cheek = list(pairwise(eye)), list(pairwise(cheek))
        bands = of_eye + [(a + start, b + start) for a, b in of_cheek]
        count = len(of_eye)
        all_m = 4 * angles
        along = np.concatenate([eye, gap[1:-1], start + cheek])
        S = between(compliances(pin, along, R, bands, pin=True, half=True), all_m) / joint.E
        turn = np.where(np.arange(all_m) % 2 == 0, 1.0, -1.0)[:, None, None]
        S[:, :count, count:] *= turn
        S[:, count:, :count] *= turn
        plates = (
            (slice(0, count), eye, of_eye, True),
            (slice(count, None), cheek, of_cheek, False),
        )
        for part, z, own, half in plates:
            plate = compliances(hole, z, R, own, clamped=OUTER * R, half=half)
            S[:, part, part] += between(plate, all_m) / joint.E_plates
        m = np.arange(all_m)
        share = np.where(m > 0, 1.0, 0.5) / np.pi * (self.step * np.sinc(m / (2 * angles))) ** 2
        turns = np.cos(np.outer(np.arange(2 * angles), m) * self.step) * share
        self.kernel = np.tensordot(turns, S, 1)
        self.in_eye = np.arange(len(bands)) < count
        self.z, self.size = np.mean(bands, axis=1), np.diff(bands, axis=1)[:, 0]

    def solved(self, force):
        """Movement, moments and means at the edges under a force on the eye."""
        joint, step, kernel = self.joint, self.step, self.kernel
        psi = (np.arange(self.angles // 2 + 2) + 0.5) * step
        cosine = np.cos(psi) * np.sinc(0.5 / self.angles)
        i, b = (index.ravel() for index in np.indices((psi.size, self.z.size)))
        area, c = joint.R * step * self.size[b], cosine[i]
        A = kernel[abs(i[:, None] - i), b[:, None], b] + kernel[i[:, None] + i + 1, b[:, None], b]
        in_eye = self.in_eye[b]
        closing = np.array([np.where(in_eye, c, 0.0), np.where(in_eye, -c, c)]).T * area[:, None]
        active = psi[i] < np.radians(50)
        for _ in range(80):
            k = np.flatnonzero(active)
            right = np.column_stack([-joint.clearance * area[k], closing[k]])
            Y = cho_solve(cho_factor(A[np.ix_(k, k)]), right)
            T = 2 * closing[k].T @ Y
            moved = np.linalg.solve(T[:, 1:], np.array([force / 2, 0.0]) - T[:, 0])
            p = np.zeros(area.size)
            p[k] = Y[:, 0] + Y[:, 1:] @ moved
            pulls = active & (p < 0)
            if pulls.any():
                active &= ~pulls
                continue
            gap = joint.clearance * area - closing @ moved + A[:, k] @ p[k]
            inside = ~active & (gap < -1e-12 * area)
            if not inside.any():
                break
            active |= inside
        line = 2 * joint.R * step * (cosine[:, None] * p.reshape(psi.size, -1)).sum(axis=0)
        q = np.where(self.in_eye, -1.0, 1.0) * line * self.size
        face = joint.eye / 2
        answer = {
            "movement_um": 1e3 * moved[0],
            "moment_Nmm": q @ self.z,
            "shear_plane_moment_Nmm": np.maximum(self.z - face, 0) @ q,
        }
        plates = {
            "eye": (self.in_eye, face, force / joint.eye),
            "cheek": (~self.in_eye, face + joint.gap, force / 2 / joint.cheek),
        }
        for name, (part, edge, nominal) in plates.items():
            for share in (0.1, 0.25):
                away = abs(self.z[part] - edge)
                mean = edge_mean(away, self.size[part], line[part], share * joint.R)
                answer[f"{name}_ratio_{share:g}R"] = mean / nominal
        return answer


def edge_mean(distance, size, f, length):
    order = np.argsort(distance)
    reach = np.append(0.0, np.cumsum(size[order]))
    return np.interp(length, reach, np.append(0.0, np.cumsum((size * f)[order]))) / length


JOINTS = {f"d {2 * R:g}": Joint(R, 20.0, 10.0, 1.0, 0.01) for R in (5.0, 7.5, 10.0)}

if __name__ == "__main__":
    for name, joint in JOINTS.items():
        print(name, ClevisOfElements(joint, first=0.01, angles=90).solved(10e3))
