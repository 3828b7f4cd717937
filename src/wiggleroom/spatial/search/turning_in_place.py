"""Turns of one body in place: the axes about which it can turn far, and how far it does before it meets another."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.spatial.bodies.rigid import SpatialPose
from wiggleroom.spatial.bodies.rotations import exponential
from wiggleroom.spatial.search.spatial_path_check import MAX_STRAIN
from wiggleroom.spatial.search.spatial_prepare import SpatialPrepared
from wiggleroom.spatial.search.straight_departure import StraightDeparture

Floats = NDArray[np.float64]

ACROSS = 1e-6
"""A face stands round an axis where its normal has a smaller share along it."""
MAX_FACES = 200
"""At most so many faces are looked at for one axis."""
LEAST_FACES = 4
"""A line at which the normals of fewer faces meet is the axis of no round surface."""
ON_AXIS = 1e-5
"""Normals of faces that miss a line by a smaller share of the size meet there, at any clearance: numbers of four bytes miss by less."""
CHORD = 0.02
"""A step leaves the arc by at most this multiple of the clearance."""
MAX_AXES = 3
"""A body is turned about the directions of most of its edges, at most so many."""
WIDEST_STEP, LEAST_STEP = 0.2, 0.005
"""And turns by at most, and at least, so much [rad]."""
LEAST_TURN = 0.1
"""A body that can nowhere turn in place by more is taken not to turn [rad]."""


@dataclass(frozen=True, eq=False)
class TurnInPlace:
    """A turn of one body about an axis that stands still.

    Parameters
    ----------
    body : int
    axis, arm : (3,) float64, [mm]
        The line is along the axis and goes through the reference point and the arm, both in the world.
    path : (k, n, 6) float64 [mm, rad]
        Motions of the parts, the first where it begins; every step is free of overlap.
    step : float [rad]
        By which every one turns.
    """

    body: int
    axis: Floats
    arm: Floats
    path: Floats
    step: float

    @property
    def angle(self) -> float:
        """Angle of the whole turn [rad]."""
        return (len(self.path) - 1) * self.step

    @property
    def endless(self) -> bool:
        """True where it is a whole turn."""
        return self.angle > 2 * np.pi - self.step / 2


def turn_in_place(ready: SpatialPrepared, motion: Floats, body: int, axis: Floats) -> TurnInPlace | None:
    """The longest turn of a body about a line along an axis, right hand; None where its locks allow none.

    A body that can turn about one axis of the world alone turns about that, as the axis leans.

    Parameters
    ----------
    motion : (n, 6) float64 [mm, rad]
        Motions of the parts where it begins.
    axis : (3,) float64
        Unit vector in the world.
    """
    free, R = ready.grouping.bodies.free[body], ready.grouping.pose_of(motion).R[body]
    if free[3:].sum() == 1:
        axis = np.where(free[3:], np.sign(axis) * (np.abs(axis) > ACROSS), 0.0)
    elif free[3:].sum() == 2 and (
        np.abs(axis[~free[3:]]).max() > ACROSS or not np.allclose(R @ axis, axis, atol=ACROSS)
    ):
        return None
    if not free[3:].any() or not axis.any():
        return None
    arms = [np.zeros(3)]
    if (free[:3] | (1 - np.abs(axis) < ACROSS)).all():
        arms += [R @ arm for arm in round_centres(ready, body, R.T @ axis)]
    turns = [free_turn(ready, motion, body, axis, arm) for arm in arms]
    return max(turns, key=lambda turn: turn.angle)


def turns_in_place(ready: SpatialPrepared, motion: Floats, body: int, axes: Iterable[Floats]) -> Iterator[TurnInPlace]:
    """Turns of a body about axes, each either way, by at least the least turn; a whole turn ahead stands for the one back, too."""
    for axis in axes:
        for direction in (axis, -axis):
            turn = turn_in_place(ready, motion, body, direction)
            if turn is not None and turn.angle >= LEAST_TURN:
                yield turn
                if turn.endless:
                    break


def free_turn(
    ready: SpatialPrepared, motion: Floats, body: int, axis: Floats, arm: Floats, angle: float = 2 * np.pi
) -> TurnInPlace:
    """The turn by an angle [rad] about the line through the reference point and an arm (3,) [mm], as far as it is free."""
    group = ready.grouping
    mine = np.flatnonzero(group.body_of == body)
    across = float(np.linalg.norm(arm - (arm @ axis) * axis))
    step = min(WIDEST_STEP, np.sqrt(8 * CHORD * ready.clearance / across)) if across > 0 else WIDEST_STEP
    count = int(np.ceil(angle / max(step, LEAST_STEP)))
    while group.strain(motion, turned_by(ready, motion, body, axis, arm, angle / count)) > MAX_STRAIN * ready.size:
        count *= 2
    path = [motion]
    for k in range(1, count + 1):
        ahead = turned_by(ready, motion, body, axis, arm, angle * k / count)
        if ready.checker.doubtful(path[-1], ahead, first=True, only=mine.tolist()):
            break
        path.append(ahead)
    return TurnInPlace(body, axis, arm, np.array(path), angle / count)


def common_edges(ready: SpatialPrepared, body: int) -> list[Floats]:
    """Directions of edges that most pieces of a body have, in its frame."""
    edges = np.vstack([piece.edges for piece in ready.grouping.bodies.pieces[body]])
    count: list[int] = []
    found: list[Floats] = []
    left = edges
    while len(left) and len(found) < 4 * MAX_AXES:
        same = np.linalg.norm(np.cross(left, left[0]), axis=1) < ACROSS
        found.append(left[0])
        count.append(int(same.sum()))
        left = left[~same]
    return [found[k] for k in np.argsort(-np.array(count), kind="stable")[:MAX_AXES]]


def turned_by(ready: SpatialPrepared, motion: Floats, body: int, axis: Floats, arm: Floats, angle: float) -> Floats:
    """Motions (n, 6) with a body turned by an angle [rad] about the line along an axis through its reference point and an arm [mm]."""
    group = ready.grouping
    start, turn = group.pose_of(motion), exponential(angle * axis)
    T, R = start.T.copy(), start.R.copy()
    T[body] += arm - turn @ arm
    R[body] = turn @ R[body]
    mine = group.body_of == body
    return np.where(mine[:, None], group.part_motion(SpatialPose(T, R)), motion)


def round_centres(ready: SpatialPrepared, body: int, axis: Floats) -> list[Floats]:
    """The line along an axis, in the body's frame, at which the normals of most of its faces meet: one point of it, or none.

    Normals of the faces of a cylinder, or of a regular prism, meet at its axis.
    """
    points: list[Floats] = []
    normals: list[Floats] = []
    for piece in ready.grouping.bodies.pieces[body]:
        for n in piece.normals[np.abs(piece.normals @ axis) < ACROSS]:
            height = piece.corners @ n
            for level in (height.max(), height.min()):
                face = piece.corners[np.abs(height - level) < ACROSS * ready.size]
                if len(face) > 2 and len(points) < MAX_FACES:
                    points.append(face.mean(axis=0))
                    normals.append(n)
    if len(points) < LEAST_FACES:
        return []
    p, n = np.array(points), np.array(normals)
    i, j = np.triu_indices(len(p), 1)
    u, v = n[i], np.cross(axis, n[j])
    slant = np.einsum("kd,kd->k", u, v)
    crossing = np.abs(slant) > 0.1
    i, j, u, v, slant = i[crossing], j[crossing], u[crossing], v[crossing], slant[crossing]
    if not len(i):
        return []
    met = p[i] + (np.einsum("kd,kd->k", p[j] - p[i], v) / slant)[:, None] * u
    met -= (met @ axis)[:, None] * axis
    off = np.cross(met[:, None] - p[None], n[None]) @ axis
    on = np.abs(off) < ON_AXIS * ready.size
    best = int(on.sum(axis=1).argmax())
    return [met[best]] if on[best].sum() >= LEAST_FACES else []


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
