"""Compiled growth of one cell round a seed: march the angle both ways and hide every edge pair on the way."""

from __future__ import annotations

import numpy as np
from numba import njit

from wiggleroom.freespace.kernel import (
    INNER,
    MOST_LINES,
    MOST_WALLS,
    OPTIONS,
    add_line,
    clip,
    cover_by,
    first_look,
    in_front,
    nearest_open,
    segments2,
    set_front,
    slice_middle,
)

MOST_ON_LINE = 48
CLOSED, OPEN, FAILED = 0, 1, 2


@njit(**INNER)
def keeps(kind, edge, v, keep, corner, after, normal, tiny, margin):
    """True where the wall leaves every point of `keep` inside, and by `margin` those where corner and edge do not touch."""
    for k in range(keep.shape[0]):
        x, y, psi = keep[k, 0], keep[k, 1], keep[k, 2]
        h = in_front(kind, edge, v, x, y, psi, corner, normal)
        if h < -tiny:
            return False
        if h < margin:
            c, s = np.cos(psi), np.sin(psi)
            if kind == 0:
                px, py = c * corner[v, 0] - s * corner[v, 1] + x, s * corner[v, 0] + c * corner[v, 1] + y
            else:
                ux, uy = corner[v, 0] - x, corner[v, 1] - y
                px, py = c * ux + s * uy, -s * ux + c * uy
            e = after[edge]
            ex, ey = corner[e, 0] - corner[edge, 0], corner[e, 1] - corner[edge, 1]
            along = ex * (px - corner[edge, 0]) + ey * (py - corner[edge, 1])
            if along < -tiny or along > ex * ex + ey * ey + tiny:
                return False
    return True


@njit(**INNER)
def parallel(i, j, p, q, corner, after):
    """Angle strictly inside (p, q) at which edge i of A and edge j of B are parallel, or nan."""
    ax, ay = corner[after[i], 0] - corner[i, 0], corner[after[i], 1] - corner[i, 1]
    bx, by = corner[after[j], 0] - corner[j, 0], corner[after[j], 1] - corner[j, 1]
    angle = np.arctan2(ay, ax) - np.arctan2(by, bx)
    angle -= np.pi * np.floor((angle - p) / np.pi)
    return angle if p + 1e-12 < angle < q - 1e-12 else np.nan


@njit(**INNER)
def line_between(i, j, x, y, psi, corner, after, normal, a0, a1, b0, b1, tiny):
    """The line that edge i of A is behind (or edge j of B) and the other edge furthest in front of: (kind, edge, distance)."""
    kind, edge, best = 0, i, -np.inf
    for side in range(2):
        lo, hi, own, other = (a0, a1, i, j) if side == 0 else (b0, b1, j, i)
        for k in range(lo, hi):
            nx, ny = normal[k, 0], normal[k, 1]
            off = nx * corner[k, 0] + ny * corner[k, 1]
            e = after[own]
            if max(nx * corner[own, 0] + ny * corner[own, 1], nx * corner[e, 0] + ny * corner[e, 1]) - off > tiny:
                continue
            front = min(
                in_front(side, k, other, x, y, psi, corner, normal),
                in_front(side, k, after[other], x, y, psi, corner, normal),
            )
            if front > best:
                kind, edge, best = side, k, front
    return kind, edge, best


