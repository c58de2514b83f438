"""What users see is what tests/golden holds: exit codes and files of commands.

The figures are held by tests/reports/test_figures.py, which draws them.

WRITE_GOLDEN=1 in the environment writes the files anew instead; `python -m`
`tests.support.write_golden` writes all of them. Read the difference before you commit it.
"""

import json
import re
import shlex
import shutil

import pytest

from tests.support import frozen
from tests.support.measured_files import USER_LAW, write_measured
from tests.support.report_files import CLAIMS, FIGURE
from tests.support.spec_files import ELEMENTS, write_bench, write_toml


def group_of(line):
    """Return the command of a line, or that it needs an extra."""
    return "extras" if re.search(r"\.parquet", line) else line.split(" ")[0]


GROUPS = [
    pytest.param(group, marks=[pytest.mark.slow] * (group == "extras"))
    for group in sorted({*map(group_of, frozen.frozen("exit_codes"))})
]
ROOT = frozen.ROOT


@pytest.fixture
def folder(tmp_path, monkeypatch, small_result):
    """A folder with good and bad inputs of every kind, where commands run."""
    write_bench(tmp_path)
    write_measured(tmp_path / "table.csv", "johnson", "internal", noise=0.01)
    write_toml(tmp_path / "elements.toml", ELEMENTS)
    small_result.save(tmp_path / "result.json")
    for name in ("slider_crank.toml", "joint.toml"):
        shutil.copy(ROOT / "datasets" / name, tmp_path)
    for name in ("grid.toml", "bad.toml"):
        (tmp_path / name).write_text("contact = 'sideways'\n")
    (tmp_path / "bad.csv").write_text("dR_um,load_N_per_mm,penetration_um\n50,ten,1\n")
    (tmp_path / "bad.json").write_text("{}")
    text = (tmp_path / "result.json").read_text("utf-8")
    value = json.loads(text)["estimates"]["n"]["value"]
    (tmp_path / "altered.json").write_text(text.replace(str(value), str(0.99 * value), 1))
    (tmp_path / "mine.py").write_text(USER_LAW)
    (tmp_path / "reports").mkdir()
    (tmp_path / "reports/mine.py").write_text(FIGURE)
    (tmp_path / "reports/claims.py").write_text(CLAIMS)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("group", GROUPS)
def test_commands_end_with_their_codes_and_write_their_files(run, folder, group):
    def of_group(key):
        return group_of(key) == group

    before, codes, wordy = set(folder.rglob("*")), {}, []
    for line in filter(of_group, frozen.frozen("exit_codes")):
        codes[line], _, errors = run(*shlex.split(line))
        if codes[line] == 2 and len(errors.splitlines()) != 1:
            wordy.append(f"{line}: {errors}")
    written = sorted(path for path in folder.rglob("*") if path.is_file() and path not in before)
    files = {
        f"{group} writes {path.relative_to(folder).as_posix()}": frozen.outline(path)
        for path in written
        if path.suffix != ".pyc" and group != "init" and "assets" not in path.parts
    }
    frozen.hold("exit_codes", codes, part=of_group)
    frozen.hold("written", files, part=of_group)
    assert wordy == []
