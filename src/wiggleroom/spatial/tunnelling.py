"""Pieces that pass through each other between two waypoints, though they meet at neither."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from wiggleroom.spatial.overlaps.swept_check import stay_apart
from wiggleroom.spatial.rigid import RigidBodies, SpatialPose, boxes_of
from wiggleroom.spatial.rotations import logarithm

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


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
