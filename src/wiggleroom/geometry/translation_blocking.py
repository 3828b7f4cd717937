"""Compiled: which bodies block which while they are moved on and on along a direction, and which of them leave."""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import COMPILED_CALLERS_ONLY, OPTIONS, njit


@njit(**COMPILED_CALLERS_ONLY)
def blocked(edges, top, b0, b1, a0, a1, unit):
    """True where an edge of b lies behind one of a on the same line along x, by more than `unit` both ways."""
    for i in range(b0, b1):
        bx, by, cx, cy = edges[i, 0], edges[i, 1], edges[i, 2], edges[i, 3]
        if cy - by <= unit:
            continue
        left = min(bx, cx)
        one, end = a0, a1  # the first edge of a before which all end below this one
        while one < end:
            middle = (one + end) // 2
            if top[middle] - by <= unit:
                one = middle + 1
            else:
                end = middle
        for j in range(one, a1):
            ax, ay, dx, dy = edges[j, 0], edges[j, 1], edges[j, 2], edges[j, 3]
            if cy - ay <= unit:
                break
            low, high = max(by, ay), min(cy, dy)
            if high - low <= unit or left >= max(ax, dx) - unit:
                continue
            for y in (low + 0.25 * unit, high - 0.25 * unit):
                xb = bx + (cx - bx) * (y - by) / (cy - by)
                xa = ax + (dx - ax) * (y - ay) / (dy - ay)
                if xb < xa - unit:
                    return True
    return False


@njit(**OPTIONS)
def turn_edges(edges, first, b, u, v, turned, boxes):
    """Write the edges of body b in a frame with the x axis (u, v), the lowest first and each upwards, and the box round them."""
    boxes[b, 0], boxes[b, 1], boxes[b, 2], boxes[b, 3] = np.inf, -np.inf, np.inf, -np.inf
    low = np.minimum(
        v * -edges[first[b] : first[b + 1], 0] + u * edges[first[b] : first[b + 1], 1],
        v * -edges[first[b] : first[b + 1], 2] + u * edges[first[b] : first[b + 1], 3],
    )
    for place, k in enumerate(np.argsort(low, kind="mergesort")):
        e = edges[first[b] + k]
        bx, by, cx, cy = u * e[0] + v * e[1], u * e[1] - v * e[0], u * e[2] + v * e[3], u * e[3] - v * e[2]
        if by > cy:
            bx, by, cx, cy = cx, cy, bx, by
        row = first[b] + place
        turned[row, 0], turned[row, 1], turned[row, 2], turned[row, 3] = bx, by, cx, cy
        boxes[b, 0], boxes[b, 1] = min(boxes[b, 0], bx, cx), max(boxes[b, 1], bx, cx)
        boxes[b, 2], boxes[b, 3] = min(boxes[b, 2], by), max(boxes[b, 3], cy)


@njit(**OPTIONS)
def add_blocking_arcs(edges, first, boxes, near, wanted, ignored, group, arcs, unit):
    """Note in `arcs` which groups are blocked by which, looking at the pairs of bodies whose `near` is as `wanted`.

    Edges (x, y) to (x, y) run upwards, those of a body from the one that begins lowest.
    """
    n = len(first) - 1
    top = np.empty(len(edges))
    for b in range(n):
        highest = -np.inf
        for i in range(first[b], first[b + 1]):
            highest = max(highest, edges[i, 3])
            top[i] = highest
    for b in range(n):
        for a in range(n):
            if a == b or near[b, a] != wanted or ignored[b, a] or group[a] == group[b] or arcs[group[b], group[a]]:
                continue
            if boxes[b, 0] >= boxes[a, 1] - unit:
                continue
            if boxes[b, 2] >= boxes[a, 3] - unit or boxes[b, 3] <= boxes[a, 2] + unit:
                continue
            if blocked(edges, top, first[b], first[b + 1], first[a], first[a + 1], unit):
                arcs[group[b], group[a]] = True


