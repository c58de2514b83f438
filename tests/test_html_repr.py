"""What notebooks show of materials, pairs and laws: every value, and no text taken for markup."""

from html.parser import HTMLParser

import numpy as np
import pytest

from cylcontact import CylinderPair, Material, laws
from cylcontact.html_repr import law_html, table_html

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
    assert cells.tags <= {"table", "caption", "b", "tbody", "tr", "th", "td"}
    return cells.texts


def test_texts_stay_texts():
    assert visible(table_html(HOSTILE, {HOSTILE: HOSTILE})) == [HOSTILE] * 3


def test_material():
    steel = Material(HOSTILE, E=207e3, nu=0.3)
    expected = [f"Material {HOSTILE}", "E (MPa)", "207000", "ν (-)", "0.3", "yield stress (MPa)"]
    assert visible(steel._repr_html_()) == [*expected, "–"]


def test_pair(pair):
    texts = visible(pair._repr_html_())
    rows = dict(zip(texts[1::2], texts[2::2], strict=True))
    assert texts[0] == "CylinderPair, internal contact"
    assert rows["ΔR (mm)"] == "0.5"
    assert rows["length (mm)"] == "12"
    assert float(rows["E* (MPa)"]) == pytest.approx(float(pair.E_star), rel=1e-5)
    assert rows["material i"] == rows["material j"] == "steel"


def test_arrays_are_shown_in_a_line(steel):
    few = CylinderPair.from_dR("external", np.array([1.0, 2.0]), steel)
    many = CylinderPair.from_dR("external", np.arange(1.0, 10.0), steel)
    assert "1, 2" in visible(few._repr_html_())
    assert "1 to 9 (9 values)" in visible(many._repr_html_())


@pytest.mark.parametrize("name", laws.LAWS)
def test_every_law_shows_its_formula_or_source(name):
    law = laws.LAWS[name]()
    title = visible(law._repr_html_())[0]
    assert title == f"{type(law).__name__}: {type(law).__doc__.splitlines()[0]}"


def test_coefficients_of_the_published_law_and_of_a_fit():
    published = visible(laws.Enhanced()._repr_html_())
    assert "ExternalCoefficients(a=0.39, b=0.85, n=1.094)" in published
    fitted = visible(laws.Enhanced({"a": 0.1, "b": 0.2, "n": 1.1})._repr_html_())
    assert fitted[1:] == ["a", "0.1", "b", "0.2", "n", "1.1"]
    assert visible(laws.PowerLaw(n=1.25, K=3e5)._repr_html_())[1:] == ["n", "1.25", "K", "300000"]
    assert "depth" in law_html(laws.Winkler(depth=0.8))
