"""The pages on laws: their numbers are computed."""

import math
import shutil
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from cylcontact import CylinderPair, InputError, Material, laws, limits
from cylcontact.impact import FACTORS, achieved_restitution
from cylcontact.laws.explicit import CALIBRATED
from cylcontact.reports import laws_bounds, laws_table
from cylcontact.reports.laws_bounds import johnson_end, johnson_shortfall
from cylcontact.reports.laws_table import case, comparison, deviations
from cylcontact.reports.laws_to_use import laws_to_use
from tests.support.paper_equations import e_star, enhanced, johnson

ROOT = Path(__file__).resolve().parents[2]
CHOICE, ACCURACY, FORMULAS, CALIBRATION = (
    (ROOT / "docs" / name).read_text(encoding="utf-8")
    for name in (
        "how-to/choose-a-law.md",
        "accuracy.md",
        "reference/formulas.md",
        "calibration.md",
    )
)

OWN = "mm, N, MPa"

# The pinned case.
E_STAR, DR, R_I, LENGTH, F = e_star(207e3, 0.3), 0.05, 10.0, 10.0, 100.0


def table(page: str, first: str) -> list[list[str]]:
    """Return the cells of the table of a page whose header begins so, below its two lines."""
    lines = page.split(f"\n{first}", 1)[1].split("\n\n", maxsplit=1)[0].splitlines()
    return [[cell.strip().strip("`") for cell in line.split("|")[1:-1]] for line in lines[2:]]


@pytest.fixture(scope="module")
def actual():
    return comparison(case(), F).set_index("law")


def test_the_pinned_case_has_every_law(actual):
    assert list(actual.index) == list(laws.LAWS)
    truth = actual.loc["persson", "penetration_um"]
    assert actual.loc["explicit", "penetration_um"] == pytest.approx(truth, rel=1e-3)
    assert actual["note"].eq("").all()


# --- the numbers in the page ---


def test_departures_are_where_they_are_said_to_be():
    steel = Material("steel", E=207e3, nu=0.3)
    clearances = (0.0075, 0.05, 0.5)
    for percent, number, *loads in table(ACCURACY, "| too low by"):
        phi = laws_bounds.departure_number(float(percent)) if float(percent) < 47 else johnson_end()
        assert f"{phi:.4f}" == number
        assert loads == [f"{phi * E_STAR * dR:.0f}" for dR in clearances]
        pair = CylinderPair.from_dR("internal", 0.3, steel)
        load = phi * E_STAR * 0.3 * (1 - 1e-12)
        ratio = laws.Johnson().penetration(load, pair) / laws.Persson().penetration(load, pair)
        assert f"{100 * (1 - ratio):.3g}" == percent


def test_explicit_table():
    error = laws_bounds.explicit_error()
    assert table(FORMULAS, "| contact | c |") == [
        [
            contact,
            *(f"{value:g}" for value in (constants.c, constants.A, constants.B)),
            laws_bounds.TRUTH[contact].name,
            f"fitting/explicit-{contact}.toml",
            "{:g} to {:g}".format(*laws_bounds.BOUNDED[contact]),
            f"{error[f'{contact} load']:.4f}",
            f"{error[f'{contact} penetration']:.4f}",
        ]
        for contact, constants in CALIBRATED.items()
    ]


def test_restitution_table():
    wanted = (0.1, 0.3, 0.5, 0.7, 0.9)
    rows = table(FORMULAS, "| factor |")
    assert [row[0] for row in rows] == list(FACTORS)
    for name, _, *cells in rows:
        assert cells == [f"{achieved_restitution(FACTORS[name](e)):.3f}" for e in wanted]


def test_the_table_to_choose_from():
    hole, rollers = (laws_to_use(contact, ROOT) for contact in ("internal", "external"))
    names = ["published", "refitted there", *hole["law"][2:]]
    expected = [
        [
            name,
            *(
                cell
                for rms, largest in (
                    (a.rms_johnson, a.max_johnson_percent),
                    (a.rms_conformal, a.max_conformal_percent),
                    (b.rms_johnson, b.max_johnson_percent),
                )
                for cell in (("0", "0") if rms < 1e-9 else (f"{rms:.4f}", f"{largest:.3g}"))
            ),
            f"{a.relative_time:.1f}",
        ]
        for name, a, b in zip(names, hole.itertuples(), rollers.itertuples(), strict=True)
    ]
    assert [*hole["units"]] == [*rollers["units"]] == [*2 * [OWN], "any", OWN, "any", "any"]
    assert table(CHOICE, "| law | hole, to Johnson |") == expected


def test_constants_are_those_of_the_fits():
    for contact in ("internal", "external"):
        used = laws_to_use(contact, ROOT).set_index("law")["constants"]
        for name in ("power-dimensionless", "power-clearance"):
            assert f"| {contact} | {used[name]} |" in FORMULAS
        for name in used.index[:2]:
            cells = " | ".join(part.split(" = ")[1] for part in used[name].split(", "))
            assert f"| {cells} |" in FORMULAS, name


