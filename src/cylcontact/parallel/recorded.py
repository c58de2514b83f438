"""Run calls for cases and record each as it is done, so that interrupted work resumes."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from contextlib import closing
from functools import partial
from itertools import chain
from typing import Any, TypeVar

from cylcontact.journal import Journal
from cylcontact.parallel.calls import Call, call
from cylcontact.parallel.run import Workers, run_calls

__all__ = ["call_for", "run_recorded"]

Case = TypeVar("Case", bound=Hashable)
Result = TypeVar("Result")


def run_recorded(
    calls: Mapping[tuple[Case, ...], Call],
    journal: Journal | None,
    parse: Callable[[Any], tuple[Case, Result]],
    entry: Callable[[Case, Result], Mapping[str, Any] | None],
    resume: bool,
    workers: Workers,
    progress: Callable[[int, int], None],
) -> dict[Case, Result]:
    """Run the calls whose results a journal lacks, and record each.

    Parameters
    ----------
    calls : mapping
        Each call by the cases it solves together; it returns a dict of their results. See
        `call_for` for a call for one case.
    journal : Journal, optional
        The finished cases.
    parse : callable
        Returns a case and its result from an entry of the journal.
    entry : callable
        Returns the journal's entry for a case and its result; None if it is to be tried again.
    resume : bool
        Whether to take the cases already in the journal from there, or to discard them.
    workers : int or Cluster
        Where to run the calls; the results do not depend on it.
    progress : callable
        Called with the number of cases done and their total.

    Returns
    -------
    dict
        The results by case, in the order of `calls`.

    Raises
    ------
    InputError
        If a call raises it, or the journal cannot be used.

    Examples
    --------
    >>> from cylcontact.parallel import call
    >>> calls = {("a", "b"): call(dict, a=1, b=2), ("c",): call_for("c", call(abs, -3))}
    >>> run_recorded(calls, None, tuple, lambda *_: None, False, 1, print)
    0 3
    2 3
    3 3
    {'a': 1, 'b': 2, 'c': 3}
    """
    cases = list(chain.from_iterable(calls))
    recorded = dict(journal.load(partial(_hashable, parse))) if journal and resume else {}
    if journal and not resume:
        journal.start()
    results = {case: recorded[case] for case in cases if case in recorded}
    missing = [each for group, each in calls.items() if not results.keys() >= set(group)]
    progress(len(results), len(cases))
    with closing(run_calls(missing, workers, ordered=False)) as solved:
        for part in solved:
            results |= part
            finished = [line for each in part.items() if (line := entry(*each)) is not None]
            if journal and finished:
                journal.add(*finished)
            progress(len(results), len(cases))
    return {case: results[case] for case in cases}


def call_for(case: Hashable, deferred: Call) -> Call:
    """Return a call that returns the result of another in a dict, by its case."""
    return call(_by_case, case, *deferred)


def _hashable(parse: Callable[[Any], tuple[Case, Result]], part: Any) -> tuple[Case, Result]:
    """Return a case and its result; raise `TypeError`, as for other damage, if it is no case."""
    case, result = parse(part)
    hash(case)
    return case, result


def _by_case(
    case: Case, function: Callable[..., Result], arguments: Any, named: Any
) -> dict[Case, Result]:
    """Return the result of a call by its case."""
    return {case: function(*arguments, **named)}
