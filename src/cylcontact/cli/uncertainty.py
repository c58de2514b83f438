"""What `fit` does with a finished result: study its uncertainty."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cylcontact.cli.options import NUMBER, integer_from
from cylcontact.cli.terminal import progress_bars, say
from cylcontact.errors import InputError
from cylcontact.files import replacing, require_suffix, require_writable
from cylcontact.reading import marked

if TYPE_CHECKING:
    from cylcontact.cli.measured import LawOption
    from cylcontact.parallel import Workers


def _option(*names: str, help: str, **details: Any) -> Any:
    """Return an option in the help panel for results."""
    return typer.Option(*names, help=help, rich_help_panel="For a fit result", **details)


@dataclass(frozen=True)
class StudyOptions:
    """Options of `fit` for the uncertainty of a result; None or False if not given."""

    bootstrap: Annotated[
        int | None,
        _option(help="Refit to resampled data.", parser=integer_from(2), metavar="REFITS"),
    ] = None
    over: Annotated[
        str | None, _option(help="What to resample: rows (default), material, dR, pair or group.")
    ] = None
    leave_out: Annotated[
        str | None,
        _option(help="Leave out one after the other: material, dR, pair, group; E, nu, load."),
    ] = None
    pairs: Annotated[
        bool, _option("--pairs", help="Map each pair of parameters, into the output.")
    ] = False
    level: Annotated[
        float | None, _option(help="Level of the intervals; 0.95 by default.", **NUMBER)
    ] = None


def study_uncertainty(
    result: Path,
    options: StudyOptions,
    law: LawOption,
    seed: int | None,
    where: Workers,
    out: Path | None,
) -> None:
    """Estimate the uncertainty of a fit: noise of measurements, or discrepancy of laws."""
    from cylcontact.fitting import DataFit, FitResult, LawFit
    from cylcontact.fitting.discrepancy import DiscrepancyStudy, study_discrepancy
    from cylcontact.fitting.study import NoiseStudy, study_noise

    level = 0.95 if options.level is None else options.level
    bootstrap, over, leave_out = options.bootstrap, options.over, options.leave_out
    _require_study(result, out, level, bootstrap, over)
    fit = FitResult.read(result)
    study: NoiseStudy | DiscrepancyStudy
    with progress_bars() as progress:
        if isinstance(fit, DataFit):
            study = study_noise(
                fit,
                level=level,
                replicates=bootstrap,
                over=over or "rows",
                seed=seed,
                leave_out=leave_out,
                with_pairs=options.pairs,
                law=law.law,
                jobs=where,
                progress=progress,
            )
        elif isinstance(fit, LawFit):
            if bootstrap is not None:
                rule = "is for measurements: samples of a law carry no noise to resample"
                remedy = "use --leave-out dR or --leave-out material"
                raise InputError(str(result), "--bootstrap", bootstrap, rule, remedy)
            study = study_discrepancy(
                fit, leave_out=leave_out, with_pairs=options.pairs, jobs=where, progress=progress
            )
    _write(study, out)
    say(f"{study}\n\nwritten to {out}" if out else str(study))


def _require_study(
    result: Path, out: Path | None, level: float, bootstrap: int | None, over: str | None
) -> None:
    """Refuse invalid combinations of options."""
    if not 0.5 <= level < 1:
        raise InputError(
            str(result), "--level", level, "must be from 0.5 to below 1", "0.95 is common"
        )
    if over is not None and bootstrap is None:
        raise InputError(str(result), "--over", over, "is for the bootstrap", "add --bootstrap 500")
    if out is not None:
        require_suffix(out, ".json")
        require_writable(out)


def _write(study: Any, out: Path | None) -> None:
    """Write a study as JSON if --out is given."""
    if out is None:
        return
    with replacing(out) as temporary:
        contents = marked(study.model_dump(mode="json"))
        text = json.dumps(contents, indent=1, ensure_ascii=False)
        temporary.write_text(text + "\n", encoding="utf-8")
