"""The compliance of the housing around a hole: a ring, or an eye, that is clamped on its rim.

The housing i has the bore R (= 1 below) and the rim ρ = R_o/R. It differs from the infinite plate
of `cylcontact.laws.conformal` by a smooth kernel

    γ(θ, s) = Σ g_nm·cos nθ·cos ms = (πE*/2)·(compliance of the housing − that of the plate),

the compliance being the radial displacement of the bore under a radial pressure. Then

    2∫p(s)·[kernel of the plate + γ(θ, s)]ds + K − (K + L − C)·cos θ = 0,

where C is the part of the pin alone, because g_11 has the plate's. With P_m = ∫p·cos ms ds, M gains
2Σ g_nm·P_m, and the operator 1 + d²/dθ² adds Γ'(θ) = Σ(1 − n²)·g_nm·P_m·cos nθ to the equation of
`cylcontact.laws.conformal.series`. g is symmetric, so reciprocity holds as without a housing.

**A ring.** By Kolosov 2μ(u_r + i·u_θ)·e^{iθ} = κφ − z·φ̄′ − ψ̄ and σ_rr − iσ_rθ = 2Re φ′ −
e^{2iθ}(z̄·φ″ + ψ′). For cos nθ there are four terms, φ = z^(1±n) and ψ = z^(−1±n); for n = 1 the
second is φ = ln z with ψ = −κ·ln z, which has a resultant. Bonded rings of several materials share
displacements and tractions at their interfaces; rings that slide share u_r and σ_rr, and σ_rθ is
zero on both sides. With a unit pressure cos nθ on the bore, U_n =
2μu_r there and (κ + 1)/(8μ) = w_i/E*, g_nn is 2w_i/(κ + 1)·(U_n − that of the plate), and half of
it for n = 0. One ring on a rigid frame has, with Q = ρ² and Z = Qⁿ, the closed form

    g_0 = −w_i/(2 + (κ − 1)Q),
    g_n = −w_i/(n² − 1)·{Z[(n + 1)κ²Q² + (n² − 1)(n(Q − 1)² + Q²) − n(n − 1)] + 2κnQ}
          / {κQ(Z² + 1) + Z[κ²Q² + 1 + (n² − 1)(Q − 1)²]},    n ≥ 2.

**A clamped sector.** The rest of the rim is released: displacements of the free arc are a sum of
modes √(1 − x²)·U_{k−1}(x), x = angle/F, odd k in u_r and even k in u_θ, whose Fourier coefficients
are φ_kn = F·k·J_k(nF)/(nF). With D_n the tractions of the rim under its displacements and T_n those
of the bore, both without traction on the bore, the free arc has the stiffness A = Σ e_n·ρ·φ·D·φ
(e_0 = 2π, e_n = π), a pressure does the work B_kn = e_n·φ_kn·T_n on mode k, and g gains
2w_i/(π(κ + 1))·BᵀA⁻¹B/((1 + δ_n0)(1 + δ_m0)).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.bodies.material import Material
from cylcontact.bodies.pair import CylinderPair
from cylcontact.support.arrays import FloatArray, IndexArray, as_floats, as_numbers, require
from cylcontact.support.errors import InputError

# g is cut off where its terms, which fall like ρ^(−2n), are below this.
_LEAST_TERM = 1e-11
# Thinner rings need more harmonics than the series has.
_LEAST_RATIO = 1.05
# The last harmonic of one's own g over the largest, at most.
_LAST_SHARE = 1e-3
# Modes of the free arc, harmonics of its stiffness, and where D_n begins to be proportional to n.
_MODES, _RIM_HARMONICS, _LINEAR_FROM = 48, 2000, 400
# For n = 0: which terms have a part in u_r, u_θ, σ_rr, σ_rθ and the sum.
_EVEN, _ODD = [1, 0, 0, 1], [0, 1, 1, 0]
_OF_ZERO = np.array([_EVEN, _ODD, _EVEN, _ODD, _EVEN])
# Half the width of a lug's shank over R_o: the far sector that stands for it in degrees, and by how
# many percent its first yield is at most below the lug's, for R_o/R from 1.3 to 4.
_LUGS = {0.5: (60, 6), 0.75: (80, 9), 1.0: (110, 16), 1.2: (130, 23), 1.5: (140, 25)}


class Ring(NamedTuple):
    """A ring of one material: radii over the bore's, κ, and μ over that of the bore."""

    inner: float
    outer: float
    kappa: float
    mu: float
    slides: bool = False  # on the ring within, without shear between them


