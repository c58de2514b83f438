"""Section 3.1: the search for the coefficients of Eq 6, repeated.

The paper gives ranges, but no points, spacing or objective, nor which coefficients were searched
at once. The campaigns recovered-internal and recovered-external take those assumptions under which
a search gives the published coefficients; other assumptions are readings.
"""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

from cylcontact.fitting.polish import polish_across_kinks
from cylcontact.fitting.problem import Problem
from cylcontact.laws import PUBLISHED
from cylcontact.laws.definition import Parameter
from cylcontact.pair import CONTACTS, Contact
from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import Alternative, Finding, claim

from ..paper import WINDOW
from ..recovery import N_FREE, best, problem_from, with_axes
from .section31 import judged

SEARCHED: dict[Contact, str] = {
    "internal": "two numbers searched, the others tied to them as their digits suggest",
    "external": "a and b searched, n = 1.094 held as read from Fig 3",
}
SAMPLES: dict[Contact, str] = {
    "internal": "20 points an axis, ΔR logarithmic, E (to 1000 GPa) and loads even",
    "external": "20 points an axis, all even",
}
BORROWED = "the samples of the other contact"
# Free in a search of all internal coefficients; the campaigns of that kind have narrower bounds.
WIDE = (
    Parameter("a", low=0.1, high=1.5),
    Parameter("b", low=0.0, high=0.5),
    Parameter("Y_log_scale", low=0.1, high=50.0),
    Parameter("Y_log_exponent", low=-3.0, high=1.0),
    Parameter("Y_slope", low=-0.1, high=0.1),
    Parameter("Y_offset", low=0.8, high=1.6),
    Parameter("n_exponent", low=-1.0, high=1.0),
)


def other_samples(bench: Bench, contact: Contact) -> dict[str, Problem]:
    """Return the recovering search on other samples, by what is changed."""
    settings = {each: bench.result(f"recovered-{each}").settings for each in CONTACTS}
    base, axes = settings[contact], ("E", "dR", "load")
    (other,) = (settings[each]["dataset"]["axes"] for each in CONTACTS if each != contact)
    borrowed = {
        axis: {
            key: other[axis][key] for key in (("spacing", "max") if axis == "E" else ("spacing",))
        }
        for axis in axes
    }
    changed: dict[str, dict[str, dict[str, Any]]] = {
        "10 points an axis": {axis: {"points": 10} for axis in axes},
        "30 points an axis": {axis: {"points": 30} for axis in axes},
        "100 points an axis": {axis: {"points": 100} for axis in axes},
        "all axes logarithmic": {axis: {"spacing": "log"} for axis in axes},
        f"E to {other['E']['max']:g} GPa": {"E": {"max": other["E"]["max"]}},
        BORROWED: borrowed,
    }
    return {name: problem_from(with_axes(base, **keys)) for name, keys in changed.items()}


def all_free(problem: Problem, contact: Contact) -> Problem:
    """Return a problem with every coefficient searched."""
    if contact == "external":
        return replace(problem, parameters=(*problem.parameters[:2], N_FREE))
    return replace(problem, parameters=WIDE)


def searched(problem: Problem, contact: Contact) -> dict[str, float]:
    """Return the coefficients at the best point, found without a genetic search."""
    if len(problem.free) < len(WIDE):
        return problem.coefficients(best(problem)[0])
    start = problem.point(asdict(PUBLISHED[contact]))
    return problem.coefficients(polish_across_kinks(problem, start)[0])


# --- the best correlation -----------------------------------------------------------------------

BEST = 1.05  # times the least objective


def excess(problem: Problem, contact: Contact) -> float:
    """Return the objective of the published coefficients over the least that a search finds."""
    published = problem.value_of(asdict(PUBLISHED[contact]))
    return published / problem.value_of(searched(problem, contact))


