"""Do the tests see faults that would harm a user? One at a time, in copies of the last commit.

    python -m benchmarks.faults -j 2         # what is left of faults.toml, into faults.csv
    python -m benchmarks.faults --only laws/ # those whose text, kind or part matches this
    python -m benchmarks.faults --map        # find anew which tests run which functions

In build/faults stay, for a run that was interrupted and the next ones, which functions each test
file runs (by coverage.py, installed there; still of use after small changes) and what became of
each fault. It is tried again if the package has changed, or if it was missed and the tests have.

With --near 6 nothing is measured: the six test files that speak most of a faulty module are run,
which takes minutes in place of hours. What these miss, others may catch.

Of the test files that run the faulty function those named after its module come first, up to the
first failure: as in `make test`, and if nothing fails the slow tests too. What is compiled, or at
the top of a module, concerns all test files that import it.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import re
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue
from typing import Any

import pandas as pd

ROOT = Path(__file__).parents[1]
LIST, TABLE = ROOT / "benchmarks/faults.toml", ROOT / "benchmarks/faults.csv"
WORK = ROOT / "build/faults"
RESULTS, MAPS, TOOLS = WORK / "results.jsonl", WORK / "maps", WORK / "tools"
PACKAGE = Path("src/cylcontact")
QUICK, SLOW, BOTH = (), ("-m", "slow and not long"), ("-m", "not long")
# Seconds for one run of pytest; the exit code of the program `timeout`.
LIMIT, TIMED_OUT = 3600, 124
IDENTITY = ("-c", "user.name=faults", "-c", "user.email=faults@localhost")
FAILED = re.compile(r"^(?:FAILED|ERROR) (\S.*?)(?: - .*)?$", re.MULTILINE)
COLUMNS = ["fault", "kind", "part", "make test", "make test-all", "by"]
Fault = dict[str, str]


def main() -> None:
    """Try what is left, and write the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults")
    parser.add_argument("-j", "--jobs", type=int, default=1, help="faults at a time")
    parser.add_argument("--only", default="", metavar="PATTERN", help="text, kind or part")
    parser.add_argument("--map", action="store_true", help="measure all test files anew")
    parser.add_argument("--near", type=int, default=0, metavar="N", help="N files and no map")
    asked = parser.parse_args()
    faults = tomllib.loads(LIST.read_text("utf-8"))["fault"]
    if asked.map:
        shutil.rmtree(MAPS, ignore_errors=True)
    MAPS.mkdir(parents=True, exist_ok=True)
    copies: SimpleQueue[Path] = SimpleQueue()
    for k in range(asked.jobs):
        copies.put(copy_of_head(WORK / f"copy-{k}"))
    files = git("ls-tree", "-r", "--name-only", "HEAD", "tests/").split()
    # The docstrings of the package are one test file more.
    tests = [*(name for name in files if re.search(r"/test_\w+\.py$", name)), "src"]
    if not asked.near:
        in_turn(asked.jobs, copies, record_map, tests)
    maps = {m["name"]: m for m in (json.loads(f.read_text()) for f in MAPS.glob("*.json"))}
    trees = git("rev-parse", "HEAD:src", "HEAD:tests").split()
    known = results(trees[0])

    def try_one(fault: Fault, copy: Path) -> None:
        found = {"fault": key_of(fault), "trees": trees} | outcome(fault, copy, maps, asked.near)
        with RESULTS.open("a", encoding="utf-8") as file:
            file.write(json.dumps(found, ensure_ascii=False) + "\n")
        print(f"{found['make test']:>10} {found['make test-all']:>10}  {key_of(fault)}", flush=True)

    def is_left(fault: Fault) -> bool:
        found = known.get(key_of(fault))
        again = found is None or (found["make test"] != "caught" and found["trees"] != trees)
        about = " ".join([key_of(fault), fault["kind"], fault["part"]])
        return again and re.search(asked.only, about) is not None

    in_turn(asked.jobs, copies, try_one, filter(is_left, faults))
    print(written_table(faults, results(trees[0])))


def in_turn(jobs: int, copies: SimpleQueue[Path], work: Any, items: Iterable[Any]) -> None:
    """Work on every item in the next copy that is free."""

    def one(item: Any) -> None:
        copy = copies.get()
        try:
            work(item, copy)
        finally:
            copies.put(copy)

    with ThreadPoolExecutor(jobs) as pool:
        list(pool.map(one, items))


