"""A small manuscript with its values, whose figure is fig99."""

import shutil

from tests.support.small_bench import ROOT

FOLDER = ROOT / "reports/manuscript"
SHARED = ("article.tex", "article.typ", "references.bib")
HEAD = """---
title: A test
author: [{name: A. Author}]
abstract: Nothing.
bibliography: references.bib
---

"""
VALUES = """
import pandas as pd

from cylcontact.reports.manuscript import number, plain

DEPTH = 2.5


def wear(bench):
    assert DEPTH > 2, "more than two"
    table = pd.DataFrame({"load, N/mm": ["20", "50"], "law": [plain("a_b"), plain("*c*")]})
    return {"depth": number(DEPTH, "µm"), "count": 3, "who": plain("A & B_c"), "table": table}
"""
BODY = """Deep are {{wear.depth}}, more than
two, and {{ wear.count | words }} of {{wear.who}} [@johnson1985, Sect. 4.2];
see @fig:one, @tbl:one, @eq:one.

$$ a = 1.5 b $$ {#eq:one}

![A line in {{ figure("fig99")["largest load, N/mm"] | number("N/mm") }}.](fig99){#fig:one}

{{wear.table}}

: Two loads. {#tbl:one}
"""


def write_manuscript(folder):
    """Write a manuscript, `a.md`, with its values, which has the figure fig99."""
    folder.mkdir(parents=True)
    for name in SHARED:
        shutil.copy(FOLDER / name, folder)
    (folder / "values.py").write_text(VALUES)
    (folder / "a.md").write_text(HEAD + BODY)
