"""The gallery: each script runs, leaves its picture, and prints what its page shows."""

import ast
import os
import re
import subprocess
import sys

import pytest

from tests.support.doc_blocks import ROOT
from tests.support.programs import require_program

SCRIPTS = sorted((ROOT / "docs/gallery").glob("*.py"))
NUMBER = re.compile(r"[-+]?\d[\d,]*\.?\d*(?:e[-+]?\d+)?")


def words_and_numbers(text):
    """Split a text, for numbers may differ in their last digits on another processor."""
    numbers = [float(number.replace(",", "")) for number in NUMBER.findall(text)]
    return NUMBER.sub("#", text).split(), numbers


@pytest.mark.slow
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_draws_its_picture_and_prints_what_the_page_shows(script, tmp_path):
    """WRITE_GOLDEN=1 writes the output anew."""
    if script.stem == "joint_in_c":
        require_program("gcc")
    if script.stem == "joint_in_octave":
        require_program("octave-cli")
    if script.stem == "joint_in_mujoco":
        pytest.importorskip("mujoco")
    if script.stem == "four_bar_in_exudyn":
        pytest.importorskip("exudyn")
    if script.stem == "posterior":
        pytest.importorskip("emcee")  # no extra has it
    env = os.environ | {"MPLBACKEND": "agg"}
    command = [sys.executable, "-W", "error", script]
    done = subprocess.run(
        command, cwd=tmp_path, env=env, check=False, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert [path.name for path in tmp_path.iterdir()] == [f"{script.stem}.png"]
    output = script.with_suffix(".txt")
    if os.environ.get("WRITE_GOLDEN") and done.stdout:
        output.write_text(done.stdout, encoding="utf-8")
    shown = output.read_text(encoding="utf-8") if output.exists() else ""
    (words, numbers), (expected, values) = map(words_and_numbers, (done.stdout, shown))
    assert words == expected
    assert numbers == pytest.approx(values, rel=0.02)


def test_each_script_is_on_the_page_with_a_title_and_words():
    page = (ROOT / "docs/gallery.md").read_text(encoding="utf-8")
    assert SCRIPTS
    for script in SCRIPTS:
        assert script.with_suffix(".png").is_file()
        assert f"](gallery/{script.stem}.png)" in page
        assert f"](gallery/{script.stem}.py)" in page
        assert "\n\n" in ast.get_docstring(ast.parse(script.read_text(encoding="utf-8")))


@pytest.mark.slow
def test_the_pictures_of_the_pages_can_be_drawn(tmp_path):
    """Each function of docs/pictures.py has its picture, which a page shows."""
    text = (ROOT / "docs/pictures.py").read_text(encoding="utf-8")
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs/pictures.py").write_text(text, encoding="utf-8")
    for folder in ("fitting", "datasets"):
        (tmp_path / folder).symlink_to(ROOT / folder)
    subprocess.run([sys.executable, "-W", "error", "docs/pictures.py"], cwd=tmp_path, check=True)
    drawn = {path.name for path in (tmp_path / "docs/pictures").iterdir()}
    assert drawn == {path.name for path in (ROOT / "docs/pictures").iterdir()}
    pages = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "docs").rglob("*.md"))
    assert all(f"pictures/{name}" in pages for name in drawn)
