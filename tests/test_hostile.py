"""Content from others is text: in a terminal, pages, figures, LaTeX, CSV, source and file names."""

import io
import json
import re
import subprocess
import warnings
import xml.etree.ElementTree as ET
from dataclasses import replace

import pandas as pd
import pytest
from matplotlib.figure import Figure

import cylcontact as cc
from cylcontact import InputError, Material, laws
from cylcontact.cli import terminal
from cylcontact.export import export, fmu
from cylcontact.export.joint import Element
from cylcontact.fitting import FitResult
from cylcontact.mechanism import read_joint
from cylcontact.plain_text import (
    as_label,
    csv_text,
    file_name,
    from_csv,
    identifier,
    latex,
)
from cylcontact.plots.figure import Drawing, new_figure
from cylcontact.plots.style import JOURNAL, figure_style
from cylcontact.reports.build import save_picture, write
from cylcontact.reports.fit_folder import write_fit
from cylcontact.reports.html.site import _renderer
from cylcontact.reports.paper import Paper
from cylcontact.tables import read_table, texts
from cylcontact.text_tables import frame_table, joined, text_table
from tests.counts import counted
from tests.hostile import HOSTILE, SURROGATE, TAME, elements
from tests.html_bench import ROOT
from tests.programs import require_program

pytestmark = pytest.mark.slow


LOADS = [10.0, 20, 40, 80, 160] * 2
READINGS = [0.2, 0.37, 0.7, 1.3, 2.5, 0.21, 0.38, 0.71, 1.31, 2.48]
# Beyond this a text has been put out whole.
LONG = 60_000


def seen(text):
    """Whether a terminal shows every character, and each where it stands."""
    return all(c.isprintable() or c in "\n\u2009\u00a0" for c in text)


@pytest.fixture(scope="module")
def fitted():
    """A function that returns a fit to measurements with a text as its name and a group's."""
    rows = {"load_N_per_mm": LOADS, "penetration_um": READINGS, "specimen": ["a"] * 5 + ["b"] * 5}
    constants = {"nu": 0.3, "dR_um": 30, "E_GPa": 207}
    result = cc.fit(
        pd.DataFrame(rows), "johnson", contact="internal", constants=constants, starts=2,
        group="specimen", name="a",
    )  # fmt: skip
    whole = result.model_dump()

    def named(text):
        data = json.loads(json.dumps(whole))
        groups = data["settings"]["measurements"]["labels"]["group"]
        groups[:5] = [text] * 5
        return FitResult.model_validate(data | {"name": text})

    return named


# --- the places, each a function of a text (and of the fit) that checks what is put out --


def in_a_terminal(text, fitted, _tmp_path):
    shown = str(fitted(text))
    assert seen(shown)
    assert len(shown) < LONG
    assert len(shown.split("\n")) - len(str(fitted(TAME)).split("\n")) in (0, 1, 2)  # wrapped


def in_a_table_of_a_terminal(text, _fitted, _tmp_path):
    frame = pd.DataFrame({"a": [text, "b"], text: [1.0, 2.0]}, index=[text, "c"])
    for table in (text_table(["", text], [(text, "1"), ("b", "2")]), frame_table(frame)):
        assert seen(table)
        assert len(table.split("\n")) == 3
        assert all(seen(cell) and len(cell) <= 100 for row in table.rows for cell in row)


def in_a_message(text, _fitted, _tmp_path):
    message = str(InputError(text, text, text, f"is {text}", f"not {text}"))
    assert seen(message)
    assert "\n" not in message
    assert len(message) < 4000


def in_a_notebook(text, fitted, _tmp_path):
    for show in (
        lambda name: fitted(name)._repr_html_(),
        lambda name: Material(name, E=207e3, nu=0.3)._repr_html_(),
        html_of_drawing,
    ):
        page = show(text)
        assert elements(page) == elements(show(TAME))
        assert seen(re.sub("[\t\n]", "", page))
        assert len(page) < 10 * LONG


def html_of_drawing(text):
    table = pd.DataFrame({"a": [1.0]})
    return Drawing(new_figure("column", 30), table, {}, f"About {text}", f"By {text}")._repr_html_()


