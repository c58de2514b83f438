"""Concentric rings before any load: pressed into each other, warm or cold.

In each ring the stresses are, with three constants C, D and S,

    σ_r = C − D/r²,    σ_θ = C + D/r²,    σ_z = S,

and Hooke's law gives the displacement u and the axial strain, with T the change of temperature,

    u/r = [(1 − ν)·C − ν·S]/E + (1 + ν)·D/(E·r²) + α·T,    ε_z = (S − 2ν·C)/E + α·T

(Lamé; Timoshenko and Goodier, Theory of Elasticity, Sects. 28 and 151). Three conditions for each
ring make one linear system:

- *Radially.* The bore is free. At each interface σ_r is continuous, and the displacements differ
  by the interference i: the outer radius of the inner ring less the inner radius of the outer one,
  both unloaded at the reference temperature. The rim is free, held, or follows a frame: u = αTR_o.
- *Axially.* Free ends carry no force. σ_z is uniform in a ring, so S = 0: free ends are exactly
  plane stress, in thick and thin rings alike. Rings that are glued or cast together have one ε_z
  and no force in all, and in a frame the ε_z of the frame.

Interfaces that are only pressed together do not pull: where the pressure would be negative the
rings come apart, and the system is solved again with two free surfaces there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.material import Material, require_known_at
from cylcontact.bodies.pair import CylinderPair
from cylcontact.laws import Housing, Sector
from cylcontact.support.arrays import BoolArray, FloatArray, as_floats, as_numbers, require
from cylcontact.support.errors import InputError

__all__ = ["AtRest", "at_rest", "at_temperature", "loose_temperatures", "rings_of"]

Ends = Literal["free", "bonded"]
Rim = Material | Literal["free", "held"]

# An interface pulls if its pressure is below this part of the stiffest ring's modulus.
_NO_PRESSURE = 1e-14
# Halvings of the search for the temperature at which a pin seizes.
_HALVINGS = 60


@dataclass(frozen=True, eq=False)
class AtRest:
    """The state of concentric rings before any load; `at_rest` computes it.

    Attributes
    ----------
    materials : tuple of Material
        Of the rings, from within.
    radii : tuple of array
        The radius of the bore, of each interface and of the rim in mm.
    constants : array, shape (..., rings, 3)
        C and S in MPa and D in N of each ring.
    warmer : tuple of float
        The change of temperature of each ring in K.
    open : array of bool, shape (..., rings)
        Where the outer edge of a ring carries no pressure: an interface that is loose, or the rim.
    """

    materials: tuple[Material, ...]
    radii: tuple[FloatArray, ...]
    constants: FloatArray
    warmer: tuple[float, ...]
    open: BoolArray

    def stress(self, ring: int, r: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return σ_r, σ_θ and σ_z in MPa in a ring at r in mm, which broadcasts with the radii."""
        C, D, S = np.moveaxis(self.constants[..., ring, :], -1, 0)
        r = as_floats(r)
        return as_floats(C - D / r**2), as_floats(C + D / r**2), as_floats(S + 0 * r)

    def von_mises(self, ring: int, r: ArrayLike) -> FloatArray:
        """Return the equivalent stress in MPa in a ring at r in mm."""
        a, b, c = self.stress(ring, r)
        return as_floats(np.sqrt(((a - b) ** 2 + (b - c) ** 2 + (c - a) ** 2) / 2))

    @property
    def bore(self) -> FloatArray:
        """How far the bore has moved outwards from its unloaded radius, in mm."""
        first, R = self.materials[0], self.radii[0]
        C, D, S = np.moveaxis(self.constants[..., 0, :], -1, 0)
        strain = ((1 - first.nu) * C - first.nu * S + (1 + first.nu) * D / R**2) / first.E
        return as_floats(R * (strain + (first.thermal_expansion or 0.0) * self.warmer[0]))

    @property
    def pressures(self) -> FloatArray:
        """The pressures in MPa at the outer edges of the rings, shape (..., rings)."""
        return _pressures(self.radii, self.constants)


