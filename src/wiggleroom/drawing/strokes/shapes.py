"""Basic shapes of SVG as subpaths."""

from __future__ import annotations

import math
from collections.abc import Mapping

from wiggleroom.drawing.strokes.pathdata import Arc, Pen, Subpath, parse_numbers, parse_path
from wiggleroom.drawing.strokes.transforms import Box, parse_length

SHAPES = ("path", "rect", "circle", "ellipse", "line", "polyline", "polygon")


def subpaths_of(tag: str, attributes: Mapping[str, str], port: Box) -> list[Subpath]:
    """Subpaths of one shape in its own user units.

    Parameters
    ----------
    tag : str
        One of `SHAPES`.
    attributes : mapping
        Attributes as written.
    port : Box
        Viewport that percentages refer to.

    Raises
    ------
    ValueError
        With a plain reason, where an attribute cannot be read.

    Examples
    --------
    >>> subpaths_of("polygon", {"points": "0,0 2,0 2,1"}, Box(0, 0, 1, 1))[0].closed
    True
    """
    if tag == "path":
        data = attributes.get("d", "").strip()
        return [] if data == "none" else parse_path(data)
    if tag in ("polyline", "polygon"):
        numbers = parse_numbers(attributes.get("points", ""), 'attribute "points"', 2)
        return _polygon([complex(x, y) for x, y in zip(numbers[::2], numbers[1::2], strict=True)], tag == "polygon")
    size = _Lengths(attributes, port)
    if tag == "line":
        return _polygon([complex(size["x1"], size["y1"]), complex(size["x2"], size["y2"])], False)
    if tag == "rect":
        return _rectangle(size["x"], size["y"], size["width"], size["height"], *size.radii())
    rx, ry = (size["r"], size["r"]) if tag == "circle" else size.radii()
    return _ellipse(complex(size["cx"], size["cy"]), rx, ry)


class _Lengths:
    """Attributes of one shape as lengths in user units; what is missing is 0."""

    def __init__(self, attributes: Mapping[str, str], port: Box) -> None:
        self._attributes = attributes
        self._wholes = dict.fromkeys(("x", "width", "cx", "rx", "x1", "x2"), port.width)
        self._wholes["r"] = math.hypot(port.width, port.height) / math.sqrt(2)
        self._rest = port.height

    def __getitem__(self, key: str) -> float:
        try:
            return parse_length(self._attributes.get(key, "0"), self._wholes.get(key, self._rest))
        except ValueError as error:
            message = f'attribute "{key}": {error}'
            raise ValueError(message) from None

    def radii(self) -> tuple[float, float]:
        """Radii rx, ry, of which one that is not given follows the other."""
        given = [self[key] for key in ("rx", "ry") if self._attributes.get(key, "auto").strip() != "auto"]
        return (given[0], given[-1]) if given else (0.0, 0.0)


def _polygon(points: list[complex], closed: bool) -> list[Subpath]:
    pen = Pen()
    if points:
        pen.move(points[0])
        for point in points[1:]:
            pen.line(point)
        if closed:
            pen.close()
    return pen.finish()


def _rectangle(x: float, y: float, width: float, height: float, rx: float, ry: float) -> list[Subpath]:
    if min(width, height, rx, ry) < 0:
        raise ValueError("width, height, rx and ry must not be negative")
    if width == 0 or height == 0:
        return []  # as SVG says
    rx, ry = min(rx, width / 2), min(ry, height / 2)
    if rx == 0 or ry == 0:
        rx = ry = 0.0
    pen = Pen()
    pen.move(complex(x + rx, y))
    right, bottom = x + width, y + height
    sides = (
        (complex(right - rx, y), complex(right, y + ry)),
        (complex(right, bottom - ry), complex(right - rx, bottom)),
        (complex(x + rx, bottom), complex(x, bottom - ry)),
        (complex(x, y + ry), complex(x + rx, y)),
    )
    for side, corner in sides:
        pen.line(side)
        if rx:
            pen.arc(rx, ry, 0.0, False, True, corner)
    pen.close()
    return pen.finish()


def _ellipse(centre: complex, rx: float, ry: float) -> list[Subpath]:
    if min(rx, ry) < 0:
        raise ValueError("a radius must not be negative")
    if rx == 0 or ry == 0:
        return []  # as SVG says
    start = centre + rx
    return [Subpath(start, [Arc(centre, complex(rx), 1j * ry, 0.0, 2 * math.pi, False, start)], True)]
