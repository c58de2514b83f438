"""A pin in a hole by finite elements: the embedded solver against CalculiX on the same mesh."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from benchmarks.calculix import run_case
from benchmarks.harness import Row, Side, compare, require_agreement
from cylcontact.datasets.finite_element import Setup, solve

LOADS, CLEARANCE = np.array([20.0, 40.0, 100.0]), 0.1
# The two treat contact each in its own way, on the same mesh.
AGREEMENT = 0.003


def measure(short: bool) -> Iterator[list[Row]]:
    """Yield the time for the loads at one clearance."""
    setup = Setup(hole_radius=2.245, outer_ratio=3.3, E=207e3, nu=0.3, cells=8)
    loads = LOADS[:1] if short else LOADS
    sides = [
        Side(
            "cylcontact: embedded finite elements",
            lambda: [case.penetration for case in solve(setup, CLEARANCE, loads)],
        ),
        Side("CalculiX", lambda: [run_case(setup, CLEARANCE, f, loads)[0] for f in loads]),
    ]
    require_agreement(sides, AGREEMENT)
    case = f"{loads.size} loads at {CLEARANCE} mm, {setup.mesh(CLEARANCE, loads).cells:,} cells"
    yield compare("finite_element", case, sides, 1 if short else 3, "s", 1.0)
