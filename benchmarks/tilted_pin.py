"""A pin that tilts in its hole, in three dimensions: what slices of the plane law miss at a rim.

Pin and hole are bodies of revolution, so finite elements in (r, z) for each harmonic cos mφ of the
pressure give their compliance S_m between bands of the wall. With these, the frictionless contact
of cells (band × angle) is a quadratic programme: with the pin's axis displaced by e(z),

    g = ΔR − e·cos φ + S·p ≥ 0,    p ≥ 0,    p·g = 0.

All is linear but the contact, so lengths are in units of R, gaps in units of ΔR and pressures in
units of E*·ΔR/R. The bush has four times the radius of its hole and is clamped outside; body forces
uniform and linear along the axis balance the pin. The law of the slices is that of the same
elements in plane strain: only slicing is judged.

    python -m benchmarks.tilted_pin

solves all cases, in about a minute, and writes datasets/tilted_pin.csv.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import skfem
from scipy.interpolate import CubicSpline
from scipy.linalg import solve
from scipy.optimize import least_squares
from scipy.sparse.linalg import splu
from skfem.helpers import dot

from cylcontact.support.arrays import BoolArray, FloatArray, IndexArray, as_floats

FILE = "datasets/tilted_pin.csv"
NU, OUTER, BEYOND = 0.3, 4.0, 0.5
LENGTHS, DEPTHS, SHARES = (1.0, 2.0, 4.0), (0.01, 0.03, 0.1, 0.3), (np.inf, 1.0, 0.5, 0.25, 0.06)
# E of the hole over E of the pin: alike; a steel pin in a hole of PEEK, and the reverse.
MATERIALS = {"alike": 1.0, "soft hole": 3.6 / 207, "soft pin": 207 / 3.6}
UNLIKE_LENGTH = 2.0
# The smallest element, at the rim; how fast they grow; the largest; cells over half a turn.
FIRST, GROWTH, MOST, ANGLES = 0.001, 1.4, 0.25, 126
# A finer mesh, by which the error is judged, for the shortest hole and like materials.
FINER = (FIRST / 2, 2 * ANGLES)
# The modulus of a foundation on which a free body stands, over E.
SOFT = 1e-6
# Harmonics computed; between them m·S_m is interpolated and beyond them it is constant.
HARMONICS = (0, 1, 2, 3, 4, 5, 6, 8, 10, 13, 17, 22, 29, 38, 50, 66, 87, 115, 152, 200, 264)


def graded(length: float, first: float, most: float = MOST) -> FloatArray:
    """Return positions from 0 to `length`, in steps that grow from the first."""
    steps = [first]
    while sum(steps) < length:
        steps.append(min(steps[-1] * GROWTH, most))
    return np.cumsum([0.0, *steps]) * length / sum(steps)


def stiffness(basis: skfem.Basis, m: int) -> Any:
    """Return the stiffness for u_r·cos mφ, u_z·cos mφ and u_φ·sin mφ with E = 1."""
    mu, lame = 1 / (2 * (1 + NU)), NU / ((1 + NU) * (1 - 2 * NU))

    def strain(u: Any, r: FloatArray) -> tuple[Any, Any]:
        (r_r, r_z), (z_r, z_z), (t_r, t_z) = u.grad
        normal = (r_r, z_z, (u[0] + m * u[2]) / r)
        return normal, (r_z + z_r, t_r - (u[2] + m * u[0]) / r, t_z - m * u[1] / r)

    @skfem.BilinearForm  # type: ignore[untyped-decorator]
    def form(u: Any, v: Any, w: Any) -> Any:
        (normal, shear), (normal_v, shear_v) = strain(u, w.x[0]), strain(v, w.x[0])
        both = sum(2 * a * b for a, b in zip(normal, normal_v, strict=True))
        both += sum(a * b for a, b in zip(shear, shear_v, strict=True))
        return w.x[0] * (mu * both + lame * sum(normal) * sum(normal_v))

    return form.assemble(basis)


@skfem.BilinearForm  # type: ignore[untyped-decorator]
def mass(u: Any, v: Any, w: Any) -> Any:
    """A foundation in proportion to the volume."""
    return w.x[0] * dot(u, v)


def in_harmonics(basis: skfem.Basis) -> tuple[tuple[Any, Any, Any], IndexArray]:
    """Return the matrices of 1, m and m² in the stiffness, and the component of each unknown."""
    minus, zero, plus = (stiffness(basis, m) for m in (-1, 0, 1))
    component = np.empty(basis.N, int)
    for number in range(3):
        for dofs in (basis.nodal_dofs, basis.facet_dofs, basis.interior_dofs):
            component[dofs[number]] = number
    return (zero, (plus - minus) / 2, (plus + minus) / 2 - zero), component


def compliances(r: FloatArray, z: FloatArray, half: float, plane: bool = False) -> FloatArray:
    """Return S_m of the bands of the wall r = 1 with z < half, as (parity, m, bands, bands)."""
    mesh = skfem.MeshQuad.init_tensor(r, z)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad2(), 3), intorder=5)
    x, y = mesh.p[:, mesh.facets]
    wall = np.flatnonzero((x == 1).all(axis=0) & (y < half + 1e-9).all(axis=0))
    wall = wall[np.argsort(y[0, wall])]
    length = np.diff(y[:, wall], axis=0)[0]
    loads = np.zeros((basis.N, wall.size))
    for band, (facet, size) in enumerate(zip(wall, np.abs(length), strict=True)):
        loads[basis.nodal_dofs[0, mesh.facets[:, facet]], band] = size / 6
        loads[basis.facet_dofs[0, facet], band] = 4 * size / 6
    (zero, linear, square), component = in_harmonics(basis)
    weight = mass.assemble(basis)
    along = np.flatnonzero(component == 1)
    x, y = basis.doflocs
    outside = np.flatnonzero(x > OUTER - 1e-9)
    middle = np.flatnonzero(y < 1e-9)
    upright = np.isin(middle, along)
    # Even in z, all move by 1 along x; odd, they turn by 1.
    across = (
        np.array([1.0, 0.0, -1.0])[component],
        np.array([y, -x, -y])[component, np.arange(y.size)],
    )
    holds = (along, along) if plane else (middle[upright], middle[~upright])
    found = np.empty((2, len(HARMONICS), wall.size, wall.size))
    for parity, held in enumerate(holds):
        free = np.setdiff1d(np.arange(basis.N), np.concatenate([held, outside]))
        soft = 0.0 if outside.size else SOFT
        motion, weights = across[parity][free], weight[free][:, free]
        for at, m in enumerate(HARMONICS):
            load = loads[free]
            if soft and m == 1:
                force = weights @ motion
                load = load - np.outer(force, motion @ load) / (motion @ force)
            stiff = (zero + m * linear + m * m * square)[free][:, free] + soft * weights
            lu = splu(stiff.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
            found[parity, at] = load.T @ lu.solve(load)
    return found


@dataclass(frozen=True)
class Contact:
    """A pin in a bush, ready for any place of the pin."""

    # Middles (0 at mid length) and widths of the bands of the wall.
    z: FloatArray
    size: FloatArray
    # (2·angles, bands, bands): displacement over a cell by a pressure on another, by their angle.
    kernel: FloatArray

    @classmethod
    def of(cls, edges: FloatArray, S: FloatArray, angles: int, plane: bool = False) -> Contact:
        """Return that of bands between edges from mid length to a rim, and of S as computed."""
        size, z = np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
        even, odd = S
        if plane:
            S = even
        else:
            S = 0.5 * np.block([[even + odd, even - odd], [even - odd, even + odd]])
            z, size = np.append(z, -z), np.append(size, size)
        m, known = np.arange(4 * angles), np.array(HARMONICS)
        spline = CubicSpline(np.log(known[3:]), known[3:, None, None] * S[3:])
        between = spline(np.log(np.clip(m, known[3], known[-1]))) / np.maximum(m, 1)[:, None, None]
        between[known] = S
        step = np.pi / angles
        share = np.where(m > 0, 1.0, 0.5) / np.pi * (step * np.sinc(m / (2 * angles))) ** 2
        turns = np.cos(np.outer(np.arange(2 * angles), m) * step) * share
        return cls(z, size, np.tensordot(turns, between, 1))

    def pressures(self, centre: float, tilt: float) -> tuple[FloatArray, FloatArray]:
        """Return cos φ and p, (angles, bands), where the axis is at centre + tilt·z."""
        angles = len(self.kernel) // 2
        step = np.pi / angles
        cosine = np.cos((np.arange(angles) + 0.5) * step)
        mean = cosine * np.sinc(0.5 / angles)
        overlap = step * self.size * (mean[:, None] * (centre + tilt * self.z) - 1)
        i, b = (index.ravel() for index in np.indices(overlap.shape))

        def between(row: IndexArray | BoolArray, column: BoolArray) -> FloatArray:
            (i_r, i_c), (b_r, b_c) = (np.ix_(k[row], k[column]) for k in (i, b))
            kernel = self.kernel
            return as_floats(kernel[abs(i_r - i_c), b_r, b_c] + kernel[i_r + i_c + 1, b_r, b_c])

        over = overlap.ravel()
        near = over > -0.1 * step * self.size[b]
        active = over > 0
        for _ in range(50):
            p = np.zeros(over.size)
            p[active] = solve(between(active, active), over[active], assume_a="pos")
            pulls = active & (p < 0)
            if pulls.any():
                active &= ~pulls
                continue
            others = np.flatnonzero(near & ~active)
            inside = over[others] - between(others, active) @ p[active] > 1e-12
            if not inside.any():
                break
            active[others[inside]] = True
        return cosine, p.reshape(overlap.shape)

    def resultant(self, centre: float, tilt: float) -> tuple[float, float]:
        """Return the force on the pin's side of cos φ > 0 and its moment about mid length."""
        cosine, p = self.pressures(centre, tilt)
        angles = len(cosine)
        line = 2 * np.pi / angles * np.maximum(cosine, 0) * np.sinc(0.5 / angles) @ p * self.size
        return float(line.sum()), float(line @ self.z)


