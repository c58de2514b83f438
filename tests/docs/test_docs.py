"""The documentation: its code runs and prints what it says, its site is whole and offline."""

import re
import shutil
import subprocess
from functools import partial
from html.parser import HTMLParser

import pytest
import typer

from cylcontact.cli import app
from cylcontact.reports.bench import Bench
from cylcontact.reports.pages import build_site
from tests.support.browser import chromium, opened
from tests.support.doc_blocks import ROOT, blocks, copy_bench, run_page, same
from tests.support.programs import require_package

PAGES = sorted(
    path
    for pattern in ("*.md", "docs/**/*.md", "*/README.md")
    for path in ROOT.glob(pattern)
    if ".venv" not in path.parts
)
README = ROOT / "README.md"  # followed twice in a row, below
WITH_CODE = [
    page
    for page in PAGES
    if page != README and any(b.language in ("python", "bash") for b in blocks(page))
]
SLOW = {
    "science.md", "calibration.md", "extend.md", "mechanism.md", "fit-my-data.md", "cluster.md",
    "choose-a-law.md", "other-codes.md", "export.md", "reproduce-the-paper.md", "write-a-paper.md",
    "from-a-drawing.md", "housing.md",
}  # fmt: skip
each_page = pytest.mark.parametrize(
    "page",
    [pytest.param(p, marks=pytest.mark.slow) if p.name in SLOW else p for p in WITH_CODE],
    ids=lambda path: str(path.relative_to(ROOT)),
)


@each_page
def test_code_runs_and_prints_what_the_page_says(page, tmp_path, monkeypatch):
    copy_bench(tmp_path)
    before = None
    for block, printed in run_page(page, tmp_path, monkeypatch):
        if block.language == "text" and block.adjacent and before is not None:
            assert same(block.text, before), f"\nshown:\n{block.text}\nprinted:\n{before}"
        before = printed


@pytest.mark.slow
def test_the_readme_leaves_no_litter_and_can_be_followed_twice(tmp_path, monkeypatch):
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True)
    for name in listed.stdout.decode().strip("\0").split("\0"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / name, tmp_path / name)
    git = partial(subprocess.run, cwd=tmp_path, check=True, capture_output=True, text=True)
    identity = ("-c", "user.name=n", "-c", "user.email=e", "-c", "commit.gpgsign=false")
    for command in (("init",), ("add", "."), ("commit", "--message", "all")):
        git(["git", *identity, *command])
    for _ in range(2):
        run_page(README, tmp_path, monkeypatch)
        assert git(["git", "status", "--porcelain"]).stdout == ""


# --- the site ---


