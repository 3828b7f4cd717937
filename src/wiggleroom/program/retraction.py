"""Retraction of a step: every body is turned, then placed so that relative poses change as the linear step predicts.

A straight step in (x, y, theta) of a long assembly that turns as a whole misses by theta^2 times its size, which is far more than a gap.
Here the angles move straight, and the positions are the least-squares fit to the relative positions that the step predicts for all
neighbours; one factorised Laplacian of the neighbour graph serves all steps. What is left of the error is second order in *relative*
motions only.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.program.nonlinear_program import Linearised, Program

Floats = NDArray[np.float64]

ANCHOR_WEIGHT = 1e-9
"""Weight that ties bodies without neighbours to the straight step."""


class Retraction:
    """Least-squares placement on the neighbour graph of one program."""

    def __init__(self, program: Program) -> None:
        import qdldl
        import scipy.sparse as sp

        cells, slot = program.cells, program.slot
        pairs = np.arange(len(cells.a))
        rows, cols, vals = [], [], []
        for body, sign in ((cells.a, -1.0), (cells.b, 1.0)):
            keep = slot[body] >= 0
            rows.append(pairs[keep])
            cols.append(slot[body][keep])
            vals.append(np.full(int(keep.sum()), sign))
        shape = (len(pairs), len(program.free))
        self._edges = sp.csr_matrix((np.concatenate(vals), (np.concatenate(rows), np.concatenate(cols))), shape=shape)
        self._ends = sp.csr_matrix(self._edges.T)
        laplacian = self._ends @ self._edges + ANCHOR_WEIGHT * sp.eye(shape[1])
        self._laplacian = qdldl.Solver(sp.csc_matrix(laplacian))
        self._program = program

    def _fit(self, targets: Floats) -> Floats:
        """Placement (F, 2) whose differences along all pairs come nearest to `targets` (P, 2)."""
        right = self._ends @ targets
        return np.column_stack([self._laplacian.solve(np.ascontiguousarray(right[:, k])) for k in (0, 1)])

    def _placed(self, straight: Floats, q: Floats) -> Floats:
        """Variables with the angles of `straight` (n, 3) in which every pair is seen at q (P, 2) as nearly as can be."""
        P = self._program
        a, b, rest = P.cells.a, P.cells.b, P.bodies.rest
        angle = rest[a, 2] + straight[a, 2]
        c, s = np.cos(angle), np.sin(angle)
        wanted = np.column_stack([c * q[:, 0] - s * q[:, 1], s * q[:, 0] + c * q[:, 1]])
        wanted -= rest[b, :2] + straight[b, :2] - rest[a, :2] - straight[a, :2]
        straight[P.free, :2] += self._fit(wanted)
        return P.variables(straight)

    def step(self, u: Floats, du: Floats, at: Linearised) -> Floats:
        """Variables after the step `du` (3F,) from `u`; equal to u + du up to second order."""
        P = self._program
        a, b = P.cells.a, P.cells.b
        change = P.motion(du)
        c, s = at.turn.T
        x, y = at.g[:, 0], at.g[:, 1]
        dx, dy = (change[b, :2] - change[a, :2]).T
        q = np.column_stack([x + c * dx + s * dy + change[a, 2] * y, y - s * dx + c * dy - change[a, 2] * x])
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
        force = (residual / P.scale).reshape(-1, 3)[:, :2]
        world = self._edges @ np.column_stack(
            [self._laplacian.solve(np.ascontiguousarray(force[:, k])) for k in (0, 1)]
        )
        c, s = at.turn.T
        return np.column_stack([c * world[:, 0] + s * world[:, 1], -s * world[:, 0] + c * world[:, 1]])
