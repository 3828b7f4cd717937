"""Cylinders inside a solid round one axis: what of it stays where it was, however it turns about the axis."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import ConvexPiece, Surface
from wiggleroom.spatial.solids.convex import prism

Floats = NDArray[np.float64]

SIDES = 16
"""A cylinder is a prism of so many sides inside it."""
SAME_LEVEL = 1e-6
"""Corners at levels that differ by a smaller share of the height are at one, but for rounding."""
THIN = 1e-3
"""Cylinders of a smaller share of the largest radius are left out."""


def inscribed_cylinders(surface: Surface) -> list[ConvexPiece]:
    """Prisms inside a closed surface, all inside cylinders round the z axis.

    Between two levels of corners the radius is that of the nearest point of the surface. A cylinder goes on through all neighbouring
    levels where there is room for it.

    Examples
    --------
    >>> import itertools
    >>> corners = np.array(list(itertools.product((-1.0, 1.0), (-2.0, 2.0), (0.0, 5.0))))
    >>> faces = [[0, 1, 3], [0, 3, 2], [4, 7, 5], [4, 6, 7], [0, 5, 1], [0, 4, 5], [2, 3, 7], [2, 7, 6], [0, 6, 4], [0, 2, 6]]
    >>> faces += [[1, 5, 7], [1, 7, 3]]
    >>> (cylinder,) = inscribed_cylinders(Surface(corners, np.array(faces)))
    >>> np.ptp(cylinder.corners, axis=0).round(9).tolist()
    [2.0, 2.0, 5.0]
    """
    triangles = surface.vertices[surface.faces]
    levels = np.sort(surface.vertices[:, 2])
    rounding = SAME_LEVEL * float(np.ptp(levels))
    first = np.diff(levels, prepend=-np.inf) > rounding
    last = np.append(first[1:], True)
    between = zip(levels[last] + rounding, levels[first][1:] - rounding, strict=False)
    radius = np.array([_free_radius(triangles, low, high) for low, high in between])
    turn = 2 * np.pi * np.arange(SIDES) / SIDES
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    found: dict[tuple[int, int], float] = {}
    for r in np.unique(radius[radius > THIN * radius.max(initial=0.0)]).tolist():
        room = np.flatnonzero(np.diff(np.concatenate([[False], radius >= r, [False]])))
        found |= {(int(k), int(m)): r for k, m in room.reshape(-1, 2)}  # of one length the widest
    return [prism(r * circle, float(levels[last][k]), float(levels[first][m])) for (k, m), r in found.items()]


def _free_radius(triangles: Floats, low: float, high: float) -> float:
    """Distance from the z axis [mm] of the nearest point of triangles (t, 3, 3) between two levels; 0 where the axis is outside."""
    middle = (low + high) / 2
    if _winding(triangles, middle) < 0.5:
        return 0.0
    near = np.inf
    for triangle in triangles[(triangles[:, :, 2].max(axis=1) > low) & (triangles[:, :, 2].min(axis=1) < high)]:
        flat = _clipped(_clipped(triangle, low, 1.0), high, -1.0)[:, :2]
        if len(flat) > 1:
            near = min(near, _distance_from_origin(flat))
    return float(near) if np.isfinite(near) else 0.0


def _winding(triangles: Floats, level: float) -> float:
    """How often closed triangles go round the point of the z axis at a level: their solid angle, by van Oosterom and Strackee 1983."""
    a, b, c = (triangles[:, k] - [0.0, 0.0, level] for k in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    volume = np.einsum("td,td->t", a, np.cross(b, c))
    below = la * lb * lc + np.einsum("td,td->t", a, b) * lc
    below += np.einsum("td,td->t", b, c) * la + np.einsum("td,td->t", c, a) * lb
    return float(2 * np.arctan2(volume, below).sum() / (4 * np.pi))


def _clipped(polygon: Floats, level: float, sign: float) -> Floats:
    """The part of a polygon (k, 3) above a level, or below it where the sign is negative."""
    kept: list[Floats] = []
    for one, two in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        s, t = sign * (one[2] - level), sign * (two[2] - level)
        if s >= 0:
            kept.append(one)
        if s * t < 0:
            kept.append(one + s / (s - t) * (two - one))
    return np.array(kept).reshape(-1, 3)


def _distance_from_origin(polygon: Floats) -> float:
    """Distance of the origin from a convex polygon (k, 2), 0 inside."""
    ahead = np.roll(polygon, -1, axis=0)
    edge = ahead - polygon
    side = edge[:, 0] * polygon[:, 1] - edge[:, 1] * polygon[:, 0]
    if len(polygon) > 2 and ((side > 0).all() or (side < 0).all()):
        return 0.0
    length = np.maximum((edge**2).sum(axis=1), 1e-300)
    share = np.clip(-(polygon * edge).sum(axis=1) / length, 0.0, 1.0)
    return float(np.linalg.norm(polygon + share[:, None] * edge, axis=1).min())
