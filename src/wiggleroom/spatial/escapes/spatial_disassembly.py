"""Does it come apart, in space: which parts leave, in which order, along which path."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.assembly import Assembly
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.disassembly.disassembly_sequence import NO_BODIES, Disassembly, Stage, Stages
from wiggleroom.disassembly.ground import with_ground
from wiggleroom.disassembly.interlock_result import Interlock
from wiggleroom.disassembly.remaining import only
from wiggleroom.drawing.model import AXES, Part
from wiggleroom.planning.steps import moves_of, without_rests
from wiggleroom.search.state_tree import Exit, Level, StateTree
from wiggleroom.spatial.bodies.rigid import near_pieces
from wiggleroom.spatial.bodies.rotations import exponential, logarithm
from wiggleroom.spatial.bodies.spatial_bodies import grouped
from wiggleroom.spatial.escapes.lattice import lattice
from wiggleroom.spatial.escapes.lattice_search import lattice_motions, lattice_search
from wiggleroom.spatial.escapes.planar_slides import TranslationSpace
from wiggleroom.spatial.escapes.turn_roadmap import TurnRoadmap
from wiggleroom.spatial.planes.spatial_objectives import Displacement, SumOfTerms, Twist
from wiggleroom.spatial.proof.confinement import EFFORTS, PairwiseConfinement
from wiggleroom.spatial.search.spatial_prepare import SpatialPrepared, prepare_spatial
from wiggleroom.spatial.search.spatial_search import SpatialSearch
from wiggleroom.spatial.search.spatial_starts import best_of_starts, random_leads
from wiggleroom.spatial.search.straight_departure import StraightDeparture
from wiggleroom.spatial.search.turning_in_place import ACROSS, common_edges, turn_in_place, turns_in_place
from wiggleroom.spatial.solids.convex import distinct_axes
from wiggleroom.spatial.spatial_flex import leaving_parts
from wiggleroom.verdict import Certainty, Separability, SolverStatus

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_DIRECTIONS = 13
"""Straight paths are tried along at most this many axes, both ways: those of most faces."""
MAX_PLACES, MAX_PULLED = 200, 3
"""Places, each reached by a checked path, from which straight paths are tried, and from which largest motions are searched."""
MAX_UNSURE_WORK = 6e6
"""Work of largest motions, in iterations times rows, where these can find a way out but no more say that there is none."""
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
MAX_ARRANGEMENTS = 40
"""At most so many arrangements that whole steps lead to are gone on from by slides and turns."""
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
    names, look = assembly.names, SpatialStages(with_ground(assembly), context)
    n = len(names)
    done = Disassembly(names, look.stages, np.zeros((n, 6)), returning=True)
    last, escapes = done.take_apart(np.arange(n), every=every), done.escapes
    return Interlock(
        assembly,
        Separability.COMES_APART if escapes else last.ended,
        Certainty.PROVEN if escapes else last.certainty,
        escapes,
        spins=_spins(look.held, context) if every and look.held is not None else (),
        remains=tuple(names[k] for k in done.remaining),
        questions=done.questions,
        seconds=time.perf_counter() - began,
    )


@dataclass(eq=False)
class SpatialStages:
    """The next parts in space that leave.

    Parameters
    ----------
    assembly : Assembly
        Something in it stands.
    context : Context
    held : SpatialPrepared or None
        Parts of which none were found to leave, where those were asked about last.
    """

    assembly: Assembly
    context: Context
    held: SpatialPrepared | None = None

    @property
    def stages(self) -> Stages:
        """As a sequence takes them."""
        return Stages(self.left, self.next, continued)

    @property
    def stuck(self) -> list[str]:
        """Names of parts that were found not to leave others that stand."""
        return [] if self.held is None else [part.name for part in self.held.assembly.parts if not part.fixed]

    def left(self, alive: Ints, motion: Floats) -> Assembly | None:
        """Some parts where they are, with something that stands; None where some have left and nothing else can."""
        if len(alive) == len(motion):
            return self.assembly
        self.held = None
        left = displaced(reduced(self.assembly, alive.tolist()), motion[alive])
        if len(grouped(left).bodies.at) < 2:
            return None
        left = with_ground(left)
        return left if grouped(left).bodies.moves.any() else None

    def next(self, left: Assembly, _: Ints, __: Floats) -> Stage:
        """The next of these parts that leave."""
        ready = prepare_spatial(left)
        stage = DisassemblyStage(ready, self.context)
        found = stage.escape_path()
        self.held = ready if found is None else None
        if found is None:
            verdict, sure = stage.verdict()
            whole = verdict is not Separability.UNKNOWN
            return Stage(verdict, sure, NO_BODIES, None, NO_BODIES, stage.questions, whole=whole)
        who, path = found[0], without_rests(found[1])
        moves = moves_of(path)
        return Stage(
            Separability.COMES_APART, Certainty.PROVEN, np.array(who), path, NO_BODIES, stage.questions, moves=moves
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


_Departure = tuple[list[int], Floats]
"""Parts that leave, and the path of all (k, n, 6) [mm, rad] from rest on which they do."""


@dataclass(frozen=True, eq=False)
class _Leg:
    """What leads from one place to the next.

    Parameters
    ----------
    path : (k, n, 6) float64 [mm, rad]
        Checked motions of all parts, the first those of the place before.
    turned : int
        The body that turned alone; -1 where none did.
    """

    path: Floats
    turned: int = -1


_Steps = Iterator[tuple[Floats, _Leg] | Exit[_Departure]]
"""Places that are reached from one, and what leaves from it."""


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

    def __post_init__(self) -> None:
        self._rest = np.zeros((len(self.ready.assembly.parts), 6))
        self._axes = _face_axes(self.ready)
        self._unseen = False
        self._tree: StateTree[Floats, _Leg] = StateTree(self._rest, self._is_new, MAX_PLACES)
        self._roadmap = TurnRoadmap(self.ready, self._axes[:MAX_AXES], self.context)
        self._held = PairwiseConfinement(self.ready, self.context)
        self._efforts = [] if self.ready.assembly.overshoot else list(EFFORTS)
        self._work = 0

    def verdict(self) -> tuple[Separability, Certainty]:
        """What became of the parts where no path out was found."""
        if self.proven:
            return Separability.INTERLOCKED, Certainty.PROVEN
        return (Separability.UNKNOWN if self._unsure else Separability.INTERLOCKED), Certainty.SEARCHED

    @property
    def _unsure(self) -> bool:
        """True where a search says nothing of what stays; what holds a cover need not hold what it covers."""
        covers = self.ready.assembly.overshoot > 0
        return covers or self.context.stopped or self.loose or (self.cut and not self.exhaustive)

    @property
    def _is_loose(self) -> bool:
        """True where a body was found to turn in place, or not everything that slides and turns lead to was looked at."""
        roadmap = self._roadmap
        return roadmap.turns or roadmap.spent or roadmap.skipped or self._unseen

    @property
    def _is_worked_off(self) -> bool:
        """True where largest motions have had their work and, whatever more of them find, what stays is unsure."""
        return (self._is_loose or self._unsure) and self._work > MAX_UNSURE_WORK

    def escape_path(self) -> _Departure | None:
        """Parts that leave, and the path of all (k, n, 6); None where none was found."""
        tree = self._tree
        out = self._straight(self._rest[None], self._axes)
        if out is not None or self.context.stopped:
            return out
        self.proven = not self.ready.assembly.overshoot and self._held.prove_by_shape()
        if self.proven:
            return None
        out = self._by_steps()
        if out is None:
            levels = (Level(steps, lambda: self.proven) for steps in (self._moved_alone, self._pulled))
            out = tree.search(*levels, context=self.context)
        if out is None and not self.proven:
            self.cut |= tree.full or len(tree.states) > MAX_PULLED
            self.loose = self._is_loose
            if not self._unsure:
                self.loose = any(self._may_tilt_out(v.state) for v in tree.states[:MAX_PULLED])
            if not self._unsure:  # turns as one take long to look for, and could only make it less sure
                self.loose = any(self._turn_together(v.state) for v in tree.states[:MAX_ARRANGEMENTS])
        return out

    def _is_new(self, motion: Floats, leg: _Leg) -> bool:
        """True where a turned body is not connected by translations with where it was, or a part lies elsewhere than in all places."""
        if leg.turned >= 0:
            return self._roadmap.is_new(motion, leg.turned)
        apart = min(np.abs(motion[:, :3] - place.state[:, :3]).max() for place in self._tree.states)
        return bool(apart > NEW_PLACE * self.ready.clearance)

    def _path(self, here: int) -> Floats:
        """Motions (k, n, 6) from rest to a place."""
        return np.concatenate([self._rest[None], *(leg.path[1:] for leg in self._tree.steps_to(here))])

    def _prove(self) -> None:
        """Try the next proof that nothing leaves, if one is left."""
        if self._efforts:
            self.proven = self._held.prove(self._efforts.pop(0))

    def _may_tilt_out(self, motion: Floats) -> bool:
        """True where a body could leave by translations if it were smaller by as much as the turns move it that its play allows.

        The largest turns either way about three axes are searched, with whatever slides go with them.
        """
        ready = self.ready
        begin = ready.grouping.pose_of(motion)
        free = ready.grouping.bodies.free
        for b in np.flatnonzero(free[:, :3].all(axis=1) & free[:, 3:].any(axis=1)).tolist():
            tilts = np.zeros((2, 3))
            for (way, sign), (k, axis) in itertools.product(enumerate((-1.0, 1.0)), enumerate(np.eye(3))):
                self.questions += 1
                goal = SumOfTerms((Twist(b, sign * axis, 1.0),))
                turned = SpatialSearch(ready, goal, self.context.silent, begin, once=True).run()
                turn = ready.grouping.pose_of(turned.path[-1]).R[b] @ begin.R[b].T
                tilts[way, k] = max(0.0, sign * float(logarithm(turn[None])[0, k]))
                if self.context.stopped:
                    return True
            space = TranslationSpace(ready, motion, b, axes=self._axes[:MAX_AXES], context=self.context, tilts=tilts)
            if space.is_open():
                return True
        return False

    def _turn_together(self, motion: Floats) -> bool:
        """True where two neighbours, or all that move, turn in place as one: each may keep the other from turning alone.

        They turn about axes about which none of them is locked; locked slides are taken as free, which can only find more.
        """
        assembly = unlocked(displaced(self.ready.assembly, motion))
        group, free = grouped(assembly), self.ready.grouping.bodies.free[:, 3:]
        moving = np.flatnonzero(self.ready.grouping.bodies.moves)
        near = near_pieces(group.bodies, group.pose_of(self._rest), NEW_PLACE * self.ready.clearance)[:, [0, 2]]
        pairs = np.unique(np.sort(near[np.isin(near, moving).all(axis=1)], axis=1), axis=0)
        for bodies in (moving.tolist(), *pairs[:MAX_TOGETHER].tolist()):
            who, turns = np.flatnonzero(np.isin(group.body_of, bodies)), free[bodies].all(axis=0)
            if len(bodies) < 2 or not turns.any() or self.context.stopped:
                continue
            glue = (*assembly.drawing.glue, tuple(assembly.names[k] for k in who))
            ready = prepare_spatial(replace(assembly, drawing=replace(assembly.drawing, glue=glue)))
            body = int(ready.grouping.body_of[who[0]])
            edges = np.array(common_edges(ready, body))
            axes = np.eye(3)[turns] if turns.sum() == 1 else edges[(np.abs(edges[:, ~turns]) < ACROSS).all(axis=1)]
            if any(turns_in_place(ready, self._rest, body, axes)):
                return True
        return False

    def _straight(self, path: Floats, axes: Floats) -> _Departure | None:
        """Parts that leave straight from the end of a path; None also where it was asked to stop."""
        for axis in axes:
            for direction in (axis, -axis):
                if self.context.stopped:
                    return None
                departure = StraightDeparture(self.ready, path[-1], direction, self.context.stop)
                group = departure.first()
                if group:
                    return group, np.concatenate([path, departure.end(group)[None]])
        return None

    def _by_steps(self) -> _Departure | None:
        """A path out by whole steps, for parts on a lattice; notes where there is none."""
        ready = self.ready
        grid = lattice(ready)
        if grid is None:
            return None
        found = lattice_search(grid, self.context)
        if not found.offsets:
            # clearances that add up to a step let parts through where whole steps do not
            self.exhaustive = found.complete and grid.clearance * len(grid.stands) < grid.step.min()
            if grid.step.min() > NEW_PLACE * ready.clearance:  # other steps lead no further than the play
                self._go_on_from(lattice_motions(ready, grid, found.arrangements), found.before)
            return None
        path = lattice_motions(ready, grid, found.offsets)
        if any(ready.checker.overlaps(one, other) for one, other in itertools.pairwise(path)):
            return None
        return self._straight(path, grid.frame[:, found.axis][None])

    def _go_on_from(self, arrangements: Floats, before: Sequence[int]) -> None:
        """Make places of what whole steps lead to, in the order in which they were reached, as far as there are not too many.

        Whole steps know of no locks: what these forbid is left out.
        """
        locked = ~self.ready.grouping.bodies.free[self.ready.grouping.body_of, :3]
        place = {0: 0}
        for k in range(1, len(arrangements)):
            if np.abs(arrangements[k, :, :3][locked]).max(initial=0.0) > SAME_PLACE:
                continue
            leg = arrangements[[before[k], k]]
            if before[k] not in place or len(place) == MAX_ARRANGEMENTS or self.ready.checker.overlaps(*leg):
                self._unseen = True
                return
            place[k] = self._tree.append(arrangements[k], place[before[k]], _Leg(leg))

    def _moved_alone(self, here: int) -> _Steps:
        """What leaves straight, or by translations or a turn of one body; and where slides and turns of one body lead.

        Straight paths are cheap: all of them from all places first.
        """
        if here in PROVE_AFTER:
            self._prove()
            if self.proven:
                return
        motion, path = self._tree.states[here].state, self._path(here)
        out = self._straight(path, self._axes)
        if out is not None:
            yield Exit(out)
        for b in np.flatnonzero(self.ready.grouping.bodies.moves).tolist():
            yield from self._rearranged(motion, path, b)
        yield from self._slides(motion)

    def _rearranged(self, motion: Floats, path: Floats, body: int) -> _Steps:
        """A path out by translations or a turn of a body alone, and where its turns lead."""
        roadmap = self._roadmap
        roadmap.note_locked(motion, body)
        space = roadmap.new_space(motion, body) if self.ready.grouping.bodies.free[body, :3].all() else None
        if space is not None and (found := space.way_out()) is not None:
            slid, axis = found
            out = self._along(np.concatenate([path, slid[1:]]), axis, body)
            if out is not None:
                yield Exit(out)
        for turned, axis, many in roadmap.turned_in_place(motion, body):
            self.context.go_on()
            out = self._along(np.concatenate([path, turned[1:]]), axis, body)
            if out is not None:
                yield Exit(out)
            if many:
                yield turned[-1], _Leg(turned, body)
        for turned in () if space is None else roadmap.turned_from(motion, body, space):
            yield turned[-1], _Leg(turned, body)
        self.context.go_on()

    def _along(self, path: Floats, axis: Floats, body: int) -> _Departure | None:
        """A body that leaves along an axis, ahead or back, from the end of a path, and what it takes along."""
        for direction in (axis, -axis):
            departure = StraightDeparture(self.ready, path[-1], direction, self.context.stop)
            group = departure.parts_with([body])
            if group:
                return group, np.concatenate([path, departure.end(group)[None]])
        return None

    def _slides(self, motion: Floats) -> _Steps:
        """Places that a body alone reaches by going straight until little more than its clearance is left."""
        ready, body_of = self.ready, self.ready.grouping.body_of
        moves = ready.grouping.bodies.free[:, :3]
        for b in np.flatnonzero(moves.any(axis=1)):
            mine = np.flatnonzero(body_of == b)
            for direction in (*self._axes, *-self._axes):
                self.context.go_on()
                if not moves[b][np.abs(direction) > 1e-12].all():
                    continue
                far = ready.checker.room(motion, mine, direction, ready.size, self.context.stop)
                if not NEW_PLACE * ready.clearance < far < ready.size:
                    continue
                end = motion.copy()
                end[mine, :3] += (far - ready.clearance) * direction
                if not ready.checker.doubtful(motion, end, first=True, only=mine.tolist()):
                    yield end, _Leg(np.stack([motion, end]))

    def _pulled(self, here: int) -> _Steps:
        """Pull every body in every direction, from the first places; from the first of all also on the paths of random pulls.

        Where only a way out would still say anything, that ends by counted work.
        """
        while self._efforts and not self.proven:
            self._prove()
            self.context.go_on()
        if self.proven or here >= MAX_PULLED:
            return
        ready, motion, path = self.ready, self._tree.states[here].state, self._path(here)
        begin, leads = ready.grouping.pose_of(motion), None
        for b in np.flatnonzero(ready.grouping.bodies.moves).tolist():
            for direction in (sign * axis for axis in self._axes[:3] for sign in (1.0, -1.0)):
                self.context.go_on()
                if self._is_worked_off:
                    self.cut = True
                    return
                goal = SumOfTerms((Displacement(b, np.zeros(3), direction, begin.T[b]),))
                self.questions += 1
                climb = SpatialSearch(ready, goal, self.context.silent, begin)
                done = climb.run()
                if not len(done.program.a):
                    continue
                self.cut |= not done.good and done.found.error > UNDECIDED
                if here == 0:
                    leads = list(random_leads(climb, None)) if leads is None else leads
                    done = best_of_starts(climb, done, leads, once=True).end
                gone = list(done.leaving)
                if not gone and done.good and done.found.status is SolverStatus.ESCAPING:
                    gone = leaving_parts(ready, done.path[-1], goal)
                if gone:
                    yield Exit((gone, np.concatenate([path, done.path[1:]])))
                self.cut |= self._is_new(done.path[-1], _Leg(done.path))  # what lies beyond is not gone on from
                self._work += climb.work


def _face_axes(ready: SpatialPrepared) -> Floats:
    """Normals of faces in the world (k, 3), those of most faces first."""
    normals = np.vstack([piece.normals for body in ready.grouping.bodies.pieces for piece in body])
    whole = np.round(normals / 1e-6)
    first_of_three = np.take_along_axis(whole, (whole != 0).argmax(axis=1)[:, None], axis=1)
    _, first, count = np.unique(whole * np.sign(first_of_three) + 0.0, axis=0, return_index=True, return_counts=True)
    found = normals[first[np.lexsort((first, -count))[:MAX_DIRECTIONS]]]
    return distinct_axes(np.array([*found, *np.eye(3)]), 1e-6)


def reduced(assembly: Assembly, keep: Sequence[int]) -> Assembly:
    """The assembly as made, with only some of its parts."""
    left = only(assembly, np.array(keep, dtype=np.int64))
    drawn = tuple(assembly.drawing.parts[k] for k in keep)
    gaps = tuple(joint for joint in assembly.drawing.gaps if set(joint.parts) <= set(left.names))
    return replace(left, drawing=replace(left.drawing, parts=drawn, gaps=gaps))


def continued(before: Floats, path: Floats) -> Floats:
    """Motions since rest (k, n, 6) [mm, rad] along a path that begins where a motion (n, 6) has taken the parts.

    >>> turn = np.array([[1.0, 0, 0, 0, 0, np.pi / 2]])
    >>> continued(turn, np.array([[[0, 2.0, 0, 0, 0, np.pi / 4]]]))[0, 0].round(6).tolist()
    [1.0, 2.0, 0.0, 0.0, 0.0, 2.356194]
    """
    out = np.empty_like(path)
    out[:, :, :3] = before[:, :3] + path[:, :, :3]
    turns = exponential(path[:, :, 3:].reshape(-1, 3)).reshape(*path.shape[:2], 3, 3) @ exponential(before[:, 3:])
    out[:, :, 3:] = logarithm(turns.reshape(-1, 3, 3)).reshape(*path.shape[:2], 3)
    return out


def unlocked(assembly: Assembly) -> Assembly:
    """The assembly without locks; parts that were locked altogether are fixed."""
    parts, drawn = (
        tuple(replace(p, fixed=p.fixed or len(p.lock) == len(AXES), lock=frozenset()) for p in some)
        for some in (assembly.parts, assembly.drawing.parts)
    )
    return Assembly(parts, replace(assembly.drawing, parts=drawn))


def displaced(assembly: Assembly, motion: Floats) -> Assembly:
    """The assembly as made, at rest where a motion (n, 6) [mm, rad] has taken it."""
    if not motion.any():
        return assembly
    turns = exponential(motion[:, 3:])

    def at(parts: tuple[Part, ...]) -> tuple[Part, ...]:
        found = []
        for part, turn, shift, middle in zip(parts, turns, motion[:, :3], assembly.reference, strict=True):
            place = turn @ (np.asarray(part.at) - middle) + middle + shift
            found.append(replace(part, at=tuple(place.tolist()), R=turn @ part.R))
        return tuple(found)

    return Assembly(at(assembly.parts), replace(assembly.drawing, parts=at(assembly.drawing.parts)))
