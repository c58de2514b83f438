"""Write anew what the claims are pinned to: python -m tests.support.write_claims.

Read the difference before you commit it: a verdict that changes needs a reason.
"""

import json
from pathlib import Path

from cylcontact.reports.bench import Bench
from cylcontact.reports.claims import ledger
from cylcontact.reports.claims_text import what_stands

ROOT = Path(__file__).parents[2]
DIGITS = 10


def main():
    claims = ledger(Bench(ROOT, jobs=2))
    pinned = {
        claim.id: {
            "verdict": claim.verdict,
            "readings": [reading.holds for reading in claim.finding.readings],
            "numbers": {
                name: float(f"{value:.{DIGITS}g}") for name, value in claim.finding.values.items()
            },
        }
        for claim in claims
    }
    text = json.dumps(pinned, ensure_ascii=False, indent=1) + "\n"
    (ROOT / "tests" / "golden" / "claims.json").write_text(text, encoding="utf-8")
    print(what_stands(claims))


if __name__ == "__main__":
    main()
