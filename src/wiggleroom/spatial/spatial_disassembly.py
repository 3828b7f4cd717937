"""Does it come apart, in space: which parts leave, in which order, along which path."""

from __future__ import annotations

import itertools
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.disassembly.ground import with_ground
from wiggleroom.disassembly.interlock_result import Escape, Interlock
from wiggleroom.disassembly.remaining import only
from wiggleroom.spatial.confinement import EFFORTS, PairwiseConfinement
from wiggleroom.spatial.lattice import lattice
from wiggleroom.spatial.lattice_search import lattice_motions, lattice_search
from wiggleroom.spatial.planes.spatial_objectives import Displacement, SumOfTerms
from wiggleroom.spatial.rigid import near_pieces
from wiggleroom.spatial.solids.convex import distinct_axes
from wiggleroom.spatial.spatial_bodies import grouped
from wiggleroom.spatial.spatial_flex import leaving_parts
from wiggleroom.spatial.spatial_prepare import SpatialPrepared, prepare_spatial
from wiggleroom.spatial.spatial_search import SpatialSearch
from wiggleroom.spatial.straight_departure import StraightDeparture
from wiggleroom.spatial.turn_roadmap import TurnRoadmap
from wiggleroom.spatial.turning_in_place import common_edges, turn_in_place, turns_in_place
from wiggleroom.verdict import Certainty, Separability, SolverStatus

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_DIRECTIONS = 13
"""Straight paths are tried along at most this many axes, both ways: those of most faces."""
MAX_PLACES, MAX_PULLED = 200, 3
"""Places, each reached by a checked path, from which straight paths are tried, and from which largest motions are searched."""
UNDECIDED = 1e-2
"""A largest motion whose error is above this was not decided, and nothing is said about what lies beyond it."""
PROVE_AFTER = (0, 1, 20)
"""After so many places the proofs that nothing leaves are tried, each with more effort; what is left of them before largest motions."""
SAME_PLACE = 1e-9
"""What has moved and turned by less is where it was [mm, rad]."""
MAX_AXES = 4
"""Paths by translations are looked for along and across at most so many axes."""
MAX_SPINNING = 200
"""At most so many bodies are turned in place to see whether they turn without limit."""
MAX_TOGETHER = 30
"""At most so many pairs of neighbours are turned as one to see whether they turn."""
NEW_PLACE = 3.0
"""A place is new where a part lies elsewhere by more than this multiple of the clearance."""


def check_spatial(assembly: Assembly, *, every: bool = True, context: Context = UNLIMITED) -> Interlock:
    """Whether some parts can be moved without limit away from the others.

    Fixed parts stand; where none is fixed, the part of the largest volume stands. Without `every` the first path out is enough.

    Raises
    ------
    TouchingError
        If two parts touch or overlap at rest.
    InputError
        If there is only one part, or all are fixed.
    """
    began = time.perf_counter()
    left = with_ground(assembly)
    names = assembly.names
    alive = list(range(len(names)))
    far = np.zeros((len(names), 6))
    escapes: list[Escape] = []
    asked, verdict, sure = 0, Separability.INTERLOCKED, Certainty.SEARCHED
    spins: tuple[str, ...] = ()
    while True:
        stage = DisassemblyStage(prepare_spatial(left), context)
        found = stage.escape_path()
        asked += stage.questions
        if found is None:
            verdict, sure = stage.verdict()
            spins = _spins(stage.ready, context) if every else ()
            break
        who, own = found
        path = np.repeat(far[None], len(own), axis=0)
        path[:, alive] = own
        escapes.append(Escape(tuple(names[alive[k]] for k in who), path))
        far = np.zeros_like(far)
        for e in escapes:
            gone = [names.index(n) for n in e.parts]
            far[gone] = e.path[-1, gone]
        keep = [k for k in range(len(alive)) if k not in set(who)]
        alive = [alive[k] for k in keep]
        left = reduced(left, keep)
        if not every or len(alive) < 2 or not grouped(left).bodies.moves.any():
            break
    if escapes:
        verdict, sure = Separability.COMES_APART, Certainty.PROVEN
    remains = tuple(names[k] for k in alive)
    return Interlock(
        assembly,
        verdict,
        sure,
        tuple(escapes),
        spins=spins,
        remains=remains,
        questions=asked,
        seconds=time.perf_counter() - began,
    )


