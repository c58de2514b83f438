"""Do the tests see faults that would harm a user? One at a time, in copies of the last commit.

    python -m benchmarks.faults -j 2         # what is left of faults.toml, into faults.csv
    python -m benchmarks.faults --only laws/ # those whose text, kind or part matches this

The docstrings of the faulty file and the test files that speak most of it are tried first, then
all test files in that order, up to the first failure: as in `make test`, and if nothing fails the
slow tests too. What became of each fault stays in build/faults, for a run that was interrupted and
the next ones; it is tried again if the package has changed, or if it was missed and the tests have.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import re
import subprocess
import sys
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue

import pandas as pd

ROOT = Path(__file__).parents[1]
LIST, TABLE = ROOT / "benchmarks/faults.toml", ROOT / "benchmarks/faults.csv"
WORK = ROOT / "build/faults"
RESULTS = WORK / "results.jsonl"
PACKAGE = Path("src/cylcontact")
MARKS = {"make test": (), "make test-all": ("-m", "slow and not long")}
NEAR = 4  # test files that are tried first: to collect all of them takes longer
# Seconds for one run of pytest; the exit code of the program `timeout`.
LIMIT, TIMED_OUT = 3600, 124
IDENTITY = ("-c", "user.name=faults", "-c", "user.email=faults@localhost")
FAILED = re.compile(r"^(?:FAILED|ERROR) (\S.*?)(?: - .*)?$", re.MULTILINE)
COLUMNS = ["fault", "kind", "part", *MARKS, "by"]
Fault = dict[str, str]


def main() -> None:
    """Try what is left, and write the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults")
    parser.add_argument("-j", "--jobs", type=int, default=1, help="faults at a time")
    parser.add_argument("--only", default="", metavar="PATTERN", help="text, kind or part")
    asked = parser.parse_args()
    faults = tomllib.loads(LIST.read_text("utf-8"))["fault"]
    copies: SimpleQueue[Path] = SimpleQueue()
    for k in range(asked.jobs):
        copies.put(copy_of_head(WORK / f"copy-{k}"))
    trees = git("rev-parse", "HEAD:src", "HEAD:tests").split()
    known = results(trees[0])

    def try_one(fault: Fault) -> None:
        found = known.get(key_of(fault))
        missed = found is None or (found["make test"] != "caught" and found["trees"] != trees)
        about = " ".join([key_of(fault), fault["kind"], fault["part"]])
        if not (missed and re.search(asked.only, about)):
            return
        copy = copies.get()
        try:
            found = {"fault": key_of(fault), "trees": trees} | outcome(fault, copy)
        finally:
            copies.put(copy)
        with RESULTS.open("a", encoding="utf-8") as file:
            file.write(json.dumps(found, ensure_ascii=False) + "\n")
        print(f"{found['make test']:>10} {found['make test-all']:>10}  {key_of(fault)}", flush=True)

    with ThreadPoolExecutor(asked.jobs) as pool:
        list(pool.map(try_one, faults))
    found = results(trees[0])
    rows = [fault | found.get(key_of(fault), {}) | {"fault": key_of(fault)} for fault in faults]
    table = pd.DataFrame(rows, columns=COLUMNS).fillna("")
    table.to_csv(TABLE, index=False, lineterminator="\n")
    print(table[[*MARKS]].apply(pd.Series.value_counts).fillna(0).astype(int))


def key_of(fault: Fault) -> str:
    """Return a fault as one line."""
    return f"{fault['file']}: {fault['old'].strip()} -> {fault['new'].strip()}"


def results(tree: str) -> dict[str, dict]:
    """Return what became of the faults in this state of the package; later lines count."""
    lines = RESULTS.read_text("utf-8").splitlines() if RESULTS.exists() else []
    rows = [json.loads(line) for line in lines]
    return {row["fault"]: row for row in rows if row["trees"][0] == tree}


def git(*arguments: str, folder: Path = ROOT) -> str:
    """Return what git prints."""
    command = ["git", *arguments]
    return subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, text=True, check=True).stdout


def copy_of_head(copy: Path) -> Path:
    """Return a clone of this repository at its last commit, with the caches of an earlier run."""
    if not copy.exists():
        git("clone", "--quiet", "--shared", str(ROOT), str(copy))
    git("fetch", "--quiet", str(ROOT), "HEAD", folder=copy)
    git("reset", "--quiet", "--hard", "FETCH_HEAD", folder=copy)
    return copy


def nearest(file: Path, copy: Path) -> list[str]:
    """Return the test files, those that speak most of a module and its public names first."""
    body = ast.parse(file.read_text("utf-8")).body
    names = [n.name for n in body if isinstance(n, ast.FunctionDef | ast.ClassDef)]
    public = [re.escape(name) for name in (file.stem, *names) if not name.startswith("_")]
    words = re.compile(rf"\b(?:{'|'.join(public)})\b")
    texts = {test: test.read_text("utf-8") for test in (copy / "tests").rglob("test_*.py")}
    said = {test: len(words.findall(text)) for test, text in texts.items()}
    ranked = sorted(texts, key=lambda t: (file.stem not in t.stem, -said[t]))
    return [str(test.relative_to(copy)) for test in ranked]


def place_of(fault: Fault, package: Path) -> Path | None:
    """Return the file that holds a fault's old text once, perhaps another one than it was."""
    files = [*package.rglob("*.py"), *(package.parents[1] / "reports").glob("*.py")]
    counts = {f: f.read_text("utf-8").count(fault["old"]) for f in files}
    named = package / fault["file"]
    if counts.get(named) == 1:
        return named
    return max(counts, key=lambda f: counts[f]) if sum(counts.values()) == 1 else None


def outcome(fault: Fault, copy: Path) -> dict:
    """Apply a fault to a copy, and return which tests see it."""
    file = place_of(fault, copy / PACKAGE)
    if file is None:
        return {**dict.fromkeys(MARKS, "moved"), "by": ""}
    tests = [str(file.relative_to(copy)), *nearest(file, copy)]
    right, found = file.read_text("utf-8"), {"by": ""}
    file.write_text(right.replace(fault["old"], fault["new"]), encoding="utf-8")
    git(*IDENTITY, "commit", "--quiet", "-am", "A fault", folder=copy)  # some tests ask git
    command = ["timeout", "-k", "10", str(LIMIT), sys.executable, "-m", "pytest", "-qx"]
    settings = {
        "cwd": copy, "env": {**os.environ, "PYTHONPATH": str(copy / "src")}, "text": True,
        "stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT,
    }  # fmt: skip
    try:
        stages = [(column, some) for column in MARKS for some in (tests[: 1 + NEAR], tests)]
        for column, some in stages:
            words = [*command, "--tb=no", *some, *MARKS[column]]
            done = subprocess.run(words, check=False, **settings)
            if done.returncode in (1, 2) or "while loading conftest" in done.stdout:
                by = [*FAILED.findall(done.stdout), "the import"][0]
                found |= dict.fromkeys(list(MARKS)[list(MARKS).index(column) :], "caught")
                return found | {"by": by}
            if done.returncode not in (0, 5, TIMED_OUT):
                raise RuntimeError(f"pytest ended with {done.returncode}: {done.stdout[-2000:]}")
            found[column] = "not caught" if done.returncode != TIMED_OUT else "time limit"
    finally:
        git("reset", "--quiet", "--hard", "HEAD~", folder=copy)
    return found


if __name__ == "__main__":
    main()
