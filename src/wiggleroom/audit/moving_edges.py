"""Edges of two parts that move: whether any of them cross between waypoints.

Two segments do not cross where both ends of one lie on the same side of the line through the other, or both beyond the
same end of it. Seen from a part that turns by a while the other turns past it by b and is carried from D by D', a
corner at distance r from the other's reference point accelerates by at most r b^2 + |D| a^2 + 2 |a| |D'| on a straight
piece that is run in unit time. A distance that is g at one end of the piece and h at the other is therefore positive
all along it if (sqrt g + sqrt h)^2 is more than half that bound. Where this shows nothing the piece is halved.
"""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import COMPILED_CALLERS_ONLY, OPTIONS, njit

MAX_HALVINGS = 40
"""Halves of a piece that wait to be looked at, at most."""
MAX_PIECES = 20_000
"""A straight piece of one pair is halved into at most this many pieces."""
MAX_STRIDE_SHARE = 0.15
"""Edges that may meet are looked for anew where parts have moved by this share of the smaller one's radius."""
MAX_STRIDES = 4096
"""A piece is cut into at most this many strides."""
SEPARATIONS = 8
"""Ways in which two edges are apart: either lies outside, inside, beyond the end or before the begin of the other."""
COS, SIN, X, Y, BACK_X, BACK_Y = 0, 1, 2, 3, 4, 5
"""A relative pose: turn of B seen from A, place of B in A's frame, place of A in B's frame."""
CROWDED_STRIDES = 64
"""A piece on which too many edges are near each other is cut into this many strides."""


@njit(**COMPILED_CALLERS_ONLY)
def relative(a, b, out):
    """Relative pose of B from the poses (x, y, angle) of both."""
    out[COS], out[SIN] = np.cos(b[2] - a[2]), np.sin(b[2] - a[2])
    dx, dy = b[0] - a[0], b[1] - a[1]
    c, s = np.cos(a[2]), np.sin(a[2])
    out[X], out[Y] = c * dx + s * dy, -s * dx + c * dy
    out[BACK_X] = -out[COS] * out[X] - out[SIN] * out[Y]
    out[BACK_Y] = out[SIN] * out[X] - out[COS] * out[Y]


@njit(**COMPILED_CALLERS_ONLY)
def accelerations(a0, a1, b0, b1, reach_a, reach_b, out):
    """Bounds of the acceleration of B's corners seen from A, and of A's seen from B, on a piece run in unit time."""
    turn_a, turn_b = a1[2] - a0[2], b1[2] - b0[2]
    past = (turn_b - turn_a) ** 2
    apart = max(np.hypot(b0[0] - a0[0], b0[1] - a0[1]), np.hypot(b1[0] - a1[0], b1[1] - a1[1]))
    carry = np.hypot(b1[0] - a1[0] - b0[0] + a0[0], b1[1] - a1[1] - b0[1] + a0[1])
    out[0] = reach_b * past + apart * turn_a * turn_a + 2.0 * abs(turn_a) * carry
    out[1] = reach_a * past + apart * turn_b * turn_b + 2.0 * abs(turn_b) * carry


@njit(**COMPILED_CALLERS_ONLY)
def beyond(kind, edge, v, c, s, x, y, corner, direction, length):
    """How far corner v lies outside (0) or inside (1) the line of an edge, or beyond its end (2) or its begin (3)."""
    px = c * corner[v, 0] - s * corner[v, 1] + x - corner[edge, 0]
    py = s * corner[v, 0] + c * corner[v, 1] + y - corner[edge, 1]
    if kind < 2:
        out = direction[edge, 1] * px - direction[edge, 0] * py
        return out if kind == 0 else -out
    along = direction[edge, 0] * px + direction[edge, 1] * py
    return along - length[edge] if kind == 2 else -along


@njit(**COMPILED_CALLERS_ONLY)
def positive(g, h, sag):
    """True where a value that is g and h at the ends of a piece, with half its second derivative at most `sag`, is positive."""
    if g <= 0.0 or h <= 0.0:
        return False
    return g + h >= sag or g + h + 2.0 * np.sqrt(g * h) >= sag


