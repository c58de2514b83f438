"""The commands as a whole: their help and their examples."""

import shlex
import shutil
from pathlib import Path

import pytest
import typer

from cylcontact.cli import options
from cylcontact.cli.app import app as program
from cylcontact.fitting.noise import NOISES
from cylcontact.plots.style import WIDTHS

ROOT = Path(__file__).resolve().parents[2]
COMMANDS = typer.main.get_command(program).commands
EXAMPLES = {name: command.epilog.removeprefix("Example: ") for name, command in COMMANDS.items()}
# Of these commands the example takes a second or two.
QUICK = ("sample", "fit", "choose", "plan", "compare", "check", "size", "laws", "export", "init")


# --- help --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", COMMANDS)
def test_the_examples_are_understood(name):
    program_name, first, *arguments = shlex.split(EXAMPLES[name])
    assert (program_name, first) == ("cylcontact", name)
    COMMANDS[name].make_context(name, arguments)


@pytest.mark.parametrize("name", COMMANDS)
def test_the_help_fits_a_screen_or_has_sections(run, name, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    lines = run(name, "--help")[1].splitlines()
    sections = {getattr(option, "rich_help_panel", None) for option in COMMANDS[name].params}
    assert 10 < len(lines) <= (95 if len(sections) > 1 else 24)


def test_help_offers_what_there_is():
    known = (NOISES, WIDTHS)
    offered = (options.NOISES, options.WIDTHS)
    assert offered == tuple(map(tuple, known))


@pytest.mark.slow
@pytest.mark.parametrize("name", QUICK)
def test_the_quick_examples_run(run, tmp_path, monkeypatch, name):
    for folder in ("datasets", "fitting"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    monkeypatch.chdir(tmp_path)
    code, out, errors = run(*shlex.split(EXAMPLES[name])[1:])
    assert (code, errors) == (0, "")
    assert out
