"""Boxes of motions (x, y, turn) of one body past another, each certainly free, certainly forbidden, or mixed.

In a box no point of the moving body at distance r from its pivot is further from where the middle of the box puts it than
reach(r) = sqrt(2) half + 2 r sin(turn / 2), with the half sides of the box. So a point of its boundary that lies deeper than its reach in
the other body forbids the whole box, and where no point of its boundary comes nearer to the other than its reach, the whole box is free.
Source of the idea: Varava et al., "Free Space of Rigid Objects", 2020.
"""

from __future__ import annotations

import numpy as np

from wiggleroom.freespace.subdivision.box_relaxation import (
    MAX_EDGES,
    MAX_ROWS,
    add_rows,
    edges_within,
    linear_program_maximum,
    signed_line_distance,
)
from wiggleroom.geometry.jit_options import COMPILED_CALLERS_ONLY, NO_ALLOCATION, OPTIONS, njit

STACK_SIZE = 96
"""Room for the nodes that wait while a tree is walked."""
MIXED, FREE, FORBIDDEN, TINY = 0, 1, 2, 3
FOUND, CLOSED, SPENT, PAUSED = 0, 1, 2, 3
SPLIT_VISITS = 100
"""Cutting a box takes about as long as going over so many."""


@njit(**COMPILED_CALLERS_ONLY)
def signed_distance(x, y, edge, normal, disc, kid, stack):
    """Signed distance of a point from the boundary, negative inside the material.

    Where two edges are equally near, as on both sides of a lip of no thickness, the point counts as outside if either says so: nothing is
    forbidden wrongly, and ways are looked at again by other means.
    """
    best, sign = np.inf, 1.0
    same = 1e-9 * disc[0, 2]
    stack[0] = 0
    count = 1
    while count:
        count -= 1
        node = stack[count]
        dx, dy = x - disc[node, 0], y - disc[node, 1]
        if np.sqrt(dx * dx + dy * dy) - disc[node, 2] > best + same:
            continue
        if kid[node, 0] >= 0:
            one, other = kid[node, 0], kid[node, 1]
            ox, oy = x - disc[one, 0], y - disc[one, 1]
            px, py = x - disc[other, 0], y - disc[other, 1]
            if ox * ox + oy * oy < px * px + py * py:  # the nearer one is looked at first
                one, other = other, one
            stack[count] = one
            stack[count + 1] = other
            count += 2
            continue
        e = kid[node, 1]
        ax, ay = edge[e, 0], edge[e, 1]
        ex, ey = edge[e, 2] - ax, edge[e, 3] - ay
        t = ((x - ax) * ex + (y - ay) * ey) / (ex * ex + ey * ey)
        t = min(max(t, 0.0), 1.0)
        qx, qy = x - ax - t * ex, y - ay - t * ey
        d = np.sqrt(qx * qx + qy * qy)
        if d > best + same:
            continue
        which = 1 if t <= 0.0 else (2 if t >= 1.0 else 0)
        side = 1.0 if qx * normal[e, which, 0] + qy * normal[e, which, 1] >= 0.0 else -1.0
        sign = side if d < best - same else max(sign, side)
        best = min(best, d)
    return sign * best


