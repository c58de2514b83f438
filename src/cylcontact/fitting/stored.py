"""Result files of either kind: to read one, and not to replace one of other inputs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from cylcontact.files.spec import parse_spec
from cylcontact.fitting.campaign import Campaign
from cylcontact.fitting.data_fit import DataFit
from cylcontact.fitting.results import LawFit, contents_of
from cylcontact.support.errors import InputError, short


def read_result(path: Path | str) -> LawFit | DataFit:
    """Read a result file, of a fit to a law or to readings.

    Parameters
    ----------
    path : path
        A JSON file that a fit has written.

    Raises
    ------
    InputError
        If the file cannot be read, is no result, is of another format, or is inconsistent.

    Examples
    --------
    >>> result = read_result("fitting/results/external.json")
    >>> result.kind, result.law, sorted(result.coefficients)
    ('law', 'enhanced', ['a', 'b', 'n'])
    """
    data, source = contents_of(path), str(path)
    result: LawFit | DataFit
    if data["kind"] == "readings":
        result = parse_spec(DataFit, data, source)
    else:
        result = parse_spec(LawFit, data, source)
    result.require_consistent(source)
    return result


def require_same_inputs(path: Path, campaign: Campaign) -> None:
    """Refuse to replace a result of other inputs than those of a campaign."""
    remedy = "write elsewhere with -o, or add --force to replace it"
    if not path.exists():
        return
    try:
        before = read_result(path).settings
    except InputError as error:
        rule = "is in the place of the result and cannot be read as one"
        raise InputError(str(path), "", None, rule, remedy) from error
    now = json.loads(json.dumps(campaign.settings))
    changed = _differences(before, now)
    if changed:
        more = f", and {len(changed) - 2} more" if len(changed) > 2 else ""
        named = ", ".join(changed[:2]) + more
        rule = f"holds a result that came from other inputs ({named})"
        raise InputError(str(path), "", None, rule, remedy)


def _differences(before: Any, now: Any, key: str = "") -> list[str]:
    if before == now:
        return []
    if isinstance(before, dict) and isinstance(now, dict):
        names = [*before, *(name for name in now if name not in before)]
        pairs = ((f"{key}.{n}" if key else n, before.get(n), now.get(n)) for n in names)
        return [text for name, old, new in pairs for text in _differences(old, new, name)]
    old, new = (short(value, 40) or "nothing" for value in (before, now))
    return [f"{key} differs" if old == new else f"{key}: {old} there, {new} now"]
