"""The parameters of a law: how a model proposes them, and how a campaign searches them."""

from __future__ import annotations

import math
from dataclasses import dataclass

__all__ = ["Parameter"]


@dataclass(frozen=True)
class Parameter:
    """A parameter of a law: searched between two bounds, fixed, or tied to others.

    Parameters
    ----------
    name : str
        Its name in campaigns and results.
    low, high : float
        Bounds of the search, if it is searched.
    nominal : float, optional
        A value to start from; that of the law's source if the model says so.
    value : float, optional
        The value that it is fixed at.
    tie : str, optional
        The expression that sets it, e.g. "a/10" (`fitting.ties`).
    shift : bool
        Whether its zero is arbitrary, so that a relative error has no meaning.
    """

    name: str
    low: float = math.nan
    high: float = math.nan
    nominal: float | None = None
    value: float | None = None
    tie: str | None = None
    shift: bool = False

    @property
    def fixed(self) -> bool:
        """Whether it is fixed."""
        return self.value is not None

    @property
    def is_free(self) -> bool:
        """Whether it is searched."""
        return not self.fixed and self.tie is None