def key_of(fault: Fault) -> str:
    """Return a fault as one line."""
    return f"{fault['file']}: {fault['old'].strip()} -> {fault['new'].strip()}"


def results(sources: str) -> dict[str, dict[str, Any]]:
    """Return the last result of each fault in these sources."""
    lines = RESULTS.read_text("utf-8").splitlines() if RESULTS.exists() else []
    every = [found for found in map(json.loads, lines) if found["trees"][0] == sources]
    return {found["fault"]: found for found in every}


def written_table(faults: list[Fault], known: dict[str, dict[str, Any]]) -> str:
    """Write the table of all faults; return the summary."""
    rows = [known.get(key_of(fault), {}) | fault | {"fault": key_of(fault)} for fault in faults]
    table = pd.DataFrame(rows, columns=COLUMNS).fillna("")
    table.to_csv(TABLE, index=False)
    count = table["make test"].value_counts()
    rest = sum(table["make test-all"] == "caught")
    return (
        f"Of {len(table)} faults make test catches {count.get('caught', 0)}, with make test-all "
        f"{rest}; {count.get('moved', 0)} moved, {count.get('', 0)} not tried; {TABLE}"
    )


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


def run_tests(
    copy: Path, arguments: Iterable[str], path: str = "", **settings: str
) -> tuple[int, str, float]:
    """Run pytest in a copy; return its exit code, what it said and how long it took."""
    said, began = copy / "build/said.txt", time.monotonic()
    said.parent.mkdir(exist_ok=True)
    python = ["timeout", "-k", "10", str(LIMIT), sys.executable]
    environment = {"PYTHONPATH": f"{copy / 'src'}{os.pathsep}{path}", **settings}
    with said.open("wb") as file:
        code = subprocess.run(
            [*python, "-m", "pytest", "-q", "--tb=no", *arguments],
            cwd=copy, env=os.environ | environment,
            stdin=subprocess.DEVNULL, stdout=file, stderr=file, check=False,
        ).returncode  # fmt: skip
    return code, said.read_text("utf-8", "replace"), time.monotonic() - began


def record_map(name: str, copy: Path) -> None:
    """Write which functions a test file runs, how long it takes and what fails without a fault."""
    out, data = MAPS / f"{name.replace('/', '-')}.json", copy / "build/measured"
    if out.exists():
        return
    if not (TOOLS / "coverage").exists():
        pip = [sys.executable, "-m", "pip", "install", "--quiet", "--target", str(TOOLS)]
        subprocess.run([*pip, "coverage"], check=True)
    # Every process that has this folder on its path measures itself.
    (TOOLS / "sitecustomize.py").write_text("import coverage\ncoverage.process_startup()\n")
    shutil.rmtree(data, ignore_errors=True)
    data.mkdir(parents=True)
    quiet = "no-data-collected, module-not-measured, module-not-imported"
    settings = f"parallel = true\nsource = {copy / PACKAGE}\ndata_file = {data}/part\n"
    (data / "settings").write_text(f"[run]\n{settings}disable_warnings = {quiet}\n")
    measure = {"COVERAGE_PROCESS_START": str(data / "settings")}
    _, said, seconds = run_tests(copy, [*BOTH, name], str(TOOLS), **measure)
    broken = FAILED.findall(said)
    if broken:  # perhaps because they were measured
        broken = FAILED.findall(run_tests(copy, [*BOTH, *broken])[1])
    sys.path.append(str(TOOLS))
    from coverage import CoverageData

    ran: dict[str, set[int]] = {}
    for part in data.glob("part.*"):
        measured = CoverageData(str(part))
        measured.read()
        for file in filter(re.compile(r".*\.py").fullmatch, measured.measured_files()):
            ran.setdefault(file, set()).update(measured.lines(file) or ())
    functions = {
        Path(file).relative_to(copy / PACKAGE).as_posix(): [
            function for function, own in functions_of(Path(file)) if own & lines
        ]
        for file, lines in sorted(ran.items())
    }
    found = {"name": name, "seconds": seconds, "broken": broken, "functions": functions}
    out.write_text(json.dumps(found), encoding="utf-8")
    print(f"{seconds:8.0f} s  {name}  {' '.join(broken)}", flush=True)


