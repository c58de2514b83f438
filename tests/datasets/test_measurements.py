"""Tables of measurements: every unit, every way to give a pair, every way to go wrong."""

import numpy as np
import pytest

from cylcontact import InputError
from cylcontact.bodies.material import COLUMNS
from cylcontact.datasets.measurements import measurements_of, read_measured
from cylcontact.datasets.reading import TableSpec
from cylcontact.fitting import fit_table
from cylcontact.fitting.campaign import Campaign
from tests.support.measured_files import (
    CONSTANTS,
    campaign_of_table,
    write_measured,
    write_table,
)

GOOD = {
    "load_N_per_mm": [10.0, 20.0, 40.0],
    "penetration_um": [0.2, 0.4, 0.7],
    "dR_um": [50.0, 50.0, 80.0],
    "E_GPa": [207.0, 207.0, 69.0],
    "nu": [0.3, 0.3, 0.33],
}


def measured(path, contact="internal", constants=None, materials=None):
    return measurements_of(read_measured(path, contact, constants, materials), str(path))


def without(*names):
    return {name: column for name, column in GOOD.items() if name not in names}


# A physical table of two rows in mm, N and MPa.
PLAIN = {
    "load_N_per_mm": [10.0, 20.0],
    "penetration_mm": [2e-4, 4e-4],
    "R_i_mm": [10.0, 10.0],
    "R_j_mm": [9.9, 9.8],
    "E_i_MPa": [2e5, 2e5],
    "nu_i": [0.3, 0.3],
    "E_j_MPa": [7e4, 7e4],
    "nu_j": [0.33, 0.33],
    "length_mm": [10.0, 10.0],
}
# --- what is read -----------------------------------------------------------------------------


def test_columns_come_out_in_mm_newton_and_megapascal(tmp_path):
    actual = measured(write_table(tmp_path / "t.csv", GOOD))
    assert actual.load == pytest.approx([10, 20, 40])
    assert actual.penetration == pytest.approx([2e-4, 4e-4, 7e-4])
    assert actual.pair.dR == pytest.approx([0.05, 0.05, 0.08])
    assert actual.pair.E_star == pytest.approx(
        [207e3 / 1.82, 207e3 / 1.82, 69e3 / (2 * (1 - 0.33**2))]
    )
    unlike = measured(write_table(tmp_path / "t.csv", PLAIN)).pair
    assert 1 / unlike.E_star == pytest.approx([(1 - 0.3**2) / 2e5 + (1 - 0.33**2) / 7e4] * 2)


def test_constants_stand_for_columns(tmp_path):
    table = write_table(tmp_path / "t.csv", without("E_GPa", "nu", "dR_um"))
    constants = {"E_MPa": 207e3, "nu": 0.3, "R_i_mm": 10, "R_j_mm": 9.95}
    actual = measured(table, constants=constants)
    assert actual.pair.dR == pytest.approx([0.05] * 3)
    assert actual.pair.R_j == pytest.approx([9.95] * 3)
    force = write_table(tmp_path / "f.csv", {**without("load_N_per_mm"), "load_N": [100, 200, 400]})
    assert measured(force, constants={"length_mm": 10.0}).load == pytest.approx([10, 20, 40])


def test_materials_are_looked_up_and_their_provenance_kept(tmp_path):
    names = ["low-carbon steel", "titanium alloy", "low-carbon steel"]
    columns = {**without("E_GPa", "nu"), "material_i": names}
    table = write_table(tmp_path / "t.csv", columns)
    data = read_measured(table, "internal", {"material_j": "aluminium alloy"})
    actual = measurements_of(data, "t")
    assert actual.columns["E_i"] == pytest.approx([200e3, 120e3, 200e3])
    assert actual.columns["E_j"] == pytest.approx([69e3] * 3)
    assert any("titanium alloy" in note and "derived" in note for note in data.notes)
    assert actual.groups("material")[0] == [
        "low-carbon steel on aluminium alloy",
        "titanium alloy on aluminium alloy",
    ]


def test_materials_of_ones_own_stand_beside_those_that_ship(tmp_path):
    path = write_table(tmp_path / "t.csv", without("E_GPa", "nu"))
    own = tmp_path / "own.csv"
    own.write_text(f"{','.join(COLUMNS[:8])}\ngunmetal,110,assumed,0.34,assumed,,,\n")
    pair = {"material_i": "Gunmetal", "material_j": "ceramics"}
    data = read_measured(path, "internal", pair, own)
    assert data.labels["material_i"] == ["gunmetal"]
    assert (data.numbers["E_i"], data.numbers["E_j"]) == ([110e3], [600e3])
    assert "E and ν of gunmetal are from own.csv" in data.notes[1]
    with pytest.raises(InputError, match=r"material = 'Bell metal': is not in own\.csv"):
        measured(path, constants={"material": "Bell metal"}, materials=own)