def test_the_laws_to_use_are_right():
    """The errors once more, from the formulas and without samples, objectives or families."""
    table = laws_to_use("external", ROOT).set_index("law")
    E = np.geomspace(20.7e3, 1e7, 25)[:, None, None, None]
    nu = np.linspace(0.1, 0.5, 9)[:, None, None]
    dR, f = np.geomspace(5, 500, 61)[:, None], np.geomspace(10, 1000, 25)
    E_star = e_star(E, nu)
    deltas = {
        "published": enhanced(f, E_star, dR, "external"),
        "power-dimensionless": dR * (f / (0.580159106 * E_star * dR)) ** (1 / 1.084759742),
    }
    for name, delta in deltas.items():
        ratio = np.log(delta / johnson(f, E_star, dR))
        assert table["rms_johnson"][name] == pytest.approx(np.sqrt(np.mean(ratio**2)), rel=1e-6)
        largest = 100 * np.abs(np.expm1(ratio)).max()
        assert table["max_johnson_percent"][name] == pytest.approx(largest, rel=1e-6)
    assert table["rms_johnson"]["johnson"] < 1e-12


def test_laws_to_use_name_what_is_missing(tmp_path):
    with pytest.raises(InputError, match=r"practical\.json"):
        laws_to_use("internal", tmp_path)
    shutil.copytree(ROOT / "fitting/results", tmp_path / "fitting/results")
    (tmp_path / "datasets").mkdir()
    for contents in ('{"rows": []}', "{", "[1]", '{"rows": [3]}', "\0"):
        (tmp_path / "datasets/benchmarks.json").write_text(contents)
        with pytest.raises(InputError, match=r"benchmarks\.json: .*make bench"):
            laws_to_use("internal", tmp_path)


YIELDING = Material("steel", E=200e3, nu=0.3, yield_stress=250)


def safe_until(criterion):
    """f/(E*·ΔR) at yield where the paper's estimate equals first yield."""

    def miss(log_dR):
        pair = CylinderPair.from_dR("internal", np.exp(log_dR), YIELDING, R_i=10.0)
        return np.log(limits.yield_load(pair, criterion) / limits.yield_load(pair, "Hertz"))

    dR = np.exp(brentq(miss, np.log(0.01), np.log(2.0)))
    pair = CylinderPair.from_dR("internal", dR, YIELDING, R_i=10.0)
    return float(limits.yield_load(pair, criterion) / (pair.E_star * dR))


def snug_yield():
    """f/(σ_Y·R) at first yield of a close fit."""
    pair = CylinderPair.from_dR("internal", 0.005, YIELDING, R_i=10.0)
    return float(limits.yield_load(pair)) / (250 * 10.0)


def test_numbers_between_the_tables():
    error = laws_bounds.explicit_error()
    assert error["one-line penetration"] <= 0.37
    ten, end = laws_bounds.departure_number(10.0), johnson_end()
    for page, words in (
        (CHOICE, f"(φ = {end:.2f}). It is 10 % too stiff at φ = {ten:.2f}"),
        (CHOICE, f"and {johnson_shortfall(end):.0f} % at its end"),
        (ACCURACY, f"radii, {2 * math.sqrt(0.02 / math.pi):.2f} at φ = 0.02"),
        (ACCURACY, f"is below {safe_until('von Mises'):.2f} by von"),
        (ACCURACY, f"and {safe_until('Tresca'):.2f} by Tresca"),
        (ACCURACY, f"yields near f = {snug_yield():.1f}·σ_Y·R"),
        (FORMULAS, f"less than {float(achieved_restitution(0.75)):.3f}"),
    ):
        assert words in page


def test_what_the_datum_changes():
    steel, bronze = (Material.named(name) for name in ("high-strength steel", "bronze"))
    pair = CylinderPair.internal(R_i=10.0, R_j=9.95, pin=steel, hole=bronze)
    eye = laws.Housing(R_o=20.0, clamp=laws.Sector(60, side="far"))
    for datum in ("johnson", laws.Housing(R_o=100.0), eye):
        assert f"{1e3 * laws.Conformal(datum).penetration(1000.0, pair):.0f} µm" in ACCURACY


def test_the_table_of_all_laws(actual):
    pair = case()
    assert (pair.dR, pair.R_i, pair.length, laws_table.LOAD) == (DR, R_I, LENGTH, F)
    assert float(pair.E_star) == pytest.approx(E_STAR, rel=1e-15)
    away = deviations(pair)
    expected = [
        [
            name,
            f"{row.penetration_um:.5f}",
            *(_percent(away.loc[name, phi]) for phi in (0.01, 0.1, 1)),
        ]
        for name, row in actual.iterrows()
    ]
    rows = table(FORMULAS, "| law | | δ, µm |")
    assert [[name, *numbers] for name, _, *numbers in rows] == expected


def _percent(value: float) -> str:
    if math.isnan(value):
        return "–"
    return f"{value:+.2f}" if abs(value) >= 0.005 else "0"


# --- the command's text, and what it is asked ---


def test_notes_say_why_there_is_no_number():
    actual = comparison(case(dR=0.001), 3000.0).set_index("law")["note"]
    assert actual["johnson"] == "beyond its largest load"
    assert actual["enhanced"] == "undefined at this ΔR"
    short = CylinderPair.from_dR("internal", 0.05, Material("steel", E=207e3, nu=0.3))
    actual = comparison(short, F).set_index("law")["note"]
    assert "needs both radii" in actual["dubowsky-freudenstein"]
    assert "needs both radii" in actual["goldsmith"]


@pytest.mark.parametrize(
    ("option", "value"), [("--contact", "sideways"), ("--dR", "12"), ("--nu", "0.6")]
)
def test_a_case_that_is_none_is_refused(run, option, value):
    code, _, errors = run("laws", option, value)
    assert code == 2
    assert option in errors
