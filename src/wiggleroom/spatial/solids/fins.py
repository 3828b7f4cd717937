"""Fins: films of rounding, pairs of opposite faces in one plane, that cuts leave hanging on a solid."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wiggleroom.spatial.solids.convex_hulls import hull_surface
from wiggleroom.spatial.solids.face_planes import face_planes
from wiggleroom.spatial.solids.solid_boolean import solid_of, surface_of

Floats = NDArray[np.float64]

SAME_SOLID = 1e-8
"""Share of the volume by which a solid may differ from the convex one that it is without its fins."""


def convex_without_fins(solid: Any, thin: float) -> Floats | None:
    """Corners (k, 3) [mm] of the convex solid that a solid is without its fins; None where it is none.

    Both faces of a fin lie in one plane, so that their areas cancel there; the other planes bound the solid. What lies behind all of them
    is compared with it by its volume, and by that of what both share.

    Parameters
    ----------
    solid : Manifold
    thin : float [mm]
        Triangles whose corners are nearer to a plane lie in it.
    """
    from scipy.optimize import linprog
    from scipy.spatial import HalfspaceIntersection, QhullError

    planes = _bounding_planes(solid, thin)
    if len(planes) < 4:
        return None
    rows = np.column_stack([planes[:, :3], np.ones(len(planes))])
    deepest = linprog([0, 0, 0, -1], A_ub=rows, b_ub=planes[:, 3], bounds=[(None, None)] * 3 + [(0, None)])
    if deepest.status != 0 or deepest.x[3] <= thin:
        return None
    try:
        behind = HalfspaceIntersection(np.column_stack([planes[:, :3], -planes[:, 3]]), deepest.x[:3])
    except QhullError:
        return None
    corners = np.asarray(behind.intersections)
    if not np.isfinite(corners).all():
        return None
    convex = solid_of(hull_surface(corners))
    volume = solid.volume()
    differs = max(abs(convex.volume() - volume), abs((convex ^ solid).volume() - volume))
    return corners if differs <= SAME_SOLID * volume else None


def _bounding_planes(solid: Any, thin: float) -> Floats:
    """Outward unit normals and offsets (k, 4) of the planes of a solid in which the areas of its faces do not cancel."""
    surface = surface_of(solid)
    normal, level, label = face_planes(surface)
    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    total = np.bincount(label, area, minlength=len(level))
    found: list[Floats] = []
    left = np.ones(len(area), dtype=bool)
    for k in np.argsort(-total).tolist():
        if not left[label == k].any():
            continue
        off = np.abs(surface.vertices @ normal[k] - level[k]) <= thin
        here = left & off[surface.faces].all(axis=1)
        left &= ~here & (label != k)
        net = float((area[here] * np.sign(normal[label[here]] @ normal[k])).sum())
        if abs(net) > thin * np.sqrt(total.sum()):
            found.append(np.sign(net) * np.append(normal[k], level[k]))
    return np.array(found).reshape(-1, 4)
