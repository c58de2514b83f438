"""The claims ledger: every quantitative statement of the paper held against computed numbers."""

from cylcontact.reports.claims.calibration import claims as calibration_claims
from cylcontact.reports.claims.claim import VERDICTS, Claim, Verdict
from cylcontact.reports.claims.domain import DEFINITIONS
from cylcontact.reports.claims.ledger import counts, ledger
from cylcontact.reports.claims.render import to_csv, to_json, to_records, to_table, to_text

__all__ = [
    "DEFINITIONS",
    "VERDICTS",
    "Claim",
    "Verdict",
    "calibration_claims",
    "counts",
    "ledger",
    "to_csv",
    "to_json",
    "to_records",
    "to_table",
    "to_text",
]
