"""What the site needs beyond Markdown: equations as MathML, the gallery of figures, the changes."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Iterable, Iterator
from dataclasses import asdict, replace
from html import escape, unescape
from pathlib import Path

from latex2mathml.converter import convert
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from cylcontact.files import replacing
from cylcontact.plots.style import JOURNAL, FigureOptions
from cylcontact.reports import Bench
from cylcontact.reports.build import FigureResult, build, chosen_recipes, find_recipes
from cylcontact.reports.html.figures import Figure, Plate, describe, plates
from cylcontact.reports.paper import paper_of

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "src"
# Pictures of earlier builds, with the record of what each was drawn from.
DRAWN = ROOT / "build" / "gallery"
PNG, PART = FigureOptions(JOURNAL, ("png",)), 12
# Front matter that keeps a page out of the search.
UNINDEXED = "---\nsearch:\n  exclude: true\n---\n"
EQUATION = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL)


def on_page_content(html: str, **_: object) -> str:
    """Return a page with each equation as MathML, which browsers show without a script."""
    return EQUATION.sub(_mathml, html)


def _mathml(match: re.Match[str]) -> str:
    """Return an equation in LaTeX as MathML."""
    display = "block" if match[1] == "div" else "inline"
    return convert(unescape(match[2]).strip(), display=display)


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add the changes, the figures, and a page with the source of each recipe."""
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").replace("(docs/", "(")
    files.append(File.generated(config, "changes.md", content=changes))
    bench = Bench(ROOT, jobs=os.cpu_count() or 1)
    results = _drawn(bench)
    recipes = find_recipes(bench)
    for result in results:
        (png,) = result.paths
        files.append(File.generated(config, f"gallery/{png.name}", abs_src_path=str(png)))
    for recipe in {recipes[result.name] for result in results}:
        name = recipe.relative_to(ROOT).as_posix()
        code = recipe.read_text(encoding="utf-8")
        text = f"{UNINDEXED}# {name}\n\n```python\n{code}```\n"
        files.append(File.generated(config, f"gallery/{recipe.stem}.md", content=text))
    config.extra["figures"] = results
    return files


def on_page_markdown(markdown: str, *, page: Page, config: MkDocsConfig, **_: object) -> str:
    """Return the gallery with its figures, and any other page as it is."""
    if page.file.src_uri != "gallery.md":
        return markdown
    bench = Bench(ROOT)
    paper, recipes = paper_of(bench), find_recipes(bench)
    figures = [
        describe(result, recipes[result.name], ROOT, DRAWN.parent, paper)
        for result in config.extra["figures"]
    ]
    numbered, others = plates(figures, paper)
    return "\n".join(
        [
            markdown,
            "## Figures of the paper\n",
            *_shown(numbered),
            "## Other figures\n",
            *_shown(others),
        ]
    )


def _shown(plates: Iterable[Plate]) -> Iterator[str]:
    """Yield the figures of a section in Markdown."""
    yield '<div class="gallery" markdown>\n'
    for plate in plates:
        for figure in plate.figures:
            variant = f", {figure.variant}" if len(plate.figures) > 1 else ""
            yield _card(figure, f"{plate.heading}{variant}")
    yield "</div>\n"


def _card(figure: Figure, title: str) -> str:
    """Return a figure with its command, its recipe and its caption."""
    source = f"[{figure.recipe}](gallery/{Path(figure.recipe).stem}.md)"
    picture = f"[![{escape(title)}]({figure.picture}){{ loading=lazy }}]({figure.picture})"
    return (
        f"<div markdown>\n{picture}\n\n"
        f"**{title}**<br>`cylcontact figure {figure.name}` · {source}\n\n"
        f"<p>{escape(figure.caption)}</p>\n"
        f"<details><summary>How it was made</summary>{escape(figure.method)}</details>\n</div>\n"
    )


def _drawn(bench: Bench) -> list[FigureResult]:
    """Return all figures, drawing those whose inputs have changed since the last build."""
    record = DRAWN / "drawn.json"
    package = _package_hash()
    known = _recorded(record, package)
    names = chosen_recipes(bench)
    old = [name for name in names if name not in known or not _is_current(known[name])]
    # In parts, so that an interrupted build goes on where it was.
    for start in range(0, len(old), PART):
        for result in build(bench, old[start : start + PART], DRAWN, PNG):
            if result.problem:
                raise result.problem
            known[result.name] = replace(result, paths=result.paths[:1])
        figures = [asdict(figure) | {"paths": [f"{name}.png"]} for name, figure in known.items()]
        with replacing(record) as temporary:
            temporary.write_text(json.dumps({"package": package, "figures": figures}), "utf-8")
    return [known[name] for name in names]


def _recorded(record: Path, package: str) -> dict[str, FigureResult]:
    """Return the figures that this version of the package has drawn, by name."""
    if not record.is_file():
        return {}
    drawn = json.loads(record.read_text(encoding="utf-8"))
    if drawn["package"] != package:
        return {}
    results = (
        FigureResult(**figure | {"paths": tuple(DRAWN / name for name in figure["paths"])})
        for figure in drawn["figures"]
    )
    return {result.name: result for result in results}


def _is_current(result: FigureResult) -> bool:
    """Return whether the inputs of a figure are those that it was drawn from."""
    return result.paths[0].is_file() and all(
        any(_hash(path) == known for path in (PACKAGE / name, ROOT / name) if path.is_file())
        for name, known in result.inputs.items()
    )


def _hash(path: Path) -> str:
    """Return the start of a file's hash, as the results of figures have it."""
    return hashlib.sha256(path.read_bytes()).hexdigest()[:12]


def _package_hash() -> str:
    """Return a hash of the package's own sources."""
    sources = sorted(PACKAGE.rglob("*.py"))
    return hashlib.sha256("".join(map(_hash, sources)).encode()).hexdigest()
