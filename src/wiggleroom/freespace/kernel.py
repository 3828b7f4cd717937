"""Compiled search for the walls of a cell.

A *line* is the line of one edge of A (kind 0) or of B (kind 1). A *wall* keeps one corner of the other part in front of a line. An edge
pair is *hidden* by a line over an angle interval when the walls on that line keep the other part's edge in front of the line by at least
as much as the owner's own edge reaches in front of it; then the two edges cannot cross. A cell is free of overlap over an interval as soon
as every edge pair is hidden there: its slices are convex, so nothing forbidden can begin inside without two edges crossing. How far a
corner stays in front is a sinusoid of the angle, so its least value over an interval is closed form: nothing is sampled.
"""

from __future__ import annotations

import numpy as np
from numba import njit

MOST_LINES = 400
MOST_WALLS = 800

OPTIONS = {"cache": True, "nogil": True, "error_model": "numpy"}
INNER = {**OPTIONS, "no_cpython_wrapper": True, "no_cfunc_wrapper": True, "_nrt": False}
"""For functions that only compiled code calls: without the wrappers they compile in half the time."""


@njit(**INNER)
def least_in_front(px, py, qx, qy, dx, dy):
    """Least n(psi) . d while the unit normal n turns counter-clockwise from p to q (less than half a turn)."""
    least = min(px * dx + py * dy, qx * dx + qy * dy)
    if py * dx - px * dy >= 0.0 and dy * qx - dx * qy >= 0.0 and (px + qx) * dx + (py + qy) * dy < 0.0:
        least = -np.sqrt(dx * dx + dy * dy)
    return least


@njit(**INNER)
def add_line(kind, edge, corner, after, normal, a0, a1, b0, b1, run, ra0, ra1, rb0, rb1, reach, run_reach):
    """How far each edge of the line's owner reaches in front of the line, by edge and by run."""
    if kind == 0:
        lo, hi, r0, r1 = a0, a1, ra0, ra1
    else:
        lo, hi, r0, r1 = b0, b1, rb0, rb1
    nx, ny = normal[edge, 0], normal[edge, 1]
    off = nx * corner[edge, 0] + ny * corner[edge, 1]
    for r in range(r0, r1):
        most = -np.inf
        for i in range(run[r], run[r + 1]):
            if i < lo or i >= hi:
                continue
            k = after[i]
            d = max(nx * corner[i, 0] + ny * corner[i, 1], nx * corner[k, 0] + ny * corner[k, 1]) - off
            if i == edge:
                d = 0.0
            reach[i - lo] = d
            most = max(most, d)
        run_reach[r - r0] = most


@njit(**INNER)
def set_front(kind, edge, walls, count, p, q, corner, after, normal, o0, o1, run, ro0, ro1, at, front, run_front):
    """How far each edge of the other part stays in front of a line over the angles [p, q], by edge and by run."""
    nx, ny = normal[edge, 0], normal[edge, 1]
    sign = -1.0 if kind == 0 else 1.0
    c, s = np.cos(p), sign * np.sin(p)
    px, py = c * nx - s * ny, s * nx + c * ny
    c, s = np.cos(q), sign * np.sin(q)
    qx, qy = c * nx - s * ny, s * nx + c * ny
    if kind == 0:  # the normal turns clockwise as B turns counter-clockwise
        px, py, qx, qy = qx, qy, px, py
    for w in range(o0, o1):
        most = -np.inf
        for k in range(count):
            v = walls[k]
            if v == w:
                most = max(most, 0.0)
            else:
                d = least_in_front(px, py, qx, qy, corner[w, 0] - corner[v, 0], corner[w, 1] - corner[v, 1])
                most = max(most, d)
        at[w - o0] = most
    for r in range(ro0, ro1):
        least = np.inf
        for j in range(run[r], run[r + 1]):
            d = min(at[j - o0], at[after[j] - o0])
            front[j - o0] = d
            least = min(least, d)
        run_front[r - ro0] = least


@njit(**INNER)
def cross_side(ax, ay, bx, by, px, py):
    """Positive where p is left of the line from a to b."""
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@njit(**INNER)
def point_segment2(px, py, ax, ay, bx, by):
    """Squared distance of a point and a segment."""
    ux, uy = bx - ax, by - ay
    t = ((px - ax) * ux + (py - ay) * uy) / (ux * ux + uy * uy)
    t = min(1.0, max(0.0, t))
    ex, ey = px - ax - t * ux, py - ay - t * uy
    return ex * ex + ey * ey


