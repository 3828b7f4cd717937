"""Compiled Schur complement of the planes: their three unknowns each are eliminated, which leaves blocks of the bodies.

Names of arrays are those of `separating_plane_constraints`.
"""

from __future__ import annotations

from wiggleroom.compiled.jit_options import NO_ALLOCATION, njit
from wiggleroom.spatial.planes.separating_plane_constraints import across, to_bodies


@njit(**NO_ALLOCATION)
def invert(A, inverse):
    """Fill inverse (3, 3) with that of the lower right 3 x 3 block of the symmetric A (12, 12), by L D L^T."""
    d0 = A[9, 9]
    l1, l2 = A[9, 10] / d0, A[9, 11] / d0
    d1 = A[10, 10] - l1 * A[9, 10]
    l3 = (A[10, 11] - l2 * A[9, 10]) / d1
    d2 = A[11, 11] - l2 * A[9, 11] - l3 * l3 * d1
    # columns of L^-1
    m20 = l1 * l3 - l2
    inverse[2, 2] = 1.0 / d2
    inverse[1, 2] = -l3 / d2
    inverse[0, 2] = m20 / d2
    inverse[1, 1] = 1.0 / d1 + l3 * l3 / d2
    inverse[0, 1] = -l1 / d1 - m20 * l3 / d2
    inverse[0, 0] = 1.0 / d0 + l1 * l1 / d1 + m20 * m20 / d2
    inverse[1, 0], inverse[2, 0], inverse[2, 1] = inverse[0, 1], inverse[0, 2], inverse[1, 2]


@njit(**NO_ALLOCATION)
def condensed(
    q,
    Psi,
    R,
    axes,
    a,
    b,
    plane,
    row,
    own,
    V,
    n,
    lever,
    h,
    G,
    weight,
    lam,
    damping,
    balance,
    scale,
    entry,
    room,
    inverse,
    mixed,
    data,
):
    """Add G^T diag(weight) G - sum lam h'' to the upper triangle `data`; planes are eliminated from it.

    `entry` (P, 12, 12) says where the entries of a pair's block live (-1: nowhere). `inverse` (K, 3, 3) and `mixed` (K, 3, 9) are
    filled with the inverse of every plane's own block and its block with xi. `balance` (P, 3) are forces on B, in A's frame.
    `room` (8, 12, 12) is worked in. `damping` is added to the planes' own blocks.
    """
    A, S, M, W, Y = room[0], room[1], room[2], room[3], room[4]
    N = room[5, :2, :3]
    for p in range(len(a)):
        for i in range(9):
            for j in range(9):
                S[i, j] = 0.0
        f0, f1, f2 = balance[p, 0], balance[p, 1], balance[p, 2]
        for k in range(plane[p], plane[p + 1]):
            across(n[k], N)
            n0, n1, n2, arm = n[k, 0], n[k, 1], n[k, 2], 1.0 / lever[k]
            for i in range(12):
                for j in range(12):
                    A[i, j] = 0.0
            for i in range(3):
                for j in range(3):
                    M[i, j] = 0.0
            turn = 0.0
            for r in range(row[k], row[k] + own[k]):
                turn += max(lam[r] * h[r], 0.0)
                w = weight[r]
                for i in range(9, 12):
                    for j in range(i, 12):
                        A[i, j] += w * G[r, i] * G[r, j]
            for r in range(row[k] + own[k], row[k + 1]):
                turn += max(lam[r] * h[r], 0.0)
                w, force = weight[r], lam[r]
                for i in range(12):
                    g = w * G[r, i]
                    for j in range(i, 12):
                        A[i, j] += g * G[r, j]
                z0 = Psi[p, 0, 0] * V[r, 0] + Psi[p, 0, 1] * V[r, 1] + Psi[p, 0, 2] * V[r, 2]
                z1 = Psi[p, 1, 0] * V[r, 0] + Psi[p, 1, 1] * V[r, 1] + Psi[p, 1, 2] * V[r, 2]
                z2 = Psi[p, 2, 0] * V[r, 0] + Psi[p, 2, 1] * V[r, 1] + Psi[p, 2, 2] * V[r, 2]
                x0, x1, x2 = z0 + q[p, 0], z1 + q[p, 1], z2 + q[p, 2]
                f0, f1, f2 = f0 + force * n0, f1 + force * n1, f2 + force * n2
                M[0, 0] += force * n0 * z0
                M[0, 1] += force * n0 * z1
                M[0, 2] += force * n0 * z2
                M[1, 0] += force * n1 * z0
                M[1, 1] += force * n1 * z1
                M[1, 2] += force * n1 * z2
                M[2, 0] += force * n2 * z0
                M[2, 1] += force * n2 * z1
                M[2, 2] += force * n2 * z2
                for t in range(2):
                    m0, m1, m2 = force * arm * N[t, 0], force * arm * N[t, 1], force * arm * N[t, 2]
                    A[0, 9 + t] -= m0
                    A[1, 9 + t] -= m1
                    A[2, 9 + t] -= m2
                    A[3, 9 + t] -= x2 * m1 - x1 * m2
                    A[4, 9 + t] -= x0 * m2 - x2 * m0
                    A[5, 9 + t] -= x1 * m0 - x0 * m1
                    A[6, 9 + t] -= z1 * m2 - z2 * m1
                    A[7, 9 + t] -= z2 * m0 - z0 * m2
                    A[8, 9 + t] -= z0 * m1 - z1 * m0
            A[9, 9] += turn * arm * arm + damping
            A[10, 10] += turn * arm * arm + damping
            A[11, 11] += damping
            trace = M[0, 0] + M[1, 1] + M[2, 2]
            for i in range(3):
                for j in range(3):
                    bend = 0.5 * (M[i, j] + M[j, i])
                    other = -M[j, i]
                    if i == j:
                        bend -= trace
                        other += trace
                    if j >= i:
                        A[3 + i, 3 + j] -= bend
                        A[6 + i, 6 + j] -= bend
                    A[3 + i, 6 + j] -= other
            invert(A, inverse[k])
            for t in range(3):
                for i in range(9):
                    mixed[k, t, i] = A[i, 9 + t]
            for i in range(9):
                for t in range(3):
                    W[i, t] = A[i, 9] * inverse[k, 0, t] + A[i, 10] * inverse[k, 1, t] + A[i, 11] * inverse[k, 2, t]
                for j in range(i, 9):
                    S[i, j] += A[i, j] - (W[i, 0] * A[j, 9] + W[i, 1] * A[j, 10] + W[i, 2] * A[j, 11])
        # second derivatives of q: - f . (a x (a x q) / 2 - a x tau)
        q0, q1, q2 = q[p, 0], q[p, 1], q[p, 2]
        S[0, 4] -= f2
        S[0, 5] += f1
        S[1, 3] += f2
        S[1, 5] -= f0
        S[2, 3] -= f1
        S[2, 4] += f0
        along = f0 * q0 + f1 * q1 + f2 * q2
        S[3, 3] -= f0 * q0 - along
        S[4, 4] -= f1 * q1 - along
        S[5, 5] -= f2 * q2 - along
        S[3, 4] -= 0.5 * (f0 * q1 + f1 * q0)
        S[3, 5] -= 0.5 * (f0 * q2 + f2 * q0)
        S[4, 5] -= 0.5 * (f1 * q2 + f2 * q1)
        for i in range(9):
            for j in range(i):
                S[i, j] = S[j, i]
        # to the bodies: tau = Ra^T (dTb - dTa), a = axes_A w_A, beta = Psi axes_B w_B
        i_a, i_b = a[p], b[p]
        for i in range(3):
            for j in range(3):
                s = 0.0
                for t in range(3):
                    s += Psi[p, i, t] * axes[i_b, t, j]
                M[i, j] = s
        for i in range(9):
            for j in range(3):
                s = 0.0
                for t in range(3):
                    s += S[i, t] * R[i_a, j, t]
                Y[i, j], Y[i, 6 + j] = -s, s
                s = 0.0
                for t in range(3):
                    s += S[i, 3 + t] * axes[i_a, t, j]
                Y[i, 3 + j] = s
                s = 0.0
                for t in range(3):
                    s += S[i, 6 + t] * M[t, j]
                Y[i, 9 + j] = s
        for j in range(12):
            for i in range(3):
                s = 0.0
                for t in range(3):
                    s += R[i_a, i, t] * Y[t, j]
                A[i, j], A[6 + i, j] = -s, s
                s = 0.0
                for t in range(3):
                    s += axes[i_a, t, i] * Y[3 + t, j]
                A[3 + i, j] = s
                s = 0.0
                for t in range(3):
                    s += M[t, i] * Y[6 + t, j]
                A[9 + i, j] = s
        for i in range(12):
            si = scale[i_a, i] if i < 6 else scale[i_b, i - 6]
            for j in range(12):
                at = entry[p, i, j]
                if at >= 0:
                    sj = scale[i_a, j] if j < 6 else scale[i_b, j - 6]
                    data[at] += A[i, j] * si * sj


