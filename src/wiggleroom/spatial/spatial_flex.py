"""How far can it move, in space: rounds of the program, a checked way, and the answer put together."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import InputError, Stop, TouchingError
from wiggleroom.spatial.overlap_check import deepest_overlap
from wiggleroom.spatial.plane_contacts import plane_contacts
from wiggleroom.spatial.plane_program import PlaneProgram, best_axis, build_planes
from wiggleroom.spatial.plane_solver import PlaneSolution, PlaneSolver
from wiggleroom.spatial.plane_way import refined
from wiggleroom.spatial.rigid import Pose, near_pieces
from wiggleroom.spatial.spatial_answer import SpatialAnswer
from wiggleroom.spatial.spatial_assembly import goal_findings
from wiggleroom.spatial.spatial_bodies import Grouping, grouped
from wiggleroom.spatial.spatial_model import SpatialAssembly, SpatialGoal, SpatialTurn, Weight
from wiggleroom.spatial.spatial_objectives import Displacement, SumOfTerms, Twist
from wiggleroom.spatial.swept_check import SweptCheck
from wiggleroom.verdict import SolverStatus, Verdict

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

REACH = 3.0
"""Pieces closer than this multiple of the typical clearance are in the program from the start."""
TOUCHING = 1e-6
"""A clearance below this share of the size counts as touching."""
HORIZON = 4.0
"""A part that moves further than this multiple of the size is taken to leave."""
MOST_TURN = 4 * np.pi
"""A twist beyond this is taken to go on without limit, once a whole turn in place is shown to be free [rad]."""
MOST_ROUNDS = 8
NEARLY = 1e-2
"""An end that is certain is taken before one that lies this share of a clearance further."""
OVERLAP = 1e-9
"""Overlaps shallower than this share of the size are rounding."""


@dataclass(frozen=True, eq=False)
class SpatialPrepared:
    """A spatial assembly made ready for questions.

    Parameters
    ----------
    assembly : SpatialAssembly
    grouping : Grouping
    clearance : float [mm]
        Typical clearance between neighbours.
    size : float [mm]
    pieces : (k, 4) int64
        Pairs of pieces in the program from the start.
    checker : SweptCheck
    """

    assembly: SpatialAssembly
    grouping: Grouping
    clearance: float
    size: float
    pieces: Ints
    checker: SweptCheck


def prepare_spatial(assembly: SpatialAssembly) -> SpatialPrepared:
    """Bodies and near pairs of pieces of an assembly.

    Raises
    ------
    TouchingError
        If two parts touch or overlap after the gap is applied.
    InputError
        If nothing can move.
    """
    group, size = grouped(assembly), assembly.size
    bodies = group.bodies
    if not bodies.moves.any():
        finding = f"{assembly.drawing.source or 'the assembly'}: every part is fixed; at least one must be free to move"
        raise InputError(finding)
    first = near_pieces(bodies, bodies.rest, max(2 * assembly.gap, 1e-3 * size))
    apart = np.array([best_axis(bodies, bodies.rest, who, np.empty(3))[0] for who in first.tolist()])
    if len(apart) and apart.min() < TOUCHING * size:
        k = int(apart.argmin())
        raise _touching(assembly, group, first[k], float(apart[k]))
    near = apart[apart > 0]
    clearance = assembly.gap or (float(np.median(near)) if len(near) else 1e-2 * size)
    pieces = near_pieces(bodies, bodies.rest, REACH * clearance)
    return SpatialPrepared(assembly, group, clearance, size, pieces, SweptCheck(assembly))


def _touching(assembly: SpatialAssembly, group: Grouping, who: Ints, apart: float) -> TouchingError:
    """Error that names the two parts."""
    a, i, b, j = who.tolist()
    one, other = (assembly.names[group.bodies.owner[k][p]] for k, p in ((a, i), (b, j)))
    what = f"overlap by {-apart:.6g} mm" if apart < -TOUCHING * assembly.size else "touch"
    finding = (
        f'{assembly.drawing.source or "assembly"}: parts "{one}" and "{other}" {what} at rest at gap {assembly.gap:g}: '
        "ask for a larger gap, draw them apart, or glue or ignore them"
    )
    return TouchingError(finding, (one, other), apart)


def spatial_objective(ready: SpatialPrepared, goals: Sequence[SpatialGoal]) -> SumOfTerms:
    """What the program maximises for some goals."""
    assembly, group = ready.assembly, ready.grouping
    index = {name: k for k, name in enumerate(assembly.names)}
    terms: list[Displacement | Twist] = []
    for goal in goals:
        if isinstance(goal, Weight):
            unit = np.array(goal.direction) / np.linalg.norm(goal.direction)
            for k, (part, made) in enumerate(zip(assembly.parts, assembly.made, strict=True)):
                b = int(group.body_of[k])
                if group.bodies.moves[b]:
                    pull = goal.weight * made.volume * part.density * unit
                    terms.append(Displacement(b, group.arm[k], pull, group.bodies.at[b]))
            continue
        k = index[goal.part]
        b = int(group.body_of[k])
        if isinstance(goal, SpatialTurn):
            terms.append(Twist(b, np.array(goal.axis) / np.linalg.norm(goal.axis), goal.weight))
            continue
        rest = group.bodies.at[b]
        arm = group.arm[k] if goal.point is None else np.array(goal.point) - rest
        unit = np.array(goal.direction) / np.linalg.norm(goal.direction)
        terms.append(Displacement(b, arm, goal.weight * unit, rest))
    return SumOfTerms(tuple(terms))


SearchEnd = tuple[PlaneProgram, PlaneSolution, Floats, bool]
"""Program, solution, way of the parts (k, n, 6), and whether that is free as far as the solution."""


def _good(done: SearchEnd) -> bool:
    """True where the end is an answer and the way there is free."""
    return done[3] and done[1].status in (SolverStatus.CONVERGED, SolverStatus.ESCAPING)


@dataclass(eq=False)
class SpatialSearch:
    """Rounds of the program for one question; the best motion whose way is checked wins."""

    ready: SpatialPrepared
    objective: SumOfTerms
    solver: str
    stop: Stop | None
    tell: Callable[[int, float], None] | None
    begin: Pose | None = None
    iterations: int = 0
    rounds: int = 0
    pieces: Ints = field(init=False)

    def run(self) -> SearchEnd:
        """Program, solution, way of the parts (k, n, 6) and whether the whole way is free."""
        ready = self.ready
        near = (
            ready.pieces
            if self.begin is None
            else near_pieces(ready.grouping.bodies, self.begin, REACH * ready.clearance)
        )
        self.pieces = near
        done = self._attempt(inside=False)
        if _good(done) or self._asked_to_stop():
            return done
        best = self._attempt(inside=True)
        if not _good(best) and not self._asked_to_stop():
            best = self._polished(best)
        return best if _good(best) or self._worth(best) >= self._worth(done) else done

    def _attempt(self, inside: bool) -> SearchEnd:
        """Solve from the start, and check the way."""
        program, found = self._with_missed(inside)
        return program, found, *refined(self.ready, program, found.way or [program.start])

    def _polished(self, done: SearchEnd) -> SearchEnd:
        """Go on with slacks from where iterates were well inside all rows; what passes through something is not taken."""
        program, first, _, whole = done
        if not whole or first.status is not SolverStatus.FAILED:
            return done
        count, mu = first.inner
        solve = PlaneSolver(program, horizon=HORIZON * self.ready.size, stop=self.stop, progress=self.tell)
        found = solve.solve(first.way[count - 1], mu=mu)
        self.iterations += found.iterations
        self.rounds += 1
        more = program, found, *refined(self.ready, program, [*first.way[:count], *found.way[1:]])
        return more if _good(more) and self._worth(more) > self._worth(done) - NEARLY * self.ready.clearance else done

    def _asked_to_stop(self) -> bool:
        return self.stop is not None and self.stop.is_set()

    def _worth(self, done: SearchEnd) -> float:
        """Objective at the end of the way as far as it is free."""
        return self.objective.value(self.ready.grouping.pose_of(done[2][-1]))

    def _with_missed(self, inside: bool) -> tuple[PlaneProgram, PlaneSolution]:
        """Solve; pairs of pieces outside the program that meet on the way join it, and it is solved again from rest."""
        ready = self.ready
        limit = MOST_TURN if any(isinstance(t, Twist) for t in self.objective.terms) else np.inf
        for _ in range(MOST_ROUNDS):
            program = build_planes(
                ready.grouping.bodies, self.objective, self.pieces, length=ready.clearance, rest=self.begin
            )
            solve = PlaneSolver(
                program,
                inside=inside,
                horizon=HORIZON * ready.size,
                most_turn=limit,
                stop=self.stop,
                progress=self.tell,
            )
            found = solve.solve()
            self.iterations += found.iterations
            self.rounds += 1
            missed = self._missed(found)
            if not len(missed) or (self.stop is not None and self.stop.is_set()):
                break
            self.pieces = np.unique(np.vstack([self.pieces, missed]), axis=0)
        return program, found

    def _missed(self, found: PlaneSolution) -> Ints:
        """Pairs of pieces outside the program that come nearer than a clearance at some way-point."""
        bodies = self.ready.grouping.bodies
        known = {tuple(sorted(((a, i), (b, j)))) for a, i, b, j in self.pieces.tolist()}
        new: dict[object, list[int]] = {}
        met = False
        for point in found.way[:: max(1, len(found.way) // 40)] + found.way[-1:]:
            for who in near_pieces(bodies, point.pose, self.ready.clearance / 2).tolist():
                key = tuple(sorted(((who[0], who[1]), (who[2], who[3]))))
                if key in known or key in new:
                    continue
                apart = best_axis(bodies, point.pose, who, np.empty(3))[0]
                if apart < self.ready.clearance / 2:
                    new[key] = who
                    met |= apart <= 0
        return np.array(list(new.values()), dtype=np.int64).reshape(-1, 4) if met else np.zeros((0, 4), dtype=np.int64)


def flex_spatial(
    assembly: SpatialAssembly | SpatialPrepared,
    goals: SpatialGoal | Sequence[SpatialGoal] | None = None,
    *,
    solver: str = "interior-point",
    stop: Stop | None = None,
    progress: Callable[[int, float], None] | None = None,
) -> SpatialAnswer:
    """How far a spatial assembly can move; see `wiggleroom.flex`.

    Raises
    ------
    InputError
        If nothing is fixed or pulled, or a goal names an unknown part.
    TouchingError
        If two parts touch at rest.
    """
    began = time.perf_counter()
    its = assembly.assembly if isinstance(assembly, SpatialPrepared) else assembly
    asked = its.goals if goals is None else tuple(goals) if isinstance(goals, Sequence) else (goals,)
    wrong = goal_findings(its.drawing, asked) + lacking(its, asked)
    if wrong:
        raise InputError([f"{its.drawing.source}: {line}" if its.drawing.source else line for line in wrong])
    ready = assembly if isinstance(assembly, SpatialPrepared) else prepare_spatial(assembly)
    prepared = time.perf_counter()
    search = SpatialSearch(ready, spatial_objective(ready, asked), solver, stop, progress)
    program, found, way, whole = search.run()
    solved = time.perf_counter()
    motion = way[-1]
    deepest = deepest_overlap(its, motion)
    pose = ready.grouping.pose_of(motion)
    last = found.point.pose
    at_end = bool(np.abs(pose.T - last.T).max() + ready.size * np.abs(pose.R - last.R).max() < 1e-9 * ready.size)
    verdict, leaves, turns = _verdict(ready, search.objective, found, way, whole, at_end)
    contacts = plane_contacts(its, ready.grouping, program, found) if at_end and found.status == "converged" else ()
    ended = time.perf_counter()
    spent = {"freespace": prepared - began, "solve": solved - prepared, "check": ended - solved, "total": ended - began}
    value = None if verdict is Verdict.UNBOUNDED else _value(search.objective, ready, way)
    return SpatialAnswer(
        assembly=its, goals=asked, verdict=verdict, objective=value, motion=motion, waypoints=way, contacts=contacts,
        path="checked" if whole else "not checked", collision_free=deepest <= OVERLAP * ready.size,
        deepest_overlap=deepest, solver=solver, rounds=search.rounds, iterations=search.iterations, seconds=spent,
        leaves=leaves, turns=turns,
    )  # fmt: skip


def _value(objective: SumOfTerms, ready: SpatialPrepared, way: Floats) -> float:
    """Objective at the end of a way; turns are counted on along it."""
    value = 0.0
    for motion in way:
        value = objective.value(ready.grouping.pose_of(motion), value)
    return value


def lacking(assembly: SpatialAssembly, goals: Sequence[SpatialGoal]) -> list[str]:
    """List what a question about motion lacks: a fixed part, a pull."""
    found = []
    if not any(p.fixed for p in assembly.parts):
        found.append("nothing is fixed: name the parts that stand with --fix NAME")
    if not goals:
        found.append("nothing is pulled: say what moves with --pull NAME:+z")
    return found


def _verdict(
    ready: SpatialPrepared,
    objective: SumOfTerms,
    found: PlaneSolution,
    way: Floats,
    whole: bool,
    at_end: bool,
) -> tuple[Verdict, tuple[str, ...], tuple[str, ...]]:
    """How the question ended, and the parts that leave or turn without limit."""
    if found.status == "escaping" and whole and at_end:
        names = ready.assembly.names
        turning = _spinning(ready, objective, found)
        leaving = leaving_parts(ready, way[-1], objective)
        if turning:
            return Verdict.UNBOUNDED, (), turning
        if leaving:
            return Verdict.UNBOUNDED, tuple(names[k] for k in leaving), ()
    if found.status == "converged" and whole and at_end:
        return (Verdict.OPTIMAL if found.curved_down else Verdict.STATIONARY), (), ()
    return Verdict.STOPPED, (), ()


def leaving_parts(ready: SpatialPrepared, motion: Floats, objective: SumOfTerms) -> list[int]:
    """Parts that go on straight without limit from a motion: nothing is ahead of them; empty where that is not sure.

    Parts that came along further than half of the farthest one go on with it, in the direction it is pulled. Balls round all parts show
    that they only get further from the others.
    """
    pulls = [t for t in objective.terms if isinstance(t, Displacement)]
    if not pulls:
        return []
    assembly, reference = ready.assembly, ready.assembly.reference
    total = np.sum([t.direction for t in pulls], axis=0)
    body = ready.grouping.body_of
    pulled = {t.body for t in pulls}
    along = motion[:, :3] @ (total / np.linalg.norm(total)) if np.linalg.norm(total) > 0 else np.zeros(len(motion))
    far = np.array([k for k in range(len(motion)) if int(body[k]) in pulled])
    farthest = float(along[far].max(initial=0.0))
    if farthest < ready.size:
        return []
    gone = along > farthest / 2
    direction = total / np.linalg.norm(total)
    radius = np.array([
        np.linalg.norm(m.surface.vertices - m.centroid, axis=1).max() for m in assembly.made
    ])  # fmt: skip
    centre = reference + motion[:, :3]
    for k in np.flatnonzero(gone):
        for j in np.flatnonzero(~gone):
            apart = centre[k] - centre[j]
            ahead = float(apart @ direction)
            beside = float(np.linalg.norm(apart - ahead * direction))
            room = radius[k] + radius[j]
            if beside <= room and not (ahead > 0 and np.linalg.norm(apart) > room):
                return []
    return np.flatnonzero(gone).tolist()


def _spinning(ready: SpatialPrepared, objective: SumOfTerms, found: PlaneSolution) -> tuple[str, ...]:
    """Parts that are twisted without limit: a whole turn in place, from the end of the way, is free."""
    twists = [t for t in objective.terms if isinstance(t, Twist)]
    if len(twists) != 1 or len(objective.terms) != 1:
        return ()
    from wiggleroom.spatial.rotations import exponential

    twist, pose = twists[0], found.point.pose
    steps = []
    for angle in np.linspace(0, 2 * np.pi, 33):
        R = pose.R.copy()
        R[twist.body] = exponential(angle * np.sign(twist.weight) * twist.direction) @ R[twist.body]
        steps.append(ready.grouping.part_motion(Pose(pose.T, R)))
    if any(ready.checker.overlaps(a, b) for a, b in itertools.pairwise(steps)):
        return ()
    return tuple(n for n, b in zip(ready.assembly.names, ready.grouping.body_of, strict=True) if b == twist.body)
