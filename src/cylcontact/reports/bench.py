"""The bench: the folders that recipes and claims live in and read from, and how they are loaded."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from cylcontact.errors import InputError
from cylcontact.fitting.result import FitResult
from cylcontact.materials import SHIPPED, MaterialRow, known_materials, shipped_materials
from cylcontact.parallel import Workers

# The name under which the files of a bench's `reports` folder are imported. It is private, so
# that a folder called `reports` hides nobody's package and needs no `__init__.py`.
PACKAGE = "_cylcontact_bench"


class MissingInputError(InputError):
    """An input that has not been made yet: a claim that needs it cannot be tested."""


@dataclass(frozen=True)
class Bench:
    """The folders that recipes read from and figures go to.

    Parameters
    ----------
    root : path
        The folder that holds `datasets`, `fitting` and `reports`.
    results : path, optional
        The folder of fit results; left out, `fitting/results` under the root.
    jobs : int or Cluster, optional
        Worker processes for computations that take long; the numbers do not depend on it.

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
        """Where fit results are read from."""
        return self.results or self.root / "fitting" / "results"

    @property
    def recipes_folder(self) -> Path:
        """Where the recipes lie, one Python file per figure."""
        return self.root / "reports"

    @property
    def figures_folder(self) -> Path:
        """Where figures are written unless another folder is named."""
        return self.recipes_folder / "figures"

    def noted(self, path: Path) -> Path:
        """Return a file that is about to be read; a bench that watches its recipes notes it."""
        return path

    def input(self, name: Path | str) -> Path:
        """Return where a file lies that a figure is drawn from, by its path below the root.

        Examples
        --------
        >>> Bench(Path("bench")).input("datasets/benchmarks.json").as_posix()
        'bench/datasets/benchmarks.json'
        """
        return self.noted(self.root / name)

    @property
    def materials_file(self) -> Path:
        """The bench's own table of materials, beside the one that ships; it may be absent."""
        return self.root / "datasets" / "materials.csv"

    def module(self, name: str) -> ModuleType:
        """Import a file of the `reports` folder, such as "maps" or "claims.section1".

        Such a file imports its neighbours relatively: `from .paper import MATERIALS`. A file that
        has changed since is read anew, and so is everything else in the folder.

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
        with _without_bytecode():
            return importlib.import_module(f"{PACKAGE}.{name}")

    def materials(self) -> dict[str, MaterialRow]:
        """Return the materials that ship and the bench's own, name → row.

        Raises
        ------
        InputError
            If the bench's own table is wrong.
        """
        self.noted(SHIPPED)
        own = self.materials_file
        return known_materials(self.noted(own) if own.is_file() else None)

    def material(self, name: str) -> MaterialRow:
        """Return a material that ships, or one of the bench's own.

        Raises
        ------
        InputError
            If there is no such material.
        """
        # A figure of shipped materials does not depend on the bench's own table.
        shipped = shipped_materials()
        if name in shipped:
            self.noted(SHIPPED)
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
        """Return where a file of the results folder lies that a figure is drawn from."""
        return self.noted(self.results_folder / name)

    def result(self, name: str) -> FitResult:
        """Load the fit result `NAME.json`.

        Raises
        ------
        InputError
            If it has not been made, or is not a fit result.
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
        return FitResult.load(path)

    def results_by_name(self) -> dict[str, FitResult]:
        """Load every fit result of the results folder, name → result; none where there are none.

        Raises
        ------
        InputError
            If a file there is not a fit result.
        """
        return {
            path.stem: FitResult.load(path) for path in sorted(self.results_folder.glob("*.json"))
        }


def call_in_bench(root: Path, module: str, function: str, *arguments: Any) -> Any:
    """Call a function of a bench's module; what worker processes get instead of the function.

    They cannot unpickle it, because the bench is not on their import path.

    Parameters
    ----------
    root : path
        The bench's.
    module, function : str
        Where it is, as for `Bench.module`, and its name.
    *arguments
        Those of the function.
    """
    return getattr(Bench(root).module(module), function)(*arguments)


def _open_package(folder: Path) -> None:
    """Make `PACKAGE` stand for a folder as it is now."""
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
    """Leave no compiled files in a user's folder; they could also be older than an edit."""
    before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        yield
    finally:
        sys.dont_write_bytecode = before
