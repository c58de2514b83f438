"""Manuscripts: numbers come from results, references lead somewhere, and LaTeX sets them."""

import io
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cylcontact import InputError
from cylcontact.reports.bench import Bench
from cylcontact.reports.manuscript import PLACEHOLDER, Values, fill, own_values, table_text
from cylcontact.reports.quantity import Quantity, markdown
from cylcontact.reports.typeset import typed_numbers, typeset
from tests.reports.test_bench import RECIPE
from tests.support.drawn_figures import BENCH
from tests.support.html_bench import CACHES
from tests.support.manuscript_files import FOLDER, HEAD, SHARED, write_manuscript
from tests.support.programs import require_package, require_program
from tests.support.spec_files import tree

ROOT = BENCH.root
OURS = FOLDER / "contact-laws.md"


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """A small bench with a manuscript, the current folder."""
    write_manuscript(tmp_path / "reports/mine")
    (tmp_path / "reports/paper.py").write_text("LOADS = (10.0, 1000.0)\n")
    (tmp_path / "reports/fig99.py").write_text(RECIPE)
    results = tmp_path / "fitting/results"
    results.mkdir(parents=True)
    shutil.copy(ROOT / "fitting/results/internal.json", results)
    monkeypatch.chdir(tmp_path)
    return Bench(tmp_path)


@pytest.fixture
def filled(bench):
    """A function that fills a text in the bench."""
    source = bench.root / "reports/mine/a.md"
    return lambda text: fill(text, Values(Bench(bench.root), source)).text


def typeset_text(bench, text):
    """Typeset a text in the bench; return what was written and the LaTeX."""
    source = bench.root / "reports/mine/a.md"
    source.write_text(HEAD + text, encoding="utf-8")
    made = typeset(bench, source, bench.root / "out")
    return made, (made.sources / "a.tex").read_text("utf-8")


# --- numbers ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("quantity", "form", "text"),
    [
        (Quantity(0.96609), "", "0.966"),
        (Quantity(0.95), "", "0.950"),
        (Quantity(5.0, digits=1), "", "5"),
        (Quantity(0.0, "mm"), "", r"0.00\ mm"),
        (Quantity(-0.0), ".1f", "0.0"),
        (Quantity(4e-5), ".1f", "0.0"),
        (Quantity(-1e-5), ".0f", "0"),
        (Quantity(np.float64(1.5), digits=2), "", "1.5"),
        (Quantity(np.int64(3)), "words", "three"),
        (Quantity(12345.6), "", "12300"),
        (Quantity(1234567), "", "1234567"),
        (Quantity(1234567.0), "", r"$1.23 \times 10^{6}$"),
        (Quantity(-0.00001), "", r"$-1.00 \times 10^{-5}$"),
        (Quantity(9.996e-5), "", r"0.000100"),
        (Quantity(-1.5, "%"), ".2g", r"$-1.5$\ \%"),
        (Quantity(1.5, "%"), "+.1f", r"+1.5\ \%"),
        (Quantity(-1.5), "+.1f", r"$-1.5$"),
        (Quantity(1500.0), ".1e", r"$1.5 \times 10^{3}$"),
        (Quantity(2e6), ".0f", "2000000"),
        (Quantity(1e-8, digits=1), "", r"$10^{-8}$"),
        (Quantity((-1.0, 2.5), "%", 2), "", r"$-1.0$ to 2.5\ \%"),
        (Quantity(7, "runs"), "words", r"seven\ runs"),
        (Quantity(13), "words", "13"),
        (Quantity(1.0, "mm^(1-n)"), ".1f", r"1.0\ mm$^{1-n}$"),
        (Quantity(1.0, "N/mm²"), ".1f", r"1.0\ N\/mm$^{2}$"),
        (Quantity(30.0, "°"), ".0f", r"30$^\circ$"),
    ],
)
def test_numbers_are_printed_as_journals_want_them(quantity, form, text):
    assert quantity.text(form) == text


