"""Compiled: which bodies block which while they are moved on and on along the x axis."""

from __future__ import annotations

from numba import njit

from wiggleroom.freespace.kernel import INNER, OPTIONS


@njit(**INNER)
def blocked(edges, b0, b1, a0, a1, unit):
    """True where an edge of b lies behind one of a on the same line along x, by more than `unit` both ways."""
    for i in range(b0, b1):
        bx, by, cx, cy = edges[i, 0], edges[i, 1], edges[i, 2], edges[i, 3]
        if by > cy:
            bx, by, cx, cy = cx, cy, bx, by
        if cy - by <= unit:
            continue
        left = min(bx, cx)
        for j in range(a0, a1):
            ax, ay, dx, dy = edges[j, 0], edges[j, 1], edges[j, 2], edges[j, 3]
            if ay > dy:
                ax, ay, dx, dy = dx, dy, ax, ay
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
    """Note in `arcs` which groups are blocked by which, looking at the pairs `todo` of moving and standing bodies."""
    n = len(first) - 1
    for b in range(n):
        for a in range(n):
            if a == b or not todo[b, a] or group[a] == group[b] or arcs[group[b], group[a]]:
                continue
            if boxes[b, 0] >= boxes[a, 1] - unit:
                continue
            if boxes[b, 2] >= boxes[a, 3] - unit or boxes[b, 3] <= boxes[a, 2] + unit:
                continue
            if blocked(edges, first[b], first[b + 1], first[a], first[a + 1], unit):
                arcs[group[b], group[a]] = True
