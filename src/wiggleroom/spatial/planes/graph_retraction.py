"""Steps of bodies and planes that respect rotation."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from wiggleroom.program.retraction import LinearSolver, factorised
from wiggleroom.spatial.bodies.rigid import SpatialPose
from wiggleroom.spatial.bodies.rotations import exponential
from wiggleroom.spatial.planes import plane_fitting
from wiggleroom.spatial.planes.separating_plane_program import (
    LinearisedSeparatingPlanes,
    SeparatingPlanePoint,
    SeparatingPlaneProgram,
)

Floats = NDArray[np.float64]


class GraphRetraction:
    """Steps that respect rotation: bodies turn, and are placed so that neighbours see each other as the step foresaw.

    Planes then follow so that rows come near to what was foreseen. The least-squares placement is that of the planar
    `wiggleroom.program.retraction`.
    """

    ANCHOR = 1e-9

    def __init__(self, program: SeparatingPlaneProgram) -> None:
        P = program
        self._program = P
        self._moving = np.flatnonzero((P.slot[:, :3] >= 0).any(axis=1))
        place = np.full(len(P.slot), -1)
        place[self._moving] = np.arange(len(self._moving))
        pairs = np.arange(len(P.a))
        rows, cols, vals = [], [], []
        for body, sign in ((P.a, -1.0), (P.b, 1.0)):
            keep = place[body] >= 0
            rows.append(pairs[keep])
            cols.append(place[body][keep])
            vals.append(np.full(int(keep.sum()), sign))
        shape = (len(pairs), len(self._moving))
        edges = sp.csr_matrix((np.concatenate(vals), (np.concatenate(rows), np.concatenate(cols))), shape=shape)
        radius = P.bodies.radius
        reach = radius[P.a] + radius[P.b]
        typical = float(np.median(reach)) if len(reach) else 1.0
        weight = (
            1.0 / np.maximum(reach / (2 * typical), 0.5) ** 4
        )  # neighbours that reach far say little about where a body goes
        self._weight, self._edges, self._ends = weight, edges, sp.csr_matrix(edges.T.multiply(weight))
        self._open = P.slot[self._moving, :3] >= 0
        self._laplacian: LinearSolver | None = None
        if len(self._moving):
            laplacian = sp.triu(self._ends @ edges + self.ANCHOR * sp.eye(shape[1]), format="coo")
            self._laplacian = factorised(
                laplacian.row.astype(np.int64), laplacian.col.astype(np.int64), laplacian.data, shape[1]
            )

    def placed(self, T: Floats, R: Floats, q: Floats) -> Floats:
        """Positions near T (n, 3) in which every pair is seen at q (P, 3) as nearly as can be."""
        P = self._program
        if self._laplacian is None:
            return T
        wanted = np.einsum("pij,pj->pi", R[P.a], q) - (T[P.b] - T[P.a])
        T = T.copy()
        T[self._moving] += _solved(self._laplacian, self._ends @ wanted) * self._open
        return T

    def bodies(self, at: LinearisedSeparatingPlanes, u: Floats, share: float) -> SpatialPose:
        """Pose after `share` of the step u (V,)."""
        pose, change = at.point.pose, at.change(share * u)
        R = pose.R @ exponential(change[:, 3:])
        xi = at.seen(share * u)
        q = at.q + xi[:, :3] - np.cross(xi[:, 3:6], at.q)
        return SpatialPose(self.placed(pose.T + change[:, :3], R, q), R)

    def step(
        self,
        at: LinearisedSeparatingPlanes,
        u: Floats,
        y: Floats,
        share: float,
        goal: Floats | None = None,
        weight: Floats | None = None,
    ) -> SeparatingPlanePoint:
        """Point after `share` of the step (u, y); with `goal` (R,) and `weight` (R,) the planes follow."""
        P = self._program
        pose = self.bodies(at, u, share)
        n, d = np.empty_like(at.point.n), np.empty_like(at.point.d)
        plane_fitting.move_planes(at.point.n, at.point.d, P.lever, P.length * y, share, np.empty((2, 3)), n, d)
        if goal is not None and weight is not None:
            q, Psi = P.frames(pose)
            plane_fitting.fit_planes(
                q,
                Psi,
                P.plane,
                P.row,
                P.own,
                P.V,
                P.c,
                P.lever,
                P.length * goal,
                weight,
                3,
                np.empty((8, 12, 12)),
                n,
                d,
            )
        return SeparatingPlanePoint(pose, n, d)

    def balance(self, residual: Floats, at: LinearisedSeparatingPlanes) -> Floats:
        """Forces on B (P, 3), in A's frame, that bring the forces of the rows into balance with the objective."""
        P = self._program
        if self._laplacian is None:
            return np.zeros((len(P.a), 3))
        x = np.zeros(P.slot.shape)
        open_ = P.slot >= 0
        x[open_] = residual / P.scale[open_]
        world = self._weight[:, None] * (self._edges @ _solved(self._laplacian, x[self._moving, :3]))
        return np.einsum("pji,pj->pi", at.point.pose.R[P.a], world)


def _solved(laplacian: LinearSolver, right: Floats) -> Floats:
    """Solution for each of three right-hand sides (n, 3)."""
    return np.column_stack([laplacian.solve(np.ascontiguousarray(right[:, k])) for k in range(3)])
