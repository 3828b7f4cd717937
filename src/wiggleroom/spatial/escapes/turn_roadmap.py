"""A roadmap over orientations of one body: where its faces are parallel to those of others, all translations, and turns between.

At each such orientation the free translations are known (`planar_slides.py`). From one to the next the body turns about its reference
point, or about the axis of its round faces, at the places where it is free at angles between: there the turn is checked. Parts that must
turn and slide at once are not seen.

Source: critical orientations, Latombe, "Robot Motion Planning" 1991; roadmaps, Kavraki, Svestka, Latombe and Overmars 1996.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wiggleroom.context import Context
from wiggleroom.spatial.bodies.rotations import exponential
from wiggleroom.spatial.escapes.planar_slides import MAX_PAIRS, TranslationSpace
from wiggleroom.spatial.search.spatial_prepare import SpatialPrepared
from wiggleroom.spatial.search.turning_in_place import (
    ACROSS,
    LEAST_TURN,
    common_edges,
    free_turn,
    turned_by,
    turns_in_place,
)
from wiggleroom.spatial.solids.convex import distinct_axes

Floats = NDArray[np.float64]

MAX_ANGLES = 240
"""Of more critical angles every second one, or fewer, is looked at."""
MAX_TARGETS = 4
"""Of the critical angles within a quarter turn those of most faces, at most so many, are where a turn from elsewhere ends."""
MAX_TURNED = 12
"""Of the critical angles to which a body turns in place those of most faces, at most so many, are where the search goes on."""
MAX_POINTS = 6
"""A turn is tried from at most so many places where the body has the most room."""
MAX_TILTS = 6
"""Axes about which a face comes to be parallel to one of others that it leans against: at most so many."""
LEAST_EXTENT = 4.0
"""A body that can be slid no further than this multiple of the clearance has nowhere more room to turn than where it is."""
SAMPLE = np.pi / 12
"""On a turn the body must be free at angles that lie no further apart [rad]."""
SAME_ANGLE = 1e-4
"""Critical angles that differ by less are one [rad]."""
SAME_PLACE = 1e-9
"""What has moved and turned by less is where it was [mm, rad]."""
MAX_WORK = 40_000
"""Differences of pieces that are worked out to find where bodies of one assembly may turn, at most."""


@dataclass(eq=False)
class TurnRoadmap:
    """Orientations of bodies with their free translations, reached so far.

    Parameters
    ----------
    ready : SpatialPrepared
    axes : (k, 3) float64
        Directions of most faces.
    context : Context
    """

    ready: SpatialPrepared
    axes: Floats
    context: Context
    work: int = 0
    turns: bool = False
    """True once a body was found that can turn in place."""
    skipped: bool = False
    """True once a body was left out that has too many pieces, or slides and turns with freedoms locked."""
    _known: list[tuple[int, Floats, Floats, TranslationSpace]] = field(default_factory=list)
    """Bodies with motions, their rotations (3, 3) there, and the translations from there."""
    _handed: set[int] = field(default_factory=set)
    _circles: set[tuple[int, bytes, bytes]] = field(default_factory=set)
    """Bodies with motions to which they turned in place, and the axis: a turn from there leads to nothing else."""

    @property
    def spent(self) -> bool:
        """True once the work is done that one assembly may take: then new orientations are no longer looked at."""
        return self.work > MAX_WORK

    def new_space(self, motion: Floats, body: int) -> TranslationSpace | None:
        """Translations of a body from a motion (n, 6); None where they were handed out before."""
        known = self._space_at(motion, body)
        if known is None:
            known = self._add(motion, body)
        if known is None or known in self._handed:
            return None
        self._handed.add(known)
        return self._known[known][3]

    def is_new(self, motion: Floats, body: int) -> bool:
        """True where no known place of the body is connected with a motion (n, 6) by translations; it is known from then on."""
        if self.spent or self._space_at(motion, body) is not None:
            return False
        self._add(motion, body)
        return True

    def _add(self, motion: Floats, body: int) -> int:
        """Number of the translations of a body from a motion, known from then on."""
        space = TranslationSpace(self.ready, motion, body, axes=self.axes, context=self.context)
        self.work += space.pairs
        self._known.append((body, motion, self.ready.grouping.pose_of(motion).R[body], space))
        return len(self._known) - 1

    def _space_at(self, motion: Floats, body: int) -> int | None:
        """Number of the known translations of a body that are connected with a motion."""
        if not self._known:
            return None
        mine = (self.ready.grouping.body_of == body)[:, None]
        apart = np.linalg.norm(
            np.array([R for _, _, R, _ in self._known]) - self.ready.grouping.pose_of(motion).R[body], axis=(1, 2)
        )
        for k in np.flatnonzero(apart < np.sqrt(2) * SAME_ANGLE).tolist():
            b, known, _, space = self._known[k]
            if b != body or np.abs(np.where(mine, 0.0, motion - known)).max() > SAME_PLACE:
                continue
            shift = self._shift(known, motion, body)
            if np.abs(shift).max() <= SAME_PLACE or space.pairs > MAX_PAIRS or space.reaches(shift):
                return k
        return None

    def note_locked(self, motion: Floats, body: int) -> None:
        """Note a body that has some freedoms only and slides and turns: turns after a slide are looked for at its ends alone."""
        ready = self.ready
        free = ready.grouping.bodies.free[body]
        if free.all() or not free[3:].any():
            return
        mine = np.flatnonzero(ready.grouping.body_of == body)
        for axis in np.eye(3)[free[:3]]:
            stop = self.context.stop
            room = sum(ready.checker.room(motion, mine, way, ready.size, stop) for way in (axis, -axis))
            self.skipped |= bool(room > LEAST_EXTENT * ready.clearance)

    def turned_from(self, motion: Floats, body: int, space: TranslationSpace) -> Iterator[Floats]:
        """Paths (k, n, 6) from a motion by translations and a turn to new orientations of a body."""
        ready = self.ready
        if not ready.grouping.bodies.free[body].all():
            return
        if space.pairs > MAX_PAIRS:
            self.skipped = True
            return
        if space.extent() < LEAST_EXTENT * ready.clearance:
            return  # as good as where it is
        for axis in self._turn_axes(motion, body):
            angles = self._targets(motion, body, axis)
            for sign in (1.0, -1.0):
                if not self._turns_somewhere(motion, body, space, sign * axis):
                    continue
                for angle in angles[np.sign(angles) == sign]:
                    for point in self._rooms(motion, body, axis, angle):
                        slid = space.path_to(point)
                        turned = None if slid is None else self._turned_path(slid[-1], body, axis, angle)
                        if turned is not None:
                            yield np.concatenate([slid, turned[1:]])

    def _turns_somewhere(self, motion: Floats, body: int, space: TranslationSpace, axis: Floats) -> bool:
        """True where the body, slid to some place, turns about an axis by the least turn; noted then."""
        found = any(space.reaches(point) for point in self._rooms(motion, body, axis, LEAST_TURN))
        self.turns |= found
        return found

    def _rooms(self, motion: Floats, body: int, axis: Floats, angle: float) -> list[Floats]:
        """Translations (3,) [mm] after which the body is free at angles up to one about an axis: those with the most room."""
        count = int(np.ceil(abs(angle) / SAMPLE))
        turns = exponential(axis * angle * np.linspace(0, 1, count + 1)[:, None])
        room = TranslationSpace(self.ready, motion, body, turns, context=self.context)
        if room.pairs > MAX_PAIRS or self.spent or self.context.stopped:
            self.skipped |= room.pairs > MAX_PAIRS
            return []
        self.work += room.pairs
        return list(itertools.islice(room.roomiest(axis), MAX_POINTS))

    def _turned_path(self, motion: Floats, body: int, axis: Floats, angle: float) -> Floats | None:
        """Motions (k, n, 6) by which the body turns about an axis through its reference point; None where that is not free."""
        turn = free_turn(self.ready, motion, body, np.sign(angle) * axis, np.zeros(3), abs(angle))
        return turn.path if turn.angle > abs(angle) - turn.step / 2 else None

    def turned_in_place(self, motion: Floats, body: int) -> Iterator[tuple[Floats, Floats, bool]]:
        """Paths (k, n, 6) by which a body turns where it is to critical angles, and the axis (3,) of each.

        The third says whether it is one of those at which most faces are parallel, of all angles about that axis.
        """
        ready = self.ready
        R = ready.grouping.pose_of(motion).R[body]
        for edge in common_edges(ready, body):
            if _circle(motion, body, R @ edge) in self._circles:
                continue
            for turn in turns_in_place(ready, motion, body, [R @ edge]):
                self.turns = True
                angles, count = _critical_angles(ready, motion, body, turn.axis)
                many = np.zeros(len(angles), dtype=np.bool_)
                many[np.lexsort((angles, -count))[:MAX_TURNED]] = True
                for angle, kept in zip(angles.tolist(), many.tolist(), strict=True):
                    done = int(angle / turn.step)
                    if done + 1 < len(turn.path):
                        end = turned_by(ready, motion, body, turn.axis, turn.arm, angle)
                        if not ready.checker.overlaps(turn.path[done], end):
                            self._circles.add(_circle(end, body, R @ edge))
                            yield np.concatenate([turn.path[: done + 1], end[None]]), turn.axis, kept

    def _turn_axes(self, motion: Floats, body: int) -> Floats:
        """Axes (k, 3) of the body's edges, and those about which a face that leans against one of others comes to be parallel to it."""
        R = self.ready.grouping.pose_of(motion).R[body]
        edges = np.array(common_edges(self.ready, body)) @ R.T
        tilts = np.cross(edges[:, None], self.axes[None]).reshape(-1, 3)
        sine = np.linalg.norm(tilts, axis=1)
        leaning = (sine > ACROSS) & (sine < 1 - ACROSS)
        tilts = tilts[leaning] / sine[leaning, None]
        return np.vstack([edges, distinct_axes(tilts, ACROSS)[:MAX_TILTS]]) if len(tilts) else edges

    def _targets(self, motion: Floats, body: int, axis: Floats) -> Floats:
        """Critical angles within a quarter turn either way [rad], those of most faces."""
        angles, count = _critical_angles(self.ready, motion, body, axis)
        angles = np.where(angles > np.pi, angles - 2 * np.pi, angles)
        near = np.abs(angles) < np.pi / 2 + SAME_ANGLE
        angles, count = angles[near], count[near]
        return angles[np.lexsort((np.abs(angles), -count))[:MAX_TARGETS]]

    def _shift(self, start: Floats, end: Floats, body: int) -> Floats:
        pose, other = (self.ready.grouping.pose_of(m) for m in (start, end))
        return other.T[body] - pose.T[body]


