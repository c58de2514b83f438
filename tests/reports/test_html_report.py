"""The report in a browser: everything is there, nothing breaks, and what is missing says why."""

import json
import re
import subprocess
import sys
import zipfile
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import pytest

from cylcontact.reports.bench import Bench
from cylcontact.reports.html import build_site
from cylcontact.reports.html.answer import answers
from cylcontact.reports.laws_to_use import laws_to_use
from tests.support.browser import opened
from tests.support.html_bench import EVIL_RECIPE, FITS, ROOT
from tests.support.programs import require_package

pytestmark = pytest.mark.slow


# One page of each kind, and those of a figure with a problem and of a missing one.
KINDS = (
    *("index", "figure-fig12", "figure-fig03", "figure-fig15"),
    *("claims", "claims-3.1", "fits"),
)
UNFOLD = "document.querySelectorAll('details').forEach((each) => each.open = true)"
SIZES = {1440: 900, 390: 844}


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
    return {page.stem: page.read_text("utf-8") for page in site.index.parent.glob("*.html")}


@pytest.fixture(scope="module")
def index(texts):
    return texts["index"]


def test_what_is_missing_is_told_and_is_on_its_page_with_the_reason(site, texts):
    reasons = {line.split(":", 1)[0]: line for line in site.missing}
    assert set(reasons) == {"fig03", "fig12p", "broken"}
    for name, page, reason in (
        ("fig03", "figure-fig03", "failed with ZeroDivisionError (division by zero)"),
        ("fig12p", "figure-fig12", "missing.json: this fit result does not exist"),
    ):
        assert reason in reasons[name]
        assert reason in texts[page]
    assert "there is no recipe reports/fig15.py" in texts["figure-fig15"]


def test_gallery_has_all_nineteen_figures_with_their_status(index):
    tiles = re.findall(r'<li class="tile (\w+)">.*?href="figure-(fig\d\d).html"', index, re.DOTALL)
    assert [name for _, name in tiles] == [f"fig{number:02d}" for number in range(1, 20)]
    assert [name for status, name in tiles if status == "drawn"] == ["fig12"]


def test_the_report_opens_with_the_law_of_least_error(index):
    for contact, reference, best in (
        ("internal", "conformal", "explicit"),
        ("external", "johnson", "johnson"),
    ):
        laws = laws_to_use(contact, Bench(ROOT)).set_index("law")[f"rms_{reference}"]
        assert laws.idxmin() == best
        assert f"<code>{best}</code></h3>" in index
        for law, rms in laws.items():
            shown = f"{rms:.4f}" if rms > 1e-9 else "0"
            assert f'<th scope="row">{law}</th><td>{shown}</td>' in index
    assert index.index('id="laws"') < index.index('id="coefficients"') < index.index('id="stands"')


@pytest.mark.parametrize(("contact", "law"), [("internal", "explicit"), ("external", "johnson")])
def test_formulas_are_mathematics_with_the_symbols_of_the_text(index, contact, law):
    text = laws_to_use(contact, Bench(ROOT)).set_index("law").loc[law, "formula"]
    label = f'aria-label="Formula of the law for {contact} contact">'
    shown = index.split(label, 1)[1].split("</div>", 1)[0]
    symbols = re.sub(r"<[^>]+>|[\s()\u2061]", "", unescape(shown))
    assert symbols == re.sub(r"[()·/ ]", "", text).replace("₋₁", "−1")
    assert "<msup><mi>E</mi><mo>*</mo></msup>" in shown


def test_the_wheel_holds_templates_styles_and_scripts(tmp_path):
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    packed = set(zipfile.ZipFile(wheel).namelist())
    folder = ROOT / "src" / "cylcontact" / "reports" / "html"
    needed = [*folder.glob("assets/*"), *folder.glob("templates/*")]
    assert len(needed) >= 10
    assert {path.relative_to(ROOT / "src").as_posix() for path in needed} <= packed


