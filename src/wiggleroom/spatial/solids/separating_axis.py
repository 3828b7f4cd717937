"""How far two convex pieces are apart along the best of all axes that can part them (compiled)."""

from __future__ import annotations

import numpy as np

from wiggleroom.compiled.jit_options import OPTIONS, njit

PARALLEL = 1e-8
"""Edges whose unit vectors have a shorter product are parallel."""
MANY_PRODUCTS = 256
"""Of pieces with more products of two edges the line between nearest points is tried first."""


@njit(**OPTIONS)
def candidate_axes(NP, EP, NQ, EQ):
    """Unit axes (m, 3) of which one parts two convex pieces, if any does: normals of faces of either, and products of an edge of each.

    Source: the separating axis theorem, Gottschalk, Lin and Manocha 1996.
    """
    count = len(NP) + len(NQ)
    x = np.empty((count + len(EP) * len(EQ), 3))
    x[: len(NP)] = NP
    x[len(NP) : count] = NQ
    for e in EP:
        for f in EQ:
            a = e[1] * f[2] - e[2] * f[1]
            b = e[2] * f[0] - e[0] * f[2]
            c = e[0] * f[1] - e[1] * f[0]
            length = np.sqrt(a * a + b * b + c * c)
            if length >= PARALLEL:
                x[count, 0], x[count, 1], x[count, 2] = a / length, b / length, c / length
                count += 1
    return x[:count]


@njit(**OPTIONS)
def extent(V, x):
    """The range of points V (k, 3) along x."""
    low, high = 1e300, -1e300
    for i in range(len(V)):
        s = V[i, 0] * x[0] + V[i, 1] * x[1] + V[i, 2] * x[2]
        low, high = min(low, s), max(high, s)
    return low, high


@njit(**OPTIONS)
def separation(P, NP, EP, Q, NQ, EQ, axis):
    """Separation of two convex pieces [mm], negative where they overlap; `axis` (3,) becomes the unit axis from P to Q.

    P, Q (k, 3) are corners, NP, NQ normals of faces, EP, EQ directions of edges, all in one frame. The separation along the best axis
    is a lower bound of the distance, and it is positive exactly where the pieces are apart. Corners off the planes of their faces, by
    rounding, may hide that from these axes: where they overlap by hardly anything the line between nearest points is tried too. Of many
    edges not all products are tried where that line parts the pieces.

    Source: the separating axis theorem, Gottschalk, Lin and Manocha 1996.
    """
    if len(EP) * len(EQ) > MANY_PRODUCTS:
        nearest = nearest_difference(P, Q, Q[0] - P[0])
        room = _room(P, Q, nearest)
        if room > 0:
            axis[:] = nearest
            return room
    best = -1e300
    for x in candidate_axes(NP, EP, NQ, EQ):
        plow, phigh = extent(P, x)
        qlow, qhigh = extent(Q, x)
        if qlow - phigh > best:
            best = qlow - phigh
            axis[0], axis[1], axis[2] = x[0], x[1], x[2]
        if plow - qhigh > best:
            best = plow - qhigh
            axis[0], axis[1], axis[2] = -x[0], -x[1], -x[2]
    if best > 0 or best < -HARDLY * _farthest(P, Q):
        return best
    nearest = nearest_difference(P, Q, axis)
    room = _room(P, Q, nearest)
    if room > best:
        axis[:] = nearest
    return max(room, best)


@njit(**OPTIONS)
def _along_normals(P, NP, Q, NQ, axis):
    """Room between two pieces along the best of the normals of their faces [mm], which `axis` (3,) becomes."""
    best = -1e300
    for normals in (NP, NQ):
        for x in normals:
            plow, phigh = extent(P, x)
            qlow, qhigh = extent(Q, x)
            if qlow - phigh > best:
                best = qlow - phigh
                axis[:] = x
            if plow - qhigh > best:
                best = plow - qhigh
                axis[:] = -x
    return best


HARDLY = 1e-7
"""An overlap smaller than this share of how far corners lie apart may be rounding."""


@njit(**OPTIONS)
def _farthest(P, Q):
    """Largest distance of a corner of Q from the first of P [mm]."""
    far = 0.0
    for k in range(len(Q)):
        v = Q[k] - P[0]
        far = max(far, _dot(v, v))
    return np.sqrt(far)


