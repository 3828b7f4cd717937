"""Bodies that lie in a cage: in a closed cavity, or behind windows too narrow for a ball inside them, however they turn.

Source: Rodriguez, Mason and Ferry, "From caging to grasping" (2012), for the term.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wiggleroom.compiled.jit_options import OPTIONS, njit
from wiggleroom.context import UNLIMITED, Context
from wiggleroom.drawing.model import ConvexPiece, Surface
from wiggleroom.spatial.solids.separating_axis import nearest_difference
from wiggleroom.spatial.solids.solid_angle import winding_numbers

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

WIDTHS = (1 / 3, 1 / 6, 1 / 12)
"""Widths of the cubes that cover where the middle of a ball may be, one after the other, as shares of its radius."""
MAX_CUBES = 100_000
"""More are not looked at."""
VISITS = 500
"""So many cubes are looked at before the request to stop is."""
MARGIN = 1e-6
"""A cube is blocked where the ball overlaps a piece by more than this share of the radius, wherever in the cube its middle lies."""
WINDING = 1e-6
"""Rounding leaves a winding number nearer than this to the integer that it is."""
BLOCKED, ESCAPED, UNDECIDED = 0, 1, 2


def in_closed_cavity(surface: Surface, points: Floats) -> bool:
    """True where a shell of a closed surface closes a cavity round one of some points (k, 3) [mm].

    Shells of a solid look outwards, so those of its cavities wind once backwards round what lies inside.

    Examples
    --------
    >>> corners = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    >>> faces = np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])
    >>> hollow = Surface(np.vstack([2 * corners, corners]), np.vstack([faces, faces[:, ::-1] + 6]))
    >>> in_closed_cavity(hollow, np.zeros((1, 3))), in_closed_cavity(hollow, np.array([[1.4, 0.1, 0.0], [3.0, 0.1, 0.2]]))
    (True, False)
    """
    shells = _shells(surface)
    triangles = surface.vertices[surface.faces]
    for k in range(shells.max(initial=-1) + 1):
        shell = triangles[shells == k]
        if len(shell) == len(triangles):
            break  # the only shell is the outer one
        if (np.abs(winding_numbers(shell, points) + 1) < WINDING).any():
            return True
    return False


def _shells(surface: Surface) -> Ints:
    """Which connected shell each face (f,) belongs to."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    a, b, c = surface.faces.T
    ends = np.concatenate([a, b]), np.concatenate([b, c])
    count = len(surface.vertices)
    of_vertex = connected_components(coo_array((np.ones(len(ends[0])), ends), (count, count)), directed=False)[1]
    return np.asarray(np.unique(of_vertex[a], return_inverse=True)[1])


def ball_stays(pieces: Sequence[ConvexPiece], middle: Floats, radius: float, context: Context = UNLIMITED) -> bool:
    """True where a ball, not overlapping convex pieces at rest, never gets out of the box round them.

    Cubes cover where its middle may be. Those of them that lie inside a piece made larger by the radius are blocked; convex sets hold a
    cube where they hold its corners. What is reached through the others from rest is closed in, or leads out.

    Examples
    --------
    >>> from wiggleroom.spatial.solids.convex import cuboid
    >>> sides = [((-3, -3, -3), (3, 3, -2)), ((-3, -3, -2), (-2, 3, 3)), ((2, -3, -2), (3, 3, 3)), ((-2, -3, -2), (2, -2, 3))]
    >>> box = [cuboid(*np.array(side, dtype=float)) for side in [*sides, ((-2, 2, -2), (2, 3, 3))]]
    >>> lid = cuboid(np.array([-1.5, -3, 3]), np.array([3.0, 3, 4]))
    >>> ball_stays(box, np.zeros(3), 1.0), ball_stays([*box, lid], np.zeros(3), 1.0)
    (False, True)
    """
    corners = np.vstack([p.corners for p in pieces])
    low, high = corners.min(axis=0) - radius, corners.max(axis=0) + radius
    if not ((middle > low) & (middle < high)).all():
        return False
    packed = (
        np.ascontiguousarray(corners), np.cumsum([0, *(len(p.corners) for p in pieces)]),
        np.ascontiguousarray(np.vstack([p.normals for p in pieces])), np.cumsum([0, *(len(p.normals) for p in pieces)]),
    )  # fmt: skip
    for share in WIDTHS:
        width = share * radius
        before, after = np.ceil((middle - low) / width), np.ceil((high - middle) / width)
        count = (before + after + 1).astype(np.int64)
        if count.astype(float).prod() > 50 * MAX_CUBES:
            return False
        seen = np.zeros(tuple(count), dtype=np.bool_)
        start = before.astype(np.int64)
        seen[tuple(start)] = True
        stack = np.empty((MAX_CUBES, 3), dtype=np.int64)
        stack[0] = start
        state = np.array([1, 1], dtype=np.int64)  # open cubes, cubes seen
        ended = UNDECIDED
        while ended == UNDECIDED and state[1] < MAX_CUBES:
            if context.stopped:
                return False
            ended = flood(*packed, middle - start * width, width, radius * (1 - MARGIN), seen, stack, state, VISITS)
        if ended == BLOCKED:
            return True
    return False


