"""Compiled search over an octree of boxes of motions: split the mixed boxes on the cheapest paths to goals until a path is free.

Boxes are nodes of a tree; those that are not split are its leaves. A path goes from leaf to leaf through faces that they share. Each box
has an upper bound of the objective of its motions, so the search also finds, and proves, the largest one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import COMPILED_CALLERS_ONLY, NO_ALLOCATION, OPTIONS, njit
from wiggleroom.freespace.subdivision.box_relaxation import MAX_EDGES, MAX_ROWS, add_rows, linear_program_maximum
from wiggleroom.freespace.subdivision.classify_box import (
    FORBIDDEN,
    FREE,
    MIXED,
    STACK_SIZE,
    TINY,
    classify_box,
    edges_near_box,
)

FOUND, CLOSED, SPENT, PAUSED = 0, 1, 2, 3
"""How the search ended: with a free path to a goal, with the proof that there is none, without room or time, or to go on."""
SPLIT_VISITS = 100
"""Splitting a box takes about as long as going over so many."""
WIDE_PATHS = 16
"""On so many of the cheapest paths the mixed boxes beside those that are split are split too: that saves passes over all boxes."""
HALF_SIDES = 0.5 ** np.arange(64)
"""Of boxes that were halved so often, in unit coordinates."""
MAX_WAITING = 256
"""Boxes across one face that wait to be looked at."""
NO_GOAL = (0.31, 0.53, 0.79)
"""Any goal will do where rows are only asked whether they contradict each other: one that no row is likely to share."""


def across_of_one_box(most: int) -> NDArray[np.int32]:
    """Boxes (most, 6) across the faces of boxes, low and high of every axis; -1 at the rim, across both ends of the turn the box itself.

    Where the turn does not close on itself its ends are goals, and no path goes on from there.
    """
    across = np.full((most, 6), -1, dtype=np.int32)
    across[0, 4:] = 0
    return across


@njit(**COMPILED_CALLERS_ONLY)
def neighbour_box(n, axis, far, middle, level, first, across):
    """Smallest box that is at least as large as n and lies across one of its faces; -1 at the rim. `across` keeps it for the next time."""
    m = across[n, 2 * axis + far]
    if m < 0 or first[m] < 0 or level[m] >= level[n]:
        return m
    one, two = (axis + 1) % 3, (axis + 2) % 3
    while first[m] >= 0 and level[m] < level[n]:
        m = (
            first[m]
            + ((1 - far) << axis)
            + ((middle[n, one] >= middle[m, one]) << one)
            + ((middle[n, two] >= middle[m, two]) << two)
        )
    across[n, 2 * axis + far] = m
    return m


@njit(**NO_ALLOCATION)
def neighbour_leaves(n, middle, level, first, across, waiting, out):
    """Leaves that share a face with box n; `waiting` is room to work in.

    Across each face lies a leaf that is at least as large, or a box of the same size, whose parts at that face count.
    """
    found = 0
    for axis in range(3):
        for far in range(2):
            m = neighbour_box(n, axis, far, middle, level, first, across)
            if m < 0:
                continue
            waiting[0] = m
            count = 1
            while count:
                count -= 1
                m = waiting[count]
                if first[m] >= 0:
                    for k in range(8):
                        if (k >> axis) & 1 != far:
                            waiting[count] = first[m] + k
                            count += 1
                elif found < len(out) - 1:
                    out[found] = m
                    found += 1
    return found


@njit(**COMPILED_CALLERS_ONLY)
def _sift_up(heap_cost, heap, k):
    while k > 0:
        up = (k - 1) // 2
        if heap_cost[up] <= heap_cost[k]:
            break
        heap_cost[up], heap_cost[k] = heap_cost[k], heap_cost[up]
        heap[up], heap[k] = heap[k], heap[up]
        k = up


@njit(**COMPILED_CALLERS_ONLY)
def _sift_down(heap_cost, heap, count):
    k = 0
    while True:
        low = 2 * k + 1
        if low >= count:
            break
        if low + 1 < count and heap_cost[low + 1] < heap_cost[low]:
            low += 1
        if heap_cost[k] <= heap_cost[low]:
            break
        heap_cost[low], heap_cost[k] = heap_cost[k], heap_cost[low]
        heap[low], heap[k] = heap[k], heap[low]
        k = low


@njit(**COMPILED_CALLERS_ONLY)
def objective_value(asked, x, y, turn):
    """Value of a motion: asked is (dx, dy, alpha, beta, gamma, ...) of dx x + dy y + alpha (cos turn - 1) + beta sin turn + gamma turn."""
    half = np.sin(turn / 2)
    return asked[0] * x + asked[1] * y - 2 * asked[2] * half * half + asked[3] * np.sin(turn) + asked[4] * turn


@njit(**COMPILED_CALLERS_ONLY)
def slope_and_curvature_bound(asked, turn):
    """Derivative of the value by the turn, and the most that it may change with it."""
    slope = asked[3] * np.cos(turn) - asked[2] * np.sin(turn) + asked[4]
    return slope, np.sqrt(asked[2] ** 2 + asked[3] ** 2)


@njit(**COMPILED_CALLERS_ONLY)
def objective_bound(asked, x, y, turn, half, swing):
    """Value that no motion of a box exceeds."""
    slope, bend = slope_and_curvature_bound(asked, turn)
    return (
        objective_value(asked, x, y, turn)
        + half * (abs(asked[0]) + abs(asked[1]))
        + swing * (abs(slope) + swing * bend / 2)
    )


@njit(**NO_ALLOCATION)
def best_corner(asked, x, y, turn, half, swing):
    """Value and turn of the best of some motions of a box: the corner that lies furthest along, at three turns."""
    x += half if asked[0] > 0 else -half
    y += half if asked[1] > 0 else -half
    best, at = objective_value(asked, x, y, turn), turn
    for k in range(-1, 2, 2):
        value = objective_value(asked, x, y, turn + k * swing)
        if value > best:
            best, at = value, turn + k * swing
    return best, at


@njit(**COMPILED_CALLERS_ONLY)
def is_goal(n, middle, level, upper, turning, asked):
    """True where a box meets the rim of the window, or may hold motions worth more than asked[5]."""
    half = HALF_SIDES[level[n]]
    if max(abs(middle[n, 0]), abs(middle[n, 1])) + half >= 1.0 or (turning and abs(middle[n, 2]) + half >= 1.0):
        return True
    return upper[n] > asked[5]


@njit(**OPTIONS)
def cheapest_paths(
    start, middle, level, state, first, across, upper, turning, asked, count, cost, before, heap_cost, heap, waiting, out, ends
):  # fmt: skip
    """Cheapest paths of boxes from `start` to goals, by Dijkstra's algorithm; mixed boxes cost much more than free ones.

    Fills `ends` with the goals, the cheapest first, and returns how many there are: none where free and mixed boxes reach no goal, -1
    where there was no room to tell. With `turning` the ends of the turn are rim too.
    """
    cost[:count] = np.inf
    cost[start], before[start] = 0.0, -1
    heap_cost[0], heap[0] = 0.0, start
    size, found = 1, 0
    while size:
        at, n = heap_cost[0], heap[0]
        size -= 1
        heap_cost[0], heap[0] = heap_cost[size], heap[size]
        _sift_down(heap_cost, heap, size)
        if at > cost[n]:
            continue
        if is_goal(n, middle, level, upper, turning, asked):
            ends[found] = n
            found += 1
            if found == len(ends):
                break
            continue
        for k in range(neighbour_leaves(n, middle, level, first, across, waiting, out)):
            m = out[k]
            if state[m] == FORBIDDEN or state[m] == TINY:
                continue
            price = at + (0.01 * HALF_SIDES[level[m]] + 1e-5 if state[m] == FREE else 1.0)
            if price < cost[m]:
                if size == len(heap):
                    return -1
                cost[m], before[m] = price, n
                heap_cost[size], heap[size] = price, m
                _sift_up(heap_cost, heap, size)
                size += 1
    return found


@njit(**NO_ALLOCATION)
def add_octants(n, middle, level, first, across, count):
    """Eight boxes, count to count + 7, that box n is cut into at its middle."""
    first[n] = count
    side = HALF_SIDES[level[n] + 1]
    for k in range(8):
        m = count + k
        level[m], first[m] = level[n] + 1, -1
        for axis in range(3):
            high = (k >> axis) & 1
            middle[m, axis] = middle[n, axis] + (side if high else -side)
            across[m, 2 * axis + high], across[m, 2 * axis + 1 - high] = (
                across[n, 2 * axis + high],
                count + (k ^ (1 << axis)),
            )


@njit(**OPTIONS)
def split_box(
    n, middle, level, state, first, across, upper, count, origin, scale, asked, a_edge, a_normal, a_disc, a_kid, b_edge, b_disc, b_kid
):  # fmt: skip
    """Split box n into eight and classify them; returns the new number of boxes.

    `scale` (3,) holds the half sides of the window [mm] and [rad], and how far rounding may put points elsewhere [mm].
    """
    stack = np.empty(STACK_SIZE, dtype=np.int64)
    nodes = np.empty(STACK_SIZE, dtype=np.int64)
    pieces = np.empty((128, 4))
    some = np.empty(MAX_EDGES + 1, dtype=np.int64)
    one = np.empty(1, dtype=np.int64)
    line, rows, active, inverse = np.empty(3), np.empty((MAX_ROWS, 4)), np.empty((3, 4)), np.empty((3, 3))
    near, nearest = np.empty(len(b_edge), dtype=np.int64), np.zeros(1, dtype=np.int64)
    add_octants(n, middle, level, first, across, count)
    side = HALF_SIDES[level[n] + 1]
    half, swing = scale[0] * side, scale[1] * side
    x, y = origin[0] + scale[0] * middle[n, 0], origin[1] + scale[0] * middle[n, 1]
    touching = edges_near_box(
        x, y, origin[2] + scale[1] * middle[n, 2], 2 * half, 2 * swing, scale[2], a_edge, a_normal, a_disc, a_kid, b_disc, b_kid,
        stack, nodes, nearest, near,
    )  # fmt: skip
    for m in range(count, count + 8):
        x, y = origin[0] + scale[0] * middle[m, 0], origin[1] + scale[0] * middle[m, 1]
        turn = origin[2] + scale[1] * middle[m, 2]
        state[m] = classify_box(
            x, y, turn, half, swing, scale[2], a_edge, a_normal, a_disc, a_kid, b_edge, near, touching, stack, pieces, some, nearest
        )  # fmt: skip
        upper[m] = objective_bound(asked, x, y, turn, half, swing)
        if state[m] != MIXED:
            continue
        found = add_rows(
            x, y, turn, half, swing, scale[2], True, b_edge, b_disc, b_kid, a_edge, a_disc, a_kid, stack, nodes, some, one, line,
            rows, 0,
        )  # fmt: skip
        found = add_rows(
            x, y, turn, half, swing, scale[2], False, a_edge, a_disc, a_kid, b_edge, b_disc, b_kid, stack, nodes, some, one, line,
            rows, found,
        )  # fmt: skip
        if asked[5] == np.inf:  # nothing is asked but whether any motion in the box is free
            if found and linear_program_maximum(*NO_GOAL, rows, found, active, inverse) == -np.inf:
                state[m] = FORBIDDEN
            continue
        slope, bend = slope_and_curvature_bound(asked, turn)
        most = linear_program_maximum(half * asked[0], half * asked[1], swing * slope, rows, found, active, inverse)
        if most == -np.inf:
            state[m] = FORBIDDEN
        upper[m] = min(upper[m], objective_value(asked, x, y, turn) + most + swing * swing * bend / 2)
    return count + 8


@njit(**OPTIONS)
def leaf_at(x, y, z, middle, first):
    """Leaf that holds a point in unit coordinates."""
    n = 0
    while first[n] >= 0:
        n = first[n] + (x >= middle[n, 0]) + 2 * (y >= middle[n, 1]) + 4 * (z >= middle[n, 2])
    return n


@njit(**OPTIONS)
def search_boxes(
    middle, level, state, first, across, upper, count, pause, origin, scale, deepest, turning, asked, goals,
    a_edge, a_normal, a_disc, a_kid, b_edge, b_disc, b_kid, path, visits,
):  # fmt: skip
    """Split the mixed boxes on the cheapest paths from rest to goals, again and again, until one path is free or none is left.

    Goals are boxes at the rim of the window and those that may hold motions worth more than asked[5]; a free one must hold a motion worth
    more than asked[6]. `goals` paths are looked at in every round.

    Returns how it ended, the number of boxes, how many boxes of `path` are filled, from rest to the goal, and, where no goal is reached, a
    value that nothing reached exceeds. Above `pause` boxes it returns too; called again, it goes on. visits[0] counts the boxes gone over
    and what splitting them takes; above visits[1] it gives up.
    """
    most = len(level)
    cost, before = np.empty(most), np.empty(most, dtype=np.int32)
    heap_cost, heap = np.empty(8 * most), np.empty(8 * most, dtype=np.int32)
    waiting, out = np.empty(MAX_WAITING, dtype=np.int32), np.empty(3 * most + 2, dtype=np.int32)
    ends = np.empty(goals, dtype=np.int32)
    x, y, z = -origin[0] / scale[0], -origin[1] / scale[0], -origin[2] / scale[1]
    while True:
        n = leaf_at(x, y, z, middle, first)
        if state[n] != MIXED or level[n] >= deepest or count + 8 > most:
            break
        count = split_box(
            n, middle, level, state, first, across, upper, count, origin, scale, asked, a_edge, a_normal, a_disc, a_kid, b_edge,
            b_disc, b_kid,
        )  # fmt: skip
    start = leaf_at(x, y, z, middle, first)
    if state[start] != FREE:
        return SPENT, count, 0, np.inf
    while True:
        if count > pause:
            return PAUSED, count, 0, np.inf
        if visits[0] > visits[1]:
            return SPENT, count, 0, np.inf
        visits[0] += count
        found = cheapest_paths(
            start, middle, level, state, first, across, upper, turning, asked, count, cost, before, heap_cost, heap, waiting, out, ends,
        )  # fmt: skip
        if found < 0:
            return SPENT, count, 0, np.inf
        if found == 0:
            given_up, largest = False, -np.inf
            for n in range(count):
                given_up = given_up or state[n] == TINY
                if cost[n] < np.inf:
                    largest = max(largest, upper[n])
            return (SPENT if given_up else CLOSED), count, 0, largest
        for e in range(found):
            length, cut, n = 0, 0, ends[e]
            while n >= 0:
                path[length] = n
                length += 1
                n = before[n]
            for k in range(length):
                n = path[k]
                if first[n] >= 0:  # split on another path already
                    cut += 1
                    continue
                if state[n] != MIXED and not (
                    k == 0 and _lies_below_goal(n, middle, level, origin, scale, turning, asked)
                ):
                    continue
                cut += 1
                if level[n] >= deepest:
                    state[n] = TINY
                    continue
                # mixed boxes beside it that are as large will be asked next
                near = neighbour_leaves(n, middle, level, first, across, waiting, out) if e < WIDE_PATHS else 0
                out[near] = n
                for i in range(near + 1):
                    m = out[i]
                    if (state[m] != MIXED and m != n) or first[m] >= 0 or level[m] > level[n] or level[m] >= deepest:
                        continue
                    if count + 8 > most:
                        return SPENT, count, 0, np.inf
                    visits[0] += SPLIT_VISITS
                    count = split_box(
                        m, middle, level, state, first, across, upper, count, origin, scale, asked, a_edge, a_normal, a_disc, a_kid,
                        b_edge, b_disc, b_kid,
                    )  # fmt: skip
            if cut == 0:
                path[:length] = path[:length][::-1].copy()
                return FOUND, count, length, np.inf


@njit(**COMPILED_CALLERS_ONLY)
def _lies_below_goal(n, middle, level, origin, scale, turning, asked):
    """True where a free goal shows no motion worth as much as is asked for: it has to be split."""
    half = HALF_SIDES[level[n]]
    if max(abs(middle[n, 0]), abs(middle[n, 1])) + half >= 1.0 or (turning and abs(middle[n, 2]) + half >= 1.0):
        return False
    x, y = origin[0] + scale[0] * middle[n, 0], origin[1] + scale[0] * middle[n, 1]
    turn = origin[2] + scale[1] * middle[n, 2]
    return best_corner(asked, x, y, turn, scale[0] * half, scale[1] * half)[0] <= asked[6]
