"""What is compiled is kept for the sources that it is made of, and for no others."""

import ast
import importlib
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import cylcontact
from cylcontact.support.numba_cache import PARTS

pytestmark = pytest.mark.slow


PACKAGE = Path(cylcontact.__file__).parent
COMPILED = [
    path
    for path in PACKAGE.rglob("*.py")
    if "cylcontact.support.numba_cache import" in path.read_text(encoding="utf-8")
]
PROGRAM = """
import numpy as np, cylcontact as cc
from cylcontact.laws.kernels import kernel, kernel_load
pair = cc.CylinderPair.from_dR("internal", 0.5, cc.Material("steel", E=207e3, nu=0.3))
found = kernel(cc.laws.Johnson(), pair)
print(kernel_load(found.kind, found.parameters, 1e-3))
"""


def test_a_changed_callee_and_a_changed_constant_are_noticed(tmp_path):
    """Of both numba takes no notice by itself."""
    shutil.copytree(
        PACKAGE, tmp_path / "cylcontact", ignore=shutil.ignore_patterns("__pycache__", "html")
    )

    def load():
        run = [sys.executable, "-c", PROGRAM]
        return float(subprocess.run(run, cwd=tmp_path, capture_output=True, check=True).stdout)

    first, again = load(), load()
    assert first == again > 0
    lambert = tmp_path / "cylcontact/laws/lambert.py"
    text = lambert.read_text(encoding="utf-8")
    assert "    1.414213562373095," in text
    lambert.write_text(text.replace("    1.414213562373095,", "    1.3,"), encoding="utf-8")
    assert load() != first


def test_all_compiled_functions_are_in_those_parts():
    assert COMPILED
    assert {path.relative_to(PACKAGE).parts[0] for path in COMPILED} <= set(PARTS)


@pytest.mark.parametrize("path", COMPILED, ids=lambda path: path.stem)
def test_their_constants_are_in_those_parts_too(path):
    """What a change elsewhere does not name the cache anew for must be no number."""
    name = ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts)
    module = importlib.import_module(name)
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("cylcontact."):
            for alias in node.names:
                value = getattr(module, alias.asname or alias.name)
                assert node.module.split(".")[1] in PARTS or callable(value), alias.name
