"""Nothing is lost where output cannot be written: bad paths, faults of the disk, lost readers."""

import io
import json
import os
import shutil
import socket
import sys
import tempfile
from collections.abc import Callable
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import pandas as pd
import pytest

from cylcontact import fitting
from cylcontact.choices import CHOICE_FILES
from cylcontact.cli import init
from cylcontact.mechanism import drawing
from tests.counts import counted
from tests.faults import ERRORS, REMOVING, changed, failing, no_file_above
from tests.killable import ROOT
from tests.manuscript_files import write_manuscript
from tests.programs import fake_program, require_package, require_program
from tests.spec_files import ELEMENTS, tree, write_bench, write_toml

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name == "nt", reason="Windows has other operations on files"),
]

FEW = {"parameters.n": {"value": 1.2, "fixed": True}, "genetic.generations": 2, "genetic.runs": 1}
RECIPE = """
import pandas as pd
from cylcontact.plots import Drawing, new_figure

def draw(bench):
    figure = new_figure("column", 60)
    table = pd.DataFrame({"load": [10.0]})
    return Drawing(figure, table, {"largest load, N/mm": 10.0}, "A load.", "So.")
"""
CLAIM = """
from cylcontact.reports.claims import Finding, claim

@claim("2-load", "there is a load", paper="10 N/mm", rule="it is positive")
def load():
    return Finding("10 N/mm", True)
"""
MECHANISM = f"{ROOT}/datasets/slider_crank.toml"
JOINT = f"{ROOT}/datasets/joint.toml"
TABLE = "load_N,penetration_mm\n" + "".join(f"{f},{1e-4 * f**0.9}\n" for f in range(10, 100, 10))
OF_TABLE = (
    *("--contact", "internal", "--E", "207000", "--nu", "0.3", "--dR", "0.05"),
    *("--Ri", "10", "--length", "12"),
)


def repeatable(contents):
    """Return a result without the times and the provenance."""
    data = json.loads(contents)
    data.pop("provenance", None)
    for run in data.get("runs", ()):
        run.pop("seconds", None)
    return data


def table_of(contents):
    """Return a trajectory without its provenance."""
    return require_package("pyarrow.parquet").read_table(io.BytesIO(contents))


def untimed(contents):
    """Return a table of revolutions without the time that its run took."""
    return pd.read_csv(io.BytesIO(contents)).drop(columns="seconds").to_csv()


class Command(NamedTuple):
    """A command in a bench, the files it writes there, and what another run gives again.

    Its files appear together, unless it writes them one after another.
    """

    arguments: tuple[object, ...]
    outputs: tuple[str, ...]
    resumes: bool = False
    same: Callable[[bytes], object] = bytes
    program: str = ""
    in_turn: bool = False


def exported(target, *names, program=""):
    return Command(
        ("export", "--joint", JOINT, "--to", target, "-o", names[0]), names, program=program
    )


