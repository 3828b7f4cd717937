"""Convex hulls of corners by Qhull: the library of solids loses corners where many lie nearly in one plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import Surface

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MOST_PAIRS = 20_000_000
"""Surfaces that need more comparisons of triangles with faces of their hull are not compared."""


def hull_volume(points: Floats) -> float:
    """Volume [mm3] of the convex hull of points (k, 3) [mm]; 0 where they lie in a plane.

    Examples
    --------
    >>> round(hull_volume(np.array([[0.0, 0, 0], [6, 0, 0], [0, 1, 0], [0, 0, 1]])), 9)
    1.0
    """
    from scipy.spatial import ConvexHull, QhullError

    try:
        return float(ConvexHull(points - points.mean(axis=0), qhull_options="Qt Q12").volume)
    except (QhullError, ValueError):
        return 0.0


def hull_surface(points: Floats) -> Surface:
    """Surface of the convex hull of points (k, 3) [mm], its faces outward.

    Examples
    --------
    >>> hull_surface(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.2, 0.2, 0.2]])).faces.shape
    (4, 3)
    """
    from scipy.spatial import ConvexHull

    hull = ConvexHull(points, qhull_options="Qt Q12")
    a, b, c = (points[hull.simplices[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    faces = hull.simplices.astype(np.int64)
    faces[inward] = faces[inward][:, ::-1]
    kept, numbers = np.unique(faces, return_inverse=True)
    return Surface(np.ascontiguousarray(points[kept]), numbers.reshape(-1, 3).astype(np.int64))


def filled_up(surface: Surface, least: float) -> tuple[Surface, float] | None:
    """The hull of a closed surface, and how much deeper that lies at most [mm]; None where this may be more than `least` [mm].

    How deep a point lies below a hull is a concave function, so that on a triangle it is at most three times what it is in the middle.
    Where no point of the surface lies deeper, no point that does lies outside the solid.

    Examples
    --------
    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.3, 0.3, 0.399]])
    >>> dented = Surface(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 4], [2, 3, 4], [3, 1, 4]]))
    >>> filled_up(dented, 1e-4) is None, filled_up(dented, 0.01)[1] < 0.002
    (True, True)
    """
    from scipy.spatial import ConvexHull, KDTree, QhullError

    corners = surface.vertices - surface.vertices.mean(axis=0)
    try:
        hull = ConvexHull(corners, qhull_options="Qt Q12")
    except (QhullError, ValueError):
        return None
    triangles = corners[surface.faces]
    volume = float(np.einsum("ij,ij->", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2]))) / 6
    shell = least * hull.area
    if hull.volume - volume > shell or volume <= shell:
        return None
    at = hull.vertices[
        KDTree(corners[hull.vertices]).query(corners)[1]
    ]  # the corner of the hull that is nearest to each corner
    order = np.argsort(hull.simplices.ravel(), kind="stable")
    first = np.searchsorted(hull.simplices.ravel()[order], np.arange(len(corners) + 1))
    meet = np.diff(first)
    if meet[at[surface.faces]].sum() > MOST_PAIRS:
        return None
    middles = triangles.mean(axis=1)
    deep = np.full(len(middles), np.inf)
    for around in at[surface.faces].T:
        count = meet[around]
        who = np.repeat(np.arange(len(middles)), count)
        rank = np.arange(len(who)) - np.repeat(np.cumsum(count) - count, count)
        face = hull.equations[order[first[around][who] + rank] // 3]
        np.minimum.at(deep, who, -np.einsum("ij,ij->i", face[:, :3], middles[who]) - face[:, 3])
    deepest = 3 * float(deep.max())
    return (hull_surface(surface.vertices), deepest) if deepest <= least else None
