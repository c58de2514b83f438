"""A clevis: a pin in double shear that bends, in an eye between two cheeks.

The pin is a Timoshenko beam, whose half z ≥ 0 is enough by symmetry. At each point of its length in
a plate the closing of the axis is the clearance and a penetration,

    closing = ΔR + (1 − s)·d(f) + s·∫ k(z, z')·d(f(z'))·dz' + (C − C_4)·(mean and tilt of f),

where d(f) is the exact plane law in a plate that is clamped at four radii. Three things differ from
slices that do not know of each other:

- The load of a slice also moves its neighbours: s of the penetration is spread over the length,
  with k an exponential of length 0.32 R for the hole's part of the compliance, 0.073 R for the
  pin's. The material of a hole ends at its faces, where k is mirrored; that of the pin goes on, so
  that the edges of a plate carry more.
- A housing bends or tilts a plate as one piece. What its compliance C adds to that of the plate
  clamped at four radii acts on the mean of the line load, and in a cheek whose housing is softer on
  its tilt too: a cheek leans away from a load at its inner edge.
- Where the pin does not touch there is no load: the points in contact are an active set.

s = 0.76, 0.32 and 0.073 are the only fitted numbers: to finite elements in three dimensions of
three clevises of like materials and of five unlike pairs.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import CylinderPair
from cylcontact.joint.bush import Limits, limits_of, shown
from cylcontact.laws import Conformal, Housing
from cylcontact.support.arrays import BoolArray, FloatArray, as_floats, require, require_positive
from cylcontact.support.errors import InputError

__all__ = ["Clevis", "Plate"]

SOURCE = "clevis"
# The share of a penetration that neighbours take part in, and over which length in R, by the hole's
# material and by the pin's.
_SHARE, _HOLE, _PIN = 0.76, 0.32, 0.073
# The plane law is that of a plate clamped at so many radii.
_LOCAL = 4.0
# Elements of the beam in half the eye, in the gap and in a cheek.
_MESH = (32, 4, 26)
# Points of the law's table, and steps of the search.
_TABLE, _STEPS = 200, 200
# The search ends when no line load changes by this part of the nominal one.
_SETTLED = 1e-8


@dataclass(frozen=True)
class Plate:
    """An eye or a cheek.

    Parameters
    ----------
    thickness : float
        In mm, of the whole eye or of one cheek.
    material : Material
        Of the hole; with a bush, that of the bush.
    hole : str, float or (float, float)
        The diameter of the hole in mm, limits, or a class such as "20H8"; of a bush after pressing.
    housing : Housing, optional
        The shape of the plate, with the rings around a bush as layers. Without one the plate is
        clamped all round at four radii of the pin.
    """

    thickness: float
    material: Material
    hole: Limits
    housing: Housing | None = None


@dataclass(frozen=True)
class Clevis:
    """A pin in an eye between two cheeks.

    Parameters
    ----------
    pin : Material
    diameter : str, float or (float, float)
        Of the pin in mm, limits, or a class such as "20f7".
    eye, cheek : Plate
        The eye, and one of two equal cheeks.
    gap : float
        Between the eye and a cheek in mm.
    beyond : float
        How far the pin goes beyond a cheek in mm.

    Raises
    ------
    InputError
        If a size is not positive, the pin does not fit, or a plate has no rings around its hole.

    Examples
    --------
    >>> steel = Material("steel", 207e3, 0.3, yield_stress=900.0)
    >>> eye, cheek = Plate(20.0, steel, 15.02), Plate(10.0, steel, 15.02)
    >>> clevis = Clevis(steel, 15.0, eye, cheek, gap=1.0)
    >>> from cylcontact.joint import check_clevis
    >>> numbers = check_clevis(clevis, 10e3).band["joint"]
    >>> print(f"{numbers.movement_um:.1f} µm, {numbers.moment_Nmm:,.0f} N mm")
    35.7 µm, 34,878 N mm
    """

    pin: Material
    diameter: Limits
    eye: Plate
    cheek: Plate
    gap: float
    beyond: float = 0.0

    def __post_init__(self) -> None:
        for key, value in (("gap", self.gap), ("eye.thickness", self.eye.thickness),
                           ("cheek.thickness", self.cheek.thickness)):  # fmt: skip
            require_positive(value, SOURCE, key, "give it in mm")
        rule, remedy = "must not be negative", "give 0 for a pin that is flush with the cheek"
        require(0 <= self.beyond < np.inf, SOURCE, "beyond", self.beyond, rule, remedy)
        pin = limits_of(self.diameter, "diameter", SOURCE)
        for key, plate in self.plates.items():
            hole = limits_of(plate.hole, f"{key}.hole", SOURCE)
            rule = f"leaves no clearance for a pin of {shown(self.diameter)}"
            require(hole[0] > pin[1], SOURCE, f"{key}.hole", plate.hole, rule, "give a wider hole")
            known = plate.housing is None or plate.housing.g is None
            rule, remedy = "is given by compliances, without its rings", "give its R_o and clamp"
            require(known, SOURCE, f"{key}.housing", str(plate.housing), rule, remedy)

    @property
    def plates(self) -> dict[str, Plate]:
        """Eye and cheek by their names."""
        return {"eye": self.eye, "cheek": self.cheek}

    @property
    def pin_length(self) -> float:
        """The length of the pin in mm."""
        half = self.eye.thickness / 2 + self.gap + self.cheek.thickness + self.beyond
        return 2 * half

    def rules(self, force: float) -> dict[str, float]:
        """Return the largest moment in N mm by the rules that designers use.

        Parameters
        ----------
        force : float
            On the eye in N.
        """
        eye, cheek, gap = self.eye.thickness, self.cheek.thickness, self.gap
        span = eye + 2 * gap + cheek  # between the middles of the cheeks
        return {
            "uniform bearing": force / 2 * (cheek / 2 + gap + eye / 4),
            "forces in the middles, F·L/4": force * span / 4,
            "built in, F·L/8": force * span / 8,
            "Melcon-Hoblit, least arm": force / 2 * (cheek / 2 + gap),
        }


class State(NamedTuple):
    """A clevis under a force: points in the plates, line loads, moment along the pin, movement."""

    R: float  # mm, of the pin
    z: FloatArray  # mm from the middle of the eye
    weights: FloatArray  # mm
    in_eye: BoolArray
    line_load: FloatArray  # N/mm
    at: FloatArray  # mm
    moment: FloatArray  # N mm
    movement: float  # mm


def sizes_of(clevis: Clevis) -> dict[str, tuple[float, float, float]]:
    """Return diameters of the pin, of the eye's hole and of the cheeks', from tight to loose."""
    pin = limits_of(clevis.diameter, "diameter", SOURCE)
    holes = [limits_of(plate.hole, "hole", SOURCE) for plate in clevis.plates.values()]
    eye, cheek = holes
    middle = sum(pin) / 2, sum(eye) / 2, sum(cheek) / 2
    if all(low == high for low, high in (pin, eye, cheek)):
        return {"joint": middle}
    return {
        "tightest": (pin[1], eye[0], cheek[0]),
        "middle": middle,
        "loosest": (pin[0], eye[1], cheek[1]),
    }


class PlateLaw:
    """The law of a plate clamped at four radii, as a table, and what its housing adds to it."""

    def __init__(self, plate: Plate, pin: Material, R: float, clearance: float, mean: float):
        self.pair = CylinderPair.internal(R + clearance, R, pin=pin, hole=plate.material)
        layers = [] if plate.housing is None else list(plate.housing.layers)
        inside = [(material, r) for material, r in layers if r < _LOCAL * R / 1.05]
        seat = plate.housing.seat if plate.housing is not None and inside else "bonded"
        self.law = Conformal(Housing(_LOCAL * R, layers=inside, seat=seat))
        unit = float(self.pair.E_star) * clearance
        self.loads = np.geomspace(1e-6 * unit, max(20 * unit, 100 * mean), _TABLE)
        depths = self.law.penetration(self.loads, self.pair)
        self.spline = CubicSpline(np.log(self.loads), depths)
        self.first = float(depths[0] / self.loads[0])
        self.extra = 0.0
        if plate.housing is not None:
            whole = Conformal(plate.housing).penetration(mean, self.pair)
            self.extra = float(whole - self.law.penetration(mean, self.pair)) / mean
        self.hole_share = float(self.pair.shares[0])

    def __call__(self, f: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return penetrations in mm under line loads in N/mm, and their slopes."""
        above = np.maximum(f, self.loads[0])
        low, x = f < self.loads[0], np.log(above)
        depth = np.where(low, self.first * f, self.spline(x))
        slope = np.where(low, self.first, self.spline(x, 1) / above)
        return as_floats(depth), as_floats(slope)

    def peak_pressure(self, f: float) -> float:
        """Return the largest pressure in MPa under a line load in N/mm."""
        return float(self.law.peak_pressure(f, self.pair)) if f > 0 else 0.0