def _circle(motion: Floats, body: int, axis: Floats) -> tuple[int, bytes, bytes]:
    """A body at a motion (n, 6) that turns about an axis (3,), either way."""
    ahead = axis * np.sign(axis[np.abs(axis).argmax()])
    return body, (motion.round(9) + 0.0).tobytes(), (ahead.round(6) + 0.0).tobytes()


def _critical_angles(
    ready: SpatialPrepared, motion: Floats, body: int, axis: Floats
) -> tuple[Floats, NDArray[np.int64]]:
    """Angles within a whole turn [rad] at which faces of the body along an axis are parallel to some of others, and how many are."""
    bodies, pose = ready.grouping.bodies, ready.grouping.pose_of(motion)
    u = np.linalg.svd(axis[None])[2][1]
    v = np.cross(axis, u)

    def directions(b: int) -> Floats:
        normals = np.unique(np.vstack([p.normals for p in bodies.pieces[b]]).round(9), axis=0) @ pose.R[b].T
        flat = normals[np.abs(normals @ axis) < ACROSS]
        return _once(np.arctan2(flat @ v, flat @ u) % np.pi)[0]

    mine = directions(body)
    others = _once(np.concatenate([directions(b) for b in range(len(bodies.at)) if b != body]))[0]
    half, count = _once(((others[:, None] - mine[None]) % np.pi).ravel())
    angles, count = np.concatenate([half, half + np.pi]), np.concatenate([count, count])
    turned = (angles > SAME_ANGLE) & (angles < 2 * np.pi - SAME_ANGLE)
    angles, count = angles[turned], count[turned]
    thin = 1 + len(angles) // MAX_ANGLES
    return angles[::thin], count[::thin]


def _once(angles: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """Angles in order, each once, and how often it is there."""
    angles = np.sort(angles)
    first = np.flatnonzero(np.diff(angles, prepend=-np.inf) > SAME_ANGLE)
    return angles[first], np.diff(np.append(first, len(angles)))
