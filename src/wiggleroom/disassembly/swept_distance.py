"""Compiled: the least distance of two outlines while one is carried past the other.

While B moves straight past A and does not turn, the distance is least between a corner of one and an edge of the other: between the edges
of A and the segments along which corners of B are carried, seen from A, and the same with A and B exchanged. A turn is cut into steps so
small that corners run straight but for a known sagitta.
"""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import COMPILED_CALLERS_ONLY, OPTIONS, njit

TURN_STEP = 0.01
"""Turns are cut into steps of at most this [rad]."""


@njit(**COMPILED_CALLERS_ONLY)
def point_distance(px, py, ax, ay, bx, by):
    """Distance of a point from a segment."""
    dx, dy = bx - ax, by - ay
    square = dx * dx + dy * dy
    t = 0.0
    if square > 0.0:
        t = min(1.0, max(0.0, ((px - ax) * dx + (py - ay) * dy) / square))
    return np.hypot(px - ax - t * dx, py - ay - t * dy)


@njit(**COMPILED_CALLERS_ONLY)
def segment_distance(ax, ay, bx, by, cx, cy, dx, dy):
    """Distance of two segments; zero where they cross."""
    one = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    two = (bx - ax) * (dy - ay) - (by - ay) * (dx - ax)
    three = (dx - cx) * (ay - cy) - (dy - cy) * (ax - cx)
    four = (dx - cx) * (by - cy) - (dy - cy) * (bx - cx)
    if one * two < 0.0 and three * four < 0.0:
        return 0.0
    return min(
        min(point_distance(ax, ay, cx, cy, dx, dy), point_distance(bx, by, cx, cy, dx, dy)),
        min(point_distance(cx, cy, ax, ay, bx, by), point_distance(dx, dy, ax, ay, bx, by)),
    )


@njit(**COMPILED_CALLERS_ONLY)
def carried_distance(corner, after, first, carried, standing, p, q, least):
    """Least distance of an outline from the corners of another shape that are carried from pose p to q; `least` where it is not less."""
    cp, sp, cq, sq = np.cos(p[2]), np.sin(p[2]), np.cos(q[2]), np.sin(q[2])
    for v in range(first[carried], first[carried + 1]):
        x, y = corner[v, 0], corner[v, 1]
        ax, ay = cp * x - sp * y + p[0], sp * x + cp * y + p[1]
        bx, by = cq * x - sq * y + q[0], sq * x + cq * y + q[1]
        left, right = min(ax, bx) - least, max(ax, bx) + least
        low, high = min(ay, by) - least, max(ay, by) + least
        for e in range(first[standing], first[standing + 1]):
            f = after[e]
            cx, cy, dx, dy = corner[e, 0], corner[e, 1], corner[f, 0], corner[f, 1]
            if max(cx, dx) < left or min(cx, dx) > right or max(cy, dy) < low or min(cy, dy) > high:
                continue
            here = segment_distance(ax, ay, bx, by, cx, cy, dx, dy)
            if here < least:
                least = here
                left, right = min(ax, bx) - least, max(ax, bx) + least
                low, high = min(ay, by) - least, max(ay, by) + least
    return least


@njit(**COMPILED_CALLERS_ONLY)
def seen_from(a, b, out):
    """Pose of b in the frame of a."""
    c, s = np.cos(a[2]), np.sin(a[2])
    dx, dy = b[0] - a[0], b[1] - a[1]
    out[0], out[1], out[2] = c * dx + s * dy, -s * dx + c * dy, b[2] - a[2]


@njit(**OPTIONS)
def swept_distance(corner, after, first, shape, radius, a, b, begin, end, least):
    """Least distance of bodies a and b while all go evenly from the poses `begin` (n, 3) to `end`; `least` where it is not less.

    Turns are cut into steps of at most TURN_STEP; by so much as corners leave the straight line in one the distance is less.
    """
    turn = max(abs(end[a, 2] - begin[a, 2]), abs(end[b, 2] - begin[b, 2]))
    pieces = max(1, int(np.ceil(turn / TURN_STEP)))
    apart = max(
        np.hypot(begin[b, 0] - begin[a, 0], begin[b, 1] - begin[a, 1]),
        np.hypot(end[b, 0] - end[a, 0], end[b, 1] - end[a, 1]),
    )
    sagitta = (radius[a] + radius[b] + apart) * (2.0 * turn / pieces) ** 2 / 8.0
    p, q, u, v = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    one, other = np.empty(3), np.empty(3)
    limit = least + sagitta
    found = limit
    for k in range(pieces):
        s, t = k / pieces, (k + 1) / pieces
        for i in range(3):
            one[i] = begin[a, i] + s * (end[a, i] - begin[a, i])
            other[i] = begin[b, i] + s * (end[b, i] - begin[b, i])
        seen_from(one, other, p)
        seen_from(other, one, u)
        for i in range(3):
            one[i] = begin[a, i] + t * (end[a, i] - begin[a, i])
            other[i] = begin[b, i] + t * (end[b, i] - begin[b, i])
        seen_from(one, other, q)
        seen_from(other, one, v)
        found = carried_distance(corner, after, first, shape[b], shape[a], p, q, found)
        found = carried_distance(corner, after, first, shape[a], shape[b], u, v, found)
    return least if found >= limit else max(found - sagitta, 0.0)
