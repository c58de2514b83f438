"""A material, and tables of them: values, provenance, and every way to go wrong."""

import numpy as np
import pytest

from cylcontact import CylinderPair, InputError, Material, laws
from cylcontact.bodies.material import (
    COLUMNS,
    SHIPPED,
    known_materials,
    material_in_MPa,
    read_materials,
)
from tests.support.spec_files import assert_told
from tests.support.strategies import ROUNDING


@pytest.mark.parametrize(
    ("text", "E"),
    [("200 MPa", 200.0), (" 0.2GPa ", 200.0), ("207 GPa", 207e3), ("2e8 Pa", 200.0), ("2e5", 2e5)],
)
def test_a_modulus_may_come_with_its_unit(text, E):
    material = Material("any", text, 0.3)
    assert material.E == pytest.approx(E, rel=4 * ROUNDING)
    assert material == material_in_MPa("any", material.E, 0.3)


# --- the shipped table ------------------------------------------------------------------------

# E in GPa and ν with their provenance, yield stress in MPa; all yield stresses are assumed. The
# paper's five, and three that it does not have.
VALUES = {
    "ceramics": (600, "derived", 0.24, "derived", 350),
    "high-strength steel": (207, "assumed", 0.30, "assumed", 1000),
    "low-carbon steel": (200, "paper", 0.30, "paper", 250),
    "titanium alloy": (120, "derived", 0.34, "derived", 830),
    "aluminium alloy": (69, "derived", 0.33, "derived", 276),
    "bronze": (110, "assumed", 0.34, "assumed", 220),
    "PEEK": (3.6, "assumed", 0.38, "assumed", 100),
    "PTFE": (0.5, "assumed", 0.46, "assumed", 10),
    "POM": (2.8, "assumed", 0.38, "assumed", 65),
    "PA 6": (2.9, "assumed", 0.39, "assumed", 75),
    "grey cast iron": (110, "assumed", 0.26, "assumed", 165),
    "brass": (97, "assumed", 0.34, "assumed", 250),
}

HEADER = ",".join(COLUMNS[:8])
STEEL = "steel,207,paper,0.3,derived,250,assumed,a note"


def write(tmp_path, *lines, header=HEADER):
    path = tmp_path / "materials.csv"
    path.write_text("\n".join([header, *lines]) + "\n", encoding="utf-8")
    return path


def test_materials_and_laws_with_them_are_keys():
    """Equal ones have one hash, whether their numbers came as a list or as an array."""
    one, other = Material("any", [7e4, 2e5], 0.3), Material("any", np.array([7e4, 2e5]), 0.3)
    assert len({one, other, Material("any", 7e4, 0.3)}) == 2
    layers = [(Material("steel", 207e3, 0.3), 12.0)]
    assert len({laws.Conformal(laws.Housing(20.0, layers=layers)) for _ in range(2)}) == 1
    pairs = {CylinderPair.internal(10.0, [9.5, 9.9], other) for _ in range(2)}
    assert len(pairs) == 1


def test_shipped_values_and_where_they_come_from():
    rows = read_materials(SHIPPED)
    assert list(rows) == list(VALUES)
    for name, (E, E_from, nu, nu_from, yield_stress) in VALUES.items():
        material = rows[name].material
        numbers = material.E, material.nu, material.yield_stress
        assert (material.name, *numbers) == (name, E * 1e3, nu, yield_stress)
        origins = {"E_GPa": E_from, "nu": nu_from, "yield_stress_MPa": "assumed"}
        assert rows[name].provenance == origins


def test_a_shipped_material_by_its_name():
    titanium = Material("titanium alloy", 120e3, 0.34, 830.0, 8.6e-6)
    assert Material.named(" Titanium  alloy") == titanium
    rule = "is not in the table that ships"
    with pytest.raises(InputError) as caught:
        Material.named("soap")
    assert_told(caught, "Material.named", "name", "soap", rule, "choose ceramics, high-strength")


