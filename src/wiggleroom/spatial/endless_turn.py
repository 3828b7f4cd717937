"""Whether a body can be turned for ever: where it is, or once it has left the others straight."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from wiggleroom.spatial.spatial_prepare import SpatialPrepared
from wiggleroom.spatial.straight_departure import StraightDeparture
from wiggleroom.spatial.turning_in_place import common_edges, turn_in_place

Floats = NDArray[np.float64]

LATTICE = np.array([d for d in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(d)])
"""Directions to the neighbours of a place in a cubic lattice (26, 3)."""

MAX_PLACES = 40
"""It is turned at so many waypoints, or a few more."""


def endless_turn(ready: SpatialPrepared, path: Floats, body: int, axis: Floats) -> Floats | None:
    """Path (m, n, 6) [mm, rad] along another one, or a part of it, and on by a whole turn of a body in place; None where none is found.

    It turns at some waypoint, or once it has left the others straight from the last one: along its edges, the axes of the world or between
    them, with what it pushes ahead.

    Parameters
    ----------
    path : (k, n, 6) float64 [mm, rad]
        Motions of the parts, free of overlap.
    axis : (3,) float64
        Unit vector in the world, right hand.
    """
    for k in range(len(path) - 1, -1, -max(1, len(path) // MAX_PLACES)):
        turn = turn_in_place(ready, path[k], body, axis)
        if turn is None:
            return None
        if turn.endless:
            return np.concatenate([path[:k], turn.path])
    motion = path[-1]
    R = ready.grouping.pose_of(motion).R[body]
    edges = np.array([sign * (R @ e) for e in common_edges(ready, body) for sign in (1.0, -1.0)])
    for direction in np.vstack([edges, LATTICE / np.linalg.norm(LATTICE, axis=1)[:, None]]):
        departure = StraightDeparture(ready, motion, direction)
        leaving = departure.parts_with([body])
        if leaving:
            turn = turn_in_place(ready, departure.end(leaving), body, axis)
            if turn is not None and turn.endless:
                return np.concatenate([path, turn.path])
    return None
