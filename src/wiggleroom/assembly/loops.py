"""Closed outlines of many parts in one flat array, so that one numpy call works on all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.model import Part, Points, Region
from wiggleroom.drawing.outlines.rings import CORNERS_AT_ONCE
from wiggleroom.parallel.batches import THREADS, in_batches

SAME = 1e-9
"""Corners closer than this, or off a straight line by less, are not corners [part size]."""


@dataclass(frozen=True, eq=False)
class Loops:
    """Closed outlines one after another.

    Parameters
    ----------
    points : (n, 2) float64 [mm]
        Corners; edge i runs from corner i to the next one of its loop.
    counts : (k,) int
        Corners of each loop.
    """

    points: Points
    counts: NDArray[np.int64]

    @property
    def starts(self) -> NDArray[np.int64]:
        """Index of the first corner of each loop (k,)."""
        return np.cumsum(self.counts) - self.counts

    @property
    def owner(self) -> NDArray[np.int64]:
        """Loop of each corner (n,)."""
        return np.repeat(np.arange(len(self.counts)), self.counts)

    @property
    def before(self) -> NDArray[np.int64]:
        """Corner before each corner (n,)."""
        index = np.arange(len(self.points)) - 1
        index[self.starts] += self.counts
        return index

    @property
    def after(self) -> NDArray[np.int64]:
        """Corner after each corner (n,)."""
        index = np.arange(len(self.points)) + 1
        index[self.starts + self.counts - 1] -= self.counts
        return index

    def rings(self) -> list[Points]:
        """One array (m, 2) [mm] per loop."""
        return np.split(self.points, self.starts[1:])

    def batches(self) -> list[tuple[Loops, slice, slice]]:
        """Consecutive loops of some thousand corners each, and which loops and which corners these are."""
        ends = np.cumsum(self.counts)
        cuts = [0, *(np.flatnonzero(np.diff(ends // CORNERS_AT_ONCE)) + 1).tolist(), len(ends)]
        corners = [0, *ends[np.array(cuts[1:]) - 1].tolist()]
        return [
            (Loops(self.points[first:end], self.counts[low:high]), slice(low, high), slice(first, end))
            for (low, high), (first, end) in zip(pairwise(cuts), pairwise(corners), strict=True)
        ]


def chained(rings: Sequence[Points]) -> Loops:
    """Rings, each (m, 2) [mm] and not closed, one after another.

    Examples
    --------
    >>> triangle = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    >>> chained([triangle, triangle]).after
    array([1, 2, 0, 4, 5, 3])
    """
    counts = np.array([len(r) for r in rings], dtype=np.int64)
    return Loops(np.concatenate(rings), counts)


def region_rings(regions: Sequence[Region]) -> tuple[list[Points], list[int]]:
    """Rings of regions, outer before its holes, and the region of each."""
    rings = [ring for region in regions for ring in (region.outer, *region.holes)]
    return rings, [i for i, region in enumerate(regions) for _ in range(1 + len(region.holes))]


def polygons(loops: Loops, region: Sequence[int] | NDArray[np.int64]) -> NDArray[np.object_]:
    """Shapely polygons of loops; `region` (k,) names the polygon of each loop, outer loop first."""
    rings = shapely.linearrings(loops.points, indices=loops.owner)
    return np.asarray(shapely.polygons(rings, indices=np.asarray(region)))


def region_of(piece: shapely.Polygon) -> Region:
    """Region of a shapely polygon, cleaned; its outer ring runs counter-clockwise and its holes clockwise.

    Examples
    --------
    >>> region_of(shapely.box(0, 0, 2, 1)).outer.tolist()
    [[2.0, 0.0], [2.0, 1.0], [0.0, 1.0], [0.0, 0.0]]
    """
    loops = chained([np.array(ring.coords)[:-1] for ring in (piece.exterior, *piece.interiors)])
    size = np.ptp(loops.points, axis=0).max()
    outer, *holes = cleaned(loops, np.full(len(loops.counts), size)).rings()
    return Region(outer, tuple(holes))


def placed_regions(parts: Sequence[Part]) -> tuple[NDArray[np.object_], NDArray[np.int64]]:
    """Every region as a shapely polygon in assembly coordinates at rest, and the index of its part."""
    loops, region, owners = placed_loops(parts)
    return polygons(loops, region), owners


def placed_loops(parts: Sequence[Part]) -> tuple[Loops, NDArray[np.int64], NDArray[np.int64]]:
    """Outlines of all regions in assembly coordinates at rest, the region of each, and the index of each region's part."""
    owners = np.repeat(np.arange(len(parts)), [len(p.regions) for p in parts])
    rings, of = region_rings([r for p in parts for r in p.regions])
    loops, region = chained(rings), np.array(of)
    x, y, angle = np.array([p.at for p in parts], dtype=float)[owners[region]].T
    at = np.column_stack([x, y, np.cos(angle), np.sin(angle)])
    placed = np.empty_like(loops.points)
    for some, which, corners in loops.batches():
        (x, y), (right, up, cosine, sine) = some.points.T, np.repeat(at[which], some.counts, axis=0).T
        placed[corners, 0] = cosine * x - sine * y + right
        placed[corners, 1] = sine * x + cosine * y + up
    return Loops(placed, loops.counts), region, owners


def are_valid(shapes: NDArray[np.object_]) -> NDArray[np.bool_]:
    """Whether shapely polygons (k,) are valid, looked at on both cores."""
    return np.concatenate(in_batches(len(shapes), THREADS, lambda some: shapely.is_valid(shapes[some])))


def cleaned(loops: Loops, size: NDArray[np.float64]) -> Loops:
    """Without repeated corners and corners on straight edges; `size` (k,) [mm] is that of each loop's part.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    >>> cleaned(chained([square]), np.array([2.0])).points.tolist()
    [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]
    """
    while (drop := np.concatenate([_droppable(some, SAME * size[which]) for some, which, _ in loops.batches()])).any():
        counts = loops.counts - np.add.reduceat(drop.astype(np.int64), loops.starts)
        loops = Loops(loops.points[~drop], counts)
    return loops


def _droppable(loops: Loops, tolerance: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Corners that say nothing, no two of them neighbours: dropping neighbours together could flatten a fine curve."""
    before, tol = loops.before, np.repeat(tolerance, loops.counts)
    back, ahead = loops.points - loops.points[before], loops.points[loops.after] - loops.points
    chord = np.hypot(*(back + ahead).T)
    off = np.abs(back[:, 0] * ahead[:, 1] - back[:, 1] * ahead[:, 0])
    straight = (off <= tol * chord) & (dot_products(back, ahead) > 0)
    idle = straight | (np.hypot(*back.T) <= tol)
    place = np.arange(len(idle)) - np.repeat(loops.starts, loops.counts)
    odd = idle & (place % 2 == 1)
    return odd if odd.any() else idle & ~((place == 0) & idle[before])


def dot_products(one: Points, other: Points) -> NDArray[np.float64]:
    """Dot products (n,) of vectors (n, 2); column by column, because sums of two numbers each are slow."""
    return one[:, 0] * other[:, 0] + one[:, 1] * other[:, 1]


def signed_areas(loops: Loops) -> NDArray[np.float64]:
    """Area of each loop (k,) [mm²], positive counter-clockwise."""
    areas = []
    for some, _, _ in loops.batches():
        points = some.points - np.repeat(some.points[some.starts], some.counts, axis=0)
        after = points[some.after]
        areas.append(np.add.reduceat(points[:, 0] * after[:, 1] - points[:, 1] * after[:, 0], some.starts) / 2)
    return np.concatenate(areas)
