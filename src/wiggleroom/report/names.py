"""Names inside the parts, as large as they fit, where nothing else is drawn."""

from __future__ import annotations

import math

import numpy as np
import shapely
from shapely import affinity

from wiggleroom.report import palette
from wiggleroom.report.shapes import Shape
from wiggleroom.report.text import escape, width

_SMALLEST, _LARGEST = 7.0, 15.0
_STEPS = (0.0, 0.3, -0.3, 0.6, -0.6)
_PLACES = sorted(((dx, dy) for dy in _STEPS for dx in _STEPS), key=lambda d: d[0] ** 2 + d[1] ** 2)
"""Where a name may go, from the middle of the part outwards, in diameters of the circle that fits into it."""


def label(name: str, shape: Shape, place: tuple[float, float, float], largest: float, marks: shapely.STRtree) -> str:
    """Text element with the part's name, or nothing where it does not fit.

    Parameters
    ----------
    place : (x, y, angle) [px, px, deg]
        Where the shape lies in the picture.
    largest : float [px]
        Font size that is never exceeded, see `usual`.
    marks : tree of lines [px]
        What the name must not cover.
    """
    wide = width(name, 1.0)
    # the circle round a text box must fit into the part: no part holds a circle larger than its area says
    if min(_size(math.sqrt(shape.polygon.area / math.pi), wide), largest) < _SMALLEST:
        return ""
    line = shapely.get_coordinates(shapely.maximum_inscribed_circle(shape.polygon, tolerance=0.5))
    radius = float(np.hypot(*(line[1] - line[0])))
    size = min(_size(radius, wide), largest)
    if size < _SMALLEST:
        return ""
    x, y, turn = place
    moved = affinity.translate(affinity.rotate(shape.polygon, turn, origin=(0, 0)), x, y)
    centre = shapely.get_coordinates(
        affinity.translate(affinity.rotate(shapely.Point(line[0]), turn, origin=(0, 0)), x, y)
    )[0]
    for smaller in (size, max(0.75 * size, _SMALLEST)):
        half = np.array([wide * smaller / 2 + 2, smaller / 2 + 1])
        for step in _PLACES:
            middle = centre + 2 * radius * np.array(step)
            box = shapely.box(*(middle - half), *(middle + half))
            if not len(marks.query(box, predicate="intersects")) and moved.contains(box):
                at = f'x="{middle[0]:.2f}" y="{middle[1] + 0.36 * smaller:.2f}" font-size="{smaller:.2f}"'
                return f"<text {at}>{escape(name)}</text>"
    return ""


def usual(room: float) -> float:
    """Largest font size in a picture whose usual part is `room` pixels large, so that names look alike."""
    return min(0.23 * room, _LARGEST)


def names_group(labels: list[str]) -> str:
    """All names of a picture in one group."""
    found = "".join(labels)
    return f'<g fill="{palette.INK}" text-anchor="middle">{found}</g>' if found else ""


def _size(radius: float, wide: float) -> float:
    """Font size at which a text `wide` ems long fits into a circle."""
    return 1.75 * radius / math.hypot(wide, 1.1)
