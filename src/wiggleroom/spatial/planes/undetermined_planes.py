"""Planes that a contact leaves undetermined: where an edge or corner meets an edge, several planes part the two pieces.

Any of them may carry the force, so an end may be one of the program and none of the motions: a body under a ceiling that is made of two
pieces stops at the seam, with a plane that leans. Where another of these planes lets the motion go on, it was no end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.errors import Stop
from wiggleroom.solve.linear_programming import maximise
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
TRUSTED = 0.005
"""Variables change by no more than this in the linear model [clearances]."""


def past_undetermined_planes(
    program: SeparatingPlaneProgram,
    found: SeparatingPlaneSolution,
    *,
    horizon: float,
    most_turn: float,
    stop: Stop | None,
    progress: Callable[[int, float], None] | None,
) -> tuple[SeparatingPlaneSolution, int]:
    """The solution, or a better one to which other planes lead, all iterates inside all rows; and the number of iterations."""
    iterations = 0
    for _ in range(MAX_ENDS):
        if found.status is not SolverStatus.CONVERGED:
            break
        load = float(np.abs(program.objective.gradient(found.point.pose)).max(initial=0.0))
        least = found.value + GAINED * max(abs(found.value), load * program.length)
        better = None
        for start in undetermined_planes(program, found):
            if stop is not None and stop.is_set():
                break
            if not _ascends(program, start.point):
                continue
            other = SeparatingPlaneSolver(
                program, inside=True, damped=True, horizon=horizon, most_turn=most_turn, stop=stop, progress=progress
            ).solve(start)
            iterations += other.iterations
            if other.status in (SolverStatus.CONVERGED, SolverStatus.ESCAPING) and other.value > least:
                better = other
                break
        if better is None:
            break
        found = better
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
    """The same end with one plane that carries a force turned into that of a face, which parts the two pieces as well."""
    P, pose = program, found.point.pose
    if not P.planes:
        return
    force = np.add.reduceat(found.lam, P.row[:-1])
    tried = 0
    for k in np.argsort(-force, kind="stable").tolist():
        if force[k] <= WEAK * force.max():
            return
        known = [found.point.n[k]]
        for normal, offset in _parting_faces(P, found, k):
            if (np.array(known) @ normal).max() > SAME_NORMAL:
                continue
            if tried == MAX_TRIED:
                return
            tried += 1
            known.append(normal)
            n, d, lam = found.point.n.copy(), found.point.d.copy(), found.lam.copy()
            n[k], d[k], lam[P.row[k] : P.row[k + 1]] = normal, offset, 0.0
            yield CarriedIterate(SeparatingPlanePoint(pose, n, d), lam, found.value, found.path)


def _parting_faces(
    program: SeparatingPlaneProgram, found: SeparatingPlaneSolution, k: int
) -> Iterator[tuple[Floats, float]]:
    """Normals (3,) of faces along which two pieces are apart, and offsets [mm], in the first one's frame."""
    P, pose = program, found.point.pose
    i, pi, j, pj = P.pieces[k].tolist()
    one, other = P.bodies.pieces[i][pi], P.bodies.pieces[j][pj]
    Psi = pose.R[i].T @ pose.R[j]
    corners = other.corners @ Psi.T + pose.R[i].T @ (pose.T[j] - pose.T[i])
    normals = np.vstack([one.normals, other.normals @ Psi.T])
    for normal in np.vstack([normals, -normals]):
        low, high = float((one.corners @ normal).max()), float((corners @ normal).min())
        if high > low:
            yield normal, (low + high) / 2 - float(normal @ P.c[k])
