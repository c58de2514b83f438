"""Statements that are no longer judged, and why."""

from __future__ import annotations

from collections.abc import Mapping

WITHDRAWN: Mapping[str, str] = {
    "1-persson-needs-conformity": (
        "the paper reports what another work found for its own use of Persson's theory"
    ),
    "2-radzimovsky-comparable": (
        "the paper reports two earlier comparisons, and does not print the formula that it means"
    ),
    "4.2-baumgarte": "the paper gives its parameters, and says nothing that a run could contradict",
}
