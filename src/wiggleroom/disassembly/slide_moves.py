"""Compiled: how far bodies slide along a direction until they meet others, and which sets of them slide as one.

A corner or an edge of b meets an edge of c that lies ahead of it on the same line of travel: for polygons the distance is least at an end
of the strip that two edges share. Edges count as longer by a margin, so that what passes with less room than that counts as blocked.
"""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import COMPILED_CALLERS_ONLY, OPTIONS, njit

MAX_STOPS = 24
"""Places along one slide at which a body may stop, at most."""


@njit(**COMPILED_CALLERS_ONLY)
def front_distance(bx, by, cx, cy, ex, ey, fx, fy, margin):
    """How far the edge b-c, which faces ahead, goes along x until it meets the edge e-f, which faces back; infinity where it never does."""
    low, high = max(by - margin, fy), min(cy + margin, ey)
    if high <= low:
        return np.inf
    nearest, furthest = np.inf, -np.inf
    for y in (low, high):
        share = min(max((y - by) / (cy - by), 0.0), 1.0)
        ahead = fx + (ex - fx) * (y - fy) / (ey - fy) - bx - (cx - bx) * share
        nearest, furthest = min(nearest, ahead), max(furthest, ahead)
    if nearest + furthest < 0.0:  # behind
        return np.inf
    return max(nearest, 0.0)


@njit(**OPTIONS)
def slide_distances(corner, after, first, shape, pose, there, directions, ignored, margin, distance):
    """Fill `distance` (d, n, n): how far body b slides along each direction until it meets body c, which stands.

    Bodies that are not `there` meet nothing. Returns the pairs of edges that were compared.
    """
    n = len(shape)
    most = 0
    for b in range(n):
        most += first[shape[b] + 1] - first[shape[b]]
    ahead, back = np.empty((most, 4)), np.empty((most, 4))
    ahead_first, back_first = np.zeros(n + 1, dtype=np.int64), np.zeros(n + 1, dtype=np.int64)
    box = np.empty((n, 4))
    work = 0
    for k in range(len(directions)):
        u, v = directions[k, 0], directions[k, 1]
        i, j = 0, 0
        for b in range(n):
            s = shape[b]
            c0, s0 = np.cos(pose[b, 2]), np.sin(pose[b, 2])
            c, d = c0 * u + s0 * v, s0 * u - c0 * v  # turned back by the direction's angle
            x0, y0 = u * pose[b, 0] + v * pose[b, 1], u * pose[b, 1] - v * pose[b, 0]
            box[b, 0], box[b, 1], box[b, 2], box[b, 3] = np.inf, -np.inf, np.inf, -np.inf
            if there[b]:
                for e in range(first[s], first[s + 1]):
                    f = after[e]
                    x = c * corner[e, 0] - d * corner[e, 1] + x0
                    y = d * corner[e, 0] + c * corner[e, 1] + y0
                    p = c * corner[f, 0] - d * corner[f, 1] + x0
                    q = d * corner[f, 0] + c * corner[f, 1] + y0
                    box[b, 0], box[b, 1] = min(box[b, 0], x), max(box[b, 1], x)
                    box[b, 2], box[b, 3] = min(box[b, 2], y), max(box[b, 3], y)
                    if q > y:
                        ahead[i, 0], ahead[i, 1], ahead[i, 2], ahead[i, 3] = x, y, p, q
                        i += 1
                    elif q < y:
                        back[j, 0], back[j, 1], back[j, 2], back[j, 3] = x, y, p, q
                        j += 1
            ahead_first[b + 1], back_first[b + 1] = i, j
        for b in range(n):
            for a in range(n):
                distance[k, b, a] = np.inf
                if a == b or ignored[b, a] or not there[a] or not there[b] or box[b, 0] >= box[a, 1]:
                    continue
                if box[b, 3] + margin <= box[a, 2] or box[b, 2] - margin >= box[a, 3]:
                    continue
                least = np.inf
                for e in range(ahead_first[b], ahead_first[b + 1]):
                    bx, by, cx, cy = ahead[e, 0], ahead[e, 1], ahead[e, 2], ahead[e, 3]
                    if by - margin >= box[a, 3] or cy + margin <= box[a, 2]:
                        continue
                    work += back_first[a + 1] - back_first[a]
                    for f in range(back_first[a], back_first[a + 1]):
                        if back[f, 1] <= by - margin or back[f, 3] >= cy + margin:
                            continue
                        least = min(
                            least,
                            front_distance(bx, by, cx, cy, back[f, 0], back[f, 1], back[f, 2], back[f, 3], margin),
                        )
                distance[k, b, a] = least
    return work