@njit(**COMPILED_CALLERS_ONLY)
def classify_box(
    x, y, turn, half, swing, a_edge, a_normal, a_disc, a_kid, b_edge, b_disc, b_kid, stack, nodes, pieces, some
):
    """FREE, FORBIDDEN or MIXED: the box round (x, y, turn) with half sides `half` [mm] and `swing` [rad]."""
    c, s = np.cos(turn), np.sin(turn)
    shift, spread = np.sqrt(2.0) * half, 2.0 * np.sin(min(swing, np.pi) / 2)
    mixed = False
    nodes[0] = 0
    count = 1
    while count:
        count -= 1
        node = nodes[count]
        px, py, w = b_disc[node, 0], b_disc[node, 1], b_disc[node, 2]
        far = np.sqrt(px * px + py * py)
        apart = signed_distance(c * px - s * py + x, s * px + c * py + y, a_edge, a_normal, a_disc, a_kid, stack)
        if apart > w + shift + spread * (far + w):
            continue
        if mixed and apart - w > -shift - spread * max(far - w, 0.0):
            continue  # nothing here is deep enough to forbid the box
        if b_kid[node, 0] >= 0:
            if apart < -w - shift - spread * (far + w):
                return FORBIDDEN
            nodes[count] = b_kid[node, 0]
            nodes[count + 1] = b_kid[node, 1]
            count += 2
            continue
        e = b_kid[node, 1]
        for k in range(4):
            pieces[0, k] = b_edge[e, k]
        left = 1
        while left:  # a straight piece is looked at from its middle, and halved where that does not decide
            left -= 1
            x0, y0, x1, y1 = pieces[left, 0], pieces[left, 1], pieces[left, 2], pieces[left, 3]
            mx, my = (x0 + x1) / 2, (y0 + y1) / 2
            w = np.sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2) / 2
            far = np.sqrt(mx * mx + my * my)
            reach = shift + spread * far
            apart = signed_distance(c * mx - s * my + x, s * mx + c * my + y, a_edge, a_normal, a_disc, a_kid, stack)
            if apart <= -reach:
                return FORBIDDEN
            if apart > w + reach + spread * w:
                continue
            if w <= reach:
                mixed = True
                continue
            if mixed and apart - w > -shift - spread * max(far - w, 0.0):
                continue
            most = shift + spread * (far + w)
            px, py = c * mx - s * my + x, s * mx + c * my + y
            if (
                edges_within(px, py, w + most, a_edge, a_disc, a_kid, stack, some) == 1
            ):  # along one line both ends decide
                qx, qy = c * (x1 - mx) - s * (y1 - my), s * (x1 - mx) + c * (y1 - my)
                one = signed_line_distance(a_edge, some[0], px - qx, py - qy)
                other = signed_line_distance(a_edge, some[0], px + qx, py + qy)
                if min(one, other) <= -most:
                    return FORBIDDEN
                mixed = mixed or min(one, other) <= most
                continue
            for k in range(2):
                pieces[left + k, 0] = x0 if k == 0 else mx
                pieces[left + k, 1] = y0 if k == 0 else my
                pieces[left + k, 2] = mx if k == 0 else x1
                pieces[left + k, 3] = my if k == 0 else y1
            left += 2
    return MIXED if mixed else FREE


@njit(**OPTIONS)
def is_free_segment(one, other, a_edge, a_normal, a_disc, a_kid, b_edge, b_disc, b_kid, least):
    """True where every motion on the straight line between two (3,) is free; halves it until boxes decide."""
    stack = np.empty(STACK_SIZE, dtype=np.int64)
    nodes = np.empty(STACK_SIZE, dtype=np.int64)
    pieces, some = np.empty((128, 4)), np.empty(MAX_EDGES + 1, dtype=np.int64)
    todo = np.empty((64, 2))
    todo[0, 0], todo[0, 1] = 0.0, 1.0
    count = 1
    d = other - one
    while count:
        count -= 1
        t0, t1 = todo[count, 0], todo[count, 1]
        m = one + (t0 + t1) / 2 * d
        half = max(abs(d[0]), abs(d[1])) * (t1 - t0) / 2
        swing = abs(d[2]) * (t1 - t0) / 2
        how = classify_box(
            m[0], m[1], m[2], half, swing, a_edge, a_normal, a_disc, a_kid, b_edge, b_disc, b_kid, stack, nodes, pieces, some
        )  # fmt: skip
        if how == FREE:
            continue
        if how == FORBIDDEN or t1 - t0 < least or count > 60:
            return False
        todo[count, 0], todo[count, 1] = (t0 + t1) / 2, t1
        todo[count + 1, 0], todo[count + 1, 1] = t0, (t0 + t1) / 2
        count += 2
    return True


