"""Manuscripts: numbers come from results, references lead somewhere, and LaTeX sets them."""

import json
import re
import shutil
import subprocess
import sys
import tomllib
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cylcontact import CylinderPair, laws
from cylcontact.reports.bench import Bench
from cylcontact.reports.manuscript import fill, number, typeset
from tests.reports.test_bench import RECIPE
from tests.support.drawn_figures import BENCH
from tests.support.manuscript_files import FOLDER, HEAD, write_manuscript
from tests.support.programs import require_program
from tests.support.spec_files import tree

ROOT = BENCH.root
OURS = ("pin_in_hole", "supplement")


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """A small bench with a manuscript, the current folder."""
    write_manuscript(tmp_path / "reports/mine")
    (tmp_path / "reports/paper.py").write_text("LOADS = (10.0, 1000.0)\n")
    (tmp_path / "reports/fig99.py").write_text(RECIPE)
    (tmp_path / "fitting/results").mkdir(parents=True)
    shutil.copy(ROOT / "fitting/results/internal.json", tmp_path / "fitting/results")
    monkeypatch.chdir(tmp_path)
    return Bench(tmp_path)


# --- numbers ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "unit", "digits", "text"),
    [
        (0.95, "", 3, "0.950"),
        (5.0, "", 1, "5"),
        (np.int64(3), "", 3, "3"),
        (12345.6, "", 3, "12300"),
        (1234567.0, "", 3, r"$1.23 \times 10^{6}$"),
        (1e-8, "", 1, "$10^{-8}$"),
        (9.996e-5, "", 3, "0.000100"),
        (-1.5, "%", 2, r"$-1.5$\ %"),
        ((-1.0, 2.5), "mm", 2, r"$-1.0$ to 2.5\ mm"),
        (30.0, "°", 2, "30°"),
    ],
)
def test_numbers_are_printed_as_journals_want_them(value, unit, digits, text):
    assert number(value, unit, digits) == text


@given(st.floats(-1e12, 1e12, allow_nan=False), st.integers(1, 7))
def test_a_printed_number_is_the_number_to_its_digits(value, digits):
    text = number(value, digits=digits).strip("$")
    mantissa, _, power = re.sub(r"( \\times )?10\^\{", "e", text).rstrip("}").partition("e")
    printed = float(mantissa or 1) * 10.0 ** int(power or 0)
    assert printed == pytest.approx(value, rel=0.500001 * 10 ** (1 - digits), abs=1e-300)


def test_a_changed_result_changes_the_text(bench):
    source = bench.root / "reports/mine/a.md"
    text = 'a = {{ fit("internal").coefficients.a | number(digits=6) }}'
    file = bench.root / "fitting/results/internal.json"
    result = json.loads(file.read_text("utf-8"))
    assert fill(text, bench, source) == f"a = {result['coefficients']['a']:.6g}"
    result["coefficients"]["a"] = 0.5
    file.write_text(json.dumps(result), encoding="utf-8")
    assert fill(text, Bench(bench.root), source) == "a = 0.500000"
    shutil.move(file, bench.root / "datasets.json")
    by_file = text.replace('"internal"', '"datasets.json"')
    assert fill(by_file, bench, source) == "a = 0.500000"


# --- what is written ----------------------------------------------------------------------------


def test_a_manuscript_is_typeset(bench, run):
    code, out, err = run("paper", "reports/mine/a.md", "-j", 1)
    assert (code, err) == (0, ""), err
    assert out == "reports/typeset/a/a.pdf; sources for a journal in reports/typeset/a/latex\n"
    made = bench.root / "reports/typeset/a"
    assert sorted(name for name in tree(made) if (made / name).is_file()) == [
        "a.pdf",
        "latex/a.tex",
        *(f"latex/figures/fig99.{ending}" for ending in ("csv", "pdf", "txt")),
        "latex/references.bib",
    ]
    latex = " ".join((made / "latex/a.tex").read_text("utf-8").split())
    for part in (
        r"Deep are 2.50~µm, more than two, and three of A \& B\_c",
        r"\citep[Sect. 4.2]{johnson1985}",
        r"see Fig.~\ref{fig:one},",
        r"Table~\ref{tbl:one}, Eq.~(\ref{eq:one}).",
        r"\begin{equation}\label{eq:one} a = 1.5 b \end{equation}",
        r"{figures/fig99.pdf}",
        r"\caption{A line in 1000~N/mm.}\label{fig:one}",
        r"\caption{Two loads.}\label{tbl:one}",
        r"20 & a\_b \\",
        r"50 & *c* \\",
    ):
        assert part in latex, part


