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


def overlaps(bodies: Bodies, motion: Floats, ignored: Ints) -> Overlaps:
    """Every pair of bodies that overlaps at `motion` (n, 3) [mm, mm, rad], apart from fixed with fixed and `ignored` keys a * n + b.

    Depth is how far the outline of one lies inside the other: the largest distance of a corner of the common material from either outline,
    or the width of the largest disc in it where that is more.
    """
    geometry = placed(bodies, motion)
    a, b = shapely.STRtree(geometry).query(geometry)
    keep = (a < b) & ~(bodies.fixed[a] & bodies.fixed[b]) & ~np.isin(a * len(geometry) + b, ignored)
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
