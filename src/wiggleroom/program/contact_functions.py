"""Compiled evaluation of relative poses and walls, with exact first and second derivatives.

The one equation: B seen from A is q = R(theta_A)^T (T_B - T_A), psi = theta_B - theta_A. Rows h >= 0, by kind (`row_kinds`):

    A_EDGE     h = n . (R(psi) v + q) - off                     a wall: corner v of B in front of an edge of A
    B_EDGE     h = n . R(-psi) (v - q) - off                    a wall: corner v of A in front of an edge of B
    LOW_TURN   h = lever (psi - low)                            psi within the interval over which a cell was verified
    HIGH_TURN  h = lever (high - psi)
    FACE       h = n . (R(psi) v + q) + per_turn psi - off      a flat face, linear in where a point v of B is seen and in psi

Rows say by number which line (n, off, per_turn) and which point v they are about (`constraint_rows.Rows`).
"""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import COMPILED_CALLERS_ONLY, NO_ALLOCATION, njit
from wiggleroom.compiled.vector_operations import larger
from wiggleroom.geometry.row_kinds import A_EDGE, B_EDGE, FACE, HIGH_TURN, LOW_TURN


@njit(**NO_ALLOCATION)
def relative_poses(pose, a, b, g, turn):
    """Fill g (P, 3) with B seen from A, and turn (P, 2) with cos and sin of A's angle."""
    for p in range(len(a)):
        i, j = a[p], b[p]
        c, s = np.cos(pose[i, 2]), np.sin(pose[i, 2])
        wx, wy = pose[j, 0] - pose[i, 0], pose[j, 1] - pose[i, 1]
        g[p, 0], g[p, 1], g[p, 2] = c * wx + s * wy, -s * wx + c * wy, pose[j, 2] - pose[i, 2]
        turn[p, 0], turn[p, 1] = c, s


@njit(**NO_ALLOCATION)
def wall_values(g, row, lever, ends, kind, line, point, normal, off, per_turn, corner, unit, h):
    """Values h (R,) of all rows, in units of `unit`; rows of pair p are row[p] .. row[p + 1]."""
    for p in range(len(row) - 1):
        x, y, psi = g[p, 0], g[p, 1], g[p, 2]
        c, s = np.cos(psi), np.sin(psi)
        for k in range(row[p], row[p + 1]):
            if kind[k] == LOW_TURN:
                h[k] = lever[p] * (psi - ends[p, 0]) / unit
                continue
            if kind[k] == HIGH_TURN:
                h[k] = lever[p] * (ends[p, 1] - psi) / unit
                continue
            e, v = line[k], point[k]
            nx, ny, vx, vy = normal[e, 0], normal[e, 1], corner[v, 0], corner[v, 1]
            if kind[k] == A_EDGE:
                value = nx * (c * vx - s * vy + x) + ny * (s * vx + c * vy + y) - off[e]
            elif kind[k] == B_EDGE:
                value = (c * nx - s * ny) * (vx - x) + (s * nx + c * ny) * (vy - y) - off[e]
            else:
                value = nx * (c * vx - s * vy + x) + ny * (s * vx + c * vy + y) + per_turn[e] * psi - off[e]
            h[k] = value / unit


@njit(**NO_ALLOCATION)
def wall_gradients(g, row, lever, ends, kind, line, point, normal, off, per_turn, corner, unit, h, d):
    """Values h (R,) of all rows and their derivatives d (R, 3) with respect to (q, psi), in units of `unit`."""
    for p in range(len(row) - 1):
        x, y, psi = g[p, 0], g[p, 1], g[p, 2]
        c, s = np.cos(psi), np.sin(psi)
        for k in range(row[p], row[p + 1]):
            e, v = line[k], point[k]
            if kind[k] == LOW_TURN:
                value, d0, d1, d2 = lever[p] * (psi - ends[p, 0]), 0.0, 0.0, lever[p]
            elif kind[k] == HIGH_TURN:
                value, d0, d1, d2 = lever[p] * (ends[p, 1] - psi), 0.0, 0.0, -lever[p]
            elif kind[k] == A_EDGE:
                nx, ny, vx, vy = normal[e, 0], normal[e, 1], corner[v, 0], corner[v, 1]
                zx, zy = c * vx - s * vy, s * vx + c * vy
                value, d0, d1, d2 = nx * (zx + x) + ny * (zy + y) - off[e], nx, ny, ny * zx - nx * zy
            elif kind[k] == B_EDGE:
                nx, ny, vx, vy = normal[e, 0], normal[e, 1], corner[v, 0], corner[v, 1]
                mx, my, ux, uy = c * nx - s * ny, s * nx + c * ny, vx - x, vy - y
                value, d0, d1, d2 = mx * ux + my * uy - off[e], -mx, -my, mx * uy - my * ux
            else:
                nx, ny, vx, vy = normal[e, 0], normal[e, 1], corner[v, 0], corner[v, 1]
                zx, zy, turning = c * vx - s * vy, s * vx + c * vy, per_turn[e]
                value = nx * (zx + x) + ny * (zy + y) + turning * psi - off[e]
                d0, d1, d2 = nx, ny, ny * zx - nx * zy + turning
            h[k] = value / unit
            d[k, 0], d[k, 1], d[k, 2] = d0 / unit, d1 / unit, d2 / unit


