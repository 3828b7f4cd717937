"""The program over bodies and planes: every two near convex pieces are parted by a plane that is a variable itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from wiggleroom.spatial.bodies.rigid import RigidBodies, SpatialPose
from wiggleroom.spatial.bodies.rotations import exponential
from wiggleroom.spatial.planes import separating_plane_constraints as kernel
from wiggleroom.spatial.planes.separating_plane_elimination import condensed
from wiggleroom.spatial.solids.separating_axis import distance, posed_points

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

DISTANCE_RATIO = 4 / 3
"""A plane begins across the line between the nearest points where these are so many times further apart than along any normal of a
face or pair of edges."""
PLANE_DAMPING = 1e-9
"""Curvature added to every plane's own block, in units of the objective's largest derivative per clearance."""


class SpatialObjective(Protocol):
    """What is maximised: value [mm or rad], gradient (n, 6) and Hessian (n, 6, 6) by (dT, a) at a pose."""

    @property
    def couples(self) -> tuple[tuple[int, int], ...]:
        """Pairs of bodies, in order, that have second derivatives in common."""

    def value(self, pose: SpatialPose, before: float | None = None) -> float:
        """Value at a pose; turns are counted on from the value `before`."""

    def gradient(self, pose: SpatialPose) -> Floats:
        """Derivatives by (dT, a) of every body."""

    def hessian(self, pose: SpatialPose) -> Floats:
        """Second derivatives by (dT, a) of every body."""

    def coupled(self, pose: SpatialPose) -> Floats:
        """Second derivatives (c, 6, 6) of the couples."""


@dataclass(frozen=True, eq=False)
class SeparatingPlanePoint:
    """A point of the program: pose of the bodies, and planes by unit normals n (K, 3) and offsets d (K,) [mm]."""

    pose: SpatialPose
    n: Floats
    d: Floats


@dataclass(frozen=True, eq=False)
class BlockPattern:
    """Upper triangle of the condensed matrix in compressed columns.

    Parameters
    ----------
    indptr, indices : column pointers and row indices
    entry : (P, 12, 12) int64
        Where the entries of a pair's block live; -1: nowhere.
    own : (n, 6, 6) int64
        Where the entries of a body's own block live; -1: nowhere.
    diagonal : (V,) int64
        Where the diagonal lives.
    coupled : (c, 6, 6) int64
        Where second derivatives of the objective by two bodies live; -1: nowhere.
    """

    indptr: Ints
    indices: Ints
    entry: Ints
    own: Ints
    diagonal: Ints
    coupled: Ints


@dataclass(frozen=True, eq=False)
class SeparatingPlaneProgram:
    """max objective(pose) subject to rows h >= 0 of planes between pieces.

    Parameters
    ----------
    bodies : RigidBodies
    objective : SpatialObjective
    pieces : (K, 4) int64
        Body a, piece of a, body b, piece of b of every plane; pairs of bodies in order.
    a, b : (P,) int64
        Bodies of every pair.
    plane, row, own : see `separating_plane_constraints`
    V : (R, 3) float64 [mm]
        Corners in the frames of their bodies.
    c : (K, 3) float64 [mm]
        Points, in A's frame, about which the planes turn.
    lever : (K,) float64 [mm]
        Farthest corner from c.
    slot : (n, 6) int64
        Place of each freedom among the variables, -1 where it is locked.
    scale : (n, 6) float64 [mm, rad]
        Unit of each variable of the bodies.
    length : float [mm]
        Unit of lengths: the typical clearance.
    start : SeparatingPlanePoint
        Rest, with the planes that part the pieces best.
    clearance : (K,) float64 [mm]
        Separation of the pieces at rest.
    """

    bodies: RigidBodies
    objective: SpatialObjective
    pieces: Ints
    a: Ints
    b: Ints
    plane: Ints
    row: Ints
    own: Ints
    V: Floats
    c: Floats
    lever: Floats
    slot: Ints
    scale: Floats
    length: float
    start: SeparatingPlanePoint
    clearance: Floats
    pattern: BlockPattern

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.V)

    @property
    def planes(self) -> int:
        """Number of planes."""
        return len(self.pieces)

    def frames(self, pose: SpatialPose) -> tuple[Floats, Floats]:
        """How B is seen from A by all pairs: q (P, 3) [mm] and Psi (P, 3, 3)."""
        q, Psi = np.empty((len(self.a), 3)), np.empty((len(self.a), 3, 3))
        kernel.relative_frames(pose.T, pose.R, self.a, self.b, q, Psi)
        return q, Psi

    def values(self, point: SeparatingPlanePoint) -> Floats:
        """Rows h (R,) in units of `length`."""
        q, Psi = self.frames(point.pose)
        h = np.empty(self.rows)
        kernel.row_values(q, Psi, self.plane, self.row, self.own, self.V, self.c, point.n, point.d, h)
        return h / self.length

    def linearise(self, point: SeparatingPlanePoint, before: float | None = None) -> LinearisedSeparatingPlanes:
        """Rows, their derivatives, and products with them; turns are counted on from the objective `before`."""
        q, Psi = self.frames(point.pose)
        h, G = np.empty(self.rows), np.empty((self.rows, 12))
        kernel.row_values(q, Psi, self.plane, self.row, self.own, self.V, self.c, point.n, point.d, h)
        kernel.row_gradients(
            q, Psi, self.plane, self.row, self.own, self.V, self.c, point.n, self.lever, np.empty((2, 3)), G
        )
        G[:, :9] /= self.length  # planes are counted in units of `length` themselves
        axes = self.bodies.turn_axes(point.pose)
        gradient = self.objective.gradient(point.pose)
        gradient[:, 3:] = np.einsum("nji,nj->ni", axes, gradient[:, 3:])
        value = self.objective.value(point.pose, before)
        return LinearisedSeparatingPlanes(
            self, point, q, Psi, axes, h / self.length, G, value, self.packed(gradient * self.scale)
        )

    def packed(self, x: Floats) -> Floats:
        """Variables (V,) from entries (n, 6) of the bodies."""
        return x[self.slot >= 0]

    def unpacked(self, u: Floats) -> Floats:
        """Entries (n, 6) of the bodies from variables (V,); zero where locked."""
        x = np.zeros(self.slot.shape)
        x[self.slot >= 0] = u
        return x


@dataclass(frozen=True, eq=False)
class LinearisedSeparatingPlanes:
    """The program at one point: rows `h`, derivatives `G` (R, 12), objective `value` and `gradient` (V,), `axes` of turns (n, 3, 3)."""

    program: SeparatingPlaneProgram
    point: SeparatingPlanePoint
    q: Floats
    Psi: Floats
    axes: Floats
    h: Floats
    G: Floats
    value: float
    gradient: Floats

    def along(self, u: Floats, y: Floats) -> Floats:
        """Change of all rows (R,) by changes u (V,) of the bodies and y (K, 3) of the planes."""
        P, out = self.program, np.empty(self.program.rows)
        kernel.along(P.plane, P.row, self.G, self.seen(u), y, out)
        return out

    def seen(self, u: Floats) -> Floats:
        """What the pairs see (P, 9) of changes u (V,) of the bodies."""
        P, xi = self.program, np.empty((len(self.program.a), 9))
        turn = np.empty((len(P.slot), 3))
        kernel.pair_changes(self.Psi, self.point.pose.R, self.axes, P.a, P.b, P.scale, P.unpacked(u), turn, xi)
        return xi

    def change(self, u: Floats) -> Floats:
        """What changes u (V,) are for the bodies: moves in the world and turns in their frames (n, 6) [mm, rad]."""
        change = self.program.unpacked(u) * self.program.scale
        change[:, 3:] = np.einsum("nij,nj->ni", self.axes, change[:, 3:])
        return change

    def against(self, lam: Floats) -> tuple[Floats, Floats]:
        """J^T lam for the bodies (V,) and the planes (K, 3)."""
        P = self.program
        x, y = np.zeros(P.slot.shape), np.empty((P.planes, 3))
        kernel.against(self.Psi, self.point.pose.R, self.axes, P.a, P.b, P.plane, P.row, self.G, lam, P.scale, x, y)
        return P.packed(x), y

    def condensed(self, weight: Floats, lam: Floats, balance: Floats, share: float) -> tuple[Floats, Floats, Floats]:
        """Entries of J^T diag(weight) J - share objective'' - sum lam h'' without the planes, and what eliminates these."""
        P = self.program
        data = np.zeros(len(P.pattern.indices))
        inverse, mixed = np.empty((P.planes, 3, 3)), np.empty((P.planes, 3, 9))
        condensed(
            self.q, self.Psi, self.point.pose.R, self.axes, P.a, P.b, P.plane, P.row, P.own, P.V, self.point.n, P.lever / P.length,
            P.length * self.h, self.G, weight, lam / P.length, PLANE_DAMPING, balance, P.scale, P.pattern.entry, np.empty((8, 12, 12)),
            inverse, mixed, data,
        )  # fmt: skip
        own = -share * self.program.objective.hessian(self.point.pose)
        own[:, :, 3:] = own[:, :, 3:] @ self.axes
        own[:, 3:] = self.axes.transpose(0, 2, 1) @ own[:, 3:]
        own *= P.scale[:, :, None] * P.scale[:, None, :]
        upper = P.pattern.own >= 0
        data[P.pattern.own[upper]] += own[upper]
        if len(P.pattern.coupled):
            i, j = np.array(P.objective.couples).T
            both = -share * P.objective.coupled(self.point.pose)
            both[:, :, 3:] = both[:, :, 3:] @ self.axes[j]
            both[:, 3:] = self.axes[i].transpose(0, 2, 1) @ both[:, 3:]
            both *= P.scale[i][:, :, None] * P.scale[j][:, None, :]
            there = P.pattern.coupled >= 0
            np.add.at(data, P.pattern.coupled[there], both[there])
        return data, inverse, mixed


def build_planes(
    bodies: RigidBodies,
    objective: SpatialObjective,
    pieces: Ints,
    *,
    length: float,
    rest: SpatialPose | None = None,
    distance_ratio: float = DISTANCE_RATIO,
) -> SeparatingPlaneProgram:
    """Planes between pairs of pieces (K, 4), each at rest where it parts them best, put into one program.

    A plane begins across the line between the nearest points where these are `distance_ratio` times further apart than along any normal
    of a face or pair of edges, and at that normal otherwise.
    """
    pieces = _framed(bodies, pieces)
    keys, pair = np.unique(pieces[:, [0, 2]], axis=0, return_inverse=True)
    pair = pair.ravel()
    a, b = np.ascontiguousarray(keys[:, 0]), np.ascontiguousarray(keys[:, 1])
    plane = np.concatenate([[0], np.cumsum(np.bincount(pair, minlength=len(a)))]).astype(np.int64)
    pose = bodies.rest if rest is None else rest
    K = len(pieces)
    n, d, c = np.empty((K, 3)), np.empty(K), np.empty((K, 3))
    clearance, lever = np.empty(K), np.empty(K)
    corners, own, count = [], np.empty(K, dtype=np.int64), np.empty(K, dtype=np.int64)
    for k, who in enumerate(pieces.tolist()):
        P, Q = bodies.pieces[who[0]][who[1]], bodies.pieces[who[2]][who[3]]
        clearance[k], other = best_axis(bodies, pose, who, n[k], distance_ratio)
        p, v = P.corners @ n[k], other @ n[k]
        middle, band = (p.max() + v.min()) / 2, max(abs(clearance[k]), 1e-6 * length)
        near = np.vstack([P.corners[p > p.max() - band], other[v < v.min() + band]])
        c[k] = near.mean(axis=0)
        d[k] = middle - n[k] @ c[k]
        corners += [P.corners, Q.corners]
        own[k], count[k] = len(P.corners), len(P.corners) + len(other)
        far = np.vstack([P.corners, other]) - c[k]
        lever[k] = np.linalg.norm(far - np.outer(far @ n[k], n[k]), axis=1).max()
    slot = np.full(bodies.free.shape, -1, dtype=np.int64)
    slot[bodies.free] = np.arange(int(bodies.free.sum()))
    scale = np.full(slot.shape, length)
    scale[:, 3:] /= bodies.radius[:, None]
    return SeparatingPlaneProgram(
        bodies, objective, pieces, a, b, plane, np.concatenate([[0], np.cumsum(count)]).astype(np.int64), own,
        np.ascontiguousarray(np.vstack([*corners, np.zeros((0, 3))])), c, lever, slot, scale, length,
        SeparatingPlanePoint(pose, n, d), clearance, _pattern(a, b, slot, objective.couples),
    )  # fmt: skip


def best_axis(
    bodies: RigidBodies, pose: SpatialPose, who: Sequence[int], axis: Floats, distance_ratio: float = 1.0
) -> tuple[float, Floats]:
    """Distance of two pieces [mm], and the second one's corners in the first one's frame; `axis` (3,) becomes the best one there.

    That is the one along which they are furthest apart; a normal of a face or pair of edges is kept unless the distance is
    `distance_ratio` times what it shows.
    """
    i, pi, j, pj = who
    P, Q = bodies.pieces[i][pi], bodies.pieces[j][pj]
    Psi = np.ascontiguousarray(pose.R[i].T @ pose.R[j])
    other, zero = posed_points(Q.corners, Psi, pose.R[i].T @ (pose.T[j] - pose.T[i])), np.zeros(3)
    normals, edges = posed_points(Q.normals, Psi, zero), posed_points(Q.edges, Psi, zero)
    return distance(P.corners, P.normals, P.edges, other, normals, edges, axis, distance_ratio), other


def beside_rest(program: SeparatingPlaneProgram, seed: int) -> SeparatingPlanePoint:
    """A point inside all rows, up to a hundredth of the clearance beside rest.

    A symmetric assembly would stay on the ridge between two equal directions. The point is the same each time.
    """
    P, rest = program, program.start
    step = np.random.default_rng(seed).uniform(-1.0, 1.0, P.slot.shape) * P.scale * P.bodies.free
    step[:, 3:] = np.einsum("nij,nj->ni", P.bodies.turn_axes(rest.pose), step[:, 3:])
    room, share = P.values(rest), 1e-2
    while share > 1e-9:
        pose = SpatialPose(rest.pose.T + share * step[:, :3], rest.pose.R @ exponential(share * step[:, 3:]))
        point = SeparatingPlanePoint(pose, rest.n, rest.d)
        if (P.values(point) > 0.5 * room).all():
            return point
        share /= 2
    return rest


def parted(program: SeparatingPlaneProgram, point: SeparatingPlanePoint, h: Floats) -> SeparatingPlanePoint:
    """The point with every plane that a corner lies beyond set anew, where it parts its pieces best."""
    P = program
    worst = np.minimum.reduceat(h, P.row[:-1])
    n, d = point.n.copy(), point.d.copy()
    for k in np.flatnonzero(worst <= 0).tolist():
        axis = np.empty(3)
        apart, other = best_axis(P.bodies, point.pose, P.pieces[k].tolist(), axis)
        if apart > 0:
            n[k], d[k] = axis, float((other @ axis).min()) - apart / 2 - axis @ P.c[k]
    return SeparatingPlanePoint(point.pose, n, d)


def _framed(bodies: RigidBodies, pieces: Ints) -> Ints:
    """Pairs of pieces sorted by bodies, the one in whose frame the plane lives first: what is fixed, else what is larger.

    There the far corners stand still, so that turns of the other body leave the plane alone.
    """
    rank = bodies.radius - 1e12 * bodies.moves
    swap = rank[pieces[:, 2]] > rank[pieces[:, 0]]
    found = np.where(swap[:, None], pieces[:, [2, 3, 0, 1]], pieces)
    return found[np.lexsort(found.T[[3, 1, 2, 0]])]


def _pattern(a: Ints, b: Ints, slot: Ints, couples: Sequence[tuple[int, int]]) -> BlockPattern:
    """Pattern of the matrix of all bodies that the pairs, and the objective, couple."""
    size = int(slot.max(initial=-1)) + 1
    of_pair = np.concatenate([slot[a], slot[b]], axis=1)
    rows = [np.repeat(of_pair, 12, axis=1).reshape(-1, 12, 12), np.repeat(slot, 6, axis=1).reshape(-1, 6, 6)]
    keys = []
    for block in rows:
        i, j = block, block.transpose(0, 2, 1)
        keys.append(np.where((i >= 0) & (j >= 0) & (i <= j), j * size + i, -1))
    one, other = np.array(couples, dtype=np.int64).reshape(-1, 2).T
    i, j = np.broadcast_arrays(slot[one][:, :, None], slot[other][:, None, :])
    keys.append(np.where((i >= 0) & (j >= 0), j * size + i, -1))
    found = np.unique(np.concatenate([k.ravel() for k in keys]))
    found = found[found >= 0]
    at = [np.where(k >= 0, np.searchsorted(found, k), -1) for k in keys]
    column, row = found // max(size, 1), found % max(size, 1)
    indptr = np.concatenate([[0], np.cumsum(np.bincount(column, minlength=size))])
    return BlockPattern(
        indptr.astype(np.int64), row.astype(np.int64), at[0], at[1], np.flatnonzero(row == column), at[2]
    )