@njit(**COMPILED_CALLERS_ONLY)
def separation_holds(how, e, f, p, q, sag_b, sag_a, least_b, least_a, corner, after, direction, length):
    """True where separation `how` of edges e of A and f of B holds between relative poses p and q with more than `least` to spare."""
    if how < 4:
        edge, v, sag, least, sign = e, f, sag_b, least_b, 1.0
        px, py, qx, qy = p[X], p[Y], q[X], q[Y]
    else:
        edge, v, sag, least, sign = f, e, sag_a, least_a, -1.0
        px, py, qx, qy = p[BACK_X], p[BACK_Y], q[BACK_X], q[BACK_Y]
    kind = how % 4
    for _ in range(2):
        g = beyond(kind, edge, v, p[COS], sign * p[SIN], px, py, corner, direction, length) - least
        if g <= 0.0:
            return False
        h = beyond(kind, edge, v, q[COS], sign * q[SIN], qx, qy, corner, direction, length) - least
        if not positive(g, h, sag):
            return False
        v = after[v]
    return True


@njit(**COMPILED_CALLERS_ONLY)
def find_separation(e, f, p, q, sag_b, sag_a, least_b, least_a, first, corner, after, direction, length):
    """A separation of two edges that holds all along a piece, the one tried first if it does; -1 where none is known to."""
    if separation_holds(first, e, f, p, q, sag_b, sag_a, least_b, least_a, corner, after, direction, length):
        return first
    for how in range(SEPARATIONS):
        if how != first and separation_holds(
            how, e, f, p, q, sag_b, sag_a, least_b, least_a, corner, after, direction, length
        ):
            return how
    return -1


@njit(**COMPILED_CALLERS_ONLY)
def clear_of(edge, f, c, s, x, y, least, corner, after, direction, length):
    """True where edge f of the other part, turned and moved, lies outside, inside, beyond the end or before the begin of an edge."""
    v, w = f, after[f]
    px = c * corner[v, 0] - s * corner[v, 1] + x - corner[edge, 0]
    py = s * corner[v, 0] + c * corner[v, 1] + y - corner[edge, 1]
    qx = c * corner[w, 0] - s * corner[w, 1] + x - corner[edge, 0]
    qy = s * corner[w, 0] + c * corner[w, 1] + y - corner[edge, 1]
    dx, dy = direction[edge, 0], direction[edge, 1]
    one, other = dy * px - dx * py, dy * qx - dx * qy
    if (one > least and other > least) or (one < -least and other < -least):
        return True
    one, other = dx * px + dy * py, dx * qx + dy * qy
    if one < -least and other < -least:
        return True
    return one - length[edge] > least and other - length[edge] > least


@njit(**COMPILED_CALLERS_ONLY)
def apart(e, f, p, least_b, least_a, corner, after, direction, length):
    """True where edges e of A and f of B lie apart at a relative pose with more than `least` to spare."""
    return clear_of(e, f, p[COS], p[SIN], p[X], p[Y], least_b, corner, after, direction, length) or clear_of(
        f, e, p[COS], -p[SIN], p[BACK_X], p[BACK_Y], least_a, corner, after, direction, length
    )


