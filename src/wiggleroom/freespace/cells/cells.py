"""Cells: regions of relative pose, one a pair, that walls keep free of overlap."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.errors import Stop, go_on
from wiggleroom.freespace.cells.grow import grow_from_seeds
from wiggleroom.freespace.cells.pair_edges import edge_table
from wiggleroom.freespace.cells.wall_search import SEED
from wiggleroom.geometry.bodies import Bodies, BodyShapes
from wiggleroom.geometry.row_kinds import A_EDGE, B_EDGE, HIGH_TURN, LOW_TURN
from wiggleroom.parallel.batches import in_batches

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Shorts = NDArray[np.int32]
Kinds = NDArray[np.int8]

MAX_ANGLE_SPAN = 0.5
"""A cell reaches at most this far [rad] from its seed; beyond, it is rebuilt."""
MIN_STEP_SHARE = 1e-8
"""Share of the first step of the march at which it gives up, where the end of the turn matters."""
MIN_PARALLEL_CORNERS = 2000
"""Up to this many corners of all pairs together one thread is as quick as two."""
STOP_CHECK_CORNERS = 20_000
"""After this many corners it is asked again whether to stop."""


@dataclass(frozen=True, eq=False)
class Cells:
    """One cell for each of P pairs.

    A cell is every relative pose (q, psi) of B in A's frame where all its rows are >= 0: its walls (A_EDGE, B_EDGE), and the ends of the
    verified interval of psi (LOW_TURN, HIGH_TURN).

    Parameters
    ----------
    a, b : (P,) int64
        Bodies.
    row : (P + 1,) int64
        Rows of pair p are row[p] .. row[p + 1].
    kind : (R,) int8
        As in `row_kinds`.
    edge, corner : (R,) int32
        Rows of `BodyShapes`.
    ends : (P, 2) float64 [rad]
        Verified interval of psi.
    seed : (P, 3) float64 [mm, mm, rad]
        Where each cell was grown.
    """

    a: Ints
    b: Ints
    row: Ints
    kind: Kinds
    edge: Shorts
    corner: Shorts
    ends: Floats
    seed: Floats

    @property
    def is_wall(self) -> NDArray[np.bool_]:
        """Which rows (R,) are walls; the others are ends of verified intervals."""
        return self.kind <= B_EDGE

    @property
    def pair(self) -> Ints:
        """Pair of each row (R,)."""
        return np.repeat(np.arange(len(self.a)), np.diff(self.row))


@dataclass(frozen=True, eq=False)
class CellWish:
    """What cells should be like, where there is a choice.

    Parameters
    ----------
    keep : (P, k, 3) float64, optional
        Relative poses that no wall may cut off, besides the seed.
    excluded_edge : (P, 2) int64, optional
        Kind and edge of a line to avoid: the other branch at a corner; kind -1 for none.
    target : (P, 3) float64, optional
        Relative poses that the pairs would like to take: of two lines that part two edges, the one that leaves more room there is chosen.
    to_the_end : (P,) bool, optional
        Where the cell should reach the end of the turn as nearly as can be; elsewhere the march stops a little before.
    """

    keep: Floats | None = None
    excluded_edge: Ints | None = None
    target: Floats | None = None
    to_the_end: NDArray[np.bool_] | None = None


NO_WISH = CellWish()
"""Any cell will do."""


def grow_cells(
    bodies: Bodies,
    a: Ints,
    b: Ints,
    seed: Floats,
    clearance: Floats,
    *,
    wish: CellWish = NO_WISH,
    stop: Stop | None = None,
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
    wish : CellWish, optional
    stop : optional
        Anything with `is_set()`, asked now and then.

    Raises
    ------
    StoppedError
        If it was asked to stop.

    Returns
    -------
    cells : Cells
    grown : (P,) bool
        False where the seed is not free or there was no room for the walls.

    Source: the idea of IRIS (Deits and Tedrake 2014) on the facets of the C-obstacle; here exact in the angle and verified between angles.
    """
    count, shapes = len(a), bodies.shapes
    radius = np.maximum(bodies.radius[a], bodies.radius[b])
    seeds = np.zeros(count, dtype=SEED)
    seeds["a"], seeds["b"] = bodies.shape[a], bodies.shape[b]
    seeds["x"], seeds["y"], seeds["psi"] = seed.T
    seeds["ends"] = seed[:, 2:]
    seeds["target_x"], seeds["target_y"], seeds["target_psi"] = (
        np.full(3, np.nan) if wish.target is None else wish.target.T
    )
    seeds["excluded_edge"] = (
        -1 if wish.excluded_edge is None else _rows_of_lines(shapes, seeds["a"], seeds["b"], wish.excluded_edge)
    )
    seeds["half"], seeds["tiny"] = 10 * clearance, 1e-12 * radius
    seeds["margin"] = 0.005 * seeds["half"]
    step = np.minimum(clearance / (4 * radius), MAX_ANGLE_SPAN / 4)
    finest = 1 / 64 if wish.to_the_end is None else np.where(wish.to_the_end, MIN_STEP_SHARE, 1 / 64)
    seeds["step"], seeds["least"], seeds["span"] = step, step * finest, MAX_ANGLE_SPAN
    keeps = seed[:, None, :] if wish.keep is None else np.concatenate([seed[:, None, :], wish.keep], axis=1)
    table, corners = edge_table(shapes), np.diff(shapes.first)
    work = int(corners[seeds["a"]].sum() + corners[seeds["b"]].sum())

    def grown(part: slice) -> Ints:
        go_on(stop)
        return grow_from_seeds(table, seeds[part], keeps[part])

    batches = 1 if work < MIN_PARALLEL_CORNERS else min(count, max(8, work // STOP_CHECK_CORNERS))
    walls = np.concatenate(in_batches(count, batches, grown))
    return _packed(a, b, seed, seeds["ends"].copy(), seeds["number"], walls), seeds["grown"] > 0


def _rows_of_lines(shapes: BodyShapes, a: Ints, b: Ints, lines: Ints) -> Ints:
    """Edges given by kind and edge, as rows of their pair: those of shape a first, then those of b; kind -1 stays."""
    kind, edge = lines.T
    edges_of_a = shapes.first[a + 1] - shapes.first[a]
    rows = np.where(kind == A_EDGE, edge - shapes.first[a], edge - shapes.first[b] + edges_of_a)
    return np.where(kind < 0, -1, rows)


def _packed(a: Ints, b: Ints, seed: Floats, ends: Floats, number: Ints, walls: Ints) -> Cells:
    """Rows of all cells one after another, the two rows of the interval last in each."""
    row = np.concatenate([[0], np.cumsum(number + 2)])
    rows = np.zeros((row[-1], 3), dtype=np.int32)
    rows[np.arange(len(walls)) + np.repeat(2 * np.arange(len(a)), number)] = walls
    rows[row[1:] - 2, 0], rows[row[1:] - 1, 0] = LOW_TURN, HIGH_TURN
    _, edge, corner = np.ascontiguousarray(rows.T)
    return Cells(a, b, row, rows[:, 0].astype(np.int8), edge, corner, ends, seed)


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


def concatenated(one: Cells, other: Cells) -> Cells:
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
    return select(concatenated(cells, new), order)
