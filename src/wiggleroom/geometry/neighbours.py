"""Which bodies can meet: pairs that are too far apart are culled by a tree search; and which pairs of them are congruent."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.geometry.bodies import Bodies, BodyShapes

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Pairs:
    """Pairs of bodies that can meet.

    Parameters
    ----------
    a, b : (P,) int64
        Bodies, a < b.
    clearance : (P,) float64 [mm]
        Distance at rest.
    """

    a: Ints
    b: Ints
    clearance: Floats


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


def neighbours(bodies: Bodies, geometry: NDArray[np.object_], reach: float, *, ignored: Ints) -> Pairs:
    """Pairs of bodies no further apart than `reach`, except fixed with fixed and `ignored` ones.

    Parameters
    ----------
    bodies : Bodies
    geometry : (n,) shapely geometries
        Material of the bodies where they are now, from `placed`.
    reach : float [mm]
    ignored : (k,) int64
        Keys a * n + b of pairs to leave out.

    Returns
    -------
    Pairs
        Sorted by (a, b).
    """
    tree = shapely.STRtree(geometry)
    i, j = tree.query(geometry, predicate="dwithin", distance=reach)
    keep = (i < j) & ~(bodies.fixed[i] & bodies.fixed[j]) & ~np.isin(i * len(geometry) + j, ignored)
    i, j = i[keep], j[keep]
    order = np.lexsort((j, i))
    i, j = i[order], j[order]
    return Pairs(i, j, shapely.distance(geometry[i], geometry[j]))


def hulls_meet(bodies: Bodies, geometry: NDArray[np.object_], *, ignored: Ints) -> Pairs:
    """Pairs of bodies whose convex hulls overlap, except fixed with fixed and `ignored` ones; arguments as for `neighbours`.

    Source: Mind the Gap, section 4.4: the pairs that get collision constraints.
    """
    around = shapely.convex_hull(geometry)
    i, j = shapely.STRtree(around).query(around, predicate="intersects")
    keep = (i < j) & ~(bodies.fixed[i] & bodies.fixed[j]) & ~np.isin(i * len(geometry) + j, ignored)
    i, j = i[keep], j[keep]
    order = np.lexsort((j, i))
    i, j = i[order], j[order]
    return Pairs(i, j, shapely.distance(geometry[i], geometry[j]))


def relative_pose(bodies: Bodies, a: Ints, b: Ints, motion: Floats | None = None) -> Floats:
    """B seen from A (P, 3) [mm, mm, rad]: position of B's origin in A's frame and its angle, at rest or moved."""
    pose = bodies.rest if motion is None else bodies.rest + motion
    c, s = np.cos(pose[a, 2]), np.sin(pose[a, 2])
    x, y = (pose[b, :2] - pose[a, :2]).T
    return np.column_stack([c * x + s * y, -s * x + c * y, pose[b, 2] - pose[a, 2]])


def classes(bodies: Bodies, a: Ints, b: Ints, pose: Floats, tolerance: float = 1e-9) -> tuple[Ints, Ints]:
    """Congruent pairs: same shapes in the same relative pose, wherever they lie and however they are turned.

    Parameters
    ----------
    a, b : (P,) int64
    pose : (P, 3) [mm, mm, rad]
        Relative poses.
    tolerance : float
        Poses are the same up to this share of the larger body's radius and this angle [rad].

    Returns
    -------
    first : (C,) int64
        One pair of each class.
    label : (P,) int64
        Class of each pair.
    """
    unit = tolerance * np.maximum(bodies.radius[a], bodies.radius[b])
    angle = np.remainder(pose[:, 2] + 1e-6, 2 * np.pi) - 1e-6
    place = np.round(pose[:, :2] / unit[:, None])
    key = np.column_stack([bodies.shape[a], bodies.shape[b], place, np.round(angle / tolerance)])
    _, first, label = np.unique(key, axis=0, return_index=True, return_inverse=True)
    return first, label.ravel()
