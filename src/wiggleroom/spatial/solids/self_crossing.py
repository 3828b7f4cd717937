"""Where a closed surface crosses itself."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.drawing.model import Surface
from wiggleroom.errors import Stop, go_on

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

BATCH = 4000
"""Triangles that are compared with those near them together."""
MOST_PAIRS = 30_000_000
"""Surfaces of which the boxes round more pairs of triangles meet are not looked at."""


def self_crossing(surface: Surface, near: float, stop: Stop | None = None) -> Floats | None:
    """A point (3,) [mm] where an edge of a surface goes through a triangle of the same shell; None where none does.

    Parameters
    ----------
    near : float [mm]
        Edges that end nearer to the triangle, or go through nearer to its border, do not count: they touch it but for rounding.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    faces, triangles = surface.faces, surface.vertices[surface.faces]
    ends = np.concatenate([faces[:, :2], faces[:, 1:]]).T
    shell = connected_components(coo_array((np.ones(ends.shape[1]), ends), (len(surface.vertices),) * 2))[1][
        faces[:, 0]
    ]
    low, high = triangles.min(axis=1), triangles.max(axis=1)
    flat = np.argsort(np.ptp(surface.vertices, axis=0))[1:]
    boxes = shapely.box(*low[:, flat].T, *high[:, flat].T)
    tree = shapely.STRtree(boxes)
    seen = 0
    for begin in range(0, len(faces), BATCH):
        go_on(stop)
        one, other = tree.query(boxes[begin : begin + BATCH])
        one += begin
        meet = (low[one] <= high[other]).all(axis=1) & (low[other] <= high[one]).all(axis=1)
        meet &= (shell[one] == shell[other]) & (one != other)
        seen += len(one)
        if seen > MOST_PAIRS:
            return None
        at = _through(triangles, one[meet], other[meet], near)
        if at is not None:
            return at
    return None


def _through(triangles: Floats, one: Ints, other: Ints, near: float) -> Floats | None:
    """A point where an edge of one of some triangles goes through another that is named beside it."""
    a, b, c = (triangles[other, k] for k in range(3))
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1)
    normal /= np.maximum(length, 1e-300)[:, None]
    for k in range(3):
        p, q = triangles[one, k], triangles[one, (k + 1) % 3]
        above, below = (np.einsum("ij,ij->i", normal, x - a) for x in (p, q))
        some = np.flatnonzero((np.minimum(abs(above), abs(below)) > near) & (above * below < 0) & (length > 0))
        at = p[some] + (above[some] / (above[some] - below[some]))[:, None] * (q[some] - p[some])
        inside = np.ones(len(some), dtype=bool)
        for start, end in ((a, b), (b, c), (c, a)):
            along = end[some] - start[some]
            side = np.einsum("ij,ij->i", np.cross(normal[some], along), at - start[some])
            inside &= side > near * np.linalg.norm(along, axis=1)
        if inside.any():
            return np.asarray(at[inside][0])
    return None
