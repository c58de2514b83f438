"""The bench: where the specs, fit results, recipes and figures lie."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from cylcontact.errors import InputError
from cylcontact.fitting.result import FitResult
from cylcontact.materials import SHIPPED, MaterialRow, known_materials, shipped_materials


@dataclass(frozen=True)
class Bench:
    """The folders that recipes read from and figures go to.

    Parameters
    ----------
    root : path
        The folder that holds `datasets`, `fitting` and `reports`.
    results : path, optional
        The folder of fit results; left out, `fitting/results` under the root.

    Examples
    --------
    >>> bench = Bench(Path("bench"))
    >>> bench.results_folder.as_posix(), bench.figures_folder.as_posix()
    ('bench/fitting/results', 'bench/reports/figures')
    """

    root: Path
    results: Path | None = None

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

    @property
    def mechanism_file(self) -> Path:
        """The spec of the slider-crank."""
        return self.input("datasets/slider_crank.toml")

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
            raise InputError(
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
