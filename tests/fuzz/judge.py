"""What must hold of every command line: its exit code, its words, and what it leaves behind."""

import contextlib
import functools
import gc
import os
import resource
import signal
import threading
import time
import traceback
import warnings
from collections import Counter
from pathlib import Path
from typing import NamedTuple
from unittest import mock

import typer

from tests.fuzz import bench
from tests.fuzz.cases import Case, case_of
from tests.killable import processes

# Seconds that a command may take; more is called a hang.
PATIENCE = 20.0
# Bytes by which memory may grow while a thousand inputs are tried, and that one may ask for.
GROWTH, MEMORY = 300 << 20, 4 << 30
# Inputs between two looks at open files, threads and processes.
INTERVAL = 250
# Where commands write that are not told where.
BY_DEFAULT = {Path("reports/tables")}
# How lines of standard error begin that do not say that the input is wrong.
NOTES = ("warning: ", "missing, ")
# And of those that --resume says of good input when nothing is kept.
ANEW = ("cylcontact: no runs", "cylcontact: no cases", "cylcontact: there is")


class Verdict(NamedTuple):
    """A case, its exit code, and what is wrong with how it ended; "" if nothing is."""

    case: Case
    code: object
    wrong: str


class Hang(BaseException):
    """A command took too long."""


class Judge:
    """A bench in a folder, in which cases are tried one after another.

    It is used as a context: outside of it this process is as it was.
    """

    def __init__(self, folder, patience=PATIENCE):
        self.root = folder / "bench"
        self.root.mkdir()
        self.patience = patience
        self._contexts = contextlib.ExitStack()
        self._count, self._first_look = 0, None

    def __enter__(self):
        enter = self._contexts.enter_context
        enter(contextlib.chdir(self.root))
        command = functools.cache(typer.main.get_command)
        enter(mock.patch("typer.main.get_command", command))
        enter(mock.patch("cylcontact.provenance._git", side_effect=OSError))
        enter(warnings.catch_warnings())
        warnings.simplefilter("always")
        for kind in (DeprecationWarning, PendingDeprecationWarning, ImportWarning, ResourceWarning):
            warnings.simplefilter("ignore", kind)
        self.files = bench.good_files(self.root)
        for name, contents in self.files.items():
            (self.root / name).write_bytes(contents)
        for seam in bench.SEAMS:
            enter(mock.patch(seam, bench.planned))
        self.sources = bench.sources(self.files)
        limits = resource.getrlimit(resource.RLIMIT_AS)
        enter_limit = _address_space() + MEMORY
        resource.setrlimit(resource.RLIMIT_AS, (enter_limit, limits[1]))
        self._contexts.callback(resource.setrlimit, resource.RLIMIT_AS, limits)
        handler = signal.signal(signal.SIGALRM, _hang)
        self._contexts.callback(signal.signal, signal.SIGALRM, handler)
        self._good = self._state()
        return self

    def __exit__(self, *error):
        return self._contexts.__exit__(*error)

    def verdicts(self, seed, numbers):
        """Try the cases of a seed with these numbers, and yield a verdict on each."""
        for number in numbers:
            verdict = self.verdict(case_of(seed, number, self.sources, self.files))
            self._count += 1
            if not verdict.wrong and self._count % INTERVAL == 0:
                verdict = verdict._replace(wrong=self._left_behind())
            yield verdict

    def verdict(self, case):
        """Try a case in the good bench, which is restored after it."""
        for name, contents in case.files.items():
            (self.root / name).write_bytes(contents)
        before = self._state()
        begun = time.monotonic()
        signal.setitimer(signal.ITIMER_REAL, self.patience)
        try:
            code, errors = bench.run(case.words)
            wrong = _wrong_words(code, errors)
        except (Exception, Hang) as error:
            code, frames = type(error).__name__, traceback.extract_tb(error.__traceback__)
            own = [frame for frame in frames if "cylcontact" in Path(frame.filename).parts]
            where = (own or frames)[-1]
            wrong = f"{Path(where.filename).name}:{where.lineno}: {code}: {error}"
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
        if time.monotonic() - begun > self.patience:
            wrong = f"hang: more than {self.patience:g} s"
        wrong = wrong or self._wrong_files(case, before, code)
        self._restore()
        return Verdict(case, code, wrong)

    def _wrong_files(self, case, before, code):
        """Return what is wrong with the files that a command has left."""
        if Path.cwd() != self.root:
            os.chdir(self.root)
            return "the working directory is another one"
        after = self._state()
        changed = sorted(n for n in before.keys() | after.keys() if before.get(n) != after.get(n))
        asked = _asked(case.words) if code == 0 else set()
        above = {folder for path in asked for folder in path.parents}
        surplus = [
            name
            for name in changed
            if not ({Path(name), *Path(name).parents} & asked or Path(name) in above)
        ]
        return f"files left or changed: {', '.join(surplus)}" if surplus else ""

    def _state(self):
        """Return every file below the bench's parent, by name, with what changes if it does."""
        state = {}
        folders = [str(self.root.parent)]
        while folders:
            with os.scandir(folders.pop()) as entries:
                for entry in entries:
                    status = entry.stat(follow_symlinks=False)
                    is_folder = entry.is_dir(follow_symlinks=False)
                    folders += [entry.path] if is_folder else []
                    name = os.path.relpath(entry.path, self.root)
                    state[name] = (
                        None if is_folder else (status.st_ino, status.st_mtime_ns, status.st_size)
                    )
        return state

    def _restore(self):
        """Put the good files back, and remove all others."""
        now = self._state()
        for name in sorted(now.keys() - self._good.keys(), reverse=True):
            path = self.root / name
            path.rmdir() if now[name] is None else path.unlink()
        for name in sorted(self._good):
            if self._good[name] != now.get(name):
                path = self.root / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(self.files[name])
        self._good = self._state()

    def _left_behind(self):
        """Return what has piled up in this process since the first look."""
        gc.collect()
        numbers = Counter(
            files=sum(1 for _ in Path("/proc/self/fd").iterdir()),
            threads=threading.active_count(),
            processes=sum(parent == os.getpid() for parent, _, _ in processes().values()),
        )
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss << 10
        if self._first_look is None:
            self._first_look = numbers, peak
        more, grown = numbers - self._first_look[0], peak - self._first_look[1]
        if more:
            return f"left in the process: {dict(more)}"
        return f"memory grew by {grown >> 20} MB" if grown > GROWTH else ""


