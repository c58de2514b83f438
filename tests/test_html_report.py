"""The report in a browser: everything is there, nothing breaks, and what is missing says why."""

import re
import subprocess
import sys
import zipfile
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import pytest

from cylcontact.reports.bench import Bench
from cylcontact.reports.html import build_site
from tests.browser import CONTRAST, opened
from tests.html_bench import EVIL_RECIPE, ROOT

FITS = ("internal", "external", "explicit-internal")  # of the small bench


class Links(HTMLParser):
    """Every address on a page, every id, and every picture's alternative text."""

    def __init__(self, text):
        super().__init__()
        self.addresses, self.ids, self.pictures = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        actual = dict(attrs)
        self.addresses += [actual[key] for key in ("href", "src") if actual.get(key)]
        self.ids += [actual["id"]] if "id" in actual else []
        self.pictures += [actual.get("alt")] if tag == "img" else []


@pytest.fixture(scope="module")
def texts(site):
    """The pages by name."""
    names = ("index", "claims", "explore")
    return {name: (site.index.parent / f"{name}.html").read_text("utf-8") for name in names}


@pytest.fixture(scope="module")
def index(texts):
    return texts["index"]


def test_what_is_missing_is_told_and_is_on_the_page_with_its_reason(site, index):
    reasons = {line.split(":", 1)[0]: line for line in site.missing}
    assert set(reasons) == {"fig03", "fig12p", "broken"}
    for name, reason in (
        ("fig03", "failed with ZeroDivisionError (division by zero)"),
        ("fig12p", "practical.json: this fit result does not exist"),
    ):
        assert reason in reasons[name]
        assert reason in index
    assert "there is no recipe reports/fig15.py" in index


def test_checklist_has_all_nineteen_figures_with_their_status(index):
    tiles = re.findall(r'<li class="tile (\w+)">.*?<code>(fig\d\d)</code>', index, re.DOTALL)
    assert [name for _, name in tiles] == [f"fig{number:02d}" for number in range(1, 20)]
    assert [name for status, name in tiles if status == "drawn"] == ["fig12"]


def test_the_wheel_holds_templates_styles_and_scripts(tmp_path):
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    packed = set(zipfile.ZipFile(wheel).namelist())
    folder = ROOT / "src" / "cylcontact" / "reports" / "html"
    needed = [*folder.glob("assets/*"), *folder.glob("templates/*")]
    assert len(needed) >= 10
    assert {path.relative_to(ROOT / "src").as_posix() for path in needed} <= packed


@pytest.mark.parametrize("page", ["index", "claims", "explore"])
def test_ids_are_unique_and_every_address_leads_somewhere_on_disk(site, texts, page):
    pages = {f"{name}.html": Links(text) for name, text in texts.items()}
    ids = pages[f"{page}.html"].ids
    assert len(ids) == len(set(ids))
    for address in pages[f"{page}.html"].addresses:
        if address.startswith("data:"):
            continue
        assert not re.match(r"\w+:|//", address), address
        file, _, anchor = unquote(address).partition("#")
        file = file or f"{page}.html"
        assert (site.index.parent / file).stat().st_size > 0
        assert not anchor or anchor in pages[file].ids


def test_every_figure_has_its_caption_downloads_and_provenance(index):
    assert "Penetration of the enhanced law (Eqs 5-6) less Johnson" in index
    for name in ("fig12", "fig12r", "fig_evil"):
        for ending in ("png", "pdf", "csv"):
            assert f'href="figures/{name}.{ending}" download' in index
    for recipe in ("maps", "fig_evil"):
        assert f"from <code>reports/{recipe}.py</code>" in index
    assert "from <code>fitting/results/internal.json</code>" in index
    assert "from <code>cylcontact/data/materials.csv</code>" in index
    # A tile's picture is named by the words beside it; a figure's, by its caption.
    alternatives = [text for text in Links(index).pictures if text]
    assert len(alternatives) == 3


def test_the_published_law_stands_in_its_own_column(index):
    result = Bench(ROOT).result("internal")
    section = index.split('id="coefficients"', 1)[1].split("</section>", 1)[0]
    row = re.search(r">objective</th><td>(.*?)</td>\s*<td>(.*?)</td>", section)
    assert row.groups() == (
        f"{result.published.objective:.5g} (ln)",
        f"{result.objective.value:.5g} (ln)",
    )
    commits = {str(Bench(ROOT).result(n).provenance["git_commit"])[:10] for n in FITS}
    assert all(commit in index for commit in commits)
    footer = index.split("<footer>", 1)[1]
    assert ("several" in footer) == (len(commits) > 1)


def test_texts_of_users_stay_text(index, texts):
    assert "<img src=x" not in index
    assert "&lt;img src=x onerror=alert(1)&gt; &amp; " in index
    assert "{{ 7 * 7 }}" in index
    assert "<img src=x" not in texts["explore"]
    assert r"\u003cimg src=x" in texts["explore"]


