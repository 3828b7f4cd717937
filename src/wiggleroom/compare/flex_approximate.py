"""How far it can move, with a model that approximates: the paper's hulls, or half-planes."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.assembly.overlaps import OVERLAP_TOLERANCE
from wiggleroom.compare.approximate import Approximation, End, answer_from, thinned
from wiggleroom.context import Context
from wiggleroom.drawing.model import Goal
from wiggleroom.errors import InputError, Stop, StoppedError
from wiggleroom.freespace.models.halfspaces import Halfspaces
from wiggleroom.freespace.models.hull import hulls
from wiggleroom.freespace.models.pair_models import HalfPlane, Hull
from wiggleroom.geometry.overlap import overlaps
from wiggleroom.program.nonlinear_program import Program, build_program
from wiggleroom.program.objectives import Objective, objective
from wiggleroom.program.retraction import Retraction
from wiggleroom.search.answer import Answer
from wiggleroom.search.local_search import ESCAPE_DISTANCE, FINE_TOLERANCE, MIN_GAIN, TOLERANCE_PER_BODY, nudged
from wiggleroom.search.multistart import pulls
from wiggleroom.search.progress import Progress
from wiggleroom.solve import solver_named
from wiggleroom.solve.kkt_conditions import conditions
from wiggleroom.solve.solution import Solution
from wiggleroom.verdict import SolverStatus, Verdict

Floats = NDArray[np.float64]

MAX_HALVINGS = 5
"""Hulls are worked out anew at this many halvings of the path before its end."""


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
        from wiggleroom.compare.flex_halfplane import flex_half_planes
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
