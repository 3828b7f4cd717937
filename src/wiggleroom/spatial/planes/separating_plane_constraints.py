"""Compiled rows of separating planes, with exact first and second derivatives.

A plane stands between a convex piece of body A and one of body B. It lives in A's frame: unit normal n, from A to B, and offset d about
a point c. With B seen from A at q = Ra^T (Tb - Ta), Psi = Ra^T Rb its rows are

    corner p of A's piece:  h = d - n . (p - c)
    corner v of B's piece:  h = n . (x - c) - d,   x = q + Psi v

Variables are (dT, w) for a body, T <- T + dT, R <- R exp(a), a = axes w, and (alpha, delta) for a plane, n <- (n + N alpha)/|.|,
d <- (d + delta)/|.| with N two unit vectors across n. `axes` (n, 3, 3) are those, in the body's frame, about which its turns are counted.
A pair of bodies sees xi = (tau, a, beta) = (Ra^T (dTb - dTa), a_A, Psi a_B).

Planes of a pair of bodies follow each other: those of pair p are plane[p] .. plane[p + 1], rows of plane k are row[k] .. row[k + 1], the
first `own[k]` of them belong to A's corners.
"""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import NO_ALLOCATION, njit


@njit(**NO_ALLOCATION)
def across(n, N):
    """Fill N (2, 3) with unit vectors across n."""
    i = 0
    if abs(n[1]) < abs(n[i]):
        i = 1
    if abs(n[2]) < abs(n[i]):
        i = 2
    j, k = (i + 1) % 3, (i + 2) % 3
    length = np.sqrt(n[j] * n[j] + n[k] * n[k])
    N[0, i], N[0, j], N[0, k] = 0.0, -n[k] / length, n[j] / length
    N[1, 0] = n[1] * N[0, 2] - n[2] * N[0, 1]
    N[1, 1] = n[2] * N[0, 0] - n[0] * N[0, 2]
    N[1, 2] = n[0] * N[0, 1] - n[1] * N[0, 0]


@njit(**NO_ALLOCATION)
def relative_frames(T, R, a, b, q, Psi):
    """Fill q (P, 3) and Psi (P, 3, 3): B seen from A."""
    for p in range(len(a)):
        for i in range(3):
            q[p, i] = 0.0
            for j in range(3):
                q[p, i] += R[a[p], j, i] * (T[b[p], j] - T[a[p], j])
            for k in range(3):
                s = 0.0
                for j in range(3):
                    s += R[a[p], j, i] * R[b[p], j, k]
                Psi[p, i, k] = s


@njit(**NO_ALLOCATION)
def row_values(q, Psi, plane, row, own, V, c, n, d, h):
    """Values h (R,) of all rows [mm]."""
    for p in range(len(plane) - 1):
        for k in range(plane[p], plane[p + 1]):
            n0, n1, n2 = n[k, 0], n[k, 1], n[k, 2]
            level = d[k] + n0 * c[k, 0] + n1 * c[k, 1] + n2 * c[k, 2]
            for r in range(row[k], row[k] + own[k]):
                h[r] = level - (n0 * V[r, 0] + n1 * V[r, 1] + n2 * V[r, 2])
            m0 = n0 * Psi[p, 0, 0] + n1 * Psi[p, 1, 0] + n2 * Psi[p, 2, 0]
            m1 = n0 * Psi[p, 0, 1] + n1 * Psi[p, 1, 1] + n2 * Psi[p, 2, 1]
            m2 = n0 * Psi[p, 0, 2] + n1 * Psi[p, 1, 2] + n2 * Psi[p, 2, 2]
            level = n0 * q[p, 0] + n1 * q[p, 1] + n2 * q[p, 2] - level
            for r in range(row[k] + own[k], row[k + 1]):
                h[r] = level + m0 * V[r, 0] + m1 * V[r, 1] + m2 * V[r, 2]


@njit(**NO_ALLOCATION)
def row_gradients(q, Psi, plane, row, own, V, c, n, lever, work, G):
    """Derivatives G (R, 12) by xi (9) and by the plane's (alpha * lever, delta) (3). `work` (2, 3) is worked in."""
    N = work
    for p in range(len(plane) - 1):
        for k in range(plane[p], plane[p + 1]):
            across(n[k], N)
            n0, n1, n2 = n[k, 0], n[k, 1], n[k, 2]
            c0, c1, c2, arm = c[k, 0], c[k, 1], c[k, 2], 1.0 / lever[k]
            for r in range(row[k], row[k] + own[k]):
                x0, x1, x2 = V[r, 0] - c0, V[r, 1] - c1, V[r, 2] - c2
                for i in range(9):
                    G[r, i] = 0.0
                G[r, 9] = -(N[0, 0] * x0 + N[0, 1] * x1 + N[0, 2] * x2) * arm
                G[r, 10] = -(N[1, 0] * x0 + N[1, 1] * x1 + N[1, 2] * x2) * arm
                G[r, 11] = 1.0
            for r in range(row[k] + own[k], row[k + 1]):
                z0 = Psi[p, 0, 0] * V[r, 0] + Psi[p, 0, 1] * V[r, 1] + Psi[p, 0, 2] * V[r, 2]
                z1 = Psi[p, 1, 0] * V[r, 0] + Psi[p, 1, 1] * V[r, 1] + Psi[p, 1, 2] * V[r, 2]
                z2 = Psi[p, 2, 0] * V[r, 0] + Psi[p, 2, 1] * V[r, 1] + Psi[p, 2, 2] * V[r, 2]
                x0, x1, x2 = z0 + q[p, 0], z1 + q[p, 1], z2 + q[p, 2]
                G[r, 0], G[r, 1], G[r, 2] = n0, n1, n2
                G[r, 3], G[r, 4], G[r, 5] = x2 * n1 - x1 * n2, x0 * n2 - x2 * n0, x1 * n0 - x0 * n1
                G[r, 6], G[r, 7], G[r, 8] = z1 * n2 - z2 * n1, z2 * n0 - z0 * n2, z0 * n1 - z1 * n0
                x0, x1, x2 = x0 - c0, x1 - c1, x2 - c2
                G[r, 9] = (N[0, 0] * x0 + N[0, 1] * x1 + N[0, 2] * x2) * arm
                G[r, 10] = (N[1, 0] * x0 + N[1, 1] * x1 + N[1, 2] * x2) * arm
                G[r, 11] = -1.0


