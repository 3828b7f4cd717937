"""Convex pieces inside solids, each grown until the surface stops it.

Where two pieces of a partition meet, a point could pass between them along their common face. Pieces that overlap leave no such seam:
every face that does not lie on the surface is pushed out, in turn, until it meets the surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly, placed_surface
from wiggleroom.drawing.model import Surface
from wiggleroom.spatial.solids.face_planes import shared_edges

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

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


def inner_pieces(assembly: Assembly) -> list[InnerPiece]:
    """Grown pieces of all parts, where they lie at rest."""
    found: list[InnerPiece] = []
    size = assembly.size
    for k, (part, made) in enumerate(zip(assembly.parts, assembly.solids, strict=True)):
        surface = placed_surface(part, made.surface)
        own: list[InnerPiece] = []
        for piece in made.pieces:
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
    """The hull of some corners, grown within a surface; None where it has no inside."""
    from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

    middle = corners.mean(axis=0)
    try:
        equations = ConvexHull(corners - middle).equations
    except QhullError:
        return None
    normals, offsets = _distinct(equations[:, :3], -equations[:, 3], size)
    triangles = surface.vertices[surface.faces] - middle
    margin = MARGIN * size
    offsets = offsets - margin
    for f in range(len(normals)):
        rest = np.arange(len(normals)) != f
        # what of the surface lies before this face, within all others
        most = _first_hit(triangles, normals[rest], offsets[rest] + margin / 2, normals[f], offsets[f])
        if np.isfinite(most):
            offsets[f] = max(offsets[f], most - margin)
    try:
        cut = HalfspaceIntersection(np.column_stack([normals, -offsets]), np.zeros(3))
    except QhullError:
        return None
    points = _distinct_points(cut.intersections, SAME * size)
    touched = ((points @ normals.T) > offsets - SAME * size).sum(axis=0) >= 3
    normals, offsets = normals[touched], offsets[touched]
    return InnerPiece(part, normals, offsets + normals @ middle, points + middle)


def _first_hit(triangles: Floats, normals: Floats, offsets: Floats, along: Floats, least: float) -> float:
    """The least extent along a direction, above `least`, of what of triangles (k, 3, 3) lies within half-spaces."""
    high = triangles @ along
    some = triangles[high.max(axis=1) > least]
    outside = ((some @ normals.T) >= offsets).all(axis=1).any(axis=1)
    best = np.inf
    for triangle in some[~outside]:
        polygon = triangle
        for n, h in zip(normals, offsets, strict=True):
            polygon = _clipped(polygon, n, h)
            if not len(polygon):
                break
        if len(polygon):
            best = min(best, float((polygon @ along).min()))
    return best


def _clipped(polygon: Floats, normal: Floats, offset: float) -> Floats:
    """What of a convex polygon (k, 3) lies on the inner side of a plane."""
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


def _distinct(normals: Floats, offsets: Floats, size: float) -> tuple[Floats, Floats]:
    """Planes of a hull, each once."""
    kept: list[int] = []
    for k in range(len(normals)):
        if not any(
            np.abs(normals[k] - normals[j]).max() < 1e-7 and abs(offsets[k] - offsets[j]) < SAME * size for j in kept
        ):
            kept.append(k)
    return normals[kept], offsets[kept]


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
