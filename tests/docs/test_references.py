"""The page of outside references, and their numbers by hand."""

import math

import numpy as np
import pytest
from scipy.special import j1

from benchmarks.references import FOLDER, PAGE, compared, main, page, pair_of
from tests.support.sheet_elements import SheetOfElements, compliances

FILES = sorted(FOLDER.glob("*.toml"))
CASES = [
    (path.stem, about, *row) for path in FILES for about, rows in compared([path]) for row in rows
]


def of(name):
    return [(about, value, mine) for stem, about, value, mine, _ in CASES if stem == name]


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case[0]} {case[2]['quantity']}")
def test_we_are_as_close_to_others_as_the_file_says(case):
    _, _, value, mine, off = case
    assert abs(off) < value["within"] if "theirs" in value else mine > 0


def test_the_page_is_that_of_the_numbers():
    assert PAGE.read_text(encoding="utf-8") == page(FILES)


def test_the_cylinder_on_a_block_by_hand():
    E_star = 1 / ((1 - 0.09) / 210e3 + (1 - 0.09) / 70e3)
    peak = math.sqrt(35000 * E_star / (math.pi * 50))
    ours = [mine for _, _, mine in of("nafems-cylinder-on-block")]
    expected = [peak, 2 * 35000 / (math.pi * peak), peak, peak]
    assert ours == pytest.approx(expected, rel=1e-12)


def test_the_loads_of_half_planes_are_the_sum_of_their_series():
    for about, value, _ in of("steuermann"):
        pair = pair_of(about["pair"])
        angle, unit = math.radians(value["theirs"]), float(pair.E_star) * float(pair.dR)
        assert value["load"] == pytest.approx(math.pi / 2 * unit * angle * j1(angle), rel=1e-12)


def test_the_sheet_of_the_loaded_pin_is_that_of_finite_elements():
    given = of("nafems-loaded-pin")[0][0]["pair"]
    pair = pair_of(given)
    g = np.loadtxt(FOLDER / given["compliances"], delimiter=",")
    elements = compliances(SheetOfElements(given["E_i"], given["nu"]), pair, 8)
    np.testing.assert_allclose(elements, g[:8, :8], rtol=0, atol=1e-3)


def test_an_empty_template_is_refused_in_one_line(tmp_path, capsys):
    template = FOLDER / "template" / "rig.toml"
    assert main([str(template)]) == 2
    assert capsys.readouterr().err.endswith("title: is empty; fill it in from the source\n")
    words = template.read_text(encoding="utf-8").replace('= ""', '= "a"').replace("  # {", "  {")
    for key, number in {"R_i": "9.0", "dR": "0.1", "E_i": "2e5", "E_j": "2e5"}.items():
        (tmp_path / "rig.toml").write_text(words, encoding="utf-8")
        assert main([str(tmp_path / "rig.toml")]) == 2
        assert f"{key} = 0.0: is empty" in capsys.readouterr().err
        words = words.replace(f"{key} = 0.0", f"{key} = {number}")
    (tmp_path / "rig.toml").write_text(words.replace(" 0.0", " 2.0"), encoding="utf-8")
    assert main([str(tmp_path / "rig.toml")]) == 0
    assert "| penetration at 2 N/mm | 2 µm |" in capsys.readouterr().out