@given(st.floats(-1e12, 1e12, allow_nan=False), st.integers(1, 7))
def test_a_printed_number_is_the_number_to_its_digits(value, digits):
    text = Quantity(value, digits=digits).text().strip("$")
    mantissa, _, power = re.sub(r"( \\times )?10\^\{", "e", text).rstrip("}").partition("e")
    printed = float(mantissa or 1) * 10.0 ** int(power or 0)
    assert printed == pytest.approx(value, rel=0.500001 * 10 ** (1 - digits), abs=1e-300)


def test_a_fit_gives_its_coefficients_with_units_and_digits(filled):
    result = json.loads(Path("fitting/results/internal.json").read_text("utf-8"))
    a = result["coefficients"]["a"]
    assert filled("{{fit.internal.a}}") == rf"{a:.4g}\ mm$^{{1-n}}$"
    assert filled("{{fit.internal.objective:.2g}}") == f"{result['objective']['value']:.2g}"
    published = result["published"]["objective"]
    assert filled("{{ fit.internal.published:.3f }}") == f"{published:.3f}"
    assert filled("{{fit.internal.samples}}") == str(result["counts"]["samples"])


def test_a_fit_to_a_table_gives_intervals(bench, filled, run):
    shutil.copytree(ROOT / "datasets/examples", bench.root / "datasets/examples")
    shape = (
        "--contact",
        "internal",
        "--E",
        "207 GPa",
        "--nu",
        0.3,
        "--Ri",
        10,
        "--Rj",
        9.97,
        "--length",
        20,
    )
    code, _, err = run("fit", "datasets/examples/specimens.csv", "--law", "explicit", *shape)
    assert code == 0, err
    folder = bench.root / "datasets/examples/results/specimens"
    estimates = json.loads((folder / "result.json").read_text("utf-8"))["uncertainty"]["estimates"]
    name, estimate = next(iter(estimates.items()))
    low, high = estimate["profile"]["low"], estimate["profile"]["high"]
    text = filled(f"{{{{fit.specimens.{name}.interval:.6g}}}}").replace("$", "")
    printed = re.match(r"(\S+) to ([-\d.]+)", text)
    assert [float(end) for end in printed.groups()] == pytest.approx([low, high], rel=1e-5)
    assert filled("{{fit.specimens.level}}") == r"95\ \%"


def test_claims_are_counted_as_the_ledger_counts_them(filled, bench):
    (bench.root / "reports/claims").mkdir()
    assert filled("{{claims.testable}} {{claims.reproduced:words}}") == "0 zero"


def test_a_changed_result_changes_the_text_and_nothing_else(bench, filled):
    text = "With a = {{fit.internal.a:.3g}} and an error of {{fit.internal.objective:.2g}}."
    before = filled(text)
    file = bench.root / "fitting/results/internal.json"
    result = json.loads(file.read_text("utf-8"))
    result["coefficients"]["a"] *= 1.1
    file.write_text(json.dumps(result), encoding="utf-8")
    after = filled(text)
    changed = [
        pair for pair in zip(before.split(), after.split(), strict=True) if len(set(pair)) > 1
    ]
    ((old, new),) = changed
    assert float(new.split("\\")[0]) == pytest.approx(1.1 * float(old.split("\\")[0]), rel=0.01)


# --- what is written ----------------------------------------------------------------------------


def test_a_manuscript_is_typeset(bench, run):
    code, out, err = run("manuscript", "reports/mine/a.md", "-j", 1)
    assert (code, err) == (0, ""), err
    assert out == ("reports/typeset/a/a.pdf; sources for a journal in reports/typeset/a/latex\n")
    made = bench.root / "reports/typeset/a"
    assert sorted(name for name in tree(made) if (made / name).is_file()) == [
        "a.pdf",
        "latex/a.tex",
        *(f"latex/figures/fig99.{ending}" for ending in ("csv", "pdf")),
        "latex/references.bib",
        "numbers.csv",
        "tables/wear.table.csv",
    ]
    latex = (made / "latex/a.tex").read_text("utf-8")
    for part in (
        r"Deep are 2.50~µm, more than two, and three of A \& B\_c",
        r"\citep[Sect. 4.2]{johnson1985}",
        r"see Fig.~\ref{fig:one},",
        r"Table~\ref{tbl:one}, Eq.~(\ref{eq:one}).",
        "\\begin{equation}\\label{eq:one}\na = 1.5 b\n\\end{equation}",
        r"{figures/fig99.pdf}",
        r"\caption{A line in 1000.0~\(\mathrm{N/mm}\).}\label{fig:one}",
        r"\caption{Two loads.}\label{tbl:one}",
        r"20 & a\_b \\",
        r"50 & *c* \\",
    ):
        assert part in " ".join(latex.split()) or part in latex, part
    numbers = pd.read_csv(made / "numbers.csv", keep_default_na=False)
    assert list(numbers["placeholder"])[:3] == ["wear.depth", "wear.count:words", "wear.who"]
    assert numbers.loc[0].to_dict() == {
        "line": 8, "placeholder": "wear.depth", "value": "2.5", "unit": "µm"
    }  # fmt: skip


