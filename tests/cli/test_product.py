"""Every pair of options of `check`, `size` and `laws compare`: the same joint built by hand.

A case is a command and some choices, two of which differ from the usual ones. Either its answer is
that of the laws and limits, called here for the pair that the options mean, or it is refused in one
line that names both.
"""

import itertools
import json
import random
import shlex
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import cylcontact as cc
from cylcontact import laws, limits
from cylcontact.bodies.material import scaled
from cylcontact.joint.answer import NUMBERS

STEEL, BRONZE, ALUMINIUM = map(
    cc.Material.named, ("high-strength steel", "bronze", "aluminium alloy")
)
PLAIN = cc.Material("", 207e3, 0.3)  # neither yield stress nor expansion
LOAD = 200.0

# By dimension and choice: the options; the first choice of each is the usual one.
CHOICES = {
    "shape": {
        "radii": "--Ri 10 --Rj 9.98",
        "clearance": "--Ri 10 --radial-clearance '20 um'",
        "diameters": "--hole-diameter 20 --pin-diameter 19.96",
        "fit": "--iso 20H7/g6",
        "transition": "--iso 20H7/k6",
        "rollers": "--contact external --Ri 15 --Rj 30",
        "plane body": "--contact external --Ri 15 --Rj inf",
    },
    "housing": {
        "none": "",
        "ring": "--R-o 20",
        "sector": "--R-o 20 --clamp pulled:60",
        "lug": "--R-o 20 --clamp lug",
        "layers": "--R-o 20 --layer 'aluminium alloy:14'",
    },
    "temperature": {"none": "", "one": "--temperature 80", "two": "--temperature 80,60"},
    "rim": {"none": "", "free": "--rim free", "frame": "--rim 'aluminium alloy'"},
    "materials": {"two": "", "plain": "", "one": ""},
    "plane": {"strain": "", "stress": "--plane stress"},
    "length": {"none": "", "some": "--length 12"},
    "depth": {"none": "", "some": "--depth 50"},
    "load": {"per mm": f"--load {LOAD:g}", "total": "--load '2.4 kN'"},
}
TARGETS = {"stiffness": 1e5, "penetration": 4.0, "peak": 60.0, "factor": 3.0}
COMMANDS = [
    "check",
    "laws compare",
    *(f"size {what} {to}" for what in ("clearance", "modulus", "length") for to in TARGETS),
]
USUAL = {name: next(iter(values)) for name, values in CHOICES.items()}


def cases():
    """Every command with every two choices that are not the usual ones."""
    others = [
        (name, each) for name, values in CHOICES.items() for each in values if each != USUAL[name]
    ]
    for command in COMMANDS:
        yield command, {}
        for choice in others:
            yield command, dict([choice])
        for one, other in itertools.combinations(others, 2):
            if one[0] != other[0]:
                yield command, dict([one, other])


ALL = list(cases())
# Those of the sample take a fraction of a second each; the first ones are what users ask most.
FAST = [case for case in ALL if not ("size" in case[0] and "housing" in case[1])]
SAMPLE = [
    ("check", {"shape": "fit", "housing": "ring"}),
    ("check", {"shape": "fit", "temperature": "one"}),
    ("check", {"shape": "plane body"}),
    ("check", {"shape": "plane body", "depth": "some"}),
    ("check", {"shape": "rollers"}),
    ("check", {"plane": "stress"}),
    ("check", {"housing": "layers", "temperature": "one", "rim": "free"}),
    ("size clearance stiffness", {"housing": "ring"}),
    ("size clearance stiffness", {"temperature": "one"}),
    ("size clearance peak", {"temperature": "one"}),
    ("size clearance penetration", {"temperature": "two"}),
    ("size clearance factor", {"materials": "one"}),
    ("size modulus stiffness", {"shape": "fit"}),
    ("size length penetration", {"shape": "fit"}),
    ("size length peak", {"shape": "plane body", "load": "total"}),
    *random.Random(84).sample(FAST, 20),
]


