"""What stands round the drawing: title, facts, scale bar, legend and the command that made it."""

from __future__ import annotations

from collections.abc import Sequence

from wiggleroom.report.pictures import palette
from wiggleroom.report.pictures.layout import View, round_down
from wiggleroom.report.pictures.text import escape, text_width, wrap
from wiggleroom.report.results.answer_words import number

LegendEntry = tuple[str, str]
"""Swatch (SVG, in a box of 16 x 12 px with its upper left corner at 0, 0) and its meaning."""


def header(title: str, facts: Sequence[str], room: float) -> tuple[list[str], float]:
    """Title and facts as `text` elements, and the height they take [px]; without a title nothing but a margin."""
    if not title:
        return [], 0.0
    y, found = palette.MARGIN - 8, []
    for row in wrap(title.split(" "), " ", palette.TITLE_SIZE, room, 2):
        y += palette.TITLE_SIZE
        found.append(_text(palette.MARGIN, y, palette.TITLE_SIZE, palette.INK, row))
        y += 6
    y += 2
    for row in wrap(facts, "  ·  ", palette.TEXT_SIZE, room, 3):
        y += palette.TEXT_SIZE
        found.append(_text(palette.MARGIN, y, palette.TEXT_SIZE, palette.SUBDUED, row))
        y += 6
    return found, y


def footer(view: View, y: float, legend: Sequence[LegendEntry], command: str) -> tuple[list[str], float]:
    """Scale bar, legend and command as SVG from `y` downwards, and where they end [px]."""
    found = []
    x, wide, label = palette.MARGIN, 0.0, ""
    wide, label = _scale(view)
    found.append(
        f'<path d="M{x:.2f},{y - 5:.2f}v5h{wide:.2f}v-5" fill="none" stroke="{palette.INK}" stroke-width="1.5"/>'
        + _text(x + wide + 8, y + 1, palette.TEXT_SIZE, palette.INK, label)
    )
    x += wide + 8 + text_width(label, palette.TEXT_SIZE) + 36
    begin, end = x, view.canvas - palette.MARGIN
    for swatch, meaning in legend:
        long = 24 + text_width(meaning, palette.TEXT_SIZE)
        if x > begin and x + long > end:
            x, y = begin, y + 22
        found.append(f'<g transform="translate({x:.2f} {y - 11:.2f})">{swatch}</g>')
        found.append(_text(x + 24, y + 1, palette.TEXT_SIZE, palette.SUBDUED, meaning))
        x += long + 26
    y += 12
    if command:
        y += 12
        for row in wrap(command.split(" "), " ", palette.SMALL_SIZE, view.canvas - 2 * palette.MARGIN, 3):
            y += palette.SMALL_SIZE + 4
            found.append(_text(palette.MARGIN, y, palette.SMALL_SIZE, palette.SUBDUED, row))
    return found, y + palette.MARGIN - 12


def swatch(fill: str, stroke: str) -> str:
    """Small filled box for the legend."""
    return f'<rect x="0.5" y="0.5" width="15" height="11" rx="2" fill="{fill}" stroke="{stroke}"/>'


def document(width: float, height: float, title: str, said: Sequence[str], command: str, body: Sequence[str]) -> str:
    """Finished SVG file."""
    size = f'width="{width:.0f}" height="{height:.0f}" viewBox="0 0 {width:.0f} {height:.0f}"'
    made = f"<metadata>{escape(command)}</metadata>" if command else ""
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
        f'{size} font-family="{palette.FONT}" role="img">',
        f"<title>{escape(title)}</title>",
        f"<desc>{escape('; '.join(said) + (f'; made by: {command}' if command else ''))}</desc>",
        made,
        f'<rect width="{width:.0f}" height="{height:.0f}" fill="{palette.PAPER}"/>',
        *body,
        "</svg>",
    ]
    return "\n".join(line for line in lines if line) + "\n"


def _scale(view: View) -> tuple[float, str]:
    """Length [px] and label of a scale bar of a round length."""
    length = round_down(min(max(view.width / 5, 60.0), 180.0) / view.scale)
    return length * view.scale, f"{number(length)} mm"


def _text(x: float, y: float, size: float, colour: str, text: str) -> str:
    return f'<text x="{x:.2f}" y="{y:.2f}" font-size="{size:g}" fill="{colour}">{escape(text)}</text>'
