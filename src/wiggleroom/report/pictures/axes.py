"""A plot's frame: axes with round numbers, in the look of the pictures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.report.pictures import frame, palette
from wiggleroom.report.pictures.text import escape, text_width, wrap
from wiggleroom.report.results.answer_words import number

Floats = NDArray[np.float64]

WIDTH, HEIGHT = 840.0, 440.0
"""Size of the field between the axes [px]."""
PANEL_SIZE = (350.0, 230.0)
"""The same in a panel of the page, where letters are to be read without being drawn smaller [px]."""
MAX_TICKS = 8
"""Of one axis."""
LABEL_ROW, LABEL_ROOM = 20.0, 7.0
"""Height of the label of an upright line, and space between the two [px]."""
TICK_WIDTH = 75.0
"""Room for a number under the field, at least [px]."""


@dataclass(frozen=True, eq=False)
class Axes:
    """Values to pixels.

    Parameters
    ----------
    x, y : (low, high)
        What the axes span.
    left, top : float [px]
        Upper left corner of the field.
    wide, tall : float [px]
        Its size.
    """

    x: tuple[float, float]
    y: tuple[float, float]
    left: float
    top: float
    wide: float = WIDTH
    tall: float = HEIGHT

    def pixels(self, x: Floats, y: Floats) -> Floats:
        """Points (k, 2) [px] of values."""
        u = (np.asarray(x, dtype=float) - self.x[0]) / (self.x[1] - self.x[0])
        v = (np.asarray(y, dtype=float) - self.y[0]) / (self.y[1] - self.y[0])
        return np.column_stack([self.left + u * self.wide, self.top + (1 - v) * self.tall])


def ticks(low: float, high: float, most: int = MAX_TICKS) -> Floats:
    """Round numbers between two values, at most so many steps; more where there would be one number alone, which tells no scale.

    >>> ticks(0.0, 1.3).round(3).tolist()
    [0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2]
    >>> ticks(8.55, 9.4, 3).round(3).tolist()
    [8.6, 8.8, 9.0, 9.2, 9.4]
    """
    power = 10.0 ** math.floor(math.log10((high - low) / most))
    sizes = (0.2, 0.5, 1, 2, 5, 10)
    k = next(k for k in range(2, 6) if (high - low) / (power * sizes[k]) <= most)
    for step in (power * sizes[k], power * sizes[k - 1], power * sizes[k - 2]):
        found = np.float64(step) * np.arange(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)
        if len(found) > 1:
            break
    return found


def span(values: Floats, *, zero: bool = False) -> tuple[float, float]:
    """Low and high end of an axis for some values; never empty, with a little room above.

    Parameters
    ----------
    zero : bool
        True: the axis holds 0.
    """
    some = values[np.isfinite(values)]
    low, high = (float(some.min()), float(some.max())) if len(some) else (0.0, 1.0)
    if zero:
        low, high = min(low, 0.0), max(high, 0.0)
    if high - low <= 1e-12 * max(abs(low), abs(high)):
        room = abs(high) or 1.0
        return (low - (0.0 if zero and low == 0 else 0.5 * room), high + 0.5 * room)
    room = 0.06 * (high - low)
    return (low if zero and low == 0 else low - room, high if zero and high == 0 else high + room)


def plot(
    x: tuple[float, float],
    y: tuple[float, float],
    labels: tuple[str, str],
    title: str,
    facts: Sequence[str],
    size: tuple[float, float] = (WIDTH, HEIGHT),
) -> tuple[Axes, list[str]]:
    """Axes and their SVG: title, facts, grid lines, numbers and labels.

    Parameters
    ----------
    labels : (along x, along y)
    size : (wide, tall) [px]
        Of the field between the axes.
    """
    wide, tall = size
    head, below = frame.header(title, facts, wide + 40)
    rows = ticks(*y)
    left = palette.MARGIN + max(text_width(number(t), palette.TEXT_SIZE) for t in rows) + 10
    axes = Axes(x, y, left, below + 46, wide, tall)
    bottom = axes.top + tall
    found = [*head, text(palette.MARGIN, axes.top - 18, palette.TEXT_SIZE, palette.INK, labels[1])]
    for t in rows:
        v = axes.pixels(np.array([x[0]]), np.array([t]))[0, 1]
        found.append(line(left, v, left + wide, v, palette.GRID))
        found.append(text(left - 8, v + 5, palette.TEXT_SIZE, palette.SUBDUED, number(t), "end"))
    for t in ticks(*x, min(MAX_TICKS, int(wide / TICK_WIDTH))):
        u = axes.pixels(np.array([t]), np.array([y[0]]))[0, 0]
        found.append(line(u, bottom, u, bottom + 5, palette.SUBDUED))
        found.append(text(u, bottom + 22, palette.TEXT_SIZE, palette.SUBDUED, number(t), "middle"))
    found.append(line(left, bottom, left + wide, bottom, palette.SUBDUED))
    found.append(text(left + wide, bottom + 46, palette.TEXT_SIZE, palette.INK, labels[0], "end"))
    return axes, found


def vertical_lines(axes: Axes, marks: Sequence[tuple[float, str]], colours: Sequence[str]) -> list[str]:
    """Upright lines at some values of x with their labels, each label in a row of its own, at which its line begins."""
    shown = [
        (value, label, c) for (value, label), c in zip(marks, colours, strict=True) if axes.x[0] <= value <= axes.x[1]
    ]
    at = axes.pixels(np.array([value for value, _, _ in shown]), np.full(len(shown), axes.y[0]))[:, 0]
    widths = np.array([text_width(label, palette.TEXT_SIZE) for _, label, _ in shown])
    starts, rows = _label_places(at, widths, axes.left, axes.left + axes.wide)
    lines, labels = [], []
    for (_, label, colour), x, start, wide, row in zip(shown, at, starts, widths, rows, strict=True):
        below = LABEL_ROW * (row + (start < x < start + wide))
        lines.append(
            f'<path d="M{x:.2f},{axes.top + below:.2f}v{axes.tall - below:.2f}" stroke="{colour}" stroke-width="1.5" '
            'stroke-dasharray="5 4" fill="none"/>'
        )
        said = text(start, axes.top + LABEL_ROW * row + 14, palette.TEXT_SIZE, palette.INK, label)
        # a rim of paper round the letters, so that lines and bars behind them do not disturb
        labels.append(f'<g paint-order="stroke" stroke="{palette.PAPER}" stroke-width="5">{said}</g>')
    return lines + labels


def _label_places(at: Floats, widths: Floats, low: float, high: float) -> tuple[Floats, NDArray[np.int64]]:
    """Where each label begins [px], and its row: beside its line or over it, between the lines that go by.

    A line begins at its label, so a label has to be clear of the lines of higher rows alone. The lowest row gets the label that
    has most to spare between its neighbours, and so on upwards.
    """
    starts, rows = np.empty(len(at)), np.empty(len(at), dtype=np.int64)
    left = np.argsort(at, kind="stable").tolist()
    for row in reversed(range(len(at))):
        walls = np.array([low, *at[left], high])
        spare = walls[2:] - walls[:-2] - widths[left]
        place = int(np.argmax(spare))
        k = left.pop(place)
        first, last = walls[place] + LABEL_ROOM, walls[place + 2] - LABEL_ROOM - widths[k]
        beside = [at[k] + LABEL_ROOM, at[k] - LABEL_ROOM - widths[k]]
        fits = [x for x in beside if first <= x <= last]
        starts[k] = fits[0] if fits else max(min(at[k] - widths[k] / 2, last), min(first, last))
        rows[k] = row
    return starts, rows


def horizontal_line(axes: Axes, mark: tuple[float, str], colour: str) -> list[str]:
    """Line across at a value of y, with its label at the left end."""
    value, label = mark
    y = float(axes.pixels(np.array([axes.x[0]]), np.array([value]))[0, 1])
    return [
        f'<path d="M{axes.left:.2f},{y:.2f}h{axes.wide:.2f}" stroke="{colour}" stroke-width="1.5" stroke-dasharray="2 4"/>',
        text(axes.left + 6, y - 6, palette.TEXT_SIZE, colour, label),
    ]


def svg_document(axes: Axes, body: list[str], title: str, facts: Sequence[str], command: str) -> str:
    """Whole SVG document of a plot."""
    wide = axes.left + axes.wide + palette.MARGIN
    y = axes.top + axes.tall + 60
    for row in wrap(command.split(" "), " ", palette.SMALL_SIZE, axes.wide, 3) if command else []:
        y += palette.SMALL_SIZE + 4
        body.append(text(palette.MARGIN, y, palette.SMALL_SIZE, palette.SUBDUED, row))
    return frame.document(wide, y + palette.MARGIN - 12, title, facts, command, body)


def text(x: float, y: float, size: float, colour: str, said: str, anchor: str = "start") -> str:
    """Text element."""
    side = "" if anchor == "start" else f' text-anchor="{anchor}"'
    return f'<text x="{x:.2f}" y="{y:.2f}" font-size="{size:g}" fill="{colour}"{side}>{escape(said)}</text>'


def line(x0: float, y0: float, x1: float, y1: float, colour: str) -> str:
    """Straight line."""
    return f'<path d="M{x0:.2f},{y0:.2f}L{x1:.2f},{y1:.2f}" stroke="{colour}" fill="none"/>'