def in_a_folder_of_a_fit(text, fitted, tmp_path):
    with warnings.catch_warnings():
        warnings.filterwarnings("error")
        warnings.filterwarnings("ignore", message="Glyph .* missing")  # of letters
        write_fit(fitted(text), tmp_path)
    assert FitResult.read(tmp_path / "result.json").name == text
    group = cells_of(tmp_path / "residuals.csv")["group"][0]
    assert not re.match(r"[=+\-@\t\r]", group)
    if "\0" not in text:  # pandas ends a cell there
        assert from_csv(group) == text


def cells_of(path):
    """The cells of a CSV file as texts."""
    return pd.read_csv(path, dtype=str, keep_default_na=False, lineterminator="\n")


def in_a_figure(text, _fitted, tmp_path):
    with figure_style():
        figure = Figure(figsize=(8, 4), layout="constrained")
        axes = figure.subplots()
        axes.plot([1, 2], label=as_label(text))
        axes.set(title=f"$E$ of {as_label(text)}", xlabel=as_label(text))
        assert len(axes.legend().get_texts()) == 1
        stream = io.StringIO()
        figure.savefig(stream, format="svg", metadata={"Date": None})
        figure.savefig(tmp_path / "a.png", format="png")
    assert len(stream.getvalue()) < 10 * LONG
    assert b"script" not in ET.tostring(ET.fromstring(stream.getvalue())).split(b"<metadata")[0]


def in_a_recipes_files(text, _fitted, tmp_path):
    table = pd.DataFrame({"group": [text, "b"], "mm": [-0.3, 2.0]})
    drawing = Drawing(new_figure("column", 30), table, {}, f"About {text}.", f"By {text}.")
    write(drawing, "fig1", tmp_path)
    back = cells_of(tmp_path / "fig1.csv")
    assert back["mm"][0] == "-0.3"
    assert not re.match(r"[=+\-@\t\r]", back["group"][0])
    assert seen((tmp_path / "fig1.txt").read_text("utf-8").replace("\t", ""))


def in_latex(text, _fitted, _tmp_path):
    escaped = latex(text)
    known = r"\\(textbackslash|textascii\w+|dots)\{\}|\\ensuremath\{\S+?\}+|\\[&%$#_{},]"
    rest = re.sub(known, "", re.sub(r"^\{([*[])\}", r"\1", escaped)).replace("{}", "")
    assert not set(rest) & set("\\&%$#_^~{}\n")
    assert not escaped.startswith(("[", "*"))


def in_csv(text, _fitted, tmp_path):
    frame = pd.DataFrame({"load_N": ["1.5", "-0.3"], "group": [text, "-40"]})
    path = tmp_path / "table.csv"
    path.write_text(csv_text(frame), encoding="utf-8")
    written = cells_of(path)
    assert not re.match(r"[=+\-@\t\r]", written["group"][0])
    assert list(written.iloc[1]) == ["-0.3", "-40"]
    if "\0" not in text and text.strip() == text and "\r" not in text and len(text) < 100_000:
        assert texts(read_table(path), 1)[0] == text


def in_source_of_a_law(text, _fitted, _tmp_path):
    for target in ("c", "fortran", "matlab"):
        source, tame = (export(laws.Enhanced(), "internal", target, x) for x in (text, TAME))
        assert source.isascii()
        assert code_of(source) == code_of(tame)
        assert max(map(len, source.splitlines())) <= 132
    exported = json.loads(export(laws.Enhanced(), "internal", "json", text))
    assert exported["provenance"]["coefficients"] == text


def in_source_of_a_joint(text, _fitted, _tmp_path):
    lines = Element(joint_of(text)).comment("use", "//").split("\n")
    assert all(line.startswith("//") and line.isascii() and line.isprintable() for line in lines)
    description, tame = (fmu.model_of(joint_of(x)).description("{0}") for x in (text, TAME))
    shape = [
        [(e.tag, tuple(e.attrib)) for e in ET.fromstring(x).iter()] for x in (description, tame)
    ]
    assert shape[0] == shape[1]


def joint_of(text):
    """A joint whose materials, law's origin and name (which begins with a letter) hold a text."""
    joint = read_joint(ROOT / "datasets/joint.toml")
    bodies = (replace(body, name=text) for body in (joint.pair.material_i, joint.pair.material_j))
    i, j = bodies
    pair = replace(joint.pair, material_i=i, material_j=j)
    return replace(joint, name=f"a{text}", origin=text, pair=pair, law=laws.Johnson())


