"""The search for first yield: its load, the body and the depth.

With T = σ_Y·R/(E*·ΔR) and φ = f/(E*·ΔR) the condition is φ·m = T, where m is the largest equivalent
stress in a body in units of f/R. It depends on the contact arc, β, κ and ν alone. `limits` holds
the functions to call.

**Where m is sought.** On the axis of the contact, θ = 0, from the surface inwards: for von Mises
and Tresca the largest equivalent stress lies there in both bodies, at the surface or below it. That
is tested on grids over both bodies for 0 ≤ ν < 1/2 and arcs up to 120°, not proved.

**How exactly.** m over the peak pressure is tabulated against ε once for a body, β, ν and
criterion, and interpolated linearly. Cells are halved until the value in the middle of each is
within 1e-5 of the interpolation. Over 100 tables the largest error elsewhere was 1.6e-4, next to
arcs where the place of first yield jumps, and 5e-6 in most.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws.conformal.arcs import Bodies
from cylcontact.laws.conformal.series import persson_peak, remainder
from cylcontact.limits.stress import PlaneStress, Pressure, in_pin, in_plate, pressure_along
from cylcontact.support.arrays import (
    FloatArray,
    as_floats,
    blocks,
    distinct_columns,
    fewest_kinds,
    on_all_cores,
)

Criterion = Literal["von Mises", "Tresca", "Hertz"]

# Arcs at the start of a table, and how often a cell is halved at most; the accuracy of m, relative,
# and that of the depth over R·sin ε.
_ARCS, _HALVINGS = 65, 20
_ACCURACY, _DEPTH_ACCURACY = 1e-5, 2e-3
# tan(ε/2) of an arc for which Hertz's formulas hold.
_HERTZ_B = 1e-7
# Below this, β changes m by less than that accuracy.
_SMALL_BETA = 1e-4
# The search on the axis: to this many half-widths or, in the plate and the pin, nearly to infinity
# and some way beyond the centre; points of the first pass, of the others, and how many of these.
_DEPTH, _FARTHEST = 3.0, {"hole": 0.9, "pin": 3.0}
_COARSE, _FINE, _PASSES = 40, 7, 5
# Each step cuts the error of ln f to a third or less: 25 leave 3e-12.
_STEPS = 25
# Kinds of joints, of other β, κ or ν, from which all are searched in compiled code; at a time.
_FEW, _ROWS = 8, 4096


@dataclass(frozen=True)
class FirstYield:
    """The load at which a contact first yields, and where. Fields have the shape of the pair.

    Attributes
    ----------
    load : float or array
        In N/mm.
    body : str or array of str
        "hole" or "pin"; for external contact "i" or "j", and "i" if both yield at once.
    depth : float or array
        Below the surface in mm, on the axis of the contact; 0 at the surface.
    criterion : {"von Mises", "Tresca", "Hertz"}
    angle : float or array
        From the load line in degrees; 0 except in a housing.
    """

    load: FloatArray
    body: NDArray[np.str_]
    depth: FloatArray
    criterion: Criterion
    angle: FloatArray | float = 0.0

    def __str__(self) -> str:
        """Return the load and the place of one pair in words; of several their numbers."""
        if np.ndim(self.load):
            return repr(self)
        if np.isnan(self.load):
            return "no load at which the pin touches its housing along one arc"
        words = {"hole": "the hole", "pin": "the pin", "i": "body i", "j": "body j"}
        body = words.get(str(self.body), self.body)  # else a layer
        surface = "its surface" if str(self.body) in words else "the hole's surface"
        place = f"{self.depth:.2g} mm below {surface}" if self.depth > 0 else f"at {surface}"
        place += f", {self.angle:.0f}° from the load" if self.angle >= 0.5 else ""
        return f"{self.load:,.0f} N/mm ({self.criterion}, in {body}, {place})"

    def take(self, index: int, shape: tuple[int, ...]) -> FirstYield:
        """Return that of one element of arrays of a shape."""
        load, body, depth, angle = (
            np.broadcast_to(each, shape).flat[index]
            for each in (self.load, self.body, self.depth, self.angle)
        )
        return FirstYield(load, body, depth, self.criterion, angle)


class Body(NamedTuple):
    """One body of a pair; its stresses depend on β and, in the plate around a hole, on κ."""

    name: Literal["hole", "pin"]
    kappa: float  # Kolosov's
    nu: float  # σ_zz/(σ_rr + σ_θθ): ν in plane strain, 0 in plane stress


class _Table(NamedTuple):
    """m over the peak pressure, and the depth of first yield over R·sin ε, against ε."""

    angle: FloatArray
    ratio: FloatArray
    depth: FloatArray


def find_first_yield(
    pair: CylinderPair, stresses: tuple[FloatArray, FloatArray], criterion: Criterion
) -> FirstYield:
    """Return the first yield of a pair whose bodies i and j have these yield stresses in MPa."""
    if pair.contact == "internal":
        return _of_hole(pair, stresses, criterion)
    loads, depths = _of_rollers(pair, stresses, criterion)
    second = loads[1] < loads[0]
    return FirstYield(
        as_floats(np.where(second, loads[1], loads[0])),
        np.where(second, "j", "i")[()],
        as_floats(np.where(second, depths[1], depths[0])),
        criterion,
    )


def equivalent(stress: PlaneStress, nu: float, criterion: Criterion) -> FloatArray:
    """Return the equivalent stress by von Mises or Tresca, with σ_zz = ν·(σ_rr + σ_θθ)."""
    return of_shear(
        np.abs(stress.difference) / 2, np.abs(0.5 - nu) * np.abs(stress.total), criterion
    )


def of_shear(half: FloatArray, across: FloatArray, criterion: Criterion) -> FloatArray:
    """Return the equivalent stress from the shear in the plane and the distance of σ_zz.

    These are (σ_1 − σ_2)/2 and |(σ_1 + σ_2)/2 − σ_zz|, with the principal stresses in the plane.
    """
    if criterion == "Tresca":
        return as_floats(np.maximum(2 * half, half + across))
    return as_floats(np.sqrt(3 * half**2 + across**2))


def largest_on_axis(
    body: Body, pressure: Pressure, criterion: Criterion
) -> tuple[FloatArray, FloatArray]:
    """Return m for each arc, and its depth in units of R; both of shape (k,)."""

    def along(tau: FloatArray) -> FloatArray:
        eta = np.asarray(1j * tau, dtype=np.complex128)
        stress = (
            in_plate(eta, pressure, body.kappa) if body.name == "hole" else in_pin(eta, pressure)
        )
        return equivalent(stress, body.nu, criterion)

    reach = np.minimum(_DEPTH * pressure.b, _FARTHEST[body.name])
    low, high, points = np.zeros_like(reach), reach, _COARSE
    for _ in range(1 + _PASSES):
        tau = low + (high - low) * np.linspace(0, 1, points)
        values = along(tau)
        best = np.argmax(values, axis=1)[:, None]
        low = np.take_along_axis(tau, np.maximum(best - 1, 0), axis=1)
        high = np.take_along_axis(tau, np.minimum(best + 1, points - 1), axis=1)
        points = _FINE
    tau = np.take_along_axis(tau, best, axis=1)[:, 0]
    depth = 2 * tau / (1 - tau if body.name == "hole" else 1 + tau)
    return as_floats(values.max(axis=1)), as_floats(depth)


@lru_cache(maxsize=256)
def _table(body: Body, beta: float, criterion: Criterion) -> _Table:
    """Return the table of a body against bodies with which it has this β."""
    if abs(beta) < _SMALL_BETA:
        beta = 0.0
    series = remainder(beta)
    new = np.linspace(0, np.pi if series is None else series.top, _ARCS)
    table = _rows(new, body, beta, criterion)
    coarse = new[1:]  # the right ends of the cells to halve
    for _ in range(_HALVINGS):
        right = np.searchsorted(table.angle, coarse)
        new = (table.angle[right - 1] + coarse) / 2
        rows = _rows(new, body, beta, criterion)
        coarser = np.abs(np.interp(new, table.angle, table.ratio) / rows.ratio - 1) > _ACCURACY
        coarser |= np.abs(np.interp(new, table.angle, table.depth) - rows.depth) > _DEPTH_ACCURACY
        table = _Table(*(np.insert(old, right, add) for old, add in zip(table, rows, strict=True)))
        coarse = np.concatenate([new, coarse])[np.tile(coarser, 2)]
        coarse.sort()
        if coarse.size == 0:
            break
    return table


def _rows(angle: FloatArray, body: Body, beta: float, criterion: Criterion) -> _Table:
    """Return the rows of a table for arcs of semi-angle ε."""
    b = np.maximum(np.tan(angle / 2), _HERTZ_B)
    strongest, depth = largest_on_axis(body, pressure_along(b, beta), criterion)
    return _Table(
        angle, as_floats(strongest / persson_peak(b)), as_floats(depth * (1 + b**2) / (2 * b))
    )


def _of_hole(
    pair: CylinderPair, stresses: tuple[FloatArray, FloatArray], criterion: Criterion
) -> FirstYield:
    """Return the first yield of a pin in a hole: many kinds of joints by `many_yields`."""
    R_i, R_j = pair.radii("the yield load")
    (kappa_i, kappa_j), (nu_i, nu_j) = pair.kolosov, _across(pair)
    R, unit = as_floats(np.sqrt(R_i * R_j)), pair.E_star * as_floats(pair.dR)
    strengths = [as_floats(stress * R / unit) for stress in stresses]
    joints = pair.shares[0], pair.beta, kappa_i, nu_i, kappa_j, nu_j
    columns = np.broadcast_arrays(R, unit, *strengths, *joints)
    shape = columns[0].shape
    R, unit, *rows = (column.ravel() for column in columns)
    found = np.full((3, R.size), np.nan)  # φ, whether it is in the pin, and the depth over R
    if R.size > _FEW and fewest_kinds(rows[3:]) > _FEW:
        from cylcontact.limits.many_yields import tables, yields_of_many  # which imports numba

        tables()  # made once, before threads would make them twice

        def fill(here: slice) -> None:
            block = np.stack([row[here] for row in rows])
            found[:, here] = yields_of_many(block[2:], block[:2], criterion == "Tresca")

        on_all_cores(fill, blocks(R.size, _ROWS))
    left = np.flatnonzero(np.isnan(found[0]))
    if left.size:
        found[:, left] = _searched([row[left] for row in rows], criterion)
    phi, in_pin, depth = found
    return FirstYield(
        as_floats((phi * unit).reshape(shape)),
        np.where(in_pin > 0, "pin", "hole").reshape(shape)[()],
        as_floats((depth * R).reshape(shape)),
        criterion,
    )


def _searched(rows: Sequence[FloatArray], criterion: Criterion) -> FloatArray:
    """Return φ of first yield, whether it is in the pin, and the depth over R, by tables."""
    found = np.empty((3, rows[0].size))
    strengths, w_i = rows[:2], rows[2]
    kinds, places = distinct_columns(rows[3:])
    for (beta, *numbers), here in zip(kinds.T.tolist(), places, strict=True):
        bodies = Bodies(w_i[here], beta, np.zeros(1))
        both = Body("hole", *numbers[:2]), Body("pin", *numbers[2:])
        (phi, depth), (of_pin, depth_of_pin) = (
            _first_arc(strength[here], bodies, _table(body, beta, criterion))
            for body, strength in zip(both, strengths, strict=True)
        )
        in_pin = of_pin < phi
        found[:, here] = (
            np.where(in_pin, of_pin, phi), in_pin, np.where(in_pin, depth_of_pin, depth)
        )  # fmt: skip
    return found


def _first_arc(
    strength: FloatArray, bodies: Bodies, table: _Table
) -> tuple[FloatArray, FloatArray]:
    """Return φ at which φ·m = T, and the depth of yield in units of R.

    The slope of ln φm over ln φ is about 1/2 for small arcs and 1 for large ones, so that steps
    with the slope 3/4 converge from any start.
    """
    phi = np.minimum(np.pi * (strength / table.ratio[0]) ** 2, 2 * strength)
    for _ in range(_STEPS):
        arc = bodies.arc_of_load(phi)
        b, angle = np.sqrt(arc.b2), arc.angle
        m = persson_peak(b) * np.interp(angle, table.angle, table.ratio)
        phi = phi * (strength / (phi * m)) ** (4 / 3)
    return as_floats(phi), as_floats(_depth(angle, table) * np.sin(angle))


def _depth(angle: FloatArray, table: _Table) -> FloatArray:
    """Return the depth over R·sin ε: interpolated; next to a jump, the nearest value."""
    cell = np.clip(np.searchsorted(table.angle, angle) - 1, 0, table.angle.size - 2)
    ends = np.stack([table.depth[cell], table.depth[cell + 1]])
    start, end = table.angle[cell], table.angle[cell + 1]
    share = (angle - start) / (end - start)
    nearest = np.where(share < 0.5, *ends)
    between = ends[0] + share * (ends[1] - ends[0])
    return as_floats(np.where(np.all(ends > 0, axis=0), between, nearest))


def _of_rollers(
    pair: CylinderPair, stresses: tuple[FloatArray, FloatArray], criterion: Criterion
) -> tuple[list[FloatArray], list[FloatArray]]:
    """Return the load of first yield in each of two rollers, by Hertz's stresses on the axis."""
    loads, depths = [], []
    for stress, nu in zip(stresses, _across(pair), strict=True):
        distinct, which = np.unique(nu, return_inverse=True)
        tables = [_at_hertz(value, criterion) for value in distinct.tolist()]
        ratio, depth = np.array(tables).T[:, which.reshape(np.shape(nu))]
        load = np.pi * (stress / ratio) ** 2 * pair.R / pair.E_star
        loads.append(as_floats(load))
        depths.append(as_floats(depth * 2 * np.sqrt(load * pair.R / (np.pi * pair.E_star))))
    return loads, depths


@lru_cache(maxsize=256)
def _at_hertz(nu: float, criterion: Criterion) -> tuple[float, float]:
    """Return m over the peak pressure and the depth over the half-width, for a flat surface."""
    b = np.array([_HERTZ_B])
    m, depth = largest_on_axis(Body("pin", 1.0, nu), pressure_along(b, 0.0), criterion)
    return (m / persson_peak(b)).item(), (depth / (2 * b)).item()


def _across(pair: CylinderPair) -> tuple[FloatArray, FloatArray]:
    """Return σ_zz/(σ_rr + σ_θθ) in bodies i and j."""
    share = 0.0 if pair.plane == "stress" else 1.0
    return share * as_floats(pair.material_i.nu), share * as_floats(pair.material_j.nu)
