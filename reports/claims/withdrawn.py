"""Claims that earlier versions of the ledger had, and why they are gone."""

from __future__ import annotations

from collections.abc import Mapping

WITHDRAWN: Mapping[str, str] = {}
