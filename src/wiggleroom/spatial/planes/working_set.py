"""The working set of planes: pairs of pieces that do not face each other stay out of the program until they meet.

A plane between pieces that lie beside each other, corner at corner, has room to turn by much of a radian, and its rows are then far
from linear in one step: such planes make every step short. They join, and it is solved again from rest, where the pieces meet on the way.

Source: working sets, Gill, Murray and Wright 1981, section 5.2.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.spatial.bodies.rigid import RigidBodies, SpatialPose, near_pieces
from wiggleroom.spatial.planes.separating_plane_program import best_axis

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

CONTACT_DIMENSION = 2
"""Sum of the dimensions of what touches in general position: a corner and a face, or two edges."""
BAND = 0.1
"""Corners within this share of the clearance are at the same level."""


def facing_pairs(bodies: RigidBodies, pose: SpatialPose, pieces: Ints, clearance: float, reach: float) -> Bools:
    """Which pairs of pieces (k, 4) are within `reach` and face each other: what is nearest of both overlaps, seen along the axis."""
    return np.array([_faces(bodies, pose, who, clearance, reach) for who in pieces.tolist()], dtype=bool)


def _faces(bodies: RigidBodies, pose: SpatialPose, who: list[int], clearance: float, reach: float) -> bool:
    import shapely

    n = np.empty(3)
    apart, other = best_axis(bodies, pose, who, n)
    if apart > reach:
        return False
    own = bodies.pieces[who[0]][who[1]].corners
    p, v = own @ n, other @ n
    band = BAND * clearance
    across = np.linalg.svd(n[None])[2][1:]
    near = [shapely.MultiPoint(c @ across.T).convex_hull for c in (own[p > p.max() - band], other[v < v.min() + band])]
    if sum(shapely.get_dimensions(near)) < CONTACT_DIMENSION:
        return False
    return bool(near[0].distance(near[1]) < clearance)


def pairs_that_meet(bodies: RigidBodies, pose: SpatialPose, known: Ints, reach: float) -> Ints:
    """Pairs of pieces (k, 4) that are not among those known (j, 4) and are within `reach` [mm], if any of them overlap."""
    new = pairs_not_among(bodies, near_pieces(bodies, pose, reach), known)
    apart = np.array([best_axis(bodies, pose, who, np.empty(3))[0] for who in new.tolist()])
    return new[apart < reach] if (apart <= 0).any() else new[:0]


def pairs_not_among(bodies: RigidBodies, pairs: Ints, known: Ints) -> Ints:
    """Those pairs of pieces (k, 4) that are not among others (j, 4), in either order."""
    return pairs[~np.isin(_keys(bodies, pairs), _keys(bodies, known))]


def _keys(bodies: RigidBodies, pairs: Ints) -> Ints:
    """A number (k,) for every pair of pieces (k, 4), the same in both orders."""
    first = np.cumsum([0, *(len(pieces) for pieces in bodies.pieces)])
    one, other = first[pairs[:, 0]] + pairs[:, 1], first[pairs[:, 2]] + pairs[:, 3]
    return np.asarray(np.minimum(one, other) * first[-1] + np.maximum(one, other))
