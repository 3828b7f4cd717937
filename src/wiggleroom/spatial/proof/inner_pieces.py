"""Convex pieces inside solids, each as large as the surface lets it be.

Where two pieces of a partition meet, a point could pass between them along their common face. Pieces that overlap leave no such seam:
each is cut off only by planes that leave triangles of the surface outside.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, placed_surface
from wiggleroom.drawing.model import Surface
from wiggleroom.errors import Stop
from wiggleroom.spatial.solids.face_planes import face_planes, shared_edges

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Plane = tuple[Floats, float]
"""A unit normal and an offset [mm]."""

MARGIN = 1e-9
"""Pieces stay this share of the size inside the surface, so that exact arithmetic finds them inside."""
SAME = 1e-7
"""Corners and faces that differ by less than this share of the size are the same."""


@dataclass(frozen=True, eq=False)
class InnerPiece:
    """All x with normals @ x <= offsets: a polytope inside one solid.

    Parameters
    ----------
    part : int
    normals : (f, 3) float64
    offsets : (f,) float64 [mm]
    corners : (k, 3) float64 [mm]
        About where faces meet.
    """

    part: int
    normals: Floats
    offsets: Floats
    corners: Floats

    def drawn_in(self, points: Floats, by: float) -> Floats:
        """Points (k, 3) near the piece moved inside, at least `by` [mm] from every face, where that is possible."""
        middle = self.corners.mean(axis=0)
        room = self.offsets - self.normals @ middle
        out = (points - middle) @ self.normals.T
        share = np.min(np.where(out > 0, (room - by) / np.maximum(out, 1e-300), np.inf), axis=1)
        return np.asarray(middle + np.minimum(share, 1.0)[:, None] * (points - middle))


def inner_pieces(assembly: Assembly, stop: Stop) -> list[InnerPiece]:
    """Grown pieces of all parts, where they lie at rest; fewer where it was asked to stop."""
    found: list[InnerPiece] = []
    size = assembly.size
    for k, (part, made) in enumerate(zip(assembly.parts, assembly.solids, strict=True)):
        surface = placed_surface(part, made.surface)
        own: list[InnerPiece] = []
        for piece in made.pieces:
            if stop.is_set():
                break
            corners = piece.corners @ part.R.T + part.at
            grown = _grown(k, corners, surface, size)
            if grown is not None and not any(_same(grown, other, size) for other in own):
                own.append(grown)
        found += own
    return found


def _same(one: InnerPiece, other: InnerPiece, size: float) -> bool:
    """Whether a piece lies in another one."""
    return bool(((one.corners @ other.normals.T) <= other.offsets + SAME * size).all())


def _grown(part: int, corners: Floats, surface: Surface, size: float) -> InnerPiece | None:
    """A polytope within a surface that holds the hull of some corners, as large as may be; None where the hull has no inside.

    Planes that leave triangles of the surface outside are added, that of the nearest triangle first, until none is left inside.
    """
    from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

    middle = corners.mean(axis=0)
    try:
        hull = ConvexHull(corners - middle)
    except QhullError:
        return None
    corners = hull.points[hull.vertices]
    sides = _distinct(hull.equations[:, :3])
    triangles = surface.vertices[surface.faces] - middle
    unit, _, label = face_planes(surface)
    level = np.full(len(unit), np.inf)  # faces are flat up to rounding: the lowest corner
    np.minimum.at(level, label, np.einsum("ikj,ij->ik", triangles, unit[label]).min(axis=1))
    unit, level = unit[label], level[label]
    box = np.maximum(np.maximum(triangles.min(axis=1), -triangles.max(axis=1)), 0.0)
    away = np.maximum(np.linalg.norm(box, axis=1), np.abs(level))
    away[(unit @ corners.T).max(axis=1) > level + SAME * size] += 10 * size  # those whose own plane cuts the hull last
    near = MARGIN / 2 * size
    normals, offsets = np.zeros((0, 3)), np.zeros(0)
    left = np.ones(len(triangles), dtype=bool)
    while left.any():
        k = int(np.where(left, away, np.inf).argmin())
        left[k] = False
        if not _reaches(triangles[k], normals, offsets - near):
            continue
        plane = _between(corners, sides, triangles[k], (unit[k], level[k]), SAME * size)
        if plane is None:
            return None
        normals, offsets = np.vstack([normals, plane[0]]), np.append(offsets, plane[1])
        left &= ~((triangles @ plane[0]) >= plane[1] - near).all(axis=1)
    offsets = offsets - MARGIN * size
    try:
        cut = HalfspaceIntersection(np.column_stack([normals, -offsets]), np.zeros(3))
    except QhullError:
        return None
    points = _distinct_points(cut.intersections, SAME * size)
    touched = ((points @ normals.T) > offsets - SAME * size).sum(axis=0) >= 3
    normals, offsets = normals[touched], offsets[touched]
    return InnerPiece(part, normals, offsets + normals @ middle, points + middle)


def _between(corners: Floats, sides: Floats, triangle: Floats, own: Plane, near: float) -> Plane | None:
    """A plane with a triangle beyond it and a hull of corners behind it, up to `near`: that of the triangle, of a side, or along edges."""
    if ((corners @ own[0]) <= own[1] + near).all():
        return own
    edges = np.cross(*sides[np.array(np.triu_indices(len(sides), 1))])
    crossed = np.cross((triangle - np.roll(triangle, 1, axis=0))[:, None], edges).reshape(-1, 3)
    long = np.linalg.norm(crossed, axis=1)
    crossed = crossed[long > 1e-9 * long.max()] / long[long > 1e-9 * long.max(), None]
    for normals in (sides, np.vstack([crossed, -crossed])):
        level = (triangle @ normals.T).min(axis=0)
        beyond = level - (corners @ normals.T).max(axis=0)
        best = int(beyond.argmax())
        if beyond[best] >= -near:
            return normals[best], level[best]
    return None


def _reaches(triangle: Floats, normals: Floats, offsets: Floats) -> bool:
    """Whether a triangle has a part inside half-spaces."""
    polygon = triangle
    for n, h in zip(normals, offsets, strict=True):
        polygon = clipped(polygon, n, h)
        if not len(polygon):
            return False
    return True


def clipped(polygon: Floats, normal: Floats, offset: float) -> Floats:
    """What of a convex polygon (k, n) lies where normal @ x <= offset, in space or in the plane."""
    side = polygon @ normal - offset
    if (side <= 0).all():
        return polygon
    if (side >= 0).all():
        return polygon[:0]
    found = []
    for i in range(len(polygon)):
        j = i - 1
        if (side[i] < 0 < side[j]) or (side[j] < 0 < side[i]):
            t = side[j] / (side[j] - side[i])
            found.append(polygon[j] + t * (polygon[i] - polygon[j]))
        if side[i] <= 0:
            found.append(polygon[i])
    return np.array(found)


def _distinct(normals: Floats) -> Floats:
    """Normals (k, 3) of a hull, each once."""
    return normals[np.unique(normals.round(7), axis=0, return_index=True)[1]]


def _distinct_points(points: Floats, near: float) -> Floats:
    """Points (k, 3), those that are nearer to each other than `near` once."""
    kept: list[int] = []
    for k in range(len(points)):
        if not kept or np.abs(points[kept] - points[k]).max(axis=1).min() > near:
            kept.append(k)
    return points[kept]


def bent_edges(surface: Surface) -> Floats:
    """Ends (k, 2, 3) of the edges of a surface at which it bends [mm]."""
    a, b, c = surface.vertices[surface.faces].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    normal = normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    ends, faces = shared_edges(surface)
    bent = (normal[faces[:, 0]] * normal[faces[:, 1]]).sum(axis=1) < 1 - 1e-9
    return surface.vertices[ends[bent]]
