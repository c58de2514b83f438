"""Every option is the number that it says: command lines, and the calls that they stand for."""

import json
import shlex
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import cylcontact as cc
from cylcontact import laws
from cylcontact.files.writing import json_text
from cylcontact.fitting import choice, measure
from cylcontact.laws.user import user_law
from cylcontact.mechanism import read_mechanism, simulate
from cylcontact.reports.page import write_page
from cylcontact.support.errors import InputError
from tests.support.mechanism_cases import ROOT
from tests.support.noisy_series import PAIR

LOAD = np.geomspace(20.0, 400.0, 8)
DEPTH = 1e3 * laws.Explicit().penetration(LOAD, PAIR)
NAMES, UP = ("load_N", "w [µm]", "specimen", "x"), [*LOAD[:5], *LOAD[3::-1]]


def rows(separator=",", mark=".", sign=1.0, names=NAMES, load=LOAD, depth=DEPTH):
    cells = [(f"{20 * sign * f:.6f}", f"{d:.9f}", "AB"[k % 2], f"{k}")
             for k, (f, d) in enumerate(zip(load, depth, strict=True))]  # fmt: skip
    return "\n".join(separator.join(row).replace(".", mark) for row in [names, *cells]) + "\n"


FILES = {
    "plain.csv": rows(),
    "two lines.csv": f"a,b,c,d\n{rows()}",
    "bars.csv": rows("|"),
    "commas.csv": rows(";", ","),
    "negative.csv": rows(sign=-1.0),
    "back.csv": rows(load=UP, depth=[*DEPTH[:5], *DEPTH[3::-1]]),
    "other.csv": rows(names=("load_N", "Weg", "specimen", "x")),
}
NUMBERS = {"E_MPa": 207e3, "nu": 0.3}
RADII = {"R_i_mm": 10.0, "R_j_mm": 9.97, "length_mm": 20.0}
WORDS = {
    "E_MPa": "--E '207 GPa'", "nu": "--nu .3", "R_i_mm": "--Ri 10", "R_j_mm": "--Rj 9.97",
    "length_mm": "--length 20",
}  # fmt: skip
HOUSING = {
    "R_o": 20.0, "clamp": "sector", "angle": 60.0, "side": "pulled",
    "layers": [{"E": "70000.0 MPa", "nu": 0.33, "R_i": 14.0}],
}  # fmt: skip
SPREAD = {"dR": "2 um", "E": "5%"}
USUAL = {"law": "explicit", "contact": "internal"}
BODIES = {"E_i_MPa": 70e3, "nu_i": 0.33, "E_j_MPa": 207e3, "nu_j": 0.3}
# A file, words of a command line, settings, constants that they give, and those that they replace.
OF_FIT = [
    ("plain.csv", "--ignore x", {"ignore": ["x"]}),
    ("other.csv", "--columns penetration_um=Weg", {"columns": {"penetration_um": "Weg"}}),
    ("plain.csv", "--group specimen", {"group": "specimen"}),
    ("plain.csv", "--group specimen --drift", {"group": "specimen", "drift": True}),
    ("two lines.csv", "--header 2", {"header": 2}),
    ("bars.csv", "--separator bar", {"separator": "bar"}),
    ("latin.csv", "--encoding cp1252", {"encoding": "cp1252"}),
    ("commas.csv", "--decimal ,", {"decimal": ","}),
    ("book.xlsx", "--sheet second", {"sheet": "second"}),
    ("plain.csv", "--exclude 3,5", {"exclude": ["3", "5"]}),
    ("plain.csv", "--loads 900:5000", {"loads": "900:5000"}),
    ("negative.csv", "--sign load", {"sign": "load"}),
    ("back.csv", "--branch unloading", {"branch": "unloading"}),
    ("plain.csv", "--noise constant", {"noise": "constant"}),
    ("plain.csv", "--load-error 1%", {"load_error": 0.01}),
    ("plain.csv", "--load-error .02", {"load_error": 0.02}),
    ("plain.csv", "--uncertain 'dR=2 um' --uncertain E=5%", {"uncertain": SPREAD}),
    ("plain.csv", "--level .9", {"level": 0.9}),
    ("plain.csv", "--free compliance", {"free": ["compliance"]}),
    ("plain.csv", "--bound stiffness_factor=.5:2", {"bounds": {"stiffness_factor": (0.5, 2.0)}}),
    ("plain.csv", "--fix offset=.001", {"fixed": {"offset": 1e-3}}),
    ("plain.csv", "--tie offset=stiffness_factor/9", {"ties": {"offset": "stiffness_factor/9"}}),
    ("plain.csv", "--runs 3 --seed 0", {"starts": 3, "seed": 0}),
    ("plain.csv", "--R-o 20 --clamp pulled:60 --layer '70 GPa, .33:14' --law conformal",
     {"law": "conformal", "housing": HOUSING}),
    ("plain.csv", "--R-o 20 --clamp pushed:90 --law conformal",
     {"law": "conformal", "housing": {"R_o": 20.0, "clamp": "sector", "angle": 90.0,
      "side": "pushed"}}),
    ("plain.csv", "--material bronze", {}, {"material": "bronze"}, NUMBERS),
    ("plain.csv", "--hole '70 GPa, .33' --pin '207 GPa, .3'", {}, BODIES, NUMBERS),
    ("plain.csv", "--hole mine --pin bronze --materials mine.csv", {"materials": "mine.csv"},
     {"material_i": "mine", "material_j": "bronze"}, NUMBERS),
    ("plain.csv",
     "--contact external --material-i '70 GPa, .33' --material-j '207 GPa, .3' --Rj 30",
     {"contact": "external"}, BODIES | {"R_j_mm": 30.0}, (*NUMBERS, "R_j_mm")),
    ("plain.csv", "--radial-clearance '40 um'", {}, {"dR_mm": 0.04}, ("R_j_mm",)),
    ("plain.csv", "--hole-diameter 20 --pin-diameter 19.94", {}, {}, ()),
]  # fmt: skip


