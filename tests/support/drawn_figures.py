"""The figures of the bench, each drawn once in a test run, whichever worker asks for it first."""

import pickle
import time
from dataclasses import dataclass
from pathlib import Path

import cloudpickle
import pytest

from cylcontact.files.writing import replacing
from cylcontact.plots.figure import Drawing
from cylcontact.plots.style import JOURNAL, FigureOptions
from cylcontact.reports.bench import Bench
from cylcontact.reports.build import draw, write

BENCH = Bench(Path(__file__).parents[2])
# One of each kind, which make test draws; the others are slow.
DRAWN = ("fig02", "fig07", "fig12", "fig17", "fig_any_pair", "fig_mechanism_cases")
# A picture in pixels takes as long to write as the rest, and no test looks at it.
PDF = FigureOptions(JOURNAL, ("pdf",))


def each_figure(names):
    """Parametrise a test by figures."""
    marked = [n if n in DRAWN else pytest.param(n, marks=pytest.mark.slow) for n in names]
    return pytest.mark.parametrize("name", marked)


@dataclass(frozen=True)
class DrawnFigure:
    """A figure on disk, its PDF and its CSV, and what was drawn."""

    name: str
    paths: tuple[Path, ...]
    drawing: Drawing


class DrawnFigures:
    """The figures, drawn from the committed fits when they are asked for.

    Parameters
    ----------
    folder : path
        Where their files go; the workers of a run share it.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._loaded: dict[str, DrawnFigure] = {}

    def __getitem__(self, name: str) -> DrawnFigure:
        if name not in self._loaded:
            self._loaded[name] = self._load(self._folder / f"{name}.pickle")
        return self._loaded[name]

    def _load(self, file: Path) -> DrawnFigure:
        """Return a figure from the folder, where this worker or another one has put it."""
        claim = file.with_suffix(".claim")
        claim.parent.mkdir(parents=True, exist_ok=True)
        while not file.exists():
            try:
                claim.touch(exist_ok=False)
            except FileExistsError:  # another worker draws it
                time.sleep(0.05)
                continue
            try:
                if not file.exists():
                    self._draw(file)
            finally:
                claim.unlink()
        # A drawing may hold functions of the bench, which a test's own bench has replaced.
        BENCH.module("paper")
        return pickle.loads(file.read_bytes())

    def _draw(self, file: Path) -> None:
        drawing = draw(file.stem, BENCH)
        paths = write(drawing, file.stem, self._folder, PDF)
        with replacing(file) as temporary:
            # A map's axis holds functions without a name, which plain pickle refuses.
            temporary.write_bytes(cloudpickle.dumps(DrawnFigure(file.stem, paths, drawing)))