def at_rest(
    materials: Sequence[Material],
    radii: Sequence[ArrayLike],
    interference: ArrayLike | Sequence[ArrayLike] = 0.0,
    warmer: float | Sequence[float] = 0.0,
    rim: Rim = "free",
    ends: Ends = "free",
) -> AtRest:
    """Return the state of concentric rings that are pressed together and warmed.

    Parameters
    ----------
    materials : sequence of Material
        Of the rings, from within.
    radii : sequence of float or array
        The radius of the bore, of each interface and of the rim in mm; arrays broadcast.
    interference : float, array, or sequence of them
        Radial interference in mm at the outer edge of each ring, from within, 0 where none is
        given; negative for a gap. A number is that of the first edge.
    warmer : float or sequence of float
        The change of temperature in K of all, or of each ring and, last, of a frame.
    rim : {"free", "held"} or Material
        The rim is free, does not move, or follows a frame of this material.
    ends : {"free", "bonded"}
        Free for rings that are pressed together, whose interfaces do not pull. Bonded for rings
        that are glued or cast together: they have one axial strain, and their interfaces may pull.
        Parts are pressed at the reference temperature, with free ends.

    Returns
    -------
    AtRest

    Raises
    ------
    InputError
        If radii do not increase, an expansion coefficient is missing, a polymer of the table
        leaves room temperature, or the numbers of interferences or temperatures are wrong.

    Examples
    --------
    A bronze bush 20/26 mm, pressed into a steel ring of 52 mm with 31 µm on the diameter:

    >>> bronze = Material("bronze", 110e3, 0.34, thermal_expansion=18e-6)
    >>> steel = Material("steel", 200e3, 0.3, thermal_expansion=12e-6)
    >>> state = at_rest([bronze, steel], [10.0, 13.0, 26.0], interference=0.0155)
    >>> print(f"{state.pressures[0]:.2f} MPa, bore {1e3 * state.bore:+.2f} µm")
    28.26 MPa, bore -12.59 µm
    """
    rule, remedy = "must be 'free' or 'bonded'", "bonded for rings that are glued or cast together"
    require(ends in ("free", "bonded"), "at_rest", "ends", ends, rule, remedy)
    rings, fits, growth, shown = _system(materials, radii, interference, warmer, rim)
    if ends == "bonded":
        cold, loose = replace(rings, growths=(0.0,) * len(materials)).solve(fits, 0.0)
        hot, _ = rings.solve([as_floats(0.0)] * len(fits), growth, "bonded")
        return AtRest(rings.materials, rings.radii, as_floats(cold + hot), shown, loose)
    constants, loose = rings.solve(fits, growth)
    state = AtRest(rings.materials, rings.radii, constants, shown, loose)
    least = -_NO_PRESSURE * max(float(np.max(body.E)) for body in materials)
    while (pulled := (state.pressures < least) & ~state.open).any():
        # The edge that pulls most opens first: the others may be pressed again then.
        worst = np.argmin(np.where(pulled, state.pressures, np.inf), axis=-1)[..., None]
        opened = state.open | (pulled & (np.arange(len(materials)) == worst))
        constants, _ = rings.solve(fits, growth, loose=opened)
        state = replace(state, constants=constants, open=opened)
    return state


