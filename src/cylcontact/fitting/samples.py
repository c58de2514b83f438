"""Samples in memory, and candidates of a law evaluated on them.

The enhanced law and the power laws are a power law at each clearance, f = K*(ΔR)·E*/ΔR·δ^n(ΔR). A
population of them is a `PowerForm`, evaluated at once. A `LawForm` holds candidates of any law.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from cylcontact.arrays import FloatArray, IndexArray, as_floats
from cylcontact.datasets.grid import AnyGrid, DimensionlessGrid
from cylcontact.datasets.sampling import Block, Counts, blocks, reduce_grid
from cylcontact.errors import InputError
from cylcontact.laws.law import ContactLaw, LawModel
from cylcontact.materials import material_in_MPa
from cylcontact.pair import Contact, CylinderPair

# With E = 2 MPa and ν = 0 the composite modulus is 1 MPa.
_UNIT = material_in_MPa("of unit composite modulus", 2.0, 0.0)


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples sorted by clearance and, within one, by s."""

    contact: Contact
    # The m clearances in mm.
    dR: FloatArray
    # Of each of N samples its clearance, ln(f/E*) and ln δ, and on a dimensionless grid α and β.
    index: IndexArray
    s: FloatArray
    j: FloatArray
    dundurs: tuple[FloatArray, FloatArray] | None = None

    @cached_property
    def pair(self) -> CylinderPair:
        """The pair of each sample with E* = 1, so that its load is f/E*, in mm."""
        if self.dundurs is not None:
            return CylinderPair.from_dundurs(*self.dundurs)
        return CylinderPair.from_dR(self.contact, self.dR[self.index], _UNIT)

    @cached_property
    def load(self) -> FloatArray:
        """Loads over the composite modulus, in mm."""
        return np.asarray(np.exp(self.s))

    @cached_property
    def penetration(self) -> FloatArray:
        """Penetrations in mm."""
        return np.asarray(np.exp(self.j))

    @cached_property
    def starts(self) -> IndexArray:
        """Index of the first sample of each clearance, shape (m,)."""
        return np.searchsorted(self.index, np.arange(self.dR.size))

    def clearances(self) -> list[tuple[FloatArray, FloatArray]]:
        """Return s and j of each clearance."""
        edges = self.starts[1:]
        return list(zip(np.split(self.s, edges), np.split(self.j, edges), strict=True))


def samples_of(grid: AnyGrid, block: Block) -> Samples:
    """Return one block of samples as rows."""
    index = np.zeros(block.load.size, dtype=np.intp)
    dundurs = block.row_values if isinstance(grid, DimensionlessGrid) else None
    return Samples(grid.contact, np.array([block.dR]), index, block.s, block.j, dundurs)


def collect_samples(grid: AnyGrid) -> tuple[Samples, Counts]:
    """Sample a grid into memory, without clearances that are masked completely."""
    clearances: list[tuple[float, FloatArray, FloatArray]] = []
    masked, dundurs = 0, None
    for dR in grid.dR:
        sampled = list(blocks(grid, float(dR)))
        masked += sum(block.masked for block in sampled)
        s = np.concatenate([block.s for block in sampled])
        j = np.concatenate([block.j for block in sampled])
        order = np.argsort(s, kind="stable")
        if s.size:
            clearances.append((float(dR), s[order], j[order]))
        if isinstance(grid, DimensionlessGrid):  # of one clearance
            alpha, beta = (np.concatenate([b.row_values[k] for b in sampled]) for k in (0, 1))
            dundurs = alpha[order], beta[order]
    if not clearances:
        reduce_grid(grid)  # raises the error that names the reason
    rows = Samples(
        contact=grid.contact,
        dR=np.array([dR for dR, _, _ in clearances]),
        index=np.repeat(np.arange(len(clearances)), [s.size for _, s, _ in clearances]),
        s=np.concatenate([s for _, s, _ in clearances]),
        j=np.concatenate([j for _, _, j in clearances]),
        dundurs=dundurs,
    )
    return rows, Counts(rows.s.size, masked)


class Form(Protocol):
    """P candidates that can be compared with samples."""

    def __len__(self) -> int:
        """Return P."""
        ...

    def log_penetration_ratio(self, candidate: int, rows: Samples) -> FloatArray:
        """Return ln(δ_law/δ_reference) of each sample at equal load, shape (N,)."""
        ...

    def log_load_ratio(self, candidate: int, rows: Samples) -> FloatArray:
        """Return ln(f_law/f_reference) of each sample at equal penetration, shape (N,)."""
        ...


@dataclass(frozen=True)
class PowerForm:
    """P power laws at m clearances: c = ln ΔR − ln K* and n, NaN where K* or n is not positive."""

    c: FloatArray
    n: FloatArray

    def __len__(self) -> int:
        return len(self.n)

    def log_penetration_ratio(self, candidate: int, rows: Samples) -> FloatArray:
        """Return r = (s + c)/n − j of each sample."""
        c, n = self.c[candidate][rows.index], self.n[candidate][rows.index]
        return as_floats((rows.s + c) / n - rows.j)

    def log_load_ratio(self, candidate: int, rows: Samples) -> FloatArray:
        """Return n·j − c − s = −n·r of each sample."""
        c, n = self.c[candidate][rows.index], self.n[candidate][rows.index]
        return as_floats(n * rows.j - c - rows.s)


@dataclass(frozen=True)
class LawForm:
    """P laws of any kind; None for parameters that define none."""

    laws: tuple[ContactLaw | None, ...]

    def __len__(self) -> int:
        return len(self.laws)

    def log_penetration_ratio(self, candidate: int, rows: Samples) -> FloatArray:
        """Return ln(δ_law/δ_reference) of each sample at equal load."""
        law = self.laws[candidate]
        if law is None:
            return np.full_like(rows.s, np.nan)
        return as_floats(np.log(law.penetration(rows.load, rows.pair)) - rows.j)

    def log_load_ratio(self, candidate: int, rows: Samples) -> FloatArray:
        """Return ln(f_law/f_reference) of each sample at equal penetration."""
        law = self.laws[candidate]
        if law is None:
            return np.full_like(rows.s, np.nan)
        return as_floats(np.log(law.load(rows.penetration, rows.pair)) - rows.s)


def form_of(model: LawModel, candidates: FloatArray, dR: FloatArray) -> Form:
    """Return candidates of a model, shape (P, k), at clearances ΔR in mm, shape (m,)."""
    if model.power_form is None:
        return law_form_of(model, candidates)
    K_star, n = model.power_form(candidates, dR)
    K_star = np.where(K_star > 0, K_star, np.nan)
    return PowerForm(
        c=as_floats(np.log(dR) - np.log(K_star)), n=as_floats(np.where(n > 0, n, np.nan))
    )


def law_form_of(model: LawModel, candidates: FloatArray) -> LawForm:
    """Return the laws of candidates, shape (P, k); None for one that defines none."""
    return LawForm(tuple(_law_or_none(model, row) for row in candidates))


def _law_or_none(model: LawModel, row: FloatArray) -> ContactLaw | None:
    """Return the law of one candidate, or None."""
    try:
        return model.build(dict(zip(model.names, map(float, row), strict=True)))
    except InputError:
        return None
