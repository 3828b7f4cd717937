"""Compiled growth of cells round their seeds: march the angle both ways and separate every edge pair on the way."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import INLINED, NO_ALLOCATION, njit
from wiggleroom.freespace.cells.pair_edges import EdgeTable, Pair, copy_shape, posed
from wiggleroom.freespace.cells.separating_lines import LINES, MAX_LINES, MAX_WALLS_PER_LINE, workspace_for
from wiggleroom.freespace.cells.wall_search import separate_all_edges
from wiggleroom.freespace.cells.walls import segment_inside, slice_middle
from wiggleroom.geometry.row_kinds import A_EDGE, B_EDGE

INITIAL_WALLS = 64
"""Walls per cell that there is room for at first."""
MAX_WALLS = MAX_LINES * MAX_WALLS_PER_LINE
"""No cell has more."""


@njit(**INLINED)
def march(pair, work, seed, keep, sign):
    """Carry the cell on from the seed's angle, upwards or downwards: the angle reached."""
    here, d = posed(seed.x, seed.y, seed.psi), seed.step
    while abs(here.psi - seed.psi) < seed.span:
        d = min(d, seed.span - abs(here.psi - seed.psi) + 1e-15)
        before = work.number[LINES]
        for k in range(before):
            work.lines[k].before = work.lines[k].count
        end = posed(seed.x, seed.y, here.psi + sign * d)
        p, q = min(here.psi, end.psi), max(here.psi, end.psi)
        corners, x, y, _ = slice_middle(pair, work, end, seed.half)
        closing = corners == 0
        pose = here if closing else posed(x, y, end.psi)
        good, cut = separate_all_edges(pair, work, seed, keep, pose, p, q)
        there = here
        if good:
            corners, x, y, rim = slice_middle(pair, work, posed(seed.x, seed.y, here.psi), seed.half)
            good = corners > 0
            if closing:
                if good and not rim:
                    return end.psi
                good = False
            else:
                middle = posed(x, y, here.psi)
                corners, x, y, _ = slice_middle(pair, work, end, seed.half)
                there = posed(x, y, end.psi)
                good = good and corners > 0 and segment_inside(pair, work, middle, there)
        if good:
            here = there
            d = min(2.0 * d, 0.5)
            continue
        work.number[LINES] = before
        for k in range(before):
            work.lines[k].count = work.lines[k].before
        if not np.isnan(cut):
            d = abs(cut - here.psi)
            continue
        d *= 0.5
        if d < seed.least:
            break
    return here.psi


@njit(**NO_ALLOCATION)
def grow_many(outlines, work, seeds, keeps, begin, walls):
    """Grow one cell per seed, from seed `begin` on: (seed where the room for walls may end, number of walls).

    Walls (kind, edge, corner) stand one after the other.
    """
    total = 0
    for c in range(begin, len(seeds)):
        if total + MAX_WALLS > len(walls):
            return c, total
        seed, keep = seeds[c], keeps[c]
        na, ra = copy_shape(outlines, seed.a, work.edges, 0, work.runs, 0)
        n, r = copy_shape(outlines, seed.b, work.edges, na, work.runs, ra)
        pair = Pair(work.edges, work.runs, na, n, ra, r)
        for k in range(n):
            work.corners[0, k], work.corners[1, k] = work.edges[k].x, work.edges[k].y
        work.number[LINES] = 0
        good, _ = separate_all_edges(pair, work, seed, keep, posed(seed.x, seed.y, seed.psi), seed.psi, seed.psi)
        seed.grown = good
        if not good:
            continue
        for side in range(2):
            seed.ends[side] = march(pair, work, seed, keep, 1.0 if side else -1.0)
        shift_a, shift_b = outlines.first[seed.a], outlines.first[seed.b] - na
        n = total
        for k in range(work.number[LINES]):
            line = work.lines[k]
            of_b = line.edge >= na
            for w in range(line.count):
                walls[n, 0] = B_EDGE if of_b else A_EDGE
                walls[n, 1] = line.edge + (shift_b if of_b else shift_a)
                walls[n, 2] = line.walls[w] + (shift_a if of_b else shift_b)
                n += 1
        seed.number, total = n - total, n
    return len(seeds), total


def grow_from_seeds(outlines: EdgeTable, seeds: np.ndarray, keeps: NDArray[np.float64]) -> NDArray[np.int64]:
    """Grow one cell per seed, with room to work in of its own: several threads may do so at once.

    Parameters
    ----------
    outlines : EdgeTable
    seeds : (P,) SEED
        What was found is filled in.
    keeps : (P, k, 3) float64 [mm, mm, rad]
        Relative poses that no wall may cut off.

    Returns
    -------
    (R, 3) int64
        Kind, edge and corner of all walls, those of one cell after those of another.
    """
    work, done, found = workspace_for(outlines), 0, [np.zeros((0, 3), dtype=np.int64)]
    while done < len(seeds):
        walls = np.empty((INITIAL_WALLS * (len(seeds) - done) + MAX_WALLS, 3), dtype=np.int64)
        done, count = grow_many(outlines, work, seeds, keeps, done, walls)
        found.append(walls[:count].copy())
    return np.concatenate(found)