@dataclass(frozen=True)
class Sector:
    """The clamped part of a rim: `angle` degrees centred on the load's side or opposite.

    A rod eye is pushed or pulled by its shank, whose angle this is.

    Parameters
    ----------
    angle : float
        The whole angle of the sector in degrees, from 10 to 350.
    side : {"pushed", "pulled"}
        Whether the pin is pressed towards the sector's middle or away from it.

    Raises
    ------
    InputError
        If the angle or the side is not one of these.

    Examples
    --------
    >>> Sector(60, side="pulled")
    Sector(angle=60, side='pulled')
    """

    angle: float
    side: Literal["pushed", "pulled"] = "pushed"
    shank: float | None = field(default=None, init=False, repr=False, compare=False)  # of a lug

    def __post_init__(self) -> None:
        rule, remedy = "must be from 10 to 350 degrees", 'or write clamp="rim" for all of the rim'
        inside = is_number(self.angle) and 10 <= self.angle <= 350
        require(inside, "Sector", "angle", self.angle, rule, remedy)
        rule = "must be 'pushed' or 'pulled'"
        remedy = "pushed if the pin is pressed towards the clamp, pulled if away from it"
        require(self.side in ("pushed", "pulled"), "Sector", "side", self.side, rule, remedy)

    @classmethod
    def lug(cls, shank: float = 1.0) -> Sector:
        """Return the sector that models the shank of a lug pulled by its pin.

        It is the widest one with which first yield is nowhere above that of the lug, a round eye
        on a straight shank, by finite elements (datasets/finite_element/lug.csv) for R_o/R from 1.3
        to 4 and σ_Y·R/(E*·ΔR) from 0.3 to 6. A lug with a shank as wide as its eye yields at up to
        1.19 times this load, for R_o/R of 1.5 or more at up to 1.10 times. The penetration at first
        yield is then within 8 % of that of the lug's pin against the shank one R_o below it.

        Parameters
        ----------
        shank : float
            Half the width of the shank over R_o, at least 0.5: 1 for a parallel-sided lug. For a
            width between those of the table the sector is that of the narrower one.

        Raises
        ------
        InputError
            If the shank is narrower than half the eye.

        Examples
        --------
        >>> Sector.lug(), Sector.lug(shank=0.5)
        (Sector(angle=110, side='pulled'), Sector(angle=60, side='pulled'))
        """
        rule, remedy = "must be at least 0.5", "for a narrower shank give a Sector"
        inside = is_number(shank) and shank >= min(_LUGS)
        require(inside, "Sector.lug", "shank", shank, rule, remedy)
        sector = cls(_LUGS[max(each for each in _LUGS if each <= shank)][0], "pulled")
        object.__setattr__(sector, "shank", shank)
        return sector


@dataclass(frozen=True, eq=False)
class Kernel:
    """The symmetric g_nm of one housing, n and m from 0."""

    g: FloatArray
    rings: tuple[Ring, ...] = ()
    sector: Sector | None = None

    @cached_property
    def h(self) -> float:
        """What the housing adds to L at small loads, 2Σ g_nm."""
        return float(2 * self.g.sum())


