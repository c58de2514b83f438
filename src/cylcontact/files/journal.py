"""Journals of finished parts, from which interrupted work resumes."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Hashable, Mapping
from contextlib import closing
from itertools import chain
from pathlib import Path
from typing import Any, TypeVar

from cylcontact.files.reading import marked, read_bytes
from cylcontact.files.writing import require_writable, unwritable
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import Call, Workers, call, run_calls

Case = TypeVar("Case", bound=Hashable)
Part = TypeVar("Part")
Result = TypeVar("Result")
_ANEW = "run without --resume to start again"


class Journal:
    """A file of finished parts of long work: a header, then one line of JSON for each.

    The header holds a key, a hash of everything that the parts depend on.
    """

    def __init__(self, path: Path, kind: str, key: str) -> None:
        require_writable(path)
        self.path = path
        self._kind = kind
        self._header = json.dumps(marked({kind: key}))

    def start(self) -> None:
        """Discard the parts recorded so far."""
        self.path.unlink(missing_ok=True)

    def load(self, parse: Callable[[Any], Part]) -> list[Part]:
        """Return the recorded parts; remove from the file what follows the last complete line."""
        contents = read_bytes(self.path) if self.path.exists() else b""
        complete = contents[: contents.rfind(b"\n") + 1]
        if complete != contents:  # a kill has cut the last line short
            os.truncate(self.path, len(complete))
        header, *lines = complete.decode(errors="replace").splitlines() or [self._header]
        if header != self._header:
            rule = f"belongs to other work: its {self._kind} or settings differ"
            raise InputError(str(self.path), "", None, rule, f"{_ANEW}, or restore the settings")
        try:
            return [parse(json.loads(line)) for line in lines]
        except InputError:
            raise
        except (ValueError, TypeError, KeyError) as error:
            raise InputError(str(self.path), "", None, "has a damaged line", _ANEW) from error

    def add(self, *parts: Mapping[str, Any]) -> None:
        """Append finished parts and flush them to the disk."""
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("a", encoding="utf-8") as file:
                lines = [] if file.tell() else [self._header]
                lines += map(json.dumps, parts)
                file.write("".join(f"{line}\n" for line in lines))
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise unwritable(self.path, error) from error


def run_recorded(
    calls: Mapping[tuple[Case, ...], Call],
    journal: Journal | None,
    parse: Callable[[Any], tuple[Case, Result]],
    entry: Callable[[Case, Result], Mapping[str, Any] | None],
    resume: bool,
    workers: Workers,
    progress: Callable[[int, int], None],
) -> dict[Case, Result]:
    """Run the calls whose results a journal lacks, and record each as it is done.

    Each call solves some cases and returns a dict of their results; `call_for` makes one for a
    single case. `entry` returns what the journal holds of a case, None if it is to be tried again;
    `parse` is its inverse. Without `resume` the journal starts anew.
    """
    cases = list(chain.from_iterable(calls))
    recorded = dict(journal.load(parse)) if journal and resume else {}
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


def _by_case(case: Any, function: Callable[..., Any], arguments: Any, named: Any) -> dict[Any, Any]:
    return {case: function(*arguments, **named)}
