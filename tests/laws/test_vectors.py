"""The law vectors: NumPy and every export against them, and two of them against mpmath."""

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from cylcontact.export import EXPORTABLE, export
from cylcontact.export.exported_law import exported
from cylcontact.laws import LAWS
from tests.support.export_runners import RUNNERS, run_octave
from tests.support.fmu_masters import started
from tests.support.programs import require_package, require_program
from tests.support.write_vectors import COLUMNS, FOLDER, pair_of

FILES = sorted(path.stem for path in Path(FOLDER).glob("*.json"))
EXPORTED = [stem for stem in FILES if stem.rsplit("-", 1)[0] in EXPORTABLE]
# Near the end of a logarithmic law a rounding of the penetration moves the stiffness the most.
CLOSE = 1e-11


@cache
def read(stem):
    about = json.loads((FOLDER / f"{stem}.json").read_text(encoding="ascii"))
    assert tuple(about["columns"]) == COLUMNS
    return about["law"], about["contact"], np.array(about["rows"])


class Case:
    """The arguments of an exported law."""

    def __init__(self, stem):
        name, self.contact, rows = read(stem)
        if name == "johnson":  # its export is the formula of one material
            rows = rows[rows[:, 0] == rows[:, 2]]
        self.law = LAWS[name]()
        of_law = exported(self.law, self.contact)
        self.name, self.rows, self.answers = of_law.name, len(rows), rows[:, 8:].T
        pairs = [pair_of(self.contact, row) for row in rows]
        self.arguments = {
            key: rows[:, 7] if key == "penetration" else
            np.array([float(getattr(pair, key)) for pair in pairs])
            for key in of_law.arguments
        }  # fmt: skip

    def each_row(self):
        return zip(*(column.tolist() for column in self.arguments.values()), strict=True)


def test_there_is_a_file_for_each_law_and_contact():
    assert FILES == sorted(
        f"{n}-{contact}" for n, law in LAWS.items() for contact in law().contacts
    )


@pytest.mark.parametrize("stem", FILES)
def test_a_law_gives_its_vectors(stem):
    name, contact, rows = read(stem)
    law = LAWS[name]()
    assert len(rows) >= 39
    for row in rows:
        pair = pair_of(contact, row)
        by_curve = name in ("conformal", "persson")
        load, stiffness = law.load(row[7], pair), law.stiffness(row[7], pair)
        assert load == pytest.approx(row[8], rel=1e-10 if by_curve else CLOSE)
        assert stiffness == pytest.approx(row[9], rel=1e-8 if by_curve else CLOSE)


@pytest.mark.parametrize("language", RUNNERS)
@pytest.mark.parametrize("stem", EXPORTED)
def test_an_export_gives_the_vectors(language, stem, tmp_path):
    case = Case(stem)
    for answer, wanted in zip(RUNNERS[language](case, tmp_path), case.answers, strict=True):
        np.testing.assert_allclose(answer, wanted, rtol=CLOSE)


@pytest.mark.parametrize("stem", EXPORTED)
def test_an_fmu_gives_the_vectors(stem, tmp_path):
    fmpy, case = require_package("fmpy"), Case(stem)
    require_program("gcc")
    path = tmp_path / "law.fmu"
    path.write_bytes(export(case.law, case.contact, "fmu"))
    variables = fmpy.read_model_description(path, validate=True).modelVariables
    assert [v.name for v in variables] == [*case.arguments, "load", "stiffness"]
    assert [v.causality for v in variables[:2]] == ["input", "parameter"]
    unit, given = started(path, tmp_path / "unpacked"), range(len(case.arguments))
    for row, answers in zip(case.each_row(), case.answers.T, strict=True):
        unit.setReal(given, row)
        results = unit.getReal([len(row), len(row) + 1])
        np.testing.assert_allclose(results, answers, rtol=CLOSE)


def test_octave_gives_the_vectors(tmp_path):
    cases = {stem: Case(stem) for stem in EXPORTED}
    for stem, answers in run_octave(cases, tmp_path).items():
        np.testing.assert_allclose(answers, cases[stem].answers, rtol=CLOSE)
