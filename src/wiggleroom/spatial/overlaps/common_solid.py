"""What two solids have in common: how deep they are in each other there, and where."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.overlaps import CONVEX
from wiggleroom.drawing.model import Surface
from wiggleroom.spatial.overlaps.surface_distance import surface_distances
from wiggleroom.spatial.solids.convex_hulls import hull_volume
from wiggleroom.spatial.solids.solid_angle import winding_numbers
from wiggleroom.spatial.solids.solid_boolean import centroid_of, volume_of

Floats = NDArray[np.float64]

MAX_STARTS = 200
"""Faces of a piece, the largest first, below whose middles a ball is begun."""
MAX_CORNERS = 1000
"""The least width of a convex piece of more corners is one across a face."""
MAX_STEPS = 30
"""A ball grows in so many steps at most."""
SETTLED = 1e-9
"""A ball that grows by less than this share has settled."""


@dataclass(frozen=True, eq=False)
class CommonPiece:
    """A piece of the solid that two parts share.

    Parameters
    ----------
    depth : float [mm]
        Of a convex piece the least width, else the diameter of the largest ball found in it.
    middle : (3,) float64 [mm]
        The centroid, else the middle of the ball.
    across : (3,) float64 or None
        Unit vector along which a convex piece is so wide, of either sign.
    """

    depth: float
    middle: Floats
    across: Floats | None


def common_piece(surface: Surface) -> CommonPiece:
    """Depth and place of a piece of overlap with this boundary.

    Examples
    --------
    >>> import manifold3d
    >>> from wiggleroom.spatial.solids.solid_boolean import surface_of
    >>> slab = manifold3d.Manifold.cube((4, 3, 0.5))
    >>> frame = manifold3d.Manifold.cube((4, 4, 4), True) - manifold3d.Manifold.cube((3, 3, 5), True)
    >>> [round(common_piece(surface_of(one)).depth, 6) for one in (slab, frame)]
    [0.5, 0.5]
    """
    width, normal = least_width(surface)
    if width == 0 or volume_of(surface) >= (1 - CONVEX) * hull_volume(surface.vertices):
        if width == 0:
            return CommonPiece(0.0, surface.vertices.mean(axis=0), normal)
        if len(surface.vertices) <= MAX_CORNERS:
            width, normal = hull_width(surface.vertices)
        return CommonPiece(width, centroid_of(surface)[1], normal)
    middle, radius = largest_ball(surface)
    return CommonPiece(min(width, 2 * radius), middle, None)


def least_width(surface: Surface) -> tuple[float, Floats]:
    """Least width of a solid across one of its faces [mm], and the unit normal (3,) of that face."""
    corners = surface.vertices[surface.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normal, axis=1)
    if not (area > 0).any():
        return 0.0, np.array([0.0, 0.0, 1.0])
    unit = normal[area > 0] / area[area > 0, None]
    width = np.ptp(surface.vertices @ unit.T, axis=0)
    return float(width.min()), unit[width.argmin()]


def hull_width(points: Floats) -> tuple[float, Floats]:
    """Least width of the hull of points (k, 3) [mm], and the unit vector (3,) across: that of a face, or of two edges.

    Points that are apart by a vector of the hull of all differences are in the hull; its nearest face is as far away as the hull is wide.

    Examples
    --------
    >>> edges = np.array([[-1.0, 0, 0], [1, 0, 0], [0, -1, 0.7], [0, 1, 0.7]])
    >>> round(hull_width(edges)[0], 9)
    0.7
    """
    from scipy.spatial import ConvexHull

    corners = points[ConvexHull(points).vertices]
    faces = ConvexHull((corners[:, None] - corners[None]).reshape(-1, 3), qhull_options="Qt Q12").equations
    nearest = faces[faces[:, 3].argmax()]
    return float(-nearest[3]), nearest[:3]


def largest_ball(surface: Surface) -> tuple[Floats, float]:
    """Middle (3,) and radius [mm] of the largest ball that was found inside a closed surface.

    Balls begin halfway to the wall that is opposite to a face, and grow while the planes that touch them leave room.
    """
    triangles = surface.vertices[surface.faces]
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = np.linalg.norm(normal, axis=1)
    faces = np.argsort(-area, kind="stable")[:MAX_STARTS]
    faces = faces[area[faces] > 0]
    inward = -normal[faces] / area[faces, None]
    start = triangles[faces].mean(axis=1)
    starts = np.array([x + _opposite(triangles, x, way) / 2 * way for x, way in zip(start, inward, strict=True)])
    radius = surface_distances(triangles, starts, np.empty_like(starts))
    radius[winding_numbers(triangles, starts) < 0.5] = 0.0  # films that belong to the piece are missed
    best = int(radius.argmax())
    return _grown(triangles, starts[best], float(radius[best]))


def _opposite(triangles: Floats, start: Floats, way: Floats) -> float:
    """How far it is from a point on a surface along a unit vector to the next wall [mm]; 0 where there is none."""
    a, u, v = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normal = np.cross(u, v)
    speed = normal @ way
    leaves = speed > 0
    a, u, v, normal, speed = a[leaves], u[leaves], v[leaves], normal[leaves], speed[leaves]
    far = ((a - start) * normal).sum(axis=1) / speed
    hit = start + far[:, None] * way - a
    square = (normal**2).sum(axis=1)
    s = (np.cross(hit, v) * normal).sum(axis=1) / square
    t = (np.cross(u, hit) * normal).sum(axis=1) / square
    through = (s >= -SETTLED) & (t >= -SETTLED) & (s + t <= 1 + SETTLED) & (far > 0)
    return float(far[through].min(initial=np.inf)) if through.any() else 0.0


def _grown(triangles: Floats, middle: Floats, radius: float) -> tuple[Floats, float]:
    """A ball moved to where it is largest nearby: each time to the middle of the largest ball between planes across its nearest places."""
    from scipy.optimize import linprog

    step = radius
    for _ in range(MAX_STEPS):
        near, out = _walls(triangles, middle, radius + 2 * step)
        rows = np.column_stack([-out, np.ones(len(out))])
        room = linprog([0, 0, 0, -1.0], rows, near, bounds=[(-step, step)] * 3 + [(None, None)])
        if room.status != 0:
            break
        there = middle + room.x[:3]
        grown = float(surface_distances(triangles, there[None], np.empty((1, 3)))[0])
        if grown <= radius * (1 + SETTLED) or winding_numbers(triangles, there[None])[0] < 0.5:
            step /= 2
            if step < SETTLED * radius:
                break
            continue
        middle, radius = there, grown
    return middle, radius


def _walls(triangles: Floats, middle: Floats, reach: float) -> tuple[Floats, Floats]:
    """Distances (k,) [mm] of triangles that are near a point, and unit vectors (k, 3) from them to it."""
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    beside = np.linalg.norm(np.maximum(np.maximum(low - middle, middle - high), 0.0), axis=1) <= reach
    chosen = triangles[beside]
    out, near = np.empty((len(chosen), 3)), np.empty(len(chosen))
    for k in range(len(chosen)):
        near[k] = surface_distances(chosen[k : k + 1], middle[None], out[k : k + 1])[0]
    return near, out
