"""Compiled search for the walls of a cell: separate the nearest edges, until all are separated or out of reach."""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import COMPILED_CALLERS_ONLY, INLINED, njit
from wiggleroom.freespace.cells.pair_edges import edge_in_front, normal_in_frame, posed
from wiggleroom.freespace.cells.separating_lines import (
    LINES,
    PAIRS,
    add_wall,
    classify_run_pairs,
    line_of,
    nearest_open,
    remove_open_pair,
    remove_separated_pairs,
    separated_piecewise,
    set_ahead,
)
from wiggleroom.freespace.cells.walls import out_of_reach, wall_contains

NO_SEPARATING_LINE, OUT_OF_MEMORY = -1, -2
"""What stands in place of a line: none separates the edges, or there is no room for it."""

SEED = np.dtype(
    [
        ("a", "i8"), ("b", "i8"),  # shapes
        ("x", "f8"), ("y", "f8"), ("psi", "f8"),  # the seed [mm, mm, rad]
        ("target_x", "f8"), ("target_y", "f8"), ("target_psi", "f8"),  # where the pair would like to be, nan for nowhere
        ("excluded_edge", "i8"),  # the edge, as a row of the pair, whose line is avoided where there is a choice, -1 for none
        ("half", "f8"),  # half the side of the square round the seed that slices are clipped to [mm]
        ("step", "f8"), ("least", "f8"), ("span", "f8"),  # first and least step of the march, and its end [rad]
        ("margin", "f8"), ("tiny", "f8"),  # room that walls leave round the poses to keep, and what counts as nothing [mm]
        ("grown", "i8"), ("number", "i8"),  # found: whether there is a cell, how many walls it has,
        ("ends", "f8", (2,)),  # and the verified interval [rad]
    ],
    align=True,
)  # fmt: skip
"""What a cell is grown for, and what was found."""


@njit(**COMPILED_CALLERS_ONLY)
def parallel_angle(pair, i, j, p, q):
    """Angle strictly inside (p, q) at which edge i of A and edge j of B are parallel, or nan."""
    a, b = pair.edges[i], pair.edges[j]
    c, d = pair.edges[a.after], pair.edges[b.after]
    angle = np.arctan2(c.y - a.y, c.x - a.x) - np.arctan2(d.y - b.y, d.x - b.x)
    angle -= np.pi * np.floor((angle - p) / np.pi)
    return angle if p + 1e-12 < angle < q - 1e-12 else np.nan


@njit(**COMPILED_CALLERS_ONLY)
def line_between(pair, i, j, pose, tiny):
    """Edge whose line edge i of A is behind (or edge j of B) and the other edge furthest in front of, and how far."""
    edge, best = i, -np.inf
    for k in range(pair.n):
        own, other = (i, j) if k < pair.na else (j, i)
        e, one = pair.edges[k], pair.edges[own]
        end = pair.edges[one.after]
        if max(e.nx * one.x + e.ny * one.y, e.nx * end.x + e.ny * end.y) - e.off > tiny:
            continue
        ahead = edge_in_front(pair, k, other, pose)
        if ahead > best:
            edge, best = k, ahead
    return edge, best


@njit(**COMPILED_CALLERS_ONLY)
def prefers_line_of_a(pair, i, j, pose, seed):
    """Which line is tried first: the one further away, or that leaves more room at the target pose, unless it is the excluded one."""
    if seed.excluded_edge == i or seed.excluded_edge == j:
        return seed.excluded_edge == j
    if not np.isnan(seed.target_x):
        pose = posed(seed.target_x, seed.target_y, seed.target_psi)
    return edge_in_front(pair, i, j, pose) >= edge_in_front(pair, j, i, pose)


@njit(**COMPILED_CALLERS_ONLY)
def height_difference(pair, edge, u, v, psi):
    """How much further corner v is in front of the line of `edge` than corner u, at an angle."""
    mx, my = normal_in_frame(pair, edge, psi)
    return mx * (pair.edges[v].x - pair.edges[u].x) + my * (pair.edges[v].y - pair.edges[u].y)


