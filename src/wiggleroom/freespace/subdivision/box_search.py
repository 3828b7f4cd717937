"""Compiled search over an octree of boxes of motions: split the mixed boxes on the cheapest paths to goals until a path is free.

Boxes are nodes of a tree; those that are not split are its leaves. A path goes from leaf to leaf through faces that they share. Each box
has an upper bound of the objective of its motions, so the search also finds, and proves, the largest one.
"""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import COMPILED_CALLERS_ONLY, NO_ALLOCATION, OPTIONS, njit
from wiggleroom.freespace.subdivision.box_relaxation import MAX_EDGES, MAX_ROWS, add_rows, linear_program_maximum
from wiggleroom.freespace.subdivision.classify_box import FORBIDDEN, FREE, MIXED, STACK_SIZE, TINY, classify_box

FOUND, CLOSED, SPENT, PAUSED = 0, 1, 2, 3
"""How the search ended: with a free path to a goal, with the proof that there is none, without room or time, or to go on."""
SPLIT_VISITS = 100
"""Splitting a box takes about as long as going over so many."""
WIDE_PATHS = 16
"""On so many of the cheapest paths the mixed boxes beside those that are split are split too: that saves passes over all boxes."""
NO_GOAL = (0.31, 0.53, 0.79)
"""Any goal will do where rows are only asked whether they contradict each other: one that no row is likely to share."""


@njit(**OPTIONS)
def neighbour_leaves(n, middle, level, first, wrap, out):
    """Leaves that share a face with box n, in unit coordinates; the turn closes on itself where `wrap`.

    Across each face lies a leaf that is at least as large, or a box of the same size, whose parts at that face count.
    """
    waiting = np.empty(256, dtype=np.int64)
    found = 0
    side = 2.0 * 0.5 ** level[n]
    for axis in range(3):
        for far in range(2):
            x, y, z = middle[n, 0], middle[n, 1], middle[n, 2]
            step = side if far else -side
            if axis == 0:
                x += step
            elif axis == 1:
                y += step
            else:
                z += step
                if wrap and abs(z) > 1.0:
                    z -= 2.0 * np.sign(z)
            if max(abs(x), abs(y), abs(z)) > 1.0:
                continue
            m = 0
            while first[m] >= 0 and level[m] < level[n]:
                m = first[m] + (x >= middle[m, 0]) + 2 * (y >= middle[m, 1]) + 4 * (z >= middle[m, 2])
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
    half = 0.5 ** level[n]
    if max(abs(middle[n, 0]), abs(middle[n, 1])) + half >= 1.0 or (turning and abs(middle[n, 2]) + half >= 1.0):
        return True
    return upper[n] > asked[5]


@njit(**OPTIONS)
def cheapest_paths(
    start, middle, level, state, first, upper, wrap, turning, asked, count, cost, before, heap_cost, heap, out, ends
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
        for k in range(neighbour_leaves(n, middle, level, first, wrap, out)):
            m = out[k]
            if state[m] == FORBIDDEN or state[m] == TINY:
                continue
            price = at + (0.01 * 0.5 ** level[m] + 1e-5 if state[m] == FREE else 1.0)
            if price < cost[m]:
                if size == len(heap):
                    return -1
                cost[m], before[m] = price, n
                heap_cost[size], heap[size] = price, m
                _sift_up(heap_cost, heap, size)
                size += 1
    return found


@njit(**OPTIONS)
def split_box(
    n, middle, level, state, first, upper, count, origin, scale, asked, a_edge, a_normal, a_disc, a_kid, b_edge, b_disc, b_kid
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
    first[n] = count
    side = 0.5 ** (level[n] + 1)
    half, swing = scale[0] * side, scale[1] * side
    for k in range(8):
        m = count + k
        for axis in range(3):
            middle[m, axis] = middle[n, axis] + (side if (k >> axis) & 1 else -side)
        level[m], first[m] = level[n] + 1, -1
        x, y = origin[0] + scale[0] * middle[m, 0], origin[1] + scale[0] * middle[m, 1]
        turn = origin[2] + scale[1] * middle[m, 2]
        state[m] = classify_box(
            x,
            y,
            turn,
            half,
            swing,
            scale[2],
            a_edge,
            a_normal,
            a_disc,
            a_kid,
            b_edge,
            b_disc,
            b_kid,
            stack,
            nodes,
            pieces,
            some,
        )
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
    middle, level, state, first, upper, count, pause, origin, scale, deepest, wrap, turning, asked, goals,
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
    cost, before = np.empty(most), np.empty(most, dtype=np.int64)
    heap_cost, heap = np.empty(8 * most), np.empty(8 * most, dtype=np.int64)
    out, ends = np.empty(3 * most + 2, dtype=np.int64), np.empty(goals, dtype=np.int64)
    x, y, z = -origin[0] / scale[0], -origin[1] / scale[0], -origin[2] / scale[1]
    while True:
        n = leaf_at(x, y, z, middle, first)
        if state[n] != MIXED or level[n] >= deepest or count + 8 > most:
            break
        count = split_box(
            n, middle, level, state, first, upper, count, origin, scale, asked, a_edge, a_normal, a_disc, a_kid, b_edge,
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
            start, middle, level, state, first, upper, wrap, turning, asked, count, cost, before, heap_cost, heap, out, ends,
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
                near = neighbour_leaves(n, middle, level, first, wrap, out) if e < WIDE_PATHS else 0
                out[near] = n
                for i in range(near + 1):
                    m = out[i]
                    if (state[m] != MIXED and m != n) or first[m] >= 0 or level[m] > level[n] or level[m] >= deepest:
                        continue
                    if count + 8 > most:
                        return SPENT, count, 0, np.inf
                    visits[0] += SPLIT_VISITS
                    count = split_box(
                        m, middle, level, state, first, upper, count, origin, scale, asked, a_edge, a_normal, a_disc, a_kid,
                        b_edge, b_disc, b_kid,
                    )  # fmt: skip
            if cut == 0:
                path[:length] = path[:length][::-1].copy()
                return FOUND, count, length, np.inf


@njit(**COMPILED_CALLERS_ONLY)
def _lies_below_goal(n, middle, level, origin, scale, turning, asked):
    """True where a free goal shows no motion worth as much as is asked for: it has to be split."""
    half = 0.5 ** level[n]
    if max(abs(middle[n, 0]), abs(middle[n, 1])) + half >= 1.0 or (turning and abs(middle[n, 2]) + half >= 1.0):
        return False
    x, y = origin[0] + scale[0] * middle[n, 0], origin[1] + scale[0] * middle[n, 1]
    turn = origin[2] + scale[1] * middle[n, 2]
    return best_corner(asked, x, y, turn, scale[0] * half, scale[1] * half)[0] <= asked[6]