@dataclass(frozen=True, eq=False)
class _Rings:
    """The linear system of rings: materials, radii, α·T of each, and whether the rim touches."""

    materials: tuple[Material, ...]
    radii: tuple[FloatArray, ...]
    growths: tuple[float, ...]
    touches: bool

    def solve(
        self,
        fits: Sequence[FloatArray],
        frame: float,
        ends: Ends = "free",
        loose: BoolArray | None = None,
    ) -> tuple[FloatArray, BoolArray]:
        """Return C, D and S of each ring, shape (..., rings, 3), and which edges are loose."""
        n, bodies = len(self.materials), self.materials
        elastic = [value for body in bodies for value in (body.E, body.nu)]
        shape = np.broadcast_shapes(*(np.shape(x) for x in (*self.radii, *fits, *elastic)))
        if loose is None:
            loose = np.zeros((*shape, n), bool)
            loose[..., -1] = not self.touches
        A, b = np.zeros((*shape, 3 * n, n, 3)), np.zeros((*shape, 3 * n))
        beyond = [*self.growths[1:], frame]  # α·T of what is around each ring
        self._radial(A, b, fits, beyond, loose)
        for k, body in enumerate(bodies):
            row, E, nu = 3 * k + 2, as_floats(body.E), as_floats(body.nu)
            if ends == "free":
                A[..., row, k, 2] = 1 / E
            elif k == n - 1 and not self.touches:  # no force in all
                for j in range(n):
                    A[..., row, j, 2] = (self.radii[j + 1] ** 2 - self.radii[j] ** 2) / E
            else:
                A[..., row, k, 0], A[..., row, k, 2] = -2 * nu / E, 1 / E
                b[..., row] = beyond[k] - self.growths[k]
                if k < n - 1:
                    E, nu = as_floats(bodies[k + 1].E), as_floats(bodies[k + 1].nu)
                    A[..., row, k + 1, 0], A[..., row, k + 1, 2] = 2 * nu / E, -1 / E
        solved = np.linalg.solve(A.reshape(*shape, 3 * n, 3 * n), b[..., None])
        return as_floats(solved.reshape(*shape, n, 3)), loose

    def _radial(
        self,
        A: FloatArray,
        b: FloatArray,
        fits: Sequence[FloatArray],
        beyond: Sequence[float],
        loose: BoolArray,
    ) -> None:
        """Fill the rows of the bore and of the outer edge of each ring."""
        E, nu = ([as_floats(getattr(m, key)) for m in self.materials] for key in ("E", "nu"))

        def stress(row: int, ring: int, r: FloatArray, factor: FloatArray) -> None:
            A[..., row, ring, 0] += factor
            A[..., row, ring, 1] -= factor / r**2

        def strain(row: int, ring: int, r: FloatArray, factor: FloatArray) -> None:
            A[..., row, ring, 0] += factor * (1 - nu[ring]) / E[ring]
            A[..., row, ring, 1] += factor * (1 + nu[ring]) / (E[ring] * r**2)
            A[..., row, ring, 2] -= factor * nu[ring] / E[ring]

        stress(0, 0, self.radii[0], 1 / E[0])
        for k, r in enumerate(self.radii[1:]):
            row, shut, apart = 3 * k + 1, as_floats(~loose[..., k]), as_floats(loose[..., k])
            stress(row, k, r, apart / E[k])
            strain(row, k, r, shut)
            b[..., row] = shut * (beyond[k] - self.growths[k] - fits[k] / r)
            if k < len(E) - 1:
                strain(row, k + 1, r, -shut)
                stress(row + 2, k, r, shut / E[k])
                stress(row + 2, k + 1, r, -1 / E[k])


def _system(
    materials: Sequence[Material],
    radii: Sequence[ArrayLike],
    interference: ArrayLike | Sequence[ArrayLike],
    warmer: float | Sequence[float],
    rim: Rim,
) -> tuple[_Rings, list[FloatArray], float, tuple[float, ...]]:
    """Return rings, the interference of each edge, α·T of the frame, and T of each ring."""
    edges = [as_numbers(r, "at_rest", "radii") for r in radii]
    rule, remedy = "must be one more than the rings, and increase", "give bore, interfaces and rim"
    sound = len(edges) == len(materials) + 1
    sound = sound and all(np.all(a < b) for a, b in pairwise(edges))
    require(sound and bool(np.all(edges[0] > 0)), "at_rest", "radii", list(radii), rule, remedy)
    _require_rim(rim, "at_rest")
    fits = [as_numbers(i, "at_rest", "interference") for i in _each(interference)]
    count = len(materials) - (rim == "free")
    rule = f"has {len(fits)} values for {count} edges that touch something"
    remedy = "give one for each interface, and one for the rim if it is held"
    touching = len(fits) <= count or not np.any(np.concatenate([np.ravel(i) for i in fits]))
    require(touching, "at_rest", "interference", interference, rule, remedy)
    fits = [*fits[:count], *[as_floats(0.0)] * (len(materials) - len(fits[:count]))]
    frame = isinstance(rim, Material)
    temperatures = list(np.ravel(as_numbers(warmer, "at_rest", "warmer")).tolist())
    if np.ndim(warmer) == 0:
        temperatures *= len(materials) + frame
    rule, remedy = "must be one, or one for each ring and a frame", "give changes in K from within"
    sound = len(temperatures) == len(materials) + frame
    require(sound, "at_rest", "warmer", warmer, rule, remedy)
    bodies = [*materials, *([rim] if isinstance(rim, Material) else [])]
    growths = [_growth(*each) for each in zip(bodies, temperatures, strict=True)]
    growth = growths[-1] if frame else 0.0
    rings = _Rings(tuple(materials), tuple(edges), tuple(growths[: len(materials)]), rim != "free")
    return rings, fits, growth, tuple(temperatures[: len(materials)])


def _each(values: ArrayLike | Sequence[ArrayLike]) -> Sequence[ArrayLike]:
    """Return a number or an array alone in a list, and a list or tuple as it is."""
    return values if isinstance(values, list | tuple) else [values]  # type: ignore[list-item]


