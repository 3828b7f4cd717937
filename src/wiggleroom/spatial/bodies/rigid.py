"""Rigid bodies in space: convex pieces in frames of their own, and which pieces of two bodies come near each other."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wiggleroom.drawing.model import ConvexPiece
from wiggleroom.spatial.bodies.rotations import exponential, logarithm

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class RigidBodies:
    """Bodies at rest; every frame has its origin at the body's reference point and the axes of the world.

    Parameters
    ----------
    pieces : tuple of tuples of ConvexPiece
        Of each body, in its own frame.
    at : (n, 3) float64 [mm]
        Reference points at rest.
    free : (n, 6) bool
        Which of x, y, z, rx, ry, rz may change; a turn that may not is a component of the rotation vector that stays zero.
    owner : tuple of (k,) int64
        Part of every piece.
    ignored : frozenset of (int, int)
        Pairs a < b of parts that never collide.
    """

    pieces: tuple[tuple[ConvexPiece, ...], ...]
    at: Floats
    free: Bools
    owner: tuple[Ints, ...] = ()
    ignored: frozenset[tuple[int, int]] = frozenset()

    @property
    def moves(self) -> Bools:
        """Bodies (n,) that are not fixed."""
        return np.asarray(self.free.any(axis=1))

    def may_overlap(self, a: int, piece: int, b: int, other: int) -> bool:
        """True where pieces of two bodies belong to parts that never collide."""
        if not self.ignored:
            return False
        p, q = int(self.owner[a][piece]), int(self.owner[b][other])
        return (min(p, q), max(p, q)) in self.ignored

    @cached_property
    def corners(self) -> tuple[Floats, Ints, Ints]:
        """Corners of all pieces (c, 3) in the frames of their bodies, the body of each, and the first one of each piece."""
        every = [p.corners for body in self.pieces for p in body]
        count = np.array([len(c) for c in every])
        first = np.cumsum(count) - count
        body = np.repeat(np.arange(len(self.pieces)), [len(pieces) for pieces in self.pieces])
        return np.vstack(every), np.repeat(body, count), first

    @cached_property
    def radius(self) -> Floats:
        """Largest distance of a corner from the reference point (n,) [mm]."""
        corners, body, _ = self.corners
        radius = np.zeros(len(self.pieces))
        np.maximum.at(radius, body, np.linalg.norm(corners, axis=1))
        return radius

    @property
    def size(self) -> float:
        """Longest side of the box round everything at rest [mm]."""
        corners = [p.corners + at for body, at in zip(self.pieces, self.at, strict=True) for p in body]
        return float(np.ptp(np.vstack(corners), axis=0).max())

    @property
    def rest(self) -> SpatialPose:
        """Pose at rest."""
        return SpatialPose(self.at.copy(), np.repeat(np.eye(3)[None], len(self.at), axis=0))

    def turn_axes(self, pose: SpatialPose) -> Floats:
        """Axes (n, 3, 3), as columns in each body's frame, about which its turns are counted.

        Where one turn alone is locked, the rotation vector of the body has no component along that axis e of the world. Such rotations are
        a great sphere of quaternions. A turn exp(a) from one of them stays there where a is across exp(-w/2) e, w the rotation vector:
        so the axes of such a body are turned back by half its turn. Those of all others are the axes of its frame.

        Source: Listing's law, Tweed and Vilis 1987.
        """
        axes = np.repeat(np.eye(3)[None], len(self.at), axis=0)
        one = self.free[:, 3:].sum(axis=1) == 2
        if one.any():
            axes[one] = exponential(-logarithm(pose.R[one]) / 2)
        return axes


@dataclass(frozen=True, eq=False)
class SpatialPose:
    """Where all bodies are: positions T (n, 3) [mm] of the reference points and rotations R (n, 3, 3)."""

    T: Floats
    R: Floats


def boxes_of(bodies: RigidBodies, pose: SpatialPose) -> tuple[Floats, Floats]:
    """Axis-aligned boxes of all pieces, one body after the other: lower and upper corners (k, 3) [mm]."""
    corners, body, first = bodies.corners
    placed = (pose.R[body] @ corners[:, :, None])[:, :, 0] + pose.T[body]
    return np.minimum.reduceat(placed, first), np.maximum.reduceat(placed, first)


def near_pieces(bodies: RigidBodies, pose: SpatialPose, reach: float) -> Ints:
    """Pairs of pieces (k, 4) as body a, piece of a, body b, piece of b, not both fixed, whose boxes come within `reach` [mm]."""
    import shapely

    low, high = boxes_of(bodies, pose)
    count = [len(pieces) for pieces in bodies.pieces]
    body, first = np.repeat(np.arange(len(count)), count), np.cumsum([0, *count])
    piece = np.arange(len(body)) - first[body]
    flat = shapely.box(*(low[:, :2] - reach / 2).T, *(high[:, :2] + reach / 2).T)
    moving = np.flatnonzero(bodies.moves[body])
    found, j = shapely.STRtree(flat).query(flat[moving])
    i = moving[found]
    keep = (body[i] < body[j]) | ((body[i] > body[j]) & ~bodies.moves[body[j]])
    keep &= (low[i, 2] <= high[j, 2] + reach) & (low[j, 2] <= high[i, 2] + reach)
    i, j = np.minimum(i[keep], j[keep]), np.maximum(i[keep], j[keep])
    near = np.column_stack([body[i], piece[i], body[j], piece[j]]).astype(np.int64)
    near = near[np.lexsort(near.T[[3, 1, 2, 0]])]
    if bodies.ignored:
        near = near[[not bodies.may_overlap(*who) for who in near.tolist()]]
    return near
