"""What a round of the program begins with where pairs of pieces join it: the end of the round before."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wiggleroom.spatial.bodies.rigid import SpatialPose
from wiggleroom.spatial.planes.separating_plane_newton import CarriedIterate
from wiggleroom.spatial.planes.separating_plane_program import SeparatingPlanePoint, SeparatingPlaneProgram, best_axis
from wiggleroom.spatial.planes.separating_plane_solver import SeparatingPlaneSolution

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def carried_iterate(
    program: SeparatingPlaneProgram, before: SeparatingPlaneProgram, found: SeparatingPlaneSolution
) -> CarriedIterate:
    """The end of a round, for a program that has the same planes and more from the same rest."""
    known = {tuple(who): k for k, who in enumerate(before.pieces.tolist())}
    old = np.array([known.get(tuple(who), -1) for who in program.pieces.tolist()], dtype=np.int64)
    lam = np.zeros(program.rows)
    for k in np.flatnonzero(old >= 0).tolist():
        lam[program.row[k] : program.row[k + 1]] = found.lam[before.row[old[k]] : before.row[old[k] + 1]]
    path = []
    for waypoint in found.path:
        point, apart = _with_joined(program, waypoint, old)
        if apart <= 0:
            break
        path.append(point)
    return CarriedIterate(_with_joined(program, found.point, old)[0], lam, found.value, tuple(path))


def _with_joined(
    program: SeparatingPlaneProgram, point: SeparatingPlanePoint, old: Ints
) -> tuple[SeparatingPlanePoint, float]:
    """A point of the round before with planes for the pieces that joined, and the least distance of these [mm]."""
    P, pose = program, point.pose
    n, d, least = point.n[old], point.d[old], np.inf
    for k in np.flatnonzero(old < 0).tolist():
        n[k], d[k], apart = _best_plane(P, pose, k)
        least = min(least, apart)
    return SeparatingPlanePoint(pose, n, d), least


def _best_plane(program: SeparatingPlaneProgram, pose: SpatialPose, k: int) -> tuple[Floats, float, float]:
    """Normal (3,) and offset [mm] of the plane that parts two pieces best, and their distance [mm], negative where they overlap."""
    axis = np.empty(3)
    apart, other = best_axis(program.bodies, pose, program.pieces[k].tolist(), axis)
    return axis, float((other @ axis).min()) - apart / 2 - float(axis @ program.c[k]), apart
