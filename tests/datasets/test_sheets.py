"""The cells of a file: columns by their names as numbers in the wanted unit."""

import numpy as np
import pandas as pd
import pytest

from cylcontact import InputError
from cylcontact.files.numbers import quantity
from cylcontact.files.sheet import read_sheet
from cylcontact.files.units import FORCES, LENGTHS, meaning_of, read_unit


def sheet_of(tmp_path, text):
    path = tmp_path / "t.csv"
    path.write_text(text, encoding="utf-8")
    return read_sheet(path)


# --- a column by its name -----------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "pin,pin_diameter_um,load_N\na,20000,5\nb,,6\n",
        "pin,Pin diameter [mm],load_N\na,20,5\nb,,6\n",
        "pin;pin-diameter (cm);load_N\na;2,0;5\nb;;6\n",
        "pin;Pin Diameter;load\n;mm;N\na;20,0;5\nb;;6\n",
        "pin;pin_diameter [10^-3 m];load\n;mm;N\na;20,0;5\nb;;6\n".replace("mm;N", ";N"),
    ],
)
def test_a_column_is_found_by_its_words_and_read_in_the_wanted_unit(tmp_path, text):
    sheet = sheet_of(tmp_path, text)
    assert quantity(sheet, "pin_diameter", LENGTHS) == pytest.approx([20.0, np.nan], nan_ok=True)
    assert quantity(sheet, "load", FORCES).tolist() == [5.0, 6.0]
    assert quantity(sheet, "hole_diameter", LENGTHS) is None


@pytest.mark.parametrize(
    ("names", "said"),
    [
        (("pin_diameter",), "'pin_diameter': has no unit; name it e.g. pin_diameter_um"),
        (("pin_diameter_furlong", "pin_diameter_N"), None),
        (("pin_diameter [psi]",), "has a unit that is not known, 'psi'"),
        (("pin_diameter_mm", "Pin diameter (cm)"), "same quantity as pin_diameter_mm"),
        (("pin_diameter (x10) [mm]",), "does not say clearly what a cell of 1 is"),
    ],
)
def test_a_column_in_doubt_is_refused_by_its_name(names, said):
    sheet = read_sheet(pd.DataFrame({name: [1.0, 2.0] for name in names}))
    if said is None:  # names of something else
        assert quantity(sheet, "pin_diameter", LENGTHS) is None
        return
    with pytest.raises(InputError) as caught:
        quantity(sheet, "pin_diameter", LENGTHS)
    assert said in str(caught.value)


def test_wrong_cells_are_collected_by_row(tmp_path):
    sheet = sheet_of(tmp_path, "name,load_N\na,1\nb,x\nc,\nd,4\n")
    wrong = {}
    values = quantity(sheet, "load", FORCES, wrong=wrong)
    assert values == pytest.approx([1, np.nan, np.nan, 4], nan_ok=True)
    assert list(wrong) == [1]
    assert "line 3: load_N = 'x': must be a finite number" in str(wrong[1])
    with pytest.raises(InputError, match="line 3: load_N = 'x'"):
        quantity(sheet, "load", FORCES)


# --- units with factors -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "unit", "factors"),
    [
        ("Force 10^3 N", "N", (1e3,)),
        ("Force / 10^3 N", "N", (1e3,)),
        ("Force [10³ N]", "N", (1e3,)),
        ("Force (1e3 N)", "N", (1e3,)),
        ("Force [10^3·N]", "N", (1e3,)),
        ("load_10^-3_kN", "kN", (1e-3,)),
        ("Force_x10_N", "N", (10.0, 0.1)),
        ("Force (x10) [N]", "N", (10.0, 0.1)),
        ("Force [x10 N]", "N", (10.0, 0.1)),
        ("Force (N) x10", "N", (10.0, 0.1)),
        ("x10 Force [N]", "N", (10.0, 0.1)),
        ("Force ·10³ / N", "N", (1e3, 1e-3)),
        ("Force 10^3 [N]", "N", (1e3, 1e-3)),
        ("Force (N/10)", "N", (0.1, 10.0)),
        ("Force 1000 N", "N", (1e3, 1.0)),
        ("Force 25 kN", "kN", (25.0, 1.0)),
        ("Force (1/100 N)", "N", (0.01, 1.0)),
        ("Force (1) [N]", "N", (1.0,)),
        ("Force (filtered) [N]", "N", (1.0,)),
        ("Load(8800 (0,1):Load) (kN)", "kN", (1.0,)),
    ],
)
def test_a_factor_beside_a_unit_is_kept(name, unit, factors):
    meaning = meaning_of(name)
    assert meaning.quantity == "load"
    assert meaning.unit.name == unit
    assert meaning.unit.factors == pytest.approx(factors)


def test_what_is_commanded_is_no_reading():
    for word in ("target", "Set point", "command", "Soll"):
        assert meaning_of(f"Force ({word}) [N]") is None


def test_a_power_beyond_all_units_is_in_doubt():
    assert not read_unit("10^400 N").is_clear
