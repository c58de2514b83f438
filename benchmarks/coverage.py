"""Coverage of the intervals over synthetic tables, fitted by `cylcontact.fit`.

    python -m benchmarks.coverage            # 200 of each kind, twenty minutes on one core: writes
                                             # datasets/coverage.csv (then: benchmarks --page)
    python -m benchmarks.coverage --sets 40  # a quick look, nothing written

Each kind of data has errors of a known size. It is fitted with the options that describe them, and
without: the 95 % intervals of the first must contain the truth in 95 % of the sets, within chance,
and the second must warn and name the option.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from joblib import Parallel, delayed

import cylcontact as cc
from cylcontact.files.writing import replacing
from cylcontact.fitting import findings

RESULT = Path(__file__).parents[1] / "datasets" / "coverage.csv"
SETS, SEED = 200, 20150101
STEEL = cc.Material("steel", E="207 GPa", nu=0.3)
PAIR = cc.CylinderPair.internal(R_i=10.0, R_j=9.97, material=STEEL, length=20.0)
LAW = cc.laws.Explicit()
# Parameters of the fit; the offset is in mm.
TRUTH = {"stiffness_factor": 1.0, "offset": 2e-4}


@dataclass(frozen=True)
class Kind:
    """A kind of data, with deviations in mm or relative, and the options that describe it."""

    series: int
    readings: int
    options: dict[str, Any]
    constant: float = 0.0
    proportional: float = 0.0
    offset: float = 0.0
    gain: float = 0.0
    drift: float = 0.0
    load: float = 0.0
    load_is_stated: bool = False
    # Whether clearance and modulus are not as stated, by 2 µm and 5 % (standard deviations).
    inputs: bool = False
    # Options that leave an error out; None if there is nothing to leave out.
    incomplete: dict[str, Any] | None = field(default_factory=dict)

    def sample(self, rng: np.random.Generator) -> pd.DataFrame:
        """Return a table of readings."""
        parts, like, pair = [], self.readings, PAIR
        if self.inputs:
            E, dR = 207e3 * (1 + 0.05 * rng.normal()), 0.03 + 0.002 * rng.normal()
            steel = cc.Material("steel", E=E, nu=0.3)
            pair = cc.CylinderPair.internal(R_i=10.0, R_j=10.0 - dR, material=steel, length=20.0)
        for number in range(self.series):
            load = np.geomspace(10.0, 1500.0, self.readings)
            if self.drift:  # else it looks like a change with the load
                load = rng.permutation(load)
            depth = LAW.penetration(load, pair)
            along = np.linspace(0.0, 1.0, self.readings)
            zero = TRUTH["offset"] + self.offset * rng.normal() + self.drift * rng.normal() * along
            scatter = np.hypot(self.constant, self.proportional * depth)
            gain = 1 + self.gain * rng.normal()
            reading = gain * depth + zero + scatter * rng.normal(size=like)
            part = {
                "load_N_per_mm": load * (1 + self.load * rng.normal(size=like)),
                "penetration_um": 1e3 * reading,
                "specimen": f"s{number}",
            }
            if self.load_is_stated:
                part |= {"load_std_N_per_mm": self.load * load, "penetration_std_um": 1e3 * scatter}
            parts.append(pd.DataFrame(part))
        return pd.concat(parts, ignore_index=True)


BOTH = {"constant": 3e-5, "proportional": 0.01}
SERIES = {**BOTH, "offset": 1.5e-4, "gain": 0.03}
GROUP = {"group": "specimen"}
LOAD = {**BOTH, "load": 0.02}
DRIFT = {"drift": True}
IGNORED, SHARE = {"ignore": ["load_std_N_per_mm"]}, {"load_error": 0.02}
KNOWN = {"uncertain": {"dR": "2 um", "E": "5%"}}
KINDS = {
    "proportional scatter": Kind(1, 40, {}, proportional=0.02, incomplete=None),
    "constant scatter": Kind(1, 40, {}, constant=5e-5, incomplete=None),
    "both": Kind(1, 40, {}, constant=5e-5, proportional=0.01, incomplete=None),
    "both, few readings": Kind(1, 8, {}, constant=5e-5, proportional=0.01, incomplete=None),
    "clearance and modulus known only so well": Kind(1, 12, KNOWN, **BOTH, inputs=True),
    "10 series": Kind(10, 10, GROUP, **SERIES),
    "8 series": Kind(8, 12, GROUP, **SERIES),
    "8 series with a drift": Kind(8, 12, GROUP | DRIFT, **SERIES, drift=3e-4, incomplete=GROUP),
    "one series with a drift": Kind(1, 40, DRIFT, **BOTH, drift=4e-4),
    "errors of the load, given": Kind(1, 40, {}, **LOAD, load_is_stated=True, incomplete=IGNORED),
    "errors of the load, a share": Kind(1, 40, SHARE, **LOAD, incomplete=None),
}


def coverage_of(name: str, sets: int, seed: int = SEED, jobs: int = 1) -> pd.DataFrame:
    """Return how often the intervals of a kind contain the truth, by options and parameter."""
    kind = KINDS[name]
    seeds = np.random.SeedSequence([seed, list(KINDS).index(name)]).spawn(sets)
    ways = [(kind.options, seeds)]
    if kind.incomplete is not None:  # its effect shows in fewer sets
        ways.append((kind.incomplete, seeds[: -(-sets // 4)]))
    rows = []
    for options, some in ways:
        fits = Parallel(n_jobs=jobs)(delayed(_fitted)(kind, options, each) for each in some)
        for parameter, truth in TRUTH.items():
            low, high = np.array([fit[parameter] for fit in fits]).T
            rows.append(
                {
                    "kind": name,
                    "options": _as_options(options),
                    "parameter": parameter,
                    "sets": len(some),
                    "coverage_percent": 100 * float(((low <= truth) & (truth <= high)).mean()),
                    "width": float((high - low).mean()),
                    "warned_percent": 100 * float(np.mean([fit["warned"] for fit in fits])),
                }
            )
    return pd.DataFrame(rows)


def _fitted(kind: Kind, options: dict[str, Any], seed: np.random.SeedSequence) -> dict[str, Any]:
    """Fit a table; return the interval of each parameter, and whether the report warns."""
    frame = kind.sample(np.random.default_rng(seed))
    result = cc.fit(frame, "explicit", PAIR, starts=1, **options)
    intervals = {n: (result.estimates[n].low, result.estimates[n].high) for n in result.free}
    return intervals | {"warned": bool(findings.tests_of_noise(result.optimum))}


def _as_options(options: dict[str, Any]) -> str:
    """Return the options of the command that does the same."""
    texts = []
    for name, value in options.items():
        option = f"--{name.replace('_', '-')}"
        values = value if isinstance(value, list) else [value]
        if isinstance(value, dict):
            values = [f'"{key}={size}"' for key, size in value.items()]
        texts += [option if each is True else f"{option} {each}" for each in values]
    return " ".join(texts)


def main() -> None:
    """Run the study; write it if all sets were asked for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.coverage", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="KIND", help=", ".join(KINDS))
    parser.add_argument("--sets", type=int, default=SETS, help="synthetic tables of each kind")
    parser.add_argument("--write", action="store_true", help="write them, however few")
    parser.add_argument("--jobs", type=int, default=-1, help="worker processes")
    arguments = parser.parse_args()
    names, parts = arguments.names or list(KINDS), []
    for name in names:
        parts.append(coverage_of(name, arguments.sets, jobs=arguments.jobs))
        print(parts[-1].to_string(index=False, header=name == names[0]), flush=True)
    if arguments.write or (names == list(KINDS) and arguments.sets >= SETS):
        with replacing(RESULT) as path:
            pd.concat(parts).to_csv(path, index=False, float_format="%.5g", lineterminator="\n")


if __name__ == "__main__":
    main()
