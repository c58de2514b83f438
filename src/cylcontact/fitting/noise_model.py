"""How measurements err: scatter that grows or not, errors of the load, series, and drift.

A reading of the penetration is δ = δ_law(f) + e with a Gaussian e of the covariance

    V = diag(σ_δ² + (dδ/df)²·σ_f² + s₀² + s₁²·δ_c²) + Z·diag(τ²)·Zᵀ.

σ_δ and σ_f are given with the data: deviations of the penetration and of the load, the latter
carried over by the slope of the law (the effective variance of Orear 1982). s₀ is a constant
scatter, s₁ one in proportion to the penetration δ_c of the contact. The readings of a series share
an offset, a gain and a drift, which are the columns of Z: 1, δ_c, and the position in the series
from 0 to 1. With five series or more these effects are random with deviations τ; fewer say too
little about a deviation, and their effects are fixed, that is, fitted without any.

The deviations are estimated by restricted maximum likelihood (`restricted_likelihood`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.datasets.measurements import Indices, Measurements
from cylcontact.laws.law import ContactLaw

__all__ = [
    "FEWEST_RANDOM",
    "NOISES",
    "Covariance",
    "FittedNoise",
    "NoiseModel",
    "Whitening",
    "basis_of",
    "positions",
]

NOISES = ("constant", "proportional", "both")
# With fewer series than this, their effects are fixed.
FEWEST_RANDOM = 5


@dataclass(frozen=True)
class NoiseModel:
    """What a fit allows for; `MeasuredSpec` has the keys of a campaign.

    Attributes
    ----------
    noise : {"constant", "proportional", "both"} or None
        How the scatter of single readings grows; None if their deviations are given.
    over : str or None
        The grouping of the rows into series (`Measurements.groups`); None for one series.
    drift : bool
        Whether readings drift along a series.
    load_error : float
        Standard deviation of the loads relative to them, beside that in the data.
    has_offset : bool
        Whether the law has a free offset, which is then the mean of fixed offsets.
    """

    noise: str | None
    over: str | None = None
    drift: bool = False
    load_error: float = 0.0
    has_offset: bool = False

    @property
    def scatter(self) -> tuple[str, ...]:
        """The deviations of single readings that are estimated."""
        if self.noise is None:
            return ()
        return ("constant", "proportional") if self.noise == "both" else (self.noise,)

    @property
    def effects(self) -> tuple[str, ...]:
        """The effects that the readings of a series share."""
        series = ("offset", "gain") if self.over else ()
        return series + (("drift",) if self.drift else ())

    def covariance(self, data: Measurements, law: ContactLaw, offset: float = 0.0) -> Covariance:
        """Return the covariance of measurements for a law close to the best.

        Parameters
        ----------
        data : Measurements
            N rows.
        law : ContactLaw
            As fitted, with the compliance and the offset of the rig.
        offset : float
            Its offset in mm, which is no penetration of the contact.
        """
        load, pair, columns = data.load, data.pair, data.columns
        reading = law.penetration(load, pair)
        zero = np.zeros(len(data))
        load_std = np.hypot(columns.get("load_std", zero), self.load_error * load)
        with np.errstate(divide="ignore"):
            slope = np.where(load_std > 0, 1 / law.stiffness(reading, pair), 0.0)
        given = columns.get("penetration_std", zero) ** 2 + (slope * load_std) ** 2
        series = np.zeros(len(data), dtype=np.intp)
        if self.over is not None:
            series = data.groups(self.over)[1]
        return Covariance(
            model=self,
            load=load,
            given=as_floats(given),
            depth=as_floats(reading - offset),
            weight=data.weight,
            series=series,
            position=positions(series, columns.get("time")),
        )


def positions(series: Indices, time: FloatArray | None) -> FloatArray:
    """Return the position of each row in its series, from 0 for the first to 1 at most."""
    order = np.arange(series.size, dtype=np.float64) if time is None else time
    along, longest = np.empty(series.size), 0.0
    for number in np.unique(series):
        rows = np.flatnonzero(series == number)
        ranks = np.arange(rows.size) if time is None else order[rows] - order[rows].min()
        along[rows] = ranks
        longest = max(longest, float(ranks.max()))
    return along / longest if longest > 0 else along


@dataclass(frozen=True, eq=False)
class Covariance:
    """The covariance of N readings, but for the deviations that are to be estimated.

    Attributes
    ----------
    model : NoiseModel
        The deviations it has.
    load : array of float, shape (N,)
        Loads in N/mm.
    given : array of float, shape (N,)
        Variance of each row that is known beforehand, in mm².
    depth : array of float, shape (N,)
        Penetration of the contact in mm.
    weight : array of float, shape (N,)
        Weights of the squared residuals.
    series : array of int, shape (N,)
        The series of each row, from 0.
    position : array of float, shape (N,)
        The position of each row in its series.
    random : bool, optional
        Whether the effects of the series are random, as they stay in a part of the data; by
        default with five series or more.
    """

    model: NoiseModel
    load: FloatArray
    given: FloatArray
    depth: FloatArray
    weight: FloatArray
    series: Indices
    position: FloatArray
    random: bool | None = None

    @cached_property
    def number(self) -> int:
        """The number of series."""
        return int(np.unique(self.series).size)

    @property
    def is_random(self) -> bool:
        """Whether the effects of the series are random."""
        if self.random is not None:
            return self.random
        return bool(self.model.effects) and self.number >= FEWEST_RANDOM

    @property
    def names(self) -> tuple[str, ...]:
        """The deviations that are estimated: of single readings, then of series."""
        return self.model.scatter + (self.model.effects if self.is_random else ())

    @cached_property
    def columns(self) -> FloatArray:
        """The effects of a series on its readings, shape (N, q)."""
        shapes = {"offset": np.ones_like(self.depth), "gain": self.depth, "drift": self.position}
        named = [shapes[name] for name in self.model.effects]
        return as_floats(np.stack(named, axis=-1))

    @cached_property
    def fixed(self) -> FloatArray:
        """The columns of fixed effects, shape (N, m); none if the effects are random.

        Gains sum to zero, since their mean is the law's own stiffness; so do offsets beside a free
        offset of the law.
        """
        if self.is_random or not self.model.effects:
            return np.empty((self.depth.size, 0))
        member = self.series[:, None] == np.unique(self.series)
        parts = []
        for name, column in zip(self.model.effects, self.columns.T, strict=True):
            part = member * column[:, None]
            if name == "gain" or (name == "offset" and self.model.has_offset):
                part = part[:, 1:] - part[:, :1]
            parts.append(part)
        return as_floats(np.hstack(parts))

    def variance(self, deviations: Mapping[str, float]) -> FloatArray:
        """Return the variance of single readings in mm², shape (N,)."""
        constant = deviations.get("constant", 0.0)
        proportional = deviations.get("proportional", 0.0) * self.depth
        return as_floats(self.given + (constant**2 + proportional**2) / self.weight)

    def spread(self, deviations: Mapping[str, float]) -> FloatArray:
        """Return the deviations of the columns of Z, shape (q,)."""
        return np.array([deviations[name] for name in self.model.effects])

    def take(self, rows: Indices, series: Indices | None = None) -> Covariance:
        """Return the covariance of a selection of rows, in the series given."""
        return replace(
            self,
            load=self.load[rows],
            given=self.given[rows],
            depth=self.depth[rows],
            weight=self.weight[rows],
            series=self.series[rows] if series is None else series,
            position=self.position[rows],
            random=self.is_random,
        )

    def whitening(self, deviations: Mapping[str, float]) -> Whitening:
        """Return the map from residuals to independent ones of variance 1."""
        scale = np.sqrt(self.variance(deviations))
        blocks: list[_Block] = []
        if self.is_random:
            columns = self.columns / scale[:, None] * self.spread(deviations)
            blocks = [_random_block(rows, columns[rows]) for rows in _rows_by_size(self.series)]
        elif self.fixed.shape[1]:
            basis = basis_of(self.fixed / scale[:, None])
            rows = np.arange(scale.size)[None, :]
            blocks.append(_Block(rows, basis[None, :], np.eye(basis.shape[1])[None, :]))
        return Whitening(scale, tuple(blocks))


@dataclass(frozen=True, eq=False)
class _Block:
    """u → u − Q·S·Qᵀ·u for G series of n rows each, with orthonormal columns Q.

    `rows` has the shape (G, n), Q (G, n, m) and S (G, m, m).
    """

    rows: Indices
    Q: FloatArray
    S: FloatArray


def _rows_by_size(series: Indices) -> list[Indices]:
    """Return the rows of series of n rows for each n, shape (G, n), to treat them at once."""
    order = np.argsort(series, kind="stable")
    _, first, sizes = np.unique(series[order], return_index=True, return_counts=True)
    return [order[first[sizes == n, None] + np.arange(n)] for n in np.unique(sizes)]


def _random_block(rows: Indices, columns: FloatArray) -> _Block:
    """Return the blocks of (I + UUᵀ)^(−1/2), with U of shape (G, n, q)."""
    Q, R = np.linalg.qr(columns)
    values, vectors = np.linalg.eigh(R @ R.mT)
    shrunk = 1 - 1 / np.sqrt(1 + np.maximum(values, 0.0))
    return _Block(rows, as_floats(Q), as_floats((vectors * shrunk[:, None, :]) @ vectors.mT))


def basis_of(columns: FloatArray) -> FloatArray:
    """Return an orthonormal basis of the space of columns, which need not be independent."""
    length = np.linalg.norm(columns, axis=0)
    scaled = columns / np.where(length > 0, length, 1.0)
    left, singular, _ = np.linalg.svd(scaled, full_matrices=False)
    return as_floats(left[:, singular > 1e-10 * singular[0]])


@dataclass(frozen=True, eq=False)
class Whitening:
    """The symmetric root of V⁻¹, by rows and by series.

    Attributes
    ----------
    scale : array of float, shape (N,)
        Deviation of single readings in mm.
    blocks : tuple
        What the series take away. Fixed effects leave no trace in whitened residuals.
    """

    scale: FloatArray
    blocks: tuple[_Block, ...] = field(default=())

    def __call__(self, residuals: FloatArray) -> FloatArray:
        """Return residuals in standard deviations, shape (..., N), as independent ones."""
        u = residuals / self.scale
        for block in self.blocks:
            part = u[..., block.rows]
            shared = (part[..., None, :] @ block.Q) @ block.S @ block.Q.mT
            u[..., block.rows] = part - shared[..., 0, :]
        return as_floats(u)


@dataclass(frozen=True, eq=False)
class FittedNoise:
    """A covariance with its estimated deviations.

    Attributes
    ----------
    covariance : Covariance
        At the best parameters.
    deviations : mapping of str to float
        From `restricted_likelihood.estimate`.
    """

    covariance: Covariance
    deviations: Mapping[str, float]

    @cached_property
    def whitening(self) -> Whitening:
        """The map from residuals to independent ones of variance 1."""
        return self.covariance.whitening(self.deviations)

    @property
    def is_given(self) -> bool:
        """Whether all deviations came with the data."""
        return not self.covariance.names

    def take(self, rows: Indices, series: Indices | None = None) -> FittedNoise:
        """Return the noise of a selection of rows, in the series given."""
        return replace(self, covariance=self.covariance.take(rows, series))

    def series_effects(self, residuals: FloatArray) -> FloatArray:
        """Return the effects of each series, shape (G, q).

        Offsets and drifts are in mm, gains relative. Random effects are the best linear unbiased
        predictions, fixed ones their least squares.

        Parameters
        ----------
        residuals : array of float, shape (N,)
            Fitted less measured, in mm.
        """
        variance = self.covariance.variance(self.deviations)
        if self.covariance.is_random:
            return self._random_effects(residuals, variance)
        return self._fixed_effects(residuals, np.sqrt(variance))

    def _random_effects(self, residuals: FloatArray, variance: FloatArray) -> FloatArray:
        """Return the best linear unbiased predictions of the effects of each series."""
        covariance, spread = self.covariance, self.covariance.spread(self.deviations)
        effects = []
        for number in np.unique(covariance.series):
            rows = covariance.series == number
            columns = covariance.columns[rows] * spread
            weighted = columns.T / variance[rows]
            core = np.eye(spread.size) + weighted @ columns
            effects.append(spread * np.linalg.solve(core, weighted @ -residuals[rows]))
        return np.array(effects)

    def _fixed_effects(self, residuals: FloatArray, scale: FloatArray) -> FloatArray:
        """Return the least squares of the effects of each series."""
        covariance, names = self.covariance, self.covariance.model.effects
        weighted = covariance.fixed / scale[:, None]
        values = np.linalg.lstsq(weighted, -residuals / scale, rcond=None)[0]
        shared = covariance.fixed @ values
        member = covariance.series[:, None] == np.unique(covariance.series)
        design = (member[:, :, None] * covariance.columns[:, None, :]).reshape(len(shared), -1)
        own = np.linalg.lstsq(design, shared, rcond=None)[0]
        return as_floats(own.reshape(-1, len(names)))

    def new_variance(self, depth: FloatArray, load: FloatArray) -> FloatArray:
        """Return the variance of a new reading of a new series in mm², shape (m,).

        Parameters
        ----------
        depth : array of float, shape (m,)
            Penetration of the contact in mm.
        load : array of float, shape (m,)
            Loads in N/mm.
        """
        deviations = self.deviations
        relative = np.hypot(deviations.get("proportional", 0.0), deviations.get("gain", 0.0))
        mm = [deviations.get(name, 0.0) for name in ("constant", "offset", "drift")]
        given = np.interp(load, *self._given)
        return as_floats(given + (relative * depth) ** 2 + np.square(mm).sum())

    @property
    def _given(self) -> tuple[FloatArray, FloatArray]:
        """The loads of the data and the variance given at each, for readings between them."""
        covariance = self.covariance
        load, place = np.unique(covariance.load, return_inverse=True)
        return load, as_floats(np.bincount(place, covariance.given) / np.bincount(place))
