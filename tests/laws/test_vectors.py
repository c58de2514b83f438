"""The law vectors: NumPy and every export against them, and two of them against mpmath."""

import json
from functools import cache, partial
from pathlib import Path

import numpy as np
import pytest
from mpmath import mp

from cylcontact.export import EXPORTABLE
from cylcontact.export.exported_law import exported
from cylcontact.laws import LAWS
from tests.support.export_runners import RUNNERS, run_octave
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
        answers = law.load(row[7], pair), law.stiffness(row[7], pair)
        assert answers == pytest.approx(tuple(row[8:]), rel=CLOSE)


@pytest.mark.parametrize("language", RUNNERS)
@pytest.mark.parametrize("stem", EXPORTED)
def test_an_export_gives_the_vectors(language, stem, tmp_path):
    case = Case(stem)
    for answer, wanted in zip(RUNNERS[language](case, tmp_path), case.answers, strict=True):
        np.testing.assert_allclose(answer, wanted, rtol=CLOSE)


def test_octave_gives_the_vectors(tmp_path):
    cases = {stem: Case(stem) for stem in EXPORTED}
    for stem, answers in run_octave(cases, tmp_path).items():
        np.testing.assert_allclose(answers, cases[stem].answers, rtol=CLOSE)


@pytest.mark.parametrize("stem", ["johnson-internal", "johnson-external", "liu-internal"])
def test_the_vectors_are_those_of_the_formula_in_forty_digits(stem):
    law, contact, rows = read(stem)
    with mp.workdps(40):
        for row in rows:
            E_i, nu_i, E_j, nu_j, R_i, R_j, _, depth, load, stiffness = map(mp.mpf, row)
            E_star = 1 / ((1 - nu_i**2) / E_i + (1 - nu_j**2) / E_j)
            dR = R_i - R_j if contact == "internal" else R_i + R_j
            if law == "liu":
                exact = E_star * mp.pi / 2 * depth * mp.sqrt(depth / (2 * (dR + depth)))
                slope = exact * (mp.mpf(3) / 2 / depth - 1 / (dR + depth) / 2)
            else:  # δ = f/(πE*)·(ln(ΛE*/f) − 1), Λ = 4π·R_i^(2w_i)·R_j^(2w_j)·ΔR/(R_i·R_j)
                w_i = E_star * (1 - nu_i**2) / E_i
                big = 4 * mp.pi * R_i ** (2 * w_i) * R_j ** (2 - 2 * w_i) * dR / (R_i * R_j)
                exact = mp.findroot(partial(depth_error, E_star, big, depth), load)
                slope = mp.pi * E_star / (mp.log(big * E_star / exact) - 2)
            assert abs(load / exact - 1) < 1e-13
            assert abs(stiffness / slope - 1) < 1e-12


def depth_error(E_star, big, depth, f):
    return f / (mp.pi * E_star) * (mp.log(big * E_star / f) - 1) - depth
