"""The commands `fit`, `choose`, `predict`, `plan`, `compare` and `verify`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import typer

from cylcontact.cli.options import (
    BUILD,
    EXAMPLES,
    FORCE,
    JOBS,
    JSON,
    LENGTH,
    NOISES,
    QUIET,
    RESULTS,
    RESUME,
    SCHEDULER,
    Options,
    Read,
    argument,
    count,
    flag,
    number,
    option,
    output,
    reader,
    several,
    takes,
)
from cylcontact.cli.pair import (
    IN_CONSTANTS,
    PAIR,
    PIN_AND_HOLE,
    blaming_options,
    constants_of,
    option_of,
)
from cylcontact.cli.terminal import note, progress_bars, resumable, say
from cylcontact.files.reading import plain_number, require_file
from cylcontact.files.units import load_in_N_per_mm
from cylcontact.files.writing import json_text, require_suffix, require_writable
from cylcontact.joint.words import HOUSING, housing_spec_from_words
from cylcontact.support.choices import (
    BRANCHES,
    CHOICE_FILES,
    FIT_FILES,
    FIT_PDF,
    PLAN_FILES,
    RESULT_SUFFIXES,
    is_table,
    listed,
)
from cylcontact.support.errors import InputError, require
from cylcontact.support.plain_text import item

if TYPE_CHECKING:
    from cylcontact.fitting import DataFit, LawFit
    from cylcontact.fitting.campaign import Campaign, MeasuredTable

# Loads among which a plan chooses.
_PLAN_LOADS = 41

DATA = argument("Tables, .csv, .txt, .xlsx or .parquet.", metavar="TABLE")
RESULT = argument("A fit, e.g. results/NAME/result.json.", metavar="RESULT")
RUNS = count(1, "Runs, instead of the campaign's.")
SEED = count(0, "Seed of the random numbers.")
LEVEL = number("Level of the intervals; 0.95, or that of the fit.", metavar="LEVEL")
OWN_LAW = option("The law, if it is your own function.", metavar="MODULE:FUNCTION")
_PANEL: dict[str, Any] = {"rich_help_panel": "For a table"}


def _text(help: str, metavar: str = "NAME", read: Read = str) -> tuple[Any, Any]:
    return str | None, option(help, metavar=metavar, parser=read, **_PANEL)


def _texts(help: str, metavar: str, read: Read = str) -> tuple[Any, Any]:
    return list[str] | None, several(help, of=read, metavar=metavar, **_PANEL)


def _named(read: Read, example: str) -> Read:
    """Return what reads NAME=…, and gives the name and what `read` makes of the rest."""

    def parse(text: str) -> tuple[str, Any]:
        name, _, rest = (part.strip() for part in text.partition("="))
        if not (name and rest):
            raise ValueError
        return name, read(rest)

    return reader(parse, f"is not valid; write e.g. {example}")


def _bound(text: str) -> list[float]:
    low, high = map(plain_number, text.split(":"))
    return [low, high]


def _range(text: str) -> tuple[str, str]:
    """Return two loads with their units, by default in N/mm; a unit behind the second is both's."""
    low, high = (part.strip() for part in text.split(":"))
    unit = high.lstrip("+-.,0123456789eE").strip() or "N/mm"
    with suppress(ValueError):
        high = f"{plain_number(high):g} N/mm"
    with suppress(ValueError):
        low = f"{plain_number(low):g} {unit}"
    return low, high


_RANGE = reader(_range, "must be two loads, the lower first, e.g. 5:400")


def _share(text: str) -> float:
    number = plain_number(text.strip().removesuffix("%"))
    return number / 100 if text.strip().endswith("%") else number


