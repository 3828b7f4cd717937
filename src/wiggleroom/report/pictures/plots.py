"""Plots of numbers as SVG: a curve, a histogram, bars. Values in, text out; `write_still` makes files of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import InputError
from wiggleroom.report.finding import Bars, Curve, Histogram, Mark
from wiggleroom.report.pictures import frame, palette
from wiggleroom.report.pictures.axes import (
    HEIGHT,
    LABEL_ROW,
    PANEL_SIZE,
    WIDTH,
    Axes,
    horizontal_line,
    plot,
    span,
    svg_document,
    text,
    vertical_lines,
)
from wiggleroom.report.pictures.text import elide, wrap
from wiggleroom.report.results.answer_words import number

Floats = NDArray[np.float64]

_BAR, _BETWEEN = 20.0, 8.0
"""Height of a bar, and space between two [px]."""
MAX_BARS = 25
"""Bars that are drawn."""
NAME_WIDTH = 220.0
"""Room for the names of bars [px]."""


@dataclass(frozen=True)
class Heading:
    """What is said above and below a plot.

    Parameters
    ----------
    title : str
    facts : sequence of str
        Lines under it.
    command : str
        What made the plot.
    framed : bool
        False: a small plot, for a panel of a page that says them itself.
    """

    title: str
    facts: Sequence[str] = ()
    command: str = ""
    framed: bool = True


def _size(heading: Heading) -> tuple[float, float]:
    """Width and height of a plot [px]."""
    return (WIDTH, HEIGHT) if heading.framed else PANEL_SIZE


def _plot(
    ranges: tuple[tuple[float, float], tuple[float, float]], labels: tuple[str, str], heading: Heading
) -> tuple[Axes, list[str]]:
    """Axes of a plot under its heading."""
    head, below = (heading.title, heading.facts) if heading.framed else ("", [])
    return plot(*ranges, labels, head, below, _size(heading))


def _drawn(axes: Axes, body: list[str], heading: Heading) -> str:
    return svg_document(axes, body, heading.title, heading.facts, heading.command if heading.framed else "")


def curve(figure: Curve, heading: Heading) -> str:
    """Curve as SVG; it is broken where y is not finite.

    Upper bounds of a curve that never falls make a band: between two points it lies above the lower one and below the bound of the higher.

    Examples
    --------
    >>> import numpy as np
    >>> svg = curve(Curve(np.array([0.1, 0.2]), np.array([1.0, 2.1]), ("gap mm", "motion mm")), Heading("b2 in +y"))
    >>> svg.count("<circle")
    2
    """
    x, y = _values(figure.x, figure.y)
    marks, level, most = figure.marks, figure.level, figure.most
    shown = [x[np.isfinite(x)], np.array([m[0] for m in marks])]
    top = np.full(len(y), np.nan) if most is None else np.asarray(most, dtype=float).ravel()
    heights = np.concatenate([y, top[np.isfinite(top) & np.isfinite(y)], [] if level is None else [level[0]]])
    axes, body = _plot((span(np.concatenate(shown)), span(heights, zero=True)), figure.labels, heading)
    body += horizontal_line(axes, level, palette.FIXED[1]) if level else []
    at, there = axes.pixels(x, np.where(np.isfinite(y), y, 0.0)), np.isfinite(x) & np.isfinite(y)
    colour = palette.PULLED[1]
    body += _band(axes, x, y, top)
    line = "".join(
        f"{'L' if k and there[k - 1] else 'M'}{u:.2f},{v:.2f}" for k, (u, v) in enumerate(at.tolist()) if there[k]
    )
    body.append(f'<path d="{line}" fill="none" stroke="{colour}" stroke-width="2.5" stroke-linejoin="round"/>')
    radius = 3.5 if there.sum() <= 60 else 1.5
    body += [f'<circle cx="{u:.2f}" cy="{v:.2f}" r="{radius}" fill="{colour}"/>' for u, v in at[there].tolist()]
    body += vertical_lines(axes, marks, [palette.FORCE] * len(marks))
    return _drawn(axes, body, heading)


def _band(axes: Axes, x: Floats, y: Floats, top: Floats) -> list[str]:
    """What a curve that never falls may be: a step between every two points, a bar at each."""
    known = np.isfinite(x) & np.isfinite(y) & np.isfinite(top)
    out = []
    for k in np.flatnonzero(known[:-1] & known[1:]).tolist():
        (left, foot), (right, head) = axes.pixels(x[[k, k + 1]], np.array([y[k], top[k + 1]])).tolist()
        box = f'x="{left:.2f}" y="{head:.2f}" width="{right - left:.2f}" height="{foot - head:.2f}"'
        out.append(f'<rect class="band" {box} fill="{palette.PULLED[0]}" fill-opacity="0.45"/>')
    for k in np.flatnonzero(known).tolist():
        (at, foot), (_, head) = axes.pixels(x[[k, k]], np.array([y[k], top[k]])).tolist()
        line = f"M{at:.2f},{foot:.2f}V{head:.2f}M{at - 4:.2f},{head:.2f}h8"
        out.append(f'<path class="bound" d="{line}" fill="none" stroke="{palette.PULLED[1]}" stroke-width="1.2"/>')
    return out


def histogram(figure: Histogram, heading: Heading) -> str:
    """Histogram as SVG; what lies above the limit is red, and values that are not finite are counted in words."""
    values, marks, limit = np.asarray(figure.values, dtype=float).ravel(), figure.marks, figure.limit
    some = values[np.isfinite(values)]
    if len(some) < len(values):
        heading = replace(heading, facts=[*heading.facts, f"{len(values) - len(some)} without limit, not drawn"])
    lines = sorted([(m, palette.SUBDUED) for m in marks] + ([(limit, palette.FIXED[1])] if limit else []))
    count, edges = np.histogram(some, _bins(some, limit))
    wide = span(np.concatenate([some, edges if len(some) else [], [m[0] for m, _ in lines]]))
    least, most = span(count.astype(float), zero=True)
    most /= 1 - min(
        (LABEL_ROW * len(lines) + 6) / _size(heading)[1], 0.5
    )  # labels of the lines have room above the bars
    axes, body = _plot((wide, (least, most)), (figure.label, "how many"), heading)
    for n, low, high in zip(count.tolist(), edges[:-1], edges[1:], strict=True):
        if n:
            fill, stroke = palette.FIXED if limit and low >= limit[0] else palette.PULLED
            (x0, y0), (x1, y1) = axes.pixels(np.array([low, high]), np.array([n, 0.0])).tolist()
            body.append(
                f'<rect x="{x0:.2f}" y="{y0:.2f}" width="{max(x1 - x0, 0.5):.2f}" height="{y1 - y0:.2f}" '
                f'fill="{fill}" stroke="{stroke}"/>'
            )
    body += vertical_lines(axes, [m for m, _ in lines], [colour for _, colour in lines])
    return _drawn(axes, body, heading)


def _bins(some: Floats, limit: Mark | None) -> Floats:
    """Edges of the bins; a limit among the values is one of them, so that no bin holds both good and bad."""
    many = int(np.clip(2 * len(some) ** (1 / 3), 5, 60))  # the rule of Rice
    low, high = (float(some.min()), float(some.max())) if len(some) else (0.0, 1.0)
    if high - low <= 1e-12 * max(abs(low), abs(high)):
        middle, half = (low + high) / 2, (abs(high) or 1.0) / 20
        return np.linspace(middle - half, middle + half, many + 1)
    if limit is None or not low < limit[0] < high:
        return np.linspace(low, high, many + 1)
    step = (high - low) / many
    below, above = (int(np.ceil(d / step - 1e-9)) for d in (limit[0] - low, high - limit[0]))
    return np.linspace(limit[0] - below * step, limit[0] + above * step, below + above + 1)


def bars(figure: Bars, heading: Heading) -> str:
    """Bars as SVG, the longest first; a line says how many are left out."""
    names, values = figure.names, np.asarray(figure.values, dtype=float)
    if values.shape != (len(names),) or not np.isfinite(values).all():
        finding = f"bars: {len(names)} names need as many finite values, not {values.shape}"
        raise InputError(finding)
    order = np.argsort(-np.abs(values), kind="stable")[:MAX_BARS]
    body, y = frame.header(heading.title, heading.facts, WIDTH + 40) if heading.framed else ([], 0.0)
    low, high = min(float(values.min(initial=0.0)), 0.0), max(float(values.max(initial=0.0)), 0.0)
    scale = (WIDTH - NAME_WIDTH - 90) / ((high - low) or 1.0)
    zero = palette.MARGIN + NAME_WIDTH - low * scale
    y += 34
    body.append(text(palette.MARGIN + NAME_WIDTH, y, palette.TEXT_SIZE, palette.INK, figure.label))
    y += 14
    top = y
    for k in order.tolist():
        value, long = float(values[k]), abs(float(values[k])) * scale
        fill, stroke = palette.PULLED if value >= 0 else palette.FIXED
        left = zero if value >= 0 else zero - long
        name = elide(names[k], palette.TEXT_SIZE, NAME_WIDTH - 12)
        said = number(value)
        middle = y + _BAR / 2 + 5
        body.append(text(palette.MARGIN + NAME_WIDTH - 10, middle, palette.TEXT_SIZE, palette.INK, name, "end"))
        body.append(
            f'<rect x="{left:.2f}" y="{y:.2f}" width="{long:.2f}" height="{_BAR}" fill="{fill}" stroke="{stroke}"/>'
        )
        body.append(text(max(zero, left + long) + 8, middle, palette.TEXT_SIZE, palette.SUBDUED, said))
        y += _BAR + _BETWEEN
    body.append(f'<path d="M{zero:.2f},{top - 4:.2f}V{y - _BETWEEN + 4:.2f}" stroke="{palette.SUBDUED}"/>')
    if len(values) > len(order):
        y += 18
        body.append(
            text(palette.MARGIN, y, palette.TEXT_SIZE, palette.SUBDUED, f"and {len(values) - len(order)} smaller ones")
        )
    y += 14
    command = heading.command if heading.framed else ""
    for row in wrap(command.split(" "), " ", palette.SMALL_SIZE, WIDTH, 3) if command else []:
        y += palette.SMALL_SIZE + 4
        body.append(text(palette.MARGIN, y, palette.SMALL_SIZE, palette.SUBDUED, row))
    return frame.document(
        WIDTH + 2 * palette.MARGIN, y + palette.MARGIN - 12, heading.title, heading.facts, command, body
    )


def _values(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    if x.ndim != 1 or x.shape != y.shape or not len(x):
        finding = f"curve: x and y must be as many numbers, at least one, not {x.shape} and {y.shape}"
        raise InputError(finding)
    return x, y