def test_a_recipe_with_arguments_and_a_picture_are_figures(bench):
    recipe = RECIPE.replace("def draw(bench)", "def draw(bench, *, load='7')")
    (bench.root / "reports/fig99.py").write_text(recipe)
    source = bench.root / "reports/mine/a.md"
    shutil.copy(ROOT / "docs/housing.png", source.with_name("my map.png"))
    source.write_text(f"{HEAD}![A.](<fig99 load=8>){{#fig:a}}\n\n![B.](<my map.png>){{#fig:b}}\n")
    latex = (typeset(bench, source, bench.root / "out").parent / "latex/a.tex").read_text("utf-8")
    assert "{figures/fig99-8.pdf}" in latex
    assert "{figures/my map.png}" in latex


# --- what is refused ----------------------------------------------------------------------------

LINE = "a.md, line 8"
REFUSED = {
    "no value": ("a.md", "{{wear.depth}}", "{{wear.deep}}", f"{LINE}: .*'deep'"),
    "no fit": ("a.md", "{{wear.depth}}", '{{ fit("none").bound }}', "none.json: this fit result"),
    "a filter": ("a.md", "| words", "| wrods", "a.md, line 9: .*wrods"),
    "no label": ("a.md", "@fig:one", "@fig:two", "cannot be set by Typst .*fig:two"),
    "no bibliography": ("a.md", "bibliography: references.bib\n", "", "bibliography: is missing"),
    "a head": ("a.md", "title: A test", "title: [", "is not what pandoc can set"),
    "an assertion": ("values.py", "DEPTH = 2.5", "DEPTH = 1.5", r"not .* any more \(more than two"),
    "an import": ("values.py", "import pandas", "import pandsa", "values.py.*pandsa"),
    "a template": ("article.typ", "#set page(", "#set pgae(", "cannot be set by Typst"),
    "the other": ("article.tex", "$title$", "$title", "is not what pandoc can set"),
}


@pytest.mark.parametrize(("name", "old", "new", "message"), REFUSED.values(), ids=REFUSED)
def test_what_cannot_be_typeset_is_told_in_one_line(bench, run, name, old, new, message):
    file = bench.root / "reports/mine" / name
    text = file.read_text("utf-8")
    assert old in text
    file.write_text(text.replace(old, new, 1), encoding="utf-8")
    refused(bench, run, message)


def refused(bench, run, message):
    """Typeset the manuscript and see it refused, with nothing left."""
    before = tree(bench.root)
    code, out, err = run("paper", "reports/mine/a.md", "-j", 1)
    assert (code, out, len(err.splitlines())) == (2, "", 1), err
    assert re.search(message, err), err
    assert tree(bench.root) == before


@pytest.mark.parametrize(("module", "name"), [("pypandoc", "pandoc"), ("typst", "typst")])
def test_without_its_packages_the_command_names_the_extra(bench, run, monkeypatch, module, name):
    monkeypatch.setitem(sys.modules, module, None)
    refused(bench, run, rf"paper: needs {name}; pip install 'cylcontact\[paper\]'")


@pytest.mark.usefixtures("bench")
def test_values_outside_of_the_bench_are_refused(tmp_path, run):
    shutil.move(tmp_path / "reports/mine", tmp_path / "elsewhere")
    code, _, err = run("paper", "elsewhere/a.md", "-j", 1)
    assert code == 2
    assert "is not in reports, so it cannot import from there; move the manuscript" in err


# --- our own manuscripts ------------------------------------------------------------------------


def test_the_template_is_typeset_where_init_lays_it_out(tmp_path, monkeypatch, run):
    assert run("init", tmp_path)[0] == 0
    monkeypatch.chdir(tmp_path)
    code, out, err = run("paper", "reports/manuscript/template.md")
    assert (code, out[:39]) == (0, "reports/typeset/template/template.pdf; "), err


@cache
def text_of(name):
    return (FOLDER / f"{name}.md").read_text("utf-8")


@pytest.mark.parametrize("name", OURS)
def test_every_figure_table_and_equation_is_referred_to(name):
    text = text_of(name)
    labels = re.findall(r"\{#((?:fig|tbl|eq):\S+?)\}", text)
    not_mentioned = [one for one in labels if not re.search(rf"@{one}\b", text)]
    # Equations that the text continues from.
    assert [one for one in not_mentioned if not one.startswith("eq:")] == []


def test_every_reference_is_cited():
    keys = re.findall(
        r"^@\w+\{(\w+),", (FOLDER / "references.bib").read_text("utf-8"), re.MULTILINE
    )
    both = "".join(map(text_of, OURS)) + (FOLDER / "template.md").read_text("utf-8")
    assert [key for key in keys if f"@{key}" not in both] == []


@pytest.fixture(scope="session")
def pairs():
    """The values of the section on explicit laws."""
    return BENCH.module("manuscript.values").pairs(BENCH)


