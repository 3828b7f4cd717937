"""A plain single-line alphabet for engraving: strokes that every cutter draws, whatever fonts it has."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from wiggleroom.drawing.model import Part, Points
from wiggleroom.drawing.outlines.rings import signed_area

_CAPITAL, _BASE, _SPACE = 6.0, 2.0, 1.7
"""Height of capitals, height of the base line, and space between letters, in units of the alphabet."""
FILL_SHARE = 0.85
"""Share of the largest circle in a part that its name may fill, ..."""
MAX_HEIGHT_SHARE = 0.35
"""... and its height as a share of that circle's radius."""

# Strokes by pairs of digits x, y: base line at 2, small letters to 6, capitals to 8, tails to 0.
_GLYPHS = {
    "0": "123243473818070312 0347", "1": "071812 0222", "2": "07183847460242", "3": "0718384746354443321203 1535",
    "4": "32380444", "5": "480805354443321203", "6": "4738180703123243443505", "7": "084812",
    "8": "15060718384746351504031232434435", "9": "0312324347381807061545",
    "A": "022842 1535", "B": "02083847463505 3544433202", "C": "4738180703123243", "D": "02083847433202",
    "E": "48080242 0535", "F": "480802 0535", "G": "47381807031232434525", "H": "0208 4248 0545",
    "I": "0222 0828 1218", "J": "4843321203", "K": "0208 480542", "L": "080242", "M": "0208254842", "N": "02084248",
    "O": "123243473818070312", "P": "02083847463505", "Q": "123243473818070312 2442", "R": "02083847463505 2542",
    "S": "473818070615354443321203", "T": "0848 2228", "U": "080312324348", "V": "082248", "W": "0812253248",
    "X": "0248 0842", "Y": "082548 2522", "Z": "08480242",
    "a": "36160503122233 3632", "b": "0802 0312223335261605", "c": "3526160503122233", "d": "3832 3526160503122233",
    "e": "043435261605031232", "f": "38281712 0626", "g": "36312000 3526160503122233", "h": "0802 0516263532",
    "i": "0602 0807", "j": "26211000 2827", "k": "0802 360432", "l": "080312", "m": "0602 05162522 25364542",
    "n": "0602 0516263532", "o": "122233352616050312", "p": "0600 0312223335261605", "q": "3630 3526160503122233",
    "r": "0602 051626", "s": "361605332202", "t": "18132232 0626", "u": "0603122233 3632", "v": "062246",
    "w": "0612243246", "x": "0236 0632", "y": "0622 4610", "z": "06360232",
    " ": "", "-": "0535", "_": "0141", ".": "0203", ",": "1301", ":": "0203 0506", ";": "1301 1516", "+": "0545 2327",
    "=": "0444 0646", "/": "0248", "\\": "0842", "(": "18070312", ")": "08171302", "[": "18080212", "]": "08181202",
    "<": "470543", ">": "074503", "#": "1218 3238 0444 0646", "*": "0545 1337 1733", "'": "0807", '"': "0807 2827",
    "!": "0804 0302", "?": "071838474624 2322", "%": "0248 0717 3343", "&": "42161728370403122244", "|": "0208",
}  # fmt: skip
_UNKNOWN = "0208484202"


@dataclass(frozen=True)
class Label:
    """Something to engrave.

    Parameters
    ----------
    text : str
    at : (x, y) [mm]
        Its middle.
    height : float [mm]
        Height of a capital.
    """

    text: str
    at: tuple[float, float]
    height: float


def lettered(label: Label) -> list[Points]:
    """Strokes (n, 2) [mm] of a label.

    Examples
    --------
    >>> [stroke.tolist() for stroke in lettered(Label("L", (0.0, 0.0), 6.0))]
    [[[-2.0, 3.0], [-2.0, -3.0], [2.0, -3.0]]]
    """
    strokes, x = _laid_out(label.text)
    size = label.height / _CAPITAL
    middle = np.array([x / 2, _BASE + _CAPITAL / 2])
    return [(stroke - middle) * size + label.at for stroke in strokes]


def width_of(text: str, height: float) -> float:
    """Width [mm] of a line of text whose capitals are `height` [mm] high.

    Examples
    --------
    >>> width_of("L", 6.0)
    4.0
    """
    return _laid_out(text)[1] * height / _CAPITAL


def labels_of(parts: Sequence[Part]) -> tuple[Label, ...]:
    """Name of every part in the middle of its largest free place, none taller than those of most others.

    Examples
    --------
    >>> from wiggleroom.drawing.model import Region
    >>> part = Part("a", (Region(np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])),))
    >>> [round(x, 2) for x in labels_of([part])[0].at]
    [2.0, 2.0]
    """
    places: dict[int, tuple[Points, float]] = {}
    rows: list[tuple[str, Points, float]] = []
    for part in parts:
        if id(part.regions) not in places:
            places[id(part.regions)] = _free_place(part)
        at, radius = places[id(part.regions)]
        x, y, angle = part.at
        turned = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        across = np.hypot(width_of(part.name, 1.0), 1.0)
        rows.append((part.name, at @ turned + (x, y), min(2 * FILL_SHARE * radius / across, MAX_HEIGHT_SHARE * radius)))
    tallest = float(np.median([height for *_, height in rows])) if rows else 0.0
    return tuple(Label(name, (float(at[0]), float(at[1])), min(height, tallest)) for name, at, height in rows)


def _free_place(part: Part) -> tuple[Points, float]:
    """Middle and radius [mm] of the largest circle in the largest piece of a part, in its own frame."""
    region = max(part.regions, key=lambda region: signed_area(region.outer))
    polygon = shapely.Polygon(region.outer, region.holes)
    if not polygon.is_valid:
        return region.outer.mean(axis=0), 0.0
    spoke = shapely.get_coordinates(shapely.maximum_inscribed_circle(polygon))
    return spoke[0], float(np.hypot(*(spoke[1] - spoke[0])))


def _laid_out(text: str) -> tuple[list[Points], float]:
    """Strokes of a line of text in units of the alphabet, and its width."""
    strokes: list[Points] = []
    x = 0.0
    for letter in text:
        plain = unicodedata.normalize("NFKD", letter)[:1]
        glyph = _GLYPHS.get(letter, _GLYPHS.get(plain, _UNKNOWN))
        digits = [np.array(list(map(float, stroke))).reshape(-1, 2) for stroke in glyph.split()]
        strokes += [stroke + np.array([x, 0.0]) for stroke in digits]
        x += max((float(stroke[:, 0].max()) for stroke in digits), default=1.0) + _SPACE
    return strokes, max(x - _SPACE, 0.0)