@njit(**INNER)
def out_of_reach(
    i, j, x, y, psi, p, q, lines, kinds, edges, walls, counts, corner, after, normal, b0, b1, placed, poly, spare, tiny,
):  # fmt: skip
    """True where the walls keep every pose of [p, q] so near to (x, y, psi) that edges as far apart as i and j cannot meet.

    Turning by up to `turn` loosens a wall at distance r by at most 2 r sin(turn / 2), where r may itself grow with the way from (x, y). If
    the loosened walls, with ways up to `room`, bound a polygon smaller than `room`, then no slice over [p, q] reaches beyond it: the
    loosened walls are convex in position and room together, so a pose at a larger distance would put one at distance `room` as well.
    """
    j2, far = after[j], 0.0
    for k in range(b0, b1):
        far = max(far, np.hypot(corner[k, 0], corner[k, 1]))
    bend = 2.0 * np.sin(min(max(psi - p, q - psi), np.pi) / 2.0)
    apart = np.sqrt(segments2(
        corner[i, 0], corner[i, 1], corner[after[i], 0], corner[after[i], 1],
        placed[j - b0, 0] + x, placed[j - b0, 1] + y, placed[j2 - b0, 0] + x, placed[j2 - b0, 1] + y,
    ))  # fmt: skip
    room = 0.999 * (apart - bend * far)
    if room <= 0.0:
        return False
    for k in range(4):
        poly[k, 0] = x + (2.0 * room if k in (1, 2) else -2.0 * room)
        poly[k, 1] = y + (2.0 * room if k > 1 else -2.0 * room)
    n, c, s = 4, np.cos(psi), np.sin(psi)
    for k in range(lines):
        nx, ny = normal[edges[k], 0], normal[edges[k], 1]
        off = nx * corner[edges[k], 0] + ny * corner[edges[k], 1]
        for w in range(counts[k]):
            v = walls[k, w]
            vx, vy = corner[v, 0], corner[v, 1]
            if in_front(kinds[k], edges[k], v, x, y, psi, corner, normal) < -tiny:
                return False
            if kinds[k] == 0:
                least = off - nx * (c * vx - s * vy) - ny * (s * vx + c * vy) - bend * np.hypot(vx, vy)
                n = clip(poly, n, nx, ny, least, spare)
            else:
                mx, my = c * nx - s * ny, s * nx + c * ny
                least = off - mx * vx - my * vy - bend * (np.hypot(vx - x, vy - y) + room)
                n = clip(poly, n, -mx, -my, least, spare)
            poly, spare = spare, poly
    for k in range(n):
        if np.hypot(poly[k, 0] - x, poly[k, 1] - y) >= room:
            return False
    return n > 0


