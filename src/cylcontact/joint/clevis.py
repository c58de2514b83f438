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

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import CylinderPair
from cylcontact.joint.bush import Limits, limits_of, shown
from cylcontact.laws import Conformal, Housing
from cylcontact.support.arrays import BoolArray, FloatArray, as_floats, require, require_positive
from cylcontact.support.errors import InputError
from cylcontact.support.text_tables import TextTable

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

__all__ = ["Clevis", "ClevisCheck", "ClevisNumbers", "Plate", "check_clevis"]

_SOURCE = "clevis"
# The share of a penetration that neighbours take part in, and over which length in R, by the hole's
# material and by the pin's.
_SHARE, _HOLE, _PIN = 0.76, 0.32, 0.073
# The plane law is that of a plate clamped at so many radii.
_LOCAL = 4.0
# Means of the line load are over these lengths from an edge, in R.
EDGES = (0.1, 0.25)
# The largest axial stress over 32M/(πd³), and how much too low the moment may be in lugs.
_PEAK, _LUG = 1.06, 1.10
# Elements of the beam in half the eye, in the gap and in a cheek.
_MESH = (32, 4, 26)
# Points of the law's table, and steps of the search.
_TABLE, _STEPS = 200, 200
# The factor on the force of a second solution, for the stiffness.
_MORE = 1.01
# The search ends when no line load changes by this part of the nominal one.
_SETTLED = 1e-8
# Ranges that were compared with elements: E of pin over E of plate, thickness, gap and R_o over R.
_STIFF = 20e3  # MPa
_RANGES = {"thickness": (0.3, 6.7), "gap": (0.05, 1.0), "R_o": (1.6, np.inf)}
COLUMNS = ("tightest", "middle", "loosest")
NOT_INCLUDED = (
    "the ultimate load of pin and lugs, friction, chamfers, hollow pins, heads and nuts, a load "
    "beside the axis of the lug, plastic flow"
)


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
            require_positive(value, _SOURCE, key, "give it in mm")
        rule, remedy = "must not be negative", "give 0 for a pin that is flush with the cheek"
        require(0 <= self.beyond < np.inf, _SOURCE, "beyond", self.beyond, rule, remedy)
        pin = limits_of(self.diameter, "diameter", _SOURCE)
        for key, plate in self.plates.items():
            hole = limits_of(plate.hole, f"{key}.hole", _SOURCE)
            rule = f"leaves no clearance for a pin of {shown(self.diameter)}"
            require(hole[0] > pin[1], _SOURCE, f"{key}.hole", plate.hole, rule, "give a wider hole")
            known = plate.housing is None or plate.housing.g is None
            rule, remedy = "is given by compliances, without its rings", "give its R_o and clamp"
            require(known, _SOURCE, f"{key}.housing", str(plate.housing), rule, remedy)

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


@dataclass(frozen=True)
class ClevisNumbers:
    """Results for one clevis of the band; NaN if unknown.

    Attributes
    ----------
    pin_mm, eye_clearance_um, cheek_clearance_um : float
        The diameter of the pin, and the radial clearances.
    movement_um, elastic_um : float
        Of the eye against the cheeks along the load, with and without the clearances.
    stiffness_N_per_mm : float
        Of the whole joint, for a force between eye and cheeks.
    moment_Nmm, shear_plane_moment_Nmm, bending_stress_MPa, pin_factor : float
        Of the pin: in the middle of the eye, at the eye's face; 1.06·32M/(πd³), NaN for a pin that
        is shorter than its diameter; and the factor to its yield, in a lug with a tenth more.
    eye_edge, cheek_edge : tuple of float
        The mean line load in N/mm over 0.1 R and 0.25 R from the inner edge.
    eye_ratio, cheek_ratio : tuple of float
        The same over the nominal line load.
    eye_pressure_MPa, cheek_pressure_MPa : tuple of float
        The largest pressure of the plane law under these loads.
    """

    pin_mm: float
    eye_clearance_um: float
    cheek_clearance_um: float
    movement_um: float
    elastic_um: float
    stiffness_N_per_mm: float
    moment_Nmm: float
    shear_plane_moment_Nmm: float
    bending_stress_MPa: float
    pin_factor: float
    eye_edge: tuple[float, float]
    cheek_edge: tuple[float, float]
    eye_ratio: tuple[float, float]
    cheek_ratio: tuple[float, float]
    eye_pressure_MPa: tuple[float, float]
    cheek_pressure_MPa: tuple[float, float]