@pytest.mark.parametrize(
    ("contact", "given", "expected"),
    [
        ("internal", {"dR_mm": 0.5, "R_i_mm": 10}, (10, 9.5)),
        ("internal", {"dR_mm": 0.5, "R_j_mm": 10}, (10.5, 10)),
        ("external", {"dR_mm": 30, "R_i_mm": 10}, (10, 20)),
        ("external", {"dR_mm": 30, "R_j_mm": 10}, (20, 10)),
        ("external", {"R_i_mm": 10, "R_j_mm": 20}, (10, 20)),
    ],
)
def test_geometry_is_completed(tmp_path, contact, given, expected):
    table = write_table(tmp_path / "t.csv", without("dR_um"))
    pair = measured(table, contact, given).pair
    assert (pair.R_i[0], pair.R_j[0]) == pytest.approx(expected)
    sign = 1 if contact == "internal" else -1
    assert pair.dR == pytest.approx(pair.R_i - sign * pair.R_j)


def test_groups_and_duplicates(tmp_path):
    columns = {name: [*column, column[0]] for name, column in GOOD.items()}
    columns["group"] = ["a", "a", "b", "a"]
    actual = measured(write_table(tmp_path / "t.csv", columns))
    assert actual.groups("rows")[0] == ["line 2", "line 3", "line 4", "line 5"]
    assert actual.groups("group")[1].tolist() == [0, 0, 1, 0]
    assert actual.groups("dR")[0] == ["ΔR = 0.05 mm", "ΔR = 0.08 mm"]
    assert actual.groups("pair")[0][0] == "E = 207000 MPa, ΔR = 0.05 mm"
    assert actual.duplicates() == [[2, 5]]
    part = actual.take(np.array([3, 3, 1]))
    assert [part.line(k) for k in range(3)] == [5, 5, 3]
    with pytest.raises(InputError, match="over = 'moon': is unknown"):
        actual.groups("moon")


# --- every way to go wrong --------------------------------------------------------------------

E_NU = ("E_GPa", "nu")
# Columns dropped, columns added, constants, and what is said then.
BAD_COLUMNS = [
    (("nu",), {}, {}, ": nu: is required; add nu"),
    (("dR_um",), {}, {"R_i_mm": 10.0}, ": lacks the other radius; add your own, e.g. --Rj 9.97"),
    (("dR_um",), {}, {"R_j_mm": 10.0}, ": lacks the other radius; add your own, e.g. --Ri 10.03"),
    (E_NU, {}, {"material_j": "ceramics"}, ": lacks the material of the hole|--hole 'low-carbon"),
    (E_NU, {}, {}, ": lacks the materials; add your own, e.g. --material 'low-carbon"),
    ((), {"E_i_GPa": [1, 1, 1]}, {}, ": material of the hole: must be given once|E_i|--ignore"),
    ((), {}, {"E_MPa": 1.0}, ": constants.E_MPa = 1.0: E is given twice|keep one"),
    ((), {}, {"load_N": 1.0}, ": constants.load_N = 1.0: is not a known constant"),
    ((), {}, {"colour": 1.0}, ": constants.colour = 1.0: is not a known constant"),
    ((), {}, {"length_mm": "x"}, ": constants.length_mm = 'x': must be a number"),
    (E_NU, {}, {"material": 3.0}, ": constants.material = 3.0: must be a name"),
    (E_NU, {}, {"material": "gold"}, ": material = 'gold': is not in the table that ships"),
    (("dR_um",), {}, {}, ": lacks the radii|--Ri 10 --Rj 9.97|[constants] dR_um"),
    ((), {}, {"R_i_mm": 10.0, "R_j_mm": 9.0}, ": dR, R_i, R_j = |must be ΔR, ΔR and one"),
    ((), {}, {"R_i_mm": 0.01}, ", line 2: dR, R_i: |leave the pin's radius = -0.04 mm"),
    (("dR_um",), {}, {"R_i_mm": 9.0, "R_j_mm": 10.0}, ": R_i, R_j: |is not above|exchange"),
    (("nu",), {}, {"nu": 30}, ": constants.nu = 30: must lie in [0, 0.5]|mind its unit"),
    (("dR_um",), {}, {"dR_um": -1}, ": constants.dR_um = -1: must be positive|mind its unit"),
    (("load_N_per_mm",), {"load_N": [1, 2, 3]}, {}, ": lacks the length|--length 20|length_mm"),
    (
        ("penetration_um", "dR_um", *E_NU), {"gap": [1, 2, 3]}, {},
        ": lacks the penetration, the materials and the radii|e.g. --columns penetration_UNIT=gap"
        "|--material 'low-carbon steel' --Ri 10 --Rj 9.97|not read: 'gap'",
    ),
    (
        ("load_N_per_mm", "penetration_um"), {"Kraftwert [kN]": [1, 2, 3]}, {"length_mm": 10.0},
        ": lacks the load and the penetration|--columns 'load=Kraftwert [kN]'",
    ),
    *(
        ((), {column: [GOOD[column][0], value, value]}, {}, f", line 3: {key} = |1 more like it")
        for column, value, key in (
            *(("load_N_per_mm", -1.0, "load_N_per_mm"), ("dR_um", 0.0, "dR")),
            *(("E_GPa", 0.0, "E_i"), ("nu", 0.6, "nu_i"), ("nu", -0.1, "nu_i")),
        )
    ),
]  # fmt: skip


