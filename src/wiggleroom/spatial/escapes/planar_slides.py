"""Ways out by translations of one body: along a direction, and in planes across it, as a keyhole leaves the head of a pin.

Between two neighbouring heights of corners of the Minkowski differences of its pieces and all others the free translations are taken for
those of a prism: a polygon with holes, exact where faces stand or lie. Pieces of neighbouring polygons that overlap are joined. A path
through them leads up or down until nothing is above or below. All its steps are checked anew.

Source: exact cell decomposition by sweeping a plane, Latombe, "Robot Motion Planning" 1991; the configuration space of translations as
the complement of Minkowski differences, Lozano-Pérez 1983.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.context import UNLIMITED, Context
from wiggleroom.search.state_tree import EqualKeys, Exit, Level, StateTree
from wiggleroom.spatial.overlaps.difference_section import (
    MinkowskiDifference,
    eroded,
    minkowski_difference,
    slab_core,
    slab_shadow,
)
from wiggleroom.spatial.search.spatial_prepare import SpatialPrepared

Floats = NDArray[np.float64]

MARGINS = (0.1, 0.002)
"""The path stays that far from what it may not meet, in multiples of the clearance: first a wide one, then a narrow one."""
MAX_SLOPING = 2
"""Where faces slope about all axes, so many of those about which the fewest do are looked at."""
SAME_HEIGHT = 1e-7
"""Heights that differ by a smaller share of the size are one."""
MAX_SLABS = 60
"""Of more heights those are left out that are nearest to their neighbours; slabs of faces that slope are cut up to so many."""
STRAIGHT = 1e-9
"""A waypoint nearer to the line between its neighbours, as a share of the extent of the path, is left out."""
MAX_CORES = 240
"""The same where it is only asked whether a body may leave."""
SLIVER = 1e-8
"""Polygons of a smaller area, as a share of the square of the length of their border, are rounding."""
MAX_PAIRS = 4000
"""Bodies that have more pairs of pieces with others are not looked at."""


@dataclass(frozen=True, eq=False)
class _Slab:
    """Free translations between two heights: connected polygons (k,) [mm]."""

    low: float
    high: float
    free: list[shapely.Polygon]

    @property
    def middle(self) -> float:
        return (self.low + self.high) / 2


_Node = tuple[int, int]
_Doors = StateTree[_Node, shapely.Point]


@dataclass(frozen=True, eq=False)
class _Reached:
    """Free translations that are connected with where the body is.

    Parameters
    ----------
    frame : (3, 3) float64
        Its rows are the axes in which the slabs are.
    slabs : list of _Slab
    tree : StateTree
        Polygons (slab, number) that are reached, and the doors between them.
    """

    frame: Floats
    slabs: list[_Slab]
    tree: _Doors

    def path_to(self, translation: Floats) -> Floats | None:
        """Translations (k, 3) [mm] from none to one (3,); None where it is not reached."""
        x, y, z = self.frame @ translation
        flat = shapely.Point(x, y)
        for k, slab in enumerate(self.slabs):
            if not slab.low <= z <= slab.high:
                continue
            for number, visited in enumerate(self.tree.states):
                polygon = slab.free[visited.state[1]] if visited.state[0] == k else None
                if polygon is not None and polygon.contains(flat):
                    points = _path_to(self.slabs, self.tree, number)
                    last = [np.array([*xy, slab.middle]) for xy in _inside(polygon, points[-1][:2], np.array([x, y]))]
                    return _bends(np.array([*points, *last, (x, y, z)])) @ self.frame
        return None


class TranslationSpace:
    """Translations of a body from a motion (n, 6), all others standing: what it may not meet.

    Parameters
    ----------
    ready : SpatialPrepared
    motion : (n, 6) float64 [mm, rad]
    body : int
    context : Context
    turns : (m, 3, 3) float64, optional
        Rotations of the world by which the body is turned about its reference point: it may meet nothing in any of them.
    axes : (k, 3) float64, optional
        Directions across which slabs may lie; those of the world by default.
    tilts : (2, 3) float64, optional [rad]
        Turns about the axes of the world, back and ahead, with which the body may move, too: what it may not meet is smaller by as much
        as they carry its corners. Where it cannot go then, it cannot go with such turns.
    """

    def __init__(
        self,
        ready: SpatialPrepared,
        motion: Floats,
        body: int,
        turns: Floats | None = None,
        axes: Floats | None = None,
        context: Context = UNLIMITED,
        tilts: Floats | None = None,
    ) -> None:
        self._ready, self._motion, self._body, self._context = ready, motion, body, context
        self._tilts = tilts
        self._axes = np.eye(3) if axes is None else axes
        self._turns = np.eye(3)[None] if turns is None else turns

    @property
    def pairs(self) -> int:
        """Number of pairs of pieces whose differences are needed."""
        bodies = self._ready.grouping.bodies
        mine = len(bodies.pieces[self._body])
        return len(self._turns) * mine * (sum(map(len, bodies.pieces)) - mine)

    @cached_property
    def _differences(self) -> list[MinkowskiDifference]:
        """Of all pieces of other bodies and all of this one; none where they are too many."""
        bodies, pose = self._ready.grouping.bodies, self._ready.grouping.pose_of(self._motion)

        def placed(b: int, R: Floats) -> list[tuple[int, Floats]]:
            corners = [piece.corners @ R.T + pose.T[b] for piece in bodies.pieces[b]]
            return list(zip(bodies.owner[b].tolist(), corners, strict=True))

        if self.pairs > MAX_PAIRS:
            return []
        mine = [piece for turn in self._turns for piece in placed(self._body, turn @ pose.R[self._body])]
        others = [piece for b in range(len(bodies.at)) if b != self._body for piece in placed(b, pose.R[b])]
        found = []
        for (p, P), (q, Q) in itertools.product(others, mine):
            if self._stopped():
                return []
            if (min(p, q), max(p, q)) not in bodies.ignored:
                difference: MinkowskiDifference | None = minkowski_difference(P, Q)
                if self._tilts is not None and difference is not None:
                    difference = eroded(difference, partial(_carried, Q - pose.T[self._body], self._tilts))
                found.append(difference)
        return [difference for difference in found if difference is not None]

    def _views(self) -> list[tuple[int, Floats, list[MinkowskiDifference]]]:
        """Of each axis how many differences slope about it, a frame along it and the differences in that; the fewest first."""
        views = []
        for frame in map(_frame_along, self._axes):
            turned = [d.turned(frame) for d in self._differences]
            views.append((sum(not d.is_prism for d in turned), frame, turned))
        return sorted(views, key=lambda view: view[0])

    def is_open(self) -> bool:
        """True where translations may lead out: between two heights only what the body may not meet at any of them blocks."""
        if not self._differences:
            return True
        sloping, _, turned = self._views()[0]
        shadows = self._shadows(turned, sloping > 0, MAX_CORES, slab_core)
        return self._stopped() or _through(_slabs(shadows, 0.0, self._ready.size)) is not None

    def way_out(self) -> tuple[Floats, Floats] | None:
        """Checked motions (k, n, 6) of the body, from where it is to where it is free along one of the axes, ahead or back; and that axis.

        Where all faces stand or lie about an axis, that alone is looked at: what is found there is all there is.
        """
        if not self._differences:
            return None
        views = self._views()
        for sloping, frame, turned in views[:1] if views[0][0] == 0 else views[:MAX_SLOPING]:
            path = self._along(frame, turned, sloping > 0)
            if path is not None:
                return path, frame[2]
        return None

    def _along(self, frame: Floats, turned: Sequence[MinkowskiDifference], sloping: bool) -> Floats | None:
        """Checked motions (k, n, 6) to where the body is free along the last axis of a frame; None where none are found."""
        shadows = self._shadows(turned, sloping)
        for margin in MARGINS:
            if self._stopped():
                return None
            translations = _through(_slabs(shadows, margin * self._ready.clearance, self._ready.size))
            path = None if translations is None else self._checked(translations @ frame)
            if path is not None:
                return path
        return None

    @cached_property
    def _reached(self) -> _Reached | None:
        """Free translations connected with none, in slabs across the axis about which the fewest faces slope."""
        sloping, frame, turned = self._views()[0]
        shadows = self._shadows(turned, sloping > 0)
        for margin in MARGINS:
            slabs = _slabs(shadows, margin * self._ready.clearance, self._ready.size)
            tree = _from_origin(slabs)
            if tree is not None:
                tree.search(Level(partial(_neighbours, slabs, tree)), context=UNLIMITED)
                return _Reached(frame, slabs, tree)
        return None

    def path_to(self, translation: Floats) -> Floats | None:
        """Checked motions (k, n, 6) of the body by translations that add up to one (3,) [mm]; None where none are found."""
        if not self._differences or self._reached is None:
            return None
        translations = self._reached.path_to(translation)
        return None if translations is None else self._checked(translations)

    def extent(self) -> float:
        """How far the translations that are connected with none reach along the axes, at most [mm]; infinite where they are not known."""
        if not self._differences or self._reached is None:
            return np.inf
        slabs, reached = self._reached.slabs, [visited.state for visited in self._reached.tree.states]
        bounds = np.array([[*slabs[k].free[i].bounds, slabs[k].low, slabs[k].high] for k, i in reached])
        low, high = bounds[:, [0, 1, 4]].min(axis=0), bounds[:, [2, 3, 5]].max(axis=0)
        return float((high - low).max())

    def reaches(self, translation: Floats) -> bool:
        """True where a translation (3,) [mm] is connected with none."""
        return bool(self._differences) and self._reached is not None and self._reached.path_to(translation) is not None

    def roomiest(self, axis: Floats) -> Iterator[Floats]:
        """Free translations (3,) [mm]: of each polygon in slabs across an axis the middle of its largest circle, the largest first."""
        frame = _frame_along(axis)
        turned = [d.turned(frame) for d in self._differences]
        shadows = self._shadows(turned, not all(d.is_prism for d in turned)) if turned else []
        found = []
        for slab in _slabs(shadows, MARGINS[-1] * self._ready.clearance, self._ready.size) if shadows else []:
            for polygon in slab.free:
                radius = shapely.maximum_inscribed_circle(polygon)
                found.append((-radius.length, [*radius.coords[0], slab.middle]))
        for _, point in sorted(found):
            yield np.array(point) @ frame

    def _shadows(
        self,
        turned: Sequence[MinkowskiDifference],
        sloping: bool,
        most: int = MAX_SLABS,
        blocked: Callable[..., shapely.Geometry] = slab_shadow,
    ) -> list[tuple[float, float, shapely.Geometry]]:
        """Translations that are blocked between all heights, from below everything to above everything: ends, and polygons."""
        near, clearance = SAME_HEIGHT * self._ready.size, self._ready.clearance
        levels = _levels(np.concatenate([d.corners[:, 2] for d in turned]), near, sloping, clearance, most)
        ends = [levels[0] - 2 * clearance, *levels, levels[-1] + 2 * clearance]
        found = []
        for low, high in itertools.pairwise(ends):
            if self._stopped():
                return []
            found.append((low, high, blocked(turned, low + near / 2, high - near / 2)))
        return found

    def _checked(self, translations: Floats) -> Floats | None:
        """Motions (k, n, 6) of the body by translations (k, 3) [mm]; None where the check of the path does not agree."""
        ready = self._ready
        path = np.repeat(self._motion[None], len(translations), axis=0)
        mine = np.flatnonzero(ready.grouping.body_of == self._body)
        path[:, mine, :3] += translations[:, None]
        steps = itertools.pairwise(path)
        return None if any(ready.checker.doubtful(a, b, first=True, only=mine.tolist()) for a, b in steps) else path

    def _stopped(self) -> bool:
        return self._context.stopped


def _carried(corners: Floats, tilts: Floats, normals: Floats) -> Floats:
    """How far turns carry the corners of a piece (k, 3) [mm] that are foremost against each normal (f, 3) along it, at most (f,) [mm].

    In all directions the turned piece reaches at least as far as its foremost corner, and that is one of those of the faces beside it.
    About the axes it turns by up to `tilts` (2, 3) [rad], back and ahead; beyond the first order it is carried by no more than half of
    the square of the whole angle times the lever.
    """
    lever = np.linalg.norm(corners, axis=1)
    moment = np.cross(corners[None], normals[:, None])
    far = np.maximum(moment, 0.0) @ tilts[1] + np.maximum(-moment, 0.0) @ tilts[0]
    far += lever * (tilts.max(axis=0) ** 2).sum() / 2
    against = normals @ corners.T
    foremost = against <= against.min(axis=1, keepdims=True) + SAME_HEIGHT * lever.max()
    return np.asarray(np.where(foremost, far, 0.0).max(axis=1))


def _frame_along(axis: Floats) -> Floats:
    """Right-handed axes, as rows (3, 3), the last of which is given."""
    across = np.linalg.svd(axis[None])[2][1]
    return np.array([across, np.cross(axis, across), axis])


def _slabs(shadows: Sequence[tuple[float, float, shapely.Geometry]], margin: float, size: float) -> list[_Slab]:
    """Free translations at some distance from those that are blocked."""
    bounds = np.array([[0.0, 0, 0, 0], *(blocked.bounds for _, _, blocked in shadows if not blocked.is_empty)])
    around = shapely.box(*(bounds.min(axis=0)[:2] - size / 10), *(bounds.max(axis=0)[2:] + size / 10))
    with np.errstate(invalid="ignore"):  # buffers of slivers raise the flag; every path is checked afterwards
        return [
            _Slab(low, high, _polygons(shapely.difference(around, blocked.buffer(margin, join_style="mitre"))))
            for low, high, blocked in shadows
        ]


def _levels(heights: Floats, near: float, sloping: bool, clearance: float, most: int) -> list[float]:
    """Heights (k,) each once, in order, with some between where faces slope; those left out that are nearest to others where too many."""
    levels = np.sort(heights)
    levels = levels[np.diff(levels, prepend=-np.inf) > near]
    if sloping:  # where the body is must be free, and so must be what is about there
        levels = np.sort(np.append(levels[np.abs(levels) > clearance / 10], [-clearance / 10, clearance / 10]))
    while len(levels) > most:
        thin = np.diff(levels)
        thin[np.searchsorted(levels, 0.0) - 1] = np.inf
        levels = np.delete(levels, 1 + int(thin[:-1].argmin()))
    while sloping and len(levels) < most:
        k = int(np.diff(levels).argmax())
        levels = np.insert(levels, k + 1, (levels[k] + levels[k + 1]) / 2)
    return levels.tolist()


def _through(slabs: Sequence[_Slab]) -> Floats | None:
    """Translations (k, 3) from none to the lowest or the highest slab, through pieces that touch; None where there is no path."""
    if not any(s.low < 0 <= s.high for s in slabs):
        return np.zeros((1, 3))
    tree = _from_origin(slabs)
    if tree is None:
        return None

    def onwards(here: int) -> Iterator[tuple[_Node, shapely.Point] | Exit[int]]:
        if tree.states[here].state[0] in (0, len(slabs) - 1):
            yield Exit(here)
        yield from _neighbours(slabs, tree, here)

    end = tree.search(Level(onwards), context=UNLIMITED)
    return None if end is None else _path_to(slabs, tree, end)


def _from_origin(slabs: Sequence[_Slab]) -> _Doors | None:
    """The tree of polygons connected with the origin, that round it alone so far; None where the origin is not free."""
    origin = shapely.Point(0.0, 0.0)
    first = next((k for k, s in enumerate(slabs) if s.low < 0 <= s.high), None)
    if first is None:
        return None
    begin = next(((first, i) for i, p in enumerate(slabs[first].free) if p.contains(origin)), None)
    return None if begin is None else StateTree(begin, EqualKeys(begin, lambda node: node))


def _neighbours(slabs: Sequence[_Slab], tree: _Doors, here: int) -> Iterator[tuple[_Node, shapely.Point]]:
    """Polygons above and below that overlap one, and a point well inside of what they share."""
    k, i = tree.states[here].state
    mine = slabs[k].free[i]
    for up in (k + 1, k - 1):
        if not 0 <= up < len(slabs):
            continue
        for j, other in enumerate(slabs[up].free):
            shared = _polygons(shapely.intersection(mine, other))
            if shared:
                inner = max((shapely.maximum_inscribed_circle(p) for p in shared), key=lambda line: line.length)
                yield (up, j), shapely.Point(inner.coords[0])


def _polygons(shape: shapely.Geometry) -> list[shapely.Polygon]:
    """Polygons of a shape that are no slivers."""
    parts = shapely.get_parts(shape)
    return [p for p in parts.tolist() if p.geom_type == "Polygon" and p.area > SLIVER * p.length**2]


def _path_to(slabs: Sequence[_Slab], tree: _Doors, end: int) -> Floats:
    """Translations (k, 3) to a polygon, through the doors to it."""
    line = [tree.states[number].state for number in tree.line(end)]
    points = [np.zeros(3)]
    for (k, i), door in zip(line, tree.steps_to(end), strict=False):
        z = slabs[k].middle
        flat = _inside(slabs[k].free[i], points[-1][:2], np.array([door.x, door.y]))
        points += [np.array([*xy, z]) for xy in flat]
    points.append(np.array([*points[-1][:2], slabs[line[-1][0]].middle]))
    return _bends(np.array(points))


def _bends(points: Floats) -> Floats:
    """First and last of points (k, 3) on a path, and those at which it changes its direction."""
    near = STRAIGHT * float(np.ptp(points, axis=0).max())
    kept = [points[0]]
    for here, after in itertools.pairwise(points[1:]):
        step, ahead = here - kept[-1], after - kept[-1]
        far = float(np.linalg.norm(ahead))
        between = far > near and 0 <= step @ ahead <= far**2
        if np.linalg.norm(step) > near and not (between and np.linalg.norm(np.cross(step, ahead)) <= near * far):
            kept.append(here)
    return np.array([*kept, points[-1]])


def _inside(polygon: shapely.Polygon, start: Floats, end: Floats) -> list[Floats]:
    """Corners of a path inside a polygon with holes between two of its points, through triangles that share sides."""
    if polygon.contains(shapely.LineString([start, end])):
        return [start, end]
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(polygon))
    side: dict[frozenset, list[int]] = {}
    for t, triangle in enumerate(triangles):
        ring = list(triangle.exterior.coords)
        for a, b in itertools.pairwise(ring):
            side.setdefault(frozenset((a, b)), []).append(t)
    beside: dict[int, list[tuple[int, Floats]]] = {t: [] for t in range(len(triangles))}
    for ends, both in side.items():
        if len(both) == 2:
            middle = np.mean(list(ends), axis=0)
            beside[both[0]].append((both[1], middle))
            beside[both[1]].append((both[0], middle))
    first, last = (int(shapely.distance(triangles, shapely.Point(p)).argmin()) for p in (start, end))
    known = EqualKeys(last, lambda t: t)
    tree: StateTree[int, Floats] = StateTree(last, known)
    tree.search(Level(lambda here: beside[tree.states[here].state]), context=UNLIMITED)
    doors = tree.steps_to(known.number[first]) if first in known.number else []
    return _shortened(polygon, [start, *doors[::-1], end])


def _shortened(polygon: shapely.Polygon, points: list[Floats]) -> list[Floats]:
    """The path without corners that straight segments inside the polygon pass by."""
    shapely.prepare(polygon)
    kept, k = [points[0]], 0
    while k < len(points) - 1:
        ahead = (
            j for j in range(len(points) - 1, k, -1) if polygon.contains(shapely.LineString([points[k], points[j]]))
        )
        k = next(ahead, k + 1)
        kept.append(points[k])
    return kept
