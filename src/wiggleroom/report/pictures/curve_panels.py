"""Panels of curves and of rows of dots, even or logarithmic, to compare several methods in one picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.report.pictures import palette
from wiggleroom.report.pictures.axes import line, span, text, ticks
from wiggleroom.report.pictures.text import elide, text_width
from wiggleroom.report.results.answer_words import number

Floats = NDArray[np.float64]

MARKS = ("circle", "square", "triangle", "diamond", "cross")
MARKER_SIZE = 5.0
"""Half the width of a marker [px]."""
LEGEND_SPACING = 30.0
"""Between two entries of the legend [px]."""


@dataclass(frozen=True)
class Style:
    """How one method looks.

    Parameters
    ----------
    colour : str
    mark : str
        One of `MARKS`.
    hollow : bool
        True for figures that are not measured here; their lines are dashed.
    """

    colour: str
    mark: str = "circle"
    hollow: bool = False


@dataclass(frozen=True, eq=False)
class Curve:
    """Points (k,) joined by a line; those that are not finite are left out."""

    name: str
    x: Floats
    y: Floats
    style: Style


@dataclass(frozen=True, eq=False)
class Panel:
    """Field between axes.

    Parameters
    ----------
    left, top, wide, high : float [px]
    x, y : (low, high)
        What the axes span.
    log : (bool, bool)
        Which axes are logarithmic.
    """

    left: float
    top: float
    wide: float
    high: float
    x: tuple[float, float]
    y: tuple[float, float]
    log: tuple[bool, bool] = (False, False)

    def pixels(self, x: Floats, y: Floats) -> Floats:
        """Points (k, 2) [px] of values."""
        return np.column_stack(
            [
                self.left + _share(x, self.x, self.log[0]) * self.wide,
                self.top + (1 - _share(y, self.y, self.log[1])) * self.high,
            ]
        )

    def axes(self, title: str, labels: tuple[str, str], rows: Sequence[str] = ()) -> list[str]:
        """Grid lines, numbers and labels; with `rows`, the y axis counts these names from the top."""
        bottom = self.top + self.high
        found = [text(self.left, self.top - 30, palette.TEXT_SIZE + 1, palette.INK, title)] if title else []
        found.append(text(self.left, self.top - 10, palette.SMALL_SIZE + 1, palette.SUBDUED, labels[1]))
        for t in _marks(self.x, self.log[0]):
            u = float(self.pixels(np.array([t]), np.array([self.y[1]]))[0, 0])
            found.append(line(u, self.top, u, bottom, palette.GRID))
            found.append(text(u, bottom + 20, palette.SMALL_SIZE + 1, palette.SUBDUED, number(t), "middle"))
        for k, name in enumerate(rows):
            v = float(self.pixels(np.array([self.x[1]]), np.array([k]))[0, 1])
            found.append(line(self.left, v, self.left + self.wide, v, palette.GRID))
            found.append(
                text(self.left - 12, v + 5, palette.TEXT_SIZE, palette.INK, elide(name, palette.TEXT_SIZE, 190), "end")
            )
        for t in () if rows else _marks(self.y, self.log[1]):
            v = float(self.pixels(np.array([self.x[1]]), np.array([t]))[0, 1])
            found.append(line(self.left, v, self.left + self.wide, v, palette.GRID))
            found.append(text(self.left - 8, v + 4, palette.SMALL_SIZE + 1, palette.SUBDUED, number(t), "end"))
        found.append(line(self.left, bottom, self.left + self.wide, bottom, palette.SUBDUED))
        found.append(text(self.left + self.wide, bottom + 40, palette.SMALL_SIZE + 1, palette.INK, labels[0], "end"))
        return found

    def curve(self, one: Curve) -> list[str]:
        """Line and marks of a curve."""
        there = np.isfinite(one.x) & np.isfinite(one.y)
        at = self.pixels(one.x[there], one.y[there])
        path = "".join(f"{'L' if k else 'M'}{u:.2f},{v:.2f}" for k, (u, v) in enumerate(at.tolist()))
        dashes = ' stroke-dasharray="6 4"' if one.style.hollow else ""
        found = (
            [f'<path d="{path}" fill="none" stroke="{one.style.colour}" stroke-width="2"{dashes}/>']
            if len(at) > 1
            else []
        )
        return found + [mark(u, v, one.style) for u, v in at.tolist()]


def around(
    left: float, top: float, wide: float, high: float, curves: Sequence[Curve], log: tuple[bool, bool] = (False, False)
) -> Panel:
    """Panel that holds all curves; even axes of y begin at 0."""
    x, y = (np.concatenate([getattr(c, axis) for c in curves]) for axis in "xy")
    return Panel(left, top, wide, high, _reach(x, log[0]), _reach(y, log[1], zero=True), log)


def mark(u: float, v: float, style: Style) -> str:
    """One mark at a place [px]."""
    fill = palette.PAPER if style.hollow else style.colour
    s = MARKER_SIZE
    path = {
        "square": f"M{-s:g},{-s:g}h{2 * s:g}v{2 * s:g}h{-2 * s:g}z",
        "triangle": f"M0,{-s - 1:g}l{s + 1:g},{2 * s:g}h{-2 * s - 2:g}z",
        "diamond": f"M0,{-s - 2:g}l{s + 2:g},{s + 2:g}l{-s - 2:g},{s + 2:g}l{-s - 2:g},{-s - 2:g}z",
        "cross": f"M{-s:g},{-s:g}l{2 * s:g},{2 * s:g}m0,{-2 * s:g}l{-2 * s:g},{2 * s:g}",
        "circle": f"M{-s:g},0a{s:g},{s:g} 0 1 0 {2 * s:g},0a{s:g},{s:g} 0 1 0 {-2 * s:g},0z",
    }[style.mark]
    where = f'transform="translate({u:.2f} {v:.2f})"'
    return f'<path class="mark" {where} d="{path}" fill="{fill}" stroke="{style.colour}" stroke-width="1.8"/>'


def legend(entries: Sequence[tuple[str, Style]], left: float, top: float, room: float) -> tuple[list[str], float]:
    """Marks with their names in as many lines as they need, and where they end [px]."""
    x, y, found = left, top, []
    for name, style in entries:
        long = 16 + text_width(name, palette.TEXT_SIZE) + LEGEND_SPACING
        if x > left and x + long - LEGEND_SPACING > left + room:
            x, y = left, y + 24
        found.append(mark(x + 5, y - 5, style) + text(x + 18, y, palette.TEXT_SIZE, palette.INK, name))
        x += long
    return found, y


def _share(values: Floats, ends: tuple[float, float], log: bool) -> Floats:
    v, (low, high) = np.asarray(values, dtype=float), ends
    if log:
        with np.errstate(divide="ignore"):
            return np.log(v / low) / math.log(high / low)
    return (v - low) / (high - low)


def _reach(values: Floats, log: bool, *, zero: bool = False) -> tuple[float, float]:
    """Ends of an axis for some values."""
    if not log:
        return span(values, zero=zero)
    some = values[np.isfinite(values) & (values > 0)]
    low, high = (float(some.min()), float(some.max())) if len(some) else (1.0, 10.0)
    return low / 1.6, high * 1.6


def _marks(ends: tuple[float, float], log: bool) -> list[float]:
    """Round numbers for an axis."""
    if not log:
        found: list[float] = ticks(*ends).tolist()
        return found
    steps = (1, 2, 5) if math.log10(ends[1] / ends[0]) < 2 else (1,)
    powers = range(math.floor(math.log10(ends[0])), math.ceil(math.log10(ends[1])) + 1)
    return [s * 10.0**p for p in powers for s in steps if ends[0] <= s * 10.0**p <= ends[1]]
