"""CalculiX: run where it is installed, and every way in which it can fail."""

from pathlib import Path

import numpy as np
import pytest

from cylcontact import InputError
from cylcontact.datasets.finite_element import Setup, read_table, solve
from cylcontact.datasets.finite_element.calculix import (
    SolverError,
    find_program,
    read_results,
    run_case,
    version,
)
from cylcontact.datasets.finite_element.calculix_deck import Deck
from tests.programs import fake_program, require_program

TABLES = Path(__file__).parents[1] / "datasets" / "finite_element"
SETUP = Setup(hole_radius=2.245, outer_ratio=3.3, E=207e3, nu=0.3, cells=8)
LOADS = np.array([20.0, 40.0, 100.0])
RESULTS = """
 displacements (vx,vy,vz) for set CENTRE and time  0.1000000E+01

         9  0.000000E+00  {first}  0.000000E+00

 stresses (elem, integ.pnt.,sxx,syy,szz,sxy,sxz,syz) for set TOP and time  0.1000000E+01

         1   1 -4.0E+02 -5.0E+02  0.0E+00  0.0E+00  0.0E+00  0.0E+00
         7   1 -4.0E+02 -5.2E+02  0.0E+00  0.0E+00  0.0E+00  0.0E+00

 displacements (vx,vy,vz) for set CENTRE and time  0.1000000E+01

         9  0.000000E+00  {second}  0.000000E+00
"""


@pytest.fixture(scope="module")
def ccx():
    """The program."""
    require_program("ccx")
    return find_program()


@pytest.mark.parametrize("dR", [0.01, 0.1, 1.0])
def test_penetration_of_nine_cases_is_the_embedded_solvers(ccx, dR):
    for case in solve(SETUP, dR, LOADS):
        actual = run_case(SETUP, dR, case.load, LOADS, ccx)
        assert actual.penetration == pytest.approx(case.penetration, rel=0.002)
        assert actual.peak_pressure == pytest.approx(case.peak_pressure, rel=0.01)
        assert actual.cells == case.mesh.cells


def test_plane_stress_by_its_equivalent_moduli(ccx):
    setup = Setup(2.245, 3.3, 207e3, 0.3, plane="stress", load_on="disc", clamp="whole", cells=8)
    (case,) = solve(setup, 0.01, [40.0])
    actual = run_case(setup, 0.01, 40.0, np.array([40.0]), ccx)
    assert actual.penetration == pytest.approx(case.penetration, rel=0.002)


def test_committed_table_is_reproduced(ccx):
    rows = read_table(TABLES / "recommended-calculix.csv").rows
    row = rows[(rows["dR_mm"] == 0.005) & (rows["load_N_per_mm"] == 100)].iloc[0]
    setup = Setup(hole_radius=2.245, outer_ratio=3.3, E=207e3, nu=0.3)
    actual = run_case(setup, 0.005, 100.0, LOADS, ccx)
    assert actual.penetration == pytest.approx(row["penetration_mm"], rel=1e-5)


def test_version_is_read_and_recorded(ccx):
    assert version(ccx)[0].isdigit()
    header = read_table(TABLES / "recommended-calculix.csv").header
    assert header["engine"].startswith("CalculiX 2.")


def test_missing_program_says_how_to_install_it(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(InputError, match="apt install calculix-ccx; or use --engine embedded"):
        find_program()


def test_a_program_that_states_no_version(tmp_path):
    assert version(str(fake_program(tmp_path, "ccx", "echo hello"))) == "unknown"
    assert version(str(tmp_path / "absent")) == "unknown"


@pytest.mark.parametrize(
    ("body", "reason", "last"),
    [
        ("echo first\necho '*ERROR in calinput'\nexit 201", "ended with code 201", "*ERROR"),
        ("echo working\nkill -9 $$", "was killed by signal 9", "working"),
        ("echo nothing to do", "wrote no results", "nothing to do"),
    ],
)
def test_failures_show_the_last_lines(tmp_path, body, reason, last):
    with pytest.raises(SolverError) as caught:
        run_case(SETUP, 0.1, 20.0, LOADS, str(fake_program(tmp_path, "ccx", body)))
    assert caught.value.reason == reason
    assert caught.value.lines[-1].startswith(last)


def test_results_are_read_from_the_last_step():
    text = RESULTS.format(first="4.000000E-04", second="4.000010E-04")
    assert read_results(text, Deck("", 1e-4)) == pytest.approx((5.00001e-4, 510.0))


def test_steps_that_disagree_have_not_settled():
    text = RESULTS.format(first="4.000000E-04", second="4.100000E-04")
    with pytest.raises(SolverError) as caught:
        read_results(text, Deck("", 1e-4))
    assert caught.value.reason == "has not settled: its steps give 0.5 µm, 0.51 µm"