@dataclass(frozen=True)
class Housing:
    """The body around the hole. Penetrations are then measured from its clamped rim.

    The penetration is how far the pin's centre moves against the rim, less the clearance. The
    housing is a ring between the hole and R_o, clamped on its whole rim, like a bush pressed into
    a rigid frame, or on a sector of it, like an eye on its shank.

    Parameters
    ----------
    R_o : float
        The radius of the rim in mm, larger than the hole.
    clamp : "rim" or Sector
        What is clamped of the rim.
    layers : sequence of (Material, float)
        Rings around the hole's own, from within, each with its inner radius in mm: a bush of the
        pair's material for the hole, in a lug of another.
    seat : {"bonded", "sliding"}
        Whether rings are bonded to each other, as if they were glued or cast, or only pressed
        together: a seat without friction has no shear, and stays closed.

    Raises
    ------
    InputError
        If a radius is not one positive and finite number, or the clamp or a layer is of a wrong
        type; when it is used, if the rim is not outside the hole, or the ring is thinner than 5 %
        of the hole's radius.

    Notes
    -----
    Linear elasticity of plane rings without friction, of one material for the whole housing or one
    for each layer; the pin is under a force spread evenly over its section. The coefficients of a
    whole rim are exact, those of a sector within 5e-4. A sector has a direction: the load acts
    along its middle. Terms of the order of ΔR/R are left out.
    The derivation is in `cylcontact.laws.conformal.housings`.

    Examples
    --------
    A steel pin in a bronze lug under 1 kN/mm, in a rigid frame, and in an eye pulled by its shank:

    >>> from cylcontact import CylinderPair, Material, laws
    >>> steel, bronze = Material("steel", 207e3, 0.3), Material("bronze", 110e3, 0.34)
    >>> pair = CylinderPair.internal(R_i=10.0, R_j=9.95, material=bronze, material_j=steel)
    >>> for clamp in ("rim", Sector(60, side="pulled")):
    ...     law = laws.Conformal(Housing(R_o=20.0, clamp=clamp))
    ...     print(f"{1e3 * law.penetration(1000.0, pair):.2f} µm")
    10.17 µm
    48.15 µm
    """

    R_o: float
    clamp: Literal["rim"] | Sector = "rim"
    layers: Sequence[tuple[Material, float]] = ()
    g: tuple[tuple[float, ...], ...] | None = field(default=None, repr=False)
    seat: Literal["bonded", "sliding"] = "bonded"

    def __post_init__(self) -> None:
        if self.g is not None:
            _require_own(self.g)
        else:
            layers = [
                layer if isinstance(layer, list | tuple) else (layer,) for layer in self.layers
            ]
            object.__setattr__(self, "layers", tuple(map(tuple, layers)))
            pairs = all(len(layer) == 2 and isinstance(layer[0], Material) for layer in layers)
            radii = [*(layer[-1] for layer in layers), self.R_o]
            positive = all(is_number(radius) and radius > 0 for radius in radii)
            key, rule = "R_o", "must be a number, positive and finite"
            if layers:
                key = "layers"
                rule = "must be pairs of a Material and its inner radius, increasing up to R_o"
            remedy = "give radii in mm, e.g. Housing(R_o=20.0, layers=[(lug, 12.0)])"
            sound = pairs and positive and radii == sorted(set(radii))
            require(sound, "Housing", key, self.layers or self.R_o, rule, remedy)
        known = isinstance(self.clamp, Sector) or self.clamp == "rim"
        rule, remedy = "must be 'rim' or a Sector", 'e.g. clamp=laws.Sector(60, side="pulled")'
        require(known, "Housing", "clamp", self.clamp, rule, remedy)
        rule, remedy = "must be 'bonded' or 'sliding'", "sliding for a bush that is pressed in"
        require(self.seat in ("bonded", "sliding"), "Housing", "seat", self.seat, rule, remedy)
        rule, remedy = "is for a ring around the hole's own", "give it with layers=[(lug, 12.0)]"
        require(
            self.seat == "bonded" or bool(self.layers), "Housing", "seat", self.seat, rule, remedy
        )

    def __str__(self) -> str:
        if self.g is not None:
            return "a housing of given compliances"
        joined = "bonded at {:g} mm to" if self.seat == "bonded" else "sliding at {:g} mm in"
        rings = "".join(
            f", {joined.format(radius)} one of E = {1e-3 * material.E:g} GPa"
            for material, radius in self.layers
        )
        where = "all round"
        if isinstance(self.clamp, Sector) and self.clamp.shank is not None:
            low = _LUGS[max(each for each in _LUGS if each <= self.clamp.shank)][1]
            shank = f"shank {2 * self.clamp.shank * self.R_o:g} mm wide"
            sector = f"as pulled:{self.clamp.angle:g}: first yield 0 to {low} % low"
            return f"a pulled lug of R_o = {self.R_o:g} mm, {shank}{rings} ({sector})"
        if isinstance(self.clamp, Sector):
            side = {"pushed": "near the contact", "pulled": "opposite to the contact"}[
                self.clamp.side
            ]
            where = f"on {self.clamp.angle:g}° {side}"
        return f"a ring clamped at {self.R_o:g} mm {where}{rings}"

    @classmethod
    def from_compliances(cls, g: ArrayLike | str | Path) -> Housing:
        """Return a housing of known coefficients g_nm, for example from finite elements.

        Parameters
        ----------
        g : array_like, shape (N,) or (N, N), or path
            Coefficients with n and m from 0. Under the pressure p = (f/R)·cos mθ let u be the
            radial displacement of the bore, and u_plate that of the bore of an infinite plate. With

                πE*/(2f)·(u − u_plate) = Σ_n A_nm·cos nθ

            g_nm = A_nm/π, and A_nm/(2π) for m = 0. The part of the plate in A_11 is
            w_i·π/(2(κ_i + 1)). One row is the diagonal, which is all that a whole rim has. A file
            has numbers with commas between them, a line for each n.

        Returns
        -------
        Housing

        Raises
        ------
        InputError
            If g is no such array, not symmetric, or has fewer harmonics than the kernel needs.

        Examples
        --------
        >>> from cylcontact import CylinderPair, Material, laws
        >>> pair = CylinderPair.from_dR("internal", 0.05, Material("steel", 207e3, 0.3))
        >>> law = laws.Conformal(Housing.from_compliances([-0.1, 0.4, -0.05, -0.001, 0.0]))
        >>> print(f"{1e3 * law.penetration(1000.0, pair):.2f} µm")
        10.78 µm
        """
        if isinstance(g, str | Path):
            try:
                g = np.loadtxt(g, delimiter=",", ndmin=1)
            except (OSError, ValueError) as error:
                rule, remedy = f"cannot be read as numbers: {error}", "separate g_nm by commas"
                raise InputError(str(g), "g", None, rule, remedy) from None
        table = as_numbers(g, "Housing", "g")
        table = np.diag(table) if table.ndim == 1 else np.atleast_2d(table)
        return cls(math.inf, g=tuple(map(tuple, table.tolist())))

    def constant(self, pair: CylinderPair) -> FloatArray:
        """Return C, which is the pin's part alone: the rest depends on the arc."""
        (_, w_j), (_, kappa_j) = pair.shares, pair.kolosov
        return as_floats(-w_j / (kappa_j + 1))

    def bore(self, pair: CylinderPair) -> FloatArray:
        """Return R_i in mm of a hole that the rings of this housing can surround."""
        R_i, _ = pair.radii(f"the datum {self!r}")
        inner = min([*(radius for _, radius in self.layers), self.R_o])
        key, given = ("layers" if self.layers else "R_o"), float(inner)
        rule = f"must be larger than the hole (R_i = {np.max(R_i):g} mm)"
        remedy = "the housing is clamped outside the hole"
        require(inner > R_i, "Housing", key, given, rule, remedy)
        rule = f"makes a ring thinner than {100 * (_LEAST_RATIO - 1):.0f} % of the hole's radius"
        require(inner >= _LEAST_RATIO * R_i, "Housing", key, given, rule, "give a thicker one")
        return R_i

    def kernels(self, pair: CylinderPair) -> tuple[IndexArray, list[Kernel]]:
        """Return which of the kernels that follow each element of a pair has, and the kernels."""
        if self.g is not None:
            return np.array(0), [_own_kernel(self.g)]
        R_i = self.bore(pair)
        around = [replace(pair, material_i=material) for material, _ in self.layers]
        numbers = [R_i, pair.shares[0]]
        for one in (pair, *around):
            kappa = one.kolosov[0]
            numbers += [kappa, one.moduli[0] * (kappa + 1)]  # 8μ
        columns = np.broadcast_arrays(*numbers)
        rows, which = np.unique(
            np.stack([column.ravel() for column in columns]), axis=1, return_inverse=True
        )
        return which.reshape(columns[0].shape), [self._kernel(row) for row in rows.T.tolist()]

    def _kernel(self, row: list[float]) -> Kernel:
        """Return the kernel of one pair from its R_i, w_i, and κ and 8μ of each ring."""
        R_i, w_i, *elastic = row
        # Rounded, so that housings of one shape and other sizes share what follows from it.
        ratios = (round(radius / R_i, 13) for radius in (*(r for _, r in self.layers), self.R_o))
        radii = [1.0, *ratios]
        rings = tuple(
            Ring(radii[k], radii[k + 1], elastic[2 * k], elastic[2 * k + 1] / elastic[1], slides)
            for k, slides in enumerate([False, *[self.seat == "sliding"] * len(self.layers)])
        )
        return _kernel_of(rings, w_i, None if self.clamp == "rim" else self.clamp)


