"""The claims ledger: every quantitative statement of the paper held against computed numbers."""

from cylcontact.reports.claims.calibration import claims as calibration_claims
from cylcontact.reports.claims.claim import VERDICTS, Claim, Verdict
from cylcontact.reports.claims.domain import DEFINITIONS
from cylcontact.reports.claims.full import full_ledger
from cylcontact.reports.claims.ledger import counts, ledger
from cylcontact.reports.claims.render import to_csv, to_json, to_records, to_table, to_text
from cylcontact.reports.claims.section4 import claims as mechanism_claims
from cylcontact.reports.claims.section32 import claims as finite_element_claims

__all__ = [
    "DEFINITIONS",
    "VERDICTS",
    "Claim",
    "Verdict",
    "calibration_claims",
    "counts",
    "finite_element_claims",
    "full_ledger",
    "ledger",
    "mechanism_claims",
    "to_csv",
    "to_json",
    "to_records",
    "to_table",
    "to_text",
]