def options_of(command, chosen):
    """The words of a command line."""
    choice = USUAL | chosen
    rollers = choice["shape"] in ("rollers", "plane body")
    if rollers:
        materials = {
            "two": "--material 'high-strength steel' --material bronze",
            "plain": "--material '207 GPa, 0.3'",
            "one": "--material bronze",
        }
    else:
        materials = {
            "two": "--pin 'high-strength steel' --hole bronze",
            "plain": "--material '207 GPa, 0.3'",
            "one": "--material bronze",
        }
    parts = [values[choice[name]] for name, values in CHOICES.items()]
    parts.append(materials[choice["materials"]])
    words = command.split()
    if words[0] == "size":
        if words[1] == "clearance" and choice["shape"] != "fit":
            parts[0] = {"rollers": "--contact external --Ri 15"}.get(choice["shape"], "--Ri 10")
            parts[0] = CHOICES["shape"][choice["shape"]] if is_sought(choice) else parts[0]
        parts.append(f"--{words[2]} {TARGETS[words[2]]:g}")
    return " ".join([*words[:2], *parts])


def is_sought(choice):
    """Whether the shape gives a clearance that is to be found, in another way than by radii."""
    return choice["shape"] in ("fit", "transition", "plane body")


def refusal(command, chosen):
    """What a refusal must name, or nothing for an answer."""
    c = USUAL | chosen
    size, _, target = command.partition(" ")[2].partition(" ") if "size" in command else ("",) * 3
    rollers = c["shape"] in ("rollers", "plane body")
    fit = c["shape"] in ("fit", "transition")
    checks = [
        (size == "clearance" and fit, ("--iso", "clearance")),
        (size == "clearance" and c["shape"] == "plane body", ("--Rj", "size clearance")),
        (rollers and c["housing"] != "none", ("--contact", "--R-o")),
        (c["load"] == "total" and c["length"] == "none" and size != "length",
         ("--load", "--length")),
        (size == "length" and c["length"] == "some", ("--length", "size length")),
        (c["temperature"] != "none" and rollers, ("--temperature", "contact")),
        (c["rim"] != "none" and rollers, ("--rim", "contact")),
        (c["depth"] == "some" and c["shape"] != "plane body", ("--depth", "--Rj inf")),
        (c["rim"] != "none" and c["temperature"] == "none", ("--rim", "temperature")),
        (c["rim"] != "none" and c["housing"] == "none", ("--rim", "housing")),
        (c["temperature"] != "none" and c["housing"] != "none" and c["rim"] == "none",
         ("--rim", "bore")),
        (c["rim"] == "frame" and c["housing"] in ("sector", "lug"), ("--rim", "clamped")),
        (c["temperature"] != "none" and c["materials"] == "plain", ("thermal_expansion",)),
        (target in ("stiffness", "penetration") and c["shape"] == "plane body"
         and c["depth"] == "none", (f"--{target}", "depth")),
        (target == "factor" and c["materials"] == "plain", ("--factor", "yield_stress")),
    ]  # fmt: skip
    return [names for applies, names in checks if applies]


# --- by hand --------------------------------------------------------------------------------------


def joint_by_hand(chosen, dR=None):
    """The pairs at their temperatures by name, the housing, the depth and the law of a case."""
    c = USUAL | chosen
    pin, hole = {"two": (STEEL, BRONZE), "plain": (PLAIN, PLAIN), "one": (BRONZE, BRONZE)}[
        c["materials"]
    ]
    plane = c["plane"]
    length = 12.0 if c["length"] == "some" else None
    clamps = {"sector": laws.Sector(60, "pulled"), "lug": laws.Sector.lug()}
    layers = [(ALUMINIUM, 14.0)] if c["housing"] == "layers" else []
    housing = None
    if c["housing"] != "none":
        housing = laws.Housing(20.0, clamps.get(c["housing"], "rim"), layers)
    depth = 50.0 if c["depth"] == "some" else None
    if c["shape"] in ("rollers", "plane body"):
        R_j = 30.0 if c["shape"] == "rollers" else np.inf
        R_j = R_j if dR is None else dR - 15.0
        pair = cc.CylinderPair.external(15.0, R_j, pin, length, hole, plane=plane)
        return {"joint": pair}, None, depth, laws.Johnson(datum=depth)
    radii = {"joint": (10.0, 9.98 if dR is None else 10.0 - dR)}
    if c["shape"] in ("fit", "transition"):
        fit = cc.iso286.IsoFit.read("20H7/g6" if c["shape"] == "fit" else "20H7/k6")
        shares = {"tightest": 0.0, "middle": 0.5, "loosest": 1.0}
        low, high = fit.clearance
        radii = {
            name: [float(radius) for radius in fit.radii(share)]
            for name, share in shares.items()
            if low + share * (high - low) > 0
        }
    pairs = {}
    for name, (R_i, R_j) in radii.items():
        pair = cc.CylinderPair.internal(R_i, R_j, length=length, pin=pin, hole=hole, plane=plane)
        if c["temperature"] != "none":
            T = (80.0, 80.0 if c["temperature"] == "one" else 60.0)
            rim = {"none": None, "free": "free", "frame": ALUMINIUM}[c["rim"]]
            with suppress(cc.InputError):  # it seizes, and the band has no such pair
                pairs[name] = limits.at_temperature(pair, *T, housing=housing, rim=rim)
            continue
        pairs[name] = pair
    return pairs, housing, depth, laws.Conformal(housing or "johnson")