@lru_cache(maxsize=256)
def _kernel_of(rings: tuple[Ring, ...], w_i: float, sector: Sector | None) -> Kernel:
    """Return the kernel of rings, clamped on the whole rim or on a sector of it."""
    return Kernel(w_i * compliances(rings, sector).g, rings, sector)


class Compliances(NamedTuple):
    """What rings do under loads cos nθ, n from 0.

    `terms`, shape (n, rings, 4, 3), are the coefficients of `michell` in each ring under a pressure
    on the bore with the rim clamped, and under 2μu_r and 2μu_θ of the rim with the bore free.
    `moved`, shape (n, 2, m), are these two displacements of the rim for each P_m.
    """

    terms: FloatArray
    moved: FloatArray
    g: FloatArray  # for w_i = 1


@lru_cache(maxsize=64)
def compliances(rings: tuple[Ring, ...], sector: Sector | None) -> Compliances:
    """Return what rings do, clamped on the whole rim or on a sector of it."""
    count = _harmonics(rings[0].outer) + 1
    n = np.arange(count if sector is None else max(count, _LINEAR_FROM + 1))
    kappa, last = rings[0].kappa, rings[-1]
    terms = _responses(n, rings)
    bore = (michell(n, rings[0], 1.0)[:, :1] @ terms[:, 0])[:, 0]
    plate = (kappa / np.maximum(n - 1, 1) + 1 / (n + 1)) / 2
    plate[:2] = 1, 0.25
    share = 2 / (kappa + 1)
    g = np.diag(share * np.where(n == 0, 0.5, 1) * (bore[:, 0] - plate))[:count, :count]
    moved = np.zeros((n.size, 2, count))
    if sector is not None:
        D = (michell(n, last, last.outer)[:, 2:4] @ terms[:, -1])[:, :, 1:]
        phi, B, A = _free_arc(sector, D, bore[:count, 1:], last.outer)
        B[:, 0] /= 2
        modes = np.linalg.solve(A, B) / np.pi
        g = g + share * (B.T @ modes)
        moved = np.stack([phi[k::2, : n.size].T @ modes[k::2] for k in range(2)], axis=1)
    return Compliances(terms, as_floats(moved), as_floats((g + g.T) / 2))


