"""Exit code 0 means that what was asked for is there and can be read again."""

import json
import zipfile
from pathlib import Path

import matplotlib.image
import pandas as pd
import pytest

import cylcontact as cc
from cylcontact.choices import CHOICE_FILES, FIT_FILES
from cylcontact.cli.app import app
from cylcontact.datasets import finite_element
from cylcontact.export import TARGETS
from cylcontact.fitting import FitResult, read_campaign
from cylcontact.mechanism import Trajectory, read_joint, read_mechanism
from tests.conftest import build_command
from tests.reports.test_bench import CLAIM, RECIPE
from tests.support.manuscript_files import write_manuscript
from tests.support.measured_files import write_measured
from tests.support.spec_files import ELEMENTS, write_bench, write_toml

pytestmark = pytest.mark.slow


ROOT = Path(__file__).parents[2]
CRANK = ROOT / "datasets/slider_crank.toml"
SHORT = ("--law", "explicit", "--revolutions", 1)


def rows(path):
    """Rows of a table, of which there must be some."""
    return len(pd.read_parquet(path) if path.suffix == ".parquet" else pd.read_csv(path))


def drawn(path):
    """Pixels of a picture."""
    return matplotlib.image.imread(path).size


def of_folder(*names):
    """A reader of a folder with these files, none of them empty."""
    return lambda folder: all((folder / name).stat().st_size for name in names)


def of_json(path):
    return json.loads(path.read_text("utf-8"))


def text(path):
    return path.read_text("utf-8")


READERS = {"fmu": zipfile.is_zipfile}
TABLE = ("measured.csv", "--contact", "internal", "--E", "207 GPa", "--nu", 0.3, "--Ri", 10)
# The arguments, the output and what reads it; without an output the report is what was asked for.
CASES = [
    (("sample", "datasets/small.toml", "-o", "s.parquet"), "s.parquet", rows),
    (("sample", "datasets/small.toml", "-o", "s.csv"), "s.csv", rows),
    (("fit", "fitting/small.toml", "-o", "f.json", "-j", 1), "f.json", FitResult.read),
    (("optimizers", "fitting/small.toml", "genetic", "least-squares", "-j", 1, "-o", "o.csv"),
     "o.csv", rows),
    (("fit", *TABLE, "--law", "johnson", "-o", "t.json"), "t.json", FitResult.read),
    (("fit", *TABLE, "--law", "johnson", "-o", "folder"), "folder", of_folder(*FIT_FILES)),
    (("fit", *TABLE, "--law", "johnson", "-o", "folder2"), "folder2/result.json", FitResult.read),
    (("fit", *TABLE, "--law", "johnson", "-o", "folder3"), "folder3/fit.png", drawn),
    (("uncertainty", "r.json", "-j", 1, "-o", "u.json"), "u.json", of_json),
    (("choose", *TABLE, "--law", "johnson,explicit", "-o", "c"), "c", of_folder(*CHOICE_FILES)),
    (("choose", *TABLE, "--law", "johnson,explicit", "-o", "c2"), "c2/choice.csv", rows),
    (("predict", "data.json", "--load", "100 N/mm"), None, None),
    (("design", *TABLE, "--law", "johnson", "--loads", "5:400", "-o", "d"), "d/design.png", drawn),
    (("compare", "r.json"), None, None),
    (("verify", "r.json", "-j", 1), None, None),
    (("laws",), None, None),
    *(
        (("export", "r.json", "--to", to, "-o", f"law.{to}"), f"law.{to}", READERS.get(to, text))
        for to in TARGETS
    ),
    (("simulate", CRANK, *SHORT), None, None),
    (("simulate", CRANK, *SHORT, "-o", "run.parquet"), "run.parquet", Trajectory.load),
    (("simulate", CRANK, *SHORT, "--table", "n.csv"), "n.csv", rows),
    (("sweep", CRANK, *SHORT, "-j", 1, "-o", "k.csv"), "k.csv", rows),
    (("tolerances", CRANK, *SHORT, "--tolerance", 1e-6, "-j", 1, "-o",
      "a.parquet"), "a.parquet", rows),
    (("bifurcation", CRANK, "--law", "explicit", "--revolutions", 3,
      "--points", 1, "--last", 1, "-j", 1, "-o", "b.csv"), "b.csv", rows),
    (("finite-element", "elements.toml", "-j", 1, "-o", "x.csv"), "x.csv",
     finite_element.read_table),
    (("figure", "fig99", "-j", 1), "reports/figures/fig99.png", drawn),
    (("figure", "fig99", "-j", 1, "-o", "fig"), "fig/fig99.csv", rows),
    (("claims", "-o", "claims.csv", "-j", 1), "claims.csv", rows),
    (("paper", "reports/mine/a.md", "-j", 1), "reports/typeset/a/latex/a.tex", text),
    (("paper", "reports/mine/a.md", "-j", 1, "-o", "set"), "set", of_folder("a.pdf")),
    (("report", "-o", "site", "-j", 1), "site/index.html", text),
    (("init", "mine"), "mine/fitting/external.toml", read_campaign),
    (("init", "mine2"), "mine2/datasets/joint.toml", read_joint),
    (("init", "mine3"), "mine3/datasets/slider_crank.toml", read_mechanism),
]  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory, small_result):
    """A folder with an input of every kind, where all commands are run."""
    root = tmp_path_factory.mktemp("work")
    write_bench(root)
    write_measured(root / "measured.csv", "johnson", "internal", noise=0.01)
    write_toml(root / "elements.toml", ELEMENTS)
    small_result.save(root / "r.json")
    constants = {"E_GPa": 207, "nu": 0.3, "R_i_mm": 10}
    table = root / "measured.csv"
    cc.fit(table, "johnson", contact="internal", constants=constants).save(root / "data.json")
    (root / "reports/claims").mkdir(parents=True)
    (root / "reports/paper.py").write_text("LOADS = (10.0, 1000.0)\n")
    (root / "reports/fig99.py").write_text(RECIPE)
    (root / "reports/claims/mine.py").write_text(CLAIM)
    write_manuscript(root / "reports/mine")
    return root


@pytest.mark.parametrize(
    ("arguments", "output", "read"), CASES, ids=[f"{case[0][0]}-{case[1]}" for case in CASES]
)
def test_after_exit_code_zero_the_output_is_there_and_can_be_read(
    folder, monkeypatch, run, arguments, output, read
):
    monkeypatch.chdir(folder)
    code, said, errors = run(*arguments)
    assert code == 0, errors
    if output is None:
        assert said.strip()
    else:
        assert read(folder / output)


def test_every_command_is_among_them():
    assert {case[0][0] for case in CASES} == set(build_command(app).commands)
