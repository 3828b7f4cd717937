"""Compiled distances of corners from edges that are near them, with derivatives and a second-order model that is convex for each pair.

h = |x - nearest point of the edge|, x the corner seen in the edge's frame. Where the nearest point is inside the edge, this is the wall of
corner and edge; where it is an end, the distance of two corners. Both have the same derivative where they meet. Behind an edge, nearer to
it than to its ends, h is negative. Unlike the walls of a cell, these rows describe all of the free space round where they were listed.

Source: the contact pairs and the projected Hessians of Li et al. 2020 (Incremental Potential Contact), in the plane.
"""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import COMPILED_CALLERS_ONLY, NO_ALLOCATION, njit
from wiggleroom.geometry.row_kinds import A_EDGE


@njit(inline="always", **COMPILED_CALLERS_ONLY)
def _seen(k, c, s, x, y, u, v):
    """Corner (u, v) as the edge's frame sees it: of B in A's frame (A_EDGE) or of A in B's frame."""
    if k == A_EDGE:
        return c * u - s * v + x, s * u + c * v + y
    return c * (u - x) + s * (v - y), -s * (u - x) + c * (v - y)


@njit(inline="always", **COMPILED_CALLERS_ONLY)
def nearer_to_end(ahead, beyond):
    """True where a point so far ahead of an edge and beyond its nearer end counts by its distance from that end.

    A corner that has come past the next edge, by ever so little, may lie far behind this one: it has not crossed it.
    """
    return beyond > 0.0 or ahead < beyond


@njit(inline="always", **COMPILED_CALLERS_ONLY)
def _distance(x, y, e, corner, normal, length):
    """Distance of (x, y) from edge e, and the unit vector along which it grows."""
    rx, ry = x - corner[e, 0], y - corner[e, 1]
    nx, ny = normal[e, 0], normal[e, 1]
    ahead, along = nx * rx + ny * ry, nx * ry - ny * rx
    if not nearer_to_end(ahead, max(-along, along - length[e])):
        return ahead, nx, ny
    beyond = along if along < 0.5 * length[e] else along - length[e]
    size = np.sqrt(ahead * ahead + beyond * beyond)
    return size, (ahead * nx - beyond * ny) / size, (ahead * ny + beyond * nx) / size


@njit(**NO_ALLOCATION)
def distance_values(g, row, kind, edge, vertex, corner, normal, length, unit, h):
    """Distances h (R,) in units of `unit`; negative behind an edge."""
    for p in range(len(row) - 1):
        c, s = np.cos(g[p, 2]), np.sin(g[p, 2])
        for r in range(row[p], row[p + 1]):
            v = vertex[r]
            x, y = _seen(kind[r], c, s, g[p, 0], g[p, 1], corner[v, 0], corner[v, 1])
            h[r] = _distance(x, y, edge[r], corner, normal, length)[0] / unit


@njit(**NO_ALLOCATION)
def distance_gradients(g, row, kind, edge, vertex, corner, normal, length, unit, h, d):
    """Distances h (R,) and their derivatives d (R, 3) with respect to (q, psi), in units of `unit`."""
    for p in range(len(row) - 1):
        c, s = np.cos(g[p, 2]), np.sin(g[p, 2])
        for r in range(row[p], row[p + 1]):
            v, k = vertex[r], kind[r]
            x, y = _seen(k, c, s, g[p, 0], g[p, 1], corner[v, 0], corner[v, 1])
            size, nx, ny = _distance(x, y, edge[r], corner, normal, length)
            h[r] = size / unit
            nx, ny = nx / unit, ny / unit
            if k == A_EDGE:
                zx, zy = x - g[p, 0], y - g[p, 1]
                d[r, 0], d[r, 1], d[r, 2] = nx, ny, ny * zx - nx * zy
            else:
                mx, my = c * nx - s * ny, s * nx + c * ny
                d[r, 0], d[r, 1], d[r, 2] = -mx, -my, mx * (corner[v, 1] - g[p, 1]) - my * (corner[v, 0] - g[p, 0])


