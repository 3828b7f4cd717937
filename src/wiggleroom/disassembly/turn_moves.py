"""Compiled: one body turns among others that stand, and gives way to them.

Every small motion is shorter than the distance to what is nearest, so nothing can be met on it: conservative advancement. After each turn
the body is pushed away from what is near. Source: Mirtich and Canny, "Impulse-based dynamic simulation", 1995.
"""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import COMPILED_CALLERS_ONLY, OPTIONS, njit

ADVANCE = 0.8
"""A motion is at most this share of the least distance."""
MAX_PUSHES = 4
"""The body is pushed away at most this many times after each turn."""
EDGES_PER_BOX, BOX_MARGIN = 16, 1 + 1e-9
"""Edges in a row that are left out together, and the rounding of how far their box is, as a factor."""
STUCK = 0.02
"""A turn that carries no corner further than this share of the clearance is none: the body is stuck."""


@njit(**OPTIONS)
def edge_boxes(corner, after, first):
    """Boxes (B, 4) round every `EDGES_PER_BOX` edges of each shape in a row, and the first box of each shape (shapes + 1,)."""
    begin = np.zeros(len(first), dtype=np.int64)
    for s in range(len(first) - 1):
        begin[s + 1] = begin[s] + -((first[s] - first[s + 1]) // EDGES_PER_BOX)
    boxes = np.empty((begin[-1], 4))
    boxes[:, :2], boxes[:, 2:] = np.inf, -np.inf
    for s in range(len(first) - 1):
        for j in range(first[s], first[s + 1]):
            b = begin[s] + (j - first[s]) // EDGES_PER_BOX
            for k in (j, after[j]):
                for axis in range(2):
                    boxes[b, axis] = min(boxes[b, axis], corner[k, axis])
                    boxes[b, 2 + axis] = max(boxes[b, 2 + axis], corner[k, axis])
    return boxes, begin


@njit(**COMPILED_CALLERS_ONLY)
def corner_distance(corner, after, first, boxes, begin, s, pose, t, other, push, want, least):
    """The lesser of `least` and the distance of the corners of shape s at `pose` from the edges of shape t at `other`.

    `push` (2,) gets what would move s away from corners that are nearer than `want`. Edges that are too far to matter are left out.
    """
    c0, s0 = np.cos(pose[2] - other[2]), np.sin(pose[2] - other[2])
    cz, sz = np.cos(other[2]), np.sin(other[2])
    gx, gy = pose[0] - other[0], pose[1] - other[1]
    ox, oy = cz * gx + sz * gy, cz * gy - sz * gx  # s seen from t
    for i in range(first[s], first[s + 1]):
        x = c0 * corner[i, 0] - s0 * corner[i, 1] + ox
        y = s0 * corner[i, 0] + c0 * corner[i, 1] + oy
        reach = max(want, least) * BOX_MARGIN
        best, bx, by = reach * reach, 0.0, 0.0
        for b in range(begin[t], begin[t + 1]):
            u = max(boxes[b, 0] - x, x - boxes[b, 2], 0.0)
            v = max(boxes[b, 1] - y, y - boxes[b, 3], 0.0)
            if u * u + v * v > best * BOX_MARGIN:
                continue
            start = first[t] + (b - begin[t]) * EDGES_PER_BOX
            for j in range(start, min(start + EDGES_PER_BOX, first[t + 1])):
                k = after[j]
                ax, ay = corner[j, 0], corner[j, 1]
                ex, ey = corner[k, 0] - ax, corner[k, 1] - ay
                share = ((x - ax) * ex + (y - ay) * ey) / max(ex * ex + ey * ey, 1e-300)
                share = min(max(share, 0.0), 1.0)
                dx, dy = x - ax - share * ex, y - ay - share * ey
                square = dx * dx + dy * dy
                if square < best:
                    best, bx, by = square, dx, dy
        d = np.sqrt(best)
        least = min(least, d)
        if 0.0 < d < want:
            weight = (want - d) / d
            push[0] += weight * (cz * bx - sz * by)
            push[1] += weight * (sz * bx + cz * by)
    return least


@njit(**COMPILED_CALLERS_ONLY)
def least_distance(corner, after, first, boxes, begin, shape, pose, near, b, mine, push, back, want):
    """Least distance of body b at the pose `mine` from those that are `near`; `push` is filled with what leads away from them."""
    least = np.inf
    push[:] = 0.0
    for c in range(len(shape)):
        if not near[c]:
            continue
        back[:] = 0.0
        least = corner_distance(
            corner, after, first, boxes, begin, shape[b], mine, shape[c], pose[c], push, want, least
        )
        least = corner_distance(
            corner, after, first, boxes, begin, shape[c], pose[c], shape[b], mine, back, want, least
        )
        push[0] -= back[0]
        push[1] -= back[1]
    return least


@njit(**OPTIONS)
def turn_in_steps(corner, after, first, radius, shape, pose, near, b, angle, clearance, reach, path):
    """Turn body b by `angle` [rad], in small steps, giving way; `path` (m, 3) is filled with its poses. How many, and pairs compared.

    It ends where the body is stuck, or further than `reach` [mm] from where it began.
    """
    mine, trial, push, back = pose[b].copy(), np.empty(3), np.empty(2), np.empty(2)
    want, r = 0.5 * clearance, radius[shape[b]]
    edges = 0
    for c in range(len(shape)):
        if near[c]:
            edges += first[shape[c] + 1] - first[shape[c]]
    edges *= 2 * (first[shape[b] + 1] - first[shape[b]])
    boxes, begin = edge_boxes(corner, after, first)
    path[0] = mine
    count, work = 1, edges
    d = least_distance(corner, after, first, boxes, begin, shape, pose, near, b, mine, push, back, want)
    left = abs(angle)
    sense = 1.0 if angle > 0 else -1.0
    while left > 0.0 and count < len(path):
        step = min(left, ADVANCE * d / r)
        if step < left and step * r < STUCK * clearance:
            break
        mine[2] += sense * step
        left -= step
        d = least_distance(corner, after, first, boxes, begin, shape, pose, near, b, mine, push, back, want)
        path[count] = mine
        count += 1
        work += edges
        for _ in range(MAX_PUSHES):
            length = np.hypot(push[0], push[1])
            if d >= want or length < 1e-9 * clearance or count == len(path):
                break
            go = min(length, ADVANCE * d, want) / length
            trial[0], trial[1], trial[2] = mine[0] + go * push[0], mine[1] + go * push[1], mine[2]
            if np.hypot(trial[0] - pose[b, 0], trial[1] - pose[b, 1]) > reach:
                break
            further = least_distance(corner, after, first, boxes, begin, shape, pose, near, b, trial, push, back, want)
            work += edges
            if further <= d:
                break
            mine[:] = trial
            d = further
            path[count] = mine
            count += 1
    return count, work


@njit(**OPTIONS)
def straight(corner, after, first, shape, pose, near, b, begin, end, clearance):
    """True where body b goes straight from one pose to another of the same turn, and certainly meets none of those that are `near`."""
    boxes, first_box = edge_boxes(corner, after, first)
    mine, push, back = begin.copy(), np.empty(2), np.empty(2)
    length = np.hypot(end[0] - begin[0], end[1] - begin[1])
    gone = 0.0
    while True:
        d = least_distance(corner, after, first, boxes, first_box, shape, pose, near, b, mine, push, back, 0.0)
        if d < STUCK * clearance:
            return False
        if gone >= length:
            return True
        gone = min(length, gone + ADVANCE * d)
        mine[0] = begin[0] + (end[0] - begin[0]) * gone / length
        mine[1] = begin[1] + (end[1] - begin[1]) * gone / length