def numbers_by_hand(pair, housing, law, load):
    """Penetration, stiffness, largest pressure and first yield of a pair."""
    flat = pair.is_flat and law.datum is None
    depth = np.nan if flat else float(law.penetration(load, pair))
    internal = pair.contact == "internal"
    peak = law.peak_pressure(load, pair) if internal else limits.hertz_stress(load, pair)
    layers = [] if housing is None else [body for body, _ in housing.layers]
    bodies = [pair.material_i, pair.material_j, *layers]
    known = all(body.yield_stress is not None for body in bodies)
    at = float(limits.first_yield(pair, housing=housing).load) if known else np.nan
    return {
        "penetration_um": 1e3 * depth,
        "stiffness_N_per_mm2": np.nan if flat else float(law.stiffness(depth, pair)),
        "peak_pressure_MPa": float(peak),
        "first_yield_N_per_mm": at,
        "factor_to_yield": at / load,
    }


def same(found, wanted, rel):
    """Whether a number of JSON is that of Python, None for NaN."""
    found = np.nan if found is None else found
    return found == pytest.approx(wanted, rel=rel, nan_ok=True)


def hold(run, command, chosen):
    """Hold a case against the joint by hand, or against its refusal; return which."""
    line = options_of(command, chosen)
    code, out, err = run(*shlex.split(line), "--json")
    if named := refusal(command, chosen):
        assert (code, out, err.count("\n")) == (2, "", 1), line
        assert any(all(name in err for name in names) for names in named), f"{line}\n{err}"
        return "refused"
    if code == 2:  # a target out of reach, which the error says
        assert "is met by no" in err, f"{line}\n{err}"
        return "refused"
    answer = json.loads(out)
    pairs, housing, _, law = joint_by_hand(chosen)
    if command == "check":
        for name, pair in pairs.items():
            wanted = numbers_by_hand(pair, housing, law, LOAD)
            found = answer["numbers"][name]
            assert all(same(found[key], wanted[key], 1e-9) for key in wanted), f"{line} {name}"
    elif command == "laws compare":
        rows = {(row["pair"], row["law"]): row for row in answer["rows"]}
        for name, pair in pairs.items():
            wanted = numbers_by_hand(pair, housing, law, LOAD)["penetration_um"]
            assert same(rows[name, law.name]["penetration_um"], wanted, 1e-9), f"{line} {name}"
    else:
        _, what, target = command.split()
        for name, value in answer["values"].items():
            hold_size(what, target, value, name, chosen, line)
    return "answered"


def hold_size(what, target, value, name, chosen, line):
    """Hold a size: the joint with it meets the target."""
    dR = value if what == "clearance" else None
    pairs, housing, _, law = joint_by_hand(chosen, dR)
    if name not in pairs:
        return
    pair, load, whole = pairs[name], LOAD, 1.0
    total = (USUAL | chosen)["load"] == "total"
    if what == "length":
        load, whole = (2400.0 if total else LOAD) / value, value
    if what == "modulus":
        if (USUAL | chosen)["temperature"] != "none" and housing is not None:
            return  # the radii depend on the modulus; the search is tested with the clearance
        factor = value / pair.material_j.E
        hole, pin = (scaled(body, factor) for body in (pair.material_i, pair.material_j))
        pair = replace(pair, material_i=hole, material_j=pin)
    found = numbers_by_hand(pair, housing, law, load)
    key = {
        "stiffness": "stiffness_N_per_mm2",
        "penetration": "penetration_um",
        "peak": "peak_pressure_MPa",
        "factor": "factor_to_yield",
    }[target]
    met = found[key] * (whole if target == "stiffness" else 1.0)
    assert met == pytest.approx(TARGETS[target], rel=1e-5), line