@njit(inline="always", **COMPILED_CALLERS_ONLY)
def _relative_change(p, g, turn, i, j, scale, u):
    """Change (x, y, psi) of the relative pose of pair p, of the free bodies i and j (-1: fixed), along u."""
    c, s = turn[p, 0], turn[p, 1]
    ex, ey, et = 0.0, 0.0, 0.0
    if j >= 0:
        vx, vy = u[3 * j] * scale[3 * j], u[3 * j + 1] * scale[3 * j + 1]
        ex, ey, et = c * vx + s * vy, -s * vx + c * vy, u[3 * j + 2] * scale[3 * j + 2]
    if i >= 0:
        vx, vy, w = u[3 * i] * scale[3 * i], u[3 * i + 1] * scale[3 * i + 1], u[3 * i + 2] * scale[3 * i + 2]
        ex += -c * vx - s * vy + g[p, 1] * w
        ey += s * vx - c * vy - g[p, 0] * w
        et -= w
    return ex, ey, et


@njit(inline="always", **COMPILED_CALLERS_ONLY)
def _add_wrench(p, g, turn, i, j, scale, fx, fy, ft, out):
    """Add what a force (fx, fy) and torque ft on B in A's frame, of pair p, mean for the free bodies i and j (-1: fixed)."""
    c, s = turn[p, 0], turn[p, 1]
    wx, wy = c * fx - s * fy, s * fx + c * fy
    if j >= 0:
        out[3 * j] += wx * scale[3 * j]
        out[3 * j + 1] += wy * scale[3 * j + 1]
        out[3 * j + 2] += ft * scale[3 * j + 2]
    if i >= 0:
        out[3 * i] -= wx * scale[3 * i]
        out[3 * i + 1] -= wy * scale[3 * i + 1]
        out[3 * i + 2] += (g[p, 1] * fx - g[p, 0] * fy - ft) * scale[3 * i + 2]


@njit(**NO_ALLOCATION)
def jacobian_product(g, turn, a, b, row, d, scale, slot, u, out):
    """Out = J u: directional derivative of every row; `slot` maps bodies to free bodies (-1: fixed)."""
    for p in range(len(a)):
        ex, ey, et = _relative_change(p, g, turn, slot[a[p]], slot[b[p]], scale, u)
        for k in range(row[p], row[p + 1]):
            out[k] = d[k, 0] * ex + d[k, 1] * ey + d[k, 2] * et


@njit(**NO_ALLOCATION)
def transposed_jacobian_product(g, turn, a, b, row, d, scale, slot, y, out):
    """Add J^T y to out."""
    for p in range(len(a)):
        fx, fy, ft = 0.0, 0.0, 0.0
        for k in range(row[p], row[p + 1]):
            fx += d[k, 0] * y[k]
            fy += d[k, 1] * y[k]
            ft += d[k, 2] * y[k]
        _add_wrench(p, g, turn, slot[a[p]], slot[b[p]], scale, fx, fy, ft, out)


@njit(**NO_ALLOCATION)
def eliminated_product(g, turn, a, b, row, d, scale, slot, h, s, lam, goal, share, out):
    """Add J^T ((lam * share * (s - h) + goal) / s) to out: what rows ask of the variables once slacks and multipliers are eliminated.

    Of the rows of a corrector hardly any asks for anything.
    """
    for p in range(len(a)):
        fx, fy, ft, idle = 0.0, 0.0, 0.0, True
        for k in range(row[p], row[p + 1]):
            asked = lam[k] * (share * (s[k] - h[k])) + goal[k]
            if asked == 0.0:
                continue
            y, idle = asked / s[k], False
            fx += d[k, 0] * y
            fy += d[k, 1] * y
            ft += d[k, 2] * y
        if not idle:
            _add_wrench(p, g, turn, slot[a[p]], slot[b[p]], scale, fx, fy, ft, out)


@njit(**COMPILED_CALLERS_ONLY)
def _eliminated(h, s, lam, goal, share, ds, dlam):
    """Take share * (s - h) off ds, fill in (goal - lam * ds) / s, and find the largest ratios -ds / s and -dlam / lam, at least 1."""
    fastest, dual_fastest = 1.0, 1.0
    for k in range(len(s)):
        change = ds[k] - share * (s[k] - h[k])
        other = (goal[k] - lam[k] * change) / s[k]
        ds[k], dlam[k] = change, other
        fastest, dual_fastest = larger(fastest, -change / s[k]), larger(dual_fastest, -other / lam[k])
    return fastest, dual_fastest