def _harmonics(ratio: float) -> int:
    """Return how many harmonics g needs for a ring of this ratio: n²·ρ^(−2n) is nothing then."""
    n = np.arange(4, 1000)
    return int(n[np.argmax(np.log(n) - n * np.log(ratio) < np.log(_LEAST_TERM) / 2)])


def _responses(n: IndexArray, rings: tuple[Ring, ...]) -> FloatArray:
    """Return the coefficients of the terms of each ring, as `Compliances` has them."""
    size = 4 * len(rings)
    system, applied = np.zeros((n.size, size, size)), np.zeros((n.size, size, 3))
    moves = n > 0  # for n = 0 a ring that slides could turn
    for k, ring in enumerate(rings):
        inner, outer = (michell(n, ring, r)[:, :4] for r in (ring.inner, ring.outer))
        own = slice(4 * k, 4 * k + 4)
        # The rows of an interface are u_r, u_θ, σ_rr and σ_rθ, equal on both sides. Where it slides
        # the shear of the outer ring is zero in the place of u_θ, and the inner's in that of σ_rθ.
        if ring.slides:
            inner[moves, 1], inner[moves, 3] = inner[moves, 3], 0.0
        if ring is not rings[-1] and rings[k + 1].slides:
            outer[moves, 1] = 0.0
        system[:, max(4 * k - 2, 0) : 4 * k + 2, own] = inner if k else inner[:, 2:]
        system[:, 4 * k + 2 : 4 * k + 6, own] = outer[:, :2] if ring is rings[-1] else -outer
    applied[:, 0, 0] = -1
    applied[:, -2:, 1:] = np.eye(2)
    return as_floats(np.linalg.solve(system, applied).reshape(n.size, len(rings), 4, 3))


def michell(n: IndexArray, ring: Ring, r: ArrayLike) -> FloatArray:
    """Return 2μu_r, 2μu_θ, σ_rr, σ_rθ and σ_rr + σ_θθ of four terms of each n at r, (..., n, 5, 4).

    μ is that of the bore, and each term is at most about 1 in its ring. For n = 0 the second and
    the third are those of a rotation and of torsion, and have no part in what is even in θ.
    """
    kappa, none, one, is_one = ring.kappa, np.zeros(n.shape), np.ones(n.shape), n == 1
    r = as_floats(r)
    rows = np.array(
        [
            [kappa - n - 1, np.where(is_one, -1, kappa - 1 + n), -one, -one],
            [kappa + n + 1, np.where(is_one, -1, n - 1 - kappa), one, -one],
            [(n + 1) * (2 - n), np.where(is_one, 3 + kappa, (1 - n) * (2 + n)), 1 - n, n + 1],
            [n * (n + 1), np.where(is_one, 1 - kappa, n * (1 - n)), n - 1, n + 1],
            [4 * (n + 1), np.where(is_one, 4, 4 * (1 - n)), none, none],
        ]
    )
    rows[:, :, n == 0] *= _OF_ZERO[:, :, None]
    grow, fall = np.log(r / ring.outer)[..., None], np.log(r / ring.inner)[..., None]
    powers = np.exp([(n + 1) * grow, (1 - n) * fall, (n - 1) * grow, -(n + 1) * fall])
    units = np.stack([0 * r + 1 / ring.mu] * 2 + [1 / r] * 3)
    terms = np.einsum("ijn,j...n,i...->...nij", rows, powers, units)
    log = 2 * kappa * np.log(r)[..., None] * powers[1] / ring.mu * is_one  # of n = 1
    terms[..., 0, 1] += log
    terms[..., 1, 1] -= log
    return as_floats(terms)