@njit(**INLINED)
def separate_edges(pair, work, seed, keep, i, j, pose, p, q):
    """Add the walls that separate edge i of A and edge j of B over [p, q]: the line they stand on, NO_SEPARATING_LINE or OUT_OF_MEMORY.

    Tried are lines that leave room at the poses to keep; then with less room; at the seed's own angle with none.
    """
    first = prefers_line_of_a(pair, i, j, pose, seed)
    room, tiny = seed.margin, seed.tiny
    for attempt in range(9 if q > p else 12):
        if attempt == 9:
            room = 0.0
        elif attempt == 3 or attempt == 6:
            room *= 0.1
        if attempt % 3 == 2:  # neither of their own lines: any other that parts them
            edge, ahead = line_between(pair, i, j, pose, tiny)
            other = j if edge < pair.na else i
        else:
            edge, other = (i, j) if (attempt % 3 == 0) == first else (j, i)
            ahead = edge_in_front(pair, edge, other, pose)
        if ahead < -tiny:
            continue
        # the lower end of the other edge at both ends of the interval: one corner, or both where the edges pass through parallel
        u, v = other, pair.edges[other].after
        at_p, at_q = height_difference(pair, edge, u, v, p), height_difference(pair, edge, u, v, q)
        need_v = min(at_p, at_q) < -tiny
        need_u = not need_v or max(at_p, at_q) > tiny
        if need_u and not wall_contains(pair, edge, u, keep, tiny, room):
            continue
        if need_v and not wall_contains(pair, edge, v, keep, tiny, room):
            continue
        line = line_of(pair, work, edge)
        if line < 0:
            return OUT_OF_MEMORY
        before = work.lines[line].count
        if need_u and not add_wall(work.lines[line], u):
            return OUT_OF_MEMORY
        if need_v and not add_wall(work.lines[line], v):
            return OUT_OF_MEMORY
        return line if work.lines[line].count > before else OUT_OF_MEMORY
    return NO_SEPARATING_LINE


@njit(**COMPILED_CALLERS_ONLY)
def separated_by_pieces(pair, work, i, j, p, q, tiny):
    """True where lines together separate edge i of A from edge j of B, either of them piece by piece."""
    return separated_piecewise(pair, work, i, j, p, q, tiny) or separated_piecewise(pair, work, j, i, p, q, tiny)


@njit(**COMPILED_CALLERS_ONLY)
def separate_all_edges(pair, work, seed, keep, pose, p, q):
    """Add walls until every edge pair is separated over [p, q] or out of reach, nearest first from `pose`.

    An edge pair that resists waits until all others are looked at: lines that part those may part it piece by piece, or hold it off.

    Returns whether all are, and, where an edge pair resists, the angle inside (p, q) at which its two edges are parallel, nan where there
    is none: up to there and from there on different corners lead, and one wall may do where both would not.
    """
    tiny = seed.tiny
    for k in range(work.number[LINES]):
        set_ahead(pair, work, k, p, q)
    classify_run_pairs(pair, work, pose, tiny)
    last = 0.0
    while True:
        where = nearest_open(pair, work, tiny)
        if where < 0:
            break
        i, j, apart2 = work.open_pairs[where].a, work.open_pairs[where].b, work.open_pairs[where].apart2
        looked = apart2 > 1.5 * last  # the reach is looked at again only where the nearest is clearly further away
        if looked:
            last = apart2
            if out_of_reach(pair, work, pose, p, q, np.sqrt(apart2), tiny):
                break
        line = separate_edges(pair, work, seed, keep, i, j, pose, p, q)
        if line == OUT_OF_MEMORY:
            return False, np.nan
        if line == NO_SEPARATING_LINE:
            if separated_by_pieces(pair, work, i, j, p, q, tiny):
                remove_open_pair(work, where)
                continue
            if not looked and out_of_reach(pair, work, pose, p, q, np.sqrt(apart2), tiny):
                break
            angle = parallel_angle(pair, i, j, p, q)
            if not np.isnan(angle):
                return False, angle
            work.open_pairs[where].postponed = 1
            continue
        set_ahead(pair, work, line, p, q)
        remove_separated_pairs(pair, work, line, tiny)
    apart2 = np.inf
    for n in range(work.number[PAIRS]):
        one = work.open_pairs[n]
        if one.postponed and one.apart2 < apart2 and not separated_by_pieces(pair, work, one.a, one.b, p, q, tiny):
            apart2 = one.apart2
    return apart2 == np.inf or out_of_reach(pair, work, pose, p, q, np.sqrt(apart2), tiny), np.nan