_COLUMN = _named(str, "load_N=Kraft")
# By their names as settings of a fit.
SETTINGS: Options = {
    "ignore": (list[str] | None,
               option("Column left out; may be repeated.", metavar="COLUMN", **_PANEL)),
    "columns": (list[str] | None,
                option("What a column is; may be repeated.",
                       metavar="NAME=COLUMN", parser=_COLUMN, **_PANEL)),
    "group": _text("Column of groups, e.g. specimens.", "COLUMN"),
    "sheet": _text("Sheet of a workbook."),
    "header": (int | None, option("Line of the column names, or 0.", metavar="LINE", **_PANEL)),
    "separator": _text("Separator: comma, semicolon, tab, bar, space.", "NAME"),
    "encoding": _text("Encoding of a text, e.g. cp1251.", "NAME"),
    "decimal": _text("Decimal mark, . or ,", "MARK"),
    "exclude": (list[str] | None,
                several("Rows to leave out, as 38 or b.csv:12.", of=str, metavar="LINE", **_PANEL)),
    "loads": _text("Only rows of these loads, in the table's unit, e.g. 5:", "LOW:HIGH"),
    "sign": _text("What is negative: load, penetration, both, neither.", "WHAT"),
    "branch": _text(f"Only rows of {listed(BRANCHES)}."),
    "noise": _text(f"{listed(NOISES)}."),
    "drift": (bool | None, flag("Allow for a drift of each series.", "--drift",
              default=None, **_PANEL)),
    "load_error": _text("Standard deviation of loads, as 1%.", "SHARE",
                        reader(_share, "is not a share; write 1% or 0.01")),
    "uncertain": (list[str] | None,
                  option("Standard uncertainty of an input (dR, R_i, R_j, E, E_i, E_j, length, "
                         "load) or parameter; that of a tolerance ±t is t/√3, of a certificate's "
                         "U it is U/2. May be repeated.",
                         metavar="NAME=SIZE", parser=_named(str, "dR=2 um"), **_PANEL)),
    "level": (float | None, LEVEL),
    "free": _texts("Fit what is fixed by default.", "NAME"),
}  # fmt: skip
# A fit is for long parts.
_OF_PAIR = {name: option for name, option in PAIR.items() if name != "plane"}
# By the names of the tables in a campaign file.
PARAMETERS: Options = {
    "bounds": (list[str] | None, several("Fit between two values.", "--bound",
               of=_named(_bound, "n=1:1.5"), metavar="NAME=LOW:HIGH")),
    "fixed": (list[str] | None, several("Fix a parameter.", "--fix",
              of=_named(plain_number, "n=1.1"), metavar="NAME=VALUE")),
    "ties": (list[str] | None, several("Set a parameter from others.", "--tie",
             of=_named(str, "b=a/10"), metavar="NAME=EXPR")),
}  # fmt: skip


@takes("settings", SETTINGS)
@takes("parameters", PARAMETERS)
@takes("pair", _OF_PAIR)
def fit(
    sources: list[Path] = argument("A campaign, .toml, or tables.", metavar="CAMPAIGN|TABLE"),
    *,
    out: Path | None = output(
        "A .json, in build; for a table a folder, results/NAME. A .csv or .tex: the coefficients.",
        metavar="FILE|FOLDER",
    ),
    runs: int | None = RUNS,
    seed: int | None = SEED,
    jobs: int = JOBS,
    scheduler: Any = SCHEDULER,
    resume: bool = RESUME,
    force: bool = FORCE,
    as_json: bool = JSON,
    quiet: bool = QUIET,
    pdf: bool = flag("Write the picture as a PDF too.", "--pdf", **_PANEL),
    show: bool = flag("Open the picture.", "--show", **_PANEL),
    law: str | None = option("The law, by name or as MODULE:FUNCTION.", metavar="LAW", **_PANEL),
    settings: dict[str, Any],
    parameters: dict[str, Any],
    pair: dict[str, Any],
) -> None:
    """Calibrate a law to another law over a grid, or to tables of measurements.

    What the tables do not say of their pair, options give. Several tables are fitted together, each
    in its own units; --group file takes each as a series.
    """
    from cylcontact.datasets.grid import Grid
    from cylcontact.fitting import DataFit, calibrate, fit_table
    from cylcontact.fitting.stored import require_same_inputs

    where, given = scheduler or jobs, pair | settings | ({} if law is None else {"law": law})
    planned, folder, target = _planned(sources, given, parameters, seed, runs, out)
    rule = "is for a fit to tables that has a folder"
    for name, is_given in (("--pdf", pdf), ("--show", show)):
        require(not is_given or folder is not None, "fit", name, None, rule, "leave it out")
    files = (*FIT_FILES, FIT_PDF) if pdf else FIT_FILES
    require_writable(target, *(target.with_name(name) for name in files if folder))
    require_suffix(target, *RESULT_SUFFIXES)
    if out is None and not force:
        require_same_inputs(target, planned)
    result: LawFit | DataFit
    with resumable(target, "run", resume, quiet) as (journal, progress):
        if isinstance(planned.data, Grid):
            result = calibrate(planned, where, progress, journal, resume)
        else:
            result = fit_table(planned, where, progress, journal, resume)
        if folder is not None and isinstance(result, DataFit):
            from cylcontact.fitting.folder import write_fit

            write_fit(result, folder, pdf=pdf)
        else:
            result.save(target)
    if show and folder is not None:
        typer.launch(str(folder / FIT_FILES[-1]))
    if as_json:
        say(result.to_json())
        return
    say(result)
    names = f": {', '.join(files)}" if folder else ""
    note(f"\nwritten to {folder or target}{names}", quiet)


