"""The report: one page with what is there, readable on a desk and on a phone."""

import re
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest

from cylcontact.fitting.stored import read_result
from cylcontact.reports.figures import write_figures
from cylcontact.reports.page import FITS, _fits, write_page
from tests.support import paper_equations as paper
from tests.support.browser import chromium
from tests.support.report_files import CLAIMS, FIGURE

ROOT = Path(__file__).resolve().parents[2]
RESULTS = ROOT / "fitting/results"
SPACED = {"linear": np.linspace, "log": np.geomspace}


@pytest.fixture
def page(tmp_path):
    (tmp_path / "reports").mkdir()
    (tmp_path / "reports/mine.py").write_text(FIGURE)
    (tmp_path / "reports/claims.py").write_text(CLAIMS)
    write_figures(tmp_path)
    path = tmp_path / "report.html"
    assert write_page(path, tmp_path, ROOT / "fitting/results") == []
    return path


def test_the_page_has_coefficients_figures_and_claims_and_loads_nothing(page):
    text = page.read_text(encoding="utf-8")
    assert "<td>0.965</td><td>0.96711</td>" in text
    assert "A load of 10 N/mm." in text
    assert "does not hold:" in text
    assert not re.search(r'(src|href)="(?!data:)', text)
    foot = text[text.index("<footer>") :]
    assert f"cylcontact {version('cylcontact')}; inputs: " in foot
    assert "reports/claims.py" in foot
    assert "doi:10.1007/s11044-015-9463-x" in foot


def test_what_is_missing_names_the_command(tmp_path):
    missing = write_page(tmp_path / "report.html", tmp_path, tmp_path)
    assert any("cylcontact fit fitting/internal.toml" in line for line in missing)
    assert any("cylcontact figure" in line for line in missing)


def test_a_figure_without_a_png_is_shown_as_svg_or_missing(page, tmp_path):
    results = ROOT / "fitting/results"
    write_figures(tmp_path, formats=["svg"])
    for picture in (tmp_path / "build/figures").glob("*.png"):
        picture.unlink()
    assert write_page(page, tmp_path, results) == []
    assert "data:image/svg+xml" in page.read_text(encoding="utf-8")
    for picture in (tmp_path / "build/figures").glob("*.svg"):
        picture.unlink()
    assert [line.split(":")[0] for line in write_page(page, tmp_path, results)] == [
        f"the picture of {text.stem}" for text in (tmp_path / "build/figures").glob("*.txt")
    ]


@pytest.mark.slow
def test_the_page_fits_the_window(page):
    with chromium() as browser:
        for width in (1280, 390):
            view = browser.new_page(viewport={"width": width, "height": 800})
            view.goto(page.as_uri())
            assert view.evaluate("document.documentElement.scrollWidth") <= width
            assert view.locator("img").first.bounding_box()["width"] > 200
            view.locator("summary").first.click()
            assert view.locator("li").first.is_visible()


def test_errors_are_compared_on_the_same_samples():
    """Eqs 1, 5 and 6 written out once more, on the samples of the last column."""
    results = {name: read_result(RESULTS / f"{name}.json") for name in FITS["external"]}
    axes = {
        key: axis["values"]
        if "values" in axis
        else SPACED[axis["spacing"]](axis["min"], axis["max"], axis["points"])
        for key, axis in results["external"].settings["dataset"]["axes"].items()
    }
    E, nu, dR, load = np.meshgrid(*(axes[key] for key in ("E", "nu", "dR", "load")))
    E_star = paper.e_star(1e3 * E, nu)
    inside = load <= paper.johnson_end(E_star, dR)
    E_star, dR, load = E_star[inside], dR[inside], load[inside]
    exact = np.log(paper.johnson(load, E_star, dR))
    expected = []
    every = [results["external"].published, *results.values()]
    for values in (each.coefficients for each in every):
        K = (values["a"] * dR + values["b"]) * E_star / dR
        n = exponent(values, dR)
        expected.append(np.sqrt(np.mean((np.log(load / K) / n - exact) ** 2)))
    row = re.search(r"<td>error</td>(.*?)</tr>", _fits(RESULTS, FITS["external"], []))[1]
    shown = [float(cell) for cell in re.findall(r"<td>(.*?)</td>", row)]
    assert shown == pytest.approx(expected, abs=6e-5)


def exponent(values, dR):
    """n of Eq 6 with these coefficients."""
    if "n" in values:
        return values["n"]
    log = values["Y_log_scale"] * np.log(1000 * dR) ** values["Y_log_exponent"]
    Y = np.where(dR < paper.SWITCH, log, values["Y_slope"] * dR + values["Y_offset"])
    return Y * dR ** values["n_exponent"]
