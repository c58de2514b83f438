"""Fits of ISO 286: from a code on a drawing, 20H7/g6, to the band of the radial clearance."""

from __future__ import annotations

import csv
import math
import re
from bisect import bisect_left
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from cylcontact.files.reading import plain_number
from cylcontact.support.arrays import FloatArray, as_floats, require
from cylcontact.support.errors import InputError

_TABLE = Path(__file__).parent / "data" / "iso286.csv"
_SMALLEST, _LARGEST = 3.0, 500.0  # mm
_GRADES = range(5, 12)
# Stands for ΔR = 0: the limit of laws, that have no value there.
_SMALLEST_CLEARANCE = 1e-6  # mm
# Places between the tightest pair and the loosest, and nodes of the integral over holes.
_PLACES, _NODES = 1001, 48
_HOLES = ("C", "D", "E", "F", "G", "H", "JS")
_PINS = ("c", "d", "e", "f", "g", "h", "j", "js", "k", "m", "n", "p", "r", "s", "u")
_CLASS = re.compile(r"\s*[⌀øØ]?\s*(\d+(?:[.,]\d+)?)\s*([A-Za-z]+)(\d+)\s*")
_CODE = re.compile(r"\s*[⌀øØ]?\s*(\d+(?:[.,]\d+)?)\s*([A-Za-z]+)(\d+)\s*[/ ]\s*([A-Za-z]+)(\d+)\s*")


@dataclass(frozen=True, eq=False)
class ClearanceShares:
    """How the clearances of the pairs of a fit are spread, between the tightest and the loosest.

    Attributes
    ----------
    places, cumulated : array
        Shares of the way from the tightest pair to the loosest, and of pairs up to there.
    below : float
        The share of pairs that are left out, because they have no clearance.
    """

    places: FloatArray
    cumulated: FloatArray
    below: float

    def percentile(self, percent: float) -> float:
        """Return the share of the way at a percentile of the pairs that are not left out."""
        wanted = self.below + percent / 100 * (1 - self.below)
        return float(np.interp(wanted, self.cumulated, self.places))

    def weights(self, places: ArrayLike) -> FloatArray:
        """Return the weights with which answers at some places give the mean over all pairs.

        They are exact for every polynomial of the place with as many coefficients as places.
        """
        nodes = as_floats(places)
        counted = np.maximum(self.cumulated, self.below)
        middles, parts = (self.places[1:] + self.places[:-1]) / 2, np.diff(counted)
        parts = parts / parts.sum()
        # Legendre's polynomials keep the equations well conditioned.
        degree = nodes.size - 1
        moments = np.polynomial.legendre.legvander(2 * middles - 1, degree).T @ parts
        matrix = np.polynomial.legendre.legvander(2 * nodes - 1, degree).T
        return as_floats(np.linalg.solve(matrix, moments))