def code_of(source):
    """The lines of a source that are no comment."""
    lines = (line.strip() for line in source.splitlines())
    return [line for line in lines if not line.startswith(("//", "!", "%", "#")) or "#in" in line]


def in_a_name_of_a_file(text, _fitted, _tmp_path):
    name = file_name(text)
    assert not set(name) & set('/\\<>:"|?*\0\n ')
    word = identifier(text)
    assert not word or re.fullmatch("[A-Za-z0-9_]+", word)


PLACES = (
    in_a_terminal, in_a_table_of_a_terminal, in_a_message, in_a_notebook, in_a_folder_of_a_fit,
    in_a_figure, in_a_recipes_files, in_latex, in_csv, in_source_of_a_law, in_source_of_a_joint,
    in_a_name_of_a_file,
)  # fmt: skip


@pytest.mark.filterwarnings("ignore:Glyph .* missing")
@pytest.mark.parametrize("text", HOSTILE.values(), ids=HOSTILE)
@pytest.mark.parametrize("place", PLACES, ids=lambda place: place.__name__)
def test_text_of_others_comes_out_as_text(place, text, fitted, tmp_path):
    place(text, fitted, tmp_path)


def test_every_text_is_tried_in_every_place():
    name = "hostile texts, each in every place where text is put out"
    counted(name, len(HOSTILE) * len(PLACES))


def test_a_terminal_gets_no_command_from_a_report_or_a_line(capsys, monkeypatch):
    for is_terminal in (True, False):
        monkeypatch.setattr("sys.stdout.isatty", lambda is_terminal=is_terminal: is_terminal)
        for text in HOSTILE.values():
            terminal.show(joined([text[:500], text_table(["", text], [(text, "1")])]))
            terminal.say(text[:500])
            said = re.sub(r"\x1b\[[013m;]+", "", capsys.readouterr().out)
            assert seen(said)


def test_a_name_that_is_half_a_character_is_refused_in_a_line(fitted, tmp_path):
    result = fitted(TAME).model_copy(update={"name": SURROGATE})
    with pytest.raises(InputError, match="is not text in UTF-8"):
        result.save(tmp_path / "a.json")
    assert list(tmp_path.iterdir()) == []


def test_hostile_sources_compile_and_run_as_tame_ones(tmp_path):
    compilers = {"c": ("gcc", "-Wall", "-Wextra", "-Werror"), "fortran": ("gfortran", "-Wall")}
    worst = " ".join(text[:80] for text in HOSTILE.values())
    for target, (compiler, *flags) in compilers.items():
        require_program(compiler)
        objects = []
        for text in (TAME, worst):
            file = tmp_path / f"law{'.c' if target == 'c' else '.f90'}"
            file.write_text(export(laws.Enhanced(), "internal", target, text), encoding="ascii")
            made = tmp_path / "law.o"
            command = [compiler, *flags, "-O1", "-c", file, "-o", made, f"-J{tmp_path}"]
            subprocess.run(command[: 8 if target == "fortran" else -1], check=True, cwd=tmp_path)
            objects.append(made.read_bytes())
        assert objects[0] == objects[1], target


def test_a_page_of_the_report_has_no_element_of_others():
    render = _renderer(
        version="1", made_with={}, paper=Paper(title="P"), marks={}, page_of={}, counts={},
        what_stands="", claims_problem="",
    )  # fmt: skip

    def page(text):
        return render("fits", tables=[], missing_campaigns={text: f"{text} is missing"})

    for text in HOSTILE.values():
        shown = page(text)
        assert elements(shown) == elements(page(TAME))
        assert len(shown) < 20 * LONG


def test_tex_runs_nothing_of_a_figure(tmp_path):
    require_program("xelatex")
    with figure_style():
        figure = Figure(figsize=(3, 8))
        for k, text in enumerate(text for text in HOSTILE.values() if text.isascii()):
            figure.text(0, k / 30, f"$E$ {as_label(text)}")
            figure.text(0.5, k / 30, as_label(text))
        drawing = Drawing(figure, pd.DataFrame({"a": [1.0]}), {}, "A figure.")
        save_picture(drawing, tmp_path / "a.pgf", "pgf", JOURNAL)
    written = (tmp_path / "a.pgf").read_text("utf-8")
    assert r"\textbackslash{}input" in written
    assert r"\input{/" not in written
    assert r"\write18" not in written.replace(r"\textbackslash{}write18", "")
