"""Claims: what a paper states, held against computed numbers.

A claim is a decorated function in a file of the bench's `reports/claims`. The decorator has the
sentence, the paper's value and the rule; the function computes our value, once for each reasonable
way to read the sentence, and returns a `Finding`:

    @claim(
        "3.2-below-10-percent",
        "the laws agree to 10 %",
        paper="< 10 %",
        rule="below 10 % at every load",
    )
    def below_10_percent(bench: Bench) -> Finding:
        '''Return the largest difference in percent.'''
        largest = ...
        return Finding(f"{largest:.1f} %", holds=largest < 10)

The verdict follows from the readings, see `Claim.verdict`; another reading than the first counts
only with a ground of its own in the text. The files are read in alphabetical order, and the claims
of one section stay in the order in which they are written. A file may have a function
`prepare(bench, progress)` for long computations; it is called before any claim.
"""

from __future__ import annotations

import inspect
import operator
import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path
from types import ModuleType
from typing import Any, Literal

from cylcontact.reports.bench import Bench, MissingInputError
from cylcontact.support.errors import InputError
from cylcontact.support.progress import Progress, silent

__all__ = [
    "VERDICTS",
    "Claim",
    "Finding",
    "Reading",
    "Verdict",
    "agrees_as_printed",
    "check",
    "claim",
    "joined",
    "ledger",
    "untestable",
    "with_unit",
    "withdrawn",
]