@dataclass(frozen=True, eq=False)
class PinBeam:
    """One clevis of the band: radius of the pin and radial clearances in mm."""

    clevis: Clevis
    R: float
    eye_clearance: float
    cheek_clearance: float

    @property
    def clearances(self) -> dict[str, float]:
        return {"eye": self.eye_clearance, "cheek": self.cheek_clearance}

    @cached_property
    def beam(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, BoolArray, FloatArray]:
        """Nodes and stiffness; points in the plates, their weights, which are in the eye, closings.

        The unknowns are displacement and rotation of each node and, last, the movement of the eye.
        """
        clevis, R, (eye, gap, cheek) = self.clevis, self.R, _MESH
        half = clevis.eye.thickness / 2
        start = half + clevis.gap
        along = np.sin(np.pi / 2 * np.linspace(0, 1, cheek + 1)[1:]) ** 2
        nodes = np.concatenate([
            half * np.sin(np.pi / 2 * np.linspace(0, 1, eye + 1)),  # fine at the edges
            half + clevis.gap * np.linspace(0, 1, gap + 1)[1:],
            start + clevis.cheek.thickness * along,
        ])  # fmt: skip
        E, nu = float(clevis.pin.E), float(clevis.pin.nu)
        EI = E * np.pi * R**4 / 4
        # Cowper's factor of shear for a round bar.
        GA = E / (2 * (1 + nu)) * np.pi * R**2 * 6 * (1 + nu) / (7 + 6 * nu)
        size = 2 * nodes.size + 1
        K, points = np.zeros((size, size)), []
        for i, h in enumerate(np.diff(nodes)):
            at = np.arange(2 * i, 2 * i + 4)
            phi = 12 * EI / (GA * h * h)
            K[np.ix_(at, at)] += EI / (h**3 * (1 + phi)) * np.array([
                [12, 6 * h, -12, 6 * h],
                [6 * h, (4 + phi) * h * h, -6 * h, (2 - phi) * h * h],
                [-12, -6 * h, 12, -6 * h],
                [6 * h, (2 - phi) * h * h, -6 * h, (4 + phi) * h * h],
            ])  # fmt: skip
            if eye <= i < eye + gap:
                continue
            for x in (0.5 - 12**-0.5, 0.5 + 12**-0.5):  # Gauss's points
                shape = np.array([
                    1 - 3 * x**2 + 2 * x**3 + phi * (1 - x),
                    h * (x - 2 * x**2 + x**3 + phi / 2 * (x - x**2)),
                    3 * x**2 - 2 * x**3 + phi * x,
                    h * (x**3 - x**2 + phi / 2 * (x**2 - x)),
                ]) / (1 + phi)  # fmt: skip
                row = np.zeros(size)
                # The eye moves away from the pin, a cheek holds it.
                row[at], row[-1] = (-shape, 1.0) if i < eye else (shape, 0.0)
                points.append((nodes[i] + x * h, h / 2, i < eye, row))
        z, weights, in_eye, closing = (np.array(column) for column in zip(*points, strict=True))
        return nodes, K, z, weights, in_eye, closing

    def coupling(self, laws: Mapping[str, PlateLaw]) -> tuple[FloatArray, FloatArray]:
        """Return how penetrations of slices act on others, and the housings' extra compliance."""
        _, _, z, weights, in_eye, _ = self.beam
        clevis, n = self.clevis, z.size
        spread, extra = np.zeros((n, n)), np.zeros((n, n))
        half = clevis.eye.thickness / 2
        start = half + clevis.gap
        faces = {"eye": (-half, half), "cheek": (start, start + clevis.cheek.thickness)}
        for name, part in (("eye", in_eye), ("cheek", ~in_eye)):
            x, w, law = z[part], weights[part], laws[name]
            high = faces[name][0] * (name == "cheek") + np.cumsum(w)
            low = high - w
            cells = [(low, high), *([(-high, -low)] if name == "eye" else [])]

            def share(a: FloatArray, b: FloatArray, reach: float, x: FloatArray = x) -> FloatArray:
                """Return the share of a cell from a to b in the displacement at each x."""
                away = [_cumulated((x[:, None] - end) / (reach * self.R)) for end in (a, b)]
                return as_floats(away[0] - away[1])

            hole = sum(
                share(a, b, _HOLE) + sum(share(2 * f - b, 2 * f - a, _HOLE) for f in faces[name])
                for a, b in cells
            )
            pin = sum(share(a, b, _PIN) for a, b in cells)
            if name == "cheek":
                end = faces["cheek"][1] + clevis.beyond
                pin = pin + share(2 * end - high, 2 * end - low, _PIN)
            mixed = law.hole_share * hole + (1 - law.hole_share) * pin
            own = np.ix_(part, part)
            spread[own] = (1 - _SHARE) * np.eye(x.size) + _SHARE * mixed
            extra[own] = law.extra * w / w.sum()
            if name == "cheek" and law.extra > 0:
                arm = x - x @ w / w.sum()
                extra[own] += law.extra * np.outer(arm, w * arm) / (w @ arm**2)
        return spread, extra

    def laws_at(self, force: float) -> dict[str, PlateLaw]:
        """Return the laws of both plates under a force."""
        clevis = self.clevis
        means = force / clevis.eye.thickness, force / 2 / clevis.cheek.thickness
        plates = zip(clevis.plates.items(), self.clearances.values(), means, strict=True)
        return {
            name: PlateLaw(plate, clevis.pin, self.R, clearance, mean)
            for (name, plate), clearance, mean in plates
        }

    def solve(self, force: float, laws: Mapping[str, PlateLaw]) -> State:
        """Return the state under a force on the eye in N, by Newton's method on an active set."""
        nodes, K, z, weights, in_eye, closing = self.beam
        spread, extra = self.coupling(laws)
        free = np.delete(np.arange(len(K)), 1)  # no rotation in the middle of the eye
        K, B = K[np.ix_(free, free)], closing[:, free]
        load = np.zeros(free.size)
        load[-1] = force / 2
        clearance = np.where(in_eye, self.eye_clearance, self.cheek_clearance)
        nominal = force / self.clevis.eye.thickness
        f = np.where(in_eye, nominal, force / 2 / self.clevis.cheek.thickness)
        touches, u = np.ones(z.size, bool), np.zeros(free.size)
        for _ in range(_STEPS):
            depth, slope = self._depths(laws, in_eye, f)
            a = np.flatnonzero(touches)
            D, X = spread[np.ix_(a, a)], extra[np.ix_(a, a)]
            J = np.block([[K, B[a].T * weights[a]], [-B[a], D * slope[a] + X]])
            miss = np.concatenate([
                K @ u + B[a].T @ (weights[a] * f[a]) - load,
                clearance[a] + D @ depth[a] + X @ f[a] - B[a] @ u,
            ])  # fmt: skip
            step = np.linalg.solve(J, -miss)
            u = u + step[: free.size]
            new = np.zeros(z.size)
            new[a] = f[a] + step[free.size :]
            # A load that turns negative is reduced before its point is taken out.
            new = np.where(new < 0, np.where(f > 1e-3 * nominal, 0.1 * f, 0.0), new)
            gap = clearance + spread @ self._depths(laws, in_eye, new)[0] + extra @ new - B @ u
            now = (touches & (new > 0)) | (~touches & (gap < -1e-9))
            settled = np.abs(new - f).max() < _SETTLED * nominal and bool((now == touches).all())
            new[now & ~touches] = 1e-3 * nominal
            f, touches = new, now
            if settled:
                break
        else:
            rule, remedy = "does not let the contact settle", "check clearances and thicknesses"
            raise InputError(SOURCE, "force", force, rule, remedy)
        at = np.sort(np.append(nodes, z))
        q = np.where(in_eye, -1.0, 1.0) * f * weights
        moment = np.maximum(z - at[:, None], 0) @ q
        return State(self.R, z, weights, in_eye, f, at, as_floats(moment), float(u[-1]))

    def _depths(
        self, laws: Mapping[str, PlateLaw], in_eye: BoolArray, f: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the penetrations of the plane laws under line loads, and their slopes."""
        eye, cheek = laws["eye"](f), laws["cheek"](f)
        depth, slope = (np.where(in_eye, a, b) for a, b in zip(eye, cheek, strict=True))
        return depth, slope


def _cumulated(x: FloatArray) -> FloatArray:
    """Return the share of exp(−|x|)/2 up to x."""
    half = 0.5 * np.exp(-np.abs(x))
    return as_floats(np.where(x < 0, half, 1 - half))
