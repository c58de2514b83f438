"""The bench: the folders of recipes, claims and their inputs, and how recipes are imported."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from cylcontact.bodies.material import MaterialRow, known_materials, shipped_materials
from cylcontact.fitting.results import LawFit
from cylcontact.support.errors import InputError
from cylcontact.support.parallel import Workers

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Bench", "MissingInputError", "call_in_bench"]

# The package name of the files in a bench's `reports` folder. It is private, so that the folder
# hides no other package called `reports` and needs no `__init__.py`.
PACKAGE = "_cylcontact_bench"


class MissingInputError(InputError):
    """An input that does not exist yet; claims that need it cannot be tested."""


@dataclass(frozen=True)
class Bench:
    """The folders that recipes read from and figures are written to.

    Parameters
    ----------
    root : path
        The folder that holds `datasets`, `fitting` and `reports`.
    results : path, optional
        The folder of fit results; by default `fitting/results` under the root.
    jobs : int or Cluster, optional
        Worker processes for long computations; the numbers do not depend on it.

    Examples
    --------
    >>> bench = Bench(Path("bench"))
    >>> bench.results_folder.as_posix(), bench.figures_folder.as_posix()
    ('bench/fitting/results', 'bench/reports/figures')
    """

    root: Path
    results: Path | None = None
    jobs: Workers = 1

    @property
    def results_folder(self) -> Path:
        """The folder of fit results."""
        return self.results or self.root / "fitting" / "results"

    @property
    def recipes_folder(self) -> Path:
        """The folder of the recipes, one Python file per figure."""
        return self.root / "reports"

    @property
    def figures_folder(self) -> Path:
        """The default folder for figures."""
        return self.recipes_folder / "figures"

    @property
    def inputs(self) -> list[Path]:
        """The files of `datasets`, and the fit results."""
        data = (path for path in (self.root / "datasets").rglob("*") if path.is_file())
        return [*data, *self.results_folder.glob("*.json")]

    def input(self, name: Path | str) -> Path:
        """Return an input file of a figure, by its path below the root.

        Examples
        --------
        >>> Bench(Path("bench")).input("datasets/benchmarks.json").as_posix()
        'bench/datasets/benchmarks.json'
        """
        return self.root / name

    def required(self, name: Path | str, rule: str, remedy: str) -> Path:
        """Return an input file that is there.

        Raises
        ------
        MissingInputError
            If it is not, with this rule and remedy.
        """
        file = self.input(name)
        if not file.is_file():
            raise MissingInputError(str(file), "", None, rule, remedy)
        return file

    def table(self, name: str, columns: Sequence[str], remedy: str) -> pd.DataFrame:
        """Read a table that an earlier version may have written, with other columns.

        Parameters
        ----------
        name : str
            Its path below the root.
        columns : sequence of str
            What is read of it.
        remedy : str
            What writes it.

        Returns
        -------
        pandas.DataFrame
            These columns.

        Raises
        ------
        InputError
            If there is no such table, it cannot be read, or lacks a column.
        """
        import pandas as pd

        file = self.required(name, "this table does not exist", remedy)
        try:
            table = pd.read_csv(file)
        except (OSError, ValueError) as error:
            raise InputError(str(file), "", None, "cannot be read", remedy) from error
        lacking = [column for column in columns if column not in table]
        if lacking:
            raise InputError(str(file), lacking[0], None, "is a column that it lacks", remedy)
        return table[list(columns)]

    @property
    def materials_file(self) -> Path:
        """The bench's own table of materials, which is optional."""
        return self.root / "datasets" / "materials.csv"

    def module(self, name: str) -> ModuleType:
        """Import a file of the `reports` folder, such as "maps" or "claims.section1".

        Such a file imports its neighbours relatively: `from .paper import MATERIALS`. If a file of
        the folder has changed, all of them are imported again.

        Raises
        ------
        InputError
            If the file, or one that it imports, fails.

        Examples
        --------
        >>> import tempfile
        >>> bench = Bench(Path(tempfile.mkdtemp()))
        >>> bench.recipes_folder.mkdir()
        >>> _ = (bench.recipes_folder / "paper.py").write_text("LOADS = (10.0, 1000.0)")
        >>> bench.module("paper").LOADS
        (10.0, 1000.0)
        """
        _open_package(self.recipes_folder.resolve())
        try:
            with _without_bytecode():
                return importlib.import_module(f"{PACKAGE}.{name}")
        except InputError:
            raise
        except (Exception, SystemExit) as error:
            file = self.recipes_folder.joinpath(*name.split(".")).with_suffix(".py")
            rule = f"failed with {type(error).__name__} ({error})"
            raise InputError(str(file), "", None, rule, "correct the file") from error

    def materials(self) -> dict[str, MaterialRow]:
        """Return the materials that ship and the bench's own, name → row.

        Raises
        ------
        InputError
            If the bench's own table is wrong.
        """
        own = self.materials_file
        return known_materials(own if own.is_file() else None)

    def material(self, name: str) -> MaterialRow:
        """Return a row of the materials that ship, or of the bench's own; it has a `material`.

        Raises
        ------
        InputError
            If there is no such material.
        """
        # A figure of shipped materials does not depend on the bench's own table.
        shipped = shipped_materials()
        if name in shipped:
            return shipped[name]
        rows = self.materials()
        if name not in rows:
            raise InputError(
                str(self.materials_file),
                "name",
                name,
                "no material has this name",
                f"add it to this table, or choose {', '.join(rows)}",
            )
        return rows[name]

    def result_file(self, name: str) -> Path:
        """Return an input file of a figure, by its name in the results folder."""
        return self.results_folder / name

    def result(self, name: str) -> LawFit:
        """Load the fit of a law to a law `NAME.json`.

        Raises
        ------
        InputError
            If it has not been made, or is not such a fit.
        """
        path = self.result_file(f"{name}.json")
        if not path.is_file():
            raise MissingInputError(
                str(path),
                "",
                None,
                "this fit result does not exist",
                f"make it with: cylcontact fit fitting/{name}.toml -o {path}",
            )
        return LawFit.read(path)


def call_in_bench(root: Path, module: str, function: str, *arguments: Any) -> Any:
    """Call a function of a bench's module in a worker process.

    Workers cannot unpickle the function itself, because the bench is not on their import path.

    Parameters
    ----------
    root : path
        The bench's folder.
    module, function : str
        The module, as for `Bench.module`, and the function's name.
    *arguments
        Arguments of the function.
    """
    return getattr(Bench(root).module(module), function)(*arguments)


def _open_package(folder: Path) -> None:
    """Bind `PACKAGE` to a folder in its present state."""
    stamp = {
        file: (status.st_mtime_ns, status.st_size)
        for file in folder.rglob("*.py")
        for status in [file.stat()]
    }
    current: Any = sys.modules.get(PACKAGE)
    if current is not None and current.__path__ == [str(folder)] and current.stamp == stamp:
        return
    for name in [name for name in sys.modules if name.partition(".")[0] == PACKAGE]:
        del sys.modules[name]
    package: Any = ModuleType(PACKAGE, "The files of a bench's `reports` folder.")
    package.__path__, package.stamp = [str(folder)], stamp
    sys.modules[PACKAGE] = package
    importlib.invalidate_caches()


@contextmanager
def _without_bytecode() -> Iterator[None]:
    """Write no compiled files to a user's folder; they could also be stale after an edit."""
    before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        yield
    finally:
        sys.dont_write_bytecode = before