@njit(**NO_ALLOCATION)
def distance_blocks(g, row, kind, edge, vertex, corner, normal, length, d, weight, lam, unit, lever, room, M, force):
    """Add D^T diag(weight) D - sum lam h'' of every pair to M (P, 6), made positive semidefinite, and D^T lam to force (P, 2).

    `d` is in units of `unit`, and so is the second derivative; M holds entries 00 01 02 11 12 22. Turns are compared with shifts by the
    pair's `lever`. `room` (2, 3, 3) is worked in.
    """
    for p in range(len(row) - 1):
        c, s, qx, qy = np.cos(g[p, 2]), np.sin(g[p, 2]), g[p, 0], g[p, 1]
        m00, m01, m02, m11, m12, m22 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for r in range(row[p], row[p + 1]):
            w, f, d0, d1, d2 = weight[r], lam[r], d[r, 0], d[r, 1], d[r, 2]
            m00 += w * d0 * d0
            m01 += w * d0 * d1
            m02 += w * d0 * d2
            m11 += w * d1 * d1
            m12 += w * d1 * d2
            m22 += w * d2 * d2
            force[p, 0] += f * d0
            force[p, 1] += f * d1
            e, v = edge[r], vertex[r]
            x, y = _seen(kind[r], c, s, qx, qy, corner[v, 0], corner[v, 1])
            if kind[r] == A_EDGE:
                t2 = d0 * (x - qx) + d1 * (y - qy)
                m22 += f * t2
            else:
                t2 = d0 * (corner[v, 0] - qx) + d1 * (corner[v, 1] - qy)
                m02 += f * d1
                m12 -= f * d0
                m22 -= f * t2
            rx, ry = x - corner[e, 0], y - corner[e, 1]
            ahead, along = normal[e, 0] * rx + normal[e, 1] * ry, normal[e, 0] * ry - normal[e, 1] * rx
            beyond = max(-along, along - length[e])
            if nearer_to_end(ahead, beyond):  # round an end of the edge the distance curves: what is tangential counts
                k = f * unit / np.sqrt(ahead * ahead + beyond * beyond)
                m00 -= k * d1 * d1
                m01 += k * d0 * d1
                m11 -= k * d0 * d0
                m02 += k * d1 * t2
                m12 -= k * d0 * t2
                m22 -= k * t2 * t2
        scale = 1.0 / lever[p]
        _semidefinite(m00, m01, m02 * scale, m11, m12 * scale, m22 * scale * scale, room)
        N = room[0]
        M[p, 0] += N[0, 0]
        M[p, 1] += N[0, 1]
        M[p, 2] += N[0, 2] / scale
        M[p, 3] += N[1, 1]
        M[p, 4] += N[1, 2] / scale
        M[p, 5] += N[2, 2] / (scale * scale)


@njit(**COMPILED_CALLERS_ONLY)
def _semidefinite(a, b, c, d, e, f, room):
    """Fill room[0] with the symmetric matrix (a b c; b d e; c e f), negative eigenvalues turned positive.

    Cyclic Jacobi rotations, as the matrix is only 3 x 3.
    """
    A, Q = room[0], room[1]
    A[0, 0], A[0, 1], A[0, 2], A[1, 1], A[1, 2], A[2, 2] = a, b, c, d, e, f
    A[1, 0], A[2, 0], A[2, 1] = b, c, e
    small = 1e-12 * (abs(a) + abs(d) + abs(f))
    if a >= -small:
        first = a + small + 1e-300
        second = d + small - b * b / first
        mixed = e - b * c / first
        if second > 0.0 and f + small - c * c / first - mixed * mixed / second > 0.0:
            return
    for i in range(3):
        for j in range(3):
            Q[i, j] = 1.0 if i == j else 0.0
    for _ in range(12):
        if A[0, 1] ** 2 + A[0, 2] ** 2 + A[1, 2] ** 2 <= 1e-24 * (A[0, 0] ** 2 + A[1, 1] ** 2 + A[2, 2] ** 2):
            break
        for i in range(2):
            for j in range(i + 1, 3):
                if A[i, j] == 0.0:
                    continue
                ratio = (A[j, j] - A[i, i]) / (2.0 * A[i, j])
                t = (1.0 if ratio >= 0.0 else -1.0) / (abs(ratio) + np.sqrt(ratio * ratio + 1.0))
                cosine = 1.0 / np.sqrt(t * t + 1.0)
                sine = t * cosine
                for k in range(3):
                    one, other = A[k, i], A[k, j]
                    A[k, i], A[k, j] = cosine * one - sine * other, sine * one + cosine * other
                for k in range(3):
                    one, other = A[i, k], A[j, k]
                    A[i, k], A[j, k] = cosine * one - sine * other, sine * one + cosine * other
                    one, other = Q[k, i], Q[k, j]
                    Q[k, i], Q[k, j] = cosine * one - sine * other, sine * one + cosine * other
    l0, l1, l2 = abs(A[0, 0]), abs(A[1, 1]), abs(A[2, 2])
    for i in range(3):
        for j in range(3):
            A[i, j] = l0 * Q[i, 0] * Q[j, 0] + l1 * Q[i, 1] * Q[j, 1] + l2 * Q[i, 2] * Q[j, 2]
