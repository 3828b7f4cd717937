"""Minkowski differences of convex pieces: where one may not lie against another, and the shadow of the part between two heights."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

GRID = 1e-10
"""Corners lie on a grid of this share of their coordinates where their union fails without."""
FLAT = 1e-7
"""Neighbouring triangles of a hull whose normals differ by less are one face."""


@dataclass(frozen=True, eq=False)
class MinkowskiDifference:
    """Translations by which a convex piece Q comes to overlap a convex piece P: all differences p - q.

    Parameters
    ----------
    corners : (k, 3) float64 [mm]
    edges : (e, 2) int64
        Corners at the ends of each.
    """

    corners: Floats
    edges: Ints

    def turned(self, frame: Floats) -> MinkowskiDifference:
        """The same in the axes that are the rows of a frame (3, 3)."""
        return MinkowskiDifference(self.corners @ frame.T, self.edges)

    @cached_property
    def is_prism(self) -> bool:
        """True where all edges stand or lie, so that sections are the same at all heights."""
        along = np.abs(self.corners[self.edges[:, 1]] - self.corners[self.edges[:, 0]])
        return bool((np.minimum(along[:, 2], along[:, :2].max(axis=1)) <= FLAT * along.max()).all())

    @cached_property
    def footprint(self) -> shapely.Geometry:
        """Its projection along z."""
        return shapely.MultiPoint(self.corners[:, :2]).convex_hull


def minkowski_difference(P: Floats, Q: Floats) -> MinkowskiDifference:
    """Differences p - q of the hulls of corners P (k, 3) and Q (m, 3) [mm].

    Examples
    --------
    >>> cube = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
    >>> np.ptp(minkowski_difference(cube, 2 * cube).corners, axis=0).round(9).tolist()
    [3.0, 3.0, 3.0]
    """
    from scipy.spatial import ConvexHull

    points = (P[:, None] - Q[None]).reshape(-1, 3)
    middle = points.mean(axis=0)
    hull = ConvexHull(points - middle, qhull_options="Qt Q12")
    normal, found = hull.equations[:, :3], []
    for k in range(3):  # the side of every triangle opposite to a corner, and the triangle beyond it
        other = hull.neighbors[:, k]
        bent = np.linalg.norm(normal - normal[other], axis=1) > FLAT
        once = bent & (other > np.arange(len(other)))
        found.append(np.delete(hull.simplices[once], k, axis=1))
    kept, numbers = np.unique(np.vstack(found), return_inverse=True)
    return MinkowskiDifference(points[kept], numbers.reshape(-1, 2).astype(np.int64))


def eroded(solid: MinkowskiDifference, depth: Callable[[Floats], Floats]) -> MinkowskiDifference | None:
    """A convex solid whose faces lie further in; None where next to nothing is left.

    Parameters
    ----------
    solid : MinkowskiDifference
    depth : callable
        Of outward normals (f, 3): how far in these faces lie (f,) [mm], 0 or more.

    Examples
    --------
    >>> cube = np.array([[x, y, z] for x in (0.0, 3.0) for y in (0.0, 3.0) for z in (0.0, 3.0)])
    >>> inner = eroded(minkowski_difference(cube, np.zeros((1, 3))), lambda normals: np.ones(len(normals)))
    >>> inner.corners.min(axis=0).round(9).tolist(), inner.corners.max(axis=0).round(9).tolist()
    ([1.0, 1.0, 1.0], [2.0, 2.0, 2.0])
    >>> eroded(inner, lambda normals: np.full(len(normals), 0.6)) is None
    True
    """
    from scipy.optimize import linprog
    from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

    middle = solid.corners.mean(axis=0)
    faces = ConvexHull(solid.corners - middle, qhull_options="Qt Q12").equations
    inside, least = np.zeros(3), -GRID * float(faces[:, 3].min())
    faces[:, 3] += depth(faces[:, :3])
    if faces[:, 3].max() > -least:
        found = linprog(
            [0, 0, 0, -1.0], np.insert(faces[:, :3], 3, 1.0, axis=1), -faces[:, 3], bounds=[(None, None)] * 4
        )
        if not found.success or found.x[3] <= least:
            return None
        inside = found.x[:3]
    try:
        return minkowski_difference(HalfspaceIntersection(faces, inside).intersections + middle, np.zeros((1, 3)))
    except QhullError:  # flat but for rounding
        return None


def slab_shadow(differences: Sequence[MinkowskiDifference], low: float, high: float) -> shapely.Geometry:
    """Union of the projections along z of what lies between two heights [mm]: of translations there, those that overlap.

    Examples
    --------
    >>> corners = np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]])
    >>> wedge = minkowski_difference(corners, np.zeros((1, 3)))
    >>> round(slab_shadow([wedge], 1.0, 5.0).area, 9)
    0.5
    """
    polygons = []
    for solid in differences:
        z = solid.corners[:, 2]
        if z.min() >= high or z.max() <= low:
            continue
        if solid.is_prism:
            polygons.append(solid.footprint)
            continue
        between = solid.corners[(z >= low) & (z <= high), :2]
        polygons.append(shapely.MultiPoint(np.vstack([between, *(_at(solid, z) for z in (low, high))])).convex_hull)
    return _union(polygons)


def slab_core(differences: Sequence[MinkowskiDifference], low: float, high: float) -> shapely.Geometry:
    """Union of what lies in one solid at all heights between two [mm]: of places, those where it overlaps throughout.

    Examples
    --------
    >>> corners = np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2]])
    >>> wedge = minkowski_difference(corners, np.zeros((1, 3)))
    >>> round(slab_core([wedge], 0.5, 1.0).area, 9)
    0.5
    """
    polygons = []
    for solid in differences:
        z = solid.corners[:, 2]
        if z.min() > low or z.max() < high:
            continue
        if solid.is_prism:
            polygons.append(solid.footprint)
            continue
        ends = (shapely.MultiPoint(_at(solid, level)).convex_hull for level in (low, high))
        polygons.append(shapely.intersection(*ends))
    return _union(polygons)


def _at(solid: MinkowskiDifference, level: float) -> Floats:
    """Where edges of a solid cross a height (k, 2) [mm]."""
    start, end = solid.corners[solid.edges[:, 0]], solid.corners[solid.edges[:, 1]]
    crossed = (start[:, 2] - level) * (end[:, 2] - level) < 0
    start, end = start[crossed], end[crossed]
    share = (level - start[:, 2]) / (end[:, 2] - start[:, 2])
    return np.asarray((start + share[:, None] * (end - start))[:, :2])


def _union(shapes: Sequence[shapely.Geometry]) -> shapely.Geometry:
    """Union of polygons; what is none is left out."""
    polygons = [p for p in shapes if p.geom_type == "Polygon"]
    try:
        return shapely.union_all(polygons)
    except shapely.errors.GEOSException:  # slivers of many facets: on a grid their union is certain
        return shapely.union_all(polygons, grid_size=GRID * max(abs(x) for p in polygons for x in p.bounds))
