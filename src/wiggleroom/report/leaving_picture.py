"""Who leaves, at a glance: all parts at rest, with a number in the order of leaving and an arrow on each that leaves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from wiggleroom.assembly.assembly import Assembly, place
from wiggleroom.drawing.model import Pull
from wiggleroom.report import frame, layout, palette
from wiggleroom.report.arrows import Mark, goal_mark, numbered
from wiggleroom.report.picture import PartColours, drawn_parts

_GAP = 30.0
_DISC = (
    f'<circle cx="8" cy="6" r="6.5" fill="{palette.PAPER}" stroke="{palette.MOTION}" stroke-width="1.4"/>'
    f'<text x="8" y="9.5" text-anchor="middle" font-size="9" fill="{palette.INK}">1</text>'
)
_ARROW = (
    f'<path d="M0,6h9" stroke="{palette.MOTION}" stroke-width="3"/><path d="M16,6l-8,-4.5v9z" fill="{palette.MOTION}"/>'
)


@dataclass(frozen=True)
class Leaving:
    """Parts that leave together, and the directions of their last straight pieces."""

    parts: tuple[str, ...]
    directions: tuple[tuple[float, float], ...]


def leaving_picture(
    assembly: Assembly, order: Sequence[Leaving], aside: set[str], *, title: str, said: Sequence[str], command: str
) -> str:
    """Picture (SVG) of who leaves.

    Parameters
    ----------
    assembly : Assembly
    order : sequence of Leaving
        In the order of leaving.
    aside : set of names
        Parts that move aside and do not leave.
    title, said, command : str, sequence of str, str
        Said above and below.
    """
    rest = assembly.rest
    boxes = layout.boxes(assembly, rest)
    box = layout.extent(boxes)
    canvas = layout.view(box, 0.0).canvas
    head, below = frame.header(title, said, canvas - 2 * palette.MARGIN)
    view = layout.view(box, below + _GAP)
    room = float(np.median((boxes[:, 2:] - boxes[:, :2]).max(axis=1)) * view.scale)
    marks: list[Mark] = []
    gone: set[str] = set()
    for k, leaving in enumerate(order):
        for name, direction in zip(leaving.parts, leaving.directions, strict=True):
            pull = Pull(name, direction, inside(assembly, name))
            marks.append(numbered(goal_mark(view, assembly, pull, rest, rest, room), k + 1, room))
            gone.add(name)
    kinds = {p.name: _kind(p.name, p.fixed, gone, aside) for p in assembly.parts}
    tints = PartColours({name: _FILLS[kind] for name, kind in kinds.items()}, ())
    body = drawn_parts(view, assembly, None, rest, gone, marks, room, tints)
    legend = [(frame.swatch(_FILLS[k], _STROKES[k]), said) for k, said in _SAID.items() if k in set(kinds.values())]
    if gone:
        legend += [(_DISC, "order of leaving"), (_ARROW, "leaves this way")]
    foot, height = frame.footer(view, view.y + view.height + _GAP + 16, legend, command)
    return frame.document(view.canvas, height, title, said, command, [*head, *body, *foot])


_FILLS = {
    "fixed": palette.FIXED[0], "leaves": palette.PULLED[0], "aside": palette.ASIDE, "stays": palette.NEUTRAL[0],
}  # fmt: skip
_STROKES = {
    "fixed": palette.FIXED[1], "leaves": palette.PULLED[1], "aside": palette.NEUTRAL[1], "stays": palette.NEUTRAL[1],
}  # fmt: skip
_SAID = {"fixed": "stands", "leaves": "leaves", "aside": "moves aside and stays", "stays": "stays"}


def _kind(name: str, fixed: bool, gone: set[str], aside: set[str]) -> str:
    if fixed:
        return "fixed"
    return "leaves" if name in gone else "aside" if name in aside else "stays"


def inside(assembly: Assembly, name: str) -> tuple[float, float]:
    """A point inside a part at rest [mm], as far from its outline as any: its reference point may lie anywhere."""
    part = assembly.parts[assembly.names.index(name)]
    largest = max(part.regions, key=lambda region: np.ptp(region.outer, axis=0).sum())
    outer, *holes = (place(ring, part.at) for ring in (largest.outer, *largest.holes))
    shape = shapely.Polygon(outer, holes)
    middle = shapely.maximum_inscribed_circle(shape, tolerance=0.02 * float(np.ptp(outer, axis=0).max()))
    at = shapely.get_coordinates(middle)[0]
    return float(at[0]), float(at[1])
