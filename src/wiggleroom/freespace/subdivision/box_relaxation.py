"""Linear relaxation of the free motions of a box: how much they are worth at most, by the contacts that hold everywhere in the box.

A corner of one body stays, over a whole box of motions, in a disc as the other body sees it. Where all edges of the other that meet this
disc lie in front of each other's lines, its material fills what is behind these lines there: the corner must stay in front of all of
them. Linearised, with its curvature taken off, each is a row of a linear program in three unknowns, solved by the dual simplex method,
whose every step is a bound. Unlike judging the box as a whole, whose error is of first order in its size, this one is of second order:
a flush contact needs few boxes.
"""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import COMPILED_CALLERS_ONLY, njit

MAX_ROWS = 60
"""Rows of a program at most; more corners than that are left out."""
MAX_EDGES = 6
"""Edges that a corner may meet at most; where it may meet more, it gives no rows."""
MIN_CHORD = 0.1
"""A chain of edges whose ends on a disc are nearer than this share of its radius gives no row: what lies behind it is not known."""
MAX_PIVOTS = 40
"""Steps of the simplex method; every one of them is a bound, so it may end at any."""
TOLERANCE = 1e-9
"""Share of a row that counts as nothing."""
SUM_ROUNDING = 1e-14
"""Sums of a few products are as exact as this share of their terms."""
SURE_VIOLATION = 1e-7
"""Rows contradict each other only where their sum fails by more than this share."""


@njit(**COMPILED_CALLERS_ONLY)
def offset_from_edge(x, y, edge, e):
    """Vector to a point from the nearest point of an edge, and where that is, 0 at the start of the edge and 1 at its end."""
    ax, ay = edge[e, 0], edge[e, 1]
    ex, ey = edge[e, 2] - ax, edge[e, 3] - ay
    t = ((x - ax) * ex + (y - ay) * ey) / (ex * ex + ey * ey)
    t = min(max(t, 0.0), 1.0)
    return x - ax - t * ex, y - ay - t * ey, t


@njit(**COMPILED_CALLERS_ONLY)
def edges_within(x, y, radius, edge, disc, kid, stack, out):
    """Fill `out` with edges no further than `radius` from a point, and return how many; it ends where there is no more room."""
    found, count = 0, 1
    stack[0] = 0
    while count:
        count -= 1
        node = stack[count]
        dx, dy, r = x - disc[node, 0], y - disc[node, 1], disc[node, 2] + radius
        if dx * dx + dy * dy > r * r:
            continue
        if kid[node, 0] >= 0:
            stack[count] = kid[node, 0]
            stack[count + 1] = kid[node, 1]
            count += 2
            continue
        e = kid[node, 1]
        qx, qy, _ = offset_from_edge(x, y, edge, e)
        if qx * qx + qy * qy > radius * radius:
            continue
        out[found] = e
        found += 1
        if found == len(out):
            return found
    return found


@njit(**COMPILED_CALLERS_ONLY)
def signed_line_distance(edge, e, x, y):
    """How far a point is in front of the line of an edge."""
    ex, ey = edge[e, 2] - edge[e, 0], edge[e, 3] - edge[e, 1]
    return (ey * (x - edge[e, 0]) - ex * (y - edge[e, 1])) / np.sqrt(ex * ex + ey * ey)


@njit(**COMPILED_CALLERS_ONLY)
def free_side_is_convex(edge, some, count, tiny):
    """True where each of some edges lies in front of the lines of all others.

    Edges on one line that face opposite ways enclose a spike of no width: what is free lies on both sides of it.
    """
    for i in range(count):
        for j in range(count):
            if i == j:
                continue
            e, f = some[i], some[j]
            one = signed_line_distance(edge, e, edge[f, 0], edge[f, 1])
            other = signed_line_distance(edge, e, edge[f, 2], edge[f, 3])
            if min(one, other) < -tiny:
                return False
            along = (edge[e, 2] - edge[e, 0]) * (edge[f, 2] - edge[f, 0])
            along += (edge[e, 3] - edge[e, 1]) * (edge[f, 3] - edge[f, 1])
            if max(one, other) <= tiny and along < 0.0:
                return False
    return True


@njit(**COMPILED_CALLERS_ONLY)
def _crossing(x, y, radius, edge, e, entering):
    """Where an edge enters a disc, or leaves it."""
    ax, ay = edge[e, 0] - x, edge[e, 1] - y
    ex, ey = edge[e, 2] - edge[e, 0], edge[e, 3] - edge[e, 1]
    a, b, c = ex * ex + ey * ey, ax * ex + ay * ey, ax * ax + ay * ay - radius * radius
    root = np.sqrt(max(b * b - a * c, 0.0))
    t = min(max((-b - root if entering else -b + root) / a, 0.0), 1.0)
    return edge[e, 0] + t * ex, edge[e, 1] + t * ey


