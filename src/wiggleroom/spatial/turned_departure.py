"""Ways out after a turn: a body turns in place until its faces are parallel to those of others, and then goes along the axis.

Where something lies in the way at any other angle, as with a bayonet, that is where it may not.

Source: critical orientations, Latombe, "Robot Motion Planning" 1991.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from wiggleroom.spatial.spatial_prepare import SpatialPrepared
from wiggleroom.spatial.turning_in_place import ACROSS, common_edges, turn_in_place, turned_by

Floats = NDArray[np.float64]

LEAST_TURN = 0.1
"""A body that can turn in place by less has no other way to go along the axis [rad]."""
MAX_ANGLES = 240
"""Of more critical angles every second one, or fewer, is looked at."""
SAME_ANGLE = 1e-4
"""Critical angles that differ by less are one [rad]."""


def critical_turns(ready: SpatialPrepared, motion: Floats, body: int) -> Iterator[tuple[Floats, Floats]]:
    """Paths (k, n, 6) by which a body turns in place to where its faces are parallel to others, and the axis (3,) of each."""
    R = ready.grouping.pose_of(motion).R[body]
    for edge in common_edges(ready, body):
        for axis in (R @ edge, -R @ edge):
            turn = turn_in_place(ready, motion, body, axis)
            if turn is None or turn.angle < LEAST_TURN:
                continue
            for angle in _critical_angles(ready, motion, body, axis):
                done = int(angle / turn.step)
                if done + 1 < len(turn.path):
                    end = turned_by(ready, motion, body, turn.axis, turn.arm, angle)
                    if not ready.checker.overlaps(turn.path[done], end):
                        yield np.concatenate([turn.path[: done + 1], end[None]]), turn.axis
            if turn.endless:
                break


def _critical_angles(ready: SpatialPrepared, motion: Floats, body: int, axis: Floats) -> list[float]:
    """Angles within a whole turn [rad] at which a face of the body is parallel to one of another body, both along the axis."""
    bodies, pose = ready.grouping.bodies, ready.grouping.pose_of(motion)
    u = np.linalg.svd(axis[None])[2][1]
    v = np.cross(axis, u)

    def directions(b: int) -> Floats:
        normals = np.unique(np.vstack([p.normals for p in bodies.pieces[b]]).round(9), axis=0) @ pose.R[b].T
        flat = normals[np.abs(normals @ axis) < ACROSS]
        return _once(np.arctan2(flat @ v, flat @ u) % np.pi)

    mine = directions(body)
    others = _once(np.concatenate([directions(b) for b in range(len(bodies.at)) if b != body]))
    half = _once(((others[:, None] - mine[None]) % np.pi).ravel())
    found = [a for a in (*half.tolist(), *(half + np.pi).tolist()) if a > SAME_ANGLE]
    return found[:: 1 + len(found) // MAX_ANGLES]


def _once(angles: Floats) -> Floats:
    """Angles in order, each once."""
    angles = np.sort(angles)
    return angles[np.diff(angles, prepend=-np.inf) > SAME_ANGLE]