@njit(**OPTIONS)
def strong_components(arcs, label):
    """Fill `label` with the number of every node's strongly connected component, those that arcs lead to first; how many.

    Source: Tarjan, "Depth-first search and linear graph algorithms", 1972.
    """
    n = len(arcs)
    index, low, next_ = np.full(n, -1), np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64)
    stack, calls = np.empty(n, dtype=np.int64), np.empty(n, dtype=np.int64)
    label[:] = -1
    seen, height, count = 0, 0, 0
    for root in range(n):
        if index[root] >= 0:
            continue
        depth = 1
        calls[0] = root
        while depth:
            node = calls[depth - 1]
            if index[node] < 0:
                index[node] = low[node] = seen
                seen += 1
                stack[height] = node
                height += 1
            deeper = False
            while next_[node] < n:
                other = next_[node]
                if arcs[node, other]:
                    if index[other] < 0:
                        calls[depth] = other
                        depth += 1
                        deeper = True
                        break
                    if label[other] < 0:
                        low[node] = min(low[node], low[other])
                next_[node] += 1
            if deeper:
                continue
            if low[node] == index[node]:
                while True:
                    height -= 1
                    label[stack[height]] = count
                    if stack[height] == node:
                        break
                count += 1
            depth -= 1
    return count


@njit(**OPTIONS)
def leaving(edges, first, direction, near, ignored, group, ground, unit, who):
    """Mark in `who` the smallest set of bodies that nothing else blocks along a direction; False where there is none.

    Nodes of the graph are groups of bodies, and the one that holds the body `ground` stands.
    """
    n, groups = len(first) - 1, group.max() + 1
    u, v = direction[0], direction[1]
    turned, boxes = np.empty((len(edges), 4)), np.empty((n, 4))
    for b in range(n):
        turn_edges(edges, first, b, u, v, turned, boxes)
    arcs, label = np.zeros((groups, groups), dtype=np.bool_), np.zeros(groups, dtype=np.int64)
    count = 0
    for wanted in (True, False):  # near ones decide most graphs
        add_blocking_arcs(turned, first, boxes, near, wanted, ignored, group, arcs, unit)
        count = strong_components(arcs, label)
        if count == 1:
            return False
    size, sink = np.zeros(count, dtype=np.int64), np.ones(count, dtype=np.bool_)
    for g in range(groups):
        size[label[g]] += 1
        for h in range(groups):
            if arcs[g, h] and label[g] != label[h]:
                sink[label[g]] = False
    sink[label[group[ground]]] = False
    best = -1
    for c in range(count):
        if sink[c] and (best < 0 or size[c] <= size[best]):
            best = c
    for b in range(n):
        who[b] = best >= 0 and label[group[b]] == best
    return best >= 0


@njit(**OPTIONS)
def taken_along(edges, first, direction, ignored, fixed, unit, who):
    """Mark in `who`, which holds one body, all that it pushes ahead of it along a direction; False where a fixed body is among them.

    It is the smallest set with that body that no arc of the blocking graph leads out of.
    """
    n = len(first) - 1
    turned, boxes, top = np.empty((len(edges), 4)), np.empty((n, 4)), np.empty(len(edges))
    order, placed = np.empty(n, dtype=np.int64), 0
    for standing in (True, False):  # fixed ones end most questions
        for b in range(n):
            if fixed[b] == standing:
                order[placed] = b
                placed += 1
    for b in order:
        turn_edges(edges, first, b, direction[0], direction[1], turned, boxes)
        highest = -np.inf
        for i in range(first[b], first[b + 1]):
            highest = max(highest, turned[i, 3])
            top[i] = highest
    waiting, height = np.empty(n, dtype=np.int64), 0
    for b in range(n):
        if who[b]:
            waiting[height] = b
            height += 1
    while height:
        height -= 1
        b = waiting[height]
        for a in order:
            if who[a] or ignored[b, a] or boxes[b, 0] >= boxes[a, 1] - unit:
                continue
            if boxes[b, 2] >= boxes[a, 3] - unit or boxes[b, 3] <= boxes[a, 2] + unit:
                continue
            if blocked(turned, top, first[b], first[b + 1], first[a], first[a + 1], unit):
                if fixed[a]:
                    return False
                who[a] = True
                waiting[height] = a
                height += 1
    return True
