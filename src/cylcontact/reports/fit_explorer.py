"""Sliders for the coefficients of a fit to measurements: the curve and the objective, live.

A `FitView` computes what coefficients other than the best would mean and draws them beside the
optimum; `explore_fit` connects it to sliders.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.image import imsave
from matplotlib.lines import Line2D

from cylcontact.arrays import FloatArray, as_floats
from cylcontact.fitting.measured import Fit
from cylcontact.html_repr import table_html
from cylcontact.plots.figure import SCREEN_DPI, StyledFigure, new_figure
from cylcontact.plots.measured import draw_readings
from cylcontact.plots.style import ACCENT, QUIET, figure_style
from cylcontact.reports.notebook import require_extra

if TYPE_CHECKING:
    from cylcontact.fitting.results import DataFit

__all__ = ["FitView", "explore_fit"]

# Half-widths of a coefficient's interval that its slider reaches to either side of the optimum.
_REACH = 4.0
_STEPS = 400
_POINTS, _PAIRS = 61, 5
_MICROMETRES = 1e3


@dataclass(frozen=True, eq=False)
class FitView:
    """What coefficients other than the best mean for the data of a fit.

    Attributes
    ----------
    result : DataFit
        Of measurements.

    Examples
    --------
    >>> import pandas as pd
    >>> import cylcontact as cc
    >>> steel = cc.Material("steel", E="207 GPa", nu=0.3)
    >>> pair = cc.CylinderPair.internal(R_i=10.0, R_j=9.97, material=steel, length=20.0)
    >>> load, noise = np.geomspace(10.0, 1000.0, 9), 1 + 0.01 * np.cos(np.arange(9))
    >>> depth = cc.laws.Explicit().penetration(load, pair) * noise
    >>> data = pd.DataFrame({"load_N": load * 20.0, "penetration_um": 1e3 * depth})
    >>> view = FitView(cc.fit(data, "explicit", pair))
    >>> print(view.verdict(view.best | {"stiffness_factor": 1.05}))
    Ruled out: the objective is 5.955 times the best, above the threshold of 95 %, 1.534 times.
    """

    result: DataFit

    @property
    def fit(self) -> Fit:
        """The law, the readings and the noise."""
        return self.result.optimum.fit

    @cached_property
    def best(self) -> dict[str, float]:
        """The fitted values of the free coefficients."""
        return self.result.free

    @cached_property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """The ends of the sliders: each interval, widened, but not beyond the bounds."""
        return {name: self._range(name) for name in self.best}

    def _range(self, name: str) -> tuple[float, float]:
        """Return the ends of one slider."""
        parameter = next(p for p in self.fit.free if p.name == name)
        estimates = self.result.uncertainty.estimates
        ends = estimates[name].profile or estimates[name]
        if ends.low is None or ends.high is None:
            return parameter.low, parameter.high
        best = self.best[name]
        low = max(parameter.low, best - _REACH * (best - ends.low))
        high = min(parameter.high, best + _REACH * (ends.high - best))
        return float(low), float(high)

    @cached_property
    def threshold(self) -> float:
        """The largest objective, relative to the best, that the data do not rule out.

        It is that of the joint region of all free coefficients, since the others do not follow
        when one moves; NaN if the fit has no covariance, or is exact.
        """
        optimum = self.result.optimum
        if optimum.covariance is None or optimum.is_rounding:
            return float("nan")
        most = optimum.threshold(self.result.level, list(self.best))
        return float(np.sqrt(1 + most * optimum.unit / optimum.sum_of_squares))

    def relative(self, coefficients: Mapping[str, float]) -> float:
        """Return the objective relative to the best; inf where the law is undefined."""
        best = self.result.objective.value
        value = self.fit.value(self.fit.point(coefficients))
        return value / best if best > 0 else float("nan")

    def verdict(self, coefficients: Mapping[str, float]) -> str:
        """Return whether the data rule coefficients out, in a sentence."""
        return self._sentence(self.relative(coefficients))

    def _sentence(self, times: float) -> str:
        """Return the verdict on an objective relative to the best."""
        threshold = self.threshold
        if np.isinf(times):
            return "The law is undefined at these values for some of the loads."
        if np.isnan(times) or np.isnan(threshold):
            return "There is no threshold: the fit is exact, or has no covariance."
        level = f"the threshold of {100 * self.result.level:g} %, {threshold:.4g} times"
        if times > threshold:
            return f"Ruled out: the objective is {times:.4g} times the best, above {level}."
        return f"Not ruled out: the objective is {times:.4g} times the best, below {level}."

    def table(self, coefficients: Mapping[str, float]) -> str:
        """Return the coefficients beside the best ones, and their objective, as HTML."""
        rows: dict[str, object] = {
            f"{p.name}{f', {p.unit}' if p.unit else ''}": (
                f"{coefficients[p.name]:.5g} (best {self.best[p.name]:.5g})"
            )
            for p in self.fit.free
        }
        times = self.relative(coefficients)
        rows[self.result.objective.name] = times * self.result.objective.value
        rows["times the best"] = times
        return table_html("With the sliders here", rows) + f"<p>{escape(self._sentence(times))}</p>"

    def readings(self, coefficients: Mapping[str, float]) -> list[FloatArray]:
        """Return the readings that each pair's curve is drawn with, in mm; NaN if undefined."""
        law = self.fit.law(self.fit.point(coefficients))
        return [
            np.full_like(load, np.nan) if law is None else law.penetration(load, pair)
            for load, pair in self._loads
        ]

    @property
    def has_series(self) -> bool:
        """Whether the fit allows for errors of series, a drift among them."""
        return "series_mm" in self.result.residuals

    @property
    def points(self) -> tuple[FloatArray, FloatArray]:
        """Loads in N/mm, and readings in mm less what the series add at the best fit."""
        table = self.result.residuals
        added = table["series_mm"] if self.has_series else 0.0
        reading = table["penetration_mm"] - added
        return table["load_N_per_mm"].to_numpy(), as_floats(reading.to_numpy())

    @cached_property
    def _loads(self) -> list[tuple[FloatArray, Any]]:
        """The loads of each pair's curve, and the pair."""
        data, curves = self.fit.data, []
        names, index = data.groups("pair")
        for number in range(min(len(names), _PAIRS)):
            rows = np.flatnonzero(index == number)
            loads = data.load[rows]
            at = as_floats(np.geomspace(loads.min(), loads.max(), _POINTS))
            curves.append((at, data.take(rows[:1]).pair))
        return curves