class State(NamedTuple):
    """A clevis under a force: points in the plates, line loads, moment along the pin, movement."""

    z: FloatArray  # mm from the middle of the eye
    weights: FloatArray  # mm
    in_eye: BoolArray
    line_load: FloatArray  # N/mm
    at: FloatArray  # mm
    moment: FloatArray  # N mm
    movement: float  # mm


@dataclass(frozen=True, eq=False)
class ClevisCheck:
    """A clevis under a force with its answer; `check_clevis` makes it.

    Attributes
    ----------
    clevis : Clevis
    force : float
        On the eye in N.
    band : dict of ClevisNumbers
        "tightest", "middle" and "loosest", or "joint" for sizes without limits.
    states : dict of State
        Line load and moment along the pin.
    rules : dict of float
        The moment in N mm by the rules that designers use.
    """

    clevis: Clevis
    force: float
    band: dict[str, ClevisNumbers]
    states: dict[str, State]
    rules: dict[str, float]

    @property
    def needed_moment(self) -> float:
        """The largest moment of the band in N mm, in a lug a tenth more."""
        return max(each.moment_Nmm for each in self.band.values()) * _margin(self.clevis)

    @property
    def factor(self) -> float:
        """The lowest factor to yield of the pin; NaN if it is not known."""
        return min(each.pin_factor for each in self.band.values())

    @property
    def warnings(self) -> tuple[str, ...]:
        """What is doubtful, a sentence each."""
        return tuple(_warnings(self))

    @property
    def table(self) -> pd.DataFrame:
        """The numbers as a table: a row for each, a column for each clevis of the band."""
        import pandas as pd

        return pd.DataFrame({name: _flat(numbers) for name, numbers in self.band.items()})

    def __str__(self) -> str:
        parts = [*_described(self), "", str(TextTable(*cells(self))), "", *summary(self)]
        return "\n".join([*parts, "", f"not included  {NOT_INCLUDED}"])

    def _repr_html_(self) -> str:
        return TextTable(*cells(self), _described(self)[0])._repr_html_()

    def to_dict(self) -> dict[str, Any]:
        """Return the clevis and its numbers under plain names, for JSON; None for the unknown."""
        clevis = self.clevis
        return {
            "pin": clevis.pin.title,
            "diameter_mm": list(limits_of(clevis.diameter, "diameter", _SOURCE)),
            **{
                name: {
                    "thickness_mm": plate.thickness,
                    "material": plate.material.title,
                    "hole_mm": list(limits_of(plate.hole, "hole", _SOURCE)),
                    "housing": str(plate.housing) if plate.housing else None,
                }
                for name, plate in clevis.plates.items()
            },
            "gap_mm": clevis.gap,
            "beyond_mm": clevis.beyond,
            "force_N": self.force,
            "rules_Nmm": self.rules,
            "needed_moment_Nmm": self.needed_moment,
            "pin_factor": _finite(self.factor),
            "warnings": list(self.warnings),
            "not_included": NOT_INCLUDED,
            "numbers": {
                name: {key: _finite(value) for key, value in _flat(numbers).items()}
                for name, numbers in self.band.items()
            },
        }

    def to_json(self) -> str:
        """Return `to_dict` as JSON."""
        return json.dumps(self.to_dict(), ensure_ascii=False, indent=1)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the line load along the pin beside the uniform one.

        The first 0.02 R at an edge are left out: the load there is no number.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw into; by default those of a new figure.
        """
        from cylcontact.joint.clevis_page import draw_line_load

        return draw_line_load(self, ax)

    def save(self, path: Path | str) -> Path:
        """Write the answer on one page, .html, .pdf or .png, with a sketch and the line load."""
        from cylcontact.joint.clevis_page import page_of
        from cylcontact.joint.page import write_page

        return write_page(page_of(self), path)


def check_clevis(clevis: Clevis, force: float) -> ClevisCheck:
    """Check a clevis under a force: movement, bending of the pin, load at the edges.

    Parameters
    ----------
    clevis : Clevis
    force : float
        On the eye in N, along the axis of lugs.

    Returns
    -------
    ClevisCheck

    Raises
    ------
    InputError
        If the force is not positive, or the contact does not settle.

    Notes
    -----
    The model is described in `cylcontact.joint.clevis`. Beside finite elements in three dimensions,
    of metals and plates clamped at four radii, movement is within 3 % and moment within 5 %, the
    means over 0.1 R within 7 % (12 % in aluminium plates), over 0.25 R within 7 %. In lugs of
    R_o/R = 2 the movement is within 3 %, the moment up to 7 % low, the mean over 0.1 R of the eye
    up to 17 % high, in thin lugs (1.6) 9 % low and 27 % high; so the factor of the pin takes a
    tenth more in a lug. A largest line load is no number: at a sharp edge it grows with the
    fineness of any mesh. For the same reason eye and cheek have no factor to yield.
    """
    require_positive(force, _SOURCE, "force", "give it in N")
    band, states = {}, {}
    for name, (pin, eye, cheek) in _columns(clevis).items():
        solver = _Solver(clevis, pin / 2, (eye - pin) / 2, (cheek - pin) / 2)
        laws = solver.laws_at(force)
        states[name] = state = solver.solve(force, laws)
        more = solver.solve(_MORE * force, solver.laws_at(_MORE * force))
        stiffness = (_MORE - 1) * force / (more.movement - state.movement)
        band[name] = _numbers(solver, laws, state, force, stiffness)
    return ClevisCheck(clevis, float(force), band, states, clevis.rules(force))


def _columns(clevis: Clevis) -> dict[str, tuple[float, float, float]]:
    """Return diameters of the pin, of the eye's hole and of the cheeks', from tight to loose."""
    pin = limits_of(clevis.diameter, "diameter", _SOURCE)
    holes = [limits_of(plate.hole, "hole", _SOURCE) for plate in clevis.plates.values()]
    eye, cheek = holes
    middle = sum(pin) / 2, sum(eye) / 2, sum(cheek) / 2
    if all(low == high for low, high in (pin, eye, cheek)):
        return {"joint": middle}
    return {
        "tightest": (pin[1], eye[0], cheek[0]),
        "middle": middle,
        "loosest": (pin[0], eye[1], cheek[1]),
    }


def _is_soft(clevis: Clevis) -> bool:
    """Return whether a plate has a housing, in which the moment may be low."""
    return any(plate.housing is not None for plate in clevis.plates.values())


def _margin(clevis: Clevis) -> float:
    return _LUG if _is_soft(clevis) else 1.0


def _numbers(
    solver: _Solver,
    laws: Mapping[str, _PlateLaw],
    state: State,
    force: float,
    stiffness: float,
) -> ClevisNumbers:
    """Return the numbers of a state."""
    clevis, R = solver.clevis, solver.R
    q = np.where(state.in_eye, -1.0, 1.0) * state.line_load * state.weights
    face = clevis.eye.thickness / 2
    moment = float(q @ state.z)
    stress = _PEAK * 4 * moment / (np.pi * R**3)
    if clevis.pin_length < 2 * R:
        stress = np.nan
    yields = clevis.pin.yield_stress
    factor = np.nan if yields is None else yields / (stress * _margin(clevis))
    found: dict[str, Any] = {}
    nominal = {"eye": force / clevis.eye.thickness, "cheek": force / 2 / clevis.cheek.thickness}
    inner = {"eye": face, "cheek": face + clevis.gap}
    for name, law in laws.items():
        part = state.in_eye if name == "eye" else ~state.in_eye
        distance = np.abs(state.z[part] - inner[name])
        loads = tuple(
            _mean(distance, state.weights[part], state.line_load[part], share * R)
            for share in EDGES
        )
        found[f"{name}_edge"] = loads
        found[f"{name}_ratio"] = tuple(load / nominal[name] for load in loads)
        found[f"{name}_pressure_MPa"] = tuple(law.peak_pressure(load) for load in loads)
    clearances = solver.clearances
    return ClevisNumbers(
        pin_mm=2 * R,
        eye_clearance_um=1e3 * clearances["eye"],
        cheek_clearance_um=1e3 * clearances["cheek"],
        movement_um=1e3 * state.movement,
        elastic_um=1e3 * (state.movement - sum(clearances.values())),
        stiffness_N_per_mm=stiffness,
        moment_Nmm=moment,
        shear_plane_moment_Nmm=float(np.maximum(state.z - face, 0) @ q),
        bending_stress_MPa=stress,
        pin_factor=factor,
        **found,
    )


def _mean(distance: FloatArray, weights: FloatArray, f: FloatArray, length: float) -> float:
    """Return the mean of f over the first `length` from an edge."""
    order = np.argsort(distance)
    reach = np.append(0.0, np.cumsum(weights[order]))
    carried = np.append(0.0, np.cumsum((weights * f)[order]))
    return float(np.interp(length, reach, carried) / min(length, reach[-1]))


class _PlateLaw:
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
class _Solver:
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

    def coupling(self, laws: Mapping[str, _PlateLaw]) -> tuple[FloatArray, FloatArray]:
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

    def laws_at(self, force: float) -> dict[str, _PlateLaw]:
        """Return the laws of both plates under a force."""
        clevis = self.clevis
        means = force / clevis.eye.thickness, force / 2 / clevis.cheek.thickness
        plates = zip(clevis.plates.items(), self.clearances.values(), means, strict=True)
        return {
            name: _PlateLaw(plate, clevis.pin, self.R, clearance, mean)
            for (name, plate), clearance, mean in plates
        }

    def solve(self, force: float, laws: Mapping[str, _PlateLaw]) -> State:
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
            raise InputError(_SOURCE, "force", force, rule, remedy)
        at = np.sort(np.append(nodes, z))
        q = np.where(in_eye, -1.0, 1.0) * f * weights
        moment = np.maximum(z - at[:, None], 0) @ q
        return State(z, weights, in_eye, f, at, as_floats(moment), float(u[-1]))

    def _depths(
        self, laws: Mapping[str, _PlateLaw], in_eye: BoolArray, f: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the penetrations of the plane laws under line loads, and their slopes."""
        eye, cheek = laws["eye"](f), laws["cheek"](f)
        depth, slope = (np.where(in_eye, a, b) for a, b in zip(eye, cheek, strict=True))
        return depth, slope


