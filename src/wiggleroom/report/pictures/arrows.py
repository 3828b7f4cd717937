"""Arrows: the pull, the turn and the forces."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.drawing.model import Goal, Pull, Towards, Turn, Vector, W
from wiggleroom.report.pictures import palette
from wiggleroom.report.pictures.axes import text
from wiggleroom.report.pictures.layout import View

if TYPE_CHECKING:
    from wiggleroom.search.answer import Answer

Floats = NDArray[np.float64]

MIN_ARROW_LENGTH = 16.0
"""A shorter arrow cannot be seen as one [px]."""
PULL_LENGTH = 44.0
"""Length of the arrow of a pull [px]."""
MAX_CONTACTS = 300
"""Contacts that are drawn, those with the largest forces first."""
MIN_FORCE_SHARE = 1e-3
"""Contacts with less than this share of the largest force are not drawn."""
_DISC_SHARE, _DISC = 0.07, (9.0, 16.0)
"""Radius of a numbered disc as a share of the size of a part, and the least and the largest [px]."""
_SMALL, _SLIGHT = 30.0, 0.1
"""Parts of fewer pixels are too small for all their contacts: those with less than this share of the largest force are left out."""

_LEGS, _HEAD = 3, 11.0
"""Straight pieces of a bent arrow at most, and length of its head [px]."""
_SLIGHT_BEND = 0.15
"""Bends that lead a part aside by less than this share of its size are not drawn."""
_LONGER = 0.6
"""Every further leg makes an arrow longer by this share."""


@dataclass(frozen=True, eq=False)
class Mark:
    """Piece of SVG, and the lines that names should keep away from by `clear` [px]."""

    svg: str
    lines: tuple[Floats, ...] = ()
    clear: float = 4.0


def goal_mark(view: View, assembly: Assembly, goal: Goal, rest: Floats, shown: Floats, room: float) -> Mark:
    """Arrow of one goal: from the pulled point at rest along the pull, or round a part that is turned.

    Its length is what the motion gains along the pull.

    Parameters
    ----------
    rest, shown : (n, 3) float64 [mm, mm, rad]
        Poses at rest and as drawn.
    room : float [px]
        Size of the part, which the turn arrow fits into.
    """
    if not isinstance(goal, Pull | Turn | W | Towards):
        return Mark("")
    k = assembly.names.index(goal.part)
    if isinstance(goal, Turn):
        return _turn(view.pixels(shown[k, :2]), 1.0 if goal.sense == "ccw" else -1.0, room)
    if isinstance(goal, Pull):
        direction = np.array(goal.direction, dtype=float)
        point = rest[k, :2] if goal.point is None else np.array(goal.point, dtype=float)
    elif isinstance(goal, Towards):
        point = rest[k, :2] if goal.point is None else np.array(goal.point, dtype=float)
        direction = np.array(goal.target) - point
        if not direction.any():
            return Mark("")
    else:
        if math.hypot(*goal.w[:2]) == 0:
            return _turn(view.pixels(shown[k, :2]), math.copysign(1.0, goal.w[2]), room)
        direction, point = np.array(goal.w[:2], dtype=float), rest[k, :2]
    direction = direction / np.hypot(*direction) * (1, -1)
    start, end = view.pixels(point), view.pixels(carry(point, rest[k], shown[k]))
    gain = float((end - start) @ direction)
    if (
        gain < MIN_ARROW_LENGTH
    ):  # too short to be seen as an arrow: from where the point is now, in the direction of the pull
        return _pull(end, end + PULL_LENGTH * direction)
    return _pull(start, start + gain * direction, end)


def pull_arrow(direction: Vector) -> str:
    """Arrow PULL_LENGTH long that begins at 0, 0 [px] and points along `direction`, y up."""
    end = PULL_LENGTH * np.array(direction, dtype=float) / math.hypot(*direction) * (1, -1)
    return _pull(np.zeros(2), end).svg


def turn_arrow(sense: float, room: float) -> str:
    """Arc round 0, 0 [px], counter-clockwise where `sense` is positive, for a part `room` pixels large."""
    return _turn(np.zeros(2), sense, room).svg


def _pull(start: Floats, tip: Floats, moved: Floats | None = None) -> Mark:
    """Arrow along the pull; where the point moved sideways too, a thin line leads from the tip to where it is."""
    colour, lines = palette.MOTION, [np.array([start, tip])]
    shaft, head = arrow(start, tip, 11.0)
    svg = f'<path d="{shaft}" fill="none" stroke="{colour}" stroke-width="3" stroke-linecap="round"/>'
    if moved is not None and np.hypot(*(moved - tip)) > 6.0:
        (x, y), (u, v) = tip, moved
        svg += f'<path d="M{x:.2f},{y:.2f}L{u:.2f},{v:.2f}" fill="none" stroke="{colour}" stroke-dasharray="2 4"/>'
        svg += f'<circle cx="{u:.2f}" cy="{v:.2f}" r="3" fill="{colour}"/>'
        lines.append(np.array([tip, moved]))
    x, y = start
    ring = f'<circle cx="{x:.2f}" cy="{y:.2f}" r="4" fill="{palette.PAPER}" stroke="{colour}" stroke-width="2"/>'
    return Mark(svg + f'<path d="{head}" fill="{colour}"/>' + ring, tuple(lines))


def bent_arrow(start: Floats, track: Floats, room: float) -> Mark:
    """Arrow from a point (2,) [px] bent as a track (k, 2) [px] is, not to scale, for a part `room` pixels large."""
    tolerance = _SLIGHT_BEND * room
    while len(corners := _simplified(track, tolerance)) > _LEGS + 1:
        tolerance *= 1.5
    legs = np.diff(corners, axis=0)
    length = np.hypot(*legs.T)
    along = legs / length[:, None]
    length[-1] = min(length[-1], max(length[:-1].sum(), room))  # the last leg has no end
    length *= PULL_LENGTH * (1 + _LONGER * (len(legs) - 1)) / length.sum()
    length = np.maximum(length, MIN_ARROW_LENGTH)
    length[0] += disc_radius(room)
    drawn = start + np.vstack([np.zeros(2), np.cumsum(along * length[:, None], axis=0)])
    shaft, head = arrow(drawn[-2], drawn[-1], _HEAD)
    before = "".join(f"M{x:.2f},{y:.2f}L{u:.2f},{v:.2f}" for (x, y), (u, v) in pairwise(drawn[:-1]))
    stroke = f'fill="none" stroke="{palette.MOTION}" stroke-width="3" stroke-linecap="round"'
    svg = f'<path d="{before}{shaft}" {stroke}/><path d="{head}" fill="{palette.MOTION}"/>'
    return Mark(svg, tuple(np.array(pair) for pair in pairwise(drawn)))


def _simplified(track: Floats, tolerance: float) -> Floats:
    return shapely.get_coordinates(shapely.simplify(shapely.LineString(track), tolerance, preserve_topology=False))


def numbered(mark: Mark, number: int, room: float) -> Mark:
    """The mark with a number in a disc where its first line begins; large parts of `room` [px] have larger discs."""
    x, y = mark.lines[0][0]
    size = disc_radius(room)
    radius = size * (1.0 if number < 10 else 1.2)
    disc = (
        f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{radius:.1f}" fill="{palette.PAPER}" stroke="{palette.MOTION}" '
        'stroke-width="1.5"/>'
    )
    letters = 1.4 * size if number < 100 else size
    digit = text(x, y + 0.36 * letters, letters, palette.INK, str(number), "middle")
    line = np.array([[x - radius, y], [x + radius, y]])
    return Mark(mark.svg + disc + digit, (*mark.lines, line), max(mark.clear, radius))


def disc_radius(room: float) -> float:
    """Radius [px] of the disc of a number on a part `room` pixels large."""
    return min(max(_DISC_SHARE * room, _DISC[0]), _DISC[1])


def contact_mark(view: View, answer: Answer, rest: Floats, shown: Floats, room: float) -> Mark:
    """Contacts as dots and their forces as arrows as long as they are large; only those that matter.

    Parameters
    ----------
    room : float [px]
        Size of a usual part, which dots and arrows go by.
    """
    largest = max((c.force for c in answer.contacts), default=0.0)
    held = sorted(
        (c for c in answer.contacts if c.force > MIN_FORCE_SHARE * largest), key=lambda c: (-c.force, c.parts, c.point)
    )
    if not held:
        return Mark("")
    if room < _SMALL:  # arrows longer than their parts: of each pair the largest
        held = [c for c in {c.parts: c for c in reversed(held)}.values() if c.force > _SLIGHT * largest][::-1]
    held, row = held[:MAX_CONTACTS], {name: k for k, name in enumerate(answer.assembly.names)}
    radius, longest = min(max(0.035 * room, 1.5), 3.0), min(max(0.45 * room, 16.0), 38.0)
    moved = rest + answer.motion
    dots, shafts, heads, lines = [], [], [], []
    for c in held:
        a, b = row[c.parts[0]], row[c.parts[1]]
        # a magnified motion pulls the two sides of a contact apart: it is drawn between them
        sides = [carry(np.array(c.point), moved[k], shown[k]) for k in (a, b)]
        point = view.pixels((sides[0] + sides[1]) / 2)
        length = longest * c.force / largest
        end = point + length * np.array(c.normal) * (1, -1)
        if length > 2 * radius:
            shaft, head = arrow(point, end, min(2.6 * radius, 0.6 * length))
            shafts.append(shaft)
            heads.append(head)
        dots.append(f'<circle cx="{point[0]:.2f}" cy="{point[1]:.2f}" r="{radius:.2f}"/>')
        lines.append(np.array([point, end]))
    stroke = f'fill="none" stroke="{palette.FORCE}" stroke-width="{max(0.55 * radius, 0.5):.2f}"'
    arrows = (
        f'<path d="{"".join(shafts)}" {stroke}/><path d="{"".join(heads)}" fill="{palette.FORCE}"/>' if shafts else ""
    )
    return Mark(f'{arrows}<g fill="{palette.INK}">{"".join(dots)}</g>', tuple(lines), radius)


def carry(point: Floats, before: Floats, after: Floats) -> Floats:
    """Where a point (2,) [mm] of a part goes when its pose (3,) [mm, mm, rad] changes."""
    turn = after[2] - before[2]
    c, s = math.cos(turn), math.sin(turn)
    x, y = point - before[:2]
    return np.array([after[0] + c * x - s * y, after[1] + s * x + c * y])


def arrow(start: Floats, end: Floats, head: float) -> tuple[str, str]:
    """Path data of the shaft and of the head of an arrow [px] that ends at `end`."""
    length = float(np.hypot(*(end - start)))
    along = (end - start) / max(length, 1e-9)
    across = np.array([-along[1], along[0]])
    head = min(head, length)
    neck = end - head * along
    left, right = neck + 0.42 * head * across, neck - 0.42 * head * across
    corners = (*left, *end, *right)
    return (
        "M{:.2f},{:.2f}L{:.2f},{:.2f}".format(*start, *(neck + 0.2 * head * along)),
        "M{:.2f},{:.2f}L{:.2f},{:.2f}L{:.2f},{:.2f}z".format(*corners),
    )


def turn_radius(room: float) -> float:
    """Radius [px] of the arc that stands for a turn of a part `room` pixels large."""
    return min(max(0.28 * room, 9.0), 46.0)


def _turn(centre: Floats, sense: float, room: float) -> Mark:
    """Arc of 240 degrees round `centre` with a head, counter-clockwise where `sense` is positive."""
    radius = turn_radius(room)
    angles = sense * np.radians(np.linspace(-30.0, 210.0, 49))
    arc = centre + radius * np.column_stack([np.cos(angles), -np.sin(angles)])
    ahead = arc[-1] + sense * 0.45 * radius * np.array([-math.sin(angles[-1]), -math.cos(angles[-1])])
    _, head = arrow(arc[-1], ahead, 0.45 * radius)
    path = ("M" + "%.2f,%.2f " * len(arc)) % tuple(arc.ravel().tolist())
    x, y = centre
    svg = (
        f'<path d="{path}" fill="none" stroke="{palette.MOTION}" stroke-width="3" stroke-linecap="round"/>'
        f'<path d="{head}" fill="{palette.MOTION}"/><circle cx="{x:.2f}" cy="{y:.2f}" r="3" fill="{palette.MOTION}"/>'
    )
    return Mark(svg, (arc, np.array([centre, centre])))


def obstacles(marks: list[Mark]) -> shapely.STRtree:
    """Tree over all lines that names keep away from, as thick as they are drawn."""
    return shapely.STRtree(
        [shapely.buffer(shapely.LineString(line), mark.clear, quad_segs=2) for mark in marks for line in mark.lines]
    )
