"""How far it can move, with a model that approximates: the paper's hulls, or half-planes.

With half-planes it is done as PuzzleFlex does it: linear programs, once at rest or step by step. A step may turn no body, and move no two
neighbours against each other, further than a trust region that shrinks where the true distances disagree with the linear ones. After each
step poses turn exactly, corners and lines are paired anew, and rows that were violated must be put right by the next step.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.assembly.overlaps import OVERLAP_TOLERANCE
from wiggleroom.compare.approximate import Approximation, End, answer_from, thinned
from wiggleroom.context import Context
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError, Stop, StoppedError
from wiggleroom.freespace.models.halfplane import half_planes
from wiggleroom.freespace.models.halfspaces import Halfspaces
from wiggleroom.freespace.models.hull import hulls
from wiggleroom.freespace.models.pair_models import HalfPlane, Hull
from wiggleroom.geometry.neighbours import neighbours
from wiggleroom.geometry.overlap import overlaps
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.program.nonlinear_program import Linearised, Program, build_program
from wiggleroom.program.objectives import Objective, objective
from wiggleroom.program.retraction import Retraction
from wiggleroom.search.answer import Answer
from wiggleroom.search.local_search import ESCAPE_DISTANCE, FINE_TOLERANCE, MIN_GAIN, TOLERANCE_PER_BODY, nudged
from wiggleroom.search.multistart import pulls
from wiggleroom.search.progress import Progress
from wiggleroom.solve import solver_named
from wiggleroom.solve.kkt_conditions import conditions
from wiggleroom.solve.linear_programming import maximise
from wiggleroom.solve.solution import Solution
from wiggleroom.verdict import SolverStatus, Verdict

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_HALVINGS = 5
"""Hulls are worked out anew at this many halvings of the path before its end."""

FIRST_TRUST_RADIUS = 2.0
"""Neighbours move against each other by at most this many clearances in the first steps."""
EDGE_REACH = 3.0
"""Corners are paired with edges up to this multiple of that distance."""
MAX_PENETRATION = 0.1
"""A step that leaves a corner deeper in the other part than this share of the clearance is tried again, half as long."""
TRUST_SHRINK, TRUST_GROWTH, MIN_TRUST_RADIUS = 0.5, 2.0, 1e-5
"""Factors of the trust region, and its last size as a share of the first."""
GAIN_TOLERANCE = 1e-6
"""Gains below this share of the typical radius, or of the objective where that is more, count as none."""
MAX_STALLED_STEPS = 3
"""The search ends after this many steps in a row without gain."""
MAX_STEPS = 300
"""Linear programs at most."""


def flex_approximate(
    ready: Approximation, asked: tuple[Goal, ...], solver: str, spent: float, context: Context
) -> Answer:
    """The answer of a model; `spent` seconds went into making it ready."""
    began = time.perf_counter()
    goal = objective(ready.assembly, ready.bodies, asked, ready.near)
    if isinstance(ready.model, HalfPlane):
        if solver != "interior-point":
            finding = f'solver "{solver}": half-planes make linear programs; leave the solver out'
            raise InputError(finding)
        from wiggleroom.compare.flex_approximate import flex_half_planes
        from wiggleroom.solve.linear_programming import linear_solver

        solver = linear_solver()
        end = flex_half_planes(ready, goal, ready.model.iterated, context)
    else:
        end = flex_hull(ready, goal, solver_named(solver), context)
    seconds = {"freespace": spent, "solve": time.perf_counter() - began}
    return answer_from(ready, asked, solver, end, seconds)


def flex_hull(ready: Approximation, objective: Objective, solve: Callable[..., Solution], context: Context) -> End:
    """Solve the paper's program; the rounds after the first work the hulls out anew round the motion found before.

    Source: Mind the Gap, Eq. (4), with the relative motion corrected: Eq. (2) as printed is not zero at zero motion.
    """
    run = _Run(ready, objective, solve, context.stop, context.tell)
    model, faces = ready.model, ready.faces
    begin = np.zeros((len(ready.bodies.fixed), 3))
    path = [begin]
    best: End | None = None
    while True:
        program, solution = run.round(faces, begin)
        points = [program.motion(u) for u in (*solution.path, solution.u)]
        value = objective.value(points[-1])
        least = MIN_GAIN * len(begin) * max(abs(value), ready.clearance)
        gained = best is None or value > best.value + least
        if best is None or gained:
            motions = thinned(ready.bodies, [*path, *points], ready.clearance)
            best = End(motions, _verdict(program, solution, ready.size), program, value, 0, 0)
        best = best.after(run.rounds, run.iterations)
        if not isinstance(model, Hull) or run.rounds >= model.rounds:
            return best
        if not gained or solution.status is not SolverStatus.CONVERGED:
            return best
        context.tell(Progress("free spaces", run.rounds, solution.iterations, value))
        inner = _well_inside(ready, program, program.variables(begin), solution.u)
        try:
            fresh = (
                None
                if inner is None
                else hulls(ready.bodies, faces.a, faces.b, ready.reference, model, inner, context.stop)
            )
        except StoppedError:
            return replace(best, verdict=Verdict.STOPPED)
        if inner is None or fresh is None:
            return best
        faces, begin, path = fresh.faces, inner, [*path, inner]


@dataclass(eq=False)
class _Run:
    """What all rounds share, and what they took."""

    ready: Approximation
    objective: Objective
    solve: Callable[..., Solution]
    stop: Stop | None
    tell: Callable[[Progress], None]
    rounds: int = 0
    iterations: int = 0

    def round(self, faces: Halfspaces, begin: Floats) -> tuple[Program, Solution]:
        """Best solution over all starts, from the motion `begin` (n, 3) strictly inside all faces."""
        ready = self.ready
        self.rounds += 1
        program = self._build(faces, self.objective)
        aside = nudged(program, program.variables(begin))
        found = []
        for pull in pulls(ready.bodies, self.objective, ready.clearance) if self.rounds == 1 else ():
            first = self._solved(self._build(faces, pull), aside)
            found.append(self._solved(program, first.inner))
            if found[-1].status is SolverStatus.STOPPED:
                break
        found = found or [self._solved(program, aside)]
        return program, max(found, key=lambda s: self.objective.value(program.motion(s.u)))

    def _build(self, faces: Halfspaces, objective: Objective) -> Program:
        return build_program(self.ready.bodies, faces, objective, length=self.ready.clearance)

    def _solved(self, program: Program, start: Floats) -> Solution:
        number = self.rounds
        found = self.solve(
            program, start, tolerance=max(FINE_TOLERANCE, TOLERANCE_PER_BODY * len(self.ready.bodies.fixed)),
            horizon=ESCAPE_DISTANCE * self.ready.size, stop=self.stop,
            progress=lambda iteration, value: self.tell(Progress("solve", number, iteration, value)),
        )  # fmt: skip
        self.iterations += found.iterations
        return found


def _verdict(program: Program, solution: Solution, size: float) -> Verdict:
    """What the model says; never "optimal", for the faces are no contacts."""
    if solution.status is SolverStatus.ESCAPING:
        return Verdict.UNBOUNDED
    held = solution.status is SolverStatus.CONVERGED and conditions(program, solution.u, solution.lam).hold(size)
    return Verdict.STATIONARY if held else Verdict.STOPPED


def _well_inside(ready: Approximation, program: Program, begin: Floats, end: Floats) -> Floats | None:
    """A motion (n, 3) a little before `end` (3F,), seen from `begin`, that overlaps nowhere."""
    retraction = Retraction(program)
    inner, found = begin, None
    for _ in range(MAX_HALVINGS):
        inner = retraction.between(inner, end)
        motion = program.motion(inner)
        if overlaps(ready.bodies, motion, ready.ignored).deepest <= OVERLAP_TOLERANCE * ready.size:
            found = motion
    return found


def flex_half_planes(ready: Approximation, objective: Objective, iterated: bool, context: Context) -> End:
    """Largest motion by one linear program at rest, or by many.

    Source: Lensgraf and others, "PuzzleFlex: kinematic motion of chains with loose joints" (ICRA 2020): local distance constraints,
    linearised, and steps in time. Bounds, pairing and stopping are ours: its text (arXiv 1906.08708) was not read in full.
    """
    steps = _Steps(ready, objective, context.stop, context.tell)
    first = [steps.first_step(pull) for pull in pulls(ready.bodies, objective, ready.clearance)] or [steps.begin()]
    if not iterated:
        return max((steps.at_once(path) for path in first), key=lambda end: end.value).after(1, steps.iterations)
    ends = []
    for path in first:
        ends.append(steps.climb(path))
        if context.stopped:
            break
    return max(ends, key=lambda end: end.value).after(steps.rounds, steps.iterations)


@dataclass(eq=False)
class _Steps:
    """Linear programs from pose to pose, and what they took."""

    ready: Approximation
    objective: Objective
    stop: Stop | None
    tell: Callable[[Progress], None]
    rounds: int = 0
    iterations: int = 0

    def begin(self) -> list[Floats]:
        """The path that has not left rest."""
        return [np.zeros((len(self.ready.bodies.fixed), 3))]

    def first_step(self, pull: Objective) -> list[Floats]:
        """The first step along a pull, for objectives without a direction at rest."""
        path = self.begin()
        at, faces = self._linearised(path[0], pull)
        found = self._solve(at, faces, 1.0)
        return path if found is None else [*path, path[0] + 0.5 * at.program.motion(found)]

    def at_once(self, path: list[Floats]) -> End:
        """One linear program without trust region, bounded only where a body would leave."""
        at, _ = self._linearised(path[0], self.objective, path[-1])
        bound = ESCAPE_DISTANCE * self.ready.size / at.program.scale
        bound[2::3] = np.pi / at.program.scale[2::3]
        found = maximise(at.gradient, at.jacobian(), -at.h, bound)
        self.iterations += found.iterations
        if found.x is None:
            return self._end([path[0]], at, Verdict.STOPPED)
        away = np.abs(found.x[0::3]).max() > 0.99 * bound[0] or np.abs(found.x[1::3]).max() > 0.99 * bound[1]
        verdict = Verdict.UNBOUNDED if away else Verdict.STATIONARY
        return self._end([path[0], path[0] + at.program.motion(found.x)], at, verdict)

    def climb(self, path: list[Floats]) -> End:
        """Step by step until nothing is gained."""
        ready, size = self.ready, 1.0
        at, faces = self._linearised(path[-1], self.objective)
        idle, too_far, verdict = 0, False, Verdict.STOPPED
        unit = GAIN_TOLERANCE * float(np.median(ready.bodies.radius)) * _unit(at)
        for _ in range(MAX_STEPS):
            if self.stop is not None and self.stop.is_set():
                break
            self.rounds += 1
            du = self._solve(at, faces, size)
            if du is None:  # the solver found no step: ask for less
                size *= TRUST_SHRINK
                if size < MIN_TRUST_RADIUS:
                    break
                continue
            moved = path[-1] + at.program.motion(du)
            after, faces_there = self._linearised(moved, self.objective)
            self.tell(Progress("solve", self.rounds, 0, after.value))
            worse = max(_violation(at), 0.1 * size * MAX_PENETRATION)
            if _violation(after) > max(MAX_PENETRATION * size**0.5, worse) and size > MIN_TRUST_RADIUS:
                size, too_far = size * TRUST_SHRINK, True
                continue
            gain = after.value - at.value
            promised = float(at.gradient @ du)
            path.append(moved)
            at, faces = after, faces_there
            if np.abs(moved[:, :2]).max() > ESCAPE_DISTANCE * ready.size:
                verdict = Verdict.UNBOUNDED
                break
            idle = idle + 1 if gain < max(unit, GAIN_TOLERANCE * abs(at.value)) else 0
            if gain < 0.5 * promised or idle:
                size = max(size * TRUST_SHRINK, MIN_TRUST_RADIUS)
            elif gain > 0.9 * promised and not too_far:
                size = min(size * TRUST_GROWTH, 1.0)
            too_far = False
            if idle >= MAX_STALLED_STEPS and _violation(at) < MAX_PENETRATION * GAIN_TOLERANCE**0.5:
                verdict = Verdict.STATIONARY
                break
        return self._end(path, at, verdict)

    def _linearised(
        self, motion: Floats, objective: Objective, slope_at: Floats | None = None
    ) -> tuple[Linearised, Halfspaces]:
        """Rows at a motion, and the derivatives of the objective there or at another motion."""
        ready = self.ready
        reach = EDGE_REACH * FIRST_TRUST_RADIUS * ready.clearance
        near = neighbours(ready.bodies, placed(ready.bodies, motion), reach, ignored=ready.ignored, motion=motion)
        faces = half_planes(ready.bodies, near.a, near.b, motion, reach)
        program = build_program(ready.bodies, faces, objective, length=ready.clearance)
        at = program.linearise(program.variables(motion))
        if slope_at is not None and slope_at is not motion:
            slope = objective.gradient(slope_at)[program.free].ravel() * program.scale
            at = Linearised(program, at.motion, at.g, at.turn, at.h, at.d, at.value, slope)
        return at, faces

    def _solve(self, at: Linearised, faces: Halfspaces, size: float) -> Floats | None:
        """Best step in the trust region; where the violated rows cannot be put right, one that makes them no worse."""
        ready, program = self.ready, at.program
        box = _box(ready, faces, size)
        limits = build_program(ready.bodies, box, self.objective, length=ready.clearance)
        there = limits.linearise(program.variables(at.motion))
        rows = sp.vstack([at.jacobian(), there.jacobian()]).tocsr()
        bound = ESCAPE_DISTANCE * ready.size / 10 / program.scale
        turn = size * np.sqrt(ready.clearance / (2 * ready.bodies.radius[program.free]))
        bound[2::3] = turn / program.scale[2::3]
        for h in (at.h, np.maximum(at.h, 0.0)):
            found = maximise(at.gradient / _unit(at), rows, -np.concatenate([h, there.h]), bound)
            self.iterations += found.iterations
            if found.x is not None:
                return found.x
        return None

    def _end(self, path: list[Floats], at: Linearised, verdict: Verdict) -> End:
        motions = thinned(self.ready.bodies, path, self.ready.clearance)
        value = self.objective.value(motions[-1])
        return End(motions, verdict, at.program, value, self.rounds, self.iterations)


def _box(ready: Approximation, faces: Halfspaces, size: float) -> Halfspaces:
    """Bounds of the motion of every pair against each other, as faces."""
    count, far = len(faces.a), size * FIRST_TRUST_RADIUS * ready.clearance
    lever = np.minimum(ready.bodies.radius[faces.a], ready.bodies.radius[faces.b])
    normal = np.tile(np.vstack([np.eye(3), -np.eye(3)]), (count, 1, 1))
    normal[:, :, 2] *= lever[:, None]
    row = np.arange(count + 1) * 6
    return Halfspaces(faces.a, faces.b, row, normal.reshape(-1, 3), np.full(6 * count, -far), faces.point, faces.rest)


def _violation(at: Linearised) -> float:
    """Deepest corner in another part, in clearances."""
    return max(0.0, -float(at.h.min(initial=0.0)))


def _unit(at: Linearised) -> float:
    return float(np.abs(at.gradient).max()) or 1.0
