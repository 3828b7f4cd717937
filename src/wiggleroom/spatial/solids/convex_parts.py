"""Exact decomposition of polygons into convex ones, by constrained triangles whose needless diagonals are taken out."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

Floats = NDArray[np.float64]

STRAIGHT = 1e-12
"""Corners that turn by less than this count as straight."""


def convex_polygons(polygon: shapely.Polygon) -> list[Floats]:
    """Convex polygons (k, 2) [mm], counter-clockwise, that make up a polygon with holes.

    Source: Hertel and Mehlhorn 1983: at most four times as many as need be.

    Examples
    --------
    >>> frame = shapely.Polygon([(0, 0), (4, 0), (4, 4), (0, 4)], [[(1, 1), (3, 1), (3, 3), (1, 3)]])
    >>> sorted(len(p) for p in convex_polygons(frame))
    [4, 4, 4, 4]
    """
    if not len(polygon.interiors) and polygon.convex_hull.area - polygon.area <= 1e-14 * polygon.area:
        return [_straightened(np.asarray(shapely.orient_polygons(polygon).exterior.coords)[:-1])]
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(polygon))
    corners, inverse = np.unique(shapely.get_coordinates(triangles), axis=0, return_inverse=True)
    rings = {}
    for k, ring in enumerate(inverse.ravel().reshape(-1, 4)[:, :3].tolist()):
        rings[k] = ring if _left(*(corners[i] for i in ring)) > 0 else ring[::-1]
    owner = {(ring[i], ring[(i + 1) % 3]): k for k, ring in rings.items() for i in range(3)}
    inner = [(i, j) for i, j in owner if i < j and (j, i) in owner]
    inner.sort(key=lambda e: -float(np.linalg.norm(corners[e[0]] - corners[e[1]])))
    for i, j in inner:
        one, other = owner[i, j], owner[j, i]
        if one == other:
            continue
        merged = _merged(rings[one], rings[other], i, j)
        place = {v: k for k, v in enumerate(merged)}
        if all(_turns_left(corners, merged, place[v]) for v in (i, j)):
            rings[one] = merged
            for k, v in enumerate(merged):
                owner[v, merged[(k + 1) % len(merged)]] = one
            del rings[other]
    return [_straightened(corners[ring]) for ring in rings.values()]


def _merged(one: list[int], other: list[int], i: int, j: int) -> list[int]:
    """Ring of both polygons without their common side i, j."""
    a, b = one.index(j), other.index(i)
    first = one[a:] + one[:a]  # from j round to i
    second = other[b:] + other[:b]  # from i round to j
    return first + second[1:-1]


def _turns_left(corners: Floats, ring: list[int], k: int) -> bool:
    before, here, after = corners[ring[k - 1]], corners[ring[k]], corners[ring[(k + 1) % len(ring)]]
    return _left(before, here, after) >= 0.0


def _left(a: Floats, b: Floats, c: Floats) -> float:
    return float((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]))


def _straightened(ring: Floats) -> Floats:
    """The ring without corners on straight sides."""
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return ring[turn > STRAIGHT * np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)]