@pytest.mark.parametrize(("dropped", "added", "constants", "said"), BAD_COLUMNS)
def test_bad_columns_and_constants_are_told(tmp_path, dropped, added, constants, said):
    path = write_table(tmp_path / "t.csv", {**without(*dropped), **added})
    with pytest.raises(InputError) as caught:
        measured(path, constants=constants)
    start, *parts = said.split("|")
    assert str(caught.value).startswith(f"{path}{start}")
    assert all(part in str(caught.value) for part in parts)


# --- campaigns --------------------------------------------------------------------------------


def campaign_on(tmp_path, columns, law="power", **settings):
    """The campaign of a law on a table of these columns."""
    table = write_table(tmp_path / "t.csv", columns)
    return campaign_of_table(table, law, "internal", {}, **settings)


def test_the_noise_follows_the_standard_deviations(tmp_path):
    of_load, of_depth = {"load_std_N_per_mm": [1] * 3}, {"penetration_std_um": [1] * 3}
    for added, settings, noise in (
        ({}, {}, "both"),
        (of_load, {}, None),
        (of_depth, {}, None),
        ({}, {"noise": "constant"}, "constant"),
        ({}, {"noise": "proportional"}, "proportional"),
        (of_load | of_depth, {}, None),
    ):
        assert campaign_on(tmp_path, {**GOOD, **added}, **settings).noise.noise == noise


def test_a_nanometre_about_zero_does_not_change_the_noise(tmp_path):
    """A reading that passes zero by 0.5 nm once changed the noise model, and the stiffness."""
    table = write_measured(tmp_path / "t.csv", "explicit", "internal", noise=0.01)
    rows = [line.split(",") for line in table.read_text().splitlines()]
    fits = []
    for first in ("0.0005", "-0.0005"):
        rows[1][2] = first
        table.write_text("\n".join(map(",".join, rows)) + "\n")
        fits.append(fit_table(campaign_of_table(table, "explicit", "internal", CONSTANTS)))
    ends = [(e.low, e.value, e.high) for e in (fit.estimates["stiffness_factor"] for fit in fits)]
    assert ends[0] == pytest.approx(ends[1], rel=2e-3)


def test_keys_of_a_campaign_and_options_say_the_same(tmp_path):
    rows = zip(np.geomspace(0.2, 4, 8), np.geomspace(0.2, 4, 8) ** 0.9, strict=True)
    lines = [f"{f:.5f};{d:.5f};A{k % 2}".replace(".", ",") for k, (f, d) in enumerate(rows)]
    (tmp_path / "t.csv").write_text("\n".join(["Kraft;Weg;Probe", *lines, *lines[::-1][2:]]))
    campaign = tmp_path / "c.toml"
    campaign.write_text(
        'data = "t.csv"\ncontact = "internal"\nlaw = "power"\ngroup = "Probe"\nbranch = "loading"\n'
        "[constants]\nE_MPa = 207000.0\nnu = 0.3\ndR_mm = 0.03\nlength_mm = 20.0\n"
        '[columns]\nload_kN = "Kraft"\npenetration_um = "Weg"\n'
    )
    read = Campaign.read(campaign)
    constants = {"E_MPa": 207e3, "nu": 0.3, "dR_mm": 0.03, "length_mm": 20.0}
    columns = {"load_kN": "Kraft", "penetration_um": "Weg"}
    keywords = {"columns": columns, "group": "Probe", "branch": "loading"}
    data = read_measured(tmp_path / "t.csv", "internal", constants, spec=TableSpec(**keywords))
    assert read.data.data == data
    assert data.labels["group"] == ["A0", "A1"] * 4