def test_the_same_inputs_give_the_same_bytes(bench):
    first = typeset(bench, bench.root / "reports/mine/a.md", bench.root / "one")
    typeset(bench, bench.root / "reports/mine/a.md", bench.root / "two")
    files = {name: text for name, text in tree(first.pdf.parent).items() if text is not None}
    assert files == {n: t for n, t in tree(bench.root / "two").items() if t is not None}


def test_a_referee_is_told_what_is_typed_and_what_nothing_refers_to(bench):
    figure = "![A line.](fig99){#fig:one}\n"
    made, _ = typeset_text(
        bench, f"In 2015 it was 12 %, $x = 3$, [@pereira2015, p. 4], H2.\n\n{figure}"
    )
    typed, unmentioned = made.notes
    assert typed == "typed, and not from a result: 12, H2."
    assert unmentioned == "not referred to in the text: fig:one"


def test_a_phrase_that_is_not_in_the_text_is_noted(bench):
    made, _ = typeset_text(bench, "{{wear.depth}}")
    assert made.notes == ("HOLDS guards a phrase that is not in the text: more than two",)


def test_tables_are_written_as_csv_too(bench):
    made = typeset(bench, bench.root / "reports/mine/a.md", bench.root / "out")
    table = (made.pdf.parent / "tables/wear.table.csv").read_text("utf-8")
    assert table == '"load, N/mm",law\n20,a_b\n50,*c*\n'


def test_a_recipe_with_arguments_and_a_picture_are_figures(bench):
    recipe = RECIPE.replace("def draw(bench)", "def draw(bench, *, load='7')").replace(
        "max(LOADS)}", "float(load)}"
    )
    (bench.root / "reports/fig99.py").write_text(recipe)
    shutil.copy(ROOT / "docs/housing.png", bench.root / "reports/mine/my map.png")
    text = "![A.](<fig99 load=8>)\n\n![B.](<my map.png>)\n\n{{figure.fig99.largest load, N/mm:.0f}}"
    made, latex = typeset_text(bench, text)
    assert [part in latex for part in ("{figures/fig99-8.pdf}", "{figures/my map.png}")]
    assert sorted(path.name for path in (made.sources / "figures").glob("*.p*")) == [
        "fig99-8.pdf", "my map.png"
    ]  # fmt: skip
    assert r"8~\(\mathrm{N/mm}\)" in latex


@pytest.mark.parametrize(
    "text",
    [
        '<img src=x><b>&amp; "quoted"',
        "[a](https://x.y) ![b](x) `c` **d** | e |",
        r"\input{/etc/passwd} & % # _ ^^5c ~ -- \\ $x^2_3$ $",
        "one\ntwo",
        "Prüfstück Ελ ΔR² −3.5",
    ],
)
def test_a_text_of_others_stays_text(text):
    pypandoc = require_package("pypandoc")
    plain = pypandoc.convert_text(markdown(text), "plain", "markdown", extra_args=["--wrap=none"])
    assert "".join(plain.split()) == "".join(text.split())
    table = pypandoc.convert_text(table_text(pd.DataFrame({text: [text]})), "json", "markdown")
    (block,) = json.loads(table)["blocks"]
    assert block["t"] == "Table"


# --- what is refused ----------------------------------------------------------------------------

