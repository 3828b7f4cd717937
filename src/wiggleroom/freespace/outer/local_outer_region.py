"""Local outer regions: what B can reach against A, from walls that hold as long as it stays within a window; far cheaper than outer slices.

Take a window of motions round rest. If a point of B, wherever the window carries it, can get behind an edge of A only into
A's material, then the wall of that point and edge holds at every free motion of the window; the same with A and B exchanged.
If all these walls together keep clear of the window's rim, then a path from rest never comes to the rim, and the walls hold for
all that can be reached. Smaller windows within make walls straighter, and more of them hold.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import OPTIONS, njit
from wiggleroom.freespace.outer.outer_slices import PairMaterial, corners_of, loops
from wiggleroom.freespace.outer.outer_walls import corners_between, cut_corners
from wiggleroom.geometry.relative_pose import rotated

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

WINDOWS = ((1.3, 2), (3.2, 8), (4.8, 8))
"""Half of the windows that are tried, in clearances, and how often their boxes are halved."""
EDGE_REACH = 15.0
"""Edges and corners count that lie no further from the other part, in clearances."""
ANGLE_INTERVALS = 6
"""Intervals of turns of a window."""
MAX_OPEN_BOXES = 24
"""At most this many boxes are halved at once."""
ROUNDING_MARGIN = 1e-12
"""Turns of a box are wider by this [rad]."""
TIGHTENING_ROUNDS = 2
"""Rounds in which a window is drawn closer round what is left of it: walls that it needs for a shorter part hold more often."""
SHARPENING_ROUNDS, MIN_SHARPENING = 10, 0.003
"""Most rounds in which boxes that reach furthest are halved, while two rounds together cut what is reached by this share."""
CORNER_REACH = 2.0
"""Points on the sides of a corner count as well, this many half windows away: a corner may slip off the end of an edge."""
NORMAL_SECTORS, WALLS_PER_SECTOR = 32, 6
"""Sectors of directions of normals, and walls of one sector that are tried at most; the tightest that holds is kept."""


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
class _Boxes:
    """Boxes (K, 3) of motions from `low` to `high` [mm, mm, rad]."""

    low: Floats
    high: Floats

    def halved(self, lever: float) -> _Boxes:
        """Both halves of each box, cut where it is longest; a turn by one radian is as long as `lever` [mm]."""
        k = np.arange(len(self.low))
        axis = ((self.high - self.low) * (1.0, 1.0, lever)).argmax(1)
        middle = (self.low[k, axis] + self.high[k, axis]) / 2
        high, low = self.high.copy(), self.low.copy()
        high[k, axis] = low[k, axis] = middle
        return _Boxes(np.vstack([self.low, low]), np.vstack([high, self.high]))


def local_outer_region(sides: NearSides) -> LocalOuterRegion | None:
    """Walls round rest; None where they do not close in a window of a few clearances."""
    material = sides.pair
    for window, rounds in WINDOWS:
        high = window * material.clearance * np.array([1.0, 1.0, 2.0 / sides.lever])
        found = _within(sides, -high, high, rounds)
        if found is None or not _at_rim(found, -high, high).any():
            return found
    return None


def _within(sides: NearSides, low: Floats, high: Floats, rounds: int) -> LocalOuterRegion | None:
    """What walls leave of a window between two corners (3,) [mm, mm, rad]; boxes that reach its rim are halved, in `rounds` rounds."""
    ends = np.linspace(low[2], high[2], ANGLE_INTERVALS + 1)
    first, last = np.tile(low, (ANGLE_INTERVALS, 1)), np.tile(high, (ANGLE_INTERVALS, 1))
    first[:, 2], last[:, 2] = ends[:-1], ends[1:]
    found = _left(sides, _Boxes(first, last))
    for _ in range(rounds):
        if found is None:
            return None
        rim = _at_rim(found, low, high)
        if not rim.any():
            break
        if len(np.unique(found.which[rim])) > MAX_OPEN_BOXES:
            break
        open_ = np.isin(found.which, found.which[rim])
        halves = _left(sides, _around(_some(found, open_)).halved(sides.lever))
        found = _connected(_joined(_some(found, ~open_), halves))
    if found is None or _at_rim(found, low, high).any():
        return found
    for _ in range(TIGHTENING_ROUNDS):
        found = None if found is None else _connected(_left(sides, _around(found)))
    return _sharpened(sides, found)


def _sharpened(sides: NearSides, found: LocalOuterRegion | None) -> LocalOuterRegion | None:
    """The same with the boxes halved that reach furthest: in smaller ones more walls hold, along curves above all."""
    if found is None:
        return None
    every = np.array([d for d in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(d)]) / np.ptp(
        found.corner, axis=0
    )
    reach: list[float] = []
    for _ in range(SHARPENING_ROUNDS):
        along = found.corner @ every.T
        reach.append(float(along.max(0).sum()))
        if len(reach) > 2 and reach[-1] > (1 - MIN_SHARPENING) * reach[-3]:
            break
        mine = np.isin(found.which, found.which[along.argmax(0)])
        halves = _left(sides, _around(_some(found, mine)).halved(sides.lever))
        sharper = _connected(_joined(_some(found, ~mine), halves))
        if sharper is None:
            break
        found = sharper
    return found


def _at_rim(found: LocalOuterRegion, low: Floats, high: Floats) -> NDArray[np.bool_]:
    """Which corners (N,) reach the rim of a window."""
    outside = (found.corner < (1 - 1e-6) * low) | (found.corner > (1 - 1e-6) * high)
    return np.asarray(outside.any(axis=1))


def _connected(found: LocalOuterRegion | None) -> LocalOuterRegion | None:
    """Only the polyhedra to which a path from rest through others leads: each touches the next one, and so do the boxes round them."""
    if found is None or not len(found.corner):
        return None
    boxes = _around(found)
    meet = np.asarray(((boxes.low[:, None] <= boxes.high) & (boxes.low <= boxes.high[:, None])).all(axis=2))
    reached = np.asarray(((boxes.low <= 0) & (boxes.high >= 0)).all(axis=1))
    while True:
        more = reached | meet[reached].any(0)
        if (more == reached).all():
            break
        reached = more
    return _some(found, np.isin(found.which, np.unique(found.which)[reached]))


def _around(found: LocalOuterRegion) -> _Boxes:
    """A box round each polyhedron."""
    first = np.flatnonzero(np.diff(found.which, prepend=-1))
    margin = np.array([4 * found.material.margin] * 2 + [ROUNDING_MARGIN])
    return _Boxes(np.minimum.reduceat(found.corner, first) - margin, np.maximum.reduceat(found.corner, first) + margin)


def _some(found: LocalOuterRegion, corners: NDArray[np.bool_]) -> LocalOuterRegion:
    """The polyhedra to which some corners (N,) belong."""
    return LocalOuterRegion(found.material, found.low, found.high, found.corner[corners], found.which[corners])


def _joined(one: LocalOuterRegion, other: LocalOuterRegion | None) -> LocalOuterRegion | None:
    """Polyhedra of both; None where there are none."""
    if not len(one.corner):
        return other
    if other is None:
        return one if len(one.corner) else None
    return LocalOuterRegion(
        one.material,
        np.concatenate([one.low, other.low]),
        np.concatenate([one.high, other.high]),
        np.vstack([one.corner, other.corner]),
        np.concatenate([one.which, other.which + len(one.low)]),
    )


class NearSides:
    """Edges and convex corners of both parts that lie near the other, each in its own axes about the pivot."""

    def __init__(self, material: PairMaterial) -> None:
        reach = EDGE_REACH * material.clearance
        self.pair, self.material = material, (material.a, material.b)
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
        for whole in self.material:
            shapely.prepare(whole)

    @property
    def work(self) -> float:
        """About how long a pocket takes, in milliseconds of some machine: from pairs of edges and points, so the same everywhere."""
        (one, *_, corners, _, _, _, _), (other, *_, others, _, _, _, _) = self.sides
        return 25 + 0.02 * (len(one) * len(others) + len(other) * len(corners))


def _left(sides: NearSides, boxes: _Boxes) -> LocalOuterRegion | None:
    """What the walls that hold in each of some boxes leave of it; None where that is nothing at all."""
    low, high = boxes.low[:, 2], boxes.high[:, 2]
    centre, half = (boxes.low + boxes.high)[:, :2] / 2, (boxes.high - boxes.low)[:, :2] / 2 * (1 + 1e-9)
    window = _Window((low + high) / 2, (high - low) / 2 * (1 + 1e-9) + 1e-14, centre, half)
    planes = [_planes(sides, kind, window) for kind in (0, 1)]
    corners = []
    for k in range(len(low)):
        x, y = centre[k]
        one, other = half[k]
        box = np.array([[1, 0, 0, x + one], [-1, 0, 0, one - x], [0, 1, 0, y + other], [0, -1, 0, other - y]])
        rows = np.vstack([rows[which == k] for rows, which in planes])
        slack = rows[:, 3] - rows[:, :2] @ centre[k] - rows[:, 2] * window.middle[k]
        rows = np.vstack([box, rows[_least(2 * _sector(rows) + (rows[:, 2] > 0), slack, 1)]])
        corners.append(corners_between(rows, float(low[k]), float(high[k])))
    count = [len(c) for c in corners]
    if not sum(count):
        return None
    return LocalOuterRegion(sides.pair, low, high, np.vstack(corners), np.repeat(np.arange(len(count)), count))


def _sector(normal: Floats) -> Ints:
    """Sector of directions that normals point into."""
    return np.round((np.arctan2(normal[:, 1], normal[:, 0]) / (2 * np.pi) + 0.5) * NORMAL_SECTORS).astype(np.int64)


def _least(key: Ints, value: Floats, most: int) -> Ints:
    """For each key the places of its `most` least values."""
    order = np.lexsort((value, key))
    first = np.searchsorted(key[order], key[order])
    return order[np.arange(len(order)) - first < most]


@dataclass(frozen=True, eq=False)
class _Window:
    """Boxes of translations, `centre` (K, 2) and half sides `sides` (K, 2) [mm], for turns within `half` of `middle` (K,) [rad]."""

    middle: Floats
    half: Floats
    centre: Floats
    sides: Floats


def _planes(sides: NearSides, kind: int, window: _Window) -> tuple[Floats, Ints]:
    """Walls (k, 4) of edges of A and points of B (`kind` 0), or of B and of A, that hold in the windows; and the window of each."""
    material, middle, half = sides.pair, window.middle, window.half
    start, end, go = sides.sides[kind][:3]
    size = np.hypot(*window.sides.T)
    points = _points(sides.sides[1 - kind], CORNER_REACH * float(size.max()))
    normal = np.column_stack([go[:, 1], -go[:, 0]])
    # where the points are in each window, seen by the part whose edges count, and how far a turn within the window carries them
    if kind == 0:
        seen = rotated(points[None], middle[:, None]) + window.centre[:, None]
        arm = np.broadcast_to(np.hypot(*points.T), seen.shape[:2])
        along_box, across_box = (np.broadcast_to(np.abs(v), (len(middle), *v.shape)) for v in (go, normal))
    else:
        seen = rotated(points - window.centre[:, None], -middle[:, None])
        arm = np.hypot(seen[..., 0], seen[..., 1]) + size[:, None]
        along_box, across_box = (np.abs(rotated(v[None], middle[:, None])) for v in (go, normal))
    swing = 2 * np.sin(half[:, None] / 2) * arm + material.margin
    # and how far the box carries them (K, edges)
    sideways = (along_box * window.sides[:, None]).sum(2)
    inwards = (across_box * window.sides[:, None]).sum(2)
    k, i, j, front = _contacts(seen, swing, start, end, go, sideways, inwards)
    few = _least(k * (2 * NORMAL_SECTORS) + _sector(normal)[j], front, WALLS_PER_SECTOR)
    k, i, j, depth = k[few], i[few], j[few], front[few, None]
    sideways, inwards = sideways[k, j] + swing[k, i], inwards[k, j] + swing[k, i]
    top = seen[k, i] - (depth + material.margin) * normal[j]
    side, deep = sideways[:, None] * go[j], (inwards[:, None] - depth) * normal[j]
    behind = shapely.polygons(np.stack([top - side, top + side, top + side - deep, top - side - deep], 1))
    holds = shapely.covers(sides.material[kind], behind)
    k, i, j = k[holds], i[holds], j[holds]
    n, p, d = normal[j], points[i], half[k]
    bent = arm[k, i] * d * d / 2 + 2 * material.margin
    if kind == 0:
        at = rotated(p, middle[k])
        slope = n[:, 1] * at[:, 0] - n[:, 0] * at[:, 1]
        level = (n * (at - start[j])).sum(1) + bent
        n = -n
    else:
        level = -(n * start[j]).sum(1) + d * size[k] + bent
        n, p = rotated(n, middle[k]), p - window.centre[k]
        slope = n[:, 0] * p[:, 1] - n[:, 1] * p[:, 0]
        level += (n * points[i]).sum(1)
    return np.column_stack([n, -slope, level - slope * middle[k]]), k


@njit(**OPTIONS)
def _contacts(
    seen: Floats, swing: Floats, start: Floats, end: Floats, go: Floats, sideways: Floats, inwards: Floats
) -> tuple[Ints, Ints, Ints, Floats]:
    """Boxes (c,), points and edges that a motion of the box can bring together, and how far the point lies in front of the edge."""
    found = [(0, 0, 0, 0.0) for _ in range(0)]
    for k in range(len(seen)):
        for j in range(len(start)):
            gx, gy = go[j]
            long = (end[j, 0] - start[j, 0]) * gx + (end[j, 1] - start[j, 1]) * gy
            for i in range(seen.shape[1]):
                x, y = seen[k, i, 0] - start[j, 0], seen[k, i, 1] - start[j, 1]
                front, along = x * gy - y * gx, x * gx + y * gy
                wide = sideways[k, j] + swing[k, i]
                if abs(front) < inwards[k, j] + swing[k, i] and -wide < along < long + wide:
                    found.append((k, i, j, front))
    count = len(found)
    box, point, edge = np.empty(count, np.int64), np.empty(count, np.int64), np.empty(count, np.int64)
    depth = np.empty(count)
    for n in range(count):
        box[n], point[n], edge[n], depth[n] = found[n]
    return box, point, edge, depth


def _points(side: tuple[Floats, ...], aside: float) -> Floats:
    """Convex corners, and points of the sides beside them."""
    corner, come, go, before, after = side[3:]
    on, back = np.minimum(aside, after / 2)[:, None] * go, np.minimum(aside, before / 2)[:, None] * come
    return np.vstack([corner, corner + on, corner - back])
