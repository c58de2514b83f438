"""Claims: verdicts from readings, and the committed table against the paper's equations."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from mpmath import mp, mpf

from cylcontact import InputError
from cylcontact.reports.claims import DEPENDS, FAILS, claims_of, to_table
from tests.support import paper_equations as paper
from tests.support.report_files import CLAIMS

ROOT = Path(__file__).resolve().parents[2]
COMMITTED = ROOT / "reports" / "claims.csv"
E_STEEL = paper.e_star(207e3, 0.3)
MATERIALS = {
    "ceramics": (600e3, 0.24, 350),
    "high-strength steel": (207e3, 0.3, 1000),
    "low-carbon steel": (200e3, 0.3, 250),
    "titanium alloy": (120e3, 0.34, 830),
    "aluminium alloy": (69e3, 0.33, 276),
}


@pytest.fixture(scope="module")
def ledger():
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(ROOT)
        return claims_of(ROOT)


@pytest.fixture
def ours(ledger):
    """What a claim's readings say, by a part of the claim's text."""

    def of(part):
        (chosen,) = (each for each in ledger if part in each.statement)
        return {how: text for how, text, _ in chosen.readings}

    return of


def test_the_committed_table_is_what_the_claims_say(ledger):
    table = pd.read_csv(COMMITTED, dtype={"section": str, "printed": str, "ours": str})
    now = to_table(ledger)
    for column in ("section", "claim", "printed", "verdict", "reading", "holds"):
        assert table[column].tolist() == now[column].tolist()
    numbers = re.compile(r"-?\d+\.?(\d*)")
    for was, text in zip(table["ours"], now["ours"], strict=True):
        for one, other in zip(numbers.finditer(was), numbers.finditer(text), strict=True):
            # Another processor may round another last digit.
            assert abs(float(one[0]) - float(other[0])) < 1.1 * 10.0 ** -len(other[1]), text


def test_verdicts_follow_from_the_readings(tmp_path):
    (tmp_path / "reports").mkdir()
    (tmp_path / "reports/claims.py").write_text(CLAIMS)
    first, second = claims_of(tmp_path)
    assert (first.verdict, second.verdict) == (DEPENDS, FAILS)
    (tmp_path / "reports/claims.py").write_text(CLAIMS.replace("1 + 1 == 2", "int('x')"))
    with pytest.raises(InputError, match="sum_of_ones: failed with ValueError"):
        claims_of(tmp_path)
    with pytest.raises(InputError, match="does not exist; run this where it is"):
        claims_of(tmp_path / "elsewhere")


# --- second derivations ---


def test_fig_2(ours):
    K, n = paper.power_fit([1, *range(10, 1001, 10)], E_STEEL, 0.05)
    assert f"K = {K:.1f}, n = {n:.5f}" in ours("ΔR = 50 µm has these").values()
    K, n = paper.power_fit([1, *range(100, 10001, 100)], E_STEEL, 140.0)
    assert f"K = {K:.1f}, n = {n:.5f}" in ours("ΔR = 140 mm").values()


def test_the_switch_of_Y(ours):
    mp.dps = 30
    root = mp.findroot(
        lambda x: (
            mpf("1.51") * mp.log(1000 * x) ** mpf("-0.151") - mpf("0.0151") * x - mpf("1.151")
        ),
        0.35,
    )
    assert list(ours("Y passes").values()) == [f"{float(root):.7f} mm"]


def test_the_ends_of_johnsons_law(ours):
    (said,) = ours("At the least clearance").values()
    for name, (E, nu, _) in MATERIALS.items():
        assert f"{name} {paper.johnson_end(paper.e_star(E, nu), 0.0075):.0f}" in said


def test_the_largest_difference_up_to_yield(ours):
    said = next(iter(ours("less than 8 %").values()))
    for name, (E, nu, strength) in MATERIALS.items():
        E_star = paper.e_star(E, nu)
        dR = np.geomspace(0.0075, 2, 401)[:, None]
        top = np.minimum(1000.0, paper.johnson_end(E_star, dR))
        top = np.minimum(top, paper.yield_load(strength, E_star, paper.effective_radius(10.0, dR)))
        load = 10 * (top / 10) ** np.linspace(0, 1, 401)
        percent = paper.difference(load, E_star, dR)[top[:, 0] >= 10]
        largest = percent.flat[np.abs(percent).argmax()]
        shown = float(said.split(f"{name} ")[1].split(",")[0].removesuffix(" %"))
        assert shown == pytest.approx(largest, abs=0.15)


def test_moderate_loads_from_50_um(ours):
    said = next(iter(ours("At moderate loads they").values()))
    E_star = paper.e_star(600e3, 0.24)
    load = np.geomspace(10**1.5, 10**2.5, 401)
    percent = paper.difference(load, E_star, np.geomspace(0.05, 0.2, 401)[:, None])
    assert float(said.split("ceramics ")[1].split(",")[0]) == pytest.approx(percent.max(), abs=0.1)


def test_enhanced_against_johnson_under_20_newtons(ours):
    dR = np.geomspace(0.005, 1.5, 4001)
    off = np.abs(paper.difference(20.0, E_STEEL, dR))
    said = ours("Finite elements and the two laws")["enhanced against Johnson, 20 N/mm"]
    assert said == f"{off.max():.1f} % and {off[dR >= 0.445].max():.1f} %"


def test_growth_at_small_clearances(ours):
    said = next(iter(ours("the more the softer").values()))
    for name, (E, nu, _) in MATERIALS.items():
        E_star = paper.e_star(E, nu)
        top = min(1000.0, paper.johnson_end(E_star, 0.0075))
        half, whole = (abs(paper.difference(share * top, E_star, 0.0075)) for share in (0.5, 1))
        assert f"{name} {whole - half:+.0f}" in said
