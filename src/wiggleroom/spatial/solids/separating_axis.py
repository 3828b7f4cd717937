"""How far two convex pieces are apart along the best of all axes that can part them (compiled)."""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import OPTIONS, njit


@njit(**OPTIONS)
def separation(P, NP, EP, Q, NQ, EQ, axis):
    """Separation of two convex pieces [mm], negative where they overlap; `axis` (3,) becomes the unit axis from P to Q.

    P, Q (k, 3) are corners, NP, NQ normals of faces, EP, EQ directions of edges, all in one frame. The separation along the best axis
    is a lower bound of the distance, and it is positive exactly where the pieces are apart.

    Source: the separating axis theorem, Gottschalk, Lin and Manocha 1996.
    """
    best = -1e300
    x = np.zeros(3)
    nf, ng, ne = len(NP), len(NQ), len(EQ)
    for t in range(nf + ng + len(EP) * ne):
        if t < nf:
            x[:] = NP[t]
        elif t < nf + ng:
            x[:] = NQ[t - nf]
        else:
            e, f = EP[(t - nf - ng) // ne], EQ[(t - nf - ng) % ne]
            x[0] = e[1] * f[2] - e[2] * f[1]
            x[1] = e[2] * f[0] - e[0] * f[2]
            x[2] = e[0] * f[1] - e[1] * f[0]
            length = np.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
            if length < 1e-8:
                continue
            x /= length
        plow, phigh, qlow, qhigh = 1e300, -1e300, 1e300, -1e300
        for i in range(len(P)):
            s = P[i, 0] * x[0] + P[i, 1] * x[1] + P[i, 2] * x[2]
            plow, phigh = min(plow, s), max(phigh, s)
        for i in range(len(Q)):
            s = Q[i, 0] * x[0] + Q[i, 1] * x[1] + Q[i, 2] * x[2]
            qlow, qhigh = min(qlow, s), max(qhigh, s)
        if qlow - phigh > best:
            best = qlow - phigh
            axis[0], axis[1], axis[2] = x[0], x[1], x[2]
        if plow - qhigh > best:
            best = plow - qhigh
            axis[0], axis[1], axis[2] = -x[0], -x[1], -x[2]
    return best


@njit(**OPTIONS)
def distance(P, NP, EP, Q, NQ, EQ, axis, ratio):
    """Distance of two convex pieces [mm], negative where they overlap; `axis` (3,) becomes the normal of the plane with most room.

    Arguments are those of `separation`. Where corners or edges are nearest, their connection has more room than any axis of that theorem:
    it runs from corner to corner, or from there across an edge. Where it has no more than `ratio` times as much, the axis of the theorem
    is kept.
    """
    best = separation(P, NP, EP, Q, NQ, EQ, axis)
    if best <= 0:
        return best
    least, nearest = ratio * best, axis.copy()
    v, w = np.empty(3), np.empty(3)
    ep, eq = len(EP), len(EQ)
    for i in range(len(P)):
        for j in range(len(Q)):
            for k in range(3):
                v[k] = Q[j, k] - P[i, k]
            if v[0] * v[0] + v[1] * v[1] + v[2] * v[2] <= best * best:
                continue
            for t in range(1 + ep + eq):
                w[:] = v
                if t > 0:
                    e = EP[t - 1] if t <= ep else EQ[t - 1 - ep]
                    along = v[0] * e[0] + v[1] * e[1] + v[2] * e[2]
                    for k in range(3):
                        w[k] -= along * e[k]
                length = np.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
                if length <= best:
                    continue
                # the connection parts the pieces at its ends where both are there the foremost corners
                w /= length
                top = P[i, 0] * w[0] + P[i, 1] * w[1] + P[i, 2] * w[2]
                for m in range(len(P)):
                    s = P[m, 0] * w[0] + P[m, 1] * w[1] + P[m, 2] * w[2]
                    if s > top + 1e-9 * length:
                        top = 1e300
                        break
                    top = max(top, s)
                if top == 1e300:
                    continue
                bottom = 1e300
                for m in range(len(Q)):
                    bottom = min(bottom, Q[m, 0] * w[0] + Q[m, 1] * w[1] + Q[m, 2] * w[2])
                if bottom - top > best * (1 + 1e-9):
                    best = bottom - top
                    nearest[:] = w
    if best > least:
        axis[:] = nearest
    return best


@njit(**OPTIONS)
def posed_points(V, R, T):
    """Points V (k, 3) turned by R (3, 3) and moved by T (3,)."""
    out = np.empty_like(V)
    for k in range(len(V)):
        for i in range(3):
            out[k, i] = R[i, 0] * V[k, 0] + R[i, 1] * V[k, 1] + R[i, 2] * V[k, 2] + T[i]
    return out
