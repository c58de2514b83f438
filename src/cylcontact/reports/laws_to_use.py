"""Laws for each contact, from the published one to Johnson's, to choose one from.

Those for a pin in a hole are compared over practical clearances, with the enhanced law refitted
there, or over the paper's ranges of E, ν, ΔR and load, those for rollers over the latter; both as
far as Johnson's law reaches (Eq 8).
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any, Literal

import numpy as np
import pandas as pd

from cylcontact.bodies.pair import Contact
from cylcontact.datasets.grid import grid_from
from cylcontact.files.reading import read_text, unmarked
from cylcontact.fitting.law_models import grid_model_of
from cylcontact.fitting.objectives import Form, LawForm, collect_samples, form_of
from cylcontact.fitting.results import FitResult
from cylcontact.laws import PUBLISHED, Explicit, Johnson
from cylcontact.laws.enhanced import INTERNAL_DR_MAX, INTERNAL_DR_MIN
from cylcontact.laws.explicit import CALIBRATED
from cylcontact.reports.bench import Bench
from cylcontact.reports.laws_bounds import BOUNDED, TRUTH, johnson_end
from cylcontact.support.arrays import FloatArray, as_floats
from cylcontact.support.errors import InputError
from cylcontact.support.text_tables import Table

__all__ = ["error_text", "laws_to_use", "to_text"]

BENCHMARKS = "datasets/benchmarks.json"
# The compiled functions whose times `benchmarks` measures; a power law costs as much as another.
_TIMED = {"power": "enhanced law", "explicit": "explicit law", "johnson": "Johnson"}
_ROUND_OFF = 1e-9
_ENHANCED = "f = (a·ΔR + b)·E*/ΔR·δⁿ"
_POWER = "f = C·E*·ΔR·(δ/ΔR)ⁿ"
_CLEARANCE = "f = K*·E*/ΔR·δⁿ, ln K* = ln A + p·x + q·x², n = n0 + n1·x + n2·x², x = ln ΔR"
_EXPLICIT = "f = π·E*·δ/(c + ln(1 + A/d·(c + ln(1 + A/d·ln(B/d))))), d = δ/ΔR"
_JOHNSON = "f = π·E*·δ/(−W₋₁(−e·δ/(4ΔR)))"

# The campaigns of the enhanced law and of the power laws, by contact and ranges.
Ranges = Literal["practical", "paper"]
_REFITS: dict[tuple[Contact, Ranges], tuple[str, ...]] = {
    ("internal", "practical"): ("practical", "power-practical", "power-clearance-practical-six"),
    ("internal", "paper"): ("internal", "power-internal", "power-clearance-six"),
    ("external", "practical"): ("external", "power-external", "power-clearance-external"),
    ("external", "paper"): ("external", "power-external", "power-clearance-external"),
}
_PLACES = {
    "practical": "practical clearances",
    "internal": "the paper's ranges",
    "external": "the paper's ranges",
}


def laws_to_use(contact: Contact, bench: Bench, ranges: Ranges = "practical") -> pd.DataFrame:
    """Compare laws on the samples that the enhanced one was refitted to.

    Errors are of the penetration at equal load: the root mean square of ln(δ/δ_Johnson) and the
    largest |Eq 9| in percent; for a pin in a hole also against conformal contact. Times are those
    of a compiled load relative to a power law's, from the committed benchmarks.

    Examples
    --------
    >>> from pathlib import Path
    >>> table = laws_to_use("external", Bench(Path())).set_index("law")
    >>> print(table["rms_johnson"].round(4).to_string())
    law
    published              0.0660
    refit                  0.0520
    power-dimensionless    0.0287
    power-clearance        0.0212
    explicit               0.0005
    johnson                0.0000
    """
    enhanced, *powers = _REFITS[contact, ranges]
    result = bench.result(enhanced)
    samples, _ = collect_samples(grid_from(result.settings["dataset"], result.name))
    # What to add to ln(δ/δ_Johnson) for another reference.
    references: dict[str, FloatArray] = {"johnson": np.zeros_like(samples.j)}
    if contact == "internal":
        truth = TRUTH[contact].penetration(samples.load, samples.pair)
        references["conformal"] = as_floats(samples.j - np.log(truth))
    times = _relative_times(bench)
    phi, (low, high) = samples.load / samples.pair.dR, BOUNDED[contact]
    within = f"{INTERNAL_DR_MIN:g} ≤ ΔR < {INTERNAL_DR_MAX:g} mm"

    def row(
        law: str,
        formula: str,
        constants: Mapping[str, float],
        form: Form | None = None,
        fit: FitResult = result,
        timed: str = "power",
        **said: Any,
    ) -> dict[str, object]:
        if form is None:  # a fitted one; the samples may be at the open end of its range
            model = grid_model_of(fit.law, contact, fit.name)
            form = form_of(model, model.candidates(constants), samples.dR)
        ratio = form.log_ratio(0, samples)
        errors: dict[str, float] = {}
        for reference, shift in references.items():
            errors[f"rms_{reference}"] = float(np.sqrt(np.mean((ratio + shift) ** 2)))
            largest = float(np.abs(np.expm1(ratio + shift)).max())
            errors[f"max_{reference}_percent"] = 100 * largest
        return {
            "law": law,
            "formula": formula,
            "constants": ", ".join(f"{name} = {value:.5g}" for name, value in constants.items()),
            **errors,
            "units": "mm, N, MPa",
            "defined": "every ΔR",
            "calibrated": f"ΔR {samples.dR.min():g}…{samples.dR.max():g} mm",
            "relative_time": times[timed],
        } | said

    def power(fit: FitResult, formula: str, **said: Any) -> dict[str, object]:
        return row(fit.law, formula, fit.coefficients, fit=fit, **said)

    defined = within if contact == "internal" else "every ΔR"
    refit = result.name if result.name == "practical" else "refit"
    one, *by_clearance = (bench.result(name) for name in powers)
    rows = [
        row("published", _ENHANCED, asdict(PUBLISHED[contact]), defined=defined),
        row(refit, _ENHANCED, result.coefficients, defined=defined),
        power(one, _POWER, calibrated=f"φ {phi.min():.1e}…{phi.max():.2g}", units="any"),
        *(power(fit, _CLEARANCE) for fit in by_clearance),
        row(
            *("explicit", _EXPLICIT, asdict(CALIBRATED[contact]), LawForm((Explicit(),))),
            timed="explicit",
            units="any",
            defined="every δ",
            calibrated=f"φ {low:.1e}…{high:g}",
        ),
        row(
            *("johnson", _JOHNSON, {}, LawForm((Johnson(),))),
            timed="johnson",
            units="any",
            defined=f"φ ≤ {johnson_end():.3f} (Eq 8)",
            calibrated="",
        ),
    ]
    return pd.DataFrame(rows)


def to_text(contact: Contact, bench: Bench) -> str:
    """Return the comparison of `laws_to_use` as text, with the constants beneath."""
    table = laws_to_use(contact, bench).to_dict("records")
    place = _PLACES[_REFITS[contact, "practical"][0]]
    references = [name for name in ("johnson", "conformal") if f"rms_{name}" in table[0]]
    columns = ["law", *(f"{what}, {name}" for name in references for what in ("RMS", "max %"))]
    rows = [
        (
            row["law"],
            *(
                text
                for name in references
                for text in (
                    error_text(row[f"rms_{name}"], ".4f"),
                    error_text(row[f"max_{name}_percent"], ".3g"),
                )
            ),
            f"{row['relative_time']:.1f}",
            row["units"],
            row["defined"],
            row["calibrated"],
        )
        for row in table
    ]
    lines = [
        f"laws for {contact} contact: error of the penetration at equal load, over {place},\n"
        "and the time of a compiled load relative to that of a power law",
        str(Table([*columns, "time", "units", "defined for", "fitted over"], rows)),
        *(
            ", ".join(filter(None, (f"{row['law']}: {row['formula']}", row["constants"])))
            for row in table
        ),
    ]
    if contact == "internal":
        lines.append(
            "a formula for one material: explicit; two materials, a housing, or the most exact: "
            "conformal\n"
            "all by Johnson's datum: a real housing changes the penetration by more than most of "
            "these laws differ; give it to conformal, e.g. --R-o 20 --clamp far:60"
        )
    return "\n".join(lines)


def error_text(value: float, form: str) -> str:
    """Format an error, 0 for round-off.

    Examples
    --------
    >>> error_text(0.01874, ".4f"), error_text(1e-15, ".4f")
    ('0.0187', '0')
    """
    return "0" if value < _ROUND_OFF else format(value, form)


def _relative_times(bench: Bench) -> dict[str, float]:
    """Return the measured times of compiled loads over that of a power law."""
    remedy = "measure them: make bench"
    path = bench.required(BENCHMARKS, "the measured times do not exist", remedy)
    try:
        data = dict(json.loads(read_text(path, remedy)))
        rows = unmarked(data, str(path))["rows"]
        compiled = [row for row in rows if row["case"].startswith("compiled scalar")]
        measured = {row["side"]: row["value"] for row in compiled}
    except InputError:
        raise
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise InputError(str(path), "", None, "holds no measured times", remedy) from error
    try:
        times = {key: measured[f"cylcontact: kernel_load, {side}"] for key, side in _TIMED.items()}
    except KeyError as error:
        raise InputError(
            str(path), "rows", None, f"lack the time of {error}", "measure it: make bench"
        ) from None
    return {key: value / times["power"] for key, value in times.items()}