def _planned(
    sources: list[Path],
    given: dict[str, Any],
    parameters: dict[str, Any],
    seed: int | None,
    runs: int | None,
    out: Path | None,
) -> tuple[Campaign, Path | None, Path]:
    """Return the campaign, the folder of its files, if it has one, and where the result goes."""
    from cylcontact.fitting import Campaign

    source = sources[0]
    if source.suffix.lower() == ".json":
        remedy = f"print it with: cylcontact compare {source}"
        raise InputError(str(source), "", None, "is a fit result", remedy)
    if is_table(source):
        measured = _measured(sources, given | parameters, seed, runs)
        return measured.campaign(given["law"]), *_place(sources, given["law"], out)
    if len(sources) > 1:
        rule, remedy = "is a campaign, which is fitted alone", "name one campaign, or tables"
        raise InputError(str(source), "", None, rule, remedy)
    for name in given:
        rule = "is an option for tables of measurements, and this is a campaign"
        remedy = "set it in the campaign file"
        raise InputError(str(source), option_of(name), None, rule, remedy)
    planned = Campaign.read(source, runs=runs, seed=seed, **_tables(str(source), parameters))
    return planned, None, out or BUILD / f"{source.stem}.json"


def _place(sources: list[Path], law: str, out: Path | None) -> tuple[Path | None, Path]:
    """Return the folder of a fit to tables, none for a file alone, and its result in it.

    A second law has a folder of its own beside that of the first, with its name.
    """
    from cylcontact.fitting import read_result

    if out is not None and out.suffix.lower() in RESULT_SUFFIXES:
        return None, out
    folder = out or _folder_of(sources)
    if out is None:
        with suppress(InputError):  # there is no result yet
            if read_result(folder / FIT_FILES[0]).law != law:
                folder = folder.with_name(f"{folder.name}-{law.replace(':', '-')}")
    return folder, folder / FIT_FILES[0]


def _folder_of(tables: list[Path]) -> Path:
    """Return the folder of the results of tables: beside the first, or in build for an example."""
    from cylcontact.fitting.campaign import name_of_tables

    of_example = tables[0].resolve().parent.parts[-len(EXAMPLES.parts) :] == EXAMPLES.parts
    return (BUILD if of_example else tables[0].parent / "results") / name_of_tables(tables)


@takes("settings", SETTINGS)
@takes("parameters", PARAMETERS)
@takes("pair", _OF_PAIR)
def choose(
    data: list[Path] = DATA,
    *,
    law: list[str] | None = several("The laws to compare; all by default.", of=str, metavar="LAW"),
    out: Path | None = output("The folder; results/NAME beside the table.", metavar="FOLDER"),
    jobs: int = JOBS,
    scheduler: Any = SCHEDULER,
    as_json: bool = JSON,
    quiet: bool = QUIET,
    settings: dict[str, Any],
    parameters: dict[str, Any],
    pair: dict[str, Any],
) -> None:
    """Fit all laws to tables, rank them, and say whether the data can decide."""
    from cylcontact.fitting.choice import choose_law
    from cylcontact.fitting.folder import write_choice

    folder = out or _folder_of(data)
    require_writable(*(folder / name for name in CHOICE_FILES))
    measured = _measured(
        data, {**pair, **settings, **parameters, "law": law[0] if law else "johnson"}
    )
    with progress_bars(quiet) as progress:
        choice = choose_law(measured, law or (), progress, scheduler or jobs)
    write_choice(choice, folder)
    if as_json:
        say(json_text({"left_out": choice.left_out, "rows": choice.table.reset_index()}))
        return
    say(choice)
    note(f"\nwritten to {folder}: {', '.join(CHOICE_FILES)}", quiet)


