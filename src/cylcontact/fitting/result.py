"""Fit results: coefficients, their quality, and everything needed to redo the fit."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Literal

from pydantic import Field

from cylcontact.errors import InputError, short
from cylcontact.files import replacing
from cylcontact.fitting import report
from cylcontact.fitting.campaign import Campaign, campaign_from_settings
from cylcontact.fitting.uncertainty.estimates import Uncertainty
from cylcontact.fitting.uncertainty.profiles import Profile
from cylcontact.pair import Contact
from cylcontact.spec import Spec, parse_spec, require_other_kind

__all__ = [
    "FitResult",
    "MaxDifference",
    "ObjectiveValue",
    "Published",
    "RunRecord",
    "SampleCounts",
    "require_same_inputs",
]


class ObjectiveValue(Spec):
    """An objective's name and value."""

    name: str = Field(description="the objective's name")
    value: float = Field(description="its value")


class Published(Spec):
    """The published coefficients on the same data."""

    coefficients: dict[str, float] = Field(description="the coefficients of the law's source")
    objective: float = Field(description="their objective")


class MaxDifference(Spec):
    """Largest |Eq 9| over the data, in percent."""

    fitted: float = Field(description="of the fitted coefficients")
    published: float | None = Field(description="of the published ones, where there are any")


class SampleCounts(Spec):
    """Samples used, and samples that the reference's domain masked."""

    samples: int = Field(description="samples used")
    masked: int = Field(description="samples masked")


class RunRecord(Spec):
    """The result of a run; only the seconds differ between repeats."""

    index: int = Field(description="the run's place in the campaign")
    seed: int = Field(description="the seed of the search")
    population: int = Field(description="the population, which sets the budget of every search")
    crossover: str | None = Field(description="the crossover of a genetic search")
    objective_before_polish: float = Field(description="the best of the search")
    coefficients_before_polish: dict[str, float] = Field(description="those of the search alone")
    objective: float = Field(description="the objective after the polish")
    coefficients: dict[str, float] = Field(description="the coefficients after the polish")
    evaluations: int = Field(description="candidates that the search evaluated")
    seconds: float = Field(description="wall-clock time")


class FitResult(Spec):
    """The result of a campaign.

    `print(result)` gives the report, and a notebook shows it as a table. The coefficients can be
    passed to `laws.Enhanced(coefficients=...)`. `calibrate` has an example.
    """

    name: str = Field(description="the campaign's name")
    law: str = Field(description="the law fitted")
    contact: Contact = Field(description="the contact it is for")
    reference: str = Field(description="the law it was fitted to, or measurements")
    coefficients: dict[str, float] = Field(description="the fitted coefficients")
    objective: ObjectiveValue = Field(description="the objective reached")
    bound: float | None = Field(
        description="the per-clearance lower bound of the objective, for power laws"
    )
    published: Published | None = Field(description="the published coefficients' objective")
    max_abs_diff_percent: MaxDifference = Field(description="largest |Eq 9| over the data")
    profiles: dict[str, Profile] = Field(
        description="a profile for each free coefficient, for a law"
    )
    runs: list[RunRecord] = Field(description="every run")
    counts: SampleCounts = Field(description="samples used and masked")
    settings: dict[str, Any] = Field(description="the campaign and the grid, or the data, as run")
    provenance: dict[str, Any] = Field(description="versions and hashes")
    kind: Literal["discrepancy", "noise"] = Field(
        "discrepancy",
        description="whether the residuals are discrepancy of laws, or noise of data",
    )
    uncertainty: Uncertainty | None = Field(
        None, description="the uncertainty of the coefficients, for measured data"
    )

    @classmethod
    def load(cls, path: Path | str) -> FitResult:
        """Read a result file.

        Raises
        ------
        InputError
            If the file cannot be read, is not a result, or is inconsistent.
        """
        source = str(path)
        try:
            data = json.loads(Path(path).read_text(encoding="utf-8"))
        except OSError as error:
            raise InputError(
                source, "", None, f"cannot be read ({error.strerror})", "check the path"
            ) from error
        except UnicodeDecodeError as error:
            raise InputError(
                source, "", None, "is not a text file", "name a result, a JSON file"
            ) from error
        except (ValueError, RecursionError) as error:
            require_other_kind(path, "a fit result")
            raise InputError(
                source, "", None, f"is not JSON ({error})", "name a result, or redo the fit"
            ) from error
        if not isinstance(data, dict):
            raise InputError(source, "", None, "is not a result", "name one that a fit has written")
        result = parse_spec(cls, data, source)
        _require_consistent(result, source)
        return result

    def save(self, path: Path | str) -> None:
        """Write the result as JSON, complete or not at all."""
        with replacing(path) as temporary:
            text = json.dumps(self._plain(), indent=1, ensure_ascii=False, allow_nan=False)
            temporary.write_text(text + "\n", encoding="utf-8")

    def _plain(self) -> dict[str, Any]:
        """Return the contents of the file; only fits to measurements have the last two keys."""
        exclude = {"kind", "uncertainty"} if self.kind == "discrepancy" else None
        return self.model_dump(exclude=exclude)

    def repeatable(self) -> dict[str, Any]:
        """Return what the same seed reproduces: everything but times and provenance."""
        data = self.model_dump(exclude={"provenance"})
        for run in data["runs"]:
            del run["seconds"]
        return data

    def __str__(self) -> str:
        return report.as_text(self)

    def __repr__(self) -> str:
        return (
            f"FitResult({self.name!r}, {self.objective.name} = {self.objective.value:.6g}, "
            f"coefficients={self.coefficients})"
        )

    def _repr_html_(self) -> str:
        return report.as_html(self)


