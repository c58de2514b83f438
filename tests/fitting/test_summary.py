"""Reports and verdicts on results made by hand, so that every sentence can be provoked."""

from cylcontact.fitting import LawFit, compare

AXES = {
    "E": {"min": 20.0, "max": 1000.0, "points": 5, "spacing": "log"},
    "nu": {"values": [0.3]},
    "dR": {"values": [5.0, 50.0, 500.0]},
    "load": {"min": 10.0, "max": 1000.0, "points": 4, "spacing": "linear"},
}
SAMPLED = "samples at E 20…1000 GPa (5 log), ν 0.3, ΔR 5…500 mm (3), load 10…1000 N/mm (4 linear)"


def run(index, objective):
    return {
        "index": index,
        "seed": index,
        "population": 60,
        "crossover": "blend",
        "objective_before_polish": objective,
        "coefficients_before_polish": {"a": 0.4, "b": 3.0, "n": 1.1},
        "objective": objective,
        "coefficients": {"a": 0.4, "b": 3.0, "n": 1.1},
        "evaluations": 100,
        "seconds": 0.1,
    }


def profile(low, high, low_is_bound=False, high_is_bound=False):
    return {
        "values": [low, high],
        "objective": [0.0505, 0.0505],
        "low": low,
        "high": high,
        "low_is_bound": low_is_bound,
        "high_is_bound": high_is_bound,
        "objective_at_published": 0.055,
    }


def made_by_hand(**changes):
    bounds = {"a": {"low": 0.1, "high": 1.5}, "b": {"low": 0.1, "high": 3.0}}
    data = {
        "name": "made by hand",
        "law": "enhanced",
        "contact": "external",
        "reference": "johnson",
        "coefficients": {"a": 0.4, "b": 3.0, "n": 1.1},
        "objective": {"name": "rms-log-penetration", "value": 0.05},
        "bound": 0.04,
        "published": {"coefficients": {"a": 0.39, "b": 0.85, "n": 1.094}, "objective": 0.06},
        "max_abs_diff_percent": {"fitted": 12.5, "published": 15.0},
        "profiles": {"a": profile(0.399, 0.41), "b": profile(2.9, 3.0, high_is_bound=True)},
        "runs": [run(0, 0.05), run(1, 0.07), run(2, 0.05001)],
        "counts": {"samples": 1200, "masked": 34},
        "settings": {
            "campaign": {"parameters": bounds | {"n": {"value": 1.1, "fixed": True}}},
            "dataset": {"axes": AXES},
        },
        "provenance": {},
    }
    return LawFit.model_validate(data | changes)


def test_half_of_the_runs_at_the_best_are_no_warning_and_fewer_name_what_to_hold():
    half = made_by_hand(runs=[run(0, 0.05), run(1, 0.07)])
    assert "warning" not in str(half)
    fewer = {"runs": [run(0, 0.05), run(1, 0.07), run(2, 0.08)]}
    flat = {"a": profile(0.2, 0.6), "b": profile(2.9, 3.1)}
    result = made_by_hand(**fewer, profiles=flat)
    assert "make more runs (--runs 12), or hold a at a value" in result.verdicts[0]
    assert f"- {result.verdicts[0][:40]}" in compare([result])


def test_comparison_separates_contacts_and_names_every_result():
    one = made_by_hand()
    other = made_by_hand(name="another", objective={"name": "rms-log-penetration", "value": 0.045})
    table, *rest = compare([one, other]).split("\n\n")
    assert table.splitlines()[-2:] == [f"made by hand: {SAMPLED}", f"another: {SAMPLED}"]
    assert table.splitlines()[0].split() == [
        *("enhanced,", "external", "published", "made", "by", "hand", "another")
    ]
    assert "0.045" in table
    assert [part.splitlines()[0] for part in rest] == ["made by hand:", "another:"]


ALONE = """\
enhanced, external   published  made by hand  difference, %
a, mm^(1-n)               0.39           0.4           +2.6
b = 7.5*a, mm^(2-n)       0.85             3         +252.9
n (fixed)                1.094           1.1
rms-log-penetration       0.06          0.05          -16.7
  lower bound                           0.04
max |Eq 9|, %               15          12.5
samples                                1,200
  masked                                  34
"""


def tied(**changes):
    parameters = {"a": {"low": 0.1, "high": 1.5}, "n": {"value": 1.1, "fixed": True}}
    campaign = {"parameters": parameters, "ties": {"b": "7.5*a"}}
    settings = {"campaign": campaign, "dataset": {"axes": AXES}}
    profiles = {"a": profile(0.399, 0.41)}
    return made_by_hand(settings=settings, profiles=profiles, **changes)


def test_a_single_result_is_compared_with_the_published_coefficients():
    table = compare([tied()]).split("\n\n")[0]
    assert table == f"{ALONE}made by hand: {SAMPLED}"


def test_results_of_another_search_have_a_table_of_their_own():
    tables = compare([tied(), made_by_hand(), tied(name="again")]).split("\n\n")
    assert tables[0].splitlines()[0].split()[-2:] == ["hand", "again"]
    assert tables[1].splitlines()[0].split()[-2:] == ["difference,", "%"]


def test_round_off_is_one_basin_and_the_optimum():
    paper = {"coefficients": {"a": 0.4, "b": 3.0, "n": 1.1}, "objective": 2.6e-8}
    exact = {"objective": {"name": "rms-log-penetration", "value": 1.8e-8}, "bound": 1.8e-8}
    runs = [run(0, 1.8e-8), run(1, 2.6e-8), run(2, 1e-3)]
    message = made_by_hand(**exact, published=paper, runs=runs).verdicts
    assert message[0] == "the published coefficients are the optimum on this grid, within 0.1 %"
    assert "2 of 3 runs reached the best objective within 0.1 %" in message