@takes("settings", SETTINGS)
@takes("parameters", PARAMETERS)
@takes("pair", _OF_PAIR)
def plan(
    data: list[Path] = DATA,
    *,
    law: str | None = option("The law, e.g. johnson.", metavar="LAW"),
    candidates: Any = option(
        'Loads to choose from, in N/mm or with their unit, e.g. 5:400 or "100 N:5 kN".',
        metavar="LOW:HIGH",
        parser=_RANGE,
    ),
    add: int = count(1, "Readings to add.", default=5),
    parameter: str | None = option("The parameter to narrow; all by default.", metavar="NAME"),
    clearances: list[float] | None = several(
        "Clearances that can be taken.", "--radial-clearances", of=LENGTH, metavar="MM"
    ),
    out: Path | None = output("A folder for the picture and its table.", metavar="FOLDER"),
    as_json: bool = JSON,
    quiet: bool = QUIET,
    settings: dict[str, Any],
    parameters: dict[str, Any],
    pair: dict[str, Any],
) -> None:
    """Say which further readings would narrow the intervals of a table most."""
    import numpy as np

    from cylcontact.fitting import fit_table
    from cylcontact.fitting.folder import write_plan

    if out is not None:
        require_writable(*(out / name for name in PLAN_FILES))
    lacks = {} if candidates else {"the loads to choose from": "--candidates 5:400"}
    given = {**pair, **settings, **parameters} | ({} if law is None else {"law": law})
    measured = _measured(data, given, lacks=lacks)
    law = given["law"]
    with progress_bars(quiet) as progress:
        fitted = fit_table(measured.campaign(law), 1, progress)
    length = fitted.data.columns.get("length")
    of_pair = None if length is None or np.ptp(length) else float(length[0])
    low, high = (load_in_N_per_mm(load, of_pair) for load in candidates)
    rule, remedy = "must be above zero, the lower first", "give e.g. 5:400"
    require(0 < low < high, str(data[0]), "--candidates", ":".join(candidates), rule, remedy)
    taken = np.geomspace(low, high, _PLAN_LOADS)
    chosen = fitted.plan(taken, add, dR=clearances or None, parameter=parameter)
    say(json_text(chosen.to_dict()) if as_json else chosen)
    if out is not None:
        write_plan(chosen, out)
        note(f"\nwritten to {out}: {', '.join(PLAN_FILES)}", quiet or as_json)


def predict(
    result: Path = RESULT,
    *,
    load: list[str] = option(
        'A load with its unit, "4500 N"; may be repeated.', default=..., metavar="LOAD"
    ),
    level: float | None = LEVEL,
    law: str | None = OWN_LAW,
    as_json: bool = JSON,
) -> None:
    """Predict readings of the penetration with their bands."""
    from cylcontact.fitting import DataFit

    fitted = DataFit.read(result)
    fitted = fitted if law is None else fitted.with_law(law)
    columns = fitted.predicted_columns(load, level)
    if as_json:
        cells = zip(*columns.values(), strict=True)
        of_each = [dict(zip(columns, row, strict=True)) for row in cells]
        say(json_text({"level": level or fitted.level, "rows": of_each}))
        return
    beyond = columns.pop("beyond")
    # In the units of the table, which come last.
    starts = ("pair", "load", "penetration", "low", "high")
    named = ([name for name in columns if name.startswith(start)] for start in starts)
    say("\n".join(item(line, "") for line in fitted.data.read))
    say(_aligned({names[-1]: columns[names[-1]] for names in named if names}))
    if beyond.any():
        loads = fitted.optimum.fit.data.load
        rows = ", ".join(str(row) for row, is_beyond in enumerate(beyond, start=1) if is_beyond)
        measured = f"{loads.min():g} to {loads.max():g} N/mm"
        say(f"\n! outside the measured loads, {measured}: row {rows}")


def _aligned(columns: Mapping[str, Any]) -> str:
    """Return columns of texts and numbers under their names, aligned on the right."""
    cells = [
        [name, *(value if isinstance(value, str) else f"{value:.5g}" for value in column)]
        for name, column in columns.items()
    ]
    widths = [max(map(len, column)) for column in cells]
    rows = (map(str.rjust, row, widths) for row in zip(*cells, strict=True))
    return "\n".join("  ".join(row) for row in rows)


def _title(path: Path) -> str:
    """Return what a result is called: by its folder if its file has the name of all fits."""
    return path.resolve().parent.name if path.name == FIT_FILES[0] else path.stem


