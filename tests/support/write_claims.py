"""Write anew what the claims are pinned to: python -m tests.support.write_claims.

Read the difference before you commit it: a verdict that changes needs a reason. A number that moves
by round-off only stays as it was.
"""

import json
import math
from pathlib import Path

from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import ledger
from cylcontact.reports.claims_text import what_stands

ROOT = Path(__file__).parents[2]
PINNED = ROOT / "tests" / "golden" / "claims.json"
DIGITS, ROUND_OFF = 10, 1e-6


def main():
    claims = ledger(Bench(ROOT, jobs=2))
    before = json.loads(PINNED.read_text("utf-8"))

    def number_of(claim, name, value):
        old = before.get(claim.id, {"numbers": {}})["numbers"].get(name, math.nan)
        same = math.isclose(old, value, rel_tol=ROUND_OFF, abs_tol=1e-12)
        return old if same else float(f"{value:.{DIGITS}g}")

    pinned = {
        claim.id: {
            "verdict": claim.verdict,
            "readings": [reading.holds for reading in claim.finding.readings],
            "numbers": {
                name: number_of(claim, name, value) for name, value in claim.finding.values.items()
            },
        }
        for claim in claims
    }
    text = json.dumps(pinned, ensure_ascii=False, indent=1) + "\n"
    PINNED.write_text(text, encoding="utf-8")
    print(what_stands(claims))


if __name__ == "__main__":
    main()