@njit(**NO_ALLOCATION)
def against(Psi, R, axes, a, b, plane, row, G, y, scale, on_bodies, on_planes):
    """Add G^T y to on_bodies (n, 6), scaled, and fill on_planes (K, 3)."""
    for p in range(len(a)):
        x0, x1, x2, x3, x4, x5, x6, x7, x8 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(plane[p], plane[p + 1]):
            y0, y1, y2 = 0.0, 0.0, 0.0
            for r in range(row[k], row[k + 1]):
                v = y[r]
                x0 += G[r, 0] * v
                x1 += G[r, 1] * v
                x2 += G[r, 2] * v
                x3 += G[r, 3] * v
                x4 += G[r, 4] * v
                x5 += G[r, 5] * v
                x6 += G[r, 6] * v
                x7 += G[r, 7] * v
                x8 += G[r, 8] * v
                y0 += G[r, 9] * v
                y1 += G[r, 10] * v
                y2 += G[r, 11] * v
            on_planes[k, 0], on_planes[k, 1], on_planes[k, 2] = y0, y1, y2
        to_bodies(p, Psi, R, axes, a[p], b[p], x0, x1, x2, x3, x4, x5, x6, x7, x8, scale, on_bodies)


@njit(**NO_ALLOCATION)
def to_bodies(p, Psi, R, axes, i, j, x0, x1, x2, x3, x4, x5, x6, x7, x8, scale, out):
    """Add what a pair feels by xi to what its two bodies feel."""
    for k in range(3):
        force = R[i, k, 0] * x0 + R[i, k, 1] * x1 + R[i, k, 2] * x2
        out[i, k] -= force * scale[i, k]
        out[j, k] += force * scale[j, k]
    m0 = Psi[p, 0, 0] * x6 + Psi[p, 1, 0] * x7 + Psi[p, 2, 0] * x8
    m1 = Psi[p, 0, 1] * x6 + Psi[p, 1, 1] * x7 + Psi[p, 2, 1] * x8
    m2 = Psi[p, 0, 2] * x6 + Psi[p, 1, 2] * x7 + Psi[p, 2, 2] * x8
    for k in range(3):
        moment = axes[i, 0, k] * x3 + axes[i, 1, k] * x4 + axes[i, 2, k] * x5
        out[i, 3 + k] += moment * scale[i, 3 + k]
        moment = axes[j, 0, k] * m0 + axes[j, 1, k] * m1 + axes[j, 2, k] * m2
        out[j, 3 + k] += moment * scale[j, 3 + k]


@njit(**NO_ALLOCATION)
def pair_changes(Psi, R, axes, a, b, scale, u, turn, xi):
    """Fill xi (P, 9) with what pairs see of scaled changes u (n, 6) of the bodies, and turn (n, 3) with their turns in their frames."""
    for i in range(len(u)):
        for k in range(3):
            s = 0.0
            for t in range(3):
                s += axes[i, k, t] * u[i, 3 + t] * scale[i, 3 + t]
            turn[i, k] = s
    for p in range(len(a)):
        i, j = a[p], b[p]
        for k in range(3):
            s = 0.0
            for t in range(3):
                s += R[i, t, k] * (u[j, t] * scale[j, t] - u[i, t] * scale[i, t])
            xi[p, k] = s
            xi[p, 3 + k] = turn[i, k]
            s = 0.0
            for t in range(3):
                s += Psi[p, k, t] * turn[j, t]
            xi[p, 6 + k] = s


@njit(**NO_ALLOCATION)
def along(plane, row, G, xi, y, out):
    """Fill out (R,) with the change of every row by xi (P, 9) of the pairs and y (K, 3) of the planes."""
    for p in range(len(plane) - 1):
        for k in range(plane[p], plane[p + 1]):
            for r in range(row[k], row[k + 1]):
                s = 0.0
                for i in range(9):
                    s += G[r, i] * xi[p, i]
                out[r] = s + G[r, 9] * y[k, 0] + G[r, 10] * y[k, 1] + G[r, 11] * y[k, 2]
