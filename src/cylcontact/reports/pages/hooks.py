"""What mkdocs calls: it adds the pages of the results, and writes equations as MathML."""

import re
from html import unescape
from pathlib import Path
from typing import Any

from latex2mathml.converter import convert
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

ASSETS = Path(__file__).parent / "assets"
EQUATION = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL)


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Leave out the page of a server that does not find one: the site is read from disk."""
    config.theme.static_templates.discard("404.html")
    return config


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add the pages of the results, the files that they link to, and the site's own assets."""
    content = config.extra["content"]
    for address, text in content.pages.items():
        files.append(File.generated(config, address, content=text))
    assets = {f"assets/{file.name}": file for file in ASSETS.iterdir()}
    for address, file in (content.files | assets).items():
        files.append(File.generated(config, address, abs_src_path=str(file)))
    return files


def on_page_content(html: str, **_: Any) -> str:
    """Return a page with equations as MathML, which needs no script; what is wide can be scrolled.

    Boxes that scroll can be reached with the keyboard, and an empty corner heads nothing.
    """
    html = html.replace("<th></th>", "<td></td>")
    html = html.replace("<table>", '<div class="scroll" tabindex="0"><table class="numbers">')
    return EQUATION.sub(_mathml, html.replace("</table>", "</table></div>"))


def on_post_page(output: str, **_: Any) -> str:
    """Return a page whose search has a name for those who hear it; the theme gives it none."""
    dialog = 'data-md-component="search" role="dialog"'
    return output.replace(dialog, f'{dialog} aria-label="Search"')


def _mathml(match: re.Match[str]) -> str:
    """Return an equation in LaTeX as MathML."""
    latex = unescape(match[2]).strip()
    if match[1] == "span":
        return convert(latex, display="inline")
    return f'<div class="scroll" tabindex="0">{convert(latex, display="block")}</div>'