@njit(**INNER)
def hide_all(
    x, y, psi, p, q, state, kinds, edges, walls, counts, keep, bar, wish, corner, after, normal, a0, a1, b0, b1,
    run, run_disc, ra0, ra1, rb0, rb1, reach, run_reach, front, run_front, at, placed, poly, spare, seen, bound,
    open_pairs, open_far, count, tiny, margin, hint,
):  # fmt: skip
    """Add walls until every edge pair is hidden over [p, q] or out of reach, nearest first from (x, y, psi); False where not all are.

    `hint` then gets the angle inside (p, q) at which the two edges that stay open are parallel, nan where there is none: up to there and
    from there on different corners lead, and one wall may do where both would not.
    """
    hint[0] = np.nan
    fresh = 0  # lines from here on have no front yet
    c, s = np.cos(psi), np.sin(psi)
    for j in range(b0, b1):
        placed[j - b0, 0] = c * corner[j, 0] - s * corner[j, 1]
        placed[j - b0, 1] = s * corner[j, 0] + c * corner[j, 1]
    count[0] = 0
    last = 0.0
    looked, stuck = False, False
    while True:
        for k in range(fresh, state[0] if not looked else min(fresh + 1, state[0])):
            o0, o1, r0, r1 = (b0, b1, rb0, rb1) if kinds[k] == 0 else (a0, a1, ra0, ra1)
            set_front(
                kinds[k],
                edges[k],
                walls[k],
                counts[k],
                p,
                q,
                corner,
                after,
                normal,
                o0,
                o1,
                run,
                r0,
                r1,
                at,
                front[k],
                run_front[k],
            )
        if not looked:
            first_look(
                x, y, psi, state[0], kinds, run_disc, ra0, ra1, rb0, rb1, run_reach, run_front, seen, bound, tiny
            )
            looked = True
        elif not stuck:  # a line was added
            cover_by(
                fresh, kinds[fresh], a0, b0, reach, run_reach, front, run_front, seen, ra1 - ra0, rb1 - rb0,
                open_pairs, open_far, count, tiny,
            )  # fmt: skip
        where = nearest_open(
            x, y, state[0], kinds, corner, after, a0, b0, run, ra0, ra1, rb0, rb1,
            reach, front, placed, seen, bound, open_pairs, open_far, count, tiny,
        )  # fmt: skip
        i, j = (open_pairs[where, 0], open_pairs[where, 1]) if where >= 0 else (-1, -1)
        if i < 0:
            return True
        if (
            stuck or open_far[where] > 1.5 * last
        ):  # looked at again only when the nearest open pair is clearly further away
            last = open_far[where]
            if out_of_reach(
                i, j, x, y, psi, p, q, state[0], kinds, edges, walls, counts, corner, after, normal, b0, b1, placed, poly, spare, tiny,
            ):  # fmt: skip
                return True
            if stuck:
                return False
        sep_a = min(in_front(0, i, j, x, y, psi, corner, normal), in_front(0, i, after[j], x, y, psi, corner, normal))
        sep_b = min(in_front(1, j, i, x, y, psi, corner, normal), in_front(1, j, after[i], x, y, psi, corner, normal))
        first_a = sep_a >= sep_b  # the further line first
        if not np.isnan(wish[0]):  # or the one that leaves more room where the pair would like to be
            wx, wy, wp = wish[0], wish[1], wish[2]
            first_a = min(
                in_front(0, i, j, wx, wy, wp, corner, normal), in_front(0, i, after[j], wx, wy, wp, corner, normal)
            ) >= min(
                in_front(1, j, i, wx, wy, wp, corner, normal), in_front(1, j, after[i], wx, wy, wp, corner, normal)
            )
        if (bar[0] == 0 and bar[1] == i) or (bar[0] == 1 and bar[1] == j):
            first_a = bar[0] == 1  # unless it is the barred one
        done = False
        room = margin
        for attempt in range(
            12
        ):  # lines that leave room at the points to keep; then less room; at the seed's own angle none
            if attempt % 3 == 0 and attempt > 0:
                room *= 0.1
            if attempt == 9:
                if q > p:
                    break
                room = 0.0
            if (
                attempt % 3 == 2
            ):  # neither of their own lines: any line that one of them is wholly behind and the other in front of
                kind, edge, sep = line_between(i, j, x, y, psi, corner, after, normal, a0, a1, b0, b1, tiny)
                u = j if kind == 0 else i
                v = after[u]
            elif (attempt % 3 == 0) == first_a:
                kind, edge, u, v, sep = 0, i, j, after[j], sep_a
            else:
                kind, edge, u, v, sep = 1, j, i, after[i], sep_b
            if sep < -tiny:
                continue
            # the lower end of the other edge at both ends of the interval: one corner, or both where the edges pass through parallel
            turn = -1.0 if kind == 0 else 1.0
            dx, dy = corner[v, 0] - corner[u, 0], corner[v, 1] - corner[u, 1]
            nx, ny = normal[edge, 0], normal[edge, 1]
            cp, sp = np.cos(p), turn * np.sin(p)
            cq, sq = np.cos(q), turn * np.sin(q)
            at_p = (cp * nx - sp * ny) * dx + (sp * nx + cp * ny) * dy
            at_q = (cq * nx - sq * ny) * dx + (sq * nx + cq * ny) * dy
            need_u = at_p > -tiny or at_q > -tiny
            need_v = at_p < tiny or at_q < tiny
            if at_p >= -tiny and at_q >= -tiny:
                need_v = False
            elif at_p <= tiny and at_q <= tiny:
                need_u = False
            if need_u and not keeps(kind, edge, u, keep, corner, after, normal, tiny, room):
                continue
            if need_v and not keeps(kind, edge, v, keep, corner, after, normal, tiny, room):
                continue
            line = -1
            for k in range(state[0]):
                if kinds[k] == kind and edges[k] == edge:
                    line = k
            if line < 0:
                if state[0] == MOST_LINES:
                    return False
                line = state[0]
                state[0] += 1
                kinds[line], edges[line], counts[line] = kind, edge, 0
                add_line(
                    kind,
                    edge,
                    corner,
                    after,
                    normal,
                    a0,
                    a1,
                    b0,
                    b1,
                    run,
                    ra0,
                    ra1,
                    rb0,
                    rb1,
                    reach[line],
                    run_reach[line],
                )
            added = False
            for w in range(2):
                corner_w = u if w == 0 else v
                if not (need_u if w == 0 else need_v):
                    continue
                known = False
                for k in range(counts[line]):
                    known = known or walls[line, k] == corner_w
                if not known:
                    if counts[line] == MOST_ON_LINE:
                        return False
                    walls[line, counts[line]] = corner_w
                    counts[line] += 1
                    added = True
            if not added:
                return False
            fresh = line
            done = True
            break
        if not done:
            hint[0] = parallel(i, j, p, q, corner, after)
            stuck = True