@njit(**OPTIONS)
def near_edges(
    a, b, p, stray_b, stray_a, rounding, corner, after, direction, length, run, first_run, run_disc, edges, how
):  # fmt: skip
    """Note the pairs of edges of parts a and b that may cross within `stray` [mm] of relative pose p; -1 where they are too many."""
    count = 0
    c, s = p[COS], p[SIN]
    for j in range(first_run[b], first_run[b + 1]):
        x = c * run_disc[j, 0] - s * run_disc[j, 1] + p[X]
        y = s * run_disc[j, 0] + c * run_disc[j, 1] + p[Y]
        for i in range(first_run[a], first_run[a + 1]):
            within = run_disc[i, 2] + run_disc[j, 2] + stray_b + rounding
            dx, dy = x - run_disc[i, 0], y - run_disc[i, 1]
            if dx * dx + dy * dy > within * within:
                continue
            for f in range(run[j], run[j + 1]):
                half = length[f] / 2  # discs over the edges tell most of them apart
                u, v = corner[f, 0] + half * direction[f, 0], corner[f, 1] + half * direction[f, 1]
                u, v = c * u - s * v + p[X], s * u + c * v + p[Y]
                half += stray_b + rounding
                dx, dy, within = u - run_disc[i, 0], v - run_disc[i, 1], half + run_disc[i, 2]
                if dx * dx + dy * dy > within * within:
                    continue
                for e in range(run[i], run[i + 1]):
                    own = length[e] / 2
                    dx, dy = u - corner[e, 0] - own * direction[e, 0], v - corner[e, 1] - own * direction[e, 1]
                    if dx * dx + dy * dy > (half + own) * (half + own):
                        continue
                    if apart(e, f, p, stray_b + rounding, stray_a + rounding, corner, after, direction, length):
                        continue
                    if count == len(how):
                        return -1
                    edges[count, 0], edges[count, 1], how[count] = e, f, 0
                    count += 1
    return count


@njit(**OPTIONS)
def free_piece(
    a0, a1, b0, b1, p0, p1, bound, edges, how, count, rounding, corner, after, direction, length, times, left, poses
):  # fmt: skip
    """True where none of the noted pairs of edges cross on a straight piece; halves it where needed."""
    times[0, 0], times[0, 1], left[0] = 0.0, 1.0, count
    poses[0, 0], poses[0, 1] = p0, p1
    size, pieces = 1, 0
    a, b, p = np.empty(3), np.empty(3), np.empty(6)
    while size:
        size -= 1
        t0, t1, many = times[size, 0], times[size, 1], left[size]
        p0, p1 = poses[size, 0], poses[size, 1]
        half = (t1 - t0) ** 2 / 2
        sag_b, sag_a = bound[0] * half, bound[1] * half
        doubt = 0
        for k in range(many):
            e, f = edges[k, 0], edges[k, 1]
            found = find_separation(
                e, f, p0, p1, sag_b, sag_a, rounding, rounding, how[k], corner, after, direction, length
            )  # fmt: skip
            if found >= 0:
                how[k] = found
                continue
            old = how[k]
            edges[k, 0], edges[k, 1], how[k] = edges[doubt, 0], edges[doubt, 1], how[doubt]
            edges[doubt, 0], edges[doubt, 1], how[doubt] = e, f, old
            doubt += 1
        if doubt == 0:
            continue
        pieces += 1
        if size + 2 > MAX_HALVINGS or pieces > MAX_PIECES:
            return False
        t = (t0 + t1) / 2
        for axis in range(3):
            a[axis] = a0[axis] + t * (a1[axis] - a0[axis])
            b[axis] = b0[axis] + t * (b1[axis] - b0[axis])
        relative(a, b, p)
        for k in range(doubt):  # edges that cross here need no further halving
            if not apart(edges[k, 0], edges[k, 1], p, rounding, rounding, corner, after, direction, length):
                return False
        poses[size + 1, 0], poses[size + 1, 1] = p0, p
        poses[size, 0] = p
        times[size, 0], times[size, 1], left[size] = t, t1, doubt
        times[size + 1, 0], times[size + 1, 1], left[size + 1] = t0, t, doubt
        size += 2
    return True