LINE = "reports/mine/a.md, line 8"
IN_FORMULA = "is a formula or code, where no number can be put"
REFUSED = {
    "no group": ("{{wera.depth}}", rf"{LINE}: '{{{{wera.depth}}}}': names no group of values; "
                 "choose fit, figure, claims, wear, or add it to values.py"),
    "no value": ("{{wear.deep}}", rf"{LINE}: .*: names no value; wear has depth, count, who, t"),
    "no name": ("{{}}", rf"{LINE}: '{{{{}}}}': names no group"),
    "no fit": ("{{fit.none.a}}", r"results/none.json: this fit result does not exist; make it"),
    "no fit's name": ("{{fit}}", rf"{LINE}: .*: names no fit; write {{{{fit.NAME"),
    "a fit elsewhere": ("{{fit./tmp/x.a}}", rf"{LINE}: .*: names no fit"),
    "no figure's name": ("{{figure}}", rf"{LINE}: .*: names no figure"),
    "no recipe": ("{{figure.fig00.caption}}", "fig00"),
    "no figure": ("![a](fig00)", "fig00"),
    "no target": ("![a]()", "is neither a recipe nor a picture"),
    "a target of another kind": ("![a](a.svg)", r"is neither a recipe nor a picture \(.pdf"),
    "a target on the web": ("![a](https://a.b/c)", "is neither a recipe nor a picture"),
    "an argument twice": ("![a](<fig99 a=1 a=2>)", "has an argument twice"),
    "no picture": ("![a](none.PNG)", r"reports/mine/none.PNG: cannot be read"),
    "a word of no integer": ("{{wear.depth:words}}", rf"{LINE}: .*: is no integer"),
    "a format of a text": ("{{wear.who:.2g}}", rf"{LINE}: .*: is no number; leave out :.2g"),
    "touching a digit": ("{{wear.depth}}5", rf"{LINE}: .*: touches other text"),
    "a table in a line": ("See {{wear.table}}", rf"{LINE}: .*: is a table; put it in a paragraph"),
    "in a formula": ("$m = {{wear.depth}}$", IN_FORMULA),
    "in a displayed formula": ("$$m = {{wear.depth}}$$", IN_FORMULA),
    "in code": ("`{{wear.depth}}`", IN_FORMULA),
    "in a link": ("[x](http://a.b/{{wear.depth}})", "is an address"),
    "in a target": ("![x]({{wear.who}})", "is an address"),
    "TeX": (r"\footnote{gone}", "'.*gone.*': is TeX or HTML, which the PDF would leave out"),
    "the word that stands for numbers": ("A VALUE.", "'VALUE': stands for numbers while"),
    "a formula that is none": (r"$\nosuch{x}$", "is not what pandoc can set .*nosuch"),
    "half a formula": (r"$\frac{1}{2$", "is not what pandoc can set"),
    "no label": ("See @fig:two.", r"'@fig:two': is no label, and references.bib has no such entry; "
                 "label it, as in"),
    "a label of no kind": ("# A {#two}\n\nSee @two.", "'@two': is no label"),
    "no entry": ("See [@nobody].", "'@nobody': is no label, and references.bib"),
    "an entry and a label": ("[@johnson1985; @sec:a]\n\n# A {#sec:a}", "'@sec:a': stands in brack"),
    "a label and a page": ("[see @sec:a, p. 3]\n\n# A {#sec:a}", "'@sec:a': stands in brackets"),
    "a label twice": ("$$a$$ {#eq:a}\n\n$$b$$ {#eq:a}", "'{#eq:a}': labels 2 things"),
    "a label of no equation": ("Hello {#eq:a}", "'{#eq:a}': stands behind no displayed equation"),
    "a label alone": ("{#eq:a}", "'{#eq:a}': stands behind no displayed equation"),
    "a label of a small formula": ("$a$ {#eq:a}", "'{#eq:a}': stands behind no displayed"),
    "a label and a full stop": ("$$a$$ {#eq:a}.", "'{#eq:a}.': stands behind no displayed"),
    "deep nesting": (">" * 1500 + " x", "is nested too deeply"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "message"), REFUSED.values(), ids=REFUSED)
def test_what_cannot_be_typeset_is_told_in_one_line(bench, run, text, message):
    (bench.root / "reports/mine/a.md").write_text(f"{HEAD}{text}\n")
    refused(bench, run, message)


