"""Claims that earlier versions of the ledger had, and why they are gone."""

from __future__ import annotations

from collections.abc import Mapping

WITHDRAWN: Mapping[str, str] = {
    "3.4-peak-near-25um": (
        "it is one sentence of the paper with 3.4-about-8-percent-at-25um, where depth and place "
        "of the maximum are now a reading"
    ),
}