def compare(
    results: list[Path] = argument("Result files, e.g. fitting/results/*.json.", metavar="RESULT"),
    as_json: bool = JSON,
) -> None:
    """Compare fits with each other and with the published coefficients."""
    from cylcontact import fitting
    from cylcontact.fitting.comparison import compared

    read = [fitting.read_result(path) for path in results]
    often = Counter(result.name for result in read)
    named = [  # fits of one table have its name
        result.model_copy(update={"name": _title(path)}) if often[result.name] > 1 else result
        for path, result in zip(results, read, strict=True)
    ]
    say(json_text(compared(named)) if as_json else fitting.compare(named))


def verify(
    results: list[Path] | None = argument("Result files.", metavar="RESULT", default=None),
    every: bool = flag("All results in fitting/results; minutes.", "--all"),
    jobs: int = JOBS,
    scheduler: Any = SCHEDULER,
    as_json: bool = JSON,
    quiet: bool = QUIET,
) -> None:
    """Redo fits with their own settings; exit code 1 if one differs."""
    from cylcontact.fitting.comparison import verify as verify_one

    rule, remedy = "names no result", "name some, or all in fitting/results with --all"
    require(bool(results) or every, "verify", "", None, rule, remedy)
    paths = [*(results or ()), *(sorted(RESULTS.glob("*.json")) if every else ())]
    remedy = "name some, or make a project folder with: cylcontact init FOLDER"
    require(bool(paths), str(RESULTS), "", None, "has no results", remedy)
    failed, rows = 0, []
    for path in paths:
        with progress_bars(quiet) as progress:
            checks = verify_one(path, scheduler or jobs, progress)
        rows += [{"result": str(path), **check.to_dict()} for check in checks]
        failed += sum(not check.holds for check in checks)
        if not as_json:
            say("\n".join(f"{_title(path)}: {check}" for check in checks))
    if as_json:
        say(json_text({"rows": rows}))
    else:
        say(f"{len(paths)} results verified, {failed} checks do not hold")
    if failed:
        raise typer.Exit(1)


def _measured(
    paths: list[Path],
    given: dict[str, Any],
    seed: int | None = None,
    runs: int | None = None,
    lacks: Mapping[str, str] = MappingProxyType({}),
) -> MeasuredTable:
    """Return tables with the options for them; refuse all that is missing at once.

    `lacks` names other options that the command needs, each with an example.
    """
    from cylcontact.datasets.measurements import MissingInputError
    from cylcontact.fitting.campaign import read_table

    source = ", ".join(map(str, paths))
    for path in paths:
        require(is_table(path), str(path), "", None, "is not a table", "name a table")
        require_file(path)
    if "contact" not in given and {*PIN_AND_HOLE} & {*given}:
        given["contact"] = "internal"
    examples = {"law": "--law explicit", "contact": "--contact internal"}
    missing = {f"the {name}": text for name, text in examples.items() if name not in given}
    missing |= lacks
    law, contact = given.get("law", "explicit"), given.get("contact", "internal")
    housing = housing_spec_from_words(given, source, option_of)
    constants, blamed = constants_of(given, source, contact)
    others = {*IN_CONSTANTS, *HOUSING, "law", "contact"}
    settings = {name: value for name, value in given.items() if name not in others}
    settings |= _tables(source, given) | {
        "columns": _each_once(source, "--columns", settings.get("columns", [])),
        "uncertain": _each_once(source, "--uncertain", settings.get("uncertain", [])),
        "housing": None if housing is None else housing.model_dump(exclude_none=True),
        "seed": seed,
        "starts": runs,
    }
    more = ""
    with blaming_options(blamed):
        try:
            table = read_table(paths, law, None, contact, constants, **settings)
        except MissingInputError as error:
            if not missing:
                raise
            missing, more = missing | error.lacks, error.more
    if missing:
        raise MissingInputError(source, missing, more)
    return table


def _tables(source: str, given: dict[str, Any]) -> dict[str, Any]:
    """Return what --bound, --fix and --tie give, as the tables of a campaign file."""
    tables = {name: given[name] for name in PARAMETERS if name in given}
    _each_once(
        source, "--bound, --fix, --tie", [each for table in tables.values() for each in table]
    )
    return {name: dict(table) for name, table in tables.items()}


def _each_once(source: str, option: str, named: list[tuple[str, Any]]) -> dict[str, Any] | None:
    """Return what options give by name; None without any."""
    names = [name for name, _ in named]
    for name in names:
        rule = f"{name} is given twice"
        require(names.count(name) == 1, source, option, None, rule, "keep one of them")
    return dict(named) or None
