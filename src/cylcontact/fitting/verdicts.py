"""What a result means, in sentences computed from its numbers."""

from __future__ import annotations

from cylcontact.fitting.profile import FAIRLY, TOLERANCE, WELL
from cylcontact.fitting.result import FitResult
from cylcontact.fitting.run import RunRecord
from cylcontact.fitting.uncertainty.wording import noise_verdicts

# Runs whose objectives are this close, relatively, count as the same result.
SAME_BASIN = 1e-3
# A coefficient this close to a bound, relative to the search interval, is at the bound.
AT_BOUND = 1e-6
# Objectives below this are rounding: data that follow the law exactly.
ROUNDING = 1e-12


def verdicts(result: FitResult) -> list[str]:
    """Return the verdicts on a result, most important first.

    For measured data they speak of noise (`uncertainty.wording`). For a reference law they say
    whether the published coefficients are the optimum, how far the fit is from the lower bound,
    which coefficients are well identified, whether one is at a bound, and how many runs agree.
    """
    if result.uncertainty is not None:
        return [
            *noise_verdicts(result.uncertainty),
            *filter(None, [_on_published_law(result)]),
            *_on_runs(result),
        ]
    found = [_on_published(result), _on_bound_of_objective(result), _on_identification(result)]
    found += _on_bounds(result)
    found += _on_runs(result)
    return [sentence for sentence in found if sentence]


def identification(result: FitResult, name: str) -> str:
    """Return "well", "fairly", "poorly", "at a bound" or "fixed" for a coefficient."""
    if result.uncertainty is not None:
        found = result.uncertainty.estimates.get(name)
        return "fixed" if found is None else found.verdict
    if name not in result.profiles:
        return "fixed"
    return result.profiles[name].verdict(result.coefficients[name])


def basins(result: FitResult) -> list[tuple[float, int]]:
    """Return the distinct objectives the runs ended at, with the number of runs, best first."""
    found: list[tuple[float, int]] = []
    for record in sorted(result.runs, key=lambda record: record.objective):
        if found and same_basin(record, found[-1][0]):
            found[-1] = (found[-1][0], found[-1][1] + 1)
        else:
            found.append((record.objective, 1))
    return found


def same_basin(record: RunRecord, objective: float) -> bool:
    """Tell whether a run ended, to within 0.1 % and rounding, at an objective."""
    return record.objective <= objective * (1 + SAME_BASIN) + ROUNDING


def _on_published(result: FitResult) -> str:
    """Compare the published coefficients' objective with the fitted one."""
    if result.published is None:
        return ""
    ratio = result.published.objective / result.objective.value
    if ratio <= 1 + SAME_BASIN:
        return "the published coefficients are the optimum on this grid, within 0.1 %"
    return (
        f"the published coefficients are not the optimum on this grid: their objective is "
        f"{result.published.objective:.4g}, {ratio:.2f} times the fitted one"
    )


def _on_published_law(result: FitResult) -> str:
    """Say how well the law describes the data with its published constants."""
    if result.published is None:
        return ""
    return (
        "on these data the law has an objective of "
        f"{result.published.objective:.4g} with its published constants, and "
        f"{result.objective.value:.4g} fitted"
    )


def _on_bound_of_objective(result: FitResult) -> str:
    """Say how far the objective is from what any law of this form could reach."""
    if not result.bound:
        return ""
    excess = result.objective.value / result.bound - 1
    return (
        f"the fit is {100 * excess:.1f} % above the lower bound {result.bound:.4g}, "
        "which the best K* and n at every single clearance would reach"
    )


def _on_identification(result: FitResult) -> str:
    """Name the coefficients that are poorly identified."""
    poor = [name for name in result.profiles if identification(result, name) == "poorly"]
    if not poor:
        return "no coefficient inside its bounds is poorly identified"
    return (
        f"poorly identified: {', '.join(poor)} (each can move by more than {FAIRLY:.0%} of its "
        f"value, or to a bound, while the best objective rises by less than {TOLERANCE:.0%}; "
        f"well means less than {WELL:.0%})"
    )


def _on_bounds(result: FitResult) -> list[str]:
    """Name the coefficients that ended at a bound of the search."""
    found = []
    for name, table in result.settings["campaign"]["parameters"].items():
        if table.get("fixed"):
            continue
        margin = AT_BOUND * (table["high"] - table["low"])
        for end in ("low", "high"):
            if abs(result.coefficients[name] - table[end]) <= margin:
                found.append(f"{name} is at its {end} bound {table[end]:g}: widen it")
    return found


def _on_runs(result: FitResult) -> list[str]:
    """Say how many runs agree with the best, and where the others ended."""
    (_, agreeing), *others = basins(result)
    found = [f"{agreeing} of {len(result.runs)} runs reached the best objective within 0.1 %"]
    if others:
        listed = ", ".join(f"{value:.4g} ({count})" for value, count in others)
        found.append(f"the others ended in other basins, at (runs): {listed}")
    return found