def test_a_table_of_ones_own_only_adds(tmp_path):
    own = write(tmp_path, STEEL)
    assert list(known_materials()) == list(VALUES)
    assert list(known_materials(own)) == [*VALUES, "steel"]
    taken = write(tmp_path, STEEL.replace("steel", "Ceramics"))
    with pytest.raises(InputError) as caught:
        known_materials(taken)
    rule = "is the name of a material that ships with the package"
    assert_told(caught, taken, "name", "Ceramics", rule, "choose another name")


# --- what is read -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("own.csv", "name,E_GPa,nu\nbrass,102.5,0.34\nrubber,0.005,0.49\n"),
        ("own.CSV", "name;E_GPa;nu\nbrass;102,5;0,34\nrubber;0,005;0,49\n"),
        ("own.txt", "# mine\nname\tnu\tE_GPa\nbrass\t0.34\t102.5\nrubber\t.49\t5e-3\n"),
    ],
)
def test_three_columns_do_written_as_a_table_of_data(tmp_path, name, text):
    (tmp_path / name).write_text(text, encoding="utf-8")
    brass, rubber = read_materials(tmp_path / name).values()
    assert brass.material == Material("brass", 102.5e3, 0.34)
    assert brass.provenance == {"E_GPa": "assumed", "nu": "assumed"}
    assert rubber.material == Material("rubber", "5 MPa", 0.49)


# --- bad input --------------------------------------------------------------------------------

NUMBER, EMPTY = "must be a finite number", "is empty"
POSITIVE, RATIO, ORIGIN = "must be positive", "must lie in [0, 0.5]", "must be one of paper"
# Bad cells of the second row of a table whose first is good, and the rule of the error.
BAD_CELLS = [
    *(("E_GPa", cell, NUMBER) for cell in ("steel", "nan", "2_07")),
    *((column, "", EMPTY) for column in ("E_GPa", "nu")),
    ("nu", "x", NUMBER),
    ("E_GPa", "207000", "is beyond any material"),
    ("yield_stress_MPa", "high", NUMBER),
    *(("E_GPa", cell, POSITIVE) for cell in ("0", "-207")),
    *(("nu", cell, RATIO) for cell in ("-0.1", "0.6", "30")),
    *(("yield_stress_MPa", cell, POSITIVE) for cell in ("0", "-250")),
    *(("E_provenance", cell, ORIGIN) for cell in ("guess", "Paper")),
    *((column, "guess", ORIGIN) for column in ("nu_provenance", "yield_provenance")),
    ("name", " ", "is required"),
    ("name", "steel", "is used twice"),
    ("name", "Steel", "is used twice"),
]


@pytest.mark.parametrize(("column", "cell", "rule"), BAD_CELLS)
def test_a_bad_cell_is_told_by_its_line(tmp_path, column, cell, rule):
    cells = dict(zip(COLUMNS[:8], STEEL.split(","), strict=True)) | {column: cell}
    path = write(tmp_path, STEEL, "", ",".join(cells.values()))
    with pytest.raises(InputError) as caught:
        read_materials(path)
    assert_told(caught, f"{path}, line 4", column, cell.strip() or None, rule, "")


@pytest.mark.parametrize(
    ("header", "rule"),
    [
        (HEADER.replace("E_GPa", "E_MPa"), "lacks E_GPa"),
        ("steel,207,paper,0.3,derived,250,assumed,a note", "lacks name, E_GPa, nu"),
        (HEADER.replace("note", "colour"), "'colour' is not known, or there twice"),
        (HEADER.replace("note", "name"), "'name' is not known, or there twice"),
    ],
)
def test_missing_unknown_and_repeated_columns_are_refused(tmp_path, header, rule):
    path = write(tmp_path, STEEL, header=header)
    with pytest.raises(InputError) as caught:
        read_materials(path)
    names = [] if header.startswith("steel") else header.split(",")  # numbers are no names
    assert_told(caught, path, "columns", names, rule, "E_provenance, nu_provenance")