@dataclass(frozen=True)
class Place:
    """Where the pin is: the depth of rim A in ΔR, and the share of the length that touches."""

    length: float
    depth: float
    share: float

    @property
    def tilt(self) -> float:
        """In ΔR/R."""
        return self.depth / (self.share * self.length)

    @property
    def centre(self) -> float:
        """The displacement at mid length in ΔR."""
        return 1 + self.depth - 0.5 * self.tilt * self.length


def rim_term(place: Place, c: float, b: float) -> tuple[float, float]:
    """Return the force at rim A and its moment about mid length that the rim's stiffness adds."""
    d, slope = place.depth, place.tilt
    if slope == 0:
        return 0.0, 0.0
    full = slope**2 / (slope**2 + (d / b) ** 2)
    stiff = 0.4 * np.sqrt(2) * c * d**1.5
    force = stiff * full * (0.5 + 2 * full)
    return force, 0.5 * place.length * force + 2 * stiff * d * full * (1 - full) / slope


def lamina(place: Place, law: Callable[[FloatArray], FloatArray]) -> tuple[float, float]:
    """Return the force at rim A and its moment of slices of the plane law."""
    x, weight = np.polynomial.legendre.leggauss(64)
    span = min(place.share, 1.0) * place.length
    line = 0.5 * span * weight * law(place.depth - place.tilt * 0.5 * span * (1 - x))
    return float(line.sum()), float(line @ (0.5 * place.length - 0.5 * span * (1 - x)))


