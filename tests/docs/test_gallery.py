"""The gallery: each script runs, leaves its picture, and stands on the page."""

import os
import subprocess
import sys

import pytest

from tests.support.doc_blocks import ROOT
from tests.support.programs import require_program

SCRIPTS = sorted((ROOT / "docs/gallery").glob("*.py"))


@pytest.mark.slow
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_draws_its_picture(script, tmp_path):
    if script.stem == "joint_in_c":
        require_program("gcc")
    if script.stem == "joint_in_octave":
        require_program("octave-cli")
    if script.stem == "joint_in_mujoco":
        pytest.importorskip("mujoco")
    if script.stem == "four_bar_in_exudyn":
        pytest.importorskip("exudyn")
    env = os.environ | {"MPLBACKEND": "agg"}
    command = [sys.executable, "-W", "error", script]
    done = subprocess.run(command, cwd=tmp_path, env=env, check=False, capture_output=True)
    assert done.returncode == 0, done.stderr.decode()
    assert [path.name for path in tmp_path.iterdir()] == [f"{script.stem}.png"]


def test_each_script_is_a_page_and_on_the_page():
    page = (ROOT / "docs/gallery.md").read_text(encoding="utf-8")
    assert len(SCRIPTS) == 16
    for script in SCRIPTS:
        assert script.with_suffix(".png").is_file()
        assert f"](gallery/{script.stem}.png)" in page
        assert f"](gallery/{script.stem}.py)" in page
