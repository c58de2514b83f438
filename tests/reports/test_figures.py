"""Figures of a folder: found, drawn with arguments, written together or not at all."""

import hashlib
import json
import re
import subprocess
from importlib.metadata import version
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from matplotlib import image
from PIL import Image

from cylcontact import InputError
from cylcontact.plots import figure_style
from cylcontact.reports.figures import caption, draw, recipes, report_module, write_figures
from tests.support import frozen
from tests.support import paper_equations as paper
from tests.support.report_files import FIGURE, shipped_figure
from tests.support.samples import sampled

ROOT = Path(__file__).resolve().parents[2]
ENDINGS = {".png", ".pdf", ".csv", ".txt"}
E_STEEL = paper.e_star(207e3, 0.3)
E_STAR = {
    10: paper.e_star(600e3, 0.24),
    11: E_STEEL,
    12: paper.e_star(200e3, 0.3),
    13: paper.e_star(120e3, 0.34),
    14: paper.e_star(69e3, 0.33),
}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "reports").mkdir()
    (tmp_path / "reports/mine.py").write_text(FIGURE)
    return tmp_path


# --- golden numbers ---


RUNS = ("fig17", "fig18", "fig19", "fig_housing")
# Figures of many runs, fits or elements.
SLOW = (*RUNS, "fig05", "fig_choices")


@pytest.mark.parametrize("name", sampled(recipes(ROOT), recipes(ROOT).keys() - SLOW))
def test_numbers_behind_a_figure(name):
    """Those of runs and finite elements may differ in their last digits."""
    _, table = shipped_figure(name)
    columns = frozen.summary(table)
    if name in ("fig18", "fig19"):  # chaotic: another processor has another path
        columns = dict.fromkeys(columns)
    now = {f"{name} {column}": numbers for column, numbers in columns.items()}
    frozen.hold("figures", now, frozen.close(1e-4), lambda key: key.split(" ")[0] == name)


# --- the engine ---


def test_the_papers_figures_are_there():
    numbers = {f"fig{n:02d}" for n in (*range(2, 15), 17, 18, 19)}
    others = ("accuracy", "choices", "elements", "housing", "map", "refit")
    assert {*numbers, *(f"fig_{name}" for name in others)} == set(recipes(ROOT))


def test_a_figure_is_written_with_numbers_and_caption(folder):
    paths = write_figures(folder, ["fig99"], {"load": "20"})
    assert {path.name for path in paths} == {f"fig99-20{ending}" for ending in ENDINGS}
    assert (
        pd.read_csv(folder / "build/figures/fig99-20.csv", comment="#")["load_N_per_mm"].item()
        == 20
    )
    text = (folder / "build/figures/fig99-20.txt").read_text()
    assert text == "A load of 20 N/mm.\n"
    assert caption(folder, "fig99") == "A load of 10 N/mm."


@pytest.mark.slow
def test_the_same_bytes_for_any_number_of_workers(folder):
    mine = folder / "reports/mine.py"
    mine.write_text(FIGURE.replace("FIGURES = {", 'FIGURES = {"other": fig99, '))
    files = [write_figures(folder, folder=folder / str(n), workers=n) for n in (1, 2)]
    assert [path.read_bytes() for path in files[0]] == [path.read_bytes() for path in files[1]]


