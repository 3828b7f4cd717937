"""Cells: regions of relative pose, one a pair, that walls keep free of overlap."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from wiggleroom.freespace import grow
from wiggleroom.pairs.shapes import Bodies

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SPAN = 0.5
"""A cell reaches at most this far [rad] from its seed; beyond, it is rebuilt."""
FINEST = 1e-8
"""Share of the first step of the march at which it gives up, where the end of the turn matters."""
ROOM = 48
"""Walls per cell that the first try has room for."""


@dataclass(frozen=True, eq=False)
class Cells:
    """One cell for each of P pairs.

    A cell is every relative pose (q, psi) of B in A's frame where all its rows are >= 0. Kind 0: a corner of B in front of the line of
    an edge of A; kind 1: a corner of A in front of the line of an edge of B; kinds 2 and 3: psi within the verified interval.

    Parameters
    ----------
    a, b : (P,) int64
        Bodies.
    row : (P + 1,) int64
        Rows of pair p are row[p] .. row[p + 1].
    kind, edge, corner : (R,) int64
        Edge and corner as rows of `Shapes`.
    ends : (P, 2) float64 [rad]
        Verified interval of psi.
    seed : (P, 3) float64 [mm, mm, rad]
        Where each cell was grown.
    """

    a: Ints
    b: Ints
    row: Ints
    kind: Ints
    edge: Ints
    corner: Ints
    ends: Floats
    seed: Floats

    @property
    def pair(self) -> Ints:
        """Pair of each row (R,)."""
        return np.repeat(np.arange(len(self.a)), np.diff(self.row))


def grow_cells(
    bodies: Bodies,
    a: Ints,
    b: Ints,
    seed: Floats,
    clearance: Floats,
    *,
    keep: Floats | None = None,
    bar: Ints | None = None,
    wish: Floats | None = None,
    to_the_end: NDArray[np.bool_] | None = None,
    span: float = SPAN,
) -> tuple[Cells, NDArray[np.bool_]]:
    """Grow one cell round each seed, all in one batch.

    Parameters
    ----------
    bodies : Bodies
    a, b : (P,) int64
        Bodies of each pair.
    seed : (P, 3) float64 [mm, mm, rad]
        Relative poses free of overlap, strictly.
    clearance : (P,) float64 [mm]
        Typical room of the pair; sets the first step of the march.
    keep : (P, k, 3) float64, optional
        Relative poses that no wall may cut off, besides the seed.
    bar : (P, 2) int64, optional
        Kind and edge of a line to avoid where there is a choice: the other branch at a corner; kind -1 for none.
    wish : (P, 3) float64, optional
        Relative poses that the pairs would like to take: of two lines that part two edges, the one that leaves more room there is chosen.
    to_the_end : (P,) bool, optional
        Where the cell should reach the end of the turn as nearly as can be; elsewhere the march stops a little before.
    span : float [rad]
        Furthest turn from the seed.

    Returns
    -------
    cells : Cells
    grown : (P,) bool
        False where the seed is not free or there was no room for the walls.

    Source: the idea of IRIS (Deits and Tedrake 2014) on the facets of the C-obstacle; here exact in the angle and verified between angles.
    """
    count = len(a)
    keeps = seed[:, None, :] if keep is None else np.concatenate([seed[:, None, :], keep], axis=1)
    bars = np.full((count, 2), -1, dtype=np.int64) if bar is None else bar
    wishes = np.full((count, 3), np.nan) if wish is None else wish
    kind, edge, corner = (np.full((count, ROOM), -1, dtype=np.int64) for _ in range(3))
    number, ends, status = np.zeros(count, dtype=np.int64), np.zeros((count, 2)), np.zeros((count, 2), dtype=np.int64)
    finest = np.where(False if to_the_end is None else to_the_end, FINEST, 1 / 64) * np.ones(count)
    batch = _Batch(a, b, seed, clearance, finest, keeps, bars, wishes, kind, edge, corner, number, ends, status)
    if count < 64:
        batch.grow(bodies, span)
    else:
        cuts = np.linspace(0, count, 9).astype(int)
        with ThreadPoolExecutor(max_workers=2) as pool:
            list(pool.map(lambda k: batch.part(slice(cuts[k], cuts[k + 1])).grow(bodies, span), range(8)))
    grown = status[:, 0] != grow.FAILED
    many = np.flatnonzero(grown & (number > ROOM))
    if len(many):  # curved outlines need more walls than most: once more, with room for them
        batch = batch.widened(int(number[many].max()))
        again = batch.part(many)
        again.grow(bodies, span)
        for table, found in zip(
            (batch.kind, batch.edge, batch.corner), (again.kind, again.edge, again.corner), strict=True
        ):
            table[many] = found
    used = np.arange(batch.kind.shape[1])[None, :] < np.where(grown, number, 0)[:, None]
    return _packed(a, b, seed, ends, used, batch.kind, batch.edge, batch.corner), grown


@dataclass(frozen=True, eq=False)
class _Batch:
    """Cells to grow, one a row; the last six arrays are filled."""

    a: Ints
    b: Ints
    seed: Floats
    clearance: Floats
    finest: Floats
    keeps: Floats
    bars: Ints
    wishes: Floats
    kind: Ints
    edge: Ints
    corner: Ints
    number: Ints
    ends: Floats
    status: Ints

    def part(self, rows: slice | Ints) -> _Batch:
        """Some of the rows; a slice is filled in place."""
        return _Batch(*(getattr(self, f.name)[rows] for f in fields(self)))

    def widened(self, room: int) -> _Batch:
        """The same with room for more walls."""
        wide = {
            k: np.pad(getattr(self, k), ((0, 0), (0, room - ROOM)), constant_values=-1)
            for k in ("kind", "edge", "corner")
        }
        return replace(self, **wide)

    def grow(self, bodies: Bodies, span: float) -> None:
        """Call the compiled search."""
        shapes, rows = bodies.shapes, len(self.a)
        radius = np.maximum(bodies.radius[self.a], bodies.radius[self.b])
        step = np.minimum(self.clearance / (4 * radius), span / 4)
        grow.grow_many(
            self.seed, self.keeps.reshape(-1, 3), np.arange(rows + 1) * self.keeps.shape[1], self.bars, self.wishes,
            10 * self.clearance, step, step * self.finest, np.full(rows, span), bodies.shape[self.a], bodies.shape[self.b],
            shapes.corner, shapes.after, shapes.normal, shapes.first, shapes.run, shapes.run_first, shapes.run_disc, 1e-12 * radius,
            self.kind, self.edge, self.corner, self.number, self.ends, self.status,
        )  # fmt: skip


def _packed(
    a: Ints, b: Ints, seed: Floats, ends: Floats, used: NDArray[np.bool_], kind: Ints, edge: Ints, corner: Ints
) -> Cells:
    """Rows of all cells one after another, the two rows of the interval last in each."""
    guard = np.tile([2, 3], (len(a), 1))
    zero = np.zeros((len(a), 2), dtype=np.int64)
    keep = np.hstack([used, np.ones((len(a), 2), dtype=bool)])
    row = np.concatenate([[0], np.cumsum(keep.sum(1))])
    pick = lambda table, last: np.hstack([table, last])[keep]  # noqa: E731
    return Cells(a, b, row, pick(kind, guard), pick(edge, zero), pick(corner, zero), ends, seed)


def select(cells: Cells, rows: Ints) -> Cells:
    """The cells of some pairs, in the order given."""
    count = np.diff(cells.row)[rows]
    row = np.concatenate([[0], np.cumsum(count)])
    take = np.repeat(cells.row[rows] - row[:-1], count) + np.arange(row[-1])
    return Cells(
        cells.a[rows],
        cells.b[rows],
        row,
        cells.kind[take],
        cells.edge[take],
        cells.corner[take],
        cells.ends[rows],
        cells.seed[rows],
    )


def joined(one: Cells, other: Cells) -> Cells:
    """Both lists of cells, one after the other."""
    cat = np.concatenate
    return Cells(
        cat([one.a, other.a]), cat([one.b, other.b]), cat([one.row, one.row[-1] + other.row[1:]]),
        cat([one.kind, other.kind]), cat([one.edge, other.edge]), cat([one.corner, other.corner]),
        cat([one.ends, other.ends]), cat([one.seed, other.seed]),
    )  # fmt: skip


def replaced(cells: Cells, pairs: Ints, new: Cells) -> Cells:
    """The same pairs in the same order, with `new` cells for some of them."""
    order = np.arange(len(cells.a))
    order[pairs] = len(cells.a) + np.arange(len(pairs))
    return select(joined(cells, new), order)
