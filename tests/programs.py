"""Programs that pip cannot install: a test that needs one skips without it, and says how to get it.

`pytest --last-skipped` runs just the tests that skipped in the run before; there, none may skip.
"""

import shutil
import subprocess

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
    "elsarticle.cls": "texlive-publishers",
}
# Set by `--last-skipped`.
REQUIRED = False
CACHED = "cylcontact/skipped"


def require_program(name):
    """Return the path of a program, or of a class of LaTeX.

    Without it, skip, or fail where no test may skip.
    """
    path = _class_of_latex(name) if name.endswith(".cls") else shutil.which(name)
    if path is None:
        absent = f"{name} is not installed (Debian: apt install {PACKAGES[name]})"
        if REQUIRED:
            pytest.fail(absent)
        pytest.skip(absent)
    return path


def _class_of_latex(name):
    """Return where LaTeX finds a class, None if it does not or is not there itself."""
    if shutil.which("pdflatex") is None:
        return None
    found = subprocess.run(["kpsewhich", name], capture_output=True, text=True, check=False)
    return found.stdout.strip() or None


def fake_program(folder, name, script):
    """Make a shell script that stands for a program, and return its path."""
    folder.mkdir(exist_ok=True)
    path = folder / name
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)
    return path