def test_picture_and_numbers_say_what_they_are_from(folder):
    """Version, files and their hashes, the seed of a fit; nothing of this machine or this hour."""
    (folder / "datasets").mkdir()
    (folder / "datasets/mine.csv").write_text("load\r\n7\r\n")
    (folder / "build").mkdir()
    fit = {"settings": {"campaign": {"seed": 5}}}
    (folder / "build/fit.json").write_text(json.dumps(fit))
    (folder / "reports/beside.py").write_text("LOAD = 'datasets/mine.csv'\n")
    mine = FIGURE.replace(
        "import pandas as pd\n", "import pandas as pd\nfrom .beside import LOAD\n"
    )
    mine = mine.replace("    figure =", READING + "    figure =")
    (folder / "reports/mine.py").write_text(mine.replace("ROOT", repr(str(folder))))
    png, pdf, csv, _ = write_figures(folder, ["fig99"])
    said = csv.read_text().splitlines()[0].removeprefix("# ")
    hashes = {
        name: hashlib.sha256((folder / name).read_bytes().replace(b"\r\n", b"\n")).hexdigest()[:12]
        for name in ("build/fit.json", "datasets/mine.csv", "reports/beside.py", "reports/mine.py")
    }
    inputs = ", ".join(f"{name} {short}" for name, short in hashes.items())
    assert said == f"cylcontact {version('cylcontact')}; inputs: {inputs}; seed: 5"
    assert Image.open(png).text["Comment"] == said
    assert "cylcontact" in pdf.read_bytes().decode("latin-1")
    first = [path.read_bytes() for path in (png, pdf, csv)]
    again = write_figures(folder, ["fig99"], folder=folder / "elsewhere")[:3]
    assert [path.read_bytes() for path in again] == first
    (folder / "datasets/mine.csv").write_text("load\n8\n")
    assert write_figures(folder, ["fig99"])[2].read_bytes() != first[2]


def test_only_what_is_in_build_names_a_commit(folder):
    git = ["git", "-c", "user.name=me", "-c", "user.email=me@here"]
    for words in (["init", "-q"], ["add", "."], ["commit", "-qm", "all"]):
        subprocess.run([*git, *words], cwd=folder, check=True)
    head = [*git, "rev-parse", "HEAD"]
    commit = subprocess.run(head, cwd=folder, capture_output=True, text=True, check=True)
    for out, named in (("build/figures", True), ("docs", False)):
        csv = write_figures(folder, ["fig99"], folder=folder / out)[2]
        assert (f"commit: {commit.stdout.strip()}" in csv.read_text()) is named


@pytest.mark.parametrize(("width", "mm"), [(None, 90.0), (190.0, 190.0), (72.5, 72.5)])
def test_a_width_is_that_of_the_picture(folder, width, mm):
    (png, *_) = write_figures(folder, ["fig99"], formats=["png"], width=width)
    assert image.imread(png).shape[1] == pytest.approx(mm / 25.4 * 300, abs=1)


def test_a_style_is_applied_on_top(folder, tmp_path):
    style = tmp_path / "mine.mplstyle"
    style.write_text("lines.linewidth: 7\n")
    with figure_style(str(style)):
        assert mpl.rcParams["lines.linewidth"] == 7
        figure, _ = draw(folder, "fig99")
    assert figure.axes[0].lines[0].get_linewidth() == 7


READING = """    import json
    import pathlib

    root = pathlib.Path(ROOT)
    pd.read_csv(root / LOAD)
    json.loads((root / "build/fit.json").read_text())
"""

MISTAKES = {
    "no such figure": (["fig98"], {}, FIGURE, "fig98: there is no such figure; choose fig99"),
    "no such argument": (["fig99"], {"dR": "1"}, FIGURE, "it takes load, name; leave it out"),
    "a failure": (["fig99"], {"load": "x"}, FIGURE, "fig99: failed with ValueError"),
    "a broken file": ([], {}, "1 /\nFIGURES = {}", "mine.py: failed with SyntaxError"),
}


