"""Convex hulls of corners by Qhull: the library of solids loses corners where many lie nearly in one plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.spatial.solids.spatial_model import Surface

Floats = NDArray[np.float64]


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
