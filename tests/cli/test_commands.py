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
QUICK = ("sample", "fit", "uncertainty", "choose", "compare", "laws", "export", "init")


# --- help --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", COMMANDS)
def test_the_examples_are_understood(name):
    program_name, first, *arguments = shlex.split(EXAMPLES[name])
    assert (program_name, first) == ("cylcontact", name)
    COMMANDS[name].make_context(name, arguments)


@pytest.mark.parametrize("name", COMMANDS)
def test_the_help_fits_a_screen(run, name, monkeypatch):
    monkeypatch.setenv("COLUMNS", "100")
    assert 10 < len(run(name, "--help")[1].splitlines()) <= 43


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


# --- options and inputs of another command -----------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (
            ("simulate", SPEC, "--clearance", "0.5,0.02"),
            "Invalid value for '--clearance': '0.5,0.02' is not a number; see cylcontact "
            "simulate --help",
        ),
        (
            ("simulate", SPEC, "--study", "cases"),
            "No such option: --study; see cylcontact simulate --help",
        ),
        (
            ("sweep", SPEC),
            "Missing option '-o' / '--out'; see cylcontact sweep --help",
        ),
        (
            ("simulate", SPEC, "-o", "x.gif", "--resume"),
            "simulate: --resume: needs a file to go on from; name it: -o run.parquet",
        ),
        (
            ("simulate", SPEC, "-o", "x.gif", "--revolutions", 2),
            "simulate: --first = 2: leaves none of 2 revolutions; start earlier, or simulate more",
        ),
        (
            ("fit", "r.json"),
            "r.json: is a fit result; study its uncertainty with: cylcontact uncertainty r.json",
        ),
    ],
)
def test_what_is_for_another_command_is_refused(run, tmp_path, monkeypatch, arguments, line):
    monkeypatch.chdir(tmp_path)
    assert run(*arguments) == (2, "", f"cylcontact: {line}\n")
    assert not list(tmp_path.iterdir())
