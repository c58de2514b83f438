"""The ledger's key numbers again, from Eqs 1, 5, 6, 7, 8 and 9 in plain Python, and finer grids."""

import math

import numpy as np
import pytest
from cylcontact.reports.claims.domain import JOHNSON_ONLY, MODERATE, PRACTICAL, difference
from cylcontact.reports.claims.extremes import best_load, largest_difference, share_below
from cylcontact.reports.claims.power_fits import TRAINING_LOADS, fit_at
from scipy.optimize import minimize

from cylcontact.materials import shipped_materials
from cylcontact.reports.claims import Claim, ledger

ROWS = shipped_materials()
MATERIALS = {name: row.material for name, row in ROWS.items()}


@pytest.fixture(scope="module")
def by_id() -> dict[str, Claim]:
    return {claim.id: claim for claim in ledger(ROWS)}


def e_star(E: float, nu: float) -> float:
    return E / (2 * (1 - nu**2))


def johnson(f: float, Es: float, dR: float) -> float:
    return f / (math.pi * Es) * (math.log(4 * math.pi * Es * dR / f) - 1)


def enhanced(f: float, Es: float, dR: float) -> float:
    Y = 1.51 * math.log(1000 * dR) ** -0.151 if dR <= 0.34954 else 0.0151 * dR + 1.151
    n = Y * dR**-0.005
    return (f * dR / ((0.965 * dR + 0.0965) * Es)) ** (1 / n)


def eq9(f: float, Es: float, dR: float) -> float:
    return 100 * (enhanced(f, Es, dR) / johnson(f, Es, dR) - 1)


def top_load(Es: float, dR: float, yield_stress: float, highest: float = 1000.0) -> float:
    at_yield = math.pi * yield_stress**2 * 10 * (10 - dR) / dR / Es
    return min(highest, at_yield, 4 * math.pi * Es * dR / math.e**2)


def plain_fit(loads: list[float], Es: float, dR: float) -> tuple[float, float]:
    x = [math.log(johnson(f, Es, dR)) for f in loads]
    y = [math.log(f) for f in loads]
    mx, my = sum(x) / len(x), sum(y) / len(y)
    n = sum((a - mx) * (b - my) for a, b in zip(x, y, strict=True)) / sum((a - mx) ** 2 for a in x)
    return math.exp(my - n * mx), n


def test_fig2_from_the_equations():
    Es = e_star(207e3, 0.3)
    K, n = plain_fit([1, *range(10, 1001, 10)], Es, 0.05)
    assert f"{K:.0f} {n:.4f}" == "312148 1.2370"
    K, n = plain_fit([1, *range(100, 10001, 100)], Es, 140.0)
    assert f"{K:.1f} {n:.5f}" == "44974.9 1.09392"


def test_limits_from_the_equations():
    limit = 4 * math.pi / math.e**2
    assert round(limit * e_star(69e3, 0.33) * 0.0075) == 494
    assert round(limit * e_star(69e3, 0.33) * 0.010) == 658
    assert round(limit * e_star(120e3, 0.34) * 0.0075) == 865


def test_switch_point_by_bisection():
    low, high = 0.1, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        if 1.51 * math.log(1000 * middle) ** -0.151 > 0.0151 * middle + 1.151:
            low = middle
        else:
            high = middle
    assert f"{low:.5f}" == "0.34954"


def fractions(count: int) -> list[float]:
    return [i / (count - 1) for i in range(count)]


@pytest.mark.parametrize("name", MATERIALS)
@pytest.mark.parametrize(
    ("claim_id", "lowest", "highest"),
    [
        ("3.4-below-8-percent", 10.0, 1000.0),
        ("3.4-below-4-percent", 10**1.5, 10**2.5),
    ],
)
def test_largest_differences_from_the_equations(by_id, name, claim_id, lowest, highest):
    material = MATERIALS[name]
    Es = e_star(material.E, material.nu)
    found = by_id[claim_id].ours_values
    largest = 0.0
    for u in fractions(241):
        dR = min(0.0075 * (2 / 0.0075) ** u, 2.0)
        top = top_load(Es, dR, material.yield_stress, highest)
        for v in fractions(81) if top > lowest else []:
            largest = max(largest, abs(eq9(lowest * (top / lowest) ** v, Es, dR)))
    reported = abs(found[f"{name}, percent"])
    # The plain grid can only miss the top; it comes within its own resolution of it.
    assert largest <= reported * (1 + 1e-12)
    assert largest == pytest.approx(reported, rel=0.02)
    dR, load = found[f"{name}, dR, mm"], found[f"{name}, load, N/mm"]
    assert eq9(load, Es, dR) == pytest.approx(found[f"{name}, percent"], rel=1e-9)
    assert lowest <= load <= top_load(Es, dR, material.yield_stress, highest) * (1 + 1e-12)