def _spins(ready: SpatialPrepared, context: Context) -> tuple[str, ...]:
    """Names of the parts that turn in place without limit, about an axis of the world, an edge or the normal of a face."""
    assembly, bodies = ready.assembly, ready.grouping.bodies
    rest = np.zeros((len(assembly.parts), 6))
    found: list[str] = []
    for b in np.flatnonzero(bodies.moves)[:MAX_SPINNING].tolist():
        normals = np.vstack([piece.normals for piece in bodies.pieces[b]])
        axes = distinct_axes(np.vstack([*common_edges(ready, b), np.eye(3), normals]), 1e-6)[:MAX_DIRECTIONS]
        for axis in axes:
            if context.stopped:
                return tuple(found)
            turn = turn_in_place(ready, rest, b, axis)  # a whole turn goes either way
            if turn is not None and turn.endless:
                found += [assembly.names[k] for k in np.flatnonzero(ready.grouping.body_of == b)]
                break
    return tuple(found)


@dataclass(eq=False)
class DisassemblyStage:
    """The next parts that leave, looked for from where all are."""

    ready: SpatialPrepared
    context: Context
    questions: int = 0
    cut: bool = False
    exhaustive: bool = False
    """True where parts on a lattice were searched exhaustively by whole steps: then pulls that were not decided do not count."""
    proven: bool = False
    """True where it is proven that none leave."""
    loose: bool = False
    """True where a body, or neighbours as one, can turn in place, or the work for turns was not enough to tell: then a search says
    nothing of what stays."""

    def verdict(self) -> tuple[Separability, Certainty]:
        """What became of the parts where no path out was found; what holds a cover need not hold what it covers."""
        if self.ready.assembly.overshoot > 0:
            return Separability.UNKNOWN, Certainty.SEARCHED
        if self.proven:
            return Separability.INTERLOCKED, Certainty.PROVEN
        cut = self.cut_short() or self.loose or (self.cut and not self.exhaustive)
        return (Separability.UNKNOWN if cut else Separability.INTERLOCKED), Certainty.SEARCHED

    def escape_path(self) -> tuple[list[int], Floats] | None:
        """Parts that leave, and the path of all (k, n, 6); None where none was found."""
        rest = np.zeros((len(self.ready.assembly.parts), 6))
        places: list[Floats] = [rest[None]]
        axes = self._axes()
        roadmap = TurnRoadmap(self.ready, axes[:MAX_AXES], self.context)
        out = self._straight(rest[None], axes)
        if out is not None or self.cut_short():
            return out
        held = PairwiseConfinement(self.ready, self.context)
        self.proven = not self.ready.assembly.overshoot and held.prove_by_shape()
        if self.proven:
            return None
        out = self._by_steps()
        if out is not None or self.cut_short():
            return out
        asked, efforts = 0, list(EFFORTS)
        while asked < len(places):
            # straight paths are cheap: all of them from all places first
            for path in places[asked:]:
                if asked in PROVE_AFTER and not self.ready.assembly.overshoot:
                    self.proven = held.prove(efforts.pop(0))
                if self.proven or self.cut_short():
                    return None
                out = self._straight(path, axes)
                if out is not None:
                    return out
                out = self._rearranged(path, roadmap, places)
                if out is not None:
                    return out
                self._slide(path, axes, places)
                asked += 1
        self.loose = roadmap.turns or roadmap.spent or roadmap.skipped
        for effort in efforts if not self.ready.assembly.overshoot else []:
            self.proven = held.prove(effort)
            if self.proven or self.cut_short():
                return None
        known = len(places)
        for path in places[:MAX_PULLED]:
            out = self._pulled(path, axes, places)
            if out is not None or self.cut_short():
                return out
        self.cut |= known > MAX_PULLED or len(places) > known
        self.loose = self.loose or self._turn_together()
        return None

    def _turn_together(self) -> bool:
        """True where two neighbours, or all that move, turn in place as one: each may keep the other from turning alone."""
        assembly, group = self.ready.assembly, self.ready.grouping
        moving = np.flatnonzero(group.bodies.moves)
        rest = np.zeros((len(assembly.parts), 6))
        near = near_pieces(group.bodies, group.pose_of(rest), NEW_PLACE * self.ready.clearance)[:, [0, 2]]
        pairs = np.unique(np.sort(near[np.isin(near, moving).all(axis=1)], axis=1), axis=0)
        for bodies in (moving.tolist(), *pairs[:MAX_TOGETHER].tolist()):
            who = np.flatnonzero(np.isin(group.body_of, bodies))
            if len(bodies) < 2 or self.cut_short():
                continue
            glue = (*assembly.drawing.glue, tuple(assembly.names[k] for k in who))
            ready = prepare_spatial(replace(assembly, drawing=replace(assembly.drawing, glue=glue)))
            body = int(ready.grouping.body_of[who[0]])
            if any(turns_in_place(ready, rest, body, common_edges(ready, body))):
                return True
        return False

    def _straight(self, path: Floats, axes: Floats) -> tuple[list[int], Floats] | None:
        """Parts that leave straight from the end of a path; None also where it was asked to stop."""
        for axis in axes:
            for direction in (axis, -axis):
                if self.cut_short():
                    return None
                departure = StraightDeparture(self.ready, path[-1], direction)
                group = departure.first()
                if group:
                    return group, np.concatenate([path, departure.end(group)[None]])
        return None

    def _by_steps(self) -> tuple[list[int], Floats] | None:
        """A path out by whole steps, for parts on a lattice; notes where there is none."""
        grid = lattice(self.ready)
        if grid is None:
            return None
        found = lattice_search(grid, self.context)
        if not found.offsets:
            # clearances that add up to a step let parts through where whole steps do not
            self.exhaustive = found.complete and grid.clearance * len(grid.stands) < grid.step.min()
            return None
        path = lattice_motions(self.ready, grid, found)
        if any(self.ready.checker.overlaps(one, other) for one, other in itertools.pairwise(path)):
            return None
        return self._straight(path, grid.frame[:, found.axis][None])

    def _slide(self, path: Floats, axes: Floats, places: list[Floats]) -> None:
        """Places that a body alone reaches by going straight until little more than its clearance is left."""
        ready, body_of = self.ready, self.ready.grouping.body_of
        moves = ready.grouping.bodies.free[:, :3]
        for b in np.flatnonzero(moves.any(axis=1)):
            mine = np.flatnonzero(body_of == b)
            for direction in (*axes, *-axes):
                if self.cut_short():
                    return
                if not moves[b][np.abs(direction) > 1e-12].all():
                    continue
                far = ready.checker.room(path[-1], mine, direction, ready.size)
                if NEW_PLACE * ready.clearance < far < ready.size:
                    self._add_slide(path, mine, direction, far, places)

    def _rearranged(self, path: Floats, roadmap: TurnRoadmap, places: list[Floats]) -> tuple[list[int], Floats] | None:
        """A path out by translations or a turn of a body alone; where a turn leads is a new place."""
        ready = self.ready
        for b in np.flatnonzero(ready.grouping.bodies.moves).tolist():
            roadmap.note_locked(path[-1], b)
            space = roadmap.new_space(path[-1], b) if ready.grouping.bodies.free[b, :3].all() else None
            if space is not None and (found := space.way_out()) is not None:
                slid, axis = found
                out = self._along(np.concatenate([path, slid[1:]]), axis, b)
                if out is not None:
                    return out
            for turned, axis, many in roadmap.turned_in_place(path[-1], b):
                if self.cut_short():
                    return None
                whole = np.concatenate([path, turned[1:]])
                out = self._along(whole, axis, b)
                if out is not None:
                    return out
                if many:
                    self._add_turned(whole, b, roadmap, places)
            if space is not None:
                for turned in roadmap.turned_from(path[-1], b, space):
                    self._add_turned(np.concatenate([path, turned[1:]]), b, roadmap, places)
            if self.cut_short():
                return None
        return None

    def _along(self, path: Floats, axis: Floats, body: int) -> tuple[list[int], Floats] | None:
        """A body that leaves along an axis, ahead or back, from the end of a path, and what it takes along."""
        for direction in (axis, -axis):
            departure = StraightDeparture(self.ready, path[-1], direction)
            group = departure.parts_with([body])
            if group:
                return group, np.concatenate([path, departure.end(group)[None]])
        return None

    def _add_turned(self, path: Floats, body: int, roadmap: TurnRoadmap, places: list[Floats]) -> None:
        """Take the end of a path in among the places where its orientation, or what it reaches by translations, is new."""
        if roadmap.is_new(path[-1], body):
            if len(places) < MAX_PLACES:
                places.append(path)
            else:
                self.cut = True

    def _add_slide(self, path: Floats, mine: Ints, direction: Floats, far: float, places: list[Floats]) -> None:
        """Note the place where some parts have gone straight from the end of a path, their clearance short of how far they can."""
        end = path[-1].copy()
        end[mine, :3] += (far - self.ready.clearance) * direction
        if not self.ready.checker.doubtful(path[-1], end, first=True, only=mine.tolist()):
            self._add_place(np.concatenate([path, end[None]]), places)

    def cut_short(self) -> bool:
        """True once somebody asked to stop."""
        if self.context.stopped:
            self.cut = True
        return self.cut and self.context.stopped

    def _axes(self) -> Floats:
        """Normals of faces in the world, those of most faces first."""
        normals = np.vstack([piece.normals for body in self.ready.grouping.bodies.pieces for piece in body])
        whole = np.round(normals / 1e-6)
        first_of_three = np.take_along_axis(whole, (whole != 0).argmax(axis=1)[:, None], axis=1)
        _, first, count = np.unique(
            whole * np.sign(first_of_three) + 0.0, axis=0, return_index=True, return_counts=True
        )
        found = normals[first[np.lexsort((first, -count))[:MAX_DIRECTIONS]]]
        return distinct_axes(np.array([*found, *np.eye(3)]), 1e-6)

    def _pulled(self, path: Floats, axes: Floats, places: list[Floats]) -> tuple[list[int], Floats] | None:
        """Pull every body in every direction from the end of a path: a path out, or else new places are added."""
        ready = self.ready
        bodies = ready.grouping.bodies
        begin = ready.grouping.pose_of(path[-1])
        for b in np.flatnonzero(bodies.moves):
            for axis in axes[:3]:
                for direction in (axis, -axis):
                    if self.cut_short():
                        return None
                    goal = SumOfTerms((Displacement(int(b), np.zeros(3), direction, begin.T[b]),))
                    self.questions += 1
                    done = SpatialSearch(ready, goal, self.context.silent, begin).run()
                    if not len(done.program.a):
                        continue
                    self.cut |= not done.good and done.found.error > UNDECIDED
                    whole = np.concatenate([path, done.path[1:]])
                    gone = list(done.leaving)
                    if not gone and done.good and done.found.status is SolverStatus.ESCAPING:
                        gone = leaving_parts(ready, whole[-1], goal)
                    if gone:
                        return gone, whole
                    self._add_place(whole, places)
        return None

    def _add_place(self, path: Floats, places: list[Floats]) -> None:
        """Take the end of a path in among the places where nothing near it is known."""
        apart = min(np.abs(path[-1, :, :3] - p[-1, :, :3]).max() for p in places)
        if apart > NEW_PLACE * self.ready.clearance:
            if len(places) < MAX_PLACES:
                places.append(path)
            else:
                self.cut = True


def reduced(assembly: Assembly, keep: Sequence[int]) -> Assembly:
    """The assembly as made, with only some of its parts."""
    left = only(assembly, np.array(keep, dtype=np.int64))
    drawn = tuple(assembly.drawing.parts[k] for k in keep)
    gaps = tuple(joint for joint in assembly.drawing.gaps if set(joint.parts) <= set(left.names))
    return replace(left, drawing=replace(left.drawing, parts=drawn, gaps=gaps))
