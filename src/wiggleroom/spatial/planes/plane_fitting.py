"""Compiled changes of separating planes: by a step, and by a fit to what their rows should be."""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import NO_ALLOCATION, njit
from wiggleroom.spatial.planes.separating_plane_constraints import across


@njit(**NO_ALLOCATION)
def move_planes(n, d, lever, y, share, work, n2, d2):
    """Fill n2, d2 with the planes changed by share * y (K, 3). `work` (2, 3) is worked in."""
    for k in range(len(n)):
        across(n[k], work)
        s, t, arm = 0.0, 0.0, share / lever[k]
        for i in range(3):
            t = n[k, i] + arm * (work[0, i] * y[k, 0] + work[1, i] * y[k, 1])
            n2[k, i] = t
            s += t * t
        s = 1.0 / np.sqrt(s)
        for i in range(3):
            n2[k, i] *= s
        d2[k] = (d[k] + share * y[k, 2]) * s


@njit(**NO_ALLOCATION)
def fit_planes(q, Psi, plane, row, own, V, c, lever, goal, weight, rounds, room, n, d):
    """Change the planes (n, d) so that rows come as near to `goal` as they can: weighted least squares, Gauss-Newton.

    `room` (8, 12, 12) is worked in.
    """
    N, A, kept = room[5, :2, :3], room[0], room[1, :3, :3]
    for p in range(len(plane) - 1):
        for k in range(plane[p], plane[p + 1]):
            before = 1e300
            for turn in range(rounds + 1):
                across(n[k], N)
                for i in range(9, 12):
                    for j in range(9, 12):
                        A[i, j] = 0.0
                g0, g1, g2, error = 0.0, 0.0, 0.0, 0.0
                for r in range(row[k], row[k + 1]):
                    if r < row[k] + own[k]:
                        x0, x1, x2, sign = V[r, 0] - c[k, 0], V[r, 1] - c[k, 1], V[r, 2] - c[k, 2], -1.0
                    else:
                        x0 = (
                            q[p, 0] + Psi[p, 0, 0] * V[r, 0] + Psi[p, 0, 1] * V[r, 1] + Psi[p, 0, 2] * V[r, 2] - c[k, 0]
                        )
                        x1 = (
                            q[p, 1] + Psi[p, 1, 0] * V[r, 0] + Psi[p, 1, 1] * V[r, 1] + Psi[p, 1, 2] * V[r, 2] - c[k, 1]
                        )
                        x2 = (
                            q[p, 2] + Psi[p, 2, 0] * V[r, 0] + Psi[p, 2, 1] * V[r, 1] + Psi[p, 2, 2] * V[r, 2] - c[k, 2]
                        )
                        sign = 1.0
                    h = sign * (n[k, 0] * x0 + n[k, 1] * x1 + n[k, 2] * x2 - d[k])
                    j0 = sign * (N[0, 0] * x0 + N[0, 1] * x1 + N[0, 2] * x2) / lever[k]
                    j1 = sign * (N[1, 0] * x0 + N[1, 1] * x1 + N[1, 2] * x2) / lever[k]
                    w, e = weight[r], goal[r] - h
                    error += w * e * e
                    g0, g1, g2 = g0 + w * e * j0, g1 + w * e * j1, g2 - w * e * sign
                    A[9, 9] += w * j0 * j0
                    A[9, 10] += w * j0 * j1
                    A[10, 10] += w * j1 * j1
                    A[9, 11] -= w * j0 * sign
                    A[10, 11] -= w * j1 * sign
                    A[11, 11] += w
                if error > before or turn == rounds:
                    if error > before:
                        n[k, 0], n[k, 1], n[k, 2], d[k] = kept[0, 0], kept[0, 1], kept[0, 2], kept[1, 0]
                    break
                before = error
                kept[0, 0], kept[0, 1], kept[0, 2], kept[1, 0] = n[k, 0], n[k, 1], n[k, 2], d[k]
                tiny = 1e-13 * (A[9, 9] + A[10, 10] + A[11, 11])
                A[9, 9] += tiny
                A[10, 10] += tiny
                A[11, 11] += tiny
                d0 = A[9, 9]
                l1, l2 = A[9, 10] / d0, A[9, 11] / d0
                d1 = A[10, 10] - l1 * A[9, 10]
                l3 = (A[10, 11] - l2 * A[9, 10]) / d1
                d2 = A[11, 11] - l2 * A[9, 11] - l3 * l3 * d1
                y0 = g0
                y1 = g1 - l1 * y0
                y2 = g2 - l2 * y0 - l3 * y1
                y2 = y2 / d2
                y1 = y1 / d1 - l3 * y2
                y0 = y0 / d0 - l1 * y1 - l2 * y2
                s = 0.0
                for i in range(3):
                    n[k, i] += (N[0, i] * y0 + N[1, i] * y1) / lever[k]
                    s += n[k, i] * n[k, i]
                s = 1.0 / np.sqrt(s)
                for i in range(3):
                    n[k, i] *= s
                d[k] = (d[k] + y2) * s