@njit(**INNER)
def joined(x0, y0, p0, x1, y1, p1, lines, kinds, edges, walls, counts, corner, normal):
    """True where the straight way between two relative poses certainly stays inside all walls."""
    turn, move = p1 - p0, np.hypot(x1 - x0, y1 - y0)
    for k in range(lines):
        for w in range(counts[k]):
            v = walls[k, w]
            h0 = in_front(kinds[k], edges[k], v, x0, y0, p0, corner, normal)
            h1 = in_front(kinds[k], edges[k], v, x1, y1, p1, corner, normal)
            far = np.hypot(corner[v, 0], corner[v, 1])
            if kinds[k] == 1:
                far += max(np.hypot(x0, y0), np.hypot(x1, y1))
            bend = far * turn * turn + 2.0 * move * abs(turn)
            if min(h0, h1) < bend / 8.0:
                return False
    return True


@njit(**INNER)
def grow(
    seed, keep, bar, wish, half, step, least_step, span, shape_a, shape_b, corner, after, normal, first, run, run_first, run_disc,
    kinds, edges, walls, counts, reach, run_reach, front, run_front, at, placed, poly, spare, seen, bound,
    open_pairs, open_far, count, state, old_counts, hint, middle, there, status, tiny, ends,
):  # fmt: skip
    """Grow a cell round `seed` (x, y, psi). Returns (lines, status low end, status high end); `ends` gets the verified interval."""
    a0, a1, b0, b1 = first[shape_a], first[shape_a + 1], first[shape_b], first[shape_b + 1]
    ra0, ra1, rb0, rb1 = run_first[shape_a], run_first[shape_a + 1], run_first[shape_b], run_first[shape_b + 1]
    state[0] = 0
    margin = 0.005 * half
    x0, y0, psi0 = seed[0], seed[1], seed[2]
    ends[0], ends[1] = psi0, psi0
    status[0], status[1] = OPEN, OPEN
    for side in range(-1, 2):  # first the seed's own angle, then down, then up
        way = 1.0 if side == 1 else -1.0
        psi, x, y, d = psi0, x0, y0, step
        while side < 0 or abs(psi - psi0) < span:
            d = min(d, span - abs(psi - psi0) + 1e-15) if side >= 0 else 0.0
            lines_before = state[0]
            for k in range(lines_before):
                old_counts[k] = counts[k]
            end = psi + way * d
            p, q = min(psi, end), max(psi, end)
            n = slice_middle(
                end, x0, y0, half, state[0], kinds, edges, walls, counts, corner, normal, poly, spare, there
            )
            closing = n == 0 and side >= 0
            sx, sy, sp = (x, y, psi) if closing or side < 0 else (there[0], there[1], end)
            good = hide_all(
                sx, sy, sp, p, q, state, kinds, edges, walls, counts, keep, bar, wish, corner, after, normal, a0, a1, b0, b1,
                run, run_disc, ra0, ra1, rb0, rb1, reach, run_reach, front, run_front, at, placed,
                poly, spare, seen, bound, open_pairs, open_far, count, tiny, margin, hint,
            )  # fmt: skip
            if side < 0:
                if not good:
                    return 0, FAILED, FAILED
                break
            if good and closing:
                n = slice_middle(
                    psi, x0, y0, half, state[0], kinds, edges, walls, counts, corner, normal, poly, spare, middle
                )
                if n > 0 and middle[3] == 0.0:
                    psi, status[side] = end, CLOSED
                    break
                good = False
            if good:
                n = slice_middle(
                    psi, x0, y0, half, state[0], kinds, edges, walls, counts, corner, normal, poly, spare, middle
                )
                m = slice_middle(
                    end, x0, y0, half, state[0], kinds, edges, walls, counts, corner, normal, poly, spare, there
                )
                good = (
                    n > 0
                    and m > 0
                    and joined(
                        middle[0],
                        middle[1],
                        psi,
                        there[0],
                        there[1],
                        end,
                        state[0],
                        kinds,
                        edges,
                        walls,
                        counts,
                        corner,
                        normal,
                    )
                )
            if good:
                psi, x, y = end, there[0], there[1]
                d = min(2.0 * d, 0.5)
            else:
                for k in range(lines_before):
                    counts[k] = old_counts[k]
                state[0] = lines_before
                if not np.isnan(hint[0]):
                    d = abs(hint[0] - psi)
                    continue
                d *= 0.5
                if d < least_step:
                    break
        if side >= 0:
            ends[side] = psi
    return state[0], status[0], status[1]


