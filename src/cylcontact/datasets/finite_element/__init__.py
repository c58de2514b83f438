"""Finite elements for a pin in a hole: an embedded solver, CalculiX, and tables of results.

The model is half of the plane problem, with structured four-node quads and frictionless contact.
Two-dimensional bodies have no absolute approach: the dependence of the penetration on load and
clearance is computed, and its additive constant is set by the outer radius of the plate.
"""

from cylcontact.choices import ENGINES, Engine
from cylcontact.datasets.finite_element.elasticity import Stress
from cylcontact.datasets.finite_element.outer_ratio import outer_ratio_like_johnson
from cylcontact.datasets.finite_element.setup import Setup
from cylcontact.datasets.finite_element.solve import Solution, solve
from cylcontact.datasets.finite_element.spec import Study, read_study
from cylcontact.datasets.finite_element.study import Failure, run_study
from cylcontact.datasets.finite_element.table import FiniteElementTable, read_table, write_table

__all__ = [
    "ENGINES",
    "Engine",
    "Failure",
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