Verdict = Literal[
    "reproduced",
    "reproduced with a stated choice",
    "not reproduced",
    "undecided",
    "depends on a missing input",
    "not testable",
]
# Each with its meaning.
VERDICTS: Mapping[Verdict, str] = {
    "reproduced": "the rule is met, and nothing that the paper leaves open affects that",
    "reproduced with a stated choice": "the rule is met, with a choice of ours that is named",
    "not reproduced": "the rule is not met; each reading says by how much",
    "undecided": (
        "readings that the text supports disagree, or the uncertainty of a number includes the "
        "limit"
    ),
    "depends on a missing input": (
        "one plausible value of something that the paper's text lacks meets the rule, and another "
        "does not"
    ),
    "not testable": "there is nothing to compute",
}
Rule = Literal["<", "<=", ">", ">=", "within"]
RULES: Mapping[Rule, Callable[[float, float], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "within": operator.lt,
}
# A hyphen that is the sign of a number, as in "-1.5 %" and not in "1e-6" or "Ti-6Al".
MINUS = re.compile(r"(?<![\w.)])-(?=\d)")
Case = Mapping[str, Any]


@dataclass(frozen=True)
class Reading:
    """A way to understand and compute a claim, and what it gives.

    Attributes
    ----------
    choice : str
        What is chosen, such as "R_i = 5 mm".
    ours : str
        Our value, with its unit.
    holds : bool or None
        Whether the rule is met; None where the value is too uncertain to tell.
    missing : str
        The input of the paper that is missing and that this choice stands in for, such as
        "Table 2", or two with "and" between them; empty where the choice is one of reading.
    miss : str
        By how much the rule is missed, where it is not met.
    ground : str
        What in the text speaks for this reading. One that is not the first, and stands in for no
        missing input, counts only with it.
    """

    choice: str
    ours: str
    holds: bool | None
    missing: str = ""
    miss: str = ""
    ground: str = ""

    @property
    def counts(self) -> bool:
        """Whether the verdict hears this reading beside the first."""
        return bool(self.ground or self.missing)


def check(
    value: float,
    rule: Rule,
    bound: float,
    unit: str = "",
    choice: str = "",
    *,
    ours: str = "",
    missing: str = "",
    ground: str = "",
) -> Reading:
    """Return the reading by which a number must keep a bound.

    Parameters
    ----------
    value, bound : float
        In one unit.
    rule : {"<", "<=", ">", ">=", "within"}
        How they must compare; "within" is for the magnitude of the value.
    unit : str, optional
        Stands after the numbers; differences of percentages are told in points.
    choice, ours, missing, ground : str, optional
        As of `Reading`; `ours` is the value with its unit if it is not given.

    Examples
    --------
    >>> check(-12.34, "within", 10, "%")
    Reading(choice='', ours='-12.3 %', holds=False, missing='', miss='2.34 points off', ground='')
    >>> check(0.9991, ">", 0.998).holds
    True
    """
    size = abs(value) if rule == "within" else value
    holds = bool(RULES[rule](size, bound))
    off = f"{abs(size - bound):.3g} {'points' if unit == '%' else unit}".strip()
    sign = "+" if rule == "within" else ""
    text = ours or f"{value:{sign}.3g} {unit}".strip()
    return Reading(choice, text, holds, missing, "" if holds else f"{off} off", ground)


@dataclass(frozen=True)
class Finding:
    """Our side of a claim, computed by its function.

    Attributes
    ----------
    ours, holds, choice, missing, miss, ground
        The first reading, as of `Reading`; `choice` is empty where the paper states everything.
    alternatives : sequence of Reading
        The other reasonable ways to compute it.
    reason : str
        Why nothing can be computed; see `untestable`.
    values : mapping
        Our numbers in full precision, by a name that ends in the unit.
    paper_values : mapping
        The paper's numbers, where these come from its constants.
    rule : str
        The rule, where its wording depends on the data.
    """

    ours: str
    holds: bool | None
    choice: str = ""
    missing: str = ""
    miss: str = ""
    alternatives: Sequence[Reading] = ()
    ground: str = ""
    reason: str = ""
    values: Mapping[str, float] = field(default_factory=dict)
    paper_values: Mapping[str, float] = field(default_factory=dict)
    rule: str = ""

    @property
    def readings(self) -> tuple[Reading, ...]:
        """The reading of `choice` and the alternatives; none where nothing can be computed."""
        if self.reason:
            return ()
        own = Reading(self.choice, self.ours, self.holds, self.missing, self.miss, self.ground)
        return (own, *self.alternatives)


def untestable(reason: str) -> Finding:
    """Return the finding on a statement that no computation can judge.

    Examples
    --------
    >>> untestable("the paper gives no measured data").readings
    ()
    """
    return Finding("", None, reason=reason)


@dataclass(frozen=True)
class Claim:
    """A statement of the paper, our number for it, and whether they agree.

    Attributes
    ----------
    id : str
        Section and short name, such as "3.4-below-8-percent".
    statement : str
        What the paper says, in our words.
    paper : str
        The paper's value as printed, with its unit.
    rule : str
        What must be true for the statement to hold.
    finding : Finding
        What we computed.
    figures : tuple of str
        Recipes of the figures that show it.
    code : str
        File and line of its function, below the bench.
    misprint : bool
        Whether it is a slip of the print and not a statement; these are listed apart.
    """

    id: str
    statement: str
    paper: str
    rule: str
    finding: Finding
    figures: tuple[str, ...] = ()
    code: str = ""
    misprint: bool = False

    @property
    def section(self) -> str:
        """The paper's section, the first part of the id."""
        return self.id.partition("-")[0]

    @property
    def heard(self) -> tuple[Reading, ...]:
        """The readings that count: the first, and those with a ground or for a missing input."""
        own, *others = self.finding.readings or (None,)
        return (own, *(each for each in others if each.counts)) if own else ()

    @property
    def verdict(self) -> Verdict:
        """The verdict that follows from the readings heard; `VERDICTS` has the meanings."""
        found, heard = self.finding, self.heard
        holds = {reading.holds for reading in heard}
        if not heard:
            return "not testable"
        if holds == {True}:
            free = not (found.choice or found.missing)
            return "reproduced" if free else "reproduced with a stated choice"
        if holds == {False}:
            return "not reproduced"
        return "depends on a missing input" if _deciding(heard) else "undecided"

    @property
    def missing(self) -> tuple[str, ...]:
        """The missing inputs that the verdict depends on."""
        hangs = self.verdict == "depends on a missing input"
        return _deciding(self.heard) if hangs else ()

    @property
    def balance(self) -> str:
        """How many of the readings heard meet the rule, where there are several."""
        holds = [reading.holds for reading in self.heard]
        if len(holds) < 2:
            return ""
        parts = [f"met by {holds.count(True)} of {len(holds)} readings"]
        return joined(*parts, *([f"{holds.count(None)} cannot tell"] if None in holds else []))

    @property
    def basis(self) -> str:
        """What the verdict rests on: the rule, the choice, and how the readings stand."""
        found = self.finding
        if found.reason:
            return found.reason
        decides = f"{' and '.join(self.missing)} would decide" if self.missing else ""
        rule = f"rule: {self.rule}" if self.rule else ""
        choice = f"choice: {found.choice}" if found.choice else ""
        ground = f"ground: {found.ground}" if found.ground else ""
        return joined(rule, choice, ground, self.balance, decides)


def _deciding(readings: Sequence[Reading]) -> tuple[str, ...]:
    """Return the missing inputs that decide: one value in their place holds, another does not.

    None does if our reading and those that differ from it in words only disagree already.
    """
    sides: dict[str, set[bool | None]] = {"": {readings[0].holds}}
    for reading in readings:
        for name in reading.missing.split(" and "):
            sides.setdefault(name, set()).add(reading.holds)
    both = {True, False}
    if sides.pop("") >= both:
        return ()
    return tuple(name for name, holds in sides.items() if holds >= both)


@dataclass(frozen=True)
class ClaimFunction:
    """A decorated function: called with a bench, it returns one claim per case."""

    function: Callable[..., Finding]
    texts: tuple[str, str, str, str]
    figures: tuple[str, ...]
    paper_values: Mapping[str, float]
    cases: Sequence[Case]
    misprint: bool

    def __call__(self, bench: Bench) -> list[Claim]:
        return [self._one(bench, case) for case in self.cases]

    def _one(self, bench: Bench, case: Case) -> Claim:
        available = {"bench": bench, **case}
        parameters = inspect.signature(self.function).parameters
        try:
            finding = self.function(**{k: v for k, v in available.items() if k in parameters})
        except MissingInputError as error:
            finding = untestable(str(error))
        except InputError as error:
            where = f"claim {self.texts[0]}: {error.source}"
            raise InputError(where, error.key, error.value, error.rule, error.remedy) from error
        *texts, rule = self.texts
        # Without a case, braces in the texts are left alone.
        id, statement, paper, rule = (
            text.format(**case) if case else text for text in (*texts, finding.rule or rule)
        )
        finding = replace(
            finding,
            **_typeset(finding, "ours", "choice", "miss"),
            alternatives=[
                replace(each, **_typeset(each, "choice", "ours", "miss"))
                for each in finding.alternatives
            ],
            paper_values={**self.paper_values, **finding.paper_values},
        )
        code = _place_of(self.function, bench)
        return Claim(id, statement, paper, rule, finding, self.figures, code, self.misprint)


def _typeset(texts: Finding | Reading, *names: str) -> dict[str, Any]:
    """Return texts with a proper minus before their numbers."""
    return {name: MINUS.sub("\N{MINUS SIGN}", getattr(texts, name)) for name in names}


def _place_of(function: Callable[..., Finding], bench: Bench) -> str:
    """Return the file, below the bench's root, and the line of a claim's function."""
    code = inspect.unwrap(function).__code__
    file, root = Path(code.co_filename).resolve(), bench.root.resolve()
    name = file.relative_to(root) if file.is_relative_to(root) else Path(file.name)
    return f"{name.as_posix()}:{code.co_firstlineno}"


def claim(
    id: str,
    statement: str,
    *,
    paper: str,
    rule: str = "",
    figures: Sequence[str] = (),
    paper_values: Mapping[str, float] | None = None,
    cases: Sequence[Case] = ({},),
    misprint: bool = False,
) -> Callable[[Callable[..., Finding]], ClaimFunction]:
    """Return a decorator that makes a claim of a function.

    Parameters
    ----------
    id : str
        Section, hyphen, short name.
    statement : str
        What the paper says, in our words.
    paper : str
        The paper's value as printed, with its unit.
    rule : str, optional
        What must be true for the statement to hold; left out where the function words it.
    figures : sequence of str, optional
        Recipes of the figures that show it, such as "fig10".
    paper_values : mapping of str to float, optional
        The numbers in `paper`, by a name that ends in the unit.
    cases : sequence of mapping, optional
        One claim is made for each. Its values replace their names in braces in the texts, and the
        function gets those that it has parameters for. It gets the bench as `bench`, if it has
        that parameter.
    misprint : bool, optional
        Whether it is a slip of the print; these are listed apart and not counted.

    Examples
    --------
    >>> @claim("2-{name}-is-even", "{name} is even", paper="even", rule="2 divides it",
    ...        cases=[{"name": "four", "number": 4}, {"name": "seven", "number": 7}])
    ... def is_even(number):
    ...     return Finding(f"remainder {number % 2}", holds=number % 2 == 0)
    >>> for each in is_even(Bench(Path("bench"))):
    ...     print(f"{each.id}, {each.statement}: {each.finding.ours}, {each.verdict}")
    2-four-is-even, four is even: remainder 0, reproduced
    2-seven-is-even, seven is even: remainder 1, not reproduced
    """
    texts = (id, statement, paper, rule)
    return lambda function: ClaimFunction(
        function, texts, tuple(figures), paper_values or {}, cases, misprint
    )


def ledger(bench: Bench, progress: Progress = silent) -> list[Claim]:
    """Compute every claim of a bench.

    Parameters
    ----------
    bench : Bench
        The claims are in its `reports/claims/*.py`; its `jobs` run the mechanism's cases.
    progress : callable, optional
        Called with the stage, how many functions have been evaluated and their total.

    Returns
    -------
    list of Claim
        In the order of the paper's sections. A claim whose input has not been made is not
        testable.

    Raises
    ------
    InputError
        If two claims have the same id, or an input is wrong.
    """
    modules = _claim_modules(bench)
    for module in modules:
        if hasattr(module, "prepare"):
            module.prepare(bench, progress)
    functions = list(chain.from_iterable(map(_claim_functions, modules)))
    claims: list[Claim] = []
    progress("claims", 0, len(functions))
    for done, function in enumerate(functions, start=1):
        claims += function(bench)
        progress("claims", done, len(functions))
    for id, times in Counter(each.id for each in claims).items():
        if times > 1:
            rule, remedy = "two claims have this id", "give one of them another"
            raise InputError(str(bench.recipes_folder / "claims"), "id", id, rule, remedy)
    return sorted(claims, key=lambda each: _place_in_paper(each.section))


def _place_in_paper(section: str) -> tuple[bool, str]:
    """Return what sections sort by: those without a number, as an abstract, come first."""
    return section[:1].isdigit(), section


def withdrawn(bench: Bench) -> dict[str, str]:
    """Return the claims that a bench no longer makes, id → reason, in the order of sections.

    They stand in a mapping `WITHDRAWN` of a file of claims.
    """
    modules = _claim_modules(bench)
    reasons = {k: v for each in modules for k, v in getattr(each, "WITHDRAWN", {}).items()}
    return dict(
        sorted(reasons.items(), key=lambda item: _place_in_paper(item[0].partition("-")[0]))
    )


def _claim_modules(bench: Bench) -> list[ModuleType]:
    """Return the files of claims of a bench, in alphabetical order."""
    names = sorted(file.stem for file in (bench.recipes_folder / "claims").glob("*.py"))
    return [bench.module(f"claims.{name}") for name in names]


def _claim_functions(module: ModuleType) -> list[ClaimFunction]:
    """Return the claims of a file in the order in which they are written."""
    return [
        value
        for value in vars(module).values()
        if isinstance(value, ClaimFunction) and value.function.__module__ == module.__name__
    ]


# Helpers for the texts of claims.


def joined(*parts: str) -> str:
    """Return the parts that are not empty, separated by semicolons."""
    return "; ".join(filter(None, parts))


def agrees_as_printed(value: float, printed: str) -> bool:
    """Whether `value`, rounded to as many decimals as `printed` shows, is that number.

    Examples
    --------
    >>> agrees_as_printed(1.23700027, "1.2370"), agrees_as_printed(1.0939, "1.0935")
    (True, False)
    """
    decimals = len(printed.partition(".")[2])
    return round(value, decimals) == float(printed)


def with_unit(values: Mapping[str, float], unit: str) -> dict[str, float]:
    """Return `values` under names that end in `unit`.

    Examples
    --------
    >>> with_unit({"steel": 1.25}, "percent")
    {'steel, percent': 1.25}
    """
    return {f"{name}, {unit}": value for name, value in values.items()}
