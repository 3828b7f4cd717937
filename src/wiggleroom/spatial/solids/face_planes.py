"""Planes in which the faces of a surface lie."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import Surface

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FLAT = 1e-7
"""Faces whose normals differ by less and that share an edge lie in one plane [rad]."""


def face_planes(surface: Surface) -> tuple[Floats, Floats, Ints]:
    """Unit normals (f, 3) and offsets (f,) [mm] of the planes of all faces, and the plane of each face."""
    import scipy.sparse as sp  # slow to import, and seldom needed
    from scipy.sparse.csgraph import connected_components

    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    area = np.linalg.norm(cross, axis=1)
    normal = cross / np.maximum(area, 1e-300)[:, None]
    pairs = shared_edges(surface)[1]
    flat = np.linalg.norm(normal[pairs[:, 0]] - normal[pairs[:, 1]], axis=1) < FLAT
    links = sp.coo_matrix((np.ones(flat.sum()), pairs[flat].T), shape=(len(area), len(area)))
    count, label = connected_components(links, directed=False)
    total = np.zeros((count, 3))
    np.add.at(total, label, cross)
    unit = total / np.maximum(np.linalg.norm(total, axis=1), 1e-300)[:, None]
    level = np.full(count, -np.inf)
    np.maximum.at(level, label, np.einsum("ij,ij->i", unit[label], a))
    return unit, level, label


def shared_edges(surface: Surface) -> tuple[Ints, Ints]:
    """Both corners (e, 2) of every edge, in the order of its first face, and both faces (e, 2)."""
    sides = np.vstack([surface.faces[:, [0, 1]], surface.faces[:, [1, 2]], surface.faces[:, [2, 0]]])
    order = np.lexsort(np.sort(sides, axis=1).T)
    face = np.tile(np.arange(len(surface.faces)), 3)
    return sides[order][::2], face[order].reshape(-1, 2)


def lies_in(triangles: Floats, point: Floats, near: float) -> bool:
    """True where a point of the plane of triangles (k, 3, 3) lies in one of them, or within `near` of it."""
    a, b, c = triangles.transpose(1, 0, 2)
    cross = np.cross(b - a, c - a)
    area = np.linalg.norm(cross, axis=1)
    unit = cross / np.maximum(area, 1e-300)[:, None]
    inside = np.ones(len(a), dtype=bool)
    for start, end in ((a, b), (b, c), (c, a)):
        side = np.cross(unit, end - start)
        length = np.maximum(np.linalg.norm(side, axis=1), 1e-300)
        inside &= np.einsum("ij,ij->i", side, point - start) / length > -near
    return bool((inside & (area > 0)).any())
