"""Where two surfaces are nearest: distances of triangles, all pairs at once."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

AT_ONCE = 100_000
"""Pairs of triangles that are looked at together."""
FLAT = 1e-30
"""A squared length, or a squared product of two, below this is none."""


def nearest_triangles(P: Floats, Q: Floats, reach: float) -> tuple[Ints, Ints, Floats, Floats]:
    """Pairs of triangles of two surfaces whose boxes are no further apart than this, and their nearest points.

    Parameters
    ----------
    P, Q : (t, 3, 3) and (u, 3, 3) float64 [mm]
        Corners.
    reach : float [mm]

    Returns
    -------
    (k,) int64, (k,) int64
        Triangles of P and of Q.
    (k, 3), (k, 3) float64 [mm]
        Nearest points of triangles that do not pass through each other.

    Examples
    --------
    >>> flat = np.array([[[0.0, 0, 0], [2, 0, 0], [0, 2, 0]]])
    >>> _, _, p, q = nearest_triangles(flat, flat + (0.0, 0.0, 0.5), 1.0)
    >>> np.linalg.norm(q - p, axis=1).tolist()
    [0.5]
    """
    pairs = list(_near_boxes(P, Q, reach))
    found = [_nearest_points(P[i], Q[j]) for i, j in pairs]
    if not found:
        none = np.zeros(0, dtype=np.int64)
        return none, none, np.zeros((0, 3)), np.zeros((0, 3))
    i, j = (np.concatenate(column) for column in zip(*pairs, strict=True))
    p, q = (np.concatenate(column) for column in zip(*found, strict=True))
    return i, j, p, q


def _near_boxes(P: Floats, Q: Floats, reach: float) -> Iterator[tuple[Ints, Ints]]:
    """Pairs of triangles whose boxes are no further apart, some at a time."""
    (plow, phigh), (qlow, qhigh) = ((T.min(axis=1), T.max(axis=1)) for T in (P, Q))
    tree = shapely.STRtree(shapely.box(*plow[:, :2].T, *phigh[:, :2].T))
    grown = shapely.box(*(qlow[:, :2] - reach).T, *(qhigh[:, :2] + reach).T)
    j, i = tree.query(grown)
    for first in range(0, len(i), AT_ONCE):
        a, b = i[first : first + AT_ONCE], j[first : first + AT_ONCE]
        apart = np.maximum(np.maximum(plow[a] - qhigh[b], qlow[b] - phigh[a]), 0.0)
        near = np.linalg.norm(apart, axis=1) <= reach
        if near.any():
            yield a[near], b[near]


def _nearest_points(P: Floats, Q: Floats) -> tuple[Floats, Floats]:
    """Nearest points (k, 3) of pairs of triangles (k, 3, 3): a corner and a face, or two edges."""
    best = np.full(len(P), np.inf)
    p, q = np.empty((len(P), 3)), np.empty((len(P), 3))

    def take(one: Floats, other: Floats) -> None:
        length = ((other - one) ** 2).sum(axis=1)
        nearer = length < best
        best[nearer], p[nearer], q[nearer] = length[nearer], one[nearer], other[nearer]

    for k in range(3):
        for m in range(3):
            take(*_of_edges(P[:, k], P[:, (k + 1) % 3], Q[:, m], Q[:, (m + 1) % 3]))
    for k in range(3):
        above, inside = _foot(Q, P[:, k])
        take(P[:, k], np.where(inside[:, None], above, np.inf))
        above, inside = _foot(P, Q[:, k])
        take(np.where(inside[:, None], above, np.inf), Q[:, k])
    return p, q


def _foot(T: Floats, x: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Feet (k, 3) of points on the planes of triangles, and which of them lie in the triangle."""
    normal = np.cross(T[:, 1] - T[:, 0], T[:, 2] - T[:, 0])
    square = np.maximum((normal**2).sum(axis=1), FLAT)
    foot = x - (((x - T[:, 0]) * normal).sum(axis=1) / square)[:, None] * normal
    inside = square > FLAT
    for k in range(3):
        side = np.cross(T[:, (k + 1) % 3] - T[:, k], foot - T[:, k])
        inside &= (side * normal).sum(axis=1) >= 0
    return foot, inside


def _of_edges(a: Floats, b: Floats, c: Floats, d: Floats) -> tuple[Floats, Floats]:
    """Nearest points (k, 3) of edges a-b and c-d.

    Source: Ericson, "Real-Time Collision Detection" (2005), section 5.1.9.
    """
    u, v, w = b - a, d - c, a - c
    uu, uv, vv = ((x * y).sum(axis=1) for x, y in ((u, u), (u, v), (v, v)))
    uw, vw = (u * w).sum(axis=1), (v * w).sum(axis=1)
    uu, vv = np.maximum(uu, FLAT), np.maximum(vv, FLAT)
    square = uu * vv - uv * uv
    s = np.where(square > 1e-14 * uu * vv, np.clip((uv * vw - uw * vv) / np.maximum(square, FLAT), 0.0, 1.0), 0.0)
    t = np.clip((uv * s + vw) / vv, 0.0, 1.0)
    s = np.clip((uv * t - uw) / uu, 0.0, 1.0)
    return a + s[:, None] * u, c + t[:, None] * v