def refused(bench, run, message, status=2):
    """Typeset the manuscript and see it refused, with nothing left."""
    before = tree(bench.root)
    code, out, err = run("manuscript", "reports/mine/a.md", "-j", 1)
    assert (code, out, len(err.splitlines())) == (status, "", 1), err
    assert re.search(message, err), err
    assert tree(bench.root) == before


DEPTH, RETURN, HOLDS = "DEPTH = 2.5", "return {", 'HOLDS = {"more than two": deep}'
BROKEN = {
    "a phrase that is not true": (
        "values.py", DEPTH, "DEPTH = 1.5", "a.md: 'more than two': is not what the results say"),
    "a function that fails": (
        "values.py", "def wear(bench):", "def wear(bench):\n    1 / 0", "wear: failed with Zero"),
    "a function that ends the program": (
        "values.py", "def wear(bench):", "def wear(bench):\n    raise SystemExit", "wear: failed"),
    "an import that fails": ("values.py", "import pandas", "import pandsa", "values.py.*pandsa"),
    "an import that ends it": (
        "values.py", "import pandas as pd", "import pandas as pd\nraise SystemExit", "SystemExit"),
    "no dict": ("values.py", RETURN, "return 3, {", "wear = .*: returns no dict of quantities"),
    "a name that is no text": ("values.py", '"who":', "7:", "wear.7 = .*: is neither a quantity"),
    "a value of another kind": (
        "values.py", '"A & B_c"', "[1]", r"wear.who = \[1\]: is neither a quantity nor a text"),
    "no number": ("values.py", "(DEPTH", "(float('nan')", "wear: value = nan: is neither a"),
    "a range of three": ("values.py", "(DEPTH", "((1.0, 2.0, 3.0)", "wear: value = .*: is ne"),
    "no digits": ("values.py", '"µm")', '"µm", 0)', "wear: digits = 0: must be from 1 to 17"),
    "a reserved name": (
        "values.py", "def deep", "def fit(bench):\n    return {}\n\n\ndef deep",
        "fit: is a group already; rename the function"),
    "no dict of phrases": ("values.py", HOLDS, "HOLDS = [deep]", "HOLDS: is no dict of phrases"),
    "a phrase that is no text": ("values.py", HOLDS, "HOLDS = {3: deep}", "HOLDS: is no dict of"),
    "a phrase without a function": (
        "values.py", HOLDS, 'HOLDS = {"more than two": True}', "HOLDS: is no dict of phrases"),
    "an answer that is none": (
        "values.py", "return DEPTH > 2", "return 7", "more than two = 7: is not answered"),
    "an empty table": (
        "values.py", '["20", "50"], "law": ["a_b", "*c*"]', '[], "law": []', "is a table without"),
    "no title": ("a.md", "title: A test\n", "", "title: is missing; name it at the top"),
    "no bibliography": ("a.md", "bibliography: references.bib\n", "", "bibliography: must name"),
    "another bibliography": ("a.md", "references.bib", "my refs.bib", "my refs.bib: cannot be"),
    "two bibliographies": ("a.md", "references.bib", "[a.bib, b.bib]", "bibliography: must name"),
    "one elsewhere": ("a.md", "references.bib", "../references.bib", "bibliography = .*must name"),
    "a head that is none": ("a.md", "title: A test", "title: [", "is not what pandoc can set"),
    "a comment in BibTeX": (
        "references.bib", "@book{johnson1985", "@comment{johnson1985", "'@johnson1985': is no lab"),
    "a template in Typst": ("article.typ", "#set page(", "#set pgae(", "cannot be set by Typst"),
    "a template in LaTeX": ("article.tex", "$title$", "$title", "is not what pandoc can set"),
}  # fmt: skip


@pytest.mark.parametrize(("name", "old", "new", "message"), BROKEN.values(), ids=BROKEN)
def test_a_broken_part_is_told_in_one_line(bench, run, name, old, new, message):
    file = bench.root / "reports/mine" / name
    text = file.read_text("utf-8")
    assert old in text
    file.write_text(text.replace(old, new, 1), encoding="utf-8")
    refused(bench, run, message)


