"""Rounds of the program in space: missed pairs, two modes of the solver, and the checked way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.spatial.rigid import SpatialPose, near_pieces
from wiggleroom.spatial.separating_plane_program import SeparatingPlaneProgram, best_axis, build_planes
from wiggleroom.spatial.separating_plane_solver import SeparatingPlaneSolution, SeparatingPlaneSolver
from wiggleroom.spatial.spatial_objectives import SumOfTerms, Twist
from wiggleroom.spatial.spatial_path_check import refined
from wiggleroom.spatial.spatial_prepare import REACH, SpatialPrepared
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

HORIZON = 4.0
"""A part that moves further than this multiple of the size is taken to leave."""
MOST_TURN = 4 * np.pi
"""A twist beyond this is taken to go on without limit, once a whole turn in place is shown to be free [rad]."""
MOST_ROUNDS = 8
NEARLY = 1e-2
"""An end that is certain is taken before one that lies this share of a clearance further."""

SearchEnd = tuple[SeparatingPlaneProgram, SeparatingPlaneSolution, Floats, bool]
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
    begin: SpatialPose | None = None
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
        return done if _good(done) or self._asked_to_stop() else self._attempt(inside=True)

    def _attempt(self, inside: bool) -> SearchEnd:
        """Solve from the start, and check the way."""
        program, found = self._with_missed(inside)
        return program, found, *refined(self.ready, program, found.way or [program.start])

    def _asked_to_stop(self) -> bool:
        return self.stop is not None and self.stop.is_set()

    def _with_missed(self, inside: bool) -> tuple[SeparatingPlaneProgram, SeparatingPlaneSolution]:
        """Solve; pairs of pieces outside the program that meet on the way join it, and it is solved again from rest."""
        ready = self.ready
        limit = MOST_TURN if any(isinstance(t, Twist) for t in self.objective.terms) else np.inf
        for _ in range(MOST_ROUNDS):
            program = build_planes(
                ready.grouping.bodies, self.objective, self.pieces, length=ready.clearance, rest=self.begin
            )
            solve = SeparatingPlaneSolver(
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

    def _missed(self, found: SeparatingPlaneSolution) -> Ints:
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
