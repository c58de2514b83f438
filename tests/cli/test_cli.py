"""The command line as a user meets it: what it writes, what it says, its exit codes."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from cylcontact import cli
from cylcontact.fitting import calibrate, read_result
from tests.support.spec_files import CAMPAIGN, GRID, changed, tree, write_bench, write_toml
from tests.support.tether import tethered

ROOT = Path(__file__).resolve().parents[2]
COMMAND = [sys.executable, "-m", "cylcontact.cli"]
in_bench = pytest.mark.usefixtures("bench")
posix = pytest.mark.skipif(os.name == "nt", reason="Windows has no such signals and pipes")


@pytest.fixture
def bench(tmp_path, monkeypatch, small_result):
    """A folder to work in: a grid, a campaign, a result, and all kinds of other files."""
    write_bench(tmp_path)
    small_result.save(tmp_path / "good.json")
    variants = {
        "excluded": {"bounds.K_star": [-2, -1]},
        "masked": {"dataset": "datasets/masked.toml"},
    }
    for name, changes in variants.items():
        write_toml(tmp_path / f"fitting/{name}.toml", changed(CAMPAIGN, changes))
    masked = changed(GRID, {"axes.load": {"values": [1e9]}})
    write_toml(tmp_path / "datasets/masked.toml", masked)
    data = json.loads((tmp_path / "good.json").read_text())
    nan = changed(data, {"objective.value": float("nan")})
    (tmp_path / "nan.json").write_text(json.dumps(nan))
    (tmp_path / "table.csv").write_text("load_N_per_mm,penetration_um\n10,0.2\n")
    (tmp_path / "foreign.json.partial").write_text('{"format": 1, "campaign": "0"}\n')
    (tmp_path / "folder").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


def start(*arguments, **options):
    """Start the command line as a process of its own, in a group of its own."""
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen(
        tethered([*COMMAND, *map(str, arguments)]), start_new_session=True, **(pipes | options)
    )


def finish(*arguments, **options):
    """Return the exit code, the output and the errors of such a process."""
    process = start(*arguments, **options)
    said, errors = process.communicate(timeout=60)
    return process.returncode, said, errors


# --- what works -------------------------------------------------------------------------------


@pytest.mark.parametrize("out", ["samples.parquet", "new/folder/samples.csv"])
def test_sample_writes_a_table_and_says_how_many(bench, run, out):
    code, said, errors = run("sample", "datasets/small.toml", "-o", out)
    assert (code, errors) == (0, "")
    assert said == f"{out}: 96 samples, 0 masked by the domain of johnson\n"
    assert (bench / out).stat().st_size > 0


def test_fit_of_a_campaign_writes_to_build(bench, run, small_result):
    code, said, errors = run("fit", "fitting/small.toml", "--jobs", "1")
    assert (code, errors) == (0, "")
    path = bench / "build/small.json"
    assert read_result(path).repeatable() == small_result.repeatable()
    assert said == f"{read_result(path)}\n\nwritten to build/small.json\n"
    assert [file.name for file in path.parent.iterdir()] == ["small.json"]


# --- verify -----------------------------------------------------------------------------------


def test_verify_redoes_a_fit_and_says_that_it_holds(bench, run):
    before = tree(bench)
    code, said, errors = run("verify", "good.json", "--jobs", "1")
    assert (code, errors) == (0, "")
    assert said.count(": holds\n") == said.count("good: ") == 4
    assert said.endswith("1 results verified, 0 checks do not hold\n")
    assert tree(bench) == before
    rows = json.loads(run("verify", "good.json", "--jobs", "1", "--json")[1])["rows"]
    lines = [
        f"good: {row['what']}: committed {row['committed']:.10g}, fresh {row['fresh']:.10g}, "
        f"deviation {row['deviation']:.1e}, allowed {row['allowed']:.0e}: holds"
        for row in rows
    ]
    assert lines == said.splitlines()[:-1]


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"estimates.n.value": 1.4}, "objective of the coefficients"),
        ({"objective.value": 0.0}, "objective of the coefficients"),
        ({"bound": 0.05}, "lower bound"),
        ({"counts.samples": 95}, "samples"),
    ],
)
def test_verify_finds_out_a_tampered_result(bench, run, changes, what):
    data = json.loads((bench / "good.json").read_text())
    (bench / "altered.json").write_text(json.dumps(changed(data, changes)))
    code, said, errors = run("verify", "altered.json", "good.json", "--jobs", "1")
    assert (code, errors) == (1, "")
    failed = [line for line in said.splitlines() if line.endswith("DOES NOT HOLD")]
    assert any(line.startswith(f"altered: {what}: committed ") for line in failed)
    assert said.endswith(f"2 results verified, {len(failed)} checks do not hold\n")


# --- bad input --------------------------------------------------------------------------------

FIT, SAMPLE = ("fit", "fitting/small.toml"), ("sample", "datasets/small.toml")
TO_RESULT = ("-o", "r.json", "--jobs", "1")


def test_a_result_from_other_inputs_is_replaced_only_when_asked(bench, run):
    fit = ("fit", "fitting/small.toml", "--jobs", "1")
    assert run(*fit)[0] == 0
    path = bench / "build/small.json"
    first = path.read_bytes()
    assert run(*fit)[0] == 0  # the same inputs again
    before = tree(bench)
    code, out, err = run(*fit, "--seed", "11", "--runs", "2")
    assert (code, out) == (2, "")
    assert "small.json: holds a result that came from other inputs (campaign.seed: 7 there," in err
    assert tree(bench) == before
    assert run(*fit, "--seed", "11", "--force")[0] == 0
    assert path.read_bytes() != first
    path.write_text("not a result")
    assert run(*fit)[0] == 2
    assert run(*fit, "-o", path)[0] == 0  # named, so meant


@pytest.mark.slow
def test_a_second_law_on_the_same_table_has_a_folder_of_its_own(bench, run):
    (bench / "table.csv").write_text(
        "load_N_per_mm,penetration_um,dR_um,E_GPa,nu\n10,.21,50,207,.3\n100,1.7,50,207,.3\n"
        "500,7.2,50,207,.3\n1000,13.2,50,207,.3\n"
    )
    fit = ("fit", "table.csv", "--contact", "internal", "--law")
    assert run(*fit, "power")[0] == 0
    assert run(*fit, "hertz-cylinder")[0] == 0
    assert run(*fit, "power")[0] == 0  # the first one again
    laws = {
        folder.name: json.loads((folder / "result.json").read_text("utf-8"))["law"]
        for folder in (bench / "results").iterdir()
    }
    assert laws == {"table": "power", "table-hertz-cylinder": "hertz-cylinder"}
    code, _, err = run(*fit, "hertz-cylinder", "--seed", 3)
    assert code == 2
    assert "hertz-cylinder/result.json: holds a result that came from other inputs" in err


OUT = ("-o", "out.csv")
BAD_INPUT = [
    # the command line itself
    ((*FIT, "--runs", "1.5"), "'--runs': '1.5' must be an integer of at least 1; see"),
    ((*FIT, "-o", ""), "command line: an argument is empty; fill it in; a variable of the shell"),
    # what is read
    (("fit", "folder"), "folder: cannot be read (Is a directory); check the path"),
    (("fit", "fitting/masked.toml"), "datasets/masked.toml: axes: all 24 samples lie outside"),
    (("fit", "fitting/excluded.toml"), "excluded.toml: bounds = {'K_star': [-2.0, -1.0], 'n'"),
    (("verify", "nan.json"), "objective.value = nan: must be a finite number; give a value that"),
    (("verify",), "verify: names no result; name some, or all in fitting/results with --all"),
    (("verify", "--all"), "fitting/results: has no results; name some, or make a project folder"),
    # files of another kind
    (("fit", "datasets/small.toml"), "datasets/small.toml: is a grid spec, not a campaign; name a"),
    (("fit", "good.json", "--runs", "2"), "good.json: is a fit result; print it with: cylcontact"),
    (("verify", "table.csv"), "table.csv: is a table, not a fit result; name a fit result"),
    # what is written
    (
        (*FIT, "--resume", "-o", "foreign.json"),
        "foreign.json.partial: belongs to other work: its campaign or settings differ; run without",
    ),
]


@pytest.mark.parametrize(
    ("arguments", "message"), BAD_INPUT, ids=[" ".join(arguments) for arguments, _ in BAD_INPUT]
)
def test_bad_input_gets_one_line_and_exit_code_2_and_writes_nothing(bench, run, arguments, message):
    before = tree(bench)
    code, said, errors = run(*arguments)
    assert code == 2
    assert errors.startswith("cylcontact: ")
    assert message in errors
    assert len(errors.splitlines()) == 1
    assert said == ""
    assert tree(bench) == before


def test_a_run_that_finds_no_defined_law_is_told_of(bench, run):
    few = {"genetic.population": 4, "genetic.generations": 1, "genetic.runs": 20}
    bounds = {"bounds.K_star": [-1000, 1], "bounds.n": [-50, 1.5]}
    write_toml(bench / "fitting/few.toml", changed(CAMPAIGN, few | bounds))
    code, _, errors = run("fit", "fitting/few.toml", "--jobs", "1")
    assert code == 2
    assert re.fullmatch(
        r"cylcontact: fitting/few\.toml: genetic\.population = 4: run \d+ found no coefficients "
        r"for which the law is defined; narrow the bounds, or raise population and "
        r"generations\n",
        errors,
    )


@in_bench
def test_memory_that_is_short_is_told_in_one_line(run, monkeypatch):
    def short(*_):
        raise MemoryError

    monkeypatch.setattr("cylcontact.datasets.sampling.write_samples", short)
    code, said, errors = run(*SAMPLE, *OUT)
    assert (code, said) == (2, "")
    assert errors.startswith("cylcontact: out of memory; use a coarser grid")
    assert len(errors.splitlines()) == 1


def test_a_mistake_of_ours_is_not_hidden(bench, monkeypatch):
    def broken(*_):
        raise ZeroDivisionError

    monkeypatch.setattr("cylcontact.datasets.sampling.write_samples", broken)
    monkeypatch.setattr(sys, "argv", ["cylcontact", *SAMPLE, *OUT])
    with pytest.raises(ZeroDivisionError):
        cli.main()
    assert not (bench / "out.csv").exists()


# --- interruption -----------------------------------------------------------------------------


@pytest.mark.parametrize("runs", [0, 1, 2])
def test_what_is_kept_is_counted(bench, run, monkeypatch, runs):
    def interrupted(campaign, _, __, kept, resume):
        def stop(stage, done, _):
            if (stage, done) == ("searching", runs):
                raise KeyboardInterrupt

        return calibrate(campaign, 1, stop, kept, resume)

    monkeypatch.setattr("cylcontact.fitting.calibrate", interrupted)
    code, said, errors = run("fit", "fitting/small.toml", "-o", "new/r.json")
    expected = {
        0: "interrupted before a run was complete; nothing is kept",
        1: "interrupted; 1 complete run is kept in new/r.json.partial; the same",
        2: "interrupted; 2 complete runs are kept in new/r.json.partial; the same",
    }
    assert (code, said) == (130, "")
    assert errors.startswith(f"cylcontact: {expected[runs]}")
    assert len(errors.splitlines()) == 1
    assert (bench / "new").exists() == (runs > 0)


# --- pipes and terminals ----------------------------------------------------------------------


@pytest.mark.slow
@posix
def test_a_result_is_written_even_if_nobody_reads_the_report(bench):
    process = start(*FIT, *TO_RESULT)
    process.stdout.close()
    assert (process.wait(timeout=60), process.stderr.read()) == (141, "")
    process.stderr.close()
    assert read_result(bench / "r.json").name == "small"
    assert not (bench / "r.json.partial").exists()


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no full device here")
@in_bench
def test_output_without_room_is_told_in_one_line():
    with Path("/dev/full").open("w") as full:
        code, _, errors = finish("compare", "good.json", stdout=full)
    assert code == 2
    assert errors.startswith("cylcontact: standard output: cannot be written (No space left")
    assert len(errors.splitlines()) == 1


@pytest.mark.slow
@posix
@in_bench
def test_there_is_progress_on_a_terminal():
    master, terminal = os.openpty()
    narrow = os.environ | {"PYTHONIOENCODING": "latin-1"}
    process = start(*FIT, *TO_RESULT, stderr=terminal, env=narrow)
    os.close(terminal)
    visible = b""
    while True:
        try:
            visible += os.read(master, 4096)
        except OSError:  # the other end is closed
            break
    os.close(master)
    said, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    assert " ? " in said  # characters that the output has no room for
    for stage in (b"sampling", b"searching", b"profiling"):
        assert stage in visible
    assert "\x1b" not in said


def test_no_arguments_show_the_help(run):
    code, said, errors = run()
    assert (code, errors) == (0, "")
    assert "Usage: cylcontact" in said


@pytest.mark.parametrize(
    ("words", "word"), [("ch", "check"), ("check --rad", "--radial-clearance")]
)
def test_the_shell_completes_commands_and_options(words, word):
    given = {"COMP_WORDS": f"cylcontact {words}", "COMP_CWORD": str(len(words.split()))}
    env = os.environ | given | {"_CYLCONTACT_COMPLETE": "complete_bash"}
    command = [sys.executable, "-m", "cylcontact.cli"]
    done = subprocess.run(command, env=env, capture_output=True, text=True, check=True)
    assert word in done.stdout.split()
