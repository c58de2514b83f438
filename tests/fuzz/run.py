"""`make fuzz`: as many inputs as one likes, in as many processes as there are cores.

What goes wrong is made smaller and written to the corpus, whose tests then fail until it is mended.
"""

import argparse
import base64
import contextlib
import json
import os
import re
import signal
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from datetime import date
from multiprocessing import get_context
from pathlib import Path
from subprocess import check_output

from rich.progress import MofNCompleteColumn, Progress

from cylcontact.cli.terminal import cores
from tests.counts import LONG_RUN
from tests.fuzz.cases import Case
from tests.fuzz.judge import Judge

HERE = Path(__file__).parent
CORPUS = HERE / "corpus"
# How many inputs a process tries before it says so.
PART = 100
# Of each worker process: its judge, and what it has found.
JUDGE = None
FOUND = set()


def read_case(path):
    """Return a case of the corpus."""
    stored = json.loads(path.read_text(encoding="utf-8"))
    files = {name: base64.b64decode(contents) for name, contents in stored["base64"].items()}
    files |= {name: text.encode() for name, text in stored["files"].items()}
    return Case(stored["kind"], tuple(stored["words"]), files)


def write_case(case, wrong):
    """Write a case to the corpus under a name made of what is wrong with it; return the file."""
    texts, others = {}, {}
    for name, contents in case.files.items():
        try:
            texts[name] = contents.decode()
        except UnicodeDecodeError:
            others[name] = base64.b64encode(contents).decode()
    stored = {"showed": wrong, "kind": case.kind, "words": case.words}
    text = json.dumps(stored | {"files": texts, "base64": others}, indent=1)
    words = re.sub(r"[^a-z0-9]+", "-", f"{' '.join(case.words[:1])} {wrong}".lower())
    path = CORPUS / f"{words[:60].strip('-')}.json"
    path.write_text(text + "\n", encoding="utf-8")
    return path


def shrunk(case, judge, wrong):
    """Return a smaller case that fails alike: without words, files or lines it does not need."""

    def fails(smaller):
        return _gist(judge.verdict(smaller).wrong) == _gist(wrong)

    for name in case.files:
        smaller = case._replace(files={k: v for k, v in case.files.items() if k != name})
        case = smaller if fails(smaller) else case
    for at in reversed(range(len(case.words))):
        smaller = case._replace(words=case.words[:at] + case.words[at + 1 :])
        case = smaller if fails(smaller) else case
    for name in case.files:
        size = len(case.files[name].splitlines()) // 2
        while size:
            lines = case.files[name].splitlines(keepends=True)
            for at in reversed(range(0, len(lines), size)):
                fewer = b"".join(lines[:at] + lines[at + size :])
                smaller = case._replace(files={**case.files, name: fewer})
                if fails(smaller):
                    case, lines = smaller, fewer.splitlines(keepends=True)
            size //= 2
    return case


def _gist(wrong):
    """Return what is wrong without what differs from input to input."""
    return tuple(re.split(r"[:'\"]", wrong)[:3])


def _start(folder):
    """Make the judge of this process, which leaves Ctrl-C to the one that started it."""
    global JUDGE  # noqa: PLW0603
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    own = Path(folder, str(os.getpid()))
    own.mkdir()
    JUDGE = Judge(own).__enter__()


def _findings(seed, numbers):
    """Return the cases among some numbers that fail in a new way, each with what is wrong."""
    findings = []
    for verdict in JUDGE.verdicts(seed, numbers):
        if verdict.wrong and _gist(verdict.wrong) not in FOUND:
            FOUND.add(_gist(verdict.wrong))
            findings.append((shrunk(verdict.case, JUDGE, verdict.wrong), verdict.wrong))
    return findings


def fuzz(seed, cases, jobs):
    """Try cases in processes; yield how many are done and what failed."""
    parts = [range(at, min(at + PART, cases)) for at in range(0, cases, PART)]
    with tempfile.TemporaryDirectory() as folder:
        pool = ProcessPoolExecutor(jobs, get_context("spawn"), _start, (folder,))
        try:
            for part in as_completed([pool.submit(_findings, seed, part) for part in parts]):
                yield PART, part.result()
        finally:
            pool.shutdown(cancel_futures=True)


def main():
    parser = argparse.ArgumentParser(prog="make fuzz", description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=cores())
    parser.add_argument("--record", action="store_true", help=f"write {LONG_RUN.name}")
    options = parser.parse_args()
    begun, found = time.monotonic(), {}
    with Progress(*Progress.get_default_columns(), MofNCompleteColumn()) as progress:
        bar = progress.add_task("fuzzing", total=options.cases)
        for count, findings in fuzz(options.seed, options.cases, options.jobs):
            progress.advance(bar, count)
            for case, wrong in findings:
                if _gist(wrong) not in found:
                    found[_gist(wrong)] = write_case(case, wrong)
                    progress.console.print(f"{found[_gist(wrong)]}: {wrong}", markup=False)
    seconds = round(time.monotonic() - begun)
    print(f"{options.cases:,} inputs of seed {options.seed} in {seconds} s: {len(found)} findings")
    if options.record:
        commit = check_output(["git", "rev-parse", "--short", "HEAD"], text=True)
        record = {"seed": options.seed, "cases": options.cases, "findings": len(found)}
        record |= {"date": str(date.today()), "commit": commit.strip(), "seconds": seconds}
        LONG_RUN.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    with contextlib.suppress(KeyboardInterrupt):
        main()
    sys.exit(130)
