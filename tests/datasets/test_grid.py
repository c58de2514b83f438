"""Grid specs: what the shipped ones cover, and every way to get one wrong."""

from pathlib import Path

import numpy as np
import pytest

from cylcontact import InputError
from cylcontact.datasets import read_grid
from cylcontact.laws import REFERENCES
from tests.support.spec_files import DROP, GRID, assert_told, changed, labels, write_toml

ROOT = Path(__file__).resolve().parents[2]
# The mechanisms in the same folder are no grids.
SHIPPED = sorted(
    path for path in (ROOT / "datasets").glob("*.toml") if "[axes" in path.read_text("utf-8")
)

FULL, REAL, RATIO = (20.7, 10000.0), (20.7, 1000.0), (0.1, 0.5)
INTERNAL, EXTERNAL = (0.05, 10.0), (5.0, 500.0)
# Contact, E in GPa, ν and ΔR in mm; loads from 10 to 1000 N/mm throughout (Sects. 3.1 and 3.4).
RANGES = {
    "internal": ("internal", FULL, RATIO, INTERNAL),
    "external": ("external", FULL, RATIO, EXTERNAL),
    "internal-E1000": ("internal", REAL, RATIO, INTERNAL),
    "external-E1000": ("external", REAL, RATIO, EXTERNAL),
    "practical": ("internal", (69.0, 600.0), (0.24, 0.34), (0.0075, 2.0)),
    "large": ("internal", FULL, RATIO, INTERNAL),
}


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_shipped_grids_have_the_ranges_of_the_paper(path):
    grid = read_grid(path)
    assert grid.size == grid.rows * grid.dR.size * grid.load.size
    if path.stem in RANGES:
        contact, *ranges = RANGES[path.stem]
        assert (grid.contact, grid.reference) == (contact, "johnson")
        axes = (grid.E, grid.nu, grid.dR, grid.load)
        assert [(axis[0], axis[-1]) for axis in axes] == [*ranges, (10.0, 1000.0)]


@pytest.mark.parametrize("name", REFERENCES)
def test_every_reference_can_be_sampled(tmp_path, name):
    grid = read_grid(write_toml(tmp_path / "g.toml", changed(GRID, {"reference": name})))
    assert np.diff(np.log(grid.E)) == pytest.approx(np.log(600 / 69) / 2)
    assert np.diff(grid.load) == pytest.approx(330.0)


LIST = "a list of increasing numbers"
EITHER = "an axis takes min, max, points and spacing, or values = [...]"
LIMITS = "must lie between 1e-12 and 1e+12"

# What no schema says; tests/cli/test_malformed.py has the rest.
# Changes to a good grid; the key, value, rule and remedy of the error.
BAD_INPUT = [
    *(
        ({f"axes.E.{key}": DROP}, f"axes.E.{key}", None, "is required", EITHER)
        for key in ("min", "points")
    ),
    ({"axes.nu": {}}, "axes.nu.min", None, "is required", EITHER),
    # unknown keys, told before what is missing because of them
    (
        {"axes.E.points": DROP, "axes.E.point": 3, "contact": DROP, "reference": DROP},
        *("axes.E.point", 3, "is not a known key", "values (2 more mistakes)"),
    ),
    ({"axes.nu.values": [0.1, "0.3"]}, "axes.nu.values.1", "0.3", "must be a number", LIST),
    ({"axes.E.max": 69}, "axes.E.min", 69.0, "must be below max = 69.0", "correct them"),
    ({"axes.E.points": 1}, "axes.E.points", 1, "must be at least 2", "use values = [...]"),
    ({"axes.E.points": 10**12}, "axes.E.points", 10**12, "must be at most 10000000", "thin"),
    ({"axes.E.min": 0.0}, "axes.E.min", 0.0, "log spacing needs a positive min", '"linear"'),
    *(
        ({"axes.nu.values": values}, "axes.nu.values", values, "increasing", "drop repeats")
        for values in ([], [0.3, 0.2], [0.3, 0.3])
    ),
    ({"axes.nu.min": 0.1}, "axes.nu.min", None, "cannot be combined with values", "keep either"),
    *(
        ({f"axes.{axis}": {"values": [value, 9.0]}}, f"axes.{axis}", value, rule, f"in {unit}")
        for axis, unit in (("E", "GPa"), ("dR", "mm"), ("load", "N/mm"))
        for value, rule in ((0.0, "every value must be positive"), (1e-13, LIMITS))
    ),
    ({"axes.E": {"values": [1.0, 1e308]}}, "axes.E", 1e308, LIMITS, "give it in GPa"),
    (
        {"axes.E.max": 207e3},
        *("axes.E", 207e3, "must be at most 10000 GPa, and diamond has 1200", "give it in GPa"),
    ),
    *(
        ({"axes.nu.values": values}, "axes.nu", values, "must lie in [0, 0.5]", "narrow the axis")
        for values in ([-0.1, 0.3], [0.3, 0.51])
    ),
    ({"reference": "hertz"}, "reference", "hertz", "is not a", "johnson"),
]


@pytest.mark.parametrize(
    ("changes", "key", "value", "rule", "remedy"), BAD_INPUT, ids=labels(BAD_INPUT)
)
def test_bad_input_is_told_by_file_key_value_rule_and_remedy(
    tmp_path, changes, key, value, rule, remedy
):
    path = write_toml(tmp_path / "g.toml", changed(GRID, changes))
    with pytest.raises(InputError) as caught:
        read_grid(path)
    assert_told(caught, path, key, value, rule, remedy)
