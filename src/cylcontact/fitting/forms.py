"""Candidates of a law, evaluated on samples.

The enhanced law and the power laws are a power law at each clearance, f = K*(ΔR)·E*/ΔR·δ^n(ΔR). A
population of them is a `PowerForm`, evaluated at once. A `LawForm` holds candidates of any law.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.errors import InputError
from cylcontact.fitting.samples import Samples
from cylcontact.laws.contact_law import ContactLaw
from cylcontact.laws.definition import LawModel

__all__ = ["Form", "LawForm", "PowerForm", "form_of", "law_form_of"]


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
    """P power laws at m clearances.

    Attributes
    ----------
    c : array of float, shape (P, m)
        ln ΔR − ln K*; NaN where K* is not positive.
    n : array of float, shape (P, m)
        Exponent; NaN where it is not positive.
    """

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
