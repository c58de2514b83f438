"""The commands as a whole: their examples, and options that are for another use."""

import shlex
from pathlib import Path

import pytest
import typer

from cylcontact.cli.app import app as program

ROOT = Path(__file__).resolve().parents[2]
SPEC = ROOT / "datasets/slider_crank.toml"
COMMANDS = typer.main.get_command(program).commands
EXAMPLES = {name: command.epilog.removeprefix("Example: ") for name, command in COMMANDS.items()}
# Of these commands the example takes a second or two.
QUICK = ("sample", "fit", "choose", "compare", "laws", "export", "init")


# --- help --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", COMMANDS)
def test_the_examples_are_understood(name):
    program_name, first, *arguments = shlex.split(EXAMPLES[name])
    assert (program_name, first) == ("cylcontact", name)
    COMMANDS[name].make_context(name, arguments)


@pytest.mark.slow
@pytest.mark.parametrize("name", QUICK)
def test_the_quick_examples_run(run, tmp_path, monkeypatch, name):
    for folder in ("datasets", "fitting"):
        (tmp_path / folder).mkdir()
        for path in (ROOT / folder).iterdir():
            (tmp_path / folder / path.name).symlink_to(path)
    (tmp_path / "datasets/examples").unlink()
    (tmp_path / "datasets/examples").mkdir()
    table = "datasets/examples/pin-in-hole.csv"
    (tmp_path / table).write_bytes((ROOT / table).read_bytes())
    (tmp_path / "fitting/results").unlink()
    (tmp_path / "fitting/results").mkdir()
    for path in (ROOT / "fitting/results").iterdir():
        (tmp_path / "fitting/results" / path.name).write_bytes(path.read_bytes())
    monkeypatch.chdir(tmp_path)
    code, out, errors = run(*shlex.split(EXAMPLES[name])[1:])
    assert (code, errors) == (0, "")
    assert out


# --- one command, several ways to use it -------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (
            ("simulate", SPEC, "--clearance", "0.5,0.02"),
            "simulate: --clearance = '0.5,0.02': must be one value; give one, or vary it with "
            "--study cases",
        ),
        (
            ("simulate", SPEC, "--study", "bifurcation", "-o", "t.csv", "--law", "johnson,liu"),
            "simulate: --law = 'johnson,liu': must be one value; give one, or vary it with "
            "--study cases",
        ),
        (
            ("simulate", SPEC, "--last", 3),
            "simulate: --last: is for --study bifurcation, and this is one run; leave it out",
        ),
        (
            ("simulate", SPEC, "-o", "x.gif", "--resume"),
            "simulate: --resume: is for one run or --study cases, and this is a film; leave it out",
        ),
        (
            ("simulate", SPEC, "--study", "tolerances", "-o", "t.csv", "--first", 0),
            "simulate: --first: is for one run, a film or --study cases, and this is --study "
            "tolerances; leave it out",
        ),
        (
            ("simulate", SPEC, "--study", "cases"),
            "simulate: --out: is missing for a study; name the table, e.g. -o cases.csv",
        ),
        (
            ("simulate", SPEC, "--study", "chaos"),
            "simulate: --study = 'chaos': is unknown; choose cases, tolerances or bifurcation",
        ),
        (
            ("simulate", SPEC, "-o", "x.gif", "--revolutions", 2),
            "simulate: --first = 2: leaves none of 2 revolutions; start earlier, or simulate more",
        ),
        (
            ("fit", "r.json", "--force"),
            "r.json: --force: is for a calibration, and this is a fit result; leave it out",
        ),
        (
            ("fit", "c.toml", "--optimizer", "all", "--resume"),
            "c.toml: --resume: is for a calibration, and this is a comparison; leave it out",
        ),
        (
            ("fit", "c.toml", "--bootstrap", 50),
            "c.toml: --bootstrap: is for a fit result, and this is a calibration; leave it out",
        ),
    ],
)
def test_what_is_for_another_way_is_refused(run, tmp_path, monkeypatch, arguments, line):
    monkeypatch.chdir(tmp_path)
    assert run(*arguments) == (2, "", f"cylcontact: {line}\n")
    assert not list(tmp_path.iterdir())
