"""Events of the integrator: onset, release, turning points of the penetration, end of the law.

Three functions of time change sign at an event,

    δ = |e| − c,    |e|·δ̇ = e·ė,    δ_limit − δ.

The second function guards the first. A root finder compares signs at the ends of a step, and a step
can skip a shallow contact or a short release. In between, δ has a turning point, which is a root of
the second function. If δ has the sign of the other mode there, the skipped crossing is located
before it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cylcontact.mechanism import contact
from cylcontact.numba_cache import compiled

__all__ = ["CROSSING", "EVENTS", "LIMIT", "TURNING", "directions", "fill_roots"]

CROSSING, TURNING, LIMIT = 0, 1, 2
EVENTS = 3


@compiled
def fill_roots(
    e_x: float, e_y: float, u_x: float, u_y: float,
    roots: NDArray[np.float64], p: NDArray[np.float64],
) -> None:  # fmt: skip
    """Write the three functions; e in m, its rate u in m/s."""
    delta = math.hypot(e_x, e_y) - p[contact.CLEARANCE]
    roots[CROSSING] = delta
    roots[TURNING] = e_x * u_x + e_y * u_y
    roots[LIMIT] = 1.0
    if p[contact.MODE] == contact.CONTACT:
        roots[LIMIT] = p[contact.STOP_PENETRATION] - delta


def directions(in_contact: bool) -> NDArray[np.int32]:
    """Return the direction in which each function must cross zero to be an event.

    Out of contact: onset and a maximum of δ. In contact: release, both kinds of turning points, as
    maxima are reported, and the limit.
    """
    return np.array([-1, 0, -1] if in_contact else [1, -1, 0], dtype=np.int32)
