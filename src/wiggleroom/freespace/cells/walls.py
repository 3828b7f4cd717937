"""Compiled use of walls: the slice they bound, what they keep, and how far they let one part go."""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import COMPILED_CALLERS_ONLY, njit
from wiggleroom.freespace.cells.pair_edges import corner_in_frame, posed, vector_length, wall_value
from wiggleroom.freespace.cells.separating_lines import LINES


@njit(**COMPILED_CALLERS_ONLY)
def clip_polygon(poly, n, nx, ny, off, out):
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


@njit(**COMPILED_CALLERS_ONLY)
def square(poly, x, y, half):
    """Fill the first four corners with a square round (x, y)."""
    for k in range(4):
        poly[k, 0] = x + half if k == 1 or k == 2 else x - half
        poly[k, 1] = y + half if k > 1 else y - half
    return 4


@njit(**COMPILED_CALLERS_ONLY)
def height(pair, edge, v, mx, my, pose):
    """How much corner v adds to its wall value; (mx, my) is the normal of the line of `edge` in A's frame."""
    x, y = pair.edges[v].x, pair.edges[v].y
    if edge < pair.na:
        x, y = pose.c * x - pose.s * y, pose.s * x + pose.c * y
    return mx * x + my * y


@njit(**COMPILED_CALLERS_ONLY)
def edge_normal(pair, edge, pose):
    """Normal of the line of `edge` in A's frame."""
    e = pair.edges[edge]
    if edge < pair.na:
        return e.nx, e.ny
    return pose.c * e.nx - pose.s * e.ny, pose.s * e.nx + pose.c * e.ny


@njit(**COMPILED_CALLERS_ONLY)
def slice_middle(pair, work, pose, half):
    """Slice of the cell at the pose's angle within a square round it: (number of corners, middle x, y, whether it meets the rim)."""
    poly, spare = work.polygons[0], work.polygons[1]
    n = square(poly, pose.x, pose.y, half)
    for k in range(work.number[LINES]):
        line = work.lines[k]
        mx, my = edge_normal(pair, line.edge, pose)
        least = np.inf
        for w in range(line.count):
            least = min(least, height(pair, line.edge, line.walls[w], mx, my, pose))
        if line.edge >= pair.na:
            mx, my = -mx, -my
        n = clip_polygon(poly, n, mx, my, pair.edges[line.edge].off - least, spare)
        if n < 3:
            return 0, 0.0, 0.0, False
        poly, spare = spare, poly
    x0, y0 = poly[0, 0], poly[0, 1]
    area, cx, cy, rim = 0.0, 0.0, 0.0, False
    ux, uy = 0.0, 0.0
    for k in range(n):
        px, py = poly[(k + 1) % n, 0], poly[(k + 1) % n, 1]
        vx, vy = px - x0, py - y0
        cross = ux * vy - uy * vx
        area += cross
        cx += cross * (ux + vx)
        cy += cross * (uy + vy)
        ux, uy = vx, vy
        if max(abs(px - pose.x), abs(py - pose.y)) > half * 0.999999:
            rim = True
    if area <= 0.0:
        return 0, 0.0, 0.0, False
    return n, x0 + cx / (3.0 * area), y0 + cy / (3.0 * area), rim


@njit(**COMPILED_CALLERS_ONLY)
def wall_contains(pair, edge, v, keep, tiny, margin):
    """True where the wall leaves every point of `keep` inside, and by `margin` those where corner and edge do not touch."""
    e = pair.edges[edge]
    for k in range(len(keep)):
        x, y = corner_in_frame(pair, edge, v, posed(keep[k, 0], keep[k, 1], keep[k, 2]))
        x, y = x - e.x, y - e.y
        h = e.nx * x + e.ny * y
        if h < -tiny:
            return False
        if h < margin:
            end = pair.edges[e.after]
            ex, ey = end.x - e.x, end.y - e.y
            along = ex * x + ey * y
            if along < -tiny or along > ex * ex + ey * ey + tiny:
                return False
    return True


@njit(**COMPILED_CALLERS_ONLY)
def segment_inside(pair, work, one, other):
    """True where the straight path between two relative poses certainly stays inside all walls."""
    turn, move = other.psi - one.psi, vector_length(other.x - one.x, other.y - one.y)
    away = max(vector_length(one.x, one.y), vector_length(other.x, other.y))
    for k in range(work.number[LINES]):
        line = work.lines[k]
        for w in range(line.count):
            v = line.walls[w]
            far = vector_length(pair.edges[v].x, pair.edges[v].y)
            if line.edge >= pair.na:
                far += away
            bend = far * turn * turn + 2.0 * move * abs(turn)
            if min(wall_value(pair, line.edge, v, one), wall_value(pair, line.edge, v, other)) < bend / 8.0:
                return False
    return True


@njit(**COMPILED_CALLERS_ONLY)
def out_of_reach(pair, work, pose, p, q, apart, tiny):
    """True where the walls keep every pose of [p, q] so near to `pose` that edges `apart` from each other cannot meet.

    Turning by up to `turn` loosens a wall at distance r by at most 2 r sin(turn / 2), where r may itself grow by the distance moved. If
    the loosened walls, with distances up to `room`, bound a polygon smaller than `room`, then no slice over [p, q] reaches beyond it: the
    loosened walls are convex in position and room together, so a pose at a larger distance would put one at distance `room` as well.
    """
    far = 0.0
    for k in range(pair.na, pair.n):
        far = max(far, vector_length(pair.edges[k].x, pair.edges[k].y))
    bend = 2.0 * np.sin(min(max(pose.psi - p, q - pose.psi), np.pi) / 2.0)
    room = 0.999 * (apart - bend * far)
    if room <= 0.0:
        return False
    poly, spare = work.polygons[0], work.polygons[1]
    n = square(poly, pose.x, pose.y, 2.0 * room)
    for k in range(work.number[LINES]):
        line = work.lines[k]
        mx, my = edge_normal(pair, line.edge, pose)
        sign, x, y, reach = 1.0, 0.0, 0.0, 0.0
        if line.edge >= pair.na:
            sign, x, y, reach = -1.0, pose.x, pose.y, room
        for w in range(line.count):
            v = line.walls[w]
            if wall_value(pair, line.edge, v, pose) < -tiny:
                return False
            least = pair.edges[line.edge].off - height(pair, line.edge, v, mx, my, pose)
            least -= bend * (vector_length(pair.edges[v].x - x, pair.edges[v].y - y) + reach)
            n = clip_polygon(poly, n, sign * mx, sign * my, least, spare)
            poly, spare = spare, poly
    for k in range(n):
        if vector_length(poly[k, 0] - pose.x, poly[k, 1] - pose.y) >= room:
            return False
    return n > 0
