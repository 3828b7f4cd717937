"""Nested dissection of a graph by where its vertices lie, and which fronts a multifrontal factorisation has then.

The vertices are parted at their mean along the longer side of their box; those of one half that have neighbours in the other one are
eliminated last. Source: George 1973, with separators by position as of Miller, Teng, Thurston and Vavasis 1997, here along the axes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import OPTIONS, njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LEAF_SIZE = 6
"""Sets of so few vertices are not halved any more."""


@dataclass(frozen=True, eq=False)
class EliminationTree:
    """Nodes in the order of elimination, children before parents.

    Parameters
    ----------
    order : (V,) int64
        Vertices in the order of elimination; node t has those from `first[t]` to `first[t + 1]`.
    place : (V,) int64
        Where each vertex stands in the order.
    first : (T + 1,) int64
    parent, depth : (T,) int64
        Of each node; the root's parent is -1.
    border_start : (T + 1,) int64
    border : (B,) int64
        Places of the later vertices that the front of node t holds, ascending, from `border_start[t]` on.
    child, sibling : (T,) int64
        First child of each node and next child of its parent, -1 where there is none.
    """

    order: Ints
    place: Ints
    first: Ints
    parent: Ints
    depth: Ints
    border_start: Ints
    border: Ints
    child: Ints
    sibling: Ints


def dissect(at: Floats, start: Ints, neighbour: Ints) -> EliminationTree:
    """Elimination tree of a graph whose vertices lie at `at` (V, 2); neighbours of v are `neighbour[start[v]:start[v + 1]]`."""
    order, first, parent, depth = _dissected(np.ascontiguousarray(at), start, neighbour)
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    border_start, border, child, sibling = _borders(order, place, first, parent, start, neighbour)
    return EliminationTree(order, place, first, parent, depth, border_start, border, child, sibling)


@njit(**OPTIONS)
def _dissected(at, start, neighbour):
    """Vertices in the order of elimination, first place, parent and depth of each node."""
    n = len(at)
    vertex, side = np.arange(n), np.zeros(n, np.int8)
    most = 2 * n + 2
    # sets still to be halved: begin, end, parent, depth; and nodes found, parents before children
    waiting, node = np.empty((most, 4), np.int64), np.empty((most, 4), np.int64)
    waiting[0] = (0, n, -1, 0)
    left, nodes = 1, 0
    stay, away, part = np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n, np.int64)
    while left > 0:
        left -= 1
        begin, end, parent, depth = waiting[left]
        own = nodes
        nodes += 1
        if end - begin <= LEAF_SIZE:
            node[own] = (begin, end, parent, depth)
            continue
        some = vertex[begin:end].copy()
        low_x, high_x, low_y, high_y = np.inf, -np.inf, np.inf, -np.inf
        for v in some:
            low_x, high_x = min(low_x, at[v, 0]), max(high_x, at[v, 0])
            low_y, high_y = min(low_y, at[v, 1]), max(high_y, at[v, 1])
        axis = 0 if high_x - low_x >= high_y - low_y else 1
        total = 0.0
        for v in some:
            total += at[v, axis]
        cut, same = total / len(some), max(high_x - low_x, high_y - low_y) <= 0.0
        for k in range(len(some)):
            lower = 2 * k < len(some) if same else at[some[k], axis] < cut
            side[some[k]] = 1 if lower else 2
        facing = np.zeros(3, np.int64)
        for v in some:
            for q in range(start[v], start[v + 1]):
                if side[neighbour[q]] == 3 - side[v]:
                    facing[side[v]] += 1
                    break
        thin = 1 if facing[1] <= facing[2] else 2
        a, b, z = 0, 0, 0
        for v in some:
            parting = False
            if side[v] == thin:
                for q in range(start[v], start[v + 1]):
                    if side[neighbour[q]] == 3 - thin:
                        parting = True
                        break
            if parting:
                part[z] = v
                z += 1
            elif side[v] == 1:
                stay[a] = v
                a += 1
            else:
                away[b] = v
                b += 1
        for v in some:
            side[v] = 0
        vertex[begin : begin + a] = stay[:a]
        vertex[begin + a : begin + a + b] = away[:b]
        vertex[begin + a + b : end] = part[:z]
        node[own] = (begin + a + b, end, parent, depth)
        if a > 0:
            waiting[left] = (begin, begin + a, own, depth + 1)
            left += 1
        if b > 0:
            waiting[left] = (begin + a, begin + a + b, own, depth + 1)
            left += 1
    order = np.empty(n, np.int64)
    first, parents, depths = np.empty(nodes + 1, np.int64), np.empty(nodes, np.int64), np.empty(nodes, np.int64)
    first[0], placed = 0, 0
    for k in range(nodes):  # parents before children, read backwards, is children before parents
        own = nodes - 1 - k
        for q in range(node[own, 0], node[own, 1]):
            order[placed] = vertex[q]
            placed += 1
        first[k + 1] = placed
        parents[k] = -1 if node[own, 2] < 0 else nodes - 1 - node[own, 2]
        depths[k] = node[own, 3]
    return order, first, parents, depths


@njit(**OPTIONS)
def _borders(order, place, first, parent, start, neighbour):
    """Border of every node, first child and next sibling."""
    n, nodes = len(order), len(parent)
    size = 16 * n + 1024
    border, border_start = np.empty(size, np.int64), np.zeros(nodes + 1, np.int64)
    seen, found = np.full(n, -1), np.empty(n, np.int64)
    child, sibling = np.full(nodes, -1), np.full(nodes, -1)
    for t in range(nodes):
        count, last = 0, first[t + 1]
        for k in range(first[t], last):
            v = order[k]
            for q in range(start[v], start[v + 1]):
                p = place[neighbour[q]]
                if p >= last and seen[p] != t:
                    seen[p] = t
                    found[count] = p
                    count += 1
        c = child[t]
        while c >= 0:
            for q in range(border_start[c], border_start[c + 1]):
                p = border[q]
                if p >= last and seen[p] != t:
                    seen[p] = t
                    found[count] = p
                    count += 1
            c = sibling[c]
        at = border_start[t]
        if at + count > size:
            size = 2 * size + count
            longer = np.empty(size, np.int64)
            longer[:at] = border[:at]
            border = longer
        border[at : at + count] = np.sort(found[:count])
        border_start[t + 1] = at + count
        if parent[t] >= 0:
            sibling[t] = child[parent[t]]
            child[parent[t]] = t
    return border_start, border[: border_start[nodes]].copy(), child, sibling