def plane_law(S: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Return the line load over the depth of compliances in plane strain."""
    contact = Contact.of(np.array([0.0, 1.0]), S, 1000, plane=True)
    depths = np.geomspace(1e-4, 0.35, 40)
    loads = [contact.resultant(1 + d, 0.0)[0] for d in depths]
    spline = CubicSpline(np.log(depths), np.log(loads))
    return lambda d: np.exp(spline(np.log(np.maximum(d, 1e-12))))


def rows_of(length: float, mesh: tuple[float, int]) -> Iterator[dict[str, Any]]:
    """Solve all places, ends and materials of a length."""
    first, angles = mesh
    half, whole = 0.5 * length, np.array([0.0, 1.0])
    hole, pin = 1 + graded(OUTER - 1, first), 1 - graded(1, first)[::-1]
    pin[0] = 0.0
    edges = half - graded(half, first)[::-1]
    edges[0] = 0.0
    beyond = np.append(edges, half + graded(BEYOND, first)[1:])
    bush, plane_bush = compliances(hole, edges, half), compliances(hole, whole, 1, plane=True)
    plane_pin = compliances(pin, whole, 1, plane=True)
    for ends, z in (("flush", edges), ("overhang", beyond)):
        shaft = compliances(pin, z, half)
        for name, ratio in MATERIALS.items():
            if name != "alike" and length != UNLIKE_LENGTH:
                continue
            unit = (1 - NU**2) * (1 + ratio)
            law = plane_law((plane_bush + ratio * plane_pin) / unit)
            contact = Contact.of(edges, (bush + ratio * shaft) / unit, angles)
            for depth in DEPTHS:
                least = depth / (2 + 2 * depth)  # with rim B as deep on the other side
                for share in [*(share for share in SHARES if share > least), least]:
                    place = Place(length, depth, share)
                    force, moment = contact.resultant(place.centre, place.tilt)
                    sliced, sliced_moment = lamina(place, law)
                    yield {
                        "first_element": first, "length": length, "ends": ends, "materials": name,
                        "depth": depth, "share": share, "force": force, "moment": moment,
                        "lamina_force": sliced, "lamina_moment": sliced_moment,
                    }  # fmt: skip


def constants(table: pd.DataFrame) -> tuple[float, float]:
    """Return c and b that bring slices with the rim's stiffness nearest to the table's forces."""
    tilted = table[np.isfinite(table["share"])]

    def errors(constants: FloatArray) -> FloatArray:
        return as_floats(with_rim(tilted, *constants)[0] / tilted["force"] - 1)

    c, b = least_squares(errors, [0.1, 0.5]).x
    return float(c), float(b)


def with_rim(table: pd.DataFrame, c: float, b: float) -> FloatArray:
    """Return forces and moments of the slices with the rim's stiffness, (2, rows)."""
    places = (Place(*row) for row in table[["length", "depth", "share"]].to_numpy())
    added = np.array([rim_term(place, c, b) for place in places])
    return as_floats(added.T + table[["lamina_force", "lamina_moment"]].to_numpy().T)


def tilted_pin() -> pd.DataFrame:
    """Solve all cases."""
    rows = [row for length in LENGTHS for row in rows_of(length, (FIRST, ANGLES))]
    return pd.DataFrame([*rows, *rows_of(min(LENGTHS), FINER)])


def mesh_change(table: pd.DataFrame) -> float:
    """Return by how much forces change at most, in percent, on the finer mesh."""
    place = ["length", "ends", "materials", "depth", "share"]
    fine = table[table["first_element"] == FINER[0]].set_index(place)["force"]
    coarse = table[table["first_element"] == FIRST].set_index(place)["force"]
    return float(100 * (fine / coarse[fine.index] - 1).abs().max())


if __name__ == "__main__":
    tilted_pin().to_csv(Path(FILE), index=False, float_format="%.6g")
