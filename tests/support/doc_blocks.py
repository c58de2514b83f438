"""The code in a page of the documentation, run as its reader would, in a copy of the bench.

A block of Python runs with the names of those before it. A line of a block of bash runs here if
it calls cylcontact, and in a shell if it calls one of `TOOLS`; a target of make must exist. A block
with a title is the file of that name. A block of text right below one that ran is what it printed.
"""

import contextlib
import doctest
import importlib
import io
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from cylcontact import cli
from tests.support.programs import require_program, skip_if_told, skipping

ROOT = Path(__file__).resolve().parents[2]
BENCH = ("datasets", "fitting", "reports")
FENCE = re.compile(r'^( *)```(\w*)(?: title="([^"]+)")?\n(.*?)^\1```$', re.DOTALL | re.MULTILINE)
TOOLS = ("cp", "mkdir", "echo", "sed", "gcc", "cat", "ls", "head", "tail", "./")
NEEDED = {"gcc": "gcc"}
# They take minutes or a cluster, or the tutorial runs the like: only that they parse is checked.
LONG = re.compile(
    r"cylcontact (figure|verify.*|.*--scheduler.*|fit fitting/mine.toml .*)"
    r"|dask .*"
)
ALIKE = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, its title, its text, and whether it follows another one."""

    language: str
    title: str
    text: str
    adjacent: bool


def blocks(page):
    """Return the blocks of a page in order."""
    actual, text, end = [], page.read_text(encoding="utf-8"), -1
    for match in FENCE.finditer(text):
        indent, language, title, body = match.groups()
        body = re.sub(rf"^{indent}", "", body, flags=re.MULTILINE)
        adjacent = end >= 0 and not text[end : match.start()].strip()
        actual.append(Block(language, title or "", body, adjacent))
        end = match.end()
    return actual


def copy_bench(folder):
    """Copy what a reader's checkout holds after make; the committed fits stand for its own."""
    for name in BENCH:
        shutil.copytree(
            ROOT / name, folder / name, ignore=shutil.ignore_patterns("generated", "figures")
        )
    (folder / "build").mkdir(parents=True)
    for name in ("internal", "external", "recovered-internal", "recovered-external"):
        shutil.copy(ROOT / f"fitting/results/{name}.json", folder / "build")


def run_page(page, folder, monkeypatch):
    """Run all blocks of a page in `folder`; return each with what it printed."""
    monkeypatch.chdir(folder)
    # A page may put its folder, relative to this one, where Python looks for modules.
    monkeypatch.setattr(sys, "path", list(sys.path))
    importlib.invalidate_caches()
    names, ran = {"__name__": "page"}, []
    for block in blocks(page):
        printed = None
        if block.title:
            target = folder / block.title
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(block.text, encoding="utf-8")
        elif block.language == "python":
            stream = io.StringIO()
            with contextlib.redirect_stdout(stream), skipping():
                exec(compile(block.text, str(page), "exec"), names)
            printed = stream.getvalue()
        elif block.language == "bash":
            printed = "".join(run_line(line, monkeypatch) for line in lines(block.text))
        ran.append((block, printed))
    return ran


def lines(text):
    """Return the commands of a block of bash."""
    joined = text.replace("\\\n", " ").splitlines()
    return [line for line in joined if line.strip() and not line.startswith("#")]


def run_line(line, monkeypatch):
    """Run one command, or see that it would be understood; return what it printed."""
    command = shlex.split(line, comments=True)
    if command[0] == "cd":
        monkeypatch.chdir(command[1])
    elif command[0] == "make":
        require_targets([word for word in command[1:] if "=" not in word])
    elif command[:3] == ["python3", "-m", "venv"] or command[0] == "mine/bin/pip":
        pass  # minutes, and a network; .ci/run does it
    elif command[0] == "mine/bin/cylcontact":
        return run_cylcontact(command[1:], monkeypatch)
    elif command[0] == "source":
        assert command[1:] == [".venv/bin/activate"]
    elif LONG.fullmatch(shlex.join(command)):
        require_understood(command)
    elif command[0] == "cylcontact":
        return run_cylcontact(command[1:], monkeypatch)
    else:
        return run_tool(line, command[0])
    return ""


def run_cylcontact(arguments, monkeypatch):
    """Run the command line in this process and return what it printed."""
    if ">" in arguments:
        *arguments, _, target = arguments
        Path(target).write_text(run_cylcontact(arguments, monkeypatch), encoding="utf-8")
        return ""
    if "fmu" in arguments:
        require_program("gcc")
    monkeypatch.setattr(sys, "argv", ["cylcontact", *arguments])
    out, err = io.StringIO(), io.StringIO()
    with (
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
        pytest.raises(SystemExit) as stop,
    ):
        cli.main()
    skip_if_told(err.getvalue())
    assert stop.value.code == 0, err.getvalue()
    return out.getvalue()


def run_tool(line, tool):
    """Run a line in a shell and return what it printed."""
    assert tool.startswith(TOOLS), f"the tests do not know how to run: {line}"
    if tool in NEEDED:
        require_program(NEEDED[tool])
    done = subprocess.run(
        ["bash", "-ec", line], capture_output=True, text=True, check=False, timeout=60
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def require_understood(command):
    """Parse a command of the package without running it."""
    if command[0] != "cylcontact":
        return
    import typer

    _, name, *arguments = command
    group = typer.main.get_command(cli.app)
    group.commands[name].make_context(name, arguments)


def require_targets(targets):
    """See that make knows every target."""
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in targets:
        assert re.search(rf"^{re.escape(target)}:", makefile, flags=re.MULTILINE), target


def same(expected, printed):
    """Compare what a page shows with what was printed; "..." stands for anything."""
    return doctest.OutputChecker().check_output(expected, printed, ALIKE)
