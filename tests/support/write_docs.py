"""Write anew what pages show as output: python -m tests.support.write_docs docs/science.md ...

A block that has "..." in it is left to its author.
"""

import re
import sys
import tempfile
from pathlib import Path

import pytest

from tests.support.doc_blocks import FENCE, copy_bench, run_page, same


def rewritten(page, folder, monkeypatch):
    """Return a page's text with the output that its code prints now."""
    copy_bench(folder)
    ran = run_page(page, folder, monkeypatch)
    text, pieces, end, before = page.read_text(encoding="utf-8"), [], 0, None
    for (block, printed), match in zip(ran, FENCE.finditer(text), strict=True):
        visible = block.language == "text" and block.adjacent and before is not None
        if visible and "..." not in block.text and not same(block.text, before):
            pieces += [text[end : match.start(4)], re.sub(r" +$", "", before.rstrip(), flags=re.M)]
            pieces.append("\n")
            end = match.end(4)
        before = printed
    return "".join([*pieces, text[end:]])


if __name__ == "__main__":
    for name in sys.argv[1:]:
        page = Path(name).resolve()
        with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
            text = rewritten(page, Path(folder), patch)
        page.write_text(text, encoding="utf-8")