@pytest.mark.parametrize("name", SHARED)
def test_a_missing_part_is_told_in_one_line(bench, run, name):
    (bench.root / "reports/mine" / name).unlink()
    refused(bench, run, f"{name}: cannot be read")


@pytest.mark.parametrize("name", ["pypandoc", "typst"])
def test_without_its_packages_the_command_names_the_extra(bench, run, monkeypatch, name):
    monkeypatch.setitem(sys.modules, name, None)
    refused(
        bench, run, rf"manuscript: needs {name}; pip install 'cylcontact\[paper\]', or make extras"
    )


def test_without_pandoc_itself_the_command_says_so(bench, run, monkeypatch):
    def absent(*_, **__):
        raise OSError

    monkeypatch.setattr(require_package("pypandoc"), "convert_text", absent)
    refused(bench, run, "manuscript: needs pandoc; pip install")


def test_values_of_a_folder_outside_of_the_bench_are_refused(bench, tmp_path):
    shutil.move(tmp_path / "reports/mine", tmp_path / "elsewhere")
    with pytest.raises(InputError, match=r"is not in .*reports, so its values.py cannot import"):
        own_values(bench, tmp_path / "elsewhere/a.md")


def test_the_folder_of_the_manuscript_is_refused(bench, run):
    before = tree(bench.root)
    for out in ("reports/mine", "reports/../reports/mine"):
        code, _, err = run("manuscript", "reports/mine/a.md", "-o", out)
        assert code == 2
        assert "is the manuscript's own folder; choose another" in err
    assert tree(bench.root) == before


def test_a_folder_with_a_dot_is_refused(bench, run):
    (bench.root / "reports/mine").rename(bench.root / "reports/v1.2")
    code, _, err = run("manuscript", "reports/v1.2/a.md")
    assert code == 2
    assert "has a dot in its name, so Python cannot import values.py from it" in err


def test_two_figures_of_one_name_are_refused(bench, run):
    for name in ("a", "b"):
        (bench.root / "reports/mine" / name).mkdir()
        shutil.copy(ROOT / "docs/housing.png", bench.root / "reports/mine" / name / "x.png")
    (bench.root / "reports/mine/a.md").write_text(f"{HEAD}![A](a/x.png)\n\n![B](b/x.png)\n")
    refused(bench, run, "'a/x.png': would be figures/x.png, and so would another figure; rename")


def test_two_results_of_one_name_are_refused(bench, run):
    folder = bench.root / "datasets/results/internal"
    folder.mkdir(parents=True)
    shutil.copy(bench.root / "fitting/results/internal.json", folder / "result.json")
    (bench.root / "reports/mine/a.md").write_text(HEAD + "{{fit.internal.a}}\n")
    refused(bench, run, "is .*internal.json and .*result.json; rename one of them")


# --- our own manuscript -------------------------------------------------------------------------


def test_the_template_is_typeset_where_init_lays_it_out(tmp_path, monkeypatch, run):
    assert run("init", tmp_path)[0] == 0
    monkeypatch.chdir(tmp_path)
    code, out, err = run("manuscript", "reports/manuscript/template.md")
    assert (code, out[:39]) == (0, "reports/typeset/template/template.pdf; "), err
    assert not re.search("typed|not referred to", err)
    text = (FOLDER / "template.md").read_text("utf-8")
    assert len(PLACEHOLDER.findall(text)) >= 3


@pytest.fixture(scope="session")
def ours(tmp_path_factory):
    """Our manuscript, typeset."""
    return typeset(BENCH, OURS, tmp_path_factory.mktemp("ours"))


def test_no_digit_is_typed_in_our_manuscript():
    text = OURS.read_text("utf-8")
    assert typed_numbers(text, OURS) == []
    assert len(PLACEHOLDER.findall(text)) > 100


@pytest.mark.slow
def test_every_figure_table_and_reference_is_mentioned(ours):
    assert ours.notes == ()


def test_every_phrase_that_results_must_support_is_in_the_text():
    words = " ".join(OURS.read_text("utf-8").split())
    holds = own_values(BENCH, OURS).HOLDS
    assert [phrase for phrase in holds if " ".join(phrase.split()) not in words] == []