@njit(**OPTIONS)
def free_long_piece(
    a, b, a0, a1, b0, b1, strides, bound, reach_a, reach_b, rounding, corner, after, direction, length, run, first_run,
    run_disc, edges, how, times, left, poses,
):  # fmt: skip
    """The same for a piece on which the parts move far: it is cut evenly, and edges that may meet are found anew on each part of it."""
    ends = np.empty((2, 2, 3))
    middle = np.empty((2, 3))
    at = np.empty((3, 6))
    share = bound / strides**2
    for k in range(strides):
        for axis in range(3):
            for side in range(2):
                t = (k + side) / strides
                ends[0, side, axis] = a0[axis] + t * (a1[axis] - a0[axis])
                ends[1, side, axis] = b0[axis] + t * (b1[axis] - b0[axis])
            middle[0, axis] = (ends[0, 0, axis] + ends[0, 1, axis]) / 2
            middle[1, axis] = (ends[1, 0, axis] + ends[1, 1, axis]) / 2
        relative(ends[0, 0], ends[1, 0], at[0])
        relative(ends[0, 1], ends[1, 1], at[1])
        relative(middle[0], middle[1], at[2])
        turn = abs(ends[1, 1, 2] - ends[0, 1, 2] - ends[1, 0, 2] + ends[0, 0, 2]) / 2
        stray_b, stray_a = 0.0, 0.0
        for side in range(2):
            stray_b = max(stray_b, np.hypot(at[side, X] - at[2, X], at[side, Y] - at[2, Y]))
            stray_a = max(stray_a, np.hypot(at[side, BACK_X] - at[2, BACK_X], at[side, BACK_Y] - at[2, BACK_Y]))
        stray_b += reach_b * turn + share[0] / 8
        stray_a += reach_a * turn + share[1] / 8
        count = near_edges(
            a,
            b,
            at[2],
            stray_b,
            stray_a,
            rounding,
            corner,
            after,
            direction,
            length,
            run,
            first_run,
            run_disc,
            edges,
            how,
        )
        if count < 0:
            return False
        if count and not free_piece(
            ends[0, 0], ends[0, 1], ends[1, 0], ends[1, 1], at[0], at[1], share, edges, how, count, rounding, corner, after,
            direction, length, times, left, poses,
        ):  # fmt: skip
            return False
    return True


