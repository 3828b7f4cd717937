"""Exact overlap of moved bodies, by general polygon geometry that shares nothing with the walls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.geometry.bodies import Bodies
from wiggleroom.geometry.placed_bodies import placed

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

PREPARED_PAIRS = 5000
"""Pairs whose outlines are prepared at once: that takes several times the memory of the outlines themselves."""

MANY_SHARE = 0.25
"""Where more than this share of all bodies is asked about, what lies round them is not looked for."""


@dataclass(frozen=True, eq=False)
class Overlaps:
    """Pairs of bodies that share material: `a`, `b` (k,) and how deep (k,) [mm]."""

    a: Ints
    b: Ints
    depth: Floats

    @property
    def deepest(self) -> float:
        """Largest depth [mm], 0 where nothing overlaps."""
        return float(self.depth.max(initial=0.0))


def overlaps(bodies: Bodies, motion: Floats, ignored: Ints, only: NDArray[np.bool_] | None = None) -> Overlaps:
    """Every pair of bodies that overlaps at `motion` (n, 3) [mm, mm, rad], apart from fixed with fixed and `ignored` keys a * n + b.

    With a mask `only` (n,) pairs with at least one of these bodies are looked at, and no others.

    Depth is how far the outline of one lies inside the other: the largest distance of a corner of the common material from either outline,
    or the width of the largest disc in it where that is more.
    """
    n = len(bodies.fixed)
    asked = np.ones(n, dtype=bool) if only is None else only
    place = (bodies.rest + motion)[:, :2]
    few = MANY_SHARE * n > np.count_nonzero(asked)
    who = within_reach(place, bodies.radius, np.flatnonzero(asked), 0.0) if few else np.arange(n)
    geometry = placed(bodies, motion, who)
    a, b = who[shapely.STRtree(geometry[who]).query(geometry[who])]
    keep = (a < b) & (asked[a] | asked[b]) & ~(bodies.fixed[a] & bodies.fixed[b]) & ~np.isin(a * n + b, ignored)
    a, b = a[keep], b[keep]
    hit = np.zeros(len(a), dtype=bool)
    for k in range(0, len(a), PREPARED_PAIRS):
        some = slice(k, k + PREPARED_PAIRS)
        first = geometry[np.unique(a[some])]
        shapely.prepare(first)
        hit[some] = shapely.intersects(geometry[a[some]], geometry[b[some]])
        shapely.destroy_prepared(first)
    a, b = a[hit], b[hit]
    common = shapely.intersection(geometry[a], geometry[b])
    solid = shapely.area(common) > 0
    a, b, common = a[solid], b[solid], common[solid]
    return Overlaps(a, b, _depth(common, geometry[a], geometry[b]))


def within_reach(place: Floats, radius: Floats, some: Ints, reach: float) -> Ints:
    """Bodies (k,), ascending, whose discs at places (n, 2) [mm] come within twice the `reach` [mm] of those of some of them.

    Examples
    --------
    >>> within_reach(np.array([(0.0, 0.0), (3.0, 0.0), (9.0, 0.0)]), np.ones(3), np.array([0]), 0.5).tolist()
    [0, 1]
    """
    if not len(some):
        return some
    half = (radius + reach)[:, None]
    low, high = place - half, place + half
    near = np.flatnonzero(((high >= low[some].min(axis=0)) & (low <= high[some].max(axis=0))).all(axis=1))
    boxes = [shapely.box(*low[who].T, *high[who].T) for who in (some, near)]
    other, one = shapely.STRtree(boxes[1]).query(boxes[0])
    a, b = near[one], some[other]
    apart = np.hypot(*(place[a] - place[b]).T) - half[a, 0] - half[b, 0]
    return np.unique(a[apart <= 0])


def _depth(common: NDArray[np.object_], a: NDArray[np.object_], b: NDArray[np.object_]) -> Floats:
    """Depth (k,) [mm] of common material of pairs of bodies."""
    corners, pair = shapely.get_coordinates(common, return_index=True)
    spots = shapely.points(corners)
    far = [shapely.distance(shapely.boundary(body)[pair], spots) for body in (a, b)]
    depth = np.zeros(len(common))
    np.maximum.at(depth, pair, np.maximum(*far))
    pieces, owner = shapely.get_parts(common, return_index=True)
    solid = shapely.area(pieces) > 0
    np.maximum.at(depth, owner[solid], 2 * shapely.length(shapely.maximum_inscribed_circle(pieces[solid])))
    return depth