def test_same_bytes_again(site, tmp_path):
    bench = Bench(site.index.parents[2])
    again = build_site(bench, tmp_path / "html")
    for file in sorted(again.index.parent.rglob("*")):
        if file.is_file():
            other = site.index.parent / file.relative_to(again.index.parent)
            assert file.read_bytes() == other.read_bytes(), file.name


def test_a_bench_with_a_broken_table_of_materials_still_has_a_report(tmp_path):
    for name in ("reports", "datasets"):
        (tmp_path / name).mkdir()
    (tmp_path / "datasets" / "materials.csv").write_bytes(b"\xff")
    (tmp_path / "reports" / "fig_evil.py").write_text(EVIL_RECIPE)
    (tmp_path / "reports" / "paper.py").write_text(
        'from cylcontact.reports.paper import Paper\n\nPAPER = Paper(fits=("internal",))\n'
    )
    site = build_site(Bench(tmp_path), tmp_path / "html")
    explore = (site.index.parent / "explore.html").read_text(encoding="utf-8")
    assert "materials.csv: cannot be read" in explore
    assert "none of the main fits exists" in site.index.read_text(encoding="utf-8")


@pytest.mark.parametrize("page", ["index", "claims", "explore"])
@pytest.mark.parametrize("width", [360, 1440])
def test_layout_holds(browser, site, page, width):
    with opened(browser, site.index.parent / f"{page}.html", width) as view:
        view.evaluate("document.querySelectorAll('details').forEach((each) => each.open = true)")
        view.wait_for_timeout(200)
        assert view.evaluate("document.documentElement.scrollWidth") == width
        outside = """(width) => [...document.querySelectorAll('main *')].filter((node) => {
          const box = node.getBoundingClientRect();
          return box.right > width + 1 && !node.closest('.scroll, svg, .equation');
        }).map((node) => node.outerHTML.slice(0, 80))"""
        assert view.evaluate(outside, width) == []


@pytest.mark.parametrize("page", ["index", "claims", "explore"])
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_all_text_has_enough_contrast(browser, site, page, theme):
    with opened(browser, site.index.parent / f"{page}.html", theme=theme) as view:
        view.evaluate("document.querySelectorAll('details').forEach((each) => each.open = true)")
        view.wait_for_timeout(300)
        ratios = view.evaluate(CONTRAST)
        assert len(ratios) > 50
        assert [actual for actual in ratios if actual[0] < 4.5] == []


def test_theme_follows_the_system_until_it_is_chosen(browser, site):
    page_colour = "getComputedStyle(document.body).backgroundColor"
    with opened(browser, site.index, theme="dark") as view:
        dark = view.evaluate(page_colour)
        button = view.get_by_role("button", name="Dark")
        assert button.get_attribute("aria-pressed") == "true"
        button.click()
        assert view.evaluate(page_colour) != dark
        view.reload()
        assert view.get_by_role("button", name="Dark").get_attribute("aria-pressed") == "false"
        assert view.evaluate(page_colour) != dark


def test_claims_are_filtered_by_verdict_section_and_words(browser, site):
    with opened(browser, site.index.parent / "claims.html") as view:
        message = view.locator("#claims-count")
        every = view.locator(".claim").count()
        assert message.text_content() == f"{every} of {every} claims shown"
        view.get_by_label(re.compile("^reproduced with a stated choice")).uncheck()
        view.get_by_label("Section").select_option("3.4")
        left = view.locator(".claim:visible")
        assert 0 < left.count() < every
        assert set(left.evaluate_all("nodes => nodes.map((n) => n.dataset.section)")) == {"3.4"}
        assert "choice" not in left.evaluate_all("nodes => nodes.map((n) => n.dataset.verdict)")
        assert view.locator("#choice").is_hidden()
        view.get_by_label("Words").fill("no such word anywhere")
        assert message.text_content() == f"0 of {every} claims shown"
        view.get_by_role("button", name="Show all").click()
        view.wait_for_timeout(50)
        assert message.text_content() == f"{every} of {every} claims shown"


def test_downloads_are_the_files(browser, site):
    with opened(browser, site.index) as view:
        with view.expect_download() as waiting:
            view.locator('a[href="figures/fig12.csv"]').click()
        own = site.index.parent / "figures" / "fig12.csv"
        assert Path(waiting.value.path()).read_bytes() == own.read_bytes()


@pytest.mark.parametrize("page", ["index", "claims", "explore"])
def test_prints_with_everything_unfolded(browser, site, page):
    with opened(browser, site.index.parent / f"{page}.html", theme="dark") as view:
        view.evaluate("""() => { window.unfolded = false; addEventListener('beforeprint', () => {
          window.unfolded = !document.querySelector('details:not([open])'); }); }""")
        pdf = view.pdf(format="A4")
        assert pdf.startswith(b"%PDF")
        assert pdf.count(b"/Type /Page\n") >= (1 if page == "explore" else 4)
        assert view.evaluate("window.unfolded")
        view.emulate_media(media="print")
        assert not view.locator(".bar").is_visible()
        assert (
            view.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
        )
