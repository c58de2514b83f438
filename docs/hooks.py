"""mkdocs: formulas become MathML, which needs no script or font from elsewhere; gallery pages."""

import ast
import html
import re
from pathlib import Path

from latex2mathml.converter import convert
from mkdocs.structure.files import File
from mkdocs.utils import get_relative_url

FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[([](.*?)\\[)\]]</\1>', re.DOTALL)
# Indices in a text, as in R_i or σ_Y; names of code such as Y_log_scale are left alone.
INDEXED = re.compile(r"(?<![\w.-])([A-Za-zα-ωΑ-Ω])_([A-Za-zδ0-9])(?!\w)")
NOT_TEXT = re.compile(r"<(code|pre|math|script|h\d)\b.*?</\1>|<[^>]*>", re.DOTALL)
GALLERY = Path(__file__).parent / "gallery"
SCRIPT = """---
search:
  boost: 0.5
---
# {title}

{words}

![{title}]({name}.png)

```python
{code}
```

{output}Run it in a [checkout](../index.md#set-up): `python docs/gallery/{name}.py` leaves the
picture in the current folder. [All scripts](../gallery.md)
"""


# What a page links to in a checkout, and the page of the site that is made from it.
LINKS = {
    r"\]\(((?:\.\./)*)gallery/(\w+)\.py": r"](\1gallery/\2.md",
    r"\]\(\.\./((?:\.\./)*)reports/claims\.csv": r"](\1claims.md",
    r"\]\(\.\./((?:\.\./)*)reports/README\.md": r"](\1figures.md",
}


def on_page_markdown(text, **_):
    """Link to the pages that are made from files of the checkout."""
    for of_checkout, of_site in LINKS.items():
        text = re.sub(of_checkout, of_site, text)
    return text


def on_page_content(text, **_):
    """Set the formulas and indices of a page; an empty head of a column is an empty cell."""

    def mathml(match):
        latex = html.unescape(match[2])
        if match[1] == "span":
            return convert(latex)
        return f'<div class="formula">{convert(latex, display="block")}</div>'

    text = FORMULA.sub(mathml, text).replace("<th></th>", "<td></td>")
    pieces, end = [], 0
    for match in NOT_TEXT.finditer(text):
        pieces += [INDEXED.sub(r"\1<sub>\2</sub>", text[end : match.start()]), match[0]]
        end = match.end()
    return "".join([*pieces, INDEXED.sub(r"\1<sub>\2</sub>", text[end:])])


def on_post_page(output, page, **_):
    """Name the search box, which the theme leaves without a name, and let it search from disk."""
    ours = get_relative_url("search_from_disk.js", page.url)
    output = output.replace("https://unpkg.com/iframe-worker/shim", ours)
    return output.replace('role="dialog">', 'role="dialog" aria-label="Search">')


def on_files(files, config):
    """Add a page for each script of the gallery."""
    for script in sorted(GALLERY.glob("*.py")):
        page = File.generated(config, f"gallery/{script.stem}.md", content=script_page(script))
        files.append(page)
    return files


def script_page(script):
    """Return title, two sentences, picture, code and output of a script."""
    source = script.read_text(encoding="utf-8")
    title, _, words = ast.get_docstring(ast.parse(source)).partition("\n\n")
    printed, output = script.with_suffix(".txt"), ""
    if printed.exists():
        output = f"```text\n{printed.read_text(encoding='utf-8')}```\n\n"
    code = source.split('"""', 2)[2].strip()
    parts = {"title": title.rstrip("."), "words": words, "code": code, "output": output}
    return SCRIPT.format(name=script.stem, **parts)