@pytest.fixture
def table(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "latin.csv").write_bytes(rows().encode("cp1252"))
    (tmp_path / "mine.csv").write_text("name,E_GPa,nu\nmine,70,0.33\n", encoding="utf-8")
    frame = pd.DataFrame({"load_N": 20 * LOAD, "w [µm]": DEPTH})
    with pd.ExcelWriter(tmp_path / "book.xlsx") as book:
        frame.head(5).to_excel(book, sheet_name="first", index=False)
        frame.to_excel(book, sheet_name="second", index=False)
    return tmp_path


@pytest.fixture
def taken(monkeypatch):
    """The campaigns that would be fitted; instead, the fit ends."""
    campaigns = []

    def end(campaign, *_):
        campaigns.append(campaign)
        raise InputError("test", "", None, "ends here", "")

    monkeypatch.setattr(measure, "fit_table", end)
    monkeypatch.setattr(choice, "choose_law", lambda table, law, *_: end(table.campaign(law[0])))
    return campaigns


@pytest.mark.parametrize("case", OF_FIT, ids=lambda case: case[1])
@pytest.mark.parametrize("command", ["fit", "choose", "plan --candidates 5:400"])
@pytest.mark.usefixtures("table")
def test_an_option_of_a_table_is_the_setting_of_its_name(command, case, run, taken):
    name, words, settings, constants, instead = (*case, {}, ())[:5]
    if command != "fit" and "--runs" in words:
        return
    radii = {"R_i_mm", "R_j_mm"} if "diameter" in words else {}
    line = [text for key, text in WORDS.items() if key not in {*instead, *radii}]
    line += [f"--{key} {value}" for key, value in USUAL.items() if f"--{key}" not in words]
    code, _, errors = run(*shlex.split(command), name, *shlex.split(" ".join([*line, words])))
    assert (code, "ends here" in errors) == (2, True), errors
    given = {key: value for key, value in (NUMBERS | RADII).items() if key not in instead}
    with pytest.raises(InputError, match="ends here"):
        cc.fit(name, constants=given | constants, **USUAL | settings)
    by_line, by_call = map(numbers_of, taken)
    for part, wanted in zip(by_line, by_call, strict=True):
        assert part == wanted


def numbers_of(campaign):
    """What a campaign is of: its table, its settings, its parameters."""
    spec = campaign.spec.model_dump()
    columns = {name: np.asarray(values).tolist() for name, values in campaign.data.columns.items()}
    return columns, spec | {"level": spec["level"] or 0.95}, campaign.parameters


# --- the other commands ---------------------------------------------------------------------------

CRANK = ROOT / "datasets/slider_crank.toml"
CHANGES = {"law": "johnson", "clearance": 0.04, "restitution": 0.8, "friction": 0.05}


def test_the_options_of_a_run_are_the_keys_of_its_file(run, tmp_path, monkeypatch):
    words = "--law johnson --radial-clearance '40 um' --restitution .8 --friction .05"
    words += " --revolutions 3 --first 1 --beyond tangent --tolerance 1e-8"
    monkeypatch.chdir(tmp_path)
    code, said, _ = run("simulate", CRANK, *shlex.split(words), "--json", "--table", "t.csv")
    mechanism = read_mechanism(CRANK, **CHANGES, tolerance=1e-8)
    wanted = simulate(mechanism, 3, beyond="tangent").statistics(1).to_dict()
    answer = json.loads(said)
    assert code == 0
    assert {name: answer[name] for name in wanted} == json.loads(json_text(wanted))
    code, said, _ = run("sweep", CRANK, *shlex.split(words), "--json", "-j", 1)
    (row,) = json.loads(said)["rows"]
    assert code == 0
    means = {each["quantity"]: each["mean"] for each in answer["means"] if each["mean"] is not None}
    assert len(means) > 10
    assert {name: row[name] for name in means} == pytest.approx(means, rel=1e-12)


