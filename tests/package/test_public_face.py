"""What completion shows of the package is what a user needs, and all of it is there."""

import importlib
import subprocess
import sys

import pytest

FACES = (
    "cylcontact",
    "cylcontact.datasets",
    "cylcontact.datasets.finite_element",
    "cylcontact.export",
    "cylcontact.fitting",
    "cylcontact.laws",
    "cylcontact.mechanism",
    "cylcontact.plots",
    "cylcontact.reports",
)


@pytest.mark.parametrize("name", FACES)
def test_completion_shows_the_public_names_and_nothing_else(name):
    face = importlib.import_module(name)
    visible = {entry for entry in dir(face) if not entry.startswith("__")}
    assert visible == set(face.__all__)
    assert all(hasattr(face, entry) for entry in face.__all__)


@pytest.mark.slow
def test_the_parts_of_the_package_need_no_import_of_their_own():
    code = (
        "import cylcontact as cc; print(callable(cc.mechanism.simulate), "
        "callable(cc.fitting.calibrate), callable(cc.datasets.read_grid), "
        "callable(cc.datasets.finite_element.solve), callable(cc.reports.write_figures))"
    )
    printed = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert printed.stdout.split() == ["True"] * 5
