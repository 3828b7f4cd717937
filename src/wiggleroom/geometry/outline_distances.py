"""Distances between bodies: by shapely where outlines are short, by bisected runs of edges where they have very many corners.

Shapely compares each edge with almost each other one; for two outlines of 100,000 corners in each other that takes minutes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.errors import Stop, go_on

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Complexes = NDArray[np.complex128]

MAX_PRODUCT = 1_000_000
"""Pairs of bodies are left to shapely up to this product of their numbers of corners, about 10 ms."""
BATCH = 25_000
"""Pairs of runs whose halves are compared at once."""
CHUNK = 8
"""Bodies whose distance to another one is worked out at once."""


class OutlineDistances:
    """Distances between bodies of an assembly.

    Parameters
    ----------
    geometry : (n,) shapely geometries
        Polygons, or lines where only boundaries count.

    Examples
    --------
    >>> boxes = shapely.box([0, 3, 9], 0, [2, 5, 10], 1)
    >>> apart = OutlineDistances(boxes)
    >>> apart.between([0, 0], [1, 2]).tolist(), apart.to_nearest([0, 1, 2]).tolist()
    ([1.0, 7.0], [1.0, 1.0, 4.0])
    """

    def __init__(self, geometry: NDArray[np.object_]) -> None:
        self._geometry = geometry
        self._corners = shapely.get_num_coordinates(geometry).astype(np.int64)
        self._runs: dict[int, EdgeRuns] = {}

    def between(self, i: Ints | Sequence[int], j: Ints | Sequence[int], stop: Stop | None = None) -> Floats:
        """Distances (P,) [mm] of pairs of bodies; 0 where they touch or overlap.

        Raises
        ------
        StoppedError
            If it was asked to stop.
        """
        i, j = np.asarray(i, dtype=np.int64), np.asarray(j, dtype=np.int64)
        apart = np.zeros(len(i))
        large = self._corners[i] * self._corners[j] > MAX_PRODUCT
        apart[~large] = shapely.distance(self._geometry[i[~large]], self._geometry[j[~large]])
        for k in np.flatnonzero(large).tolist():
            go_on(stop)
            apart[k] = self._of_large(int(i[k]), int(j[k]), stop)
        return apart

    def to_nearest(self, some: Ints | Sequence[int], stop: Stop | None = None) -> Floats:
        """Distances (k,) [mm] of some bodies to the nearest other one; infinite where all others are equal to it.

        Raises
        ------
        StoppedError
            If it was asked to stop.
        """
        box = shapely.bounds(self._geometry)
        return np.array([self._to_nearest(k, box, stop) for k in np.asarray(some).tolist()], dtype=np.float64)

    def _to_nearest(self, k: int, box: Floats, stop: Stop | None) -> float:
        least = np.hypot(*np.maximum(np.maximum(box[:, :2] - box[k, 2:], box[k, :2] - box[:, 2:]), 0.0).T)
        least[k] = np.inf
        alike = np.flatnonzero((box == box[k]).all(axis=1) & (least == 0))
        least[alike[shapely.equals(self._geometry[alike], self._geometry[k])]] = np.inf
        order = np.argsort(least, kind="stable")
        best = np.inf
        for first in range(0, len(order), CHUNK):
            go_on(stop)
            near = order[first : first + CHUNK]
            near = near[least[near] < best]
            if not len(near) or best == 0:
                break
            best = min(best, float(self.between(np.full(len(near), k), near, stop).min()))
        return best

    def _of_large(self, a: int, b: int, stop: Stop | None) -> float:
        one, other = self._geometry[[a, b]]
        shapely.prepare(one)  # in one thread: what is prepared may not be shared
        meet = shapely.intersects(one, other)
        shapely.destroy_prepared(one)
        return 0.0 if meet else distance_of_edges(self._of_body(a), self._of_body(b), stop)

    def _of_body(self, k: int) -> EdgeRuns:
        if k not in self._runs:
            self._runs[k] = edge_runs(self._geometry[k])
        return self._runs[k]


@dataclass(frozen=True, eq=False)
class EdgeRuns:
    """Edges of closed outlines, in order, and runs of 1, 2, 4, ... of them: each lies within a width of its chord.

    Parameters
    ----------
    begin, end : (n,) complex128 [mm]
        Of every edge, x + iy.
    """

    begin: Complexes
    end: Complexes

    @cached_property
    def levels(self) -> list[tuple[Complexes, Complexes, Floats]]:
        """Begin and end of the chords of all runs (k,) [mm], and how far their points lie from these; the shortest runs first."""
        levels = [(self.begin, self.end, np.zeros(len(self.begin)))]
        while len(levels[-1][0]) > 1:
            begin, end, width = levels[-1]
            first = np.arange(0, len(begin), 2)
            last = np.minimum(first + 1, len(begin) - 1)
            # the distance from a chord is convex: of a shorter chord an end is furthest
            off = (np.sqrt(_to_edge(p, begin[first], end[last])) for p in (end[first], begin[last]))
            wide = [width[part] + away for part, away in zip((first, last), off, strict=True)]
            levels.append((begin[first], end[last], np.maximum(*wide)))
        return levels

    def level(self, k: int) -> tuple[Complexes, Complexes, Floats]:
        """Runs of 2^k edges; one run where there are no more edges than that."""
        return self.levels[min(k, len(self.levels) - 1)]


def edge_runs(body: shapely.Geometry) -> EdgeRuns:
    """Edges of the boundary of a polygon, or of closed lines."""
    lines = shapely.boundary(body) if shapely.get_dimensions(body) == 2 else body
    points, ring = shapely.get_coordinates(shapely.get_parts(lines), return_index=True)
    joined, at = ring[1:] == ring[:-1], points @ (1, 1j)
    return EdgeRuns(at[:-1][joined], at[1:][joined])


def distance_of_edges(one: EdgeRuns, other: EdgeRuns, stop: Stop | None = None) -> float:
    """Least distance [mm] of edges that do not cross.

    Pairs of runs that lie further apart than the nearest points so far are left out, all others are halved.

    Raises
    ------
    StoppedError
        If it was asked to stop.
    """
    best, start = np.inf, np.zeros(1, dtype=np.int64)
    stack = [(max(len(one.levels), len(other.levels)) - 1, start, start)]
    while stack:
        go_on(stop)
        level, i, j = stack.pop()
        (begin, end, width), (begin_, end_, width_) = one.level(level), other.level(level)
        apart = np.sqrt(_between_edges(begin[i], end[i], begin_[j], end_[j]))
        if level == 0:
            best = min(best, float(apart.min()))
            continue
        best = min(best, float(np.abs(begin[i] - begin_[j]).min()))
        least = apart - width[i] - width_[j]
        least[_cross(begin[i], end[i], begin_[j], end_[j])] = 0.0
        near = np.flatnonzero(least < best)
        near = near[np.argsort(least[near], kind="stable")]
        counts = len(one.level(level - 1)[0]), len(other.level(level - 1)[0])
        for first in reversed(range(0, len(near), BATCH)):  # the nearest are looked at first
            some = near[first : first + BATCH]
            stack.append((level - 1, *_halves(i[some], j[some], *counts)))
    return best


def _halves(i: Ints, j: Ints, count: int, other: int) -> tuple[Ints, Ints]:
    """All pairs of the halves of runs; of `count` and `other` runs there are of these."""
    left = np.concatenate([2 * i, 2 * i, 2 * i + 1, 2 * i + 1])
    right = np.concatenate([2 * j, 2 * j + 1, 2 * j, 2 * j + 1])
    there = (left < count) & (right < other)
    return left[there], right[there]


def _between_edges(a: Complexes, b: Complexes, c: Complexes, d: Complexes) -> Floats:
    """Squared distances (P,) [mm^2] of edges a b and c d that do not cross: an end of the one is nearest to the other."""
    return np.minimum.reduce([_to_edge(a, c, d), _to_edge(b, c, d), _to_edge(c, a, b), _to_edge(d, a, b)])


def _to_edge(point: Complexes, begin: Complexes, end: Complexes) -> Floats:
    """Squared distances (P,) [mm^2] of points from edges."""
    along, away = end - begin, point - begin
    length = np.maximum(along.real**2 + along.imag**2, np.finfo(float).tiny)
    share = np.clip((away.real * along.real + away.imag * along.imag) / length, 0.0, 1.0)
    x, y = away.real - share * along.real, away.imag - share * along.imag
    return np.asarray(x * x + y * y)


def _cross(a: Complexes, b: Complexes, c: Complexes, d: Complexes) -> NDArray[np.bool_]:
    """True (P,) where edges a b and c d cross or touch."""
    one, other = b - a, d - c
    sides = [_side(one, c - a) * _side(one, d - a), _side(other, a - c) * _side(other, b - c)]
    return np.asarray(np.maximum(*sides) <= 0)


def _side(along: Complexes, to: Complexes) -> Floats:
    return np.sign(along.real * to.imag - along.imag * to.real)
