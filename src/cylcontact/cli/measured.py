"""Options for fits to a table of measurements, and the command `choose`."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from cylcontact.choices import BRANCHES, CHOICE_FILES, DESIGN_FILES, is_table, listed
from cylcontact.cli.options import (
    LOSSES,
    NOISES,
    NUMBER,
    Runs,
    Seed,
    expand_options,
    integer_from,
    numbers,
    option_of,
    plain_numbers,
    split,
)
from cylcontact.cli.pair import (
    IN_CONSTANTS,
    OF_PIN_AND_HOLE,
    PairOptions,
    blaming_options,
    constants_of,
    housing_of,
)
from cylcontact.cli.terminal import progress_bars, say
from cylcontact.errors import InputError
from cylcontact.files import require_writable
from cylcontact.fitting.optimizers import OPTIMIZERS
from cylcontact.reading import require_file

if TYPE_CHECKING:
    from cylcontact.fitting import Campaign, TableCampaign
    from cylcontact.fitting.table_campaign import MeasuredTable

_PANEL = "For a table of measurements"
# Loads among which a design chooses.
_DESIGN_LOADS = 41


def _option(*names: str, help: str, **details: Any) -> Any:
    """Return an option in the help panel for tables."""
    return typer.Option(*names, help=help, rich_help_panel=_PANEL, **details)


@dataclass(frozen=True)
class SearchOptions:
    """Options of `fit` for the search; None leaves the campaign as it is."""

    runs: Runs = None
    seed: Seed = None
    optimizer: Annotated[
        list[str] | None,
        typer.Option(
            callback=split,
            metavar="NAME[,...]",
            help=f"{listed(OPTIMIZERS)}; several, or all, are compared.",
        ),
    ] = None

    @property
    def optimizers(self) -> list[str]:
        """The optimisers named, "all" replaced by their names."""
        return list(OPTIMIZERS) if self.optimizer == ["all"] else self.optimizer or []


@dataclass(frozen=True)
class TableOptions(PairOptions):
    """Options of `fit` and `choose` for tables; None if not given."""

    objective: Annotated[
        str | None,
        _option("--objective", help="What to minimise: rms-log-penetration, rms-load, ..."),
    ] = None
    loss: Annotated[
        str | None, _option("--loss", help=f"Weight of large residuals: {listed(LOSSES)}.")
    ] = None
    ignore: Annotated[
        list[str] | None,
        _option("--ignore", help="A column to leave out; may be repeated.", metavar="COLUMN"),
    ] = None
    columns: Annotated[
        list[str] | None,
        _option(
            "--columns",
            help="What a column is, e.g. load_N=Kraft; may be repeated.",
            metavar="NAME=COLUMN",
        ),
    ] = None
    group: Annotated[
        str | None,
        _option("--group", help="The column of the groups, e.g. specimens.", metavar="COLUMN"),
    ] = None
    branch: Annotated[
        str | None, _option("--branch", help=f"Use only the rows of {listed(BRANCHES)}.")
    ] = None
    noise: Annotated[
        str | None, _option("--noise", help=f"How readings scatter: {listed(NOISES)}.")
    ] = None
    drift: Annotated[
        bool | None, _option("--drift", help="Allow for a drift along each series.")
    ] = None
    load_error: Annotated[
        str | None,
        _option("--load-error", help="Standard deviation of the loads, e.g. 1%.", metavar="SHARE"),
    ] = None
    free: Annotated[
        list[str] | None,
        _option(
            "--free",
            help="Fit a parameter that is fixed by default.",
            metavar="NAME[,...]",
            callback=split,
        ),
    ] = None
    bound: Annotated[
        list[str] | None,
        _option(
            "--bound",
            help="Fit a parameter between two values.",
            metavar="NAME=LOW:HIGH[,...]",
            callback=split,
        ),
    ] = None
    fix: Annotated[
        list[str] | None,
        _option("--fix", help="Fix a parameter.", metavar="NAME=VALUE[,...]", callback=split),
    ] = None


@dataclass(frozen=True)
class LawOption:
    """Options of `fit` for the law to fit to a table."""

    law: Annotated[
        str | None, _option("--law", help="The law, e.g. johnson; or module:function of your own.")
    ] = None


def plan(
    path: Path,
    law: LawOption,
    options: TableOptions,
    search: SearchOptions,
    optimizer: str | None = None,
) -> Campaign | TableCampaign:
    """Return the campaign of a file, or of a table and its options."""
    from cylcontact.fitting import read_campaign

    given = _given(asdict(law) | asdict(options))
    if not is_table(path):
        if given:
            rule = "is an option for tables of measurements, and this is a campaign"
            remedy = "set it in the campaign file"
            raise InputError(str(path), option_of(next(iter(given))), None, rule, remedy)
        return read_campaign(path, search.runs, search.seed, optimizer)
    table = _table(path, given, search, optimizer)
    return table.campaign(table.spec.law)


def _given(options: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in options.items() if value not in (None, [])}


def _table(
    path: Path, given: dict[str, Any], search: SearchOptions, optimizer: str | None = None
) -> MeasuredTable:
    """Return a table with the options for it."""
    from cylcontact.fitting.table_campaign import read_table

    if not is_table(path):
        rule, remedy = "is not a table", "name a table of measurements"
        raise InputError(str(path), "", None, rule, remedy)
    require_file(path)
    if "contact" not in given and OF_PIN_AND_HOLE & {*given}:
        given["contact"] = "internal"
    for name, example in (("law", "explicit"), ("contact", "internal")):
        if name not in given:
            raise InputError(
                str(path), f"--{name}", None, "is required for a table", f"add --{name} {example}"
            )
    if "load_error" in given:
        given["load_error"] = _share(str(path), "--load-error", given["load_error"])
    housing = housing_of(given, str(path), given["contact"])
    constants, blamed = constants_of(given, str(path), given["contact"])
    given = {name: value for name, value in given.items() if name not in IN_CONSTANTS}
    columns = _columns(str(path), given.pop("columns", []))
    parameters = _parameters(str(path), given.pop("bound", []), given.pop("fix", []))
    settings = {
        **given,
        "seed": search.seed,
        "optimizer": optimizer,
        "parameters": parameters or None,
    }
    settings["columns"] = columns or None
    if housing is not None:
        settings["housing"] = housing.model_dump(exclude_none=True)
    runs = search.runs
    settings |= {"starts": runs} if optimizer is None else {"genetic": runs and {"runs": runs}}
    law, contact = settings.pop("law"), settings.pop("contact")
    with blaming_options(blamed):
        return read_table(path, law, contact, constants, **settings)


@expand_options
def choose(
    data: Annotated[Path, typer.Argument(help="A table, .csv, .txt, .xlsx or .parquet.")],
    *,
    law: Annotated[
        list[str] | None,
        _option(
            "--law",
            help="The law, e.g. johnson; several are compared, all by default.",
            metavar="NAME[,...]",
            callback=split,
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="The folder; results/NAME beside the table.")
    ] = None,
    table: TableOptions,
) -> None:
    """Fit all laws that apply to a table, rank them, and say whether the data can tell."""
    from cylcontact.fitting.choice import choose_law
    from cylcontact.reports.fit_folder import write_choice

    folder = out or data.parent / "results" / data.stem
    require_writable(*(folder / name for name in CHOICE_FILES))
    first = law[0] if law else "johnson"
    measured = _table(data, {"law": first, **_given(asdict(table))}, SearchOptions())
    with progress_bars() as progress:
        choice = choose_law(measured, law or (), progress)
    write_choice(choice, folder)
    say(f"{choice}\n\nwritten to {folder}: {', '.join(CHOICE_FILES)}")


@expand_options
def design(
    data: Annotated[Path, typer.Argument(help="A table, .csv, .txt, .xlsx or .parquet.")],
    *,
    law: LawOption,
    loads: Annotated[
        str, typer.Option("--loads", help="Loads that can be taken, in N/mm.", metavar="LOW:HIGH")
    ],
    add: Annotated[
        int | None,
        typer.Option("--add", help="Readings to add; 5.", parser=integer_from(1), metavar="N"),
    ] = None,
    parameter: Annotated[
        str | None, typer.Option("--parameter", help="The one that counts; all by default.")
    ] = None,
    clearances: Annotated[
        list[str] | None,
        typer.Option(
            "--dR-choices",
            help="Clearances that can be taken, in mm.",
            metavar="DR[,...]",
            callback=split,
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="A folder for the picture and its table.")
    ] = None,
    table: TableOptions,
) -> None:
    """Fit a law to a table, and say which further readings would narrow its intervals most."""
    from cylcontact.fitting import fit_table
    from cylcontact.reports.fit_folder import write_design

    ends = plain_numbers(loads.split(":"))
    if ends is None or len(ends) != 2 or not 0 < ends[0] < ends[1]:
        rule, remedy = "must be two positive loads in N/mm", "e.g. --loads 5:400"
        raise InputError(str(data), "--loads", loads, rule, remedy)
    if out is not None:
        require_writable(*(out / name for name in DESIGN_FILES))
    plan = _table(data, _given(asdict(law) | asdict(table)), SearchOptions())
    with progress_bars() as progress:
        fitted = fit_table(plan.campaign(plan.spec.law), 1, progress)
    chosen = fitted.design(
        np.geomspace(ends[0], ends[1], _DESIGN_LOADS),
        5 if add is None else add,
        dR=numbers("--dR-choices", clearances) or None,
        parameter=parameter,
    )
    parts = [str(chosen)]
    if out is not None:
        write_design(chosen, out)
        parts.append(f"written to {out}: {', '.join(DESIGN_FILES)}")
    say("\n\n".join(parts))


@expand_options
def predict(
    result: Annotated[
        Path, typer.Argument(help="A fit to a table, e.g. results/NAME/result.json.")
    ],
    *,
    load: Annotated[
        list[str],
        typer.Option("--load", help='A load with its unit, e.g. "4500 N"; may be repeated.'),
    ],
    level: Annotated[
        float | None,
        typer.Option("--level", help="Level of the intervals; 0.95 by default.", **NUMBER),
    ] = None,
    law: LawOption,
) -> None:
    """Predict readings of the penetration with their bands, in the units of the table."""
    from cylcontact.fitting import DataFit

    fit = DataFit.read(result)
    fit = fit if law.law is None else fit.with_law(law.law)
    table = fit.predict(load, 0.95 if level is None else level)
    beyond = table.pop("beyond")
    # In the units of the table, which come last.
    starts = ("pair", "load", "penetration", "low", "high")
    columns = [[name for name in map(str, table) if name.startswith(start)] for start in starts]
    shown = table[[names[-1] for names in columns if names]]
    notes = []
    if beyond.any():
        loads = fit.optimum.fit.data.load
        rows = ", ".join(str(k + 1) for k in np.flatnonzero(beyond))
        reach = f"reach from {loads.min():g} to {loads.max():g} N/mm"
        notes = [f"! beyond the readings, which {reach}: row {rows}"]
    say("\n\n".join([shown.to_string(index=False, float_format="{:.5g}".format), *notes]))


def _columns(source: str, texts: list[str]) -> dict[str, str]:
    """Return the table [columns] from --columns."""
    columns: dict[str, str] = {}
    for text in texts:
        name, _, column = (part.strip() for part in text.partition("="))
        if not name or not column:
            raise InputError(
                source, "--columns", text, "is not valid", "write --columns load_N=Kraft"
            )
        if name in columns:
            rule = f"{name} is given twice"
            raise InputError(source, "--columns", text, rule, "keep one of them")
        columns[name] = column
    return columns


def _parameters(source: str, bounds: list[str], fixed: list[str]) -> dict[str, dict[str, Any]]:
    """Return the tables [parameters.NAME] from --bound and --fix."""
    tables: dict[str, dict[str, Any]] = {}
    for key, texts, parts in (("--bound", bounds, 2), ("--fix", fixed, 1)):
        for text in texts:
            name, _, numbers = text.partition("=")
            values = plain_numbers(numbers.split(":"))
            if not name or values is None or len(values) != parts:
                example = "n=1:1.5" if parts == 2 else "n=1.1"
                raise InputError(source, key, text, "is not valid", f"write {key} {example}")
            if name in tables:
                raise InputError(source, key, text, f"{name} is given twice", "keep one of them")
            tables[name] = (
                {"low": values[0], "high": values[1]}
                if parts == 2
                else {"value": values[0], "fixed": True}
            )
    return tables


def _share(source: str, key: str, text: str) -> float:
    """Return a share such as 1% or 0.01 as a number."""
    numbers = plain_numbers([text.strip().removesuffix("%")])
    if numbers is None:
        raise InputError(source, key, text, "is not a share", f"write {key} 1% or {key} 0.01")
    return numbers[0] / 100 if text.strip().endswith("%") else numbers[0]