def test_ids_are_unique_and_every_address_leads_somewhere_on_disk(site, texts):
    pages = {f"{name}.html": Links(text) for name, text in texts.items()}
    reached = {"index.html"}
    for page, links in pages.items():
        assert len(links.ids) == len(set(links.ids))
        for address in links.addresses:
            if address.startswith("data:"):
                continue
            assert not re.match(r"\w+:|//", address), address
            file, _, anchor = unquote(address).partition("#")
            file = file or page
            reached.add(file)
            assert (site.index.parent / file).stat().st_size > 0
            assert not anchor or anchor in pages[file].ids, address
    assert set(pages) <= reached


def test_every_claim_is_on_one_page_and_in_the_count_of_its_section(texts):
    claims = json.loads((ROOT / "tests" / "golden" / "claims.json").read_text(encoding="utf-8"))
    ids = [each for text in texts.values() for each in Links(text).ids]
    shown = [each.removeprefix("claim-") for each in ids if each.startswith("claim-")]
    assert sorted(shown) == sorted(claims)
    counts = re.findall(r'href="claims-([^"#]+).html#\w+">(\d+)</a>', texts["claims"])
    for section in ("3.1", "3.4", "abstract"):
        in_section = [
            number for page, number in counts if re.fullmatch(f"{section}(-part.)?", page)
        ]
        expected = sum(each.startswith(f"{section}-") for each in claims)
        assert sum(map(int, in_section)) == expected > 0


def test_every_figure_has_its_caption_method_downloads_and_provenance(texts):
    assert "(Eqs 5-6; published coefficients) less Johnson" in texts["figure-fig12"]
    assert "<summary>Method</summary>" in texts["figure-fig_evil"]
    assert '<p class="prose">A note.</p>' in texts["figure-fig_evil"]
    for page, name, recipe in (
        ("figure-fig12", "fig12", "maps"),
        ("figure-fig_maps_refit", "fig_maps_refit", "maps"),
        ("figure-fig_evil", "fig_evil", "fig_evil"),
    ):
        for ending in ("png", "pdf", "csv"):
            assert f'href="figures/{name}.{ending}" download' in texts[page]
        assert f"from <code>reports/{recipe}.py</code>" in texts[page]
    assert "from <code>fitting/results/internal.json</code>" in texts["figure-fig_maps_refit"]
    assert "from <code>cylcontact/data/materials.csv</code>" in texts["figure-fig12"]
    # Each picture says what it shows and the main numbers, and does not repeat the caption.
    alternatives = Links(texts["figure-fig12"]).pictures
    assert len(set(alternatives)) == 1
    for text in alternatives:
        assert text.startswith("Enhanced against Johnson: low-carbon steel")
        assert re.search(r": [-\d]", text)
        assert "Penetration of the enhanced law" not in text


def test_the_published_law_stands_in_its_own_column(index, texts):
    result = Bench(ROOT).result("recovered-internal")
    section = index.split('id="coefficients"', 1)[1].split("</section>", 1)[0]
    row = re.search(r">objective</th><td>(.*?)</td>\s*<td>(.*?)</td>", section)
    assert row.groups() == (
        f"{result.published.objective:.5g}",
        f"{result.objective.value:.5g}",
    )
    commits = {str(Bench(ROOT).result(n).provenance["git_commit"])[:10] for n in FITS}
    assert all(commit in texts["fits"] for commit in commits)
    footer = index.split("<footer>", 1)[1]
    assert ("several" in footer) == (len(commits) > 1)


def test_texts_of_users_stay_text(texts):
    for text in texts.values():
        assert "<img src=x" not in text
    for page in ("figure-fig_evil", "fits"):
        assert "&lt;img src=x onerror=alert(1)&gt; &amp; " in texts[page]
        assert "{{ 7 * 7 }}" in texts[page]


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
    index = site.index.read_text(encoding="utf-8")
    assert "none of the main fits exists" in index
    (reason, _) = [line for line in site.missing if line.startswith("laws: ")]
    assert "practical.json: this fit result does not exist" in reason
    assert index.count("Missing: ") == 3