def test_references_are_cited_and_have_the_dois_of_the_documentation():
    library = (FOLDER / "references.bib").read_text("utf-8")
    page = (ROOT / "docs/reference/literature.md").read_text("utf-8")
    text = OURS.read_text("utf-8")
    keys = re.findall(r"^@\w+\{(\w+),", library, re.MULTILINE)
    assert [key for key in keys if f"@{key}" not in text] == []
    listed = set(re.findall(r"<https://doi\.org/(10\.[^>]+)>", page))
    shared = [doi for doi in re.findall(r"doi\s*=\s*\{(.+?)\}", library) if doi in listed]
    assert len(shared) >= 8


@pytest.mark.slow
def test_it_has_six_to_ten_pages(ours):
    pages = len(re.findall(rb"/Type\s*/Page\b", ours.pdf.read_bytes()))
    assert 6 <= pages <= 10


@pytest.mark.parametrize("which", ["ours", "template"])
def test_a_class_of_a_journal_sets_it(which, ours, tmp_path):
    require_program("elsarticle.cls")
    if which == "template":
        made = typeset(BENCH, FOLDER / "template.md", tmp_path / "template")
        folder, name = made.sources, "template"
    else:
        folder, name = shutil.copytree(ours.sources, tmp_path / "latex"), OURS.stem
    latex = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", name]
    for command in (latex, ["bibtex", name], latex, latex):
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, check=False, errors="replace"
        )
        assert done.returncode == 0, done.stdout[-2000:]
    log = (folder / f"{name}.log").read_text("utf-8", errors="replace")
    assert "undefined" not in log
    assert "Missing character" not in log
    # A line that sticks out by more than 2 mm.
    wide = [float(width) for width in re.findall(r"Overfull \\hbox \(([\d.]+)pt too wide", log)]
    assert max(wide, default=0.0) < 6.0


def scaled(column, factor):
    """A change of a table: one of its columns times a factor."""

    def change(text):
        table = pd.read_csv(io.StringIO(text))
        table[column] *= factor
        return table.to_csv(index=False)

    return change


def coefficient(name, factor):
    """A change of a result: one of its coefficients times a factor."""

    def change(text):
        result = json.loads(text)
        result["coefficients"][name] *= factor
        return json.dumps(result)

    return change


def objective(factor):
    """A change of a result: its objective times a factor."""

    def change(text):
        result = json.loads(text)
        result["objective"]["value"] *= factor
        return json.dumps(result)

    return change


# Tables of finite elements are not among them: a changed one is refused.
CHANGES = {
    "fitting/results/recovered-internal.json": ("made.off", coefficient("a", 1.05)),
    "fitting/results/recovered-external.json": ("made.coefficients", coefficient("b", 1.05)),
    "datasets/readings.csv": ("readings.a_refined", scaled("difference_percent", 1.5)),
    "fitting/results/internal.json": ("made.internal_ratio", objective(1.1)),
    "datasets/mechanism/cases.csv": ("crank.together", scaled("horizon_revolutions", 0.99)),
}
SLOW = {"datasets/mechanism/cases.csv"}  # with the claims


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow) if n in SLOW else n for n in CHANGES]
)
def test_a_changed_result_changes_a_sentence_of_our_manuscript(name, tmp_path):
    placeholder, change = CHANGES[name]
    paragraphs = OURS.read_text("utf-8").split("\n\n")
    # With its group alone, because the others would take long.
    group = placeholder.partition(".")[0]
    sentences = [part for text in paragraphs for part in re.split(r"(?<=\.)\s", text)]
    (sentence, *_) = [part for part in sentences if f"{{{{{placeholder}" in part]
    sentence = re.sub(rf"\{{\{{(?!{group}\.)[^}}]*\}}\}}", "", sentence)
    for folder in ("datasets", "fitting", "reports"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=CACHES)
    source = tmp_path / "reports/manuscript" / OURS.name
    text = f"\n\n{sentence}\n\n"
    before = fill(text, Values(Bench(tmp_path), source)).text
    file = tmp_path / name
    file.write_text(change(file.read_text("utf-8")), encoding="utf-8")
    after = fill(text, Values(Bench(tmp_path), source)).text
    assert before != after
    assert len(before.split()) == len(after.split())