class Links(HTMLParser):
    """The links of a page, and what it loads."""

    def __init__(self, text):
        super().__init__()
        self.loaded, self.links, self.ids = [], [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        named = dict(attributes)
        self.ids |= {named[key] for key in ("id", "name") if named.get(key)}
        if tag == "a" and named.get("href"):
            self.links.append(named["href"])
        elif tag in ("script", "img", "iframe", "source") and named.get("src"):
            self.loaded.append(named["src"])
        elif tag == "link" and named.get("href"):
            self.loaded.append(named["href"])


FEW = ["fig01", "fig02", "fig12", "fig_maps_refit"]


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The site with a few figures, built strictly: a broken link or an unknown name stops it."""
    require_package("mkdocstrings")
    pages = "cylcontact.reports.pages"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("cylcontact.reports.build.chosen_recipes", lambda *_: FEW)
        patch.setattr(f"{pages}.content.ledger", lambda *_: [])
        return build_site(Bench(ROOT), tmp_path_factory.mktemp("docs") / "site").index.parent


def test_every_page_is_in_the_site(site):
    for page in (ROOT / "docs").rglob("*.md"):
        built = site / page.relative_to(ROOT / "docs").with_suffix(".html")
        assert built.is_file()
        assert "<h1" in built.read_text(encoding="utf-8")


def test_nothing_comes_from_the_network(site):
    for page in site.rglob("*.html"):
        loaded = Links(page.read_text(encoding="utf-8")).loaded
        assert loaded
        assert not [link for link in loaded if re.match(r"(https?:)?//", link)], page.name
    for sheet in site.rglob("*.css"):
        assert not re.search(r"(url\(|@import)\s*['\"]?(https?:)?//", sheet.read_text("utf-8"))


def test_links_and_files_of_the_site_exist(site):
    parsed = {page: Links(page.read_text(encoding="utf-8")) for page in site.rglob("*.html")}
    for page, actual in parsed.items():
        for link in actual.links + actual.loaded:
            path, _, anchor = link.partition("#")
            if re.match(r"[a-z]+:", link):
                continue
            target = (page.parent / path).resolve() if path else page
            assert target.is_file(), f"{page.name}: {link}"
            if anchor and target.suffix == ".html":
                assert anchor in parsed[target].ids, f"{page.name}: {link}"


def test_equations_are_mathml_and_no_star_is_lost(site):
    equations = 0
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        source = page.relative_to(site).with_suffix(".md")
        written = (ROOT / "docs" / source).is_file() and (ROOT / "docs" / source).read_text("utf-8")
        assert "arithmatex" not in text, page.name
        assert not re.search(r"\w<em>|</em>[\w/·^]", text), page.name
        if written:
            assert text.count('display="block"') == written.count("\n$$\n") / 2, page.name
        equations += text.count("<math")
    assert equations > 10
    text = (site / "reference" / "laws.html").read_text(encoding="utf-8")
    assert "f = π·E*·δ/[ln(4π·E*·ΔR/f) − 1]" in text
    text = (site / "science.html").read_text(encoding="utf-8")
    assert "<msup><mi>E</mi><mo>&#x0002A;</mo></msup>" in text


def test_the_site_shows_each_figure_with_its_command_and_recipe(site):
    page = site / "figures.html"
    text, parsed = page.read_text(encoding="utf-8"), Links(page.read_text(encoding="utf-8"))
    for name, recipe in zip(FEW, ("fig01", "fig02", "maps", "maps"), strict=True):
        assert f"figures/{name}.png" in parsed.loaded
        assert f"<code>cylcontact figure {name}</code>" in text
        assert f"figures/{recipe}.html" in parsed.links
        assert "Drawing" in (site / "figures" / f"{recipe}.html").read_text(encoding="utf-8")
    assert "Figure 12. Enhanced against Johnson: low-carbon steel" in text


# Elements that reach beyond the window, unless they or what they are in can be scrolled.
CUT_OFF = """() => {
  const scrolls = (node) => ["auto", "scroll"].includes(getComputedStyle(node).overflowX);
  const cut = (node) => {
    const box = node.getBoundingClientRect();
    if (box.left > -1 && box.right < innerWidth + 1) return false;
    for (let at = node; at; at = at.parentElement) if (scrolls(at)) return false;
    return true;
  };
  const parts = [...document.querySelectorAll("article *")];
  const found = parts.filter((node) => node.checkVisibility() && cut(node))
    .map((node) => `${node.tagName} ${node.textContent.slice(0, 40)}`);
  for (const code of document.querySelectorAll("article pre > code"))
    if (code.scrollWidth > code.clientWidth && !scrolls(code)) found.push(code.textContent);
  if (document.documentElement.scrollWidth > innerWidth) found.push("the page");
  return found;
}"""


@pytest.mark.long
@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("width", [1440, 390])
def test_axe_finds_nothing_and_nothing_is_cut_off(site, width, theme):
    axe = require_package("axe_playwright_python.sync_playwright").Axe()
    # The theme names a part of the contents by its heading, and two headings may be the same.
    options = {"preload": False, "rules": {"landmark-unique": {"enabled": False}}}
    found = {}
    with chromium() as browser:
        size = {"width": width, "height": 900}
        page = browser.new_page(viewport=size, color_scheme=theme)
        for path in sorted(site.rglob("*.html")):
            page.goto(path.as_uri())
            assert page.evaluate(CUT_OFF) == [], path.name
            violations = axe.run(page, options=options).response["violations"]
            found |= {f"{path.name}: {each['id']}": each["nodes"][0] for each in violations}
    assert found == {}


def test_equations_have_a_font_of_the_site(site):
    with chromium() as browser, opened(browser, site / "reference" / "formulas.html") as page:
        page.wait_for_function("document.fonts.status === 'loaded'")
        loaded = page.evaluate("[...document.fonts].map((each) => each.family + each.status)")
        assert '"Site Math"loaded' in loaded or "Site Mathloaded" in loaded
        family = page.evaluate("getComputedStyle(document.querySelector('math')).fontFamily")
        assert family.startswith('"Site Math"')


def test_search_works_from_disk_and_asks_the_network_for_nothing(site):
    with chromium() as browser, opened(browser, site / "tutorial.html") as page:
        actual = page.locator(".md-search-result__item", has_text="conformal")
        for _ in range(30):  # what is typed before the search is ready is lost
            page.fill("input.md-search__input", "")
            page.locator("input.md-search__input").press_sequentially("Persson")
            page.wait_for_timeout(500)
            if actual.count():
                break
        assert actual.count()


def test_every_command_is_in_the_reference():
    text = (ROOT / "docs/reference/command-line.md").read_text(encoding="utf-8")
    commands = typer.main.get_command(app).commands
    assert set(re.findall(r"^\| `([a-z-]+)", text, re.MULTILINE)) == set(commands)
