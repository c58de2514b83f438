"""Imports point one way, and importing the package stays cheap."""

import ast
import functools
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import cylcontact

PACKAGE = Path(cylcontact.__file__).parent
# Each package may import those before it, and its own.
ORDER = (
    *("support", "files", "bodies", "laws", "limits", "impact", "datasets", "plots", "fitting"),
    *("joint", "mechanism", "export", "reports", "cli"),
)
MODULES = sorted(path for path in PACKAGE.rglob("*.py") if path != PACKAGE / "__init__.py")


def part_of(path):
    return path.relative_to(PACKAGE).with_suffix("").parts[0]


@functools.cache
def imports_of(path):
    """What a module imports from the package, anywhere in it: modules, with the names taken."""
    return [
        (node.module, [alias.name for alias in node.names])
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("cylcontact")
    ]


def imported_parts(path):
    """The parts of the package that a module imports."""
    for module, names in imports_of(path):
        parts = module.split(".")
        yield from [parts[1]] if len(parts) > 1 else names


def test_no_module_imports_from_a_later_package():
    later = [
        f"{path.relative_to(PACKAGE)} imports from {part}"
        for path in MODULES
        for part in imported_parts(path)
        if part in ORDER and ORDER.index(part) > ORDER.index(part_of(path))
    ]
    assert later == []


def imported_modules(path):
    """The modules of the package that a module imports, in functions and for types too."""
    for module, names in imports_of(path):
        for name in [module, *(f"{module}.{name}" for name in names)]:
            yield PACKAGE.parent / f"{name.replace('.', '/')}.py"


def test_no_modules_import_each_other_by_any_way_round():
    graph = {path: set(imported_modules(path)) & set(MODULES) for path in MODULES}
    assert list(TopologicalSorter(graph).static_order())


def test_no_module_is_loose_at_the_root():
    assert {part_of(path) for path in MODULES} <= set(ORDER)


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
