"""Published benchmarks beside ours, and their numbers by hand."""

import math

import numpy as np
import pytest
from scipy.special import j1

from benchmarks.references import FOLDER, compared, main, pair_of
from tests.support.sheet_elements import SheetOfElements, compliances

REFERENCES = {path.stem: compared(path) for path in sorted(FOLDER.glob("*.toml"))}
CASES = [(name, *row) for name, (_, rows) in REFERENCES.items() for row in rows]


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case[0]} {case[1]['quantity']}")
def test_we_are_as_close_to_others_as_the_file_says(case):
    _, value, mine, off = case
    assert abs(off) < value["within"] if "theirs" in value else mine > 0


def test_the_cylinder_on_a_block_by_hand():
    E_star = 1 / ((1 - 0.09) / 210e3 + (1 - 0.09) / 70e3)
    peak = math.sqrt(35000 * E_star / (math.pi * 50))
    ours = [mine for _, mine, _ in REFERENCES["nafems-cylinder-on-block"][1]]
    assert ours == pytest.approx([peak, 2 * 35000 / (math.pi * peak), peak, peak], rel=1e-12)


def test_the_loads_of_half_planes_are_the_sum_of_their_series():
    about, rows = REFERENCES["steuermann"]
    pair = pair_of(about["pair"])
    for value, _, _ in rows:
        angle, unit = math.radians(value["theirs"]), float(pair.E_star) * float(pair.dR)
        assert value["load"] == pytest.approx(math.pi / 2 * unit * angle * j1(angle), rel=1e-12)


def test_the_sheet_of_the_loaded_pin_is_that_of_finite_elements():
    given = REFERENCES["nafems-loaded-pin"][0]["pair"]
    g = np.loadtxt(FOLDER / given["compliances"], delimiter=",")
    elements = compliances(SheetOfElements(given["E_i"], given["nu"]), pair_of(given), 8)
    np.testing.assert_allclose(elements, g[:8, :8], rtol=0, atol=1e-3)


def test_an_empty_template_is_refused_in_one_line(tmp_path, capsys):
    words = (FOLDER / "template" / "rig.toml").read_text(encoding="utf-8")
    path = tmp_path / "rig.toml"
    path.write_text(words, encoding="utf-8")
    assert main([str(path)]) == 2
    assert capsys.readouterr().err.endswith("title: is empty; fill it in from the source\n")
    path.write_text(words.replace('= ""', '= "a"').replace("  # {", "  {"), encoding="utf-8")
    assert main([str(path)]) == 2
    assert "R_i = 0.0: is empty" in capsys.readouterr().err
    words = path.read_text("utf-8").replace("dR = 0.0", "dR = 0.1").replace("_i = 0.0", "_i = 2e5")
    words = words.replace("E_j = 0.0", "E_j = 2e5").replace(" 0.0", " 2.0")
    path.write_text(words, encoding="utf-8")
    assert main([str(path)]) == 0
    assert "| penetration at 2 N/mm, µm | 2 |" in capsys.readouterr().out