@njit(**NO_ALLOCATION)
def eliminate(Psi, R, axes, a, b, plane, inverse, mixed, y, scale, share, on_bodies):
    """Fill share (K, 3) with inverse y, and take what that means for the bodies off on_bodies (n, 6)."""
    for p in range(len(a)):
        x0, x1, x2, x3, x4, x5, x6, x7, x8 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(plane[p], plane[p + 1]):
            for t in range(3):
                share[k, t] = inverse[k, t, 0] * y[k, 0] + inverse[k, t, 1] * y[k, 1] + inverse[k, t, 2] * y[k, 2]
            for t in range(3):
                v = -share[k, t]
                x0 += mixed[k, t, 0] * v
                x1 += mixed[k, t, 1] * v
                x2 += mixed[k, t, 2] * v
                x3 += mixed[k, t, 3] * v
                x4 += mixed[k, t, 4] * v
                x5 += mixed[k, t, 5] * v
                x6 += mixed[k, t, 6] * v
                x7 += mixed[k, t, 7] * v
                x8 += mixed[k, t, 8] * v
        to_bodies(p, Psi, R, axes, a[p], b[p], x0, x1, x2, x3, x4, x5, x6, x7, x8, scale, on_bodies)


@njit(**NO_ALLOCATION)
def substitute(plane, inverse, mixed, xi, share):
    """Turn share (K, 3) into the changes of the planes that go with xi (P, 9)."""
    for p in range(len(plane) - 1):
        for k in range(plane[p], plane[p + 1]):
            m0, m1, m2 = 0.0, 0.0, 0.0
            for i in range(9):
                m0 += mixed[k, 0, i] * xi[p, i]
                m1 += mixed[k, 1, i] * xi[p, i]
                m2 += mixed[k, 2, i] * xi[p, i]
            for t in range(3):
                share[k, t] -= inverse[k, t, 0] * m0 + inverse[k, t, 1] * m1 + inverse[k, t, 2] * m2
