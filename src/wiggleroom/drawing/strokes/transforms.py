"""Affine maps of the plane, and the `transform`, `viewBox` and lengths of SVG."""

from __future__ import annotations

import math
import re
from typing import NamedTuple

from wiggleroom.drawing.strokes.pathdata import MAX_COORDINATE, NUMBER
from wiggleroom.drawing.units import UNITS

_FUNCTION = re.compile(r"([A-Za-z]+)\s*\(([^()]*)\)[\s,]*")
_VALUE = re.compile(rf"({NUMBER})(deg|px)?")
_LENGTH = re.compile(rf"^\s*({NUMBER})\s*([A-Za-z]+|%)?\s*$")
SVG_UNITS = {key: UNITS[key] for key in ("px", "mm", "cm", "in")} | {"pt": 25.4 / 72, "pc": 25.4 / 6, "q": 0.25}
"""Length of the units that SVG knows [mm]."""
FLAT = 1e-12
"""A matrix whose determinant is below this share of its largest factor squared leaves no area."""


class Affine(NamedTuple):
    """x' = a x + c y + e, y' = b x + d y + f."""

    a: float = 1.0
    b: float = 0.0
    c: float = 0.0
    d: float = 1.0
    e: float = 0.0
    f: float = 0.0

    def after(self, inner: Affine) -> Affine:
        """Compose with `inner`, which is applied first.

        Examples
        --------
        >>> Affine(e=5).after(Affine(2, 0, 0, 2, 1, 1))
        Affine(a=2.0, b=0.0, c=0.0, d=2.0, e=6.0, f=1.0)
        """
        a, b, c, d, e, f = self
        return Affine(
            a * inner.a + c * inner.b,
            b * inner.a + d * inner.b,
            a * inner.c + c * inner.d,
            b * inner.c + d * inner.d,
            a * inner.e + c * inner.f + e,
            b * inner.e + d * inner.f + f,
        )

    def inverse(self) -> Affine:
        """The map back.

        Examples
        --------
        >>> Affine(2.0, 0.0, 0.0, -2.0, 1.0, 6.0).inverse().point(3 + 4j)
        (1+1j)
        """
        size = self.a * self.d - self.b * self.c
        back = Affine(self.d / size, -self.b / size, -self.c / size, self.a / size)
        shift = back.vector(complex(self.e, self.f))
        return back._replace(e=-shift.real, f=-shift.imag)

    def vector(self, z: complex) -> complex:
        """Map a vector x + iy without the shift."""
        return complex(self.a * z.real + self.c * z.imag, self.b * z.real + self.d * z.imag)

    def point(self, z: complex) -> complex:
        """Map a point x + iy."""
        return complex(self.a * z.real + self.c * z.imag + self.e, self.b * z.real + self.d * z.imag + self.f)


def matrix_problem(matrix: Affine) -> str:
    """Why nothing can be drawn through a matrix of transforms, one after the other; empty where it can.

    Examples
    --------
    >>> matrix_problem(parse_transform("translate(3, 4) scale(0)"))
    "is scaled to a line or a point, its groups' transforms counted; a scale must not be 0"
    """
    a, b, c, d, *_ = matrix
    largest = max(map(abs, matrix))
    if not largest <= MAX_COORDINATE:
        return f"is moved or scaled by more than {MAX_COORDINATE:g}, its groups' transforms counted; move or scale the drawing"
    if abs(a * d - b * c) <= FLAT * max(map(abs, (a, b, c, d))) ** 2:
        return "is scaled to a line or a point, its groups' transforms counted; a scale must not be 0"
    return ""


def parse_transform(text: str) -> Affine:
    """Matrix of a `transform` attribute.

    Raises
    ------
    ValueError
        With a plain reason, where the text is not a list of transforms.

    Examples
    --------
    >>> parse_transform("translate(10) scale(2)")
    Affine(a=2.0, b=0.0, c=0.0, d=2.0, e=10.0, f=0.0)
    """
    result, at = Affine(), len(text) - len(text.lstrip())
    if text.strip() == "none":
        return result
    while at < len(text):
        match = _FUNCTION.match(text, at)
        if not match:
            message = f'transform cannot be read at "{text[at : at + 20]}"'
            raise ValueError(message)
        result = result.after(_one(match.group(1), match.group(2)))
        at = match.end()
    return result


def parse_origin(text: str, width: float, height: float) -> complex:
    """Point of a `transform-origin` in user units; percentages and words are of a viewport's width and height.

    Raises
    ------
    ValueError
        With a plain reason, where the text is no point.

    Examples
    --------
    >>> parse_origin("right 25%", 100.0, 80.0), parse_origin("top", 100.0, 80.0)
    ((100+20j), (50+0j))
    """
    sides = {"left": "0%", "top": "0%", "center": "50%", "right": "100%", "bottom": "100%"}
    words = text.replace(",", " ").lower().split()
    if not 1 <= len(words) <= 3:
        message = f'transform-origin "{text[:40]}" cannot be read; it takes two lengths'
        raise ValueError(message)
    x, y = (*words, "center")[:2]
    if x in ("top", "bottom") or y in ("left", "right"):
        x, y = y, x
    return complex(parse_length(sides.get(x, x), width), parse_length(sides.get(y, y), height))