def test_two_descriptions_of_rollers_have_one_answer(run):
    """Those of a pin in a hole are in test_joint."""
    one, other = (f"--contact external {R} --Rj 30" for R in ("--radial-clearance 45", "--Ri 15"))
    numbers = [
        json.loads(run("check", *shlex.split(words), "--material", "bronze", "--json")[1])[
            "numbers"
        ]
        for words in (one, other)
    ]
    known = [{k: v for k, v in n["joint"].items() if isinstance(v, float)} for n in numbers]
    assert known[0] == pytest.approx(known[1], rel=1e-9)


def test_a_table_of_joints_takes_materials_of_ones_own(run, table):
    (table / "joints.csv").write_text("R_i_mm,R_j_mm,hole,pin\n10,9.98,mine,bronze\n")
    line = ("check", "joints.csv", "--load", 100, "--materials", "mine.csv", "--json")
    (row,) = json.loads(run(*line)[1])
    mine = cc.Material("mine", 70e3, 0.33)
    pair = cc.CylinderPair.internal(10.0, 9.98, pin=cc.Material.named("bronze"), hole=mine)
    depth = 1e3 * laws.Conformal().penetration(100.0, pair)
    assert row["penetration_um"] == pytest.approx(float(depth), rel=1e-6)


def test_a_law_of_ones_own_is_a_row_of_the_comparison(run, monkeypatch):
    monkeypatch.chdir(ROOT / "tests/support")
    pair = "--pin '207 GPa, .3' --hole '207 GPa, .3' --Ri 10 --Rj 9.97 --load 200"
    code, said, _ = run("laws", "compare", "--own", "own_laws:power", *shlex.split(pair), "--json")
    row = next(row for row in json.loads(said)["rows"] if "own_laws" in row["law"])
    depth = user_law("own_laws:power", ROOT / "tests/support").penetration(200.0, PAIR)
    assert code == 0
    assert row["penetration_um"] == pytest.approx(1e3 * float(depth), rel=1e-9)


@pytest.mark.parametrize(("given", "mm"), [(70, 70), ("page", 190)])
def test_width_style_and_format_are_those_of_the_picture(run, table, monkeypatch, given, mm):
    monkeypatch.chdir(ROOT)
    style, out = table / "mine.mplstyle", table / "out"
    style.write_text("lines.linewidth: 7.25")
    where = ("--width", given, "--style", style, "--format", "svg", "-o", out)
    assert run("figure", "fig12", *where)[0] == 0
    assert {path.suffix for path in out.iterdir()} >= {".svg", ".csv"}
    assert not [*out.glob("*.png"), *out.glob("*.pdf")]
    text = (out / "fig12.svg").read_text("utf-8")
    width = float(text.split('width="')[1].split("pt")[0])
    assert width == pytest.approx(mm * 72 / 25.4, rel=1e-4)
    assert "stroke-width: 7.25" in text


def test_a_plan_takes_its_clearances(run, table):
    options = "--law explicit --contact internal --E 207000 --nu .3 --Ri 10 --length 20"
    options += " --radial-clearance .03"
    words = "--candidates '100:8000 N' --add 3 --radial-clearances '30 um,.06' --json"
    code, said, errors = run("plan", "plain.csv", *shlex.split(f"{options} {words} -o out"))
    assert (code, errors) == (0, "")
    constants = NUMBERS | {"R_i_mm": 10.0, "dR_mm": 0.03, "length_mm": 20.0}
    assert {path.suffix for path in (table / "out").iterdir()} == {".csv", ".png", ".pdf"}
    candidates = pd.read_csv(next((table / "out").glob("*.csv")), comment="#")
    loads = np.unique(candidates["load_N_per_mm"])
    assert loads == pytest.approx(np.geomspace(5, 400, 41), rel=1e-6)
    assert set(candidates["dR_mm"]) == {0.03, 0.06}
    fitted = cc.fit(table / "plain.csv", "explicit", contact="internal", constants=constants)
    wanted = fitted.plan(np.geomspace(5, 400, 41), 3, dR=[0.03, 0.06]).to_dict()
    assert json.loads(said) == json.loads(json_text(wanted))


def test_a_page_is_of_the_folders_that_are_named(run, table):
    (table / "results").mkdir()
    shutil.copy(ROOT / "fitting/results/internal.json", table / "results")
    (table / "drawn").mkdir()
    where = ("--results", "results", "--figures", "drawn", "-o", "page.html")
    code, _, errors = run("report", *where)
    assert code == 0
    wanted = write_page(Path("other.html"), Path(), Path("results"), Path("drawn"))
    assert errors.splitlines() == [f"missing: {what}" for what in wanted]
    assert (table / "page.html").read_bytes() == (table / "other.html").read_bytes()