@pytest.mark.parametrize("number", range(len(SAMPLE)))
def test_a_sample_of_the_pairs_of_options(run, number):
    hold(run, *SAMPLE[number])


@pytest.mark.parametrize(
    "number",
    [pytest.param(30, marks=pytest.mark.slow), pytest.param(1000, marks=pytest.mark.long)],
)
@pytest.mark.parametrize("command", COMMANDS)
def test_many_or_all_pairs_of_options(run, command, number):
    every = [case for case in ALL if case[0] == command]
    chosen = random.Random(86).sample(every, min(number, len(every)))
    assert {hold(run, *case) for case in chosen} == {"answered", "refused"}


# --- tables ---------------------------------------------------------------------------------------

COLUMNS = {
    "--Ri": "R_i_mm", "--Rj": "R_j_mm", "--hole-diameter": "hole_diameter_mm",
    "--pin-diameter": "pin_diameter_mm", "--R-o": "R_o_mm", "--length": "length_mm",
    "--depth": "depth_mm", "--radial-clearance": "radial_clearance_um",
}  # fmt: skip


def row_of(chosen):
    """The columns of a case."""
    words = shlex.split(options_of("check", chosen))[1:]
    row = {"pin": None}
    for name, value in zip(words[::2], words[1::2], strict=True):
        if name == "--temperature":
            both = dict(zip(("pin", "hole"), value.split(","), strict=False))
            is_one = len(both) == 1
            row |= {"temperature_C" if is_one else f"{k}_temperature_C": v for k, v in both.items()}
        elif name == "--load":
            row["load_N_per_mm" if value[-1].isdigit() else "load_kN"] = value.split()[0]
        elif name == "--material" and name[2:] in row:
            row["material"] += f"; {value}"
        else:
            row[COLUMNS.get(name, name[2:])] = value.removesuffix(" um")
    return row


def hold_table(run, path, cases):
    """Hold the rows of a table against the same joints, each in a command; return the counts."""
    out = path.with_name("answers.csv")
    pd.DataFrame([row_of(chosen) for chosen in cases]).to_csv(path, index=False)
    code, said, _ = run("check", path, "-o", out)
    found = pd.read_csv(out, keep_default_na=True)
    answered = 0
    for (_, row), chosen in zip(found.iterrows(), cases, strict=True):
        line = options_of("check", chosen)
        alone, text, _ = run(*shlex.split(line), "--json")
        assert pd.isna(row["error"]) == (alone == 0), f"{line}: {row['error']}"
        if alone:
            continue
        answered += 1
        answer = json.loads(text)
        numbers = answer["numbers"].get("middle", answer["numbers"]["joint"])
        for name in NUMBERS:
            rel = 2e-4 if "yield" in name else 1e-8
            wanted = np.nan if numbers[name] is None else numbers[name]
            assert row[name] == pytest.approx(wanted, rel=rel, nan_ok=True), f"{line} {name}"
        assert row["worst"] == answer["worst"], line
    assert code == (1 if answered < len(cases) else 0)
    assert said == f"{out}: {answered} of {len(cases)} joints answered\n"
    return answered, len(cases) - answered


CHECKS = [chosen for command, chosen in ALL if command == "check"]


@pytest.mark.parametrize("load", ["per mm", "total"])
def test_a_row_of_a_table_is_answered_as_the_command_is(run, tmp_path, load):
    cases = [{"shape": "fit"}, {"housing": "lug"}, {"temperature": "two"}, {"shape": "rollers"}]
    cases += random.Random(85).sample([c for c in CHECKS if "load" not in c], 12)
    assert hold_table(run, tmp_path / "joints.csv", [c | {"load": load} for c in cases])[0] > 0


@pytest.mark.slow
@pytest.mark.parametrize(("load", "counts"), [("per mm", (93, 74)), ("total", (17, 170))])
def test_all_rows_of_a_table_are_answered_as_the_commands_are(run, tmp_path, load, counts):
    cases = [c | {"load": load} for c in CHECKS if c.get("load", load) == load]
    assert hold_table(run, tmp_path / "joints.csv", cases) == counts
