"""Corners of bodies near edges of others, and how their distances change with small motions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.geometry.bodies import Bodies

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class NearCorners:
    """Corners of bodies near edges of others.

    Parameters
    ----------
    who : (m, 2) int64
        The body whose corner it is, and the one whose edge it is.
    gradient : (m, 2, 3) float64
        Derivatives of the distance by their motions.
    distance : (m,) float64 [mm]
    """

    who: Ints
    gradient: Floats
    distance: Floats


def corners_near_edges(bodies: Bodies, pairs: Sequence[Sequence[int]], pose: Floats, reach: float) -> NearCorners:
    """Corners of either body of some pairs nearer than `reach` [mm] to an edge of the other, each with the nearest edge.

    Parameters
    ----------
    bodies : Bodies
    pairs : sequence of a, b
    pose : (n, 3) float64 [mm, mm, rad]
        Of all bodies.
    reach : float [mm]
    """
    found: list[NearCorners] = []
    for a, b in pairs:
        apart = np.hypot(*(pose[a, :2] - pose[b, :2])) - bodies.radius[a] - bodies.radius[b]
        if apart <= reach:
            found += [_corners_at_edges(bodies, a, b, pose, reach), _corners_at_edges(bodies, b, a, pose, reach)]
    return joined_corners(found)


def joined_corners(found: Sequence[NearCorners]) -> NearCorners:
    """All of them as one."""
    none = NearCorners(np.zeros((0, 2), dtype=np.int64), np.zeros((0, 2, 3)), np.zeros(0))
    found = [none, *found]
    return NearCorners(
        np.concatenate([one.who for one in found]),
        np.concatenate([one.gradient for one in found]),
        np.concatenate([one.distance for one in found]),
    )


def _corners_at_edges(bodies: Bodies, a: int, b: int, pose: Floats, reach: float) -> NearCorners:
    """Corners of a that lie nearer than `reach` to an edge of b, each with the nearest of b's edges."""
    p, begin = _corners(bodies, a, pose[a]), _corners(bodies, b, pose[b])
    shapes = bodies.shapes
    row = slice(shapes.first[bodies.shape[b]], shapes.first[bodies.shape[b] + 1])
    end = begin[shapes.after[row] - row.start]
    low, high = begin.min(axis=0) - reach, begin.max(axis=0) + reach
    p = p[((p > low) & (p < high)).all(axis=1)]
    along = end - begin
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    x, y = p[:, 0, None] - begin[:, 0], p[:, 1, None] - begin[:, 1]
    t = np.clip((x * along[:, 0] + y * along[:, 1]) / square, 0.0, 1.0)
    x -= t * along[:, 0]
    y -= t * along[:, 1]
    edge = (x * x + y * y).argmin(axis=1)
    nearest = np.arange(len(p)), edge
    away = np.column_stack([x[nearest], y[nearest]])
    distance = np.hypot(away[:, 0], away[:, 1])
    near = distance <= reach
    p, away, distance, edge = p[near], away[near], distance[near], edge[near]
    outward = np.column_stack([along[edge, 1], -along[edge, 0]]) / np.sqrt(square[edge])[:, None]
    touching = distance <= 1e-9 * reach
    normal = np.where(touching[:, None], outward, away / np.where(touching, 1.0, distance)[:, None])
    arm = (p - away)[:, None] - pose[[a, b], :2]
    turn = normal[:, None, 1] * arm[..., 0] - normal[:, None, 0] * arm[..., 1]
    gradient = np.concatenate([np.broadcast_to(normal[:, None], arm.shape), turn[..., None]], axis=2)
    return NearCorners(np.tile([a, b], (len(p), 1)), gradient * np.array([1.0, -1.0])[:, None], distance)


def _corners(bodies: Bodies, body: int, pose: Floats) -> Floats:
    shapes = bodies.shapes
    c, s = np.cos(pose[2]), np.sin(pose[2])
    corner = shapes.corner[shapes.first[bodies.shape[body]] : shapes.first[bodies.shape[body] + 1]]
    return corner @ np.array([[c, s], [-s, c]]) + pose[:2]