def _asked(words):
    """Return the files and folders that a command line may write."""
    forms = ((word, word.partition("=")[2], word[2:]) for word in words)  # --out=x, -ox
    parts = [part for form in forms for part in form if part]
    paths = [Path(os.path.normpath(part)) for part in parts]
    # C comes with a header. A fit that begins anew discards what an earlier one has kept.
    kept = [path.with_name(f"{path.name}.partial") for path in paths if path.name]
    headers = [path.with_suffix(".h") for path in paths if path.name]
    return {*paths, *kept, *headers, *BY_DEFAULT} - {Path()}


def _wrong_words(code, errors):
    """Return what is wrong with an exit code and with what was said on standard error."""
    lines = errors.split("\n")
    if lines.pop():
        return f"the last line has no end: {errors[-300:]!r}"
    notes = NOTES if code == 2 else (*NOTES, *ANEW)
    others = [line for line in lines if not line.startswith(notes)]
    if code not in (0, 1, 2):
        return f"exit code {code}: {errors!r}"
    if not all(line.isprintable() and len(line) < 2000 for line in lines):
        return f"not printable, or long: {errors[:300]!r} ({len(errors)} characters)"
    if len(others) != (code == 2) or "Traceback" in errors:
        return f"exit code {code} with {len(others)} lines: {errors[:600]!r}"
    return ""


def _hang(*_):
    raise Hang


def _address_space():
    """Return the address space of this process, in bytes."""
    return int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
