"""Linear inequalities that hold for all free poses in a box of poses.

A pose is (u, a): the body turns by the quaternion (1, a) / |(1, a)| about its origin, then moves by u. A material point of one body is
never inside a convex piece of the other. Where in a box of poses all faces of the piece but one have the point behind them for certain,
the point lies beyond that one. With arm r from the origin and z from the piece's frame

    n . R(a) r = n . r + Q(a) / s(a),   s = 1 + |a|^2,   Q = 2 a . (r x n) + 2 (n . a) (r . a) - 2 |a|^2 n . r.

About the middle m of the box, d = a - m, F = Q / s and g its gradient at m:

    n . R(a) r = n . r + F + g . d + P(d) / s(m + d),
    P(d) = 2 (n . d) (r . d) - |d|^2 (2 n . r + F) - 2 (m . d) (g . d) - |d|^2 (g . d),

exactly, so that bounds of P over the box bound what linearisation leaves out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ROUNDING = 1e-11
"""Rows are widened by this share of the lengths in them."""


def rotation(a: Floats) -> Floats:
    """Rotation matrix (3, 3) of the quaternion (1, a), normalised."""
    x, y, z = a
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    s = float(a @ a)
    return np.asarray(((1 - s) * np.eye(3) + 2 * np.outer(a, a) + 2 * cross) / (1 + s))


def linearised(n: Floats, r: Floats, m: Floats, d: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """N . R(a) r for vectors (..., 3) about m within half-widths d: value and gradient at m, remainder at least and at most."""
    nr, w = (n * r).sum(-1), np.cross(r, n)
    nm, rm, mm = n @ m, r @ m, float(m @ m)
    s = 1 + mm
    F = (2 * w @ m + 2 * nm * rm - 2 * mm * nr) / s
    dQ = 2 * w + 2 * (nm[..., None] * r + rm[..., None] * n) - 4 * nr[..., None] * m
    g = (dQ - 2 * F[..., None] * m) / s
    low, high = np.zeros_like(F), np.zeros_like(F)
    for i in range(3):
        square = 2 * n[..., i] * r[..., i] - (2 * nr + F) - 2 * m[i] * g[..., i]
        low += np.minimum(square, 0) * d[i] ** 2
        high += np.maximum(square, 0) * d[i] ** 2
        for j in range(i):
            mixed = 2 * np.abs(n[..., i] * r[..., j] + n[..., j] * r[..., i] - m[i] * g[..., j] - m[j] * g[..., i])
            low -= mixed * d[i] * d[j]
            high += mixed * d[i] * d[j]
    cubic = float(d @ d) * (np.abs(g) @ d)
    least = np.maximum(np.abs(m) - d, 0.0)
    smallest = 1 + float(least @ least)
    return nr + F, g, (low - cubic) / smallest, (high + cubic) / smallest


@dataclass(frozen=True, eq=False)
class Box:
    """Poses with low <= (u, a) <= high, each (6,)."""

    low: Floats
    high: Floats

    @property
    def middle(self) -> Floats:
        """Of all six."""
        return (self.low + self.high) / 2

    @property
    def half(self) -> Floats:
        """Half of each width, not less than the rounding of the middle."""
        m = self.middle
        return np.maximum(self.high - m, m - self.low)


@dataclass(frozen=True, eq=False)
class Rows:
    """constant + slope . (pose - middle) >= 0 for all free poses in a box.

    Parameters
    ----------
    point, piece, face : (k,) int64
        What each is about; the point is of one body, the piece of the other.
    constant : (k,) float64 [mm]
    slope : (k, 6) float64
    """

    point: Ints
    piece: Ints
    face: Ints
    constant: Floats
    slope: Floats


Pairs = tuple[int, Ints, Ints]
"""Of the first so many points, numbers of points and pieces."""


class Contacts:
    """Points of one body and pieces of the other, in the frame of the moving body's origin at rest.

    Parameters
    ----------
    fixed : bool
        Whether the points are of what is fixed, and the pieces of the moving body.
    pieces : list of (number, normals, offsets)
    """

    def __init__(self, fixed: bool, pieces: list[tuple[int, Floats, Floats]]) -> None:
        self.fixed = fixed
        self.number = np.array([k for k, _, _ in pieces], dtype=np.int64)
        count = np.array([len(h) for _, _, h in pieces], dtype=np.int64)
        self.count, self.first = count, np.cumsum(count) - count
        self.piece_of = np.repeat(np.arange(len(pieces)), count)
        self.face_of = np.concatenate([np.arange(c) for c in count])
        self.normals = np.vstack([n for _, n, _ in pieces])
        self.offsets = np.concatenate([h for _, _, h in pieces])
        self.points = np.zeros((0, 3))
        self.names = np.zeros(0, dtype=np.int64)

    def add(self, names: Ints, points: Floats) -> None:
        """More points (k, 3) [mm], and what they are called."""
        self.names = np.concatenate([self.names, names])
        self.points = np.vstack([self.points, points])

    def bounds(self, who: Ints, face: Ints, box: Box) -> tuple[Floats, Floats, Floats, Floats]:
        """Of some points before some faces: linearisation, and what it leaves out at least and at most."""
        m, d = box.middle, box.half
        n, h = self.normals[face], self.offsets[face]
        k = len(who)
        slope = np.zeros((k, 6))
        if not self.fixed:
            r = self.points[who]
            value, slope[:, 3:], low, high = linearised(n, r, m[3:], d[3:])
            slope[:, :3] = n
            return value + n @ m[:3] - h, slope, low, high
        z = self.points[who] - m[:3]
        value, slope[:, 3:], low, high = linearised(z, n, m[3:], d[3:])
        slope[:, :3] = -n @ rotation(m[3:]).T
        for axis in np.eye(3):
            _, g, down, up = linearised(np.broadcast_to(axis, n.shape), n, m[3:], d[3:])
            turned = (np.abs(g) @ d[3:] + np.maximum(-down, up)) * float(axis @ d[:3])
            low, high = low - turned, high + turned
        return value - h, slope, low, high

    def bites(self, ends: Floats, by: float = 0.0) -> tuple[Ints, Floats, Floats, Floats]:
        """Which of some edges (k, 2, 3), where pieces lie, run through a piece whose faces are further out.

        Also from where to where, as shares of the edge, and how deep the middle is.
        """
        a, b = ((self.normals @ ends[:, k].T) - (self.offsets + by)[:, None] for k in (0, 1))
        outside = np.maximum.reduceat(np.minimum(a, b), self.first, axis=0)
        piece, edge = np.nonzero(outside < 0)  # (pieces, k)
        if not len(edge):
            return edge, np.zeros(0), np.zeros(0), np.zeros(0)
        face, owner, first = self._faces(piece)
        a, b = a[face, edge[owner]], b[face, edge[owner]]
        with np.errstate(divide="ignore", invalid="ignore"):
            t = a / (a - b)
        start = np.maximum.reduceat(np.where(a > 0, t, 0.0), first)
        stop = np.minimum.reduceat(np.where(b > 0, t, 1.0), first)
        depth = -np.maximum.reduceat(a + ((start + stop) / 2)[owner] * (b - a), first)
        through = stop > start
        return edge[through], start[through], stop[through], depth[through]

    def rows(self, box: Box, open_: Pairs | None = None) -> tuple[Rows, Pairs]:
        """All inequalities that hold in a box and are not true of all its poses, and pairs that may meet in it.

        `open_` are the pairs that may meet in a box around it.
        """
        m, d = box.middle, box.half
        R = rotation(m[3:])
        turn = 2 * float(np.linalg.norm(d[3:]))
        if self.fixed:
            placed = (self.points - m[:3]) @ R
            reach = np.linalg.norm(self.points - m[:3], axis=1)
            shift = np.full(len(self.normals), float(np.linalg.norm(d[:3])))
        else:
            placed = self.points @ R.T + m[:3]
            reach = np.linalg.norm(self.points, axis=1)
            shift = np.abs(self.normals) @ d[:3]
        seen, who, piece = open_ or (0, np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64))
        new, pieces = np.arange(seen, len(self.points)), np.arange(len(self.count))
        who = np.concatenate([who, np.repeat(new, len(pieces))])
        piece = np.concatenate([piece, np.tile(pieces, len(new))])
        face, owner, start = self._faces(piece)
        value = (self.normals @ placed.T)[face, who[owner]] - self.offsets[face]
        room = np.minimum(turn, 2.0) * reach[who[owner]] + shift[face]
        near = np.maximum.reduceat(value - room, start) < 0 if len(start) else np.zeros(0, dtype=bool)
        before = value >= -room
        count = np.bincount(owner, before, len(who))
        kept = (near & (count <= MOST_FACES))[owner] & (
            before | (count == 0)[owner]
        )  # of what is inside any face says so
        found = len(self.points), who[near], piece[near]
        face, owner = face[kept], owner[kept]
        point = who[owner]
        constant, slope, low, high = self.bounds(point, face, box)
        linear = np.abs(slope) @ d
        slack = ROUNDING * (np.abs(constant) + linear + reach[point] + 1e-3)
        possible = constant + linear + high + slack >= 0
        certain = constant - linear + low - slack >= 0
        ways = np.bincount(owner, possible, len(who))
        settled = np.bincount(owner, certain, len(who)) > 0
        keep = possible & (ways[owner] == 1) & ~settled[owner]
        # no face is left: every pose of the box is barred, which the row of any face says
        barred = (ways[owner] == 0) & (np.r_[True, owner[1:] != owner[:-1]])
        keep |= barred
        rows = Rows(
            self.names[point[keep]],
            self.number[self.piece_of[face[keep]]],
            self.face_of[face[keep]],
            (constant + high + slack)[keep],
            slope[keep],
        )
        return rows, found

    def _faces(self, piece: Ints) -> tuple[Ints, Ints, Ints]:
        """Faces of some pieces (k,) one after another, which of the pieces each is of, and where those of each begin."""
        count = self.count[piece]
        start = np.cumsum(count) - count
        owner = np.repeat(np.arange(len(piece)), count)
        return np.arange(count.sum()) + (self.first[piece] - start)[owner], owner, start


MOST_FACES = 4
"""Pieces of which more faces may hold a point are left out."""
