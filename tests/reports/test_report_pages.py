"""The pages of results: the answer first, what is missing with its reason, no text as markup."""

import re
import subprocess
import sys
import zipfile
from html import unescape
from html.parser import HTMLParser

import pytest

from cylcontact import InputError
from cylcontact.reports.bench import Bench
from cylcontact.reports.laws_to_use import laws_to_use
from cylcontact.reports.pages import build_site
from cylcontact.reports.pages.content import FORMULAS, answer
from tests.support.browser import opened
from tests.support.programs import require_package
from tests.support.small_bench import EVIL, ROOT, build_small_site

pytestmark = pytest.mark.slow

PAGES = ("index", "figures", "fits", "statements")


class Read(HTMLParser):
    """The texts of a page outside its scripts, and the names of its elements."""

    def __init__(self, text):
        super().__init__()
        self.texts, self.tags = [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))

    def handle_data(self, data):
        self.texts.append(data)


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    return build_small_site(tmp_path_factory.mktemp("bench"))


@pytest.fixture(scope="module")
def texts(site):
    return {name: (site.index.parent / f"{name}.html").read_text("utf-8") for name in PAGES}


def test_what_is_missing_is_told_and_is_on_its_page_with_the_reason(site, texts):
    assert [line.split(":", 1)[0] for line in site.missing] == ["fig03", "broken"]
    assert "failed with ZeroDivisionError (division by zero)" in texts["figures"]
    assert "there is no recipe reports/fig15.py" in texts["figures"]
    assert "broken.json: name: is required" in texts["fits"]


def test_the_site_opens_with_the_law_of_least_error(texts):
    index = texts["index"]
    for contact, reference, best in (
        ("internal", "conformal", "explicit"),
        ("external", "johnson", "johnson"),
    ):
        laws = laws_to_use(contact, Bench(ROOT)).set_index("law")[f"rms_{reference}"]
        assert laws.idxmin() == best
        assert re.search(rf"<h2[^>]*>{answer(contact, Bench(ROOT))['bodies']}: {best}<", index)
        for law, rms in laws.items():
            shown = f"{rms:.4f}" if rms > 1e-9 else "0"
            assert f'<th scope="row">{law}</th><td>{shown}</td>' in index
    order = ("<h2", "<dt>Datum", "<dt>Range", "searched again", "statements of the paper hold")
    article = index.split("<article", 1)[1]
    places = [article.index(words) for words in order]
    assert places == sorted(places)


@pytest.mark.parametrize(("contact", "law"), [("internal", "explicit"), ("external", "johnson")])
def test_formulas_are_those_of_the_laws(contact, law):
    convert = require_package("latex2mathml.converter").convert
    text = laws_to_use(contact, Bench(ROOT)).set_index("law").loc[law, "formula"]
    shown = unescape(re.sub(r"<[^>]+>", "", convert(FORMULAS[law])))
    symbols = re.sub(r"[(){}·/ \u2003\s\u2061]", "", shown).replace("−", "-")
    assert symbols == re.sub(r"[()·/ ]", "", text).replace("₋₁", "-1").replace("−", "-")


def test_the_published_law_stands_in_its_own_column(texts):
    result = Bench(ROOT).result("recovered-internal")
    section = texts["index"].split("recovered, internal contact", 1)[1]
    row = re.search(r">objective</th><td>(.*?)</td><td>(.*?)</td>", section)
    assert row.groups() == (f"{result.published.objective:.5g}", f"{result.objective.value:.5g}")
    assert str(result.provenance["git_commit"])[:10] in texts["fits"]


def test_a_figure_has_its_caption_method_files_and_origin(site, texts):
    for part in ("Caption ", "A note.", "0.333333", "reports/fig_evil.py"):
        assert part in texts["figures"]
    for ending in ("png", "pdf", "csv"):
        assert f'href="figures/fig_evil.{ending}"' in texts["figures"]
        assert (site.index.parent / "figures" / f"fig_evil.{ending}").stat().st_size > 0
    assert 'href="figures.html#fig_evil"' in texts["statements"]


@pytest.mark.parametrize("page", ["figures", "fits", "statements"])
def test_texts_of_users_stay_text(texts, page):
    actual = Read(texts[page])
    assert EVIL in "".join(actual.texts)
    assert ("img", {"src": "x", "onerror": "alert(1)"}) not in actual.tags


def test_without_the_libraries_one_line_names_the_extra(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "mkdocs", None)
    with pytest.raises(InputError, match=r"mkdocs.*pip install 'cylcontact\[docs\]'"):
        build_site(Bench(tmp_path), tmp_path / "site")
    assert not any(tmp_path.iterdir())


def test_laws_are_not_compared_without_the_times_of_the_benchmarks(tmp_path):
    bench = Bench(tmp_path, results=ROOT / "fitting" / "results")
    assert (
        "benchmarks.json: the measured times do not exist" in answer("internal", bench)["problem"]
    )


def test_the_wheel_holds_templates_and_assets(tmp_path):
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    packed = set(zipfile.ZipFile(wheel).namelist())
    folder = ROOT / "src" / "cylcontact" / "reports" / "pages"
    needed = [folder / "mkdocs.yml", *folder.glob("assets/*"), *folder.glob("templates/*")]
    assert len(needed) >= 9
    assert {path.relative_to(ROOT / "src").as_posix() for path in needed} <= packed


@pytest.mark.parametrize("page", PAGES)
@pytest.mark.parametrize("width", [1440, 390])
def test_axe_finds_nothing_and_nothing_is_wider_than_the_page(browser, site, page, width):
    axe = require_package("axe_playwright_python.sync_playwright")
    for theme in ("light", "dark"):
        with opened(browser, site.index.parent / f"{page}.html", width, theme) as view:
            view.evaluate("document.querySelectorAll('details').forEach((it) => it.open = true)")
            assert view.evaluate("document.documentElement.scrollWidth") == width
            found = axe.Axe().run(view, options={"preload": False}).response["violations"]
            assert [(each["id"], each["nodes"][0]["html"]) for each in found] == []
