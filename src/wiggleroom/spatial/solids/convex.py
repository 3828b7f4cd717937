"""Convex pieces: corners, the normals of their faces and the directions of their edges."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import ConvexPiece

Floats = NDArray[np.float64]

PARALLEL = 1e-9
"""Two unit vectors whose cross product is shorter are parallel."""


MANY_AXES = 64
"""Of more vectors those that are parallel are found by a tree."""


def convex_piece(points: Floats) -> ConvexPiece:
    """Convex hull of points (k, 3) [mm] as a piece.

    Raises
    ------
    ValueError
        If the points lie in a plane.

    Examples
    --------
    >>> piece = convex_piece(np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 2.0) for z in (0.0, 3.0)]))
    >>> len(piece.corners), len(piece.normals), len(piece.edges)
    (8, 3, 3)
    """
    from scipy.spatial import ConvexHull, QhullError

    points = np.asarray(points, dtype=float)
    middle = points.mean(axis=0)
    size = float(np.abs(points - middle).max())
    try:
        hull = ConvexHull((points - middle) / (size or 1.0), qhull_options="Qt Q12")  # Q12: films are no error
    except QhullError:
        raise ValueError("the points lie in a plane") from None
    face = hull.equations[:, :3]
    other = hull.neighbors  # beyond the side that is opposite to each corner
    bent = np.linalg.norm(np.cross(face[:, None], face[other]), axis=2) > 1e-7
    k, i = np.nonzero(bent & (other > np.arange(len(face))[:, None]))
    ends = hull.simplices[k[:, None], np.array([[1, 2], [0, 2], [0, 1]])[i]]
    edges = points[ends[:, 1]] - points[ends[:, 0]]
    corners = np.ascontiguousarray(points[_true_corners(hull)])
    directions = edges / np.linalg.norm(edges, axis=1)[:, None]
    return ConvexPiece(corners, distinct_axes(face, 1e-7), distinct_axes(directions, PARALLEL))


def _true_corners(hull: Any) -> NDArray[np.int64]:
    """Corners where faces of three directions meet; others lie on an edge or inside a face."""
    order = np.argsort(hull.simplices.ravel(), kind="stable")
    corner, first = np.unique(hull.simplices.ravel()[order], return_index=True)
    faces = dict(zip(corner.tolist(), np.split(order // 3, first[1:]), strict=True))
    kept = []
    for v in hull.vertices.tolist():
        normals = hull.equations[faces[v], :3]
        if len(normals) >= 3 and np.linalg.svd(normals, compute_uv=False)[-1] > 1e-7:
            kept.append(v)
    return np.array(kept if len(kept) >= 4 else hull.vertices, dtype=np.int64)


def distinct_axes(vectors: Floats, tolerance: float) -> Floats:
    """Unit vectors (k, 3) without those that are parallel to an earlier one."""
    if len(vectors) <= MANY_AXES:
        few: list[Floats] = []
        for v in vectors:
            if not few or np.linalg.norm(np.cross(np.array(few), v), axis=1).min() > tolerance:
                few.append(v)
        return np.ascontiguousarray(np.array(few))
    from scipy.spatial import KDTree

    whole = np.round(
        vectors / (tolerance / 4)
    )  # those that agree to a quarter of the tolerance are taken together first
    vectors = vectors[np.sort(np.unique(whole + 0.0, axis=0, return_index=True)[1])]
    tree = KDTree(np.vstack([vectors, -vectors]))
    pairs = tree.query_pairs(tolerance, output_type="ndarray") % len(vectors)
    earlier: dict[int, list[int]] = {}
    for one, two in np.unique(np.sort(pairs, axis=1), axis=0).tolist():
        earlier.setdefault(two, []).append(one)
    keep = np.ones(len(vectors), dtype=bool)
    for k in sorted(earlier):
        keep[k] = not keep[earlier[k]].any()
    return np.ascontiguousarray(vectors[keep])


def prism(ring: Floats, low: float, high: float) -> ConvexPiece:
    """Convex polygon (k, 2) [mm], counter-clockwise, extruded from z = low to z = high."""
    k = len(ring)
    corners = np.vstack([np.column_stack([ring, np.full(k, z)]) for z in (low, high)])
    edge = np.roll(ring, -1, axis=0) - ring
    edge /= np.linalg.norm(edge, axis=1)[:, None]
    flat = np.zeros((k, 1))
    normals = np.vstack([[0.0, 0.0, 1.0], np.hstack([edge[:, 1:], -edge[:, :1], flat])])
    edges = np.vstack([[0.0, 0.0, 1.0], np.hstack([edge, flat])])
    return ConvexPiece(corners, distinct_axes(normals, PARALLEL), distinct_axes(edges, PARALLEL))


def cuboid(low: Floats, high: Floats) -> ConvexPiece:
    """Axis-aligned box between two corners (3,) [mm]."""
    x, y, z = np.meshgrid(*np.column_stack([low, high]), indexing="ij")
    return ConvexPiece(np.column_stack([x.ravel(), y.ravel(), z.ravel()]), np.eye(3), np.eye(3))
