"""SVG path data to subpaths of lines, cubics and arcs; strict, where browsers draw up to the first error."""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Callable
from typing import NamedTuple

_COMMAND = re.compile(r"([MmZzLlHhVvCcSsQqTtAa])([^MmZzLlHhVvCcSsQqTtAa]*+)")
NUMBER = r"[-+]?+(?:\d++\.?+\d*+|\.\d++)(?:[eE][-+]?+\d++)?+"
_NUMBER = re.compile(NUMBER)
_ARC = re.compile(r"[\s,]*+".join([f"({NUMBER})"] * 3 + ["([01])"] * 2 + [f"({NUMBER})"] * 2))
_ARGUMENTS = {"M": 2, "Z": 0, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7}
MAX_COORDINATE = 1e15
"""Numbers beyond this are no coordinates in any unit; below it squares and products stay finite."""
OPPOSITE_TOLERANCE = 1e-13
"""Ends this near to opposite each other (relative) are opposite: rounding would else move the centre by its root."""


class Line(NamedTuple):
    """Straight to `end`."""

    end: complex


class Cubic(NamedTuple):
    """Cubic Bézier to `end`."""

    first: complex
    second: complex
    end: complex


class Arc(NamedTuple):
    """Ellipse centre + u cos a + v sin a from angle `start` over `sweep` [rad]; travelled backwards if `flipped`."""

    centre: complex
    u: complex
    v: complex
    start: float
    sweep: float
    flipped: bool
    end: complex


Segment = Line | Cubic | Arc


class Subpath(NamedTuple):
    """One stroke of the pen; `closed` where the file says so."""

    start: complex
    segments: list[Segment]
    closed: bool


def parse_path(data: str) -> list[Subpath]:
    """Subpaths of the `d` of a path, in its own units; those without length are left out.

    Raises
    ------
    ValueError
        With a plain reason, where the text is not path data.

    Examples
    --------
    >>> parse_path("M0 0h2v1z")
    [Subpath(start=0j, segments=[Line(end=(2+0j)), Line(end=(2+1j))], closed=True)]
    """
    pen = Pen()
    at = len(data) - len(data.lstrip())
    for match in _COMMAND.finditer(data, at):
        if match.start() != at:
            break
        at = match.end()
        letter = match.group(1)
        kind = letter.upper()
        if pen.here is None and kind != "M":
            message = f'path data begins with "{letter}"; it must begin with M'
            raise ValueError(message)
        if kind == "Z":
            if match.group(2).strip(" \t\r\n,"):
                message = f'path data has "{match.group(2).strip()[:20]}" after "{letter}"; a command must follow'
                raise ValueError(message)
            pen.close()
            continue
        size = _ARGUMENTS[kind]
        numbers = parse_numbers(match.group(2), f'path data after "{letter}"', size)
        if not numbers:
            message = f'path data ends at "{letter}"; it takes {size} numbers at a time'
            raise ValueError(message)
        for i in range(0, len(numbers), size):
            pen.draw("L" if kind == "M" and i else kind, letter.islower(), numbers[i : i + size])
    if data[at:].strip():
        message = f'path data cannot be read at "{data[at : at + 20].strip()}"'
        raise ValueError(message)
    return pen.finish()


def parse_numbers(text: str, place: str, size: int) -> list[float]:
    """Read numbers separated by blanks or commas, a multiple of `size` many.

    Raises
    ------
    ValueError
        With a plain reason that names the `place`.

    Examples
    --------
    >>> parse_numbers("1,2 3-4", "points", 2)
    [1.0, 2.0, 3.0, -4.0]
    """
    if size == _ARGUMENTS["A"]:  # flags need no blank after them
        words = [word for group in _ARC.findall(text) for word in group]
        rest = _ARC.sub("", text)
    else:
        words, rest = _NUMBER.findall(text), _NUMBER.sub("", text)
    rest = rest.replace(",", " ").strip()
    if rest:
        message = f'{place} has "{rest[:20]}" where only numbers may stand'
        raise ValueError(message)
    if len(words) % size:
        message = f"{place} has {len(words)} numbers where {size} at a time are needed"
        raise ValueError(message)
    numbers = [float(word) for word in words]
    if any(abs(number) > MAX_COORDINATE for number in numbers):
        message = f"{place} has a number beyond {MAX_COORDINATE:g}; move or scale the drawing"
        raise ValueError(message)
    return numbers