def _free_arc(
    sector: Sector, D: FloatArray, T: FloatArray, radius: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return φ and B, shape (modes, harmonics), and the stiffness A of the free arc of the rim."""
    F, phi = _modes(sector)
    n, k = np.arange(1, _RIM_HARMONICS + 1), np.arange(1, _MODES + 1)
    e = np.where(np.arange(n.size + 1) == 0, 2 * np.pi, np.pi)
    last = D.shape[0] - 1
    beyond = np.arange(last + 1, n.size + 1) / last
    D = np.concatenate([D, D[-1] * beyond[:, None, None]])
    odd, even = slice(0, None, 2), slice(1, None, 2)  # modes in u_r and u_θ
    A = np.zeros((_MODES, _MODES))
    for i, rows in enumerate((odd, even)):
        for j, columns in enumerate((odd, even)):
            A[rows, columns] = (phi[rows] * (e * radius * D[:, i, j])) @ phi[columns].T
    # The rest of Σ n·φ_kn·φ_ln, where J_k·J_l is cos((k − l)π/2)/(πnF) on average.
    pairs = k[:, None] * k * np.cos((k[:, None] - k) * np.pi / 2)
    tail = radius * pairs / (F * last * (n.size + 0.5))
    A[odd, odd] += D[last, 0, 0] * tail[odd, odd]
    A[even, even] += D[last, 1, 1] * tail[even, even]
    count = T.shape[0]
    B = np.zeros((_MODES, count))
    B[odd] = phi[odd, :count] * (e[:count] * T[:, 0])
    B[even] = phi[even, :count] * (e[:count] * T[:, 1])
    return phi, B, (A + A.T) / 2


@lru_cache(maxsize=16)
def _modes(sector: Sector) -> tuple[float, FloatArray]:
    """Return half the free arc, and the harmonics of its modes, shape (modes, harmonics)."""
    from scipy.special import jv

    F = np.pi - np.radians(sector.angle) / 2
    n, k = np.arange(1, _RIM_HARMONICS + 1), np.arange(1, _MODES + 1)[:, None]
    phi = np.hstack([F / 4 * (k == 1), k * jv(k, n * F) / n])
    if sector.side == "pushed":  # the free arc is opposite to the load
        phi[:, 1::2] *= -1
    return F, phi


def _require_own(g: tuple[tuple[float, ...], ...]) -> None:
    """Raise `InputError` unless g is square, finite, symmetric, and long enough."""
    rule, remedy = "", "give g_nm for n and m from 0, or its diagonal"
    table = np.array(g)
    if table.ndim != 2 or table.shape[0] != table.shape[1] or table.shape[0] < 3:
        rule = f"has the shape {table.shape}: must be (N,) or (N, N) with N at least 3"
    elif not np.all(np.isfinite(table)):
        rule = "must be finite"
    elif np.max(np.abs(table - table.T)) > 1e-3 * np.max(np.abs(table)):
        rule = "must be symmetric: the work of two loads does not depend on their order"
    elif np.abs(table[-1]).max() > _LAST_SHARE * np.abs(table).max():
        rule = f"has fewer harmonics than the kernel needs: that of n = {len(g) - 1} is not small"
        remedy = "give more harmonics"
    if rule:
        raise InputError("Housing", "g", None, rule, remedy)


@lru_cache(maxsize=64)
def _own_kernel(g: tuple[tuple[float, ...], ...]) -> Kernel:
    table = np.array(g)
    return Kernel(as_floats((table + table.T) / 2))


def is_number(value: object) -> bool:
    """Return whether a value is one finite number."""
    return isinstance(value, (int, float, np.number)) and bool(np.isfinite(value))