@njit(**COMPILED_CALLERS_ONLY)
def supporting_line(x, y, radius, edge, some, count, line):
    """Fill `line` (nx, ny, offset) so that n . z >= offset for what is free in a disc; False where no such line is known.

    The edges that meet the disc must be one chain across it. Its chord, moved back until no corner of the chain is behind it, cuts off a
    piece of the disc that no edge meets; it lies on the material's side of the chain, so it is material.
    """
    first = -1
    for i in range(count):
        e = some[i]
        if (edge[e, 0] - x) ** 2 + (edge[e, 1] - y) ** 2 > radius * radius:
            if first >= 0:
                return False
            first = e
    if first < 0:
        return False
    px, py = _crossing(x, y, radius, edge, first, True)
    last, seen = first, 1
    while (edge[last, 2] - x) ** 2 + (edge[last, 3] - y) ** 2 <= radius * radius:
        following = -1
        for i in range(count):
            if edge[some[i], 0] == edge[last, 2] and edge[some[i], 1] == edge[last, 3]:
                following = some[i]
        seen += 1
        if following < 0 or seen > count:
            return False
        last = following
    if seen != count:
        return False
    qx, qy = _crossing(x, y, radius, edge, last, False)
    dx, dy = qx - px, qy - py
    long = np.sqrt(dx * dx + dy * dy)
    if long < MIN_CHORD * radius:
        return False
    nx, ny = dy / long, -dx / long
    least = min(nx * px + ny * py, nx * qx + ny * qy)
    for i in range(count):
        e = some[i]
        if e != first:
            least = min(least, nx * edge[e, 0] + ny * edge[e, 1])
    line[0], line[1], line[2] = nx, ny, least
    return True


@njit(**COMPILED_CALLERS_ONLY)
def add_rows(
    x, y, turn, half, swing, slack, of_b, p_edge, p_disc, p_kid, q_edge, q_disc, q_kid, stack, nodes, some, first, line, rows, m
):  # fmt: skip
    """Append rows a . z <= b, z in [-1, 1]^3 the motions of the box, of the corners p of one body against edges q of the other.

    `of_b` tells whether the corners are the moving body's. Corners may lie up to `slack` [mm] behind an edge, which is more than
    rounding puts them elsewhere. Returns the new number of rows.
    """
    c, s = np.cos(turn), np.sin(turn)
    shift, spread = np.sqrt(2.0) * half + slack, 2.0 * np.sin(min(swing, np.pi) / 2)
    tiny = 1e-12 * q_disc[0, 2]
    least_room = tiny + slack
    nodes[0] = 0
    waiting = 1
    while waiting:
        waiting -= 1
        node = nodes[waiting]
        leaf = p_kid[node, 0] < 0
        if leaf:
            px, py, w = p_edge[p_kid[node, 1], 0], p_edge[p_kid[node, 1], 1], 0.0
        else:
            px, py, w = p_disc[node, 0], p_disc[node, 1], p_disc[node, 2]
        if of_b:
            far = np.sqrt(px * px + py * py)
            zx, zy = c * px - s * py + x, s * px + c * py + y
        else:
            zx, zy = c * (px - x) + s * (py - y), -s * (px - x) + c * (py - y)
            far = np.sqrt(zx * zx + zy * zy)
        reach = w + shift + spread * (far + w)
        if not leaf:
            if edges_within(zx, zy, reach, q_edge, q_disc, q_kid, stack, first):
                nodes[waiting] = p_kid[node, 0]
                nodes[waiting + 1] = p_kid[node, 1]
                waiting += 2
            continue
        count = edges_within(zx, zy, reach, q_edge, q_disc, q_kid, stack, some)
        if count == 0 or count > MAX_EDGES:
            continue
        convex = free_side_is_convex(q_edge, some, count, tiny)
        if not convex:
            if not supporting_line(zx, zy, reach, q_edge, some, count, line):
                continue
            count = 1
        for k in range(count):
            if m == len(rows):
                return m
            if convex:
                e = some[k]
                ex, ey = q_edge[e, 2] - q_edge[e, 0], q_edge[e, 3] - q_edge[e, 1]
                long = np.sqrt(ex * ex + ey * ey)
                nx, ny = ey / long, -ex / long
                room = nx * (zx - q_edge[e, 0]) + ny * (zy - q_edge[e, 1]) + least_room
            else:
                nx, ny = line[0], line[1]
                room = nx * zx + ny * zy - line[2] + least_room
            if of_b:
                gx, gy, gt = nx, ny, ny * (zx - x) - nx * (zy - y)
                room += far * swing * swing / 2
            else:
                gx, gy, gt = -(c * nx - s * ny), -(s * nx + c * ny), nx * zy - ny * zx
                room += swing * shift + swing * swing / 2 * (far + shift)
            rows[m, 0], rows[m, 1], rows[m, 2], rows[m, 3] = -gx * half, -gy * half, -gt * swing, room
            m += 1
    return m


