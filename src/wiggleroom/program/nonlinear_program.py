"""The sparse nonlinear program over all bodies: walls of every pair that can meet, and an objective."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from wiggleroom.geometry.bodies import Bodies
from wiggleroom.parallel.batches import THREADS, in_batches
from wiggleroom.program import contact_functions as kernel
from wiggleroom.program.constraint_rows import Regions, Rows, rows_of
from wiggleroom.program.material_points import subtract_own_blocks
from wiggleroom.program.objectives import Objective
from wiggleroom.program.sparsity_pattern import Pattern, pattern

if TYPE_CHECKING:
    import scipy.sparse as sp

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
T = TypeVar("T")

MIN_PARALLEL_ROWS = 20_000
"""From this many rows on two threads are quicker than one."""


def row_of(row: Ints, some: slice) -> Ints:
    """First rows of some pairs, and the end of the last."""
    return row[some.start : some.stop + 1]


@dataclass(frozen=True, eq=False)
class Program:
    """max objective(motion) subject to rows h(motion) >= 0, in scaled variables u (3F,) of the free bodies.

    Parameters
    ----------
    bodies : Bodies
    objective : Objective
    cells : Cells or Halfspaces
        One region per pair; `cells.row` holds the first row of each pair.
    geometry : Rows
        What the rows are about.
    slot : (n,) int64
        Position of each body among the free ones, -1 where fixed.
    free : (F,) int64
        The free bodies.
    scale : (3F,) float64 [mm, mm, rad]
        motion = scale * u.
    length : float [mm]
        Rows are compared with this length.
    pattern : Pattern
    coupled_at : (k, 9) int32
        Where the blocks of pairs of bodies live that the objective couples, in the order of its `couples`; -1 where one is fixed.
    """

    bodies: Bodies
    objective: Objective
    cells: Any
    geometry: Rows
    slot: Ints
    free: Ints
    scale: Floats
    length: float
    pattern: Pattern
    coupled_at: NDArray[np.int32]

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.geometry.kind)

    @property
    def batches(self) -> int:
        """Number of batches in which its pairs are worked on."""
        return THREADS if self.rows > MIN_PARALLEL_ROWS else 1

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
        g, turn = np.empty((len(self.cells.a), 3)), np.empty((len(self.cells.a), 2))
        kernel.relative_poses(self.bodies.rest + motion, self.cells.a, self.cells.b, g, turn)
        return g, turn

    def values(self, u: Floats) -> Floats:
        """Rows h (R,) in units of `length`."""
        g, _ = self.relative(self.motion(u))
        return self.row_values(g)

    def row_values(self, g: Floats) -> Floats:
        """Rows h (R,) in units of `length` at relative poses g (P, 3)."""
        h = np.empty(self.rows)

        def fill(some: slice) -> None:
            row, rows = row_of(self.cells.row, some), self.geometry.of_pairs(some)
            kernel.wall_values(g[some], row, *rows, self.length, h)

        in_batches(len(g), self.batches, fill)
        return h

    def rows_at(self, g: Floats, h: Floats, d: Floats) -> None:
        """Fill in rows h (R,) and their derivatives d (R, 3) with respect to (q, psi), in units of `length`."""

        def fill(some: slice) -> None:
            row, rows = row_of(self.cells.row, some), self.geometry.of_pairs(some)
            kernel.wall_gradients(g[some], row, *rows, self.length, h, d)

        in_batches(len(g), self.batches, fill)

    def pair_blocks(self, g: Floats, d: Floats, weight: Floats, lam: Floats) -> tuple[Floats, Floats]:
        """D^T diag(weight) D - sum lam h'' of every pair (P, 6), by (q, psi), and D^T lam (P, 2) by q."""
        M, force = np.zeros((len(self.cells.a), 6)), np.zeros((len(self.cells.a), 2))
        rows = self.geometry

        def fill(some: slice) -> None:
            kernel.wall_blocks(
                g[some], row_of(self.cells.row, some), rows.kind, rows.line, rows.point, d, rows.normal, rows.corner, self.length,
                weight, lam, M[some], force[some],
            )  # fmt: skip

        in_batches(len(g), self.batches, fill)
        return M, force

    def linearise(self, u: Floats, over: Linearised | None = None) -> Linearised:
        """Rows, their derivatives, and products with them, at u; in the arrays of `over` where that is no longer of use."""
        h, d = (np.empty(self.rows), np.empty((self.rows, 3))) if over is None else (over.h, over.d)
        motion = self.motion(u)
        g, turn = self.relative(motion)
        gradient = self.objective.gradient(motion)[self.free].ravel() * self.scale
        self.rows_at(g, h, d)
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

    def jacobian_product(self, u: Floats) -> Floats:
        """J u (R,)."""
        out = np.empty(self.program.rows)
        self._in_batches(lambda pairs: kernel.jacobian_product(*pairs, u, out))
        return out

    def transposed_jacobian_product(self, y: Floats) -> Floats:
        """J^T y (3F,)."""
        return self._summed(lambda pairs, out: kernel.transposed_jacobian_product(*pairs, y, out))

    def eliminated_product(self, s: Floats, lam: Floats, goal: Floats, share: float) -> Floats:
        """J^T ((lam * share * (s - h) + goal) / s) (3F,): what rows ask of the variables once slacks and multipliers are eliminated."""
        return self._summed(lambda pairs, out: kernel.eliminated_product(*pairs, self.h, s, lam, goal, share, out))

    def eliminated_changes(
        self, u: Floats, s: Floats, lam: Floats, goal: Floats, share: float
    ) -> tuple[Floats, Floats, float, float]:
        """Changes of slacks and multipliers (R,) that belong to a change u, and the longest steps in [0, 1] that keep them positive."""
        ds, dlam = np.empty_like(s), np.empty_like(s)
        found = self._in_batches(
            lambda pairs: kernel.eliminated_changes(*pairs, u, self.h, s, lam, goal, share, ds, dlam)
        )
        fastest, dual_fastest = np.array(found).max(axis=0).tolist()
        return ds, dlam, 1.0 / fastest, 1.0 / dual_fastest

    def condensed(self, weight: Floats, lam: Floats, balance: Floats | None = None, share: float = 1.0) -> Floats:
        """Entries of J^T diag(weight) J - share objective'' - sum lam h'' in the order of `program.pattern`."""
        P, pattern = self.program, self.program.pattern
        M, force = P.pair_blocks(self.g, self.d, weight, lam)
        if balance is not None:
            force += balance

        def add(some: slice) -> Floats:
            data = np.zeros(len(pattern.indices))
            kernel.add_condensed_blocks(
                self.g[some], self.turn[some], P.cells.a[some], P.cells.b[some], M[some], force[some], P.scale, P.slot,
                pattern.diagonal_at, pattern.block_at[some], np.zeros((3, 6, 6)), data,
            )  # fmt: skip
            return data

        data = _sum(in_batches(len(self.g), P.batches, add))
        self._add_objective(data, share)
        return data

    def _in_batches(self, work: Callable[[tuple[Any, ...]], T]) -> list[T]:
        """Results of `work` for batches of pairs, each given as what the kernels of the Jacobian take first."""
        P = self.program

        def done(some: slice) -> T:
            row = row_of(P.cells.row, some)
            pairs = self.g[some], self.turn[some], P.cells.a[some], P.cells.b[some], row, self.d, P.scale, P.slot
            return work(pairs)

        return in_batches(len(self.g), P.batches, done)

    def _summed(self, add: Callable[[tuple[Any, ...], Floats], None]) -> Floats:
        """Sum (3F,) of what is added for each batch of pairs."""

        def done(pairs: tuple[Any, ...]) -> Floats:
            out = np.zeros(len(self.program.scale))
            add(pairs, out)
            return out

        return _sum(self._in_batches(done))

    def _add_objective(self, data: Floats, share: float) -> None:
        """Take a share of the objective's second derivatives off."""
        P = self.program
        body, own, coupled = P.objective.hessian(self.motion)
        subtract_own_blocks(body, own, share, P.slot, P.scale, P.pattern.diagonal_at, data)
        if not len(P.coupled_at):
            return
        scale = P.scale.reshape(-1, 3)
        both = P.coupled_at[:, 0] >= 0
        i, j = (P.slot[k[both]] for k in P.objective.couples)
        blocks = share * coupled[both] * scale[i, :, None] * scale[j, None, :]
        blocks[i > j] = blocks[i > j].transpose(0, 2, 1)  # rows belong to the body with the smaller slot
        np.subtract.at(data, P.coupled_at[both], blocks.transpose(0, 2, 1).reshape(-1, 9))

    def jacobian(self) -> sp.csr_matrix:
        """The whole Jacobian (R, 3F), for checks and for solvers that want it."""
        import scipy.sparse as sp  # slow to import, and not always needed

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


