"""The folder for another paper in the documentation: its figure, its claim, its page."""

from cylcontact.reports import Bench
from cylcontact.reports.build import find_recipes
from cylcontact.reports.claims import ledger
from cylcontact.reports.pages import build_site
from tests.support.doc_blocks import ROOT, blocks
from tests.support.programs import skipping


def test_a_bench_of_three_files_reports_on_another_paper(tmp_path):
    for block in blocks(ROOT / "docs/how-to/extend.md"):
        if block.title.startswith("flores/"):
            target = tmp_path / block.title
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(block.text, encoding="utf-8")
    bench = Bench(tmp_path / "flores")
    assert list(find_recipes(bench)) == ["fig01"]
    assert [(claim.id, claim.verdict) for claim in ledger(bench)] == [
        ("5-low-restitution", "reproduced with a stated choice")
    ]
    with skipping():
        site = build_site(bench, tmp_path / "site")
    page = site.index.read_text(encoding="utf-8")
    assert "Contact of soft materials, recomputed" in page
    figures = (site.index.parent / "figures.html").read_text(encoding="utf-8")
    assert "Restitution that two factors achieve" in figures
    claims = (site.index.parent / "statements.html").read_text(encoding="utf-8")
    assert "the new factor also serves low restitution" in claims
    # Nothing of the shipped bench's paper is on them.
    for word in ("Pereira", "Enhanced cylindrical", "ceramics"):
        assert word not in page + claims
    assert site.missing == ()