def _cumulated(x: FloatArray) -> FloatArray:
    """Return the share of exp(−|x|)/2 up to x."""
    half = 0.5 * np.exp(-np.abs(x))
    return as_floats(np.where(x < 0, half, 1 - half))


# --- the text -------------------------------------------------------------------------------------


def _flat(numbers: ClevisNumbers) -> dict[str, float]:
    """Return numbers under plain names, with the length of each mean at an edge."""
    flat = {}
    for key, value in asdict(numbers).items():
        if isinstance(value, tuple):
            stem, _, unit = key.partition("_MPa")
            for share, each in zip(EDGES, value, strict=True):
                flat[f"{stem}_{share:g}R{'_MPa' if key.endswith('_MPa') else ''}{unit}"] = each
        else:
            flat[key] = value
    return flat


_ROWS = {
    "radial clearance of the eye, µm": "eye_clearance_um",
    "radial clearance of the cheeks, µm": "cheek_clearance_um",
    "movement of the eye, µm": "movement_um",
    "of it elastic, µm": "elastic_um",
    "stiffness of the joint, N/mm": "stiffness_N_per_mm",
    "moment, middle of the eye, N mm": "moment_Nmm",
    "moment, face of the eye, N mm": "shear_plane_moment_Nmm",
    "bending stress of the pin, MPa": "bending_stress_MPa",
    "factor to yield of the pin": "pin_factor",
    "eye, mean over 0.1 R, N/mm": "eye_edge_0.1R",
    "over the nominal load": "eye_ratio_0.1R",
    "eye, mean over 0.25 R, N/mm": "eye_edge_0.25R",
    "pressure there (0.1 R), MPa": "eye_pressure_0.1R_MPa",
    "cheek, mean over 0.1 R, N/mm": "cheek_edge_0.1R",
    "over the nominal load ": "cheek_ratio_0.1R",
    "cheek, mean over 0.25 R, N/mm": "cheek_edge_0.25R",
    "pressure there (0.1 R), MPa ": "cheek_pressure_0.1R_MPa",
}


