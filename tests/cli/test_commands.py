"""The commands as a whole: their help, their examples, and the same numbers as JSON."""

import json
import re
import shlex
import shutil
from pathlib import Path

import pytest
import typer

from cylcontact.cli import options
from cylcontact.cli.app import app as program
from cylcontact.fitting.noise import NOISES
from cylcontact.plots.style import WIDTHS
from tests.support.report_files import CLAIMS

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = typer.main.get_command(program)
COMMANDS = PROGRAM.commands | {
    f"laws {name}": command for name, command in PROGRAM.commands["laws"].commands.items()
}
EXAMPLES = [
    line.removeprefix("Example: cylcontact ")
    for command in COMMANDS.values()
    for line in command.epilog.split("\n\n")
]
# Examples that take less than five seconds together.
QUICK = ("fit datasets", "predict", "compare", "check", "size", "laws compare", "export johnson")


# --- help --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", COMMANDS)
def test_the_help_fits_a_screen_or_has_sections_and_shows_no_type(run, name, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    text = run(*name.split(), "--help")[1]
    sections = {getattr(option, "rich_help_panel", None) for option in COMMANDS[name].params}
    assert 10 < len(text.splitlines()) <= (95 if len(sections) > 1 else 27)
    assert not re.search(r"<\w+|TEXT|FLOAT|\[\[", text)
    assert f"Example: cylcontact {name}" in text


def test_help_offers_what_there_is():
    known = (NOISES, WIDTHS)
    offered = (options.NOISES, options.WIDTHS)
    assert offered == tuple(map(tuple, known))


# --- examples ----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def shipped(tmp_path_factory):
    """The folder that `cylcontact init` makes; examples run in it one after the other."""
    folder = tmp_path_factory.mktemp("shipped")
    for part in ("datasets", "fitting", "reports"):
        shutil.copytree(ROOT / part, folder / part, ignore=shutil.ignore_patterns("results"))
    shutil.copytree(ROOT / "fitting/results", folder / "fitting/results")
    return folder


def as_marked(line):
    return line if line.startswith(QUICK) else pytest.param(line, marks=pytest.mark.slow)


@pytest.mark.parametrize("line", [*map(as_marked, EXAMPLES)])
def test_the_examples_run_and_write_to_build_alone(run, shipped, monkeypatch, line):
    monkeypatch.chdir(shipped)
    before = {path for path in shipped.rglob("*") if "build" not in path.parts}
    code, out, err = run(*shlex.split(line))
    assert code == 0, err
    assert out
    new = {path for path in shipped.rglob("*") if "build" not in path.parts} - before
    assert {path.relative_to(shipped).parts[0] for path in new} <= {"mine"}


# --- the same numbers as JSON, and without notes -------------------------------------------------

TABLE = "datasets/examples/specimens.csv --law explicit --contact internal --fix offset=0"
OF_TABLE = "--material 'high-strength steel' --Ri 10 --Rj 9.97 --length 20"
CRANK = "datasets/slider_crank.toml --revolutions 2"


def numbers_in(data):
    """All numbers of JSON that are no integers."""
    if isinstance(data, dict | list):
        values = data.values() if isinstance(data, dict) else data
        return [number for each in values for number in numbers_in(each)]
    return [data] if isinstance(data, float) else []


@pytest.mark.parametrize(
    ("line", "digits"),
    [
        ("compare fitting/results/internal.json fitting/results/internal-E1000.json", ".5g"),
        ("compare fitting/results/internal.json", ".5g"),
        (f"plan {TABLE} {OF_TABLE} --candidates 5:400 --add 2", ".5g"),
        (f"simulate {CRANK}", ".5g"),
    ],
    ids=["compare", "one", "plan", "simulate"],
)
def test_json_has_the_numbers_of_the_text(run, shipped, monkeypatch, line, digits):
    monkeypatch.chdir(shipped)
    text, said = (run(*shlex.split(line), *more)[1] for more in ((), ("--json",)))
    printed = {
        float(word.replace(",", "")) for word in re.findall(r"-?\d[\d,]*\.?\d*(?:e-?\d+)?", text)
    }
    numbers = numbers_in(json.loads(said))
    missing = [
        x
        for x in numbers
        if not {float(f"{x:{digits}}"), float(f"{x:.2g}"), float(f"{x:.4g}")} & printed
    ]
    assert len(numbers) >= 5
    assert not missing


def test_a_sweep_prints_the_rows_that_it_writes(run, shipped, monkeypatch):
    import pandas as pd

    monkeypatch.chdir(shipped)
    line = shlex.split(f"sweep {CRANK} --law johnson,explicit -j 1")
    assert run(*line)[0] == 2  # neither a table nor JSON
    code, said, _ = run(*line, "--json", "-o", "build/sweep.csv")
    rows = json.loads(said)["rows"]
    written = pd.read_csv("build/sweep.csv").to_dict("list")
    assert (code, [row["law"] for row in rows]) == (0, ["johnson", "explicit"])
    assert [row["max_penetration_um"] for row in rows] == pytest.approx(
        written["max_penetration_um"]
    )


def test_quiet_leaves_the_results_alone(run, shipped, monkeypatch):
    monkeypatch.chdir(shipped)
    fit = shlex.split("fit datasets/examples/pin-in-hole.csv --law explicit --contact internal")
    fit += ["--runs", "1", "-o", "build/one.json"]
    loud, quiet = run(*fit)[1], run(*fit, "-q")[1]
    assert loud == f"{quiet}\nwritten to build/one.json\n"
    assert run("sweep", *shlex.split(CRANK), "-j", 1, "-q", "-o", "build/s.csv")[1:] == ("", "")


def test_claims_are_written_and_printed_as_json_at_once(run, tmp_path, monkeypatch):
    (tmp_path / "reports").mkdir()
    (tmp_path / "reports/claims.py").write_text(CLAIMS)
    monkeypatch.chdir(tmp_path)
    code, said, _ = run("claims", "--json", "-q", "-o", "build/claims.csv")
    assert (code, len(json.loads(said))) == (0, 2)
    assert (tmp_path / "build/claims.csv").is_file()