def cells(table):
    """Return the numbers of a printed table, a dash as nothing."""
    return table.map(lambda cell: float(cell.replace("−", "-").replace("–", "0"))).to_numpy()


PAIRS = [(0.0, 0.0), (0.5, 0.1), (-0.5, -0.1), (0.2, -0.15)]


@pytest.mark.parametrize(("alpha", "beta"), PAIRS)
def test_the_printed_constants_and_equations_are_the_laws(pairs, alpha, beta):
    a0, a1, a2, a3, h3, m0, m1, m2 = cells(pairs["eight"])[0]
    pair = CylinderPair.from_dundurs(alpha, beta)
    w_i, w_j = (1 - alpha) / 2, (1 + alpha) / 2

    def arc(S):
        u, H = np.sqrt(S), 2 * S - (1 - S) ** 2 / S * np.log(1 - S)
        K = (1 - S) ** 2 / S + beta / u * (a0 + a1 * u + a2 * u**2 + a3 * u**3)
        K = K - w_i * (H + h3 * beta * u**3)
        L = -np.log(S) + S**2 / 2 + w_i * H - w_j * h3 * beta * u**3
        return K, L + beta * u * (m0 + m1 * u + m2 * u**2) + 2 * np.log(2) - 2 + w_j

    S = np.array([1e-4, 1e-2, 0.1, 0.3])
    K, L = arc(S)
    phi, d = np.pi / K, L / K
    scale = float(pair.E_star * pair.dR)
    loads = laws.Parametric().load(d * float(pair.dR), pair) / scale
    assert loads == pytest.approx(phi, rel=2e-4)
    # The one line, from the arc that no load exceeds.
    fine = np.linspace(0.2, 0.9, 70001)
    last = fine[np.argmax(arc(fine)[0] <= 0)]
    c = arc(last)[1]
    g = c - 1.4
    powers = np.array([1, g, beta, g**2, g * beta, beta**2])
    ln_A, ln_B, D, G = cells(pairs["eighteen"].iloc[:, 1:]) @ powers
    inner = np.log(1 + np.exp(ln_A) / d + G / np.sqrt(d)) + D
    one_line = np.pi * d / (c + np.log1p(np.exp(ln_B) / d * inner))
    loads = laws.ExplicitPair().load(d * float(pair.dR), pair) / scale
    assert one_line == pytest.approx(loads, rel=5e-4)
    assert one_line == pytest.approx(phi, rel=0.012)


@pytest.fixture(scope="session")
def ours(tmp_path_factory):
    """Our manuscripts, typeset."""
    folder = tmp_path_factory.mktemp("ours")
    return {name: typeset(BENCH, FOLDER / f"{name}.md", folder / name) for name in OURS}


@pytest.mark.slow
def test_they_have_at_most_ten_and_six_pages(ours):
    pages = [len(re.findall(rb"/Type\s*/Page\b", ours[name].read_bytes())) for name in OURS]
    assert 6 <= pages[0] <= 10
    assert 3 <= pages[1] <= 6


@pytest.mark.slow
@pytest.mark.parametrize("name", OURS)
def test_a_class_of_a_journal_sets_it(ours, name, tmp_path):
    require_program("elsarticle.cls")
    folder = shutil.copytree(ours[name].parent / "latex", tmp_path / "latex")
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


def test_the_paper_on_the_program_has_its_numbers():
    text = " ".join((ROOT / "paper/paper.md").read_text("utf-8").split())
    values = BENCH.module("manuscript.values")
    housing, law = values.housing(BENCH), values.explicit_law(BENCH)
    joint = [housing[name].replace("\\", "") for name in ("rim_thin", "far_60_thin")]
    micrometres = [f"{float(one.split()[0]):.0f} µm" for one in joint]
    of_load = law["internal_load"].replace("\\", "")
    assert f"by {micrometres[0]} in a thin bush" in text
    assert f"by {micrometres[1]} in a thin eye" in text
    assert f"within {of_load} of the load" in text
    assert len(laws.LAW_TYPES) == 21
    assert "has twenty-one laws" in text


def test_metadata_agree_with_the_project():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    meta = json.loads((ROOT / "codemeta.json").read_text("utf-8"))
    needs = [re.match(r"[\w-]+", one)[0] for one in project["dependencies"]]
    assert meta["softwareRequirements"] == needs
    cff = (ROOT / "CITATION.cff").read_text("utf-8")
    for own in (meta["version"], meta["name"]):
        assert own in (project["version"], project["name"])
        assert f": {own}\n" in cff
    licences = project["license"].split(" AND ")
    assert [one.rsplit("/", 1)[1] for one in meta["license"]] == licences
    assert f": {licences[0]}\n" in cff