@njit(**OPTIONS)
def flood(corners, begin, normals, first, origin, width, radius, seen, stack, state, visits):
    """Go on through cubes that are not blocked: `BLOCKED` once all are seen, `ESCAPED` at the rim, else `UNDECIDED` after some visits."""
    near = np.empty(3, np.int64)
    for _ in range(visits):
        if state[0] == 0:
            return BLOCKED
        state[0] -= 1
        here = stack[state[0]].copy()
        for side in range(6):
            near[:] = here
            near[side // 2] += 1 - 2 * (side % 2)
            i, j, k = near[0], near[1], near[2]
            if min(i, j, k) < 0 or i >= seen.shape[0] or j >= seen.shape[1] or k >= seen.shape[2]:
                return ESCAPED
            if seen[i, j, k]:
                continue
            seen[i, j, k] = True
            if cube_blocked(corners, begin, normals, first, origin + near * width, width / 2, radius):
                continue
            if state[1] >= len(stack):
                return UNDECIDED
            stack[state[0]] = near
            state[0] += 1
            state[1] += 1
    return UNDECIDED


@njit(**OPTIONS)
def cube_blocked(corners, begin, normals, first, middle, half, radius):
    """True where all points of a cube are nearer to one convex piece than the radius."""
    corner = np.empty(3)
    diagonal = np.sqrt(3.0) * half
    for p in range(len(begin) - 1):
        P, N = corners[begin[p] : begin[p + 1]], normals[first[p] : first[p + 1]]
        far = distance_above(P, N, middle)
        if far + diagonal < radius:
            return True
        if far >= radius + diagonal:
            continue
        inside = True
        for k in range(8):
            for i in range(3):
                corner[i] = middle[i] + half * (1 - 2 * ((k >> i) & 1))
            if distance_above(P, N, corner) >= radius:
                inside = False
                break
        if inside:
            return True
    return False


@njit(**OPTIONS)
def distance_above(P, N, point):
    """Distance of a point from a convex piece [mm], or a little more; 0 inside."""
    axis, best = np.zeros(3), 0.0
    for k in range(len(N)):
        low, high = 1e300, -1e300
        for i in range(len(P)):
            s = P[i, 0] * N[k, 0] + P[i, 1] * N[k, 1] + P[i, 2] * N[k, 2]
            low, high = min(low, s), max(high, s)
        s = point[0] * N[k, 0] + point[1] * N[k, 1] + point[2] * N[k, 2]
        if s - high > best:
            best = s - high
            axis[:] = N[k]
        if low - s > best:
            best = low - s
            axis[:] = -N[k]
    if best == 0.0:
        return 0.0
    nearest = nearest_difference(P, point.reshape(1, 3), axis)
    return np.sqrt(nearest[0] ** 2 + nearest[1] ** 2 + nearest[2] ** 2)