def test_trough_by_an_optimiser(by_id):
    Es = e_star(200e3, 0.3)
    found = minimize(
        lambda x: eq9(math.exp(x[0]), Es, math.exp(x[1])),
        [math.log(100), math.log(0.02)],
        method="Nelder-Mead",
        options={"xatol": 1e-9, "fatol": 1e-12},
    )
    values = by_id["3.4-peak-near-25um"].ours_values
    assert found.fun == pytest.approx(values["difference, percent"], rel=1e-10)
    assert math.exp(found.x[1]) == pytest.approx(values["dR, mm"], rel=1e-5)
    assert math.exp(found.x[0]) == pytest.approx(values["low-carbon steel, N/mm"], rel=1e-5)


def test_difference_at_25_um_from_the_equations(by_id):
    Es = e_star(200e3, 0.3)
    loads = [10 ** (1.5 + i / 2000) for i in range(2001)]
    largest = max((eq9(f, Es, 0.025) for f in loads), key=abs)
    values = by_id["3.4-about-8-percent-at-25um"].ours_values
    assert values["low-carbon steel, percent"] == pytest.approx(largest, rel=1e-6)


def test_lankarani_nikravesh_is_softest_as_a_closed_form_says(by_id):
    # With f = 4πE*ΔR·exp(−l), F/(L·f) = (4/3)·√(R·δ)·(l − 1)/(π·L) is largest at l = 4, where
    # it is (8/π)·√3·e⁻²·√(R_i·R_j)/L; R_j is nearly R_i where that load is in the domain.
    largest = 8 / math.pi * math.sqrt(3) * math.exp(-2)
    values = by_id["2-lankarani-nikravesh-softer"].ours_values
    for name in MATERIALS:
        assert values[f"{name}, largest, -"] == pytest.approx(largest, rel=1e-3)


def test_exponent_of_the_yield_load_from_eq_7():
    def load(E, stress):
        return math.pi * stress**2 * 10 / e_star(E, 0.3)

    assert load(400e3, 250) / load(200e3, 250) == pytest.approx(1 / 2)
    assert load(200e3, 500) / load(200e3, 250) == pytest.approx(4)


# --- convergence ---


@pytest.mark.parametrize("domain", [PRACTICAL, MODERATE, JOHNSON_ONLY], ids=lambda d: d.label)
@pytest.mark.parametrize("name", MATERIALS)
def test_no_finer_grid_finds_a_larger_difference(name, domain):
    material = MATERIALS[name]
    found = largest_difference(material, domain)
    u, v = np.linspace(0, 1, 1501), np.linspace(0, 1, 501)
    dR, load = domain.point(u[:, None], v[None, :], material)
    largest = np.nanmax(np.abs(difference(dR, load, material)))
    assert largest <= abs(found.percent) * (1 + 1e-12)
    assert largest == pytest.approx(abs(found.percent), rel=3e-3)


@pytest.mark.parametrize("name", MATERIALS)
def test_best_load_is_no_artefact_of_its_grid(name):
    material = MATERIALS[name]
    found = best_load(material, PRACTICAL)
    dR = np.union1d(np.geomspace(0.0075, 2, 3001), 0.34954)
    top = PRACTICAL.top_load(dR, material)
    for load in np.geomspace(10, 1000, 151):
        worst = np.abs(difference(dR[load <= top], load, material)).max()
        assert worst >= abs(found.percent) - 1e-3
    assert abs(found.percent) > 4


def test_shares_are_those_of_random_points():
    # Points drawn uniformly on logarithmic axes over the whole rectangle; those beyond the
    # highest load are not in the domain.
    material = MATERIALS["low-carbon steel"]
    rng = np.random.default_rng(1)
    dR = 0.0075 * (2 / 0.0075) ** rng.random(400_000)
    load = 10 * 100 ** rng.random(400_000)
    inside = load <= PRACTICAL.top_load(dR, material)
    below = np.abs(difference(dR[inside], load[inside], material)) < 8
    # Four standard errors of the share.
    assert share_below(8.0, material, PRACTICAL) == pytest.approx(100 * below.mean(), abs=0.2)


def test_exponent_depends_on_the_product_of_modulus_and_clearance_only():
    n = fit_at("internal", 0.2, 100e3, TRAINING_LOADS).n
    assert fit_at("internal", 0.1, 200e3, TRAINING_LOADS).n == pytest.approx(n, rel=1e-12)


def test_share_of_the_box_served_by_one_exponent_from_the_box_itself(by_id):
    Es = [e_star(20.7e3 * (10000 / 20.7) ** u, 0.3) for u in fractions(41)]
    loads = [10 ** (1 + i / 20) for i in range(41)]
    good = []
    for u in fractions(41):
        dR = 0.05 * 200**u
        for modulus in Es:
            inside = [f for f in loads if f <= 4 * math.pi * modulus * dR / math.e**2]
            x = np.log([johnson(f, modulus, dR) for f in inside])
            y = np.log(inside)
            residual = (y - 1.125 * x) - np.mean(y - 1.125 * x)
            good.append(1 - residual @ residual / np.sum((y - y.mean()) ** 2) > 0.998)
    served = by_id["3.1-internal-no-single-n"].ours_values["served, percent"]
    # A cell of this grid in four is on the boundary's staircase.
    assert served == pytest.approx(100 * np.mean(good), abs=1.5)