def _one(name: str, text: str) -> Affine:
    values = [float(number) for number, _ in _VALUE.findall(text)]
    kind = name.lower()
    allowed = {"matrix": (6,), "translate": (1, 2), "scale": (1, 2), "rotate": (1, 3), "skewx": (1,), "skewy": (1,)}
    if kind not in allowed:
        message = f'transform "{name}" is not known; it must be matrix, translate, scale, rotate, skewX or skewY'
        raise ValueError(message)
    rest = _VALUE.sub("", text).replace(",", " ").strip()
    if rest or len(values) not in allowed[kind] or not all(map(math.isfinite, values)):
        count = " or ".join(map(str, allowed[kind]))
        message = f'transform "{name}({text.strip()[:40]})" cannot be read; it takes {count} finite numbers'
        raise ValueError(message)
    if kind == "matrix":
        return Affine(*values)
    if kind == "translate":
        return Affine(e=values[0], f=values[1] if len(values) > 1 else 0.0)
    if kind == "scale":
        return Affine(a=values[0], d=values[-1])
    if kind == "rotate":
        c, s = _cos_sin(values[0])
        x, y = values[1:] or (0.0, 0.0)
        return Affine(c, s, -s, c, x - c * x + s * y, y - s * x - c * y)
    slope = math.tan(math.radians(values[0]))
    return Affine(c=slope) if kind == "skewx" else Affine(b=slope)


def _cos_sin(degrees: float) -> tuple[float, float]:
    """Exact at quarter turns."""
    quarter, rest = divmod(degrees, 90.0)
    c, s = math.cos(math.radians(rest)), math.sin(math.radians(rest))
    return ((c, s), (-s, c), (-c, -s), (s, -c))[int(quarter) % 4]


def parse_length(text: str, whole: float) -> float:
    """Read a length in user units (CSS pixels); percentages are of `whole`.

    Raises
    ------
    ValueError
        With a plain reason, where the text is not a length.

    Examples
    --------
    >>> parse_length("1in", 100), parse_length("50%", 100)
    (96.0, 50.0)
    """
    match = _LENGTH.match(text)
    unit = (match.group(2) or "px").lower() if match else ""
    if match and unit == "%":
        return float(match.group(1)) / 100 * whole
    if not match or unit not in SVG_UNITS or not abs(float(match.group(1))) <= MAX_COORDINATE:
        message = f'"{text[:30]}" is not a length; it must be a number, with or without {", ".join(SVG_UNITS)} or %'
        raise ValueError(message)
    return float(match.group(1)) * (SVG_UNITS[unit] / SVG_UNITS["px"])


class Box(NamedTuple):
    """A viewBox or viewport in user units."""

    x: float
    y: float
    width: float
    height: float


def parse_view_box(text: str) -> Box:
    """Four numbers, the last two positive.

    Raises
    ------
    ValueError
        With a plain reason, where the text is anything else.

    Examples
    --------
    >>> parse_view_box("0 0 10 5")
    Box(x=0.0, y=0.0, width=10.0, height=5.0)
    """
    values = _four_numbers(text)
    if not values or min(values[2:]) <= 0:
        message = f'viewBox "{text[:40]}" cannot be read; it takes four numbers, the last two larger than 0'
        raise ValueError(message)
    return Box(*values)


def is_empty_view_box(text: str) -> bool:
    """Whether a viewBox has no width or no height."""
    values = _four_numbers(text)
    return bool(values) and min(values[2:]) == 0


def _four_numbers(text: str) -> list[float]:
    """The numbers of a viewBox; none where they are not four."""
    try:
        values = [float(item) for item in text.replace(",", " ").split()]
    except ValueError:
        return []
    return values if len(values) == 4 and all(map(math.isfinite, values)) else []


def fit(view: Box, port: Box, aspect: str) -> Affine:
    """Map of a viewBox into a viewport by `preserveAspectRatio`.

    Examples
    --------
    >>> fit(Box(0, 0, 10, 10), Box(0, 0, 40, 20), "")
    Affine(a=2.0, b=0.0, c=0.0, d=2.0, e=10.0, f=0.0)
    """
    x, y = port.width / view.width, port.height / view.height
    if not aspect.startswith("none"):
        x = y = max(x, y) if aspect.endswith("slice") else min(x, y)
    share_x = 0.0 if "xMin" in aspect or aspect.startswith("none") else 1.0 if "xMax" in aspect else 0.5
    share_y = 0.0 if "YMin" in aspect or aspect.startswith("none") else 1.0 if "YMax" in aspect else 0.5
    e = port.x - x * view.x + share_x * (port.width - x * view.width)
    f = port.y - y * view.y + share_y * (port.height - y * view.height)
    return Affine(x, 0.0, 0.0, y, e, f)