SIMULATE = ("simulate", MECHANISM, "--revolutions", "1", "--first", "0")
STUDY = ("simulate", MECHANISM, "--law", "explicit", "--jobs", "1", "--study")
COMMANDS = {
    "sample, csv": Command(("sample", "datasets/small.toml", "-o", "s.csv"), ("s.csv",)),
    "sample, parquet": Command(
        ("sample", "datasets/small.toml", "-o", "s.parquet"), ("s.parquet",)
    ),
    "fit": Command(
        ("fit", "fitting/small.toml", "-o", "r.json", "--jobs", "1"), ("r.json",), True, repeatable
    ),
    "fit a table": Command(
        ("fit", "t.csv", *OF_TABLE, "--law", "winkler", "-o", "folder"),
        tuple(f"folder/{name}" for name in ("result.json", "residuals.csv", "fit.png", "fit.pdf")),
        True,
        lambda contents: repeatable(contents) if contents[:1] == b"{" else contents,
    ),
    "fit with each optimizer": Command(
        ("fit", "fitting/small.toml", "--optimizer", "all", "-o", "o.csv", "--jobs", "1"),
        ("o.csv",),
        same=untimed,
    ),
    "choose": Command(
        ("choose", "t.csv", *OF_TABLE, "--law", "winkler,johnson", "-o", "chosen"),
        tuple(f"chosen/{name}" for name in CHOICE_FILES),
    ),
    "study a result": Command(
        ("fit", "good.json", "-o", "study.json", "--jobs", "1"), ("study.json",)
    ),
    "export a law": Command(("export", "johnson", "--to", "c", "-o", "law.c"), ("law.c",)),
    "export a result": Command(
        ("export", "good.json", "--to", "json", "-o", "l.json"), ("l.json",)
    ),
    "export c": exported("c", "j.c", "j.h"),
    "export cpp": exported("cpp", "j.hpp"),
    "export fortran": exported("fortran", "j.f90"),
    "export python": exported("python", "j.py"),
    "export matlab": exported("matlab", "j.m"),
    "export fmu": exported("fmu", "j.fmu", program="cc"),
    "simulate": Command((*SIMULATE, "-o", "run.parquet"), ("run.parquet",), same=table_of),
    "simulate, table": Command((*SIMULATE, "--table", "run.csv"), ("run.csv",), same=untimed),
    "simulate cases": Command(
        (*SIMULATE, "--study", "cases", "-o", "cases.csv", "--friction", "0,0.1", "--jobs", "1"),
        ("cases.csv",),
        True,
    ),
    "simulate tolerances": Command(
        (*STUDY, "tolerances", "-o", "a.csv", "--tolerance", "1e-5", "--revolutions", "1"),
        ("a.csv",),
    ),
    "simulate bifurcation": Command(
        (*STUDY, "bifurcation", "-o", "b.csv", "--points", "1", "--last", "1", "--revolutions", 2),
        ("b.csv",),
    ),
    "film": Command((*SIMULATE, "-o", "film.gif"), ("film.gif",)),
    "finite-element": Command(
        ("finite-element", "elements.toml", "-o", "e.csv", "--jobs", "1"), ("e.csv",), True
    ),
    "figure": Command(
        ("figure", "fig99", "-o", "figures", "--jobs", "1", "--format", "png,svg"),
        tuple(f"figures/fig99.{ending}" for ending in ("png", "svg", "csv", "txt")),
    ),
    "report": Command(
        ("report", "-o", "html", "--jobs", "1"),
        tuple(f"html/{name}" for name in ("index.html", "explore.html", "figures/fig99.png")),
        in_turn=True,
    ),
    "report, tables": Command(
        ("report", "--tables", "latex", "-o", "tables", "--jobs", "1"),
        tuple(f"tables/{name}.tex" for name in ("coefficients", "claims", "fig99-caption")),
    ),
    "manuscript": Command(
        ("manuscript", "reports/mine/a.md", "-o", "set", "--jobs", "1"),
        ("set/a.pdf", "set/numbers.csv", "set/latex/a.tex", "set/latex/figures/fig99.pdf"),
    ),
    "claims": Command(("claims", "-o", "claims.json", "--jobs", "1"), ("claims.json",)),
    "init": Command(("init", "new"), ()),
}
# These need a program, or their pictures take long to draw.
APART = ("export fmu", "fit a table", "choose")


@pytest.fixture
def bench(tmp_path, monkeypatch, small_result):
    """A small bench, in which commands run; its temporary files are in it too."""
    folder = tmp_path / "bench"
    write_bench(folder, FEW)
    write_toml(folder / "elements.toml", ELEMENTS | {"dR": [0.5], "load": [20.0, 40.0]})
    (folder / "t.csv").write_text(TABLE)
    (folder / "reports").mkdir()
    (folder / "reports/fig99.py").write_text(RECIPE)
    (folder / "reports/claims").mkdir()
    write_manuscript(folder / "reports/mine")
    (folder / "reports/claims/section2.py").write_text(CLAIM)
    (folder / "scratch").mkdir()
    small_result.save(folder / "good.json")
    monkeypatch.chdir(folder)
    monkeypatch.setattr(tempfile, "tempdir", str(folder / "scratch"))
    monkeypatch.setattr(init, "FOLDERS", ("datasets/examples",))
    monkeypatch.setattr(drawing, "FRAMES_PER_REVOLUTION", 2)
    return folder