@njit(**COMPILED_CALLERS_ONLY)
def linear_program_maximum(c0, c1, c2, rows, m, active, inverse):
    """Largest c . z over the cube [-1, 1]^3 and rows a . z <= b, or a little more; -inf where there is no such z.

    `active` (3, 4) and `inverse` (3, 3) are room to work in.

    Source: the dual simplex method of Lemke (1954), begun at the corner of the cube that is best without any rows.
    """
    goal = (c0, c1, c2)
    for k in range(3):
        active[k, 0] = active[k, 1] = active[k, 2] = 0.0
        active[k, k] = 1.0 if goal[k] >= 0.0 else -1.0
        active[k, 3] = 1.0
    best = abs(c0) + abs(c1) + abs(c2)
    margin = TOLERANCE * best
    for _ in range(MAX_PIVOTS):
        a, b = active, inverse
        det = (
            a[0, 0] * (a[1, 1] * a[2, 2] - a[1, 2] * a[2, 1])
            - a[0, 1] * (a[1, 0] * a[2, 2] - a[1, 2] * a[2, 0])
            + a[0, 2] * (a[1, 0] * a[2, 1] - a[1, 1] * a[2, 0])
        )
        size = 1.0
        for k in range(3):
            size *= np.sqrt(a[k, 0] ** 2 + a[k, 1] ** 2 + a[k, 2] ** 2)
        if abs(det) < 1e-10 * size:
            return best + margin
        for i in range(3):
            i1, i2 = (i + 1) % 3, (i + 2) % 3
            for j in range(3):
                j1, j2 = (j + 1) % 3, (j + 2) % 3
                b[j, i] = (a[i1, j1] * a[i2, j2] - a[i1, j2] * a[i2, j1]) / det
        z0 = b[0, 0] * a[0, 3] + b[0, 1] * a[1, 3] + b[0, 2] * a[2, 3]
        z1 = b[1, 0] * a[0, 3] + b[1, 1] * a[1, 3] + b[1, 2] * a[2, 3]
        z2 = b[2, 0] * a[0, 3] + b[2, 1] * a[1, 3] + b[2, 2] * a[2, 3]
        y = (
            max(c0 * b[0, 0] + c1 * b[1, 0] + c2 * b[2, 0], 0.0),
            max(c0 * b[0, 1] + c1 * b[1, 1] + c2 * b[2, 1], 0.0),
            max(c0 * b[0, 2] + c1 * b[1, 2] + c2 * b[2, 2], 0.0),
        )
        value, summed = 0.0, 0.0
        left0, left1, left2 = c0, c1, c2
        for k in range(3):
            value += y[k] * a[k, 3]
            summed += y[k] * (abs(a[k, 0]) + abs(a[k, 1]) + abs(a[k, 2]) + abs(a[k, 3]))
            left0, left1, left2 = left0 - y[k] * a[k, 0], left1 - y[k] * a[k, 1], left2 - y[k] * a[k, 2]
        # weak duality over the cube: it holds for whatever multipliers rounding has left, but for that of these sums: rows that are nearly
        # parallel have large multipliers, which cancel
        best = min(best, value + abs(left0) + abs(left1) + abs(left2) + SUM_ROUNDING * summed)
        worst, r0, r1, r2, r3 = 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(m):
            behind = rows[k, 0] * z0 + rows[k, 1] * z1 + rows[k, 2] * z2 - rows[k, 3]
            norm = abs(rows[k, 0]) + abs(rows[k, 1]) + abs(rows[k, 2])
            if behind > TOLERANCE * (norm + abs(rows[k, 3])) and behind > worst * norm:
                worst, r0, r1, r2, r3 = (
                    behind / norm if norm > 0.0 else np.inf,
                    rows[k, 0],
                    rows[k, 1],
                    rows[k, 2],
                    rows[k, 3],
                )
        z = (z0, z1, z2)
        for k in range(3):
            if abs(z[k]) - 1.0 > max(worst, TOLERANCE):
                side = 1.0 if z[k] > 0.0 else -1.0
                worst, r0, r1, r2, r3 = abs(z[k]) - 1.0, side * (k == 0), side * (k == 1), side * (k == 2), 1.0
        if worst == 0.0:
            return best + margin
        leaves, ratio = -1, np.inf
        norm = abs(r0) + abs(r1) + abs(r2)
        low, weight = r3, norm + abs(r3)
        left0, left1, left2 = r0, r1, r2
        for i in range(3):
            alpha = r0 * b[0, i] + r1 * b[1, i] + r2 * b[2, i]
            length = abs(a[i, 0]) + abs(a[i, 1]) + abs(a[i, 2])
            if alpha * length > 1e-9 * norm and y[i] / alpha < ratio:
                leaves, ratio = i, y[i] / alpha
            if alpha < 0.0:
                low, weight = low - alpha * a[i, 3], weight - alpha * (length + abs(a[i, 3]))
                left0, left1, left2 = left0 - alpha * a[i, 0], left1 - alpha * a[i, 1], left2 - alpha * a[i, 2]
        if leaves < 0:  # Farkas: the rows add up to one that no point of the cube fulfils
            sure = low < -(abs(left0) + abs(left1) + abs(left2)) - SURE_VIOLATION * weight
            return -np.inf if sure else best + margin
        active[leaves, 0], active[leaves, 1], active[leaves, 2], active[leaves, 3] = r0, r1, r2, r3
    return best + margin
