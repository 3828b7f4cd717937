"""Does it come apart, in space: which parts leave, in which order, along which path."""

from __future__ import annotations

import itertools
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.disassembly.interlock_result import Escape, Interlock
from wiggleroom.errors import InputError, Stop
from wiggleroom.spatial.confinement import EFFORTS, PairwiseConfinement
from wiggleroom.spatial.lattice_search import lattice, lattice_motions, lattice_search
from wiggleroom.spatial.planes.spatial_objectives import Displacement, SumOfTerms
from wiggleroom.spatial.solids.convex import distinct_axes
from wiggleroom.spatial.solids.spatial_model import SpatialAssembly
from wiggleroom.spatial.spatial_bodies import grouped
from wiggleroom.spatial.spatial_flex import leaving_parts
from wiggleroom.spatial.spatial_prepare import SpatialPrepared, prepare_spatial
from wiggleroom.spatial.spatial_search import SpatialSearch
from wiggleroom.spatial.straight_departure import StraightDeparture
from wiggleroom.spatial.turn_roadmap import TurnRoadmap
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
NEW_PLACE = 3.0
"""A place is new where a part lies elsewhere by more than this multiple of the clearance."""


def check_spatial(
    assembly: SpatialAssembly, *, stop: Stop | None = None, every: bool = True
) -> Interlock[SpatialAssembly]:
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
    left = _standing(assembly)
    names = assembly.names
    alive = list(range(len(names)))
    far = np.zeros((len(names), 6))
    escapes: list[Escape] = []
    asked, cut, proven = 0, False, False
    while True:
        stage = _Stage(prepare_spatial(left), stop)
        found = stage.escape_path()
        asked += stage.questions
        if found is None:
            proven = stage.proven
            cut = stage.cut_short() or stage.loose or (stage.cut and not stage.exhaustive)
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
        left = _reduced(left, keep)
        if not every or len(alive) < 2 or not grouped(left).bodies.moves.any():
            break
    if escapes:
        verdict, sure = Separability.COMES_APART, Certainty.PROVEN
    else:
        verdict = Separability.UNKNOWN if cut and not proven else Separability.INTERLOCKED
        sure = Certainty.PROVEN if proven else Certainty.SEARCHED
    remains = tuple(names[k] for k in alive)
    return Interlock(
        assembly, verdict, sure, tuple(escapes), remains=remains, questions=asked, seconds=time.perf_counter() - began
    )


@dataclass(eq=False)
class _Stage:
    """Looks for the next parts that leave."""

    ready: SpatialPrepared
    stop: Stop | None
    questions: int = 0
    cut: bool = False
    exhaustive: bool = False
    """True where parts made of boxes were searched exhaustively by whole steps: then pulls that were not decided do not count."""
    proven: bool = False
    """True where it is proven that none leave."""
    loose: bool = False
    """True where a body can turn in place, or the work for turns was not enough to tell: then a search says nothing of what stays."""

    def escape_path(self) -> tuple[list[int], Floats] | None:
        """Parts that leave, and the path of all (k, n, 6); None where none was found."""
        rest = np.zeros((len(self.ready.assembly.parts), 6))
        places: list[Floats] = [rest[None]]
        axes = self._axes()
        roadmap = TurnRoadmap(self.ready, axes[:MAX_AXES], self.stop)
        out = self._straight(rest[None], axes)
        if out is not None or self.cut_short():
            return out
        held = PairwiseConfinement(self.ready, self.stop)
        self.proven = held.prove_by_shape()
        if self.proven:
            return None
        out = self._by_steps()
        if out is not None or self.cut_short():
            return out
        asked, efforts = 0, list(EFFORTS)
        while asked < len(places):
            # straight paths are cheap: all of them from all places first
            for path in places[asked:]:
                if asked in PROVE_AFTER:
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
        for effort in efforts:
            self.proven = held.prove(effort)
            if self.proven or self.cut_short():
                return None
        known = len(places)
        for path in places[:MAX_PULLED]:
            out = self._pulled(path, axes, places)
            if out is not None or self.cut_short():
                return out
        self.cut |= known > MAX_PULLED or len(places) > known
        return None

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
        """A path out by whole steps, for parts made of boxes; notes where there is none."""
        grid = lattice(self.ready)
        if grid is None:
            return None
        found = lattice_search(grid, self.stop)
        if not found.offsets:
            # gaps that add up to a step let parts through where whole steps do not
            self.exhaustive = found.complete and self.ready.assembly.widest_gap * len(grid.stands) < grid.step
            return None
        path = lattice_motions(self.ready, grid, found)
        if any(self.ready.checker.overlaps(one, other) for one, other in itertools.pairwise(path)):
            return None
        direction = np.zeros((1, 3))
        direction[0, found.axis] = 1.0
        return self._straight(path, direction)

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
        if self.stop is not None and self.stop.is_set():
            self.cut = True
        return self.cut and self.stop is not None and self.stop.is_set()

    def _axes(self) -> Floats:
        """Normals of faces in the world, those of most faces first."""
        normals: list[Floats] = []
        count: list[int] = []
        for body in self.ready.grouping.bodies.pieces:
            for piece in body:
                for n in piece.normals:
                    for k, known in enumerate(normals):
                        if np.linalg.norm(np.cross(known, n)) < 1e-6:
                            count[k] += 1
                            break
                    else:
                        normals.append(n)
                        count.append(1)
                if len(normals) > 400:
                    break
        order = np.argsort(-np.array(count), kind="stable")
        found = [normals[k] for k in order[:MAX_DIRECTIONS]]
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
                    done = SpatialSearch(ready, goal, self.stop, None, begin).run()
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


def _standing(assembly: SpatialAssembly) -> SpatialAssembly:
    """The assembly with something that stands: the part of the largest volume where nothing is fixed."""
    if len(assembly.parts) < 2:
        finding = f"{assembly.drawing.source or 'the assembly'}: there is only one part, which nothing can leave; give at least two"
        raise InputError(finding)
    if any(p.fixed for p in assembly.parts):
        return assembly
    largest = int(np.argmax([m.volume for m in assembly.made]))
    parts = tuple(replace(p, fixed=k == largest) for k, p in enumerate(assembly.parts))
    return replace(assembly, drawing=replace(assembly.drawing, parts=parts))


def _reduced(assembly: SpatialAssembly, keep: Sequence[int]) -> SpatialAssembly:
    """The assembly as made, with only some of its parts."""
    parts = tuple(assembly.parts[k] for k in keep)
    names = {p.name for p in parts}
    old = assembly.drawing
    glue = tuple(g for g in (tuple(n for n in g if n in names) for g in old.glue) if len(g) > 1)
    ignore = tuple(p for p in old.ignore if set(p) <= names)
    gaps = tuple(joint for joint in old.gaps if set(joint.parts) <= names)
    drawing = replace(old, parts=parts, glue=glue, ignore=ignore, gaps=gaps, goals=())
    return SpatialAssembly(drawing, tuple(assembly.made[k] for k in keep))