def restore(bench, files):
    """Give a folder these files and no others."""
    for name in changed(tree(bench), files):
        if (bench / name).is_dir():
            shutil.rmtree(bench / name)
        else:
            (bench / name).unlink(missing_ok=True)
    for name, contents in files.items():
        if contents is None:
            (bench / name).mkdir(parents=True, exist_ok=True)
        elif not (bench / name).exists():
            (bench / name).parent.mkdir(parents=True, exist_ok=True)
            (bench / name).write_bytes(contents)


def ready(command, bench, run):
    """Run a command once; return what it gives, and all files with old ones in its place."""
    if command.program:
        require_program(command.program)
    before = tree(bench)
    code, _, errors = run(*command.arguments)
    assert code == 0, errors
    whole = tree(bench)
    for output in command.outputs:
        (bench / output).write_bytes(b"old")
    old = tree(bench) if command.outputs else before
    restore(bench, old)
    return whole, old


def assert_kept(command, bench, whole, old, done, failed=""):
    """One line, the old files whole, and nothing half-written beside them."""
    code, _, errors = done
    if code == 0:  # what failed can be done without, or was done by then
        assert b"old" not in [(bench / name).read_bytes() for name in command.outputs]
        return
    assert code == 2, (failed, errors)
    assert len(errors.splitlines()) == 1, (failed, errors)
    assert errors.startswith("cylcontact: "), (failed, errors)
    now = tree(bench)
    differ = changed(old, now) - {f"{name}.partial" for name in command.outputs}
    if failed == "replace" or command.in_turn:  # each is the old one or the new one, whole
        differ = {name for name in differ if not is_new(command, now.get(name), whole.get(name))}
    if failed not in REMOVING:  # or a temporary file cannot be removed
        assert differ == set(), (failed, errors)


def is_new(command, contents, new):
    """Whether a file, or a folder, is as it is without a fault."""
    if contents is None or new is None:
        return contents is new
    return command.same(contents) == command.same(new)


def assert_repeated(command, bench, whole, run):
    """Without a fault the command now does all, and goes on from what is kept."""
    kept = any((bench / f"{name}.partial").exists() for name in command.outputs)
    code, _, errors = run(*command.arguments, *(["--resume"] if kept else []))
    assert code == 0, errors
    for name in command.outputs:
        assert command.same((bench / name).read_bytes()) == command.same(whole[name])


def inject(name, bench, run, monkeypatch, errors_of):
    """Let each operation of a command fail in turn; return how many faults that were."""
    command = COMMANDS[name]
    whole, old = ready(command, bench, run)
    number = injected = 0
    while True:
        number += 1
        for error in errors_of(number):
            with failing(monkeypatch, bench, number, error) as faults:
                done = run(*command.arguments)
            if faults.failed is None:
                assert done[0] == 0
                return injected
            injected += 1
            assert_kept(command, bench, whole, old, done, faults.failed)
            if command.resumes and done[0]:
                assert_repeated(command, bench, whole, run)
            restore(bench, old)


def each_once(number):
    """One error for an operation, another for the next."""
    return [ERRORS[number % len(ERRORS)]]


def all_at_first(number):
    """Every error for the first operations, which are alike in all commands; later one each."""
    return ERRORS if number <= 3 else each_once(number)


def test_whatever_operation_on_a_file_fails_nothing_is_lost(bench, run, monkeypatch):
    """Each command in turn; in its last run nothing fails, after all those that failed."""
    files, faults = tree(bench), 0
    for name in COMMANDS.keys() - {*APART, "report", "manuscript"}:  # of very many operations
        faults += inject(name, bench, run, monkeypatch, each_once)
        restore(bench, files)
    counted("faults injected at writes, renames and other operations on files", faults)


