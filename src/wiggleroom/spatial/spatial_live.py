"""Parts in space that are dragged while somebody looks: every motion that is shown is free, and so is the path there."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.assembly.statements import unknown
from wiggleroom.context import Context
from wiggleroom.deadline import Deadline
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError, Stop, go_on
from wiggleroom.live.drag_target import target_in_sight
from wiggleroom.live.live_result import LiveResult, Mode
from wiggleroom.live.loose_modes import MAX_SHOWN_TRAVEL, Side, cut_off, modes, picked
from wiggleroom.search.answer import Answer, Contact
from wiggleroom.spatial.bodies.rigid import RigidBodies, SpatialPose, near_pieces
from wiggleroom.spatial.bodies.rotations import logarithm
from wiggleroom.spatial.planes.separating_plane_program import build_planes
from wiggleroom.spatial.planes.separating_plane_solver import SeparatingPlaneSolver
from wiggleroom.spatial.planes.spatial_objectives import Displacement, SpatialApproach, SumOfTerms
from wiggleroom.spatial.search.spatial_path_check import free_path
from wiggleroom.spatial.search.spatial_prepare import REACH, SpatialPrepared, prepare_spatial
from wiggleroom.spatial.search.spatial_search import SpatialSearch
from wiggleroom.spatial.search.spatial_starts import is_held
from wiggleroom.spatial.spatial_contact_forces import HeldMotion, spatial_contacts
from wiggleroom.spatial.spatial_flex import flex_spatial
from wiggleroom.verdict import PathState, SolverStatus

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_PREPARED = 4
"""Number of designs that are kept ready."""
ARRIVED = 1e-3
"""A grip this share of the clearance from its target has arrived."""
MAX_ROUNDS = 12
"""The program is built anew at most this many times where the hand led the part among others."""
MIN_GAIN = 1e-3
"""A round that comes nearer by less than this share of the distance is the last one."""
MAX_DOUBLINGS = 7
"""The time that the same drag may take is doubled at most this many times."""
ITERATIONS, TOLERANCE = 60, 1e-5
"""Most iterations of the solve of a drag, and its tolerance as a share of the distance."""


MAX_LEFT = 24
"""Number of poses that are kept as they were found."""


def _key(motion: Floats) -> bytes:
    """A motion as a page knows it, rounded."""
    return (np.round(motion, 4) + 0.0).tobytes()


class SpatialLive:
    """An assembly in space whose design is changed, and whose parts are dragged, while somebody looks.

    Examples
    --------
    >>> from wiggleroom.spatial.solids.spatial_assembly import assemble_spatial
    >>> from wiggleroom.spatial.solids.spatial_file import read_spatial
    >>> text = '''{"format": "wiggleroom/2", "parts": [{"name": "floor", "boxes": [[0, 0, 0, 9, 9, 1]], "fixed": true},
    ...            {"name": "block", "boxes": [[0, 0, 0, 2, 2, 2]], "at": [4, 4, 3]}]}'''
    >>> live = SpatialLive()
    >>> live.take(assemble_spatial(read_spatial(text)))
    >>> round(live.drag("block", (5, 5, 4), (5, 5, 9)).distance, 6)
    0.0
    """

    def __init__(self) -> None:
        self._ready: OrderedDict[int, SpatialPrepared] = OrderedDict()
        self._now: SpatialPrepared | None = None
        self._motion: Floats | None = None
        self._asked: object = None
        self._times = 0
        self._left: OrderedDict[bytes, Floats] = OrderedDict()
        self._end: tuple[SpatialPrepared, tuple[Goal, ...], Floats] | None = None

    def take(self, assembly: Assembly) -> None:
        """Go on with this design; another one than before begins at rest.

        Raises
        ------
        InputError
            If nothing can move.
        TouchingError
            If two parts touch at rest.
        """
        key = id(assembly)
        if key not in self._ready:
            self._ready[key] = prepare_spatial(assembly)
        self._ready.move_to_end(key)
        while len(self._ready) > MAX_PREPARED:
            self._ready.popitem(last=False)
        if self._now is not self._ready[key]:
            self._now, self._motion = self._ready[key], None
            self._left.clear()

    @property
    def ready(self) -> SpatialPrepared:
        """The present design, prepared."""
        if self._now is None:
            raise InputError("nothing is open: open a drawing first")
        return self._now

    @property
    def assembly(self) -> Assembly:
        """The present design."""
        return self.ready.assembly

    def settle(
        self,
        goals: Sequence[Goal],
        *,
        stop: Stop | None = None,
        progress: Callable[[int, float], None] | None = None,
    ) -> Answer:
        """Return the answer of `wiggleroom.flex`; a drag may begin at its end.

        Raises
        ------
        InputError
            If nothing is fixed or pulled.
        StoppedError
            If it was asked to stop.
        """
        answer = flex_spatial(
            self.ready, tuple(goals), search=0, bound=True, context=Context(stop=stop, progress=progress)
        )
        go_on(stop)
        if answer.path == PathState.CHECKED and answer.collision_free:
            self._end = (self.ready, tuple(goals), answer.motion)
        return answer

    def drag(
        self,
        part: str,
        grip: Sequence[float],
        target: Sequence[float],
        *,
        start: str | Floats = "here",
        goals: Sequence[Goal] | None = None,
        within: int | None = None,
        pinned: Collection[str] = (),
        seconds: float = 0.4,
        stop: Stop | None = None,
    ) -> LiveResult:
        """Bring a point of a part as near to a place as the assembly lets it; see `wiggleroom.Live.drag`.

        First the part alone goes straight. Where that is not free, the program of the separating planes is solved with every iterate
        inside all rows, its path is checked for all pairs of parts, and from as far as it is free it goes on. Asked the same again, it
        takes twice as long; of the bodies `within`, those nearest to the part may move.
        """
        began = time.perf_counter()
        ready = self.ready
        names = ready.assembly.names
        body = self._movable(part, "drag")
        if len(grip) != 3 or len(target) != 3:
            raise InputError("drag: in space grip and target have three numbers each")
        group = ready.grouping
        asked = (part, tuple(grip), tuple(target))
        self._times = self._times + 1 if asked == self._asked else 0  # a large program needs longer than the first look
        self._asked = asked
        until = Deadline(seconds * 2 ** min(self._times, MAX_DOUBLINGS), stop)
        arm = np.array(grip, dtype=float) - group.bodies.at[body]
        aim = target_in_sight(grip, target, ready.size)
        motion = self._begun(start, goals)
        held = {int(group.body_of[names.index(name)]) for name in pinned}
        if body in held:
            message = f'"{part}" is pinned: let it go before you drag it'
            raise InputError(message)
        search = _Drag(ready, body, arm, aim, self._loose(body, motion, within, held), until)
        motion, settled, contacts = search.run(motion)
        self._motion = motion
        reached = search.grip(group.pose_of(motion))
        blocking = dict.fromkeys(n for c in contacts if part in c.parts for n in c.parts if n != part)
        whole = within is None or bool(search.bodies.moves.sum() + len(held) >= group.bodies.moves.sum())
        distance = float(np.linalg.norm(np.subtract(target, reached)))
        return LiveResult(
            motion,
            settled and (whole or not contacts),
            time.perf_counter() - began,
            contacts,
            tuple(blocking),
            reached=tuple(reached.tolist()),
            distance=distance,
        )

    def wiggle(
        self, part: str | None = None, *, count: int = 4, seconds: float = 8.0, stop: Stop | None = None
    ) -> tuple[Mode, ...]:
        """Return the loosest freedoms at rest, each followed to its end both ways; see `wiggleroom.Live.wiggle`."""
        body = None if part is None else self._movable(part, "wiggle")
        return modes(SpatialLoose(self.ready), body, count, Deadline(seconds, stop))

    def _movable(self, part: str, question: str) -> int:
        """The body of a part that can move; raises InputError."""
        names, group = self.ready.assembly.names, self.ready.grouping
        if part not in names:
            message = f"{question}: {unknown(part, dict.fromkeys(names))}"
            raise InputError(message)
        body = int(group.body_of[names.index(part)])
        if not group.bodies.moves[body]:
            message = f'"{part}" is fixed: let it go before you drag it'
            raise InputError(message)
        return body

    @property
    def dragged(self) -> bool:
        """Whether a drag has ended somewhere in this design."""
        return self._motion is not None

    def leave(self, motion: Floats) -> bool:
        """Leave all parts at a motion (n, 6) [mm, rad], where a later drag may begin; False where some overlap there.

        Where the last drag ended, at that motion to single precision, that one is kept.
        """
        last = self._motion
        if last is not None and np.allclose(last, motion, rtol=1e-6, atol=1e-6 * self.ready.size):
            self._left[_key(motion)] = last
            while len(self._left) > MAX_LEFT:
                self._left.popitem(last=False)
        at = self._left.get(_key(motion), motion)
        return not self.ready.checker.overlaps(at, at)

    def _begun(self, start: str | Floats, goals: Sequence[Goal] | None) -> Floats:
        """Motion (n, 6) at which a drag begins."""
        if not isinstance(start, str):
            at = self._left.get(_key(start), start)
            if self.ready.checker.overlaps(at, at):
                raise InputError("drag: parts overlap where they were left; bring them back to rest")
            return at
        rest = np.zeros((len(self.ready.assembly.parts), 6))
        if start == "answer" and self._end is not None and goals is not None:
            ready, asked, motion = self._end
            return motion if ready is self.ready and asked == tuple(goals) else rest
        return self._motion if start == "here" and self._motion is not None else rest

    def _loose(self, body: int, motion: Floats, within: int | None, held: set[int]) -> RigidBodies:
        """The bodies, those that are pinned or not among the nearest `within` of one of them held fast."""
        group = self.ready.grouping
        bodies = group.bodies
        if held:
            stands = np.isin(np.arange(len(bodies.at)), list(held))
            bodies = replace(bodies, free=bodies.free & ~stands[:, None])
        if within is None or within >= len(bodies.at):
            return bodies
        pose = group.pose_of(motion)
        far = np.linalg.norm(pose.T - pose.T[body], axis=1)
        near = np.zeros(len(far), dtype=bool)
        near[np.argsort(far, kind="stable")[:within]] = True
        return replace(bodies, free=bodies.free & near[:, None])


@dataclass(eq=False)
class _Drag:
    """One drag of one body."""

    ready: SpatialPrepared
    body: int
    arm: Floats
    aim: Floats
    bodies: RigidBodies
    until: Deadline

    def grip(self, pose: SpatialPose) -> Floats:
        """Where the grip is (3,) [mm]."""
        return np.asarray(pose.T[self.body] + pose.R[self.body] @ self.arm)

    def run(self, motion: Floats) -> tuple[Floats, bool, tuple[Contact, ...]]:
        """Motion (n, 6) at the end, whether that settles it, and what holds it."""
        group = self.ready.grouping
        near = ARRIVED * self.ready.clearance
        for _ in range(MAX_ROUNDS):
            left = self.aim - self.grip(group.pose_of(motion))
            distance = float(np.linalg.norm(left))
            if distance <= near:
                return motion, True, ()
            ahead = self._straight(motion, left)
            if ahead is not None:
                motion = ahead
                continue
            after, done = self._solved(motion, distance)
            now = float(np.linalg.norm(self.aim - self.grip(group.pose_of(after))))
            if now >= distance:  # no nearer: it stays where it was
                return motion, done is not None, done or ()
            motion = after
            if done is not None and now > distance * (1 - MIN_GAIN):
                return motion, True, done
            if self.until.is_set():
                return motion, False, ()
        return motion, True, ()

    def _straight(self, motion: Floats, left: Floats) -> Floats | None:
        """Motion after the body alone has gone straight, as its locks let it; None where it meets something or comes no nearer."""
        step = left * self.bodies.free[self.body, :3]
        if np.linalg.norm(left - step) >= np.linalg.norm(left) * (1 - MIN_GAIN):
            return None
        mine = np.flatnonzero(self.ready.grouping.body_of == self.body).tolist()
        end = motion.copy()
        end[mine, :3] += step
        return None if self.ready.checker.doubtful(motion, end, first=True, only=mine) else end

    def _solved(self, motion: Floats, distance: float) -> tuple[Floats, tuple[Contact, ...] | None]:
        """Motion as far as the path to the nearest point is free, and the contacts there; None where it is not the end."""
        ready = self.ready
        begin = ready.grouping.pose_of(motion)
        goal = SpatialApproach(self.body, self.arm, self.aim, begin, self.bodies.radius, distance)
        pieces = near_pieces(self.bodies, begin, REACH * ready.clearance)
        program = build_planes(self.bodies, goal, pieces, length=ready.clearance, rest=begin)
        solver = SeparatingPlaneSolver(
            program, inside=True, most=ITERATIONS, tolerance=TOLERANCE, horizon=np.inf, stop=self.until
        )
        found = solver.solve()
        path, whole = free_path(ready, program, found.path or [program.start])
        if ready.checker.overlaps(motion, path[0]):
            return motion, None
        ended = whole and found.status is SolverStatus.CONVERGED
        held = HeldMotion(ready.grouping, program, found)
        return path[-1], spatial_contacts(ready.assembly, held) if ended else None


class SpatialLoose:
    """See `wiggleroom.live.loose_modes.LooseBodies`.

    Parameters
    ----------
    ready : SpatialPrepared
    """

    def __init__(self, ready: SpatialPrepared) -> None:
        self._ready = ready
        bodies, body_of = ready.grouping.bodies, ready.grouping.body_of
        self._program = build_planes(bodies, SumOfTerms(()), ready.pieces, length=ready.clearance)
        self.names = ready.assembly.names
        self.members = tuple(tuple(np.flatnonzero(body_of == b).tolist()) for b in range(len(bodies.at)))
        self.clearance = ready.clearance

    def stiffness(self) -> sp.csc_matrix:
        """Second derivatives of the barrier of the rows, where planes give way as they like."""
        program = self._program
        at = program.linearise(program.start)
        nothing = np.zeros((len(program.a), 3))
        data, *_ = at.condensed(1.0 / np.maximum(at.h, 1e-9) ** 2, np.zeros(program.rows), nothing, 0.0)
        n = len(program.pattern.diagonal)
        upper = sp.csc_matrix((data, program.pattern.indices, program.pattern.indptr), shape=(n, n))
        return sp.csc_matrix(upper + sp.triu(upper, 1).T)

    def variables(self, body: int) -> Ints:
        """Which variables are freedoms of a body."""
        slot = self._program.slot[body]
        return slot[slot >= 0]

    def followed(self, direction: Floats, until: Stop) -> Side:
        """The largest motion along a direction."""
        ready, program = self._ready, self._program
        bodies, group = ready.grouping.bodies, ready.grouping
        pull = program.unpacked(direction) / program.scale
        pull /= np.abs(pull).max(initial=1e-300)
        search = SpatialSearch(ready, SumOfTerms(self._terms(pull)), Context(stop=until), once=True)
        done = search.run()
        endless = not is_held(done)
        path = done.path
        if endless:
            far = np.array([self._furthest(group.pose_of(m)).max() for m in path])
            last = cut_off(far, ready.size)
            if last < len(path):
                share = (MAX_SHOWN_TRAVEL * ready.size - far[last - 1]) / (far[last] - far[last - 1])
                path = np.concatenate([path[:last], (path[last - 1] + share * (path[last] - path[last - 1]))[None]])
        shown = path[picked(len(path))]
        pose = group.pose_of(shown[-1])
        moved = np.hstack([pose.T - bodies.at, logarithm(pose.R)]) / program.scale
        return Side(shown, program.packed(moved), self._furthest(pose), endless)

    def _terms(self, pull: Floats) -> tuple[Displacement, ...]:
        """Forces and torques (n, 6) on the bodies as pulls: a torque is two that are opposite."""
        bodies = self._ready.grouping.bodies
        found = []
        for b in np.flatnonzero(bodies.moves).tolist():
            rest, force, torque = bodies.at[b], pull[b, :3], pull[b, 3:]
            found.append(Displacement(b, np.zeros(3), force, rest))
            size = float(np.linalg.norm(torque))
            if size > 0:
                arm = bodies.radius[b] * np.linalg.svd(torque[None])[2][1]
                along = np.cross(torque, arm) / (2 * bodies.radius[b] ** 2)
                found += [Displacement(b, sign * arm, sign * along, rest) for sign in (1.0, -1.0)]
        return tuple(found)

    def _furthest(self, pose: SpatialPose) -> Floats:
        """How far the furthest corner of each body is moved (m,) [mm]."""
        bodies = self._ready.grouping.bodies
        corners, body, _ = bodies.corners
        moved = np.einsum("kij,kj->ki", pose.R[body], corners) + pose.T[body] - corners - bodies.at[body]
        out = np.zeros(len(bodies.at))
        np.maximum.at(out, body, np.linalg.norm(moved, axis=1))
        return out
