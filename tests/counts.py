"""How many cases the tests of faults and hostile input try, as docs/reliability.md states it."""

import json
import os
from pathlib import Path

COUNTS = Path(__file__).parent / "golden/counts.json"


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