@njit(**OPTIONS)
def add_pushed(distance, who, reach, stands):
    """Add to `who` all that it pushes when it slides by `reach`; False where something that stands is among it."""
    n = len(who)
    waiting = np.flatnonzero(who)
    pushed = np.empty(n, dtype=np.int64)
    count = len(waiting)
    pushed[:count] = waiting
    while count:
        count -= 1
        b = pushed[count]
        for c in range(n):
            if not who[c] and distance[b, c] < reach:
                if stands[c]:
                    return False
                who[c] = True
                pushed[count] = c
                count += 1
    return True


@njit(**OPTIONS)
def slides(i0, i1, distance, stands, there, stops, stop_count, units, clearance, horizon, who, along, length, count):
    """Add slides of some bodies, and of what they push, to the `count` in `who` (m, n), `along` (m,) and `length` (m,); their number then.

    They are those of i0 to i1, where i = k n + b stands for body b along direction k.

    Along a direction with a unit they stop at its multiples, else at the `stops` (d, n, MAX_STOPS) of the body and a clearance before what
    they meet. A length of infinity: they leave.
    """
    n = len(stands)
    mine = np.zeros(n, dtype=np.bool_)
    reach, closest = np.empty(MAX_STOPS + n), np.empty(n)
    begin = 0
    while begin < count and along[begin] < i0 // n:
        begin += 1
    for i in range(i0, i1):
        k, b = i // n, i % n
        if b == 0:
            begin = count
        if stands[b] or not there[b]:
            continue
        mine[:] = False
        mine[b] = True
        if add_pushed(distance[k], mine, np.inf, stands):
            count = _append(who, along, length, count, begin, mine, k, np.inf)
            continue
        many = 0
        if units[k] > 0:
            while many < len(reach) and (many + 1) * units[k] < horizon:
                reach[many] = (many + 1) * units[k]
                many += 1
        else:
            for s in range(stop_count[k, b]):
                reach[many] = stops[k, b, s]
                many += 1
            mine[:] = False
            closest[:] = np.inf
            joins = b
            while True:  # a clearance before each body that would join
                mine[joins] = True
                for c in range(n):
                    closest[c] = min(closest[c], distance[k, joins, c])
                nearest, joins = np.inf, -1
                for c in range(n):
                    if not mine[c] and closest[c] < nearest:
                        nearest, joins = closest[c], c
                if nearest > 2.0 * clearance and many < len(reach):
                    reach[many] = nearest - clearance
                    many += 1
                if joins < 0 or stands[joins]:
                    break
            reach[:many].sort()
        for s in range(many):
            if s and reach[s] - reach[s - 1] < 0.25 * clearance:
                continue
            mine[:] = False
            mine[b] = True
            if not add_pushed(distance[k], mine, reach[s] + 0.1 * clearance, stands):
                break
            count = _append(who, along, length, count, begin, mine, k, reach[s])
            if count == len(along):
                return count
    return count


@njit(**COMPILED_CALLERS_ONLY)
def _append(who, along, length, count, begin, mine, k, reach):
    for m in range(begin, count):
        same = length[m] == reach
        for b in range(len(mine)):
            same = same and who[m, b] == mine[b]
        if same:
            return count
    if count < len(along):
        for b in range(len(mine)):
            who[count, b] = mine[b]
        along[count], length[count] = k, reach
        count += 1
    return count


