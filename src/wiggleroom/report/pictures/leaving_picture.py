"""Who leaves, at a glance: all parts at rest, with a number in the order of leaving and an arrow on each that leaves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.inner_point import inner_point
from wiggleroom.report.pictures import frame, layout, palette
from wiggleroom.report.pictures.arrows import Mark, bent_arrow, carry, numbered
from wiggleroom.report.pictures.picture import PartColours, colours_of, drawn_parts
from wiggleroom.report.results.separability import Checked, check_facts, check_title

Floats = NDArray[np.float64]

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
    """Parts that leave together.

    Parameters
    ----------
    parts : tuple of names
    path : (k, n, 3) float64 [mm, mm, rad]
        Motions of all parts.
    """

    parts: tuple[str, ...]
    path: Floats


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
    box = layout.bounding_box(boxes)
    canvas = layout.view(box, 0.0).canvas
    head, below = frame.header(title, said, canvas - 2 * palette.MARGIN)
    view = layout.view(box, below + _GAP)
    room = float(np.median((boxes[:, 2:] - boxes[:, :2]).max(axis=1)) * view.scale)
    marks: list[Mark] = []
    gone: set[str] = set()
    for k, leaving in enumerate(order):
        for name in leaving.parts:
            row, point = assembly.names.index(name), np.array(inner_point(assembly, name))
            track = np.array([carry(point, rest[row], rest[row] + motion) for motion in leaving.path[:, row]])
            marks.append(numbered(way_out(view, point, track, room), k + 1, room))
            gone.add(name)
    kinds = {p.name: _kind(p.name, p.fixed, gone, aside) for p in assembly.parts}
    tints = PartColours({name: _FILLS[kind] for name, kind in kinds.items()}, ())
    body = drawn_parts(view, assembly, rest, colours_of(assembly, gone, tints), marks, room)
    legend = [(frame.swatch(_FILLS[k], _STROKES[k]), said) for k, said in _SAID.items() if k in set(kinds.values())]
    if gone:
        legend += [(_DISC, "order of leaving"), (_ARROW, "leaves this way")]
    foot, height = frame.footer(view, view.y + view.height + _GAP + 16, legend, command)
    return frame.document(view.canvas, height, title, said, command, [*head, *body, *foot])


def way_out(view: layout.View, point: Floats, track: Floats, room: float) -> Mark:
    """Arrow from a point (2,) [mm] bent as its track (k, 2) [mm] is, not to scale, for a part `room` pixels large."""
    return bent_arrow(view.pixels(point), track * (view.scale, -view.scale), room)


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


def picture_of_check(checked: Checked, *, command: str = "") -> str:
    """All parts at rest, with a number in the order of leaving and an arrow on each that leaves, as an SVG picture."""
    found = checked.found
    order = [Leaving(e.parts, e.path) for e in found.escapes]
    moved = {n for e in found.escapes for k, n in enumerate(found.assembly.names) if e.path[:, k].any()}
    aside = moved - {n for e in found.escapes for n in e.parts}
    said = check_facts(found, checked.border)
    return leaving_picture(found.assembly, order, aside, title=check_title(found), said=said, command=command)