@njit(**OPTIONS)
def distance(P, NP, EP, Q, NQ, EQ, axis, ratio):
    """Distance of two convex pieces [mm], negative where they overlap; `axis` (3,) becomes the normal of the plane with most room.

    Arguments are those of `separation`. Where corners or edges are nearest, the line between the nearest points has more room than any
    axis of that theorem. Where it has no more than `ratio` times as much, the axis of the theorem is kept.
    """
    best = separation(P, NP, EP, Q, NQ, EQ, axis)
    if best <= 0:
        return best
    if len(EP) * len(EQ) > MANY_PRODUCTS:
        flat = np.empty(3)
        if ratio > 1 and best <= ratio * _along_normals(P, NP, Q, NQ, flat):
            axis[:] = flat
        return best
    nearest = nearest_difference(P, Q, axis)
    room = _room(P, Q, nearest)
    if room <= best * (1 + 1e-9):
        return best
    if room > ratio * best:
        axis[:] = nearest
    return room


MAX_SIMPLICES = 100
"""The nearest points are found after a dozen simplices; rounding may turn in a circle."""
NEAREST = 1e-12
"""Nothing is looked for that comes nearer by less than this share."""


@njit(**OPTIONS)
def nearest_difference(P, Q, axis):
    """Of all q - p, with p and q in two convex pieces that are apart along an axis, the one nearest to the origin [mm].

    Source: Gilbert, Johnson and Keerthi, "A fast procedure for computing the distance between complex objects" (1988).
    """
    simplex, count = np.empty((4, 3)), 0
    v = _foremost(P, Q, axis)
    for _ in range(MAX_SIMPLICES):
        w = _foremost(P, Q, v)
        if _dot(v, v) - _dot(v, w) <= NEAREST * _dot(v, v):
            break
        simplex[count] = w
        nearer, count = _nearest_in_simplex(simplex, count + 1)
        if _dot(nearer, nearer) >= _dot(v, v) and count > 1:
            break
        v = nearer
    return v


@njit(**OPTIONS)
def _room(P, Q, x):
    """Room between two pieces along x [mm], which becomes a unit vector; -inf where it has no length."""
    length = np.sqrt(_dot(x, x))
    if length == 0:
        return -np.inf
    x /= length
    return _dot(_foremost(P, Q, x), x)


@njit(**OPTIONS)
def _foremost(P, Q, x):
    """The corner of all q - p that is foremost against x."""
    i, j, high, low = 0, 0, -1e300, 1e300
    for k in range(len(P)):
        s = P[k, 0] * x[0] + P[k, 1] * x[1] + P[k, 2] * x[2]
        if s > high:
            i, high = k, s
    for k in range(len(Q)):
        s = Q[k, 0] * x[0] + Q[k, 1] * x[1] + Q[k, 2] * x[2]
        if s < low:
            j, low = k, s
    return Q[j] - P[i]


@njit(**OPTIONS)
def _nearest_in_simplex(simplex, count):
    """The point of a simplex (4 corners at most) nearest to the origin, which lies outside; its face becomes the simplex."""
    best, size, kept = 1e300, 0, np.zeros(3, np.int64)
    found = np.zeros(3)
    for i in range(count):
        a = simplex[i]
        if _dot(a, a) < best:
            best, size, found = _dot(a, a), 1, a.copy()
            kept[0] = i
        for j in range(i):
            e = simplex[j] - a
            ee = _dot(e, e)
            t = -_dot(a, e) / ee if ee > 0 else -1.0
            if 0 < t < 1:
                x = a + t * e
                if _dot(x, x) < best:
                    best, size, found = _dot(x, x), 2, x
                    kept[0], kept[1] = i, j
            for k in range(j):
                f = simplex[k] - a
                ef, ff = _dot(e, f), _dot(f, f)
                determinant = ee * ff - ef * ef
                if determinant <= 1e-14 * ee * ff:
                    continue
                s = (ef * _dot(a, f) - ff * _dot(a, e)) / determinant
                t = (ef * _dot(a, e) - ee * _dot(a, f)) / determinant
                if s > 0 and t > 0 and s + t < 1:
                    x = a + s * e + t * f
                    if _dot(x, x) < best:
                        best, size, found = _dot(x, x), 3, x
                        kept[0], kept[1], kept[2] = i, j, k
    corners = simplex[kept[:size]].copy()
    simplex[:size] = corners
    return found, size


@njit(**OPTIONS)
def _dot(x, y):
    return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]


@njit(**OPTIONS)
def posed_points(V, R, T):
    """Points V (k, 3) turned by R (3, 3) and moved by T (3,)."""
    out = np.empty_like(V)
    for k in range(len(V)):
        for i in range(3):
            out[k, i] = R[i, 0] * V[k, 0] + R[i, 1] * V[k, 1] + R[i, 2] * V[k, 2] + T[i]
    return out
