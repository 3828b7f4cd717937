"""The sparse nonlinear program over all bodies: walls of every pair that can meet, and an objective."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.freespace.cells import Cells
from wiggleroom.pairs.shapes import Bodies
from wiggleroom.program import kernel
from wiggleroom.program.objectives import Objective

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Pattern:
    """Where the entries of the condensed matrix live: upper triangle, compressed columns.

    Parameters
    ----------
    indptr, indices : column pointers and row indices
    diagonal_at : (F, 6) int64
        Entries (0,0) (0,1) (1,1) (0,2) (1,2) (2,2) of each free body's own block.
    block_at : (P, 9) int64
        Entries of each pair's block, column by column; -1 where one of the two is fixed.
    """

    indptr: Ints
    indices: Ints
    diagonal_at: Ints
    block_at: Ints


@dataclass(frozen=True, eq=False)
class Program:
    """max objective(motion) subject to rows h(motion) >= 0, in scaled variables u (3F,) of the free bodies.

    Parameters
    ----------
    bodies : Bodies
    objective : Objective
    cells : Cells
        One cell per pair; `cells.row` holds the first row of each pair.
    kind, normal, off, corner : (R,), (R, 2), (R,), (R, 2)
        Geometry of the rows, see `wiggleroom.program.kernel`.
    slot : (n,) int64
        Position of each body among the free ones, -1 where fixed.
    free : (F,) int64
        The free bodies.
    scale : (3F,) float64 [mm, mm, rad]
        motion = scale * u.
    length : float [mm]
        Rows are compared with this length.
    pattern : Pattern
    """

    bodies: Bodies
    objective: Objective
    cells: Cells
    kind: Ints
    normal: Floats
    off: Floats
    corner: Floats
    slot: Ints
    free: Ints
    scale: Floats
    length: float
    pattern: Pattern

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.kind)

    def motion(self, u: Floats) -> Floats:
        """Motions (n, 3) [mm, mm, rad] of all bodies."""
        out = np.zeros((len(self.slot), 3))
        out[self.free] = (u * self.scale).reshape(-1, 3)
        return out

    def variables(self, motion: Floats) -> Floats:
        """Scaled variables u (3F,) of a motion (n, 3)."""
        return motion[self.free].ravel() / self.scale

    def relative(self, motion: Floats) -> tuple[Floats, Floats]:
        """Relative poses (P, 3) of all pairs, and cos and sin of A's angle (P, 2).

        Source: Mind the Gap, Eq. (2); corrected, because as printed it is not zero at zero motion.
        """
        g = np.empty((len(self.cells.a), 3))
        turn = kernel.relative_poses(self.bodies.rest + motion, self.cells.a, self.cells.b, g)
        return g, turn

    def values(self, u: Floats) -> Floats:
        """Rows h (R,) in units of `length`."""
        g, _ = self.relative(self.motion(u))
        h = np.empty(self.rows)
        kernel.wall_values(g, self.cells.row, self.kind, self.normal, self.off, self.corner, h)
        h /= self.length
        return h

    def linearise(self, u: Floats) -> Linearised:
        """Rows, their derivatives, and products with them, at u."""
        motion = self.motion(u)
        g, turn = self.relative(motion)
        h, d = np.empty(self.rows), np.empty((self.rows, 3))
        kernel.wall_values(g, self.cells.row, self.kind, self.normal, self.off, self.corner, h)
        kernel.wall_gradients(g, self.cells.row, self.kind, self.normal, self.corner, d)
        h /= self.length
        d /= self.length
        gradient = self.objective.gradient(motion)[self.free].ravel() * self.scale
        return Linearised(self, motion, g, turn, h, d, self.objective.value(motion), gradient)


@dataclass(frozen=True, eq=False)
class Linearised:
    """The program at one point: rows `h` (R,), objective `value` and `gradient` (3F,), and products with the Jacobian."""

    program: Program
    motion: Floats
    g: Floats
    turn: Floats
    h: Floats
    d: Floats
    value: float
    gradient: Floats

    def along(self, u: Floats) -> Floats:
        """J u (R,)."""
        P, out = self.program, np.empty(self.program.rows)
        kernel.along(self.g, self.turn, P.cells.a, P.cells.b, P.cells.row, self.d, P.scale, P.slot, u, out)
        return out

    def against(self, y: Floats) -> Floats:
        """J^T y (3F,)."""
        P, out = self.program, np.empty(len(self.program.scale))
        kernel.against(self.g, self.turn, P.cells.a, P.cells.b, P.cells.row, self.d, P.scale, P.slot, y, out)
        return out

    def condensed(self, weight: Floats, lam: Floats, balance: Floats | None = None, share: float = 1.0) -> Floats:
        """Entries of J^T diag(weight) J - share objective'' - sum lam h'' in the order of `program.pattern`."""
        P, pattern = self.program, self.program.pattern
        data = np.zeros(len(pattern.indices))
        # second derivatives of h share the rows' unit, first derivatives already carry it
        kernel.condensed(
            self.g, self.turn, P.cells.a, P.cells.b, P.cells.row, P.kind, self.d, P.normal / P.length, P.corner,
            weight, lam, np.zeros((len(P.cells.a), 2)) if balance is None else balance, P.scale, P.slot,
            pattern.diagonal_at, pattern.block_at, data,
        )  # fmt: skip
        body, block = P.objective.hessian(self.motion)
        for f, m in zip(P.slot[body], block, strict=True):
            if f >= 0:
                scale = P.scale[3 * f : 3 * f + 3]
                data[pattern.diagonal_at[f]] -= (share * m * scale[:, None] * scale)[
                    [0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]
                ]
        return data

    def jacobian(self) -> sp.csr_matrix:
        """The whole Jacobian (R, 3F), for checks and for solvers that want it."""
        P = self.program
        pair = np.repeat(np.arange(len(P.cells.a)), np.diff(P.cells.row))
        c, s = self.turn[pair].T
        x, y = self.g[pair, 0], self.g[pair, 1]
        d0, d1, d2 = self.d.T
        to_b = np.column_stack([c * d0 - s * d1, s * d0 + c * d1, d2])
        to_a = np.column_stack([-to_b[:, 0], -to_b[:, 1], y * d0 - x * d1 - d2])
        rows, cols, vals = [], [], []
        for body, part in ((P.cells.a, to_a), (P.cells.b, to_b)):
            f = P.slot[body[pair]]
            keep = np.flatnonzero(f >= 0)
            col = (3 * f[keep, None] + np.arange(3)).ravel()
            rows.append(np.repeat(keep, 3))
            cols.append(col)
            vals.append(part[keep].ravel() * P.scale[col])
        where = (np.concatenate(rows), np.concatenate(cols))
        return sp.csr_matrix((np.concatenate(vals), where), shape=(P.rows, len(P.scale)))


def build(bodies: Bodies, cells: Cells, objective: Objective, *, length: float) -> Program:
    """Put all pairs and the objective into one program.

    Parameters
    ----------
    bodies : Bodies
    cells : Cells
        One cell per pair that can meet.
    objective : Objective
    length : float [mm]
        Typical clearance; variables and rows are scaled by it.

    Source: Mind the Gap, Eq. (4); glue and fixed parts are eliminated instead of added as equations.
    """
    shapes = bodies.shapes
    normal = np.where(cells.kind[:, None] <= kernel.B_EDGE, shapes.normal[cells.edge], 0.0)
    corner = np.where(cells.kind[:, None] <= kernel.B_EDGE, shapes.corner[cells.corner], 0.0)
    off = (normal * shapes.corner[cells.edge]).sum(1)
    pair = np.repeat(np.arange(len(cells.a)), np.diff(cells.row))
    lever = np.minimum(bodies.radius[cells.a], bodies.radius[cells.b])[pair]
    for kind, end in ((kernel.LOW, 0), (kernel.HIGH, 1)):
        rows = cells.kind == kind
        normal[rows, 0] = lever[rows]
        off[rows] = cells.ends[pair[rows], end]
    free = np.flatnonzero(~bodies.fixed)
    slot = np.full(len(bodies.fixed), -1, dtype=np.int64)
    slot[free] = np.arange(len(free))
    scale = np.repeat(length, 3 * len(free)).reshape(-1, 3)
    scale[:, 2] /= bodies.radius[free]
    return Program(
        bodies,
        objective,
        cells,
        cells.kind,
        normal,
        off,
        corner,
        slot,
        free,
        scale.ravel(),
        length,
        _pattern(cells, slot, len(free)),
    )


def _pattern(cells: Cells, slot: Ints, n: int) -> Pattern:
    """Block pattern of the neighbour graph, with a place for every entry."""
    i, j = slot[cells.a], slot[cells.b]
    both = (i >= 0) & (j >= 0)
    lo, hi = np.minimum(i, j)[both], np.maximum(i, j)[both]
    rank = np.empty(len(lo), dtype=np.int64)
    order = np.lexsort((lo, hi))
    rank[order] = np.arange(len(lo))
    count = np.bincount(hi, minlength=n)  # blocks above the diagonal in each block column
    start = np.concatenate([[0], np.cumsum(count)])
    height = 3 * count[:, None] + np.arange(1, 4)  # entries of the three columns of each block column
    indptr = np.concatenate([[0], np.cumsum(height.ravel())])
    top = indptr[:-1].reshape(-1, 3)
    indices = np.empty(indptr[-1], dtype=np.int64)
    place = rank - start[hi]
    block = top[hi][:, :, None] + 3 * place[:, None, None] + np.arange(3)
    indices[block] = 3 * lo[:, None, None] + np.arange(3)
    own = np.empty((n, 6), dtype=np.int64)
    k = 0
    for q in range(3):
        for r in range(q + 1):
            own[:, k] = top[:, q] + 3 * count + r
            indices[own[:, k]] = 3 * np.arange(n) + r
            k += 1
    block_at = np.full((len(i), 9), -1, dtype=np.int64)
    block_at[both] = block.reshape(-1, 9)
    return Pattern(indptr, indices, own, block_at)
