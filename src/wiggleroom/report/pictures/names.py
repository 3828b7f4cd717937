"""Names inside the parts, as large as they fit, where nothing else is drawn."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import affinity

from wiggleroom.report.pictures import palette
from wiggleroom.report.pictures.part_paths import PartPath
from wiggleroom.report.pictures.text import escape, text_width
from wiggleroom.report.results.answer_words import short

_SMALLEST, _LARGEST = 7.0, 15.0
"""Least and largest size of the text [px]."""
MAX_MEASURED = 400
"""Names that are measured to find the size of the text."""
MIN_NAME_SIZE = 10.0
"""Names that fit only in smaller text are left out, but for the first ones [px]."""
OFFSET_STEPS = (0.0, 0.3, -0.3, 0.6, -0.6)
"""Where a name is tried beside its place, in sizes of the text."""
Floats = NDArray[np.float64]
Place = tuple[float, float, float]
_PLACES = sorted(((dx, dy) for dy in OFFSET_STEPS for dx in OFFSET_STEPS), key=lambda d: d[0] ** 2 + d[1] ** 2)
"""Where a name may go, from the middle of the part outwards, in diameters of the circle that fits into it."""


def label(name: str, shape: PartPath, place: Place, largest: float, marks: shapely.STRtree) -> str:
    """Text element with the part's name, or nothing where it does not fit; see `name_position`."""
    found = name_position(name, shape, place, largest, marks)
    return text_at(name, *found) if found else ""


def name_position(
    name: str, shape: PartPath, place: Place, largest: float, marks: shapely.STRtree
) -> tuple[Floats, float] | None:
    """Middle (2,) [px] and font size of a part's name, or None where it does not fit.

    Parameters
    ----------
    place : (x, y, angle) [px, px, deg]
        Where the shape lies in the picture.
    largest : float [px]
        Font size that is never exceeded, see `common_font_size`.
    marks : tree of areas [px]
        What the name must not cover.
    """
    wide = text_width(name, 1.0)
    size = min(fitting_font_size(name, shape), largest)
    if size < _SMALLEST:
        return None
    middle, radius = shape.circle
    x, y, turn = place
    moved = affinity.translate(affinity.rotate(shape.polygon, turn, origin=(0, 0)), x, y)
    centre = shapely.get_coordinates(
        affinity.translate(affinity.rotate(shapely.Point(middle), turn, origin=(0, 0)), x, y)
    )[0]
    shapely.prepare(moved)
    for smaller in (size, max(0.75 * size, _SMALLEST)):
        half = np.array([wide * smaller / 2 + 0.25 * smaller, smaller / 2 + 1])
        for step in _PLACES:
            at = centre + 2 * radius * np.array(step)
            box = shapely.box(*(at - half), *(at + half))
            if not len(marks.query(box, predicate="intersects")) and moved.contains(box):
                return at, smaller
    return None


def text_at(name: str, middle: Floats, size: float) -> str:
    """Text element with its middle at a place (2,) [px]."""
    return f'<text x="{middle[0]:.2f}" y="{middle[1] + 0.36 * size:.2f}" font-size="{size:.2f}">{escape(name)}</text>'


def fitting_font_size(name: str, shape: PartPath) -> float:
    """Font size [px] at which a name fits into the largest circle inside a shape."""
    wide = text_width(name, 1.0)
    # no part holds a circle larger than its area says
    most = _size(math.sqrt(shape.polygon.area / math.pi), wide)
    return most if most < _SMALLEST else _size(shape.circle[1], wide)


def common_font_size(named: Sequence[tuple[str, PartPath]], room: float) -> float:
    """One font size for all names in a picture whose usual part is `room` pixels large.

    Most names fit in this size; those that do not are written smaller, or left out.
    """
    sizes = sorted(fitting_font_size(name, shape) for name, shape in named[:MAX_MEASURED])
    return min(0.23 * room, _LARGEST, max(sizes[len(sizes) // 5], _SMALLEST) if sizes else _LARGEST)


def names_group(
    named: Sequence[tuple[str, PartPath, Place]], first: set[str], room: float, marks: shapely.STRtree
) -> str:
    """All names of a picture; where the parts are small, those that are not among the `first` ones stand back.

    Parameters
    ----------
    named : sequence of (name, shape, place)
    first : set of names
    room : float [px]
        Size of a usual part.
    marks : tree of areas [px]
        What names must not cover.
    """
    size = common_font_size([(short(name), shape) for name, shape, _ in named], room)
    found: dict[str, list[str]] = {palette.SUBDUED: [], palette.INK: []}
    for name, shape, place in named:
        quiet = size < MIN_NAME_SIZE and name not in first
        found[palette.SUBDUED if quiet else palette.INK].append(label(short(name), shape, place, size, marks))
    return "".join(
        f'<g fill="{colour}" text-anchor="middle">{"".join(texts)}</g>' for colour, texts in found.items() if any(texts)
    )


def _size(radius: float, wide: float) -> float:
    """Font size at which a text `wide` ems long fits into a circle."""
    return 1.75 * radius / math.hypot(wide, 1.1)
