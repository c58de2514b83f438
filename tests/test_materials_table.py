"""The table of materials: the shipped values with their provenance, and every way to go wrong."""

import pytest

from cylcontact import InputError, Material
from cylcontact.materials import (
    COLUMNS,
    SHIPPED,
    known_materials,
    material_in_MPa,
    read_materials,
)
from tests.spec_files import assert_told

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
}

HEADER = ",".join(COLUMNS)
STEEL = "steel,207,paper,0.3,derived,250,assumed,a note"


def write(tmp_path, *lines, header=HEADER):
    path = tmp_path / "materials.csv"
    path.write_text("\n".join([header, *lines]) + "\n", encoding="utf-8")
    return path


# --- the shipped table ------------------------------------------------------------------------


def test_the_shipped_table_holds_the_materials_in_order():
    assert list(read_materials(SHIPPED)) == list(VALUES)


@pytest.mark.parametrize("name", VALUES)
def test_shipped_values_and_where_they_come_from(name):
    E, E_from, nu, nu_from, yield_stress = VALUES[name]
    row = read_materials(SHIPPED)[name]
    assert row.material == material_in_MPa(name, E * 1e3, nu, yield_stress)
    assert row.provenance == {"E_GPa": E_from, "nu": nu_from, "yield_stress_MPa": "assumed"}


def test_a_shipped_material_by_its_name():
    assert Material.named("titanium alloy") == Material("titanium alloy", 120e3, 0.34, 830.0)
    with pytest.raises(InputError) as caught:
        Material.named("brass")
    rule = "is not in the table that ships"
    assert_told(caught, "Material.named", "name", "brass", rule, "choose ceramics, high-strength")
    assert Material.named("Low-Carbon  steel") == Material.named("low-carbon steel")


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


def test_a_row_comes_out_as_written(tmp_path):
    (row,) = read_materials(write(tmp_path, STEEL)).values()
    assert row.material == Material("steel", 207e3, 0.3, 250.0)
    assert row.provenance == {"E_GPa": "paper", "nu": "derived", "yield_stress_MPa": "assumed"}
    assert row.note == "a note"


@pytest.mark.parametrize("cells", [",", ",assumed", "  ,"])
def test_the_yield_stress_may_be_left_out(tmp_path, cells):
    (row,) = read_materials(write(tmp_path, f"steel,207,paper,0.3,paper,{cells},")).values()
    assert row.material.yield_stress is None
    assert row.provenance == {"E_GPa": "paper", "nu": "paper"}


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


def test_columns_may_stand_in_any_order(tmp_path):
    header, line = (",".join(reversed(text.split(","))) for text in (HEADER, STEEL))
    assert read_materials(write(tmp_path, line, header=header)) == read_materials(
        write(tmp_path, STEEL)
    )


# --- bad input --------------------------------------------------------------------------------


def replaced(column, cell):
    cells = dict(zip(COLUMNS, STEEL.split(","), strict=True)) | {column: cell}
    return ",".join(cells.values())


NUMBER = ("must be a finite number", "write it with a decimal point, without its unit")
EMPTY = ("is empty", "fill it in, or remove the row")
ORIGIN = ("must be one of paper, derived, assumed", "say which")
UNIT = "mind the unit in the column's name"
CELLS = "give every row a cell for each column, separated by commas"

NO_NUMBERS = ("steel", "nan", "2_07")
# The second row of a table whose first is good; the key, value, rule and remedy of the error.
BAD_ROWS = [
    *((replaced("E_GPa", cell), "E_GPa", cell, *NUMBER) for cell in NO_NUMBERS),
    *((replaced(column, ""), column, None, *EMPTY) for column in ("E_GPa", "nu")),
    (replaced("nu", "x"), "nu", "x", *NUMBER),
    (replaced("E_GPa", "207000"), "E_GPa", "207000", "is beyond any material", UNIT),
    (replaced("yield_stress_MPa", "high"), "yield_stress_MPa", "high", *NUMBER),
    *(
        (replaced("E_GPa", cell), "E_GPa", cell, "must be positive and finite", UNIT)
        for cell in ("0", "-207")
    ),
    *(
        (replaced("nu", cell), "nu", cell, "must lie in [0, 0.5]", UNIT)
        for cell in ("-0.1", "0.6", "30")
    ),
    *(
        (replaced("yield_stress_MPa", cell), "yield_stress_MPa", cell, "must be positive", UNIT)
        for cell in ("0", "-250")
    ),
    *(
        (replaced(column, cell), column, cell, *ORIGIN)
        for column in ("E_provenance", "nu_provenance", "yield_provenance")
        for cell in ("", "guess", "Paper")
    ),
    *((replaced("name", cell), "name", None, "is required", "name the") for cell in ("", " ")),
    (replaced("note", "a, b"), "", None, "has 9 cells for 8 columns", CELLS),
    (STEEL.removesuffix(",a note"), "", None, "has 7 cells for 8 columns", CELLS),
    (STEEL, "name", "steel", "is used twice", "a name of its own"),
    (STEEL.replace("steel", "Steel"), "name", "Steel", "is used twice", "a name of its own"),
]


@pytest.mark.parametrize(
    ("line", "key", "value", "rule", "remedy"), BAD_ROWS, ids=[row[0] for row in BAD_ROWS]
)
def test_a_bad_row_is_told_by_its_line(tmp_path, line, key, value, rule, remedy):
    path = write(tmp_path, STEEL, "", line)
    with pytest.raises(InputError) as caught:
        read_materials(path)
    assert_told(caught, f"{path}, line 4", key, value, rule, remedy)


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
    assert_told(caught, path, "columns", header.split(","), rule, "E_provenance, nu_provenance")


def test_a_table_without_materials_is_refused(tmp_path):
    path = write(tmp_path)
    with pytest.raises(InputError) as caught:
        read_materials(path)
    assert_told(caught, path, "", None, "holds no rows", "at least one")
