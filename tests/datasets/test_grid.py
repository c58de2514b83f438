"""Grid specs: what the shipped ones cover, and every way to get one wrong."""

import tomllib
from pathlib import Path

import pytest

from cylcontact import InputError
from cylcontact.datasets import read_grid
from cylcontact.laws import REFERENCES
from cylcontact.provenance import spec_hash
from tests.support.spec_files import DROP, GRID, assert_told, changed, labels, write_toml

ROOT = Path(__file__).resolve().parents[2]
# The mechanisms in the same folder are no grids.
SHIPPED = sorted(
    path for path in (ROOT / "datasets").glob("*.toml") if "[axes" in path.read_text("utf-8")
)

FULL, REAL = (20.7, 10000.0), (20.7, 1000.0)
INTERNAL, EXTERNAL = (0.05, 10.0), (5.0, 500.0)
# Contact, E in GPa, ν and ΔR in mm; loads from 10 to 1000 N/mm throughout (Sects. 3.1 and 3.4).
RANGES = {
    "internal": ("internal", FULL, (0.1, 0.5), INTERNAL),
    "external": ("external", FULL, (0.1, 0.5), EXTERNAL),
    "internal-linear": ("internal", FULL, (0.1, 0.5), INTERNAL),
    "external-linear": ("external", FULL, (0.1, 0.5), EXTERNAL),
    "internal-E1000": ("internal", REAL, (0.1, 0.5), INTERNAL),
    "internal-E1000-thin": ("internal", REAL, (0.1, 0.5), INTERNAL),
    "external-E1000": ("external", REAL, (0.1, 0.5), EXTERNAL),
    "practical": ("internal", (69.0, 600.0), (0.24, 0.34), (0.0075, 2.0)),
    "large": ("internal", FULL, (0.1, 0.5), INTERNAL),
}


# --- the shipped grids ------------------------------------------------------------------------


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_every_shipped_grid_parses(path):
    grid = read_grid(path)
    assert grid.size == grid.rows * grid.dR.size * grid.load.size
    assert grid.source == str(path)


@pytest.mark.parametrize("name", RANGES)
def test_shipped_grids_have_the_ranges_of_the_paper(name):
    contact, *ranges = RANGES[name]
    grid = read_grid(ROOT / f"datasets/{name}.toml")
    assert (grid.contact, grid.reference) == (contact, "johnson")
    axes = (grid.E, grid.nu, grid.dR, grid.load)
    assert [(axis[0], axis[-1]) for axis in axes] == [*ranges, (10.0, 1000.0)]


# --- what is read -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "changes",
    [
        {"axes.nu": {"values": [0]}},
        {"axes.nu": {"values": [0.5]}},
        {"axes.nu": {"min": 0, "max": 0.5, "points": 2, "spacing": "linear"}},
        {"axes.load": {"values": [1, 2.5, 1000]}},
        {"contact": "external"},
        *({"reference": name} for name in REFERENCES),
    ],
)
def test_good_variants_are_accepted(tmp_path, changes):
    assert read_grid(write_toml(tmp_path / "g.toml", changed(GRID, changes))).size > 0


def test_hash_depends_on_contents_not_on_layout(tmp_path):
    one = write_toml(tmp_path / "one.toml", GRID)
    two = tmp_path / "two.toml"
    two.write_text(f"# The same.\n\n{one.read_text()}".replace(" = ", "   =  "))
    first, second = (tomllib.loads(path.read_text()) for path in (one, two))
    assert spec_hash(first) == spec_hash(second)
    assert spec_hash(first) != spec_hash(changed(first, {"axes.E.points": 4}))


# --- bad input --------------------------------------------------------------------------------

RANGED = {"min": 1.0, "max": 2.0, "points": 3, "spacing": "linear"}
LIST = "a list of increasing numbers"
EITHER = "an axis takes min, max, points and spacing, or values = [...]"
NUMBER = "must be a number"

# What no schema says; tests/cli/test_malformed.py has the rest.
# Changes to a good grid; the key, value, rule and remedy of the error.
BAD_INPUT = [
    # missing keys
    *(
        ({f"axes.E.{key}": DROP}, f"axes.E.{key}", None, "is required", EITHER)
        for key in ("min", "max", "points", "spacing")
    ),
    ({"axes.nu": {}}, "axes.nu.min", None, "is required", EITHER),
    ({"axes.nu": {"min": 0.1}}, "axes.nu.max", None, "is required", EITHER),
    # unknown keys, told before what is missing because of them
    (
        {"contact": DROP, "contct": "internal"},
        *("contct", "internal", "is not a known key", "penetrations (1 more mistake)"),
    ),
    (
        {"axes.E.points": DROP, "axes.E.point": 3, "contact": DROP, "reference": DROP},
        *("axes.E.point", 3, "is not a known key", "values (2 more mistakes)"),
    ),
    # wrong types
    ({"axes.nu.values": [0.1, "0.3"]}, "axes.nu.values.1", "0.3", NUMBER, LIST),
    # ranges and lists
    ({"axes.E.max": 69}, "axes.E.min", 69.0, "must be below max = 69.0", "correct them"),
    ({"axes.E.max": 1}, "axes.E.min", 69.0, "must be below max = 1.0", "exchange"),
    *(
        ({"axes.E.points": n}, "axes.E.points", n, "must be at least 2", "use values = [...]")
        for n in (1, 0, -3)
    ),
    *(
        ({"axes.E.points": n}, "axes.E.points", n, "must be at most 10000000", "thin the axis")
        for n in (10_000_001, 10**12, 10**30)
    ),
    *(
        ({"axes.E.min": low}, "axes.E.min", low, "log spacing needs a positive min", '"linear"')
        for low in (0.0, -1.0)
    ),
    *(
        ({"axes.nu.values": values}, "axes.nu.values", values, "increasing", "drop repeats")
        for values in ([], [0.3, 0.2], [0.3, 0.3])
    ),
    ({"axes.nu.min": 0.1}, "axes.nu.min", None, "cannot be combined with values", "keep either"),
    (
        {"axes.nu.spacing": "log"},
        "axes.nu.spacing",
        None,
        "cannot be combined with values",
        "keep either",
    ),
    # physics
    *(
        ({f"axes.{axis}": {"values": [value, 9.0]}}, f"axes.{axis}", value, rule, f"in {unit}")
        for axis, unit in (("E", "GPa"), ("dR", "mm"), ("load", "N/mm"))
        for value, rule in (
            (-1.0, "every value must be positive"),
            (0.0, "every value must be positive"),
            (1e-13, "must lie between 1e-12 and 1e+12"),
        )
    ),
    (
        {"axes.E": {"values": [1.0, 1e308]}},
        *("axes.E", 1e308, "must lie between 1e-12 and 1e+12", "give it in GPa"),
    ),
    (
        {"axes.E.max": 207e3},
        *("axes.E", 207e3, "must be at most 10000 GPa, and diamond has 1200", "give it in GPa"),
    ),
    (
        {"axes.dR": {**RANGED, "min": -1.0}},
        *("axes.dR", -1.0, "every value must be positive", "give it in mm"),
    ),
    *(
        (
            {"axes.nu.values": values},
            *("axes.nu", [values[0], values[-1]], "must lie in [0, 0.5]", "narrow the axis"),
        )
        for values in ([-0.1, 0.3], [0.3, 0.51], [0.6])
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