def functions_of(file: Path) -> Iterator[tuple[str, set[int]]]:
    """Yield each function of a source with the lines of its body."""

    def below(node: ast.AST, name: str) -> Iterator[tuple[str, set[int]]]:
        for child in ast.iter_child_nodes(node):
            inner = f"{name}.{getattr(child, 'name', '')}".rstrip(".")
            if isinstance(child, ast.FunctionDef):
                yield inner, set(range(child.body[0].lineno, (child.end_lineno or 0) + 1))
            yield from below(child, inner)

    yield from below(ast.parse(file.read_text("utf-8")), "")


def chosen(file: Path, line: int, copy: Path, maps: dict[str, Any]) -> list[str]:
    """Return the test files that run the function of a line, else those that import its module."""
    inside = file.relative_to(copy / PACKAGE).as_posix()
    importing = [name for name, found in maps.items() if inside in found["functions"]]
    around = [function for function, own in functions_of(file) if line in own][-1:]
    running = [n for n in importing if set(around) & set(maps[n]["functions"][inside])]

    def order(name: str) -> tuple[bool, bool, float]:
        text = (copy / name).read_text("utf-8") if (copy / name).is_file() else ""
        return file.stem not in name, file.stem not in text, maps[name]["seconds"]

    return sorted(running or importing, key=order)


def nearest(file: Path, copy: Path, number: int) -> list[str]:
    """Return the test files that speak most of a module and its public names."""
    body = ast.parse(file.read_text("utf-8")).body
    names = [n.name for n in body if isinstance(n, ast.FunctionDef | ast.ClassDef)]
    public = [re.escape(name) for name in (file.stem, *names) if not name.startswith("_")]
    words = re.compile(rf"\b(?:{'|'.join(public)})\b")
    texts = {test: test.read_text("utf-8") for test in (copy / "tests").rglob("test_*.py")}
    said = {test: len(words.findall(text)) for test, text in texts.items()}
    ranked = sorted(filter(said.get, said), key=lambda t: (file.stem not in t.stem, -said[t]))
    return [str(test.relative_to(copy)) for test in ranked[:number]]


def place_of(fault: Fault, package: Path) -> Path | None:
    """Return the file that holds a fault's old text once, perhaps another one than it was."""
    named = package / fault["file"]
    if named.exists() and named.read_text("utf-8").count(fault["old"]) == 1:
        return named
    counts = {f: f.read_text("utf-8").count(fault["old"]) for f in package.rglob("*.py")}
    return max(counts, key=lambda f: counts[f]) if sum(counts.values()) == 1 else None


def outcome(fault: Fault, copy: Path, maps: dict[str, Any], near: int) -> dict[str, Any]:
    """Apply a fault to a copy, and return which tests see it."""
    file = place_of(fault, copy / PACKAGE)
    if file is None:
        return {"make test": "moved", "make test-all": "moved", "by": ""}
    right = file.read_text("utf-8")
    line = right[: right.index(fault["old"])].count("\n") + 1
    files = nearest(file, copy, near) if near else chosen(file, line, copy, maps)
    failing = [test for name in files if not near for test in maps[name]["broken"]]
    broken = [f"--deselect={test}" for test in failing]
    tests = ["-x", *broken, str(file.relative_to(copy)), *files]  # its own docstrings first
    found: dict[str, Any] = {"by": "", "seconds": 0}
    file.write_text(right.replace(fault["old"], fault["new"]), encoding="utf-8")
    git(*IDENTITY, "commit", "--quiet", "-am", "A fault", folder=copy)  # some tests ask git
    try:
        for column, marks in (("make test", QUICK), ("make test-all", SLOW)):
            code, said, seconds = run_tests(copy, [*tests, *marks])
            found["seconds"] += round(seconds)
            if code in (1, 2) or "while loading conftest" in said:
                found |= {column: "caught", "by": [*FAILED.findall(said), "the import"][0]}
                break
            if code == TIMED_OUT:
                found[column] = "time limit"
                break
            if code not in (0, 5):
                raise RuntimeError(f"pytest ended with {code}: {said[-2000:]}")
            found[column] = "not by the nearest" if near else "not caught"
    finally:
        git("reset", "--quiet", "--hard", "HEAD~", folder=copy)
    return {"make test-all": found.get("make test"), **found}


if __name__ == "__main__":
    main()
