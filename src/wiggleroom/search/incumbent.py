"""Where a round of the search begins, and the best motion it has found."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.freespace.cells.cells import Cells
from wiggleroom.program.nonlinear_program import Program
from wiggleroom.search.active_set import ActiveSet
from wiggleroom.search.prepare import Prepared
from wiggleroom.solve.interior_point_settings import INITIAL_BARRIER
from wiggleroom.solve.solution import Solution

Floats = NDArray[np.float64]

HANDED_OVER_TOLERANCE = 1e-3
"""Tolerance of the first round among cells after a climb without; the next one is fine, earlier ones show where everything wants to go."""
BARRIER_GROWTH = 5.0
"""A round begins with this multiple of the complementarity at the inner point of the one before: its new cells leave more to gain."""


@dataclass(frozen=True, eq=False)
class PathSegment:
    """A piece of the path inside the cells of one program: points in its scaled variables."""

    program: Program
    points: tuple[Floats, ...]


@dataclass(frozen=True, eq=False)
class Start:
    """Where a round begins.

    Parameters
    ----------
    cells : Cells
        One a pair.
    inner : (n, 3) float64 [mm, mm, rad]
        Motion of the bodies strictly inside all cells.
    segments : tuple of PathSegment
        The path from rest to there.
    mu : float
        Complementarity to begin with.
    tolerance : float, optional
        Of the round; by default that of the first rounds.
    multipliers : (R,) float64, optional
        Of the rows of all cells, to begin with.
    """

    cells: Cells
    inner: Floats
    segments: tuple[PathSegment, ...] = ()
    mu: float = INITIAL_BARRIER
    tolerance: float | None = None
    multipliers: Floats | None = None


def start_at_rest(ready: Prepared) -> Start:
    """Return the start at rest."""
    return Start(ready.cells, np.zeros((len(ready.bodies.fixed), 3)))


@dataclass(frozen=True, eq=False)
class Incumbent:
    """A safe motion, and how it was found.

    Parameters
    ----------
    motion : (n, 3) float64 [mm, mm, rad]
        Of the bodies.
    value : float
        Objective there.
    program, solution, active
        The round that gave it, and its active rows.
    segments : tuple of PathSegment
        The path from rest to where the round began.
    begin : (3F,) float64
        Where the round began.
    tolerance, mu : float
        Of the round.
    """

    motion: Floats
    value: float
    program: Program
    solution: Solution
    active: ActiveSet
    segments: tuple[PathSegment, ...]
    begin: Floats
    tolerance: float
    mu: float

    def nearer(self, level: int) -> Floats:
        """A legal point (3F,) of the round's path nearer to its end than the inner one: level 1 half as near in steps, 2 a quarter."""
        path, inner = self.solution.path, self.solution.inner
        if not path or not level:
            return inner
        start = next((k for k, u in enumerate(path) if u is inner), -1)  # else it stands before the path
        steps = (len(path) - 1 - start) // 2**level
        return path[len(path) - 1 - steps]

    def segment(self, end: Floats) -> PathSegment:
        """The round's piece of the path, up to its point `end` or to its solution."""
        points = [self.begin, *self.solution.path, self.solution.u]
        last = next(k for k, point in enumerate(points) if point is end or np.array_equal(point, end))
        return PathSegment(self.program, tuple(points[: last + 1]))

    @property
    def path(self) -> tuple[PathSegment, ...]:
        """The path from rest to the motion."""
        return (*self.segments, self.segment(self.solution.u))

    def start(self, *, tolerance: float | None = None, mu: float | None = None, level: int = 0) -> Start:
        """Where a round in the same cells begins: at the inner point, or at one nearer to the end."""
        point = self.nearer(level)
        mu = BARRIER_GROWTH * self.solution.inner_mu if mu is None else mu
        return Start(
            self.program.cells, self.program.motion(point), (*self.segments, self.segment(point)), mu, tolerance
        )