def _described(check: ClevisCheck) -> list[str]:
    """Return the clevis and its force in some lines."""
    clevis = check.clevis
    eye, cheek = clevis.eye, clevis.cheek
    lines = [
        f"{clevis.pin.title} pin {shown(clevis.diameter)}, {clevis.pin_length:g} mm long, "
        f"gaps of {clevis.gap:g} mm",
        f"eye {eye.thickness:g} mm of {eye.material.title}, hole {shown(eye.hole)}, {around(eye)}",
        f"cheeks {cheek.thickness:g} mm of {cheek.material.title}, hole {shown(cheek.hole)}, "
        f"{around(cheek)}",
        f"under {check.force:,.6g} N on the eye",
    ]
    nominal = check.force / eye.thickness, check.force / 2 / cheek.thickness
    diameter = sum(limits_of(clevis.diameter, "diameter", _SOURCE)) / 2
    lines.append(
        f"nominal line load {_text(nominal[0])} N/mm in the eye, {_text(nominal[1])} in a cheek: "
        f"{_text(nominal[0] / diameter)} and {_text(nominal[1] / diameter)} MPa over the pin's "
        "diameter"
    )
    return lines


def around(plate: Plate) -> str:
    """Return the housing of a plate in words."""
    if plate.housing is None:
        return "clamped at four radii of the pin"
    return f"in {str(plate.housing).partition(' (as ')[0]}"


