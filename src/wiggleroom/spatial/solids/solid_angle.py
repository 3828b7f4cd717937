"""Solid angles of triangles, and winding numbers of surfaces round points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def solid_angles(a: Floats, b: Floats, c: Floats) -> Floats:
    """Signed solid angles (...) of triangles with corners (..., 3) seen from the origin [sr].

    Source: van Oosterom and Strackee, "The solid angle of a plane triangle" (1983).

    Examples
    --------
    >>> x, y, z = np.eye(3)[:, None]
    >>> float(solid_angles(x, y, z)[0] / np.pi)
    0.5
    """
    x, y, z = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
    volume = (a * np.cross(b, c)).sum(axis=-1)
    below = x * y * z + (a * b).sum(axis=-1) * z + (b * c).sum(axis=-1) * x + (c * a).sum(axis=-1) * y
    return np.asarray(2 * np.arctan2(volume, below))


def winding_numbers(triangles: Floats, points: Floats) -> Floats:
    """How often triangles (f, 3, 3) that close, looking outward, go round each of some points (k, 3).

    Examples
    --------
    >>> corners = np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
    >>> tetrahedron = corners[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]
    >>> winding_numbers(tetrahedron, np.array([(0.1, 0.1, 0.1), (1.0, 1, 1)])).round(9).tolist()
    [1.0, 0.0]
    """
    angles = [solid_angles(*(triangles - point).transpose(1, 0, 2)).sum() for point in points]
    return np.array(angles, dtype=float) / (4 * np.pi)
