"""Programs and extras that a test may need: without them it skips, and says how to get them.

`pytest --rest` runs what `make test` leaves out: slow tests, and those that skipped in the run
before; there, none may skip.
"""

import importlib.util
import shutil
import sys
from contextlib import contextmanager

import pytest

from cylcontact import InputError

# The Debian packages that hold each program.
PACKAGES = {
    "gcc": "gcc libc6-dev",
    "g++": "g++",
    "gfortran": "gfortran",
    "octave-cli": "octave",
    "ccx": "calculix-ccx",
    "chromium": "chromium",
}
# The libraries of each extra that tests import.
EXTRAS = {
    "parquet": "pyarrow",
    "notebooks": "IPython ipykernel ipywidgets nbclient nbformat nbmake voila",
    "distributed": "dask distributed",
    "docs": "latex2mathml material mkdocs mkdocstrings",
    "browser": "playwright",
    "peers": "cma exudyn fmpy iminuit libcosimpy lmfit mujoco odrpack statsmodels",
}
# Set by `--rest`.
REQUIRED = False
CACHED = "cylcontact/skipped"


def require_program(name):
    """Return the path of a program; without it, skip, or fail where no test may skip."""
    path = shutil.which(name)
    if path is None:
        _leave_out(f"{name} is not installed (Debian: apt install {PACKAGES[name]})")
    return path


def require_package(name):
    """Return a module of an extra; without it, skip, or fail where no test may skip."""
    with skipping():
        return importlib.import_module(name)


@contextmanager
def skipping():
    """Skip, or fail where no test may skip, if the block needs an extra that is not installed."""
    try:
        yield
    except ModuleNotFoundError as error:
        if reason := absent(error):
            _leave_out(reason)
        raise
    except InputError as error:
        skip_if_told(str(error))
        raise


def skip_if_told(text):
    """Skip, or fail where no test may skip, if a message asks for an extra that is absent."""
    for extra, libraries in EXTRAS.items():
        if f"cylcontact[{extra}]" in text and not all(map(_is_there, libraries.split())):
            _leave_out(f"the extra '{extra}' is not installed (make extras)")


def _is_there(library):
    """Return whether a library is installed, also where a test hides it or stands in for it."""
    return library in sys.modules or importlib.util.find_spec(library) is not None


def absent(error):
    """Return how to get what an import did not find, None if that is in no extra."""
    name = (getattr(error, "name", None) or "").split(".")[0]
    for extra, libraries in EXTRAS.items():
        if name in libraries.split():
            return f"{name} is not installed (make extras, or the extra '{extra}')"
    return None


def _leave_out(reason):
    if REQUIRED:
        pytest.fail(reason)
    pytest.skip(reason)


def fake_program(folder, name, script):
    """Make a shell script that stands for a program, and return its path."""
    folder.mkdir(exist_ok=True)
    path = folder / name
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)
    return path