@njit(**INNER)
def segments2(ax, ay, bx, by, cx, cy, dx, dy):
    """Squared distance of two segments; 0 where they cross."""
    s1, s2 = cross_side(ax, ay, bx, by, cx, cy), cross_side(ax, ay, bx, by, dx, dy)
    s3, s4 = cross_side(cx, cy, dx, dy, ax, ay), cross_side(cx, cy, dx, dy, bx, by)
    if s1 * s2 < 0.0 and s3 * s4 < 0.0:
        return 0.0
    return min(
        min(point_segment2(cx, cy, ax, ay, bx, by), point_segment2(dx, dy, ax, ay, bx, by)),
        min(point_segment2(ax, ay, cx, cy, dx, dy), point_segment2(bx, by, cx, cy, dx, dy)),
    )


UNSEEN, SEEN, COVERED = 0, 1, 2


@njit(**INNER)
def first_look(x, y, psi, lines, kinds, run_disc, ra0, ra1, rb0, rb1, run_reach, run_front, state, bound, tiny):
    """Which pairs of runs some line covers wholly, and how near (x, y, psi) brings the others at least."""
    c, s = np.cos(psi), np.sin(psi)
    for rb in range(rb0, rb1):
        ux, uy, ur = run_disc[rb, 0], run_disc[rb, 1], run_disc[rb, 2]
        cx, cy = c * ux - s * uy + x, s * ux + c * uy + y
        for ra in range(ra0, ra1):
            i, j = ra - ra0, rb - rb0
            state[i, j] = UNSEEN
            for k in range(lines):
                if (
                    (run_reach[k, i] <= run_front[k, j] + tiny)
                    if kinds[k] == 0
                    else (run_reach[k, j] <= run_front[k, i] + tiny)
                ):
                    state[i, j] = COVERED
                    break
            bound[i, j] = max(0.0, np.hypot(cx - run_disc[ra, 0], cy - run_disc[ra, 1]) - ur - run_disc[ra, 2])


@njit(**INNER)
def nearest_open(
    x, y, lines, kinds, corner, after, a0, b0, run, ra0, ra1, rb0, rb1, reach, front, placed,
    state, bound, open_pairs, open_far, count, tiny,
):  # fmt: skip
    """Place in the list of the nearest edge pair that no line hides, or -1; runs are opened in the order of their distance."""
    best, where = np.inf, -1
    for n in range(count[0]):
        if open_far[n] < best:
            best, where = open_far[n], n
    while True:
        near, ra, rb = np.sqrt(best), -1, -1
        for i in range(ra1 - ra0):
            for j in range(rb1 - rb0):
                if state[i, j] == UNSEEN and bound[i, j] < near:
                    near, ra, rb = bound[i, j], i, j
        if ra < 0:
            return where
        state[ra, rb] = SEEN
        for i in range(run[ra0 + ra], run[ra0 + ra + 1]):
            i2 = after[i]
            for j in range(run[rb0 + rb], run[rb0 + rb + 1]):
                hidden = False
                for k in range(lines):
                    own, other = (i - a0, j - b0) if kinds[k] == 0 else (j - b0, i - a0)
                    hidden = reach[k, own] <= front[k, other] + tiny
                    if hidden:
                        break
                if hidden:
                    continue
                j2, n = after[j], count[0]
                open_pairs[n, 0], open_pairs[n, 1] = i, j
                open_far[n] = segments2(
                    corner[i, 0], corner[i, 1], corner[i2, 0], corner[i2, 1],
                    placed[j - b0, 0] + x, placed[j - b0, 1] + y, placed[j2 - b0, 0] + x, placed[j2 - b0, 1] + y,
                )  # fmt: skip
                count[0] += 1
                if open_far[n] < best:
                    best, where = open_far[n], n


