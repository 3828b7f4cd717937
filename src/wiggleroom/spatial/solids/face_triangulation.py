"""Faces of a surface triangulated anew inside their boundaries, after their corners have moved in their planes."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.model import Surface

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def triangulated_anew(surface: Surface, normal: Floats, label: Ints) -> Surface | None:
    """The surface with every flat face triangulated anew; None where a face is turned over or crosses itself.

    Old triangles inside a flat face may be turned over by a move that leaves the face itself sound.

    Parameters
    ----------
    surface : Surface
        Its corners moved.
    normal : (p, 3) float64
        Of every plane, which the move leaves as it is.
    label : (f,) int64
        Plane of every triangle.
    """
    order = np.argsort(label, kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(label[order])) + 1)
    faces = []
    for group in groups:
        found = _face(surface.vertices, surface.faces[group], normal[label[group[0]]])
        if found is None:
            return None
        faces.append(found)
    return Surface(surface.vertices, np.vstack(faces))


def _face(vertices: Floats, triangles: Ints, normal: Floats) -> Ints | None:
    """Triangles (k, 3) of one flat face, from those it had; None where its boundary is not sound."""
    if len(triangles) == 1:
        a, b, c = vertices[triangles[0]]
        return triangles if np.cross(b - a, c - a) @ normal > 0 else None
    along = vertices[triangles[0, 1]] - vertices[triangles[0, 0]]
    across = np.cross(normal, along)
    flat = vertices @ np.column_stack([along, across])
    rings = _rings(triangles)
    if rings is None:
        return None
    shapes = [shapely.Polygon(flat[ring]) for ring in rings]
    outer = [s for s in shapes if shapely.is_ccw(s.exterior)]
    holes = [s.exterior for s in shapes if not shapely.is_ccw(s.exterior)]
    if len(outer) != 1:
        return None
    whole = shapely.Polygon(outer[0].exterior, holes)
    if not whole.is_valid or whole.area <= 0:
        return None
    corner = {tuple(flat[k]): k for ring in rings for k in ring}
    found = []
    for triangle in shapely.get_parts(shapely.constrained_delaunay_triangles(whole)):
        i, j, k = (corner[point] for point in triangle.exterior.coords[:3])
        found.append((i, j, k) if shapely.is_ccw(triangle.exterior) else (i, k, j))
    return np.array(found, dtype=np.int64)


def _rings(triangles: Ints) -> list[list[int]] | None:
    """Corners along each boundary of a face; None where boundaries meet in a corner."""
    sides = {(i, j) for t in triangles.tolist() for i, j in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))}
    rim = [(i, j) for i, j in sides if (j, i) not in sides]
    following = dict(rim)
    if len(following) < len(rim):
        return None
    rings = []
    while following:
        first, ring = next(iter(following)), []
        k = first
        while k in following:
            ring.append(k)
            k = following.pop(k)
        if k != first:
            return None
        rings.append(ring)
    return rings
