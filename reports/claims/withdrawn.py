"""Claims that earlier versions of the ledger had, and why they are gone."""

from __future__ import annotations

from collections.abc import Mapping

WITHDRAWN: Mapping[str, str] = {
    "2-johnson-good-to-its-limit": (
        "the paper says that Johnson's law ends at Eq 8's load, not that it is accurate up to "
        "there; how far it is off is in 1-johnson-needs-clearance"
    ),
    "3.1-external-a": "replaced by 3.1-recovered-external-a, which holds n as the paper does",
    "3.1-external-b": "replaced by 3.1-recovered-external-b, which holds n as the paper does",
    "3.1-external-n": "the paper reads n from Fig 3 (3.1-external-single-n); where searches end "
    "that have it free is said there",
    "3.1-several-runs": "the paper says that several runs were made, not that they were needed",
    "3.4-peak-near-25um": (
        "it is one sentence of the paper with 3.4-about-8-percent-at-25um, where depth and place "
        "of the maximum are now a reading"
    ),
}
