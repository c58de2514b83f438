"""Fixtures shared by the tests: a material, pairs of cylinders, a small campaign, commands."""

import functools
import signal
import sys

import numpy as np
import pytest
import typer
from hypothesis import settings

from cylcontact import CylinderPair, Material, cli
from cylcontact.fitting import Campaign, LawFit, calibrate
from tests.support import programs
from tests.support.spec_files import write_bench

# Typer takes most of a short command's time to build it; the tests build it once.
build_command = functools.cache(typer.main.get_command)

# The same examples on every run and machine; mpmath and first imports make times uneven.
settings.register_profile("reproducible", derandomize=True, deadline=None)
settings.load_profile("reproducible")


def pytest_addoption(parser):
    parser.addoption(
        "--rest",
        action="store_true",
        help="run only slow tests, and those that skipped in the last run; none may skip",
    )


def pytest_configure(config):
    programs.REQUIRED = config.getoption("--rest")
    # What a shell starts in its background ignores Ctrl-C, and under nohup a closed terminal;
    # tests that end commands so must not pass this on to them.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if hasattr(signal, "SIGHUP"):
        signal.signal(signal.SIGHUP, signal.SIG_DFL)


def pytest_collection_modifyitems(config, items):
    skipped = config.cache.get(programs.CACHED, None) if config.getoption("--rest") else None
    if skipped is not None:
        # A file that needs an extra at its top has skipped as a whole.
        wanted = [
            item.get_closest_marker("slow") is not None
            or not {item.nodeid, item.nodeid.partition("::")[0]}.isdisjoint(skipped)
            for item in items
        ]
        out = [item for item, want in zip(items, wanted, strict=True) if not want]
        config.hook.pytest_deselected(items=out)
        items[:] = [item for item, want in zip(items, wanted, strict=True) if want]


def pytest_terminal_summary(terminalreporter, config):
    if not config.getoption("--rest") and hasattr(config, "cache"):  # not so by -p no:cacheprovider
        skipped = {report.nodeid for report in terminalreporter.stats.get("skipped", [])}
        config.cache.set(programs.CACHED, sorted(skipped))


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report():
    """Skip a file that imports what only an extra has."""
    report = yield
    if report.failed and not programs.REQUIRED:
        error = report.call.excinfo.value
        if reason := programs.absent(error.__cause__ or error):
            report.outcome, report.longrepr = "skipped", (report.nodeid, 0, f"Skipped: {reason}")
    return report


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup():
    with programs.skipping():
        return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call():
    with programs.skipping():
        return (yield)


@pytest.fixture(scope="session")
def steel() -> Material:
    return Material("steel", E=207e3, nu=0.3, yield_stress=250.0)


@pytest.fixture(scope="session")
def pair(steel: Material) -> CylinderPair:
    """A pin in a hole that knows everything a law may ask for."""
    return CylinderPair.internal(R_i=10.0, R_j=9.5, material=steel, length=12.0)


@pytest.fixture(scope="session")
def pairs(steel: Material) -> CylinderPair:
    """Three such pairs at once, as a column."""
    R_j = np.array([[9.99], [9.9], [9.0]])
    return CylinderPair.internal(R_i=10.0, R_j=R_j, material=steel, length=12.0)


@pytest.fixture(scope="session")
def small_campaign(tmp_path_factory: pytest.TempPathFactory) -> Campaign:
    """Three short runs on 96 samples."""
    return Campaign.read(write_bench(tmp_path_factory.mktemp("bench")))


@pytest.fixture(scope="session")
def small_result(small_campaign: Campaign) -> LawFit:
    return calibrate(small_campaign)


@pytest.fixture
def run(monkeypatch, capsys):
    """Run the command line in this process; return its exit code, output and errors."""
    monkeypatch.setattr(typer.main, "get_command", build_command)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["cylcontact", *map(str, arguments)])
        with pytest.raises(SystemExit) as caught:
            cli.main()
        written = capsys.readouterr()
        programs.skip_if_told(written.err)
        return caught.value.code, written.out, written.err

    return run