@claim(
    "3.1-best-correlation-{contact}",
    "the published coefficients give the best correlation with Johnson's law ({contact} contact)",
    paper="the best of several genetic runs",
    rule=f"deviation (rms of ln δ) at most {BEST:g} times the least found (5 % is ours)",
    figures=("fig_readings", "fig_forms"),
    against="{against}",
    cases=[
        {
            "contact": "internal",
            "against": "The paper calls the parameters of the equation its design variables and "
            "mentions no ties; with all of them searched, the published ones are at least twice "
            "as far off as the best on every sample of its ranges tried.",
        },
        {
            "contact": "external",
            "against": "The paper wants K* identified together with n; with n searched too, the "
            "published ones are about a tenth or more above the best on every sample tried.",
        },
    ],
)
def best_correlation(bench: Bench, contact: Contact) -> Finding:
    """Return the published coefficients' objective over the least, by what was searched on what."""
    base = problem_from(bench.result(f"recovered-{contact}").settings)
    others = other_samples(bench, contact)
    as_stated = bench.result(contact)
    published = problem_from(as_stated.settings).value_of(asdict(PUBLISHED[contact]))
    own = published / as_stated.objective.value
    free, few, borrowed = "all coefficients searched", SEARCHED[contact], others[BORROWED]
    recovered = excess(base, contact)
    ratios = {
        f"{free}; {SAMPLES[contact]}": excess(all_free(base, contact), contact),
        f"{free}; {BORROWED}": excess(all_free(borrowed, contact), contact),
        f"{few}; {SAMPLES[contact]}": recovered,
    }
    for name in list(others)[2:5]:
        ratios[f"{few}; {name}"] = excess(others[name], contact)

    def miss(ratio: float) -> str:
        return "" if ratio <= BEST else f"{ratio - BEST:.2f} above {BEST:g}"

    return Finding(
        f"{own:.2f} times the least with all coefficients searched; {recovered:.3f} times with "
        f"{few}",
        holds=not miss(own),
        choice=f"{free}; the ranges to the letter, all axes logarithmic",
        missing=WINDOW,
        miss=miss(own),
        alternatives=[
            judged(name, f"{ratio:.3f} times", miss(ratio), WINDOW)
            for name, ratio in ratios.items()
        ],
        values={
            "objective ratio, all searched, -": own,
            **{f"objective ratio, {name}, -": ratio for name, ratio in ratios.items()},
        },
    )


# --- the coefficients, one by one ---------------------------------------------------------------

RECOVERED: list[dict[str, Any]] = [
    {
        "contact": "internal",
        "id": "internal-a",
        "name": "a",
        "what": "the search for internal contact ends at this a (b is a tenth of it)",
        "tolerance": 5.0,
    },
    {
        "contact": "internal",
        "id": "internal-Y",
        "name": "Y_log_scale",
        "what": "the search for internal contact ends at this factor of Y (−0.151, 0.0151 and "
        "1.151 follow from it)",
        "tolerance": 1.0,
    },
    *(
        {
            "contact": "external",
            "id": f"external-{name}",
            "name": name,
            "what": f"the search for external contact ends at this {name}",
            "tolerance": tolerance,
        }
        for name, tolerance in (("a", 5.0), ("b", 5.0), ("n", 1.0))
    ),
]
AGAINST_RECOVERED = {
    "internal-a": "It comes back within 0.2 % on plausible samples, and within 4 % from 10 to 100 "
    "points an axis; but the tie to b is read from the digits.",
    "internal-Y": "It comes back within 1 % on nearly every sample; only evenly spaced clearances, "
    "few of them small, lead elsewhere.",
    "external-a": "With n held it comes back within 5 % on every sample tried, which would make it "
    "reproduced; only with n searched too is it lost on some.",
    "external-b": "It comes back to both printed digits on a plain sample; but that has few "
    "clearances near 5 mm, which alone decide b.",
    "external-n": "The paper takes n from Fig 3 and need not have searched it at all.",
}