@njit(**OPTIONS)
def mark_doubtful_pieces(
    pair_a, pair_b, pose, shape, rounding, corner, after, direction, length, run, first_run, run_disc, disc, reach, room,
    doubtful, first_doubt,
):  # fmt: skip
    """Look at some pairs of parts along all pieces between the poses (n, k, 3) of all parts, whose shapes are known by number.

    Pieces on which some pair may overlap are marked in `doubtful` (k - 1,), the first one of every pair in `first_doubt`.
    """
    last = pose.shape[1] - 1
    at = np.empty((last + 1, 6))
    bound = np.empty((last, 2))
    ranges = np.empty((128, 2), dtype=np.int64)
    edges = np.empty((room, 2), dtype=np.int64)
    how = np.empty(room, dtype=np.int64)
    times = np.empty((MAX_HALVINGS + 2, 2))
    left = np.empty(MAX_HALVINGS + 2, dtype=np.int64)
    poses = np.empty((MAX_HALVINGS + 2, 2, 6))
    for pair in range(len(pair_a)):
        pose_a, pose_b = pose[pair_a[pair]], pose[pair_b[pair]]
        a, b = shape[pair_a[pair]], shape[pair_b[pair]]
        for k in range(last + 1):
            relative(pose_a[k], pose_b[k], at[k])
        for k in range(last):
            accelerations(pose_a[k], pose_a[k + 1], pose_b[k], pose_b[k + 1], reach[a], reach[b], bound[k])
        stride = MAX_STRIDE_SHARE * min(disc[a, 2], disc[b, 2])
        ranges[0, 0], ranges[0, 1] = 0, last
        size = 1
        while size:
            size -= 1
            k0, k1 = ranges[size, 0], ranges[size, 1]
            m = (k0 + k1) // 2
            stray_b, stray_a, most_b, most_a = 0.0, 0.0, 0.0, 0.0
            turn = pose_b[m, 2] - pose_a[m, 2]
            for k in range(k0, k1 + 1):
                turned = abs(pose_b[k, 2] - pose_a[k, 2] - turn)
                stray_b = max(stray_b, np.hypot(at[k, X] - at[m, X], at[k, Y] - at[m, Y]) + reach[b] * turned)
                stray_a = max(
                    stray_a, np.hypot(at[k, BACK_X] - at[m, BACK_X], at[k, BACK_Y] - at[m, BACK_Y]) + reach[a] * turned
                )
            for k in range(k0, k1):
                most_b, most_a = max(most_b, bound[k, 0]), max(most_a, bound[k, 1])
            stray_b += most_b / 8
            stray_a += most_a / 8
            x = at[m, COS] * disc[b, 0] - at[m, SIN] * disc[b, 1] + at[m, X] - disc[a, 0]
            y = at[m, SIN] * disc[b, 0] + at[m, COS] * disc[b, 1] + at[m, Y] - disc[a, 1]
            if np.hypot(x, y) > disc[a, 2] + disc[b, 2] + stray_b + rounding:
                continue
            if k1 - k0 > 1 and stray_b > stride:
                ranges[size, 0], ranges[size, 1] = m, k1
                ranges[size + 1, 0], ranges[size + 1, 1] = k0, m
                size += 2
                continue
            if stray_b > 2 * stride:  # one piece only
                strides = min(MAX_STRIDES, int(np.ceil(stray_b / stride)))
                free = free_long_piece(
                    a, b, pose_a[k0], pose_a[k1], pose_b[k0], pose_b[k1], strides, bound[k0], reach[a], reach[b], rounding,
                    corner, after, direction, length, run, first_run, run_disc, edges, how, times, left, poses,
                )  # fmt: skip
                if not free:
                    doubtful[k0] = True
                    first_doubt[pair] = min(first_doubt[pair], k0)
                continue
            count = near_edges(
                a, b, at[m], stray_b, stray_a, rounding, corner, after, direction, length, run, first_run, run_disc, edges,
                how,
            )  # fmt: skip
            if count < 0 and k1 - k0 > 1:  # too many edges are near each other: on shorter stretches there are fewer
                ranges[size, 0], ranges[size, 1] = m, k1
                ranges[size + 1, 0], ranges[size + 1, 1] = k0, m
                size += 2
                continue
            if count < 0 and free_long_piece(
                a, b, pose_a[k0], pose_a[k1], pose_b[k0], pose_b[k1], CROWDED_STRIDES, bound[k0], reach[a], reach[b],
                rounding, corner, after, direction, length, run, first_run, run_disc, edges, how, times, left, poses,
            ):  # fmt: skip
                continue
            for k in range(k0, k1):
                if count < 0 or (count > 0 and not free_piece(
                    pose_a[k], pose_a[k + 1], pose_b[k], pose_b[k + 1], at[k], at[k + 1], bound[k], edges, how, count,
                    rounding, corner, after, direction, length, times, left, poses,
                )):  # fmt: skip
                    doubtful[k] = True
                    first_doubt[pair] = min(first_doubt[pair], k)


@njit(**OPTIONS)
def swept_boxes(pose, k0, k1, shape, first, corner, reach, out):
    """Boxes (n, 4) [mm] round what every part sweeps between waypoints k0 and k1 of its poses (n, k, 3)."""
    for p in range(len(out)):
        own = shape[p]
        low_x, low_y, high_x, high_y, aside = np.inf, np.inf, -np.inf, -np.inf, 0.0
        for k in range(k0, k1 + 1):
            if k > k0:
                turn = pose[p, k, 2] - pose[p, k - 1, 2]
                aside = max(aside, turn * turn / 8 * reach[own])
                if pose[p, k, 0] == pose[p, k - 1, 0] and pose[p, k, 1] == pose[p, k - 1, 1] and turn == 0.0:
                    continue
            c, s = np.cos(pose[p, k, 2]), np.sin(pose[p, k, 2])
            for v in range(first[own], first[own + 1]):
                x = c * corner[v, 0] - s * corner[v, 1] + pose[p, k, 0]
                y = s * corner[v, 0] + c * corner[v, 1] + pose[p, k, 1]
                low_x, high_x = min(low_x, x), max(high_x, x)
                low_y, high_y = min(low_y, y), max(high_y, y)
        out[p, 0], out[p, 1], out[p, 2], out[p, 3] = low_x - aside, low_y - aside, high_x + aside, high_y + aside