class Pen:
    """Draws commands one after the other; also used for the basic shapes."""

    def __init__(self) -> None:
        self.here: complex | None = None
        self._home = 0j
        self._segments: list[Segment] = []
        self._done: list[Subpath] = []
        self._handle: tuple[str, complex] = ("", 0j)

    def draw(self, kind: str, relative: bool, numbers: list[float]) -> None:
        """One command with its numbers."""
        here = self.here or 0j
        base = here if relative else 0j
        if kind == "H":
            self.line(complex(numbers[0] + base.real, here.imag))
        elif kind == "V":
            self.line(complex(here.real, numbers[0] + base.imag))
        elif kind == "A":
            rx, ry, turn, large, sweep, x, y = numbers
            self.arc(rx, ry, math.radians(turn), bool(large), bool(sweep), complex(x, y) + base)
        else:
            points = [complex(x, y) + base for x, y in zip(numbers[::2], numbers[1::2], strict=True)]
            _STROKES[kind](self, *points)

    def move(self, to: complex) -> None:
        """Begin a new subpath."""
        self._end(closed=False)
        self.here = self._home = to

    def close(self) -> None:
        """Close the subpath; what follows begins at its start."""
        self._end(closed=True)
        self.here = self._home

    def line(self, end: complex) -> None:
        """Straight to `end`."""
        self._add(Line(end))

    def cubic(self, first: complex, second: complex, end: complex) -> None:
        """Cubic Bézier to `end`."""
        self._add(Cubic(first, second, end))
        self._handle = ("C", second)

    def smooth_cubic(self, second: complex, end: complex) -> None:
        """Cubic whose first handle mirrors the cubic before it."""
        self.cubic(self._mirrored("C"), second, end)

    def quad(self, control: complex, end: complex) -> None:
        """Quadratic Bézier, as the cubic that it is."""
        here = self.here or 0j
        self._add(Cubic(here + 2 / 3 * (control - here), end + 2 / 3 * (control - end), end))
        self._handle = ("Q", control)

    def smooth_quad(self, end: complex) -> None:
        """Quadratic whose handle mirrors the quadratic before it."""
        self.quad(self._mirrored("Q"), end)

    def arc(self, rx: float, ry: float, turn: float, large: bool, sweep: bool, end: complex) -> None:
        """Elliptic arc; straight where a radius vanishes, nothing where it ends where it starts, as SVG says."""
        here = self.here or 0j
        chord, least, most = abs(end - here), min(abs(rx), abs(ry)), max(abs(rx), abs(ry))
        if least <= max(1e-12 * most, 1e-15 * chord) or 0 < chord <= 1e-15 * least:
            self.line(end)
        elif chord:
            self._add(arc_between(here, end, abs(rx), abs(ry), turn, large, sweep))

    def finish(self) -> list[Subpath]:
        """All subpaths that were drawn."""
        self._end(closed=False)
        return self._done

    def _mirrored(self, kind: str) -> complex:
        here = self.here or 0j
        return 2 * here - self._handle[1] if self._handle[0] == kind else here

    def _add(self, segment: Segment) -> None:
        self._segments.append(segment)
        self.here = segment.end
        self._handle = ("", 0j)

    def _end(self, *, closed: bool) -> None:
        if self._segments:
            self._done.append(Subpath(self._home, self._segments, closed))
        self._segments = []
        self._handle = ("", 0j)


_STROKES: dict[str, Callable[..., None]] = {
    "M": Pen.move,
    "L": Pen.line,
    "C": Pen.cubic,
    "S": Pen.smooth_cubic,
    "Q": Pen.quad,
    "T": Pen.smooth_quad,
}


def arc_between(start: complex, end: complex, rx: float, ry: float, turn: float, large: bool, sweep: bool) -> Arc:
    """Arc of an ellipse with radii `rx`, `ry` turned by `turn` [rad], by the flags of SVG.

    The ends are put in order first, so that an arc and its reverse are the same ellipse to the last bit.

    Examples
    --------
    >>> arc = arc_between(-1 + 0j, 1 + 0j, 1, 1, 0.0, False, True)
    >>> arc.centre, round(arc.sweep, 12)
    (0j, 3.14159265359)
    """
    flipped = (end.real, end.imag) < (start.real, start.imag)
    a, b, positive = (end, start, not sweep) if flipped else (start, end, sweep)
    axis = cmath.rect(1.0, turn) if turn else 1 + 0j
    half = (a - b) / 2 * axis.conjugate()
    z = complex(half.real / rx, half.imag / ry)  # the start, where the ellipse is the unit circle, from the middle
    square = z.real**2 + z.imag**2
    if square > 1 - OPPOSITE_TOLERANCE:  # too small radii grow until the ends are opposite
        grow = math.sqrt(square)
        rx, ry, z, square = rx * grow, ry * grow, z / grow, 1.0
    centre = (-1j if large != positive else 1j) * z * math.sqrt(1 / square - 1)
    first, last = cmath.phase(z - centre), cmath.phase(-z - centre)
    angle = last - first
    if positive and angle < 0:
        angle += 2 * math.pi
    elif not positive and angle > 0:
        angle -= 2 * math.pi
    middle = (a + b) / 2 + axis * complex(centre.real * rx, centre.imag * ry)
    return Arc(middle, axis * rx, axis * 1j * ry, first, angle, flipped, end)
