"""Imports point one way, and importing the package stays cheap."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import cylcontact

PACKAGE = Path(cylcontact.__file__).parent
# Each layer may import those before it, and its own.
LAYERS = (
    {"choices", "errors", "plain_text"},
    {
        "arrays",
        "files",
        "html_repr",
        "journal",
        "numba_cache",
        "parallel",
        "progress",
        "provenance",
        "reading",
        "spec",
        "tables",
        "text_tables",
        "units",
    },
    {"fits", "material_spec", "materials", "pair"},
    {"laws"},
    {"housing_spec", "stress"},
    {"yield_search"},
    {"housing_stress"},
    {"limits", "impact", "sizing"},
    {"datasets", "plots"},
    {"fitting", "mechanism"},
    {"export", "reports"},
    {"cli"},
)
MODULES = sorted(path for path in PACKAGE.rglob("*.py") if path != PACKAGE / "__init__.py")


def part_of(path):
    return path.relative_to(PACKAGE).with_suffix("").parts[0]


def layer(part):
    return next(depth for depth, parts in enumerate(LAYERS) if part in parts)


def imported_parts(path):
    """The parts of the package that a module imports, anywhere in it."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("cylcontact"):
            parts = (node.module or "").split(".")
            yield from [parts[1]] if len(parts) > 1 else [alias.name for alias in node.names]


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_no_module_imports_from_a_later_layer(path):
    own = layer(part_of(path))
    known = set().union(*LAYERS)
    later = [part for part in imported_parts(path) if part in known and layer(part) > own]
    assert not later


@pytest.mark.parametrize(
    ("name", "numbers"), [("cylcontact.limits", ()), ("cylcontact.cli.app", ("numpy",))]
)
def test_importing_the_package_leaves_the_heavy_libraries_alone(name, numbers):
    heavy = (
        *("pandas", "matplotlib", "pygad", "pydantic", "pyarrow", "joblib", "numba", "sksundae"),
        *("scipy", "cma", *numbers),
    )
    code = f"import sys, {name}; print([m for m in {heavy} if m in sys.modules])"
    actual = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert actual.stdout.strip() == "[]"