def test_laws_are_not_compared_without_the_times_of_the_benchmarks(tmp_path):
    bench = Bench(tmp_path, results=ROOT / "fitting" / "results")
    for answer in answers(bench):
        assert "benchmarks.json: the measured times do not exist" in answer.problem


@pytest.mark.long
@pytest.mark.parametrize("width", SIZES)
def test_no_page_is_longer_than_eight_screens(browser, site, texts, width):
    assert set(KINDS) < set(texts)
    with opened(browser, site.index, width) as view:
        for page in texts:
            view.goto((site.index.parent / f"{page}.html").as_uri())
            height = view.evaluate("document.documentElement.scrollHeight")
            assert height <= 8 * SIZES[width], page


@pytest.mark.long
@pytest.mark.parametrize("page", KINDS)
@pytest.mark.parametrize("width", SIZES)
def test_layout_holds(browser, site, page, width):
    with opened(browser, site.index.parent / f"{page}.html", width) as view:
        view.evaluate(UNFOLD)
        view.wait_for_timeout(200)
        assert view.evaluate("document.documentElement.scrollWidth") == width
        outside = """(width) => [...document.querySelectorAll('main *')].filter((node) => {
          const box = node.getBoundingClientRect();
          return box.right > width + 1 && !node.closest('.scroll, svg');
        }).map((node) => node.outerHTML.slice(0, 80))"""
        assert view.evaluate(outside, width) == []
        unlabelled = """() => [...document.querySelectorAll('.scroll, .equation')].filter((node) =>
          !(node.ariaLabel && node.tabIndex === 0)).length"""
        assert view.evaluate(unlabelled) == 0


@pytest.mark.long
@pytest.mark.parametrize("page", KINDS)
@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("width", SIZES)
def test_axe_finds_nothing(browser, site, page, theme, width):
    with opened(browser, site.index.parent / f"{page}.html", width, theme) as view:
        view.evaluate(UNFOLD)
        view.wait_for_timeout(200)
        axe = require_package("axe_playwright_python.sync_playwright")
        found = axe.Axe().run(view).response["violations"]
        assert [(each["id"], [node["html"] for node in each["nodes"]]) for each in found] == []


@pytest.mark.parametrize("page", ["index", "figure-fig12", "claims", "claims-3.1", "fits"])
def test_keys_reach_everything_in_order_with_a_visible_ring(browser, site, page):
    with opened(browser, site.index.parent / f"{page}.html") as view:
        order = """() => [...document.querySelectorAll('a[href], button, summary, [tabindex="0"]')]
          .filter((node) => node.checkVisibility()).map((node) => node.outerHTML)"""
        focused = "document.activeElement.outerHTML"
        ring = "getComputedStyle(document.activeElement).outlineStyle"
        for expected in view.evaluate(order):
            view.keyboard.press("Tab")
            assert view.evaluate(focused) == expected
            assert view.evaluate(ring) == "solid"
        view.goto(view.url)
        view.keyboard.press("Tab")
        view.keyboard.press("Enter")
        assert view.evaluate("document.activeElement.id") == "content"


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


def test_downloads_are_the_files(browser, site):
    with opened(browser, site.index.parent / "figure-fig12.html") as view:
        with view.expect_download() as waiting:
            view.locator('a[href="figures/fig12.csv"]').click()
        own = site.index.parent / "figures" / "fig12.csv"
        assert Path(waiting.value.path()).read_bytes() == own.read_bytes()


@pytest.mark.long
@pytest.mark.parametrize("page", KINDS)
def test_prints_with_everything_unfolded(browser, site, page):
    with opened(browser, site.index.parent / f"{page}.html", theme="dark") as view:
        view.evaluate("""() => { window.unfolded = false; addEventListener('beforeprint', () => {
          window.unfolded = !document.querySelector('details:not([open])'); }); }""")
        pdf = view.pdf(format="A4")
        assert pdf.startswith(b"%PDF")
        assert pdf.count(b"/Type /Page\n") >= 1
        assert view.evaluate("window.unfolded")
        view.emulate_media(media="print")
        assert not view.locator(".bar").is_visible()
        assert (
            view.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
        )
