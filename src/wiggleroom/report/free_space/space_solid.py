"""The free space of a pair as the page reads it: its slices, and a surface of triangles from slice to slice."""

from __future__ import annotations

import base64
from itertools import pairwise

import numpy as np
import shapely
from msgspec import UNSET
from numpy.typing import NDArray

from wiggleroom.compare.monte_carlo import about_pivot
from wiggleroom.freespace.free_space import FreeSlices
from wiggleroom.report.free_space.space_report import space_facts, space_headline
from wiggleroom.report.free_space.stacked_slices import HEIGHT_RATIO, rings, slices_box
from wiggleroom.report.results.answer_words import number
from wiggleroom.schema.study_replies import SpaceReply, SpaceSlice

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_SLICES = 64
"""Slices that the page is given."""


def space_message(found: FreeSlices, state: tuple[float, float, float], command: str) -> SpaceReply:
    """Free space of a pair, with the state (x [mm], y [mm], turn [deg]) that is shown in it.

    The solid stands over x [mm], y [mm] and angle [deg], in motions of the pivot.
    """
    regions, angles = about_pivot(found), np.degrees([s.angle for s in found.slices])
    low, high = slices_box(regions)
    first, last = np.degrees(found.angles).tolist()
    vertices, triangles = lofted(regions, angles, (first, last))
    shown = np.unique(np.linspace(0, len(regions) - 1, min(len(regions), MAX_SLICES)).round().astype(int))
    a, b = found.parts
    return SpaceReply(
        a=a,
        b=b,
        vertices=base64.b64encode(vertices.astype("<f4").tobytes()).decode(),
        triangles=base64.b64encode(triangles.astype("<u4").tobytes()).decode(),
        slices=[SpaceSlice(float(angles[k]), [ring.tolist() for ring in rings(regions[k])]) for k in shown.tolist()],
        range_deg=(first, last),
        scale=HEIGHT_RATIO * float((high - low).max()) / (last - first) if last > first else 1.0,
        pivot=(float(found.pivot[0]), float(found.pivot[1])),
        state=state,
        headline=space_headline(found),
        facts=space_facts(found, None),
        model="walls",
        command=command,
        open=UNSET if found.closed else True,
        words=UNSET if found.closed else f"it has no end: looked at as far as {number(found.reach, 3)} mm",
    )


def lofted(regions: list[shapely.Geometry], levels: Floats, ends: tuple[float, float]) -> tuple[Floats, Ints]:
    """Vertices (v, 3) and triangles (t, 3) of a closed surface through the outlines of slices, seen from outside counter-clockwise.

    A piece and the one that it goes over into are joined by a strip of triangles between their outlines; where pieces
    split, join, begin or end they are closed flat. Beyond the first and the last slice the surface runs straight on to
    the ends of the turn.
    """
    surface = _Surface()
    levels, regions = np.asarray(levels), list(regions)
    if ends[0] < levels[0]:
        levels, regions = np.append(ends[0], levels), [regions[0], *regions]
    if ends[1] > levels[-1]:
        levels, regions = np.append(levels, ends[1]), [*regions, regions[-1]]
    pieces = [[_Piece(piece) for piece in shapely.get_parts(region)] for region in regions]
    for level, some in zip(levels, pieces, strict=True):
        for piece in some:
            piece.rows = [surface.add(ring, float(level)) for ring in piece.rings]
    joined: set[tuple[int, int, bool]] = set()
    for k, (below, above) in enumerate(pairwise(pieces)):
        for i, j in _continued(below, above):
            for one, other in zip(below[i].rows, above[j].rows, strict=True):
                surface.strip(one, other)
            joined |= {(k, i, True), (k + 1, j, False)}
    for k, some in enumerate(pieces):
        for i, piece in enumerate(some):
            for up in (False, True):
                if (k, i, up) not in joined:
                    surface.cap(piece.area, float(levels[k]), up=up)
    return np.vstack(surface.points), np.vstack(surface.faces)


class _Piece:
    """One piece of a slice: its area, and its rings with the free space on the left, holes by their size."""

    def __init__(self, area: shapely.Polygon) -> None:
        self.area = area
        outer, *holes = rings(area)
        holes.sort(key=lambda ring: -shapely.Polygon(ring).area)
        self.rings = [outer, *holes]
        self.rows: list[Ints] = []


def _continued(below: list[_Piece], above: list[_Piece]) -> list[tuple[int, int]]:
    """Pieces of two slices of which each meets the other alone, and that have as many holes."""
    meets = np.array([[one.area.intersects(other.area) for other in above] for one in below]).reshape(len(below), -1)
    alone = meets & (meets.sum(axis=0) == 1) & (meets.sum(axis=1) == 1)[:, None]
    return [(i, j) for i, j in np.argwhere(alone).tolist() if len(below[i].rings) == len(above[j].rings)]


class _Surface:
    """Points and triangles as they come."""

    def __init__(self) -> None:
        self.points: list[Floats] = []
        self.faces: list[Ints] = []
        self.count = 0

    def add(self, flat: Floats, level: float) -> Ints:
        """Rows of points (k, 2) at a level."""
        self.points.append(np.column_stack([flat, np.full(len(flat), level)]))
        self.count += len(flat)
        return np.arange(self.count - len(flat), self.count)

    def strip(self, one: Ints, other: Ints) -> None:
        """Triangles between two closed rings, the first one below; each goes on where it is behind in its share of the length."""
        points = np.vstack(self.points) if len(self.points) > 1 else self.points[0]
        self.points = [points]
        a, b = points[one, :2], points[other, :2]
        start = int(np.hypot(*(b - a[0]).T).argmin())
        other, b = np.roll(other, -start), np.roll(b, -start, axis=0)
        along_a, along_b = _shares(a), _shares(b)
        steps = np.concatenate([np.zeros(len(a), dtype=bool), np.ones(len(b), dtype=bool)])
        order = np.argsort(np.concatenate([along_a, along_b]), kind="stable")
        steps = steps[order]
        j = np.cumsum(steps)
        i = np.arange(1, len(steps) + 1) - j
        before_i, before_j = i - ~steps, j - steps
        third = np.where(steps, other[j % len(b)], one[i % len(a)])
        self.faces.append(np.column_stack([one[before_i % len(a)], third, other[before_j % len(b)]]))

    def cap(self, area: shapely.Polygon, level: float, *, up: bool) -> None:
        """Close a piece flat."""
        cut = shapely.get_parts(shapely.constrained_delaunay_triangles(area))
        if not len(cut):
            return
        corners = np.array([shapely.get_coordinates(shapely.orient_polygons(t))[:3] for t in cut])
        rows = self.add(corners.reshape(-1, 2), level).reshape(-1, 3)
        self.faces.append(rows if up else rows[:, ::-1])


def _shares(ring: Floats) -> Floats:
    """Share of a ring's length (k,) that lies behind the end of each of its edges."""
    length = np.hypot(*(np.roll(ring, -1, axis=0) - ring).T)
    return np.cumsum(length) / length.sum()
