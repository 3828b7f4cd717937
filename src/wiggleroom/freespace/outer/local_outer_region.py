"""Local outer regions: what B can reach against A, from walls that hold as long as it stays within a window; far cheaper than outer slices.

Take a window of motions round rest. If a point of B, wherever the window carries it, can get behind an edge of A only into
A's material, then the wall of that point and edge holds at every free motion of the window; the same with A and B exchanged.
If all these walls together keep clear of the window's rim, then a way from rest never comes to the rim, and the walls hold for
all that can be reached. Smaller windows within make walls straighter, and more of them hold.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.freespace.outer.outer_slices import PairMaterial, corners_of, loops
from wiggleroom.freespace.outer.outer_walls import corners_between, cut_corners
from wiggleroom.geometry.relative_pose import turn

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FIRST_WINDOW = 1.3
"""Half of the first window, in clearances."""
WINDOW_GROWTH, MAX_WINDOWS = 1.4, 7
"""Where the walls do not close, the window becomes so many times larger, and so often."""
EDGE_REACH = 15.0
"""Edges and corners count that lie no further from the other part, in clearances."""
ANGLE_INTERVALS = 4
"""Intervals of turns of a window."""
TIGHTENING_ROUNDS = 2
"""So often a window is drawn closer round what is left of the one before."""
CORNER_REACH = 2.0
"""Points on the sides of a corner count as well, so many half windows away: a corner may slip off the end of an edge."""
NORMAL_SECTORS, WALLS_PER_SECTOR = 32, 6
"""Of walls that look the same way only so many are tried, and of those that hold the tightest is kept."""


@dataclass(frozen=True, eq=False)
class LocalOuterRegion:
    """All that B can reach, and some more, as convex polyhedra over intervals of turns; it takes the place of `Outer` in a program.

    Parameters
    ----------
    material : PairMaterial
    low, high : (K,) float64 [rad]
        Intervals of turns.
    corner : (N, 3) float64 [mm, mm, rad]
        Corners of a polyhedron for each interval, one after the other.
    which : (N,) int64
        Interval of each corner.
    """

    material: PairMaterial
    low: Floats
    high: Floats
    corner: Floats
    which: Ints

    @property
    def turns(self) -> tuple[float, float]:
        """Least and largest turn [rad]."""
        return float(self.corner[:, 2].min()) - 1e-12, float(self.corner[:, 2].max()) + 1e-12

    @cached_property
    def far(self) -> float:
        """Largest motion of the pivot [mm]."""
        return float(np.hypot(*self.corner[:, :2].T).max()) + 4 * self.material.margin

    def points(self, low: float = -np.inf, high: float = np.inf) -> tuple[Floats, Ints]:
        """Corners (M, 3) of the polyhedra, cut to turns between `low` and `high`, and the interval of each (M,)."""
        return cut_corners(self.corner, self.which, self.low, self.high, low, high)


@dataclass(frozen=True, eq=False)
class _Window:
    """Boxes of translations, `centre` (K, 2) and half sides `half` (K, 2) [mm], for the turns between `low` and `high` (K,)."""

    low: Floats
    high: Floats
    centre: Floats
    half: Floats


def local_outer_region(material: PairMaterial) -> LocalOuterRegion | None:
    """Walls round rest; None where they do not close in a window of a few clearances."""
    sides = _Sides(material)
    most = material.clearance * np.array([FIRST_WINDOW, FIRST_WINDOW, 2 * FIRST_WINDOW / sides.lever])
    for _ in range(MAX_WINDOWS):
        ends = np.linspace(-most[2], most[2], ANGLE_INTERVALS + 1)
        window = _Window(ends[:-1], ends[1:], np.zeros((ANGLE_INTERVALS, 2)), np.tile(most[:2], (ANGLE_INTERVALS, 1)))
        found = _left(material, sides, window)
        if found is None:
            return None
        open_ = np.abs(found.corner).max(0) > most * (1 - 1e-6)
        if not open_.any():
            break
        most = np.where(open_, WINDOW_GROWTH * most, most)
    else:
        return None
    for _ in range(TIGHTENING_ROUNDS):
        closer = _left(material, sides, _closer(found))
        if closer is None:
            break
        found = closer
    return found


def _closer(found: LocalOuterRegion) -> _Window:
    """As many intervals over the turns that are left, each with a box round what is left at its turns."""
    ends = np.linspace(*found.turns, ANGLE_INTERVALS + 1)
    boxes = []
    for low, high in pairwise(ends):
        there = (found.low[found.which] <= high) & (found.high[found.which] >= low)
        at = found.corner[there, :2]
        boxes.append((at.min(0), at.max(0)) if len(at) else (np.zeros(2), np.zeros(2)))
    box = np.array(boxes)
    return _Window(ends[:-1], ends[1:], box.mean(1), (box[:, 1] - box[:, 0]) / 2 + 4 * found.material.margin)


class _Sides:
    """Edges and convex corners of both parts that lie near the other, each in its own axes about the pivot."""

    def __init__(self, material: PairMaterial) -> None:
        reach = EDGE_REACH * material.clearance
        self.material = material.a, material.b
        self.sides = []
        for mine, other in ((material.a, material.b), (material.b, material.a)):
            start, end, come, go = corners_of(mine)
            _, following = loops(mine)
            near = shapely.dwithin(shapely.linestrings(np.stack([start, end], 1)), other, reach)
            convex = come[:, 0] * go[:, 1] - come[:, 1] * go[:, 0] > 0
            touch = convex & shapely.dwithin(shapely.points(start), other, reach)
            after = np.hypot(*(end - start).T)
            before = np.empty_like(after)
            before[following] = after
            self.sides.append(
                (start[near], end[near], go[near], start[touch], come[touch], go[touch], before[touch], after[touch])
            )
        seen = np.vstack([s[3] for s in self.sides])
        self.lever = float(np.hypot(*seen.T).max()) if len(seen) else material.radius
        for material in self.material:
            shapely.prepare(material)


def _left(material: PairMaterial, sides: _Sides, window: _Window) -> LocalOuterRegion | None:
    """What the walls that hold in a window leave of it; None where that is nothing at all, which only rounding can do."""
    half = (window.high - window.low) / 2 * (1 + 1e-9) + 1e-14
    middle = (window.low + window.high) / 2
    planes = [_planes(material, sides, kind, window, middle, half) for kind in (0, 1)]
    corners = []
    for k in range(len(middle)):
        x, y = window.centre[k]
        one, other = window.half[k]
        box = np.array([[1, 0, 0, x + one], [-1, 0, 0, one - x], [0, 1, 0, y + other], [0, -1, 0, other - y]])
        rows = np.vstack([rows[which == k] for rows, which in planes])
        slack = rows[:, 3] - rows[:, :2] @ window.centre[k] - rows[:, 2] * middle[k]
        rows = np.vstack([box, rows[_least(2 * _sector(rows) + (rows[:, 2] > 0), slack, 1)]])
        corners.append(corners_between(rows, float(window.low[k]), float(window.high[k])))
    count = [len(c) for c in corners]
    if not sum(count):
        return None
    return LocalOuterRegion(
        material, window.low, window.high, np.vstack(corners), np.repeat(np.arange(len(count)), count)
    )


def _sector(normal: Floats) -> Ints:
    """Which way normals look."""
    return np.round((np.arctan2(normal[:, 1], normal[:, 0]) / (2 * np.pi) + 0.5) * NORMAL_SECTORS).astype(np.int64)


def _least(key: Ints, value: Floats, most: int) -> Ints:
    """For each key the places of its `most` least values."""
    order = np.lexsort((value, key))
    first = np.searchsorted(key[order], key[order])
    return order[np.arange(len(order)) - first < most]


def _planes(
    material: PairMaterial, sides: _Sides, kind: int, window: _Window, middle: Floats, half: Floats
) -> tuple[Floats, Ints]:
    """Walls (k, 4) of edges of A and points of B (`kind` 0), or of B and of A, that hold in the windows; and the window of each."""
    start, end, go = sides.sides[kind][:3]
    size = np.hypot(*window.half.T)
    points = _points(sides.sides[1 - kind], CORNER_REACH * float(size.max()))
    normal = np.column_stack([go[:, 1], -go[:, 0]])
    # where the points are in each window, seen by the part whose edges count, and how far a turn within the window carries them
    if kind == 0:
        seen = turn(points[None], middle[:, None]) + window.centre[:, None]
        arm = np.broadcast_to(np.hypot(*points.T), seen.shape[:2])
        along_box, across_box = (np.abs(v)[None] for v in (go, normal))
    else:
        seen = turn(points - window.centre[:, None], -middle[:, None])
        arm = np.hypot(seen[..., 0], seen[..., 1]) + size[:, None]
        along_box, across_box = (np.abs(turn(v[None], middle[:, None])) for v in (go, normal))
    swing = (2 * np.sin(half[:, None] / 2) * arm + material.margin)[..., None]
    # and how far with what the box adds (K, points, edges)
    sideways = (along_box * window.half[:, None]).sum(2)[:, None] + swing
    inwards = (across_box * window.half[:, None]).sum(2)[:, None] + swing
    front = seen @ normal.T - (start * normal).sum(1)
    along = seen @ go.T - (start * go).sum(1)
    long = ((end - start) * go).sum(1)
    k, i, j = np.nonzero((np.abs(front) < inwards) & (along > -sideways) & (along < long + sideways))
    few = _least(k * (2 * NORMAL_SECTORS) + _sector(normal)[j], front[k, i, j], WALLS_PER_SECTOR)
    k, i, j = k[few], i[few], j[few]
    depth = front[k, i, j][:, None]
    top = seen[k, i] - (depth + material.margin) * normal[j]
    side, deep = sideways[k, i, j][:, None] * go[j], (inwards[k, i, j][:, None] - depth) * normal[j]
    behind = shapely.polygons(np.stack([top - side, top + side, top + side - deep, top - side - deep], 1))
    holds = shapely.covers(sides.material[kind], behind)
    k, i, j = k[holds], i[holds], j[holds]
    n, p, d = normal[j], points[i], half[k]
    bent = arm[k, i] * d * d / 2 + 2 * material.margin
    if kind == 0:
        at = turn(p, middle[k])
        slope = n[:, 1] * at[:, 0] - n[:, 0] * at[:, 1]
        level = (n * (at - start[j])).sum(1) + bent
        n = -n
    else:
        level = -(n * start[j]).sum(1) + d * size[k] + bent
        n, p = turn(n, middle[k]), p - window.centre[k]
        slope = n[:, 0] * p[:, 1] - n[:, 1] * p[:, 0]
        level += (n * points[i]).sum(1)
    return np.column_stack([n, -slope, level - slope * middle[k]]), k


def _points(side: tuple[Floats, ...], aside: float) -> Floats:
    """Convex corners, and points of the sides beside them."""
    corner, come, go, before, after = side[3:]
    on, back = np.minimum(aside, after / 2)[:, None] * go, np.minimum(aside, before / 2)[:, None] * come
    return np.vstack([corner, corner + on, corner - back])
