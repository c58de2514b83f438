"""Several tables in one fit: the same numbers as in one table, and what is missing at once."""

import json
import shlex

import numpy as np
import pytest

import cylcontact as cc
from cylcontact.fitting import DataFit
from tests.support.machine_files import DEPTH, LENGTH, LOAD, OPTIONS, rows
from tests.support.noisy_series import PAIR

CUT = 4
NOISY = DEPTH * (1 + 0.003 * np.cos(7.0 * np.arange(DEPTH.size)))


@pytest.fixture
def tables(tmp_path):
    """Readings in one table, and in two of different units."""
    one, first, second = (tmp_path / name for name in ("one.csv", "a.csv", "b.txt"))
    groups = ["a.csv"] * CUT + ["b.txt"] * (DEPTH.size - CUT)
    one.write_text("F [N],w [mm],file\n" + rows(LOAD, NOISY, groups))
    first.write_text("F [N],w [mm]\n" + rows(LOAD[:CUT], NOISY[:CUT]))
    second.write_text("w [nm];F [kN]\n" + rows(NOISY[CUT:] * 1e6, LOAD[CUT:] / 1e3, separator=";"))
    return one, first, second


def test_two_files_are_fitted_as_their_rows_in_one(tables):
    one, *parts = tables
    whole, both = (cc.fit(each, "explicit", PAIR, starts=1) for each in (one, parts))
    assert both.coefficients == pytest.approx(whole.coefficients, rel=1e-9)
    for name in ("stiffness_factor", "offset"):
        ends = (
            getattr(fit.estimates[name], end) for fit in (whole, both) for end in ("low", "high")
        )
        low, high, low_both, high_both = ends
        assert (low_both, high_both) == pytest.approx((low, high), rel=1e-6)


def test_each_file_may_be_a_series(tables):
    one, *parts = tables
    whole, both = (cc.fit(each, "explicit", PAIR, group="file", starts=1) for each in (one, parts))
    assert both.coefficients == pytest.approx(whole.coefficients, rel=1e-9)
    assert both.data.groups("group")[0] == ["a.csv", "b.txt"]


@pytest.mark.usefixtures("tables")
def test_a_campaign_names_several_tables(tmp_path):
    text = """data = ["a.csv", "b.txt"]
law = "explicit"
contact = "internal"
exclude = ["b.txt:3"]
[constants]
E_GPa = 207
nu = 0.3
R_i_mm = 10
R_j_mm = 9.97
length_mm = 20
"""
    (tmp_path / "mine.toml").write_text(text)
    campaign = cc.fitting.Campaign.read(tmp_path / "mine.toml")
    assert [campaign.data.line(k) for k in (0, CUT, CUT + 1)] == ["a.csv:2", "b.txt:2", "b.txt:4"]
    assert campaign.spec.exclude == ("b.txt:3",)
    (tmp_path / "mine.toml").write_text(text.replace('b.txt"', 'c.txt"', 1))
    with pytest.raises(cc.InputError, match=r"data = 'c\.txt': no such file beside the campaign"):
        cc.fitting.Campaign.read(tmp_path / "mine.toml")


def test_the_command_fits_several_tables_and_its_result_is_read_again(tables, run):
    _, *parts = tables
    options = (*OPTIONS, "--length", LENGTH, "--law", "explicit", "-j", 1, "--runs", 1)
    code, out, errors = run("fit", *parts, *options, "--exclude", "a.csv:3")
    assert (code, errors) == (0, "")
    assert "left out: 1 row excluded (line 3)" in out
    result = DataFit.read(parts[0].parent / "results/a+b/result.json")
    assert len(result.data) == DEPTH.size - 1
    assert result.settings["campaign"]["exclude"] == ["a.csv:3"]
    assert result.settings["campaign"]["data"] == ["a.csv", "b.txt"]
    code, out, _ = run("verify", parts[0].parent / "results/a+b/result.json")
    assert (code, "0 checks do not hold" in out) == (0, True)


def test_an_outlier_is_named_so_that_it_can_be_left_out(tables):
    _, *parts = tables
    lines = parts[1].read_text().splitlines()
    depth, load = lines[2].split(";")
    lines[2] = f"{1.3 * float(depth)!r};{load}"
    parts[1].write_text("\n".join(lines))
    fitted = cc.fit(parts, "explicit", PAIR, starts=1)
    assert fitted.outliers == ["b.txt:3"]
    without = cc.fit(parts, "explicit", PAIR, exclude=["b.txt:3"], starts=1)
    assert not without.outliers
    assert "(exclude=['b.txt:3'])" in " ".join(str(fitted).split())


# --- what is missing ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("command", "own"),
    [
        ("fit", "the law, the contact"),
        ("plan", "the law, the contact, the loads to choose from"),
        ("choose", "the contact"),
    ],
)
def test_all_that_is_missing_is_said_at_once_and_the_offered_options_run(tables, run, command, own):
    one, *_ = tables
    code, _, errors = run(command, one)
    assert code == 2
    assert f"lacks {own}, the materials, the radii and the length; add your own" in errors
    offered = shlex.split(errors.partition("e.g. ")[2].partition(", or columns")[0])
    laws = ("--law", "johnson") if command == "choose" else ()
    code, out, errors = run(command, one, *offered, *laws)
    assert (code, errors) == (0, "")
    assert out


def test_what_is_given_is_not_missing(tables, run):
    errors = run("fit", tables[0], "--pin", "ceramics", "--Ri", 10, "--length", 5)[2]
    lacks = "lacks the law, the material of the hole and the other radius"
    assert (
        f"{lacks}; add your own, e.g. --law explicit --hole 'low-carbon steel' --Rj 9.97" in errors
    )
    with pytest.raises(cc.InputError, match="is an empty list; give at least one table"):
        cc.fit([], "explicit", PAIR)


def test_the_options_of_the_pair_are_in_a_panel_of_their_own(run):
    for command in ("fit", "choose", "plan"):
        shown = run(command, "--help")[1]
        assert "The pair of cylinders" in shown
        assert all(
            option in shown for option in ("--contact", "--pin", "--Ri", "--length", "--R-o")
        )
        assert "--plane" not in shown  # no fit takes it


def test_a_result_of_several_files_holds_their_hashes(tables, tmp_path):
    _, *parts = tables
    result = cc.fit(parts, "explicit", PAIR, starts=1)
    result.save(tmp_path / "fit.json")
    stored = json.loads((tmp_path / "fit.json").read_text())["settings"]["measurements"]
    assert stored["source"] == "a.csv, b.txt"
    assert len(set(stored["sha256"].split(", "))) == 2
