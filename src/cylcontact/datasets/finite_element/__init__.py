"""Finite elements for a pin in a hole, and tables of results.

The model is half of the plane problem, with structured four-node quads and frictionless contact.
In two dimensions a penetration is known only up to a constant: its dependence on load and clearance
is computed, and the constant is set by the outer radius of the plate.
"""

from cylcontact.datasets.finite_element.mesh import Setup
from cylcontact.datasets.finite_element.solver import Solution, Stress, solve
from cylcontact.datasets.finite_element.study import (
    FiniteElementTable,
    Study,
    outer_ratio_like_johnson,
    read_study,
    read_table,
    run_study,
    write_table,
)

__all__ = [
    "FiniteElementTable",
    "Setup",
    "Solution",
    "Stress",
    "Study",
    "outer_ratio_like_johnson",
    "read_study",
    "read_table",
    "run_study",
    "solve",
    "write_table",
]


def __dir__() -> list[str]:
    return __all__