@pytest.mark.long
@pytest.mark.parametrize("name", COMMANDS)
def test_whatever_operation_fails_in_whatever_way_nothing_is_lost(name, bench, run, monkeypatch):
    if name == "fit a table":  # it is fitted once
        run(*COMMANDS[name].arguments)
        result = fitting.FitResult.read(bench / "folder/result.json")
        monkeypatch.setattr(fitting, "calibrate", lambda *_: result)
    assert inject(name, bench, run, monkeypatch, all_at_first) > 0


def test_a_file_that_may_not_grow_leaves_the_old_one(bench, run):
    """The system's limit on the size of files stands for a full disk, for compiled writers too."""
    files, limits = tree(bench), 0
    for name in COMMANDS.keys() - {*APART, "init"}:
        command = COMMANDS[name]
        whole, old = ready(command, bench, run)
        size = len(whole[command.outputs[0]])
        for limit in (0, size // 2, size * 9 // 10):
            with no_file_above(limit):
                done = run(*command.arguments)
            assert done[0] == 2, (name, limit)
            assert_kept(command, bench, whole, old, done)
            restore(bench, old)
            limits += 1
        assert_repeated(command, bench, whole, run)
        restore(bench, files)
    counted("writes stopped by a limit on the size of files", limits)


@pytest.mark.parametrize("script", ["exit 3", "cat >/dev/null; exit 3"])
def test_a_film_that_ffmpeg_cannot_write_leaves_the_old_one(bench, run, monkeypatch, script):
    ffmpeg = fake_program(bench / "scratch", "ffmpeg", script)
    monkeypatch.setenv("PATH", f"{ffmpeg.parent}:{os.environ['PATH']}")
    (bench / "film.mp4").write_text("old")
    before = tree(bench)
    code, _, errors = run(*SIMULATE, "-o", "film.mp4")
    assert code == 2
    assert errors.startswith("cylcontact: film.mp4: cannot be written (")
    assert len(errors.splitlines()) == 1
    assert tree(bench) == before


# --- where output goes --------------------------------------------------------------------------


def pipe(path):
    os.mkfifo(path)


def bound_socket(path):
    with socket.socket(socket.AF_UNIX) as bound:
        bound.bind(os.path.relpath(path))


def link(path):
    path.with_name("pointed").write_text("precious")
    path.symlink_to("pointed")


KINDS = {
    "named pipe": pipe,
    "socket": bound_socket,
    "folder": Path.mkdir,
    "link": link,
    "link to itself": lambda path: path.symlink_to(path.name),
    "link to nothing": lambda path: path.symlink_to("nowhere"),
    "link to a device": lambda path: path.symlink_to("/dev/null"),
}


def test_a_path_that_is_no_file_is_refused_before_any_work(bench, run, monkeypatch):
    """The output, its lock and its journal, whichever a command has."""
    monkeypatch.setattr("cylcontact.cli.terminal.progress_bars", None)
    files, refused = tree(bench), 0
    for command in COMMANDS.values():
        locked = [*command.outputs[:1]] if command.resumes else []
        beside = [f"{name}{suffix}" for name in locked for suffix in (".lock", ".partial")]
        for name in (*command.outputs, *beside):
            for kind, make in KINDS.items():
                (bench / name).parent.mkdir(parents=True, exist_ok=True)
                make(bench / name)
                before = tree(bench)
                code, out, errors = run(*command.arguments)
                (line,) = errors.splitlines()
                assert (code, out) == (2, ""), (name, kind)
                assert line.startswith(f"cylcontact: {name}: cannot be "), (name, kind)
                assert f"(it is a {kind.split(' to ')[0]})" in line, (name, kind)
                if kind == "link" and not name.endswith(".partial"):
                    assert line.endswith(f"; name the file it points to, {bench}/pointed") or (
                        "/" in name
                    )
                assert changed(before, tree(bench)) == set()
                restore(bench, files)
                refused += 1
    counted("output paths that are no file, refused", refused)


@pytest.mark.parametrize("path", ["/dev/null", "/dev/full", "/dev/stdout", "/dev/null/x.c"])
def test_a_device_is_refused(run, path):
    code, out, errors = run("export", "johnson", "--to", "c", "-o", path)
    assert (code, out) == (2, "")
    assert errors.startswith(f"cylcontact: {path}: cannot be written (")
    assert Path("/dev/null").is_char_device()


def test_a_link_to_the_folder_is_followed(bench, run):
    (bench / "other").mkdir()
    (bench / "linked").symlink_to("other")
    assert run("export", "johnson", "--to", "c", "-o", "linked/law.c")[0] == 0
    assert (bench / "other/law.c").is_file()


# --- an output is no input ----------------------------------------------------------------------


@pytest.mark.parametrize(
    "arguments",
    [
        ("fit", "good.json", "-o", "good.json"),
        ("fit", "good.json", "-o", "hard.json"),
        ("fit", "good.json", "-o", "scratch/../good.json"),
        ("fit", "t.csv", *OF_TABLE, "--law", "johnson", "--optimizer", "all", "-o", "t.csv"),
        ("choose", "results/choice.csv", *OF_TABLE, "-o", "results"),
        ("fit", "results/residuals.csv", *OF_TABLE, "--law", "winkler", "-o", "results"),
        ("export", "good.json", "--to", "json", "-o", "good.json"),
        ("export", "--joint", "joint.py", "--to", "python", "-o", "joint.py"),
        ("simulate", "run.csv", "--table", "run.csv"),
        ("claims", "--results", "results", "-o", "results"),
    ],
    ids=lambda arguments: " ".join((arguments[0], *arguments[-2:])),
)
def test_an_output_is_never_an_input(bench, run, arguments):
    os.link(bench / "good.json", bench / "hard.json")
    (bench / "results").mkdir()
    for name in ("results/choice.csv", "results/residuals.csv", "run.csv"):
        (bench / name).write_text(TABLE)
    (bench / "joint.py").write_text("")
    before = tree(bench)
    code, out, errors = run(*arguments)
    assert (code, out) == (2, "")
    assert len(errors.splitlines()) == 1
    assert tree(bench) == before


# --- lost readers -------------------------------------------------------------------------------

PRINTING = {name: command.arguments for name, command in COMMANDS.items() if name not in APART} | {
    "compare": ("compare", "good.json"),
    "laws": ("laws",),
    "export, printed": ("export", "johnson", "--to", "c"),
    "study, printed": ("fit", "good.json", "--jobs", "1"),
    "simulate, printed": SIMULATE,
    "verify": ("verify", "good.json", "--jobs", "1"),
    "version": ("--version",),
    "help": ("--help",),
    "help of a command": ("fit", "--help"),
}


@pytest.mark.parametrize("reader", ["gone", "full"])
def test_a_lost_reader_of_what_is_printed_costs_no_file(bench, run, monkeypatch, reader):
    if reader == "full" and not Path("/dev/full").exists():
        pytest.skip("there is no full device here")
    for name, arguments in PRINTING.items():
        with lost_output(reader) as output, monkeypatch.context() as patch:
            patch.setattr(sys, "stdout", output)
            code, _, errors = run(*arguments)
        if reader == "gone":
            assert (code, errors) == (141, ""), name
        else:
            assert code == 2, name
            line = "cylcontact: standard output: cannot be written (No space left on device); "
            assert errors == f"{line}make room\n", name
        command = COMMANDS.get(name)
        for output in command.outputs if command else ():
            assert (bench / output).stat().st_size > 0, name
        assert not list(bench.rglob(".*")), name


@contextmanager
def lost_output(reader):
    """A standard output that nobody reads, or without room."""
    if reader == "full":
        output = os.fdopen(os.open("/dev/full", os.O_WRONLY), "w")
    else:
        ending, handle = os.pipe()
        os.close(ending)
        output = os.fdopen(handle, "w")
    yield output
    os.dup2(os.open(os.devnull, os.O_WRONLY), output.fileno())
    output.close()
