"""Rounds of the program in space: missed pairs, two modes of the solver, and the checked path."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from wiggleroom.context import Context
from wiggleroom.spatial.bodies.rigid import SpatialPose, near_pieces
from wiggleroom.spatial.planes.carried_planes import carried_iterate
from wiggleroom.spatial.planes.separating_plane_program import (
    DISTANCE_RATIO,
    SeparatingPlanePoint,
    SeparatingPlaneProgram,
    build_planes,
)
from wiggleroom.spatial.planes.separating_plane_settings import SETTINGS
from wiggleroom.spatial.planes.separating_plane_solver import SeparatingPlaneSolution, SeparatingPlaneSolver
from wiggleroom.spatial.planes.spatial_objectives import SumOfTerms, Twist
from wiggleroom.spatial.planes.undetermined_planes import past_undetermined_planes
from wiggleroom.spatial.planes.working_set import facing_pairs, pairs_not_among, pairs_that_meet
from wiggleroom.spatial.search.spatial_path_check import free_path, passing_pairs
from wiggleroom.spatial.search.spatial_prepare import REACH, SpatialPrepared
from wiggleroom.spatial.search.straight_departure import StraightDeparture
from wiggleroom.spatial.search.turning_in_place import TurnInPlace, common_edges, endless_turn, turn_in_place
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

HORIZON = 4.0
"""A part that moves further than this multiple of the size is taken to leave."""
MAX_TURN = 4 * np.pi
"""A twist beyond this is taken to go on without limit, once a whole turn in place is shown to be free [rad]."""
MAX_ROUNDS = 8
"""Rounds at most: solve, find pairs that met, solve again."""
SLACK_ITERATIONS = 260
"""Number of iterations with slacks that run ahead, at most."""
INSIDE_STARTS, INSIDE_ITERATIONS = 3, 150
"""Where iterates stay inside all rows: number of starts beside rest, and most iterations of each."""
MAX_ROWS_OF_STARTS = 20_000
"""Larger programs are started once."""
MAX_PAIRS_UNDAMPED = 3000
"""Programs of more pairs of pieces begin with damped rows, without the pairs that do not face each other."""
MISSED = 1.0
"""Where pairs of pieces outside the program meet, all that come nearer than this multiple of the clearance join it."""
LONG_TURN = 0.3
"""A part that can turn in place further than this, as it is twisted, is turned there first [rad]."""
LEAST_SHARE = 1e-4
"""Axes of the part count too where a turn about them has more than this share about the direction asked for, and they are not the same."""
ROUNDED = 1e-6
"""Where contacts close to the last digits, the last waypoints lie nearer than can be checked: this share of the value is not missed."""
LOST = 1e-3
"""An end is worse than the begin where it is less by more than this share of the clearance."""
DEPARTED = 0.25
"""An unfinished motion further than this share of the size may be one that never ends: then straight departures are looked for."""


@dataclass(frozen=True, eq=False)
class SearchEnd:
    """Where a search ended.

    Parameters
    ----------
    program : SeparatingPlaneProgram
    found : SeparatingPlaneSolution
    path : (k, n, 6) float64 [mm, rad]
        Motions of the parts from rest.
    whole : bool
        True where the path is free as far as the solution.
    leaving : tuple of int
        Parts that go on straight for ever at the end of the path, which then ends beyond the solution.
    turning : tuple of int
        Parts that go on turning in place for ever.
    """

    program: SeparatingPlaneProgram
    found: SeparatingPlaneSolution
    path: Floats
    whole: bool
    leaving: tuple[int, ...] = ()
    turning: tuple[int, ...] = ()

    @property
    def good(self) -> bool:
        """True where the end is an answer and the path there is free."""
        return bool(self.leaving or self.turning) or (
            self.whole and self.found.status in (SolverStatus.CONVERGED, SolverStatus.ESCAPING)
        )


@dataclass(frozen=True)
class _Mode:
    """How the program is solved.

    Parameters
    ----------
    seed : int, optional
        Iterates stay inside all rows, from that start; without one slacks run ahead.
    damped : bool
        Rows are damped, and pairs of pieces that do not face each other join only where they meet.
    centred : bool
        Iterates are kept near the central path.
    """

    seed: int | None = None
    damped: bool = False
    centred: bool = False


_DAMPED, _CENTRED = _Mode(damped=True), _Mode(damped=True, centred=True)


@dataclass(eq=False)
class SpatialSearch:
    """Rounds of the program for one question; the best motion whose path is checked wins."""

    ready: SpatialPrepared
    objective: SumOfTerms
    context: Context
    begin: SpatialPose | None = None
    solver: str = "interior-point"
    once: bool = False
    """True: in one way only."""
    iterations: int = 0
    rounds: int = 0
    work: int = 0
    """Iterations, each times the rows of its program."""
    pieces: Ints = field(init=False)
    facing: Ints | None = None
    met: Ints = field(default_factory=lambda: np.zeros((0, 4), dtype=np.int64))

    def run(self) -> SearchEnd:
        """Search until an end is good; what is twisted and comes to no end may leave and turn for ever."""
        done = self._ended()
        over = (done.good and done.found.status is not SolverStatus.ESCAPING) or done.turning
        return done if over or self._asked_to_stop() else self._without_end(done)

    def _ended(self) -> SearchEnd:
        """Search until an end is good: where what is twisted can turn far in place, from there first."""
        turn = self._turn()
        if turn is None:
            return self._climbed()
        if turn.endless:
            return self._spinning(turn)
        begin, self.begin = self.begin, self.ready.grouping.pose_of(turn.path[-1])
        done = self._climbed()
        done = replace(done, path=np.concatenate([turn.path, done.path[1:]]))
        self.begin = begin
        if done.good or self.once:
            return done
        other = self._climbed()
        return other if other.good or self.value(other) > self.value(done) else done

    def _turn(self) -> TurnInPlace | None:
        """A long turn in place that a single twist asks for."""
        twist, ready = self._single_twist(), self.ready
        if twist is None or self._asked_to_stop():
            return None
        begin = self.begin or ready.grouping.bodies.rest
        motion, towards = ready.grouping.part_motion(begin), np.sign(twist.weight) * twist.direction
        edges = [begin.R[twist.body] @ e for e in common_edges(ready, twist.body)]
        axes = [towards, *(np.sign(e @ towards) * e for e in edges if LEAST_SHARE < abs(e @ towards) < 1 - LEAST_SHARE)]
        turns = [turn for axis in axes if (turn := turn_in_place(ready, motion, twist.body, axis))]
        longest = max(turns, key=lambda turn: turn.angle, default=None)
        return longest if longest is not None and longest.angle > LONG_TURN else None

    def _single_twist(self) -> Twist | None:
        """The twist that alone is asked for, if one is."""
        term = self.objective.terms[0]
        return term if len(self.objective.terms) == 1 and isinstance(term, Twist) else None

    def _without_end(self, done: SearchEnd) -> SearchEnd:
        """The end where what is twisted goes on to turn for ever, in place or once it has left; unchanged where it does not."""
        twist = self._single_twist()
        if twist is None:
            return done
        path = endless_turn(self.ready, done.path, twist.body, np.sign(twist.weight) * twist.direction)
        if path is None:
            return done
        who = np.flatnonzero(self.ready.grouping.body_of == twist.body).tolist()
        return replace(done, path=path, whole=True, turning=tuple(who))

    def _spinning(self, turn: TurnInPlace) -> SearchEnd:
        """The end where what is twisted turns in place for ever."""
        ready = self.ready
        program = build_planes(ready.grouping.bodies, self.objective, ready.pieces[:0], length=ready.clearance)
        found = SeparatingPlaneSolution(
            program.start, np.zeros(0), 0.0, SolverStatus.ESCAPING, 0, (program.start,), 0.0, False
        )
        who = np.flatnonzero(ready.grouping.body_of == turn.body).tolist()
        return SearchEnd(program, found, turn.path, True, turning=tuple(who))

    def _climbed(self) -> SearchEnd:
        """Search in one way after the other until an end is good.

        First slacks run ahead, then rows are damped too, then iterates are centred besides, at last they stay inside all rows, from several
        starts. Large programs begin with damped rows.
        """
        ready = self.ready
        self.pieces = (
            ready.pieces
            if self.begin is None
            else near_pieces(ready.grouping.bodies, self.begin, REACH * ready.clearance)
        )
        self.facing = None
        large = len(self.pieces) > MAX_PAIRS_UNDAMPED and self.solver != "ipopt"
        best = self._attempt(_DAMPED if large else _Mode())
        starts = 0 if large and best.whole else INSIDE_STARTS if best.program.rows <= MAX_ROWS_OF_STARTS else 1
        between = () if self.solver == "ipopt" else (_CENTRED,) if large else (_DAMPED, _CENTRED)
        for mode in (*between, *(_Mode(seed) for seed in range(starts))):
            if self._gained(best) or self.once or self._asked_to_stop():
                break
            done = self._attempt(mode)
            if self._gained(done) or self.value(done) > self.value(best):
                best = done
        return best

    def _gained(self, done: SearchEnd) -> bool:
        """True where the end is an answer no worse than the begin: first iterates may carry a part to where it lies on another."""
        lost = self.value(replace(done, path=done.path[:1])) - self.value(done)
        return done.good and lost <= LOST * self.ready.clearance

    def value(self, done: SearchEnd) -> float:
        """Objective at the end of the path that is certain."""
        value = 0.0
        for motion in done.path:
            value = self.objective.value(self.ready.grouping.pose_of(motion), value)
        return value

    def _attempt(self, mode: _Mode) -> SearchEnd:
        """Solve, and check the path; pairs of pieces outside the program that meet on it join, and it is solved again.

        That begins at rest; with damped rows, where pairs are looked for at a rough answer too, at the end of the round before, until one
        so begun comes to nothing: it may have carried parts through each other.
        """
        limit = MAX_TURN if any(isinstance(t, Twist) for t in self.objective.terms) else np.inf
        end: tuple[SeparatingPlaneProgram, SeparatingPlaneSolution] | None = None
        before: SearchEnd | None = None
        carries = mode.damped
        self.met = self.met[:0]
        for _ in range(MAX_ROUNDS):
            program, found = self._solved(mode, limit, end)
            self.iterations += found.iterations
            self.work += found.iterations * program.rows
            self.rounds += 1
            if self.solver != "ipopt" and program.rows <= MAX_ROWS_OF_STARTS:
                found, more = past_undetermined_planes(
                    program,
                    found,
                    horizon=HORIZON * self.ready.size,
                    most_turn=limit,
                    context=self.context,
                )
                self.iterations += more
                self.work += more * program.rows
            if found.status is SolverStatus.FAILED:
                done = self._departed(self._checked(program, found))
                if done.good:
                    return done
            missed, rest_of_way = self._missed(program, found)
            if not len(missed) or self._asked_to_stop():
                done = self._checked(program, found)
                if not done.whole and not self._asked_to_stop():
                    missed, rest_of_way = self._passed_through(program, found), []
            if not len(missed) or self._asked_to_stop():
                if before is not None and not done.good and self.value(before) > self.value(done):
                    return before
                if end is None or done.good or self._asked_to_stop():
                    return done
                end, carries, before = None, False, done
                continue
            if found.status is SolverStatus.CONVERGED and rest_of_way:
                done = self._checked(program, replace(found, path=tuple(rest_of_way)))
                if done.good:
                    return done
            self.pieces = np.unique(np.vstack([self.pieces, missed]), axis=0)
            self.met = np.unique(np.vstack([self.met, missed]), axis=0)
            carried = carries and program.planes > 0 and found.status in (SolverStatus.CONVERGED, SolverStatus.STOPPED)
            end = (program, found) if carried else None
        return self._checked(program, found)

    def _solved(
        self,
        mode: _Mode,
        limit: float,
        before: tuple[SeparatingPlaneProgram, SeparatingPlaneSolution] | None = None,
    ) -> tuple[SeparatingPlaneProgram, SeparatingPlaneSolution]:
        """The program, and its solution from beside rest or from the end of a round before, twists up to a limit [rad]."""
        ready, horizon = self.ready, HORIZON * self.ready.size
        pieces = self._working_set() if mode.damped else self.pieces
        program = build_planes(
            ready.grouping.bodies,
            self.objective,
            pieces,
            length=ready.clearance,
            rest=self.begin,
            distance_ratio=1.0 if mode.damped else DISTANCE_RATIO,
        )
        if self.solver == "ipopt":
            from wiggleroom.spatial.planes.separating_plane_ipopt import solve_with_ipopt

            return program, solve_with_ipopt(
                program,
                seed=mode.seed or 0,
                horizon=horizon,
                most_turn=limit,
                stop=self.context.stop,
                progress=self.context.progress,
            )
        start = None if before is None else carried_iterate(program, *before)
        for carried_mu in SETTINGS.carried_mu:
            solver = SeparatingPlaneSolver(
                program,
                inside=mode.seed is not None,
                damped=mode.damped,
                centred=mode.centred,
                most=SLACK_ITERATIONS if mode.seed is None else INSIDE_ITERATIONS,
                seed=mode.seed or 0,
                horizon=horizon,
                most_turn=limit,
                stop=self.context.stop,
                progress=self.context.progress,
                lacks=partial(self._lacks, program) if mode.damped else None,
            )
            found = solver.solve(start, carried_mu)
            if start is None or found.status is not SolverStatus.FAILED or self._asked_to_stop():
                break
            self.iterations += found.iterations
        return program, found

    def _working_set(self) -> Ints:
        """Pairs of pieces that face each other at the begin, and those that met on the way in an earlier round."""
        if self.facing is None:  # what joins later is further apart at the begin, or did not face each other
            bodies, pose = self.ready.grouping.bodies, self.begin or self.ready.grouping.bodies.rest
            near = facing_pairs(bodies, pose, self.pieces, self.ready.clearance, REACH * self.ready.clearance)
            self.facing = self.pieces[near]
        return np.unique(np.vstack([self.facing, self.met]), axis=0)

    def _checked(self, program: SeparatingPlaneProgram, found: SeparatingPlaneSolution) -> SearchEnd:
        """The end with its path, as far as that is free; what is worth the solution but for rounding is as far as it goes."""
        path, whole = free_path(self.ready, program, found.path or [program.start])
        done = SearchEnd(program, found, path, whole)
        if whole or found.status is not SolverStatus.CONVERGED:
            return done
        reached = self.value(done)
        value = self.objective.value(found.point.pose, reached)
        return replace(done, whole=bool(value - reached <= ROUNDED * max(abs(value), self.ready.clearance)))

    def _departed(self, done: SearchEnd) -> SearchEnd:
        """The same end where what is pulled can go on straight for ever from it, else unchanged."""
        pulls = self.objective.pulls(self.ready.grouping.pose_of(done.path[-1])) or []
        total = np.sum([t.direction for t in pulls], axis=0) if pulls else np.zeros(3)
        if not total.any():
            return done
        if np.abs(done.path[-1, :, :3]).max() < DEPARTED * self.ready.size:
            return done
        departure = StraightDeparture(self.ready, done.path[-1], total / np.linalg.norm(total), self.context.stop)
        leaving = departure.parts_with(sorted({t.body for t in pulls}))
        if not leaving:
            return done
        return replace(done, path=np.concatenate([done.path, departure.end(leaving)[None]]), leaving=tuple(leaving))

    def _asked_to_stop(self) -> bool:
        return self.context.stopped

    def _missed(
        self, program: SeparatingPlaneProgram, found: SeparatingPlaneSolution
    ) -> tuple[Ints, list[SeparatingPlanePoint]]:
        """Pairs of pieces outside the program that come near where some of them meet, and the waypoints where none do.

        Where they meet at the end, the path is not looked at.
        """
        bodies, reach = self.ready.grouping.bodies, MISSED * self.ready.clearance
        at_end = pairs_that_meet(bodies, found.path[-1].pose, program.pieces, reach)
        if len(at_end):
            return at_end, []
        some = [*found.path[:: max(1, len(found.path) // 40)], *found.path[-1:]]
        near = [pairs_that_meet(bodies, point.pose, program.pieces, reach) for point in some]
        return np.unique(np.vstack(near), axis=0), [p for p, n in zip(some, near, strict=True) if not len(n)]

    def _lacks(self, program: SeparatingPlaneProgram, pose: SpatialPose) -> bool:
        """True where pairs of pieces outside the program overlap."""
        return len(pairs_that_meet(self.ready.grouping.bodies, pose, program.pieces, 0.0)) > 0

    def _passed_through(self, program: SeparatingPlaneProgram, found: SeparatingPlaneSolution) -> Ints:
        """Pairs of pieces outside the program that meet between two waypoints: small pieces go through each other in one step."""
        bodies = self.ready.grouping.bodies
        return pairs_not_among(bodies, passing_pairs(bodies, [point.pose for point in found.path]), program.pieces)
