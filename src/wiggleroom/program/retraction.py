"""Retraction of a step: every body is turned, then placed so that relative poses change as the linear step predicts.

A straight step in (x, y, theta) of a long assembly that turns as a whole misses by theta^2 times its size, which is far more than a gap.
Here the angles move straight, and the positions are the least-squares fit to the relative positions that the step predicts for all
neighbours; one factorised Laplacian of the neighbour graph serves all steps. What is left of the error is second order in *relative*
motions only.
"""

from __future__ import annotations

from typing import Protocol
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from wiggleroom.program.envelope_cholesky import MAX_ENVELOPE_ROWS, EnvelopeCholesky
from wiggleroom.program.nonlinear_program import Linearised, Program
from wiggleroom.program.relative_places import add_shortfalls, pair_differences, predicted_places
from wiggleroom.program.sparsity_pattern import Pattern

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ANCHOR_WEIGHT = 1e-9
"""Weight that ties bodies without neighbours to the straight step."""


class LinearSolver(Protocol):
    """A system of equations that was factorised."""

    def solve(self, right: Floats, /) -> Floats:
        """Solution for a right-hand side."""


def factorised(row: Ints, column: Ints, entry: Floats, size: int, at: Floats | None = None) -> LinearSolver:
    """Factor of a positive definite matrix, from the entries (E,) of its upper triangle.

    Of few rows it is within the envelope; of more the multifrontal one where they belong to places `at` (size, 2), else that of qdldl.
    """
    if size <= MAX_ENVELOPE_ROWS:
        factor = EnvelopeCholesky(row, column, size)
        factor.update(entry, 0.0)
        return factor
    if at is not None:
        from wiggleroom.program.multifrontal import FrontalPlan, Multifrontal  # slow to import, and seldom needed

        order = np.lexsort((row, column))
        indptr = np.concatenate([[0], np.cumsum(np.bincount(column, minlength=size))])
        fronts = Multifrontal(FrontalPlan(at, indptr, row[order], 1))
        fronts.update(entry[order], 0.0)
        return fronts
    import qdldl
    import scipy.sparse as sp  # slow to import, and seldom needed

    return qdldl.Solver(sp.csc_matrix((entry, (row, column)), shape=(size, size)), upper=True)


def _laplacian(program: Program) -> LinearSolver:
    """Laplacian of the neighbour graph, fixed bodies grounded."""
    slot, count = program.slot, len(program.free)
    i, j = slot[program.cells.a], slot[program.cells.b]
    both = (i >= 0) & (j >= 0)
    degree = np.bincount(i[i >= 0], minlength=count) + np.bincount(j[j >= 0], minlength=count)
    row = np.concatenate([np.arange(count), np.minimum(i, j)[both]])
    column = np.concatenate([np.arange(count), np.maximum(i, j)[both]])
    entry = np.concatenate([degree + ANCHOR_WEIGHT, np.full(len(row) - count, -1.0)])
    return factorised(row, column, entry, count, program.pattern.at)


_LAPLACIANS: WeakKeyDictionary[Pattern, LinearSolver] = WeakKeyDictionary()
"""Laplacians: programs of the same pairs share a pattern, and so this."""


class Retraction:
    """Least-squares placement on the neighbour graph of one program."""

    def __init__(self, program: Program) -> None:
        if program.pattern not in _LAPLACIANS:
            _LAPLACIANS[program.pattern] = _laplacian(program)
        self._laplacian = _LAPLACIANS[program.pattern]
        self._program = program
        self._pairs = program.cells.a, program.cells.b, program.slot

    def _placed(self, straight: Floats, q: Floats) -> Floats:
        """Variables with the angles of `straight` (n, 3) in which every pair is seen at q (P, 2) as nearly as can be."""
        P = self._program
        short = np.zeros((2, len(P.free)))
        add_shortfalls(P.bodies.rest + straight, *self._pairs, q, short)
        for axis in (0, 1):
            straight[P.free, axis] += self._laplacian.solve(short[axis])
        return P.variables(straight)

    def step(self, u: Floats, du: Floats, at: Linearised) -> Floats:
        """Variables after the step `du` (3F,) from `u`; equal to u + du up to second order."""
        P = self._program
        q = np.empty((len(at.g), 2))
        predicted_places(at.g, at.turn, *self._pairs[:2], P.motion(du), q)
        return self._placed(P.motion(u + du), q)

    def between(self, u: Floats, v: Floats) -> Floats:
        """Half way between two points: middle angles, and every pair seen half way between where it was and will be."""
        P = self._program
        one, _ = P.relative(P.motion(u))
        other, _ = P.relative(P.motion(v))
        return self._placed(P.motion((u + v) / 2), (one[:, :2] + other[:, :2]) / 2)

    def balance(self, residual: Floats, at: Linearised) -> Floats:
        """Pair forces (P, 2), in A's frame, that bring the walls' forces into balance with the objective.

        With them the second derivatives are those along `step` instead of along straight lines; at an optimum both agree.
        """
        P = self._program
        x, y, _ = (residual / P.scale).reshape(-1, 3).T
        out = np.empty((len(at.g), 2))
        held = np.array([self._laplacian.solve(np.ascontiguousarray(some)) for some in (x, y)])
        pair_differences(at.turn, *self._pairs, held, out)
        return out
