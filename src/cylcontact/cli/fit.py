"""The commands `sample`, `fit`, `choose`, `predict`, `design` and others of fits."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from cylcontact.choices import BRANCHES, CHOICE_FILES, DESIGN_FILES, FIT_FILES, is_table, listed
from cylcontact.cli.options import (
    FORCE,
    JOBS,
    LOSSES,
    NOISES,
    OPTIMIZERS,
    RESULTS,
    RESUME,
    SCHEDULER,
    Options,
    argument,
    count,
    number,
    numbers,
    option,
    output,
    plain_numbers,
    require_output,
    resumable,
    several,
    split,
    takes,
)
from cylcontact.cli.pair import (
    IN_CONSTANTS,
    OF_PIN_AND_HOLE,
    PAIR,
    blaming_options,
    constants_of,
    housing_of,
    option_of,
)
from cylcontact.cli.terminal import noting, progress_bars, say, workers
from cylcontact.errors import InputError, require
from cylcontact.files import replacing, require_suffix, require_writable
from cylcontact.reading import marked, require_file

if TYPE_CHECKING:
    from cylcontact.fitting import Campaign, FitResult, TableCampaign
    from cylcontact.fitting.table_campaign import MeasuredTable

# Loads among which a design chooses.
_DESIGN_LOADS = 41

DATA = argument("A table, .csv, .txt, .xlsx or .parquet.", metavar="TABLE")
RESULT = argument("A fit, e.g. results/NAME/result.json.", metavar="RESULT")
RUNS = count(1, "Runs, instead of the campaign's.")
SEED = count(0, "Seed of the random numbers.")
LEVEL = number("Level of the intervals.", default=0.95)
OWN_LAW = option("The law, if it is your own function.", metavar="MODULE:FUNCTION")
_PANEL = {"rich_help_panel": "For a table"}
_ANY = "[,...]"


def _text(help: str, metavar: str = "NAME") -> tuple[Any, Any]:
    return str | None, option(help, metavar=metavar, **_PANEL)


def _texts(help: str, metavar: str) -> tuple[Any, Any]:
    """Return an option that may be repeated; with commas between if the metavar shows them."""
    callback = split if metavar.endswith(_ANY) else None
    return list[str] | None, option(help, metavar=metavar, callback=callback, **_PANEL)


# By their names as settings of a fit.
SETTINGS: Options = {
    "objective": _text("What to minimise: rms-log-penetration, rms-load, ..."),
    "loss": _text(f"Weight of residuals: {listed(LOSSES)}."),
    "ignore": _texts("A column to leave out; may be repeated.", "COLUMN"),
    "columns": _texts("What a column is, e.g. load_N=Kraft; may be repeated.", "NAME=COLUMN"),
    "group": _text("The column of the groups, e.g. specimens.", "COLUMN"),
    "branch": _text(f"Use only the rows of {listed(BRANCHES)}."),
    "noise": _text(f"How readings scatter: {listed(NOISES)}."),
    "drift": (bool | None, option("Allow for a drift along each series.", "--drift", **_PANEL)),
    "load_error": _text("Standard deviation of the loads, e.g. 1%.", "SHARE"),
    "free": _texts("Fit what is fixed by default.", f"NAME{_ANY}"),
    "bound": _texts("Fit between two values.", f"NAME=LOW:HIGH{_ANY}"),
    "fix": _texts("Fix a parameter.", f"NAME=VALUE{_ANY}"),
}


def sample(
    spec: Path = argument("A grid spec, e.g. datasets/internal.toml."),
    out: Path = output("The .parquet or .csv file to write.", default=...),
) -> None:
    """Sample a reference law over a grid, in bounded memory."""
    from cylcontact.datasets import read_grid, write_samples

    require_output(out)
    grid = read_grid(spec)
    with progress_bars() as progress:
        counts = write_samples(grid, out, lambda n: progress("sampling", n, grid.dR.size))
    say(
        f"{out}: {counts.samples:,} samples, {counts.masked:,} masked by the domain of "
        f"{grid.reference}"
    )


@takes("settings", SETTINGS)
@takes("pair", PAIR, listed=False)
def fit(
    source: Path = argument(
        "A campaign, e.g. fitting/internal.toml, or a table.", metavar="CAMPAIGN|TABLE"
    ),
    *,
    out: Path | None = output("A .json, or for a table a folder; results/NAME by default."),
    runs: int | None = RUNS,
    seed: int | None = SEED,
    optimizer: str | None = option(f"{listed(OPTIMIZERS)}.", metavar="NAME"),
    jobs: int | None = JOBS,
    scheduler: str | None = SCHEDULER,
    resume: bool = RESUME,
    force: bool = FORCE,
    law: str | None = option(
        "The law, e.g. johnson; or module:function of your own.", metavar="NAME", **_PANEL
    ),
    settings: dict[str, Any],
    pair: dict[str, Any],
) -> None:
    """Calibrate a law to another law over a grid, or to a table of measurements.

    What a table does not say of its pair takes the options of cylcontact laws: --contact; --pin,
    --hole, --material, --E, --nu; --dR, --Ri, --Rj, --length; --R-o, --clamp and others.
    """
    from cylcontact.fitting import Campaign, DataFit, calibrate, fit_table, read_campaign
    from cylcontact.fitting.results import require_same_inputs

    where, given = workers(jobs, scheduler), pair | settings | ({} if law is None else {"law": law})
    planned: Campaign | TableCampaign
    if source.suffix.lower() == ".json":
        remedy = f"study its uncertainty with: cylcontact uncertainty {source}"
        raise InputError(str(source), "", None, "is a fit result", remedy)
    if is_table(source):
        measured = _measured(source, given, seed, runs, optimizer)
        planned = measured.campaign(measured.spec.law)
    elif given:
        rule = "is an option for tables of measurements, and this is a campaign"
        remedy = "set it in the campaign file"
        raise InputError(str(source), option_of(next(iter(given))), None, rule, remedy)
    else:
        planned = read_campaign(source, runs, seed, optimizer)
    target, folder = _place(source, planned, out)
    require_writable(target, *(target.with_name(name) for name in FIT_FILES if folder))
    require_suffix(target, ".json")
    if out is None and not force:
        require_same_inputs(target, planned)
    with resumable(target, "run") as journal:
        anew = resume and not journal.exists()
        note = f"no runs are kept in {journal}; all are run" if anew else ""
        with progress_bars() as bars:
            progress = noting(bars, "searching", note)
            result: FitResult
            if isinstance(planned, Campaign):
                result = calibrate(planned, where, progress, journal, resume)
            else:
                result = fit_table(planned, where, progress, journal, resume)
        if folder is not None and isinstance(result, DataFit):
            from cylcontact.reports.fit_folder import write_fit

            write_fit(result, folder)
        else:
            result.save(target)
    names = f": {', '.join(FIT_FILES)}" if folder else ""
    say(f"{result}\n\nwritten to {folder or target}{names}")


def _place(
    source: Path, planned: Campaign | TableCampaign, out: Path | None
) -> tuple[Path, Path | None]:
    """Return the file of the result, and for a table the folder of all its files.

    A campaign's result is a file alone, and so is one that is to be written to a .json. A second
    law has a folder of its own beside that of the first, with its name.
    """
    results = source.parent / "results"
    if not is_table(source):
        return out or results / f"{source.stem}.json", None
    if out is None:
        out = results / source.stem
        law = planned.model.law
        if _law_in(out / FIT_FILES[0]) not in ("", law):
            out = results / f"{source.stem}-{law.replace(':', '-')}"
    elif out.suffix.lower() == ".json":
        return out, None
    return out / FIT_FILES[0], out


def _law_in(result: Path) -> str:
    """Return the law of a fit result; empty without a result that can be read."""
    from cylcontact.fitting import FitResult

    try:
        return FitResult.read(result).law if result.exists() else ""
    except InputError:
        return ""


def optimizers(
    campaign: Path = argument("A campaign, e.g. fitting/internal.toml.", metavar="CAMPAIGN"),
    names: list[str] | None = argument(
        f"{listed(OPTIMIZERS)}; all by default.", metavar="[NAME]...", default=None
    ),
    out: Path | None = output("A .csv of the runs."),
    runs: int | None = RUNS,
    seed: int | None = SEED,
    jobs: int | None = JOBS,
    scheduler: str | None = SCHEDULER,
) -> None:
    """Compare optimisers on a campaign, with the same seeds, budget and polish."""
    from cylcontact.fitting import read_campaign
    from cylcontact.fitting.comparison import compare_optimizers, runs_as_text

    where, chosen = workers(jobs, scheduler), names or [*OPTIMIZERS]
    for name in chosen:
        planned = read_campaign(campaign, runs, seed, name)
    require_output(out, ".csv")
    with progress_bars() as progress:
        compared = compare_optimizers(planned, chosen, where, progress)
    if out is not None:
        with replacing(out) as temporary:
            compared.to_csv(temporary, index=False, lineterminator="\n")
    say(runs_as_text(compared))


def uncertainty(
    result: Path = RESULT,
    *,
    out: Path | None = output("The study, .json."),
    bootstrap: int | None = count(2, "Refit N times to resampled data."),
    over: str | None = option(
        "What to resample: rows (default), material, dR, pair or group.", metavar="WHAT"
    ),
    leave_out: str | None = option(
        "What to leave out in turn: material, dR, pair, group; E, nu, load.", metavar="WHAT"
    ),
    pairs: bool = option("Map each pair of parameters, into the output.", "--pairs", default=False),
    level: float = LEVEL,
    law: str | None = OWN_LAW,
    seed: int | None = SEED,
    jobs: int | None = JOBS,
    scheduler: str | None = SCHEDULER,
) -> None:
    """Study how certain a fit is.

    A fit to measurements has their noise, a fit to a law the differences between the two laws.
    Samples of a law carry no noise: --bootstrap, --over, --level and --law are for measurements.
    """
    from cylcontact.fitting import DataFit, FitResult, LawFit
    from cylcontact.fitting.discrepancy import study_discrepancy
    from cylcontact.fitting.study import study_noise

    source, where = str(result), workers(jobs, scheduler)
    rule, remedy = "must be from 0.5 to below 1", "0.95 is common"
    require(0.5 <= level < 1, source, "--level", level, rule, remedy)
    rule, remedy = "is for the bootstrap", "add --bootstrap 500"
    require(over is None or bootstrap is not None, source, "--over", over, rule, remedy)
    require_output(out, ".json")
    fitted = FitResult.read(result)
    study: Any = None
    with progress_bars() as progress:
        if isinstance(fitted, DataFit):
            study = study_noise(
                fitted, level=level, replicates=bootstrap, over=over or "rows", seed=seed,
                leave_out=leave_out, with_pairs=pairs, law=law, jobs=where, progress=progress,
            )  # fmt: skip
        elif isinstance(fitted, LawFit):
            rule = "is for measurements: samples of a law carry no noise to resample"
            remedy = "use --leave-out dR or --leave-out material"
            require(bootstrap is None, source, "--bootstrap", bootstrap, rule, remedy)
            study = study_discrepancy(
                fitted, leave_out=leave_out, with_pairs=pairs, jobs=where, progress=progress
            )
    if out is not None:
        contents = marked(study.model_dump(mode="json"))
        text = json.dumps(contents, indent=1, ensure_ascii=False)
        with replacing(out) as temporary:
            temporary.write_text(text + "\n", encoding="utf-8")
    say(f"{study}\n\nwritten to {out}" if out else str(study))


@takes("settings", SETTINGS)
@takes("pair", PAIR, listed=False)
def choose(
    data: Path = DATA,
    *,
    law: list[str] | None = several("The laws to compare; all by default.", metavar=f"NAME{_ANY}"),
    out: Path | None = output("The folder; results/NAME beside the table."),
    settings: dict[str, Any],
    pair: dict[str, Any],
) -> None:
    """Fit all laws to a table and rank them; say whether the data can tell.

    What the table does not say of its pair takes the options of cylcontact laws: --contact; --pin,
    --hole, --material, --E, --nu; --dR, --Ri, --Rj, --length; --R-o, --clamp and others.
    """
    from cylcontact.fitting.choice import choose_law
    from cylcontact.reports.fit_folder import write_choice

    folder = out or data.parent / "results" / data.stem
    require_writable(*(folder / name for name in CHOICE_FILES))
    measured = _measured(data, {**pair, **settings, "law": law[0] if law else "johnson"})
    with progress_bars() as progress:
        choice = choose_law(measured, law or (), progress)
    write_choice(choice, folder)
    say(f"{choice}\n\nwritten to {folder}: {', '.join(CHOICE_FILES)}")


@takes("settings", SETTINGS)
@takes("pair", PAIR, listed=False)
def design(
    data: Path = DATA,
    *,
    law: str = option("The law, e.g. johnson.", metavar="NAME", default=...),
    loads: str = option("Loads that can be taken, in N/mm.", metavar="LOW:HIGH", default=...),
    add: int = count(1, "Readings to add.", default=5),
    parameter: str | None = option("The one that counts; all by default.", metavar="NAME"),
    clearances: list[str] | None = several(
        "Clearances that can be taken, in mm.", "--dR-choices", metavar=f"DR{_ANY}"
    ),
    out: Path | None = output("A folder for the picture and its table."),
    settings: dict[str, Any],
    pair: dict[str, Any],
) -> None:
    """Say which further readings of a table would narrow its intervals most.

    What the table does not say of its pair takes the options of cylcontact laws: --contact; --pin,
    --hole, --material, --E, --nu; --dR, --Ri, --Rj, --length; --R-o, --clamp and others.
    """
    import numpy as np

    from cylcontact.fitting import fit_table
    from cylcontact.reports.fit_folder import write_design

    ends = plain_numbers(loads.split(":"))
    if ends is None or len(ends) != 2 or not 0 < ends[0] < ends[1]:
        rule, remedy = "must be two positive loads in N/mm", "e.g. --loads 5:400"
        raise InputError(str(data), "--loads", loads, rule, remedy)
    if out is not None:
        require_writable(*(out / name for name in DESIGN_FILES))
    measured = _measured(data, {**pair, **settings, "law": law})
    with progress_bars() as progress:
        fitted = fit_table(measured.campaign(law), 1, progress)
    possible = numbers("--dR-choices", clearances) or None
    taken = np.geomspace(ends[0], ends[1], _DESIGN_LOADS)
    chosen = fitted.design(taken, add, dR=possible, parameter=parameter)
    if out is None:
        say(str(chosen))
        return
    write_design(chosen, out)
    say(f"{chosen}\n\nwritten to {out}: {', '.join(DESIGN_FILES)}")


def predict(
    result: Path = RESULT,
    *,
    load: list[str] = option('A load with its unit, "4500 N"; may be repeated.', default=...),
    level: float = LEVEL,
    law: str | None = OWN_LAW,
) -> None:
    """Predict readings of the penetration with their bands."""
    from cylcontact.fitting import DataFit

    fitted = DataFit.read(result)
    table = (fitted if law is None else fitted.with_law(law)).predict(load, level)
    beyond = table.pop("beyond")
    # In the units of the table, which come last.
    starts = ("pair", "load", "penetration", "low", "high")
    columns = [[name for name in map(str, table) if name.startswith(start)] for start in starts]
    shown = table[[names[-1] for names in columns if names]]
    say(shown.to_string(index=False, float_format="{:.5g}".format))
    if beyond.any():
        loads = fitted.optimum.fit.data.load
        rows = ", ".join(str(row) for row, is_beyond in enumerate(beyond, start=1) if is_beyond)
        reach = f"reach from {loads.min():g} to {loads.max():g} N/mm"
        say(f"\n! beyond the readings, which {reach}: row {rows}")


def compare(
    results: list[Path] = argument(
        "Result files, e.g. fitting/results/*.json.", metavar="RESULT..."
    ),
) -> None:
    """Compare fits with each other and with the published coefficients."""
    from cylcontact import fitting

    say(fitting.compare([fitting.FitResult.read(path) for path in results]))


def verify(
    results: list[Path] | None = argument(
        "Result files; all committed ones by default.", metavar="[RESULT]...", default=None
    ),
    jobs: int | None = JOBS,
    scheduler: str | None = SCHEDULER,
) -> None:
    """Redo fits with their own settings; exit code 1 if one differs."""
    from cylcontact.fitting.comparison import verify as verify_one

    paths = results or sorted(RESULTS.glob("*.json"))
    remedy = "name some, or lay out a bench with: cylcontact init FOLDER"
    require(bool(paths), str(RESULTS), "", None, "has no results", remedy)
    failed = 0
    for path in paths:
        with progress_bars() as progress:
            checks = verify_one(path, workers(jobs, scheduler), progress)
        say("\n".join(f"{path.stem}: {check}" for check in checks))
        failed += sum(not check.holds for check in checks)
    say(f"{len(paths)} results verified, {failed} checks do not hold")
    if failed:
        raise typer.Exit(1)


def _measured(
    path: Path,
    given: dict[str, Any],
    seed: int | None = None,
    runs: int | None = None,
    optimizer: str | None = None,
) -> MeasuredTable:
    """Return a table with the options for it."""
    from cylcontact.fitting.table_campaign import read_table

    source = str(path)
    require(is_table(path), source, "", None, "is not a table", "name a table of measurements")
    require_file(path)
    if "contact" not in given and OF_PIN_AND_HOLE & {*given}:
        given["contact"] = "internal"
    for name, example in (("law", "explicit"), ("contact", "internal")):
        remedy = f"add --{name} {example}"
        require(name in given, source, f"--{name}", None, "is required for a table", remedy)
    housing = housing_of(given, source, given["contact"])
    constants, blamed = constants_of(given, source, given["contact"])
    settings = {name: value for name, value in given.items() if name not in IN_CONSTANTS}
    law, contact = settings.pop("law"), settings.pop("contact")
    if "load_error" in settings:
        settings["load_error"] = _share(source, settings["load_error"])
    settings |= {
        "columns": _columns(source, settings.pop("columns", [])) or None,
        "parameters": _parameters(source, settings.pop("bound", []), settings.pop("fix", []))
        or None,
        "housing": None if housing is None else housing.model_dump(exclude_none=True),
        "seed": seed,
        "optimizer": optimizer,
    }
    if runs is not None:
        settings |= {"starts": runs} if optimizer is None else {"genetic": {"runs": runs}}
    with blaming_options(blamed):
        return read_table(path, law, contact, constants, **settings)


def _columns(source: str, texts: list[str]) -> dict[str, str]:
    """Return the table [columns] from --columns."""
    columns: dict[str, str] = {}
    for text in texts:
        name, _, column = (part.strip() for part in text.partition("="))
        example = "write --columns load_N=Kraft"
        require(bool(name and column), source, "--columns", text, "is not valid", example)
        rule = f"{name} is given twice"
        require(name not in columns, source, "--columns", text, rule, "keep one of them")
        columns[name] = column
    return columns


def _parameters(source: str, bounds: list[str], fixed: list[str]) -> dict[str, dict[str, Any]]:
    """Return the tables [parameters.NAME] from --bound and --fix."""
    tables: dict[str, dict[str, Any]] = {}
    of_both = [("--bound", text, "n=1:1.5") for text in bounds]
    for key, text, example in [*of_both, *(("--fix", text, "n=1.1") for text in fixed)]:
        name, _, given = text.partition("=")
        values = plain_numbers(given.split(":"))
        if not name or values is None or len(values) != example.count(":") + 1:
            raise InputError(source, key, text, "is not valid", f"write {key} {example}")
        if name in tables:
            raise InputError(source, key, text, f"{name} is given twice", "keep one of them")
        names = ("low", "high") if key == "--bound" else ("value",)
        tables[name] = dict(zip(names, values, strict=True))
        if key == "--fix":
            tables[name]["fixed"] = True
    return tables


def _share(source: str, text: str) -> float:
    """Return a share such as 1% or 0.01 as a number."""
    values = plain_numbers([text.strip().removesuffix("%")])
    if values is None:
        remedy = "write --load-error 1% or --load-error 0.01"
        raise InputError(source, "--load-error", text, "is not a share", remedy)
    return values[0] / 100 if text.strip().endswith("%") else values[0]
