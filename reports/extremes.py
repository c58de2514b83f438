"""Largest differences over a domain, converged to more digits than are printed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cylcontact.bodies.material import Material
from cylcontact.support.arrays import FloatArray

from .paper import Y_SWITCH, Domain, difference

Score = Callable[[FloatArray, FloatArray], FloatArray]
# Tells of clearances in mm and loads in N/mm whether they are left out.
Region = Callable[[FloatArray, FloatArray], NDArray[np.bool_]]
FIRST_GRID = 401
ZOOM_GRID = 21
ZOOMS = 12
BEST_LOAD_ZOOMS = 4


@dataclass(frozen=True)
class Extreme:
    """A difference in percent and where it occurs: ΔR in mm, load in N/mm."""

    percent: float
    dR: float
    load: float

    @property
    def place(self) -> str:
        """Clearance and load, the clearance in the unit that is short."""
        dR = f"{self.dR * 1e3:.3g} µm" if self.dR < 0.1 else f"{self.dR:.3g} mm"
        return f"{dR}, {self.load:.4g} N/mm"


def largest_difference(
    material: Material, domain: Domain, without: Region | None = None
) -> Extreme:
    """Return the difference of largest magnitude (Eq 9) over `domain`, `without` a part of it."""
    return _extreme(material, domain, np.abs, without)


def lowest_difference(material: Material, domain: Domain) -> Extreme:
    """Return the most negative difference (Eq 9) over `domain`."""
    return _extreme(material, domain, lambda percent: -percent)


def share_below(percent: float, material: Material, domain: Domain) -> float:
    """Return the percentage of `domain` in which the difference stays below `percent`.

    Measured by area on logarithmic axes, at the midpoints of a fine grid.
    """
    u, v = (np.arange(n) / n + 0.5 / n for n in (1200, 600))
    dR, load = domain.point(u[:, None], v[None, :], material)
    # v is stretched to the highest load at each ΔR: undo that to measure the true area.
    height = np.log(domain.top_load(dR, material) / domain.loads[0])
    area = np.broadcast_to(np.where(height > 0, height, 0.0), load.shape)
    below = np.abs(difference(dR, load, material)) < percent
    return float(100 * area[below].sum() / area.sum())


def best_load(material: Material, domain: Domain) -> Extreme:
    """Return the largest difference over all clearances at the load where it is least.

    If even this exceeds a bound, the bound holds for all clearances at no load.
    """
    # The law has a kink at the switch point of Y, where the difference may be largest.
    dR = np.union1d(np.geomspace(*domain.clearances, 1501), float(Y_SWITCH))
    top = domain.top_load(dR, material)
    low, high = domain.loads[0], min(domain.loads[1], float(top.max()))
    best = Extreme(np.inf, np.nan, np.nan)
    for _ in range(BEST_LOAD_ZOOMS):
        loads = np.geomspace(low, high, 61)
        worst = [_worst_clearance(load, dR[load <= top], material) for load in loads]
        i = int(np.argmin([abs(extreme.percent) for extreme in worst]))
        best = worst[i]
        low, high = loads[max(i - 2, 0)], loads[min(i + 2, loads.size - 1)]
    return best


def _worst_clearance(load: float, dR: FloatArray, material: Material) -> Extreme:
    """Return the largest difference under one load among the given clearances."""
    percent = difference(dR, load, material)
    i = int(np.argmax(np.abs(percent)))
    return Extreme(float(percent[i]), float(dR[i]), float(load))


def _extreme(
    material: Material,
    domain: Domain,
    score: Callable[[FloatArray], FloatArray],
    without: Region | None = None,
) -> Extreme:
    """Return the difference whose score is highest."""

    def scored(u: FloatArray, v: FloatArray) -> FloatArray:
        dR, load = domain.point(u, v, material)
        scores = score(difference(dR, load, material))
        return scores if without is None else np.where(without(dR, load), np.nan, scores)

    u, v = maximise(scored)
    dR, load = domain.point(u, v, material)
    return Extreme(float(difference(dR, load, material)), float(dR), float(load))


def maximise(score: Score) -> tuple[float, float]:
    """Return the point of the unit square where `score` is highest.

    A fine grid finds the hill; smaller grids around the best point so far refine it to machine
    precision. Unlike a gradient method this copes with the kinks where the highest load passes
    from one limit to another. NaN scores are skipped.

    Examples
    --------
    >>> u, v = maximise(lambda u, v: -((u - 0.3) ** 2) - (v - 1) ** 2)
    >>> print(f"{u:.6f} {v:.6f}")
    0.300000 1.000000
    """
    low, high, points = np.zeros(2), np.ones(2), FIRST_GRID
    best = low
    for _ in range(ZOOMS + 1):
        axes = np.linspace(low, high, points)
        values = score(axes[:, :1], axes[:, 1][None, :])
        i, j = np.unravel_index(np.nanargmax(values), values.shape)
        best = np.array([axes[i, 0], axes[j, 1]])
        cell = (high - low) / (points - 1)
        low, high = np.clip(best - 2 * cell, 0, 1), np.clip(best + 2 * cell, 0, 1)
        points = ZOOM_GRID
    return float(best[0]), float(best[1])