@njit(**INNER)
def cover_by(k, kind, a0, b0, reach, run_reach, front, run_front, state, na, nb, open_pairs, open_far, count, tiny):
    """Strike what line k hides from the runs and from the list of open edge pairs."""
    for i in range(na):
        for j in range(nb):
            if (
                (run_reach[k, i] <= run_front[k, j] + tiny)
                if kind == 0
                else (run_reach[k, j] <= run_front[k, i] + tiny)
            ):
                state[i, j] = COVERED
    kept = 0
    for n in range(count[0]):
        i, j = open_pairs[n, 0], open_pairs[n, 1]
        if (reach[k, i - a0] > front[k, j - b0] + tiny) if kind == 0 else (reach[k, j - b0] > front[k, i - a0] + tiny):
            open_pairs[kept, 0], open_pairs[kept, 1], open_far[kept] = i, j, open_far[n]
            kept += 1
    count[0] = kept


@njit(**INNER)
def in_front(kind, edge, v, x, y, psi, corner, normal):
    """Wall value h: how far corner v is in front of the line of `edge` at relative pose (x, y, psi)."""
    c, s = np.cos(psi), np.sin(psi)
    nx, ny = normal[edge, 0], normal[edge, 1]
    if kind == 0:
        px, py = c * corner[v, 0] - s * corner[v, 1] + x, s * corner[v, 0] + c * corner[v, 1] + y
    else:
        ux, uy = corner[v, 0] - x, corner[v, 1] - y
        px, py = c * ux + s * uy, -s * ux + c * uy
    return nx * (px - corner[edge, 0]) + ny * (py - corner[edge, 1])


@njit(**INNER)
def clip(poly, n, nx, ny, off, out):
    """Part of a convex polygon where n . p >= off."""
    m = 0
    for k in range(n):
        ax, ay = poly[k, 0], poly[k, 1]
        nxt = k + 1 if k + 1 < n else 0
        bx, by = poly[nxt, 0], poly[nxt, 1]
        da, db = nx * ax + ny * ay - off, nx * bx + ny * by - off
        if da >= 0.0:
            out[m, 0], out[m, 1] = ax, ay
            m += 1
        if (da > 0.0 and db < 0.0) or (da < 0.0 and db > 0.0):
            t = da / (da - db)
            out[m, 0], out[m, 1] = ax + t * (bx - ax), ay + t * (by - ay)
            m += 1
    return m


@njit(**INNER)
def slice_middle(psi, mx, my, half, lines, kinds, edges, walls, counts, corner, normal, poly, spare, result):
    """Slice of the cell at psi within a square round (mx, my): result = centroid, area, 1 where it meets the square's rim."""
    poly[0, 0], poly[0, 1] = mx - half, my - half
    poly[1, 0], poly[1, 1] = mx + half, my - half
    poly[2, 0], poly[2, 1] = mx + half, my + half
    poly[3, 0], poly[3, 1] = mx - half, my + half
    n = 4
    c, s = np.cos(psi), np.sin(psi)
    for k in range(lines):
        e = edges[k]
        nx, ny = normal[e, 0], normal[e, 1]
        off = nx * corner[e, 0] + ny * corner[e, 1]
        least = np.inf
        for w in range(counts[k]):
            v = walls[k, w]
            vx, vy = corner[v, 0], corner[v, 1]
            if kinds[k] == 0:
                least = min(least, nx * (c * vx - s * vy) + ny * (s * vx + c * vy))
            else:
                least = min(least, (c * nx - s * ny) * vx + (s * nx + c * ny) * vy)
        if kinds[k] == 0:
            n = clip(poly, n, nx, ny, off - least, spare)
        else:
            n = clip(poly, n, -(c * nx - s * ny), -(s * nx + c * ny), off - least, spare)
        if n < 3:
            result[2] = 0.0
            return 0
        poly, spare = spare, poly
    x0, y0 = poly[0, 0], poly[0, 1]
    area, cx, cy, rim = 0.0, 0.0, 0.0, 0.0
    for k in range(n):
        nxt = k + 1 if k + 1 < n else 0
        ux, uy, vx, vy = poly[k, 0] - x0, poly[k, 1] - y0, poly[nxt, 0] - x0, poly[nxt, 1] - y0
        cr = ux * vy - uy * vx
        area += cr
        cx += cr * (ux + vx)
        cy += cr * (uy + vy)
        if max(abs(poly[k, 0] - mx), abs(poly[k, 1] - my)) > half * 0.999999:
            rim = 1.0
    if area <= 0.0:
        result[2] = 0.0
        return 0
    result[0], result[1] = x0 + cx / (3.0 * area), y0 + cy / (3.0 * area)
    result[2], result[3] = area / 2.0, rim
    return n
