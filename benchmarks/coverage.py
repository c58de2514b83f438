"""Do the intervals hold? Coverage over synthetic sets of measurements, fitted by `cylcontact.fit`.

    python -m benchmarks.coverage            # 400 sets of each kind: writes datasets/coverage.csv
                                             # and docs/coverage.md; about half an hour
    python -m benchmarks.coverage --sets 40  # a look, nothing written

Each kind of data has faults of a known size. It is fitted once with the options that name them, and
once without: the 95 % intervals of the first must hold the truth in 92 to 98 % of the sets, and
the second must say by itself that its intervals cannot be trusted, and name the option.
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
from cylcontact.fitting import FitResult

ROOT = Path(__file__).parents[1]
RESULT, PAGE = ROOT / "datasets" / "coverage.csv", ROOT / "docs" / "coverage.md"
SETS, SEED, DIGITS = 400, 20150101, 5
STEEL = cc.Material("steel", E="207 GPa", nu=0.3)
PAIR = cc.CylinderPair.internal(R_i=10.0, R_j=9.97, material=STEEL, length=20.0)
# The truth: the law as it is, read from a zero that is off by 0.2 µm.
TRUTH = {"stiffness_factor": 1.0, "offset": 2e-4}
LAW = cc.laws.Explicit()
TEXT = """# Do the intervals hold?

How often the 95 % intervals of a fit to measurements hold the truth, in synthetic experiments with
faults of a known size: {sets} sets of each kind (`python -m benchmarks.coverage`), fitted by the
explicit law. The numbers are percentages of sets, of the true stiffness factor and the true offset;
95 % of {sets} sets is known to ± 2 %.

| data | options | stiffness factor | offset | warned |
|---|---|---:|---:|---:|
{rows}

In the first row of each kind the options name its faults. In the second they leave one out, as
would somebody who does not know of it, in a quarter of the sets. The intervals may then be far off;
the last column is the percentage of sets where the report warns of that fault and names the option.
Errors of the load are the exception: no residual shows them, as they look like scatter of the
reading. With fewer than five series the intervals are about these series, with eight or more about
the population that they come from.

The kinds of data, with their standard deviations:

{kinds}
"""


@dataclass(frozen=True)
class Kind:
    """Measurements with faults of one kind; deviations are in mm or relative."""

    # `options` name the faults, `unnamed` leave one out; None if there is nothing to leave out.
    series: int
    readings: int
    options: dict[str, Any]
    constant: float = 0.0
    proportional: float = 0.0
    offset: float = 0.0
    gain: float = 0.0
    drift: float = 0.0
    load: float = 0.0
    shuffled: bool = False
    given: bool = False
    unnamed: dict[str, Any] | None = field(default_factory=dict)

    def sample(self, rng: np.random.Generator) -> pd.DataFrame:
        """Return a set of measurements."""
        parts = []
        for number in range(self.series):
            load = np.geomspace(10.0, 1500.0, self.readings)
            if self.shuffled:
                load = rng.permutation(load)
            depth = LAW.penetration(load, PAIR)
            along = np.linspace(0.0, 1.0, self.readings)
            zero = TRUTH["offset"] + self.offset * rng.normal() + self.drift * rng.normal() * along
            scatter = np.hypot(self.constant, self.proportional * depth)
            reading = (1 + self.gain * rng.normal()) * depth + zero + scatter * _noise(rng, load)
            read = load * (1 + self.load * _noise(rng, load))
            part = {"load_N_per_mm": read, "penetration_um": 1e3 * reading}
            if self.given:
                part |= {"load_std_N_per_mm": self.load * load, "penetration_std_um": 1e3 * scatter}
            parts.append(pd.DataFrame(part | {"specimen": f"s{number}"}))
        return pd.concat(parts, ignore_index=True)


def _noise(rng: np.random.Generator, like: np.ndarray) -> np.ndarray:
    """Return standard normal numbers."""
    return rng.normal(size=like.size)


BOTH = {"constant": 3e-5, "proportional": 0.01}
SERIES = {**BOTH, "offset": 1.5e-4, "gain": 0.03}
GROUP = {"group": "specimen"}
KINDS: dict[str, Kind] = {
    "proportional scatter": Kind(1, 40, {"noise": "proportional"}, proportional=0.02, unnamed=None),
    "constant scatter": Kind(1, 40, {"noise": "constant"}, constant=5e-5),
    "both": Kind(1, 40, {"noise": "both"}, constant=5e-5, proportional=0.01),
    "10 series": Kind(10, 10, GROUP, **SERIES),
    "8 series": Kind(8, 12, GROUP, **SERIES),
    "8 series with a drift": Kind(
        8, 12, {**GROUP, "drift": True}, **SERIES, drift=3e-4, shuffled=True, unnamed=GROUP
    ),
    "one series with a drift": Kind(
        1, 40, {"drift": True}, **BOTH, drift=4e-4, shuffled=True, unnamed={"noise": "both"}
    ),
    "errors of the load, given": Kind(
        1, 40, {}, **BOTH, load=0.02, given=True, unnamed={"ignore": ["load_std_N_per_mm"]}
    ),
    "errors of the load, a share": Kind(
        1, 40, {"load_error": 0.02}, **BOTH, load=0.02, unnamed=None
    ),
}


def coverage_of(name: str, sets: int, seed: int = SEED, jobs: int = 1) -> pd.DataFrame:
    """Return how often the intervals of a kind hold the truth, by way of fitting and parameter."""
    kind, number = KINDS[name], list(KINDS).index(name)
    seeds = np.random.SeedSequence([seed, number]).spawn(sets)
    # What an unnamed fault does is seen in fewer sets.
    ways = [(kind.options, seeds)]
    if kind.unnamed is not None:
        ways.append((kind.unnamed, seeds[: -(-sets // 4)]))
    rows = []
    for options, some in ways:
        fits = Parallel(n_jobs=jobs)(delayed(_fitted)(kind, options, each) for each in some)
        for parameter, truth in TRUTH.items():
            low, high = (np.array([fit[parameter][end] for fit in fits]) for end in (0, 1))
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
    """Fit a set; return the interval of each parameter, and whether the report warns."""
    frame = kind.sample(np.random.default_rng(seed))
    result: FitResult = cc.fit(frame, "explicit", PAIR, starts=1, **options)
    estimates = result.uncertainty.estimates
    intervals = {name: (one.profile.low, one.profile.high) for name, one in estimates.items()}
    return intervals | {"warned": bool(result.uncertainty.findings)}


def page(table: pd.DataFrame) -> str:
    """Return the page of the documentation, in Markdown, from the table of the study."""
    lines = []
    for (kind, options), rows in table.groupby(["kind", "options"], sort=False):
        held = rows.set_index("parameter")["coverage_percent"]
        command = f"`{options}`" if options else "none"
        lines.append(
            f"| {kind} | {command} | {held['stiffness_factor']:.1f} | {held['offset']:.1f} "
            f"| {rows['warned_percent'].iloc[0]:.0f} |"
        )
    kinds = "\n".join(f"- {name}: {_as_text(kind)}" for name, kind in KINDS.items())
    return TEXT.format(sets=int(table["sets"].max()), rows="\n".join(lines), kinds=kinds)


def _as_text(kind: Kind) -> str:
    """Return what a kind of data is made of."""
    readings = f"{kind.series} × {kind.readings}" if kind.series > 1 else f"{kind.readings}"
    in_um = {"of scatter": kind.constant, "of offset": kind.offset, "of drift": kind.drift}
    shares = {
        "of the penetration": kind.proportional,
        "of gain": kind.gain,
        "of the load": kind.load,
    }
    parts = [f"{1e3 * value:g} µm {what}" for what, value in in_um.items() if value]
    parts += [f"{100 * value:g} % {what}" for what, value in shares.items() if value]
    return f"{readings} readings, {', '.join(parts)}"


def _as_options(options: dict[str, Any]) -> str:
    """Return the options of the command that does the same."""
    texts = []
    for name, value in options.items():
        option = f"--{name.replace('_', '-')}"
        values = value if isinstance(value, list) else [value]
        texts += [option if each is True else f"{option} {each}" for each in values]
    return " ".join(texts)


def main() -> None:
    """Run the study; write it if all sets were asked for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.coverage", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="KIND", help=", ".join(KINDS))
    parser.add_argument("--sets", type=int, default=SETS, help="synthetic sets of each kind")
    parser.add_argument("--jobs", type=int, default=-1, help="worker processes")
    arguments = parser.parse_args()
    names = arguments.names or list(KINDS)
    parts = []
    for name in names:
        parts.append(coverage_of(name, arguments.sets, jobs=arguments.jobs))
        print(parts[-1].to_string(index=False, header=name == names[0]), flush=True)
    if names == list(KINDS) and arguments.sets >= SETS:
        with replacing(RESULT) as table, replacing(PAGE) as text:
            pd.concat(parts).to_csv(
                table, index=False, float_format=f"%.{DIGITS}g", lineterminator="\n"
            )
            text.write_text(page(pd.read_csv(table, keep_default_na=False)), encoding="utf-8")


if __name__ == "__main__":
    main()
