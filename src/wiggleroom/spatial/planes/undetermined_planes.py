"""Planes that a contact leaves undetermined: where an edge or corner meets an edge, several planes part the two pieces.

Any of them may carry the force, so an end may be one of the program and none of the motions: a body under a ceiling that is made of two
pieces stops at the seam, with a plane that leans. Where another of these planes lets the motion go on, it was no end.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.context import Context
from wiggleroom.solve.linear_programming import maximise
from wiggleroom.spatial.bodies.rigid import SpatialPose
from wiggleroom.spatial.planes.separating_plane_newton import CarriedIterate
from wiggleroom.spatial.planes.separating_plane_program import SeparatingPlanePoint, SeparatingPlaneProgram
from wiggleroom.spatial.planes.separating_plane_solver import SeparatingPlaneSolution, SeparatingPlaneSolver
from wiggleroom.verdict import SolverStatus

Floats = NDArray[np.float64]

WEAK = 1e-5
"""Planes with less than this share of the largest force are not looked at."""
SAME_NORMAL = 0.99
"""Normals whose cosine is larger are not tried one after the other."""
MAX_TRIED, MAX_ENDS = 6, 8
"""Number of planes that are tried at an end, and of ends after each other, at most."""
GAINED = 1e-5
"""Other planes lead further where they bring more than this share of the value, or of what a clearance brings."""
TOUCHING = 1e-4
"""Pieces that overlap along a face by no more than this touch there [clearances]."""
MAX_BACK = 20
"""Waypoints before the end that are looked at for one where they do not overlap, at most."""
TURNED_MU = (1e-4, 0.03)
"""Barrier parameters with which the climb goes on, as `carried_mu` of the settings, one after the other: a large one may turn the plane
back, with a small one it may not get away from where it begins."""
TRUSTED = 0.005
"""Variables change by no more than this in the linear model [clearances]."""


def past_undetermined_planes(
    program: SeparatingPlaneProgram,
    found: SeparatingPlaneSolution,
    *,
    horizon: float,
    most_turn: float,
    context: Context,
) -> tuple[SeparatingPlaneSolution, int]:
    """The solution, or a better one to which other planes lead, all iterates inside all rows; and the number of iterations.

    Where one leads further to no end, that is the solution, and it is none: what it began at was no end either.
    """
    iterations = 0
    for _ in range(MAX_ENDS):
        if found.status is not SolverStatus.CONVERGED:
            break
        load = float(np.abs(program.objective.gradient(found.point.pose)).max(initial=0.0))
        least = found.value + GAINED * max(abs(found.value), load * program.length)
        better = unsettled = None
        starts = (start for start in undetermined_planes(program, found) if _ascends(program, start.point))
        for start, mu in ((start, mu) for start in starts for mu in TURNED_MU):
            if context.stopped:
                break
            other = SeparatingPlaneSolver(
                program,
                inside=True,
                damped=True,
                horizon=horizon,
                most_turn=most_turn,
                stop=context.stop,
                progress=context.progress,
            ).solve(start, mu)
            iterations += other.iterations
            if other.value > least:
                if other.status in (SolverStatus.CONVERGED, SolverStatus.ESCAPING):
                    better = other
                    break
                unsettled = other
        found = better or unsettled or found
        if better is None:
            break
    return found, iterations


def _ascends(program: SeparatingPlaneProgram, point: SeparatingPlanePoint) -> bool:
    """True where a small change raises the objective to first order, by more than `GAINED` of what a clearance brings: a linear program."""
    at = program.linearise(point)
    near = np.flatnonzero(at.h < 12 * TRUSTED * np.abs(at.G).max(axis=1))
    plane = np.repeat(np.arange(program.planes), np.diff(program.row))[near]
    pair = np.repeat(np.arange(len(program.a)), np.diff(program.plane))[plane]
    loaded, column = np.unique(plane, return_inverse=True)
    seen = np.stack([at.seen(unit) for unit in np.eye(len(at.gradient))], axis=2)
    by_bodies = np.einsum("ki,kiv->kv", at.G[near, :9], seen[pair])
    by_planes = sp.csr_matrix(
        (at.G[near, 9:].ravel(), (3 * column.reshape(-1, 1) + np.arange(3)).ravel(), 3 * np.arange(len(near) + 1)),
        shape=(len(near), 3 * len(loaded)),
    )
    cost = np.concatenate([at.gradient, np.zeros(3 * len(loaded))])
    rows = sp.hstack([sp.csr_matrix(by_bodies), by_planes], format="csr")
    found = maximise(cost, rows, -at.h[near], np.full(len(cost), TRUSTED))
    return found.x is None or float(cost @ found.x) > GAINED * np.abs(at.gradient).max()


def undetermined_planes(program: SeparatingPlaneProgram, found: SeparatingPlaneSolution) -> Iterator[CarriedIterate]:
    """The same end with one plane that carries a force turned into that of a face, which parts the two pieces as well.

    Where the pieces touch along the face they overlap by a rounding: then the last waypoint at which they do not stands for the end.
    """
    P = program
    if not P.planes:
        return
    force = np.add.reduceat(found.lam, P.row[:-1])
    tried = 0
    for k in np.argsort(-force, kind="stable").tolist():
        if force[k] <= WEAK * force.max():
            return
        known = [found.point.n[k]]
        normals, _, apart = _along_faces(P, found.point.pose, k)
        for face in np.flatnonzero(apart > -TOUCHING * P.length).tolist():
            if (np.array(known) @ normals[face]).max() > SAME_NORMAL:
                continue
            if tried == MAX_TRIED:
                return
            start = _turned(P, found, k, face)
            if start is not None:
                tried += 1
                known.append(normals[face])
                yield start


def _turned(
    program: SeparatingPlaneProgram, found: SeparatingPlaneSolution, k: int, face: int
) -> CarriedIterate | None:
    """The last of the waypoints before the end at which a face's plane parts two pieces, with that plane; None where none does."""
    for last in range(len(found.path), max(len(found.path) - MAX_BACK, 0), -1):
        point = found.path[last - 1]
        normals, offsets, apart = _along_faces(program, point.pose, k)
        if apart[face] > 0:
            n, d, lam = point.n.copy(), point.d.copy(), found.lam.copy()
            n[k], d[k], lam[program.row[k] : program.row[k + 1]] = normals[face], offsets[face], 0.0
            turned = SeparatingPlanePoint(point.pose, n, d)
            return CarriedIterate(turned, lam, found.value, (*found.path[: last - 1], turned))
    return None


def _along_faces(program: SeparatingPlaneProgram, pose: SpatialPose, k: int) -> tuple[Floats, Floats, Floats]:
    """Normals (m, 3) of the faces of two pieces in the first one's frame, offsets (m,) and how far these are apart along them (m,) [mm]."""
    P = program
    i, pi, j, pj = P.pieces[k].tolist()
    one, other = P.bodies.pieces[i][pi], P.bodies.pieces[j][pj]
    Psi = pose.R[i].T @ pose.R[j]
    corners = other.corners @ Psi.T + pose.R[i].T @ (pose.T[j] - pose.T[i])
    normals = np.vstack([one.normals, other.normals @ Psi.T])
    normals = np.vstack([normals, -normals])
    low, high = (one.corners @ normals.T).max(axis=0), (corners @ normals.T).min(axis=0)
    return normals, (low + high) / 2 - normals @ P.c[k], high - low