@njit(**OPTIONS)
def grow_many(
    seeds, keeps_at, keep_first, bars, wishes, half, step, least_step, span, shape_a, shape_b,
    corner, after, normal, first, run, run_first, run_disc, tiny, out_kind, out_edge, out_corner, out_count, out_ends, out_status,
):  # fmt: skip
    """Grow one cell per seed; walls of cell c fill the first `out_count[c]` columns of row c, -1 where there was no room."""
    largest, runs = 0, 0
    for s in range(len(first) - 1):
        largest, runs = max(largest, first[s + 1] - first[s]), max(runs, run_first[s + 1] - run_first[s])
    kinds, edges, counts = (
        np.zeros(MOST_LINES, np.int64),
        np.zeros(MOST_LINES, np.int64),
        np.zeros(MOST_LINES, np.int64),
    )
    walls = np.zeros((MOST_LINES, MOST_ON_LINE), np.int64)
    reach, front = np.zeros((MOST_LINES, largest)), np.zeros((MOST_LINES, largest))
    run_reach, run_front = np.zeros((MOST_LINES, runs)), np.zeros((MOST_LINES, runs))
    at, placed = np.zeros(largest), np.zeros((largest, 2))
    poly, spare = np.zeros((2 * MOST_WALLS, 2)), np.zeros((2 * MOST_WALLS, 2))
    seen, bound = np.zeros((runs, runs), np.int64), np.zeros((runs, runs))
    open_pairs, open_far = np.zeros((largest * largest, 2), np.int64), np.zeros(largest * largest)
    count, state, status = np.zeros(1, np.int64), np.zeros(1, np.int64), np.zeros(2, np.int64)
    hint, middle, there, old_counts = np.zeros(1), np.zeros(4), np.zeros(4), np.zeros(MOST_LINES, np.int64)
    for c in range(seeds.shape[0]):
        lines, low, high = grow(
            seeds[c], keeps_at[keep_first[c] : keep_first[c + 1]], bars[c], wishes[c], half[c], step[c],
            least_step[c], span[c], shape_a[c], shape_b[c],
            corner, after, normal, first, run, run_first, run_disc,
            kinds, edges, walls, counts, reach, run_reach, front, run_front, at, placed, poly, spare, seen, bound,
            open_pairs, open_far, count, state, old_counts, hint, middle, there, status, tiny[c], out_ends[c],
        )  # fmt: skip
        out_status[c, 0], out_status[c, 1] = low, high
        n = 0
        for k in range(lines):
            for w in range(counts[k]):
                if n < out_kind.shape[1]:
                    out_kind[c, n], out_edge[c, n], out_corner[c, n] = kinds[k], edges[k], walls[k, w]
                n += 1
        out_count[c] = n