@njit(**OPTIONS)
def alignments(
    i0, i1, corner, after, first, shape, pose, stands, there, directions, units, clearance, distance, stops, stop_count
):
    """Fill `stops` (d, n, MAX_STOPS) where an edge of a body comes to lie in line with one of another body, as they would without a gap.

    Those of i0 to i1 are filled, where i = k n + b stands for body b along direction k.
    """
    n = len(shape)
    most = 0
    for b in range(n):
        most += first[shape[b] + 1] - first[shape[b]] + 2
    level, level_first = np.empty(most), np.zeros(n + 1, dtype=np.int64)
    for k in range(i0 // n, (i1 - 1) // n + 1):
        low, high = max(i0 - k * n, 0), min(i1 - k * n, n)
        if units[k] > 0:
            stop_count[k, low:high] = 0
            continue
        at = 0
        for b in range(n):
            if there[b]:
                at = levels(corner, after, first, shape[b], pose[b], directions[k], clearance, level, at)
            level_first[b + 1] = at
        for b in range(low, high):
            stop_count[k, b] = 0
            if stands[b] or not there[b]:
                continue
            furthest = 0.0  # until something that stands is met
            for c in range(n):
                if stands[c]:
                    furthest = distance[k, b, c] if furthest == 0.0 else min(furthest, distance[k, b, c])
            for c in range(n):
                if c == b:
                    continue
                for i in range(level_first[b], level_first[b + 1]):
                    for j in range(level_first[c], level_first[c + 1]):
                        t = level[j] - level[i]
                        if t < 2.0 * clearance or t > furthest or stop_count[k, b] == MAX_STOPS:
                            continue
                        new = True
                        for s in range(stop_count[k, b]):
                            if abs(stops[k, b, s] - t) < 0.5 * clearance:
                                new = False
                                break
                        if new:
                            stops[k, b, stop_count[k, b]] = t
                            stop_count[k, b] += 1


@njit(**COMPILED_CALLERS_ONLY)
def levels(corner, after, first, s, pose, direction, clearance, level, at):
    """Note how far along a direction the edges across it lie, half a clearance further out, and both ends of the body."""
    u, v = direction[0], direction[1]
    c0, s0 = np.cos(pose[2]), np.sin(pose[2])
    c, d = c0 * u + s0 * v, s0 * u - c0 * v
    x0 = u * pose[0] + v * pose[1]
    begin, least, largest = at, np.inf, -np.inf
    for e in range(first[s], first[s + 1]):
        f = after[e]
        x = c * corner[e, 0] - d * corner[e, 1] + x0
        p = c * corner[f, 0] - d * corner[f, 1] + x0
        rise = d * (corner[f, 0] - corner[e, 0]) + c * (corner[f, 1] - corner[e, 1])
        least, largest = min(least, x), max(largest, x)
        if abs(p - x) > 1e-6 * abs(rise):
            continue
        at = _note(level, begin, at, x + (0.5 if rise > 0 else -0.5) * clearance, clearance)
    at = _note(level, begin, at, least - 0.5 * clearance, clearance)
    return _note(level, begin, at, largest + 0.5 * clearance, clearance)


@njit(**COMPILED_CALLERS_ONLY)
def _note(level, begin, at, x, clearance):
    for k in range(begin, at):
        if abs(level[k] - x) < 0.25 * clearance:
            return at
    level[at] = x
    return at + 1


@njit(**OPTIONS)
def all_levels(corner, after, first, shape, pose, there, direction, clearance, out):
    """Fill `out` with how far along a direction all edges across it lie, half a clearance further out; their number."""
    at = 0
    for b in range(len(shape)):
        if there[b]:
            at = levels(corner, after, first, shape[b], pose[b], direction, clearance, out, at)
    return at