@pytest.mark.parametrize(("names", "arguments", "text", "words"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_is_one_line_and_leaves_nothing(folder, names, arguments, text, words):
    (folder / "reports/mine.py").write_text(text)
    with pytest.raises(InputError) as caught:
        write_figures(folder, names, arguments)
    assert words in str(caught.value).replace("figure = ", "").replace("'", "")
    assert "\n" not in str(caught.value)
    assert not list((folder / "build").rglob("*99*"))


def test_a_changed_file_is_read_anew(folder):
    assert "fig99" in recipes(folder)
    (folder / "reports/mine.py").write_text(FIGURE.replace('"fig99"', '"fig98"'))
    assert list(recipes(folder)) == ["fig98"]
    assert report_module(folder, "mine").__name__ != "reports.mine"


# --- what the figures show, by the paper's equations ---


def test_fig_2_prints_the_papers_constants():
    figure, table = shipped_figure("fig02")
    labels = [text for axes in figure.axes for text in axes.get_legend_handles_labels()[1]]
    assert any("K = 312148, n = 1.2370" in label for label in labels)
    rows = table[table["contact"] == "internal"]
    expected = paper.johnson(rows["load_N_per_mm"], E_STEEL, 0.05)
    assert rows["penetration_mm"].to_numpy() == pytest.approx(expected.to_numpy(), rel=1e-12)


def test_fig_3_shows_the_exponent_itself():
    figure, table = shipped_figure("fig03")
    assert figure.axes[0].get_yscale() == "linear"
    row = table[(table["contact"] == "internal") & (table["E_GPa"] == 207) & (table["nu"] == 0.3)]
    loads = np.geomspace(10, 1000, 41)
    _, n = paper.power_fit(loads, E_STEEL, row["dR_mm"].iloc[0])
    assert row["n"].iloc[0] == pytest.approx(n, rel=1e-10)


def test_figs_7_to_9_are_eqs_7_and_8():
    figure, table = shipped_figure("fig07")
    steel = table[(table["material"] == "low-carbon steel") & (table["R_i_mm"] == 10)]
    R = paper.effective_radius(10.0, steel["dR_mm"])
    E_star = paper.e_star(200e3, 0.3)
    hertz = paper.yield_load(250.0, E_star, R)
    assert steel["hertz_load_N_per_mm"].to_numpy() == pytest.approx(hertz.to_numpy(), rel=1e-12)
    for axes in figure.axes:  # the bold curves are Eq 7, and none is cut off
        low, high = axes.get_ylim()
        for line in axes.lines:
            assert ((line.get_ydata() > low) & (line.get_ydata() < high)).all()
    bold = [line for line in figure.axes[1].lines if line.get_label() == "low-carbon steel"]
    assert bold[0].get_ydata() == pytest.approx(hertz.to_numpy(), rel=1e-12)
    _, limits = shipped_figure("fig08")
    steel = limits[limits["material"] == "low-carbon steel"]
    ends = paper.johnson_end(E_star, steel["dR_mm"])
    assert steel["load_N_per_mm"].to_numpy() == pytest.approx(ends.to_numpy(), rel=1e-12)
    figure, table = shipped_figure("fig09")
    steel = table[(table["material"] == "low-carbon steel") & (table["R_i_mm"] == 10)]
    peak = np.sqrt(ends.to_numpy() * E_star / (np.pi * R.to_numpy()))
    assert steel["stress_MPa"].to_numpy() == pytest.approx(peak, rel=1e-12)
    assert "MPa" in figure.axes[0].get_ylabel()


@pytest.mark.parametrize(("name", "E", "nu"), [("fig10", 600e3, 0.24), ("fig12", 200e3, 0.3)])
def test_the_maps_are_eq_9(name, E, nu):
    figure, table = shipped_figure(name)
    assert f"$E$ = {E / 1e3:g} GPa" in figure.axes[0].get_title(loc="left")
    table = table.dropna()
    expected = paper.difference(table["load_N_per_mm"], paper.e_star(E, nu), table["dR_mm"])
    assert table["difference_percent"].to_numpy() == pytest.approx(
        expected.to_numpy(), rel=1e-9, abs=1e-9
    )


@pytest.mark.parametrize("number", range(10, 15))
def test_a_map_explains_what_it_draws_and_its_numbers_are_a_rectangle(number):
    figure, table = shipped_figure(f"fig{number}")
    words = caption(ROOT, f"fig{number}")
    (legend,) = figure.legends
    drawn_marks = " ".join(text.get_text() for text in legend.get_texts())
    assert ("Hatched" in words) is ("beyond Johnson's" in drawn_marks)
    assert ("Ticked" in words) is ("first yield" in drawn_marks)
    assert "Dotted" in words
    assert "the paper's fit begins" in drawn_marks
    assert any("enhanced less Johnson's" in axes.get_ylabel() for axes in figure.axes)
    grid = table.pivot(index="dR_mm", columns="load_N_per_mm", values="difference_percent")
    assert grid.shape == (161, 81)
    ends = paper.johnson_end(E_STAR[number], grid.index.to_numpy())[:, None]
    assert np.array_equal(np.isnan(grid.to_numpy()), grid.columns.to_numpy() > ends)


@pytest.mark.parametrize("name", sampled([n for n in recipes(ROOT) if n not in RUNS], ["fig07"]))
def test_a_narrow_figure_keeps_its_labels_and_fits_a_page(name, monkeypatch):
    monkeypatch.chdir(ROOT)
    with figure_style(width=85.0):
        figure, _ = draw(ROOT, name)
    assert figure.get_figheight() * 25.4 <= 205.5
    if name not in ("fig_choices", "fig_refit"):  # whose panels share a label
        assert all(axes.get_ylabel() for axes in figure.axes)


def test_fig_6_has_the_elements_of_the_paper_beside_ours():
    """As the paper says: plane stress, the load on the centre nodes."""
    _, table = shipped_figure("fig06")
    letter = table[table["set_up"] == "paper"]
    off = 100 * (letter["johnson_mm"] / letter["embedded_mm"] - 1)
    assert (off.min().round(1), off.max().round(1)) == (-53.1, -26.2)
    expected = paper.johnson(letter["load_N_per_mm"], E_STEEL, letter["dR_mm"])
    assert letter["johnson_mm"].to_numpy() == pytest.approx(expected.to_numpy(), rel=1e-9)


def test_fig_4_states_the_size_of_its_cells(monkeypatch):
    monkeypatch.chdir(ROOT)
    mesh = report_module(ROOT, "elements").setup().mesh(0.1, [20.0, 40.0, 100.0])
    low, high = map(float, re.search(r"sides of (\d) to (\d) µm", caption(ROOT, "fig04")).groups())
    for body in (mesh.plate, mesh.pin):
        cells = body.points[body.quads]
        x, y = np.abs(cells.mean(axis=1) - [0.0, 2.245]).T
        sides = 1e3 * np.linalg.norm(cells - np.roll(cells, 1, axis=1), axis=2)
        at_contact = sides[(x < 0.04) & (y < 0.02)]
        assert low <= at_contact.min()
        assert at_contact.max() < high + 0.5


@pytest.mark.slow
def test_shares_of_time_add_up_and_settled_runs_agree():
    """With losses the three runs give one curve; without they differ, which the figure shows."""
    _, table = shipped_figure("fig19")
    case = ["law", "restitution", "friction"]
    cells = table[table["quantity"] == "time in a cell"]
    assert set(cells["law"]) == {"lankarani-nikravesh", "johnson", "enhanced"}
    assert cells.groupby(case)["percent"].sum().to_numpy() == pytest.approx(100, rel=1e-12)
    deeper = table[table["quantity"] == "time deeper"]
    spread = deeper.groupby([*case, "depth_um"])["percent"].agg(np.ptp).groupby(case).max()
    assert spread.xs(0.9, level="restitution").max() < 3
    assert spread.xs(1.0, level="restitution").min() > 3
    settled = cells[(cells["restitution"] == 0.9) & (cells["friction"] == 0.1)]
    depth = np.hypot(settled["x_um"], settled["y_um"]) - 20
    assert 0 < (depth * settled["percent"]).sum() / settled["percent"].sum() < 4


def test_a_fresh_fit_takes_the_place_of_the_published_law():
    result = "fitting/results/internal.json"
    _, table = shipped_figure("fig12", result=result)
    _, refit = shipped_figure("fig_refit", result="internal")
    rows = refit[refit["material"] == "low-carbon steel"]
    assert table["difference_percent"].to_numpy() == pytest.approx(
        rows["difference_percent"].to_numpy()
    )
    assert result in caption(ROOT, "fig12", {"result": result})


def test_an_unknown_result_is_refused(monkeypatch):
    monkeypatch.chdir(ROOT)
    with pytest.raises(InputError, match="neither a law nor a fit result"):
        draw(ROOT, "fig12", {"result": "build/none.json"})
