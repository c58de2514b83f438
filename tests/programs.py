"""Programs that pip cannot install: a test that needs one skips without it, and says how to get it.

`pytest --last-skipped` runs just the tests that skipped in the run before; there, none may skip.
"""

import shutil

import pytest

# The Debian packages that hold each program.
PACKAGES = {
    "gcc": "gcc libc6-dev",
    "g++": "g++",
    "gfortran": "gfortran",
    "octave-cli": "octave",
    "ccx": "calculix-ccx",
    "chromium": "chromium",
    "xelatex": "texlive-xetex",
}
# Set by `--last-skipped`.
REQUIRED = False
CACHED = "cylcontact/skipped"


def require_program(name):
    """Return the path of a program; without it, skip, or fail where no test may skip."""
    path = shutil.which(name)
    if path is None:
        absent = f"{name} is not installed (Debian: apt install {PACKAGES[name]})"
        if REQUIRED:
            pytest.fail(absent)
        pytest.skip(absent)
    return path


def fake_program(folder, name, script):
    """Make a shell script that stands for a program, and return its path."""
    folder.mkdir(exist_ok=True)
    path = folder / name
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)
    return path
