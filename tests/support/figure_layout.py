"""What a journal's desk would send back: faults in the layout of a figure."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from unittest.mock import patch

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.path import Path
from matplotlib.text import Text
from matplotlib.transforms import Affine2D, Bbox

from cylcontact.plots.style import JOURNAL, MM_PER_INCH, FigureStyle, figure_style

SMALLEST = 6.0  # points
# A text's box is higher than its letters: this much of the size of its font is not ink.
BLANK = {"left": 0.08, "right": 0.08, "bottom": 0.24, "top": 0.12}


@dataclass(frozen=True)
class Label:
    """A text as it is drawn: its ink as a rectangle in its own frame, and the way there."""

    text: str
    size: float
    ink: Bbox
    to_frame: Affine2D

    def __str__(self) -> str:
        return repr(self.text)

    def corners(self) -> np.ndarray:
        """Return the corners of the ink in pixels."""
        return self.to_frame.inverted().transform(self.ink.corners()[[0, 1, 3, 2]])

    def is_crossed_by(self, path: Path) -> bool:
        """Return whether a line, in pixels, runs through the ink."""
        return self.to_frame.transform_path(path).intersects_bbox(self.ink, filled=False)

    def holds(self, points: np.ndarray) -> bool:
        """Return whether a point, in pixels, lies in the ink."""
        low, high = self.ink.min, self.ink.max
        own = self.to_frame.transform(points)
        return bool(((own > low) & (own < high)).all(axis=1).any())

    def overlaps(self, other: "Label") -> bool:
        """Return whether the ink of two texts overlaps."""
        return _apart(self, other) and _apart(other, self)


def _apart(one: Label, other: Label) -> bool:
    """Return whether no side of `one` separates it from `other`."""
    points = one.to_frame.transform(other.corners())
    low, high = points.min(axis=0), points.max(axis=0)
    return bool((high > one.ink.min).all() and (low < one.ink.max).all())


def layout_faults(figure: Figure, style: FigureStyle = JOURNAL) -> list[str]:
    """Return what is wrong with the layout of a figure drawn in a style, a sentence each.

    Texts that overlap, that a line or a marker runs through, that cross the frame of a panel or
    leave the page, that are smaller than six points; and a width that is not the style's.
    """
    with figure_style(style):
        labels = _labels(figure)
        width = figure.get_size_inches()[0] * MM_PER_INCH
        widths = style.widths_mm
        faults = [f"is {width:.1f} mm wide"] if min(abs(width - w) for w in widths) > 0.01 else []
        drawn, page = figure.get_tightbbox(), figure.bbox_inches
        if min(drawn.x0, drawn.y0) < 0 or drawn.x1 > page.x1 or drawn.y1 > page.y1:
            faults.append("something leaves the page")
        faults += [fault for label in labels for fault in _faults_of_one(label, figure.bbox)]
        faults += [f"{a} overlaps {b}" for a, b in combinations(labels, 2) if a.overlaps(b)]
        faults += [fault for axes in figure.axes for fault in _faults_in_panel(axes, labels)]
    return faults


def _faults_of_one(label: Label, page: Bbox) -> Iterator[str]:
    """Return what is wrong with a text by itself."""
    if label.size < SMALLEST - 1e-6:
        yield f"{label} has {label.size:.1f} points"
    corners = label.corners()
    if (corners < page.min - 0.5).any() or (corners > page.max + 0.5).any():
        yield f"{label} leaves the page"


def _faults_in_panel(axes: Axes, labels: list[Label]) -> Iterator[str]:
    """Return what in a panel runs through a text."""
    frames, lines, points = list(_frame(axes)), list(_lines(axes)), list(_points(axes))
    for label in labels:
        if any(map(label.is_crossed_by, frames)):
            yield f"{label} crosses the frame of a panel"
        if any(map(label.is_crossed_by, lines)):
            yield f"{label} has a line through it"
        if any(map(label.holds, points)):
            yield f"{label} has a marker on it"


def _labels(figure: Figure) -> list[Label]:
    """Return the texts that are drawn, once each."""
    drawn: dict[int, Text] = {}

    def record(text: Text, *_: object) -> None:
        if text.get_visible() and text.get_text().strip():
            drawn[id(text)] = text

    with patch.object(Text, "draw", record):
        figure.draw_without_rendering()
    return [_label(text, figure.dpi) for text in drawn.values()]


def _label(text: Text, dpi: float) -> Label:
    """Return the ink of a text."""
    box = Text.get_window_extent(text)
    angle = text.get_rotation()
    # Its width and height before it is turned, which leaves the middle where it is.
    with patch.object(text, "_rotation", 0.0), patch.object(text, "_transform_rotates_text", False):
        plain = Text.get_window_extent(text)
    size = float(text.get_fontsize())
    em = size * dpi / 72
    half = 0.5 * np.array([plain.width, plain.height])
    low = -half + em * np.array([BLANK["left"], BLANK["bottom"]])
    high = half - em * np.array([BLANK["right"], BLANK["top"]])
    middle = 0.5 * (box.min + box.max)
    to_frame = Affine2D().translate(*-middle).rotate_deg(-angle)
    return Label(text.get_text(), size, Bbox([low, high]), to_frame)


def _frame(axes: Axes) -> Iterator[Path]:
    """Return the visible sides of a panel in pixels."""
    if not (axes.get_visible() and axes.axison):
        return
    for spine in axes.spines.values():
        if spine.get_visible():
            yield spine.get_transform().transform_path(spine.get_path())


def _lines(axes: Axes) -> Iterator[Path]:
    """Return the lines in a panel, cut off at its frame, in pixels."""
    if not axes.get_visible():
        return
    clip = axes.bbox
    for artist in axes.get_children():
        if not artist.get_visible() or isinstance(artist, Legend):
            continue
        if isinstance(artist, Line2D) and artist.get_linestyle() not in ("None", " ", ""):
            yield from _clipped([artist.get_path()], artist, clip)
        elif isinstance(artist, LineCollection) or (
            isinstance(artist, ContourSet) and not artist.filled
        ):
            yield from _clipped(artist.get_paths(), artist, clip)


def _clipped(paths: Sequence[Path], artist: Artist, clip: Bbox) -> Iterator[Path]:
    """Return an artist's paths in pixels, without what its panel's frame cuts off."""
    edges = tuple(clip.extents) if artist.get_clip_on() else None
    for path in paths:
        whole = artist.get_transform().transform_path(path)
        if len(whole.vertices):
            cut = whole.cleaned(clip=edges, remove_nans=True)
            yield from map(Path, cut.to_polygons(closed_only=False))


def _points(axes: Axes) -> Iterator[np.ndarray]:
    """Return the places of the markers in a panel that its frame does not cut off, in pixels."""
    if not axes.get_visible():
        return
    frame = axes.bbox
    for artist in axes.get_children():
        if not artist.get_visible():
            continue
        if isinstance(artist, Line2D) and artist.get_marker() not in ("None", " ", "", None):
            path = artist.get_transform().transform_path(artist.get_path())
            every = artist.get_markevery()
            points = path.vertices
            if isinstance(every, int):
                points = points[::every]
            elif isinstance(every, tuple):
                points = points[every[0] :: every[1]]
            inside = ((points >= frame.min) & (points <= frame.max)).all(axis=1)
            yield points[inside] if artist.get_clip_on() else points
        elif isinstance(artist, PathCollection):
            yield artist.get_offset_transform().transform(artist.get_offsets())
