"""Bodies as shapely geometries where they lie."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.geometry.bodies import Bodies, BodyShapes

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def placed(bodies: Bodies, motion: Floats | None = None, only: Ints | None = None) -> NDArray[np.object_]:
    """Material of every body (or of `only` some) as shapely geometries (n,), at rest or moved by `motion` (n, 3) [mm, mm, rad]."""
    pose = bodies.rest if motion is None else bodies.rest + motion
    shapes, out = bodies.shapes, np.empty(len(pose), dtype=object)
    who = np.arange(len(pose)) if only is None else only
    if not len(who):
        return out
    start, count = shapes.first[bodies.shape[who]], np.diff(shapes.first)[bodies.shape[who]]
    at = np.repeat(np.arange(len(who)), count)
    row = np.arange(len(at)) + np.repeat(start - (np.cumsum(count) - count), count)
    c, s = np.cos(pose[who, 2])[at], np.sin(pose[who, 2])[at]
    x, y = shapes.corner[row].T
    points = np.column_stack([c * x - s * y + pose[who, 0][at], s * x + c * y + pose[who, 1][at]])
    ring, outer = _rings(shapes)
    mine = ring[row] + np.repeat(np.arange(len(who)), count) * (
        ring[-1] + 1
    )  # rings of one body after those of another
    first = np.flatnonzero(np.diff(mine, prepend=-1))
    made = shapely.linearrings(points, indices=np.cumsum(np.diff(mine, prepend=mine[0]) != 0))
    # outer rings turn counter-clockwise, holes clockwise and follow theirs
    region = np.cumsum(outer[ring[row[first]]]) - 1
    pieces = np.asarray(shapely.polygons(made, indices=region))
    owner = at[first][np.flatnonzero(np.diff(region, prepend=-1))]
    if len(pieces) == len(who):
        out[who] = pieces
        return out
    several = np.bincount(owner, minlength=len(who)) > 1
    out[who[owner[~several[owner]]]] = pieces[~several[owner]]
    for k in np.flatnonzero(several):
        out[who[k]] = shapely.union_all(pieces[owner == k])
    return out


def _rings(shapes: BodyShapes) -> tuple[Ints, NDArray[np.bool_]]:
    """Ring (N,) of every corner, counted through all shapes, and which rings are outer ones."""
    ends = shapes.after != np.arange(1, len(shapes.after) + 1)
    ring = np.cumsum(ends) - ends
    x, y = shapes.corner.T
    after = shapes.after
    cross = x * y[after] - x[after] * y
    return ring, np.bincount(ring, cross) > 0
