"""The outer radius of the plate for which finite elements agree with Johnson's law.

A plane body has no absolute approach: the outer radius sets the additive constant of the
penetration, −c·f/(πE*), and the paper does not state it. This module solves for the radius that
gives the constant of Johnson's law where that is valid. The 3.3 in `recommended.toml` is from here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cylcontact.datasets.finite_element.setup import Setup
from cylcontact.datasets.finite_element.solve import solve
from cylcontact.errors import InputError
from cylcontact.laws.logarithmic import Johnson

__all__ = ["mean_offset", "outer_ratio_like_johnson"]

# The range of the ratio that is searched, and the relative accuracy.
_BOUNDS, _XTOL = (2.0, 10.0), 2e-3


def outer_ratio_like_johnson(
    setup: Setup, dR: Sequence[float] = (1.0,), loads: Sequence[float] = (20.0, 40.0, 100.0)
) -> float:
    """Return the outer ratio at which finite elements agree with Johnson's law on average.

    Parameters
    ----------
    setup : Setup
        The set-up; its `outer_ratio` is not used.
    dR, loads : sequence of float
        In mm and N/mm, outside the conformal range: f/(E*ΔR) of 0.01 or less.

    Returns
    -------
    float
        Outer radius over the hole's radius, to 0.2 %.

    Raises
    ------
    InputError
        If no ratio between 2 and 10 makes them agree.

    Examples
    --------
    >>> setup = Setup(hole_radius=2.245, outer_ratio=5.0, E=207e3, nu=0.3, cells=6)
    >>> print(f"{outer_ratio_like_johnson(setup, [1.0], [40.0]):.1f}")
    3.4
    """
    from scipy.optimize import brentq

    def offset(log_ratio: float) -> float:
        # Nearly linear in the logarithm, like the displacement of a plane body.
        return mean_offset(replace(setup, outer_ratio=float(np.exp(log_ratio))), dR, loads)

    low, high = map(float, np.log(_BOUNDS))
    try:
        return float(np.exp(brentq(offset, low, high, xtol=_XTOL)))
    except ValueError as error:
        raise InputError(
            "finite elements",
            "outer_ratio",
            None,
            f"between {_BOUNDS[0]:g} and {_BOUNDS[1]:g} never gives Johnson's penetration",
            "choose clearances and loads outside the conformal range, the load on the pin",
        ) from error


def mean_offset(setup: Setup, dR: Sequence[float], loads: Sequence[float]) -> float:
    """Return the mean of (δ − δ_Johnson)·πE*/f, dimensionless, over clearances and loads."""
    johnson = Johnson()
    offsets = []
    for clearance in dR:
        pair = setup.pair(clearance)
        for case in solve(setup, clearance, loads):
            above = case.penetration - float(johnson.penetration(case.load, pair))
            offsets.append(above * np.pi * float(pair.E_star) / case.load)
    return float(np.mean(offsets))