def _growth(body: Material, warmer: float) -> float:
    """Return α·T of a body."""
    known = body.thermal_expansion is not None or warmer == 0
    rule = f"needs the thermal_expansion of {body.title}, which is not known"
    remedy = "give it in 1/K: '207 GPa, 0.3, 350 MPa, 12e-6/K'"
    require(known, "a joint", "temperature", None, rule, remedy)
    require_known_at(body, warmer)
    return (body.thermal_expansion or 0.0) * warmer


def _require_rim(rim: Rim | None, source: str) -> None:
    """Raise `InputError` unless this is a state of the rim."""
    remedy = 'give "free", "held", or the material of the frame'
    rule = "is missing: how far the bore moves depends on what the rim does"
    require(rim is not None, source, "rim", None, rule, remedy)
    known = isinstance(rim, Material) or rim in ("free", "held")
    require(known, source, "rim", rim, "is not a state of the rim", remedy)


def rings_of(pair: CylinderPair, housing: Housing) -> tuple[list[Material], list[FloatArray]]:
    """Return the materials and the radii in mm of the rings of a housing around a pair's hole."""
    rule, remedy = "is given by compliances, without its rings", "give its rings, R_o and layers"
    require(housing.g is None, "at rest", "housing", housing, rule, remedy)
    R_i = housing.bore(pair)
    materials = [pair.material_i, *(body for body, _ in housing.layers)]
    return materials, [R_i, *(as_floats(r) for _, r in housing.layers), as_floats(housing.R_o)]


def loose_temperatures(
    materials: Sequence[Material],
    radii: Sequence[ArrayLike],
    interference: ArrayLike | Sequence[ArrayLike],
    rim: Rim = "free",
) -> FloatArray:
    """Return the changes of temperature in K at which pressed rings come loose.

    All rings and the frame have one temperature, and free ends. Of two rings the change is
    −i/[r·(α_inner − α_outer)], whatever their stiffness: their unloaded radii are equal then.

    Parameters
    ----------
    materials, radii, interference, rim
        As for `at_rest`.

    Returns
    -------
    array, shape (..., edges)
        For each interface and, if it is not free, the rim: negative where cold makes it loose,
        positive where heat does, inf where no change of temperature changes the pressure.

    Examples
    --------
    A PEEK bush in a steel frame, pressed by 27 µm on the radius, is loose 55 K below:

    >>> peek = Material("PEEK", 3.3e3, 0.38, thermal_expansion=50e-6)
    >>> steel = Material("steel", 200e3, 0.3, thermal_expansion=12e-6)
    >>> print(loose_temperatures([peek], [10.0, 13.0], 0.027, rim=steel).round(2))
    [-54.66]
    """
    rings, fits, growth, _ = _system(materials, radii, interference, 1.0, rim)
    none, count = [as_floats(0.0)] * len(fits), len(fits) - (not rings.touches)
    cold, _ = replace(rings, growths=(0.0,) * len(materials)).solve(fits, 0.0)
    slope, _ = rings.solve(none, growth)
    p, rate = (_pressures(rings.radii, solved)[..., :count] for solved in (cold, slope))
    least = _NO_PRESSURE * max(float(np.max(body.E)) for body in materials)
    moves = np.abs(rate) > least
    return as_floats(np.where(moves, -p / np.where(moves, rate, 1.0), np.inf))