@njit(**OPTIONS)
def neighbour_leaves(n, middle, level, first, wrap, out):
    """Leaves that share a face with box n, in unit coordinates; the turn closes on itself where `wrap`."""
    waiting = np.empty(256, dtype=np.int64)
    found = 0
    half = 0.5 ** level[n]
    for lap in range(-1, 2):
        z = middle[n, 2] + 2.0 * lap
        if lap != 0 and (not wrap or abs(z) - half > 1.0):
            continue
        waiting[0] = 0
        count = 1
        while count:
            count -= 1
            m = waiting[count]
            touch = half + 0.5 ** level[m]
            dx, dy = abs(middle[n, 0] - middle[m, 0]) - touch, abs(middle[n, 1] - middle[m, 1]) - touch
            dz = abs(z - middle[m, 2]) - touch
            if dx > 0.0 or dy > 0.0 or dz > 0.0:
                continue
            faces = (dx == 0.0) + (dy == 0.0) + (dz == 0.0)
            if faces > 1:
                continue
            if first[m] >= 0:
                for k in range(8):
                    waiting[count + k] = first[m] + k
                count += 8
            elif faces == 1 and found < len(out) - 1:
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
    """Cheapest ways of boxes from `start` to goals; mixed boxes cost much more than free ones.

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
    """Cut box n into eight and judge them; returns the new number of boxes."""
    stack = np.empty(STACK_SIZE, dtype=np.int64)
    nodes = np.empty(STACK_SIZE, dtype=np.int64)
    pieces = np.empty((128, 4))
    some = np.empty(MAX_EDGES + 1, dtype=np.int64)
    one = np.empty(1, dtype=np.int64)
    rows, active, inverse = np.empty((MAX_ROWS, 4)), np.empty((3, 4)), np.empty((3, 3))
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
            x, y, turn, half, swing, a_edge, a_normal, a_disc, a_kid, b_edge, b_disc, b_kid, stack, nodes, pieces, some
        )
        upper[m] = objective_bound(asked, x, y, turn, half, swing)
        if state[m] != MIXED or asked[5] == np.inf:
            continue
        found = add_rows(
            x,
            y,
            turn,
            half,
            swing,
            True,
            b_edge,
            b_disc,
            b_kid,
            a_edge,
            a_disc,
            a_kid,
            stack,
            nodes,
            some,
            one,
            rows,
            0,
        )
        found = add_rows(
            x,
            y,
            turn,
            half,
            swing,
            False,
            a_edge,
            a_disc,
            a_kid,
            b_edge,
            b_disc,
            b_kid,
            stack,
            nodes,
            some,
            one,
            rows,
            found,
        )
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
    a_edge, a_normal, a_disc, a_kid, b_edge, b_disc, b_kid, way, visits,
):  # fmt: skip
    """Cut the mixed boxes on the cheapest ways from rest to goals, again and again, until one way is free or none is left.

    Goals are boxes at the rim of the window and those that may hold motions worth more than asked[5]; a free one must hold a motion worth
    more than asked[6]. `goals` ways are looked at in every lap.

    Returns how it ended, the number of boxes, and how many boxes of `way` are filled, from rest to the goal. Above `pause` boxes it
    returns too; called again, it goes on. visits[0] counts the boxes gone over and what cutting them takes; above visits[1] it gives up.
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
        return SPENT, count, 0
    while True:
        if count > pause:
            return PAUSED, count, 0
        if visits[0] > visits[1]:
            return SPENT, count, 0
        visits[0] += count
        found = cheapest_paths(
            start, middle, level, state, first, upper, wrap, turning, asked, count, cost, before, heap_cost, heap, out, ends,
        )  # fmt: skip
        if found < 0:
            return SPENT, count, 0
        if found == 0:
            given_up = False
            for n in range(count):
                given_up = given_up or state[n] == TINY
            return (SPENT if given_up else CLOSED), count, 0
        for e in range(found):
            length, cut, n = 0, 0, ends[e]
            while n >= 0:
                way[length] = n
                length += 1
                n = before[n]
            for k in range(length):
                n = way[k]
                if first[n] >= 0:  # cut on another way already
                    cut += 1
                    continue
                if state[n] != MIXED and not (
                    k == 0 and _hides_its_best(n, middle, level, origin, scale, turning, asked)
                ):
                    continue
                cut += 1
                if level[n] >= deepest:
                    state[n] = TINY
                    continue
                # mixed boxes beside it that are as large will be asked next
                near = neighbour_leaves(n, middle, level, first, wrap, out) if e == 0 else 0
                out[near] = n
                for i in range(near + 1):
                    m = out[i]
                    if (state[m] != MIXED and m != n) or first[m] >= 0 or level[m] > level[n] or level[m] >= deepest:
                        continue
                    if count + 8 > most:
                        return SPENT, count, 0
                    visits[0] += SPLIT_VISITS
                    count = split_box(
                        m, middle, level, state, first, upper, count, origin, scale, asked, a_edge, a_normal, a_disc, a_kid,
                        b_edge, b_disc, b_kid,
                    )  # fmt: skip
            if cut == 0:
                way[:length] = way[:length][::-1].copy()
                return FOUND, count, length


@njit(**COMPILED_CALLERS_ONLY)
def _hides_its_best(n, middle, level, origin, scale, turning, asked):
    """True where a free goal shows no motion worth as much as is asked for: it has to be cut."""
    half = 0.5 ** level[n]
    if max(abs(middle[n, 0]), abs(middle[n, 1])) + half >= 1.0 or (turning and abs(middle[n, 2]) + half >= 1.0):
        return False
    x, y = origin[0] + scale[0] * middle[n, 0], origin[1] + scale[0] * middle[n, 1]
    turn = origin[2] + scale[1] * middle[n, 2]
    return best_corner(asked, x, y, turn, scale[0] * half, scale[1] * half)[0] <= asked[6]
