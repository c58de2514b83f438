"""What notebooks and consoles show of objects: every value with its unit, and no text as markup."""

from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pandas as pd

from cylcontact import CylinderPair, Material, choose, fit, laws
from cylcontact.support.html_repr import table_html

ROOT = Path(__file__).resolve().parents[2]

HOSTILE = "<script>alert('x')</script> & \"co\""


class Cells(HTMLParser):
    """The tags, and the texts that a reader sees."""

    def __init__(self, fragment):
        super().__init__()
        self.tags, self.texts = set(), []
        self.feed(fragment)

    def handle_starttag(self, tag, _attrs):
        self.tags.add(tag)

    def handle_data(self, data):
        if data.strip():
            self.texts.append(data)


def visible(fragment):
    cells = Cells(fragment)
    assert cells.tags <= {"table", "caption", "b", "thead", "tbody", "tr", "th", "td"}
    return cells.texts


def test_texts_stay_texts():
    assert visible(table_html(HOSTILE, {HOSTILE: HOSTILE})) == [HOSTILE] * 3


def test_constants_of_a_law_have_their_units():
    texts = visible(laws.Enhanced()._repr_html_())
    assert {"internal: a (mm^(1-n))", "external: n", "internal: Y_slope (1/mm)"} <= {*texts}
    assert "K_star (mm^(2-n))" in visible(laws.PowerLaw(n=1.1, K_star=0.3)._repr_html_())


# --- campaigns, results, choices and trajectories ---


def test_no_text_of_a_result_or_a_choice_is_markup():
    steel = Material(HOSTILE, E=207e3, nu=0.3)
    pair = CylinderPair.internal(R_i=10.0, R_j=9.97, material=steel, length=20.0)
    load, noise = np.geomspace(10.0, 3000.0, 30), 1 + 0.01 * np.cos(np.arange(30))
    depth = laws.Explicit().penetration(load, pair) * noise
    data = pd.DataFrame({"load_N": load * 20.0, "penetration_um": 1e3 * depth})
    result = fit(data, "johnson", pair, name=HOSTILE, starts=1)
    choice = choose(data, pair, laws=["johnson"], name=HOSTILE)
    (law,) = choice.laws
    named = replace(choice, laws=(replace(law, law=HOSTILE),))
    for shown in (result._repr_html_(), named._repr_html_()):
        assert "<script" not in shown
        assert "&lt;script&gt;" in shown
