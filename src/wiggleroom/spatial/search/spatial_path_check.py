"""The path from rest: waypoints of the solver, and more between them until every piece of the path is checked."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.solve.factorisation import factor
from wiggleroom.spatial.bodies.rigid import RigidBodies, SpatialPose, boxes_of
from wiggleroom.spatial.bodies.rotations import exponential, logarithm
from wiggleroom.spatial.overlaps.swept_check import stay_apart
from wiggleroom.spatial.planes import plane_fitting
from wiggleroom.spatial.planes.graph_retraction import GraphRetraction
from wiggleroom.spatial.planes.separating_plane_newton import SeparatingPlaneSystem
from wiggleroom.spatial.planes.separating_plane_program import (
    SeparatingPlanePoint,
    SeparatingPlaneProgram,
    parted,
)

if TYPE_CHECKING:
    from wiggleroom.spatial.search.spatial_prepare import SpatialPrepared


Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MAX_HALVINGS = 9
"""A piece of a path is halved at most this many times."""
MAX_STRAIN = 1e-5
"""Glued parts shift against each other by at most this share of the size between two waypoints."""
OPPOSITE = 1e-6
"""Normals whose sum is shorter look away from each other: a plane has turned over, as where pieces went through each other."""
MAX_LIFTS, ENOUGH_LIFT = 6, 0.2
"""Corrections of a point half way, until no row is below this share of the mean of both ends."""


def free_path(
    ready: SpatialPrepared, program: SeparatingPlaneProgram, points: Sequence[SeparatingPlanePoint]
) -> tuple[Floats, bool]:
    """Motions (k, n, 6) of the parts along a path through legal points, as far as every piece of it is free.

    Returns
    -------
    (k, n, 6) float64 [mm, rad]
        From rest.
    bool
        True where the path goes to the last point.
    """
    retraction = GraphRetraction(program)
    motions = [ready.grouping.part_motion(points[0].pose)]
    for one, other in itertools.pairwise(points):
        if not _join(ready, retraction, program, one, other, motions, MAX_HALVINGS):
            return np.array(motions), False
    return np.array(motions), True


def _join(
    ready: SpatialPrepared,
    retraction: GraphRetraction,
    program: SeparatingPlaneProgram,
    one: SeparatingPlanePoint,
    other: SeparatingPlanePoint,
    motions: list[Floats],
    left: int,
) -> bool:
    """Add motions from one point to another; False, with those as far as it is free, where that fails."""
    end = ready.grouping.part_motion(other.pose)
    rigid = ready.grouping.strain(motions[-1], end) <= MAX_STRAIN * ready.size
    if rigid and not ready.checker.overlaps(motions[-1], end):
        motions.append(end)
        return True
    if left == 0:
        return False
    middle = halfway(retraction, program, one, other)
    if middle is None:
        return False
    return all(
        _join(ready, retraction, program, start, stop, motions, left - 1)
        for start, stop in ((one, middle), (middle, other))
    )


def halfway(
    retraction: GraphRetraction, program: SeparatingPlaneProgram, one: SeparatingPlanePoint, other: SeparatingPlanePoint
) -> SeparatingPlanePoint | None:
    """A legal point half way between two: middle turns, every pair seen half way between; None where none is found."""
    P = program
    R = one.pose.R @ exponential(logarithm(np.einsum("nji,njk->nik", one.pose.R, other.pose.R)) / 2)
    q = (P.frames(one.pose)[0] + P.frames(other.pose)[0]) / 2
    T = retraction.placed((one.pose.T + other.pose.T) / 2, R, q)
    pose = SpatialPose(T, R)
    n = one.n + other.n
    length = np.linalg.norm(n, axis=1)
    if length.min(initial=1.0) < OPPOSITE:
        return None
    n, d = n / length[:, None], (one.d + other.d) / 2
    goal = (P.values(one) + P.values(other)) / 2 * P.length
    q, Psi = P.frames(pose)
    weight = 1 / np.maximum(goal, 1e-14) ** 2
    plane_fitting.fit_planes(
        q, Psi, P.plane, P.row, P.own, P.V, P.c, P.lever, goal, weight, 5, np.empty((8, 12, 12)), n, d
    )
    point = _lifted(retraction, P, SeparatingPlanePoint(pose, n, d), goal / P.length)
    h = P.values(point)
    if h.min(initial=np.inf) <= 0:
        point = parted(P, point, h)
    return point if P.values(point).min(initial=np.inf) > 0 else None


def _lifted(
    retraction: GraphRetraction, program: SeparatingPlaneProgram, point: SeparatingPlanePoint, goal: Floats
) -> SeparatingPlanePoint:
    """The point with bodies and planes moved so that rows come near to `goal` (R,): Gauss-Newton, in relative terms."""
    system = SeparatingPlaneSystem(factor(program.pattern), retraction)
    weight = 1 / np.maximum(goal, 1e-13) ** 2
    at = program.linearise(point)
    for _ in range(MAX_LIFTS):
        if (at.h > ENOUGH_LIFT * goal).all():
            break
        if not system.set_least_squares(at, weight):
            break
        du, dy = system.correction(np.where(at.h > goal, 0.0, goal - at.h))
        if not np.isfinite(du).all():
            break
        ahead = program.linearise(retraction.step(at, du, dy, 1.0))
        if (ahead.h / goal).min(initial=np.inf) <= (at.h / goal).min(initial=np.inf):
            break
        at = ahead
    return at.point


def passing_pairs(bodies: RigidBodies, path: Sequence[SpatialPose]) -> Ints:
    """Pairs of pieces (k, 4) as body a, piece of a, body b, piece of b, that may meet between two poses of a path.

    Positions of the reference points go straight, turns about one constant axis.
    """
    body = np.repeat(np.arange(len(bodies.pieces)), [len(pieces) for pieces in bodies.pieces])
    piece = np.concatenate([np.arange(len(pieces)) for pieces in bodies.pieces])
    corners, _, first = bodies.corners
    radius = np.maximum.reduceat(np.linalg.norm(corners, axis=1), first)
    found: set[tuple[int, int, int, int]] = set()
    for start, end in itertools.pairwise(path):
        turn = logarithm(np.einsum("nji,njk->nik", start.R, end.R))
        angle = np.minimum(np.linalg.norm(turn, axis=1), np.pi)[body]
        bulge = (radius * (1 - np.cos(angle / 2)))[:, None]  # how far an arc leaves its chord
        (low0, high0), (low1, high1) = boxes_of(bodies, start), boxes_of(bodies, end)
        low, high = np.minimum(low0, low1) - bulge, np.maximum(high0, high1) + bulge
        flat = shapely.box(*low[:, :2].T, *high[:, :2].T)
        one, other = shapely.STRtree(flat).query(flat)
        meets = (low[one, 2] <= high[other, 2]) & (low[other, 2] <= high[one, 2])
        moves = bodies.moves[body[one]] | bodies.moves[body[other]]
        near = np.flatnonzero((body[one] < body[other]) & moves & meets)
        for i, j in zip(one[near].tolist(), other[near].tolist(), strict=True):
            a, b, k, m = int(body[i]), int(body[j]), int(piece[i]), int(piece[j])
            if (a, k, b, m) in found or bodies.may_overlap(a, k, b, m):
                continue
            P, Q = bodies.pieces[a][k], bodies.pieces[b][m]
            apart = stay_apart(
                P.corners, P.normals, P.edges, Q.corners, Q.normals, Q.edges,
                start.T[a], end.T[a], start.R[a], turn[a], start.T[b], end.T[b], start.R[b], turn[b],
            )  # fmt: skip
            if not apart:
                found.add((a, k, b, m))
    return np.array(sorted(found), dtype=np.int64).reshape(-1, 4)