@claim(
    "3.1-recovered-{id}",
    "{what}",
    paper="{printed}",
    rule="within {tolerance:g} % of the printed value (ours)",
    figures=("fig_readings",),
    against="{against}",
    cases=[
        {
            **case,
            "printed": f"{getattr(PUBLISHED[case['contact']], case['name']):g}",
            "against": AGAINST_RECOVERED[case["id"]],
        }
        for case in RECOVERED
    ],
)
def recovered(bench: Bench, contact: Contact, name: str, tolerance: float, printed: str) -> Finding:
    """Return one coefficient where the search ends, on several samples."""
    result = bench.result(f"recovered-{contact}")
    base, others = problem_from(result.settings), other_samples(bench, contact)
    how, every = SEARCHED[contact], all_free(base, contact)
    if name == "n":
        how, own = "a, b and n searched", searched(every, contact)[name]
        others = {key: all_free(problem, contact) for key, problem in others.items()}
    else:
        own = result.coefficients[name]
    found = {key: searched(problem, contact)[name] for key, problem in others.items()}
    free = {} if name == "n" else {"all coefficients searched": searched(every, contact)[name]}

    def off(value: float) -> float:
        return 100 * (value / float(printed) - 1)

    def miss(value: float) -> str:
        return "" if abs(off(value)) <= tolerance else f"{off(value):+.1f} %, over {tolerance:g} %"

    def reading(key: str, value: float, missing: str) -> Alternative:
        return judged(key, f"{value:.4g} ({off(value):+.1f} %)", miss(value), missing)

    return Finding(
        f"{own:.4g} ({off(own):+.1f} %); {min(found.values()):.3g} to {max(found.values()):.3g} on "
        "other samples",
        holds=not miss(own),
        choice=f"{how}; {SAMPLES[contact]}",
        missing=WINDOW,
        miss=miss(own),
        alternatives=[
            *(reading(key, value, WINDOW) for key, value in found.items()),
            *(reading(key, value, "") for key, value in free.items()),
        ],
        values={
            f"{name}, -": own,
            **{f"{name}, {key}, -": value for key, value in (found | free).items()},
        },
        paper_values={f"{name}, -": float(printed)},
    )


# --- one branch of Y ----------------------------------------------------------------------------


@claim(
    "3.1-no-single-Y",
    "for internal contact no single expression of Y gives a good fit over all clearances",
    paper="not possible",
    rule="no law with one branch of Y is as near to Johnson's as the published one with two "
    "(rms of ln δ)",
    figures=("fig_forms",),
    against="With a, b and the exponent of ΔR as published, two branches of Y fitted anew do come "
    "a quarter nearer than one.",
)
def no_single_Y(bench: Bench) -> Finding:
    """Return the objective of laws with one branch of Y, and of the published law."""
    problems = {
        "all searched; the ranges to the letter, all axes logarithmic": "internal",
        "all searched; E up to 1000 GPa": "internal-E1000",
        f"all searched; {SAMPLES['internal']}": "recovered-internal",
    }
    found: dict[str, tuple[float, float]] = {}
    for choice, result in problems.items():
        problem = all_free(problem_from(bench.result(result).settings), "internal")
        found[choice] = one_branch(problem), problem.value_of(asdict(PUBLISHED["internal"]))
    # The last of the problems once more.
    held, (*_, (_, published)) = problem, found.values()
    for name in ("a", "b", "n_exponent"):
        held = held.fixing(name, getattr(PUBLISHED["internal"], name))
    found["only Y searched; the same samples"] = one_branch(held), published
    two = problem.value_of(searched(problem, "internal"))

    def miss(one: float, published: float) -> str:
        return (
            "" if one > published else f"one branch is {100 * (1 - one / published):.0f} % nearer"
        )

    (choice, own), *others = found.items()
    return Finding(
        f"deviation {own[0]:.4f} with one branch, {own[1]:.4f} as published with two",
        holds=not miss(*own),
        choice=choice,
        missing=WINDOW,
        miss=miss(*own),
        alternatives=[
            judged(name, f"{values[0]:.4f} and {values[1]:.4f}", miss(*values), WINDOW)
            for name, values in others
        ],
        values={
            **{f"one branch, {name}, -": one for name, (one, _) in found.items()},
            "two branches searched anew, the recovering samples, -": two,
        },
    )


def one_branch(problem: Problem) -> float:
    """Return the least objective with the logarithmic or with the linear branch of Y alone."""
    start = asdict(PUBLISHED["internal"])
    ways = (
        problem.fixing("Y_slope", 0.0).fixing("Y_offset", 0.0),
        problem.fixing("Y_log_scale", 0.0).fixing("Y_log_exponent", 0.0),
    )
    return min(polish_across_kinks(way, way.point(start))[1] for way in ways)
