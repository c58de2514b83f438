"""Masses and inertias that can hardly be meant: in g for kg, or in g mm² for kg m²."""

from __future__ import annotations

import cmath
import math
from itertools import combinations
from typing import Any

__all__ = ["extent", "unusual_masses"]

# Assumed bounds, an order of magnitude or more from any machine: a body as heavy as tungsten that
# fills a cube around the whole mechanism, and radii of gyration by its extent.
_DENSITY = 20e3  # kg/m³
_SLIMMEST = 1e-3


def extent(data: dict[str, Any]) -> float:
    """Return the largest distance in m between two named points or guesses of a spec's data.

    The points of a body are placed by its guess.
    """
    places = [complex(*point) for point in data["ground"]["points"].values()]
    for body in data["bodies"].values():
        x, y, degrees = body["guess"]
        centre, turn = complex(x, y), cmath.rect(1.0, math.radians(degrees))
        places += [centre, *(centre + turn * complex(*p) for p in body["points"].values())]
    return max((abs(a - b) for a, b in combinations(places, 2)), default=0.0)


def unusual_masses(data: dict[str, Any]) -> tuple[str, ...]:
    """Return a sentence for each mass or inertia of a spec's data that can hardly be meant.

    That is a mass above 20,000 kg/m³ times the cube of the mechanism's extent, or a radius of
    gyration above the extent or below a thousandth of it.
    """
    size = extent(data)
    found = []
    for name, body in data["bodies"].items():
        mass, inertia = body["mass"], body["inertia"]
        radius = math.sqrt(inertia / mass)
        if mass > _DENSITY * size**3:
            found.append(
                f"{name} has {mass:g} kg in a mechanism of {size:.3g} m; masses are in kg, not in g"
            )
        elif not _SLIMMEST * size <= radius <= size:
            found.append(
                f"{name} has a radius of gyration of {radius:.3g} m in a mechanism of {size:.3g} m;"
                " inertias are in kg m², not in g mm² or kg mm²"
            )
    return tuple(found)
