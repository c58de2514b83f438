"""The report: one page with what is there, readable on a desk and on a phone."""

import re
from pathlib import Path

import pytest

from cylcontact.reports.figures import write_figures
from cylcontact.reports.page import write_page
from tests.support.browser import chromium
from tests.support.report_files import CLAIMS, FIGURE

ROOT = Path(__file__).resolve().parents[2]


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
    assert "<td>0.965</td><td>0.96609</td>" in text
    assert "A load of 10 N/mm." in text
    assert "does not hold:" in text
    assert not re.search(r'(src|href)="(?!data:)', text)


def test_what_is_missing_names_the_command(tmp_path):
    missing = write_page(tmp_path / "report.html", tmp_path, tmp_path)
    assert any("cylcontact fit fitting/internal.toml" in line for line in missing)
    assert any("cylcontact figure" in line for line in missing)


@pytest.mark.parametrize("width", [1280, 390])
def test_the_page_fits_the_window(page, width):
    with chromium() as browser:
        view = browser.new_page(viewport={"width": width, "height": 800})
        view.goto(page.as_uri())
        assert view.evaluate("document.documentElement.scrollWidth") <= width
        assert view.locator("img").first.bounding_box()["width"] > 200
        view.locator("summary").first.click()
        assert view.locator("li").first.is_visible()