class _Picture:
    """The data with two curves for each pair, the optimum's and that of the sliders.

    All but the sliders' curves is drawn once: a whole figure takes longer than a slider may wait.
    """

    def __init__(self, view: FitView) -> None:
        self.view = view
        with figure_style():
            figure: StyledFigure = new_figure("column", 68.0)
            figure.set_dpi(SCREEN_DPI)
            canvas: Any = FigureCanvasAgg(figure)
            self.axes = figure.subplots()
            draw_readings(self.axes, *view.points)
            if view.has_series:
                self.axes.set_ylabel("penetration less series effects (µm)")
            self._draw("best fit", linestyle="-", color=QUIET)
            self.moving = self._draw("sliders", linestyle="--", color=ACCENT)
            self.axes.legend()
            # The axes stay where they are when the curve moves.
            self.axes.set(xlim=self.axes.get_xlim(), ylim=self.axes.get_ylim())
            for line in self.moving:
                line.set_animated(True)
            canvas.draw()
        self.canvas, self.still = canvas, canvas.copy_from_bbox(figure.bbox)

    def _draw(self, label: str, **style: Any) -> list[Line2D]:
        """Draw the curves of the best fit, and return them."""
        lines: list[Line2D] = []
        for (load, _), reading in zip(
            self.view._loads, self.view.readings(self.view.best), strict=True
        ):
            name = None if lines else label
            lines += self.axes.plot(load, _MICROMETRES * reading, marker="", label=name, **style)
        return lines

    def png(self, coefficients: Mapping[str, float]) -> bytes:
        """Return the picture with the curve of coefficients."""
        self.canvas.restore_region(self.still)
        for line, reading in zip(self.moving, self.view.readings(coefficients), strict=True):
            line.set_ydata(_MICROMETRES * reading)
            self.axes.draw_artist(line)
        stream = io.BytesIO()
        imsave(stream, np.asarray(self.canvas.buffer_rgba()), format="png")
        return stream.getvalue()


def explore_fit(result: DataFit) -> Any:
    """Return sliders for the coefficients of a fit, with the data and the objective, live.

    Each slider reaches over the coefficient's interval, widened. The objective is compared with
    the best, and with the threshold above which the data rule the values out together.

    Parameters
    ----------
    result : DataFit
        Of measurements.

    Returns
    -------
    ipywidgets.VBox
        Sliders and a button that resets them, the picture, and the table.

    Raises
    ------
    InputError
        If ipywidgets is not installed, or the result is not of measurements.
    """
    widgets = require_extra("ipywidgets")
    view = FitView(result)
    picture = _Picture(view)
    wide = {"style": {"description_width": "12em"}, "layout": widgets.Layout(width="34em")}
    sliders = {
        p.name: widgets.FloatSlider(
            value=view.best[p.name],
            min=view.ranges[p.name][0],
            max=view.ranges[p.name][1],
            step=(view.ranges[p.name][1] - view.ranges[p.name][0]) / _STEPS,
            description=f"{p.name} ({p.unit})" if p.unit else p.name,
            readout_format=".4g",
            **wide,
        )
        for p in view.fit.free
    }
    reset = widgets.Button(description="back to the best fit")
    image, table = widgets.Image(format="png"), widgets.HTML()

    def update(_change: object = None) -> None:
        values = {name: slider.value for name, slider in sliders.items()}
        image.value, table.value = picture.png(values), view.table(values)

    def back(_button: object = None) -> None:
        for name, slider in sliders.items():
            slider.value = view.best[name]

    for slider in sliders.values():
        slider.observe(update, names="value")
    reset.on_click(back)
    update()
    left = widgets.VBox([*sliders.values(), reset, table])
    return widgets.HBox([left, image], layout=widgets.Layout(flex_flow="row wrap"))
