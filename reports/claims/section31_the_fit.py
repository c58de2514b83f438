"""Section 3.1: the fit itself, judged by the committed results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict

from cylcontact.fitting.result import FitResult
from cylcontact.fitting.verdicts import basins
from cylcontact.laws import PUBLISHED
from cylcontact.pair import Contact
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Finding, claim

# An objective this close to the best known counts as the optimum.
OPTIMUM = 1.01
# How close a refitted coefficient must be to the published one to count as the same.
SAME_COEFFICIENT = 0.01
MISSING = "no fit result to compute it from; make fits produces them"
CHOICES = (
    "objective, point counts, spacing, bounds and search settings are ours; the objective is the "
    "root mean square of ln(δ_enhanced/δ_Johnson)"
)

EXTERNAL = asdict(PUBLISHED["external"])
Results = Mapping[str, FitResult]


@claim(
    "3.1-best-correlation-{contact}",
    "the published {contact} coefficients give the best correlation with Johnson",
    paper="best of several genetic runs",
    rule=f"at most {OPTIMUM:g} times the refit's objective",
    cases=[{"contact": "internal"}, {"contact": "external"}],
)
def published_is_best(bench: Bench, contact: Contact) -> Finding:
    """Compare the published coefficients' objective with the refit's."""
    ratios = _ratios(bench.results_by_name(), contact)
    main = ratios.get(contact)
    return Finding(
        "" if main is None else f"objective {main:.2f} times that of the refit",
        holds=None if main is None else main <= OPTIMUM,
        choice=MISSING if main is None else f"ranges of Sect. 3.1 to the letter; {CHOICES}",
        alternatives=_on_others({k: v for k, v in ratios.items() if k != contact}),
        values={f"objective ratio on {name}, -": v for name, v in ratios.items()},
    )


@claim(
    "3.1-external-{name}",
    "the optimum for external contact has this {name}",
    paper="{published:g}",
    rule=f"within {SAME_COEFFICIENT:.0%} of the published value",
    cases=[{"name": name, "published": value} for name, value in EXTERNAL.items()],
)
def external_coefficient(bench: Bench, name: str, published: float) -> Finding:
    """Compare one refitted external coefficient with the published one."""
    results = bench.results_by_name()
    refitted = {
        key: result.coefficients[name]
        for key, result in results.items()
        if result.contact == "external" and result.law == "enhanced"
    }
    main = refitted.get("external-E1000")
    deviation = None if main is None else main / published - 1
    others = ", ".join(f"{value:.4g} ({key})" for key, value in refitted.items() if value != main)
    return Finding(
        "" if main is None else f"{main:.4g} ({deviation:+.1%}){_interval(results, name)}",
        holds=None if deviation is None else abs(deviation) <= SAME_COEFFICIENT,
        choice=MISSING if main is None else f"E up to 1000 GPa; {CHOICES}",
        alternatives=f"refit on other grids: {others}" if others else "",
        values={f"{name} on {key}, -": value for key, value in refitted.items()},
        paper_values={f"{name}, -": published},
    )


@claim(
    "3.1-several-runs",
    "several runs with different populations and crossovers are needed",
    paper="several runs",
    rule="at least one run misses the best objective by more than 0.1 %",
)
def several_runs(bench: Bench) -> Finding:
    """Count the runs of the internal campaign that miss the best basin."""
    result = bench.results_by_name().get("internal")
    missed = None if result is None else len(result.runs) - basins(result)[0][1]
    return Finding(
        ""
        if result is None
        else f"{missed} of {len(result.runs)} internal runs end in a worse basin, even polished",
        holds=None if missed is None else missed > 0,
        choice=MISSING if result is None else CHOICES,
        values={} if missed is None else {"runs in a worse basin, -": float(missed)},
    )


def _interval(results: Results, name: str) -> str:
    """Return the interval in which the coefficient fits nearly as well."""
    profile = results["external-E1000"].profiles[name]
    return f"; from {profile.low:.3g} to {profile.high:.3g} the fit is within 1 % of the best"


def _ratios(results: Results, contact: Contact) -> dict[str, float]:
    """Return published over fitted objective, campaign by campaign."""
    return {
        name: result.published.objective / result.objective.value
        for name, result in results.items()
        if result.contact == contact and result.published is not None
    }


def _on_others(ratios: Mapping[str, float]) -> str:
    """List the ratios on the other campaigns."""
    listed = ", ".join(f"{ratio:.2f} ({name})" for name, ratio in ratios.items())
    return f"on other grids or by other objectives: {listed}" if listed else ""
