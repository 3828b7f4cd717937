"""Compiled: which bodies block which while they are moved on and on along the x axis."""

from __future__ import annotations

import numpy as np

from wiggleroom.geometry.jit_options import COMPILED_CALLERS_ONLY, OPTIONS, njit


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
def block(edges, first, boxes, todo, group, arcs, unit):
    """Note in `arcs` which groups are blocked by which, looking at the pairs `todo` of moving and standing bodies.

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
            if a == b or not todo[b, a] or group[a] == group[b] or arcs[group[b], group[a]]:
                continue
            if boxes[b, 0] >= boxes[a, 1] - unit:
                continue
            if boxes[b, 2] >= boxes[a, 3] - unit or boxes[b, 3] <= boxes[a, 2] + unit:
                continue
            if blocked(edges, top, first[b], first[b + 1], first[a], first[a + 1], unit):
                arcs[group[b], group[a]] = True
