"""How the corners of convex pieces move when all faces of their solid move inward."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from wiggleroom.drawing.model import MadeSolid
from wiggleroom.spatial.solids.face_planes import face_planes, lies_in

Floats = NDArray[np.float64]

ON_PLANE = 1e-7
"""A corner nearer to a face than this share of the solid's size lies on it."""


def corner_displacements(made: MadeSolid, piece: int) -> Floats:
    """Displacement (k, 3) of the corners of a piece for each mm that all faces of its solid move inward.

    A corner follows the faces of the solid that it lies on, and those faces of its piece that lie in a face of the solid; along
    directions that none of these fixes it stays. Steps where a joint's own gap ends stay where they are.

    Source: the mitred offset, as for the corners of outlines in `wiggleroom.geometry.offset_bodies`.
    """
    normal, level, label = face_planes(made.surface)
    triangles = made.surface.vertices[made.surface.faces]
    size = float(np.ptp(made.surface.vertices, axis=0).max())
    near = ON_PLANE * size
    corners = made.pieces[piece].corners
    hull = ConvexHull(corners)
    own = np.unique(hull.equations.round(12), axis=0)
    inward = np.full(len(normal), -1.0)
    for n0, n1, n2, offset in made.steps.tolist():
        inward[(normal @ np.array([n0, n1, n2]) > 1 - 1e-9) & (np.abs(level - offset) < near)] = 0.0
    out = np.zeros_like(corners)
    for k, corner in enumerate(corners):
        on = np.abs(normal @ corner - level) < near
        touched = [p for p in np.flatnonzero(on).tolist() if lies_in(triangles[label == p], corner, near)]
        for n0, n1, n2, offset in own[np.abs(own[:, :3] @ corner + own[:, 3]) < near].tolist():
            same = (normal @ np.array([n0, n1, n2]) > 1 - 1e-9) & (np.abs(level + offset) < near)
            touched += np.flatnonzero(same).tolist()
        if touched:
            out[k] = np.linalg.lstsq(normal[touched], inward[touched], rcond=1e-6)[0]
    return out