@njit(**NO_ALLOCATION)
def eliminated_changes(g, turn, a, b, row, d, scale, slot, u, h, s, lam, goal, share, ds, dlam):
    """Fill in the changes of slacks, J u - share * (s - h), and multipliers, (goal - lam * ds) / s, that belong to a change u.

    Returns the largest ratios -ds / s and -dlam / lam, at least 1: the reciprocals of the longest steps.
    """
    jacobian_product(g, turn, a, b, row, d, scale, slot, u, ds)
    begin, end = row[0], row[len(a)]
    return _eliminated(
        h[begin:end], s[begin:end], lam[begin:end], goal[begin:end], share, ds[begin:end], dlam[begin:end]
    )


@njit(**NO_ALLOCATION)
def wall_blocks(g, row, kind, line, point, d, normal, corner, unit, weight, lam, M, force):
    """Add D^T diag(weight) D - sum lam h'' of every pair to M (P, 6), entries 00 01 02 11 12 22, and D^T lam to force (P, 2).

    `d` is in units of `unit`, and so is the second derivative.
    """
    for p in range(len(row) - 1):
        x, y, psi = g[p, 0], g[p, 1], g[p, 2]
        c, s = np.cos(psi), np.sin(psi)
        for k in range(row[p], row[p + 1]):
            w, f = weight[k], lam[k]
            d0, d1, d2 = d[k, 0], d[k, 1], d[k, 2]
            M[p, 0] += w * d0 * d0
            M[p, 1] += w * d0 * d1
            M[p, 2] += w * d0 * d2
            M[p, 3] += w * d1 * d1
            M[p, 4] += w * d1 * d2
            M[p, 5] += w * d2 * d2
            force[p, 0] += f * d0
            force[p, 1] += f * d1
            vx, vy = corner[point[k], 0], corner[point[k], 1]
            if kind[k] == A_EDGE or kind[k] == FACE:
                nx, ny = normal[line[k], 0] / unit, normal[line[k], 1] / unit
                M[p, 5] += f * (nx * (c * vx - s * vy) + ny * (s * vx + c * vy))
            elif kind[k] == B_EDGE:
                M[p, 2] += f * d1
                M[p, 4] -= f * d0
                M[p, 5] -= f * (d0 * (vx - x) + d1 * (vy - y))


@njit(**NO_ALLOCATION)
def add_condensed_blocks(g, turn, a, b, M, force, scale, slot, diagonal_at, block_at, room, data):
    """Add the blocks M (P, 6) of all pairs, seen from the bodies, to the upper triangle `data`.

    `force` (P, 2) multiplies the second derivatives of q. `diagonal_at` (F, 6) and `block_at` (P, 9) say where the entries of a body's
    own block and of a pair's block live; the pair's block has the rows of the body with the smaller slot. `room` (3, 6, 6) is zero on entry
    and worked in.
    """
    G, T, B = room[0], room[1], room[2]
    for p in range(len(a)):
        x, y, fx, fy = g[p, 0], g[p, 1], force[p, 0], force[p, 1]
        c, s = turn[p, 0], turn[p, 1]
        G[0, 0], G[0, 1], G[0, 2], G[0, 3], G[0, 4] = -c, -s, y, c, s
        G[1, 0], G[1, 1], G[1, 2], G[1, 3], G[1, 4] = s, -c, -x, -s, c
        G[2, 2], G[2, 5] = -1.0, 1.0
        for q in range(6):
            T[0, q] = M[p, 0] * G[0, q] + M[p, 1] * G[1, q] + M[p, 2] * G[2, q]
            T[1, q] = M[p, 1] * G[0, q] + M[p, 3] * G[1, q] + M[p, 4] * G[2, q]
            T[2, q] = M[p, 2] * G[0, q] + M[p, 4] * G[1, q] + M[p, 5] * G[2, q]
        for r in range(6):
            for q in range(r, 6):
                B[r, q] = G[0, r] * T[0, q] + G[1, r] * T[1, q] + G[2, r] * T[2, q]
        # second derivatives of q
        ax, ay = -s * fx - c * fy, c * fx - s * fy
        B[0, 2] += ax
        B[1, 2] += ay
        B[2, 3] -= ax
        B[2, 4] -= ay
        B[2, 2] += fx * x + fy * y
        i, j = slot[a[p]], slot[b[p]]
        for body in range(2):
            f, o, n = j if body else i, 3 * body, 0
            if f < 0:
                continue
            for q in range(3):
                for r in range(q + 1):
                    data[diagonal_at[f, n]] += B[o + r, o + q] * scale[3 * f + r] * scale[3 * f + q]
                    n += 1
        if i < 0 or j < 0:
            continue
        n = 0
        for q in range(3):
            for r in range(3):  # only the upper triangle of B is filled: rows of A, columns of B
                if i < j:  # noqa: SIM108 (one line would be too long)
                    entry = B[r, 3 + q] * scale[3 * i + r] * scale[3 * j + q]
                else:
                    entry = B[q, 3 + r] * scale[3 * j + r] * scale[3 * i + q]
                data[block_at[p, n]] += entry
                n += 1
