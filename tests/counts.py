"""How many cases the tests of faults and hostile input try, as docs/reliability.md states it.

python -m tests.counts writes the counts into the page.
"""

import json
import os
import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
COUNTS = ROOT / "tests/golden/counts.json"
LONG_RUN = ROOT / "tests/fuzz/long_run.json"
PAGE = ROOT / "docs/reliability.md"
# What stands between two comments of the page is written here.
_WRITTEN = re.compile(r"(<!-- (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)


def recorded():
    """Return every recorded count, by its name."""
    return json.loads(COUNTS.read_text(encoding="utf-8"))


def counted(name, number):
    """Hold a test's own count of its cases against the recorded one.

    WRITE_COUNTS=1 in the environment records it instead; run the tests one after another then.
    """
    counts = recorded()
    if os.environ.get("WRITE_COUNTS"):
        text = json.dumps(dict(sorted({**counts, name: number}.items())), indent=1)
        COUNTS.write_text(text + "\n", encoding="utf-8")
    else:
        assert counts.get(name) == number, f"{name}: WRITE_COUNTS=1 records another number"


def table():
    """Return the counts as a table; the fuzzer's kinds of input have one of their own."""
    counts = {name: count for name, count in recorded().items() if ": " not in name}
    return _table("cases | number", counts)


def kinds():
    """Return the fuzzer's inputs by kind as a table."""
    parts = {name.partition(": ")[2]: count for name, count in recorded().items() if ": " in name}
    return _table("input | of 10,000", dict(sorted(parts.items(), key=lambda part: -part[1])))


def longest():
    """Return the fuzzer's longest run in a sentence."""
    run = json.loads(LONG_RUN.read_text(encoding="utf-8"))
    kinds = "one kind" if run["findings"] == 1 else f"{run['findings']} kinds"
    found = f"{kinds} of failure, since mended" if run["findings"] else "no failure"
    return (
        f"The longest run on record tried {run['cases']:,} inputs of seed {run['seed']} in "
        f"{run['seconds'] / 60:.0f} minutes on two cores, on {run['date']}, and found {found}."
    )


def written(page):
    """Return the text of the page with the counts of today."""
    parts = {"table": table, "kinds": kinds, "longest": longest}
    return _WRITTEN.sub(lambda found: f"{found[1]}\n{parts[found[2]]()}\n\n{found[3]}", page)


def _table(head, counts):
    rows = (f"| {name} | {count:,} |" for name, count in counts.items())
    return "\n".join([f"| {head} |", "|---|---:|", *rows])


if __name__ == "__main__":
    PAGE.write_text(written(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
