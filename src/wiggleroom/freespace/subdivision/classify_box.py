"""Boxes of motions (x, y, turn) of one body past another, each certainly free, certainly forbidden, or mixed.

In a box no point of the moving body at distance r from its pivot is further from where the middle of the box puts it than
reach(r) = sqrt(2) half + 2 r sin(turn / 2), with the half sides of the box. So a point of its boundary that lies deeper than its reach in
the other body forbids the whole box, and where no point of its boundary comes nearer to the other than its reach, the whole box is free.
Source of the idea: Varava et al., "Free Space of Rigid Objects", 2020.
"""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import COMPILED_CALLERS_ONLY, OPTIONS, njit
from wiggleroom.freespace.subdivision.box_relaxation import (
    MAX_EDGES,
    edges_within,
    offset_from_edge,
    signed_line_distance,
)

STACK_SIZE = 96
"""Room for the nodes that wait while a tree is walked."""
MIXED, FREE, FORBIDDEN, TINY = 0, 1, 2, 3
"""States of a box; TINY is mixed and not split any more."""


@njit(**COMPILED_CALLERS_ONLY)
def signed_distance(x, y, edge, normal, disc, kid, stack, nearest):
    """Signed distance of a point from the boundary, negative inside the material.

    nearest[0] is any edge, best one that is near, and then the one that is nearest. Where two edges are equally near, as on both sides of
    a lip of no thickness, the point counts as outside if either says so: nothing is forbidden wrongly, and paths are looked at again by
    other means.
    """
    qx, qy, t = offset_from_edge(x, y, edge, nearest[0])
    best, sign = np.inf, 1.0
    same = 1e-9 * disc[0, 2]
    limit = np.sqrt(qx * qx + qy * qy) + same
    stack[0] = 0
    count = 1
    while count:
        count -= 1
        node = stack[count]
        dx, dy, far = x - disc[node, 0], y - disc[node, 1], limit + disc[node, 2]
        if dx * dx + dy * dy > far * far:
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
        qx, qy, t = offset_from_edge(x, y, edge, e)
        d = np.sqrt(qx * qx + qy * qy)
        if d > limit:
            continue
        which = 1 if t <= 0.0 else (2 if t >= 1.0 else 0)
        side = 1.0 if qx * normal[e, which, 0] + qy * normal[e, which, 1] >= 0.0 else -1.0
        sign = side if d < best - same else max(sign, side)
        if d < best:
            best, nearest[0] = d, e
            limit = min(limit, best + same)
    return sign * best


@njit(**COMPILED_CALLERS_ONLY)
def edges_near_box(
    x, y, turn, half, swing, slack, a_edge, a_normal, a_disc, a_kid, b_disc, b_kid, stack, nodes, nearest, near
):  # fmt: skip
    """Fill `near` with the moving body's edges that may touch the other in a box, and return how many; none else does in any part of it."""
    c, s = np.cos(turn), np.sin(turn)
    shift, spread = np.sqrt(2.0) * half + slack, 2.0 * np.sin(min(swing, np.pi) / 2)
    nodes[0] = 0
    count, found = 1, 0
    while count:
        count -= 1
        node = nodes[count]
        px, py, w = b_disc[node, 0], b_disc[node, 1], b_disc[node, 2]
        far = np.sqrt(px * px + py * py)
        apart = signed_distance(
            c * px - s * py + x, s * px + c * py + y, a_edge, a_normal, a_disc, a_kid, stack, nearest
        )
        if apart > w + shift + spread * (far + w):
            continue
        if b_kid[node, 0] >= 0:
            nodes[count] = b_kid[node, 1]
            nodes[count + 1] = b_kid[node, 0]
            count += 2
        else:
            near[found] = b_kid[node, 1]
            found += 1
    return found


@njit(**COMPILED_CALLERS_ONLY)
def classify_box(
    x, y, turn, half, swing, slack, a_edge, a_normal, a_disc, a_kid, b_edge, near, count, stack, pieces, some, nearest
):  # fmt: skip
    """FREE, FORBIDDEN or MIXED: the box round (x, y, turn) with half sides `half` [mm] and `swing` [rad].

    Of the moving body's edges only near[:count] may touch the other. Points count as moving `slack` [mm] further than they do, which is
    more than rounding puts them elsewhere.
    """
    c, s = np.cos(turn), np.sin(turn)
    shift, spread = np.sqrt(2.0) * half + slack, 2.0 * np.sin(min(swing, np.pi) / 2)
    mixed = False
    for i in range(count):
        e = near[i]
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
            apart = signed_distance(
                c * mx - s * my + x, s * mx + c * my + y, a_edge, a_normal, a_disc, a_kid, stack, nearest
            )
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
    near, nearest = np.empty(len(b_edge), dtype=np.int64), np.zeros(1, dtype=np.int64)
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
        found = edges_near_box(
            m[0], m[1], m[2], half, swing, 0.0, a_edge, a_normal, a_disc, a_kid, b_disc, b_kid, stack, nodes, nearest, near
        )  # fmt: skip
        how = classify_box(
            m[0], m[1], m[2], half, swing, 0.0, a_edge, a_normal, a_disc, a_kid, b_edge, near, found, stack, pieces, some, nearest
        )  # fmt: skip
        if how == FREE:
            continue
        if how == FORBIDDEN or t1 - t0 < least or count > 60:
            return False
        todo[count, 0], todo[count, 1] = (t0 + t1) / 2, t1
        todo[count + 1, 0], todo[count + 1, 1] = t0, (t0 + t1) / 2
        count += 2
    return True
