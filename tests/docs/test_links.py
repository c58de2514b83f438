"""Links of the checkout's Markdown lead to files of the checkout."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PLACES = ("*.md", "docs/**/*.md", "*/README.md", "datasets/*/README.md")
PAGES = sorted({page for place in PLACES for page in ROOT.glob(place)})
# Written by `make docs`, and not committed.
MADE = {ROOT / "docs/figures.md", ROOT / "docs/claims.md"}
LINK = re.compile(r"\]\((?!https?:|mailto:|#|data:)([^)\s]+)\)")


@pytest.mark.parametrize(
    "page",
    [each for each in PAGES if each not in MADE],
    ids=lambda page: str(page.relative_to(ROOT)),
)
def test_links_of_a_page_lead_to_files(page):
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)
    targets = [link.partition("#")[0] for link in LINK.findall(text)]
    missing = [target for target in targets if not (page.parent / target).exists()]
    assert missing == []
