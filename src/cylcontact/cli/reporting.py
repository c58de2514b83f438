"""The commands `figure`, `report`, `claims` and `paper`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from cylcontact.cli.options import (
    JOBS,
    RESULTS_FOLDER,
    STYLES,
    argument,
    option,
    output,
    require_output,
    several,
)
from cylcontact.cli.terminal import progress_bars, say
from cylcontact.files.writing import replacing, require_apart, write_table
from cylcontact.support.choices import FORMATS, listed
from cylcontact.support.errors import InputError, require


def figure(
    names: list[str] | None = argument(
        "Recipes, e.g. fig10 fig_explicit; all by default. Arguments of a recipe follow its name, "
        'e.g. maps material="titanium alloy" law=explicit.',
        default=None,
    ),
    out: Path | None = output("The folder; reports/figures by default."),
    style: str | None = option(f"{listed(STYLES)}.", metavar="STYLE"),
    formats: list[str] | None = several(
        f"{listed(FORMATS)}.", "--format", of=str, metavar="FORMAT"
    ),
    results: Path = RESULTS_FOLDER,
    jobs: int = JOBS,
) -> None:
    """Draw figures, each with the CSV of its numbers."""
    from cylcontact.plots.style import JOURNAL, choose
    from cylcontact.reports.bench import Bench
    from cylcontact.reports.build import build

    bench = Bench(Path(), results, jobs)
    choice = choose(bench.recipes_folder / "style.mplstyle", style, tuple(formats or ()))
    own = bench.figures_folder
    folder = out or (own if choice.style.name == JOURNAL.name else own / choice.style.name)
    recipes, arguments = _names_and_arguments(names or ())
    with progress_bars() as progress:
        drawn = build(bench, recipes, folder, choice, progress, arguments)
    problems = [each.problem for each in drawn if each.problem is not None]
    for problem in problems[1:]:
        say(f"cylcontact: {problem}", err=True)
    if problems:
        raise problems[0]
    count = len(drawn)
    say(f"{count} {'figure' if count == 1 else 'figures'} in {folder}")


def _names_and_arguments(words: Sequence[str]) -> tuple[list[str], dict[str, str]]:
    """Split a command line into recipes and the arguments, KEY=VALUE, of a single one."""
    recipes = [word for word in words if "=" not in word]
    pairs = [word.partition("=") for word in words if "=" in word]
    if pairs and len(recipes) != 1:
        rule, remedy = "is an argument of one recipe", "name that recipe before it, and no other"
        raise InputError("figure", pairs[0][0], pairs[0][2], rule, remedy)
    return recipes, {key: value for key, _, value in pairs}


def report(
    out: Path | None = option("The folder; build/site by default.", "-o", "--out"),
    results: Path = RESULTS_FOLDER,
    jobs: int = JOBS,
) -> None:
    """Build the results as pages to read in a browser: laws, figures, fits, statements."""
    from cylcontact.reports.bench import Bench
    from cylcontact.reports.pages import build_site

    bench = Bench(Path(), results, jobs)
    with progress_bars() as progress:
        site = build_site(bench, out or Path("build", "site"), progress)
    for reason in site.missing:
        say(f"missing, {reason}", err=True)
    say(f"open {site.index}")


def claims(
    out: Path | None = option("Write the ledger as .csv or .json instead.", "-o", "--out"),
    results: Path = RESULTS_FOLDER,
    jobs: int = JOBS,
) -> None:
    """Compare each statement of the paper with a computed number, and give a verdict.

    Long simulations are stored, and repeated only if something that they depend on changes.
    """
    from cylcontact.reports.bench import Bench
    from cylcontact.reports.claims import ledger, withdrawn
    from cylcontact.reports.claims_text import to_json, to_table, to_text
    from cylcontact.reports.paper import paper_of

    bench = Bench(Path(), results, jobs)
    require_output(out, ".csv", ".json")
    if out is not None:
        require_apart([out], bench.inputs)
    folder = bench.recipes_folder / "claims"
    remedy = "run it in a folder that has them; cylcontact init FOLDER lays one out"
    require(folder.is_dir(), str(folder), "", None, "there are no claims here", remedy)
    try:
        with progress_bars() as progress:
            computed = ledger(bench, progress)
    except KeyboardInterrupt:
        text = "interrupted; the runs that were complete are kept, and the same command goes on"
        raise KeyboardInterrupt(text) from None
    terms, gone = paper_of(bench).definitions, withdrawn(bench)
    if out is None:
        say(to_text(computed, terms, gone))
        return
    if out.suffix == ".csv":
        write_table(to_table(computed), out)
    else:
        with replacing(out) as temporary:
            temporary.write_text(to_json(computed, terms, gone), encoding="utf-8")
    count = len(computed)
    say(f"{count} {'claim' if count == 1 else 'claims'} written to {out}")


def paper(
    source: Path = argument(
        "The manuscript: Markdown that names numbers and figures.",
        default=Path("reports/manuscript/pin_in_hole.md"),
    ),
    out: Path | None = option("The folder; reports/typeset/NAME.", "-o", "--out"),
    results: Path = RESULTS_FOLDER,
    jobs: int = JOBS,
) -> None:
    """Typeset a paper whose numbers and figures come from results, as PDF and as LaTeX."""
    from cylcontact.reports.bench import Bench
    from cylcontact.reports.manuscript import typeset

    bench = Bench(Path(), results, jobs)
    folder = out or bench.recipes_folder / "typeset" / source.stem
    with progress_bars() as progress:
        made = typeset(bench, source, folder, progress)
    say(f"{made}; sources for a journal in {folder / 'latex'}")