@dataclass(frozen=True)
class IsoFit:
    """A fit of a pin in a hole, with the limits of both diameters.

    Build one with `IsoFit.read`.

    Attributes
    ----------
    code : str
        As on the drawing, "20H7/g6".
    nominal : float
        The nominal diameter in mm.
    hole, pin : (float, float)
        The lower and the upper deviation of the diameter in mm.

    Notes
    -----
    The numbers are those of ISO 286-1:2010 for nominal sizes from 3 to 500 mm, holes C to H and
    JS, pins c to u, without cd, ef, fg and t, and grades from 5 to 11. JS and js are halves of
    the tolerance, not rounded.

    Examples
    --------
    >>> fit = IsoFit.read("20H7/g6")
    >>> print(fit)
    20H7/g6: hole 20 +0.000 +0.021, pin 20 -0.020 -0.007 mm, radial clearance 3.5 to 20.5 µm
    >>> IsoFit.read("20H7/k6").kind
    'transition'
    """

    code: str
    nominal: float
    hole: tuple[float, float]
    pin: tuple[float, float]

    @classmethod
    def read(cls, code: str, source: str = "iso", key: str = "") -> IsoFit:
        """Return the fit of a code.

        Parameters
        ----------
        code : str
            The nominal diameter in mm, the hole's class and the pin's, as "20H7/g6".
        source, key : str
            Where the code comes from, for errors.

        Raises
        ------
        InputError
            If the code cannot be read, or the tables here do not have it.
        """
        match = _CODE.fullmatch(code)
        if match is None:
            rule, remedy = (
                "is not an ISO fit",
                "write the diameter in mm, the hole and the pin: 20H7/g6",
            )
            raise InputError(source, key, code, rule, remedy)
        size, hole, hole_grade, pin, pin_grade = match.groups()
        nominal = plain_number(size.replace(",", "."))
        limits = [
            _checked(code, nominal, letters, int(grade), is_hole, source, key)
            for letters, grade, is_hole in ((hole, hole_grade, True), (pin, pin_grade, False))
        ]
        plain = f"{nominal:g}{hole}{hole_grade}/{pin}{pin_grade}"
        return cls(plain, nominal, limits[0], limits[1])

    @property
    def clearance(self) -> tuple[float, float]:
        """The least and the largest radial clearance ΔR in mm, negative for an interference."""
        return (self.hole[0] - self.pin[1]) / 2, (self.hole[1] - self.pin[0]) / 2

    @property
    def kind(self) -> str:
        """What the fit is: a "clearance" (the least may be 0), "transition" or "interference"."""
        low, high = self.clearance
        return "interference" if high <= 0 else "clearance" if low >= 0 else "transition"

    @property
    def limits(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """The least and the largest radius of the hole, and of the pin, in mm."""
        (low, high), (least, most) = (
            ((self.nominal + lower) / 2, (self.nominal + upper) / 2)
            for lower, upper in (self.hole, self.pin)
        )
        return (low, high), (least, most)

    def radii(self, share: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return radii of hole and pin in mm, from the tightest (share 0) to the loosest (1)."""
        (low, high), (least, most) = self.limits
        share = as_floats(share)
        return apart(low + share * (high - low), most - share * (most - least))

    def at_clearance(self, dR: ArrayLike) -> FloatArray:
        """Return the share of the way from the tightest pair to the loosest with this ΔR in mm."""
        low, high = self.clearance
        return as_floats((as_floats(dR) - low) / (high - low))

    def shares(self, above: float = -np.inf) -> ClearanceShares:
        """Return how the clearances of produced pairs are spread, of those above a ΔR in mm.

        Both diameters are normally distributed around the middle of their tolerances, whose limits
        are 3 standard deviations away; what lies beyond the limits is rejected.

        Examples
        --------
        >>> spread = IsoFit.read("20H7/k6").shares(above=0.0)
        >>> print(f"{100 * spread.below:.1f} % of the pairs have no clearance")
        31.3 % of the pairs have no clearance
        """
        (low, high), (least, most) = self.limits
        hole, pin = (high - low) / 2, (most - least) / 2
        places = np.linspace(0, 1, _PLACES)
        # With h the place of the hole in its tolerance, from −1 to 1, the pin has to be at this
        # place of its own for a share of the way from the tightest pair to the loosest.
        h, weights = np.polynomial.legendre.leggauss(_NODES)
        weights = weights * np.exp(-4.5 * h**2)
        place = ((2 * places[:, None] - 1) * (hole + pin) - hole * h) / pin
        below = as_floats(_normal(place) @ weights / weights.sum())
        start = float(np.interp(self.at_clearance(max(above, self.clearance[0])), places, below))
        return ClearanceShares(places, below, start)

    @property
    def middle(self) -> tuple[float, float]:
        """The radii of hole and pin in mm in the middle of the fit."""
        hole, pin = self.radii(0.5)
        return float(hole), float(pin)

    def require_clearance(self, source: str, key: str = "iso") -> None:
        """Raise `InputError` unless every pin within the limits fits in every hole."""
        low, high = self.clearance
        rule = f"is an interference fit, {-2e3 * high:.3g} to {-2e3 * low:.3g} µm on the diameter"
        if self.kind == "transition":
            rule = (
                f"is a transition fit: ΔR is {1e3 * low:.3g} to {1e3 * high:.3g} µm, and a pin "
                "that is pressed in has no clearance for a law"
            )
        require(self.kind == "clearance", source, key, self.code, rule, "choose a looser pin: h, g")

    def __str__(self) -> str:
        def limits(deviations: tuple[float, float]) -> str:
            return f"{self.nominal:g} " + " ".join(map(_micrometres, deviations))

        low, high = (1e3 * value for value in self.clearance)
        return (
            f"{self.code}: hole {limits(self.hole)}, pin {limits(self.pin)} mm, "
            f"radial clearance {low:.4g} to {high:.4g} µm"
        )


def _micrometres(value: float) -> str:
    """Return a deviation in mm to a micrometre, or to a tenth of one where it has it.

    >>> _micrometres(0.021), _micrometres(-0.0075)
    ('+0.021', '-0.0075')
    """
    return f"{value:+.3f}" if abs(1e3 * value - round(1e3 * value)) < 1e-6 else f"{value:+.4f}"


def _normal(place: FloatArray) -> FloatArray:
    """Return the share of parts up to a place of their tolerance, from −1 to 1."""
    of = np.vectorize(math.erf, otypes=[float])
    edge = math.erf(3 / math.sqrt(2))
    return as_floats((1 + of(3 * np.clip(place, -1, 1) / math.sqrt(2)) / edge) / 2)


def apart(R_i: FloatArray, R_j: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return radii of hole and pin with a clearance of 1 nm at least, in place of none."""
    return as_floats(R_i), as_floats(np.minimum(R_j, R_i - _SMALLEST_CLEARANCE))


def diameters(code: str, source: str = "ISO 286", key: str = "") -> tuple[float, float]:
    """Return the least and the largest diameter in mm of one class, 20E6 or 26s6.

    Parameters
    ----------
    code : str
        The nominal diameter in mm and the class, a hole's in capital letters.
    source, key : str
        Where the code comes from, for errors.

    Raises
    ------
    InputError
        If the code cannot be read, or the tables here do not have it.

    Examples
    --------
    >>> print(*diameters("26s6"))
    26.035 26.048
    """
    match = _CLASS.fullmatch(code)
    if match is None:
        rule, remedy = "is not a class of ISO 286", "write the diameter in mm and the class: 20E6"
        raise InputError(source, key, code, rule, remedy)
    nominal, letters = plain_number(match[1].replace(",", ".")), match[2]
    low, high = _checked(code, nominal, letters, int(match[3]), letters.isupper(), source, key)
    return nominal + low, nominal + high


def _checked(
    code: str, nominal: float, letters: str, grade: int, is_hole: bool, source: str, key: str
) -> tuple[float, float]:
    """Return the deviations in mm of a class that the tables have; refuse others."""
    rule, remedy = "is outside ISO 286's range here, 3 to 500 mm", "give radii or diameters"
    require(_SMALLEST <= nominal <= _LARGEST, source, key, code, rule, remedy)
    known, body = (_HOLES, "hole") if is_hole else (_PINS, "pin")
    rule = f"has a {body} {letters} that is not in the table"
    require(letters in known, source, key, code, rule, f"choose {', '.join(known)}")
    rule, remedy = f"has a grade {grade} that is not in the table", "choose 5 to 11"
    require(grade in _GRADES, source, key, code, rule, remedy)
    if letters == "j":
        rule, remedy = f"has a pin j{grade}, and ISO 286 has j5 to j7", "choose js, or j6"
        require(grade <= 7, source, key, code, rule, remedy)
    return _deviations(nominal, letters.lower(), is_hole, grade)


def _deviations(nominal: float, letters: str, is_hole: bool, grade: int) -> tuple[float, float]:
    """Return the lower and the upper deviation in mm of a class, of a pin in small letters."""
    sizes, rows = _table()
    row = rows[bisect_left(sizes, nominal)]
    width = row[f"IT{grade}"]
    if letters == "js":
        low, high = -width / 2, width / 2
    elif is_hole:  # the mirror image of the shaft with this letter
        low, high = 0.0 - row[letters], width - row[letters]
    elif letters in "cdefgh":
        low, high = row[letters] - width, row[letters]
    else:
        key = {"j": "j7" if grade == 7 else "j6"}.get(letters, letters)
        low = 0.0 if letters == "k" and grade > 7 else row[key]
        high = low + width
    return low / 1e3, high / 1e3


@cache
def _table() -> tuple[list[float], list[dict[str, float]]]:
    """Return the upper ends of the sizes in mm, and their rows in µm."""
    lines = [line for line in _TABLE.read_text("utf-8").splitlines() if line[:1] != "#"]
    rows = [{key: float(cell) for key, cell in row.items()} for row in csv.DictReader(lines)]
    return [row["to_mm"] for row in rows], rows