def cells(check: ClevisCheck) -> tuple[list[str], list[list[str]]]:
    """Return the headings and the rows of the answer."""
    columns = [_flat(numbers) for numbers in check.band.values()]
    rows = []
    for name, key in _ROWS.items():
        values = [column[key] for column in columns]
        if not all(np.isnan(values)):
            rows.append([name.strip(), *("-" if np.isnan(v) else _text(v) for v in values)])
    return ["", *check.band], rows


def summary(check: ClevisCheck) -> list[str]:
    """Return the designers' rules beside the moment, and the factor of the pin."""
    needed, clevis = check.needed_moment, check.clevis
    raised = ", raised by a tenth as it may be low in a lug" if _is_soft(clevis) else ""
    lines = [f"moment of the pin   {_text(needed)} N mm{raised}"]
    for name, moment in check.rules.items():
        verdict = "safe" if moment >= needed else "UNSAFE"
        lines.append(f"  {name:<32}{_text(moment)} N mm, {moment / needed:.2f} of it: {verdict}")
    if clevis.pin_length < limits_of(clevis.diameter, "diameter", _SOURCE)[1]:
        lines.append("bending stress      not given: the pin is shorter than its diameter, and its "
                     "stress is one of contact")  # fmt: skip
    elif np.isnan(check.factor):
        lines.append("factor of the pin   the yield stress is not given")
    else:
        lines.append(f"factor of the pin   {check.factor:.3g} to yield, at 1.06·32M/(πd³)")
    lines.append("eye and cheeks      no factor: a sharp edge has no yield load, and a largest "
                 "line load is no number")  # fmt: skip
    return lines


def _warnings(check: ClevisCheck) -> list[str]:
    """Return where the clevis is outside of what was compared, and whether its pin yields."""
    clevis = check.clevis
    R = limits_of(clevis.diameter, "diameter", _SOURCE)[1] / 2
    found = []
    bodies = {"the pin": clevis.pin} | {f"the {k}": p.material for k, p in clevis.plates.items()}
    for name, material in bodies.items():
        if float(material.E) < _STIFF:
            found.append(
                f"{name} is of {material.title}: beside elements, soft plates moved by 8 % more "
                "and a soft pin had 9 % more moment than this answer"
            )
    sizes = {"gap": clevis.gap} | {
        f"thickness of the {k}": p.thickness for k, p in clevis.plates.items()
    }
    sizes |= {f"R_o of the {k}": p.housing.R_o for k, p in clevis.plates.items() if p.housing}
    for name, value in sizes.items():
        low, high = _RANGES[name.partition(" ")[0]]
        if not low <= value / R <= high:
            ends = f"{low:g} to {high:g}" if np.isfinite(high) else f"at least {low:g}"
            found.append(
                f"the {name} is {value / R:.2g} R; it was compared with elements for {ends} R"
            )
    if check.factor < 1:
        found.append("the pin yields in bending; this answer is elastic")
    return found


def _text(value: float) -> str:
    """Return a number with four digits and no exponent."""
    return f"{float(f'{value:.4g}'):,.10g}"


def _finite(value: float) -> float | None:
    """Return a number for JSON."""
    return float(value) if np.isfinite(value) else None