def require_same_inputs(path: Path, campaign: Campaign) -> None:
    """Refuse to replace a result of other inputs than those of a campaign.

    Parameters
    ----------
    path : Path
        Where the result will be written.
    campaign : Campaign
        The campaign.

    Raises
    ------
    InputError
        If the file exists and is another campaign's result, or not a result.
    """
    remedy = "write elsewhere with -o, or add --force to replace it"
    if not path.exists():
        return
    try:
        before = FitResult.load(path).settings
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
    """Return the differences between two settings, one text for each key.

    Examples
    --------
    >>> _differences({"law": "power", "seed": 1}, {"law": "hertz", "seed": 1})
    ["law: 'power' there, 'hertz' now"]
    """
    if before == now:
        return []
    if isinstance(before, dict) and isinstance(now, dict):
        names = [*before, *(name for name in now if name not in before)]
        pairs = ((f"{key}.{n}" if key else n, before.get(n), now.get(n)) for n in names)
        return [text for name, old, new in pairs for text in _differences(old, new, name)]
    old, new = (short(value, 40) or "nothing" for value in (before, now))
    return [f"{key} differs" if old == new else f"{key}: {old} there, {new} now"]


def _require_consistent(result: FitResult, source: str) -> None:
    """Refuse a result with invalid settings or inconsistent parts."""
    campaign = campaign_from_settings(result.name, result.settings, source)
    names = campaign.model.names
    _require_of_campaign(result, campaign, source)
    sets = {"coefficients": result.coefficients}
    if result.published is not None:
        sets["published.coefficients"] = result.published.coefficients
    sets |= {f"runs.{run.index}.coefficients": run.coefficients for run in result.runs}
    for key, coefficients in sets.items():
        if set(coefficients) != set(names):
            rule = f"must be the coefficients of its campaign: {', '.join(names)}"
            raise InputError(source, key, sorted(coefficients), rule, "redo the fit")
    if result.uncertainty is not None and not {*result.uncertainty.estimates} <= {*names}:
        rule = f"must be those of coefficients of its campaign: {', '.join(names)}"
        raise InputError(source, "uncertainty.estimates", None, rule, "redo the fit")
    for name, curve in result.profiles.items():
        if name not in names or len(curve.values) != len(curve.objective):
            rule = "must be that of a coefficient, with as many values as objectives"
            raise InputError(source, f"profiles.{name}", None, rule, "redo the fit")
    if not result.runs:
        raise InputError(source, "runs", [], "must hold at least one run", "redo the fit")


def _require_of_campaign(result: FitResult, campaign: Campaign, source: str) -> None:
    """Refuse a result whose law, contact, reference or kind is not that of its campaign."""
    model, data = campaign.model, campaign.data
    expected = {"law": model.law, "contact": model.contact, "kind": data.kind}
    for key, value in (expected | {"reference": data.reference}).items():
        if getattr(result, key) != value:
            rule = f"must be that of its campaign, {value}"
            raise InputError(source, key, getattr(result, key), rule, "redo the fit")
    if (data.kind == "noise") != (result.uncertainty is not None):
        rule = "is for fits to measurements, and required for them"
        raise InputError(source, "uncertainty", None, rule, "redo the fit")