def _sum(terms: list[Floats]) -> Floats:
    """Sum of some arrays, in the first of them."""
    for term in terms[1:]:
        terms[0] += term
    return terms[0]


def build_program(
    bodies: Bodies, cells: Regions, objective: Objective, *, length: float, like: Program | None = None
) -> Program:
    """Put all pairs and the objective into one program.

    Parameters
    ----------
    bodies : Bodies
    cells : Cells or Halfspaces
        One region per pair that can meet.
    objective : Objective
    length : float [mm]
        Typical clearance; variables and rows are scaled by it.
    like : Program, optional
        Another one for the same bodies and objective: where its pairs are the same ones too, both share a pattern.

    Source: Mind the Gap, Eq. (4); glue and fixed parts are eliminated instead of added as equations.
    """
    rows = rows_of(bodies, cells)
    if like is not None and _alike(like, bodies, cells, objective, length):
        return Program(
            bodies, objective, cells, rows, like.slot, like.free, like.scale, length, like.pattern, like.coupled_at
        )
    free = np.flatnonzero(~bodies.fixed)
    slot = np.full(len(bodies.fixed), -1, dtype=np.int64)
    slot[free] = np.arange(len(free))
    scale = np.full((len(free), 3), float(length))
    scale[:, 2] /= bodies.radius[free]
    n, (i, j) = len(slot), objective.couples
    own, other = cells.a * n + cells.b, i * n + j
    extra = np.setdiff1d(other, own)
    whole = pattern(
        np.concatenate([cells.a, extra // n]), np.concatenate([cells.b, extra % n]), slot, bodies.rest[free, :2]
    )
    key = np.concatenate([own, extra])
    order = np.argsort(key)
    at = order[np.searchsorted(key, other, sorter=order)] if len(other) else other
    return Program(
        bodies, objective, cells, rows, slot, free, scale.ravel(), length,
        replace(whole, block_at=whole.block_at[: len(own)]), whole.block_at[at],
    )  # fmt: skip


def _alike(like: Program, bodies: Bodies, cells: Regions, objective: Objective, length: float) -> bool:
    """True where a program has the same bodies, pairs and objective."""
    same = like.bodies is bodies and like.objective is objective and like.length == length
    return same and np.array_equal(like.cells.a, cells.a) and np.array_equal(like.cells.b, cells.b)