def at_temperature(
    pair: CylinderPair,
    pin: float | None = None,
    hole: float | None = None,
    *,
    housing: Housing | None = None,
    rim: Rim | None = None,
    interference: ArrayLike | Sequence[ArrayLike] = 0.0,
    ends: Ends = "free",
    reference: float = 20.0,
) -> CylinderPair:
    """Return pin and hole with the radii that they have at other temperatures.

    Parameters
    ----------
    pair : CylinderPair
        A pin in a hole with its radii at the reference, after its rings are pressed together.
    pin, hole : float, optional
        Temperatures in °C of the pin, and of the hole with all that surrounds it; the reference if
        left out.
    housing : Housing, optional
        The rings around the hole.
    rim : {"free", "held"} or Material, optional
        What the outer rim does: it is free, does not move at all, or follows a frame of this
        material, which has the hole's temperature. Needed with a housing.
    interference : float, array, or sequence of them
        Radial interference in mm with which the rings are pressed together, as for `at_rest`.
    ends : {"free", "bonded"}
        As for `at_rest`: bonded for rings that are glued or cast together.
    reference : float
        The temperature in °C at which the pair has its radii.

    Returns
    -------
    CylinderPair

    Raises
    ------
    InputError
        If an expansion coefficient, the radii or the state of the rim is not known, a polymer of
        the table leaves room temperature, or the pin seizes; the error says at which temperature.

    Notes
    -----
    A pin grows as a free body, and a hole without a housing widens as a disk of its material would.
    One material that is warmed evenly scales its clearance, whatever surrounds it. Rings that are
    only pressed together do not pull: a bush without interference leaves its frame in the cold.
    Young's moduli and the length stay as they are. The derivation is in `cylcontact.limits.rings`.

    Examples
    --------
    >>> steel, bronze = (Material.named(name) for name in ("low-carbon steel", "bronze"))
    >>> pair = CylinderPair.internal(10.0, 9.99, pin=bronze, hole=steel)
    >>> print(f"{1e3 * at_temperature(pair, pin=80, hole=80).dR:.2f} µm")
    6.41 µm

    A PEEK bush that is pressed into a steel frame, 60 K warmer:

    >>> peek = Material("PEEK at 80 °C", 3.3e3, 0.38, thermal_expansion=50e-6)
    >>> pair = CylinderPair.internal(10.0, 9.9, pin=steel, hole=peek)
    >>> warm = at_temperature(pair, 80.0, 80.0, housing=Housing(13.0), rim=steel)
    >>> print(f"the bore moves by {1e3 * (warm.R_i - 10.0):.2f} µm")
    the bore moves by -1.74 µm
    """
    source = "at_temperature"
    rule, remedy = "has no pin and no hole", "this is for internal contact"
    require(pair.contact == "internal", source, "contact", pair.contact, rule, remedy)
    R_i, R_j = pair.radii("a temperature")
    warmer = [_warmer(T, reference, source) for T in (pin, hole)]
    if housing is None:
        for key, value in (("rim", rim), ("interference", interference)):
            given = value is not None if key == "rim" else np.any(as_floats(value) != 0)
            require(not given, source, key, value, "is for a housing", "give the housing too")
    else:
        rule, remedy = "is for a rim clamped all round", 'a rim clamped on a sector is "free"'
        whole = not isinstance(housing.clamp, Sector) or rim == "free"
        _require_rim(rim, source)
        require(whole, source, "rim", rim, rule, remedy)

    def moved(share: float) -> FloatArray:
        """Return by how much the bore moves at a share of the change of temperature."""
        if housing is None:
            return R_i * _growth(pair.material_i, share * warmer[1])
        materials, radii = rings_of(pair, housing)
        cold, hot = (
            at_rest(materials, radii, interference, T, rim or "free", ends).bore
            for T in (0.0, share * warmer[1])
        )
        return as_floats(hot - cold)

    grown = R_j * _growth(pair.material_j, warmer[0])
    widened = moved(1.0)
    dR = as_floats(as_floats(pair.dR) + widened - grown)
    if not np.all(dR > 0):
        # Loose rings make the clearance bend with the temperature, so the place is searched.
        low, high = 0.0, 1.0
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            fits = np.all(as_floats(pair.dR) + moved(middle) - middle * grown > 0)
            low, high = (middle, high) if fits else (low, middle)
        at = [reference + low * T for T in warmer]
        rule = f"seizes the pin: no clearance is left at {at[0]:.1f} °C"
        rule += "" if at[0] == at[1] else f" of the pin and {at[1]:.1f} °C of the hole"
        remedy = f"give more clearance, or keep the temperatures closer to {reference:g} °C"
        raise InputError(source, "pin", pin, rule, remedy)
    return replace(pair, dR=dR, R_i=R_i + widened, R_j=R_j + grown)


def _warmer(T: float | None, reference: float, source: str) -> float:
    """Return by how many K a body is warmer."""
    rule, remedy = "must be a temperature above -273.15 °C", "e.g. 80"
    require(T is None or -273.15 < T < np.inf, source, "temperature", T, rule, remedy)
    return 0.0 if T is None else T - reference


def _pressures(radii: Sequence[FloatArray], constants: FloatArray) -> FloatArray:
    """Return −σ_r in MPa at the outer edge of each ring, shape (..., rings)."""
    edges = [constants[..., k, 1] / r**2 - constants[..., k, 0] for k, r in enumerate(radii[1:])]
    return as_floats(np.stack(np.broadcast_arrays(*edges), axis=-1))
