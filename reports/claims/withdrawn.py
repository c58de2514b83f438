"""Claims that earlier versions of the ledger had, and why they are gone."""

from __future__ import annotations

from collections.abc import Mapping

WITHDRAWN: Mapping[str, str] = {
    "2-johnson-good-to-its-limit": (
        "the paper says that Johnson's law ends at Eq 8's load, not that it is accurate up to "
        "there; how far it is off is in 1-johnson-needs-clearance"
    ),
}
